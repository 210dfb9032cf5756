!> The equation of an implicit step in the unknowns of a structure, whose mass is diagonal: the state at its
!> begin, a trial of its end, and the residual that the trial leaves.
!>
!>     (1 - am) M a1 + am M a0 = (1 - af) G(q1, v1, t1) + af G(q0, v0, t0)
!>     x1 = x0 + h v0 + h^2 ((1/2 - b) a0 + b a1),   v1 = v0 + h ((1 - g) a0 + g a1)
!>
!> with G the forces on the unknowns (J. Chung, G. M. Hulbert, J. Appl. Mech. 60 (1993)).
!>
!> The tangent of an implicit step: mass, damping and stiffness on the present lines of the springs, as a band
!> in the unknowns of the structure, and its factor.
module rbs_solve_time_implicit_balance
   use rbs_base_arrays, only: swap
   use rbs_base_band_matrix, only: band_matrix
   use rbs_base_inner_product, only: inner_product
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_base_tolerances, only: no_stiffness, round_off_of_sums
   use rbs_solve_time_state, only: state_type
   use rbs_structure_condensation, only: series_tangent
   use rbs_structure_spring_location, only: flexure
   use rbs_structure_structure, only: structure_type, motion_result, unknown_group, lateral, signals
   implicit none
   private

   public :: family_type, step_balance, step_tangent

   !> Parameters of the method; those of Newmark's average acceleration.
   type :: family_type
      real(wp) :: alpha_m = 0.0_wp, alpha_f = 0.0_wp, beta = 0.25_wp, gamma = 0.5_wp
   end type family_type

   type, extends(family_type) :: step_balance
      !> Velocities, accelerations and forces of the unknowns at the start of a step, and at its end
      !> (unknowns)
      real(wp), allocatable :: v0(:), a0(:), g0(:), v1(:), a1(:), g1(:)
      !> Residual, and displacements of the unknowns in the step (unknowns)
      real(wp), allocatable :: r(:), moved(:)
      !> Loads at the end of the step
      real(wp) :: load(signals) = 0.0_wp
      !> Position at the end of the step and its velocity (coordinates)
      real(wp), allocatable :: q1(:), w1(:)
      !> Runs of the coordinates that are no layers (2, runs), see `layer_joints`
      integer, allocatable :: run(:, :)
      !> Whether forces and tangents are those of the start of the step
      logical, private :: known = .false.
      !> Forces of the present trial
      type(motion_result) :: now
      !> Stiffness of the springs in the tangent (springs), its version, and the resistance in it as a share
      !> of the initial stiffness
      real(wp), allocatable, private :: k(:)
      integer :: version = -1
      !> Tangents at the start of a step, and their version, for damping in proportion to the present
      !> stiffness: a force that falls with the stiffness within the step may leave no equilibrium. Empty
      !> where elements have no such damping
      type(series_tangent), allocatable :: damping_tangent(:)
      integer, private :: damping_version = -1
      real(wp), private :: resistance_in = 0.0_wp
      !> Whether springs without stiffness share a motion in them, of which the ends determine the sum alone
      logical :: shares = .false.
      !> Resistance that belongs into the tangents
      real(wp) :: resistance = 0.0_wp
      !> Largest force of each group of unknowns in the present trial and in all steps so far. Residuals are
      !> measured by them: where a motion passes through zero, or springs and damping cancel each other, all
      !> forces of the moment are round-off.
      real(wp), allocatable, private :: scale(:)
      real(wp), allocatable :: largest(:)
      !> Factors that bring forces and moments of one group to one unit, those of unknowns and of springs; not
      !> allocated where no group has both (unknowns), (springs). Initial stiffness in these units
      !> (coordinates)
      real(wp), allocatable, private :: unit_factor(:), spring_factor(:), stiff(:)
   contains
      procedure :: start, find_residual, find_first, end_on_lines
      procedure, private :: fit_elements, measure
      procedure :: is_round_off, go_on
      procedure, private :: set_damping
      procedure :: serialize
   end type step_balance

   !> A rotation without mass that hinges leave free is held by this share of the initial stiffness.
   real(wp), parameter :: held_by = 1.0e-3_wp

   !> Steps that differ by a smaller share have one factor.
   real(wp), parameter :: equal_step = 1.0e-14_wp

   !> Modal damping in a correction: most rounds, and the share of the largest force that may be lacking.
   integer, parameter :: most_rounds = 8
   real(wp), parameter :: found_force = 1.0e-10_wp

   type :: step_tangent
      !> Diagonal of the tangent (unknowns)
      real(wp), allocatable :: stiffness(:)
      type(band_matrix) :: matrix
      !> Initial diagonal of unknowns without mass whose elements yield, 0 of the others (unknowns)
      real(wp), allocatable, private :: initial(:)
      !> Contribution of each spring (springs)
      real(wp), allocatable, private :: k(:)
      !> Step and lines that the factor belongs to
      real(wp), private :: factor_step = -1.0_wp, factor_resistance = 0.0_wp
      integer, private :: factor_version = -1, factor_damping = -1
      !> Of modal damping: force of a mode per motion that it lacks, in the elastic structure (modes), and its
      !> factor in the tangent [1/s]
      real(wp), allocatable, private :: of_mode(:)
      real(wp), private :: damping_factor = 0.0_wp
      !> Whether an unknown without mass is held, as its pivot is round-off
      logical :: holds = .false.
   contains
      procedure :: create, find_correction, fit
   end type step_tangent

contains

   !> Velocities and accelerations of the unknowns at the start of the first step.
   subroutine start(self, state)
      class(step_balance), intent(inout) :: self
      type(state_type), intent(in) :: state
      real(wp) :: relative, force, terms, work
      integer :: m, springs

      associate (structure => state%motion%structure)
         m = structure%unknowns
         springs = size(structure%location)
         if (.not. allocated(self%v0)) then
            allocate (self%v0(m), self%a0(m), self%g0(m), self%v1(m), self%a1(m), self%g1(m), self%r(m), &
                      self%moved(m), self%q1(structure%coordinates), &
                      self%w1(structure%coordinates), source=0.0_wp)
            allocate (self%scale(size(structure%group)), self%largest(size(structure%group)), source=0.0_wp)
            call self%now%create(structure)
            allocate (self%k(springs))
            if (structure%joints%count > 0) then
               self%run = structure%joints%run
            else
               self%run = reshape([1, structure%coordinates], [2, 1])
            end if
            if (structure%tangent_damping) then
               self%damping_tangent = structure%initial_tangent
            else
               allocate (self%damping_tangent(0))
            end if
            if (allocated(structure%reach)) then
               self%unit_factor = 1.0_wp/structure%reach
               self%spring_factor = merge(1.0_wp/structure%total_height, 1.0_wp, &
                                        structure%location%kind == flexure)
               call set_stiffness(structure, self%spring_factor, self%stiff)
            end if
         end if
         call structure%unknown_rates(state%v, self%v0)
         self%version = -1
         call self%fit_elements(state)
         call self%set_damping(state)
         call find_forces(state, state%q, state%v, self%v0, state%load, self%damping_tangent, self%now, &
                          self%g0)
         self%known = .true.
         self%a0 = 0.0_wp
         where (structure%inertias > 0.0_wp) self%a0 = self%g0/structure%inertias
         self%largest = 0.0_wp
         call self%measure(structure, self%a0, state%load, relative)
         ! A structure at rest is measured by the forces of its members and its dead load.
         call structure%size_of_parts(state%springs, state%q, 0.0_wp, force, terms, work)
         self%largest = max(self%scale, force)
      end associate
   end subroutine start

   !> Initial stiffness against each coordinate, in the units of the forces; that of the layers of a joint
   !> belongs to its opening and its rotation, whose moment is in the place of the second layer.
   subroutine set_stiffness(structure, unit, stiff)
      class(structure_type), intent(in) :: structure
      !> (springs): factors that bring forces and moments to one unit; in the place of the second layer of a
      !> joint the factor of a moment is put
      real(wp), intent(inout) :: unit(:)
      !> (coordinates)
      real(wp), allocatable, intent(out) :: stiff(:)
      integer :: i, j

      allocate (stiff(structure%coordinates), source=0.0_wp)
      associate (joints => structure%joints, k => structure%initial_stiffness)
         stiff(:size(unit)) = unit*k
         ! Layers count by opening and rotation of their joint.
         do j = 1, joints%count
            unit(joints%first(j) + 1) = 1.0_wp/structure%total_height
            associate (of => [(i, i=joints%first(j), joints%last(j))], at => joints%before + 2*j)
               stiff(of) = 0.0_wp
               stiff(at - 1) = sum(k(of))
               stiff(at) = sum(k(of)*joints%y(of)**2)/structure%total_height
            end associate
         end do
      end associate
   end subroutine set_stiffness

   !> The end of the step that was found is the start of the next one.
   subroutine go_on(self, state)
      class(step_balance), intent(inout) :: self
      type(state_type), intent(in) :: state

      self%largest(:) = max(self%largest, self%scale)
      call swap(self%v0, self%v1)
      call swap(self%a0, self%a1)
      call swap(self%g0, self%g1)
      self%known = .true.
      ! Damping by the present stiffness changes with the lines: forces and accelerations at the start follow.
      if (size(self%damping_tangent) == 0 .or. state%springs%version == self%damping_version) return
      associate (structure => state%motion%structure, force => self%g1)
         force = 0.0_wp
         call structure%damp(-self%v0, self%damping_tangent, force)
         call self%set_damping(state)
         call structure%damp(self%v0, self%damping_tangent, force)
         self%g0 = self%g0 + force
         where (structure%inertias > 0.0_wp) self%a0 = self%a0 + force/structure%inertias
      end associate
   end subroutine go_on

   !> Tangents of the present lines for the damping of the next step; springs that soften damp nothing.
   subroutine set_damping(self, state)
      class(step_balance), intent(inout) :: self
      type(state_type), intent(in) :: state
      integer :: unstable

      if (size(self%damping_tangent) == 0) return
      call state%motion%structure%linearise(max(state%springs%k, 0.0_wp), self%damping_tangent, unstable)
      self%damping_version = state%springs%version
   end subroutine set_damping

   !> Save or restore, whichever the stream is set to, the motion of the bodies at the start of a step, the
   !> scales of its residual, and what springs between the unknowns lack.
   subroutine serialize(self, stream)
      class(step_balance), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%item(self%v0)
      call stream%item(self%a0)
      call stream%item(self%g0)
      call stream%item(self%largest)
      call stream%item(self%now%correction)
   end subroutine serialize

   !> Find the tangents of the elements on the present lines, which condense the parts between the unknowns;
   !> not where lines and resistance are those of the last tangents.
   subroutine fit_elements(self, state)
      class(step_balance), intent(inout) :: self
      type(state_type), intent(in) :: state
      integer :: unstable

      if (state%springs%version == self%version .and. &
          .not. abs(self%resistance - self%resistance_in) > 0.0_wp) return
      self%k = state%springs%k
      if (self%resistance > 0.0_wp) then
         self%k = self%k + self%resistance*state%motion%structure%initial_stiffness
      end if
      call state%motion%structure%linearise(self%k, self%now%tangent, unstable, self%shares)
      self%version = state%springs%version
      self%resistance_in = self%resistance
   end subroutine fit_elements

   !> Find the residual of the step for the displacements of the unknowns in `moved`, and its size relative to
   !> the forces.
   subroutine find_residual(self, state, h, load, relative)
      class(step_balance), intent(inout) :: self
      type(state_type), intent(in) :: state
      !> Step [s], loads at its end
      real(wp), intent(in) :: h, load(signals)
      !> Size of the residual relative to the forces
      real(wp), intent(out) :: relative

      self%load = load
      call self%fit_elements(state)
      call end_of_step(self, h)
      if (state%motion%springs_damp) then
         call state%motion%structure%spring_rates(self%now%tangent, self%v1, self%w1)
      end if
      call find_forces(state, self%q1, self%w1, self%v1, load, self%damping_tangent, self%now, self%g1)
      self%known = .false.
      call compare(self, state, relative)
   end subroutine find_residual

   !> Find the residual of the first trial, in which nothing has moved. It has the forces of the end of the
   !> last step, but for the response to loads and velocities alone.
   subroutine find_first(self, state, h, load, relative)
      class(step_balance), intent(inout) :: self
      type(state_type), intent(in) :: state
      !> Step [s], loads at its end
      real(wp), intent(in) :: h, load(signals)
      !> Size of the residual relative to the forces
      real(wp), intent(out) :: relative

      ! The forces of the last end may not be at hand, or springs may be damped.
      if (.not. self%known .or. .not. (size(self%now%tangent) > 0 .or. state%motion%plain)) then
         call self%find_residual(state, h, load, relative)
         return
      end if
      self%load = load
      associate (structure => state%motion%structure, change => load - state%load)
         call end_of_step(self, h)
         self%g1 = self%g0 + change(lateral)*structure%pattern(lateral)%force
         call structure%add_ground(change, self%g1)
         if (structure%damped) call structure%damp(self%v1 - self%v0, self%damping_tangent, self%g1)
         if (structure%mass_damping > 0.0_wp) then
            self%g1 = self%g1 - structure%mass_damping*structure%inertias*(self%v1 - self%v0)
         end if
      end associate
      call compare(self, state, relative)
   end subroutine find_first

   !> End the step with a correction that was exact, as no line has changed: the forces on the unknowns are
   !> those of the equation of the step, and nothing between the unknowns is left to be corrected.
   subroutine end_on_lines(self, mass, h, load)
      class(step_balance), intent(inout) :: self
      !> Mass or inertia of the unknowns (unknowns); step [s]; loads at its end
      real(wp), intent(in), contiguous :: mass(:)
      real(wp), intent(in) :: h, load(signals)
      integer :: i

      self%load = load
      call end_of_step(self, h)
      self%r(:) = 0.0_wp
      do i = 1, size(mass)
         self%g1(i) = 0.0_wp
         if (mass(i) > 0.0_wp) self%g1(i) = (mass(i)*((1.0_wp - self%alpha_m)*self%a1(i) &
                                                      + self%alpha_m*self%a0(i)) &
                                             - self%alpha_f*self%g0(i))/(1.0_wp - self%alpha_f)
      end do
      do i = 1, size(self%run, 2)
         self%now%correction(self%run(1, i):self%run(2, i)) = 0.0_wp
      end do
      self%known = .false.
   end subroutine end_on_lines

   !> Find the residual of the balance in the trial, and its size relative to the forces (`relative`).
   subroutine compare(self, state, relative)
      class(step_balance), intent(inout) :: self
      type(state_type), intent(in) :: state
      real(wp), intent(out) :: relative
      real(wp) :: rest
      integer :: j

      associate (structure => state%motion%structure)
         call balance(size(self%r), self%alpha_m, self%alpha_f, structure%inertias, self%a0, self%a1, &
                      self%g0, self%g1, self%r)
         call self%measure(structure, self%a1, self%load, relative)
         if (size(self%now%correction) > 0) then
            rest = 0.0_wp
            do j = 1, size(self%run, 2)
               associate (first => self%run(1, j), last => self%run(2, j))
                  rest = max(rest, largest_product(last - first + 1, self%stiff(first:last), &
                                                   self%now%correction(first:last)))
               end associate
            end do
            relative = max(relative, rest/max(maxval(self%scale), maxval(self%largest), tiny(1.0_wp)))
         end if
      end associate
   end subroutine compare

   !> Find the forces on the unknowns, inertia of the ground and damping included.
   subroutine find_forces(state, q, w, v, load, damping_tangent, now, g)
      type(state_type), intent(in) :: state
      !> Deformations of the springs and their velocities (springs), velocities of the unknowns
      real(wp), intent(in), contiguous :: q(:), w(:), v(:)
      !> Loads at the time
      real(wp), intent(in) :: load(signals)
      !> Tangents that elements are damped by, if their damping follows the present stiffness
      type(series_tangent), intent(in) :: damping_tangent(:)
      type(motion_result), intent(inout) :: now
      !> Forces on the unknowns (unknowns)
      real(wp), intent(out), contiguous :: g(:)

      associate (motion => state%motion, structure => state%motion%structure)
         call motion%forces_on_bodies(state%springs, q, w, load, now, g)
         call structure%add_ground(load, g)
         if (structure%damped) call structure%damp(v, damping_tangent, g)
         if (structure%mass_damping > 0.0_wp) g = g - structure%mass_damping*structure%inertias*v
         ! Supports balance the forces on them.
         where (structure%is_held) g = 0.0_wp
      end associate
   end subroutine find_forces

   !> Accelerations and velocities at the end of the step for displacements of the unknowns.
   pure subroutine end_of_step(self, h)
      class(step_balance), intent(inout) :: self
      !> Step [s]
      real(wp), intent(in) :: h

      associate (v0 => self%v0, a0 => self%a0, beta => self%beta, gamma => self%gamma)
         self%a1(:) = (self%moved - h*v0 - (h**2*(0.5_wp - beta))*a0)*(1.0_wp/(beta*h**2))
         self%v1(:) = v0 + (h*(1.0_wp - gamma))*a0 + (h*gamma)*self%a1
      end associate
   end subroutine end_of_step

   !> Residual of the equation of the step.
   pure subroutine balance(m, alpha_m, alpha_f, mass, a0, a1, g0, g1, r)
      integer, intent(in) :: m
      !> Shares of the start of the step in inertia and forces; mass; accelerations and forces at start and
      !> end
      real(wp), intent(in) :: alpha_m, alpha_f, mass(m), a0(m), a1(m), g0(m), g1(m)
      real(wp), intent(out) :: r(m)

      ! Unknowns without mass are in equilibrium at the end of the step, even if not at the start.
      r = (1.0_wp - alpha_f)*g1 + alpha_f*merge(g0, 0.0_wp, mass > 0.0_wp) &
          - mass*((1.0_wp - alpha_m)*a1 + alpha_m*a0)
   end subroutine balance

   !> Largest force of each group at the present forces: of springs, of inertia and of the loads; and the
   !> largest residual over the largest force of its group, at the most 1.
   subroutine measure(self, structure, a, load, relative)
      class(step_balance), intent(inout) :: self
      class(structure_type), intent(in) :: structure
      !> Accelerations (unknowns), loads
      real(wp), intent(in), contiguous :: a(:)
      real(wp), intent(in) :: load(signals)
      !> Largest residual over the largest force of its group
      real(wp), intent(out) :: relative
      !> Largest residual of a group
      real(wp) :: rest
      integer :: j

      relative = 0.0_wp
      do j = 1, size(self%scale)
         if (allocated(self%unit_factor)) then
            call measure_all(size(a), self%unit_factor, structure%inertias, a, self%r, self%scale(j), rest)
            self%scale(j) = max(self%scale(j), largest(structure%joints%with_force, self%spring_factor, &
                                                       self%now%f))
         else
            call measure_group(structure%group(j), size(a), size(self%now%f), structure%inertias, a, &
                               self%now%f, self%r, self%scale(j), rest)
         end if
         self%scale(j) = max(self%scale(j), abs(load(lateral))*structure%group(j)%lateral_arm)
         relative = max(relative, rest/max(self%scale(j), self%largest(j), rest, tiny(1.0_wp)))
      end do
   end subroutine measure

   !> Largest force and largest residual of a group of unknowns, which are all forces or all moments.
   pure subroutine measure_group(group, unknowns, springs, inertias, a, f, r, scale, rest)
      type(unknown_group), intent(in) :: group
      integer, intent(in) :: unknowns, springs
      !> Mass or inertia, accelerations, forces of the springs, residual
      real(wp), intent(in) :: inertias(unknowns), a(unknowns), f(springs), r(unknowns)
      !> Largest force (of springs and inertia) and largest residual
      real(wp), intent(out) :: scale, rest
      integer :: i, k

      scale = 0.0_wp
      rest = 0.0_wp
      do i = group%first_spring, group%last_spring
         scale = max(scale, abs(f(i)))
      end do
      i = group%first
      do k = 1, group%count
         scale = max(scale, abs(inertias(i)*a(i)))
         rest = max(rest, abs(r(i)))
         i = i + group%step
      end do
   end subroutine measure_group

   !> Largest force of inertia and largest residual of the unknowns of one group that has forces and moments,
   !> which their factors bring to one unit.
   pure subroutine measure_all(unknowns, unit_factor, inertias, a, r, scale, rest)
      integer, intent(in) :: unknowns
      !> Factors to one unit; mass or inertia, accelerations, residual
      real(wp), intent(in) :: unit_factor(unknowns), inertias(unknowns), a(unknowns), r(unknowns)
      !> Largest force, and largest residual
      real(wp), intent(out) :: scale, rest
      integer :: i

      scale = 0.0_wp
      rest = 0.0_wp
      do i = 1, unknowns
         scale = max(scale, unit_factor(i)*abs(inertias(i)*a(i)))
         rest = max(rest, unit_factor(i)*abs(r(i)))
      end do
   end subroutine measure_all

   !> The largest product of two numbers, in size, over chosen places of two lists.
   pure real(wp) function largest(chosen, a, b)
      !> Places that count, ascending
      integer, intent(in), contiguous :: chosen(:)
      real(wp), intent(in), contiguous :: a(:), b(:)
      integer :: i

      largest = 0.0_wp
      if (size(chosen) == 0) return
      ! Where no spring is a layer all places count, one after the other.
      if (chosen(size(chosen)) == size(chosen)) then
         largest = largest_product(size(chosen), a, b)
         return
      end if
      do i = 1, size(chosen)
         largest = max(largest, abs(a(chosen(i))*b(chosen(i))))
      end do
   end function largest

   !> The largest product of two numbers, in size, of two lists.
   pure real(wp) function largest_product(n, a, b) result(largest)
      integer, intent(in) :: n
      real(wp), intent(in) :: a(n), b(n)
      integer :: i

      largest = 0.0_wp
      !$omp simd reduction(max:largest)
      do i = 1, n
         largest = max(largest, abs(a(i)*b(i)))
      end do
   end function largest_product

   !> Whether the residual is the round-off of the terms of the step. Modes that the step does not
   !> resolve have accelerations far beyond the motion of the step: after a shock h^2 a0 is many turns.
   logical function is_round_off(self, state, h, stiffness)
      class(step_balance), intent(in) :: self
      type(state_type), intent(in) :: state
      !> Step [s]
      real(wp), intent(in) :: h
      !> Diagonal of the tangent (unknowns)
      real(wp), intent(in), contiguous :: stiffness(:)
      !> Of each part of the structure: sum of the roots of its diagonal, times the largest motion of the
      !> group; that motion; largest force of members, and the same if no terms cancelled
      real(wp) :: reach(maxval(state%motion%structure%part)), distance, force, terms, work
      real(wp), dimension(size(stiffness)) :: unit_factor, moved
      integer :: i, j, k

      ! An unknown is coupled with the others of its part: |k_ij| is at most the root of k_ii k_jj.
      reach = 0.0_wp
      unit_factor = 1.0_wp
      if (allocated(self%unit_factor)) unit_factor = self%unit_factor
      moved = (abs(self%moved) + h*abs(self%v0) + h**2*abs(self%a0))/unit_factor
      associate (structure => state%motion%structure)
         do j = 1, size(structure%group)
            distance = 0.0_wp
            do k = 0, structure%group(j)%count - 1
               i = structure%group(j)%first + k*structure%group(j)%step
               distance = max(distance, moved(i))
            end do
            do k = 0, structure%group(j)%count - 1
               i = structure%group(j)%first + k*structure%group(j)%step
               reach(structure%part(i)) = reach(structure%part(i)) &
                                          + sqrt(max(stiffness(i), 0.0_wp))*unit_factor(i)*distance
            end do
         end do
         ! Forces of members are sums over whole displacements, not over those of the step.
         call structure%size_of_parts(state%springs, self%q1, 0.0_wp, force, terms, work)
         is_round_off = all(abs(self%r) <= round_off_of_sums* &
                            (sqrt(max(stiffness, 0.0_wp))*reach(structure%part) &
                             + max(force, terms)/unit_factor))
         ! Springs between the unknowns are in equilibrium too.
         if (size(self%now%correction) > 0) then
            is_round_off = is_round_off .and. all(self%stiff*abs(self%now%correction) <= round_off_of_sums* &
                                                  (self%stiff*abs(self%q1) + max(force, terms)))
         end if
      end associate
   end function is_round_off

   !> Make room for a structure.
   subroutine create(self, structure)
      class(step_tangent), intent(out) :: self
      class(structure_type), intent(in) :: structure

      allocate (self%stiffness(structure%unknowns), self%k(size(structure%location)), source=0.0_wp)
      call self%matrix%create(structure%unknowns, structure%half_width)
      ! Unknowns without mass may lose all stiffness: their initial one tells.
      if (all(structure%inertias > 0.0_wp)) return
      call structure%add_stiffness(structure%initial_stiffness, structure%initial_tangent, self%matrix%band)
      self%initial = merge(0.0_wp, self%matrix%band(1, :), structure%inertias > 0.0_wp)
   end subroutine create

   !> The correction that takes the residual away as long as no line changes. The tangent is factored anew
   !> only if a line, the step or the axial load has changed.
   subroutine find_correction(self, step, state, h, dx)
      class(step_tangent), intent(inout) :: self
      type(step_balance), intent(inout) :: step
      type(state_type), intent(in) :: state
      !> Step [s]
      real(wp), intent(in) :: h
      !> Correction of the unknowns (unknowns)
      real(wp), intent(out), contiguous :: dx(:)
      logical :: regular

      call self%fit(step, state, h)
      dx = step%r
      call self%matrix%solve(dx, regular)
      associate (structure => state%motion%structure)
         if (allocated(self%of_mode)) call apply_modal_damping(structure%massed, structure%modal_momenta)
      end associate

   contains

      !> Modal damping would fill the band. Its forces follow from the motions of the modes and these from the
      !> forces: with the flexibility of the elastic structure, in which the modes are uncoupled, the first
      !> round is exact, and a few rounds are where springs have yielded.
      subroutine apply_modal_damping(massed, momenta)
         !> Unknowns with mass
         integer, intent(in) :: massed(:)
         !> Momenta of the modes (unknowns with mass, modes)
         real(wp), intent(in) :: momenta(:, :)
         real(wp) :: moved(size(massed)), force(size(momenta, 2)), lacking(size(momenta, 2)), rest
         integer :: j, round

         force = 0.0_wp
         rest = huge(1.0_wp)
         do round = 0, most_rounds
            ! Motion that each mode has beyond what its damping force stands for
            moved = dx(massed)
            do j = 1, size(force)
               lacking(j) = inner_product(size(moved), momenta(:, j), moved) - force(j)/self%damping_factor
            end do
            if (maxval(abs(lacking)) <= found_force*maxval(abs(force))/self%damping_factor) return
            if (.not. maxval(abs(lacking)) < rest) return
            rest = maxval(abs(lacking))
            force = force + self%of_mode*lacking
            moved = step%r(massed)
            do j = 1, size(force)
               moved = moved - force(j)*momenta(:, j)
            end do
            dx = step%r
            dx(massed) = moved
            call self%matrix%solve(dx, regular)
         end do
      end subroutine apply_modal_damping

   end subroutine find_correction

   !> Factor the tangent anew, if a line, the step or the axial load has changed.
   subroutine fit(self, step, state, h)
      class(step_tangent), intent(inout) :: self
      type(step_balance), intent(inout) :: step
      type(state_type), intent(in) :: state
      !> Step [s]
      real(wp), intent(in) :: h

      if (state%springs%version == self%factor_version .and. abs(h - self%factor_step) <= equal_step*h .and. &
          .not. abs(step%resistance - self%factor_resistance) > 0.0_wp .and. &
          (size(step%damping_tangent) == 0 .or. step%damping_version == self%factor_damping) .and. &
          .not. (state%motion%second_order .and. state%motion%varies)) return
      call step%fit_elements(state)
      associate (structure => state%motion%structure)
         if (allocated(structure%modal_momenta) .and. abs(h - self%factor_step) > equal_step*h) then
            call prepare_modal_damping(structure%massed, structure%modal_momenta)
         end if
         call set_tangent(state%springs%k, step%now%tangent)
         if (allocated(self%initial)) call hold_free()
      end associate
      self%factor_step = h
      self%factor_damping = step%damping_version
      self%factor_resistance = step%resistance
      self%factor_version = state%springs%version

   contains

      !> What `apply_modal_damping` needs of the elastic structure without damping.
      subroutine prepare_modal_damping(massed, momenta)
         !> Unknowns with mass; momenta of the modes (unknowns with mass, modes)
         integer, intent(in) :: massed(:)
         real(wp), intent(in) :: momenta(:, :)
         real(wp) :: motion(size(step%r))
         logical :: regular
         integer :: j

         self%damping_factor = (1.0_wp - step%alpha_f)*step%gamma/(step%beta*h)
         associate (structure => state%motion%structure)
            call set_tangent(structure%initial_stiffness, structure%initial_tangent)
         end associate
         if (.not. allocated(self%of_mode)) allocate (self%of_mode(size(momenta, 2)))
         do j = 1, size(momenta, 2)
            motion = 0.0_wp
            motion(massed) = momenta(:, j)
            call self%matrix%solve(motion, regular)
            self%of_mode(j) = 1.0_wp/(1.0_wp/self%damping_factor + sum(momenta(:, j)*motion(massed)))
         end do
      end subroutine prepare_modal_damping

      !> Tangent of the step on lines of the springs, and its factor.
      subroutine set_tangent(k, tangent)
         !> Stiffness of the springs (springs); tangents of elements on the same lines
         real(wp), intent(in) :: k(:)
         type(series_tangent), intent(in) :: tangent(:)
         real(wp) :: of_mass, of_damping
         integer :: i

         ! Velocities and accelerations at the end of the step, per displacement in it.
         of_damping = step%gamma/(step%beta*h)
         associate (motion => state%motion, structure => state%motion%structure)
            of_mass = (1.0_wp - step%alpha_m)/(step%beta*h**2) &
                      + (1.0_wp - step%alpha_f)*of_damping*structure%mass_damping
            self%k = k
            if (step%resistance > 0.0_wp) self%k = self%k + step%resistance*structure%initial_stiffness
            if (structure%tangent_damping) then
               self%k = self%k + (of_damping*structure%spring_damping)*max(k, 0.0_wp)
            else if (motion%springs_damp) then
               self%k = self%k + of_damping*motion%joint_damping
            end if
            self%matrix%band = 0.0_wp
            call structure%add_stiffness(self%k, tangent, self%matrix%band)
            if (structure%stiffness_damping > 0.0_wp) then
               call structure%add_damping(of_damping, step%damping_tangent, self%matrix%band)
            end if
            if (motion%second_order) call structure%add_geometric(step%now%axial, self%matrix%band)
            self%matrix%band = (1.0_wp - step%alpha_f)*self%matrix%band
            self%matrix%band(1, :) = self%matrix%band(1, :) + of_mass*structure%inertias
            do i = 1, structure%unknowns
               if (structure%is_held(i)) call self%matrix%hold(i, of_mass*structure%inertias(i))
            end do
            self%stiffness = self%matrix%band(1, :)
            self%holds = .false.
            call self%matrix%factor()
         end associate
      end subroutine set_tangent

      !> Where the pivot of an unknown without mass is round-off, a share of the initial stiffness holds the
      !> unknown, and the tangent is factored again.
      subroutine hold_free()

         associate (inverse => abs(self%matrix%triangle(1, :)), initial => self%initial)
            self%holds = any(no_stiffness*initial*inverse > 1.0_wp)
            if (.not. self%holds) return
            where (no_stiffness*initial*inverse > 1.0_wp) self%matrix%band(1, :) = self%matrix%band(1, :) &
                                                                                    + held_by*initial
            call self%matrix%factor()
         end associate
      end subroutine hold_free

   end subroutine fit

end module rbs_solve_time_implicit_balance
