!> Task of a run of any analysis: its settings besides structure and loads, and its answers besides rows.
module rbs_solve_task
   use, intrinsic :: iso_fortran_env, only: int64
   use rbs_base_constants, only: unset, unset_integer
   use rbs_base_check, only: is_given
   use rbs_base_kinds, only: wp
   use rbs_output_recorder, only: recorder_type, observer_type
   use rbs_output_summary, only: summary_type
   use rbs_solve_end_state, only: end_state
   implicit none
   private

   public :: task_type, many_unknowns

   !> From so many unknowns on a step is long enough to report it.
   integer, parameter :: many_unknowns = 12

   type :: task_type
      !> Recorder of the kept rows, and observer of the progress (null: none)
      class(recorder_type), pointer :: recorder => null()
      class(observer_type), pointer :: progress => null()
      !> Every n-th point is kept, and the last; `unset_integer`: all
      integer :: every = unset_integer
      !> Whether a static path leaps from target to target, by Newton's method
      logical :: leaps = .false.
      !> Drift of a storey, or of the top, at which the run ends as collapsed; `unset`: it does not
      real(wp) :: collapse_drift = unset
      !> The word by which another thread ends the run, where it is not 0 (null: none)
      integer, pointer :: control => null()
      !> Seconds by the clock after which the run ends; `unset`: it does not
      real(wp) :: most_seconds = unset
      !> Count of the clock when `stops` was asked first, -1 before
      integer(int64), private :: begun = -1_int64
      !> The state to begin in, empty: virgin; and the state at the end, if it is asked for
      type(end_state) :: before, after
      logical :: keeps_end = .false.
      !> Figures of the run, up to the last good state if it fails
      type(summary_type) :: summary
   contains
      procedure :: resumes, stops
   end type task_type

contains

   !> Whether the run begins in the state that another one ended in.
   pure logical function resumes(self)
      class(task_type), intent(in) :: self

      resumes = self%before%is_given()
   end function resumes

   !> Whether the run ends here, because another thread has asked for it or because its seconds by the clock
   !> are over, which are counted from the first call. Rows up to here are kept.
   logical function stops(self)
      class(task_type), intent(inout) :: self
      integer(int64) :: now, rate

      stops = .false.
      if (associated(self%control)) stops = is_set(self%control)
      if (is_given(self%most_seconds)) then
         call system_clock(now, rate)
         if (self%begun < 0_int64) self%begun = now
         stops = stops .or. real(now - self%begun, wp) > self%most_seconds*real(rate, wp)
      end if
      self%summary%stopped = self%summary%stopped .or. stops
   end function stops

   !> Whether a word is set that other threads may change at any time: `volatile`, so that it is read anew
   !> each time.
   logical function is_set(word)
      integer, intent(inout), volatile :: word

      is_set = word /= 0
   end function is_set

end module rbs_solve_task
