!> The shape of a section: a rectangle or a circle, one of them with a void of the same form in its middle, or
!> a rectangle with a flange at one face, or a wall, which may have a flange at each end.
!>
!> y runs from mid-depth. The concrete outline of a section is a shape, and so is the core that its hoops
!> enclose; where there is a void, the core lies between hoops around the outside and hoops around the void,
!> with the same cover at both. A hollow figure is the difference of two solid ones, one with flanges the sum
!> of its web and the wings beside it; the hoops of a tee are around its web. The core of a wall is what the
!> hoops of its boundary elements enclose: two flanges without a web between them.
module rbs_section_shape
   use rbs_base_constants, only: pi
   use rbs_base_key_visitor, only: key_visitor
   use rbs_base_keys, only: bound_type
   use rbs_base_kinds, only: wp
   implicit none
   private

   public :: shape_type, new_shape, new_core

   character(len=16), parameter, public :: shape_names(6) = [character(len=16) :: &
      'rectangle', 'circle', 'hollow_rectangle', 'hollow_circle', 'tee', 'wall']
   !> The names as choices of a key
   character(len=*), parameter, public :: shape_choices = &
      'rectangle circle hollow_rectangle hollow_circle tee wall'

   !> Sizes of columns [m]: a larger number was given in millimetres.
   type(bound_type), parameter, public :: column_size = &
      bound_type(0.0_wp, 50.0_wp, least_open=.true., reason='(400 mm is 0.4)')

   !> Diameters of bars [m].
   real(wp), parameter, public :: thickest_bar = 0.075_wp
   type(bound_type), parameter, public :: bar_size = &
      bound_type(0.0_wp, thickest_bar, least_open=.true., reason='(20 mm is 0.02)')

   type :: shape_type
      !> Sizes of the smallest rectangle around the figure: across and along the direction of loading [m]; the
      !> width is that of the web where there is a flange
      real(wp) :: width = 0.0_wp, depth = 0.0_wp
      !> Whether it is a circle, else a rectangle; whether there is a void in the middle, or a flange
      logical :: round = .false., hollow = .false., flanged = .false.
      !> Thickness of the walls around the void: at the faces y = +-depth/2, and of the webs [m]
      real(wp) :: wall = 0.0_wp, side_wall = 0.0_wp
      !> Width of the flange with that of the web, its thickness [m]; whether it is at the face y = -depth/2
      real(wp) :: flange_width = 0.0_wp, flange_thickness = 0.0_wp
      logical :: flange_below = .false.
      !> Whether it is a wall; widths with that of the web and lengths of what is at its ends y = -depth/2 and
      !> y = depth/2, and how far that is from them [m]
      logical :: walled = .false.
      real(wp) :: end_width(2) = 0.0_wp, end_length(2) = 0.0_wp, end_inset(2) = 0.0_wp
   contains
      procedure :: area_between, moment_between, area, centroid, second_moment, shear_area, leg_share, shrink
      procedure :: visit
   end type shape_type

contains

   !> Make a shape by its name; of another name none is made.
   subroutine new_shape(name, width, depth, shape)
      !> One of `shape_names`
      character(len=*), intent(in) :: name
      !> Sizes across and along the direction of loading [m]; `unset` where keys will put them
      real(wp), intent(in) :: width, depth
      type(shape_type), allocatable, intent(out) :: shape

      if (all(shape_names /= name)) return
      shape = shape_type(width, depth, round=index(name, 'circle') > 0, hollow=index(name, 'hollow') > 0, &
                         flanged=name == 'tee', walled=name == 'wall')
   end subroutine new_shape

   !> Make the shape that the hoops of an outline enclose: a round hoop encloses a circle, ties enclose a
   !> smaller figure of the same shape.
   subroutine new_core(outline, round, width_by, depth_by, core)
      type(shape_type), intent(in) :: outline
      !> Whether the hoops are round
      logical, intent(in) :: round
      !> Reductions of the whole width and depth from the outline to the hoop centre lines [m]
      real(wp), intent(in) :: width_by, depth_by
      type(shape_type), allocatable, intent(out) :: core

      core = outline
      core%flanged = .false.
      if (round .and. .not. outline%round) core = shape_type(outline%depth, outline%depth, round=.true.)
      call core%shrink(width_by, depth_by)
   end subroutine new_core

   !> The void of a hollow shape, as a solid one.
   elemental type(shape_type) function void_of(self) result(void)
      type(shape_type), intent(in) :: self

      void%round = self%round
      void%width = max(0.0_wp, self%width - 2.0_wp*self%side_wall)
      void%depth = max(0.0_wp, self%depth - 2.0_wp*self%wall)
   end function void_of

   !> Both wings of a flange beside the web, as one rectangle; without a depth where there is none.
   elemental type(shape_type) function wings_of(self, side) result(wings)
      type(shape_type), intent(in) :: self
      !> 1 at the face y = -depth/2, 2 at the other
      integer, intent(in) :: side

      if (self%walled) then
         wings%width = self%end_width(side) - self%width
         wings%depth = self%end_length(side)
      else if (self%flanged .and. side == merge(1, 2, self%flange_below)) then
         wings%width = self%flange_width - self%width
         wings%depth = self%flange_thickness
      end if
   end function wings_of

   !> Distance of the middle of a flange from mid-depth [m].
   elemental real(wp) function middle_of_flange(self, side) result(y)
      type(shape_type), intent(in) :: self
      !> 1 at the face y = -depth/2, 2 at the other
      integer, intent(in) :: side
      type(shape_type) :: wings

      wings = wings_of(self, side)
      y = merge(0.5_wp, -0.5_wp, side == 2)*(self%depth - wings%depth - 2.0_wp*self%end_inset(side))
   end function middle_of_flange

   !> Whether there may be flanges.
   elemental logical function has_wings(self)
      type(shape_type), intent(in) :: self

      has_wings = self%flanged .or. self%walled
   end function has_wings

   !> Integral of the width between two distances from mid-depth [m2].
   elemental real(wp) function area_between(self, lo, hi) result(area)
      class(shape_type), intent(in) :: self
      !> lo <= hi [m]
      real(wp), intent(in) :: lo, hi
      real(wp) :: middle
      integer :: side

      area = solid_area_between(self, lo, hi)
      if (self%hollow) area = area - solid_area_between(void_of(self), lo, hi)
      if (.not. has_wings(self)) return
      do side = 1, 2
         middle = middle_of_flange(self, side)
         area = area + solid_area_between(wings_of(self, side), lo - middle, hi - middle)
      end do
   end function area_between

   !> Area between two distances from mid-depth of a rectangle or circle without void and wings [m2].
   elemental real(wp) function solid_area_between(self, lo, hi) result(area)
      type(shape_type), intent(in) :: self
      !> lo <= hi [m]
      real(wp), intent(in) :: lo, hi
      real(wp) :: radius, a, b

      area = 0.0_wp
      radius = 0.5_wp*self%depth
      if (.not. self%round) then
         area = self%width*max(0.0_wp, min(hi, radius) - max(lo, -radius))
      else if (radius > 0.0_wp) then
         a = min(max(lo/radius, -1.0_wp), 1.0_wp)
         b = min(max(hi/radius, -1.0_wp), 1.0_wp)
         area = radius**2*((b*sqrt(1.0_wp - b**2) + asin(b)) - (a*sqrt(1.0_wp - a**2) + asin(a)))
      end if
   end function solid_area_between

   !> Integral of y times the width between two distances from mid-depth [m3].
   elemental real(wp) function moment_between(self, lo, hi) result(moment)
      class(shape_type), intent(in) :: self
      !> lo <= hi [m]
      real(wp), intent(in) :: lo, hi
      type(shape_type) :: wings
      real(wp) :: middle
      integer :: side

      moment = solid_moment_between(self, lo, hi)
      if (self%hollow) moment = moment - solid_moment_between(void_of(self), lo, hi)
      if (.not. has_wings(self)) return
      do side = 1, 2
         wings = wings_of(self, side)
         middle = middle_of_flange(self, side)
         moment = moment + solid_moment_between(wings, lo - middle, hi - middle) + &
                  middle*solid_area_between(wings, lo - middle, hi - middle)
      end do
   end function moment_between

   !> First moment about mid-depth of a rectangle or circle without void and wings, between two distances from
   !> mid-depth [m3].
   elemental real(wp) function solid_moment_between(self, lo, hi) result(moment)
      type(shape_type), intent(in) :: self
      !> lo <= hi [m]
      real(wp), intent(in) :: lo, hi
      real(wp) :: radius, a, b

      moment = 0.0_wp
      radius = 0.5_wp*self%depth
      if (.not. self%round) then
         a = max(lo, -radius)
         b = min(hi, radius)
         moment = 0.5_wp*(a + b)*self%width*max(0.0_wp, b - a)
      else if (radius > 0.0_wp) then
         a = 1.0_wp - min(max(lo/radius, -1.0_wp), 1.0_wp)**2
         b = 1.0_wp - min(max(hi/radius, -1.0_wp), 1.0_wp)**2
         moment = 2.0_wp/3.0_wp*radius**3*(a*sqrt(a) - b*sqrt(b))
      end if
   end function solid_moment_between

   !> Area [m2].
   elemental real(wp) function area(self)
      class(shape_type), intent(in) :: self

      area = solid_area(self)
      if (self%hollow) area = area - solid_area(void_of(self))
      if (has_wings(self)) area = area + (solid_area(wings_of(self, 1)) + solid_area(wings_of(self, 2)))
   end function area

   !> Area of the rectangle or circle without void and wings [m2].
   elemental real(wp) function solid_area(self)
      type(shape_type), intent(in) :: self

      solid_area = merge(0.25_wp*pi*self%depth**2, self%width*self%depth, self%round)
   end function solid_area

   !> Distance of the centroid from mid-depth [m].
   elemental real(wp) function centroid(self)
      class(shape_type), intent(in) :: self

      centroid = 0.0_wp
      if (has_wings(self)) centroid = (middle_of_flange(self, 1)*solid_area(wings_of(self, 1)) + &
                                       middle_of_flange(self, 2)*solid_area(wings_of(self, 2)))/self%area()
   end function centroid

   !> Second moment of the area about its centroid [m4].
   elemental real(wp) function second_moment(self)
      class(shape_type), intent(in) :: self
      type(shape_type) :: wings
      real(wp) :: middle
      integer :: side

      second_moment = solid_second_moment(self)
      if (self%hollow) second_moment = second_moment - solid_second_moment(void_of(self))
      if (.not. has_wings(self)) return
      do side = 1, 2
         wings = wings_of(self, side)
         middle = middle_of_flange(self, side)
         ! Over both sides area*middle*(middle - centroid) moves all moments to the centroid.
         second_moment = second_moment + solid_second_moment(wings) + &
                         solid_area(wings)*middle*(middle - self%centroid())
      end do
   end function second_moment

   !> Second moment of the rectangle or circle without void and wings about its middle [m4].
   elemental real(wp) function solid_second_moment(self)
      type(shape_type), intent(in) :: self

      solid_second_moment = merge(pi*self%depth**4/64.0_wp, self%width*self%depth**3/12.0_wp, self%round)
   end function solid_second_moment

   !> Area of an elastic section that carries shear [m2]: 5/6 of a rectangle, 0.9 of a circle, 5/6 of the webs
   !> of a box or a tee over the whole depth. From 0.9 to half of the area of a thin ring, as the factor of
   !> Cowper (1966) falls with the square of the ratio of the radii (no Poisson's ratio).
   elemental real(wp) function shear_area(self) result(area)
      class(shape_type), intent(in) :: self
      type(shape_type) :: void
      real(wp) :: m, factor

      if (self%round .and. self%hollow) then
         void = void_of(self)
         m = 0.0_wp
         if (self%depth > 0.0_wp) m = (void%depth/self%depth)**2
         factor = (1.0_wp + m)**2/((1.0_wp + m)**2 + 20.0_wp/7.0_wp*m)
         ! The factor goes from 1 to 7/12; so does this from 0.9 to 0.5.
         area = (0.5_wp + 0.4_wp*(factor - 7.0_wp/12.0_wp)*12.0_wp/5.0_wp)*self%area()
      else if (self%hollow) then
         area = 5.0_wp/6.0_wp*min(2.0_wp*self%side_wall, self%width)*self%depth
      else
         area = merge(0.9_wp, 5.0_wp/6.0_wp, self%round)*solid_area(self)
      end if
   end function shear_area

   !> Share of their force with which the legs of a hoop along the outline pull in the direction of loading:
   !> all of it on a straight side; sqrt(1 - (y/r)^2), the share of the width, where the hoop is round.
   elemental real(wp) function leg_share(self, y)
      class(shape_type), intent(in) :: self
      !> Distance from mid-depth [m]; outside the share is that at the edge
      real(wp), intent(in) :: y

      leg_share = 0.0_wp
      if (.not. merge(self%depth, self%width, self%round) > 0.0_wp .and. .not. self%walled) return
      leg_share = 1.0_wp
      if (self%round) leg_share = 2.0_wp*sqrt(max(0.0_wp, (0.5_wp*self%depth)**2 - y**2))/self%depth
   end function leg_share

   !> Reduce the sizes, not below zero; a void grows as much as the outside moves inwards.
   pure subroutine shrink(self, width_by, depth_by)
      class(shape_type), intent(inout) :: self
      !> Reductions of width and depth, half of each on either side [m]
      real(wp), intent(in) :: width_by, depth_by

      self%width = max(0.0_wp, self%width - width_by)
      self%depth = max(0.0_wp, self%depth - depth_by)
      if (self%round .and. .not. self%hollow) then
         self%depth = min(self%width, self%depth)
         self%width = self%depth
      end if
      self%wall = max(0.0_wp, self%wall - depth_by)
      self%side_wall = max(0.0_wp, self%side_wall - width_by)
   end subroutine shrink

   !> Present the sizes as keys.
   subroutine visit(self, v)
      class(shape_type), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      if (self%round) then
         call v%key('diameter', self%depth, 'm', column_size, 'diameter')
         if (self%hollow) call v%key('wall', self%wall, 'm', column_size, 'thickness of the wall')
         self%width = self%depth
         self%side_wall = self%wall
      else
         call v%key('width', self%width, 'm', column_size, 'width, across the direction of loading')
         call v%key('depth', self%depth, 'm', column_size, 'depth, in the direction of loading')
         if (self%hollow) then
            call v%key('wall', self%wall, 'm', column_size, 'thickness of the walls at the faces')
            call v%key('side_wall', self%side_wall, 'm', column_size, 'thickness of the webs')
         else if (self%flanged) then
            call v%key('flange_width', self%flange_width, 'm', column_size, &
                       'width of the flange with that of the web')
            call v%key('flange_thickness', self%flange_thickness, 'm', column_size, 'thickness of the flange')
            call v%key('flange_below', self%flange_below, 'flange at the face y < 0, below')
         end if
      end if
   end subroutine visit

end module rbs_section_shape
