!> The inner product of two arrays.
module rbs_base_inner_product
   use rbs_base_kinds, only: wp
   implicit none
   private

   public :: inner_product

contains

   !> Four independent sums, so that one addition need not wait for the previous one.
   pure real(wp) function inner_product(m, a, b)
      integer, intent(in) :: m
      real(wp), intent(in) :: a(m), b(m)
      real(wp) :: part(4)
      integer :: i

      if (m == 2) then
         inner_product = a(1)*b(1) + a(2)*b(2)
         return
      end if
      part = 0.0_wp
      do i = 1, m - 3, 4
         part = part + a(i:i + 3)*b(i:i + 3)
      end do
      inner_product = (part(1) + part(2)) + (part(3) + part(4))
      do i = m - mod(m, 4) + 1, m
         inner_product = inner_product + a(i)*b(i)
      end do
   end function inner_product

end module rbs_base_inner_product
