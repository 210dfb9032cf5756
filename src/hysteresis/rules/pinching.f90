!> The peak-oriented spring with pinched reloading, for columns with open shear cracks or slip of bars:
!> Ibarra, Medina, Krawinkler 2005 (Earthquake Eng. Struct. Dyn. 34, section 2.3).
!>
!> Two parts with the same backbone act in parallel (`rbs_hysteresis_rules_capped`). One has the share kappa_f
!> of the force and is peak-oriented. The other slips: it has no force before the deformation
!> (1 - kappa_d) d_per, where unloading from the peak ends at d_per, and goes to the peak from there. So the
!> line from zero force to the peak has its break there, with kappa_f times the force of the straight line, as
!> in the source, and what holds for each part holds for both.
module rbs_hysteresis_rules_pinching
   use rbs_base_keys, only: key_type, share_above_zero
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_rules_peak_oriented, only: peak_oriented_rule, capped_keys
   implicit none
   private

   public :: pinching_rule

   type(key_type), parameter :: own_keys(2) = [ &
      key_type('kappa_f', bound=share_above_zero, &
               meaning='force at the break of the reloading line over that of the straight line there'), &
      key_type('kappa_d', bound=share_above_zero, &
               meaning='share of the permanent deformation that is missing at the break')]
   type(key_type), parameter, public :: pinching_keys(*) = [capped_keys, own_keys]
   integer, parameter :: before = size(capped_keys)

   !> The second part slips.
   type, extends(peak_oriented_rule) :: pinching_rule
   contains
      procedure :: set
   end type pinching_rule

contains

   pure subroutine set(self, value)
      class(pinching_rule), intent(inout) :: self
      real(wp), intent(in) :: value(:)

      call self%peak_oriented_rule%set(value)
      self%parts = 2
      self%share = value(before + 1)
      self%part(2) = self%part(1)
      self%part(2)%slips = .true.
      self%part(2)%slip = 1.0_wp - value(before + 2)
   end subroutine set

end module rbs_hysteresis_rules_pinching
