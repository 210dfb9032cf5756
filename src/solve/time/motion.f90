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
   use rbs_structure_column_chain, only: chain_accelerations, second_order_forces
   use rbs_structure_column_column, only: column_type, small, finite
   use rbs_hysteresis_springs, only: spring_array
   use rbs_solve_modal_matrices, only: modal_damping
   use rbs_loading_loads, only: lateral, horizontal, vertical, axial
   use rbs_structure_spring_place, only: shear, flexure
   use rbs_structure_structure, only: structure_type
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
      !> Small rotations: forces on the unknowns of the structure, without the inertia of the moving ground
      !> and without mass damping, and their accelerations relative to the ground (unknowns)
      real(wp), allocatable :: force(:), x(:)
      !> The latter where joints do not open, along x and in rotation (n)
      real(wp), allocatable :: along(:), turning(:)
      !> Second-order moments on the bodies (n)
      real(wp), allocatable, private :: moment(:)
      !> Axial forces that do second-order work at the time, in the order of the structure [N]
      real(wp), allocatable :: axial(:)
      real(wp), allocatable :: work(:)
   contains
      procedure :: create => create_result
   end type motion_result

   type :: motion_type
      class(column_type), pointer :: column => null()
      !> The same, as solvers see it
      class(structure_type), pointer :: structure => null()
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
      !> One over the mass or rotary inertia of each unknown, 0 for what is held (unknowns); the same of the
      !> bodies, by kind (n)
      real(wp), allocatable :: inverse(:), inverse_mass(:), inverse_inertia(:)
   contains
      procedure :: create
      procedure :: acceleration
      procedure :: forces_on_bodies
      procedure :: press
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
      class(column_type), intent(in) :: column

      allocate (self%a(column%unknowns), self%f(column%unknowns), self%force(column%unknowns), &
                self%x(column%unknowns), self%along(column%n), self%turning(column%n), &
                self%moment(column%n), source=0.0_wp)
      self%axial = [column%axial_body, column%axial_slip]
      allocate (self%work(column%work_size), source=0.0_wp)
   end subroutine create_result

   subroutine create(self, column, acts, error)
      class(motion_type), intent(out) :: self
      class(column_type), intent(in), target :: column
      !> Which of the loads act
      logical, intent(in) :: acts(4)
      type(error_type), allocatable, intent(out) :: error

      self%column => column
      self%structure => column
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
      self%inverse = merge(0.0_wp, 1.0_wp/column%inertias, column%is_held)
      self%inverse_mass = self%inverse(1:2*column%n:2)
      self%inverse_inertia = self%inverse(2:2*column%n:2)
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
      real(wp) :: of_speeds(2)

      if (self%column%kinematics == finite) then
         call joint_forces(self, springs, q, v, load, result%f)
         call self%column%accelerations(q, v, load, result%axial, result%f, result%work, result%a, of_speeds)
         return
      end if
      if (self%column%opens) then
         call self%forces_on_bodies(springs, q, v, load, result)
         call divide(size(q), 2*self%column%n, self%inverse, load(horizontal), load(vertical), result%force, &
                     result%x)
         call self%structure%spring_rates(result%x, result%a)
         result%along(self%column%n) = result%x(2*self%column%n - 1)
         result%turning(self%column%n) = result%x(2*self%column%n)
      else
         if (self%plain) then
            call on_lines(self%column%unknowns, springs%d0, springs%f0, springs%k, q, result%f)
         else
            call joint_forces(self, springs, q, v, load, result%f)
         end if
         if (self%second_order) then
            if (self%acts(vertical) .or. self%acts(axial)) call self%column%axial_forces(load, result%axial)
            call second_order_forces(self%column%n, self%column%length, result%axial, q, result%f, 1, &
                                     result%moment)
         end if
         call chain_accelerations(self%column%n, self%column%lower, self%column%upper, self%inverse_mass, &
                                  self%inverse_inertia, result%f, result%moment, load(lateral), &
                                  load(horizontal), result%along, result%turning, result%a)
      end if
      if (self%column%mass_damping > 0.0_wp) result%a = result%a - self%column%mass_damping*v
   end subroutine acceleration

   !> Forces of the joints and on the unknowns with small rotations: all of the result but the accelerations.
   subroutine forces_on_bodies(self, springs, q, v, load, result)
      class(motion_type), intent(in) :: self
      type(spring_array), intent(in) :: springs
      real(wp), intent(in), contiguous :: q(:), v(:)
      !> Loads at the time
      real(wp), intent(in) :: load(4)
      type(motion_result), intent(inout) :: result
      integer :: m

      call joint_forces(self, springs, q, v, load, result%f)
      m = 0
      if (self%second_order) then
         m = size(result%axial)
         if (self%acts(vertical) .or. self%acts(axial)) call self%structure%axial_forces(load, result%axial)
      end if
      call self%structure%forces(q, load, result%axial(:m), result%f, result%force)
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
            f(i) = f(i) - springs%centre(i)*(self%column%axial_force(i, load) - springs%press_at(i))
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

   !> Rate of the axial force at a spring [N/s].
   pure real(wp) function press_rate(self, spring, slope)
      class(motion_type), intent(in) :: self
      integer, intent(in) :: spring
      !> Slopes of the loads [per s]
      real(wp), intent(in) :: slope(4)

      press_rate = slope(axial) + slope(vertical)*self%column%lifted_joint(self%column%index_of(spring))
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
         springs%press_to(i) = self%column%axial_force(i, load)
      end do
   end subroutine press

   pure subroutine on_lines(m, d0, f0, k, q, f)
      integer, intent(in) :: m
      real(wp), intent(in) :: d0(m), f0(m), k(m), q(m)
      real(wp), intent(out) :: f(m)

      f = f0 + k*(q - d0)
   end subroutine on_lines

   !> Accelerations of the bodies from their forces.
   pure subroutine divide(m, last, inverse, ground, upward, force, x)
      !> Number of unknowns, and the last that is a displacement along x or a rotation
      integer, intent(in) :: m, last
      !> Accelerations of the ground
      real(wp), intent(in) :: inverse(m), ground, upward, force(m)
      real(wp), intent(out) :: x(m)
      integer :: i

      do i = 1, last, 2
         x(i) = force(i)*inverse(i) - ground
         x(i + 1) = force(i + 1)*inverse(i + 1)
      end do
      do i = last + 1, m
         x(i) = force(i)*inverse(i) - upward
      end do
   end subroutine divide

   !> Power of the loads at a state [W].
   real(wp) function load_power(self, q, v, load) result(watt)
      class(motion_type), intent(in) :: self
      real(wp), intent(in), contiguous :: q(:), v(:)
      real(wp), intent(in) :: load(4)

      if (self%column%kinematics == finite) then
         watt = self%column%power_of_loads(q, v, load)
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
         watt = watt + 2.0_wp*self%column%mass_damping*self%column%kinetic_energy(q, v)
      end if
   end function damping_power

   !> Power of vertical ground motion and of the changing part of the axial load, small rotations [W].
   pure real(wp) function lifting_power(self, q, v, load) result(watt)
      class(motion_type), intent(in) :: self
      real(wp), intent(in), contiguous :: q(:), v(:)
      real(wp), intent(in) :: load(4)

      watt = 0.0_wp
      if (self%acts(vertical) .or. self%acts(axial)) watt = self%column%power_of_lifts(q, v, load)
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

      base = [force_at(self, springs, q, v, self%column%at(shear, 1)), &
              force_at(self, springs, q, v, self%column%at(flexure, 1))]
      if (self%column%mass_damping > 0.0_wp) then
         base = base + self%column%mass_damping*self%column%momentum_at_foot(q, v)
      end if
   end function base_reaction

   !> The shear force alone; asked for in every step.
   function base_shear(self, springs, q, v) result(force)
      class(motion_type), intent(in) :: self
      type(spring_array), intent(in) :: springs
      real(wp), intent(in), contiguous :: q(:), v(:)
      real(wp) :: force, momentum(2)

      force = force_at(self, springs, q, v, self%column%at(shear, 1))
      if (.not. self%damped) return
      if (self%column%mass_damping > 0.0_wp) then
         momentum = self%column%momentum_at_foot(q, v)
         force = force + self%column%mass_damping*momentum(1)
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
