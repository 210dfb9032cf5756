!> A spring that stays on one straight line.
module rbs_hysteresis_rules_elastic
   use rbs_base_keys, only: key_type, above_zero, stiffness
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_rule, only: rule_type, rule_memory
   use rbs_hysteresis_segment, only: segment
   implicit none
   private

   public :: elastic_rule

   type(key_type), parameter, public :: elastic_keys(*) = [ &
      key_type('k', unit=stiffness, bound=above_zero, &
               meaning='stiffness')]

   type, extends(rule_type) :: elastic_rule
      !> Stiffness [N/m or N m/rad]
      real(wp) :: k = 0.0_wp
   contains
      procedure :: set
      procedure :: start
      procedure :: next
   end type elastic_rule

contains

   pure subroutine set(self, value)
      class(elastic_rule), intent(inout) :: self
      real(wp), intent(in) :: value(:)

      self%k = value(1)
      self%initial_stiffness = self%k
   end subroutine set

   subroutine start(self, memory, branch)
      class(elastic_rule), intent(in) :: self
      class(rule_memory), allocatable, intent(out) :: memory
      type(segment), intent(out) :: branch

      allocate (memory)
      branch%k = self%k
   end subroutine start

   !> Called only for deformations beyond the largest number: the branch continues.
   subroutine next(self, memory, branch, direction)
      class(elastic_rule), intent(in) :: self
      class(rule_memory), intent(inout) :: memory
      type(segment), intent(inout) :: branch
      integer, intent(in) :: direction

      branch%k = self%k
      if (.false.) memory%flexural_work = real(direction, wp)      ! there is no memory: the branch says all
   end subroutine next

end module rbs_hysteresis_rules_elastic
