!> The static path, event to event: against springs in series, bracketing, closed forms, and other runs.
module test_static
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
   use dense, only: factor_positive, solve_general, solve_positive
   use check, only: unit_test, check_close, check_equal, check_failed, check_passed, check_same, check_true
   use rbs_base_constants, only: unset_integer
   use rbs_base_error, only: error_type, fatal_error, analysis_failed, bad_input
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_structure_column_chain, only: geometric_forces
   use rbs_structure_column_chain_matrices, only: geometric_stiffness
   use rbs_structure_column_column, only: column_type
   use rbs_hysteresis_springs, only: follow_path, spring_array
   use rbs_output_channels, only: new_channels
   use rbs_output_recorder, only: array_recorder, recorder_type
   use rbs_output_summary, only: summary_type
   use rbs_solve_static_chain_equilibrium, only: chain_equilibrium
   use rbs_solve_static_run_static, only: run_static
   use rbs_solve_static_path, only: kept_rows
   use rbs_solve_static_straight, only: trace_straight
   use rbs_solve_task, only: task_type
   use rbs_structure_column_column_record, only: column_record
   use samples, only: set_value, value_of, bilinear, bilinear_1, chain, column_1, elastic, made, &
                      random_type, takeda_1, k_c, d_y, f_y, k_u, s_k, s_d, height_1
   use storeys, only: storeys_type, storeys_equilibrium, new_storeys, share
   use row_places, only: row_time, row_displacement, row_force, row_axial, row_residual, row_joints, &
                         row_spring, row_input, row_top
   implicit none
   private

   public :: collect_static

   !> Accepts a few rows, then fails like a full disk.
   type, extends(recorder_type) :: failing_recorder
      integer :: count = 0
   contains
      procedure :: record => record_and_fail
   end type failing_recorder

contains

   subroutine collect_static(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('elastic column: flexibility of springs in series', series), &
               unit_test('one body, both springs nonlinear: same result by bracketing', bracketing), &
               unit_test('forces of a chain are those of its springs moved separately', chain_of_springs), &
               unit_test('driven by its own force, the column follows the same path', both_drives), &
               unit_test('increments have no effect', increments), &
               unit_test('pdelta: every row is in equilibrium, energy too', equilibrium), &
               unit_test('pdelta: elastic column against its closed form', pdelta_elastic), &
               unit_test('k_post = 0: capacity, the path up to it is kept', capacity), &
               unit_test('pdelta: softening column, force-driven capacity', softening_force), &
               unit_test('pdelta: softening column, displacement-driven beyond the peak', softening), &
               unit_test('a mechanism of equal joints shares the motion', mechanism), &
               unit_test('a mechanism of unequal joints shares it by their stiffness', mechanism_unequal), &
               unit_test('equal cycles return to the peaks exactly', repeated_cycles), &
               unit_test('beyond the critical load: a path by displacement, none by force', &
                         buckled), &
               unit_test('every n-th row and the last', every), &
               unit_test('number of rows kept', rows_kept), &
               unit_test('no targets, no rows', nothing), &
               unit_test('the first target may be zero, targets may repeat', standstill), &
               unit_test('a recorder that fails ends the path', failing), &
               unit_test('a target that is not a number is refused', not_a_number), &
               unit_test('bands and full matrices give the same line', bands), &
               unit_test('rates that are updated are those that are solved for', updated_rates), &
               unit_test('pdelta: a long chain, beyond its peak', long_chain), &
               unit_test('a mechanism in a band', band_mechanism), &
               unit_test('openings do not move and have no other effect', openings), &
               unit_test('height of the top, largest rotation', height_of_top), &
               unit_test('collapse ends the path', collapse), &
               unit_test('a force that is that of yield but for its last digits', nearly_yield), &
               unit_test('another structure: indeterminate, loaded elsewhere than driven', &
                         other_structure), &
               unit_test('another structure is cut and goes on with the same bits', cut_structure)]
   end subroutine collect_static

   subroutine record_and_fail(self, row, error)
      class(failing_recorder), intent(inout) :: self
      real(wp), intent(in) :: row(:)
      type(error_type), allocatable, intent(inout) :: error

      self%count = self%count + 1
      if (self%count == 3) then
         call fatal_error(error, analysis_failed, 'disk full at row '//to_text(row(row_time)))
      end if
   end subroutine record_and_fail

   !> Run into an array of rows.
   subroutine run(spec, by_force, values, rows, outcome, every, summary, collapse_drift)
      type(column_record), intent(in) :: spec
      logical, intent(in) :: by_force
      real(wp), intent(in) :: values(:)
      real(wp), allocatable, intent(out) :: rows(:, :)
      type(error_type), allocatable, intent(out) :: outcome
      integer, intent(in), optional :: every
      type(summary_type), intent(out), optional :: summary
      real(wp), intent(in), optional :: collapse_drift
      type(array_recorder), target :: recorder
      class(column_type), allocatable :: column
      type(task_type) :: task

      if (present(every)) task%every = every
      column = made(spec)
      recorder%channels = new_channels(column, .false., .false., .false.)
      task%recorder => recorder
      if (present(collapse_drift)) task%collapse_drift = collapse_drift
      call run_static(column, by_force, values, task, outcome)
      if (recorder%count == 0) allocate (recorder%rows(recorder%channels%width, 0))
      rows = recorder%rows(:, :recorder%count)
      if (present(summary)) summary = task%summary
   end subroutine run

   subroutine series(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      class(column_type), allocatable :: column
      real(wp), allocatable :: rows(:, :)
      real(wp), parameter :: x(3) = [0.01_wp, -0.02_wp, 0.005_wp]
      real(wp) :: flexibility
      integer, parameter :: n = 4
      integer :: i

      spec = chain(n, 'small')
      column = made(spec)
      flexibility = 0.0_wp
      do i = 1, n
         flexibility = flexibility + 1.0_wp/value_of(spec%shear(i), 'k') &
                       + (2.0_wp - column%joint_height(i))**2/value_of(spec%flexure(i), 'k')
      end do
      call run(spec, .false., x, rows, outcome)
      call check_passed(error, outcome, 'driven by displacement')
      call check_close(error, rows(row_force, :), x/flexibility, 1.0e-13_wp, 0.0_wp, 'force')
      call check_close(error, rows(row_input, :), 0.5_wp*x**2/flexibility, 1.0e-12_wp, 0.0_wp, 'work')
      do i = 1, 3
         call check_close(error, rows(row_joints:row_joints + n - 1, i), &
                          x(i)/flexibility/value_of(spec%shear, 'k'), &
                          1.0e-13_wp, 0.0_wp, 'slips')
      end do
      call run(spec, .true., x/flexibility, rows, outcome)
      call check_passed(error, outcome, 'driven by force')
      call check_close(error, rows(row_displacement, :), x, 1.0e-13_wp, 0.0_wp, 'displacement')
   end subroutine series

   !> Displacements of the top that bring both springs of column 1 far beyond yield and back inside.
   subroutine random_targets(random, x, largest)
      type(random_type), intent(inout) :: random
      real(wp), intent(out) :: x(:)
      real(wp), intent(in) :: largest
      integer :: i

      do i = 1, size(x)
         x(i) = random%uniform(-largest, largest)*i/size(x)
      end do
   end subroutine random_targets

   !> Both springs carry the same force F = V(u) = M(phi)/l, u + l phi = x: bisection on u, from the state at
   !> the last target, with the springs but no other part of the solver.
   subroutine bracketing(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(random_type) :: random
      type(spring_array) :: springs, trial
      real(wp), allocatable :: rows(:, :)
      real(wp) :: x(60), below, above, u
      integer :: i, j

      call random_targets(random, x, 0.03_wp)
      call run(column_1('small'), .false., x, rows, outcome)
      call check_passed(error, outcome, 'static path')
      if (allocated(error)) return
      call springs%create([bilinear_1(), takeda_1('kc')])
      do i = 1, size(x)
         below = -1.0_wp
         above = 1.0_wp
         do j = 1, 80
            u = 0.5_wp*(below + above)
            trial = springs
            call trial%move_all([u, (x(i) - u)/height_1])
            if (trial%force(1) < trial%force(2)/height_1) then
               below = u
            else
               above = u
            end if
         end do
         call springs%move_all([u, (x(i) - u)/height_1])
         call check_close(error, rows(row_force, i), springs%force(2)/height_1, 1.0e-9_wp, 1.0e-6_wp, 'force')
         call check_close(error, rows(row_joints, i), u, 1.0e-8_wp, 1.0e-12_wp, 'slip')
         call check_close(error, rows(row_spring, i), sum(springs%work), 1.0e-8_wp, 1.0e-8_wp, 'work')
      end do
   end subroutine bracketing

   !> A nonlinear chain.
   type(column_record) function yielding_chain(n, kinematics) result(spec)
      integer, intent(in) :: n
      character(len=*), intent(in) :: kinematics
      integer :: i

      spec = column_1(kinematics)
      spec%n = n
      spec%flexure = [(takeda_1('kc'), i=1, n)]
      do i = 1, n
         call set_value(spec%flexure(i), 'k_c', value_of(spec%flexure(i), 'k_c')* &
                        (1.0_wp + 0.3_wp*sin(1.0_wp*i)))
         call set_value(spec%flexure(i), 'k_u', value_of(spec%flexure(i), 'k_u')* &
                        (1.0_wp + 0.2_wp*cos(1.0_wp*i)))
      end do
   end function yielding_chain

   subroutine chain_of_springs(error)
      type(error_type), allocatable, intent(inout) :: error
      integer, parameter :: n = 7
      type(error_type), allocatable :: outcome
      type(random_type) :: random
      type(column_record) :: spec
      class(column_type), allocatable :: column
      real(wp), allocatable :: rows(:, :)
      real(wp) :: x(100), f(100)
      integer :: i

      spec = yielding_chain(n, 'small')
      column = made(spec)
      call random_targets(random, x, 0.05_wp)
      call run(spec, .false., x, rows, outcome)
      call check_passed(error, outcome, 'static path')
      if (allocated(error)) return
      do i = 1, 2*n
         call follow_path(column%spring(i), rows(row_joints - 1 + i, :), f)
         call check_close(error, rows(row_joints - 1 + 2*n + i, :), f, 1.0e-9_wp, 1.0e-4_wp, &
                          'unknown '//to_text(i)//' alone')
         call check_close(error, rows(row_joints - 1 + 2*n + i, :), column%arm(i)*rows(row_force, :), &
                          1.0e-10_wp, 1.0e-4_wp, 'unknown '//to_text(i)//' in equilibrium')
      end do
      call check_close(error, rows(row_displacement, :), matmul(column%arm, &
                       rows(row_joints:row_joints + 2*n - 1, :)), &
                       1.0e-12_wp, 1.0e-15_wp, 'displacement')
      call check_close(error, rows(row_displacement, :), x, 0.0_wp, 0.0_wp, 'targets')
   end subroutine chain_of_springs

   subroutine both_drives(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(random_type) :: random
      type(column_record) :: spec
      real(wp), allocatable :: rows(:, :), again(:, :)
      real(wp) :: x(80)

      spec = yielding_chain(4, 'pdelta')
      spec%axial_load = 1.0e6_wp
      call random_targets(random, x, 0.04_wp)
      call run(spec, .false., x, rows, outcome)
      call check_passed(error, outcome, 'driven by displacement')
      call run(spec, .true., rows(row_force, :), again, outcome)
      call check_passed(error, outcome, 'driven by force')
      if (allocated(error)) return
      call check_close(error, again(row_displacement, :), x, 1.0e-9_wp, 1.0e-12_wp, 'displacement')
   end subroutine both_drives

   subroutine increments(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(random_type) :: random
      type(column_record) :: spec
      real(wp), allocatable :: rows(:, :), cut(:, :)
      integer, parameter :: m = 40, parts = 50
      real(wp) :: x(m), fine(m*parts), from
      integer :: i, j, level

      do level = 1, 2
         spec = yielding_chain(3, 'small')
         if (level == 2) then
            spec%kinematics = 'pdelta'
            spec%axial_load = 1.0e6_wp
         end if
         call random_targets(random, x, 0.04_wp)
         from = 0.0_wp
         do i = 1, m
            do j = 1, parts
               fine((i - 1)*parts + j) = from + (x(i) - from)*j/parts
            end do
            fine(i*parts) = x(i)
            from = x(i)
         end do
         call run(spec, .false., x, rows, outcome)
         call check_passed(error, outcome, 'whole')
         call run(spec, .false., fine, cut, outcome)
         call check_passed(error, outcome, 'cut')
         if (allocated(error)) return
         call check_close(error, cut(row_force, parts::parts), rows(row_force, :), 1.0e-9_wp, 1.0e-5_wp, &
                          'force')
      end do
   end subroutine increments

   subroutine equilibrium(error)
      type(error_type), allocatable, intent(inout) :: error
      integer, parameter :: n = 6
      type(error_type), allocatable :: outcome
      type(random_type) :: random
      type(column_record) :: spec
      class(column_type), allocatable :: column
      real(wp), allocatable :: rows(:, :)
      real(wp) :: x(150), g(2*n), largest
      integer :: i

      spec = yielding_chain(n, 'pdelta')
      spec%axial_load = 2.0e6_wp
      spec%self_weight = .true.
      column = made(spec)
      call random_targets(random, x, 0.05_wp)
      call run(spec, .false., x, rows, outcome)
      call check_passed(error, outcome, 'static path')
      if (allocated(error)) return
      do i = 1, size(x)
         call geometric_forces(column%n, column%length, [column%axial_body, column%axial_slip], &
                               rows(row_joints:row_joints + 2*n - 1, i), g)
         call check_close(error, rows(row_joints + 2*n:, i), column%arm*rows(row_force, i) - g, 1.0e-10_wp, &
                          1.0e-4_wp, 'equilibrium')
      end do
      largest = maxval(abs(rows(row_input, :)))
      call check_true(error, maxval(abs(rows(row_residual, :))) < 1.0e-10_wp*largest, 'energy balance')
      call check_true(error, minval(rows(row_axial, :)) < -0.001_wp*largest, 'the axial load does work')
   end subroutine equilibrium

   subroutine pdelta_elastic(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      real(wp), allocatable :: rows(:, :)
      real(wp), parameter :: load = 5.0e7_wp
      real(wp) :: flexibility

      spec = column_1('pdelta')
      spec%axial_load = load
      spec%shear(1) = elastic(s_k)
      spec%flexure(1) = elastic(k_c)
      flexibility = 1.0_wp/s_k + height_1**2/(k_c - load*height_1)
      call run(spec, .true., [1.0e5_wp, -3.0e5_wp], rows, outcome)
      call check_passed(error, outcome, 'driven by force')
      call check_close(error, rows(row_displacement, :), [1.0e5_wp, -3.0e5_wp]*flexibility, 1.0e-13_wp, &
                       0.0_wp, &
                       'displacement')
   end subroutine pdelta_elastic

   subroutine capacity(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      real(wp), allocatable :: rows(:, :)
      integer :: last

      spec = column_1('small')
      spec%shear(1) = bilinear(s_k, s_d, 0.0_wp)
      call run(spec, .true., [5.0e4_wp, -9.0e4_wp, 9.0e4_wp, 9.2e4_wp, 0.0_wp], rows, outcome)
      call check_failed(error, outcome, analysis_failed, 'row 4: the lateral force 92000 N is beyond')
      call check_failed(error, outcome, analysis_failed, 'the shear spring of joint 1 has no stiffness left')
      call check_failed(error, outcome, analysis_failed, 'force 91221.6 N')
      last = size(rows, 2)
      call check_equal(error, last, 4, 'rows kept')
      call check_close(error, rows(row_force, last), s_k*s_d, 1.0e-12_wp, 0.0_wp, 'force reached')
      ! The same column continues if the displacement drives it.
      call run(spec, .false., [0.05_wp, 0.1_wp, 0.0_wp], rows, outcome)
      call check_passed(error, outcome, 'driven by displacement')
      call check_close(error, rows(row_force, :2), [s_k*s_d, s_k*s_d], 1.0e-12_wp, 0.0_wp, 'force')
   end subroutine capacity

   !> k_u - P l < 0: the force is largest at yield, F l = f_y - P l d_y.
   type(column_record) function softening_column() result(spec)
      spec = column_1('pdelta')
      spec%axial_load = 8.0e6_wp
      spec%shear(1) = elastic(s_k)
   end function softening_column

   subroutine softening_force(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      real(wp), allocatable :: rows(:, :)
      real(wp) :: largest
      integer :: last

      largest = f_y/height_1 - 8.0e6_wp*d_y
      call run(softening_column(), .true., [-0.5_wp, 0.999_wp, 1.001_wp]*largest, rows, outcome)
      call check_failed(error, outcome, analysis_failed, &
                        'beyond the capacity of the column: the flexural spring')
      call check_failed(error, outcome, analysis_failed, 'above what the axial load takes away')
      last = size(rows, 2)
      call check_equal(error, last, 3, 'rows kept')
      call check_close(error, rows(row_force, last), largest, 1.0e-12_wp, 0.0_wp, 'force reached')
   end subroutine softening_force

   subroutine softening(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      real(wp), allocatable :: rows(:, :)
      real(wp) :: rotation(3), force(3)

      rotation = [1.0_wp, 3.0_wp, 10.0_wp]*d_y
      force = (f_y + k_u*(rotation - d_y))/height_1 - 8.0e6_wp*rotation
      call run(softening_column(), .false., force/s_k + height_1*rotation, rows, outcome)
      call check_passed(error, outcome, 'driven by displacement')
      if (allocated(error)) return
      call check_close(error, rows(row_force, :), force, 1.0e-11_wp, 0.0_wp, 'force')
      call check_true(error, rows(row_force, 3) < rows(row_force, 1), 'the force falls')
   end subroutine softening

   subroutine mechanism(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      real(wp), allocatable :: rows(:, :)

      spec = column_1('small')
      spec%n = 2
      spec%shear(1) = bilinear(s_k, s_d, 0.0_wp)
      spec%flexure(1) = elastic(k_c)
      call run(spec, .false., [0.02_wp, -0.02_wp, 0.02_wp], rows, outcome)
      call check_passed(error, outcome, 'static path')
      if (allocated(error)) return
      call check_close(error, rows(row_joints, :), rows(row_joints + 1, :), 1.0e-10_wp, 0.0_wp, 'equal slips')
      call check_close(error, abs(rows(row_force, :)), spread(s_k*s_d, 1, 3), 1.0e-12_wp, 0.0_wp, 'force')
   end subroutine mechanism

   !> Joints of unequal stiffness and equal strength: the motion is distributed as by hardening in proportion
   !> to the stiffness.
   subroutine mechanism_unequal(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      real(wp), allocatable :: rows(:, :)
      real(wp) :: slip(2)

      spec = column_1('small')
      spec%n = 2
      spec%shear = [bilinear(s_k, s_d, 0.0_wp), bilinear(3.0_wp*s_k, s_d/3.0_wp, 0.0_wp)]
      spec%flexure(1) = elastic(k_c)
      call run(spec, .false., [0.01_wp, 0.02_wp], rows, outcome)
      call check_passed(error, outcome, 'static path')
      if (allocated(error)) return
      slip = rows(row_joints:row_joints + 1, 2) - rows(row_joints:row_joints + 1, 1)
      call check_close(error, slip, [0.75_wp, 0.25_wp]*0.01_wp, 1.0e-10_wp, 0.0_wp, 'slips')
   end subroutine mechanism_unequal

   !> Cycles of equal amplitude return to the peak of each spring in spite of round-off: unloading is outer
   !> unloading in every cycle (takeda.md section 2b, the discontinuity in the amplitude).
   subroutine repeated_cycles(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      real(wp), allocatable :: rows(:, :)
      real(wp), parameter :: share(4) = [1.0_wp, 0.9_wp, -1.0_wp, -0.9_wp]
      real(wp) :: slope, first
      integer :: i, j, level

      do level = 1, 2
         spec = yielding_chain(3, 'small')
         if (level == 2) spec%kinematics = 'pdelta'
         spec%axial_load = 744.0e3_wp
         do j = 1, 40
            call run(spec, .false., (0.004_wp + 3.1e-4_wp*j)*[(share(1 + mod(i - 1, 4)), i=1, 24)], rows, &
                     outcome)
            call check_passed(error, outcome, 'static path')
            if (allocated(error)) return
            do i = 5, 24, 2
               slope = (rows(row_force, i) - rows(row_force, i + 1))/(rows(row_displacement, i) &
                                                                      - rows(row_displacement, i + 1))
               if (i == 5) first = slope
               call check_close(error, slope, first, 1.0e-6_wp, 0.0_wp, 'unloading stiffness')
            end do
         end do
      end do
   end subroutine repeated_cycles

   subroutine buckled(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      real(wp), allocatable :: rows(:, :)
      real(wp), parameter :: load = 2.0e8_wp

      spec = column_1('pdelta')
      spec%axial_load = load
      spec%shear(1) = elastic(s_k)
      spec%flexure(1) = elastic(k_c)
      call run(spec, .true., [1.0_wp], rows, outcome)
      call check_failed(error, outcome, analysis_failed, 'times the critical load of the uncracked column')
      ! The column pushes against the support at its top: a negative force.
      call run(spec, .false., [0.01_wp], rows, outcome)
      call check_passed(error, outcome, 'driven by displacement')
      call check_close(error, rows(row_displacement, 1)/rows(row_force, 1), &
                       1.0_wp/s_k + height_1**2/(k_c - load*height_1), 1.0e-12_wp, 0.0_wp, 'flexibility')
   end subroutine buckled

   subroutine every(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(random_type) :: random
      type(summary_type) :: summary
      real(wp), allocatable :: all_rows(:, :), rows(:, :)
      real(wp) :: x(20)

      call random_targets(random, x, 0.02_wp)
      call run(column_1('small'), .false., x, all_rows, outcome, summary=summary)
      call check_passed(error, outcome, 'static path')
      call check_equal(error, summary%steps, 20, 'steps')
      call check_equal(error, summary%rows, 20, 'rows')
      call check_true(error, summary%events > 20, 'events')
      call run(column_1('small'), .false., x, rows, outcome, every=7, summary=summary)
      call check_close(error, rows(row_time, :), 1.0_wp*[0, 7, 14, 19], 0.0_wp, 0.0_wp, 'numbers of the rows')
      call check_close(error, rows(row_force, :), all_rows(row_force, [1, 8, 15, 20]), 0.0_wp, 0.0_wp, &
                       'force')
      call check_equal(error, summary%steps, 20, 'steps')
      call check_equal(error, summary%rows, 4, 'rows')
      call check_close(error, summary%peak_force, &
                       all_rows(row_force, maxloc(abs(all_rows(row_force, :)), dim=1)), 0.0_wp, 0.0_wp, &
                       'the peak is that of all points')
   end subroutine every

   subroutine rows_kept(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      real(wp), allocatable :: rows(:, :)
      real(wp) :: x(12)
      integer :: m, n_th

      x = 0.001_wp
      do m = 1, 12
         do n_th = 1, 13
            call run(column_1('small'), .false., x(:m), rows, outcome, every=n_th)
            call check_equal(error, size(rows, 2), kept_rows(m, n_th), &
                             to_text(m)//' rows, every '//to_text(n_th))
         end do
      end do
      call check_equal(error, kept_rows(0, 3), 0, 'no rows')
      call check_equal(error, kept_rows(9, unset_integer), 9, 'all rows')
   end subroutine rows_kept

   subroutine nothing(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      real(wp), allocatable :: rows(:, :)
      real(wp) :: none(0)

      call run(column_1('small'), .false., none, rows, outcome)
      call check_passed(error, outcome, 'static path')
      call check_equal(error, size(rows, 2), 0, 'rows')
   end subroutine nothing

   subroutine standstill(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      real(wp), allocatable :: rows(:, :)

      call run(column_1('small'), .false., [0.0_wp, 0.01_wp, 0.01_wp, 0.0_wp, 0.0_wp], rows, outcome)
      call check_passed(error, outcome, 'static path')
      call check_close(error, rows(2:row_top - 1, 1), spread(0.0_wp, 1, row_top - 2), 0.0_wp, 0.0_wp, &
                       'at rest')
      call check_close(error, rows(row_joints:, 1), spread(0.0_wp, 1, 4), 0.0_wp, 0.0_wp, 'joints at rest')
      call check_close(error, rows(row_top, 1), height_1, 0.0_wp, 0.0_wp, 'height')
      call check_close(error, rows(2:, 3), rows(2:, 2), 0.0_wp, 0.0_wp, 'the same again')
      call check_close(error, rows(2:, 5), rows(2:, 4), 0.0_wp, 0.0_wp, 'the same again at zero')
   end subroutine standstill

   subroutine failing(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(failing_recorder), target :: recorder
      type(task_type) :: task

      task%recorder => recorder
      recorder%channels = new_channels(made(column_1('small')), .false., .false., .false.)
      call run_static(made(column_1('small')), .false., [0.01_wp, 0.02_wp, 0.03_wp, 0.04_wp], task, outcome)
      call check_failed(error, outcome, analysis_failed, 'disk full at row 2')
      call check_equal(error, recorder%count, 3, 'rows offered')
   end subroutine failing

   subroutine not_a_number(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      real(wp), allocatable :: rows(:, :)
      real(wp) :: values(3)

      values = [0.01_wp, ieee_value(1.0_wp, ieee_quiet_nan), 0.02_wp]
      call run(column_1('small'), .false., values, rows, outcome)
      call check_failed(error, outcome, bad_input, 'displacement: value 2 of 3 is NaN')
      call run(column_1('small'), .true., values, rows, outcome)
      call check_failed(error, outcome, bad_input, 'force: value 2 of 3 is NaN')
      call check_equal(error, size(rows, 2), 0, 'rows')
      call run(column_1('small'), .true., [0.0_wp, -1.0e60_wp], rows, outcome)
      call check_failed(error, outcome, bad_input, 'force: value 2 of 2 is -1e+60')
   end subroutine not_a_number

   !> Springs of a column on lines through zero.
   subroutine put_on_lines(column, k, f0, springs)
      class(column_type), intent(in) :: column
      !> Stiffness, and forces without deformation
      real(wp), intent(in) :: k(:), f0(:)
      type(spring_array), intent(out) :: springs
      integer :: heard(size(k))
      real(wp) :: axial_load(size(k))

      heard = 0
      axial_load = 0.0_wp
      call springs%create(column%rules, heard, axial_load)
      springs%k = k
      springs%f0 = f0
      springs%d0 = 0.0_wp
   end subroutine put_on_lines

   !> One spring after the other changes its stiffness, most of them several times in a row.
   subroutine updated_rates(error)
      type(error_type), allocatable, intent(inout) :: error
      type(chain_equilibrium) :: solved, updated
      type(random_type) :: random
      type(spring_array) :: springs
      class(column_type), allocatable :: column
      type(column_record) :: spec
      real(wp), dimension(4) :: k, none, rate, rate_updated
      integer :: change, spring, updates
      logical :: regular

      spec = chain(2, 'pdelta')
      spec%axial_load = 2.0e6_wp
      column = made(spec)
      call updated%create(column)
      call solved%create(column)
      k = column%initial_stiffness
      none = 0.0_wp
      updates = 0
      do change = 1, 400
         spring = 1 + modulo(change/30, 4)
         k(spring) = column%initial_stiffness(spring)*10.0_wp**random%uniform(-3.0_wp, 0.0_wp)
         call put_on_lines(column, k, none, springs)
         call solved%follow(springs, .false., .true., 0.0_wp, 0.0_wp, rate, regular)
         call check_true(error, regular, 'the column has a line')
         call updated%follow(springs, .false., .false., 0.0_wp, 0.0_wp, rate_updated, regular)
         if (any(abs(rate_updated - rate) > 0.0_wp)) updates = updates + 1
         call check_close(error, rate_updated, rate, 1.0e-11_wp, 1.0e-11_wp*maxval(abs(rate)), 'rates')
         call check_close(error, updated%force_rate, solved%force_rate, 1.0e-11_wp, 0.0_wp, &
                          'rate of the force')
      end do
      call check_true(error, updates > 100, 'many updates')
   end subroutine updated_rates

   !> Random stiffness on both sides of the loss of stability, residuals, gap; few bodies.
   subroutine bands(error)
      type(error_type), allocatable, intent(inout) :: error
      type(chain_equilibrium) :: band
      type(random_type) :: random
      type(spring_array) :: springs
      class(column_type), allocatable :: column
      type(column_record) :: spec
      real(wp), allocatable, dimension(:) :: k, r, rate, correction, rate_band
      real(wp) :: gap, force(2), largest(2)
      logical :: regular, regular_band
      integer :: stable, unstable, i, j, n

      stable = 0
      unstable = 0
      do n = 1, 12
         spec = chain(n, 'pdelta')
         spec%self_weight = .true.
         do j = 1, 20
            spec%axial_load = random%uniform(-4.0e7_wp, 4.0e7_wp)/n
            column = made(spec)
            call band%create(column)
            k = column%initial_stiffness*[(10.0_wp**random%uniform(-3.0_wp, 0.0_wp), i=1, 2*n)]
            r = [(random%uniform(-1.0_wp, 1.0_wp), i=1, 2*n)]
            gap = random%uniform(-1.0e-6_wp, 1.0e-6_wp)
            allocate (rate(2*n), correction(2*n), rate_band(2*n))
            ! Without deformations the residual is what the springs have of forces.
            call put_on_lines(column, k, -r, springs)
            call follow_displacement()
            call band%follow(springs, .false., .true., gap, 0.0_wp, rate_band, regular_band)
            call check_true(error, regular .and. regular_band, 'both have an answer')
            call compare('displacement')
            call check_close(error, band%force_rate, force(1), 1.0e-8_wp, 1.0e-12_wp*s_k, 'rate of the force')
            call follow_force()
            call band%follow(springs, .true., .true., 0.0_wp, 0.0_wp, rate_band, regular_band)
            call check_true(error, regular_band .eqv. regular, 'both are stable, or none')
            if (regular) call compare('force')
            if (regular) stable = stable + 1
            if (.not. regular) unstable = unstable + 1
            deallocate (rate, correction, rate_band)
         end do
      end do
      call check_true(error, stable > 40 .and. unstable > 40, 'stable and unstable columns')

   contains

      !> The tangent as a full matrix.
      subroutine fill(a)
         real(wp), intent(out) :: a(2*n, 2*n)

         call geometric_stiffness(column, a)
         do i = 1, 2*n
            a(i, i) = a(i, i) + k(i)
         end do
      end subroutine fill

      subroutine follow_displacement()
         real(wp) :: a(2*n + 1, 2*n + 1), b(2*n + 1, 2)

         a = 0.0_wp
         call fill(a(:2*n, :2*n))
         a(:2*n, 2*n + 1) = -column%arm
         a(2*n + 1, :2*n) = column%arm
         b(:, 1) = 0.0_wp
         b(:2*n, 2) = r
         b(2*n + 1, :) = [1.0_wp, gap]
         call solve_general(a, b, regular)
         rate = b(:2*n, 1)
         correction = b(:2*n, 2)
         force = b(2*n + 1, :)
      end subroutine follow_displacement

      subroutine follow_force()
         real(wp) :: a(2*n, 2*n)

         call fill(a)
         call factor_positive(a, regular)
         if (.not. regular) return
         rate = column%arm
         correction = r
         call solve_positive(a, rate)
         call solve_positive(a, correction)
      end subroutine follow_force

      !> Slips and rotations relative to the largest, as the residual has entries of different size.
      subroutine compare(drive)
         character(len=*), intent(in) :: drive

         do i = 1, 2
            associate (first => (i - 1)*n + 1, last => i*n)
               largest = [maxval(abs(rate(first:last))), maxval(abs(correction(first:last)))]
               call check_close(error, rate_band(first:last), rate(first:last), 0.0_wp, &
                                1.0e-10_wp*largest(1), 'rates by '//drive)
               call check_close(error, band%correction(first:last), correction(first:last), 0.0_wp, &
                                1.0e-10_wp*largest(2), 'corrections by '//drive)
            end associate
         end do
      end subroutine compare

   end subroutine bands

   subroutine long_chain(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(random_type) :: random
      type(column_record) :: spec
      class(column_type), allocatable :: column
      type(summary_type) :: summary
      integer, parameter :: n = 60
      real(wp), allocatable :: rows(:, :)
      real(wp) :: x(40), g(2*n), largest
      integer :: i

      spec = yielding_chain(n, 'pdelta')
      spec%axial_load = 1.0e6_wp
      spec%self_weight = .true.
      column = made(spec)
      call random_targets(random, x, 0.3_wp)
      x(1) = 0.3_wp
      call run(spec, .false., x, rows, outcome, summary=summary)
      call check_passed(error, outcome, 'static path')
      if (allocated(error)) return
      do i = 1, size(x)
         call geometric_forces(column%n, column%length, [column%axial_body, column%axial_slip], &
                               rows(row_joints:row_joints + 2*n - 1, i), g)
         call check_close(error, rows(row_joints + 2*n:, i), column%arm*rows(row_force, i) - g, 1.0e-9_wp, &
                          1.0e-4_wp, 'equilibrium')
      end do
      largest = maxval(abs(rows(row_input, :)))
      call check_true(error, maxval(abs(rows(row_residual, :))) < 1.0e-11_wp*largest, 'energy balance')
      call check_true(error, abs(rows(row_force, 1)) < 0.8_wp*summary%peak_force .or. summary%events > n, &
                      'springs yield')
      ! The column softens: the force is larger at a third of the displacement.
      call run(spec, .false., [0.1_wp, 0.2_wp, 0.3_wp], rows, outcome)
      call check_passed(error, outcome, 'static path')
      call check_true(error, rows(row_force, 3) < rows(row_force, 2), 'the force falls')
   end subroutine long_chain

   !> The spring stands on the end of its line, so that the joints move the top a little farther.
   subroutine nearly_yield(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      real(wp), allocatable :: rows(:, :)
      real(wp), parameter :: nearly = 1.0_wp - 5.0e-12_wp

      spec = column_1('small')
      spec%shear(1) = elastic(s_k)
      spec%flexure(1) = bilinear(k_c, d_y, k_u)
      call run(spec, .true., [0.5_wp, nearly]*k_c*d_y/height_1, rows, outcome)
      call check_passed(error, outcome, 'path to yield')
      if (allocated(error)) return
      call check_close(error, rows(row_displacement, 2), &
                       nearly*k_c*d_y*(height_1/k_c + 1.0_wp/(s_k*height_1)), 1.0e-12_wp, 0.0_wp, &
                       'displacement')
   end subroutine nearly_yield

   !> Yielding springs of the two storeys and the brace of `storeys`.
   subroutine trace_storeys(by_force, target, task, recorder, outcome)
      logical, intent(in) :: by_force
      real(wp), intent(in) :: target(:)
      type(task_type), intent(inout) :: task
      type(array_recorder), intent(out), target :: recorder
      type(error_type), allocatable, intent(out) :: outcome
      type(storeys_type) :: structure
      type(storeys_equilibrium) :: equilibrium

      call new_storeys(structure, [bilinear(4.0e6_wp, 0.010_wp, 4.0e5_wp), &
                                   bilinear(2.0e6_wp, 0.008_wp, 1.0e5_wp), &
                                   bilinear(1.0e6_wp, 0.030_wp, 5.0e4_wp)])
      equilibrium%moving = 3
      recorder%channels = new_channels(structure, .false., .false., .false.)
      task%recorder => recorder
      call trace_straight(structure, equilibrium, by_force, target, task, outcome)
   end subroutine trace_storeys

   !> Every row is in equilibrium on both floors, and the balance of energy holds with the work of the load on
   !> the floors it acts on. Driven by its own forces it takes the same way.
   subroutine other_structure(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(array_recorder) :: recorder, by_force
      type(task_type) :: task
      type(spring_array) :: springs
      real(wp), parameter :: target(8) = [0.005_wp, 0.02_wp, 0.05_wp, 0.08_wp, -0.01_wp, -0.08_wp, 0.0_wp, &
                                          0.09_wp]
      real(wp) :: f(3)
      integer :: i

      call trace_storeys(.false., target, task, recorder, outcome)
      call check_passed(error, outcome, 'path')
      if (allocated(error)) return
      call springs%create([bilinear(4.0e6_wp, 0.010_wp, 4.0e5_wp), bilinear(2.0e6_wp, 0.008_wp, 1.0e5_wp), &
                           bilinear(1.0e6_wp, 0.030_wp, 5.0e4_wp)])
      associate (rows => recorder%rows, first => size(recorder%rows, 1) - 2)
         do i = 1, size(target)
            ! Each deformation goes one way between these targets.
            call springs%move_all(rows(first:, i))
            f = [springs%force(1), springs%force(2), springs%force(3)]
            call check_close(error, f(1) - f(2), share(1)*rows(row_force, i), 1.0e-12_wp, 1.0e-6_wp, &
                             'lower floor')
            call check_close(error, f(2) + f(3), share(2)*rows(row_force, i), 1.0e-12_wp, 1.0e-6_wp, &
                             'upper floor')
            call check_close(error, sum(rows(first:first + 1, i)), target(i), 1.0e-12_wp, 1.0e-15_wp, &
                             'both storeys')
         end do
         call check_true(error, springs%events > 10, 'springs yield and unload')
         call check_true(error, maxval(abs(rows(row_residual, :))) &
                         < 1.0e-12_wp*rows(row_input, size(target)), 'balance of energy')
         call check_equal(error, springs%events, task%summary%events, 'events')
         call trace_storeys(.true., rows(row_force, :), task, by_force, outcome)
         call check_passed(error, outcome, 'path by force')
         if (allocated(error)) return
         do i = 1, size(target)
            call check_close(error, by_force%rows(:, i), rows(:, i), 1.0e-10_wp, 1.0e-9_wp, 'driven by force')
         end do
      end associate
   end subroutine other_structure

   subroutine cut_structure(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(array_recorder) :: whole, first, second
      type(task_type) :: task, cut
      real(wp), parameter :: target(5) = [0.05_wp, -0.03_wp, 0.02_wp, 0.04_wp, -0.08_wp]

      call trace_storeys(.false., target, task, whole, outcome)
      cut%keeps_end = .true.
      call trace_storeys(.false., target(:3), cut, first, outcome)
      cut%before = cut%after
      call trace_storeys(.false., target(4:), cut, second, outcome)
      call check_passed(error, outcome, 'second part')
      if (allocated(error)) return
      call check_same(error, second%rows(row_displacement:, 1), whole%rows(row_displacement:, 4), 'row 4')
      call check_same(error, second%rows(row_displacement:, 2), whole%rows(row_displacement:, 5), 'row 5')
   end subroutine cut_structure

   !> The shear spring of the base has no stiffness left: its row of K is zero, and K has no inverse.
   subroutine band_mechanism(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      real(wp), allocatable :: rows(:, :)
      integer :: i, n

      do n = 1, 5
         spec = chain(n, 'pdelta')
         spec%axial_load = 1.0e5_wp
         spec%shear(1) = bilinear(1.0e8_wp, 1.0e-3_wp, 0.0_wp)
         call run(spec, .false., [0.01_wp, 0.05_wp], rows, outcome)
         call check_passed(error, outcome, 'static path')
         if (allocated(error)) return
         call check_close(error, rows(row_force, :), [1.0e5_wp, 1.0e5_wp], 1.0e-12_wp, 0.0_wp, 'force')
         call check_close(error, rows(row_joints, 2) - rows(row_joints, 1), 0.04_wp, 1.0e-11_wp, 0.0_wp, &
                          'the base slips')
         do i = 1, 2*n - 1
            call check_close(error, rows(row_joints + i, 2), rows(row_joints + i, 1), 1.0e-9_wp, 0.0_wp, &
                             'the other springs do not move')
         end do
      end do
   end subroutine band_mechanism

   subroutine openings(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(random_type) :: random
      type(column_record) :: spec
      real(wp), allocatable :: rows(:, :), closed(:, :)
      character(len=6), parameter :: kinematics(2) = ['small ', 'pdelta']
      integer, parameter :: bodies(3) = [1, 2, 6]
      real(wp) :: x(30)
      integer :: i, j, n

      do j = 1, 2
         do i = 1, size(bodies)
            n = bodies(i)
            spec = yielding_chain(n, kinematics(j))
            spec%axial_load = 5.0e5_wp
            call random_targets(random, x, 0.05_wp)
            call run(spec, .false., x, closed, outcome)
            call check_passed(error, outcome, 'closed joints')
            spec%axial_spring = [bilinear(1.0e9_wp, 1.0e-4_wp, 1.0e8_wp)]
            call run(spec, .false., x, rows, outcome)
            call check_passed(error, outcome, 'joints that open')
            if (allocated(error)) return
            call check_close(error, rows(row_force, :), closed(row_force, :), 0.0_wp, 0.0_wp, 'force')
            call check_close(error, maxval(abs(rows(row_residual, :))), 0.0_wp, 0.0_wp, &
                             1.0e-10_wp*maxval(abs(rows(row_input, :))), 'energy balance')
            call check_close(error, reshape(rows(row_joints + 2*n:row_joints + 3*n - 1, :), [30*n]), &
                             spread(-1.0e-4_wp - 4.0e5_wp/1.0e8_wp, 1, 30*n), 1.0e-12_wp, 0.0_wp, 'openings')
            call check_close(error, reshape(rows(row_joints + 5*n:, :), [30*n]), &
                             spread(-5.0e5_wp, 1, 30*n), 1.0e-12_wp, 0.0_wp, 'axial forces')
            call check_close(error, rows(row_top, :) - closed(row_top, :), spread(-n*4.1e-3_wp, 1, 30), &
                             1.0e-9_wp, 0.0_wp, 'height')
         end do
      end do
   end subroutine openings

   subroutine height_of_top(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      class(column_type), allocatable :: column
      type(summary_type) :: summary
      real(wp), allocatable :: rows(:, :)
      real(wp) :: turn(3)

      spec = chain(3, 'small')
      call run(spec, .false., [0.1_wp, -0.05_wp], rows, outcome, summary=summary)
      call check_passed(error, outcome, 'small')
      call check_close(error, rows(row_top, :), [2.0_wp, 2.0_wp], 1.0e-15_wp, 0.0_wp, 'height')
      turn = [rows(row_joints + 3, 1), sum(rows(row_joints + 3:row_joints + 4, 1)), &
              sum(rows(row_joints + 3:row_joints + 5, 1))]
      call check_close(error, summary%peak_rotation, maxval(abs(turn)), 1.0e-14_wp, 0.0_wp, &
                       'largest rotation')
      spec%kinematics = 'pdelta'
      spec%axial_load = 1.0e6_wp
      column = made(spec)
      call run(spec, .false., [0.1_wp], rows, outcome)
      call check_passed(error, outcome, 'pdelta')
      turn = [rows(row_joints + 3, 1), sum(rows(row_joints + 3:row_joints + 4, 1)), &
              sum(rows(row_joints + 3:row_joints + 5, 1))]
      call check_close(error, rows(row_top, 1), 2.0_wp - sum(0.5_wp*column%length*turn**2) &
                       - sum(rows(row_joints + 1:row_joints + 2, 1)*turn(:2)), 1.0e-15_wp, 0.0_wp, 'height')
      call check_close(error, rows(row_axial, 1), 1.0e6_wp*(rows(row_top, 1) - 2.0_wp), 1.0e-10_wp, 0.0_wp, &
                       'work of the axial load')
   end subroutine height_of_top

   subroutine collapse(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(summary_type) :: summary
      real(wp), allocatable :: rows(:, :)

      call run(column_1('small'), .false., [0.01_wp, -0.081_wp, 0.1_wp], rows, outcome, every=5, &
               summary=summary, collapse_drift=0.05_wp)
      call check_passed(error, outcome, 'static path')
      call check_true(error, summary%collapsed, 'collapsed')
      call check_close(error, rows(row_displacement, :), [0.01_wp, -0.081_wp], 0.0_wp, 0.0_wp, 'rows')
      call run(column_1('small'), .false., [0.01_wp, -0.07_wp, 0.075_wp], rows, outcome, summary=summary, &
               collapse_drift=0.05_wp)
      call check_passed(error, outcome, 'static path')
      call check_true(error, .not. summary%collapsed, 'not collapsed')
      call check_equal(error, size(rows, 2), 3, 'rows')
   end subroutine collapse

end module test_static
