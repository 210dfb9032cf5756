!> Reads a case from a namelist file: the scanner cuts the text into groups and entries; each entry is
!> checked against the key that it names and passed to the reader of groups.
module rbs_io_namelist
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan, ieee_positive_inf
   use rbs_base_error, only: error_type, message_list
   use rbs_base_keys, only: key_type, real_kind, integer_kind, word_kind, text_kind
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: lower, to_text
   use rbs_case_case_record, only: case_record
   use rbs_case_group_reader, only: group_reader, ignored
   use rbs_io_namelist_scan, only: nml_entry, nml_group, nml_scan, scan_namelist, most_messages
   use rbs_io_text_file, only: text_file, load_text, read_real, number_wrong, number_not_finite
   implicit none
   private

   public :: read_case

   !> Largest case file that is read [bytes].
   integer, parameter :: most_bytes = 100000000

   !> Longer texts are refused.
   integer, parameter :: text_length = 512

   character(len=*), parameter :: digits = '0123456789'

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
      type(group_reader) :: reader
      integer :: known

      understood = .false.
      known = messages%count
      call load_text(file, path, most_bytes, error)
      if (allocated(error)) then
         call messages%add(error%message)
         return
      end if
      call scan_namelist(file, path(index(path, '/', back=.true.) + 1:), scanned, messages)
      if (messages%count > known) return
      call put_groups()
      ! Values that were not understood would also be reported as missing, which would mislead.
      understood = messages%count == known
      if (understood) call reader%finish(messages)
      understood = messages%count == known
      case = reader%case
      if (understood) call case%validate(messages)

   contains

      !> Read all groups; &units first, as the numbers of the others depend on it.
      subroutine put_groups()
         character(len=8), parameter :: required(3) = ['column  ', 'shear   ', 'flexure ']
         integer :: i, pass

         do pass = 1, 2
            do i = 1, scanned%groups
               if (messages%count > most_messages) return
               if ((scanned%group(i)%name == 'units') .eqv. (pass == 1)) call put_group(scanned%group(i))
            end do
         end do
         ! A frame needs none of the groups of a column.
         if (allocated(reader%case%frame)) return
         do i = 1, size(required)
            if (any(scanned%group(:scanned%groups)%name == required(i))) cycle
            ! Python makes the springs of a column that is drawn.
            if (i > 1 .and. allocated(reader%case%drawing)) cycle
            call messages%add(scanned%path//': the group &'//trim(required(i))//' is missing')
         end do
      end subroutine put_groups

      !> Read one group; first the rule of a spring and the shape of a section, which bring keys.
      subroutine put_group(group)
         type(nml_group), intent(in) :: group
         integer :: i, pass
         logical :: ok

         call reader%open(group%name, scanned%location(group%line), group%line, messages, ok)
         if (.not. ok) return
         do pass = 1, 2
            do i = group%first, group%last
               if (messages%count > most_messages) return
               if (any(scanned%entry(i)%name == [character(len=5) :: 'rule', 'shape']) .eqv. (pass == 1)) then
                  call put_entry(group, i)
               end if
            end do
         end do
      end subroutine put_group

      !> Read one entry, `name = values` or `name(i) = value`.
      subroutine put_entry(group, i)
         type(nml_group), intent(in) :: group
         !> Number of the entry
         integer, intent(in) :: i
         character(len=:), allocatable :: text
         real(wp), allocatable :: number(:)
         integer :: key_index, known

         known = messages%count
         call reader%find(scanned%entry(i)%name, scanned%location(scanned%entry(i)%line), key_index, messages)
         if (messages%count > known .or. key_index == ignored) return
         call check_twice(group, i)
         call read_values(scanned%entry(i), reader%keys(key_index), number, text)
         if (messages%count > known) return
         if (is_text(reader%keys(key_index))) then
            call reader%put_text(key_index, text, messages)
            return
         end if
         ! All subscripted values of a name are put together when the first of them is read; for the others
         ! `number` comes back without values.
         if (scanned%entry(i)%subscript > 0) call gather(group, i, reader%keys(key_index), number)
         if (allocated(number)) call reader%put_numbers(key_index, number)
      end subroutine put_entry

      !> A name (with its subscript) must not appear twice in a group.
      subroutine check_twice(group, i)
         type(nml_group), intent(in) :: group
         integer, intent(in) :: i
         integer :: j

         associate (entry => scanned%entry)
            do j = group%first, i - 1
               if (entry(j)%name /= entry(i)%name) cycle
               if (entry(j)%subscript /= entry(i)%subscript .and. &
                   min(entry(j)%subscript, entry(i)%subscript) > 0) cycle
               call messages%add(scanned%location(entry(i)%line)//" '"//trim(entry(i)%name)// &
                                 "' appears twice in &"//trim(group%name)//', first on line '// &
                                 to_text(entry(j)%line)//'; remove one')
               return
            end do
         end associate
      end subroutine check_twice

      !> Read the values of an entry, and add a message if one is not of the kind of the key, or if they are
      !> too many.
      subroutine read_values(entry, key, number, text)
         type(nml_entry), intent(in) :: entry
         type(key_type), intent(in) :: key
         !> The values; for a word or a text the first one without its quotes
         real(wp), allocatable, intent(out) :: number(:)
         character(len=:), allocatable, intent(out) :: text
         character(len=:), allocatable :: location, what
         real(wp) :: value
         integer :: i, times, total

         location = scanned%location(entry%line)//' '
         allocate (number(min(entry%total, key%most)))
         total = 0
         do i = entry%first, entry%last
            associate (word => scanned%text(scanned%word(i)%first:scanned%word(i)%last))
               call read_value(word, key%kind, value, what)
               if (allocated(what)) then
                  call messages%add(location//trim(entry%name)//' = '//word(:min(len(word), 40))//' '//what)
                  return
               end if
               if (i == entry%first .and. is_text(key)) call unquote(word, text)
            end associate
            ! 3*0.5 stands for three values; those beyond the room for the key are counted, not stored.
            times = min(scanned%word(i)%times, size(number) - total)
            number(total + 1:total + times) = value
            total = total + times
         end do
         ! From here on the place of the last value, counted from the subscript; `min` keeps the sum in range.
         total = min(entry%total, huge(1) - entry%subscript) + max(entry%subscript - 1, 0)
         if (entry%subscript > 0 .and. key%most == 1) then
            call messages%add(location//"'"//trim(entry%name)//"' takes no subscript")
         else if (entry%subscript > 0 .and. total > entry%subscript) then
            call messages%add(location//"'"//trim(entry%name)//'('//to_text(entry%subscript)//")' takes "// &
                              'one value, not '//to_text(entry%total)//'; give a list without subscript')
         else if (total > key%most) then
            call messages%add(location//"'"//trim(entry%name)//"' has "//to_text(total)// &
                              ' values; it takes '//to_text(key%most)//' at the most')
         end if
      end subroutine read_values

      !> The values of all subscripted entries with one name, for the first of them; not allocated for the
      !> other entries, or if values are missing.
      subroutine gather(group, i, key, number)
         type(nml_group), intent(in) :: group
         !> Number of the entry
         integer, intent(in) :: i
         type(key_type), intent(in) :: key
         real(wp), allocatable, intent(out) :: number(:)
         character(len=:), allocatable :: what
         logical, allocatable :: given(:)
         integer :: j, last

         associate (entry => scanned%entry)
            last = 0
            do j = group%first, group%last
               if (entry(j)%name /= entry(i)%name) cycle
               if (j < i) return
               last = max(last, entry(j)%subscript)
            end do
            if (last > key%most) return                ! is reported with its entry
            allocate (number(last), given(last))
            given = .false.
            do j = i, group%last
               if (entry(j)%name /= entry(i)%name .or. entry(j)%subscript == 0) cycle
               associate (word => scanned%word(entry(j)%first))
                  call read_value(scanned%text(word%first:word%last), key%kind, number(entry(j)%subscript), &
                                  what)
               end associate
               given(entry(j)%subscript) = .true.
            end do
         end associate
         j = findloc(given, .false., dim=1)
         if (j == 0) return
         call messages%add(scanned%path//': '//trim(group%name)//': '//trim(key%name)//'('//to_text(j)// &
                           ') is missing before '//trim(key%name)//'('//to_text(last)//'); give them all')
         deallocate (number)
      end subroutine gather

   end subroutine read_case

   !> Whether the value of a key is a text in quotes.
   pure logical function is_text(key)
      type(key_type), intent(in) :: key

      is_text = key%kind == text_kind .or. key%kind == word_kind
   end function is_text

   !> The value of a word, or the reason why it is refused.
   subroutine read_value(word, kind, value, what)
      !> As it stands in the file, with its quotes
      character(len=*), intent(in) :: word
      !> Kind of the key, see `rbs_base_keys`
      character(len=1), intent(in) :: kind
      !> A logical as 0 or 1; 0 for a text
      real(wp), intent(out) :: value
      !> The reason, as the end of a message; not allocated if the value is valid
      character(len=:), allocatable, intent(out) :: what
      integer :: status, first
      logical :: quoted

      value = 0.0_wp
      quoted = word(1:1) == '''' .or. word(1:1) == '"'
      select case (kind)
      case (text_kind, word_kind)
         if (.not. quoted) then
            what = "must be a text in quotes: '"//word(:min(len(word), 40))//"'"
         else if (len(word) > text_length) then
            what = 'is longer than '//to_text(text_length - 2)//' characters'
         end if
      case (real_kind)
         call read_real(word, value, status)
         if (quoted) then
            what = 'must be a number without quotes'
         else if (status == number_wrong) then
            what = 'is not a number; write it like 1.6 or 7.04e8, without a unit'
         else if (status == number_not_finite .and. scan(word, digits) > 0) then
            what = 'is too large to be a finite number; check its exponent'
         else if (status == number_not_finite) then
            ! The check of the values reports it.
            value = ieee_value(value, ieee_positive_inf)
            if (word(1:1) == '-') value = -value
            if (scan(word, 'aA') > 0) value = ieee_value(value, ieee_quiet_nan)
         end if
      case (integer_kind)
         first = merge(2, 1, scan(word(1:1), '+-') == 1)
         if (len(word) < first .or. len(word) > 9 .or. verify(word(first:), digits) /= 0) then
            what = 'must be a whole number'
         else
            call read_real(word, value, status)
         end if
      case default                                       ! logical_kind
         select case (lower(word))
         case ('.true.', 't', 'true')
            value = 1.0_wp
         case ('.false.', 'f', 'false')
            value = 0.0_wp
         case default
            what = 'must be .true. or .false.'
         end select
      end select
   end subroutine read_value

   !> A text without its quotes; doubled quotes within become single.
   subroutine unquote(quoted, text)
      character(len=*), intent(in) :: quoted
      character(len=:), allocatable, intent(out) :: text
      integer :: i, length

      allocate (character(len=len(quoted)) :: text)
      length = 0
      i = 2
      do while (i < len(quoted))
         length = length + 1
         text(length:length) = quoted(i:i)
         if (quoted(i:i) == quoted(1:1)) i = i + 1
         i = i + 1
      end do
      text = text(:length)
   end subroutine unquote

end module rbs_io_namelist
