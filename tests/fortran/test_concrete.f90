!> Concrete across a joint (docs/rules.md section 9): envelope, unloading, cracks that close gradually.
module test_concrete
   use check, only: unit_test, check_close
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_springs, only: follow_path
   use rbs_hysteresis_spring_record, only: spring_record
   use samples, only: set_value
   implicit none
   private

   public :: collect_concrete

contains

   subroutine collect_concrete(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('Popovics 1973 at the ends of the chords', rising), &
               unit_test('softening line, residual, no tension', falling), &
               unit_test('Karsan and Jirsa 1969: plastic closing', plastic_closing), &
               unit_test('faces that were apart touch early and close fully later', contact), &
               unit_test('wear: by the way of opening over the widest one', wear), &
               unit_test('friction: two paths, and the initial stiffness between them', friction)]
   end subroutine collect_concrete

   !> A spring with simple parameters: 100 at a closing of 2, then slope -10 down to 20 at 10.
   type(spring_record) function hand() result(spec)
      spec%rule = 'concrete'
      call set_value(spec, 'k', 100.0_wp)
      call set_value(spec, 'f_peak', 100.0_wp)
      call set_value(spec, 'd_peak', 2.0_wp)
      call set_value(spec, 'k_soft', 10.0_wp)
      call set_value(spec, 'f_res', 20.0_wp)
   end function hand

   !> r = 100/(100 - 50) = 2: the curve is f_peak 2 x/(1 + x^2).
   subroutine rising(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp), parameter :: x(5) = [0.125_wp, 0.25_wp, 0.5_wp, 0.75_wp, 1.0_wp]
      real(wp) :: f(5), expected(5)

      call follow_path(hand(), -2.0_wp*x, f)
      expected = -200.0_wp*x/(1.0_wp + x**2)
      expected(1) = 0.5_wp*expected(2)
      call check_close(error, f, expected, 1.0e-14_wp, 0.0_wp, 'force')
   end subroutine rising

   subroutine falling(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp) :: f(6)

      call follow_path(hand(), [-2.0_wp, -5.0_wp, -10.0_wp, -12.0_wp, 0.0_wp, 5.0_wp], f)
      call check_close(error, f, -[100.0_wp, 70.0_wp, 20.0_wp, 20.0_wp, 0.0_wp, 0.0_wp], 1.0e-14_wp, 0.0_wp, &
                       'force')
   end subroutine falling

   !> Unloading reaches zero force at 0.145 x^2 + 0.13 x, beyond x = 2 on the line 0.84 + 0.834 (x - 2), less
   !> the value at x = 0.25, up to where the virgin spring is elastic.
   subroutine plastic_closing(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp), parameter :: x(5) = [0.8_wp, 1.0_wp, 1.5_wp, 2.0_wp, 4.0_wp]
      real(wp), parameter :: share(5) = [0.1968_wp, 0.275_wp, 0.52125_wp, 0.84_wp, 2.508_wp] - 0.0415625_wp
      real(wp) :: f(4), middle
      integer :: i

      do i = 1, size(x)
         middle = x(i) + share(i)
         call follow_path(hand(), [-2.0_wp*x(i), -middle, -2.0_wp*share(i), -1.9_wp*share(i)], f)
         call check_close(error, f(2), 0.5_wp*f(1), 1.0e-13_wp, 0.0_wp, 'half of the path')
         call check_close(error, f(3:), [0.0_wp, 0.0_wp], 0.0_wp, 1.0e-12_wp, 'end of the path')
      end do
   end subroutine plastic_closing

   !> By hand: from (4, 80) unloading as stiff as at first ends at the plastic closing 3.2. Opened to 0.2
   !> (width 3), faces touch at 3.2 - 0.5 3 = 1.7; fully closed at 3.2 + 0.25 (4 - 3.2) = 3.4 with 20.
   subroutine contact(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_record) :: spec
      real(wp) :: f(6)

      spec = hand()
      call set_value(spec, 'plastic', 5.0_wp)
      call set_value(spec, 'contact', 0.25_wp)
      call set_value(spec, 'misfit', 0.5_wp)
      call follow_path(spec, [-4.0_wp, -0.2_wp, -1.7_wp, -2.55_wp, -3.4_wp, -3.7_wp], f)
      call check_close(error, f, -[80.0_wp, 0.0_wp, 0.0_wp, 10.0_wp, 20.0_wp, 50.0_wp], 1.0e-12_wp, &
                       1.0e-11_wp, 'force')
      ! A narrower opening does not move the touch, which depends on the widest opening.
      call follow_path(spec, [-4.0_wp, -0.2_wp, -3.5_wp, -1.2_wp, -2.55_wp, -4.0_wp], f)
      call check_close(error, f(5:), -[10.0_wp, 80.0_wp], 1.0e-12_wp, 0.0_wp, 'widest opening')
      ! Crushing from 80 % of the strength to all of it wears the gap down to 0.8 of 0.5 (0.2 + 1.3) = 0.75:
      ! from (2, 100) the plastic closing is 1, full closing at 1.25 with 25, touch at 0.4.
      call follow_path(spec, [-1.0_wp, 1.3_wp, -2.0_wp, -1.25_wp, -0.825_wp, -0.4_wp], f)
      call check_close(error, f(3:), -[100.0_wp, 25.0_wp, 12.5_wp, 0.0_wp], 1.0e-12_wp, 1.0e-11_wp, &
                       'crushed')
   end subroutine contact

   !> 10 % for a way of opening of widest + d_peak, at twice the closing at the peak and beyond; half of that
   !> at the peak. While the crack becomes wider the sum of way/(width + d_peak) is a logarithm.
   subroutine wear(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp), parameter :: d_peak = 2.0_wp, c_p = 1.596875_wp, wide = c_p + 1.0_wp, wider = c_p + 2.0_wp
      type(spring_record) :: spec
      real(wp) :: f(7), first, all

      spec = hand()
      call set_value(spec, 'wear', 0.1_wp)
      call follow_path(spec, [-4.0_wp, 1.0_wp, -4.0_wp, 1.0_wp, 2.0_wp, 1.0_wp, -5.0_wp], f)
      first = log((wide + d_peak)/d_peak)
      call check_close(error, f(3), -80.0_wp*0.9_wp**first, 1.0e-12_wp, 0.0_wp, 'after one opening')
      all = first + wide/(wide + d_peak) + log((wider + d_peak)/(wide + d_peak))
      call check_close(error, f(7), -70.0_wp*0.9_wp**all, 1.0e-12_wp, 0.0_wp, 'envelope, after two')
      ! In parts: closing in between adds nothing, opening again does.
      call follow_path(spec, [-4.0_wp, 0.5_wp, 1.0_wp, 0.0_wp, 1.0_wp, 1.0_wp, -4.0_wp], f)
      call check_close(error, f(7), -80.0_wp*0.9_wp**(first + 1.0_wp/(wide + d_peak)), 1.0e-12_wp, 0.0_wp, &
                       'in parts')
      call follow_path(spec, [-2.0_wp, 1.0_wp, -2.0_wp], f(:3))
      call check_close(error, f(3), -100.0_wp*0.9_wp**(0.5_wp*log((0.466875_wp + 1.0_wp + d_peak)/d_peak)), &
                       1.0e-12_wp, 0.0_wp, 'at the peak')
   end subroutine wear

   !> Unloading from (4, 80) leads to c_p = 2 (0.84 - 0.0415625), along a slope of 80/(4 - c_p); with half of
   !> it lost to friction opening is on half of that line.
   subroutine friction(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp), parameter :: c_p = 2.0_wp*(0.84_wp - 0.0415625_wp), slope = 80.0_wp/(4.0_wp - c_p)
      type(spring_record) :: spec
      real(wp) :: f(8)

      spec = hand()
      call set_value(spec, 'friction', 0.5_wp)
      call follow_path(spec, [-4.0_wp, -3.7_wp, -3.0_wp, -2.0_wp, -2.02_wp, -3.0_wp, -4.0_wp, -5.0_wp], f)
      call check_close(error, f, -[80.0_wp, 50.0_wp, 0.5_wp*slope*(3.0_wp - c_p), &
                                   0.5_wp*slope*(2.0_wp - c_p), 0.5_wp*slope*(2.0_wp - c_p) + 2.0_wp, &
                                   slope*(3.0_wp - c_p), 80.0_wp, 70.0_wp], 1.0e-12_wp, 0.0_wp, 'force')
      ! No friction where the virgin spring is elastic.
      call follow_path(spec, [-0.4_wp, -0.2_wp, 0.0_wp, -0.2_wp, -0.4_wp, -0.2_wp, 0.0_wp, 1.0_wp], f)
      call check_close(error, f(2), 0.5_wp*f(1), 1.0e-12_wp, 0.0_wp, 'elastic')
   end subroutine friction

end module test_concrete
