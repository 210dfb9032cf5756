!> The embedded pair of order 5(4) of Dormand and Prince (1980), with the estimate of its error.
module rbs_solve_time_pair45
   use rbs_base_kinds, only: wp
   use rbs_solve_time_scheme, only: scheme_type
   use rbs_solve_time_state, only: state_type
   use rbs_structure_structure, only: structure_type, signals
   implicit none
   private

   public :: pair45_scheme

   integer, parameter :: stages = 7

   !> Times of the stages in shares of the step, and their coefficients row by row (J. R. Dormand, P. J.
   !> Prince, A family of embedded Runge-Kutta formulae, J. Comput. Appl. Math. 6 (1980), RK5(4)7M).
   real(wp), parameter :: time_share(stages) = [0.0_wp, 0.2_wp, 0.3_wp, 0.8_wp, 8.0_wp/9.0_wp, 1.0_wp, 1.0_wp]
   real(wp), parameter :: row(stages - 1, stages) = reshape([ &
      [0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp], &
      [0.2_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp], &
      [3.0_wp/40.0_wp, 9.0_wp/40.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp], &
      [44.0_wp/45.0_wp, -56.0_wp/15.0_wp, 32.0_wp/9.0_wp, 0.0_wp, 0.0_wp, 0.0_wp], &
      [19372.0_wp/6561.0_wp, -25360.0_wp/2187.0_wp, 64448.0_wp/6561.0_wp, -212.0_wp/729.0_wp, &
       0.0_wp, 0.0_wp], &
      [9017.0_wp/3168.0_wp, -355.0_wp/33.0_wp, 46732.0_wp/5247.0_wp, 49.0_wp/176.0_wp, &
       -5103.0_wp/18656.0_wp, 0.0_wp], &
      [35.0_wp/384.0_wp, 0.0_wp, 500.0_wp/1113.0_wp, 125.0_wp/192.0_wp, -2187.0_wp/6784.0_wp, &
       11.0_wp/84.0_wp]], [stages - 1, stages])

   !> Weights of order 5 minus those of order 4.
   real(wp), parameter :: difference(stages) = [ &
      71.0_wp/57600.0_wp, 0.0_wp, -71.0_wp/16695.0_wp, 71.0_wp/1920.0_wp, -17253.0_wp/339200.0_wp, &
      22.0_wp/525.0_wp, -1.0_wp/40.0_wp]

   type, extends(scheme_type) :: pair45_scheme
      !> Velocities and accelerations of the stages (springs, stages)
      real(wp), allocatable, private :: rate_q(:, :), rate_v(:, :)
      !> Power of loads and damping at the start of the step [W]
      real(wp), private :: load_power = 0.0_wp, damping_power = 0.0_wp
   contains
      procedure :: create, attempt
   end type pair45_scheme

contains

   !> Make room for a structure.
   subroutine create(self, structure)
      class(pair45_scheme), intent(out) :: self
      class(structure_type), intent(in) :: structure
      integer :: m

      m = size(structure%location)
      self%order = 5
      allocate (self%q(m), self%v(m), self%error_q(m), self%error_v(m))
      allocate (self%rate_q(m, stages), self%rate_v(m, stages))
      call self%now%create(structure)
   end subroutine create

   !> A step of h from the state. The last stage is at the end of the step; works of loads and damping
   !> are integrated with the weights of order 5.
   subroutine attempt(self, state, h)
      class(pair45_scheme), intent(inout) :: self
      type(state_type), intent(inout) :: state
      !> Step [s]
      real(wp), intent(in) :: h
      real(wp) :: load(signals), of_loads, of_damping
      integer :: stage

      ! The first stage is the last one of the step before, unless that was not taken or something has
      ! changed.
      if (.not. self%begun) then
         call reach_stage(self, state, 1, h, state%load)
         call find_powers(self, state, state%load, self%load_power, self%damping_power)
      end if
      self%of_loads = h*row(1, stages)*self%load_power
      self%of_damping = h*row(1, stages)*self%damping_power
      do stage = 2, stages - 1
         call state%loads%at_time(state%time + time_share(stage)*h, load)
         call reach_stage(self, state, stage, h, load)
         call find_powers(self, state, load, of_loads, of_damping)
         self%of_loads = self%of_loads + h*row(stage, stages)*of_loads
         self%of_damping = self%of_damping + h*row(stage, stages)*of_damping
      end do
      ! The last two stages are at the same time.
      call reach_stage(self, state, stages, h, load)
      self%begun = .true.
      self%load = load
      self%error_q = h*matmul(self%rate_q, difference)
      self%error_v = h*matmul(self%rate_v, difference)
   end subroutine attempt

   !> Powers of loads and damping at the stage that was reached last [W].
   subroutine find_powers(self, state, load, of_loads, of_damping)
      class(pair45_scheme), intent(in) :: self
      type(state_type), intent(in) :: state
      !> Loads at the time of the stage
      real(wp), intent(in) :: load(signals)
      real(wp), intent(out) :: of_loads, of_damping

      of_loads = self%now%power
      if (.not. self%now%has_power) of_loads = state%motion%structure%power_of_loads(self%q, self%v, load)
      of_damping = 0.0_wp
      if (state%motion%damped) of_damping = state%motion%damping_power(state%springs, self%q, self%v)
   end subroutine find_powers

   !> Find deformations, velocities and accelerations of a stage from the rates of the stages before it.
   subroutine reach_stage(self, state, stage, h, load)
      class(pair45_scheme), intent(inout) :: self
      type(state_type), intent(inout) :: state
      !> From 1, the start of the step, to 7, its end
      integer, intent(in) :: stage
      !> Step [s], and loads at the time of the stage
      real(wp), intent(in) :: h, load(signals)

      call add_rates(size(self%q), stage - 1, h*row(:, stage), state%q, self%rate_q, self%q)
      call add_rates(size(self%v), stage - 1, h*row(:, stage), state%v, self%rate_v, self%v)
      self%rate_q(:, stage) = self%v
      call state%motion%acceleration(state%springs, self%q, self%v, load, self%now)
      self%rate_v(:, stage) = self%now%a
   end subroutine reach_stage

   !> Go from x0 at the rates of the first n stages.
   pure subroutine add_rates(m, n, share, x0, rate, x)
      !> Numbers of values, and of stages
      integer, intent(in) :: m, n
      !> Coefficients of the stages times the step [s]; start, and rates of the stages
      real(wp), intent(in) :: share(stages - 1), x0(m), rate(m, stages)
      real(wp), intent(out) :: x(m)
      real(wp) :: sum
      integer :: i, j

      do i = 1, m
         sum = x0(i)
         do j = 1, n
            sum = sum + share(j)*rate(i, j)
         end do
         x(i) = sum
      end do
   end subroutine add_rates

end module rbs_solve_time_pair45
