!> What a run of any analysis is given besides the column and its loads, and what it gives back besides rows.
module rbs_solve_task
   use rbs_base_constants, only: unset, unset_integer
   use rbs_base_kinds, only: wp
   use rbs_output_recorder, only: recorder_type, observer_type
   use rbs_output_summary, only: summary_type
   use rbs_solve_end_state, only: end_state
   implicit none
   private

   public :: task_type

   type :: task_type
      !> Where kept rows go, and who is told now and then how far the run is (null: nobody)
      class(recorder_type), pointer :: recorder => null()
      class(observer_type), pointer :: progress => null()
      !> Every n-th point is kept, and the last; `unset_integer`: all
      integer :: every = unset_integer
      !> Displacement of the top over the height at which the run ends as collapsed; `unset`: it does not
      real(wp) :: collapse_drift = unset
      !> The state to begin in, empty: virgin; and the state at the end, if it is asked for
      type(end_state) :: before, after
      logical :: keeps_end = .false.
      !> Figures of the run, up to the last good state if it fails
      type(summary_type) :: summary
   contains
      procedure :: resumes
   end type task_type

contains

   !> Whether the run begins in the state that another one ended in.
   pure logical function resumes(self)
      class(task_type), intent(in) :: self

      resumes = self%before%is_given()
   end function resumes

end module rbs_solve_task
