!> The springs of a column as arrays: each spring is independent, and assignment copies them.
module test_springs
   use check, only: unit_test, check_close, check_equal, check_same, check_true
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_hysteresis_springs, only: spring_array
   use rbs_hysteresis_spring_record, only: spring_record
   use samples, only: make_springs, bilinear, bilinear_1, compression, elastic, random_type, takeda_1, d_c, &
                      d_y, f_c, f_y, k_y, k_u, s_d
   implicit none
   private

   public :: collect_springs

contains

   subroutine collect_springs(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('a spring that arrives at an open end is on the next line', arrive_open), &
               unit_test('a spring that arrives at a closed end stays on the line', arrive_closed), &
               unit_test('leave turns back on a one-way line', leave_one_way), &
               unit_test('restore brings back the marked state, to the last bit', restoring), &
               unit_test('a further trial ends as one from the mark, to the last bit', trying_again), &
               unit_test('only a new stiffness changes the version', versions), &
               unit_test('springs that stay on their lines move as along a path', carried), &
               unit_test('a contact presses, and does not pull', contact), &
               unit_test('loading to a force', loaded), &
               unit_test('loading to a force that no line reaches', not_loaded)]
   end subroutine collect_springs

   !> One spring of every kind.
   subroutine every_kind(specs)
      type(spring_record), intent(out) :: specs(5)

      specs(1) = elastic(2.0_wp)
      specs(2) = bilinear_1()
      specs(3) = takeda_1('kc')
      specs(4) = takeda_1('kr')
      specs(5) = takeda_1('one')
   end subroutine every_kind

   subroutine arrive_open(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_array) :: springs

      call make_springs(springs, [takeda_1('kc')])
      call springs%arrive(1, 1)
      call check_same(error, [springs%d(1), springs%force(1), springs%k(1)], [d_c, f_c, k_y], 'cracked')
      call springs%arrive(1, 1)
      call check_same(error, [springs%d(1), springs%force(1), springs%k(1)], [d_y, f_y, k_u], 'yielded')
      call check_equal(error, springs%events, 2, 'events')
   end subroutine arrive_open

   subroutine arrive_closed(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_array) :: springs
      real(wp) :: slope

      call make_springs(springs, [takeda_1('kc')])
      call springs%advance_to(1, -4.0_wp*d_y)
      call springs%advance_to(1, 4.0_wp*d_y)
      call springs%advance_to(1, 3.9_wp*d_y)
      slope = springs%k(1)
      call springs%arrive(1, -1)
      ! The spring has passed a crossing of zero force only when it is strictly beyond it.
      call check_close(error, springs%force(1), 0.0_wp, 0.0_wp, 1.0e-9_wp*f_y, 'zero force')
      call check_same(error, springs%k(1), slope, 'slope')
      call springs%advance_to(1, nearest(springs%d(1), -1.0_wp))
      call check_true(error, springs%k(1) < slope, 'reloading beyond it')
   end subroutine arrive_closed

   subroutine leave_one_way(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_array) :: springs
      real(wp) :: force

      call make_springs(springs, [takeda_1('kc')])
      call springs%advance_to(1, 2.0_wp*d_y)
      force = springs%force(1)
      call check_equal(error, springs%unload_on_reversal(1), 1, 'one-way upward')
      call springs%leave(1, -1)
      call check_equal(error, springs%unload_on_reversal(1), 0, 'unloading goes both ways')
      call check_close(error, springs%force(1), force, 1.0e-15_wp, 0.0_wp, 'the force stays')
      call check_same(error, springs%d(1), 2.0_wp*d_y, 'the deformation stays')
   end subroutine leave_one_way

   !> One more spring of every kind, for the tests of restore.
   subroutine all_kinds(specs)
      type(spring_record), intent(out) :: specs(6)

      call every_kind(specs(:5))
      specs(6) = compression(3.0_wp)
   end subroutine all_kinds

   !> All arrays of the springs are equal, and so are their next moves, as their rules have the same memory.
   subroutine check_alike(error, a, b, random, what)
      type(error_type), allocatable, intent(inout) :: error
      !> Copies, which are moved further
      type(spring_array), intent(in) :: a, b
      type(random_type), intent(in) :: random
      character(len=*), intent(in) :: what
      type(spring_array) :: one, other
      type(random_type) :: dice
      real(wp) :: point(a%count)
      integer :: j

      call check_same(error, [a%d, a%d0, a%f0, a%k, a%lower, a%upper, a%work], &
                      [b%d, b%d0, b%f0, b%k, b%lower, b%upper, b%work], what)
      call check_equal(error, a%events, b%events, what//': events')
      call check_true(error, all(a%unload_on_reversal == b%unload_on_reversal), what//': one-way lines')
      call check_true(error, all((a%includes_lower_end .eqv. b%includes_lower_end) .and. &
                                 (a%includes_upper_end .eqv. b%includes_upper_end)), &
                      what//': closed ends')
      one = a
      other = b
      dice = random
      do j = 1, 30
         call random_move(dice, point)
         call one%move_all(point)
         call other%move_all(point)
         call check_same(error, [one%f0, one%k, one%d0, one%work], &
                         [other%f0, other%k, other%d0, other%work], what//': later')
      end do
   end subroutine check_alike

   !> A point for springs of all kinds, with some deformations far away and some near.
   subroutine random_move(random, d)
      type(random_type), intent(inout) :: random
      real(wp), intent(out) :: d(:)
      real(wp), parameter :: scale(6) = [1.0_wp, s_d, d_y, d_y, d_y, 1.0_wp]
      integer :: i

      do i = 1, size(d)
         d(i) = scale(i)*random%uniform(-4.0_wp, 4.0_wp)*10.0_wp**(-random%uniform(0.0_wp, 3.0_wp))
      end do
   end subroutine random_move

   !> Mark, make random moves, restore; mark again elsewhere; move springs one by one and all together.
   subroutine restoring(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      type(spring_record) :: specs(6)
      type(spring_array) :: springs, undisturbed
      real(wp) :: point(6)
      integer :: round, trial, j, i

      call all_kinds(specs)
      call make_springs(springs, specs)
      call make_springs(undisturbed, specs)
      do round = 1, 60
         call springs%mark()
         do trial = 1, 4
            do j = 1, 3*trial
               call random_move(random, point)
               if (mod(j, 3) == 0) then
                  i = 1 + mod(j + trial, 6)
                  call springs%advance_to(i, point(i))
               else if (mod(j, 7) == 0) then
                  ! Turn back on a one-way line.
                  i = 2 + mod(j + round, 4)
                  if (springs%unload_on_reversal(i) /= 0) then
                     call springs%leave(i, -springs%unload_on_reversal(i))
                  end if
               else
                  call springs%move_all(point)
               end if
            end do
            call springs%restore()
            call check_alike(error, springs, undisturbed, random, 'round '//to_text(round))
            if (allocated(error)) return
         end do
         ! The next move: after a restore or not, with or without the mark.
         call random_move(random, point)
         if (mod(round, 3) == 0) call springs%forget_mark()
         call springs%move_all(point)
         if (mod(round, 3) == 1) call springs%forget_mark()
         call undisturbed%move_all(point)
         call check_alike(error, springs, undisturbed, random, 'after round '//to_text(round))
      end do
      call check_true(error, springs%events > 100, 'lines were left')
   end subroutine restoring

   !> Trials near the last one, farther or less far, and others elsewhere; now and then a spring has turned
   !> back in between.
   subroutine trying_again(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      type(spring_record) :: specs(6)
      type(spring_array) :: springs, undisturbed, moved, tried
      real(wp) :: point(6), other(6)
      integer :: round, trial, i
      !> Whether springs that stay on their lines are not moved in trials
      logical :: lines_alone

      call all_kinds(specs)
      call make_springs(springs, specs)
      do round = 1, 300
         undisturbed = springs
         lines_alone = mod(round, 2) == 0
         call random_move(random, point)
         if (lines_alone) then
            call springs%choose_lines(point)
         else
            call springs%mark()
            call springs%move_all(point)
         end if
         do trial = 1, 6
            call random_move(random, other)
            if (mod(trial + round, 4) > 0) then
               point = springs%d + 0.1_wp*other
            else
               point = other
            end if
            if (mod(trial + round, 9) == 0) then
               i = 2 + mod(trial, 4)
               if (springs%unload_on_reversal(i) /= 0) then
                  call springs%leave(i, -springs%unload_on_reversal(i))
               end if
            end if
            if (lines_alone) then
               call springs%choose_lines(point)
            else
               call springs%retry(point)
            end if
            tried = springs
            if (lines_alone) call tried%carry_to(point)
            moved = undisturbed
            call moved%move_all(point)
            call check_alike(error, tried, moved, random, 'round '//to_text(round))
            if (allocated(error)) return
         end do
         if (lines_alone .and. mod(round, 3) > 0) call springs%carry_to(point)
         if (mod(round, 3) == 0 .or. mod(round, 5) == 0) then
            call springs%restore()
            call check_alike(error, springs, undisturbed, random, 'restored in round '//to_text(round))
            if (allocated(error)) return
         end if
         call springs%forget_mark()
      end do
      call check_true(error, springs%events > 100, 'lines were left')
   end subroutine trying_again

   subroutine versions(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_array) :: springs
      integer :: before

      call make_springs(springs, [bilinear_1(), elastic(2.0_wp)])
      before = springs%version
      call springs%move_all([0.5_wp*s_d, 100.0_wp])
      call springs%move_all([-0.9_wp*s_d, -100.0_wp])
      call check_equal(error, springs%version, before, 'elastic')
      call springs%mark()
      call springs%restore()
      call check_equal(error, springs%version, before, 'nothing to restore')
      call springs%mark()
      call springs%move_all([2.0_wp*s_d, 0.0_wp])
      call check_true(error, springs%version /= before, 'yielded')
      before = springs%version
      call springs%restore()
      ! Factors of the yielded lines must not be used for the present ones.
      call check_true(error, springs%version /= before, 'restored')
      call check_equal(error, springs%events, 0, 'events are those of the mark')
   end subroutine versions

   subroutine carried(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      type(spring_record) :: specs(6)
      type(spring_array) :: springs, moved
      real(wp) :: point(6)
      integer :: j, within

      call all_kinds(specs)
      call make_springs(springs, specs)
      within = 0
      do j = 1, 3000
         call random_move(random, point)
         ! Mostly small moves from the present deformations.
         if (mod(j, 5) /= 0) point = springs%d + 0.01_wp*point
         moved = springs
         call moved%move_all(point)
         if (springs%stay_on_lines(point)) then
            within = within + 1
            call check_equal(error, moved%events, springs%events, 'no line has changed')
            call springs%carry_to(point)
         else
            call check_true(error, moved%events > springs%events, 'a line has changed')
            call springs%move_all(point)
         end if
         call check_same(error, [springs%d, springs%lower, springs%upper, springs%work], &
                         [moved%d, moved%lower, moved%upper, moved%work], 'carried or moved')
      end do
      call check_true(error, within > 100 .and. within < 2900, 'both happen')
   end subroutine carried

   subroutine contact(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      type(spring_array) :: springs
      real(wp) :: d
      integer :: j

      call make_springs(springs, [compression(3.0_wp)])
      call check_same(error, [springs%d(1), springs%force(1)], [0.0_wp, 0.0_wp], 'closed, without force')
      do j = 1, 1000
         d = random%uniform(-1.0_wp, 1.0_wp)
         if (mod(j, 10) == 0) d = 0.0_wp
         call springs%advance_to(1, d)
         call check_same(error, springs%force(1), 3.0_wp*min(d, 0.0_wp), 'force')
         call check_close(error, springs%work(1), 1.5_wp*min(d, 0.0_wp)**2, 1.0e-12_wp, 1.0e-13_wp, 'work')
      end do
      call check_true(error, .not. springs%stuck, 'not stuck')
   end subroutine contact

   !> Along the lines that a path of deformations follows, and no further.
   subroutine loaded(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_array) :: springs, moved
      real(wp), parameter :: force(9) = [0.5_wp, 1.3_wp, 0.0_wp, -0.4_wp, -1.2_wp, -1.1_wp, 1.2_wp, 0.2_wp, &
                                         1.5_wp]
      logical :: found
      integer :: i

      call make_springs(springs, [takeda_1('kc'), bilinear(10.0_wp, 0.1_wp, 1.0_wp), compression(4.0_wp), &
                           elastic(2.0_wp)])
      moved = springs
      do i = 1, size(force)
         call springs%load_to(1, f_y*force(i), found)
         call check_true(error, found, 'Takeda: found')
         call check_close(error, springs%force(1), f_y*force(i), 1.0e-13_wp, 1.0e-12_wp*f_y, 'Takeda: force')
         call springs%load_to(2, force(i), found)
         call check_true(error, found, 'bilinear: found')
         call check_close(error, springs%force(2), force(i), 1.0e-13_wp, 1.0e-14_wp, 'bilinear: force')
         call moved%move_all([springs%d(1), springs%d(2), 0.0_wp, 0.0_wp])
         call check_close(error, [moved%force(1)/f_y, moved%force(2)], &
                          [springs%force(1)/f_y, springs%force(2)], 1.0e-12_wp, 1.0e-12_wp, &
                          'the same by deformation')
         call check_close(error, moved%work(:2), springs%work(:2), 1.0e-12_wp, 1.0e-12_wp, 'work')
      end do
      call springs%load_to(3, -8.0_wp, found)
      call check_true(error, found, 'contact: found')
      call check_same(error, springs%d(3), -2.0_wp, 'contact: closed')
      call springs%load_to(3, 0.0_wp, found)
      call check_true(error, found, 'contact: found')
      call check_same(error, [springs%d(3), springs%force(3)], [0.0_wp, 0.0_wp], 'contact: without force')
      call springs%load_to(4, -8.0_wp, found)
      call check_same(error, springs%d(4), -4.0_wp, 'elastic')
      call springs%load_to(4, -8.0_wp, found)
      call check_true(error, found, 'there already')
      call check_same(error, springs%d(4), -4.0_wp, 'it stays there')
      ! From an open contact back to pressure.
      call springs%advance_to(3, 1.0_wp)
      call springs%load_to(3, -8.0_wp, found)
      call check_true(error, found, 'contact: found from the open side')
      call check_same(error, springs%d(3), -2.0_wp, 'contact: closed again')
   end subroutine loaded

   subroutine not_loaded(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_array) :: springs
      logical :: found

      call make_springs(springs, [compression(4.0_wp), bilinear(10.0_wp, 0.1_wp, 0.0_wp)])
      call springs%load_to(1, 1.0_wp, found)
      call check_true(error, .not. found, 'a contact does not pull')
      call springs%load_to(2, 1.0_wp, found)
      call check_true(error, found, 'the yield force itself')
      call springs%load_to(2, 1.01_wp, found)
      call check_true(error, .not. found, 'beyond a plateau')
      call springs%load_to(2, -1.01_wp, found)
      call check_true(error, .not. found, 'beyond the other plateau')
      call check_true(error, .not. springs%stuck, 'not stuck')
   end subroutine not_loaded

end module test_springs
