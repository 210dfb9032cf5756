!> A column as a lane of a block, and the lane as the state of a run alone.
module rbs_solve_ensemble_lane_state
   use rbs_base_kinds, only: wp
   use rbs_structure_column_column, only: column_type
   use rbs_loading_loads, only: horizontal
   use rbs_solve_ensemble_lane_arrays, only: lane_clock, lane_block, allot, few
   use rbs_solve_time_implicit, only: implicit_stepper
   use rbs_solve_time_motion, only: motion_type
   use rbs_solve_time_state, only: state_type
   implicit none
   private

   public :: fit_block, column_to_lane, springs_to_lane, motion_to_lane, bounds_to_lane, step_to_lane
   public :: springs_from_lane, motion_from_lane, step_from_lane, ground_from_lane

contains

   !> Room for columns of the size and the kind of damping of one.
   subroutine fit_block(b, room, taken, base, width, column)
      type(lane_block), intent(inout) :: b
      !> See `allot`
      real(wp), intent(inout), target, contiguous :: room(:)
      integer, intent(inout) :: taken
      !> Lanes before the block, and its number of lanes
      integer, intent(in) :: base, width
      type(column_type), intent(in) :: column
      integer :: n, m

      n = column%n
      m = 2*n
      b%width = width
      b%base = base
      b%n = n
      b%damped = column%damped
      b%modal = allocated(column%modal_damping)
      ! In the order of `body_arrays`
      call allot(room, taken, width, m, b%q)
      call allot(room, taken, width, m, b%v)
      call allot(room, taken, width, m, b%from)
      call allot(room, taken, width, m, b%lowest)
      call allot(room, taken, width, m, b%highest)
      call allot(room, taken, width, m, b%d0)
      call allot(room, taken, width, m, b%f0)
      call allot(room, taken, width, m, b%k)
      call allot(room, taken, width, m, b%first)
      call allot(room, taken, width, m, b%last)
      call allot(room, taken, width, m, b%way)
      call allot(room, taken, width, m, b%work)
      call allot(room, taken, width, m, b%v0)
      call allot(room, taken, width, m, b%a0)
      call allot(room, taken, width, m, b%g0)
      call allot(room, taken, width, 2, b%largest)
      b%lowest = -huge(1.0_wp)
      b%highest = huge(1.0_wp)
      if (width /= few) return
      allocate (b%damping(few, m), b%summed(few, m), b%arm(few, m), b%ground_arm(few, m), b%lower(few, n), &
                b%upper(few, n), b%inverse_mass(few, n), b%inverse_inertia(few, n), b%along(few, n), &
                b%across(few, n), source=0.0_wp)
      allocate (b%mass(few, m), source=1.0_wp)
      allocate (b%tangent(few, 4, m), source=0.0_wp)
      if (b%modal) allocate (b%matrix(few, m, m), source=0.0_wp)
   end subroutine fit_block

   !> What of a column stays as it is.
   subroutine column_to_lane(b, i, column, motion)
      type(lane_block), intent(inout) :: b
      !> Lane of the block
      integer, intent(in) :: i
      class(column_type), intent(in) :: column
      type(motion_type), intent(in) :: motion

      associate (n => b%n)
         b%lower(i, :) = column%lower
         b%upper(i, :) = column%upper
         b%inverse_mass(i, :) = column%inverse_mass
         b%inverse_inertia(i, :) = column%inverse_inertia
         b%mass(i, :) = column%inertias
         b%along(i, :) = 0.0_wp
         b%across(i, :) = 0.0_wp
         if (motion%second_order) then
            b%along(i, :) = column%axial_body*column%length
            b%across(i, :) = column%axial_slip
         end if
         b%arm(i, :) = column%arm
         b%ground_arm(i, :) = column%ground_arm
         b%mass_above(i) = column%mass_above(1)
         b%of_mass(i) = column%mass_damping
         b%factor(i) = 1.0_wp
         if (column%tangent_damping) b%factor(i) = column%stiffness_damping
      end associate
      if (b%modal) b%matrix(i, :, :) = motion%modal
   end subroutine column_to_lane

   !> Works and lines of the springs.
   subroutine springs_to_lane(b, i, state)
      type(lane_block), intent(inout) :: b
      integer, intent(in) :: i
      type(state_type), intent(in) :: state
      integer :: j

      associate (springs => state%springs, structure => state%motion%structure)
         do j = 1, 2*b%n
            b%work(i, j) = springs%work(j)
            b%d0(i, j) = springs%d0(j)
            b%f0(i, j) = springs%f0(j)
            b%k(i, j) = springs%k(j)
            b%first(i, j) = springs%first(j)
            b%last(i, j) = springs%last(j)
            b%way(i, j) = real(springs%unload_on_reversal(j), wp)
            if (.not. b%damped) cycle
            b%summed(i, j) = state%motion%joint_damping(j)
            if (structure%tangent_damping) b%summed(i, j) = max(springs%k(j), 0.0_wp)
            b%damping(i, j) = b%summed(i, j)
            if (structure%tangent_damping) b%damping(i, j) = structure%stiffness_damping*b%summed(i, j)
         end do
      end associate
   end subroutine springs_to_lane

   !> Works of the springs, and rear ends of those that unload on reversal; their branches have not
   !> changed.
   subroutine springs_from_lane(b, i, d, state)
      type(lane_block), intent(in) :: b
      integer, intent(in) :: i
      !> Deformations (width, unknowns) that the works belong to
      real(wp), intent(in) :: d(:, :)
      type(state_type), intent(inout) :: state
      integer :: j

      do j = 1, 2*b%n
         state%springs%d(j) = d(i, j)
         state%springs%work(j) = b%work(i, j)
         state%springs%first(j) = b%first(i, j)
         state%springs%last(j) = b%last(i, j)
      end do
   end subroutine springs_from_lane

   !> How the joints move, works, and the largest responses.
   subroutine motion_to_lane(x, b, i, state)
      type(lane_clock), intent(inout) :: x
      type(lane_block), intent(inout) :: b
      integer, intent(in) :: i
      type(state_type), intent(in) :: state
      integer :: l

      l = b%base + i
      b%q(i, :) = state%q
      b%v(i, :) = state%v
      x%ground(l) = state%load(horizontal)
      x%of_loads(l) = state%of_loads
      x%of_damping(l) = state%of_damping
      x%peak(l) = state%sight%peak_displacement
      x%base(l) = state%sight%peak_base_shear
      x%rotation(l) = state%sight%peak_rotation
      call bounds_to_lane(b, i, state)
   end subroutine motion_to_lane

   !> The same at the start of a step.
   subroutine motion_from_lane(x, b, i, state)
      type(lane_clock), intent(in) :: x
      type(lane_block), intent(in) :: b
      integer, intent(in) :: i
      type(state_type), intent(inout) :: state
      integer :: l

      l = b%base + i
      state%q(:) = b%q(i, :)
      state%v(:) = b%v(i, :)
      state%time = x%t(l)
      state%clock = x%t(l)
      state%load(horizontal) = x%ground(l)
      state%of_loads = x%of_loads(l)
      state%of_damping = x%of_damping(l)
      state%sight%peak_displacement = x%peak(l)
      state%sight%peak_base_shear = x%base(l)
      state%sight%peak_rotation = x%rotation(l)
      state%sight%clock = x%t(l)
      state%sight%q(:) = state%q
      call ground_from_lane(x, l, state)
   end subroutine motion_from_lane

   !> Of its motion a run alone has the present interval and the next.
   subroutine ground_from_lane(x, l, state)
      type(lane_clock), intent(in) :: x
      !> Number of the lane
      integer, intent(in) :: l
      type(state_type), intent(inout) :: state
      real(wp) :: time(3), value(3)

      time = [x%begin(l), x%finish(l), x%next_finish(l)]
      value = [x%value(l), x%next_value(l), x%after_value(l)]
      call state%loads%signal(horizontal)%replace(time, value)
   end subroutine ground_from_lane

   !> The bounds of what is watched for, and the deformations that were seen last.
   subroutine bounds_to_lane(b, i, state)
      type(lane_block), intent(inout) :: b
      integer, intent(in) :: i
      type(state_type), intent(in) :: state

      b%lowest(i, :) = state%sight%lowest
      b%highest(i, :) = state%sight%highest
      b%from(i, :) = state%sight%q
   end subroutine bounds_to_lane

   !> What an implicit method starts the next step from.
   subroutine step_to_lane(b, i, stepper)
      type(lane_block), intent(inout) :: b
      integer, intent(in) :: i
      type(implicit_stepper), intent(in) :: stepper

      b%v0(i, :) = stepper%step%v0
      b%a0(i, :) = stepper%step%a0
      b%g0(i, :) = stepper%step%g0
      b%largest(i, :) = stepper%step%largest(:2)
   end subroutine step_to_lane

   subroutine step_from_lane(b, i, stepper)
      type(lane_block), intent(in) :: b
      integer, intent(in) :: i
      type(implicit_stepper), intent(inout) :: stepper

      stepper%step%v0(:) = b%v0(i, :)
      stepper%step%a0(:) = b%a0(i, :)
      stepper%step%g0(:) = b%g0(i, :)
      stepper%step%largest(:2) = b%largest(i, :)
   end subroutine step_from_lane

end module rbs_solve_ensemble_lane_state
