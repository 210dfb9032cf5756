!> The trilinear Takeda spring: sequences S1 to S4 of takeda.md by hand, rules and properties.
module test_takeda
   use check, only: unit_test, check_close, check_same, check_true
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_springs, only: follow_path, spring_array
   use rbs_hysteresis_spring_record, only: spring_record
   use samples, only: make_springs, value_of, takeda, takeda_1, k_c, d_c, k_y, d_y, k_u, b0, b1, f_c, f_y, &
                      k_0, random_type
   implicit none
   private

   public :: collect_takeda

   character(len=3), parameter :: inner(3) = ['kc ', 'kr ', 'one']

   !> The peak at 4 d_y, the slope of unloading from it, the zero crossing after unloading from the opposite
   !> peak, and the slope of reloading from there.
   real(wp), parameter :: f_4 = f_y + 3.0_wp*k_u*d_y, k_r4 = k_0*(1.0_wp/4.0_wp)**b0
   real(wp), parameter :: zero_4 = -4.0_wp*d_y + f_4/k_r4, slope_4 = f_4/(4.0_wp*d_y - zero_4)

contains

   subroutine collect_takeda(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('S2 cracked, not yielded', s2), &
               unit_test('S3 yielded, full reversals, with work', s3), &
               unit_test('S4 partial unloading, inner loops', s4), &
               unit_test('equality: a turn at zero force leads directly to the other side', turn_at_zero), &
               unit_test('a turn at zero force without a way beyond it leaves no trace', no_way), &
               unit_test('6000 nested peaks: the oldest are forgotten, without a jump', forgotten_peaks), &
               unit_test('partial unloading does not fill the memory', partial_unloading)]
   end subroutine collect_takeda

   subroutine s2(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp), parameter :: d(7) = [1.0e-3_wp, -1.5e-3_wp, 2.0e-3_wp, -2.0e-3_wp, 2.0e-3_wp, -2.0e-3_wp, &
                                     0.0_wp]
      real(wp), parameter :: printed(7) = [123958.196_wp, -155426.696_wp, 186895.196_wp, -186895.196_wp, &
                                           186895.196_wp, -186895.196_wp, 30024.092_wp]
      real(wp) :: f(7), f_2, k_r, zero, before
      type(spring_array) :: spring
      integer :: i, j

      f_2 = f_c + k_y*(2.0e-3_wp - d_c)
      k_r = (f_2 + f_c)/(2.0e-3_wp + d_c)
      zero = -2.0e-3_wp + f_2/k_r
      do i = 1, 3
         call follow_path(takeda_1(inner(i)), d, f)
         call check_close(error, f, printed, 0.0_wp, 1.0e-3_wp, inner(i)//' printed')
         call check_close(error, f, [f_c + k_y*(1.0e-3_wp - d_c), -(f_c + k_y*(1.5e-3_wp - d_c)), f_2, -f_2, &
                                     f_2, -f_2, -zero*f_2/(2.0e-3_wp - zero)], 1.0e-9_wp, 0.0_wp, &
                          inner(i)//' by hand')
         call make_springs(spring, [takeda_1(inner(i))])
         do j = 1, 6
            call spring%advance_to(1, d(j))
            if (j == 4) before = spring%work(1)
         end do
         ! For each half cycle the loading triangle less the unloading triangle.
         call check_close(error, spring%work(1) - before, f_2*(2.0e-3_wp - zero) - f_2**2/k_r, 1.0e-9_wp, &
                          0.0_wp, inner(i)//' work of the cycle')
         call check_close(error, spring%work(1) - before, 143.082_wp, 0.0_wp, 1.0e-3_wp, &
                          inner(i)//' printed work')
      end do
   end subroutine s2

   subroutine s3(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp), parameter :: f_2 = f_y + k_u*d_y
      real(wp), parameter :: d(9) = [2, -2, 2, -2, 4, -4, 4, -4, 0]*d_y
      real(wp), parameter :: by_hand(9) = [f_2, -f_2, f_2, -f_2, f_4, -f_4, f_4, -f_4, -slope_4*zero_4]
      real(wp), parameter :: printed(9) = [252699.946_wp, -252699.946_wp, 252699.946_wp, -252699.946_wp, &
                                           293894.152_wp, -293894.152_wp, 293894.152_wp, -293894.152_wp, &
                                           103502.562_wp]
      real(wp), parameter :: printed_work(9) = [1047.589_wp, 1948.207_wp, 2504.922_wp, 3061.638_wp, &
                                                5104.161_wp, 7294.555_wp, 9031.762_wp, 10768.970_wp, &
                                                10345.690_wp]
      real(wp) :: f(9), work(9)
      type(spring_array) :: spring
      integer :: i, j

      do i = 1, 3
         call make_springs(spring, [takeda_1(inner(i))])
         do j = 1, 9
            call spring%advance_to(1, d(j))
            f(j) = spring%force(1)
            work(j) = spring%work(1)
         end do
         call check_close(error, f, by_hand, 1.0e-9_wp, 0.0_wp, inner(i)//' by hand')
         call check_close(error, f, printed, 0.0_wp, 1.0e-3_wp, inner(i)//' printed')
         call check_close(error, work, printed_work, 0.0_wp, 1.0e-3_wp, inner(i)//' printed work')
         ! The first leg is the area under the backbone, the last the triangles to zero.
         call check_close(error, work(1), 0.5_wp*f_c*d_c + 0.5_wp*(f_c + f_y)*(d_y - d_c) &
                          + 0.5_wp*(f_y + f_2)*d_y, 1.0e-12_wp, 0.0_wp, inner(i)//' work of the first leg')
         call check_close(error, work(9) - work(8), -0.5_wp*f_4**2/k_r4 + 0.5_wp*slope_4*zero_4**2, &
                          1.0e-9_wp, 0.0_wp, inner(i)//' work of the last leg')
      end do
   end subroutine s3

   subroutine s4(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp), parameter :: d(15) = [4.0_wp, -4.0_wp, 1.0_wp, 0.6_wp, 1.5_wp, -1.0_wp, 0.5_wp, -0.5_wp, &
                                      0.5_wp, -1.0_wp, 1.5_wp, 2.0_wp, -4.0_wp, 5.0_wp, 0.0_wp]*d_y
      ! Points 4 to 10 for 'kc', 'kr' and 'one'
      real(wp), parameter :: printed(4:10, 3) = reshape([ &
         90274.039_wp, 174899.408_wp, -91201.345_wp, 82859.284_wp, -43457.444_wp, 82859.284_wp, &
         -91201.345_wp, &
         132061.300_wp, 174899.408_wp, 55904.664_wp, 127301.510_wp, 79703.613_wp, 127301.510_wp, &
         55904.664_wp, &
         86702.254_wp, 174899.408_wp, -94130.951_wp, 83583.356_wp, -46145.804_wp, 83583.356_wp, &
         -94130.951_wp], [7, 3])
      real(wp) :: f(15)
      integer :: i

      do i = 1, 3
         call follow_path(takeda_1(inner(i)), d, f)
         call check_close(error, f, s4_by_hand(inner(i)), 1.0e-9_wp, 0.0_wp, inner(i)//' by hand')
         call check_close(error, f(4:10), printed(:, i), 0.0_wp, 1.0e-3_wp, inner(i)//' printed')
         call check_close(error, f(11:15), [174899.408_wp, 198698.357_wp, -293894.152_wp, 314491.254_wp, &
                                            -122632.372_wp], 0.0_wp, 1.0e-3_wp, inner(i)//' printed, end')
         call check_same(error, f(9:11), [f(7), f(6), f(5)], inner(i)//' closed loops')
      end do
   end subroutine s4

   !> Sequence S4, point by point as in the table of takeda.md section 4.
   pure function s4_by_hand(option) result(f)
      character(len=*), intent(in) :: option
      real(wp) :: f(15)
      real(wp) :: k_in, z(6:9), slope(6:8), f_5, k_r5, z_5

      k_in = k_r4
      if (option == 'kc') k_in = min(b1*k_c, k_r4)
      if (option == 'kr') k_in = max(b1*k_r4, slope_4)

      f(1) = f_4
      f(2) = -f_4
      f(3) = slope_4*(d_y - zero_4)
      f(4) = f(3) - k_in*0.4_wp*d_y
      f(5) = slope_4*(1.5_wp*d_y - zero_4)
      if (option == 'kr') then
         ! K_in is the secant: everything stays on the reloading line.
         f(6:8) = slope_4*([-1.0_wp, 0.5_wp, -0.5_wp]*d_y - zero_4)
      else
         z(6) = 1.5_wp*d_y - f(5)/k_in
         slope(6) = f_4/(z(6) + 4.0_wp*d_y)
         f(6) = -slope(6)*(z(6) + d_y)
         z(7) = -d_y - f(6)/k_in
         slope(7) = f(5)/(1.5_wp*d_y - z(7))
         f(7) = slope(7)*(0.5_wp*d_y - z(7))
         z(8) = 0.5_wp*d_y - f(7)/k_in
         slope(8) = -f(6)/(d_y + z(8))
         f(8) = -slope(8)*(0.5_wp*d_y + z(8))
      end if
      f(9:11) = [f(7), f(6), f(5)]
      f(12) = slope_4*(2.0_wp*d_y - zero_4)
      f(13) = -f_4
      f_5 = f_y + 4.0_wp*k_u*d_y
      f(14) = f_5
      k_r5 = k_0*(1.0_wp/5.0_wp)**b0
      z_5 = 5.0_wp*d_y - f_5/k_r5
      f(15) = -f_4/(z_5 + 4.0_wp*d_y)*z_5
   end function s4_by_hand

   !> Turn a few floating-point numbers beyond a crossing of zero force, where force and distance are
   !> round-off: their ratio must not become a slope.
   subroutine turn_at_zero(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      type(spring_record) :: spec
      type(spring_array) :: spring
      real(wp) :: d(12), back
      integer :: path, j, ulps, direction, found

      found = 0
      do path = 1, 400
         call random_spring(random, spec)
         call random_path(random, value_of(spec, 'd_y'), d)
         call make_springs(spring, [spec])
         do j = 1, size(d)
            call spring%advance_to(1, d(j))
            if (.not. (spring%includes_lower_end(1) .or. spring%includes_upper_end(1))) cycle
            if (spring%unload_on_reversal(1) /= 0) cycle
            direction = merge(1, -1, spring%includes_upper_end(1))
            found = found + 1
            call spring%arrive(1, direction)
            back = spring%d(1) - 1.0e-3_wp*direction
            do ulps = 1, 1 + mod(path, 4)
               call spring%advance_to(1, nearest(spring%d(1), real(direction, wp)))
            end do
            call spring%advance_to(1, back)
            call check_true(error, spring%k(1) > 0.0_wp .and. spring%k(1) < 1.0_wp, 'slope after the turn')
            call check_close(error, spring%force(1), 0.0_wp, 0.0_wp, 1.0e-3_wp, 'force after the turn')
         end do
      end do
      call check_true(error, found > 300, 'enough turns')
   end subroutine turn_at_zero

   !> At a corner of a static path a spring is put on the line beyond zero force, and back, where it is.
   subroutine no_way(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      type(spring_record) :: spec
      type(spring_array) :: spring, twin
      real(wp) :: d(12)
      integer :: path, j, direction

      do path = 1, 400
         call random_spring(random, spec)
         call random_path(random, value_of(spec, 'd_y'), d)
         call make_springs(spring, [spec])
         twin = spring
         do j = 1, size(d)
            call spring%advance_to(1, d(j))
            call twin%advance_to(1, d(j))
            call check_same(error, [twin%force(1)], [spring%force(1)], 'force')
            if (.not. (spring%includes_lower_end(1) .or. spring%includes_upper_end(1))) cycle
            if (spring%unload_on_reversal(1) /= 0) cycle
            direction = merge(1, -1, spring%includes_upper_end(1))
            call spring%arrive(1, direction)
            call twin%arrive(1, direction)
            call twin%leave(1, direction)
            call twin%leave(1, -direction)
            call spring%advance_to(1, spring%d(1) - 0.3_wp*direction)
            call twin%advance_to(1, spring%d(1))
         end do
      end do
   end subroutine no_way

   !> Parameters over the whole range on which takeda.md section 3 was tested.
   subroutine random_spring(random, spec)
      type(random_type), intent(inout) :: random
      type(spring_record), intent(out) :: spec
      real(wp) :: yield, k_yield, k_ultimate, factor

      yield = random%uniform(1.05_wp, 15.0_wp)
      k_yield = random%uniform(0.05_wp, 0.9_wp)
      k_ultimate = k_yield*random%uniform(0.0_wp, 0.9_wp)
      factor = random%uniform(0.05_wp, 1.5_wp)
      spec = takeda(1.0_wp, 1.0_wp, k_yield, yield, k_ultimate, random%uniform(0.0_wp, 1.0_wp), factor, &
                    inner(1 + int(random%uniform(0.0_wp, 2.999_wp))))
   end subroutine random_spring

   !> Points from small to far beyond yield; some exact returns to earlier ones, some to zero.
   subroutine random_path(random, yield, d)
      type(random_type), intent(inout) :: random
      real(wp), intent(in) :: yield
      real(wp), intent(out) :: d(:)
      real(wp) :: kind, size_now
      integer :: j

      size_now = yield*random%uniform(0.3_wp, 6.0_wp)
      do j = 1, size(d)
         kind = random%uniform(0.0_wp, 1.0_wp)
         if (j > 2 .and. kind < 0.2_wp) then
            d(j) = d(1 + int(random%uniform(0.0_wp, j - 1.001_wp)))
         else if (kind < 0.25_wp) then
            d(j) = 0.0_wp
         else
            d(j) = random%uniform(-size_now, size_now)
         end if
      end do
   end subroutine random_path

   !> Ever smaller cycles inside +-4 d_y; vertex j alternates in sign.
   elemental real(wp) function vertex(j, n)
      integer, intent(in) :: j, n

      vertex = d_y*(3.5_wp - 3.0_wp*j/n)
      if (mod(j, 2) == 0) vertex = -vertex
   end function vertex

   !> More than `most_peaks` = 4096: the older half is forgotten when the memory is full.
   subroutine forgotten_peaks(error)
      type(error_type), allocatable, intent(inout) :: error
      integer, parameter :: n = 6000, kept = 4096/2 + (n - 4096)
      type(spring_array) :: spring
      real(wp) :: f(n), d_before, f_before
      integer :: j

      call make_springs(spring, [takeda_1('kc')])
      call spring%advance_to(1, 4.0_wp*d_y)
      call spring%advance_to(1, -4.0_wp*d_y)
      do j = 1, n
         call spring%advance_to(1, vertex(j, n))
         f(j) = spring%force(1)
      end do
      do j = n - 1, 1, -2
         d_before = spring%d(1)
         f_before = spring%force(1)
         call spring%advance_to(1, vertex(j, n))
         if (j > n - kept) call check_same(error, spring%force(1), f(j), 'remembered loop')
         call check_true(error, abs(spring%force(1) - f_before) &
                         <= k_c*abs(spring%d(1) - d_before)*(1.0_wp + 1.0e-8_wp), 'a jump of the force')
      end do
      call spring%advance_to(1, 4.0_wp*d_y)
      call check_close(error, spring%force(1), f_4, 1.0e-15_wp, 0.0_wp, 'the peak')
      call spring%advance_to(1, 5.0_wp*d_y)
      call check_close(error, spring%force(1), f_y + 4.0_wp*k_u*d_y, 1.0e-15_wp, 0.0_wp, 'the backbone')
      call spring%advance_to(1, 0.0_wp)
      call check_close(error, spring%force(1), -122632.372_wp, 0.0_wp, 1.0e-3_wp, 'S4, last point')
   end subroutine forgotten_peaks

   !> More often than peaks are remembered: the open ones from before are all still there.
   subroutine partial_unloading(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp), parameter :: nest(7) = [4.0_wp, -4.0_wp, 3.0_wp, -3.0_wp, 2.0_wp, -2.0_wp, 1.0_wp]*d_y
      type(spring_array) :: spring
      real(wp) :: f(9)
      integer :: j

      call follow_path(takeda_1('kc'), [nest, 2.5_wp*d_y, 3.5_wp*d_y], f)
      call make_springs(spring, [takeda_1('kc')])
      do j = 1, size(nest)
         call spring%advance_to(1, nest(j))
      end do
      do j = 1, 5000
         call spring%advance_to(1, 0.95_wp*d_y)
         call spring%advance_to(1, 1.0_wp*d_y)
      end do
      call spring%advance_to(1, 2.5_wp*d_y)
      call check_same(error, spring%force(1), f(8), 'toward the peak at 3')
      call spring%advance_to(1, 3.5_wp*d_y)
      call check_same(error, spring%force(1), f(9), 'toward the peak at 4')
   end subroutine partial_unloading

end module test_takeda
