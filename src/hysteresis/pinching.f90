!> The peak-oriented spring with pinched reloading, for columns that open shear cracks or slip: Ibarra,
!> Medina, Krawinkler 2005 (Earthquake Eng. Struct. Dyn. 34, section 2.3).
!>
!> Reloading breaks at the deformation (1 - kappa_d) d_per, d_per where unloading from the largest peak would
!> end (zero for a side that has not yielded), with kappa_f times the force that the straight line to the
!> peak has there.
module rbs_hysteresis_pinching
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_inner_peaks, only: point
   use rbs_hysteresis_peak_oriented, only: peak_oriented_rule
   implicit none
   private

   public :: pinching_rule

   type, extends(peak_oriented_rule) :: pinching_rule
      !> Share of the force, and what is missing to the permanent deformation, at the break
      real(wp) :: kappa_f = 1.0_wp, kappa_d = 0.0_wp
   contains
      procedure :: break_point
   end type pinching_rule

contains

   !> The break, positive; the peak if reloading begins beyond it. Where it turned back last does not count.
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
