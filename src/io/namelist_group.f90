!> What the readers of the groups of a namelist file share.
module rbs_io_namelist_group
   use rbs_base_constants, only: unset_integer
   use rbs_base_error, only: message_list
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_io_namelist_entry, only: location
   use rbs_io_namelist_pieces, only: nml_scan
   use rbs_base_check, only: is_given
   implicit none
   private

   public :: reader, find_groups, check_status, take_text, given_reals, given_integers

   !> A file that has been cut into pieces.
   type :: reader
      character(len=:), allocatable :: path
      type(nml_scan) :: scanned
   end type reader

contains

   !> The groups of a name; a message if there are fewer or more than the case may have.
   subroutine find_groups(r, name, least, most, found, messages)
      type(reader), intent(in) :: r
      character(len=*), intent(in) :: name
      integer, intent(in) :: least, most
      integer, allocatable, intent(out) :: found(:)
      type(message_list), intent(inout) :: messages
      integer :: i

      found = pack([(i, i=1, r%scanned%groups)], r%scanned%group(:r%scanned%groups)%name == name)
      if (size(found) < least) then
         call messages%add(r%path//': the group &'//name//' is missing')
      else if (size(found) > most) then
         call messages%add(location(r%path, r%scanned%group(found(most + 1))%line)//': &'//name// &
                           ' stands '//to_text(size(found))//' times; '//to_text(most)//' at the most')
         found = found(:most)
      end if
   end subroutine find_groups

   !> A message for a value that passed the checks and that Fortran does not take all the same.
   subroutine check_status(r, i, status, iomsg, messages)
      type(reader), intent(in) :: r
      integer, intent(in) :: i, status
      character(len=*), intent(in) :: iomsg
      type(message_list), intent(inout) :: messages

      if (status == 0) return
      call messages%add(location(r%path, r%scanned%entry(i)%line)//": '"//trim(r%scanned%entry(i)%name)// &
                        "' cannot be read ("//trim(iomsg)//')')
   end subroutine check_status

   !> A text into its place, with a message where it would be cut: what is left may mean something else.
   subroutine take_text(r, name, given, text, messages)
      type(reader), intent(in) :: r
      character(len=*), intent(in) :: name, given
      character(len=*), intent(out) :: text
      type(message_list), intent(inout) :: messages

      text = given(:min(len(given), len(text)))
      if (len_trim(given) > len(text)) then
         call messages%add(r%path//': '//name//" = '"//trim(given(:40))//"' has "// &
                           to_text(len_trim(given))//' letters; it has '//to_text(len(text))// &
                           ' at the most')
      end if
   end subroutine take_text

   !> The numbers of an array that were given: all up to the last, without holes.
   subroutine given_reals(r, name, values, given, messages)
      type(reader), intent(in) :: r
      character(len=*), intent(in) :: name
      real(wp), intent(in) :: values(:)
      real(wp), allocatable, intent(inout) :: given(:)
      type(message_list), intent(inout) :: messages
      integer :: last

      call find_last(r, name, is_given(values), last, messages)
      if (last > 0) given = values(:last)
   end subroutine given_reals

   subroutine given_integers(r, name, values, given, messages)
      type(reader), intent(in) :: r
      character(len=*), intent(in) :: name
      integer, intent(in) :: values(:)
      integer, allocatable, intent(inout) :: given(:)
      type(message_list), intent(inout) :: messages
      integer :: last

      call find_last(r, name, values /= unset_integer, last, messages)
      if (last > 0) given = values(:last)
   end subroutine given_integers

   subroutine find_last(r, name, there, last, messages)
      type(reader), intent(in) :: r
      character(len=*), intent(in) :: name
      logical, intent(in) :: there(:)
      integer, intent(out) :: last
      type(message_list), intent(inout) :: messages
      integer :: hole

      last = findloc(there, .true., dim=1, back=.true.)
      hole = findloc(there, .false., dim=1)
      if (last == 0 .or. hole == 0 .or. hole > last) return
      call messages%add(r%path//': '//name//'('//to_text(hole)//') is missing before '//name//'('// &
                        to_text(last)//'); give them all')
   end subroutine find_last

end module rbs_io_namelist_group
