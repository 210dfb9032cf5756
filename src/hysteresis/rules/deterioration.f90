!> Cyclic deterioration by energy, after Rahnama and Krawinkler 1993 (Blume Center report 108) and Ibarra,
!> Medina, Krawinkler 2005 (Earthquake Eng. Struct. Dyn. 34, section 3.2), as a function of the path that does
!> not depend on where excursions are cut:
!>
!>     left = 1 - (E/E_t)^c,   E_t = lambda f_y d_y,   E = energy dissipated so far
!>
!> For strength, softening line and target of a side, E is the energy that all excursions to the other side
!> have dissipated, for the unloading stiffness that of both sides. In the source each excursion takes the
!> share (E/(E_t - sum E))^c of the rest. For c = 1 and small excursions in one direction both are the same;
!> but there an excursion and its two halves differ, so that a reversal of any size changes the response.
module rbs_hysteresis_rules_deterioration
   use rbs_base_kinds, only: wp
   implicit none
   private

   public :: deterioration_type

   type :: deterioration_type
      !> E_t of strength, softening line, unloading stiffness and target of reloading [J]; 0: none
      real(wp) :: strength = 0.0_wp, softening = 0.0_wp, unloading = 0.0_wp, target = 0.0_wp
      !> Exponent
      real(wp) :: c = 1.0_wp
      !> Of the strength: 0 as above, to nothing; 1: exponential; 2: a hyperbola
      real(wp) :: fade = 0.0_wp
   contains
      procedure :: left, strength_left, acts
   end type deterioration_type

contains

   !> Share 1 - (E/E_t)^c that is left of a virgin value, from 1 to 0.
   elemental real(wp) function left(self, capacity, energy)
      class(deterioration_type), intent(in) :: self
      !> E_t [J], 0: no deterioration; energy E dissipated so far [J]
      real(wp), intent(in) :: capacity, energy

      left = 1.0_wp
      if (.not. (capacity > 0.0_wp .and. energy > 0.0_wp)) return
      left = 0.0_wp
      if (energy < capacity) left = 1.0_wp - (energy/capacity)**self%c
   end function left

   !> Share that is left of the strength. With `fade` above zero it begins to fall as fast as without, then
   !> ever more slowly, as the strength of cracks does that have worn smooth: with x = (E/E_t)^c the
   !> slope of the share s is ds/dx = -s^fade.
   elemental real(wp) function strength_left(self, energy) result(share)
      class(deterioration_type), intent(in) :: self
      !> Energy dissipated [J]
      real(wp), intent(in) :: energy
      real(wp) :: x, more

      share = self%left(self%strength, energy)
      if (.not. self%fade > 0.0_wp .or. .not. share < 1.0_wp) return
      x = (energy/self%strength)**self%c
      more = self%fade - 1.0_wp
      ! The solution of that equation; fade = 1 has a form of its own.
      if (abs(more) < 1.0e-6_wp) then
         share = exp(-x)
      else
         share = max(1.0_wp + more*x, 0.0_wp)**(-1.0_wp/more)
      end if
   end function strength_left

   !> Whether there is any deterioration.
   elemental logical function acts(self)
      class(deterioration_type), intent(in) :: self

      acts = max(self%strength, self%softening, self%unloading, self%target) > 0.0_wp
   end function acts

end module rbs_hysteresis_rules_deterioration
