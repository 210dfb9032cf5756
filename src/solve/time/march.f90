!> Response in time: marching through the plan, energy balance, rows.
module rbs_solve_time_march
   use rbs_base_constants, only: unset_integer
   use rbs_base_error, only: error_type, fatal_error, analysis_failed
   use rbs_base_inner_product, only: total
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_hysteresis_interaction_joints, only: fall_of
   use rbs_output_summary, only: summary_type
   use rbs_solve_end_state, only: checkpoint_type
   use rbs_solve_task, only: task_type, many_unknowns
   use rbs_loading_loads, only: loads_type, lateral, horizontal, sideways
   use rbs_solve_time_motion, only: motion_result
   use rbs_solve_time_plan, only: time_plan, same_step
   use rbs_solve_time_monitor, only: response_monitor
   use rbs_solve_time_start, only: initial_state, start_state, resume_state, resume_steps, keep_state
   use rbs_solve_time_state, only: state_type, stepper_type, out_of_bounds
   use rbs_structure_channel, only: energy_type, response_type
   use rbs_structure_spring_location, only: spring_name
   use rbs_structure_structure, only: structure_type
   implicit none
   private

   public :: initial_state, march, start_state, report_state, step_of, balance

contains

   !> March through the plan: from the state at the start step by step, with rows, peaks and energies, to the
   !> end of the run.
   subroutine march(structure, planned, stepper, time, loads, initial, task, error, monitor)
      class(structure_type), intent(in) :: structure
      type(time_plan), intent(in) :: planned
      !> The method
      class(stepper_type), intent(inout) :: stepper
      !> Times of the loading (m) [s]
      real(wp), intent(in) :: time(:)
      type(loads_type), intent(in) :: loads
      type(initial_state), intent(in) :: initial
      !> Without `every` each interval of the plan has a row
      type(task_type), intent(inout) :: task
      !> On failure everything up to the last good state has been recorded
      type(error_type), allocatable, intent(out) :: error
      !> Monitor of peaks and limit states
      type(response_monitor), intent(inout), optional :: monitor
      type(checkpoint_type) :: checkpoint
      type(time_plan) :: plan
      type(state_type) :: state
      type(response_type) :: response
      integer :: step

      plan = planned
      if (task%resumes()) then
         call resume_state(state, structure, loads, task%before, plan, checkpoint, error)
         if (allocated(error)) return
         call resume_steps(state, stepper, task%before, checkpoint)
      end if
      if (checkpoint%kind == 0) call start_state(state, structure, loads, initial, plan%begin, error)
      if (allocated(error)) return
      if (present(monitor)) state%monitor = monitor
      call state%begin_monitor(task%collapse_drift, task%recorder%channels%contents%motion)
      task%summary%time_step = plan%dt
      call take_steps()
      if (present(monitor)) monitor = state%monitor
      task%summary%last_time = response%time
      task%summary%last_displacement = response%displacement
      task%summary%peaks_type = state%monitor%peaks_type
      task%summary%collapsed = state%monitor%collapsed
      task%summary%events = state%springs%events
      task%summary%steps = stepper%steps
      task%summary%cut_steps = stepper%cut_steps
      if (state%snaps > 0) call report_snaps(state, task%summary)
      if (stepper%longest_step > 0.0_wp) task%summary%time_step = stepper%longest_step
      if (allocated(error) .or. .not. task%keeps_end .or. task%summary%lost_joint > 0) return
      call keep_state(state, stepper, plan, step, response%energy%residual, task%after)

   contains

      !> Take the steps of the plan, up to the end of the run, and keep rows. A run ends early by an error, a
      !> collapse, a fall or a stop.
      subroutine take_steps()
         type(motion_result) :: now
         real(wp) :: begin, finish, h
         !> Interval of the plan; step in it, and number of these; next step with a row; joint that has lost
         !> its axial load, 0 for none
         integer :: interval, part, parts, next_row, crushed_joint
         logical :: ends

         call now%create(state%motion%structure)
         ! Number of the step after which the next row is kept; without `every` rows are those of intervals.
         next_row = huge(1)
         if (task%every /= unset_integer) next_row = min(task%every, plan%steps)
         step = 0
         call remove_members()
         call balance(state, response%energy, task%summary)
         call keep(error, now)
         if (allocated(error)) return
         finish = plan%begin
         do interval = 1, plan%intervals
            begin = finish
            call interval_of(plan, time, interval, finish, parts)
            h = step_of(plan, (finish - begin)/parts)
            do part = 1, parts
               call stepper%advance(state, h, error)
               if (allocated(error)) then
                  call keep_last(now)
                  return
               end if
               step = step + 1
               if (state%diverged .or. state%springs%stuck) then
                  call report_state(state, error)
                  return
               end if
               if (state%runaway > 0) then
                  call end_with_fall(now)
                  return
               end if
               state%clock = begin + part*h
               if (part == parts) state%clock = finish
               crushed_joint = state%springs%crushed_joint()
               if (crushed_joint > 0) then
                  task%summary%lost_joint = state%motion%structure%location(crushed_joint)%index
               end if
               ends = task%summary%lost_joint > 0 .or. state%monitor%collapsed
               ! A joint may have lost its axial load, or the column may have collapsed, within the step.
               if (ends .and. state%begin + state%time < state%clock - same_step*h) then
                  state%clock = state%begin + state%time
               end if
               state%time = state%clock - state%begin
               call remove_members()
               call state%update_monitor(state%clock)
               if (state%motion%structure%has_collapsed(state%q)) state%monitor%collapsed = .true.
               ends = ends .or. state%monitor%collapsed
               if (task%summary%lost_joint > 0) call fall_of(state%springs, crushed_joint, task%summary%fall)
               if (ends .or. part == parts) call balance(state, response%energy, task%summary)
               if (ends .or. step == next_row .or. (task%every == unset_integer .and. part == parts)) then
                  if (.not. (ends .or. part == parts)) call balance(state, response%energy)
                  call keep(error, now)
                  if (allocated(error) .or. ends) return
                  if (task%every /= unset_integer) next_row = min(step + task%every, plan%steps)
               end if
               ! Steps of many unknowns are long.
               if (iand(step, merge(15, 1023, state%motion%structure%unknowns >= many_unknowns)) == 0) then
                  if (associated(task%progress)) call task%progress%update(real(step, wp)/plan%steps)
                  if (task%stops()) then
                     task%summary%remark = 'the run was stopped at time '//to_text(state%clock)// &
                                           ' s (max_seconds, or from outside)'
                     call keep_last(now)
                     return
                  end if
               end if
            end do
         end do
      end subroutine take_steps

      !> A member has failed inside, where nothing has mass: the run ends in the last state that it has.
      subroutine end_with_fall(now)
         !> Work arrays
         type(motion_result), intent(inout) :: now

         task%summary%remark = 'at time '//to_text(state%begin + state%time)//' s '// &
                               trim(spring_name(state%motion%structure%location(state%runaway)))// &
                               ' slides or turns away: its member no longer carries its dead load, or '// &
                               'the moments of its ends'
         task%summary%fallen_member = state%motion%structure%location(state%runaway)%member
         state%monitor%collapsed = .true.
         call keep_last(now)
      end subroutine end_with_fall

      !> Members that are lost carry nothing from the next step on, which begins with other accelerations.
      subroutine remove_members()
         integer :: member

         do
            member = state%motion%structure%next_failed_member(state%springs, state%clock)
            if (member == 0) return
            call state%motion%structure%remove_member(member, state%springs)
            state%q = state%springs%d
            stepper%begun = .false.
         end do
      end subroutine remove_members

      !> Record the last good state before a failure.
      subroutine keep_last(now)
         !> Work arrays
         type(motion_result), intent(inout) :: now
         type(error_type), allocatable :: ignored

         state%clock = state%begin + state%time
         ! A row of this time may be there already.
         if (state%diverged .or. .not. state%clock > response%time) return
         call state%update_monitor(state%clock)
         call balance(state, response%energy, task%summary)
         call keep(ignored, now)
      end subroutine keep_last

      !> Keep the present state, whose energies are in the response.
      subroutine keep(error, now)
         type(error_type), allocatable, intent(inout) :: error
         !> Work arrays
         type(motion_result), intent(inout) :: now

         response%time = state%clock
         response%displacement = state%motion%structure%top_displacement(state%q)
         response%force = state%load(lateral)
         response%ground = state%load(horizontal)
         response%ground_y = state%load(sideways)
         if (.not. allocated(response%v)) then
            allocate (response%v, response%a, source=state%v)
            allocate (response%f(state%springs%count), source=0.0_wp)
         end if
         response%v(:) = state%v
         if (task%recorder%channels%contents%motion) then
            call state%motion%acceleration(state%springs, state%q, state%v, state%load, now)
            response%a(:) = now%a
         end if
         ! Without damping the forces of the springs are all.
         if (state%motion%damped) then
            call state%motion%joint_forces(state%springs, state%q, state%v, state%load, response%f)
            response%base_shear = state%motion%base_shear(state%springs, state%q, state%v)
         end if
         task%summary%rows = task%summary%rows + 1
         call task%recorder%keep(state%motion%structure, response, state%springs, state%q, error)
      end subroutine keep

   end subroutine march

   !> End of an interval between kept times [s], and the number of its steps.
   pure subroutine interval_of(plan, time, interval, finish, parts)
      type(time_plan), intent(in) :: plan
      !> Times of the loading (m) [s]
      real(wp), intent(in) :: time(:)
      integer, intent(in) :: interval
      real(wp), intent(out) :: finish
      integer, intent(out) :: parts

      if (plan%free) then
         parts = 1
         finish = min(plan%origin + (plan%offset + interval)*plan%dt, plan%finish)
         if (interval == plan%intervals) finish = plan%finish
      else
         parts = plan%parts(interval)
         finish = time(interval + 1)
      end if
   end subroutine interval_of

   !> Report to the summary where, when and how often members snapped.
   subroutine report_snaps(state, summary)
      type(state_type), intent(in) :: state
      type(summary_type), intent(inout) :: summary
      character(len=:), allocatable :: before

      summary%snaps = state%snaps
      summary%snap_member = state%motion%structure%location(state%snap_spring)%member
      summary%snap_time = state%snap_time
      before = trim(summary%remark)
      if (before /= '') before = '; '//before
      summary%remark = 'members snapped from one equilibrium to another in '//to_text(state%snaps)// &
                       ' step(s), which lost '//to_text(state%in_snaps)//' J; the most, '// &
                       to_text(state%largest_snap)//' J, was lost at time '//to_text(state%snap_time)// &
                       ' s, where '//trim(spring_name(state%motion%structure%location(state%snap_spring)))// &
                       ' moved farthest'//before
   end subroutine report_snaps

   !> The step of the plan in place of a step that differs from it by round-off, as where times are multiples
   !> of one step: the steps are then equal to the last bit, and the constants of a method for a step hold for
   !> all of them.
   pure real(wp) function step_of(plan, h)
      type(time_plan), intent(in) :: plan
      !> Step [s]
      real(wp), intent(in) :: h

      step_of = h
      if (abs(h - plan%dt) <= same_step*plan%dt) step_of = plan%dt
   end function step_of

   !> Report why the run cannot be continued: a deformation is out of bounds, or a rule of a spring goes in a
   !> circle.
   subroutine report_state(state, error)
      type(state_type), intent(in) :: state
      type(error_type), allocatable, intent(inout) :: error

      if (state%diverged) then
         call fatal_error(error, analysis_failed, 'the motion grows without bounds at time '// &
                          to_text(state%begin + state%time)//' s (a deformation is beyond '// &
                          to_text(out_of_bounds)//'): the step is beyond the stability limit, the column '// &
                          'has lost its stability under the axial load, or the loading has a wrong unit. '// &
                          'Rows up to there are kept')
      else
         call fatal_error(error, analysis_failed, 'a hysteresis rule leads in a circle of lines at time '// &
                          to_text(state%begin + state%time)//' s; the parameters of a spring are too '// &
                          'extreme for the arithmetic. Rows up to there are kept')
      end if
   end subroutine report_state

   !> The energies of the present state, and the residual of their balance.
   subroutine balance(state, energy, summary)
      type(state_type), intent(in) :: state
      type(energy_type), intent(out) :: energy
      !> The summary that keeps the largest of them
      type(summary_type), intent(inout), optional :: summary

      energy%input = state%of_loads
      energy%kinetic = state%motion%structure%kinetic_energy(state%q, state%v) + state%along_joints
      energy%spring = total(state%springs%count, state%springs%work)
      energy%damping = state%of_damping
      energy%axial = state%motion%structure%potential_energy(state%q)
      energy%snaps = state%in_snaps
      energy%residual = state%of_loads + state%at_begin - energy%kinetic - energy%spring - energy%damping &
                        - energy%axial - energy%snaps
      if (present(summary)) call summary%update_energies(energy)
   end subroutine balance

end module rbs_solve_time_march
