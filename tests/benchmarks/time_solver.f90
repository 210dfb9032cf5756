!> Times of the solver itself, without Python and without files: `time_solver [repeats [divisor]]`.
!>
!> A line for every repeat: name, nanoseconds of the processor per unit of work; for one body also how
!> many lines its springs leave in 1000 steps. The divisor makes all runs shorter.
program time_solver
   use, intrinsic :: iso_fortran_env, only: output_unit
   use rbs_base_constants, only: pi, unset, unset_integer
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_column_column, only: column_type
   use rbs_hysteresis_springs, only: follow_path
   use rbs_loading_signal, only: signal_type
   use rbs_results_recorder, only: array_recorder
   use rbs_results_row, only: row_size
   use rbs_results_summary, only: summary_type
   use rbs_solve_history, only: initial_state
   use rbs_solve_run, only: make_column, run_static, plan_dynamic, run_dynamic
   use rbs_solve_time_plan, only: time_plan
   use rbs_spec_column, only: column_spec
   use rbs_spec_spring, only: spring_spec
   implicit none

   integer, parameter :: bodies(3) = [10, 50, 200]
   integer :: repeats, divisor, repeat, i
   character(len=16) :: label

   repeats = whole_argument(1, 5)
   divisor = whole_argument(2, 1)
   do repeat = 1, repeats
      call time_spring('spring_smooth', .true.)
      call time_spring('spring_random', .false.)
      call time_static()
      call time_rk4('rk4_small', 'small', 1)
      call time_rk4('rk4_pdelta', 'pdelta', 1)
      call time_rk4('rk4_finite', 'finite', 1)
      do i = 1, size(bodies)
         write (label, '(a, i0)') 'rk4_n', bodies(i)
         call time_rk4(trim(label), 'pdelta', bodies(i))
      end do
   end do

contains

   integer function whole_argument(i, default) result(value)
      integer, intent(in) :: i, default
      character(len=32) :: word
      integer :: status

      value = default
      call get_command_argument(i, word)
      if (word == '') return
      read (word, *, iostat=status) value
      if (status /= 0 .or. value < 1) error stop 'usage: time_solver [repeats [divisor]]'
   end function whole_argument

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
      type(column_type), intent(out) :: column
      character(len=*), intent(in) :: kinematics
      integer, intent(in) :: n
      type(column_spec) :: spec
      type(error_type), allocatable :: error

      spec%n = n
      spec%height = 1.6_wp
      spec%mass = 614.4_wp
      spec%kinematics = kinematics
      if (kinematics == 'pdelta') spec%axial_load = 744.0e3_wp
      allocate (spec%shear(1), spec%flexure(1))
      spec%shear(1)%rule = 'bilinear'
      spec%shear(1)%k = 7.0387e8_wp
      spec%shear(1)%d_y = 1.2960e-4_wp
      spec%shear(1)%k_post = 8.3185e6_wp
      spec%flexure(1) = paper_flexure()
      call make_column(spec, column, error)
      if (allocated(error)) error stop 'time_solver: the column is refused'
   end subroutine make_paper_column

   type(spring_spec) function paper_flexure() result(spec)
      spec%rule = 'takeda'
      spec%k_c = 2.5428e8_wp
      spec%d_c = 3.1891e-4_wp
      spec%k_y = 6.2937e7_wp
      spec%d_y = 2.7183e-3_wp
      spec%k_u = 7.5772e6_wp
      spec%b0 = 0.4_wp
      spec%b1 = 0.22_wp
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

   !> Static cyclic path of one body, driven by displacement, per increment.
   subroutine time_static()
      type(column_type) :: column
      type(array_recorder) :: recorder
      type(summary_type) :: summary
      type(error_type), allocatable :: error
      real(wp), allocatable, target :: rows(:, :)
      real(wp), allocatable :: x(:)
      real(wp) :: begin
      integer, parameter :: m = 20000

      call make_paper_column(column, 'pdelta', 1)
      allocate (x(m), source=wave(m, 20, 0.05_wp))
      allocate (rows(row_size(1), m))
      recorder%rows => rows
      call cpu_time(begin)
      call run_static(column, .false., x, unset_integer, recorder, summary, error)
      call tell('static', begin, m)
      if (allocated(error)) error stop 'time_solver: the static path failed'
   end subroutine time_static

   !> RK4 under a force that brings the springs beyond yield in every cycle, per step and body.
   subroutine time_rk4(what, kinematics, n)
      character(len=*), intent(in) :: what, kinematics
      integer, intent(in) :: n
      type(column_type) :: column
      type(array_recorder) :: recorder
      type(summary_type) :: summary
      type(error_type), allocatable :: error
      type(time_plan) :: plan
      type(signal_type) :: force, no_ground
      type(initial_state) :: rest
      real(wp), allocatable, target :: rows(:, :)
      real(wp) :: limit, begin
      integer :: steps, i
      integer, parameter :: points = 101

      call make_paper_column(column, kinematics, n)
      allocate (force%time(points), force%value(points))
      force%time = [(0.02_wp*(i - 1), i=1, points)]
      force%value = 1.5e5_wp*sin(2.0_wp*pi*5.0_wp*force%time)
      ! Once for the limit, then as long as the work is worth measuring.
      call plan_dynamic(column, force%time, unset, plan, limit, error)
      if (allocated(error)) error stop 'time_solver: the time history cannot be planned'
      steps = max(400000/(divisor*n), 50)
      force%time = force%time*(steps*0.2_wp*limit/force%time(points))
      call plan_dynamic(column, force%time, unset, plan, limit, error)
      if (allocated(error)) error stop 'time_solver: the time history cannot be planned'
      allocate (rows(row_size(n), plan%rows(1000)))
      recorder%rows => rows
      call cpu_time(begin)
      call run_dynamic(column, plan, limit, force%time, force, no_ground, rest, 1000, recorder, &
                       summary, error)
      call tell(what, begin, n*summary%steps)
      if (allocated(error)) error stop 'time_solver: the time history failed'
      if (n > 1) return
      write (output_unit, '(a, 1x, f0.3)') what//'_lines', 1000.0_wp*real(summary%events, wp)/summary%steps
   end subroutine time_rk4

end program time_solver
