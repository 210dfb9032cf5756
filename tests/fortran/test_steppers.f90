!> The explicit steppers: closed forms through contact and yielding, observed orders with located events,
!> errors in proportion to the tolerance, events in difficult places, any units.
module test_steppers
   use check, only: unit_test, check_close, check_equal, check_failed, check_passed, check_same, check_true
   use rbs_base_constants, only: pi
   use rbs_base_error, only: error_type, analysis_failed
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_structure_column_column, only: column_type
   use rbs_solve_modal_modes, only: modes_type, find_modes
   use rbs_loading_loads, only: loads_type, lateral
   use rbs_solve_time_located, only: located_stepper
   use rbs_solve_time_pair45, only: pair45_scheme
   use rbs_solve_time_rk4, only: rk4_stepper
   use rbs_solve_time_state, only: state_type
   use rbs_structure_column_column_record, only: column_record
   use runs, only: scene_type, scenes, new_scene, new_mass, play, play_located, find_reference, new_state, &
                   new_located, signal_of, check_order, residual_of, distance
   use samples, only: bilinear, chain, column_1, compression, made, random_type, takeda_1, d_y
   implicit none
   private

   public :: collect_steppers

contains

   subroutine collect_steppers(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('a bouncing contact: closed form', bounce), &
               unit_test('a bilinear spring, yielding both ways: closed form', yielding), &
               unit_test('located rk4 without events is rk4, to the last bit', no_events), &
               unit_test('orders of located and plain steps, errors of rk45, energies', orders), &
               unit_test('the pair: order 5, and an estimate of order 5', pair_order), &
               unit_test('an event at the exact end of a step', exact_end), &
               unit_test('a contact that is just touched', grazing), &
               unit_test('several springs at the same instant', at_once), &
               unit_test('many springs, shortly after each other', in_a_row), &
               unit_test('start on the end of a line', begin_on_end), &
               unit_test('start with a velocity against a one-way line', against_one_way), &
               unit_test('start at rest, on the yield plateau', rest_on_line), &
               unit_test('ever smaller Takeda loops', small_loops), &
               unit_test('events are counted once', counted), &
               unit_test('a tolerance that cannot be met: an error, the last good state', hopeless)]
   end subroutine collect_steppers

   !> A mass falls on a spring, is thrown back, flies under a constant load and falls again.
   subroutine bounce(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(scene_type) :: scene
      type(state_type) :: state
      real(wp), parameter :: mass = 2.0_wp, k = 800.0_wp, v0 = 3.0_wp, push = 20.0_wp
      real(wp) :: omega, sag, radius, flight, contact, wrong(4)
      integer :: i

      call new_mass(scene, compression(k), mass, 0.0_wp, v0)
      scene%column%axial_load = push
      scene%column%axial_joint = push
      omega = sqrt(k/mass)
      sag = push/k
      radius = hypot(sag, v0/omega)
      flight = 2.0_wp*v0*mass/push
      contact = (2.0_wp*pi - 2.0_wp*acos(sag/radius))/omega
      scene%finish = 5.0_wp*(flight + contact) + 0.5_wp*flight
      do i = 1, 4
         call play_located(scene, 0.0_wp, 800*2**i, state, outcome)
         call check_passed(error, outcome, 'rk4')
         wrong(i) = abs(state%q(3)/(0.5_wp*v0**2*mass/push) - 1.0_wp) + abs(state%v(3))/v0
      end do
      call check_order(error, wrong, 3.8_wp, 4.5_wp, 'rk4')
      call check_true(error, wrong(4) < 1.0e-6_wp, 'rk4: error')
      do i = 6, 12, 2
         call play_located(scene, 10.0_wp**(-i), 1, state, outcome)
         call check_passed(error, outcome, 'rk45')
         call check_close(error, [state%q(3), state%v(3)], [0.5_wp*v0**2*mass/push, 0.0_wp], 0.0_wp, &
                          1.0e3_wp*10.0_wp**(-i), 'rk45 with 1e-'//to_text(i))
      end do
      ! The spring has returned all work.
      call check_close(error, state%springs%work(3), 0.0_wp, 0.0_wp, 1.0e-9_wp, 'work of the contact')
      call check_equal(error, state%springs%events, 11, 'opened six times, closed five times')
   end subroutine bounce

   !> Yield, turn, yield in the other direction, turn, and a quarter of the elastic period back: on each line
   !> the motion is harmonic.
   subroutine yielding(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(scene_type) :: scene
      type(state_type) :: state
      real(wp), parameter :: mass = 2.0_wp, k = 800.0_wp, post = 80.0_wp, yield = 0.05_wp, v0 = 4.0_wp
      real(wp), parameter :: omega = sqrt(k/mass), slow = sqrt(post/mass)
      real(wp) :: f, v, w, reach, span, time, wrong(4)
      integer :: i

      time = asin(yield*omega/v0)/omega
      v = sqrt(v0**2 - (yield*omega)**2)
      f = k*yield
      reach = hypot(f/post, v/slow)
      time = time + atan2(v/slow, f/post)/slow
      w = yield - f/post + reach
      f = post*reach
      ! Elastic down by twice the yield deformation, with the amplitude f/k
      span = f/k - 2.0_wp*yield
      time = time + acos(span*k/f)/omega
      v = omega*sqrt((f/k)**2 - span**2)
      w = w - 2.0_wp*yield
      f = k*span
      reach = hypot(f/post, v/slow)
      time = time + atan2(v/slow, -f/post)/slow
      w = w - f/post - reach
      f = -post*reach
      time = time + 0.5_wp*pi/omega
      w = w - f/k

      call new_mass(scene, bilinear(k, yield, post), mass, 0.0_wp, v0)
      scene%finish = time
      do i = 1, 4
         call play_located(scene, 0.0_wp, 80*2**i, state, outcome)
         call check_passed(error, outcome, 'rk4')
         wrong(i) = abs(state%q(3) - w)/yield
      end do
      call check_order(error, wrong, 3.7_wp, 4.8_wp, 'rk4')
      call check_true(error, wrong(4) < 1.0e-5_wp, 'rk4: error '//to_text(wrong(4)))
      do i = 6, 12, 2
         call play_located(scene, 10.0_wp**(-i), 1, state, outcome)
         call check_passed(error, outcome, 'rk45')
         call check_close(error, [state%q(3), state%v(3)], [w, omega*abs(f)/k], 0.0_wp, &
                          1.0e3_wp*10.0_wp**(-i), 'rk45 with 1e-'//to_text(i))
      end do
      call check_close(error, residual_of(state), 0.0_wp, 0.0_wp, 1.0e-10_wp*mass*v0**2, 'energy')
   end subroutine yielding

   !> Elastic springs have no ends: the steps are the same, bit for bit.
   subroutine no_events(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(scene_type) :: scene
      type(state_type) :: located, plain
      type(rk4_stepper) :: stepper
      integer, parameter :: bodies(3) = [1, 2, 5]
      integer :: i, m

      do i = 1, 3
         scene = scene_type()
         scene%column = made(chain(bodies(i), 'small'))
         m = scene%column%unknowns
         ! A binary fraction: no round-off in the times
         scene%finish = 2.0_wp**(-7)
         scene%loads%signal(lateral) = signal_of(scene%finish*[0.0_wp, 1.0_wp], [0.0_wp, 1.0e5_wp])
         allocate (scene%q(m), scene%v(m), source=0.0_wp)
         scene%v(1) = 1.0_wp
         call play_located(scene, 0.0_wp, 2048, located, outcome)
         call check_passed(error, outcome, 'located')
         stepper = rk4_stepper()
         call stepper%scheme%create(scene%column)
         call play(scene, stepper, 2048, plain, outcome)
         call check_passed(error, outcome, 'step')
         call check_same(error, located%q, plain%q, 'deformation')
         call check_same(error, located%v, plain%v, 'velocity')
         call check_same(error, located%of_loads, plain%of_loads, 'work of the loads')
      end do
   end subroutine no_events

   !> Steps that end at events are of order 4. A change of line at the end of a step reduces the order by two;
   !> the error varies randomly, so the mean over five halvings is taken. Errors of some hundred steps of the
   !> pair add up, and some twenty changes of stiffness increase them.
   subroutine orders(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(scene_type) :: scene
      type(state_type) :: reference, state
      type(rk4_stepper) :: stepper
      character(len=:), allocatable :: name
      real(wp) :: located(5), residual(5), by_step(6), pair(4:12), slope
      integer :: coarse, i, number

      do number = 1, scenes
         call new_scene(scene, number)
         call find_reference(scene, reference, error)
         name = 'scene '//to_text(number)
         coarse = merge(360, 2000, scene%column%n == 1)
         do i = 1, 5
            call play_located(scene, 0.0_wp, coarse*2**(i - 1), state, outcome)
            call check_passed(error, outcome, name//', located')
            located(i) = distance(state, reference)
            residual(i) = abs(residual_of(state))/sum(state%springs%work)
         end do
         call check_order(error, located, 3.7_wp, 4.5_wp, name//', located')
         call check_true(error, located(5) < 2.0e-7_wp, name//', located: error '//to_text(located(5)))
         call check_order(error, residual(:4), 4.0_wp, 6.0_wp, name//', located: energy')
         call check_true(error, residual(4) < 1.0e-8_wp, name//', located: residual')
         call check_equal(error, state%springs%events, reference%springs%events, name//': events')
         do i = 1, 6
            stepper = rk4_stepper()
            call stepper%scheme%create(scene%column)
            call play(scene, stepper, coarse*2**(i - 1), state, outcome)
            call check_passed(error, outcome, name//', by steps')
            by_step(i) = distance(state, reference)
         end do
         call check_order(error, by_step, 1.4_wp, 2.8_wp, name//', by steps')
         do i = 4, 12
            call play_located(scene, 10.0_wp**(-i), 1, state, outcome)
            call check_passed(error, outcome, name//', rk45')
            pair(i) = distance(state, reference)
            call check_true(error, pair(i) < 1.0e4_wp*10.0_wp**(-i), name//', tolerance 1e-'//to_text(i)// &
                            ': error '//to_text(pair(i)))
            call check_close(error, residual_of(state)/sum(state%springs%work), 0.0_wp, 0.0_wp, &
                             10.0_wp**(1 - i), name//', rk45: residual')
         end do
         slope = log10(pair(5)/pair(11))/6.0_wp
         call check_true(error, slope > 0.85_wp .and. slope < 1.2_wp, name// &
                         ': the error goes with the tolerance to the power '//to_text(slope))
         if (allocated(error)) return
      end do
   end subroutine orders

   !> Fixed steps of the pair by hand, without control: a damped chain in its highest mode.
   subroutine pair_order(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      class(column_type), allocatable :: column
      type(modes_type) :: modes
      type(state_type) :: state
      type(pair45_scheme) :: scheme
      real(wp) :: wrong(4), first(4), omega, t, q, v, c
      integer :: i, step, steps

      spec = chain(2, 'small')
      spec%damping%mass = 200.0_wp
      column = made(spec)
      call find_modes(column, modes, outcome)
      call check_passed(error, outcome, 'find_modes')
      c = 0.5_wp*spec%damping%mass
      omega = sqrt(modes%omega(4)**2 - c**2)
      t = 5.0_wp/omega
      q = exp(-c*t)*(cos(omega*t) + c/omega*sin(omega*t))
      v = -exp(-c*t)*(omega + c**2/omega)*sin(omega*t)
      do i = 1, 4
         steps = 10*2**i
         scheme = pair45_scheme()
         call scheme%create(column)
         call check_equal(error, scheme%order, 5, 'order')
         call new_state(state, column, loads_type(), modes%shapes(:, 4), 0.0_wp*modes%shapes(:, 4))
         do step = 1, steps
            call scheme%attempt(state, t/steps)
            if (step == 1) first(i) = maxval(abs(scheme%error_q)) + maxval(abs(scheme%error_v))/omega
            call scheme%accept(state, t/steps)
         end do
         call check_close(error, state%time, t, 1.0e-13_wp, 0.0_wp, 'time')
         wrong(i) = maxval(abs(state%q - q*modes%shapes(:, 4)))/maxval(abs(modes%shapes(:, 4))) &
                    + maxval(abs(state%v - v*modes%shapes(:, 4)))/maxval(abs(modes%shapes(:, 4)))/omega
      end do
      call check_order(error, wrong, 4.8_wp, 5.4_wp, 'errors')
      call check_true(error, wrong(4) < 1.0e-8_wp, 'errors')
      call check_order(error, first, 4.8_wp, 5.4_wp, 'estimates of the first step')
   end subroutine pair_order

   !> Free flight onto a contact: everything is a binary fraction, the contact closes at t = 1 exactly.
   subroutine exact_end(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(scene_type) :: scene
      type(state_type) :: state
      real(wp), parameter :: k = 4.0_wp
      real(wp) :: tolerance
      integer :: way

      do way = 1, 2
         tolerance = merge(0.0_wp, 1.0e-10_wp, way == 1)
         call new_mass(scene, compression(k), 1.0_wp, 1.0_wp, -1.0_wp)
         scene%finish = 1.0_wp
         call play_located(scene, tolerance, 4, state, outcome)
         call check_passed(error, outcome, 'flight')
         call check_close(error, [state%q(3), state%v(3)], [0.0_wp, -1.0_wp], 0.0_wp, 1.0e-15_wp, 'contact')
         ! Half a period in contact, then off with the same speed.
         scene%finish = 4.0_wp
         call play_located(scene, tolerance, 1024, state, outcome)
         call check_passed(error, outcome, 'there and back')
         call check_close(error, [state%q(3), state%v(3)], [3.0_wp - pi/sqrt(k), 1.0_wp], 0.0_wp, 1.0e-9_wp, &
                          'thrown back')
         call check_equal(error, state%springs%events, 3, 'open at the start, closed, opened')
      end do
   end subroutine exact_end

   !> w = (t - t0)^2 - depth under a constant lift: beyond the end and back within a step, or almost.
   subroutine grazing(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(scene_type) :: scene
      type(state_type) :: state
      real(wp), parameter :: depth(9) = [0.0_wp, 1.0e-16_wp, -1.0e-16_wp, 1.0e-12_wp, -1.0e-12_wp, &
                                         1.0e-8_wp, -1.0e-8_wp, 1.0e-4_wp, -1.0e-4_wp]
      real(wp), parameter :: touch(3) = [1.0_wp, 1.1_wp, 1.0_wp + 1.0e-9_wp]
      real(wp) :: w0, v0
      integer :: i, j, way

      do way = 1, 2
         do j = 1, 3
            do i = 1, 9
               w0 = touch(j)**2 - depth(i)
               v0 = -2.0_wp*touch(j)
               call new_mass(scene, compression(10.0_wp), 1.0_wp, w0, v0)
               scene%column%axial_load = -2.0_wp
               scene%column%axial_joint = -2.0_wp
               scene%finish = 2.0_wp
               call play_located(scene, merge(0.0_wp, 1.0e-9_wp, way == 1), 8, state, outcome)
               call check_passed(error, outcome, 'depth '//to_text(depth(i)))
               ! The contact dissipates no energy in any case; a small depth has little effect.
               call check_close(error, 0.5_wp*state%v(3)**2 - 2.0_wp*state%q(3), 0.5_wp*v0**2 - 2.0_wp*w0, &
                                0.0_wp, 1.0e-7_wp + 1.0e-3_wp*sqrt(abs(depth(i))), 'energy')
               call check_close(error, state%q(3), (2.0_wp - touch(j))**2 - depth(i), 0.0_wp, &
                                1.0e-6_wp + 20.0_wp*sqrt(max(depth(i), 0.0_wp)), 'opening')
            end do
         end do
      end do
   end subroutine grazing

   !> Two contacts that close at the same instant, to the last bit; and what follows by the pair.
   subroutine at_once(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      type(scene_type) :: scene
      type(state_type) :: state, reference
      real(wp) :: wrong(4)
      integer :: i

      spec = chain(2, 'small')
      spec%masses = [1.0_wp, 1.0_wp]
      allocate (spec%axial_spring(1))
      spec%axial_spring(1) = compression(100.0_wp)
      scene%column = made(spec)
      allocate (scene%q(6), scene%v(6), source=0.0_wp)
      scene%q(5:6) = 1.0_wp
      scene%v(5:6) = -1.0_wp
      scene%finish = 2.0_wp
      call play_located(scene, 1.0e-12_wp, 1, reference, outcome)
      call check_passed(error, outcome, 'reference')
      do i = 1, 4
         call play_located(scene, 0.0_wp, 40*2**i, state, outcome)
         call check_passed(error, outcome, 'rk4')
         wrong(i) = distance(state, reference)
      end do
      call check_order(error, wrong, 3.7_wp, 5.0_wp, 'rk4')
      call check_close(error, state%v(5)**2 + (state%v(5) + state%v(6))**2, 5.0_wp, 1.0e-6_wp, 0.0_wp, &
                       'kinetic energy, all contacts open again')
      call check_true(error, all(state%q(5:6) > 0.0_wp), 'open')
      call check_close(error, state%q(5:6), reference%q(5:6), 0.0_wp, 1.0e-5_wp, 'openings')
   end subroutine at_once

   !> Blocks thrown at each other in long steps: within one step many contacts open and close, and the first
   !> of these events is known only after they are located.
   subroutine in_a_row(error)
      type(error_type), allocatable, intent(inout) :: error
      integer, parameter :: n = 8
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      type(random_type) :: random
      type(scene_type) :: scene
      type(state_type) :: state
      real(wp) :: wrong(4)
      integer :: i, trial

      spec = chain(n, 'small')
      spec%masses = 1.0_wp
      allocate (spec%axial_spring(1))
      spec%axial_spring(1) = compression(100.0_wp)
      scene%column = made(spec)
      allocate (scene%q(3*n), scene%v(3*n), source=0.0_wp)
      scene%finish = 3.0_wp
      do trial = 1, 5
         scene%q(2*n + 1:) = random%uniform_array(0.0_wp, 0.05_wp, n)
         scene%v(2*n + 1:) = random%uniform_array(-1.0_wp, 0.2_wp, n)
         do i = 1, 4
            call play_located(scene, 0.0_wp, 40*2**i, state, outcome)
            call check_passed(error, outcome, 'rk4')
            wrong(i) = abs(residual_of(state))/state%at_begin
         end do
         call check_true(error, state%springs%events > 20, 'events')
         call check_order(error, wrong, 3.7_wp, 7.0_wp, 'trial '//to_text(trial)//': energy')
         call check_true(error, wrong(4) < 1.0e-5_wp, 'trial '//to_text(trial)//': energy is wrong by '// &
                         to_text(wrong(4)))
      end do
   end subroutine in_a_row

   !> The yield deformation belongs to the yielded line; a spring that turns back there is elastic.
   subroutine begin_on_end(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(scene_type) :: scene
      type(state_type) :: state
      real(wp), parameter :: mass = 2.0_wp, k = 800.0_wp, post = 80.0_wp, yield = 0.05_wp
      real(wp), parameter :: omega = sqrt(k/mass), slow = sqrt(post/mass)
      integer :: method, side
      real(wp) :: s, tolerance

      do method = 1, 2
         tolerance = merge(0.0_wp, 1.0e-12_wp, method == 1)
         do side = -1, 1, 2
            s = side
            ! Inward: elastic, here for three eighths of a period. At rest: the same without velocity.
            call new_mass(scene, bilinear(k, yield, post), mass, s*yield, 0.0_wp)
            scene%finish = 0.75_wp*pi/omega
            call play_located(scene, tolerance, 400, state, outcome)
            call check_passed(error, outcome, 'at rest')
            call check_close(error, state%q(3), s*yield*cos(0.75_wp*pi), 1.0e-9_wp, 0.0_wp, 'from rest')
            call new_mass(scene, bilinear(k, yield, post), mass, s*yield, -s*0.1_wp)
            scene%finish = 0.5_wp*pi/omega
            call play_located(scene, tolerance, 400, state, outcome)
            call check_passed(error, outcome, 'inward')
            call check_close(error, state%q(3), -s*0.1_wp/omega, 1.0e-9_wp, 0.0_wp, 'inward')
            ! Outward: plastic until it turns.
            call new_mass(scene, bilinear(k, yield, post), mass, s*yield, s*1.0_wp)
            scene%finish = atan2(1.0_wp/slow, k*yield/post)/slow
            call play_located(scene, tolerance, 400, state, outcome)
            call check_passed(error, outcome, 'outward')
            call check_close(error, state%q(3), s*(yield - k*yield/post + hypot(k*yield/post, 1.0_wp/slow)), &
                             1.0e-9_wp, 0.0_wp, 'outward')
         end do
      end do
   end subroutine begin_on_end

   !> Yielded by its initial deformation, and with a velocity back: the first step is on the elastic line.
   subroutine against_one_way(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(scene_type) :: scene
      type(state_type) :: state
      type(rk4_stepper) :: stepper
      real(wp), parameter :: mass = 2.0_wp, k = 800.0_wp, post = 80.0_wp, yield = 0.05_wp
      real(wp), parameter :: omega = sqrt(k/mass)
      real(wp) :: amplitude, expected

      call new_mass(scene, bilinear(k, yield, post), mass, 2.0_wp*yield, -0.1_wp)
      ! The amplitude about the point of zero force, which is F/k back, stays within the elastic range 2 d_y.
      amplitude = (k*yield + post*yield)/k
      scene%finish = 0.5_wp/omega
      expected = 2.0_wp*yield - amplitude + amplitude*cos(0.5_wp) - 0.1_wp/omega*sin(0.5_wp)
      call play_located(scene, 1.0e-12_wp, 1, state, outcome)
      call check_passed(error, outcome, 'rk45')
      call check_close(error, state%q(3), expected, 1.0e-10_wp, 0.0_wp, 'rk45')
      call play_located(scene, 0.0_wp, 100, state, outcome)
      call check_passed(error, outcome, 'located')
      call check_close(error, state%q(3), expected, 1.0e-10_wp, 0.0_wp, 'located')
      ! Without location of events only the first step is on the wrong line.
      call stepper%scheme%create(scene%column)
      call play(scene, stepper, 100, state, outcome)
      call check_passed(error, outcome, 'step')
      call check_close(error, state%q(3), expected, 1.0e-3_wp, 0.0_wp, 'step')
   end subroutine against_one_way

   !> Yielded and at rest in equilibrium, or pushed further: no line changes without need.
   subroutine rest_on_line(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(scene_type) :: scene
      type(state_type) :: state
      real(wp), parameter :: mass = 2.0_wp, k = 1024.0_wp, post = 0.0_wp, yield = 0.0625_wp
      integer :: method

      do method = 1, 2
         call new_mass(scene, bilinear(k, yield, post), mass, 2.0_wp*yield, 0.0_wp)
         ! The load is the force of the plateau, to the last bit.
         scene%column%axial_load = -k*yield
         scene%column%axial_joint = -k*yield
         scene%finish = 1.0_wp
         call play_located(scene, merge(0.0_wp, 1.0e-8_wp, method == 1), 10, state, outcome)
         call check_passed(error, outcome, 'rest')
         call check_same(error, state%q, scene%q, 'it stays')
         call check_same(error, state%v, [0.0_wp, 0.0_wp, 0.0_wp], 'at rest')
         ! On the plateau a constant speed is kept, without any event.
         scene%v(3) = 0.25_wp
         call play_located(scene, merge(0.0_wp, 1.0e-8_wp, method == 1), 10, state, outcome)
         call check_passed(error, outcome, 'glide')
         call check_close(error, state%q(3), 2.0_wp*yield + 0.25_wp, 1.0e-14_wp, 0.0_wp, 'it glides')
         call check_equal(error, state%springs%events, 1, 'events')
      end do
   end subroutine rest_on_line

   !> A damped column, cracked and yielded on both sides, comes to rest: every swing crosses zero force, and
   !> each inner loop is smaller than the one before.
   subroutine small_loops(error)
      type(error_type), allocatable, intent(inout) :: error
      character(len=3), parameter :: inner(3) = ['kc ', 'kr ', 'one']
      type(column_record) :: spec
      class(column_type), allocatable :: column
      type(state_type) :: state, reference
      integer :: i

      do i = 1, 3
         spec = column_1('small')
         spec%flexure(1) = takeda_1(trim(inner(i)))
         spec%damping%mass = 20.0_wp
         column = made(spec)
         call swing(0.2_wp, 1.0e-12_wp, 1, reference)
         call swing(0.2_wp, 0.0_wp, 8000, state)
         call check_close(error, state%q, reference%q, 0.0_wp, 1.0e-7_wp*maxval(abs(reference%q)), &
                          inner(i)//': deformation')
         ! exp(-20): the motion has almost vanished.
         call swing(2.0_wp, 1.0e-12_wp, 1, state)
         call check_true(error, all(abs(state%v) < 1.0e-6_wp), inner(i)//': at rest')
         call check_true(error, state%springs%events > 100, inner(i)//': many loops, not '// &
                         to_text(state%springs%events))
         call check_close(error, residual_of(state)/sum(state%springs%work), 0.0_wp, 0.0_wp, 1.0e-10_wp, &
                          inner(i)//': energy')
      end do

   contains

      subroutine swing(finish, tolerance, steps, state)
         real(wp), intent(in) :: finish, tolerance
         integer, intent(in) :: steps
         type(state_type), intent(out) :: state
         type(error_type), allocatable :: outcome
         type(located_stepper) :: stepper
         integer :: step

         call new_state(state, column, loads_type(), [0.0_wp, 4.0_wp*d_y], [0.0_wp, 0.0_wp])
         state%q(2) = -4.0_wp*d_y
         call state%springs%move_all(state%q)
         state%q(2) = -2.0_wp*d_y
         call state%springs%move_all(state%q)
         state%at_begin = sum(state%springs%work)
         call new_located(stepper, column, tolerance, 1.0e-4_wp)
         do step = 1, steps
            call stepper%advance(state, finish/steps, outcome)
            call check_passed(error, outcome, inner(i))
         end do
      end subroutine swing

   end subroutine small_loops

   !> One yield and one turn are two changes of line with every method.
   subroutine counted(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(scene_type) :: scene
      type(state_type) :: state
      type(rk4_stepper) :: stepper

      call new_mass(scene, bilinear(800.0_wp, 0.05_wp, 80.0_wp), 2.0_wp, 0.0_wp, 2.0_wp)
      ! Past the turn, before the other yield
      scene%finish = 0.14_wp
      call stepper%scheme%create(scene%column)
      call play(scene, stepper, 1000, state, outcome)
      call check_passed(error, outcome, 'step')
      call check_equal(error, state%springs%events, 2, 'step: events')
      call play_located(scene, 0.0_wp, 1000, state, outcome)
      call check_passed(error, outcome, 'located')
      call check_equal(error, state%springs%events, 2, 'located: events')
      call play_located(scene, 1.0e-8_wp, 1, state, outcome)
      call check_passed(error, outcome, 'rk45')
      call check_equal(error, state%springs%events, 2, 'rk45: events')
   end subroutine counted

   !> If the shortest step equals the first, the step cannot be reduced.
   subroutine hopeless(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(scene_type) :: scene
      type(state_type) :: state
      type(located_stepper) :: stepper

      call new_scene(scene, 2)
      call new_located(stepper, scene%column, 1.0e-10_wp, 1.0e-3_wp)
      stepper%shortest = 1.0e-3_wp
      call play(scene, stepper, 1, state, outcome)
      call check_failed(error, outcome, analysis_failed, 's does not reach the tolerance of 1e-10')
      call check_failed(error, outcome, analysis_failed, 'spring of joint 1')
      call check_same(error, [state%q, state%v], [scene%q, scene%v], 'the state is that before the step')
      call check_same(error, [state%time, state%of_loads, state%springs%d], spread(0.0_wp, 1, 4), &
                      'so are time, work and springs')
      ! With a shorter shortest step the run continues from there.
      stepper%shortest = 1.0e-9_wp
      deallocate (outcome)
      call stepper%advance(state, scene%finish, outcome)
      call check_passed(error, outcome, 'once more')
   end subroutine hopeless

end module test_steppers
