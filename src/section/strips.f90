!> Sections cut into strips across the direction of loading.
!>
!> The integration of stresses uses the middles of the strips, the layers of a hinge use the centroids of
!> core and cover in each strip.
module rbs_section_strips
   use rbs_base_kinds, only: wp
   use rbs_section_shape, only: shape_type
   implicit none
   private

   public :: strips_type, cut_strips, strip_centroids

   type :: strips_type
      !> Height of a strip [m]
      real(wp) :: dy = 0.0_wp
      !> Middle of each strip, from the compression face on [m]; its area, and the part of that inside the
      !> centre line of the hoops [m2]
      real(wp), allocatable :: y(:), area(:), core_area(:)
   end type strips_type

contains

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

end module rbs_section_strips
