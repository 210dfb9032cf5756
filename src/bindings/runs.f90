!> Analyses for Python.
module rbs_bindings_runs
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
   use, intrinsic :: iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type, message_list, fatal_error, analysis_failed, bad_input
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_bindings_exchange, only: request_type, answer_type
   use rbs_bindings_statements, only: case_from_statements
   use rbs_case_case_record, only: case_record
   use rbs_loading_loads, only: loads_type, lateral, horizontal, vertical, signals, signal_names
   use rbs_loading_signal, only: signal_type
   use rbs_output_channels, only: new_channels
   use rbs_output_notes, only: run_notes
   use rbs_output_recorder, only: array_recorder, observer_type
   use rbs_output_summary, only: figure_type
   use rbs_solve_end_state, only: end_state
   use rbs_solve_static_run_static, only: run_static
   use rbs_solve_static_path, only: kept_rows
   use rbs_solve_task, only: task_type
   use rbs_solve_time_effort, only: expected_seconds, long_run_note, patience
   use rbs_solve_time_march, only: initial_state
   use rbs_solve_time_plan, only: time_plan
   use rbs_solve_time_run_dynamic, only: run_dynamic, plan_dynamic
   use rbs_solve_time_monitor, only: response_monitor, watch_type
   use rbs_structure_structure, only: structure_type
   implicit none
   private

   public :: run_analysis, choose_method, watches_of

   !> Code of the "error" that a long run was not started, as the user has not been `told` how long it is.
   integer, parameter :: long_run = 3

   !> The share of the run that has been completed, in parts of a thousand, in a word which another thread
   !> reads.
   type, extends(observer_type) :: word_progress
      integer(c_int), pointer :: word => null()
   contains
      procedure :: update
   end type word_progress

   !> An analysis with what it needs and fills.
   type :: run_type
      class(structure_type), pointer :: structure => null()
      !> Settings of analysis and output
      type(case_record) :: case
      type(array_recorder) :: recorder
      type(task_type) :: task
      type(word_progress) :: progress
      type(response_monitor) :: monitor
   end type run_type

contains

   !> Note the share, from 0 to 1, that has been completed.
   subroutine update(self, share)
      class(word_progress), intent(inout) :: self
      real(wp), intent(in) :: share

      self%word = nint(1000.0_wp*share, c_int)
   end subroutine update

   !> Run a static path or a response in time. Rows: those of the run. Values: when each of the `watches` is
   !> reached first [s], then the displacement of the top at these times [m], not numbers where a watch is not
   !> reached; figures of the run; the state at its end, if there is one. Text, a line each: method, the
   !> reason for it, how the run ended, the channels of the rows, the names of the figures, and notes on a run
   !> that succeeded.
   subroutine run_analysis(request, control, answer)
      type(request_type), intent(in) :: request
      !> Words that another thread sets and reads: the first stops the run, the second is its progress
      integer(c_int), intent(inout), volatile, target :: control(2)
      type(answer_type), intent(inout) :: answer
      type(run_type), target :: run
      real(c_double), pointer, contiguous :: watches(:)
      type(figure_type), allocatable :: figure(:)
      type(message_list) :: notes
      character(len=:), allocatable :: note
      character(len=1), parameter :: line = new_line('a')
      integer :: i

      watches => request%array('watches')
      call run%monitor%watch_for(watches_of(watches), size(watches)/6)
      call case_from_statements(request%statement, request%number, run%case, answer%error)
      if (.not. allocated(answer%error)) then
         run%structure => request%made%structure
         run%task%before = request%made%before
         associate (output => run%case%output)
            run%recorder%channels = new_channels(run%structure, request%what /= 'cyclic', output%openings, &
                                                 output%motion)
         end associate
         run%task%recorder => run%recorder
         run%task%every = run%case%output%every
         run%task%collapse_drift = run%case%analysis%collapse_drift
         run%task%keeps_end = .not. request%wants('without_end')
         run%task%most_seconds = run%case%analysis%max_seconds
         run%task%control => control(1)
         run%progress%word => control(2)
         run%task%progress => run%progress
         ! A state of the request replaces that of the structure.
         associate (before => request%array('before'))
            if (size(before) > 0) then
               run%task%before%stream%value = before
               run%task%before%stream%count = size(before)
            end if
         end associate
         if (request%what == 'cyclic') then
            call run_cyclic(answer%error)
         else
            call run_time_history(answer%error)
         end if
      end if
      note = ''
      if (.not. allocated(answer%error)) then
         call run_notes(run%structure, run%task%summary, run%recorder%spans, notes)
         if (notes%count > 0) note = notes%text
      ! A run that failed keeps its rows and figures; wrong input has none.
      else if (answer%error%code /= analysis_failed) then
         return
      end if
      if (run%recorder%count == 0) allocate (run%recorder%rows(run%recorder%channels%width, 0))
      call move_alloc(run%recorder%rows, answer%rows)
      answer%kept = run%recorder%count
      call run%task%summary%get_figures(figure)
      where (.not. run%monitor%reached < huge(1.0_wp))
         run%monitor%reached = ieee_value(1.0_wp, ieee_quiet_nan)
         run%monitor%top = run%monitor%reached
      end where
      answer%value = [run%monitor%reached, run%monitor%top, (figure(i)%value, i=1, size(figure))]
      if (run%task%after%is_given()) then
         answer%value = [answer%value, run%task%after%stream%value(:run%task%after%stream%count)]
      end if
      associate (summary => run%task%summary)
         answer%text = trim(summary%method)//line//trim(summary%reason)//line//trim(summary%status())// &
                       line//trim(run%recorder%channels%names())//line
      end associate
      do i = 1, size(figure)
         answer%text = answer%text//trim(figure(i)%name)//' '
      end do
      answer%text = answer%text//line//note

   contains

      !> Run a static path through the values of `target`, displacements [m] or forces [N].
      subroutine run_cyclic(error)
         type(error_type), allocatable, intent(out) :: error
         real(c_double), pointer, contiguous :: target(:)

         if (run%case%analysis%method == '') run%case%analysis%method = 'static'
         call check_settings(run%case, error)
         if (allocated(error)) return
         target => request%array('target')
         run%recorder%corners = request%wants('corners')
         run%recorder%expected = kept_rows(size(target), run%case%output%every)
         call run_static(run%structure, run%case%analysis%method, request%wants('by_force'), target, &
                         run%task, error, request%array('axial_load'))
      end subroutine run_cyclic

      !> Run a response in time under the signals that are given.
      subroutine run_time_history(error)
         type(error_type), allocatable, intent(out) :: error
         type(loads_type) :: loads
         type(initial_state) :: initial
         type(time_plan) :: plan
         real(c_double), pointer, contiguous :: time(:), start(:)
         character(len=:), allocatable :: note
         integer :: i

         time => request%array('time')
         do i = 1, signals
            call take_signal(trim(signal_names(i)), time, loads%signal(i), error)
         end do
         if (.not. allocated(error)) call choose_method(run%case, loads, error)
         if (allocated(error)) return
         associate (structure => run%structure, analysis => run%case%analysis, output => run%case%output)
            call plan_dynamic(structure, analysis, time, loads, plan, error)
            if (allocated(error)) return
            ! A run longer than the user's patience needs consent first.
            if (.not. request%wants('told') .and. expected_seconds(structure, plan) >= patience) then
               call long_run_note(structure, plan, note)
               call fatal_error(error, long_run, note)
               return
            end if
            ! Deformations of the springs, then their velocities; without numbers at rest
            start => request%array('initial')
            if (size(start) > 0) then
               initial%deformation = start(:size(structure%location))
               initial%velocity = start(size(structure%location) + 1:)
               initial%opening_given = request%wants('opening_given')
            end if
            run%recorder%expected = plan%rows(output%every)
            call run_dynamic(structure, analysis, plan, time, loads, initial, run%task, error, run%monitor)
         end associate
      end subroutine run_time_history

      !> Take one of the signals, if it is given.
      subroutine take_signal(name, time, signal, error)
         !> Name of the signal, and times of its values [s]
         character(len=*), intent(in) :: name
         real(c_double), intent(in) :: time(:)
         type(signal_type), intent(inout) :: signal
         type(error_type), allocatable, intent(inout) :: error
         real(c_double), pointer, contiguous :: value(:)

         ! An array without values is still given, so the name is looked for.
         if (allocated(error) .or. index(' '//request%names, ' '//name//':') == 0) return
         value => request%array(name)
         if (size(value) /= size(time)) then
            call fatal_error(error, bad_input, name//': '//to_text(size(value))//' values for '// &
                             to_text(size(time))//' times; give one for each')
            return
         end if
         signal%time = time
         signal%value = value
      end subroutine take_signal

   end subroutine run_analysis

   !> Validate the settings of a case without its structure.
   subroutine check_settings(case, error)
      !> Analysis and output count
      type(case_record), intent(inout) :: case
      type(error_type), allocatable, intent(out) :: error
      type(message_list) :: messages

      call case%analysis%validate(messages)
      call case%output%check('output', messages)
      if (case%analysis%static()) call case%check_static(messages)
      call messages%raise(error)
   end subroutine check_settings

   !> Choose the method of an analysis in time if the user has not named one, and check its settings.
   subroutine choose_method(case, loads, error)
      !> Its method is set here; loads by which it is chosen
      type(case_record), intent(inout) :: case
      type(loads_type), intent(in) :: loads
      type(error_type), allocatable, intent(out) :: error

      if (case%analysis%static()) then
         call fatal_error(error, bad_input, "analysis: method = '"//trim(case%analysis%method)// &
                          "' takes no time; call cyclic, or set method = 'auto'")
      else if (case%analysis%method == '' .and. loads%signal(lateral)%acts() .and. .not. &
               (loads%signal(horizontal)%acts() .or. loads%signal(vertical)%acts())) then
         call fatal_error(error, bad_input, 'analysis: a force with time needs a method that is named: '// &
                          "method = 'auto', or cyclic for the path without inertia")
      else
         if (case%analysis%method == '') case%analysis%method = 'auto'
         call check_settings(case, error)
      end if
   end subroutine choose_method

   !> Limit states to watch for, from six numbers of the user for each: state, joint, factors of slip,
   !> rotation and opening, and threshold of their sum.
   pure function watches_of(numbers) result(watch)
      real(c_double), intent(in) :: numbers(:)
      type(watch_type) :: watch(size(numbers)/6)
      integer :: i

      do i = 1, size(watch)
         associate (given => numbers(6*i - 5:6*i))
            watch(i) = watch_type(state=nint(given(1)), joint=nint(given(2)), slip=given(3), &
                                  rotation=given(4), opening=given(5), threshold=given(6))
         end associate
      end do
   end function watches_of

end module rbs_bindings_runs
