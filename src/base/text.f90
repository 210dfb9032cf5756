!> Numbers as text, names compared: what messages are made of.
module rbs_base_text
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_is_finite
   use rbs_base_kinds, only: wp
   implicit none
   private

   public :: to_text, lower, nearest_name, list_of

   !> A number as short text for messages and headers.
   interface to_text
      module procedure :: real_to_text, integer_to_text
   end interface to_text

contains

   !> Six significant digits at the most, without blanks and trailing zeros: 0.0016, 7.0387e+08.
   pure function real_to_text(x) result(text)
      real(wp), intent(in) :: x
      character(len=:), allocatable :: text
      character(len=32) :: buffer, form
      integer :: mark, power

      if (ieee_is_nan(x)) then
         text = 'NaN'
      else if (.not. ieee_is_finite(x)) then
         text = merge('Infinity ', '-Infinity', x > 0.0_wp)
         text = trim(text)
      else if (.not. abs(x) > 0.0_wp) then
         text = '0'
      else
         write (buffer, '(es13.5e3)') x
         buffer = adjustl(buffer)
         mark = index(buffer, 'E')
         read (buffer(mark + 1:), *) power
         if (power >= -4 .and. power <= 5) then
            write (form, '(a, i0, a)') '(f24.', 5 - power, ')'
            write (buffer, form) x
            text = without_zeros(trim(adjustl(buffer)))
            if (text(1:1) == '.') text = '0'//text
            if (text(1:2) == '-.') text = '-0'//text(2:)
         else
            text = without_zeros(buffer(:mark - 1))//'e'//exponent_text(power)
         end if
      end if
   end function real_to_text

   pure function integer_to_text(i) result(text)
      integer, intent(in) :: i
      character(len=:), allocatable :: text
      character(len=16) :: buffer

      write (buffer, '(i0)') i
      text = trim(buffer)
   end function integer_to_text

   pure function exponent_text(power) result(text)
      integer, intent(in) :: power
      character(len=:), allocatable :: text
      character(len=8) :: buffer

      write (buffer, '(sp, i0.2)') power
      text = trim(buffer)
   end function exponent_text

   !> A decimal number without the zeros (and the point) at its end.
   pure function without_zeros(number) result(text)
      character(len=*), intent(in) :: number
      character(len=:), allocatable :: text
      integer :: last

      last = len_trim(number)
      if (index(number, '.') > 0) then
         do while (number(last:last) == '0')
            last = last - 1
         end do
         if (number(last:last) == '.') last = last - 1
      end if
      text = number(:last)
   end function without_zeros

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
      character(len=:), allocatable :: text
      integer :: i

      text = ''
      do i = 1, size(names)
         if (i > 1) text = text//', '
         text = text//trim(names(i))
      end do
   end function list_of

   !> The valid name that a misspelt word comes nearest to by edit distance.
   pure function nearest_name(word, names) result(name)
      character(len=*), intent(in) :: word
      character(len=*), intent(in) :: names(:)
      character(len=:), allocatable :: name
      integer :: i, distance, least

      name = ''
      least = huge(1)
      do i = 1, size(names)
         distance = edit_distance(lower(trim(word)), lower(trim(names(i))))
         if (distance < least) then
            least = distance
            name = trim(names(i))
         end if
      end do
   end function nearest_name

   !> Levenshtein distance: the least number of letters put in, taken out or changed.
   pure function edit_distance(a, b) result(distance)
      character(len=*), intent(in) :: a, b
      integer :: distance
      integer :: row(0:len(b))
      integer :: i, j, diagonal, above

      do j = 0, len(b)
         row(j) = j
      end do
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
