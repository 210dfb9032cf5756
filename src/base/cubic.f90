!> Hermite's cubic over a step: values at both ends with their slopes, over the share s of the step, 0 to 1.
!> As an array c it is the first value, the last value, the first slope, the last slope.
module rbs_base_cubic
   use rbs_base_kinds, only: wp
   implicit none
   private

   public :: cubic_at, turns_of, bound_of, largest_of, first_at

   !> No cubic exceeds its end values by more than this share of the sum of its slopes there.
   real(wp), parameter, public :: beyond_ends = 4.0_wp/27.0_wp

contains

   !> Value at a share of the step; its change is reckoned from the first end.
   elemental real(wp) function cubic_at(s, first, last, first_slope, last_slope) result(value)
      !> Values at the ends, and slopes by s
      real(wp), intent(in) :: s, first, last, first_slope, last_slope

      value = last
      if (s < 1.0_wp) value = first + s*(first_slope*(1.0_wp - s)**2 &
                                         + s*((last - first)*(3.0_wp - 2.0_wp*s) - last_slope*(1.0_wp - s)))
   end function cubic_at

   !> The shares of the step at which the cubic has an extreme, ascending; 1 in place of an extreme that it
   !> does not have within the step.
   pure function turns_of(c) result(s)
      !> First value, last value, first slope, last slope
      real(wp), intent(in) :: c(4)
      real(wp) :: s(2), a, half, root, q

      s = 1.0_wp
      ! Half of the derivative is  a s**2/2 + half s + c(3)/2.
      a = 3.0_wp*(c(3) + c(4) - 2.0_wp*(c(2) - c(1)))
      half = 3.0_wp*(c(2) - c(1)) - 2.0_wp*c(3) - c(4)
      root = half**2 - a*c(3)
      if (.not. root > 0.0_wp) return
      ! The larger of both in size first, so that nothing cancels.
      q = -(half + sign(sqrt(root), half))
      s(1) = share_of(c(3), q)
      s(2) = share_of(q, a)
      if (s(1) > s(2)) s = s([2, 1])
   end function turns_of

   !> The quotient part/whole where it is between 0 and 1, else 1.
   pure real(wp) function share_of(part, whole) result(share)
      real(wp), intent(in) :: part, whole

      share = 1.0_wp
      if (abs(part) < abs(whole) .and. part*whole > 0.0_wp) share = part/whole
   end function share_of

   !> A number that the cubic does not exceed in size within the step.
   pure real(wp) function bound_of(c) result(bound)
      !> First value, last value, first slope, last slope
      real(wp), intent(in) :: c(4)

      bound = max(abs(c(1)), abs(c(2))) + beyond_ends*(abs(c(3)) + abs(c(4)))
   end function bound_of

   !> The value of the cubic within the step that is largest in size, with its sign.
   pure real(wp) function largest_of(c) result(largest)
      !> First value, last value, first slope, last slope
      real(wp), intent(in) :: c(4)
      real(wp) :: value(4)

      value = [c(1), cubic_at(turns_of(c), c(1), c(2), c(3), c(4)), c(2)]
      largest = value(maxloc(abs(value), dim=1))
   end function largest_of

   !> The first share at which the cubic reaches a value from below; 2 if it does not within the step.
   pure real(wp) function first_at(c, value) result(s)
      !> First value, last value, first slope, last slope; the value to reach
      real(wp), intent(in) :: c(4), value
      real(wp) :: node(4), low, high
      integer :: i

      ! Between two of these shares the cubic only rises or only falls.
      node = [0.0_wp, turns_of(c), 1.0_wp]
      i = findloc(cubic_at(node, c(1), c(2), c(3), c(4)) >= value, .true., dim=1)
      ! Reached at the start, or at none of these shares.
      s = merge(0.0_wp, 2.0_wp, i == 1)
      if (i < 2) return
      ! It rises between these two: bisect.
      low = node(i - 1)
      high = node(i)
      do
         s = 0.5_wp*(low + high)
         if (.not. (s > low .and. s < high)) exit
         if (cubic_at(s, c(1), c(2), c(3), c(4)) >= value) then
            high = s
         else
            low = s
         end if
      end do
      s = high
   end function first_at

end module rbs_base_cubic
