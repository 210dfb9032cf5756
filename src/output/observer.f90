!> An observer of a long run, which is told now and then what share has been completed.
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
         !> Share of the run that has been completed, 0 to 1
         real(wp), intent(in) :: share
      end subroutine update_interface
   end interface

end module rbs_output_observer
