!> The chain of rigid bodies: geometry, mass, axial load, and the springs of its joints.
!>
!> Unknowns q = (slip of joint 1..n, relative rotation of joint 1..n [, opening of joint 1..n]); openings
!> take part only where the joints have axial springs. Joint i is at the bottom of body i; rotations are
!> clockwise, so that a positive one moves the top to +x. A mass lumped at the top is part of the last
!> body: it moves its centroid and adds to its inertia, and costs nothing.
!>
!> Ends other than a rigid ground and a free top are bodies of the same chain. A footing is its first body. A
!> top fixed against rotation is its last one, without length, whose rotation is held: the joint between
!> it and the body below turns by minus the rotation of that body, and its moment holds the top. That joint
!> is the lowest one turned about the middle of the column: it slips and opens along the directions of the
!> body above it, which are fixed.
module rbs_structure_column_column
   use rbs_base_error, only: error_type, fatal_error, bad_input
   use rbs_base_inner_product, only: inner_product
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_base_tolerances, only: round_off, same_input
   use rbs_structure_condensation, only: series_tangent
   use rbs_structure_channel, only: channel_type, response_type, row_contents
   use rbs_structure_column_chain, only: deformations, displacements, joint_forces, second_order_forces, &
                                         geometric_forces, second_order_energy, add_joint_stiffness, &
                                         add_axial_stiffness
   use rbs_structure_column_sturm, only: sturm_chain, sturm_chain_of
   use rbs_structure_dynamic_stiffness, only: dynamic_stiffness
   use rbs_hysteresis_interaction_joints, only: opening_of, rest_of
   use rbs_hysteresis_springs, only: spring_array
   use rbs_structure_spring_location, only: shear, flexure, axial
   use rbs_structure_structure, only: structure_type, motion_result, accelerate_unknowns, &
                                      power_of_patterns, small, pdelta, &
                                      finite, lateral, horizontal, vertical, top_axial, sideways, signals
   implicit none
   private

   public :: column_type
   public :: small, pdelta, finite, column_channel

   !> Channels of a column besides those of all structures; some only where joints have axial
   !> springs, in time where there is damping, on demand how the top moves, and layered joints. Without
   !> `base_shear` and `base_moment` the base has the forces of the lowest joint. The motion is that of
   !> the top relative to the ground. Openings of layered joints are those at the middle of their
   !> sections; `rest` is the rotation at which they rest under their first axial load.
   type(channel_type), parameter :: column_channel(14) = [ &
      channel_type('top_height', 'm'), channel_type('slip', 'm'), channel_type('rotation', 'rad'), &
      channel_type('opening', 'm'), channel_type('shear', 'N'), channel_type('moment', 'N m'), &
      channel_type('axial_force', 'N'), channel_type('base_shear', 'N'), channel_type('base_moment', 'N m'), &
      channel_type('velocity', 'm/s'), channel_type('acceleration', 'm/s2'), &
      channel_type('ground_acceleration', 'm/s2'), channel_type('opening', 'm'), channel_type('rest', 'rad')]

   type, extends(structure_type) :: column_type
      ! The unknowns, as many as springs, are 2 n or, with axial springs, 3 n
      !> Kinds of deformations of a joint: slip, rotation and, with axial springs, opening. Deformations are
      !> kept by kind, (n, kinds)
      integer :: kinds = 2
      !> Whether joints have axial springs and open
      logical :: opens = .false.
      !> Whether the first body is a footing, so that its joint is joint 0, and whether the last body is held
      !> against rotation
      logical :: footing = .false., held = .false.
      !> Masses [kg] and rotary inertias about the centroid [kg m2] of the bodies (n); distance of the
      !> centroid from the bottom and from the top of its body (n) [m]
      real(wp), allocatable :: mass(:), inertia(:), lower(:), upper(:)
      !> Height of the joints above the ground (n + 1) [m]; the last is the top
      real(wp), allocatable :: joint_height(:)
      !> Sums over the bodies from i up (n + 1): mass, first and second moment of mass about joint i,
      !> rotary inertia included [kg, kg m, kg m2]
      real(wp), allocatable :: mass_above(:), moment_above(:), inertia_above(:)
      !> Acceleration of gravity that gives the bodies their weight, 0 without self-weight [m/s2]
      real(wp) :: gravity = 0.0_wp
      !> Height at which the axial load acts over the height of the column
      real(wp) :: axial_lever = 1.0_wp
      !> Weight of the bodies (n) [N]
      real(wp), allocatable :: weight(:)
      !> Axial force of load and weight for the rotation of body i, and across the slip of joint i,
      !> compression positive (n) [N]
      real(wp), allocatable :: axial_body(:), axial_joint(:)
      !> The latter as far as it does second-order work on slips: not where they keep their direction (n) [N]
      real(wp), allocatable :: axial_slip(:)
      !> Axial forces in second-order work: `axial_body` times the lengths, then `axial_slip` (2 n) [N m, N]
      real(wp), allocatable :: second_order(:)
      !> The same of a unit of axial force (2 n) [m, -]
      real(wp), allocatable :: unit_axial(:)
      !> Axial force of load and weight in the joints of the straight column, compression positive (n) [N]
      real(wp), allocatable :: compression(:)
      !> The same per vertical acceleration of the ground, from all masses (n) [kg]
      real(wp), allocatable :: lifted_body(:), lifted_joint(:)
      !> One over the mass or rotary inertia of each body, 0 for a rotation that is held (n)
      real(wp), allocatable :: inverse_mass(:), inverse_inertia(:)
      !> Number of the spring of a kind in a joint, from the bottom up (3, n); 0: there is none
      integer, allocatable :: at(:, :)
   contains
      procedure :: spring_rates, unknown_rates, forces, axial_forces, axial_force, add_stiffness
      procedure :: add_geometric, accelerations, power_of_loads, potential_energy, top_height, rotations
      procedure :: angular_momentum, acceleration_scale, check_loads, check_initial, check_inertia
      procedure :: dynamic_parts, set_shape, clear_round_off, momenta, channels, fill_row
      procedure :: put_under, largest_rotation
   end type column_type

contains

   !> Put the column under a constant axial load at its top and the weight of its bodies.
   subroutine put_under(self, load)
      class(column_type), intent(inout) :: self
      !> Compression positive [N]
      real(wp), intent(in) :: load
      real(wp) :: above(self%n + 1), dead
      integer :: i

      ! A load at a lower height has the second-order work of a smaller one at the top.
      dead = load*self%axial_lever
      above(self%n + 1) = 0.0_wp
      do i = self%n, 1, -1
         above(i) = above(i + 1) + self%weight(i)
      end do
      self%axial_load = load
      self%axial_body = dead + (0.5_wp*self%weight + above(2:))
      self%axial_joint = dead + above(:self%n)
      ! The joint of a held top slips along a fixed direction.
      self%axial_slip = self%axial_joint
      if (self%held) self%axial_slip(self%n) = 0.0_wp
      self%second_order = [self%axial_body*self%length, self%axial_slip]
      self%unit_axial = [self%length, (1.0_wp, i=1, self%n)]
      if (self%held) self%unit_axial(2*self%n) = 0.0_wp
      self%compression = load + above(:self%n)
      self%axially_loaded = self%kinematics /= small .and. (abs(dead) > 0.0_wp .or. self%gravity > 0.0_wp)
      self%in_series = .not. (self%axially_loaded .or. self%held)
      ! Flexural springs, of layered joints too, and axial springs carry the load and the weight above them.
      do i = self%n + 1, self%unknowns
         self%constant_axial(i) = self%compression(self%location(i)%index)
      end do
   end subroutine put_under

   !> Changes of the deformations of the joints from those of the bodies; a chain does not use `tangent`.
   subroutine spring_rates(self, tangent, dx, dd)
      class(column_type), intent(in) :: self
      !> Parts between the unknowns, of which a chain has none
      type(series_tangent), intent(in) :: tangent(:)
      !> Displacements of the bodies, or rates of them (unknowns)
      real(wp), intent(in), contiguous :: dx(:)
      !> Deformations by kind: slips, relative rotations, openings (springs)
      real(wp), intent(out), contiguous :: dd(:)

      call deformations(self%n, self%kinds, self%lower, self%upper, dx, dd)
   end subroutine spring_rates

   !> Changes of the displacements of the bodies from those of the joints.
   pure subroutine unknown_rates(self, dd, dx)
      class(column_type), intent(in) :: self
      !> Deformations by kind: slips, relative rotations, openings, or rates of them (springs)
      real(wp), intent(in), contiguous :: dd(:)
      !> Displacements of the bodies (unknowns)
      real(wp), intent(out), contiguous :: dx(:)

      call displacements(self%n, self%kinds, self%lower, self%upper, dd, dx)
      if (self%held) dx(2*self%n) = 0.0_wp
   end subroutine unknown_rates

   !> Forces of springs, loads and axial forces on the bodies, without the inertia of the moving ground. A
   !> chain uses neither `tangent` nor `correction` nor `dead`, which are for frames.
   subroutine forces(self, d, load, axial, tangent, f, g, correction, dead)
      class(column_type), intent(in) :: self
      !> Deformations of the springs (springs) [m, rad], signals of the loads (signals), and what
      !> `axial_forces` gives (2 n), or nothing where axial forces do no second-order work
      real(wp), intent(in), contiguous :: d(:), load(:), axial(:)
      type(series_tangent), intent(in) :: tangent(:)
      !> Forces of the springs; those of slips get the second-order share of the axial forces [N, N m]
      real(wp), intent(inout), contiguous :: f(:)
      !> Forces on the bodies, displacement and rotation of each in turn, then openings (unknowns) [N, N m]
      real(wp), intent(out), contiguous :: g(:)
      real(wp), intent(inout), contiguous :: correction(:)
      real(wp), intent(in), optional :: dead

      ! Step 2: moments are every second number of g. `body_forces` adds to them.
      if (size(axial) > 0) call second_order_forces(self%n, axial, d, f, 2, g)
      call body_forces(self%n, self%kinds, self%lower, self%upper, f, load(lateral), &
                       self%axial_load + load(top_axial), self%weight, size(axial) > 0, g)
   end subroutine forces

   !> Forces and moments about the centroids from the forces f of the joints and the loads p, -B' f + p; B
   !> gives deformations of the joints from displacements of the bodies.
   pure subroutine body_forces(n, kinds, lower, upper, f, lateral, axial_load, weight, adds, g)
      !> Number of bodies, and of joints
      integer, intent(in) :: n
      !> Kinds of deformations: 2, or 3 where joints open
      integer, intent(in) :: kinds
      !> Distances of the centroids from bottom and top of the bodies (n) [m]
      real(wp), intent(in) :: lower(n), upper(n)
      !> Shear forces [N], moments [N m] and axial forces, tension positive [N], of the joints
      real(wp), intent(in) :: f(kinds*n)
      !> Lateral force at the top to +x, axial load there, compression positive, and weight of the bodies [N]
      real(wp), intent(in) :: lateral, axial_load, weight(n)
      !> Whether g holds second-order moments, to which the others are added
      logical, intent(in) :: adds
      !> Force and moment of each body in turn, then forces along the column (2 n or 3 n)
      real(wp), intent(inout) :: g(kinds*n)
      real(wp) :: moment
      integer :: i

      do i = 1, n - 1
         g(2*i - 1) = f(i + 1) - f(i)
         moment = (f(n + i + 1) - f(n + i)) + (lower(i)*f(i) + upper(i)*f(i + 1))
         if (adds) moment = moment + g(2*i)
         g(2*i) = moment
      end do
      g(2*n - 1) = lateral - f(n)
      moment = (lower(n)*f(n) + upper(n)*lateral) - f(2*n)
      if (adds) moment = moment + g(2*n)
      g(2*n) = moment
      if (kinds < 3) return
      do i = 1, n - 1
         g(2*n + i) = (f(2*n + i + 1) - f(2*n + i)) - weight(i)
      end do
      g(3*n) = -axial_load - f(3*n) - weight(n)
   end subroutine body_forces

   !> Axial forces that do second-order work under loads and constant ones, compression positive: those for
   !> the rotations of the bodies, times their lengths [N m], then those across the slips of the joints [N].
   subroutine axial_forces(self, load, axial)
      class(column_type), intent(in) :: self
      !> Signals of the loads (signals)
      real(wp), intent(in), contiguous :: load(:)
      !> (2 n)
      real(wp), intent(out), contiguous :: axial(:)

      axial = self%second_order + added_axial(self, load)
   end subroutine axial_forces

   !> The share in `axial_forces` of changes of the axial load and of vertical accelerations of the ground.
   pure function added_axial(self, load) result(axial)
      class(column_type), intent(in) :: self
      !> Signals of the loads (signals)
      real(wp), intent(in) :: load(:)
      !> (2 n) [N m, N]
      real(wp) :: axial(2*self%n)

      associate (top => load(top_axial)*self%axial_lever)
         axial = [(top + load(vertical)*self%lifted_body)*self%length, top + load(vertical)*self%lifted_joint]
      end associate
      if (self%held) axial(2*self%n) = 0.0_wp
   end function added_axial

   !> Axial force at a spring, constant one and that of the loads, compression positive [N].
   pure real(wp) function axial_force(self, spring, load)
      class(column_type), intent(in) :: self
      !> Number of the spring; signals of the loads (signals)
      integer, intent(in) :: spring
      !> (signals) [N, m/s2, m/s2, N, m/s2]
      real(wp), intent(in) :: load(:)

      axial_force = self%constant_axial(spring) + load(top_axial) &
                    + load(vertical)*self%lifted_joint(self%location(spring)%index)
   end function axial_force

   !> Add B' diag(k) B of the springs to a lower band; B gives deformations of the joints from displacements
   !> of the bodies. A chain does not use `tangent`.
   subroutine add_stiffness(self, k, tangent, band, columns)
      class(column_type), intent(in) :: self
      !> Stiffness of the springs by kind: slips, relative rotations, openings (springs)
      real(wp), intent(in), contiguous :: k(:)
      type(series_tangent), intent(in) :: tangent(:)
      !> (4, unknowns)
      real(wp), intent(inout), contiguous :: band(:, :)
      !> All columns are filled
      logical, intent(in), optional, contiguous :: columns(:)

      call add_joint_stiffness(self%n, self%kinds, self%lower, self%upper, k, band)
   end subroutine add_stiffness

   !> Add the geometric stiffness of axial forces to a lower band.
   subroutine add_geometric(self, k, band)
      class(column_type), intent(in) :: self
      !> What `axial_forces` gives (2 n)
      real(wp), intent(in), contiguous :: k(:)
      !> (4, unknowns)
      real(wp), intent(inout), contiguous :: band(:, :)

      call add_axial_stiffness(self%n, self%lower, self%upper, k, band)
   end subroutine add_geometric

   !> Accelerations of the joints, relative to the ground, where the rotations are small.
   subroutine accelerations(self, d, v, load, pressing, result)
      class(column_type), intent(in) :: self
      !> Deformations of the springs and their velocities (springs), signals of the loads
      real(wp), intent(in) :: d(self%coordinates), v(self%coordinates), load(signals)
      !> Number of axial forces that do second-order work: 2 n, or 0 where none does
      integer, intent(in) :: pressing
      !> It holds the forces of the springs and gets accelerations. Its work array: second-order moments on
      !> the bodies, which stay zero where there are none, and accelerations of the bodies, along x and in
      !> rotation (n each)
      type(motion_result), intent(inout) :: result
      integer :: n

      if (self%opens) then
         call accelerate_unknowns(self, d, v, load, pressing, result)
         return
      end if
      n = self%n
      if (pressing > 0) call second_order_forces(n, result%axial, d, result%f, 1, result%work)
      call chain_accelerations(n, self%lower, self%upper, self%inverse_mass, self%inverse_inertia, result%f, &
                               result%work, load(lateral), load(horizontal), result%work(n + 1), &
                               result%work(2*n + 1), result%a)
      ! Acceleration of the top, as numbers 2 n and 3 n are those of the last body; change of the momentum
      ! along x, with its sign turned, from the forces on the chain.
      result%of_speeds(lateral) = result%work(2*n) + self%upper(n)*result%work(3*n)
      result%of_speeds(horizontal) = -(load(lateral) - result%f(1) - self%mass_above(1)*load(horizontal))
      if (self%mass_damping > 0.0_wp) result%a = result%a - self%mass_damping*v
   end subroutine accelerations

   !> Accelerations of the joints at once, B M^-1 (p - B' f), where joints do not open [m/s2, rad/s2].
   pure subroutine chain_accelerations(n, lower, upper, inverse_mass, inverse_inertia, f, moment, lateral, &
                                       ground, along, turning, a)
      !> Number of bodies, and of joints
      integer, intent(in) :: n
      !> Distances of the centroids from bottom and top of the bodies (n) [m]
      real(wp), intent(in) :: lower(n), upper(n)
      !> One over mass and rotary inertia of the bodies, forces of the joints, and second-order
      !> moments on the bodies
      real(wp), intent(in) :: inverse_mass(n), inverse_inertia(n), f(2*n), moment(n)
      !> Force at the top [N] and acceleration of the ground [m/s2]
      real(wp), intent(in) :: lateral, ground
      !> Accelerations of the bodies relative to the ground, along x and in rotation; of slips, then rotations
      !> of the joints
      real(wp), intent(out) :: along(n), turning(n), a(2*n)
      integer :: i

      do i = 1, n - 1
         along(i) = (f(i + 1) - f(i))*inverse_mass(i) - ground
         turning(i) = (((f(n + i + 1) - f(n + i)) + (lower(i)*f(i) + upper(i)*f(i + 1))) + moment(i)) &
                      *inverse_inertia(i)
      end do
      along(n) = (lateral - f(n))*inverse_mass(n) - ground
      turning(n) = (((lower(n)*f(n) + upper(n)*lateral) - f(2*n)) + moment(n))*inverse_inertia(n)
      a(1) = along(1) - lower(1)*turning(1)
      a(n + 1) = turning(1)
      do i = 2, n
         a(i) = (along(i) - along(i - 1)) - (lower(i)*turning(i) + upper(i - 1)*turning(i - 1))
         a(n + i) = turning(i) - turning(i - 1)
      end do
   end subroutine chain_accelerations

   !> Power of the loads, and of their share of the axial forces that do second-order work [W].
   pure real(wp) function power_of_loads(self, d, v, load) result(watt)
      class(column_type), intent(in) :: self
      !> Deformations of the springs and their velocities (springs), signals of the loads
      real(wp), intent(in), contiguous :: d(:), v(:), load(:)
      real(wp) :: g(2*self%n)

      watt = power_of_patterns(self, d, v, load)
      ! A change of the axial load, or a vertical acceleration, does second-order work too.
      if (self%kinematics == small .or. .not. any(abs(load(vertical:)) > 0.0_wp)) return
      call geometric_forces(self%n, added_axial(self, load), d, g)
      watt = watt - inner_product(2*self%n, v, g)
   end function power_of_loads

   !> Potential of the constant axial load and the weight, on rotations and openings [J].
   pure real(wp) function potential_energy(self, d) result(energy)
      class(column_type), intent(in) :: self
      !> Deformations by kind: slips, relative rotations, openings (springs)
      real(wp), intent(in), contiguous :: d(:)

      energy = 0.0_wp
      if (self%axially_loaded) energy = second_order_energy(self%n, self%second_order, d)
      if (self%opens) energy = energy + inner_product(self%n, self%axial_joint, d(2*self%n + 1:))
   end function potential_energy

   !> Height of the top above the ground, to second order [m]: the way on which the axial load does its work.
   pure real(wp) function top_height(self, d) result(y)
      class(column_type), intent(in) :: self
      !> Deformations by kind: slips, relative rotations, openings (springs)
      real(wp), intent(in), contiguous :: d(:)

      y = self%joint_height(self%n + 1)
      ! The potential of an axial force of one is the height that the top has lost, with its sign turned.
      if (self%kinematics /= small) y = y + second_order_energy(self%n, self%unit_axial, d)
      if (self%opens) y = y + sum(d(2*self%n + 1:))
   end function top_height

   !> Absolute rotations of the bodies, the sums of the relative ones of the joints below them.
   pure subroutine rotations(self, d, rotation)
      class(column_type), intent(in) :: self
      !> Deformations by kind: slips, relative rotations, openings (springs)
      real(wp), intent(in), contiguous :: d(:)
      !> (n) [rad]
      real(wp), intent(out), contiguous :: rotation(:)
      real(wp) :: turned
      integer :: i

      turned = 0.0_wp
      do i = 1, self%n
         turned = turned + d(self%n + i)
         rotation(i) = turned
      end do
   end subroutine rotations

   !> Angular momentum about the lowest joint, in the straight column [kg m2/s].
   pure real(wp) function angular_momentum(self, d, v) result(momentum)
      class(column_type), intent(in) :: self
      !> Deformations, of which only the number counts here, and their velocities (springs)
      real(wp), intent(in), contiguous :: d(:), v(:)
      !> Rates: of the rotation of a body, and along x of its top and its centroid
      real(wp) :: rotation, top, centroid
      integer :: i, n

      n = size(d)/self%kinds
      momentum = 0.0_wp
      top = 0.0_wp
      rotation = 0.0_wp
      do i = 1, n
         rotation = rotation + v(n + i)
         centroid = top + v(i) + self%lower(i)*rotation
         top = centroid + self%upper(i)*rotation
         momentum = momentum + self%mass(i)*centroid*(self%joint_height(i) + self%lower(i)) &
                    + self%inertia(i)*rotation
      end do
   end function angular_momentum

   !> The acceleration of a spring by the largest forces alone, with which a computed one is compared, in
   !> m/s2 or, of a flexural spring, in rad/s2.
   pure real(wp) function acceleration_scale(self, spring, springs, load) result(scale)
      class(column_type), intent(in) :: self
      !> Number of the spring, and all of them; signals of the loads (signals)
      integer, intent(in) :: spring
      type(spring_array), intent(in) :: springs
      real(wp), intent(in) :: load(:)
      !> Largest force and largest moment, then accelerations; length of the longest body
      real(wp) :: along, about, reach
      logical :: upright
      integer :: j

      along = abs(load(lateral))
      ! Vertical loads leave round-off only where joints balance them, not where they lean.
      upright = self%opens .or. size(springs%layered) > 0
      if (upright) along = max(along, abs(self%axial_load + load(top_axial)))
      about = 0.0_wp
      do j = 1, springs%count
         if (self%location(j)%kind == flexure) then
            about = max(about, abs(springs%force(j)))
         else
            along = max(along, abs(springs%force(j)))
         end if
      end do
      reach = maxval(self%length)
      about = (about + along*reach)/minval(self%inertia)
      along = along/minval(self%mass) + abs(load(horizontal)) + about*reach
      if (upright) along = along + abs(load(vertical)) + self%gravity
      scale = merge(about, along, self%location(spring)%kind == flexure)
   end function acceleration_scale

   !> Refuse axial loads and vertical motions that do nothing, and motions along y, which a column does not
   !> have.
   subroutine check_loads(self, acts, error)
      class(column_type), intent(in) :: self
      !> Which loads act (signals)
      logical, intent(in) :: acts(signals)
      type(error_type), allocatable, intent(inout) :: error

      if (acts(sideways)) then
         call fatal_error(error, bad_input, 'ground_acceleration_y: a column moves along x alone; give '// &
                          'ground_acceleration')
         return
      end if
      if (self%kinematics /= small .or. self%opens .or. any(self%rules%name == 'layered')) return
      if (acts(vertical)) then
         call fatal_error(error, bad_input, "vertical_acceleration: with kinematics = 'small' and joints "// &
                          "that do not open it does nothing; use 'pdelta' or 'finite', or give axial "// &
                          'springs or layered joints')
      else if (acts(top_axial)) then
         call fatal_error(error, bad_input, "axial_load: with kinematics = 'small' and joints that do "// &
                          "not open a history of it does nothing; use 'pdelta' or 'finite', or give "// &
                          'axial springs or layered joints')
      end if
   end subroutine check_loads

   !> Refuse initial deformations, or velocities, in which a fixed top is turned, or turns.
   subroutine check_initial(self, name, value, error)
      class(column_type), intent(in) :: self
      !> Name of the values, for the message; the values (springs)
      character(len=*), intent(in) :: name
      real(wp), intent(in), contiguous :: value(:)
      type(error_type), allocatable, intent(inout) :: error
      real(wp) :: total

      if (.not. self%held .or. allocated(error)) return
      associate (relative => value(self%n + 1:2*self%n))
         total = sum(relative)
         if (abs(total) <= same_input*maxval(abs(relative))) return
      end associate
      call fatal_error(error, bad_input, name//": with top = 'fixed' the relative rotations must add up "// &
                       'to zero, not to '//to_text(total)//'; change that of the last joint')
   end subroutine check_initial

   !> Refuse ends without inertia: no equation of motion would hold them.
   subroutine check_inertia(self, error)
      class(column_type), intent(in) :: self
      type(error_type), allocatable, intent(inout) :: error

      if (self%footing .and. .not. (self%mass(1) > 0.0_wp .and. self%inertia(1) > 0.0_wp)) then
         call fatal_error(error, bad_input, 'column: footing_mass = '//to_text(self%mass(1))// &
                          ' kg and footing_inertia = '//to_text(self%inertia(1))// &
                          ' kg m2 must be above zero in a dynamic analysis; give those of the footing '// &
                          '(only a static path takes a footing without inertia)')
      else if (self%held .and. .not. self%mass(self%n) > 0.0_wp) then
         call fatal_error(error, bad_input, "column: with top = 'fixed' a dynamic analysis needs "// &
                          'top_mass, the mass that moves with the top without turning; give one above zero')
      end if
   end subroutine check_inertia

   !> Dynamic stiffness before any spring yields, in parts that nothing couples: slips and rotations are the
   !> first, openings the second, where joints open.
   subroutine dynamic_parts(self, axial, part)
      class(column_type), intent(in) :: self
      !> Whether the axial forces do second-order work
      logical, intent(in) :: axial
      !> One part, or two where joints open
      class(dynamic_stiffness), allocatable, intent(out) :: part(:)
      type(sturm_chain), allocatable :: chain(:)
      real(wp) :: none(2*self%n)

      none = 0.0_wp
      allocate (chain(merge(2, 1, self%opens)))
      ! Openings are a chain whose bodies do not turn: any stiffness against rotation does, as 1.
      associate (n => self%n, k => self%initial_stiffness)
         chain(1) = sturm_chain_of(k(:n), k(n + 1:2*n), self%mass, self%inertia, self%lower, self%upper, &
                                   merge(self%second_order, none, axial), self%held)
         if (self%opens) chain(2) = sturm_chain_of(k(2*n + 1:), none(:n) + 1.0_wp, self%mass, none(:n), &
                                                   none(:n), none(:n), none, .false.)
      end associate
      call move_alloc(chain, part)
   end subroutine dynamic_parts

   !> Put a shape of vibration into the order of the springs, with its sign: the top moves to +x, or up if it
   !> moves along the column only.
   subroutine set_shape(self, part, found, shape)
      class(column_type), intent(in) :: self
      !> Number of the part, of `dynamic_parts`: 2 is that of the openings
      integer, intent(in) :: part
      !> Translation and rotation of each joint in turn (2 n)
      real(wp), intent(in), contiguous :: found(:)
      !> (springs), zero on entry
      real(wp), intent(inout), contiguous :: shape(:)
      real(wp) :: along

      if (part == 2) then
         shape = unpack(found(::2), self%location%kind == axial, shape)
         along = sum(shape)
      else
         shape = unpack(found(::2), self%location%kind == shear, shape)
         shape = unpack(found(2::2), self%location%kind == flexure, shape)
         along = self%top_displacement(shape)
      end if
      shape = sign(1.0_wp, along)*shape
   end subroutine set_shape

   !> Take rates that are round-off for zero: where a spring without stiffness moves alone, the force rates of
   !> all others are round-off of its motion. `tangent` and `dx` are not used.
   pure subroutine clear_round_off(self, tangent, dx, k, dd)
      class(column_type), intent(in) :: self
      type(series_tangent), intent(in) :: tangent(:)
      !> Rates of the unknowns (unknowns); present stiffness of the springs (springs)
      real(wp), intent(in), contiguous :: dx(:), k(:)
      !> Rates of the deformations (springs)
      real(wp), intent(inout), contiguous :: dd(:)
      real(wp) :: lever(self%moving), largest

      associate (m => self%moving)
         if (all(abs(k(:m)) > 0.0_wp)) return
         ! A moment over the height is compared with forces.
         lever = merge(self%total_height, 1.0_wp, self%location(:m)%kind == flexure)
         largest = maxval(self%initial_stiffness(:m)*abs(dd(:m))/lever, mask=.not. abs(k(:m)) > 0.0_wp)
         where (abs(k(:m)) > 0.0_wp .and. abs(k(:m)*dd(:m))/lever < round_off*largest) dd(:m) = 0.0_wp
      end associate
   end subroutine clear_round_off

   !> Momenta of a motion of the joints, conjugate to its deformations.
   pure subroutine momenta(self, shape, momentum)
      class(column_type), intent(in) :: self
      !> Deformations by kind (springs)
      real(wp), intent(in), contiguous :: shape(:)
      !> (springs) [kg m, kg m2 times the unit of the motion]
      real(wp), intent(out), contiguous :: momentum(:)
      real(wp) :: x(self%unknowns)

      call self%unknown_rates(shape, x)
      call joint_forces(self%n, self%kinds, self%lower, self%upper, self%inertias*x, momentum)
   end subroutine momenta

   !> Channels of a column in a row, from `column_channel`: those that the run asks for and the column has.
   pure subroutine channels(self, contents, channel)
      class(column_type), intent(in) :: self
      !> What the run asks for
      type(row_contents), intent(in) :: contents
      type(channel_type), allocatable, intent(out) :: channel(:)
      logical :: held(size(column_channel))

      ! Numbers are places in `column_channel`.
      held = .true.
      held([4, 7]) = self%opens
      held(8:9) = contents%in_time .and. self%damped
      held(10:12) = contents%motion
      held(13:14) = contents%openings .and. .not. self%opens
      channel = column_channel
      channel([2, 3, 4, 5, 6, 7, 13, 14])%count = self%n
      channel%first = merge(0, 1, self%footing)
      channel = pack(channel, held)
   end subroutine channels

   !> Fill a row of a response with the values of `channels`, one after the other.
   pure subroutine fill_row(self, contents, response, springs, d, row)
      class(column_type), intent(in) :: self
      !> What the run asks for; response in time, and springs at the begin of their lines
      type(row_contents), intent(in) :: contents
      type(response_type), intent(in) :: response
      type(spring_array), intent(in) :: springs
      !> Deformations of the springs (springs)
      real(wp), intent(in), contiguous :: d(:)
      !> Values of `channels` without those of all structures
      real(wp), intent(out), contiguous :: row(:)
      ! Place of the last value that is filled; m springs, n joints
      integer :: at, i, m, n

      m = size(d)
      n = self%n
      row(1) = self%top_height(d)
      do i = 1, m
         row(1 + i) = d(i)
         ! Forces on the line that a spring is on, from its begin (d0, f0)
         row(1 + m + i) = springs%f0(i) + springs%k(i)*(d(i) - springs%d0(i))
      end do
      at = 2*m + 1
      if (contents%in_time) then
         if (self%damped) then
            ! Force n + 1 is the moment of the lowest joint.
            row(at + 1) = response%base_shear
            row(at + 2) = response%f(n + 1)
            ! Damping of the masses acts against the ground too, with its moment about the base.
            if (self%mass_damping > 0.0_wp) then
               row(at + 2) = row(at + 2) + self%mass_damping*self%angular_momentum(d, response%v)
            end if
            at = at + 2
         end if
         if (contents%motion) then
            row(at + 1:at + 3) = [self%speed(lateral, d, response%v), &
                                  self%top_acceleration(d, response%v, response%a), response%ground]
            at = at + 3
         end if
      end if
      if (.not. contents%openings .or. self%opens) return
      do i = 1, n
         row(at + i) = opening_of(springs, self%at(flexure, i), d(self%at(flexure, i)))
         row(at + n + i) = rest_of(springs, self%at(flexure, i))
      end do
   end subroutine fill_row

   !> The largest absolute rotation of a body, in size [rad].
   pure real(wp) function largest_rotation(self, d) result(largest)
      class(column_type), intent(in) :: self
      !> Deformations of the springs, or changes of them (springs)
      real(wp), intent(in), contiguous :: d(:)
      real(wp) :: rotation
      integer :: i

      largest = 0.0_wp
      rotation = 0.0_wp
      do i = self%n + 1, 2*self%n
         rotation = rotation + d(i)
         largest = max(largest, abs(rotation))
      end do
   end function largest_rotation

end module rbs_structure_column_column
