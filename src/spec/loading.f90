!> What the user asked of one loading: what is driven, and where its values come from.
module rbs_spec_loading
   use rbs_base_kinds, only: wp
   use rbs_base_constants, only: unset
   use rbs_base_error, only: message_list
   use rbs_base_text, only: to_text
   use rbs_base_check, only: is_given, check_positive, check_finite, check_name
   use rbs_base_units, only: unit_type, length_units, force_units, acceleration_units
   implicit none
   private

   public :: loading_spec, drive_names, source_names, format_names, units_of

   character(len=12), parameter :: drive_names(5) = [ &
      'displacement', 'force       ', 'ground      ', 'vertical    ', 'axial       ']
   character(len=8), parameter :: source_names(2) = ['file    ', 'protocol']
   character(len=4), parameter :: format_names(3) = ['auto', 'peer', 'csv ']

   !> One loading of a case.
   type :: loading_spec
      !> What is prescribed, one of `drive_names`: displacement of the top [m], lateral force at the top
      !> [N], acceleration of the ground, horizontal or (upward positive) vertical [m/s2], or axial load
      !> besides the constant one, compression positive [N]
      character(len=16) :: drive = ''
      !> One of `source_names`
      character(len=16) :: source = ''
      !> file: its path
      character(len=:), allocatable :: file
      !> file: one of `format_names`
      character(len=16) :: format = 'auto'
      !> csv: name or number of the column with the values; empty: the one named after `drive`
      character(len=64) :: column = ''
      !> csv: name or number of the column with the time [s]; empty: the one named time, if any
      character(len=64) :: time_column = ''
      !> Unit of the values. Of a file: empty for the one in the name of the column, else mm and kN for a
      !> PEER file, SI for a csv. Of the amplitudes: empty for drift (displacement) or SI
      character(len=16) :: unit = ''
      !> Factor on the values
      real(wp) :: scale = 1.0_wp
      !> Time from row to row where the file has no time column [s]
      real(wp) :: interval = unset
      !> protocol: amplitudes, one a step
      real(wp), allocatable :: amplitudes(:)
      !> protocol: cycles at each amplitude, one for all or one for each
      integer, allocatable :: cycles(:)
      !> protocol: how often the whole is run
      integer :: repeats = 1
      !> protocol: points on a quarter of a cycle
      integer :: points = 25
      !> protocol in a dynamic analysis: duration of one cycle [s]
      real(wp) :: period = unset
      !> force: whether it turns with the top body
      logical :: follows = .false.
   contains
      procedure :: validate
   end type loading_spec

contains

   !> The units that the values of a drive may have.
   function units_of(drive) result(units)
      character(len=*), intent(in) :: drive
      type(unit_type), allocatable :: units(:)

      select case (drive)
      case ('displacement')
         units = length_units
      case ('force', 'axial')
         units = force_units
      case default
         units = acceleration_units
      end select
   end function units_of

   !> Add a message for everything that is wrong with the loading.
   subroutine validate(self, dynamic, messages)
      class(loading_spec), intent(in) :: self
      !> Whether the analysis runs in time
      logical, intent(in) :: dynamic
      type(message_list), intent(inout) :: messages
      integer :: drive, source, place

      call check_name(self%drive, drive_names, 'loading: drive', messages, drive)
      call check_name(self%source, source_names, 'loading: source', messages, source)
      call check_finite(self%scale, 'loading: scale', '', messages)
      if (.not. dynamic .and. drive > 2) then
         call messages%add("loading: drive = '"//trim(self%drive)//"' needs a dynamic analysis; set "// &
                           "method = 'rk4' in the group analysis")
      end if
      if (dynamic .and. self%drive == 'displacement') then
         call messages%add("loading: drive = 'displacement' needs the static analysis; set "// &
                           "method = 'static' in the group analysis, or drive = 'force'")
      end if
      if (self%follows .and. self%drive /= 'force') then
         call messages%add("loading: follows has no meaning for drive = '"//trim(self%drive)// &
                           "'; only a force can turn with the top (and the axial load, with follows in "// &
                           'the group axial)')
      end if
      if (is_given(self%interval)) call check_positive(self%interval, 'loading: interval', 's', messages)
      if (drive > 0) call check_unit(self, messages)
      if (allocated(self%file) .and. allocated(self%amplitudes)) then
         call messages%add('loading: both file and amplitudes are given; keep the one that is meant')
      end if
      select case (self%source)
      case ('file')
         if (.not. allocated(self%file)) then
            call messages%add('loading: file is missing; give the path of the history')
         end if
         call check_name(self%format, format_names, 'loading: format', messages, place)
      case ('protocol')
         call validate_protocol(self, dynamic, messages)
      case default
         return                                     ! the source has been reported
      end select
   end subroutine validate

   !> The unit must be one of the drive's; a protocol of displacements may also be in drift.
   subroutine check_unit(self, messages)
      type(loading_spec), intent(in) :: self
      type(message_list), intent(inout) :: messages
      type(unit_type), allocatable :: units(:)
      character(len=8), allocatable :: names(:)
      integer :: place

      if (self%unit == '') return
      units = units_of(self%drive)
      names = units%name
      if (self%drive == 'displacement' .and. self%source == 'protocol') names = ['drift   ', names]
      call check_name(self%unit, names, "loading: unit of the drive '"//trim(self%drive)//"'", &
                      messages, place)
   end subroutine check_unit

   subroutine validate_protocol(self, dynamic, messages)
      type(loading_spec), intent(in) :: self
      logical, intent(in) :: dynamic
      type(message_list), intent(inout) :: messages
      integer :: i

      if (.not. allocated(self%amplitudes)) then
         call messages%add('loading: amplitudes are missing; give one for each step of the protocol')
         return
      end if
      do i = 1, size(self%amplitudes)
         call check_positive(self%amplitudes(i), 'loading: amplitudes('//to_text(i)//')', '', messages)
      end do
      if (allocated(self%cycles)) then
         if (size(self%cycles) /= 1 .and. size(self%cycles) /= size(self%amplitudes)) then
            call messages%add('loading: cycles has '//to_text(size(self%cycles))//' values for '// &
                              to_text(size(self%amplitudes))//' amplitudes; give one, or one for each')
         end if
         if (any(self%cycles < 1)) then
            call messages%add('loading: cycles = '//to_text(minval(self%cycles))//' must be 1 or more')
         end if
      end if
      if (self%repeats < 1) then
         call messages%add('loading: repeats = '//to_text(self%repeats)//' must be 1 or more')
      end if
      if (self%points < 1) then
         call messages%add('loading: points = '//to_text(self%points)//' must be 1 or more')
      end if
      if (dynamic) call check_positive(self%period, 'loading: period', 's', messages)
   end subroutine validate_protocol

end module rbs_spec_loading
