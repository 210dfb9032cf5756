!> The equation of an implicit step in centroid coordinates, where the mass is diagonal: the state at its
!> begin, a trial of its end, and the residual that the trial leaves.
!>
!>     (1 - am) M a1 + am M a0 = (1 - af) G(q1, v1, t1) + af G(q0, v0, t0)
!>     x1 = x0 + h v0 + h^2 ((1/2 - b) a0 + b a1),   v1 = v0 + h ((1 - g) a0 + g a1)
!>
!> with G the forces on the bodies (J. Chung, G. M. Hulbert, J. Appl. Mech. 60 (1993)).
module rbs_solve_time_implicit_balance
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_column_band, only: to_joints
   use rbs_column_chain, only: body_velocities
   use rbs_loading_loads, only: lateral, horizontal, vertical
   use rbs_solve_time_motion, only: motion_result
   use rbs_solve_time_state, only: state_type
   implicit none
   private

   public :: step_balance

   !> What round-off leaves of the terms of a sum, as a share of the largest.
   real(wp), parameter :: round_off = 32.0_wp*epsilon(1.0_wp)

   type :: step_balance
      !> Parameters of the method; those of Newmark's average acceleration
      real(wp) :: alpha_m = 0.0_wp, alpha_f = 0.0_wp, beta = 0.25_wp, gamma = 0.5_wp
      !> Velocities, accelerations and forces of the bodies at the start of a step, and at its end
      !> (unknowns), in the order x_1, th_1, x_2, ... [, y_1, ...]
      real(wp), allocatable :: v0(:), a0(:), g0(:), v1(:), a1(:), g1(:)
      !> Mass, residual, and what the bodies have moved in the step, in that order (unknowns)
      real(wp), allocatable :: mass(:), r(:), moved(:)
      !> Deformations and velocities of the joints at the end of the step (unknowns)
      real(wp), allocatable :: q1(:), w1(:)
      !> Forces of the present trial
      type(motion_result) :: now
      !> Largest force, moment and lift of the present trial and of all steps so far. Residuals are measured
      !> by them: where a motion passes through zero, or springs and damping cancel each other, all forces of
      !> the moment are round-off.
      real(wp), private :: scale(3) = 0.0_wp
      real(wp) :: largest(3) = 0.0_wp
   contains
      procedure :: start
      procedure :: find_residual
      procedure :: is_round_off
      procedure :: go_on
      procedure :: serialize
   end type step_balance

contains

   !> Velocities and accelerations of the bodies at the start of the first step.
   subroutine start(self, state)
      class(step_balance), intent(inout) :: self
      type(state_type), intent(in) :: state
      integer :: m, n, i

      n = state%motion%column%n
      m = state%motion%column%unknowns
      allocate (self%v0(m), self%a0(m), self%g0(m), self%v1(m), self%a1(m), self%g1(m), self%mass(m), &
                self%r(m), self%moved(m), self%q1(m), self%w1(m), source=0.0_wp)
      do i = 1, n
         self%mass(2*i - 1) = state%motion%column%mass(i)
         self%mass(2*i) = state%motion%column%inertia(i)
         if (state%motion%column%opens) self%mass(2*n + i) = state%motion%column%mass(i)
      end do
      call self%now%create(state%motion%column)
      call body_velocities(state%motion%column, state%v, self%v0)
      if (state%motion%column%held) self%v0(2*n) = 0.0_wp
      call find_forces(state, self%mass, state%q, state%v, self%v0, state%load, self%now, self%g0)
      self%a0 = self%g0/self%mass
      call find_scale(n, m, self%mass, self%a0, self%g0, self%now%f, state%load(lateral), &
                      state%motion%column%upper(n), self%largest)
   end subroutine start

   !> The end of the step that was found is the start of the next one.
   subroutine go_on(self)
      class(step_balance), intent(inout) :: self

      self%largest = max(self%largest, self%scale)
      self%v0 = self%v1
      self%a0 = self%a1
      self%g0 = self%g1
   end subroutine go_on

   !> Save or restore what the bodies do at the start of a step.
   subroutine serialize(self, stream)
      class(step_balance), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%item(self%v0)
      call stream%item(self%a0)
      call stream%item(self%g0)
      call stream%item(self%largest)
   end subroutine serialize

   !> Residual of the step for what the bodies have moved, and its size relative to the forces.
   subroutine find_residual(self, state, h, load, relative)
      class(step_balance), intent(inout) :: self
      type(state_type), intent(in) :: state
      real(wp), intent(in) :: h, load(4)
      real(wp), intent(out) :: relative
      integer :: m, n

      m = size(self%r)
      n = state%motion%column%n
      call end_of_step(m, h, self%beta, self%gamma, self%moved, self%v0, self%a0, self%v1, self%a1)
      if (state%motion%damped) call to_joints(state%motion%column, self%v1, self%w1)
      call find_forces(state, self%mass, self%q1, self%w1, self%v1, load, self%now, self%g1)
      call balance(m, self%alpha_m, self%alpha_f, self%mass, self%a0, self%a1, self%g0, self%g1, self%r)
      call find_scale(n, m, self%mass, self%a1, self%g1, self%now%f, load(lateral), &
                      state%motion%column%upper(n), self%scale)
      relative = size_of(n, m, self%r, max(self%scale, self%largest))
   end subroutine find_residual

   !> Forces on the bodies, inertia of the ground and damping included.
   subroutine find_forces(state, mass, q, w, v, load, now, g)
      type(state_type), intent(in) :: state
      !> Mass, deformations and velocities of the joints, velocities of the bodies (unknowns)
      real(wp), intent(in), contiguous :: mass(:), q(:), w(:), v(:)
      real(wp), intent(in) :: load(4)
      type(motion_result), intent(inout) :: now
      real(wp), intent(out), contiguous :: g(:)
      integer :: i, n

      n = state%motion%column%n
      associate (motion => state%motion)
         call motion%forces_on_bodies(state%springs, q, w, load, now)
         do i = 1, n
            g(2*i - 1) = now%force(i) - motion%column%mass(i)*load(horizontal)
            g(2*i) = now%torque(i)
         end do
         ! What holds the top takes its moment.
         if (motion%column%held) g(2*n) = 0.0_wp
         if (motion%column%opens) g(2*n + 1:) = now%lift - motion%column%mass*load(vertical)
         if (motion%column%mass_damping > 0.0_wp) g = g - motion%column%mass_damping*mass*v
      end associate
   end subroutine find_forces

   pure subroutine end_of_step(m, h, beta, gamma, moved, v0, a0, v1, a1)
      integer, intent(in) :: m
      real(wp), intent(in) :: h, beta, gamma, moved(m), v0(m), a0(m)
      real(wp), intent(out) :: v1(m), a1(m)

      a1 = (moved - h*v0 - (h**2*(0.5_wp - beta))*a0)*(1.0_wp/(beta*h**2))
      v1 = v0 + (h*(1.0_wp - gamma))*a0 + (h*gamma)*a1
   end subroutine end_of_step

   pure subroutine balance(m, alpha_m, alpha_f, mass, a0, a1, g0, g1, r)
      integer, intent(in) :: m
      real(wp), intent(in) :: alpha_m, alpha_f, mass(m), a0(m), a1(m), g0(m), g1(m)
      real(wp), intent(out) :: r(m)

      r = (1.0_wp - alpha_f)*g1 + alpha_f*g0 - mass*((1.0_wp - alpha_m)*a1 + alpha_m*a0)
   end subroutine balance

   !> Largest force, moment and lift at a state.
   pure subroutine find_scale(n, m, mass, a, g, f, lateral_force, arm, scale)
      integer, intent(in) :: n, m
      real(wp), intent(in) :: mass(m), a(m), g(m), f(m), lateral_force, arm
      real(wp), intent(out) :: scale(3)
      integer :: i

      scale = [abs(lateral_force), abs(lateral_force)*arm, 0.0_wp]
      do i = 1, n
         scale(1) = max(scale(1), abs(f(i)), abs(mass(2*i - 1)*a(2*i - 1)))
         scale(2) = max(scale(2), abs(f(n + i)), abs(mass(2*i)*a(2*i)))
      end do
      if (m > 2*n) scale(3) = max(maxval(abs(f(2*n + 1:))), maxval(abs(g(2*n + 1:))))
   end subroutine find_scale

   !> Largest residual over the largest force, at the most 1: forces, moments and lifts each by themselves.
   pure real(wp) function size_of(n, m, r, scale) result(relative)
      integer, intent(in) :: n, m
      real(wp), intent(in) :: r(m), scale(3)
      real(wp) :: rest(3)
      integer :: i

      rest = 0.0_wp
      do i = 1, n
         rest(1) = max(rest(1), abs(r(2*i - 1)))
         rest(2) = max(rest(2), abs(r(2*i)))
      end do
      if (m > 2*n) rest(3) = maxval(abs(r(2*n + 1:)))
      relative = maxval(rest/max(scale, rest, tiny(1.0_wp)))
   end function size_of

   !> Whether the residual is what round-off leaves of the terms of the step.
   pure logical function is_round_off(self, h, stiffness)
      class(step_balance), intent(in) :: self
      real(wp), intent(in) :: h
      !> Diagonal of the tangent (unknowns)
      real(wp), intent(in) :: stiffness(:)
      integer :: n

      n = size(self%now%force)
      is_round_off = bodies_are_round_off(n, h, stiffness, self%r, self%moved, self%v0, self%a0)
      if (size(self%r) > 2*n .and. is_round_off) then
         is_round_off = lifts_are_round_off(n, h, stiffness(2*n + 1:), self%r(2*n + 1:), &
                                            self%moved(2*n + 1:), self%v0(2*n + 1:), self%a0(2*n + 1:))
      end if
   end function is_round_off

   !> Forces and moments. Modes that the step does not resolve have accelerations far beyond what comes of
   !> them: after a shock h^2 a0 is many turns.
   pure logical function bodies_are_round_off(n, h, stiffness, r, moved, v0, a0)
      integer, intent(in) :: n
      real(wp), intent(in) :: h, stiffness(2*n), r(2*n), moved(2*n), v0(2*n), a0(2*n)
      real(wp) :: way, turn, along, about
      integer :: i

      way = 0.0_wp
      turn = 0.0_wp
      do i = 1, n
         way = max(way, abs(moved(2*i - 1)) + h*abs(v0(2*i - 1)) + h**2*abs(a0(2*i - 1)))
         turn = max(turn, abs(moved(2*i)) + h*abs(v0(2*i)) + h**2*abs(a0(2*i)))
      end do
      bodies_are_round_off = .true.
      do i = 1, n
         along = sqrt(max(stiffness(2*i - 1), 0.0_wp))
         about = sqrt(max(stiffness(2*i), 0.0_wp))
         bodies_are_round_off = bodies_are_round_off .and. &
                                abs(r(2*i - 1)) <= round_off*along*(along*way + about*turn) .and. &
                                abs(r(2*i)) <= round_off*about*(along*way + about*turn)
      end do
   end function bodies_are_round_off

   !> Lifts, where the joints open.
   pure logical function lifts_are_round_off(n, h, stiffness, r, moved, v0, a0)
      integer, intent(in) :: n
      real(wp), intent(in) :: h, stiffness(n), r(n), moved(n), v0(n), a0(n)
      real(wp) :: way

      way = maxval(abs(moved) + h*abs(v0) + h**2*abs(a0))
      lifts_are_round_off = all(abs(r) <= round_off*stiffness*way)
   end function lifts_are_round_off

end module rbs_solve_time_implicit_balance
