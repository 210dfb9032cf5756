!> A text file in memory: its lines, with any line ending, and strict reading of numbers.
module rbs_io_text_file
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use, intrinsic :: iso_fortran_env, only: int64
   use rbs_base_error, only: error_type, fatal_error, bad_input
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: lower, to_text
   implicit none
   private

   public :: text_file, load_text, read_real, is_integer
   public :: number_ok, number_wrong, number_not_finite

   !> Results of `read_real`.
   integer, parameter :: number_ok = 0, number_wrong = 1, number_not_finite = 2

   !> Longest text that is read as a number.
   integer, parameter :: most_digits = 4096

   character(len=1), parameter :: cr = achar(13), lf = achar(10)

   !> The text of a file and a position in it.
   type :: text_file
      character(len=:), allocatable :: text
      !> Number of the line read last
      integer :: line = 0
      integer, private :: at = 1
   contains
      procedure :: next_line
      procedure :: place
      procedure :: go_back
   end type text_file

contains

   !> Read a whole file.
   subroutine load_text(file, path, most, error)
      type(text_file), intent(out) :: file
      character(len=*), intent(in) :: path
      !> Largest size that is accepted [bytes]
      integer, intent(in) :: most
      type(error_type), allocatable, intent(out) :: error
      character(len=256) :: message
      integer(int64) :: size
      integer :: unit, status
      logical :: there

      inquire (file=path//'/.', exist=there)
      if (there) then
         call fatal_error(error, bad_input, path//': is a folder; give the path of a file')
         return
      end if
      open (newunit=unit, file=path, access='stream', form='unformatted', action='read', status='old', &
            iostat=status, iomsg=message)
      if (status /= 0) then
         call fatal_error(error, bad_input, path//': cannot be opened ('//trim(message)// &
                          '); check the path and the permissions')
         return
      end if
      inquire (unit=unit, size=size)
      if (size > int(most, int64)) then
         call fatal_error(error, bad_input, path//': has '//to_text(real(size, wp))// &
                          ' bytes, more than the '//to_text(most)//' that are read; is it the right file?')
      else if (size < 1_int64) then
         call fatal_error(error, bad_input, path//': is empty')
      else
         allocate (character(len=int(size)) :: file%text)
         read (unit, iostat=status, iomsg=message) file%text
         if (status /= 0) call fatal_error(error, bad_input, path//': cannot be read ('//trim(message)//')')
      end if
      close (unit)
      if (allocated(error)) return
      if (len(file%text) >= 3) then
         if (file%text(:3) == char(239)//char(187)//char(191)) file%text = file%text(4:)
      end if
      if (index(file%text, achar(0)) > 0) then
         call fatal_error(error, bad_input, path//': is not a text file (it has a zero byte)')
      end if
   end subroutine load_text

   !> First and last character of the next line in `text`; lines end with LF, CR or both. `found` is false
   !> after the last line.
   subroutine next_line(self, first, last, found)
      class(text_file), intent(inout) :: self
      integer, intent(out) :: first, last
      logical, intent(out) :: found
      integer :: length

      first = self%at
      found = first <= len(self%text)
      last = first - 1
      if (.not. found) return
      length = scan(self%text(first:min(first + 4095, len(self%text))), lf//cr)
      if (length == 0) length = scan(self%text(first:), lf//cr)
      self%line = self%line + 1
      if (length == 0) then
         last = len(self%text)
         self%at = last + 1
         return
      end if
      last = first + length - 2
      self%at = last + 2
      if (self%text(last + 1:last + 1) == cr .and. self%at <= len(self%text)) then
         if (self%text(self%at:self%at) == lf) self%at = self%at + 1
      end if
   end subroutine next_line

   !> The present position, for `go_back`.
   pure function place(self)
      class(text_file), intent(in) :: self
      integer :: place(2)

      place = [self%at, self%line]
   end function place

   !> Go back to a position, by default to the start of the file.
   subroutine go_back(self, place)
      class(text_file), intent(inout) :: self
      integer, intent(in), optional :: place(2)

      self%at = 1
      self%line = 0
      if (present(place)) then
         self%at = place(1)
         self%line = place(2)
      end if
   end subroutine go_back

   !> Read a word as a number: a sign, digits, a point, an exponent with e or d. A Fortran read would also
   !> accept `1,5`, `1/2` and `3*4`.
   subroutine read_real(word, value, status)
      character(len=*), intent(in) :: word
      real(wp), intent(out) :: value
      !> `number_ok`, `number_wrong`, or `number_not_finite` for NaN, infinity and overflow
      integer, intent(out) :: status
      character(len=64) :: buffer
      character(len=12) :: form
      integer :: ios

      call read_short(word, value, status)
      if (status == number_ok) return
      value = 0.0_wp
      status = number_wrong
      select case (lower(word(min(1, len(word) + 1):)))
      case ('nan', '+nan', '-nan', 'inf', '+inf', '-inf', 'infinity', '+infinity', '-infinity')
         status = number_not_finite
         return
      case default
         if (len(word) > most_digits .or. .not. looks_real(word)) return
      end select
      if (overflows(word)) then
         status = number_not_finite
         return
      end if
      if (len(word) <= len(buffer)) then
         buffer = word
         read (buffer, '(f64.0)', iostat=ios) value
      else
         write (form, '(a, i0, a)') '(f', len(word), '.0)'
         read (word, form, iostat=ios) value
      end if
      if (ios /= 0) then
         status = number_not_finite
      else
         status = merge(number_ok, number_not_finite, ieee_is_finite(value))
      end if
   end subroutine read_real

   !> Read a decimal number with few digits. A whole number below 2**53, multiplied or divided by an exact
   !> power of ten, is rounded once, which gives the nearest number. Other words are left to the library.
   pure subroutine read_short(word, value, status)
      character(len=*), intent(in) :: word
      real(wp), intent(out) :: value
      !> `number_ok`, or `number_wrong` if the number has more digits
      integer, intent(out) :: status
      integer, parameter :: most_places = 15, most_power = 22
      real(wp), parameter :: ten = 10.0_wp
      integer(int64) :: mantissa
      integer :: i, digit, places, power, exponent, sign_of_power
      logical :: point, negative, in_exponent

      value = 0.0_wp
      status = number_wrong
      mantissa = 0_int64
      places = 0
      power = 0
      exponent = -1
      sign_of_power = 1
      point = .false.
      in_exponent = .false.
      negative = .false.
      do i = 1, len(word)
         digit = iachar(word(i:i)) - iachar('0')
         if (digit >= 0 .and. digit <= 9) then
            if (in_exponent) then
               exponent = 10*max(exponent, 0) + digit
               if (exponent > most_power + most_places) return
            else
               mantissa = 10_int64*mantissa + digit
               places = places + 1
               if (places > most_places) return
               if (point) power = power - 1
            end if
         else if (word(i:i) == '.' .and. .not. (point .or. in_exponent)) then
            point = .true.
         else if ((word(i:i) == 'e' .or. word(i:i) == 'E') .and. places > 0 .and. .not. in_exponent) then
            in_exponent = .true.
         else if (word(i:i) == '-' .and. i == 1) then
            negative = .true.
         else if (word(i:i) == '-' .and. in_exponent .and. exponent < 0 .and. sign_of_power == 1) then
            sign_of_power = -1
         else
            return
         end if
      end do
      if (places == 0 .or. (in_exponent .and. exponent < 0)) return
      power = power + sign_of_power*max(exponent, 0)
      if (abs(power) > most_power) return
      value = real(mantissa, wp)
      if (power > 0) value = value*ten**power
      if (power < 0) value = value/ten**(-power)
      if (negative) value = -value
      status = number_ok
   end subroutine read_short

   !> Whether a number that `looks_real` is too large for the arithmetic. This is checked before the read,
   !> which would overflow inside the C library and end a program that traps overflow.
   pure logical function overflows(word)
      character(len=*), intent(in) :: word
      !> Digits of the largest number, rounded down: 1.79769313486231580 e308
      character(len=*), parameter :: largest = '179769313486231580'
      integer, parameter :: largest_power = 308
      character(len=len(largest)) :: digits
      integer :: mark, at, last, point, count, power, first

      overflows = .false.
      mark = scan(word, 'eEdD')
      last = merge(mark - 1, len(word), mark > 0)
      ! Without an exponent only a very long number can be too large.
      if (mark == 0 .and. last <= largest_power) return
      first = scan(word(:last), '123456789')
      if (first == 0) return
      point = index(word(:last), '.')
      if (point == 0) point = last + 1
      power = merge(point - first - 1, point - first, point > first)
      if (mark > 0) power = power + exponent_of(word(mark + 1:))
      overflows = power > largest_power
      if (power /= largest_power) return
      digits = repeat('0', len(digits))
      count = 0
      do at = first, last
         if (at == point) cycle
         count = count + 1
         if (count > len(digits)) exit
         digits(count:count) = word(at:at)
      end do
      overflows = lge(digits, largest)
   end function overflows

   !> The exponent of a number, limited to a million in size.
   pure integer function exponent_of(word) result(power)
      character(len=*), intent(in) :: word
      integer :: at

      power = 0
      do at = 1, len(word)
         if (scan(word(at:at), '+-') == 1) cycle
         power = min(10*power + iachar(word(at:at)) - iachar('0'), 1000000)
      end do
      if (word(1:1) == '-') power = -power
   end function exponent_of

   pure logical function looks_real(word)
      character(len=*), intent(in) :: word
      character(len=*), parameter :: digits = '0123456789'
      integer :: at, mantissa, first

      at = 1
      looks_real = .false.
      if (len(word) == 0) return
      if (scan(word(1:1), '+-') == 1) at = 2
      first = at
      at = at + run_of(word(at:), digits)
      mantissa = at - first
      if (at <= len(word)) then
         if (word(at:at) == '.') then
            first = at + 1
            at = first + run_of(word(first:), digits)
            mantissa = mantissa + at - first
         end if
      end if
      if (mantissa == 0) return
      if (at <= len(word)) then
         if (scan(word(at:at), 'eEdD') == 0) return
         at = at + 1
         if (at > len(word)) return
         if (scan(word(at:at), '+-') == 1) at = at + 1
         first = at
         at = at + run_of(word(at:), digits)
         if (at == first) return
      end if
      looks_real = at > len(word)
   end function looks_real

   !> Number of leading characters that belong to a set.
   pure integer function run_of(word, set)
      character(len=*), intent(in) :: word, set

      run_of = verify(word, set) - 1
      if (run_of < 0) run_of = len(word)
   end function run_of

   !> Whether a word is a whole number without sign that fits into an integer.
   pure logical function is_integer(word)
      character(len=*), intent(in) :: word

      is_integer = len(word) > 0 .and. len(word) < 10 .and. verify(word, '0123456789') == 0
   end function is_integer

end module rbs_io_text_file
