!> The classical Runge-Kutta scheme with fixed steps (the paper's choice).
module rbs_solve_time_rk4
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_loading_loads, only: lateral, horizontal, signals
   use rbs_solve_one_body_body_damping, only: column_of_one_body
   use rbs_solve_one_body_rk4_one_body, only: rk4_body
   use rbs_structure_column_column, only: column_type
   use rbs_solve_time_scheme, only: scheme_type
   use rbs_solve_time_state, only: state_type, stepper_type, in_bounds, out_of_bounds
   use rbs_structure_structure, only: structure_type
   implicit none
   private

   public :: rk4_stepper, rk4_scheme

   !> Stages: weight, way to the next one, and the times of their loads (start, middle, end of the step).
   real(wp), parameter :: weight(4) = [1.0_wp, 2.0_wp, 2.0_wp, 1.0_wp]/6.0_wp
   real(wp), parameter :: reach(4) = [0.5_wp, 0.5_wp, 1.0_wp, 0.0_wp]
   integer, parameter :: at(4) = [1, 2, 2, 3]

   type, extends(scheme_type) :: rk4_scheme
      !> Stage (springs)
      real(wp), allocatable, private :: stage_q(:), stage_v(:)
      !> The column, if it has one body
      type(rk4_body) :: body
   contains
      procedure :: create, attempt
   end type rk4_scheme

   !> Springs change their lines at the end of a step.
   type, extends(stepper_type) :: rk4_stepper
      type(rk4_scheme) :: scheme
   contains
      procedure :: advance
   end type rk4_stepper

contains

   !> Make room for a structure.
   subroutine create(self, structure)
      class(rk4_scheme), intent(out) :: self
      class(structure_type), intent(in) :: structure
      type(column_type), pointer :: column
      integer :: m

      self%order = 4
      m = size(structure%location)
      allocate (self%q(m), self%v(m), self%stage_q(m), self%stage_v(m))
      call self%now%create(structure)
      column => column_of_one_body(structure)
      if (associated(column)) call self%body%create(column)
   end subroutine create

   !> A step of h from the state, which stays as it is. Works of loads and damping are integrated with the
   !> weights of the scheme.
   subroutine attempt(self, state, h)
      class(rk4_scheme), intent(inout) :: self
      type(state_type), intent(inout) :: state
      !> Step [s]
      real(wp), intent(in) :: h
      !> Loads at start, middle and end of the step
      real(wp) :: load(signals, 3), push(3), ground(3)

      load(:, 1) = state%load
      call state%loads%at_time(state%time + 0.5_wp*h, load(:, 2))
      call state%loads%at_time(state%time + h, load(:, 3))
      self%load = load(:, 3)
      if (associated(state%motion%one_body)) then
         push = load(lateral, :)
         ground = load(horizontal, :)
         self%q(:) = state%q
         self%v(:) = state%v
         call self%body%take_step(state%springs, state%motion%damping, h, push, ground, self%q, self%v, &
                                  self%of_loads, self%of_damping)
      else
         call step_of_chain(self, state, h, load)
      end if
   end subroutine attempt

   !> Find the step for any number of bodies: deformations, velocities and works at its end.
   subroutine step_of_chain(self, state, h, load)
      class(rk4_scheme), intent(inout) :: self
      type(state_type), intent(inout) :: state
      !> Step [s]
      real(wp), intent(in) :: h
      !> Loads at start, middle and end of the step
      real(wp), intent(in) :: load(signals, 3)
      !> Velocity of the top, and momentum with its sign turned, at the start and at the stage: times lateral
      !> force and acceleration of the ground they are power
      real(wp) :: start(2), speed(2)
      integer :: stage, i, m

      m = size(state%q)
      self%of_loads = 0.0_wp
      self%of_damping = 0.0_wp
      associate (motion => state%motion, result => self%now)
         start = 0.0_wp
         do i = lateral, horizontal
            if (motion%plain .and. motion%acts(i)) start(i) = motion%structure%speed(i, state%q, state%v)
         end do
         speed = start
         call begin_step(m, state%q, state%v, self%stage_q, self%stage_v, self%q, self%v)
         do stage = 1, 4
            associate (now => load(:, at(stage)))
               call motion%acceleration(state%springs, self%stage_q, self%stage_v, now, result)
               if (motion%plain) then
                  self%of_loads = self%of_loads + h*weight(stage)*(speed(lateral)*now(lateral) &
                                                                   + speed(horizontal)*now(horizontal))
                  ! Velocity of the top and momentum are linear in v: they step as it does.
                  speed = start + h*reach(stage)*result%of_speeds
               else
                  if (.not. result%has_power) then
                     result%power = motion%structure%power_of_loads(self%stage_q, self%stage_v, now)
                  end if
                  self%of_loads = self%of_loads + h*weight(stage)*result%power
                  if (motion%damped) self%of_damping = self%of_damping + h*weight(stage) &
                                                       *motion%damping_power(state%springs, self%stage_q, &
                                                                             self%stage_v)
               end if
            end associate
            if (stage < 4) then
               call next_stage(m, h*weight(stage), h*reach(stage), state%q, state%v, result%a, self%stage_q, &
                               self%stage_v, self%q, self%v)
            else
               call end_step(m, h*weight(stage), result%a, self%stage_v, self%q, self%v)
            end if
         end do
      end associate
   end subroutine step_of_chain

   !> The first stage is the start of the step, and the result begins there.
   pure subroutine begin_step(m, q0, v0, stage_q, stage_v, q, v)
      integer, intent(in) :: m
      real(wp), intent(in) :: q0(m), v0(m)
      real(wp), intent(out) :: stage_q(m), stage_v(m), q(m), v(m)

      stage_q = q0
      stage_v = v0
      q = q0
      v = v0
   end subroutine begin_step

   !> Add a stage to the result, and find the next stage.
   pure subroutine next_stage(m, share, reach, q0, v0, a, stage_q, stage_v, q, v)
      integer, intent(in) :: m
      !> Weight and place of the stage times the step [s]
      real(wp), intent(in) :: share, reach
      !> Deformations and velocities at the start of the step; accelerations of the stage
      real(wp), intent(in) :: q0(m), v0(m), a(m)
      !> The stage, which becomes the next one; the result so far
      real(wp), intent(inout) :: stage_q(m), stage_v(m), q(m), v(m)
      integer :: i

      do i = 1, m
         q(i) = q(i) + share*stage_v(i)
         v(i) = v(i) + share*a(i)
         stage_q(i) = q0(i) + reach*stage_v(i)
         stage_v(i) = v0(i) + reach*a(i)
      end do
   end subroutine next_stage

   !> Add the last stage to the result.
   pure subroutine end_step(m, share, a, stage_v, q, v)
      integer, intent(in) :: m
      !> Weight of the stage times the step [s]; its accelerations and velocities
      real(wp), intent(in) :: share, a(m), stage_v(m)
      !> The result
      real(wp), intent(inout) :: q(m), v(m)

      q = q + share*stage_v
      v = v + share*a
   end subroutine end_step

   !> One step of a column of one body, and its springs at the end: loops and calls as for any number of
   !> bodies would take nearly all of the time.
   subroutine advance_one_body(body, state, h)
      type(rk4_body), intent(inout) :: body
      type(state_type), intent(inout) :: state
      !> Step [s]
      real(wp), intent(in) :: h
      !> Lateral force and acceleration of the ground at start, middle and end of the step
      real(wp) :: force(3), ground(3), of_loads, of_damping

      force = 0.0_wp
      ground = 0.0_wp
      if (state%motion%acts(lateral)) then
         force(1) = state%load(lateral)
         force(2) = state%loads%signal(lateral)%at_time(state%time + 0.5_wp*h)
         force(3) = state%loads%signal(lateral)%at_time(state%time + h)
      end if
      if (state%motion%acts(horizontal)) then
         ground(1) = state%load(horizontal)
         ground(2) = state%loads%signal(horizontal)%at_time(state%time + 0.5_wp*h)
         ground(3) = state%loads%signal(horizontal)%at_time(state%time + h)
      end if
      call body%take_step(state%springs, state%motion%damping, h, force, ground, state%q, state%v, of_loads, &
                          of_damping)
      state%time = state%time + h
      state%load(lateral) = force(3)
      state%load(horizontal) = ground(3)
      state%of_loads = state%of_loads + of_loads
      state%of_damping = state%of_damping + of_damping
      state%diverged = .not. (abs(state%q(1)) < out_of_bounds .and. abs(state%q(2)) < out_of_bounds)
      if (.not. state%diverged) call state%springs%move_all(state%q)
   end subroutine advance_one_body

   !> One step; the springs follow at its end, along as many lines as they have passed.
   subroutine advance(self, state, h, error)
      class(rk4_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state
      !> Step [s]
      real(wp), intent(in) :: h
      !> Not set here: a state out of bounds is marked as diverged
      type(error_type), allocatable, intent(inout) :: error

      if (allocated(error)) return
      self%steps = self%steps + 1
      if (associated(state%motion%one_body)) then
         call advance_one_body(self%scheme%body, state, h)
         return
      end if
      call self%scheme%attempt(state, h)
      call self%scheme%accept(state, h)
      if (state%springs%stay_on_lines(state%q)) then
         call state%springs%carry_to(state%q)
      else
         state%diverged = .not. in_bounds(size(state%q), state%q)
         if (.not. state%diverged) call state%springs%move_all(state%q)
      end if
   end subroutine advance

end module rbs_solve_time_rk4
