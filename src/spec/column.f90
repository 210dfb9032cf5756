!> What the user asked of the column: geometry, mass, joints, axial load, damping.
module rbs_spec_column
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use rbs_base_kinds, only: wp
   use rbs_base_constants, only: unset, standard_gravity
   use rbs_base_error, only: message_list
   use rbs_base_text, only: to_text
   use rbs_base_check, only: check_positive, check_not_negative, check_finite, check_name
   use rbs_spec_spring, only: spring_spec
   use rbs_spec_spring_table, only: is_capped
   implicit none
   private

   public :: column_spec, kinematics_names, most_bodies, most_dense

   character(len=6), parameter :: kinematics_names(3) = ['small ', 'pdelta', 'finite']

   !> Every row holds four numbers or more for each body: more bodies are a slip of the pen.
   integer, parameter :: most_bodies = 10000

   !> What needs dense matrices (mode shapes, modal damping) takes seconds with this number of bodies and
   !> grows with its cube.
   integer, parameter :: most_dense = 500

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
      !> Whether the axial load, and the lateral force, turn with the top body (`finite` only)
      logical :: axial_follows = .false., force_follows = .false.
      !> Mass lumped at the top [kg] and its rotary inertia about the top [kg m2]; its weight belongs to
      !> the axial load
      real(wp) :: top_mass = 0.0_wp, top_inertia = 0.0_wp
      !> Depth of the section [m]: adds m depth^2/12 to the rotary inertia of every body
      real(wp) :: depth = 0.0_wp
      !> Rotary inertia of the bodies about their centroids, one for all or n [kg m2]; not allocated:
      !> m (l^2 + depth^2)/12
      real(wp), allocatable :: rotary_inertia(:)
      !> Damping in proportion to the mass [1/s]
      real(wp) :: mass_damping = 0.0_wp
      !> Damping in proportion to the stiffness of each joint [s]
      real(wp) :: stiffness_damping = 0.0_wp
      !> Whether that is the stiffness of the present line, else the initial one
      logical :: tangent_damping = .false.
      !> Damping ratios of the modes of the uncracked column: one for all, or those of the first ones
      real(wp), allocatable :: modal_damping(:)
      !> Shear springs: one for every joint, or n
      type(spring_spec), allocatable :: shear(:)
      !> Flexural springs: one for every joint, or n
      type(spring_spec), allocatable :: flexure(:)
      !> Axial springs, tension positive: one for every joint, or n; not allocated: joints do not open
      type(spring_spec), allocatable :: axial(:)
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
      if (self%kinematics /= 'finite' .and. (self%axial_follows .or. self%force_follows)) then
         call messages%add('column: a load that follows the top (axial_follows, force_follows) needs '// &
                           "kinematics = 'finite'; remove it or change the kinematics")
      end if
      call check_finite(self%axial_load, 'column: axial_load', 'N', messages)
      call check_not_negative(self%gravity, 'column: gravity', 'm/s2', messages)
      call check_inertia(self, messages)
      call check_not_negative(self%mass_damping, 'column: mass_damping', '1/s', messages)
      call check_not_negative(self%stiffness_damping, 'column: stiffness_damping', 's', messages)
      call check_modal_damping(self, messages)
      call check_springs(self%shear, 'shear', self%n, messages)
      call check_springs(self%flexure, 'flexure', self%n, messages)
      if (allocated(self%axial)) call check_springs(self%axial, 'axial', self%n, messages)
   end subroutine validate

   !> Lumped mass and rotary inertias; a body without inertia has no equation of motion.
   subroutine check_inertia(self, messages)
      type(column_spec), intent(in) :: self
      type(message_list), intent(inout) :: messages
      integer :: i
      logical :: given

      call check_not_negative(self%top_mass, 'column: top_mass', 'kg', messages)
      call check_not_negative(self%top_inertia, 'column: top_inertia', 'kg m2', messages)
      call check_not_negative(self%depth, 'column: depth', 'm', messages)
      if (.not. allocated(self%rotary_inertia)) return
      given = .false.
      if (ieee_is_finite(self%depth)) given = self%depth > 0.0_wp
      if (given) then
         call messages%add('column: both depth and rotary_inertia are given; keep the one that is meant')
      end if
      if (size(self%rotary_inertia) == 1) then
         call check_positive(self%rotary_inertia(1), 'column: rotary_inertia', 'kg m2', messages)
         return
      end if
      if (size(self%rotary_inertia) /= self%n) then
         call messages%add('column: rotary_inertia has '//to_text(size(self%rotary_inertia))// &
                           ' values for n = '//to_text(self%n)//' bodies; give one, or one for each')
      end if
      do i = 1, size(self%rotary_inertia)
         call check_positive(self%rotary_inertia(i), 'column: rotary_inertia('//to_text(i)//')', 'kg m2', &
                             messages)
      end do
   end subroutine check_inertia

   !> Modal damping: ratios below critical, and matrices that can be handled.
   subroutine check_modal_damping(self, messages)
      type(column_spec), intent(in) :: self
      type(message_list), intent(inout) :: messages
      character(len=:), allocatable :: name
      integer :: i, modes
      logical :: ok, given

      given = .false.
      if (ieee_is_finite(self%stiffness_damping)) given = self%stiffness_damping > 0.0_wp
      if (self%tangent_damping .and. .not. given) then
         call messages%add('column: tangent_damping has no meaning without stiffness_damping; give one')
      end if
      if (.not. allocated(self%modal_damping)) return
      modes = merge(3, 2, allocated(self%axial))*self%n
      if (size(self%modal_damping) > modes) then
         call messages%add('column: modal_damping has '//to_text(size(self%modal_damping))// &
                           ' values for '//to_text(modes)//' modes; give one for all, or one for each '// &
                           'of the first modes')
      end if
      do i = 1, size(self%modal_damping)
         name = 'column: modal_damping('//to_text(i)//')'
         call check_not_negative(self%modal_damping(i), name, '', messages, ok)
         if (ok .and. self%modal_damping(i) >= 1.0_wp) then
            call messages%add(name//' = '//to_text(self%modal_damping(i))//' must be below 1 (critical '// &
                              'damping); it is a ratio, not per cent')
         end if
      end do
      if (self%n > most_dense) then
         call messages%add('column: modal damping needs all modes, which are there for up to '// &
                           to_text(most_dense)//' bodies, not for n = '//to_text(self%n)// &
                           '; use mass and stiffness damping')
      end if
   end subroutine check_modal_damping

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
      if (.not. allocated(springs)) return
      if (name == 'axial' .and. any(is_lateral(springs%rule))) then
         i = findloc(is_lateral(springs%rule), .true., dim=1)
         call messages%add("column: an axial spring cannot be of the rule '"//trim(springs(i)%rule)// &
                           "'; it is elastic, bilinear, compression, concrete or steel")
      else if (name /= 'axial' .and. any(springs%rule == 'compression' .or. springs%rule == 'concrete')) then
         i = findloc(springs%rule == 'compression' .or. springs%rule == 'concrete', .true., dim=1)
         call messages%add('column: the '//name//" spring cannot be of the rule '"//trim(springs(i)%rule)// &
                           "', which is for axial springs and layers")
      else if (name == 'shear' .and. any(springs%rule == 'layered')) then
         call messages%add("column: a shear spring cannot be of the rule 'layered', which is for flexure")
      end if
   end subroutine check_springs

   !> Whether a rule is for bending and shear only.
   elemental logical function is_lateral(rule)
      character(len=*), intent(in) :: rule

      is_lateral = rule == 'takeda' .or. rule == 'layered' .or. is_capped(rule)
   end function is_lateral

end module rbs_spec_column
