!> The dynamic stiffness K - s M of a structure at rest, for the search of its modes: a factor whose
!> negative pivots are counted, their number being that of the squared frequencies below s (Sylvester), and
!> with the same factor the answer to inertia forces.
!>
!> The band serves every structure. A chain has a factor of its own (`sturm`), which keeps the relative
!> accuracy of its lowest frequency whatever the ratios of its stiffnesses; the band loses as many digits as
!> the squares of the highest and the lowest frequency are apart.
module rbs_structure_dynamic_stiffness
   use rbs_base_band_matrix, only: band_matrix
   use rbs_base_kinds, only: wp
   implicit none
   private

   public :: dynamic_stiffness

   type :: dynamic_stiffness
      !> Number of modes
      integer :: modes = 0
      !> Masses and rotary inertias of the unknowns x, zero where they are held (unknowns) [kg, kg m2]
      real(wp), allocatable :: inertia(:)
      !> Size of a motion that all modes have a share in: a length, or one for rotations (unknowns)
      real(wp), allocatable :: reach(:)
      !> K - s M at the last shift
      type(band_matrix), private :: matrix
      !> K and K_G (half-width + 1, unknowns); the latter only where axial forces count
      real(wp), allocatable, private :: stiffness(:, :), geometric(:, :)
   contains
      procedure :: create, factor, solve, motion, stiffness_of, sum_of_squares
      procedure, non_overridable :: mass_product
      procedure, non_overridable :: critical_multiple
   end type dynamic_stiffness

contains

   !> x' M y of two motions of the unknowns (unknowns).
   pure real(wp) function mass_product(self, x, y) result(total)
      class(dynamic_stiffness), intent(in) :: self
      !> Displacements or velocities (unknowns)
      real(wp), intent(in), contiguous :: x(:), y(:)

      total = sum(self%inertia*x*y)
   end function mass_product

   !> The number by which all axial forces must be multiplied to make the structure lose its stiffness before
   !> any spring yields; `huge` if no multiple does. Tension too can buckle a column of several bodies, by
   !> slip against rotation. The multiples that the structure carries are an interval from zero, so it is
   !> bisected.
   real(wp) function critical_multiple(self, bits) result(below)
      class(dynamic_stiffness), intent(inout) :: self
      !> Binary digits of the answer; without it all
      integer, intent(in), optional :: bits
      !> Beyond 2**200 times the load nothing buckles.
      integer, parameter :: most_doublings = 200
      real(wp) :: between
      integer :: i, most

      below = 1.0_wp
      if (carries(below)) then
         do i = 1, most_doublings
            if (.not. carries(2.0_wp*below)) exit
            below = 2.0_wp*below
         end do
         if (i > most_doublings) then
            below = huge(1.0_wp)
            return
         end if
      else
         do i = 1, most_doublings
            below = 0.5_wp*below
            if (carries(below)) exit
         end do
      end if
      most = digits(below)
      if (present(bits)) most = bits
      between = below
      do i = 1, most
         between = 0.5_wp*between
         if (carries(below + between)) below = below + between
      end do

   contains

      logical function carries(multiple)
         !> Factor of all axial forces
         real(wp), intent(in) :: multiple

         carries = self%factor(0.0_wp, multiple) == 0
      end function carries

   end function critical_multiple

   !> The dynamic stiffness of bands; held unknowns get a stiffness of one and no connection to the others.
   subroutine create(self, inertias, is_held, stiffness, geometric)
      class(dynamic_stiffness), intent(out) :: self
      !> Masses, and whether supports hold an unknown (unknowns)
      real(wp), intent(in) :: inertias(:)
      logical, intent(in) :: is_held(:)
      !> K and K_G (half-width + 1, unknowns), the latter only where axial forces count; they move into `self`
      real(wp), allocatable, intent(inout) :: stiffness(:, :), geometric(:, :)

      self%inertia = merge(0.0_wp, inertias, is_held)
      self%modes = count(self%inertia > 0.0_wp)
      allocate (self%reach(size(inertias)), source=1.0_wp)
      call self%matrix%create(size(inertias), size(stiffness, 1) - 1)
      call take_out_held(1.0_wp, stiffness)
      if (allocated(geometric)) call take_out_held(0.0_wp, geometric)
      call move_alloc(stiffness, self%stiffness)
      call move_alloc(geometric, self%geometric)

   contains

      !> Clear rows and columns of held unknowns in a band, and put a number on their diagonal.
      subroutine take_out_held(diagonal, band)
         !> Number for the diagonal; lower band of K or K_G
         real(wp), intent(in) :: diagonal
         real(wp), intent(inout) :: band(:, :)
         integer :: i, j

         do j = 1, size(band, 2)
            do i = 0, min(size(band, 1) - 1, size(band, 2) - j)
               if (is_held(j) .or. is_held(i + j)) band(1 + i, j) = merge(diagonal, 0.0_wp, i == 0)
            end do
         end do
      end subroutine take_out_held

   end subroutine create

   !> Factor K - s M under a multiple of the axial forces; the number of squared frequencies below s.
   integer function factor(self, s, multiple) result(below)
      class(dynamic_stiffness), intent(inout) :: self
      !> Square of a circular frequency [1/s2]
      real(wp), intent(in) :: s
      !> Factor of the axial forces; 1, if it is not given
      real(wp), intent(in), optional :: multiple
      real(wp) :: share

      associate (rows => size(self%stiffness, 1))
         self%matrix%band(:rows, :) = self%stiffness
         if (allocated(self%geometric)) then
            share = 1.0_wp
            if (present(multiple)) share = multiple
            self%matrix%band(:rows, :) = self%matrix%band(:rows, :) + share*self%geometric
         end if
      end associate
      self%matrix%band(1, :) = self%matrix%band(1, :) - s*self%inertia
      call self%matrix%factor()
      below = self%matrix%negative
   end function factor

   !> Solve (K - s M) d = M x with the last factor, in the coordinates of shapes, which here are the unknowns.
   subroutine solve(self, x, d)
      class(dynamic_stiffness), intent(in) :: self
      !> Motion whose inertia forces act (unknowns)
      real(wp), intent(in), contiguous :: x(:)
      !> (unknowns)
      real(wp), intent(out), contiguous :: d(:)

      d = self%inertia*x
      call self%matrix%substitute(d)
   end subroutine solve

   !> The unknowns x of a shape d: the shape itself, but for chains, whose shapes are deformations.
   pure subroutine motion(self, d, x)
      class(dynamic_stiffness), intent(in) :: self
      !> Shape, and the unknowns of it (unknowns)
      real(wp), intent(in), contiguous :: d(:)
      real(wp), intent(out), contiguous :: x(:)

      x(:size(self%inertia)) = d
   end subroutine motion

   !> d' K d, axial forces included; d and x are one motion, as a shape and in the unknowns, here the same.
   pure real(wp) function stiffness_of(self, d, x) result(total)
      class(dynamic_stiffness), intent(in) :: self
      !> (unknowns)
      real(wp), intent(in), contiguous :: d(:), x(:)

      total = quadratic_form(self%stiffness, d, x)
      if (allocated(self%geometric)) total = total + quadratic_form(self%geometric, d, x)
   end function stiffness_of

   !> d' A x of a symmetric matrix A, given as its lower band (half-width + 1, unknowns).
   pure real(wp) function quadratic_form(band, d, x) result(total)
      real(wp), intent(in), contiguous :: band(:, :), d(:), x(:)
      integer :: i, n

      n = size(d)
      total = sum(band(1, :)*d*x)
      do i = 1, min(size(band, 1), n) - 1
         total = total + 2.0_wp*sum(band(1 + i, :n - i)*d(:n - i)*x(1 + i:))
      end do
   end function quadratic_form

   !> The trace of M^-1 K, a bound of the sum of squared frequencies [1/s2]: unknowns without mass, which
   !> follow the others, make those only softer.
   pure real(wp) function sum_of_squares(self) result(total)
      class(dynamic_stiffness), intent(in) :: self
      real(wp) :: k(size(self%inertia))

      k = self%stiffness(1, :)
      if (allocated(self%geometric)) k = k + abs(self%geometric(1, :))
      total = sum(k/merge(self%inertia, 1.0_wp, self%inertia > 0.0_wp), mask=self%inertia > 0.0_wp)
   end function sum_of_squares

end module rbs_structure_dynamic_stiffness
