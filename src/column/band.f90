!> The chain in centroid coordinates, where the mass is diagonal and joints couple neighbours only.
!>
!> Unknowns x = (x_1, th_1, x_2, th_2, ..., x_n, th_n [, y_1, ..., y_n]): displacement of the centroid [m]
!> and absolute rotation [rad] of every body, and, where joints open, its displacement along the column
!> [m]. Small rotations: the joints' deformations are d = B x with
!>
!>     u_i = x_i - lower_i th_i - x_{i-1} - upper_{i-1} th_{i-1},  phi_i = th_i - th_{i-1},
!>     w_i = y_i - y_{i-1}                                         (body 0 is the ground, at rest)
!>
!> so that stiffness is a band of half-width 3 in (x, th), kept as `band_matrix` wants it:
!> band(1 + i - j, j) = a(i, j) for j <= i <= j + 3. The openings are a tridiagonal chain of their own.
module rbs_column_band
   use rbs_base_kinds, only: wp
   use rbs_column_column, only: column_type
   implicit none
   private

   public :: add_spring_band, add_geometric_band, opening_band, to_joints

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

   !> Stiffness of the axial springs, tridiagonal in y.
   pure subroutine opening_band(column, k, band)
      type(column_type), intent(in) :: column
      !> Stiffness of the axial springs [N/m]
      real(wp), intent(in) :: k(column%n)
      !> Lower band
      real(wp), intent(out) :: band(4, column%n)
      integer :: n

      n = column%n
      band = 0.0_wp
      band(1, :) = k
      band(1, :n - 1) = k(:n - 1) + k(2:)
      band(2, :n - 1) = -k(2:)
   end subroutine opening_band

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

end module rbs_column_band
