!> Input of a frame: a grid of storeys and bays, single nodes and members, and kinds of members,
!> each stated once. A grid only names its nodes and members: node N-2-1 is on line 2 of columns and floor 1,
!> with floor 0 at the base; column C-2-1 is below it, beam B-2-1 is in bay 2 of that floor.
module rbs_structure_frame_frame_record
   use rbs_base_check, only: is_given
   use rbs_base_constants, only: unset
   use rbs_base_key_visitor, only: key_visitor, visited_record
   use rbs_base_keys, only: above_zero, any_number, bound_type, not_negative
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_spring_record, only: spring_record
   implicit none
   private

   public :: frame_record, frame_spring, name_length

   integer, parameter :: name_length = 32

   !> Most storeys, and most bays, of a grid.
   integer, parameter :: most_storeys = 200

   character(len=*), parameter :: support_names = 'free roller pinned fixed'

   !> The groups of a frame; all but the first may appear several times.
   character(len=12), parameter, public :: frame_groups(12) = [character(len=12) :: &
      'frame', 'plane', 'floor', 'node_load', 'member_kind', 'column_of', 'beam_of', 'infill', 'infill_of', &
      'node', 'member', 'loss']

   ! Meaning, unit and bound of each component are stated by its key, in the `visit` procedures below.

   !> The vertical plane of nodes in a building, whose floors are rigid in plan: its angle from the x axis,
   !> counterclockwise, and its distance from the origin, positive where a counterclockwise turn of the floors
   !> moves it forward.
   type, extends(visited_record), public :: plane_record
      character(len=name_length) :: name = ''
      real(wp) :: angle = 0.0_wp, arm = 0.0_wp, along = unset
   contains
      procedure :: visit => visit_plane
   end type plane_record

   !> Mass and load of a floor, or of all floors where its number is 0.
   type, extends(visited_record), public :: floor_record
      integer :: floor = 0
      real(wp) :: mass = 0.0_wp, live_load = 0.0_wp, inertia = 0.0_wp
      !> On all beams, or on those of each bay
      real(wp), allocatable :: dead_load(:)
      real(wp) :: centre_x = 0.0_wp, centre_y = 0.0_wp
      !> Of a grid in plan, on its panels and on the beams around it
      real(wp) :: floor_load = 0.0_wp, live_floor_load = 0.0_wp, edge_load = 0.0_wp
   contains
      procedure :: visit => visit_floor
      procedure :: load_on
      procedure :: is_loaded
   end type floor_record

   !> Weights on the nodes of floors, which Python makes into loads of the nodes.
   type, extends(visited_record), public :: node_load_record
      integer :: line = 0, floor = 0
      character(len=8) :: lines = 'all'
      real(wp) :: load = unset
   contains
      procedure :: visit => visit_node_load
   end type node_load_record

   !> A kind of member: an elastic beam, springs at the points of a Gauss-Lobatto rule that yield, or
   !> springs that are given one by one.
   type, extends(visited_record), public :: kind_record
      character(len=name_length) :: name = ''
      real(wp) :: modulus = unset, area = unset, inertia = unset, shear_rigidity = 0.0_wp
      real(wp) :: yield_moment = unset, hardening = 0.0_wp, length = unset
      real(wp) :: failure_drift = unset, failure_load = unset, shear_drift = unset
      character(len=12) :: interior = 'elastic', ends = 'continuous'
      logical :: after_dead_load = .false.
      !> What its springs were made of, for what Python judges: drawings of its two halves, M/V of their
      !> strength in shear, and what the layers at the foot of a wall stand for
      character(len=name_length) :: section = '', section_to = ''
      real(wp), allocatable :: shear_spans(:)
      integer :: core_layers = 0
      real(wp) :: concrete_length = unset, bar_length = unset
   contains
      procedure :: visit => visit_kind
   end type kind_record

   !> A masonry panel between columns and beams; Python makes its struts.
   type, extends(visited_record), public :: infill_record
      character(len=name_length) :: name = ''
      real(wp) :: thickness = unset, fm = unset, opening_length = 0.0_wp, opening_height = 0.0_wp
      real(wp) :: strength = unset, peak_drift = 0.005_wp
   contains
      procedure :: visit => visit_infill
   end type infill_record

   !> The kind of columns, beams or infills of a grid, 0: of all lines or bays, and of all storeys.
   type, extends(visited_record), public :: cell_record
      logical :: is_beam = .false., is_infill = .false.
      integer :: line = 0, storey = 0
      !> In a grid in plan: lines of a column along x and y, line of a beam, direction of a beam or wall
      integer :: line_x = 0, line_y = 0, of_line = 0
      character(len=4) :: along = ''
      !> Which lines or bays where no number is given: all of them, the two outer, or those between
      character(len=8) :: lines = 'all'
      !> Name of a kind; of a drawn member that of a drawing, and of its second half if it is another one
      character(len=name_length) :: kind = '', kind_to = ''
      !> In all nodes, or at the two ends where these are given
      real(wp) :: rigid_end = 0.0_wp, rigid_from = unset, rigid_to = unset
   contains
      procedure :: visit => visit_cell, fits
   end type cell_record

   !> A node, or additions to a node of the grid.
   type, extends(visited_record), public :: node_record
      character(len=name_length) :: name = ''
      real(wp) :: x = unset, y = unset
      !> Floor that it is of, 0 at the base; -1: none
      integer :: floor = -1
      character(len=8) :: support = ''
      real(wp) :: mass = 0.0_wp, inertia = 0.0_wp
      real(wp) :: load_x = 0.0_wp, load_y = 0.0_wp, load_moment = 0.0_wp
      real(wp) :: push_x = 0.0_wp, push_y = 0.0_wp
      character(len=name_length) :: moves_with = '', plane = '', rises_with = ''
   contains
      procedure :: visit => visit_node
   end type node_record

   !> A member between two nodes.
   type, extends(visited_record), public :: member_record
      character(len=name_length) :: name = '', from = '', to = '', kind = '', axial_of = ''
      real(wp) :: rigid_from = 0.0_wp, rigid_to = 0.0_wp, load = 0.0_wp
   contains
      procedure :: visit => visit_member
   end type member_record

   !> A member that is lost at a time.
   type, extends(visited_record), public :: loss_record
      character(len=name_length) :: member = ''
      real(wp) :: time = 0.0_wp
   contains
      procedure :: visit => visit_loss
   end type loss_record

   !> A spring of a kind of members, at positions in shares of the clear length, from the ground to a node, or
   !> in the panel of a node, between its columns and its beams.
   type :: frame_spring
      !> Group that gives it: 'shear', 'flexure' or 'axial_spring'
      character(len=16) :: group = ''
      character(len=name_length) :: kind = '', node = '', panel = ''
      real(wp), allocatable :: position(:)
      type(spring_record) :: spring
   end type frame_spring

   type, extends(visited_record) :: frame_record
      real(wp), allocatable :: storeys(:), bays(:)
      !> Of a grid in plan, of which Python makes a building
      real(wp), allocatable :: bays_x(:), bays_y(:)
      real(wp) :: eccentricity_x = 0.0_wp, eccentricity_y = 0.0_wp
      character(len=16) :: kinematics = 'small', base = 'fixed', pattern = 'triangular', collapse = 'storey'
      logical :: diaphragm = .false.
      !> Whether it is laid out alone: other frames of its building hold it, and it is not solved
      logical :: is_part = .false.
      !> Of the lateral load of a building [degrees]
      real(wp) :: direction = 0.0_wp
      character(len=name_length) :: control_node = ''
      character(len=8) :: control = 'x'
      !> Of drawn members: the part of a node that is rigid, and whose ties are in the panels of the nodes
      real(wp) :: ends = unset
      character(len=name_length) :: panel_hoops = ''
      !> What loads and masses Python makes of the loads of floors and of the sections
      real(wp) :: live_share = unset
      logical :: self_weight = .false.
      character(len=16) :: mass = 'of_floors'
      real(wp), allocatable :: wall_spans(:)
      type(plane_record), allocatable :: plane(:)
      type(floor_record), allocatable :: floor(:)
      type(node_load_record), allocatable :: node_load(:)
      type(kind_record), allocatable :: kind(:)
      type(cell_record), allocatable :: column_of(:), beam_of(:), infill_of(:)
      type(infill_record), allocatable :: infill(:)
      type(node_record), allocatable :: node(:)
      type(member_record), allocatable :: member(:)
      type(loss_record), allocatable :: loss(:)
      type(frame_spring), allocatable :: spring(:)
   contains
      procedure :: open_group, visit => visit_frame, visit_group, count_of, total_height
   end type frame_record

contains

   !> Make room for the values of a group; `frame` itself is there once.
   subroutine open_group(self, group)
      class(frame_record), intent(inout) :: self
      !> Name of the group, one of `frame_groups`
      character(len=*), intent(in) :: group
      type(cell_record) :: beam, infilled

      ! The first group: no other is there yet.
      if (.not. allocated(self%floor)) then
         allocate (self%plane(0), self%floor(0), self%node_load(0), self%kind(0), self%column_of(0), &
                   self%beam_of(0), self%infill(0), self%infill_of(0), self%node(0), self%member(0), &
                   self%loss(0), self%spring(0))
      end if
      select case (group)
      case ('plane')
         self%plane = [self%plane, plane_record()]
      case ('floor')
         self%floor = [self%floor, floor_record()]
      case ('node_load')
         self%node_load = [self%node_load, node_load_record()]
      case ('member_kind')
         self%kind = [self%kind, kind_record()]
      case ('column_of')
         self%column_of = [self%column_of, cell_record()]
      case ('beam_of')
         beam%is_beam = .true.
         self%beam_of = [self%beam_of, beam]
      case ('infill')
         self%infill = [self%infill, infill_record()]
      case ('infill_of')
         infilled%is_infill = .true.
         self%infill_of = [self%infill_of, infilled]
      case ('node')
         self%node = [self%node, node_record()]
      case ('member')
         self%member = [self%member, member_record()]
      case ('loss')
         self%loss = [self%loss, loss_record()]
      case default                                  ! the frame itself
      end select
   end subroutine open_group

   !> How many groups of a name were given.
   pure integer function count_of(self, group) result(number)
      class(frame_record), intent(in) :: self
      !> Name of the group, one of `frame_groups`
      character(len=*), intent(in) :: group

      select case (group)
      case ('plane')
         number = size(self%plane)
      case ('floor')
         number = size(self%floor)
      case ('node_load')
         number = size(self%node_load)
      case ('member_kind')
         number = size(self%kind)
      case ('column_of')
         number = size(self%column_of)
      case ('beam_of')
         number = size(self%beam_of)
      case ('infill')
         number = size(self%infill)
      case ('infill_of')
         number = size(self%infill_of)
      case ('node')
         number = size(self%node)
      case ('member')
         number = size(self%member)
      case ('loss')
         number = size(self%loss)
      case default
         number = 1
      end select
   end function count_of

   !> Present the keys of a group to a visitor, which reads, writes or lists them.
   subroutine visit_group(self, group, v, number)
      class(frame_record), intent(inout) :: self
      !> Name of the group, one of `frame_groups`
      character(len=*), intent(in) :: group
      type(key_visitor), intent(inout) :: v
      !> Which of several; without it the last
      integer, intent(in), optional :: number
      integer :: i

      i = self%count_of(group)
      if (present(number)) i = number
      select case (group)
      case ('plane')
         call self%plane(i)%visit(v)
      case ('floor')
         call self%floor(i)%visit(v)
      case ('node_load')
         call self%node_load(i)%visit(v)
      case ('member_kind')
         call self%kind(i)%visit(v)
      case ('column_of')
         call self%column_of(i)%visit(v)
      case ('beam_of')
         call self%beam_of(i)%visit(v)
      case ('infill')
         call self%infill(i)%visit(v)
      case ('infill_of')
         call self%infill_of(i)%visit(v)
      case ('node')
         call self%node(i)%visit(v)
      case ('member')
         call self%member(i)%visit(v)
      case ('loss')
         call self%loss(i)%visit(v)
      case default
         call self%visit(v)
      end select
   end subroutine visit_group

   !> The keys of a frame.
   subroutine visit_frame(self, v)
      class(frame_record), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%key('storeys', self%storeys, 'm', above_zero, 'heights of the storeys from the ground up', &
                 most_storeys)
      call v%key('bays', self%bays, 'm', above_zero, 'widths of the bays from the left; without them one '// &
                 'line of columns', most_storeys)
      call v%key('bays_x', self%bays_x, 'm', above_zero, 'widths of the bays along x of a building in '// &
                 'plan, in place of bays', most_storeys)
      call v%key('bays_y', self%bays_y, 'm', above_zero, 'the same along y', most_storeys)
      call v%key('eccentricity_x', self%eccentricity_x, '', any_number, 'of a grid in plan: how far the '// &
                 'centres of mass are moved along x, in parts of its length')
      call v%key('eccentricity_y', self%eccentricity_y, '', any_number, 'the same along y')
      call v%word('kinematics', self%kinematics, &
                  'small rotations, or the same with second-order work of the dead load', 'small pdelta')
      call v%word('base', self%base, 'how the columns of the grid stand', 'fixed pinned free')
      call v%key('diaphragm', self%diaphragm, 'whether all nodes of a floor of the grid move alike along x')
      call v%word('pattern', self%pattern, 'shares of the lateral load: as mass, mass times height, '// &
                  'first mode, or push_x and push_y of the nodes', 'uniform triangular modal nodes')
      call v%key('direction', self%direction, '', any_number, 'of a building: direction of the lateral '// &
                 'load in plan, in degrees from x towards y')
      call v%word('control_node', self%control_node, 'node whose displacement is that of the top; '// &
                  'without it the first of the highest')
      call v%word('control', self%control, 'direction of that displacement', 'x y')
      call v%word('collapse', self%collapse, 'whose drift collapse is judged by: the largest of the '// &
                  'storeys, or that of the top', 'storey roof')
      call v%key('ends', self%ends, '', bound_type(0.0_wp, 1.0_wp), 'of drawn members: part of a node '// &
                 'that is rigid in columns and beams; without it the rule of ASCE 41-17', optional=.true.)
      call v%key('wall_spans', self%wall_spans, 'm', not_negative, 'of drawn walls: M/V at the foot, of '// &
                 'all lines or of each; without it, or 0, where beams and wall yield', most_storeys)
      call v%word('panel_hoops', self%panel_hoops, 'of drawn members: drawing whose ties are in the '// &
                  'panels of the nodes, or ''none''; without it the nodes are rigid')
      call v%key('live_share', self%live_share, '', bound_type(0.0_wp, 1.0_wp), 'part of the live load '// &
                 'that acts, 0.3 without it', optional=.true.)
      call v%key('self_weight', self%self_weight, 'whether drawn members have their own weight, 25 kN/m3')
      call v%word('mass', self%mass, 'masses of the floors: as given with them, or those of the loads', &
                  'of_floors from_loads')
   end subroutine visit_frame

   !> The keys of a plane.
   subroutine visit_plane(self, v)
      class(plane_record), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%word('name', self%name, 'name of the plane', required=.true.)
      call v%key('angle', self%angle, '', any_number, 'direction of its x axis in plan, in degrees from '// &
               'x towards y')
      call v%key('arm', self%arm, 'm', any_number, 'distance of its x axis from the origin in plan, '// &
               'positive '// &
                 'where a counterclockwise turn moves it forward: -y of a plane along x, x of one along y')
      call v%key('along', self%along, 'm', any_number, 'where its x begins on this axis: Python finds '// &
                 'by it which columns are one', optional=.true.)
   end subroutine visit_plane

   !> The keys of a floor.
   subroutine visit_floor(self, v)
      class(floor_record), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%key('floor', self%floor, '', not_negative, 'floor that is meant, 0 for all')
      call v%key('mass', self%mass, 'kg', not_negative, 'mass of the floor, shared by its nodes as the '// &
                 'widths beside them; its weight acts as far as it is given as a load')
      call v%key('inertia', self%inertia, 'kg m2', not_negative, 'of a building: rotary inertia about '// &
                 'the centre of mass, besides the mass, which is at it')
      call v%key('centre_x', self%centre_x, 'm', any_number, 'of a building: place of the centre of mass '// &
               'in plan')
      call v%key('centre_y', self%centre_y, 'm', any_number, 'the same along y')
      call v%key('dead_load', self%dead_load, 'N/m', any_number, 'dead load on the beams of the floor, '// &
                 'all or of each bay, downward', most_storeys)
      call v%key('live_load', self%live_load, 'N/m', any_number, 'live load on them, of which '// &
                 'live_share acts')
      call v%key('floor_load', self%floor_load, 'Pa', not_negative, 'of a grid in plan: dead load on the '// &
                 'panels between beams, N/m2')
      call v%key('live_floor_load', self%live_floor_load, 'Pa', not_negative, 'of a grid in plan: live '// &
                 'load on them, of which live_share acts')
      call v%key('edge_load', self%edge_load, 'N/m', not_negative, 'of a grid in plan: weight of facades '// &
                 'on the beams with a panel on one side')
   end subroutine visit_floor

   !> The keys of a load on nodes.
   subroutine visit_node_load(self, v)
      class(node_load_record), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%key('line', self%line, '', not_negative, 'line of columns from the left, 0 for all')
      call v%word('lines', self%lines, 'which lines in place of a number', 'all outer inner')
      call v%key('floor', self%floor, '', not_negative, 'floor from the ground up, 0 for all')
      call v%key('load', self%load, 'N', any_number, 'weight of walls and facades on each of the nodes; '// &
                 'the last group that fits counts')
   end subroutine visit_node_load

   !> The keys of a kind of member.
   subroutine visit_kind(self, v)
      class(kind_record), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%word('name', self%name, 'name of the kind', required=.true.)
      call v%key('modulus', self%modulus, 'Pa', above_zero, 'Young''s modulus')
      call v%key('area', self%area, 'm2', above_zero, 'area of the section')
      call v%key('inertia', self%inertia, 'm4', above_zero, 'second moment of area; of the cracked '// &
                 'section, if that is meant')
      call v%key('shear_rigidity', self%shear_rigidity, 'N', not_negative, &
                 'shear modulus times shear area; 0: no deformation by shear')
      call v%key('yield_moment', self%yield_moment, 'N m', above_zero, 'moment at which sections yield; '// &
                 'without it and without springs the member stays elastic', optional=.true.)
      call v%key('hardening', self%hardening, '', bound_type(-1.0_wp, 1.0_wp, .true., .true.), &
                 'stiffness after yielding over the one before')
      call v%key('length', self%length, 'm', above_zero, 'clear length that its springs were made for; '// &
                 'members of another one are refused', optional=.true.)
      call v%key('failure_drift', self%failure_drift, '', above_zero, 'drift at which the member loses '// &
                 'its axial load, if that is small, once a shear spring of it has yielded; without it: '// &
                 'never', optional=.true.)
      call v%key('failure_load', self%failure_load, 'N', above_zero, 'axial load under which that drift '// &
                 'is half of it', optional=.true.)
      call v%key('shear_drift', self%shear_drift, '', above_zero, 'drift at which it counts as failed in '// &
                 'shear, if no shear spring of it has yielded', optional=.true.)
      call v%word('interior', self%interior, 'what is between springs that are given one by one; a '// &
                  '''rigid'' member without springs does not deform, and modulus, area '// &
                  'and inertia do nothing', 'elastic rigid')
      call v%word('ends', self%ends, 'how it joins its nodes; ''pinned'' ends turn freely, and it '// &
                  'carries axial force alone', 'continuous pinned')
      call v%key('after_dead_load', self%after_dead_load, 'whether it is built when the dead load acts '// &
                 'already, and carries none of it')
      call v%word('section', self%section, 'drawing that its springs were made of, for limit states and '// &
                  'acceptance; the springs that are given count')
      call v%word('section_to', self%section_to, 'drawing of its second half, if it is another one')
      call v%key('shear_spans', self%shear_spans, 'm', above_zero, 'M/V of the strength of its shear '// &
                 'springs: at its start with y > 0 in tension and in compression, and at its end', 4)
      call v%key('core_layers', self%core_layers, '', not_negative, 'at the foot of a wall: layers of '// &
                 'confined concrete, the first; layers of bars are the last')
      call v%key('concrete_length', self%concrete_length, 'm', above_zero, 'length over which these '// &
                 'layers of concrete deform', optional=.true.)
      call v%key('bar_length', self%bar_length, 'm', above_zero, 'length over which those of bars do', &
                 optional=.true.)
   end subroutine visit_kind

   !> The keys of an infill.
   subroutine visit_infill(self, v)
      class(infill_record), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%word('name', self%name, 'name of the infill', required=.true.)
      call v%key('thickness', self%thickness, 'm', above_zero, 'thickness of the masonry, of all wythes')
      call v%key('fm', self%fm, 'Pa', above_zero, 'compressive strength of the masonry across its bed '// &
                 'joints; without it strength is needed', optional=.true.)
      call v%key('opening_length', self%opening_length, 'm', not_negative, 'length of an opening, of '// &
                 'several the sum')
      call v%key('opening_height', self%opening_height, 'm', not_negative, 'height of the opening')
      call v%key('strength', self%strength, 'N', above_zero, 'largest horizontal force, in place of that '// &
                 'of the law', optional=.true.)
      call v%key('peak_drift', self%peak_drift, '', bound_type(0.0_wp, 0.03_wp, .true., .true.), &
                 'drift of the panel at which it has this force')
   end subroutine visit_infill

   !> The keys of a group that gives places of a grid their kind; an infill has neither halves nor rigid ends.
   subroutine visit_cell(self, v)
      class(cell_record), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      if (self%is_beam .or. self%is_infill) then
         call v%key('bay', self%line, '', not_negative, 'bay from the left, 0 for all')
         call v%word('bays', self%lines, 'which bays in place of a number', 'all outer inner')
      else
         call v%key('line', self%line, '', not_negative, 'line of columns from the left, 0 for all')
         call v%word('lines', self%lines, 'which lines in place of a number', 'all outer inner')
      end if
      if (self%is_beam .or. self%is_infill) then
         call v%key('of_line', self%of_line, '', not_negative, 'of a grid in plan: line that it is in, 0 '// &
                    'for all')
      else
         call v%key('line_x', self%line_x, '', not_negative, 'of a grid in plan: place along x, 0 for all')
         call v%key('line_y', self%line_y, '', not_negative, 'the same along y')
      end if
      call v%word('along', self%along, 'of a grid in plan: direction of a beam, an infill or a wall', 'x y')
      call v%key('storey', self%storey, '', not_negative, 'storey from the ground up, 0 for all')
      if (self%is_infill) then
         call v%word('kind', self%kind, 'name of the infill, ''none'' where there is none; the last '// &
                     'group that fits counts', required=.true.)
         return
      end if
      call v%word('kind', self%kind, 'name of the kind of member or of its drawing, ''none'' where there '// &
                  'is none; the last group that fits counts', required=.true.)
      call v%word('kind_to', self%kind_to, 'drawing of its second half, if it is another one')
      call v%key('rigid_end', self%rigid_end, 'm', not_negative, &
                 'rigid length in each node that it ends in, not at the base')
      call v%key('rigid_from', self%rigid_from, 'm', not_negative, 'rigid length at its beginning, '// &
                 'if it is another one', optional=.true.)
      call v%key('rigid_to', self%rigid_to, 'm', not_negative, 'rigid length at its end, if it is '// &
                 'another one', optional=.true.)
   end subroutine visit_cell

   !> The keys of a node.
   subroutine visit_node(self, v)
      class(node_record), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%word('name', self%name, 'name of the node; one of the grid gets the rest in addition', &
                  required=.true.)
      call v%key('x', self%x, 'm', any_number, 'position to the right', optional=.true.)
      call v%key('y', self%y, 'm', any_number, 'height above the ground', optional=.true.)
      call v%key('floor', self%floor, '', any_number, 'floor of a node outside of the grid, from 0 at '// &
                 'the base; -1: none')
      call v%word('support', self%support, 'what holds it: a roller only along y, a pin along x and y', &
                  support_names)
      call v%key('mass', self%mass, 'kg', not_negative, 'mass of the node')
      call v%key('inertia', self%inertia, 'kg m2', not_negative, 'rotary inertia')
      call v%key('load_x', self%load_x, 'N', any_number, 'dead load to the right')
      call v%key('load_y', self%load_y, 'N', any_number, 'dead load upward; a weight is negative')
      call v%key('load_moment', self%load_moment, 'N m', any_number, 'dead moment, clockwise')
      call v%key('push_x', self%push_x, '', any_number, 'share of the lateral load to the right')
      call v%key('push_y', self%push_y, '', any_number, 'share of the lateral load upward')
      call v%word('moves_with', self%moves_with, 'node whose displacement along x it shares')
      call v%word('plane', self%plane, 'of a building: plane that it is in; with its floor it moves as '// &
               'that does')
      call v%word('rises_with', self%rises_with, 'of a building: node of another plane whose '// &
                  'displacement upward it shares')
   end subroutine visit_node

   !> The keys of a member.
   subroutine visit_member(self, v)
      class(member_record), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%word('name', self%name, 'name of the member', required=.true.)
      call v%word('from', self%from, 'name of the node that it begins at', required=.true.)
      call v%word('to', self%to, 'name of the node that it ends at', required=.true.)
      call v%word('kind', self%kind, 'name of its kind', required=.true.)
      call v%key('rigid_from', self%rigid_from, 'm', not_negative, 'rigid length at its beginning')
      call v%key('rigid_to', self%rigid_to, 'm', not_negative, 'rigid length at its end')
      call v%key('load', self%load, 'N/m', any_number, 'dead load downward, per length along x')
      call v%word('axial_of', self%axial_of, 'of a building: column of another plane that is the same '// &
                  'column, and whose axial force is its own')
   end subroutine visit_member

   !> The keys of a loss.
   subroutine visit_loss(self, v)
      class(loss_record), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%word('member', self%member, 'name of the member that is lost', required=.true.)
      call v%key('time', self%time, 's', any_number, 'time of the record from which on it carries nothing')
   end subroutine visit_loss

   !> Dead load on the beam of a bay [N/m]: one value for all bays, or one for each.
   pure real(wp) function load_on(self, bay)
      class(floor_record), intent(in) :: self
      !> Number of the bay, from the left
      integer, intent(in) :: bay

      load_on = 0.0_wp
      if (self%is_loaded()) load_on = self%dead_load(min(bay, size(self%dead_load)))
   end function load_on

   !> Whether its beams have a dead load.
   elemental logical function is_loaded(self)
      class(floor_record), intent(in) :: self

      is_loaded = allocated(self%dead_load)
      if (is_loaded) is_loaded = any(abs(self%dead_load) > 0.0_wp)
   end function is_loaded

   !> Whether a group is meant for a member of the grid, by line (or bay) and storey; 0 means all.
   pure logical function fits(self, line, storey, last)
      class(cell_record), intent(in) :: self
      !> Line or bay, and storey, of the member
      integer, intent(in) :: line, storey
      !> Number of lines or bays
      integer, intent(in) :: last

      fits = any(self%line == [0, line]) .and. any(self%storey == [0, storey])
      if (self%lines /= 'all') fits = fits .and. ((line == 1 .or. line == last) .eqv. self%lines == 'outer')
   end function fits

   !> Height of the grid or of the nodes [m]; values that are not given count as zero.
   pure real(wp) function total_height(self) result(height)
      class(frame_record), intent(in) :: self
      real(wp) :: lowest
      integer :: i

      height = 0.0_wp
      lowest = 0.0_wp
      if (allocated(self%storeys)) height = sum(self%storeys)
      do i = 1, size(self%node)
         if (.not. is_given(self%node(i)%y)) cycle
         height = max(height, self%node(i)%y)
         lowest = min(lowest, self%node(i)%y)
      end do
      height = height - lowest
   end function total_height

end module rbs_structure_frame_frame_record
