!> The two analyses, from what the user asked for to rows: where both doors meet.
module rbs_solve_run
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use rbs_base_constants, only: beyond_meaning
   use rbs_base_error, only: error_type, message_list, fatal_error, bad_input
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_column_column, only: column_type, new_column, finite
   use rbs_loading_signal, only: signal_type
   use rbs_results_progress, only: progress_type
   use rbs_results_recorder, only: recorder_type
   use rbs_results_summary, only: summary_type
   use rbs_solve_history, only: initial_state, march
   use rbs_solve_modal, only: modes_type, find_modes
   use rbs_solve_static, only: trace
   use rbs_solve_time_plan, only: time_plan, new_plan, check_times
   use rbs_spec_column, only: column_spec
   implicit none
   private

   public :: make_column, run_static, plan_dynamic, run_dynamic, check_values

contains

   !> Validate a column and make it.
   subroutine make_column(spec, column, error)
      type(column_spec), intent(in) :: spec
      type(column_type), intent(out) :: column
      type(error_type), allocatable, intent(out) :: error
      type(message_list) :: messages

      call spec%validate(messages)
      call messages%raise(error)
      if (.not. allocated(error)) call new_column(column, spec)
   end subroutine make_column

   !> Static path through displacements of the top or lateral forces.
   subroutine run_static(column, by_force, target, every, recorder, summary, error, progress)
      type(column_type), intent(in) :: column
      !> Whether the targets are lateral forces [N], else displacements of the top [m]
      logical, intent(in) :: by_force
      !> Targets (m)
      real(wp), intent(in) :: target(:)
      !> Every n-th point is kept, and the last; `unset_integer`: all
      integer, intent(in) :: every
      class(recorder_type), intent(inout) :: recorder
      type(summary_type), intent(out) :: summary
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress

      if (column%kinematics == finite) then
         call fatal_error(error, bad_input, "column: kinematics = 'finite' has no static path; use "// &
                          "'small' or 'pdelta', or a dynamic analysis")
         return
      end if
      if (by_force) then
         call check_values(target, 'force', error)
      else
         call check_values(target, 'displacement', error)
      end if
      if (allocated(error)) return
      call trace(column, by_force, target, every, recorder, summary, error, progress)
   end subroutine run_static

   !> Stability limit and plan of the steps of a dynamic analysis.
   subroutine plan_dynamic(column, time, dt, plan, limit, error)
      type(column_type), intent(in) :: column
      !> Times of the loading (m) [s]
      real(wp), intent(in) :: time(:)
      !> Step, or `unset` [s]
      real(wp), intent(in) :: dt
      type(time_plan), intent(out) :: plan
      !> Stability limit [s]
      real(wp), intent(out) :: limit
      type(error_type), allocatable, intent(out) :: error
      type(modes_type) :: modes

      limit = 0.0_wp
      call check_times(time, error)
      if (allocated(error)) return
      call find_modes(column, modes, error)
      if (allocated(error)) return
      limit = modes%stable_step
      call new_plan(plan, time, dt, limit, error)
   end subroutine plan_dynamic

   !> Response in time under lateral force, ground motion, or both, by RK4.
   subroutine run_dynamic(column, plan, limit, time, force, ground, initial, every, recorder, summary, &
                          error, progress)
      type(column_type), intent(in) :: column
      !> From `plan_dynamic`
      type(time_plan), intent(in) :: plan
      real(wp), intent(in) :: limit
      !> Times of the loading (m) [s]
      real(wp), intent(in) :: time(:)
      !> Lateral force [N] and acceleration of the ground [m/s2]; no points: none
      type(signal_type), intent(in) :: force, ground
      type(initial_state), intent(in) :: initial
      !> Every n-th step gives a row, and the last; `unset_integer`: every interval of the plan
      integer, intent(in) :: every
      class(recorder_type), intent(inout) :: recorder
      type(summary_type), intent(out) :: summary
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress

      if (force%acts()) call check_values(force%value, 'force', error)
      if (allocated(error)) return
      if (ground%acts()) call check_values(ground%value, 'ground_acceleration', error)
      if (allocated(error)) return
      summary%stable_step = limit
      call march(column, plan, time, force, ground, initial, every, recorder, summary, error, progress)
   end subroutine run_dynamic

   !> Values must be finite, and so must what is made of them.
   subroutine check_values(values, name, error)
      real(wp), intent(in) :: values(:)
      character(len=*), intent(in) :: name
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      do i = 1, size(values)
         if (.not. ieee_is_finite(values(i))) then
            call fatal_error(error, bad_input, name//': value '//to_text(i)//' of '// &
                             to_text(size(values))//' is '//to_text(values(i))// &
                             '; it must be a finite number')
            return
         else if (abs(values(i)) > beyond_meaning) then
            call fatal_error(error, bad_input, name//': value '//to_text(i)//' of '// &
                             to_text(size(values))//' is '//to_text(values(i))// &
                             '; products of it would not be finite: check its exponent and unit')
            return
         end if
      end do
   end subroutine check_values

end module rbs_solve_run
