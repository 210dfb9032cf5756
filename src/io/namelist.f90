!> A case from a namelist file.
module rbs_io_namelist
   use rbs_base_constants, only: unset, unset_integer
   use rbs_base_error, only: error_type, message_list
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_io_namelist_entry, only: key_type, key, check_group_name, entry_text, location, text_length
   use rbs_io_namelist_group, only: reader, find_groups, check_status, take_text, given_reals, given_integers
   use rbs_io_namelist_scan, only: scan_namelist, most_messages
   use rbs_io_text_file, only: text_file, load_text
   use rbs_spec_analysis, only: analysis_spec, output_spec
   use rbs_spec_case, only: case_spec, most_loadings
   use rbs_spec_check, only: is_given
   use rbs_spec_column, only: column_spec, most_bodies
   use rbs_spec_loading, only: loading_spec
   use rbs_spec_spring, only: spring_spec
   implicit none
   private

   public :: read_case

   !> Larger files are no cases [bytes].
   integer, parameter :: most_bytes = 10000000
   integer, parameter :: most_amplitudes = 1000

   character(len=8), parameter :: group_names(8) = ['case    ', 'column  ', 'axial   ', 'shear   ', &
                                                    'flexure ', 'loading ', 'analysis', 'output  ']

contains

   !> Read a case. Nothing that is wrong with it stops the reading: there is a message for each fault.
   subroutine read_case(path, case, messages, understood)
      character(len=*), intent(in) :: path
      type(case_spec), intent(out) :: case
      type(message_list), intent(inout) :: messages
      !> Whether every entry was understood; if not, the values have not been validated
      logical, intent(out) :: understood
      type(error_type), allocatable :: error
      type(text_file) :: file
      type(reader) :: r
      integer :: i, known

      understood = .false.
      known = messages%count
      call load_text(file, path, most_bytes, error)
      if (allocated(error)) then
         call messages%add(error%message)
         return
      end if
      r%path = path(index(path, '/', back=.true.) + 1:)
      call scan_namelist(file, r%path, r%scanned, messages)
      if (messages%count > known) return

      do i = 1, r%scanned%groups
         call check_group_name(r%path, r%scanned%group(i), group_names, messages)
      end do
      call read_title(r, case%title, messages)
      call read_column(r, case%column, messages)
      call read_axial(r, case%column, messages)
      call read_springs(r, 'shear', case%column%n, case%column%shear, messages)
      call read_springs(r, 'flexure', case%column%n, case%column%flexure, messages)
      call read_loadings(r, case, messages)
      call read_analysis(r, case%analysis, messages)
      call read_output(r, case%output, messages)
      ! Values that were not understood are missing below: reporting that too would mislead.
      understood = messages%count == known
      if (understood) call case%validate(messages)
   end subroutine read_case

   subroutine read_title(r, found_title, messages)
      type(reader), intent(in) :: r
      character(len=:), allocatable, intent(out) :: found_title
      type(message_list), intent(inout) :: messages
      type(key_type), parameter :: keys(1) = [key_type('title', 's', 1)]
      character(len=text_length) :: title, iomsg
      character(len=:), allocatable :: text
      integer, allocatable :: found(:)
      integer :: i, status
      namelist /case/ title

      title = ''
      call find_groups(r, 'case', 0, 1, found, messages)
      if (size(found) == 1) then
         associate (group => r%scanned%group(found(1)))
            do i = group%first, group%last
               call entry_text(r%path, r%scanned, group, i, keys, text, messages)
               if (.not. allocated(text)) cycle
               read (text, nml=case, iostat=status, iomsg=iomsg)
               call check_status(r, i, status, iomsg, messages)
            end do
         end associate
      end if
      found_title = trim(title)
   end subroutine read_title

   subroutine read_column(r, spec, messages)
      type(reader), intent(in) :: r
      type(column_spec), intent(inout) :: spec
      type(message_list), intent(inout) :: messages
      type(key_type) :: keys(8)
      integer :: n, i, status
      real(wp) :: height, mass, mass_damping, stiffness_damping
      real(wp), allocatable :: lengths(:), masses(:)
      character(len=text_length) :: kinematics, iomsg
      character(len=:), allocatable :: text
      integer, allocatable :: found(:)
      namelist /column/ n, height, mass, lengths, masses, kinematics, mass_damping, stiffness_damping

      keys = [key('n', 'i'), key('height', 'r'), key('mass', 'r'), key('lengths', 'r', most_bodies), &
              key('masses', 'r', most_bodies), key('kinematics', 's'), key('mass_damping', 'r'), &
              key('stiffness_damping', 'r')]
      n = spec%n
      height = spec%height
      mass = spec%mass
      mass_damping = spec%mass_damping
      stiffness_damping = spec%stiffness_damping
      kinematics = spec%kinematics
      allocate (lengths(most_bodies), masses(most_bodies), source=unset)
      call find_groups(r, 'column', 1, 1, found, messages)
      if (size(found) == 0) return
      associate (group => r%scanned%group(found(1)))
         do i = group%first, group%last
            call entry_text(r%path, r%scanned, group, i, keys, text, messages)
            if (.not. allocated(text)) cycle
            read (text, nml=column, iostat=status, iomsg=iomsg)
            call check_status(r, i, status, iomsg, messages)
         end do
      end associate
      spec%n = n
      spec%height = height
      spec%mass = mass
      spec%mass_damping = mass_damping
      spec%stiffness_damping = stiffness_damping
      call take_text(r, 'column: kinematics', kinematics, spec%kinematics, messages)
      call given_reals(r, 'column: lengths', lengths, spec%lengths, messages)
      call given_reals(r, 'column: masses', masses, spec%masses, messages)
   end subroutine read_column

   subroutine read_axial(r, spec, messages)
      type(reader), intent(in) :: r
      type(column_spec), intent(inout) :: spec
      type(message_list), intent(inout) :: messages
      type(key_type) :: keys(3)
      real(wp) :: load, gravity
      logical :: self_weight
      character(len=text_length) :: iomsg
      character(len=:), allocatable :: text
      integer, allocatable :: found(:)
      integer :: i, status
      namelist /axial/ load, self_weight, gravity

      keys = [key('load', 'r'), key('self_weight', 'l'), key('gravity', 'r')]
      load = spec%axial_load
      gravity = spec%gravity
      self_weight = spec%self_weight
      call find_groups(r, 'axial', 0, 1, found, messages)
      if (size(found) == 0) return
      associate (group => r%scanned%group(found(1)))
         do i = group%first, group%last
            call entry_text(r%path, r%scanned, group, i, keys, text, messages)
            if (.not. allocated(text)) cycle
            read (text, nml=axial, iostat=status, iomsg=iomsg)
            call check_status(r, i, status, iomsg, messages)
         end do
      end associate
      spec%axial_load = load
      spec%gravity = gravity
      spec%self_weight = self_weight
   end subroutine read_axial

   !> Springs of the joints: a group with joint = 0 is for every joint that has no group of its own.
   subroutine read_springs(r, name, n, springs, messages)
      type(reader), intent(in) :: r
      character(len=*), intent(in) :: name
      integer, intent(in) :: n
      type(spring_spec), allocatable, intent(out) :: springs(:)
      type(message_list), intent(inout) :: messages
      type(spring_spec) :: one
      integer, allocatable :: found(:), group_of(:)
      integer :: g, joint, missing

      call find_groups(r, name, 1, huge(1), found, messages)
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
            ! One namelist serves both groups.
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

   subroutine read_loadings(r, case, messages)
      type(reader), intent(in) :: r
      type(case_spec), intent(inout) :: case
      type(message_list), intent(inout) :: messages
      integer, allocatable :: found(:)
      integer :: i

      call find_groups(r, 'loading', 0, most_loadings, found, messages)
      case%loadings = size(found)
      do i = 1, size(found)
         call read_loading(r, found(i), case%loading(i), messages)
      end do
   end subroutine read_loadings

   subroutine read_loading(r, place, spec, messages)
      type(reader), intent(in) :: r
      integer, intent(in) :: place
      type(loading_spec), intent(inout) :: spec
      type(message_list), intent(inout) :: messages
      type(key_type) :: keys(14)
      character(len=text_length) :: drive, source, file, format, column, time_column, unit, iomsg
      real(wp) :: scale, interval, period
      real(wp) :: amplitudes(most_amplitudes)
      integer :: cycles(most_amplitudes)
      integer :: repeats, points, i, status
      character(len=:), allocatable :: text
      namelist /loading/ drive, source, file, format, column, time_column, unit, scale, interval, &
         amplitudes, cycles, repeats, points, period

      keys = [key('drive', 's'), key('source', 's'), key('file', 's'), key('format', 's'), &
              key('column', 's'), key('time_column', 's'), key('unit', 's'), key('scale', 'r'), &
              key('interval', 'r'), key('amplitudes', 'r', most_amplitudes), &
              key('cycles', 'i', most_amplitudes), key('repeats', 'i'), key('points', 'i'), &
              key('period', 'r')]
      drive = spec%drive
      source = spec%source
      file = ''
      format = spec%format
      column = spec%column
      time_column = spec%time_column
      unit = spec%unit
      scale = spec%scale
      interval = spec%interval
      amplitudes = unset
      cycles = unset_integer
      repeats = spec%repeats
      points = spec%points
      period = spec%period
      associate (group => r%scanned%group(place))
         do i = group%first, group%last
            call entry_text(r%path, r%scanned, group, i, keys, text, messages)
            if (.not. allocated(text)) cycle
            read (text, nml=loading, iostat=status, iomsg=iomsg)
            call check_status(r, i, status, iomsg, messages)
         end do
      end associate
      call take_text(r, 'loading: drive', drive, spec%drive, messages)
      if (source == '' .and. file /= '') source = 'file'
      if (source == '' .and. is_given(amplitudes(1))) source = 'protocol'
      call take_text(r, 'loading: source', source, spec%source, messages)
      if (file /= '') spec%file = trim(file)
      call take_text(r, 'loading: format', format, spec%format, messages)
      call take_text(r, 'loading: column', column, spec%column, messages)
      call take_text(r, 'loading: time_column', time_column, spec%time_column, messages)
      call take_text(r, 'loading: unit', unit, spec%unit, messages)
      spec%scale = scale
      spec%interval = interval
      spec%repeats = repeats
      spec%points = points
      spec%period = period
      call given_reals(r, 'loading: amplitudes', amplitudes, spec%amplitudes, messages)
      call given_integers(r, 'loading: cycles', cycles, spec%cycles, messages)
   end subroutine read_loading

   subroutine read_analysis(r, spec, messages)
      type(reader), intent(in) :: r
      type(analysis_spec), intent(inout) :: spec
      type(message_list), intent(inout) :: messages
      type(key_type) :: keys(3)
      character(len=text_length) :: method, iomsg
      real(wp) :: dt, duration
      character(len=:), allocatable :: text
      integer, allocatable :: found(:)
      integer :: i, status
      namelist /analysis/ method, dt, duration

      keys = [key('method', 's'), key('dt', 'r'), key('duration', 'r')]
      method = spec%method
      dt = spec%dt
      duration = spec%duration
      call find_groups(r, 'analysis', 0, 1, found, messages)
      if (size(found) == 0) return
      associate (group => r%scanned%group(found(1)))
         do i = group%first, group%last
            call entry_text(r%path, r%scanned, group, i, keys, text, messages)
            if (.not. allocated(text)) cycle
            read (text, nml=analysis, iostat=status, iomsg=iomsg)
            call check_status(r, i, status, iomsg, messages)
         end do
      end associate
      call take_text(r, 'analysis: method', method, spec%method, messages)
      spec%dt = dt
      spec%duration = duration
   end subroutine read_analysis

   subroutine read_output(r, spec, messages)
      type(reader), intent(in) :: r
      type(output_spec), intent(inout) :: spec
      type(message_list), intent(inout) :: messages
      type(key_type) :: keys(2)
      character(len=text_length) :: file, iomsg
      character(len=:), allocatable :: text
      integer, allocatable :: found(:)
      integer :: every, i, status
      namelist /output/ file, every

      keys = [key('file', 's'), key('every', 'i')]
      file = ''
      every = spec%every
      call find_groups(r, 'output', 0, 1, found, messages)
      if (size(found) == 0) return
      associate (group => r%scanned%group(found(1)))
         do i = group%first, group%last
            call entry_text(r%path, r%scanned, group, i, keys, text, messages)
            if (.not. allocated(text)) cycle
            read (text, nml=output, iostat=status, iomsg=iomsg)
            call check_status(r, i, status, iomsg, messages)
         end do
      end associate
      if (file /= '') spec%file = trim(file)
      spec%every = every
   end subroutine read_output

end module rbs_io_namelist
