!> Exact rotations, body by body: against the dense method of module `exact`, eq 4, and invariants.
module test_finite
   use dense, only: solve_general
   use check, only: unit_test, check_close, check_same, check_true
   use rbs_base_constants, only: pi
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_structure_column_chain, only: geometric_forces
   use rbs_structure_column_column, only: column_type
   use rbs_structure_column_finite, only: finite_chain_type
   use rbs_structure_column_chain_matrices, only: symmetric_mass
   use rbs_structure_column_column_record, only: column_record
   use rbs_structure_structure, only: motion_result
   use exact, only: point, variant, state, sample, variant_of, random_state, place, dense_mass, &
                    dense_acceleration
   use samples, only: elastic, made, random_type
   implicit none
   private

   public :: collect_finite

contains

   subroutine collect_finite(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('accelerations against M = sum J'' diag(m, m, I) J', accelerations), &
               unit_test('the same for 40 bodies', many_bodies), &
               unit_test('mass matrix of the straight column', mass_straight), &
               unit_test('one body: corrected eq 4 with axial load, weight and ground', one_body), &
               unit_test('closed joints are open ones held by their reactions', reactions), &
               unit_test('power balance of loads, springs, potential and damping', power_balance), &
               unit_test('kinetic energy and position of the top', kinetic), &
               unit_test('velocity and acceleration of the top', moving_top), &
               unit_test('potential of axial load and weight from the heights', potential), &
               unit_test('potential of small rotations, without cancellation', small_potential), &
               unit_test('the derivative of the potential is the force', potential_force), &
               unit_test('small rotations: pdelta to third order', small_rotations), &
               unit_test('small rotations: openings are not coupled to second order', small_openings), &
               unit_test('a rigid rotation of the column is not felt in the joints above', rigid_rotation), &
               unit_test('a full turn of any joint changes nothing', full_turns), &
               unit_test('in free fall the column has no weight', free_fall)]
   end subroutine collect_finite

   !> Accelerations of a state.
   function accelerated(column, now) result(a)
      class(column_type), intent(in) :: column
      type(state), intent(in) :: now
      real(wp) :: a(size(now%q))
      type(motion_result) :: result

      call result%create(column)
      result%f = now%f
      call column%accelerations(now%q, now%v, now%load, 0, result)
      a = result%a
   end function accelerated

   subroutine accelerations(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      type(column_record) :: spec
      class(column_type), allocatable :: column
      type(state) :: now
      real(wp), allocatable :: expected(:)
      real(wp) :: largest
      integer :: i, n, sample_number

      do n = 1, 5
         do i = 0, 15
            spec = sample(n, variant_of(i))
            column = made(spec)
            do sample_number = 1, 10
               now = random_state(column, random)
               expected = now%q
               call dense_acceleration(spec, now, expected, largest)
               call check_close(error, accelerated(column, now), expected, 1.0e-10_wp, 1.0e-12_wp*largest, &
                                'n = '//to_text(n)//', variant '//to_text(i))
            end do
         end do
      end do
   end subroutine accelerations

   subroutine many_bodies(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      type(column_record) :: spec
      class(column_type), allocatable :: column
      type(state) :: now
      real(wp), allocatable :: expected(:)
      real(wp) :: largest
      integer :: i

      do i = 8, 9
         spec = sample(40, variant_of(i))
         column = made(spec)
         now = random_state(column, random)
         expected = now%q
         call dense_acceleration(spec, now, expected, largest)
         call check_close(error, accelerated(column, now), expected, 0.0_wp, 1.0e-10_wp*largest, &
                          'variant '//to_text(i))
      end do
   end subroutine many_bodies

   subroutine mass_straight(error)
      type(error_type), allocatable, intent(inout) :: error
      type(column_record) :: spec
      real(wp) :: q(15), mass(15, 15), expected(15, 15)

      spec = sample(5, variant(opens=.true., lumped=.true.))
      q = 0.0_wp
      call dense_mass(spec, q, mass)
      call symmetric_mass(made(spec), expected)
      call check_close(error, pack(mass, .true.), pack(expected, .true.), 1.0e-14_wp, 0.0_wp, 'entry')
   end subroutine mass_straight

   !> theory.md section 3, both rows.
   subroutine one_body(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      type(column_record) :: spec
      class(column_type), allocatable :: column
      type(state) :: now
      real(wp) :: a(2), left(2), right(2), i_half, s, c
      integer :: i

      spec = sample(1, variant())
      spec%damping%mass = 0.0_wp
      spec%depth = 0.0_wp
      column = made(spec)
      do i = 1, 20
         now = random_state(column, random)
         now%load(3:) = 0.0_wp
         a = accelerated(column, now)
         s = sin(now%q(2))
         c = cos(now%q(2))
         associate (m => spec%masses(1), l => spec%height, p => spec%axial_load, g => spec%gravity)
            i_half = m*l**2/12.0_wp + m*l**2/4.0_wp
            left = [m*a(1) + 0.5_wp*m*l*c*a(2) - 0.5_wp*m*l*s*now%v(2)**2 + now%f(1), &
                    0.5_wp*m*l*c*a(1) + i_half*a(2) + now%f(2)]
            right = [now%load(1) - m*now%load(2), &
                     now%load(1)*l*c + p*l*s + 0.5_wp*m*g*l*s - 0.5_wp*m*l*now%load(2)*c]
         end associate
         call check_close(error, left, right, 0.0_wp, 1.0e-12_wp*(maxval(abs(now%f)) + spec%axial_load), &
                          'row')
      end do
   end subroutine one_body

   subroutine reactions(error)
      type(error_type), allocatable, intent(inout) :: error
      integer, parameter :: n = 4
      type(random_type) :: random
      class(column_type), allocatable :: closed, open
      type(state) :: now, held
      real(wp) :: a(2*n), zero(n), b(3*n), work(5*n)

      closed = made(sample(n, variant(lumped=.true.)))
      open = made(sample(n, variant(opens=.true., lumped=.true.)))
      zero = 0.0_wp
      now = random_state(closed, random)
      select type (closed)
      class is (finite_chain_type)
         call closed%accelerate(now%q, now%v, now%f, now%load, work, a)
      end select
      held%q = [now%q, zero]
      held%v = [now%v, zero]
      held%f = [now%f, work(:n)]
      held%load = now%load
      b = accelerated(open, held)
      call check_close(error, b(:2*n), a, 1.0e-12_wp, 1.0e-12_wp*maxval(abs(a)), 'acceleration')
      call check_close(error, b(2*n + 1:), zero, 0.0_wp, 1.0e-11_wp*maxval(abs(a)), 'opening')
   end subroutine reactions

   !> dT/dt + f . v + d(potential)/dt = power of the loads - 2 alpha T.
   subroutine power_balance(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      type(column_record) :: spec
      class(column_type), allocatable :: column
      type(state) :: now
      type(point), allocatable :: points(:)
      real(wp) :: left, right, terms
      integer :: i, k, n, sample_number

      do n = 1, 5
         do i = 0, 15
            spec = sample(n, variant_of(i))
            column = made(spec)
            allocate (points(n + 1))
            do sample_number = 1, 5
               now = random_state(column, random)
               call place(spec, now%q, now%v, accelerated(column, now), points)
               left = 0.0_wp
               terms = 0.0_wp
               do k = 1, n + 1
                  associate (p => points(k))
                     call add(p%mass*p%x%d(1)*p%x%d(2))
                     call add(p%mass*p%y%d(1)*p%y%d(2))
                     call add(p%inertia*p%rotation%d(1)*p%rotation%d(2))
                     if (k <= n) call add(p%mass*spec%gravity*p%y%d(1))
                  end associate
               end do
               if (.not. spec%axial_follows) call add(spec%axial_load*points(n + 1)%y%d(1))
               do k = 1, column%unknowns
                  call add(now%f(k)*now%v(k))
               end do
               right = column%power_of_loads(now%q, now%v, now%load) &
                       - 2.0_wp*spec%damping%mass*column%kinetic_energy(now%q, now%v)
               call check_close(error, left, right, 0.0_wp, 1.0e-11_wp*terms, &
                                'n = '//to_text(n)//', variant '//to_text(i))
            end do
            deallocate (points)
         end do
      end do

   contains

      subroutine add(term)
         real(wp), intent(in) :: term

         left = left + term
         terms = terms + abs(term)
      end subroutine add

   end subroutine power_balance

   subroutine kinetic(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      type(column_record) :: spec
      class(column_type), allocatable :: column
      type(state) :: now
      type(point) :: points(6)
      real(wp), allocatable :: mass(:, :)
      integer :: i

      do i = 8, 9
         spec = sample(5, variant_of(i))
         column = made(spec)
         now = random_state(column, random)
         if (allocated(mass)) deallocate (mass)
         allocate (mass(column%unknowns, column%unknowns))
         call dense_mass(spec, now%q, mass)
         call check_close(error, column%kinetic_energy(now%q, now%v), &
                          0.5_wp*dot_product(now%v, matmul(mass, now%v)), 1.0e-13_wp, 0.0_wp, 'v M v/2')
         call place(spec, now%q, now%v, now%v, points)
         call check_close(error, [column%top_displacement(now%q), column%top_height(now%q)], &
                          [points(6)%x%d(0), points(6)%y%d(0)], 0.0_wp, 1.0e-14_wp, 'top')
      end do
   end subroutine kinetic

   !> Velocity and acceleration of the top are derivatives of its displacement; a fixed top moves along
   !> its own directions.
   subroutine moving_top(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp), parameter :: h = 1.0e-4_wp
      type(random_type) :: random
      type(column_record) :: spec
      class(column_type), allocatable :: column
      type(state) :: now
      real(wp) :: x(-1:1), speed(2)
      integer :: i, k

      do i = 1, 2
         spec = sample(4, variant(opens=.true.))
         if (i == 2) then
            spec%top = 'fixed'
            spec%top_mass = 100.0_wp
            deallocate (spec%shear, spec%flexure)
            allocate (spec%shear(5), source=elastic(4.0e8_wp))
            allocate (spec%flexure(5), source=elastic(2.0e8_wp))
         end if
         column = made(spec)
         now = random_state(column, random)
         associate (phi => column%at(2, :))
            if (column%held) then
               now%q(phi(5)) = -sum(now%q(phi(:4)))
               now%v(phi(5)) = -sum(now%v(phi(:4)))
               now%f(phi(5)) = -sum(now%f(phi(:4)))
            end if
         end associate
         ! The forces stand for accelerations.
         now%f = now%f/maxval(abs(now%f))
         do k = -1, 1
            x(k) = column%top_displacement(now%q + k*h*now%v + 0.5_wp*(k*h)**2*now%f)
         end do
         call column%speeds(now%q, now%v, speed)
         call check_close(error, speed(1), (x(1) - x(-1))/(2.0_wp*h), 1.0e-6_wp, 1.0e-6_wp, 'velocity')
         call check_close(error, column%top_acceleration(now%q, now%v, now%f), &
                          (x(1) - 2.0_wp*x(0) + x(-1))/h**2, 1.0e-5_wp, 1.0e-6_wp, 'acceleration')
      end do
   end subroutine moving_top

   !> P (y_T - height) + sum m g (y - y_0) over the masses of the bodies.
   subroutine potential(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      type(column_record) :: spec
      class(column_type), allocatable :: column
      type(state) :: now
      type(point) :: points(6), straight(6)
      real(wp) :: energy
      integer :: i, k

      do i = 8, 11
         spec = sample(5, variant_of(i))
         column = made(spec)
         now = random_state(column, random)
         call place(spec, now%q, now%v, now%v, points)
         call place(spec, 0.0_wp*now%q, now%v, now%v, straight)
         energy = 0.0_wp
         if (.not. spec%axial_follows) energy = spec%axial_load*(points(6)%y%d(0) - straight(6)%y%d(0))
         do k = 1, 5
            energy = energy + spec%masses(k)*spec%gravity*(points(k)%y%d(0) - straight(k)%y%d(0))
         end do
         call check_close(error, column%potential_energy(now%q), energy, 1.0e-13_wp, 0.0_wp, &
                          'variant '//to_text(i))
         call check_same(error, column%potential_energy(0.0_wp*now%q), 0.0_wp, 'straight')
      end do
   end subroutine potential

   subroutine small_potential(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      class(column_type), allocatable :: column, upright
      type(column_record) :: spec
      real(wp) :: q(10)
      integer :: i

      spec = sample(5, variant(lumped=.true.))
      column = made(spec)
      spec%kinematics = 'pdelta'
      upright = made(spec)
      do i = 1, 10
         q(i) = random%uniform(0.0_wp, 1.0e-9_wp)
      end do
      call check_close(error, column%potential_energy(q), upright%potential_energy(q), 1.0e-14_wp, 0.0_wp, &
                       'second order')
   end subroutine small_potential

   subroutine potential_force(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      type(column_record) :: spec
      class(column_type), allocatable :: column
      type(state) :: now
      real(wp), parameter :: h = 0.01_wp
      real(wp) :: mass(15, 15), slope(15), at(-3:3)
      integer :: i, k

      spec = sample(5, variant(opens=.true., lumped=.true.))
      column = made(spec)
      now = random_state(column, random)
      now%v = 0.0_wp
      now%f = 0.0_wp
      now%load = 0.0_wp
      call dense_mass(spec, now%q, mass)
      do i = 1, 15
         do k = -3, 3
            at(k) = column%potential_energy(moved(now%q, i, k*h))
         end do
         slope(i) = (45.0_wp*(at(1) - at(-1)) - 9.0_wp*(at(2) - at(-2)) + at(3) - at(-3))/(60.0_wp*h)
      end do
      call check_close(error, matmul(mass, accelerated(column, now)), -slope, 0.0_wp, &
                       1.0e-11_wp*maxval(abs(slope)), 'force')
   end subroutine potential_force

   !> The unknowns with one of them changed.
   pure function moved(q, i, by) result(there)
      real(wp), intent(in) :: q(:), by
      integer, intent(in) :: i
      real(wp) :: there(size(q))

      there = q
      there(i) = q(i) + by
   end function moved

   !> M q'' + f + K_G q = a F - b a_g holds up to terms of third order, as the motion is odd in the state.
   subroutine small_rotations(error)
      type(error_type), allocatable, intent(inout) :: error
      integer, parameter :: n = 5
      type(random_type) :: random
      class(column_type), allocatable :: column
      type(state) :: one, now
      real(wp) :: right(2*n, 1), mass(2*n, 2*n), g(2*n), away(2), share
      integer :: i
      logical :: regular

      column = made(sample(n, variant(lumped=.true.)))
      one = random_state(column, random)
      one%q(n + 1:) = one%q(n + 1:)/10.0_wp
      one%load(3:) = 0.0_wp
      do i = 1, 2
         share = 2.0e-3_wp/i
         now = state(share*one%q, share*one%v, share*one%f, share*one%load)
         call symmetric_mass(column, mass)
         g = 0.0_wp
         call geometric_forces(column%n, column%length, [column%axial_body, column%axial_slip], &
                               now%q, g)
         right(:, 1) = column%arm*now%load(1) - column%ground_arm*now%load(2) - now%f - g
         call solve_general(mass, right, regular)
         g = accelerated(column, now) - (right(:, 1) - column%mass_damping*now%v)
         away(i) = maxval(abs(g))
         call check_true(error, away(i) < 1.0e-3_wp*maxval(abs(right)), 'close')
      end do
      call check_close(error, away(1)/away(2), 8.0_wp, 0.01_wp, 0.0_wp, 'third order')
   end subroutine small_rotations

   !> Openings about the equilibrium N_i = -`axial_joint` are not coupled to other unknowns at first order.
   subroutine small_openings(error)
      type(error_type), allocatable, intent(inout) :: error
      integer, parameter :: n = 5
      type(random_type) :: random
      class(column_type), allocatable :: column
      type(state) :: one, now
      real(wp) :: right(3*n, 1), mass(3*n, 3*n), g(3*n), away(2), share
      integer :: i
      logical :: regular

      column = made(sample(n, variant(opens=.true., lumped=.true.)))
      one = random_state(column, random)
      one%q(n + 1:2*n) = one%q(n + 1:2*n)/10.0_wp
      one%load(3:) = 0.0_wp
      do i = 1, 2
         share = 1.0e-4_wp/i
         now = state(share*one%q, share*one%v, share*one%f, share*one%load)
         call symmetric_mass(column, mass)
         g = 0.0_wp
         call geometric_forces(column%n, column%length, [column%axial_body, column%axial_slip], &
                               now%q, g)
         right(:, 1) = column%arm*now%load(1) - column%ground_arm*now%load(2) - now%f - g
         now%f(2*n + 1:) = now%f(2*n + 1:) - column%axial_joint
         call solve_general(mass, right, regular)
         g = accelerated(column, now) - (right(:, 1) - column%mass_damping*now%v)
         away(i) = maxval(abs(g))
         call check_true(error, away(i) < 1.0e-2_wp*maxval(abs(right)), 'close')
      end do
      call check_close(error, away(1)/away(2), 4.0_wp, 0.01_wp, 0.0_wp, 'second order')
   end subroutine small_openings

   !> A chain without ground motion turns as a whole: the motion of its joints is the same.
   subroutine rigid_rotation(error)
      type(error_type), allocatable, intent(inout) :: error
      integer, parameter :: n = 4
      type(random_type) :: random
      type(column_record) :: spec
      class(column_type), allocatable :: column
      type(state) :: now
      real(wp) :: before(3*n), after(3*n), turn

      spec = sample(n, variant(opens=.true., axial_follows=.true., force_follows=.true.))
      spec%self_weight = .false.
      column = made(spec)
      now = random_state(column, random)
      now%load(2:3) = 0.0_wp
      now%q([1, 2*n + 1]) = 0.0_wp
      now%f([1, 2*n + 1]) = 0.0_wp
      now%v([1, 2*n + 1]) = 0.0_wp
      before = accelerated(column, now)
      turn = 1.234_wp
      now%q(n + 1) = now%q(n + 1) + turn
      after = accelerated(column, now)
      associate (u => before(1), w => before(2*n + 1), size => maxval(abs(before)))
         before([1, 2*n + 1]) = [u*cos(turn) + w*sin(turn), w*cos(turn) - u*sin(turn)]
         call check_close(error, after, before, 0.0_wp, 1.0e-13_wp*size, 'acceleration')
      end associate
   end subroutine rigid_rotation

   subroutine full_turns(error)
      type(error_type), allocatable, intent(inout) :: error
      integer, parameter :: n = 4
      type(random_type) :: random
      class(column_type), allocatable :: column
      type(state) :: now
      real(wp) :: before(2*n), after(2*n), energy
      integer :: i

      column = made(sample(n, variant(lumped=.true.)))
      now = random_state(column, random)
      before = accelerated(column, now)
      energy = column%potential_energy(now%q)
      do i = 1, n
         now%q(n + i) = now%q(n + i) + (-1)**i*i*2.0_wp*pi
         after = accelerated(column, now)
         call check_close(error, after, before, 0.0_wp, 1.0e-13_wp*maxval(abs(before)), 'acceleration')
         call check_close(error, column%potential_energy(now%q), energy, 1.0e-13_wp, 0.0_wp, 'potential')
      end do
   end subroutine full_turns

   !> If the ground falls with g, the bodies have no weight.
   subroutine free_fall(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      type(column_record) :: spec
      class(column_type), allocatable :: column
      type(state) :: now
      real(wp) :: falling(10), expected(10)

      spec = sample(5, variant())
      column = made(spec)
      now = random_state(column, random)
      now%load(3) = -spec%gravity
      falling = accelerated(column, now)
      spec%self_weight = .false.
      now%load(3) = 0.0_wp
      expected = accelerated(made(spec), now)
      call check_same(error, falling, expected, 'acceleration')
   end subroutine free_fall

end module test_finite
