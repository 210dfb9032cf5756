!> Elastic and bilinear springs (takeda.md section 2c and the bilinear sequence of section 4).
module test_bilinear
   use check, only: unit_test, check_close, check_equal, check_same
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_springs, only: follow_path, spring_array
   use samples, only: bilinear, bilinear_1, s_k, s_d, s_post
   implicit none
   private

   public :: collect_bilinear

   !> Force at zero deformation of the bounding lines.
   real(wp), parameter :: q = (s_k - s_post)*s_d

contains

   subroutine collect_bilinear(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('takeda.md section 4, the bilinear sequence', sequence), &
               unit_test('work of a closed cycle is the area of the loop', work_of_cycle), &
               unit_test('k_post = 0: the force stays at yield', perfectly_plastic), &
               unit_test('after a turn and back on the bounding line it continues', turn_and_back)]
   end subroutine collect_bilinear

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

end module test_bilinear
