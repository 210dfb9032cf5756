!> The equation of an implicit step with exact rotations, in absolute coordinates of the centroids (x, y,
!> th): the mass is constant and diagonal, joints meet their neighbours only, and the tangent is a band.
!> Joints that do not open have their axial force as an unknown, and that they do not open as its equation.
!>
!> Average acceleration with mean-value derivatives balances the energy exactly for a step of any length,
!>
!>     M 2/h^2 (dx - h v_0) + sum B' f = Q,   v_1 = 2 dx/h - v_0,   f = (work of the spring)/(its change)
!>
!> and the generalised-alpha method has the forces of both ends of the step (see
!> `rbs_solve_time_implicit_balance`), with the axial forces among them (M. Arnold, O. Bruels, Multibody
!> Syst. Dyn. 18 (2007) 185-203).
module rbs_solve_time_finite_step
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_base_linalg, only: solve_general_band
   use rbs_structure_column_column, only: column_type
   use rbs_structure_column_finite, only: finite_chain_type
   use rbs_solve_time_finite_chain, only: finite_chain
   use rbs_solve_time_finite_joint, only: joint_forces, joint_tangent, local
   use rbs_loading_loads, only: lateral, horizontal, vertical, axial
   use rbs_solve_time_motion, only: motion_result
   use rbs_solve_time_state, only: state_type
   use rbs_structure_spring_place, only: shear, flexure, tension => axial
   implicit none
   private

   public :: finite_step

   !> Below this share of the forces a change of a spring's force is round-off.
   real(wp), parameter :: no_change = 1.0e-6_wp
   !> A change below this share of a deformation has few digits in it.
   real(wp), parameter :: no_digits = 1.0e-8_wp

   type, extends(finite_chain) :: finite_step
      !> Whether the forces are those of the mean-value derivatives; else the parameters of generalised-alpha
      logical :: average = .true.
      real(wp) :: alpha_m = 0.0_wp, alpha_f = 0.0_wp, beta = 0.25_wp, gamma = 0.5_wp
      !> The residual (3, n)
      real(wp), allocatable :: r(:, :)
      !> Axial forces of the joints, tension positive (n)
      real(wp), allocatable :: tension(:)
      !> Mass; accelerations and forces of the bodies at the start of the step and at its end (3, n)
      real(wp), allocatable, private :: mass(:, :), a0(:, :), g0(:, :), a1(:, :), g1(:, :)
      !> Forces of the joints, their derivatives and damping (unknowns)
      real(wp), allocatable, private :: f(:), k(:), viscous(:)
      !> Derivative of the load on the top body by its rotation
      real(wp), private :: load_rate(3) = 0.0_wp
      !> Largest force, moment of the present trial and of all steps so far
      real(wp), private :: scale(2) = 0.0_wp, largest(2) = 0.0_wp
      real(wp), allocatable, private :: band(:, :), right(:, :)
      integer, allocatable, private :: pivot(:)
      type(motion_result), private :: now
   contains
      procedure :: start
      procedure :: find_residual
      procedure :: find_correction
      procedure :: finish
      procedure :: serialize
   end type finite_step

contains

   !> Velocities and accelerations of the bodies at the start of the first step.
   subroutine start(self, state)
      class(finite_step), intent(inout) :: self
      type(state_type), intent(in) :: state
      integer :: m, n, size_of_band, beside

      select type (column => state%motion%structure)
      class is (finite_chain_type)
         call self%make_chain(column)
      end select
      n = self%column%n
      m = self%column%unknowns
      allocate (self%r(3, n), self%mass(3, n), self%a0(3, n), self%g0(3, n), self%a1(3, n), self%g1(3, n), &
                source=0.0_wp)
      allocate (self%tension(n), self%f(m), self%k(m), self%viscous(m), source=0.0_wp)
      size_of_band = merge(3, 4, self%column%opens)*n
      beside = beside_diagonal(self%column)
      allocate (self%band(3*beside + 1, size_of_band), self%right(size_of_band, 1), source=0.0_wp)
      allocate (self%pivot(size_of_band), source=0)
      associate (column => self%column)
         self%mass(1, :) = column%mass
         self%mass(2, :) = column%mass
         self%mass(3, :) = column%inertia
         call self%now%create(column)
         call state%motion%acceleration(state%springs, state%q, state%v, state%load, self%now)
         call column%accelerate(state%q, state%v, self%now%f, state%load, self%now%work, self%now%a)
         if (.not. column%opens) self%tension = self%now%work(:n)
      end associate
      call self%place(state)
      call self%body_velocities(state)
      if (self%column%held) self%v0(3, n) = 0.0_wp
      self%v1 = self%v0
      call self%see_end(self%column, state%q)
      call find_forces_at(self, state, state%q, state%v, state%load, 1.0_wp, self%g0)
      self%a0 = self%g0/self%mass
      self%largest = self%scale
   end subroutine start

   !> Save or restore what the bodies do at the start of a step.
   subroutine serialize(self, stream)
      class(finite_step), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%item(self%v0)
      call stream%item(self%a0)
      call stream%item(self%g0)
      call stream%item(self%tension)
      call stream%item(self%largest)
   end subroutine serialize

   !> Half-width of the band.
   pure integer function beside_diagonal(column) result(beside)
      class(column_type), intent(in) :: column

      beside = merge(5, 6, column%opens)
   end function beside_diagonal

   !> Residual of the step for what the bodies have moved, and its size relative to the forces. The springs
   !> are at the end of the step, or still at its start if their lines reach so far.
   subroutine find_residual(self, state, h, load, there, relative)
      class(finite_step), intent(inout) :: self
      type(state_type), intent(in) :: state
      real(wp), intent(in) :: h, load(4)
      !> Whether the springs are at the end of the step; their work is then counted from its start
      logical, intent(in) :: there
      real(wp), intent(out) :: relative
      integer :: n

      n = self%column%n
      if (self%average) then
         self%v1 = (2.0_wp/h)*self%moved - self%v0
         self%a1 = (2.0_wp/h**2)*(self%moved - h*self%v0)
         self%seen = self%turned
         call mean_forces(self, state, h, there)
         call balance(self, self%column, 0.5_wp*(state%load + load), self%r)
         self%r = self%r - self%mass*(self%a1 + (self%column%mass_damping/h)*self%moved)
      else
         self%a1 = (self%moved - h*self%v0 - (h**2*(0.5_wp - self%beta))*self%a0)/(self%beta*h**2)
         self%v1 = self%v0 + h*((1.0_wp - self%gamma)*self%a0 + self%gamma*self%a1)
         call self%see_end(self%column, self%q1)
         call find_forces_at(self, state, self%q1, self%w1, load, h, self%g1)
         self%r = (1.0_wp - self%alpha_f)*self%g1 + self%alpha_f*self%g0 &
                  - self%mass*((1.0_wp - self%alpha_m)*self%a1 + self%alpha_m*self%a0)
      end if
      self%scale(1) = max(self%scale(1), maxval(abs(self%mass(:2, :)*self%a1(:2, :))))
      self%scale(2) = max(self%scale(2), maxval(abs(self%mass(3, :)*self%a1(3, :))))
      relative = max(maxval(abs(self%r(:2, :)))/max(self%scale(1), self%largest(1), tiny(1.0_wp)), &
                     maxval(abs(self%r(3, :)))/max(self%scale(2), self%largest(2), tiny(1.0_wp)))
      if (.not. self%column%opens) then
         relative = max(relative, maxval(abs(self%gap))/maxval(self%column%length))
      end if
   end subroutine find_residual

   !> Forces of the joints that do exactly the work of springs and damping, and their derivatives.
   subroutine mean_forces(self, state, h, there)
      class(finite_step), intent(inout) :: self
      type(state_type), intent(in) :: state
      real(wp), intent(in) :: h
      logical, intent(in) :: there
      real(wp) :: finish, mean, moved
      integer :: i

      call find_damping(self, state)
      associate (springs => state%springs)
         do i = 1, size(self%f)
            finish = springs%f0(i) + springs%k(i)*(self%q1(i) - springs%d0(i))
            mean = springs%f0(i) + springs%k(i)*(0.5_wp*(self%q1(i) + state%q(i)) - springs%d0(i))
            self%k(i) = 0.5_wp*springs%k(i)
            ! A change that its deformation has no digits for is the one that the spring has made.
            moved = self%change(i)
            if (abs(moved) < no_digits*abs(state%q(i))) moved = self%q1(i) - state%q(i)
            if (there .and. abs(moved) > 0.0_wp) then
               mean = springs%work(i)/moved
               if (abs(finish - mean) > no_change*(abs(finish) + abs(mean))) then
                  self%k(i) = (finish - mean)/moved
               end if
            end if
            self%f(i) = mean + self%viscous(i)*self%change(i)/h
            self%k(i) = self%k(i) + self%viscous(i)/h
         end do
      end associate
      if (allocated(state%motion%modal)) self%f = self%f + matmul(state%motion%modal, self%change)/h
   end subroutine mean_forces

   !> Damping of the joints on their present lines.
   subroutine find_damping(self, state)
      class(finite_step), intent(inout) :: self
      type(state_type), intent(in) :: state

      if (self%column%tangent_damping) then
         self%viscous = self%column%stiffness_damping*max(state%springs%k, 0.0_wp)
      else if (state%motion%damped) then
         self%viscous = state%motion%joint_damping
      end if
   end subroutine find_damping

   !> Forces on the bodies at one state.
   subroutine find_forces_at(self, state, q, v, load, h, g)
      class(finite_step), intent(inout) :: self
      type(state_type), intent(in) :: state
      real(wp), intent(in), contiguous :: q(:), v(:)
      !> Loads, and length of the step
      real(wp), intent(in) :: load(4), h
      real(wp), intent(out) :: g(:, :)

      call find_damping(self, state)
      associate (springs => state%springs)
         self%f = springs%f0 + springs%k*(q - springs%d0) + self%viscous*v
         self%k = springs%k + self%viscous*(self%gamma/(self%beta*h))
      end associate
      if (allocated(state%motion%modal)) self%f = self%f + matmul(state%motion%modal, v)
      call balance(self, self%column, load, g)
      if (.not. self%column%mass_damping > 0.0_wp) return
      g = g - self%column%mass_damping*self%mass*self%v1
   end subroutine find_forces_at

   !> Loads less forces of the joints on the bodies, as the bodies are seen.
   subroutine balance(self, column, load, g)
      class(finite_step), intent(inout) :: self
      class(column_type), intent(in) :: column
      real(wp), intent(in) :: load(4)
      real(wp), intent(out) :: g(:, :)
      real(wp) :: f(3), ground(3), reach(2)
      integer :: i, n

      n = column%n
      g = 0.0_wp
      ground = 0.0_wp
      reach = 0.0_wp
      do i = 1, n
         f = forces_of(self, column, i)
         reach = max(reach, [max(abs(f(1)), abs(f(3))), abs(f(2))])
         if (i == n .and. column%held) then
            call joint_forces(self%seen(n), self%seen(n - 1), self%joint(n), -f, g(:, n), g(:, n - 1))
         else if (i > 1) then
            call joint_forces(self%seen(i - 1), self%seen(i), self%joint(i), f, g(:, i - 1), g(:, i))
         else
            call joint_forces(self%seen(0), self%seen(1), self%joint(1), f, ground, g(:, 1))
         end if
      end do
      g = -g
      g(1, :) = g(1, :) - load(horizontal)*column%mass
      g(2, :) = g(2, :) - (load(vertical) + column%gravity)*column%mass
      call load_top(self, column, load, g(:, n))
      if (column%held) then
         ! What holds the top takes its moment.
         g(3, n) = 0.0_wp
         self%load_rate = 0.0_wp
      end if
      self%scale = max(reach, [1.0_wp, column%upper(n)]*(abs(load(lateral)) + abs(column%axial_load)))
   end subroutine balance

   !> Shear, moment and axial force of a joint.
   pure function forces_of(self, column, i) result(f)
      class(finite_step), intent(in) :: self
      class(column_type), intent(in) :: column
      integer, intent(in) :: i
      real(wp) :: f(3)

      f = [self%f(column%at(shear, i)), self%f(column%at(flexure, i)), self%tension(i)]
      if (column%opens) f(3) = self%f(column%at(tension, i))
   end function forces_of

   !> Add the loads at the top to the forces on the last body. The weight of a mass lumped there is in the
   !> field of gravity, but belongs to the axial load: it is taken away again.
   subroutine load_top(self, column, load, g)
      class(finite_step), intent(inout) :: self
      class(column_type), intent(in) :: column
      real(wp), intent(in) :: load(4)
      real(wp), intent(inout) :: g(3)
      real(wp) :: force(2), rate(2), press

      associate (n => column%n, top => self%seen(column%n))
         press = column%axial_load + load(axial)
         force = [0.0_wp, -(column%weight(n) - column%gravity*column%mass(n))]
         rate = 0.0_wp
         if (column%axial_follows) then
            force = force - press*top%eb
            rate = rate - press*top%eb_rate
         else
            force(2) = force(2) - press
         end if
         if (column%force_follows) then
            force = force + load(lateral)*top%tb
            rate = rate + load(lateral)*top%tb_rate
         else
            force(1) = force(1) + load(lateral)
         end if
         g = g + [force, column%upper(n)*sum(top%tb*force)]
         self%load_rate = [rate, column%upper(n)*(sum(top%tb_rate*force) + sum(top%tb*rate))]
      end associate
   end subroutine load_top

   !> The correction that takes the residual away as far as the step is linear.
   subroutine find_correction(self, h, dx, dn, regular)
      class(finite_step), intent(inout) :: self
      real(wp), intent(in) :: h
      !> Of the bodies (3, n) and of the axial forces of joints that do not open (n)
      real(wp), intent(out) :: dx(:, :), dn(:)
      logical, intent(out) :: regular
      real(wp) :: tangent(local, local), of_mass, share, half, per_force, f(3), k(3)
      integer :: i, j, l, n, per, first, beside, at(local)

      associate (column => self%column)
         n = column%n
         per = merge(3, 4, column%opens)
         beside = beside_diagonal(column)
         if (self%average) then
            half = 0.5_wp
            share = 1.0_wp
            of_mass = 2.0_wp/h**2 + column%mass_damping/h
         else
            half = 1.0_wp
            share = 1.0_wp - self%alpha_f
            of_mass = (1.0_wp - self%alpha_m)/(self%beta*h**2) &
                      + share*column%mass_damping*self%gamma/(self%beta*h)
         end if
         ! The axial forces in units that make both kinds of equations alike.
         per_force = of_mass*maxval(column%mass)
         self%band = 0.0_wp
         first = 2*beside + 1
         do i = 1, n
            f = forces_of(self, column, i)
            k = [self%k(column%at(shear, i)), self%k(column%at(flexure, i)), 0.0_wp]
            if (column%opens) k(3) = self%k(column%at(tension, i))
            if (i == n .and. column%held) then
               call joint_tangent(self%seen(n), self%seen(n - 1), self%joint(n), half, -f, k, &
                                  .not. column%opens, tangent)
               call turn_about(tangent)
            else
               call joint_tangent(self%seen(i - 1), self%seen(i), self%joint(i), half, f, k, &
                                  .not. column%opens, tangent)
            end if
            tangent = share*tangent
            tangent(4, :) = tangent(4, :)*(per_force/share)
            tangent(:, 4) = tangent(:, 4)*per_force
            ! Places of the local coordinates; those of the ground, and axial forces of springs, have none.
            at = 0
            if (i > 1) at(1:3) = per*(i - 1) + [-2, -1, 0]
            if (.not. column%opens) at(4) = per*(i - 1) + 1
            at(5:7) = per*i + [-2, -1, 0]
            do j = 1, local
               if (at(j) == 0) cycle
               do l = 1, local
                  if (at(l) == 0) cycle
                  associate (place => self%band(first + at(l) - at(j), at(j)))
                     place = place + tangent(l, j)
                  end associate
               end do
            end do
         end do
         do i = 1, n
            do j = 1, 3
               l = per*i - 3 + j
               self%band(first, l) = self%band(first, l) + of_mass*self%mass(j, i)
               self%right(l, 1) = self%r(j, i)
            end do
            if (.not. column%opens) self%right(per*(i - 1) + 1, 1) = -per_force*self%gap(i)
         end do
         do j = 1, 3
            l = per*n - 3 + j
            associate (place => self%band(first + l - per*n, per*n))
               place = place - share*self%load_rate(j)
            end associate
         end do
         if (column%held) call hold_top(self%band, beside, of_mass*self%mass(3, n))
         call solve_general_band(self%band, beside, beside, self%right, regular, self%pivot)
         dn = 0.0_wp
         do i = 1, n
            dx(:, i) = self%right(per*i - 2:per*i, 1)
            if (.not. column%opens) dn(i) = per_force*self%right(per*(i - 1) + 1, 1)
         end do
      end associate
   end subroutine find_correction

   !> The tangent of a joint that was looked at from above, as it is from below: the bodies change places, and
   !> axial force and opening their signs.
   pure subroutine turn_about(tangent)
      real(wp), intent(inout) :: tangent(local, local)
      integer, parameter :: order(local) = [5, 6, 7, 4, 1, 2, 3]

      tangent = tangent(order, order)
      tangent(4, :) = -tangent(4, :)
      tangent(:, 4) = -tangent(:, 4)
   end subroutine turn_about

   !> Hold the last unknown of a general band: it couples with nothing.
   pure subroutine hold_top(band, beside, diagonal)
      !> (3 beside + 1, unknowns)
      real(wp), intent(inout) :: band(:, :)
      !> Half-width
      integer, intent(in) :: beside
      real(wp), intent(in) :: diagonal
      integer :: i, last, main

      last = size(band, 2)
      main = 2*beside + 1
      do i = max(1, last - beside), last - 1
         band(main + last - i, i) = 0.0_wp
         band(main + i - last, last) = 0.0_wp
      end do
      band(main, last) = diagonal
   end subroutine hold_top

   !> The end of the step becomes the state, the springs excepted.
   subroutine finish(self, state, h, load)
      class(finite_step), intent(inout) :: self
      type(state_type), intent(inout) :: state
      real(wp), intent(in) :: h, load(4)
      real(wp) :: mean(4), way(2)
      integer :: n

      associate (column => self%column)
         n = column%n
         mean = 0.5_wp*(state%load + load)
         state%of_loads = state%of_loads - sum(column%mass*(mean(horizontal)*self%moved(1, :) &
                                                            + mean(vertical)*self%moved(2, :)))
         associate (top => self%turned(n))
            way = self%moved(:2, n) + (column%upper(n)*self%moved(3, n))*top%tb
            if (column%axial_follows) then
               state%of_loads = state%of_loads - (column%axial_load + mean(axial))*sum(top%eb*way)
            else
               state%of_loads = state%of_loads - mean(axial)*way(2)
            end if
            if (column%force_follows) then
               state%of_loads = state%of_loads + mean(lateral)*sum(top%tb*way)
            else
               state%of_loads = state%of_loads + mean(lateral)*way(1)
            end if
         end associate
         if (state%motion%damped) then
            state%of_damping = state%of_damping + sum(self%viscous*self%change**2)/h &
                               + column%mass_damping*sum(self%mass*self%moved**2)/h
            if (allocated(state%motion%modal)) then
               state%of_damping = state%of_damping &
                                  + sum(self%change*matmul(state%motion%modal, self%change))/h
            end if
         end if
      end associate
      call self%see_end(self%column, self%q1)
      state%q(:) = self%q1
      state%v(:) = self%w1
      state%along_joints = 0.5_wp*sum(self%mass*self%v1**2) &
                           - self%column%kinetic_energy(state%q, state%v)
      state%time = state%time + h
      state%load = load
      self%largest = max(self%largest, self%scale)
      self%v0 = self%v1
      self%a0 = self%a1
      self%g0 = self%g1
   end subroutine finish

end module rbs_solve_time_finite_step
