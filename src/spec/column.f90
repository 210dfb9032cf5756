!> What the user asked of the column: geometry, mass, joints, axial load, damping.
module rbs_spec_column
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use rbs_base_kinds, only: wp
   use rbs_base_constants, only: unset, standard_gravity
   use rbs_base_error, only: message_list
   use rbs_base_text, only: to_text
   use rbs_spec_check, only: check_positive, check_not_negative, check_finite, check_name
   use rbs_spec_spring, only: spring_spec
   implicit none
   private

   public :: column_spec, kinematics_names, most_bodies

   character(len=6), parameter :: kinematics_names(3) = ['small ', 'pdelta', 'finite']

   !> The solvers work on dense matrices of twice this size at the most; their modes take seconds.
   integer, parameter :: most_bodies = 500

   !> A column of `n` rigid bodies; joint i is at the bottom of body i, counted from the ground.
   type :: column_spec
      !> Number of rigid bodies
      integer :: n = 1
      !> Height of the column [m]
      real(wp) :: height = unset
      !> Mass of the column [kg]
      real(wp) :: mass = unset
      !> Lengths of the bodies (n) [m]; not allocated: all equal
      real(wp), allocatable :: lengths(:)
      !> Masses of the bodies (n) [kg]; not allocated: in proportion to the lengths
      real(wp), allocatable :: masses(:)
      !> Level of kinematics, one of `kinematics_names`
      character(len=16) :: kinematics = 'small'
      !> Axial load at the top, compression positive [N]
      real(wp) :: axial_load = 0.0_wp
      !> Whether the weight of the bodies acts
      logical :: self_weight = .false.
      !> Acceleration of gravity for the weight [m/s2]
      real(wp) :: gravity = standard_gravity
      !> Damping in proportion to the mass [1/s]
      real(wp) :: mass_damping = 0.0_wp
      !> Damping in proportion to the initial stiffness of each joint [s]
      real(wp) :: stiffness_damping = 0.0_wp
      !> Shear springs: one for every joint, or n
      type(spring_spec), allocatable :: shear(:)
      !> Flexural springs: one for every joint, or n
      type(spring_spec), allocatable :: flexure(:)
   contains
      procedure :: validate
   end type column_spec

contains

   !> Add a message for everything that is wrong with the column.
   subroutine validate(self, messages)
      class(column_spec), intent(in) :: self
      type(message_list), intent(inout) :: messages
      integer :: place
      logical :: ok

      if (self%n < 1 .or. self%n > most_bodies) then
         call messages%add('column: n = '//to_text(self%n)//' bodies; it must be from 1 to '// &
                           to_text(most_bodies))
      end if
      call check_positive(self%height, 'column: height', 'm', messages, ok)
      if (allocated(self%lengths)) call check_parts(self%lengths, 'lengths', 'm', self%n, messages)
      if (allocated(self%lengths) .and. ok) call check_sum(self, messages)
      if (allocated(self%masses)) then
         call check_parts(self%masses, 'masses', 'kg', self%n, messages)
      else
         call check_positive(self%mass, 'column: mass', 'kg', messages)
      end if
      call check_name(self%kinematics, kinematics_names, 'column: kinematics', messages, place)
      if (self%kinematics == 'finite' .and. self%n > 1) then
         call messages%add("column: kinematics = 'finite' is there for n = 1 only, not for n = "// &
                           to_text(self%n)//"; use 'pdelta' or one body")
      end if
      call check_finite(self%axial_load, 'column: axial_load', 'N', messages)
      call check_not_negative(self%gravity, 'column: gravity', 'm/s2', messages)
      call check_not_negative(self%mass_damping, 'column: mass_damping', '1/s', messages)
      call check_not_negative(self%stiffness_damping, 'column: stiffness_damping', 's', messages)
      call check_springs(self%shear, 'shear', self%n, messages)
      call check_springs(self%flexure, 'flexure', self%n, messages)
   end subroutine validate

   !> Lengths or masses: n positive numbers.
   subroutine check_parts(parts, name, unit, n, messages)
      real(wp), intent(in) :: parts(:)
      character(len=*), intent(in) :: name, unit
      integer, intent(in) :: n
      type(message_list), intent(inout) :: messages
      integer :: i

      if (size(parts) /= n) then
         call messages%add('column: '//name//' has '//to_text(size(parts))//' values for n = '// &
                           to_text(n)//' bodies; give one for each')
      end if
      do i = 1, size(parts)
         call check_positive(parts(i), 'column: '//name//'('//to_text(i)//')', unit, messages)
      end do
   end subroutine check_parts

   subroutine check_sum(self, messages)
      type(column_spec), intent(in) :: self
      type(message_list), intent(inout) :: messages
      real(wp) :: total

      if (.not. all(ieee_is_finite(self%lengths))) return
      total = sum(self%lengths)
      if (abs(total - self%height) > 1.0e-9_wp*self%height) then
         call messages%add('column: the lengths add up to '//to_text(total)//' m, the height is '// &
                           to_text(self%height)//' m; make them equal')
      end if
   end subroutine check_sum

   subroutine check_springs(springs, name, n, messages)
      type(spring_spec), intent(in), allocatable :: springs(:)
      character(len=*), intent(in) :: name
      integer, intent(in) :: n
      type(message_list), intent(inout) :: messages
      integer :: i

      if (.not. allocated(springs)) then
         call messages%add('column: the '//name//' spring is missing; give one for every joint')
      else if (size(springs) == 1) then
         call springs(1)%validate(name//' spring', messages)
      else if (size(springs) /= n) then
         call messages%add('column: '//to_text(size(springs))//' '//name//' springs for '// &
                           to_text(n)//' joints; give one, or one for each joint')
      else
         do i = 1, size(springs)
            call springs(i)%validate(name//' spring of joint '//to_text(i), messages)
         end do
      end if
   end subroutine check_springs

end module rbs_spec_column
