!> Few bodies with full matrices: rates of the column on the lines of its springs, and driven by the
!> displacement of the top their update where one spring has changed its line.
!>
!>     K rate = a dF,   a rate = 1        K = diag(k) + K_G
!>
!> They are solved at every event, in loops of our own: a call of LAPACK costs more than their arithmetic, and
!> one with threads wakes them for nothing, which on a busy machine takes a thousand times as long.
module rbs_solve_static_few_bodies
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   implicit none
   private

   public :: few_bodies, most_unknowns, solve_rows, row_length

   !> Length of an equation in `solve_rows`: unknowns, the force and three right-hand sides; and the most
   !> unknowns for which full matrices are faster than bands.
   integer, parameter :: row_length = 8, most_unknowns = row_length - 4

   !> Most lines in a row whose rates are updated and not solved for.
   integer, parameter :: most_updates = 8

   !> What an updated solution may miss of an equation, as a share of its terms.
   real(wp), parameter :: lost_digits = 1.0e-14_wp

   type :: few_bodies
      !> 0 where full matrices are not used
      integer :: unknowns = 0
      !> The equations without springs, and the last solution (row_length, unknowns + 1)
      real(wp), allocatable, private :: row(:, :), solved(:, :)
      !> The stiffness of that solution (unknowns), the spring that is expected to change next, and how often
      !> the solution has been updated since
      real(wp), allocatable, private :: k(:)
      integer, private :: changing = 1, updates = most_updates
   contains
      procedure :: create
      procedure :: solve
      procedure :: solve_force
      procedure :: update
      procedure :: serialize
   end type few_bodies

contains

   subroutine create(self, geometric, arm)
      class(few_bodies), intent(out) :: self
      !> Geometric stiffness (unknowns, unknowns), arms of the lateral force (unknowns)
      real(wp), intent(in) :: geometric(:, :), arm(:)

      associate (m => self%unknowns)
         m = size(arm)
         allocate (self%row(row_length, m + 1), source=0.0_wp)
         allocate (self%k(m), source=0.0_wp)
         self%row(:m, :m) = transpose(geometric)
         self%row(m + 1, :m) = -arm
         self%row(:m, m + 1) = arm
         self%row(row_length - 2, m + 1) = 1.0_wp
         self%solved = self%row
         self%changing = m
      end associate
   end subroutine create

   !> Change of deformations and force per metre, and what takes the residuals away.
   subroutine solve(self, k, r, gap, rate, force_rate, correction, force_correction, regular)
      class(few_bodies), intent(inout) :: self
      !> Stiffness of the springs and more, residual (unknowns), and what is missing from the displacement [m]
      real(wp), intent(in) :: k(:), r(:), gap
      real(wp), intent(out) :: rate(:), force_rate, correction(:), force_correction
      !> Whether there is a unique solution
      logical, intent(out) :: regular
      integer, parameter :: right = row_length - 2
      integer :: i, m

      m = self%unknowns
      associate (solved => self%solved)
         solved = self%row
         do i = 1, m
            solved(i, i) = solved(i, i) + k(i)
            solved(right + 1, i) = r(i)
         end do
         solved(right + 1, m + 1) = gap
         solved(right + 2, self%changing) = 1.0_wp
         call solve_rows(m + 1, solved, regular)
         self%updates = 0
         if (.not. regular) self%updates = most_updates
         do i = 1, m
            rate(i) = solved(right, i)
            correction(i) = solved(right + 1, i)
            self%k(i) = k(i)
         end do
         force_rate = solved(right, m + 1)
         force_correction = solved(right + 1, m + 1)
      end associate
   end subroutine solve

   !> Driven by the force: elimination without pivots, which shows whether the column is stable.
   pure subroutine solve_force(self, k, least, arm, r, rate, correction, positive)
      class(few_bodies), intent(in) :: self
      !> Stiffness of the springs and more; pivots that count as none, arms of the force, residual (unknowns)
      real(wp), intent(in) :: k(:), least(:), arm(:), r(:)
      !> Change of the deformations per newton, and what takes the residual away (unknowns)
      real(wp), intent(out) :: rate(:), correction(:)
      logical, intent(out) :: positive
      real(wp) :: a(row_length, row_length), right(2, most_unknowns), share
      integer :: i, j, m

      m = self%unknowns
      positive = .false.
      a(:, :m) = self%row(:, :m)
      do j = 1, m
         a(j, j) = a(j, j) + k(j)
         right(:, j) = [arm(j), r(j)]
      end do
      do j = 1, m
         if (.not. a(j, j) > least(j)) return
         do i = j + 1, m
            share = a(j, i)/a(j, j)
            a(j:m, i) = a(j:m, i) - share*a(j:m, j)
            right(:, i) = right(:, i) - share*right(:, j)
         end do
      end do
      do j = m, 1, -1
         do i = j + 1, m
            right(:, j) = right(:, j) - a(i, j)*right(:, i)
         end do
         right(:, j) = right(:, j)/a(j, j)
      end do
      rate = right(1, :m)
      correction = right(2, :m)
      positive = .true.
   end subroutine solve_force

   !> The rates after one spring has changed its line, driven by the displacement, where the last solution is
   !> good enough to be updated. With the change e of the stiffness of spring i and the solution z for a unit
   !> force on it (Sherman and Morrison):
   !>
   !>     rate := rate - e rate_i/(1 + e z_i) z,     z := z/(1 + e z_i)
   !>
   !> What is missing from equilibrium, round-off of a few lines, waits for the next solution.
   subroutine update(self, k, rate, force_rate, done)
      class(few_bodies), intent(inout) :: self
      !> Stiffness of the springs and more
      real(wp), intent(in), contiguous :: k(:)
      !> Change of the deformations (unknowns) and of the force [N/m] per metre
      real(wp), intent(inout), contiguous :: rate(:)
      real(wp), intent(inout) :: force_rate
      logical, intent(out) :: done
      integer, parameter :: right = row_length - 2
      real(wp) :: change, growth
      integer :: i, j, m

      done = .false.
      if (self%updates >= most_updates) return
      m = self%unknowns
      i = self%changing
      do j = 1, m
         if (j == i .or. .not. abs(k(j) - self%k(j)) > 0.0_wp) cycle
         ! Another spring has changed, and will probably be the next one too.
         self%changing = j
         self%updates = most_updates
         return
      end do
      associate (solved => self%solved)
         change = k(i) - self%k(i)
         growth = 1.0_wp + change*solved(right + 2, i)
         if (growth > 2.0_wp .or. growth < 0.5_wp) return
         change = change*solved(right, i)/growth
         do j = 1, m + 1
            solved(right, j) = solved(right, j) - change*solved(right + 2, j)
            solved(right + 2, j) = solved(right + 2, j)/growth
         end do
         if (.not. still_solves(self, k)) then
            self%updates = most_updates
            return
         end if
         do j = 1, m
            rate(j) = solved(right, j)
         end do
         force_rate = solved(right, m + 1)
      end associate
      self%k(i) = k(i)
      self%updates = self%updates + 1
      done = .true.
   end subroutine update

   !> Whether the updated rates solve the equations: from a soft line to a stiff one digits are lost.
   pure logical function still_solves(self, k)
      class(few_bodies), intent(in) :: self
      real(wp), intent(in), contiguous :: k(:)
      integer, parameter :: right = row_length - 2
      real(wp) :: term, missing, size
      integer :: i, j, m

      m = self%unknowns
      still_solves = .true.
      do j = 1, m + 1
         missing = self%row(right, j)
         size = abs(missing)
         do i = 1, m + 1
            term = self%row(i, j)*self%solved(right, i)
            if (i == j .and. j <= m) term = term + k(j)*self%solved(right, j)
            missing = missing - term
            size = size + abs(term)
         end do
         still_solves = still_solves .and. abs(missing) <= lost_digits*size
      end do
   end function still_solves

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

   !> Save or restore the last solution, from which the next one may follow.
   pure subroutine serialize(self, stream)
      class(few_bodies), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      if (.not. allocated(self%solved)) return
      call stream%item(self%solved)
      call stream%item(self%k)
      call stream%item(self%changing)
      call stream%item(self%updates)
   end subroutine serialize

end module rbs_solve_static_few_bodies
