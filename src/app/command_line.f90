!> The command line: command, paths and options.
module rbs_app_command_line
   use rbs_base_error, only: error_type, fatal_error, bad_input
   use rbs_base_text, only: suggestion
   implicit none
   private

   public :: command_type, read_command_line

   !> Words that a misspelt one is compared with
   character(len=9), parameter :: commands(4) = ['run  ', 'check', 'modes', 'keys ']
   character(len=10), parameter :: options(8) = ['--output  ', '--quiet   ', '--json    ', '--count   ', &
              '--matrices', '--as      ', '--help    ', '--version ']

   !> A command of the user, with its options.
   type :: command_type
      !> run, check, modes, keys, help or version
      character(len=:), allocatable :: name
      !> The command that help is asked for, or the group or rule whose keys are; empty: all of them
      character(len=:), allocatable :: topic
      !> Path of the case
      character(len=:), allocatable :: case
      !> Path that the case is called by where it comes from standard input
      character(len=:), allocatable :: shown
      !> Path of the output; not allocated: the path that the case gives
      character(len=:), allocatable :: output
      !> run and check: no summary, no notes and no progress
      logical :: quiet = .false.
      !> keys: as JSON, else as a table; check: as JSON, else in words
      logical :: as_json = .false.
      !> modes: how many, the lowest first (0: all), and whether the matrices are printed too
      integer :: count = 0
      logical :: matrices = .false.
   end type command_type

contains

   !> Read the arguments of the process, and refuse what does not belong together.
   subroutine read_command_line(command, error)
      type(command_type), intent(out) :: command
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: word
      integer :: i

      if (command_argument_count() == 0) then
         call complain('no command')
         return
      end if
      i = 0
      do while (i < command_argument_count())
         i = i + 1
         word = argument(i)
         if (len(word) > 1 .and. index(word, '-') == 1) then
            call take_option()
         else
            call take_word()
         end if
         if (allocated(error)) return
      end do
      call check_whole()

   contains

      !> Take a word that begins with a dash.
      subroutine take_option()
         character(len=:), allocatable :: value
         integer :: mark, status

         ! '--count=3' has its value behind the sign, '--count 3' in the next argument.
         mark = index(word//'=', '=')
         select case (word(:mark - 1))
         case ('-h', '--help')
            if (allocated(command%name)) command%topic = command%name
            command%name = 'help'
         case ('--version')
            command%name = 'version'
         case ('-q', '--quiet')
            command%quiet = .true.
         case ('--json')
            command%as_json = .true.
         case ('--matrices')
            command%matrices = .true.
         case ('--count', '-o', '--output', '--as')
            ! With the sign at the end of the word there is no value.
            if (mark < len(word)) then
               value = word(mark + 1:)
            else if (mark > len(word) .and. i < command_argument_count()) then
               i = i + 1
               value = argument(i)
            end if
            if (word(:mark - 1) == '--as') then
               if (allocated(value)) command%shown = value
               if (.not. allocated(value)) call complain('--as needs the path of the case after it')
               return
            else if (word(:mark - 1) /= '--count') then
               if (allocated(value)) command%output = value
               if (.not. allocated(value)) then
                  call complain(word(:mark - 1)//' needs the path of a file after it')
               end if
               return
            end if
            status = 1
            if (allocated(value)) then
               if (verify(value, '0123456789') == 0 .and. len(value) < 9) then
                  read (value, *, iostat=status) command%count
               end if
            end if
            if (status /= 0 .or. command%count < 1) then
               call complain('--count needs a number of modes above zero')
            end if
            return
         case default
            call complain("the option '"//word(:mark - 1)//"' is not known"// &
                          suggestion(word(:mark - 1), options))
            return
         end select
         if (mark <= len(word)) call complain("the option '"//word(:mark - 1)//"' takes no value")
      end subroutine take_option

      !> Take any other word: the command, then its topic or its case.
      subroutine take_word()

         if (.not. allocated(command%name) .or. help_for(command)) then
            if (all(commands /= word)) then
               call complain("the command '"//word//"' is not known"//suggestion(word, commands))
               return
            end if
            if (help_for(command)) then
               command%topic = word
            else
               command%name = word
            end if
         else if (command%name == 'keys' .and. .not. allocated(command%topic)) then
            command%topic = word
         else if (.not. allocated(command%case)) then
            if (word == '') then
               call complain('the path of the case is empty')
               return
            end if
            command%case = word
         else
            call complain("one argument too many: '"//word//"'")
         end if
      end subroutine take_word

      !> Refuse what does not belong together, once all words are taken.
      subroutine check_whole()

         if (.not. allocated(command%topic)) command%topic = ''
         if (allocated(command%case) .and. .not. allocated(command%shown)) command%shown = command%case
         if (.not. allocated(command%name)) then
            call complain('no command')
         else if (command%name == 'help' .or. command%name == 'version') then
            return
         else if (command%as_json .and. command%name /= 'keys' .and. command%name /= 'check') then
            call complain('--json is for keys and check only')
         else if ((command%count > 0 .or. command%matrices) .and. command%name /= 'modes') then
            call complain(trim(merge('--count   ', '--matrices', command%count > 0))//' is for modes only')
         else if (command%name == 'keys') then
            if (allocated(command%case)) then
               call complain("one argument too many: '"//command%case//"'")
            else if (command%as_json .and. command%topic /= '') then
               call complain('--json prints all keys; leave '//command%topic//' away')
            end if
         else if (.not. allocated(command%case)) then
            call complain(command%name//' needs the path of a case after it')
         else if (allocated(command%output)) then
            if (command%name /= 'run') then
               call complain('--output is for run only')
            else if (len_trim(command%output) == 0) then
               call complain('--output needs the path of a file')
            end if
         end if
      end subroutine check_whole

      !> Refuse the command line.
      subroutine complain(what)
         character(len=*), intent(in) :: what

         call fatal_error(error, bad_input, what//" (try 'rbsdem --help')")
      end subroutine complain

   end subroutine read_command_line

   !> Whether help was asked for, and not yet for which command.
   pure logical function help_for(command)
      type(command_type), intent(in) :: command

      help_for = .false.
      if (allocated(command%name)) help_for = command%name == 'help' .and. .not. allocated(command%topic)
   end function help_for

   !> Argument i of the process, with its blanks.
   function argument(i) result(word)
      integer, intent(in) :: i
      character(len=:), allocatable :: word
      integer :: length

      call get_command_argument(i, length=length)
      allocate (character(len=length) :: word)
      call get_command_argument(i, word)
   end function argument

end module rbs_app_command_line
