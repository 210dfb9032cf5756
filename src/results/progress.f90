!> Told by a long run how far it is.
module rbs_results_progress
   use rbs_base_kinds, only: wp
   implicit none
   private

   public :: progress_type

   type, abstract :: progress_type
   contains
      procedure(update_interface), deferred :: update
   end type progress_type

   abstract interface
      subroutine update_interface(self, share)
         import :: progress_type, wp
         implicit none
         class(progress_type), intent(inout) :: self
         !> Share of the run that is done, 0 to 1
         real(wp), intent(in) :: share
      end subroutine update_interface
   end interface

end module rbs_results_progress
