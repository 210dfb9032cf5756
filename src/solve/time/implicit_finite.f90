!> The implicit methods with exact rotations: Newton's method for the equation of the step
!> (`rbs_solve_time_finite_step`), a number of operations a step in proportion to n.
module rbs_solve_time_implicit_finite
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_solve_time_finite_step, only: finite_step
   use rbs_solve_time_newton, only: newton_stepper, move_springs
   use rbs_solve_time_state, only: state_type
   implicit none
   private

   public :: finite_stepper

   !> Largest rotation in one correction [rad].
   real(wp), parameter :: most_turn = 1.0_wp

   type, extends(newton_stepper) :: finite_stepper
      type(finite_step) :: step
      !> Correction of the bodies (3, n) and of the axial forces (n); these at the start of the step (n)
      real(wp), allocatable, private :: dx(:, :), dn(:), tension(:)
      !> Work of the springs up to the step (unknowns)
      real(wp), allocatable, private :: work(:)
   contains
      procedure :: prepare
      procedure :: take_step
      procedure :: correct
      procedure :: try
      procedure :: work_of_residual
      procedure :: is_round_off
      procedure :: serialize
   end type finite_stepper

contains

   subroutine prepare(self, state)
      class(finite_stepper), intent(inout) :: self
      type(state_type), intent(in) :: state

      self%most_iterations = 30
      self%searches_uphill = .false.
      call self%step%start(state)
      associate (n => self%step%column%n)
         allocate (self%dx(3, n), self%dn(n), self%tension(n), self%work(size(state%q)), source=0.0_wp)
      end associate
   end subroutine prepare

   !> In a step the work of the springs is counted from its start: as the small difference of large numbers
   !> it would have no digits.
   subroutine take_step(self, state, h, load, converged, busiest)
      class(finite_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state
      real(wp), intent(in) :: h, load(4)
      logical, intent(out) :: converged
      integer, intent(out) :: busiest
      real(wp) :: size_now
      logical :: marked

      marked = .false.
      self%work(:) = state%springs%work
      self%tension(:) = self%step%tension
      state%springs%work_before(:) = self%work
      state%springs%work = 0.0_wp
      call state%motion%press(state%springs, load)
      call self%step%place(state)
      call self%try(state, h, load, 0.0_wp, marked, size_now)
      call self%iterate(state, h, load, size_now, converged, marked)
      busiest = maxloc(abs(self%step%change)*self%step%column%initial_stiffness, dim=1)
      if (converged) then
         call state%springs%carry_to(self%step%q1)
         state%springs%work = state%springs%work + self%work
         call self%step%finish(state, h, load)
      else
         if (marked) call state%springs%restore()
         state%springs%work = self%work
         self%step%tension(:) = self%tension
      end if
      state%springs%work_before(:) = 0.0_wp
      if (marked) call state%springs%forget_mark()
   end subroutine take_step

   subroutine correct(self, state, h, found)
      class(finite_stepper), intent(inout) :: self
      type(state_type), intent(in) :: state
      real(wp), intent(in) :: h
      logical, intent(out) :: found

      found = .not. state%springs%stuck
      if (found) call self%step%find_correction(h, self%dx, self%dn, found)
      if (found) found = maxval(abs(self%dx(3, :))) < most_turn
   end subroutine correct

   real(wp) function work_of_residual(self) result(work)
      class(finite_stepper), intent(in) :: self

      work = sum(self%step%r*self%dx)
   end function work_of_residual

   !> Where the bodies turn, round-off is not told from the rest: the acceptable residual decides.
   logical function is_round_off(self, state, h)
      class(finite_stepper), intent(in) :: self
      type(state_type), intent(in) :: state
      real(wp), intent(in) :: h

      is_round_off = self%acceptable < 0.0_wp .and. state%lost .and. h < 0.0_wp
   end function is_round_off

   subroutine try(self, state, h, load, share, marked, size_now)
      class(finite_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state
      real(wp), intent(in) :: h, load(4), share
      logical, intent(inout) :: marked
      real(wp), intent(out) :: size_now
      logical :: inside

      size_now = huge(1.0_wp)
      self%step%moved = self%step%moved + share*self%dx
      self%step%tension = self%step%tension + share*self%dn
      call self%step%go(state)
      call move_springs(state, self%step%q1, marked, inside)
      if (inside) call self%step%find_residual(state, h, load, marked, size_now)
   end subroutine try

   !> Save or restore what the bodies do at the start of a step.
   subroutine serialize(self, stream)
      class(finite_stepper), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call self%step%serialize(stream)
   end subroutine serialize

end module rbs_solve_time_implicit_finite
