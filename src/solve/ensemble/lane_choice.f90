!> Which runs lanes can take.
module rbs_solve_ensemble_lane_choice
   use rbs_base_check, only: is_given
   use rbs_base_kinds, only: wp
   use rbs_structure_column_column, only: column_type, finite
   use rbs_solve_ensemble_ensemble_input, only: ensemble_column
   use rbs_solve_time_march, only: step_of
   use rbs_solve_time_plan, only: time_plan
   implicit none
   private

   public :: takes_lanes

contains

   !> Whether lanes can take a run: one body from rest, small rotations, a free top, joints that do not open
   !> and are not layered, all steps equal, lines changed at the end of a step, no bound by the clock.
   pure logical function takes_lanes(of_runs, plan, time)
      type(ensemble_column), intent(in) :: of_runs
      type(time_plan), intent(in) :: plan
      real(wp), intent(in) :: time(:)
      integer :: i

      takes_lanes = .false.
      if (allocated(of_runs%before) .or. is_given(of_runs%analysis%max_seconds)) return
      select type (column => of_runs%structure)
      class is (column_type)
         if (column%unknowns /= 2 .or. column%held .or. column%kinematics == finite) return
         if (any(column%rules%name == 'layered')) return
      class default
         return
      end select
      select case (plan%method)
      case ('rk4')
         if (plan%located .or. of_runs%analysis%events == 'located') return
      case ('newmark', 'hht', 'generalised_alpha')
         continue
      case default
         return
      end select
      if (plan%free .or. abs(time(1)) > 0.0_wp) return
      if (any(plan%parts /= plan%parts(1))) return
      do i = 1, size(time) - 1
         if (abs(step_of(plan, (time(i + 1) - time(i))/plan%parts(1)) - plan%dt) > 0.0_wp) return
      end do
      takes_lanes = .true.
   end function takes_lanes

end module rbs_solve_ensemble_lane_choice
