!> A block of runs: columns under ground motions, each of which is scaled. No run stops the others.
module rbs_solve_ensemble_block
   use rbs_base_constants, only: unset_integer
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_case_analysis_record, only: analysis_record
   use rbs_column_column, only: column_type
   use rbs_output_summary, only: summary_type
   use rbs_solve_ensemble_outcome, only: outcome_type
   use rbs_solve_ensemble_tally, only: tally_recorder, settle
   use rbs_solve_time_effort, only: expected_seconds
   use rbs_solve_time_loads, only: loads_type
   use rbs_solve_time_march, only: initial_state
   use rbs_solve_time_plan, only: time_plan
   use rbs_solve_time_run_dynamic, only: run_dynamic, plan_dynamic
   implicit none
   private

   public :: ensemble_column, ensemble_motion, run_type, plan_column, run_block

   !> A column and what is asked of it.
   type :: ensemble_column
      type(column_type) :: column
      type(analysis_record) :: analysis
      !> Rotation at which each joint yields; `huge` where that is not known (n) [rad]
      real(wp), allocatable :: yield(:)
      !> What is wrong with it; all its runs fail
      type(error_type), allocatable :: error
   end type ensemble_column

   !> A ground motion.
   type :: ensemble_motion
      !> Times (m) [s], ascending, and accelerations (m) [m/s2]
      real(wp), allocatable :: time(:), acceleration(:)
   end type ensemble_motion

   !> One run: its column, its motion, and the factor of the accelerations.
   type :: run_type
      integer :: column = 0, motion = 0
      real(wp) :: scale = 1.0_wp
   end type run_type

contains

   !> What a run of each motion will take: expected seconds, within a factor of three (motions). Stops at the
   !> first motion that the column cannot be run with.
   subroutine plan_column(column, motion, seconds, error)
      type(ensemble_column), intent(in) :: column
      type(ensemble_motion), intent(in) :: motion(:)
      real(wp), intent(out) :: seconds(:)
      type(error_type), allocatable, intent(out) :: error
      type(loads_type) :: loads
      type(time_plan) :: plan
      integer :: j

      seconds = 0.0_wp
      do j = 1, size(motion)
         loads%ground%time = motion(j)%time
         loads%ground%value = motion(j)%acceleration
         call plan_dynamic(column%column, column%analysis, motion(j)%time, loads, plan, error)
         if (allocated(error)) return
         seconds(j) = expected_seconds(column%column, plan)
      end do
   end subroutine plan_column

   !> Run them all.
   subroutine run_block(column, motion, run, outcome, control)
      type(ensemble_column), intent(in) :: column(:)
      type(ensemble_motion), intent(in) :: motion(:)
      type(run_type), intent(in) :: run(:)
      type(outcome_type), intent(inout) :: outcome(:)
      !> Shared with other threads: 1: not zero to stop before the next run, 2: number of runs that are done
      integer, intent(inout), volatile :: control(2)
      integer :: i

      do i = 1, size(run)
         if (control(1) /= 0) return
         call run_alone(column(run(i)%column), motion(run(i)%motion), run(i)%scale, outcome(i))
         control(2) = control(2) + 1
      end do
   end subroutine run_block

   !> One run by itself.
   subroutine run_alone(column, motion, scale, outcome)
      type(ensemble_column), intent(in) :: column
      type(ensemble_motion), intent(in) :: motion
      real(wp), intent(in) :: scale
      type(outcome_type), intent(inout) :: outcome
      type(loads_type) :: loads
      type(time_plan) :: plan
      type(initial_state) :: at_rest
      type(tally_recorder) :: tally
      type(summary_type) :: summary
      type(error_type), allocatable :: error

      if (allocated(column%error)) then
         error = column%error
         call settle(column%column, tally, summary, error, outcome)
         return
      end if
      loads%ground%time = motion%time
      loads%ground%value = scale*motion%acceleration
      tally%n = column%column%n
      tally%yield = column%yield
      call plan_dynamic(column%column, column%analysis, motion%time, loads, plan, error)
      if (.not. allocated(error)) then
         call run_dynamic(column%column, column%analysis, plan, motion%time, loads, at_rest, unset_integer, &
                          tally, summary, error)
      end if
      call settle(column%column, tally, summary, error, outcome)
   end subroutine run_alone

end module rbs_solve_ensemble_block
