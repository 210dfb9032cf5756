!> A text file in memory: its lines, with any line ending, and strict reading of numbers.
module rbs_io_text_file
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_get_halting_mode, ieee_overflow, &
                                            ieee_set_flag, ieee_set_halting_mode
   use, intrinsic :: iso_c_binding, only: c_int, c_null_char, c_size_t
   use, intrinsic :: iso_fortran_env, only: int64
   use rbs_base_error, only: error_type, fatal_error, bad_input
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: lower, to_text
   use rbs_io_posix, only: c_close, c_dup, c_open, c_poll, c_read, is_folder, is_special, poll_in, &
                           poll_type, to_read, without_waiting
   implicit none
   private

   public :: text_file, load_text, read_real, is_integer
   public :: number_ok, number_wrong, number_not_finite

   !> Results of `read_real`.
   integer, parameter :: number_ok = 0, number_wrong = 1, number_not_finite = 2

   !> Longest text that is read as a number, and whole numbers below which all are exact as real numbers.
   integer, parameter :: most_digits = 4096
   integer(int64), parameter :: most_exact = 2_int64**53

   !> How long the writer of a pipe is waited for [ms].
   integer(c_int), parameter :: writer_time = 5000_c_int

   !> Bytes that are made room for at first, and that are read at most, of a pipe, whose size is not known.
   integer, parameter :: first_of_pipe = 65536, most_of_pipe = 250000000

   !> Codes of `read_some` in place of a number of bytes.
   integer(c_size_t), parameter :: nobody_writes = -2_c_size_t, cannot_read = -1_c_size_t

   character(len=1), parameter :: cr = achar(13), lf = achar(10)

   !> The text of a file and a position in it.
   type :: text_file
      character(len=:), allocatable :: text
      !> Number of the line read last
      integer :: line = 0
      integer, private :: at = 1
   contains
      procedure :: next_line, position, go_back
   end type text_file

contains

   !> Read a whole file, a pipe, or with `-` standard input.
   subroutine load_text(file, path, most, error)
      type(text_file), intent(out) :: file
      character(len=*), intent(in) :: path
      !> Largest size that is accepted [bytes]
      integer, intent(in) :: most
      type(error_type), allocatable, intent(out) :: error
      integer(c_int) :: descriptor, status

      if (is_folder(path)) then
         call refuse('is a folder; give the path of a file')
         return
      end if
      if (path == '-') then
         descriptor = c_dup(0_c_int)
      else
         descriptor = c_open(path//c_null_char, to_read + without_waiting)
      end if
      if (descriptor < 0_c_int) then
         call report_open()
         return
      end if
      call read_all()
      status = c_close(descriptor)
      if (allocated(error)) return
      ! The mark at the start of a file in UTF-8 is no text.
      if (len(file%text) >= 3) then
         if (file%text(:3) == char(239)//char(187)//char(191)) file%text = file%text(4:)
      end if
      if (index(file%text, achar(0)) > 0) call refuse('is not a text file (it has a zero byte)')

   contains

      !> Read from the descriptor to the end into `file%text`. Where its room is full, one byte more shows
      !> whether the text goes on, and the room is doubled.
      subroutine read_all()
         character(len=:), allocatable :: longer
         character(len=1) :: one
         integer(c_size_t) :: count
         integer(int64) :: size
         integer :: length, capacity, limit, status

         ! The size of a file is known, that of a pipe is not.
         size = 0
         if (path /= '-') inquire (file=path, size=size)
         limit = most
         if (size < 1_int64) limit = min(most, most_of_pipe)
         capacity = int(min(size, int(limit, int64)))
         if (size < 1_int64) capacity = first_of_pipe
         allocate (character(len=capacity) :: file%text, stat=status)
         length = 0
         count = 0_c_size_t
         do while (status == 0 .and. max(size, int(length, int64)) <= int(limit, int64))
            if (length < capacity) then
               count = read_some(descriptor, file%text(length + 1:capacity), length == 0)
            else
               count = read_some(descriptor, one, .false.)
            end if
            if (count <= 0_c_size_t) exit
            length = length + int(count)
            if (length <= capacity .or. length > limit) cycle
            capacity = int(min(2*int(capacity, int64), int(limit, int64)))
            allocate (character(len=capacity) :: longer, stat=status)
            if (status /= 0) exit
            longer(:length - 1) = file%text
            longer(length:length) = one
            call move_alloc(longer, file%text)
         end do
         size = max(size, int(length, int64))
         if (status /= 0) then
            call refuse('there is not enough memory to read it; raise the limit of the process or '// &
                        'make the file shorter')
         else if (size > int(limit, int64)) then
            call refuse('has '//to_text(real(size, wp))//' bytes, more than the '//to_text(limit)// &
                        ' that are read; is it the right file?')
         else if (count == nobody_writes) then
            call refuse('is a pipe that nobody writes to; start its writer first, or give the path of a file')
         else if (count < 0_c_size_t) then
            call refuse('cannot be read; check the path and the permissions')
         else if (length == 0) then
            call refuse('is empty')
         else if (length < capacity) then
            file%text = file%text(:length)
         end if
      end subroutine read_all

      !> Report why a path cannot be opened.
      subroutine report_open()
         character(len=256) :: message
         integer :: unit, status, reason

         message = 'it cannot be opened'
         if (path == '-') then
            message = 'standard input is closed'
         else if (.not. is_special(path)) then
            ! Opened once more, since Fortran gives the reason in words.
            open (newunit=unit, file=path, action='read', status='old', iostat=status, iomsg=message)
            if (status == 0) close (unit)
            reason = index(message, "': ", back=.true.)  ! Behind the path
            if (reason > 0) message = message(reason + 3:)
         end if
         call refuse('cannot be opened ('//trim(message)//'); check the path and the permissions')
      end subroutine report_open

      !> Report why a file is not read.
      subroutine refuse(reason)
         character(len=*), intent(in) :: reason

         call fatal_error(error, bad_input, path//': '//reason)
      end subroutine refuse

   end subroutine load_text

   !> Read the bytes at hand, and wait if there are none yet: the number of bytes, 0 at the end, or
   !> `nobody_writes` or `cannot_read`.
   integer(c_size_t) function read_some(descriptor, text, at_start) result(count)
      integer(c_int), intent(in) :: descriptor
      character(len=*), intent(inout) :: text
      !> Whether nothing has been read before: a pipe may still be waiting for its writer
      logical, intent(in) :: at_start
      type(poll_type) :: what
      integer(c_int) :: ready
      integer :: failures

      failures = 0
      do
         count = c_read(descriptor, text, len(text, kind=c_size_t))
         if (count > 0_c_size_t) return
         what = poll_type(descriptor, poll_in, 0)
         if (count < 0_c_size_t) then
            ! A pipe with a writer and nothing in it, or a file that cannot be read.
            failures = failures + 1
            if (failures == 2) count = cannot_read
            if (failures == 2) return
            ready = c_poll(what, 1_c_size_t, -1_c_int)
         else
            ! The end of a file, or a pipe whose writer has not opened it: only the pipe is not ready.
            if (.not. at_start .or. failures > 0) return
            ready = c_poll(what, 1_c_size_t, writer_time)
            if (ready == 0_c_int) count = nobody_writes
            if (ready == 0_c_int .or. iand(what%answered, poll_in) == 0) return
            failures = failures + 1
         end if
      end do
   end function read_some

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
      ! Most lines are short; only a longer one is searched for its end in the whole text.
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
   pure function position(self)
      class(text_file), intent(in) :: self
      integer :: position(2)

      position = [self%at, self%line]
   end function position

   !> Go back to a position, by default to the start of the file.
   subroutine go_back(self, position)
      class(text_file), intent(inout) :: self
      integer, intent(in), optional :: position(2)

      self%at = 1
      self%line = 0
      if (present(position)) then
         self%at = position(1)
         self%line = position(2)
      end if
   end subroutine go_back

   !> Read a word as a number: a sign, digits, a point, an exponent with e or d. A Fortran read would also
   !> accept `1,5`, `1/2` and `3*4`, and be slow.
   subroutine read_real(word, value, status)
      character(len=*), intent(in) :: word
      real(wp), intent(out) :: value
      !> `number_ok`, `number_wrong`, or `number_not_finite` for NaN, infinity and overflow
      integer, intent(out) :: status
      integer(int64) :: mantissa
      integer :: i, digit, digits, power, exponent, sign_of_power, first, ios
      !> Whether a point and an exponent have begun; whether the mantissa has all digits; whether the program
      !> stops on overflow
      logical :: point, in_exponent, exact, stops
      character(len=12) :: form

      value = 0.0_wp
      status = number_wrong
      if (len(word) > most_digits) return
      mantissa = 0_int64
      digits = 0
      power = 0
      exponent = 0
      sign_of_power = 1
      first = 1
      point = .false.
      in_exponent = .false.
      exact = .true.
      do i = 1, len(word)
         digit = iachar(word(i:i)) - iachar('0')
         if (digit >= 0 .and. digit <= 9) then
            digits = digits + 1
            if (in_exponent) then
               exponent = min(10*exponent + digit, 2*most_digits)
            else if (mantissa < most_exact) then
               mantissa = 10_int64*mantissa + digit
               if (point) power = power - 1
            else
               exact = .false.
            end if
         else if (i == first .and. scan(word(i:i), '+-') == 1) then
            if (in_exponent .and. word(i:i) == '-') sign_of_power = -1
         else if (word(i:i) == '.' .and. .not. (point .or. in_exponent)) then
            point = .true.
         else if (digits > 0 .and. .not. in_exponent .and. scan(word(i:i), 'eEdD') == 1) then
            in_exponent = .true.
            digits = 0
            first = i + 1
         else
            select case (lower(word(1 + scan(word(:1), '+-'):)))
            case ('nan', 'inf', 'infinity')
               status = number_not_finite
            case default                            ! not a number
            end select
            return
         end if
      end do
      if (digits == 0) return
      status = number_ok
      power = power + sign_of_power*exponent
      if (mantissa == 0_int64) return
      if (exact .and. mantissa < most_exact .and. abs(power) <= 22) then
         ! Multiplied or divided by an exact power of ten it is rounded once, which gives the nearest number.
         value = real(mantissa, wp)
         if (power > 0) value = value*10.0_wp**power
         if (power < 0) value = value/10.0_wp**(-power)
         if (word(1:1) == '-') value = -value
      else if (exponent < 2*most_digits) then
         ! The nearest number. One that is too large must not end a program that stops on overflow.
         call ieee_get_halting_mode(ieee_overflow, stops)
         call ieee_set_halting_mode(ieee_overflow, .false.)
         write (form, '(a, i0, a)') '(f', len(word), '.0)'
         read (word, form, iostat=ios) value
         call ieee_set_flag(ieee_overflow, .false.)
         call ieee_set_halting_mode(ieee_overflow, stops)
         status = number_not_finite
         if (ios == 0) status = merge(number_ok, number_not_finite, ieee_is_finite(value))
      else if (sign_of_power > 0) then
         status = number_not_finite
      end if
   end subroutine read_real

   !> Whether a word is a whole number without sign that fits into an integer.
   pure logical function is_integer(word)
      character(len=*), intent(in) :: word

      is_integer = len(word) > 0 .and. len(word) < 10 .and. verify(word, '0123456789') == 0
   end function is_integer

end module rbs_io_text_file
