!> A symmetric band matrix with a border: the tangent of a column, and what drives it.
!>
!>     A x - a y = f,   c x = g
!>
!> A need not be positive definite, and may have no inverse where the force has its peak, while the whole
!> has one. There a plain block elimination fails; the mixed one used here does not (W. Govaerts, Stable
!> solvers and block elimination for bordered systems, SIAM J. Matrix Anal. Appl. 12 (1991) 469-483).
module rbs_solve_static_bordered
   use rbs_base_constants, only: no_stiffness
   use rbs_base_kinds, only: wp
   use rbs_base_linalg, only: solve_general_band
   use rbs_base_narrow_band, only: factor_narrow_band, solve_narrow_band
   implicit none
   private

   public :: bordered_band

   !> Added in proportion to the initial stiffness where elimination meets a zero: no more than round-off.
   real(wp), parameter :: round_off = 8.0_wp*epsilon(1.0_wp)

   !> If one step of refinement changes the solution by more than this share, the system counts as singular.
   real(wp), parameter :: no_answer = 1.0e-3_wp

   type :: bordered_band
      !> Number of unknowns, and of diagonals below the main one, 3 at the most
      integer :: size = 0, width = 0
      !> The matrix, to be filled before `factor` (4, size): band(1 + i - j, j) = a(i, j), zero elsewhere
      real(wp), allocatable :: band(:, :)
      !> Initial stiffness of the unknowns (size), to be given once: everything is scaled by it
      real(wp), allocatable :: stiffness(:)
      !> Whether the matrix is positive definite, after `factor`
      logical :: positive = .false.
      !> One over root of the stiffness and three zeros (size + 3), factor (4, size), and the matrix as
      !> elimination takes it
      real(wp), allocatable, private :: scale(:), triangle(:, :), general(:, :)
      !> Columns a and c of the border, and A^-1 times them (size, 2), scaled
      real(wp), allocatable, private :: border(:, :), flexible(:, :)
      !> Products of the two: once from the left, once from the right
      real(wp), private :: from_left = 0.0_wp, from_right = 0.0_wp
      !> Work arrays (size, number of right-hand sides)
      real(wp), allocatable, private :: right(:, :), more(:, :)
   contains
      procedure :: create
      procedure :: factor
      procedure :: solve
      procedure :: set_border
      procedure :: solve_bordered
   end type bordered_band

contains

   subroutine create(self, width, stiffness)
      class(bordered_band), intent(out) :: self
      integer, intent(in) :: width
      !> Initial stiffness of the unknowns, all positive
      real(wp), intent(in) :: stiffness(:)

      self%size = size(stiffness)
      self%width = width
      self%stiffness = stiffness
      self%scale = [1.0_wp/sqrt(stiffness), 0.0_wp, 0.0_wp, 0.0_wp]
      allocate (self%band(4, self%size), self%triangle(4, self%size), self%border(self%size, 2), &
                self%flexible(self%size, 2), source=0.0_wp)
   end subroutine create

   !> Scale the matrix and factor it, if it is positive definite.
   subroutine factor(self)
      class(bordered_band), intent(inout) :: self

      call scale_and_factor(self%size, self%scale, self%band, self%triangle, self%positive)
   end subroutine factor

   pure subroutine scale_and_factor(n, scale, band, triangle, positive)
      integer, intent(in) :: n
      real(wp), intent(in) :: scale(n + 3)
      real(wp), intent(inout) :: band(4, n)
      real(wp), intent(out) :: triangle(4, n)
      logical, intent(out) :: positive
      integer :: j

      do j = 1, n
         band(:, j) = band(:, j)*(scale(j)*scale(j:j + 3))
         triangle(:, j) = band(:, j)
      end do
      call factor_narrow_band(n, triangle, positive)
      ! The factor holds one over the pivots.
      if (positive) positive = maxval(triangle(1, :)) < 1.0_wp/no_stiffness
   end subroutine scale_and_factor

   !> Without border: A x = b.
   subroutine solve(self, b, regular)
      class(bordered_band), intent(inout) :: self
      !> Right-hand sides (size, m), replaced by the solutions
      real(wp), intent(inout), contiguous :: b(:, :)
      logical, intent(out) :: regular

      call scale_rows(self, b)
      call solve_scaled(self, b, regular)
      call scale_rows(self, b)
   end subroutine solve

   !> Give the border of the matrix that has been factored.
   subroutine set_border(self, column, row, regular)
      class(bordered_band), intent(inout) :: self
      !> a and c (size); without c it is a
      real(wp), intent(in), contiguous :: column(:)
      real(wp), intent(in), contiguous, optional :: row(:)
      !> Whether the system can have a unique solution
      logical, intent(out) :: regular
      integer :: m

      m = 1
      self%border(:, 1) = column*self%scale(:self%size)
      if (present(row)) then
         m = 2
         self%border(:, 2) = row*self%scale(:self%size)
      end if
      self%flexible(:, :m) = self%border(:, :m)
      call solve_scaled(self, self%flexible(:, :m), regular)
      if (.not. present(row)) then
         self%border(:, 2) = self%border(:, 1)
         self%flexible(:, 2) = self%flexible(:, 1)
      end if
      self%from_left = dot_product(self%flexible(:, 2), self%border(:, 1))
      self%from_right = dot_product(self%border(:, 2), self%flexible(:, 1))
      regular = regular .and. abs(self%from_left) > 0.0_wp .and. abs(self%from_right) > 0.0_wp
   end subroutine set_border

   !> With border.
   subroutine solve_bordered(self, f, g, x, y, regular)
      class(bordered_band), intent(inout) :: self
      !> Right-hand sides (size, m), (m)
      real(wp), intent(in), contiguous :: f(:, :)
      real(wp), intent(in) :: g(:)
      !> Solutions (size, m), (m)
      real(wp), intent(out), contiguous :: x(:, :)
      real(wp), intent(out) :: y(:)
      !> Whether the system has a unique solution
      logical, intent(out) :: regular
      real(wp) :: change(size(g)), missing(size(g))
      integer :: j

      if (.not. allocated(self%right)) allocate (self%right, self%more, mold=f)
      self%right = f
      call scale_rows(self, self%right)
      call eliminate(self, self%right, g, x, y, regular)
      if (.not. regular) return
      if (.not. self%positive) then
         ! One step of refinement. Its size also shows whether the system has a solution.
         do j = 1, size(g)
            self%right(:, j) = self%right(:, j) - times(self, x(:, j)) + self%border(:, 1)*y(j)
            missing(j) = g(j) - dot_product(self%border(:, 2), x(:, j))
         end do
         call eliminate(self, self%right, missing, self%more, change, regular)
         do j = 1, size(g)
            regular = regular .and. maxval(abs(self%more(:, j))) <= no_answer*maxval(abs(x(:, j)))
         end do
         if (.not. regular) return
         x = x + self%more
         y = y + change
      end if
      call scale_rows(self, x)
   end subroutine solve_bordered

   !> Mixed block elimination: once from the left, which gives most of y, and once from the right for
   !> what is missing.
   subroutine eliminate(self, f, g, x, y, regular)
      type(bordered_band), intent(inout) :: self
      real(wp), intent(in) :: f(:, :), g(:)
      real(wp), intent(out), contiguous :: x(:, :)
      real(wp), intent(out) :: y(:)
      logical, intent(out) :: regular
      real(wp) :: more
      integer :: j

      do j = 1, size(g)
         y(j) = (g(j) - dot_product(self%flexible(:, 2), f(:, j)))/self%from_left
         x(:, j) = f(:, j) + self%border(:, 1)*y(j)
      end do
      call solve_scaled(self, x, regular)
      if (.not. regular) return
      do j = 1, size(g)
         more = (g(j) - dot_product(self%border(:, 2), x(:, j)))/self%from_right
         x(:, j) = x(:, j) + self%flexible(:, 1)*more
         y(j) = y(j) + more
      end do
   end subroutine eliminate

   !> Solve with the scaled matrix.
   subroutine solve_scaled(self, b, regular)
      type(bordered_band), intent(inout) :: self
      real(wp), intent(inout), contiguous :: b(:, :)
      logical, intent(out) :: regular
      real(wp), allocatable :: right(:, :)
      integer :: j

      regular = .true.
      if (self%positive) then
         do j = 1, size(b, 2)
            call solve_narrow_band(self%size, self%triangle, b(:, j))
         end do
         return
      end if
      right = b
      call spread_band(self, 0.0_wp)
      call solve_general_band(self%general, self%width, self%width, b, regular)
      if (regular) return
      b = right
      call spread_band(self, round_off)
      call solve_general_band(self%general, self%width, self%width, b, regular)
   end subroutine solve_scaled

   !> The band as elimination takes it, both triangles.
   subroutine spread_band(self, extra)
      type(bordered_band), intent(inout) :: self
      !> Added to the diagonal
      real(wp), intent(in) :: extra
      integer :: i, j, main

      main = 2*self%width + 1
      if (.not. allocated(self%general)) allocate (self%general(main + self%width, self%size))
      do j = 1, self%size
         self%general(:, j) = 0.0_wp
         self%general(main, j) = self%band(1, j) + extra
         do i = max(1, j - self%width), j - 1
            self%general(main + i - j, j) = self%band(1 + j - i, i)
         end do
         do i = j + 1, min(j + self%width, self%size)
            self%general(main + i - j, j) = self%band(1 + i - j, j)
         end do
      end do
   end subroutine spread_band

   !> The scaled matrix times a column.
   pure function times(self, x) result(product)
      type(bordered_band), intent(in) :: self
      real(wp), intent(in) :: x(:)
      real(wp) :: product(self%size)
      integer :: i, j

      product = self%band(1, :)*x
      do j = 1, self%size
         do i = j + 1, min(j + self%width, self%size)
            product(i) = product(i) + self%band(1 + i - j, j)*x(j)
            product(j) = product(j) + self%band(1 + i - j, j)*x(i)
         end do
      end do
   end function times

   pure subroutine scale_rows(self, b)
      type(bordered_band), intent(in) :: self
      real(wp), intent(inout) :: b(:, :)
      integer :: j

      do j = 1, size(b, 2)
         b(:, j) = b(:, j)*self%scale(:self%size)
      end do
   end subroutine scale_rows

end module rbs_solve_static_bordered
