!> Told by a long run how far it is.
module rbs_output_observer
   use rbs_base_kinds, only: wp
   implicit none
   private

   public :: observer_type

   type, abstract :: observer_type
   contains
      procedure(update_interface), deferred :: update
   end type observer_type

   abstract interface
      subroutine update_interface(self, share)
         import :: observer_type, wp
         implicit none
         class(observer_type), intent(inout) :: self
         !> Share of the run that is done, 0 to 1
         real(wp), intent(in) :: share
      end subroutine update_interface
   end interface

end module rbs_output_observer
