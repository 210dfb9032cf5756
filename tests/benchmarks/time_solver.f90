!> Times of the solver itself, without Python and without files.
!>
!>     time_solver [repeats [divisor]]
!>
!> A line for every repeat: name, nanoseconds of the processor per unit of work; for one body also how
!> many lines its springs leave in 1000 steps. The divisor makes all runs shorter.
!>
!>     time_solver rk4|newmark N DT STEPS PERIOD STRENGTH
!>     time_solver static POINTS
!>
!> The same work as `yardstick`, which is told there: nanoseconds per step (static: per increment), the
!> peak displacement [m] (static: force [N]), and the memory that the process held at the most [kB].
program time_solver
   use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
   use rbs_base_constants, only: pi
   use rbs_base_error, only: error_type
   use rbs_base_keys, only: key_type, find_key
   use rbs_base_kinds, only: wp
   use rbs_structure_column_column, only: column_type
   use rbs_hysteresis_registry, only: keys_of
   use rbs_hysteresis_springs, only: follow_path, spring_array
   use rbs_output_channels, only: new_channels
   use rbs_output_recorder, only: array_recorder
   use rbs_output_summary, only: summary_type
   use rbs_solve_begin_make_column, only: make_column
   use rbs_solve_static_run_static, only: run_static
   use rbs_solve_task, only: task_type
   use rbs_loading_loads, only: loads_type, lateral
   use rbs_solve_time_march, only: initial_state
   use rbs_solve_time_plan, only: time_plan
   use rbs_solve_time_run_dynamic, only: plan_dynamic, run_dynamic
   use rbs_case_analysis_record, only: analysis_record
   use rbs_structure_column_column_record, only: column_record
   use rbs_hysteresis_rule, only: spring_rules
   use rbs_hysteresis_spring_record, only: spring_record, add_rules
   implicit none

   integer :: repeats, divisor, repeat
   character(len=16) :: label

   call get_command_argument(1, label)
   select case (label)
   case ('static')
      call compare_static(whole_argument(2, 0))
   case ('rk4', 'newmark')
      call compare_dynamic(trim(label), whole_argument(2, 0), real_argument(3), whole_argument(4, 0), &
                           real_argument(5), real_argument(6))
   case default
      repeats = whole_argument(1, 5)
      divisor = whole_argument(2, 1)
      do repeat = 1, repeats
         call time_all()
      end do
   end select

contains

   subroutine time_all()
      integer, parameter :: bodies(3) = [10, 50, 200]
      character(len=16) :: name
      integer :: i

      call time_spring('spring_smooth', .true.)
      call time_spring('spring_random', .false.)
      call time_joint()
      call time_static()
      call time_rk4('rk4_small', 'small', 1)
      call time_rk4('rk4_pdelta', 'pdelta', 1)
      call time_rk4('rk4_finite', 'finite', 1)
      do i = 1, size(bodies)
         write (name, '(a, i0)') 'rk4_n', bodies(i)
         call time_rk4(trim(name), 'pdelta', bodies(i))
      end do
   end subroutine time_all

   integer function whole_argument(i, default) result(value)
      integer, intent(in) :: i, default
      character(len=32) :: word
      integer :: status

      value = default
      call get_command_argument(i, word)
      if (word == '') return
      read (word, *, iostat=status) value
      if (status /= 0 .or. value < 1) error stop 'time_solver: arguments are not as told in its source'
   end function whole_argument

   real(wp) function real_argument(i) result(value)
      integer, intent(in) :: i
      character(len=32) :: word
      integer :: status

      call get_command_argument(i, word)
      read (word, *, iostat=status) value
      if (status /= 0) error stop 'time_solver: arguments are not as told in its source'
   end function real_argument

   subroutine tell(what, begin, count)
      character(len=*), intent(in) :: what
      !> Processor time at the begin [s]; units of work done since
      real(wp), intent(in) :: begin
      integer, intent(in) :: count
      real(wp) :: finish

      call cpu_time(finish)
      write (output_unit, '(a, 1x, f0.3)') what, 1.0e9_wp*(finish - begin)/count
   end subroutine tell

   !> Soesianawati & Park No 1, table 3 of the paper, in n bodies; the base is as in one.
   subroutine make_paper_column(column, kinematics, n)
      class(column_type), allocatable, intent(out) :: column
      character(len=*), intent(in) :: kinematics
      integer, intent(in) :: n
      type(column_record) :: spec
      type(error_type), allocatable :: error

      spec%n = n
      spec%height = 1.6_wp
      spec%mass = 614.4_wp
      spec%kinematics = kinematics
      if (kinematics == 'pdelta') spec%axial_load = 744.0e3_wp
      allocate (spec%shear(1), spec%flexure(1))
      spec%shear(1)%rule = 'bilinear'
      call set_value(spec%shear(1), 'k', 7.0387e8_wp)
      call set_value(spec%shear(1), 'd_y', 1.2960e-4_wp)
      call set_value(spec%shear(1), 'k_post', 8.3185e6_wp)
      spec%flexure(1) = paper_flexure()
      call make_column(spec, column, error)
      if (allocated(error)) error stop 'time_solver: the column is refused'
   end subroutine make_paper_column

   !> Set a parameter of a spring by name.
   subroutine set_value(spec, name, value)
      type(spring_record), intent(inout) :: spec
      character(len=*), intent(in) :: name
      real(wp), intent(in) :: value
      type(key_type), allocatable :: keys(:)

      call keys_of(spec%rule, keys)
      spec%value(find_key(keys, name)) = value
   end subroutine set_value

   type(spring_record) function paper_flexure() result(spec)
      spec%rule = 'takeda'
      call set_value(spec, 'k_c', 2.5428e8_wp)
      call set_value(spec, 'd_c', 3.1891e-4_wp)
      call set_value(spec, 'k_y', 6.2937e7_wp)
      call set_value(spec, 'd_y', 2.7183e-3_wp)
      call set_value(spec, 'k_u', 7.5772e6_wp)
      call set_value(spec, 'b0', 0.4_wp)
      call set_value(spec, 'b1', 0.22_wp)
   end function paper_flexure

   !> A wave whose amplitude grows and falls, with a second one on it that makes inner loops.
   pure function wave(m, cycles, amplitude) result(x)
      integer, intent(in) :: m, cycles
      real(wp), intent(in) :: amplitude
      real(wp) :: x(m)
      integer :: i

      do i = 1, m
         associate (share => real(i, wp)/m, angle => 2.0_wp*pi*cycles*i/m)
            x(i) = amplitude*sin(pi*share)*(sin(angle) + 0.2_wp*sin(7.0_wp*angle))
         end associate
      end do
   end function wave

   !> Takeda spring, per point of the path.
   subroutine time_spring(what, smooth)
      character(len=*), intent(in) :: what
      !> Many points on a line, else a turn or more at every point
      logical, intent(in) :: smooth
      real(wp), allocatable :: d(:), f(:)
      real(wp) :: begin
      integer :: m, i

      m = max(1000000/divisor, 1000)
      allocate (d(m), f(m))
      if (smooth) then
         d = wave(m, m/1000, 0.01_wp)
      else
         do i = 1, m
            d(i) = 0.01_wp*sin(1.0e4_wp*sin(real(i, wp)))
         end do
      end if
      call cpu_time(begin)
      call follow_path(paper_flexure(), d, f)
      call tell(what, begin, m)
   end subroutine time_spring

   !> A joint of 28 strips of concrete and two rows of bars under growing cycles: per event, and per step of a
   !> motion so small that nothing happens.
   subroutine time_joint()
      integer, parameter :: strips = 28, cycles = 40
      type(spring_record) :: joint(1), layer(strips + 2)
      type(spring_rules), target :: rules
      type(spring_array) :: spring
      real(wp) :: y(strips + 2), begin, turning
      integer :: i, m, events, run, runs

      do i = 1, strips
         y(i) = 0.4_wp*((i - 0.5_wp)/strips - 0.5_wp)
         layer(i)%rule = 'concrete'
         call set_value(layer(i), 'k', 1.6e10_wp/strips)
         call set_value(layer(i), 'f_peak', 4.8e6_wp/strips)
         call set_value(layer(i), 'd_peak', 6.0e-4_wp)
         call set_value(layer(i), 'k_soft', 3.0e8_wp/strips)
         call set_value(layer(i), 'f_res', 1.5e6_wp/strips)
         call set_value(layer(i), 'contact', 0.35_wp)
         call set_value(layer(i), 'misfit', 0.4_wp)
         call set_value(layer(i), 'wear', 0.03_wp)
      end do
      y(strips + 1:) = [-0.16_wp, 0.16_wp]
      do i = strips + 1, strips + 2
         layer(i)%rule = 'steel'
         call set_value(layer(i), 'k', 8.0e8_wp)
         call set_value(layer(i), 'f_y', 7.2e5_wp)
         call set_value(layer(i), 'k_post', 8.0e6_wp)
      end do
      joint(1)%rule = 'layered'
      joint(1)%axial_load = 7.0e5_wp
      call joint(1)%set_layers(y, layer)

      runs = max(50/divisor, 2)
      call add_rules(rules, joint, 1)
      events = 0
      turning = 0.0_wp
      do run = 1, runs
         call spring%create(rules, spread([0], 1, 2), joint%axial_load, 1)
         call cpu_time(begin)
         turning = turning - begin
         do i = 1, cycles
            call spring%advance_to(1, 0.03_wp*i/cycles)
            call spring%advance_to(1, -0.03_wp*i/cycles)
         end do
         call cpu_time(begin)
         turning = turning + begin
         events = events + spring%events
      end do
      write (output_unit, '(a, 1x, f0.3)') 'joint_event', 1.0e9_wp*turning/events

      ! From the last turn a little way back, and to and fro there.
      m = max(1000000/divisor, 1000)
      call spring%advance_to(1, -0.0299_wp)
      events = spring%events
      call cpu_time(begin)
      do i = 1, m
         call spring%move_all([-0.0299_wp + 1.0e-9_wp*modulo(i, 100)])
      end do
      call tell('joint_step', begin, m)
      write (output_unit, '(a, 1x, f0.3)') 'joint_step_lines', 1000.0_wp*(spring%events - events)/m
   end subroutine time_joint

   !> Static cyclic path of one body, driven by displacement, per increment.
   subroutine time_static()
      class(column_type), allocatable :: column
      type(array_recorder), target :: recorder
      type(task_type) :: task
      type(error_type), allocatable :: error
      real(wp), allocatable :: x(:)
      real(wp) :: begin
      integer, parameter :: m = 20000

      call make_paper_column(column, 'pdelta', 1)
      allocate (x(m), source=wave(m, 20, 0.05_wp))
      recorder%channels = new_channels(column, .false., .false., .false.)
      recorder%expected = m
      call cpu_time(begin)
      task%recorder => recorder
      call run_static(column, .false., x, task, error)
      call tell('static', begin, m)
      if (allocated(error)) error stop 'time_solver: the static path failed'
   end subroutine time_static

   !> RK4 under a force that brings the springs beyond yield in every cycle, per step and body.
   subroutine time_rk4(what, kinematics, n)
      character(len=*), intent(in) :: what, kinematics
      integer, intent(in) :: n
      class(column_type), allocatable :: column
      type(summary_type) :: summary
      type(error_type), allocatable :: error
      type(analysis_record) :: analysis
      type(time_plan) :: plan
      type(loads_type) :: loads
      real(wp) :: used
      integer :: steps, i
      integer, parameter :: points = 101

      call make_paper_column(column, kinematics, n)
      allocate (loads%signal(lateral)%time(points), loads%signal(lateral)%value(points))
      loads%signal(lateral)%time = [(0.02_wp*(i - 1), i=1, points)]
      loads%signal(lateral)%value = 1.5e5_wp*sin(2.0_wp*pi*5.0_wp*loads%signal(lateral)%time)
      analysis%method = 'rk4'
      ! Once for the limit, of a motion too long to be run, then as long as the work is worth measuring.
      analysis%max_seconds = 1.0e4_wp
      call plan_dynamic(column, analysis, loads%signal(lateral)%time, loads, plan, error)
      if (allocated(error)) call give_up(error)
      steps = max(400000/(divisor*n), 50)
      associate (time => loads%signal(lateral)%time)
         time = time*(steps*0.2_wp*plan%limit/time(points))
      end associate
      call run(column, analysis, loads, summary, used)
      write (output_unit, '(a, 1x, f0.3)') what, 1.0e9_wp*used/(n*summary%steps)
      if (n > 1) return
      write (output_unit, '(a, 1x, f0.3)') what//'_lines', 1000.0_wp*real(summary%events, wp)/summary%steps
   end subroutine time_rk4

   !> Plan and run; every 1000th step is kept. Only the run is timed.
   subroutine run(column, analysis, loads, summary, used)
      type(column_type), intent(in) :: column
      type(analysis_record), intent(in) :: analysis
      type(loads_type), intent(in) :: loads
      type(summary_type), intent(out) :: summary
      !> Processor time [s]
      real(wp), intent(out) :: used
      type(array_recorder), target :: recorder
      type(task_type) :: task
      type(time_plan) :: plan
      type(initial_state) :: rest
      type(error_type), allocatable :: error
      real(wp) :: begin, finish

      call plan_dynamic(column, analysis, loads%signal(lateral)%time, loads, plan, error)
      if (allocated(error)) call give_up(error)
      recorder%channels = new_channels(column, .true., .false., .false.)
      recorder%expected = plan%rows(1000)
      task%recorder => recorder
      task%every = 1000
      call cpu_time(begin)
      call run_dynamic(column, analysis, plan, loads%signal(lateral)%time, loads, rest, task, error)
      call cpu_time(finish)
      summary = task%summary
      used = finish - begin
      if (allocated(error)) call give_up(error)
   end subroutine run

   !> The chain of the yardstick: column 1 of table 3 in n equal bodies, two bilinear springs a joint that
   !> together are as soft as those of one body.
   subroutine make_bilinear_column(column, n, strength)
      class(column_type), allocatable, intent(out) :: column
      integer, intent(in) :: n
      !> Of the shear springs, 1 as in the paper
      real(wp), intent(in) :: strength
      type(column_record) :: spec
      type(error_type), allocatable :: error

      spec%n = n
      spec%height = 1.6_wp
      spec%mass = 614.4_wp
      spec%depth = 0.4_wp
      allocate (spec%shear(1), spec%flexure(1))
      spec%shear(1)%rule = 'bilinear'
      call set_value(spec%shear(1), 'k', n*7.0387e8_wp)
      call set_value(spec%shear(1), 'd_y', strength*1.2960e-4_wp/n)
      call set_value(spec%shear(1), 'k_post', n*8.3185e6_wp)
      spec%flexure(1)%rule = 'bilinear'
      call set_value(spec%flexure(1), 'k', n*6.2937e7_wp)
      call set_value(spec%flexure(1), 'd_y', 2.7183e-3_wp/n)
      call set_value(spec%flexure(1), 'k_post', n*7.5772e6_wp)
      call make_column(spec, column, error)
      if (allocated(error)) call give_up(error)
   end subroutine make_bilinear_column

   !> One history in time, as `yardstick` runs it.
   subroutine compare_dynamic(method, n, dt, steps, period, strength)
      character(len=*), intent(in) :: method
      integer, intent(in) :: n, steps
      !> Step [s], steps in a cycle of the load, strength of the shear springs
      real(wp), intent(in) :: dt, period, strength
      class(column_type), allocatable :: column
      type(summary_type) :: summary
      type(analysis_record) :: analysis
      type(loads_type) :: loads
      real(wp) :: used
      integer, parameter :: spacing = 20
      integer :: i

      call make_bilinear_column(column, n, strength)
      analysis%method = method
      analysis%dt = dt
      loads%signal(lateral)%time = [(i*dt, i=0, steps, spacing)]
      loads%signal(lateral)%value = [(1.5e5_wp*sin(2.0_wp*pi*i/period), i=0, steps, spacing)]
      call run(column, analysis, loads, summary, used)
      call tell_case(used/summary%steps, summary%peak_displacement)
   end subroutine compare_dynamic

   !> The static path of one body, as `yardstick` follows it.
   subroutine compare_static(points)
      integer, intent(in) :: points
      class(column_type), allocatable :: column
      type(array_recorder), target :: recorder
      type(task_type) :: task
      type(error_type), allocatable :: error
      real(wp), allocatable :: x(:)
      real(wp) :: begin, finish

      call make_bilinear_column(column, 1, 1.0_wp)
      allocate (x(points), source=wave(points, 20, 0.05_wp))
      recorder%channels = new_channels(column, .false., .false., .false.)
      recorder%expected = points/1000 + 2
      call cpu_time(begin)
      task%recorder => recorder
      task%every = 1000
      call run_static(column, .false., x, task, error)
      call cpu_time(finish)
      if (allocated(error)) call give_up(error)
      call tell_case((finish - begin)/points, task%summary%peak_force)
   end subroutine compare_static

   subroutine tell_case(seconds, peak)
      !> Per unit of work [s]
      real(wp), intent(in) :: seconds
      !> Peak [m, N]
      real(wp), intent(in) :: peak

      write (output_unit, '(f0.4, 1x, es24.16, 1x, i0)') 1.0e9_wp*seconds, peak, memory()
   end subroutine tell_case

   !> Memory that this process has held at the most [kB]; 0 where the system does not tell (all but Linux).
   integer function memory() result(kilobytes)
      character(len=80) :: text
      integer :: unit, status

      kilobytes = 0
      open (newunit=unit, file='/proc/self/status', status='old', action='read', iostat=status)
      if (status /= 0) return
      do
         read (unit, '(a)', iostat=status) text
         if (status /= 0) exit
         if (text(:6) /= 'VmHWM:') cycle
         read (text(7:), *, iostat=status) kilobytes
         if (status /= 0) kilobytes = 0
         exit
      end do
      close (unit)
   end function memory

   subroutine give_up(error)
      type(error_type), intent(in) :: error

      write (error_unit, '(a)') 'time_solver: '//error%message
      error stop 1
   end subroutine give_up

end program time_solver
