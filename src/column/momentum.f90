!> Momentum of a column relative to the ground, at every level of kinematics.
module rbs_column_momentum
   use rbs_base_kinds, only: wp
   use rbs_column_column, only: column_type, finite
   use rbs_structure_spring_place, only: shear, flexure, axial
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
         momentum = of_turned_bodies(column, q, v)
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

   !> With exact rotations: places and velocities of the centroids, from the ground up.
   pure function of_turned_bodies(column, q, v) result(momentum)
      type(column_type), intent(in) :: column
      real(wp), intent(in) :: q(column%n, column%kinds), v(column%n, column%kinds)
      real(wp) :: momentum(2)
      !> Top of the body below, its velocity, its axis and normal; rotation and its rate
      real(wp) :: place(2), velocity(2), axis(2), normal(2), rotation, spin
      !> Slip and opening with their velocities; the foot; the centroid seen from it, and its velocity
      real(wp) :: slip, opening, slipping, rising, foot(2), lever(2), centroid(2)
      integer :: i, n

      n = column%n
      momentum = 0.0_wp
      place = 0.0_wp
      velocity = 0.0_wp
      foot = 0.0_wp
      axis = [0.0_wp, 1.0_wp]
      normal = [1.0_wp, 0.0_wp]
      rotation = 0.0_wp
      spin = 0.0_wp
      opening = 0.0_wp
      rising = 0.0_wp
      do i = 1, n
         if (i == n .and. column%held) then
            ! The joint of a held top moves along fixed directions.
            axis = [0.0_wp, 1.0_wp]
            normal = [1.0_wp, 0.0_wp]
            spin = 0.0_wp
         end if
         slip = q(i, shear)
         slipping = v(i, shear)
         if (column%opens) then
            opening = q(i, axial)
            rising = v(i, axial)
         end if
         place = place + slip*normal + opening*axis
         velocity = velocity + (slipping + opening*spin)*normal + (rising - slip*spin)*axis
         if (i == 1) foot = place
         rotation = rotation + q(i, flexure)
         if (.not. (i == n .and. column%held)) spin = spin + v(i, flexure)
         axis = [sin(rotation), cos(rotation)]
         normal = [axis(2), -axis(1)]
         lever = place + column%lower(i)*axis - foot
         centroid = velocity + column%lower(i)*spin*normal
         momentum(1) = momentum(1) + column%mass(i)*centroid(1)
         momentum(2) = momentum(2) + column%mass(i)*(centroid(1)*lever(2) - centroid(2)*lever(1)) &
                       + column%inertia(i)*spin
         place = place + column%length(i)*axis
         velocity = velocity + column%length(i)*spin*normal
      end do
   end function of_turned_bodies

end module rbs_column_momentum
