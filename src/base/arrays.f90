!> Arrays that change their places.
module rbs_base_arrays
   use rbs_base_kinds, only: wp
   implicit none
   private

   public :: swap

contains

   !> Exchange two arrays; no number is copied.
   pure subroutine swap(one, other)
      real(wp), allocatable, intent(inout) :: one(:), other(:)
      real(wp), allocatable :: kept(:)

      call move_alloc(one, kept)
      call move_alloc(other, one)
      call move_alloc(kept, other)
   end subroutine swap

end module rbs_base_arrays
