!> The state of a structure in time, the works done on it so far, and the type of a method that advances it.
module rbs_solve_time_state
   use rbs_base_constants, only: out_of_bounds
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_hysteresis_springs, only: spring_array
   use rbs_loading_loads, only: loads_type, signals
   use rbs_solve_time_motion, only: equation_of_motion
   use rbs_solve_time_monitor, only: response_monitor
   implicit none
   private

   public :: state_type, stepper_type, out_of_bounds, in_bounds

   type :: state_type
      type(equation_of_motion) :: motion
      type(spring_array) :: springs
      type(loads_type) :: loads
      !> Position, deformations of the springs first, and its velocity (coordinates)
      real(wp), allocatable :: q(:), v(:)
      !> Time since the start of the run [s], which keeps its digits where the clock is late; the loads then
      real(wp) :: time = 0.0_wp, load(signals) = 0.0_wp
      !> Time of the clock at the start, and now [s]; works of loads and damping, and the energy at the start
      !> [J]
      real(wp) :: begin = 0.0_wp, clock = 0.0_wp, of_loads = 0.0_wp, of_damping = 0.0_wp, at_begin = 0.0_wp
      !> Kinetic energy that the velocities of the joints do not show: implicit steps keep joints from
      !> opening at their ends, not at every moment [J]
      real(wp) :: along_joints = 0.0_wp
      !> Whether a deformation is out of bounds; the run cannot be continued from there
      logical :: diverged = .false.
      !> A spring in a member without equilibrium between its ends, 0 for none; the state is the one before
      integer :: runaway = 0
      !> Number of steps in which members snapped, the energy lost in them, and the largest loss [J]; its
      !> spring, and its time [s]
      integer :: snaps = 0, snap_spring = 0
      real(wp) :: in_snaps = 0.0_wp, largest_snap = -huge(1.0_wp), snap_time = 0.0_wp
      !> Peaks and limit states so far
      type(response_monitor) :: monitor
   contains
      procedure :: begin_monitor, update_monitor
   end type state_type

   !> A method of integration. Its own type holds its memory from step to step.
   type, abstract :: stepper_type
      !> Steps that were cut so far: at an event, for accuracy, or because they did not converge
      integer :: cut_steps = 0
      !> Steps taken so far; each part of a cut step counts as one
      integer :: steps = 0
      !> Longest step taken, if the method chooses its steps; 0 if they are as planned [s]
      real(wp) :: longest_step = 0.0_wp
      !> Whether its values before the first step have been found
      logical :: begun = .false.
      !> Method and its setting: a continued run with the same keeps its steps
      integer :: method = 0
      real(wp) :: setting = 0.0_wp
   contains
      procedure(advance_interface), deferred :: advance
      procedure :: restart, resume
   end type stepper_type

   abstract interface
      !> Move a state on by h. On failure the state is the last good one.
      subroutine advance_interface(self, state, h, error)
         import :: stepper_type, state_type, error_type, wp
         class(stepper_type), intent(inout) :: self
         type(state_type), intent(inout) :: state
         !> Step [s]
         real(wp), intent(in) :: h
         type(error_type), allocatable, intent(inout) :: error
      end subroutine advance_interface
   end interface

contains

   !> Let the monitor look at the state for the first time; the limit states are known to it before.
   subroutine begin_monitor(self, collapse_drift, floor)
      class(state_type), intent(inout) :: self
      !> Drift at which the structure has collapsed, of a storey or of the top; `unset`: none
      real(wp), intent(in) :: collapse_drift
      !> Whether the acceleration of the top is monitored
      logical, intent(in) :: floor

      call self%monitor%begin(self%motion, self%springs, self%q, self%v, self%load, self%clock, &
                            collapse_drift, floor)
   end subroutine begin_monitor

   !> Let the monitor look at the state at the end of a step, or of a part of a step.
   subroutine update_monitor(self, clock)
      class(state_type), intent(inout) :: self
      !> Time of the clock [s]
      real(wp), intent(in) :: clock

      call self%monitor%update(self%motion, self%springs, self%q, self%v, self%load, clock)
   end subroutine update_monitor

   !> Make the method ready for another run of the same structure with the same steps.
   subroutine restart(self)
      class(stepper_type), intent(inout) :: self

      self%cut_steps = 0
      self%steps = 0
      self%longest_step = 0.0_wp
      self%begun = .false.
   end subroutine restart

   !> Save or restore the values on which the next step depends besides the state. A method whose steps depend
   !> on the state alone inherits this procedure.
   subroutine resume(self, state, stream)
      class(stepper_type), intent(inout) :: self
      type(state_type), intent(inout) :: state
      type(stream_type), intent(inout) :: stream

      ! Nothing to save; a state out of bounds is no start.
      stream%broken = stream%broken .or. self%steps < 0 .or. state%diverged
   end subroutine resume

   !> Whether all deformations are within bounds.
   pure logical function in_bounds(m, q)
      integer, intent(in) :: m
      real(wp), intent(in) :: q(m)
      real(wp) :: beyond
      integer :: i

      ! NaN is not below the bound.
      beyond = 0.0_wp
      !$omp simd reduction(max:beyond)
      do i = 1, m
         beyond = max(beyond, merge(0.0_wp, 1.0_wp, abs(q(i)) < out_of_bounds))
      end do
      in_bounds = .not. beyond > 0.0_wp
   end function in_bounds

end module rbs_solve_time_state
