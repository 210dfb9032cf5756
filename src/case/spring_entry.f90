!> Springs as given in the input: each once, with the joints that have it or the layers that refer to it.
module rbs_case_spring_entry
   use rbs_base_check, only: check_name
   use rbs_base_constants, only: unset_integer
   use rbs_base_error, only: message_list
   use rbs_base_key_visitor, only: key_visitor
   use rbs_base_keys, only: key_type, above_zero, any_number, not_negative, one_or_more
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_structure_column_column_record, only: column_record, most_bodies
   use rbs_hysteresis_registry, only: rule_names, suits
   use rbs_hysteresis_rule, only: in_layer
   use rbs_hysteresis_spring_record, only: spring_record
   use rbs_structure_frame_frame_record, only: frame_record, frame_spring
   implicit none
   private

   public :: spring_entry, entry_list, place_springs, give_springs

   !> Most layers of a joint.
   integer, parameter :: most_layers = 10000

   !> Most positions of a spring in a member.
   integer, parameter :: most_positions = 20

   !> The groups that give springs.
   character(len=16), parameter, public :: spring_groups(5) = [character(len=16) :: &
      'shear', 'flexure', 'axial_spring', 'layer_spring', 'layers']

   !> The groups that describe layers of joints, and are no springs of joints themselves.
   character(len=16), parameter :: layer_groups(2) = spring_groups(4:)

   !> One of these groups: a spring of a joint, a spring of layers, or the layers of joints.
   type, extends(frame_spring) :: spring_entry
      !> For messages: 'case.nml line 4: ' or blank
      character(len=80) :: where = ''
      !> Joints that have the spring; not allocated: all joints that no other group names
      integer, allocatable :: joint(:)
      !> Number by which layers refer to the spring
      integer :: id = unset_integer
      !> Distances of layers [m], and their springs
      real(wp), allocatable :: y(:)
      integer, allocatable :: layer(:)
   contains
      procedure :: visit, set_rule
   end type spring_entry

   type :: entry_list
      integer :: count = 0
      type(spring_entry), allocatable :: entry(:)
   contains
      procedure :: add
   end type entry_list

contains

   !> Append an empty entry.
   subroutine add(self, group, where, line)
      class(entry_list), intent(inout) :: self
      !> One of `spring_groups`; location for messages, 'case.nml line 4:', or blank
      character(len=*), intent(in) :: group, where
      !> Line of the file in which the group begins, 0 without a file
      integer, intent(in) :: line
      type(spring_entry), allocatable :: longer(:)

      if (.not. allocated(self%entry)) allocate (self%entry(8))
      if (self%count == size(self%entry)) then
         allocate (longer(2*self%count))
         longer(:self%count) = self%entry
         call move_alloc(longer, self%entry)
      end if
      self%count = self%count + 1
      self%entry(self%count)%group = group
      self%entry(self%count)%where = where
      self%entry(self%count)%spring%line = line
   end subroutine add

   !> The keys of a spring, or of the layers of joints.
   subroutine visit(self, v, rule_keys)
      class(spring_entry), intent(inout) :: self
      type(key_visitor), intent(inout) :: v
      !> Keys of the rule
      type(key_type), intent(in) :: rule_keys(:)

      if (self%group == 'layer_spring') then
         call v%key('id', self%id, '', above_zero, 'number by which layers refer to the spring')
      else
         call v%key('joint', self%joint, '', not_negative, &
                    'joints that have this spring, from 1 up, 0 beneath a footing, n + 1 at a fixed '// &
                    'top; without it all from 1 that are not named', most_bodies)
      end if
      if (self%group /= 'layer_spring') then
         call v%word('kind', self%kind, 'frame: the kind of members that has the spring')
         call v%key('position', self%position, '', not_negative, 'frame: where in a member, in shares of '// &
                    'its clear length; without it flexure at both ends', most_positions)
      end if
      if (self%group /= 'layer_spring' .and. self%group /= 'layers') then
         call v%word('node', self%node, "frame: node that it holds to the ground, or 'base'")
         call v%word('panel', self%panel, 'frame, flexure: node whose columns it connects with its '// &
                     "beams, or 'all' where both meet")
      end if
      if (self%group == 'layers') then
         call v%key('y', self%y, 'm', any_number, 'distances from the middle of the section, '// &
                    'positive where positive rotation opens', most_layers, required=.true.)
         call v%key('spring', self%layer, '', one_or_more, 'id of the spring of each layer', most_layers, &
                    required=.true.)
      else
         call v%word('rule', self%spring%rule, 'name of the rule', '', required=.true.)
         call v%parameters(rule_keys, self%spring%value)
      end if
   end subroutine visit

   !> Set the rule. A name that is too long ends with the mark ~, so that its start is not taken for a rule.
   subroutine set_rule(self, name)
      class(spring_entry), intent(inout) :: self
      character(len=*), intent(in) :: name

      self%spring%rule = name
      if (len_trim(name) > len(self%spring%rule)) self%spring%rule(len(self%spring%rule):) = '~'
   end subroutine set_rule

   !> Give the springs to the kinds of members of a frame and to its nodes, layered ones with their layers;
   !> refuse layers that belong to no spring.
   subroutine give_springs(list, frame, messages)
      type(entry_list), intent(in) :: list
      type(frame_record), intent(inout) :: frame
      type(message_list), intent(inout) :: messages
      type(frame_spring), allocatable :: spring(:)
      integer :: i, j, n, known

      call frame%open_group('')
      known = messages%count
      call check_ids(list, messages)
      allocate (spring(count([(all(list%entry(i)%group /= layer_groups), i=1, list%count)])))
      n = 0
      do i = 1, list%count
         associate (entry => list%entry(i))
            if (allocated(entry%joint)) then
               call messages%add_at(entry%where, '&'//trim(entry%group)//' has joint, but joints of a '// &
                                    'frame belong to its members; give kind and position')
            end if
            if (entry%group == 'layers' .and. messages%count == known) then
               do j = 1, list%count
                  if (list%entry(j)%group == 'flexure' .and. list%entry(j)%spring%rule == 'layered' .and. &
                      are_of(entry, list%entry(j))) exit
               end do
               if (j > list%count) then
                  call messages%add_at(entry%where, '&layers belong to no &flexure with rule = '// &
                                       "'layered' and the same kind and position; give it these, or "// &
                                       'remove the layers')
               end if
            end if
            if (any(entry%group == layer_groups)) cycle
            n = n + 1
            spring(n) = entry%frame_spring
            if (entry%spring%rule /= 'layered' .or. messages%count > known) cycle
            ! The layers with the same kind of members and positions; of several the last.
            do j = list%count, 1, -1
               if (list%entry(j)%group == 'layers' .and. are_of(list%entry(j), entry)) exit
            end do
            if (j > 0) call set_layers(list, spring(n)%spring, list%entry(j), messages)
         end associate
      end do
      call move_alloc(spring, frame%spring)
   end subroutine give_springs

   !> Whether layers belong to a spring of a frame: both have the same kind of members and positions.
   pure logical function are_of(layers, spring)
      type(spring_entry), intent(in) :: layers, spring

      are_of = layers%kind == spring%kind .and. (allocated(layers%position) .eqv. allocated(spring%position))
      if (.not. are_of .or. .not. allocated(layers%position)) return
      are_of = size(layers%position) == size(spring%position)
      if (are_of) are_of = .not. any(abs(layers%position - spring%position) > 0.0_wp)
   end function are_of

   !> Give the springs to the joints of a column. A drawn column may have those beneath its footing alone.
   subroutine place_springs(list, column, drawn, messages)
      type(entry_list), intent(in) :: list
      type(column_record), intent(inout) :: column
      !> Whether the case has a drawing, of which the other springs are made
      logical, intent(in) :: drawn
      type(message_list), intent(inout) :: messages
      !> Numbers of the lowest and the uppermost joint, and the same for messages
      integer :: first, last, known, i
      character(len=40) :: range
      logical :: numbered

      column%footing = .false.
      do i = 1, list%count
         if (.not. allocated(list%entry(i)%joint)) cycle
         column%footing = column%footing .or. any(list%entry(i)%joint == 0)
      end do
      ! A spring of joint 0 means a footing.
      first = merge(0, 1, column%footing)
      last = column%joint_number(column%joints())
      range = to_text(first)//' to '//trim(merge('n + 1', 'n    ', column%top == 'fixed'))//' = '// &
              to_text(last)
      known = messages%count
      call refuse_frame()
      call check_ids(list, messages)
      ! Layers are placed only if the numbers of their springs are sound.
      numbered = messages%count == known
      call place_group('shear', column%shear)
      call place_group('flexure', column%flexure)
      if (numbered .and. allocated(column%flexure)) call place_layers(column%flexure)
      call place_group('axial_spring', column%axial_spring)

   contains

      !> Find the entry of a group for each joint: the one that names it, or the one without joints.
      subroutine assign(group, of_joint, rest)
         character(len=*), intent(in) :: group
         !> Of each joint the entry that names it, 0: none; the entry for all other joints, 0: none
         integer, intent(out) :: of_joint(first:), rest
         integer :: i, j

         of_joint = 0
         rest = 0
         do i = 1, list%count
            associate (entry => list%entry(i))
               if (entry%group /= group) cycle
               if (.not. allocated(entry%joint)) then
                  if (rest > 0) call twice(entry, list%entry(rest), group)
                  rest = i
                  cycle
               end if
               do j = 1, size(entry%joint)
                  if (entry%joint(j) < first .or. entry%joint(j) > last) then
                     call messages%add_at(entry%where, '&'//group//' has joint = '// &
                                          to_text(entry%joint(j))//'; joints are '//trim(range))
                  else if (of_joint(entry%joint(j)) > 0) then
                     call twice(entry, list%entry(of_joint(entry%joint(j))), group, entry%joint(j))
                  else
                     of_joint(entry%joint(j)) = i
                  end if
               end do
            end associate
         end do
      end subroutine assign

      !> Give springs of one kind to the joints: one for all joints, or one for each.
      subroutine place_group(group, springs)
         character(len=*), intent(in) :: group
         type(spring_record), allocatable, intent(out) :: springs(:)
         integer :: of_joint(first:max(last, 1)), i, rest, before

         before = messages%count
         call assign(group, of_joint, rest)
         if (messages%count > before .or. (all(of_joint == 0) .and. rest == 0)) return
         if (all(of_joint == 0) .and. first > 0) then
            springs = [list%entry(rest)%spring]
            return
         end if
         if (drawn .and. first == 0 .and. rest == 0) then
            ! Only the joint beneath the footing has a spring.
            if (count(of_joint > 0) == 1 .and. of_joint(0) > 0) then
               springs = [list%entry(of_joint(0))%spring]
               return
            end if
         end if
         ! The first joint that no entry names.
         i = findloc(of_joint, 0, dim=1) + first - 1
         if (i == 0 .and. first == 0) then
            call messages%add('the column stands on a footing, but there is no &'//group// &
                              ' with joint = 0; give the footing one')
         else if (i >= first .and. rest == 0) then
            call messages%add('joint '//to_text(i)//' has no &'//group// &
                              '; give it one, or one without joint, which is for all others')
         else
            allocate (springs(last - first + 1))
            do i = first, last
               springs(i - first + 1) = list%entry(merge(of_joint(i), rest, of_joint(i) > 0))%spring
            end do
         end if
      end subroutine place_group

      !> Give the layers to the layered springs of flexure.
      subroutine place_layers(springs)
         type(spring_record), allocatable, intent(inout) :: springs(:)
         type(spring_record) :: one
         integer :: of_joint(first:max(last, 1)), i, k, rest, made, line

         ! Which entry has the layers of each joint, and which is for all other joints.
         known = messages%count
         call assign('layers', of_joint, rest)
         if (messages%count > known) return
         ! One spring for all joints becomes one for each where the layers of some are their own.
         if (any(of_joint > 0) .and. size(springs) == 1) then
            one = springs(1)
            deallocate (springs)
            allocate (springs(last - first + 1))
            do i = 1, size(springs)
               springs(i) = one
            end do
         end if
         where (of_joint == 0) of_joint = rest
         do k = 1, list%count
            if (list%entry(k)%group /= 'layers') cycle
            made = 0
            do i = 1, size(springs)
               if (of_joint(first + i - 1) /= k .or. springs(i)%rule /= 'layered') cycle
               ! The first spring of an entry gets its layers; the others are copies of it.
               if (made == 0) then
                  made = i
                  call set_layers(list, springs(i), list%entry(k), messages)
               else
                  line = springs(i)%line
                  springs(i) = springs(made)
                  springs(i)%line = line
               end if
            end do
            if (made > 0) cycle
            call messages%add_at(list%entry(k)%where, '&layers belong to no flexural spring with '// &
                                 "rule = 'layered'; remove them, or choose that rule for the spring")
         end do
      end subroutine place_layers

      !> Refuse keys that only springs of frames have.
      subroutine refuse_frame()
         integer :: i

         do i = 1, list%count
            associate (entry => list%entry(i))
               if (entry%kind == '' .and. entry%node == '' .and. entry%panel == '' .and. &
                   .not. allocated(entry%position)) cycle
               call messages%add_at(entry%where, '&'//trim(entry%group)//': kind, position, node and '// &
                                    'panel belong to springs of a frame; give joint, or a group &frame')
            end associate
         end do
      end subroutine refuse_frame

      !> Report two springs for one joint.
      subroutine twice(entry, first, group, joint)
         !> The second entry, and the one before it
         type(spring_entry), intent(in) :: entry, first
         character(len=*), intent(in) :: group
         !> Number of the joint; without it both entries are for all other joints
         integer, intent(in), optional :: joint
         character(len=:), allocatable :: text

         text = '&'//group
         if (present(joint)) then
            text = text//' for joint = '//to_text(joint)
         else
            text = text//' without joint'
         end if
         text = text//' appears twice'
         if (first%where /= '') text = text//', first at '//first%where(:len_trim(first%where) - 1)
         call messages%add_at(entry%where, text//'; remove one')
      end subroutine twice

   end subroutine place_springs

   !> Check the springs of layers: each number must belong to one spring, which must have a rule.
   subroutine check_ids(list, messages)
      type(entry_list), intent(in) :: list
      type(message_list), intent(inout) :: messages
      character(len=:), allocatable :: name
      integer :: i, j, kind

      do i = 1, list%count
         if (list%entry(i)%group /= 'layer_spring') cycle
         name = trim(adjustl(trim(list%entry(i)%where)//' &layer_spring: '))
         if (.not. any(rule_names == list%entry(i)%spring%rule)) then
            call check_name(list%entry(i)%spring%rule, pack(rule_names, suits(rule_names, in_layer)), &
                            name//' rule', messages, kind)
         end if
         if (list%entry(i)%id < 1) then
            call messages%add(name//' id is missing; give each spring of layers a number of its own')
            cycle
         end if
         do j = 1, i - 1
            if (list%entry(j)%group /= 'layer_spring' .or. list%entry(j)%id /= list%entry(i)%id) cycle
            call messages%add_at(list%entry(i)%where, '&layer_spring with id = '// &
                                 to_text(list%entry(i)%id)//' appears twice; give each a number of its own')
            exit
         end do
      end do
   end subroutine check_ids

   !> Copy layers, with the springs of the list that they refer to, into a layered spring.
   subroutine set_layers(list, spring, layers, messages)
      type(entry_list), intent(in) :: list
      type(spring_record), intent(inout) :: spring
      !> Entry of the group &layers
      type(spring_entry), intent(in) :: layers
      type(message_list), intent(inout) :: messages
      type(spring_record), allocatable :: springs(:)
      integer :: i, j

      if (.not. allocated(layers%y) .or. .not. allocated(layers%layer)) then
         call messages%add_at(layers%where, '&layers needs y and spring, one value of each for each layer')
         return
      else if (size(layers%y) /= size(layers%layer)) then
         call messages%add_at(layers%where, '&layers has '//to_text(size(layers%y))//' values of y and '// &
                              to_text(size(layers%layer))//' of spring; give one of each for each layer')
         return
      end if
      allocate (springs(size(layers%y)))
      do i = 1, size(layers%y)
         do j = 1, list%count
            if (list%entry(j)%group == 'layer_spring' .and. list%entry(j)%id == layers%layer(i)) exit
         end do
         if (j > list%count) then
            call messages%add_at(layers%where, '&layers: there is no &layer_spring with id = '// &
                                 to_text(layers%layer(i))//'; add it, or correct spring')
            return
         end if
         springs(i) = list%entry(j)%spring
      end do
      call spring%set_layers(layers%y, springs)
      spring%places_line = layers%spring%line
   end subroutine set_layers

end module rbs_case_spring_entry
