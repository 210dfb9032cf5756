!> Runs in lanes: columns that advance side by side, and beside each lane the state of its run and its method.
!> A step on which a spring leaves its line, the first step of a run and a step that has to be cut are taken
!> by that state and that method, and the lane gets their result. So a lane has the bits of a run alone, and
!> all rules of the program. A lane that is done takes the next run.
module rbs_solve_ensemble_simd_batch
   use, intrinsic :: iso_c_binding, only: c_f_pointer, c_intptr_t, c_loc
   use, intrinsic :: iso_fortran_env, only: int32
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_segment, only: segment
   use rbs_loading_loads, only: loads_type, horizontal
   use rbs_output_summary, only: summary_type
   use rbs_solve_ensemble_dispatch, only: chosen_kernel
   use rbs_solve_ensemble_ensemble_input, only: ensemble_column, ensemble_motion, run_type, lane_task
   use rbs_solve_ensemble_lane_arrays, only: lane_clock, body_arrays, lane_method, kernel_type, lanes
   use rbs_solve_ensemble_lane_state, only: springs_to_lane, motion_to_lane, bounds_to_lane, step_to_lane, &
                                            motion_from_lane, step_from_lane, ground_from_lane
   use rbs_solve_ensemble_one_body_lane, only: body_to_lane, method_to_body, follow_springs, follow_trial, &
                                               lines_to_lane, lines_from_lane
   use rbs_solve_ensemble_run_result, only: run_result, collect
   use rbs_solve_one_body_implicit_one_body, only: one_body_step
   use rbs_solve_time_implicit, only: implicit_stepper
   use rbs_solve_time_march, only: report_state
   use rbs_solve_time_run_dynamic, only: new_stepper
   use rbs_solve_time_start, only: initial_state, start_state, restart_state
   use rbs_solve_time_state, only: state_type, stepper_type
   implicit none
   private

   public :: run_in_lanes

   !> The run of a lane: its task, its state and its method.
   type :: lane_type
      !> Places of the task, and of the column that state and method are for; 0: none
      integer :: task = 0, column = 0
      !> Step that they are for [s]
      real(wp) :: dt = 0.0_wp
      !> The run alone, with the rules of its springs
      type(state_type) :: state
      class(stepper_type), allocatable :: stepper
      !> Lines of its springs
      type(segment) :: line(2)
   end type lane_type

   type :: batch_type
      type(kernel_type) :: kernel
      type(lane_method) :: method
      !> The lanes, in storage that begins where a line of the cache does: an access to several lanes that
      !> crosses the border of two lines takes twice the time
      real(wp), allocatable :: storage(:)
      type(lane_clock), pointer :: x => null()
      type(body_arrays), pointer :: y => null()
      !> Steps on which springs leave their lines
      type(one_body_step) :: body
      type(lane_type), allocatable :: lane(:)
      !> All motions one after the other, each followed by two more points [s, m/s2], and the number of the
      !> first point of each
      real(wp), allocatable :: time(:), acceleration(:)
      integer, allocatable :: first(:)
   end type batch_type

contains

   !> Run tasks of one method, with columns that are alike, in lanes.
   subroutine run_in_lanes(column, motion, run, task, level, result, control)
      type(ensemble_column), intent(in), target :: column(:)
      type(ensemble_motion), intent(in) :: motion(:)
      type(run_type), intent(in) :: run(:)
      !> The runs to be taken, by their places in `run` and `result`
      type(lane_task), intent(in) :: task(:)
      !> Level of the kernel, with 0 the fastest that the processor has, with 1, 2 or 3 at the most that of
      !> the baseline, of AVX2, of AVX-512
      integer, intent(in) :: level
      type(run_result), intent(inout) :: result(:)
      !> Shared with other threads: 1: not zero to stop before the next run, 2: number of runs that are done,
      !> which each run here adds to
      integer, intent(inout), volatile :: control(2)
      type(batch_type), target :: batch
      !> Task begun last, number of lanes with a run, and a lane
      integer :: next, busy, l

      if (size(task) == 0) return
      call create_batch(batch, column(run(task(1)%run)%column)%structure%damped, motion, level)
      next = 0
      busy = 0
      do l = 1, lanes
         call refill(l)
      end do
      do while (busy > 0)
         call advance_all()
      end do

   contains

      !> One step of all lanes; lanes whose runs have ended get the next ones.
      subroutine advance_all()
         integer :: count, list(lanes), failed, fails(lanes), j
         type(error_type), allocatable :: error

         ! The kernel lists the lanes on whose steps springs leave their lines.
         call batch%kernel%advance(batch%x, batch%y, batch%method, count, list)
         failed = 0
         do j = 1, count
            call finish_step_scalar(batch, list(j), error)
            call find_watched(batch, list(j))
            if (.not. allocated(error)) cycle
            failed = failed + 1
            fails(failed) = list(j)
            ! A lane whose run has failed is empty for `finish`, and is filled again after it.
            call unload(batch, list(j), task, result, error)
         end do
         call batch%kernel%finish(batch%x, batch%y, size(batch%time), batch%time, batch%acceleration, count, &
                                  list)
         if (batch%x%any_beyond > 0.5_wp) call check_limit_states(batch)
         do j = 1, count
            call unload(batch, list(j), task, result, error)
            call free(list(j))
         end do
         do j = 1, failed
            call free(fails(j))
         end do
      end subroutine advance_all

      !> The run of a lane is done: count it, and fill the lane with the next.
      subroutine free(l)
         !> Number of the lane
         integer, intent(in) :: l

         control(2) = control(2) + 1
         busy = busy - 1
         call refill(l)
      end subroutine free

      !> Put the next run into a lane, if there is one. A run that cannot begin has failed, and the one after
      !> it is tried.
      subroutine refill(l)
         !> Number of the lane
         integer, intent(in) :: l
         type(error_type), allocatable :: error

         ! `next` is the task begun last. None begins after another thread has asked to stop.
         do while (next < size(task) .and. control(1) == 0)
            next = next + 1
            batch%lane(l)%task = next
            associate (this => run(task(next)%run))
               call load_run(batch, l, column(this%column), this%column, motion(this%motion), &
                             batch%first(this%motion), task(next), error)
            end associate
            if (.not. allocated(error)) then
               busy = busy + 1
               return
            end if
            call unload(batch, l, task, result, error)
            control(2) = control(2) + 1
         end do
      end subroutine refill

   end subroutine run_in_lanes

   !> Make lanes without runs, and the table of all motions.
   subroutine create_batch(batch, damped, motion, level)
      type(batch_type), intent(inout), target :: batch
      !> Whether the columns have damping
      logical, intent(in) :: damped
      type(ensemble_motion), intent(in) :: motion(:)
      !> Kernel, with 0 the fastest, else the highest level that may be taken
      integer, intent(in) :: level
      !> Numbers in a line of the cache
      integer, parameter :: line = 8
      integer(c_intptr_t) :: address
      integer :: first, clock, bodies, j, m, at

      batch%kernel = chosen_kernel(level)
      ! The clock and the bodies of the lanes lie in one store, each from the start of a line of the cache.
      clock = line*ceiling(storage_size(batch%x)/real(line*storage_size(1.0_wp), wp))
      bodies = storage_size(batch%y)/storage_size(1.0_wp)
      allocate (batch%storage(line + clock + bodies), batch%lane(lanes))
      ! Address in numbers of 8 bytes; the first place is at a border between lines of the cache.
      address = transfer(c_loc(batch%storage), address)/(storage_size(1.0_wp)/8)
      first = int(modulo(-address, int(line, c_intptr_t))) + 1
      call c_f_pointer(c_loc(batch%storage(first)), batch%x)
      call c_f_pointer(c_loc(batch%storage(first + clock)), batch%y)
      batch%x = lane_clock(damped=damped)
      batch%y = body_arrays()
      ! All motions stand in one table, one behind the other.
      at = 0
      do j = 1, size(motion)
         at = at + size(motion(j)%time) + 2
      end do
      allocate (batch%time(at), batch%acceleration(at), batch%first(size(motion)))
      at = 0
      do j = 1, size(motion)
         m = size(motion(j)%time)
         batch%first(j) = at + 1
         batch%time(at + 1:at + m + 2) = [motion(j)%time, motion(j)%time(m) + 1.0_wp, &
                                          motion(j)%time(m) + 2.0_wp]
         ! After its end a motion stays at its last value, for two more intervals that the kernel looks ahead
         ! into.
         batch%acceleration(at + 1:at + m) = motion(j)%acceleration
         batch%acceleration(at + m + 1:at + m + 2) = motion(j)%acceleration(m)
         at = at + m + 2
      end do
   end subroutine create_batch

   !> A run begins in a lane. The lane is not yet ready for the kernel: its first step is taken by the state
   !> and the method of the lane alone, which find their starting values there.
   subroutine load_run(batch, l, column, column_number, motion, first, task, error)
      type(batch_type), intent(inout) :: batch
      !> Number of the lane
      integer, intent(in) :: l
      !> The column, and its number
      type(ensemble_column), intent(in), target :: column
      integer, intent(in) :: column_number
      type(ensemble_motion), intent(in) :: motion
      !> Number of the first point of the motion in the table
      integer, intent(in) :: first
      type(lane_task), intent(in) :: task
      type(error_type), allocatable, intent(out) :: error

      call load_motion(motion, first, task, batch%x, l)
      associate (x => batch%x, y => batch%y, lane => batch%lane(l))
         ! State and method serve on where the column and the step are those of the last run of the lane.
         if (lane%column == column_number .and. .not. abs(lane%dt - x%h(l)) > 0.0_wp) then
            call ground_from_lane(x, l, lane%state)
            call restart_state(lane%state)
            call lane%stepper%restart()
         else
            call create_run(batch, l, column, task, error)
            if (allocated(error)) return
            lane%column = column_number
            lane%dt = x%h(l)
         end if
         call lane%state%monitor%watch_for(column%watch, column%states)
         call lane%state%begin_monitor(column%analysis%collapse_drift, .false.)
         x%furthest(l) = lane%state%monitor%furthest
         call motion_to_lane(x, y, l, lane%state)
         call springs_to_lane(y, l, lane%state)
         call lines_to_lane(x, y, l, lane%state, batch%body, batch%method%implicit, lane%line)
         x%seen(l) = 0.0_wp
         x%t(l) = 0.0_wp
         x%steps(l) = 0.0_wp
         x%displacement(l) = 0.0_wp
         ! Residual of energy, and the largest energy
         x%residual(l) = 0.0_wp
         x%most(l) = 0.0_wp
         x%ended(l) = 0.0_wp
         x%active(l) = 1.0_wp
         x%ready(l) = 0.0_wp
         x%tried(l) = 0.0_wp
      end associate
   end subroutine load_run

   !> Make state and method of a run, and put the constants of its column into the lane.
   subroutine create_run(batch, l, column, task, error)
      type(batch_type), intent(inout) :: batch
      !> Number of the lane
      integer, intent(in) :: l
      type(ensemble_column), intent(in), target :: column
      type(lane_task), intent(in) :: task
      type(error_type), allocatable, intent(out) :: error
      type(loads_type) :: loads
      type(initial_state) :: at_rest

      associate (x => batch%x, y => batch%y, lane => batch%lane(l))
         ! Until it is made the lane has no column.
         lane%column = 0
         loads%signal(horizontal)%time = [x%begin(l), x%finish(l), x%next_finish(l)]
         loads%signal(horizontal)%value = [x%value(l), x%next_value(l), x%after_value(l)]
         call start_state(lane%state, column%structure, loads, at_rest, 0.0_wp, error)
         if (allocated(error)) return
         call new_stepper(lane%stepper, column%structure, column%analysis, task%plan)
         select type (stepper => lane%stepper)
         type is (implicit_stepper)
            batch%method = lane_method(.true., stepper%step%alpha_m, stepper%step%alpha_f, &
                                       stepper%step%beta, stepper%step%gamma, stepper%wanted, &
                                       stepper%acceptable)
         end select
         call body_to_lane(x, l, lane%state)
         call method_to_body(batch%method, batch%body)
      end associate
   end subroutine create_run

   !> Put the first two intervals of the motion, times its factor, into a lane, and its counts of steps and
   !> intervals.
   pure subroutine load_motion(motion, first, task, x, l)
      type(ensemble_motion), intent(in) :: motion
      !> Number of the first point of the motion in the table
      integer, intent(in) :: first
      type(lane_task), intent(in) :: task
      !> Clock and column of every lane
      type(lane_clock), intent(inout) :: x
      !> Number of the lane
      integer, intent(in) :: l
      integer :: m

      m = size(motion%time)
      associate (time => motion%time, value => motion%acceleration, scale => task%scale)
         x%h(l) = task%plan%dt
         x%part(l) = 1.0_wp
         x%parts(l) = real(task%parts, wp)
         x%left(l) = real(m - 1, wp)
         x%scale(l) = scale
         x%begin(l) = time(1)
         x%finish(l) = time(2)
         x%value(l) = scale*value(1)
         x%next_value(l) = scale*value(2)
         x%slope(l) = (x%next_value(l) - x%value(l))/(time(2) - time(1))
         ! A motion of two points stays at its last value.
         x%next_finish(l) = time(m) + 1.0_wp
         x%after_value(l) = x%next_value(l)
         x%next_slope(l) = 0.0_wp
         if (m > 2) then
            x%next_finish(l) = time(3)
            x%after_value(l) = scale*value(3)
            x%next_slope(l) = (x%after_value(l) - x%next_value(l))/(time(3) - time(2))
         end if
         ! The place of the third point in the table, behind which the kernel reads on
         x%at(l) = int(first + 2, int32)
      end associate
   end subroutine load_motion

   !> Complete, for one lane, the step that the other lanes have taken: from the trial of the kernel if there
   !> is one, else as a whole by the method of the run alone. An error says why the run has failed.
   subroutine finish_step_scalar(batch, l, error)
      type(batch_type), intent(inout) :: batch
      !> Number of the lane
      integer, intent(in) :: l
      type(error_type), allocatable, intent(out) :: error
      logical :: taken

      associate (x => batch%x, y => batch%y, lane => batch%lane(l), &
                 state => batch%lane(l)%state)
         taken = .false.
         if (x%tried(l) > 0.5_wp) then
            ! An implicit step has left a trial. RK4 has ended the step, and only its springs have still to
            ! follow.
            if (batch%method%implicit) then
               call follow_trial(x, y, l, state%motion%damping, batch%body, lane%line, state%springs, taken)
            else
               call follow_springs(x, y, l, state%motion%damping, lane%line, state%springs)
               taken = .true.
            end if
            if (taken) state%time = x%t(l) + x%h(l)
         end if
         if (.not. taken) call step_alone(batch, x, y, lane, l, error)
         if (allocated(error)) return
         if (state%diverged .or. state%springs%stuck) call report_state(state, error)
      end associate
   end subroutine finish_step_scalar

   !> Take a whole step of a lane by the state and the method of the run alone, and put the result into the
   !> lane.
   subroutine step_alone(batch, x, y, lane, l, error)
      type(batch_type), intent(inout) :: batch
      !> Clock and column of every lane
      type(lane_clock), intent(inout) :: x
      !> Motion and springs of every lane
      type(body_arrays), intent(inout) :: y
      type(lane_type), intent(inout) :: lane
      !> Number of the lane
      integer, intent(in) :: l
      type(error_type), allocatable, intent(out) :: error

      call lines_from_lane(y, l, lane%line, lane%state%springs)
      call motion_from_lane(x, y, l, lane%state)
      select type (stepper => lane%stepper)
      type is (implicit_stepper)
         ! Before the first step, by the kernel or alone, the method has nothing to start from.
         if (x%steps(l) + stepper%steps > 0.5_wp) call step_from_lane(y, l, stepper)
      end select
      call lane%stepper%advance(lane%state, x%h(l), error)
      if (allocated(error) .or. lane%state%diverged .or. lane%state%springs%stuck) return
      x%ready(l) = 1.0_wp
      call motion_to_lane(x, y, l, lane%state)
      call springs_to_lane(y, l, lane%state)
      select type (stepper => lane%stepper)
      type is (implicit_stepper)
         call step_to_lane(y, l, stepper)
      end select
      call lines_to_lane(x, y, l, lane%state, batch%body, batch%method%implicit, lane%line)
   end subroutine step_alone

   !> Check the limit states of lanes whose deformations are where one may have been reached (flag `beyond`, 1
   !> or 0).
   subroutine check_limit_states(batch)
      type(batch_type), intent(inout) :: batch
      integer :: l

      do l = 1, lanes
         if (batch%x%beyond(l) < 0.5_wp) cycle
         associate (x => batch%x, y => batch%y, state => batch%lane(l)%state)
            ! The state before the step, from which the monitor interpolates; a step that was cut has been
            ! seen within.
            state%monitor%q(:) = y%from(l, :)
            state%monitor%clock = max(state%monitor%clock, x%seen(l))
            state%q(:) = y%q(l, :)
            call state%monitor%check_limits(state%springs, state%q, x%displacement(l), x%t(l))
            call bounds_to_lane(y, l, state)
            call find_watched(batch, l)
         end associate
      end do
   end subroutine check_limit_states

   !> Find whether a spring of a lane may come to a limit state on its present line. Lines change only where
   !> steps are taken alone.
   pure subroutine find_watched(batch, l)
      type(batch_type), intent(inout) :: batch
      !> Number of the lane
      integer, intent(in) :: l

      associate (x => batch%x, y => batch%y)
         x%may_reach(l) = merge(1.0_wp, 0.0_wp, any(y%upper(l, :) > y%highest(l, :) .or. &
                                                    y%lower(l, :) < y%lowest(l, :)))
         x%watched = any(x%may_reach > 0.5_wp)
      end associate
   end subroutine find_watched

   !> Store fate and measures of the run of a lane, which has ended, and leave the lane empty.
   subroutine unload(batch, l, task, result, error)
      type(batch_type), intent(inout) :: batch
      !> Number of the lane
      integer, intent(in) :: l
      type(lane_task), intent(in) :: task(:)
      type(run_result), intent(inout) :: result(:)
      !> Why the run has failed; not allocated: it has not
      type(error_type), allocatable, intent(in) :: error
      type(summary_type) :: summary

      associate (x => batch%x, y => batch%y, lane => batch%lane(l), &
                 this => task(batch%lane(l)%task))
         summary%last_displacement = x%displacement(l)
         summary%last_time = x%t(l)
         summary%time_step = this%plan%dt
         summary%peak_displacement = x%peak(l)
         summary%peak_base_shear = x%base(l)
         summary%peak_rotation = x%rotation(l)
         summary%collapsed = abs(x%peak(l)) >= x%furthest(l)
         summary%energy%input = x%of_loads(l)
         summary%energy%spring = sum(y%work(l, :))
         summary%energy%damping = x%of_damping(l)
         summary%residual = x%residual(l)
         summary%largest = x%most(l)
         summary%events = lane%state%springs%events
         summary%steps = nint(x%steps(l))
         if (allocated(lane%stepper)) then
            summary%steps = summary%steps + lane%stepper%steps
            summary%cut_steps = lane%stepper%cut_steps
         end if
         if (allocated(lane%state%monitor%reached)) then
            call collect(lane%state%monitor%reached, summary, error, result(this%run))
         else
            ! A run that could not begin has no monitor.
            call collect([huge(1.0_wp)], summary, error, result(this%run))
         end if
         x%active(l) = 0.0_wp
         x%ready(l) = 0.0_wp
         x%may_reach(l) = 0.0_wp
         lane%task = 0
      end associate
   end subroutine unload

end module rbs_solve_ensemble_simd_batch
