!> Reads a case from a namelist file: the scanner cuts the text into groups and entries; each entry is
!> checked against the key that it names and passed to the setter.
module rbs_io_namelist
   use rbs_base_error, only: error_type, message_list
   use rbs_base_keys, only: text_kind, word_kind
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_case_case_record, only: case_record
   use rbs_case_group_reader, only: group_reader, ignored
   use rbs_io_namelist_entry, only: location, check_twice, check_values, entry_numbers, entry_text
   use rbs_io_namelist_pieces, only: nml_group, nml_scan
   use rbs_io_namelist_scan, only: scan_namelist, most_messages
   use rbs_io_text_file, only: text_file, load_text
   implicit none
   private

   public :: read_case

   !> Largest case file that is read [bytes].
   integer, parameter :: most_bytes = 100000000

contains

   !> Read a case. An error does not stop the reading: every error of the file gets a message.
   subroutine read_case(path, case, messages, understood)
      character(len=*), intent(in) :: path
      type(case_record), intent(out) :: case
      type(message_list), intent(inout) :: messages
      !> Whether every entry was understood; if not, the values have not been validated
      logical, intent(out) :: understood
      type(error_type), allocatable :: error
      type(text_file) :: file
      type(nml_scan) :: scanned
      type(group_reader) :: setter
      character(len=:), allocatable :: name
      integer :: known

      understood = .false.
      known = messages%count
      call load_text(file, path, most_bytes, error)
      if (allocated(error)) then
         call messages%add(error%message)
         return
      end if
      name = path(index(path, '/', back=.true.) + 1:)
      call scan_namelist(file, name, scanned, messages)
      if (messages%count > known) return
      call put_groups(scanned, name, setter, messages)
      ! Values that were not understood would also be reported as missing, which would mislead.
      understood = messages%count == known
      if (understood) call setter%finish(messages)
      understood = messages%count == known
      case = setter%case
      if (understood) call case%validate(messages)
   end subroutine read_case

   !> Read all groups; &units first, as the numbers of the others depend on it.
   subroutine put_groups(scanned, path, setter, messages)
      type(nml_scan), intent(in) :: scanned
      character(len=*), intent(in) :: path
      type(group_reader), intent(inout) :: setter
      type(message_list), intent(inout) :: messages
      character(len=8), parameter :: required(3) = ['column  ', 'shear   ', 'flexure ']
      integer :: i, pass

      do pass = 1, 2
         do i = 1, scanned%groups
            if (messages%count > most_messages) return
            if ((scanned%group(i)%name == 'units') .eqv. (pass == 1)) then
               call put_group(scanned, scanned%group(i), path, setter, messages)
            end if
         end do
      end do
      do i = 1, size(required)
         if (any(scanned%group(:scanned%groups)%name == required(i))) cycle
         call messages%add(path//': the group &'//trim(required(i))//' is missing')
      end do
   end subroutine put_groups

   !> Read one group; first the rule of a spring and the shape of a section, which bring keys.
   subroutine put_group(scanned, group, path, setter, messages)
      type(nml_scan), intent(in) :: scanned
      type(nml_group), intent(in) :: group
      character(len=*), intent(in) :: path
      type(group_reader), intent(inout) :: setter
      type(message_list), intent(inout) :: messages
      integer :: i, pass
      logical :: ok

      call setter%open(group%name, location(path, group%line)//':', messages, ok)
      if (.not. ok) return
      do pass = 1, 2
         do i = group%first, group%last
            if (messages%count > most_messages) return
            if (any(scanned%entry(i)%name == [character(len=5) :: 'rule', 'shape']) .eqv. (pass == 1)) then
               call put_entry(scanned, group, i, path, setter, messages)
            end if
         end do
      end do
   end subroutine put_group

   !> Read one entry, `name = values` or `name(i) = value`.
   subroutine put_entry(scanned, group, i, path, setter, messages)
      type(nml_scan), intent(in) :: scanned
      type(nml_group), intent(in) :: group
      !> Number of the entry
      integer, intent(in) :: i
      character(len=*), intent(in) :: path
      type(group_reader), intent(inout) :: setter
      type(message_list), intent(inout) :: messages
      character(len=:), allocatable :: text
      real(wp), allocatable :: number(:)
      integer :: place, known

      known = messages%count
      associate (entry => scanned%entry(i))
         call setter%find(entry%name, location(path, entry%line)//':', place, messages)
         if (messages%count > known .or. place == ignored) return
         associate (key => setter%keys(place))
            call check_twice(path, scanned, group, i, messages)
            call check_values(path, entry, key, messages)
            if (messages%count > known) return
            if (key%kind == text_kind .or. key%kind == word_kind) then
               call entry_text(entry, text)
               call setter%put_text(place, text, messages)
               return
            end if
            ! All subscripted values of a name are put together when the first of them is read.
            call entry_numbers(path, scanned, group, i, key, number, messages)
            if (allocated(number)) call setter%put_numbers(place, number)
         end associate
      end associate
   end subroutine put_entry

end module rbs_io_namelist
