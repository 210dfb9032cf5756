!> Rigid floors of a building in plan: each moves by U and V along x and y and turns by Theta about its centre
!> of mass, counterclockwise, and vertical planes at the angle alpha and the distance r from this centre
!> follow, u = U cos alpha + V sin alpha + r Theta. A plane through (X, Y) has r = X sin alpha - Y cos alpha
!> about the origin.
module rbs_structure_frame_plan
   use rbs_base_constants, only: pi
   use rbs_base_kinds, only: wp
   implicit none
   private

   public :: floor_plan, cosine_sine

   !> Shares of a plane in the motion of a floor that are less are round-off.
   real(wp), parameter :: no_share = 1.0e-12_wp

   type :: floor_plan
      !> cos alpha, sin alpha and r [m] of the planes about the centre of each floor (3, planes, floors);
      !> none: it is a planar frame
      real(wp), allocatable :: share(:, :, :)
      !> Whether a plane has nodes on a floor (planes, floors)
      logical, allocatable :: is_there(:, :)
      !> Which of U, V and Theta no plane resists: the floors do not move in this way
      logical :: held(3) = .false.
      !> Direction of the lateral load, as the share of a plane through the centres of mass
      real(wp) :: direction(3) = [1.0_wp, 0.0_wp, 0.0_wp]
      !> Whether it is made of shares of nodes, in their planes
      logical :: by_nodes = .false.
      !> Masses of the floors besides those of their nodes [kg, kg m2] (floors)
      real(wp), allocatable :: mass(:), inertia(:)
      !> Numbers of U, V and Theta of the floors among the unknowns, 0 where they are held (3, floors)
      integer, allocatable :: number(:, :)
   contains
      procedure :: is_given, planes, hold_free, motion, on_floors, turning_mass, turning_momentum
   end type floor_plan

contains

   !> Whether it is a building, which has planes.
   pure logical function is_given(self)
      class(floor_plan), intent(in) :: self

      is_given = allocated(self%share)
   end function is_given

   !> Number of planes.
   pure integer function planes(self)
      class(floor_plan), intent(in) :: self

      planes = 0
      if (allocated(self%share)) planes = size(self%share, 2)
   end function planes

   !> Cosine and sine of an angle in degrees, exact where they are 0 or 1.
   pure function cosine_sine(degrees) result(pair)
      !> Angle [degrees]
      real(wp), intent(in) :: degrees
      real(wp) :: pair(2), rest, turned(2)
      integer :: quarters

      quarters = nint(modulo(degrees, 360.0_wp)/90.0_wp)
      rest = (modulo(degrees, 360.0_wp) - 90.0_wp*quarters)*pi/180.0_wp
      pair = [cos(rest), sin(rest)]
      do quarters = 1, quarters
         turned = [-pair(2), pair(1)]
         pair = turned
      end do
   end function cosine_sine

   !> Hold what no plane resists, and find a floor that is free to move, or to turn, in another way; 0: none.
   pure subroutine hold_free(self, free)
      class(floor_plan), intent(inout) :: self
      !> Number of that floor
      integer, intent(out) :: free
      !> Shares of the planes on a floor; those of the plane that is taken out, over its pivot; largest r [m]
      real(wp) :: row(3, size(self%is_there, 1)), part(3), size_of_arms
      integer :: i, j, pivot

      self%held = [(.not. any(abs(self%share(i, :, :)) > no_share*maxval(abs(self%share(i, :, :))) .and. &
                              self%is_there), i=1, 3)]
      ! Gaussian elimination on each floor; left early, the loop has the free floor in `free`.
      do free = 1, size(self%is_there, 2)
         row = self%share(:, :, free)
         size_of_arms = maxval(abs(row(3, :)))
         if (size_of_arms > 0.0_wp) row(3, :) = row(3, :)/size_of_arms
         where (spread(.not. self%is_there(:, free), 1, 3)) row = 0.0_wp
         ! Each direction that moves takes a plane out, and its part of the others.
         do i = 1, 3
            if (self%held(i)) cycle
            pivot = maxloc(abs(row(i, :)), dim=1)
            if (.not. abs(row(i, pivot)) > no_share) return
            part = row(:, pivot)/row(i, pivot)
            do j = 1, size(row, 2)
               row(:, j) = row(:, j) - part*row(i, j)
            end do
         end do
      end do
      free = 0
   end subroutine hold_free

   !> U, V and Theta of a floor [m, m, rad]; those of the ground are zero.
   pure function motion(self, floor, x) result(moved)
      class(floor_plan), intent(in) :: self
      !> Number of the floor, 0 for the ground
      integer, intent(in) :: floor
      !> Unknowns, or changes of them (unknowns)
      real(wp), intent(in) :: x(:)
      real(wp) :: moved(3)
      integer :: j

      moved = 0.0_wp
      if (floor < 1) return
      do j = 1, 3
         if (self%number(j, floor) > 0) moved(j) = x(self%number(j, floor))
      end do
   end function motion

   !> Forces on the floors alone: those on other unknowns are set to zero.
   pure function on_floors(self, force) result(of_floors)
      class(floor_plan), intent(in) :: self
      !> (unknowns)
      real(wp), intent(in) :: force(:)
      real(wp) :: of_floors(size(force))
      logical :: is_of_floor(size(force))
      integer :: i

      is_of_floor = .false.
      do i = 1, size(self%number, 2)
         is_of_floor(pack(self%number(:, i), self%number(:, i) > 0)) = .true.
      end do
      of_floors = merge(force, 0.0_wp, is_of_floor)
   end function on_floors

   !> Sum of the rotary inertias of all floors [kg m2].
   pure real(wp) function turning_mass(self, inertias) result(inertia)
      class(floor_plan), intent(in) :: self
      !> (unknowns)
      real(wp), intent(in) :: inertias(:)
      integer :: i

      inertia = sum([(inertias(max(self%number(3, i), 1)), i=1, size(self%number, 2))], &
                    mask=self%number(3, :) > 0)
   end function turning_mass

   !> Angular momentum of a motion, the sum of those of the floors about their centres of mass.
   pure real(wp) function turning_momentum(self, inertias, x) result(momentum)
      class(floor_plan), intent(in) :: self
      !> Masses and rotary inertias; displacements or velocities (unknowns)
      real(wp), intent(in) :: inertias(:), x(:)
      real(wp) :: moved(3)
      integer :: i

      momentum = 0.0_wp
      do i = 1, size(self%number, 2)
         if (self%number(3, i) == 0) cycle
         moved = self%motion(i, x)
         momentum = momentum + inertias(self%number(3, i))*moved(3)
      end do
   end function turning_momentum

end module rbs_structure_frame_plan
