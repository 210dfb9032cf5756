!> Rows as a csv file: under a temporary name until it is whole.
module rbs_io_csv
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_null_char
   use rbs_base_error, only: error_type, fatal_error, analysis_failed, bad_input
   use rbs_base_kinds, only: wp
   use rbs_results_recorder, only: recorder_type
   implicit none
   private

   public :: csv_recorder

   !> Ending of the file until it is whole, and of what is left of a failed run.
   character(len=*), parameter, public :: partial = '.partial'

   !> Width of one number with its comma: every bit of a double comes back from 17 digits.
   integer, parameter :: width = 25

   type, extends(recorder_type) :: csv_recorder
      !> Rows written so far
      integer :: count = 0
      !> Path of the file
      character(len=:), allocatable :: path
      integer, private :: unit = -1
      character(len=:), allocatable, private :: buffer
   contains
      procedure :: open => open_csv
      procedure :: record
      procedure :: close => close_csv
   end type csv_recorder

   interface
      !> C: give a file another name, in place of what has that name; 0 if it went well.
      function c_rename(from, to) bind(c, name='rename') result(status)
         import :: c_char, c_int
         implicit none
         character(kind=c_char), intent(in) :: from(*), to(*)
         integer(c_int) :: status
      end function c_rename
   end interface

contains

   !> Begin the file: comment lines, then the names of the columns.
   subroutine open_csv(self, path, comments, labels, error)
      class(csv_recorder), intent(inout) :: self
      !> Path of the file when it is whole
      character(len=*), intent(in) :: path
      !> Lines of the header, without the mark of a comment
      character(len=*), intent(in) :: comments(:)
      !> Names of the columns
      character(len=*), intent(in) :: labels(:)
      type(error_type), allocatable, intent(out) :: error
      character(len=256) :: message
      character(len=:), allocatable :: line
      integer :: i, status

      self%path = path
      self%count = 0
      if (is_folder(path)) then
         call fatal_error(error, bad_input, 'output: '//path//' is a folder; give the path of a file')
         return
      end if
      open (newunit=self%unit, file=path//partial, status='replace', action='write', iostat=status, &
            iomsg=message)
      if (status /= 0) then
         self%unit = -1
         call fatal_error(error, bad_input, 'output: cannot write '//path//partial//': '// &
                          trim(message)//'; choose another file with --output')
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
      integer :: i, at, first

      if (allocated(error)) return
      at = 0
      do i = 1, size(row)
         write (number, '(es24.16e3)') row(i)
         first = verify(number, ' ')
         self%buffer(at + 1:at + width - first) = number(first:width - 1)
         at = at + width - first + 1
         self%buffer(at:at) = ','
      end do
      call put_line(self, self%buffer(:at - 1), error)
      self%count = self%count + 1
   end subroutine record

   subroutine put_line(self, line, error)
      class(csv_recorder), intent(inout) :: self
      character(len=*), intent(in) :: line
      type(error_type), allocatable, intent(inout) :: error
      character(len=256) :: message
      integer :: status

      write (self%unit, '(a)', iostat=status, iomsg=message) line
      if (status /= 0) call report_write(self, message, error)
   end subroutine put_line

   !> End the file. If the run went well it gets its name; else `.partial` stays, if it has rows, and
   !> what had the name before is untouched.
   subroutine close_csv(self, whole, error)
      class(csv_recorder), intent(inout) :: self
      !> Whether the run went well
      logical, intent(in) :: whole
      type(error_type), allocatable, intent(inout) :: error
      character(len=256) :: message
      integer :: status

      if (self%unit == -1) return
      if (self%count == 0 .and. .not. whole) then
         ! Nothing to keep.
         close (self%unit, status='delete', iostat=status, iomsg=message)
         self%unit = -1
         if (status /= 0 .and. .not. allocated(error)) call report_write(self, message, error)
         return
      end if
      flush (self%unit, iostat=status, iomsg=message)
      if (status /= 0 .and. .not. allocated(error)) call report_write(self, message, error)
      close (self%unit, iostat=status, iomsg=message)
      self%unit = -1
      if (status /= 0 .and. .not. allocated(error)) call report_write(self, message, error)
      if (allocated(error) .or. .not. whole) return
      status = c_rename(self%path//partial//c_null_char, self%path//c_null_char)
      if (status /= 0) then
         call fatal_error(error, analysis_failed, 'output: '//self%path//partial//' is whole but '// &
                          'could not be renamed to '//self%path//'; move it by hand')
      end if
   end subroutine close_csv

   subroutine report_write(self, message, error)
      class(csv_recorder), intent(in) :: self
      character(len=*), intent(in) :: message
      type(error_type), allocatable, intent(inout) :: error

      call fatal_error(error, analysis_failed, 'output: cannot write '//self%path//partial//': '// &
                       trim(message)//'; free some space or choose another file with --output')
   end subroutine report_write

   !> Whether a path is a folder.
   logical function is_folder(path)
      character(len=*), intent(in) :: path

      inquire (file=path//'/.', exist=is_folder)
   end function is_folder

end module rbs_io_csv
