!> The chain in centroid coordinates, where the mass is diagonal and joints couple neighbours only.
!>
!> Unknowns x = (x_1, th_1, x_2, th_2, ..., x_n, th_n [, y_1, ..., y_n]): displacement of the centroid [m]
!> and absolute rotation [rad] of every body, and, where joints open, its displacement along the column
!> [m]. Small rotations: the joints' deformations are d = B x with
!>
!>     u_i = x_i - lower_i th_i - x_{i-1} - upper_{i-1} th_{i-1},  phi_i = th_i - th_{i-1},
!>     w_i = y_i - y_{i-1}                                         (body 0 is the ground, at rest)
!>
!> so that stiffness is a band of half-width 3 in (x, th), kept as `factor_band` wants it:
!> band(1 + i - j, j) = a(i, j) for j <= i <= j + 3. The openings are a tridiagonal chain of their own.
module rbs_column_band
   use rbs_base_kinds, only: wp
   use rbs_column_column, only: column_type
   implicit none
   private

   public :: add_spring_band, add_geometric_band, add_mass_band, hold_last, opening_stiffness
   public :: to_joints, from_joints

contains

   !> Add B' diag(k) B of shear and flexural springs.
   pure subroutine add_spring_band(column, k, band)
      type(column_type), intent(in) :: column
      !> Stiffness of the joints, shear then flexure [N/m, N m]; what follows is not read
      real(wp), intent(in) :: k(2*column%n)
      !> Lower band
      real(wp), intent(inout) :: band(4, 2*column%n)
      real(wp) :: shear, flexure, lower, upper
      integer :: i, n, t

      n = column%n
      do i = 1, n
         shear = k(i)
         flexure = k(n + i)
         lower = column%lower(i)
         ! Place of the rotation; its displacement stands before it.
         t = 2*i
         band(1, t - 1) = band(1, t - 1) + shear
         band(2, t - 1) = band(2, t - 1) - shear*lower
         band(1, t) = band(1, t) + shear*lower**2 + flexure
         if (i == 1) cycle
         upper = column%upper(i - 1)
         band(1, t - 3) = band(1, t - 3) + shear
         band(2, t - 3) = band(2, t - 3) + shear*upper
         band(3, t - 3) = band(3, t - 3) - shear
         band(4, t - 3) = band(4, t - 3) + shear*lower
         band(1, t - 2) = band(1, t - 2) + shear*upper**2 + flexure
         band(2, t - 2) = band(2, t - 2) - shear*upper
         band(3, t - 2) = band(3, t - 2) + shear*upper*lower - flexure
      end do
   end subroutine add_spring_band

   !> Add the second derivatives of the potential of axial forces, compression positive,
   !>
   !>     -sum axial_body_i l_i th_i^2/2 - sum axial_joint_i u_i th_{i-1}.
   pure subroutine add_geometric_band(column, axial_body, axial_joint, band)
      type(column_type), intent(in) :: column
      !> Axial force for the rotation of each body and across the slip of each joint [N]
      real(wp), intent(in) :: axial_body(column%n), axial_joint(column%n)
      !> Lower band
      real(wp), intent(inout) :: band(4, 2*column%n)
      real(wp) :: force
      integer :: i, t

      do i = 1, column%n
         t = 2*i
         band(1, t) = band(1, t) - axial_body(i)*column%length(i)
         if (i == 1) cycle
         force = axial_joint(i)
         band(2, t - 3) = band(2, t - 3) + force
         band(1, t - 2) = band(1, t - 2) + 2.0_wp*force*column%upper(i - 1)
         band(2, t - 2) = band(2, t - 2) - force
         band(3, t - 2) = band(3, t - 2) + force*column%lower(i)
      end do
   end subroutine add_geometric_band

   !> Add masses and rotary inertias, times a factor.
   pure subroutine add_mass_band(column, factor, band)
      type(column_type), intent(in) :: column
      real(wp), intent(in) :: factor
      !> Lower band
      real(wp), intent(inout) :: band(4, 2*column%n)
      integer :: i

      do i = 1, column%n
         band(1, 2*i - 1) = band(1, 2*i - 1) + factor*column%mass(i)
         band(1, 2*i) = band(1, 2*i) + factor*column%inertia(i)
      end do
   end subroutine add_mass_band

   !> Hold the last unknown of a band, the rotation of a held top: it couples with nothing.
   pure subroutine hold_last(band, diagonal)
      !> Lower band (half-width + 1 or more, unknowns)
      real(wp), intent(inout) :: band(:, :)
      !> What stands on the diagonal in its place
      real(wp), intent(in) :: diagonal
      integer :: i, last

      last = size(band, 2)
      do i = 2, min(size(band, 1), last)
         band(i, last + 1 - i) = 0.0_wp
      end do
      band(1, last) = diagonal
   end subroutine hold_last

   !> Stiffness of the axial springs, tridiagonal in y.
   pure subroutine opening_stiffness(column, k, diagonal, beside)
      type(column_type), intent(in) :: column
      !> Stiffness of the axial springs [N/m]
      real(wp), intent(in) :: k(column%n)
      !> Diagonal, and the numbers beside it
      real(wp), intent(out) :: diagonal(column%n), beside(column%n - 1)
      integer :: i, n

      n = column%n
      do i = 1, n - 1
         diagonal(i) = k(i) + k(i + 1)
         beside(i) = -k(i + 1)
      end do
      diagonal(n) = k(n)
   end subroutine opening_stiffness

   !> Deformations of the joints, d = B x.
   pure subroutine to_joints(column, x, d)
      type(column_type), intent(in) :: column
      !> Displacements and rotations of the bodies
      real(wp), intent(in) :: x(column%unknowns)
      !> Slips, relative rotations [, openings]
      real(wp), intent(out) :: d(column%unknowns)
      real(wp) :: below, turned
      integer :: i, n

      n = column%n
      ! Displacement of the top of the body below, and its rotation
      below = 0.0_wp
      turned = 0.0_wp
      do i = 1, n
         d(i) = (x(2*i - 1) - column%lower(i)*x(2*i)) - below
         d(n + i) = x(2*i) - turned
         turned = x(2*i)
         below = x(2*i - 1) + column%upper(i)*turned
      end do
      if (.not. column%opens) return
      d(2*n + 1) = x(2*n + 1)
      do i = 2, n
         d(2*n + i) = x(2*n + i) - x(2*n + i - 1)
      end do
   end subroutine to_joints

   !> Forces on the bodies that do the same work as forces in the joints, r = B' f.
   pure subroutine from_joints(column, f, r)
      type(column_type), intent(in) :: column
      !> Shear forces, moments [, axial forces] of the joints [N, N m, N]
      real(wp), intent(in) :: f(column%unknowns)
      !> Force and moment about the centroid of every body
      real(wp), intent(out) :: r(column%unknowns)
      integer :: i, n

      n = column%n
      do i = 1, n - 1
         r(2*i - 1) = f(i) - f(i + 1)
         r(2*i) = f(n + i) - f(n + i + 1) - column%lower(i)*f(i) - column%upper(i)*f(i + 1)
      end do
      r(2*n - 1) = f(n)
      r(2*n) = f(2*n) - column%lower(n)*f(n)
      if (.not. column%opens) return
      do i = 1, n - 1
         r(2*n + i) = f(2*n + i) - f(2*n + i + 1)
      end do
      r(3*n) = f(3*n)
   end subroutine from_joints

end module rbs_column_band
