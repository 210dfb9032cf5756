!> The second pass over a namelist file: each entry is checked against the key that it names.
module rbs_io_namelist_entry
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan, ieee_negative_inf, ieee_positive_inf
   use rbs_base_error, only: message_list
   use rbs_base_kinds, only: wp
   use rbs_base_keys, only: key_type, real_kind, integer_kind, logical_kind, word_kind, text_kind
   use rbs_base_text, only: lower, to_text, integer_length
   use rbs_io_namelist_pieces, only: nml_entry, nml_group, nml_scan
   use rbs_io_text_file, only: read_real, number_ok, number_wrong, number_not_finite
   implicit none
   private

   public :: location, check_twice, check_values, entry_text, entry_numbers

   !> Longer texts are refused.
   integer, parameter :: text_length = 512

contains

   !> 'case.nml line 4', for the start of a message.
   pure function location(path, line) result(text)
      character(len=*), intent(in) :: path
      integer, intent(in) :: line
      character(len=len(path) + 6 + integer_length(line)) :: text

      text = path//' line '//to_text(line)
   end function location

   !> A name (with its subscript) must not appear twice in a group.
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
                           "' appears twice in &"//trim(group%name)//', first on line '// &
                           to_text(scanned%entry(j)%line)//'; remove one')
         return
      end do
   end subroutine check_twice

   !> Every value must be of the kind of the key, and there must not be too many.
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

   !> The reason why a value is refused; empty if it is valid.
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
      case (text_kind, word_kind)
         if (.not. quoted) then
            what = "must be a text in quotes: '"//clean(text)//"'"
         else if (len(text) > text_length) then
            what = 'is longer than '//to_text(text_length - 2)//' characters'
         end if
      case (real_kind)
         call read_real(text, value, status)
         if (status == number_ok) return
         if (quoted) then
            what = 'must be a number without quotes'
         else if (status == number_wrong) then
            what = 'is not a number; write it like 1.6 or 7.04e8, without a unit'
         else if (status == number_not_finite .and. scan(text, '0123456789') > 0) then
            what = 'is too large to be a finite number; check its exponent'
         end if
      case (integer_kind)
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

   !> The text of an entry without its quotes; doubled quotes within become single.
   subroutine entry_text(entry, text)
      type(nml_entry), intent(in) :: entry
      character(len=:), allocatable, intent(out) :: text
      character(len=:), allocatable :: quoted
      integer :: i, length

      quoted = entry%value(1)%text
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
   end subroutine entry_text

   !> The numbers of an entry. If it has a subscript, the first entry of its name gets the numbers of all
   !> entries of that name; the result is not allocated for the other entries, or if numbers are missing.
   subroutine entry_numbers(path, scanned, group, i, key, number, messages)
      character(len=*), intent(in) :: path
      type(nml_scan), intent(in) :: scanned
      type(nml_group), intent(in) :: group
      !> Number of the entry
      integer, intent(in) :: i
      type(key_type), intent(in) :: key
      real(wp), allocatable, intent(out) :: number(:)
      type(message_list), intent(inout) :: messages
      integer :: j, k, at, last
      logical, allocatable :: there(:)

      if (scanned%entry(i)%subscript == 0) then
         allocate (number(sum(scanned%entry(i)%value(:scanned%entry(i)%values)%times)))
         at = 0
         do k = 1, scanned%entry(i)%values
            associate (value => scanned%entry(i)%value(k))
               number(at + 1:at + value%times) = one_number(value%text, key%kind)
               at = at + value%times
            end associate
         end do
         return
      end if
      last = 0
      do j = group%first, group%last
         if (scanned%entry(j)%name /= scanned%entry(i)%name) cycle
         if (j < i) return
         last = max(last, scanned%entry(j)%subscript)
      end do
      if (last > key%most) return                   ! has been reported
      allocate (number(last), there(last))
      there = .false.
      do j = i, group%last
         if (scanned%entry(j)%name /= scanned%entry(i)%name .or. scanned%entry(j)%subscript == 0) cycle
         number(scanned%entry(j)%subscript) = one_number(scanned%entry(j)%value(1)%text, key%kind)
         there(scanned%entry(j)%subscript) = .true.
      end do
      j = findloc(there, .false., dim=1)
      if (j == 0) return
      call messages%add(path//': '//trim(group%name)//': '//trim(key%name)//'('//to_text(j)// &
                        ') is missing before '//trim(key%name)//'('//to_text(last)//'); give them all')
      deallocate (number)
   end subroutine entry_numbers

   !> The number of a value that has been checked.
   real(wp) function one_number(text, kind)
      character(len=*), intent(in) :: text
      character(len=1), intent(in) :: kind
      integer :: status

      if (kind == logical_kind) then
         one_number = merge(1.0_wp, 0.0_wp, scan(lower(text(:min(2, len(text)))), 't') > 0)
      else
         call read_real(text, one_number, status)
         if (status == number_wrong) one_number = 0.0_wp
         if (status == number_not_finite) one_number = not_finite(text)
      end if
   end function one_number

   !> NaN or infinity, which the check of the values then reports.
   real(wp) function not_finite(text)
      character(len=*), intent(in) :: text

      if (scan(text, 'aA') > 0) then
         not_finite = ieee_value(not_finite, ieee_quiet_nan)
      else if (text(1:1) == '-') then
         not_finite = ieee_value(not_finite, ieee_negative_inf)
      else
         not_finite = ieee_value(not_finite, ieee_positive_inf)
      end if
   end function not_finite

   !> A short piece of a text for a message.
   pure function clean(text)
      character(len=*), intent(in) :: text
      character(len=min(len(text), 40)) :: clean

      clean = text
   end function clean

end module rbs_io_namelist_entry
