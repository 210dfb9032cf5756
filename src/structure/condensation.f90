!> Springs in a row between two ends, condensed to the ends.
!>
!> The ends move by q and work with forces s. By equilibrium a spring carries f = p . s, so that the
!> deformations add up to q = sum p d, and those of the springs on straight lines follow from q. Springs may
!> have no stiffness, or soften. Three of them are the basis B: the softest ones whose rows p are
!> independent, so that all others are at least about as stiff. With a = P_B^-1 p and r = P_B^-1 q the forces
!> in the basis, its motion and the stiffness of the ends are
!>
!>     sigma = (I + k_B D)^-1 k_B r,   d_B = (I + D k_B)^-1 r,   D = sum a a'/k over the others
!>     dd_j = a_j . sigma/k_j,   K = P_B^-T k_B (I + D k_B)^-1 P_B^-1
!>
!> Nothing is divided by the stiffness of the basis, which may vanish; then the ends move without force, and
!> exactly so. For the basis whose det(P_B)^2/(k_1 k_2 k_3) is the largest no entry of a_i^2 k_B/k_j is above
!> one; it is found by exchanges. det(I + D k_B) is that of the flexibility in units of this largest term.
!>
!> Springs beside the basis without stiffness make a mechanism: the ends do not determine their motions.
!> They share them as if all springs of the mechanism were on their initial lines.
!>
!> Forces f out of equilibrium and a misfit m of the motions are corrected by deformations c with
!> f + k c = p . s and sum p c = m, so that s = K m + sum f dd/dq.
module rbs_structure_condensation
   use rbs_base_kinds, only: wp
   use rbs_base_tolerances, only: no_stiffness, hardening_of_none, round_off
   implicit none
   private

   public :: series_tangent

   !> A spring enters the basis if it is softer by this factor than the one that it replaces.
   real(wp), parameter :: softer = 2.0_wp

   type :: series_tangent
      !> Whether it is known at all, and the springs that it belongs to (parts)
      logical :: is_known = .false.
      real(wp), allocatable :: branch(:)
      !> Whether it has changed since a band was filled with it, see `mark_columns` of the structure
      logical :: is_new = .true.
      !> Rows, present stiffness, and initial one in size (springs)
      real(wp), allocatable :: p(:, :), k(:), k0(:)
      !> Directions of pairs of springs that turn with their stiffness: cosine and sine (2, pairs)
      real(wp), allocatable :: turn(:, :)
      !> K, and deformations per motion of the ends (3, springs)
      real(wp) :: stiffness(3, 3) = 0.0_wp
      real(wp), allocatable :: rate(:, :)
      !> Whether springs without stiffness share motions that the ends do not determine; whether the row is
      !> not in stable equilibrium while its ends are held
      logical :: is_mechanism = .false., snaps_back = .false.
      !> Springs of the basis, 0 where the rows span less; P_B^-1
      integer, private :: basis(3) = 0
      real(wp), private :: to_basis(3, 3) = 0.0_wp
      !> Rows in the basis, compliances of springs beside it (springs)
      real(wp), allocatable, private :: a(:, :), soft(:)
      !> Of a mechanism: initial compliances of springs beside the basis, 0 of those that have stiffness
      !> (springs); what sharing leaves of forces in the basis
      real(wp), allocatable, private :: soft_shared(:)
      real(wp), private :: sharing(3, 3) = 0.0_wp
   contains
      procedure :: create
      procedure :: condense
      procedure :: correct
   end type series_tangent

contains

   !> Make room for the springs of a row, for the stiffness of their parts, and for pairs of springs that
   !> turn.
   subroutine create(self, springs, parts, pairs)
      class(series_tangent), intent(out) :: self
      !> Springs of the row; springs that they are made of, as layers are; pairs that turn
      integer, intent(in) :: springs, parts, pairs

      allocate (self%branch(parts), self%p(3, springs), self%k(springs), self%k0(springs), &
                self%turn(2, pairs), self%rate(3, springs), self%a(3, springs), self%soft(springs), &
                self%soft_shared(springs), source=0.0_wp)
   end subroutine create

   !> The tangent of a row of n springs, from their rows `p` and stiffness `k`.
   pure subroutine condense(self, n, weight, spared)
      class(series_tangent), intent(inout) :: self
      !> Number of springs; what follows them in the arrays is not used
      integer, intent(in) :: n
      !> A stiffness against each motion of the ends, to compare rows with
      real(wp), intent(in) :: weight(3)
      !> Number of springs with a negative stiffness that are no springs of their own: they take off
      !> flexibility of others
      integer, intent(in) :: spared
      real(wp), dimension(3, 3) :: flexibility, gain, motion, force
      real(wp) :: k_basis(3), determinant
      integer :: i, j

      self%is_mechanism = .false.
      ! Compliances that choose the basis, springs without stiffness as the softest.
      do j = 1, n
         self%soft(j) = 1.0_wp/max(abs(self%k(j)), no_stiffness*self%k0(j))
      end do
      call choose_basis(n, self%p, self%soft, weight, self%a, self%to_basis, self%basis)
      ! Those beside the basis: of springs with stiffness, and the initial ones of springs without.
      do j = 1, n
         self%soft_shared(j) = 0.0_wp
         if (abs(self%k(j)) > no_stiffness*self%k0(j)) then
            self%soft(j) = 1.0_wp/self%k(j)
         else
            self%soft_shared(j) = 1.0_wp/self%k0(j)
            self%soft(j) = 0.0_wp
            self%k(j) = 0.0_wp
         end if
      end do
      k_basis = 0.0_wp
      do i = 1, 3
         if (self%basis(i) == 0) cycle
         k_basis(i) = self%k(self%basis(i))
         self%soft(self%basis(i)) = 0.0_wp
         self%soft_shared(self%basis(i)) = 0.0_wp
      end do
      flexibility = 0.0_wp
      do j = 1, n
         if (abs(self%soft(j)) > 0.0_wp) call add_compliance(self%a(:, j), self%soft(j), flexibility)
         if (self%soft_shared(j) > 0.0_wp) self%is_mechanism = .true.
      end do
      ! See the head: D, (I + D k_B)^-1, and with the motions and forces of the basis K and dd.
      call invert(flexibility, k_basis, gain, determinant)
      motion = product_of(gain, self%to_basis)
      do j = 1, 3
         force(:, j) = k_basis*motion(:, j)
         do i = 1, j
            self%stiffness(i, j) = self%to_basis(1, i)*force(1, j) + self%to_basis(2, i)*force(2, j) &
                                   + self%to_basis(3, i)*force(3, j)
            self%stiffness(j, i) = self%stiffness(i, j)
         end do
      end do
      do j = 1, n
         self%rate(:, j) = self%soft(j)*(self%a(1, j)*force(1, :) + self%a(2, j)*force(2, :) &
                                         + self%a(3, j)*force(3, :))
      end do
      if (self%is_mechanism) call share_motion(self, n, k_basis, motion)
      do i = 1, 3
         if (self%basis(i) > 0) self%rate(:, self%basis(i)) = motion(i, :)
      end do
      self%snaps_back = .false.
      if (any(self%k(:n) < 0.0_wp)) then
         self%snaps_back = negative_directions(n, self%k, k_basis, flexibility) > spared
      end if
      self%is_known = .true.
      self%is_new = .true.
   end subroutine condense

   !> The softest springs with independent rows, and all rows as sums of theirs.
   pure subroutine choose_basis(n, p, soft, weight, a, to_basis, basis)
      !> Number of springs
      integer, intent(in) :: n
      !> Rows and compliances of the springs; a stiffness against each motion of the ends
      real(wp), intent(in) :: p(3, n), soft(n), weight(3)
      !> Rows in the basis, P_B^-1, and the numbers of its springs, 0 where rows span less
      real(wp), intent(out) :: a(3, n), to_basis(3, 3)
      integer, intent(out) :: basis(3)
      !> Stiffness of the present basis, its weight where it is empty; ratio that a spring must exceed to
      !> enter
      real(wp) :: stiff(3), largest, ratio
      integer :: i, j, row, column, exchanges

      a = p
      to_basis = 0.0_wp
      do i = 1, 3
         to_basis(i, i) = 1.0_wp
      end do
      basis = 0
      stiff = weight
      ! The first three exchanges fill empty places of the basis; the others put softer springs into it.
      do exchanges = 1, 3 + 6*n
         largest = 0.0_wp
         if (exchanges > 3) largest = softer
         row = 0
         column = 0
         do j = 1, n
            do i = 1, 3
               ! First empty places alone, then taken ones alone
               if (exchanges <= 3 .eqv. basis(i) > 0) cycle
               ratio = a(i, j)**2*stiff(i)*soft(j)
               if (.not. ratio > largest) cycle
               largest = ratio
               row = i
               column = j
            end do
         end do
         if (row > 0) then
            call pivot(n, row, column, a, to_basis)
            basis(row) = column
            stiff(row) = 1.0_wp/soft(column)
         else if (exchanges > 3) then
            exit
         end if
      end do
      do i = 1, 3
         if (basis(i) == 0) to_basis(i, :) = 0.0_wp
      end do
   end subroutine choose_basis

   !> Put a spring (column) into a place of the basis (row), as an exchange of linear programming does.
   pure subroutine pivot(n, row, column, a, to_basis)
      !> Number of springs; place in the basis, from 1 to 3; number of the spring that enters
      integer, intent(in) :: n, row, column
      !> Rows of the springs in the basis, and P_B^-1
      real(wp), intent(inout) :: a(3, n), to_basis(3, 3)
      real(wp) :: factor(3)
      integer :: i

      factor = a(:, column)
      a(row, :) = a(row, :)/factor(row)
      to_basis(row, :) = to_basis(row, :)/factor(row)
      do i = 1, 3
         if (i == row .or. .not. abs(factor(i)) > 0.0_wp) cycle
         a(i, :) = a(i, :) - factor(i)*a(row, :)
         to_basis(i, :) = to_basis(i, :) - factor(i)*to_basis(row, :)
      end do
      a(:, column) = 0.0_wp
      a(row, column) = 1.0_wp
   end subroutine pivot

   !> Add a a'/k of a spring to the flexibility in the basis.
   pure subroutine add_compliance(a, soft, flexibility)
      !> Row of the spring in the basis, and its compliance
      real(wp), intent(in) :: a(3), soft
      real(wp), intent(inout) :: flexibility(3, 3)
      integer :: i

      do i = 1, 3
         flexibility(:, i) = flexibility(:, i) + (soft*a(i))*a
      end do
   end subroutine add_compliance

   !> (I + D k)^-1 by cofactors; its entries are of the order of one for the basis that was chosen.
   pure subroutine invert(flexibility, k, inverse, determinant)
      !> D, and the stiffness of the basis
      real(wp), intent(in) :: flexibility(3, 3), k(3)
      !> The inverse; det(I + D k), kept away from 0
      real(wp), intent(out) :: inverse(3, 3), determinant
      real(wp) :: m(3, 3)
      integer :: i, j, next(3), last(3)

      do j = 1, 3
         m(:, j) = flexibility(:, j)*k(j)
         m(j, j) = 1.0_wp + m(j, j)
      end do
      next = [2, 3, 1]
      last = [3, 1, 2]
      do j = 1, 3
         do i = 1, 3
            inverse(i, j) = m(next(j), next(i))*m(last(j), last(i)) - m(next(j), last(i))*m(last(j), next(i))
         end do
      end do
      determinant = sum(m(1, :)*inverse(:, 1))
      ! Near 0 the forces of springs that soften fall as steeply as others rise, and the line is upright.
      if (abs(determinant) < no_stiffness) determinant = sign(no_stiffness, determinant)
      inverse = inverse/determinant
   end subroutine invert

   !> The product of two matrices.
   pure function product_of(a, b) result(c)
      real(wp), intent(in) :: a(3, 3), b(3, 3)
      real(wp) :: c(3, 3)
      integer :: j

      do j = 1, 3
         c(:, j) = a(:, 1)*b(1, j) + a(:, 2)*b(2, j) + a(:, 3)*b(3, j)
      end do
   end function product_of

   !> Share the motions of those springs of the basis that have no stiffness with the other springs that have
   !> none: all of these move as if they were alone in the row, with their initial stiffnesses.
   pure subroutine share_motion(self, n, k_basis, motion)
      class(series_tangent), intent(inout) :: self
      !> Number of springs
      integer, intent(in) :: n
      !> Stiffness of the basis
      real(wp), intent(in) :: k_basis(3)
      !> Of the basis per motion of the ends
      real(wp), intent(inout) :: motion(3, 3)
      real(wp) :: flexibility(3, 3), gain(3, 3), k_shared(3), determinant
      integer :: i, j

      k_shared = 0.0_wp
      do i = 1, 3
         if (self%basis(i) > 0 .and. .not. abs(k_basis(i)) > 0.0_wp) k_shared(i) = self%k0(self%basis(i))
      end do
      flexibility = 0.0_wp
      do j = 1, n
         if (.not. self%soft_shared(j) > 0.0_wp) cycle
         ! Springs that have stiffness take no part.
         where (.not. k_shared > 0.0_wp) self%a(:, j) = 0.0_wp
         call add_compliance(self%a(:, j), self%soft_shared(j), flexibility)
      end do
      call invert(flexibility, k_shared, gain, determinant)
      motion = product_of(gain, motion)
      do i = 1, 3
         self%sharing(i, :) = k_shared(i)*gain(i, :)
      end do
      do j = 1, n
         if (.not. self%soft_shared(j) > 0.0_wp) cycle
         self%rate(:, j) = self%soft_shared(j)*matmul(k_shared*self%a(:, j), motion)
      end do
   end subroutine share_motion

   !> Number of negative directions of the energy inside the row while its ends are held: that of springs with
   !> a negative stiffness, less that of the flexibility of the ends (Sylvester's law of inertia).
   pure integer function negative_directions(n, k, k_basis, flexibility) result(negative)
      !> Number of springs
      integer, intent(in) :: n
      !> Stiffness of the springs and of the basis; D of the springs beside it
      real(wp), intent(in) :: k(n), k_basis(3), flexibility(3, 3)
      real(wp) :: s(3, 3), minor(0:3)
      integer :: i, j

      ! Where the basis has no stiffness its motion is not in question: 1 stands in its place.
      do j = 1, 3
         s(:, j) = k_basis*flexibility(:, j)*k_basis(j)
         s(j, j) = s(j, j) + merge(k_basis(j), 1.0_wp, abs(k_basis(j)) > 0.0_wp)
      end do
      ! Leading minors: a change of sign is a negative direction.
      minor = [1.0_wp, s(1, 1), s(1, 1)*s(2, 2) - s(1, 2)**2, &
               s(1, 1)*(s(2, 2)*s(3, 3) - s(2, 3)**2) - s(1, 2)*(s(1, 2)*s(3, 3) - s(2, 3)*s(1, 3)) &
               + s(1, 3)*(s(1, 2)*s(2, 3) - s(2, 2)*s(1, 3))]
      negative = count(k < 0.0_wp)
      do i = 1, 3
         if (minor(i)*sign(1.0_wp, minor(i - 1)) < 0.0_wp) negative = negative - 1
      end do
   end function negative_directions

   !> Forces of the ends, and corrections of the deformations that bring the springs to equilibrium.
   pure subroutine correct(self, n, place, misfit, s, x)
      class(series_tangent), intent(in) :: self
      !> Number of springs
      integer, intent(in) :: n
      !> Places of the springs; the last ones, which are elastic and without force, have none (springs with a
      !> place)
      integer, intent(in), contiguous :: place(:)
      !> Motion of the ends less that by the deformations
      real(wp), intent(in) :: misfit(3)
      !> Forces of the ends
      real(wp), intent(out) :: s(3)
      !> In the places forces of the springs, then the corrections
      real(wp), intent(inout), contiguous :: x(:)
      !> Misfit that is left; effect of the mechanism on its basis; force out of balance, then correction
      real(wp) :: left(3), flexed(3), out
      integer :: j

      s = self%stiffness(:, 1)*misfit(1) + self%stiffness(:, 2)*misfit(2) + self%stiffness(:, 3)*misfit(3)
      do j = 1, size(place)
         s = s + self%rate(:, j)*x(place(j))
      end do
      if (self%is_mechanism) then
         ! Springs without stiffness beside the basis leave their lines for forces that are out of balance.
         flexed = 0.0_wp
         do j = 1, size(place)
            out = unbalance(x(place(j)), self%p(1, j)*s(1), self%p(2, j)*s(2), self%p(3, j)*s(3))
            flexed = flexed + (self%soft_shared(j)*out)*self%a(:, j)
         end do
         flexed = self%sharing(:, 1)*flexed(1) + self%sharing(:, 2)*flexed(2) + self%sharing(:, 3)*flexed(3)
      end if
      left = misfit
      do j = 1, n
         out = 0.0_wp
         if (j <= size(place)) out = x(place(j))
         out = unbalance(out, self%p(1, j)*s(1), self%p(2, j)*s(2), self%p(3, j)*s(3))
         if (self%soft_shared(j) > 0.0_wp) then
            out = self%soft_shared(j)*(out - sum(self%a(:, j)*flexed))/hardening_of_none
         else
            out = self%soft(j)*out
         end if
         left = left - out*self%p(:, j)
         if (j <= size(place)) x(place(j)) = out
      end do
      do j = 1, 3
         if (self%basis(j) == 0 .or. self%basis(j) > size(place)) cycle
         x(place(self%basis(j))) = sum(self%to_basis(j, :)*left)
      end do
   end subroutine correct

   !> Effect of forces on a spring, which is a sum of three terms, less its force. Round-off of it counts as
   !> zero: a spring all but without stiffness would move far for it, and back in the next trial.
   pure real(wp) function unbalance(force, first, second, third)
      !> Force of the spring; the terms p s of the three forces of the ends
      real(wp), intent(in) :: force, first, second, third

      unbalance = (first + second + third) - force
      associate (terms => abs(force) + (abs(first) + abs(second) + abs(third)))
         if (abs(unbalance) <= round_off*terms) unbalance = 0.0_wp
      end associate
   end function unbalance

end module rbs_structure_condensation
