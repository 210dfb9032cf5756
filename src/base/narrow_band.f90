!> Symmetric band matrices of half-width 3, which the implicit methods factor and solve in every step.
!>
!> The three columns that an elimination changes stay in registers. LAPACK's band routines (see
!> `factor_band` in `rbs_base_linalg`, the reference of the tests) take several times as long, because
!> they call other routines for vectors of three numbers.
module rbs_base_narrow_band
   use rbs_base_kinds, only: wp
   implicit none
   private

   public :: factor_narrow_band, solve_narrow_band

contains

   !> Factor L D L', in place.
   pure subroutine factor_narrow_band(n, band, positive)
      integer, intent(in) :: n
      !> Lower band: band(1 + i - j, j) = a(i, j) for j <= i <= j + 3; elements beyond the last row must be
      !> zero. On return 1/D and L
      real(wp), intent(inout) :: band(4, n)
      !> Whether the matrix is positive definite; if not, `band` is useless on return
      logical, intent(out) :: positive
      real(wp) :: pivot, share, l1, l2, l3, below1, below2, below3
      real(wp) :: r11, r21, r31, r22, r32, r33
      integer :: j

      positive = .false.
      r11 = 0.0_wp
      r21 = 0.0_wp
      r31 = 0.0_wp
      r22 = 0.0_wp
      r32 = 0.0_wp
      r33 = 0.0_wp
      do j = 1, n
         pivot = band(1, j) - r11
         if (.not. pivot > 0.0_wp) return
         share = 1.0_wp/pivot
         below1 = band(2, j) - r21
         below2 = band(3, j) - r31
         below3 = band(4, j)
         l1 = below1*share
         l2 = below2*share
         l3 = below3*share
         band(1, j) = share
         band(2, j) = l1
         band(3, j) = l2
         band(4, j) = l3
         r11 = r22 + l1*below1
         r21 = r32 + l1*below2
         r31 = l1*below3
         r22 = r33 + l2*below2
         r32 = l2*below3
         r33 = l3*below3
      end do
      positive = .true.
   end subroutine factor_narrow_band

   !> Solve with the factor of `factor_narrow_band`.
   pure subroutine solve_narrow_band(n, factor, b)
      integer, intent(in) :: n
      real(wp), intent(in) :: factor(4, n)
      !> Right-hand side, replaced by the solution
      real(wp), intent(inout) :: b(n)
      real(wp) :: r1, r2, r3, x, x1, x2, x3
      integer :: j

      r1 = 0.0_wp
      r2 = 0.0_wp
      r3 = 0.0_wp
      do j = 1, n
         x = b(j) - r1
         r1 = r2 + factor(2, j)*x
         r2 = r3 + factor(3, j)*x
         r3 = factor(4, j)*x
         b(j) = x*factor(1, j)
      end do
      x1 = 0.0_wp
      x2 = 0.0_wp
      x3 = 0.0_wp
      do j = n, 1, -1
         x = (b(j) - (factor(3, j)*x2 + factor(4, j)*x3)) - factor(2, j)*x1
         x3 = x2
         x2 = x1
         x1 = x
         b(j) = x
      end do
   end subroutine solve_narrow_band

end module rbs_base_narrow_band
