!> An implicit step of one body whose springs stay on their lines: the step is linear then, and the tangent of
!> two by two has been inverted once for all steps on the same lines. The same equations as in
!> `rbs_solve_time_implicit_balance`, without a loop; where a spring leaves its line, or the residual has not
!> vanished, nothing has happened and the step is taken there.
module rbs_solve_time_implicit_one_body
   use rbs_base_kinds, only: wp
   use rbs_solve_time_implicit_balance, only: step_balance
   use rbs_solve_time_implicit_tangent, only: step_tangent
   use rbs_solve_time_loads, only: lateral, horizontal
   use rbs_solve_time_motion, only: motion_type
   use rbs_solve_time_state, only: state_type, in_bounds
   implicit none
   private

   public :: one_body_step

   type :: one_body_step
      !> Inverse of the tangent, and what it belongs to; 1/(beta h^2)
      real(wp), private :: inverse(2, 2) = 0.0_wp, h = -1.0_wp, per_h = 0.0_wp
      integer, private :: version = -1
   contains
      procedure :: try_linear_step
   end type one_body_step

contains

   !> Take a step of h if both springs stay on their lines.
   subroutine try_linear_step(self, step, tangent, state, h, load, wanted, taken)
      class(one_body_step), intent(inout) :: self
      type(step_balance), intent(inout) :: step
      type(step_tangent), intent(inout) :: tangent
      type(state_type), intent(inout) :: state
      real(wp), intent(in) :: h, load(4)
      !> Share of the forces that the residual may have
      real(wp), intent(in) :: wanted
      logical, intent(out) :: taken
      real(wp) :: g(2), r(2), moved(2), q(2), a1(2), v1(2), before(2), lower
      real(wp) :: scale(2), shear, moment

      taken = .false.
      if (self%version /= state%springs%version .or. abs(h - self%h) > 0.0_wp) then
         call find_inverse(self, step, tangent, state, h)
      end if
      associate (motion => state%motion, springs => state%springs)
         lower = motion%column%lower(1)
         before = h*step%v0 + (h**2*(0.5_wp - step%beta))*step%a0
         call forces_at(motion, springs%d0, springs%f0, springs%k, state%q, load, g, shear, moment)
         r = (1.0_wp - step%alpha_f)*g + step%alpha_f*step%g0 &
             - step%mass*((step%alpha_m - 1.0_wp)*self%per_h*before + step%alpha_m*step%a0)
         moved = self%inverse(:, 1)*r(1) + self%inverse(:, 2)*r(2)
         q = [state%q(1) + (moved(1) - lower*moved(2)), state%q(2) + moved(2)]
         ! Written so that a number that is not one leaves too.
         if (.not. (q(1) <= springs%last(1) .and. q(1) >= springs%first(1) .and. &
                    q(2) <= springs%last(2) .and. q(2) >= springs%first(2))) return
         a1 = (moved - before)*self%per_h
         v1 = step%v0 + (h*(1.0_wp - step%gamma))*step%a0 + (h*step%gamma)*a1
         call forces_at(motion, springs%d0, springs%f0, springs%k, q, load, g, shear, moment)
         r = (1.0_wp - step%alpha_f)*g + step%alpha_f*step%g0 &
             - step%mass*((1.0_wp - step%alpha_m)*a1 + step%alpha_m*step%a0)
         scale(1) = max(step%largest(1), abs(shear), abs(load(lateral)), abs(step%mass(1)*a1(1)))
         scale(2) = max(step%largest(2), abs(moment), abs(load(lateral))*motion%column%upper(1), &
                        abs(step%mass(2)*a1(2)))
         if (.not. (abs(r(1)) <= wanted*scale(1) .and. abs(r(2)) <= wanted*scale(2))) return
         if (.not. in_bounds(2, q)) return
         taken = .true.
         if (motion%acts(lateral)) then
            state%of_loads = state%of_loads + 0.5_wp*(state%load(lateral) + load(lateral)) &
                             *(moved(1) + motion%column%upper(1)*moved(2))
         end if
         if (motion%acts(horizontal)) then
            state%of_loads = state%of_loads - 0.5_wp*(state%load(horizontal) + load(horizontal)) &
                             *motion%column%mass(1)*moved(1)
         end if
      end associate
      call state%springs%carry_to(q)
      state%q(:) = q
      state%v(:) = [v1(1) - lower*v1(2), v1(2)]
      state%time = state%time + h
      state%load = load
      step%largest(:2) = scale
      step%v0(:) = v1
      step%a0(:) = a1
      step%g0(:) = g
   end subroutine try_linear_step

   !> Forces on the body, inertia of the ground included, and those of the joint.
   pure subroutine forces_at(motion, d0, f0, k, q, load, g, shear, moment)
      type(motion_type), intent(in) :: motion
      !> Lines of the springs, and deformations
      real(wp), intent(in) :: d0(2), f0(2), k(2), q(2)
      real(wp), intent(in) :: load(4)
      real(wp), intent(out) :: g(2), shear, moment

      shear = f0(1) + k(1)*(q(1) - d0(1))
      moment = f0(2) + k(2)*(q(2) - d0(2))
      associate (column => motion%column)
         g(1) = (load(lateral) - shear) - column%mass(1)*load(horizontal)
         g(2) = (column%lower(1)*shear + column%upper(1)*load(lateral)) - moment
         if (motion%second_order) g(2) = g(2) + column%axial_body(1)*column%length(1)*q(2)
      end associate
   end subroutine forces_at

   !> The inverse of the tangent on the present lines.
   subroutine find_inverse(self, step, tangent, state, h)
      type(one_body_step), intent(inout) :: self
      type(step_balance), intent(inout) :: step
      type(step_tangent), intent(inout) :: tangent
      type(state_type), intent(in) :: state
      real(wp), intent(in) :: h
      integer :: j

      do j = 1, 2
         step%r(:) = 0.0_wp
         step%r(j) = 1.0_wp
         call tangent%find_correction(step, state, h, self%inverse(:, j))
      end do
      self%h = h
      self%per_h = 1.0_wp/(step%beta*h**2)
      self%version = state%springs%version
   end subroutine find_inverse

end module rbs_solve_time_implicit_one_body
