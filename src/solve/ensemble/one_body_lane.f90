!> Lanes of one body without damping whose springs leave their lines: they follow what the kernel has found,
!> with all numbers in one record, without the state of a run alone.
module rbs_solve_ensemble_one_body_lane
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_springs, only: spring_array
   use rbs_solve_ensemble_lane_arrays, only: lane_clock, lane_block
   use rbs_solve_one_body_implicit_one_body, only: one_body_step, body_spring, side_of, move_spring, &
                                                   advance_on_branch
   use rbs_solve_one_body_rk4_one_body, only: rk4_body, resistance_per_velocity
   use rbs_solve_time_implicit, only: implicit_stepper, fit_one_body
   use rbs_solve_time_state, only: state_type, stepper_type
   implicit none
   private

   public :: body_to_lane, follow_springs, follow_trial, lines_to_body, lines_from_body

contains

   !> What of a column stays as it is.
   subroutine body_to_lane(x, l, state)
      type(lane_clock), intent(inout) :: x
      integer, intent(in) :: l
      type(state_type), intent(in) :: state
      type(rk4_body) :: body

      call body%create(state%motion%one_body)
      x%flexible(l) = body%flexible
      x%coupling(l) = body%coupling
      x%turning(l) = body%turning
      x%softening(l) = body%softening
      associate (column => state%motion%one_body)
         x%mass(l, :) = column%inertias
         x%lower(l) = column%lower(1)
         x%upper(l) = column%upper(1)
         x%length(l) = column%length(1)
      end associate
   end subroutine body_to_lane

   !> The step of RK4 has ended, and only the springs have still to follow.
   subroutine follow_springs(x, b, l, body, springs)
      type(lane_clock), intent(inout) :: x
      type(lane_block), intent(inout) :: b
      integer, intent(in) :: l
      type(one_body_step), intent(inout) :: body
      type(spring_array), intent(inout) :: springs
      integer :: i, events

      do i = 1, 2
         associate (spring => body%spring(i))
            call spring_from_lane(b, l, i, b%from(l, i), spring)
            if (side_of(spring, b%q(l, i)) == 0) then
               call advance_on_branch(spring, b%q(l, i))
            else
               ! The first spring may decay with what the second has done up to the start of the step.
               call move_spring(spring, springs, i, b%q(l, i), b%work(l, 2), events, springs%stuck)
               if (springs%stuck) return
               springs%events = springs%events + events
               call line_to_lane(b, l, i, spring)
            end if
            call spring_to_lane(b, l, i, spring)
         end associate
      end do
      call fit_resistance(x, b, l)
   end subroutine follow_springs

   !> Follow the trial of an implicit step along the lines of the springs.
   subroutine follow_trial(x, b, l, body, springs, taken)
      type(lane_clock), intent(inout) :: x
      type(lane_block), intent(inout) :: b
      integer, intent(in) :: l
      type(one_body_step), intent(inout) :: body
      type(spring_array), intent(inout) :: springs
      logical, intent(out) :: taken
      integer :: i

      body%ground = x%trial(l, 4)
      body%work = x%trial(l, 3)
      do i = 1, 2
         body%moved(i) = x%trial(l, i)
         body%q0(i) = b%q(l, i)
         body%v0(i) = b%v0(l, i)
         body%a0(i) = b%a0(l, i)
         body%g0(i) = b%g0(l, i)
         body%largest(i) = b%largest(l, i)
         call spring_from_lane(b, l, i, b%q(l, i), body%spring(i))
      end do
      call body%solve(springs, taken)
      if (.not. taken) return
      x%steps(l) = x%steps(l) + 1.0_wp
      springs%events = springs%events + body%events
      x%of_loads(l) = x%of_loads(l) - 0.5_wp*(x%ground(l) + body%ground)*body%mass(1)*body%moved(1)
      x%ground(l) = body%ground
      b%v(l, 1) = body%v1(1) - body%lower*body%v1(2)
      b%v(l, 2) = body%v1(2)
      do i = 1, 2
         b%q(l, i) = body%q(i)
         b%v0(l, i) = body%v1(i)
         b%a0(l, i) = body%a1(i)
         b%g0(l, i) = body%g(i)
         b%largest(l, i) = body%scale(i)
         if (body%spring(i)%way /= 0) call line_to_lane(b, l, i, body%spring(i))
         call spring_to_lane(b, l, i, body%spring(i))
      end do
      do i = 1, 4
         x%inverse(l, i) = body%inverse(i)
      end do
   end subroutine follow_trial

   !> Where a spring is in a lane, at d, on the line that its record has.
   pure subroutine spring_from_lane(b, l, i, d, spring)
      type(lane_block), intent(in) :: b
      integer, intent(in) :: l, i
      real(wp), intent(in) :: d
      type(body_spring), intent(inout) :: spring

      spring%first = b%first(l, i)
      spring%last = b%last(l, i)
      spring%d = d
      spring%work = b%work(l, i)
   end subroutine spring_from_lane

   pure subroutine spring_to_lane(b, l, i, spring)
      type(lane_block), intent(inout) :: b
      integer, intent(in) :: l, i
      type(body_spring), intent(in) :: spring

      b%work(l, i) = spring%work
      b%first(l, i) = spring%first
      b%last(l, i) = spring%last
   end subroutine spring_to_lane

   pure subroutine line_to_lane(b, l, i, spring)
      type(lane_block), intent(inout) :: b
      integer, intent(in) :: l, i
      type(body_spring), intent(in) :: spring

      b%d0(l, i) = spring%line%d0
      b%f0(l, i) = spring%line%f0
      b%k(l, i) = spring%line%k
      b%way(l, i) = real(spring%line%unload_on_reversal, wp)
   end subroutine line_to_lane

   !> The lines of the springs of a run alone, on which the next steps start, and what these need of them.
   subroutine lines_to_body(x, b, l, state, stepper, body)
      type(lane_clock), intent(inout) :: x
      type(lane_block), intent(in) :: b
      integer, intent(in) :: l
      type(state_type), intent(in) :: state
      class(stepper_type), intent(inout) :: stepper
      type(one_body_step), intent(inout) :: body
      integer :: i

      select type (stepper)
      type is (implicit_stepper)
         call fit_one_body(body, stepper%step, stepper%wanted, state, x%h(l))
         x%inverse(l, :) = body%inverse
         x%per_h(l) = body%per_h
      class default
         call fit_resistance(x, b, l)
      end select
      do i = 1, 2
         body%spring(i)%line = state%springs%line_of(i)
      end do
   end subroutine lines_to_body

   !> Lines that springs have come to here become those of the run alone.
   subroutine lines_from_body(b, l, body, springs)
      type(lane_block), intent(in) :: b
      integer, intent(in) :: l
      type(one_body_step), intent(in) :: body
      type(spring_array), intent(inout) :: springs
      integer :: i

      do i = 1, 2
         call springs%put(i, body%spring(i)%line, b%q(l, i), b%work(l, i))
      end do
   end subroutine lines_from_body

   !> What a step of RK4 needs of the present lines.
   pure subroutine fit_resistance(x, b, l)
      type(lane_clock), intent(inout) :: x
      type(lane_block), intent(in) :: b
      integer, intent(in) :: l
      real(wp) :: g(4)
      integer :: i

      g = resistance_per_velocity(x%flexible(l), x%coupling(l), x%turning(l), x%softening(l), b%k(l, 1), &
                                  b%k(l, 2), 0.5_wp*x%h(l))
      do i = 1, 4
         x%g(l, i) = g(i)
      end do
   end subroutine fit_resistance

end module rbs_solve_ensemble_one_body_lane
