!> The chain of rigid bodies: geometry, mass, axial load, and the springs of its joints.
!>
!> Unknowns q = (slip of joint 1..n, relative rotation of joint 1..n). Joint i is at the bottom of
!> body i; rotations are clockwise, so that a positive one moves the top to +x.
module rbs_column_column
   use rbs_base_kinds, only: wp
   use rbs_spec_column, only: column_spec
   use rbs_spec_spring, only: spring_spec, initial_stiffness
   implicit none
   private

   public :: column_type, new_column
   public :: small, pdelta, finite

   !> Levels of kinematics.
   integer, parameter :: small = 1, pdelta = 2, finite = 3

   type :: column_type
      !> Number of bodies, number of unknowns 2 n
      integer :: n = 0, unknowns = 0
      !> `small`, `pdelta` or `finite`
      integer :: kinematics = small
      !> Lengths [m], masses [kg] and rotary inertias about the centroid [kg m2] of the bodies (n)
      real(wp), allocatable :: length(:), mass(:), inertia(:)
      !> Height of the joints above the ground (n + 1) [m]; the last is the top
      real(wp), allocatable :: joint_height(:)
      !> Displacement of the top per unknown, for small rotations (2 n) [1, m]
      real(wp), allocatable :: arm(:)
      !> Inertia load per acceleration of the ground, for small rotations (2 n) [kg, kg m]
      real(wp), allocatable :: ground_arm(:)
      !> Sums over the bodies from i up (n + 1): mass, first and second moment of mass about joint i,
      !> rotary inertia included [kg, kg m, kg m2]
      real(wp), allocatable :: mass_above(:), moment_above(:), inertia_above(:)
      !> Whether an axial force acts, from the load or from the weight
      logical :: axially_loaded = .false.
      !> Axial force for the rotation of body i, and across the slip of joint i, compression
      !> positive (n) [N]
      real(wp), allocatable :: axial_body(:), axial_joint(:)
      !> Damping in proportion to the mass [1/s] and to the initial stiffness [s]
      real(wp) :: mass_damping = 0.0_wp, stiffness_damping = 0.0_wp
      !> Numbers of the springs (2 n), shear first, and their initial stiffness
      type(spring_spec), allocatable :: spring(:)
      real(wp), allocatable :: initial_stiffness(:)
   end type column_type

contains

   !> Make the column of a validated specification.
   subroutine new_column(column, spec)
      type(column_type), intent(out) :: column
      type(column_spec), intent(in) :: spec
      integer :: n

      n = spec%n
      column%n = n
      column%unknowns = 2*n
      select case (spec%kinematics)
      case ('pdelta')
         column%kinematics = pdelta
      case ('finite')
         column%kinematics = finite
      case default
         column%kinematics = small
      end select

      allocate (column%length(n), column%mass(n))
      if (allocated(spec%lengths)) then
         column%length = spec%lengths
      else
         column%length = spec%height/n
      end if
      if (allocated(spec%masses)) then
         column%mass = spec%masses
      else
         column%mass = spec%mass*(column%length/spec%height)
      end if
      column%inertia = column%mass*column%length**2/12.0_wp
      column%mass_damping = spec%mass_damping
      column%stiffness_damping = spec%stiffness_damping

      call set_heights(column)
      call set_mass_sums(column)
      call set_axial_forces(column, spec)
      call set_springs(column, spec)
   end subroutine new_column

   subroutine set_heights(column)
      type(column_type), intent(inout) :: column
      integer :: i, n

      n = column%n
      allocate (column%joint_height(n + 1), column%arm(2*n))
      column%joint_height(1) = 0.0_wp
      do i = 1, n
         column%joint_height(i + 1) = column%joint_height(i) + column%length(i)
      end do
      column%arm(:n) = 1.0_wp
      ! Summed from the top down: the lever arm of an upper joint is no difference of large heights.
      column%arm(2*n) = column%length(n)
      do i = n - 1, 1, -1
         column%arm(n + i) = column%arm(n + i + 1) + column%length(i)
      end do
   end subroutine set_heights

   !> Sums over the bodies above each joint; every term is positive, so nothing cancels.
   subroutine set_mass_sums(column)
      type(column_type), intent(inout) :: column
      integer :: i, n

      n = column%n
      allocate (column%mass_above(n + 1), column%moment_above(n + 1), column%inertia_above(n + 1), &
                source=0.0_wp)
      do i = n, 1, -1
         associate (m => column%mass(i), l => column%length(i))
            column%mass_above(i) = column%mass_above(i + 1) + m
            column%moment_above(i) = column%moment_above(i + 1) + l*column%mass_above(i + 1) + m*l/2.0_wp
            column%inertia_above(i) = column%inertia_above(i + 1) &
                                      + 2.0_wp*l*column%moment_above(i + 1) &
                                      + l**2*column%mass_above(i + 1) &
                                      + m*l**2/4.0_wp + column%inertia(i)
         end associate
      end do
      column%ground_arm = [column%mass_above(:n), column%moment_above(:n)]
   end subroutine set_mass_sums

   !> Axial forces of load and weight; with small kinematics they do no work.
   subroutine set_axial_forces(column, spec)
      type(column_type), intent(inout) :: column
      type(column_spec), intent(in) :: spec
      real(wp) :: g
      integer :: n

      n = column%n
      g = 0.0_wp
      if (spec%self_weight) g = spec%gravity
      column%axial_body = spec%axial_load + g*(column%mass/2.0_wp + column%mass_above(2:))
      column%axial_joint = spec%axial_load + g*column%mass_above(:n)
      column%axially_loaded = column%kinematics /= small .and. &
                              (abs(spec%axial_load) > 0.0_wp .or. g > 0.0_wp)
   end subroutine set_axial_forces

   subroutine set_springs(column, spec)
      type(column_type), intent(inout) :: column
      type(column_spec), intent(in) :: spec
      integer :: i, n

      n = column%n
      allocate (column%spring(2*n))
      do i = 1, n
         column%spring(i) = spec%shear(min(i, size(spec%shear)))
         column%spring(n + i) = spec%flexure(min(i, size(spec%flexure)))
      end do
      column%initial_stiffness = initial_stiffness(column%spring)
   end subroutine set_springs

end module rbs_column_column
