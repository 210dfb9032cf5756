!> The first pass over a namelist file: groups, names and values, each with its line.
!>
!> A Fortran namelist read does not report which name is unknown, does not distinguish a missing group, too
!> many values and the end of the file, and accepts too few values. Here the text is cut into pieces
!> with valid syntax, and each piece is read on its own.
module rbs_io_namelist_scan
   use rbs_base_error, only: message_list
   use rbs_base_text, only: lower, to_text
   use rbs_io_namelist_pieces, only: nml_entry, nml_scan, add_group, add_entry, add_value
   use rbs_io_text_file, only: text_file
   implicit none
   private

   public :: scan_namelist

   character(len=*), parameter :: letters = 'abcdefghijklmnopqrstuvwxyz'
   character(len=*), parameter :: name_set = letters//'0123456789_'

   !> Largest repeat count; a larger one is taken for a typing error.
   integer, parameter :: most_repeats = 100000

   !> The scan stops after this many errors: the file is probably not a case file.
   integer, parameter, public :: most_messages = 20

   !> Largest numbers of groups, and of entries in a group; no case needs as many.
   integer, parameter :: most_groups = 100000, most_entries = 5000

   !> The text, in which each line ends with a blank, and the position of the scan.
   type :: cursor
      character(len=:), allocatable :: text
      integer, allocatable :: line_of(:)
      integer :: at = 1
   end type cursor

contains

   !> Cut a file into groups and entries.
   subroutine scan_namelist(file, path, scanned, messages)
      type(text_file), intent(inout) :: file
      !> Path of the file, for messages
      character(len=*), intent(in) :: path
      type(nml_scan), intent(out) :: scanned
      type(message_list), intent(inout) :: messages
      type(cursor) :: c
      integer :: known

      known = messages%count
      allocate (scanned%group(8), scanned%entry(64))
      call strip_comments(file, path, c, messages)
      if (messages%count > known) return
      do
         call skip_blanks(c)
         if (c%at > len(c%text)) exit
         if (c%text(c%at:c%at) /= '&') then
            call complain(c, path, "'"//word_at(c)//"' stands outside a group; a group begins with "// &
                          '&name and ends with /', messages)
            return
         end if
         c%at = c%at + 1
         call scan_group(c, path, scanned, messages)
         if (messages%count > known) return
      end do
      if (scanned%groups == 0) then
         call messages%add(path//': has no groups; a case has &column, &shear, &flexure, &loading ...')
      end if
   end subroutine scan_namelist

   !> Copy the text without comments, and refuse control characters.
   subroutine strip_comments(file, path, c, messages)
      type(text_file), intent(inout) :: file
      character(len=*), intent(in) :: path
      type(cursor), intent(out) :: c
      type(message_list), intent(inout) :: messages
      character(len=1) :: quote, letter
      integer :: first, last, i, length
      logical :: found

      allocate (character(len=len(file%text) + 2) :: c%text)
      allocate (c%line_of(len(file%text) + 2))
      length = 0
      do
         call file%next_line(first, last, found)
         if (.not. found) exit
         quote = ' '
         do i = first, last
            letter = file%text(i:i)
            if (letter == achar(9)) letter = ' '
            if (quote == ' ' .and. letter == '!') exit
            if (iachar(letter) < 32 .or. iachar(letter) == 127) then
               call messages%add(path//' line '//to_text(file%line)//': a control character (code '// &
                                 to_text(iachar(letter))//') is in the text; is it a text file?')
               if (messages%count > most_messages) return
               exit
            end if
            if (quote == ' ') then
               if (letter == '''' .or. letter == '"') quote = letter
            else if (letter == quote) then
               quote = ' '
            end if
            length = length + 1
            c%text(length:length) = letter
            c%line_of(length) = file%line
         end do
         if (quote /= ' ') then
            call messages%add(path//' line '//to_text(file%line)//': a text begins with '//quote// &
                              ' and does not end on the line; close the quotes')
            if (messages%count > most_messages) return
         end if
         length = length + 1
         c%text(length:length) = ' '
         c%line_of(length) = file%line
      end do
      c%text = c%text(:length)
   end subroutine strip_comments

   !> Scan from the name after & to the closing slash.
   subroutine scan_group(c, path, scanned, messages)
      type(cursor), intent(inout) :: c
      character(len=*), intent(in) :: path
      type(nml_scan), intent(inout) :: scanned
      type(message_list), intent(inout) :: messages
      character(len=:), allocatable :: name
      integer :: begin, known

      known = messages%count
      begin = c%at - 1
      call take_name(c, name)
      if (name == '') then
         call complain(c, path, 'a group has no name after &', messages)
         return
      end if
      if (scanned%groups == most_groups) then
         call complain(c, path, 'there are more than '//to_text(most_groups)//' groups; is it a case?', &
                       messages)
         return
      end if
      call add_group(scanned, name, c%line_of(begin))
      do
         call skip_blanks(c, commas=.true.)
         if (c%at > len(c%text)) then
            c%at = begin
            call complain(c, path, '&'//name//' is not closed; end it with /', messages)
            return
         end if
         if (c%text(c%at:c%at) == '/') then
            c%at = c%at + 1
            scanned%group(scanned%groups)%last = scanned%entries
            return
         end if
         if (scanned%entries - scanned%group(scanned%groups)%first + 1 == most_entries) then
            call complain(c, path, '&'//name//' has more than '//to_text(most_entries)// &
                          ' entries; is it a case?', messages)
            return
         end if
         call scan_entry(c, path, name, scanned, messages)
         if (messages%count > known) return
      end do
   end subroutine scan_group

   !> Scan `name = values` or `name(i) = values`.
   subroutine scan_entry(c, path, group, scanned, messages)
      type(cursor), intent(inout) :: c
      character(len=*), intent(in) :: path, group
      type(nml_scan), intent(inout) :: scanned
      type(message_list), intent(inout) :: messages
      character(len=:), allocatable :: name
      integer :: subscript, known

      known = messages%count
      call take_name(c, name)
      if (name == '') then
         call complain(c, path, "'"//word_at(c)//"' in &"//group//' is not a name; entries are '// &
                       'name = value', messages)
         return
      end if
      call add_entry(scanned, name, c%line_of(min(c%at, size(c%line_of)) - 1))
      subscript = 0
      call skip_blanks(c)
      if (at_letter(c, '(')) call take_subscript(c, path, name, subscript, messages)
      if (messages%count > known) return
      scanned%entry(scanned%entries)%subscript = subscript
      call skip_blanks(c)
      if (.not. at_letter(c, '=')) then
         call complain(c, path, "'"//name//"' in &"//group//' has no = after it; entries are '// &
                       'name = value, and texts are in quotes', messages)
         return
      end if
      c%at = c%at + 1
      call scan_values(c, path, name, scanned%entry(scanned%entries), messages)
   end subroutine scan_entry

   !> Scan values up to the next name or the end of the group.
   subroutine scan_values(c, path, name, entry, messages)
      type(cursor), intent(inout) :: c
      character(len=*), intent(in) :: path, name
      type(nml_entry), intent(inout) :: entry
      type(message_list), intent(inout) :: messages
      logical :: after_comma
      integer :: known

      known = messages%count
      after_comma = .true.
      do
         call skip_blanks(c)
         if (c%at > len(c%text)) exit
         if (at_letter(c, '/')) exit
         if (at_letter(c, ',')) then
            if (after_comma) then
               call complain(c, path, "a value of '"//name//"' is missing before a comma", messages)
               return
            end if
            after_comma = .true.
            c%at = c%at + 1
            cycle
         end if
         if (is_name_ahead(c)) exit
         call take_value(c, path, name, entry, messages)
         if (messages%count > known) return
         after_comma = .false.
      end do
      if (entry%values == 0) call complain(c, path, "'"//name//"' has no value", messages)
   end subroutine scan_values

   !> One value: a quoted text or a word, perhaps with a repeat count.
   subroutine take_value(c, path, name, entry, messages)
      type(cursor), intent(inout) :: c
      character(len=*), intent(in) :: path, name
      type(nml_entry), intent(inout) :: entry
      type(message_list), intent(inout) :: messages
      character(len=1) :: quote
      integer :: length, star, times

      quote = c%text(c%at:c%at)
      if (quote == '''' .or. quote == '"') then
         length = quoted_length(c%text(c%at:))
         if (length == 0) then
            call complain(c, path, "the text of '"//name//"' has no closing quote", messages)
            return
         end if
         call add_value(entry, 1, c%text(c%at:c%at + length - 1))
         c%at = c%at + length
         return
      end if
      length = scan(c%text(c%at:), ' ,/''"=') - 1
      if (length < 0) length = len(c%text) - c%at + 1
      if (length == 0) then
         call complain(c, path, "'"//c%text(c%at:c%at)//"' is not allowed among the values of '"//name// &
                       "'", messages)
         return
      end if
      associate (word => c%text(c%at:c%at + length - 1))
         star = index(word, '*')
         times = 1
         if (star > 0) then
            times = -1
            if (star > 1 .and. star <= 7 .and. verify(word(:star - 1), '0123456789') == 0) then
               read (word(:star - 1), '(i6)') times
            end if
            if (times < 1 .or. times > most_repeats .or. star == length) then
               call complain(c, path, "'"//word//"' of '"//name//"' is not a value; "// &
                             'repeats are count*value', messages)
               return
            end if
         end if
         call add_value(entry, times, word(star + 1:))
      end associate
      c%at = c%at + length
   end subroutine take_value

   !> Length of a quoted text with its quotes; a quote within is doubled. 0 if the text is not closed.
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

   !> A subscript (i).
   subroutine take_subscript(c, path, name, subscript, messages)
      type(cursor), intent(inout) :: c
      character(len=*), intent(in) :: path, name
      integer, intent(out) :: subscript
      type(message_list), intent(inout) :: messages
      character(len=12) :: word
      integer :: length

      subscript = 0
      length = index(c%text(c%at:min(c%at + 11, len(c%text))), ')')
      if (length > 2) then
         ! Not an associate name: gfortran 12 frees the text of trim(adjustl()) twice.
         word = adjustl(c%text(c%at + 1:c%at + length - 2))
         if (len_trim(word) > 0 .and. len_trim(word) < 8 .and. verify(trim(word), '0123456789') == 0) then
            read (word, '(i8)') subscript
         end if
      end if
      if (subscript < 1) then
         call complain(c, path, "the subscript of '"//name//"' must be one whole number from 1", messages)
         return
      end if
      c%at = c%at + length
   end subroutine take_subscript

   !> Whether a name with its = (or subscript) is next.
   logical function is_name_ahead(c)
      type(cursor), intent(in) :: c
      integer :: at

      at = c%at
      is_name_ahead = .false.
      if (verify(lower(c%text(at:at)), letters) /= 0) return
      do while (at <= len(c%text))
         if (verify(lower(c%text(at:at)), name_set) /= 0) exit
         at = at + 1
      end do
      do while (at <= len(c%text))
         if (c%text(at:at) /= ' ') exit
         at = at + 1
      end do
      if (at <= len(c%text)) is_name_ahead = c%text(at:at) == '=' .or. c%text(at:at) == '('
   end function is_name_ahead

   !> Take a name, in lower case; empty if the next character cannot begin one.
   subroutine take_name(c, name)
      type(cursor), intent(inout) :: c
      character(len=:), allocatable, intent(out) :: name
      integer :: begin

      begin = c%at
      do while (c%at <= len(c%text))
         if (verify(lower(c%text(c%at:c%at)), name_set) /= 0) exit
         c%at = c%at + 1
      end do
      name = lower(c%text(begin:c%at - 1))
      if (len(name) > 31) name = name(:31)
   end subroutine take_name

   subroutine skip_blanks(c, commas)
      type(cursor), intent(inout) :: c
      logical, intent(in), optional :: commas

      do while (c%at <= len(c%text))
         if (c%text(c%at:c%at) /= ' ') then
            if (.not. present(commas)) exit
            if (c%text(c%at:c%at) /= ',') exit
         end if
         c%at = c%at + 1
      end do
   end subroutine skip_blanks

   pure logical function at_letter(c, letter)
      type(cursor), intent(in) :: c
      character(len=1), intent(in) :: letter

      at_letter = .false.
      if (c%at <= len(c%text)) at_letter = c%text(c%at:c%at) == letter
   end function at_letter

   !> The word at the present position, for a message.
   pure function word_at(c) result(word)
      type(cursor), intent(in) :: c
      character(len=word_length(c)) :: word

      word = c%text(c%at:c%at + len(word) - 1)
   end function word_at

   pure integer function word_length(c)
      type(cursor), intent(in) :: c

      word_length = 0
      if (c%at > len(c%text)) return
      word_length = scan(c%text(c%at:), ' ') - 1
      if (word_length < 1) word_length = len(c%text) - c%at + 1
      word_length = min(word_length, 30)
   end function word_length

   subroutine complain(c, path, what, messages)
      type(cursor), intent(in) :: c
      character(len=*), intent(in) :: path, what
      type(message_list), intent(inout) :: messages
      integer :: line

      line = 1
      if (len(c%text) > 0) line = c%line_of(max(1, min(c%at, len(c%text))))
      call messages%add(path//' line '//to_text(line)//': '//what)
   end subroutine complain

end module rbs_io_namelist_scan
