!> Completes a section from its data: the core, the bars in it, the laws of core and cover, the strips.
module rbs_section_section_build
   use rbs_base_kinds, only: wp
   use rbs_section_confinement, only: confine
   use rbs_section_cross_section, only: enclose_core, section_type, slice
   implicit none
   private

   public :: build_section

contains

   !> Complete a section whose shape, cover, hoops, bars and plain concrete are set and checked.
   subroutine build_section(section, eps_spall, strips)
      type(section_type), intent(inout) :: section
      !> Strain at which the cover has spalled
      real(wp), intent(in) :: eps_spall
      !> Number of strips
      integer, intent(in) :: strips

      call enclose_core(section)
      section%bar_in_core = abs(section%bar_y) <= 0.5_wp*section%core_shape%depth
      call confine(section, eps_spall)
      call slice(section, strips)
   end subroutine build_section

end module rbs_section_section_build
