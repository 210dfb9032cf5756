!> Springs of the joints from the groups of a namelist file.
module rbs_io_namelist_springs
   use rbs_base_error, only: message_list
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_io_namelist_entry, only: key_type, key, entry_text, location, text_length
   use rbs_io_namelist_group, only: reader, find_groups, check_status, take_text
   use rbs_io_namelist_scan, only: most_messages
   use rbs_spec_column, only: most_bodies
   use rbs_spec_spring, only: spring_spec
   implicit none
   private

   public :: read_springs

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

   subroutine read_spring(r, name, place, joint_read, spec, messages)
      type(reader), intent(in) :: r
      character(len=*), intent(in) :: name
      !> Number of the group
      integer, intent(in) :: place
      integer, intent(out) :: joint_read
      type(spring_spec), intent(out) :: spec
      type(message_list), intent(inout) :: messages
      type(key_type) :: keys(12)
      integer :: joint, i, status
      real(wp) :: k, d_y, k_post, k_c, d_c, k_y, k_u, b0, b1
      character(len=text_length) :: rule, inner, iomsg
      character(len=:), allocatable :: text
      namelist /spring/ joint, rule, k, d_y, k_post, k_c, d_c, k_y, k_u, b0, b1, inner

      keys = [key('joint', 'i'), key('rule', 's'), key('k', 'r'), key('d_y', 'r'), key('k_post', 'r'), &
              key('k_c', 'r'), key('d_c', 'r'), key('k_y', 'r'), key('k_u', 'r'), key('b0', 'r'), &
              key('b1', 'r'), key('inner', 's')]
      joint = 0
      rule = spec%rule
      inner = spec%inner
      k = spec%k
      d_y = spec%d_y
      k_post = spec%k_post
      k_c = spec%k_c
      d_c = spec%d_c
      k_y = spec%k_y
      k_u = spec%k_u
      b0 = spec%b0
      b1 = spec%b1
      associate (group => r%scanned%group(place))
         do i = group%first, group%last
            call entry_text(r%path, r%scanned, group, i, keys, text, messages)
            if (.not. allocated(text)) cycle
            ! One namelist serves all kinds of springs.
            text = '&spring'//text(len(name) + 2:)
            read (text, nml=spring, iostat=status, iomsg=iomsg)
            call check_status(r, i, status, iomsg, messages)
         end do
      end associate
      joint_read = joint
      call take_text(r, name//': rule', rule, spec%rule, messages)
      call take_text(r, name//': inner', inner, spec%inner, messages)
      spec%k = k
      spec%d_y = d_y
      spec%k_post = k_post
      spec%k_c = k_c
      spec%d_c = d_c
      spec%k_y = k_y
      spec%k_u = k_u
      spec%b0 = b0
      spec%b1 = b1
   end subroutine read_spring

end module rbs_io_namelist_springs
