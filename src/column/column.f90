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
module rbs_column_column
   use rbs_base_constants, only: unset
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_column_column_record, only: column_record
   use rbs_hysteresis_spring_record, only: spring_record
   implicit none
   private

   public :: column_type, new_column, joint_name
   public :: small, pdelta, finite

   !> Levels of kinematics.
   integer, parameter :: small = 1, pdelta = 2, finite = 3

   !> Rotary inertia of a body that does not turn [kg m2]: any positive number.
   real(wp), parameter :: of_held_body = 1.0_wp

   type :: column_type
      !> Number of bodies, number of unknowns 2 n or, with axial springs, 3 n
      integer :: n = 0, unknowns = 0
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
      real(wp), allocatable :: initial_stiffness(:)
      !> The spring whose work a spring may ask for: of a shear spring the flexural one of its joint, else 0
      !> (unknowns)
      integer, allocatable :: told(:)
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
      column%unknowns = merge(3, 2, column%opens)*n
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
      if (spec%axial_height > unset) column%axial_lever = spec%axial_height/spec%height
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
      integer :: i, n

      n = column%n
      allocate (column%spring(column%unknowns))
      allocate (column%told(column%unknowns), source=0)
      column%told(:n) = [(n + i, i=1, n)]
      do i = 1, n
         column%spring(i) = spec%shear(min(i, size(spec%shear)))
         column%spring(n + i) = spec%flexure(min(i, size(spec%flexure)))
         if (column%opens) column%spring(2*n + i) = spec%axial_spring(min(i, size(spec%axial_spring)))
      end do
      ! Layered joints share the axial load of load and weight above them.
      column%spring(n + 1:2*n)%axial_load = column%compression
      column%initial_stiffness = column%spring%initial_stiffness()
   end subroutine set_springs

   !> Which spring an unknown is, for messages: 'the shear spring of joint 3'.
   function joint_name(column, i) result(name)
      type(column_type), intent(in) :: column
      !> Number of the unknown
      integer, intent(in) :: i
      character(len=40) :: name
      character(len=9), parameter :: kinds(3) = ['shear    ', 'flexural ', 'axial    ']

      name = 'the '//trim(kinds((i - 1)/column%n + 1))//' spring of joint '// &
             to_text(mod(i - 1, column%n) + merge(0, 1, column%footing))
   end function joint_name

end module rbs_column_column
