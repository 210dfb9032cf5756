!> Rows as a csv file.
module rbs_io_csv
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_base_units, only: unit_system
   use rbs_io_output_file, only: output_file
   use rbs_output_recorder, only: recorder_type
   implicit none
   private

   public :: csv_recorder

   !> Width of one number with its comma: 17 digits preserve every bit of a double.
   integer, parameter :: width = 25

   type, extends(recorder_type) :: csv_recorder
      !> Rows written so far
      integer :: count = 0
      type(output_file) :: file
      !> Units of the file, and the SI units of the values of a row (values of a row)
      type(unit_system) :: units
      character(len=4), allocatable, private :: si(:)
      character(len=:), allocatable, private :: buffer
   contains
      procedure :: write_head, record
   end type csv_recorder

contains

   !> Write comment lines, then the names of the columns.
   subroutine write_head(self, comments, error)
      class(csv_recorder), intent(inout) :: self
      !> Lines of the header, without the mark of a comment
      character(len=*), intent(in) :: comments(:)
      type(error_type), allocatable, intent(out) :: error
      character(len=32), allocatable :: labels(:)
      character(len=:), allocatable :: line
      integer :: i, at

      do i = 1, size(comments)
         call put_line(self, '# '//trim(comments(i)), error)
         if (allocated(error)) return
      end do
      ! Names of the columns, with the units of the file, and the SI units of their values.
      call self%channels%get_labels(self%units, labels, self%si)
      allocate (character(len=(len(labels) + 1)*size(labels)) :: line)
      at = 0
      do i = 1, size(labels)
         associate (label => trim(labels(i))//',')
            line(at + 1:at + len(label)) = label
            at = at + len(label)
         end associate
      end do
      call put_line(self, line(:at - 1), error)
      self%buffer = repeat(' ', width*size(labels))
   end subroutine write_head

   !> Write one row. After an error nothing is written any more.
   subroutine record(self, row, error)
      class(csv_recorder), intent(inout) :: self
      !> Values in SI, in the order of the columns
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
         ! The number has 24 characters at most, and blanks before it that are left out; then comes the comma.
         write (number, '(es24.16e3)') value(i)
         first = verify(number, ' ')
         self%buffer(at + 1:at + width - first) = number(first:width - 1)
         at = at + width - first + 1
         self%buffer(at:at) = ','
      end do
      call put_line(self, self%buffer(:at - 1), error)
      self%count = self%count + 1
   end subroutine record

   !> Write one line.
   subroutine put_line(self, line, error)
      class(csv_recorder), intent(inout) :: self
      character(len=*), intent(in) :: line
      type(error_type), allocatable, intent(inout) :: error

      call self%file%put(line, error)
      call self%file%put(new_line('a'), error)
   end subroutine put_line

end module rbs_io_csv
