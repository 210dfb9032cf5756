!> Runs in lanes: columns that advance side by side; a lane that is done takes the next run.
module rbs_solve_ensemble_lane_runs
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_solve_ensemble_dispatch, only: kernel_type, chosen_kernel
   use rbs_solve_ensemble_lane_entry, only: lane_task, motion_table, fill_table, enter
   use rbs_solve_ensemble_lane_fields, only: one_body_lanes, lane_method, lanes
   use rbs_solve_ensemble_lane_step, only: lane_type, go_on
   use rbs_solve_ensemble_outcome, only: outcome_type, measure_count, fate_completed, fate_collapsed, &
                                         fate_failed, at_peak_displacement, at_residual_displacement, &
                                         at_peak_base_shear, at_peak_rotation, at_input, at_spring, &
                                         at_damping, at_residual, at_relative_residual, at_first_yield, &
                                         at_end, at_time_step, at_steps, at_events, at_cut, at_lost_joint
   use rbs_solve_ensemble_subject, only: ensemble_column, ensemble_motion, run_type
   use rbs_solve_time_implicit, only: implicit_stepper
   implicit none
   private

   public :: run_in_lanes

contains

   !> Run tasks of one method in lanes; a lane that is done takes the next.
   subroutine run_in_lanes(column, motion, run, task, level, outcome, control)
      type(ensemble_column), intent(in) :: column(:)
      type(ensemble_motion), intent(in) :: motion(:)
      type(run_type), intent(in) :: run(:)
      type(lane_task), intent(in) :: task(:)
      !> Of the kernel, see `chosen_kernel`
      integer, intent(in) :: level
      type(outcome_type), intent(inout) :: outcome(:)
      !> See `run_block`
      integer, intent(inout), volatile :: control(2)
      type(one_body_lanes), allocatable :: x
      type(lane_type), allocatable :: lane(:)
      type(motion_table) :: table
      type(kernel_type) :: kernel
      type(lane_method) :: method
      integer :: next, busy, l

      if (size(task) == 0) return
      allocate (x, lane(lanes))
      kernel = chosen_kernel(level)
      call fill_table(motion, table)
      next = 0
      busy = 0
      do l = 1, lanes
         call refill(l)
      end do
      do while (busy > 0)
         call advance_all()
      end do

   contains

      !> One step of all lanes.
      subroutine advance_all()
         integer :: count, list(lanes), ended, ends(lanes), failed, fails(lanes), j
         type(error_type), allocatable :: error

         if (implicit_method(lane)) then
            call kernel%implicit_lanes(x, method, count, list)
         else
            call kernel%rk4_lanes(x, count, list)
         end if
         failed = 0
         do j = 1, count
            call go_on(x, list(j), lane(list(j)), error)
            if (.not. allocated(error)) cycle
            failed = failed + 1
            fails(failed) = list(j)
            associate (result => outcome(task(lane(list(j))%task)%run))
               result%fate = fate_failed
               result%message = error%message
               result%value = ieee_value(1.0_wp, ieee_quiet_nan)
            end associate
            x%active(list(j)) = 0.0_wp
            x%ready(list(j)) = 0.0_wp
         end do
         call kernel%finish_step(x, size(table%time), table%time, table%acceleration, ended, ends)
         do j = 1, ended
            call settle_lane(x, ends(j), lane(ends(j)), task(lane(ends(j))%task), &
                             outcome(task(lane(ends(j))%task)%run))
            call free(ends(j))
         end do
         do j = 1, failed
            call free(fails(j))
         end do
      end subroutine advance_all

      !> A run is done.
      subroutine free(l)
         integer, intent(in) :: l

         control(2) = control(2) + 1
         busy = busy - 1
         x%active(l) = 0.0_wp
         x%ready(l) = 0.0_wp
         lane(l)%task = 0
         call refill(l)
      end subroutine free

      !> Put the next run into a lane, if there is one.
      subroutine refill(l)
         integer, intent(in) :: l
         type(error_type), allocatable :: error

         do while (next < size(task) .and. control(1) == 0)
            next = next + 1
            lane(l)%task = next
            associate (this => run(task(next)%run))
               call enter(column(this%column), motion(this%motion), table%first(this%motion), this%scale, &
                          task(next), x, l, lane(l), method, error)
            end associate
            if (.not. allocated(error)) then
               busy = busy + 1
               return
            end if
            outcome(task(next)%run)%fate = fate_failed
            outcome(task(next)%run)%message = error%message
            outcome(task(next)%run)%value = ieee_value(1.0_wp, ieee_quiet_nan)
            control(2) = control(2) + 1
            lane(l)%task = 0
         end do
      end subroutine refill

   end subroutine run_in_lanes

   !> Whether the runs are integrated by an implicit method; all are by the same.
   logical function implicit_method(lane)
      type(lane_type), intent(in) :: lane(:)

      select type (stepper => lane(1)%stepper)
      class is (implicit_stepper)
         implicit_method = .true.
      class default
         implicit_method = .false.
      end select
   end function implicit_method

   !> Fate and measures of a run that has ended.
   subroutine settle_lane(x, l, lane, task, outcome)
      type(one_body_lanes), intent(in) :: x
      integer, intent(in) :: l
      type(lane_type), intent(in) :: lane
      type(lane_task), intent(in) :: task
      type(outcome_type), intent(inout) :: outcome
      real(wp) :: value(measure_count)

      outcome%fate = merge(fate_collapsed, fate_completed, abs(x%displacement(l)) >= x%furthest(l))
      value(at_peak_displacement) = x%peak(l)
      value(at_residual_displacement) = x%displacement(l)
      value(at_peak_base_shear) = x%base(l)
      value(at_peak_rotation) = x%rotation(l)
      value(at_input) = x%of_loads(l)
      value(at_spring) = x%work(l, 1) + x%work(l, 2)
      value(at_damping) = 0.0_wp
      value(at_residual) = x%residual(l)
      value(at_relative_residual) = x%residual(l)/max(x%most(l), tiny(1.0_wp))
      value(at_first_yield) = ieee_value(1.0_wp, ieee_quiet_nan)
      if (x%first_yield(l) < huge(1.0_wp)) value(at_first_yield) = x%first_yield(l)
      value(at_end) = x%t(l)
      value(at_time_step) = task%plan%dt
      value(at_steps) = x%steps(l) + real(lane%stepper%steps, wp)
      value(at_events) = x%events(l) + real(lane%state%springs%events, wp)
      value(at_cut) = real(lane%stepper%cut_steps, wp)
      value(at_lost_joint) = 0.0_wp
      outcome%value = value
   end subroutine settle_lane

end module rbs_solve_ensemble_lane_runs
