!> A contact: elastic while the joint is closed, without force while it is open. With a gap it closes only
!> after the joint has closed by that much.
module rbs_hysteresis_rules_compression
   use rbs_base_key_visitor, only: key_visitor
   use rbs_base_keys, only: above_zero, not_negative, deformation, stiffness
   use rbs_base_kinds, only: wp
   use rbs_base_constants, only: unbounded, unset
   use rbs_hysteresis_rule, only: rule_type, rule_memory
   use rbs_hysteresis_segment, only: segment
   implicit none
   private

   public :: compression_rule

   type, extends(rule_type) :: compression_rule
      !> Stiffness of the closed joint [N/m]; closing at which it begins to carry [m]
      real(wp) :: k = unset, gap = 0.0_wp
   contains
      procedure :: visit, prepare, next
   end type compression_rule

contains

   !> Present the parameters to a visitor.
   subroutine visit(self, v)
      class(compression_rule), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%key('k', self%k, stiffness, above_zero, 'stiffness in compression; there is none in tension')
      call v%key('gap', self%gap, deformation, not_negative, 'closing before the faces touch')
   end subroutine visit

   !> Initial stiffness and first branch. Openings are positive; a joint without a gap is closed at zero, one
   !> with a gap at an opening of -gap.
   subroutine prepare(self)
      class(compression_rule), intent(inout) :: self

      self%initial_stiffness = self%k
      self%branch = segment(k=self%k, hi=0.0_wp, includes_upper_end=.true.)
      if (self%gap > 0.0_wp) self%branch = segment(k=0.0_wp, lo=-self%gap, hi=unbounded)
   end subroutine prepare

   !> The free line when the joint opens (direction = +1), the line of contact when it closes (-1).
   subroutine next(self, memory, branch, direction)
      class(compression_rule), intent(in) :: self
      class(rule_memory), intent(inout) :: memory
      !> The branch that ends, replaced by its successor
      type(segment), intent(inout) :: branch
      integer, intent(in) :: direction

      if (direction > 0) then
         branch = segment(k=0.0_wp, lo=-self%gap, hi=unbounded)
      else
         branch = segment(d0=-self%gap, k=self%k, lo=-unbounded, hi=-self%gap, includes_upper_end=.true.)
      end if
   end subroutine next

end module rbs_hysteresis_rules_compression
