!> The state of a run alone as a lane, and the lane as that state.
module rbs_solve_ensemble_lane_state
   use rbs_base_kinds, only: wp
   use rbs_loading_loads, only: horizontal
   use rbs_solve_ensemble_lane_arrays, only: lane_clock, body_arrays
   use rbs_solve_time_implicit, only: implicit_stepper
   use rbs_solve_time_state, only: state_type
   implicit none
   private

   public :: springs_to_lane, motion_to_lane, bounds_to_lane, step_to_lane
   public :: motion_from_lane, step_from_lane, ground_from_lane

contains

   !> Put works and lines of the two springs from the state of a run alone into its lane.
   subroutine springs_to_lane(y, l, state)
      !> Motion and springs of every lane
      type(body_arrays), intent(inout) :: y
      !> Number of the lane
      integer, intent(in) :: l
      type(state_type), intent(in) :: state
      integer :: j

      associate (springs => state%springs)
         do j = 1, 2
            y%work(l, j) = springs%work(j)
            y%d0(l, j) = springs%d0(j)
            y%f0(l, j) = springs%f0(j)
            y%k(l, j) = springs%k(j)
            y%lower(l, j) = springs%lower(j)
            y%upper(l, j) = springs%upper(j)
            y%direction(l, j) = real(springs%unload_on_reversal(j), wp)
         end do
      end associate
   end subroutine springs_to_lane

   !> Put motion of the joints, works and the largest responses from the state of a run alone into its lane.
   subroutine motion_to_lane(x, y, l, state)
      !> Clock and column of every lane
      type(lane_clock), intent(inout) :: x
      !> Motion and springs of every lane
      type(body_arrays), intent(inout) :: y
      !> Number of the lane
      integer, intent(in) :: l
      type(state_type), intent(in) :: state

      y%q(l, :) = state%q
      y%v(l, :) = state%v
      x%ground(l) = state%load(horizontal)
      x%of_loads(l) = state%of_loads
      x%of_damping(l) = state%of_damping
      x%peak(l) = state%monitor%peak_displacement
      x%base(l) = state%monitor%peak_base_shear
      x%rotation(l) = state%monitor%peak_rotation
      call bounds_to_lane(y, l, state)
   end subroutine motion_to_lane

   !> Give the state of a run alone what its lane has at the start of a step: time, motion of the joints,
   !> works, the largest responses and the motion of the ground.
   subroutine motion_from_lane(x, y, l, state)
      !> Clock and column of every lane
      type(lane_clock), intent(in) :: x
      !> Motion and springs of every lane
      type(body_arrays), intent(in) :: y
      !> Number of the lane
      integer, intent(in) :: l
      type(state_type), intent(inout) :: state

      state%q(:) = y%q(l, :)
      state%v(:) = y%v(l, :)
      state%time = x%t(l)
      state%clock = x%t(l)
      state%load(horizontal) = x%ground(l)
      state%of_loads = x%of_loads(l)
      state%of_damping = x%of_damping(l)
      state%monitor%peak_displacement = x%peak(l)
      state%monitor%peak_base_shear = x%base(l)
      state%monitor%peak_rotation = x%rotation(l)
      state%monitor%clock = x%t(l)
      state%monitor%q(:) = state%q
      call ground_from_lane(x, l, state)
   end subroutine motion_from_lane

   !> Give the state of a run alone the present interval of the ground motion and the next; a step needs no
   !> more of it.
   subroutine ground_from_lane(x, l, state)
      !> Clock and column of every lane
      type(lane_clock), intent(in) :: x
      !> Number of the lane
      integer, intent(in) :: l
      type(state_type), intent(inout) :: state
      real(wp) :: time(3), value(3)

      time = [x%begin(l), x%finish(l), x%next_finish(l)]
      value = [x%value(l), x%next_value(l), x%after_value(l)]
      call state%loads%signal(horizontal)%replace(time, value)
   end subroutine ground_from_lane

   !> Put the deformations between which no limit state is reached, and those at the last check, into a lane.
   subroutine bounds_to_lane(y, l, state)
      !> Motion and springs of every lane
      type(body_arrays), intent(inout) :: y
      !> Number of the lane
      integer, intent(in) :: l
      type(state_type), intent(in) :: state

      y%lowest(l, :) = state%monitor%lowest
      y%highest(l, :) = state%monitor%highest
      y%from(l, :) = state%monitor%q
   end subroutine bounds_to_lane

   !> Put what the next implicit step starts with into a lane: velocities, accelerations and forces of the
   !> body, and the largest forces so far.
   subroutine step_to_lane(y, l, stepper)
      !> Motion and springs of every lane
      type(body_arrays), intent(inout) :: y
      !> Number of the lane
      integer, intent(in) :: l
      type(implicit_stepper), intent(in) :: stepper

      y%v0(l, :) = stepper%step%v0
      y%a0(l, :) = stepper%step%a0
      y%g0(l, :) = stepper%step%g0
      y%largest(l, :) = stepper%step%largest(:2)
   end subroutine step_to_lane

   !> Give the method what its next implicit step starts with, from a lane: velocities, accelerations and
   !> forces of the body, and the largest forces so far.
   subroutine step_from_lane(y, l, stepper)
      !> Motion and springs of every lane
      type(body_arrays), intent(in) :: y
      !> Number of the lane
      integer, intent(in) :: l
      type(implicit_stepper), intent(inout) :: stepper

      stepper%step%v0(:) = y%v0(l, :)
      stepper%step%a0(:) = y%a0(l, :)
      stepper%step%g0(:) = y%g0(l, :)
      stepper%step%largest(:2) = y%largest(l, :)
   end subroutine step_from_lane

end module rbs_solve_ensemble_lane_state
