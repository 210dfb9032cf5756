!> Response in time: marching through the plan, springs, energy balance, rows.
module rbs_solve_history
   use rbs_base_constants, only: unset_integer
   use rbs_base_error, only: error_type, fatal_error, analysis_failed
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_column_column, only: column_type
   use rbs_hysteresis_springs, only: spring_array
   use rbs_loading_signal, only: signal_type
   use rbs_results_progress, only: progress_type
   use rbs_results_recorder, only: recorder_type
   use rbs_results_row, only: row_size, row_time, row_displacement, row_force, row_input, row_kinetic, &
                              row_spring, row_damping, row_axial, row_residual, row_joints
   use rbs_results_summary, only: summary_type
   use rbs_solve_motion, only: motion_type
   use rbs_solve_rk4, only: rk4_work, step
   use rbs_solve_time_plan, only: time_plan
   implicit none
   private

   public :: initial_state, march

   !> Beyond this [m, rad] no column is left, and squares would overflow.
   real(wp), parameter :: out_of_bounds = 1.0e100_wp

   !> State at the begin; arrays that are not allocated are zero.
   type :: initial_state
      !> Deformations [m, rad] and velocities [m/s, rad/s] (2 n); the springs get there from zero
      real(wp), allocatable :: deformation(:), velocity(:)
   end type initial_state

   !> State of a run.
   type :: run_type
      type(motion_type) :: motion
      type(spring_array) :: springs
      type(rk4_work) :: work
      type(signal_type) :: force, ground
      real(wp), allocatable :: q(:), v(:)
      real(wp) :: time = 0.0_wp
      !> Lateral force [N] and ground acceleration [m/s2] now
      real(wp) :: force_now = 0.0_wp, ground_now = 0.0_wp
      !> Works of loads and damping, and the energy at the begin [J]
      real(wp) :: of_loads = 0.0_wp, of_damping = 0.0_wp, at_begin = 0.0_wp
   end type run_type

contains

   !> March through the plan.
   subroutine march(column, plan, time, force, ground, initial, every, recorder, summary, error, progress)
      type(column_type), intent(in) :: column
      type(time_plan), intent(in) :: plan
      !> Times of the loading (m) [s]
      real(wp), intent(in) :: time(:)
      !> Lateral force [N] and acceleration of the ground [m/s2]; a signal without points is zero
      type(signal_type), intent(in) :: force, ground
      type(initial_state), intent(in) :: initial
      !> Every n-th step gives a row, and the last; `unset_integer`: every interval of the plan
      integer, intent(in) :: every
      class(recorder_type), intent(inout) :: recorder
      !> On entry with the stability limit
      type(summary_type), intent(inout) :: summary
      !> On failure everything up to the last good state has been recorded
      type(error_type), allocatable, intent(out) :: error
      !> Told now and then how far the run is
      class(progress_type), intent(inout), optional :: progress
      type(run_type) :: run
      real(wp), allocatable :: row(:)
      real(wp) :: finish
      integer :: interval, part, parts

      call start_run(run, column, force, ground, initial, plan%begin, error)
      if (allocated(error)) return
      allocate (row(row_size(column%n)))
      summary%time_step = plan%dt
      call summary%see_peak(run%motion%top_displacement(run%q), run%force_now)
      call keep(run, row, recorder, summary, error)
      if (allocated(error)) return
      do interval = 1, plan%intervals
         call interval_of(plan, time, interval, finish, parts)
         do part = parts, 1, -1
            call take_step(run, (finish - run%time)/part)
            summary%steps = summary%steps + 1
            if (part == 1) run%time = finish
            call summary%see_peak(run%motion%top_displacement(run%q), run%force_now)
            if (.not. maxval(abs(run%q)) < out_of_bounds) then
               call report_unbounded(run, error)
               return
            else if (run%springs%stuck) then
               call fatal_error(error, analysis_failed, 'a hysteresis rule goes in a circle at time '// &
                                to_text(run%time)//' s; the parameters of a spring are too extreme '// &
                                'for the arithmetic. Rows up to there are kept')
               return
            end if
            if (is_kept(summary%steps, part == 1, plan%steps, every)) then
               call keep(run, row, recorder, summary, error)
               if (allocated(error)) return
            end if
            if (mod(summary%steps, 8192) == 0 .and. present(progress)) then
               call progress%update(real(summary%steps, wp)/plan%steps)
            end if
         end do
      end do
   end subroutine march

   !> Whether a step gives a row.
   pure logical function is_kept(step, ends_interval, steps, every)
      !> Number of the step, of all steps, and n of every n-th
      integer, intent(in) :: step, steps, every
      logical, intent(in) :: ends_interval

      if (every == unset_integer) then
         is_kept = ends_interval
      else
         is_kept = mod(step, every) == 0 .or. step == steps
      end if
   end function is_kept

   !> End of an interval between kept times, and the number of its steps.
   pure subroutine interval_of(plan, time, interval, finish, parts)
      type(time_plan), intent(in) :: plan
      real(wp), intent(in) :: time(:)
      integer, intent(in) :: interval
      real(wp), intent(out) :: finish
      integer, intent(out) :: parts

      if (plan%free) then
         parts = 1
         finish = min(plan%begin + interval*plan%dt, plan%finish)
         if (interval == plan%intervals) finish = plan%finish
      else
         parts = plan%parts(interval)
         finish = time(interval + 1)
      end if
   end subroutine interval_of

   subroutine start_run(run, column, force, ground, initial, begin, error)
      type(run_type), intent(out) :: run
      type(column_type), intent(in) :: column
      type(signal_type), intent(in) :: force, ground
      type(initial_state), intent(in) :: initial
      real(wp), intent(in) :: begin
      type(error_type), allocatable, intent(out) :: error
      integer :: m

      m = column%unknowns
      call run%motion%create(column, error)
      if (allocated(error)) return
      call run%springs%create(column%spring)
      call run%work%create(m)
      run%force = force
      run%ground = ground
      run%time = begin
      allocate (run%q(m), run%v(m), source=0.0_wp)
      if (allocated(initial%deformation)) run%q = initial%deformation
      if (allocated(initial%velocity)) run%v = initial%velocity
      call run%springs%move_all(run%q)
      if (run%force%acts()) run%force_now = run%force%at_time(begin)
      if (run%ground%acts()) run%ground_now = run%ground%at_time(begin)
      run%at_begin = run%motion%kinetic_energy(run%q, run%v) + sum(run%springs%work) &
                     + run%motion%potential(run%q)
   end subroutine start_run

   !> One step; the springs follow at its end, along as many lines as they have passed.
   subroutine take_step(run, h)
      type(run_type), intent(inout) :: run
      !> Step [s]
      real(wp), intent(in) :: h
      real(wp) :: force(3), ground(3)

      force = 0.0_wp
      ground = 0.0_wp
      if (run%force%acts()) then
         force = [run%force_now, run%force%at_time(run%time + 0.5_wp*h), run%force%at_time(run%time + h)]
      end if
      if (run%ground%acts()) then
         ground = [run%ground_now, run%ground%at_time(run%time + 0.5_wp*h), &
                   run%ground%at_time(run%time + h)]
      end if
      call step(run%motion, run%springs, run%work, h, force, ground, run%q, run%v, &
                run%of_loads, run%of_damping)
      run%time = run%time + h
      run%force_now = force(3)
      run%ground_now = ground(3)
      if (maxval(abs(run%q)) < out_of_bounds) call run%springs%move_all(run%q)
   end subroutine take_step

   !> Record the present state.
   subroutine keep(run, row, recorder, summary, error)
      type(run_type), intent(in) :: run
      real(wp), intent(inout) :: row(:)
      class(recorder_type), intent(inout) :: recorder
      type(summary_type), intent(inout) :: summary
      type(error_type), allocatable, intent(inout) :: error
      integer :: m

      m = run%springs%count
      row(row_time) = run%time
      row(row_displacement) = run%motion%top_displacement(run%q)
      row(row_force) = run%force_now
      row(row_input) = run%of_loads
      row(row_kinetic) = run%motion%kinetic_energy(run%q, run%v)
      row(row_spring) = sum(run%springs%work)
      row(row_damping) = run%of_damping
      row(row_axial) = run%motion%potential(run%q)
      row(row_residual) = run%of_loads + run%at_begin - row(row_kinetic) - row(row_spring) &
                          - row(row_damping) - row(row_axial)
      row(row_joints:row_joints + m - 1) = run%q
      row(row_joints + m:) = run%springs%f0 + run%springs%k*(run%q - run%springs%d0)
      summary%events = run%springs%events
      call summary%see(row)
      call recorder%record(row, error)
   end subroutine keep

   subroutine report_unbounded(run, error)
      type(run_type), intent(in) :: run
      type(error_type), allocatable, intent(out) :: error

      call fatal_error(error, analysis_failed, 'the motion has no bounds any more at time '// &
                       to_text(run%time)//' s (a deformation is beyond '//to_text(out_of_bounds)// &
                       '); the column has lost its stability under the axial load, or the loading '// &
                       'has a wrong unit. Rows up to there are kept')
   end subroutine report_unbounded

end module rbs_solve_history
