!> Keeps an answer until Python has read it. Its rows, which may be many, are not copied: Python looks at them
!> in place and releases them with the last array that shows them.
module rbs_bindings_doors
   use, intrinsic :: iso_c_binding, only: c_double, c_f_pointer, c_int, c_loc, c_null_ptr
   use rbs_bindings_evaluate, only: evaluate
   use rbs_bindings_exchange, only: request_type, answer_type
   implicit none
   private

   public :: open_door, read_answer, release_answer

contains

   !> See `rbs_evaluate`.
   subroutine open_door(what, statement, number, names, input, control, handle, address, sizes)
      character(len=*), intent(in) :: what, statement, names
      real(c_double), intent(in), contiguous, target :: number(:), input(:)
      integer(c_int), intent(inout), volatile :: control(2)
      integer(c_int), intent(out) :: handle(2), address(2), sizes(5)
      type(request_type) :: request
      type(answer_type), pointer :: answer

      request%what = what
      request%statement = statement
      request%number => number
      request%names = names
      request%input => input
      allocate (answer)
      call evaluate(request, control, answer)
      handle = transfer(c_loc(answer), handle)
      address = 0
      sizes = 0
      if (allocated(answer%error)) then
         sizes(1) = answer%error%code
         ! A run says its method before its error.
         if (.not. allocated(answer%text)) answer%text = ''
         answer%text = answer%text//answer%error%message
      end if
      if (allocated(answer%text)) sizes(2) = len(answer%text)
      if (allocated(answer%value)) sizes(3) = size(answer%value)
      if (allocated(answer%rows)) then
         if (answer%kept < 0) answer%kept = size(answer%rows, 2)
         sizes(4:) = [size(answer%rows, 1), answer%kept]
      else
         answer%kept = 0
      end if
      if (answer%kept > 0) then
         address = transfer(c_loc(answer%rows), address)
      else if (all(sizes(2:3) == 0)) then
         call release_answer(handle)
         handle = 0
      end if
   end subroutine open_door

   !> See `rbs_read`.
   subroutine read_answer(handle, text, values)
      integer(c_int), intent(in) :: handle(2)
      character(len=*), intent(inout) :: text
      real(c_double), intent(inout) :: values(:)
      type(answer_type), pointer :: answer

      call c_f_pointer(transfer(handle, c_null_ptr), answer)
      text = ''
      if (allocated(answer%text)) text = answer%text
      if (allocated(answer%value)) values = answer%value
      if (answer%kept == 0) call release_answer(handle)
   end subroutine read_answer

   !> See `rbs_release`.
   subroutine release_answer(handle)
      integer(c_int), intent(in) :: handle(2)
      type(answer_type), pointer :: answer

      call c_f_pointer(transfer(handle, c_null_ptr), answer)
      deallocate (answer)
   end subroutine release_answer

end module rbs_bindings_doors
