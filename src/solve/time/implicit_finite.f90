!> The implicit methods with exact rotations: Newton's method for the equation of the step
!> (`rbs_solve_time_finite_step`), a number of operations a step in proportion to n.
module rbs_solve_time_implicit_finite
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_solve_time_finite_step, only: finite_step
   use rbs_solve_time_halving, only: halving_stepper
   use rbs_solve_time_state, only: state_type, in_bounds, out_of_bounds
   implicit none
   private

   public :: finite_stepper

   !> Most iterations of Newton's method, which mostly needs three, and the number of them in which it may
   !> overshoot.
   integer, parameter :: most_iterations = 30, most_free = 8

   !> Largest rotation in one correction [rad].
   real(wp), parameter :: most_turn = 1.0_wp

   !> The residual has vanished below this share of the forces; where round-off does not let it, below the
   !> second.
   real(wp), parameter :: wanted = 1.0e-12_wp, acceptable = 1.0e-7_wp

   type, extends(halving_stepper) :: finite_stepper
      type(finite_step) :: step
      !> Correction of the bodies (3, n) and of the axial forces (n); these at the start of the step (n)
      real(wp), allocatable, private :: dx(:, :), dn(:), tension(:)
      !> Work of the springs up to the step (unknowns)
      real(wp), allocatable, private :: work(:)
   contains
      procedure :: prepare
      procedure :: take_step
      procedure :: serialize
   end type finite_stepper

contains

   subroutine prepare(self, state)
      class(finite_stepper), intent(inout) :: self
      type(state_type), intent(in) :: state

      call self%step%start(state)
      associate (n => state%motion%column%n)
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
      logical :: marked

      marked = .false.
      self%work(:) = state%springs%work
      self%tension(:) = self%step%tension
      state%springs%work_before(:) = self%work
      state%springs%work = 0.0_wp
      call state%motion%press(state%springs, load)
      call iterate(self, state, h, load, converged, marked)
      busiest = maxloc(abs(self%step%change)*state%motion%column%initial_stiffness, dim=1)
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

   !> Newton's method with a line search. Every trial goes from the start of the step, each spring in one
   !> direction, so that earlier trials leave no trace.
   subroutine iterate(self, state, h, load, converged, marked)
      type(finite_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state
      real(wp), intent(in) :: h, load(4)
      logical, intent(out) :: converged
      !> Whether springs have changed their lines, and a mark was set
      logical, intent(inout) :: marked
      real(wp) :: size_now, size_before, slope_before, slope, too_far
      integer :: iteration, most
      logical :: regular

      converged = .false.
      most = most_iterations
      ! Modal damping is not in the tangent.
      if (allocated(state%motion%modal)) most = 10*most
      call self%step%place(state)
      call try(self, state, h, load, 0.0_wp, marked, size_now)
      do iteration = 1, most
         size_before = size_now
         call self%step%find_correction(state, h, self%dx, self%dn, regular)
         if (.not. regular) return
         if (.not. maxval(abs(self%dx(3, :))) < most_turn) return
         slope_before = sum(self%step%r*self%dx)
         call try(self, state, h, load, 1.0_wp, marked, size_now)
         if (.not. size_now < out_of_bounds .or. state%springs%stuck) return
         converged = size_now <= wanted .or. (size_now <= acceptable .and. size_now > 0.5_wp*size_before)
         if (converged) return
         slope = sum(self%step%r*self%dx)
         ! An overshoot mostly does no harm. Where Newton's method goes back and forth, it is bounded.
         too_far = merge(0.9_wp, 0.05_wp, iteration <= most_free)
         if (slope < -too_far*abs(slope_before)) then
            call search_line(self, state, h, load, slope_before, slope, too_far/3.0_wp, marked, size_now)
            if (.not. size_now < out_of_bounds .or. state%springs%stuck) return
         end if
      end do
   end subroutine iterate

   !> The trial has gone too far: find the share of the correction at which the residual does little work
   !> on it, by the method of false position (Illinois).
   subroutine search_line(self, state, h, load, slope_before, slope_at_end, share_left, marked, size_now)
      type(finite_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state
      real(wp), intent(in) :: h, load(4)
      !> Work of the residual on the correction at its start and at its end
      real(wp), intent(in) :: slope_before, slope_at_end
      !> Share of the first that may be left
      real(wp), intent(in) :: share_left
      logical, intent(inout) :: marked
      real(wp), intent(inout) :: size_now
      real(wp) :: low, high, at_low, at_high, share, slope, now
      integer :: trial

      if (.not. slope_before > 0.0_wp) return
      low = 0.0_wp
      high = 1.0_wp
      at_low = slope_before
      at_high = slope_at_end
      now = 1.0_wp
      do trial = 1, 8
         share = low + (high - low)*at_low/(at_low - at_high)
         call try(self, state, h, load, share - now, marked, size_now)
         now = share
         if (.not. size_now < out_of_bounds .or. state%springs%stuck) return
         slope = sum(self%step%r*self%dx)
         if (abs(slope) <= share_left*slope_before) return
         if (slope > 0.0_wp) then
            low = share
            at_low = slope
            at_high = 0.5_wp*at_high
         else
            high = share
            at_high = slope
            at_low = 0.5_wp*at_low
         end if
      end do
   end subroutine search_line

   !> Go on (or back) by a share of the correction, and find the residual there.
   subroutine try(self, state, h, load, share, marked, size_now)
      type(finite_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state
      real(wp), intent(in) :: h, load(4), share
      logical, intent(inout) :: marked
      real(wp), intent(out) :: size_now

      size_now = huge(1.0_wp)
      self%step%moved = self%step%moved + share*self%dx
      self%step%tension = self%step%tension + share*self%dn
      call self%step%go(state)
      if (.not. in_bounds(size(self%step%q1), self%step%q1)) return
      if (marked .or. .not. state%springs%stay_on_lines(self%step%q1)) then
         if (marked) then
            call state%springs%restore()
         else
            call state%springs%mark()
            marked = .true.
         end if
         call state%springs%move_all(self%step%q1)
      end if
      call self%step%find_residual(state, h, load, marked, size_now)
   end subroutine try

   !> Save or restore what the bodies do at the start of a step.
   subroutine serialize(self, stream)
      class(finite_stepper), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call self%step%serialize(stream)
   end subroutine serialize

end module rbs_solve_time_implicit_finite
