!> What the process does on signals.
!>
!> A handler gets nothing but the number of the signal, so the name of the unfinished file is a variable of
!> this module, the only one in the house.
module rbs_app_signals
   use, intrinsic :: iso_c_binding, only: c_char, c_funloc, c_funptr, c_int, c_intptr_t, c_null_char, &
                                          c_null_funptr
   use rbs_io_posix, only: c_close, c_open, c_unlink, to_read
   implicit none
   private

   public :: prepare_process, remove_if_stopped

   !> Numbers of signals: hangup, interrupt, broken pipe, end, file too large.
   integer(c_int), parameter :: hangup = 1, interrupt = 2, broken_pipe = 13, termination = 15, too_large = 25

   integer(c_intptr_t), parameter :: by_default = 0_c_intptr_t, ignored = 1_c_intptr_t

   integer, parameter :: longest = 4096

   !> Path of the file that goes when the process is stopped; it starts with a zero byte if there is none.
   character(kind=c_char), volatile :: doomed(longest) = c_null_char

   interface
      !> In C: set what is done on a signal; what was done before.
      type(c_funptr) function c_signal(number, action) bind(c, name='signal') result(before)
         import :: c_funptr, c_int
         implicit none
         integer(c_int), value :: number
         type(c_funptr), value :: action
      end function c_signal

      !> In C: send a signal to the process itself; 0 on success.
      integer(c_int) function c_raise(number) bind(c, name='raise') result(status)
         import :: c_int
         implicit none
         integer(c_int), value :: number
      end function c_raise
   end interface

contains

   !> Set what is done on signals, and see to it that the standard streams are open.
   subroutine prepare_process()
      integer(c_int), parameter :: signals(3) = [hangup, interrupt, termination]
      type(c_funptr) :: before
      integer(c_int) :: descriptor, status
      integer :: i

      ! A file that is opened first would otherwise become the standard output.
      do
         descriptor = c_open('/dev/null'//c_null_char, to_read)
         if (descriptor > 2_c_int .or. descriptor < 0_c_int) exit
      end do
      if (descriptor > 2_c_int) status = c_close(descriptor)
      ! Python, which starts this program, ignores it: `rbsdem modes case.nml | head` ends as other tools do.
      before = c_signal(broken_pipe, action(by_default))
      ! A write beyond the limit of the process then fails with a message.
      before = c_signal(too_large, action(ignored))
      do i = 1, size(signals)
         before = c_signal(signals(i), c_funloc(on_signal))
         ! As by `nohup`.
         if (transfer(before, by_default) == ignored) before = c_signal(signals(i), before)
      end do
   end subroutine prepare_process

   !> Remove a file if the process is stopped from now on; no file if the path is empty.
   subroutine remove_if_stopped(path)
      character(len=*), intent(in) :: path
      integer :: i

      doomed(1) = c_null_char
      if (len(path) == 0 .or. len(path) >= longest) return
      doomed(len(path) + 1) = c_null_char
      do i = len(path), 1, -1
         doomed(i) = path(i:i)
      end do
   end subroutine remove_if_stopped

   !> Remove the unfinished file and end as the signal asks for.
   subroutine on_signal(number) bind(c)
      integer(c_int), value :: number
      type(c_funptr) :: before
      integer(c_int) :: status

      call remove_unfinished()
      before = c_signal(number, action(by_default))
      status = c_raise(number)
   end subroutine on_signal

   !> Remove the unfinished file, if there is one.
   subroutine remove_unfinished()
      integer(c_int) :: status

      if (doomed(1) /= c_null_char) status = c_unlink(doomed)
   end subroutine remove_unfinished

   type(c_funptr) function action(number) result(pointer)
      integer(c_intptr_t), intent(in) :: number

      pointer = transfer(number, c_null_funptr)
   end function action

end module rbs_app_signals
