!> Runs in time for several suites, from a column and its loads to rows and summary; and states that a
!> test moves with a stepper.
module runs
   use check, only: check_passed, check_true
   use rbs_base_constants, only: unset, unset_integer
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_structure_column_column, only: column_type
   use rbs_loading_signal, only: signal_type
   use rbs_output_channels, only: new_channels
   use rbs_output_recorder, only: array_recorder
   use rbs_output_summary, only: summary_type
   use rbs_loading_loads, only: loads_type, lateral, horizontal, vertical, top_axial
   use rbs_solve_static_run_static, only: run_static
   use rbs_solve_task, only: task_type
   use rbs_solve_time_located, only: located_stepper
   use rbs_solve_time_march, only: initial_state
   use rbs_solve_time_pair45, only: pair45_scheme
   use rbs_solve_time_plan, only: time_plan
   use rbs_solve_time_rk4, only: rk4_scheme
   use rbs_solve_time_run_dynamic, only: plan_dynamic, run_dynamic
   use rbs_solve_time_state, only: state_type, stepper_type
   use rbs_case_analysis_record, only: analysis_record
   use rbs_structure_column_column_record, only: column_record
   use rbs_hysteresis_spring_record, only: spring_record
   use rbs_structure_structure, only: structure_type
   use samples, only: bilinear, chain, column_1, made, random_type, d_c, k_c
   use row_places, only: row_joints
   implicit none
   private

   public :: scene_type, scenes, new_scene, new_mass, play, play_located, find_reference
   public :: run_data, run, run_path, times, signal_of, loads_of, last_deformation
   public :: new_state, column_of, new_located, residual_of, distance, order_of, check_order

   !> One run: its input without the column, and its results.
   type :: run_data
      type(analysis_record) :: analysis = analysis_record(method='rk4')
      !> Times of the loading [s]; loads that are not allocated do not act
      real(wp), allocatable :: time(:), force(:), ground(:), vertical(:), axial(:)
      integer :: every = unset_integer
      type(initial_state) :: initial
      type(time_plan) :: plan
      real(wp), allocatable :: rows(:, :)
      type(summary_type) :: summary
      type(error_type), allocatable :: outcome
   end type run_data

   !> A column, its loads, its initial state and the duration of the motion.
   type :: scene_type
      class(column_type), allocatable :: column
      type(loads_type) :: loads
      real(wp), allocatable :: q(:), v(:)
      real(wp) :: finish = 0.0_wp
   end type scene_type

   integer, parameter :: scenes = 6

contains

   !> Plan and run.
   subroutine run(data, column)
      type(run_data), intent(inout) :: data
      class(column_type), intent(in) :: column
      type(array_recorder), target :: recorder
      type(task_type) :: task
      type(loads_type) :: loads

      if (allocated(data%rows)) deallocate (data%rows)
      if (allocated(data%outcome)) deallocate (data%outcome)
      loads = loads_of(data)
      call plan_dynamic(column, data%analysis, data%time, loads, data%plan, data%outcome)
      if (allocated(data%outcome)) return
      recorder%channels = new_channels(column, .true., .false., .false.)
      recorder%expected = data%plan%rows(data%every)
      task%recorder => recorder
      task%every = data%every
      task%collapse_drift = data%analysis%collapse_drift
      call run_dynamic(column, data%analysis, data%plan, data%time, loads, data%initial, task, data%outcome)
      data%summary = task%summary
      if (recorder%count == 0) allocate (recorder%rows(recorder%channels%width, 0))
      data%rows = recorder%rows(:, :recorder%count)
   end subroutine run

   !> Follow a static path.
   subroutine run_path(spec, by_force, values, rows, outcome, summary)
      type(column_record), intent(in) :: spec
      logical, intent(in) :: by_force
      real(wp), intent(in) :: values(:)
      real(wp), allocatable, intent(out) :: rows(:, :)
      type(error_type), allocatable, intent(out) :: outcome
      type(summary_type), intent(out), optional :: summary
      type(array_recorder), target :: recorder
      class(column_type), allocatable :: column
      type(task_type) :: task

      column = made(spec)
      recorder%channels = new_channels(column, .false., .false., .false.)
      task%recorder => recorder
      call run_static(column, by_force, values, task, outcome)
      if (recorder%count == 0) allocate (recorder%rows(recorder%channels%width, 0))
      rows = recorder%rows(:, :recorder%count)
      if (present(summary)) summary = task%summary
   end subroutine run_path

   !> The loads of a run.
   type(loads_type) function loads_of(data) result(loads)
      type(run_data), intent(in) :: data

      if (allocated(data%force)) loads%signal(lateral) = signal_of(data%time, data%force)
      if (allocated(data%ground)) loads%signal(horizontal) = signal_of(data%time, data%ground)
      if (allocated(data%vertical)) loads%signal(vertical) = signal_of(data%time, data%vertical)
      if (allocated(data%axial)) loads%signal(top_axial) = signal_of(data%time, data%axial)
   end function loads_of

   type(signal_type) function signal_of(time, value) result(signal)
      real(wp), intent(in) :: time(:), value(:)

      allocate (signal%time, source=time)
      allocate (signal%value, source=value)
   end function signal_of

   !> Times 0, h, ..., m h.
   pure function times(m, h) result(t)
      integer, intent(in) :: m
      real(wp), intent(in) :: h
      real(wp) :: t(m + 1)
      integer :: i

      t = [(i*h, i=0, m)]
   end function times

   !> Deformations in the last row.
   function last_deformation(data, unknowns) result(q)
      type(run_data), intent(in) :: data
      integer, intent(in) :: unknowns
      real(wp) :: q(unknowns)

      q = data%rows(row_joints:row_joints + unknowns - 1, size(data%rows, 2))
   end function last_deformation

   !> A state at time zero with the springs at the deformations q.
   subroutine new_state(state, structure, loads, q, v)
      type(state_type), intent(out) :: state
      class(structure_type), intent(in) :: structure
      type(loads_type), intent(in) :: loads
      real(wp), intent(in) :: q(:), v(:)
      type(error_type), allocatable :: outcome
      ! A state refers to its structure, which a test may give up before it.
      class(structure_type), pointer :: kept

      allocate (kept, source=structure)
      state%loads = loads
      call state%loads%find_acting()
      call state%motion%create(kept, state%loads%acts, outcome)
      if (allocated(outcome)) error stop 'runs: a structure without motion'
      call kept%create_springs(state%springs, kept%constant_axial)
      call state%loads%at_time(0.0_wp, state%load)
      state%q = q
      state%v = v
      call state%springs%move_all(state%q)
      state%at_begin = energy_of(state)
      call state%begin_monitor(unset, .false.)
   end subroutine new_state

   !> The structure of a state, which is a column.
   function column_of(state) result(column)
      type(state_type), intent(in) :: state
      class(column_type), pointer :: column

      select type (structure => state%motion%structure)
      class is (column_type)
         column => structure
      class default
         error stop 'runs: no column'
      end select
   end function column_of

   !> Energy of a state: motion, springs, potential [J].
   real(wp) function energy_of(state) result(energy)
      type(state_type), intent(in) :: state

      energy = state%motion%structure%kinetic_energy(state%q, state%v) + sum(state%springs%work) &
               + state%motion%structure%potential_energy(state%q) + state%along_joints
   end function energy_of

   !> Residual of the balance of energy [J].
   real(wp) function residual_of(state) result(residual)
      type(state_type), intent(in) :: state

      residual = state%of_loads + state%at_begin - energy_of(state) - state%of_damping
   end function residual_of

   !> Difference of two states relative to the second: deformations and velocities.
   real(wp) function distance(state, reference)
      type(state_type), intent(in) :: state, reference

      distance = max(maxval(abs(state%q - reference%q))/maxval(abs(reference%q)), &
                     maxval(abs(state%v - reference%v))/maxval(abs(reference%v)))
   end function distance

   !> Move a state in steps that end at events: by rk4 without a tolerance, by the embedded pair with one.
   subroutine new_located(stepper, column, tolerance, step)
      type(located_stepper), intent(out) :: stepper
      class(column_type), intent(in) :: column
      !> 0: rk4 [1], and the first step of the pair [s]
      real(wp), intent(in) :: tolerance, step

      if (tolerance > 0.0_wp) then
         allocate (pair45_scheme :: stepper%scheme)
      else
         allocate (rk4_scheme :: stepper%scheme)
      end if
      call stepper%scheme%create(column)
      stepper%tolerance = tolerance
      stepper%next_step = step
      stepper%shortest = 1.0e-6_wp*step
   end subroutine new_located

   !> Observed order from the first error to the last, with the step halved each time.
   pure real(wp) function order_of(wrong) result(order)
      real(wp), intent(in) :: wrong(:)

      order = log(wrong(1)/wrong(size(wrong)))/log(2.0_wp)/(size(wrong) - 1)
   end function order_of

   !> The mean order of a sequence of errors is between two bounds.
   subroutine check_order(error, wrong, least, most, what)
      type(error_type), allocatable, intent(inout) :: error
      real(wp), intent(in) :: wrong(:), least, most
      character(len=*), intent(in) :: what

      call check_true(error, order_of(wrong) >= least .and. order_of(wrong) <= most, &
                      what//': order '//to_text(order_of(wrong))//' is not between '//to_text(least)// &
                      ' and '//to_text(most))
   end subroutine check_order

   !> Columns that yield and unload many times; the corners of the force do not coincide with steps.
   subroutine new_scene(scene, number)
      type(scene_type), intent(out) :: scene
      integer, intent(in) :: number
      type(column_record) :: spec
      type(random_type) :: random
      real(wp) :: value(8)
      integer :: i

      select case (number)
      case (1)
         spec = column_1('small')
         spec%flexure(1) = bilinear(k_c, d_c, 0.1_wp*k_c)
      case (2)
         spec = column_1('small')
      case (3)
         spec = column_1('pdelta')
         spec%axial_load = 1.0e6_wp
      case (4)
         spec = column_1('small')
         spec%n = 3
         spec%flexure(1) = bilinear(k_c, d_c, 0.1_wp*k_c)
      case (5)
         spec = column_1('pdelta')
         spec%n = 3
         spec%axial_load = 1.0e6_wp
         spec%self_weight = .true.
         spec%damping%mass = 5.0_wp
      case default
         spec = column_1('finite')
         spec%axial_load = 1.0e6_wp
      end select
      scene%column = made(spec)
      scene%finish = 0.05_wp
      value = [(random%uniform(-2.0e5_wp, 2.0e5_wp), i=1, 8)]
      value(1) = 0.0_wp
      scene%loads%signal(lateral) = signal_of([(scene%finish*i/7, i=0, 7)], value)
      allocate (scene%q(scene%column%unknowns), scene%v(scene%column%unknowns), source=0.0_wp)
      scene%v(1) = 0.3_wp
      scene%v(scene%column%n + 1) = 1.0_wp
   end subroutine new_scene

   !> One mass on an axial spring that is not coupled to the other springs, without load.
   subroutine new_mass(scene, spring, mass, w, v)
      type(scene_type), intent(out) :: scene
      type(spring_record), intent(in) :: spring
      !> Mass [kg], opening and its velocity
      real(wp), intent(in) :: mass, w, v
      type(column_record) :: spec

      spec = chain(1, 'small')
      spec%masses = [mass]
      allocate (spec%axial_spring(1))
      spec%axial_spring(1) = spring
      scene%column = made(spec)
      scene%q = [0.0_wp, 0.0_wp, w]
      scene%v = [0.0_wp, 0.0_wp, v]
   end subroutine new_mass

   !> Start a scene and move it to its end in equal steps.
   subroutine play(scene, stepper, steps, state, outcome)
      type(scene_type), intent(in) :: scene
      class(stepper_type), intent(inout) :: stepper
      integer, intent(in) :: steps
      type(state_type), intent(out) :: state
      type(error_type), allocatable, intent(out) :: outcome
      integer :: i

      call new_state(state, scene%column, scene%loads, scene%q, scene%v)
      do i = 1, steps
         call stepper%advance(state, scene%finish/steps, outcome)
         if (allocated(outcome) .or. state%lost) return
      end do
   end subroutine play

   !> The same by rk4 with located events, or by the pair with a tolerance.
   subroutine play_located(scene, tolerance, steps, state, outcome)
      type(scene_type), intent(in) :: scene
      !> 0: rk4
      real(wp), intent(in) :: tolerance
      integer, intent(in) :: steps
      type(state_type), intent(out) :: state
      type(error_type), allocatable, intent(out) :: outcome
      type(located_stepper) :: stepper

      call new_located(stepper, scene%column, tolerance, scene%finish/100.0_wp)
      call play(scene, stepper, steps, state, outcome)
   end subroutine play_located

   !> The end of a scene to ten digits or more, by the pair.
   subroutine find_reference(scene, state, error)
      type(scene_type), intent(in) :: scene
      type(state_type), intent(out) :: state
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome

      call play_located(scene, 1.0e-13_wp, 1, state, outcome)
      call check_passed(error, outcome, 'reference')
      call check_true(error, state%springs%events > 20, 'the springs change their lines')
      call check_true(error, abs(residual_of(state)) < 1.0e-11_wp*sum(state%springs%work), &
                      'energy of the reference')
   end subroutine find_reference

end module runs
