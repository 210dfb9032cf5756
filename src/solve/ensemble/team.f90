!> Columns that advance side by side, and what stands beside each lane: the state of its run and its method.
!> For a step on which a spring leaves its line, for which the method has to find something first, or which
!> has to be cut, the lane is put into them, goes on as every run does, and comes back. So a lane has the
!> bits of a run alone, and all rules of the program.
module rbs_solve_ensemble_team
   use, intrinsic :: iso_fortran_env, only: int32
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_loading_signal, only: signal_type
   use rbs_solve_ensemble_dispatch, only: kernel_type
   use rbs_solve_ensemble_lane_fields, only: lane_clock, lane_method, lanes
   use rbs_solve_ensemble_motions, only: motion_table
   use rbs_solve_ensemble_outcome, only: outcome_type
   use rbs_solve_ensemble_subject, only: ensemble_column, ensemble_motion, lane_task
   use rbs_solve_time_implicit, only: implicit_stepper
   use rbs_loading_loads, only: loads_type, horizontal
   use rbs_solve_time_march, only: initial_state, start_state
   use rbs_solve_time_run_dynamic, only: new_stepper
   use rbs_solve_time_sight, only: sight_type
   use rbs_solve_time_state, only: state_type, stepper_type
   implicit none
   private

   public :: team_type, lane_type, begin_run, show_motion, show_seen, take_seen

   !> What stands beside a lane.
   type :: lane_type
      !> Place of the task, 0: none
      integer :: task = 0
      type(state_type) :: state
      class(stepper_type), allocatable :: stepper
   end type lane_type

   type, abstract :: team_type
      type(kernel_type) :: kernel
      !> Parameters of the method, if it is an implicit one
      logical :: implicit = .false.
      type(lane_method) :: method
      type(lane_type), allocatable :: lane(:)
   contains
      procedure(enter_interface), deferred :: enter
      procedure(advance_interface), deferred :: advance
      procedure(go_on_interface), deferred :: go_on
      procedure(finish_interface), deferred :: finish
      procedure(settle_interface), deferred :: settle
      procedure(leave_interface), deferred :: leave
   end type team_type

   abstract interface
      !> A run begins in a lane. Its first step is taken alone, as then the method finds what it needs.
      subroutine enter_interface(self, l, column, motion, first, task, error)
         import :: team_type, ensemble_column, ensemble_motion, lane_task, error_type
         implicit none
         class(team_type), intent(inout) :: self
         integer, intent(in) :: l
         type(ensemble_column), intent(in) :: column
         type(ensemble_motion), intent(in) :: motion
         !> Place of the first point of the motion in the table
         integer, intent(in) :: first
         type(lane_task), intent(in) :: task
         type(error_type), allocatable, intent(out) :: error
      end subroutine enter_interface

      !> A step of all lanes; those that could not take it, or not wholly, are listed.
      subroutine advance_interface(self, count, list)
         import :: team_type, lanes
         implicit none
         class(team_type), intent(inout) :: self
         integer, intent(out) :: count, list(lanes)
      end subroutine advance_interface

      !> Take a lane that is listed over the step that its neighbours have taken.
      subroutine go_on_interface(self, l, error)
         import :: team_type, error_type
         implicit none
         class(team_type), intent(inout) :: self
         integer, intent(in) :: l
         type(error_type), allocatable, intent(out) :: error
      end subroutine go_on_interface

      !> After a step: the clock and the measures. Lanes whose runs have ended are listed.
      subroutine finish_interface(self, table, count, list)
         import :: team_type, motion_table, lanes
         implicit none
         class(team_type), intent(inout) :: self
         type(motion_table), intent(in) :: table
         integer, intent(out) :: count, list(lanes)
      end subroutine finish_interface

      !> Fate and measures of a run that has ended.
      subroutine settle_interface(self, l, task, outcome)
         import :: team_type, lane_task, outcome_type
         implicit none
         class(team_type), intent(in) :: self
         integer, intent(in) :: l
         type(lane_task), intent(in) :: task
         type(outcome_type), intent(inout) :: outcome
      end subroutine settle_interface

      !> A lane is empty.
      subroutine leave_interface(self, l)
         import :: team_type
         implicit none
         class(team_type), intent(inout) :: self
         integer, intent(in) :: l
      end subroutine leave_interface
   end interface

contains

   !> State, method and clock of a run at its start.
   subroutine begin_run(team, x, l, column, motion, first, task, error)
      class(team_type), intent(inout) :: team
      !> Those of the team
      class(lane_clock), intent(inout) :: x
      integer, intent(in) :: l
      type(ensemble_column), intent(in) :: column
      type(ensemble_motion), intent(in) :: motion
      integer, intent(in) :: first
      type(lane_task), intent(in) :: task
      type(error_type), allocatable, intent(out) :: error
      type(loads_type) :: loads
      type(initial_state) :: at_rest

      call enter_motion(motion, first, task, x, l)
      allocate (loads%ground%time(3), loads%ground%value(3))
      call show_motion(x, l, loads%ground)
      associate (lane => team%lane(l))
         call start_state(lane%state, column%column, loads, at_rest, 0.0_wp, error)
         if (allocated(error)) return
         if (allocated(lane%stepper)) deallocate (lane%stepper)
         call new_stepper(lane%stepper, column%column, column%analysis, task%plan)
         select type (stepper => lane%stepper)
         type is (implicit_stepper)
            team%implicit = .true.
            team%method = lane_method(stepper%step%alpha_m, stepper%step%alpha_f, stepper%step%beta, &
                                      stepper%step%gamma, stepper%wanted, stepper%acceptable)
         end select
         x%ground(l) = lane%state%load(horizontal)
      end associate
      associate (state => team%lane(l)%state)
         call state%sight%watch_for(column%watch, column%states)
         call state%begin_sight(column%analysis%collapse_drift, .false.)
         x%furthest(l) = state%sight%furthest
         call take_seen(x, l, state%sight)
      end associate
      x%seen(l) = 0.0_wp
      x%t(l) = 0.0_wp
      x%steps(l) = 0.0_wp
      x%events(l) = 0.0_wp
      x%of_loads(l) = 0.0_wp
      x%displacement(l) = 0.0_wp
      x%ended(l) = 0.0_wp
      x%active(l) = 1.0_wp
      x%ready(l) = 0.0_wp
      x%tried(l) = 0.0_wp
   end subroutine begin_run

   !> The first two intervals of the motion.
   pure subroutine enter_motion(motion, first, task, x, l)
      type(ensemble_motion), intent(in) :: motion
      integer, intent(in) :: first
      type(lane_task), intent(in) :: task
      class(lane_clock), intent(inout) :: x
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

   !> Of its motion a run alone has the present interval and the next.
   pure subroutine show_motion(x, l, ground)
      class(lane_clock), intent(in) :: x
      integer, intent(in) :: l
      type(signal_type), intent(inout) :: ground
      real(wp) :: time(3), value(3)

      time(1) = x%begin(l)
      time(2) = x%finish(l)
      time(3) = x%next_finish(l)
      value(1) = x%value(l)
      value(2) = x%next_value(l)
      value(3) = x%after_value(l)
      call ground%replace(time, value)
   end subroutine show_motion

   !> What has been seen of a lane before a step that it takes alone: within that step more is seen.
   pure subroutine show_seen(x, l, sight)
      class(lane_clock), intent(in) :: x
      integer, intent(in) :: l
      type(sight_type), intent(inout) :: sight

      sight%peak_displacement = x%peak(l)
      sight%peak_base_shear = x%base(l)
      sight%peak_rotation = x%rotation(l)
      sight%clock = x%t(l)
   end subroutine show_seen

   !> What has been seen then.
   pure subroutine take_seen(x, l, sight)
      class(lane_clock), intent(inout) :: x
      integer, intent(in) :: l
      type(sight_type), intent(in) :: sight

      x%peak(l) = sight%peak_displacement
      x%base(l) = sight%peak_base_shear
      x%rotation(l) = sight%peak_rotation
   end subroutine take_seen

end module rbs_solve_ensemble_team
