!> Confinement of a core by hoops, ties or a spiral (Mander, Priestley, Park 1988, ASCE 114(8)).
!>
!> One relation in the forms in which it is used: the diagrams of a section take the stress of both directions
!> and the arches between the bars of each face, as the source does; the layers of a column's hinge take the
!> stress of the direction of loading alone and spread the held bars evenly around the core, as their
!> parameters are fitted with that form; those of a wall take the weaker direction.
module rbs_section_confinement
   use rbs_base_constants, only: pi, unset
   use rbs_base_check, only: is_given
   use rbs_base_kinds, only: wp
   use rbs_section_steel_law, only: steel_type
   implicit none
   private

   public :: transverse_type, hoop_area, confinement_type, confinement_form, hooped_core, confinement_of

   !> Kinds of transverse reinforcement.
   integer, parameter, public :: no_ties = 0, ties = 1, spiral = 2, circular_hoops = 3

   !> Transverse reinforcement.
   type :: transverse_type
      !> One of the kinds above
      integer :: kind = no_ties
      !> Diameter of the bar [m], distance between hoops or pitch along the column [m]
      real(wp) :: diameter = 0.0_wp, spacing = 0.0_wp
      !> Bars that cross the section parallel to the depth and across it: two of a round hoop; a diagonal
      !> tie counts in part
      real(wp) :: legs = 2.0_wp, legs_across = 2.0_wp
      type(steel_type) :: steel
   end type transverse_type

   !> What confines a core.
   type :: hooped_core
      type(transverse_type) :: hoops
      !> Between the centre lines of the hoops; of round hoops both are the diameter [m]
      real(wp) :: width = 0.0_wp, depth = 0.0_wp
      !> Longitudinal bars: diameter [m], area of all of them in the core [m2]
      real(wp) :: bar_diameter = 0.0_wp, bar_area = 0.0_wp
      !> Whether the inner hoops bow into a void, so that nothing is confined
      logical :: hollow = .false.
   end type hooped_core

   !> The form of the relation.
   type :: confinement_form
      !> Whether the stress is that of the direction of loading, or of the weaker direction; else the mean
      logical :: along = .false., weaker = .false.
      !> Whether held bars are spread evenly around the core, else along each face; how many there are, by
      !> default four and four more for each leg beyond two
      logical :: even = .false.
      real(wp) :: held = unset
      !> Whether round hoops count as a spiral
      logical :: continuous = .false.
      !> Largest share of the longitudinal bars in the core that is counted, and largest k_e
      real(wp) :: most_bars = 0.5_wp, most_effective = 1.0_wp
   end type confinement_form

   type(confinement_form), parameter, public :: form_of_diagram = confinement_form()
   type(confinement_form), parameter, public :: form_of_hinge = &
      confinement_form(along=.true., even=.true., continuous=.true., most_bars=0.08_wp, &
                       most_effective=1.1_wp)
   type(confinement_form), parameter, public :: form_of_wall = &
      confinement_form(weaker=.true., most_bars=0.08_wp)

   type :: confinement_type
      !> Effective lateral stress [Pa] and the coefficient k_e in it
      real(wp) :: stress = 0.0_wp, effectiveness = 0.0_wp
      !> Volume of the hoops over that of the core: the sum of both directions, or twice that of one
      real(wp) :: ratio = 0.0_wp
   end type confinement_type

contains

   !> Area of one transverse bar [m2].
   elemental real(wp) function hoop_area(transverse)
      type(transverse_type), intent(in) :: transverse

      hoop_area = 0.25_wp*pi*transverse%diameter**2
   end function hoop_area

   !> The effective lateral stress as the hoops yield; zero without hoops or without a core.
   pure type(confinement_type) function confinement_of(core, form) result(confinement)
      type(hooped_core), intent(in) :: core
      type(confinement_form), intent(in) :: form
      real(wp) :: ratio, along, across

      if (core%hoops%kind == no_ties) return
      if (.not. min(core%width, core%depth) > 0.0_wp) return
      associate (t => core%hoops)
         ! A round hoop has two legs in each direction, which gives its 4 A/(d s).
         along = t%legs*hoop_area(t)/(t%spacing*core%width)
         across = t%legs_across*hoop_area(t)/(t%spacing*core%depth)
         ratio = along + across
         if (t%kind == ties .and. form%along) ratio = 2.0_wp*along
         if (t%kind == ties .and. form%weaker) ratio = 2.0_wp*min(along, across)
      end associate
      confinement%ratio = ratio
      ! Around a void nothing is confined, but the ratio of the hoops is that of a section.
      if (core%hollow) return
      confinement%effectiveness = effectiveness(core, form)
      confinement%stress = 0.5_wp*confinement%effectiveness*ratio*core%hoops%steel%fy
   end function confinement_of

   !> k_e: the share of the core that is confined halfway between two hoops.
   pure real(wp) function effectiveness(core, form) result(k_e)
      type(hooped_core), intent(in) :: core
      type(confinement_form), intent(in) :: form
      !> Clear distance of the hoops [m]; share of depth and width left by the arches between them
      real(wp) :: clear, part, area, across

      area = core%width*core%depth
      if (core%hoops%kind /= ties) area = 0.25_wp*pi*core%depth**2
      clear = max(0.0_wp, core%hoops%spacing - core%hoops%diameter)
      part = max(0.0_wp, 1.0_wp - 0.5_wp*clear/core%depth)
      across = max(0.0_wp, 1.0_wp - 0.5_wp*clear/core%width)
      k_e = part
      if (core%hoops%kind == circular_hoops .and. .not. form%continuous) k_e = part**2
      if (core%hoops%kind == ties) k_e = part*across*max(0.0_wp, 1.0_wp - arches(core, form)/(6.0_wp*area))
      k_e = min(form%most_effective, k_e/(1.0_wp - min(form%most_bars, core%bar_area/area)))
   end function effectiveness

   !> Sum of the squares of the clear distances, around the core, between the bars that legs hold [m2].
   !> A leg holds one bar at each of its ends; between two such bars the concrete forms an arch.
   pure real(wp) function arches(core, form)
      type(hooped_core), intent(in) :: core
      type(confinement_form), intent(in) :: form
      real(wp) :: inset, gaps, clear, corners, held

      if (form%even) then
         ! With two legs the four corners alone are held; from three on the held bars are taken as spread
         ! evenly around the core. `corners` is the share of the first form: 1 for two legs, 0 from three on.
         corners = min(max(3.0_wp - core%hoops%legs, 0.0_wp), 1.0_wp)
         held = 4.0_wp*core%hoops%legs - 4.0_wp
         if (is_given(form%held)) held = form%held
         held = max(4.0_wp, held)
         clear = max(0.0_wp, 2.0_wp*(core%width + core%depth)/held - core%bar_diameter)
         arches = (1.0_wp - corners)*held*clear**2 + corners*2.0_wp* &
                  ((core%width - core%bar_diameter)**2 + (core%depth - core%bar_diameter)**2)
         return
      end if
      ! Bars touch the hoops: between the outer bars the size less `inset`, cut into gaps by the legs.
      inset = core%hoops%diameter + core%bar_diameter
      gaps = max(1.0_wp, core%hoops%legs - 1.0_wp)
      clear = max(0.0_wp, (core%width - inset)/gaps - core%bar_diameter)
      arches = 2.0_wp*gaps*clear**2
      gaps = max(1.0_wp, core%hoops%legs_across - 1.0_wp)
      clear = max(0.0_wp, (core%depth - inset)/gaps - core%bar_diameter)
      arches = arches + 2.0_wp*gaps*clear**2
   end function arches

end module rbs_section_confinement
