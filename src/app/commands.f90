!> The commands: from a case file to a csv and a summary.
module rbs_app_commands
   use, intrinsic :: iso_fortran_env, only: error_unit
   use rbs_app_progress, only: terminal_progress, say
   use rbs_app_signals, only: keep_if_stopped
   use rbs_base_error, only: error_type, message_list, fatal_error, bad_input
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: next_line, to_text, text_buffer
   use rbs_case_key_list, only: keys_as_json, keys_as_table
   use rbs_io_case_file, only: case_history, load_case
   use rbs_io_csv, only: csv_recorder
   use rbs_io_output_file, only: is_ours, partial
   use rbs_io_state_file, only: read_state, write_state
   use rbs_io_posix, only: exists, is_standard_output, same_file, standard_input
   use rbs_output_notes, only: drift_note, run_notes, structure_notes
   use rbs_output_channels, only: new_channels
   use rbs_output_summary, only: figure_type
   use rbs_solve_begin_make_structure, only: make_structure
   use rbs_solve_end_state, only: end_state
   use rbs_solve_static_run_static, only: run_static
   use rbs_solve_task, only: task_type
   use rbs_structure_structure, only: structure_type, finite
   use rbs_solve_time_effort, only: long_run_note
   use rbs_solve_time_march, only: initial_state
   use rbs_solve_time_plan, only: time_plan
   use rbs_solve_time_run_dynamic, only: plan_dynamic, run_dynamic
   use rbs_case_case_record, only: case_record
   use rbs_version, only: version
   implicit none
   private

   public :: run_case, check_case, show_keys

   !> Exit code of a run that ended because the user's criterion of collapse was met.
   integer, parameter :: column_collapsed = 3

   !> A case with its structure, its recorder and its summary.
   type :: run_type
      !> Path of the case
      character(len=:), allocatable :: path
      type(case_record) :: case
      type(case_history) :: history
      class(structure_type), allocatable :: structure
      type(csv_recorder) :: recorder
      type(task_type) :: task
   end type run_type

contains

   !> rbsdem run: solve a case, write its rows to a csv and print its summary.
   subroutine run_case(path, shown, output, quiet, error)
      !> Path of the case, and the path that messages call it by where the case comes from standard input
      character(len=*), intent(in) :: path, shown
      !> Path of the csv; not allocated: the path that the case gives, or the case's name with .csv
      character(len=:), allocatable, intent(in) :: output
      !> Whether there is no summary, no note and no progress
      logical, intent(in) :: quiet
      type(error_type), allocatable, intent(out) :: error
      type(run_type), target :: run
      type(message_list) :: notes
      type(error_type), allocatable :: closing
      character(len=:), allocatable :: file, kept_name

      call prepare(run, path, error)
      ! The name that the user knows, for the paths of files beside the case
      run%path = shown
      if (.not. allocated(error)) call output_path(file)
      if (.not. allocated(error)) call check_output()
      if (allocated(error)) return
      call solve()
      ! From here on a signal finds no unfinished file.
      call keep_if_stopped('', '')
      call run%recorder%file%close(.not. allocated(error), run%recorder%count > 0, closing)
      if (allocated(closing) .and. .not. allocated(error)) call move_alloc(closing, error)
      if (allocated(error)) then
         if (run%recorder%count == 0 .or. run%recorder%file%kept == '') return
         error%message = error%message//new_line('a')//'the '//to_text(run%recorder%count)// &
                         ' rows up to there are in '//run%recorder%file%kept
         return
      end if
      ! Among rows on standard output a summary would be in the way.
      if (.not. (quiet .or. is_standard_output(file))) then
         call print_summary()
         call structure_notes(run%case, run%structure, notes)
         call run_notes(run%structure, run%task%summary, run%recorder%spans, notes)
         ! Python gives the name of the case, as it does the rest itself.
         if (shown == path .and. run%case%judgement%asked()) then
            call notes%add('&target, &records and &assess are for the Python package: '// &
                           'python -m rbsdem run '//path)
         end if
         call print_notes(notes, error)
      end if
      if (.not. allocated(error)) call report_end(run, error)

   contains

      !> Solve the case and write its rows to a csv, and its last state to a file if the case asks for one.
      subroutine solve()
         type(terminal_progress), target :: progress
         type(time_plan) :: plan
         type(initial_state) :: at_rest
         character(len=:), allocatable :: note

         ! A static path is not planned; its method is as given.
         plan%method = run%case%analysis%method
         associate (case => run%case, structure => run%structure, history => run%history, &
                    recorder => run%recorder, task => run%task)
            if (allocated(case%analysis%initial)) then
               task%before = end_state()
               call read_state(from_case_folder(run%path, case%analysis%initial), task%before%stream, error)
               if (.not. allocated(error)) call task%before%check(structure, error)
               if (allocated(error)) return
            end if
            if (case%analysis%dynamic()) then
               call plan_dynamic(structure, case%analysis, history%time, history%loads, plan, error)
               if (allocated(error)) return
               call long_run_note(structure, plan, note)
               if (.not. (quiet .or. note == '')) then
                  write (error_unit, '(a)') 'rbsdem: note: '//note
                  flush (error_unit)
               end if
            end if
            recorder%units = case%units%system()
            recorder%channels = new_channels(structure, case%analysis%dynamic(), case%output%openings, &
                                             case%output%motion)
            call recorder%file%open(file, error)
            if (allocated(error)) return
            if (.not. (quiet .or. recorder%file%left == '')) then
               write (error_unit, '(a)') 'rbsdem: note: '//recorder%file%left//' has rows of a run '// &
                  'that was killed'
            end if
            call recorder%file%get_partial_name(kept_name)
            call keep_if_stopped(recorder%file%own, kept_name)
            call recorder%write_head(header(case, plan%method), error)
            if (allocated(error)) return
            call progress%start(quiet)
            task%recorder => run%recorder
            task%progress => progress
            task%every = case%output%every
            task%collapse_drift = case%analysis%collapse_drift
            task%most_seconds = case%analysis%max_seconds
            task%keeps_end = .true.
            if (case%analysis%dynamic()) then
               call run_dynamic(structure, case%analysis, plan, history%time, history%loads, at_rest, task, &
                                error)
            else
               call run_static(structure, case%analysis%method, &
                               any(case%loading(:case%loadings)%drive == 'force'), &
                               history%target, task, error, history%axial_load)
            end if
            call progress%finish()
            if (allocated(error) .or. .not. (allocated(case%output%state) .and. task%after%is_given())) return
            call write_state(from_case_folder(run%path, case%output%state), task%after%stream, error)
         end associate
      end subroutine solve

      !> Refuse files of output that would do harm: neither rows nor state may replace a file that the case
      !> was read from, nor rows a file of others whose name nobody gave.
      subroutine check_output()
         character(len=:), allocatable :: state

         ! A failed run keeps its rows in the file with the ending `partial`.
         if (is_input(file) .or. is_input(file//partial)) then
            call fatal_error(error, bad_input, 'output: '//file//' is an input of the case and would '// &
                             'be written over; choose another file with --output')
         else if (exists(file) .and. .not. (allocated(output) .or. allocated(run%case%output%file) .or. &
                                            is_ours(file))) then
            call fatal_error(error, bad_input, 'output: '//file//' is there and has no rows of rbsdem; '// &
                             'move it away, or name a file with --output')
         else if (allocated(run%case%output%state)) then
            state = from_case_folder(run%path, run%case%output%state)
            if (is_input(state) .or. same_file(state, file) .or. state == file) then
               call fatal_error(error, bad_input, 'output: state = '//run%case%output%state//' is an '// &
                                'input of the case or its file of rows; choose another name')
            end if
         end if
      end subroutine check_output

      !> Whether a path is that of the case itself, or of a history of it.
      logical function is_input(path)
         character(len=*), intent(in) :: path
         integer :: i

         is_input = same_file(path, standard_input(run%path))
         do i = 1, run%case%loadings
            if (.not. allocated(run%case%loading(i)%file)) cycle
            if (same_file(path, from_case_folder(run%path, run%case%loading(i)%file))) is_input = .true.
         end do
      end function is_input

      !> Path of the csv: that of the command line, else that of the case, else the case's name with .csv.
      subroutine output_path(path)
         character(len=:), allocatable, intent(out) :: path
         integer :: dot

         if (allocated(output)) then
            path = output
         else if (allocated(run%case%output%file)) then
            path = from_case_folder(run%path, run%case%output%file)
         else if (run%path == '-' .or. index(run%path, '/dev/') == 1 .or. index(run%path, '/proc/') == 1) then
            call fatal_error(error, bad_input, 'output: a case from '//standard_input(run%path)// &
                             ' has no name for its rows; give one with --output')
         else
            dot = index(run%path, '.', back=.true.)
            ! A dot at the begin of the name is no ending.
            if (dot <= index(run%path, '/', back=.true.) + 1) dot = len(run%path) + 1
            path = run%path(:dot - 1)//'.csv'
         end if
      end subroutine output_path

      !> Print the summary of a run without the values that do not apply to it; its end is reported apart.
      subroutine print_summary()
         type(figure_type), allocatable :: figures(:)
         character(len=28) :: name
         logical :: dynamic
         integer :: i

         dynamic = run%case%analysis%dynamic()
         call run%task%summary%get_figures(figures)
         if (run%case%title /= '') call say(run%case%title, error)
         name = 'method'
         call say('  '//name//'  '//method_text(run%task%summary%method, run%task%summary%reason), error)
         do i = 1, size(figures)
            associate (figure => figures(i))
               ! Figures of a lost joint are in the report of the end.
               if (figure%name == 'lost_joint') exit
               ! A static path has no steps in time, and an implicit method no stability limit.
               if (figure%unit == 's' .and. .not. figure%value > 0.0_wp) cycle
               ! Without inertia the base holds the force at the top; in time there mostly is none.
               if (figure%name == 'peak_base_shear' .and. .not. dynamic) cycle
               if (index(figure%name, 'peak_force') > 0 .and. dynamic .and. &
                   .not. abs(run%task%summary%peak_force) > 0.0_wp) cycle
               name = figure%name
               if (figure%unit /= '') name = trim(name)//'_'//figure%unit
               call say('  '//name//'  '//to_text(figure%value), error)
            end associate
         end do
         name = 'rows in'
         call say('  '//name//'  '//run%recorder%file%path, error)
      end subroutine print_summary

   end subroutine run_case

   !> Set the error of a run that ended at the user's criterion of collapse, or where a joint lost its axial
   !> load; the run itself has not failed, but the exit code says how it ended.
   subroutine report_end(run, error)
      type(run_type), intent(in) :: run
      type(error_type), allocatable, intent(inout) :: error
      character(len=:), allocatable :: text

      associate (summary => run%task%summary, fall => run%task%summary%fall)
         if (summary%status() == 'completed' .or. summary%stopped) return
         text = 'step '//to_text(nint(summary%last_time))
         if (run%case%analysis%dynamic()) text = 'time '//to_text(summary%last_time)//' s'
         if (summary%lost_joint > 0) then
            text = 'axial failure at '//text//': the layers of joint '// &
                   to_text(run%case%column%joint_number(summary%lost_joint))//' no longer carry the '// &
                   'axial load of '//to_text(fall%axial_load)//' N; at that rotation they carry at '// &
                   'most '//to_text(fall%capacity)//' N, and the joint would '
            if (fall%rests) then
               text = text//'rest after '//to_text(abs(fall%drop))//' m. The'
            else
               text = text//'fall without end. The'
            end if
         else if (summary%has_fallen()) then
            text = 'axial failure at '//text//': '//trim(summary%remark)//'; the'
         else if (summary%remark /= '') then
            text = 'collapsed: '//trim(summary%remark)//'; the'
         else if (run%structure%by_storeys) then
            text = 'collapsed at '//text//': the drift of a storey is beyond collapse_drift = '// &
                   to_text(run%case%analysis%collapse_drift)//'; the'
         else
            text = 'collapsed at '//text//': the top is at '//to_text(summary%peak_displacement)// &
                   ' m, beyond collapse_drift = '//to_text(run%case%analysis%collapse_drift)// &
                   ' of the height; the'
         end if
      end associate
      call fatal_error(error, column_collapsed, text//' rows up to there are in '//run%recorder%file%path)
   end subroutine report_end

   !> rbsdem check: report all errors of the input without solving the case.
   subroutine check_case(path, shown, quiet, as_json, error)
      !> Path of the case, and the path that messages call it by where the case comes from standard input
      character(len=*), intent(in) :: path, shown
      !> Whether only errors are printed, and whether all is printed as JSON
      logical, intent(in) :: quiet, as_json
      type(error_type), allocatable, intent(out) :: error
      type(run_type) :: run
      type(time_plan) :: plan
      type(message_list) :: notes
      type(text_buffer) :: buffer
      character(len=:), allocatable :: text

      call prepare(run, path, error)
      if (.not. allocated(error) .and. run%case%analysis%dynamic()) then
         call plan_dynamic(run%structure, run%case%analysis, run%history%time, run%history%loads, plan, error)
      end if
      if (allocated(error)) then
         if (as_json) call print_json()
         return
      end if
      call structure_notes(run%case, run%structure, notes)
      if (run%case%analysis%dynamic()) then
         call long_run_note(run%structure, plan, text)
         if (text /= '') call notes%add(text)
      else if (all(run%case%loading(:run%case%loadings)%drive /= 'force') .and. &
               run%structure%kinematics /= finite) then
         call drift_note(run%structure, maxval(abs(run%history%target)), notes)
      end if
      if (as_json) then
         call print_json()
      else if (.not. quiet) then
         call say(shown//': no errors', error)
         if (plan%reason /= '') call say('method: '//method_text(plan%method, plan%reason), error)
         call print_notes(notes, error)
      end if

   contains

      !> Print {"case": ..., "errors": [{"line": ..., "message": ...}], "method": ..., "notes": [...]}.
      subroutine print_json()
         type(error_type), allocatable :: printing

         call buffer%append('{"case": '//json_text(shown)//', "errors": [')
         if (allocated(error)) call append_lines(error%message, .true.)
         call buffer%append(']')
         if (plan%reason /= '') call buffer%append(', "method": '//json_text(trim(plan%method)))
         call buffer%append(', "notes": [')
         if (notes%count > 0) call append_lines(notes%text, .false.)
         call buffer%append(']}')
         call say(buffer%text(:buffer%length), printing)
         ! The message has been printed; the exit code stays.
         if (allocated(error)) error%message = ''
         if (allocated(printing)) call move_alloc(printing, error)
      end subroutine print_json

      !> Append the lines of a text to the JSON; errors with the line of the file that they name, or null.
      subroutine append_lines(message, numbered)
         character(len=*), intent(in) :: message
         !> Whether the lines are errors
         logical, intent(in) :: numbered
         character(len=:), allocatable :: number
         integer :: first, last, at, digits

         last = -1
         do while (next_line(message, first, last))
            if (first > 1) call buffer%append(', ')
            if (numbered) then
               number = 'null'
               at = index(message(first:last), ' line ') + first - 1
               if (at >= first) then
                  digits = verify(message(at + 6:last)//':', '0123456789') - 1
                  if (digits > 0) number = message(at + 6:at + 5 + digits)
               end if
               call buffer%append('{"line": '//number//', "message": '//json_text(message(first:last))//'}')
            else
               call buffer%append(json_text(message(first:last)))
            end if
         end do
      end subroutine append_lines

   end subroutine check_case

   !> rbsdem keys: print the keys of a case.
   subroutine show_keys(name, as_json, error)
      !> A group or a rule; empty for all of them
      character(len=*), intent(in) :: name
      logical, intent(in) :: as_json
      type(error_type), allocatable, intent(inout) :: error
      type(text_buffer) :: buffer

      if (as_json) then
         call keys_as_json(buffer)
      else
         call keys_as_table(name, buffer, error)
         if (allocated(error)) return
      end if
      call say(buffer%text(:buffer%length - 1), error)
   end subroutine show_keys

   !> Read a case and its loadings, and make its structure; all errors in them are returned as one.
   subroutine prepare(run, path, error)
      type(run_type), intent(inout) :: run
      !> Path of the case
      character(len=*), intent(in) :: path
      type(error_type), allocatable, intent(out) :: error

      run%path = path
      call load_case(path, run%case, run%history, error)
      if (.not. allocated(error)) call make_structure(run%case, run%structure, run%task%before, error)
   end subroutine prepare

   !> A path that is given from the folder of the case, as a path from the folder of the process.
   function from_case_folder(case_path, path) result(found)
      character(len=*), intent(in) :: case_path, path
      character(len=:), allocatable :: found

      found = path
      if (path(1:1) /= '/') found = case_path(:index(case_path, '/', back=.true.))//path
   end function from_case_folder

   !> Comment lines at the head of the csv.
   function header(case, method) result(lines)
      type(case_record), intent(in) :: case
      !> The method that is used, also where the program chooses it
      character(len=*), intent(in) :: method
      character(len=600) :: lines(3)
      character(len=:), allocatable :: kinematics, units

      units = 'SI'
      kinematics = trim(case%column%kinematics)
      if (allocated(case%frame)) kinematics = trim(case%frame%kinematics)
      if (case%units%force /= 'N' .or. case%units%length /= 'm') then
         units = trim(case%units%force)//', '//trim(case%units%length)//', else SI'
      end if
      lines(1) = 'rbsdem '//version
      lines(2) = 'case: '//case%title
      lines(3) = 'units: '//units//', in the names of the columns; method: '//trim(method)// &
                 ', kinematics: '//kinematics
   end function header

   !> A method for print, with the reason if the program chose it.
   function method_text(method, reason) result(text)
      character(len=*), intent(in) :: method, reason
      character(len=:), allocatable :: text

      text = trim(method)
      if (reason /= '') text = text//' ('//trim(reason)//')'
   end function method_text

   !> Print notes on input that is valid but may be a mistake, a line each.
   subroutine print_notes(notes, error)
      type(message_list), intent(in) :: notes
      type(error_type), allocatable, intent(inout) :: error
      integer :: first, last

      if (notes%count == 0) return
      last = -1
      do while (next_line(notes%text, first, last))
         call say('note: '//notes%text(first:last), error)
      end do
   end subroutine print_notes

   !> A text in quotes, with special characters as JSON has them.
   pure function json_text(text) result(quoted)
      character(len=*), intent(in) :: text
      character(len=:), allocatable :: quoted
      character(len=6) :: code
      integer :: i

      quoted = '"'
      do i = 1, len(text)
         if (text(i:i) == '"' .or. text(i:i) == '\') then
            quoted = quoted//'\'//text(i:i)
         else if (iachar(text(i:i)) < 32) then
            write (code, '(a, z4.4)') '\u', iachar(text(i:i))
            quoted = quoted//code
         else
            quoted = quoted//text(i:i)
         end if
      end do
      quoted = quoted//'"'
   end function json_text

end module rbs_app_commands
