!> Equation of motion of the column: forces on the bodies and accelerations of the joints at a state, on
!> the present lines of the springs.
!>
!>     M q'' + C q' + f(q) + K_G q = a F - b a_g        (small, pdelta: O(n) in centroid coordinates)
!>
!> With finite rotations M depends on q (paper, eq 4, without its last term in row 2, which is a misprint
!> and makes energy drift).
module rbs_solve_time_motion
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_column_axial, only: axial_energy
   use rbs_column_chain, only: body_forces, lift_forces, second_order_forces, joint_accelerations, &
                               joint_lifts, kinetic_of
   use rbs_column_column, only: column_type, small, finite
   use rbs_column_finite, only: finite_work, finite_acceleration, finite_kinetic, finite_potential, &
                                finite_power, finite_top
   use rbs_column_mass, only: symmetric_mass
   use rbs_hysteresis_springs, only: spring_array
   use rbs_solve_modal_modes, only: modes_type, find_modes
   use rbs_solve_time_loads, only: lateral, horizontal, vertical, axial
   implicit none
   private

   public :: motion_type

   type :: motion_type
      type(column_type) :: column
      !> Which of the four loads act (see `rbs_solve_time_loads`)
      logical :: acts(4) = .false.
      !> Damping of the joints, beta k0 (unknowns) [N s/m, N m s]
      real(wp), allocatable :: joint_damping(:)
      !> Modal damping (unknowns, unknowns); not allocated: none
      real(wp), allocatable :: modal(:, :)
      !> Whether there is damping at all, and whether any axial force does second-order work
      logical :: damped = .false., second_order = .false.
      !> Whether the power of the loads follows from velocity of the top and momentum alone
      logical :: plain = .false.
      !> Whether slip and rotation of one joint are all
      logical :: single = .false.
      !> Whether it is the column of the paper's eq 4: one body, finite rotation, dead loads
      logical :: equation_4 = .false.
      !> One over mass and rotary inertia of the bodies (n)
      real(wp), allocatable :: inverse_mass(:), inverse_inertia(:)
      !> Forces of the joints, springs and damping (unknowns); forces, torques and lifts on the bodies and
      !> their accelerations (n)
      real(wp), allocatable :: f(:), force(:), torque(:), lift(:), extra(:)
      !> Axial forces now, where they change in time (n) [N]
      real(wp), allocatable :: axial_body(:), axial_joint(:)
      type(finite_work), private :: work
      !> One body with finite rotation: the last angle asked for, its sine and cosine
      real(wp), private :: angle = 0.0_wp, sine = 0.0_wp, cosine = 1.0_wp
   contains
      procedure :: create
      procedure :: acceleration
      procedure :: find_body_forces
      procedure :: joint_forces
      procedure :: power
      procedure :: kinetic_energy
      procedure :: potential
      procedure :: top
      procedure :: top_displacement
      procedure :: top_velocity
      procedure :: momentum
   end type motion_type

contains

   subroutine create(self, column, acts, error)
      class(motion_type), intent(out) :: self
      type(column_type), intent(in) :: column
      !> Which of the loads act
      logical, intent(in) :: acts(4)
      type(error_type), allocatable, intent(out) :: error
      integer :: n, m

      n = column%n
      m = column%unknowns
      self%column = column
      self%acts = acts
      self%joint_damping = column%stiffness_damping*column%initial_stiffness
      self%damped = column%mass_damping > 0.0_wp .or. column%stiffness_damping > 0.0_wp
      if (allocated(column%modal_damping)) then
         call find_modal_damping(column, self%modal, error)
         if (allocated(error)) return
         self%damped = .true.
      end if
      self%second_order = column%kinematics /= small .and. &
                          (column%axially_loaded .or. acts(vertical) .or. acts(axial))
      self%plain = column%kinematics /= finite .and. .not. (self%damped .or. acts(vertical) .or. acts(axial))
      self%single = m == 2
      self%equation_4 = self%single .and. column%kinematics == finite .and. &
                        .not. (acts(vertical) .or. acts(axial) .or. column%axial_follows .or. &
                               column%force_follows)
      self%inverse_mass = 1.0_wp/column%mass
      self%inverse_inertia = 1.0_wp/column%inertia
      self%axial_body = column%axial_body
      self%axial_joint = column%axial_joint
      allocate (self%f(m), self%force(n), self%torque(n), self%lift(n), self%extra(n), source=0.0_wp)
      if (column%kinematics == finite) call self%work%create(n)
   end subroutine create

   !> C = sum_j 2 zeta_j omega_j (M s_j) (M s_j)', the modes s_j of the uncracked column.
   subroutine find_modal_damping(column, damping, error)
      type(column_type), intent(in) :: column
      real(wp), allocatable, intent(out) :: damping(:, :)
      type(error_type), allocatable, intent(out) :: error
      type(modes_type) :: modes
      real(wp), allocatable :: mass(:, :), carried(:, :)
      real(wp) :: ratio
      integer :: j, m

      m = column%unknowns
      call find_modes(column, modes, error)
      if (allocated(error)) return
      allocate (mass(m, m))
      allocate (damping(m, m), source=0.0_wp)
      call symmetric_mass(column, mass)
      carried = matmul(mass, modes%shapes)
      do j = 1, m
         ratio = 0.0_wp
         if (size(column%modal_damping) == 1) then
            ratio = column%modal_damping(1)
         else if (j <= size(column%modal_damping)) then
            ratio = column%modal_damping(j)
         end if
         carried(:, j) = sqrt(2.0_wp*ratio*modes%omega(j))*carried(:, j)
      end do
      damping = matmul(carried, transpose(carried))
   end subroutine find_modal_damping

   !> Forces of the joints: springs on their present lines, and damping.
   subroutine joint_forces(self, springs, q, v, f)
      class(motion_type), intent(in) :: self
      type(spring_array), intent(in) :: springs
      !> Deformations and their velocities (unknowns)
      real(wp), intent(in), contiguous :: q(:), v(:)
      !> Forces (unknowns) [N, N m]
      real(wp), intent(out), contiguous :: f(:)
      integer :: m

      m = self%column%unknowns
      call on_lines(m, springs%d0, springs%f0, springs%k, q, f)
      if (.not. self%damped) return
      if (self%column%tangent_damping) then
         f = f + self%column%stiffness_damping*max(springs%k, 0.0_wp)*v
      else
         f = f + self%joint_damping*v
      end if
      if (allocated(self%modal)) f = f + matmul(self%modal, v)
   end subroutine joint_forces

   pure subroutine on_lines(m, d0, f0, k, q, f)
      integer, intent(in) :: m
      real(wp), intent(in) :: d0(m), f0(m), k(m), q(m)
      real(wp), intent(out) :: f(m)

      f = f0 + k*(q - d0)
   end subroutine on_lines

   !> Forces and torques on the bodies, kept in `force`, `torque`, `lift` (small rotations); inertia of the
   !> moving ground and mass damping are not among them.
   subroutine find_body_forces(self, springs, q, v, load)
      class(motion_type), intent(inout) :: self
      type(spring_array), intent(in) :: springs
      real(wp), intent(in), contiguous :: q(:), v(:)
      !> Loads at the time
      real(wp), intent(in) :: load(4)
      integer :: n

      n = self%column%n
      call self%joint_forces(springs, q, v, self%f)
      associate (column => self%column)
         if (self%second_order) then
            if (self%acts(vertical) .or. self%acts(axial)) then
               self%axial_body = column%axial_body + load(axial) + load(vertical)*column%lifted_body
               self%axial_joint = column%axial_joint + load(axial) + load(vertical)*column%lifted_joint
            end if
            call second_order_forces(n, column%length, self%axial_body, self%axial_joint, q(:n), &
                                     q(n + 1:2*n), self%f(:n), self%extra)
         end if
         call body_forces(n, column%lower, column%upper, self%f(:n), self%f(n + 1:2*n), load(lateral), &
                          self%force, self%torque)
         if (self%second_order) self%torque = self%torque + self%extra
         if (column%opens) then
            call lift_forces(n, column%weight, self%f(2*n + 1:), column%axial_load + load(axial), self%lift)
         end if
      end associate
   end subroutine find_body_forces

   !> Accelerations of the joints. With small rotations those of the bodies, relative to the ground, are
   !> left in `force`, `torque`, `lift`.
   subroutine acceleration(self, springs, q, v, load, a)
      class(motion_type), intent(inout) :: self
      type(spring_array), intent(in) :: springs
      !> Deformations and their velocities (unknowns)
      real(wp), intent(in), contiguous :: q(:), v(:)
      !> Loads at the time
      real(wp), intent(in) :: load(4)
      !> Accelerations (unknowns)
      real(wp), intent(out), contiguous :: a(:)
      integer :: n

      n = self%column%n
      if (self%column%kinematics == finite) then
         call self%joint_forces(springs, q, v, self%f)
         if (self%equation_4) then
            call accelerate_equation_4(self, q, v, load, a)
         else
            call finite_acceleration(self%column, self%work, q, v, self%f, load, a)
         end if
         return
      end if
      if (self%plain .and. .not. (self%second_order .or. self%column%opens)) then
         call plain_accelerations(n, self%column%lower, self%column%upper, self%inverse_mass, &
                                  self%inverse_inertia, springs%d0, springs%f0, springs%k, q, load(lateral), &
                                  load(horizontal), self%f, self%force, self%torque, a)
         return
      end if
      call self%find_body_forces(springs, q, v, load)
      call divide(n, self%inverse_mass, self%inverse_inertia, load(horizontal), self%force, self%torque)
      call joint_accelerations(n, self%column%lower, self%column%upper, self%force, self%torque, &
                               a(:n), a(n + 1:2*n))
      if (self%column%opens) then
         self%lift = self%lift*self%inverse_mass - load(vertical)
         call joint_lifts(n, self%lift, a(2*n + 1:))
      end if
      if (self%column%mass_damping > 0.0_wp) a = a - self%column%mass_damping*v
   end subroutine acceleration

   !> One body, finite rotation: the paper's eq 4, corrected, with axial load and weight; s is the distance of
   !> the centroid from the joint.
   !>
   !>     m u'' + m s cos(th) th'' - m s sin(th) th'^2 + V = F - m a_g
   !>     m s cos(th) u'' + (I + m s^2) th'' + M = (F l - m s a_g) cos(th) + P l sin(th)
   subroutine accelerate_equation_4(self, q, v, load, a)
      class(motion_type), intent(inout) :: self
      real(wp), intent(in), contiguous :: q(:), v(:)
      real(wp), intent(in) :: load(4)
      real(wp), intent(out), contiguous :: a(:)
      real(wp) :: coupling, along, about, determinant

      self%angle = q(2)
      self%sine = sin(q(2))
      self%cosine = cos(q(2))
      associate (column => self%column, m => self%column%mass(1), inertia => self%column%inertia_above(1), &
                 moment => self%column%moment_above(1))
         coupling = moment*self%cosine
         along = load(lateral) - m*load(horizontal) - self%f(1) + moment*self%sine*v(2)**2
         about = (column%length(1)*load(lateral) - moment*load(horizontal))*self%cosine &
                 + column%axial_body(1)*column%length(1)*self%sine - self%f(2)
         if (column%mass_damping > 0.0_wp) then
            along = along - column%mass_damping*(m*v(1) + coupling*v(2))
            about = about - column%mass_damping*(coupling*v(1) + inertia*v(2))
         end if
         determinant = 1.0_wp/(m*inertia - coupling**2)
         a(1) = (inertia*along - coupling*about)*determinant
         a(2) = (m*about - coupling*along)*determinant
      end associate
   end subroutine accelerate_equation_4

   !> All of it in three loops, for the chain with small rotations, without damping and axial forces.
   pure subroutine plain_accelerations(n, lower, upper, inverse_mass, inverse_inertia, d0, f0, k, q, &
                                       lateral_force, ground, f, along, turning, a)
      integer, intent(in) :: n
      real(wp), intent(in) :: lower(n), upper(n), inverse_mass(n), inverse_inertia(n)
      !> Lines of the springs, and deformations
      real(wp), intent(in) :: d0(2*n), f0(2*n), k(2*n), q(2*n)
      real(wp), intent(in) :: lateral_force, ground
      !> Forces of the joints, accelerations of the bodies and of the joints
      real(wp), intent(out) :: f(2*n), along(n), turning(n), a(2*n)
      integer :: i

      do i = 1, 2*n
         f(i) = f0(i) + k(i)*(q(i) - d0(i))
      end do
      do i = 1, n - 1
         along(i) = (f(i + 1) - f(i))*inverse_mass(i) - ground
         turning(i) = ((f(n + i + 1) - f(n + i)) + (lower(i)*f(i) + upper(i)*f(i + 1)))*inverse_inertia(i)
      end do
      along(n) = (lateral_force - f(n))*inverse_mass(n) - ground
      turning(n) = ((lower(n)*f(n) + upper(n)*lateral_force) - f(2*n))*inverse_inertia(n)
      a(1) = along(1) - lower(1)*turning(1)
      a(n + 1) = turning(1)
      do i = 2, n
         a(i) = (along(i) - along(i - 1)) - (lower(i)*turning(i) + upper(i - 1)*turning(i - 1))
         a(n + i) = turning(i) - turning(i - 1)
      end do
   end subroutine plain_accelerations

   !> Accelerations of the bodies from their forces.
   pure subroutine divide(n, inverse_mass, inverse_inertia, ground, force, torque)
      integer, intent(in) :: n
      real(wp), intent(in) :: inverse_mass(n), inverse_inertia(n), ground
      real(wp), intent(inout) :: force(n), torque(n)

      force = force*inverse_mass - ground
      torque = torque*inverse_inertia
   end subroutine divide

   !> Power of the loads and of the damping [W].
   subroutine power(self, springs, q, v, load, of_loads, of_damping)
      class(motion_type), intent(in) :: self
      type(spring_array), intent(in) :: springs
      real(wp), intent(in), contiguous :: q(:), v(:)
      real(wp), intent(in) :: load(4)
      real(wp), intent(out) :: of_loads, of_damping

      if (self%equation_4 .and. .not. abs(self%angle - q(2)) > 0.0_wp) then
         ! The acceleration was asked for at the same state.
         of_loads = load(lateral)*(v(1) + self%column%length(1)*self%cosine*v(2)) &
                    - load(horizontal)*(self%column%mass(1)*v(1) &
                                        + self%column%moment_above(1)*self%cosine*v(2))
      else if (self%column%kinematics == finite) then
         of_loads = finite_power(self%column, q, v, load)
      else
         of_loads = self%top_velocity(v)*load(lateral) - self%momentum(v)*load(horizontal) &
                    + lifting_power(self, q, v, load)
      end if
      of_damping = 0.0_wp
      if (.not. self%damped) return
      if (self%column%tangent_damping) then
         of_damping = self%column%stiffness_damping*sum(max(springs%k, 0.0_wp)*v**2)
      else
         of_damping = sum(self%joint_damping*v**2)
      end if
      if (allocated(self%modal)) of_damping = of_damping + dot(v, matmul(self%modal, v))
      if (self%column%mass_damping > 0.0_wp) then
         of_damping = of_damping + 2.0_wp*self%column%mass_damping*self%kinetic_energy(q, v)
      end if
   end subroutine power

   !> Power of vertical ground motion and of the changing part of the axial load, small rotations [W].
   pure real(wp) function lifting_power(self, q, v, load) result(watt)
      class(motion_type), intent(in) :: self
      real(wp), intent(in), contiguous :: q(:), v(:)
      real(wp), intent(in) :: load(4)
      real(wp) :: rotation, turning, rising, body, joint
      integer :: i, n

      watt = 0.0_wp
      if (.not. (self%acts(vertical) .or. self%acts(axial))) return
      n = self%column%n
      rotation = 0.0_wp
      turning = 0.0_wp
      rising = 0.0_wp
      do i = 1, n
         body = load(axial) + load(vertical)*self%column%lifted_body(i)
         joint = load(axial) + load(vertical)*self%column%lifted_joint(i)
         if (self%second_order) watt = watt + joint*(v(i)*rotation + q(i)*turning)
         rotation = rotation + q(n + i)
         turning = turning + v(n + i)
         if (self%second_order) watt = watt + body*self%column%length(i)*rotation*turning
         if (self%column%opens) then
            rising = rising + v(2*n + i)
            watt = watt - self%column%mass(i)*load(vertical)*rising
         end if
      end do
      if (self%column%opens) watt = watt - load(axial)*rising
   end function lifting_power

   !> Kinetic energy relative to the ground [J].
   pure real(wp) function kinetic_energy(self, q, v) result(energy)
      class(motion_type), intent(in) :: self
      real(wp), intent(in), contiguous :: q(:), v(:)

      if (self%column%kinematics == finite) then
         energy = finite_kinetic(self%column, q, v)
      else
         energy = kinetic_of(self%column, v)
      end if
   end function kinetic_energy

   !> Potential of the constant axial load and the weight, zero for the straight column [J].
   pure real(wp) function potential(self, q) result(energy)
      class(motion_type), intent(in) :: self
      real(wp), intent(in), contiguous :: q(:)
      integer :: n

      n = self%column%n
      if (self%column%kinematics == finite) then
         energy = finite_potential(self%column, q)
         return
      end if
      energy = 0.0_wp
      if (self%column%axially_loaded) energy = axial_energy(self%column, q)
      if (self%column%opens) energy = energy + dot(self%column%axial_joint, q(2*n + 1:))
   end function potential

   !> Position of the top (x, y) [m].
   pure function top(self, q)
      class(motion_type), intent(in) :: self
      real(wp), intent(in), contiguous :: q(:)
      real(wp) :: top(2)
      real(wp) :: rotation
      integer :: i, n

      n = self%column%n
      if (self%column%kinematics == finite) then
         top = finite_top(self%column, q)
         return
      end if
      top(1) = self%top_velocity(q)
      top(2) = self%column%joint_height(n + 1)
      if (self%column%kinematics /= small) then
         ! To second order: what the axial load has done work on.
         rotation = 0.0_wp
         do i = 1, n
            top(2) = top(2) - q(i)*rotation
            rotation = rotation + q(n + i)
            top(2) = top(2) - 0.5_wp*self%column%length(i)*rotation**2
         end do
      end if
      if (self%column%opens) top(2) = top(2) + sum(q(2*n + 1:))
   end function top

   !> Displacement of the top [m].
   pure real(wp) function top_displacement(self, q) result(x)
      class(motion_type), intent(in) :: self
      real(wp), intent(in), contiguous :: q(:)
      real(wp) :: top(2)

      if (self%equation_4) then
         x = q(1) + self%column%length(1)*sin(q(2))
      else if (self%single .and. self%column%kinematics /= finite) then
         x = q(1) + self%column%length(1)*q(2)
      else if (self%column%kinematics == finite) then
         top = finite_top(self%column, q)
         x = top(1)
      else
         x = dot(self%column%arm, q)
      end if
   end function top_displacement

   !> Velocity of the top along x of velocities, or its displacement of deformations, small rotations.
   pure real(wp) function top_velocity(self, v)
      class(motion_type), intent(in) :: self
      real(wp), intent(in) :: v(:)

      top_velocity = dot(self%column%arm, v)
   end function top_velocity

   !> Momentum along x, relative to the ground, small rotations [kg m/s].
   pure real(wp) function momentum(self, v)
      class(motion_type), intent(in) :: self
      real(wp), intent(in) :: v(:)

      momentum = dot(self%column%ground_arm, v)
   end function momentum

   !> Inner product; four sums side by side do not wait for each other.
   pure real(wp) function dot(a, b)
      real(wp), intent(in) :: a(:), b(:)
      real(wp) :: part(4)
      integer :: i, m

      m = size(a)
      if (m == 2) then
         dot = a(1)*b(1) + a(2)*b(2)
         return
      end if
      part = 0.0_wp
      do i = 1, m - 3, 4
         part = part + a(i:i + 3)*b(i:i + 3)
      end do
      dot = (part(1) + part(2)) + (part(3) + part(4))
      do i = m - mod(m, 4) + 1, m
         dot = dot + a(i)*b(i)
      end do
   end function dot

end module rbs_solve_time_motion
