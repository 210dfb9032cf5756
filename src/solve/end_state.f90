!> The state that an analysis ended in, from which another one begins: deformations of the structure, memory
!> of its springs, and numbers that let the solver continue with the same bits.
!>
!> It is one list of numbers. Its head has marks of the structure and a check sum of the rest, so that
!> it can pass through Python or a file.
module rbs_solve_end_state
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use, intrinsic :: iso_fortran_env, only: int64
   use rbs_base_error, only: error_type, fatal_error, analysis_failed, bad_input
   use rbs_base_key_visitor, only: key_visitor
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_base_text, only: to_text
   use rbs_hysteresis_interaction_joints, only: change_axial_loads
   use rbs_hysteresis_layered_layered_joint, only: layered_rule
   use rbs_hysteresis_rule, only: rule_type
   use rbs_hysteresis_springs, only: spring_array
   use rbs_structure_spring_location, only: spring_name
   use rbs_structure_structure, only: structure_type, signals
   implicit none
   private

   public :: end_state, checkpoint_type, stamp_of, static_state, moving_state

   !> Number of the format; it changes with the contents.
   integer, parameter :: format = 4

   !> Numbers of the head: format, two of the model, two of the rest, bodies, kinematics, springs.
   integer, parameter :: head = 8

   !> Kinds of analyses.
   integer, parameter :: static_state = 1, moving_state = 2

   !> State of a structure at the end of an analysis, as either kind of analysis takes it up.
   type :: checkpoint_type
      integer :: kind = 0
      !> Whether the axial loads of layered joints varied
      logical :: axial_load_varies = .false.
      !> Displacement of the top [m], lateral force [N], axial load at the top without the part that follows
      !> the force [N]
      real(wp) :: displacement = 0.0_wp, force = 0.0_wp, axial_load = 0.0_wp
      !> Axial forces at the springs, compression positive (springs) [N]; velocities of the position
      !> (coordinates), zero after a static path
      real(wp), allocatable :: axial_force(:), v(:)
      !> Works of loads and damping, energy at the start, residual of the balance [J]
      real(wp) :: input = 0.0_wp, damping = 0.0_wp, at_begin = 0.0_wp, residual = 0.0_wp
      !> Kinetic energy that the velocities of the joints do not show [J]
      real(wp) :: along_joints = 0.0_wp
      !> The clock: where its counting began, where it is now, and the way between as the steps counted it [s]
      real(wp) :: begin = 0.0_wp, clock = 0.0_wp, time = 0.0_wp
      !> Loads at the end; the step [s], steps from `origin` where they do not follow the times of the loading
      real(wp) :: load(signals) = 0.0_wp, dt = 0.0_wp, origin = 0.0_wp
      integer :: offset = 0
      !> The method, and the setting that it has; those of another need not match
      integer :: method = 0
      real(wp) :: setting = 0.0_wp
   contains
      procedure :: serialize => serialize_checkpoint, put_under
   end type checkpoint_type

   type :: end_state
      type(stream_type) :: stream
   contains
      procedure :: is_given, start_saving, finish_saving, restore, check
   end type end_state

contains

   !> Whether there is a state.
   pure logical function is_given(self)
      class(end_state), intent(in) :: self

      is_given = self%stream%count > 0
   end function is_given

   !> Save or restore all components, whichever the stream is set to.
   pure subroutine serialize_checkpoint(self, stream)
      class(checkpoint_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%item(self%kind)
      call stream%item(self%axial_load_varies)
      call stream%items(self%displacement, self%force, self%axial_load)
      call stream%item(self%axial_force)
      call stream%item(self%v)
      call stream%items(self%input, self%damping, self%at_begin, self%residual, self%along_joints, &
                        self%begin, self%clock, self%time)
      call stream%item(self%load)
      call stream%item(self%dt)
      call stream%item(self%origin)
      call stream%item(self%offset)
      call stream%item(self%method)
      call stream%item(self%setting)
   end subroutine serialize_checkpoint

   !> Begin a state with the part common to all analyses. The memory of the solver follows.
   subroutine start_saving(self, structure, checkpoint, springs)
      class(end_state), intent(inout) :: self
      class(structure_type), intent(in) :: structure
      type(checkpoint_type), intent(inout) :: checkpoint
      type(spring_array), intent(inout) :: springs
      real(wp) :: first(head)

      ! Places 4 and 5 are for the check sum, which `finish_saving` puts there.
      first = 0.0_wp
      first(1) = format
      first(2:3) = stamp_of(structure)
      first(6) = structure%n
      first(7) = structure%kinematics
      first(8) = size(structure%location)
      call self%stream%save()
      call self%stream%item(first)
      call checkpoint%serialize(self%stream)
      call springs%serialize(self%stream)
   end subroutine start_saving

   !> The state is whole: put its check sum into the head. A state with a number that is not finite is
   !> dropped, since no analysis could begin in it.
   subroutine finish_saving(self)
      class(end_state), intent(inout) :: self

      if (.not. all(ieee_is_finite(self%stream%value(:self%stream%count)))) then
         ! An empty stream is no state.
         self%stream%count = 0
         return
      end if
      call find_check_sum(self%stream%value(head + 1:self%stream%count), self%stream%value(4:5))
   end subroutine finish_saving

   !> Whether an analysis of a structure can begin from the state.
   subroutine check(self, structure, error)
      class(end_state), intent(in) :: self
      class(structure_type), intent(in) :: structure
      type(error_type), allocatable, intent(out) :: error
      character(len=*), parameter :: kinematics(3) = [character(len=6) :: 'small', 'pdelta', 'finite']
      real(wp) :: expected(2)

      associate (value => self%stream%value, count => self%stream%count)
         if (count <= head) then
            call fatal_error(error, bad_input, 'initial: this is no state of an analysis, or it is '// &
                             'damaged; run the first analysis again')
            return
         end if
         ! A check sum is never negative: with a number that is not finite none fits.
         expected = -1.0_wp
         if (all(ieee_is_finite(value(:count)))) call find_check_sum(value(head + 1:count), expected)
         if (abs(value(1) - format) > 0.0_wp .and. ieee_is_finite(value(1))) then
            call fatal_error(error, bad_input, 'initial: the state was written by a version of rbsdem '// &
                             'whose springs remember other things (format '//to_text(value(1))//', here '// &
                             to_text(format)//'); run the first analysis again with this version')
         else if (any(abs(expected - value(4:5)) > 0.0_wp)) then
            call fatal_error(error, bad_input, 'initial: the state is damaged, its numbers do not add up '// &
                             'to what its head says; run the first analysis again')
         else if (nint(value(6)) /= structure%n) then
            call fatal_error(error, bad_input, 'initial: the state belongs to a column of n = '// &
                             to_text(nint(value(6)))//' bodies, this one has n = '//to_text(structure%n)// &
                             '; begin from a result of the same column')
         else if (nint(value(7)) /= structure%kinematics) then
            call fatal_error(error, bad_input, "initial: the state is one of kinematics = '"// &
                             trim(kinematics(min(max(nint(value(7)), 1), 3)))//"', this column has '"// &
                             trim(kinematics(structure%kinematics))//"', under which it would not be in "// &
                             'equilibrium; run both analyses with the same kinematics')
         else
            expected = stamp_of(structure)
            if (all(abs(expected - value(2:3)) <= 0.0_wp)) return
            call fatal_error(error, bad_input, 'initial: the state belongs to a column with other '// &
                             'springs or lengths; begin from a result of the same column (loading, '// &
                             'method, axial load, mass and damping may be others)')
         end if
      end associate
   end subroutine check

   !> Restore the part common to all analyses; springs are those of the structure, virgin. The memory of the
   !> solver comes next in the stream.
   subroutine restore(self, structure, checkpoint, springs, error)
      class(end_state), intent(inout) :: self
      class(structure_type), intent(in) :: structure
      type(checkpoint_type), intent(out) :: checkpoint
      type(spring_array), intent(inout) :: springs
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: first(head)

      call self%check(structure, error)
      if (allocated(error)) return
      allocate (checkpoint%axial_force(size(structure%location)), checkpoint%v(structure%coordinates), &
                source=0.0_wp)
      call self%stream%restore()
      call self%stream%item(first)
      call checkpoint%serialize(self%stream)
      call springs%serialize(self%stream)
      if (self%stream%broken) then
         call fatal_error(error, bad_input, 'initial: the state was written by a version of rbsdem whose '// &
                          'springs remember other things; run the first analysis again with this version')
      end if
   end subroutine restore

   !> Two numbers that differ between structures with other springs or sizes: a hash of the lengths and of the
   !> rules with their parameters, or the two numbers that the structure keeps, if it does.
   function stamp_of(structure) result(stamp)
      class(structure_type), intent(in) :: structure
      real(wp) :: stamp(2)
      integer(int64) :: hash
      integer :: i, seen

      if (any(structure%stamp > 0.0_wp)) then
         stamp = structure%stamp
         return
      end if
      ! Any seed but 0 serves.
      hash = 88172645463325252_int64
      seen = 0
      do i = 1, size(structure%length)
         call mix(hash, structure%length(i))
      end do
      do i = 1, size(structure%rules%of)
         associate (of => structure%rules%of(i))
            call mix(hash, real(of, wp))
            ! Springs in a row with the same rule need its parameters once.
            if (of == seen) cycle
            seen = of
            call mix_rule(hash, structure%rules%name(of), structure%rules%list(of)%rule)
         end associate
      end do
      call split(hash, stamp)
   end function stamp_of

   !> Mix the name of a rule and its parameters into a hash, those of the layers of a joint too.
   recursive subroutine mix_rule(hash, name, rule)
      !> The hash, which gets the parameters
      integer(int64), intent(inout) :: hash
      character(len=*), intent(in) :: name
      class(rule_type), intent(in) :: rule
      class(rule_type), allocatable :: visited
      type(key_visitor) :: parameters
      integer :: i

      do i = 1, len_trim(name)
         call mix(hash, real(iachar(name(i:i)), wp))
      end do
      ! The defaults that a visit collects are the parameters, given or not.
      allocate (visited, source=rule)
      call parameters%collect(name)
      call visited%visit(parameters)
      do i = 1, parameters%count
         call mix(hash, parameters%keys(i)%default)
      end do
      select type (rule)
      type is (layered_rule)
         do i = 1, size(rule%y)
            call mix(hash, rule%y(i))
            call mix(hash, rule%weight(i))
            call mix(hash, real(rule%rule_of(i), wp))
         end do
         do i = 1, size(rule%rule)
            call mix_rule(hash, '', rule%rule(i)%rule)
         end do
      end select
   end subroutine mix_rule

   !> Check sum of a list, two whole numbers, by which a state that was changed or cut off is refused.
   pure subroutine find_check_sum(value, total)
      real(wp), intent(in) :: value(:)
      !> Two halves of a hash
      real(wp), intent(out) :: total(2)
      integer(int64) :: hash
      integer :: i

      ! Any seed but 0 serves.
      hash = 1442695040888963407_int64
      do i = 1, size(value)
         call mix(hash, value(i))
      end do
      call split(hash, total)
   end subroutine find_check_sum

   !> Mix a number into a hash by Marsaglia's xorshift (J. Stat. Softw. 8 (2003) 14), which has no overflow.
   pure subroutine mix(hash, x)
      !> The hash, which gets the number
      integer(int64), intent(inout) :: hash
      real(wp), intent(in) :: x

      ! Adding zero makes -0 the same as 0.
      hash = ieor(hash, transfer(x + 0.0_wp, hash))
      hash = ieor(hash, ishft(hash, 13))
      hash = ieor(hash, ishft(hash, -7))
      hash = ieor(hash, ishft(hash, 17))
   end subroutine mix

   !> A hash as two whole numbers that reals hold exactly.
   pure subroutine split(hash, parts)
      integer(int64), intent(in) :: hash
      real(wp), intent(out) :: parts(2)

      parts(1) = real(ibits(hash, 0, 32), wp)
      parts(2) = real(ibits(hash, 32, 32), wp)
   end subroutine split

   !> Put the springs that were restored under the axial forces with which the next analysis begins.
   subroutine put_under(self, structure, axial_force, springs, error)
      class(checkpoint_type), intent(in) :: self
      class(structure_type), intent(in) :: structure
      !> Compression positive (springs) [N]
      real(wp), intent(in) :: axial_force(:)
      type(spring_array), intent(inout) :: springs
      type(error_type), allocatable, intent(inout) :: error
      integer :: crushed_joint

      call change_axial_loads(springs, axial_force, self%axial_load_varies)
      crushed_joint = springs%crushed_joint()
      if (crushed_joint == 0) return
      call fatal_error(error, analysis_failed, 'initial: the layers of '// &
                       trim(spring_name(structure%location(crushed_joint)))//' cannot carry the axial '// &
                       'load of '//to_text(axial_force(crushed_joint))//' N in the state that the first '// &
                       'analysis ended in; give a smaller axial_load')
   end subroutine put_under

end module rbs_solve_end_state
