!> Linear algebra, dense and banded: the only place that calls LAPACK.
!>
!> No analysis calls it for a dense system at each event or step: that is for `rbs_base_small_systems`.
!> Symmetric matrices are passed whole; only the lower triangle is read. `info` of LAPACK becomes a
!> logical where the caller can write a better message, and an error otherwise.
module rbs_base_linalg
   use, intrinsic :: ieee_exceptions, only: ieee_all, ieee_get_status, ieee_set_halting_mode, &
                                            ieee_set_status, ieee_status_type
   use rbs_base_kinds, only: wp
   use rbs_base_error, only: error_type, fatal_error, analysis_failed
   use rbs_base_text, only: to_text
   implicit none
   private

   public :: solve_eigen
   public :: solve_tridiagonal, solve_general_band
   public :: singular_values, solve_upper, is_dominated

   interface
      subroutine dptsv(n, nrhs, d, e, b, ldb, info)
         import :: wp
         implicit none
         integer, intent(in) :: n, nrhs, ldb
         real(wp), intent(inout) :: d(*), e(*), b(ldb, *)
         integer, intent(out) :: info
      end subroutine dptsv

      subroutine dgbsv(n, kl, ku, nrhs, ab, ldab, ipiv, b, ldb, info)
         import :: wp
         implicit none
         integer, intent(in) :: n, kl, ku, nrhs, ldab, ldb
         real(wp), intent(inout) :: ab(ldab, *), b(ldb, *)
         integer, intent(out) :: ipiv(*), info
      end subroutine dgbsv

      subroutine dsygv(itype, jobz, uplo, n, a, lda, b, ldb, w, work, lwork, info)
         import :: wp
         implicit none
         integer, intent(in) :: itype, n, lda, ldb, lwork
         character(len=1), intent(in) :: jobz, uplo
         real(wp), intent(inout) :: a(lda, *), b(ldb, *)
         real(wp), intent(out) :: w(*), work(*)
         integer, intent(out) :: info
      end subroutine dsygv

      subroutine dgejsv(joba, jobu, jobv, jobr, jobt, jobp, m, n, a, lda, sva, u, ldu, v, ldv, work, lwork, &
                        iwork, info)
         import :: wp
         implicit none
         character(len=1), intent(in) :: joba, jobu, jobv, jobr, jobt, jobp
         integer, intent(in) :: m, n, lda, ldu, ldv, lwork
         real(wp), intent(inout) :: a(lda, *)
         real(wp), intent(out) :: sva(*), u(ldu, *), v(ldv, *)
         real(wp), intent(inout) :: work(*)
         integer, intent(out) :: iwork(*), info
      end subroutine dgejsv

      subroutine dtrtrs(uplo, trans, diag, n, nrhs, a, lda, b, ldb, info)
         import :: wp
         implicit none
         character(len=1), intent(in) :: uplo, trans, diag
         integer, intent(in) :: n, nrhs, lda, ldb
         real(wp), intent(in) :: a(lda, *)
         real(wp), intent(inout) :: b(ldb, *)
         integer, intent(out) :: info
      end subroutine dtrtrs
   end interface

contains

   !> Solve a symmetric positive definite tridiagonal system.
   subroutine solve_tridiagonal(diagonal, beside, b, positive)
      !> Diagonal (n) and off-diagonal (n - 1), overwritten
      real(wp), intent(inout), contiguous :: diagonal(:), beside(:)
      !> Right-hand side (n), replaced by the solution
      real(wp), intent(inout), contiguous :: b(:)
      !> Whether the matrix is positive definite
      logical, intent(out) :: positive
      integer :: info

      call dptsv(size(b), 1, diagonal, beside, b, size(b), info)
      positive = info == 0
   end subroutine solve_tridiagonal

   !> Solve a general band system by elimination with pivots.
   subroutine solve_general_band(band, below, above, b, regular, work)
      !> Band (2 below + above + 1, n): band(below + above + 1 + i - j, j) = a(i, j); overwritten
      real(wp), intent(inout), contiguous :: band(:, :)
      !> Number of diagonals below and above the main one
      integer, intent(in) :: below, above
      !> Right-hand sides (n, m), replaced by the solutions
      real(wp), intent(inout), contiguous :: b(:, :)
      !> Whether the matrix has an inverse
      logical, intent(out) :: regular
      !> Work array (n) of a caller that solves again and again
      integer, intent(inout), contiguous, optional :: work(:)
      integer, allocatable :: pivot(:)
      integer :: info

      if (present(work)) then
         call dgbsv(size(b, 1), below, above, size(b, 2), band, size(band, 1), work, b, size(b, 1), info)
      else
         allocate (pivot(size(b, 1)))
         call dgbsv(size(b, 1), below, above, size(b, 2), band, size(band, 1), pivot, b, size(b, 1), info)
      end if
      regular = info == 0
   end subroutine solve_general_band

   !> Eigenvalues of `a x = w b x`, ascending, with vectors that satisfy x' b x = 1.
   subroutine solve_eigen(a, b, w, error)
      !> Symmetric matrix (n, n), replaced by the vectors, one per column
      real(wp), intent(inout) :: a(:, :)
      !> Symmetric positive definite matrix (n, n), overwritten
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

   !> Singular values, descending, and left vectors of a square matrix, by one-sided Jacobi rotations. For
   !> D1 C D2 with diagonal D1 and D2, all values have the relative accuracy that the condition of C allows,
   !> however far apart they are (Drmac and Veselic, SIAM J. Matrix Anal. Appl. 29, 2008).
   subroutine singular_values(a, values, left, error)
      !> Matrix (n, n), overwritten
      real(wp), intent(inout), contiguous :: a(:, :)
      !> Singular values (n)
      real(wp), intent(out), contiguous :: values(:)
      !> Left vectors, one per column (n, n)
      real(wp), intent(out), contiguous :: left(:, :)
      type(error_type), allocatable, intent(out) :: error
      type(ieee_status_type) :: status
      real(wp), allocatable :: work(:)
      real(wp) :: right(1, 1)
      integer, allocatable :: iwork(:)
      integer :: info, n

      n = size(values)
      allocate (work(max(7, 6*n + 2*n**2)), source=0.0_wp)
      allocate (iwork(max(3, 4*n)))
      ! LAPACK divides the largest number by small ones here and intends the infinity that results
      ! (Reference-LAPACK issue 1282).
      call ieee_get_status(status)
      call ieee_set_halting_mode(ieee_all, .false.)
      call dgejsv('G', 'U', 'N', 'N', 'N', 'N', n, n, a, n, values, left, n, right, 1, work, size(work), &
                  iwork, info)
      call ieee_set_status(status)
      if (info /= 0) then
         call fatal_error(error, analysis_failed, 'singular values: LAPACK dgejsv did not '// &
                          'converge (info = '//to_text(info)//'); check masses and stiffnesses for '// &
                          'extreme ratios')
         return
      end if
      ! LAPACK scales values that would leave the range of the arithmetic.
      values = values*(work(1)/work(2))
   end subroutine singular_values

   !> Solve with the transposed factor of `factor_positive`, which is an upper triangle.
   subroutine solve_upper(factor, b)
      !> Factor (n, n)
      real(wp), intent(in), contiguous :: factor(:, :)
      !> Right-hand sides (n, m), replaced by the solutions
      real(wp), intent(inout), contiguous :: b(:, :)
      integer :: info

      call dtrtrs('L', 'T', 'N', size(b, 1), size(b, 2), factor, size(factor, 1), b, size(b, 1), info)
   end subroutine solve_upper

   !> Whether shift*diag(d) - a is positive definite, for a symmetric band matrix `a` of half-width 3, by a
   !> factorisation without square roots that keeps three columns at a time and stores nothing else.
   pure logical function is_dominated(band, d, shift)
      !> Lower band (4, n): band(1 + i - j, j) = a(i, j)
      real(wp), intent(in), contiguous :: band(:, :)
      !> Diagonal (n)
      real(wp), intent(in), contiguous :: d(:)
      real(wp), intent(in) :: shift
      real(wp) :: pivot, l1, l2, l3, below1, below2, below3
      ! The next three columns after elimination of those before: (1 1), (2 1), (3 1), (2 2), (3 2), (3 3)
      real(wp) :: r11, r21, r31, r22, r32, r33
      integer :: j

      is_dominated = .false.
      r11 = 0.0_wp
      r21 = 0.0_wp
      r31 = 0.0_wp
      r22 = 0.0_wp
      r32 = 0.0_wp
      r33 = 0.0_wp
      do j = 1, size(d)
         pivot = (shift*d(j) - band(1, j)) - r11
         if (.not. pivot > 0.0_wp) return
         below1 = -band(2, j) - r21
         below2 = -band(3, j) - r31
         below3 = -band(4, j)
         l1 = below1/pivot
         l2 = below2/pivot
         l3 = below3/pivot
         r11 = r22 + l1*below1
         r21 = r32 + l1*below2
         r31 = l1*below3
         r22 = r33 + l2*below2
         r32 = l2*below3
         r33 = l3*below3
      end do
      is_dominated = .true.
   end function is_dominated

end module rbs_base_linalg
