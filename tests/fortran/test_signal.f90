!> A tabulated signal, linear between its points.
module test_signal
   use check, only: unit_test, check_close, check_same, check_true
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_loading_signal, only: signal_type
   use samples, only: random_type
   implicit none
   private

   public :: collect_signal

contains

   subroutine collect_signal(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('a signal without points does not act', acts), &
               unit_test('linear between the points, exact at them', interpolation), &
               unit_test('constant before the first and after the last point', beyond), &
               unit_test('times may be asked in any order', any_order), &
               unit_test('points very unequal in distance', unequal)]
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

   subroutine interpolation(error)
      type(error_type), allocatable, intent(inout) :: error
      type(signal_type) :: s

      s = table([1.0_wp, 2.0_wp, 4.0_wp, 5.0_wp], [3.0_wp, -1.0_wp, 7.0_wp, 7.0_wp])
      call check_same(error, s%at_time(1.0_wp), 3.0_wp, 'first point')
      call check_same(error, s%at_time(1.25_wp), 2.0_wp, 'a quarter down')
      call check_same(error, s%at_time(2.0_wp), -1.0_wp, 'second point')
      call check_same(error, s%at_time(3.5_wp), 5.0_wp, 'three quarters up')
      call check_same(error, s%at_time(4.0_wp), 7.0_wp, 'third point')
      call check_same(error, s%at_time(4.5_wp), 7.0_wp, 'flat')
      call check_same(error, s%at_time(5.0_wp), 7.0_wp, 'last point')
   end subroutine interpolation

   subroutine beyond(error)
      type(error_type), allocatable, intent(inout) :: error
      type(signal_type) :: s

      s = table([1.0_wp, 2.0_wp], [3.0_wp, -1.0_wp])
      call check_same(error, s%at_time(-1.0e9_wp), 3.0_wp, 'long before')
      call check_same(error, s%at_time(0.999_wp), 3.0_wp, 'just before')
      call check_same(error, s%at_time(2.001_wp), -1.0_wp, 'just after')
      call check_same(error, s%at_time(1.0e9_wp), -1.0_wp, 'long after')
      call check_same(error, s%at_time(1.5_wp), 1.0_wp, 'and back inside')
   end subroutine beyond

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

   subroutine unequal(error)
      type(error_type), allocatable, intent(inout) :: error
      type(signal_type) :: s

      s = table([0.0_wp, 1.0e-9_wp, 1.0_wp, 1.0e9_wp], [0.0_wp, 1.0_wp, 1.0_wp, 0.0_wp])
      call check_close(error, s%at_time(0.5e-9_wp), 0.5_wp, 1.0e-15_wp, 0.0_wp, 'on the jump')
      call check_close(error, s%at_time(0.5_wp), 1.0_wp, 1.0e-15_wp, 0.0_wp, 'on the plateau')
      call check_close(error, s%at_time(0.5e9_wp), 0.5_wp, 1.0e-8_wp, 0.0_wp, 'on the slope')
   end subroutine unequal

end module test_signal
