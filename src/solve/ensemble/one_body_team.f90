!> Lanes for columns of one body without damping.
module rbs_solve_ensemble_one_body_team
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
   use, intrinsic :: iso_c_binding, only: c_f_pointer, c_intptr_t, c_loc
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_segment, only: segment
   use rbs_hysteresis_springs, only: spring_array
   use rbs_solve_ensemble_lane_fields, only: one_body_lanes, lanes
   use rbs_solve_ensemble_motions, only: motion_table
   use rbs_solve_ensemble_outcome, only: outcome_type, measure_count, fate_completed, fate_collapsed, &
                                         at_peak_displacement, at_residual_displacement, &
                                         at_peak_base_shear, at_peak_rotation, at_input, at_spring, &
                                         at_damping, at_residual, at_relative_residual, at_first_yield, &
                                         at_end, at_time_step, at_steps, at_events, at_cut, at_lost_joint
   use rbs_solve_ensemble_subject, only: ensemble_column, ensemble_motion, lane_task
   use rbs_solve_ensemble_team, only: team_type, lane_type, begin_run, show_motion, show_seen, take_seen
   use rbs_solve_time_implicit, only: implicit_stepper, fit_one_body
   use rbs_loading_loads, only: horizontal
   use rbs_solve_time_march, only: report_state
   use rbs_solve_one_body_implicit_one_body, only: body_spring, side_of, move_spring, advance_on_branch
   use rbs_solve_one_body_rk4_one_body, only: rk4_body, resistance_per_velocity
   use rbs_solve_time_state, only: state_type
   implicit none
   private

   public :: one_body_team, new_one_body_team

   type, extends(team_type) :: one_body_team
      type(one_body_lanes), pointer :: x => null()
      !> Where they are
      real(wp), allocatable :: room(:)
   contains
      procedure :: enter
      procedure :: advance
      procedure :: go_on
      procedure :: finish
      procedure :: settle
      procedure :: leave
   end type one_body_team

contains

   !> Lanes without runs. They begin where a line of the cache does, as an access to several lanes that
   !> crosses the border of two lines takes twice the time.
   subroutine new_one_body_team(team)
      type(one_body_team), intent(inout), target :: team
      integer, parameter :: numbers = 8
      integer(c_intptr_t) :: address
      integer :: first

      allocate (team%room(storage_size(team%x)/storage_size(1.0_wp) + numbers))
      address = transfer(c_loc(team%room), address)/(storage_size(1.0_wp)/8)
      first = 1 + int(modulo(-address, int(numbers, c_intptr_t)))
      call c_f_pointer(c_loc(team%room(first)), team%x)
      team%x = one_body_lanes()
   end subroutine new_one_body_team

   subroutine enter(self, l, column, motion, first, task, error)
      class(one_body_team), intent(inout) :: self
      integer, intent(in) :: l
      type(ensemble_column), intent(in) :: column
      type(ensemble_motion), intent(in) :: motion
      integer, intent(in) :: first
      type(lane_task), intent(in) :: task
      type(error_type), allocatable, intent(out) :: error
      type(rk4_body) :: body

      call begin_run(self, self%x, l, column, motion, first, task, error)
      if (allocated(error)) return
      associate (x => self%x, one => column%column)
         call body%create(one)
         x%flexible(l) = body%flexible
         x%coupling(l) = body%coupling
         x%turning(l) = body%turning
         x%softening(l) = body%softening
         x%mass(l, 1) = one%mass(1)
         x%mass(l, 2) = one%inertia(1)
         x%lower(l) = one%lower(1)
         x%upper(l) = one%upper(1)
         x%length(l) = one%length(1)
         x%ground_arm(l, :) = one%ground_arm
         x%potential(l) = 0.0_wp
         if (one%axially_loaded) x%potential(l) = 0.5_wp*one%axial_body(1)*one%length(1)
         x%yield(l) = huge(1.0_wp)
         if (size(column%watch) > 0) x%yield(l) = column%watch(1)%threshold/abs(column%watch(1)%rotation)
         x%residual(l) = 0.0_wp
         x%most(l) = 0.0_wp
         call from_state(x, l, self%lane(l)%state)
      end associate
   end subroutine enter

   subroutine leave(self, l)
      class(one_body_team), intent(inout) :: self
      integer, intent(in) :: l

      self%x%active(l) = 0.0_wp
      self%x%ready(l) = 0.0_wp
   end subroutine leave

   subroutine advance(self, count, list)
      class(one_body_team), intent(inout) :: self
      integer, intent(out) :: count, list(lanes)

      if (self%implicit) then
         call self%kernel%implicit_lanes(self%x, self%method, count, list)
      else
         call self%kernel%rk4_lanes(self%x, count, list)
      end if
   end subroutine advance

   subroutine finish(self, table, count, list)
      class(one_body_team), intent(inout) :: self
      type(motion_table), intent(in) :: table
      integer, intent(out) :: count, list(lanes)

      call self%kernel%finish_step(self%x, size(table%time), table%time, table%acceleration, count, list)
   end subroutine finish

   subroutine go_on(self, l, error)
      class(one_body_team), intent(inout) :: self
      integer, intent(in) :: l
      type(error_type), allocatable, intent(out) :: error
      logical :: taken

      associate (x => self%x, lane => self%lane(l))
         taken = .false.
         if (x%tried(l) > 0.5_wp) then
            select type (stepper => lane%stepper)
            type is (implicit_stepper)
               call follow_trial(x, l, lane%state, stepper, taken)
            class default
               call follow_body(x, l, lane%state%springs, lane%state%springs%stuck)
               lane%state%time = x%t(l) + x%h(l)
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
      end associate
   end subroutine go_on

   !> The step of RK4 has ended, and only the springs have still to follow.
   subroutine follow_body(x, l, springs, stuck)
      type(one_body_lanes), intent(inout) :: x
      integer, intent(in) :: l
      type(spring_array), intent(inout) :: springs
      logical, intent(out) :: stuck
      type(body_spring) :: spring
      integer :: i, events

      stuck = .false.
      do i = 1, 2
         call take_spring(x, l, i, x%from(l, i), spring)
         if (side_of(spring, x%q(l, i)) == 0) then
            call advance_on_branch(spring, x%q(l, i))
         else
            ! The first spring may decay with what the second has done up to the start of the step.
            call move_spring(spring, springs, i, x%q(l, i), x%work(l, 2), events, stuck)
            if (stuck) return
            x%events(l) = x%events(l) + events
            call put_line(x, l, i, spring%line)
         end if
         call give_spring(x, l, i, spring)
      end do
      call fit_resistance(x, l)
   end subroutine follow_body

   !> Follow the trial of an implicit step along the lines of the springs.
   subroutine follow_trial(x, l, lane, stepper, taken)
      type(one_body_lanes), intent(inout) :: x
      integer, intent(in) :: l
      type(state_type), intent(inout) :: lane
      type(implicit_stepper), intent(inout) :: stepper
      logical, intent(out) :: taken
      integer :: i

      associate (bent => stepper%one_body)
         bent%ground = x%trial(l, 4)
         bent%work = x%trial(l, 3)
         do i = 1, 2
            bent%moved(i) = x%trial(l, i)
            bent%q0(i) = x%q(l, i)
            bent%v0(i) = x%v0(l, i)
            bent%a0(i) = x%a0(l, i)
            bent%g0(i) = x%g0(l, i)
            bent%largest(i) = x%largest(l, i)
            call take_spring(x, l, i, x%q(l, i), bent%spring(i))
         end do
         call bent%solve(lane%springs, taken)
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
            if (bent%spring(i)%way /= 0) call put_line(x, l, i, bent%spring(i)%line)
            call give_spring(x, l, i, bent%spring(i))
         end do
         do i = 1, 4
            x%inverse(l, i) = bent%inverse(i)
         end do
      end associate
   end subroutine follow_trial

   !> A spring of a lane, at d.
   pure subroutine take_spring(x, l, i, d, spring)
      type(one_body_lanes), intent(in) :: x
      integer, intent(in) :: l, i
      real(wp), intent(in) :: d
      type(body_spring), intent(inout) :: spring

      spring%line = line_of(x, l, i)
      spring%first = x%first(l, i)
      spring%last = x%last(l, i)
      spring%d = d
      spring%work = x%work(l, i)
   end subroutine take_spring

   !> What a spring leaves in its lane, on the line that is there.
   pure subroutine give_spring(x, l, i, spring)
      type(one_body_lanes), intent(inout) :: x
      integer, intent(in) :: l, i
      type(body_spring), intent(in) :: spring

      x%work(l, i) = spring%work
      x%first(l, i) = spring%first
      x%last(l, i) = spring%last
   end subroutine give_spring

   !> The line of a spring, in the form that its rule takes.
   pure type(segment) function line_of(x, l, i) result(line)
      type(one_body_lanes), intent(in) :: x
      integer, intent(in) :: l, i

      line%d0 = x%d0(l, i)
      line%f0 = x%f0(l, i)
      line%k = x%k(l, i)
      line%lo = x%lo(l, i)
      line%hi = x%hi(l, i)
      line%includes_lower_end = x%lo_closed(l, i)
      line%includes_upper_end = x%hi_closed(l, i)
      line%unload_on_reversal = int(x%way(l, i))
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
      x%lo_closed(l, i) = line%includes_lower_end
      x%hi_closed(l, i) = line%includes_upper_end
      x%way(l, i) = real(line%unload_on_reversal, wp)
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
      call show_seen(x, l, state%sight)
      state%sight%reached(1) = x%first_yield(l)
      state%sight%watching = state%sight%watching .and. .not. x%first_yield(l) < huge(1.0_wp)
      state%sight%q(:) = state%q
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
      end do
      x%ground(l) = state%load(horizontal)
      x%of_loads(l) = state%of_loads
      call take_seen(x, l, state%sight)
      x%first_yield(l) = state%sight%reached(1)
      x%turned(l) = state%sight%q(2)
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
      call fit_resistance(x, l)
   end subroutine from_springs

   !> What a step of RK4 needs of the present lines.
   pure subroutine fit_resistance(x, l)
      type(one_body_lanes), intent(inout) :: x
      integer, intent(in) :: l
      real(wp) :: g(4)
      integer :: i

      g = resistance_per_velocity(x%flexible(l), x%coupling(l), x%turning(l), x%softening(l), x%k(l, 1), &
                                  x%k(l, 2), 0.5_wp*x%h(l))
      do i = 1, 4
         x%g(l, i) = g(i)
      end do
   end subroutine fit_resistance

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

      call fit_one_body(stepper, state, x%h(l))
      do i = 1, 2
         x%v0(l, i) = stepper%step%v0(i)
         x%a0(l, i) = stepper%step%a0(i)
         x%g0(l, i) = stepper%step%g0(i)
         x%largest(l, i) = stepper%step%largest(i)
      end do
      do i = 1, 4
         x%inverse(l, i) = stepper%one_body%inverse(i)
      end do
      x%per_h(l) = stepper%one_body%per_h
      stepper%one_body%wanted = stepper%wanted
      stepper%one_body%push = 0.0_wp
   end subroutine from_balance

   subroutine settle(self, l, task, outcome)
      class(one_body_team), intent(in) :: self
      integer, intent(in) :: l
      type(lane_task), intent(in) :: task
      type(outcome_type), intent(inout) :: outcome
      real(wp) :: value(measure_count)

      associate (x => self%x, lane => self%lane(l))
         outcome%fate = merge(fate_collapsed, fate_completed, abs(x%peak(l)) >= x%furthest(l))
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
      end associate
      outcome%value = value
   end subroutine settle

end module rbs_solve_ensemble_one_body_team
