!> Result of a run of an ensemble: its fate and its measures.
module rbs_solve_ensemble_run_result
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_output_summary, only: summary_type
   implicit none
   private

   public :: run_result, measure_count, measure_names, collect

   !> The fates of a run, a closed list. Skipped runs are those that were not started before a stop.
   integer, parameter :: fate_skipped = 0, fate_completed = 1, fate_collapsed = 2, fate_axial = 3, &
                         fate_failed = 4

   integer, parameter :: measure_count = 18

   !> One run; not a number where a run has failed.
   type :: run_result
      integer :: fate = fate_skipped
      !> In the order of `measure_names`
      real(wp) :: value(measure_count) = 0.0_wp
      !> When each limit state was reached first; not a number if it was not (states) [s]
      real(wp), allocatable :: reached(:)
      !> Largest drift ratios of the storeys in size, then those at the end (2 storeys)
      real(wp), allocatable :: storey(:)
      !> Why it failed
      character(len=:), allocatable :: message
   end type run_result

contains

   !> Names of the measures in their order, separated by blanks.
   pure function measure_names() result(names)
      character(len=512) :: names

      names = 'peak_displacement residual_displacement peak_base_shear peak_rotation input_energy '// &
              'spring_energy damping_energy energy_residual relative_energy_residual first_yield '// &
              'end_time time_step steps events cut_steps lost_joint peak_storey_drift '// &
              'residual_storey_drift'
   end function measure_names

   !> Put fate and measures of a run that has ended into its result: failed with its message where there is an
   !> error, else lost its axial load, collapsed or completed. Measures that a run does not have are not a
   !> number.
   subroutine collect(reached, summary, error, result)
      !> When each limit state was reached, `huge` if it was not (states) [s]
      real(wp), intent(in) :: reached(:)
      type(summary_type), intent(in) :: summary
      type(error_type), allocatable, intent(in) :: error
      type(run_result), intent(inout) :: result
      real(wp) :: nothing

      nothing = ieee_value(nothing, ieee_quiet_nan)
      if (allocated(error)) then
         result%fate = fate_failed
         result%message = error%message
         result%value = nothing
         result%reached = spread(nothing, 1, size(reached))
         return
      end if
      result%fate = fate_completed
      if (summary%collapsed) result%fate = fate_collapsed
      if (summary%lost_joint > 0) result%fate = fate_axial
      result%reached = merge(reached, nothing, reached < huge(1.0_wp))
      ! In the order of `measure_names`. Limit state 1 is the first yield; the last two are drifts of storeys,
      ! which only frames have.
      result%value = [summary%peak_displacement, summary%last_displacement, summary%peak_base_shear, &
                      summary%peak_rotation, summary%energy%input, summary%energy%spring, &
                      summary%energy%damping, summary%residual, &
                      summary%residual/max(summary%largest, tiny(1.0_wp)), result%reached(1), &
                      summary%last_time, summary%time_step, real(summary%steps, wp), &
                      real(summary%events, wp), real(summary%cut_steps, wp), &
                      real(summary%lost_joint, wp), nothing, nothing]
      if (.not. allocated(summary%storey_drift)) return
      result%storey = [summary%peak_storey_drift, abs(summary%storey_drift)]
      result%value(measure_count - 1:) = [maxval(summary%peak_storey_drift), &
                                          maxval(abs(summary%storey_drift))]
   end subroutine collect

end module rbs_solve_ensemble_run_result
