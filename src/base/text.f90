!> Text for messages: numbers as text, and the valid name closest to a misspelt one.
!>
!> The length of every result is computed beforehand. For a text of deferred length gfortran keeps the
!> length in static storage, which threads would share.
module rbs_base_text
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_is_finite
   use rbs_base_kinds, only: wp
   implicit none
   private

   public :: to_text, exact_text, integer_length, lower, suggestion, list_of, next_line, text_buffer

   !> Longest text of a number.
   integer, parameter :: longest = 32

   !> A number as short text for messages and headers.
   interface to_text
      module procedure :: real_to_text, integer_to_text
   end interface to_text

   !> A text to which other texts are appended.
   type :: text_buffer
      !> Number of characters so far
      integer :: length = 0
      !> The text, followed by free space
      character(len=:), allocatable :: text
   contains
      procedure :: append
   end type text_buffer

contains

   !> At most six significant digits, without blanks and trailing zeros: 0.0016, 7.0387e+08.
   pure function real_to_text(x) result(text)
      real(wp), intent(in) :: x
      character(len=real_length(x)) :: text
      character(len=longest) :: buffer

      call write_real(x, buffer)
      text = buffer(:len(text))
   end function real_to_text

   !> Length of the text of a real number.
   pure integer function real_length(x)
      real(wp), intent(in) :: x
      character(len=longest) :: buffer

      call write_real(x, buffer)
      real_length = len_trim(buffer)
   end function real_length

   !> A whole number as text.
   pure function integer_to_text(i) result(text)
      integer, intent(in) :: i
      character(len=integer_length(i)) :: text
      integer :: left, digit

      ! Without formatted output, which is slow: every key of an input has a location with a line number.
      left = i
      if (i < 0) text(1:1) = '-'
      do digit = len(text), merge(2, 1, i < 0), -1
         text(digit:digit) = achar(iachar('0') + abs(mod(left, 10)))
         left = left/10
      end do
   end function integer_to_text

   !> Length of the text of a whole number, with its sign.
   pure integer function integer_length(i)
      integer, intent(in) :: i
      integer :: left

      integer_length = merge(2, 1, i < 0)
      left = i/10
      do while (left /= 0)
         integer_length = integer_length + 1
         left = left/10
      end do
   end function integer_length

   !> Write a number, adjusted to the left.
   pure subroutine write_real(x, text)
      real(wp), intent(in) :: x
      character(len=longest), intent(out) :: text
      character(len=longest) :: digits, exponent
      integer :: power

      if (ieee_is_nan(x)) then
         text = 'NaN'
      else if (.not. ieee_is_finite(x)) then
         text = merge('Infinity ', '-Infinity', x > 0.0_wp)
      else if (.not. abs(x) > 0.0_wp) then
         text = '0'
      else
         call find_digits(x, 6, digits, power)
         if (power >= -4 .and. power <= 5) then
            text = with_point(trim(digits), power)
         else
            write (exponent, '(sp, i0.2)') power
            text = trim(with_point(trim(digits), 0))//'e'//exponent
         end if
         if (x < 0.0_wp) text = '-'//text(:longest - 1)
      end if
   end subroutine write_real

   !> A number with the fewest digits from which the same bits are read back.
   pure character(len=longest) function exact_text(x) result(text)
      !> Finite
      real(wp), intent(in) :: x
      character(len=longest) :: digits
      real(wp) :: again
      integer :: count, power

      text = '0'
      if (.not. abs(x) > 0.0_wp) return
      do count = 15, 17
         call find_digits(x, count, digits, power)
         if (power >= -4 .and. power <= 8) then
            text = with_point(trim(digits), power)
         else
            text = trim(with_point(trim(digits), 0))//'e'//to_text(power)
         end if
         read (text, *) again
         if (.not. abs(again - abs(x)) > 0.0_wp) exit
      end do
      if (x < 0.0_wp) text = '-'//text(:longest - 1)
   end function exact_text

   !> Significant digits of the size of a number, without trailing zeros, and the power of ten of the first.
   pure subroutine find_digits(x, count, digits, power)
      !> Finite and not zero
      real(wp), intent(in) :: x
      !> Digits to which the number is rounded
      integer, intent(in) :: count
      character(len=longest), intent(out) :: digits
      integer, intent(out) :: power
      character(len=longest) :: buffer, form
      integer :: mark

      write (form, '(a, i0, a)') '(es32.', count - 1, 'e3)'
      write (buffer, form) abs(x)
      buffer = adjustl(buffer)
      mark = index(buffer, 'E')
      read (buffer(mark + 1:), *) power
      digits = buffer(1:1)//buffer(3:mark - 1)
      digits = digits(:verify(trim(digits), '0', back=.true.))
   end subroutine find_digits

   !> A decimal number from its significant digits and the power of ten of the first: 0.016 from 16 and -2.
   pure character(len=longest) function with_point(digits, power) result(text)
      character(len=*), intent(in) :: digits
      integer, intent(in) :: power

      if (power < 0) then
         text = '0.'//repeat('0', -power - 1)//digits
      else if (power < len(digits) - 1) then
         text = digits(:power + 1)//'.'//digits(power + 2:)
      else
         text = digits//repeat('0', power - len(digits) + 1)
      end if
   end function with_point

   !> Append a text.
   subroutine append(self, text)
      class(text_buffer), intent(inout) :: self
      character(len=*), intent(in) :: text
      character(len=:), allocatable :: longer

      if (.not. allocated(self%text)) allocate (character(len=1024) :: self%text)
      if (self%length + len(text) > len(self%text)) then
         allocate (character(len=2*(self%length + len(text))) :: longer)
         longer(:self%length) = self%text(:self%length)
         call move_alloc(longer, self%text)
      end if
      self%text(self%length + 1:self%length + len(text)) = text
      self%length = self%length + len(text)
   end subroutine append

   !> Lower case (ASCII).
   elemental function lower(word) result(text)
      character(len=*), intent(in) :: word
      character(len=len(word)) :: text
      integer :: i, code

      text = word
      do i = 1, len(word)
         code = iachar(word(i:i))
         if (code >= iachar('A') .and. code <= iachar('Z')) text(i:i) = achar(code + 32)
      end do
   end function lower

   !> Whether there is a further line in a text; its first and last character, from those of the line before.
   logical function next_line(text, first, last)
      character(len=*), intent(in) :: text
      !> First and last character of the line before, replaced; before the first line any number and -1
      integer, intent(inout) :: first, last

      first = last + 2
      next_line = first <= len(text)
      last = index(text(first:), new_line('a')) + first - 2
      if (last == first - 2) last = len(text)
   end function next_line

   !> The names joined by commas, for "valid names are ...".
   pure function list_of(names) result(text)
      character(len=*), intent(in) :: names(:)
      character(len=sum(len_trim(names)) + 2*max(size(names) - 1, 0)) :: text
      integer :: i, at

      at = 0
      do i = 1, size(names)
         if (i > 1) then
            text(at + 1:at + 2) = ', '
            at = at + 2
         end if
         text(at + 1:at + len_trim(names(i))) = trim(names(i))
         at = at + len_trim(names(i))
      end do
   end function list_of

   !> "; did you mean 'height'?" where a valid name is near to a word by edit distance, else nothing.
   pure function suggestion(word, names) result(text)
      character(len=*), intent(in) :: word, names(:)
      character(len=suggestion_length(word, names)) :: text

      if (len(text) > 0) text = "; did you mean '"//trim(names(nearest_name(word, names)))//"'?"
   end function suggestion

   !> Length of the text of `suggestion`, 0 where it is empty.
   pure integer function suggestion_length(word, names) result(length)
      character(len=*), intent(in) :: word, names(:)
      integer :: number

      number = nearest_name(word, names)
      length = 0
      if (number > 0) length = len_trim(names(number)) + len("; did you mean ''?")
   end function suggestion_length

   !> Place of the name that is nearest to a word by edit distance; 0 if no distance is at most a third of the
   !> length of the word, rounded.
   pure integer function nearest_name(word, names) result(number)
      character(len=*), intent(in) :: word, names(:)
      integer :: i, distance, least

      number = 0
      least = (len_trim(word) + 1)/3 + 1
      do i = 1, size(names)
         distance = edit_distance(lower(trim(word)), lower(trim(names(i))))
         if (distance < least) then
            least = distance
            number = i
         end if
      end do
   end function nearest_name

   !> Levenshtein distance: the least number of characters to insert, remove or change.
   pure integer function edit_distance(a, b) result(distance)
      character(len=*), intent(in) :: a, b
      !> Distances of the first i characters of a from the first j of b
      integer :: row(0:len(b)), i, j, diagonal, above

      row = [(j, j=0, len(b))]
      do i = 1, len(a)
         diagonal = row(0)
         row(0) = i
         do j = 1, len(b)
            above = row(j)
            row(j) = min(above + 1, row(j - 1) + 1, diagonal + merge(0, 1, a(i:i) == b(j:j)))
            diagonal = above
         end do
      end do
      distance = row(len(b))
   end function edit_distance

end module rbs_base_text
