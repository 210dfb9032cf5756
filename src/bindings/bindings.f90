! The only file that f2py reads: the entry points for Python. The questions are listed in
! `rbs_bindings_evaluate`.
!
! f2py would treat real(wp) as a C float without a warning, so only c_double and c_int appear here.

subroutine rbs_evaluate(what, statement, nn, number, names, m, input, made, control, answer, address, sizes)
   ! Answer a request (see `request_type`). `answer` is a pointer, for `rbs_read` and `rbs_release`, and zero
   ! if there is nothing to read; `address` is that of its rows, which may be many and are not copied: Python
   ! reads them in place and releases them with the last array that refers to them. An answer with a structure
   ! is kept too, and is `made` where this structure is asked about. `sizes`: status (0 success, 1 the run
   ! failed, 2 bad input, 3 a long run that was not started), characters of the text, numbers of the values,
   ! values of a row, rows, and whether there is a structure (1). Another thread may read and set `control`: a
   ! word that stops the run, and how much of it is done. Addresses are two words of 32 bits each; `nn` and
   ! `m` are the sizes of `number` and `input`.
   use iso_c_binding, only: c_double, c_f_pointer, c_int, c_loc, c_null_ptr
   use rbs_bindings_evaluate, only: evaluate
   use rbs_bindings_exchange, only: request_type, answer_type
   implicit none
   character(len=*), intent(in) :: what, statement, names
   integer(c_int), intent(in) :: nn, m, made(2)
   real(c_double), intent(in), target :: number(nn), input(m)
   integer(c_int), intent(inout) :: control(2)
   integer(c_int), intent(out) :: answer(2), address(2), sizes(6)
   !f2py threadsafe
   type(request_type) :: request
   ! The answer itself, to which the pointer leads
   type(answer_type), pointer :: found

   request%what = what
   request%statement = statement
   request%number => number
   request%names = names
   request%input => input
   if (any(made /= 0)) call c_f_pointer(transfer(made, c_null_ptr), request%made)
   allocate (found)
   call evaluate(request, control, found)
   sizes = 0
   if (allocated(found%error)) then
      sizes(1) = found%error%code
      ! The method of a run precedes its error.
      if (.not. allocated(found%text)) found%text = ''
      found%text = found%text//found%error%message
   end if
   if (allocated(found%text)) sizes(2) = len(found%text)
   if (allocated(found%value)) sizes(3) = size(found%value)
   if (.not. allocated(found%rows)) allocate (found%rows(0, 0))
   if (found%kept < 0) found%kept = size(found%rows, 2)
   sizes(4:) = [size(found%rows, 1), found%kept, merge(1, 0, allocated(found%structure))]
   address = 0
   if (found%kept > 0) address = transfer(c_loc(found%rows), address)
   answer = transfer(c_loc(found), answer)
   ! With nothing to read Python gets no pointer.
   if (any(sizes([2, 3, 5, 6]) > 0)) return
   deallocate (found)
   answer = 0
end subroutine rbs_evaluate

subroutine rbs_read(answer, length, count, text, values)
   ! Text and values of an answer, of the lengths that `sizes` gave. An answer without rows and structure is
   ! released.
   use iso_c_binding, only: c_double, c_f_pointer, c_int, c_null_ptr
   use rbs_bindings_exchange, only: answer_type
   implicit none
   integer(c_int), intent(in) :: answer(2), length, count
   character(len=length + 1), intent(out) :: text
   real(c_double), intent(out) :: values(count)
   !f2py threadsafe
   ! The answer itself, to which the pointer leads
   type(answer_type), pointer :: found

   call c_f_pointer(transfer(answer, c_null_ptr), found)
   text = ''
   if (allocated(found%text)) text = found%text
   if (allocated(found%value)) values = found%value
   if (found%kept == 0 .and. .not. allocated(found%structure)) deallocate (found)
end subroutine rbs_read

subroutine rbs_release(answer)
   ! Release an answer whose rows and structure are no longer needed.
   use iso_c_binding, only: c_f_pointer, c_int, c_null_ptr
   use rbs_bindings_exchange, only: answer_type
   implicit none
   integer(c_int), intent(in) :: answer(2)
   !f2py threadsafe
   ! The answer itself, to which the pointer leads
   type(answer_type), pointer :: found

   call c_f_pointer(transfer(answer, c_null_ptr), found)
   deallocate (found)
end subroutine rbs_release
