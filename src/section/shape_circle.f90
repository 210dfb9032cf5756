!> A circle; its diameter is its width and its depth.
module rbs_section_shape_circle
   use rbs_base_constants, only: pi
   use rbs_base_key_visitor, only: key_visitor
   use rbs_base_kinds, only: wp
   use rbs_section_shape, only: column_size, shape_type
   implicit none
   private

   public :: circle_type

   type, extends(shape_type) :: circle_type
   contains
      procedure :: width_at
      procedure :: area_between
      procedure :: moment_between
      procedure :: area
      procedure :: second_moment
      procedure :: shear_area
      procedure :: shrink
      procedure :: visit
   end type circle_type

contains

   elemental real(wp) function width_at(self, y)
      class(circle_type), intent(in) :: self
      real(wp), intent(in) :: y

      width_at = 2.0_wp*sqrt(max(0.0_wp, (0.5_wp*self%depth)**2 - y**2))
   end function width_at

   elemental real(wp) function area_between(self, lo, hi)
      class(circle_type), intent(in) :: self
      real(wp), intent(in) :: lo, hi
      real(wp) :: radius, a, b

      area_between = 0.0_wp
      radius = 0.5_wp*self%depth
      if (.not. radius > 0.0_wp) return
      a = min(max(lo/radius, -1.0_wp), 1.0_wp)
      b = min(max(hi/radius, -1.0_wp), 1.0_wp)
      area_between = radius**2*((b*sqrt(1.0_wp - b**2) + asin(b)) - (a*sqrt(1.0_wp - a**2) + asin(a)))
   end function area_between

   elemental real(wp) function moment_between(self, lo, hi)
      class(circle_type), intent(in) :: self
      real(wp), intent(in) :: lo, hi
      real(wp) :: radius, a, b

      moment_between = 0.0_wp
      radius = 0.5_wp*self%depth
      if (.not. radius > 0.0_wp) return
      a = 1.0_wp - min(max(lo/radius, -1.0_wp), 1.0_wp)**2
      b = 1.0_wp - min(max(hi/radius, -1.0_wp), 1.0_wp)**2
      moment_between = 2.0_wp/3.0_wp*radius**3*(a*sqrt(a) - b*sqrt(b))
   end function moment_between

   elemental real(wp) function area(self)
      class(circle_type), intent(in) :: self

      area = 0.25_wp*pi*self%depth**2
   end function area

   elemental real(wp) function second_moment(self)
      class(circle_type), intent(in) :: self

      second_moment = pi*self%depth**4/64.0_wp
   end function second_moment

   elemental real(wp) function shear_area(self)
      class(circle_type), intent(in) :: self

      shear_area = 0.9_wp*self%area()
   end function shear_area

   pure subroutine shrink(self, width_by, depth_by)
      class(circle_type), intent(inout) :: self
      real(wp), intent(in) :: width_by, depth_by

      self%depth = max(0.0_wp, self%depth - max(width_by, depth_by))
      self%width = self%depth
   end subroutine shrink

   subroutine visit(self, v)
      class(circle_type), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%key('diameter', self%depth, 'm', column_size, 'diameter')
      self%width = self%depth
   end subroutine visit

end module rbs_section_shape_circle
