!> Bilinear spring with kinematic hardening (paper, table 1, shear spring).
!>
!> Between two bounding lines F = k_post D + q and F = k_post D - q, q = (k - k_post) d_y, the spring is
!> elastic with slope k; the elastic range is 2 d_y wide and travels with the plastic deformation.
module rbs_hysteresis_rules_bilinear
   use rbs_base_check, only: check_order
   use rbs_base_error, only: message_list
   use rbs_base_key_visitor, only: key_visitor
   use rbs_base_keys, only: above_zero, not_negative, deformation, stiffness
   use rbs_base_kinds, only: wp
   use rbs_base_constants, only: unbounded, unset
   use rbs_hysteresis_rule, only: rule_type, rule_memory, check_product
   use rbs_hysteresis_segment, only: segment
   implicit none
   private

   public :: bilinear_rule

   type, extends(rule_type) :: bilinear_rule
      !> Initial stiffness [N/m or N m/rad]; yield deformation [m or rad]
      real(wp) :: k = unset, d_y = unset
      !> Stiffness after yield [N/m or N m/rad]
      real(wp) :: k_post = unset
   contains
      procedure :: visit, prepare, check_relations, next
   end type bilinear_rule

contains

   !> Present the parameters to a visitor.
   subroutine visit(self, v)
      class(bilinear_rule), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%key('k', self%k, stiffness, above_zero, 'initial stiffness')
      call v%key('d_y', self%d_y, deformation, above_zero, 'yield deformation')
      call v%key('k_post', self%k_post, stiffness, not_negative, 'stiffness after yield, below k')
   end subroutine visit

   !> Initial stiffness and first branch.
   subroutine prepare(self)
      class(bilinear_rule), intent(inout) :: self

      self%initial_stiffness = self%k
      self%branch = segment(k=self%k, lo=-self%d_y, hi=self%d_y)
   end subroutine prepare

   !> Add a message for each pair of parameters that do not suit each other.
   subroutine check_relations(self, name, messages)
      class(bilinear_rule), intent(inout) :: self
      character(len=*), intent(in) :: name
      type(message_list), intent(inout) :: messages

      call check_order(name, 'k_post', self%k_post, 'must be below', 'k', self%k, &
                       '; use an elastic spring for one that does not yield', messages)
      call check_product(self%k, self%d_y, name, 'k d_y', messages)
   end subroutine check_relations

   !> The branch after the present one, which the motion leaves going up (direction = +1) or down (-1).
   subroutine next(self, memory, branch, direction)
      class(bilinear_rule), intent(in) :: self
      class(rule_memory), intent(inout) :: memory
      !> The branch that ends, replaced by its successor
      type(segment), intent(inout) :: branch
      integer, intent(in) :: direction
      real(wp) :: d, f

      d = branch%end_toward(direction)
      if (branch%unload_on_reversal == 0) then
         ! The elastic branch has ended: yield along the bounding line of this direction.
         branch = segment(f0=direction*(self%k - self%k_post)*self%d_y, k=self%k_post)
         call branch%lead_outward(direction, near=d, far=direction*unbounded)
      else
         ! The motion has turned back from the bounding line of side -direction: elastic from there (far)
         ! over twice the yield deformation to the bounding line of the other side (near).
         f = branch%force(d)
         branch = segment(d0=d, f0=f, k=self%k)
         call branch%lead_outward(-direction, near=d + direction*2.0_wp*self%d_y, far=d, &
                                  includes_near_end=.false., unload_on_reversal=.false.)
      end if
   end subroutine next

end module rbs_hysteresis_rules_bilinear
