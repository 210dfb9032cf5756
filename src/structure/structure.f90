!> A structure of rigid bodies and springs, as the solvers see it: unknowns with a diagonal mass, springs
!> whose deformations are linear in them, and loads that are signals times patterns.
!>
!>     M x'' + C x' + B' f(d) + K_G(N) x = sum signal * pattern,   d = B x
!>
!> A structure does not change once it has been made, and every run on it shares it.
module rbs_structure_structure
   use rbs_base_kinds, only: wp
   use rbs_structure_spring_place, only: spring_place
   implicit none
   private

   public :: structure_type, load_pattern, unknown_group
   public :: lateral, horizontal, vertical, top_axial, signals

   !> Signals of the loads: lateral force [N], acceleration of the ground to +x and upward [m/s2], axial load
   !> besides the constant one, compression positive [N].
   integer, parameter :: lateral = 1, horizontal = 2, vertical = 3, top_axial = 4, signals = 4

   !> Forces on the unknowns per unit of a signal.
   type :: load_pattern
      real(wp), allocatable :: force(:)
      !> First and last unknown that has any; none if the last is less than the first
      integer :: first = 1, last = 0
   end type load_pattern

   !> Unknowns of one kind and the springs whose forces are of that kind: forces, moments, vertical forces.
   !> Both are slices of their arrays.
   type :: unknown_group
      integer :: first = 1, last = 0, step = 1
      integer :: first_spring = 1, last_spring = 0
      !> Largest force of the group per lateral force
      real(wp) :: lateral_arm = 0.0_wp
   end type unknown_group

   type, abstract :: structure_type
      !> Number of unknowns, and of diagonals of the stiffness beside the main one
      integer :: unknowns = 0, half_width = 0
      !> Mass or rotary inertia of each unknown (unknowns) [kg, kg m2]
      real(wp), allocatable :: inertias(:)
      !> Unknowns that supports keep still (unknowns)
      logical, allocatable :: is_held(:)
      logical :: has_held = .false.
      !> The body, or the part of it that is coupled, that an unknown belongs to (unknowns)
      integer, allocatable :: part(:)
      type(unknown_group), allocatable :: group(:)
      !> Where the springs are (springs)
      type(spring_place), allocatable :: place(:)
      !> Loads in the order of their signals (signals)
      type(load_pattern) :: pattern(signals)
   contains
      !> Changes of the deformations of the springs from those of the unknowns
      procedure(gather), deferred :: spring_rates
      !> Changes of the unknowns from those of the deformations
      procedure(spread_out), deferred :: unknown_rates
      !> Forces on the unknowns
      procedure(collect), deferred :: forces
      !> Axial forces that do second-order work, under loads
      procedure(press), deferred :: axial_forces
      procedure(assemble), deferred :: add_stiffness
      procedure(assemble), deferred :: add_geometric
      procedure :: add_ground
      procedure :: work_of
   end type structure_type

   abstract interface
      subroutine gather(self, dx, dd)
         import :: structure_type, wp
         implicit none
         class(structure_type), intent(in) :: self
         !> (unknowns)
         real(wp), intent(in), contiguous :: dx(:)
         !> (springs)
         real(wp), intent(out), contiguous :: dd(:)
      end subroutine gather

      subroutine spread_out(self, dd, dx)
         import :: structure_type, wp
         implicit none
         class(structure_type), intent(in) :: self
         !> (springs)
         real(wp), intent(in), contiguous :: dd(:)
         !> (unknowns)
         real(wp), intent(out), contiguous :: dx(:)
      end subroutine spread_out

      !> Forces of springs, of loads but the inertia of the moving ground, and of axial forces.
      subroutine collect(self, d, load, axial, f, g)
         import :: structure_type, wp
         implicit none
         class(structure_type), intent(in) :: self
         !> Deformations (springs), signals of the loads, axial forces (see `axial_forces`)
         real(wp), intent(in), contiguous :: d(:), load(:), axial(:)
         !> Forces of the springs; those of slips get the second-order share of the axial forces (springs)
         real(wp), intent(inout), contiguous :: f(:)
         !> (unknowns) [N, N m]
         real(wp), intent(out), contiguous :: g(:)
      end subroutine collect

      subroutine press(self, load, axial)
         import :: structure_type, wp
         implicit none
         class(structure_type), intent(in) :: self
         real(wp), intent(in), contiguous :: load(:)
         !> Compression positive, in the order of the structure [N]
         real(wp), intent(out), contiguous :: axial(:)
      end subroutine press

      !> Add to a lower band, band(1 + i - j, j) = a(i, j): B' diag(k) B of the stiffness of the springs, or
      !> the geometric stiffness of the axial forces.
      subroutine assemble(self, k, band)
         import :: structure_type, wp
         implicit none
         class(structure_type), intent(in) :: self
         !> Stiffness of the springs, or axial forces
         real(wp), intent(in), contiguous :: k(:)
         !> (half_width + 1, unknowns)
         real(wp), intent(inout), contiguous :: band(:, :)
      end subroutine assemble
   end interface

contains

   !> Add the inertia of the moving ground.
   pure subroutine add_ground(self, load, g)
      class(structure_type), intent(in) :: self
      real(wp), intent(in) :: load(signals)
      !> Forces on the unknowns (unknowns)
      real(wp), intent(inout), contiguous :: g(:)
      integer :: i, j

      do j = horizontal, vertical
         if (.not. abs(load(j)) > 0.0_wp) cycle
         associate (pattern => self%pattern(j))
            do i = pattern%first, pattern%last
               g(i) = g(i) + pattern%force(i)*load(j)
            end do
         end associate
      end do
   end subroutine add_ground

   !> Work of a load that keeps its direction, per unit of its signal.
   pure real(wp) function work_of(self, signal, moved) result(work)
      class(structure_type), intent(in) :: self
      integer, intent(in) :: signal
      !> What the unknowns have moved (unknowns)
      real(wp), intent(in), contiguous :: moved(:)
      integer :: i

      work = 0.0_wp
      associate (pattern => self%pattern(signal))
         do i = pattern%first, pattern%last
            work = work + pattern%force(i)*moved(i)
         end do
      end associate
   end function work_of

end module rbs_structure_structure
