!> Springs of the joints from the groups of a namelist file.
module rbs_io_namelist_springs
   use rbs_base_error, only: message_list
   use rbs_base_constants, only: unset
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_io_namelist_entry, only: key_type, key, entry_text, location, text_length
   use rbs_io_namelist_group, only: reader, find_groups, check_status, take_text
   use rbs_io_namelist_scan, only: most_messages
   use rbs_base_check, only: check_name
   use rbs_spec_column, only: most_bodies
   use rbs_spec_spring, only: spring_spec
   use rbs_spec_spring_table, only: number_names, number_count, layer_rules, rule_names
   implicit none
   private

   public :: read_springs, read_layers

contains

   !> Springs of the joints: a group with joint = 0 is for every joint that has no group of its own.
   subroutine read_springs(r, name, least, n, springs, messages)
      type(reader), intent(in) :: r
      character(len=*), intent(in) :: name
      !> How many groups the case must have, and number of joints
      integer, intent(in) :: least, n
      type(spring_spec), allocatable, intent(out) :: springs(:)
      type(message_list), intent(inout) :: messages
      type(spring_spec) :: one
      integer, allocatable :: found(:), group_of(:)
      integer :: g, joint, missing

      call find_groups(r, name, least, huge(1), found, messages)
      if (size(found) == 0) return
      if (n < 1 .or. n > most_bodies) then
         ! The number of joints is reported elsewhere; let the first spring stand for all.
         call read_spring(r, name, found(1), joint, one, messages)
         springs = [one]
         return
      end if
      allocate (group_of(0:n), source=0)
      allocate (springs(0:n))
      do g = 1, size(found)
         if (messages%count > most_messages) return
         call read_spring(r, name, found(g), joint, one, messages)
         if (joint < 0 .or. joint > n) then
            call messages%add(location(r%path, r%scanned%group(found(g))%line)//': &'//name// &
                              ' has joint = '//to_text(joint)//'; it is 0 for every joint, or 1 to n = '// &
                              to_text(n))
         else if (group_of(joint) > 0) then
            call messages%add(location(r%path, r%scanned%group(found(g))%line)//': &'//name// &
                              ' for joint = '//to_text(joint)//' stands twice, first on line '// &
                              to_text(r%scanned%group(group_of(joint))%line)//'; remove one')
         else
            group_of(joint) = found(g)
            springs(joint) = one
         end if
      end do
      if (all(group_of(1:) == 0)) then
         springs = [springs(0)]
         return
      end if
      missing = findloc(group_of(1:), 0, dim=1)
      if (missing > 0 .and. group_of(0) == 0) then
         call messages%add(r%path//': joint '//to_text(missing)//' has no &'//name// &
                           '; give it one, or one with joint = 0 for every joint')
      end if
      do joint = 1, n
         if (group_of(joint) == 0) springs(joint) = springs(0)
      end do
      springs = springs(1:)
   end subroutine read_springs

   !> Give the layers of a case to its layered springs: a group with joint = 0 is for all of them.
   subroutine read_layers(r, n, springs, messages)
      type(reader), intent(in) :: r
      !> Number of joints
      integer, intent(in) :: n
      !> Springs of the joints, or one for all; one for each where layers differ
      type(spring_spec), allocatable, intent(inout) :: springs(:)
      type(message_list), intent(inout) :: messages
      type(spring_spec) :: layer
      integer, allocatable :: found(:)
      real(wp) :: column(2 + number_count)
      integer :: g, i, joint, place
      logical :: taken

      call find_groups(r, 'layer', 0, huge(1), found, messages)
      do g = 1, size(found)
         if (messages%count > most_messages) return
         call read_spring(r, 'layer', found(g), joint, layer, messages, column(1))
         call check_name(layer%rule, layer_rules, location(r%path, r%scanned%group(found(g))%line)// &
                         ': &layer: rule', messages, place)
         if (n < 1 .or. n > most_bodies) cycle
         if (joint < 0 .or. joint > n) then
            call messages%add(location(r%path, r%scanned%group(found(g))%line)//': &layer has joint = '// &
                              to_text(joint)//'; it is 0 for every joint, or 1 to n = '//to_text(n))
            cycle
         end if
         if (place == 0) cycle
         column(2) = findloc(rule_names == layer%rule, .true., dim=1)
         column(3:) = layer%numbers()
         if (joint > 0 .and. size(springs) < n) call repeat_spring(springs, n)
         taken = .false.
         do i = 1, size(springs)
            if (springs(i)%rule /= 'layered' .or. (joint /= 0 .and. joint /= i)) cycle
            if (.not. allocated(springs(i)%layers)) allocate (springs(i)%layers(size(column), 0))
            springs(i)%layers = reshape([springs(i)%layers, column], &
                                        [size(column), size(springs(i)%layers, 2) + 1])
            taken = .true.
         end do
         if (.not. taken) then
            call messages%add(location(r%path, r%scanned%group(found(g))%line)//': &layer with joint = '// &
                              to_text(joint)//" belongs to no flexural spring with rule = 'layered'; "// &
                              'remove it, or choose that rule for the spring')
         end if
      end do
   end subroutine read_layers

   !> One spring of its own for each joint, from one for all.
   subroutine repeat_spring(springs, n)
      type(spring_spec), allocatable, intent(inout) :: springs(:)
      integer, intent(in) :: n
      type(spring_spec) :: one
      integer :: i

      one = springs(1)
      deallocate (springs)
      allocate (springs(n))
      do i = 1, n
         springs(i) = one
      end do
   end subroutine repeat_spring

   !> One spring. The names of its numbers are those of the table, so a Fortran namelist is not of use.
   subroutine read_spring(r, name, place, joint, spec, messages, y)
      type(reader), intent(in) :: r
      character(len=*), intent(in) :: name
      !> Number of the group
      integer, intent(in) :: place
      integer, intent(out) :: joint
      type(spring_spec), intent(out) :: spec
      type(message_list), intent(inout) :: messages
      !> Distance of a layer from the middle of the section [m]; only layers have one
      real(wp), intent(out), optional :: y
      type(key_type) :: keys(4 + number_count)
      real(wp) :: numbers(number_count)
      character(len=text_length) :: iomsg
      character(len=:), allocatable :: text
      integer :: i, j, status

      keys(:3) = [key('joint', 'i'), key('rule', 's'), key('inner', 's')]
      do j = 1, number_count
         keys(3 + j) = key(number_names(j), 'r')
      end do
      keys(size(keys)) = key('y', 'r')
      iomsg = ''
      joint = 0
      if (present(y)) y = unset
      numbers = spec%numbers()
      associate (group => r%scanned%group(place))
         do i = group%first, group%last
            call entry_text(r%path, r%scanned, group, i, keys(:merge(4, 3, present(y)) + number_count), &
                            text, messages)
            if (.not. allocated(text)) cycle
            status = 0
            associate (entry => r%scanned%entry(i))
               select case (entry%name)
               case ('joint')
                  read (entry%value(1)%text, *, iostat=status, iomsg=iomsg) joint
               case ('rule')
                  call take_word(r, name//': rule', entry%value(1)%text, spec%rule, messages)
               case ('inner')
                  call take_word(r, name//': inner', entry%value(1)%text, spec%inner, messages)
               case ('y')
                  read (entry%value(1)%text, *, iostat=status, iomsg=iomsg) y
               case default
                  j = findloc(number_names == entry%name, .true., dim=1)
                  read (entry%value(1)%text, *, iostat=status, iomsg=iomsg) numbers(j)
               end select
            end associate
            call check_status(r, i, status, iomsg, messages)
         end do
      end associate
      call spec%set_numbers(numbers)
      call spec%fill_defaults()
   end subroutine read_spring

   !> A quoted text into its place.
   subroutine take_word(r, name, quoted, word, messages)
      type(reader), intent(in) :: r
      character(len=*), intent(in) :: name, quoted
      character(len=16), intent(out) :: word
      type(message_list), intent(inout) :: messages
      character(len=text_length) :: given

      ! List-directed: it takes away the quotes, and the doubled ones within.
      read (quoted, *) given
      call take_text(r, name, given, word, messages)
   end subroutine take_word

end module rbs_io_namelist_springs
