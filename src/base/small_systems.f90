!> Dense systems that are solved at every event or step, in loops of our own. They are small: a call of
!> LAPACK costs more than their arithmetic, and one with threads wakes them for nothing, which on a busy
!> machine takes a thousand times as long.
module rbs_base_small_systems
   use rbs_base_kinds, only: wp
   implicit none
   private

   public :: factor_positive, solve_positive, solve_general, solve_rows, row_length

   !> Length of an equation in `solve_rows`: up to five unknowns and three right-hand sides.
   integer, parameter :: row_length = 8

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

   !> Solve a very small system for three right-hand sides by elimination with partial pivoting. All equations
   !> have the same length, known when this is compiled: they are added without loops.
   pure subroutine solve_rows(n, row, regular)
      !> Number of unknowns, at the most `row_length` - 3
      integer, intent(in) :: n
      !> Each column an equation: its coefficients, and in the last three places the right-hand sides, which
      !> the solutions replace
      real(wp), intent(inout) :: row(row_length, n)
      !> Whether the matrix has an inverse
      logical, intent(out) :: regular
      integer, parameter :: right = row_length - 2
      real(wp) :: factor, pivot(row_length)
      integer :: i, k, p

      regular = .false.
      do k = 1, n
         p = k
         do i = k + 1, n
            if (abs(row(k, i)) > abs(row(k, p))) p = i
         end do
         if (.not. abs(row(k, p)) > 0.0_wp) return
         pivot = row(:, p)
         if (p /= k) then
            row(:, p) = row(:, k)
            row(:, k) = pivot
         end if
         do i = k + 1, n
            if (.not. abs(row(k, i)) > 0.0_wp) cycle
            factor = row(k, i)/pivot(k)
            row(:, i) = row(:, i) - factor*pivot
         end do
      end do
      do i = n, 1, -1
         do k = n, i + 1, -1
            row(right:, i) = row(right:, i) - row(k, i)*row(right:, k)
         end do
         row(right:, i) = row(right:, i)/row(i, i)
      end do
      regular = .true.
   end subroutine solve_rows

end module rbs_base_small_systems
