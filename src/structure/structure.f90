!> A structure of rigid bodies and springs, as the solvers see it: unknowns with a diagonal mass, springs
!> whose deformations are linear in them, and loads that are signals times patterns.
!>
!>     M x'' + C x' + B' f(d) + K_G(N) x = sum signal * pattern,   d = B x
!>
!> A structure does not change once it has been made, and every run on it shares it.
module rbs_structure_structure
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_rule, only: spring_rules
   use rbs_hysteresis_spring_record, only: spring_record
   use rbs_hysteresis_springs, only: spring_array
   use rbs_structure_channel, only: channel_type, response_type, row_contents
   use rbs_structure_spring_place, only: spring_place
   implicit none
   private

   public :: structure_type, load_pattern, unknown_group
   public :: small, pdelta, finite
   public :: lateral, horizontal, vertical, top_axial, signals

   !> Levels of kinematics.
   integer, parameter :: small = 1, pdelta = 2, finite = 3

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
      !> Number of bodies; those that are held count too
      integer :: n = 0
      !> `small`, `pdelta` or `finite`
      integer :: kinematics = small
      !> Lengths of the bodies (n) [m]
      real(wp), allocatable :: length(:)
      !> Height that drifts are in proportion to, and that of the top above the ground [m]
      real(wp) :: height = 0.0_wp, total_height = 0.0_wp
      !> Mass or rotary inertia of each unknown (unknowns) [kg, kg m2]
      real(wp), allocatable :: inertias(:)
      !> Unknowns that supports keep still (unknowns)
      logical, allocatable :: is_held(:)
      logical :: has_held = .false.
      !> The body, or the part of it that is coupled, that an unknown belongs to (unknowns)
      integer, allocatable :: part(:)
      type(unknown_group), allocatable :: group(:)
      !> Where the springs are, their parameters, rules and initial stiffness (springs)
      type(spring_place), allocatable :: place(:)
      type(spring_record), allocatable :: spring(:)
      type(spring_rules) :: rules
      real(wp), allocatable :: initial_stiffness(:)
      !> Displacement of the top per deformation, for small rotations: what static paths control (springs)
      real(wp), allocatable :: arm(:)
      !> The springs whose forces, times the factors beside them, add up to the base shear
      integer, allocatable :: base_spring(:)
      real(wp), allocatable :: base_factor(:)
      !> Axial load at the top that is there from the start, compression positive [N]
      real(wp) :: axial_load = 0.0_wp
      !> Change of the axial load at the top per lateral force on a static path
      real(wp) :: axial_force_ratio = 0.0_wp
      !> Whether a constant axial force does second-order work, from the load or from the weight
      logical :: axially_loaded = .false.
      !> Damping in proportion to the mass [1/s] and to the stiffness of the springs [s], the initial one
      !> or that of the present line
      real(wp) :: mass_damping = 0.0_wp, stiffness_damping = 0.0_wp
      logical :: tangent_damping = .false.
      !> Damping ratios of the modes (first modes, or one for all); not allocated without modal damping
      real(wp), allocatable :: modal_damping(:)
      !> Whether there is damping at all
      logical :: damped = .false.
      !> Number of axial forces that may do second-order work, and of numbers in the work array of
      !> `accelerations`
      integer :: axial_count = 0, work_size = 0
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
      !> Accelerations of the springs, for explicit steps
      procedure(accelerate), deferred :: accelerations
      !> What the lateral force and the acceleration of the ground do work on, per unit of time
      procedure(find_speeds), deferred :: speeds
      procedure(find_power), deferred :: power_of_loads
      procedure(of_motion), deferred :: kinetic_energy
      !> Potential of constant loads, zero where no spring is deformed [J]
      procedure(of_position), deferred :: potential_energy
      !> Displacement of the top along x [m]
      procedure(of_position), deferred :: top_displacement
      procedure(find_top_acceleration), deferred :: top_acceleration
      !> Absolute rotations of the bodies
      procedure(turn), deferred :: rotations
      !> Axial force at a spring under loads, compression positive [N], and its rate under their slopes
      procedure(press_spring), deferred :: axial_force
      procedure(press_spring), deferred :: axial_rate
      !> What the loads of a moment and the forces in it may accelerate a spring by, in size
      procedure(scale_acceleration), deferred :: acceleration_scale
      !> What rows hold besides what all structures have, and the values of one
      procedure(list_channels), deferred :: channels
      procedure(fill_values), deferred :: fill_row
      !> Refuse loads in time that do nothing, or cannot be
      procedure(check_acting), deferred :: check_loads
      !> Refuse deformations, or velocities, that supports do not allow
      procedure(check_values), deferred :: check_initial
      procedure :: spring_of
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

      subroutine accelerate(self, d, v, load, axial, f, work, a, of_speeds)
         import :: structure_type, wp
         implicit none
         class(structure_type), intent(in) :: self
         !> Deformations of the springs and their velocities (springs), signals of the loads, axial forces
         !> that do second-order work (see `axial_forces`; none where they do not)
         real(wp), intent(in), contiguous :: d(:), v(:), load(:), axial(:)
         !> Forces of springs and damping; see `forces` (springs)
         real(wp), intent(inout), contiguous :: f(:)
         !> (work_size)
         real(wp), intent(inout), contiguous :: work(:)
         !> Second derivatives of the deformations, mass damping included (springs)
         real(wp), intent(out), contiguous :: a(:)
         !> Rates of `speeds`, where rotations are small
         real(wp), intent(out) :: of_speeds(2)
      end subroutine accelerate

      pure subroutine find_speeds(self, d, v, speed)
         import :: structure_type, wp
         implicit none
         class(structure_type), intent(in) :: self
         !> Deformations of the springs and their velocities (springs)
         real(wp), intent(in), contiguous :: d(:), v(:)
         !> Velocity of the top along x [m/s], momentum along x relative to the ground with its sign turned
         !> [kg m/s]: power per lateral force and per acceleration of the ground
         real(wp), intent(out) :: speed(2)
      end subroutine find_speeds

      !> Power of the loads, constant ones left out [W].
      pure real(wp) function find_power(self, d, v, load)
         import :: structure_type, wp
         implicit none
         class(structure_type), intent(in) :: self
         real(wp), intent(in), contiguous :: d(:), v(:), load(:)
      end function find_power

      !> Energy of a motion relative to the ground [J].
      pure real(wp) function of_motion(self, d, v)
         import :: structure_type, wp
         implicit none
         class(structure_type), intent(in) :: self
         real(wp), intent(in), contiguous :: d(:), v(:)
      end function of_motion

      pure real(wp) function of_position(self, d)
         import :: structure_type, wp
         implicit none
         class(structure_type), intent(in) :: self
         real(wp), intent(in), contiguous :: d(:)
      end function of_position

      !> Acceleration of the top along x, relative to the ground [m/s2].
      pure real(wp) function find_top_acceleration(self, d, v, a)
         import :: structure_type, wp
         implicit none
         class(structure_type), intent(in) :: self
         !> Deformations of the springs and their derivatives (springs)
         real(wp), intent(in), contiguous :: d(:), v(:), a(:)
      end function find_top_acceleration

      pure subroutine turn(self, d, rotation)
         import :: structure_type, wp
         implicit none
         class(structure_type), intent(in) :: self
         !> Deformations of the springs, or changes of them (springs)
         real(wp), intent(in), contiguous :: d(:)
         !> (n) [rad]
         real(wp), intent(out), contiguous :: rotation(:)
      end subroutine turn

      pure real(wp) function press_spring(self, spring, load)
         import :: structure_type, wp
         implicit none
         class(structure_type), intent(in) :: self
         integer, intent(in) :: spring
         !> Signals of the loads, or their slopes
         real(wp), intent(in) :: load(:)
      end function press_spring

      pure real(wp) function scale_acceleration(self, spring, springs, load)
         import :: structure_type, spring_array, wp
         implicit none
         class(structure_type), intent(in) :: self
         !> Which spring, and all of them
         integer, intent(in) :: spring
         type(spring_array), intent(in) :: springs
         real(wp), intent(in) :: load(:)
      end function scale_acceleration

      subroutine check_acting(self, acts, error)
         import :: structure_type, error_type, signals
         implicit none
         class(structure_type), intent(in) :: self
         !> Which loads act (signals)
         logical, intent(in) :: acts(signals)
         type(error_type), allocatable, intent(inout) :: error
      end subroutine check_acting

      subroutine check_values(self, name, value, error)
         import :: structure_type, error_type, wp
         implicit none
         class(structure_type), intent(in) :: self
         !> For messages
         character(len=*), intent(in) :: name
         !> (springs)
         real(wp), intent(in), contiguous :: value(:)
         type(error_type), allocatable, intent(inout) :: error
      end subroutine check_values

      pure subroutine list_channels(self, contents, channel)
         import :: structure_type, row_contents, channel_type
         implicit none
         class(structure_type), intent(in) :: self
         type(row_contents), intent(in) :: contents
         type(channel_type), allocatable, intent(out) :: channel(:)
      end subroutine list_channels

      pure subroutine fill_values(self, contents, response, springs, d, row)
         import :: structure_type, row_contents, response_type, spring_array, wp
         implicit none
         class(structure_type), intent(in) :: self
         type(row_contents), intent(in) :: contents
         type(response_type), intent(in) :: response
         type(spring_array), intent(in) :: springs
         !> Deformations of the springs (springs)
         real(wp), intent(in), contiguous :: d(:)
         !> Values of `channels`, one after the other
         real(wp), intent(out), contiguous :: row(:)
      end subroutine fill_values
   end interface

contains

   !> The spring of a kind that comes in a place among those of the kind; 0 if there are not so many.
   pure integer function spring_of(self, kind, number) result(i)
      class(structure_type), intent(in) :: self
      integer, intent(in) :: kind, number
      integer :: counted

      counted = 0
      do i = 1, size(self%place)
         if (self%place(i)%kind == kind) counted = counted + 1
         if (counted == number) return
      end do
      i = 0
   end function spring_of

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
