!> Which runs lanes can take, and how a run begins in a lane.
module rbs_solve_ensemble_lane_entry
   use, intrinsic :: iso_fortran_env, only: int32
   use rbs_base_check, only: is_given
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_column_column, only: finite
   use rbs_solve_ensemble_lane_fields, only: one_body_lanes, lane_method
   use rbs_solve_ensemble_lane_step, only: lane_type, from_state, show_motion
   use rbs_solve_ensemble_subject, only: ensemble_column, ensemble_motion, watch_type
   use rbs_solve_time_implicit, only: implicit_stepper
   use rbs_solve_time_loads, only: loads_type, horizontal
   use rbs_solve_time_march, only: initial_state, start_state, step_of
   use rbs_solve_time_plan, only: time_plan
   use rbs_solve_time_rk4_one_body, only: inverse_of_mass
   use rbs_solve_time_run_dynamic, only: new_stepper
   implicit none
   private

   public :: lane_task, takes_lanes, motion_table, fill_table, enter

   !> A run that lanes can take, and its steps.
   type :: lane_task
      integer :: run = 0
      type(time_plan) :: plan
      !> Equal steps in each interval of the motion
      integer :: parts = 1
   end type lane_task

   !> Motions as the kernel reads them: one after the other, each followed by two more points.
   type :: motion_table
      real(wp), allocatable :: time(:), acceleration(:)
      integer, allocatable :: first(:)
   end type motion_table

contains

   !> Whether lanes can take a run: one body without damping, all steps equal, lines changed at the end of
   !> a step, watched for yield at a rotation alone.
   pure logical function takes_lanes(of_runs, plan, time)
      type(ensemble_column), intent(in) :: of_runs
      type(time_plan), intent(in) :: plan
      real(wp), intent(in) :: time(:)
      integer :: i

      takes_lanes = .false.
      associate (column => of_runs%column)
         if (column%unknowns /= 2 .or. column%kinematics == finite .or. column%damped) return
         if (any(column%spring%rule == 'layered')) return
      end associate
      if (.not. one_rotation(of_runs%watch)) return
      select case (plan%method)
      case ('rk4')
         if (plan%located .or. of_runs%analysis%events == 'located') return
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

   !> Whether all that is watched is yield at one rotation to both sides, or nothing.
   pure logical function one_rotation(watch)
      type(watch_type), intent(in) :: watch(:)

      one_rotation = size(watch) == 0
      if (size(watch) /= 2) return
      one_rotation = all(watch%state == 1 .and. abs(watch%slip) <= 0.0_wp &
                         .and. abs(watch%opening) <= 0.0_wp) &
                     .and. abs(watch(1)%rotation + watch(2)%rotation) <= 0.0_wp &
                     .and. abs(watch(1)%threshold - watch(2)%threshold) <= 0.0_wp
   end function one_rotation

   !> All motions one after the other.
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

      call enter_motion(motion, first, scale, task, x, l)
      allocate (loads%ground%time(3), loads%ground%value(3))
      call show_motion(x, l, loads%ground)
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
      x%yield(l) = huge(1.0_wp)
      if (size(column%watch) > 0) x%yield(l) = column%watch(1)%threshold/abs(column%watch(1)%rotation)
      select type (stepper => lane%stepper)
      class is (implicit_stepper)
         method = lane_method(stepper%step%alpha_m, stepper%step%alpha_f, stepper%step%beta, &
                              stepper%step%gamma, stepper%wanted)
      end select
      x%t(l) = 0.0_wp
      x%ground(l) = lane%state%load(horizontal)
      x%steps(l) = 0.0_wp
      x%events(l) = 0.0_wp
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
   pure subroutine enter_motion(motion, first, scale, task, x, l)
      type(ensemble_motion), intent(in) :: motion
      integer, intent(in) :: first
      real(wp), intent(in) :: scale
      type(lane_task), intent(in) :: task
      type(one_body_lanes), intent(inout) :: x
      integer, intent(in) :: l
      integer :: m

      m = size(motion%time)
      associate (time => motion%time, value => motion%acceleration)
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
         x%next_finish(l) = time(m) + 1.0_wp
         x%after_value(l) = x%next_value(l)
         x%next_slope(l) = 0.0_wp
         if (m > 2) then
            x%next_finish(l) = time(3)
            x%after_value(l) = scale*value(3)
            x%next_slope(l) = (x%after_value(l) - x%next_value(l))/(time(3) - time(2))
         end if
         x%at(l) = int(first + 2, int32)
      end associate
   end subroutine enter_motion

end module rbs_solve_ensemble_lane_entry
