!> Rows as a csv file, which has a temporary name until it is complete.
!>
!> Written through C: on a full disk the Fortran library of gfortran 12 gives status 0 for writes, flush
!> and close, so that a truncated file would look complete.
module rbs_io_csv
   use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_int, c_null_char, c_null_ptr, &
                                          c_ptr, c_size_t
   use rbs_base_error, only: error_type, fatal_error, analysis_failed, bad_input
   use rbs_base_kinds, only: wp
   use rbs_base_units, only: unit_system
   use rbs_output_recorder, only: recorder_type
   use rbs_output_row, only: row_time
   implicit none
   private

   public :: csv_recorder

   !> Ending of the name until the file is complete; a failed run leaves a file with this ending.
   character(len=*), parameter, public :: partial = '.partial'

   !> Width of one number with its comma: 17 digits preserve every bit of a double.
   integer, parameter :: width = 25

   type, extends(recorder_type) :: csv_recorder
      !> Rows written so far
      integer :: count = 0
      !> First value of the last row: time [s], or number of the point
      real(wp) :: last_time = 0.0_wp
      !> Path of the file
      character(len=:), allocatable :: path
      !> Units of the file, and the SI units of the values of a row (values of a row)
      type(unit_system) :: units
      character(len=4), allocatable :: si(:)
      type(c_ptr), private :: stream = c_null_ptr
      character(len=:), allocatable, private :: buffer
   contains
      procedure :: open => open_csv
      procedure :: record
      procedure :: close => close_csv
   end type csv_recorder

   interface
      !> C: open a file; a null pointer if that fails.
      function c_fopen(path, mode) bind(c, name='fopen') result(stream)
         import :: c_char, c_ptr
         implicit none
         character(kind=c_char), intent(in) :: path(*), mode(*)
         type(c_ptr) :: stream
      end function c_fopen

      !> C: write `count` pieces of `size` bytes; fewer are written if that fails.
      function c_fwrite(text, size, count, stream) bind(c, name='fwrite') result(written)
         import :: c_char, c_ptr, c_size_t
         implicit none
         character(kind=c_char), intent(in) :: text(*)
         integer(c_size_t), value :: size, count
         type(c_ptr), value :: stream
         integer(c_size_t) :: written
      end function c_fwrite

      !> C: write what is still in the buffer; 0 on success.
      function c_fflush(stream) bind(c, name='fflush') result(status)
         import :: c_int, c_ptr
         implicit none
         type(c_ptr), value :: stream
         integer(c_int) :: status
      end function c_fflush

      !> C: the descriptor of an open file.
      function c_fileno(stream) bind(c, name='fileno') result(descriptor)
         import :: c_int, c_ptr
         implicit none
         type(c_ptr), value :: stream
         integer(c_int) :: descriptor
      end function c_fileno

      !> C: write a file through to its disk; not 0 on failure, or if the file is not on a disk.
      function c_fsync(descriptor) bind(c, name='fsync') result(status)
         import :: c_int
         implicit none
         integer(c_int), value :: descriptor
         integer(c_int) :: status
      end function c_fsync

      !> C: close a file; 0 on success.
      function c_fclose(stream) bind(c, name='fclose') result(status)
         import :: c_int, c_ptr
         implicit none
         type(c_ptr), value :: stream
         integer(c_int) :: status
      end function c_fclose

      !> C: remove a file; 0 on success.
      function c_remove(path) bind(c, name='remove') result(status)
         import :: c_char, c_int
         implicit none
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int) :: status
      end function c_remove

      !> C: rename a file and replace any file that has the new name; 0 on success.
      function c_rename(from, to) bind(c, name='rename') result(status)
         import :: c_char, c_int
         implicit none
         character(kind=c_char), intent(in) :: from(*), to(*)
         integer(c_int) :: status
      end function c_rename
   end interface

contains

   !> Start the file: comment lines, then the names of the columns.
   subroutine open_csv(self, path, comments, labels, error)
      class(csv_recorder), intent(inout) :: self
      !> Path of the complete file
      character(len=*), intent(in) :: path
      !> Lines of the header, without the mark of a comment
      character(len=*), intent(in) :: comments(:)
      !> Names of the columns
      character(len=*), intent(in) :: labels(:)
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: line
      integer :: i

      self%path = path
      self%count = 0
      if (is_folder(path)) then
         call fatal_error(error, bad_input, 'output: '//path//' is a folder; give the path of a file')
         return
      end if
      if (is_special(path)) then
         call fatal_error(error, bad_input, 'output: '//path//' is a device or a pipe, which a file '// &
                          'cannot take the place of; choose another file with --output')
         return
      end if
      self%stream = c_fopen(path//partial//c_null_char, 'w'//c_null_char)
      if (.not. c_associated(self%stream)) then
         call fatal_error(error, bad_input, 'output: cannot write '//path//partial//'; '// &
                          'check its folder, name and permissions, or choose another file with --output')
         return
      end if
      do i = 1, size(comments)
         call put_line(self, '# '//trim(comments(i)), error)
         if (allocated(error)) return
      end do
      line = trim(labels(1))
      do i = 2, size(labels)
         line = line//','//trim(labels(i))
      end do
      call put_line(self, line, error)
      self%buffer = repeat(' ', width*size(labels))
   end subroutine open_csv

   !> Write one row.
   subroutine record(self, row, error)
      class(csv_recorder), intent(inout) :: self
      real(wp), intent(in) :: row(:)
      type(error_type), allocatable, intent(inout) :: error
      character(len=width) :: number
      real(wp) :: value(size(row))
      integer :: i, at, first

      if (allocated(error)) return
      value = row
      if (.not. self%units%is_si()) value = self%units%out_of_si(row, self%si)
      at = 0
      do i = 1, size(row)
         write (number, '(es24.16e3)') value(i)
         first = verify(number, ' ')
         self%buffer(at + 1:at + width - first) = number(first:width - 1)
         at = at + width - first + 1
         self%buffer(at:at) = ','
      end do
      call put_line(self, self%buffer(:at - 1), error)
      self%count = self%count + 1
      self%last_time = row(row_time)
   end subroutine record

   subroutine put_line(self, line, error)
      class(csv_recorder), intent(inout) :: self
      character(len=*), intent(in) :: line
      type(error_type), allocatable, intent(inout) :: error
      integer(c_size_t) :: length

      length = len(line, kind=c_size_t) + 1_c_size_t
      if (c_fwrite(line//new_line('a'), 1_c_size_t, length, self%stream) /= length) then
         call report_write(self, error)
      end if
   end subroutine put_line

   !> Close the file. After a successful run it gets its final name. After a failed run it keeps the ending
   !> `.partial`, if it has rows, and an earlier file with the final name is untouched.
   subroutine close_csv(self, whole, error)
      class(csv_recorder), intent(inout) :: self
      !> Whether the run succeeded
      logical, intent(in) :: whole
      type(error_type), allocatable, intent(inout) :: error
      integer(c_int) :: flushed, status

      if (.not. c_associated(self%stream)) return
      flushed = c_fflush(self%stream)
      status = c_fclose(self%stream)
      self%stream = c_null_ptr
      if ((flushed /= 0 .or. status /= 0) .and. .not. allocated(error)) call report_write(self, error)
      if (self%count == 0 .and. .not. whole) then
         ! There are no rows to keep.
         status = c_remove(self%path//partial//c_null_char)
         return
      end if
      if (allocated(error) .or. .not. whole) return
      status = c_rename(self%path//partial//c_null_char, self%path//c_null_char)
      if (status /= 0) then
         call fatal_error(error, analysis_failed, 'output: '//self%path//partial//' is whole but '// &
                          'could not be renamed to '//self%path//'; move it by hand')
      end if
   end subroutine close_csv

   subroutine report_write(self, error)
      class(csv_recorder), intent(in) :: self
      type(error_type), allocatable, intent(inout) :: error

      call fatal_error(error, analysis_failed, 'output: cannot write all of '//self%path//partial// &
                       '; the disk is probably full: free some space or choose another file '// &
                       'with --output')
   end subroutine report_write

   !> Whether a path is a device or a pipe, which cannot be written through to a disk.
   logical function is_special(path)
      character(len=*), intent(in) :: path
      type(c_ptr) :: stream
      integer(c_int) :: status

      is_special = .false.
      ! Opened for update, which neither truncates a file nor waits for the other end of a pipe.
      stream = c_fopen(path//c_null_char, 'r+'//c_null_char)
      if (.not. c_associated(stream)) return
      status = c_fsync(c_fileno(stream))
      is_special = status /= 0
      status = c_fclose(stream)
   end function is_special

   !> Whether a path is a folder.
   logical function is_folder(path)
      character(len=*), intent(in) :: path

      inquire (file=path//'/.', exist=is_folder)
   end function is_folder

end module rbs_io_csv
