!> Equation of motion of the chain with small rotations: the O(n) forms against dense matrices from the
!> equations of theory.md, and against the energies.
module test_chain
   use check, only: unit_test, check_close, check_passed, check_same, check_true
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_structure_column_column, only: column_type
   use rbs_structure_column_chain_matrices, only: symmetric_mass
   use rbs_loading_loads, only: loads_type, lateral, horizontal, vertical, top_axial
   use rbs_loading_signal, only: signal_type
   use rbs_solve_modal_matrices, only: matrices_type, assemble_matrices
   use rbs_solve_modal_modes, only: modes_type, find_modes
   use rbs_solve_time_motion, only: motion_result
   use rbs_solve_time_rk4, only: rk4_scheme
   use rbs_solve_time_state, only: state_type
   use rbs_structure_column_column_record, only: column_record
   use runs, only: column_of, new_state, signal_of
   use samples, only: made, random_type, rich_column
   implicit none
   private

   public :: collect_chain

contains

   subroutine collect_chain(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('accelerations solve the dense equation of motion', dense), &
               unit_test('powers are the rates of the energies', power), &
               unit_test('velocities of bodies and of joints, kinetic energy', bodies), &
               unit_test('one body: the fast step is the step of the chain', fast_step)]
   end subroutine collect_chain

   !> Column of a variant, whose bits mean: opens, second order, lumped mass, damping of mass, of initial
   !> stiffness, of present stiffness, of modes.
   type(column_record) function variant(n, kind, random) result(spec)
      integer, intent(in) :: n, kind
      type(random_type), intent(inout) :: random

      spec = rich_column(n, merge('pdelta', 'small ', btest(kind, 0)), btest(kind, 1), random)
      if (btest(kind, 2)) then
         spec%top_mass = random%uniform(100.0_wp, 2000.0_wp)
         spec%top_inertia = random%uniform(0.0_wp, 200.0_wp)
      end if
      if (btest(kind, 3)) spec%damping%mass = random%uniform(0.0_wp, 20.0_wp)
      if (btest(kind, 4)) then
         spec%damping%stiffness = random%uniform(0.0_wp, 1.0e-3_wp)
         spec%damping%tangent = btest(kind, 5)
      end if
      if (btest(kind, 6)) spec%damping%modal = [random%uniform(0.0_wp, 0.3_wp)]
   end function variant

   !> A state with all loads and with springs at random points of their paths.
   subroutine random_state(spec, random, state)
      type(column_record), intent(in) :: spec
      type(random_type), intent(inout) :: random
      type(state_type), intent(out) :: state
      class(column_type), allocatable :: column
      type(loads_type) :: loads
      real(wp), allocatable :: q(:), v(:)
      integer :: step

      column = made(spec)
      loads%signal(lateral) = constant(random%uniform(-1.0e6_wp, 1.0e6_wp))
      loads%signal(horizontal) = constant(random%uniform(-9.0_wp, 9.0_wp))
      loads%signal(vertical) = constant(random%uniform(-9.0_wp, 9.0_wp))
      loads%signal(top_axial) = constant(random%uniform(-1.0e6_wp, 1.0e6_wp))
      allocate (q(column%unknowns), source=0.0_wp)
      v = random%uniform_array(-1.0_wp, 1.0_wp, column%unknowns)
      call new_state(state, column, loads, q, v)
      do step = 1, 3
         q = random%uniform_array(-1.0e-2_wp, 1.0e-2_wp, size(q))
         call state%springs%move_all(q)
      end do
      state%q = q
   end subroutine random_state

   type(signal_type) function constant(value) result(signal)
      real(wp), intent(in) :: value

      signal = signal_of([0.0_wp, 1.0_wp], [value, value])
   end function constant

   !> Forces of dead loads on the straight column to second order. A load of w (down) at the height s on
   !> body k has the potential w y, y = sum_{j<k} l_j (1 - th_j^2/2) + s (1 - th_k^2/2) + sum_{j<=k} (w_j
   !> - u_j th_{j-1}).
   subroutine add_dead_load(column, w, k, s, q, second_order, force)
      class(column_type), intent(in) :: column
      real(wp), intent(in) :: w, s, q(:)
      integer, intent(in) :: k
      logical, intent(in) :: second_order
      real(wp), intent(inout) :: force(:)
      real(wp) :: th(0:column%n), of_rotation(0:column%n), arm
      integer :: j, n

      n = column%n
      if (column%opens) force(2*n + 1:2*n + k) = force(2*n + 1:2*n + k) - w
      if (.not. second_order) return
      th(0) = 0.0_wp
      do j = 1, n
         th(j) = th(j - 1) + q(n + j)
      end do
      of_rotation = 0.0_wp
      do j = 1, k
         arm = merge(s, column%length(j), j == k)
         of_rotation(j) = of_rotation(j) + w*arm*th(j)
         force(j) = force(j) + w*th(j - 1)
         of_rotation(j - 1) = of_rotation(j - 1) + w*q(j)
      end do
      do j = 1, n
         force(n + j) = force(n + j) + sum(of_rotation(j:))
      end do
   end subroutine add_dead_load

   !> Right-hand side of M a = f and M itself, term by term.
   subroutine equation_of_motion(spec, state, mass, right)
      type(column_record), intent(in) :: spec
      type(state_type), intent(in) :: state
      real(wp), allocatable, intent(out) :: mass(:, :), right(:)
      type(error_type), allocatable :: outcome
      type(modes_type) :: modes
      real(wp) :: own, shape_force
      integer :: i, k, m, n

      n = spec%n
      associate (column => column_of(state), springs => state%springs, load => state%load)
         m = column%unknowns
         allocate (mass(m, m), right(m))
         call symmetric_mass(column, mass)
         do i = 1, m
            right(i) = -springs%force(i)
         end do
         right(:2*n) = right(:2*n) + load(lateral)*column%arm(:2*n) &
                        + load(horizontal)*column%pattern(horizontal)%arm(:2*n)
         do k = 1, n
            own = spec%masses(k)*(load(vertical) + merge(spec%gravity, 0.0_wp, spec%self_weight))
            call add_dead_load(column, own, k, 0.5_wp*spec%lengths(k), state%q, spec%kinematics == 'pdelta', &
                               right)
         end do
         call add_dead_load(column, spec%axial_load + load(top_axial) + spec%top_mass*load(vertical), n, &
                            spec%lengths(n), state%q, spec%kinematics == 'pdelta', right)
         right = right - spec%damping%mass*matmul(mass, state%v)
         do i = 1, m
            right(i) = right(i) - spec%damping%stiffness*state%v(i) &
                       *merge(springs%k(i), column%initial_stiffness(i), spec%damping%tangent)
         end do
         if (allocated(spec%damping%modal)) then
            call find_modes(column, modes, outcome)
            do i = 1, m
               shape_force = 2.0_wp*spec%damping%modal(1)*modes%omega(i) &
                             *dot_product(modes%shapes(:, i), matmul(mass, state%v))
               right = right - shape_force*matmul(mass, modes%shapes(:, i))
            end do
         end if
      end associate
   end subroutine equation_of_motion

   subroutine dense(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      type(column_record) :: spec
      type(state_type) :: state
      type(motion_result) :: now
      type(matrices_type) :: matrices
      type(error_type), allocatable :: outcome
      real(wp), allocatable :: mass(:, :), expected(:), force(:)
      integer :: kind, n

      do n = 1, 6
         do kind = 0, 127
            spec = variant(n, kind, random)
            call random_state(spec, random, state)
            call equation_of_motion(spec, state, mass, expected)
            call assemble_matrices(column_of(state), .false., matrices, outcome)
            call check_passed(error, outcome, 'matrices')
            force = expected
            call matrices%accelerations(force, expected, outcome)
            call check_passed(error, outcome, 'accelerations')
            call now%create(state%motion%structure)
            call state%motion%acceleration(state%springs, state%q, state%v, state%load, now)
            ! Round-off of the dense solution grows with the condition of M.
            call check_close(error, now%a, expected, 0.0_wp, 1.0e-11_wp*maxval(abs(expected)), &
                             'n = '//to_text(n)//', variant '//to_text(kind)//', acceleration')
            if (allocated(error)) return
         end do
      end do
   end subroutine dense

   !> d(kinetic energy + potential)/dt + power of the springs = power of loads - power of damping. Both
   !> energies are quadratic, so a central difference over any distance is their derivative.
   subroutine power(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      type(state_type) :: state
      type(motion_result) :: now
      real(wp), allocatable :: a(:)
      real(wp) :: of_motion, of_potential, of_springs, of_loads, of_damping
      integer :: i, kind, n

      do n = 1, 6
         do kind = 0, 127
            call random_state(variant(n, kind, random), random, state)
            call now%create(state%motion%structure)
            associate (motion => state%motion, column => state%motion%structure, q => state%q, v => state%v)
               call motion%acceleration(state%springs, q, v, state%load, now)
               of_loads = column%power_of_loads(q, v, state%load)
               of_damping = motion%damping_power(state%springs, q, v)
               ! Steps of the size of q and v lose no digits.
               a = 1.0e-5_wp*now%a
               of_motion = 0.5e5_wp*(column%kinetic_energy(q, v + a) - column%kinetic_energy(q, v - a))
               of_potential = 50.0_wp*(column%potential_energy(q + 0.01_wp*v) &
                                       - column%potential_energy(q - 0.01_wp*v))
               of_springs = sum([(state%springs%force(i)*v(i), i=1, size(v))])
            end associate
            call check_close(error, of_motion + of_potential + of_springs, of_loads - of_damping, 0.0_wp, &
                             1.0e-10_wp*(abs(of_motion) + abs(of_potential) + abs(of_springs) &
                                         + abs(of_loads) + abs(of_damping)), &
                             'n = '//to_text(n)//', variant '//to_text(kind)//', power')
            call check_true(error, of_damping >= 0.0_wp, 'damping gives energy')
            if (allocated(error)) return
         end do
      end do
   end subroutine power

   subroutine bodies(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      integer :: kind, n

      do n = 1, 6
         do kind = 0, 7
            call check_bodies(error, made(variant(n, kind, random)), random)
         end do
      end do
   end subroutine bodies

   !> Deformations and displacements are inverse to each other, the forces on the bodies are the transpose;
   !> the kinetic energy of the bodies is half of v M v of the joints.
   subroutine check_bodies(error, column, random)
      type(error_type), allocatable, intent(inout) :: error
      class(column_type), intent(in) :: column
      type(random_type), intent(inout) :: random
      real(wp), dimension(column%unknowns) :: v, x, back, f, pull, g, dead
      real(wp) :: none(0)
      real(wp), parameter :: unloaded(4) = 0.0_wp
      real(wp) :: mass(column%unknowns, column%unknowns)
      integer :: n

      n = column%n
      v = random%uniform_array(-1.0_wp, 1.0_wp, column%unknowns)
      pull = random%uniform_array(-1.0_wp, 1.0_wp, column%unknowns)
      f = pull
      call column%unknown_rates(v, x)
      call column%spring_rates(unloaded(:0), x, back)
      call check_close(error, back, v, 0.0_wp, 1.0e-14_wp, 'there and back')
      call column%forces(v, unloaded, unloaded(:0), unloaded(:0), f, g, none)
      f = 0.0_wp*f
      call column%forces(v, unloaded, unloaded(:0), unloaded(:0), f, dead, none)
      g = g - dead
      call check_close(error, dot_product(g, x), -dot_product(pull, v), 0.0_wp, &
                       1.0e-13_wp*(1.0_wp + maxval(abs(dead))), 'equal works')
      call check_close(error, x(2*n - 1) + column%upper(n)*x(2*n), dot_product(column%arm, v), 0.0_wp, &
                       1.0e-14_wp, 'velocity of the top')
      call symmetric_mass(column, mass)
      call check_close(error, column%kinetic_energy(0.0_wp*v, v), 0.5_wp*dot_product(v, matmul(mass, v)), &
                       1.0e-13_wp, 0.0_wp, 'kinetic energy')
   end subroutine check_bodies

   !> `one_body` only chooses the method of computation.
   subroutine fast_step(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      type(column_record) :: spec
      class(column_type), allocatable :: column
      type(state_type) :: state
      type(loads_type) :: loads
      type(rk4_scheme) :: fast, slow
      real(wp) :: q(2), v(2)
      integer :: trial

      do trial = 1, 200
         spec = rich_column(1, merge('pdelta', 'small ', mod(trial, 2) == 0), .false., random)
         if (mod(trial, 3) == 0) spec%top_mass = random%uniform(100.0_wp, 2000.0_wp)
         column = made(spec)
         call fast%create(column)
         call slow%create(column)
         loads = loads_type()
         if (mod(trial, 5) /= 0) then
            loads%signal(lateral) = signal_of([0.0_wp, 1.0_wp], [random%uniform(-1.0e6_wp, 1.0e6_wp), 0.0_wp])
         end if
         if (mod(trial, 7) /= 0) then
            loads%signal(horizontal) = signal_of([0.0_wp, 1.0e-4_wp, 1.0_wp], [3.0_wp, 0.0_wp, 0.0_wp])
         end if
         q = random%uniform_array(-1.0e-2_wp, 1.0e-2_wp, 2)
         v = random%uniform_array(-1.0_wp, 1.0_wp, 2)
         call new_state(state, column, loads, q, v)
         call check_true(error, associated(state%motion%one_body), 'the fast step is taken')
         call fast%attempt(state, 2.0e-4_wp)
         state%motion%one_body => null()
         call slow%attempt(state, 2.0e-4_wp)
         call check_close(error, fast%q, slow%q, 0.0_wp, 1.0e-14_wp*maxval(abs(slow%q)), 'deformation')
         call check_close(error, fast%v, slow%v, 0.0_wp, 1.0e-13_wp*maxval(abs(slow%v)), 'velocity')
         call check_close(error, fast%of_loads, slow%of_loads, 1.0e-11_wp, 1.0e-12_wp, 'work of the loads')
         ! The computation for all columns, power by power
         state%motion%plain = .false.
         call slow%attempt(state, 2.0e-4_wp)
         call check_close(error, fast%v, slow%v, 0.0_wp, 1.0e-13_wp*maxval(abs(slow%v)), 'velocity again')
         call check_close(error, fast%of_loads, slow%of_loads, 1.0e-11_wp, 1.0e-12_wp, 'work again')
         call check_same(error, fast%load, slow%load, 'loads at the end')
      end do
   end subroutine fast_step

end module test_chain
