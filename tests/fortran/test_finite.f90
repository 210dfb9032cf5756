!> Exact rotations, body by body: against the dense method of module `exact`, eq 4, and invariants.
module test_finite
   use check, only: unit_test, check_close, check_same
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_structure_column_column, only: column_type
   use rbs_structure_column_finite, only: finite_chain_type
   use rbs_structure_column_column_record, only: column_record
   use rbs_structure_structure, only: motion_result, lateral
   use exact, only: point, variant, state, sample, variant_of, random_state, place, dense_acceleration
   use samples, only: elastic, made, random_type
   implicit none
   private

   public :: collect_finite

contains

   subroutine collect_finite(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('accelerations against M = sum J'' diag(m, m, I) J', accelerations), &
               unit_test('closed joints are open ones held by their reactions', reactions), &
               unit_test('power balance of loads, springs, potential and damping', power_balance), &
               unit_test('velocity and acceleration of the top', moving_top), &
               unit_test('potential of axial load and weight from the heights', potential), &
               unit_test('potential of small rotations, without cancellation', small_potential)]
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
         do i = 0, 3
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
         do i = 0, 3
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
               call add(spec%axial_load*points(n + 1)%y%d(1))
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

   !> Velocity and acceleration of the top are derivatives of its displacement; a fixed top moves along
   !> its own directions.
   subroutine moving_top(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp), parameter :: h = 1.0e-4_wp
      type(random_type) :: random
      type(column_record) :: spec
      class(column_type), allocatable :: column
      type(state) :: now
      real(wp) :: x(-1:1)
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
         call check_close(error, column%speed(lateral, now%q, now%v), (x(1) - x(-1))/(2.0_wp*h), 1.0e-6_wp, &
                          1.0e-6_wp, 'velocity')
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

      do i = 2, 3
         spec = sample(5, variant_of(i))
         column = made(spec)
         now = random_state(column, random)
         call place(spec, now%q, now%v, now%v, points)
         call place(spec, 0.0_wp*now%q, now%v, now%v, straight)
         energy = 0.0_wp
         energy = spec%axial_load*(points(6)%y%d(0) - straight(6)%y%d(0))
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

end module test_finite
