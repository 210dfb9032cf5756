!> What holds for every rule in the registry, with random parameters on random paths (`any_rule`).
module test_rules
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   use, intrinsic :: iso_fortran_env, only: int64
   use any_rule, only: detours, loops, detour_result, loop_result, random_spring, random_path, yield_of
   use check, only: unit_test, check_close, check_equal, check_same, check_true
   use rbs_base_check, only: is_given
   use rbs_base_error, only: error_type
   use rbs_base_keys, only: key_type
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_hysteresis_registry, only: keys_of, rule_names
   use rbs_hysteresis_spring_record, only: spring_record
   use rbs_hysteresis_springs, only: follow_path, spring_array
   use samples, only: make_springs, random_type
   implicit none
   private

   public :: collect_rules

   !> Rules that depend on their path discontinuously: Takeda's at a former peak and where the force is zero
   !> (docs/takeda.md), and a joint whose layers soften.
   character(len=*), parameter :: exceptions(*) = [character(len=16) :: 'takeda', 'layered']

contains

   subroutine collect_rules(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('a detour of size e changes later forces by 10 k e at most', &
                         continuous), &
               unit_test('property 9: no loop and no path gives energy', dissipative), &
               unit_test('property 3: forces are continuous where lines meet', lines_meet), &
               unit_test('property 2: 1, 7, 1000 increments, to the last bit', increments), &
               unit_test('property 13: copies and trial moves leave no trace', trials), &
               unit_test('what a spring remembers is all that it goes on by', resumes)]
   end subroutine collect_rules

   subroutine continuous(error)
      type(error_type), allocatable, intent(inout) :: error
      type(detour_result) :: found
      integer :: i

      do i = 1, size(rule_names)
         if (any(exceptions == rule_names(i))) cycle
         call detours(trim(rule_names(i)), 600, found)
         call check_true(error, all(found%largest <= 10.0_wp), trim(rule_names(i)))
      end do
   end subroutine continuous

   subroutine dissipative(error)
      type(error_type), allocatable, intent(inout) :: error
      type(loop_result) :: found
      integer :: i, histories

      do i = 1, size(rule_names)
         histories = 400
         if (rule_names(i) == 'layered') histories = 60
         call loops(trim(rule_names(i)), histories, found)
         call check_true(error, found%virgin >= -1.0e-12_wp, trim(rule_names(i))//': virgin')
         call check_true(error, found%closed >= -1.0e-9_wp, trim(rule_names(i))//': work of closed loops')
         call check_true(error, found%loops > 0, trim(rule_names(i))//': some loops close')
      end do
   end subroutine dissipative

   !> Across every event the force stays, the deformation is between the ends of its line, and no line is
   !> steeper than the first one.
   subroutine lines_meet(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_record) :: spec
      type(spring_array) :: spring
      real(wp) :: d(24), k, before
      integer :: rule, history, j, s, lines

      do rule = 1, size(rule_names)
         do history = 1, merge(10, 300, rule_names(rule) == 'layered')
            call random_history(trim(rule_names(rule)), history, spec, d)
            call make_springs(spring, [spec])
            k = spec%initial_stiffness()
            ! The mean of both sides, of which one may carry nothing.
            if (has_one_side(spec)) k = 2.0_wp*k
            do j = 1, size(d)
               s = merge(1, -1, d(j) > spring%d(1))
               do lines = 1, 100000
                  if (s*(d(j) - spring%end_toward(1, s)) <= 0.0_wp) exit
                  call spring%advance_on_branch(1, spring%end_toward(1, s))
                  before = spring%force(1)
                  call spring%leave(1, s)
                  if (ieee_is_nan(spring%force(1))) exit
                  ! Layers that soften may snap.
                  if (rule_names(rule) == 'layered') before = spring%force(1)
                  call check_close(error, spring%force(1), before, 0.0_wp, 1.0e-9_wp*k*maxval(abs(d)), &
                                   trim(rule_names(rule))//': force at an event')
                  call check_true(error, spring%k(1) <= (1.0_wp + 1.0e-9_wp)*k, &
                                  trim(rule_names(rule))//': not steeper than the first line')
               end do
               if (ieee_is_nan(spring%force(1))) exit
               call check_true(error, lines < 100 .or. rule_names(rule) == 'layered', &
                               trim(rule_names(rule))//': few lines in one move')
               call spring%advance_to(1, d(j))
               call check_true(error, spring%lower(1) <= d(j) .and. d(j) <= spring%upper(1), &
                               trim(rule_names(rule))//': within the ends')
            end do
            if (allocated(error)) return
         end do
      end do
   end subroutine lines_meet

   !> Whether a spring carries forces of one sign alone.
   logical function has_one_side(spec)
      type(spring_record), intent(in) :: spec
      type(key_type), allocatable :: keys(:)
      integer :: i

      has_one_side = .false.
      if (spec%rule == 'layered') return
      call keys_of(trim(spec%rule), keys)
      do i = 1, size(keys)
         if (keys(i)%name /= 'f_y' .and. keys(i)%name /= 'f_y_neg') cycle
         has_one_side = has_one_side .or. (is_given(spec%value(i)) .and. .not. abs(spec%value(i)) > 0.0_wp)
      end do
   end function has_one_side

   !> On a path cut into increments every move ends at the same force.
   subroutine increments(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_record) :: spec
      type(spring_array) :: spring
      type(spring_array) :: whole
      real(wp) :: d(24), f(24), begin
      integer :: rule, history, parts, i, j

      do rule = 1, size(rule_names)
         do history = 1, merge(4, 60, rule_names(rule) == 'layered')
            call random_history(trim(rule_names(rule)), history, spec, d)
            call follow_path(spec, d, f)
            parts = merge(1000, 7, mod(history, 20) == 0)
            call make_springs(spring, [spec])
            whole = spring
            begin = 0.0_wp
            do j = 1, size(d)
               if (ieee_is_nan(f(j))) exit  ! Layers that carry their axial load no more.
               do i = 1, parts - 1
                  call spring%advance_to(1, begin + (d(j) - begin)*i/parts)
               end do
               call spring%advance_to(1, d(j))
               call whole%advance_to(1, d(j))
               call check_same(error, spring%force(1), f(j), trim(rule_names(rule)))
               begin = d(j)
            end do
            call check_close(error, spring%work(1), whole%work(1), 1.0e-9_wp, &
                             1.0e-10_wp*spec%initial_stiffness()*maxval(abs(d))**2, &
                             trim(rule_names(rule))//': work')
            call check_equal(error, spring%events, whole%events, trim(rule_names(rule))//': events')
         end do
      end do
   end subroutine increments

   !> Trial moves with mark and restore, and copies, change nothing.
   subroutine trials(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      type(spring_record) :: spec
      type(spring_array) :: spring, copy
      real(wp) :: d(24), f(24), reach
      integer :: rule, history, j

      do rule = 1, size(rule_names)
         do history = 1, merge(4, 60, rule_names(rule) == 'layered')
            call random_history(trim(rule_names(rule)), history, spec, d)
            reach = maxval(abs(d))
            call follow_path(spec, d, f)
            call make_springs(spring, [spec])
            do j = 1, size(d)
               if (ieee_is_nan(f(j))) exit
               copy = spring
               call copy%advance_to(1, random%uniform(-reach, reach))
               call spring%mark()
               call spring%advance_to(1, random%uniform(-reach, reach))
               call spring%advance_to(1, random%uniform(-reach, reach))
               call spring%restore()
               if (mod(j, 2) == 0) call spring%forget_mark()
               call spring%advance_to(1, d(j))
               call check_same(error, spring%force(1), f(j), trim(rule_names(rule)))
            end do
         end do
      end do
   end subroutine trials

   subroutine random_history(rule, history, spec, d)
      character(len=*), intent(in) :: rule
      integer, intent(in) :: history
      type(spring_record), intent(out) :: spec
      real(wp), intent(out) :: d(:)
      type(random_type) :: random

      random%state = 7919_int64*history + len(rule)
      call random_spring(random, rule, spec)
      call random_path(random, yield_of(spec), d)
   end subroutine random_history

   !> A path that is cut anywhere goes on with the same bits in springs that were made anew and given the
   !> memory: a rule that leaves something out of `serialize` fails.
   subroutine resumes(error)
      type(error_type), allocatable, intent(inout) :: error
      integer :: i, history

      do i = 1, size(rule_names)
         do history = 1, merge(6, 60, rule_names(i) == 'layered')
            call cut_path(error, trim(rule_names(i)), history)
         end do
      end do
   end subroutine resumes

   !> Two springs of a rule, of which the first may hear of the work of the second.
   subroutine cut_path(error, rule, history)
      type(error_type), allocatable, intent(inout) :: error
      character(len=*), intent(in) :: rule
      integer, intent(in) :: history
      type(random_type) :: random
      type(spring_record) :: spec(2)
      type(spring_array) :: whole, part
      type(stream_type) :: stream
      real(wp) :: d(24, 2), f(24, 2), w(24, 2)
      integer :: cut, i, j
      logical :: equal

      random%state = 7919_int64*history + len(rule)
      do i = 1, 2
         call random_spring(random, rule, spec(i))
         call random_path(random, yield_of(spec(i)), d(:, i))
      end do
      cut = 1 + int(random%uniform(0.0_wp, 23.0_wp))
      call make_springs(whole, spec)
      do j = 1, size(d, 1)
         call whole%move_all(d(j, :))
         if (j == cut) then
            call stream%save()
            call whole%serialize(stream)
         end if
         f(j, :) = [whole%force(1), whole%force(2)]
         w(j, :) = whole%work
      end do
      call make_springs(part, spec)
      call stream%restore()
      call part%serialize(stream)
      call check_true(error, stream%at == stream%count .and. .not. stream%broken, rule//': all is read')
      equal = .true.
      do j = cut, size(d, 1)
         if (j > cut) call part%move_all(d(j, :))
         equal = equal .and. all(same([part%force(1), part%force(2)], f(j, :))) .and. &
                 all(same(part%work, w(j, :)))
      end do
      call check_true(error, equal, rule//': forces and works')
   end subroutine cut_path

   elemental logical function same(a, b)
      real(wp), intent(in) :: a, b

      same = .not. abs(a - b) > 0.0_wp
   end function same

end module test_rules
