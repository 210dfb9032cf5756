!> A rectangle.
module rbs_section_shape_rectangle
   use rbs_base_key_visitor, only: key_visitor
   use rbs_base_kinds, only: wp
   use rbs_section_shape, only: column_size, shape_type
   implicit none
   private

   public :: rectangle_type

   type, extends(shape_type) :: rectangle_type
   contains
      procedure :: width_at
      procedure :: area_between
      procedure :: moment_between
      procedure :: area
      procedure :: second_moment
      procedure :: shear_area
      procedure :: shrink
      procedure :: visit
   end type rectangle_type

contains

   elemental real(wp) function width_at(self, y)
      class(rectangle_type), intent(in) :: self
      real(wp), intent(in) :: y

      width_at = 0.0_wp
      if (abs(y) <= 0.5_wp*self%depth) width_at = self%width
   end function width_at

   elemental real(wp) function area_between(self, lo, hi)
      class(rectangle_type), intent(in) :: self
      real(wp), intent(in) :: lo, hi

      area_between = self%width*max(0.0_wp, min(hi, 0.5_wp*self%depth) - max(lo, -0.5_wp*self%depth))
   end function area_between

   elemental real(wp) function moment_between(self, lo, hi)
      class(rectangle_type), intent(in) :: self
      real(wp), intent(in) :: lo, hi
      real(wp) :: a, b

      a = max(lo, -0.5_wp*self%depth)
      b = min(hi, 0.5_wp*self%depth)
      moment_between = 0.5_wp*(a + b)*self%width*max(0.0_wp, b - a)
   end function moment_between

   elemental real(wp) function area(self)
      class(rectangle_type), intent(in) :: self

      area = self%width*self%depth
   end function area

   elemental real(wp) function second_moment(self)
      class(rectangle_type), intent(in) :: self

      second_moment = self%width*self%depth**3/12.0_wp
   end function second_moment

   elemental real(wp) function shear_area(self)
      class(rectangle_type), intent(in) :: self

      shear_area = 5.0_wp/6.0_wp*self%area()
   end function shear_area

   pure subroutine shrink(self, width_by, depth_by)
      class(rectangle_type), intent(inout) :: self
      real(wp), intent(in) :: width_by, depth_by

      self%width = max(0.0_wp, self%width - width_by)
      self%depth = max(0.0_wp, self%depth - depth_by)
   end subroutine shrink

   subroutine visit(self, v)
      class(rectangle_type), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%key('width', self%width, 'm', column_size, 'width, across the direction of loading')
      call v%key('depth', self%depth, 'm', column_size, 'depth, in the direction of loading')
   end subroutine visit

end module rbs_section_shape_rectangle
