!> Arrays that change their places.
module rbs_base_arrays
   use rbs_base_kinds, only: wp
   implicit none
   private

   public :: swap, copy

contains

   !> Exchange two arrays; no number is copied.
   pure subroutine swap(one, other)
      real(wp), allocatable, intent(inout) :: one(:), other(:)
      real(wp), allocatable :: kept(:)

      call move_alloc(one, kept)
      call move_alloc(other, one)
      call move_alloc(kept, other)
   end subroutine swap

   !> Copy an array of length m; of its bounds nothing is asked, so that it is copied as a block.
   pure subroutine copy(m, from, to)
      integer, intent(in) :: m
      real(wp), intent(in) :: from(m)
      real(wp), intent(out) :: to(m)

      to = from
   end subroutine copy

end module rbs_base_arrays
