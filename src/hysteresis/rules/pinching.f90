!> The peak-oriented spring with pinched reloading, for columns with open shear cracks or slip of bars:
!> Ibarra, Medina, Krawinkler 2005 (Earthquake Eng. Struct. Dyn. 34, section 2.3).
!>
!> Two parts with the same backbone act in parallel (`rbs_hysteresis_rules_capped`). One has the share kappa_f
!> of the force and is peak-oriented. The other slips: it has no force before the deformation
!> (1 - kappa_d) d_per, where unloading from the peak ends at d_per, and reloads to the peak from there. So
!> the line from zero force to the peak has its break there, with kappa_f times the force of the straight
!> line, as in the source, and each property of the parts is one of both.
module rbs_hysteresis_rules_pinching
   use rbs_base_constants, only: unset
   use rbs_base_key_visitor, only: key_visitor
   use rbs_base_keys, only: share_above_zero
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_rules_peak_oriented, only: peak_oriented_rule
   implicit none
   private

   public :: pinching_rule

   !> The second part slips.
   type, extends(peak_oriented_rule) :: pinching_rule
      !> Force at the break of the reloading line over that of the straight line; share of the permanent
      !> deformation that is missing there
      real(wp) :: kappa_f = unset, kappa_d = unset
   contains
      procedure :: visit, prepare
   end type pinching_rule

contains

   !> Present the parameters to a visitor: those of the rule `peak_oriented`, and two more.
   subroutine visit(self, v)
      class(pinching_rule), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call self%peak_oriented_rule%visit(v)
      call v%key('kappa_f', self%kappa_f, '', share_above_zero, &
                 'force at the break of the reloading line over that of the straight line there')
      call v%key('kappa_d', self%kappa_d, '', share_above_zero, &
                 'share of the permanent deformation that is missing at the break')
   end subroutine visit

   !> The second part: a copy of the first that slips. It has the share 1 - kappa_f of the force.
   subroutine prepare(self)
      class(pinching_rule), intent(inout) :: self

      call self%peak_oriented_rule%prepare()
      self%parts = 2
      self%share = self%kappa_f
      self%part(2) = self%part(1)
      self%part(2)%slips = .true.
      self%part(2)%slip = 1.0_wp - self%kappa_d
   end subroutine prepare

end module rbs_hysteresis_rules_pinching
