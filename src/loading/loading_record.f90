!> The input of one loading: the quantity that is prescribed, and the source of its values.
module rbs_loading_loading_record
   use rbs_base_kinds, only: wp
   use rbs_base_constants, only: unset
   use rbs_base_error, only: message_list
   use rbs_base_text, only: to_text
   use rbs_base_check, only: is_given, check_name
   use rbs_base_key_visitor, only: key_visitor, visited_record
   use rbs_base_keys, only: any_number, any_value, above_zero, not_negative, one_or_more
   use rbs_base_units, only: unit_type, unit_named, to_si, length_units, force_units, acceleration_units
   use rbs_structure_structure, only: signal_names
   use rbs_loading_named_protocols, only: protocol_names, counted_in_drift
   implicit none
   private

   public :: loading_record, drive_names, units_of

   !> A displacement is no action in time; the others are its signals.
   character(len=21), parameter :: drive_names(6) = [character(len=21) :: 'displacement', signal_names]
   character(len=8), parameter :: source_names(3) = ['file    ', 'protocol', 'values  ']

   !> Most values of one loading in a case file; longer histories are read from files.
   integer, parameter :: most_amplitudes = 1000, most_values = 1000000

   !> One loading of a case.
   type, extends(visited_record) :: loading_record
      !> The prescribed quantity, one of `drive_names`: displacement of the top [m], lateral force at the top
      !> [N], acceleration of the ground, horizontal or vertical (upward positive) [m/s2], axial load at
      !> the top in place of the constant one, compression positive [N], or acceleration of the ground along
      !> y of a building [m/s2]
      character(len=24) :: drive = ''
      !> One of `source_names`
      character(len=16) :: source = ''
      character(len=:), allocatable :: file
      !> Format of the file, its columns by name or number, unit of the values and factor on them; time from
      !> row to row [s]
      character(len=16) :: format = 'auto'
      character(len=64) :: column = '', time_column = ''
      character(len=16) :: unit = ''
      real(wp) :: scale = 1.0_wp, interval = unset
      !> A protocol of the literature, the unit of its amplitudes and the largest of them
      character(len=16) :: protocol = ''
      real(wp) :: reference = unset, largest = unset
      !> Amplitudes to both sides, one a step, in `unit`, and cycles at each; how often all is run, points on
      !> a quarter of a cycle, and duration of a cycle [s]
      real(wp), allocatable :: amplitudes(:), negative_amplitudes(:)
      integer, allocatable :: cycles(:)
      integer :: repeats = 1, points = 25
      real(wp) :: period = unset
      !> Times [s] and values that are given in the case itself
      real(wp), allocatable :: time(:), values(:)
   contains
      procedure :: visit, settle, has_time, validate, inline_values
   end type loading_record

contains

   !> The keys of a loading.
   subroutine visit(self, v)
      class(loading_record), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%word('drive', self%drive, 'what is prescribed', 'displacement force ground_acceleration '// &
                  'vertical_acceleration axial_load ground_acceleration_y')
      call v%word('source', self%source, 'where the values come from; without it from what is given', &
                  'file protocol values')
      call v%long_text('file', self%file, 'path of a history, from the folder of the case')
      call v%word('format', self%format, 'format of the file', 'auto peer csv')
      call v%word('column', self%column, &
                  'name or number of the column with the values; without it the one named after the drive')
      call v%word('time_column', self%time_column, &
                  'name or number of the column with the time; without it the one named time')
      call v%word('unit', self%unit, 'unit of the values; drift is displacement over height')
      call v%key('scale', self%scale, '', any_number, 'factor on the values')
      call v%key('interval', self%interval, 's', above_zero, &
                 'time from row to row where the file has no column of times', optional=.true.)
      call v%word('protocol', self%protocol, 'a protocol of the literature in place of amplitudes', &
                  protocol_names)
      call v%key('reference', self%reference, '', above_zero, &
                 'amplitude that the protocol is counted in, or the drift at yield', optional=.true.)
      call v%key('largest', self%largest, '', above_zero, &
                 'up to which amplitude the protocol goes; without it to its own end', optional=.true.)
      call v%key('amplitudes', self%amplitudes, '', above_zero, 'amplitudes of a protocol, one a step', &
                 most_amplitudes)
      call v%key('negative_amplitudes', self%negative_amplitudes, '', not_negative, &
                 'amplitudes to the other side; without them the same', most_amplitudes)
      call v%key('cycles', self%cycles, '', one_or_more, &
                 'cycles at each amplitude: one for all, or one for each; without it 1', most_amplitudes)
      call v%key('repeats', self%repeats, '', one_or_more, 'how often the whole protocol is run')
      call v%key('points', self%points, '', one_or_more, 'points on a quarter of a cycle')
      call v%key('period', self%period, 's', above_zero, &
                 'duration of a cycle in a dynamic analysis', optional=.true.)
      call v%key('time', self%time, 's', any_value, 'times of the values', most_values)
      call v%key('values', self%values, '', any_value, 'the values themselves', most_values)
   end subroutine visit

   !> Find the source from what is given, if it is not named; a file comes before all others.
   subroutine settle(self)
      class(loading_record), intent(inout) :: self

      if (self%source /= '') return
      if (allocated(self%values)) self%source = 'values'
      if (allocated(self%amplitudes) .or. self%protocol /= '') self%source = 'protocol'
      if (allocated(self%file)) self%source = 'file'
   end subroutine settle

   !> Whether the input gives the times of the values. A column of times in a file is found only when the
   !> file is read.
   elemental logical function has_time(self)
      class(loading_record), intent(in) :: self

      has_time = is_given(self%interval) .or. is_given(self%period) .or. allocated(self%time) .or. &
                 self%time_column /= ''
   end function has_time

   !> The units that the values of a quantity in `drive_names` may have.
   function units_of(drive) result(units)
      !> One of `drive_names`
      character(len=*), intent(in) :: drive
      type(unit_type), allocatable :: units(:)

      select case (drive)
      case ('displacement')
         units = length_units
      case ('force', 'axial_load')
         units = force_units
      case default
         units = acceleration_units
      end select
   end function units_of

   !> Times and values that are given in the case itself, of a validated loading.
   subroutine inline_values(self, time, value)
      class(loading_record), intent(in) :: self
      !> Times (m) [s]; if none are given, the number of each point
      real(wp), allocatable, intent(out) :: time(:)
      !> Values (m) [m, N or m/s2]
      real(wp), allocatable, intent(out) :: value(:)
      integer :: i

      ! Without an interval the numbers of the points, from 0, are the times.
      value = to_si(self%values*self%scale, unit_named(units_of(self%drive), self%unit))
      if (allocated(self%time)) then
         time = self%time
      else
         time = [((i - 1)*merge(self%interval, 1.0_wp, is_given(self%interval)), i=1, size(value))]
      end if
   end subroutine inline_values

   !> Add a message for every error of the loading.
   subroutine validate(self, dynamic, messages)
      class(loading_record), intent(inout) :: self
      !> Whether the analysis runs in time
      logical, intent(in) :: dynamic
      type(message_list), intent(inout) :: messages
      integer :: drive, source

      call self%check('loading', messages)
      if (self%drive == '') call check_name(self%drive, drive_names, 'loading: drive', messages, drive)
      if (self%source == '') call check_name(self%source, source_names, 'loading: source', messages, source)
      ! The first two drives are displacement and force.
      drive = findloc(drive_names == self%drive, .true., dim=1)
      if (.not. dynamic .and. drive > 2 .and. self%drive /= 'axial_load') then
         call messages%add("loading: drive = '"//trim(self%drive)//"' needs a dynamic analysis; set "// &
                           "method = 'auto' in the group analysis")
      end if
      if (dynamic .and. self%drive == 'displacement') then
         call messages%add("loading: drive = 'displacement' needs the static analysis; set "// &
                           "method = 'static' in the group analysis, or drive = 'force'")
      end if
      if (drive > 0) call check_unit()
      if (count([allocated(self%file), allocated(self%amplitudes), self%protocol /= '', &
                 allocated(self%values)]) > 1) then
         call messages%add('loading: more than one of file, amplitudes, '// &
                           'protocol and values are given; keep the one that is meant')
      end if
      select case (self%source)
      case ('file')
         if (.not. allocated(self%file)) then
            call messages%add('loading: file is missing; give the path of the history')
         end if
      case ('protocol')
         call validate_protocol()
      case ('values')
         call validate_values()
      case default                                  ! reported already
      end select

   contains

      !> The unit must be one of the drive's; a protocol of displacements may also be in drift.
      subroutine check_unit()
         type(unit_type), allocatable :: units(:)
         character(len=8), allocatable :: names(:)
         integer :: number

         if (self%unit == '') return
         units = units_of(self%drive)
         names = units%name
         if (self%drive == 'displacement' .and. self%source == 'protocol') names = ['drift   ', names]
         call check_name(self%unit, names, 'loading of '//trim(self%drive)//': unit', messages, number)
      end subroutine check_unit

      !> Check the cycles of a protocol: of a named one, or of amplitudes.
      subroutine validate_protocol()

         if (self%protocol /= '') then
            call validate_named()
         else if (.not. allocated(self%amplitudes)) then
            call messages%add('loading: amplitudes are missing; give one for each step, '// &
                              'or the name of a protocol')
            return
         else
            call validate_amplitudes()
         end if
         if (dynamic .and. .not. is_given(self%period)) then
            call messages%add('loading: period is missing; give it a value in s')
         end if
      end subroutine validate_protocol

      !> Refuse keys that contradict a protocol of the literature; missing ones are found where it is made.
      subroutine validate_named()

         if (allocated(self%cycles) .or. allocated(self%negative_amplitudes)) then
            call messages%add("loading: protocol = '"//trim(self%protocol)// &
                              "' has its own cycles and amplitudes; "// &
                              'leave out cycles and negative_amplitudes, or give amplitudes in its place')
         end if
         if (counted_in_drift(self%protocol) .and. &
             (self%drive /= 'displacement' .or. (self%unit /= '' .and. self%unit /= 'drift'))) then
            call messages%add("loading: protocol = '"//trim(self%protocol)//"' has amplitudes in drift; "// &
                              "it goes with drive = 'displacement' and no other unit")
         end if
      end subroutine validate_named

      !> Check amplitudes: as many as negative ones and as cycles, and no key of named protocols.
      subroutine validate_amplitudes()

         if (is_given(self%reference) .or. is_given(self%largest)) then
            call messages%add('loading: reference and largest belong to a protocol of the literature; '// &
                              'leave them out, or give protocol in place of amplitudes')
         end if
         if (allocated(self%negative_amplitudes)) then
            if (size(self%negative_amplitudes) /= size(self%amplitudes)) then
               call messages%add('loading: negative_amplitudes has '// &
                                 to_text(size(self%negative_amplitudes))//' values for '// &
                                 to_text(size(self%amplitudes))//' amplitudes; give one for each')
            end if
         end if
         if (allocated(self%cycles)) then
            if (size(self%cycles) /= 1 .and. size(self%cycles) /= size(self%amplitudes)) then
               call messages%add('loading: cycles has '//to_text(size(self%cycles))//' values for '// &
                                 to_text(size(self%amplitudes))//' amplitudes; give one, or one for each')
            end if
         end if
      end subroutine validate_amplitudes

      !> Check values that are given point by point: as many as times.
      subroutine validate_values()

         if (.not. allocated(self%values)) then
            call messages%add('loading: values are missing; give one for each point')
         else if (allocated(self%time)) then
            if (size(self%time) /= size(self%values)) then
               call messages%add('loading: '//to_text(size(self%values))//' values for '// &
                                 to_text(size(self%time))//' times; give one for each')
            end if
         else if (dynamic .and. .not. is_given(self%interval)) then
            call messages%add('loading: a dynamic analysis needs the times of the values; give time, one '// &
                              'for each value, or interval')
         end if
      end subroutine validate_values

   end subroutine validate

end module rbs_loading_loading_record
