!> Lanes for chains, and for columns of one body with damping.
module rbs_solve_ensemble_chain_team
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_column_column, only: column_type
   use rbs_output_channels, only: energy_type
   use rbs_output_summary, only: summary_type
   use rbs_solve_ensemble_chain_lane, only: fit_block, enter_column, enter_springs, enter_tangent, &
                                            enter_state, enter_bounds, take_springs, take_state, take_tangent
   use rbs_solve_ensemble_lane_fields, only: lane_clock, chain_block, lanes, few
   use rbs_solve_ensemble_motions, only: motion_table
   use rbs_solve_ensemble_outcome, only: outcome_type
   use rbs_solve_ensemble_subject, only: ensemble_column, ensemble_motion, lane_task
   use rbs_solve_ensemble_tally, only: settle_tally => settle
   use rbs_solve_ensemble_team, only: team_type, begin_run, show_motion, show_seen, take_seen
   use rbs_solve_time_implicit, only: implicit_stepper
   use rbs_loading_loads, only: horizontal
   use rbs_solve_time_march, only: report_state, balance
   implicit none
   private

   public :: chain_team, new_chain_team

   !> The balance of energy of a run.
   type :: lane_rows
      type(summary_type) :: summary
      type(energy_type) :: energy
   end type lane_rows

   type, extends(team_type) :: chain_team
      type(lane_clock) :: x
      type(chain_block) :: block(lanes/few)
      type(lane_rows) :: rows(lanes)
   contains
      procedure :: enter
      procedure :: advance
      procedure :: go_on
      procedure :: finish
      procedure :: settle
      procedure :: leave
   end type chain_team

contains

   !> Lanes for columns of the size and the kind of damping of one.
   subroutine new_chain_team(team, column)
      type(chain_team), intent(inout) :: team
      type(column_type), intent(in) :: column
      integer :: j

      do j = 1, size(team%block)
         call fit_block(team%block(j), column%n, column%damped, allocated(column%modal_damping))
      end do
   end subroutine new_chain_team

   subroutine enter(self, l, column, motion, first, task, error)
      class(chain_team), intent(inout) :: self
      integer, intent(in) :: l
      type(ensemble_column), intent(in) :: column
      type(ensemble_motion), intent(in) :: motion
      integer, intent(in) :: first
      type(lane_task), intent(in) :: task
      type(error_type), allocatable, intent(out) :: error
      type(summary_type) :: fresh
      integer :: j, i

      call begin_run(self, self%x, l, column, motion, first, task, error)
      if (allocated(error)) return
      j = (l - 1)/few + 1
      i = l - (j - 1)*few
      self%rows(l)%summary = fresh
      call balance(self%lane(l)%state, self%rows(l)%energy, self%rows(l)%summary)
      call enter_column(self%block(j), i, self%lane(l)%state%motion)
      call enter_state(self%block(j), i, self%lane(l)%state)
      call enter_springs(self%block(j), i, self%lane(l)%state)
      call enter_bounds(self%block(j), i, self%lane(l)%state)
   end subroutine enter

   subroutine leave(self, l)
      class(chain_team), intent(inout) :: self
      integer, intent(in) :: l

      self%x%active(l) = 0.0_wp
      self%x%ready(l) = 0.0_wp
   end subroutine leave

   subroutine advance(self, count, list)
      class(chain_team), intent(inout) :: self
      integer, intent(out) :: count, list(lanes)
      logical :: inside(few)
      integer :: j, i, base

      count = 0
      do j = 1, size(self%block)
         base = (j - 1)*few
         if (.not. any(self%x%active(base + 1:base + few) > 0.5_wp)) cycle
         if (self%implicit) then
            call self%kernel%implicit_chain(self%x, self%block(j), base, self%method, inside)
         else
            call self%kernel%rk4_chain(self%x, self%block(j), base, inside)
         end if
         do i = 1, few
            if (inside(i) .or. self%x%active(base + i) < 0.5_wp) cycle
            count = count + 1
            list(count) = base + i
         end do
      end do
   end subroutine advance

   subroutine go_on(self, l, error)
      class(chain_team), intent(inout) :: self
      integer, intent(in) :: l
      type(error_type), allocatable, intent(out) :: error
      integer :: j, i

      j = (l - 1)/few + 1
      i = l - (j - 1)*few
      associate (b => self%block(j), lane => self%lane(l), state => self%lane(l)%state)
         self%x%ready(l) = 1.0_wp
         if (self%x%tried(l) > 0.5_wp) then
            ! The step of RK4 has ended, and only the springs have still to follow.
            call take_springs(b, i, state, b%from)
            call take_state(b, i, state)
            state%time = self%x%t(l) + self%x%h(l)
            call state%springs%move_all(state%q)
         else
            call take_springs(b, i, state, b%q)
            call take_state(b, i, state)
            call show_motion(self%x, l, state%loads%ground)
            state%time = self%x%t(l)
            state%clock = self%x%t(l)
            state%load(horizontal) = self%x%ground(l)
            state%of_loads = self%x%of_loads(l)
            select type (stepper => lane%stepper)
            type is (implicit_stepper)
               call take_tangent(b, i, stepper)
            end select
            call show_seen(self%x, l, state%sight)
            state%sight%q(:) = state%q
            call lane%stepper%advance(state, self%x%h(l), error)
            if (allocated(error)) return
            call take_seen(self%x, l, state%sight)
            call enter_bounds(b, i, state)
            self%x%ground(l) = state%load(horizontal)
            self%x%of_loads(l) = state%of_loads
            if (.not. (state%lost .or. state%springs%stuck)) then
               call enter_state(b, i, state)
               select type (stepper => lane%stepper)
               type is (implicit_stepper)
                  call enter_tangent(b, i, state, self%x%h(l), stepper, self%x%ready(l))
               end select
            end if
         end if
         if (state%lost .or. state%springs%stuck) then
            call report_state(state, error)
            return
         end if
         call enter_springs(b, i, state)
      end associate
   end subroutine go_on

   subroutine finish(self, table, count, list)
      class(chain_team), intent(inout) :: self
      type(motion_table), intent(in) :: table
      integer, intent(out) :: count, list(lanes)
      real(wp) :: row(lanes)
      logical :: any_row
      integer :: l, j, i

      do j = 1, size(self%block)
         associate (b => self%block(j), first => (j - 1)*few + 1, last => j*few)
            call self%kernel%measure_chain(b)
            self%x%displacement(first:last) = b%top
            self%x%rotation(first:last) = max(self%x%rotation(first:last), b%turn)
            where (abs(b%base) > abs(self%x%base(first:last))) self%x%base(first:last) = b%base
         end associate
      end do
      call self%kernel%turn_clock(self%x, size(table%time), table%time, table%acceleration, row, any_row, &
                                  count, list)
      call look_closely(self)
      if (.not. any_row) return
      do l = 1, lanes
         if (.not. (row(l) > 0.5_wp .and. self%x%active(l) > 0.5_wp)) cycle
         j = (l - 1)/few + 1
         i = l - (j - 1)*few
         associate (state => self%lane(l)%state)
            call take_springs(self%block(j), i, state, self%block(j)%q)
            call take_state(self%block(j), i, state)
            state%of_loads = self%x%of_loads(l)
            call balance(state, self%rows(l)%energy, self%rows(l)%summary)
         end associate
      end do
   end subroutine finish

   !> Lanes in which a limit state may have been reached.
   subroutine look_closely(self)
      class(chain_team), intent(inout) :: self
      integer :: j, i, l

      do j = 1, size(self%block)
         associate (b => self%block(j))
            if (.not. any(b%beyond > 0.5_wp)) cycle
            do i = 1, few
               l = (j - 1)*few + i
               if (.not. (b%beyond(i) > 0.5_wp .and. self%x%active(l) > 0.5_wp)) cycle
               associate (state => self%lane(l)%state)
                  state%sight%q(:) = b%from(i, :)
                  state%sight%clock = self%x%seen(l)
                  state%q(:) = b%q(i, :)
                  call state%sight%look(state%springs, state%q, self%x%displacement(l), self%x%t(l))
                  call enter_bounds(b, i, state)
               end associate
            end do
         end associate
      end do
   end subroutine look_closely

   subroutine settle(self, l, task, outcome)
      class(chain_team), intent(in) :: self
      integer, intent(in) :: l
      type(lane_task), intent(in) :: task
      type(outcome_type), intent(inout) :: outcome
      type(summary_type) :: summary
      type(error_type), allocatable :: none

      summary = self%rows(l)%summary
      summary%last_displacement = self%x%displacement(l)
      summary%last_time = self%x%t(l)
      summary%time_step = task%plan%dt
      summary%peak_displacement = self%x%peak(l)
      summary%peak_base_shear = self%x%base(l)
      summary%peak_rotation = self%x%rotation(l)
      summary%collapsed = abs(self%x%peak(l)) >= self%x%furthest(l)
      summary%events = self%lane(l)%state%springs%events
      summary%steps = nint(self%x%steps(l)) + self%lane(l)%stepper%steps
      summary%cut_steps = self%lane(l)%stepper%cut_steps
      call settle_tally(self%lane(l)%state%sight%reached, summary, none, outcome)
   end subroutine settle

end module rbs_solve_ensemble_chain_team
