!> The springs of a column as arrays: each one on its own, copied by assignment.
module test_springs
   use check, only: unit_test, check_close, check_equal, check_same, check_true
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_springs, only: follow_path, spring_array
   use rbs_spec_spring, only: spring_spec
   use samples, only: elastic, bilinear_1, takeda_1, d_c, d_y, f_c, f_y, k_c, k_y, k_u, s_d, s_k, random_type
   implicit none
   private

   public :: collect_springs

contains

   subroutine collect_springs(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('virgin springs', virgin), &
               unit_test('each spring moves as if it were alone', independent), &
               unit_test('property 13: assignment is copy and restore', copy_and_restore), &
               unit_test('a copy shares no memory with its original', deep_copy), &
               unit_test('property 2: all rules at once, to the last bit', increments), &
               unit_test('the work does not depend on the cuts', work), &
               unit_test('the present deformation is always within the ends', within_ends), &
               unit_test('arrive at an open end is to be on the next line', arrive_open), &
               unit_test('arrive at a closed end stays on the line', arrive_closed), &
               unit_test('leave turns back a one-way line', leave_one_way), &
               unit_test('create forgets everything', create_again)]
   end subroutine collect_springs

   !> One spring of every kind.
   subroutine every_kind(specs)
      type(spring_spec), intent(out) :: specs(5)

      specs(1) = elastic(2.0_wp)
      specs(2) = bilinear_1()
      specs(3) = takeda_1('kc')
      specs(4) = takeda_1('kr')
      specs(5) = takeda_1('one')
   end subroutine every_kind

   !> A point of a random path, of the size at which each spring yields.
   subroutine random_point(random, d)
      type(random_type), intent(inout) :: random
      real(wp), intent(out) :: d(5)
      integer :: i

      do i = 1, 5
         d(i) = random%uniform(-4.0_wp, 4.0_wp)
      end do
      d = d*[1.0_wp, s_d, d_y, d_y, d_y]
   end subroutine random_point

   subroutine virgin(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_spec) :: specs(5)
      type(spring_array) :: springs
      integer :: i

      call every_kind(specs)
      call springs%create(specs)
      call check_equal(error, springs%count, 5, 'count')
      call check_equal(error, springs%events, 0, 'events')
      call check_same(error, springs%k, [2.0_wp, s_k, k_c, k_c, k_c], 'stiffness')
      do i = 1, 5
         call check_same(error, springs%force(i), 0.0_wp, 'force')
      end do
      ! The end itself belongs to the line that follows.
      call check_same(error, springs%last(3), nearest(d_c, -1.0_wp), 'last deformation before cracking')
   end subroutine virgin

   subroutine independent(error)
      type(error_type), allocatable, intent(inout) :: error
      integer, parameter :: m = 300
      type(random_type) :: random
      type(spring_spec) :: specs(5)
      type(spring_array) :: springs
      real(wp) :: d(5, m), f(5, m), alone(m)
      integer :: i, j

      call every_kind(specs)
      call springs%create(specs)
      do j = 1, m
         call random_point(random, d(:, j))
         call springs%move_all(d(:, j))
         f(:, j) = springs%f0 + springs%k*(springs%d - springs%d0)
         do i = 1, 5
            call check_same(error, springs%force(i), f(i, j), 'force is the fused loop')
         end do
      end do
      do i = 1, 5
         call follow_path(specs(i), d(i, :), alone)
         call check_same(error, f(i, :), alone, 'force')
      end do
   end subroutine independent

   subroutine copy_and_restore(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      type(spring_spec) :: specs(5)
      type(spring_array) :: springs, saved
      real(wp) :: d(5, 60), f(5), first(5, 60), work(5), point(5)
      integer :: path, j, events

      call every_kind(specs)
      do path = 1, 60
         call springs%create(specs)
         do j = 1, path
            call random_point(random, point)
            call springs%move_all(point)
         end do
         saved = springs
         do j = 1, size(d, 2)
            call random_point(random, d(:, j))
            call springs%move_all(d(:, j))
            first(:, j) = springs%f0 + springs%k*(springs%d - springs%d0)
         end do
         work = springs%work
         events = springs%events
         springs = saved
         do j = 1, size(d, 2)
            call springs%move_all(d(:, j))
            f = springs%f0 + springs%k*(springs%d - springs%d0)
            call check_same(error, f, first(:, j), 'force after restoring')
         end do
         call check_same(error, springs%work, work, 'work after restoring')
         call check_equal(error, springs%events, events, 'events after restoring')
      end do
   end subroutine copy_and_restore

   subroutine deep_copy(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_array) :: original, copy
      real(wp) :: force

      call original%create([takeda_1('kc')])
      call original%move(1, 4.0_wp*d_y)
      call original%move(1, -4.0_wp*d_y)
      call original%move(1, 1.5_wp*d_y)
      call original%move(1, -1.0_wp*d_y)
      force = original%force(1)
      copy = original
      ! Closes every loop of the copy; the original must still find its inner peak at 1.5 d_y.
      call copy%move(1, 6.0_wp*d_y)
      call check_same(error, original%force(1), force, 'the original has not moved')
      call original%move(1, 1.5_wp*d_y)
      call check_close(error, original%force(1), 174899.408_wp, 0.0_wp, 1.0e-3_wp, 'S4, point 11')
   end subroutine deep_copy

   subroutine increments(error)
      type(error_type), allocatable, intent(inout) :: error
      integer, parameter :: cuts(3) = [1, 7, 1000]
      type(random_type) :: random
      type(spring_spec) :: specs(5)
      type(spring_array) :: springs(3)
      real(wp) :: from(5), to(5)
      integer :: cut, j, i

      call every_kind(specs)
      do cut = 1, 3
         call springs(cut)%create(specs)
      end do
      from = 0.0_wp
      do j = 1, 200
         call random_point(random, to)
         do cut = 1, 3
            do i = 1, cuts(cut) - 1
               call springs(cut)%move_all(from + (to - from)*i/cuts(cut))
            end do
            call springs(cut)%move_all(to)
            call check_same(error, springs(cut)%f0 + springs(cut)%k*(springs(cut)%d - springs(cut)%d0), &
                            springs(1)%f0 + springs(1)%k*(springs(1)%d - springs(1)%d0), 'force')
         end do
         from = to
      end do
      call check_equal(error, springs(3)%events, springs(1)%events, 'events')
   end subroutine increments

   subroutine work(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_array) :: whole, cut
      type(spring_spec) :: specs(5)
      type(random_type) :: random
      real(wp) :: from(5), to(5)
      integer :: j, i

      call every_kind(specs)
      call whole%create(specs)
      call cut%create(specs)
      from = 0.0_wp
      do j = 1, 100
         call random_point(random, to)
         call whole%move_all(to)
         do i = 1, 20
            call cut%move_all(from + (to - from)*i/20)
         end do
         from = to
         call cut%move_all(to)
      end do
      call check_close(error, whole%work, cut%work, 1.0e-11_wp, 1.0e-12_wp, 'work')
      call check_close(error, whole%work(1), to(1)**2, 1.0e-11_wp, 1.0e-12_wp, 'work of the elastic spring')
   end subroutine work

   subroutine within_ends(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      type(spring_spec) :: specs(5)
      type(spring_array) :: springs
      real(wp) :: d(5)
      integer :: j

      call every_kind(specs)
      call springs%create(specs)
      do j = 1, 2000
         call random_point(random, d)
         call springs%move_all(d)
         call check_same(error, springs%d, d, 'deformation')
         call check_true(error, all(springs%first <= d .and. d <= springs%last), 'beyond an end')
         call check_true(error, all(springs%k > 0.0_wp .and. springs%k <= max(k_c, s_k)), &
                         'property 7: tangent out of bounds')
      end do
   end subroutine within_ends

   subroutine arrive_open(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_array) :: springs

      call springs%create([takeda_1('kc')])
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

      call springs%create([takeda_1('kc')])
      call springs%move(1, -4.0_wp*d_y)
      call springs%move(1, 4.0_wp*d_y)
      call springs%move(1, 3.9_wp*d_y)
      slope = springs%k(1)
      call springs%arrive(1, -1)
      ! A crossing of zero force is passed only strictly beyond.
      call check_close(error, springs%force(1), 0.0_wp, 0.0_wp, 1.0e-9_wp*f_y, 'zero force')
      call check_same(error, springs%k(1), slope, 'slope')
      call springs%move(1, nearest(springs%d(1), -1.0_wp))
      call check_true(error, springs%k(1) < slope, 'reloading beyond it')
   end subroutine arrive_closed

   subroutine leave_one_way(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_array) :: springs
      real(wp) :: force

      call springs%create([takeda_1('kc')])
      call springs%move(1, 2.0_wp*d_y)
      force = springs%force(1)
      call check_equal(error, springs%one_way(1), 1, 'one-way upward')
      call springs%leave(1, -1)
      call check_equal(error, springs%one_way(1), 0, 'unloading goes both ways')
      call check_close(error, springs%force(1), force, 1.0e-15_wp, 0.0_wp, 'the force stays')
      call check_same(error, springs%d(1), 2.0_wp*d_y, 'the deformation stays')
   end subroutine leave_one_way

   subroutine create_again(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_array) :: springs
      type(spring_spec) :: specs(5)

      call every_kind(specs)
      call springs%create(specs)
      call springs%move_all([1.0_wp, 1.0_wp, 1.0_wp, 1.0_wp, 1.0_wp])
      call springs%create(specs(2:3))
      call check_equal(error, springs%count, 2, 'count')
      call check_equal(error, springs%events, 0, 'events')
      call check_same(error, springs%work, [0.0_wp, 0.0_wp], 'work')
      call springs%move_all([0.5_wp*s_d, 0.5_wp*d_c])
      call check_same(error, [springs%force(1), springs%force(2)], [s_k*0.5_wp*s_d, k_c*0.5_wp*d_c], &
                      'uncracked again')
   end subroutine create_again

end module test_springs
