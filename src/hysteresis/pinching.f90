!> The peak-oriented spring with pinched reloading, for columns with open shear cracks or slip of bars:
!> Ibarra, Medina, Krawinkler 2005 (Earthquake Eng. Struct. Dyn. 34, section 2.3).
!>
!> Reloading breaks at the deformation (1 - kappa_d) d_per, with kappa_f times the force that the straight
!> line to the peak has there. Unloading from the largest peak would end at d_per (zero for a side that
!> has not yielded).
module rbs_hysteresis_pinching
   use rbs_base_keys, only: key_type, share_above_zero
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_inner_peaks, only: point
   use rbs_hysteresis_peak_oriented, only: peak_oriented_rule, capped_keys
   implicit none
   private

   public :: pinching_rule

   type(key_type), parameter :: own_keys(2) = [ &
      key_type('kappa_f', bound=share_above_zero, &
               meaning='force at the break of the reloading line over that of the straight line there'), &
      key_type('kappa_d', bound=share_above_zero, &
               meaning='share of the permanent deformation that is missing at the break')]
   integer, parameter :: before = size(capped_keys)

   type, extends(peak_oriented_rule) :: pinching_rule
      !> At the break: share of the force, and share of the permanent deformation that is missing
      real(wp) :: kappa_f = 1.0_wp, kappa_d = 0.0_wp
   contains
      procedure, nopass :: keys
      procedure :: set
      procedure :: break_point
   end type pinching_rule

contains

   pure function keys()
      type(key_type), allocatable :: keys(:)

      keys = [capped_keys, own_keys]
   end function keys

   pure subroutine set(self, value)
      class(pinching_rule), intent(inout) :: self
      real(wp), intent(in) :: value(:)

      call self%peak_oriented_rule%set(value)
      self%kappa_f = value(before + 1)
      self%kappa_d = value(before + 2)
   end subroutine set

   !> The break, positive; the peak if reloading starts beyond the break. The last turning point is ignored.
   elemental type(point) function break_point(self, s, zero, peak)
      class(pinching_rule), intent(in) :: self
      integer, intent(in) :: s
      real(wp), intent(in) :: zero
      type(point), intent(in) :: peak
      real(wp) :: permanent, d

      break_point = peak
      permanent = peak%d - peak%f/self%unloading_stiffness(s)
      d = (1.0_wp - self%kappa_d)*max(permanent, 0.0_wp)
      if (d > zero) break_point = point(d, self%kappa_f*peak%f*((d - zero)/(peak%d - zero)))
   end function break_point

end module rbs_hysteresis_pinching
