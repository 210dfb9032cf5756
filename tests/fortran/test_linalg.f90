!> The interface to LAPACK and the band matrix: small systems by hand, and every possible failure.
module test_linalg
   use check, only: unit_test, check_close, check_true
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_base_band_matrix, only: band_matrix
   use rbs_base_linalg, only: solve_tridiagonal, solve_general_band, solve_dense
   implicit none
   private

   public :: collect_linalg

contains

   subroutine collect_linalg(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('band: L D L'' solves and counts negative eigenvalues, narrow and wide', band), &
               unit_test('band with a border, also where the band has no inverse', bordered), &
               unit_test('band with a border and negative pivots', indefinite_with_border), &
               unit_test('tridiagonal system, and one that is not positive', tridiagonal), &
               unit_test('general band needs pivots, two right-hand sides', general_band), &
               unit_test('dense system by LAPACK, and a singular one', dense_system)]
   end subroutine collect_linalg

   !> T T of the second differences T, (1, -4, 6, -4, 1) with 5 in place of 6 at the ends, as a lower band
   !> of half-width 3; its eigenvalues are (2 - 2 cos(j pi/(n + 1)))^2.
   pure function bending(n) result(a)
      integer, intent(in) :: n
      real(wp) :: a(4, n)

      a(1, :) = 6.0_wp
      a(1, [1, n]) = 5.0_wp
      a(2, :) = -4.0_wp
      a(3, :) = 1.0_wp
      a(4, :) = 0.0_wp
   end function bending

   subroutine band(error)
      type(error_type), allocatable, intent(inout) :: error
      integer, parameter :: n = 7
      type(band_matrix) :: a, fresh
      real(wp) :: b(n), expected(n)
      integer :: i, width
      logical :: regular

      do width = 2, 5
         call a%create(n, width)
         a%band(:4, :) = bending(n)
         ! T x = e_n has x_i = i/(n + 1), and T of that is e_n: so T T x = T e_n.
         b = 0.0_wp
         b(n - 1:) = [-1.0_wp, 2.0_wp]
         expected = [(real(i, wp)/(n + 1), i=1, n)]
         call a%factor()
         call check_true(error, a%positive .and. a%negative == 0, 'positive definite')
         call a%solve(b, regular)
         call check_close(error, b, expected, 1.0e-13_wp, 0.0_wp, 'solution')
         ! Between the second eigenvalue and the third
         a%band(:4, :) = bending(n)
         a%band(1, :) = a%band(1, :) - 1.0_wp
         call a%factor()
         call check_true(error, .not. a%positive .and. a%negative == 2, 'two eigenvalues below 1')
         b = 0.0_wp
         b(n - 1:) = [-1.0_wp, 2.0_wp]
         b = b - expected
         call a%solve(b, regular)
         call check_true(error, regular, 'regular')
         call check_close(error, b, expected, 1.0e-12_wp, 0.0_wp, 'indefinite')
         ! Columns before a change keep their factor, and the others have the bits of a new one, also where
         ! rows have become shorter.
         a%band(:4, :) = bending(n)
         a%band(1, :) = a%band(1, :) - 1.0_wp
         do i = 1, 2
            a%band(i, 3*i) = 9.0_wp*(2 - i)
            a%band(3, 3*i - 1) = 1.0_wp*(2 - i)
            call fresh%create(n, width)
            fresh%band(:, :) = a%band
            call a%factor()
            call fresh%factor()
            call check_close(error, reshape(a%triangle, [size(a%triangle)]), &
                             reshape(fresh%triangle, [size(a%triangle)]), 0.0_wp, 0.0_wp, 'changed')
            call check_true(error, a%negative == fresh%negative, 'negative pivots')
         end do
      end do
   end subroutine band

   !> A scaled matrix with negative pivots of sound size, and one with a pivot next to nothing.
   subroutine indefinite_with_border(error)
      type(error_type), allocatable, intent(inout) :: error
      integer, parameter :: n = 7
      real(wp), parameter :: shift(2) = [1.0_wp, 5.0_wp - 1.0e-9_wp]
      type(band_matrix) :: a
      real(wp) :: lower(4, n), dense(n, n), x(n), y, column(n), row(n), f(n)
      integer :: i, j, k
      logical :: regular

      column = [(1.0_wp/i, i=1, n)]
      row = [(real(i, wp), i=1, n)]
      f = [((-1.0_wp)**i, i=1, n)]
      do k = 1, size(shift)
         lower = bending(n)
         call a%create(n, 5, stiffness=lower(1, :))
         lower(1, :) = lower(1, :) - shift(k)
         a%band(:4, :) = lower
         do j = 1, n
            do i = 1, n
               dense(i, j) = 0.0_wp
               if (abs(i - j) < 4) dense(i, j) = lower(1 + abs(i - j), min(i, j))
            end do
         end do
         call a%factor()
         call check_true(error, a%negative > 0, 'negative pivots')
         call a%set_border(column, row, regular)
         call a%solve_bordered(f, 3.0_wp, x, y, regular)
         call check_true(error, regular, 'regular')
         call check_close(error, [matmul(dense, x) - column*y, sum(row*x)], [f, 3.0_wp], 1.0e-11_wp, 0.0_wp, &
                          'balance')
      end do
   end subroutine indefinite_with_border

   !> (1 0; 0 p) has no inverse for p = 0, with a border it has, and a pivot p far below round-off changes
   !> nothing.
   subroutine bordered(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp), parameter :: p(4) = [0.0_wp, 1.0e-20_wp, 1.0e-28_wp, -1.0e-28_wp]
      type(band_matrix) :: a
      real(wp) :: x(2), y
      integer :: i
      logical :: regular

      do i = 1, size(p)
         call a%create(2, 1, stiffness=[1.0_wp, 4.0_wp])
         a%band(1, :) = [1.0_wp, p(i)]
         call a%factor()
         call check_true(error, .not. a%positive, 'no inverse')
         call a%set_border([0.1_wp, 0.3_wp], [0.7_wp, 1.1_wp], regular)
         call check_true(error, regular, 'border')
         ! x = (1, 2) and y = 0.9 solve it.
         call a%solve_bordered([0.91_wp, -0.27_wp], 2.9_wp, x, y, regular)
         call check_true(error, regular, 'regular')
         call check_close(error, [x, y], [1.0_wp, 2.0_wp, 0.9_wp], 1.0e-14_wp, 0.0_wp, 'solution')
      end do
   end subroutine bordered

   subroutine tridiagonal(error)
      type(error_type), allocatable, intent(inout) :: error
      integer, parameter :: n = 5
      real(wp) :: diagonal(n), beside(n - 1), b(n)
      integer :: i
      logical :: is_positive

      diagonal = 2.0_wp
      beside = -1.0_wp
      b = 0.0_wp
      b(n) = n + 1.0_wp
      call solve_tridiagonal(diagonal, beside, b, is_positive)
      call check_true(error, is_positive, 'positive definite')
      call check_close(error, b, [(real(i, wp), i=1, n)], 1.0e-14_wp, 0.0_wp, 'solution')
      diagonal = 1.0_wp
      beside = -1.0_wp
      call solve_tridiagonal(diagonal, beside, b, is_positive)
      call check_true(error, .not. is_positive, 'indefinite')
   end subroutine tridiagonal

   !> (0 1; 1 0; ...): a permutation of neighbours, then a singular matrix.
   subroutine general_band(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp) :: a(4, 4), b(4, 2)
      integer :: j, pivot(4)
      logical :: regular

      a = 0.0_wp
      do j = 1, 3
         a(4, j) = merge(2.0_wp, 0.0_wp, mod(j, 2) == 1)
         a(2, j + 1) = a(4, j)
      end do
      b(:, 1) = [1.0_wp, 2.0_wp, 3.0_wp, 4.0_wp]
      b(:, 2) = -b(:, 1)
      call solve_general_band(a, 1, 1, b, regular, pivot)
      call check_true(error, regular, 'regular')
      call check_close(error, b(:, 1), [1.0_wp, 0.5_wp, 2.0_wp, 1.5_wp], 1.0e-15_wp, 0.0_wp, 'first')
      call check_close(error, b(:, 2), -b(:, 1), 0.0_wp, 0.0_wp, 'second')
      a = 0.0_wp
      call solve_general_band(a, 1, 1, b, regular, pivot)
      call check_true(error, .not. regular, 'singular')
   end subroutine general_band

   subroutine dense_system(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp) :: a(2, 2), b(2)
      logical :: regular

      a = reshape([0.0_wp, 1.0_wp, 2.0_wp, 3.0_wp], [2, 2])
      b = matmul(a, [5.0_wp, 7.0_wp])
      call solve_dense(a, b, regular)
      call check_true(error, regular, 'regular')
      call check_close(error, b, [5.0_wp, 7.0_wp], 1.0e-15_wp, 0.0_wp, 'solution')
      a = 0.0_wp
      call solve_dense(a, b, regular)
      call check_true(error, .not. regular, 'singular')
   end subroutine dense_system

end module test_linalg
