!> Implicit steps with exact rotations, in absolute coordinates of the centroids (x, y, th): the mass is
!> constant and diagonal, joints meet their neighbours only, and the tangent is a band, so that a step takes a
!> number of operations in proportion to n. Joints that do not open have their axial force as an unknown, and
!> that they do not open as its equation.
!>
!> Average acceleration with mean-value derivatives balances the energy exactly for a step of any length,
!>
!>     M 2/h^2 (dx - h v_0) + sum B' f = Q,   v_1 = 2 dx/h - v_0,   f = (work of the spring)/(its change)
!>
!> and the generalised-alpha method has the forces of both ends of the step (see
!> `rbs_solve_time_implicit_balance`), with the axial forces among them (M. Arnold, O. Bruels, Multibody
!> Syst. Dyn. 18 (2007) 185-203).
module rbs_solve_time_implicit_finite
   use rbs_base_kinds, only: wp
   use rbs_base_linalg, only: solve_general_band
   use rbs_base_stream, only: stream_type
   use rbs_base_tolerances, only: half_of_digits
   use rbs_structure_column_finite, only: finite_chain_type
   use rbs_solve_time_finite_joint, only: turned_body, turn_body, body_at, joint_type, joint_change, &
                                          joint_at, joint_rates, add_joint_forces, joint_tangent, local
   use rbs_loading_loads, only: lateral, horizontal, vertical, signals
   use rbs_solve_time_motion, only: motion_result
   use rbs_solve_time_implicit_balance, only: family_type
   use rbs_solve_time_newton, only: newton_stepper
   use rbs_solve_time_state, only: state_type
   use rbs_structure_spring_location, only: shear, flexure, tension => axial
   implicit none
   private

   public :: finite_stepper

   !> Largest rotation in one correction [rad].
   real(wp), parameter :: most_rotation = 1.0_wp
   !> Below this share of the forces a change of a spring's force is round-off.
   real(wp), parameter :: no_change = 1.0e-6_wp
   !> Forces that residuals are compared with are no smaller, so that nothing overflows [N, N m].
   real(wp), parameter :: least_scale = 1.0e-150_wp

   type, extends(newton_stepper) :: finite_stepper
      !> Whether the forces are those of the mean-value derivatives; else the parameters of generalised-alpha
      logical :: average = .true.
      type(family_type) :: by
      class(finite_chain_type), pointer, private :: column => null()
      !> Unknowns of a body in the band, and diagonals of the band beside the main one
      integer, private :: per = 3, half_width = 6
      !> Mass of the bodies, and the residual (3, n)
      real(wp), allocatable, private :: mass(:, :), r(:, :)
      !> Displacements of the bodies, the ground (0) among them, in the step; velocities, forces and
      !> accelerations at its start and its end (3, 0:n)
      real(wp), allocatable, private :: moved(:, :), v0(:, :), v1(:, :), g0(:, :), g1(:, :), a0(:, :), &
                                        a1(:, :)
      !> Rotations at the start of the step, and as the forces see them (n)
      real(wp), allocatable, private :: from(:), rotation(:)
      !> The bodies over the step, and as the forces see them (0:n)
      type(turned_body), allocatable, private :: turned(:), seen(:)
      type(joint_type), allocatable, private :: joint(:)
      !> Deformations at the end of the step and their change, and velocities of the joints (unknowns)
      real(wp), allocatable, private :: q1(:), change(:), w1(:)
      !> Forces of the joints, their derivatives and damping (unknowns)
      real(wp), allocatable, private :: f(:), k(:), viscous(:)
      !> Of joints that do not open: how far they have opened, axial forces, tension positive, and these at
      !> the start of the step (n)
      real(wp), allocatable, private :: opening(:), reaction(:), reaction0(:)
      !> Derivative of the moment on the top body by its rotation; largest force, moment of the present trial
      !> and of all steps so far
      real(wp), private :: load_rate = 0.0_wp, scale(2) = 0.0_wp, largest(2) = 0.0_wp
      !> Correction of the bodies (3, n) and of the axial forces (n)
      real(wp), allocatable, private :: dx(:, :), dn(:)
      real(wp), allocatable, private :: band(:, :), right(:, :)
      integer, allocatable, private :: pivot(:)
      !> Work of the springs up to the step (unknowns)
      real(wp), allocatable, private :: work(:)
   contains
      procedure :: prepare, take_step, correct, try, work_of_residual, serialize
   end type finite_stepper

contains

   !> Make room, and find velocities, accelerations and forces of the bodies at the start of the first step.
   subroutine prepare(self, state)
      class(finite_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state
      type(motion_result) :: now
      integer :: i, m, n

      select type (column => state%motion%structure)
      class is (finite_chain_type)
         self%column => column
      end select
      self%most_trials = 30
      self%searches_uphill = .false.
      n = self%column%n
      m = self%column%unknowns
      ! Unknowns of a body: its place and rotation, and the axial force of its joint if that does not open.
      self%per = merge(3, 4, self%column%opens)
      self%half_width = merge(5, 6, self%column%opens)
      allocate (self%mass(3, n), self%r(3, n), self%dx(3, n), source=0.0_wp)
      allocate (self%moved(3, 0:n), self%v0(3, 0:n), self%g0(3, 0:n), self%a0(3, 0:n), source=0.0_wp)
      allocate (self%v1(3, 0:n), self%g1(3, 0:n), self%a1(3, 0:n), source=0.0_wp)
      allocate (self%from(n), self%rotation(n), self%opening(n), self%reaction(n), self%reaction0(n), &
                self%dn(n), source=0.0_wp)
      allocate (self%q1(m), self%change(m), self%w1(m), self%f(m), self%k(m), self%viscous(m), &
                self%work(m), source=0.0_wp)
      allocate (self%turned(0:n), self%seen(0:n), self%joint(n))
      allocate (self%band(3*self%half_width + 1, self%per*n), self%right(self%per*n, 1), source=0.0_wp)
      allocate (self%pivot(self%per*n), source=0)
      associate (column => self%column, joint => self%joint)
         self%mass(1, :) = column%mass
         self%mass(2, :) = column%mass
         self%mass(3, :) = column%inertia
         ! Joint i is between bodies i - 1 and i, at its distances from their centroids; body 0 is the ground.
         do i = 1, n
            joint(i)%lower = i - 1
            joint(i)%upper = i
            joint(i)%above = column%lower(i)
            if (i > 1) joint(i)%below = column%upper(i - 1)
         end do
         if (column%held) joint(n) = joint_type(lower=n, upper=n - 1, sign=-1.0_wp, &
                                                above=-column%upper(n - 1), below=0.0_wp)
         ! An axial force that no opening gives is that of the equation of motion.
         call now%create(column)
         call state%motion%acceleration(state%springs, state%q, state%v, state%load, now)
         call column%accelerate(state%q, state%v, now%f, state%load, now%work, now%a)
         if (.not. column%opens) self%reaction = now%work(:n)
         call column%body_velocities(state%q, state%v, self%v0(:, 1:))
      end associate
      self%v1 = self%v0
      call locate_bodies(self, state%q)
      ! The length of a step, here any, counts for the derivatives alone.
      call find_forces_at(self, state, state%q, state%v, state%load, 1.0_wp, self%g0)
      self%a0(:, 1:) = self%g0(:, 1:)/self%mass
      self%largest = self%scale
   end subroutine prepare

   !> Take the step, if Newton's method converges; else the state is as before. In the step the work of the
   !> springs is counted from its start: as the small difference of large numbers it would have no digits.
   subroutine take_step(self, state)
      class(finite_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state

      self%marked = .false.
      self%work(:) = state%springs%work
      self%reaction0(:) = self%reaction
      state%springs%work_before(:) = self%work
      state%springs%work = 0.0_wp
      call state%motion%set_axial_loads(state%springs, self%load)
      call locate_bodies(self, state%q)
      self%from(:) = self%rotation
      self%joint%start(1) = self%joint%finish(1)
      self%joint%start(2) = self%joint%finish(2)
      self%moved = 0.0_wp
      ! The first trial: nothing has moved.
      call self%try(state, 0.0_wp)
      call self%iterate(state)
      self%busiest = maxloc(abs(self%change)*self%column%initial_stiffness, dim=1)
      if (self%converged) then
         call state%springs%carry_to(self%q1)
         state%springs%work = state%springs%work + self%work
         call finish_step(self, state)
      else
         if (self%marked) call state%springs%restore()
         state%springs%work = self%work
         self%reaction(:) = self%reaction0
      end if
      state%springs%work_before(:) = 0.0_wp
      if (self%marked) call state%springs%forget_mark()
   end subroutine take_step

   !> Find directions of the bodies and gaps of the joints at one state.
   subroutine locate_bodies(self, q)
      type(finite_stepper), intent(inout) :: self
      !> Deformations of the joints (springs)
      real(wp), intent(in), contiguous :: q(:)
      integer :: i

      call self%column%rotations(q, self%rotation)
      do i = 1, size(self%rotation)
         call body_at(self%rotation(i), self%seen(i))
      end do
      do i = 1, size(self%joint)
         associate (joint => self%joint(i))
            joint%finish = joint_at(self%seen(joint%lower), joint, joint_values(self, q, i, 0.0_wp))
            joint%mean = joint%finish
         end associate
      end do
   end subroutine locate_bodies

   !> Values of joint i (slip, rotation, opening), from those of all springs.
   pure function joint_values(self, x, i, opening) result(y)
      type(finite_stepper), intent(in) :: self
      !> (springs)
      real(wp), intent(in), contiguous :: x(:)
      integer, intent(in) :: i
      !> The value where joints do not open
      real(wp), intent(in) :: opening
      real(wp) :: y(3)

      y = [x(self%column%at(shear, i)), x(self%column%at(flexure, i)), opening]
      if (self%column%opens) y(tension) = x(self%column%at(tension, i))
   end function joint_values

   !> Put values of joint i (slip, rotation, opening) among those of all springs; an opening only where joints
   !> have a spring for it.
   pure subroutine put_joint(self, y, i, x)
      type(finite_stepper), intent(in) :: self
      real(wp), intent(in) :: y(3)
      integer, intent(in) :: i
      !> (springs)
      real(wp), intent(inout), contiguous :: x(:)

      x(self%column%at(shear, i)) = y(shear)
      x(self%column%at(flexure, i)) = y(flexure)
      if (self%column%opens) x(self%column%at(tension, i)) = y(tension)
   end subroutine put_joint

   !> Go on (or back) by a share of the correction, and find the residual there; `huge` out of bounds.
   subroutine try(self, state, share)
      class(finite_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state
      real(wp), intent(in) :: share
      logical :: in_range

      self%residual = huge(1.0_wp)
      self%moved(:, 1:) = self%moved(:, 1:) + share*self%dx
      self%reaction = self%reaction + share*self%dn
      call find_changes()
      self%q1(:) = state%q + self%change
      call self%move_springs(state, self%q1, in_range)
      if (in_range .and. self%marked) call state%springs%carry_to(self%q1)
      if (in_range) call find_residual()

   contains

      !> Changes of the deformations by the displacements of the bodies.
      subroutine find_changes()
         real(wp) :: change(3)
         integer :: i

         do i = 1, size(self%from)
            call turn_body(self%from(i), self%moved(3, i), self%turned(i))
         end do
         do i = 1, size(self%joint)
            associate (a => self%joint(i)%lower, b => self%joint(i)%upper)
               call joint_change(self%turned(a), self%turned(b), self%moved(:, a), self%moved(:, b), &
                                 self%joint(i), change)
            end associate
            call put_joint(self, change, i, self%change)
            self%opening(i) = change(tension)
         end do
      end subroutine find_changes

      !> Residual of the step, and its size relative to the forces. The springs are at the end of the step, or
      !> still at its start if their lines reach so far.
      subroutine find_residual()

         associate (by => self%by, h => self%h)
            if (self%average) then
               ! The means over the step are in balance, else a state between its start and its end.
               call end_of_step(size(self%moved), h, self%moved, self%v0, self%v1, self%a1)
               self%seen = self%turned
               call find_mean_forces()
               call find_balance(self, 0.5_wp*(state%load + self%load), self%g1)
               call balance(size(self%r), self%column%mass_damping/h, self%mass, self%moved(:, 1:), &
                            self%a1(:, 1:), self%g1(:, 1:), self%r)
            else
               self%a1 = (self%moved - h*self%v0 - (h**2*(0.5_wp - by%beta))*self%a0)/(by%beta*h**2)
               self%v1 = self%v0 + h*((1.0_wp - by%gamma)*self%a0 + by%gamma*self%a1)
               call locate_end(self)
               call find_forces_at(self, state, self%q1, self%w1, self%load, h, self%g1)
               self%r = (1.0_wp - by%alpha_f)*self%g1(:, 1:) + by%alpha_f*self%g0(:, 1:) &
                        - self%mass*((1.0_wp - by%alpha_m)*self%a1(:, 1:) + by%alpha_m*self%a0(:, 1:))
            end if
         end associate
         self%scale(1) = max(self%scale(1), maxval(abs(self%mass(:2, :)*self%a1(:2, 1:))))
         self%scale(2) = max(self%scale(2), maxval(abs(self%mass(3, :)*self%a1(3, 1:))))
         self%residual = max(maxval(abs(self%r(:2, :)))/max(self%scale(1), self%largest(1), least_scale), &
                             maxval(abs(self%r(3, :)))/max(self%scale(2), self%largest(2), least_scale))
         if (self%column%opens) return
         self%residual = max(self%residual, maxval(abs(self%opening))/maxval(self%column%length))
      end subroutine find_residual

      !> Forces of the joints that do exactly the work of springs and damping, and their derivatives.
      subroutine find_mean_forces()
         real(wp) :: finish, mean, moved
         integer :: i

         self%viscous(:) = state%motion%viscous(state%springs%k, state%motion%joint_damping)
         associate (springs => state%springs, h => self%h)
            do i = 1, size(self%f)
               finish = springs%f0(i) + springs%k(i)*(self%q1(i) - springs%d0(i))
               mean = springs%f0(i) + springs%k(i)*(0.5_wp*(self%q1(i) + state%q(i)) - springs%d0(i))
               self%k(i) = 0.5_wp*springs%k(i)
               ! A change that its deformation has no digits for is the one that the spring has made.
               moved = self%change(i)
               if (abs(moved) < half_of_digits*abs(state%q(i))) moved = self%q1(i) - state%q(i)
               ! Springs with a mark are at the end of the step; their work is counted from its start.
               if (self%marked .and. abs(moved) > 0.0_wp) then
                  mean = springs%work(i)/moved
                  if (abs(finish - mean) > no_change*(abs(finish) + abs(mean))) then
                     self%k(i) = (finish - mean)/moved
                  end if
               end if
               self%f(i) = mean + self%viscous(i)*self%change(i)/h
               self%k(i) = self%k(i) + self%viscous(i)/h
            end do
         end associate
         if (allocated(state%motion%modal)) self%f = self%f + matmul(state%motion%modal, self%change)/self%h
      end subroutine find_mean_forces

   end subroutine try

   !> Velocities and accelerations at the end of a step of average acceleration, from the displacements in it.
   pure subroutine end_of_step(m, h, moved, v0, v1, a1)
      integer, intent(in) :: m
      !> Step [s]; displacements in it, and velocities at its start
      real(wp), intent(in) :: h, moved(m), v0(m)
      real(wp), intent(out) :: v1(m), a1(m)

      v1 = (2.0_wp/h)*moved - v0
      a1 = (2.0_wp/h**2)*(moved - h*v0)
   end subroutine end_of_step

   !> Residual of the balance of a step of average acceleration.
   pure subroutine balance(m, damping, mass, moved, a1, g1, r)
      integer, intent(in) :: m
      !> Mass damping over the step [1/s2]; mass, displacements in the step, accelerations, other forces
      real(wp), intent(in) :: damping, mass(m), moved(m), a1(m), g1(m)
      real(wp), intent(out) :: r(m)

      r = g1 - mass*(a1 + damping*moved)
   end subroutine balance

   !> Find bodies and joints at the end of the step, and the velocities of the joints.
   subroutine locate_end(self)
      type(finite_stepper), intent(inout) :: self
      integer :: i

      call locate_bodies(self, self%q1)
      do i = 1, size(self%joint)
         associate (a => self%joint(i)%lower, b => self%joint(i)%upper)
            call put_joint(self, joint_rates(self%seen(a), self%seen(b), self%v1(:, a), self%v1(:, b), &
                                             self%joint(i)), i, self%w1)
         end associate
      end do
   end subroutine locate_end

   !> Find the forces on the bodies at one state: of loads, springs and damping.
   subroutine find_forces_at(self, state, q, v, load, h, g)
      type(finite_stepper), intent(inout) :: self
      type(state_type), intent(in) :: state
      !> Deformations and their velocities (springs)
      real(wp), intent(in), contiguous :: q(:), v(:)
      !> Loads, and length of the step [s]
      real(wp), intent(in) :: load(signals), h
      !> Along x and y [N] and about the centroids [N m] (3, 0:n)
      real(wp), intent(out) :: g(:, 0:)

      self%viscous(:) = state%motion%viscous(state%springs%k, state%motion%joint_damping)
      self%f = state%springs%f0 + state%springs%k*(q - state%springs%d0) + self%viscous*v
      self%k = state%springs%k + self%viscous*(self%by%gamma/(self%by%beta*h))
      if (allocated(state%motion%modal)) self%f = self%f + matmul(state%motion%modal, v)
      call find_balance(self, load, g)
      if (self%column%mass_damping > 0.0_wp) then
         g(:, 1:) = g(:, 1:) - self%column%mass_damping*self%mass*self%v1(:, 1:)
      end if
   end subroutine find_forces_at

   !> Find the forces of loads and joints on the bodies, in the directions of `seen`: at one state, or in the
   !> mean of a step.
   subroutine find_balance(self, load, g)
      type(finite_stepper), intent(inout) :: self
      real(wp), intent(in) :: load(signals)
      !> Along x and y [N] and about the centroids [N m] (3, 0:n)
      real(wp), intent(out) :: g(:, 0:)
      !> Forces of a joint; largest force and largest moment of all
      real(wp) :: f(3), reach(2)
      integer :: i, n

      n = self%column%n
      g = 0.0_wp
      reach = 0.0_wp
      do i = 1, n
         f = joint_values(self, self%f, i, self%reaction(i))
         reach = max(reach, [max(abs(f(shear)), abs(f(tension))), abs(f(flexure))])
         associate (a => self%joint(i)%lower, b => self%joint(i)%upper)
            call add_joint_forces(self%seen(a), self%seen(b), self%joint(i), f, g(:, a), g(:, b))
         end associate
      end do
      g(2, 1:) = g(2, 1:) - self%column%gravity*self%column%mass
      call add_loads(self, self%seen(n), load, .true., g, self%load_rate)
      if (self%column%held) then
         ! The held top takes the moment.
         g(3, n) = 0.0_wp
         self%load_rate = 0.0_wp
      end if
      self%scale = max(reach, [1.0_wp, self%column%upper(n)]*(abs(load(lateral)) &
                                                              + abs(self%column%axial_load)))
   end subroutine find_balance

   !> Add the inertia of the moving ground, and the loads at the top.
   pure subroutine add_loads(self, top, load, constant, g, rate)
      type(finite_stepper), intent(in) :: self
      !> The top body
      type(turned_body), intent(in) :: top
      real(wp), intent(in) :: load(signals)
      !> Whether loads that have a potential count too
      logical, intent(in) :: constant
      !> Forces on the bodies, which are added to (3, 0:n)
      real(wp), intent(inout) :: g(:, 0:)
      !> Derivative of the moment on the top body by its rotation
      real(wp), intent(out) :: rate
      real(wp) :: force(2)

      associate (column => self%column, n => self%column%n)
         g(1, 1:) = g(1, 1:) - load(horizontal)*column%mass
         g(2, 1:) = g(2, 1:) - load(vertical)*column%mass
         call column%find_top_force(load, constant, force)
         g(:, n) = g(:, n) + [force, column%upper(n)*sum(top%tb*force)]
         rate = column%upper(n)*sum(top%tb_rate*force)
      end associate
   end subroutine add_loads

   !> Find the correction that takes the residual away as far as the step is linear. The three displacements
   !> of a body end at `last`; before them is the axial force of its joint, if that does not open.
   subroutine correct(self, state)
      class(finite_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state
      real(wp) :: damping, of_mass, share, per_force
      integer :: i, last

      ! Mass and mass damping per square second of the step; share of the end of the step in the balance.
      damping = merge(self%column%mass_damping, 0.0_wp, state%motion%damped)
      share = 1.0_wp
      associate (by => self%by, h => self%h)
         if (self%average) then
            of_mass = 2.0_wp/h**2 + damping/h
         else
            share = 1.0_wp - by%alpha_f
            of_mass = (1.0_wp - by%alpha_m)/(by%beta*h**2) + share*damping*by%gamma/(by%beta*h)
         end if
      end associate
      ! The axial forces in units that make both kinds of equations alike.
      per_force = of_mass*maxval(self%column%mass)
      self%band = 0.0_wp
      do i = 1, self%column%n
         call add_joint_tangent(self, i, share, per_force)
      end do
      associate (main => self%band(2*self%half_width + 1, :), right => self%right(:, 1))
         do i = 1, self%column%n
            last = self%per*i
            main(last - 2:last) = main(last - 2:last) + of_mass*self%mass(:, i)
            right(last - 2:last) = self%r(:, i)
            if (.not. self%column%opens) right(last - 3) = -per_force*self%opening(i)
         end do
         main(last) = main(last) - share*self%load_rate
      end associate
      call solve_general_band(self%band, self%half_width, self%half_width, self%right, self%regular, &
                              self%pivot)
      do i = 1, self%column%n
         last = self%per*i
         self%dx(:, i) = self%right(last - 2:last, 1)
         if (.not. self%column%opens) self%dn(i) = per_force*self%right(last - 3, 1)
      end do
      if (self%regular) self%regular = maxval(abs(self%dx(3, :))) < most_rotation
   end subroutine correct

   !> Add the part of joint i to the tangent of the step.
   subroutine add_joint_tangent(self, i, share, per_force)
      type(finite_stepper), intent(inout) :: self
      integer, intent(in) :: i
      !> Share of the forces at the end of the step in the residual; unit of the axial forces
      real(wp), intent(in) :: share, per_force
      real(wp) :: tangent(local, local)
      integer :: at(local), j, l

      associate (joint => self%joint(i), main => 2*self%half_width + 1, per => self%per)
         call joint_tangent(self%seen(joint%lower), self%seen(joint%upper), joint, &
                            merge(0.5_wp, 1.0_wp, self%average), &
                            joint_values(self, self%f, i, self%reaction(i)), &
                            joint_values(self, self%k, i, 0.0_wp), .not. self%column%opens, tangent)
         tangent = share*tangent
         tangent(4, :) = tangent(4, :)*(per_force/share)
         tangent(:, 4) = tangent(:, 4)*per_force
         ! Places of the local coordinates; those of the ground, a held rotation, and axial forces of springs
         ! have none.
         at = 0
         if (joint%lower > 0) at(1:3) = per*joint%lower + [-2, -1, 0]
         if (.not. self%column%opens) at(4) = per*i - 3
         if (joint%sign < 0.0_wp) at(3) = 0
         if (joint%upper > 0) at(5:7) = per*joint%upper + [-2, -1, 0]
         do j = 1, local
            if (at(j) == 0) cycle
            do l = 1, local
               if (at(l) == 0) cycle
               self%band(main + at(l) - at(j), at(j)) = self%band(main + at(l) - at(j), at(j)) + tangent(l, j)
            end do
         end do
      end associate
   end subroutine add_joint_tangent

   !> Work of the residual on the correction [J].
   real(wp) function work_of_residual(self) result(work)
      class(finite_stepper), intent(in) :: self

      work = sum(self%r*self%dx)
   end function work_of_residual

   !> The end of the step becomes the state, the springs excepted; works of loads and damping in it are added.
   subroutine finish_step(self, state)
      type(finite_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state

      self%g0 = 0.0_wp
      ! Loads without a potential, in the mean of the step, do work on its displacements.
      call add_loads(self, self%turned(self%column%n), 0.5_wp*(state%load + self%load), .false., self%g0, &
                     self%load_rate)
      state%of_loads = state%of_loads + sum(self%g0*self%moved)
      if (state%motion%damped) then
         state%of_damping = state%of_damping + sum(self%viscous*self%change**2)/self%h &
                            + self%column%mass_damping*sum(self%mass*self%moved(:, 1:)**2)/self%h
         if (allocated(state%motion%modal)) then
            state%of_damping = state%of_damping + sum(self%change*matmul(state%motion%modal, self%change)) &
                               /self%h
         end if
      end if
      call locate_end(self)
      state%q(:) = self%q1
      state%v(:) = self%w1
      ! Kinetic energy that the velocities of the joints do not show
      state%along_joints = 0.5_wp*sum(self%mass*self%v1(:, 1:)**2) &
                           - self%column%kinetic_energy(state%q, state%v)
      state%time = state%time + self%h
      state%load = self%load
      self%largest = max(self%largest, self%scale)
      self%v0 = self%v1
      self%a0 = self%a1
      self%g0 = self%g1
   end subroutine finish_step

   !> Save or restore, whichever the stream is set to, the motion of the bodies at the start of a step, the
   !> axial forces of joints that do not open, and the scales of the residual.
   subroutine serialize(self, stream)
      class(finite_stepper), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%item(self%v0)
      call stream%item(self%a0)
      call stream%item(self%g0)
      call stream%item(self%reaction)
      call stream%item(self%largest)
   end subroutine serialize

end module rbs_solve_time_implicit_finite
