!> The entry of the analyses in time: choice of the method, plan of the steps, run.
module rbs_solve_time_run_dynamic
   use rbs_base_constants, only: pi
   use rbs_base_error, only: error_type, fatal_error, bad_input
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_case_methods, only: method_type, methods, method_named, usual_tolerance, &
                               usual_rho_infinity
   use rbs_base_check, only: is_given, check_values
   use rbs_solve_task, only: task_type
   use rbs_solve_modal_modes, only: frequency_bounds, stability_limit
   use rbs_solve_time_implicit, only: implicit_stepper, new_newmark, new_hht, new_generalised_alpha, &
                                      with_finite_rotations
   use rbs_loading_loads, only: loads_type, lateral, horizontal, sideways, vertical, top_axial, signals, &
                               signal_names
   use rbs_solve_time_located, only: located_stepper
   use rbs_solve_time_march, only: initial_state, march
   use rbs_solve_time_pair45, only: pair45_scheme
   use rbs_solve_time_plan, only: time_plan, new_plan, check_times, check_length
   use rbs_solve_time_rk4, only: rk4_stepper, rk4_scheme
   use rbs_solve_time_monitor, only: response_monitor
   use rbs_solve_time_state, only: stepper_type
   use rbs_structure_structure, only: structure_type, finite
   use rbs_case_analysis_record, only: analysis_record
   implicit none
   private

   public :: plan_dynamic, run_dynamic, new_stepper

   !> Assumption of `auto`: an implicit step costs as much as this number of explicit ones, with small and
   !> with finite rotations.
   real(wp), parameter :: implicit_step_cost = 5.0_wp, finite_step_cost = 12.0_wp

   !> Numbers of explicit steps times bodies that take some hundredths of a second, and some minutes.
   real(wp), parameter :: negligible_work = 1.0e6_wp, bearable_work = 3.0e9_wp

contains

   !> Choose the method of a dynamic analysis, find its limit of stability, and plan its steps. Settings,
   !> structure and loads that do not go together give an error.
   subroutine plan_dynamic(structure, analysis, time, loads, plan, error)
      class(structure_type), intent(in) :: structure
      !> Validated settings
      type(analysis_record), intent(in) :: analysis
      !> Times of the loading (m) [s]
      real(wp), intent(in) :: time(:)
      type(loads_type), intent(in) :: loads
      type(time_plan), intent(out) :: plan
      type(error_type), allocatable, intent(out) :: error

      !> Whether joints have layers under an axial load that varies, so that their rule is a plane over it
      logical :: on_planes

      call check_times(time, error)
      if (allocated(error)) return
      on_planes = any(structure%rules%name == 'layered') .and. &
                  (loads%signal(vertical)%is_nonzero() .or. loads%signal(top_axial)%acts())
      plan%method = analysis%method
      if (structure%is_implicit) then
         call choose_implicit()
         if (allocated(error)) return
      end if
      if (plan%method == 'auto') then
         call choose_method()
         if (allocated(error)) return
      end if
      if (on_planes .and. (plan%method == 'rk45' .or. analysis%events == 'located')) then
         call fatal_error(error, bad_input, "analysis: events = 'located' and method = 'rk45' stop at "// &
                          'events of springs, not at those of the layers of a joint whose axial load '// &
                          "varies; use 'rk4' without events, 'newmark', 'hht' or 'generalised_alpha'")
         return
      end if
      call plan_steps()

   contains

      !> A structure with unknowns without mass needs an implicit step, from which alone their motion follows:
      !> choose one, or refuse an explicit one that the user has chosen.
      subroutine choose_implicit()
         type(method_type) :: method

         call structure%check_inertia(error)
         if (allocated(error)) return
         if (plan%method == 'auto') then
            plan%method = 'generalised_alpha'
            plan%reason = 'nodes of a frame without mass of their own need an implicit method'
         end if
         method = method_named(plan%method)
         if (method%implicit) return
         call fatal_error(error, bad_input, &
                          "analysis: method = '"//trim(plan%method)//"' takes explicit steps, "// &
                          'and a frame has unknowns without mass; choose newmark, hht or generalised_alpha')
      end subroutine choose_implicit

      !> Plan the steps of the method chosen, and check that the loads act on the structure.
      subroutine plan_steps()
         type(method_type) :: method
         !> Lowest circular frequency [rad/s]; longest step where the user gives none, and the longest that
         !> the user may give [s]
         real(wp) :: lowest, longest, bound

         method = method_named(plan%method)
         longest = time(size(time)) - time(1)
         bound = huge(1.0_wp)
         if (method%implicit) then
            call frequency_bounds(structure, lowest, error)
            if (allocated(error)) return
            longest = min(longest, method%period_share*longest_period(lowest))
         else
            call stability_limit(structure, plan%limit, error)
            if (allocated(error)) return
            if (method%adaptive) then
               ! It is explicit too: its steps cannot be much longer than the limit of rk4.
               call check_length((time(size(time)) - time(1))/plan%limit, plan%limit, error)
               if (allocated(error)) return
            else
               longest = method%limit_share*plan%limit
               if (.not. analysis%allow_unstable) bound = plan%limit
            end if
         end if
         call new_plan(plan, time, analysis%dt, longest, bound, error)
         if (allocated(error)) return
         if (abs(structure%axial_force_ratio) > 0.0_wp) then
            call fatal_error(error, bad_input, 'column: axial_force_ratio = '// &
                             to_text(structure%axial_force_ratio)//' belongs to a static path, which has '// &
                             'one lateral force; in a dynamic analysis give the axial load as a history, '// &
                             'axial_load')
            return
         end if
         call structure%check_loads(loads%signal%acts(), error)
      end subroutine plan_steps

      !> The method for a case whose user leaves it to the program: the most accurate one if it takes hardly
      !> any time, else the cheapest. It is chosen by counts of steps, never by a clock.
      subroutine choose_method()
         type(method_type) :: explicit_choice, implicit_choice, chosen
         !> Lowest circular frequency [rad/s]; steps of both methods; longest implicit step [s]; cost of such
         !> a step in explicit ones; explicit steps times bodies
         real(wp) :: lowest, explicit_steps, implicit_steps, longest, step_cost, work
         logical :: affordable

         explicit_choice = method_named('rk4')
         implicit_choice = method_named('generalised_alpha')
         call stability_limit(structure, plan%limit, error)
         if (allocated(error)) return
         call frequency_bounds(structure, lowest, error)
         if (allocated(error)) return
         longest = implicit_choice%period_share*longest_period(lowest)
         step_cost = merge(finite_step_cost, implicit_step_cost, structure%kinematics == finite)
         associate (duration => time(size(time)) - time(1))
            explicit_steps = real(size(time) - 1, wp) + duration/(explicit_choice%limit_share*plan%limit)
            implicit_steps = real(size(time) - 1, wp) + duration/longest
         end associate
         work = explicit_steps*structure%n
         affordable = work <= negligible_work .or. explicit_steps <= step_cost*implicit_steps
         if (is_given(analysis%tolerance) .and. (affordable .or. work <= bearable_work)) then
            plan%method = 'rk45'
            plan%reason = 'a tolerance of '//to_text(analysis%tolerance)//' asks for controlled errors'
         else if (.not. affordable) then
            plan%method = implicit_choice%name
            plan%reason = 'stiff: rk4 would take '//to_text(anint(explicit_steps))//' steps for its '// &
                          'stability, this method takes about '//to_text(anint(implicit_steps))
         else if (structure%kinematics == finite .and. .not. on_planes) then
            ! How fast the column turns, and with it the step that resolves it, is not known in advance.
            plan%method = 'rk45'
            plan%reason = 'finite rotations: the steps follow from a tolerance'
         else
            plan%method = explicit_choice%name
            plan%located = any(structure%rules%name /= 'elastic') .and. .not. on_planes
            plan%reason = to_text(anint(explicit_steps))//' steps take little time'
            if (plan%located) plan%reason = trim(plan%reason)//'; events located'
         end if
         chosen = method_named(plan%method)
         plan%reason = trim(plan%reason)//'; errors over the peaks: '//to_text(chosen%usual_error)// &
                       ' in the median of '//to_text(chosen%responses)//' responses, '// &
                       to_text(chosen%largest_error)//' at most'
      end subroutine choose_method

   end subroutine plan_dynamic

   !> The longest natural period [s]; a very long time where there is no restoring force.
   pure real(wp) function longest_period(lowest)
      !> Lowest circular frequency [rad/s]
      real(wp), intent(in) :: lowest

      longest_period = 2.0_wp*pi/max(lowest, tiny(1.0_wp)*1.0e3_wp)
   end function longest_period

   !> Response in time under lateral force, ground motion, axial load, or all of them: check loads and initial
   !> values, make the method, march.
   subroutine run_dynamic(structure, analysis, plan, time, loads, initial, task, error, monitor)
      class(structure_type), intent(in) :: structure
      !> Validated settings
      type(analysis_record), intent(in) :: analysis
      !> Plan of the steps that `plan_dynamic` has made for these settings and loads
      type(time_plan), intent(in) :: plan
      !> Times of the loading (m) [s]
      real(wp), intent(in) :: time(:)
      type(loads_type), intent(in) :: loads
      type(initial_state), intent(in) :: initial
      !> Without `every` each interval of the plan has a row
      type(task_type), intent(inout) :: task
      type(error_type), allocatable, intent(out) :: error
      !> Monitor of peaks and limit states
      type(response_monitor), intent(inout), optional :: monitor
      class(stepper_type), allocatable :: stepper
      integer :: i

      do i = 1, signals
         if (allocated(error) .or. .not. loads%signal(i)%acts()) cycle
         call check_values(loads%signal(i)%value, trim(signal_names(i)), error)
         if (.not. any(i == [horizontal, sideways, vertical])) cycle
         task%summary%peak_ground = max(task%summary%peak_ground, maxval(abs(loads%signal(i)%value)))
      end do
      if (.not. allocated(error) .and. allocated(initial%deformation)) then
         call check_values(initial%deformation, 'initial deformation', error)
         call structure%check_initial('initial deformation', initial%deformation, error)
      end if
      if (.not. allocated(error) .and. allocated(initial%velocity)) then
         call check_values(initial%velocity, 'initial velocity', error)
         call structure%check_initial('initial velocity', initial%velocity, error)
      end if
      if (allocated(error)) return
      task%summary%has_force = loads%signal(lateral)%acts()
      task%summary%stable_step = plan%limit
      task%summary%method = plan%method
      task%summary%reason = plan%reason
      call new_stepper(stepper, structure, analysis, plan)
      call march(structure, plan, stepper, time, loads, initial, task, error, monitor)
   end subroutine run_dynamic

   !> Make the method of a plan, ready for its first step.
   subroutine new_stepper(stepper, structure, analysis, plan)
      class(stepper_type), allocatable, intent(out) :: stepper
      class(structure_type), intent(in) :: structure
      type(analysis_record), intent(in) :: analysis
      type(time_plan), intent(in) :: plan
      type(rk4_stepper), allocatable :: fixed
      type(located_stepper), allocatable :: located
      type(method_type) :: method, first
      real(wp) :: rho

      method = method_named(plan%method)
      rho = usual_rho_infinity
      if (is_given(analysis%rho_infinity)) rho = analysis%rho_infinity
      select case (plan%method)
      case ('newmark')
         call set_implicit(stepper, new_newmark(), structure)
      case ('hht')
         call set_implicit(stepper, new_hht(rho), structure)
      case ('generalised_alpha')
         call set_implicit(stepper, new_generalised_alpha(rho), structure)
      case ('rk45')
         allocate (located)
         allocate (pair45_scheme :: located%scheme)
         call located%scheme%create(structure)
         located%tolerance = usual_tolerance
         if (is_given(analysis%tolerance)) located%tolerance = analysis%tolerance
         ! The first step is that of rk4.
         first = method_named('rk4')
         located%next_step = first%limit_share*plan%limit
         located%longest = method%limit_share*plan%limit
         located%shortest = 1.0e-6_wp*plan%limit
         call move_alloc(located, stepper)
      case default
         if (analysis%events == 'located' .or. plan%located) then
            allocate (located)
            allocate (rk4_scheme :: located%scheme)
            call located%scheme%create(structure)
            call move_alloc(located, stepper)
         else
            allocate (fixed)
            call fixed%scheme%create(structure)
            call move_alloc(fixed, stepper)
         end if
      end select
      ! A number for the method, 100 more with located events: a state is continued by the same one alone.
      stepper%method = findloc(methods%name == plan%method, .true., dim=1)
      if (analysis%events == 'located' .or. plan%located) stepper%method = stepper%method + 100
      if (is_given(analysis%rho_infinity)) stepper%setting = analysis%rho_infinity
   end subroutine new_stepper

   !> Make a stepper of an implicit method, for exact rotations if the kinematics of the structure is
   !> `finite`.
   subroutine set_implicit(stepper, method, structure)
      class(stepper_type), allocatable, intent(out) :: stepper
      type(implicit_stepper), intent(in) :: method
      class(structure_type), intent(in) :: structure

      if (structure%kinematics == finite) then
         allocate (stepper, source=with_finite_rotations(method))
      else
         allocate (stepper, source=method)
      end if
   end subroutine set_implicit

end module rbs_solve_time_run_dynamic
