!> A text to which other texts are appended.
module rbs_case_text_buffer
   implicit none
   private

   public :: text_buffer

   type :: text_buffer
      !> Number of characters so far
      integer :: length = 0
      !> The text, followed by free space
      character(len=:), allocatable :: text
   contains
      procedure :: append
   end type text_buffer

contains

   !> Append a text.
   subroutine append(self, text)
      class(text_buffer), intent(inout) :: self
      character(len=*), intent(in) :: text
      character(len=:), allocatable :: longer

      if (.not. allocated(self%text)) allocate (character(len=1024) :: self%text)
      if (self%length + len(text) > len(self%text)) then
         allocate (character(len=2*(self%length + len(text))) :: longer)
         longer(:self%length) = self%text(:self%length)
         call move_alloc(longer, self%text)
      end if
      self%text(self%length + 1:self%length + len(text)) = text
      self%length = self%length + len(text)
   end subroutine append

end module rbs_case_text_buffer
