!> Modes of a chain one by one, each in a number of operations proportional to the number of bodies: bisection
!> on the number of squared frequencies below a shift until one is left between two of them, then Rayleigh
!> quotient iteration with the same factor (B. N. Parlett, The symmetric eigenvalue problem, SIAM 1998).
!>
!> Shapes are found as motions of the joints. The Rayleigh quotient of those is a quotient of sums of positive
!> terms without axial forces, so that the smallest frequency too has the relative accuracy of stiffnesses and
!> masses.
module rbs_solve_modal_mode_search
   use rbs_base_kinds, only: wp
   use rbs_structure_column_sturm, only: sturm_chain
   implicit none
   private

   public :: mode_search

   !> The Rayleigh quotient has converged: its error is the square of that of the shape.
   real(wp), parameter :: arrived = 1.0e-13_wp

   !> Below this change it may be as exact as round-off lets it be.
   real(wp), parameter :: nearly = 1.0e-9_wp

   !> The shift stands so far beside the frequency: where a shape is at home in a part of the chain, its pivot
   !> vanishes there, and what is below would drown in its round-off.
   real(wp), parameter :: beside = 1.0e-8_wp

   !> Most steps of the iteration before the bounds are drawn closer.
   integer, parameter :: most_steps = 10

   !> Modes closer than this are made orthogonal to each other, and so many below to the first trial of a
   !> shape, which they would outweigh.
   real(wp), parameter :: close_by = 1.0e-5_wp
   integer, parameter :: neighbours = 6

   type :: mode_search
      type(sturm_chain) :: chain
      !> Bounds of the square of each frequency, and how many are below them (modes)
      real(wp), allocatable, private :: low(:), high(:)
      integer, allocatable, private :: below_low(:), below_high(:)
      !> Motion of the bodies in a shape, and in one found before (2, n)
      real(wp), allocatable, private :: x(:, :), other(:, :)
   contains
      procedure :: start
      procedure :: find
      procedure :: frequency
   end type mode_search

contains

   subroutine start(self, chain)
      class(mode_search), intent(out) :: self
      type(sturm_chain), intent(in) :: chain
      real(wp) :: s
      integer :: below, m

      self%chain = chain
      m = chain%modes
      s = min(chain%sum_of_squares(), sqrt(huge(1.0_wp)))
      allocate (self%low(m), source=0.0_wp)
      allocate (self%high(m), source=1.01_wp*s)
      allocate (self%below_low(m), source=0)
      allocate (self%below_high(m), source=m)
      allocate (self%x(2, chain%n), self%other(2, chain%n))
      do while (s > sqrt(tiny(1.0_wp)))
         s = s/1024.0_wp
         below = count_below(self, s)
         if (below == 0) exit
      end do
   end subroutine start

   !> Number of squared frequencies below s, which bounds them all.
   integer function count_below(self, s) result(below)
      type(mode_search), intent(inout) :: self
      real(wp), intent(in) :: s
      integer :: i

      below = self%chain%factor(s)
      do i = below, 1, -1
         if (.not. s < self%high(i)) exit
         self%high(i) = s
         self%below_high(i) = below
      end do
      do i = below + 1, self%chain%modes
         if (.not. s > self%low(i)) exit
         self%low(i) = s
         self%below_low(i) = below
      end do
   end function count_below

   !> Circular frequency of mode j [rad/s].
   real(wp) function frequency(self, j) result(omega)
      class(mode_search), intent(inout) :: self
      integer, intent(in) :: j
      real(wp) :: square(1), shape(2, self%chain%n, 1)

      call self%find(j, 1, square, shape)
      omega = sqrt(square(1))
   end function frequency

   !> Mode j.
   subroutine find(self, j, place, squares, shapes)
      class(mode_search), intent(inout) :: self
      integer, intent(in) :: j
      !> Where it belongs in the arrays; before it stand the modes below
      integer, intent(in) :: place
      !> Squares of the frequencies, and slips and rotations of unit modal mass (2, n, as many)
      real(wp), intent(inout), contiguous :: squares(:), shapes(:, :, :)
      real(wp) :: change, last_change, rho, shift
      integer :: below, step
      logical :: astray, more

      astray = .false.
      step = 0
      rho = 0.0_wp
      do
         call split(self%low(j), self%high(j), shift)
         if (more .and. (astray .or. self%below_low(j) /= j - 1 .or. self%below_high(j) /= j)) then
            below = count_below(self, shift)
            astray = .false.
            step = 0
            cycle
         end if
         if (.not. more) then
            step = 0
            shift = self%low(j)
         end if
         if (step > 0) shift = (1.0_wp - beside)*rho
         ! So near to a frequency the number of pivots is not certain, so it bounds nothing.
         below = self%chain%factor(shift)
         if (step == 0) then
            last_change = huge(1.0_wp)
            call any_motion()
            call iterate()
         end if
         change = rho
         call iterate()
         if (.not. more) exit
         step = step + 1
         change = abs(rho - change)
         if (rho >= self%low(j) .and. rho <= self%high(j)) then
            if (change <= arrived*rho .or. (change < nearly*rho .and. change > 0.5_wp*last_change)) exit
         end if
         astray = .not. (rho > self%low(j) .and. rho < self%high(j)) .or. step > most_steps
         last_change = change
      end do
      shapes(:, :, place) = shapes(:, :, place)/sqrt(self%chain%mass_product(self%x, self%x))
      squares(place) = min(max(rho, self%low(j)), self%high(j))

   contains

      !> Inverse iteration, and the Rayleigh quotient. Motions are scaled by powers of two, so that the units
      !> change no digit.
      subroutine iterate()
         real(wp) :: share
         integer :: i

         associate (chain => self%chain, d => shapes(:, :, place))
            call chain%solve(self%x, d)
            d = scale(1.0_wp, -exponent(maxval(abs(d))))*d
            call chain%body_motion(d, self%x)
            do i = place - 1, 1, -1
               if (i < place - neighbours .and. squares(i) < (1.0_wp - close_by)*shift) exit
               call chain%body_motion(shapes(:, :, i), self%other)
               share = chain%mass_product(self%other, self%x)
               self%x = self%x - share*self%other
               d = d - share*shapes(:, :, i)
            end do
            rho = chain%stiffness_of(d, self%x)/chain%mass_product(self%x, self%x)
         end associate
      end subroutine iterate

      !> A motion in which every mode has a share: a logistic map wanders between 0 and 1.
      subroutine any_motion()
         real(wp) :: length, z
         integer :: i

         length = sum(self%chain%lower + self%chain%upper)
         if (.not. length > 0.0_wp) length = 1.0_wp
         z = 0.5_wp
         do i = 1, self%chain%n
            z = z*3.9_wp*(1.0_wp - z)
            self%x(1, i) = (z - 0.4_wp)*length
            z = z*3.9_wp*(1.0_wp - z)
            self%x(2, i) = z - 0.4_wp
         end do
      end subroutine any_motion

      !> A number between two bounds, a power of two while they are far apart. `more` is false when there is
      !> no number between them.
      subroutine split(below, above, between)
         real(wp), intent(in) :: below, above
         real(wp), intent(out) :: between
         integer :: powers

         if (above > 8.0_wp*below .and. below > 0.0_wp) then
            powers = exponent(below) + exponent(above) - 1
            between = scale(1.0_wp, (powers - modulo(powers, 2))/2)
         else
            between = below + 0.5_wp*(above - below)
         end if
         more = between > below .and. between < above
      end subroutine split

   end subroutine find

end module rbs_solve_modal_mode_search
