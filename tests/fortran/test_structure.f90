!> A structure that is no column, and has more springs than unknowns, moves in time: modes and free vibration
!> in closed form by every method, energy, the base, rows, limit states, and runs that go on.
module test_structure
   use check, only: unit_test, check_close, check_equal, check_passed, check_same, check_true
   use rbs_base_constants, only: pi
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_case_analysis_record, only: analysis_record
   use rbs_hysteresis_spring_record, only: spring_record
   use rbs_loading_loads, only: loads_type
   use rbs_output_channels, only: new_channels
   use rbs_output_recorder, only: array_recorder
   use rbs_solve_modal_modes, only: frequency_bounds, stability_limit
   use rbs_solve_task, only: task_type
   use rbs_solve_time_march, only: initial_state
   use rbs_solve_time_plan, only: time_plan
   use rbs_solve_time_run_dynamic, only: plan_dynamic, run_dynamic
   use rbs_solve_time_sight, only: sight_type, watch_type
   use runs, only: check_order, signal_of, times
   use samples, only: bilinear, elastic
   use storeys, only: storeys_type, new_storeys, mass
   implicit none
   private

   public :: collect_structure

   !> Stiffness of the lower storey, the upper one, and of the brace to the upper floor [N/m].
   real(wp), parameter :: k(3) = [4.0e6_wp, 2.0e6_wp, 1.0e6_wp]

   !> Where they yield [m].
   real(wp), parameter :: yields(3) = [0.010_wp, 0.008_wp, 0.030_wp]

   !> Deformations of the springs begin here in a row.
   integer, parameter :: row_springs = 10

contains

   subroutine collect_structure(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('frequencies in closed form', frequencies), &
               unit_test('free vibration in closed form, by every method', free_vibration), &
               unit_test('yielding storeys: methods agree, energies balance, the base', shaken), &
               unit_test('a run goes on as if it had not been cut', goes_on), &
               unit_test('limit states and collapse', limit_states), &
               unit_test('loads that do nothing are refused', refused)]
   end subroutine collect_structure

   !> Circular frequencies [rad/s], and the second floor over the first in both modes.
   pure subroutine find_modes(omega, ratio)
      real(wp), intent(out) :: omega(2), ratio(2)
      real(wp) :: half, product

      ! m1 m2 w^4 - ((k1 + k2) m2 + (k2 + k3) m1) w^2 + (k1 + k2)(k2 + k3) - k2^2 = 0
      half = 0.5_wp*((k(1) + k(2))/mass(1) + (k(2) + k(3))/mass(2))
      product = ((k(1) + k(2))*(k(2) + k(3)) - k(2)**2)/(mass(1)*mass(2))
      omega(2) = sqrt(half + sqrt(half**2 - product))
      omega(1) = sqrt(product)/omega(2)
      ratio = (k(1) + k(2) - mass(1)*omega**2)/k(2)
   end subroutine find_modes

   !> Deformations of the springs from displacements of the floors.
   pure function springs_of(x) result(d)
      real(wp), intent(in) :: x(2)
      real(wp) :: d(3)

      d = [x(1), x(2) - x(1), x(2)]
   end function springs_of

   subroutine frequencies(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(storeys_type) :: structure
      real(wp) :: omega(2), ratio(2), lowest, highest, limit

      call new_storeys(structure, elastic_springs())
      call find_modes(omega, ratio)
      call frequency_bounds(structure, lowest, highest, outcome)
      call check_passed(error, outcome, 'frequencies')
      call check_close(error, [lowest, highest], omega, 1.0e-13_wp, 0.0_wp, 'frequencies')
      call stability_limit(structure, limit, outcome)
      call check_close(error, limit, 2.0_wp*sqrt(2.0_wp)/omega(2), 1.0e-13_wp, 0.0_wp, 'stable step')
   end subroutine frequencies

   function elastic_springs() result(spring)
      type(spring_record) :: spring(3)

      spring(1) = elastic(k(1))
      spring(2) = elastic(k(2))
      spring(3) = elastic(k(3))
   end function elastic_springs

   function yielding_springs() result(spring)
      type(spring_record) :: spring(3)

      spring(1) = bilinear(k(1), yields(1), 4.0e5_wp)
      spring(2) = bilinear(k(2), yields(2), 1.0e5_wp)
      spring(3) = bilinear(k(3), yields(3), 5.0e4_wp)
   end function yielding_springs

   !> Plan and run; the rows are those of every step.
   subroutine run(structure, analysis, time, loads, initial, task, recorder, outcome, sight)
      type(storeys_type), intent(in) :: structure
      type(analysis_record), intent(in) :: analysis
      real(wp), intent(in) :: time(:)
      type(loads_type), intent(in) :: loads
      type(initial_state), intent(in) :: initial
      type(task_type), intent(inout) :: task
      type(array_recorder), intent(out), target :: recorder
      type(error_type), allocatable, intent(out) :: outcome
      type(sight_type), intent(inout), optional :: sight
      type(time_plan) :: plan

      call plan_dynamic(structure, analysis, time, loads, plan, outcome)
      if (allocated(outcome)) return
      recorder%channels = new_channels(structure, .true., .false., .false.)
      task%recorder => recorder
      task%every = 1
      call run_dynamic(structure, analysis, plan, time, loads, initial, task, outcome, sight)
   end subroutine run

   !> Both modes at once, let go with a velocity.
   subroutine free_vibration(error)
      type(error_type), allocatable, intent(inout) :: error
      character(len=17), parameter :: method(5) = [character(len=17) :: 'newmark', 'hht', &
                                                   'generalised_alpha', 'rk4', 'rk45']
      integer, parameter :: order(5) = [2, 2, 2, 4, 0]
      type(error_type), allocatable :: outcome
      type(storeys_type) :: structure
      type(analysis_record) :: analysis
      type(task_type) :: task
      type(array_recorder) :: recorder
      type(initial_state) :: initial
      real(wp) :: omega(2), ratio(2), finish, x(2), wrong(3)
      integer :: i, j

      call new_storeys(structure, elastic_springs())
      call find_modes(omega, ratio)
      initial%deformation = springs_of([0.01_wp + 0.004_wp, 0.01_wp*ratio(1) + 0.004_wp*ratio(2)])
      initial%velocity = springs_of([0.1_wp, 0.1_wp*ratio(1)])
      finish = 2.0_wp*pi/omega(1)
      x = [0.01_wp*cos(omega(1)*finish) + 0.1_wp/omega(1)*sin(omega(1)*finish), &
           0.004_wp*cos(omega(2)*finish)]
      x = [sum(x), sum(x*ratio)]
      do i = 1, size(method)
         do j = 1, 3
            analysis = analysis_record(method=method(i), dt=finish/(100*2**j))
            if (method(i) == 'rk45') analysis%tolerance = 1.0e-7_wp
            task = task_type()
            call run(structure, analysis, [0.0_wp, finish], loads_type(), initial, task, recorder, outcome)
            call check_passed(error, outcome, trim(method(i)))
            if (allocated(error)) return
            associate (last => recorder%rows(row_springs:, recorder%count))
               wrong(j) = maxval(abs(last - springs_of(x)))/maxval(abs(x))
               call check_close(error, last(1) + last(2), last(3), 1.0e-12_wp, 1.0e-14_wp, 'springs fit')
            end associate
         end do
         if (method(i) == 'rk45') then
            call check_true(error, maxval(wrong) < 1.0e-6_wp, 'rk45: error '//to_text(maxval(wrong)))
         else
            call check_order(error, wrong, order(i) - 0.2_wp, order(i) + 0.2_wp, trim(method(i)))
         end if
         if (method(i) == 'newmark' .or. method(i) == 'rk45') then
            call check_true(error, task%summary%residual < 1.0e-6_wp*task%summary%largest, 'energy')
         end if
      end do
   end subroutine free_vibration

   !> A ground motion that makes all springs yield, with damping: the methods come to the same end, energies
   !> balance, and the largest base shear is that of the lower storey and the brace with their damping.
   subroutine shaken(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(storeys_type) :: structure
      type(analysis_record) :: analysis
      type(task_type) :: task, reference
      type(array_recorder) :: recorder, exact
      type(loads_type) :: loads
      real(wp) :: time(401), wrong(3)
      integer :: i

      call new_storeys(structure, yielding_springs())
      time = times(400, 0.01_wp)
      loads%ground = signal_of(time, 30.0_wp*sin(17.0_wp*time)*sin(0.7_wp*time))
      analysis = analysis_record(method='rk4', dt=2.5e-4_wp, events='located')
      call run(structure, analysis, time, loads, initial_state(), reference, exact, outcome)
      call check_passed(error, outcome, 'rk4')
      if (allocated(error)) return
      do i = 1, 3
         call check_true(error, maxval(abs(exact%rows(row_springs + i - 1, :))) > yields(i), 'all yield')
      end do
      call check_true(error, reference%summary%residual < 1.0e-7_wp*reference%summary%largest, 'rk4: energy')
      do i = 1, 3
         analysis = analysis_record(method='newmark', dt=5.0e-3_wp/2**i)
         task = task_type()
         call run(structure, analysis, time, loads, initial_state(), task, recorder, outcome)
         call check_passed(error, outcome, 'newmark')
         if (allocated(error)) return
         wrong(i) = maxval(abs(recorder%rows(row_springs:, recorder%count) &
                               - exact%rows(row_springs:, exact%count)))
         call check_close(error, task%summary%peak_displacement, reference%summary%peak_displacement, &
                          1.0e-2_wp, 0.0_wp, 'peak')
         call check_close(error, task%summary%peak_base_shear, reference%summary%peak_base_shear, &
                          1.0e-2_wp, 0.0_wp, 'base shear')
      end do
      call check_order(error, wrong, 1.0_wp, 4.0_wp, 'newmark')
      structure%mass_damping = 0.5_wp
      structure%stiffness_damping = 1.0e-3_wp
      structure%damped = .true.
      do i = 1, 2
         analysis%method = merge('newmark', 'rk4    ', i == 1)
         analysis%dt = 2.5e-4_wp
         task = task_type()
         call run(structure, analysis, time, loads, initial_state(), task, recorder, outcome)
         call check_passed(error, outcome, 'damped')
         call check_true(error, task%summary%energy%damping > 0.1_wp*task%summary%energy%spring, 'it damps')
         call check_true(error, task%summary%residual < 1.0e-3_wp*task%summary%largest, &
                         'damped: energy '//to_text(task%summary%residual/task%summary%largest))
         if (i == 1) reference%summary = task%summary
      end do
      call check_close(error, task%summary%peak_base_shear, reference%summary%peak_base_shear, 1.0e-4_wp, &
                       0.0_wp, 'damped: base shear')
   end subroutine shaken

   !> Half of a motion, and the rest from the state at its end.
   subroutine goes_on(error)
      type(error_type), allocatable, intent(inout) :: error
      character(len=7), parameter :: method(2) = ['newmark', 'rk4    ']
      type(error_type), allocatable :: outcome
      type(storeys_type) :: structure
      type(analysis_record) :: analysis
      type(task_type) :: whole, first, second
      type(array_recorder) :: all_rows, half, rest
      type(loads_type) :: loads
      real(wp) :: time(401)
      integer :: i

      call new_storeys(structure, yielding_springs())
      time = times(400, 0.01_wp)
      loads%ground = signal_of(time, 9.0_wp*sin(11.0_wp*time))
      do i = 1, 2
         analysis = analysis_record(method=method(i), dt=1.0e-3_wp)
         whole = task_type()
         first = task_type()
         second = task_type()
         call run(structure, analysis, time, loads, initial_state(), whole, all_rows, outcome)
         call check_passed(error, outcome, 'whole')
         first%keeps_end = .true.
         call run(structure, analysis, time(:201), loads, initial_state(), first, half, outcome)
         call check_passed(error, outcome, 'first half')
         second%before = first%after
         call run(structure, analysis, time(201:), loads, initial_state(), second, rest, outcome)
         call check_passed(error, outcome, 'second half')
         if (allocated(error)) return
         call check_same(error, rest%rows(:, rest%count), all_rows%rows(:, all_rows%count), method(i))
      end do
   end subroutine goes_on

   !> The first yield of the lower storey is where its row crosses the yield deformation; the run ends where
   !> the drift of the top is that of collapse.
   subroutine limit_states(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(storeys_type) :: structure
      type(task_type) :: task
      type(array_recorder) :: recorder
      type(loads_type) :: loads
      type(sight_type) :: sight
      real(wp) :: time(401), share
      integer :: i

      call new_storeys(structure, yielding_springs())
      time = times(400, 0.01_wp)
      loads%force = signal_of(time, 2.0e5_wp*time)
      call sight%watch_for([watch_type(state=1, joint=1, slip=1.0_wp, threshold=0.01_wp)], 1)
      task%collapse_drift = 0.02_wp
      call run(structure, analysis_record(method='newmark', dt=1.0e-3_wp), time, loads, initial_state(), &
               task, recorder, outcome, sight)
      call check_passed(error, outcome, 'run')
      if (allocated(error)) return
      associate (slip => recorder%rows(row_springs, :recorder%count), t => recorder%rows(1, :recorder%count))
         i = findloc(slip >= 0.01_wp, .true., dim=1)
         share = (0.01_wp - slip(i - 1))/(slip(i) - slip(i - 1))
         call check_close(error, sight%reached(1), t(i - 1) + share*(t(i) - t(i - 1)), 1.0e-13_wp, 0.0_wp, &
                          'first yield')
      end associate
      call check_true(error, task%summary%collapsed, 'collapse')
      call check_true(error, recorder%rows(2, recorder%count) >= 0.12_wp .and. &
                      recorder%rows(2, recorder%count - 1) < 0.12_wp, 'at 2 % of 6 m')
      call check_equal(error, recorder%count, task%summary%steps + 1, 'rows')
   end subroutine limit_states

   !> Its floors do not move up or down.
   subroutine refused(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(storeys_type) :: structure
      type(time_plan) :: plan
      type(loads_type) :: loads

      call new_storeys(structure, elastic_springs())
      loads%vertical = signal_of([0.0_wp, 1.0_wp], [1.0_wp, 1.0_wp])
      call plan_dynamic(structure, analysis_record(method='newmark'), [0.0_wp, 1.0_wp], loads, plan, outcome)
      call check_true(error, allocated(outcome), 'refused')
      if (allocated(error)) return
      call check_true(error, index(outcome%message, 'vertical_acceleration: it does nothing') == 1, 'message')
   end subroutine refused

end module test_structure
