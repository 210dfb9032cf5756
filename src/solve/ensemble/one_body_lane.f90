!> Lanes whose springs leave their lines: they follow the result of the kernel,
!> with all numbers in one record, without the state of a run alone. The record is the same for all lanes, so
!> that it stays near the processor; a lane keeps its lines. In all procedures x has column and clock of every
!> lane, y motion and springs; l is the lane.
module rbs_solve_ensemble_one_body_lane
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_segment, only: segment
   use rbs_hysteresis_springs, only: spring_array
   use rbs_solve_ensemble_lane_arrays, only: lane_clock, body_arrays, lane_method
   use rbs_solve_one_body_implicit_one_body, only: one_body_step, body_spring, side_of, move_spring, &
                                                   advance_on_branch
   use rbs_solve_one_body_body_damping, only: body_damping, decay_of
   use rbs_solve_one_body_rk4_one_body, only: rk4_body, resistance_per_velocity
   use rbs_solve_time_state, only: state_type
   implicit none
   private

   public :: body_to_lane, method_to_body, follow_springs, follow_trial, lines_to_lane, lines_from_lane

contains

   !> Put masses, lengths and axial force of a column into a lane.
   subroutine body_to_lane(x, l, state)
      !> Clock and column of every lane
      type(lane_clock), intent(inout) :: x
      !> Number of the lane
      integer, intent(in) :: l
      type(state_type), intent(in) :: state
      type(rk4_body) :: body

      call body%create(state%motion%one_body)
      x%inv_mass(l) = body%inv_mass
      x%inv_coupling(l) = body%inv_coupling
      x%inv_inertia(l) = body%inv_inertia
      x%pdelta_moment(l) = body%pdelta_moment
      associate (column => state%motion%one_body)
         x%mass(l, :) = column%inertias
         x%lower(l) = column%lower(1)
         x%upper(l) = column%upper(1)
         x%length(l) = column%length(1)
      end associate
   end subroutine body_to_lane

   !> Take over the parameters of the method, which are the same in all lanes.
   pure subroutine method_to_body(method, body)
      type(lane_method), intent(in) :: method
      !> The record of a step, which all lanes share
      type(one_body_step), intent(inout) :: body

      body%alpha_m = method%alpha_m
      body%alpha_f = method%alpha_f
      body%beta = method%beta
      body%gamma = method%gamma
      body%wanted = method%wanted
   end subroutine method_to_body

   !> Copy the column of a lane and its step into the record that all lanes share.
   pure subroutine lane_to_body(x, l, damping, body)
      !> Clock and column of every lane
      type(lane_clock), intent(in) :: x
      !> Number of the lane
      integer, intent(in) :: l
      !> Damping of the column, if it has any
      type(body_damping), intent(in) :: damping
      !> The record of a step, which all lanes share
      type(one_body_step), intent(inout) :: body

      body%h = x%h(l)
      body%per_h = x%per_h(l)
      body%mass(1) = x%mass(l, 1)
      body%mass(2) = x%mass(l, 2)
      body%lower = x%lower(l)
      body%upper = x%upper(l)
      body%pdelta_moment = x%pdelta_moment(l)
      if (x%damped) body%damping = damping
      ! The tangent in the record is that of another lane.
      body%fits = .false.
   end subroutine lane_to_body

   !> RK4 has moved the column to the end of the step: move the springs there, along as many lines as they
   !> pass, and put them into the lane.
   subroutine follow_springs(x, y, l, damping, line, springs)
      !> Clock and column of every lane
      type(lane_clock), intent(inout) :: x
      !> Motion and springs of every lane
      type(body_arrays), intent(inout) :: y
      !> Number of the lane
      integer, intent(in) :: l
      !> Damping of the column, if it has any
      type(body_damping), intent(in) :: damping
      !> Present lines of the springs of this lane, slip and rotation
      type(segment), intent(inout) :: line(2)
      !> Springs of the run alone, whose rules and memories these lines come from
      type(spring_array), intent(inout) :: springs
      type(body_spring) :: spring
      integer :: i, events

      ! Slip and rotation
      do i = 1, 2
         spring%line = line(i)
         spring%lower = y%lower(l, i)
         spring%upper = y%upper(l, i)
         spring%d = y%from(l, i)
         spring%work = y%work(l, i)
         if (side_of(spring, y%q(l, i)) == 0) then
            call advance_on_branch(spring, y%q(l, i))
         else
            ! The first spring may decay with the work of the second up to the start of the step.
            call move_spring(spring, springs%slot(i), y%q(l, i), y%work(l, 2), events, springs%stuck)
            if (springs%stuck) return
            springs%events = springs%events + events
            line(i) = spring%line
         end if
         call spring_to_lane(y, l, i, spring)
      end do
      call fit_resistance(x, y, l, damping)
   end subroutine follow_springs

   !> Complete an implicit step whose trial, on the lines of its start, takes springs beyond the ends of these
   !> lines: find its end along the lines that follow, and put it into the lane.
   subroutine follow_trial(x, y, l, damping, body, line, springs, taken)
      !> Clock and column of every lane
      type(lane_clock), intent(inout) :: x
      !> Motion and springs of every lane
      type(body_arrays), intent(inout) :: y
      !> Number of the lane
      integer, intent(in) :: l
      !> Damping of the column, if it has any
      type(body_damping), intent(in) :: damping
      !> The record of a step, which all lanes share
      type(one_body_step), intent(inout) :: body
      !> Present lines of the springs of this lane, slip and rotation
      type(segment), intent(inout) :: line(2)
      !> Springs of the run alone, whose rules and memories these lines come from
      type(spring_array), intent(inout) :: springs
      !> Whether the end was found; else the lane is as before
      logical, intent(out) :: taken
      integer :: i

      call lane_to_body(x, l, damping, body)
      ! A trial: slip, rotation, work of the residual, acceleration of the ground.
      body%ground = x%trial(l, 4)
      body%work = x%trial(l, 3)
      do i = 1, 2
         body%moved(i) = x%trial(l, i)
         body%q0(i) = y%q(l, i)
         body%v0(i) = y%v0(l, i)
         body%a0(i) = y%a0(l, i)
         body%g0(i) = y%g0(l, i)
         body%largest(i) = y%largest(l, i)
         ! Both number by number: a record that has just been written so is not at hand as a whole.
         call spring_from_lane(y, l, i, line(i), body%start(i))
         call spring_from_lane(y, l, i, line(i), body%spring(i))
      end do
      call body%solve(springs%slot, taken)
      if (.not. taken) return
      x%steps(l) = x%steps(l) + 1.0_wp
      springs%events = springs%events + body%events
      x%of_loads(l) = x%of_loads(l) - 0.5_wp*(x%ground(l) + body%ground)*body%mass(1)*body%moved(1)
      if (x%damped) then
         x%of_damping(l) = x%of_damping(l) + body%work_of_damping(body%v0)
         x%c(l, :) = body%c
      end if
      x%ground(l) = body%ground
      ! The velocity of the slip is that of the bottom of the body.
      y%v(l, 1) = body%v1(1) - body%lower*body%v1(2)
      y%v(l, 2) = body%v1(2)
      do i = 1, 2
         y%q(l, i) = body%q(i)
         y%v0(l, i) = body%v1(i)
         y%a0(l, i) = body%a1(i)
         y%g0(l, i) = body%g(i)
         y%largest(l, i) = body%scale(i)
         call spring_to_lane(y, l, i, body%spring(i))
         if (body%spring(i)%direction /= 0) line(i) = body%spring(i)%line
      end do
      do i = 1, 4
         x%inverse(l, i) = body%inverse(i)
      end do
   end subroutine follow_trial

   !> Take spring i (1: slip, 2: rotation) from lane l, as it is at the start of a step.
   pure subroutine spring_from_lane(y, l, i, line, spring)
      !> Motion and springs of every lane
      type(body_arrays), intent(in) :: y
      !> Number of the lane; 1: slip, 2: rotation
      integer, intent(in) :: l, i
      type(segment), intent(in) :: line
      type(body_spring), intent(inout) :: spring

      spring%line = line
      spring%lower = y%lower(l, i)
      spring%upper = y%upper(l, i)
      spring%d = y%q(l, i)
      spring%work = y%work(l, i)
      ! It has not come to its line in this step.
      spring%direction = 0
   end subroutine spring_from_lane

   !> Put work and line of spring i (1: slip, 2: rotation) into lane l.
   pure subroutine spring_to_lane(y, l, i, spring)
      !> Motion and springs of every lane
      type(body_arrays), intent(inout) :: y
      !> Number of the lane; 1: slip, 2: rotation
      integer, intent(in) :: l, i
      type(body_spring), intent(in) :: spring

      y%work(l, i) = spring%work
      y%lower(l, i) = spring%lower
      y%upper(l, i) = spring%upper
      y%d0(l, i) = spring%line%d0
      y%f0(l, i) = spring%line%f0
      y%k(l, i) = spring%line%k
      y%direction(l, i) = real(spring%line%unload_on_reversal, wp)
   end subroutine spring_to_lane

   !> Take from the state of a run alone the lines on which the next steps start, and put what these steps
   !> need of them into the lane: the inverse of the tangent, or what RK4 multiplies velocities by.
   subroutine lines_to_lane(x, y, l, state, body, implicit, line)
      !> Clock and column of every lane
      type(lane_clock), intent(inout) :: x
      !> Motion and springs of every lane
      type(body_arrays), intent(in) :: y
      !> Number of the lane
      integer, intent(in) :: l
      type(state_type), intent(in) :: state
      !> The record of a step, which all lanes share
      type(one_body_step), intent(inout) :: body
      !> Whether the method is implicit
      logical, intent(in) :: implicit
      !> Present lines of the springs of this lane, slip and rotation
      type(segment), intent(out) :: line(2)
      integer :: i

      do i = 1, 2
         line(i) = state%springs%line_of(i)
      end do
      ! The record is shared: step and column of this lane come first, then the tangent.
      if (implicit) then
         call body%set_step(x%h(l))
         x%per_h(l) = body%per_h
         call lane_to_body(x, l, state%motion%damping, body)
         call body%fit_to(state%springs)
         x%inverse(l, :) = body%inverse
         x%c(l, :) = body%c
      else
         call fit_resistance(x, y, l, state%motion%damping)
      end if
   end subroutine lines_to_lane

   !> Give the springs of a run alone the lines, deformations and works that they have in the lane.
   subroutine lines_from_lane(y, l, line, springs)
      !> Motion and springs of every lane
      type(body_arrays), intent(in) :: y
      !> Number of the lane
      integer, intent(in) :: l
      !> Present lines of the springs of this lane, slip and rotation
      type(segment), intent(in) :: line(2)
      !> Springs of the run alone, whose rules and memories these lines come from
      type(spring_array), intent(inout) :: springs
      integer :: i

      do i = 1, 2
         call springs%put(i, line(i), y%q(l, i), y%work(l, i))
      end do
   end subroutine lines_from_lane

   !> Renew what a step of RK4 multiplies velocities by, resistance and damping, after a spring has changed
   !> its line.
   pure subroutine fit_resistance(x, y, l, damping)
      !> Clock and column of every lane
      type(lane_clock), intent(inout) :: x
      !> Motion and springs of every lane
      type(body_arrays), intent(in) :: y
      !> Number of the lane
      integer, intent(in) :: l
      !> Damping of the column, if it has any
      type(body_damping), intent(in) :: damping
      real(wp) :: g(4)
      integer :: i

      g = resistance_per_velocity(x%inv_mass(l), x%inv_coupling(l), x%inv_inertia(l), x%pdelta_moment(l), &
                                  y%k(l, 1), y%k(l, 2), 0.5_wp*x%h(l))
      do i = 1, 4
         x%g(l, i) = g(i)
      end do
      if (.not. x%damped) return
      x%c(l, :) = damping%on_lines(y%k(l, 1), y%k(l, 2))
      x%d(l, :) = decay_of(x%inv_mass(l), x%inv_coupling(l), x%inv_inertia(l), x%c(l, :))
   end subroutine fit_resistance

end module rbs_solve_ensemble_one_body_lane
