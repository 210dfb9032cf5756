!> A building from the input: planes of its nodes, rigid floors, and columns that stand in two planes.
module rbs_structure_frame_plan_parts
   use rbs_base_check, only: is_given
   use rbs_base_error, only: message_list
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_hysteresis_rule, only: rule_type
   use rbs_structure_frame_frame_checks, only: check_reference
   use rbs_structure_frame_frame_record, only: frame_record
   use rbs_structure_frame_new_frame, only: frame_node, frame_member
   use rbs_structure_frame_plan, only: floor_plan, cosine_sine
   use rbs_structure_spring_location, only: layer
   implicit none
   private

   public :: put_planes, put_second_planes

   !> Least flexibility along its axis of the rest of a column in two planes, as a share of the whole.
   real(wp), parameter :: least_rest = 0.01_wp

contains

   !> Put nodes on the planes of a building, and lay out its floors; refuse what only a planar frame can have,
   !> or only a building.
   subroutine put_planes(nodes, plan, on_grid, record, messages)
      type(frame_node), intent(inout) :: nodes(:)
      type(floor_plan), intent(inout) :: plan
      !> Whether the frame has a grid
      logical, intent(in) :: on_grid
      type(frame_record), intent(in) :: record
      type(message_list), intent(inout) :: messages
      integer :: i, known

      known = messages%count
      if (size(record%plane) == 0) then
         do i = 1, size(record%node)
            if (record%node(i)%plane == '' .and. record%node(i)%rises_with == '') cycle
            call messages%add("node '"//trim(record%node(i)%name)//"': plane and rises_with belong to a "// &
                              'building, and no group &plane is given; give one for each frame of it')
            return
         end do
         if (any(record%floor%inertia > 0.0_wp) .or. abs(record%direction) > 0.0_wp) then
            call messages%add('frame: inertia of floors and direction belong to a building, and no group '// &
                              '&plane is given; remove them, or give a plane for each frame')
         end if
         return
      end if
      if (on_grid .or. record%diaphragm) then
         call messages%add('frame: storeys, bays and diaphragm are of a planar frame; the nodes of a '// &
                           'building have x, y, floor and plane of their own')
      end if
      if (record%control == 'y') call messages%add("frame: control = 'y' is of a planar frame; remove it")
      call put_on_planes(nodes, record, messages)
      if (messages%count > known) return
      do i = 1, size(nodes)
         associate (node => nodes(i), with => nodes(i)%rises_like)
            if (with > 0) then
               if (node%held(2) .neqv. nodes(with)%held(2)) then
                  call messages%add("node '"//trim(node%name)//"' rises with node '"// &
                                    trim(nodes(with)%name)//"', and a support holds one of them "// &
                                    'alone; give both the same')
               end if
            end if
            if (node%held(1) .and. node%follows_floor()) then
               call messages%add("node '"//trim(node%name)//"' is held along x, and would hold its "// &
                                 'floor; remove the support, or its floor')
            end if
         end associate
      end do
      call lay_floors(nodes, plan, record, messages)
   end subroutine put_planes

   !> Put nodes on their planes, and note the nodes that they rise with.
   subroutine put_on_planes(nodes, record, messages)
      type(frame_node), intent(inout) :: nodes(:)
      type(frame_record), intent(in) :: record
      type(message_list), intent(inout) :: messages
      integer :: i, number, with

      do i = 1, size(record%node)
         associate (given => record%node(i), name => "node '"//trim(record%node(i)%name)//"'")
            number = findloc(nodes%name == given%name, .true., dim=1)
            if (number == 0) cycle
            call check_reference(given%plane, [record%plane%name], name//': plane', 'plane', messages)
            nodes(number)%plane = findloc(record%plane%name == given%plane, .true., dim=1)
            if (given%moves_with /= '') then
               call messages%add(name//': moves_with is of a planar frame; in a building nodes of a '// &
                                 'floor move with it')
            end if
            if (given%rises_with == '') cycle
            call check_reference(given%rises_with, [nodes%name], name//': rises_with', 'node', messages)
            with = findloc(nodes%name == given%rises_with, .true., dim=1)
            ! Names that were not found have their messages.
            if (with == 0) cycle
            if (with == number .or. record%node(findloc(record%node%name == given%rises_with, .true., &
                                                        dim=1))%rises_with /= '') then
               call messages%add(name//": rises_with = '"//trim(given%rises_with)//"' rises with another "// &
                                 'node itself; name that one')
               cycle
            end if
            nodes(number)%rises_like = with
         end associate
      end do
   end subroutine put_on_planes

   !> Lay out the floors: their masses, and the shares of their motion in that of each plane.
   subroutine lay_floors(nodes, plan, record, messages)
      type(frame_node), intent(in) :: nodes(:)
      type(floor_plan), intent(inout) :: plan
      type(frame_record), intent(in) :: record
      type(message_list), intent(inout) :: messages
      !> Number of a floor that is free to move; direction of a plane; centres of mass of the floors (2,
      !> floors) [m]
      integer :: i, j, free
      real(wp) :: along(2)
      real(wp), allocatable :: centre(:, :)

      associate (floors => max(0, maxval(nodes%storey)))
         if (floors == 0) then
            call messages%add('frame: a building has floors, and no node names one; give nodes their floors')
            return
         end if
         allocate (plan%share(3, size(record%plane), floors))
         allocate (centre(2, floors), source=0.0_wp)
         allocate (plan%mass(floors), plan%inertia(floors), source=0.0_wp)
         do i = 1, size(record%plane)
            if (any(nodes%plane == i .and. nodes%storey > 0)) cycle
            call messages%add("plane '"//trim(record%plane(i)%name)//"' has no node on a floor; remove it")
         end do
         do i = 1, size(record%floor)
            associate (floor => record%floor(i))
               if (floor%floor > floors) then
                  call messages%add('floor: floor = '//to_text(floor%floor)//', but the building has '// &
                                    to_text(floors)//' floors; correct it, or give 0 for all')
               else if (floor%floor > 0) then
                  plan%mass(floor%floor) = floor%mass
                  plan%inertia(floor%floor) = floor%inertia
                  centre(:, floor%floor) = [floor%centre_x, floor%centre_y]
               else
                  plan%mass = floor%mass
                  plan%inertia = floor%inertia
                  centre = spread([floor%centre_x, floor%centre_y], 2, floors)
               end if
               if (floor%is_loaded()) then
                  call messages%add('floor: dead_load acts on the beams of a grid, and a building has '// &
                                    'none; give it to its members as load')
               end if
            end associate
         end do
         do i = 1, size(record%plane)
            along = cosine_sine(record%plane(i)%angle)
            do j = 1, floors
               plan%share(:, i, j) = [along, record%plane(i)%arm - &
                                           (centre(1, j)*along(2) - centre(2, j)*along(1))]
            end do
         end do
         plan%is_there = reshape([((any(nodes%plane == i .and. nodes%storey == j), &
                                    i=1, size(record%plane)), j=1, floors)], [size(record%plane), floors])
      end associate
      plan%direction(:2) = cosine_sine(record%direction)
      plan%by_nodes = record%pattern == 'nodes'
      call plan%hold_free(free)
      if (free > 0) then
         call messages%add('floor '//to_text(free)//': the planes leave it free to turn, or to move; '// &
                           'give planes in another direction, or at other distances from the centre of mass')
      else if (any(plan%held .and. abs(plan%direction) > 0.0_wp)) then
         call messages%add('frame: direction = '//to_text(record%direction)//' has a part along '// &
                           merge('x', 'y', plan%held(1) .and. abs(plan%direction(1)) > 0.0_wp)// &
                           ', in which no plane of the building resists it; choose another one')
      end if
   end subroutine lay_floors

   !> Note columns that stand in two planes: the member of the second names that of the first.
   subroutine put_second_planes(nodes, members, record, messages)
      type(frame_node), intent(in) :: nodes(:)
      type(frame_member), intent(inout) :: members(:)
      type(frame_record), intent(in) :: record
      type(message_list), intent(inout) :: messages
      !> Numbers of the member, and of the one that is the same column in the first plane
      integer :: i, number, with
      logical :: is_lost

      do i = 1, size(record%member)
         associate (given => record%member(i), name => 'member '//trim(record%member(i)%name))
            if (given%axial_of == '') cycle
            call check_reference(given%axial_of, [members%name], name//': axial_of', 'member', messages)
            number = findloc(members%name == given%name, .true., dim=1)
            with = findloc(members%name == given%axial_of, .true., dim=1)
            ! A name that was not found has its message.
            if (with == 0) cycle
            if (with == number .or. record%member(with)%axial_of /= '' .or. &
                any(members(:number - 1)%axial_of == with)) then
               call messages%add(name//": axial_of = '"//trim(given%axial_of)//"' is no column of one "// &
                                 'other plane; a column has two planes, of which the first has none')
               cycle
            end if
            associate (a => members(number)%node, b => members(with)%node)
               if (any(nodes(a)%plane == nodes(b)%plane) .or. any(nodes(a)%rises_like /= b .and. &
                   .not. (nodes(a)%held(2) .and. nodes(b)%held(2)))) then
                  call messages%add(name//": axial_of = '"//trim(given%axial_of)//"' is a column between "// &
                                    'other nodes; their nodes rise together (rises_with)')
                  cycle
               end if
            end associate
            associate (both => members([number, with]))
               is_lost = any(is_given([both%lost_at, both%failure_drift]))
            end associate
            if (is_lost) then
               call messages%add('member '//trim(given%name)//' is a column in two planes, and these '// &
                                 'cannot be lost; leave out its group &loss, and failure_drift of its kind')
               cycle
            end if
            members(number)%axial_of = with
            ! Springs that were made for a length have their part of its E A.
            associate (kinds => members([with, number])%kind_of)
               if (all(is_given(record%kind(kinds)%length))) call join_rests(nodes, members, [with, number])
            end associate
         end associate
      end do
   end subroutine put_second_planes

   !> Let a column in two planes be as stiff along its axis as its members are alone, in the mean of both: its
   !> elastic rest is stiffer by the joints of the other plane, which shorten in series with its own.
   subroutine join_rests(nodes, members, of)
      type(frame_node), intent(in) :: nodes(:)
      type(frame_member), intent(inout) :: members(:)
      !> Numbers of its members in the first plane, whose rest is the column's, and in the second one
      integer, intent(in) :: of(2)
      !> Clear length [m]; length per E A of the rests, and how far joints close per force [m/N]
      real(wp) :: clear(2), rest(2), closes(2)
      integer :: i

      do i = 1, 2
         associate (m => members(of(i)), ends => nodes(members(of(i))%node))
            clear(i) = hypot(ends(2)%x - ends(1)%x, ends(2)%y - ends(1)%y) - sum(m%rigid)
            rest(i) = clear(i)/m%axial
            closes(i) = flexibility_of_joints(m)
         end associate
      end do
      if (.not. all(closes > 0.0_wp)) return
      members(of(1))%axial = clear(1)/max(0.5_wp*sum(rest - closes), 0.5_wp*least_rest*sum(rest + closes))
   end subroutine join_rests

   !> How far all virgin joints of layers of a member close per axial force [m/N].
   real(wp) function flexibility_of_joints(m) result(flexible)
      type(frame_member), intent(in) :: m
      class(rule_type), allocatable :: rule
      real(wp) :: k(size(m%kind))
      integer :: i

      k = 0.0_wp
      do i = 1, size(m%kind)
         if (m%kind(i) /= layer) cycle
         call m%spring(i)%make(rule)
         k(m%joint(i)) = k(m%joint(i)) + rule%branch%k
      end do
      flexible = sum(1.0_wp/pack(k, k > 0.0_wp))
   end function flexibility_of_joints

end module rbs_structure_frame_plan_parts
