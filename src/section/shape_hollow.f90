!> A shape with a void in its middle: a box, or a ring. Both are the difference of two solid shapes.
!>
!> The core lies between hoops around the outside and hoops around the void, with the same cover at both.
module rbs_section_shape_hollow
   use rbs_base_key_visitor, only: key_visitor
   use rbs_base_kinds, only: wp
   use rbs_section_shape, only: column_size, shape_type
   use rbs_section_shape_circle, only: circle_type
   use rbs_section_shape_rectangle, only: rectangle_type
   implicit none
   private

   public :: hollow_type, box_type, ring_type

   !> What the two have in common.
   type, abstract, extends(shape_type) :: hollow_type
      !> Thickness of the walls at the faces y = +-depth/2, and of the webs [m]
      real(wp) :: wall = 0.0_wp, side_wall = 0.0_wp
   contains
      procedure :: shrink
   end type hollow_type

   !> A rectangle with a rectangular void.
   type, extends(hollow_type) :: box_type
   contains
      procedure :: width_at => box_width_at
      procedure :: area_between => box_area_between
      procedure :: moment_between => box_moment_between
      procedure :: area => box_area
      procedure :: second_moment => box_second_moment
      procedure :: shear_area => box_shear_area
      procedure :: leg_share => box_leg_share
      procedure :: visit => visit_box
   end type box_type

   !> A circle with a circular void.
   type, extends(hollow_type) :: ring_type
   contains
      procedure :: width_at => ring_width_at
      procedure :: area_between => ring_area_between
      procedure :: moment_between => ring_moment_between
      procedure :: area => ring_area
      procedure :: second_moment => ring_second_moment
      procedure :: shear_area => ring_shear_area
      procedure :: leg_share => ring_leg_share
      procedure :: visit => visit_ring
   end type ring_type

contains

   !> The outside moves inwards, the void grows as much.
   pure subroutine shrink(self, width_by, depth_by)
      class(hollow_type), intent(inout) :: self
      real(wp), intent(in) :: width_by, depth_by

      self%width = max(0.0_wp, self%width - width_by)
      self%depth = max(0.0_wp, self%depth - depth_by)
      self%wall = max(0.0_wp, self%wall - depth_by)
      self%side_wall = max(0.0_wp, self%side_wall - width_by)
   end subroutine shrink

   ! ---- the box

   pure type(rectangle_type) function box_outside(self) result(solid)
      class(box_type), intent(in) :: self

      solid%width = self%width
      solid%depth = self%depth
   end function box_outside

   pure type(rectangle_type) function box_void(self) result(void)
      class(box_type), intent(in) :: self

      void%width = max(0.0_wp, self%width - 2.0_wp*self%side_wall)
      void%depth = max(0.0_wp, self%depth - 2.0_wp*self%wall)
   end function box_void

   elemental real(wp) function box_width_at(self, y) result(width)
      class(box_type), intent(in) :: self
      real(wp), intent(in) :: y
      type(rectangle_type) :: solid, void

      solid = box_outside(self)
      void = box_void(self)
      width = solid%width_at(y) - void%width_at(y)
   end function box_width_at

   elemental real(wp) function box_area_between(self, lo, hi) result(area)
      class(box_type), intent(in) :: self
      real(wp), intent(in) :: lo, hi
      type(rectangle_type) :: solid, void

      solid = box_outside(self)
      void = box_void(self)
      area = solid%area_between(lo, hi) - void%area_between(lo, hi)
   end function box_area_between

   elemental real(wp) function box_moment_between(self, lo, hi) result(moment)
      class(box_type), intent(in) :: self
      real(wp), intent(in) :: lo, hi
      type(rectangle_type) :: solid, void

      solid = box_outside(self)
      void = box_void(self)
      moment = solid%moment_between(lo, hi) - void%moment_between(lo, hi)
   end function box_moment_between

   elemental real(wp) function box_area(self) result(area)
      class(box_type), intent(in) :: self
      type(rectangle_type) :: solid, void

      solid = box_outside(self)
      void = box_void(self)
      area = solid%area() - void%area()
   end function box_area

   elemental real(wp) function box_second_moment(self) result(inertia)
      class(box_type), intent(in) :: self
      type(rectangle_type) :: solid, void

      solid = box_outside(self)
      void = box_void(self)
      inertia = solid%second_moment() - void%second_moment()
   end function box_second_moment

   !> 5/6 of the webs over the whole depth, which is that of the rectangle if there is no void.
   elemental real(wp) function box_shear_area(self) result(area)
      class(box_type), intent(in) :: self

      area = 5.0_wp/6.0_wp*min(2.0_wp*self%side_wall, self%width)*self%depth
   end function box_shear_area

   !> Legs along straight webs pull in full.
   elemental real(wp) function box_leg_share(self, y) result(share)
      class(box_type), intent(in) :: self
      real(wp), intent(in) :: y

      share = merge(1.0_wp, 0.0_wp, self%width > 0.0_wp .and. abs(y) >= 0.0_wp)
   end function box_leg_share

   subroutine visit_box(self, v)
      class(box_type), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%key('width', self%width, 'm', column_size, 'width, across the direction of loading')
      call v%key('depth', self%depth, 'm', column_size, 'depth, in the direction of loading')
      call v%key('wall', self%wall, 'm', column_size, 'thickness of the walls at the faces')
      call v%key('side_wall', self%side_wall, 'm', column_size, 'thickness of the webs')
   end subroutine visit_box

   ! ---- the ring

   pure type(circle_type) function ring_outside(self) result(solid)
      class(ring_type), intent(in) :: self

      solid%width = self%depth
      solid%depth = self%depth
   end function ring_outside

   pure type(circle_type) function ring_void(self) result(void)
      class(ring_type), intent(in) :: self

      void%depth = max(0.0_wp, self%depth - 2.0_wp*self%wall)
      void%width = void%depth
   end function ring_void

   elemental real(wp) function ring_width_at(self, y) result(width)
      class(ring_type), intent(in) :: self
      real(wp), intent(in) :: y
      type(circle_type) :: solid, void

      solid = ring_outside(self)
      void = ring_void(self)
      width = solid%width_at(y) - void%width_at(y)
   end function ring_width_at

   elemental real(wp) function ring_area_between(self, lo, hi) result(area)
      class(ring_type), intent(in) :: self
      real(wp), intent(in) :: lo, hi
      type(circle_type) :: solid, void

      solid = ring_outside(self)
      void = ring_void(self)
      area = solid%area_between(lo, hi) - void%area_between(lo, hi)
   end function ring_area_between

   elemental real(wp) function ring_moment_between(self, lo, hi) result(moment)
      class(ring_type), intent(in) :: self
      real(wp), intent(in) :: lo, hi
      type(circle_type) :: solid, void

      solid = ring_outside(self)
      void = ring_void(self)
      moment = solid%moment_between(lo, hi) - void%moment_between(lo, hi)
   end function ring_moment_between

   elemental real(wp) function ring_area(self) result(area)
      class(ring_type), intent(in) :: self
      type(circle_type) :: solid, void

      solid = ring_outside(self)
      void = ring_void(self)
      area = solid%area() - void%area()
   end function ring_area

   elemental real(wp) function ring_second_moment(self) result(inertia)
      class(ring_type), intent(in) :: self
      type(circle_type) :: solid, void

      solid = ring_outside(self)
      void = ring_void(self)
      inertia = solid%second_moment() - void%second_moment()
   end function ring_second_moment

   !> From that of the solid circle, 0.9 of the area, to half of the area of a thin ring, as the factor of
   !> Cowper (1966) falls with the square of the ratio of the radii (no Poisson's ratio).
   elemental real(wp) function ring_shear_area(self) result(area)
      class(ring_type), intent(in) :: self
      type(circle_type) :: void
      real(wp) :: m, factor

      void = ring_void(self)
      m = 0.0_wp
      if (self%depth > 0.0_wp) m = (void%depth/self%depth)**2
      factor = (1.0_wp + m)**2/((1.0_wp + m)**2 + 20.0_wp/7.0_wp*m)
      ! The factor goes from 1 to 7/12; so does this from 0.9 to 0.5.
      area = (0.5_wp + 0.4_wp*(factor - 7.0_wp/12.0_wp)*12.0_wp/5.0_wp)*self%area()
   end function ring_shear_area

   !> A round hoop pulls with the share of the solid circle.
   elemental real(wp) function ring_leg_share(self, y) result(share)
      class(ring_type), intent(in) :: self
      real(wp), intent(in) :: y
      type(circle_type) :: solid

      solid = ring_outside(self)
      share = solid%leg_share(y)
   end function ring_leg_share

   subroutine visit_ring(self, v)
      class(ring_type), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%key('diameter', self%depth, 'm', column_size, 'diameter')
      call v%key('wall', self%wall, 'm', column_size, 'thickness of the wall')
      self%width = self%depth
      self%side_wall = self%wall
   end subroutine visit_ring

end module rbs_section_shape_hollow
