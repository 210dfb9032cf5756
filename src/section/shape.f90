!> The shape of a section: a plane figure, symmetric about mid-depth and about the direction of loading.
!>
!> y runs from mid-depth. The concrete outline of a section is a shape, and so is the core that its hoops
!> enclose. A new shape is one file with a type that extends this one, and two lines in `shapes.f90`.
module rbs_section_shape
   use rbs_base_check, only: check_positive
   use rbs_base_error, only: message_list
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   implicit none
   private

   public :: shape_type, check_size

   !> Largest size [m]; a larger one was probably given in millimetres.
   real(wp), parameter, public :: largest_size = 50.0_wp

   type, abstract :: shape_type
      !> Sizes of the smallest rectangle around the figure: across and along the direction of loading [m]
      real(wp) :: width = 0.0_wp, depth = 0.0_wp
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
      !> Add a message for every size that is refused
      procedure(check_sizes), deferred :: check
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

      subroutine check_sizes(self, messages, ok)
         import :: message_list, shape_type
         implicit none
         class(shape_type), intent(in) :: self
         type(message_list), intent(inout) :: messages
         logical, intent(out) :: ok
      end subroutine check_sizes
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

   !> Add a message if a size is not positive, or too large for a column.
   subroutine check_size(size_of, name, messages, ok)
      !> [m]
      real(wp), intent(in) :: size_of
      character(len=*), intent(in) :: name
      type(message_list), intent(inout) :: messages
      logical, intent(out) :: ok

      call check_positive(size_of, name, 'm', messages, ok)
      if (.not. ok) return
      ok = size_of <= largest_size
      if (ok) return
      call messages%add(name//' = '//to_text(size_of)//' m is larger than any column; 400 mm is 0.4')
   end subroutine check_size

end module rbs_section_shape
