!> An explicit scheme: one step from a state, tried without moving it.
module rbs_solve_time_scheme
   use rbs_base_arrays, only: swap
   use rbs_base_kinds, only: wp
   use rbs_solve_time_motion, only: motion_result
   use rbs_solve_time_state, only: state_type
   use rbs_structure_structure, only: structure_type, signals
   implicit none
   private

   public :: scheme_type

   type, abstract :: scheme_type
      !> Order of the scheme
      integer :: order = 0
      !> Result of the last attempt: deformations and velocities (springs); estimate of its error, if the
      !> scheme has one (springs)
      real(wp), allocatable :: q(:), v(:), error_q(:), error_v(:)
      !> Works of loads and damping in it [J]; loads at its end
      real(wp) :: of_loads = 0.0_wp, of_damping = 0.0_wp, load(signals) = 0.0_wp
      !> The equation of motion at the last stage
      type(motion_result) :: now
      !> Whether the acceleration at the start is known from the last attempt
      logical :: begun = .false.
   contains
      procedure(create_interface), deferred :: create
      procedure(attempt_interface), deferred :: attempt
      procedure :: accept
   end type scheme_type

   abstract interface
      !> Allocate the work arrays for the steps of a structure.
      subroutine create_interface(self, structure)
         import :: scheme_type, structure_type
         class(scheme_type), intent(out) :: self
         class(structure_type), intent(in) :: structure
      end subroutine create_interface

      !> A step of h on the present lines of the springs; deformations and velocities of the state stay.
      subroutine attempt_interface(self, state, h)
         import :: scheme_type, state_type, wp
         class(scheme_type), intent(inout) :: self
         type(state_type), intent(inout) :: state
         !> Step [s]
         real(wp), intent(in) :: h
      end subroutine attempt_interface
   end interface

contains

   !> Take the last attempt, of length h [s], as the state; its springs do not follow yet. The scheme keeps
   !> the state before in place of the result.
   subroutine accept(self, state, h)
      class(scheme_type), intent(inout) :: self
      type(state_type), intent(inout) :: state
      real(wp), intent(in) :: h

      call swap(state%q, self%q)
      call swap(state%v, self%v)
      state%time = state%time + h
      state%load = self%load
      call state%motion%set_axial_loads(state%springs, self%load)
      state%of_loads = state%of_loads + self%of_loads
      state%of_damping = state%of_damping + self%of_damping
      self%begun = .false.
   end subroutine accept

end module rbs_solve_time_scheme
