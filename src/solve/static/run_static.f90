!> The entry of the static analyses.
module rbs_solve_static_run_static
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_column_column, only: column_type, finite
   use rbs_output_observer, only: observer_type
   use rbs_output_recorder, only: recorder_type
   use rbs_output_summary, only: summary_type
   use rbs_solve_check_values, only: check_values
   use rbs_solve_static_trace, only: trace
   use rbs_solve_static_trace_finite, only: trace_finite
   implicit none
   private

   public :: run_static

contains

   !> Static path through displacements of the top or lateral forces.
   subroutine run_static(column, by_force, target, every, collapse_drift, recorder, summary, error, progress)
      type(column_type), intent(in) :: column
      !> Whether the targets are lateral forces [N], else displacements of the top [m]
      logical, intent(in) :: by_force
      !> Targets (m)
      real(wp), intent(in) :: target(:)
      !> Every n-th point is kept, and the last; `unset_integer`: all
      integer, intent(in) :: every
      !> Displacement of the top over the height at which the path ends as collapsed; `unset`: none
      real(wp), intent(in) :: collapse_drift
      class(recorder_type), intent(inout) :: recorder
      type(summary_type), intent(out) :: summary
      type(error_type), allocatable, intent(out) :: error
      class(observer_type), intent(inout), optional :: progress

      if (by_force) then
         call check_values(target, 'force', error)
      else
         call check_values(target, 'displacement', error)
      end if
      if (allocated(error)) return
      if (column%kinematics == finite) then
         call trace_finite(column, by_force, target, every, collapse_drift, recorder, summary, error, &
                           progress)
      else
         call trace(column, by_force, target, every, collapse_drift, recorder, summary, error, progress)
      end if
      ! Without inertia the ground holds what drives the column.
      summary%peak_base_shear = summary%peak_force
      summary%method = 'static'
   end subroutine run_static

end module rbs_solve_static_run_static
