!> Natural frequencies, mode shapes and the stable step of RK4.
!>
!> Modes of a chain one by one, each in a number of operations proportional to the number of bodies: bisection
!> on the number of squared frequencies below a shift until one is left between two of them, then Rayleigh
!> quotient iteration with the same factor (B. N. Parlett, The symmetric eigenvalue problem, SIAM 1998).
!>
!> Shapes are found as motions of the joints. The Rayleigh quotient of those is a quotient of sums of positive
!> terms without axial forces, so that the smallest frequency too has the relative accuracy of stiffnesses and
!> masses.
module rbs_solve_modal_modes
   use rbs_base_band_matrix, only: band_matrix
   use rbs_base_error, only: error_type, fatal_error, bad_input
   use rbs_base_kinds, only: wp
   use rbs_base_linalg, only: symmetric_modes
   use rbs_base_text, only: to_text
   use rbs_structure_column_column, only: column_type
   use rbs_structure_column_column_record, only: most_dense
   use rbs_structure_column_sturm, only: lateral_chain, opening_chain, critical_factor, check_stable, &
                                         check_inertia_of_ends, sturm_chain
   use rbs_structure_spring_place, only: shear, flexure, axial
   use rbs_structure_structure, only: structure_type, horizontal, signals
   implicit none
   private

   public :: modes_type, find_modes, frequency_bounds, stability_limit, most_numbers

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

   !> The stability region of RK4 ends here on the negative real axis: z = -2.785293563...
   real(wp), parameter :: real_limit = 2.785293563405282_wp

   !> The left half of a disc of this radius lies in the stability region; it touches at 122.7 degrees.
   real(wp), parameter :: least_radius = 2.615587_wp

   !> A mode slower than this [rad/s] sets no limit.
   real(wp), parameter :: slowest = 1.0e-100_wp

   !> Above this condition the modes come with a warning.
   real(wp), parameter :: worst_condition = 1.0e4_wp

   !> Most numbers in a matrix, or in the shapes of the modes: 400 MB.
   real(wp), parameter :: most_numbers = 5.0e7_wp

   type :: modes_type
      !> Circular frequencies, ascending (modes) [rad/s]
      real(wp), allocatable :: omega(:)
      !> Shapes in (slip, relative rotation [, opening]), one a column, with shape' M shape = 1 and the
      !> top going to +x or up (unknowns, modes)
      real(wp), allocatable :: shapes(:, :)
      !> Longest step for which RK4 is stable [s]
      real(wp) :: stable_step = 0.0_wp
      !> How much a relative error of a stiffness or of the axial load can grow in the square of a
      !> frequency: (f + 1)/(f - 1), where f times the axial load is the critical one; 1 without
      real(wp) :: condition = 1.0_wp
      !> Blank, or what to beware of
      character(len=200) :: warning = ''
   end type modes_type

contains

   !> Modes of the uncracked column; the axial forces count where the kinematics let them. Openings are
   !> modes of their own.
   subroutine find_modes(structure, modes, error, count)
      class(structure_type), intent(in) :: structure
      type(modes_type), intent(out) :: modes
      type(error_type), allocatable, intent(out) :: error
      !> How many, the lowest first; without it all
      integer, intent(in), optional :: count

      if (present(count)) then
         if (count < 1) then
            call fatal_error(error, bad_input, 'modes: count = '//to_text(count)//' must be above zero')
            return
         end if
      end if
      select type (structure)
      class is (column_type)
         call find_column_modes(structure)
      class default
         call find_assembled_modes()
      end select

   contains

      !> Modes of a structure from its matrices: what has no mass follows the rest, and with the flexibility
      !> F = (K + K_G)^-1 between the masses M^(1/2) F M^(1/2) y = y/omega^2, by LAPACK. Shapes are those of
      !> the unknowns, and the stable step of RK4 is that of none where unknowns have no mass.
      subroutine find_assembled_modes()
         type(band_matrix) :: matrix
         real(wp), allocatable :: flexible(:, :), all_of(:, :), square(:), root(:)
         integer, allocatable :: heavy(:)
         integer :: i, wanted
         logical :: found

         call frequency_bounds(structure, modes%condition, modes%stable_step, error)
         modes%condition = 1.0_wp
         modes%stable_step = 0.0_wp
         if (allocated(error)) return
         heavy = pack([(i, i=1, structure%unknowns)], structure%inertias > 0.0_wp &
                 .and. .not. structure%is_held)
         if (size(heavy) == 0) then
            call fatal_error(error, bad_input, 'modes: nothing has mass; give &floor mass, or mass to nodes')
            return
         end if
         wanted = size(heavy)
         if (present(count)) wanted = min(wanted, count)
         call assemble_initial(structure, structure%axially_loaded, matrix)
         call matrix%factor()
         allocate (all_of(structure%unknowns, size(heavy)), source=0.0_wp)
         root = sqrt(structure%inertias(heavy))
         do i = 1, size(heavy)
            all_of(heavy(i), i) = root(i)
         end do
         call matrix%solve(all_of, found)
         flexible = all_of(heavy, :)*spread(root, 2, size(heavy))
         allocate (square(size(heavy)))
         if (found) call symmetric_modes(flexible, square, found)
         if (.not. found) then
            call fatal_error(error, bad_input, 'modes: the stiffness has no inverse; look for parts that '// &
                             'can move without force')
            return
         end if
         allocate (modes%omega(wanted), modes%shapes(structure%unknowns, wanted))
         do i = 1, wanted
            associate (from => size(heavy) + 1 - i)
               modes%omega(i) = 1.0_wp/sqrt(max(square(from), tiny(1.0_wp)))
               ! F M^(1/2) y omega^2 is the shape of all unknowns, with unit modal mass.
               modes%shapes(:, i) = matmul(all_of, flexible(:, from))*modes%omega(i)**2
            end associate
            if (structure%work_of(horizontal, modes%shapes(:, i)) > 0.0_wp) then
               modes%shapes(:, i) = -modes%shapes(:, i)
            end if
         end do
      end subroutine find_assembled_modes

      subroutine find_column_modes(column)
         class(column_type), intent(in) :: column
         type(mode_search) :: search(2)
         real(wp), allocatable :: squares(:, :), shapes(:, :, :, :)
         real(wp) :: lowest(2), top
         integer :: b, blocks, i, n, next(2), wanted

         n = column%n
         blocks = merge(2, 1, column%opens)
         wanted = column%unknowns - merge(1, 0, column%held)
         if (present(count)) then
            wanted = min(wanted, count)
            if (real(wanted, wp)*column%unknowns > most_numbers) then
               call fatal_error(error, bad_input, 'modes: the shapes of '//to_text(wanted)//' modes of n '// &
                                '= '//to_text(n)//' bodies take too much memory; ask for '// &
                                to_text(int(most_numbers/column%unknowns))//' at the most')
               return
            end if
         else if (n > most_dense) then
            call fatal_error(error, bad_input, 'modes: all modes are found for up to '// &
                             to_text(most_dense)//' bodies, not for n = '// &
                             to_text(n)//'; ask for the first ones by count. '// &
                             'A dynamic analysis does not need them, it finds its stable step for any n')
            return
         end if
         ! This also refuses a column that buckles under its axial load alone.
         call stability_limit(column, modes%stable_step, error)
         if (allocated(error)) return
         call set_condition(column)

         allocate (squares(wanted, blocks), shapes(2, n, wanted, blocks))
         call search(1)%start(lateral_chain(column, column%axially_loaded))
         if (column%opens) call search(2)%start(opening_chain(column))
         lowest = huge(1.0_wp)
         do b = 1, blocks
            next(b) = 1
            call search(b)%find(1, 1, squares(:, b), shapes(:, :, :, b))
            lowest(b) = squares(1, b)
         end do
         allocate (modes%omega(wanted))
         allocate (modes%shapes(column%unknowns, wanted), source=0.0_wp)
         do i = 1, wanted
            b = minloc(lowest, 1)
            associate (shape => modes%shapes(:, i), found => shapes(:, :, next(b), b))
               modes%omega(i) = sqrt(lowest(b))
               if (b == 2) then
                  shape(column%at(axial, :)) = found(1, :)
               else
                  shape(column%at(shear, :)) = found(1, :)
                  shape(column%at(flexure, :)) = found(2, :)
               end if
               ! The top goes to +x or, if it only goes along the column, up.
               top = dot_product(column%arm, shape) + sum(shape, column%place%kind == axial)
               shape = sign(1.0_wp, top)*shape
            end associate
            next(b) = next(b) + 1
            lowest(b) = huge(1.0_wp)
            if (next(b) > min(wanted, search(b)%chain%modes) .or. i == wanted) cycle
            call search(b)%find(next(b), next(b), squares(:, b), shapes(:, :, :, b))
            lowest(b) = squares(next(b), b)
         end do
      end subroutine find_column_modes

      !> Condition of the modes under axial load.
      subroutine set_condition(column)
         class(column_type), intent(in) :: column
         real(wp) :: factor, share

         if (.not. column%axially_loaded) return
         call critical_factor(column, factor)
         share = 1.0_wp/factor
         modes%condition = (1.0_wp + share)/max(1.0_wp - share, epsilon(1.0_wp))
         if (modes%condition < worst_condition) return
         modes%warning = 'the axial load is '//to_text(share)//' of the critical one: a relative error '// &
                         'of a stiffness or of the load may grow by '//to_text(modes%condition)// &
                         ' in the square of the lowest frequency'
      end subroutine set_condition

   end subroutine find_modes

   !> Stiffness before any spring yields, with the axial forces at rest.
   subroutine assemble_initial(structure, axial, matrix)
      class(structure_type), intent(in) :: structure
      logical, intent(in) :: axial
      type(band_matrix), intent(out) :: matrix
      real(wp) :: force(structure%axial_count), at_rest(signals)

      call matrix%create(structure%unknowns, structure%half_width)
      matrix%band = 0.0_wp
      call structure%add_stiffness(structure%initial_stiffness, structure%initial_tangent, matrix%band)
      if (.not. axial) return
      at_rest = 0.0_wp
      call structure%axial_forces(at_rest, force)
      call structure%add_geometric(force, matrix%band)
   end subroutine assemble_initial

   !> Lowest and highest circular frequency of the structure before any spring yields [rad/s]; the axial
   !> forces count where the kinematics let them.
   subroutine frequency_bounds(structure, lowest, highest, error)
      class(structure_type), intent(in) :: structure
      real(wp), intent(out) :: lowest, highest
      type(error_type), allocatable, intent(out) :: error

      lowest = 0.0_wp
      highest = huge(1.0_wp)
      select type (structure)
      class is (column_type)
         call check_inertia_of_ends(structure, error)
         if (.not. allocated(error)) call check_stable(structure, error)
      class default
         if (modes_below(structure, structure%axially_loaded, 0.0_wp) > 0) then
            call fatal_error(error, bad_input, 'structure: it is not stable under its constant axial '// &
                             'forces alone; reduce them, or stiffen the springs')
         end if
      end select
      if (.not. allocated(error)) call frequency_range(structure, structure%axially_loaded, lowest, highest)
   end subroutine frequency_bounds

   subroutine frequency_range(structure, axial, lowest, highest)
      class(structure_type), intent(in) :: structure
      !> Whether the axial forces count
      logical, intent(in) :: axial
      real(wp), intent(out) :: lowest, highest
      type(mode_search) :: search

      select type (structure)
      class is (column_type)
         call search%start(lateral_chain(structure, axial))
         lowest = search%frequency(1)
         highest = search%frequency(search%chain%modes)
         if (.not. structure%opens) return
         call search%start(opening_chain(structure))
         lowest = min(lowest, search%frequency(1))
         highest = max(highest, search%frequency(search%chain%modes))
      class default
         lowest = frequency_of(structure, axial, 1)
         highest = frequency_of(structure, axial, &
                                count(structure%inertias > 0.0_wp .and. .not. structure%is_held))
      end select
   end subroutine frequency_range

   !> One circular frequency of any structure, by bisection with the number of those below [rad/s].
   real(wp) function frequency_of(structure, axial, number) result(omega)
      class(structure_type), intent(in) :: structure
      !> Whether the axial forces count
      logical, intent(in) :: axial
      !> From the lowest up
      integer, intent(in) :: number
      real(wp) :: below, above
      integer :: i

      below = 1.0_wp
      do while (modes_below(structure, axial, below) >= number .and. below > slowest)
         below = 0.5_wp*below
      end do
      above = 2.0_wp*below
      do while (modes_below(structure, axial, above) < number .and. above < 1.0_wp/slowest)
         above = 2.0_wp*above
      end do
      below = 0.5_wp*above
      do i = 1, digits(omega)
         omega = 0.5_wp*(below + above)
         if (modes_below(structure, axial, omega) < number) then
            below = omega
         else
            above = omega
         end if
      end do
   end function frequency_of

   !> Number of modes below a circular frequency: that of negative eigenvalues of K + K_G - omega^2 M.
   integer function modes_below(structure, axial, omega) result(below)
      class(structure_type), intent(in) :: structure
      logical, intent(in) :: axial
      !> [rad/s]
      real(wp), intent(in) :: omega
      type(band_matrix) :: matrix
      integer :: i

      call assemble_initial(structure, axial, matrix)
      matrix%band(1, :) = matrix%band(1, :) - omega**2*structure%inertias
      do i = 1, structure%unknowns
         if (structure%is_held(i)) call matrix%hold(i, 1.0_wp)
      end do
      call matrix%factor()
      below = matrix%negative
   end function modes_below

   !> Longest step for which RK4 is stable [s], for any number of bodies in O(n).
   !>
   !> Only the lowest and the highest frequency are asked: with c = alpha + beta omega^2 the limit of one mode
   !> first grows with omega and then falls (see the tests), and with c = 2 zeta omega, or on the half disc,
   !> it only falls; so no mode between two has a shorter limit than both.
   subroutine stability_limit(structure, limit, error)
      class(structure_type), intent(in) :: structure
      real(wp), intent(out) :: limit
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: plain(2), loaded(2)

      limit = 0.0_wp
      call frequency_bounds(structure, loaded(1), loaded(2), error)
      if (allocated(error)) return
      plain = loaded
      if (structure%axially_loaded) call frequency_range(structure, .false., plain(1), plain(2))
      limit = min(step_of_mode(structure, plain(1), loaded(1)), step_of_mode(structure, plain(2), loaded(2)))
   end subroutine stability_limit

   !> Longest stable step for one mode, on the safe side of what is not known.
   !>
   !> Whatever lines the springs are on, a motion lambda^2 x + lambda M^-1 C x + M^-1 K x = 0 obeys the scalar
   !> equation of the quotients c = x'Cx/x'Mx and k = x'Kx/x'Mx of its shape. So |lambda| is at most the
   !> larger of the largest c and omega, which always gives a safe step; where c follows from the initial
   !> stiffness in the shape, the scalar equations themselves give the longest one.
   pure real(wp) function step_of_mode(structure, plain, loaded) result(h)
      class(structure_type), intent(in) :: structure
      !> Circular frequency without and with axial forces [rad/s]
      real(wp), intent(in) :: plain, loaded
      real(wp) :: omega, c, remaining
      logical :: elastic, apart

      elastic = all(structure%rules%name == 'elastic')
      omega = max(plain, loaded)
      c = structure%mass_damping + structure%stiffness_damping*plain**2
      ! Stiffness damping has no axial forces in it.
      apart = .not. (structure%axially_loaded .and. structure%stiffness_damping > 0.0_wp)
      if (allocated(structure%modal_damping)) then
         c = c + 2.0_wp*maxval(structure%modal_damping)*loaded
         apart = elastic .and. size(structure%modal_damping) == 1 .and. &
                 .not. (structure%mass_damping > 0.0_wp .or. structure%stiffness_damping > 0.0_wp)
      end if
      if (.not. apart) then
         h = least_radius/max(omega, c, slowest)
         return
      end if
      h = stable_step(omega, c)
      if (elastic) return
      ! Where springs yield, their stiffness goes and their damping stays, unless it is that of the present
      ! lines: the eigenvalue -c is left.
      remaining = merge(structure%mass_damping, c, structure%tangent_damping)
      if (remaining > 0.0_wp) h = min(h, real_limit/remaining)
   end function step_of_mode

   !> Longest stable step of RK4 for x'' + c x' + omega^2 x = 0: the largest h with |R(lambda h)| <= 1
   !> for both eigenvalues, R(z) = 1 + z + z^2/2 + z^3/6 + z^4/24. Without damping 2 sqrt(2)/omega.
   pure real(wp) function stable_step(omega, c) result(h)
      real(wp), intent(in) :: omega, c
      complex(wp) :: root, lambda(2)
      real(wp) :: below, above
      logical :: stable
      integer :: i

      h = 2.0_wp*sqrt(2.0_wp)/max(omega, slowest)
      if (.not. c > 0.0_wp) return
      root = sqrt(cmplx((c/2.0_wp)**2 - omega**2, 0.0_wp, wp))
      ! The larger real root without cancellation, the other from the product of the roots.
      lambda(1) = -c/2.0_wp - root
      lambda(2) = omega**2/lambda(1)
      ! |lambda h| stays below 4 in the region of stability.
      below = 0.0_wp
      above = 4.0_wp/abs(lambda(1))
      do i = 1, 100
         h = 0.5_wp*(below + above)
         associate (z => lambda*h)
            stable = all(abs(1.0_wp + z*(1.0_wp + z/2.0_wp*(1.0_wp + z/3.0_wp*(1.0_wp + z/4.0_wp)))) &
                         <= 1.0_wp + 1.0e-12_wp)
         end associate
         if (stable) then
            below = h
         else
            above = h
         end if
      end do
      h = below
   end function stable_step

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

end module rbs_solve_modal_modes
