!> Natural frequencies, shapes and the stable step of RK4.
module test_modal
   use check, only: unit_test, check_close, check_failed, check_passed, check_true
   use rbs_base_constants, only: pi
   use rbs_base_error, only: error_type, bad_input
   use rbs_base_kinds, only: wp
   use rbs_column_axial, only: geometric_stiffness
   use rbs_column_column, only: column_type
   use rbs_column_mass, only: symmetric_mass
   use rbs_solve_modal, only: modes_type, find_modes
   use rbs_spec_column, only: column_spec
   use samples, only: chain, column_1, elastic, made, k_c, s_k, mass_1, height_1
   implicit none
   private

   public :: collect_modal

contains

   subroutine collect_modal(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('eq 6 and misprint E5: frequencies of column 1', eq_6), &
               unit_test('modes diagonalise mass and stiffness', orthogonal), &
               unit_test('an axial load takes P l from k_M', axial), &
               unit_test('a chain of equal bodies comes to the cantilever', cantilever), &
               unit_test('stable step without damping: 2 sqrt(2)/omega', plain_step), &
               unit_test('stable step with damping is on the edge |R| = 1', damped_step), &
               unit_test('stable step under axial load is the shorter one', axial_step), &
               unit_test('a column that buckles by itself has no modes', buckling)]
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
      type(column_type) :: column
      type(column_spec) :: spec
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
      type(column_spec) :: spec
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

   !> Bending of a slender elastic cantilever, omega = 1.875104^2 sqrt(E I/(m l^3)); each flexural
   !> spring stands for the length of one body (the lowest for a half): error of second order in 1/n.
   subroutine cantilever(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_spec) :: spec
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
      complex(wp) :: root, z
      real(wp) :: c
      integer :: i, sign

      growth = 0.0_wp
      do i = 1, size(omega)
         c = alpha + beta*omega(i)**2
         root = sqrt(cmplx(c**2/4.0_wp - omega(i)**2, 0.0_wp, wp))
         do sign = -1, 1, 2
            z = h*(-c/2.0_wp + sign*root)
            growth = max(growth, abs(1.0_wp + z + z**2/2.0_wp + z**3/6.0_wp + z**4/24.0_wp))
         end do
      end do
   end function growth

   subroutine damped_step(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_spec) :: spec
      type(modes_type) :: modes
      integer, parameter :: cases = 5
      real(wp), parameter :: alpha(cases) = [1.0_wp, 500.0_wp, 0.0_wp, 100.0_wp, 0.0_wp]
      real(wp), parameter :: beta(cases) = [0.0_wp, 0.0_wp, 1.0e-5_wp, 1.0e-4_wp, 0.1_wp]
      integer :: i

      do i = 1, cases
         spec = column_1('small')
         spec%mass_damping = alpha(i)
         spec%stiffness_damping = beta(i)
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
      type(column_spec) :: spec
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
      type(column_spec) :: spec
      type(modes_type) :: modes

      spec = column_1('finite')
      spec%axial_load = 1.6e8_wp
      call find_modes(made(spec), modes, outcome)
      call check_failed(error, outcome, bad_input, 'the column buckles by itself')
   end subroutine buckling

end module test_modal
