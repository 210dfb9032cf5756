!> Runs of columns of one body in lanes. Each lane has the state of its run and its method beside it: for a
!> step on which a spring leaves its line, or for which the tangent is not yet known, the lane is put back
!> into them, takes the step by itself as every run does, and comes back. So a lane has the bits of a run
!> alone, and all rules of the program.
module rbs_solve_ensemble_lane_runs
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
   use, intrinsic :: iso_fortran_env, only: int32
   use rbs_base_check, only: is_given
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_case_analysis_record, only: analysis_record
   use rbs_column_column, only: column_type, finite
   use rbs_solve_ensemble_dispatch, only: kernel_type, chosen_kernel
   use rbs_solve_ensemble_lane_fields, only: one_body_lanes, lane_method, lanes
   use rbs_solve_ensemble_outcome, only: outcome_type, measure_count, fate_completed, fate_collapsed, &
                                         fate_failed, at_peak_displacement, at_residual_displacement, &
                                         at_peak_base_shear, at_peak_rotation, at_input, at_spring, &
                                         at_damping, at_residual, at_relative_residual, at_first_yield, &
                                         at_end, at_time_step, at_steps, at_events, at_cut, at_lost_joint
   use rbs_solve_ensemble_subject, only: ensemble_column, ensemble_motion, run_type
   use rbs_solve_time_implicit, only: implicit_stepper
   use rbs_solve_time_loads, only: loads_type, horizontal
   use rbs_solve_time_march, only: initial_state, start_state, report_state, step_of
   use rbs_solve_time_plan, only: time_plan
   use rbs_solve_time_rk4_one_body, only: inverse_of_mass
   use rbs_solve_time_run_dynamic, only: new_stepper
   use rbs_solve_time_state, only: state_type, stepper_type
   implicit none
   private

   public :: lane_task, takes_lanes, run_in_lanes

   !> A run that lanes can take, and its steps.
   type :: lane_task
      integer :: run = 0
      type(time_plan) :: plan
      !> Equal steps in each interval of the motion
      integer :: parts = 1
   end type lane_task

   !> What stands beside a lane.
   type :: lane_type
      !> Place of the task, 0: none
      integer :: task = 0
      type(state_type) :: state
      class(stepper_type), allocatable :: stepper
   end type lane_type

   !> Motions as the kernel reads them: one after the other, each followed by two more points.
   type :: motion_table
      real(wp), allocatable :: time(:), acceleration(:)
      integer, allocatable :: first(:)
   end type motion_table

contains

   !> Whether lanes can take a run: one body without damping, all steps equal, lines changed at the end of
   !> a step.
   pure logical function takes_lanes(column, analysis, plan, time)
      type(column_type), intent(in) :: column
      type(analysis_record), intent(in) :: analysis
      type(time_plan), intent(in) :: plan
      real(wp), intent(in) :: time(:)
      integer :: i

      takes_lanes = .false.
      if (column%unknowns /= 2 .or. column%kinematics == finite .or. column%damped) return
      if (any(column%spring%rule == 'layered')) return
      select case (plan%method)
      case ('rk4')
         if (plan%located .or. analysis%events == 'located') return
      case ('newmark', 'hht', 'generalised_alpha')
      case default
         return
      end select
      if (plan%free .or. abs(time(1)) > 0.0_wp) return
      if (any(plan%parts /= plan%parts(1))) return
      do i = 1, size(time) - 1
         if (abs(step_of(plan, (time(i + 1) - time(i))/plan%parts(1)) - plan%dt) > 0.0_wp) return
      end do
      takes_lanes = .true.
   end function takes_lanes

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
            call step_alone(x, list(j), lane(list(j)), error)
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

   subroutine fill_table(motion, table)
      type(ensemble_motion), intent(in) :: motion(:)
      type(motion_table), intent(out) :: table
      integer :: j, m, at

      at = 0
      do j = 1, size(motion)
         at = at + size(motion(j)%time) + 2
      end do
      allocate (table%time(at), table%acceleration(at), table%first(size(motion)))
      at = 0
      do j = 1, size(motion)
         m = size(motion(j)%time)
         table%first(j) = at + 1
         table%time(at + 1:at + m) = motion(j)%time
         table%time(at + m + 1) = motion(j)%time(m) + 1.0_wp
         table%time(at + m + 2) = motion(j)%time(m) + 2.0_wp
         table%acceleration(at + 1:at + m) = motion(j)%acceleration
         ! After its end a motion stays at its last value.
         table%acceleration(at + m + 1:at + m + 2) = motion(j)%acceleration(m)
         at = at + m + 2
      end do
   end subroutine fill_table

   !> A run begins in a lane. Its first step is taken alone, as then the method finds what it needs.
   subroutine enter(column, motion, first, scale, task, x, l, lane, method, error)
      type(ensemble_column), intent(in) :: column
      type(ensemble_motion), intent(in) :: motion
      !> Place of the first point of the motion in the table
      integer, intent(in) :: first
      real(wp), intent(in) :: scale
      type(lane_task), intent(in) :: task
      type(one_body_lanes), intent(inout) :: x
      integer, intent(in) :: l
      type(lane_type), intent(inout) :: lane
      type(lane_method), intent(inout) :: method
      type(error_type), allocatable, intent(out) :: error
      type(loads_type) :: loads
      type(initial_state) :: at_rest

      loads%ground%time = motion%time
      loads%ground%value = scale*motion%acceleration
      call start_state(lane%state, column%column, loads, at_rest, 0.0_wp, error)
      if (allocated(error)) return
      if (allocated(lane%stepper)) deallocate (lane%stepper)
      call new_stepper(lane%stepper, column%column, column%analysis, task%plan)
      associate (one => column%column)
         call inverse_of_mass(lane%state%motion, x%flexible(l), x%coupling(l), x%turning(l), x%softening(l))
         x%mass(l, 1) = one%mass(1)
         x%mass(l, 2) = one%inertia(1)
         x%lower(l) = one%lower(1)
         x%upper(l) = one%upper(1)
         x%length(l) = one%length(1)
         x%ground_arm(l, :) = one%ground_arm
         x%potential(l) = 0.0_wp
         if (one%axially_loaded) x%potential(l) = 0.5_wp*one%axial_body(1)*one%length(1)
         x%furthest(l) = huge(1.0_wp)
         if (is_given(column%analysis%collapse_drift)) then
            x%furthest(l) = column%analysis%collapse_drift*one%joint_height(2)
         end if
      end associate
      x%yield(l) = column%yield(1)
      select type (stepper => lane%stepper)
      class is (implicit_stepper)
         method = lane_method(stepper%step%alpha_m, stepper%step%alpha_f, stepper%step%beta, &
                              stepper%step%gamma, stepper%wanted)
      end select
      call enter_motion(lane%state%loads%ground%time, lane%state%loads%ground%value, first, scale, task, x, l)
      x%t(l) = 0.0_wp
      x%ground(l) = lane%state%load(horizontal)
      x%steps(l) = 0.0_wp
      x%of_loads(l) = 0.0_wp
      x%peak(l) = 0.0_wp
      x%base(l) = 0.0_wp
      x%rotation(l) = 0.0_wp
      x%residual(l) = 0.0_wp
      x%most(l) = 0.0_wp
      x%first_yield(l) = huge(1.0_wp)
      x%ended(l) = 0.0_wp
      x%active(l) = 1.0_wp
      x%ready(l) = 0.0_wp
      call from_state(x, l, lane%state)
   end subroutine enter

   !> The first two intervals of the motion.
   pure subroutine enter_motion(time, value, first, scale, task, x, l)
      !> Times and scaled values (m)
      real(wp), intent(in) :: time(:), value(:)
      integer, intent(in) :: first
      real(wp), intent(in) :: scale
      type(lane_task), intent(in) :: task
      type(one_body_lanes), intent(inout) :: x
      integer, intent(in) :: l
      integer :: m

      m = size(time)
      x%h(l) = task%plan%dt
      x%part(l) = 1.0_wp
      x%parts(l) = real(task%parts, wp)
      x%left(l) = real(m - 1, wp)
      x%scale(l) = scale
      x%begin(l) = time(1)
      x%finish(l) = time(2)
      x%value(l) = value(1)
      x%slope(l) = (value(2) - value(1))/(time(2) - time(1))
      x%next_value(l) = value(2)
      x%next_finish(l) = time(m) + 1.0_wp
      x%after_value(l) = value(m)
      x%next_slope(l) = 0.0_wp
      if (m > 2) then
         x%next_finish(l) = time(3)
         x%after_value(l) = value(3)
         x%next_slope(l) = (value(3) - value(2))/(time(3) - time(2))
      end if
      x%at(l) = int(first + 2, int32)
   end subroutine enter_motion

   !> A step by the method of the run itself.
   subroutine step_alone(x, l, lane, error)
      type(one_body_lanes), intent(inout) :: x
      integer, intent(in) :: l
      type(lane_type), intent(inout) :: lane
      type(error_type), allocatable, intent(out) :: error

      call into_state(x, l, lane%state)
      select type (stepper => lane%stepper)
      class is (implicit_stepper)
         if (x%ready(l) > 0.5_wp) call into_balance(x, l, stepper)
         call stepper%advance(lane%state, x%h(l), error)
         if (.not. allocated(error) .and. .not. (lane%state%lost .or. lane%state%springs%stuck)) then
            call from_balance(x, l, lane%state, stepper)
         end if
      class default
         call stepper%advance(lane%state, x%h(l), error)
      end select
      if (.not. allocated(error) .and. (lane%state%lost .or. lane%state%springs%stuck)) then
         call report_state(lane%state, error)
      end if
      if (allocated(error)) return
      call from_state(x, l, lane%state)
      x%ready(l) = 1.0_wp
   end subroutine step_alone

   !> The lane as a state.
   pure subroutine into_state(x, l, state)
      type(one_body_lanes), intent(in) :: x
      integer, intent(in) :: l
      type(state_type), intent(inout) :: state
      integer :: i

      do i = 1, 2
         state%q(i) = x%q(l, i)
         state%v(i) = x%v(l, i)
         state%springs%d(i) = x%q(l, i)
         state%springs%work(i) = x%work(l, i)
         state%springs%first(i) = x%first(l, i)
         state%springs%last(i) = x%last(l, i)
      end do
      state%time = x%t(l)
      state%clock = x%t(l)
      state%load(horizontal) = x%ground(l)
      state%of_loads = x%of_loads(l)
   end subroutine into_state

   !> The state as a lane.
   pure subroutine from_state(x, l, state)
      type(one_body_lanes), intent(inout) :: x
      integer, intent(in) :: l
      type(state_type), intent(in) :: state
      integer :: i

      do i = 1, 2
         x%q(l, i) = state%q(i)
         x%v(l, i) = state%v(i)
         x%work(l, i) = state%springs%work(i)
         x%d0(l, i) = state%springs%d0(i)
         x%f0(l, i) = state%springs%f0(i)
         x%k(l, i) = state%springs%k(i)
         x%first(l, i) = state%springs%first(i)
         x%last(l, i) = state%springs%last(i)
         x%way(l, i) = real(state%springs%one_way(i), wp)
      end do
      x%ground(l) = state%load(horizontal)
      x%of_loads(l) = state%of_loads
   end subroutine from_state

   pure subroutine into_balance(x, l, stepper)
      type(one_body_lanes), intent(in) :: x
      integer, intent(in) :: l
      class(implicit_stepper), intent(inout) :: stepper
      integer :: i

      do i = 1, 2
         stepper%step%v0(i) = x%v0(l, i)
         stepper%step%a0(i) = x%a0(l, i)
         stepper%step%g0(i) = x%g0(l, i)
         stepper%step%largest(i) = x%largest(l, i)
      end do
   end subroutine into_balance

   !> What the next step starts from, and the inverse of its tangent.
   subroutine from_balance(x, l, state, stepper)
      type(one_body_lanes), intent(inout) :: x
      integer, intent(in) :: l
      type(state_type), intent(in) :: state
      class(implicit_stepper), intent(inout) :: stepper
      integer :: i

      call stepper%one_body%fit(stepper%step, state, x%h(l))
      do i = 1, 2
         x%v0(l, i) = stepper%step%v0(i)
         x%a0(l, i) = stepper%step%a0(i)
         x%g0(l, i) = stepper%step%g0(i)
         x%largest(l, i) = stepper%step%largest(i)
         x%inverse(l, 2*i - 1) = stepper%one_body%inverse(i, 1)
         x%inverse(l, 2*i) = stepper%one_body%inverse(i, 2)
      end do
      x%per_h(l) = stepper%one_body%per_h
   end subroutine from_balance

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
      value(at_events) = real(lane%state%springs%events, wp)
      value(at_cut) = real(lane%stepper%cut_steps, wp)
      value(at_lost_joint) = 0.0_wp
      outcome%value = value
   end subroutine settle_lane

end module rbs_solve_ensemble_lane_runs
