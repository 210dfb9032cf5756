!> The decisions and messages of a run: the method, the end by failure, the initial state.
module test_run
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use check, only: unit_test, check_close, check_contains, check_equal, check_failed, check_passed, &
                    check_same, check_true
   use rbs_base_constants, only: unset
   use rbs_base_error, only: error_type, fatal_error, analysis_failed
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_structure_column_column, only: column_type
   use rbs_output_channels, only: new_channels
   use rbs_output_recorder, only: array_recorder
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
   use samples, only: set_value, value_of, bilinear, chain, column_1, compression, elastic, made, k_u, &
                      height_1
   use row_places, only: row_time, row_displacement, row_kinetic, row_residual, row_joints
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

      tests = [unit_test('without a criterion of collapse the fall is an error', no_bounds), &
               unit_test('auto: the choice', choice), &
               unit_test('auto: the reason is true', reason), &
               unit_test('joints closed by load and weight stay at rest', at_rest), &
               unit_test('joints that cannot carry their load', cannot_carry), &
               unit_test('a stepper that fails: the rows up to the last good state', failing)]
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

   !> P l above the yielded stiffness: once it is pushed beyond yield, the column falls.
   subroutine no_bounds(error)
      type(error_type), allocatable, intent(inout) :: error
      type(run_data) :: data
      type(column_record) :: spec
      integer :: last, method, n

      do n = 1, 3, 2
         do method = 1, methods
            spec = column_1('pdelta')
            spec%n = n
            spec%axial_load = 10.0_wp*k_u/height_1
            data = run_data()
            data%time = times(1000, 0.01_wp)
            data%force = 2.0e5_wp + 0.0_wp*data%time
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

end module test_run
