! The only file that f2py reads: the doors to Python. What can be asked for stands in `rbs_bindings_evaluate`.
!
! f2py would treat real(wp) as a C float without a warning, so only c_double and c_int appear here.

subroutine rbs_evaluate(what, statement, nn, number, names, m, input, control, answer, address, sizes)
   ! Answer a request (see `request_type`). `answer` is a pointer, for `rbs_read` and `rbs_release`, and zero
   ! if there is nothing to read; `address` is that of its rows. `sizes`: status (0 success, 1 the analysis
   ! failed, 2 bad input, 3 a long run that waits to be told), characters of the text, numbers of the values,
   ! values of a row, and rows. Another thread may read and set `control`.
   use iso_c_binding, only: c_double, c_int
   use rbs_bindings_doors, only: open_door
   implicit none
   character(len=*), intent(in) :: what, statement, names
   integer(c_int), intent(in) :: nn, m
   real(c_double), intent(in) :: number(nn), input(m)
   integer(c_int), intent(inout) :: control(2)
   integer(c_int), intent(out) :: answer(2), address(2), sizes(5)
   !f2py threadsafe

   call open_door(what, statement, number, names, input, control, answer, address, sizes)
end subroutine rbs_evaluate

subroutine rbs_read(answer, length, count, text, values)
   ! Text and values of an answer, of the lengths that it has. One without rows is released.
   use iso_c_binding, only: c_double, c_int
   use rbs_bindings_doors, only: read_answer
   implicit none
   integer(c_int), intent(in) :: answer(2), length, count
   character(len=length + 1), intent(out) :: text
   real(c_double), intent(out) :: values(count)
   !f2py threadsafe

   call read_answer(answer, text, values)
end subroutine rbs_read

subroutine rbs_release(answer)
   ! The rows of an answer are no longer needed.
   use iso_c_binding, only: c_int
   use rbs_bindings_doors, only: release_answer
   implicit none
   integer(c_int), intent(in) :: answer(2)
   !f2py threadsafe

   call release_answer(answer)
end subroutine rbs_release
