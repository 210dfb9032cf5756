!> A spring that stays on one line.
module rbs_hysteresis_elastic
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_rule, only: rule_type
   use rbs_hysteresis_segment, only: segment
   implicit none
   private

   public :: elastic_rule

   type, extends(rule_type) :: elastic_rule
      !> Stiffness [N/m or N m/rad]
      real(wp) :: k = 0.0_wp
   contains
      procedure :: start
      procedure :: next
   end type elastic_rule

contains

   subroutine start(self, line)
      class(elastic_rule), intent(inout) :: self
      type(segment), intent(out) :: line

      line%k = self%k
   end subroutine start

   !> Reached only beyond the largest number: the line goes on.
   subroutine next(self, line, direction)
      class(elastic_rule), intent(inout) :: self
      type(segment), intent(inout) :: line
      integer, intent(in) :: direction

      line%k = self%k
      line%one_way = 0*direction
   end subroutine next

end module rbs_hysteresis_elastic
