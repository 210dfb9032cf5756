!> Where a function of one variable vanishes between two values at which it has opposite signs: the method of
!> false position, where the end that stays counts half (Illinois).
module rbs_solve_line_search
   use rbs_base_kinds, only: wp
   implicit none
   private

   public :: false_position

   type :: false_position
      !> The ends, and the function there
      real(wp) :: low = 0.0_wp, high = 1.0_wp, at_low = 0.0_wp, at_high = 0.0_wp
   contains
      procedure :: next, narrow
   end type false_position

contains

   !> The next trial: where the straight line through the values at both ends vanishes.
   pure real(wp) function next(self)
      class(false_position), intent(in) :: self

      next = self%low + (self%high - self%low)*self%at_low/(self%at_low - self%at_high)
   end function next

   !> Take the value at a trial into account: the trial takes the place of the end whose value has the same
   !> sign, low where it is positive. The value at the end that stays is halved (Illinois), so that this end
   !> moves soon too.
   pure subroutine narrow(self, x, value)
      class(false_position), intent(inout) :: self
      !> The trial, and the function there
      real(wp), intent(in) :: x, value

      if (value > 0.0_wp) then
         self%low = x
         self%at_low = value
         self%at_high = 0.5_wp*self%at_high
      else
         self%high = x
         self%at_high = value
         self%at_low = 0.5_wp*self%at_low
      end if
   end subroutine narrow

end module rbs_solve_line_search
