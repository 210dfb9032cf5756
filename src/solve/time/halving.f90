!> Implicit methods: a step that does not converge is taken in two halves.
module rbs_solve_time_halving
   use rbs_base_error, only: error_type, fatal_error, analysis_failed
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_base_text, only: to_text
   use rbs_solve_time_state, only: state_type, stepper_type
   use rbs_structure_spring_place, only: spring_name
   implicit none
   private

   public :: halving_stepper

   !> Most cuts of a step in halves.
   integer, parameter :: most_cuts = 24

   type, abstract, extends(stepper_type) :: halving_stepper
   contains
      procedure :: advance
      procedure :: resume
      procedure(prepare_interface), deferred :: prepare
      procedure(take_step_interface), deferred :: take_step
      procedure(serialize_interface), deferred :: serialize
   end type halving_stepper

   abstract interface
      !> Once, before the first step.
      subroutine prepare_interface(self, state)
         import :: halving_stepper, state_type
         implicit none
         class(halving_stepper), intent(inout) :: self
         type(state_type), intent(in) :: state
      end subroutine prepare_interface

      !> Take a step of h, if it converges; else the state is as before.
      subroutine take_step_interface(self, state, h, load, converged, busiest)
         import :: halving_stepper, state_type, wp
         implicit none
         class(halving_stepper), intent(inout) :: self
         type(state_type), intent(inout) :: state
         !> Length [s], and loads at the end
         real(wp), intent(in) :: h, load(4)
         logical, intent(out) :: converged
         !> The spring that changed its line last, 0 for none
         integer, intent(out) :: busiest
      end subroutine take_step_interface

      !> Save or restore what the bodies do at the start of a step.
      subroutine serialize_interface(self, stream)
         import :: halving_stepper, stream_type
         implicit none
         class(halving_stepper), intent(inout) :: self
         type(stream_type), intent(inout) :: stream
      end subroutine serialize_interface
   end interface

contains

   subroutine advance(self, state, h, error)
      class(halving_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state
      real(wp), intent(in) :: h
      type(error_type), allocatable, intent(inout) :: error
      real(wp) :: finish, load(4)
      integer :: busiest
      logical :: converged

      if (allocated(error)) return
      if (.not. self%begun) call self%prepare(state)
      self%begun = .true.
      finish = state%time + h
      ! Most steps converge.
      call state%loads%at_time(finish, load)
      call self%take_step(state, h, load, converged, busiest)
      if (converged) then
         self%steps = self%steps + 1
      else
         call halve(self, state, h, 0, busiest, error)
      end if
      if (.not. allocated(error)) state%time = finish
   end subroutine advance

   !> Accelerations and forces at the start of a step are those that the step before ended with.
   subroutine resume(self, state, stream)
      class(halving_stepper), intent(inout) :: self
      type(state_type), intent(in) :: state
      type(stream_type), intent(inout) :: stream

      if (.not. self%begun) call self%prepare(state)
      self%begun = .true.
      call self%serialize(stream)
   end subroutine resume

   !> Take a step, or its two halves if it does not converge.
   recursive subroutine move_on(self, state, h, cuts, error)
      class(halving_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state
      real(wp), intent(in) :: h
      !> How often the step has been cut already
      integer, intent(in) :: cuts
      type(error_type), allocatable, intent(inout) :: error
      real(wp) :: load(4)
      integer :: busiest
      logical :: converged

      call state%loads%at_time(state%time + h, load)
      call self%take_step(state, h, load, converged, busiest)
      if (converged) then
         self%steps = self%steps + 1
         if (.not. (state%lost .or. state%springs%stuck)) call state%see(state%begin + state%time)
      else
         call halve(self, state, h, cuts, busiest, error)
      end if
   end subroutine move_on

   !> Take the halves of a step that has not converged.
   recursive subroutine halve(self, state, h, cuts, busiest, error)
      class(halving_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state
      real(wp), intent(in) :: h
      !> How often the step has been cut before, and the spring that changed its line last
      integer, intent(in) :: cuts, busiest
      type(error_type), allocatable, intent(inout) :: error

      self%cut_steps = self%cut_steps + 1
      if (cuts == most_cuts) then
         call fatal_error(error, analysis_failed, 'the step of '//to_text(h)//' s at time '// &
                          to_text(state%begin + state%time)//' s does not converge although it was cut '// &
                          to_text(most_cuts)//' times; '// &
                          trim(spring_name(state%motion%structure%place(max(busiest, 1))))// &
                          ' is the busiest. Rows up to there are kept, the last good state is that of '// &
                          "this time. Try a shorter dt or method = 'rk45', and look at the springs "// &
                          'that soften')
         return
      end if
      call move_on(self, state, 0.5_wp*h, cuts + 1, error)
      if (.not. allocated(error)) call move_on(self, state, 0.5_wp*h, cuts + 1, error)
   end subroutine halve

end module rbs_solve_time_halving
