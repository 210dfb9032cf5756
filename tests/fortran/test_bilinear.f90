!> Elastic and bilinear springs (takeda.md section 2c and the bilinear sequence of section 4).
module test_bilinear
   use check, only: unit_test, check_close, check_equal, check_same
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_springs, only: follow_path, spring_array
   use rbs_hysteresis_spring_record, only: spring_record
   use samples, only: elastic, bilinear, bilinear_1, s_k, s_d, s_post, random_type
   implicit none
   private

   public :: collect_bilinear

   !> Force at zero deformation of the bounding lines.
   real(wp), parameter :: q = (s_k - s_post)*s_d

contains

   subroutine collect_bilinear(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('elastic: one line for every path', elastic_line), &
               unit_test('takeda.md section 4, the bilinear sequence', sequence), &
               unit_test('takeda.md section 2c, the median on random paths', median), &
               unit_test('the elastic range is 2 d_y wide', elastic_range), &
               unit_test('work of a closed cycle is the area of the loop', work_of_cycle), &
               unit_test('k_post = 0: the force stays at yield', perfectly_plastic), &
               unit_test('after a turn and back on the bounding line it continues', turn_and_back), &
               unit_test('one move through several lines', long_move)]
   end subroutine collect_bilinear

   subroutine elastic_line(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp), parameter :: d(5) = [1.0_wp, -2.0_wp, 0.0_wp, 1.0e30_wp, -1.0e30_wp]
      real(wp) :: f(5)

      call follow_path(elastic(3.0_wp), d, f)
      call check_same(error, f, 3.0_wp*d, 'force')
   end subroutine elastic_line

   subroutine sequence(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp), parameter :: d(8) = [1.0e-4_wp, -1.0e-4_wp, 5.0e-4_wp, 3.0e-4_wp, 5.0e-4_wp, -5.0e-4_wp, &
                                     1.0e-3_wp, 0.0_wp]
      real(wp), parameter :: printed(8) = [70387.000_wp, -70387.000_wp, 94302.724_wp, -46471.276_wp, &
                                           94302.724_wp, -94302.724_wp, 98461.974_wp, -90143.474_wp]
      real(wp) :: by_hand(8), f(8)

      by_hand = [s_k*1.0e-4_wp, -s_k*1.0e-4_wp, s_post*5.0e-4_wp + q, &
                 s_post*5.0e-4_wp + q - s_k*2.0e-4_wp, s_post*5.0e-4_wp + q, -s_post*5.0e-4_wp - q, &
                 s_post*1.0e-3_wp + q, -q]
      call follow_path(bilinear_1(), d, f)
      call check_close(error, f, printed, 0.0_wp, 1.0e-3_wp, 'printed')
      call check_close(error, f, by_hand, 1.0e-9_wp, 0.0_wp, 'by hand')
   end subroutine sequence

   !> F = median(F_old + k dD, k_post D + q, k_post D - q).
   subroutine median(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      type(spring_record) :: spec
      real(wp) :: d(200), f(200), by_median(200), k, k_post, d_old, f_old
      integer :: path, j

      do path = 1, 50
         k = random%uniform(1.0_wp, 5.0_wp)
         k_post = k*random%uniform(0.0_wp, 0.9_wp)
         spec = bilinear(k, 1.0_wp, k_post)
         d_old = 0.0_wp
         f_old = 0.0_wp
         do j = 1, size(d)
            d(j) = random%uniform(-5.0_wp, 5.0_wp)
            f_old = f_old + k*(d(j) - d_old)
            f_old = min(max(f_old, k_post*d(j) - (k - k_post)), k_post*d(j) + (k - k_post))
            d_old = d(j)
            by_median(j) = f_old
         end do
         call follow_path(spec, d, f)
         ! The median accumulates round-off, the spring does not.
         call check_close(error, f, by_median, 1.0e-12_wp, 1.0e-12_wp, 'median')
      end do
   end subroutine median

   subroutine elastic_range(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp) :: f(4), peak

      peak = s_post*5.0e-4_wp + q
      call follow_path(bilinear_1(), [5.0e-4_wp, 5.0e-4_wp - 1.999_wp*s_d, 5.0e-4_wp - 2.0_wp*s_d, &
                                      5.0e-4_wp - 3.0_wp*s_d], f)
      call check_close(error, f, [peak, peak - s_k*1.999_wp*s_d, peak - s_k*2.0_wp*s_d, &
                                  peak - s_k*2.0_wp*s_d - s_post*s_d], 1.0e-12_wp, 0.0_wp, 'force')
   end subroutine elastic_range

   subroutine work_of_cycle(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_array) :: spring
      real(wp) :: before
      integer :: j

      call spring%create([bilinear_1()])
      do j = 1, 3
         call spring%advance_to(1, 5.0_wp*s_d)
         if (j == 3) exit
         before = spring%work(1)
         call spring%advance_to(1, -5.0_wp*s_d)
      end do
      ! A parallelogram of height 2 q and width 2 (5 - 1) d_y, the plastic deformation.
      call check_close(error, spring%work(1) - before, 2.0_wp*q*8.0_wp*s_d, 1.0e-12_wp, 0.0_wp, 'work')
      call check_equal(error, spring%events, 9, 'lines left')
   end subroutine work_of_cycle

   subroutine perfectly_plastic(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp) :: f(4)

      call follow_path(bilinear(2.0_wp, 0.5_wp, 0.0_wp), [0.5_wp, 7.0_wp, 5.5_wp, 6.0_wp], f)
      call check_same(error, f, [1.0_wp, 1.0_wp, -1.0_wp, 0.0_wp], 'force')
   end subroutine perfectly_plastic

   subroutine turn_and_back(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp) :: f(4), direct(1)

      call follow_path(bilinear_1(), [5.0e-4_wp, 4.5e-4_wp, 5.0e-4_wp, 7.0e-4_wp], f)
      call follow_path(bilinear_1(), [7.0e-4_wp], direct)
      call check_close(error, f(3), f(1), 1.0e-15_wp, 0.0_wp, 'back where it turned')
      call check_same(error, f(4), direct(1), 'as if it had not turned')
   end subroutine turn_and_back

   subroutine long_move(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp) :: f(2)

      call follow_path(bilinear_1(), [1.0_wp, -1.0_wp], f)
      call check_close(error, f, [s_post + q, -s_post - q], 1.0e-15_wp, 0.0_wp, 'force')
   end subroutine long_move

end module test_bilinear
