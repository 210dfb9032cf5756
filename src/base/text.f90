!> Text for messages: numbers as text, and the valid name closest to a misspelt one.
!>
!> The length of every result is computed beforehand. For a text of deferred length gfortran keeps the
!> length in static storage, which threads would share.
module rbs_base_text
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_is_finite
   use rbs_base_kinds, only: wp
   implicit none
   private

   public :: to_text, exact_text, integer_length, lower, suggestion, list_of

   !> Longest text of a number.
   integer, parameter :: longest = 32

   !> A number as short text for messages and headers.
   interface to_text
      module procedure :: real_to_text, integer_to_text
   end interface to_text

contains

   !> At most six significant digits, without blanks and trailing zeros: 0.0016, 7.0387e+08.
   pure function real_to_text(x) result(text)
      real(wp), intent(in) :: x
      character(len=real_length(x)) :: text
      character(len=longest) :: buffer

      call write_real(x, buffer)
      text = buffer(:len(text))
   end function real_to_text

   pure integer function real_length(x)
      real(wp), intent(in) :: x
      character(len=longest) :: buffer

      call write_real(x, buffer)
      real_length = len_trim(buffer)
   end function real_length

   pure function integer_to_text(i) result(text)
      integer, intent(in) :: i
      character(len=integer_length(i)) :: text
      integer :: left, place

      ! Without formatted output, which is slow: every key of an input has a location with a line number.
      left = i
      if (i < 0) text(1:1) = '-'
      do place = len(text), merge(2, 1, i < 0), -1
         text(place:place) = achar(iachar('0') + abs(mod(left, 10)))
         left = left/10
      end do
   end function integer_to_text

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
      character(len=longest) :: buffer, form
      integer :: mark, power

      if (ieee_is_nan(x)) then
         text = 'NaN'
      else if (.not. ieee_is_finite(x)) then
         text = merge('Infinity ', '-Infinity', x > 0.0_wp)
      else if (.not. abs(x) > 0.0_wp) then
         text = '0'
      else
         write (buffer, '(es13.5e3)') x
         buffer = adjustl(buffer)
         mark = index(buffer, 'E')
         read (buffer(mark + 1:), *) power
         if (power >= -4 .and. power <= 5) then
            write (form, '(a, i0, a)') '(f24.', 5 - power, ')'
            write (text, form) x
            text = adjustl(text)
            if (text(1:1) == '.') text = '0'//text(:longest - 1)
            if (text(1:2) == '-.') text = '-0'//text(2:longest - 1)
            call cut_zeros(text)
         else
            text = buffer(:mark - 1)
            call cut_zeros(text)
            write (form, '(sp, i0.2)') power
            text = trim(text)//'e'//form
         end if
      end if
   end subroutine write_real

   !> A number with the fewest digits from which the same bits are read back.
   pure character(len=longest) function exact_text(x) result(text)
      !> Finite
      real(wp), intent(in) :: x
      character(len=longest) :: buffer, digits
      real(wp) :: again
      integer :: count, mark, power, last

      text = '0'
      if (.not. abs(x) > 0.0_wp) return
      do count = 15, 17
         write (digits, '(a, i0, a)') '(es', 26, '.'//to_text(count - 1)//'e3)'
         write (buffer, digits) abs(x)
         read (buffer, *) again
         if (.not. abs(again - abs(x)) > 0.0_wp) exit
      end do
      buffer = adjustl(buffer)
      mark = index(buffer, 'E')
      read (buffer(mark + 1:), *) power
      digits = buffer(1:1)//buffer(3:mark - 1)
      last = verify(digits(:mark - 2), '0', back=.true.)
      if (power >= last - 1 .and. power <= 8) then
         text = digits(:last)//repeat('0', power - last + 1)
      else if (power >= 0 .and. power <= 8) then
         text = digits(:power + 1)//'.'//digits(power + 2:last)
      else if (power < 0 .and. power >= -4) then
         text = '0.'//repeat('0', -power - 1)//digits(:last)
      else if (last == 1) then
         text = digits(1:1)//'e'//to_text(power)
      else
         text = digits(1:1)//'.'//digits(2:last)//'e'//to_text(power)
      end if
      if (x < 0.0_wp) text = '-'//text(:longest - 1)
   end function exact_text

   !> Remove trailing zeros, and a trailing point, from a decimal number.
   pure subroutine cut_zeros(number)
      character(len=longest), intent(inout) :: number
      integer :: last

      last = len_trim(number)
      if (index(number, '.') == 0) return
      do while (number(last:last) == '0')
         last = last - 1
      end do
      if (number(last:last) == '.') last = last - 1
      number = number(:last)
   end subroutine cut_zeros

   !> Lower case (ASCII).
   pure function lower(word) result(text)
      character(len=*), intent(in) :: word
      character(len=len(word)) :: text
      integer :: i, code

      text = word
      do i = 1, len(word)
         code = iachar(word(i:i))
         if (code >= iachar('A') .and. code <= iachar('Z')) text(i:i) = achar(code + 32)
      end do
   end function lower

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

      if (len(text) > 0) text = "; did you mean '"//trim(names(nearest_place(word, names)))//"'?"
   end function suggestion

   pure integer function suggestion_length(word, names) result(length)
      character(len=*), intent(in) :: word, names(:)
      integer :: place

      place = nearest_place(word, names)
      length = 0
      if (place > 0) length = len_trim(names(place)) + len("; did you mean ''?")
   end function suggestion_length

   !> Place of the name that is nearest to a word; 0 if a third of the word or more is other.
   pure integer function nearest_place(word, names) result(place)
      character(len=*), intent(in) :: word, names(:)
      integer :: i, distance, least

      place = 0
      least = (len_trim(word) + 1)/3 + 1
      do i = 1, size(names)
         distance = edit_distance(lower(trim(word)), lower(trim(names(i))))
         if (distance < least) then
            least = distance
            place = i
         end if
      end do
   end function nearest_place

   !> Levenshtein distance: the least number of characters to insert, remove or change.
   pure integer function edit_distance(a, b) result(distance)
      character(len=*), intent(in) :: a, b
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
