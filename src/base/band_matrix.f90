!> Symmetric band matrices: the factor L D L' without pivots, in time and memory proportional to the number of
!> unknowns, the number of negative pivots (by Sylvester that of negative eigenvalues), and systems with a
!> border: the tangent of a structure, and its driven load or displacement.
!>
!>     A x - a y = f,   c x = g
!>
!> A need not be positive definite, and may have no inverse where the force has its peak, while the whole
!> has one. There a plain block elimination fails; the mixed one used here does not (W. Govaerts, Stable
!> solvers and block elimination for bordered systems, SIAM J. Matrix Anal. Appl. 12 (1991) 469-483).
!>
!> A matrix with small pivots, or with negative ones where nothing is scaled, is solved by LAPACK's
!> elimination with pivots. The others are factored here: for a half-width up to 3 the columns that an
!> elimination changes stay in registers. LAPACK's band routines take several times as long, because they call
!> other routines for vectors of three numbers. Of a wide matrix rows are factored from their first element
!> on, and those before the first one that has changed keep their factor.
module rbs_base_band_matrix
   use rbs_base_inner_product, only: inner_product
   use rbs_base_kinds, only: wp
   use rbs_base_linalg, only: solve_general_band
   use rbs_base_tolerances, only: no_stiffness, round_off
   implicit none
   private

   public :: band_matrix

   !> If one step of refinement changes the solution by more than this share, the system counts as singular.
   real(wp), parameter :: no_answer = 1.0e-3_wp

   !> Half-width of the elimination in registers.
   integer, parameter :: narrow = 3

   !> Pivots of the scaled matrix above this, in size, serve as well as exchanged ones: they lose no more than
   !> four digits, which a step of refinement recovers.
   real(wp), parameter :: least_pivot = 1.0e-4_wp

   type :: band_matrix
      !> Number of unknowns, and of diagonals below the main one
      integer :: size = 0, width = 0
      !> The matrix, to be filled before `factor` (4 or width + 1, size): band(1 + i - j, j) = a(i, j) for
      !> i >= j, zero elsewhere. A matrix with a scale is scaled by `factor`
      real(wp), allocatable :: band(:, :)
      !> Initial stiffness of the unknowns (size), where all is scaled by it
      real(wp), allocatable :: stiffness(:)
      !> After `factor`: whether the matrix is positive definite, and its number of negative pivots
      logical :: positive = .false.
      integer :: negative = 0
      !> Its factor: 1/D and L, of a wide matrix by rows: triangle(2 + width - i + j, i) = l(i, j)
      real(wp), allocatable :: triangle(:, :)
      !> Whether this serves for solutions
      logical, private :: serves = .false.
      !> The band of a wide factor, as it was factored last, and 1/D; where its rows begin (size)
      real(wp), allocatable, private :: factored(:, :), inverse(:)
      integer, allocatable, private :: first(:)
      !> Powers of two next to one over root of the stiffness, so that no digit depends on units, and zeros
      !> (size + half-width); the stiffness scaled by them (size); the matrix as elimination with pivots
      !> takes it
      real(wp), allocatable, private :: scale(:), scaled_stiffness(:), general(:, :)
      integer, allocatable, private :: pivot(:)
      !> Whether that has been done since `factor`
      logical, private :: has_pivots = .false.
      !> Columns a and c of the border, and A^-1 times them (size, 2), scaled
      real(wp), allocatable, private :: border(:, :), flexible(:, :)
      !> Products of the two: once from the left, once from the right
      real(wp), private :: from_left = 0.0_wp, from_right = 0.0_wp
      !> Work arrays (size)
      real(wp), allocatable, private :: right(:), more(:)
   contains
      procedure :: create
      procedure :: hold
      procedure :: factor
      generic :: solve => solve_one, solve_many
      procedure, private :: solve_one, solve_many
      procedure :: substitute
      procedure :: set_border
      procedure :: solve_bordered
   end type band_matrix

contains

   !> Make room for a matrix.
   subroutine create(self, unknowns, width, stiffness)
      class(band_matrix), intent(out) :: self
      !> Number of unknowns, and of diagonals below the main one
      integer, intent(in) :: unknowns, width
      !> Initial stiffness of the unknowns, all positive; without it nothing is scaled
      real(wp), intent(in), optional :: stiffness(:)
      integer :: i, rows

      self%size = unknowns
      self%width = width
      rows = max(width, narrow) + 1
      allocate (self%band(rows, unknowns), self%triangle(rows, unknowns), source=0.0_wp)
      if (width > narrow) then
         allocate (self%factored(rows, unknowns), self%inverse(unknowns), source=huge(1.0_wp))
         self%first = [(i, i=1, unknowns)]
      end if
      if (.not. present(stiffness)) return
      self%stiffness = stiffness
      ! 2**(-floor(e/2)) with the binary exponent e; the zeros stand for rows beyond the end.
      self%scale = [scale(1.0_wp, -shifta(exponent(stiffness), 1)), (0.0_wp, i=2, rows)]
      self%scaled_stiffness = stiffness*self%scale(:unknowns)**2
   end subroutine create

   !> Hold an unknown that a support keeps still: its row and column become zero but for the diagonal.
   pure subroutine hold(self, unknown, diagonal)
      class(band_matrix), intent(inout) :: self
      integer, intent(in) :: unknown
      !> Diagonal element of the unknown
      real(wp), intent(in) :: diagonal
      integer :: i

      do i = 1, min(self%width, unknown - 1)
         self%band(1 + i, unknown - i) = 0.0_wp
      end do
      self%band(2:, unknown) = 0.0_wp
      self%band(1, unknown) = diagonal
   end subroutine hold

   !> Scale the matrix, if it has a scale, and factor it: sets the factor, `negative`, `positive`, and whether
   !> the factor serves for solutions.
   subroutine factor(self, columns)
      class(band_matrix), intent(inout) :: self
      !> The columns that have been filled since the last call (size); without it, all: the others are scaled
      logical, intent(in), optional, contiguous :: columns(:)
      integer :: first

      first = 1
      if (present(columns)) then
         do first = 1, self%size - 1
            if (columns(first)) exit
         end do
      end if
      if (allocated(self%scale)) call scale_band(self%size, size(self%band, 1), self%scale, self%band, &
                                                 columns)
      if (self%width <= narrow) then
         call factor_narrow(self%size, self%band, self%triangle, self%negative)
      else
         call factor_wide(self%size, self%width, self%band, first, self%factored, self%first, self%triangle, &
                          self%inverse, self%negative)
      end if
      self%has_pivots = .false.
      self%positive = self%negative == 0
      self%serves = self%positive
      if (.not. allocated(self%scale)) return
      ! Stiffness over pivot, as the factor holds one over the pivots. If a pivot is too small a share of the
      ! stiffness, the matrix counts as not positive definite, or the factor does not serve.
      associate (share => self%triangle(1, :)*self%scaled_stiffness)
         self%positive = self%positive .and. maxval(share) < 1.0_wp/no_stiffness
         self%serves = maxval(abs(share)) < 1.0_wp/least_pivot
      end associate
   end subroutine factor

   !> Multiply each element a(i, j) of a lower band by scale(i) scale(j).
   pure subroutine scale_band(n, rows, scale, band, columns)
      integer, intent(in) :: n, rows
      real(wp), intent(in) :: scale(n + rows - 1)
      real(wp), intent(inout) :: band(rows, n)
      !> The columns that are scaled; without it, all
      logical, intent(in), optional :: columns(n)
      integer :: j

      do j = 1, n
         if (present(columns)) then
            if (.not. columns(j)) cycle
         end if
         band(:, j) = band(:, j)*(scale(j)*scale(j:j + rows - 1))
      end do
   end subroutine scale_band

   !> Factor L D L' for a half-width up to 3.
   pure subroutine factor_narrow(n, band, triangle, negative)
      integer, intent(in) :: n
      !> Lower band; 1/D and L
      real(wp), intent(in) :: band(4, n)
      real(wp), intent(out) :: triangle(4, n)
      !> Number of pivots that are not positive
      integer, intent(out) :: negative
      real(wp) :: pivot, share, l1, l2, l3, below1, below2, below3, r11, r21, r31, r22, r32, r33
      integer :: j

      negative = 0
      ! Sums that finished columns take off the next three: r21 off their second row and first column.
      r11 = 0.0_wp
      r21 = 0.0_wp
      r31 = 0.0_wp
      r22 = 0.0_wp
      r32 = 0.0_wp
      r33 = 0.0_wp
      do j = 1, n
         pivot = band(1, j) - r11
         if (.not. pivot > tiny(1.0_wp)) call count_negative(pivot, negative)
         share = 1.0_wp/pivot
         below1 = band(2, j) - r21
         below2 = band(3, j) - r31
         below3 = band(4, j)
         l1 = below1*share
         l2 = below2*share
         l3 = below3*share
         triangle(1, j) = share
         triangle(2, j) = l1
         triangle(3, j) = l2
         triangle(4, j) = l3
         r11 = r22 + l1*below1
         r21 = r32 + l1*below2
         r31 = l1*below3
         r22 = r33 + l2*below2
         r32 = l2*below3
         r33 = l3*below3
      end do
   end subroutine factor_narrow

   !> Factor L D L' for any half-width, row by row and within the profile: a row of L begins where that of the
   !> matrix does. Rows before the first one that has changed stay.
   pure subroutine factor_wide(n, width, band, filled, factored, first, triangle, inverse, negative)
      integer, intent(in) :: n, width
      !> Lower band: band(1 + i - j, j) = a(i, j), and the first column that has been filled
      real(wp), intent(in) :: band(width + 1, n)
      integer, intent(in) :: filled
      !> Band that was factored before, replaced by this one; the first column of each row; the factor: 1/D
      !> and L, row by row, and 1/D alone. All follow from this band: a path that is resumed has the same bits
      real(wp), intent(inout) :: factored(width + 1, n), triangle(width + 1, n), inverse(n)
      integer, intent(inout) :: first(n)
      !> Number of pivots that are not positive
      integer, intent(out) :: negative
      !> Elements of the present row of L, times their pivots
      real(wp) :: row(n), pivot
      integer :: changed, i, j, k

      do changed = filled, n
         if (.not. all(abs(band(:, changed) - factored(:, changed)) <= 0.0_wp)) exit
      end do
      factored(:, changed:) = band(:, changed:)
      negative = count(.not. inverse(:changed - 1) > 0.0_wp)
      do i = changed, n
         do k = max(1, i - width), i - 1
            if (abs(band(1 + i - k, k)) > 0.0_wp) exit
         end do
         first(i) = k
         triangle(2:1 + width - i + k, i) = 0.0_wp
         do k = first(i), i - 1
            row(k) = band(1 + i - k, k)
         end do
         ! Four columns at once, as the row is loaded less often so.
         do j = first(i), i - 4, 4
            k = max(first(i), minval(first(j:j + 3)))
            call reduce_four(j - k, row(k:j + 3), triangle(2 + width - j + k:, j), &
                             triangle(1 + width - j + k:, j + 1), triangle(width - j + k:, j + 2), &
                             triangle(width - j + k - 1:, j + 3))
         end do
         do j = j, i - 1
            k = max(first(i), first(j))
            row(j) = row(j) - inner_product(j - k, row(k:), triangle(2 + width - j + k:, j))
         end do
         pivot = band(1, i)
         do k = first(i), i - 1
            triangle(2 + width - i + k, i) = row(k)*inverse(k)
            pivot = pivot - row(k)*triangle(2 + width - i + k, i)
         end do
         if (.not. pivot > tiny(1.0_wp)) call count_negative(pivot, negative)
         inverse(i) = 1.0_wp/pivot
         triangle(1, i) = inverse(i)
      end do
   end subroutine factor_wide

   !> Subtract from four elements of a row, behind m that are done, their products with the rows of L of these
   !> four columns.
   pure subroutine reduce_four(m, row, a, b, c, d)
      integer, intent(in) :: m
      real(wp), intent(inout) :: row(m + 4)
      !> Rows of L of the four columns, from the same column on as `row`
      real(wp), intent(in) :: a(m), b(m + 1), c(m + 2), d(m + 3)
      real(wp) :: p, q, r, s
      integer :: k

      p = 0.0_wp
      q = 0.0_wp
      r = 0.0_wp
      s = 0.0_wp
      !$omp simd reduction(+:p, q, r, s)
      do k = 1, m
         p = p + row(k)*a(k)
         q = q + row(k)*b(k)
         r = r + row(k)*c(k)
         s = s + row(k)*d(k)
      end do
      row(m + 1) = row(m + 1) - p
      row(m + 2) = row(m + 2) - (q + row(m + 1)*b(m + 1))
      row(m + 3) = row(m + 3) - (r + row(m + 1)*c(m + 1) + row(m + 2)*c(m + 2))
      row(m + 4) = row(m + 4) - (s + row(m + 1)*d(m + 1) + row(m + 2)*d(m + 2) + row(m + 3)*d(m + 3))
   end subroutine reduce_four

   !> Count a pivot that is not positive. In place of zero it becomes a small negative number, which changes
   !> nothing but round-off.
   pure subroutine count_negative(pivot, negative)
      real(wp), intent(inout) :: pivot
      integer, intent(inout) :: negative

      negative = negative + 1
      if (.not. abs(pivot) > tiny(1.0_wp)) pivot = -sqrt(tiny(1.0_wp))
   end subroutine count_negative

   !> Solve with the factor of `factor_narrow`.
   pure subroutine solve_narrow(n, factor, b)
      integer, intent(in) :: n
      real(wp), intent(in) :: factor(4, n)
      !> Right-hand side, replaced by the solution
      real(wp), intent(inout) :: b(n)
      real(wp) :: r1, r2, r3, x, x1, x2, x3
      integer :: j

      ! Sums that finished rows take off the next three.
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
   end subroutine solve_narrow

   !> Solve with the factor of `factor_wide`.
   pure subroutine solve_wide(n, width, first, factor, inverse, b)
      integer, intent(in) :: n, width, first(n)
      real(wp), intent(in) :: factor(width + 1, n), inverse(n)
      !> Right-hand side, replaced by the solution
      real(wp), intent(inout) :: b(n)
      integer :: i, k

      do i = 1, n
         k = first(i)
         b(i) = b(i) - inner_product(i - k, factor(2 + width - i + k:, i), b(k:))
      end do
      b = b*inverse
      do i = n, 1, -1
         k = first(i)
         b(k:i - 1) = b(k:i - 1) - factor(2 + width - i + k:, i)*b(i)
      end do
   end subroutine solve_wide

   !> Solve A x = b, without border, with one right-hand side.
   subroutine solve_one(self, b, regular)
      class(band_matrix), intent(inout) :: self
      !> Right-hand side (size), replaced by the solution
      real(wp), intent(inout), contiguous :: b(:)
      !> Whether the matrix has an inverse
      logical, intent(out) :: regular

      if (self%positive .and. self%width <= narrow .and. .not. allocated(self%scale)) then
         ! The tangent of most implicit steps
         call solve_narrow(self%size, self%triangle, b)
         regular = .true.
         return
      end if
      ! With the scaled matrix S A S:  x = S (S A S)^-1 S b.
      call scale_rows(self, 1, b)
      call solve_scaled(self, 1, b, regular)
      call scale_rows(self, 1, b)
   end subroutine solve_one

   !> Solve with the factor as it is, also where the matrix is not positive definite: inverse iteration needs
   !> no more. A matrix with a scale is not for this.
   pure subroutine substitute(self, b)
      class(band_matrix), intent(in) :: self
      !> Right-hand side (size), replaced by the solution
      real(wp), intent(inout), contiguous :: b(:)

      if (self%width <= narrow) then
         call solve_narrow(self%size, self%triangle, b)
      else
         call solve_wide(self%size, self%width, self%first, self%triangle, self%inverse, b)
      end if
   end subroutine substitute

   !> Solve A x = b, without border, with several right-hand sides.
   subroutine solve_many(self, b, regular)
      class(band_matrix), intent(inout) :: self
      !> Right-hand sides (size, m), replaced by the solutions
      real(wp), intent(inout), contiguous :: b(:, :)
      !> Whether the matrix has an inverse
      logical, intent(out) :: regular

      call scale_rows(self, size(b, 2), b)
      call solve_scaled(self, size(b, 2), b, regular)
      call scale_rows(self, size(b, 2), b)
   end subroutine solve_many

   !> Give the matrix, which has been factored, its border, and find A^-1 a and, if needed, A^-1 c.
   subroutine set_border(self, column, row, regular)
      class(band_matrix), intent(inout) :: self
      !> a and c (size); without c it is a
      real(wp), intent(in), contiguous :: column(:)
      real(wp), intent(in), contiguous, optional :: row(:)
      !> Whether the system can have a unique solution
      logical, intent(out) :: regular
      integer :: m

      if (.not. allocated(self%border)) allocate (self%border(self%size, 2), self%flexible(self%size, 2))
      self%border(:, 1) = column
      self%border(:, 2) = column
      if (present(row)) self%border(:, 2) = row
      call scale_rows(self, 2, self%border)
      ! Of a positive definite matrix the left one is not needed.
      m = merge(1, 2, self%positive .or. .not. present(row))
      self%flexible(:, :m) = self%border(:, :m)
      call solve_scaled(self, m, self%flexible, regular)
      if (m == 1) self%flexible(:, 2) = self%flexible(:, 1)
      self%from_right = dot_product(self%border(:, 2), self%flexible(:, 1))
      self%from_left = self%from_right
      if (m == 2) self%from_left = dot_product(self%flexible(:, 2), self%border(:, 1))
      regular = regular .and. abs(self%from_left) > 0.0_wp .and. abs(self%from_right) > 0.0_wp
   end subroutine set_border

   !> Solve A x - a y = f, c x = g with the border of `set_border`.
   subroutine solve_bordered(self, f, g, x, y, regular)
      class(band_matrix), intent(inout) :: self
      !> Right-hand side (size), and that of the border
      real(wp), intent(in), contiguous :: f(:)
      real(wp), intent(in) :: g
      !> Solution (size), and that of the border
      real(wp), intent(out), contiguous :: x(:)
      real(wp), intent(out) :: y
      !> Whether the system has a unique solution
      logical, intent(out) :: regular
      real(wp) :: change

      if (.not. allocated(self%right)) allocate (self%right, self%more, mold=f)
      self%right = f
      call scale_rows(self, 1, self%right)
      call eliminate(self, self%right, g, x, y, regular)
      if (.not. regular) return
      if (.not. self%positive) then
         ! One step of refinement. Its size also shows whether the system has a solution.
         self%right(:) = self%right + self%border(:, 1)*y
         call subtract_product(self%size, size(self%band, 1), self%band, x, self%right)
         ! `right` is now what x and y leave of the right-hand side.
         call eliminate(self, self%right, g - dot_product(self%border(:, 2), x), self%more, change, regular)
         regular = regular .and. maxval(abs(self%more)) <= no_answer*maxval(abs(x))
         if (.not. regular) return
         x = x + self%more
         y = y + change
      end if
      call scale_rows(self, 1, x)
   end subroutine solve_bordered

   !> Block elimination on the scaled system A x - a y = f, c x = g. Where the matrix is not positive definite
   !> it is the mixed one: once from the left, which gives most of y, and once from the right for the rest.
   subroutine eliminate(self, f, g, x, y, regular)
      type(band_matrix), intent(inout) :: self
      real(wp), intent(in) :: f(:), g
      real(wp), intent(out), contiguous :: x(:)
      real(wp), intent(out) :: y
      logical, intent(out) :: regular
      real(wp) :: more

      y = 0.0_wp
      x = f
      if (.not. self%positive) then
         y = (g - dot_product(self%flexible(:, 2), f))/self%from_left
         x = f + self%border(:, 1)*y
      end if
      ! A displacement alone has no force to solve for.
      regular = .true.
      if (any(abs(x) > 0.0_wp)) call solve_scaled(self, 1, x, regular)
      if (.not. regular) return
      more = (g - dot_product(self%border(:, 2), x))/self%from_right
      x = x + self%flexible(:, 1)*more
      y = y + more
   end subroutine eliminate

   !> Solve with the scaled matrix, by the factor where it serves, else by elimination with pivots.
   subroutine solve_scaled(self, m, b, regular)
      type(band_matrix), intent(inout) :: self
      !> Number of right-hand sides, which the solutions replace
      integer, intent(in) :: m
      real(wp), intent(inout) :: b(self%size, m)
      logical, intent(out) :: regular
      integer :: j

      regular = .true.
      if (.not. (self%positive .or. self%serves)) then
         call solve_with_pivots()
         return
      end if
      do j = 1, m
         call self%substitute(b(:, j))
      end do

   contains

      !> Solve by elimination with pivots. A pivot below round-off is given the size of round-off: with a
      !> smaller one the solution goes so far along the direction without stiffness that the digits of all
      !> others are lost.
      subroutine solve_with_pivots()
         real(wp) :: right(self%size, m)

         right = b
         if (.not. self%has_pivots) call mirror()
         call solve()
         ! Only a scaled matrix has pivots near one; of another, small pivots say nothing.
         associate (pivot => self%general(2*self%width + 1, :))
            if (.not. (allocated(self%scale) .and. any(abs(pivot) < round_off))) return
            where (abs(pivot) < round_off) pivot = sign(round_off, pivot)
         end associate
         b = right
         self%has_pivots = .true.
         call solve()
      end subroutine solve_with_pivots

      !> Solve with LAPACK, by the pivots of the last call if they are still those of the matrix.
      subroutine solve()
         call solve_general_band(self%general, self%width, self%width, b, regular, self%pivot, &
                                 self%has_pivots)
         self%has_pivots = regular
      end subroutine solve

      !> The band as elimination with pivots takes it, both triangles.
      subroutine mirror()
         integer :: i, j, main

         main = 2*self%width + 1
         if (.not. allocated(self%general)) then
            allocate (self%general(main + self%width, self%size), self%pivot(self%size))
         end if
         self%general = 0.0_wp
         do j = 1, self%size
            self%general(main, j) = self%band(1, j)
            do i = j + 1, min(j + self%width, self%size)
               self%general(main + i - j, j) = self%band(1 + i - j, j)
               self%general(main + j - i, i) = self%band(1 + i - j, j)
            end do
         end do
      end subroutine mirror

   end subroutine solve_scaled

   !> Subtract from g a symmetric matrix times the column x.
   pure subroutine subtract_product(n, rows, band, x, g)
      integer, intent(in) :: n, rows
      !> Lower band
      real(wp), intent(in) :: band(rows, n), x(n)
      real(wp), intent(inout) :: g(n)
      real(wp) :: product
      integer :: i, j

      do j = 1, n
         product = band(1, j)*x(j)
         !$omp simd reduction(+:product)
         do i = 1, min(rows - 1, n - j)
            product = product + band(1 + i, j)*x(j + i)
            g(j + i) = g(j + i) - band(1 + i, j)*x(j)
         end do
         g(j) = g(j) - product
      end do
   end subroutine subtract_product

   !> Multiply the rows of m columns by the scale, if there is one.
   pure subroutine scale_rows(self, m, b)
      type(band_matrix), intent(in) :: self
      integer, intent(in) :: m
      real(wp), intent(inout) :: b(self%size, m)
      integer :: j

      if (.not. allocated(self%scale)) return
      do j = 1, m
         b(:, j) = b(:, j)*self%scale(:self%size)
      end do
   end subroutine scale_rows

end module rbs_base_band_matrix
