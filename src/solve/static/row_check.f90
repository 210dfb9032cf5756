!> Whether a row of a static path is a state of the column: the top is where its joints are, each joint is in
!> equilibrium, and no work is missing. A path is found without tolerances, so that what a row may miss is
!> round-off; more means that the arithmetic could not carry the path on.
module rbs_solve_static_row_check
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_structure_column_column, only: column_type, finite
   use rbs_hysteresis_springs, only: spring_array
   use rbs_structure_spring_place, only: shear, flexure, axial
   implicit none
   private

   public :: row_check

   !> What a row may miss: of the displacement, in shares of what all joints contribute; of equilibrium, in
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
      !> Largest way of all joints, force and work so far [m, N, J]; the work that was missing at the start
      real(wp), private :: largest_place = 0.0_wp, largest_force = 0.0_wp, largest_work = 0.0_wp
      real(wp), private :: at_begin = 0.0_wp
      !> Force and work of the springs if they had their initial stiffness, the largest so far [N, J]
      real(wp), private :: stiff_force = 0.0_wp, stiff_work = 0.0_wp
   contains
      procedure :: begin
      procedure :: look
   end type row_check

contains

   subroutine begin(self, column, missing_work)
      class(row_check), intent(out) :: self
      class(column_type), intent(in) :: column
      real(wp), intent(in) :: missing_work

      self%at_begin = missing_work
      associate (k => column%initial_stiffness, way => no_way*column%joint_height(column%n + 1), &
                 slips => column%at(shear, :), turns => column%at(flexure, :))
         self%largest_place = no_digits*column%joint_height(column%n + 1)
         self%largest_force = no_digits*maxval(abs(column%compression))
         self%stiff_force = max(maxval(k(slips))*way, maxval(k(turns))*no_way**2/way)
         self%stiff_work = sum(k(slips))*way**2 + sum(k(turns))*no_way**2
      end associate
      if (column%kinematics /= finite) return
      self%place = of_place_on_curve
      self%work = of_work_on_curve
   end subroutine begin

   !> Look at a row.
   subroutine look(self, column, springs, displacement, force, unbalance, works, missing_work, fault)
      class(row_check), intent(inout) :: self
      class(column_type), intent(in) :: column
      type(spring_array), intent(in) :: springs
      !> Of the top [m], and lateral force [N]
      real(wp), intent(in) :: displacement, force
      !> Largest force that is out of balance; moments over the height [N]
      real(wp), intent(in) :: unbalance
      !> Works of which the balance consists, and what it misses [J]
      real(wp), intent(in) :: works(:), missing_work
      !> What is wrong, for a message; not allocated if nothing is
      character(len=:), allocatable, intent(out) :: fault
      real(wp) :: place, reach, term, stiff_work
      integer :: i

      place = 0.0_wp
      stiff_work = 0.0_wp
      self%largest_force = max(self%largest_force, abs(force))
      associate (height => column%joint_height(column%n + 1))
         do i = 1, size(column%place)
            if (column%place(i)%kind == axial) cycle
            reach = 1.0_wp
            if (column%place(i)%kind == flexure) reach = height
            place = place + abs(column%arm(i)*springs%d(i))
            self%largest_force = max(self%largest_force, abs(springs%force(i))/reach)
            term = column%initial_stiffness(i)*abs(springs%d(i))
            self%stiff_force = max(self%stiff_force, term/reach)
            stiff_work = stiff_work + term*abs(springs%d(i))
         end do
      end associate
      self%stiff_work = max(self%stiff_work, stiff_work)
      self%largest_place = max(self%largest_place, place)
      self%largest_work = max(self%largest_work, maxval(abs(works)))
      associate (there => column%top_displacement(springs%d))
         if (abs(there - displacement) > self%place*self%largest_place) then
            fault = 'its joints move the top by '//to_text(there)//' m'
         else if (unbalance > of_force*self%largest_force + digits*self%stiff_force) then
            fault = to_text(unbalance)//' N of its forces are out of balance'
         else if (abs(missing_work - self%at_begin) > self%work*self%largest_work &
                  + digits*self%stiff_work) then
            fault = to_text(missing_work - self%at_begin)//' J of its work are missing'
         end if
      end associate
   end subroutine look

end module rbs_solve_static_row_check
