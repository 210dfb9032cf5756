!> The static path, event to event: closed forms. What a user sees of it is
!> proved in tests/python/test_static.py and test_invariants.py.
module test_static
   use check, only: unit_test, check_close, check_failed, check_passed, check_true
   use rbs_base_error, only: error_type, analysis_failed
   use rbs_base_kinds, only: wp
   use rbs_structure_column_column, only: column_type
   use rbs_output_summary, only: summary_type
   use rbs_structure_column_column_record, only: column_record
   use runs, only: run_path
   use samples, only: bilinear, chain, column_1, elastic, made, k_c, d_y, k_u, s_k, s_d, height_1
   use row_places, only: row_displacement, row_force, row_axial, row_joints, row_top
   implicit none
   private

   public :: collect_static

contains

   subroutine collect_static(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('pdelta: elastic column below and beyond its critical load', pdelta_elastic), &
               unit_test('a mechanism of joints shares the motion by their stiffness', mechanism), &
               unit_test('a mechanism in a band', band_mechanism), &
               unit_test('height of the top, largest rotation', height_of_top), &
               unit_test('a force that is that of yield but for its last digits', nearly_yield)]
   end subroutine collect_static

   !> Below the critical load, and beyond it, where the column pushes against the support at its top.
   subroutine pdelta_elastic(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      real(wp), allocatable :: rows(:, :)
      real(wp), parameter :: load(2) = [5.0e7_wp, 2.0e8_wp], x(2) = [0.01_wp, -0.03_wp]
      real(wp) :: force(2)
      integer :: i

      do i = 1, 2
         spec = column_1('pdelta')
         spec%axial_load = load(i)
         spec%shear(1) = elastic(s_k)
         spec%flexure(1) = elastic(k_c)
         call run_path(spec, .false., x, rows, outcome)
         call check_passed(error, outcome, 'driven by displacement')
         call check_close(error, x/rows(row_force, :), spread(1.0_wp/s_k + height_1**2/(k_c &
                          - load(i)*height_1), 1, 2), 1.0e-12_wp, 0.0_wp, 'flexibility')
         force = rows(row_force, :)
         call run_path(spec, .true., force, rows, outcome)
         if (i == 1) then
            call check_passed(error, outcome, 'driven by force')
            call check_close(error, rows(row_displacement, :), x, 1.0e-13_wp, 0.0_wp, 'displacement')
         else
            call check_failed(error, outcome, analysis_failed, &
                              'times the critical load of the uncracked column')
         end if
      end do
   end subroutine pdelta_elastic

   !> Joints of equal strength: the motion is distributed as by hardening in proportion to the stiffness.
   subroutine mechanism(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      real(wp), allocatable :: rows(:, :)
      real(wp), parameter :: ratio(2) = [1.0_wp, 3.0_wp]
      integer :: i

      do i = 1, 2
         spec = column_1('small')
         spec%n = 2
         spec%shear = [bilinear(s_k, s_d, 0.0_wp), bilinear(ratio(i)*s_k, s_d/ratio(i), 0.0_wp)]
         spec%flexure(1) = elastic(k_c)
         call run_path(spec, .false., [0.01_wp, 0.02_wp], rows, outcome)
         call check_passed(error, outcome, 'static path')
         if (allocated(error)) return
         call check_close(error, rows(row_joints:row_joints + 1, 2) - rows(row_joints:row_joints + 1, 1), &
                          [ratio(i), 1.0_wp]/(1.0_wp + ratio(i))*0.01_wp, 1.0e-10_wp, 0.0_wp, 'slips')
         call check_close(error, rows(row_force, :), [s_k*s_d, s_k*s_d], 1.0e-12_wp, 0.0_wp, 'force')
      end do
   end subroutine mechanism

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
      call run_path(spec, .true., [0.5_wp, nearly]*k_c*d_y/height_1, rows, outcome)
      call check_passed(error, outcome, 'path to yield')
      if (allocated(error)) return
      call check_close(error, rows(row_displacement, 2), &
                       nearly*k_c*d_y*(height_1/k_c + 1.0_wp/(s_k*height_1)), 1.0e-12_wp, 0.0_wp, &
                       'displacement')
   end subroutine nearly_yield

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
         call run_path(spec, .false., [0.01_wp, 0.05_wp], rows, outcome)
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

   subroutine height_of_top(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      class(column_type), allocatable :: column
      type(summary_type) :: summary
      real(wp), allocatable :: rows(:, :)
      real(wp) :: turn(3)

      spec = chain(3, 'small')
      call run_path(spec, .false., [0.1_wp, -0.05_wp], rows, outcome, summary=summary)
      call check_passed(error, outcome, 'small')
      call check_close(error, rows(row_top, :), [2.0_wp, 2.0_wp], 1.0e-15_wp, 0.0_wp, 'height')
      turn = [rows(row_joints + 3, 1), sum(rows(row_joints + 3:row_joints + 4, 1)), &
              sum(rows(row_joints + 3:row_joints + 5, 1))]
      call check_close(error, summary%peak_rotation, maxval(abs(turn)), 1.0e-14_wp, 0.0_wp, &
                       'largest rotation')
      spec%kinematics = 'pdelta'
      spec%axial_load = 1.0e6_wp
      column = made(spec)
      call run_path(spec, .false., [0.1_wp], rows, outcome)
      call check_passed(error, outcome, 'pdelta')
      turn = [rows(row_joints + 3, 1), sum(rows(row_joints + 3:row_joints + 4, 1)), &
              sum(rows(row_joints + 3:row_joints + 5, 1))]
      call check_close(error, rows(row_top, 1), 2.0_wp - sum(0.5_wp*column%length*turn**2) &
                       - sum(rows(row_joints + 1:row_joints + 2, 1)*turn(:2)), 1.0e-15_wp, 0.0_wp, 'height')
      call check_close(error, rows(row_axial, 1), 1.0e6_wp*(rows(row_top, 1) - 2.0_wp), 1.0e-10_wp, 0.0_wp, &
                       'work of the axial load')
   end subroutine height_of_top

end module test_static
