!> Confinement of the core by hoops, ties or a spiral (Mander, Priestley, Park 1988, ASCE 114(8)).
!>
!> The lateral stress is the mean of both directions, with the arches between the bars of each face. The
!> layered hinge (`python/rbsdem/section/strips.py`) takes the stress of the direction of loading alone and
!> spreads the held bars evenly around the core; it has its own formula, as its parameters are fitted with it.
module rbs_section_confinement
   use rbs_base_kinds, only: wp
   use rbs_section_concrete_law, only: confined_concrete, spalling_concrete
   use rbs_section_cross_section, only: section_type, no_ties, spiral, circular_hoops, hoop_area, steel_area
   implicit none
   private

   public :: confine, volumetric_ratio

contains

   !> Set the laws of core and cover, the lateral stress and its effectiveness. Hoops around a void do not
   !> confine the walls between them: the inner ones bow into the void.
   pure subroutine confine(section, eps_spall)
      type(section_type), intent(inout) :: section
      !> Strain at which the cover has spalled
      real(wp), intent(in) :: eps_spall
      real(wp) :: ratio, eps_cu, yield

      section%core = section%plain
      section%shell = section%plain
      section%lateral_stress = 0.0_wp
      section%effectiveness = 0.0_wp
      if (section%transverse%kind == no_ties) return
      if (.not. min(section%core_shape%width, section%core_shape%depth) > 0.0_wp) return
      if (.not. section%shape%hollow) section%effectiveness = effectiveness(section)
      ratio = volumetric_ratio(section)
      yield = section%transverse%steel%fy
      ! The ratio is the sum of both directions; half of it is their mean.
      section%lateral_stress = 0.5_wp*section%effectiveness*ratio*yield
      section%core = confined_concrete(section%plain, section%lateral_stress, 0.0_wp)
      eps_cu = 0.004_wp + 1.4_wp*ratio*yield*section%transverse%steel%eps_u/section%core%fc
      section%core%eps_cu = eps_cu
      section%shell = spalling_concrete(section%plain, eps_spall)
   end subroutine confine

   !> Volume of transverse steel over that of the core: the sum of both directions. A round hoop has two legs
   !> in each, which gives its 4 A/(d s).
   pure real(wp) function volumetric_ratio(section) result(ratio)
      type(section_type), intent(in) :: section

      ratio = 0.0_wp
      if (section%transverse%kind == no_ties) return
      associate (t => section%transverse, core => section%core_shape)
         ratio = t%legs*hoop_area(t)/(t%spacing*core%width) + &
                 t%legs_across*hoop_area(t)/(t%spacing*core%depth)
      end associate
   end function volumetric_ratio

   !> k_e: the share of the core that is confined halfway between two hoops.
   pure real(wp) function effectiveness(section) result(k_e)
      type(section_type), intent(in) :: section
      real(wp) :: b_c, d_c, clear, part, core

      b_c = section%core_shape%width
      d_c = section%core_shape%depth
      core = section%core_shape%area()
      clear = max(0.0_wp, section%transverse%spacing - section%transverse%diameter)
      part = max(0.0_wp, 1.0_wp - 0.5_wp*clear/d_c)
      select case (section%transverse%kind)
      case (spiral)
         k_e = part
      case (circular_hoops)
         k_e = part**2
      case default
         k_e = part*max(0.0_wp, 1.0_wp - 0.5_wp*clear/b_c)
         k_e = k_e*max(0.0_wp, 1.0_wp - arches(section, b_c, d_c)/(6.0_wp*core))
      end select
      k_e = min(1.0_wp, k_e/(1.0_wp - min(0.5_wp, steel_area(section)/core)))
   end function effectiveness

   !> Sum of the squares of the clear distances, around the core, between the bars that legs hold [m2].
   !> A leg holds one bar at each of its ends; between two such bars the concrete forms an arch.
   pure real(wp) function arches(section, b_c, d_c)
      type(section_type), intent(in) :: section
      !> Core between hoop centre lines [m]
      real(wp), intent(in) :: b_c, d_c
      real(wp) :: inset, gaps, clear

      inset = section%transverse%diameter + section%bar_diameter
      gaps = max(1.0_wp, section%transverse%legs - 1.0_wp)
      clear = max(0.0_wp, (b_c - inset)/gaps - section%bar_diameter)
      arches = 2.0_wp*gaps*clear**2
      gaps = max(1.0_wp, section%transverse%legs_across - 1.0_wp)
      clear = max(0.0_wp, (d_c - inset)/gaps - section%bar_diameter)
      arches = arches + 2.0_wp*gaps*clear**2
   end function arches

end module rbs_section_confinement
