!> Springs as given in the input: each once, with the joints that have it or the layers that refer to it.
module rbs_case_spring_entry
   use rbs_base_check, only: check_name
   use rbs_base_constants, only: unset_integer
   use rbs_base_error, only: message_list
   use rbs_base_key_visitor, only: key_visitor
   use rbs_base_keys, only: key_type, above_zero, any_number, not_negative, one_or_more
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_column_column_record, only: column_record, most_bodies
   use rbs_hysteresis_registry, only: rule_names, suits
   use rbs_hysteresis_rule, only: in_layer
   use rbs_hysteresis_spring_record, only: spring_record
   implicit none
   private

   public :: spring_entry, entry_list, place_springs

   !> Most layers of a joint.
   integer, parameter :: most_layers = 10000

   !> The groups that give springs.
   character(len=16), parameter, public :: spring_groups(5) = [character(len=16) :: &
      'shear', 'flexure', 'axial_spring', 'layer_spring', 'layers']

   !> One group of the input that gives a spring, or the layers of joints.
   type :: spring_entry
      !> 'shear', 'flexure', 'axial_spring', 'layer_spring' or 'layers'
      character(len=16) :: group = ''
      !> For messages: 'case.nml line 4: ' or blank
      character(len=80) :: where = ''
      !> Joints that have the spring; not allocated: all joints that no other group names
      integer, allocatable :: joint(:)
      !> Number by which layers refer to the spring
      integer :: id = unset_integer
      type(spring_record) :: spring
      !> Distances of layers [m], and their springs
      real(wp), allocatable :: y(:)
      integer, allocatable :: layer(:)
   contains
      procedure :: visit
      procedure :: set_rule
   end type spring_entry

   type :: entry_list
      integer :: count = 0
      type(spring_entry), allocatable :: entry(:)
   contains
      procedure :: add
   end type entry_list

contains

   !> Append an empty entry.
   subroutine add(self, group, where)
      class(entry_list), intent(inout) :: self
      character(len=*), intent(in) :: group, where
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
      self%entry(self%count)%spring%line = line_of(where)
   end subroutine add

   !> The number at the end of a place such as 'case.nml line 4:'; 0 without one.
   pure integer function line_of(where) result(line)
      character(len=*), intent(in) :: where
      integer :: first, last, stat

      line = 0
      last = verify(where, ' :', back=.true.)
      if (last == 0) return
      first = verify(where(:last), '0123456789', back=.true.) + 1
      if (first > last) return
      read (where(first:last), *, iostat=stat) line
      if (stat /= 0) line = 0
   end function line_of

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

   !> Set the rule; a name that is too long keeps a mark of that, so that it is not taken for a shorter one.
   subroutine set_rule(self, name)
      class(spring_entry), intent(inout) :: self
      character(len=*), intent(in) :: name

      self%spring%rule = name
      if (len_trim(name) > len(self%spring%rule)) self%spring%rule(len(self%spring%rule):) = '~'
   end subroutine set_rule

   !> Give the springs to the joints of a column.
   subroutine place_springs(list, column, messages)
      type(entry_list), intent(in) :: list
      type(column_record), intent(inout) :: column
      type(message_list), intent(inout) :: messages
      type(entry_list) :: whole
      character(len=40) :: range
      integer :: first, known

      whole = list
      column%footing = any_beneath(list)
      if (list%count > 0) then
         known = messages%count
         call check_ids(list, messages)
         if (messages%count == known) call fill_layers(whole, last_joint(column), messages)
      end if
      first = merge(0, 1, column%footing)
      range = to_text(first)//' to '//trim(merge('n + 1', 'n    ', column%top == 'fixed'))//' = '// &
              to_text(last_joint(column))
      call place_group(whole, 'shear', first, last_joint(column), range, column%shear, messages)
      call place_group(whole, 'flexure', first, last_joint(column), range, column%flexure, messages)
      call place_group(whole, 'axial_spring', first, last_joint(column), range, column%axial_spring, messages)
   end subroutine place_springs

   !> Whether a spring is given for joint 0, beneath a footing.
   pure logical function any_beneath(list)
      type(entry_list), intent(in) :: list
      integer :: i

      any_beneath = .false.
      do i = 1, list%count
         if (.not. allocated(list%entry(i)%joint)) cycle
         any_beneath = any_beneath .or. any(list%entry(i)%joint == 0)
      end do
   end function any_beneath

   !> Number of the uppermost joint: that of the last body, or that of a fixed top.
   pure integer function last_joint(column)
      class(column_record), intent(in) :: column

      last_joint = column%joint_number(column%joints())
   end function last_joint

   !> Check the springs of layers: each number must belong to one spring, which must have a rule.
   subroutine check_ids(list, messages)
      type(entry_list), intent(in) :: list
      type(message_list), intent(inout) :: messages
      character(len=:), allocatable :: name
      integer :: i, j, place

      do i = 1, list%count
         if (list%entry(i)%group /= 'layer_spring') cycle
         name = trim(adjustl(trim(list%entry(i)%where)//' &layer_spring: '))
         if (.not. any(rule_names == list%entry(i)%spring%rule)) then
            call check_name(list%entry(i)%spring%rule, pack(rule_names, suits(rule_names, in_layer)), &
                            name//' rule', messages, place)
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

   !> Give springs of one kind to the joints: one for all joints, or one for each.
   subroutine place_group(list, group, first, last, range, springs, messages)
      type(entry_list), intent(in) :: list
      character(len=*), intent(in) :: group
      !> Numbers of the joints, and the same for messages
      integer, intent(in) :: first, last
      character(len=*), intent(in) :: range
      type(spring_record), allocatable, intent(out) :: springs(:)
      type(message_list), intent(inout) :: messages
      integer :: of_joint(first:max(last, 1)), i, j, rest, known

      if (list%count == 0) return
      if (.not. any(list%entry(:list%count)%group == group)) return
      of_joint = 0
      rest = 0
      known = messages%count
      do i = 1, list%count
         associate (entry => list%entry(i))
            if (entry%group /= group) cycle
            if (.not. allocated(entry%joint)) then
               if (rest > 0) call twice(entry, list%entry(rest), group, messages)
               rest = i
               cycle
            end if
            do j = 1, size(entry%joint)
               if (entry%joint(j) < first .or. entry%joint(j) > last) then
                  call messages%add_at(entry%where, '&'//group//' has joint = '// &
                                       to_text(entry%joint(j))//'; joints are '//trim(range))
               else if (of_joint(entry%joint(j)) > 0) then
                  call twice(entry, list%entry(of_joint(entry%joint(j))), group, messages, entry%joint(j))
               else
                  of_joint(entry%joint(j)) = i
               end if
            end do
         end associate
      end do
      if (messages%count > known) return
      if (all(of_joint == 0) .and. first > 0) then
         springs = [list%entry(rest)%spring]
         return
      end if
      if (of_joint(first) == 0 .and. first == 0) then
         call messages%add('the column stands on a footing, but there is no &'//group// &
                           ' with joint = 0; give the footing one')
         return
      end if
      i = findloc(of_joint, 0, dim=1) + first - 1
      if (i >= first .and. rest == 0) then
         call messages%add('joint '//to_text(i)//' has no &'//group// &
                           '; give it one, or one without joint, which is for all others')
         return
      end if
      allocate (springs(last - first + 1))
      do i = first, last
         springs(i - first + 1) = list%entry(merge(of_joint(i), rest, of_joint(i) > 0))%spring
      end do
   end subroutine place_group

   !> Report two springs for one joint.
   subroutine twice(entry, first, group, messages, joint)
      type(spring_entry), intent(in) :: entry, first
      character(len=*), intent(in) :: group
      type(message_list), intent(inout) :: messages
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

   !> Give the layers to the layered springs of flexure.
   subroutine fill_layers(list, n, messages)
      type(entry_list), intent(inout) :: list
      integer, intent(in) :: n
      type(message_list), intent(inout) :: messages
      type(entry_list) :: made
      integer, allocatable :: named(:), order(:)
      integer :: i, j, k

      if (.not. any(list%entry(:list%count)%group == 'layers')) return
      ! Layers that name their joints before those for the rest.
      order = [pack([(i, i=1, list%count)], [(allocated(list%entry(i)%joint), i=1, list%count)]), &
               pack([(i, i=1, list%count)], [(.not. allocated(list%entry(i)%joint), i=1, list%count)])]
      do k = 1, size(order)
         i = order(k)
         if (list%entry(i)%group /= 'layers') cycle
         made = entry_list()
         call joints_named(list, named)
         do j = 1, list%count
            if (list%entry(j)%group /= 'flexure' .or. list%entry(j)%spring%rule /= 'layered') cycle
            call share_joints(list%entry(j), list%entry(i), n, named, made)
         end do
         if (made%count == 0) then
            call messages%add_at(list%entry(i)%where, '&layers belong to no flexural spring with '// &
                                 "rule = 'layered'; remove them, or choose that rule for the spring")
            cycle
         end if
         do j = 1, made%count
            call set_layers(list, made%entry(j)%spring, list%entry(i), messages)
            call list%add('flexure', made%entry(j)%where)
            list%entry(list%count) = made%entry(j)
         end do
      end do
   end subroutine fill_layers

   !> The joints that flexural springs name.
   subroutine joints_named(list, named)
      type(entry_list), intent(in) :: list
      integer, allocatable, intent(out) :: named(:)
      integer :: i

      allocate (named(0))
      do i = 1, list%count
         if (list%entry(i)%group /= 'flexure' .or. .not. allocated(list%entry(i)%joint)) cycle
         named = [named, list%entry(i)%joint]
      end do
   end subroutine joints_named

   !> Give the joints of a &layers group a copy of their spring, separate from the other joints.
   subroutine share_joints(entry, layers, n, named, made)
      type(spring_entry), intent(inout) :: entry
      type(spring_entry), intent(in) :: layers
      integer, intent(in) :: n
      !> Joints that flexural springs name
      integer, intent(in) :: named(:)
      type(entry_list), intent(inout) :: made
      integer :: i

      if (allocated(entry%spring%y)) return         ! it has its layers already
      call made%add('flexure', entry%where)
      made%entry(made%count) = entry
      if (.not. allocated(layers%joint)) then
         entry%group = 'taken'
      else if (.not. allocated(entry%joint)) then
         ! It is for the joints that no other spring names; what is left of them stays with it.
         made%entry(made%count)%joint = pack(layers%joint, [(all(named /= layers%joint(i)), &
                                                             i=1, size(layers%joint))])
         if (size(made%entry(made%count)%joint) == 0) made%count = made%count - 1
         if (all([(any(named == i) .or. any(layers%joint == i), i=1, n)])) entry%group = 'taken'
      else
         made%entry(made%count)%joint = pack(entry%joint, [(any(layers%joint == entry%joint(i)), &
                                                            i=1, size(entry%joint))])
         entry%joint = pack(entry%joint, [(all(layers%joint /= entry%joint(i)), i=1, size(entry%joint))])
         if (size(entry%joint) == 0) entry%group = 'taken'
         if (size(made%entry(made%count)%joint) == 0) made%count = made%count - 1
      end if
   end subroutine share_joints

   !> Copy the layers into a spring.
   subroutine set_layers(list, spring, layers, messages)
      type(entry_list), intent(in) :: list
      type(spring_record), intent(inout) :: spring
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
                                 to_text(layers%layer(i)))
            return
         end if
         springs(i) = list%entry(j)%spring
      end do
      call spring%set_layers(layers%y, springs)
      spring%places_line = layers%spring%line
   end subroutine set_layers

end module rbs_case_spring_entry
