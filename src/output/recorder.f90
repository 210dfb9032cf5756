!> Where kept rows go: an array (Python) or a file (executable). The solver does not know which.
module rbs_output_recorder
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   implicit none
   private

   public :: recorder_type, array_recorder

   type, abstract :: recorder_type
      !> Whether the rows hold the openings of layered joints
      logical :: openings = .false.
      !> Whether the rows of an analysis in time hold how the top moves
      logical :: motion = .false.
      !> Whether a static path has rows at its corners too, where a spring leaves its line between two targets
      logical :: corners = .false.
   contains
      procedure(record_interface), deferred :: record
   end type recorder_type

   abstract interface
      !> Take one kept row; the order of its values is that of `rbs_output_row`.
      subroutine record_interface(self, row, error)
         import :: recorder_type, error_type, wp
         implicit none
         class(recorder_type), intent(inout) :: self
         real(wp), intent(in) :: row(:)
         type(error_type), allocatable, intent(inout) :: error
      end subroutine record_interface
   end interface

   !> Keeps rows in an array.
   type, extends(recorder_type) :: array_recorder
      !> Rows kept so far, and how many there will be as far as known
      integer :: count = 0, expected = 0
      !> One row a column (values of a row, rows kept and room for others)
      real(wp), allocatable :: rows(:, :)
   contains
      procedure :: record
   end type array_recorder

contains

   subroutine record(self, row, error)
      class(array_recorder), intent(inout) :: self
      real(wp), intent(in) :: row(:)
      type(error_type), allocatable, intent(inout) :: error

      if (allocated(error)) return
      if (.not. allocated(self%rows)) allocate (self%rows(size(row), max(1, self%expected)))
      if (self%count == size(self%rows, 2)) call make_room(self)
      self%count = self%count + 1
      self%rows(:, self%count) = row
   end subroutine record

   !> Room for twice as many rows: how many corners a path has is not known before.
   subroutine make_room(self)
      type(array_recorder), intent(inout) :: self
      real(wp), allocatable :: larger(:, :)

      allocate (larger(size(self%rows, 1), 2*self%count))
      larger(:, :self%count) = self%rows
      call move_alloc(larger, self%rows)
   end subroutine make_room

end module rbs_output_recorder
