!> The chain with small rotations in centroid coordinates: every sum runs over neighbours only, so that
!> forces, accelerations and energies cost O(n) and no matrix is factored.
!>
!> Joint i acts on body i with -V_i, -M_i, -N_i at its bottom, and on body i - 1 the other way round at its
!> top. The mass is diagonal in (x, theta, y) of the centroids; joint accelerations are differences of
!> those of neighbouring bodies. It is M^-1 r of eqs 1-3 without M.
module rbs_column_chain
   use rbs_base_kinds, only: wp
   use rbs_column_column, only: column_type
   implicit none
   private

   public :: body_forces, lift_forces, second_order_forces, joint_accelerations, joint_lifts
   public :: body_velocities, kinetic_of

contains

   !> Horizontal forces and moments about the centroids from the forces of the joints.
   pure subroutine body_forces(n, lower, upper, shear, moment, lateral, force, torque)
      integer, intent(in) :: n
      !> Distances from the centroid to bottom and top (n) [m]
      real(wp), intent(in) :: lower(n), upper(n)
      !> Forces [N] and moments [N m] of the joints (n)
      real(wp), intent(in) :: shear(n), moment(n)
      !> Force at the top [N]
      real(wp), intent(in) :: lateral
      !> On the bodies (n) [N], [N m]
      real(wp), intent(out) :: force(n), torque(n)
      integer :: i

      do i = 1, n - 1
         force(i) = shear(i + 1) - shear(i)
         torque(i) = (moment(i + 1) - moment(i)) + (lower(i)*shear(i) + upper(i)*shear(i + 1))
      end do
      force(n) = lateral - shear(n)
      torque(n) = (lower(n)*shear(n) + upper(n)*lateral) - moment(n)
   end subroutine body_forces

   !> Vertical forces from the axial forces of the joints (tension positive), weight and axial load.
   pure subroutine lift_forces(n, weight, tension, axial_load, force)
      integer, intent(in) :: n
      real(wp), intent(in) :: weight(n), tension(n)
      !> At the top, compression positive [N]
      real(wp), intent(in) :: axial_load
      !> On the bodies, upward (n) [N]
      real(wp), intent(out) :: force(n)
      integer :: i

      do i = 1, n - 1
         force(i) = (tension(i + 1) - tension(i)) - weight(i)
      end do
      force(n) = -axial_load - tension(n) - weight(n)
   end subroutine lift_forces

   !> Add the second-order forces of the axial load: of the potential
   !> -sum a_k l_k th_k^2/2 - sum b_k u_k th_{k-1}, on the joint its part in u, on the bodies that in th.
   pure subroutine second_order_forces(n, length, axial_body, axial_joint, slip, rotation, shear, torque)
      integer, intent(in) :: n
      real(wp), intent(in) :: length(n), axial_body(n), axial_joint(n)
      !> Slips [m] and relative rotations [rad] of the joints (n)
      real(wp), intent(in) :: slip(n), rotation(n)
      !> Forces of the joints (n) [N]
      real(wp), intent(inout) :: shear(n)
      !> What is to be added to the torques on the bodies (n) [N m]
      real(wp), intent(out) :: torque(n)
      real(wp) :: absolute
      integer :: i

      absolute = 0.0_wp
      do i = 1, n
         shear(i) = shear(i) - axial_joint(i)*absolute
         absolute = absolute + rotation(i)
         torque(i) = axial_body(i)*length(i)*absolute
      end do
      do i = 1, n - 1
         torque(i) = torque(i) + axial_joint(i + 1)*slip(i + 1)
      end do
   end subroutine second_order_forces

   !> Accelerations of slips and relative rotations from those of the centroids.
   pure subroutine joint_accelerations(n, lower, upper, along, turning, slip, rotation)
      integer, intent(in) :: n
      real(wp), intent(in) :: lower(n), upper(n)
      !> Of the centroids [m/s2] and of the rotations [rad/s2] (n)
      real(wp), intent(in) :: along(n), turning(n)
      !> Of the joints (n)
      real(wp), intent(out) :: slip(n), rotation(n)
      integer :: i

      slip(1) = along(1) - lower(1)*turning(1)
      rotation(1) = turning(1)
      do i = 2, n
         slip(i) = (along(i) - along(i - 1)) - (lower(i)*turning(i) + upper(i - 1)*turning(i - 1))
         rotation(i) = turning(i) - turning(i - 1)
      end do
   end subroutine joint_accelerations

   !> Accelerations of the openings from the vertical ones of the centroids.
   pure subroutine joint_lifts(n, upward, opening)
      integer, intent(in) :: n
      real(wp), intent(in) :: upward(n)
      real(wp), intent(out) :: opening(n)
      integer :: i

      opening(1) = upward(1)
      do i = 2, n
         opening(i) = upward(i) - upward(i - 1)
      end do
   end subroutine joint_lifts

   !> Velocities of the centroids (x_1, th_1, ..., x_n, th_n [, y_1..y_n]) from those of the joints.
   pure subroutine body_velocities(column, v, x)
      type(column_type), intent(in) :: column
      !> Of the joints (unknowns) [m/s, rad/s]
      real(wp), intent(in) :: v(:)
      !> Of the bodies (unknowns)
      real(wp), intent(out) :: x(:)
      real(wp) :: top, turning, height
      integer :: i, n

      n = column%n
      top = 0.0_wp
      turning = 0.0_wp
      do i = 1, n
         turning = turning + v(n + i)
         x(2*i) = turning
         x(2*i - 1) = top + v(i) + column%lower(i)*turning
         top = x(2*i - 1) + column%upper(i)*turning
      end do
      if (.not. column%opens) return
      height = 0.0_wp
      do i = 1, n
         height = height + v(2*n + i)
         x(2*n + i) = height
      end do
   end subroutine body_velocities

   !> Kinetic energy of velocities of the joints, relative to the ground [J].
   pure real(wp) function kinetic_of(column, v) result(energy)
      type(column_type), intent(in) :: column
      real(wp), intent(in) :: v(:)
      real(wp) :: top, turning, centroid, height
      integer :: i, n

      n = column%n
      top = 0.0_wp
      turning = 0.0_wp
      energy = 0.0_wp
      do i = 1, n
         turning = turning + v(n + i)
         centroid = top + v(i) + column%lower(i)*turning
         top = centroid + column%upper(i)*turning
         energy = energy + 0.5_wp*(column%mass(i)*centroid**2 + column%inertia(i)*turning**2)
      end do
      if (.not. column%opens) return
      height = 0.0_wp
      do i = 1, n
         height = height + v(2*n + i)
         energy = energy + 0.5_wp*column%mass(i)*height**2
      end do
   end function kinetic_of

end module rbs_column_chain
