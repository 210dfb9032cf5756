!> Ensembles for Python.
module rbs_bindings_ensembles
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
   use, intrinsic :: iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text, text_buffer
   use rbs_bindings_exchange, only: request_type, answer_type
   use rbs_bindings_runs, only: choose_method, watches_of
   use rbs_bindings_statements, only: structure_from_statements
   use rbs_case_case_record, only: case_record
   use rbs_solve_end_state, only: end_state
   use rbs_solve_ensemble_block, only: plan_column, run_block
   use rbs_solve_ensemble_run_result, only: run_result, measure_count
   use rbs_solve_ensemble_ensemble_input, only: ensemble_column, ensemble_motion, run_type
   use rbs_loading_loads, only: loads_type, horizontal
   implicit none
   private

   public :: plan_ensemble, run_ensemble

   !> End of each statement and each message, and mark between the number of a fault and its message.
   character(len=1), parameter :: after = achar(30), after_number = achar(31)

contains

   !> Expected time of each motion for each column, and messages on the columns. A row for each column:
   !> seconds of each motion, then for each motion 1 if lanes take it, else 0. Text: number of the column and
   !> message of each fault.
   subroutine plan_ensemble(request, answer)
      type(request_type), intent(in) :: request
      type(answer_type), intent(inout) :: answer
      type(ensemble_column), allocatable :: column(:)
      type(ensemble_motion), allocatable :: motion(:)
      type(error_type), allocatable :: error
      type(text_buffer) :: text
      integer :: i, at(4), motions, columns
      logical, allocatable :: in_lanes(:)

      call take_motions(request, motion)
      motions = size(motion)
      columns = size(request%array('counts'))/3
      allocate (column(1), in_lanes(motions))
      allocate (answer%rows(2*motions, columns), source=0.0_wp)
      ! Where the next column begins in statement, numbers, watches and states
      at = 1
      do i = 1, columns
         call next_column(request, i, at, motion(1), column(1), error)
         if (.not. allocated(error)) then
            call plan_column(column(1), motion, answer%rows(:motions, i), in_lanes, error)
            answer%rows(motions + 1:, i) = merge(1.0_wp, 0.0_wp, in_lanes)
         end if
         if (allocated(error)) call text%append(to_text(i)//after_number//error%message//after)
      end do
      if (text%length > 0) answer%text = text%text(:text%length)
   end subroutine plan_ensemble

   !> Runs, each of a column, a motion and a factor of the accelerations. A row for each run: its fate, its
   !> measures, for each limit state but the first yield the time when it is reached, then the largest drifts
   !> of the first storeys and their drifts at the end; not a number where there is none. Text: number of the
   !> run and message of each failure.
   subroutine run_ensemble(request, control, answer)
      type(request_type), intent(in) :: request
      !> Words that another thread sets and reads, see `run_block`
      integer(c_int), intent(inout), volatile :: control(2)
      type(answer_type), intent(inout) :: answer
      type(ensemble_column), allocatable :: column(:)
      type(ensemble_motion), allocatable :: motion(:)
      type(run_type), allocatable :: run(:)
      type(run_result), allocatable :: outcome(:)
      type(error_type), allocatable :: error
      type(text_buffer) :: text
      integer :: i, at(4), states, storeys, known

      call take_motions(request, motion)
      storeys = request%whole('storeys')
      ! The first yield is among the measures and the first of the states.
      states = 1 + request%whole('measures') - measure_count
      allocate (column(size(request%array('counts'))/3))
      at = 1
      do i = 1, size(column)
         call next_column(request, i, at, motion(1), column(i), error)
         column(i)%states = states
         if (allocated(error)) call move_alloc(error, column(i)%error)
      end do
      associate (columns => request%array('columns'), motions => request%array('motions'), &
                 scales => request%array('scales'))
         run = [(run_type(nint(columns(i)), nint(motions(i)), scales(i)), i=1, size(scales))]
         allocate (outcome(size(scales)))
      end associate
      call run_block(column, motion, run, request%whole('level'), outcome, control)
      allocate (answer%rows(measure_count + states + 2*storeys, size(run)), &
                source=ieee_value(1.0_wp, ieee_quiet_nan))
      do i = 1, size(run)
         answer%rows(1, i) = outcome(i)%fate
         answer%rows(2:measure_count + 1, i) = outcome(i)%value
         associate (row => answer%rows(:, i))
            if (allocated(outcome(i)%reached)) then
               row(measure_count + 2:measure_count + states) = outcome(i)%reached(2:)
            end if
            if (allocated(outcome(i)%storey)) then
               known = min(storeys, size(outcome(i)%storey)/2)
               associate (peaks => measure_count + states, half => size(outcome(i)%storey)/2)
                  row(peaks + 1:peaks + known) = outcome(i)%storey(:known)
                  row(peaks + storeys + 1:peaks + storeys + known) = outcome(i)%storey(half + 1:half + known)
               end associate
            end if
         end associate
         if (allocated(outcome(i)%message)) then
            call text%append(to_text(i)//after_number//outcome(i)%message//after)
         end if
      end do
      if (text%length > 0) answer%text = text%text(:text%length)
   end subroutine run_ensemble

   !> Take the motions, which follow each other in the arrays; `points` has two numbers for each motion:
   !> points along x, and along y, where there are none or as many.
   subroutine take_motions(request, motion)
      type(request_type), intent(in) :: request
      type(ensemble_motion), allocatable, intent(out) :: motion(:)
      real(c_double), pointer, contiguous :: points(:), time(:), acceleration(:), across(:)
      integer :: j, first, last, last_across

      points => request%array('points')
      time => request%array('time')
      acceleration => request%array('acceleration')
      across => request%array('across')
      allocate (motion(size(points)/2))
      last = 0
      last_across = 0
      do j = 1, size(motion)
         first = last + 1
         last = last + nint(points(2*j - 1))
         motion(j)%time = time(first:last)
         motion(j)%acceleration = acceleration(first:last)
         if (nint(points(2*j)) == 0) cycle
         first = last_across + 1
         last_across = last_across + nint(points(2*j))
         motion(j)%across = across(first:last_across)
      end do
   end subroutine take_motions

   !> Make the next column of the request. The statement holds the groups of all columns with their settings,
   !> those of each column followed by `after`; the arrays `watches` and `before` hold the limit states of all
   !> columns and the states that their runs begin in. `counts` says how many numbers, watches and numbers of
   !> its state a column has.
   subroutine next_column(request, number, at, motion, column, error)
      type(request_type), intent(in) :: request
      !> Number of the column
      integer, intent(in) :: number
      !> Where its statement, its numbers, its watches and its state begin; on return those of the column
      !> after it
      integer, intent(inout) :: at(4)
      !> Any of the motions
      type(ensemble_motion), intent(in) :: motion
      !> Filled here: structure, settings, limit states and state
      type(ensemble_column), intent(inout) :: column
      type(error_type), allocatable, intent(out) :: error
      type(case_record) :: case
      type(end_state) :: begin
      type(loads_type) :: loads
      integer :: next(4)

      associate (counts => request%array('counts'), watches => request%array('watches'), &
                 before => request%array('before'))
         next(1) = at(1) + index(request%statement(at(1):), after)
         ! A watch is six numbers.
         next(2:) = at(2:) + nint(counts(3*number - 2:3*number)*[1, 6, 1])
         ! Without the mark `after` at its end
         call structure_from_statements(request%statement(at(1):next(1) - 2), &
                                     request%number(at(2):next(2) - 1), column%structure, begin, case, error)
         column%watch = watches_of(watches(at(3):next(3) - 1))
         if (allocated(column%before)) deallocate (column%before)
         ! The state that the structure begins in, as under its dead load; one of the request replaces it.
         if (begin%is_given()) column%before = begin%stream%value(:begin%stream%count)
         if (next(4) > at(4)) column%before = before(at(4):next(4) - 1)
      end associate
      at = next
      if (allocated(error)) return
      ! Any motion will do: it only says that the ground moves, for the choice of the method.
      loads%signal(horizontal)%value = motion%acceleration(:1)
      call choose_method(case, loads, error)
      column%analysis = case%analysis
   end subroutine next_column

end module rbs_bindings_ensembles
