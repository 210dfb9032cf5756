!> Response of the process to signals.
!>
!> A handler gets nothing but the number of the signal, so the names of the unfinished file are variables of
!> this module, the only ones in the house.
module rbs_app_signals
   use, intrinsic :: iso_c_binding, only: c_char, c_funloc, c_funptr, c_int, c_intptr_t, c_null_char, &
                                          c_null_funptr, c_size_t
   use rbs_io_posix, only: c_close, c_open, c_rename, c_write, to_read
   implicit none
   private

   public :: prepare_process, keep_if_stopped

   !> Numbers of signals: hangup, interrupt, broken pipe, end, file too large.
   integer(c_int), parameter :: hangup = 1, interrupt = 2, broken_pipe = 13, termination = 15, too_large = 25

   !> Actions on a signal that are no procedure, as C has them
   integer(c_intptr_t), parameter :: by_default = 0_c_intptr_t, ignored = 1_c_intptr_t

   !> Longest path
   integer, parameter :: longest = 4096

   !> Path of the file that is kept when the process is stopped, zero bytes if there is none, and the path
   !> that it then gets; the notice of it, and its length.
   character(kind=c_char), volatile :: own(longest) = c_null_char, partial(longest) = c_null_char
   character(len=2*longest) :: notice = ''
   integer(c_size_t), volatile :: notice_length = 0_c_size_t

   interface
      !> In C: set the action on a signal; the result is the action before.
      type(c_funptr) function c_signal(number, action) bind(c, name='signal') result(before)
         import :: c_funptr, c_int
         integer(c_int), value :: number
         type(c_funptr), value :: action
      end function c_signal

      !> In C: send a signal to the process itself; 0 on success.
      integer(c_int) function c_raise(number) bind(c, name='raise') result(status)
         import :: c_int
         integer(c_int), value :: number
      end function c_raise
   end interface

contains

   !> Set the actions on signals, and make sure that the standard streams are open.
   subroutine prepare_process()
      integer(c_int), parameter :: signals(3) = [hangup, interrupt, termination]
      type(c_funptr) :: before
      integer(c_int) :: descriptor, status
      integer :: i

      ! Streams 0, 1 and 2 that are closed are opened as the empty device.
      ! A file that is opened first would otherwise become the standard output.
      do
         descriptor = c_open('/dev/null'//c_null_char, to_read)
         if (descriptor > 2_c_int .or. descriptor < 0_c_int) exit
      end do
      if (descriptor > 2_c_int) status = c_close(descriptor)
      ! Python, which may start this program, ignores a broken pipe: `rbsdem modes case.nml | head` ends as
      ! other tools do.
      before = c_signal(broken_pipe, action(by_default))
      ! A write beyond the limit of the process then fails with a message.
      before = c_signal(too_large, action(ignored))
      do i = 1, size(signals)
         before = c_signal(signals(i), c_funloc(on_signal))
         ! A signal that was ignored before stays ignored, as by `nohup`.
         if (transfer(before, by_default) == ignored) before = c_signal(signals(i), before)
      end do
   end subroutine prepare_process

   !> Keep a file under another name if the process is stopped from now on; no file if the path is empty.
   subroutine keep_if_stopped(path, name)
      !> Path of the unfinished file, and the name that it then gets
      character(len=*), intent(in) :: path, name

      ! First of all there is no file, as a signal may come at any time.
      own(1) = c_null_char
      if (len(path) == 0 .or. len(path) >= longest .or. len(name) >= longest) return
      call put(name, partial)
      notice = 'rbsdem: stopped by a signal; the rows up to there are in '//name//new_line('a')
      notice_length = int(len_trim(notice), c_size_t)
      call put(path, own)
   end subroutine keep_if_stopped

   !> Store a path such that its first letter comes last: until then the variable is empty.
   subroutine put(path, into)
      character(len=*), intent(in) :: path
      character(kind=c_char), volatile, intent(inout) :: into(:)
      integer :: i

      into(len(path) + 1) = c_null_char
      do i = len(path), 1, -1
         into(i) = path(i:i)
      end do
   end subroutine put

   !> Keep the unfinished file and end by the signal.
   subroutine on_signal(number) bind(c)
      !> Number of the signal
      integer(c_int), value :: number
      type(c_funptr) :: before
      integer(c_int) :: status
      integer(c_size_t) :: written

      ! Only calls that are safe in a handler
      if (own(1) /= c_null_char) then
         status = c_rename(own, partial)
         written = c_write(2_c_int, notice, notice_length)
      end if
      before = c_signal(number, action(by_default))
      status = c_raise(number)
   end subroutine on_signal

   !> An action that is no procedure, as a pointer.
   type(c_funptr) function action(number) result(pointer)
      integer(c_intptr_t), intent(in) :: number

      pointer = transfer(number, c_null_funptr)
   end function action

end module rbs_app_signals
