!> Linear algebra, dense and banded: the only place that calls LAPACK.
!>
!> No analysis calls it for a dense system at each event or step: those are bands (`rbs_base_band_matrix`).
!> `info` of LAPACK becomes a logical, as the caller can write a better message.
module rbs_base_linalg
   use rbs_base_kinds, only: wp
   implicit none
   private

   public :: solve_tridiagonal, solve_general_band, solve_dense

   interface
      !> LAPACK: solve with a symmetric positive definite tridiagonal matrix, diagonal d and off-diagonal e.
      subroutine dptsv(n, nrhs, d, e, b, ldb, info)
         import :: wp
         integer, intent(in) :: n, nrhs, ldb
         real(wp), intent(inout) :: d(*), e(*), b(ldb, *)
         integer, intent(out) :: info
      end subroutine dptsv

      !> LAPACK: factor a band matrix with pivots, and solve.
      subroutine dgbsv(n, kl, ku, nrhs, ab, ldab, ipiv, b, ldb, info)
         import :: wp
         integer, intent(in) :: n, kl, ku, nrhs, ldab, ldb
         real(wp), intent(inout) :: ab(ldab, *), b(ldb, *)
         integer, intent(out) :: ipiv(*), info
      end subroutine dgbsv

      !> LAPACK: solve with the factor and the pivots of `dgbsv`.
      subroutine dgbtrs(trans, n, kl, ku, nrhs, ab, ldab, ipiv, b, ldb, info)
         import :: wp
         character(len=1), intent(in) :: trans
         integer, intent(in) :: n, kl, ku, nrhs, ldab, ipiv(*), ldb
         real(wp), intent(in) :: ab(ldab, *)
         real(wp), intent(inout) :: b(ldb, *)
         integer, intent(out) :: info
      end subroutine dgbtrs

      !> LAPACK: factor a general matrix with pivots, and solve.
      subroutine dgesv(n, nrhs, a, lda, ipiv, b, ldb, info)
         import :: wp
         integer, intent(in) :: n, nrhs, lda, ldb
         real(wp), intent(inout) :: a(lda, *), b(ldb, *)
         integer, intent(out) :: ipiv(*), info
      end subroutine dgesv
   end interface

contains

   !> Solve a symmetric positive definite tridiagonal system.
   subroutine solve_tridiagonal(diagonal, off_diagonal, b, positive)
      !> Diagonal (n) and off-diagonal (n - 1), overwritten; right-hand side (n), replaced by the solution
      real(wp), intent(inout), contiguous :: diagonal(:), off_diagonal(:), b(:)
      !> Whether the matrix is positive definite
      logical, intent(out) :: positive
      integer :: info

      call dptsv(size(b), 1, diagonal, off_diagonal, b, size(b), info)
      positive = info == 0
   end subroutine solve_tridiagonal

   !> Solve a general band system by elimination with pivots.
   subroutine solve_general_band(band, below, above, b, regular, work, is_factored)
      !> Band (2 below + above + 1, n): band(below + above + 1 + i - j, j) = a(i, j); replaced by its factor
      real(wp), intent(inout), contiguous :: band(:, :)
      !> Number of diagonals below and above the main one
      integer, intent(in) :: below, above
      !> Right-hand sides (n, m), replaced by the solutions
      real(wp), intent(inout), contiguous :: b(:, :)
      !> Whether the matrix has an inverse
      logical, intent(out) :: regular
      !> Pivots (n)
      integer, intent(inout), contiguous :: work(:)
      !> Whether band and pivots are those that a regular solution has left
      logical, intent(in), optional :: is_factored
      integer :: info

      regular = .false.
      if (present(is_factored)) regular = is_factored
      if (regular) then
         call dgbtrs('n', size(b, 1), below, above, size(b, 2), band, size(band, 1), work, b, size(b, 1), &
                     info)
         return
      end if
      call dgbsv(size(b, 1), below, above, size(b, 2), band, size(band, 1), work, b, size(b, 1), info)
      regular = info == 0
   end subroutine solve_general_band

   !> Solve a general system by elimination with pivots.
   subroutine solve_dense(a, b, regular)
      !> Matrix (n, n), overwritten; right-hand side (n), replaced by the solution
      real(wp), intent(inout), contiguous :: a(:, :), b(:)
      !> Whether the matrix has an inverse
      logical, intent(out) :: regular
      integer :: pivot(size(b)), info

      call dgesv(size(b), 1, a, size(b), pivot, b, size(b), info)
      regular = info == 0
   end subroutine solve_dense

end module rbs_base_linalg
