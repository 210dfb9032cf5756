!> A contact: elastic while the joint is closed, without force while it is open.
module rbs_hysteresis_compression
   use rbs_base_kinds, only: wp
   use rbs_base_constants, only: unbounded
   use rbs_hysteresis_rule, only: rule_type
   use rbs_hysteresis_segment, only: segment
   implicit none
   private

   public :: compression_rule

   type, extends(rule_type) :: compression_rule
      !> Stiffness of the closed joint [N/m]
      real(wp) :: k = 0.0_wp
   contains
      procedure :: start
      procedure :: next
   end type compression_rule

contains

   !> The joint is closed at zero opening; openings are positive.
   subroutine start(self, line)
      class(compression_rule), intent(inout) :: self
      type(segment), intent(out) :: line

      line = segment(k=self%k, hi=0.0_wp, hi_closed=.true.)
   end subroutine start

   subroutine next(self, line, direction)
      class(compression_rule), intent(inout) :: self
      type(segment), intent(inout) :: line
      integer, intent(in) :: direction

      if (direction > 0) then
         line = segment(k=0.0_wp, lo=0.0_wp, hi=unbounded)
      else
         line = segment(k=self%k, lo=-unbounded, hi=0.0_wp, hi_closed=.true.)
      end if
   end subroutine next

end module rbs_hysteresis_compression
