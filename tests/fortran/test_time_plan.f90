!> The plan of the steps, and the input that is refused.
module test_time_plan
   use check, only: unit_test, check_close, check_equal, check_passed, check_same, check_true
   use rbs_base_constants, only: unset, unset_integer
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_solve_time_plan, only: time_plan, new_plan
   use samples, only: random_type
   implicit none
   private

   public :: collect_time_plan

   !> Stability limit of these plans, and the longest step if the user gives none [s]
   real(wp), parameter :: limit = 0.1_wp, longest = 0.02_wp

contains

   subroutine collect_time_plan(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('no dt: equal steps, not above the longest', automatic), &
               unit_test('dt that divides within round-off', nearly_dividing), &
               unit_test('intervals that are all shorter than the step', short_intervals), &
               unit_test('steps and rows of random loadings', any_loading)]
   end subroutine collect_time_plan

   subroutine automatic(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(time_plan) :: plan
      integer, parameter :: expected(3) = [1, 5, 45]
      integer :: i

      call new_plan(plan, [1.0_wp, 1.001_wp, 1.1_wp, 2.0_wp], unset, longest, limit, outcome)
      call check_passed(error, outcome, 'plan')
      call check_true(error, .not. plan%free, 'steps follow the loading')
      call check_equal(error, plan%intervals, 3, 'intervals')
      do i = 1, 3
         call check_equal(error, plan%parts(i), expected(i), 'steps in an interval')
      end do
      call check_equal(error, plan%steps, 51, 'steps')
      call check_true(error, plan%dt <= longest, 'longest step')
      call check_same(error, [plan%begin, plan%finish], [1.0_wp, 2.0_wp], 'start and end')
      call new_plan(plan, [0.0_wp, 1.0_wp], unset, 0.25_wp, limit, outcome)
      call check_equal(error, plan%steps, 4, 'an interval of four longest steps')
   end subroutine automatic

   subroutine nearly_dividing(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(time_plan) :: plan
      real(wp) :: time(1001)
      integer :: i

      time = [(0.02_wp*(i - 1), i=1, 1001)]
      call new_plan(plan, time, 0.005_wp, longest, limit, outcome)
      call check_passed(error, outcome, 'plan')
      call check_true(error, .not. plan%free, 'steps follow the loading')
      call check_equal(error, plan%steps, 4000, 'steps')
   end subroutine nearly_dividing

   subroutine short_intervals(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(time_plan) :: plan

      call new_plan(plan, [0.0_wp, 1.0e-6_wp, 2.0e-6_wp], unset, longest, limit, outcome)
      call check_passed(error, outcome, 'plan')
      call check_equal(error, plan%steps, 2, 'one step each')
      call check_close(error, plan%dt, 1.0e-6_wp, 1.0e-14_wp, 0.0_wp, 'as long as the intervals')
      ! No limit: one step for each interval.
      call new_plan(plan, [0.0_wp, 1.0e6_wp], unset, 1.0e7_wp, huge(1.0_wp), outcome)
      call check_passed(error, outcome, 'no limit')
      call check_equal(error, plan%steps, 1, 'steps')
   end subroutine short_intervals

   !> For all times: no step exceeds the longest, parts add up, rows are counted.
   subroutine any_loading(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(random_type) :: random
      type(time_plan) :: plan
      real(wp) :: time(30), dt
      integer :: i, trial

      do trial = 1, 300
         time(1) = random%uniform(-100.0_wp, 100.0_wp)
         do i = 2, 30
            time(i) = time(i - 1) + 10.0_wp**random%uniform(-4.0_wp, 0.0_wp)
         end do
         dt = unset
         if (mod(trial, 2) == 0) dt = random%uniform(1.0e-3_wp, limit)
         plan = time_plan()
         call new_plan(plan, time, dt, longest, limit, outcome)
         call check_passed(error, outcome, 'plan')
         if (allocated(error)) return
         if (plan%free) then
            call check_equal(error, plan%steps, ceiling((time(30) - time(1))/dt*(1.0_wp - 1.0e-9_wp)), &
                             'steps')
            call check_same(error, plan%dt, dt, 'step')
            call check_equal(error, plan%rows(unset_integer), plan%steps + 1, 'rows')
         else
            call check_equal(error, sum(plan%parts), plan%steps, 'parts')
            call check_true(error, all((time(2:) - time(:29))/plan%parts <= longest*(1.0_wp + 1.0e-8_wp)), &
                            'a step is too long')
            call check_true(error, &
                            all((time(2:) - time(:29))/plan%parts > 0.499_wp*longest .or. plan%parts == 1), &
                            'a step is shorter than need be')
            call check_equal(error, plan%rows(unset_integer), 30, 'rows')
         end if
         do i = 1, 40, 3
            call check_equal(error, plan%rows(i), 1 + ceiling(real(plan%steps, wp)/i), &
                             'every n-th and the last')
         end do
      end do
   end subroutine any_loading

end module test_time_plan
