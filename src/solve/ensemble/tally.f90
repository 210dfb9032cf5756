!> The measures of a run whose rows are not kept.
module rbs_solve_ensemble_tally
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_output_summary, only: summary_type
   use rbs_solve_ensemble_outcome, only: outcome_type, fate_completed, fate_collapsed, fate_axial, &
                                         fate_failed, at_peak_displacement, at_residual_displacement, &
                                         at_peak_base_shear, at_peak_rotation, at_input, at_spring, &
                                         at_damping, at_residual, at_relative_residual, at_first_yield, &
                                         at_end, at_time_step, at_steps, at_events, at_cut, at_lost_joint
   implicit none
   private

   public :: settle

contains

   !> Fate and measures of a run that has ended.
   subroutine settle(reached, summary, error, outcome)
      !> When each limit state was reached, `huge` if it was not (states) [s]
      real(wp), intent(in) :: reached(:)
      type(summary_type), intent(in) :: summary
      type(error_type), allocatable, intent(in) :: error
      type(outcome_type), intent(inout) :: outcome
      real(wp) :: nothing

      nothing = ieee_value(nothing, ieee_quiet_nan)
      if (allocated(error)) then
         outcome%fate = fate_failed
         outcome%message = error%message
         outcome%value = nothing
         outcome%reached = spread(nothing, 1, size(reached))
         return
      end if
      outcome%fate = fate_completed
      if (summary%collapsed) outcome%fate = fate_collapsed
      if (summary%lost_joint > 0) outcome%fate = fate_axial
      associate (value => outcome%value)
         value(at_peak_displacement) = summary%peak_displacement
         value(at_residual_displacement) = summary%last_displacement
         value(at_peak_base_shear) = summary%peak_base_shear
         value(at_peak_rotation) = summary%peak_rotation
         value(at_input) = summary%energy%input
         value(at_spring) = summary%energy%spring
         value(at_damping) = summary%energy%damping
         value(at_residual) = summary%residual
         value(at_relative_residual) = summary%residual/max(summary%largest, tiny(1.0_wp))
         outcome%reached = merge(reached, nothing, reached < huge(1.0_wp))
         value(at_first_yield) = outcome%reached(1)
         value(at_end) = summary%last_time
         value(at_time_step) = summary%time_step
         value(at_steps) = real(summary%steps, wp)
         value(at_events) = real(summary%events, wp)
         value(at_cut) = real(summary%cut_steps, wp)
         value(at_lost_joint) = real(summary%lost_joint, wp)
      end associate
   end subroutine settle

end module rbs_solve_ensemble_tally
