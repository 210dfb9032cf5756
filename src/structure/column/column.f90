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
   use rbs_base_check, only: is_given
   use rbs_base_kinds, only: wp
   use rbs_structure_column_chain, only: deformations, displacements, body_forces, second_order_forces, &
                               add_joint_stiffness, add_axial_stiffness
   use rbs_structure_column_column_record, only: column_record
   use rbs_hysteresis_rule, only: spring_rules
   use rbs_hysteresis_spring_record, only: spring_record, make_rules
   use rbs_structure_spring_place, only: spring_place, shear, flexure, axial
   use rbs_structure_structure, only: structure_type, unknown_group, lateral, horizontal, vertical, top_axial
   implicit none
   private

   public :: column_type, new_column
   public :: small, pdelta, finite

   !> Levels of kinematics.
   integer, parameter :: small = 1, pdelta = 2, finite = 3

   !> Rotary inertia of a body that does not turn [kg m2]: any positive number.
   real(wp), parameter :: of_held_body = 1.0_wp

   type, extends(structure_type) :: column_type
      !> Number of bodies; the unknowns, as many as springs, are 2 n or, with axial springs, 3 n
      integer :: n = 0
      !> Kinds of deformations of a joint: slip, rotation and, with axial springs, opening. Deformations are
      !> kept by kind, (n, kinds)
      integer :: kinds = 2
      !> `small`, `pdelta` or `finite`
      integer :: kinematics = small
      !> Whether joints have axial springs and open
      logical :: opens = .false.
      !> Whether the first body is a footing, so that its joint is joint 0, and whether the last body is held
      !> against rotation
      logical :: footing = .false., held = .false.
      !> Lengths [m], masses [kg] and rotary inertias about the centroid [kg m2] of the bodies (n)
      real(wp), allocatable :: length(:), mass(:), inertia(:)
      !> Distance of the centroid from the bottom and from the top of its body (n) [m]
      real(wp), allocatable :: lower(:), upper(:)
      !> Height of the column itself, which drifts are in proportion to: a footing is not part of it [m]
      real(wp) :: height = 0.0_wp
      !> Height of the joints above the ground (n + 1) [m]; the last is the top
      real(wp), allocatable :: joint_height(:)
      !> Displacement of the top per unknown, for small rotations (unknowns) [1, m, 0]
      real(wp), allocatable :: arm(:)
      !> Inertia load per acceleration of the ground, for small rotations (unknowns) [kg, kg m, 0]
      real(wp), allocatable :: ground_arm(:)
      !> Sums over the bodies from i up (n + 1): mass, first and second moment of mass about joint i,
      !> rotary inertia included [kg, kg m, kg m2]
      real(wp), allocatable :: mass_above(:), moment_above(:), inertia_above(:)
      !> Whether an axial force does second-order work, from the load or from the weight
      logical :: axially_loaded = .false.
      !> Axial load at the top, compression positive [N], and acceleration of gravity that gives the bodies
      !> their weight, 0 without self-weight [m/s2]
      real(wp) :: axial_load = 0.0_wp, gravity = 0.0_wp
      !> Change of the axial load per lateral force on a static path
      real(wp) :: axial_force_ratio = 0.0_wp
      !> Height at which the axial load acts over the height of the column
      real(wp) :: axial_lever = 1.0_wp
      !> Weight of the bodies (n) [N]
      real(wp), allocatable :: weight(:)
      !> Axial force of load and weight for the rotation of body i, and across the slip of joint i,
      !> compression positive (n) [N]; a load that follows the top has no potential and is not in them
      real(wp), allocatable :: axial_body(:), axial_joint(:)
      !> The latter as far as it does second-order work on slips: not where they keep their direction (n) [N]
      real(wp), allocatable :: axial_slip(:)
      !> Axial force of load and weight in the joints of the straight column, compression positive (n) [N]
      real(wp), allocatable :: compression(:)
      !> The same per vertical acceleration of the ground, from all masses (n) [kg]
      real(wp), allocatable :: lifted_body(:), lifted_joint(:)
      !> Whether the axial load, and the lateral force, turn with the top body
      logical :: axial_follows = .false., force_follows = .false.
      !> Damping in proportion to the mass [1/s] and to the stiffness of the joints [s], the initial one
      !> or that of the present line
      real(wp) :: mass_damping = 0.0_wp, stiffness_damping = 0.0_wp
      logical :: tangent_damping = .false.
      !> Damping ratios of the modes (first modes, or one for all); not allocated without modal damping
      real(wp), allocatable :: modal_damping(:)
      !> Whether there is damping at all
      logical :: damped = .false.
      !> Springs (unknowns), shear first, and their initial stiffness
      type(spring_record), allocatable :: spring(:)
      type(spring_rules) :: rules
      real(wp), allocatable :: initial_stiffness(:)
      !> Number of the spring of a kind in a joint, from the bottom up (3, n); 0: there is none
      integer, allocatable :: at(:, :)
   contains
      procedure :: spring_rates
      procedure :: unknown_rates
      procedure :: forces
      procedure :: axial_forces
      procedure :: axial_force
      procedure :: index_of
      procedure :: add_stiffness
      procedure :: add_geometric
   end type column_type

contains

   !> Make the column of a validated specification.
   subroutine new_column(column, spec)
      type(column_type), intent(out) :: column
      type(column_record), intent(in) :: spec
      integer :: first, last, n

      column%footing = spec%footing
      column%held = spec%top == 'fixed'
      n = spec%joints()
      column%n = n
      column%height = spec%height
      ! The bodies of the column itself
      first = merge(2, 1, column%footing)
      last = first + spec%n - 1
      column%opens = allocated(spec%axial_spring)
      column%kinds = merge(3, 2, column%opens)
      column%unknowns = column%kinds*n
      select case (spec%kinematics)
      case ('pdelta')
         column%kinematics = pdelta
      case ('finite')
         column%kinematics = finite
      case default
         column%kinematics = small
      end select

      allocate (column%length(n), column%mass(n), source=0.0_wp)
      if (allocated(spec%lengths)) then
         column%length(first:last) = spec%lengths
      else
         column%length(first:last) = spec%height/spec%n
      end if
      if (allocated(spec%masses)) then
         column%mass(first:last) = spec%masses
      else
         column%mass(first:last) = spec%mass*(column%length(first:last)/spec%height)
      end if
      if (column%footing) then
         column%length(1) = spec%footing_height
         column%mass(1) = spec%footing_mass
      end if
      column%mass_damping = spec%damping%mass
      column%stiffness_damping = spec%damping%stiffness
      column%tangent_damping = spec%damping%tangent
      if (allocated(spec%damping%modal)) column%modal_damping = spec%damping%modal
      column%damped = column%mass_damping > 0.0_wp .or. column%stiffness_damping > 0.0_wp .or. &
                      allocated(column%modal_damping)
      column%axial_follows = spec%axial_follows
      column%force_follows = spec%force_follows

      call set_heights(column)
      call set_weights(column, spec)
      call set_bodies(column, spec, first, last)
      call set_mass_sums(column)
      call set_lifted_masses(column)
      call set_springs(column, spec)
      call set_unknowns(column)
   end subroutine new_column

   subroutine set_heights(column)
      type(column_type), intent(inout) :: column
      integer :: i, n

      n = column%n
      allocate (column%joint_height(n + 1))
      allocate (column%arm(column%unknowns), source=0.0_wp)
      column%joint_height(1) = 0.0_wp
      do i = 1, n
         column%joint_height(i + 1) = column%joint_height(i) + column%length(i)
      end do
      column%arm(:n) = 1.0_wp
      ! Summed from the top down: the lever arm of an upper joint is not a difference of large heights.
      column%arm(2*n) = column%length(n)
      do i = n - 1, 1, -1
         column%arm(n + i) = column%arm(n + i + 1) + column%length(i)
      end do
   end subroutine set_heights

   !> Axial forces of load and weight of the bodies.
   subroutine set_weights(column, spec)
      type(column_type), intent(inout) :: column
      type(column_record), intent(in) :: spec
      real(wp) :: above(column%n + 1)
      real(wp) :: dead
      integer :: i, n

      n = column%n
      column%axial_load = spec%axial_load
      column%axial_force_ratio = spec%axial_force_ratio
      if (is_given(spec%axial_height)) column%axial_lever = spec%axial_height/spec%height
      dead = merge(0.0_wp, column%axial_load*column%axial_lever, column%axial_follows)
      if (spec%self_weight) column%gravity = spec%gravity
      above(n + 1) = 0.0_wp
      do i = n, 1, -1
         above(i) = above(i + 1) + column%mass(i)
      end do
      column%weight = column%gravity*column%mass
      column%axial_body = dead + column%gravity*(column%mass/2.0_wp + above(2:))
      column%axial_joint = dead + column%gravity*above(:n)
      column%axial_slip = column%axial_joint
      if (column%held) column%axial_slip(n) = 0.0_wp
      column%compression = column%axial_load + column%gravity*above(:n)
      column%axially_loaded = column%kinematics /= small .and. &
                              (abs(dead) > 0.0_wp .or. column%gravity > 0.0_wp)
   end subroutine set_weights

   !> Centroids and rotary inertias, the lumped mass included.
   subroutine set_bodies(column, spec, first, last)
      type(column_type), intent(inout) :: column
      type(column_record), intent(in) :: spec
      !> Bodies of the column itself
      integer, intent(in) :: first, last
      real(wp) :: own, shift
      integer :: i, n

      n = column%n
      column%inertia = column%mass*(column%length**2 + spec%depth**2)/12.0_wp
      if (allocated(spec%rotary_inertia)) then
         column%inertia(first:last) = spec%rotary_inertia(min([(i, i=1, spec%n)], size(spec%rotary_inertia)))
      end if
      column%lower = column%length/2.0_wp
      column%upper = column%length/2.0_wp
      if (column%footing) column%inertia(1) = spec%footing_inertia
      if (column%held) then
         column%mass(n) = spec%top_mass
         column%inertia(n) = of_held_body
         return
      end if
      if (.not. spec%top_mass > 0.0_wp .and. .not. spec%top_inertia > 0.0_wp) return
      own = column%mass(n)
      shift = spec%top_mass/(own + spec%top_mass)*column%upper(n)
      column%inertia(n) = column%inertia(n) + spec%top_inertia + own*shift*column%upper(n)
      column%mass(n) = own + spec%top_mass
      column%upper(n) = own/column%mass(n)*column%upper(n)
      column%lower(n) = column%length(n) - column%upper(n)
   end subroutine set_bodies

   !> Sums over the bodies above each joint; every term is positive, so nothing cancels.
   subroutine set_mass_sums(column)
      type(column_type), intent(inout) :: column
      integer :: i, n

      n = column%n
      allocate (column%mass_above(n + 1), column%moment_above(n + 1), column%inertia_above(n + 1), &
                source=0.0_wp)
      do i = n, 1, -1
         associate (m => column%mass(i), l => column%length(i), s => column%lower(i))
            column%mass_above(i) = column%mass_above(i + 1) + m
            column%moment_above(i) = column%moment_above(i + 1) + l*column%mass_above(i + 1) + m*s
            column%inertia_above(i) = column%inertia_above(i + 1) &
                                      + 2.0_wp*l*column%moment_above(i + 1) &
                                      + l**2*column%mass_above(i + 1) &
                                      + m*s**2 + column%inertia(i)
         end associate
      end do
      allocate (column%ground_arm(column%unknowns), source=0.0_wp)
      column%ground_arm(:n) = column%mass_above(:n)
      column%ground_arm(n + 1:2*n) = column%moment_above(:n)
   end subroutine set_mass_sums

   !> Axial forces per vertical acceleration of the ground.
   subroutine set_lifted_masses(column)
      type(column_type), intent(inout) :: column
      integer :: n

      n = column%n
      ! A body without length does not lean.
      column%lifted_body = column%mass_above(2:)
      where (column%length > 0.0_wp)
         column%lifted_body = column%mass*column%lower/column%length + column%mass_above(2:)
      end where
      column%lifted_joint = column%mass_above(:n)
   end subroutine set_lifted_masses

   subroutine set_springs(column, spec)
      type(column_type), intent(inout) :: column
      type(column_record), intent(in) :: spec
      integer :: i, joint, n

      n = column%n
      allocate (column%spring(column%unknowns), column%place(column%unknowns))
      allocate (column%at(3, n), source=0)
      do i = 1, n
         column%at(:2, i) = [i, n + i]
         column%spring(i) = spec%shear(min(i, size(spec%shear)))
         column%spring(n + i) = spec%flexure(min(i, size(spec%flexure)))
         ! A shear spring may ask for the work of the flexural one of its joint.
         joint = merge(i - 1, i, column%footing)
         column%place(i) = spring_place(shear, 1, joint, n + i)
         column%place(n + i) = spring_place(flexure, 1, joint)
         if (.not. column%opens) cycle
         column%at(axial, i) = 2*n + i
         column%spring(2*n + i) = spec%axial_spring(min(i, size(spec%axial_spring)))
         column%place(2*n + i) = spring_place(axial, 1, joint)
      end do
      ! Layered joints share the axial load of load and weight above them.
      column%spring(n + 1:2*n)%axial_load = column%compression
      call make_rules(column%spring, column%rules)
      column%initial_stiffness = column%rules%initial_stiffness()
   end subroutine set_springs

   !> The coordinates of the bodies, in which the mass is diagonal; see `rbs_structure_column_chain`.
   subroutine set_unknowns(column)
      type(column_type), intent(inout) :: column
      integer :: i, n, m

      n = column%n
      m = column%unknowns
      column%half_width = 3
      allocate (column%inertias(m), column%is_held(m), column%part(m))
      column%is_held = .false.
      column%is_held(2*n) = column%held
      column%has_held = column%held
      do i = 1, n
         column%inertias(2*i - 1:2*i) = [column%mass(i), column%inertia(i)]
         column%part(2*i - 1:2*i) = i
         if (.not. column%opens) cycle
         column%inertias(2*n + i) = column%mass(i)
         column%part(2*n + i) = n + i
      end do
      allocate (column%group(merge(3, 2, column%opens)))
      column%group(1) = unknown_group(1, 2*n, 2, 1, n, 1.0_wp)
      column%group(2) = unknown_group(2, 2*n, 2, n + 1, 2*n, column%upper(n))
      if (column%opens) column%group(3) = unknown_group(2*n + 1, 3*n, 1, 2*n + 1, 3*n)
      do i = 1, size(column%pattern)
         allocate (column%pattern(i)%force(m), source=0.0_wp)
      end do
      associate (push => column%pattern(lateral), ground => column%pattern(horizontal))
         push%force(2*n - 1:2*n) = [1.0_wp, column%upper(n)]
         if (column%held) push%force(2*n) = 0.0_wp
         ground%force(1:2*n:2) = -column%mass
      end associate
      if (column%opens) then
         column%pattern(vertical)%force(2*n + 1:) = -column%mass
         column%pattern(top_axial)%force(3*n) = -1.0_wp
      end if
      do i = 1, size(column%pattern)
         associate (pattern => column%pattern(i))
            pattern%first = findloc(abs(pattern%force) > 0.0_wp, .true., dim=1)
            pattern%last = findloc(abs(pattern%force) > 0.0_wp, .true., dim=1, back=.true.)
            if (pattern%first == 0) pattern%first = 1
         end associate
      end do
   end subroutine set_unknowns

   !> Changes of the deformations of the joints from those of the bodies.
   subroutine spring_rates(self, dx, dd)
      class(column_type), intent(in) :: self
      real(wp), intent(in), contiguous :: dx(:)
      real(wp), intent(out), contiguous :: dd(:)

      call deformations(self%n, self%kinds, self%lower, self%upper, dx, dd)
   end subroutine spring_rates

   !> Changes of the displacements of the bodies from those of the joints.
   subroutine unknown_rates(self, dd, dx)
      class(column_type), intent(in) :: self
      real(wp), intent(in), contiguous :: dd(:)
      real(wp), intent(out), contiguous :: dx(:)

      call displacements(self%n, self%kinds, self%lower, self%upper, dd, dx)
      if (self%held) dx(2*self%n) = 0.0_wp
   end subroutine unknown_rates

   !> Forces on the bodies, without the inertia of the moving ground.
   subroutine forces(self, d, load, axial, f, g)
      class(column_type), intent(in) :: self
      real(wp), intent(in), contiguous :: d(:), load(:), axial(:)
      real(wp), intent(inout), contiguous :: f(:)
      real(wp), intent(out), contiguous :: g(:)

      if (size(axial) > 0) call second_order_forces(self%n, self%length, axial, d, f, 2, g)
      call body_forces(self%n, self%kinds, self%lower, self%upper, f, load(lateral), &
                       self%axial_load + load(top_axial), self%weight, size(axial) > 0, g)
   end subroutine forces

   !> Axial forces for the rotations of the bodies, then across the slips of the joints (2 n).
   subroutine axial_forces(self, load, axial)
      class(column_type), intent(in) :: self
      real(wp), intent(in), contiguous :: load(:)
      real(wp), intent(out), contiguous :: axial(:)
      integer :: n

      n = self%n
      axial(:n) = self%axial_body + load(top_axial)*self%axial_lever + load(vertical)*self%lifted_body
      axial(n + 1:) = self%axial_slip + load(top_axial)*self%axial_lever + load(vertical)*self%lifted_joint
      if (self%held) axial(2*n) = 0.0_wp
   end subroutine axial_forces

   !> Number of a spring's joint from the bottom up, that of a footing included.
   pure integer function index_of(self, spring) result(i)
      class(column_type), intent(in) :: self
      integer, intent(in) :: spring

      i = self%place(spring)%joint + merge(1, 0, self%footing)
   end function index_of

   !> Axial force at a spring from axial load, weight and vertical motion, compression positive [N].
   pure real(wp) function axial_force(self, spring, load)
      class(column_type), intent(in) :: self
      integer, intent(in) :: spring
      real(wp), intent(in) :: load(:)
      integer :: i

      i = self%index_of(spring)
      axial_force = self%compression(i) + load(top_axial) + load(vertical)*self%lifted_joint(i)
   end function axial_force

   !> Add B' diag(k) B.
   subroutine add_stiffness(self, k, band)
      class(column_type), intent(in) :: self
      real(wp), intent(in), contiguous :: k(:)
      real(wp), intent(inout), contiguous :: band(:, :)

      call add_joint_stiffness(self%n, self%kinds, self%lower, self%upper, k, band)
   end subroutine add_stiffness

   !> Add the geometric stiffness.
   subroutine add_geometric(self, k, band)
      class(column_type), intent(in) :: self
      real(wp), intent(in), contiguous :: k(:)
      real(wp), intent(inout), contiguous :: band(:, :)

      call add_axial_stiffness(self%n, self%length, self%lower, self%upper, k, band)
   end subroutine add_geometric

end module rbs_structure_column_column
