!> The static path with exact rotations: against bracketing, statics by hand, the elastica, and other runs.
module test_static_finite
   use check, only: unit_test, check_close, check_equal, check_failed, check_passed, check_true
   use rbs_base_constants, only: pi
   use rbs_base_error, only: error_type, analysis_failed, bad_input
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_structure_column_column, only: column_type
   use rbs_hysteresis_springs, only: follow_path, spring_array
   use rbs_output_channels, only: new_channels
   use rbs_output_recorder, only: array_recorder
   use rbs_output_summary, only: summary_type
   use rbs_solve_static_run_static, only: run_static
   use rbs_solve_task, only: task_type
   use rbs_structure_column_column_record, only: column_record
   use rbs_hysteresis_spring_record, only: spring_record
   use samples, only: set_value, value_of, bilinear, bilinear_1, chain, column_1, compression, elastic, &
                      made, random_type, takeda, takeda_1, f_y, d_y, k_u, s_k, height_1, mass_1
   use row_places, only: row_displacement, row_force, row_axial, row_residual, row_joints, row_spring, &
                         row_input, row_top
   implicit none
   private

   public :: collect_static_finite

contains

   subroutine collect_static_finite(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('one body: same result by bracketing of its two equations', bracketing), &
               unit_test('small amplitudes: pdelta, and the difference falls with their square', &
                         small_amplitudes), &
               unit_test('elastica: cantilever under an end load, order 2', elastica), &
               unit_test('elastica: buckled cantilever, its top beyond a right angle, order 2', &
                         buckled_elastica), &
               unit_test('every row of a yielding chain is in equilibrium', equilibrium), &
               unit_test('the same with joints that open', equilibrium_opening), &
               unit_test('springs are on their paths', on_their_paths), &
               unit_test('one increment or a hundred', increments), &
               unit_test('driven by its own force, the column follows the same path', both_drives), &
               unit_test('loops through yield close', closed_loops), &
               unit_test('back to a peak, and on', back_to_a_peak), &
               unit_test('the residual of the energy decreases with the fourth power', energy_order), &
               unit_test('softening column: capacity under a force, peak under a displacement', softening), &
               unit_test('a smooth peak of the force', smooth_peak), &
               unit_test('a driven top moves as far as the column can follow', farthest_top), &
               unit_test('beyond the critical load: a path by displacement, none by force', buckled), &
               unit_test('an axial spring yields before the path starts', axial_yield), &
               unit_test('a joint that cannot carry tension is named', no_tension), &
               unit_test('loads that follow are refused', following), &
               unit_test('collapse ends the path', collapse), &
               unit_test('a long chain', long_chain)]
   end subroutine collect_static_finite

   !> Run into an array of rows.
   subroutine run(spec, by_force, values, rows, outcome, summary, drift)
      type(column_record), intent(in) :: spec
      logical, intent(in) :: by_force
      real(wp), intent(in) :: values(:)
      real(wp), allocatable, intent(out) :: rows(:, :)
      type(error_type), allocatable, intent(out) :: outcome
      type(summary_type), intent(out), optional :: summary
      real(wp), intent(in), optional :: drift
      class(column_type), allocatable :: column
      type(array_recorder), target :: recorder
      type(task_type) :: task

      column = made(spec)
      recorder%channels = new_channels(column, .false., .false., .false.)
      task%recorder => recorder
      if (present(drift)) task%collapse_drift = drift
      call run_static(column, by_force, values, task, outcome)
      if (recorder%count == 0) allocate (recorder%rows(recorder%channels%width, 0))
      rows = recorder%rows(:, :recorder%count)
      if (present(summary)) summary = task%summary
   end subroutine run

   subroutine random_targets(random, x, largest)
      type(random_type), intent(inout) :: random
      real(wp), intent(out) :: x(:)
      real(wp), intent(in) :: largest
      integer :: i

      do i = 1, size(x)
         x(i) = random%uniform(-largest, largest)*i/size(x)
      end do
   end subroutine random_targets

   !> V(u) = F and M(th) = F l cos th + P l sin th + m g l/2 sin th with u + l sin th = x: bisection on th,
   !> from the state at the last target, with the springs but no other part of the solver.
   subroutine bracketing(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      type(random_type) :: random
      type(spring_array) :: springs, trial
      real(wp), allocatable :: rows(:, :)
      real(wp), parameter :: load = 2.0e6_wp, g = 9.80665_wp, l = height_1
      real(wp) :: x(60), below, above, th, moment
      integer :: i, j

      spec = column_1('finite')
      spec%axial_load = load
      spec%self_weight = .true.
      call random_targets(random, x, 0.5_wp)
      call run(spec, .false., x, rows, outcome)
      call check_passed(error, outcome, 'static path')
      if (allocated(error)) return
      call springs%create([bilinear_1(), takeda_1('kc')])
      do i = 1, size(x)
         below = -0.5_wp*pi
         above = 0.5_wp*pi
         do j = 1, 80
            th = 0.5_wp*(below + above)
            trial = springs
            call trial%move_all([x(i) - l*sin(th), th])
            moment = trial%force(1)*l*cos(th) + (load + mass_1*g/2.0_wp)*l*sin(th)
            if (trial%force(2) < moment) then
               below = th
            else
               above = th
            end if
         end do
         call springs%move_all([x(i) - l*sin(th), th])
         call check_close(error, rows(row_force, i), springs%force(1), 1.0e-9_wp, 1.0e-4_wp, 'force')
         call check_close(error, rows(row_joints, i), springs%d(1), 1.0e-9_wp, 1.0e-12_wp, 'slip')
         call check_close(error, rows(row_joints + 1, i), th, 1.0e-9_wp, 1.0e-12_wp, 'rotation')
         call check_close(error, rows(row_spring, i), sum(springs%work), 1.0e-8_wp, 1.0e-6_wp, 'work')
         call check_close(error, rows(row_top, i), l*cos(th), 1.0e-12_wp, 0.0_wp, 'height')
      end do
   end subroutine bracketing

   subroutine small_amplitudes(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      real(wp), allocatable :: rows(:, :), second_order(:, :)
      real(wp) :: difference(4), x(2)
      integer :: i, n

      do n = 1, 9, 4
         do i = 1, 4
            spec = chain(n, 'finite')
            spec%axial_load = 1.0e7_wp
            x = [1.0_wp, -0.7_wp]*0.2_wp/2.0_wp**i
            call run(spec, .false., x, rows, outcome)
            call check_passed(error, outcome, 'finite')
            spec%kinematics = 'pdelta'
            call run(spec, .false., x, second_order, outcome)
            call check_passed(error, outcome, 'pdelta')
            if (allocated(error)) return
            difference(i) = maxval(abs(rows(row_force, :)/second_order(row_force, :) - 1.0_wp))
         end do
         call check_true(error, difference(1) > 1.0e-5_wp, 'exact rotations matter')
         do i = 2, 4
            call check_close(error, difference(i - 1)/difference(i), 4.0_wp, 0.02_wp, 0.0_wp, 'order 2')
         end do
      end do
   end subroutine small_amplitudes

   !> A chain for an elastic beam of EI = 1 and length 1 in n parts: a joint represents the two half parts
   !> next to it, so that the curvature is summed by the trapezoidal rule (it is zero at the top).
   type(column_record) function beam(n) result(spec)
      integer, intent(in) :: n
      integer :: i

      spec%n = n
      spec%height = 1.0_wp
      spec%mass = 1.0_wp
      spec%kinematics = 'finite'
      allocate (spec%shear(1))
      spec%shear(1) = elastic(1.0e13_wp)
      spec%flexure = [(elastic(1.0_wp*n), i=1, n)]
      call set_value(spec%flexure(1), 'k', 2.0_wp*n)
   end function beam

   !> Integrals of 1 and of 2 k^2 sin^2 - 1 over sqrt(1 - k^2 sin^2) from `low` to pi/2, by Simpson's rule.
   pure function elliptic(k2, low) result(integral)
      !> k^2, and the lower bound
      real(wp), intent(in) :: k2, low
      real(wp) :: integral(2)
      integer, parameter :: parts = 2000
      real(wp) :: h, s2, weight
      integer :: i

      h = (0.5_wp*pi - low)/parts
      integral = 0.0_wp
      do i = 0, parts
         weight = merge(4.0_wp, 2.0_wp, mod(i, 2) == 1)
         if (i == 0 .or. i == parts) weight = 1.0_wp
         s2 = sin(low + i*h)**2
         integral = integral + weight*h/3.0_wp*[1.0_wp, 2.0_wp*k2*s2 - 1.0_wp]/sqrt(1.0_wp - k2*s2)
      end do
   end function elliptic

   !> Rotation a of the end: sqrt(F L^2/EI) = K(k) - F(asin(1/(k sqrt 2)), k), k^2 = (1 + sin a)/2; with
   !> sin th = 2 k^2 sin^2 - 1 (Bisshopp and Drucker, Quart. Appl. Math. 3 (1945) 272-275).
   subroutine elastica(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      real(wp), allocatable :: rows(:, :)
      real(wp) :: k2, integral(2), force, top(2), wrong(2, 4)
      integer :: i, n

      k2 = 0.5_wp*(1.0_wp + sin(1.3_wp))
      integral = elliptic(k2, asin(sqrt(0.5_wp/k2)))
      force = integral(1)**2
      top = [integral(2)/integral(1), sqrt(2.0_wp*sin(1.3_wp)/force)]
      do i = 1, 4
         n = 10*2**i
         call run(beam(n), .true., [force], rows, outcome)
         call check_passed(error, outcome, 'driven by force')
         if (allocated(error)) return
         wrong(:, i) = [rows(row_displacement, 1), rows(row_top, 1)] - top
      end do
      call check_true(error, maxval(abs(wrong(:, 4))) < 2.0e-4_wp, 'close')
      do i = 2, 4
         call check_close(error, wrong(:, i - 1)/wrong(:, i), [4.0_wp, 4.0_wp], 0.05_wp, 0.0_wp, 'order 2')
      end do
   end subroutine elastica

   !> Without lateral force: sqrt(P L^2/EI) = K(k), x = 2 k/sqrt(P/EI), k = sin(a/2), at a = 110 degrees.
   !> The top is driven there from the straight column; then no force is left.
   subroutine buckled_elastica(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      type(summary_type) :: summary
      real(wp), allocatable :: rows(:, :)
      real(wp) :: angle, k2, integral(2), x, wrong(4), turn
      integer :: i

      angle = 110.0_wp*pi/180.0_wp
      k2 = sin(0.5_wp*angle)**2
      integral = elliptic(k2, 0.0_wp)
      x = 2.0_wp*sqrt(k2)/integral(1)
      do i = 1, 4
         spec = beam(10*2**i)
         spec%axial_load = integral(1)**2
         call run(spec, .false., [0.1_wp*x, x], rows, outcome, summary)
         call check_passed(error, outcome, 'driven by displacement')
         if (allocated(error)) return
         call check_true(error, rows(row_force, 1) < -0.05_wp, 'it leans against the hand')
         wrong(i) = rows(row_force, 2)
         turn = summary%peak_rotation
      end do
      call check_true(error, abs(wrong(4)) < 2.0e-3_wp, 'no force is left')
      call check_close(error, turn, angle, 2.0e-3_wp, 0.0_wp, 'rotation of the top')
      do i = 2, 4
         call check_close(error, wrong(i - 1)/wrong(i), 4.0_wp, 0.05_wp, 0.0_wp, 'order 2')
      end do
   end subroutine buckled_elastica

   !> A nonlinear chain.
   type(column_record) function yielding_chain(n) result(spec)
      integer, intent(in) :: n
      integer :: i

      spec = column_1('finite')
      spec%n = n
      spec%axial_load = 5.0e5_wp
      spec%lengths = [(1.0_wp + 0.3_wp*sin(1.0_wp*i), i=1, n)]
      spec%lengths = spec%lengths*(spec%height/sum(spec%lengths))
      spec%flexure = [(takeda_1('kc'), i=1, n)]
      do i = 1, n
         call set_value(spec%flexure(i), 'k_c', value_of(spec%flexure(i), 'k_c')* &
                        (1.0_wp + 0.3_wp*sin(1.0_wp*i)))
         call set_value(spec%flexure(i), 'k_u', value_of(spec%flexure(i), 'k_u')* &
                        (1.0_wp + 0.2_wp*cos(1.0_wp*i)))
      end do
   end function yielding_chain

   !> Forces and moments of everything above each joint, from the positions of the bodies alone.
   subroutine check_statics(error, column, row, tolerance)
      type(error_type), allocatable, intent(inout) :: error
      class(column_type), intent(in) :: column
      real(wp), intent(in) :: row(:), tolerance
      real(wp), dimension(column%n) :: x, y, x_middle, below
      real(wp) :: top(2), th, shear, moment, tension, weight, down, largest(2)
      integer :: i, n, m

      n = column%n
      m = column%unknowns
      top = 0.0_wp
      th = 0.0_wp
      do i = 1, n
         below(i) = th
         x(i) = top(1) + row(row_joints - 1 + i)*cos(th)
         y(i) = top(2) - row(row_joints - 1 + i)*sin(th)
         if (column%opens) then
            x(i) = x(i) + row(row_joints - 1 + 2*n + i)*sin(th)
            y(i) = y(i) + row(row_joints - 1 + 2*n + i)*cos(th)
         end if
         th = th + row(row_joints - 1 + n + i)
         x_middle(i) = x(i) + 0.5_wp*column%length(i)*sin(th)
         top = [x(i), y(i)] + column%length(i)*[sin(th), cos(th)]
      end do
      call check_close(error, row(row_displacement), top(1), 1.0e-12_wp, 1.0e-13_wp, 'displacement')
      call check_close(error, row(row_top), top(2), 1.0e-12_wp, 0.0_wp, 'height')
      associate (force => row(row_joints + m:))
         largest = [maxval(abs(force(:n))), maxval(abs(force(n + 1:2*n)))]
         down = column%axial_load
         moment = 0.0_wp
         do i = n, 1, -1
            weight = column%gravity*column%mass(i)
            down = down + weight
            shear = row(row_force)*cos(below(i)) + down*sin(below(i))
            tension = row(row_force)*sin(below(i)) - down*cos(below(i))
            moment = row(row_force)*(top(2) - y(i)) + column%axial_load*(top(1) - x(i)) &
                     + sum(column%gravity*column%mass(i:)*(x_middle(i:) - x(i)))
            call check_close(error, force(i), shear, 0.0_wp, tolerance*largest(1), 'shear '//to_text(i))
            call check_close(error, force(n + i), moment, 0.0_wp, tolerance*largest(2), 'moment '//to_text(i))
            if (column%opens) call check_close(error, force(2*n + i), tension, tolerance, &
                                               tolerance*abs(down), 'axial force '//to_text(i))
         end do
      end associate
   end subroutine check_statics

   subroutine equilibrium(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(random_type) :: random
      type(column_record) :: spec
      class(column_type), allocatable :: column
      type(summary_type) :: summary
      real(wp), allocatable :: rows(:, :)
      real(wp) :: x(60), largest
      integer :: i, n

      do n = 1, 13, 4
         spec = yielding_chain(n)
         spec%self_weight = .true.
         column = made(spec)
         call random_targets(random, x, 0.8_wp)
         call run(spec, .false., x, rows, outcome, summary)
         call check_passed(error, outcome, 'static path')
         if (allocated(error)) return
         do i = 1, size(x)
            call check_statics(error, column, rows(:, i), 1.0e-9_wp)
         end do
         largest = maxval(abs(rows(row_input, :)))
         call check_true(error, maxval(abs(rows(row_residual, :))) < 1.0e-6_wp*largest, 'energy balance')
         call check_true(error, minval(rows(row_axial, :)) < -0.001_wp*largest, 'the axial load does work')
         call check_true(error, summary%events > 50, 'springs yield')
         call check_true(error, summary%peak_rotation > 0.2_wp, 'rotations are large')
      end do
   end subroutine equilibrium

   subroutine equilibrium_opening(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(random_type) :: random
      type(column_record) :: spec
      class(column_type), allocatable :: column
      real(wp), allocatable :: rows(:, :)
      real(wp) :: x(40), largest
      integer :: i, j, n

      do n = 1, 5, 2
         do j = 1, 3
            spec = yielding_chain(n)
            spec%self_weight = .true.
            select case (j)
            case (1)
               spec%axial_spring = [elastic(1.0e7_wp)]
            case (2)
               spec%axial_spring = [bilinear(1.0e7_wp, 0.06_wp, 1.0e6_wp)]
            case default
               spec%axial_spring = [compression(2.0e7_wp)]
            end select
            column = made(spec)
            call random_targets(random, x, 0.4_wp)
            call run(spec, .false., x, rows, outcome)
            call check_passed(error, outcome, 'static path')
            if (allocated(error)) return
            do i = 1, size(x)
               call check_statics(error, column, rows(:, i), 1.0e-9_wp)
            end do
            largest = maxval(abs(rows(row_input, :)))
            call check_true(error, maxval(abs(rows(row_residual, :))) < 1.0e-6_wp*largest, 'energy balance')
         end do
      end do
   end subroutine equilibrium_opening

   !> The path to each target in many increments.
   subroutine divide(x, parts, fine)
      real(wp), intent(in) :: x(:)
      integer, intent(in) :: parts
      real(wp), intent(out) :: fine(:)
      real(wp) :: from
      integer :: i, j

      from = 0.0_wp
      do i = 1, size(x)
         do j = 1, parts
            fine((i - 1)*parts + j) = from + (x(i) - from)*j/parts
         end do
         fine(i*parts) = x(i)
         from = x(i)
      end do
   end subroutine divide

   !> Rows so close that no spring can turn back between them unnoticed.
   subroutine on_their_paths(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(random_type) :: random
      class(column_type), allocatable :: column
      real(wp), allocatable :: rows(:, :)
      integer, parameter :: m = 15, parts = 200, n = 3
      real(wp) :: x(m), fine(m*parts), f(m*parts)
      integer :: i

      column = made(yielding_chain(n))
      call random_targets(random, x, 0.4_wp)
      call divide(x, parts, fine)
      call run(yielding_chain(n), .false., fine, rows, outcome)
      call check_passed(error, outcome, 'static path')
      if (allocated(error)) return
      do i = 1, 2*n
         call follow_path(column%spring(i), rows(row_joints - 1 + i, :), f)
         call check_close(error, rows(row_joints - 1 + 2*n + i, :), f, 1.0e-8_wp, 1.0e-2_wp, &
                          'unknown '//to_text(i)//' alone')
      end do
   end subroutine on_their_paths

   subroutine increments(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(random_type) :: random
      real(wp), allocatable :: rows(:, :), cut(:, :)
      integer, parameter :: m = 12, parts = 100
      real(wp) :: x(m), fine(m*parts)
      integer :: n, i

      do n = 1, 9, 4
         call random_targets(random, x, 0.5_wp)
         x(1) = 0.4_wp
         call divide(x, parts, fine)
         call run(yielding_chain(n), .false., x, rows, outcome)
         call check_passed(error, outcome, 'whole')
         call run(yielding_chain(n), .false., fine, cut, outcome)
         call check_passed(error, outcome, 'cut')
         if (allocated(error)) return
         do i = 1, m
            call check_close(error, cut(row_force, parts*i), rows(row_force, i), 1.0e-9_wp, 1.0e-4_wp, &
                             to_text(n)//' bodies: force '//to_text(i))
         end do
      end do
   end subroutine increments

   subroutine both_drives(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(random_type) :: random
      real(wp), allocatable :: rows(:, :), again(:, :)
      real(wp) :: x(40)
      integer :: n

      do n = 1, 5, 2
         call random_targets(random, x, 0.3_wp)
         call run(yielding_chain(n), .false., x, rows, outcome)
         call check_passed(error, outcome, 'driven by displacement')
         call run(yielding_chain(n), .true., rows(row_force, :), again, outcome)
         call check_passed(error, outcome, 'driven by force')
         if (allocated(error)) return
         call check_close(error, again(row_displacement, :), x, 1.0e-8_wp, 1.0e-10_wp, 'displacement')
         call check_true(error, maxval(abs(again(row_residual, :))) &
                         < 1.0e-6_wp*maxval(abs(again(row_input, :))), 'energy balance')
      end do
   end subroutine both_drives

   !> Equal cycles through yield: bilinear springs return from the first peak on, Takeda springs too.
   subroutine closed_loops(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      real(wp), allocatable :: rows(:, :)
      real(wp), parameter :: share(6) = [1.0_wp, 0.5_wp, 0.9_wp, -1.0_wp, 0.2_wp, -0.6_wp]
      integer :: i, j

      do j = 1, 2
         spec = yielding_chain(3)
         if (j == 2) spec%flexure = [(bilinear(1.0e8_wp, 1.0e-3_wp, 5.0e6_wp), i=1, 3)]
         call run(spec, .false., 0.3_wp*[share, share, share, share], rows, outcome)
         call check_passed(error, outcome, 'static path')
         if (allocated(error)) return
         call check_close(error, rows(row_force, 19:24), rows(row_force, 13:18), 1.0e-8_wp, 1.0e-3_wp, &
                          'force')
         call check_close(error, rows(row_spring, 24) - rows(row_spring, 18), &
                          rows(row_spring, 18) - rows(row_spring, 12), 1.0e-8_wp, 0.0_wp, 'work of a loop')
         call check_true(error, rows(row_spring, 24) - rows(row_spring, 18) > 0.0_wp, 'work is lost')
      end do
   end subroutine closed_loops

   !> Where a target is a former peak, springs meet the ends of their lines in its last digits.
   subroutine back_to_a_peak(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      real(wp), allocatable :: rows(:, :)
      real(wp), parameter :: x = 0.007_wp, y = 0.025_wp

      spec = column_1('finite')
      spec%n = 2
      spec%axial_load = 7.0e5_wp
      spec%shear(1) = elastic(7.0e8_wp)
      spec%flexure(1) = takeda(2.5e8_wp, 3.0e-4_wp, 6.0e7_wp, 3.0e-3_wp, 7.0e6_wp, 0.4_wp, 1.0_wp, 'kc')
      spec%mass = 600.0_wp
      call run(spec, .false., [-x, y, -x, -y, x, -x, y], rows, outcome)
      call check_passed(error, outcome, 'static path')
      if (allocated(error)) return
      call check_close(error, rows(row_force, 3), rows(row_force, 1), 1.0e-10_wp, 0.0_wp, 'at the peak')
      call check_close(error, rows(row_force, 4), -rows(row_force, 2), 1.0e-10_wp, 0.0_wp, 'symmetric')
      call check_close(error, rows(row_force, 7), rows(row_force, 2), 1.0e-10_wp, 0.0_wp, 'and again')
   end subroutine back_to_a_peak

   subroutine energy_order(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      real(wp), allocatable :: rows(:, :)
      real(wp) :: residual(3)
      integer :: i, j, k, parts
      logical :: by_force

      do k = 1, 2
         by_force = k == 1
         do j = 1, 3
            parts = 160*2**j
            if (by_force) then
               call run(beam(3), .true., [(8.0_wp*i/parts, i=1, parts)], rows, outcome)
            else
               call run(beam(3), .false., [(0.8_wp*i/parts, i=1, parts)], rows, outcome)
            end if
            call check_passed(error, outcome, 'static path')
            if (allocated(error)) return
            residual(j) = abs(rows(row_residual, parts)/rows(row_input, parts))
         end do
         call check_true(error, residual(1) > 1.0e-12_wp, 'there is something to see')
         call check_true(error, residual(1) < 1.0e-4_wp, 'but not much')
         do j = 2, 3
            call check_true(error, residual(j - 1)/residual(j) > 14.0_wp, 'order 4')
         end do
      end do
   end subroutine energy_order

   !> P l above the stiffness after yield: F l cos th = M - P l sin th decreases from the yield point on.
   subroutine softening(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      real(wp), allocatable :: rows(:, :)
      real(wp), parameter :: load = 8.0e6_wp
      real(wp) :: th(4), force(4), largest
      integer :: last

      spec = column_1('finite')
      spec%axial_load = load
      spec%shear(1) = elastic(s_k)
      th = [1.0_wp, 3.0_wp, 10.0_wp, 40.0_wp]*d_y
      force = (f_y + k_u*(th - d_y))/(height_1*cos(th)) - load*tan(th)
      largest = force(1)
      call run(spec, .false., height_1*sin(th) + force/s_k, rows, outcome)
      call check_passed(error, outcome, 'driven by displacement')
      if (allocated(error)) return
      call check_close(error, rows(row_force, :), force, 1.0e-9_wp, 0.0_wp, 'force')
      call check_close(error, rows(row_joints + 1, :), th, 1.0e-9_wp, 0.0_wp, 'rotation')
      call check_true(error, force(3) < force(1), 'the force falls')
      call run(spec, .true., [-0.5_wp, 0.999_wp, 1.001_wp]*largest, rows, outcome)
      call check_failed(error, outcome, analysis_failed, &
                        'row 3: the lateral force '//to_text(1.001_wp*largest)//' N is beyond the capacity')
      call check_failed(error, outcome, analysis_failed, 'the flexural spring of joint 1 has no stiffness')
      last = size(rows, 2)
      call check_equal(error, last, 3, 'rows kept')
      call check_close(error, rows(row_force, last), largest, 1.0e-10_wp, 0.0_wp, 'force reached')
   end subroutine softening

   !> Soft axial springs: the column gets longer as it leans, and the force has a peak on a smooth curve.
   subroutine smooth_peak(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      real(wp), allocatable :: rows(:, :), driven(:, :)
      real(wp), parameter :: load = 1.0_wp
      real(wp) :: largest
      integer :: i, peak, last

      spec = beam(2)
      spec%axial_load = load
      spec%lengths = [0.95_wp, 0.05_wp]
      spec%axial_spring = [elastic(2.5_wp)]
      spec%flexure = [elastic(0.66_wp), elastic(10.0_wp)]
      call run(spec, .false., [(0.002_wp*i, i=1, 300)], rows, outcome)
      call check_passed(error, outcome, 'driven by displacement')
      if (allocated(error)) return
      peak = maxloc(rows(row_force, :), dim=1)
      largest = rows(row_force, peak)
      call check_true(error, peak > 10 .and. peak < 290, 'a peak inside')
      call run(spec, .true., [0.5_wp*largest, 1.1_wp*largest], driven, outcome)
      call check_failed(error, outcome, analysis_failed, 'is beyond the capacity of the column')
      last = size(driven, 2)
      call check_close(error, driven(row_force, last), largest, 1.0e-5_wp, 0.0_wp, 'force reached')
   end subroutine smooth_peak

   !> P l above k_M: x = l sin th + F/k_V has a maximum, from where F, which pulls back, grows faster.
   subroutine farthest_top(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      real(wp), allocatable :: rows(:, :)
      real(wp) :: th, x, farthest
      integer :: i, last

      spec = beam(1)
      spec%axial_load = 3.0_wp
      call set_value(spec%flexure(1), 'k', 1.0_wp)
      call set_value(spec%shear(1), 'k', 10.0_wp)
      farthest = 0.0_wp
      do i = 1, 100000
         th = 0.5_wp*pi*i/100001
         x = sin(th) + (th - 3.0_wp*sin(th))/cos(th)/10.0_wp
         farthest = max(farthest, x)
      end do
      call run(spec, .false., [0.3_wp, 0.99_wp*farthest, 1.01_wp*farthest], rows, outcome)
      call check_failed(error, outcome, analysis_failed, 'row 3: no equilibrium was found beyond force')
      last = size(rows, 2)
      call check_equal(error, last, 3, 'rows kept')
      call check_close(error, rows(row_displacement, last), farthest, 1.0e-8_wp, 0.0_wp, &
                       'displacement reached')
      ! Below this displacement the path continues.
      call run(spec, .false., [0.99_wp, -0.99_wp]*farthest, rows, outcome)
      call check_passed(error, outcome, 'driven by displacement')
      call check_close(error, rows(row_force, 2), -rows(row_force, 1), 1.0e-10_wp, 0.0_wp, 'symmetric')
   end subroutine farthest_top

   subroutine buckled(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      real(wp), allocatable :: rows(:, :)
      real(wp) :: th, force

      spec = beam(1)
      call set_value(spec%flexure(1), 'k', 1.0_wp)
      call set_value(spec%shear(1), 'k', 100.0_wp)
      spec%axial_load = 1.25_wp
      call run(spec, .true., [0.1_wp], rows, outcome)
      call check_failed(error, outcome, analysis_failed, &
                        'the axial load is 1.25 times the critical load of the uncracked column')
      th = 0.4_wp
      force = (th - 1.25_wp*sin(th))/cos(th)
      call run(spec, .false., [sin(th) + force/100.0_wp], rows, outcome)
      call check_passed(error, outcome, 'driven by displacement')
      call check_close(error, rows(row_force, 1), force, 1.0e-10_wp, 0.0_wp, 'force')
      call check_true(error, force < 0.0_wp, 'it leans against the hand')
      ! At the critical load itself the force starts with the third power.
      spec%axial_load = 1.0_wp
      call run(spec, .true., [0.1_wp], rows, outcome)
      call check_failed(error, outcome, analysis_failed, 'critical load')
      call run(spec, .false., [0.01_wp], rows, outcome)
      call check_passed(error, outcome, 'driven by displacement')
      call check_close(error, rows(row_force, 1), 0.01_wp**3/6.0_wp, 1.0e-3_wp, 0.0_wp, 'third power')
   end subroutine buckled

   !> The axial springs are in equilibrium beyond yield from the start, where the energy balance begins.
   subroutine axial_yield(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      real(wp), allocatable :: rows(:, :)
      real(wp) :: opening(2)
      character(len=6), parameter :: kinematics(3) = ['small ', 'pdelta', 'finite']
      integer :: i

      do i = 1, 3
         spec = chain(2, kinematics(i))
         spec%axial_load = 1.0e5_wp
         spec%self_weight = .true.
         spec%masses = [1000.0_wp, 2000.0_wp]
         spec%axial_spring = [bilinear(1.0e8_wp, 1.1e-3_wp, 1.0e7_wp), bilinear(1.0e8_wp, 1.5e-3_wp, &
                                       1.0e7_wp)]
         opening(2) = -(1.0e5_wp + 2000.0_wp*9.80665_wp)/1.0e8_wp
         opening(1) = -(1.1e-3_wp + (1.0e5_wp + 3000.0_wp*9.80665_wp - 1.1e5_wp)/1.0e7_wp)
         call run(spec, .false., [0.0_wp, 1.0e-4_wp], rows, outcome)
         call check_passed(error, outcome, 'static path')
         if (allocated(error)) return
         call check_close(error, rows(row_joints + 4:row_joints + 5, 1), opening, 1.0e-12_wp, 0.0_wp, &
                          'openings')
         call check_close(error, rows(row_joints + 4:row_joints + 5, 2), opening, 1.0e-6_wp, 0.0_wp, &
                          'openings later')
         call check_close(error, rows(row_top, 1), 2.0_wp + sum(opening), 1.0e-14_wp, 0.0_wp, 'height')
         call check_close(error, rows(row_residual, :), [0.0_wp, 0.0_wp], 0.0_wp, &
                          1.0e-9_wp*rows(row_input, 2), 'energy balance')
         call check_close(error, rows(row_axial, 1), &
                          1.0e5_wp*sum(opening) &
                          + 9.80665_wp*(1000.0_wp*opening(1) + 2000.0_wp*sum(opening)), &
                          1.0e-12_wp, 0.0_wp, 'potential of the axial load')
      end do
   end subroutine axial_yield

   subroutine no_tension(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      real(wp), allocatable :: rows(:, :)
      character(len=6), parameter :: kinematics(3) = ['small ', 'pdelta', 'finite']
      integer :: i

      do i = 1, 3
         spec = chain(2, kinematics(i))
         spec%axial_load = -500.0_wp
         spec%axial_spring = [compression(1.0e8_wp)]
         call run(spec, .false., [1.0e-4_wp], rows, outcome)
         call check_failed(error, outcome, analysis_failed, &
                           "the axial spring of joint 1 (rule 'compression')")
         call check_failed(error, outcome, analysis_failed, 'cannot carry the tension of 500 N')
         spec%axial_spring = [elastic(1.0e8_wp), bilinear(1.0e8_wp, 4.0e-6_wp, 0.0_wp)]
         call run(spec, .false., [1.0e-4_wp], rows, outcome)
         call check_failed(error, outcome, analysis_failed, "the axial spring of joint 2 (rule 'bilinear')")
         call check_equal(error, size(rows, 2), 0, 'rows')
      end do
   end subroutine no_tension

   subroutine following(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      real(wp), allocatable :: rows(:, :)

      spec = column_1('finite')
      spec%axial_follows = .true.
      call run(spec, .false., [0.1_wp], rows, outcome)
      call check_failed(error, outcome, bad_input, 'use a dynamic analysis')
      spec%axial_follows = .false.
      spec%force_follows = .true.
      call run(spec, .true., [0.1_wp], rows, outcome)
      call check_failed(error, outcome, bad_input, 'force_follows')
   end subroutine following

   subroutine collapse(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(summary_type) :: summary
      real(wp), allocatable :: rows(:, :)

      call run(beam(3), .false., [0.1_wp, -0.2_wp, 0.3_wp, 0.1_wp], rows, outcome, summary, drift=0.2_wp)
      call check_passed(error, outcome, 'static path')
      call check_true(error, summary%collapsed, 'collapsed')
      call check_equal(error, size(rows, 2), 2, 'rows')
      call check_equal(error, summary%steps, 2, 'steps')
      call run(beam(3), .false., [0.1_wp, -0.2_wp, 0.3_wp], rows, outcome, summary, drift=0.31_wp)
      call check_passed(error, outcome, 'static path')
      call check_true(error, .not. summary%collapsed, 'not collapsed')
      call check_equal(error, size(rows, 2), 3, 'rows')
   end subroutine collapse

   subroutine long_chain(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      real(wp), allocatable :: rows(:, :)
      real(wp) :: k2, integral(2), force
      integer, parameter :: n = 2000

      k2 = 0.5_wp*(1.0_wp + sin(0.8_wp))
      integral = elliptic(k2, asin(sqrt(0.5_wp/k2)))
      force = integral(1)**2
      spec = beam(n)
      call run(spec, .true., [force], rows, outcome)
      call check_passed(error, outcome, 'driven by force')
      if (allocated(error)) return
      call check_close(error, rows(row_displacement, 1), integral(2)/integral(1), 1.0e-6_wp, 0.0_wp, &
                       'elastica')
      call check_statics(error, made(spec), rows(:, 1), 1.0e-9_wp)
   end subroutine long_chain

end module test_static_finite
