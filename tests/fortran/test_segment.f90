!> The straight line with two ends.
module test_segment
   use check, only: unit_test, check_equal, check_same, check_true
   use rbs_base_constants, only: unbounded
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_segment, only: segment
   implicit none
   private

   public :: collect_segment

contains

   subroutine collect_segment(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('force is computed from the anchor', anchor), &
               unit_test('a line has no ends by default', endless), &
               unit_test('outward on the positive side', outward_up), &
               unit_test('outward on the negative side is the mirror', outward_down)]
   end subroutine collect_segment

   subroutine anchor(error)
      type(error_type), allocatable, intent(inout) :: error
      type(segment) :: line

      line = segment(d0=2.0_wp, f0=-3.0_wp, k=4.0_wp)
      call check_same(error, line%force(2.0_wp), -3.0_wp, 'at the anchor')
      call check_same(error, line%force(2.5_wp), -1.0_wp, 'ahead of it')
      call check_same(error, line%force([1.0_wp, 0.0_wp]), [-7.0_wp, -11.0_wp], 'elemental, beyond it')
   end subroutine anchor

   subroutine endless(error)
      type(error_type), allocatable, intent(inout) :: error
      type(segment) :: line

      call check_same(error, [line%lo, line%hi], [-unbounded, unbounded], 'ends')
      call check_equal(error, line%unload_on_reversal, 0, 'both ways')
   end subroutine endless

   subroutine outward_up(error)
      type(error_type), allocatable, intent(inout) :: error
      type(segment) :: line

      line = segment(d0=1.0_wp, f0=2.0_wp, k=3.0_wp)
      line = line%outward(1, near=0.5_wp, far=4.0_wp)
      call check_same(error, [line%lo, line%hi], [0.5_wp, 4.0_wp], 'ends')
      call check_true(error, line%includes_lower_end .and. .not. line%includes_upper_end, &
                      'the near end is closed')
      call check_equal(error, line%unload_on_reversal, 1, 'one-way upward')
      call check_same(error, [line%d0, line%f0, line%k], [1.0_wp, 2.0_wp, 3.0_wp], 'the line itself')
   end subroutine outward_up

   subroutine outward_down(error)
      type(error_type), allocatable, intent(inout) :: error
      type(segment) :: line

      line = segment(d0=-1.0_wp, f0=-2.0_wp, k=3.0_wp)
      line = line%outward(-1, near=-0.5_wp, far=-4.0_wp)
      call check_same(error, [line%lo, line%hi], [-4.0_wp, -0.5_wp], 'ends')
      call check_true(error, line%includes_upper_end .and. .not. line%includes_lower_end, &
                      'the near end is closed')
      call check_equal(error, line%unload_on_reversal, -1, 'one-way downward')
      line = line%outward(-1, near=-0.5_wp, far=-4.0_wp, includes_near_end=.false., &
                          unload_on_reversal=.false.)
      call check_true(error, .not. (line%includes_upper_end .or. line%includes_lower_end), 'both ends open')
      call check_equal(error, line%unload_on_reversal, 0, 'both ways')
   end subroutine outward_down

end module test_segment
