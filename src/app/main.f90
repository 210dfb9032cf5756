!> The executable. Only this program prints errors and ends the process.
program rbsdem
   use, intrinsic :: iso_c_binding, only: c_int
   use, intrinsic :: iso_fortran_env, only: error_unit
   use rbs_app_command_line, only: command_type, read_command_line
   use rbs_app_commands, only: run_case, check_case, show_keys
   use rbs_app_progress, only: say
   use rbs_app_show_modes, only: show_modes
   use rbs_app_signals, only: prepare_process
   use rbs_base_error, only: error_type
   use rbs_base_text, only: next_line
   use rbs_version, only: version
   implicit none

   interface
      !> In C: end the process with a status, and print nothing.
      subroutine c_exit(status) bind(c, name='exit')
         import :: c_int
         integer(c_int), value :: status
      end subroutine c_exit
   end interface

   type(command_type) :: command
   type(error_type), allocatable :: error
   integer(c_int) :: status

   call prepare_process()
   call read_command_line(command, error)
   if (.not. allocated(error)) then
      select case (command%name)
      case ('run')
         call run_case(command%case, command%shown, command%output, command%quiet, error)
      case ('check')
         call check_case(command%case, command%shown, command%quiet, command%as_json, error)
      case ('modes')
         call show_modes(command%case, command%count, command%matrices, error)
      case ('keys')
         call show_keys(command%topic, command%as_json, error)
      case ('version')
         call say('rbsdem '//version, error)
      case default
         call print_help(command%topic, error)
      end select
   end if
   status = 0_c_int
   if (allocated(error)) then
      if (error%message /= '') call print_error(error%message)
      status = int(error%code, c_int)
   end if
   flush (error_unit)
   ! The process does not end by `stop`, which reports floating-point flags.
   call c_exit(status)

contains

   !> Print a message, each line after the name of the program.
   subroutine print_error(message)
      character(len=*), intent(in) :: message
      integer :: first, last

      last = -1
      do while (next_line(message, first, last))
         write (error_unit, '(a)') 'rbsdem: '//message(first:last)
      end do
   end subroutine print_error

   !> Print the help of a command, or the overview and the help of run.
   subroutine print_help(topic, error)
      !> The command; empty for all of them
      character(len=*), intent(in) :: topic
      type(error_type), allocatable, intent(inout) :: error
      character(len=*), parameter :: text(28) = [character(len=84) :: &
         'rbsdem '//version//': reinforced-concrete columns and planar frames', &
         '', &
         'usage:', &
         '  rbsdem run CASE.nml [--output FILE] [--quiet] [--report]  solve a case', &
         '  rbsdem check CASE.nml [--quiet] [--json]        find all errors of the input', &
         '  rbsdem modes CASE.nml [--count N] [--matrices]  natural frequencies, stable step', &
         '  rbsdem keys [NAME] [--json]                     keys of a group or rule, or all', &
         '  rbsdem COMMAND --help                           options of a command', &
         '  rbsdem --help | --version', &
         '', &
         'with the Python package also:', &
         '  rbsdem explore                                  a page to draw columns and frames', &
         '  rbsdem report CASE.nml                          a page on a case', &
         '  rbsdem draw CASE.nml                            springs of a frame of sections', &
         '  rbsdem trade CASE.nml                           error and time of the methods', &
         '  rbsdem ensemble CASE.nml RECORD ... --out DIR   many records', &
         '  rbsdem ida CASE.nml RECORD ...                  incremental dynamic analysis', &
         '  rbsdem peer DIR                                 columns beside their tests', &
         '  rbsdem predict DIR                              tests predicted from drawings', &
         '  rbsdem verify                                   printed numbers of others', &
         '  rbsdem completion SHELL                         completion of the command line', &
         '', &
         'A case of a column has the groups &case, &units, &column, &damping, &shear,', &
         '&flexure, &axial_spring, &layer_spring, &layers, &loading, &analysis and &output,', &
         'one of a frame &frame, &floor, &member_kind, &column_of, &beam_of and others in', &
         'place of &column and its springs. The input reference is docs/input.md, examples', &
         'are in examples/.', &
         '']
      integer :: i

      if (topic /= '') then
         call print_topic(topic, error)
         return
      end if
      do i = 1, size(text)
         call say(trim(text(i)), error)
      end do
      call print_topic('run', error)
   end subroutine print_help

   !> Print the help of one command.
   subroutine print_topic(topic, error)
      !> The command; keys, if it is none of the others
      character(len=*), intent(in) :: topic
      type(error_type), allocatable, intent(inout) :: error

      select case (topic)
      case ('run')
         call say('usage: rbsdem run CASE.nml [--output FILE] [--quiet] [--report[=FILE]]', error)
         call say('', error)
         call say('Solves a case, writes a row for each point or step kept, and prints a summary.', error)
         call say('CASE.nml may be -, which is standard input.', error)
         call say('', error)
         call say('  -o, --output FILE   file for the rows (default: the file of &output, or the', error)
         call say('                      name of the case with .csv); - is standard output', error)
         call say('  -q, --quiet         no summary, no notes and no progress', error)
         call say('  --report[=FILE]     a report too, of CASE.nml by default CASE.html; this, drawn', error)
         call say('                      members, &target, &records, &assess and &limit are done by', error)
         call say('                      the Python package, whose command is python -m rbsdem, too', error)
         call say('', error)
         call say('exit code:', error)
         call say('  0  all went well', error)
         call say('  1  the analysis failed; the rows before are in FILE.partial', error)
         call say('  2  the input is wrong; all its errors are listed', error)
         call say('  3  the column collapsed: collapse_drift was reached; all rows are written', error)
      case ('check')
         call say('usage: rbsdem check CASE.nml [--quiet] [--json]', error)
         call say('', error)
         call say('Reports all errors of a case with their lines, and what may be a mistake;', error)
         call say('solves nothing. For a run in time it says which method is chosen and why, and how', error)
         call say('long it will take if that is long.', error)
         call say('', error)
         call say('  -q, --quiet         print errors only', error)
         call say('  --json              errors with lines, method and notes as JSON', error)
         call say('', error)
         call say('Exit code: 0 no errors, 2 the input is wrong.', error)
      case ('modes')
         call say('usage: rbsdem modes CASE.nml [--count N] [--matrices]', error)
         call say('', error)
         call say('Prints frequency, period and circular frequency of the modes of the uncracked', error)
         call say('column as csv, then the longest step for which rk4 is stable.', error)
         call say('', error)
         call say('  --count N           the first N modes; without it all, for up to 500 bodies', error)
         call say('  --matrices          and the matrices of mass, stiffness, geometric stiffness and', error)
         call say('                      damping, in slips, relative rotations and openings', error)
         call say('', error)
         call say('Exit code: 0 all went well, 1 there are no modes, 2 the input is wrong.', error)
      case default
         call say('usage: rbsdem keys [NAME] [--json]', error)
         call say('', error)
         call say('Explains the keys of a case file: for a group as column, a rule of springs as', error)
         call say('takeda, or all of them, each key with kind, unit, bounds, default and meaning.', error)
         call say('', error)
         call say('  --json              as JSON, for programs', error)
         call say('', error)
         call say('With the Python package, rbsdem keys --schema prints a JSON schema of a case.', error)
      end select
   end subroutine print_topic

end program rbsdem
