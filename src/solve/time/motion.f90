!> Equation of motion of the column: forces on the bodies and accelerations of the joints at a state, on
!> the present lines of the springs.
!>
!>     M q'' + C q' + f(q) + K_G q = a F - b a_g        (small, pdelta: O(n) in centroid coordinates)
!>
!> With finite rotations M depends on q (paper, eq 4, without its last term in row 2, which is a misprint
!> and makes energy drift).
!>
!> A motion does not change once it has been created: all that `acceleration` finds is in its result.
module rbs_solve_time_motion
   use rbs_base_error, only: error_type
   use rbs_base_inner_product, only: inner_product
   use rbs_base_kinds, only: wp
   use rbs_column_chain, only: body_forces, lift_forces, second_order_forces, joint_accelerations, joint_lifts
   use rbs_column_column, only: column_type, small, finite
   use rbs_column_energy, only: kinetic_energy
   use rbs_column_finite, only: finite_work, finite_acceleration, finite_power
   use rbs_column_momentum, only: momentum_at_foot
   use rbs_hysteresis_springs, only: spring_array
   use rbs_solve_modal_damping, only: modal_damping
   use rbs_loading_loads, only: lateral, horizontal, vertical, axial
   implicit none
   private

   public :: motion_type, motion_result

   !> What the equation of motion gives at one state. `create` allocates it once, before the first step.
   type :: motion_result
      !> Accelerations of the joints (unknowns) [m/s2, rad/s2]
      real(wp), allocatable :: a(:)
      !> Forces of the joints: springs, damping and, with small rotations, the second-order share of the axial
      !> forces (unknowns) [N, N m, N]
      real(wp), allocatable :: f(:)
      !> Small rotations: forces, torques and lifts on the bodies, without the inertia of the moving ground
      !> and without mass damping (n) [N, N m, N]
      real(wp), allocatable :: force(:), torque(:), lift(:)
      !> Small rotations: accelerations of the bodies relative to the ground, along x, in rotation and
      !> upward (n)
      real(wp), allocatable :: along(:), turning(:), upward(:)
      !> Axial forces of the bodies and across the slips of the joints at the time (n) [N]
      real(wp), allocatable :: axial_body(:), axial_joint(:)
      !> Cosine of the rotation, where the equation is the paper's eq 4
      real(wp) :: cosine = 1.0_wp
      !> Work arrays
      real(wp), allocatable, private :: second_order(:)
      type(finite_work), private :: work
   contains
      procedure :: create => create_result
   end type motion_result

   type :: motion_type
      type(column_type) :: column
      !> Which of the four loads act (see `rbs_loading_loads`)
      logical :: acts(4) = .false.
      !> Damping of the joints, beta k0 (unknowns) [N s/m, N m s]
      real(wp), allocatable :: joint_damping(:)
      !> Modal damping (unknowns, unknowns); allocated only if there is any
      real(wp), allocatable :: modal(:, :)
      !> Whether there is damping at all, and whether any axial force does second-order work
      logical :: damped = .false., second_order = .false.
      !> Whether the power of the loads follows from velocity of the top and momentum alone
      logical :: plain = .false.
      !> Whether slip and rotation of one joint are the only unknowns
      logical :: single = .false.
      !> Whether it is the column of the paper's eq 4: one body, finite rotation, dead loads
      logical :: equation_4 = .false.
      !> One over mass and rotary inertia of the bodies (n)
      real(wp), allocatable :: inverse_mass(:), inverse_inertia(:)
   contains
      procedure :: create
      procedure :: acceleration
      procedure :: forces_on_bodies
      procedure :: press
      procedure :: axial_force
      procedure :: press_rate
      procedure :: load_power
      procedure :: lifting_power
      procedure :: damping_power
      procedure :: top_velocity
      procedure :: momentum
      procedure :: base_shear
      procedure :: base_reaction
   end type motion_type

contains

   subroutine create_result(self, column)
      class(motion_result), intent(out) :: self
      type(column_type), intent(in) :: column

      allocate (self%a(column%unknowns), self%f(column%unknowns), source=0.0_wp)
      allocate (self%force(column%n), self%torque(column%n), self%lift(column%n), self%along(column%n), &
                self%turning(column%n), self%upward(column%n), self%second_order(column%n), source=0.0_wp)
      self%axial_body = column%axial_body
      self%axial_joint = column%axial_slip
      if (column%kinematics == finite) call self%work%create(column%n)
   end subroutine create_result

   subroutine create(self, column, acts, error)
      class(motion_type), intent(out) :: self
      type(column_type), intent(in) :: column
      !> Which of the loads act
      logical, intent(in) :: acts(4)
      type(error_type), allocatable, intent(out) :: error

      self%column = column
      self%acts = acts
      self%joint_damping = column%stiffness_damping*column%initial_stiffness
      self%damped = column%damped
      if (allocated(column%modal_damping)) then
         call modal_damping(column, self%modal, error)
         if (allocated(error)) return
      end if
      self%second_order = column%kinematics /= small .and. &
                          (column%axially_loaded .or. acts(vertical) .or. acts(axial))
      self%plain = column%kinematics /= finite .and. .not. (self%damped .or. acts(vertical) .or. acts(axial))
      self%single = column%unknowns == 2
      self%equation_4 = self%single .and. column%kinematics == finite .and. &
                        .not. (acts(vertical) .or. acts(axial) .or. column%axial_follows .or. &
                               column%force_follows)
      self%inverse_mass = 1.0_wp/column%mass
      self%inverse_inertia = 1.0_wp/column%inertia
      if (column%held) self%inverse_inertia(column%n) = 0.0_wp
   end subroutine create

   !> Accelerations of the joints at a state, and what they follow from.
   subroutine acceleration(self, springs, q, v, load, result)
      class(motion_type), intent(in) :: self
      type(spring_array), intent(in) :: springs
      !> Deformations and their velocities (unknowns)
      real(wp), intent(in), contiguous :: q(:), v(:)
      !> Loads at the time
      real(wp), intent(in) :: load(4)
      type(motion_result), intent(inout) :: result
      integer :: n

      n = self%column%n
      if (self%column%kinematics == finite) then
         call joint_forces(self, springs, q, v, load, result%f)
         if (self%equation_4) then
            call accelerate_equation_4(self, q, v, load, result%f, result%a, result%cosine)
         else
            call finite_acceleration(self%column, result%work, q, v, result%f, load, result%a)
         end if
         return
      end if
      if (self%plain .and. .not. (self%second_order .or. self%column%opens)) then
         call plain_accelerations(n, self%column%lower, self%column%upper, self%inverse_mass, &
                                  self%inverse_inertia, springs%d0, springs%f0, springs%k, q, load(lateral), &
                                  load(horizontal), result%f, result%along, result%turning, result%a)
         return
      end if
      call self%forces_on_bodies(springs, q, v, load, result)
      call divide(n, self%inverse_mass, self%inverse_inertia, load(horizontal), result%force, result%torque, &
                  result%along, result%turning)
      call joint_accelerations(n, self%column%lower, self%column%upper, result%along, result%turning, &
                               result%a(:n), result%a(n + 1:2*n))
      if (self%column%opens) then
         result%upward = result%lift*self%inverse_mass - load(vertical)
         call joint_lifts(n, result%upward, result%a(2*n + 1:))
      end if
      if (self%column%mass_damping > 0.0_wp) result%a = result%a - self%column%mass_damping*v
   end subroutine acceleration

   !> Forces of the joints and on the bodies with small rotations: all of the result but the accelerations.
   subroutine forces_on_bodies(self, springs, q, v, load, result)
      class(motion_type), intent(in) :: self
      type(spring_array), intent(in) :: springs
      real(wp), intent(in), contiguous :: q(:), v(:)
      !> Loads at the time
      real(wp), intent(in) :: load(4)
      type(motion_result), intent(inout) :: result
      integer :: n

      n = self%column%n
      call joint_forces(self, springs, q, v, load, result%f)
      associate (column => self%column)
         if (self%second_order) then
            if (self%acts(vertical) .or. self%acts(axial)) then
               result%axial_body = column%axial_body + load(axial)*column%axial_lever &
                                   + load(vertical)*column%lifted_body
               result%axial_joint = column%axial_slip + load(axial)*column%axial_lever &
                                    + load(vertical)*column%lifted_joint
               if (column%held) result%axial_joint(n) = 0.0_wp
            end if
            call second_order_forces(n, column%length, result%axial_body, result%axial_joint, q(:n), &
                                     q(n + 1:2*n), result%f(:n), result%second_order)
         end if
         call body_forces(n, column%lower, column%upper, result%f(:n), result%f(n + 1:2*n), load(lateral), &
                          result%force, result%torque)
         if (self%second_order) result%torque = result%torque + result%second_order
         if (column%opens) then
            call lift_forces(n, column%weight, result%f(2*n + 1:), column%axial_load + load(axial), &
                             result%lift)
         end if
      end associate
   end subroutine forces_on_bodies

   !> Forces of the joints: springs on their present lines, and damping.
   subroutine joint_forces(self, springs, q, v, load, f)
      class(motion_type), intent(in) :: self
      type(spring_array), intent(in) :: springs
      real(wp), intent(in), contiguous :: q(:), v(:)
      !> Loads at the time
      real(wp), intent(in) :: load(4)
      !> Forces (unknowns) [N, N m]
      real(wp), intent(out), contiguous :: f(:)
      integer :: i, j

      call on_lines(self%column%unknowns, springs%d0, springs%f0, springs%k, q, f)
      if (springs%pressed) then
         do j = 1, size(springs%layered)
            i = springs%layered(j)
            f(i) = f(i) - springs%centre(i)*(self%axial_force(i - self%column%n, load) - springs%press_at(i))
         end do
      end if
      if (.not. self%damped) return
      if (self%column%tangent_damping) then
         f = f + self%column%stiffness_damping*max(springs%k, 0.0_wp)*v
      else
         f = f + self%joint_damping*v
      end if
      if (allocated(self%modal)) f = f + modal_forces(size(v), self%modal, v)
   end subroutine joint_forces

   !> Forces of the modal damping, summed in the order that lanes of ensembles have too.
   pure function modal_forces(m, modal, v) result(f)
      integer, intent(in) :: m
      real(wp), intent(in) :: modal(m, m), v(m)
      real(wp) :: f(m)
      integer :: j

      f = 0.0_wp
      do j = 1, m
         f = f + modal(:, j)*v(j)
      end do
   end function modal_forces

   !> Axial force in a joint from axial load, weight and vertical motion, compression positive [N].
   pure real(wp) function axial_force(self, joint, load)
      class(motion_type), intent(in) :: self
      integer, intent(in) :: joint
      real(wp), intent(in) :: load(4)

      axial_force = self%column%compression(joint) + load(axial) &
                    + load(vertical)*self%column%lifted_joint(joint)
   end function axial_force

   !> Rate of the axial force in a joint [N/s].
   pure real(wp) function press_rate(self, joint, slope)
      class(motion_type), intent(in) :: self
      integer, intent(in) :: joint
      !> Slopes of the loads [per s]
      real(wp), intent(in) :: slope(4)

      press_rate = slope(axial) + slope(vertical)*self%column%lifted_joint(joint)
   end function press_rate

   !> Tell layered joints the axial forces that their next move leads to.
   subroutine press(self, springs, load)
      class(motion_type), intent(in) :: self
      type(spring_array), intent(inout) :: springs
      !> Loads at the end of the move
      real(wp), intent(in) :: load(4)
      integer :: i, j

      if (.not. springs%pressed) return
      do j = 1, size(springs%layered)
         i = springs%layered(j)
         springs%press_to(i) = self%axial_force(i - self%column%n, load)
      end do
   end subroutine press

   pure subroutine on_lines(m, d0, f0, k, q, f)
      integer, intent(in) :: m
      real(wp), intent(in) :: d0(m), f0(m), k(m), q(m)
      real(wp), intent(out) :: f(m)

      f = f0 + k*(q - d0)
   end subroutine on_lines

   !> The whole acceleration in three loops, for the chain with small rotations, without damping and axial
   !> forces.
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
   pure subroutine divide(n, inverse_mass, inverse_inertia, ground, force, torque, along, turning)
      integer, intent(in) :: n
      real(wp), intent(in) :: inverse_mass(n), inverse_inertia(n), ground, force(n), torque(n)
      real(wp), intent(out) :: along(n), turning(n)

      along = force*inverse_mass - ground
      turning = torque*inverse_inertia
   end subroutine divide

   !> One body, finite rotation: the paper's eq 4, corrected, with axial load and weight; s is the distance of
   !> the centroid from the joint.
   !>
   !>     m u'' + m s cos(th) th'' - m s sin(th) th'^2 + V = F - m a_g
   !>     m s cos(th) u'' + (I + m s^2) th'' + M = (F l - m s a_g) cos(th) + P l sin(th)
   pure subroutine accelerate_equation_4(self, q, v, load, f, a, cosine)
      type(motion_type), intent(in) :: self
      !> Deformations, velocities and forces of the joint
      real(wp), intent(in) :: q(2), v(2), f(2)
      real(wp), intent(in) :: load(4)
      !> Accelerations, and the cosine of the rotation
      real(wp), intent(out) :: a(2), cosine
      real(wp) :: sine, coupling, along, about, determinant

      sine = sin(q(2))
      cosine = cos(q(2))
      associate (column => self%column, m => self%column%mass(1), inertia => self%column%inertia_above(1), &
                 moment => self%column%moment_above(1))
         coupling = moment*cosine
         along = load(lateral) - m*load(horizontal) - f(1) + moment*sine*v(2)**2
         about = (column%length(1)*load(lateral) - moment*load(horizontal))*cosine &
                 + column%axial_body(1)*column%length(1)*sine - f(2)
         if (column%mass_damping > 0.0_wp) then
            along = along - column%mass_damping*(m*v(1) + coupling*v(2))
            about = about - column%mass_damping*(coupling*v(1) + inertia*v(2))
         end if
         determinant = 1.0_wp/(m*inertia - coupling**2)
         a(1) = (inertia*along - coupling*about)*determinant
         a(2) = (m*about - coupling*along)*determinant
      end associate
   end subroutine accelerate_equation_4

   !> Power of the loads at a state [W].
   real(wp) function load_power(self, q, v, load, result) result(watt)
      class(motion_type), intent(in) :: self
      real(wp), intent(in), contiguous :: q(:), v(:)
      real(wp), intent(in) :: load(4)
      !> What `acceleration` gave at the same deformations
      type(motion_result), intent(in) :: result

      if (self%equation_4) then
         watt = load(lateral)*(v(1) + self%column%length(1)*result%cosine*v(2)) &
                - load(horizontal)*(self%column%mass(1)*v(1) &
                                    + self%column%moment_above(1)*result%cosine*v(2))
      else if (self%column%kinematics == finite) then
         watt = finite_power(self%column, q, v, load)
      else
         watt = self%top_velocity(v)*load(lateral) - self%momentum(v)*load(horizontal) &
                + self%lifting_power(q, v, load)
      end if
   end function load_power

   !> Power of the damping [W].
   real(wp) function damping_power(self, springs, q, v) result(watt)
      class(motion_type), intent(in) :: self
      type(spring_array), intent(in) :: springs
      real(wp), intent(in), contiguous :: q(:), v(:)

      watt = 0.0_wp
      if (.not. self%damped) return
      if (self%column%tangent_damping) then
         watt = self%column%stiffness_damping*sum(max(springs%k, 0.0_wp)*v**2)
      else
         watt = sum(self%joint_damping*v**2)
      end if
      if (allocated(self%modal)) watt = watt + inner_product(size(v), v, modal_forces(size(v), self%modal, v))
      if (self%column%mass_damping > 0.0_wp) then
         watt = watt + 2.0_wp*self%column%mass_damping*kinetic_energy(self%column, q, v)
      end if
   end function damping_power

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
         body = load(axial)*self%column%axial_lever + load(vertical)*self%column%lifted_body(i)
         joint = load(axial)*self%column%axial_lever + load(vertical)*self%column%lifted_joint(i)
         if (i == n .and. self%column%held) joint = 0.0_wp
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

   !> Velocity of the top along x, small rotations [m/s].
   pure real(wp) function top_velocity(self, v)
      class(motion_type), intent(in) :: self
      real(wp), intent(in), contiguous :: v(:)

      top_velocity = inner_product(size(v), self%column%arm, v)
   end function top_velocity

   !> Momentum along x, relative to the ground, small rotations [kg m/s].
   pure real(wp) function momentum(self, v)
      class(motion_type), intent(in) :: self
      real(wp), intent(in), contiguous :: v(:)

      momentum = inner_product(size(v), self%column%ground_arm, v)
   end function momentum

   !> What the ground holds the column with: shear and moment of the lowest joint and of the damping, that
   !> between the bodies and the ground included [N, N m].
   function base_reaction(self, springs, q, v) result(base)
      class(motion_type), intent(in) :: self
      type(spring_array), intent(in) :: springs
      real(wp), intent(in), contiguous :: q(:), v(:)
      real(wp) :: base(2)

      base = [force_at(self, springs, q, v, 1), force_at(self, springs, q, v, self%column%n + 1)]
      if (self%column%mass_damping > 0.0_wp) then
         base = base + self%column%mass_damping*momentum_at_foot(self%column, q, v)
      end if
   end function base_reaction

   !> The shear force alone; asked for in every step.
   function base_shear(self, springs, q, v) result(shear)
      class(motion_type), intent(in) :: self
      type(spring_array), intent(in) :: springs
      real(wp), intent(in), contiguous :: q(:), v(:)
      real(wp) :: shear, momentum(2)

      shear = force_at(self, springs, q, v, 1)
      if (.not. self%damped) return
      if (self%column%mass_damping > 0.0_wp) then
         momentum = momentum_at_foot(self%column, q, v)
         shear = shear + self%column%mass_damping*momentum(1)
      end if
   end function base_shear

   !> Force of a spring on its line, and of the damping beside it.
   function force_at(self, springs, q, v, place) result(force)
      class(motion_type), intent(in) :: self
      type(spring_array), intent(in) :: springs
      real(wp), intent(in), contiguous :: q(:), v(:)
      integer, intent(in) :: place
      real(wp) :: force

      force = springs%f0(place) + springs%k(place)*(q(place) - springs%d0(place))
      if (.not. self%damped) return
      if (self%column%tangent_damping) then
         force = force + self%column%stiffness_damping*max(springs%k(place), 0.0_wp)*v(place)
      else
         force = force + self%joint_damping(place)*v(place)
      end if
      ! The matrix is symmetric: its columns lie together.
      if (allocated(self%modal)) force = force + inner_product(size(v), self%modal(:, place), v)
   end function force_at

end module rbs_solve_time_motion
