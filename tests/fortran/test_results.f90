!> Rows, recorder and summary.
module test_results
   use check, only: unit_test, check_equal, check_same, check_true
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_output_recorder, only: array_recorder
   use rbs_output_summary, only: summary_type
   implicit none
   private

   public :: collect_results

contains

   subroutine collect_results(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('recorder keeps rows until it is full', recorder), &
               unit_test('summary has peaks with sign, of kept and other rows', peaks), &
               unit_test('how a run ends', ends)]
   end subroutine collect_results

   subroutine recorder(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(array_recorder) :: keeper

      keeper%expected = 2
      call keeper%record([1.0_wp, 2.0_wp, 3.0_wp], outcome)
      call keeper%record([4.0_wp, 5.0_wp, 6.0_wp], outcome)
      call keeper%record([7.0_wp, 8.0_wp, 9.0_wp], outcome)
      call check_true(error, .not. allocated(outcome), 'a full recorder takes more rows')
      call check_equal(error, keeper%count, 3, 'rows kept')
      call check_same(error, pack(keeper%rows(:, :3), .true.), 1.0_wp*[1, 2, 3, 4, 5, 6, 7, 8, 9], 'rows')
   end subroutine recorder

   subroutine peaks(error)
      type(error_type), allocatable, intent(inout) :: error
      type(summary_type) :: summary

      call summary%see_peak(0.1_wp, 5.0_wp)
      call summary%see_peak(-0.3_wp, -4.0_wp)
      call summary%see_peak(0.2_wp, -6.0_wp)
      call summary%see_peak(0.3_wp, 6.0_wp)
      call check_same(error, summary%peak_displacement, -0.3_wp, 'peak displacement: the first of two')
      call check_same(error, summary%peak_force, -6.0_wp, 'peak force')
      call check_same(error, summary%displacement_at_peak, 0.2_wp, 'displacement there')
      call check_equal(error, summary%rows, 0, 'no row')
   end subroutine peaks

   subroutine ends(error)
      type(error_type), allocatable, intent(inout) :: error
      type(summary_type) :: summary

      call check_equal(error, trim(summary%status()), 'completed', 'end of the loading')
      summary%collapsed = .true.
      call check_equal(error, trim(summary%status()), 'collapsed', 'collapse')
      summary%lost_joint = 1
      call check_equal(error, trim(summary%status()), 'axial_failure', 'loss of the axial load')
   end subroutine ends

end module test_results
