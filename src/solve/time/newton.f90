!> Implicit steps by Newton's method with a line search. Every trial starts from the state at the start of the
!> step, each spring in one direction, so that earlier trials leave no trace; and the forces of springs that
!> do not soften then have a convex potential, on which this converges. A step that does not converge is taken
!> in two halves.
module rbs_solve_time_newton
   use rbs_base_error, only: error_type, fatal_error, analysis_failed
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_base_text, only: to_text
   use rbs_solve_line_search, only: false_position
   use rbs_solve_time_state, only: state_type, stepper_type, in_bounds, out_of_bounds
   use rbs_structure_spring_location, only: spring_name
   use rbs_structure_structure, only: structure_type, signals
   implicit none
   private

   public :: newton_stepper, progress

   !> Number of trials in which Newton's method may overshoot, most trials in turn that do not bring the
   !> residual below the least one before, most cuts of a step in halves, and most tries of a step and its
   !> parts that fail.
   integer, parameter :: most_free = 8, most_idle = 10, most_cuts = 24, most_failed = 60

   !> Share of the least residual so far that a trial must come below, or it is idle.
   real(wp), parameter :: progress = 0.95_wp

   type, abstract, extends(stepper_type) :: newton_stepper
      !> Most trials; mostly two or three are needed
      integer :: most_trials = 400
      !> The residual has vanished below this share of the forces; where round-off does not let it, below the
      !> second
      real(wp) :: wanted = 1.0e-12_wp, acceptable = 1.0e-7_wp
      !> Whether an overshoot is bounded too where the residual does negative work on the correction, as a
      !> tangent that is not positive definite may let it
      logical :: searches_uphill = .true.
      !> The step that is taken: its length [s], the loads at its end, the relative size of the residual of
      !> the trial
      real(wp) :: h = 0.0_wp, load(signals) = 0.0_wp, residual = 0.0_wp
      !> Whether it has converged, whether springs have changed their lines, and a mark was set, and whether
      !> there is a correction
      logical :: converged = .false., marked = .false., regular = .true.
      !> The spring that changed its line last, 0 for none
      integer :: busiest = 0
      !> A spring in a member without equilibrium between its ends, 0 for none
      integer :: runaway = 0
      !> Tries of the present step that have failed
      integer, private :: failed = 0
   contains
      procedure :: advance, resume, iterate, has_converged, is_round_off, move_springs
      !> Find velocities, accelerations and forces at the start, once before the first step
      procedure(act_on_state), deferred :: prepare
      !> Take the step, if it converges; else the state is as before
      procedure(act_on_state), deferred :: take_step
      !> Find the correction that takes the residual away as long as no line changes
      procedure(act_on_state), deferred :: correct
      procedure(try_interface), deferred :: try
      procedure(work_interface), deferred :: work_of_residual
      procedure(serialize_interface), deferred :: serialize
   end type newton_stepper

   abstract interface
      !> Any act of the method on a state.
      subroutine act_on_state(self, state)
         import :: newton_stepper, state_type
         class(newton_stepper), intent(inout) :: self
         type(state_type), intent(inout) :: state
      end subroutine act_on_state

      !> Go on (or back) by a share of the correction, and find the residual there.
      subroutine try_interface(self, state, share)
         import :: newton_stepper, state_type, wp
         class(newton_stepper), intent(inout) :: self
         type(state_type), intent(inout) :: state
         !> May be negative, to go back
         real(wp), intent(in) :: share
      end subroutine try_interface

      !> Work of the residual on the correction.
      real(wp) function work_interface(self)
         import :: newton_stepper, wp
         class(newton_stepper), intent(in) :: self
      end function work_interface

      !> Save or restore the motion of the bodies at the start of a step.
      subroutine serialize_interface(self, stream)
         import :: newton_stepper, stream_type
         class(newton_stepper), intent(inout) :: self
         type(stream_type), intent(inout) :: stream
      end subroutine serialize_interface
   end interface

contains

   !> Move the state on by h; a step that does not converge is cut into halves, and these in turn. The state
   !> may end before with `runaway`, where a member has lost its equilibrium.
   subroutine advance(self, state, h, error)
      class(newton_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state
      !> Step [s]
      real(wp), intent(in) :: h
      type(error_type), allocatable, intent(inout) :: error
      real(wp) :: finish

      if (allocated(error)) return
      if (.not. self%begun) call self%prepare(state)
      self%begun = .true.
      finish = state%time + h
      ! Most steps converge.
      self%h = h
      self%failed = 0
      call state%loads%at_time(finish, self%load)
      call self%take_step(state)
      if (self%converged) then
         self%steps = self%steps + 1
      else
         call halve(self, state, h, 0, error)
      end if
      if (.not. allocated(error) .and. state%runaway == 0) state%time = finish
   end subroutine advance

   !> Save or restore, whichever the stream is set to, what the next step depends on besides the state:
   !> accelerations and forces at its start are those that the step before ended with.
   subroutine resume(self, state, stream)
      class(newton_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state
      type(stream_type), intent(inout) :: stream

      ! A new method needs its arrays before they are restored.
      if (.not. self%begun) call self%prepare(state)
      self%begun = .true.
      call self%serialize(stream)
   end subroutine resume

   !> Take the halves of a step that has not converged; each that does not converge either is cut again.
   recursive subroutine halve(self, state, h, cuts, error)
      class(newton_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state
      !> Length of the step that failed [s]
      real(wp), intent(in) :: h
      !> How often the step has been cut before
      integer, intent(in) :: cuts
      type(error_type), allocatable, intent(inout) :: error
      integer :: half

      ! A member that has lost its equilibrium does so in a shorter step too.
      state%runaway = self%runaway
      if (self%runaway > 0) return
      self%cut_steps = self%cut_steps + 1
      self%failed = self%failed + 1
      if (cuts == most_cuts .or. self%failed > most_failed) then
         call fatal_error(error, analysis_failed, 'the step of '//to_text(h)//' s at time '// &
                          to_text(state%begin + state%time)//' s does not converge although it was cut '// &
                          to_text(cuts)//' times; '// &
                          trim(spring_name(state%motion%structure%location(max(self%busiest, 1))))// &
                          ' is the busiest. Rows up to there are kept, the last good state is that of '// &
                          'this time. '//trim(remedy(state%motion%structure)))
         return
      end if
      do half = 1, 2
         self%h = 0.5_wp*h
         call state%loads%at_time(state%time + self%h, self%load)
         call self%take_step(state)
         if (self%converged) then
            self%steps = self%steps + 1
            if (.not. (state%diverged .or. state%springs%stuck)) then
               call state%update_monitor(state%begin + state%time)
            end if
         else
            call halve(self, state, 0.5_wp*h, cuts + 1, error)
            if (allocated(error) .or. state%runaway > 0) return
         end if
      end do
   end subroutine halve

   !> Remedy where no step converges.
   pure character(len=160) function remedy(structure)
      class(structure_type), intent(in) :: structure

      if (structure%is_implicit) then
         remedy = 'Damping in proportion to the stiffness holds members that soften; look at the '// &
                  'member that is named'
      else
         remedy = "Try a shorter dt or method = 'rk45', and look at the springs that soften"
      end if
   end function remedy

   !> Newton's method from a trial whose residual has been found, until the residual has vanished
   !> (`converged`), no correction exists, or the residual decreases no more.
   subroutine iterate(self, state)
      class(newton_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state
      !> Residual of the trial before; work of the residual on a correction at its start and at its end; share
      !> of the first by which the second may be negative; least residual so far
      real(wp) :: before, slope_before, slope, too_far, least
      integer :: iteration, idle

      self%converged = .false.
      least = self%residual
      idle = 0
      do iteration = 1, self%most_trials
         before = self%residual
         call self%correct(state)
         if (.not. self%regular) return
         slope_before = self%work_of_residual()
         call self%try(state, 1.0_wp)
         if (.not. self%residual < out_of_bounds .or. state%springs%stuck) return
         self%converged = self%has_converged(state, before)
         if (self%converged) return
         idle = idle + 1
         if (self%residual < progress*least) idle = 0
         least = min(least, self%residual)
         if (idle > most_idle) return
         slope = self%work_of_residual()
         ! An overshoot mostly does no harm. Where Newton's method oscillates, it is bounded.
         too_far = merge(0.9_wp, 0.05_wp, iteration <= most_free)
         if (slope < -too_far*slope_before .and. (self%searches_uphill .or. slope_before > 0.0_wp)) then
            call search_line(self, state, slope_before, slope, too_far/3.0_wp)
            if (.not. self%residual < out_of_bounds .or. state%springs%stuck) return
         end if
      end do
   end subroutine iterate

   !> Whether the residual has vanished, or is as small as round-off lets it be: it is acceptable and no more
   !> than halves from trial to trial, or it hardly decreases and is the round-off of the terms of the step.
   logical function has_converged(self, state, before)
      class(newton_stepper), intent(in) :: self
      type(state_type), intent(in) :: state
      !> Size of the residual relative to the forces at the trial before
      real(wp), intent(in) :: before

      has_converged = self%residual <= self%wanted
      if (has_converged .or. self%acceptable < 0.0_wp) return
      has_converged = self%residual <= self%acceptable .and. self%residual > 0.5_wp*before
      ! As long as the residual decreases quickly, it is not yet round-off.
      if (has_converged .or. self%residual < 0.1_wp*before) return
      has_converged = self%is_round_off(state)
   end function has_converged

   !> Whether the residual is the round-off of the terms of the step: no, where these cannot be separated from
   !> it, as while bodies turn.
   logical function is_round_off(self, state)
      class(newton_stepper), intent(in) :: self
      type(state_type), intent(in) :: state

      is_round_off = .false.
   end function is_round_off

   !> The trial has gone too far: find the share of the correction at which the residual does little work
   !> on it.
   subroutine search_line(self, state, slope_before, slope_at_end, share_left)
      class(newton_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state
      !> Work of the residual on the correction at its start and at its end; share of the first that may be
      !> left
      real(wp), intent(in) :: slope_before, slope_at_end, share_left
      type(false_position) :: line
      !> Share of the correction to be tried, work of the residual there, share reached
      real(wp) :: share, slope, now
      integer :: trial

      line = false_position(at_low=slope_before, at_high=slope_at_end)
      now = 1.0_wp
      do trial = 1, 8
         share = line%next()
         call self%try(state, share - now)
         now = share
         if (.not. self%residual < out_of_bounds .or. state%springs%stuck) return
         slope = self%work_of_residual()
         if (abs(slope) <= share_left*slope_before) return
         call line%narrow(share, slope)
      end do
   end subroutine search_line

   !> Put the springs on the lines that they have at a trial, each in one direction from the start of the
   !> step. As long as all stay on their lines nothing need be done.
   subroutine move_springs(self, state, q, in_range)
      class(newton_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state
      !> Position (coordinates); deformations of layers in it are set by those of their joints
      real(wp), intent(inout), contiguous :: q(:)
      !> Whether the deformations are within bounds
      logical, intent(out) :: in_range

      in_range = .true.
      ! Without a mark no spring has left its line in this step.
      if (.not. self%marked) then
         if (state%springs%stay_on_lines(q)) return
      end if
      call state%springs%joints%open_layers(q)
      in_range = in_bounds(size(q), q)
      if (.not. in_range) return
      call state%springs%choose_lines(q)
      self%marked = .true.
   end subroutine move_springs

end module rbs_solve_time_newton
