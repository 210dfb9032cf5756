!> Which runs lanes can take, and which of them together.
module rbs_solve_ensemble_lane_choice
   use rbs_base_kinds, only: wp
   use rbs_column_column, only: finite
   use rbs_solve_ensemble_subject, only: ensemble_column
   use rbs_solve_time_march, only: step_of
   use rbs_solve_time_plan, only: time_plan
   use rbs_solve_time_sight, only: watch_type
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
      associate (column => of_runs%column)
         if (column%opens .or. column%held .or. column%kinematics == finite) return
         if (any(column%spring%rule == 'layered')) return
         ! Lanes of chains have not the bits of the steps that are made for one body without damping.
         if (column%unknowns == 2 .and. .not. column%damped .and. .not. is_plain_body(of_runs)) return
      end associate
      select case (plan%method)
      case ('rk4')
         if (plan%located .or. of_runs%analysis%events == 'located') return
      case ('newmark', 'hht', 'generalised_alpha')
         if (of_runs%column%n > most_bodies) return
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

   !> Whether a column is one body without damping that is watched for nothing but yield at a rotation: such
   !> columns have lanes of their own.
   pure logical function is_plain_body(of_runs)
      type(ensemble_column), intent(in) :: of_runs

      is_plain_body = of_runs%column%unknowns == 2 .and. .not. of_runs%column%damped
      if (is_plain_body) is_plain_body = one_rotation(of_runs%watch)
   end function is_plain_body

   !> Whether all that is watched is yield at one rotation to both sides, or nothing.
   pure logical function one_rotation(watch)
      type(watch_type), intent(in) :: watch(:)

      one_rotation = size(watch) == 0
      if (size(watch) /= 2) return
      one_rotation = all(watch%state == 1 .and. abs(watch%slip) <= 0.0_wp &
                         .and. abs(watch%opening) <= 0.0_wp) &
                     .and. abs(watch(1)%rotation + watch(2)%rotation) <= 0.0_wp &
                     .and. abs(watch(1)%threshold - watch(2)%threshold) <= 0.0_wp
   end function one_rotation

   !> Whether the runs of two columns can advance side by side.
   pure logical function are_alike(one, other)
      type(ensemble_column), intent(in) :: one, other

      are_alike = one%column%n == other%column%n .and. &
                  (one%column%damped .eqv. other%column%damped) .and. &
                  (allocated(one%column%modal_damping) .eqv. allocated(other%column%modal_damping)) .and. &
                  (is_plain_body(one) .eqv. is_plain_body(other))
   end function are_alike

end module rbs_solve_ensemble_lane_choice
