!> Whether a point of a static path is a state of the structure: the top is where its springs are, each joint
!> is in equilibrium, and no work is missing. A path is found without tolerances, so that what a point may
!> miss is round-off; more means that the arithmetic could not carry the path on.
module rbs_solve_static_row_check
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_hysteresis_springs, only: spring_array
   use rbs_structure_channel, only: energy_type
   use rbs_structure_spring_place, only: flexure, axial
   use rbs_structure_structure, only: structure_type, finite
   implicit none
   private

   public :: row_check, on_the_end

   !> A spring this close to an end of its line, relative to the end, is on it. Not a tolerance of the
   !> solution: where a cycle returns to its peak, round-off would otherwise decide between outer and inner
   !> unloading.
   real(wp), parameter :: on_the_end = 1.0e-11_wp

   !> What a point may miss: of the displacement, in shares of what all springs contribute; of equilibrium, in
   !> shares of the forces; of work, in shares of the works; each the largest so far. Where Newton's method
   !> follows a curve, and work is an integral over it, place and work have limits of their own.
   real(wp), parameter :: of_place = 1.0e-12_wp, of_force = 1.0e-9_wp, of_work = 1.0e-9_wp
   real(wp), parameter :: of_place_on_curve = 1.0e-10_wp, of_work_on_curve = 1.0e-5_wp
   !> A way below this share of the height and a force below this share of the axial load have no digits to
   !> lose.
   real(wp), parameter :: no_digits = 1.0e-3_wp
   !> Way, in shares of the height, and rotation by which stiff springs have forces and works.
   real(wp), parameter :: no_way = 1.0e-6_wp
   !> Round-off of forces and works by the initial stiffness of the springs.
   real(wp), parameter :: digits = 1.0e-13_wp

   type :: row_check
      real(wp), private :: place = of_place, work = of_work
      !> Largest way of all springs, force and work so far [m, N, J]; the work that was missing at the start
      real(wp), private :: largest_place = 0.0_wp, largest_force = 0.0_wp, largest_work = 0.0_wp
      real(wp), private :: at_begin = 0.0_wp
      !> Displacement up to which these have been measured [m]
      real(wp), private :: farthest = 0.0_wp
      !> Force and work of the springs if they had their initial stiffness, the largest so far [N, J]
      real(wp), private :: stiff_force = 0.0_wp, stiff_work = 0.0_wp
      !> What a force of each spring is at the top: moments count by the height; those of axial springs not
      !> at all (springs)
      real(wp), allocatable, private :: share(:)
   contains
      procedure :: begin
      procedure :: look
   end type row_check

contains

   subroutine begin(self, structure, missing_work)
      class(row_check), intent(out) :: self
      class(structure_type), intent(in) :: structure
      real(wp), intent(in) :: missing_work
      real(wp) :: d
      integer :: i

      self%at_begin = missing_work
      self%largest_place = no_digits*structure%total_height
      self%largest_force = no_digits*maxval(abs(structure%constant_axial))
      allocate (self%share(size(structure%place)))
      do i = 1, size(self%share)
         self%share(i) = merge(1.0_wp/structure%total_height, 1.0_wp, structure%place(i)%kind == flexure)
         if (structure%place(i)%kind == axial) self%share(i) = 0.0_wp
         d = no_way*structure%total_height*self%share(i)
         self%stiff_force = max(self%stiff_force, structure%initial_stiffness(i)*d*self%share(i))
         self%stiff_work = self%stiff_work + structure%initial_stiffness(i)*d**2
      end do
      call see_parts(self, structure, no_way*structure%total_height)
      if (structure%kinematics /= finite) return
      self%place = of_place_on_curve
      self%work = of_work_on_curve
   end subroutine begin

   !> Forces and work of parts without springs, if they took all of a displacement.
   pure subroutine see_parts(self, structure, displacement)
      type(row_check), intent(inout) :: self
      class(structure_type), intent(in) :: structure
      real(wp), intent(in) :: displacement

      associate (force => structure%stiffest_part*abs(displacement))
         self%stiff_force = max(self%stiff_force, force)
         self%stiff_work = max(self%stiff_work, force*abs(displacement))
      end associate
   end subroutine see_parts

   !> Look at a point.
   subroutine look(self, structure, springs, displacement, force, unbalance, energy, on_ends, fault)
      class(row_check), intent(inout) :: self
      class(structure_type), intent(in) :: structure
      type(spring_array), intent(in) :: springs
      !> Of the top [m], and lateral force [N]; largest force that is out of balance; moments over the height
      !> [N]
      real(wp), intent(in) :: displacement, force, unbalance
      type(energy_type), intent(in) :: energy
      !> Whether springs were put on ends of their lines since the displacement was found
      logical, intent(in) :: on_ends
      !> What is wrong, for a message; not allocated if nothing is
      character(len=:), allocatable, intent(out) :: fault
      real(wp) :: there, gap, missing, place, ways, works, term
      integer :: i

      there = structure%top_displacement(springs%d)
      gap = abs(there - displacement)
      missing = energy%residual - self%at_begin
      place = self%place + merge(2.0_wp*on_the_end, 0.0_wp, on_ends)
      self%largest_force = max(self%largest_force, abs(force))
      self%largest_work = max(self%largest_work, abs(energy%input), abs(energy%spring), abs(energy%axial))
      if (abs(displacement) > self%farthest .or. wrong() > 0) then
         self%farthest = max(self%farthest, abs(displacement))
         ways = 0.0_wp
         works = 0.0_wp
         do i = 1, springs%count
            if (.not. self%share(i) > 0.0_wp) cycle
            ways = ways + abs(structure%arm(i)*springs%d(i))
            self%largest_force = max(self%largest_force, abs(springs%force(i))*self%share(i))
            term = structure%initial_stiffness(i)*abs(springs%d(i))
            self%stiff_force = max(self%stiff_force, term*self%share(i))
            works = works + term*abs(springs%d(i))
         end do
         call see_parts(self, structure, displacement)
         self%largest_place = max(self%largest_place, ways)
         self%stiff_work = max(self%stiff_work, works)
      end if
      select case (wrong())
      case (0)
         return
      case (1)
         fault = 'its joints move the top by '//to_text(there)//' m'
      case (2)
         fault = to_text(unbalance)//' N of its forces are out of balance'
      case default
         fault = to_text(missing)//' J of its work are missing'
      end select

   contains

      !> What misses more than round-off: place, forces, work; 0: nothing.
      pure integer function wrong()
         wrong = 0
         if (gap > place*self%largest_place) then
            wrong = 1
         else if (unbalance > of_force*self%largest_force + digits*self%stiff_force) then
            wrong = 2
         else if (abs(missing) > self%work*self%largest_work + digits*self%stiff_work) then
            wrong = 3
         end if
      end function wrong

   end subroutine look

end module rbs_solve_static_row_check
