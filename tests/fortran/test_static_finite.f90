!> The static path with exact rotations: statics by hand, orders, peaks and limits of the path. The elastica
!> is in tests/python/test_extremes_rotations.py, other relations in test_invariants.py.
module test_static_finite
   use check, only: unit_test, check_close, check_equal, check_failed, check_passed, check_true
   use rbs_base_constants, only: pi
   use rbs_base_error, only: error_type, analysis_failed
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_structure_column_column_record, only: column_record
   use runs, only: run_path
   use samples, only: set_value, bilinear, chain, column_1, compression, elastic, takeda, f_y, d_y, k_u, &
                      s_k, height_1
   use row_places, only: row_displacement, row_force, row_axial, row_residual, row_joints, row_input, row_top
   implicit none
   private

   public :: collect_static_finite

contains

   subroutine collect_static_finite(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('back to a peak, and on', back_to_a_peak), &
               unit_test('the residual of the energy decreases with the fourth power', energy_order), &
               unit_test('softening column: capacity under a force, peak under a displacement', softening), &
               unit_test('a smooth peak of the force', smooth_peak), &
               unit_test('a driven top moves as far as the column can follow', farthest_top), &
               unit_test('beyond the critical load: a path by displacement, none by force', buckled), &
               unit_test('an axial spring yields before the path starts', axial_yield), &
               unit_test('a joint that cannot carry tension is named', no_tension)]
   end subroutine collect_static_finite

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
      call run_path(spec, .false., [-x, y, -x, -y, x, -x, y], rows, outcome)
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
               call run_path(beam(3), .true., [(8.0_wp*i/parts, i=1, parts)], rows, outcome)
            else
               call run_path(beam(3), .false., [(0.8_wp*i/parts, i=1, parts)], rows, outcome)
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
      call run_path(spec, .false., height_1*sin(th) + force/s_k, rows, outcome)
      call check_passed(error, outcome, 'driven by displacement')
      if (allocated(error)) return
      call check_close(error, rows(row_force, :), force, 1.0e-9_wp, 0.0_wp, 'force')
      call check_close(error, rows(row_joints + 1, :), th, 1.0e-9_wp, 0.0_wp, 'rotation')
      call check_true(error, force(3) < force(1), 'the force falls')
      call run_path(spec, .true., [-0.5_wp, 0.999_wp, 1.001_wp]*largest, rows, outcome)
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
      call run_path(spec, .false., [(0.002_wp*i, i=1, 300)], rows, outcome)
      call check_passed(error, outcome, 'driven by displacement')
      if (allocated(error)) return
      peak = maxloc(rows(row_force, :), dim=1)
      largest = rows(row_force, peak)
      call check_true(error, peak > 10 .and. peak < 290, 'a peak inside')
      call run_path(spec, .true., [0.5_wp*largest, 1.1_wp*largest], driven, outcome)
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
      call run_path(spec, .false., [0.3_wp, 0.99_wp*farthest, 1.01_wp*farthest], rows, outcome)
      call check_failed(error, outcome, analysis_failed, 'row 3: no equilibrium was found beyond force')
      last = size(rows, 2)
      call check_equal(error, last, 3, 'rows kept')
      call check_close(error, rows(row_displacement, last), farthest, 1.0e-8_wp, 0.0_wp, &
                       'displacement reached')
      ! Below this displacement the path continues.
      call run_path(spec, .false., [0.99_wp, -0.99_wp]*farthest, rows, outcome)
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
      call run_path(spec, .true., [0.1_wp], rows, outcome)
      call check_failed(error, outcome, analysis_failed, &
                        'the axial load is 1.25 times the critical load of the uncracked column')
      th = 0.4_wp
      force = (th - 1.25_wp*sin(th))/cos(th)
      call run_path(spec, .false., [sin(th) + force/100.0_wp], rows, outcome)
      call check_passed(error, outcome, 'driven by displacement')
      call check_close(error, rows(row_force, 1), force, 1.0e-10_wp, 0.0_wp, 'force')
      call check_true(error, force < 0.0_wp, 'it leans against the hand')
      ! At the critical load itself the force starts with the third power.
      spec%axial_load = 1.0_wp
      call run_path(spec, .true., [0.1_wp], rows, outcome)
      call check_failed(error, outcome, analysis_failed, 'critical load')
      call run_path(spec, .false., [0.01_wp], rows, outcome)
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
         call run_path(spec, .false., [0.0_wp, 1.0e-4_wp], rows, outcome)
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
         call run_path(spec, .false., [1.0e-4_wp], rows, outcome)
         call check_failed(error, outcome, analysis_failed, &
                           "the axial spring of joint 1 (rule 'compression')")
         call check_failed(error, outcome, analysis_failed, 'cannot carry the tension of 500 N')
         spec%axial_spring = [elastic(1.0e8_wp), bilinear(1.0e8_wp, 4.0e-6_wp, 0.0_wp)]
         call run_path(spec, .false., [1.0e-4_wp], rows, outcome)
         call check_failed(error, outcome, analysis_failed, "the axial spring of joint 2 (rule 'bilinear')")
         call check_equal(error, size(rows, 2), 0, 'rows')
      end do
   end subroutine no_tension

end module test_static_finite
