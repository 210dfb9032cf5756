!> The equation of an implicit step in the unknowns of a structure, whose mass is diagonal: the state at its
!> begin, a trial of its end, and the residual that the trial leaves.
!>
!>     (1 - am) M a1 + am M a0 = (1 - af) G(q1, v1, t1) + af G(q0, v0, t0)
!>     x1 = x0 + h v0 + h^2 ((1/2 - b) a0 + b a1),   v1 = v0 + h ((1 - g) a0 + g a1)
!>
!> with G the forces on the unknowns (J. Chung, G. M. Hulbert, J. Appl. Mech. 60 (1993)).
module rbs_solve_time_implicit_balance
   use rbs_base_arrays, only: swap
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_solve_time_state, only: state_type
   use rbs_structure_structure, only: structure_type, motion_result, unknown_group, lateral, signals
   implicit none
   private

   public :: family_type, step_balance

   !> What round-off leaves of the terms of a sum, as a share of the largest.
   real(wp), parameter :: round_off = 32.0_wp*epsilon(1.0_wp)

   !> Parameters of the method; those of Newmark's average acceleration.
   type :: family_type
      real(wp) :: alpha_m = 0.0_wp, alpha_f = 0.0_wp, beta = 0.25_wp, gamma = 0.5_wp
   end type family_type

   type, extends(family_type) :: step_balance
      !> Velocities, accelerations and forces of the unknowns at the start of a step, and at its end
      !> (unknowns)
      real(wp), allocatable :: v0(:), a0(:), g0(:), v1(:), a1(:), g1(:)
      !> Residual, and what the unknowns have moved in the step (unknowns)
      real(wp), allocatable :: r(:), moved(:)
      !> Loads at the end of the step
      real(wp) :: load(signals) = 0.0_wp
      !> Deformations of the springs and their velocities at the end of the step (springs)
      real(wp), allocatable :: q1(:), w1(:)
      !> Forces of the present trial
      type(motion_result) :: now
      !> Largest force of each group of unknowns in the present trial and in all steps so far. Residuals are
      !> measured by them: where a motion passes through zero, or springs and damping cancel each other, all
      !> forces of the moment are round-off.
      real(wp), allocatable, private :: scale(:)
      real(wp), allocatable :: largest(:)
   contains
      procedure :: start
      procedure :: find_residual
      procedure :: is_round_off
      procedure :: go_on
      procedure :: serialize
   end type step_balance

contains

   !> Velocities and accelerations of the unknowns at the start of the first step.
   subroutine start(self, state)
      class(step_balance), intent(inout) :: self
      type(state_type), intent(in) :: state
      real(wp) :: relative
      integer :: m, springs, unstable

      associate (structure => state%motion%structure)
         m = structure%unknowns
         springs = size(structure%place)
         if (.not. allocated(self%v0)) then
            allocate (self%v0(m), self%a0(m), self%g0(m), self%v1(m), self%a1(m), self%g1(m), self%r(m), &
                      self%moved(m), self%q1(springs), self%w1(springs), source=0.0_wp)
            allocate (self%scale(size(structure%group)), self%largest(size(structure%group)), source=0.0_wp)
            call self%now%create(structure)
         end if
         call structure%unknown_rates(state%v, self%v0)
         call structure%linearise(state%springs%k, self%now%tangent, unstable)
         call find_forces(state, state%q, state%v, self%v0, state%load, self%now, self%g0)
         self%a0 = 0.0_wp
         where (structure%inertias > 0.0_wp) self%a0 = self%g0/structure%inertias
         call measure(structure, self%a0, self%now%f, self%r, state%load, self%scale, self%largest, relative)
      end associate
   end subroutine start

   !> The end of the step that was found is the start of the next one.
   subroutine go_on(self)
      class(step_balance), intent(inout) :: self

      self%largest(:) = max(self%largest, self%scale)
      call swap(self%v0, self%v1)
      call swap(self%a0, self%a1)
      call swap(self%g0, self%g1)
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

   !> Residual of the step for what the unknowns have moved, and its size relative to the forces.
   subroutine find_residual(self, state, h, load, relative)
      class(step_balance), intent(inout) :: self
      type(state_type), intent(in) :: state
      real(wp), intent(in) :: h, load(signals)
      real(wp), intent(out) :: relative
      integer :: m

      m = size(self%r)
      self%load = load
      associate (structure => state%motion%structure)
         call end_of_step(m, h, self%beta, self%gamma, self%moved, self%v0, self%a0, self%v1, self%a1)
         ! Where elements damp as wholes, the springs do not by themselves.
         if (state%motion%damped .and. structure%tangent_numbers == 0) then
            call structure%spring_rates(self%now%tangent, self%v1, self%w1)
         end if
         call find_forces(state, self%q1, self%w1, self%v1, load, self%now, self%g1)
         call balance(m, self%alpha_m, self%alpha_f, structure%inertias, self%a0, self%a1, self%g0, self%g1, &
                      self%r)
         call measure(structure, self%a1, self%now%f, self%r, load, self%largest, self%scale, relative)
         if (size(self%now%correction) > 0) then
            relative = max(relative, maxval(abs(structure%initial_stiffness*self%now%correction)) &
                           /max(maxval(self%scale), maxval(self%largest), tiny(1.0_wp)))
         end if
      end associate
   end subroutine find_residual

   !> Forces on the unknowns, inertia of the ground and damping included.
   subroutine find_forces(state, q, w, v, load, now, g)
      type(state_type), intent(in) :: state
      !> Deformations of the springs and their velocities (springs), velocities of the unknowns
      real(wp), intent(in), contiguous :: q(:), w(:), v(:)
      real(wp), intent(in) :: load(signals)
      type(motion_result), intent(inout) :: now
      real(wp), intent(out), contiguous :: g(:)

      associate (motion => state%motion, structure => state%motion%structure)
         call motion%forces_on_bodies(state%springs, q, w, load, now, g)
         call structure%add_ground(load, g)
         if (structure%damped .and. structure%tangent_numbers > 0) call structure%damp(v, now%tangent, g)
         if (structure%mass_damping > 0.0_wp) g = g - structure%mass_damping*structure%inertias*v
         ! Supports take what acts on them.
         if (structure%has_held) where (structure%is_held) g = 0.0_wp
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

      ! What has no mass is in equilibrium at the end of the step, whatever it was at the start.
      r = (1.0_wp - alpha_f)*g1 + alpha_f*merge(g0, 0.0_wp, mass > 0.0_wp) &
          - mass*((1.0_wp - alpha_m)*a1 + alpha_m*a0)
   end subroutine balance

   !> Largest force of each group at a state: of springs, of inertia and of the loads; and the largest
   !> residual over the largest force of its group, at the most 1.
   pure subroutine measure(structure, a, f, r, load, largest, scale, relative)
      class(structure_type), intent(in) :: structure
      !> Accelerations (unknowns), forces of springs (springs), residual (unknowns), loads
      real(wp), intent(in), contiguous :: a(:), f(:), r(:)
      real(wp), intent(in) :: load(signals)
      !> Largest forces so far, and at this state (groups)
      real(wp), intent(in), contiguous :: largest(:)
      real(wp), intent(out), contiguous :: scale(:)
      real(wp), intent(out) :: relative
      real(wp) :: rest
      integer :: j

      relative = 0.0_wp
      do j = 1, size(scale)
         call measure_group(structure%group(j), size(a), size(f), structure%inertias, a, f, r, &
                            abs(load(lateral)), scale(j), rest)
         relative = max(relative, rest/max(scale(j), largest(j), rest, tiny(1.0_wp)))
      end do
   end subroutine measure

   pure subroutine measure_group(group, unknowns, springs, inertias, a, f, r, load, scale, rest)
      type(unknown_group), intent(in) :: group
      integer, intent(in) :: unknowns, springs
      real(wp), intent(in) :: inertias(unknowns), a(unknowns), f(springs), r(unknowns), load
      real(wp), intent(out) :: scale, rest
      real(wp) :: most, left
      integer :: i, k

      most = load*group%lateral_arm
      left = 0.0_wp
      do i = group%first_spring, group%last_spring
         most = max(most, abs(f(i)))
      end do
      i = group%first
      do k = 1, group%count
         most = max(most, abs(inertias(i)*a(i)))
         left = max(left, abs(r(i)))
         i = i + group%step
      end do
      scale = most
      rest = left
   end subroutine measure_group

   !> Whether the residual is what round-off leaves of the terms of the step. Modes that the step does not
   !> resolve have accelerations far beyond what comes of them: after a shock h^2 a0 is many turns.
   pure logical function is_round_off(self, structure, h, stiffness)
      class(step_balance), intent(in) :: self
      class(structure_type), intent(in) :: structure
      real(wp), intent(in) :: h
      !> Diagonal of the tangent (unknowns)
      real(wp), intent(in), contiguous :: stiffness(:)
      real(wp) :: reach(maxval(structure%part)), way
      integer :: i, j, k

      ! An unknown is coupled with the others of its part: |k_ij| is at most the root of k_ii k_jj.
      reach = 0.0_wp
      do j = 1, size(structure%group)
         associate (group => structure%group(j))
            way = 0.0_wp
            do k = 0, group%count - 1
               i = group%first + k*group%step
               way = max(way, abs(self%moved(i)) + h*abs(self%v0(i)) + h**2*abs(self%a0(i)))
            end do
            do k = 0, group%count - 1
               i = group%first + k*group%step
               reach(structure%part(i)) = reach(structure%part(i)) + sqrt(max(stiffness(i), 0.0_wp))*way
            end do
         end associate
      end do
      is_round_off = all(abs(self%r) <= round_off*sqrt(max(stiffness, 0.0_wp))*reach(structure%part))
   end function is_round_off

end module rbs_solve_time_implicit_balance
