!> A drawing: a section, and the choices of the model. The springs of a column are in the case as well, and
!> the solver takes them; members of a frame are named after their drawings, and Python makes their springs.
module rbs_case_drawing_record
   use rbs_base_check, only: is_given
   use rbs_base_constants, only: unset, unset_integer
   use rbs_base_error, only: message_list
   use rbs_base_key_visitor, only: key_visitor, visited_record
   use rbs_base_keys, only: above_zero, any_number, bound_type, not_negative, one_or_more
   use rbs_base_kinds, only: wp
   use rbs_structure_column_column_record, only: most_bodies
   use rbs_structure_frame_frame_record, only: name_length
   use rbs_section_confinement, only: no_ties, spiral, ties
   use rbs_section_section_record, only: append_steel, boundary_record, find_steel, add_no_steel, &
                                         section_record
   use rbs_section_shape, only: bar_size
   implicit none
   private

   public :: drawing_record

   !> The groups of a drawing.
   character(len=12), parameter, public :: drawing_groups(14) = [character(len=12) :: &
      'drawing', 'section', 'concrete', 'steel', 'bars', 'row', 'layout', 'inner_layout', 'ties', 'spiral', &
      'boundary', 'curtain', 'lap', 'parameter']

   !> Bars by number and diameter, on the faces of a rectangle or around a circle.
   type, extends(visited_record) :: layout_record
      integer :: number = unset_integer
      real(wp) :: diameter = unset
      !> Number of their steel; bars on the tension face
      integer :: steel = unset_integer, face = unset_integer
      !> Bars between the corners, where they differ
      real(wp) :: between_diameter = unset
      integer :: between_steel = unset_integer
   contains
      procedure :: visit => visit_layout
   end type layout_record

   !> A row of equal bars along a face of a rectangle; those of one face follow each other inwards.
   type, extends(visited_record) :: row_record
      character(len=8) :: face = ''
      integer :: number = unset_integer, steel = unset_integer
      real(wp) :: diameter = unset, clear = unset
   contains
      procedure :: visit => visit_row
   end type row_record
   !> A lap of the bars at the foot of a column.
   type, extends(visited_record) :: lap_record
      real(wp) :: length = unset, development_length = unset
   contains
      procedure :: visit => visit_lap
   end type lap_record

   !> Bars of the web of a wall, as a mesh.
   type, extends(visited_record) :: curtain_record
      character(len=10) :: direction = 'vertical'
      real(wp) :: diameter = unset, spacing = unset
      integer :: faces = 2, steel = unset_integer
   contains
      procedure :: visit => visit_curtain
   end type curtain_record

   !> A parameter of the model that is not that of its version.
   type, extends(visited_record) :: parameter_record
      character(len=32) :: name = ''
      real(wp) :: value = unset
   contains
      procedure :: visit => visit_parameter
   end type parameter_record

   type, extends(visited_record) :: drawing_record
      !> By which the members of a frame are named after it
      character(len=name_length) :: name = ''
      type(section_record) :: section
      !> In place of bars one by one: rows along the faces, or along the hoops, and along those around a void
      type(row_record), allocatable :: rows(:)
      type(layout_record), allocatable :: layout, inner_layout
      type(lap_record), allocatable :: lap
      !> Version of the parameters of the layered model
      character(len=32) :: version = ''
      !> From an end to where the moment is zero [m], the axial load [N], bodies of that part
      real(wp) :: height = unset, axial_load = unset
      !> Moment over shear at the foot of a wall, where it is not the height [m]
      real(wp) :: shear_span = unset
      integer :: n = unset_integer
      !> Bars that hoops hold, and whether the core of a rectangle is round
      integer :: restrained = unset_integer
      logical :: round_core = .false.
      type(parameter_record), allocatable :: parameters(:)
      !> Of a wall: vertical bars of the web, and horizontal ones
      type(curtain_record), allocatable :: curtains(:)
      !> Whether the group itself and its concrete were given, and how many groups of hoops were
      logical :: stated = .false., has_concrete = .false.
      integer :: hoops = 0
   contains
      procedure :: open_group, count_of, visit => visit_drawing, visit_group, take_materials, validate
   end type drawing_record

contains

   !> Make room for the values of a group.
   subroutine open_group(self, group)
      class(drawing_record), intent(inout) :: self
      character(len=*), intent(in) :: group

      if (.not. allocated(self%section%steels)) allocate (self%section%steels(0))
      if (.not. allocated(self%parameters)) allocate (self%parameters(0), self%rows(0))
      if (.not. allocated(self%curtains)) allocate (self%curtains(0))
      if (.not. allocated(self%section%boundaries)) allocate (self%section%boundaries(0))
      if (group == 'ties' .or. group == 'spiral') self%hoops = self%hoops + 1
      select case (group)
      case ('drawing')
         self%stated = .true.
      case ('concrete')
         self%has_concrete = .true.
      case ('steel')
         call append_steel(self%section)
      case ('row')
         self%rows = [self%rows, row_record()]
      case ('layout')
         allocate (self%layout)
      case ('inner_layout')
         allocate (self%inner_layout)
      case ('lap')
         allocate (self%lap)
      case ('ties')
         self%section%hoops%kind = ties
      case ('spiral')
         self%section%hoops%kind = spiral
      case ('parameter')
         self%parameters = [self%parameters, parameter_record()]
      case ('boundary')
         self%section%boundaries = [self%section%boundaries, boundary_record()]
      case ('curtain')
         self%curtains = [self%curtains, curtain_record()]
      case default                                  ! always there
      end select
   end subroutine open_group

   !> How many groups of a name there are.
   pure integer function count_of(self, group) result(number)
      class(drawing_record), intent(in) :: self
      character(len=*), intent(in) :: group

      number = 1
      if (group == 'steel') number = size(self%section%steels)
      if (group == 'parameter') number = size(self%parameters)
      if (group == 'row') number = size(self%rows)
      if (group == 'boundary') number = size(self%section%boundaries)
      if (group == 'curtain') number = size(self%curtains)
      if (group == 'layout') number = merge(1, 0, allocated(self%layout))
      if (group == 'inner_layout') number = merge(1, 0, allocated(self%inner_layout))
      if (group == 'lap') number = merge(1, 0, allocated(self%lap))
      if (group == 'ties') number = merge(1, 0, self%section%hoops%kind == ties)
      if (group == 'spiral') number = merge(1, 0, all(self%section%hoops%kind /= [no_ties, ties]))
   end function count_of

   !> Present the keys of a group.
   subroutine visit_group(self, group, v, number)
      class(drawing_record), intent(inout) :: self
      character(len=*), intent(in) :: group
      type(key_visitor), intent(inout) :: v
      !> Number among the groups of this name; without it the last
      integer, intent(in), optional :: number
      integer :: i

      i = self%count_of(group)
      if (present(number)) i = number
      select case (group)
      case ('section')
         call self%section%visit(v)
      case ('concrete')
         call self%section%concrete%visit(v)
      case ('steel')
         call self%section%steels(i)%visit(v)
      case ('bars')
         call self%section%bars%visit(v)
      case ('row')
         call self%rows(i)%visit(v)
      case ('layout')
         call self%layout%visit(v)
      case ('inner_layout')
         call self%inner_layout%visit(v)
      case ('lap')
         call self%lap%visit(v)
      case ('ties', 'spiral')
         call self%section%hoops%visit(v)
      case ('parameter')
         call self%parameters(i)%visit(v)
      case ('boundary')
         call self%section%boundaries(i)%visit(v)
      case ('curtain')
         call self%curtains(i)%visit(v)
      case default
         call self%visit(v)
      end select
   end subroutine visit_group

   !> The keys of the drawing itself.
   subroutine visit_drawing(self, v)
      class(drawing_record), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%word('name', self%name, 'name of a drawing of members of a frame; its groups follow it')
      call v%word('version', self%version, 'version of the parameters of the layered model')
      call v%key('height', self%height, 'm', above_zero, 'of a column, from an end to where the moment '// &
                 'is zero: the height, or half of it under a fixed top', optional=.true.)
      call v%key('axial_load', self%axial_load, 'N', any_number, &
                 'axial load that the springs were drawn for, compression positive', optional=.true.)
      call v%key('shear_span', self%shear_span, 'm', above_zero, &
                 'of a wall: moment over shear at its foot; without it the height', optional=.true.)
      call v%key('n', self%n, '', bound_type(2.0_wp, real(most_bodies, wp)), 'bodies of that height', &
                 optional=.true.)
      call v%key('restrained', self%restrained, '', one_or_more, &
                 'bars that hoops or ties hold; without it as the layout has them', optional=.true.)
      call v%key('round_core', self%round_core, 'the ties stand for a spiral around a round core')
   end subroutine visit_drawing

   !> The keys of a layout of bars.
   subroutine visit_layout(self, v)
      class(layout_record), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%key('number', self%number, '', one_or_more, 'number of bars')
      call v%key('diameter', self%diameter, 'm', bar_size, 'their diameter')
      call v%key('steel', self%steel, '', any_number, 'number of their steel')
      call v%key('face', self%face, '', one_or_more, &
                 'bars on the tension face of a rectangle; without it number/4 + 1', optional=.true.)
      call v%key('between_diameter', self%between_diameter, 'm', bar_size, &
                 'diameter of the bars between the corners, if it differs', optional=.true.)
      call v%key('between_steel', self%between_steel, '', any_number, &
                 'number of the steel of the bars between the corners, if it differs', optional=.true.)
   end subroutine visit_layout

   !> The keys of a row of bars.
   subroutine visit_row(self, v)
      class(row_record), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%word('face', self%face, 'face of the row; those of one face follow each other inwards', &
                  'top bottom side both start end', required=.true.)
      call v%key('number', self%number, '', one_or_more, 'number of bars; at the side those of each side')
      call v%key('diameter', self%diameter, 'm', bar_size, 'their diameter')
      call v%key('clear', self%clear, 'm', not_negative, 'clear distance to the row before it; without '// &
                 'it the diameter of the thicker bars, 25 mm at least', optional=.true.)
      call v%key('steel', self%steel, '', any_number, 'number of their steel; without it the first', &
                 optional=.true.)
   end subroutine visit_row
   !> The keys of a lap.
   subroutine visit_lap(self, v)
      class(lap_record), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%key('length', self%length, 'm', above_zero, 'length of the lap')
      call v%key('development_length', self%development_length, 'm', above_zero, 'development length '// &
                 'of the bars; without it that of ACI 318-19', optional=.true.)
   end subroutine visit_lap

   !> The keys of a mesh of a wall.
   subroutine visit_curtain(self, v)
      class(curtain_record), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%word('direction', self%direction, 'bars of the web of a wall', 'vertical horizontal')
      call v%key('diameter', self%diameter, 'm', bar_size, 'diameter of its bars')
      call v%key('spacing', self%spacing, 'm', above_zero, 'distance between them')
      call v%key('faces', self%faces, '', one_or_more, 'layers of bars over the thickness')
      call v%key('steel', self%steel, '', any_number, 'number of their steel')
   end subroutine visit_curtain

   !> The keys of a parameter of the model.
   subroutine visit_parameter(self, v)
      class(parameter_record), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%word('name', self%name, 'name of a parameter of the model that is not that of the version')
      call v%key('value', self%value, '', any_number, 'its value')
   end subroutine visit_parameter

   !> Take concrete and steels of the drawing before it where this one has none.
   subroutine take_materials(self, before)
      class(drawing_record), intent(inout) :: self
      type(drawing_record), intent(in) :: before

      if (.not. self%has_concrete) self%section%concrete = before%section%concrete
      if (size(self%section%steels) == 0) self%section%steels = before%section%steels
   end subroutine take_materials

   !> Add a message for every value that is refused.
   subroutine validate(self, of_frame, drawn, messages)
      class(drawing_record), intent(inout) :: self
      !> Whether it is of members of a frame; whether springs are still to be made of it
      logical, intent(in) :: of_frame, drawn
      type(message_list), intent(inout) :: messages
      type(message_list) :: own
      character(len=:), allocatable :: rest
      integer :: line

      call check_values(self, of_frame, drawn, own)
      if (own%count == 0) return
      if (.not. of_frame .or. self%name == '') then
         call messages%join(own)
         return
      end if
      ! Each message begins with the name of the drawing, as there may be several.
      rest = own%text
      do
         line = index(rest//new_line('a'), new_line('a'))
         call messages%add("drawing '"//trim(self%name)//"': "//rest(:line - 1))
         if (line > len(rest)) exit
         rest = rest(line + 1:)
      end do
   end subroutine validate

   !> Check the groups of a drawing of a column or of members of a frame.
   subroutine check_values(self, of_frame, drawn, messages)
      class(drawing_record), intent(inout) :: self
      !> Whether it is of members of a frame; whether springs are still to be made of it
      logical, intent(in) :: of_frame, drawn
      type(message_list), intent(inout) :: messages
      integer :: i

      if (.not. self%stated) then
         call messages%add('drawing: a section is there without the group &drawing, which says what was '// &
                           'made of it; give it, or remove the groups of the section')
      else
         call self%check('drawing', messages)
         if (self%version == '') call messages%add("drawing: version is missing; give it, as '2026.8'")
         if (of_frame) then
            if (self%name == '') call messages%add('drawing: name is missing; members of the frame name it')
         else if (drawn) then
            if (is_given(self%height) .or. is_given(self%axial_load) .or. is_given(self%n)) then
               call messages%add('drawing: height, axial_load and n are those that springs were made '// &
                                 'for, and there are none; remove them, and give them to the column')
            end if
         else
            call require('height', is_given(self%height), ' in m')
            call require('axial_load', is_given(self%axial_load), ' in N')
            call require('n', is_given(self%n), '')
         end if
      end if
      call self%section%validate(messages)
      call check_layout(self%section, 'layout', self%layout, messages)
      call check_layout(self%section, 'inner_layout', self%inner_layout, messages)
      if (allocated(self%lap)) call self%lap%check('lap', messages)
      if (allocated(self%layout) .and. allocated(self%section%bars%y)) then
         call messages%add('bars: there is a layout too; give one of them')
      end if
      do i = 1, size(self%rows)
         call self%rows(i)%check('row', messages)
         if (allocated(self%layout) .or. allocated(self%section%bars%y)) then
            call messages%add('row: there are bars or a layout too; give one of them')
         else if (is_given(self%rows(i)%steel) .and. find_steel(self%section, self%rows(i)%steel) == 0) then
            call add_no_steel(messages, 'row: steel', self%rows(i)%steel)
         else if (self%rows(i)%face == 'side' .and. count(self%rows(:i)%face == 'side') > 1) then
            call messages%add("row: face = 'side' appears twice; it may appear once")
         end if
      end do
      if (self%hoops > 1) call messages%add('ties: there is a spiral too; give one of them')
      do i = 1, size(self%curtains)
         call self%curtains(i)%check('curtain', messages)
         if (self%section%shape_name /= 'wall') then
            call messages%add("curtain: it is for shape = 'wall'; remove it")
         end if
         if (find_steel(self%section, self%curtains(i)%steel) == 0) then
            call add_no_steel(messages, 'curtain: steel', self%curtains(i)%steel)
         end if
      end do
      do i = 1, size(self%parameters)
         call self%parameters(i)%check('parameter', messages)
         if (self%parameters(i)%name == '') call messages%add('parameter: name is missing; give it')
      end do

   contains

      !> Add a message unless a value is given.
      subroutine require(name, given, unit)
         !> Key; end of the message: ' in m'
         character(len=*), intent(in) :: name, unit
         logical, intent(in) :: given

         if (.not. given) call messages%add('drawing: '//name//' is missing; give it a value'//unit)
      end subroutine require
   end subroutine check_values

   !> Check the values of a layout, if there is one, and that its steels are among those of the section.
   subroutine check_layout(section, name, layout, messages)
      type(section_record), intent(in) :: section
      !> Name of the group
      character(len=*), intent(in) :: name
      type(layout_record), allocatable, intent(inout) :: layout
      type(message_list), intent(inout) :: messages
      logical :: sound

      if (.not. allocated(layout)) return
      call layout%check(name, messages, sound)
      if (.not. sound) return
      if (find_steel(section, layout%steel) == 0) then
         call add_no_steel(messages, name//': steel', layout%steel)
      end if
      if (.not. is_given(layout%between_steel)) return
      if (find_steel(section, layout%between_steel) == 0) then
         call add_no_steel(messages, name//': between_steel', layout%between_steel)
      end if
   end subroutine check_layout

end module rbs_case_drawing_record
