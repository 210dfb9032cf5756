!> Between plain arrays and the types of the library: what the flat procedures call.
module rbs_flat_door
   use, intrinsic :: iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type, message_list, fatal_error, bad_input
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_column_column, only: column_type
   use rbs_loading_protocol, only: protocol_values
   use rbs_loading_signal, only: signal_type
   use rbs_results_recorder, only: array_recorder
   use rbs_results_summary, only: summary_type
   use rbs_solve_history, only: initial_state
   use rbs_solve_run, only: make_column, run_static, run_dynamic, plan_dynamic
   use rbs_solve_time_plan, only: time_plan
   use rbs_spec_check, only: is_given
   use rbs_spec_column, only: column_spec
   use rbs_spec_loading, only: loading_spec
   use rbs_spec_spring, only: spring_spec, rule_names, inner_names
   implicit none
   private

   public :: spring_from_numbers, column_from_numbers, into_rows_static, into_rows_dynamic, &
             protocol_from_numbers, tell

contains

   !> A spring from its numbers k, d_y, k_post, k_c, d_c, k_y, k_u, b0, b1.
   pure function spring_from_numbers(rule, numbers, inner) result(spring)
      character(len=*), intent(in) :: rule, inner
      real(c_double), intent(in) :: numbers(9)
      type(spring_spec) :: spring

      spring%rule = rule
      spring%inner = inner
      spring%k = numbers(1)
      spring%d_y = numbers(2)
      spring%k_post = numbers(3)
      spring%k_c = numbers(4)
      spring%d_c = numbers(5)
      spring%k_y = numbers(6)
      spring%k_u = numbers(7)
      spring%b0 = numbers(8)
      spring%b1 = numbers(9)
   end function spring_from_numbers

   !> A column from its numbers height, mass, axial_load, self_weight (0 or 1), gravity, mass_damping,
   !> stiffness_damping; lengths and masses are given if their first value is.
   subroutine column_from_numbers(column, n, kinematics, numbers, lengths, masses, shear, flexure, &
                                  codes_shear, codes_flexure, error)
      type(column_type), intent(out) :: column
      integer(c_int), intent(in) :: n
      character(len=*), intent(in) :: kinematics
      real(c_double), intent(in) :: numbers(7), lengths(:), masses(:)
      !> Numbers of the springs, one a column, with the places of their rules and inner rules
      real(c_double), intent(in) :: shear(:, :), flexure(:, :)
      integer(c_int), intent(in) :: codes_shear(:, :), codes_flexure(:, :)
      type(error_type), allocatable, intent(out) :: error
      type(column_spec) :: spec

      spec%n = n
      spec%kinematics = kinematics
      spec%height = numbers(1)
      spec%mass = numbers(2)
      spec%axial_load = numbers(3)
      spec%self_weight = abs(numbers(4)) > 0.0_wp
      spec%gravity = numbers(5)
      spec%mass_damping = numbers(6)
      spec%stiffness_damping = numbers(7)
      if (is_given(lengths(1))) spec%lengths = lengths
      if (is_given(masses(1))) spec%masses = masses
      call springs_from_numbers(spec%shear, shear, codes_shear)
      call springs_from_numbers(spec%flexure, flexure, codes_flexure)
      call make_column(spec, column, error)
   end subroutine column_from_numbers

   subroutine springs_from_numbers(springs, numbers, codes)
      type(spring_spec), allocatable, intent(out) :: springs(:)
      real(c_double), intent(in) :: numbers(:, :)
      integer(c_int), intent(in) :: codes(:, :)
      integer :: i

      allocate (springs(size(numbers, 2)))
      do i = 1, size(springs)
         springs(i) = spring_from_numbers(rule_names(codes(1, i)), numbers(:, i), inner_names(codes(2, i)))
      end do
   end subroutine springs_from_numbers

   !> Static path into an array of rows.
   subroutine into_rows_static(column, by_force, target_values, every, rows, count, summary, error)
      type(column_type), intent(in) :: column
      logical, intent(in) :: by_force
      real(c_double), intent(in) :: target_values(:)
      integer(c_int), intent(in) :: every
      real(c_double), intent(inout), target, contiguous :: rows(:, :)
      integer, intent(out) :: count
      type(summary_type), intent(out) :: summary
      type(error_type), allocatable, intent(out) :: error
      type(array_recorder) :: recorder

      recorder%rows => rows
      call run_static(column, by_force, target_values, every, recorder, summary, error)
      count = recorder%count
   end subroutine into_rows_static

   !> Response in time into an array of rows; a loading without points is none.
   subroutine into_rows_dynamic(column, time, force, ground, dt, initial_deformation, initial_velocity, &
                                every, rows, count, summary, error)
      type(column_type), intent(in) :: column
      real(c_double), intent(in) :: time(:), force(:), ground(:), dt
      real(c_double), intent(in) :: initial_deformation(:), initial_velocity(:)
      integer(c_int), intent(in) :: every
      real(c_double), intent(inout), target, contiguous :: rows(:, :)
      integer, intent(out) :: count
      type(summary_type), intent(out) :: summary
      type(error_type), allocatable, intent(out) :: error
      type(array_recorder) :: recorder
      type(initial_state) :: initial
      type(time_plan) :: plan
      type(signal_type) :: force_signal, ground_signal
      real(wp) :: limit

      count = 0
      call plan_dynamic(column, time, dt, plan, limit, error)
      if (allocated(error)) return
      call make_signal(force_signal, 'force', time, force, error)
      if (allocated(error)) return
      call make_signal(ground_signal, 'ground_acceleration', time, ground, error)
      if (allocated(error)) return
      initial%deformation = initial_deformation
      initial%velocity = initial_velocity
      recorder%rows => rows
      call run_dynamic(column, plan, limit, time, force_signal, ground_signal, initial, every, recorder, &
                       summary, error)
      count = recorder%count
   end subroutine into_rows_dynamic

   subroutine make_signal(made, name, time, value, error)
      type(signal_type), intent(out) :: made
      character(len=*), intent(in) :: name
      real(c_double), intent(in) :: time(:), value(:)
      type(error_type), allocatable, intent(out) :: error

      if (size(value) == 0) return
      if (size(value) /= size(time)) then
         call fatal_error(error, bad_input, name//': '//to_text(size(value))//' values for '// &
                          to_text(size(time))//' times; give one for each')
         return
      end if
      made%time = time
      made%value = value
   end subroutine make_signal

   !> Points of a cyclic protocol, in the unit of the amplitudes.
   subroutine protocol_from_numbers(amplitudes, cycles, repeats, points, values, error)
      real(c_double), intent(in) :: amplitudes(:)
      integer(c_int), intent(in) :: cycles(:), repeats, points
      !> Filled as far as there are points
      real(c_double), intent(out) :: values(:)
      type(error_type), allocatable, intent(out) :: error
      type(loading_spec) :: spec
      type(message_list) :: messages
      real(wp), allocatable :: time(:), made(:)

      values = 0.0_wp
      spec%drive = 'force'
      spec%source = 'protocol'
      spec%amplitudes = amplitudes
      spec%cycles = cycles
      spec%repeats = repeats
      spec%points = points
      call spec%validate(.false., messages)
      call messages%raise(error)
      if (allocated(error)) return
      call protocol_values(spec, 1.0_wp, time, made, error)
      if (.not. allocated(error)) values = made(:size(values))
   end subroutine protocol_from_numbers

   !> Status and text of an error, 0 and blank without one.
   subroutine tell(error, status, message)
      type(error_type), allocatable, intent(in) :: error
      integer(c_int), intent(out) :: status
      character(len=*), intent(out) :: message

      status = 0
      message = ''
      if (.not. allocated(error)) return
      status = error%code
      message = error%message
   end subroutine tell

end module rbs_flat_door
