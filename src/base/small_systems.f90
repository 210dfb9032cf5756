!> Dense systems that are solved at every event or step, in loops of our own. They are small: a call of
!> LAPACK costs more than their arithmetic, and one with threads wakes them for nothing, which on a busy
!> machine takes a thousand times as long.
module rbs_base_small_systems
   use rbs_base_kinds, only: wp
   implicit none
   private

   public :: solve_rows, row_length

   !> Length of an equation in `solve_rows`: up to five unknowns and three right-hand sides.
   integer, parameter :: row_length = 8

contains

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
