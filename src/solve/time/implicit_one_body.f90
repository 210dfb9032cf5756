!> Implicit steps of one body: the tangent of two by two is inverted once for all steps on the same lines, and
!> a step on which springs leave their lines needs no loop over bodies. The same equations as in
!> `rbs_solve_time_implicit_balance`; where a step is not found here, nothing has happened and it is taken
!> there.
module rbs_solve_time_implicit_one_body
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_journal, only: rule_slot
   use rbs_solve_time_bent_step, only: bent_step
   use rbs_solve_time_implicit_balance, only: step_balance
   use rbs_loading_loads, only: lateral, horizontal
   use rbs_solve_time_state, only: state_type, out_of_bounds
   implicit none
   private

   public :: one_body_step

   type :: one_body_step
      !> Column, method and step, the inverse of the tangent, and steps on which springs leave their lines
      type(bent_step) :: bent
      !> Room for copies of the rules
      type(rule_slot) :: kept(2)
      !> Lines that the inverse belongs to
      integer, private :: version = -1
   contains
      procedure :: take_step
      procedure :: fit
   end type one_body_step

contains

   !> Take a step of h: on the present lines of both springs, or along the lines that follow. If it is not
   !> found so, nothing has happened.
   subroutine take_step(self, step, state, h, load, wanted, taken)
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
      real(wp) :: v1_1, v1_2, a1_1, a1_2, g1_1, g1_2, start_1, start_2, rest_1, rest_2, scale_1, scale_2

      taken = .false.
      call self%fit(step, state, h)
      push = load(lateral)
      ground = load(horizontal)
      associate (bent => self%bent, springs => state%springs)
         alpha_m = bent%alpha_m
         alpha_f = bent%alpha_f
         beta = bent%beta
         gamma = bent%gamma
         per_h = bent%per_h
         mass_1 = bent%mass(1)
         mass_2 = bent%mass(2)
         lower = bent%lower
         upper = bent%upper
         softening = bent%softening
         inverse_11 = bent%inverse(1)
         inverse_12 = bent%inverse(2)
         inverse_21 = bent%inverse(3)
         inverse_22 = bent%inverse(4)
         d0_1 = springs%d0(1)
         f0_1 = springs%f0(1)
         k_1 = springs%k(1)
         d0_2 = springs%d0(2)
         f0_2 = springs%f0(2)
         k_2 = springs%k(2)
      end associate
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
      ! The lanes of ensembles take the lines up to the next mark from here.
      !---
      before_1 = h*v0_1 + (h**2*(0.5_wp - beta))*a0_1
      before_2 = h*v0_2 + (h**2*(0.5_wp - beta))*a0_2
      shear = f0_1 + k_1*(q_1 - d0_1)
      moment = f0_2 + k_2*(q_2 - d0_2)
      g1_1 = (push - shear) - mass_1*ground
      g1_2 = ((lower*shear + upper*push) - moment) + softening*q_2
      start_1 = (1.0_wp - alpha_f)*g1_1 + alpha_f*g0_1 &
                - mass_1*((alpha_m - 1.0_wp)*per_h*before_1 + alpha_m*a0_1)
      start_2 = (1.0_wp - alpha_f)*g1_2 + alpha_f*g0_2 &
                - mass_2*((alpha_m - 1.0_wp)*per_h*before_2 + alpha_m*a0_2)
      moved_1 = inverse_11*start_1 + inverse_12*start_2
      moved_2 = inverse_21*start_1 + inverse_22*start_2
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
      associate (springs => state%springs, bent => self%bent)
         ! Written so that a number that is not one leaves too.
         if (.not. (abs(to_1) < out_of_bounds .and. abs(to_2) < out_of_bounds)) return
         taken = to_1 <= springs%last(1) .and. to_1 >= springs%first(1) .and. &
                 to_2 <= springs%last(2) .and. to_2 >= springs%first(2) .and. &
                 abs(rest_1) <= wanted*scale_1 .and. abs(rest_2) <= wanted*scale_2
         bent%moved(1) = moved_1
         bent%moved(2) = moved_2
         if (taken) then
            ! Both elements one by one: the compiler does not know that there are no more.
            bent%q(1) = to_1
            bent%q(2) = to_2
            bent%v1(1) = v1_1
            bent%v1(2) = v1_2
            bent%a1(1) = a1_1
            bent%a1(2) = a1_2
            bent%g(1) = g1_1
            bent%g(2) = g1_2
            bent%scale(1) = scale_1
            bent%scale(2) = scale_2
            call springs%carry_to(bent%q)
         else
            bent%work = start_1*moved_1 + start_2*moved_2
            call bend(self, step, state, load, wanted, taken)
            if (.not. taken) return
         end if
      end associate
      call end_step(self%bent, step, state, load)
   end subroutine take_step

   !> Find the end of the step along the lines that follow, and put the springs there.
   subroutine bend(self, step, state, load, wanted, taken)
      type(one_body_step), intent(inout) :: self
      type(step_balance), intent(in) :: step
      type(state_type), intent(inout) :: state
      real(wp), intent(in) :: load(4), wanted
      logical, intent(out) :: taken
      integer :: i

      associate (bent => self%bent, springs => state%springs)
         bent%wanted = wanted
         bent%push = load(lateral)
         bent%ground = load(horizontal)
         do i = 1, 2
            bent%q0(i) = state%q(i)
            bent%v0(i) = step%v0(i)
            bent%a0(i) = step%a0(i)
            bent%g0(i) = step%g0(i)
            bent%largest(i) = step%largest(i)
            bent%spring(i)%line = springs%line_of(i)
            bent%spring(i)%first = springs%first(i)
            bent%spring(i)%last = springs%last(i)
            bent%spring(i)%d = springs%d(i)
            bent%spring(i)%work = springs%work(i)
         end do
         bent%hears = springs%heard(1) > 0
         call bent%solve(springs%slot, self%kept, taken)
         if (.not. taken) return
         do i = 1, 2
            call springs%put(i, bent%spring(i)%line, bent%spring(i)%d, bent%spring(i)%work)
         end do
         springs%events = springs%events + bent%events
         self%version = springs%version
      end associate
   end subroutine bend

   !> Find the inverse of the tangent on the present lines, where that is not the one that is there.
   pure subroutine fit(self, step, state, h)
      class(one_body_step), intent(inout) :: self
      type(step_balance), intent(in) :: step
      type(state_type), intent(in) :: state
      real(wp), intent(in) :: h

      if (abs(h - self%bent%h) > 0.0_wp) then
         call set_step(self%bent, step, state, h)
      else if (self%version == state%springs%version) then
         return
      end if
      self%bent%spring(1)%line%k = state%springs%k(1)
      self%bent%spring(2)%line%k = state%springs%k(2)
      call self%bent%fit()
      self%version = state%springs%version
   end subroutine fit

   !> Column, method and length of the step.
   pure subroutine set_step(bent, step, state, h)
      type(bent_step), intent(inout) :: bent
      type(step_balance), intent(in) :: step
      type(state_type), intent(in) :: state
      real(wp), intent(in) :: h

      bent%alpha_m = step%alpha_m
      bent%alpha_f = step%alpha_f
      bent%beta = step%beta
      bent%gamma = step%gamma
      bent%mass(1) = state%motion%column%inertias(1)
      bent%mass(2) = state%motion%column%inertias(2)
      associate (column => state%motion%column)
         bent%lower = column%lower(1)
         bent%upper = column%upper(1)
         bent%softening = 0.0_wp
         if (state%motion%second_order) bent%softening = column%axial_body(1)*column%length(1)
      end associate
      call bent%set_step(h)
   end subroutine set_step

   !> The end of the step, to which the springs have moved, becomes the state.
   subroutine end_step(bent, step, state, load)
      type(bent_step), intent(in) :: bent
      type(step_balance), intent(inout) :: step
      type(state_type), intent(inout) :: state
      real(wp), intent(in) :: load(4)

      associate (motion => state%motion, moved => bent%moved)
         if (motion%acts(lateral)) then
            state%of_loads = state%of_loads + 0.5_wp*(state%load(lateral) + load(lateral)) &
                             *(moved(1) + motion%column%upper(1)*moved(2))
         end if
         if (motion%acts(horizontal)) then
            state%of_loads = state%of_loads - 0.5_wp*(state%load(horizontal) + load(horizontal)) &
                             *state%motion%column%mass(1)*moved(1)
         end if
         state%v(1) = bent%v1(1) - motion%column%lower(1)*bent%v1(2)
      end associate
      state%v(2) = bent%v1(2)
      state%q(1) = bent%q(1)
      state%q(2) = bent%q(2)
      state%time = state%time + bent%h
      state%load = load
      step%largest(1) = bent%scale(1)
      step%largest(2) = bent%scale(2)
      step%v0(1) = bent%v1(1)
      step%v0(2) = bent%v1(2)
      step%a0(1) = bent%a1(1)
      step%a0(2) = bent%a1(2)
      step%g0(1) = bent%g(1)
      step%g0(2) = bent%g(2)
   end subroutine end_step

end module rbs_solve_time_implicit_one_body
