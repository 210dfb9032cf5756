!> Lines on standard output, through C: the Fortran library does not report a full disk.
module rbs_app_say
   use, intrinsic :: iso_c_binding, only: c_size_t
   use rbs_base_error, only: error_type, fatal_error, analysis_failed
   use rbs_io_posix, only: c_write, standard_output
   implicit none
   private

   public :: say

contains

   !> Print a line, unless an error has occurred.
   subroutine say(line, error)
      character(len=*), intent(in) :: line
      type(error_type), allocatable, intent(inout) :: error
      character(len=len(line) + 1) :: text
      integer(c_size_t) :: written
      integer :: at

      if (allocated(error)) return
      text = line//new_line('a')
      at = 1
      do while (at <= len(text))
         written = c_write(standard_output, text(at:), int(len(text) - at + 1, c_size_t))
         if (written < 1_c_size_t) then
            call fatal_error(error, analysis_failed, 'standard output cannot be written; is the disk full?')
            return
         end if
         at = at + int(written)
      end do
   end subroutine say

end module rbs_app_say
