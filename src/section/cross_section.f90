!> A reinforced-concrete section in uniaxial bending: its shape, strips of concrete, bars as points, hoops.
!>
!> y runs from mid-depth, positive to the face that a positive curvature puts in tension:
!> strain(y) = eps_0 - phi y, compression positive. Strips go from y = -depth/2 to depth/2. Concrete
!> that a bar displaces is deducted where the bar is.
!>
!> Sections cut into strips across the direction of loading.
!>
!> The integration of stresses uses the middles of the strips, the layers of a hinge use the centroids of
!> core and cover in each strip.
module rbs_section_cross_section
   use rbs_base_constants, only: pi
   use rbs_base_kinds, only: wp
   use rbs_section_concrete_law, only: concrete_type
   use rbs_section_shape, only: new_core, shape_type
   use rbs_section_steel_law, only: steel_type
   implicit none
   private

   public :: section_type, transverse_type, enclose_core, hoop_area, strips_type, &
             cut_strips, strip_centroids

   type :: strips_type
      !> Height of a strip [m]
      real(wp) :: dy = 0.0_wp
      !> Middle of each strip, from the compression face on [m]; its area, and the part of that inside the
      !> centre line of the hoops [m2]
      real(wp), allocatable :: y(:), area(:), core_area(:)
   end type strips_type

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

   type :: section_type
      !> Outline of the concrete, and of the core between the centre lines of the hoops
      type(shape_type), allocatable :: shape, core_shape
      !> Clear cover to the outer edge of the transverse bars, at the faces y = +-depth/2 and at the sides [m]
      real(wp) :: cover = 0.0_wp, side_cover = 0.0_wp
      !> Diameter of the main bars, for hinge length and confinement [m]
      real(wp) :: bar_diameter = 0.0_wp
      type(transverse_type) :: transverse
      !> Laws without confinement, inside the hoops and outside them with confinement
      type(concrete_type) :: plain, core, shell
      !> Effective lateral stress of the hoops [Pa] and the coefficient k_e in it
      real(wp) :: lateral_stress = 0.0_wp, effectiveness = 0.0_wp
      type(strips_type) :: strips
      !> Bars: distance from mid-depth [m], area [m2], place of the steel in `steels`, inside the hoops
      real(wp), allocatable :: bar_y(:), bar_area(:)
      integer, allocatable :: bar_steel(:)
      logical, allocatable :: bar_in_core(:)
      type(steel_type), allocatable :: steels(:)
   end type section_type

contains

   !> Find the outline of the core from cover and hoops.
   subroutine enclose_core(section)
      type(section_type), intent(inout) :: section

      associate (t => section%transverse)
         call new_core(section%shape, any(t%kind == [spiral, circular_hoops]), &
                       2.0_wp*section%side_cover + t%diameter, 2.0_wp*section%cover + t%diameter, &
                       section%core_shape)
      end associate
   end subroutine enclose_core

   !> Area of one transverse bar [m2].
   elemental real(wp) function hoop_area(transverse)
      type(transverse_type), intent(in) :: transverse

      hoop_area = 0.25_wp*pi*transverse%diameter**2
   end function hoop_area

   !> Cut into `count` strips of equal height.
   pure subroutine cut_strips(outline, core, count, strips)
      type(shape_type), intent(in) :: outline, core
      integer, intent(in) :: count
      type(strips_type), intent(inout) :: strips
      real(wp) :: low(count), high(count)

      if (allocated(strips%y)) deallocate (strips%y, strips%area, strips%core_area)
      allocate (strips%y(count), strips%area(count), strips%core_area(count))
      call find_edges(outline, count, low, high, strips%y)
      strips%dy = outline%depth/count
      strips%area = outline%area_between(low, high)
      strips%core_area = min(core%area_between(low, high), strips%area)
   end subroutine cut_strips

   !> Centroids of core and cover in each strip [m]; the middle of a strip that has no core, or no cover.
   pure subroutine strip_centroids(outline, core, strips, core_y, cover_y)
      type(shape_type), intent(in) :: outline, core
      type(strips_type), intent(in) :: strips
      real(wp), intent(out) :: core_y(:), cover_y(:)
      real(wp), dimension(size(core_y)) :: low, high, middle, moment, core_moment, cover_area

      call find_edges(outline, size(core_y), low, high, middle)
      core_y = middle
      cover_y = middle
      moment = outline%moment_between(low, high)
      core_moment = core%moment_between(low, high)
      cover_area = strips%area - strips%core_area
      where (strips%core_area > 0.0_wp) core_y = core_moment/strips%core_area
      where (cover_area > 0.0_wp) cover_y = (moment - core_moment)/cover_area
   end subroutine strip_centroids

   !> Lower and upper edge and middle of each strip [m]; those of mirrored strips differ by their sign alone.
   pure subroutine find_edges(outline, count, low, high, middle)
      type(shape_type), intent(in) :: outline
      integer, intent(in) :: count
      real(wp), intent(out) :: low(count), high(count), middle(count)
      real(wp) :: half
      integer :: i

      half = 0.5_wp*outline%depth
      do i = 1, count
         low(i) = half*(real(2*i - 2 - count, wp)/count)
         high(i) = half*(real(2*i - count, wp)/count)
         middle(i) = half*(real(2*i - 1 - count, wp)/count)
      end do
   end subroutine find_edges

end module rbs_section_cross_section
