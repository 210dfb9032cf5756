!> Where the top of a column is, at every level of kinematics, and how far its bodies have turned.
module rbs_column_top
   use rbs_base_inner_product, only: inner_product
   use rbs_base_kinds, only: wp
   use rbs_column_column, only: column_type, small, finite
   use rbs_column_finite, only: finite_top
   implicit none
   private

   public :: top_position, top_displacement, largest_turn

contains

   !> Position of the top (x, y) [m].
   pure function top_position(column, q) result(top)
      type(column_type), intent(in) :: column
      !> Deformations (unknowns)
      real(wp), intent(in), contiguous :: q(:)
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
            if (i < n .or. .not. column%held) top(2) = top(2) - q(i)*rotation
            rotation = rotation + q(n + i)
            top(2) = top(2) - 0.5_wp*column%length(i)*rotation**2
         end do
      end if
      if (column%opens) top(2) = top(2) + sum(q(2*n + 1:))
   end function top_position

   !> Displacement of the top along x [m]; asked for in every step.
   pure real(wp) function top_displacement(column, q) result(x)
      type(column_type), intent(in) :: column
      !> Deformations (unknowns)
      real(wp), intent(in), contiguous :: q(:)
      real(wp) :: top(2)

      if (column%kinematics == finite) then
         if (column%unknowns == 2) then
            x = q(1) + column%length(1)*sin(q(2))
         else
            top = finite_top(column, q)
            x = top(1)
         end if
      else if (column%unknowns == 2) then
         x = q(1) + column%length(1)*q(2)
      else
         x = inner_product(size(q), column%arm, q)
      end if
   end function top_displacement

   !> Largest absolute rotation of a body in deformations, or in a change of them, in size [rad].
   pure real(wp) function largest_turn(column, change) result(largest)
      type(column_type), intent(in) :: column
      real(wp), intent(in) :: change(:)
      real(wp) :: rotation
      integer :: i

      largest = 0.0_wp
      rotation = 0.0_wp
      do i = column%n + 1, 2*column%n
         rotation = rotation + change(i)
         largest = max(largest, abs(rotation))
      end do
   end function largest_turn

end module rbs_column_top
