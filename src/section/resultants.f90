!> Axial force and moment of a section under a plane distribution of strain, and the axial stiffness.
module rbs_section_resultants
   use rbs_base_kinds, only: wp
   use rbs_section_concrete_law, only: concrete_type, concrete_both, tension_zero
   use rbs_section_cross_section, only: section_type, side_of
   use rbs_section_steel_law, only: steel_both
   implicit none
   private

   public :: laws_type, section_laws, resultants_type, resultants, force_scale

   !> The laws of the concrete outside the hoops, and inside those at y < 0 and y > 0.
   type :: laws_type
      type(concrete_type) :: shell, core(2)
      !> Whether the two differ
      logical :: confined = .false.
   end type laws_type

   !> Resultants of the stresses: compression positive; moment about mid-depth, positive with a curvature
   !> that puts y > 0 in tension.
   type :: resultants_type
      !> Axial force [N], moment [N m]; change of the axial force with the strain at mid-depth [N]
      real(wp) :: n = 0.0_wp, m = 0.0_wp, stiffness = 0.0_wp
   end type resultants_type

contains

   !> Laws with one of the tension laws, with or without confinement.
   elemental type(laws_type) function section_laws(section, tension, confined) result(laws)
      type(section_type), intent(in) :: section
      !> Place of the tension law among `tension_names`
      integer, intent(in) :: tension
      !> Whether the core is confined and the cover spalls
      logical, intent(in) :: confined

      laws%confined = confined
      laws%shell = section%plain
      laws%core = section%plain
      if (confined) then
         laws%shell = section%shell
         laws%core = section%core
      end if
      laws%shell%tension = tension
      laws%core%tension = tension
   end function section_laws

   !> Resultants, as sums over strips and bars. The strip that contains the tip of the crack is cut there, so
   !> that the axial force is a continuous function of the strain although the stress drops at cracking.
   pure type(resultants_type) function resultants(section, laws, eps0, curvature) result(sums)
      type(section_type), intent(in) :: section
      type(laws_type), intent(in) :: laws
      !> Strain at mid-depth, compression positive; [1/m]
      real(wp), intent(in) :: eps0, curvature
      real(wp) :: stress, tangent, stress_core(2), tangent_core(2), strain, force, stiffness
      integer :: i, cut, side
      !> Whether the stresses of shell (0) and cores (1, 2) at the present strain have been found
      logical :: known(0:2)

      cut = cut_strip(section, laws, eps0, curvature)
      known = .false.
      do i = 1, size(section%strips%y)
         if (i == cut) cycle
         ! Without curvature all strips have the same strain, and stresses are found once.
         if (abs(curvature) > 0.0_wp) known = .false.
         strain = eps0 - curvature*section%strips%y(i)
         if (.not. known(0)) call concrete_both(laws%shell, strain, stress, tangent)
         known(0) = .true.
         force = stress*section%strips%area(i)
         stiffness = tangent*section%strips%area(i)
         if (laws%confined .and. section%strips%core_area(i) > 0.0_wp) then
            side = side_of(section%strips%y(i))
            if (.not. known(side)) then
               call concrete_both(laws%core(side), strain, stress_core(side), tangent_core(side))
               known(side) = .true.
            end if
            force = force + (stress_core(side) - stress)*section%strips%core_area(i)
            stiffness = stiffness + (tangent_core(side) - tangent)*section%strips%core_area(i)
         end if
         sums%n = sums%n + force
         sums%m = sums%m - force*section%strips%y(i)
         sums%stiffness = sums%stiffness + stiffness
      end do
      if (cut > 0) call add_cut_strip(cut, sums)
      call add_bars(sums)

   contains

      !> Add the parts of strip i on both sides of the tip of the crack. The law of the cover serves for all,
      !> as core and cover have the same tension law.
      pure subroutine add_cut_strip(i, sums)
         integer, intent(in) :: i
         type(resultants_type), intent(inout) :: sums
         real(wp) :: tip, ends(3), width, y, area, strain, stress, tangent, after
         integer :: part

         tip = crack_tip(laws, eps0, curvature)
         associate (strips => section%strips)
            ends = [strips%y(i) - 0.5_wp*strips%dy, tip, strips%y(i) + 0.5_wp*strips%dy]
            width = strips%area(i)/strips%dy
         end associate
         do part = 1, 2
            y = 0.5_wp*(ends(part) + ends(part + 1))
            area = width*(ends(part + 1) - ends(part))
            strain = eps0 - curvature*y
            call concrete_both(laws%shell, strain, stress, tangent)
            sums%n = sums%n + stress*area
            sums%m = sums%m - stress*area*y
            sums%stiffness = sums%stiffness + tangent*area
         end do
         ! With d(eps_0) the tip moves by d(eps_0)/phi, and the stress of the concrete that it passes changes
         ! from that just beyond cracking to f_t.
         strain = laws%shell%ft/laws%shell%ec*(1.0_wp + 1.0e-9_wp)
         call concrete_both(laws%shell, -strain, after, tangent)
         sums%stiffness = sums%stiffness - (laws%shell%ft + after)*width/abs(curvature)
      end subroutine add_cut_strip

      !> Add the bars, each less the concrete that it displaces.
      pure subroutine add_bars(sums)
         type(resultants_type), intent(inout) :: sums
         real(wp) :: strain, stress, tangent, displaced, slope, force
         integer :: i

         do i = 1, size(section%bar_y)
            strain = eps0 - curvature*section%bar_y(i)
            call steel_both(section%steels(section%bar_steel(i)), strain, stress, tangent)
            if (section%bar_in_core(i)) then
               call concrete_both(laws%core(side_of(section%bar_y(i))), strain, displaced, slope)
            else
               call concrete_both(laws%shell, strain, displaced, slope)
            end if
            force = (stress - displaced)*section%bar_area(i)
            sums%n = sums%n + force
            sums%m = sums%m - force*section%bar_y(i)
            sums%stiffness = sums%stiffness + (tangent - slope)*section%bar_area(i)
         end do
      end subroutine add_bars

   end function resultants

   !> Index of the strip that contains the tip of the crack; 0 if no strip does, or if the law has no tension.
   pure integer function cut_strip(section, laws, eps0, curvature)
      type(section_type), intent(in) :: section
      type(laws_type), intent(in) :: laws
      !> Strain at mid-depth, compression positive; curvature [1/m]
      real(wp), intent(in) :: eps0, curvature
      real(wp) :: tip

      cut_strip = 0
      if (laws%shell%tension == tension_zero .or. .not. abs(curvature) > 0.0_wp) return
      tip = crack_tip(laws, eps0, curvature)
      if (abs(tip) < 0.5_wp*section%shape%depth) then
         cut_strip = 1 + int((tip + 0.5_wp*section%shape%depth)/section%strips%dy)
         cut_strip = min(size(section%strips%y), cut_strip)
      end if
   end function cut_strip

   !> Distance of the tip of the crack, where the strain is that of cracking, from mid-depth [m].
   elemental real(wp) function crack_tip(laws, eps0, curvature)
      type(laws_type), intent(in) :: laws
      !> Strain at mid-depth, compression positive; curvature, not zero [1/m]
      real(wp), intent(in) :: eps0, curvature

      crack_tip = (eps0 + laws%shell%ft/laws%shell%ec)/curvature
   end function crack_tip

   !> Scale of the forces, to which residuals are compared: strength of all concrete and steel [N].
   pure real(wp) function force_scale(section)
      type(section_type), intent(in) :: section
      integer :: i

      force_scale = section%plain%fc*sum(section%strips%area)
      do i = 1, size(section%bar_y)
         force_scale = force_scale + section%steels(section%bar_steel(i))%fy*section%bar_area(i)
      end do
   end function force_scale

end module rbs_section_resultants
