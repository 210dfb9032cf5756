!> Input of a column: geometry, mass, joints, axial load, damping.
module rbs_structure_column_column_record
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use rbs_base_check, only: is_given
   use rbs_base_constants, only: unset, standard_gravity
   use rbs_base_error, only: message_list
   use rbs_base_key_visitor, only: key_visitor, visited_record
   use rbs_base_keys, only: bound_type, any_number, above_zero, not_negative
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text, list_of
   use rbs_base_tolerances, only: same_input
   use rbs_hysteresis_registry, only: rule_names, suits
   use rbs_hysteresis_rule, only: in_shear, in_flexure, in_axial
   use rbs_hysteresis_spring_record, only: spring_record
   implicit none
   private

   public :: column_record, damping_record, most_bodies, most_dense, most_modes

   character(len=*), parameter :: kinematics_names = 'small pdelta finite'
   character(len=*), parameter :: top_names = 'free fixed'

   !> Every row holds four numbers or more for each body: more bodies are a slip of the pen.
   integer, parameter :: most_bodies = 10000

   !> Modal damping, and all modes at once, take seconds with this number of bodies, a time that grows with
   !> its cube.
   integer, parameter :: most_dense = 500

   !> A column that takes modal damping has no more modes, head and footing included.
   integer, parameter :: most_modes = 3*(most_dense + 2)

   !> Damping ratios are below critical.
   type(bound_type), parameter :: ratio = &
      bound_type(0.0_wp, 1.0_wp, most_open=.true., reason='(critical); it is a ratio, not per cent')

   !> Viscous damping.
   type, extends(visited_record) :: damping_record
      !> In proportion to the mass [1/s], and to the stiffness of each joint [s]
      real(wp) :: mass = 0.0_wp, stiffness = 0.0_wp
      !> Whether that is the stiffness of the present line, else the initial one
      logical :: tangent = .false.
      !> Damping ratios of the modes of the uncracked column: one for all, or those of the first ones
      real(wp), allocatable :: modal(:)
   contains
      procedure :: visit => visit_damping
   end type damping_record

   !> A column of `n` rigid bodies; joint i is at the bottom of body i, counted from the ground. Where the
   !> top is fixed against rotation, joint n + 1 is between body n and its support; joint 0 is that
   !> beneath a footing, and joint 1 is on top of it.
   type, extends(visited_record) :: column_record
      integer :: n = 1
      real(wp) :: height = unset, mass = unset
      !> Lengths [m] and masses [kg] of the bodies (n); not allocated: all lengths equal, masses in
      !> proportion to the lengths
      real(wp), allocatable :: lengths(:), masses(:)
      character(len=16) :: kinematics = 'small'
      !> At the top, compression positive [N]; how it follows the lateral force on a static path: N =
      !> axial_load + axial_force_ratio F
      real(wp) :: axial_load = 0.0_wp, axial_force_ratio = 0.0_wp
      !> Height at which the axial load acts [m]; `unset`: at the top
      real(wp) :: axial_height = unset
      !> Whether the weight of the bodies acts, and acceleration of gravity [m/s2]; mass [kg] and rotary
      !> inertia [kg m2] lumped at the top
      logical :: self_weight = .false.
      real(wp) :: gravity = standard_gravity
      real(wp) :: top_mass = 0.0_wp, top_inertia = 0.0_wp
      !> 'free', or 'fixed' against rotation
      character(len=16) :: top = 'free'
      !> Whether there is a footing, that is, whether springs are given for joint 0
      logical :: footing = .false.
      !> Whether its springs, but for those beneath a footing, and its mass are made of its section by Python
      logical :: drawn = .false.
      !> Mass [kg], rotary inertia about the centroid [kg m2] and height [m] of the footing; depth of the
      !> section [m]
      real(wp) :: footing_mass = 0.0_wp, footing_inertia = 0.0_wp, footing_height = 0.0_wp, depth = 0.0_wp
      !> Rotary inertia of the bodies, one for all or n; not allocated: m (l^2 + depth^2)/12 [kg m2]
      real(wp), allocatable :: rotary_inertia(:)
      !> Which model made the column, and the version of its parameters; for the record only
      character(len=64) :: model = ''
      type(damping_record) :: damping
      !> The springs, one for every joint or one for each from the ground up; with a footing always one for
      !> each. Axial ones are tension positive, without them joints do not open
      type(spring_record), allocatable :: shear(:), flexure(:), axial_spring(:)
   contains
      procedure :: visit, validate, joints, joint_number
   end type column_record

contains

   !> The keys of a column.
   subroutine visit(self, v)
      class(column_record), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%key('n', self%n, '', bound_type(1.0_wp, real(most_bodies, wp)), 'number of rigid bodies')
      call v%key('height', self%height, 'm', above_zero, 'height of the column')
      call v%key('mass', self%mass, 'kg', above_zero, &
                 'mass of the column, in proportion to the lengths; not needed with masses, or with '// &
                 'a section alone', &
                 optional=allocated(self%masses) .or. self%drawn)
      call v%key('lengths', self%lengths, 'm', above_zero, &
                 'lengths of the bodies from the ground up; without them all are equal', most_bodies)
      call v%key('masses', self%masses, 'kg', above_zero, 'masses of the bodies from the ground up', &
                 most_bodies)
      call v%word('kinematics', self%kinematics, &
                  'small rotations, the same with second-order work of the axial load, or exact rotations', &
                  kinematics_names)
      call v%key('axial_load', self%axial_load, 'N', any_number, &
                 'axial load at the top, compression positive')
      call v%key('axial_force_ratio', self%axial_force_ratio, '', any_number, 'change of the axial load '// &
                 'per lateral force on a static path, as in the exterior column of a frame')
      call v%key('axial_height', self%axial_height, 'm', above_zero, 'height at which the axial load '// &
                 'acts and leans with the column (pdelta); by default the top', optional=.true.)
      call v%key('self_weight', self%self_weight, 'whether the weight of the bodies acts')
      call v%key('gravity', self%gravity, 'm/s2', not_negative, 'acceleration of gravity for the weight')
      call v%key('top_mass', self%top_mass, 'kg', not_negative, &
                 'mass lumped at the top; its weight belongs to the axial load')
      call v%key('top_inertia', self%top_inertia, 'kg m2', not_negative, 'its rotary inertia about the top')
      call v%word('top', self%top, 'whether the top can turn, or is fixed against rotation', top_names)
      call v%key('footing_mass', self%footing_mass, 'kg', not_negative, &
                 'mass of the footing, which stands on the springs of joint 0')
      call v%key('footing_inertia', self%footing_inertia, 'kg m2', not_negative, &
                 'its rotary inertia about its centroid')
      call v%key('footing_height', self%footing_height, 'm', not_negative, &
                 'height of the footing, between joint 0 and joint 1')
      call v%key('depth', self%depth, 'm', not_negative, &
                 'depth of the section: adds m depth^2/12 to the rotary inertia of every body')
      call v%key('rotary_inertia', self%rotary_inertia, 'kg m2', above_zero, &
                 'rotary inertia about the centroid, one for all bodies or one for each', most_bodies)
      call v%word('model', self%model, 'model and version that made the column; kept for the record')
   end subroutine visit

   !> The keys of the damping.
   subroutine visit_damping(self, v)
      class(damping_record), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%key('mass', self%mass, '1/s', not_negative, 'damping in proportion to the mass')
      call v%key('stiffness', self%stiffness, 's', not_negative, &
                 'damping in proportion to the stiffness of each joint')
      call v%key('tangent', self%tangent, &
                 'whether that is the stiffness of the present line, else the initial one')
      call v%key('modal', self%modal, '', ratio, &
                 'damping ratios: one for all modes, or one for each of the first modes', most_modes)
   end subroutine visit_damping

   !> Number of joints: one at the bottom of each body, one at a fixed top, one beneath a footing.
   pure integer function joints(self)
      class(column_record), intent(in) :: self

      ! `validate` refuses more bodies; before that no more joints are counted or placed.
      joints = min(self%n, most_bodies) + merge(1, 0, self%top == 'fixed') + merge(1, 0, self%footing)
   end function joints

   !> Number by which a joint is known: from 1 at the bottom of the column, 0 beneath a footing.
   elemental integer function joint_number(self, i)
      class(column_record), intent(in) :: self
      !> From 1 at the ground
      integer, intent(in) :: i

      joint_number = i - merge(1, 0, self%footing)
   end function joint_number

   !> Add a message for everything that is wrong with the column.
   subroutine validate(self, messages)
      class(column_record), intent(inout) :: self
      type(message_list), intent(inout) :: messages

      call self%check('column', messages)
      if (allocated(self%lengths)) call check_count('lengths', size(self%lengths), self%n)
      if (allocated(self%masses)) call check_count('masses', size(self%masses), self%n)
      if (allocated(self%lengths)) call check_sum()
      call check_axial_height()
      call check_inertia()
      if (self%top == 'fixed' .and. self%top_inertia > 0.0_wp) then
         call messages%add('column: top_inertia = '//to_text(self%top_inertia)//' kg m2 has no effect '// &
                           "with top = 'fixed', as the top does not turn; remove it")
      end if
      if (.not. self%footing .and. &
          any([self%footing_mass, self%footing_inertia, self%footing_height] > 0.0_wp)) then
         call messages%add('column: footing_mass, footing_inertia and footing_height need springs '// &
                           'beneath the footing; give &shear and &flexure with joint = 0 (Python: '// &
                           'footing=), or remove them')
      end if
      call self%damping%check('damping', messages)
      call check_damping()
      call check_springs(self%shear, 'shear', in_shear)
      call check_springs(self%flexure, 'flexure', in_flexure)
      if (allocated(self%axial_spring)) then
         call check_springs(self%axial_spring, 'axial', in_axial)
      end if

   contains

      !> Refuse a height of the axial load where it has no effect: it acts by second-order moments alone.
      subroutine check_axial_height()

         if (.not. ieee_is_finite(self%axial_height)) return
         if (.not. is_given(self%axial_height)) return
         if (self%footing .or. self%top == 'fixed') then
            call messages%add('column: axial_height is the lever of the load on a cantilever; remove it, '// &
                              'or the footing and the fixed top')
         else if (self%kinematics /= 'pdelta') then
            call messages%add("column: axial_height needs kinematics = 'pdelta', not '"// &
                              trim(self%kinematics)//"'; remove it or change the kinematics")
         else if (allocated(self%axial_spring)) then
            call messages%add('column: axial_height cannot stand with axial springs; remove one of them')
         end if
      end subroutine check_axial_height

      !> Refuse two statements on rotary inertia, and a number of values that is neither 1 nor n.
      subroutine check_inertia()
         logical :: given

         if (.not. allocated(self%rotary_inertia)) return
         given = .false.
         if (ieee_is_finite(self%depth)) given = self%depth > 0.0_wp
         if (given) then
            call messages%add('column: both depth and rotary_inertia are given; keep the one that is meant')
         end if
         if (size(self%rotary_inertia) /= 1 .and. size(self%rotary_inertia) /= self%n) then
            call messages%add('column: rotary_inertia has '//to_text(size(self%rotary_inertia))// &
                              ' values for n = '//to_text(self%n)//' bodies; give one, or one for each')
         end if
      end subroutine check_inertia

      !> Refuse tangent damping without stiffness damping, more damping ratios than modes, and modal damping
      !> of too many bodies.
      subroutine check_damping()
         integer :: modes
         logical :: given

         given = .false.
         if (ieee_is_finite(self%damping%stiffness)) given = self%damping%stiffness > 0.0_wp
         if (self%damping%tangent .and. .not. given) then
            call messages%add('damping: tangent has no meaning without stiffness; give one')
         end if
         if (.not. allocated(self%damping%modal)) return
         ! Each joint has two or three unknowns; the top that is held does not turn.
         modes = merge(3, 2, allocated(self%axial_spring))*self%joints() - merge(1, 0, self%top == 'fixed')
         if (size(self%damping%modal) > modes) then
            call messages%add('damping: modal has '//to_text(size(self%damping%modal))//' values for '// &
                              to_text(modes)//' modes; give one for all, or one for each of the first modes')
         end if
         if (self%n > most_dense) then
            call messages%add('damping: modal damping needs all modes, which are there for up to '// &
                              to_text(most_dense)//' bodies, not for n = '//to_text(self%n)// &
                              '; use mass and stiffness damping')
         end if
      end subroutine check_damping

      !> Lengths and masses: one for each body.
      subroutine check_count(name, count, n)
         !> Key, number of its values, number of bodies
         character(len=*), intent(in) :: name
         integer, intent(in) :: count, n

         if (count == n) return
         call messages%add('column: '//name//' has '//to_text(count)//' values for n = '//to_text(n)// &
                           ' bodies; give one for each')
      end subroutine check_count

      !> Refuse lengths that do not add up to the height.
      subroutine check_sum()
         real(wp) :: total

         if (.not. ieee_is_finite(self%height) .or. .not. all(ieee_is_finite(self%lengths))) return
         if (.not. self%height > 0.0_wp) return
         total = sum(self%lengths)
         if (abs(total - self%height) > same_input*self%height) then
            call messages%add('column: the lengths add up to '//to_text(total)//' m, the height is '// &
                              to_text(self%height)//' m; make them equal')
         end if
      end subroutine check_sum

      !> Check the springs of one direction: their number, and each of them.
      subroutine check_springs(springs, name, place)
         type(spring_record), intent(in), allocatable :: springs(:)
         !> Word of messages, as 'shear'; place of the springs: `in_shear`, `in_flexure` or `in_axial`
         character(len=*), intent(in) :: name, place
         integer :: i

         ! Of a drawn column only the springs beneath a footing are given; Python makes the others.
         if (self%drawn) then
            if (allocated(springs)) call check_spring(springs(1), name//' spring of joint 0', name, place)
         else if (.not. allocated(springs)) then
            call messages%add('column: the '//name//' spring is missing; give one for every joint')
         else if (size(springs) == 1 .and. .not. self%footing) then
            call check_spring(springs(1), name//' spring', name, place)
         else if (size(springs) /= self%joints()) then
            call messages%add('column: '//to_text(size(springs))//' '//name//' springs for '// &
                              to_text(self%joints())//' joints; give one, or one for each joint')
         else
            do i = 1, size(springs)
               ! Equal springs have equal faults; they get one message.
               if (i > 1) then
                  if (springs(i)%same_as(springs(i - 1))) cycle
               end if
               call check_spring(springs(i), name//' spring of joint '//to_text(self%joint_number(i)), name, &
                                 place)
            end do
         end if
      end subroutine check_springs

      !> Check the values of a spring, and that its rule may be used in its place.
      subroutine check_spring(spring, full_name, name, place)
         type(spring_record), intent(in) :: spring
         !> The spring and its joint, for messages; direction, for messages, and place
         character(len=*), intent(in) :: full_name, name, place
         character(len=:), allocatable :: from

         call spring%where_given(from)
         call spring%validate(from//full_name, messages)
         ! An unknown rule has its message from the spring.
         if (suits(spring%rule, place) .or. .not. any(rule_names == spring%rule)) return
         call messages%add(from//'column: the '//name//" spring cannot be of the rule '"// &
                           trim(spring%rule)//"'; it is one of "// &
                           list_of(pack(rule_names, suits(rule_names, place))))
      end subroutine check_spring

   end subroutine validate

end module rbs_structure_column_column_record
