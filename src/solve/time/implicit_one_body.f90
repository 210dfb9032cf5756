!> Implicit steps of one body: the tangent of two by two is inverted once for all steps on the same lines, and
!> a step on which springs leave their lines needs no loop over bodies. The same equations as in
!> `rbs_solve_time_implicit_balance`; where a step is not found here, nothing has happened and it is taken
!> there.
module rbs_solve_time_implicit_one_body
   use rbs_base_kinds, only: wp
   use rbs_solve_time_implicit_balance, only: step_balance
   use rbs_solve_time_loads, only: lateral, horizontal
   use rbs_solve_time_state, only: state_type, out_of_bounds
   implicit none
   private

   public :: one_body_step

   !> Most trials of Newton's method, which mostly needs two.
   integer, parameter :: most_trials = 8

   !> Most lines within one step here.
   integer, parameter :: most_lines = 100

   type :: one_body_step
      !> Inverse of the tangent, and what it belongs to; 1/(beta h^2)
      real(wp) :: inverse(2, 2) = 0.0_wp, per_h = 0.0_wp
      real(wp), private :: h = -1.0_wp
      integer, private :: version = -1
   contains
      procedure :: try_linear_step
      procedure :: try_step
      procedure :: fit
   end type one_body_step

contains

   !> Take a step of h if both springs stay on their lines.
   subroutine try_linear_step(self, step, state, h, load, wanted, taken)
      class(one_body_step), intent(inout) :: self
      type(step_balance), intent(inout) :: step
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
      if (self%version /= state%springs%version .or. abs(h - self%h) > 0.0_wp) call self%fit(step, state, h)
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
      end associate
      taken = .true.
      state%q(1) = to_1
      state%q(2) = to_2
      call state%springs%carry_to(state%q)
      call end_step(step, state, h, load, [moved_1, moved_2], [to_1, to_2], [v1_1, v1_2], [a1_1, a1_2], &
                    [g1_1, g1_2], [scale_1, scale_2])
   end subroutine try_linear_step

   !> Find the inverse of the tangent on the present lines, where that is not the one that is there.
   pure subroutine fit(self, step, state, h)
      class(one_body_step), intent(inout) :: self
      type(step_balance), intent(in) :: step
      type(state_type), intent(in) :: state
      real(wp), intent(in) :: h
      real(wp) :: of_mass, shear, along, across, about, share

      if (self%version == state%springs%version .and. .not. abs(h - self%h) > 0.0_wp) return
      of_mass = (1.0_wp - step%alpha_m)/(step%beta*h**2)
      associate (column => state%motion%column, k => state%springs%k)
         shear = (1.0_wp - step%alpha_f)*k(1)
         along = shear + of_mass*step%mass(1)
         across = -shear*column%lower(1)
         about = shear*column%lower(1)**2 + (1.0_wp - step%alpha_f)*k(2) + of_mass*step%mass(2)
         if (state%motion%second_order) then
            about = about - (1.0_wp - step%alpha_f)*column%axial_body(1)*column%length(1)
         end if
      end associate
      ! Where the column softens more than its inertia holds, the pivot is negative. One that is nearly zero
      ! gives a step that does not converge.
      share = across/along
      about = 1.0_wp/(about - share*across)
      self%inverse(1, 1) = 1.0_wp/along + share*about*share
      self%inverse(1, 2) = -share*about
      self%inverse(2, 1) = -share*about
      self%inverse(2, 2) = about
      self%h = h
      self%per_h = 1.0_wp/(step%beta*h**2)
      self%version = state%springs%version
   end subroutine fit

   !> Take a step of h on which springs leave their lines, by Newton's method with whole corrections. As in
   !> `rbs_solve_time_implicit` every trial goes from the start of the step, each spring in one direction. If
   !> it overshoots too far, or does not converge at once, nothing has happened and the step is taken there.
   subroutine try_step(self, step, state, h, load, wanted, taken)
      class(one_body_step), intent(inout) :: self
      type(step_balance), intent(inout) :: step
      type(state_type), intent(inout) :: state
      real(wp), intent(in) :: h, load(4)
      !> Share of the forces that the residual may have
      real(wp), intent(in) :: wanted
      logical, intent(out) :: taken
      real(wp) :: before(2), moved(2), dx(2), q(2), r(2), a1(2), v1(2), g(2), scale(2)
      real(wp) :: lower, left, work
      integer :: trial, way(2)
      logical :: changed

      taken = .false.
      changed = .false.
      way = 0
      lower = state%motion%column%lower(1)
      before(1) = h*step%v0(1) + (h**2*(0.5_wp - step%beta))*step%a0(1)
      before(2) = h*step%v0(2) + (h**2*(0.5_wp - step%beta))*step%a0(2)
      moved = 0.0_wp
      call state%springs%mark()
      call find_residual(self, step, state, h, load, before, moved, state%q, r, a1, v1, g, scale)
      do trial = 1, most_trials
         call self%fit(step, state, h)
         dx(1) = self%inverse(1, 1)*r(1) + self%inverse(1, 2)*r(2)
         dx(2) = self%inverse(2, 1)*r(1) + self%inverse(2, 2)*r(2)
         work = r(1)*dx(1) + r(2)*dx(2)
         moved = moved + dx
         q(1) = state%q(1) + (moved(1) - lower*moved(2))
         q(2) = state%q(2) + moved(2)
         if (.not. (abs(q(1)) < out_of_bounds .and. abs(q(2)) < out_of_bounds)) exit
         if (.not. are_on_lines(q, way, state%springs%d, state%springs%first, state%springs%last)) then
            if (changed) call state%springs%restore()
            changed = .true.
            call find_lines(state, q, way)
            if (state%springs%stuck) exit
         end if
         call find_residual(self, step, state, h, load, before, moved, q, r, a1, v1, g, scale)
         taken = abs(r(1)) <= wanted*scale(1) .and. abs(r(2)) <= wanted*scale(2)
         if (taken) exit
         left = r(1)*dx(1) + r(2)*dx(2)
         ! Written so that a number that is not one leaves too.
         if (.not. left >= -0.9_wp*work) exit
      end do
      if (taken) then
         state%q(1) = q(1)
         state%q(2) = q(2)
         call state%springs%carry_to(state%q)
         call end_step(step, state, h, load, moved, q, v1, a1, g, scale)
      else
         call state%springs%restore()
      end if
      call state%springs%forget_mark()
   end subroutine try_step

   !> Whether springs that go to q are on the present lines there: those that have come to them by the end of
   !> another are beyond that end.
   pure logical function are_on_lines(q, way, d, first, last)
      real(wp), intent(in) :: q(2), d(2), first(2), last(2)
      !> How each spring has come to its line: +1 or -1 by the end of another, at d; 0 it was on it before
      integer, intent(in) :: way(2)

      are_on_lines = q(1) <= last(1) .and. q(1) >= first(1) .and. way(1)*(q(1) - d(1)) >= 0.0_wp .and. &
                     q(2) <= last(2) .and. q(2) >= first(2) .and. way(2)*(q(2) - d(2)) >= 0.0_wp
   end function are_on_lines

   !> Put the springs, which are at the start of the step, on the lines that they are on at q. They stay where
   !> these lines begin.
   subroutine find_lines(state, q, way)
      type(state_type), intent(inout) :: state
      real(wp), intent(in) :: q(2)
      !> See `are_on_lines`
      integer, intent(out) :: way(2)
      integer :: i, lines

      way = 0
      do i = 1, 2
         do lines = 1, most_lines
            if (q(i) > state%springs%last(i)) then
               way(i) = 1
            else if (q(i) < state%springs%first(i)) then
               way(i) = -1
            else
               exit
            end if
            call state%springs%leave(i, way(i))
         end do
         state%springs%stuck = state%springs%stuck .or. lines > most_lines
      end do
   end subroutine find_lines

   !> What is left of the balance where the body has moved so far.
   pure subroutine find_residual(self, step, state, h, load, before, moved, q, r, a1, v1, g, scale)
      type(one_body_step), intent(in) :: self
      type(step_balance), intent(in) :: step
      type(state_type), intent(in) :: state
      real(wp), intent(in) :: h, load(4), before(2), moved(2), q(2)
      !> Residual, acceleration, velocity and forces of the body, and what the residual is measured by
      real(wp), intent(out) :: r(2), a1(2), v1(2), g(2), scale(2)
      real(wp) :: shear, moment

      a1 = (moved - before)*self%per_h
      v1 = step%v0(:2) + (h*(1.0_wp - step%gamma))*step%a0(:2) + (h*step%gamma)*a1
      associate (column => state%motion%column, springs => state%springs)
         shear = springs%f0(1) + springs%k(1)*(q(1) - springs%d0(1))
         moment = springs%f0(2) + springs%k(2)*(q(2) - springs%d0(2))
         g(1) = (load(lateral) - shear) - column%mass(1)*load(horizontal)
         g(2) = (column%lower(1)*shear + column%upper(1)*load(lateral)) - moment
         if (state%motion%second_order) g(2) = g(2) + column%axial_body(1)*column%length(1)*q(2)
         r = (1.0_wp - step%alpha_f)*g + step%alpha_f*step%g0(:2) &
             - step%mass(:2)*((1.0_wp - step%alpha_m)*a1 + step%alpha_m*step%a0(:2))
         scale(1) = max(step%largest(1), abs(shear), abs(load(lateral)), abs(step%mass(1)*a1(1)))
         scale(2) = max(step%largest(2), abs(moment), abs(load(lateral))*column%upper(1), &
                        abs(step%mass(2)*a1(2)))
      end associate
   end subroutine find_residual

   !> The end of the step, to which the springs have moved, becomes the state.
   subroutine end_step(step, state, h, load, moved, q, v1, a1, g, scale)
      type(step_balance), intent(inout) :: step
      type(state_type), intent(inout) :: state
      real(wp), intent(in) :: h, load(4), moved(2), q(2), v1(2), a1(2), g(2), scale(2)

      associate (motion => state%motion)
         if (motion%acts(lateral)) then
            state%of_loads = state%of_loads + 0.5_wp*(state%load(lateral) + load(lateral)) &
                             *(moved(1) + motion%column%upper(1)*moved(2))
         end if
         if (motion%acts(horizontal)) then
            state%of_loads = state%of_loads - 0.5_wp*(state%load(horizontal) + load(horizontal)) &
                             *step%mass(1)*moved(1)
         end if
         state%v(1) = v1(1) - motion%column%lower(1)*v1(2)
      end associate
      state%v(2) = v1(2)
      state%q(1) = q(1)
      state%q(2) = q(2)
      state%time = state%time + h
      state%load = load
      ! Both elements one by one: the compiler does not know that there are no more.
      step%largest(1) = scale(1)
      step%largest(2) = scale(2)
      step%v0(1) = v1(1)
      step%v0(2) = v1(2)
      step%a0(1) = a1(1)
      step%a0(2) = a1(2)
      step%g0(1) = g(1)
      step%g0(2) = g(2)
   end subroutine end_step

end module rbs_solve_time_implicit_one_body
