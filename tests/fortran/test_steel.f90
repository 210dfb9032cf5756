!> Steel as a bank of slipping elements (docs/rules.md section 13).
!>
!> Springs here yield at (1, 1). A roundness of 1e12 makes the limits of all elements equal, so that the bank
!> is bilinear and every force is known in closed form.
module test_steel
   use check, only: unit_test, check_close, check_true
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_springs, only: follow_path, spring_array
   use rbs_hysteresis_spring_record, only: spring_record
   use samples, only: make_springs, set_value, random_type
   implicit none
   private

   public :: collect_steel

   !> Limits of the elements at the plastic reaches 3.2 and 6.4, roundness 20, 0.925, 0.15.
   real(wp), parameter :: y_32(7) = [0.203404095650_wp, 0.423449427538_wp, 0.683686723388_wp, &
                                     1.015613042036_wp, 1.528778537409_wp, 2.455739543281_wp, 4.2_wp]
   real(wp), parameter :: y_64(7) = [0.122638480162_wp, 0.319586818913_wp, 0.583150651000_wp, &
                                     0.948469798059_wp, 1.552550838535_wp, 2.717909087577_wp, &
                                     7.227823339223_wp]
   real(wp), parameter :: share(7) = [0.06_wp, 0.19_wp, 0.25_wp, 0.25_wp, 0.17_wp, 0.065_wp, 0.015_wp]

contains

   subroutine collect_steel(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('steel.md S2 to S4: branches by the limits of the elements', by_limits), &
               unit_test('steel.md S5: end of hardening, plateau', plateau), &
               unit_test('steel.md S6: wear inside the reach', wear), &
               unit_test('wear ends at zero force', worn_out), &
               unit_test('steel.md S7: isotropic hardening', hardening), &
               unit_test('the virgin curve is exact whatever the roundness', virgin), &
               unit_test('few lines in a cycle', lines_of_cycle), &
               unit_test('bars that were stretched far wear faster in compression', buckling)]
   end subroutine collect_steel

   !> Yields at (1, 1).
   type(spring_record) function bank(k_post) result(spec)
      real(wp), intent(in) :: k_post

      spec%rule = 'steel'
      call set_value(spec, 'k', 1.0_wp)
      call set_value(spec, 'f_y', 1.0_wp)
      call set_value(spec, 'k_post', k_post)
   end function bank

   !> The same without roundness.
   type(spring_record) function sharp(k_post) result(spec)
      real(wp), intent(in) :: k_post

      spec = bank(k_post)
      call set_value(spec, 'r0', 1.0e12_wp)
      call set_value(spec, 'cr1', 0.0_wp)
   end function sharp

   subroutine check_path(error, spec, d, expected, what)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_record), intent(in) :: spec
      real(wp), intent(in) :: d(:), expected(:)
      character(len=*), intent(in) :: what
      real(wp) :: f(size(d))

      call follow_path(spec, d, f)
      call check_close(error, f, expected, 0.0_wp, 1.0e-9_wp, what)
   end subroutine check_path

   !> After a turn at (4.2, 1) the force is 1 - sum k_i min(4.2 - d, 2 Y_i) down to -1.
   subroutine by_limits(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp), parameter :: d(7) = [4.2_wp, 4.0_wp, 3.2_wp, 2.2_wp, 1.2_wp, 0.2_wp, -1.0_wp]
      real(wp), parameter :: printed(7) = [1.0_wp, 0.8_wp, 0.0646807260575_wp, -0.527162635637_wp, &
                                           -0.784969156655_wp, -0.874753859374_wp, -0.952_wp]
      real(wp) :: by_hand(7)
      integer :: j

      call check_path(error, bank(0.0_wp), d, printed, 'S2')
      do j = 1, size(d)
         by_hand(j) = 1.0_wp - sum(share*min(4.2_wp - d(j), 2.0_wp*y_32))
      end do
      call check_close(error, printed, by_hand, 0.0_wp, 1.0e-9_wp, 'S2 by hand')
      call check_path(error, bank(0.0_wp), [4.2_wp, 0.2_wp, 1.2_wp, 0.7_wp, 1.2_wp, 0.2_wp, -1.0_wp], &
                      [1.0_wp, printed(6), 0.060565414569_wp, -0.433843076909_wp, 0.060565414569_wp, &
                       printed(6), -0.952_wp], 'S3')
      ! The last element follows its limit, which grows as fast as it does.
      call check_path(error, bank(0.0_wp), [4.2_wp, -1.0_wp, -4.2_wp, -1.0_wp, 4.2_wp], &
                      [1.0_wp, -0.952_wp, -0.954582649912_wp, 0.731254468527_wp, 0.954582649912_wp], 'S4')
      call check_close(error, -(1.0_wp - share(7)*y_64(7)) - 0.063_wp, -0.954582649912_wp, 0.0_wp, &
                       1.0e-9_wp, 'S4 by hand')
   end subroutine by_limits

   subroutine plateau(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_record) :: spec

      spec = sharp(0.05_wp)
      call set_value(spec, 'f_u', 1.2_wp)
      call set_value(spec, 'plateau', 3.0_wp)
      call check_path(error, spec, [3.9_wp, 5.0_wp, 8.0_wp, 20.0_wp, 18.0_wp, 10.0_wp, 9.0_wp], &
                      [1.0_wp, 1.05_wp, 1.2_wp, 1.2_wp, -0.8_wp, -1.2_wp, -1.2_wp], 'corners at 4 and 8')
      call check_path(error, spec, [3.0_wp, 1.0_wp, -1.0_wp, -2.0_wp, -4.0_wp, -2.0_wp], &
                      [1.0_wp, -1.0_wp, -1.0_wp, -1.0_wp, -1.1_wp, 0.9_wp], 'what is left of the plateau')
   end subroutine plateau

   !> The strength falls by 1/99 per d_y: all of the deformation is plastic but for what the force loses.
   subroutine wear(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_record) :: spec

      spec = sharp(0.0_wp)
      call set_value(spec, 'endurance', 50.0_wp)
      call check_path(error, spec, [2.0_wp, 0.0_wp, -1.0_wp, -3.0_wp, 2.0_wp], &
                      [1.0_wp, -1.0_wp, -98.0_wp/99.0_wp, -98.0_wp/99.0_wp, 9403.0_wp/9801.0_wp], 'S6')
   end subroutine wear

   !> Hardening without end does not wear.
   subroutine worn_out(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_record) :: spec
      type(spring_array) :: spring
      integer :: i

      spec = bank(0.01_wp)
      call set_value(spec, 'endurance', 50.0_wp)
      call make_springs(spring, [spec])
      do i = 1, 40
         call spring%advance_to(1, 4.0_wp*(-1)**i)
      end do
      call check_close(error, spring%force(1), 0.04_wp, 0.0_wp, 1.0e-12_wp, 'worn out')
      call spring%advance_to(1, -20.0_wp)
      call check_close(error, spring%force(1), -0.2_wp, 0.0_wp, 1.0e-12_wp, 'further out')
   end subroutine worn_out

   subroutine hardening(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_record) :: spec
      real(wp) :: h(2)

      h = 1.0_wp + 0.1_wp*(0.5_wp*[0.1_wp, 3.2_wp])**0.8_wp
      spec = sharp(0.0_wp)
      call set_value(spec, 'isotropic_hardening', 0.1_wp)
      call check_path(error, spec, [1.05_wp, 1.1_wp, 4.2_wp], [0.5_wp*(1.0_wp + h(1)), h(1), h(2)], 'S7')
      call check_path(error, spec, [1.05_wp, 1.1_wp, 4.2_wp], &
                      [1.00455141051_wp, 1.00910282102_wp, 1.14564513624_wp], 'S7 as printed')
      ! Growth by the share 0.1 at a plastic reach of 2 hardening_reach.
      call set_value(spec, 'hardening_reach', 1.6_wp)
      call check_path(error, spec, [4.2_wp], [1.1_wp], 'with a reach of its own')
   end subroutine hardening

   subroutine virgin(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      type(spring_record) :: spec
      real(wp) :: b, f(9), f_u, flat
      real(wp), parameter :: d(9) = [0.5_wp, 0.99_wp, 1.01_wp, 1.5_wp, 3.0_wp, 9.0_wp, 30.0_wp, 200.0_wp, &
                                     1000.0_wp]
      integer :: path

      do path = 1, 200
         b = random%uniform(0.001_wp, 0.2_wp)
         f_u = random%uniform(1.0_wp, 2.0_wp)
         flat = random%uniform(0.0_wp, 30.0_wp)
         if (path == 1) flat = 0.0_wp
         spec = bank(b)
         call set_value(spec, 'r0', random%uniform(0.5_wp, 25.0_wp))
         call set_value(spec, 'cr1', random%uniform(0.0_wp, 0.95_wp))
         call set_value(spec, 'cr2', random%uniform(0.05_wp, 0.5_wp))
         call follow_path(spec, d, f)
         call check_close(error, f, min(d, 1.0_wp + b*(d - 1.0_wp)), 1.0e-11_wp, 0.0_wp, 'without end')
         call set_value(spec, 'f_u', f_u)
         call set_value(spec, 'plateau', flat)
         call follow_path(spec, d, f)
         call check_close(error, f, min(d, 1.0_wp + b*max(d - 1.0_wp - flat, 0.0_wp), f_u), 1.0e-11_wp, &
                          0.0_wp, 'with plateau and end')
      end do
   end subroutine virgin

   !> Seven elements each way, the reversals and the way out.
   subroutine lines_of_cycle(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_array) :: spring
      real(wp), parameter :: amplitudes(4) = [2.5_wp, 5.0_wp, 10.0_wp, 20.0_wp]
      integer :: i, j, before

      do i = 1, size(amplitudes)
         call make_springs(spring, [bank(0.01_wp)])
         do j = 1, 6
            if (j == 5) before = spring%events
            call spring%advance_to(1, amplitudes(i)*(-1)**(j + 1))
         end do
         call check_true(error, spring%events - before <= 18, 'lines of the third cycle')
      end do
   end subroutine lines_of_cycle

   !> Stretched to 4 = 2 d_buckle, a unit of plastic compression counts 1 + 4 (2 - 1) = 5 times: the strength
   !> loses 5/(2 endurance - 5) = 1/19 for each unit of the way; in tension 1/99 as ever.
   subroutine buckling(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_record) :: spec
      real(wp) :: f(4)

      spec%rule = 'steel'
      call set_value(spec, 'k', 1.0_wp)
      call set_value(spec, 'f_y', 1.0_wp)
      call set_value(spec, 'k_post', 0.0_wp)
      call set_value(spec, 'r0', 1.0e12_wp)
      call set_value(spec, 'cr1', 0.0_wp)
      call set_value(spec, 'endurance', 50.0_wp)
      call set_value(spec, 'd_buckle', 2.0_wp)
      call set_value(spec, 'buckling', 4.0_wp)
      call follow_path(spec, [4.0_wp, -1.0_wp, -3.0_wp, 4.0_wp], f)
      call check_close(error, f, [1.0_wp, -16.0_wp/19.0_wp, -16.0_wp/19.0_wp, 1483.0_wp/1881.0_wp], &
                       1.0e-12_wp, 0.0_wp, 'stretched to twice d_buckle')
      call follow_path(spec, [2.0_wp, 0.0_wp, -1.0_wp, 0.0_wp], f)
      call check_close(error, f(3), -98.0_wp/99.0_wp, 1.0e-12_wp, 0.0_wp, 'stretched to d_buckle')
   end subroutine buckling

end module test_steel
