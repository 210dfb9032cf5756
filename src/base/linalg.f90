!> Dense linear algebra: the only place that calls LAPACK.
!>
!> Symmetric matrices are passed whole; the lower triangle is the one that is read. `info` of LAPACK
!> becomes a logical where the caller has something better to say, an error otherwise.
module rbs_base_linalg
   use rbs_base_kinds, only: wp
   use rbs_base_error, only: error_type, fatal_error, analysis_failed
   use rbs_base_text, only: to_text
   implicit none
   private

   public :: factor_positive, solve_positive, invert_positive, solve_general, solve_eigen

   interface
      subroutine dpotrf(uplo, n, a, lda, info)
         import :: wp
         implicit none
         character(len=1), intent(in) :: uplo
         integer, intent(in) :: n, lda
         real(wp), intent(inout) :: a(lda, *)
         integer, intent(out) :: info
      end subroutine dpotrf

      subroutine dpotrs(uplo, n, nrhs, a, lda, b, ldb, info)
         import :: wp
         implicit none
         character(len=1), intent(in) :: uplo
         integer, intent(in) :: n, nrhs, lda, ldb
         real(wp), intent(in) :: a(lda, *)
         real(wp), intent(inout) :: b(ldb, *)
         integer, intent(out) :: info
      end subroutine dpotrs

      subroutine dpotri(uplo, n, a, lda, info)
         import :: wp
         implicit none
         character(len=1), intent(in) :: uplo
         integer, intent(in) :: n, lda
         real(wp), intent(inout) :: a(lda, *)
         integer, intent(out) :: info
      end subroutine dpotri

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

   !> Cholesky factor of a symmetric matrix, in place; `positive` tells whether there is one.
   subroutine factor_positive(a, positive)
      !> Matrix (n, n); on return its factor in the lower triangle
      real(wp), intent(inout) :: a(:, :)
      !> Whether the matrix is positive definite
      logical, intent(out) :: positive
      integer :: info

      call dpotrf('L', size(a, 1), a, size(a, 1), info)
      positive = info == 0
   end subroutine factor_positive

   !> Solve with the factor of `factor_positive`.
   subroutine solve_positive(factor, b)
      !> Factor (n, n)
      real(wp), intent(in) :: factor(:, :)
      !> Right-hand side (n), replaced by the solution
      real(wp), intent(inout) :: b(:)
      integer :: info

      call dpotrs('L', size(b), 1, factor, size(factor, 1), b, size(b), info)
   end subroutine solve_positive

   !> Inverse of a symmetric positive definite matrix, in place and whole.
   subroutine invert_positive(a, positive)
      !> Matrix (n, n), replaced by its inverse
      real(wp), intent(inout) :: a(:, :)
      !> Whether the matrix is positive definite; if not, `a` is spoilt
      logical, intent(out) :: positive
      integer :: i, info

      call factor_positive(a, positive)
      if (.not. positive) return
      call dpotri('L', size(a, 1), a, size(a, 1), info)
      positive = info == 0
      do i = 2, size(a, 1)
         a(:i - 1, i) = a(i, :i - 1)
      end do
   end subroutine invert_positive

   !> Solve a general system by elimination with pivots.
   subroutine solve_general(a, b, regular)
      !> Matrix (n, n), spoilt on return
      real(wp), intent(inout) :: a(:, :)
      !> Right-hand sides (n, m), replaced by the solutions
      real(wp), intent(inout) :: b(:, :)
      !> Whether the matrix has an inverse
      logical, intent(out) :: regular
      integer :: pivot(size(a, 1))
      integer :: info

      call dgesv(size(a, 1), size(b, 2), a, size(a, 1), pivot, b, size(b, 1), info)
      regular = info == 0
   end subroutine solve_general

   !> Eigenvalues of `a x = w b x`, ascending, with vectors that satisfy x' b x = 1.
   subroutine solve_eigen(a, b, w, error)
      !> Symmetric matrix (n, n), replaced by the vectors, one a column
      real(wp), intent(inout) :: a(:, :)
      !> Symmetric positive definite matrix (n, n), spoilt on return
      real(wp), intent(inout) :: b(:, :)
      !> Eigenvalues (n)
      real(wp), intent(out) :: w(:)
      type(error_type), allocatable, intent(out) :: error
      real(wp), allocatable :: work(:)
      real(wp) :: query(1)
      integer :: n, info

      n = size(w)
      call dsygv(1, 'V', 'L', n, a, n, b, n, w, query, -1, info)
      allocate (work(int(query(1))))
      call dsygv(1, 'V', 'L', n, a, n, b, n, w, work, size(work), info)
      if (info > n) then
         call fatal_error(error, analysis_failed, 'eigenproblem: the mass matrix is not positive '// &
                          'definite (leading minor '//to_text(info - n)//'); check the masses')
      else if (info /= 0) then
         call fatal_error(error, analysis_failed, 'eigenproblem: LAPACK dsygv did not converge '// &
                          '(info = '//to_text(info)//'); check masses and stiffnesses for extreme ratios')
      end if
   end subroutine solve_eigen

end module rbs_base_linalg
