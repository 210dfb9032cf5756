!> The commands: from a case file to a csv and a summary.
module rbs_app_run
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_null_char, c_ptr
   use rbs_app_progress, only: terminal_progress
   use rbs_app_say, only: say
   use rbs_base_constants, only: pi
   use rbs_base_error, only: error_type, message_list, fatal_error, bad_input
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_column_column, only: column_type
   use rbs_io_csv, only: csv_recorder
   use rbs_io_loading_file, only: loading_values
   use rbs_io_namelist, only: read_case
   use rbs_loading_protocol, only: protocol_values
   use rbs_loading_signal, only: signal_type
   use rbs_results_row, only: row_labels
   use rbs_results_summary, only: summary_type, summary_names
   use rbs_solve_history, only: initial_state
   use rbs_solve_modal, only: modes_type, find_modes
   use rbs_solve_run, only: make_column, run_static, plan_dynamic, run_dynamic, &
                            check_values
   use rbs_solve_time_plan, only: time_plan
   use rbs_spec_analysis, only: analysis_spec
   use rbs_spec_case, only: case_spec
   use rbs_spec_check, only: is_given
   use rbs_version, only: version
   implicit none
   private

   public :: run_case, check_case, show_modes

   !> The loadings of a case on common times.
   type :: loads_type
      real(wp), allocatable :: time(:)
      !> What is driven on a static path
      real(wp), allocatable :: target(:)
      type(signal_type) :: force, ground
   end type loads_type

   interface
      !> C: the path of a file that is there without links and dots; a null pointer if it is not.
      function c_realpath(path, real_path) bind(c, name='realpath') result(status)
         import :: c_char, c_ptr
         implicit none
         character(kind=c_char), intent(in) :: path(*)
         character(kind=c_char), intent(out) :: real_path(*)
         type(c_ptr) :: status
      end function c_realpath
   end interface

contains

   !> rbsdem run: solve a case and write its rows.
   subroutine run_case(path, output, quiet, error)
      character(len=*), intent(in) :: path
      !> Path of the csv; not allocated: what the case says, or the case's name with .csv
      character(len=:), allocatable, intent(in) :: output
      logical, intent(in) :: quiet
      type(error_type), allocatable, intent(out) :: error
      type(case_spec) :: case
      type(loads_type) :: loads
      type(column_type) :: column
      type(csv_recorder) :: recorder
      type(summary_type) :: summary
      type(error_type), allocatable :: closing
      character(len=:), allocatable :: file

      call prepare(path, case, column, loads, error)
      if (allocated(error)) return
      file = output_path(path, case, output)
      call check_output(file, path, case, error)
      if (allocated(error)) return
      call solve(case, column, loads, file, recorder, summary, quiet, error)
      call recorder%close(.not. allocated(error), closing)
      if (allocated(closing) .and. .not. allocated(error)) call move_alloc(closing, error)
      if (allocated(error)) then
         if (recorder%count > 0) then
            error%message = error%message//new_line('a')//'the '//to_text(recorder%count)// &
                            ' rows up to there are in '//recorder%path//'.partial'
         end if
         return
      end if
      if (.not. quiet) call print_summary(case, recorder, summary, error)
   end subroutine run_case

   !> rbsdem check: everything that can be wrong with the input, and nothing else.
   subroutine check_case(path, quiet, error)
      character(len=*), intent(in) :: path
      logical, intent(in) :: quiet
      type(error_type), allocatable, intent(out) :: error
      type(case_spec) :: case
      type(loads_type) :: loads
      type(column_type) :: column
      type(time_plan) :: plan
      real(wp) :: limit

      call prepare(path, case, column, loads, error)
      if (allocated(error)) return
      if (case%analysis%dynamic()) then
         call plan_dynamic(column, loads%time, case%analysis%dt, plan, limit, error)
         if (allocated(error)) return
      end if
      if (quiet) return
      call say(path//': no errors', error)
      call print_notes(case, error)
   end subroutine check_case

   !> rbsdem modes: frequencies, shapes of few joints, stable step.
   subroutine show_modes(path, error)
      character(len=*), intent(in) :: path
      type(error_type), allocatable, intent(out) :: error
      type(case_spec) :: case
      type(column_type) :: column
      type(modes_type) :: modes
      type(message_list) :: messages
      logical :: understood
      character(len=96) :: line
      real(wp) :: period
      integer :: i

      call read_case(path, case, messages, understood)
      call messages%raise(error)
      if (allocated(error)) return
      call make_column(case%column, column, error)
      if (allocated(error)) return
      call find_modes(column, modes, error)
      if (allocated(error)) return
      call say('mode,frequency_Hz,period_s,omega_rad/s', error)
      do i = 1, column%unknowns
         ! A column without stiffness to speak of has no period: its frequency is zero.
         period = 0.0_wp
         if (modes%omega(i) > tiny(1.0_wp)*1.0e3_wp) period = 2.0_wp*pi/modes%omega(i)
         write (line, '(i0, 3(a, es22.16e2))') i, ',', modes%omega(i)/(2.0_wp*pi), ',', period, ',', &
            modes%omega(i)
         call say(trim(line), error)
      end do
      write (line, '(a, es23.16e2)') '# stable step of rk4 [s]:', modes%stable_step
      call say(trim(line), error)
   end subroutine show_modes

   !> Read a case and its loadings; all their faults come back as one error.
   subroutine prepare(path, case, column, loads, error)
      character(len=*), intent(in) :: path
      type(case_spec), intent(out) :: case
      type(column_type), intent(out) :: column
      type(loads_type), intent(out) :: loads
      type(error_type), allocatable, intent(out) :: error
      type(message_list) :: messages
      logical :: understood

      call read_case(path, case, messages, understood)
      if (understood) call load_values(case, path(:index(path, '/', back=.true.)), loads, messages)
      call messages%raise(error)
      if (allocated(error)) return
      call make_column(case%column, column, error)
      if (allocated(error)) return
      call cut_duration(case%analysis, loads, error)
   end subroutine prepare

   !> Values of all loadings that are sound in themselves.
   subroutine load_values(case, folder, loads, messages)
      type(case_spec), intent(in) :: case
      character(len=*), intent(in) :: folder
      type(loads_type), intent(inout) :: loads
      type(message_list), intent(inout) :: messages
      type(error_type), allocatable :: fault
      type(message_list) :: own
      real(wp), allocatable :: time(:), value(:)
      integer :: i

      do i = 1, case%loadings
         associate (spec => case%loading(i))
            own = message_list()
            call spec%validate(case%analysis%dynamic(), own)
            if (own%count > 0) cycle                ! reported already
            if (spec%source == 'protocol') then
               ! The height is in the amplitudes; a wrong one has been reported.
               if (.not. ieee_is_finite(case%column%height)) cycle
               if (case%column%height <= 0.0_wp) cycle
               call protocol_values(spec, case%column%height, time, value, fault)
            else
               call loading_values(spec, folder, case%analysis%dynamic(), time, value, fault)
            end if
            if (.not. allocated(fault)) call check_values(value, 'loading: '//trim(spec%drive), fault)
            if (allocated(fault)) then
               call messages%add(fault%message)
               cycle
            end if
            if (spec%drive == 'force') loads%force = signal_type(time=time, value=value)
            if (spec%drive == 'ground') loads%ground = signal_type(time=time, value=value)
            call move_alloc(value, loads%target)
            call join_times(loads%time, time)
         end associate
      end do
      if (case%loadings == 0) then
         call messages%add('the case has no loading; give it a group &loading')
      end if
   end subroutine load_values

   !> Times of two loadings in one ascending list. Times that differ by round-off are one.
   subroutine join_times(all_times, more)
      real(wp), allocatable, intent(inout) :: all_times(:)
      real(wp), intent(in) :: more(:)
      real(wp), allocatable :: joined(:)
      real(wp) :: same
      integer :: i, j, n

      if (.not. allocated(all_times)) then
         all_times = more
         return
      end if
      allocate (joined(size(all_times) + size(more)))
      same = 1.0e-9_wp*min(minval(all_times(2:) - all_times(:size(all_times) - 1)), &
                           minval(more(2:) - more(:size(more) - 1)))
      i = 1
      j = 1
      n = 0
      do while (i <= size(all_times) .or. j <= size(more))
         n = n + 1
         if (j > size(more)) then
            joined(n) = all_times(i)
            i = i + 1
         else if (i > size(all_times)) then
            joined(n) = more(j)
            j = j + 1
         else
            joined(n) = min(all_times(i), more(j))
            if (.not. all_times(i) > joined(n) + same) i = i + 1
            if (.not. more(j) > joined(n) + same) j = j + 1
         end if
      end do
      all_times = joined(:n)
   end subroutine join_times

   !> End the times where the user wants: earlier, or later with the last value held.
   subroutine cut_duration(spec, loads, error)
      type(analysis_spec), intent(in) :: spec
      type(loads_type), intent(inout) :: loads
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: finish

      if (.not. spec%dynamic() .or. .not. is_given(spec%duration)) return
      finish = loads%time(1) + spec%duration
      if (.not. finish > loads%time(1)) then
         call fatal_error(error, bad_input, 'analysis: duration = '//to_text(spec%duration)// &
                          ' s is lost beside the time of the begin, '//to_text(loads%time(1))//' s')
         return
      end if
      loads%time = [pack(loads%time, loads%time < finish), finish]
   end subroutine cut_duration

   !> Solve into a csv.
   subroutine solve(case, column, loads, path, recorder, summary, quiet, error)
      type(case_spec), intent(in) :: case
      type(column_type), intent(in) :: column
      type(loads_type), intent(in) :: loads
      character(len=*), intent(in) :: path
      type(csv_recorder), intent(inout) :: recorder
      type(summary_type), intent(out) :: summary
      logical, intent(in) :: quiet
      type(error_type), allocatable, intent(out) :: error
      type(terminal_progress) :: progress
      type(time_plan) :: plan
      type(initial_state) :: at_rest
      real(wp) :: limit

      if (case%analysis%dynamic()) then
         call plan_dynamic(column, loads%time, case%analysis%dt, plan, limit, error)
         if (allocated(error)) return
      end if
      call recorder%open(path, header(case), row_labels(column%n, case%analysis%dynamic()), error)
      if (allocated(error)) return
      call progress%start(quiet)
      if (case%analysis%dynamic()) then
         call run_dynamic(column, plan, limit, loads%time, loads%force, loads%ground, at_rest, &
                          case%output%every, recorder, summary, error, progress)
      else
         call run_static(column, case%loading(1)%drive == 'force', loads%target, case%output%every, &
                         recorder, summary, error, progress)
      end if
      call progress%finish()
   end subroutine solve

   !> Comment lines of the csv.
   function header(case) result(lines)
      type(case_spec), intent(in) :: case
      character(len=600) :: lines(3)

      lines(1) = 'rbsdem '//version
      lines(2) = 'case: '//case%title
      lines(3) = 'units: SI, in the names of the columns; method: '//trim(case%analysis%method)// &
                 ', kinematics: '//trim(case%column%kinematics)
   end function header

   !> The rows must not go into a file that the case was read from.
   subroutine check_output(file, case_path, case, error)
      !> Where the rows are to go
      character(len=*), intent(in) :: file
      character(len=*), intent(in) :: case_path
      type(case_spec), intent(in) :: case
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: input
      integer :: i
      logical :: clash

      clash = same_file(file, case_path)
      do i = 1, case%loadings
         if (.not. allocated(case%loading(i)%file)) cycle
         input = case%loading(i)%file
         if (input(1:1) /= '/') input = case_path(:index(case_path, '/', back=.true.))//input
         if (same_file(file, input)) clash = .true.
      end do
      if (clash) then
         call fatal_error(error, bad_input, 'output: '//file//' is an input of the case and would '// &
                          'be written over; choose another file with --output')
      end if
   end subroutine check_output

   !> Whether two paths lead to one file that is there.
   logical function same_file(a, b)
      character(len=*), intent(in) :: a, b
      !> POSIX: no path is longer
      integer, parameter :: longest = 4097
      character(kind=c_char) :: real_a(longest), real_b(longest)

      real_a = c_null_char
      real_b = c_null_char
      same_file = .false.
      if (.not. c_associated(c_realpath(a//c_null_char, real_a))) return
      if (.not. c_associated(c_realpath(b//c_null_char, real_b))) return
      same_file = all(real_a(:findloc(real_a, c_null_char, dim=1)) == &
                      real_b(:findloc(real_a, c_null_char, dim=1)))
   end function same_file

   !> Where the rows go.
   function output_path(case_path, case, output) result(path)
      character(len=*), intent(in) :: case_path
      type(case_spec), intent(in) :: case
      character(len=:), allocatable, intent(in) :: output
      character(len=:), allocatable :: path
      integer :: dot, slash

      slash = index(case_path, '/', back=.true.)
      if (allocated(output)) then
         path = output
      else if (allocated(case%output%file)) then
         path = case%output%file
         if (path(1:1) /= '/') path = case_path(:slash)//path
      else
         dot = index(case_path, '.', back=.true.)
         if (dot <= slash + 1) dot = len(case_path) + 1
         path = case_path(:dot - 1)//'.csv'
      end if
   end function output_path

   !> The figures of a run that say something.
   subroutine print_summary(case, recorder, summary, error)
      type(case_spec), intent(in) :: case
      type(csv_recorder), intent(in) :: recorder
      type(summary_type), intent(in) :: summary
      type(error_type), allocatable, intent(inout) :: error
      character(len=28) :: name
      integer :: i

      if (case%title /= '') call say(case%title, error)
      associate (values => summary%as_array())
         do i = 1, size(values)
            ! Times of a static path and the like are no figures of it.
            if (.not. case%analysis%dynamic() .and. index(summary_names(i), 'step_s') > 0) cycle
            name = summary_names(i)
            call say('  '//name//'  '//to_text(values(i)), error)
         end do
      end associate
      name = 'rows in'
      call say('  '//name//'  '//recorder%path, error)
      call print_notes(case, error)
   end subroutine print_summary

   !> What is allowed and perhaps not meant.
   subroutine print_notes(case, error)
      type(case_spec), intent(in) :: case
      type(error_type), allocatable, intent(inout) :: error

      associate (column => case%column)
         if (column%kinematics == 'small' .and. &
             (abs(column%axial_load) > 0.0_wp .or. column%self_weight)) then
            call say('note: axial load and weight do no work with kinematics = '// &
                     "'small'; 'pdelta' takes them into account", error)
         end if
      end associate
   end subroutine print_notes

end module rbs_app_run
