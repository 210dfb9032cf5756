!> Input of a section: its shape, cover, concrete, steels, bars and hoops, under the names of keys.
module rbs_section_section_record
   use rbs_base_check, only: is_given
   use rbs_base_constants, only: unset, unset_integer
   use rbs_base_error, only: message_list
   use rbs_base_key_visitor, only: key_visitor, visited_record
   use rbs_base_keys, only: above_zero, any_number, bound_type, not_negative
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_section_concrete_law, only: concrete_record
   use rbs_section_confinement, only: no_ties, ties, spiral, circular_hoops
   use rbs_section_shape, only: bar_size, new_shape, shape_choices, shape_type
   use rbs_section_steel_law, only: steel_record
   implicit none
   private

   public :: section_record, bars_record, hoops_record, boundary_record, append_steel, find_steel, &
             add_no_steel

   integer, parameter :: most_bars = 100000

   type(bound_type), parameter :: strip_counts = bound_type(10.0_wp, 100000.0_wp)
   type(bound_type), parameter :: spacings = &
      bound_type(0.0_wp, 50.0_wp, least_open=.true., reason='(100 mm is 0.1)')

   !> Longitudinal bars, an entry for each bar or row of bars.
   type, extends(visited_record) :: bars_record
      !> Distance from mid-depth [m], y > 0 up in a beam, and area [m2]
      real(wp), allocatable :: y(:), area(:)
      !> Numbers of their steels
      integer, allocatable :: steel(:)
   contains
      procedure :: visit => visit_bars
   end type bars_record

   !> Ties, a spiral, or round hoops.
   type, extends(visited_record) :: hoops_record
      !> One of the kinds of `rbs_section_cross_section`
      integer :: kind = no_ties
      !> Diameter of the bar, distance between hoops or pitch along the column [m]
      real(wp) :: diameter = unset, spacing = unset
      !> Of ties: bars that cross the section along the depth and across it
      real(wp) :: legs = 2.0_wp, legs_across = unset
      !> Of round bars: whether they are single hoops, not a spiral
      logical :: hoops = .false.
      !> Number of the steel
      integer :: steel = unset_integer
   contains
      procedure :: visit => visit_hoops, name => name_of_hoops
   end type hoops_record

   !> The end of a wall at y < 0, that at y > 0, or both.
   character(len=5), parameter, public :: side_names(3) = [character(len=5) :: 'start', 'end', 'both']

   !> A boundary element of a wall.
   type, extends(visited_record) :: boundary_record
      character(len=5) :: side = 'both'
      !> Along the wall and across it; hoops: diameter of the bar and distance along the height [m]
      real(wp) :: length = unset, thickness = unset, hoop_diameter = unset, hoop_spacing = unset
      !> Diameter of its bars [m]
      real(wp) :: bar_diameter = unset
      !> Bars of a hoop parallel to the length of the wall and across it
      real(wp) :: legs_along = 2.0_wp, legs_across = 2.0_wp
      !> Number of the steel of the hoops
      integer :: steel = unset_integer
   contains
      procedure :: visit => visit_boundary
   end type boundary_record

   type, extends(visited_record) :: section_record
      !> Name of the shape
      character(len=16) :: shape_name = ''
      !> Outline of the concrete with its sizes, made when the name is put
      type(shape_type), allocatable :: shape
      !> Clear cover to the outer edge of the hoops, at the faces y = +-depth/2 and at the sides [m]
      real(wp) :: cover = 0.0_wp, side_cover = unset
      !> Diameter of the main bars [m]
      real(wp) :: bar_diameter = unset
      integer :: strips = 400
      type(concrete_record) :: concrete
      type(steel_record), allocatable :: steels(:)
      type(bars_record) :: bars
      type(hoops_record) :: hoops
      !> Of a wall
      type(boundary_record), allocatable :: boundaries(:)
   contains
      procedure :: visit => visit_section, validate => validate_section
   end type section_record

contains

   !> The keys of the section; those of its shape follow when that is known.
   subroutine visit_section(self, v)
      class(section_record), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%word('shape', self%shape_name, 'outline of the concrete', shape_choices)
      if (.not. allocated(self%shape)) call new_shape(self%shape_name, unset, unset, self%shape)
      if (allocated(self%shape)) call self%shape%visit(v)
      call v%key('cover', self%cover, 'm', not_negative, 'clear cover to the outer edge of the hoops')
      call v%key('side_cover', self%side_cover, 'm', not_negative, &
                 'clear cover at the sides; without it the same', optional=.true.)
      call v%key('bar_diameter', self%bar_diameter, 'm', above_zero, &
                 'diameter of the main bars, for hinge length and confinement', optional=.true.)
      call v%key('strips', self%strips, '', strip_counts, 'number of strips over the depth')
   end subroutine visit_section

   !> The keys of the bars.
   subroutine visit_bars(self, v)
      class(bars_record), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%key('y', self%y, 'm', any_number, 'distance from mid-depth; y > 0 is up in a beam', most_bars)
      call v%key('area', self%area, 'm2', above_zero, 'area of the bar or row', most_bars)
      call v%key('steel', self%steel, '', any_number, 'numbers of their steels', most_bars)
   end subroutine visit_bars

   !> The keys of a boundary element of a wall.
   subroutine visit_boundary(self, v)
      class(boundary_record), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%word('side', self%side, 'end of the wall: start is y < 0, end y > 0', 'both start end')
      call v%key('length', self%length, 'm', above_zero, 'length of the boundary element along the wall')
      call v%key('thickness', self%thickness, 'm', above_zero, &
                 'its thickness; without it that of the web', optional=.true.)
      call v%key('bar_diameter', self%bar_diameter, 'm', bar_size, &
                 'diameter of its bars, where some are rows', optional=.true.)
      call v%key('hoop_diameter', self%hoop_diameter, 'm', bar_size, &
                 'diameter of its hoops; without it there are none', optional=.true.)
      call v%key('hoop_spacing', self%hoop_spacing, 'm', spacings, 'distance between the hoops', &
                 optional=.true.)
      call v%key('legs_along', self%legs_along, '', above_zero, &
                 'bars of a hoop parallel to the length of the wall')
      call v%key('legs_across', self%legs_across, '', above_zero, 'bars of a hoop across the wall')
      call v%key('steel', self%steel, '', any_number, 'number of the steel of the hoops', optional=.true.)
   end subroutine visit_boundary

   !> The keys of hoops. Ties have legs to count; a spiral or round hoops have not.
   subroutine visit_hoops(self, v)
      class(hoops_record), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%key('diameter', self%diameter, 'm', bar_size, 'diameter of the bar')
      call v%key('spacing', self%spacing, 'm', spacings, 'distance between hoops, or pitch of the spiral')
      call v%key('steel', self%steel, '', any_number, 'number of the steel')
      if (self%kind == ties) then
         call v%key('legs', self%legs, '', above_zero, 'bars that cross the section along its depth')
         call v%key('legs_across', self%legs_across, '', above_zero, 'bars that cross the section along '// &
                    'its width; without it as many as legs', optional=.true.)
      else
         call v%key('hoops', self%hoops, 'single hoops in place of a spiral')
         if (self%hoops) self%kind = circular_hoops
      end if
   end subroutine visit_hoops

   !> Name of the group that the hoops come from.
   pure character(len=6) function name_of_hoops(self) result(name)
      class(hoops_record), intent(in) :: self

      name = merge('ties  ', 'spiral', self%kind == ties)
   end function name_of_hoops

   !> Add a message for every value that is refused.
   subroutine validate_section(self, messages)
      class(section_record), intent(inout) :: self
      type(message_list), intent(inout) :: messages
      integer :: i

      call self%check('section', messages)
      if (.not. allocated(self%shape)) call messages%add('section: shape is missing; give it a value')
      call self%concrete%validate(messages)
      do i = 1, size(self%steels)
         call self%steels(i)%validate(messages)
      end do
      call self%bars%check('bars', messages)
      call check_references(self, messages)
      if (self%hoops%kind /= no_ties) call self%hoops%check(self%hoops%name(), messages)
      if (.not. allocated(self%boundaries)) return
      if (size(self%boundaries) > 0) call check_boundaries(self, messages)
   end subroutine validate_section

   !> Boundary elements are those of a wall, one at each end, with whole hoops.
   subroutine check_boundaries(self, messages)
      type(section_record), intent(inout) :: self
      type(message_list), intent(inout) :: messages
      integer :: i, ends

      if (self%shape_name /= 'wall') call messages%add("boundary: it is for shape = 'wall'; remove it")
      ! Units count the elements at the start of the wall, tens those at its end.
      ends = 0
      do i = 1, size(self%boundaries)
         associate (boundary => self%boundaries(i))
            call boundary%check('boundary', messages)
            ends = ends + merge(1, 0, any(boundary%side == side_names([1, 3]))) + &
                   merge(10, 0, any(boundary%side == side_names(2:)))
            if (.not. is_given(boundary%hoop_diameter)) cycle
            if (.not. is_given(boundary%hoop_spacing)) then
               call messages%add('boundary: hoop_spacing is missing; give it a value in m')
            end if
            if (find_steel(self, boundary%steel) == 0) then
               call add_no_steel(messages, 'boundary: steel', boundary%steel)
            end if
         end associate
      end do
      if (mod(ends, 10) > 1 .or. ends > 11) then
         call messages%add("boundary: an end of the wall has two; give side = 'both' once, or "// &
                           "'start' and 'end'")
      end if
   end subroutine check_boundaries

   !> Add a message where the lists of the bars differ in length, or bars or hoops name a steel that is not
   !> there.
   subroutine check_references(self, messages)
      type(section_record), intent(in) :: self
      type(message_list), intent(inout) :: messages
      integer :: i

      if (self%hoops%kind /= no_ties .and. find_steel(self, self%hoops%steel) == 0) then
         call add_no_steel(messages, trim(self%hoops%name())//': steel', self%hoops%steel)
      end if
      if (.not. allocated(self%bars%y)) return
      if (.not. (allocated(self%bars%area) .and. allocated(self%bars%steel))) then
         call messages%add('bars: area or steel is missing; give them for each y')
      else if (size(self%bars%area) /= size(self%bars%y) .or. size(self%bars%steel) /= size(self%bars%y)) then
         call messages%add('bars: y, area and steel must have the same number of values')
      else
         do i = 1, size(self%bars%steel)
            if (find_steel(self, self%bars%steel(i)) > 0) cycle
            call add_no_steel(messages, 'bars: steel('//to_text(i)//')', self%bars%steel(i))
            return
         end do
      end if
   end subroutine check_references

   !> Number of a steel in the list by its id, 0 if it is not there.
   pure integer function find_steel(self, id) result(number)
      type(section_record), intent(in) :: self
      integer, intent(in) :: id

      do number = 1, size(self%steels)
         if (self%steels(number)%id == id) return
      end do
      number = 0
   end function find_steel

   !> The message on a key that names a steel which is not there.
   subroutine add_no_steel(messages, key, id)
      type(message_list), intent(inout) :: messages
      !> Group and key: 'bars: steel(2)'
      character(len=*), intent(in) :: key
      integer, intent(in) :: id

      call messages%add(key//' = '//to_text(id)// &
                        ' is not the id of a steel of the section; correct it, or add that steel')
   end subroutine add_no_steel

   !> One more steel, without values.
   subroutine append_steel(self)
      type(section_record), intent(inout) :: self
      type(steel_record), allocatable :: more(:)

      if (.not. allocated(self%steels)) allocate (self%steels(0))
      allocate (more(size(self%steels) + 1))
      more(:size(self%steels)) = self%steels
      call move_alloc(more, self%steels)
   end subroutine append_steel

end module rbs_section_section_record
