!> Steps that lanes do not take side by side: where a spring leaves its line, where the method has to find
!> something first, and where a step has to be cut. Each lane has the state of its run and its method beside
!> it. The lane is put into them, goes on as every run does, and comes back. So a lane has the bits of a run
!> alone, and all rules of the program.
module rbs_solve_ensemble_lane_step
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_segment, only: segment
   use rbs_loading_signal, only: signal_type
   use rbs_solve_ensemble_lane_fields, only: one_body_lanes
   use rbs_solve_time_implicit, only: implicit_stepper
   use rbs_solve_time_loads, only: horizontal
   use rbs_solve_time_march, only: report_state
   use rbs_solve_time_state, only: state_type, stepper_type
   implicit none
   private

   public :: lane_type, go_on, from_state, show_motion

   !> What stands beside a lane.
   type :: lane_type
      !> Place of the task, 0: none
      integer :: task = 0
      type(state_type) :: state
      class(stepper_type), allocatable :: stepper
   end type lane_type

contains

   !> Take a lane over the step that its neighbours have taken.
   subroutine go_on(x, l, lane, error)
      type(one_body_lanes), intent(inout) :: x
      integer, intent(in) :: l
      type(lane_type), intent(inout) :: lane
      type(error_type), allocatable, intent(out) :: error
      logical :: taken

      taken = .false.
      if (x%tried(l) > 0.5_wp) then
         select type (stepper => lane%stepper)
         type is (implicit_stepper)
            call follow_trial(x, l, lane%state, stepper, taken)
         class default
            call follow_body(x, l, lane%state)
            taken = .true.
         end select
      end if
      if (.not. taken) call step_alone(x, l, lane, error)
      if (allocated(error)) return
      if (lane%state%lost .or. lane%state%springs%stuck) then
         call report_state(lane%state, error)
         return
      end if
      x%ready(l) = 1.0_wp
   end subroutine go_on

   !> The step of RK4 has ended, and only the springs have still to follow.
   subroutine follow_body(x, l, state)
      type(one_body_lanes), intent(inout) :: x
      integer, intent(in) :: l
      type(state_type), intent(inout) :: state
      integer :: i

      do i = 1, 2
         state%springs%d(i) = x%from(l, i)
         state%springs%work(i) = x%work(l, i)
         state%springs%first(i) = x%first(l, i)
         state%springs%last(i) = x%last(l, i)
         state%q(i) = x%q(l, i)
      end do
      state%time = x%t(l) + x%h(l)
      call state%springs%move_all(state%q)
      if (.not. state%springs%stuck) call from_springs(x, l, state)
   end subroutine follow_body

   !> Follow the trial of an implicit step along the lines of the springs.
   subroutine follow_trial(x, l, lane, stepper, taken)
      type(one_body_lanes), intent(inout) :: x
      integer, intent(in) :: l
      type(state_type), intent(inout) :: lane
      type(implicit_stepper), intent(inout) :: stepper
      logical, intent(out) :: taken
      integer :: i

      associate (bent => stepper%one_body%bent)
         bent%ground = x%trial(l, 4)
         bent%work = x%trial(l, 3)
         do i = 1, 2
            bent%moved(i) = x%trial(l, i)
            bent%q0(i) = x%q(l, i)
            bent%v0(i) = x%v0(l, i)
            bent%a0(i) = x%a0(l, i)
            bent%g0(i) = x%g0(l, i)
            bent%largest(i) = x%largest(l, i)
            associate (spring => bent%spring(i))
               spring%line = line_of(x, l, i)
               spring%first = x%first(l, i)
               spring%last = x%last(l, i)
               spring%d = x%q(l, i)
               spring%work = x%work(l, i)
            end associate
         end do
         call bent%solve(lane%springs%slot, stepper%one_body%kept, taken)
         if (.not. taken) return
         x%steps(l) = x%steps(l) + 1.0_wp
         x%events(l) = x%events(l) + bent%events
         x%of_loads(l) = x%of_loads(l) - 0.5_wp*(x%ground(l) + bent%ground)*bent%mass(1)*bent%moved(1)
         x%ground(l) = bent%ground
         x%v(l, 1) = bent%v1(1) - bent%lower*bent%v1(2)
         x%v(l, 2) = bent%v1(2)
         do i = 1, 2
            x%q(l, i) = bent%q(i)
            x%v0(l, i) = bent%v1(i)
            x%a0(l, i) = bent%a1(i)
            x%g0(l, i) = bent%g(i)
            x%largest(l, i) = bent%scale(i)
            x%work(l, i) = bent%spring(i)%work
            if (bent%spring(i)%way /= 0) call put_line(x, l, i, bent%spring(i)%line)
            x%first(l, i) = bent%spring(i)%first
            x%last(l, i) = bent%spring(i)%last
         end do
         do i = 1, 4
            x%inverse(l, i) = bent%inverse(i)
         end do
      end associate
   end subroutine follow_trial

   !> The line of a spring, in the form that its rule takes.
   pure type(segment) function line_of(x, l, i) result(line)
      type(one_body_lanes), intent(in) :: x
      integer, intent(in) :: l, i

      line%d0 = x%d0(l, i)
      line%f0 = x%f0(l, i)
      line%k = x%k(l, i)
      line%lo = x%lo(l, i)
      line%hi = x%hi(l, i)
      line%lo_closed = x%lo_closed(l, i)
      line%hi_closed = x%hi_closed(l, i)
      line%one_way = int(x%way(l, i))
   end function line_of

   pure subroutine put_line(x, l, i, line)
      type(one_body_lanes), intent(inout) :: x
      integer, intent(in) :: l, i
      type(segment), intent(in) :: line

      x%d0(l, i) = line%d0
      x%f0(l, i) = line%f0
      x%k(l, i) = line%k
      x%lo(l, i) = line%lo
      x%hi(l, i) = line%hi
      x%lo_closed(l, i) = line%lo_closed
      x%hi_closed(l, i) = line%hi_closed
      x%way(l, i) = real(line%one_way, wp)
   end subroutine put_line

   !> A whole step by the method of the run itself.
   subroutine step_alone(x, l, lane, error)
      type(one_body_lanes), intent(inout) :: x
      integer, intent(in) :: l
      type(lane_type), intent(inout) :: lane
      type(error_type), allocatable, intent(out) :: error

      call into_state(x, l, lane%state)
      select type (stepper => lane%stepper)
      type is (implicit_stepper)
         if (x%ready(l) > 0.5_wp) call into_balance(x, l, stepper)
         call stepper%advance(lane%state, x%h(l), error)
         if (.not. allocated(error) .and. .not. (lane%state%lost .or. lane%state%springs%stuck)) then
            call from_balance(x, l, lane%state, stepper)
         end if
      class default
         call stepper%advance(lane%state, x%h(l), error)
      end select
      if (.not. allocated(error)) call from_state(x, l, lane%state)
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
         call state%springs%put(i, line_of(x, l, i), x%q(l, i), x%work(l, i))
      end do
      call show_motion(x, l, state%loads%ground)
      state%time = x%t(l)
      state%clock = x%t(l)
      state%load(horizontal) = x%ground(l)
      state%of_loads = x%of_loads(l)
   end subroutine into_state

   !> Of its motion the state has the present interval and the next.
   pure subroutine show_motion(x, l, ground)
      type(one_body_lanes), intent(in) :: x
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

   !> The state as a lane.
   pure subroutine from_state(x, l, state)
      type(one_body_lanes), intent(inout) :: x
      integer, intent(in) :: l
      type(state_type), intent(in) :: state
      integer :: i

      do i = 1, 2
         x%q(l, i) = state%q(i)
         x%v(l, i) = state%v(i)
      end do
      x%ground(l) = state%load(horizontal)
      x%of_loads(l) = state%of_loads
      call from_springs(x, l, state)
   end subroutine from_state

   !> The lines of the springs.
   pure subroutine from_springs(x, l, state)
      type(one_body_lanes), intent(inout) :: x
      integer, intent(in) :: l
      type(state_type), intent(in) :: state
      integer :: i

      do i = 1, 2
         x%work(l, i) = state%springs%work(i)
         call put_line(x, l, i, state%springs%line_of(i))
         x%first(l, i) = state%springs%first(i)
         x%last(l, i) = state%springs%last(i)
      end do
   end subroutine from_springs

   pure subroutine into_balance(x, l, stepper)
      type(one_body_lanes), intent(in) :: x
      integer, intent(in) :: l
      type(implicit_stepper), intent(inout) :: stepper
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
      type(implicit_stepper), intent(inout) :: stepper
      integer :: i

      call stepper%one_body%fit(stepper%step, state, x%h(l))
      do i = 1, 2
         x%v0(l, i) = stepper%step%v0(i)
         x%a0(l, i) = stepper%step%a0(i)
         x%g0(l, i) = stepper%step%g0(i)
         x%largest(l, i) = stepper%step%largest(i)
      end do
      do i = 1, 4
         x%inverse(l, i) = stepper%one_body%bent%inverse(i)
      end do
      x%per_h(l) = stepper%one_body%bent%per_h
      stepper%one_body%bent%wanted = stepper%wanted
      stepper%one_body%bent%push = 0.0_wp
      stepper%one_body%bent%hears = state%springs%heard(1) > 0
   end subroutine from_balance

end module rbs_solve_ensemble_lane_step
