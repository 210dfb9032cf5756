!> Nodes and members of a frame from the input: the grid is laid out, names are found, and everything
!> that is wrong gets a message with its remedy.
module rbs_structure_frame_frame_parts
   use rbs_base_check, only: is_given
   use rbs_base_error, only: message_list
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_base_tolerances, only: same_input
   use rbs_structure_frame_connections, only: find_leaders, check_floors, end_nodes, hold_idle, &
                                              hold_between_pins, check_geometry, check_held
   use rbs_structure_frame_frame_checks, only: check_values, check_reference, is_rigid, is_strut, group_of
   use rbs_structure_frame_frame_kinds, only: put_kind, can_be_lost, stiffness_of
   use rbs_structure_frame_frame_record, only: frame_record, frame_spring, cell_record, kind_record
   use rbs_structure_frame_new_frame, only: frame_node, frame_member
   use rbs_structure_frame_plan, only: floor_plan
   use rbs_structure_frame_plan_parts, only: put_planes, put_second_planes
   implicit none
   private

   public :: frame_parts

   !> Largest difference of the length of a member from the length that its kind was made for, as a share.
   real(wp), parameter :: one_length = 0.01_wp

   !> The kind of a member of the grid that is not there.
   integer, parameter :: left_out = -1

   type :: frame_parts
      type(frame_node), allocatable :: node(:)
      type(frame_member), allocatable :: member(:)
      !> Number of members so far; nodes and members of the grid, which come first
      integer :: members = 0, grid_nodes = 0, grid_members = 0
      !> The node whose displacement is that of the top; 0: of a building the highest floor
      integer :: top = 0
      !> Planes and rigid floors of a building
      type(floor_plan) :: plan
   contains
      procedure :: find
   end type frame_parts

contains

   !> Lay out the frame of a record; messages on all that is wrong are given together.
   subroutine find(self, record, messages)
      class(frame_parts), intent(out) :: self
      class(frame_record), intent(inout) :: record
      type(message_list), intent(inout) :: messages
      !> Number of messages before
      integer :: known

      known = messages%count
      call check_values(record, messages)
      ! Of a grid in plan Python makes planes, which are checked when they are solved.
      if (allocated(record%bays_x)) return
      if (messages%count > known) return
      call lay_grid(self, record, messages)
      call put_nodes(self, record, messages)
      call put_planes(self%node, self%plan, self%grid_nodes > 0, record, messages)
      call put_members(self, record, messages)
      if (size(self%node) == 0) then
         call messages%add('frame: it has no storeys and no nodes; give storeys (and bays), or groups '// &
                           '&node and &member')
      end if
      if (messages%count > known) return
      call put_node_springs(self, record, messages)
      call put_losses(self, record, messages)
      call put_kinds(self, record, messages)
      call put_second_planes(self%node, self%member, record, messages)
      call hold_idle(self%node, self%member, self%grid_nodes)
      call hold_between_pins(self%node, self%member)
      call check_geometry(self%node, self%member, self%grid_nodes, self%grid_members, messages)
      if (.not. record%is_part) call check_held(self%node, self%member, messages)
      if (messages%count > known) return
      call choose_top(self, record, messages)
      if (.not. record%is_part) call push(self, record, messages)
   end subroutine find

   !> Lay out nodes, columns and beams of the grid, with the masses of its floors.
   subroutine lay_grid(self, record, messages)
      type(frame_parts), intent(inout) :: self
      type(frame_record), intent(in) :: record
      type(message_list), intent(inout) :: messages
      integer :: bays, i, j, known, l, lines, s, storeys
      !> Whether a member ends in the node of a line, on the present floor
      logical, allocatable :: is_joined(:)

      known = messages%count
      storeys = 0
      bays = 0
      if (allocated(record%storeys)) storeys = size(record%storeys)
      if (allocated(record%bays)) bays = size(record%bays)
      call check_cells(record, storeys, bays, messages)
      lines = bays + 1
      self%grid_nodes = merge(lines*(storeys + 1), 0, storeys > 0)
      allocate (self%node(self%grid_nodes + size(record%node)), &
                self%member(storeys*(lines + bays) + size(record%member)))
      if (storeys == 0) then
         if (bays > 0) call messages%add('frame: bays need storeys; give their heights')
         return
      end if
      allocate (is_joined(lines))
      do s = 1, storeys
         do l = 1, lines
            call add_cell(self, record, 'C', l, s, lines, [(s - 1)*lines + l, s*lines + l])
         end do
      end do
      do s = 1, storeys
         do l = 1, bays
            call add_cell(self, record, 'B', l, s, bays, [s*lines + l, s*lines + l + 1])
         end do
      end do
      ! Nodes are numbered floor by floor from the left.
      i = 0
      do s = 0, storeys
         do l = 1, lines
            i = i + 1
            associate (node => self%node(i))
               node%name = 'N-'//to_text(l)//'-'//to_text(s)
               if (l > 1) node%x = sum(record%bays(:l - 1))
               node%y = sum(record%storeys(:s))
               is_joined(l) = any(record%member%from == node%name .or. record%member%to == node%name)
               do j = 1, self%members
                  is_joined(l) = is_joined(l) .or. any(self%member(j)%node == i)
               end do
               ! Where a frame steps back nothing is there.
               node%storey = merge(s, -1, s == 0 .or. is_joined(l))
               if (s == 0) call hold(node, record%base)
            end associate
         end do
         if (s == 0) cycle
         ! With a diaphragm the first node of a floor that has members leads the others.
         associate (first => i - lines + findloc(is_joined, .true., dim=1))
            call put_mass(self%node(i - lines + 1:i), record, s, is_joined)
            if (record%diaphragm .and. any(is_joined)) then
               where (is_joined) self%node(i - lines + 1:i)%like = first
               self%node(first)%like = 0
            end if
         end associate
      end do
      self%grid_members = self%members
      ! A wrong group has its message already, and names no cell.
      if (messages%count > known) return
      call check_named(self%member(:self%members), 'C', '&column_of, with line = 0', messages)
      call check_named(self%member(:self%members), 'B', '&beam_of, with bay = 0', messages)
   end subroutine lay_grid

   !> One message on all columns, or beams, of the grid that no group names.
   subroutine check_named(member, letter, group, messages)
      type(frame_member), intent(in) :: member(:)
      !> 'C' or 'B'
      character(len=1), intent(in) :: letter
      !> Group that would name kinds, for the message
      character(len=*), intent(in) :: group
      type(message_list), intent(inout) :: messages
      character(len=:), allocatable :: others
      integer :: first, missing

      associate (unnamed => member%kind_of == 0 .and. member%name(1:1) == letter)
         missing = count(unnamed)
         first = findloc(unnamed, .true., dim=1)
      end associate
      if (missing == 0) return
      others = ''
      if (missing > 1) others = ' and '//to_text(missing - 1)//' more'
      call messages%add(trim(merge('column', 'beam  ', letter == 'C'))//' '//trim(member(first)%name)// &
                        others//': no kind is given; give '//group//' and storey = 0 for all')
   end subroutine check_named

   !> Refuse groups that name what the grid does not have, and loads that it cannot take.
   subroutine check_cells(record, storeys, bays, messages)
      type(frame_record), intent(in) :: record
      !> Numbers of storeys and bays of the grid
      integer, intent(in) :: storeys, bays
      type(message_list), intent(inout) :: messages
      integer :: i

      ! Floors of a building, which has planes, are checked by `lay_floors`.
      do i = 1, merge(0, size(record%floor), size(record%plane) > 0)
         if (record%floor(i)%floor > storeys) then
            call refuse('floor: floor', record%floor(i)%floor, 'floors', storeys)
         end if
         if (max(record%floor(i)%floor_load, record%floor(i)%live_floor_load, &
                 record%floor(i)%edge_load) > 0.0_wp) then
            call messages%add('floor: floor_load, live_floor_load and edge_load are of a grid in plan; '// &
                              'give bays_x and bays_y, or dead_load')
         end if
         if (.not. record%floor(i)%is_loaded()) cycle
         if (bays == 0) then
            call messages%add('floor: dead_load acts on beams, and there are none; give it to the nodes '// &
                              'as load_y')
         else if (all(size(record%floor(i)%dead_load) /= [1, bays])) then
            call messages%add('floor: dead_load has '//to_text(size(record%floor(i)%dead_load))// &
                              ' values for '//to_text(bays)//' bays; give one, or one for each')
         end if
      end do
      do i = 1, size(record%column_of)
         call check_cell(record%column_of(i), 'column_of', 'line', 'lines of columns', bays + 1)
      end do
      do i = 1, size(record%beam_of)
         call check_cell(record%beam_of(i), 'beam_of', 'bay', 'bays', bays)
      end do
      do i = 1, size(record%infill_of)
         call check_cell(record%infill_of(i), 'infill_of', 'bay', 'bays', bays)
      end do

   contains

      !> Check a group that gives the members of some places a kind.
      subroutine check_cell(cell, group, key, what, most)
         type(cell_record), intent(in) :: cell
         !> Group and key of the line or bay, and what these are in plural
         character(len=*), intent(in) :: group, key, what
         !> Largest number of a line or bay
         integer, intent(in) :: most

         call check_storey(group, cell%storey)
         if (any([cell%line_x, cell%line_y, cell%of_line] > 0) .or. cell%along /= '') then
            call messages%add(group//': line_x, line_y, of_line and along are of a grid in plan; give '// &
                              'bays_x and bays_y, or remove them')
         end if
         if (cell%line > 0 .and. cell%lines /= 'all') then
            call messages%add(group//': '//key//' and '//key//"s = '"//trim(cell%lines)// &
                              "' are given; remove one")
         end if
         if (cell%kind == 'none') then
            ! 'none' leaves the members out.
            continue
         else if (cell%is_infill) then
            call check_reference(cell%kind, [record%infill%name], group, 'infill', messages)
         else
            call check_reference(cell%kind, [record%kind%name], group, 'kind', messages)
         end if
         if (cell%line > most) call refuse(group//': '//key, cell%line, what, most)
      end subroutine check_cell

      !> Refuse a storey that the grid does not have.
      subroutine check_storey(group, storey)
         !> Name of the group, for the message; number that it names
         character(len=*), intent(in) :: group
         integer, intent(in) :: storey

         if (storey > storeys) call refuse(group//': storey', storey, 'storeys', storeys)
      end subroutine check_storey

      !> Refuse a number above the largest one.
      subroutine refuse(key, value, what, most)
         !> Key, and what is numbered, in plural; value, and the largest one
         character(len=*), intent(in) :: key, what
         integer, intent(in) :: value, most

         call messages%add(key//' = '//to_text(value)//', but the frame has '//to_text(most)//' '//what// &
                           '; correct it, or give 0 for all')
      end subroutine refuse
   end subroutine check_cells

   !> Share the mass of a floor among its nodes, by the widths of the bays beside them.
   subroutine put_mass(node, record, storey, is_joined)
      !> All nodes of the floor
      type(frame_node), intent(inout) :: node(:)
      type(frame_record), intent(in) :: record
      !> Number of the floor
      integer, intent(in) :: storey
      !> Whether a member ends in a node (nodes of the floor)
      logical, intent(in) :: is_joined(:)
      real(wp) :: mass, part(size(node)), width(size(node) - 1)
      integer :: i

      mass = 0.0_wp
      ! The last group that fits counts.
      do i = 1, size(record%floor)
         if (any(record%floor(i)%floor == [0, storey])) mass = record%floor(i)%mass
      end do
      ! Half of each bay goes to the node on either side; bays without both nodes count for nothing, and a
      ! floor without bays is shared alike.
      width = 0.0_wp
      if (size(width) > 0) width = merge(record%bays, 0.0_wp, is_joined(:size(width)) .and. is_joined(2:))
      if (sum(width) > 0.0_wp) then
         part = ([0.0_wp, width] + [width, 0.0_wp])/(2.0_wp*sum(width))
      else
         part = merge(1.0_wp, 0.0_wp, is_joined)/max(count(is_joined), 1)
      end if
      node%mass(1) = mass*part
      node%mass(2) = mass*part
   end subroutine put_mass

   !> Add a column or a beam of the grid, if its group does not leave it out.
   subroutine add_cell(self, record, letter, line, storey, last, node)
      type(frame_parts), intent(inout) :: self
      type(frame_record), intent(in) :: record
      !> 'C' or 'B'
      character(len=1), intent(in) :: letter
      !> Line or bay, storey, number of lines or bays, nodes of its ends
      integer, intent(in) :: line, storey, last, node(2)
      type(frame_member) :: member
      integer :: i

      member%name = letter//'-'//to_text(line)//'-'//to_text(storey)
      member%node = node
      if (letter == 'C') then
         call choose(record%column_of)
      else
         call choose(record%beam_of)
         do i = 1, size(record%floor)
            if (any(record%floor(i)%floor == [0, storey])) member%load = record%floor(i)%load_on(line)
         end do
      end if
      if (member%kind_of == left_out) return
      self%members = self%members + 1
      self%member(self%members) = member

   contains

      !> Take kind and rigid ends of the last group that fits.
      subroutine choose(cell)
         !> Groups for columns, or for beams
         type(cell_record), intent(in) :: cell(:)
         integer :: j

         do j = 1, size(cell)
            if (.not. cell(j)%fits(line, storey, last)) cycle
            member%kind_of = findloc(record%kind%name == cell(j)%kind, .true., dim=1)
            if (cell(j)%kind == 'none') member%kind_of = left_out
            member%rigid = cell(j)%rigid_end
            ! A column has no rigid end at the base.
            if (letter == 'C' .and. storey == 1) member%rigid(1) = 0.0_wp
            if (is_given(cell(j)%rigid_from)) member%rigid(1) = cell(j)%rigid_from
            if (is_given(cell(j)%rigid_to)) member%rigid(2) = cell(j)%rigid_to
         end do
      end subroutine choose
   end subroutine add_cell

   !> Hold the displacements (x, y, rotation) of a node that its support holds.
   subroutine hold(node, support)
      type(frame_node), intent(inout) :: node
      !> 'free', 'roller', 'pinned' or 'fixed'
      character(len=*), intent(in) :: support

      node%held(1) = support == 'fixed' .or. support == 'pinned'
      node%held(2) = node%held(1) .or. support == 'roller'
      node%held(3) = support == 'fixed'
   end subroutine hold

   !> Put in the nodes that are given by name: new ones, and additions to those of the grid.
   subroutine put_nodes(self, record, messages)
      type(frame_parts), intent(inout) :: self
      type(frame_record), intent(in) :: record
      type(message_list), intent(inout) :: messages
      integer :: i, n, nodes, number

      nodes = self%grid_nodes
      do i = 1, size(record%node)
         associate (given => record%node(i))
            number = findloc(self%node%name == given%name, .true., dim=1)
            if (number > self%grid_nodes) then
               call messages%add("node '"//trim(given%name)//"' is given twice; remove one")
               cycle
            else if (number == 0) then
               if (.not. (is_given(given%x) .and. is_given(given%y))) then
                  if (self%grid_nodes > 0) then
                     call messages%add("node '"//trim(given%name)//"' is none of the grid, "//'whose '// &
                                       'nodes are called N-line-floor, and has no place; give x and y, '// &
                                       'or one of those names')
                  else
                     call messages%add("node '"//trim(given%name)//"' has no place; give x and y")
                  end if
                  cycle
               end if
               nodes = nodes + 1
               number = nodes
               self%node(number)%name = given%name
               self%node(number)%x = given%x
               self%node(number)%y = given%y
               self%node(number)%storey = given%floor
               if (given%floor < -1) then
                  call messages%add("node '"//trim(given%name)//"': floor = "//to_text(given%floor)// &
                                    ' must be 0 at the base or more; leave it out for a node of none')
               end if
            else if (given%floor >= 0) then
               call messages%add("node '"//trim(given%name)//"' belongs to the grid, which has its "// &
                                 'floor; remove floor')
            else if (is_given(given%x) .or. is_given(given%y)) then
               call messages%add("node '"//trim(given%name)//"' belongs to the grid, which places it; "// &
                                 'remove x and y')
            end if
            associate (node => self%node(number))
               if (given%support /= '') call hold(node, given%support)
               node%mass = node%mass + [given%mass, given%mass, given%inertia]
               node%load = node%load + [given%load_x, given%load_y, given%load_moment]
               node%push = [given%push_x, given%push_y]
            end associate
         end associate
      end do
      self%node = self%node(:nodes)
      do i = 1, size(record%node)
         associate (given => record%node(i))
            if (given%moves_with == '') cycle
            call check_reference(given%moves_with, [self%node%name], "node '"//trim(given%name)// &
                                 "': moves_with", 'node', messages)
            number = findloc(self%node%name == given%name, .true., dim=1)
            n = findloc(self%node%name == given%moves_with, .true., dim=1)
            if (number == 0 .or. n == 0) cycle
            if (n == number) then
               call messages%add("node '"//trim(given%name)//"' moves with itself; name another one")
               cycle
            end if
            self%node(number)%like = n
         end associate
      end do
      call find_leaders(self%node, messages)
      if (.not. record%is_part) call check_floors(self%node, messages)
   end subroutine put_nodes

   !> Put in the members that are given one by one.
   subroutine put_members(self, record, messages)
      type(frame_parts), intent(inout) :: self
      type(frame_record), intent(in) :: record
      type(message_list), intent(inout) :: messages
      character(len=:), allocatable :: name
      integer :: i

      do i = 1, size(record%member)
         associate (given => record%member(i))
            name = "member '"//trim(given%name)//"'"
            if (any(self%member(:self%members)%name == given%name)) then
               call messages%add(name//' is given twice; give each a name of its own')
            end if
            call check_reference(given%from, [self%node%name], name//': from', 'node', messages)
            call check_reference(given%to, [self%node%name], name//': to', 'node', messages)
            call check_reference(given%kind, [record%kind%name], name, 'kind', messages)
            self%members = self%members + 1
            associate (member => self%member(self%members))
               member%name = given%name
               member%node = [findloc(self%node%name == given%from, .true., dim=1), &
                              findloc(self%node%name == given%to, .true., dim=1)]
               member%kind_of = findloc(record%kind%name == given%kind, .true., dim=1)
               member%rigid = [given%rigid_from, given%rigid_to]
               member%load = given%load
            end associate
         end associate
      end do
      self%member = self%member(:self%members)
      do i = 1, self%members
         associate (member => self%member(i))
            ! A kind that was not found has its message.
            if (member%kind_of < 1) cycle
            member%pinned = record%kind(member%kind_of)%ends == 'pinned'
            member%after_dead_load = record%kind(member%kind_of)%after_dead_load
            if (member%after_dead_load .and. abs(member%load) > 0.0_wp) then
               call messages%add('member '//trim(member%name)//' is built after the dead load, and its '// &
                                 'load of '//to_text(member%load)//' N/m would do nothing; give that to '// &
                                 'its nodes, as load_y')
            end if
         end associate
      end do
   end subroutine put_members

   !> Put in springs between nodes and the ground, where 'base' means all nodes of floor 0, and springs in
   !> panels.
   subroutine put_node_springs(self, record, messages)
      type(frame_parts), intent(inout) :: self
      type(frame_record), intent(in) :: record
      type(message_list), intent(inout) :: messages
      !> Displacement (1: x, 2: y, 3: rotation) that springs of the groups shear, flexure, axial_spring resist
      integer, parameter :: direction(3) = [1, 3, 2]
      integer :: i, j, k
      logical :: any_node

      do i = 1, size(record%spring)
         associate (s => record%spring(i))
            if (s%panel /= '' .and. s%panel /= 'all') call put_panel(self, s, messages)
            if (s%node == '') cycle
            k = direction(findloc(group_of == s%group, .true., dim=1))
            any_node = .false.
            do j = 1, size(self%node)
               associate (node => self%node(j))
                  if (node%name /= s%node .and. .not. (s%node == 'base' .and. node%storey == 0)) cycle
                  any_node = .true.
                  if (node%held(k)) then
                     call messages%add('the '//trim(s%group)//" spring of node '"//trim(node%name)// &
                                       "' does nothing, as its support holds it; change support (or base)")
                  else if (k == 1 .and. node%follows_floor()) then
                     call messages%add("the spring of node '"//trim(node%name)//"' holds a floor, which "// &
                                       'moves in plan; give it to a node of the base')
                  else if (k == 2 .and. node%rises_like > 0) then
                     call messages%add("the spring of node '"//trim(node%name)//"' stands where another "// &
                                       "node rises alike; give it to node '"// &
                                       trim(self%node(node%rises_like)%name)//"'")
                  else if (k == 1 .and. node%like > 0) then
                     call messages%add("the spring of node '"//trim(node%name)//"' stands where another "// &
                                       "node moves alike; give it to node '"// &
                                       trim(self%node(node%like)%name)//"'")
                  else if (node%ground(k)%rule /= '') then
                     call messages%add("node '"//trim(node%name)//"' has two springs &"//trim(s%group)// &
                                       '; remove one')
                  end if
                  node%ground(k) = s%spring
               end associate
            end do
            if (.not. any_node) call check_reference(s%node, [self%node%name], '&'//trim(s%group), 'node', &
                                                     messages)
         end associate
      end do
      ! Nodes whose panel was given by name keep it when one is given for all.
      do i = 1, size(record%spring)
         if (record%spring(i)%panel == 'all') call put_panel(self, record%spring(i), messages)
      end do
   end subroutine put_node_springs

   !> A spring between the columns and the beams of a node; 'all' means all nodes where both meet.
   subroutine put_panel(self, given, messages)
      type(frame_parts), intent(inout) :: self
      !> Spring of the panel, with the name of the node
      type(frame_spring), intent(in) :: given
      type(message_list), intent(inout) :: messages
      logical :: any_node
      logical :: has_beam(size(self%node)), has_column(size(self%node))
      integer :: i

      any_node = .false.
      has_beam = end_nodes(self%node, self%member, beams=.true., unpinned=.true.)
      has_column = end_nodes(self%node, self%member, beams=.false., unpinned=.true.)
      do i = 1, size(self%node)
         associate (node => self%node(i))
            if (given%panel == 'all') then
               if (.not. (has_beam(i) .and. has_column(i))) cycle
            else if (node%name /= given%panel) then
               cycle
            else if (.not. has_beam(i)) then
               call messages%add("the panel of node '"//trim(node%name)//"' does nothing, as no beam "// &
                                 'ends there; remove it')
            else if (.not. (has_column(i) .or. node%held(3) .or. node%ground(3)%rule /= '')) then
               call messages%add("the panel of node '"//trim(node%name)//"' does nothing, as no column "// &
                                 'ends there; remove it')
            else if (node%panel%rule /= '') then
               call messages%add("node '"//trim(node%name)//"' has two panels; remove one")
            end if
            any_node = .true.
            if (given%panel /= 'all' .or. node%panel%rule == '') node%panel = given%spring
         end associate
      end do
      if (any_node) return
      if (given%panel == 'all') then
         call messages%add("&flexure: panel = 'all' finds no node where a column and a beam meet; remove it")
      else
         call check_reference(given%panel, [self%node%name], '&flexure: panel', 'node', messages)
      end if
   end subroutine put_panel

   !> Note the time at which members are lost.
   subroutine put_losses(self, record, messages)
      type(frame_parts), intent(inout) :: self
      type(frame_record), intent(in) :: record
      type(message_list), intent(inout) :: messages
      integer :: i, number

      do i = 1, size(record%loss)
         call check_reference(record%loss(i)%member, [self%member%name], 'loss', 'member', messages)
         number = findloc(self%member%name == record%loss(i)%member, .true., dim=1)
         if (number > 0) self%member(number)%lost_at = record%loss(i)%time
      end do
   end subroutine put_losses

   !> Give members the springs and stiffness of their kinds, and refuse lengths and loads that do not suit
   !> them.
   subroutine put_kinds(self, record, messages)
      type(frame_parts), intent(inout) :: self
      type(frame_record), intent(in) :: record
      type(message_list), intent(inout) :: messages
      !> Clear and whole length [m]; largest E A/l [N/m] and E I/l [N m] of members; stiffness of springs of
      !> nodes along x, upward and in rotation
      real(wp) :: clear, whole, stiffest(2), held(3)
      logical :: reported(size(record%kind)), all_rigid
      !> Direction nearest to the member: 1 is x, 2 is y
      integer :: i, along

      reported = .false.
      ! A rigid member has a multiple of the stiffness of the stiffest of the others or, if all are rigid, of
      ! the springs of nodes.
      stiffest = 0.0_wp
      all_rigid = all([(is_rigid(record%kind(self%member(i)%kind_of), record%spring), &
                        i=1, size(self%member))])
      ! Of nodes: along x, along y and against rotation.
      held = 0.0_wp
      if (all_rigid) held = stiffness_of_nodes(self%node)
      if (all_rigid .and. .not. any(held > 0.0_wp)) then
         call messages%add('frame: all of its members are rigid; give one of them stiffness, or springs, '// &
                           'or a node springs to the ground')
         return
      end if
      do i = 1, size(self%member)
         associate (m => self%member(i), kind => record%kind(self%member(i)%kind_of))
            associate (a => self%node(m%node(1)), b => self%node(m%node(2)))
               clear = hypot(b%x - a%x, b%y - a%y) - sum(m%rigid)
               along = merge(1, 2, abs(b%x - a%x) > abs(b%y - a%y))
            end associate
            if (.not. clear > 0.0_wp) cycle
            ! Along the member, and against its rotation.
            if (all_rigid) then
               ! In bending a rigid member works against springs across it, at its ends, and against
               ! rotations.
               stiffest = max(stiffest, [held(along), held(3 - along)*clear**2 + held(3)])
            else if (.not. (is_rigid(kind, record%spring) .or. is_strut(kind, record%spring))) then
               stiffest = max(stiffest, stiffness_of(kind, clear))
            end if
         end associate
      end do
      do i = 1, size(self%member)
         associate (m => self%member(i))
            associate (a => self%node(m%node(1)), b => self%node(m%node(2)))
               whole = hypot(b%x - a%x, b%y - a%y)
               clear = whole - sum(m%rigid)
               if (.not. whole > 0.0_wp) then
                  call messages%add('member '//trim(m%name)//' has no length: nodes '//trim(a%name)// &
                                    ' and '//trim(b%name)//' are at one place; move one of them')
                  cycle
               else if (.not. clear > 0.0_wp) then
                  call messages%add('member '//trim(m%name)//': its rigid ends of '//to_text(sum(m%rigid))// &
                                    ' m leave nothing of its length of '//to_text(whole)// &
                                    ' m; shorten rigid_end')
                  cycle
               end if
               if (abs(m%load) > 0.0_wp .and. abs(b%x - a%x) <= same_input*whole) then
                  call messages%add('member '//trim(m%name)//' stands upright, and a load per length '// &
                                    'along x does nothing on it; give load_y to its nodes')
               end if
            end associate
            if (.not. reported(m%kind_of)) call check_length(m, record%kind(m%kind_of), clear, messages, &
                                                         reported(m%kind_of))
            call put_kind(m, record%kind(m%kind_of), record%spring, clear, stiffest)
            if (.not. (is_given(m%failure_drift) .or. is_given(m%lost_at))) cycle
            if (.not. can_be_lost(m)) then
               call messages%add('member '//trim(m%name)//' cannot be lost, as its springs do not take '// &
                                 'part in all that it carries; give it flexural springs at both ends')
            end if
         end associate
      end do
   end subroutine put_kinds

   !> Largest stiffness of springs of nodes along x, upward and in rotation [N/m, N/m, N m].
   function stiffness_of_nodes(node) result(largest)
      type(frame_node), intent(in) :: node(:)
      real(wp) :: largest(3)
      integer :: i, j

      largest = 0.0_wp
      do i = 1, size(node)
         do j = 1, 3
            associate (spring => node(i)%ground(j))
               if (spring%rule /= '') largest(j) = max(largest(j), spring%initial_stiffness())
            end associate
         end do
         if (node(i)%panel%rule /= '') largest(3) = max(largest(3), node(i)%panel%initial_stiffness())
      end do
   end function stiffness_of_nodes

   !> Refuse a kind whose springs were made for members of another length, once each.
   subroutine check_length(m, kind, clear, messages, reported)
      type(frame_member), intent(in) :: m
      type(kind_record), intent(in) :: kind
      !> Clear length of the member [m]
      real(wp), intent(in) :: clear
      type(message_list), intent(inout) :: messages
      !> Whether a message was added
      logical, intent(out) :: reported

      reported = .false.
      if (is_given(kind%length)) reported = abs(clear - kind%length) > one_length*kind%length
      if (.not. reported) return
      call messages%add('member '//trim(m%name)//': its clear length is '//to_text(clear)//' m, and the '// &
                        "springs of member_kind '"//trim(kind%name)//"' were made for "// &
                        to_text(kind%length)//' m; make a kind for this length, or correct rigid_end')
   end subroutine check_length

   !> Choose the node whose displacement is that of the top, and is controlled.
   subroutine choose_top(self, record, messages)
      type(frame_parts), intent(inout) :: self
      type(frame_record), intent(in) :: record
      type(message_list), intent(inout) :: messages
      integer :: i, direction

      direction = merge(2, 1, record%control == 'y')
      ! Of a building the top is the centre of its highest floor, unless a node is named: 0 says so.
      if (record%control_node == '' .and. self%plan%is_given()) return
      if (record%control_node == '') then
         do i = 1, size(self%node)
            if (self%node(i)%held(direction)) cycle
            if (self%top == 0) self%top = i
            ! The first of the highest nodes
            if (self%node(i)%y > self%node(self%top)%y) self%top = i
         end do
         if (self%top == 0) call messages%add('frame: no node can move along '//trim(record%control)// &
                                              '; free one, or give control')
         return
      end if
      call check_reference(record%control_node, [self%node%name], 'frame: control_node', 'node', messages)
      self%top = findloc(self%node%name == record%control_node, .true., dim=1)
      ! A name that was not found has its message.
      if (self%top == 0) return
      if (self%node(self%top)%held(direction)) then
         call messages%add("frame: control_node = '"//trim(record%control_node)//"' cannot move along "// &
                           trim(record%control)//'; name another one')
      end if
   end subroutine choose_top

   !> Set the shares of the nodes in the lateral load, by mass or mass times height; those of the first mode
   !> are found later, from the frame.
   subroutine push(self, record, messages)
      type(frame_parts), intent(inout) :: self
      type(frame_record), intent(in) :: record
      type(message_list), intent(inout) :: messages
      !> Mass along x of each node, of those that can move [kg]; height of the lowest node [m]
      real(wp) :: mass(size(self%node)), lowest
      logical :: has_mass
      integer :: i

      if (record%pattern == 'nodes') then
         if (all([(all(.not. abs(self%node(i)%push) > 0.0_wp), i=1, size(self%node))])) then
            call messages%add("frame: pattern = 'nodes' needs push_x or push_y of some node; give one")
         end if
         return
      else if (any([(any(abs(self%node(i)%push) > 0.0_wp), i=1, size(self%node))])) then
         call messages%add("frame: push_x and push_y belong to pattern = 'nodes'; choose that, or remove "// &
                           'them')
         return
      end if
      mass = [(merge(0.0_wp, self%node(i)%mass(1), self%node(i)%held(1)), i=1, size(self%node))]
      ! The mass of a floor itself is on its first node.
      if (self%plan%is_given()) then
         do i = 1, size(self%plan%mass)
            associate (first => findloc(self%node%follows_floor() .and. self%node%storey == i, .true., dim=1))
               mass(first) = mass(first) + self%plan%mass(i)
            end associate
         end do
      end if
      has_mass = any(mass > 0.0_wp)
      lowest = minval(self%node%y)
      do i = 1, size(self%node)
         associate (node => self%node(i))
            ! Where no mass is given all nodes count alike.
            if (.not. (has_mass .or. node%held(1))) mass(i) = 1.0_wp
            ! Along x, nothing upward
            node%push = [mass(i), 0.0_wp]
            if (record%pattern == 'triangular') node%push = node%push*(node%y - lowest)
         end associate
      end do
      associate (all_of_it => sum([(self%node(i)%push(1), i=1, size(self%node))]))
         if (all_of_it > 0.0_wp) then
            do i = 1, size(self%node)
               self%node(i)%push = self%node(i)%push/all_of_it
            end do
         else if (record%pattern /= 'modal') then
            call messages%add("frame: pattern = '"//trim(record%pattern)//"' finds no node that can be "// &
                              "pushed along x; choose pattern = 'nodes' with push_x or push_y")
         end if
      end associate
   end subroutine push

end module rbs_structure_frame_frame_parts
