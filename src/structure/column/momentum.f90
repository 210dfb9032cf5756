!> Momentum of a column relative to the ground, at every level of kinematics.
module rbs_structure_column_momentum
   use rbs_base_kinds, only: wp
   use rbs_structure_column_column, only: column_type, finite
   use rbs_structure_column_finite, only: finite_momentum
   use rbs_structure_spring_place, only: shear, flexure
   implicit none
   private

   public :: momentum_at_foot

contains

   !> Momentum along x [kg m/s], and angular momentum about the lowest joint, as it has slipped and opened
   !> [kg m2/s]. They are conjugate to slip and rotation of that joint: the first rows of M q'.
   pure function momentum_at_foot(column, q, v) result(momentum)
      type(column_type), intent(in) :: column
      !> Deformations and their velocities (unknowns)
      real(wp), intent(in) :: q(column%n, column%kinds), v(column%n, column%kinds)
      real(wp) :: momentum(2)

      if (column%kinematics == finite) then
         momentum = finite_momentum(column, q, v)
      else
         momentum = of_upright_bodies(column, v)
      end if
   end function momentum_at_foot

   !> With small rotations: the centroids move along x at their heights.
   pure function of_upright_bodies(column, v) result(momentum)
      type(column_type), intent(in) :: column
      real(wp), intent(in) :: v(column%n, column%kinds)
      real(wp) :: momentum(2)
      real(wp) :: top, turning, centroid
      integer :: i

      momentum = 0.0_wp
      top = 0.0_wp
      turning = 0.0_wp
      do i = 1, column%n
         turning = turning + v(i, flexure)
         centroid = top + v(i, shear) + column%lower(i)*turning
         top = centroid + column%upper(i)*turning
         momentum(1) = momentum(1) + column%mass(i)*centroid
         momentum(2) = momentum(2) + column%mass(i)*centroid*(column%joint_height(i) + column%lower(i)) &
                       + column%inertia(i)*turning
      end do
   end function of_upright_bodies

end module rbs_structure_column_momentum
