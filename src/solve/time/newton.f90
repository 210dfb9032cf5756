!> Implicit steps by Newton's method with a line search. Every trial goes from the state at the start of the
!> step, each spring in one direction, so that earlier trials leave no trace; and the forces of springs that
!> do not soften then have a convex potential, on which this converges.
module rbs_solve_time_newton
   use rbs_base_kinds, only: wp
   use rbs_solve_line_search, only: false_position
   use rbs_solve_time_halving, only: halving_stepper
   use rbs_solve_time_state, only: state_type, in_bounds, out_of_bounds
   implicit none
   private

   public :: newton_stepper, move_springs

   !> Number of trials in which Newton's method may overshoot.
   integer, parameter :: most_free = 8

   type, abstract, extends(halving_stepper) :: newton_stepper
      !> Most iterations; mostly two or three are needed
      integer :: most_iterations = 40
      !> The residual has vanished below this share of the forces; where round-off does not let it, below the
      !> second
      real(wp) :: wanted = 1.0e-12_wp, acceptable = 1.0e-7_wp
      !> Whether an overshoot is bounded too where the residual does negative work on the correction, as a
      !> tangent that is not positive definite may let it
      logical :: searches_uphill = .true.
   contains
      procedure :: iterate
      procedure :: has_converged
      procedure(correct_interface), deferred :: correct
      procedure(try_interface), deferred :: try
      procedure(work_interface), deferred :: work_of_residual
      procedure(round_off_interface), deferred :: is_round_off
   end type newton_stepper

   abstract interface
      !> Find the correction that takes the residual away as long as no line changes.
      subroutine correct_interface(self, state, h, found)
         import :: newton_stepper, state_type, wp
         implicit none
         class(newton_stepper), intent(inout) :: self
         type(state_type), intent(in) :: state
         real(wp), intent(in) :: h
         logical, intent(out) :: found
      end subroutine correct_interface

      !> Go on (or back) by a share of the correction, and find the residual there.
      subroutine try_interface(self, state, h, load, share, marked, size_now)
         import :: newton_stepper, state_type, wp
         implicit none
         class(newton_stepper), intent(inout) :: self
         type(state_type), intent(inout) :: state
         real(wp), intent(in) :: h, load(4), share
         !> Whether springs have changed their lines, and a mark was set
         logical, intent(inout) :: marked
         !> Relative size of the residual
         real(wp), intent(out) :: size_now
      end subroutine try_interface

      !> Work of the residual on the correction.
      real(wp) function work_interface(self)
         import :: newton_stepper, wp
         implicit none
         class(newton_stepper), intent(in) :: self
      end function work_interface

      !> Whether the residual is what round-off leaves of the terms of the step.
      logical function round_off_interface(self, state, h)
         import :: newton_stepper, state_type, wp
         implicit none
         class(newton_stepper), intent(in) :: self
         type(state_type), intent(in) :: state
         real(wp), intent(in) :: h
      end function round_off_interface
   end interface

contains

   !> Iterate from a trial whose residual has been found.
   subroutine iterate(self, state, h, load, size_now, converged, marked)
      class(newton_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state
      real(wp), intent(in) :: h, load(4)
      real(wp), intent(inout) :: size_now
      logical, intent(out) :: converged
      !> See `try_interface`
      logical, intent(inout) :: marked
      real(wp) :: size_before, slope_before, slope, too_far
      integer :: iteration, most
      logical :: found

      converged = .false.
      most = self%most_iterations
      ! Modal damping is not in the tangent: an iteration leaves of its share as much as the damping ratio.
      if (allocated(state%motion%structure%modal_damping)) most = 10*most
      do iteration = 1, most
         size_before = size_now
         call self%correct(state, h, found)
         if (.not. found) return
         slope_before = self%work_of_residual()
         call self%try(state, h, load, 1.0_wp, marked, size_now)
         if (.not. size_now < out_of_bounds .or. state%springs%stuck) return
         converged = self%has_converged(state, h, size_now, size_before)
         if (converged) return
         slope = self%work_of_residual()
         ! An overshoot mostly does no harm. Where Newton's method goes back and forth, it is bounded.
         too_far = merge(0.9_wp, 0.05_wp, iteration <= most_free)
         if (slope < -too_far*slope_before .and. (self%searches_uphill .or. slope_before > 0.0_wp)) then
            call search_line(self, state, h, load, slope_before, slope, too_far/3.0_wp, marked, size_now)
            if (.not. size_now < out_of_bounds .or. state%springs%stuck) return
         end if
      end do
   end subroutine iterate

   !> Whether the residual has vanished, or is as small as round-off lets it be.
   logical function has_converged(self, state, h, size_now, size_before)
      class(newton_stepper), intent(in) :: self
      type(state_type), intent(in) :: state
      real(wp), intent(in) :: h
      !> Relative size now and at the last trial
      real(wp), intent(in) :: size_now, size_before

      has_converged = size_now <= self%wanted
      if (has_converged .or. self%acceptable < 0.0_wp) return
      has_converged = size_now <= self%acceptable .and. size_now > 0.5_wp*size_before
      ! As long as the residual decreases quickly, it is not yet round-off.
      if (has_converged .or. size_now < 0.1_wp*size_before) return
      has_converged = self%is_round_off(state, h)
   end function has_converged

   !> The trial has gone too far: find the share of the correction at which the residual does little work
   !> on it.
   subroutine search_line(self, state, h, load, slope_before, slope_at_end, share_left, marked, size_now)
      class(newton_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state
      real(wp), intent(in) :: h, load(4)
      !> Work of the residual on the correction at its start and at its end
      real(wp), intent(in) :: slope_before, slope_at_end
      !> Share of the first that may be left
      real(wp), intent(in) :: share_left
      logical, intent(inout) :: marked
      real(wp), intent(inout) :: size_now
      type(false_position) :: line
      real(wp) :: share, slope, now
      integer :: trial

      line = false_position(at_low=slope_before, at_high=slope_at_end)
      now = 1.0_wp
      do trial = 1, 8
         share = line%next()
         call self%try(state, h, load, share - now, marked, size_now)
         now = share
         if (.not. size_now < out_of_bounds .or. state%springs%stuck) return
         slope = self%work_of_residual()
         if (abs(slope) <= share_left*slope_before) return
         call line%narrow(share, slope)
      end do
   end subroutine search_line

   !> Move the springs from the start of the step to a trial, if their lines do not reach so far.
   subroutine move_springs(state, q, marked, inside)
      type(state_type), intent(inout) :: state
      !> Deformations (springs)
      real(wp), intent(in), contiguous :: q(:)
      logical, intent(inout) :: marked
      !> Whether the deformations are within bounds
      logical, intent(out) :: inside

      inside = .true.
      if (.not. marked) then
         if (state%springs%stay_on_lines(q)) return
      end if
      inside = in_bounds(size(q), q)
      if (.not. inside) return
      if (marked) then
         call state%springs%restore()
      else
         call state%springs%mark()
         marked = .true.
      end if
      call state%springs%move_all(q)
   end subroutine move_springs

end module rbs_solve_time_newton
