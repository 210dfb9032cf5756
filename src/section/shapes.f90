!> The list of shapes, and the only procedures that make them.
module rbs_section_shapes
   use rbs_base_kinds, only: wp
   use rbs_section_shape, only: shape_type
   use rbs_section_shape_circle, only: circle_type
   use rbs_section_shape_hollow, only: box_type, ring_type
   use rbs_section_shape_rectangle, only: rectangle_type
   implicit none
   private

   public :: new_shape, new_core

   character(len=16), parameter, public :: shape_names(4) = [character(len=16) :: &
      'rectangle', 'circle', 'hollow_rectangle', 'hollow_circle']
   !> The names as choices of a key
   character(len=*), parameter, public :: shape_choices = 'rectangle circle hollow_rectangle hollow_circle'

contains

   !> Make a shape by its name; of another name none is made.
   subroutine new_shape(name, width, depth, shape)
      !> One of `shape_names`
      character(len=*), intent(in) :: name
      !> Sizes across and along the direction of loading [m]; `unset` where keys will put them
      real(wp), intent(in) :: width, depth
      class(shape_type), allocatable, intent(inout) :: shape

      if (allocated(shape)) deallocate (shape)
      select case (name)
      case ('rectangle')
         allocate (rectangle_type :: shape)
      case ('circle')
         allocate (circle_type :: shape)
      case ('hollow_rectangle')
         allocate (box_type :: shape)
      case ('hollow_circle')
         allocate (ring_type :: shape)
      case default
         return
      end select
      shape%width = width
      shape%depth = depth
      shape%hollow = index(name, 'hollow') > 0
      shape%round = index(name, 'circle') > 0
   end subroutine new_shape

   !> Make the shape that the hoops of an outline enclose: a round hoop encloses a circle, ties enclose a
   !> smaller figure of the same shape.
   subroutine new_core(outline, round, width_by, depth_by, core)
      class(shape_type), intent(in) :: outline
      !> Whether the hoops are round
      logical, intent(in) :: round
      !> Reductions of width and depth from the outline to the hoop centre lines [m]
      real(wp), intent(in) :: width_by, depth_by
      class(shape_type), allocatable, intent(inout) :: core

      if (allocated(core)) deallocate (core)
      if (round .and. .not. outline%round) then
         call new_shape('circle', outline%depth, outline%depth, core)
      else
         allocate (core, source=outline)
      end if
      call core%shrink(width_by, depth_by)
   end subroutine new_core

end module rbs_section_shapes
