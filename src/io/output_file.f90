!> A file that is written under a name of its own and gets its final name when it is whole.
!>
!> The name of its own is made anew for each process and is opened exclusively: it never replaces a file,
!> never follows a link, and two processes with one output do not meet. Pipes and devices, which nothing
!> can be renamed onto, are written directly.
module rbs_io_output_file
   use, intrinsic :: iso_c_binding, only: c_associated, c_int, c_null_char, c_null_ptr, c_ptr, c_size_t
   use, intrinsic :: iso_fortran_env, only: int64
   use rbs_base_error, only: error_type, fatal_error, analysis_failed, bad_input
   use rbs_base_text, only: to_text
   use rbs_io_posix, only: c_close, c_dup, c_fclose, c_fileno, c_flock, c_fopen, c_open, c_poll, c_read, &
                           c_rename, c_unlink, c_write, exists, is_folder, is_link, is_special, &
                           is_standard_output, is_taken, poll_out, poll_type, standard_output, &
                           to_read, to_write, without_waiting
   implicit none
   private

   public :: output_file, first_words, is_ours

   !> Ending of the name until the file is whole.
   character(len=*), parameter, public :: partial = '.partial'

   !> How every file of rows starts. An earlier `.partial` that starts like this is one of ours.
   character(len=*), parameter :: first_words = '# rbsdem '

   !> Letters of a name that a disk takes, and those of it that go into the name of its own.
   integer, parameter :: longest_name = 255, longest_start = 200

   !> Names that are tried before the folder is taken to be at fault.
   integer, parameter :: most_tries = 100

   integer, parameter :: buffer_size = 16384

   !> How a file is locked: by one process, without waiting.
   integer(c_int), parameter :: exclusive_at_once = 6_c_int

   type :: output_file
      !> Path of the whole file
      character(len=:), allocatable :: path
      !> Its name until it is whole; empty if it is written directly
      character(len=:), allocatable :: own
      !> Where an unfinished file was kept; empty if it was not
      character(len=:), allocatable :: kept
      !> A file that a run with this output has left which was killed; empty if there is none
      character(len=:), allocatable :: left
      integer(c_int), private :: descriptor = -1_c_int
      type(c_ptr), private :: stream = c_null_ptr
      logical, private :: broken = .false.
      integer, private :: used = 0
      integer(int64), private :: flushed = 0_int64
      character(len=buffer_size), private :: buffer
   contains
      procedure :: open => open_file, put, close => close_file, get_partial_name
      procedure, private :: flush => flush_buffer, open_own
   end type output_file

contains

   !> Start the file.
   subroutine open_file(self, path, error)
      class(output_file), intent(inout) :: self
      !> Path of the whole file; `-` is standard output
      character(len=*), intent(in) :: path
      type(error_type), allocatable, intent(out) :: error
      type(c_ptr) :: stream
      integer(c_int) :: status

      self%path = path
      self%own = ''
      self%kept = ''
      self%left = ''
      self%used = 0
      call system_clock(self%flushed)
      self%broken = .false.
      if (is_folder(path)) then
         call fatal_error(error, bad_input, 'output: '//path//' is a folder; give the path of a file')
      else if (is_standard_output(path)) then
         self%descriptor = c_dup(standard_output)
         if (self%descriptor < 0_c_int) then
            call fatal_error(error, bad_input, 'output: standard output is closed; name a file with --output')
         end if
      else if (is_special(path)) then
         self%descriptor = c_open(path//c_null_char, to_write + without_waiting)
         if (self%descriptor < 0_c_int) then
            call fatal_error(error, bad_input, 'output: '//path//' is a pipe that nobody reads, or a '// &
                             'device that cannot be written; start its reader first, or choose another '// &
                             'file with --output')
         end if
      else if (exists(path)) then
         ! A file that is protected from writing is refused, although another could be renamed onto it.
         stream = c_fopen(path//c_null_char, 'r+'//c_null_char)
         if (c_associated(stream)) then
            status = c_fclose(stream)
            call self%open_own(error)
         else
            call fatal_error(error, bad_input, 'output: '//path//' is there and is protected from '// &
                             'writing; change its permissions, or choose another file with --output')
         end if
      else
         call self%open_own(error)
      end if
   end subroutine open_file

   !> Open the file under a name of its own, PATH.i.partial with the first i that is free, and lock it. An
   !> earlier file of this kind that no process has locked is reported in `left`.
   subroutine open_own(self, error)
      class(output_file), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error
      integer :: i, slash
      integer(c_int) :: descriptor, status

      slash = index(self%path, '/', back=.true.)
      ! No try if the final name is longer than a disk takes.
      do i = 1, merge(most_tries, 0, len(self%path) - slash <= longest_name)
         self%own = self%path(:min(len(self%path), slash + longest_start))//'.'//to_text(i)//partial
         self%stream = c_fopen(self%own//c_null_char, 'wx'//c_null_char)
         if (c_associated(self%stream)) exit
         ! The name is free: the folder is at fault.
         if (.not. is_taken(self%own)) exit
         if (is_ours(self%own)) then
            ! A run that is under way has the lock of its file.
            descriptor = c_open(self%own//c_null_char, to_read + without_waiting)
            if (c_flock(descriptor, exclusive_at_once) == 0_c_int) self%left = self%own
            status = c_close(descriptor)
         end if
      end do
      if (c_associated(self%stream)) then
         self%descriptor = c_fileno(self%stream)
         status = c_flock(self%descriptor, exclusive_at_once)
      else
         call fatal_error(error, bad_input, 'output: cannot write '//self%path//'; check its folder, '// &
                          'name and permissions, or choose another file with --output')
      end if
   end subroutine open_own

   !> Write a text. The file on the disk ends with a whole text, and lacks at most those of the last second.
   subroutine put(self, text, error)
      class(output_file), intent(inout) :: self
      character(len=*), intent(in) :: text
      type(error_type), allocatable, intent(inout) :: error
      integer(int64) :: now, second
      integer :: at, length

      ! In counts of the clock, of which `second` make one second.
      call system_clock(now, second)
      if (self%used + len(text) > buffer_size .or. now - self%flushed > second) then
         call self%flush(error)
         if (allocated(error)) return
         self%flushed = now
      end if
      at = 0
      do while (at < len(text))
         if (self%used == buffer_size) call self%flush(error)
         if (allocated(error)) return
         length = min(len(text) - at, buffer_size - self%used)
         self%buffer(self%used + 1:self%used + length) = text(at + 1:at + length)
         self%used = self%used + length
         at = at + length
      end do
   end subroutine put

   !> Write what is in the buffer; after a failure the file is broken and takes nothing any more.
   subroutine flush_buffer(self, error)
      class(output_file), intent(inout) :: self
      type(error_type), allocatable, intent(inout) :: error
      type(poll_type) :: what
      integer(c_size_t) :: written
      integer(c_int) :: ready
      integer :: at, failures

      at = 1
      failures = 0
      do while (at <= self%used .and. .not. self%broken)
         written = c_write(self%descriptor, self%buffer(at:self%used), int(self%used - at + 1, c_size_t))
         if (written > 0_c_size_t) then
            at = at + int(written)
            failures = 0
         else
            failures = failures + 1
            ! A write that fails on a disk is not tried again.
            self%broken = self%own /= '' .or. failures == most_tries
            if (self%broken) exit
            ! The reader of a pipe takes its time.
            what = poll_type(self%descriptor, poll_out, 0)
            ready = c_poll(what, 1_c_size_t, -1_c_int)
            if (what%answered /= poll_out) self%broken = .true.
         end if
      end do
      self%used = 0
      if (self%broken .and. .not. allocated(error)) then
         call fatal_error(error, analysis_failed, 'output: cannot write all of '//self%path// &
                          '; the disk is full or files may not be so large: free some space, raise the '// &
                          'limit or choose another file with --output')
      end if
   end subroutine flush_buffer

   !> Close the file. A whole file gets its final name. An unfinished one is removed or kept; in both cases an
   !> earlier file with the final name is untouched.
   subroutine close_file(self, whole, worth, error)
      class(output_file), intent(inout) :: self
      !> Whether the file is whole; whether an unfinished file is worth keeping
      logical, intent(in) :: whole, worth
      type(error_type), allocatable, intent(inout) :: error
      integer(c_int) :: status
      character(len=:), allocatable :: name

      if (self%descriptor < 0_c_int) return
      call self%flush(error)
      if (c_associated(self%stream)) then
         status = c_fclose(self%stream)
      else
         status = c_close(self%descriptor)
      end if
      self%stream = c_null_ptr
      self%descriptor = -1_c_int
      if (status /= 0 .and. .not. allocated(error)) then
         call fatal_error(error, analysis_failed, 'output: '//self%path//' could not be closed; is the '// &
                          'disk full?')
         self%broken = .true.
      end if
      if (self%own == '') return
      if (self%broken .or. .not. (whole .or. worth)) then
         status = c_unlink(self%own//c_null_char)
      else if (whole) then
         status = c_rename(self%own//c_null_char, self%path//c_null_char)
         if (status /= 0) then
            self%kept = self%own
            call fatal_error(error, analysis_failed, 'output: '//self%own//' is whole but could not be '// &
                             'renamed to '//self%path//'; move it by hand')
         else if (is_ours(self%path//partial)) then
            ! A file that an earlier run has left would be taken for a part of this one.
            status = c_unlink(self%path//partial//c_null_char)
         end if
      else
         ! As PATH.partial if this name is free or has been left by an earlier run
         self%kept = self%own
         call self%get_partial_name(name)
         if (name == self%own) return
         if (c_rename(self%own//c_null_char, name//c_null_char) == 0_c_int) self%kept = name
      end if
   end subroutine close_file

   !> Name under which the rows of a run are kept that does not come to its end: PATH.partial if this is free
   !> or has been left by an earlier run, else the name that the file has now.
   subroutine get_partial_name(self, name)
      class(output_file), intent(in) :: self
      character(len=:), allocatable, intent(out) :: name
      logical :: free

      name = self%path//partial
      free = .not. is_taken(name)
      if (.not. free) free = is_ours(name)
      if (self%own == '' .or. .not. free) name = self%own
   end subroutine get_partial_name

   !> Whether a path is an ordinary file that a run has left, by its first words.
   logical function is_ours(path)
      character(len=*), intent(in) :: path
      character(len=len(first_words)) :: words
      integer(c_size_t) :: count
      integer(c_int) :: descriptor, status

      is_ours = .false.
      if (.not. exists(path)) return
      if (is_link(path) .or. is_folder(path) .or. is_special(path)) return
      descriptor = c_open(path//c_null_char, to_read + without_waiting)
      if (descriptor < 0_c_int) return
      words = ''
      count = c_read(descriptor, words, len(words, kind=c_size_t))
      status = c_close(descriptor)
      is_ours = count == len(words, kind=c_size_t) .and. words == first_words
   end function is_ours

end module rbs_io_output_file
