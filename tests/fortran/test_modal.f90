!> Natural frequencies, shapes and the stable step of RK4.
module test_modal
   use check, only: unit_test, check_close, check_contains, check_failed, check_passed, check_true
   use rbs_base_constants, only: pi
   use rbs_base_error, only: error_type, bad_input
   use rbs_base_kinds, only: wp
   use rbs_structure_column_sturm, only: critical_factor
   use rbs_structure_column_column, only: column_type
   use rbs_structure_column_chain_matrices, only: symmetric_mass, geometric_stiffness
   use rbs_solve_modal_modes, only: modes_type, find_modes, frequency_bounds, stability_limit
   use rbs_structure_column_column_record, only: column_record, most_dense
   use samples, only: set_value, value_of, bilinear, chain, column_1, elastic, made, random_type, k_c, &
                      s_k, mass_1, height_1
   implicit none
   private

   public :: collect_modal

contains

   subroutine collect_modal(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('eq 6 and misprint E5: frequencies of column 1', eq_6), &
               unit_test('modes diagonalise mass and stiffness', orthogonal), &
               unit_test('an axial load reduces k_M by P l', axial), &
               unit_test('a chain of equal bodies converges to the cantilever', cantilever), &
               unit_test('stable step without damping: 2 sqrt(2)/omega', plain_step), &
               unit_test('stable step with damping is on the edge |R| = 1', damped_step), &
               unit_test('stable step under axial load is the shorter one', axial_step), &
               unit_test('a column that buckles by itself has no modes', buckling), &
               unit_test('openings are separate modes', openings), &
               unit_test('lowest and highest frequency in O(n) are those of all modes', bounds), &
               unit_test('lowest and highest frequency of 10000 bodies', bounds_long), &
               unit_test('stability limit of chains with damping is on the edge |R| = 1', chain_steps), &
               unit_test('modes between two others have no shorter limit', unimodal), &
               unit_test('modal damping: exact for elastic springs, safe for others', modal_step), &
               unit_test('damping from present stiffness ends with that stiffness', tangent_step), &
               unit_test('near the critical load the modes come with a warning', near_critical), &
               unit_test('all modes of too many bodies are refused', too_many), &
               unit_test('the first modes of 5000 bodies: those of a beam', first_of_many)]
   end subroutine collect_modal

   !> The two values of eq 6 corrected, k_M/(2 I) with I = m l^2/12; the small one from the product.
   pure function eigenvalues(k_v, k_m) result(w)
      real(wp), intent(in) :: k_v, k_m
      real(wp) :: w(2)
      real(wp) :: inertia, half

      inertia = mass_1*height_1**2/12.0_wp
      half = 2.0_wp*k_v/mass_1 + k_m/(2.0_wp*inertia)
      w(2) = half + sqrt(half**2 - k_v*k_m/(mass_1*inertia))
      w(1) = k_v*k_m/(mass_1*inertia)/w(2)
   end function eigenvalues

   subroutine eq_6(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(modes_type) :: modes

      call find_modes(made(column_1('small')), modes, outcome)
      call check_passed(error, outcome, 'find_modes')
      call check_close(error, modes%omega**2, eigenvalues(s_k, k_c), 1.0e-12_wp, 0.0_wp, 'eq 6')
      call check_close(error, modes%omega**2, [3.606916e5_wp, 6.161798e6_wp], 2.0e-7_wp, 0.0_wp, 'printed')
      call check_close(error, modes%omega/(2.0_wp*pi), [95.585_wp, 395.070_wp], 0.0_wp, 5.0e-4_wp, 'Hz')
   end subroutine eq_6

   subroutine orthogonal(error)
      type(error_type), allocatable, intent(inout) :: error
      integer, parameter :: n = 6
      type(error_type), allocatable :: outcome
      class(column_type), allocatable :: column
      type(column_record) :: spec
      type(modes_type) :: modes
      real(wp), dimension(2*n, 2*n) :: mass, stiffness, product
      integer :: i

      spec = chain(n, 'pdelta')
      spec%axial_load = 1.0e6_wp
      column = made(spec)
      call find_modes(column, modes, outcome)
      call check_passed(error, outcome, 'find_modes')
      call symmetric_mass(column, mass)
      call geometric_stiffness(column, stiffness)
      do i = 1, 2*n
         stiffness(i, i) = stiffness(i, i) + column%initial_stiffness(i)
      end do
      product = matmul(transpose(modes%shapes), matmul(mass, modes%shapes))
      do i = 1, 2*n
         product(i, i) = product(i, i) - 1.0_wp
      end do
      call check_true(error, maxval(abs(product)) < 1.0e-11_wp, 'modal masses are one')
      product = matmul(transpose(modes%shapes), matmul(stiffness, modes%shapes))
      do i = 1, 2*n
         product(i, i) = product(i, i) - modes%omega(i)**2
      end do
      call check_true(error, maxval(abs(product)) < 1.0e-10_wp*modes%omega(2*n)**2, 'modal stiffness')
      call check_true(error, all(modes%omega(2:) >= modes%omega(:2*n - 1)), 'ascending')
   end subroutine orthogonal

   subroutine axial(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      type(modes_type) :: modes
      real(wp), parameter :: load(3) = [1.0e7_wp, -1.0e7_wp, 0.99_wp*k_c/height_1]
      integer :: i

      do i = 1, 3
         spec = column_1('pdelta')
         spec%axial_load = load(i)
         call find_modes(made(spec), modes, outcome)
         call check_passed(error, outcome, 'find_modes')
         call check_close(error, modes%omega**2, eigenvalues(s_k, k_c - load(i)*height_1), 1.0e-12_wp, &
                          0.0_wp, &
                          'eigenvalues')
         spec%kinematics = 'finite'
         call find_modes(made(spec), modes, outcome)
         call check_close(error, modes%omega**2, eigenvalues(s_k, k_c - load(i)*height_1), 1.0e-12_wp, &
                          0.0_wp, &
                          'finite rotations begin as small ones')
      end do
   end subroutine axial

   !> Bending of a slender elastic cantilever, omega = 1.875104^2 sqrt(E I/(m l^3)); each flexural spring
   !> represents the length of one body (the lowest a half): error of second order in 1/n.
   subroutine cantilever(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      type(modes_type) :: modes
      integer, parameter :: bodies(3) = [10, 20, 40]
      real(wp), parameter :: ei = 1.0e6_wp, length = 2.0_wp, mass = 100.0_wp
      real(wp) :: exact, wrong(3)
      integer :: i, n

      exact = 1.8751040687119611_wp**2*sqrt(ei/(mass*length**3))
      do i = 1, 3
         n = bodies(i)
         spec = chain(n, 'small')
         spec%lengths = length/n
         spec%masses = mass/n
         spec%shear = spec%shear(:1)
         spec%shear(1) = elastic(1.0e13_wp)
         spec%flexure(:) = elastic(ei*n/length)
         spec%flexure(1) = elastic(2.0_wp*ei*n/length)
         call find_modes(made(spec), modes, outcome)
         call check_passed(error, outcome, 'find_modes')
         if (allocated(error)) return
         wrong(i) = abs(modes%omega(1)/exact - 1.0_wp)
      end do
      call check_true(error, wrong(3) < 1.0e-3_wp, 'first frequency of 40 bodies')
      call check_close(error, log(wrong(:2)/wrong(2:))/log(2.0_wp), [2.0_wp, 2.0_wp], 0.0_wp, 0.1_wp, &
                       'order of convergence')
   end subroutine cantilever

   subroutine plain_step(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(modes_type) :: modes

      call find_modes(made(column_1('small')), modes, outcome)
      call check_passed(error, outcome, 'find_modes')
      call check_close(error, modes%stable_step, 2.0_wp*sqrt(2.0_wp)/maxval(modes%omega), 1.0e-15_wp, &
                       0.0_wp, &
                       'stable step')
      call check_close(error, modes%stable_step, sqrt(8.0_wp/6.161798e6_wp), 1.0e-6_wp, 0.0_wp, 'column 1')
   end subroutine plain_step

   !> Largest growth of RK4 over the modes for q'' + c q' + omega^2 q = 0.
   pure real(wp) function growth(omega, alpha, beta, h)
      real(wp), intent(in) :: omega(:), alpha, beta, h
      integer :: i

      growth = 0.0_wp
      do i = 1, size(omega)
         growth = max(growth, growth_of(omega(i), alpha + beta*omega(i)**2, h))
      end do
   end function growth

   !> Growth of RK4 for one mode.
   pure real(wp) function growth_of(omega, c, h)
      real(wp), intent(in) :: omega, c, h
      complex(wp) :: root, z(2)

      root = sqrt(cmplx(c**2/4.0_wp - omega**2, 0.0_wp, wp))
      z(1) = -h*(c/2.0_wp + root)
      z(2) = h**2*omega**2/z(1)
      growth_of = maxval(abs(1.0_wp + z + z**2/2.0_wp + z**3/6.0_wp + z**4/24.0_wp))
   end function growth_of

   subroutine damped_step(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      type(modes_type) :: modes
      integer, parameter :: cases = 5
      real(wp), parameter :: alpha(cases) = [1.0_wp, 500.0_wp, 0.0_wp, 100.0_wp, 0.0_wp]
      real(wp), parameter :: beta(cases) = [0.0_wp, 0.0_wp, 1.0e-5_wp, 1.0e-4_wp, 0.1_wp]
      integer :: i

      do i = 1, cases
         spec = column_1('small')
         spec%damping%mass = alpha(i)
         spec%damping%stiffness = beta(i)
         call find_modes(made(spec), modes, outcome)
         call check_passed(error, outcome, 'find_modes')
         if (allocated(error)) return
         call check_true(error, growth(modes%omega, alpha(i), beta(i), &
                         0.9999_wp*modes%stable_step) <= 1.0_wp, &
                         'stable just below')
         call check_true(error, growth(modes%omega, alpha(i), beta(i), &
                         1.0001_wp*modes%stable_step) > 1.0_wp, &
                         'unstable just above')
      end do
      ! Far beyond critical damping: the real limit of RK4, 2.785293563405282/(beta omega^2).
      call check_close(error, modes%stable_step*beta(cases)*modes%omega(2)**2, 2.785293563405282_wp, &
                       1.0e-4_wp, &
                       0.0_wp, 'real axis')
   end subroutine damped_step

   subroutine axial_step(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      type(modes_type) :: free, pressed, pulled

      call find_modes(made(column_1('pdelta')), free, outcome)
      spec = column_1('pdelta')
      spec%axial_load = 1.0e8_wp
      call find_modes(made(spec), pressed, outcome)
      spec%axial_load = -1.0e8_wp
      call find_modes(made(spec), pulled, outcome)
      call check_passed(error, outcome, 'find_modes')
      call check_close(error, pressed%stable_step, free%stable_step, 1.0e-14_wp, 0.0_wp, 'compression')
      call check_close(error, pulled%stable_step, sqrt(8.0_wp)/pulled%omega(2), 1.0e-14_wp, 0.0_wp, 'tension')
      call check_true(error, pulled%stable_step < free%stable_step, 'tension stiffens')
   end subroutine axial_step

   subroutine buckling(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      type(modes_type) :: modes

      spec = column_1('finite')
      spec%axial_load = 1.6e8_wp
      call find_modes(made(spec), modes, outcome)
      call check_failed(error, outcome, bad_input, 'the column buckles by itself')
   end subroutine buckling

   !> A uniform chain in tension, fixed at its foot: 2 sqrt(k/m) sin((2 j - 1) pi/(4 n + 2)).
   subroutine openings(error)
      type(error_type), allocatable, intent(inout) :: error
      integer, parameter :: n = 5
      real(wp), parameter :: k = 3.0e9_wp, mass = 40.0_wp
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      class(column_type), allocatable :: column
      type(modes_type) :: plain, modes
      real(wp) :: m(3*n, 3*n), product(3*n, 3*n), expected(3*n)
      integer :: i, j

      spec = chain(n, 'small')
      spec%masses = mass
      call find_modes(made(spec), plain, outcome)
      call check_passed(error, outcome, 'find_modes')
      allocate (spec%axial_spring(1))
      spec%axial_spring(1) = elastic(k)
      column = made(spec)
      call find_modes(column, modes, outcome)
      call check_passed(error, outcome, 'find_modes')
      if (allocated(error)) return
      expected(:2*n) = plain%omega
      do j = 1, n
         expected(2*n + j) = 2.0_wp*sqrt(k/mass)*sin((2*j - 1)*pi/(4*n + 2))
      end do
      do i = 1, 3*n
         j = i - 1 + minloc(expected(i:), 1)
         expected([i, j]) = expected([j, i])
      end do
      call check_close(error, modes%omega, expected, 1.0e-13_wp, 0.0_wp, 'frequencies')
      call symmetric_mass(column, m)
      product = matmul(transpose(modes%shapes), matmul(m, modes%shapes))
      do i = 1, 3*n
         product(i, i) = product(i, i) - 1.0_wp
      end do
      call check_true(error, maxval(abs(product)) < 1.0e-11_wp, 'modal masses are one')
      do i = 1, 3*n
         call check_true(error, all(abs(modes%shapes(:2*n, i)) <= 0.0_wp) .neqv. &
                         all(abs(modes%shapes(2*n + 1:, i)) <= 0.0_wp), 'a mode opens or bends')
         call check_true(error, dot_product(column%arm, modes%shapes(:, i)) + &
                         sum(modes%shapes(2*n + 1:, i)) > 0.0_wp, 'the top goes to +x or up')
      end do
   end subroutine openings

   !> Chains with stiffnesses over 12 and masses over 8 powers of ten, with and without axial forces.
   subroutine bounds(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      class(column_type), allocatable :: column
      type(modes_type) :: modes
      type(random_type) :: random
      real(wp) :: lowest, highest, factor
      integer :: i, n, trial

      do trial = 1, 60
         n = 1 + mod(trial, 8)
         spec = chain(n, merge('small ', 'pdelta', mod(trial, 3) == 0))
         do i = 1, n
            spec%masses(i) = 10.0_wp**random%uniform(-4.0_wp, 4.0_wp)
            call set_value(spec%shear(i), 'k', 10.0_wp**random%uniform(0.0_wp, 12.0_wp))
            call set_value(spec%flexure(i), 'k', 10.0_wp**random%uniform(0.0_wp, 12.0_wp))
         end do
         if (mod(trial, 4) == 1) then
            allocate (spec%axial_spring(1))
            spec%axial_spring(1) = elastic(10.0_wp**random%uniform(0.0_wp, 12.0_wp))
         end if
         if (mod(trial, 3) /= 0) then
            spec%axial_load = sign(1.0e-3_wp, random%uniform(-1.0_wp, 1.0_wp))
            call critical_factor(made(spec), factor)
            spec%axial_load = random%uniform(0.1_wp, 0.99_wp)*spec%axial_load*min(factor, 1.0e12_wp)
         end if
         column = made(spec)
         call find_modes(column, modes, outcome)
         call check_passed(error, outcome, 'find_modes')
         call frequency_bounds(column, lowest, highest, outcome)
         call check_passed(error, outcome, 'frequency_bounds')
         if (allocated(error)) return
         call check_close(error, lowest, modes%omega(1), 1.0e-10_wp, 0.0_wp, 'lowest')
         call check_close(error, highest, modes%omega(column%unknowns), 1.0e-10_wp, 0.0_wp, 'highest')
      end do
   end subroutine bounds

   !> The cantilever above; in the highest mode all bodies far from the ends rotate equally and slip back:
   !> omega^2 = k_V l^2/I, twenty orders of magnitude above the square of the lowest one.
   subroutine bounds_long(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      integer, parameter :: n = 10000
      real(wp), parameter :: ei = 1.0e6_wp, length = 2.0_wp, mass = 100.0_wp, k_v = 1.0e21_wp
      real(wp) :: lowest, highest, limit

      spec = chain(n, 'small')
      spec%lengths = length/n
      spec%masses = mass/n
      spec%shear(:) = elastic(k_v)
      spec%flexure(:) = elastic(ei*n/length)
      spec%flexure(1) = elastic(2.0_wp*ei*n/length)
      call frequency_bounds(made(spec), lowest, highest, outcome)
      call check_passed(error, outcome, 'frequency_bounds')
      call check_close(error, lowest, 1.8751040687119611_wp**2*sqrt(ei/(mass*length**3)), 1.0e-8_wp, 0.0_wp, &
                       'lowest')
      call stability_limit(made(spec), limit, outcome)
      call check_passed(error, outcome, 'stability_limit')
      call check_close(error, highest, sqrt(12.0_wp*k_v*n/mass), 1.0e-6_wp, 0.0_wp, 'highest')
      call check_close(error, limit, 2.0_wp*sqrt(2.0_wp)/highest, 1.0e-14_wp, 0.0_wp, 'limit')
   end subroutine bounds_long

   subroutine chain_steps(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      type(modes_type) :: modes
      integer, parameter :: n = 6, cases = 6
      real(wp), parameter :: alpha(cases) = [1.0_wp, 3.0e4_wp, 0.0_wp, 1.0e2_wp, 0.0_wp, 1.0e5_wp]
      real(wp), parameter :: beta(cases) = [0.0_wp, 0.0_wp, 1.0e-5_wp, 1.0e-4_wp, 0.1_wp, 1.0e-5_wp]
      real(wp) :: limit
      integer :: i

      do i = 1, cases
         spec = chain(n, 'small')
         spec%damping%mass = alpha(i)
         spec%damping%stiffness = beta(i)
         call find_modes(made(spec), modes, outcome)
         call check_passed(error, outcome, 'find_modes')
         call stability_limit(made(spec), limit, outcome)
         call check_passed(error, outcome, 'stability_limit')
         if (allocated(error)) return
         call check_close(error, limit, modes%stable_step, 0.0_wp, 0.0_wp, 'one limit')
         call check_true(error, growth(modes%omega, alpha(i), beta(i), 0.9999_wp*limit) <= 1.0_wp, &
                         'stable just below')
         call check_true(error, growth(modes%omega, alpha(i), beta(i), 1.0001_wp*limit) > 1.0_wp, &
                         'unstable just above')
      end do
   end subroutine chain_steps

   !> Why two modes are enough: the limit of a mode with c = alpha + beta omega^2 first increases with omega
   !> and then decreases; over a series of frequencies it never increases again. In units of sqrt(alpha/beta)
   !> there is only one parameter. With alpha alone: the springs of a mode soften.
   subroutine unimodal(error)
      type(error_type), allocatable, intent(inout) :: error
      integer, parameter :: rungs = 1000
      real(wp), parameter :: alpha(8) = [1.0_wp, 0.0_wp, 1.0e-3_wp, 0.1_wp, 0.3_wp, 1.0_wp, 3.0_wp, 1.0e2_wp]
      real(wp), parameter :: beta(8) = [0.0_wp, 1.0_wp, alpha(3:)]
      real(wp) :: limit, last, omega
      integer :: i, j
      logical :: falls

      do j = 1, size(alpha)
         falls = .false.
         last = 0.0_wp
         do i = 1, rungs
            omega = 10.0_wp**(10.0_wp*(i - 1)/(rungs - 1) - 5.0_wp)
            limit = edge(omega, alpha(j) + beta(j)*omega**2)
            call check_true(error, .not. (falls .and. limit > last*(1.0_wp + 1.0e-9_wp)), &
                            'a limit rises after it fell')
            if (limit < last*(1.0_wp - 1.0e-9_wp)) falls = .true.
            last = limit
         end do
      end do
   end subroutine unimodal

   !> Longest step h at which no motion of q'' + c q' + omega^2 q = 0 grows in RK4.
   pure real(wp) function edge(omega, c) result(below)
      real(wp), intent(in) :: omega, c
      real(wp) :: above, h
      integer :: i

      below = 0.0_wp
      above = 4.0_wp/max(omega, 0.5_wp*c)
      do i = 1, 60
         h = 0.5_wp*(below + above)
         if (growth_of(omega, c, h) <= 1.0_wp + 1.0e-13_wp) then
            below = h
         else
            above = h
         end if
      end do
   end function edge

   !> Elastic springs with one ratio: like one mode of the highest frequency. Otherwise at most the radius
   !> 2.615587 of a half disc over the highest frequency, and not less for ratios up to one half.
   subroutine modal_step(error)
      type(error_type), allocatable, intent(inout) :: error
      integer, parameter :: n = 4
      real(wp), parameter :: zeta = 0.3_wp
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      type(modes_type) :: modes
      real(wp) :: limit, highest
      integer :: i

      spec = chain(n, 'pdelta')
      spec%axial_load = -1.0e6_wp
      spec%damping%modal = [zeta]
      call find_modes(made(spec), modes, outcome)
      call check_passed(error, outcome, 'find_modes')
      if (allocated(error)) return
      highest = modes%omega(2*n)
      limit = modes%stable_step
      call check_true(error, growth_of(highest, 2.0_wp*zeta*highest, 0.9999_wp*limit) <= 1.0_wp, 'just below')
      call check_close(error, limit, edge(highest, 2.0_wp*zeta*highest), 1.0e-10_wp, 0.0_wp, 'elastic')
      do i = 1, 3
         if (i == 1) then
            spec%damping%modal = [zeta, 0.1_wp]
         else if (i == 2) then
            spec%damping%modal = [zeta]
            spec%damping%mass = 1.0_wp
         else
            spec%flexure(1) = bilinear(value_of(spec%flexure(1), 'k'), 1.0e-3_wp, 0.0_wp)
         end if
         call stability_limit(made(spec), limit, outcome)
         call check_passed(error, outcome, 'stability_limit')
         call check_close(error, limit*highest, 2.615587_wp, 1.0e-3_wp, 0.0_wp, 'half disc')
      end do
   end subroutine modal_step

   !> When springs yield, their initial damping -c remains; damping from the present stiffness does not.
   subroutine tangent_step(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      type(modes_type) :: modes
      real(wp) :: c

      spec = column_1('small')
      spec%damping%stiffness = 7.0e-4_wp
      call find_modes(made(spec), modes, outcome)
      call check_passed(error, outcome, 'find_modes')
      if (allocated(error)) return
      c = spec%damping%stiffness*modes%omega(2)**2
      call check_close(error, modes%stable_step, 2.785293563405282_wp/c, 1.0e-12_wp, 0.0_wp, 'initial')
      spec%damping%tangent = .true.
      call find_modes(made(spec), modes, outcome)
      call check_passed(error, outcome, 'find_modes')
      call check_close(error, modes%stable_step, edge(modes%omega(2), c), 1.0e-6_wp, 0.0_wp, 'tangent')
      call check_true(error, modes%stable_step*c > 2.79_wp, 'tangent is longer')
   end subroutine tangent_step

   subroutine near_critical(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      type(modes_type) :: modes

      spec = column_1('pdelta')
      spec%axial_load = 0.5_wp*k_c/height_1
      call find_modes(made(spec), modes, outcome)
      call check_passed(error, outcome, 'find_modes')
      call check_close(error, modes%condition, 3.0_wp, 1.0e-12_wp, 0.0_wp, 'condition at half of the load')
      call check_true(error, modes%warning == '', 'no warning')
      spec%axial_load = (1.0_wp - 1.0e-5_wp)*k_c/height_1
      call find_modes(made(spec), modes, outcome)
      call check_passed(error, outcome, 'find_modes')
      call check_close(error, modes%condition, 2.0e5_wp, 1.0e-4_wp, 0.0_wp, 'condition')
      call check_contains(error, modes%warning, 'of the critical one', 'warning')
   end subroutine near_critical

   subroutine too_many(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(modes_type) :: modes
      class(column_type), allocatable :: column
      real(wp) :: limit

      column = made(chain(most_dense + 1, 'small'))
      call find_modes(column, modes, outcome)
      call check_failed(error, outcome, bad_input, 'for up to 500 bodies, not for n = 501')
      call stability_limit(column, limit, outcome)
      call check_passed(error, outcome, 'stability_limit')
   end subroutine too_many

   !> A slender cantilever of equal bodies, error of second order in 1/n.
   subroutine first_of_many(error)
      type(error_type), allocatable, intent(inout) :: error
      integer, parameter :: n = 5000
      real(wp), parameter :: ei = 1.0e6_wp, length = 2.0_wp, mass = 100.0_wp
      !> Roots of cos x cosh x = -1
      real(wp), parameter :: roots(3) = [1.8751040687119611_wp, 4.6940911329741746_wp, 7.8547574382376126_wp]
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      class(column_type), allocatable :: column
      type(modes_type) :: modes
      integer :: i

      spec = chain(n, 'small')
      spec%lengths = length/n
      spec%masses = mass/n
      spec%shear(:) = elastic(1.0e18_wp)
      spec%flexure(:) = elastic(ei*n/length)
      spec%flexure(1) = elastic(2.0_wp*ei*n/length)
      call find_modes(made(spec), modes, outcome, count=3)
      call check_passed(error, outcome, 'find_modes')
      if (allocated(error)) return
      call check_close(error, modes%omega, roots**2*sqrt(ei/(mass*length**3)), 1.0e-6_wp, 0.0_wp, 'beam')
      ! A cantilever's end moves by 2 per unit of mass, in every mode.
      column = made(spec)
      do i = 1, 3
         call check_close(error, dot_product(modes%shapes(:, i), column%arm), 2.0_wp/sqrt(mass), 1.0e-3_wp, &
                          0.0_wp, 'top')
      end do
   end subroutine first_of_many

end module test_modal
