!> A case from a namelist file.
module rbs_io_namelist
   use rbs_base_constants, only: unset, unset_integer
   use rbs_base_error, only: error_type, message_list
   use rbs_base_kinds, only: wp
   use rbs_io_namelist_entry, only: key_type, key, check_group_name, entry_text, text_length
   use rbs_io_namelist_group, only: reader, find_groups, check_status, take_text, given_reals, given_integers
   use rbs_io_namelist_scan, only: scan_namelist
   use rbs_io_namelist_springs, only: read_springs, read_layers
   use rbs_io_text_file, only: text_file, load_text
   use rbs_spec_analysis, only: analysis_spec, output_spec
   use rbs_spec_case, only: case_spec, most_loadings
   use rbs_base_check, only: is_given
   use rbs_spec_column, only: column_spec, most_bodies, most_dense
   use rbs_spec_loading, only: loading_spec
   implicit none
   private

   public :: read_case

   !> Larger files are no cases [bytes].
   integer, parameter :: most_bytes = 10000000
   integer, parameter :: most_amplitudes = 1000

   !> A column that takes modal damping has no more modes.
   integer, parameter :: most_modes = 3*most_dense

   character(len=8), parameter :: group_names(10) = [ &
      'case    ', 'column  ', 'axial   ', 'shear   ', 'flexure ', 'opening ', 'loading ', 'analysis', &
      'output  ', 'layer   ']

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
      call read_springs(r, 'shear', 1, case%column%n, case%column%shear, messages)
      call read_springs(r, 'flexure', 1, case%column%n, case%column%flexure, messages)
      if (allocated(case%column%flexure)) call read_layers(r, case%column%n, case%column%flexure, messages)
      call read_springs(r, 'opening', 0, case%column%n, case%column%axial, messages)
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
      type(key_type) :: keys(14)
      integer :: n, i, status
      real(wp) :: height, mass, top_mass, top_inertia, depth, mass_damping, stiffness_damping
      logical :: tangent_damping
      real(wp), allocatable :: lengths(:), masses(:), rotary_inertia(:), modal_damping(:)
      character(len=text_length) :: kinematics, iomsg
      character(len=:), allocatable :: text
      integer, allocatable :: found(:)
      namelist /column/ n, height, mass, lengths, masses, kinematics, top_mass, top_inertia, depth, &
         rotary_inertia, mass_damping, stiffness_damping, tangent_damping, modal_damping

      keys = [key('n', 'i'), key('height', 'r'), key('mass', 'r'), key('lengths', 'r', most_bodies), &
              key('masses', 'r', most_bodies), key('kinematics', 's'), key('top_mass', 'r'), &
              key('top_inertia', 'r'), key('depth', 'r'), key('rotary_inertia', 'r', most_bodies), &
              key('mass_damping', 'r'), key('stiffness_damping', 'r'), key('tangent_damping', 'l'), &
              key('modal_damping', 'r', most_modes)]
      n = spec%n
      height = spec%height
      mass = spec%mass
      top_mass = spec%top_mass
      top_inertia = spec%top_inertia
      depth = spec%depth
      mass_damping = spec%mass_damping
      stiffness_damping = spec%stiffness_damping
      tangent_damping = spec%tangent_damping
      kinematics = spec%kinematics
      allocate (lengths(most_bodies), masses(most_bodies), rotary_inertia(most_bodies), &
                modal_damping(most_modes), source=unset)
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
      spec%top_mass = top_mass
      spec%top_inertia = top_inertia
      spec%depth = depth
      spec%mass_damping = mass_damping
      spec%stiffness_damping = stiffness_damping
      spec%tangent_damping = tangent_damping
      call take_text(r, 'column: kinematics', kinematics, spec%kinematics, messages)
      call given_reals(r, 'column: lengths', lengths, spec%lengths, messages)
      call given_reals(r, 'column: masses', masses, spec%masses, messages)
      call given_reals(r, 'column: rotary_inertia', rotary_inertia, spec%rotary_inertia, messages)
      call given_reals(r, 'column: modal_damping', modal_damping, spec%modal_damping, messages)
   end subroutine read_column

   subroutine read_axial(r, spec, messages)
      type(reader), intent(in) :: r
      type(column_spec), intent(inout) :: spec
      type(message_list), intent(inout) :: messages
      type(key_type) :: keys(4)
      real(wp) :: load, gravity
      logical :: self_weight, follows
      character(len=text_length) :: iomsg
      character(len=:), allocatable :: text
      integer, allocatable :: found(:)
      integer :: i, status
      namelist /axial/ load, self_weight, gravity, follows

      keys = [key('load', 'r'), key('self_weight', 'l'), key('gravity', 'r'), key('follows', 'l')]
      load = spec%axial_load
      gravity = spec%gravity
      self_weight = spec%self_weight
      follows = spec%axial_follows
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
      spec%axial_follows = follows
   end subroutine read_axial

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
         if (case%loading(i)%follows) case%column%force_follows = .true.
      end do
   end subroutine read_loadings

   subroutine read_loading(r, place, spec, messages)
      type(reader), intent(in) :: r
      integer, intent(in) :: place
      type(loading_spec), intent(inout) :: spec
      type(message_list), intent(inout) :: messages
      type(key_type) :: keys(15)
      character(len=text_length) :: drive, source, file, format, column, time_column, unit, iomsg
      real(wp) :: scale, interval, period
      real(wp) :: amplitudes(most_amplitudes)
      integer :: cycles(most_amplitudes)
      integer :: repeats, points, i, status
      logical :: follows
      character(len=:), allocatable :: text
      namelist /loading/ drive, source, file, format, column, time_column, unit, scale, interval, &
         amplitudes, cycles, repeats, points, period, follows

      keys = [key('drive', 's'), key('source', 's'), key('file', 's'), key('format', 's'), &
              key('column', 's'), key('time_column', 's'), key('unit', 's'), key('scale', 'r'), &
              key('interval', 'r'), key('amplitudes', 'r', most_amplitudes), &
              key('cycles', 'i', most_amplitudes), key('repeats', 'i'), key('points', 'i'), &
              key('period', 'r'), key('follows', 'l')]
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
      follows = spec%follows
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
      spec%follows = follows
      call given_reals(r, 'loading: amplitudes', amplitudes, spec%amplitudes, messages)
      call given_integers(r, 'loading: cycles', cycles, spec%cycles, messages)
   end subroutine read_loading

   subroutine read_analysis(r, spec, messages)
      type(reader), intent(in) :: r
      type(analysis_spec), intent(inout) :: spec
      type(message_list), intent(inout) :: messages
      type(key_type) :: keys(8)
      character(len=text_length) :: method, events, iomsg
      real(wp) :: dt, duration, tolerance, rho_infinity, collapse_drift
      logical :: allow_unstable
      character(len=:), allocatable :: text
      integer, allocatable :: found(:)
      integer :: i, status
      namelist /analysis/ method, dt, duration, events, tolerance, rho_infinity, collapse_drift, &
         allow_unstable

      keys = [key('method', 's'), key('dt', 'r'), key('duration', 'r'), key('events', 's'), &
              key('tolerance', 'r'), key('rho_infinity', 'r'), key('collapse_drift', 'r'), &
              key('allow_unstable', 'l')]
      method = spec%method
      dt = spec%dt
      duration = spec%duration
      events = spec%events
      tolerance = spec%tolerance
      rho_infinity = spec%rho_infinity
      collapse_drift = spec%collapse_drift
      allow_unstable = spec%allow_unstable
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
      call take_text(r, 'analysis: events', events, spec%events, messages)
      spec%tolerance = tolerance
      spec%rho_infinity = rho_infinity
      spec%collapse_drift = collapse_drift
      spec%allow_unstable = allow_unstable
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
