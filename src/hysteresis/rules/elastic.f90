!> A spring that stays on one straight line.
module rbs_hysteresis_rules_elastic
   use rbs_base_constants, only: unset
   use rbs_base_key_visitor, only: key_visitor
   use rbs_base_keys, only: above_zero, stiffness
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_rule, only: rule_type, rule_memory
   use rbs_hysteresis_segment, only: segment
   implicit none
   private

   public :: elastic_rule

   type, extends(rule_type) :: elastic_rule
      !> Stiffness [N/m or N m/rad]
      real(wp) :: k = unset
   contains
      procedure :: visit, prepare, next
   end type elastic_rule

contains

   !> Present the parameters to a visitor.
   subroutine visit(self, v)
      class(elastic_rule), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%key('k', self%k, stiffness, above_zero, 'stiffness')
   end subroutine visit

   !> Initial stiffness and the only branch.
   subroutine prepare(self)
      class(elastic_rule), intent(inout) :: self

      self%initial_stiffness = self%k
      self%branch%k = self%k
   end subroutine prepare

   !> Called only for deformations beyond the largest number: the branch continues.
   subroutine next(self, memory, branch, direction)
      class(elastic_rule), intent(in) :: self
      class(rule_memory), intent(inout) :: memory
      type(segment), intent(inout) :: branch
      integer, intent(in) :: direction

      branch%k = self%k
   end subroutine next

end module rbs_hysteresis_rules_elastic
