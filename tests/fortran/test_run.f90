!> The decisions and messages of a run: the method, its steps, the end by collapse or failure, the initial
!> state; and that every method gives the same answer in any units.
module test_run
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan, ieee_is_finite
   use check, only: unit_test, check_close, check_contains, check_equal, check_failed, check_passed, &
                    check_same, check_true
   use rbs_base_constants, only: unset, unset_integer
   use rbs_base_error, only: error_type, fatal_error, analysis_failed, bad_input
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_structure_column_column, only: column_type
   use rbs_output_channels, only: new_channels
   use rbs_output_recorder, only: array_recorder
   use rbs_output_summary, only: summary_type
   use rbs_loading_loads, only: loads_type
   use rbs_solve_task, only: task_type
   use rbs_solve_time_located, only: located_stepper
   use rbs_solve_time_march, only: initial_state, march
   use rbs_solve_time_plan, only: time_plan, new_plan
   use rbs_solve_time_run_dynamic, only: plan_dynamic
   use rbs_solve_time_state, only: state_type, stepper_type
   use rbs_case_analysis_record, only: analysis_record
   use rbs_structure_column_column_record, only: column_record
   use runs, only: run_data, run, times, new_located
   use samples, only: set_value, value_of, bilinear, chain, column_1, compression, elastic, made, k_c, &
                      k_u, height_1
   use row_places, only: row_time, row_displacement, row_force, row_input, row_kinetic, row_spring, &
                         row_damping, row_axial, row_residual, row_top, row_joints
   implicit none
   private

   public :: collect_run

   !> Methods by number; 1 with events at the end of a step, 2 with located ones.
   integer, parameter :: methods = 6
   character(len=17), parameter :: method_name(methods) = [ &
      'rk4              ', 'rk4              ', 'rk45             ', 'newmark          ', &
      'hht              ', 'generalised_alpha']

   !> Makes a few steps, then fails in the middle of one.
   type, extends(stepper_type) :: failing_stepper
      integer :: count = 0
   contains
      procedure :: advance => advance_and_fail
   end type failing_stepper

contains

   subroutine collect_run(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('all methods agree', agreement), &
               unit_test('any units: the same answer, to the last bit', units), &
               unit_test('collapse ends the run, and is no failure', collapse), &
               unit_test('a collapse that does not occur', no_collapse), &
               unit_test('without a criterion of collapse the fall is an error', no_bounds), &
               unit_test('a step beyond the limit: refused, unless it is allowed', unstable), &
               unit_test('a dt that other methods accept', long_dt), &
               unit_test('what a method cannot do is refused', refused), &
               unit_test('loads without effect are refused', idle_loads), &
               unit_test('auto: the choice', choice), &
               unit_test('auto: the reason is true', reason), &
               unit_test('auto gives the results of the method that it names', auto_is_method), &
               unit_test('joints closed by load and weight stay at rest', at_rest), &
               unit_test('joints that cannot carry their load', cannot_carry), &
               unit_test('initial openings, given or found', openings), &
               unit_test('a stepper that fails: the rows up to the last good state', failing), &
               unit_test('rows of methods with steps of their own', rows), &
               unit_test('times far from zero: the same motion, no more steps', late), &
               unit_test('initial values must be numbers', initial_numbers), &
               unit_test('the largest rotation is that of a body', peak_rotation)]
   end subroutine collect_run

   !> The record of a method by number.
   subroutine ask(data, method)
      type(run_data), intent(inout) :: data
      integer, intent(in) :: method

      data%analysis%method = method_name(method)
      data%analysis%events = ''
      if (method == 2) data%analysis%events = 'located'
      data%analysis%tolerance = unset
      if (method == 3) data%analysis%tolerance = 1.0e-9_wp
   end subroutine ask

   !> A column with all optional properties, scaled to other units of length, mass and time.
   type(column_record) function scaled(kinematics, length, mass, time) result(spec)
      character(len=*), intent(in) :: kinematics
      real(wp), intent(in) :: length, mass, time
      real(wp) :: force

      force = mass*length/time**2
      spec = column_1(kinematics)
      spec%n = 3
      spec%height = spec%height*length
      spec%mass = spec%mass*mass
      spec%axial_load = 1.0e6_wp*force
      spec%self_weight = .true.
      spec%gravity = spec%gravity*length/time**2
      spec%top_mass = 500.0_wp*mass
      spec%top_inertia = 20.0_wp*mass*length**2
      spec%depth = 0.4_wp*length
      spec%damping%mass = 5.0_wp/time
      spec%damping%stiffness = 1.0e-5_wp*time
      spec%shear(1) = bilinear(value_of(spec%shear(1), 'k')*force/length, &
                               value_of(spec%shear(1), 'd_y')*length, &
                               value_of(spec%shear(1), 'k_post')*force/length)
      call set_value(spec%flexure(1), 'k_c', value_of(spec%flexure(1), 'k_c')*force*length)
      call set_value(spec%flexure(1), 'k_y', value_of(spec%flexure(1), 'k_y')*force*length)
      call set_value(spec%flexure(1), 'k_u', value_of(spec%flexure(1), 'k_u')*force*length)
      allocate (spec%axial_spring(1))
      spec%axial_spring(1) = bilinear(2.0e9_wp*force/length, 4.0e-3_wp*length, 1.0e8_wp*force/length)
   end function scaled

   !> Its loads, scaled.
   subroutine shake(data, length, mass, time)
      type(run_data), intent(inout) :: data
      real(wp), intent(in) :: length, mass, time

      data%time = times(20, 0.0025_wp)
      data%force = 1.5e5_wp*sin(200.0_wp*data%time)*(mass*length/time**2)
      data%ground = 20.0_wp*cos(150.0_wp*data%time)*(length/time**2)
      data%vertical = 100.0_wp*sin(300.0_wp*data%time)*(length/time**2)
      data%axial = 1.0e6_wp*sin(100.0_wp*data%time)*(mass*length/time**2)
      data%time = data%time*time
      allocate (data%initial%velocity(9), source=0.0_wp)
      data%initial%velocity(4) = 0.5_wp/time
   end subroutine shake

   subroutine agreement(error)
      type(error_type), allocatable, intent(inout) :: error
      type(run_data) :: reference, data
      class(column_type), allocatable :: column
      character(len=6), parameter :: kinematics(3) = ['small ', 'pdelta', 'finite']
      real(wp) :: peak, wrong
      real(wp), parameter :: allowed(methods) = [1.0e-2_wp, 1.0e-4_wp, 0.0_wp, 2.0e-2_wp, 2.0e-2_wp, &
                                                 2.0e-2_wp]
      integer :: level, method

      do level = 1, 3
         column = made(scaled(trim(kinematics(level)), 1.0_wp, 1.0_wp, 1.0_wp))
         reference = run_data()
         call shake(reference, 1.0_wp, 1.0_wp, 1.0_wp)
         call ask(reference, 3)
         call run(reference, column)
         call check_passed(error, reference%outcome, 'reference')
         if (allocated(error)) return
         call check_true(error, reference%summary%events > 20, 'springs yield and unload')
         peak = maxval(abs(reference%rows(row_displacement, :)))
         do method = 1, methods
            if (level == 3 .and. method > 3) cycle
            data = run_data()
            call shake(data, 1.0_wp, 1.0_wp, 1.0_wp)
            call ask(data, method)
            if (method > 3) data%analysis%dt = 2.5e-5_wp
            call run(data, column)
            call check_passed(error, data%outcome, trim(method_name(method)))
            if (allocated(error)) return
            call check_equal(error, size(data%rows, 2), 21, 'rows')
            call check_same(error, data%rows(row_time, :), data%time, 'times')
            wrong = maxval(abs(data%rows(row_displacement, :) - reference%rows(row_displacement, :)))/peak
            call check_true(error, wrong <= allowed(method), trim(kinematics(level))//', method '// &
                            to_text(method)//': wrong by '//to_text(wrong))
            wrong = data%summary%residual/data%summary%largest
            call check_true(error, wrong < 0.1_wp*max(allowed(method), 1.0e-6_wp), trim(kinematics(level))// &
                            ', method '//to_text(method)//': residual '//to_text(wrong))
            call check_contains(error, data%summary%method, trim(method_name(method)), 'method')
         end do
      end do
   end subroutine agreement

   !> Powers of two change no digit: a result that depends on the units has a constant with units in it.
   subroutine units(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp), parameter :: length = 2.0_wp**10, mass = 2.0_wp**(-6), time = 2.0_wp**4
      character(len=6), parameter :: kinematics(3) = ['small ', 'pdelta', 'finite']
      type(run_data) :: plain, other
      character(len=:), allocatable :: what
      real(wp), allocatable :: unit(:)
      integer :: level, method

      ! Of a damped column: with shear and moment at the base.
      allocate (unit(row_joints + 2*9 + 1))
      unit(row_time) = time
      unit(row_displacement) = length
      unit(row_force) = mass*length/time**2
      unit([row_input, row_kinetic, row_spring, row_damping, row_axial, row_residual]) = mass*(length/time)**2
      unit(row_top) = length
      unit(row_joints:) = unit(row_force)
      unit(row_joints:row_joints + 8) = length
      unit(row_joints + 3:row_joints + 5) = 1.0_wp
      unit(row_joints + 12:row_joints + 14) = unit(row_force)*length
      unit(size(unit)) = unit(row_force)*length
      do level = 1, 3
         do method = 0, methods
            if (level == 3 .and. method > 3) cycle
            plain = run_data()
            other = run_data()
            call shake(plain, 1.0_wp, 1.0_wp, 1.0_wp)
            call shake(other, length, mass, time)
            if (method > 0) then
               call ask(plain, method)
               call ask(other, method)
            else
               plain%analysis%method = 'auto'
               other%analysis%method = 'auto'
            end if
            what = trim(kinematics(level))//', method '//to_text(method)
            call run(plain, made(scaled(trim(kinematics(level)), 1.0_wp, 1.0_wp, 1.0_wp)))
            call check_passed(error, plain%outcome, what)
            call run(other, made(scaled(trim(kinematics(level)), length, mass, time)))
            call check_passed(error, other%outcome, what)
            if (allocated(error)) return
            call check_equal(error, other%summary%steps, plain%summary%steps, what//': steps')
            call check_same(error, other%plan%limit, plain%plan%limit*time, what//': limit of stability')
            call check_same(error, pack(other%rows, .true.), &
                            pack(plain%rows*spread(unit, 2, size(plain%rows, 2)), .true.), what//': value')
            if (allocated(error)) return
         end do
      end do
   end subroutine units

   !> P l above the yielded stiffness: once it is pushed beyond yield, the column falls.
   subroutine fall(data, kinematics, n, spec)
      type(run_data), intent(inout) :: data
      character(len=*), intent(in) :: kinematics
      integer, intent(in) :: n
      type(column_record), intent(out) :: spec

      spec = column_1(kinematics)
      spec%n = n
      spec%axial_load = 10.0_wp*k_u/height_1
      data%time = times(1000, 0.01_wp)
      data%force = 2.0e5_wp + 0.0_wp*data%time
   end subroutine fall

   subroutine collapse(error)
      type(error_type), allocatable, intent(inout) :: error
      type(run_data) :: data
      type(column_record) :: spec
      integer, parameter :: every(3) = [unset_integer, 1, 7]
      integer :: i, last, level, method, n

      do level = 1, 2
         do n = 1, 3, 2
            do method = 1, methods
               if (level == 2 .and. method > 3) cycle
               do i = 1, 3
                  data = run_data()
                  call fall(data, merge('pdelta', 'finite', level == 1), n, spec)
                  call ask(data, method)
                  data%analysis%collapse_drift = 0.05_wp
                  data%every = every(i)
                  if (data%every == 1 .and. method == 1) data%every = 20
                  call run(data, made(spec))
                  call check_passed(error, data%outcome, method_name(method))
                  if (allocated(error)) return
                  last = size(data%rows, 2)
                  call check_true(error, data%summary%collapsed, trim(method_name(method))//': collapsed')
                  call check_true(error, last > 1 .and. last < 1000, 'rows up to there')
                  call check_equal(error, data%summary%rows, last, 'reported rows')
                  call check_true(error, abs(data%rows(row_displacement, last)) >= 0.05_wp*height_1, &
                                  'the last row has the drift')
                  call check_true(error, maxval(abs(data%rows(row_displacement, :last - 1))) &
                                  < 0.05_wp*height_1, 'the others have not')
                  call check_same(error, data%summary%peak_displacement, data%rows(row_displacement, last), &
                                  'it is the peak')
                  call check_true(error, data%rows(row_time, last) < 1.0_wp, 'it falls soon')
                  if (allocated(error)) return
               end do
            end do
         end do
      end do
   end subroutine collapse

   subroutine no_collapse(error)
      type(error_type), allocatable, intent(inout) :: error
      type(run_data) :: data
      integer :: method

      do method = 1, methods
         data = run_data()
         call shake(data, 1.0_wp, 1.0_wp, 1.0_wp)
         call ask(data, method)
         data%analysis%collapse_drift = 0.5_wp
         call run(data, made(scaled('pdelta', 1.0_wp, 1.0_wp, 1.0_wp)))
         call check_passed(error, data%outcome, method_name(method))
         if (allocated(error)) return
         call check_true(error, .not. data%summary%collapsed, 'not collapsed')
         call check_equal(error, size(data%rows, 2), 21, 'all rows')
      end do
   end subroutine no_collapse

   subroutine no_bounds(error)
      type(error_type), allocatable, intent(inout) :: error
      type(run_data) :: data
      type(column_record) :: spec
      integer :: last, method, n

      do n = 1, 3, 2
         do method = 1, methods
            data = run_data()
            call fall(data, 'pdelta', n, spec)
            call ask(data, method)
            if (method == 3) data%analysis%tolerance = 1.0e-4_wp
            call run(data, made(spec))
            if (method < 4) then
               call check_failed(error, data%outcome, analysis_failed, 'the motion grows without bounds at')
            else
               call check_failed(error, data%outcome, analysis_failed, 'Rows up to there are kept')
            end if
            last = size(data%rows, 2)
            call check_true(error, last > 1 .and. last < 1000, 'rows up to there')
            call check_true(error, all(ieee_is_finite(data%rows)), trim(method_name(method))// &
                            ': only finite rows, n = '//to_text(n))
            call check_true(error, all(data%rows(row_time, 2:) > data%rows(row_time, :last - 1)), &
                            'times ascend')
            if (allocated(error)) return
         end do
      end do
   end subroutine no_bounds

   subroutine unstable(error)
      type(error_type), allocatable, intent(inout) :: error
      type(run_data) :: data
      type(column_record) :: spec
      integer :: n, located

      do n = 1, 2
         do located = 1, 2
            spec = chain(n, 'small')
            data = run_data()
            call ask(data, located)
            data%time = [0.0_wp, 100.0_wp]
            allocate (data%initial%velocity(2*n), source=1.0_wp)
            call run(data, made(spec))
            call check_passed(error, data%outcome, 'a step of its own')
            if (allocated(error)) return
            data%analysis%dt = 1.2_wp*data%plan%limit
            call run(data, made(spec))
            call check_failed(error, data%outcome, bad_input, 's is beyond the stability limit of rk4, ')
            call check_true(error, .not. allocated(data%rows), 'nothing has run')
            data%analysis%allow_unstable = .true.
            data%every = 1
            data%time(2) = 10000.0_wp*data%analysis%dt
            call run(data, made(spec))
            call check_failed(error, data%outcome, analysis_failed, 'the step is beyond the stability limit')
            call check_true(error, size(data%rows, 2) > 10 .and. size(data%rows, 2) < 10000, &
                            'rows up to there')
            call check_true(error, all(ieee_is_finite(data%rows)), 'only finite rows')
            call check_contains(error, data%outcome%message, 'at time '// &
                                to_text(size(data%rows, 2)*data%analysis%dt)//' s', 'the time of the failure')
         end do
      end do
   end subroutine unstable

   subroutine long_dt(error)
      type(error_type), allocatable, intent(inout) :: error
      type(run_data) :: data
      class(column_type), allocatable :: column
      integer :: method

      column = made(chain(4, 'small'))
      do method = 3, methods
         data = run_data()
         call ask(data, method)
         data%time = times(10, 0.01_wp)
         data%force = 1.0e5_wp*data%time
         data%analysis%dt = 0.005_wp
         call run(data, column)
         call check_passed(error, data%outcome, method_name(method))
         if (allocated(error)) return
         call check_equal(error, size(data%rows, 2), 11, 'rows')
         if (method > 3) call check_equal(error, data%summary%steps, 20, 'steps')
         if (method > 3) call check_equal(error, data%summary%cut_steps, 0, 'cut steps')
         if (method == 3) call check_true(error, data%summary%steps > 20, 'rk45 has taken shorter ones: '// &
                                          to_text(data%summary%steps))
         if (method > 3) call check_close(error, data%summary%time_step, 0.005_wp, 1.0e-14_wp, 0.0_wp, &
                                           'time step')
         if (method == 3) call check_true(error, data%summary%time_step < data%summary%stable_step, &
                                          'rk45: the longest step taken')
      end do
   end subroutine long_dt

   subroutine refused(error)
      type(error_type), allocatable, intent(inout) :: error
      type(run_data) :: data
      type(column_record) :: spec
      integer :: method

      do method = 1, methods
         data = run_data()
         call ask(data, method)
         data%time = [0.0_wp, 1.0_wp]
         spec = column_1('pdelta')
         spec%axial_load = 1.01_wp*k_c/height_1
         call run(data, made(spec))
         call check_failed(error, data%outcome, bad_input, 'the column buckles by itself')
         data%time = [0.0_wp]
         call run(data, made(column_1('small')))
         call check_failed(error, data%outcome, bad_input, 'time: 1 point(s)')
      end do
   end subroutine refused

   subroutine idle_loads(error)
      type(error_type), allocatable, intent(inout) :: error
      type(run_data) :: data
      type(column_record) :: spec

      data%time = [0.0_wp, 1.0e-3_wp]
      data%vertical = [1.0_wp, 1.0_wp]
      call run(data, made(column_1('small')))
      call check_failed(error, data%outcome, bad_input, "vertical_acceleration: with kinematics = 'small'")
      deallocate (data%vertical)
      data%axial = [1.0_wp, 1.0_wp]
      call run(data, made(column_1('small')))
      call check_failed(error, data%outcome, bad_input, "axial_load: with kinematics = 'small'")
      call run(data, made(column_1('pdelta')))
      call check_passed(error, data%outcome, 'pdelta')
      spec = column_1('small')
      allocate (spec%axial_spring(1))
      spec%axial_spring(1) = elastic(1.0e9_wp)
      call run(data, made(spec))
      call check_passed(error, data%outcome, 'openings')
   end subroutine idle_loads

   !> A stiff problem: many short bodies under a long loading.
   type(column_record) function stiff() result(spec)
      integer, parameter :: n = 200

      spec = column_1('pdelta')
      spec%n = n
      spec%shear(1) = elastic(value_of(spec%shear(1), 'k')*n)
      call set_value(spec%flexure(1), 'k_c', value_of(spec%flexure(1), 'k_c')*n)
      call set_value(spec%flexure(1), 'k_y', value_of(spec%flexure(1), 'k_y')*n)
      call set_value(spec%flexure(1), 'k_u', value_of(spec%flexure(1), 'k_u')*n)
      call set_value(spec%flexure(1), 'd_c', value_of(spec%flexure(1), 'd_c')/n)
      call set_value(spec%flexure(1), 'd_y', value_of(spec%flexure(1), 'd_y')/n)
      spec%top_mass = 2.0e4_wp
   end function stiff

   subroutine choice(error)
      type(error_type), allocatable, intent(inout) :: error
      type(run_data) :: data
      type(column_record) :: spec

      data%analysis%method = 'auto'
      data%time = [0.0_wp, 0.01_wp]
      call run(data, made(chain(2, 'small')))
      call check_passed(error, data%outcome, 'elastic')
      call check_equal(error, trim(data%summary%method), 'rk4', 'elastic')
      call check_true(error, .not. data%plan%located, 'elastic: no events to locate')
      call run(data, made(column_1('small')))
      call check_passed(error, data%outcome, 'yields')
      call check_equal(error, trim(data%summary%method), 'rk4', 'yields')
      call check_contains(error, data%summary%reason, 'located', 'yields')
      call run(data, made(column_1('finite')))
      call check_passed(error, data%outcome, 'finite')
      call check_equal(error, trim(data%summary%method), 'rk45', 'finite')
      call check_contains(error, data%summary%reason, 'finite rotations', 'finite')
      data%analysis%tolerance = 1.0e-8_wp
      call run(data, made(column_1('small')))
      call check_passed(error, data%outcome, 'tolerance')
      call check_equal(error, trim(data%summary%method), 'rk45', 'tolerance')
      call check_contains(error, data%summary%reason, '1e-08', 'tolerance')
      data%analysis%tolerance = unset
      data%time = times(50, 0.02_wp)
      data%ground = 5.0_wp*sin(20.0_wp*data%time)
      spec = stiff()
      call run(data, made(spec))
      call check_passed(error, data%outcome, 'stiff')
      call check_equal(error, trim(data%summary%method), 'generalised_alpha', 'stiff')
      call check_contains(error, data%summary%reason, 'stiff', 'stiff')
   end subroutine choice

   !> Numbers of steps in the reason are those of the plans.
   subroutine reason(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp) :: time(51)
      class(column_type), allocatable :: column
      type(time_plan) :: auto, named

      time = times(50, 0.02_wp)
      column = made(stiff())
      call planned('auto', auto)
      call planned('generalised_alpha', named)
      call check_equal(error, auto%steps, named%steps, 'auto plans the steps of the method')
      call check_number(named%steps, number_after(auto%reason, 'takes about'), 'generalised-alpha')
      call planned('rk4', named)
      call check_number(named%steps, number_after(auto%reason, 'would take'), 'rk4')
      column = made(column_1('small'))
      call planned('auto', auto)
      call planned('rk4', named)
      call check_equal(error, auto%steps, named%steps, 'auto plans the steps of the method')
      call check_number(named%steps, number_after(auto%reason, ''), 'rk4')

   contains

      subroutine planned(method, plan)
         character(len=*), intent(in) :: method
         type(time_plan), intent(out) :: plan
         type(error_type), allocatable :: outcome

         ! Nothing is run: any effort may be planned.
         call plan_dynamic(column, analysis_record(method=method, max_seconds=huge(1.0_wp)), time, &
                           loads_type(), plan, outcome)
         call check_passed(error, outcome, method)
      end subroutine planned

      !> The stated number is an upper bound: intervals of the loading are cut into whole numbers of steps.
      subroutine check_number(steps, told, what)
         integer, intent(in) :: steps
         real(wp), intent(in) :: told
         character(len=*), intent(in) :: what

         ! The reason has six digits.
         call check_true(error, steps <= 1.00001_wp*told .and. steps >= 0.5_wp*told, &
                         what//': reported '//to_text(told)//' steps, planned '//to_text(steps))
      end subroutine check_number

      !> The number after a word.
      real(wp) function number_after(text, word)
         character(len=*), intent(in) :: text, word
         integer :: at, status

         at = index(text, word) + len(word)
         read (text(at:), *, iostat=status) number_after
         call check_equal(error, status, 0, "a number after '"//word//"' in '"//trim(text)//"'")
      end function number_after

   end subroutine reason

   subroutine auto_is_method(error)
      type(error_type), allocatable, intent(inout) :: error
      type(run_data) :: auto, named
      type(column_record) :: spec(4)
      integer :: i

      spec(1) = chain(2, 'small')
      spec(2) = column_1('pdelta')
      spec(3) = column_1('finite')
      spec(4) = stiff()
      do i = 1, 4
         auto = run_data()
         auto%analysis%method = 'auto'
         auto%time = times(20, 0.02_wp)
         auto%ground = 20.0_wp*sin(50.0_wp*auto%time)
         named = auto
         call run(auto, made(spec(i)))
         call check_passed(error, auto%outcome, 'auto')
         if (allocated(error)) return
         named%analysis%method = auto%summary%method
         if (auto%plan%located) named%analysis%events = 'located'
         call run(named, made(spec(i)))
         call check_passed(error, named%outcome, auto%summary%method)
         if (allocated(error)) return
         call check_same(error, pack(auto%rows, .true.), pack(named%rows, .true.), auto%summary%method)
         call check_true(error, named%summary%reason == '', 'a method that the user names has no reason')
         call check_true(error, auto%summary%reason /= '', 'a reason for the choice')
      end do
   end subroutine auto_is_method

   !> Nothing moves without a cause, with axial springs of every rule.
   subroutine at_rest(error)
      type(error_type), allocatable, intent(inout) :: error
      type(run_data) :: data
      type(column_record) :: spec
      integer :: kind, method, n

      do kind = 1, 3
         do n = 1, 4, 3
            do method = 1, methods
               spec = chain(n, 'pdelta')
               spec%axial_load = 1.0e6_wp
               spec%self_weight = .true.
               allocate (spec%axial_spring(1))
               spec%axial_spring(1) = elastic(2.0e9_wp)
               if (kind == 2) spec%axial_spring(1) = compression(2.0e9_wp)
               if (kind == 3) spec%axial_spring(1) = bilinear(2.0e9_wp, 1.0e-4_wp, 1.0e8_wp)
               data = run_data()
               data%time = times(10, 1.0e-3_wp)
               call ask(data, method)
               call run(data, made(spec))
               call check_passed(error, data%outcome, method_name(method))
               if (allocated(error)) return
               call check_true(error, maxval(data%rows(row_kinetic, :)) < 1.0e-15_wp, &
                               trim(method_name(method))//', kind '//to_text(kind)//': it moves')
               call check_close(error, data%rows(row_joints + 5*n, 11), &
                                -1.0e6_wp - sum(spec%masses)*9.80665_wp, 1.0e-9_wp, 0.0_wp, &
                                'axial force at the base')
               call check_close(error, data%rows(row_residual, :), spread(0.0_wp, 1, 11), 0.0_wp, 1.0e-9_wp, &
                                'balance of energy')
            end do
         end do
      end do
   end subroutine at_rest

   subroutine cannot_carry(error)
      type(error_type), allocatable, intent(inout) :: error
      type(run_data) :: data
      type(column_record) :: spec

      spec = chain(3, 'small')
      spec%axial_load = -1.0e5_wp
      allocate (spec%axial_spring(1))
      spec%axial_spring(1) = compression(1.0e9_wp)
      data%time = [0.0_wp, 0.01_wp]
      call run(data, made(spec))
      call check_failed(error, data%outcome, analysis_failed, &
                        'the axial spring of joint 1 cannot carry the axial force of -100000 N')
      ! A lift at the start; the springs could carry the constant load alone.
      spec%axial_load = 1.0e5_wp
      data%axial = [-1.0e5_wp, 1.0e5_wp]
      call run(data, made(spec))
      call check_failed(error, data%outcome, analysis_failed, 'the axial force of -100000 N')
      ! Given openings need no equilibrium.
      data%initial%opening_given = .true.
      call run(data, made(spec))
      call check_passed(error, data%outcome, 'openings given')
   end subroutine cannot_carry

   subroutine openings(error)
      type(error_type), allocatable, intent(inout) :: error
      type(run_data) :: data
      type(column_record) :: spec

      spec = chain(2, 'small')
      spec%axial_load = 1.0e6_wp
      allocate (spec%axial_spring(1))
      spec%axial_spring(1) = elastic(1.0e9_wp)
      data%time = [0.0_wp, 1.0e-4_wp]
      data%axial = [2.0e6_wp, 2.0e6_wp]
      ! Openings of the initial state are used only if they are marked as given.
      data%initial%deformation = [1.0e-5_wp, 0.0_wp, 0.0_wp, 0.0_wp, 7.0_wp, 7.0_wp]
      call run(data, made(spec))
      call check_passed(error, data%outcome, 'found')
      if (allocated(error)) return
      call check_close(error, data%rows(row_joints:row_joints + 5, 1), &
                       [1.0e-5_wp, 0.0_wp, 0.0_wp, 0.0_wp, -2.0e-3_wp, -2.0e-3_wp], 1.0e-14_wp, 0.0_wp, &
                       'slips given, openings found')
      call check_close(error, data%rows(row_top, 1), 2.0_wp - 4.0e-3_wp, 1.0e-14_wp, 0.0_wp, &
                       'height of the top')
      data%initial%deformation(5:) = [1.0e-3_wp, 2.0e-3_wp]
      data%initial%opening_given = .true.
      call run(data, made(spec))
      call check_passed(error, data%outcome, 'given')
      if (allocated(error)) return
      call check_same(error, data%rows(row_joints + 4:row_joints + 5, 1), [1.0e-3_wp, 2.0e-3_wp], 'given')
      call check_true(error, data%rows(row_kinetic, 2) > 1.0_wp, 'not in equilibrium')
   end subroutine openings

   subroutine advance_and_fail(self, state, h, error)
      class(failing_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state
      real(wp), intent(in) :: h
      type(error_type), allocatable, intent(inout) :: error

      self%count = self%count + 1
      self%cut_steps = self%cut_steps + 1
      if (self%count == 8) then
         ! The first half of the step succeeds.
         state%time = state%time + 0.5_wp*h
         state%q(1) = 0.5_wp
         call fatal_error(error, analysis_failed, 'no way to go on at '//to_text(state%time)//' s')
         return
      end if
      self%steps = self%steps + 1
      state%time = state%time + h
      state%q(1) = 0.01_wp*self%count
   end subroutine advance_and_fail

   subroutine failing(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(failing_stepper) :: stepper
      type(located_stepper) :: located
      type(initial_state) :: rest
      type(loads_type) :: none
      type(time_plan) :: plan
      type(task_type) :: task
      type(array_recorder), target :: recorder
      integer :: every

      do every = 1, 3
         call new_plan(plan, [0.0_wp, 1.0_wp], 0.125_wp, 1.0_wp, 1.0_wp, outcome)
         call check_passed(error, outcome, 'plan')
         recorder = array_recorder()
         recorder%channels = new_channels(made(column_1('small')), .true., .false., .false.)
         task = task_type()
         task%recorder => recorder
         task%every = every
         stepper = failing_stepper()
         call march(made(column_1('small')), plan, stepper, [0.0_wp, 1.0_wp], none, rest, task, &
                    outcome)
         call check_failed(error, outcome, analysis_failed, 'no way to go on at 0.9375 s')
         call check_equal(error, recorder%count, 1 + 7/every + 1, 'rows')
         call check_same(error, recorder%rows([row_time, row_displacement], recorder%count), &
                         [0.9375_wp, 0.5_wp], 'the last row is the last good state')
         call check_same(error, recorder%rows([row_time, row_displacement], 2), [0.125_wp, 0.01_wp]*every, &
                         'a row before')
         call check_equal(error, task%summary%rows, recorder%count, 'reported rows')
         call check_equal(error, task%summary%cut_steps, 8, 'reported cut steps')
         call check_equal(error, task%summary%steps, 7, 'reported steps')
      end do
      ! Failure in the very first step: the initial state is the only row.
      stepper = failing_stepper(count=7)
      recorder%count = 0
      task = task_type()
      task%recorder => recorder
      task%every = 1
      call march(made(column_1('small')), plan, stepper, [0.0_wp, 1.0_wp], none, rest, task, outcome)
      call check_failed(error, outcome, analysis_failed, 'no way to go on at 0.0625 s')
      call check_equal(error, recorder%count, 2, 'rows')
      ! If no part of the first step succeeds, the initial state is the only row.
      rest%velocity = [0.0_wp, 1.0_wp]
      call new_located(located, made(column_1('small')), 1.0e-10_wp, 1.0e-2_wp)
      located%shortest = 1.0e-2_wp
      recorder%count = 0
      task = task_type()
      task%recorder => recorder
      task%every = 1
      call march(made(column_1('small')), plan, located, [0.0_wp, 1.0_wp], none, rest, task, outcome)
      call check_failed(error, outcome, analysis_failed, 'does not reach the tolerance')
      call check_equal(error, recorder%count, 1, 'rows')
      call check_equal(error, task%summary%steps, 0, 'steps')
   end subroutine failing

   !> rk45 chooses its own steps; rows follow the steps of the plan.
   subroutine rows(error)
      type(error_type), allocatable, intent(inout) :: error
      type(run_data) :: data, fine
      integer :: i, method

      do method = 2, methods
         data = run_data()
         call shake(data, 1.0_wp, 1.0_wp, 1.0_wp)
         call ask(data, method)
         data%analysis%dt = 1.25e-4_wp
         if (method == 2) data%analysis%dt = 2.5e-5_wp
         fine = data
         call run(data, made(scaled('pdelta', 1.0_wp, 1.0_wp, 1.0_wp)))
         call check_passed(error, data%outcome, method_name(method))
         fine%every = 1
         call run(fine, made(scaled('pdelta', 1.0_wp, 1.0_wp, 1.0_wp)))
         call check_passed(error, fine%outcome, method_name(method))
         if (allocated(error)) return
         i = nint(2.5e-3_wp/data%analysis%dt)
         call check_equal(error, size(fine%rows, 2), 20*i + 1, 'a row after each step')
         call check_same(error, pack(fine%rows(:, ::i), .true.), pack(data%rows, .true.), &
                         trim(method_name(method))//': the same rows')
         call check_true(error, fine%summary%steps >= 20*i, 'steps')
         call check_equal(error, fine%summary%steps, data%summary%steps, 'steps do not depend on rows')
         if (method < 4) call check_true(error, fine%summary%cut_steps > 0, 'steps cut at events')
         if (method == 2) call check_equal(error, fine%summary%steps, 20*i + fine%summary%cut_steps, &
                                           'every cut makes one more step')
      end do
   end subroutine rows

   !> Times of ten thousand seconds have four decimal places less.
   subroutine late(error)
      type(error_type), allocatable, intent(inout) :: error
      type(run_data) :: early, late_one
      real(wp), parameter :: begin = 1.0e4_wp
      real(wp), parameter :: allowed(methods) = [1.0e-2_wp, 1.0e-7_wp, 1.0e-5_wp, 1.0e-6_wp, 1.0e-6_wp, &
                                                 1.0e-6_wp]
      real(wp) :: wrong
      integer :: method

      do method = 1, methods
         early = run_data()
         call shake(early, 1.0_wp, 1.0_wp, 1.0_wp)
         call ask(early, method)
         late_one = early
         late_one%time = late_one%time + begin
         call run(early, made(scaled('pdelta', 1.0_wp, 1.0_wp, 1.0_wp)))
         call check_passed(error, early%outcome, method_name(method))
         call run(late_one, made(scaled('pdelta', 1.0_wp, 1.0_wp, 1.0_wp)))
         call check_passed(error, late_one%outcome, method_name(method))
         if (allocated(error)) return
         call check_same(error, late_one%rows(row_time, :), late_one%time, 'times')
         wrong = maxval(abs(late_one%rows(row_displacement, :) - early%rows(row_displacement, :))) &
                 /maxval(abs(early%rows(row_displacement, :)))
         call check_true(error, wrong < allowed(method), trim(method_name(method))//': differs by '// &
                         to_text(wrong))
         call check_true(error, &
                         abs(late_one%summary%steps - early%summary%steps) <= 5 + early%summary%steps/50, &
                         trim(method_name(method))//': '//to_text(late_one%summary%steps)//' steps, not '// &
                         to_text(early%summary%steps))
      end do
   end subroutine late

   subroutine initial_numbers(error)
      type(error_type), allocatable, intent(inout) :: error
      type(run_data) :: data

      data%time = [0.0_wp, 0.01_wp]
      data%initial%deformation = [0.0_wp, ieee_value(1.0_wp, ieee_quiet_nan)]
      call run(data, made(column_1('small')))
      call check_failed(error, data%outcome, bad_input, 'initial deformation: value 2 of 2 is NaN')
      data%initial%deformation = [0.0_wp, 0.0_wp]
      data%initial%velocity = [1.0e60_wp, 0.0_wp]
      call run(data, made(column_1('small')))
      call check_failed(error, data%outcome, bad_input, 'initial velocity: value 1 of 2 is 1e+60')
   end subroutine initial_numbers

   !> Rotations are absolute, not relative to the body below.
   subroutine peak_rotation(error)
      type(error_type), allocatable, intent(inout) :: error
      type(run_data) :: data

      data%time = [0.0_wp, 1.0e-6_wp]
      data%initial%deformation = [0.0_wp, 0.0_wp, 0.0_wp, 0.1_wp, 0.2_wp, -0.15_wp]
      call run(data, made(chain(3, 'small')))
      call check_passed(error, data%outcome, 'run')
      call check_close(error, data%summary%peak_rotation, 0.3_wp, 1.0e-3_wp, 0.0_wp, 'peak rotation')
   end subroutine peak_rotation

end module test_run
