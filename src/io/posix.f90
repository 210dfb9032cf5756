!> The functions of POSIX that files need and Fortran lacks.
!>
!> Fortran cannot open a file exclusively, waits for the other end of a pipe, and in gfortran 12 gives status
!> 0 for writes on a full disk, so that a truncated file would look complete.
module rbs_io_posix
   use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_int, c_null_char, c_ptr, c_short, c_size_t
   implicit none
   private

   public :: c_close, c_dup, c_fclose, c_fileno, c_flock, c_fopen, c_fsync, c_open, c_poll, c_read, &
             c_rename, c_unlink, c_write, poll_type
   public :: exists, is_folder, is_link, is_special, is_standard_output, is_taken, same_file, standard_input

   !> How `c_open` opens: to read or to write, without waiting for the other end of a pipe. The second part
   !> is the value of Linux; where it differs, as on macOS, a pipe is waited for.
   integer(c_int), parameter, public :: to_read = 0_c_int, to_write = 1_c_int, without_waiting = 2048_c_int

   !> Events that `c_poll` waits for and reports.
   integer(c_short), parameter, public :: poll_in = 1_c_short, poll_out = 4_c_short

   integer(c_int), parameter, public :: standard_output = 1_c_int

   character(len=*), parameter :: standard_input_path = '/dev/stdin'

   !> Request and answer of `poll` for a descriptor.
   type, bind(c) :: poll_type
      integer(c_int) :: descriptor
      integer(c_short) :: asked, answered
   end type poll_type

   interface
      !> In C: open an existing file; -1 if that fails.
      integer(c_int) function c_open(path, flags) bind(c, name='open') result(descriptor)
         import :: c_char, c_int
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), value :: flags
      end function c_open

      !> In C: a second descriptor of an open file; -1 if that fails.
      integer(c_int) function c_dup(descriptor) bind(c, name='dup') result(second)
         import :: c_int
         integer(c_int), value :: descriptor
      end function c_dup

      !> In C: close a descriptor; 0 on success.
      integer(c_int) function c_close(descriptor) bind(c, name='close') result(status)
         import :: c_int
         integer(c_int), value :: descriptor
      end function c_close

      !> In C: read at most `length` bytes: how many, 0 at the end, -1 if nothing can be read now.
      integer(c_size_t) function c_read(descriptor, text, length) bind(c, name='read') result(count)
         import :: c_char, c_int, c_size_t
         integer(c_int), value :: descriptor
         character(kind=c_char), intent(out) :: text(*)
         integer(c_size_t), value :: length
      end function c_read

      !> In C: write at most `length` bytes: how many, -1 if nothing can be written now.
      integer(c_size_t) function c_write(descriptor, text, length) bind(c, name='write') result(count)
         import :: c_char, c_int, c_size_t
         integer(c_int), value :: descriptor
         character(kind=c_char), intent(in) :: text(*)
         integer(c_size_t), value :: length
      end function c_write

      !> In C: wait until a descriptor is ready, for a time in ms or, with -1, for ever; 0 if it is not.
      integer(c_int) function c_poll(what, count, milliseconds) bind(c, name='poll') result(ready)
         import :: c_int, c_size_t, poll_type
         type(poll_type), intent(inout) :: what
         integer(c_size_t), value :: count
         integer(c_int), value :: milliseconds
      end function c_poll

      !> In C: open a file as a stream; a null pointer if that fails. Mode `wx` makes a file that was not
      !> there and never follows a link.
      type(c_ptr) function c_fopen(path, mode) bind(c, name='fopen') result(stream)
         import :: c_char, c_ptr
         character(kind=c_char), intent(in) :: path(*), mode(*)
      end function c_fopen

      !> In C: the descriptor of a stream.
      integer(c_int) function c_fileno(stream) bind(c, name='fileno') result(descriptor)
         import :: c_int, c_ptr
         type(c_ptr), value :: stream
      end function c_fileno

      !> In C: close a stream; 0 on success.
      integer(c_int) function c_fclose(stream) bind(c, name='fclose') result(status)
         import :: c_int, c_ptr
         type(c_ptr), value :: stream
      end function c_fclose

      !> In C: write a file through to its disk; not 0 on failure, or if the file is not on a disk.
      integer(c_int) function c_fsync(descriptor) bind(c, name='fsync') result(status)
         import :: c_int
         integer(c_int), value :: descriptor
      end function c_fsync

      !> In C: lock a file until the process ends or closes it; 0 on success, -1 if another has the lock.
      integer(c_int) function c_flock(descriptor, how) bind(c, name='flock') result(status)
         import :: c_int
         integer(c_int), value :: descriptor, how
      end function c_flock

      !> In C: remove a file; 0 on success.
      integer(c_int) function c_unlink(path) bind(c, name='unlink') result(status)
         import :: c_char, c_int
         character(kind=c_char), intent(in) :: path(*)
      end function c_unlink

      !> In C: rename a file and replace any file that has the new name; 0 on success.
      integer(c_int) function c_rename(from, to) bind(c, name='rename') result(status)
         import :: c_char, c_int
         character(kind=c_char), intent(in) :: from(*), to(*)
      end function c_rename


      !> In C: 0 if a path leads to something.
      integer(c_int) function c_access(path, mode) bind(c, name='access') result(status)
         import :: c_char, c_int
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), value :: mode
      end function c_access

      !> In C: the target of a symbolic link; -1 if the path is no link.
      integer(c_size_t) function c_readlink(path, text, length) bind(c, name='readlink') result(count)
         import :: c_char, c_int, c_size_t
         character(kind=c_char), intent(in) :: path(*)
         character(kind=c_char), intent(out) :: text(*)
         integer(c_size_t), value :: length
      end function c_readlink

      !> In C: the path of an existing file, without links and dots; a null pointer if there is no such file.
      type(c_ptr) function c_realpath(path, real_path) bind(c, name='realpath') result(status)
         import :: c_char, c_ptr
         character(kind=c_char), intent(in) :: path(*)
         character(kind=c_char), intent(out) :: real_path(*)
      end function c_realpath
   end interface

contains

   !> Whether a path leads to something: a file, a folder, a device.
   logical function exists(path)
      character(len=*), intent(in) :: path

      exists = c_access(path//c_null_char, 0_c_int) == 0_c_int
   end function exists

   !> Whether a name is taken, be it by a link that leads nowhere.
   logical function is_taken(path)
      character(len=*), intent(in) :: path

      is_taken = exists(path)
      if (.not. is_taken) is_taken = is_link(path)
   end function is_taken

   !> Whether a path is a folder: only a folder contains itself.
   logical function is_folder(path)
      character(len=*), intent(in) :: path

      is_folder = exists(path//'/.') .and. path /= ''
   end function is_folder

   !> Whether a path is a symbolic link.
   logical function is_link(path)
      character(len=*), intent(in) :: path
      character(kind=c_char) :: text(8)

      is_link = c_readlink(path//c_null_char, text, 8_c_size_t) >= 0_c_size_t
   end function is_link

   !> Whether a path is a device or a pipe, which cannot be written through to a disk.
   logical function is_special(path)
      character(len=*), intent(in) :: path
      type(c_ptr) :: stream
      integer(c_int) :: status

      is_special = .false.
      ! Only a file on a disk can be written through (fsync). It is opened for update, which neither truncates
      ! a file nor waits for the other end of a pipe.
      stream = c_fopen(path//c_null_char, 'r+'//c_null_char)
      if (.not. c_associated(stream)) return
      status = c_fsync(c_fileno(stream))
      is_special = status /= 0
      status = c_fclose(stream)
   end function is_special

   !> Whether two paths lead to the same existing file.
   logical function same_file(a, b)
      character(len=*), intent(in) :: a, b
      !> Longest path in POSIX
      integer, parameter :: longest = 4097
      character(kind=c_char) :: real_a(longest), real_b(longest)

      real_a = c_null_char
      real_b = c_null_char
      same_file = .false.
      if (.not. c_associated(c_realpath(a//c_null_char, real_a))) return
      if (.not. c_associated(c_realpath(b//c_null_char, real_b))) return
      ! Up to the end of the first path, with the null character behind it.
      same_file = all(real_a(:findloc(real_a, c_null_char, dim=1)) == &
                      real_b(:findloc(real_a, c_null_char, dim=1)))
   end function same_file

   !> Whether a path means standard output.
   pure logical function is_standard_output(path)
      character(len=*), intent(in) :: path

      is_standard_output = path == '-' .or. path == '/dev/stdout' .or. path == '/dev/fd/1' .or. &
                           path == '/proc/self/fd/1'
   end function is_standard_output

   !> A path; `-` becomes the path of standard input.
   pure function standard_input(path) result(long)
      character(len=*), intent(in) :: path
      character(len=length_of(path)) :: long

      long = path
      if (path == '-') long = standard_input_path
   end function standard_input

   !> Length of the path that `standard_input` returns.
   pure integer function length_of(path)
      character(len=*), intent(in) :: path

      length_of = merge(len(standard_input_path), len(path), path == '-')
   end function length_of

end module rbs_io_posix
