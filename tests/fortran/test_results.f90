!> Rows, recorder and summary.
module test_results
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   use check, only: unit_test, check_close, check_equal, check_same, check_true
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_base_units, only: unit_system
   use rbs_output_channels, only: channel_list, new_channels
   use rbs_structure_channel, only: energy_type
   use rbs_output_recorder, only: array_recorder
   use rbs_output_summary, only: figure_type, summary_type
   use samples, only: made, random_type, rich_column
   use row_places, only: row_joints
   implicit none
   private

   public :: collect_results

contains

   subroutine collect_results(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('labels of joints that open', labels_of_openings), &
               unit_test('recorder keeps rows until it is full', recorder), &
               unit_test('summary has peaks with sign, of kept and other rows', peaks), &
               unit_test('figures of a summary: those that apply', figures), &
               unit_test('how a run ends', ends)]
   end subroutine collect_results

   subroutine labels_of_openings(error)
      type(error_type), allocatable, intent(inout) :: error
      type(channel_list) :: channels
      character(len=32), allocatable :: label(:)
      character(len=4), allocatable :: si(:)
      type(unit_system) :: units
      type(random_type) :: random
      integer :: i, j

      channels = new_channels(made(rich_column(12, 'small', .true., random)), .true., .true., .false.)
      call channels%get_labels(units, label, si)
      call check_equal(error, size(label), row_joints + 6*12 - 1, 'number of labels')
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

   !> Energies that all differ.
   pure type(energy_type) function energy_of(input, residual) result(energy)
      real(wp), intent(in) :: input, residual

      energy = energy_type(input=input, kinetic=1.0_wp, spring=2.0_wp, damping=3.0_wp, residual=residual)
   end function energy_of

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

   subroutine figures(error)
      type(error_type), allocatable, intent(inout) :: error
      type(summary_type) :: summary
      type(figure_type), allocatable :: list(:)

      call summary%get_figures(list)
      call check_true(error, all(abs(list%value) <= 0.0_wp), 'nothing seen yet')
      call check_true(error, all(list%name /= 'peak_floor_acceleration'), 'no acceleration')
      call check_true(error, all(list%name /= 'lost_joint' .and. list%name /= 'fall'), 'no fall')
      summary%steps = 7
      summary%stable_step = 0.5_wp
      call summary%see_peak(0.1_wp, 5.0_wp)
      call summary%see_energies(energy_of(50.0_wp, 1.0e-9_wp))
      summary%peak_rotation = 0.25_wp
      summary%cut_steps = 3
      call summary%see_floor(-2.0_wp)
      call summary%get_figures(list)
      call check_same(error, named('steps'), 7.0_wp, 'steps')
      call check_same(error, named('stable_step'), 0.5_wp, 'stable step')
      call check_same(error, named('peak_force'), 5.0_wp, 'peak force')
      call check_same(error, named('damping_energy'), 3.0_wp, 'damping')
      call check_close(error, named('relative_energy_residual'), 1.0e-9_wp/50.0_wp, 1.0e-15_wp, &
                       0.0_wp, 'relative residual')
      call check_same(error, named('peak_rotation'), 0.25_wp, 'peak rotation')
      call check_same(error, named('cut_steps'), 3.0_wp, 'cut steps')
      call check_same(error, named('peak_floor_acceleration'), 2.0_wp, 'acceleration')
      summary%has_force = .false.
      summary%lost_joint = 2
      call summary%get_figures(list)
      call check_true(error, all(index(list%name, 'peak_force') == 0), 'no force')
      call check_same(error, named('lost_joint'), 2.0_wp, 'joint that was lost')
      ! How far a column falls is not known where it does not rest.
      call check_true(error, ieee_is_nan(named('fall')) .and. ieee_is_nan(named('fall_energy')), 'no rest')
      summary%fall%rests = .true.
      call summary%get_figures(list)
      call check_same(error, named('fall'), 0.0_wp, 'rest')

   contains

      real(wp) function named(name)
         character(len=*), intent(in) :: name

         named = list(findloc(list%name == name, .true., dim=1))%value
      end function named

   end subroutine figures

   subroutine ends(error)
      type(error_type), allocatable, intent(inout) :: error
      type(summary_type) :: summary

      call check_equal(error, trim(summary%status()), 'completed', 'end of the loading')
      summary%collapsed = .true.
      call check_equal(error, trim(summary%status()), 'collapsed', 'collapse')
      summary%lost_joint = 1
      call check_equal(error, trim(summary%status()), 'axial_failure', 'loss of the axial load')
   end subroutine ends

end module test_results
