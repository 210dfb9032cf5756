!> A planar frame from its nodes and members: numbers of the unknowns, elements with their springs, and forces
!> of the dead load in them.
module rbs_structure_frame_new_frame
   use rbs_base_check, only: is_given
   use rbs_base_constants, only: unset
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_spring_record, only: spring_record, add_rules
   use rbs_structure_frame_element, only: frame_element, element_joint, most_columns
   use rbs_structure_frame_frame, only: frame_type
   use rbs_structure_frame_frame_record, only: name_length
   use rbs_structure_frame_numbering, only: order_nodes, order_downward
   use rbs_structure_frame_plan, only: floor_plan
   use rbs_structure_spring_location, only: spring_location, shear, flexure, axial, layer
   use rbs_structure_structure, only: unknown_group, pdelta, lateral, horizontal, vertical, sideways, signals
   implicit none
   private

   public :: frame_node, frame_member, new_frame, is_beam

   !> A node: position [m], supports (x, y, theta), mass [kg, kg, kg m2], dead load [N, N, N m].
   type :: frame_node
      character(len=name_length) :: name = ''
      !> Floor of the grid, -1 for a node that is none of it
      integer :: storey = -1
      real(wp) :: x = 0.0_wp, y = 0.0_wp
      logical :: held(3) = .false.
      real(wp) :: mass(3) = 0.0_wp, load(3) = 0.0_wp
      !> Shares of the lateral load, along x and upward
      real(wp) :: push(2) = 0.0_wp
      !> Springs to the ground along x, upward and in rotation; without a rule: none
      type(spring_record) :: ground(3)
      !> Between the rotations of its columns and its beams; without a rule they are one
      type(spring_record) :: panel
      !> The node whose displacement along x this one shares, as along a floor; 0: none
      integer :: like = 0
      !> In a building the plane that it is in, and the node whose displacement upward this one shares; 0:
      !> none
      integer :: plane = 0, rises_like = 0
   contains
      procedure :: follows_floor
   end type frame_node

   !> A member from node to node: rigid ends, and springs in the part that is elastic otherwise.
   type :: frame_member
      character(len=name_length) :: name = ''
      integer :: node(2) = 0
      !> Number of its kind in the input
      integer :: kind_of = 0
      !> Lengths of the rigid ends [m]
      real(wp) :: rigid(2) = 0.0_wp
      !> E A [N], E I [N m2] and G A_s [N] of the elastic rest; 0 where it is rigid. Whether springs have the
      !> flexibility of E I, whether its ends are pinned, and whether it is built under the dead load
      real(wp) :: axial = 0.0_wp, bending = 0.0_wp, sliding = 0.0_wp
      logical :: lumped = .false., pinned = .false., after_dead_load = .false.
      !> Of springs: kind, joint, position in shares of the clear length, parameters; last those that open.
      !> Layers of a joint follow one another, with their distances from its middle [m]
      integer, allocatable :: kind(:), joint(:)
      real(wp), allocatable :: position(:), y(:)
      type(spring_record), allocatable :: spring(:)
      !> Dead load downward per length along x [N/m]
      real(wp) :: load = 0.0_wp
      !> Drift at which it loses a small axial load after shear failure, the load that halves this drift [N],
      !> the drift of shear failure if no shear spring has yielded, and the time from which on it is lost [s];
      !> `unset`: never
      real(wp) :: failure_drift = unset, failure_load = unset, shear_drift = unset, lost_at = unset
      !> In a building the member that is this column in another plane, and whose axial force is its own; 0:
      !> none
      integer :: axial_of = 0
   contains
      procedure :: opens
   end type frame_member

   !> Motion of the ends by the opening of a joint, in the first column.
   real(wp), parameter :: along_axis(3, 2) = reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp], [3, 2])

contains

   !> Make a frame of nodes and members that have been checked.
   subroutine new_frame(frame, node, member, kinematics, plan, top, vertical)
      type(frame_type), intent(out) :: frame
      type(frame_node), intent(in) :: node(:)
      type(frame_member), intent(in) :: member(:)
      !> `small` or `pdelta`
      integer, intent(in) :: kinematics
      !> Of a building; else of no planes
      type(floor_plan), intent(in) :: plan
      !> The node whose displacement is that of the top; 0: in a building that of the highest floor along the
      !> load
      integer, intent(in) :: top
      !> Whether that is the one upward, not the one along x
      logical, intent(in), optional :: vertical
      type(spring_record), allocatable :: spring(:)
      !> Direction of the control: 1 is x, 2 is y
      integer :: i, direction

      frame%kinematics = kinematics
      frame%n = size(node)
      frame%node_name = node%name
      frame%member_name = member%name
      frame%storey = node%storey
      frame%x = node%x
      frame%y = node%y
      frame%plan = plan
      frame%plane = node%plane
      frame%axial_of = member%axial_of
      ! Distances of the nodes from a point on none of their axes. As a mark of the state, they differ between
      ! frames.
      frame%length = [(hypot(node(i)%x + 1.0_wp/3.0_wp, node(i)%y + 0.7_wp), i=1, size(node))]
      frame%height = maxval(node%y) - minval(node%y)
      ! A beam alone has no height.
      if (.not. frame%height > 0.0_wp) frame%height = maxval(node%x) - minval(node%x)
      frame%total_height = frame%height
      call set_storeys(frame)
      frame%members = size(member)
      frame%failure_drift = member%failure_drift
      frame%failure_load = member%failure_load
      frame%shear_drift = member%shear_drift
      frame%lost_at = member%lost_at
      frame%may_lose = any(is_given(frame%failure_drift) .or. is_given(frame%lost_at))
      frame%member_springs = count(node%panel%rule /= '')
      do i = 1, size(member)
         frame%member_springs = frame%member_springs + size(member(i)%kind)
      end do
      call number_unknowns(frame, node, member)
      frame%springs = frame%member_springs + sum([(count(node(i)%ground%rule /= '' .and. &
                                                         frame%number(:, i) > 0), i=1, size(node))])
      call number_joints(frame, member)
      frame%coordinates = frame%joints%before + 2*frame%joints%count
      associate (springs => frame%springs, inside => frame%member_springs)
         allocate (spring(springs), frame%location(springs), frame%position_ratio(inside), &
                   frame%ground(springs - inside))
         allocate (frame%arm(frame%coordinates), frame%constant_axial(springs), source=0.0_wp)
         direction = 1
         if (present(vertical)) direction = merge(2, 1, vertical)
         ! The displacement of the top, as a row for the coordinates
         if (top > 0 .and. direction == 2) then
            frame%arm(springs + frame%number(2, top)) = 1.0_wp
         else if (top > 0) then
            call frame%add_along_x(top, 1.0_wp, frame%arm(springs + 1:))
         else
            call put_on_floor(frame, frame%storeys, frame%plan%direction, frame%arm(springs + 1:))
         end if
         frame%before_arm = 4*(springs/4)
         frame%control = frame%arm(springs + 1:springs + frame%unknowns)
      end associate
      call set_ground(frame, node, member, spring)
      call set_elements(frame, node, member, spring)
      call set_panels(frame, node, spring)
      call list_springs(frame)
      call add_rules(frame%rules, spring, frame%springs)
      frame%initial_stiffness = frame%rules%initial_stiffness()
      allocate (frame%initial_tangent(size(frame%element)))
      do i = 1, size(frame%element)
         associate (e => frame%element(i), springs => frame%element(i)%bending + frame%element(i)%opening)
            call e%set_initial(frame%initial_stiffness(e%before + 1:e%before + springs))
            call frame%initial_tangent(i)%create(e%inner + 3, springs, size(e%joint))
         end associate
      end do
      call frame%linearise(frame%initial_stiffness, frame%initial_tangent, i)
      do i = 1, frame%members
         call frame%element(i)%bend_as_springs(frame%initial_stiffness)
      end do
      frame%moving = frame%springs
      frame%is_still = frame%is_held
      frame%is_implicit = .true.
      frame%axially_loaded = kinematics == pdelta
      ! Axial forces are known for all members, and count where they do second-order work.
      frame%axial_count = merge(size(member), 0, frame%axially_loaded)
      frame%group = [unknown_group(1, frame%unknowns, 1, 1, frame%member_springs, 1.0_wp)]
   end subroutine new_frame

   !> Set the shares of the nodes in the drifts of the storeys: the mean of a floor over the height of the
   !> storey.
   subroutine set_storeys(frame)
      type(frame_type), intent(inout) :: frame
      real(wp) :: height
      integer :: i, nodes

      frame%storeys = max(maxval(frame%storey), 0)
      if (frame%plan%is_given()) call set_levels(frame)
      allocate (frame%storey_share(2, frame%n), source=0.0_wp)
      do i = 1, frame%storeys
         associate (above => frame%storey == i, below => frame%storey == i - 1)
            height = maxval(frame%y, mask=above) - maxval(frame%y, mask=below)
            nodes = count(above)
            where (above) frame%storey_share(1, :) = 1.0_wp/(nodes*height)
            nodes = count(below)
            where (below) frame%storey_share(2, :) = -1.0_wp/(nodes*height)
         end associate
      end do
   end subroutine set_storeys

   !> Set the heights of the storeys of a building, and the node of the base in each plane.
   subroutine set_levels(frame)
      type(frame_type), intent(inout) :: frame
      real(wp) :: level(0:frame%storeys)
      integer :: i

      level = [(maxval(frame%y, mask=frame%storey == i), i=0, frame%storeys)]
      frame%storey_height = level(1:) - level(:frame%storeys - 1)
      frame%foot = [(findloc(frame%plane == i .and. frame%storey == 0, .true., dim=1), &
                     i=1, frame%plan%planes())]
   end subroutine set_levels

   !> Number the unknowns along the order of the nodes, and find the half-width of the band.
   subroutine number_unknowns(frame, node, member)
      type(frame_type), intent(inout) :: frame
      type(frame_node), intent(in) :: node(:)
      type(frame_member), intent(in) :: member(:)
      !> Nodes that are coupled; order of the nodes; node that has the unknown for x, y and rotation (nodes,
      !> 3)
      integer :: pair(2, size(member) + size(node)), order(size(node)), leader(size(node), 3)
      integer :: i, j, number(most_columns), width

      do i = 1, size(member)
         pair(:, i) = member(i)%node
      end do
      ! The node whose unknown along x, along y or of the rotation a node has.
      do i = 1, size(node)
         leader(i, :) = i
         if (node(i)%like > 0) leader(i, 1) = node(i)%like
         if (node(i)%rises_like > 0) leader(i, 2) = node(i)%rises_like
         pair(:, size(member) + i) = [i, leader(i, 1)]
      end do
      if (frame%plan%is_given()) then
         allocate (frame%plan%number(3, frame%storeys), source=0)
         ! Rigid floors couple all nodes of a floor.
         call order_downward(size(node), node%y, order)
      else
         call order_nodes(size(node), pair, order)
      end if
      allocate (frame%number(3, size(node)), frame%also(2, size(node)), frame%beam_rotation(size(node)), &
                frame%parting(size(member)), source=0)
      allocate (frame%share(3, size(node)), source=1.0_wp)
      do i = 1, size(node)
         do j = 1, 3
            associate (of => leader(order(i), j))
               if (j == 1 .and. node(of)%follows_floor()) cycle
               ! A node that others move with is numbered at the last of these, which keeps the rows of all of
               ! them short.
               if (node(of)%held(j) .or. any(leader(order(i + 1:), j) == of)) cycle
               frame%unknowns = frame%unknowns + 1
               frame%number(j, of) = frame%unknowns
            end associate
         end do
         if (any(member%axial_of > 0)) call number_partings(frame, member, order(i))
         if (node(order(i))%panel%rule /= '') then
            frame%unknowns = frame%unknowns + 1
            frame%beam_rotation(order(i)) = frame%unknowns
         end if
         ! A floor is numbered at the last of its nodes.
         if (.not. node(order(i))%follows_floor()) cycle
         associate (storey => node(order(i))%storey)
            if (any(node(order(i + 1:))%follows_floor() .and. node(order(i + 1:))%storey == storey)) cycle
            do j = 1, 3
               if (frame%plan%held(j)) cycle
               frame%unknowns = frame%unknowns + 1
               frame%plan%number(j, storey) = frame%unknowns
            end do
         end associate
      end do
      ! Nodes that move alike have the numbers of their leader.
      do i = 1, size(node)
         frame%number(:, i) = [(frame%number(j, leader(i, j)), j=1, 3)]
         associate (of => node(leader(i, 1)))
            if (of%follows_floor()) call follow_floor(frame, i, frame%plan%number(:, of%storey))
         end associate
      end do
      do i = 1, size(member)
         call find_numbers(frame, node, member(i), i, number, width)
         if (any(number > 0)) frame%half_width = max(frame%half_width, maxval(number) &
                                                     - minval(number, mask=number > 0))
      end do
      ! A panel couples two unknowns, whatever the members.
      if (any(frame%beam_rotation > 0)) frame%half_width = max(frame%half_width, 1)
   end subroutine number_unknowns

   !> Let a node move with its floor: note the unknowns that move it along x, and their shares.
   subroutine follow_floor(frame, node, floor)
      type(frame_type), intent(inout) :: frame
      !> Number of the node
      integer, intent(in) :: node
      !> Numbers of U, V and Theta of the floor among the unknowns (3)
      integer, intent(in) :: floor(:)
      !> Number of unknowns that move the node
      integer :: j, moving, at(3)

      moving = 0
      at = 0
      associate (share => frame%plan%share(:, frame%plane(node), frame%storey(node)))
         do j = 1, 3
            if (floor(j) == 0 .or. .not. abs(share(j)) > 0.0_wp) cycle
            moving = moving + 1
            at(moving) = floor(j)
            frame%share(moving, node) = share(j)
         end do
      end associate
      frame%number(1, node) = at(1)
      frame%also(:, node) = at(2:)
   end subroutine follow_floor

   !> Where both planes of a column may open, number the part of its elongation that is of the second plane.
   subroutine number_partings(frame, member, node)
      type(frame_type), intent(inout) :: frame
      type(frame_member), intent(in) :: member(:)
      !> The node at which the columns end that are meant
      integer, intent(in) :: node
      integer :: i

      do i = 1, size(member)
         if (member(i)%axial_of == 0 .or. member(i)%node(2) /= node) cycle
         if (.not. member(i)%opens()) cycle
         frame%unknowns = frame%unknowns + 1
         frame%parting(i) = frame%unknowns
      end do
   end subroutine number_partings

   !> Numbers of the displacements of the ends of a member among the unknowns: beams turn with the other side
   !> of a panel. In a building further unknowns of its floors, and the parting of its elongation, follow.
   subroutine find_numbers(frame, node, member, of, number, width, end_of, factor)
      type(frame_type), intent(in) :: frame
      type(frame_node), intent(in) :: node(:)
      type(frame_member), intent(in) :: member
      !> Number of the member
      integer, intent(in) :: of
      !> The numbers, 0 where a support holds one, and how many there are
      integer, intent(out) :: number(most_columns), width
      !> See `follow_floor` of `frame_element`
      integer, intent(out), optional :: end_of(most_columns)
      real(wp), intent(out), optional :: factor(most_columns)
      integer :: i, j, follows(most_columns), parting
      real(wp) :: share(most_columns)

      number = 0
      number(:6) = reshape(frame%number(:, member%node), [6])
      width = 6
      follows = 0
      share = 1.0_wp
      if (is_beam(node(member%node(1)), node(member%node(2)))) then
         do i = 1, 2
            if (frame%beam_rotation(member%node(i)) > 0) number(3*i) = frame%beam_rotation(member%node(i))
         end do
      end if
      associate (a => node(member%node(1)), b => node(member%node(2)))
         if (a%follows_floor() .and. b%follows_floor() .and. a%storey == b%storey) then
            ! Nothing of it changes as its floor moves.
            number([1, 4]) = 0
         else
            do i = 1, 2
               associate (end_node => member%node(i))
                  if (.not. node(end_node)%follows_floor()) cycle
                  ! Along x it moves as its floor moves and turns, in shares.
                  follows(3*i - 2) = 3*i - 2
                  share(3*i - 2) = frame%share(1, end_node)
                  do j = 1, 2
                     if (frame%also(j, end_node) > 0) call add(frame%also(j, end_node), 3*i - 2, &
                                                               frame%share(1 + j, end_node))
                  end do
               end associate
            end do
         end if
      end associate
      ! The unknown is in both planes of the column.
      parting = frame%parting(of)
      if (any(frame%axial_of == of)) parting = maxval(frame%parting, mask=frame%axial_of == of)
      if (parting > 0) call add(parting, 0, 1.0_wp)
      if (present(end_of)) end_of = follows
      if (present(factor)) factor = share

   contains

      !> Append an unknown that moves the column of an x by a factor.
      subroutine add(unknown, column, factor)
         !> Number of the unknown; column of x that it follows from, 0: none; its share in that
         integer, intent(in) :: unknown, column
         real(wp), intent(in) :: factor

         width = width + 1
         number(width) = unknown
         follows(width) = column
         share(width) = factor
      end subroutine add
   end subroutine find_numbers

   !> Whether the displacement of a node along x is that of its floor.
   elemental logical function follows_floor(self)
      class(frame_node), intent(in) :: self

      follows_floor = self%plane > 0 .and. self%storey > 0
   end function follows_floor

   !> Whether a member has springs that open.
   elemental logical function opens(self)
      class(frame_member), intent(in) :: self

      opens = any(self%kind == axial .or. self%kind == layer)
   end function opens

   !> Add shares of the motion (U, V, Theta) of a floor to a row of the unknowns.
   pure subroutine put_on_floor(frame, floor, share, row)
      type(frame_type), intent(in) :: frame
      !> Number of the floor; shares of U, V and Theta
      integer, intent(in) :: floor
      real(wp), intent(in) :: share(3)
      !> (unknowns)
      real(wp), intent(inout) :: row(:)
      integer :: j

      do j = 1, 3
         associate (at => frame%plan%number(j, floor))
            if (at > 0) row(at) = row(at) + share(j)
         end associate
      end do
   end subroutine put_on_floor

   !> Whether a member between two nodes is a beam: it is flatter than 45 degrees.
   pure logical function is_beam(a, b)
      type(frame_node), intent(in) :: a, b

      is_beam = abs(b%x - a%x) > abs(b%y - a%y)
   end function is_beam

   !> Put masses and loads of the nodes on the unknowns, and set the springs from the ground.
   subroutine set_ground(frame, node, member, spring)
      type(frame_type), intent(inout) :: frame
      type(frame_node), intent(in) :: node(:)
      type(frame_member), intent(in) :: member(:)
      !> Springs of the frame, those from the ground behind the others
      type(spring_record), intent(inout) :: spring(:)
      integer, parameter :: kind_of(3) = [shear, axial, flexure]
      character(len=2), parameter :: along(3) = ['x_', 'y_', 't_']
      integer :: i, j, last

      allocate (frame%unknown_name(frame%unknowns), source=repeat(' ', len(frame%unknown_name)))
      allocate (frame%inertias(frame%unknowns), frame%dead(frame%unknowns), source=0.0_wp)
      allocate (frame%is_held(frame%unknowns), source=.false.)
      allocate (frame%reach(frame%unknowns), source=1.0_wp)
      allocate (frame%part(frame%unknowns), source=0)
      do j = 1, signals
         allocate (frame%pattern(j)%force(frame%unknowns), source=0.0_wp)
      end do
      last = frame%member_springs
      do i = 1, size(node)
         ! Along x a node on a rigid floor has no unknown, see `set_floors`.
         do j = merge(2, 1, node(i)%follows_floor()), 3
            associate (at => frame%number(j, i))
               if (at == 0) cycle
               frame%inertias(at) = frame%inertias(at) + node(i)%mass(j)
               frame%dead(at) = frame%dead(at) + node(i)%load(j)
               frame%part(at) = i
               if (j == 3) frame%reach(at) = frame%total_height
               if (frame%unknown_name(at) == '') frame%unknown_name(at) = along(j)//node(i)%name
               if (node(i)%ground(j)%rule /= '') then
                  last = last + 1
                  frame%ground(last - frame%member_springs) = at
                  ! No member, no joint, no source of work; the index is that of the node.
                  frame%location(last) = spring_location(kind_of(j), 0, 0, 0, 0, i, 'node '//node(i)%name)
                  spring(last) = node(i)%ground(j)
               end if
               associate (push => [node(i)%push, 0.0_wp])
                  frame%pattern(lateral)%force(at) = frame%pattern(lateral)%force(at) + push(j)
               end associate
               if (j == 1) frame%pattern(horizontal)%force(at) = -frame%inertias(at)
               if (j == 2) frame%pattern(vertical)%force(at) = -frame%inertias(at)
            end associate
         end do
         associate (at => frame%beam_rotation(i))
            if (at == 0) cycle
            frame%part(at) = i
            frame%reach(at) = frame%total_height
            frame%unknown_name(at) = 'b_'//node(i)%name
         end associate
      end do
      do i = 1, size(frame%parting)
         if (frame%parting(i) == 0) cycle
         frame%part(frame%parting(i)) = member(i)%node(2)
         frame%unknown_name(frame%parting(i)) = 'w_'//member(i)%name
      end do
      if (frame%plan%is_given()) call set_floors(frame, node)
      frame%pattern%last = frame%unknowns
   end subroutine set_ground

   !> Put masses on the floors, at their centres of mass, and loads on them.
   subroutine set_floors(frame, node)
      type(frame_type), intent(inout) :: frame
      type(frame_node), intent(in) :: node(:)
      character(len=2), parameter :: along(3) = ['U_', 'V_', 'T_']
      character(len=12) :: floor_number
      real(wp) :: mass(3)
      integer :: i, j

      do i = 1, frame%storeys
         mass = frame%plan%mass(i)
         mass(3) = frame%plan%inertia(i)
         mass(:2) = mass(:2) + sum(node%mass(1), mask=node%storey == i .and. node%plane > 0)
         write (floor_number, '(i0)') i
         do j = 1, 3
            associate (at => frame%plan%number(j, i))
               if (at == 0) cycle
               frame%inertias(at) = mass(j)
               frame%unknown_name(at) = along(j)//'floor-'//floor_number
               frame%part(at) = findloc(node%storey == i .and. node%plane > 0, .true., dim=1)
               if (j == 1) frame%pattern(horizontal)%force(at) = -mass(j)
               if (j == 2) frame%pattern(sideways)%force(at) = -mass(j)
               if (j == 3) frame%reach(at) = frame%total_height
            end associate
         end do
      end do
      do i = 1, size(node)
         if (.not. node(i)%follows_floor()) cycle
         call frame%add_along_x(i, node(i)%load(1), frame%dead)
         ! Shares by mass are in the direction of the load, those of nodes in their planes.
         if (frame%plan%by_nodes) then
            call frame%add_along_x(i, node(i)%push(1), frame%pattern(lateral)%force)
         else
            call put_on_floor(frame, node(i)%storey, node(i)%push(1)*frame%plan%direction, &
                              frame%pattern(lateral)%force)
         end if
      end do
   end subroutine set_floors

   !> Number the joints of layers, in the order of the springs.
   subroutine number_joints(frame, member)
      type(frame_type), intent(inout) :: frame
      type(frame_member), intent(in) :: member(:)
      !> Joint of each spring, 0 for none; distance of a layer from the middle of its joint [m]
      integer :: of(frame%springs), at, i, j, joints
      real(wp) :: y(frame%springs)

      allocate (frame%heads(frame%member_springs), source=.false.)
      of = 0
      y = 0.0_wp
      at = 0
      joints = 0
      do i = 1, size(member)
         associate (m => member(i))
            do j = 1, size(m%kind)
               at = at + 1
               if (m%kind(j) /= layer) cycle
               frame%heads(at) = findloc(m%joint, m%joint(j), dim=1) == j
               if (frame%heads(at)) joints = joints + 1
               of(at) = joints
               y(at) = m%y(j)
            end do
         end associate
      end do
      call frame%joints%create(of, y, frame%springs + frame%unknowns)
   end subroutine number_joints

   !> Set the geometry of the elements, their springs, and the forces of the dead load in them.
   subroutine set_elements(frame, node, member, spring)
      type(frame_type), intent(inout) :: frame
      type(frame_node), intent(in) :: node(:)
      type(frame_member), intent(in) :: member(:)
      !> Springs of the frame, in which those of the members are set
      type(spring_record), intent(inout) :: spring(:)
      !> Unit vectors along the member and across it; rotation of the chord per displacement of the ends
      real(wp) :: axis(2), across(2), chord(6), factor(most_columns)
      integer :: i, j, before, end_of(most_columns)

      associate (elements => size(member) + count(frame%beam_rotation > 0))
         allocate (frame%element(elements))
         allocate (frame%dead_force(frame%member_springs), source=0.0_wp)
      end associate
      before = 0
      do i = 1, size(member)
         associate (m => member(i), e => frame%element(i), a => node(member(i)%node(1)), &
                    b => node(member(i)%node(2)))
            axis = [b%x - a%x, b%y - a%y]
            associate (whole => norm2(axis))
               axis = axis/whole
               e%rigid = m%rigid
               e%length = whole - sum(m%rigid)
            end associate
            across = [axis(2), -axis(1)]
            associate (clear => e%length)
               e%node = m%node
               call find_numbers(frame, node, m, i, e%number, e%width, end_of, factor)
               ! Elongation and rotations of both ends off the chord, from the motions of the two nodes.
               e%to_basic(1, :6) = [-axis, 0.0_wp, axis, 0.0_wp]
               ! The chord turns clockwise as its end moves across.
               chord = [-across, -m%rigid(1), across, -m%rigid(2)]/clear
               e%to_basic(2, :6) = [0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp] - chord
               e%to_basic(3, :6) = [0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp] - chord
               if (m%pinned) e%to_basic(2:, :) = 0.0_wp
               ! Rotations of the rigid ends and of the chord, on which axial forces do second-order work.
               e%lean(1, 3) = 1.0_wp
               e%lean(2, 6) = 1.0_wp
               e%lean(3, :6) = chord
               e%lean_of_end = chord([1, 4])
               call e%follow_floor(end_of, factor)
               call share_elongation(frame, i, e)
               call e%leave_out_supports()
               e%before = before
               e%opening = count(m%kind == axial)
               e%bending = size(m%kind) - e%opening
               e%rest_along = m%axial/clear
               ! A column in two planes is elastic along its axis once, in the first.
               if (frame%parting(i) > 0) e%rest_along = 0.0_wp
               e%flexural_rigidity = m%bending
               e%shear_rigidity = m%sliding
               e%lumped = m%lumped
               e%pinned = m%pinned
               e%after_dead_load = m%after_dead_load
               do j = 1, size(m%kind)
                  spring(before + j) = m%spring(j)
                  frame%position_ratio(before + j) = m%position(j)
                  ! Only shear springs ask for the work of others.
                  frame%location(before + j) = spring_location(m%kind(j), i, m%joint(j), 0, 0, i, m%name)
                  if (m%kind(j) == shear) call assign_work_source(m, j, before, frame%location(before + j))
               end do
               call set_joints(e, m, clear, frame)
               call put_load(frame, m, i, axis, clear)
               call frame%compress(i, 0.0_wp)
               before = before + size(m%kind)
            end associate
         end associate
      end do
   end subroutine set_elements

   !> A column in two planes has one elongation. If joints in both planes open, the part of the second plane
   !> is an unknown, which the elongation of the first plane is less by; else the second plane has none.
   pure subroutine share_elongation(frame, i, e)
      type(frame_type), intent(in) :: frame
      !> Number of the member, and its element
      integer, intent(in) :: i
      !> Its row of elongations is changed here
      type(frame_element), intent(inout) :: e

      ! That unknown is the last one of the element in either plane.
      if (frame%axial_of(i) > 0) e%to_basic(1, :) = 0.0_wp
      if (frame%parting(i) > 0) then
         e%to_basic(1, e%width) = 1.0_wp
      else if (any(frame%axial_of == i .and. frame%parting > 0)) then
         e%to_basic(1, e%width) = -1.0_wp
      end if
   end subroutine share_elongation

   !> Let the nearest flexural spring, or joint of layers, of a member be the one whose work weakens a shear
   !> spring.
   pure subroutine assign_work_source(m, spring, before, location)
      type(frame_member), intent(in) :: m
      !> Number of the shear spring in the member, and of the springs before the member
      integer, intent(in) :: spring, before
      !> Place of the shear spring, in which the source is set
      type(spring_location), intent(inout) :: location
      integer :: nearest

      associate (bends => m%kind == flexure .or. m%kind == layer)
         if (.not. any(bends)) return
         nearest = minloc(abs(m%position - m%position(spring)), dim=1, mask=bends)
         associate (joint => m%joint == m%joint(nearest))
            location%work_source = before + findloc(joint, .true., dim=1)
            location%last_work_source = before + findloc(joint, .true., dim=1, back=.true.)
         end associate
      end associate
   end subroutine assign_work_source

   !> Set the panels: each is an element of one spring, which "opens" by the rotation of columns against
   !> beams.
   subroutine set_panels(frame, node, spring)
      type(frame_type), intent(inout) :: frame
      type(frame_node), intent(in) :: node(:)
      !> Springs of the frame, in which those of the panels are set
      type(spring_record), intent(inout) :: spring(:)
      integer :: i, element, at

      element = frame%members
      at = frame%member_springs - count(frame%beam_rotation > 0)
      do i = 1, size(node)
         if (frame%beam_rotation(i) == 0) cycle
         element = element + 1
         at = at + 1
         associate (e => frame%element(element))
            e%node = i
            e%number([3, 6]) = [frame%number(3, i), frame%beam_rotation(i)]
            e%to_basic(1, :6) = [0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, -1.0_wp]
            call e%leave_out_supports()
            e%before = at - 1
            e%opening = 1
            e%is_panel = .true.
            e%inner = 1
            allocate (e%joint(1))
            e%joint(1) = element_joint(first=1, last=1, motion=at, spring=1, arm=along_axis)
         end associate
         spring(at) = node(i)%panel
         frame%position_ratio(at) = 0.0_wp
         frame%location(at) = spring_location(flexure, 0, 1, index=i, owner=node(i)%name)
      end do
   end subroutine set_panels

   !> List the springs of each kind for rows; a joint of layers is both in flexure and in axial, as it rotates
   !> and opens.
   subroutine list_springs(frame)
      type(frame_type), intent(inout) :: frame
      integer :: i, kind

      do kind = 1, 3
         frame%listed(kind)%spring = pack([(i, i=1, frame%member_springs)], &
                                          frame%location(:frame%member_springs)%kind == kind &
                                          .or. (frame%heads .and. kind /= shear))
      end do
   end subroutine list_springs

   !> Set the joints of an element: its springs, those of layers together, and the motion of the ends by them.
   subroutine set_joints(e, m, clear, frame)
      type(frame_element), intent(inout) :: e
      type(frame_member), intent(in) :: m
      !> Clear length [m]; frame whose joints of layers are numbered
      real(wp), intent(in) :: clear
      type(frame_type), intent(in) :: frame
      real(wp) :: moment(3)
      integer :: i, j

      if (any(m%kind == layer)) e%y = m%y
      allocate (e%joint(maxval([0, m%joint])))
      do j = 1, size(e%joint)
         i = findloc(m%joint, j, dim=1)
         associate (of => e%joint(j))
            of%first = i
            of%last = findloc(m%joint, j, dim=1, back=.true.)
            of%is_single = m%kind(i) /= layer
            of%motion = e%before + i
            of%spring = e%inner + 1
            e%inner = e%inner + merge(1, 2, of%is_single)
            if (.not. of%is_single) of%motion = frame%joints%before + 2*frame%joints%of(e%before + i) - 1
            ! Moment at the position by the moments of the two ends, which turn the same way
            moment = [0.0_wp, m%position(i) - 1.0_wp, m%position(i)]
            select case (m%kind(i))
            case (layer)
               of%arm(:, 1) = along_axis(:, 1)
               of%arm(:, 2) = moment
            case (axial)
               of%arm = along_axis
            case (shear)
               of%arm(:, 1) = [0.0_wp, -1.0_wp, -1.0_wp]/clear
            case default
               of%arm(:, 1) = moment
            end select
         end associate
      end do
   end subroutine set_joints

   !> Dead load on a member: that of the clear length is carried to the rigid ends as by a beam on two
   !> supports, with moments in between; that of the rigid ends is on them.
   subroutine put_load(frame, m, i, axis, clear)
      type(frame_type), intent(inout) :: frame
      type(frame_member), intent(in) :: m
      !> Number of the member
      integer, intent(in) :: i
      !> Unit vector from its first to its last node; clear length [m]
      real(wp), intent(in) :: axis(2), clear
      real(wp) :: down, per_length, share, lever, over_node
      integer :: j, k, at

      if (.not. abs(m%load) > 0.0_wp) return
      ! Per length of the member: the load downward, then its part across it
      per_length = m%load*abs(axis(1))
      down = per_length*axis(1)
      ! Moments and shear forces of a beam on two supports, at the springs
      do j = 1, size(m%kind)
         share = m%position(j)
         at = frame%element(i)%before + j
         if (m%kind(j) == flexure) frame%dead_force(at) = -down*clear**2*share*(1.0_wp - share)/2.0_wp
         if (frame%heads(at)) call bend_layers(-down*clear**2*share*(1.0_wp - share)/2.0_wp, &
                                               m%y, m%joint == m%joint(j), frame%element(i))
         if (m%kind(j) == shear) frame%dead_force(at) = down*clear*(0.5_wp - share)
      end do
      if (.not. m%pinned) frame%element(i)%load_across = down
      ! Half of the load for each node; the rigid ends have a lever to it.
      do k = 1, 2
         over_node = per_length*m%rigid(k)
         at = frame%number(2, m%node(k))
         if (at > 0) frame%dead(at) = frame%dead(at) - (per_length*clear/2.0_wp + over_node)
         at = frame%element(i)%number(3*k)
         lever = merge(1.0_wp, -1.0_wp, k == 1)*m%rigid(k)*axis(1)
         if (at > 0) frame%dead(at) = frame%dead(at) + lever*(per_length*clear + over_node)/2.0_wp
      end do

   contains

      !> The moment of a joint of layers, as a couple of forces in its outermost layers.
      subroutine bend_layers(moment, y, joint_numbers, e)
         !> Moment [N m]; distances of the layers of the member [m]
         real(wp), intent(in) :: moment, y(:)
         !> Whether a layer is of this joint
         logical, intent(in) :: joint_numbers(:)
         type(frame_element), intent(inout) :: e

         e%joint(m%joint(j))%dead_moment = moment
         associate (low => minloc(y, dim=1, mask=joint_numbers), high => maxloc(y, dim=1, mask=joint_numbers))
            frame%dead_force(e%before + high) = moment/(y(high) - y(low))
            frame%dead_force(e%before + low) = -moment/(y(high) - y(low))
         end associate
      end subroutine bend_layers
   end subroutine put_load

end module rbs_structure_frame_new_frame
