!> A column as a lane of a block of chains, and the lane as the state of a run alone.
module rbs_solve_ensemble_chain_lane
   use rbs_base_kinds, only: wp
   use rbs_solve_ensemble_lane_fields, only: chain_block, few
   use rbs_solve_time_implicit, only: implicit_stepper
   use rbs_solve_time_motion, only: motion_type
   use rbs_solve_time_state, only: state_type
   implicit none
   private

   public :: fit_block, enter_column, enter_springs, enter_tangent, enter_state, enter_bounds
   public :: take_springs, take_state, take_tangent

contains

   !> Room for columns of n bodies.
   subroutine fit_block(b, n, damped, modal)
      type(chain_block), intent(inout) :: b
      integer, intent(in) :: n
      logical, intent(in) :: damped, modal
      integer :: m

      m = 2*n
      b%n = n
      b%damped = damped
      b%modal = modal
      allocate (b%q(few, m), b%v(few, m), b%from(few, m), b%d0(few, m), b%f0(few, m), b%k(few, m), &
                b%first(few, m), b%last(few, m), b%way(few, m), b%work(few, m), b%damping(few, m), &
                b%summed(few, m), b%arm(few, m), b%ground_arm(few, m), b%v0(few, m), b%a0(few, m), &
                b%g0(few, m), source=0.0_wp)
      allocate (b%lowest(few, m), source=-huge(1.0_wp))
      allocate (b%highest(few, m), source=huge(1.0_wp))
      allocate (b%mass(few, m), source=1.0_wp)
      allocate (b%lower(few, n), b%upper(few, n), b%inverse_mass(few, n), b%inverse_inertia(few, n), &
                b%along(few, n), b%across(few, n), source=0.0_wp)
      allocate (b%tangent(few, 4, m), source=0.0_wp)
      if (modal) allocate (b%matrix(few, m, m), source=0.0_wp)
   end subroutine fit_block

   !> What of a column stays as it is.
   subroutine enter_column(b, i, motion)
      type(chain_block), intent(inout) :: b
      !> Lane of the block
      integer, intent(in) :: i
      type(motion_type), intent(in) :: motion
      integer :: n, j

      n = b%n
      associate (column => motion%column)
         do j = 1, n
            b%lower(i, j) = column%lower(j)
            b%upper(i, j) = column%upper(j)
            b%inverse_mass(i, j) = motion%inverse_mass(j)
            b%inverse_inertia(i, j) = motion%inverse_inertia(j)
            b%mass(i, 2*j - 1) = column%mass(j)
            b%mass(i, 2*j) = column%inertia(j)
            b%along(i, j) = 0.0_wp
            b%across(i, j) = 0.0_wp
            if (motion%second_order) then
               b%along(i, j) = column%axial_body(j)*column%length(j)
               b%across(i, j) = column%axial_slip(j)
            end if
         end do
         do j = 1, 2*n
            b%arm(i, j) = column%arm(j)
            b%ground_arm(i, j) = column%ground_arm(j)
         end do
         b%mass_above(i) = column%mass_above(1)
         b%of_mass(i) = column%mass_damping
         b%factor(i) = 1.0_wp
         if (column%tangent_damping) b%factor(i) = column%stiffness_damping
      end associate
      if (b%modal) b%matrix(i, :, :) = motion%modal
   end subroutine enter_column

   !> Springs after a step alone: works and lines.
   subroutine enter_springs(b, i, state)
      type(chain_block), intent(inout) :: b
      integer, intent(in) :: i
      type(state_type), intent(in) :: state
      integer :: j

      associate (springs => state%springs)
         do j = 1, 2*b%n
            b%work(i, j) = springs%work(j)
            b%d0(i, j) = springs%d0(j)
            b%f0(i, j) = springs%f0(j)
            b%k(i, j) = springs%k(j)
            b%first(i, j) = springs%first(j)
            b%last(i, j) = springs%last(j)
            b%way(i, j) = real(springs%unload_on_reversal(j), wp)
         end do
         if (.not. b%damped) return
         do j = 1, 2*b%n
            if (state%motion%column%tangent_damping) then
               b%summed(i, j) = max(springs%k(j), 0.0_wp)
               b%damping(i, j) = state%motion%column%stiffness_damping*b%summed(i, j)
            else
               b%summed(i, j) = state%motion%joint_damping(j)
               b%damping(i, j) = b%summed(i, j)
            end if
         end do
      end associate
   end subroutine enter_springs

   !> Motion of the joints.
   subroutine enter_state(b, i, state)
      type(chain_block), intent(inout) :: b
      integer, intent(in) :: i
      type(state_type), intent(in) :: state

      b%q(i, :) = state%q
      b%v(i, :) = state%v
      b%of_damping(i) = state%of_damping
   end subroutine enter_state

   !> The bounds of what is watched for, and the deformations that were seen last.
   subroutine enter_bounds(b, i, state)
      type(chain_block), intent(inout) :: b
      integer, intent(in) :: i
      type(state_type), intent(in) :: state

      b%lowest(i, :) = state%sight%lowest
      b%highest(i, :) = state%sight%highest
      b%from(i, :) = state%sight%q
   end subroutine enter_bounds

   !> What an implicit method starts the next step from, and the factor of its tangent.
   subroutine enter_tangent(b, i, state, h, stepper, ready)
      type(chain_block), intent(inout) :: b
      integer, intent(in) :: i
      type(state_type), intent(in) :: state
      real(wp), intent(in) :: h
      type(implicit_stepper), intent(inout) :: stepper
      !> 1, or 0 where the tangent is not positive definite, so that lanes cannot solve with it
      real(wp), intent(out) :: ready

      call stepper%tangent%fit(stepper%step, state, h)
      ready = merge(1.0_wp, 0.0_wp, stepper%tangent%matrix%positive)
      b%tangent(i, :, :) = stepper%tangent%matrix%triangle
      b%v0(i, :) = stepper%step%v0
      b%a0(i, :) = stepper%step%a0
      b%g0(i, :) = stepper%step%g0
      b%largest(i, :) = stepper%step%largest(:2)
   end subroutine enter_tangent

   !> Works of the springs, and rear ends of one-way lines; their lines have not changed.
   subroutine take_springs(b, i, state, d)
      type(chain_block), intent(in) :: b
      integer, intent(in) :: i
      type(state_type), intent(inout) :: state
      !> Deformations (few, unknowns) that the works belong to
      real(wp), intent(in) :: d(:, :)
      integer :: j

      do j = 1, 2*b%n
         state%springs%d(j) = d(i, j)
         state%springs%work(j) = b%work(i, j)
         state%springs%first(j) = b%first(i, j)
         state%springs%last(j) = b%last(i, j)
      end do
   end subroutine take_springs

   subroutine take_state(b, i, state)
      type(chain_block), intent(in) :: b
      integer, intent(in) :: i
      type(state_type), intent(inout) :: state

      state%q(:) = b%q(i, :)
      state%v(:) = b%v(i, :)
      state%of_damping = b%of_damping(i)
   end subroutine take_state

   subroutine take_tangent(b, i, stepper)
      type(chain_block), intent(in) :: b
      integer, intent(in) :: i
      type(implicit_stepper), intent(inout) :: stepper

      ! Before its first step the method has none.
      if (.not. allocated(stepper%step%v0)) return
      stepper%step%v0(:) = b%v0(i, :)
      stepper%step%a0(:) = b%a0(i, :)
      stepper%step%g0(:) = b%g0(i, :)
      stepper%step%largest(:2) = b%largest(i, :)
   end subroutine take_tangent

end module rbs_solve_ensemble_chain_lane
