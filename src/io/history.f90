!> History files: the text format of the PEER database, and csv.
!>
!> A line of a file of rows, cut into its fields.
module rbs_io_history
   use rbs_base_error, only: error_type, fatal_error, bad_input
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: lower, to_text
   use rbs_io_text_file, only: text_file, load_text, read_real, is_integer, number_ok, number_wrong, &
                               number_not_finite
   implicit none
   private

   public :: history_type, read_history, elsewhere, snippet

   !> A remedy for a layout that is not the strict one.
   character(len=*), parameter :: elsewhere = 'rbsdem.motions.read_motion and rbsdem.read_test of '// &
                                  'Python take more layouts'

   !> Most fields of a line.
   integer, parameter :: most_columns = 64

   character(len=1), parameter :: tab = achar(9)
   character(len=*), parameter :: blanks = ' '//tab

   !> First and last characters of the fields of a line.
   type :: field_list
      integer :: count = 0, first(most_columns + 1) = 0, last(most_columns + 1) = 0
   end type field_list

   !> Largest file that is read [bytes].
   integer, parameter :: most_bytes = 2000000000

   !> Lines above the numbers of an AT2 file.
   integer, parameter :: at2_head = 4

   type :: history_type
      !> Name of the test: first line of a PEER file, else the file's name
      character(len=:), allocatable :: name
      !> Whether the file has the PEER format: millimetres, kilonewtons
      logical :: peer = .false.
      !> Numbers of columns and rows
      integer :: columns = 0, rows = 0
      !> Names of the columns; empty where the file gives none
      character(len=64), allocatable :: labels(:)
      !> A comment that states a unit, which is not read
      character(len=:), allocatable :: stated
      !> Values (columns, rows)
      real(wp), allocatable :: values(:, :)
   end type history_type

contains

   !> Read a history: a PEER file, an AT2 file or a csv.
   subroutine read_history(path, format, history, error)
      character(len=*), intent(in) :: path
      !> 'peer', 'csv' (or AT2), or 'auto': as the file looks
      character(len=*), intent(in) :: format
      type(history_type), intent(out) :: history
      type(error_type), allocatable, intent(out) :: error
      type(text_file) :: file

      logical :: at2

      call load_text(file, path, most_bytes, error)
      if (allocated(error)) return
      history%peer = format == 'peer'
      if (format == 'auto') history%peer = is_peer(file)
      at2 = .not. history%peer
      if (at2) at2 = is_at2(file)
      if (history%peer) then
         call read_peer()
      else if (at2) then
         call read_at2()
      else
         call read_csv()
      end if

   contains

      !> Accelerations, a few in a line: rows of time [s] and acceleration [g].
      subroutine read_at2()
         type(field_list) :: fields
         character(len=:), allocatable :: head
         real(wp) :: numbers(2), value
         integer :: first, last, i, count, status
         logical :: found

         history%name = path(index(path, '/', back=.true.) + 1:)
         do i = 1, at2_head
            call file%next_line(first, last, found)
            ! The line before the last one of the head states the unit.
            if (i /= at2_head - 1) cycle
            if (index(file%text(first:last), 'ACCEL') == 0 .or. index(file%text(first:last), ' G') == 0) then
               call fatal_error(error, bad_input, path//" line 3: '"//snippet(file%text(first:last))// &
                                "' of an AT2 file must say ACCELERATION ... IN UNITS OF G; "//elsewhere)
               return
            end if
         end do
         ! NPTS= 4000, DT= .01 SEC, or in older files: 4000 0.01 NPTS, DT
         head = file%text(first:last)
         do i = 1, len(head)
            if (scan(head(i:i), '=,') == 1) head(i:i) = ' '
         end do
         call split(head, 1, ' ', fields)
         count = 0
         do i = 1, fields%count
            call read_real(head(fields%first(i):fields%last(i)), value, status)
            if (status /= number_ok .or. count == 2) cycle
            count = count + 1
            numbers(count) = value
         end do
         ! Without both numbers the head is refused below.
         if (count < 2) numbers = 0.0_wp
         if (.not. (numbers(1) > 1.0_wp .and. numbers(1) < 1.0e8_wp .and. numbers(2) > 0.0_wp)) then
            call fatal_error(error, bad_input, path//" line 4: '"//snippet(file%text(first:last))// &
                             "' must give the number of values, NPTS, and the time step in s, DT ("// &
                             elsewhere//')')
            return
         end if
         history%columns = 2
         history%labels = [character(len=len(history%labels)) :: 'time_s', 'acceleration_g']
         history%rows = nint(numbers(1))
         allocate (history%values(2, history%rows))
         count = 0
         do while (count <= history%rows)
            call file%next_line(first, last, found)
            if (.not. found) exit
            call split(file%text(:last), first, ' ', fields)
            do i = 1, fields%count
               call read_field(fields, i, value)
               if (allocated(error)) return
               count = count + 1
               if (count > history%rows) exit
               history%values(:, count) = [(count - 1)*numbers(2), value]
            end do
         end do
         if (count /= history%rows) then
            call fatal_error(error, bad_input, path//': line 4 declares '//to_text(history%rows)// &
                             ' values, but there are '// &
                             trim(merge('more ', 'fewer', count > history%rows))// &
                             '; the file is cut or mixed up')
         end if
      end subroutine read_at2

      !> Name, count, then displacement [mm], force [kN] and in some files the axial load [kN].
      subroutine read_peer()
         character(len=12), parameter :: labels(3) = ['displacement', 'force       ', 'axial_load  ']
         character(len=3), parameter :: units(3) = ['_mm', '_kN', '_kN']
         integer :: first, last, declared, i
         logical :: found

         call file%next_line(first, last, found)
         call trim_field(file%text, first, last)
         history%name = file%text(first:last)
         call file%next_line(first, last, found)
         declared = -1
         if (found) declared = count_of(file%text(first:last))
         if (declared < 0) then
            call fatal_error(error, bad_input, path//" line 2: '"//snippet(file%text(first:last))// &
                             "' is not the number of pairs that a PEER file has there; check the file, "// &
                             "or set format = 'csv'")
            return
         end if
         call read_rows(' ')
         if (allocated(error)) return
         if (history%columns < 2 .or. history%columns > 3) then
            call fatal_error(error, bad_input, path//': has '//to_text(history%columns)//' columns; a '// &
                             'PEER file has displacement, force and perhaps the axial load')
         else if (history%rows /= declared) then
            call fatal_error(error, bad_input, path//': line 2 declares '//to_text(declared)// &
                             ' pairs, but there are '//to_text(history%rows)//'; the file is cut or '// &
                             "mixed up, or the number wants correcting (if it is a csv, set format = 'csv')")
         else
            allocate (history%labels(history%columns))
            do i = 1, history%columns
               history%labels(i) = trim(labels(i))//units(i)
            end do
         end if
      end subroutine read_peer

      !> Whether a comment states a unit of acceleration or of a rate, or has the word unit in some language.
      !> The comment is in lower case.
      logical function states_unit(comment)
         character(len=*), intent(in) :: comment
         character(len=4), parameter :: marks(20) = &
            [character(len=4) :: 'unit', 'unid', 'einh', 'hz', ' gal', '(gal', '/s', 's-2', '(g)', '[g]', &
             'in g', '/(s', 'mps2', '_s2', '/с', 's⁻', 'grav', 'cms', '⁄', '$^']
         integer :: i

         states_unit = any([(index(comment, trim(marks(i))) > 0, i=1, size(marks))])
      end function states_unit

      !> Comments with #, perhaps a line of names, then numbers.
      subroutine read_csv()
         !> Separators of columns: the first of these that the line has counts
         character(len=*), parameter :: separators = ';,'//tab//' '
         type(field_list) :: fields
         character(len=1) :: separator
         integer :: begin(2)
         real(wp) :: value
         integer :: first, last, status, i
         logical :: found, named, worded

         history%name = path(index(path, '/', back=.true.) + 1:)
         do
            begin = file%position()
            call file%next_line(first, last, found)
            if (.not. found) exit
            if (.not. is_blank(file%text(first:last))) exit
            if (.not. states_unit(lower(file%text(first:last)))) cycle
            history%stated = file%text(first:last)
         end do
         if (.not. found) then
            call fatal_error(error, bad_input, path//': has no rows of numbers; check the file')
            return
         end if
         ! Without any other separator the loop ends at the blank.
         do i = 1, len(separators) - 1
            if (index(trim(file%text(first:last)), separators(i:i)) > 0) exit
         end do
         separator = separators(i:i)
         call split(file%text(:last), first, separator, fields)
         ! A line of names has at least one word, and no number.
         named = .true.
         worded = .false.
         do i = 1, fields%count
            call read_real(file%text(fields%first(i):fields%last(i)), value, status)
            if (status == number_ok) named = .false.
            if (status == number_wrong) worded = .true.
         end do
         named = named .and. worded
         ! A first row of numbers is read again below.
         allocate (history%labels(fields%count))
         history%labels = ''
         if (named) then
            do i = 1, fields%count
               history%labels(i) = file%text(fields%first(i):fields%last(i))
            end do
         else
            call file%go_back(begin)
         end if
         call read_rows(separator)
         if (allocated(error)) return
         if (size(history%labels) /= history%columns) then
            call fatal_error(error, bad_input, path//': has '//to_text(size(history%labels))// &
                             ' names of columns for '//to_text(history%columns)//' columns; make them '// &
                             'equal ('//elsewhere//')')
         end if
      end subroutine read_csv

      !> Read rows of numbers to the end of the file into `history`; every row must be as long as the first.
      !> A first pass counts the rows.
      subroutine read_rows(separator)
         character(len=1), intent(in) :: separator
         type(field_list) :: fields
         integer :: first, last, rows, i, begin(2)
         logical :: found

         begin = file%position()
         rows = 0
         do
            call file%next_line(first, last, found)
            if (.not. found) exit
            if (.not. is_blank(file%text(first:last))) rows = rows + 1
         end do
         call file%go_back(begin)
         if (rows == 0) then
            call fatal_error(error, bad_input, path//': has no rows of numbers; check the file')
            return
         end if
         history%rows = 0
         do
            call file%next_line(first, last, found)
            if (.not. found) exit
            if (is_blank(file%text(first:last))) cycle
            call split(file%text(:last), first, separator, fields)
            if (fields%count > most_columns) then
               call fatal_error(error, bad_input, path//' line '//to_text(file%line)//': has more than '// &
                                to_text(most_columns)//' columns; is it a history?')
               return
            end if
            if (history%rows == 0) then
               history%columns = fields%count
               allocate (history%values(fields%count, rows))
            else if (fields%count /= history%columns) then
               call fatal_error(error, bad_input, path//' line '//to_text(file%line)//': has '// &
                                to_text(fields%count)//trim(merge(' value ', ' values', &
                                fields%count == 1))//', the rows before have '//to_text(history%columns)// &
                                '; every row has one for each column')
               return
            end if
            history%rows = history%rows + 1
            do i = 1, fields%count
               call read_field(fields, i, history%values(i, history%rows))
               if (allocated(error)) return
            end do
         end do
      end subroutine read_rows

      !> The number in field i of the present line; `error` is set if it is none.
      subroutine read_field(fields, i, value)
         type(field_list), intent(in) :: fields
         integer, intent(in) :: i
         real(wp), intent(out) :: value
         character(len=:), allocatable :: remedy
         integer :: status

         associate (word => file%text(fields%first(i):fields%last(i)))
            call read_real(word, value, status)
            if (status == number_ok) return
            remedy = 'is not a number; correct the file ('//elsewhere//')'
            if (status == number_not_finite) remedy = 'is not a finite number; correct the file'
            if (word == '') remedy = 'is empty; correct the file'
            call fatal_error(error, bad_input, path//' line '//to_text(file%line)//', value '//to_text(i)// &
                             ": '"//snippet(word)//"' "//remedy)
         end associate
      end subroutine read_field

   end subroutine read_history

   !> Whether a file is one of PEER: it has a line with a name, a line with a count (perhaps followed by 0),
   !> and then at least two numbers in a line. The file is left at its start.
   logical function is_peer(file)
      type(text_file), intent(inout) :: file
      type(field_list) :: fields
      integer :: first(3), last(3), i, columns
      logical :: found

      call file%go_back()
      do i = 1, 3
         call file%next_line(first(i), last(i), found)
      end do
      call file%go_back()
      call split(file%text(:last(3)), first(3), ' ', fields)
      columns = fields%count
      is_peer = found .and. columns >= 2
      if (.not. is_peer) return
      ! The name of a test may be a number, but a line with as many numbers as a row is itself a row.
      call split(file%text(:last(1)), first(1), ' ', fields)
      is_peer = fields%count > 0 .and. (fields%count /= columns .or. &
                                        count_numbers(file%text, fields) < columns)
      ! A csv separated by blanks may have the row `0 0` there.
      call split(file%text(:last(2)), first(2), ' ', fields)
      is_peer = is_peer .and. count_of(file%text(first(2):last(2))) >= merge(0, 1, fields%count == 1)
   end function is_peer

   !> How many fields of a line are numbers.
   integer function count_numbers(text, fields) result(numbers)
      character(len=*), intent(in) :: text
      type(field_list), intent(in) :: fields
      real(wp) :: value
      integer :: status, i

      numbers = 0
      do i = 1, fields%count
         call read_real(text(fields%first(i):fields%last(i)), value, status)
         if (status == number_ok) numbers = numbers + 1
      end do
   end function count_numbers

   !> Whether a file is an AT2 file of a ground motion: of its four lines above the numbers the last names
   !> their count, NPTS, and the time step, DT. The file is left at its start.
   logical function is_at2(file)
      type(text_file), intent(inout) :: file
      integer :: first, last, i
      logical :: found

      call file%go_back()
      do i = 1, at2_head
         call file%next_line(first, last, found)
      end do
      is_at2 = index(file%text(first:last), 'NPTS') > 0 .and. index(file%text(first:last), 'DT') > 0
      call file%go_back()
   end function is_at2

   !> The count on the second line of a PEER file, alone or followed by one 0; -1 if that line has none.
   integer function count_of(line)
      character(len=*), intent(in) :: line
      type(field_list) :: fields

      count_of = -1
      call split(line, 1, ' ', fields)
      if (fields%count < 1 .or. fields%count > 2) return
      if (fields%count == 2) then
         if (line(fields%first(2):fields%last(2)) /= '0') return
      end if
      associate (word => line(fields%first(1):fields%last(1)))
         if (is_integer(word)) read (word, '(i9)') count_of
      end associate
   end function count_of

   !> Cut a line into at most `most_columns` + 1 fields. If the separator is a blank, any run of blanks and
   !> tabs separates two fields.
   subroutine split(line, first, separator, fields)
      character(len=*), intent(in) :: line
      !> Where the line begins in the text `line`, which ends with the line
      integer, intent(in) :: first
      character(len=1), intent(in) :: separator
      type(field_list), intent(out) :: fields
      integer :: at, last, stop_at

      at = first
      ! Spreadsheets may write separators at the end of every line.
      last = first - 1 + verify(line(first:), blanks, back=.true.)
      do while (at <= last .and. fields%count <= most_columns)
         if (separator == ' ') then
            stop_at = verify(line(at:last), blanks)
            if (stop_at == 0) exit
            at = at + stop_at - 1
            stop_at = scan(line(at:last), blanks)
         else
            stop_at = end_of_field(line(at:last), separator)
         end if
         fields%count = fields%count + 1
         fields%first(fields%count) = at
         fields%last(fields%count) = merge(last, at + stop_at - 2, stop_at == 0)
         call trim_field(line, fields%first(fields%count), fields%last(fields%count))
         if (stop_at == 0) exit
         at = at + stop_at
         ! The line ends with a separator: an empty field follows.
         if (at > last .and. separator /= ' ') then
            fields%count = min(fields%count + 1, most_columns + 1)
            fields%first(fields%count) = last + 1
            fields%last(fields%count) = last
         end if
      end do
   end subroutine split

   !> Position of the separator that ends the first field of a line, 0 if it is the last field; separators
   !> between quotes are not counted.
   pure integer function end_of_field(line, separator) result(at)
      character(len=*), intent(in) :: line
      character(len=1), intent(in) :: separator
      !> Position of the opening quote, then of the closing one
      integer :: quote

      at = index(line, separator)
      if (at == 0) return
      quote = index(line(:at), '"')
      if (quote == 0) return
      if (verify(line(:quote - 1), ' ') > 0) return
      quote = quote + index(line(quote + 1:), '"')
      at = index(line(quote + 1:), separator)
      if (at > 0) at = at + quote
   end function end_of_field

   !> Remove the blanks around a field, and quotes that enclose it; a second pass removes blanks within the
   !> quotes.
   pure subroutine trim_field(line, first, last)
      character(len=*), intent(in) :: line
      !> First and last character of the field in the line
      integer, intent(inout) :: first, last
      integer :: pass

      do pass = 1, 2
         last = first - 1 + verify(line(first:last), blanks, back=.true.)
         first = first + max(verify(line(first:last), blanks), 1) - 1
         if (pass == 2 .or. last <= first) return
         if (line(first:first) /= '"' .or. line(last:last) /= '"') return
         first = first + 1
         last = last - 1
      end do
   end subroutine trim_field

   !> Whether a line has nothing but blanks, or is a comment.
   logical function is_blank(line)
      character(len=*), intent(in) :: line
      integer :: at

      at = verify(line, blanks)
      is_blank = at == 0
      if (at > 0) is_blank = line(at:at) == '#'
   end function is_blank

   !> A short piece of a text for a message, without control characters.
   function snippet(text)
      character(len=*), intent(in) :: text
      character(len=min(len(text), 40)) :: snippet
      integer :: i

      snippet = text
      do i = 1, len(snippet)
         if (iachar(snippet(i:i)) < 32 .or. iachar(snippet(i:i)) > 126) snippet(i:i) = '?'
      end do
   end function snippet

end module rbs_io_history
