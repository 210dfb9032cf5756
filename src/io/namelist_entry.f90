!> Second look at a namelist file: each entry against the names that its group has.
module rbs_io_namelist_entry
   use rbs_base_error, only: message_list
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: lower, nearest_name, list_of, to_text, integer_length
   use rbs_io_namelist_pieces, only: nml_entry, nml_group, nml_scan
   use rbs_io_namelist_scan, only: most_messages
   use rbs_io_text_file, only: read_real, number_wrong, number_not_finite
   implicit none
   private

   public :: key_type, key, check_group_name, entry_text, location

   !> Texts longer than this are refused: they would be cut.
   integer, parameter, public :: text_length = 512

   !> A name that a group has.
   type :: key_type
      character(len=32) :: name
      !> 'r' real, 'i' whole number, 'l' logical, 's' text
      character(len=1) :: kind
      !> Most values
      integer :: most
   end type key_type

contains

   !> A name with its kind and most values (one, if not said).
   pure type(key_type) function key(name, kind, most)
      character(len=*), intent(in) :: name
      character(len=1), intent(in) :: kind
      integer, intent(in), optional :: most

      key = key_type(name=name, kind=kind, most=1)
      if (present(most)) key%most = most
   end function key

   !> 'case.nml line 4', for the begin of a message.
   pure function location(path, line) result(text)
      character(len=*), intent(in) :: path
      integer, intent(in) :: line
      character(len=len(path) + 6 + integer_length(line)) :: text

      text = path//' line '//to_text(line)
   end function location

   !> A message if a group is none of the valid ones.
   subroutine check_group_name(path, group, valid, messages)
      character(len=*), intent(in) :: path
      type(nml_group), intent(in) :: group
      character(len=*), intent(in) :: valid(:)
      type(message_list), intent(inout) :: messages

      if (any(valid == group%name) .or. messages%count > most_messages) return
      call messages%add(location(path, group%line)//': the group &'//trim(group%name)// &
                        " is not known; did you mean '&"//nearest_name(group%name, valid)// &
                        "'? Groups are "//list_of(valid))
   end subroutine check_group_name

   !> One entry as a namelist of its own, `&group name = values /`, if it is sound.
   subroutine entry_text(path, scanned, group, i, keys, text, messages)
      character(len=*), intent(in) :: path
      type(nml_scan), intent(in) :: scanned
      type(nml_group), intent(in) :: group
      !> Number of the entry
      integer, intent(in) :: i
      !> Names that the group has
      type(key_type), intent(in) :: keys(:)
      !> Not allocated if the entry is not sound
      character(len=:), allocatable, intent(out) :: text
      type(message_list), intent(inout) :: messages
      character(len=len(keys%name)) :: names(size(keys))
      integer :: place, known

      known = messages%count
      if (known > most_messages) return
      names = keys%name
      associate (entry => scanned%entry(i))
         do place = 1, size(keys)
            if (keys(place)%name == entry%name) exit
         end do
         if (place > size(keys)) then
            call messages%add(location(path, entry%line)//': &'//trim(group%name)//" has no '"// &
                              trim(entry%name)//"'; did you mean '"// &
                              nearest_name(entry%name, names)//"'?")
            return
         end if
         call check_twice(path, scanned, group, i, messages)
         call check_values(path, entry, keys(place), messages)
         if (messages%count > known) return
         text = '&'//trim(group%name)//' '//trim(entry%name)
         if (entry%subscript > 0) text = text//'('//to_text(entry%subscript)//')'
         text = text//' ='
         call add_values(entry, text)
         text = text//' /'
      end associate
   end subroutine entry_text

   !> The same name (and subscript) must not come twice in a group.
   subroutine check_twice(path, scanned, group, i, messages)
      character(len=*), intent(in) :: path
      type(nml_scan), intent(in) :: scanned
      type(nml_group), intent(in) :: group
      integer, intent(in) :: i
      type(message_list), intent(inout) :: messages
      integer :: j

      do j = group%first, i - 1
         if (scanned%entry(j)%name /= scanned%entry(i)%name) cycle
         if (scanned%entry(j)%subscript /= scanned%entry(i)%subscript .and. &
             scanned%entry(j)%subscript > 0 .and. scanned%entry(i)%subscript > 0) cycle
         call messages%add(location(path, scanned%entry(i)%line)//": '"//trim(scanned%entry(i)%name)// &
                           "' stands twice in &"//trim(group%name)//', first on line '// &
                           to_text(scanned%entry(j)%line)//'; remove one')
         return
      end do
   end subroutine check_twice

   !> Every value must be of the kind that the name wants, and there must not be too many.
   subroutine check_values(path, entry, wanted, messages)
      character(len=*), intent(in) :: path
      type(nml_entry), intent(in) :: entry
      type(key_type), intent(in) :: wanted
      type(message_list), intent(inout) :: messages
      character(len=:), allocatable :: what
      integer :: i, total

      total = max(entry%subscript - 1, 0)
      do i = 1, entry%values
         total = total + entry%value(i)%times
         call find_fault(entry%value(i)%text, wanted%kind, what)
         if (what /= '') then
            call messages%add(location(path, entry%line)//': '//trim(entry%name)//' = '// &
                              clean(entry%value(i)%text)//' '//what)
            return
         end if
      end do
      if (entry%subscript > 0 .and. wanted%most == 1) then
         call messages%add(location(path, entry%line)//": '"//trim(entry%name)//"' takes no subscript")
      else if (entry%subscript > 0 .and. total > entry%subscript) then
         call messages%add(location(path, entry%line)//": '"//trim(entry%name)//'('// &
                           to_text(entry%subscript)//")' takes one value, not "// &
                           to_text(total - entry%subscript + 1)//'; give a list without subscript')
      else if (total > wanted%most) then
         call messages%add(location(path, entry%line)//": '"//trim(entry%name)//"' has "// &
                           to_text(total)//' values; it takes '//to_text(wanted%most)//' at the most')
      end if
   end subroutine check_values

   !> What is wrong with a value; empty if nothing is.
   subroutine find_fault(text, kind, what)
      character(len=*), intent(in) :: text
      character(len=1), intent(in) :: kind
      character(len=:), allocatable, intent(out) :: what
      real(wp) :: value
      integer :: status, first
      logical :: quoted

      what = ''
      quoted = text(1:1) == '''' .or. text(1:1) == '"'
      select case (kind)
      case ('s')
         if (.not. quoted) then
            what = "must be a text in quotes: '"//clean(text)//"'"
         else if (len(text) > text_length) then
            what = 'is longer than '//to_text(text_length - 2)//' letters'
         end if
      case ('r')
         call read_real(text, value, status)
         if (quoted) then
            what = 'must be a number without quotes'
         else if (status == number_wrong) then
            what = 'is not a number; write it like 1.6 or 7.04e8, without a unit'
         else if (status == number_not_finite .and. scan(text, '0123456789') > 0) then
            what = 'is too large to be a finite number; check its exponent'
         end if
      case ('i')
         first = merge(2, 1, scan(text(1:1), '+-') == 1)
         if (len(text) < first .or. len(text) > 9 .or. verify(text(first:), '0123456789') /= 0) then
            what = 'must be a whole number'
         end if
      case default
         select case (lower(text))
         case ('.true.', '.false.', 't', 'f', 'true', 'false')
            what = ''
         case default
            what = 'must be .true. or .false.'
         end select
      end select
   end subroutine find_fault

   !> Put the values of an entry behind a text, separated by commas.
   subroutine add_values(entry, text)
      type(nml_entry), intent(in) :: entry
      character(len=:), allocatable, intent(inout) :: text
      integer :: i

      do i = 1, entry%values
         if (i > 1) text = text//','
         if (entry%value(i)%times > 1) text = text//to_text(entry%value(i)%times)//'*'
         text = text//entry%value(i)%text
      end do
   end subroutine add_values

   !> A short piece of a text for a message.
   pure function clean(text)
      character(len=*), intent(in) :: text
      character(len=min(len(text), 40)) :: clean

      clean = text
   end function clean

end module rbs_io_namelist_entry
