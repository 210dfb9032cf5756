!> Frames under their dead load: the path from no load to all of it, event by event, on which the columns get
!> the axial forces whose second-order work is counted from then on.
module rbs_solve_static_dead_load
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_springs, only: spring_array
   use rbs_output_recorder, only: array_recorder
   use rbs_solve_end_state, only: end_state, standing_type
   use rbs_solve_static_frame_equilibrium, only: frame_equilibrium
   use rbs_solve_static_straight, only: trace_straight
   use rbs_solve_task, only: task_type
   use rbs_structure_frame_frame, only: frame_type
   implicit none
   private

   public :: put_dead_load

contains

   !> Put the dead load on a frame: its axial forces, and the state in which every analysis begins.
   subroutine put_dead_load(frame, state, error)
      type(frame_type), intent(inout) :: frame
      type(end_state), intent(out) :: state
      type(error_type), allocatable, intent(out) :: error
      logical :: second_order

      if (.not. frame%is_loaded()) return
      ! First without second-order work, then with that of the axial forces found.
      second_order = frame%axially_loaded
      frame%axially_loaded = .false.
      call load_once(frame, state, error)
      frame%axially_loaded = second_order
      if (second_order .and. .not. allocated(error)) call load_once(frame, state, error)
      ! The path has one row, from no load to all of it.
      if (allocated(error)) error%message = 'dead load: '//error%message(len('row 1: ') + 1:)
   end subroutine put_dead_load

   subroutine load_once(frame, state, error)
      type(frame_type), intent(inout), target :: frame
      type(end_state), intent(out) :: state
      type(error_type), allocatable, intent(out) :: error
      type(frame_type), target :: unloaded
      type(frame_equilibrium), target :: equilibrium
      type(array_recorder), target :: nothing
      type(task_type), target :: task
      type(standing_type) :: standing
      type(spring_array) :: springs

      call equilibrium%create(frame, .true.)
      unloaded = frame
      call unloaded%take_load_off()
      task%recorder => nothing
      task%keeps_end = .true.
      call trace_straight(unloaded, equilibrium, .true., [1.0_wp], task, error)
      if (allocated(error)) return
      call frame%create_springs(springs, frame%constant_axial)
      call task%after%take_up(frame, standing, springs, error)
      if (allocated(error)) return
      call frame%set_compression(springs%d, springs%f0 + springs%k*(springs%d - springs%d0))
      ! What has been done so far is no part of an analysis, whose lateral force begins at zero.
      standing%force = 0.0_wp
      standing%load = 0.0_wp
      standing%input = 0.0_wp
      standing%residual = 0.0_wp
      standing%method = 0
      call state%start_saving(frame, standing, springs)
      call state%finish_saving()
   end subroutine load_once

end module rbs_solve_static_dead_load
