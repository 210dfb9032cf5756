!> The implicit steppers: orders, damping of high frequencies, energy, stiff
!> chains, contact, and the recovery from a step that fails.
module test_implicit
   use check, only: unit_test, check_close, check_equal, check_failed, check_passed, check_same, check_true
   use rbs_base_error, only: error_type, analysis_failed
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_structure_column_column, only: column_type
   use rbs_solve_time_implicit, only: implicit_stepper, new_newmark, new_hht, new_generalised_alpha
   use rbs_loading_loads, only: loads_type, lateral, horizontal, vertical, top_axial
   use rbs_solve_time_state, only: state_type
   use rbs_structure_column_column_record, only: column_record
   use runs, only: scene_type, new_scene, new_mass, play, play_located, find_reference, new_state, &
                   signal_of, check_order, residual_of, distance
   use samples, only: set_value, value_of, chain, column_1, compression, elastic, made, random_type, takeda_1
   implicit none
   private

   public :: collect_implicit

   !> Newmark, HHT with two radii, generalised-alpha with four.
   integer, parameter :: methods = 7
   real(wp), parameter :: radius(methods) = [1.0_wp, 0.5_wp, 0.9_wp, 1.0_wp, 0.8_wp, 0.5_wp, 0.0_wp]

contains

   subroutine collect_implicit(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('infinite frequency: the spectral radius of the input', high_frequency), &
               unit_test('order 2 through yielding and unloading', yielding_order), &
               unit_test('average acceleration keeps the energy of elastic chains', elastic_energy), &
               unit_test('axial load and vertical motion in time, against rk45', axial_history), &
               unit_test('stiff chains that yield', stiff_yielding), &
               unit_test('a chain of contacts falls onto its base', impact), &
               unit_test('a step that fails names spring and time, and has no effect', no_trace), &
               unit_test('steps of all lengths in any order', halves), &
               unit_test('very short steps from an initial velocity alone', short_steps)]
   end subroutine collect_implicit

   !> One of the methods by number.
   type(implicit_stepper) function method(number) result(stepper)
      integer, intent(in) :: number

      select case (number)
      case (1)
         stepper = new_newmark()
      case (2, 3)
         stepper = new_hht(radius(number))
      case default
         stepper = new_generalised_alpha(radius(number))
      end select
   end function method

   !> At h omega -> infinity all three roots of generalised-alpha are -rho, those of HHT -rho twice and
   !> -alpha_f/(1 - alpha_f): w_{i+3} + c2 w_{i+2} + c1 w_{i+1} + c0 w_i = 0 with these roots.
   subroutine high_frequency(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(scene_type) :: scene
      type(state_type) :: state
      type(implicit_stepper) :: stepper
      real(wp) :: w(0:12), third, rho, h, rest
      integer :: number, step

      do number = 1, methods
         call new_mass(scene, elastic(800.0_wp), 2.0_wp, 0.1_wp, 0.0_wp)
         h = 1.0e6_wp*sqrt(2.0_wp/800.0_wp)
         call new_state(state, scene%column, scene%loads, scene%q, scene%v)
         stepper = method(number)
         w(0) = scene%q(3)
         do step = 1, 12
            call stepper%advance(state, h, outcome)
            call check_passed(error, outcome, 'step')
            w(step) = state%q(3)
         end do
         rho = radius(number)
         third = rho
         if (number < 4) third = (1.0_wp - rho)/(2.0_wp*rho)
         do step = 0, 9
            rest = w(step + 3) + (2.0_wp*rho + third)*w(step + 2) + (rho**2 + 2.0_wp*rho*third)*w(step + 1) &
                   + rho**2*third*w(step)
            call check_close(error, rest, 0.0_wp, 0.0_wp, 1.0e-8_wp*maxval(abs(w)), &
                             'method '//to_text(number))
         end do
         if (number > 3 .and. rho < 0.6_wp) then
            call check_true(error, abs(w(12)) < 0.3_wp*abs(w(0)), 'the motion decays')
         end if
      end do
   end subroutine high_frequency

   !> A line ends at a random place within the step: order 2 in the mean over five halvings.
   subroutine yielding_order(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(scene_type) :: scene
      type(state_type) :: reference, state
      type(implicit_stepper) :: stepper
      character(len=:), allocatable :: place
      real(wp) :: wrong(6)
      integer :: i, number, scene_number

      do scene_number = 1, 5
         call new_scene(scene, scene_number)
         call find_reference(scene, reference, error)
         do number = 1, methods, 2
            place = 'scene '//to_text(scene_number)//', method '//to_text(number)
            do i = 1, 6
               stepper = method(number)
               call play(scene, stepper, merge(360, 1500, scene%column%n == 1)*2**(i - 1), state, outcome)
               call check_passed(error, outcome, 'scene '//to_text(scene_number))
               wrong(i) = distance(state, reference)
            end do
            call check_order(error, wrong(2:), 1.4_wp, 2.6_wp, place)
            call check_true(error, wrong(6) < 3.0e-3_wp, place//': error '//to_text(wrong(6)))
            if (allocated(error)) return
         end do
      end do
   end subroutine yielding_order

   !> Work of the loads, of damping and of the springs by the trapezoidal rule balances exactly.
   subroutine elastic_energy(error)
      type(error_type), allocatable, intent(inout) :: error
      integer, parameter :: bodies(4) = [1, 3, 20, 100]
      type(error_type), allocatable :: outcome
      type(random_type) :: random
      type(column_record) :: spec
      class(column_type), allocatable :: column
      type(loads_type) :: loads
      type(state_type) :: state
      type(implicit_stepper) :: stepper
      real(wp) :: largest
      integer :: i, kind, m, step

      do i = 1, 4
         do kind = 0, 3
            spec = chain(bodies(i), 'pdelta')
            spec%axial_load = 1.0e5_wp
            spec%self_weight = .true.
            spec%top_mass = 300.0_wp
            if (btest(kind, 0)) then
               spec%damping%mass = 3.0_wp
               spec%damping%stiffness = 1.0e-4_wp
            end if
            if (btest(kind, 1)) then
               allocate (spec%axial_spring(1))
               spec%axial_spring(1) = elastic(2.0e9_wp)
            end if
            column = made(spec)
            m = column%unknowns
            loads%signal(lateral) = signal_of([0.0_wp, 0.013_wp, 0.1_wp], [0.0_wp, 1.0e6_wp, -1.0e6_wp])
            loads%signal(horizontal) = signal_of([0.0_wp, 0.017_wp, 0.1_wp], [3.0_wp, -5.0_wp, 9.0_wp])
            call new_state(state, column, loads, spread(0.0_wp, 1, m), &
                           random%uniform_array(-1.0_wp, 1.0_wp, m))
            largest = state%at_begin
            stepper = method(1)
            do step = 1, 100
               call stepper%advance(state, 1.0e-3_wp, outcome)
               call check_passed(error, outcome, 'step')
               largest = max(largest, sum(state%springs%work))
               call check_close(error, residual_of(state), 0.0_wp, 0.0_wp, 1.0e-11_wp*largest, &
                                'n = '//to_text(bodies(i))//', kind '//to_text(kind)//': energy')
            end do
            call check_equal(error, stepper%cut_steps, 0, 'no step is cut')
            if (allocated(error)) return
         end do
      end do
   end subroutine elastic_energy

   !> All four loads on a column with axial springs.
   subroutine axial_history(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      type(scene_type) :: scene
      type(state_type) :: reference, state
      type(implicit_stepper) :: stepper
      real(wp) :: wrong(4), time(5)
      integer :: i, number, kind

      do kind = 1, 2
         spec = chain(3, 'pdelta')
         spec%axial_load = 1.0e7_wp
         spec%self_weight = .true.
         spec%damping%stiffness = 1.0e-5_wp
         if (kind == 2) then
            allocate (spec%axial_spring(1))
            spec%axial_spring(1) = elastic(2.0e9_wp)
         end if
         scene = scene_type()
         scene%column = made(spec)
         allocate (scene%q(scene%column%unknowns), scene%v(scene%column%unknowns), source=0.0_wp)
         scene%finish = 0.04_wp
         time = scene%finish*[0.0_wp, 0.25_wp, 0.5_wp, 0.75_wp, 1.0_wp]
         scene%loads%signal(lateral) = signal_of(time, 1.0e5_wp*[0.0_wp, 1.0_wp, -1.0_wp, 2.0_wp, 0.0_wp])
         scene%loads%signal(horizontal) = signal_of(time, [0.0_wp, 5.0_wp, -5.0_wp, 0.0_wp, 5.0_wp])
         scene%loads%signal(vertical) = signal_of(time, 1.0e4_wp*[0.0_wp, 1.0_wp, 0.0_wp, -1.0_wp, 0.0_wp])
         scene%loads%signal(top_axial) = signal_of(time, 1.0e7_wp*[0.0_wp, 1.0_wp, 1.0_wp, -2.0_wp, 0.0_wp])
         call play_located(scene, 1.0e-12_wp, 1, reference, outcome)
         call check_passed(error, outcome, 'reference')
         call check_close(error, residual_of(reference)/reference%of_loads, 0.0_wp, 0.0_wp, 1.0e-9_wp, &
                          'energy of the reference')
         do number = 1, methods, 2
            do i = 1, 4
               stepper = method(number)
               call play(scene, stepper, 500*2**i, state, outcome)
               call check_passed(error, outcome, 'method '//to_text(number))
               wrong(i) = distance(state, reference)
            end do
            call check_order(error, wrong(2:), 1.85_wp, 2.15_wp, 'kind '//to_text(kind)//', method '// &
                             to_text(number))
            call check_true(error, wrong(4) < 1.0e-2_wp, 'error '//to_text(wrong(4)))
            call check_true(error, abs(residual_of(state)) < 1.0e-3_wp*sum(state%springs%work), 'energy')
         end do
      end do
   end subroutine axial_history

   !> Many springs change their lines in one step: it is not cut, and the energy has the order of the step.
   subroutine stiff_yielding(error)
      type(error_type), allocatable, intent(inout) :: error
      integer, parameter :: bodies(2) = [200, 1000]
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      type(scene_type) :: scene
      type(state_type) :: state
      type(implicit_stepper) :: stepper
      real(wp) :: share
      integer :: i

      do i = 1, 2
         spec = column_1('pdelta')
         spec%n = bodies(i)
         share = 1.0_wp/bodies(i)
         ! The flexibility of one joint, distributed over all; shear is elastic.
         spec%shear(1) = elastic(value_of(spec%shear(1), 'k')*bodies(i))
         call set_value(spec%flexure(1), 'k_c', value_of(spec%flexure(1), 'k_c')*bodies(i))
         call set_value(spec%flexure(1), 'k_y', value_of(spec%flexure(1), 'k_y')*bodies(i))
         call set_value(spec%flexure(1), 'k_u', value_of(spec%flexure(1), 'k_u')*bodies(i))
         call set_value(spec%flexure(1), 'd_c', value_of(spec%flexure(1), 'd_c')*share)
         call set_value(spec%flexure(1), 'd_y', value_of(spec%flexure(1), 'd_y')*share)
         spec%axial_load = 5.0e5_wp
         spec%top_mass = 2.0e4_wp
         spec%damping%stiffness = 1.0e-3_wp
         scene = scene_type()
         scene%column = made(spec)
         allocate (scene%q(2*bodies(i)), scene%v(2*bodies(i)), source=0.0_wp)
         scene%finish = 0.5_wp
         scene%loads%signal(horizontal) = signal_of(0.1_wp*[0.0_wp, 1.0_wp, 2.0_wp, 3.0_wp, 4.0_wp, 5.0_wp], &
                                        [0.0_wp, 20.0_wp, -25.0_wp, 20.0_wp, -15.0_wp, 10.0_wp])
         stepper = method(5)
         call play(scene, stepper, 100, state, outcome)
         call check_passed(error, outcome, 'n = '//to_text(bodies(i)))
         call check_true(error, state%springs%events > bodies(i), 'springs change their lines: '// &
                         to_text(state%springs%events))
         call check_true(error, stepper%cut_steps <= 2, 'cut steps: '//to_text(stepper%cut_steps))
         call check_true(error, abs(residual_of(state)) < 0.05_wp*state%of_damping, 'energy')
      end do
   end subroutine stiff_yielding

   !> Twenty loose blocks fall onto each other, with steps far beyond the limit of explicit methods.
   subroutine impact(error)
      type(error_type), allocatable, intent(inout) :: error
      integer, parameter :: n = 20
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      type(scene_type) :: scene
      type(state_type) :: state
      type(implicit_stepper) :: stepper
      real(wp) :: energy
      integer :: number, step

      spec = chain(n, 'small')
      allocate (spec%axial_spring(1))
      spec%axial_spring(1) = compression(1.0e9_wp)
      spec%self_weight = .true.
      spec%damping%stiffness = 1.0e-4_wp
      scene%column = made(spec)
      allocate (scene%q(3*n), scene%v(3*n), source=0.0_wp)
      scene%q(2*n + 1:) = 0.01_wp
      do number = 1, methods
         call new_state(state, scene%column, scene%loads, scene%q, scene%v)
         stepper = method(number)
         energy = state%at_begin
         do step = 1, 1000
            call stepper%advance(state, 2.0e-3_wp, outcome)
            call check_passed(error, outcome, 'method '//to_text(number))
            call check_true(error, all(abs(state%q) < 1.0_wp), 'method '//to_text(number)//': unbounded')
            if (allocated(error)) return
         end do
         ! At rest each joint is closed by the weight above over its stiffness.
         if (number == 5 .or. number == 6) then
            call check_close(error, state%q(2*n + 1:), -scene%column%axial_joint/1.0e9_wp, 0.0_wp, &
                             1.0e-7_wp, 'method '//to_text(number)//': they lie')
         end if
      end do
   end subroutine impact

   !> Force a step to fail in the middle of a run, after all its work; then continue.
   subroutine no_trace(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(scene_type) :: scene
      type(state_type) :: state, plain, before
      type(implicit_stepper) :: stepper, undisturbed
      real(wp) :: wanted, acceptable, h
      integer :: number, scene_number, step

      do scene_number = 1, 5
         call new_scene(scene, scene_number)
         h = 4.0e-4_wp
         do number = 1, methods, 4
            call new_state(state, scene%column, scene%loads, scene%q, scene%v)
            call new_state(plain, scene%column, scene%loads, scene%q, scene%v)
            stepper = method(number)
            undisturbed = method(number)
            wanted = stepper%wanted
            acceptable = stepper%acceptable
            do step = 1, 120
               call undisturbed%advance(plain, h, outcome)
               call check_passed(error, outcome, 'undisturbed')
               if (mod(step, 10) == 0) then
                  before = state
                  stepper%wanted = -1.0_wp
                  stepper%acceptable = -1.0_wp
                  call stepper%advance(state, h, outcome)
                  call check_failed(error, outcome, analysis_failed, &
                                    's at time '//to_text(before%time)//' s does not converge although')
                  call check_failed(error, outcome, analysis_failed, ' spring of joint ')
                  ! If there is an error already, nothing moves.
                  call stepper%advance(state, h, outcome)
                  call check_same(error, [state%q, state%v, state%time, state%load, state%of_loads, &
                                          state%of_damping], &
                                  [before%q, before%v, before%time, before%load, before%of_loads, &
                                   before%of_damping], 'state')
                  associate (now => state%springs, then => before%springs)
                     call check_same(error, [now%d, now%d0, now%f0, now%k, now%first, now%last, now%work], &
                                     [then%d, then%d0, then%f0, then%k, then%first, then%last, then%work], &
                                     'springs')
                     call check_equal(error, now%events, then%events, 'events')
                     call check_true(error, all(now%unload_on_reversal == then%unload_on_reversal), &
                                     'one-way lines')
                  end associate
                  stepper%wanted = wanted
                  stepper%acceptable = acceptable
                  deallocate (outcome)
               end if
               call stepper%advance(state, h, outcome)
               call check_passed(error, outcome, 'go on')
               call check_same(error, [state%q, state%v, state%time, state%of_loads, state%springs%work], &
                               [plain%q, plain%v, plain%time, plain%of_loads, plain%springs%work], &
                               'scene '//to_text(scene_number)//', method '//to_text(number))
               if (allocated(error)) return
            end do
            call check_true(error, state%springs%events > 10, 'the springs change their lines')
         end do
      end do
   end subroutine no_trace

   !> Steps that differ by four orders of magnitude, on a column whose springs have many lines.
   subroutine halves(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(random_type) :: random
      type(column_record) :: spec
      class(column_type), allocatable :: column
      type(state_type) :: state
      type(implicit_stepper) :: stepper
      real(wp) :: q(6), v(6)
      integer :: trial

      spec = column_1('pdelta')
      spec%n = 3
      spec%axial_load = 2.0e6_wp
      spec%flexure(1) = takeda_1('one')
      column = made(spec)
      q = 0.0_wp
      do trial = 1, 20
         v = random%uniform_array(-5.0_wp, 5.0_wp, 6)
         v(:3) = 0.1_wp*v(:3)
         call new_state(state, column, loads_type(), q, v)
         stepper = method(1 + mod(trial, methods))
         do while (state%time < 0.05_wp)
            call stepper%advance(state, 10.0_wp**random%uniform(-6.0_wp, -2.0_wp), outcome)
            call check_passed(error, outcome, 'trial '//to_text(trial))
            if (allocated(error)) return
            call check_same(error, state%springs%d, state%q, 'the springs are where the joints are')
            call check_true(error, all(abs(state%q) < 1.0_wp), 'bounded')
         end do
      end do
   end subroutine halves

   !> At the start there are no forces, and those of the first step are small differences of large numbers:
   !> only the velocity shows the size of round-off.
   subroutine short_steps(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      class(column_type), allocatable :: column
      type(state_type) :: state
      type(implicit_stepper) :: stepper
      real(wp), parameter :: h(5) = [1.0e-4_wp, 1.0e-5_wp, 1.0e-6_wp, 1.0e-7_wp, 1.0e-8_wp]
      real(wp), allocatable :: v(:)
      integer, parameter :: bodies(3) = [1, 3, 20]
      integer :: i, j, number, step

      do j = 1, 3
         column = made(chain(bodies(j), 'small'))
         allocate (v(2*bodies(j)), source=0.0_wp)
         v(bodies(j) + 1) = -0.5_wp
         do i = 1, 5
            do number = 1, methods
               call new_state(state, column, loads_type(), 0.0_wp*v, v)
               stepper = method(number)
               do step = 1, 5
                  call stepper%advance(state, h(i), outcome)
                  call check_passed(error, outcome, 'step of '//to_text(h(i))//' s')
               end do
               call check_equal(error, stepper%cut_steps, 0, 'n = '//to_text(bodies(j))//', method '// &
                                to_text(number)//', step of '//to_text(h(i))//' s: cut steps')
               ! The time is too short for the column to stop.
               if (h(i) < 2.0e-7_wp) then
                  call check_close(error, state%q(bodies(j) + 1), 5.0_wp*h(i)*v(bodies(j) + 1), 1.0e-2_wp, &
                                   0.0_wp, 'rotation')
                  call check_close(error, residual_of(state), 0.0_wp, 0.0_wp, 1.0e-2_wp*state%at_begin, &
                                   'energy')
               end if
               if (allocated(error)) return
            end do
         end do
         deallocate (v)
      end do
   end subroutine short_steps

end module test_implicit
