!> An implicit step of one body whose springs stay on their lines: the step is linear then, and the tangent of
!> two by two has been inverted once for all steps on the same lines. The same equations as in
!> `rbs_solve_time_implicit_balance`, without a loop; where a spring leaves its line, or the residual has not
!> vanished, nothing has happened and the step is taken there.
module rbs_solve_time_implicit_one_body
   use rbs_base_kinds, only: wp
   use rbs_solve_time_implicit_balance, only: step_balance
   use rbs_solve_time_implicit_tangent, only: step_tangent
   use rbs_solve_time_loads, only: lateral, horizontal
   use rbs_solve_time_state, only: state_type, out_of_bounds
   implicit none
   private

   public :: one_body_step

   type :: one_body_step
      !> Inverse of the tangent, and what it belongs to; 1/(beta h^2)
      real(wp) :: inverse(2, 2) = 0.0_wp, per_h = 0.0_wp
      real(wp), private :: h = -1.0_wp
      integer, private :: version = -1
   contains
      procedure :: try_linear_step
      procedure :: fit
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
      real(wp) :: alpha_m, alpha_f, beta, gamma, per_h, mass_1, mass_2, lower, upper, softening
      real(wp) :: d0_1, f0_1, k_1, d0_2, f0_2, k_2, inverse_11, inverse_12, inverse_21, inverse_22
      real(wp) :: q_1, q_2, v0_1, v0_2, a0_1, a0_2, g0_1, g0_2, largest_1, largest_2, push, ground
      real(wp) :: before_1, before_2, shear, moment, moved_1, moved_2, to_1, to_2
      real(wp) :: v1_1, v1_2, a1_1, a1_2, g1_1, g1_2, rest_1, rest_2, scale_1, scale_2

      taken = .false.
      if (self%version /= state%springs%version .or. abs(h - self%h) > 0.0_wp) then
         call self%fit(step, tangent, state, h)
      end if
      alpha_m = step%alpha_m
      alpha_f = step%alpha_f
      beta = step%beta
      gamma = step%gamma
      per_h = self%per_h
      mass_1 = step%mass(1)
      mass_2 = step%mass(2)
      push = load(lateral)
      ground = load(horizontal)
      inverse_11 = self%inverse(1, 1)
      inverse_12 = self%inverse(1, 2)
      inverse_21 = self%inverse(2, 1)
      inverse_22 = self%inverse(2, 2)
      q_1 = state%q(1)
      q_2 = state%q(2)
      v0_1 = step%v0(1)
      v0_2 = step%v0(2)
      a0_1 = step%a0(1)
      a0_2 = step%a0(2)
      g0_1 = step%g0(1)
      g0_2 = step%g0(2)
      largest_1 = step%largest(1)
      largest_2 = step%largest(2)
      associate (motion => state%motion, springs => state%springs)
         lower = motion%column%lower(1)
         upper = motion%column%upper(1)
         softening = 0.0_wp
         if (motion%second_order) softening = motion%column%axial_body(1)*motion%column%length(1)
         d0_1 = springs%d0(1)
         f0_1 = springs%f0(1)
         k_1 = springs%k(1)
         d0_2 = springs%d0(2)
         f0_2 = springs%f0(2)
         k_2 = springs%k(2)
         ! The lanes of ensembles take the lines up to the next mark from here.
         !---
         before_1 = h*v0_1 + (h**2*(0.5_wp - beta))*a0_1
         before_2 = h*v0_2 + (h**2*(0.5_wp - beta))*a0_2
         shear = f0_1 + k_1*(q_1 - d0_1)
         moment = f0_2 + k_2*(q_2 - d0_2)
         g1_1 = (push - shear) - mass_1*ground
         g1_2 = ((lower*shear + upper*push) - moment) + softening*q_2
         rest_1 = (1.0_wp - alpha_f)*g1_1 + alpha_f*g0_1 &
                  - mass_1*((alpha_m - 1.0_wp)*per_h*before_1 + alpha_m*a0_1)
         rest_2 = (1.0_wp - alpha_f)*g1_2 + alpha_f*g0_2 &
                  - mass_2*((alpha_m - 1.0_wp)*per_h*before_2 + alpha_m*a0_2)
         moved_1 = inverse_11*rest_1 + inverse_12*rest_2
         moved_2 = inverse_21*rest_1 + inverse_22*rest_2
         to_1 = q_1 + (moved_1 - lower*moved_2)
         to_2 = q_2 + moved_2
         a1_1 = (moved_1 - before_1)*per_h
         a1_2 = (moved_2 - before_2)*per_h
         v1_1 = v0_1 + (h*(1.0_wp - gamma))*a0_1 + (h*gamma)*a1_1
         v1_2 = v0_2 + (h*(1.0_wp - gamma))*a0_2 + (h*gamma)*a1_2
         shear = f0_1 + k_1*(to_1 - d0_1)
         moment = f0_2 + k_2*(to_2 - d0_2)
         g1_1 = (push - shear) - mass_1*ground
         g1_2 = ((lower*shear + upper*push) - moment) + softening*to_2
         rest_1 = (1.0_wp - alpha_f)*g1_1 + alpha_f*g0_1 - mass_1*((1.0_wp - alpha_m)*a1_1 + alpha_m*a0_1)
         rest_2 = (1.0_wp - alpha_f)*g1_2 + alpha_f*g0_2 - mass_2*((1.0_wp - alpha_m)*a1_2 + alpha_m*a0_2)
         scale_1 = max(largest_1, abs(shear), abs(push), abs(mass_1*a1_1))
         scale_2 = max(largest_2, abs(moment), abs(push)*upper, abs(mass_2*a1_2))
         !---
         ! Written so that a number that is not one leaves too.
         if (.not. (to_1 <= springs%last(1) .and. to_1 >= springs%first(1) .and. &
                    to_2 <= springs%last(2) .and. to_2 >= springs%first(2))) return
         if (.not. (abs(rest_1) <= wanted*scale_1 .and. abs(rest_2) <= wanted*scale_2)) return
         if (.not. (abs(to_1) < out_of_bounds .and. abs(to_2) < out_of_bounds)) return
         taken = .true.
         if (motion%acts(lateral)) then
            state%of_loads = state%of_loads + 0.5_wp*(state%load(lateral) + push)*(moved_1 + upper*moved_2)
         end if
         if (motion%acts(horizontal)) then
            state%of_loads = state%of_loads - 0.5_wp*(state%load(horizontal) + ground)*mass_1*moved_1
         end if
      end associate
      ! Both elements one by one: the compiler does not know that there are no more.
      state%q(1) = to_1
      state%q(2) = to_2
      call state%springs%carry_to(state%q)
      state%v(1) = v1_1 - lower*v1_2
      state%v(2) = v1_2
      state%time = state%time + h
      state%load = load
      step%largest(1) = scale_1
      step%largest(2) = scale_2
      step%v0(1) = v1_1
      step%v0(2) = v1_2
      step%a0(1) = a1_1
      step%a0(2) = a1_2
      step%g0(1) = g1_1
      step%g0(2) = g1_2
   end subroutine try_linear_step

   !> Find the inverse of the tangent on the present lines, where that is not the one that is there.
   subroutine fit(self, step, tangent, state, h)
      class(one_body_step), intent(inout) :: self
      type(step_balance), intent(inout) :: step
      type(step_tangent), intent(inout) :: tangent
      type(state_type), intent(in) :: state
      real(wp), intent(in) :: h
      integer :: j

      if (self%version == state%springs%version .and. .not. abs(h - self%h) > 0.0_wp) return
      do j = 1, 2
         step%r(:) = 0.0_wp
         step%r(j) = 1.0_wp
         call tangent%find_correction(step, state, h, self%inverse(:, j))
      end do
      self%h = h
      self%per_h = 1.0_wp/(step%beta*h**2)
      self%version = state%springs%version
   end subroutine fit

end module rbs_solve_time_implicit_one_body
