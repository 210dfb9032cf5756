!> Where an analysis in time begins: at rest, in a state that the user gives, or in the one that another
!> analysis ended in; and the state that it ends in itself.
module rbs_solve_time_start
   use rbs_base_error, only: error_type, fatal_error, analysis_failed
   use rbs_base_inner_product, only: total
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_hysteresis_interaction_joints, only: vary_axial_loads
   use rbs_solve_end_state, only: end_state, checkpoint_type, moving_state
   use rbs_loading_loads, only: loads_type, lateral, vertical, top_axial
   use rbs_solve_time_plan, only: time_plan, same_step
   use rbs_solve_time_state, only: state_type, stepper_type
   use rbs_structure_spring_location, only: spring_name, axial
   use rbs_structure_structure, only: structure_type, signals
   implicit none
   private

   public :: initial_state, start_state, restart_state, resume_state, resume_steps, keep_state

   !> State at the start; arrays that are not allocated are zero.
   type :: initial_state
      !> Deformations [m, rad] and velocities [m/s, rad/s] (unknowns); the springs reach them from zero
      real(wp), allocatable :: deformation(:), velocity(:)
      !> Whether the openings are among them; else the axial springs begin in equilibrium with axial load
      !> and weight
      logical :: opening_given = .false.
   end type initial_state

contains

   !> Begin in the state that another analysis ended in. If this one begins at the time at which that ended,
   !> the clock continues.
   subroutine resume_state(state, structure, loads, before, plan, checkpoint, error)
      type(state_type), intent(out) :: state
      class(structure_type), intent(in) :: structure
      type(loads_type), intent(in) :: loads
      type(end_state), intent(inout) :: before
      !> Its steps continue those of the other analysis, if they are the same
      type(time_plan), intent(inout) :: plan
      !> Numbers of the state that are not part of `state`
      type(checkpoint_type), intent(out) :: checkpoint
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: axial_force(size(structure%location)), residual, largest(signals)
      integer :: i

      call create_state(state, structure, loads, plan%begin, error)
      if (allocated(error)) return
      call before%restore(structure, checkpoint, state%springs, error)
      if (allocated(error)) return
      if (checkpoint%kind == moving_state) then
         call plan%go_on_from(checkpoint%dt, checkpoint%origin, checkpoint%offset)
         if (.not. abs(checkpoint%clock - plan%begin) > 0.0_wp) then
            state%begin = checkpoint%begin
            state%time = checkpoint%time
            state%loads = loads
            call prepare_loads(state, structure)
         end if
      end if
      ! A continuous load differs by the round-off of a clock that counts steps from its start.
      call state%loads%find_largest(largest)
      largest = same_step*max(largest, abs(checkpoint%load))
      if (all(abs(state%load - checkpoint%load) <= largest)) state%load = checkpoint%load
      axial_force = [(structure%axial_force(i, state%load), i=1, size(axial_force))]
      call checkpoint%put_under(structure, axial_force, state%springs, error)
      if (allocated(error)) return
      state%q = state%springs%d
      state%v = checkpoint%v
      state%of_loads = checkpoint%input
      state%of_damping = checkpoint%damping
      state%at_begin = checkpoint%at_begin
      state%along_joints = checkpoint%along_joints
      ! The balance of energy keeps the residual that it had.
      residual = checkpoint%residual - (state%of_loads + state%at_begin &
                                     - (structure%kinetic_energy(state%q, state%v) + state%along_joints) &
                                     - total(state%springs%count, state%springs%work) - state%of_damping &
                                     - structure%potential_energy(state%q))
      if (abs(residual) > 0.0_wp) state%at_begin = state%at_begin + residual
   end subroutine resume_state

   !> Let the method continue with its memory, if it is the same with the same setting, unless a load jumps at
   !> the start.
   subroutine resume_steps(state, stepper, before, checkpoint)
      type(state_type), intent(inout) :: state
      class(stepper_type), intent(inout) :: stepper
      !> The state, read up to the memory of the method
      type(end_state), intent(inout) :: before
      type(checkpoint_type), intent(in) :: checkpoint

      if (checkpoint%kind /= moving_state .or. checkpoint%method /= stepper%method) return
      if (abs(checkpoint%setting - stepper%setting) > 0.0_wp .or. &
          any(abs(state%load - checkpoint%load) > 0.0_wp)) return
      call stepper%resume(state, before%stream)
   end subroutine resume_steps

   !> Keep the state at the end of a run, from which another analysis can begin.
   subroutine keep_state(state, stepper, plan, steps, residual, after)
      type(state_type), intent(inout) :: state
      class(stepper_type), intent(inout) :: stepper
      type(time_plan), intent(in) :: plan
      !> Steps taken, as planned
      integer, intent(in) :: steps
      !> Residual of the balance of energy [J]
      real(wp), intent(in) :: residual
      type(end_state), intent(inout) :: after
      type(checkpoint_type) :: checkpoint
      integer :: i

      associate (structure => state%motion%structure)
         checkpoint%kind = moving_state
         checkpoint%axial_load_varies = state%springs%axial_load_varies
         checkpoint%displacement = structure%top_displacement(state%q)
         checkpoint%force = state%load(lateral)
         checkpoint%axial_load = structure%axial_load + state%load(top_axial)
         checkpoint%axial_force = [(structure%axial_force(i, state%load), i=1, size(structure%location))]
         checkpoint%v = state%v
         checkpoint%input = state%of_loads
         checkpoint%damping = state%of_damping
         checkpoint%at_begin = state%at_begin
         checkpoint%residual = residual
         checkpoint%along_joints = state%along_joints
         checkpoint%begin = state%begin
         checkpoint%clock = state%clock
         checkpoint%time = state%time
         checkpoint%load = state%load
         checkpoint%dt = plan%dt
         if (plan%free) then
            checkpoint%origin = plan%origin
            checkpoint%offset = plan%offset + steps
         end if
         checkpoint%method = stepper%method
         checkpoint%setting = stepper%setting
         ! The motion is where its springs are.
         call after%start_saving(structure, checkpoint, state%springs)
      end associate
      call stepper%resume(state, after%stream)
      call after%finish_saving()
   end subroutine keep_state

   !> The state at the start of an analysis: at rest, or with the deformations and velocities that the user
   !> gives.
   subroutine start_state(state, structure, loads, initial, begin, error)
      type(state_type), intent(out) :: state
      class(structure_type), intent(in) :: structure
      type(loads_type), intent(in) :: loads
      type(initial_state), intent(in) :: initial
      !> Time of the clock at the start [s]
      real(wp), intent(in) :: begin
      type(error_type), allocatable, intent(out) :: error

      call create_state(state, structure, loads, begin, error)
      if (allocated(error)) return
      if (allocated(initial%deformation)) state%q = initial%deformation
      if (allocated(initial%velocity)) state%v = initial%velocity
      if (.not. initial%opening_given) call close_joints(state, error)
      if (allocated(error)) return
      call state%springs%move_all(state%q)
      state%at_begin = state%motion%structure%kinetic_energy(state%q, state%v) &
                       + total(state%springs%count, state%springs%work) &
                       + state%motion%structure%potential_energy(state%q)
   end subroutine start_state

   !> Put the same structure at rest once more, under ground motions that have taken the place of others in
   !> the state.
   subroutine restart_state(state)
      type(state_type), intent(inout) :: state

      state%time = 0.0_wp
      state%clock = state%begin
      state%q = 0.0_wp
      state%v = 0.0_wp
      state%of_loads = 0.0_wp
      state%of_damping = 0.0_wp
      state%diverged = .false.
      call state%springs%restart(state%motion%structure%constant_axial)
      call state%loads%at_time(state%time, state%load)
   end subroutine restart_state

   !> The structure at rest, undeformed, under the loads of the first moment.
   subroutine create_state(state, structure, loads, begin, error)
      type(state_type), intent(out) :: state
      class(structure_type), intent(in) :: structure
      type(loads_type), intent(in) :: loads
      !> Time of the clock at the start [s]
      real(wp), intent(in) :: begin
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: axial_force(size(structure%location))
      integer :: i

      state%loads = loads
      state%begin = begin
      state%clock = begin
      call state%loads%find_acting()
      call state%motion%create(structure, state%loads%acts, error)
      if (allocated(error)) return
      call prepare_loads(state, structure)
      ! Layered joints begin under the axial forces of the first moment.
      axial_force = structure%constant_axial
      if (state%motion%varies) axial_force = [(structure%axial_force(i, state%load), i=1, size(axial_force))]
      call structure%create_springs(state%springs, axial_force)
      if (state%motion%varies) then
         call vary_axial_loads(state%springs)
         call state%motion%set_axial_loads(state%springs, state%load)
      end if
      allocate (state%q(structure%coordinates), state%v(structure%coordinates), source=0.0_wp)
   end subroutine create_state

   !> Let the loads be taken by the time since the start of the run, and find those of the moment.
   subroutine prepare_loads(state, structure)
      type(state_type), intent(inout) :: state
      class(structure_type), intent(in) :: structure

      call state%loads%find_acting()
      call state%loads%set_begin(state%begin)
      ! The history is that of the whole axial load; the motion takes its difference from the constant one.
      if (state%loads%acts(top_axial)) then
         state%loads%signal(top_axial)%value = state%loads%signal(top_axial)%value - structure%axial_load
      end if
      call state%loads%at_time(state%time, state%load)
   end subroutine prepare_loads

   !> Find the openings at which axial springs are in equilibrium with axial load and weight.
   subroutine close_joints(state, error)
      type(state_type), intent(inout) :: state
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: load(signals), tension
      integer :: i
      logical :: found

      load = state%load
      ! Not with the vertical acceleration of the ground
      load(vertical) = 0.0_wp
      do i = 1, state%springs%count
         if (state%motion%structure%location(i)%kind /= axial) cycle
         tension = -state%motion%structure%axial_force(i, load)
         call state%springs%load_to(i, tension, found)
         if (.not. found) then
            call fatal_error(error, analysis_failed, trim(spring_name(state%motion%structure%location(i)))// &
                             ' cannot carry the axial force of '//to_text(-tension)//' N (compression '// &
                             'positive) at the start; change axial_load or the spring, or give the '// &
                             'openings at the start')
            return
         end if
         state%q(i) = state%springs%d(i)
      end do
   end subroutine close_joints

end module rbs_solve_time_start
