!> A message when memory runs out.
!>
!> The Fortran runtime would print a backtrace, or run on with a null pointer where an assignment makes
!> room. The linker leads `malloc` and `realloc` of all Fortran code of the executable here (`--wrap`).
module rbs_app_memory
   use, intrinsic :: iso_c_binding, only: c_associated, c_int, c_null_ptr, c_ptr, c_size_t
   use rbs_app_signals, only: remove_unfinished
   use rbs_io_posix, only: c_write
   implicit none
   private

   public :: wrapped_malloc, wrapped_realloc

   !> Exit code: the input is right, but cannot be solved here.
   integer(c_int), parameter :: failed = 1_c_int

   interface
      !> In C: the malloc of the C library.
      type(c_ptr) function real_malloc(size) bind(c, name='__real_malloc') result(place)
         import :: c_ptr, c_size_t
         implicit none
         integer(c_size_t), value :: size
      end function real_malloc

      !> In C: the realloc of the C library.
      type(c_ptr) function real_realloc(old, size) bind(c, name='__real_realloc') result(place)
         import :: c_ptr, c_size_t
         implicit none
         type(c_ptr), value :: old
         integer(c_size_t), value :: size
      end function real_realloc

      !> In C: end the process at once.
      subroutine c_exit_now(status) bind(c, name='_exit')
         import :: c_int
         implicit none
         integer(c_int), value :: status
      end subroutine c_exit_now
   end interface

contains

   type(c_ptr) function wrapped_malloc(size) bind(c, name='__wrap_malloc') result(place)
      integer(c_size_t), value :: size

      place = real_malloc(size)
      if (size > 0_c_size_t .and. .not. c_associated(place)) call give_up()
   end function wrapped_malloc

   type(c_ptr) function wrapped_realloc(old, size) bind(c, name='__wrap_realloc') result(place)
      type(c_ptr), value :: old
      integer(c_size_t), value :: size

      place = real_realloc(old, size)
      if (size > 0_c_size_t .and. .not. c_associated(place)) call give_up()
   end function wrapped_realloc

   !> Say why, and end. Nothing here makes room in memory.
   subroutine give_up()
      character(len=*), parameter :: text = 'rbsdem: there is not enough memory for this case; raise the '// &
                                     'limit of the process, or use fewer bodies, a shorter history or '// &
                                     'fewer springs'//new_line('a')
      integer(c_size_t) :: written

      call remove_unfinished()
      written = c_write(2_c_int, text, len(text, kind=c_size_t))
      call c_exit_now(failed)
   end subroutine give_up

end module rbs_app_memory
