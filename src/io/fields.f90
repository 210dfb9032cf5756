!> A line of a file of rows, cut into its fields.
module rbs_io_fields
   use rbs_base_error, only: error_type, fatal_error, bad_input
   use rbs_base_text, only: to_text
   use rbs_io_text_file, only: number_not_finite
   implicit none
   private

   public :: field_list, most_columns, split, separator_of, is_blank, plain, snippet, report_number

   !> Most fields of a line.
   integer, parameter :: most_columns = 64

   character(len=1), parameter :: tab = achar(9)

   !> First and last characters of the fields of a line.
   type :: field_list
      integer :: count = 0, first(most_columns + 1) = 0, last(most_columns + 1) = 0
   end type field_list

contains

   !> A field that is not a number, as an error.
   subroutine report_number(path, line, column, word, status, error)
      character(len=*), intent(in) :: path, word
      integer, intent(in) :: line, column, status
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: remedy

      remedy = 'is not a number'
      if (status == number_not_finite) remedy = 'is not a finite number'
      if (word == '') remedy = 'is empty'
      call fatal_error(error, bad_input, path//' line '//to_text(line)//', value '//to_text(column)// &
                       ": '"//snippet(word)//"' "//remedy//'; correct the file')
   end subroutine report_number

   !> Cut a line into at most `most_columns` + 1 fields. If the separator is a blank, any run of blanks and
   !> tabs separates two fields.
   subroutine split(line, first, separator, fields)
      character(len=*), intent(in) :: line
      !> Where the line begins in the text, which ends with it
      integer, intent(in) :: first
      character(len=1), intent(in) :: separator
      type(field_list), intent(out) :: fields
      integer :: at, last, stop_at

      at = first
      last = len(line)
      ! Spreadsheets may write separators at the end of every line.
      do while (last >= first)
         if (scan(line(last:last), ' '//tab) == 0) exit
         last = last - 1
      end do
      do while (at <= last .and. fields%count <= most_columns)
         if (separator == ' ') then
            stop_at = verify(line(at:last), ' '//tab)
            if (stop_at == 0) exit
            at = at + stop_at - 1
            stop_at = scan(line(at:last), ' '//tab)
         else
            stop_at = end_of_field(line(at:last), separator)
         end if
         fields%count = fields%count + 1
         fields%first(fields%count) = at
         fields%last(fields%count) = merge(last, at + stop_at - 2, stop_at == 0)
         call trim_field(line, fields%first(fields%count), fields%last(fields%count))
         if (stop_at == 0) exit
         at = at + stop_at
         if (at > last .and. separator /= ' ') then
            fields%count = min(fields%count + 1, most_columns + 1)
            fields%first(fields%count) = last + 1
            fields%last(fields%count) = last
         end if
      end do
   end subroutine split

   !> Place of the separator that ends the first field of a line, 0 if it is the last field; separators
   !> between quotes are not counted.
   pure integer function end_of_field(line, separator) result(place)
      character(len=*), intent(in) :: line
      character(len=1), intent(in) :: separator
      integer :: quote

      place = index(line, separator)
      if (place == 0) return
      quote = index(line(:place), '"')
      if (quote == 0) return
      if (verify(line(:quote - 1), ' ') > 0) return
      quote = quote + index(line(quote + 1:), '"')
      place = index(line(quote + 1:), separator)
      if (place > 0) place = place + quote
   end function end_of_field

   !> Remove the blanks around a field, and quotes that enclose it.
   pure subroutine trim_field(line, first, last)
      character(len=*), intent(in) :: line
      integer, intent(inout) :: first, last

      call trim_blanks(line, first, last)
      if (last <= first) return
      if (line(first:first) /= '"' .or. line(last:last) /= '"') return
      first = first + 1
      last = last - 1
      call trim_blanks(line, first, last)
   end subroutine trim_field

   pure subroutine trim_blanks(line, first, last)
      character(len=*), intent(in) :: line
      integer, intent(inout) :: first, last

      do while (first <= last)
         if (line(first:first) /= ' ' .and. line(first:first) /= tab) exit
         first = first + 1
      end do
      do while (last >= first)
         if (line(last:last) /= ' ' .and. line(last:last) /= tab) exit
         last = last - 1
      end do
   end subroutine trim_blanks

   !> The separator of a csv: semicolon, comma, tab or blanks.
   character(len=1) function separator_of(line)
      character(len=*), intent(in) :: line

      separator_of = ' '
      if (index(line, ';') > 0) then
         separator_of = ';'
      else if (index(line, ',') > 0) then
         separator_of = ','
      else if (index(trim(line), tab) > 0) then
         separator_of = tab
      end if
   end function separator_of

   logical function is_blank(line)
      character(len=*), intent(in) :: line
      integer :: at

      at = verify(line, ' '//tab)
      is_blank = at == 0
      if (at > 0) is_blank = line(at:at) == '#'
   end function is_blank

   !> A text without blanks, tabs and quotes around it.
   pure function plain(text)
      character(len=*), intent(in) :: text
      character(len=plain_length(text)) :: plain
      integer :: first, last

      first = 1
      last = len(text)
      call trim_field(text, first, last)
      plain = text(first:last)
   end function plain

   pure integer function plain_length(text)
      character(len=*), intent(in) :: text
      integer :: first, last

      first = 1
      last = len(text)
      call trim_field(text, first, last)
      plain_length = last - first + 1
   end function plain_length

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

end module rbs_io_fields
