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
   use rbs_base_kinds, only: wp
   use rbs_section_concrete_law, only: concrete_type
   use rbs_section_confinement, only: circular_hoops, confinement_type, hooped_core, no_ties, spiral, &
                                      transverse_type
   use rbs_section_shape, only: new_core, shape_type
   use rbs_section_steel_law, only: steel_type
   implicit none
   private

   public :: section_type, enclose_core, hooped_core_of, strips_type, cut_strips, strip_centroids, side_of

   type :: strips_type
      !> Height of a strip [m]
      real(wp) :: dy = 0.0_wp
      !> Middle of each strip, from the compression face on [m]; its area, and the part of that inside the
      !> centre line of the hoops [m2]
      real(wp), allocatable :: y(:), area(:), core_area(:)
   end type strips_type

   type :: section_type
      !> Outline of the concrete, and of the core between the centre lines of the hoops
      type(shape_type), allocatable :: shape, core_shape
      !> Clear cover to the outer edge of the transverse bars, at the faces y = +-depth/2 and at the sides [m]
      real(wp) :: cover = 0.0_wp, side_cover = 0.0_wp
      !> Diameter of the main bars, for hinge length and confinement [m]
      real(wp) :: bar_diameter = 0.0_wp
      type(transverse_type) :: transverse
      !> Hoops of the boundary elements of a wall, at y < 0 and y > 0
      type(transverse_type) :: boundary(2)
      !> Laws without confinement, inside the hoops at y < 0 and y > 0, and outside them with confinement
      type(concrete_type) :: plain, core(2), shell
      !> By the hoops at y < 0 and y > 0
      type(confinement_type) :: confinement(2)
      type(strips_type) :: strips
      !> Bars: distance from mid-depth [m], area [m2], place of the steel in `steels`, inside the hoops
      real(wp), allocatable :: bar_y(:), bar_area(:)
      integer, allocatable :: bar_steel(:)
      logical, allocatable :: bar_in_core(:)
      type(steel_type), allocatable :: steels(:)
   end type section_type

contains

   !> Which of two boundaries is nearer to a place.
   elemental integer function side_of(y) result(side)
      !> Distance from mid-depth [m]
      real(wp), intent(in) :: y

      side = merge(2, 1, y > 0.0_wp)
   end function side_of

   !> Find the outline of the core from cover and hoops.
   subroutine enclose_core(section, round)
      type(section_type), intent(inout) :: section
      !> Whether the hoops are taken as round although they are given as ties
      logical, intent(in), optional :: round
      logical :: as_round
      integer :: side
      real(wp) :: less

      as_round = any(section%transverse%kind == [spiral, circular_hoops])
      if (present(round)) as_round = as_round .or. round
      ! The cover goes to the outer edge of the hoops: from face to centre line half a bar more, on two sides.
      associate (t => section%transverse, outline => section%shape)
         if (.not. outline%walled) then
            call new_core(outline, as_round, 2.0_wp*section%side_cover + t%diameter, &
                          2.0_wp*section%cover + t%diameter, section%core_shape)
            return
         end if
         section%core_shape = shape_type(0.0_wp, outline%depth, walled=.true.)
         do side = 1, 2
            if (section%boundary(side)%kind == no_ties) cycle
            ! Across the wall the cover is on both sides; along it on the outer one alone.
            less = 2.0_wp*section%cover + section%boundary(side)%diameter
            associate (core => section%core_shape)
               core%end_width(side) = outline%end_width(side) - less
               core%end_length(side) = outline%end_length(side) - less + section%cover
               core%end_inset(side) = 0.5_wp*less
            end associate
         end do
      end associate
   end subroutine enclose_core

   !> The core with the hoops that confine it; of a wall that of one boundary element.
   pure type(hooped_core) function hooped_core_of(section, side) result(core)
      type(section_type), intent(in) :: section
      !> At y < 0 (1) or at y > 0 (2)
      integer, intent(in) :: side

      core%hoops = section%transverse
      core%width = section%core_shape%width
      core%depth = section%core_shape%depth
      core%bar_diameter = section%bar_diameter
      core%bar_area = sum(section%bar_area)
      core%hollow = section%shape%hollow
      if (section%core_shape%round .and. core%hoops%kind /= no_ties) then
         ! Ties that stand for a spiral have its two legs.
         if (core%hoops%kind /= circular_hoops) core%hoops%kind = spiral
         core%hoops%legs = 2.0_wp
         core%hoops%legs_across = 2.0_wp
      end if
      if (.not. section%shape%walled) return
      core%hoops = section%boundary(side)
      core%width = section%core_shape%end_width(side)
      core%depth = section%core_shape%end_length(side)
      core%bar_area = sum(section%bar_area, section%bar_in_core .and. side_of(section%bar_y) == side)
   end function hooped_core_of

   !> Cut an outline, and the core in it, into `count` strips of equal height.
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

   !> Strips of a hinge, a column of four numbers for each: centroid [m] and area [m2] of its core, then of
   !> its cover. Where a boundary of a wall with hoops or wings ends, a strip ends too. The centroid of a core
   !> or cover without area is the middle of the strip.
   pure function strip_centroids(section, count) result(rows)
      type(section_type), intent(in) :: section
      !> Number of strips of equal height, before those edges cut them
      integer, intent(in) :: count
      real(wp), allocatable :: rows(:, :)
      real(wp), allocatable, dimension(:) :: low, high, middle, area, core, moment, core_moment
      integer :: side

      allocate (low(count), high(count), middle(count))
      call find_edges(section%shape, count, low, high, middle)
      if (section%shape%walled) then
         do side = 1, 2
            if (.not. (section%core_shape%end_length(side) > 0.0_wp .or. &
                       section%shape%end_width(side) > section%shape%width)) cycle
            ! The sign is that of the side: 1 is at y < 0.
            call cut_at(low, high, sign(0.5_wp*section%shape%depth - section%shape%end_length(side), &
                                        side - 1.5_wp))
         end do
         middle = 0.5_wp*(low + high)
      end if
      area = section%shape%area_between(low, high)
      core = min(section%core_shape%area_between(low, high), area)
      moment = section%shape%moment_between(low, high)
      core_moment = section%core_shape%moment_between(low, high)
      allocate (rows(4, size(low)))
      rows(1, :) = middle
      rows(2, :) = core
      rows(3, :) = middle
      rows(4, :) = area - core
      where (core > 0.0_wp) rows(1, :) = core_moment/core
      where (area - core > 0.0_wp) rows(3, :) = (moment - core_moment)/(area - core)
   end function strip_centroids

   !> Cut the strip that contains a place in two there, unless the place is on an edge.
   pure subroutine cut_at(low, high, place)
      !> Lower and upper edges of the strips, ascending [m]; one element is added
      real(wp), allocatable, intent(inout) :: low(:), high(:)
      !> Distance from mid-depth [m]
      real(wp), intent(in) :: place
      real(wp) :: least
      integer :: i

      least = 1.0e-6_wp*(high(size(high)) - low(1))
      do i = 1, size(low)
         if (low(i) + least < place .and. place < high(i) - least) exit
      end do
      if (i > size(low)) return
      low = [low(:i), place, low(i + 1:)]
      high = [high(:i - 1), place, high(i:)]
   end subroutine cut_at

   !> Lower and upper edge and middle of each of `count` strips of equal height [m], from the same formula on
   !> both sides, so that mirrored strips differ by the sign alone.
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
