!> Analyses from plain arrays into plain arrays, called by the procedures for f2py.
module rbs_bindings_runs
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
   use, intrinsic :: iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type, message_list, fatal_error, bad_input
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_case_case_record, only: case_record
   use rbs_column_column, only: column_type
   use rbs_loading_loading_record, only: loading_record
   use rbs_loading_protocol, only: protocol_values
   use rbs_loading_signal, only: signal_type
   use rbs_output_notes, only: rotation_note
   use rbs_output_recorder, only: array_recorder
   use rbs_output_summary, only: summary_type
   use rbs_solve_end_state, only: end_state
   use rbs_solve_static_run_static, only: run_static
   use rbs_solve_task, only: task_type
   use rbs_solve_time_effort, only: expected_seconds, long_run_note, patience
   use rbs_loading_loads, only: loads_type
   use rbs_solve_time_march, only: initial_state
   use rbs_solve_time_plan, only: time_plan
   use rbs_solve_time_run_dynamic, only: run_dynamic, plan_dynamic
   use rbs_solve_time_sight, only: sight_type, watch_type
   implicit none
   private

   public :: into_rows_static, into_rows_dynamic, make_loads, choose_method, protocol_from_numbers, tell, &
             tell_run, watches_of

   !> Status of a run that needs more rows than the array has; 0 to 2 are those of an error.
   integer(c_int), parameter, public :: little_room = 3

   !> Status of a long run of which the user has not been told yet.
   integer(c_int), parameter, public :: long_run = 4

contains

   !> Write the rows of a static path into an array.
   subroutine into_rows_static(column, case, by_force, target_values, axial_load, before, corners, rows, &
                               count, after, ended, summary, error)
      type(column_type), intent(in) :: column
      !> Settings of analysis and output
      type(case_record), intent(inout) :: case
      logical, intent(in) :: by_force
      real(c_double), intent(in) :: target_values(:)
      !> Axial load at each of them; empty: constant
      real(c_double), intent(in) :: axial_load(:)
      !> The state to begin in; empty: virgin
      real(c_double), intent(in) :: before(:)
      !> Whether the corners between two targets have rows too
      logical, intent(in) :: corners
      real(c_double), intent(inout), target, contiguous :: rows(:, :)
      !> Rows that there are; those for which there was room are filled
      integer, intent(out) :: count
      !> The state at the end, and how many numbers it has: 0 if there is none; if it has no room it is not
      !> filled
      real(c_double), intent(inout) :: after(:)
      integer(c_int), intent(out) :: ended
      type(summary_type), intent(out) :: summary
      type(error_type), allocatable, intent(out) :: error
      type(array_recorder), target :: recorder
      type(task_type) :: task

      count = 0
      ended = 0
      case%analysis%method = 'static'
      call check_settings(case, error)
      if (allocated(error)) return
      recorder%rows => rows
      recorder%openings = case%output%openings .and. .not. column%opens
      recorder%corners = corners
      task%recorder => recorder
      task%every = case%output%every
      task%collapse_drift = case%analysis%collapse_drift
      task%keeps_end = .true.
      call take_from(before, task%before)
      call run_static(column, by_force, target_values, task, error, axial_load)
      summary = task%summary
      count = recorder%offered
      call hand_over(task%after, after, ended)
   end subroutine into_rows_static

   !> A state from the numbers of the user.
   subroutine take_from(numbers, state)
      real(c_double), intent(in) :: numbers(:)
      type(end_state), intent(inout) :: state

      if (size(numbers) == 0) return
      state%stream%value = numbers
      state%stream%count = size(numbers)
   end subroutine take_from

   !> A state into an array of the user, if there is room.
   subroutine hand_over(state, numbers, count)
      type(end_state), intent(in) :: state
      real(c_double), intent(inout) :: numbers(:)
      integer(c_int), intent(out) :: count

      count = state%stream%count
      if (count > 0 .and. count <= size(numbers)) numbers(:count) = state%stream%value(:count)
   end subroutine hand_over

   !> Validate the case without its column.
   subroutine check_settings(case, error)
      type(case_record), intent(inout) :: case
      type(error_type), allocatable, intent(out) :: error
      type(message_list) :: messages

      call case%analysis%validate(messages)
      call case%output%check('output', messages)
      call messages%raise(error)
   end subroutine check_settings

   !> Choose the method of an analysis in time if the user has not named one, and check its settings.
   subroutine choose_method(case, loads, error)
      type(case_record), intent(inout) :: case
      type(loads_type), intent(in) :: loads
      type(error_type), allocatable, intent(out) :: error

      if (case%analysis%method == 'static') then
         call fatal_error(error, bad_input, &
                          "analysis: method = 'static' takes no time; call cyclic, or set "// &
                          "method = 'auto'")
      else if (case%analysis%method == '' .and. loads%force%acts() .and. .not. &
               (loads%ground%acts() .or. loads%vertical%acts())) then
         call fatal_error(error, bad_input, 'analysis: a force with time needs a method that is named: '// &
                          "method = 'auto', or cyclic for the path without inertia")
      else
         if (case%analysis%method == '') case%analysis%method = 'auto'
         call check_settings(case, error)
      end if
   end subroutine choose_method

   !> Write the rows of a response in time into an array.
   subroutine into_rows_dynamic(column, case, time, loads, initial_values, opening_given, before, watches, &
                                rows, count, after, ended, reached, summary, enough, told, note, error)
      type(column_type), intent(in) :: column
      !> Settings of analysis and output
      type(case_record), intent(in) :: case
      real(c_double), intent(in) :: time(:)
      type(loads_type), intent(in) :: loads
      !> Deformations, then velocities (2 unknowns); empty: at rest
      real(c_double), intent(in) :: initial_values(:)
      logical, intent(in) :: opening_given
      !> The state to begin in; empty: that of `initial_values`
      real(c_double), intent(in) :: before(:)
      !> See `watches_of` (6, watches)
      real(c_double), intent(in) :: watches(:, :)
      real(c_double), intent(inout), target, contiguous :: rows(:, :)
      !> Rows kept; if the array is too small, nothing is solved and this is the number of rows needed
      integer, intent(out) :: count
      !> The state at the end, and how many numbers it has: 0 if there is none; if it has no room it is not
      !> filled
      real(c_double), intent(inout) :: after(:)
      integer(c_int), intent(out) :: ended
      !> When each state that is watched for is reached first [s] and the displacement of the top then [m],
      !> not a number if it is not (2, watches)
      real(c_double), intent(out) :: reached(:, :)
      type(summary_type), intent(out) :: summary
      logical, intent(out) :: enough
      !> Whether the user has been told how long the run takes; if not, the note is allocated for a long
      !> run, and nothing is solved
      logical, intent(in) :: told
      character(len=:), allocatable, intent(out) :: note
      type(error_type), allocatable, intent(out) :: error
      type(array_recorder) :: recorder
      type(initial_state) :: initial
      type(time_plan) :: plan
      type(end_state) :: from, at_end
      type(sight_type) :: sight

      count = 0
      ended = 0
      enough = .true.
      reached = ieee_value(1.0_wp, ieee_quiet_nan)
      call plan_dynamic(column, case%analysis, time, loads, plan, error)
      if (allocated(error)) return
      if (.not. told .and. expected_seconds(column, plan) >= patience) then
         call long_run_note(column, plan, note)
         return
      end if
      enough = size(rows, 2) >= plan%rows(case%output%every)
      if (.not. enough) then
         count = plan%rows(case%output%every)
         return
      end if
      if (size(initial_values) > 0) then
         initial%deformation = initial_values(:column%unknowns)
         initial%velocity = initial_values(column%unknowns + 1:)
         initial%opening_given = opening_given
      end if
      recorder%rows => rows
      recorder%motion = case%output%motion
      recorder%openings = case%output%openings .and. .not. column%opens
      call take_from(before, from)
      call sight%watch_for(watches_of(watches), size(watches, 2))
      call run_dynamic(column, case%analysis, plan, time, loads, initial, case%output%every, recorder, &
                       summary, error, before=from, after=at_end, sight=sight)
      count = recorder%count
      call hand_over(at_end, after, ended)
      where (sight%reached < huge(1.0_wp))
         reached(1, :) = sight%reached
         reached(2, :) = sight%top
      end where
   end subroutine into_rows_dynamic

   !> What to watch for, from the numbers of the user: state, joint, factors of slip, rotation and opening,
   !> threshold of each (6, watches).
   pure function watches_of(numbers) result(watch)
      real(c_double), intent(in) :: numbers(:, :)
      type(watch_type) :: watch(size(numbers, 2))
      integer :: i

      do i = 1, size(watch)
         associate (given => numbers(:, i))
            watch(i) = watch_type(state=nint(given(1)), joint=nint(given(2)), slip=given(3), &
                                  rotation=given(4), opening=given(5), threshold=given(6))
         end associate
      end do
   end function watches_of

   !> The excitation, from one column of values for each drive.
   subroutine make_loads(loads, drives, time, load, error)
      type(loads_type), intent(out) :: loads
      !> Names of the drives, separated by blanks
      character(len=*), intent(in) :: drives
      real(c_double), intent(in) :: time(:)
      !> Values (m, drives)
      real(c_double), intent(in) :: load(:, :)
      type(error_type), allocatable, intent(out) :: error
      integer :: i, first, last

      first = 1
      do i = 1, size(load, 2)
         last = index(drives(first:)//' ', ' ') + first - 2
         associate (drive => drives(first:last))
            if (drive == 'force') call make_signal(loads%force, drive, time, load(:, i), error)
            if (drive == 'ground_acceleration') call make_signal(loads%ground, drive, time, load(:, i), error)
            if (drive == 'vertical_acceleration') then
               call make_signal(loads%vertical, drive, time, load(:, i), error)
            end if
            if (drive == 'axial_load') call make_signal(loads%axial, drive, time, load(:, i), error)
         end associate
         if (allocated(error)) return
         first = last + 2
      end do
   end subroutine make_loads

   subroutine make_signal(made, name, time, value, error)
      type(signal_type), intent(out) :: made
      character(len=*), intent(in) :: name
      real(c_double), intent(in) :: time(:), value(:)
      type(error_type), allocatable, intent(out) :: error

      if (size(value) /= size(time)) then
         call fatal_error(error, bad_input, name//': '//to_text(size(value))//' values for '// &
                          to_text(size(time))//' times; give one for each')
         return
      end if
      made%time = time
      made%value = value
   end subroutine make_signal

   !> Points of a cyclic protocol, in the unit of the amplitudes.
   subroutine protocol_from_numbers(amplitudes, negative, cycles, repeats, points, values, error)
      real(c_double), intent(in) :: amplitudes(:)
      !> Those of the other side; empty: the same
      real(c_double), intent(in) :: negative(:)
      integer(c_int), intent(in) :: cycles(:), repeats, points
      !> Filled up to the number of points
      real(c_double), intent(out) :: values(:)
      type(error_type), allocatable, intent(out) :: error
      type(loading_record) :: spec
      type(message_list) :: messages
      real(wp), allocatable :: time(:), made(:)

      values = 0.0_wp
      spec%drive = 'force'
      spec%source = 'protocol'
      spec%amplitudes = amplitudes
      if (size(negative) > 0) spec%negative_amplitudes = negative
      spec%cycles = cycles
      spec%repeats = repeats
      spec%points = points
      call spec%validate(.false., messages)
      call messages%raise(error)
      if (allocated(error)) return
      call protocol_values(spec, 1.0_wp, time, made, error)
      if (.not. allocated(error)) values = made(:size(values))
   end subroutine protocol_from_numbers

   !> Status and text of an error; 0 and blank if there is no error.
   subroutine tell(error, status, message)
      type(error_type), allocatable, intent(in) :: error
      integer(c_int), intent(out) :: status
      character(len=*), intent(out) :: message

      status = 0
      message = ''
      if (.not. allocated(error)) return
      status = error%code
      message = error%message
   end subroutine tell

   !> The same for a run; a successful run may have a note as its message.
   subroutine tell_run(column, summary, error, figures, method, status, message)
      type(column_type), intent(in) :: column
      type(summary_type), intent(in) :: summary
      type(error_type), allocatable, intent(in) :: error
      real(c_double), intent(out) :: figures(:)
      !> Method that was used, followed by the reason if the program chose it
      character(len=*), intent(out) :: method
      integer(c_int), intent(out) :: status
      character(len=*), intent(out) :: message
      character(len=:), allocatable :: note

      figures = summary%as_array()
      method = summary%method//summary%reason
      call tell(error, status, message)
      if (status /= 0) return
      call rotation_note(column, summary, note)
      message = note
   end subroutine tell_run

end module rbs_bindings_runs
