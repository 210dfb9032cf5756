!> Rows, recorder and summary.
module test_results
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   use check, only: unit_test, check_close, check_equal, check_same, check_true
   use rbs_base_error, only: error_type, fatal_error
   use rbs_base_kinds, only: wp
   use rbs_base_units, only: unit_system
   use rbs_output_recorder, only: array_recorder
   use rbs_output_row, only: row_size, row_labels, row_time, row_displacement, row_force, row_input, &
                              row_kinetic, row_spring, row_damping, row_axial, row_residual, row_top, &
                              row_joints
   use rbs_output_summary, only: summary_type, summary_size, summary_names
   implicit none
   private

   public :: collect_results

contains

   subroutine collect_results(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('columns of a row are all different and fill it', places), &
               unit_test('labels carry joint and unit', labels), &
               unit_test('labels of joints that open', labels_of_openings), &
               unit_test('recorder keeps rows until it is full', recorder), &
               unit_test('recorder keeps nothing after an error', recorder_after_error), &
               unit_test('summary has peaks with sign, of kept and other rows', peaks), &
               unit_test('summary has the energies of kept rows', energies), &
               unit_test('summary as an array, in the order of its names', as_array)]
   end subroutine collect_results

   subroutine places(error)
      type(error_type), allocatable, intent(inout) :: error
      integer :: i
      integer, parameter :: all_places(11) = [row_time, row_displacement, row_force, row_input, &
                                              row_kinetic, row_spring, row_damping, row_axial, &
                                              row_residual, row_top, row_joints]

      do i = 1, 11
         call check_equal(error, all_places(i), i, 'place')
      end do
      call check_equal(error, row_size(2), 14, 'one body')
      call check_equal(error, row_size(3), 16, 'one body that opens')
      call check_equal(error, row_size(100), 210, 'fifty bodies')
   end subroutine places

   subroutine labels(error)
      type(error_type), allocatable, intent(inout) :: error
      character(len=32), allocatable :: label(:)
      character(len=4), allocatable :: si(:)
      type(unit_system) :: units

      call row_labels(12, .false., .true., .false., .false., units, label, si)
      call check_equal(error, size(label), row_size(24), 'number of labels')
      call check_equal(error, trim(label(row_time)), 'time_s', 'dynamic')
      call check_equal(error, trim(label(row_residual)), 'residual_J', 'residual')
      call check_equal(error, trim(label(row_top)), 'top_height_m', 'height of the top')
      call check_equal(error, trim(label(row_joints)), 'slip_1_m', 'first slip')
      call check_equal(error, trim(label(row_joints + 12)), 'rotation_1_rad', 'first rotation')
      call check_equal(error, trim(label(row_joints + 35)), 'shear_12_N', 'last shear')
      call check_equal(error, trim(label(row_joints + 47)), 'moment_12_Nm', 'last moment')
      call row_labels(1, .false., .false., .false., .false., units, label, si)
      call check_equal(error, trim(label(row_time)), 'step', 'static')
   end subroutine labels

   subroutine labels_of_openings(error)
      type(error_type), allocatable, intent(inout) :: error
      character(len=32), allocatable :: label(:)
      character(len=4), allocatable :: si(:)
      type(unit_system) :: units
      integer :: i, j

      call row_labels(12, .true., .true., .false., .false., units, label, si)
      call check_equal(error, size(label), row_size(36), 'number of labels')
      call check_equal(error, trim(label(row_joints + 23)), 'rotation_12_rad', 'last rotation')
      call check_equal(error, trim(label(row_joints + 24)), 'opening_1_m', 'first opening')
      call check_equal(error, trim(label(row_joints + 35)), 'opening_12_m', 'last opening')
      call check_equal(error, trim(label(row_joints + 36)), 'shear_1_N', 'first shear')
      call check_equal(error, trim(label(row_joints + 59)), 'moment_12_Nm', 'last moment')
      call check_equal(error, trim(label(row_joints + 71)), 'axial_force_12_N', 'last axial force')
      do i = 1, size(label)
         do j = i + 1, size(label)
            call check_true(error, label(i) /= label(j), 'two columns with the name '//trim(label(i)))
         end do
      end do
   end subroutine labels_of_openings

   subroutine recorder(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(array_recorder) :: keeper

      keeper%expected = 2
      call keeper%record([1.0_wp, 2.0_wp, 3.0_wp], outcome)
      call keeper%record([4.0_wp, 5.0_wp, 6.0_wp], outcome)
      call keeper%record([7.0_wp, 8.0_wp, 9.0_wp], outcome)
      call check_true(error, .not. allocated(outcome), 'a full recorder takes more rows')
      call check_equal(error, keeper%count, 3, 'rows kept')
      call check_same(error, pack(keeper%rows(:, :3), .true.), 1.0_wp*[1, 2, 3, 4, 5, 6, 7, 8, 9], 'rows')
   end subroutine recorder

   subroutine recorder_after_error(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(array_recorder) :: keeper

      call fatal_error(outcome, 1, 'before')
      call keeper%record([1.0_wp], outcome)
      call check_equal(error, keeper%count, 0, 'rows kept')
      call check_true(error, allocated(outcome), 'the error is still there')
   end subroutine recorder_after_error

   !> A row with a displacement, a force, and energies that all differ.
   pure function row_of(displacement, force, residual) result(row)
      real(wp), intent(in) :: displacement, force, residual
      real(wp) :: row(14)

      row = 0.0_wp
      row(row_displacement) = displacement
      row(row_force) = force
      row(row_input) = 10.0_wp*force
      row(row_kinetic) = 1.0_wp
      row(row_spring) = 2.0_wp
      row(row_damping) = 3.0_wp
      row(row_residual) = residual
   end function row_of

   subroutine peaks(error)
      type(error_type), allocatable, intent(inout) :: error
      type(summary_type) :: summary

      call summary%see_peak(0.1_wp, 5.0_wp)
      call summary%see_peak(-0.3_wp, -4.0_wp)
      call summary%see_peak(0.2_wp, -6.0_wp)
      call summary%see_peak(0.3_wp, 6.0_wp)
      call check_same(error, summary%peak_displacement, -0.3_wp, 'peak displacement: the first of two')
      call check_same(error, summary%peak_force, -6.0_wp, 'peak force')
      call check_same(error, summary%displacement_at_peak, 0.2_wp, 'displacement there')
      call check_equal(error, summary%rows, 0, 'no row')
   end subroutine peaks

   subroutine energies(error)
      type(error_type), allocatable, intent(inout) :: error
      type(summary_type) :: summary

      call summary%see_energies(row_of(0.1_wp, 5.0_wp, 1.0e-9_wp))
      call summary%see_energies(row_of(-0.3_wp, -4.0_wp, -2.0e-9_wp))
      call summary%see_energies(row_of(0.2_wp, -6.0_wp, 0.0_wp))
      call check_same(error, [summary%input, summary%spring, summary%damping], [-60.0_wp, 2.0_wp, 3.0_wp], &
                      'energies at the end')
      call check_same(error, summary%residual, 2.0e-9_wp, 'largest residual')
      call check_same(error, summary%largest, 60.0_wp, 'largest energy')
   end subroutine energies

   subroutine as_array(error)
      type(error_type), allocatable, intent(inout) :: error
      type(summary_type) :: summary
      real(wp) :: values(summary_size)

      values = summary%as_array()
      ! How far a column falls is not known of one that stands.
      call check_true(error, ieee_is_nan(values(named('peak_floor_acceleration'))), 'no acceleration')
      values(named('peak_floor_acceleration')) = 0.0_wp
      call check_same(error, values(:summary_size - 2), spread(0.0_wp, 1, summary_size - 2), &
                      'nothing seen yet')
      call check_true(error, all(ieee_is_nan(values(summary_size - 1:))), 'no fall')
      summary%steps = 7
      summary%stable_step = 0.5_wp
      call summary%see_peak(0.1_wp, 5.0_wp)
      call summary%see_energies(row_of(0.1_wp, 5.0_wp, 1.0e-9_wp))
      values = summary%as_array()
      call check_same(error, values(named('steps')), 7.0_wp, 'steps')
      call check_same(error, values(named('stable_step')), 0.5_wp, 'stable step')
      call check_same(error, values(named('peak_force')), 5.0_wp, 'peak force')
      call check_same(error, values(named('damping_energy')), 3.0_wp, 'damping')
      call check_close(error, values(named('relative_energy_residual')), 1.0e-9_wp/50.0_wp, 1.0e-15_wp, &
                       0.0_wp, 'relative residual')
      summary%peak_rotation = 0.25_wp
      summary%cut_steps = 3
      summary%collapsed = .true.
      values = summary%as_array()
      call check_same(error, values(named('peak_rotation')), 0.25_wp, 'peak rotation')
      call check_same(error, values(named('cut_steps')), 3.0_wp, 'cut steps')
      call check_same(error, values(named('collapsed')), 1.0_wp, 'collapsed')
      call check_true(error, all(summary_names /= ''), 'every number has a name')
   end subroutine as_array

   integer function named(name)
      character(len=*), intent(in) :: name

      named = findloc(summary_names == name, .true., dim=1)
   end function named

end module test_results
