!> A tabulated signal, linear between its points.
module test_signal
   use check, only: unit_test, check_close, check_equal, check_same, check_true
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_loading_signal, only: signal_type
   use rbs_loading_loads, only: loads_type, lateral, horizontal, vertical, top_axial
   use samples, only: random_type
   implicit none
   private

   public :: collect_signal

contains

   subroutine collect_signal(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('a signal without points does not act', acts), &
               unit_test('times may be in any order', any_order), &
               unit_test('the corner that follows a time', corners), &
               unit_test('corners asked for in any order, values in between', corners_and_values), &
               unit_test('corners are found where times are coarse', late_corners), &
               unit_test('of several loads the next corner of any', load_corners)]
   end subroutine collect_signal

   type(signal_type) function table(time, value) result(s)
      real(wp), intent(in) :: time(:), value(:)

      allocate (s%time, source=time)
      allocate (s%value, source=value)
   end function table

   subroutine acts(error)
      type(error_type), allocatable, intent(inout) :: error
      type(signal_type) :: s

      call check_true(error, .not. s%acts(), 'no points')
      s = table([0.0_wp, 1.0_wp], [0.0_wp, 0.0_wp])
      call check_true(error, s%acts(), 'zeros are points')
   end subroutine acts

   subroutine any_order(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      type(signal_type) :: s
      real(wp) :: time(50), t
      integer :: i

      do i = 1, 50
         time(i) = i + random%uniform(-0.4_wp, 0.4_wp)
      end do
      s = table(time, 3.0_wp*time - 2.0_wp)
      do i = 1, 2000
         t = random%uniform(time(1), time(50))
         call check_close(error, s%at_time(t), 3.0_wp*t - 2.0_wp, 1.0e-13_wp, 1.0e-13_wp, 'a straight line')
      end do
   end subroutine any_order

   subroutine corners(error)
      type(error_type), allocatable, intent(inout) :: error
      type(signal_type) :: s

      s = table([1.0_wp, 2.0_wp, 4.0_wp, 5.0_wp], [3.0_wp, -1.0_wp, 7.0_wp, 7.0_wp])
      call check_same(error, s%corner_after(-3.0_wp), 1.0_wp, 'before the first point')
      call check_same(error, s%corner_after(0.999_wp), 1.0_wp, 'just before the first point')
      call check_same(error, s%corner_after(1.0_wp), 2.0_wp, 'at the first point')
      call check_same(error, s%corner_after(3.0_wp), 4.0_wp, 'between points')
      call check_same(error, s%corner_after(4.0_wp), 5.0_wp, 'at a point')
      call check_same(error, s%corner_after(5.0_wp), huge(1.0_wp), 'at the last point')
      call check_same(error, s%corner_after(1.0e9_wp), huge(1.0_wp), 'after the last point')
      call check_same(error, s%corner_after(1.5_wp), 2.0_wp, 'and back')
      ! A time that differs from the corner only in its last bits counts as past it.
      call check_same(error, s%corner_after(nearest(2.0_wp, -1.0_wp)), 4.0_wp, 'a bit before a point')
      call check_same(error, s%corner_after(nearest(5.0_wp, -1.0_wp)), huge(1.0_wp), 'a bit before the last')
      s = table([0.0_wp, 1.0_wp], [0.0_wp, 1.0_wp])
      call check_same(error, s%corner_after(0.0_wp), 1.0_wp, 'time zero')
   end subroutine corners

   subroutine corners_and_values(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      type(signal_type) :: s, fresh
      real(wp) :: time(40), value(40), t
      integer :: i

      do i = 1, 40
         time(i) = i + random%uniform(-0.4_wp, 0.4_wp)
         value(i) = random%uniform(-1.0_wp, 1.0_wp)
      end do
      s = table(time, value)
      do i = 1, 3000
         t = random%uniform(-1.0_wp, 43.0_wp)
         fresh = table(time, value)
         if (mod(i, 3) == 0) then
            call check_same(error, s%corner_after(t), minval(time, mask=time > t), 'corner')
         else
            ! Earlier calls have no effect on the value.
            call check_same(error, s%at_time(t), fresh%at_time(t), 'value')
         end if
      end do
   end subroutine corners_and_values

   !> A walk from corner to corner ends, and meets every corner once.
   subroutine late_corners(error)
      type(error_type), allocatable, intent(inout) :: error
      type(signal_type) :: s
      real(wp), parameter :: begin(4) = [0.0_wp, 1.0_wp, 1.0e4_wp, -1.0e4_wp]
      real(wp) :: time(101), t, next
      integer :: i, j, count

      do i = 1, 4
         time = begin(i) + [(0.005_wp*j, j=0, 100)]
         s = table(time, 0.0_wp*time)
         t = time(1)
         count = 0
         do while (count < 200)
            next = s%corner_after(t)
            if (next > 1.0e300_wp) exit
            count = count + 1
            call check_true(error, any(abs(time - next) <= 0.0_wp), 'a corner is a point')
            ! The time arrives there within its last digit.
            t = t + (next - t)
         end do
         call check_equal(error, count, 100, 'corners')
      end do
   end subroutine late_corners

   subroutine load_corners(error)
      type(error_type), allocatable, intent(inout) :: error
      type(loads_type) :: loads
      real(wp) :: load(4)

      call loads%find_acting()
      call check_true(error, .not. any(loads%acts), 'nothing acts')
      call check_same(error, loads%corner_after(0.0_wp), huge(1.0_wp), 'no corner')
      call loads%at_time(1.0_wp, load)
      call check_same(error, load, [0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp], 'no load')
      loads%signal(lateral) = table([0.0_wp, 3.0_wp], [0.0_wp, 3.0_wp])
      loads%signal(horizontal) = table([0.0_wp, 2.0_wp, 6.0_wp], [0.0_wp, 1.0_wp, 5.0_wp])
      loads%signal(vertical) = table([1.0_wp, 5.0_wp], [7.0_wp, 7.0_wp])
      loads%signal(top_axial) = table([0.0_wp, 4.0_wp], [0.0_wp, -4.0_wp])
      call loads%find_acting()
      call check_true(error, all(loads%acts), 'all act')
      call check_same(error, loads%corner_after(0.0_wp), 1.0_wp, 'of the vertical motion')
      call check_same(error, loads%corner_after(1.0_wp), 2.0_wp, 'of the ground')
      call check_same(error, loads%corner_after(2.5_wp), 3.0_wp, 'of the force')
      call check_same(error, loads%corner_after(3.0_wp), 4.0_wp, 'of the axial load')
      call loads%at_time(2.5_wp, load)
      call check_same(error, load([lateral, horizontal, vertical, top_axial]), [2.5_wp, 1.5_wp, 7.0_wp, &
                      -2.5_wp], 'loads')
   end subroutine load_corners

end module test_signal
