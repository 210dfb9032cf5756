!> The syntax of a namelist file: groups, entries with their lines, and the words that are their values.
!>
!> A Fortran namelist read does not report which name is unknown, does not distinguish a missing group, too
!> many values and the end of the file, and accepts too few values. Here the syntax is checked, and each value
!> is then read on its own.
module rbs_io_namelist_scan
   use rbs_base_error, only: message_list
   use rbs_base_text, only: lower, to_text, integer_length
   use rbs_io_text_file, only: text_file
   implicit none
   private

   public :: nml_entry, nml_group, nml_scan, scan_namelist

   character(len=*), parameter :: name_set = &
      'abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_', digits = '0123456789'

   !> Largest repeat count; a larger one is taken for a typing error.
   integer, parameter :: most_repeats = 100000

   !> The scan stops after this many errors: the file is probably not a case file.
   integer, parameter, public :: most_messages = 20

   !> Largest numbers of groups, and of entries in a group; no case needs as many.
   integer, parameter :: most_groups = 100000, most_entries = 5000

   !> One value: its place in the text, quotes included, and its repeat count.
   type :: nml_word
      integer :: first = 1, last = 0, times = 1
   end type nml_word

   !> `name = values` or `name(i) = values`.
   type :: nml_entry
      character(len=32) :: name = ''
      !> Subscript, 0 without one; line in the file
      integer :: subscript = 0, line = 0
      !> Its values are the words `first` to `last` of the scan; how many they are with repeats
      integer :: first = 1, last = 0, total = 0
   end type nml_entry

   !> One `&name ... /`.
   type :: nml_group
      character(len=32) :: name = ''
      integer :: line = 0
      !> Its entries are `first` to `last` of the scan
      integer :: first = 1, last = 0
   end type nml_group

   type :: nml_scan
      !> Name of the file, for messages
      character(len=:), allocatable :: path
      !> The text without comments, in which each line ends with a blank, and the line of each character
      character(len=:), allocatable :: text
      integer, allocatable :: line_of(:)
      integer :: groups = 0, entries = 0, words = 0
      type(nml_group), allocatable :: group(:)
      type(nml_entry), allocatable :: entry(:)
      type(nml_word), allocatable :: word(:)
      !> Position of the scan
      integer, private :: at = 1
      logical, private :: failed = .false.
   contains
      procedure :: location
   end type nml_scan

contains

   !> Cut a file into groups and entries.
   subroutine scan_namelist(file, path, self, messages)
      type(text_file), intent(inout) :: file
      !> Name of the file, for messages
      character(len=*), intent(in) :: path
      type(nml_scan), intent(inout) :: self
      type(message_list), intent(inout) :: messages

      self%path = path
      call strip_comments()
      ! Each entry has its =, and each word ends at one of these characters or at the end.
      allocate (self%group(min(count_of('&'), most_groups)), self%entry(count_of('=')), &
                self%word(count_of(' ,/''"=') + 1))
      do while (.not. self%failed)
         call skip(' ')
         if (self%at > len(self%text)) exit
         if (letter() /= '&') then
            call complain('stands outside a group; a group begins with &name and ends with /', &
                          after_word=.true.)
            return
         end if
         self%at = self%at + 1
         call scan_group()
      end do
      if (self%groups == 0 .and. .not. self%failed) then
         call messages%add(path//': has no groups; a case has &column, &shear, &flexure, &loading ...')
      end if

   contains

      !> Copy the text without comments, and refuse control characters.
      subroutine strip_comments()
         character(len=1) :: quote, letter
         integer :: first, last, i, length
         logical :: found

         allocate (character(len=len(file%text) + 2) :: self%text)
         allocate (self%line_of(len(file%text) + 2))
         length = 0
         do
            call file%next_line(first, last, found)
            if (.not. found .or. messages%count > most_messages) exit
            quote = ' '
            do i = first, last
               letter = file%text(i:i)
               if (letter == achar(9)) letter = ' '
               if (quote == ' ' .and. letter == '!') exit
               if (iachar(letter) < 32 .or. iachar(letter) == 127) then
                  call messages%add(self%location(file%line)//' a control character (code '// &
                                    to_text(iachar(letter))//') is in the text; is it a text file?')
                  self%failed = .true.
                  exit
               end if
               if (quote == ' ') then
                  if (letter == '''' .or. letter == '"') quote = letter
               else if (letter == quote) then
                  quote = ' '
               end if
               length = length + 1
               self%text(length:length) = letter
               self%line_of(length) = file%line
            end do
            if (quote /= ' ' .and. messages%count <= most_messages) then
               call messages%add(self%location(file%line)//' a text begins with '//quote// &
                                 ' and does not end on the line; close the quotes')
               self%failed = .true.
            end if
            length = length + 1
            self%text(length:length) = ' '
            self%line_of(length) = file%line
         end do
         self%text = self%text(:length)
      end subroutine strip_comments

      !> How many characters of the text belong to a set.
      pure integer function count_of(set)
         character(len=*), intent(in) :: set
         integer :: i

         count_of = 0
         do i = 1, len(self%text)
            if (scan(self%text(i:i), set) > 0) count_of = count_of + 1
         end do
      end function count_of

      !> Scan from the name after & to the closing slash.
      subroutine scan_group()
         type(nml_group) :: group
         integer :: begin

         begin = self%at - 1
         group%line = self%line_of(begin)
         group%first = self%entries + 1
         call take_name(group%name)
         if (group%name == '') then
            call complain('a group has no name after &')
            return
         end if
         if (self%groups == most_groups) then
            call complain('there are more than '//to_text(most_groups)//' groups; is it a case?')
            return
         end if
         do
            call skip(' ,')
            if (self%at > len(self%text)) then
               self%at = begin
               call complain('&'//trim(group%name)//' is not closed; end it with /')
            else if (group_begins()) then
               ! The next group is scanned all the same: it would otherwise be taken for values of this one.
               call complain('&'//trim(group%name)//' of line '//to_text(group%line)// &
                             ' is not closed before the next group; end it with /')
               self%failed = .false.
               return
            else if (letter() == '/') then
               exit
            else if (self%entries - group%first + 1 == most_entries) then
               call complain('&'//trim(group%name)//' has more than '//to_text(most_entries)// &
                             ' entries; is it a case?')
            else
               call scan_entry(trim(group%name))
            end if
            if (self%failed) return
         end do
         self%at = self%at + 1
         group%last = self%entries
         self%groups = self%groups + 1
         self%group(self%groups) = group
      end subroutine scan_group

      !> Scan `name = values` or `name(i) = values`.
      subroutine scan_entry(group)
         character(len=*), intent(in) :: group
         type(nml_entry) :: entry

         call take_name(entry%name)
         if (entry%name == '') then
            call complain('in &'//group//' is not a name; entries are name = value', after_word=.true.)
            return
         end if
         entry%line = self%line_of(self%at - 1)
         call skip(' ')
         if (letter() == '(') call scan_subscript(trim(entry%name), entry%subscript)
         if (self%failed) return
         call skip(' ')
         if (letter() /= '=') then
            call complain("'"//trim(entry%name)//"' in &"//group//' has no = after it; entries are '// &
                          'name = value, and texts are in quotes')
            return
         end if
         self%at = self%at + 1
         call scan_values(entry)
         self%entries = self%entries + 1
         self%entry(self%entries) = entry
      end subroutine scan_entry

      !> Scan a subscript (i).
      subroutine scan_subscript(name, subscript)
         character(len=*), intent(in) :: name
         integer, intent(out) :: subscript
         character(len=12) :: word
         integer :: length

         subscript = 0
         length = index(self%text(self%at:min(self%at + 11, len(self%text))), ')')
         if (length > 2) then
            ! Not an associate name: gfortran 12 frees the text of trim(adjustl()) twice.
            word = adjustl(self%text(self%at + 1:self%at + length - 2))
            if (len_trim(word) > 0 .and. len_trim(word) < 8 .and. verify(trim(word), digits) == 0) then
               read (word, '(i8)') subscript
            end if
         end if
         if (subscript < 1) then
            call complain("the subscript of '"//name//"' must be one whole number from 1")
            return
         end if
         self%at = self%at + length
      end subroutine scan_subscript

      !> Scan values, separated by blanks or commas, up to the next name or the end of the group.
      subroutine scan_values(entry)
         type(nml_entry), intent(inout) :: entry
         !> Whether a comma here would leave a value out; also true before the first value
         logical :: after_comma

         after_comma = .true.
         entry%first = self%words + 1
         do
            call skip(' ')
            if (self%at > len(self%text) .or. letter() == '/' .or. group_begins()) exit
            if (letter() == ',') then
               if (after_comma) then
                  call complain("a value of '"//trim(entry%name)//"' is missing before a comma")
                  return
               end if
               after_comma = .true.
               self%at = self%at + 1
               cycle
            end if
            if (is_name_ahead()) exit
            self%words = self%words + 1
            call scan_word(trim(entry%name), self%word(self%words))
            if (self%failed) return
            ! The sum of many repeats must not overflow.
            entry%total = min(entry%total, huge(1) - most_repeats) + self%word(self%words)%times
            after_comma = .false.
         end do
         entry%last = self%words
         if (entry%last < entry%first) call complain("'"//trim(entry%name)//"' has no value")
      end subroutine scan_values

      !> Scan one value: a quoted text or a word, perhaps with a repeat count as in 3*0.5.
      subroutine scan_word(name, word)
         character(len=*), intent(in) :: name
         type(nml_word), intent(out) :: word
         integer :: length, star

         word%first = self%at
         if (scan(letter(), '''"') == 1) then
            length = quoted_length(self%text(self%at:))
            if (length == 0) call complain("the text of '"//name//"' has no closing quote")
         else
            length = scan(self%text(self%at:), ' ,/''"=') - 1
            if (length < 0) length = len(self%text) - self%at + 1
            if (length == 0) then
               call complain("'"//letter()//"' is not allowed among the values of '"//name//"'")
               return
            end if
            associate (text => self%text(self%at:self%at + length - 1))
               ! With a star a count must stand before it, and a value behind it; 0 marks a fault.
               star = index(text, '*')
               if (star > 0) word%times = 0
               if (star > 1 .and. star <= 7 .and. star < length) then
                  if (verify(text(:star - 1), digits) == 0) read (text(:star - 1), '(i6)') word%times
               end if
               if (word%times < 1 .or. word%times > most_repeats) then
                  call complain("'"//text//"' of '"//name//"' is not a value; repeats are count*value")
               end if
            end associate
            word%first = self%at + star
         end if
         self%at = self%at + length
         word%last = self%at - 1
      end subroutine scan_word

      !> Length of the quoted text, with its quotes, that a text begins with; a quote within it is doubled. 0
      !> if it is not closed.
      pure integer function quoted_length(text) result(length)
         character(len=*), intent(in) :: text
         integer :: mark

         length = 1
         do
            mark = index(text(length + 1:), text(1:1))
            length = length + mark
            if (mark == 0) exit
            if (length == len(text)) return
            if (text(length + 1:length + 1) /= text(1:1)) return
            length = length + 1
         end do
         length = 0
      end function quoted_length

      !> Whether a name with its = (or subscript) is next.
      logical function is_name_ahead()
         integer :: at

         is_name_ahead = scan(lower(letter()), name_set(:26)) == 1
         if (.not. is_name_ahead) return
         at = self%at + run_of(self%at, name_set)
         at = at + run_of(at, ' ')
         is_name_ahead = scan(self%text(at:min(at, len(self%text))), '=(') > 0
      end function is_name_ahead

      !> Whether & and a name come next.
      logical function group_begins()

         group_begins = letter() == '&' .and. run_of(self%at + 1, name_set) > 0
      end function group_begins

      !> Take a name, in lower case; blank if the next character cannot begin one. A name that is too long is
      !> cut, and then fits no key.
      subroutine take_name(name)
         character(len=32), intent(out) :: name
         integer :: length

         length = run_of(self%at, name_set)
         name = lower(self%text(self%at:self%at + min(length, 31) - 1))
         self%at = self%at + length
      end subroutine take_name

      !> Go beyond all characters of a set that come next.
      subroutine skip(set)
         character(len=*), intent(in) :: set

         self%at = self%at + run_of(self%at, set)
      end subroutine skip

      !> Number of characters from a position that belong to a set.
      integer function run_of(at, set)
         integer, intent(in) :: at
         character(len=*), intent(in) :: set

         run_of = verify(self%text(at:), set) - 1
         if (run_of < 0) run_of = len(self%text) - at + 1
      end function run_of

      !> The next character; a zero byte at the end.
      character(len=1) function letter()

         letter = achar(0)
         if (self%at <= len(self%text)) letter = self%text(self%at:self%at)
      end function letter

      !> Report an error of syntax at the present position, and set `failed`, which ends the scan.
      subroutine complain(what, after_word)
         !> The error, as the end of the message
         character(len=*), intent(in) :: what
         !> Whether the message begins with the word at the present position
         logical, intent(in), optional :: after_word
         character(len=:), allocatable :: text

         self%failed = .true.
         text = what
         if (present(after_word)) then
            text = "'"//self%text(self%at:self%at + min(index(self%text(self%at:)//' ', ' ') - 1, 30) - 1)// &
                   "' "//what
         end if
         call messages%add(self%location(self%line_of(min(self%at, len(self%text))))//' '//text)
      end subroutine complain
   end subroutine scan_namelist

   !> 'case.nml line 4:', for the start of a message.
   pure function location(self, line) result(text)
      class(nml_scan), intent(in) :: self
      integer, intent(in) :: line
      character(len=len(self%path) + 7 + integer_length(line)) :: text

      text = self%path//' line '//to_text(line)//':'
   end function location

end module rbs_io_namelist_scan
