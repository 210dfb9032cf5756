!> Which runs lanes can take, and which of them together.
module rbs_solve_ensemble_lane_choice
   use rbs_base_kinds, only: wp
   use rbs_structure_column_column, only: column_type, finite
   use rbs_solve_ensemble_ensemble_input, only: ensemble_column
   use rbs_solve_time_march, only: step_of
   use rbs_solve_time_plan, only: time_plan
   implicit none
   private

   public :: takes_lanes, are_alike, is_plain_body

   !> In longer chains some spring leaves its line in most steps of the length that implicit methods take, and
   !> lanes gain nothing.
   integer, parameter :: most_bodies = 4

contains

   !> Whether lanes can take a run: from rest, small rotations, a free top, joints that do not open and are
   !> not layered, all steps equal, lines changed at the end of a step; implicit methods with few bodies.
   pure logical function takes_lanes(of_runs, plan, time)
      type(ensemble_column), intent(in) :: of_runs
      type(time_plan), intent(in) :: plan
      real(wp), intent(in) :: time(:)
      integer :: i

      takes_lanes = .false.
      if (allocated(of_runs%before)) return
      select type (column => of_runs%structure)
      class is (column_type)
         if (column%opens .or. column%held .or. column%kinematics == finite) return
         if (any(column%rules%name == 'layered')) return
      class default
         return
      end select
      select case (plan%method)
      case ('rk4')
         if (plan%located .or. of_runs%analysis%events == 'located') return
      case ('newmark', 'hht', 'generalised_alpha')
         if (of_runs%structure%n > most_bodies) return
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

   !> Whether a column is one body without damping: such columns have lanes of their own.
   pure logical function is_plain_body(column)
      type(column_type), intent(in) :: column

      is_plain_body = column%unknowns == 2 .and. .not. column%damped
   end function is_plain_body

   !> Whether the runs of two columns can advance side by side.
   pure logical function are_alike(one, other)
      type(column_type), intent(in) :: one, other

      are_alike = one%n == other%n .and. (one%damped .eqv. other%damped) .and. &
                  (allocated(one%modal_damping) .eqv. allocated(other%modal_damping))
   end function are_alike

end module rbs_solve_ensemble_lane_choice
