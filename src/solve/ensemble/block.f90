!> A block of runs: columns under ground motions, each of which is scaled. No run stops the others.
module rbs_solve_ensemble_block
   use rbs_base_check, only: is_given
   use rbs_base_error, only: error_type, fatal_error, analysis_failed
   use rbs_base_kinds, only: wp
   use rbs_output_recorder, only: array_recorder
   use rbs_solve_end_state, only: end_state, checkpoint_type
   use rbs_solve_ensemble_ensemble_input, only: ensemble_column, ensemble_motion, run_type, lane_task
   use rbs_solve_ensemble_run_result, only: run_result, collect
   use rbs_solve_ensemble_simd_batch, only: run_in_lanes
   use rbs_solve_task, only: task_type
   use rbs_solve_time_effort, only: expected_seconds
   use rbs_loading_loads, only: loads_type
   use rbs_solve_time_march, only: initial_state, step_of
   use rbs_solve_time_plan, only: time_plan
   use rbs_solve_time_run_dynamic, only: run_dynamic, plan_dynamic
   use rbs_solve_time_monitor, only: response_monitor
   use rbs_solve_time_start, only: resume_state
   use rbs_solve_time_state, only: state_type
   use rbs_structure_column_column, only: column_type, finite
   implicit none
   private

   public :: plan_column, run_block, without_lanes

   !> Tells `run_block` to run everything without lanes.
   integer, parameter :: without_lanes = -1

   !> Fewer runs are faster one after the other: a step of the lanes takes about as long as that of these
   !> alone, however many lanes are empty.
   integer, parameter :: min_batch = 4

contains

   !> Effort of a run of each motion: expected seconds, within a factor of three (motions), and whether lanes
   !> take it. It stops with an error at the first motion that the column cannot be run with.
   subroutine plan_column(column, motion, seconds, in_lanes, error)
      type(ensemble_column), intent(in) :: column
      type(ensemble_motion), intent(in) :: motion(:)
      !> Of a run of each motion: expected duration [s] (motions)
      real(wp), intent(out) :: seconds(:)
      !> Whether lanes take a run of each motion (motions)
      logical, intent(out) :: in_lanes(:)
      type(error_type), allocatable, intent(out) :: error
      type(time_plan) :: plan
      integer :: j

      seconds = 0.0_wp
      in_lanes = .false.
      do j = 1, size(motion)
         call plan_run(column, motion(j), plan, error)
         if (allocated(error)) return
         seconds(j) = expected_seconds(column%structure, plan)
         in_lanes(j) = takes_lanes(column, plan, motion(j)%time)
      end do
      ! The state to begin in is tried once, with the motion planned last.
      call check_start(column, motion(size(motion)), plan, error)
   end subroutine plan_column

   !> Whether lanes can take a run: one body from rest, small rotations, a free top, joints that do not open
   !> and are not layered, all steps equal, lines changed at the end of a step, no bound by the clock.
   pure logical function takes_lanes(of_runs, plan, time)
      type(ensemble_column), intent(in) :: of_runs
      type(time_plan), intent(in) :: plan
      !> Times of the motion [s]
      real(wp), intent(in) :: time(:)
      integer :: i

      takes_lanes = .false.
      if (allocated(of_runs%before) .or. is_given(of_runs%analysis%max_seconds)) return
      select type (column => of_runs%structure)
      class is (column_type)
         ! Slip and rotation of one body
         if (column%unknowns /= 2 .or. column%held .or. column%kinematics == finite) return
         if (any(column%rules%name == 'layered')) return
      class default
         return
      end select
      select case (plan%method)
      case ('rk4')
         if (plan%located .or. of_runs%analysis%events == 'located') return
      case ('newmark', 'hht', 'generalised_alpha')
         continue
      case default
         return
      end select
      ! The clock of the lanes starts at 0, and their steps divide the intervals of the motion.
      if (plan%free .or. abs(time(1)) > 0.0_wp) return
      if (any(plan%parts /= plan%parts(1))) return
      do i = 1, size(time) - 1
         if (abs(step_of(plan, (time(i + 1) - time(i))/plan%parts(1)) - plan%dt) > 0.0_wp) return
      end do
      takes_lanes = .true.
   end function takes_lanes

   !> Whether runs of a column can begin in the state that it is given; nothing to check where they begin at
   !> rest.
   subroutine check_start(column, motion, planned, error)
      type(ensemble_column), intent(in) :: column
      type(ensemble_motion), intent(in) :: motion
      !> Plan of a run under the motion, of which a copy is used: taking up a state may change it
      type(time_plan), intent(in) :: planned
      type(error_type), allocatable, intent(out) :: error
      type(end_state) :: before
      type(time_plan) :: plan
      type(state_type) :: state
      type(checkpoint_type) :: checkpoint
      type(loads_type) :: loads

      if (.not. allocated(column%before)) return
      call take_before(column, before)
      loads = motion%loads(1.0_wp)
      plan = planned
      call resume_state(state, column%structure, loads, before, plan, checkpoint, error)
   end subroutine check_start

   !> Copy the state that runs of a column begin in, if it is given one; else `before` stays empty.
   pure subroutine take_before(column, before)
      type(ensemble_column), intent(in) :: column
      type(end_state), intent(inout) :: before

      if (.not. allocated(column%before)) return
      before%stream%value = column%before
      before%stream%count = size(column%before)
   end subroutine take_before

   !> Run all runs: those that lanes cannot take one after the other, and then the others in lanes, or one
   !> after the other where they are few.
   subroutine run_block(column, motion, run, level, result, control)
      type(ensemble_column), intent(in) :: column(:)
      type(ensemble_motion), intent(in) :: motion(:)
      type(run_type), intent(in) :: run(:)
      !> Kernel of the lanes: 0: the fastest that the processor has; 1, 2 or 3: at the most that of the
      !> baseline, of AVX2, of AVX-512; `without_lanes`: no run in lanes
      integer, intent(in) :: level
      !> One for each run; that of a run that was not started stays as it is
      type(run_result), intent(inout) :: result(:)
      !> Shared with other threads: 1: not zero to stop before the next run, 2: number of runs that are done,
      !> which each run here adds to
      integer, intent(inout), volatile :: control(2)
      type(lane_task), allocatable :: task(:), others(:)
      logical, allocatable :: together(:)
      type(time_plan) :: plan
      type(error_type), allocatable :: error
      logical :: in_lanes
      integer :: i, tasks

      allocate (task(size(run)))
      tasks = 0
      in_lanes = .false.
      do i = 1, size(run)
         if (control(1) /= 0) return
         associate (one => column(run(i)%column), shaken => motion(run(i)%motion))
            ! Runs of one column under one motion have one plan; those that lanes take wait for others.
            if (is_new(run, i)) then
               in_lanes = .false.
               call plan_run(one, shaken, plan, error)
               if (.not. allocated(error) .and. level /= without_lanes) then
                  in_lanes = takes_lanes(one, plan, shaken%time)
               end if
            end if
            if (in_lanes) then
               tasks = tasks + 1
               task(tasks)%run = i
               task(tasks)%parts = plan%parts(1)
               task(tasks)%scale = run(i)%scale
               ! The plan without its list of intervals
               task(tasks)%plan = time_plan(dt=plan%dt, method=plan%method, limit=plan%limit, &
                                            located=plan%located)
               cycle
            end if
            call run_alone(one, shaken, run(i)%scale, plan, error, result(i))
         end associate
         control(2) = control(2) + 1
      end do
      ! The columns in lanes all have damping or none has, and one method.
      task = task(:tasks)
      do while (size(task) > 0)
         ! Runs that may share lanes with the first; the others wait for the next round.
         allocate (together(size(task)))
         do i = 1, size(task)
            together(i) = task(i)%plan%method == task(1)%plan%method .and. &
                          (column(run(task(i)%run)%column)%structure%damped .eqv. &
                           column(run(task(1)%run)%column)%structure%damped)
         end do
         others = pack(task, .not. together)
         if (count(together) >= min_batch) then
            call run_in_lanes(column, motion, run, pack(task, together), level, result, control)
         else
            call run_singly(column, motion, run, pack(task, together), result, control)
         end if
         call move_alloc(others, task)
         deallocate (together)
      end do
   end subroutine run_block

   !> Runs that lanes could take, one after the other: there are too few of them to be faster in lanes.
   subroutine run_singly(column, motion, run, task, result, control)
      type(ensemble_column), intent(in) :: column(:)
      type(ensemble_motion), intent(in) :: motion(:)
      type(run_type), intent(in) :: run(:)
      !> The runs to be taken, by their places in `run` and `result`
      type(lane_task), intent(in) :: task(:)
      type(run_result), intent(inout) :: result(:)
      !> Shared with other threads: 1: not zero to stop before the next run, 2: number of runs that are done,
      !> which each run here adds to
      integer, intent(inout), volatile :: control(2)
      type(time_plan) :: plan
      type(error_type), allocatable :: error
      integer :: i

      do i = 1, size(task)
         if (control(1) /= 0) return
         associate (this => run(task(i)%run), result => result(task(i)%run))
            call plan_run(column(this%column), motion(this%motion), plan, error)
            call run_alone(column(this%column), motion(this%motion), this%scale, plan, error, result)
         end associate
         control(2) = control(2) + 1
      end do
   end subroutine run_singly

   !> Whether run i has another column or another motion than the run before it; true of the first run.
   pure logical function is_new(run, i)
      type(run_type), intent(in) :: run(:)
      integer, intent(in) :: i

      is_new = i == 1
      if (.not. is_new) is_new = run(i)%column /= run(i - 1)%column .or. run(i)%motion /= run(i - 1)%motion
   end function is_new

   !> Plan the runs of a column under a motion. The plan is that of the motion as it is given, and serves
   !> whatever factor scales it. A column with a fault has no plan but its error.
   subroutine plan_run(column, motion, plan, error)
      type(ensemble_column), intent(in) :: column
      type(ensemble_motion), intent(in) :: motion
      type(time_plan), intent(out) :: plan
      type(error_type), allocatable, intent(out) :: error
      type(loads_type) :: loads

      if (allocated(column%error)) then
         error = column%error
         return
      end if
      loads = motion%loads(1.0_wp)
      call plan_dynamic(column%structure, column%analysis, motion%time, loads, plan, error)
   end subroutine plan_run

   !> Run a column under a motion by the analysis of a single case, and collect its fate and measures.
   subroutine run_alone(column, motion, scale, plan, unplanned, result)
      type(ensemble_column), intent(in) :: column
      type(ensemble_motion), intent(in) :: motion
      !> Factor of the accelerations
      real(wp), intent(in) :: scale
      type(time_plan), intent(in) :: plan
      !> Why there is no plan, with which the run fails; not allocated: there is one
      type(error_type), allocatable, intent(in) :: unplanned
      type(run_result), intent(inout) :: result
      type(loads_type) :: loads
      type(initial_state) :: at_rest
      type(array_recorder), target :: no_rows
      type(task_type) :: task
      type(response_monitor) :: monitor
      type(error_type), allocatable :: error

      call monitor%watch_for(column%watch, column%states)
      if (allocated(unplanned)) then
         call collect(monitor%reached, task%summary, unplanned, result)
         return
      end if
      task%recorder => no_rows
      task%collapse_drift = column%analysis%collapse_drift
      task%most_seconds = column%analysis%max_seconds
      loads = motion%loads(scale)
      call take_before(column, task%before)
      call run_dynamic(column%structure, column%analysis, plan, motion%time, loads, at_rest, task, error, &
                       monitor)
      ! Measures of a run that the clock has stopped early would mislead: it counts as failed.
      if (task%summary%stopped .and. .not. allocated(error)) then
         call fatal_error(error, analysis_failed, task%summary%remark)
      end if
      call collect(monitor%reached, task%summary, error, result)
   end subroutine run_alone

end module rbs_solve_ensemble_block
