!> Runs in lanes: columns that advance side by side; a lane that is done takes the next run.
module rbs_solve_ensemble_lane_runs
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_solve_ensemble_chain_team, only: chain_team, new_chain_team
   use rbs_solve_ensemble_dispatch, only: chosen_kernel
   use rbs_solve_ensemble_lane_choice, only: is_plain_body
   use rbs_solve_ensemble_lane_fields, only: lanes
   use rbs_solve_ensemble_motions, only: motion_table, fill_table
   use rbs_solve_ensemble_one_body_team, only: one_body_team, new_one_body_team
   use rbs_solve_ensemble_outcome, only: outcome_type, fate_failed
   use rbs_solve_ensemble_subject, only: ensemble_column, ensemble_motion, run_type, lane_task
   use rbs_solve_ensemble_team, only: team_type
   implicit none
   private

   public :: run_in_lanes

contains

   !> Run tasks of one method, with columns that are alike, in lanes; a lane that is done takes the next.
   subroutine run_in_lanes(column, motion, run, task, level, outcome, control)
      type(ensemble_column), intent(in) :: column(:)
      type(ensemble_motion), intent(in) :: motion(:)
      type(run_type), intent(in) :: run(:)
      type(lane_task), intent(in) :: task(:)
      !> Of the kernel, see `chosen_kernel`
      integer, intent(in) :: level
      type(outcome_type), intent(inout) :: outcome(:)
      !> See `run_block`
      integer, intent(inout), volatile :: control(2)
      ! Of both, which are large, one is made. A polymorphic team would need no choice here, but the compiler
      ! (gfortran 12) spoils the memory where it deallocates one.
      type(one_body_team), allocatable, target :: bodies
      type(chain_team), allocatable :: chains

      if (size(task) == 0) return
      associate (first => column(run(task(1)%run)%column))
         if (is_plain_body(first)) then
            allocate (bodies)
            call new_one_body_team(bodies)
            call run_team(bodies, column, motion, run, task, level, outcome, control)
         else
            allocate (chains)
            call new_chain_team(chains, first%column)
            call run_team(chains, column, motion, run, task, level, outcome, control)
         end if
      end associate
   end subroutine run_in_lanes

   subroutine run_team(team, column, motion, run, task, level, outcome, control)
      class(team_type), intent(inout) :: team
      !> See `run_in_lanes`
      type(ensemble_column), intent(in) :: column(:)
      type(ensemble_motion), intent(in) :: motion(:)
      type(run_type), intent(in) :: run(:)
      type(lane_task), intent(in) :: task(:)
      integer, intent(in) :: level
      type(outcome_type), intent(inout) :: outcome(:)
      integer, intent(inout), volatile :: control(2)
      type(motion_table) :: table
      integer :: next, busy, l

      team%kernel = chosen_kernel(level)
      allocate (team%lane(lanes))
      call fill_table(motion, table)
      next = 0
      busy = 0
      do l = 1, lanes
         call refill(l)
      end do
      do while (busy > 0)
         call advance_all()
      end do

   contains

      !> One step of all lanes.
      subroutine advance_all()
         integer :: count, list(lanes), failed, fails(lanes), j
         type(error_type), allocatable :: error

         call team%advance(count, list)
         failed = 0
         do j = 1, count
            call team%go_on(list(j), error)
            if (.not. allocated(error)) cycle
            failed = failed + 1
            fails(failed) = list(j)
            call fail(team%lane(list(j))%task, error)
            call team%leave(list(j))
         end do
         call team%finish(table, count, list)
         do j = 1, count
            associate (this => task(team%lane(list(j))%task))
               call team%settle(list(j), this, outcome(this%run))
            end associate
            call free(list(j))
         end do
         do j = 1, failed
            call free(fails(j))
         end do
      end subroutine advance_all

      !> A run has failed.
      subroutine fail(place, error)
         integer, intent(in) :: place
         type(error_type), intent(in) :: error

         associate (result => outcome(task(place)%run))
            result%fate = fate_failed
            result%message = error%message
            result%value = ieee_value(1.0_wp, ieee_quiet_nan)
         end associate
      end subroutine fail

      !> A run is done.
      subroutine free(l)
         integer, intent(in) :: l

         control(2) = control(2) + 1
         busy = busy - 1
         call team%leave(l)
         team%lane(l)%task = 0
         call refill(l)
      end subroutine free

      !> Put the next run into a lane, if there is one.
      subroutine refill(l)
         integer, intent(in) :: l
         type(error_type), allocatable :: error

         do while (next < size(task) .and. control(1) == 0)
            next = next + 1
            team%lane(l)%task = next
            associate (this => run(task(next)%run))
               call team%enter(l, column(this%column), motion(this%motion), table%first(this%motion), &
                               task(next), error)
            end associate
            if (.not. allocated(error)) then
               busy = busy + 1
               return
            end if
            call fail(next, error)
            control(2) = control(2) + 1
            call team%leave(l)
            team%lane(l)%task = 0
         end do
      end subroutine refill

   end subroutine run_team

end module rbs_solve_ensemble_lane_runs
