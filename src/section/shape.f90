!> The shape of a section: a plane figure, symmetric about mid-depth and about the direction of loading.
!>
!> y runs from mid-depth. The concrete outline of a section is a shape, and so is the core that its hoops
!> enclose. A new shape is one file with a type that extends this one, and two lines in `shapes.f90`.
module rbs_section_shape
   use rbs_base_key_visitor, only: key_visitor
   use rbs_base_keys, only: bound_type
   use rbs_base_kinds, only: wp
   implicit none
   private

   public :: shape_type

   !> Sizes of columns [m]: a larger number was given in millimetres.
   type(bound_type), parameter, public :: column_size = &
      bound_type(0.0_wp, 50.0_wp, least_open=.true., reason='(400 mm is 0.4)')

   type, abstract :: shape_type
      !> Sizes of the smallest rectangle around the figure: across and along the direction of loading [m]
      real(wp) :: width = 0.0_wp, depth = 0.0_wp
      !> Whether there is a void in the middle, and whether round hoops enclose a figure of the same shape
      logical :: hollow = .false., round = .false.
   contains
      !> Width at a distance from mid-depth [m]; zero outside
      procedure(at_depth), deferred :: width_at
      !> Integrals of the width and of y times the width between two distances from mid-depth [m2], [m3]
      procedure(between), deferred :: area_between
      procedure(between), deferred :: moment_between
      !> Area [m2], second moment about mid-depth [m4]
      procedure(figure), deferred :: area
      procedure(figure), deferred :: second_moment
      !> Area of an elastic section that carries shear [m2]
      procedure(figure), deferred :: shear_area
      procedure :: leg_share
      !> Reduce the sizes, not below zero
      procedure(reduce), deferred :: shrink
      !> Show the sizes as keys
      procedure(show_keys), deferred :: visit
   end type shape_type

   abstract interface
      elemental real(wp) function at_depth(self, y)
         import :: shape_type, wp
         implicit none
         class(shape_type), intent(in) :: self
         !> Distance from mid-depth [m]
         real(wp), intent(in) :: y
      end function at_depth

      elemental real(wp) function between(self, lo, hi)
         import :: shape_type, wp
         implicit none
         class(shape_type), intent(in) :: self
         !> Distances from mid-depth, lo <= hi [m]
         real(wp), intent(in) :: lo, hi
      end function between

      elemental real(wp) function figure(self)
         import :: shape_type, wp
         implicit none
         class(shape_type), intent(in) :: self
      end function figure

      pure subroutine reduce(self, width_by, depth_by)
         import :: shape_type, wp
         implicit none
         class(shape_type), intent(inout) :: self
         !> [m]
         real(wp), intent(in) :: width_by, depth_by
      end subroutine reduce

      subroutine show_keys(self, v)
         import :: key_visitor, shape_type
         implicit none
         class(shape_type), intent(inout) :: self
         type(key_visitor), intent(inout) :: v
      end subroutine show_keys
   end interface

contains

   !> Share of their force with which the legs of a hoop along the outline pull in the direction of loading:
   !> all of it on a straight side; sqrt(1 - (y/r)^2), the share of the width, where the hoop is round.
   elemental real(wp) function leg_share(self, y)
      class(shape_type), intent(in) :: self
      !> Distance from mid-depth [m]; outside the share is that at the edge
      real(wp), intent(in) :: y

      leg_share = 0.0_wp
      if (self%width > 0.0_wp) leg_share = self%width_at(min(abs(y), 0.5_wp*self%depth))/self%width
   end function leg_share

end module rbs_section_shape
