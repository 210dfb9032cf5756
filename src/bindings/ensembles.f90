!> Ensembles from plain arrays into plain arrays, called by the procedures for f2py.
module rbs_bindings_ensembles
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
   use, intrinsic :: iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_bindings_runs, only: choose_method, watches_of
   use rbs_bindings_statements, only: column_from_statements
   use rbs_case_case_record, only: case_record
   use rbs_case_text_buffer, only: text_buffer
   use rbs_solve_ensemble_block, only: plan_column, run_block
   use rbs_solve_ensemble_outcome, only: outcome_type, measure_count
   use rbs_solve_ensemble_subject, only: ensemble_column, ensemble_motion, run_type
   use rbs_loading_loads, only: loads_type
   implicit none
   private

   public :: plan_ensemble, run_ensemble

   !> Stands after each statement and each message, and between the number of what has failed and its message.
   character(len=1), parameter :: after = achar(30), after_number = achar(31)

contains

   !> Expected seconds of each motion for each column, and what is wrong with the columns.
   subroutine plan_ensemble(statements, numbers, counts, watches, before, time, acceleration, points, &
                            seconds, in_lanes, text)
      !> Statements of the columns with their settings, each followed by `after`; all their numbers; how many
      !> numbers and watches each has, and numbers of the state that its runs begin in, 0 for rest (3,
      !> columns); the watches (6, all columns): state, joint, factors of slip, rotation and opening,
      !> threshold; all states
      character(len=*), intent(in) :: statements
      real(c_double), intent(in) :: numbers(:), watches(:, :), before(:)
      integer(c_int), intent(in) :: counts(:, :)
      !> All motions one after the other [s, m/s2], and the number of points of each (motions)
      real(c_double), intent(in) :: time(:), acceleration(:)
      integer(c_int), intent(in) :: points(:)
      !> (motions, columns) [s]
      real(c_double), intent(out) :: seconds(:, :)
      !> 1 where lanes take a run (motions, columns)
      integer(c_int), intent(out) :: in_lanes(:, :)
      !> Number of the column and message of each fault
      type(text_buffer), intent(inout) :: text
      type(ensemble_column), allocatable :: column(:)
      type(ensemble_motion), allocatable :: motion(:)
      type(error_type), allocatable :: error
      integer :: i, at(4)
      logical :: lanes_take(size(points))

      seconds = 0.0_wp
      in_lanes = 0
      call take_motions(time, acceleration, points, motion)
      allocate (column(1))
      at = 1
      do i = 1, size(counts, 2)
         call next_column(statements, numbers, counts(:, i), watches, before, at, motion(1), column(1), error)
         if (.not. allocated(error)) then
            call plan_column(column(1), motion, seconds(:, i), lanes_take, error)
            in_lanes(:, i) = merge(1, 0, lanes_take)
         end if
         if (allocated(error)) call text%append(to_text(i)//after_number//error%message//after)
      end do
   end subroutine plan_ensemble

   !> Runs, each of a column and a motion, into their fates and measures.
   subroutine run_ensemble(statements, numbers, counts, watches, before, time, acceleration, points, &
                           columns, motions, scales, level, control, fates, values, text)
      !> As for `plan_ensemble`
      character(len=*), intent(in) :: statements
      real(c_double), intent(in) :: numbers(:), watches(:, :), before(:)
      integer(c_int), intent(in) :: counts(:, :)
      real(c_double), intent(in) :: time(:), acceleration(:)
      integer(c_int), intent(in) :: points(:)
      !> Column, motion and factor of the accelerations (runs)
      integer(c_int), intent(in) :: columns(:), motions(:)
      real(c_double), intent(in) :: scales(:)
      !> See `run_block`
      integer(c_int), intent(in) :: level
      !> See `run_block`
      integer(c_int), intent(inout), volatile :: control(2)
      integer(c_int), intent(out) :: fates(:)
      !> (measures and, behind them, limit states but the first yield, runs)
      real(c_double), intent(out) :: values(:, :)
      !> Number of the run and message of each failure
      type(text_buffer), intent(inout) :: text
      type(ensemble_column), allocatable :: column(:)
      type(ensemble_motion), allocatable :: motion(:)
      type(run_type), allocatable :: run(:)
      type(outcome_type), allocatable :: outcome(:)
      type(error_type), allocatable :: error
      integer :: i, at(4)

      call take_motions(time, acceleration, points, motion)
      allocate (column(size(counts, 2)), run(size(columns)), outcome(size(columns)))
      at = 1
      do i = 1, size(column)
         call next_column(statements, numbers, counts(:, i), watches, before, at, motion(1), column(i), error)
         column(i)%states = 1 + size(values, 1) - measure_count
         if (allocated(error)) call move_alloc(error, column(i)%error)
      end do
      do i = 1, size(run)
         run(i) = run_type(columns(i), motions(i), scales(i))
      end do
      call run_block(column, motion, run, level, outcome, control)
      do i = 1, size(run)
         fates(i) = outcome(i)%fate
         values(:measure_count, i) = outcome(i)%value
         values(measure_count + 1:, i) = ieee_value(1.0_wp, ieee_quiet_nan)
         if (allocated(outcome(i)%reached)) values(measure_count + 1:, i) = outcome(i)%reached(2:)
         if (allocated(outcome(i)%message)) then
            call text%append(to_text(i)//after_number//outcome(i)%message//after)
         end if
      end do
   end subroutine run_ensemble

   subroutine take_motions(time, acceleration, points, motion)
      real(c_double), intent(in) :: time(:), acceleration(:)
      integer(c_int), intent(in) :: points(:)
      type(ensemble_motion), allocatable, intent(out) :: motion(:)
      integer :: j, first

      allocate (motion(size(points)))
      first = 1
      do j = 1, size(points)
         motion(j)%time = time(first:first + points(j) - 1)
         motion(j)%acceleration = acceleration(first:first + points(j) - 1)
         first = first + points(j)
      end do
   end subroutine take_motions

   !> The next column of the statements, with its settings.
   subroutine next_column(statements, numbers, counts, watches, before, at, motion, column, error)
      character(len=*), intent(in) :: statements
      real(c_double), intent(in) :: numbers(:), watches(:, :), before(:)
      !> Numbers and watches of the column, and numbers of its state
      integer(c_int), intent(in) :: counts(3)
      !> Where its statement, its numbers, its watches and its state begin; on return those of the column
      !> after it
      integer, intent(inout) :: at(4)
      !> Any of the motions
      type(ensemble_motion), intent(in) :: motion
      type(ensemble_column), intent(inout) :: column
      type(error_type), allocatable, intent(out) :: error
      type(case_record) :: case
      type(loads_type) :: loads
      integer :: last

      last = at(1) + index(statements(at(1):), after) - 2
      call column_from_statements(statements(at(1):last), numbers(at(2):at(2) + counts(1) - 1), &
                                  column%column, case, error)
      column%watch = watches_of(watches(:, at(3):at(3) + counts(2) - 1))
      if (allocated(column%before)) deallocate (column%before)
      if (counts(3) > 0) column%before = before(at(4):at(4) + counts(3) - 1)
      at = [last + 2, at(2) + counts(1), at(3) + counts(2), at(4) + counts(3)]
      if (allocated(error)) return
      loads%ground%value = motion%acceleration(:1)
      call choose_method(case, loads, error)
      column%analysis = case%analysis
   end subroutine next_column

end module rbs_bindings_ensembles
