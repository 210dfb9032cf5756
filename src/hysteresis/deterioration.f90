!> Cyclic deterioration by energy: Rahnama and Krawinkler 1993 (Blume Center report 108), as in Ibarra,
!> Medina, Krawinkler 2005 (Earthquake Eng. Struct. Dyn. 34, section 3.2).
!>
!> An excursion, from one crossing of zero force to the next, that dissipates E reduces strength or
!> stiffness by the share
!>
!>     beta = (E/(E_t - spent))^c,   E_t = lambda f_y d_y,   spent = energy so far, E included
!>
!> of its present value. Each kind of deterioration has its own lambda; at beta >= 1 its E_t is used up.
module rbs_hysteresis_deterioration
   use rbs_base_kinds, only: wp
   implicit none
   private

   public :: deterioration_type

   type :: deterioration_type
      !> E_t of strength, softening line, unloading stiffness and target of reloading [J]; 0: none
      real(wp) :: strength = 0.0_wp, softening = 0.0_wp, unloading = 0.0_wp, target = 0.0_wp
      !> Exponent
      real(wp) :: c = 1.0_wp
      !> Energy dissipated by the completed excursions [J]
      real(wp) :: spent = 0.0_wp
   contains
      procedure :: share
   end type deterioration_type

contains

   !> Beta of an excursion, from 0 to 1.
   elemental real(wp) function share(self, capacity, energy)
      class(deterioration_type), intent(in) :: self
      !> E_t [J], 0: none
      real(wp), intent(in) :: capacity
      !> Energy that the excursion has dissipated, not yet in `spent` [J]
      real(wp), intent(in) :: energy
      real(wp) :: left

      share = 0.0_wp
      if (.not. (capacity > 0.0_wp .and. energy > 0.0_wp)) return
      left = capacity - (self%spent + energy)
      share = 1.0_wp
      if (energy < left) share = (energy/left)**self%c
   end function share

end module rbs_hysteresis_deterioration
