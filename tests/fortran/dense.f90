!> Dense systems and the dense eigenproblem by LAPACK, that tests compare with.
module dense
   use rbs_base_kinds, only: wp
   implicit none
   private

   public :: is_positive, solve_general, solve_eigen

   interface
      subroutine dpotrf(uplo, n, a, lda, info)
         import :: wp
         implicit none
         character(len=1), intent(in) :: uplo
         integer, intent(in) :: n, lda
         real(wp), intent(inout) :: a(lda, *)
         integer, intent(out) :: info
      end subroutine dpotrf

      subroutine dgesv(n, nrhs, a, lda, ipiv, b, ldb, info)
         import :: wp
         implicit none
         integer, intent(in) :: n, nrhs, lda, ldb
         real(wp), intent(inout) :: a(lda, *), b(ldb, *)
         integer, intent(out) :: ipiv(*), info
      end subroutine dgesv

      subroutine dsygv(itype, jobz, uplo, n, a, lda, b, ldb, w, work, lwork, info)
         import :: wp
         implicit none
         integer, intent(in) :: itype, n, lda, ldb, lwork
         character(len=1), intent(in) :: jobz, uplo
         real(wp), intent(inout) :: a(lda, *), b(ldb, *)
         real(wp), intent(out) :: w(*), work(*)
         integer, intent(out) :: info
      end subroutine dsygv
   end interface

contains

   !> Whether a symmetric matrix, of which the lower triangle is read, is positive definite.
   logical function is_positive(matrix)
      real(wp), intent(in) :: matrix(:, :)
      real(wp) :: a(size(matrix, 1), size(matrix, 1))
      integer :: info

      a = matrix
      call dpotrf('L', size(a, 1), a, size(a, 1), info)
      is_positive = info == 0
   end function is_positive

   !> Solve a general system by elimination with partial pivoting.
   subroutine solve_general(a, b, regular)
      !> Matrix (n, n), overwritten
      real(wp), intent(inout), contiguous :: a(:, :)
      !> Right-hand sides (n, m), replaced by the solutions
      real(wp), intent(inout), contiguous :: b(:, :)
      !> Whether the matrix has an inverse
      logical, intent(out) :: regular
      integer :: pivot(size(b, 1)), info

      call dgesv(size(b, 1), size(b, 2), a, size(b, 1), pivot, b, size(b, 1), info)
      regular = info == 0
   end subroutine solve_general

   !> Eigenvalues of `a x = w b x`, ascending, with vectors that satisfy x' b x = 1.
   subroutine solve_eigen(a, b, w)
      !> Symmetric matrix (n, n), replaced by the vectors, one per column
      real(wp), intent(inout), contiguous :: a(:, :)
      !> Symmetric positive definite matrix (n, n), overwritten
      real(wp), intent(inout), contiguous :: b(:, :)
      !> Eigenvalues (n)
      real(wp), intent(out) :: w(:)
      real(wp) :: work(40*size(w))
      integer :: info

      call dsygv(1, 'V', 'L', size(w), a, size(w), b, size(w), w, work, size(work), info)
      if (info /= 0) error stop 'dense: LAPACK dsygv did not converge'
   end subroutine solve_eigen

end module dense
