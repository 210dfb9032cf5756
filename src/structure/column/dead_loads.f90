!> Dead loads on the column: forces and stiffness from one potential, with exact rotations
!>
!>     A = sum P_i l_i cos th_i + sum Q_i (-u_i sin th_{i-1} + w_i cos th_{i-1}) - F x_T
!>     x_T = sum l_i sin th_i + u_i cos th_{i-1} + w_i sin th_{i-1}
!>
!> or, with the other kinematics, to second order without what the lateral force does on rotated bodies and
!> the axial loads on openings of rotated joints. P = `axial_body`, Q = `axial_joint` (`axial_slip` on slips),
!> th_0 = 0. In absolute rotations joints meet only their neighbours. Unknowns stand joint by joint here:
!> slip, opening if there is one, absolute rotation.
module rbs_structure_column_dead_loads
   use rbs_base_kinds, only: wp
   use rbs_structure_column_column, only: column_type, finite
   use rbs_structure_spring_place, only: shear, flexure, axial
   implicit none
   private

   public :: per_joint, dead_loads, add_springs, to_joints

contains

   !> Number of unknowns of a joint: also the number of diagonals beside the main one.
   elemental integer function per_joint(column)
      type(column_type), intent(in) :: column

      per_joint = merge(3, 2, column%opens)
   end function per_joint

   !> Generalised loads -dA/dz, arms dx_T/dz and stiffness d2A/dz2.
   pure subroutine dead_loads(column, q, force, load, arm, band, top)
      type(column_type), intent(in) :: column
      !> Deformations of the joints (unknowns)
      real(wp), intent(in) :: q(column%n, column%kinds)
      !> Lateral force F [N]
      real(wp), intent(in) :: force
      !> Loads [N, N, N m] and arms [1, 1, m] (unknowns, joint by joint)
      real(wp), intent(out), contiguous :: load(:), arm(:)
      !> Lower band (per_joint + 1, unknowns), as `band_matrix` takes it
      real(wp), intent(out), contiguous :: band(:, :)
      !> Displacement of the top [m]
      real(wp), intent(out) :: top
      real(wp) :: rotation, s, c, across, along, opening, exact
      integer :: i, j, n, per

      n = column%n
      per = per_joint(column)
      exact = merge(1.0_wp, 0.0_wp, column%kinematics == finite)
      band = 0.0_wp
      top = 0.0_wp
      rotation = 0.0_wp
      s = 0.0_wp
      c = 1.0_wp
      opening = 0.0_wp
      do i = 1, n
         if (i == n .and. column%held) then
            ! What is held does not turn, and its joint moves along its directions.
            s = 0.0_wp
            c = 1.0_wp
         end if
         ! Forces of the loads above, across and along the body below the joint.
         across = force*c + column%axial_slip(i)*s
         along = exact*force*s - column%axial_slip(i)*c
         j = per*(i - 1)
         if (column%opens) opening = q(i, axial)
         load(j + 1) = across
         arm(j + 1) = c
         top = top + q(i, shear)*c + exact*opening*s
         if (column%opens) then
            load(j + 2) = exact*force*s - column%axial_joint(i)*c
            arm(j + 2) = exact*s
         end if
         if (i > 1 .and. .not. (i == n .and. column%held)) then
            load(j) = load(j) - q(i, shear)*along + exact*opening*across
            arm(j) = arm(j) - exact*(q(i, shear)*s - opening*c)
            band(1, j) = band(1, j) + exact*(q(i, shear)*across + opening*along)
            band(2, j) = along
            if (column%opens) band(3, j) = -exact*across
         end if
         rotation = rotation + q(i, flexure)
         if (exact > 0.0_wp) then
            s = sin(rotation)
            c = cos(rotation)
         else
            s = rotation
         end if
         j = per*i
         load(j) = column%length(i)*(force*c + column%axial_body(i)*s)
         arm(j) = column%length(i)*c
         band(1, j) = column%length(i)*(exact*force*s - column%axial_body(i)*c)
         top = top + column%length(i)*s
      end do
   end subroutine dead_loads

   !> Take the forces of the springs from the loads and add their stiffness.
   pure subroutine add_springs(column, f, k, load, band)
      type(column_type), intent(in) :: column
      !> Forces and stiffness of the springs (unknowns)
      real(wp), intent(in) :: f(column%n, column%kinds), k(column%n, column%kinds)
      real(wp), intent(inout), contiguous :: load(:), band(:, :)
      integer :: i, j, n, per

      n = column%n
      per = per_joint(column)
      do i = 1, n
         j = per*(i - 1)
         load(j + 1) = load(j + 1) - f(i, shear)
         band(1, j + 1) = band(1, j + 1) + k(i, shear)
         if (column%opens) then
            load(j + 2) = load(j + 2) - f(i, axial)
            band(1, j + 2) = band(1, j + 2) + k(i, axial)
         end if
         load(j + per) = load(j + per) - f(i, flexure)
         band(1, j + per) = band(1, j + per) + k(i, flexure)
         if (i == 1) cycle
         load(j) = load(j) + f(i, flexure)
         band(1, j) = band(1, j) + k(i, flexure)
         band(per + 1, j) = band(per + 1, j) - k(i, flexure)
      end do
   end subroutine add_springs

   !> Changes of the deformations of the joints from those of the unknowns joint by joint.
   pure subroutine to_joints(column, per, z, q)
      type(column_type), intent(in) :: column
      !> Unknowns of a joint in z: 2 if the openings keep still
      integer, intent(in) :: per
      real(wp), intent(in), contiguous :: z(:)
      !> (unknowns, or 2 n of them)
      real(wp), intent(out) :: q(column%n, per)
      real(wp) :: below
      integer :: i, n

      n = column%n
      below = 0.0_wp
      do i = 1, n
         q(i, shear) = z(per*(i - 1) + 1)
         q(i, flexure) = z(per*i) - below
         below = z(per*i)
         if (per == 3) q(i, axial) = z(per*(i - 1) + 2)
      end do
   end subroutine to_joints

end module rbs_structure_column_dead_loads
