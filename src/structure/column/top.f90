!> Where the top of a column is, at every level of kinematics, and how far its bodies have turned.
module rbs_structure_column_top
   use rbs_base_inner_product, only: inner_product
   use rbs_base_kinds, only: wp
   use rbs_structure_column_column, only: column_type, small, finite
   use rbs_structure_spring_place, only: shear, flexure, axial
   use rbs_structure_column_finite, only: finite_top
   implicit none
   private

   public :: top_motion, top_position, top_displacement, largest_turn

contains

   !> Position of the top (x, y) [m].
   pure function top_position(column, q) result(top)
      type(column_type), intent(in) :: column
      !> Deformations (unknowns)
      real(wp), intent(in) :: q(column%n, column%kinds)
      real(wp) :: top(2)
      real(wp) :: rotation
      integer :: i, n

      n = column%n
      if (column%kinematics == finite) then
         top = finite_top(column, q)
         return
      end if
      top(1) = inner_product(size(q), column%arm, q)
      top(2) = column%joint_height(n + 1)
      if (column%kinematics /= small) then
         ! To second order: this is the way on which the axial load does its work.
         rotation = 0.0_wp
         do i = 1, n
            if (i < n .or. .not. column%held) top(2) = top(2) - q(i, shear)*rotation
            rotation = rotation + q(i, flexure)
            top(2) = top(2) - 0.5_wp*column%length(i)*rotation**2
         end do
      end if
      if (column%opens) top(2) = top(2) + sum(q(:, axial))
   end function top_position

   !> Velocity and acceleration of the top along x, relative to the ground [m/s, m/s2].
   pure subroutine top_motion(column, q, v, a, velocity, acceleration)
      type(column_type), intent(in) :: column
      !> Deformations and their first and second derivatives (unknowns)
      real(wp), intent(in) :: q(column%n, column%kinds), v(column%n, column%kinds), a(column%n, column%kinds)
      real(wp), intent(out) :: velocity, acceleration
      real(wp) :: rotation, spin, turn, s, c, opening, opens, lifts
      integer :: i, n

      if (column%kinematics /= finite) then
         velocity = inner_product(size(v), column%arm, v)
         acceleration = inner_product(size(a), column%arm, a)
         return
      end if
      n = column%n
      velocity = 0.0_wp
      acceleration = 0.0_wp
      rotation = 0.0_wp
      spin = 0.0_wp
      turn = 0.0_wp
      opening = 0.0_wp
      opens = 0.0_wp
      lifts = 0.0_wp
      do i = 1, n
         s = sin(rotation)
         c = cos(rotation)
         if (column%opens) then
            opening = q(i, axial)
            opens = v(i, axial)
            lifts = a(i, axial)
         end if
         velocity = velocity + (v(i, shear) + opening*spin)*c + (opens - q(i, shear)*spin)*s
         acceleration = acceleration + (a(i, shear) + 2.0_wp*opens*spin + opening*turn &
                                        - q(i, shear)*spin**2)*c &
                        + (lifts - 2.0_wp*v(i, shear)*spin - q(i, shear)*turn - opening*spin**2)*s
         rotation = rotation + q(i, flexure)
         spin = spin + v(i, flexure)
         turn = turn + a(i, flexure)
         velocity = velocity + column%length(i)*cos(rotation)*spin
         acceleration = acceleration + column%length(i)*(cos(rotation)*turn - sin(rotation)*spin**2)
      end do
   end subroutine top_motion

   !> Displacement of the top along x [m]; asked for in every step.
   pure real(wp) function top_displacement(column, q) result(x)
      type(column_type), intent(in) :: column
      !> Deformations (unknowns)
      real(wp), intent(in) :: q(column%n, column%kinds)
      real(wp) :: top(2)

      if (column%kinematics == finite) then
         if (column%unknowns == 2) then
            x = q(1, shear) + column%length(1)*sin(q(1, flexure))
         else
            top = finite_top(column, q)
            x = top(1)
         end if
      else if (column%unknowns == 2) then
         x = q(1, shear) + column%length(1)*q(1, flexure)
      else
         x = inner_product(size(q), column%arm, q)
      end if
   end function top_displacement

   !> Largest absolute rotation of a body in deformations, or in a change of them, in size [rad].
   pure real(wp) function largest_turn(column, change) result(largest)
      type(column_type), intent(in) :: column
      real(wp), intent(in) :: change(column%n, 2)
      real(wp) :: rotation
      integer :: i

      largest = 0.0_wp
      rotation = 0.0_wp
      do i = 1, column%n
         rotation = rotation + change(i, flexure)
         largest = max(largest, abs(rotation))
      end do
   end function largest_turn

end module rbs_structure_column_top
