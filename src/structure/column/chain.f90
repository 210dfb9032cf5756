!> The chain with small rotations in the coordinates of its bodies: every sum runs over neighbours only, so
!> that forces, accelerations and energies cost O(n) and no matrix is factored.
!>
!> Unknowns x = (x_1, th_1, x_2, th_2, ..., x_n, th_n [, y_1, ..., y_n]): displacement of the centroid [m]
!> and absolute rotation [rad] of every body, and, where joints open, its displacement along the column
!> [m]. The mass is diagonal in them. Deformations of the joints (slip 1..n, relative rotation 1..n [,
!> opening 1..n]) are d = B x with
!>
!>     u_i = x_i - lower_i th_i - x_{i-1} - upper_{i-1} th_{i-1},  phi_i = th_i - th_{i-1},
!>     w_i = y_i - y_{i-1}                                         (body 0 is the ground, at rest)
!>
!> Joint i acts on body i with -V_i, -M_i, -N_i at its bottom, and on body i - 1 the other way round at its
!> top: B' f. It is M^-1 r of eqs 1-3 without M. Stiffness is a band of half-width 3, band(1 + i - j, j) =
!> a(i, j) for j <= i <= j + 3; the y are a chain of their own behind the rest.
module rbs_structure_column_chain
   use rbs_base_kinds, only: wp
   implicit none
   private

   public :: deformations, displacements, joint_forces
   public :: second_order_forces, geometric_forces, second_order_energy
   public :: add_joint_stiffness, add_axial_stiffness

contains

   !> Deformations of the joints from displacements of the bodies, d = B x.
   pure subroutine deformations(n, kinds, lower, upper, x, d)
      !> Number of bodies, and of joints
      integer, intent(in) :: n
      !> Kinds of deformations: 2, or 3 where joints open
      integer, intent(in) :: kinds
      !> Distances from the centroid of each body to its bottom and top (n) [m]; displacements of the bodies
      !> in the order of the unknowns (2 n or 3 n)
      real(wp), intent(in) :: lower(n), upper(n), x(kinds*n)
      !> Slips, then relative rotations, then openings of the joints, all set here (2 n or 3 n) [m, rad, m]
      real(wp), intent(inout) :: d(kinds*n)
      integer :: i

      d(1) = x(1) - lower(1)*x(2)
      d(n + 1) = x(2)
      do i = 2, n
         d(i) = (x(2*i - 1) - x(2*i - 3)) - (lower(i)*x(2*i) + upper(i - 1)*x(2*i - 2))
         d(n + i) = x(2*i) - x(2*i - 2)
      end do
      if (kinds < 3) return
      d(2*n + 1) = x(2*n + 1)
      do i = 2*n + 2, 3*n
         d(i) = x(i) - x(i - 1)
      end do
   end subroutine deformations

   !> Displacements of the bodies from deformations of the joints, from the ground up.
   pure subroutine displacements(n, kinds, lower, upper, d, x)
      !> Number of bodies, and of joints
      integer, intent(in) :: n
      !> Kinds of deformations: 2, or 3 where joints open
      integer, intent(in) :: kinds
      !> Distances from the centroids to bottom and top (n) [m]; slips, then relative rotations, then openings
      real(wp), intent(in) :: lower(n), upper(n), d(kinds*n)
      !> Displacements of the bodies in the order of the unknowns, all set here
      real(wp), intent(inout) :: x(kinds*n)
      !> Displacement of the top of the body below, and rotation of the body; displacement along the column
      real(wp) :: top, rotation, height
      integer :: i

      top = 0.0_wp
      rotation = 0.0_wp
      do i = 1, n
         rotation = rotation + d(n + i)
         x(2*i) = rotation
         x(2*i - 1) = top + d(i) + lower(i)*rotation
         top = x(2*i - 1) + upper(i)*rotation
      end do
      if (kinds < 3) return
      height = 0.0_wp
      do i = 2*n + 1, 3*n
         height = height + d(i)
         x(i) = height
      end do
   end subroutine displacements

   !> Forces of the joints, conjugate to their deformations, that balance forces on the bodies: B'^-1 g, from
   !> the top down.
   pure subroutine joint_forces(n, kinds, lower, upper, g, f)
      !> Number of bodies; kinds of deformations: 2, or 3 where joints open
      integer, intent(in) :: n, kinds
      !> Distances from the centroids to bottom and top (n) [m]; forces on the bodies in the order of the
      !> unknowns
      real(wp), intent(in) :: lower(n), upper(n), g(kinds*n)
      !> Shear forces, then moments, then axial forces (n each) [N, N m, N]
      real(wp), intent(out) :: f(kinds*n)
      real(wp) :: force, moment
      integer :: i

      force = 0.0_wp
      moment = 0.0_wp
      do i = n, 1, -1
         moment = moment + upper(i)*force
         force = force + g(2*i - 1)
         moment = moment + g(2*i) + lower(i)*force
         f(i) = force
         f(n + i) = moment
      end do
      force = 0.0_wp
      do i = kinds*n, 2*n + 1, -1
         force = force + g(i)
         f(i) = force
      end do
   end subroutine joint_forces

   !> Second-order forces of axial forces, from their potential U = -sum a_k th_k^2/2 - sum b_k u_k th_{k-1}
   !> in slips u and absolute rotations th: dU/du adds to the forces of the joints, -dU/dth are moments on the
   !> bodies.
   pure subroutine second_order_forces(n, axial, d, shear, step, moment)
      !> Number of bodies, and of joints
      integer, intent(in) :: n
      !> a_k, axial force times length of body k [N m], then b_k, axial force across the slip of joint k [N];
      !> compression positive (2 n)
      real(wp), intent(in) :: axial(2*n)
      !> Slips [m] and relative rotations [rad] of the joints (2 n)
      real(wp), intent(in) :: d(2*n)
      !> Shear forces of the joints (n) [N], to which dU/du is added
      real(wp), intent(inout) :: shear(n)
      !> Distance between moments of neighbours in their array: 1 if it holds moments alone, 2 if it holds
      !> force and moment of each body in turn
      integer, intent(in) :: step
      !> Moments on the bodies, set here; what stands between them is left alone (step n) [N m]
      real(wp), intent(inout) :: moment(step*n)
      real(wp) :: rotation
      integer :: i

      rotation = 0.0_wp
      do i = 1, n - 1
         shear(i) = shear(i) - axial(n + i)*rotation
         rotation = rotation + d(n + i)
         moment(step*i) = axial(i)*rotation + axial(n + i + 1)*d(i + 1)
      end do
      shear(n) = shear(n) - axial(2*n)*rotation
      moment(step*n) = axial(n)*(rotation + d(2*n))
   end subroutine second_order_forces

   !> Geometric stiffness times deformations: the derivatives of the potential U of `second_order_forces` by
   !> slips and relative rotations of the joints.
   pure subroutine geometric_forces(n, axial, d, g)
      !> Number of bodies, and of joints
      integer, intent(in) :: n
      !> a and b of that potential, compression positive [N m, N]; slips and relative rotations [m, rad] (2 n)
      real(wp), intent(in) :: axial(2*n), d(2*n)
      !> Forces of the slips, then moments of the relative rotations (2 n) [N, N m]
      real(wp), intent(out) :: g(2*n)
      integer :: i

      g(:n) = 0.0_wp
      call second_order_forces(n, axial, d, g, 1, g(n + 1:))
      ! A relative rotation turns all bodies above its joint: its moment is their sum, with the sign of dU.
      g(2*n) = -g(2*n)
      do i = 2*n - 1, n + 1, -1
         g(i) = g(i + 1) - g(i)
      end do
   end subroutine geometric_forces

   !> The potential U of axial forces in `second_order_forces` [J].
   pure real(wp) function second_order_energy(n, axial, d) result(energy)
      !> Number of bodies, and of joints
      integer, intent(in) :: n
      !> a and b of that potential, compression positive [N m, N]; slips and relative rotations [m, rad] (2 n)
      real(wp), intent(in) :: axial(2*n), d(2*n)
      real(wp) :: rotation, below
      integer :: i

      energy = 0.0_wp
      rotation = 0.0_wp
      do i = 1, n
         below = rotation
         rotation = rotation + d(n + i)
         energy = energy - (axial(n + i)*d(i)*below + 0.5_wp*rotation*(axial(i)*rotation))
      end do
   end function second_order_energy

   !> Add B' diag(k) B of the springs to a lower band, band(1 + i - j, j) = a(i, j); B gives deformations
   !> of the joints from displacements of the bodies.
   pure subroutine add_joint_stiffness(n, kinds, lower, upper, k, band)
      !> Number of bodies, and of joints
      integer, intent(in) :: n
      !> Kinds of deformations: 2, or 3 where joints open
      integer, intent(in) :: kinds
      !> Distances from the centroids to bottom and top of the bodies (n) [m]
      real(wp), intent(in) :: lower(n), upper(n)
      !> Stiffness of the joints against slip, relative rotation and opening (n each) [N/m, N m, N/m]
      real(wp), intent(in) :: k(kinds*n)
      !> Lower band of all unknowns, to which it is added
      real(wp), intent(inout) :: band(4, kinds*n)
      real(wp) :: shear, flexure, low, up
      integer :: i, t

      do i = 1, n
         shear = k(i)
         flexure = k(n + i)
         low = lower(i)
         ! Place of the rotation; its displacement comes before it.
         t = 2*i
         band(1, t - 1) = band(1, t - 1) + shear
         band(2, t - 1) = band(2, t - 1) - shear*low
         band(1, t) = band(1, t) + shear*low**2 + flexure
         if (i == 1) cycle
         ! Here i > 1; compilers that do not see it would warn of upper(0).
         up = upper(max(i - 1, 1))
         band(1, t - 3) = band(1, t - 3) + shear
         band(2, t - 3) = band(2, t - 3) + shear*up
         band(3, t - 3) = band(3, t - 3) - shear
         band(4, t - 3) = band(4, t - 3) + shear*low
         band(1, t - 2) = band(1, t - 2) + shear*up**2 + flexure
         band(2, t - 2) = band(2, t - 2) - shear*up
         band(3, t - 2) = band(3, t - 2) + shear*up*low - flexure
      end do
      if (kinds < 3) return
      do i = 2*n + 1, 3*n
         band(1, i) = band(1, i) + k(i)
         if (i == 2*n + 1) cycle
         band(1, i - 1) = band(1, i - 1) + k(i)
         band(2, i - 1) = band(2, i - 1) - k(i)
      end do
   end subroutine add_joint_stiffness

   !> Add the geometric stiffness, the second derivatives of the potential of `second_order_forces` by the
   !> displacements and rotations of the bodies, to a lower band, band(1 + i - j, j) = a(i, j).
   pure subroutine add_axial_stiffness(n, lower, upper, axial, band)
      !> Number of bodies, and of joints
      integer, intent(in) :: n
      !> Distances from the centroids to bottom and top (n) [m]; a and b of that potential (2 n) [N m, N]
      real(wp), intent(in) :: lower(n), upper(n), axial(2*n)
      !> Lower band of slips and rotations, to which it is added
      real(wp), intent(inout) :: band(4, 2*n)
      real(wp) :: force
      integer :: i, t

      do i = 1, n
         ! Place of the rotation; its displacement comes before it.
         t = 2*i
         band(1, t) = band(1, t) - axial(i)
         if (i == 1) cycle
         ! -b u_i th_{i-1}: the slip u_i holds displacement and rotation of both bodies.
         force = axial(n + i)
         band(2, t - 3) = band(2, t - 3) + force
         band(1, t - 2) = band(1, t - 2) + 2.0_wp*force*upper(max(i - 1, 1))
         band(2, t - 2) = band(2, t - 2) - force
         band(3, t - 2) = band(3, t - 2) + force*lower(i)
      end do
   end subroutine add_axial_stiffness

end module rbs_structure_column_chain
