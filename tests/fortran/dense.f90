!> Dense systems, and the dense eigenproblem by LAPACK, that tests compare with.
module dense
   use rbs_base_kinds, only: wp
   implicit none
   private

   public :: factor_positive, solve_positive, solve_general, solve_eigen

   interface
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

   !> Cholesky factor of a symmetric matrix, in place; it exists if the matrix is positive definite.
   pure subroutine factor_positive(a, positive)
      !> Matrix (n, n), of which only the lower triangle is read; on return its factor there
      real(wp), intent(inout) :: a(:, :)
      !> Whether the matrix is positive definite
      logical, intent(out) :: positive
      integer :: i, j, k

      positive = .false.
      do k = 1, size(a, 1)
         if (.not. a(k, k) > 0.0_wp) return
         a(k, k) = sqrt(a(k, k))
         do i = k + 1, size(a, 1)
            a(i, k) = a(i, k)/a(k, k)
         end do
         do j = k + 1, size(a, 1)
            do i = j, size(a, 1)
               a(i, j) = a(i, j) - a(i, k)*a(j, k)
            end do
         end do
      end do
      positive = .true.
   end subroutine factor_positive

   !> Solve with the factor of `factor_positive`.
   pure subroutine solve_positive(factor, b)
      !> Factor (n, n)
      real(wp), intent(in) :: factor(:, :)
      !> Right-hand side (n), replaced by the solution
      real(wp), intent(inout) :: b(:)
      integer :: i, k

      do k = 1, size(b)
         b(k) = b(k)/factor(k, k)
         do i = k + 1, size(b)
            b(i) = b(i) - factor(i, k)*b(k)
         end do
      end do
      do k = size(b), 1, -1
         do i = k + 1, size(b)
            b(k) = b(k) - factor(i, k)*b(i)
         end do
         b(k) = b(k)/factor(k, k)
      end do
   end subroutine solve_positive

   !> Solve a general system by elimination with partial pivoting.
   pure subroutine solve_general(a, b, regular)
      !> Matrix (n, n), overwritten
      real(wp), intent(inout) :: a(:, :)
      !> Right-hand sides (n, m), replaced by the solutions
      real(wp), intent(inout) :: b(:, :)
      !> Whether the matrix has an inverse
      logical, intent(out) :: regular

      call eliminate(size(a, 1), size(b, 2), a, b, regular)
   end subroutine solve_general

   !> The same with arrays of known shape: column by column, as they stand in memory.
   pure subroutine eliminate(n, m, a, b, regular)
      integer, intent(in) :: n, m
      real(wp), intent(inout) :: a(n, n), b(n, m)
      logical, intent(out) :: regular
      real(wp) :: swap
      integer :: i, j, k, p

      regular = .false.
      do k = 1, n
         p = k
         do i = k + 1, n
            if (abs(a(i, k)) > abs(a(p, k))) p = i
         end do
         if (.not. abs(a(p, k)) > 0.0_wp) return
         if (p /= k) then
            do j = k, n
               swap = a(k, j)
               a(k, j) = a(p, j)
               a(p, j) = swap
            end do
            do j = 1, m
               swap = b(k, j)
               b(k, j) = b(p, j)
               b(p, j) = swap
            end do
         end if
         do i = k + 1, n
            a(i, k) = a(i, k)/a(k, k)
         end do
         do j = k + 1, n
            do i = k + 1, n
               a(i, j) = a(i, j) - a(i, k)*a(k, j)
            end do
         end do
         do j = 1, m
            do i = k + 1, n
               b(i, j) = b(i, j) - a(i, k)*b(k, j)
            end do
         end do
      end do
      do j = 1, m
         do i = n, 1, -1
            do k = i + 1, n
               b(i, j) = b(i, j) - a(i, k)*b(k, j)
            end do
            b(i, j) = b(i, j)/a(i, i)
         end do
      end do
      regular = .true.
   end subroutine eliminate

   !> Eigenvalues of `a x = w b x`, ascending, with vectors that satisfy x' b x = 1.
   subroutine solve_eigen(a, b, w)
      !> Symmetric matrix (n, n), replaced by the vectors, one per column
      real(wp), intent(inout) :: a(:, :)
      !> Symmetric positive definite matrix (n, n), overwritten
      real(wp), intent(inout) :: b(:, :)
      !> Eigenvalues (n)
      real(wp), intent(out) :: w(:)
      real(wp) :: work(40*size(w))
      integer :: info

      call dsygv(1, 'V', 'L', size(w), a, size(w), b, size(w), w, work, size(work), info)
      if (info /= 0) error stop 'dense: LAPACK dsygv did not converge'
   end subroutine solve_eigen

end module dense
