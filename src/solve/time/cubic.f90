!> Cubics on a step: through four values at its start, its thirds and its end.
module rbs_solve_time_cubic
   use rbs_base_kinds, only: wp
   implicit none
   private

   public :: cubic_type, cubic_through

   !> c(1) + c(2) s + c(3) s**2 + c(4) s**3, s from 0 to 1.
   type :: cubic_type
      real(wp) :: c(4) = 0.0_wp
      !> Its value at the end, to the last bit
      real(wp) :: last = 0.0_wp
   contains
      procedure :: at
      procedure :: largest
      procedure :: first_at
      procedure, private :: turns
   end type cubic_type

contains

   pure type(cubic_type) function cubic_through(value) result(cubic)
      !> At 0, 1/3, 2/3 and 1
      real(wp), intent(in) :: value(4)
      real(wp) :: d1, d2, d3

      ! Differences: values that are equal have coefficients that vanish.
      d1 = value(2) - value(1)
      d2 = value(3) - value(2)
      d3 = value(4) - value(3)
      cubic%last = value(4)
      cubic%c(1) = value(1)
      cubic%c(2) = 0.5_wp*(11.0_wp*d1 - 7.0_wp*d2 + 2.0_wp*d3)
      cubic%c(3) = 4.5_wp*(-2.0_wp*d1 + 3.0_wp*d2 - d3)
      cubic%c(4) = 4.5_wp*(d1 - 2.0_wp*d2 + d3)
   end function cubic_through

   pure real(wp) function at(self, s)
      class(cubic_type), intent(in) :: self
      real(wp), intent(in) :: s

      at = self%last
      if (s < 1.0_wp) at = self%c(1) + s*(self%c(2) + s*(self%c(3) + s*self%c(4)))
   end function at

   !> Where it turns within the step, in order; 1 where it does not.
   pure function turns(self) result(s)
      class(cubic_type), intent(in) :: self
      real(wp) :: s(2), a, half, root, q

      s = 1.0_wp
      a = 3.0_wp*self%c(4)
      half = self%c(3)
      root = half**2 - a*self%c(2)
      if (.not. root > 0.0_wp) return
      ! The larger of both in size first, so that nothing cancels.
      q = -(half + sign(sqrt(root), half))
      s(1) = share_of(self%c(2), q)
      s(2) = share_of(q, a)
      if (s(1) > s(2)) s = s([2, 1])
   end function turns

   !> A quotient, 1 where it is not between 0 and 1.
   pure real(wp) function share_of(part, whole) result(share)
      real(wp), intent(in) :: part, whole

      share = 1.0_wp
      if (abs(part) < abs(whole) .and. part*whole > 0.0_wp) share = part/whole
   end function share_of

   !> The value that is largest in size, with its sign.
   pure real(wp) function largest(self)
      class(cubic_type), intent(in) :: self
      real(wp) :: value(4), s(2)

      s = self%turns()
      value = [self%c(1), self%at(s(1)), self%at(s(2)), self%last]
      largest = value(maxloc(abs(value), dim=1))
   end function largest

   !> Where it first has a value or is above it; 2 if it does not within the step.
   pure real(wp) function first_at(self, value) result(s)
      class(cubic_type), intent(in) :: self
      real(wp), intent(in) :: value
      real(wp) :: way(3), low, high
      integer :: i

      s = 0.0_wp
      if (self%c(1) >= value) return
      way(:2) = self%turns()
      way(3) = 1.0_wp
      low = 0.0_wp
      do i = 1, 3
         high = way(i)
         if (self%at(high) >= value) exit
         low = high
      end do
      s = 2.0_wp
      if (i > 3) return
      ! It rises from the one to the other.
      do
         s = 0.5_wp*(low + high)
         if (.not. (s > low .and. s < high)) exit
         if (self%at(s) >= value) then
            high = s
         else
            low = s
         end if
      end do
      s = high
   end function first_at

end module rbs_solve_time_cubic
