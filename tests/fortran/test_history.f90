!> Response in time by RK4: closed forms and observed orders, energy, the static path, and failures.
module test_history
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
   use check, only: unit_test, check_close, check_equal, check_failed, check_passed, check_same, check_true
   use rbs_base_constants, only: unset, unset_integer
   use rbs_base_error, only: error_type, fatal_error, analysis_failed, bad_input
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_structure_column_column, only: column_type
   use rbs_hysteresis_springs, only: follow_path, spring_array
   use rbs_output_observer, only: observer_type
   use rbs_output_channels, only: new_channels
   use rbs_output_recorder, only: array_recorder, recorder_type
   use rbs_output_summary, only: summary_type
   use rbs_solve_modal_modes, only: modes_type, find_modes
   use rbs_solve_static_run_static, only: run_static
   use rbs_solve_task, only: task_type
   use rbs_loading_loads, only: loads_type
   use rbs_solve_time_march, only: initial_state, march
   use rbs_solve_time_motion, only: motion_type, motion_result
   use rbs_solve_time_plan, only: time_plan
   use rbs_solve_time_rk4, only: rk4_stepper
   use rbs_solve_time_run_dynamic, only: plan_dynamic, run_dynamic
   use rbs_structure_column_column_record, only: column_record
   use runs, only: run_data, run, times, last_deformation
   use samples, only: chain, column_1, elastic, made, random_type, d_y, k_u, mass_1, height_1
   use row_places, only: row_time, row_displacement, row_force, row_input, row_kinetic, row_spring, &
                         row_damping, row_axial, row_residual, row_joints
   implicit none
   private

   public :: collect_history

   !> Accepts a few rows, then fails like a full disk.
   type, extends(recorder_type) :: failing_recorder
      integer :: count = 0
   contains
      procedure :: record => record_and_fail
   end type failing_recorder

   !> Counts the reports of progress, and keeps the last share.
   type, extends(observer_type) :: counting_progress
      integer :: count = 0
      real(wp) :: share = 0.0_wp
      logical :: ascends = .true.
   contains
      procedure :: update
   end type counting_progress

contains

   subroutine collect_history(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('free vibration in a mode: closed form, order 4', free_vibration), &
               unit_test('damped free vibration: closed form, order 4', damped_vibration), &
               unit_test('harmonic force: closed form, order 4', harmonic_force), &
               unit_test('harmonic ground motion: closed form, order 4', harmonic_ground), &
               unit_test('ramp of the force: the input is linear between its points', ramp), &
               unit_test('beyond the stability limit the motion grows, below it does not', limit), &
               unit_test('a step beyond the limit is refused, with the limit', refused), &
               unit_test('misprint E6: eq 4 keeps its energy, finite rotation', misprint_e6), &
               unit_test('finite rotation: energy under force, ground, axial load, damping', finite_energy), &
               unit_test('finite rotation starts as small rotation', finite_small), &
               unit_test('energy balance of a linear chain under everything', chain_energy), &
               unit_test('nonlinear: springs follow their rules, to the last bit', spring_rows), &
               unit_test('nonlinear: the energy residual shrinks with the step', energy_converges), &
               unit_test('slow force-driven loading approaches the static path', slow_loading), &
               unit_test('initial state: the springs move there from zero', initial), &
               unit_test('rows: the first, every n-th, the last', rows), &
               unit_test('free steps end exactly at the end', free_steps), &
               unit_test('a column that falls: an error, with the rows before it', falling), &
               unit_test('a recorder that fails ends the run', failing), &
               unit_test('progress is reported in ascending shares', progress), &
               unit_test('input that is not a number is refused', not_a_number)]
   end subroutine collect_history

   subroutine record_and_fail(self, row, error)
      class(failing_recorder), intent(inout) :: self
      real(wp), intent(in) :: row(:)
      type(error_type), allocatable, intent(inout) :: error

      self%count = self%count + 1
      if (self%count == 3) then
         call fatal_error(error, analysis_failed, 'disk full at '//to_text(row(row_time))//' s')
      end if
   end subroutine record_and_fail

   subroutine update(self, share)
      class(counting_progress), intent(inout) :: self
      real(wp), intent(in) :: share

      self%count = self%count + 1
      self%ascends = self%ascends .and. share > self%share
      self%share = share
   end subroutine update

   !> The error must fall by 2**4 as the step is halved, within 4.0 +- 0.05.
   subroutine check_order_4(error, wrong, what)
      type(error_type), allocatable, intent(inout) :: error
      real(wp), intent(in) :: wrong(:)
      character(len=*), intent(in) :: what
      integer :: m

      m = size(wrong)
      call check_close(error, log(wrong(:m - 1)/wrong(2:))/log(2.0_wp), spread(4.0_wp, 1, m - 1), 0.0_wp, &
                       0.05_wp, what//': order')
   end subroutine check_order_4

   !> Largest difference of the deformations at the last row from the exact ones, over their size.
   real(wp) function wrong_at_end(data, exact) result(wrong)
      type(run_data), intent(in) :: data
      real(wp), intent(in) :: exact(:)
      wrong = maxval(abs(last_deformation(data, size(exact)) - exact))/maxval(abs(exact))
   end function wrong_at_end

   subroutine free_vibration(error)
      type(error_type), allocatable, intent(inout) :: error
      integer, parameter :: n = 3
      type(error_type), allocatable :: outcome
      type(run_data) :: data
      class(column_type), allocatable :: column
      type(modes_type) :: modes
      real(wp) :: finish, wrong(3), h
      integer :: mode, i

      column = made(chain(n, 'small'))
      call find_modes(column, modes, outcome)
      call check_passed(error, outcome, 'find_modes')
      allocate (data%initial%deformation(2*n))
      do mode = 1, 2*n
         ! The error of the phase is visible where the cosine is steep.
         finish = 4.7_wp/modes%omega(mode)
         data%initial%deformation(:) = 1.0e-3_wp*modes%shapes(:, mode)
         h = min(finish/20, 0.9_wp*modes%stable_step)
         do i = 1, 3
            data%time = [0.0_wp, finish]
            data%analysis%dt = finish/(ceiling(finish/h)*2**i)
            call run(data, column)
            call check_passed(error, data%outcome, 'run')
            if (allocated(error)) return
            wrong(i) = wrong_at_end(data, data%initial%deformation*cos(modes%omega(mode)*finish))
         end do
         call check_order_4(error, wrong, 'mode '//to_text(mode))
         call check_true(error, wrong(3) < 1.0e-5_wp, 'error in mode '//to_text(mode))
      end do
   end subroutine free_vibration

   !> Rayleigh damping keeps the modes: exp(-c t/2) (cos w t + c/(2 w) sin w t), c = alpha + beta omega^2.
   subroutine damped_vibration(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(run_data) :: data
      type(column_record) :: spec
      class(column_type), allocatable :: column
      type(modes_type) :: modes
      real(wp), parameter :: alpha(3) = [60.0_wp, 0.0_wp, 30.0_wp], beta(3) = [0.0_wp, 5.0e-5_wp, 2.0e-5_wp]
      real(wp) :: wrong(3), c, w, t
      integer :: kind, i

      do kind = 1, 3
         spec = chain(2, 'small')
         spec%damping%mass = alpha(kind)
         spec%damping%stiffness = beta(kind)
         column = made(spec)
         call find_modes(column, modes, outcome)
         call check_passed(error, outcome, 'find_modes')
         c = alpha(kind) + beta(kind)*modes%omega(4)**2
         w = sqrt(modes%omega(4)**2 - c**2/4)
         t = 4.7_wp/modes%omega(4)
         data%time = [0.0_wp, t]
         data%initial%deformation = modes%shapes(:, 4)
         do i = 1, 3
            data%analysis%dt = t/(40*2**i)
            call run(data, column)
            call check_passed(error, data%outcome, 'run')
            if (allocated(error)) return
            wrong(i) = wrong_at_end(data, modes%shapes(:, 4)*exp(-c*t/2)*(cos(w*t) + c/(2*w)*sin(w*t)))
         end do
         call check_order_4(error, wrong, 'damping '//to_text(kind))
         call check_true(error, abs(data%rows(row_residual, size(data%rows, &
                         2))) < 1.0e-5_wp*data%summary%largest, &
                         'energy balance')
         call check_true(error, data%rows(row_damping, size(data%rows, 2)) > 0.0_wp, 'damping takes energy')
      end do
   end subroutine damped_vibration

   !> Modal response to a load b sin(W t) from rest: b_m/(omega^2 - W^2) (sin W t - W/omega sin omega t).
   pure function harmonic(modes, load, w, t) result(q)
      type(modes_type), intent(in) :: modes
      real(wp), intent(in) :: load(:), w, t
      real(wp) :: q(size(load))
      integer :: i

      q = 0.0_wp
      do i = 1, size(load)
         associate (omega => modes%omega(i), shape => modes%shapes(:, i))
            q = q + shape*(dot_product(shape, load)/(omega**2 - w**2)*(sin(w*t) - w/omega*sin(omega*t)))
         end associate
      end do
   end function harmonic

   !> The table has a point at every half step, where RK4 needs the load: no error of interpolation.
   subroutine harmonic_orders(error, by_ground)
      type(error_type), allocatable, intent(inout) :: error
      logical, intent(in) :: by_ground
      type(error_type), allocatable :: outcome
      type(run_data) :: data
      class(column_type), allocatable :: column
      type(modes_type) :: modes
      real(wp) :: wrong(3), w, finish, h, q(4), exact(4)
      real(wp), allocatable :: load(:), wave(:)
      integer :: i, j, m

      column = made(chain(2, 'small'))
      call find_modes(column, modes, outcome)
      call check_passed(error, outcome, 'find_modes')
      w = 0.7_wp*modes%omega(1)
      finish = 5.0_wp/modes%omega(1)
      load = 1.0e5_wp*column%arm
      if (by_ground) load = -3.0_wp*column%ground_arm
      do i = 1, 3
         m = ceiling(2.0_wp*finish*modes%omega(4))*2**i
         h = finish/m
         data%time = times(2*m, 0.5_wp*h)
         data%analysis%dt = h
         wave = sin(w*data%time)
         if (by_ground) then
            data%ground = 3.0_wp*wave
         else
            data%force = 1.0e5_wp*wave
         end if
         call run(data, column)
         call check_passed(error, data%outcome, 'run')
         if (allocated(error)) return
         call check_equal(error, data%summary%steps, m, 'steps')
         wrong(i) = 0.0_wp
         do j = 1, m + 1
            q = data%rows(row_joints:row_joints + 3, j)
            exact = harmonic(modes, load, w, data%rows(row_time, j))
            wrong(i) = max(wrong(i), maxval(abs(q - exact)))
         end do
         wrong(i) = wrong(i)/maxval(abs(exact))
      end do
      call check_order_4(error, wrong, 'harmonic load')
      call check_true(error, wrong(3) < 1.0e-6_wp, 'error')
   end subroutine harmonic_orders

   subroutine harmonic_force(error)
      type(error_type), allocatable, intent(inout) :: error

      call harmonic_orders(error, .false.)
   end subroutine harmonic_force

   subroutine harmonic_ground(error)
      type(error_type), allocatable, intent(inout) :: error

      call harmonic_orders(error, .true.)
   end subroutine harmonic_ground

   subroutine ramp(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(run_data) :: data
      class(column_type), allocatable :: column
      type(modes_type) :: modes
      real(wp) :: q(2), t, omega
      integer :: i

      column = made(column_1('small'))
      call find_modes(column, modes, outcome)
      call check_passed(error, outcome, 'find_modes')
      t = 0.013_wp
      data%time = t*[0.0_wp, 0.25_wp, 1.0_wp]
      data%force = 2.0e4_wp*[0.0_wp, 0.25_wp, 1.0_wp]
      data%analysis%dt = t/2000
      call run(data, column)
      call check_passed(error, data%outcome, 'run')
      if (allocated(error)) return
      q = 0.0_wp
      do i = 1, 2
         omega = modes%omega(i)
         q = q + modes%shapes(:, i)*dot_product(modes%shapes(:, i), column%arm)*2.0e4_wp/t &
             *(t - sin(omega*t)/omega)/omega**2
      end do
      call check_true(error, wrong_at_end(data, q) < 1.0e-8_wp, 'closed form')
      call check_close(error, data%rows(row_force, :), data%force, 1.0e-14_wp, 0.0_wp, 'force')
      call check_equal(error, data%summary%events, 0, 'no spring has left its first line')
   end subroutine ramp

   !> Integrate with a step that no plan would allow: the limit is that of the scheme itself.
   subroutine limit(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      class(column_type), allocatable :: column
      type(modes_type) :: modes
      type(time_plan) :: plan
      type(initial_state) :: start
      type(loads_type) :: none
      type(rk4_stepper) :: stepper
      type(task_type) :: task
      type(array_recorder), target :: recorder
      real(wp) :: energy(2), share(2)
      integer, parameter :: steps = 3000
      integer :: kind, i

      share = [0.999_wp, 1.001_wp]
      do kind = 1, 3
         spec = chain(2, 'small')
         if (kind > 1) spec%damping%stiffness = 1.0e-5_wp*100.0_wp**(kind - 2)
         column = made(spec)
         call find_modes(column, modes, outcome)
         call check_passed(error, outcome, 'find_modes')
         start%velocity = modes%shapes(:, 4)
         do i = 1, 2
            plan%free = .true.
            plan%dt = share(i)*modes%stable_step
            plan%intervals = steps
            plan%steps = steps
            plan%finish = steps*plan%dt
            recorder = array_recorder()
            recorder%channels = new_channels(column, .true., .false., .false.)
            stepper = rk4_stepper()
            call stepper%scheme%create(column)
            task = task_type()
            task%recorder => recorder
            task%every = steps
            call march(column, plan, stepper, [0.0_wp, plan%finish], none, start, task, outcome)
            call check_passed(error, outcome, 'march')
            energy(i) = (recorder%rows(row_kinetic, 2) + recorder%rows(row_spring, 2)) &
                        /recorder%rows(row_kinetic, 1)
         end do
         call check_true(error, energy(1) < 1.0_wp, 'just below the limit, damping '//to_text(kind))
         call check_true(error, energy(2) > 10.0_wp, 'just above the limit, damping '//to_text(kind))
      end do
   end subroutine limit

   subroutine refused(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(run_data) :: data
      class(column_type), allocatable :: column
      type(modes_type) :: modes

      column = made(column_1('small'))
      call find_modes(column, modes, outcome)
      call check_passed(error, outcome, 'find_modes')
      data%time = [0.0_wp, 1.0_wp]
      data%analysis%dt = 1.01_wp*modes%stable_step
      call run(data, column)
      call check_failed(error, data%outcome, bad_input, 'is beyond the stability limit of rk4, '// &
                        to_text(modes%stable_step)//' s')
   end subroutine refused

   !> theory.md section 4: as printed, the energy of this motion drifts by 18 %.
   subroutine misprint_e6(error)
      type(error_type), allocatable, intent(inout) :: error
      type(run_data) :: data
      type(column_record) :: spec
      real(wp) :: energy

      spec = column_1('finite')
      spec%shear(1) = elastic(7.0e3_wp)
      spec%flexure(1) = elastic(2.5e3_wp)
      data%time = times(200, 0.05_wp)
      data%analysis%dt = 5.0e-4_wp
      data%initial%deformation = [0.05_wp, 0.8_wp]
      call run(data, made(spec))
      call check_passed(error, data%outcome, 'run')
      if (allocated(error)) return
      energy = 0.5_wp*(7.0e3_wp*0.05_wp**2 + 2.5e3_wp*0.8_wp**2)
      call check_close(error, data%rows(row_kinetic, :) + data%rows(row_spring, :), spread(energy, 1, 201), &
                       1.0e-10_wp, 0.0_wp, 'energy')
      call check_true(error, minval(data%rows(row_joints + 1, :)) < -0.75_wp, 'the rotation is large')
      call check_close(error, data%rows(row_displacement, :), data%rows(row_joints, :) &
                       + height_1*sin(data%rows(row_joints + 1, :)), 1.0e-14_wp, 1.0e-15_wp, 'top')
   end subroutine misprint_e6

   subroutine finite_energy(error)
      type(error_type), allocatable, intent(inout) :: error
      type(run_data) :: data
      type(column_record) :: spec
      real(wp) :: wrong(3)
      integer :: i, last

      spec = column_1('finite')
      spec%shear(1) = elastic(7.0e4_wp)
      spec%flexure(1) = elastic(2.5e4_wp)
      spec%axial_load = 5.0e3_wp
      spec%self_weight = .true.
      spec%damping%mass = 0.3_wp
      spec%damping%stiffness = 1.0e-3_wp
      data%initial%deformation = [0.05_wp, 0.6_wp]
      data%initial%velocity = [-0.2_wp, 1.0_wp]
      do i = 1, 3
         data%time = times(100, 0.02_wp)
         data%force = 3.0e3_wp*sin(7.0_wp*data%time)
         data%ground = 4.0_wp*cos(5.0_wp*data%time)
         data%analysis%dt = 4.0e-3_wp/2**i
         call run(data, made(spec))
         call check_passed(error, data%outcome, 'run')
         if (allocated(error)) return
         wrong(i) = data%summary%residual/data%summary%largest
      end do
      last = size(data%rows, 2)
      call check_true(error, wrong(3) < 1.0e-8_wp, 'residual')
      call check_true(error, all(wrong(:2)/wrong(2:) > 12.0_wp), 'order of the residual is 4 or more')
      call check_true(error, minval(abs([data%rows(row_input, last), data%rows(row_damping, last), &
                                         data%rows(row_axial, last)])) > 1.0_wp, 'every energy takes part')
   end subroutine finite_energy

   subroutine finite_small(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(random_type) :: random
      type(column_record) :: spec
      class(column_type), allocatable, target :: upright, turned
      type(motion_type) :: small, finite
      type(spring_array) :: springs
      type(motion_result) :: a, b
      real(wp) :: q(2), v(2)
      real(wp), parameter :: load(4) = [30.0_wp, 0.1_wp, 0.2_wp, 400.0_wp]
      integer :: i

      spec = column_1('pdelta')
      spec%axial_load = 1.0e6_wp
      spec%self_weight = .true.
      spec%damping%mass = 2.0_wp
      spec%damping%stiffness = 1.0e-4_wp
      upright = made(spec)
      call small%create(upright, spread(.true., 1, 4), outcome)
      call check_passed(error, outcome, 'small')
      spec%kinematics = 'finite'
      turned = made(spec)
      call finite%create(turned, spread(.true., 1, 4), outcome)
      call check_passed(error, outcome, 'finite')
      call springs%create(small%structure%spring)
      call a%create(small%structure)
      call b%create(finite%structure)
      do i = 1, 50
         q = 1.0e-7_wp*[random%uniform(-1.0_wp, 1.0_wp), random%uniform(-1.0_wp, 1.0_wp)]
         v = 1.0e-6_wp*[random%uniform(-1.0_wp, 1.0_wp), random%uniform(-1.0_wp, 1.0_wp)]
         call small%acceleration(springs, q, v, load, a)
         call finite%acceleration(springs, q, v, load, b)
         call check_close(error, a%a, b%a, 1.0e-10_wp, 1.0e-10_wp, 'acceleration')
         call check_close(error, small%structure%kinetic_energy(q, v), &
                          finite%structure%kinetic_energy(q, v), 1.0e-10_wp, 0.0_wp, 'kinetic energy')
         call check_close(error, small%structure%potential_energy(q), finite%structure%potential_energy(q), &
                          1.0e-10_wp, 0.0_wp, 'potential')
      end do
   end subroutine finite_small

   subroutine chain_energy(error)
      type(error_type), allocatable, intent(inout) :: error
      type(run_data) :: data
      type(column_record) :: spec
      real(wp) :: wrong(3)
      integer :: i

      spec = chain(5, 'pdelta')
      spec%axial_load = 1.0e6_wp
      spec%self_weight = .true.
      spec%damping%mass = 5.0_wp
      spec%damping%stiffness = 1.0e-6_wp
      do i = 1, 3
         data%time = times(40, 1.0e-3_wp)
         data%force = 3.0e5_wp*sin(70.0_wp*data%time)
         data%ground = 4.0_wp*cos(50.0_wp*data%time)
         data%analysis%dt = 1.0e-3_wp/(10*2**i)
         call run(data, made(spec))
         call check_passed(error, data%outcome, 'run')
         if (allocated(error)) return
         wrong(i) = data%summary%residual/data%summary%largest
      end do
      call check_true(error, wrong(3) < 1.0e-6_wp, 'residual')
      call check_true(error, all(wrong(:2)/wrong(2:) > 12.0_wp), 'order of the residual is 4 or more')
   end subroutine chain_energy

   !> A force that brings both springs of column 1 beyond yield, twice.
   subroutine yielding_force(data, height, seconds)
      type(run_data), intent(inout) :: data
      real(wp), intent(in) :: height, seconds
      integer, parameter :: corners = 4
      integer :: i

      data%time = times(corners, seconds/corners)
      data%force = height*[(merge(0.0_wp, 1.0_wp, i == 0)*merge(1, -1, mod(i, 2) == 1), i=0, corners)]
   end subroutine yielding_force

   subroutine spring_rows(error)
      type(error_type), allocatable, intent(inout) :: error
      type(run_data) :: data
      class(column_type), allocatable :: column
      real(wp), allocatable :: f(:)
      integer :: i

      column = made(column_1('small'))
      call yielding_force(data, 1.6e5_wp, 0.2_wp)
      data%analysis%dt = 0.2_wp/2003.0_wp
      call run(data, column)
      call check_passed(error, data%outcome, 'run')
      if (allocated(error)) return
      call check_equal(error, size(data%rows, 2), 2004, 'a row after each step')
      call check_true(error, data%summary%events > 20, 'the springs change lines')
      allocate (f(size(data%rows, 2)))
      do i = 1, 2
         call follow_path(column%spring(i), data%rows(row_joints - 1 + i, :), f)
         call check_same(error, data%rows(row_joints + 1 + i, :), f, 'force of a spring')
      end do
   end subroutine spring_rows

   subroutine energy_converges(error)
      type(error_type), allocatable, intent(inout) :: error
      type(run_data) :: data
      real(wp) :: wrong(4)
      integer :: i

      do i = 1, 4
         call yielding_force(data, 1.6e5_wp, 0.2_wp)
         data%analysis%dt = 0.05_wp/(50*4**i)
         call run(data, made(column_1('small')))
         call check_passed(error, data%outcome, 'run')
         if (allocated(error)) return
         wrong(i) = data%summary%residual/data%summary%largest
      end do
      ! A line is changed at the end of a step: the residual is of second order only on average.
      call check_true(error, wrong(4) < 1.0e-6_wp, 'residual')
      call check_true(error, wrong(4) < 0.01_wp*wrong(1), 'residual of a step 64 times smaller')
   end subroutine energy_converges

   subroutine slow_loading(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      type(run_data) :: data
      type(array_recorder), target :: recorder
      type(task_type) :: task
      real(wp) :: wrong(2)
      real(wp), allocatable :: x(:)
      integer :: i

      spec = column_1('small')
      spec%damping%mass = 100.0_wp
      do i = 1, 2
         call yielding_force(data, 1.6e5_wp, 5.0_wp*10**(i - 1))
         call run(data, made(spec))
         call check_passed(error, data%outcome, 'run')
         if (allocated(error)) return
         recorder = array_recorder()
         recorder%channels = new_channels(made(spec), .false., .false., .false.)
         task%recorder => recorder
         task%every = 1
         call run_static(made(spec), .true., data%force, task, outcome)
         call check_passed(error, outcome, 'static path')
         x = recorder%rows(row_displacement, :recorder%count)
         wrong(i) = maxval(abs(data%rows(row_displacement, :) - x))/maxval(abs(x))
      end do
      call check_true(error, maxval(abs(x)) > 3.0_wp*height_1*d_y, 'beyond yield')
      call check_true(error, wrong(2) < 0.01_wp, 'slow: below 1 %, not '//to_text(wrong(2)))
      call check_true(error, wrong(2) < 0.2_wp*wrong(1), 'ten times slower is better')
   end subroutine slow_loading

   subroutine initial(error)
      type(error_type), allocatable, intent(inout) :: error
      type(run_data) :: data
      class(column_type), allocatable :: column
      real(wp) :: f(1)

      column = made(column_1('small'))
      data%time = [0.0_wp, 1.0e-4_wp]
      data%initial%deformation = [0.0_wp, 3.0_wp*d_y]
      data%initial%velocity = [1.0_wp, 0.0_wp]
      call run(data, column)
      call check_passed(error, data%outcome, 'run')
      if (allocated(error)) return
      call follow_path(column%spring(2), [3.0_wp*d_y], f)
      call check_same(error, data%rows(row_joints + 3, 1), f(1), 'moment at the start')
      call check_same(error, data%rows(row_kinetic, 1), 0.5_wp*mass_1, 'kinetic energy at the start')
      call check_same(error, data%rows(row_residual, 1), 0.0_wp, 'the balance starts at zero')
   end subroutine initial

   subroutine rows(error)
      type(error_type), allocatable, intent(inout) :: error
      type(run_data) :: data, fine, thin
      class(column_type), allocatable :: column
      type(random_type) :: random
      integer :: steps, i

      column = made(column_1('small'))
      data%time = times(10, 0.01_wp)
      do i = 2, 10
         data%time(i) = data%time(i) + random%uniform(-0.004_wp, 0.004_wp)
      end do
      data%force = 1.0e4_wp*sin(30.0_wp*data%time)
      call run(data, column)
      call check_passed(error, data%outcome, 'run')
      if (allocated(error)) return
      call check_same(error, data%rows(row_time, :), data%time, 'times of the loading')
      call check_close(error, data%rows(row_force, :), data%force, 1.0e-14_wp, 0.0_wp, 'force')
      call check_equal(error, size(data%rows, 2), 11, 'rows')

      ! `every` counts steps.
      steps = data%summary%steps
      fine%time = data%time
      fine%force = data%force
      fine%every = 1
      call run(fine, column)
      call check_passed(error, fine%outcome, 'a row after each step')
      if (allocated(error)) return
      call check_equal(error, size(fine%rows, 2), steps + 1, 'a row after each step')
      thin%time = data%time
      thin%force = data%force
      thin%every = 7
      call run(thin, column)
      call check_passed(error, thin%outcome, 'every 7th step')
      if (allocated(error)) return
      call check_true(error, mod(steps, 7) /= 0, 'the last step is not one of them')
      call check_equal(error, thin%summary%rows, steps/7 + 2, 'rows: the start, every 7th, the last')
      call check_same(error, pack(thin%rows(:, :steps/7 + 1), .true.), pack(fine%rows(:, ::7), .true.), &
                      'every 7th step')
      call check_same(error, thin%rows(:, steps/7 + 2), fine%rows(:, steps + 1), 'the last step')
      call check_same(error, pack(data%rows(:, 11), .true.), fine%rows(:, steps + 1), 'the same run')
      call check_same(error, thin%summary%peak_displacement, fine%summary%peak_displacement, &
                      'the peak is that of all steps')
      call check_same(error, fine%summary%peak_displacement, &
                      fine%rows(row_displacement, maxloc(abs(fine%rows(row_displacement, :)), dim=1)), &
                      'the peak is that of a row')
   end subroutine rows

   subroutine free_steps(error)
      type(error_type), allocatable, intent(inout) :: error
      type(run_data) :: data
      integer :: last

      data%time = [1.0_wp, 1.0205_wp]
      data%analysis%dt = 1.0e-3_wp
      data%initial%velocity = [1.0_wp, 0.0_wp]
      call run(data, made(column_1('small')))
      call check_passed(error, data%outcome, 'run')
      if (allocated(error)) return
      last = size(data%rows, 2)
      call check_equal(error, last, 22, 'rows: the start, 20 steps and a half one')
      call check_same(error, data%rows(row_time, [1, last]), data%time, 'start and end')
      call check_close(error, data%rows(row_time, last - 1), 1.02_wp, 1.0e-15_wp, 0.0_wp, 'last whole step')
   end subroutine free_steps

   !> P l above k_u: after yield the column falls, and with linear geometry it falls without end.
   subroutine falling(error)
      type(error_type), allocatable, intent(inout) :: error
      type(run_data) :: data
      type(column_record) :: spec
      integer :: last

      spec = column_1('pdelta')
      spec%axial_load = 10.0_wp*k_u/height_1
      data%time = times(1000, 0.01_wp)
      data%force = 2.0e5_wp + 0.0_wp*data%time
      call run(data, made(spec))
      call check_failed(error, data%outcome, analysis_failed, 'the motion grows without bounds at time')
      last = size(data%rows, 2)
      call check_true(error, last > 1 .and. last < 1000, 'rows up to there')
      call check_true(error, all(abs(data%rows(row_displacement, :)) < 1.0e100_wp), 'finite rows')
   end subroutine falling

   subroutine failing(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(failing_recorder), target :: recorder
      type(run_data) :: data
      class(column_type), allocatable :: column
      type(time_plan) :: plan
      type(loads_type) :: none
      type(task_type) :: task

      column = made(column_1('small'))
      data%time = times(5, 0.25_wp)
      call plan_dynamic(column, data%analysis, data%time, none, plan, outcome)
      call check_passed(error, outcome, 'plan')
      recorder%channels = new_channels(column, .true., .false., .false.)
      task%recorder => recorder
      call run_dynamic(column, data%analysis, plan, data%time, none, data%initial, task, outcome)
      call check_failed(error, outcome, analysis_failed, 'disk full at 0.5 s')
      call check_equal(error, recorder%count, 3, 'rows offered')
   end subroutine failing

   subroutine progress(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(array_recorder), target :: recorder
      type(counting_progress), target :: told
      type(run_data) :: data
      class(column_type), allocatable :: column
      type(time_plan) :: plan
      type(loads_type) :: none
      type(task_type) :: task

      column = made(column_1('small'))
      data%time = [0.0_wp, 10.0_wp]
      data%analysis%dt = 1.0e-4_wp
      call plan_dynamic(column, data%analysis, data%time, none, plan, outcome)
      call check_passed(error, outcome, 'plan')
      task%recorder => recorder
      task%progress => told
      call run_dynamic(column, data%analysis, plan, data%time, none, data%initial, task, outcome)
      call check_passed(error, outcome, 'run')
      call check_equal(error, told%count, 12, 'number of reports')
      call check_true(error, told%ascends .and. told%share <= 1.0_wp, 'shares')
   end subroutine progress

   subroutine not_a_number(error)
      type(error_type), allocatable, intent(inout) :: error
      type(run_data) :: data
      class(column_type), allocatable :: column

      column = made(column_1('small'))
      data%time = [0.0_wp, 1.0_wp]
      data%force = [0.0_wp, ieee_value(1.0_wp, ieee_quiet_nan)]
      call run(data, column)
      call check_failed(error, data%outcome, bad_input, 'force: value 2 of 2 is NaN')
      data%force = [0.0_wp, 0.0_wp]
      data%ground = [ieee_value(1.0_wp, ieee_quiet_nan), 0.0_wp]
      call run(data, column)
      call check_failed(error, data%outcome, bad_input, 'ground_acceleration: value 1 of 2 is NaN')
   end subroutine not_a_number

end module test_history
