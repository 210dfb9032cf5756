!> Natural frequencies, mode shapes and the stable step of RK4, for every structure.
!>
!> Modes come one by one: bisection on the number of squared frequencies below a shift until one is left
!> between two of them, then Rayleigh quotient iteration with the same factor (B. N. Parlett, The symmetric
!> eigenvalue problem, SIAM 1998). Each takes a number of operations proportional to the number of bodies.
!>
!> Shapes of a column are found as motions of its joints. The Rayleigh quotient of those is a quotient of sums
!> of positive terms without axial forces, so that the smallest frequency too has the relative accuracy of
!> stiffnesses and masses. Shapes of a frame are those of its nodes.
module rbs_solve_modal_modes
   use rbs_base_error, only: error_type, fatal_error, bad_input
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_structure_column_column_record, only: most_modes
   use rbs_structure_dynamic_stiffness, only: dynamic_stiffness
   use rbs_structure_spring_location, only: shear, flexure, axial
   use rbs_structure_structure, only: structure_type, horizontal
   implicit none
   private

   public :: modes_type, find_modes, frequency_bounds, stability_limit, most_numbers

   !> Change of the Rayleigh quotient at which it has converged: its error is the square of that of the shape.
   real(wp), parameter :: converged = 1.0e-13_wp

   !> Change below which it may be as exact as round-off lets it be.
   real(wp), parameter :: nearly = 1.0e-9_wp

   !> Distance of the shift from the frequency, as a share of it: where one part of the chain has most of the
   !> motion its pivot vanishes at the frequency, and round-off would hide the parts below.
   real(wp), parameter :: shift_offset = 1.0e-8_wp

   !> Most steps of the iteration before the bounds are drawn closer.
   integer, parameter :: most_steps = 10

   !> Modes closer than this are made orthogonal to each other, and so many below to the first trial of a
   !> shape, which they would outweigh.
   real(wp), parameter :: near_shift = 1.0e-5_wp
   integer, parameter :: neighbours = 6

   !> Modes that nothing couples with others: all of a frame, slips with rotations or openings of a column
   type :: mode_search
      class(dynamic_stiffness), allocatable :: dynamic
      !> Bounds of the square of each frequency, and how many are below them (modes)
      real(wp), allocatable, private :: low(:), high(:)
      integer, allocatable, private :: below_low(:), below_high(:)
      !> Unknowns of a shape, and of one found before (unknowns)
      real(wp), allocatable, private :: x(:), other(:)
   contains
      procedure :: start, find, frequency
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
      !> Shapes with shape' M shape = 1, one a column (unknowns, modes): of a column in (slip, relative
      !> rotation [, opening]), its top going to +x or up; of a frame in the displacements of its nodes
      real(wp), allocatable :: shapes(:, :)
      !> Longest step for which RK4 is stable [s]; 0 where unknowns have no mass
      real(wp) :: stable_step = 0.0_wp
      !> How much a relative error of a stiffness or of the axial load can grow in the square of a
      !> frequency: (f + 1)/(f - 1), where f times the axial load is the critical one; 1 without
      real(wp) :: condition = 1.0_wp
      !> Blank, or a warning
      character(len=200) :: warning = ''
   end type modes_type

contains

   !> Modes before any spring yields; the axial forces count where the kinematics let them. Openings are
   !> modes of their own.
   subroutine find_modes(structure, modes, error, count)
      class(structure_type), intent(in) :: structure
      type(modes_type), intent(out) :: modes
      type(error_type), allocatable, intent(out) :: error
      !> How many, the lowest first; without it all
      integer, intent(in), optional :: count
      type(mode_search), allocatable :: search(:)
      real(wp), allocatable :: squares(:, :), shapes(:, :, :)
      integer :: b, i, wanted
      !> Of each part: the mode that comes next, and whether there is one
      integer, allocatable :: next(:)
      logical, allocatable :: left(:)

      if (present(count)) then
         if (count < 1) then
            call fatal_error(error, bad_input, 'modes: count = '//to_text(count)//' must be above zero')
            return
         end if
      end if
      ! These also refuse a structure that buckles under its axial load alone.
      if (structure%is_implicit) then
         call check_at_rest(structure, error)
      else
         call stability_limit(structure, modes%stable_step, error)
      end if
      if (allocated(error)) return
      call new_searches(structure, structure%axially_loaded, search)
      wanted = sum([(search(b)%dynamic%modes, b=1, size(search))])
      if (present(count)) then
         wanted = min(wanted, count)
         if (real(wanted, wp)*structure%unknowns > most_numbers) then
            call fatal_error(error, bad_input, 'modes: the shapes of '//to_text(wanted)//' modes of '// &
                             to_text(structure%unknowns)//' unknowns take too much memory; ask for '// &
                             to_text(int(most_numbers/structure%unknowns))//' at the most')
            return
         end if
      else if (wanted > most_modes) then
         call fatal_error(error, bad_input, 'modes: all modes are found for up to '//to_text(most_modes)// &
                          ' of them, not for '//to_text(wanted)//'; ask for the first ones by count. '// &
                          'A dynamic analysis does not need them, it finds its stable step for any n')
         return
      end if
      call set_condition(structure, search(1)%dynamic, modes)

      associate (blocks => size(search), m => size(search(1)%dynamic%inertia))
         allocate (squares(wanted, blocks), shapes(m, wanted, blocks), next(blocks), left(blocks))
      end associate
      next = 1
      left = .true.
      do b = 1, size(search)
         call search(b)%find(1, 1, squares(:, b), shapes(:, :, b))
      end do
      allocate (modes%omega(wanted))
      allocate (modes%shapes(structure%unknowns, wanted), source=0.0_wp)
      do i = 1, wanted
         b = minloc([(squares(min(next(b), wanted), b), b=1, size(search))], mask=left, dim=1)
         modes%omega(i) = sqrt(squares(next(b), b))
         call structure%set_shape(b, shapes(:, next(b), b), modes%shapes(:, i))
         next(b) = next(b) + 1
         left(b) = next(b) <= min(wanted, search(b)%dynamic%modes)
         if (left(b) .and. i < wanted) then
            call search(b)%find(next(b), next(b), squares(:, b), shapes(:, :, b))
         end if
      end do
   end subroutine find_modes

   !> Condition of the modes under axial load, with a warning where it is bad.
   subroutine set_condition(structure, dynamic, modes)
      class(structure_type), intent(in) :: structure
      !> The first part of the structure, on which the axial forces act
      class(dynamic_stiffness), intent(inout) :: dynamic
      type(modes_type), intent(inout) :: modes
      !> Digits of the critical load that the condition needs
      integer, parameter :: digits_needed = 24
      real(wp) :: share

      if (.not. structure%axially_loaded) return
      ! The axial load as a share of the critical one, 1/f; the condition is (f + 1)/(f - 1).
      share = 1.0_wp/dynamic%critical_multiple(digits_needed)
      modes%condition = (1.0_wp + share)/max(1.0_wp - share, epsilon(1.0_wp))
      if (modes%condition < worst_condition) return
      modes%warning = 'the axial load is '//to_text(share)//' of the critical one: a relative error '// &
                      'of a stiffness or of the load may grow by '//to_text(modes%condition)// &
                      ' in the square of the lowest frequency'
   end subroutine set_condition

   !> Begin the search of the modes in each part of a structure; nothing couples the parts.
   subroutine new_searches(structure, axial, search)
      class(structure_type), intent(in) :: structure
      !> Whether the axial forces count
      logical, intent(in) :: axial
      type(mode_search), allocatable, intent(out) :: search(:)
      class(dynamic_stiffness), allocatable :: part(:)
      integer :: b

      call structure%dynamic_parts(axial, part)
      allocate (search(size(part)))
      do b = 1, size(part)
         allocate (search(b)%dynamic, source=part(b))
      end do
      call search%start()
   end subroutine new_searches

   !> Refuse a structure that has no modes: it has no inertia, or is buckled by its constant axial forces
   !> alone.
   subroutine check_at_rest(structure, error)
      class(structure_type), intent(in) :: structure
      type(error_type), allocatable, intent(out) :: error
      type(mode_search), allocatable :: search(:)
      real(wp) :: factor, force

      call structure%check_inertia(error)
      if (allocated(error) .or. .not. structure%axially_loaded) return
      call new_searches(structure, .true., search)
      ! No square of a frequency is below zero: it is stable.
      if (search(1)%dynamic%factor(0.0_wp) == 0) return
      factor = search(1)%dynamic%critical_multiple()
      force = structure%constant_axial(maxloc(abs(structure%constant_axial), dim=1))
      call fatal_error(error, bad_input, 'structure: the axial load of '//to_text(force)//' N at '// &
                       'its base is beyond the critical load of '//to_text(factor*force)//' N; it '// &
                       'buckles by itself. Reduce the axial load or stiffen the springs')
   end subroutine check_at_rest

   !> Lowest and highest circular frequency of the structure before any spring yields [rad/s]; the axial
   !> forces count where the kinematics let them.
   subroutine frequency_bounds(structure, lowest, error, highest)
      class(structure_type), intent(in) :: structure
      !> 0 with an error
      real(wp), intent(out) :: lowest
      type(error_type), allocatable, intent(out) :: error
      !> `huge` with an error
      real(wp), intent(out), optional :: highest

      lowest = 0.0_wp
      if (present(highest)) highest = huge(1.0_wp)
      call check_at_rest(structure, error)
      if (.not. allocated(error)) call frequency_range(structure, structure%axially_loaded, lowest, highest)
   end subroutine frequency_bounds

   !> The lowest and the highest circular frequency of a structure [rad/s].
   subroutine frequency_range(structure, axial, lowest, highest)
      class(structure_type), intent(in) :: structure
      !> Whether the axial forces count
      logical, intent(in) :: axial
      real(wp), intent(out) :: lowest
      real(wp), intent(out), optional :: highest
      type(mode_search), allocatable :: search(:)
      integer :: b

      call new_searches(structure, axial, search)
      lowest = minval([(search(b)%frequency(1), b=1, size(search))])
      if (.not. present(highest)) return
      highest = maxval([(search(b)%frequency(search(b)%dynamic%modes), b=1, size(search))])
   end subroutine frequency_range

   !> Longest step for which RK4 is stable [s], for any number of bodies in O(n).
   !>
   !> Only the lowest and the highest frequency are asked: with c = alpha + beta omega^2 the limit of one mode
   !> first grows with omega and then falls (see the tests), and with c = 2 zeta omega, or on the half disc,
   !> it only falls; so no mode between two has a shorter limit than both.
   subroutine stability_limit(structure, limit, error)
      class(structure_type), intent(in) :: structure
      real(wp), intent(out) :: limit
      type(error_type), allocatable, intent(out) :: error
      !> Lowest and highest frequency without and with axial forces [rad/s]
      real(wp) :: plain(2), loaded(2)

      limit = 0.0_wp
      call frequency_bounds(structure, loaded(1), error, loaded(2))
      if (allocated(error)) return
      plain = loaded
      if (structure%axially_loaded) call frequency_range(structure, .false., plain(1), plain(2))
      limit = min(step_of_mode(structure, plain(1), loaded(1)), step_of_mode(structure, plain(2), loaded(2)))
   end subroutine stability_limit

   !> Longest stable step for one mode, on the safe side.
   !>
   !> Whatever lines the springs are on, a motion lambda^2 x + lambda M^-1 C x + M^-1 K x = 0 obeys the scalar
   !> equation of the quotients c = x'Cx/x'Mx and k = x'Kx/x'Mx of its shape. So |lambda| is at most the
   !> larger of the largest c and omega, which always gives a safe step; where c follows from the initial
   !> stiffness in the shape, the scalar equations themselves give the longest one.
   pure real(wp) function step_of_mode(structure, plain, loaded) result(h)
      class(structure_type), intent(in) :: structure
      !> Circular frequency of the mode without and with axial forces [rad/s]
      real(wp), intent(in) :: plain, loaded
      real(wp) :: omega, c, remaining
      !> Whether all springs stay on their first lines; whether the scalar equation of the mode holds
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
      ! Where springs yield, their stiffness vanishes and their damping stays, unless it is that of the
      ! present lines: the eigenvalue -c is left.
      remaining = merge(structure%mass_damping, c, structure%tangent_damping)
      if (remaining > 0.0_wp) h = min(h, real_limit/remaining)
   end function step_of_mode

   !> Longest stable step of RK4 for x'' + c x' + omega^2 x = 0: the largest h with |R(lambda h)| <= 1
   !> for both eigenvalues, R(z) = 1 + z + z^2/2 + z^3/6 + z^4/24. Without damping 2 sqrt(2)/omega.
   pure real(wp) function stable_step(omega, c) result(h)
      !> Circular frequency [rad/s], and damping over mass [1/s]
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

   !> Begin a search: every squared frequency is between zero and their sum. The lower bounds are raised from
   !> zero: s is lowered by powers of two until no squared frequency is below it.
   impure elemental subroutine start(self)
      class(mode_search), intent(inout) :: self
      real(wp) :: s
      integer :: below

      associate (m => self%dynamic%modes, unknowns => size(self%dynamic%inertia))
         s = min(self%dynamic%sum_of_squares(), sqrt(huge(1.0_wp)))
         allocate (self%low(m), source=0.0_wp)
         ! The sum bounds them all, round-off included.
         allocate (self%high(m), source=1.01_wp*s)
         allocate (self%below_low(m), source=0)
         allocate (self%below_high(m), source=m)
         allocate (self%x(unknowns), self%other(unknowns))
      end associate
      do while (s > sqrt(tiny(1.0_wp)))
         s = s/1024.0_wp
         below = count_below(self, s)
         if (below == 0) exit
      end do
   end subroutine start

   !> Number of squared frequencies below s, by which the bounds of all of them are narrowed.
   integer function count_below(self, s) result(below)
      type(mode_search), intent(inout) :: self
      !> Square of a circular frequency [rad2/s2]
      real(wp), intent(in) :: s
      integer :: i

      below = self%dynamic%factor(s)
      do i = below, 1, -1
         if (.not. s < self%high(i)) exit
         self%high(i) = s
         self%below_high(i) = below
      end do
      do i = below + 1, self%dynamic%modes
         if (.not. s > self%low(i)) exit
         self%low(i) = s
         self%below_low(i) = below
      end do
   end function count_below

   !> Circular frequency of mode j [rad/s].
   real(wp) function frequency(self, j) result(omega)
      class(mode_search), intent(inout) :: self
      !> 1: the lowest
      integer, intent(in) :: j
      real(wp) :: square(1), shape(size(self%x), 1)

      call self%find(j, 1, square, shape)
      omega = sqrt(square(1))
   end function frequency

   !> Find mode j (1: the lowest): by bisection until no other square is between its bounds, then by Rayleigh
   !> quotient iteration. A quotient that leaves the bounds has gone astray, and bisection goes on.
   subroutine find(self, j, column, squares, shapes)
      class(mode_search), intent(inout) :: self
      integer, intent(in) :: j
      !> Its column in the arrays, after the modes below it
      integer, intent(in) :: column
      !> Squares of the frequencies [rad2/s2], and shapes of unit modal mass (unknowns, as many): the modes
      !> below are used, and mode j is put into `column`
      real(wp), intent(inout), contiguous :: squares(:), shapes(:, :)
      !> Change of the Rayleigh quotient in this step and in the last; the quotient; square of a frequency for
      !> which the matrix is factored
      real(wp) :: change, last_change, rho, shift
      integer :: below, step
      !> Whether the iteration leads to another mode; whether there is a number between the bounds
      logical :: astray, more

      astray = .false.
      step = 0
      rho = 0.0_wp
      do
         call split(self%low(j), self%high(j), shift)
         ! Bisect until mode j alone is between its bounds, and whenever the iteration has gone astray.
         if (more .and. (astray .or. self%below_low(j) /= j - 1 .or. self%below_high(j) /= j)) then
            below = count_below(self, shift)
            astray = .false.
            step = 0
            cycle
         end if
         ! No number is left between the bounds: the lower one is the square to the last digit.
         if (.not. more) then
            step = 0
            shift = self%low(j)
         end if
         if (step > 0) shift = (1.0_wp - shift_offset)*rho
         ! So near to a frequency the number of pivots is not certain, so it bounds nothing.
         below = self%dynamic%factor(shift)
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
            if (change <= converged*rho .or. (change < nearly*rho .and. change > 0.5_wp*last_change)) exit
         end if
         astray = .not. (rho > self%low(j) .and. rho < self%high(j)) .or. step > most_steps
         last_change = change
      end do
      shapes(:, column) = shapes(:, column)/sqrt(self%dynamic%mass_product(self%x, self%x))
      squares(column) = min(max(rho, self%low(j)), self%high(j))

   contains

      !> Inverse iteration, and the Rayleigh quotient. The shape is kept free of close modes that were found
      !> before. Motions are scaled by powers of two, so that the units change no digit.
      subroutine iterate()
         real(wp) :: share
         integer :: i

         associate (dynamic => self%dynamic, d => shapes(:, column))
            call dynamic%solve(self%x, d)
            d = scale(1.0_wp, -exponent(maxval(abs(d))))*d
            call dynamic%motion(d, self%x)
            do i = column - 1, 1, -1
               if (i < column - neighbours .and. squares(i) < (1.0_wp - near_shift)*shift) exit
               call dynamic%motion(shapes(:, i), self%other)
               share = dynamic%mass_product(self%other, self%x)
               self%x = self%x - share*self%other
               d = d - share*shapes(:, i)
            end do
            rho = dynamic%stiffness_of(d, self%x)/dynamic%mass_product(self%x, self%x)
         end associate
      end subroutine iterate

      !> A motion in which every mode has a share: a logistic map wanders between 0 and 1.
      subroutine any_motion()
         real(wp) :: z
         integer :: i

         z = 0.5_wp
         do i = 1, size(self%x)
            z = z*3.9_wp*(1.0_wp - z)
            self%x(i) = (z - 0.4_wp)*self%dynamic%reach(i)
         end do
      end subroutine any_motion

      !> The number that halves an interval, or its exponents while the bounds are far apart: few steps then
      !> cross many decades. `more` is false when there is no number between the bounds.
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
