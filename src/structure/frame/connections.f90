!> How nodes and members of a frame hang together: nodes that move alike, floors one above the other, parts
!> that nothing ties.
module rbs_structure_frame_connections
   use rbs_base_error, only: message_list
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_base_tolerances, only: same_input
   use rbs_structure_frame_new_frame, only: frame_node, frame_member, is_beam
   implicit none
   private

   public :: find_leaders, check_floors, end_nodes, hold_idle, hold_between_pins, check_geometry, check_held

contains

   !> Let `like` of each node name the leader of its group, the node whose displacement along x the others
   !> share; a support of any of them holds all. Refuse nodes that move with themselves.
   subroutine find_leaders(node, messages)
      type(frame_node), intent(inout) :: node(:)
      type(message_list), intent(inout) :: messages
      integer :: i, steps, leader(size(node))

      do i = 1, size(node)
         leader(i) = i
         ! A way that is longer than the number of nodes goes in a circle.
         do steps = 1, size(node)
            if (node(leader(i))%like == 0) exit
            leader(i) = node(leader(i))%like
         end do
         if (node(leader(i))%like == 0) cycle
         call messages%add("node '"//trim(node(i)%name)//"' moves with itself, by way of node '"// &
                           trim(node(node(i)%like)%name)//"'; remove one moves_with")
         return
      end do
      do i = 1, size(node)
         if (leader(i) /= i) node(i)%like = leader(i)
         node(leader(i))%held(1) = node(leader(i))%held(1) .or. node(i)%held(1)
      end do
      node%held(1) = node(leader)%held(1)
   end subroutine find_leaders

   !> Refuse floors without nodes, and those that are not above the floor before.
   subroutine check_floors(node, messages)
      type(frame_node), intent(in) :: node(:)
      type(message_list), intent(inout) :: messages
      integer :: i

      ! Without floors above the base there is nothing to check.
      if (all(node%storey < 1)) return
      do i = 0, maxval(node%storey)
         if (all(node%storey /= i)) then
            call messages%add('floor '//to_text(i)//' has no node; give nodes their floors from 0, the '// &
                              'base, up')
         else if (i > 0) then
            if (maxval(node%y, mask=node%storey == i) <= maxval(node%y, mask=node%storey == i - 1)) then
               call messages%add('floor '//to_text(i)//' is not above floor '//to_text(i - 1)// &
                                 '; give nodes their floors from the base up')
            end if
         end if
      end do
   end subroutine check_floors

   !> Whether members end in each of the nodes.
   pure function end_nodes(nodes, members, beams, unpinned, dead_load) result(ends)
      type(frame_node), intent(in) :: nodes(:)
      type(frame_member), intent(in) :: members(:)
      !> Count beams alone if true, columns alone if false; by default both
      logical, intent(in), optional :: beams
      !> If present, whatever their values: leave out members that are pinned; those that are built after the
      !> dead load
      logical, intent(in), optional :: unpinned, dead_load
      logical :: ends(size(nodes))
      integer :: i

      ends = .false.
      do i = 1, size(members)
         associate (ends_at => members(i)%node)
            ! A node that was not found
            if (any(ends_at == 0)) cycle
            if (present(unpinned) .and. members(i)%pinned) cycle
            if (present(dead_load) .and. members(i)%after_dead_load) cycle
            if (present(beams)) then
               if (is_beam(nodes(ends_at(1)), nodes(ends_at(2))) .neqv. beams) cycle
            end if
            ends(ends_at) = .true.
         end associate
      end do
   end function end_nodes

   !> Hold the nodes of a grid whose members are left out: nothing is there.
   subroutine hold_idle(nodes, members, grid_nodes)
      type(frame_node), intent(inout) :: nodes(:)
      type(frame_member), intent(in) :: members(:)
      !> Number of nodes of the grid, which come first
      integer, intent(in) :: grid_nodes
      logical :: has_member(size(nodes))
      integer :: i

      has_member = end_nodes(nodes, members)
      do i = 1, size(nodes)
         if (i > grid_nodes .or. has_member(i)) cycle
         nodes(i)%held = .true.
         nodes(i)%ground%rule = ''
      end do
   end subroutine hold_idle

   !> Hold the rotation of nodes in which every member is pinned: nothing else would.
   subroutine hold_between_pins(nodes, members)
      type(frame_node), intent(inout) :: nodes(:)
      type(frame_member), intent(in) :: members(:)
      logical :: turned(size(nodes))
      integer :: i

      turned = end_nodes(nodes, members, unpinned=.true.)
      do i = 1, size(nodes)
         ! A spring from the ground resists the rotation.
         if (turned(i) .or. nodes(i)%ground(3)%rule /= '') cycle
         nodes(i)%held(3) = .true.
      end do
   end subroutine hold_between_pins

   !> Refuse nodes at one place, nodes without a member, nodes joined only by members that are built after the
   !> dead load, loads on displacements that are held, and members between the same nodes.
   subroutine check_geometry(nodes, members, grid_nodes, grid_members, messages)
      type(frame_node), intent(in) :: nodes(:)
      type(frame_member), intent(in) :: members(:)
      !> How many nodes and members the grid has, which come first
      integer, intent(in) :: grid_nodes, grid_members
      type(message_list), intent(inout) :: messages
      real(wp) :: near
      !> Whether a member ends in a node, and whether one that carries dead load does
      logical :: has_member(size(nodes)), is_carried(size(nodes))
      integer :: i, j

      has_member = end_nodes(nodes, members)
      is_carried = end_nodes(nodes, members, dead_load=.true.)
      near = same_input*(maxval(nodes%x) - minval(nodes%x) + maxval(nodes%y) - minval(nodes%y))
      do i = 1, size(nodes)
         associate (node => nodes(i))
            ! Nodes of the grid are apart.
            do j = 1, merge(i - 1, 0, i > grid_nodes)
               if (node%plane /= nodes(j)%plane) cycle
               if (hypot(node%x - nodes(j)%x, node%y - nodes(j)%y) > near) cycle
               ! A hinge between two parts, or the feet of parts that stand behind each other
               if (leader_of(nodes, i) == leader_of(nodes, j)) cycle
               if (all(node%held(:2)) .and. all(nodes(j)%held(:2))) cycle
               call messages%add('nodes '//trim(nodes(j)%name)//' and '//trim(node%name)// &
                                 ' are at one place; move one of them, use one in place of both, or '// &
                                 'tie them by moves_with')
            end do
            ! A grid has nodes where members are left out. `hold_idle` holds them, so that only a mass is a
            ! fault.
            if (.not. has_member(i) .and. (i > grid_nodes .or. any(node%mass > 0.0_wp))) then
               call messages%add("node '"//trim(node%name)//"' has no member; connect it, or remove it")
            else if (has_member(i) .and. .not. is_carried(i) .and. &
                     .not. all(node%held .or. node%ground%rule /= '')) then
               call messages%add("node '"//trim(node%name)//"' is joined by nothing but members that are "// &
                                 'built after the dead load; give it a support, or join it to the others')
            end if
            ! Between pins alone the rotation is held; see `hold_between_pins`.
            if (node%held(3) .and. abs(node%load(3)) > 0.0_wp .and. .not. all(node%held)) then
               call messages%add("node '"//trim(node%name)//"' does not turn, and its load_moment does "// &
                                 'nothing; remove it, or join a member that is not pinned')
            else if (all(node%held) .and. any(abs(node%load) > 0.0_wp)) then
               call messages%add("node '"//trim(node%name)//"' is held, "//'and its load does nothing; '// &
                                 'remove the load, or free the node')
            end if
         end associate
      end do
      ! Members of the grid join different nodes.
      do i = grid_members + 1, size(members)
         do j = 1, i - 1
            ! A jacket is beside its column, and is built later.
            if (members(i)%after_dead_load .neqv. members(j)%after_dead_load) cycle
            if (any(members(i)%node /= members(j)%node) .and. &
                any(members(i)%node([2, 1]) /= members(j)%node)) cycle
            call messages%add('members '//trim(members(j)%name)//' and '//trim(members(i)%name)// &
                              ' join the same two nodes; remove one')
         end do
      end do
   end subroutine check_geometry

   !> Refuse frames that nothing holds, those all of whose nodes are held, and those of several parts.
   subroutine check_held(nodes, members, messages)
      type(frame_node), intent(in) :: nodes(:)
      type(frame_member), intent(in) :: members(:)
      type(message_list), intent(inout) :: messages
      integer :: i

      if (all([(all(nodes(i)%held), i=1, size(nodes))])) then
         call messages%add('frame: every node is held, and nothing can move; free one of them')
      else if (.not. any([(any(nodes(i)%held) .or. any(nodes(i)%ground%rule /= ''), &
                           i=1, size(nodes))])) then
         call messages%add('frame: nothing holds it; give nodes a support, or springs to the ground')
      end if
      call check_tied(nodes, members, end_nodes(nodes, members), messages)
   end subroutine check_held

   !> Refuse parts that neither a member nor a common motion ties: one would carry all of the lateral load,
   !> the other none.
   subroutine check_tied(nodes, members, has_member, messages)
      type(frame_node), intent(in) :: nodes(:)
      type(frame_member), intent(in) :: members(:)
      !> Whether a member ends in a node (nodes)
      logical, intent(in) :: has_member(:)
      type(message_list), intent(inout) :: messages
      !> Part of each node, as the number of one of its nodes
      integer :: part(size(nodes)), i, first, other
      logical :: moved

      part = [(leader_of(nodes, i), i=1, size(part))]
      moved = .true.
      ! A member makes one part of two, until nothing changes.
      do while (moved)
         moved = .false.
         do i = 1, size(members)
            associate (ends => members(i)%node)
               if (part(ends(1)) == part(ends(2))) cycle
               first = minval(part(ends))
               other = maxval(part(ends))
               where (part == other) part = first
               moved = .true.
            end associate
         end do
      end do
      first = findloc(has_member, .true., dim=1)
      if (first == 0) return
      ! Nodes without a member count for nothing.
      other = findloc(has_member .and. part /= part(first), .true., dim=1)
      if (other == 0) return
      call messages%add('frame: nodes '//trim(nodes(first)%name)//' and '//trim(nodes(other)%name)// &
                        ' are of parts that nothing ties, so that one would carry all of the load; join '// &
                        'them by a member, or let a node of one move with one of the other (moves_with)')
   end subroutine check_tied

   !> The node whose displacement along x a node shares: the one that was given or, in a building, the first
   !> of its floor, else itself.
   pure integer function leader_of(nodes, node) result(leader)
      !> Number of the node
      type(frame_node), intent(in) :: nodes(:)
      integer, intent(in) :: node

      leader = nodes(node)%like
      if (nodes(node)%follows_floor()) then
         leader = findloc(nodes%follows_floor() .and. nodes%storey == nodes(node)%storey, &
                          .true., dim=1)
      end if
      if (leader == 0) leader = node
   end function leader_of

end module rbs_structure_frame_connections
