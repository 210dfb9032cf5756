!> The inner product of two arrays, and the sum of one.
module rbs_base_inner_product
   use rbs_base_kinds, only: wp
   implicit none
   private

   public :: inner_product, total

contains

   !> Inner product of two arrays of length m: four independent sums, so that one addition need not wait for
   !> the previous one.
   pure real(wp) function inner_product(m, a, b)
      integer, intent(in) :: m
      real(wp), intent(in) :: a(m), b(m)
      real(wp) :: part(4)
      integer :: i

      ! Two products need no loop.
      if (m == 2) then
         inner_product = a(1)*b(1) + a(2)*b(2)
         return
      end if
      part = 0.0_wp
      do i = 1, m - 3, 4
         part = part + a(i:i + 3)*b(i:i + 3)
      end do
      inner_product = (part(1) + part(2)) + (part(3) + part(4))
      ! The last one to three, which make no four.
      do i = m - mod(m, 4) + 1, m
         inner_product = inner_product + a(i)*b(i)
      end do
   end function inner_product

   !> Sum of an array, its terms in any order.
   pure real(wp) function total(m, a)
      integer, intent(in) :: m
      real(wp), intent(in) :: a(m)
      integer :: i

      total = 0.0_wp
      !$omp simd reduction(+:total)
      do i = 1, m
         total = total + a(i)
      end do
   end function total

end module rbs_base_inner_product
