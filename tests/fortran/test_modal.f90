!> Natural frequencies, shapes and the stable step of RK4.
module test_modal
   use check, only: unit_test, check_close, check_passed, check_true
   use rbs_base_constants, only: pi
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_structure_column_column, only: column_type
   use rbs_structure_column_chain_matrices, only: symmetric_mass
   use rbs_solve_modal_modes, only: modes_type, find_modes, frequency_bounds, stability_limit
   use rbs_structure_column_column_record, only: column_record
   use samples, only: set_value, value_of, bilinear, chain, column_1, elastic, made, random_type
   implicit none
   private

   public :: collect_modal

contains

   subroutine collect_modal(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('openings are separate modes', openings), &
               unit_test('lowest and highest frequency in O(n) are those of all modes', bounds), &
               unit_test('lowest and highest frequency of 10000 bodies', bounds_long), &
               unit_test('modes between two others have no shorter limit', unimodal), &
               unit_test('modal damping: exact for elastic springs, safe for others', modal_step), &
               unit_test('damping from present stiffness ends with that stiffness', tangent_step)]
   end subroutine collect_modal

   !> Growth of RK4 for one mode.
   pure real(wp) function growth_of(omega, c, h)
      real(wp), intent(in) :: omega, c, h
      complex(wp) :: root, z(2)

      root = sqrt(cmplx(c**2/4.0_wp - omega**2, 0.0_wp, wp))
      z(1) = -h*(c/2.0_wp + root)
      z(2) = h**2*omega**2/z(1)
      growth_of = maxval(abs(1.0_wp + z + z**2/2.0_wp + z**3/6.0_wp + z**4/24.0_wp))
   end function growth_of

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
      real(wp) :: lowest, highest, factor, limit
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
         if (mod(trial, 5) == 0) spec%damping%stiffness = 10.0_wp**random%uniform(-6.0_wp, 0.0_wp)
         if (mod(trial, 3) /= 0) then
            spec%axial_load = sign(1.0e-3_wp, random%uniform(-1.0_wp, 1.0_wp))
            column = made(spec)
            factor = column%critical_factor()
            spec%axial_load = random%uniform(0.1_wp, 0.99_wp)*spec%axial_load*min(factor, 1.0e12_wp)
         end if
         column = made(spec)
         call find_modes(column, modes, outcome)
         call check_passed(error, outcome, 'find_modes')
         call frequency_bounds(column, lowest, outcome, highest)
         call check_passed(error, outcome, 'frequency_bounds')
         if (allocated(error)) return
         call check_close(error, lowest, modes%omega(1), 1.0e-10_wp, 0.0_wp, 'lowest')
         call check_close(error, highest, modes%omega(column%unknowns), 1.0e-10_wp, 0.0_wp, 'highest')
         call stability_limit(column, limit, outcome)
         call check_passed(error, outcome, 'stability_limit')
         call check_close(error, limit, modes%stable_step, 1.0e-10_wp, 0.0_wp, 'one limit')
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
      call frequency_bounds(made(spec), lowest, outcome, highest)
      call check_passed(error, outcome, 'frequency_bounds')
      call check_close(error, lowest, 1.8751040687119611_wp**2*sqrt(ei/(mass*length**3)), 1.0e-8_wp, 0.0_wp, &
                       'lowest')
      call stability_limit(made(spec), limit, outcome)
      call check_passed(error, outcome, 'stability_limit')
      call check_close(error, highest, sqrt(12.0_wp*k_v*n/mass), 1.0e-6_wp, 0.0_wp, 'highest')
      call check_close(error, limit, 2.0_wp*sqrt(2.0_wp)/highest, 1.0e-14_wp, 0.0_wp, 'limit')
   end subroutine bounds_long

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

end module test_modal
