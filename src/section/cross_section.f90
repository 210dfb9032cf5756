!> A reinforced-concrete section in uniaxial bending: strips of concrete, bars as points, ties.
!>
!> y runs from mid-depth, positive to the face that a positive curvature puts in tension:
!> strain(y) = eps_0 - phi y, compression positive. Strips go from y = -depth/2 to depth/2. Concrete
!> displaced by a bar is deducted where the bar is.
module rbs_section_cross_section
   use rbs_base_constants, only: pi
   use rbs_base_kinds, only: wp
   use rbs_section_concrete_law, only: concrete_type
   use rbs_section_steel_law, only: steel_type
   implicit none
   private

   public :: section_type, transverse_type, slice, gross_area, steel_area, core_width, core_depth, &
             hoop_area

   !> Strips over the depth; 400 as in the reference values of the documentation.
   integer, parameter, public :: default_strips = 400

   !> Kinds of transverse reinforcement.
   integer, parameter, public :: no_ties = 0, ties = 1, spiral = 2, circular_hoops = 3

   !> Transverse reinforcement.
   type :: transverse_type
      !> One of the kinds above
      integer :: kind = no_ties
      !> Diameter of the bar [m], distance between hoops or pitch along the column [m]
      real(wp) :: diameter = 0.0_wp, spacing = 0.0_wp
      !> Bars that cross the section parallel to the depth and across it; a diagonal tie counts in part
      real(wp) :: legs = 0.0_wp, legs_across = 0.0_wp
      type(steel_type) :: steel
   end type transverse_type

   type :: section_type
      !> Whether it is a circle, of diameter `depth` = `width`
      logical :: circular = .false.
      !> Width, depth in the direction of loading [m]
      real(wp) :: width = 0.0_wp, depth = 0.0_wp
      !> Clear cover to the outer edge of the transverse bars, at the faces y = +-depth/2 and at the sides [m]
      real(wp) :: cover = 0.0_wp, side_cover = 0.0_wp
      !> Diameter of the main bars, for hinge length and confinement [m]
      real(wp) :: bar_diameter = 0.0_wp
      type(transverse_type) :: transverse
      !> Laws without confinement, inside the hoops and outside them with confinement
      type(concrete_type) :: plain, core, shell
      !> Effective lateral stress of the hoops [Pa] and the coefficient k_e in it
      real(wp) :: lateral_stress = 0.0_wp, effectiveness = 0.0_wp
      !> Strips: centre [m], whole area [m2], and the part of it inside the hoop centre line [m2]
      real(wp), allocatable :: y(:), area(:), core_area(:)
      !> Height of a strip [m]
      real(wp) :: dy = 0.0_wp
      !> Bars: distance from mid-depth [m], area [m2], place of the steel in `steels`, inside the hoops
      real(wp), allocatable :: bar_y(:), bar_area(:)
      integer, allocatable :: bar_steel(:)
      logical, allocatable :: bar_in_core(:)
      type(steel_type), allocatable :: steels(:)
   end type section_type

contains

   !> Cut the section into `count` strips.
   pure subroutine slice(section, count)
      type(section_type), intent(inout) :: section
      integer, intent(in) :: count
      real(wp) :: lo, hi, half_core
      integer :: i

      if (allocated(section%y)) deallocate (section%y, section%area, section%core_area)
      allocate (section%y(count), section%area(count), section%core_area(count))
      section%dy = section%depth/count
      half_core = 0.5_wp*core_depth(section)
      do i = 1, count
         lo = -0.5_wp*section%depth + (i - 1)*section%dy
         hi = lo + section%dy
         section%y(i) = -0.5_wp*section%depth + (i - 0.5_wp)*section%dy
         if (section%circular) then
            section%area(i) = circle_area(0.5_wp*section%depth, lo, hi)
            section%core_area(i) = circle_area(half_core, lo, hi)
         else
            section%area(i) = section%width*section%dy
            section%core_area(i) = core_width(section)*max(0.0_wp, min(hi, half_core) - max(lo, -half_core))
         end if
         section%core_area(i) = min(section%core_area(i), section%area(i))
      end do
   end subroutine slice

   !> Area of a circle about mid-depth between two ordinates [m2].
   elemental real(wp) function circle_area(radius, lo, hi)
      real(wp), intent(in) :: radius
      real(wp), intent(in) :: lo, hi
      real(wp) :: a, b

      circle_area = 0.0_wp
      if (.not. radius > 0.0_wp) return
      a = min(max(lo/radius, -1.0_wp), 1.0_wp)
      b = min(max(hi/radius, -1.0_wp), 1.0_wp)
      circle_area = radius**2*(b*sqrt(1.0_wp - b**2) + asin(b) - a*sqrt(1.0_wp - a**2) - asin(a))
   end function circle_area

   !> Area of the concrete outline [m2].
   elemental real(wp) function gross_area(section)
      type(section_type), intent(in) :: section

      gross_area = section%width*section%depth
      if (section%circular) gross_area = 0.25_wp*pi*section%depth**2
   end function gross_area

   !> Area of all bars [m2].
   pure real(wp) function steel_area(section)
      type(section_type), intent(in) :: section

      steel_area = sum(section%bar_area)
   end function steel_area

   !> Width and depth of the core, between the centre lines of the hoop [m].
   elemental real(wp) function core_width(section)
      type(section_type), intent(in) :: section

      core_width = max(0.0_wp, section%width - 2.0_wp*section%side_cover - section%transverse%diameter)
   end function core_width

   elemental real(wp) function core_depth(section)
      type(section_type), intent(in) :: section

      core_depth = max(0.0_wp, section%depth - 2.0_wp*section%cover - section%transverse%diameter)
   end function core_depth

   !> Area of one transverse bar [m2].
   elemental real(wp) function hoop_area(transverse)
      type(transverse_type), intent(in) :: transverse

      hoop_area = 0.25_wp*pi*transverse%diameter**2
   end function hoop_area

end module rbs_section_cross_section
