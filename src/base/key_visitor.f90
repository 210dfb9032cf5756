!> How a record presents its keys: its procedure `visit` names each component once, with unit, bounds and
!> meaning, to a visitor. The visitor does one of five things:
!>
!>     collect   makes the list of keys with their defaults, for documentation, hints and the reader
!>     put       sets one component by name
!>     take      sets all numbers in their order; those that are not given stay as they are
!>     check     adds a message for each value that is missing or out of bounds
!>     list      lists the values that differ from the defaults, for the writer
module rbs_base_key_visitor
   use rbs_base_check, only: is_given
   use rbs_base_constants, only: unset
   use rbs_base_error, only: message_list
   use rbs_base_keys, only: key_type, bound_type, any_number, check_number, is_inside, find_key, &
                            choice_number, choice_name, choice_list, real_kind, integer_kind, logical_kind, &
                            word_kind, text_kind, key_length
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text, suggestion
   implicit none
   private

   public :: key_visitor, entry_type, visited_record

   integer, parameter :: collecting = 1, putting = 2, checking = 3, listing = 4, taking = 5

   !> A record whose components are the values of keys.
   type, abstract :: visited_record
   contains
      procedure(visit_record), deferred :: visit
      procedure :: check => check_record
   end type visited_record

   !> One key with its value.
   type :: entry_type
      character(len=key_length) :: name = ''
      character(len=1) :: kind = real_kind
      !> Its values: real numbers, whole numbers, or 0 and 1 for logicals
      real(wp), allocatable :: number(:)
      !> In place of numbers
      character(len=:), allocatable :: text
   end type entry_type

   type :: key_visitor
      !> Name of the record in messages: 'column'
      character(len=:), allocatable :: group
      !> The list of keys
      integer :: count = 0
      type(key_type), allocatable :: keys(:)
      !> Values that a listing found
      integer :: listed = 0
      type(entry_type), allocatable :: entry(:)
      !> Whether all numbers passed the last check
      logical :: sound = .true.
      integer, private :: mode = collecting
      !> The value to put, or the values to take, which stay where they are; how many have been taken
      character(len=key_length), private :: wanted = ''
      real(wp), pointer, contiguous, private :: number(:) => null()
      integer, private :: taken = 0
      character(len=:), allocatable, private :: text
      type(message_list), private :: messages
   contains
      procedure :: collect, put, take, start_check, end_check, list
      procedure, private :: real_key, integer_key, logical_key, choice_key, text_key, long_text_key
      procedure, private :: real_list_key, integer_list_key
      !> `call visitor%parameters(keys, value)`, the parameters of a rule
      procedure :: parameters
      !> `call visitor%key(name, component, unit, bound, meaning)`
      generic :: key => real_key, integer_key, logical_key, real_list_key, integer_list_key
      !> `call visitor%word(name, component, meaning, choices)`; the component is the word, or its place among
      !> the choices
      generic :: word => text_key, choice_key
      !> `call visitor%long_text(name, component, meaning)`
      generic :: long_text => long_text_key
   end type key_visitor

   abstract interface
      !> Call the procedures `key`, `word` and `long_text` of the visitor, once for each component.
      subroutine visit_record(self, v)
         import :: key_visitor, visited_record
         class(visited_record), intent(inout) :: self
         type(key_visitor), intent(inout) :: v
      end subroutine visit_record
   end interface

contains

   !> Add a message for each value of a record that is missing or out of bounds.
   subroutine check_record(self, group, messages, sound)
      class(visited_record), intent(inout) :: self
      !> Name of the record in messages
      character(len=*), intent(in) :: group
      type(message_list), intent(inout) :: messages
      !> Whether all values passed
      logical, intent(out), optional :: sound
      type(key_visitor) :: v

      call v%start_check(group)
      call self%visit(v)
      call v%end_check(messages)
      if (present(sound)) sound = v%sound
   end subroutine check_record

   !> The next visit collects keys; the record must be a new one, as its values are the defaults.
   subroutine collect(self, group)
      class(key_visitor), intent(inout) :: self
      !> Name of the record in messages
      character(len=*), intent(in) :: group

      self%group = trim(group)
      self%mode = collecting
      self%count = 0
      if (.not. allocated(self%keys)) allocate (self%keys(24))
   end subroutine collect

   !> The next visit puts values, or a text, into the component of one key.
   subroutine put(self, name, number, text)
      class(key_visitor), intent(inout) :: self
      !> Name of the key, and one of the two: its values, which must stay where they are, or its text
      character(len=*), intent(in) :: name
      real(wp), intent(in), contiguous, target, optional :: number(:)
      character(len=*), intent(in), optional :: text

      self%mode = putting
      self%wanted = name
      if (present(number)) self%number => number
      if (present(text)) self%text = text
   end subroutine put

   !> The next visit sets the numbers of a record in their order.
   subroutine take(self, number)
      class(key_visitor), intent(inout) :: self
      !> A value for each key, which must stay where it is; `unset`: the component stays as it is
      real(wp), intent(in), contiguous, target :: number(:)

      self%mode = taking
      self%number => number
      self%taken = 0
   end subroutine take

   !> The next visit checks values, and keeps a message for each that fails.
   subroutine start_check(self, group)
      class(key_visitor), intent(inout) :: self
      !> Name of the record in messages
      character(len=*), intent(in) :: group

      self%group = trim(group)
      self%mode = checking
      self%sound = .true.
      self%messages = message_list()
   end subroutine start_check

   !> Append the messages of the visit to a list.
   subroutine end_check(self, messages)
      class(key_visitor), intent(inout) :: self
      type(message_list), intent(inout) :: messages

      call messages%join(self%messages)
      self%messages = message_list()
   end subroutine end_check

   !> The next visit lists the values that differ from the defaults of the list of keys, which has been
   !> collected before.
   subroutine list(self)
      class(key_visitor), intent(inout) :: self

      self%mode = listing
      self%listed = 0
      if (allocated(self%entry)) deallocate (self%entry)
      allocate (self%entry(self%count))
   end subroutine list

   !> A key whose component is a real number.
   subroutine real_key(self, name, x, unit, bound, meaning, optional)
      class(key_visitor), intent(inout) :: self
      !> Name of the key; component, set when the visit puts or takes values
      character(len=*), intent(in) :: name
      real(wp), intent(inout) :: x
      character(len=*), intent(in) :: unit, meaning
      type(bound_type), intent(in) :: bound
      !> Whether the value may be missing
      logical, intent(in), optional :: optional

      if (is_done(self, name, x, bound)) return
      call one_number(self, key_type(name=name, unit=unit, bound=bound, default=x, meaning=meaning, &
                                     optional=is_true(optional)), x)
   end subroutine real_key

   !> A key whose component is a whole number: handled as a real one, which is rounded at the end.
   subroutine integer_key(self, name, i, unit, bound, meaning, optional)
      class(key_visitor), intent(inout) :: self
      character(len=*), intent(in) :: name
      integer, intent(inout) :: i
      character(len=*), intent(in) :: unit, meaning
      type(bound_type), intent(in) :: bound
      logical, intent(in), optional :: optional
      real(wp) :: x

      x = unset
      if (is_given(i)) x = i
      if (.not. is_done(self, name, x, bound)) then
         call one_number(self, key_type(name=name, kind=integer_kind, unit=unit, bound=bound, default=x, &
                                        meaning=meaning, optional=is_true(optional)), x)
      end if
      if (is_given(x)) i = nint(x)
   end subroutine integer_key

   !> A key whose component is a logical: handled as the number 0 or 1.
   subroutine logical_key(self, name, l, meaning)
      class(key_visitor), intent(inout) :: self
      character(len=*), intent(in) :: name
      logical, intent(inout) :: l
      character(len=*), intent(in) :: meaning
      real(wp) :: x

      x = merge(1.0_wp, 0.0_wp, l)
      if (.not. is_done(self, name, x, any_number)) then
         call one_number(self, key_type(name=name, kind=logical_kind, default=x, meaning=meaning), x)
      end if
      l = abs(x) > 0.0_wp
   end subroutine logical_key

   !> A key whose component is the place of a word among the choices.
   subroutine choice_key(self, name, choice, meaning, choices)
      class(key_visitor), intent(inout) :: self
      character(len=*), intent(in) :: name
      !> Place of the word; the choices are separated by blanks
      integer, intent(inout) :: choice
      character(len=*), intent(in) :: meaning, choices
      real(wp) :: x

      x = choice
      ! A check is of the place, not of the bounds of a number.
      if (self%mode == checking .or. .not. is_done(self, name, x, any_number)) then
         call one_number(self, key_type(name=name, kind=word_kind, default=x, choices=choices, &
                                        meaning=meaning), x)
      end if
      choice = nint(x)
   end subroutine choice_key

   !> The parameters of a rule, a value for each of its keys; a word is its number among the choices. A check
   !> does nothing here, as the rule itself is checked.
   subroutine parameters(self, keys, value)
      class(key_visitor), intent(inout) :: self
      type(key_type), intent(in) :: keys(:)
      real(wp), intent(inout) :: value(:)
      integer :: i

      if (self%mode == checking) return
      do i = 1, size(keys)
         if (is_done(self, keys(i)%name, value(i), keys(i)%bound)) cycle
         call one_number(self, keys(i), value(i))
      end do
   end subroutine parameters

   !> Do what most visits do without making a key: put or take the number, or pass a check if it is within its
   !> bounds. False if the visit needs the key, to collect, to list or to report (`one_number`).
   logical function is_done(self, name, x, bound)
      type(key_visitor), intent(inout) :: self
      character(len=*), intent(in) :: name
      real(wp), intent(inout) :: x
      type(bound_type), intent(in) :: bound

      is_done = self%mode == putting .or. self%mode == taking
      if (self%mode == putting) then
         if (is_wanted(self, name)) x = self%number(1)
      else if (self%mode == taking) then
         self%taken = self%taken + 1
         if (is_given(self%number(self%taken))) x = self%number(self%taken)
      else if (self%mode == checking) then
         is_done = is_inside(x, bound)
      end if
   end function is_done

   !> Whether a key is the one that the visit puts.
   pure logical function is_wanted(self, name)
      type(key_visitor), intent(in) :: self
      character(len=*), intent(in) :: name

      ! Most names differ in their first letter.
      is_wanted = name(1:1) == self%wanted(1:1)
      if (is_wanted) is_wanted = name == self%wanted
   end function is_wanted

   !> What `is_done` has left of the key of one number: collect it, report it in a check, or list it. The
   !> number may stand for a whole number, a logical or the place of a word.
   subroutine one_number(self, key, x)
      type(key_visitor), intent(inout) :: self
      type(key_type), intent(in) :: key
      real(wp), intent(inout) :: x

      select case (self%mode)
      case (collecting)
         call append(self, key)
      case (checking)
         if (key%kind /= word_kind) then
            call check_number(x, self%group, key, self%messages, self%sound)
         else if (choice_name(key, nint(x)) == '') then
            self%sound = .false.
            call self%messages%add(self%group//': '//trim(key%name)//' is not known; it is one of '// &
                                   trim(key%choices))
         end if
      case (listing)
         if (is_given(x)) call list_numbers(self, key%name, [x])
      case default                                  ! putting and taking are done in `is_done`
      end select
   end subroutine one_number

   !> A key whose component is a list of numbers; not allocated: not given.
   subroutine real_list_key(self, name, x, unit, bound, meaning, most, required)
      class(key_visitor), intent(inout) :: self
      character(len=*), intent(in) :: name
      real(wp), allocatable, intent(inout) :: x(:)
      character(len=*), intent(in) :: unit, meaning
      type(bound_type), intent(in) :: bound
      !> Largest number of values
      integer, intent(in) :: most
      !> Whether the list must be given
      logical, intent(in), optional :: required

      if (self%mode == putting) then
         if (is_wanted(self, name)) x = self%number
         return
      end if
      call number_list(self, key_type(name=name, unit=unit, bound=bound, optional=.not. is_true(required), &
                                      most=most, meaning=meaning), x)
   end subroutine real_list_key

   !> A key whose component is a list of whole numbers; not allocated: not given.
   subroutine integer_list_key(self, name, i, unit, bound, meaning, most, required)
      class(key_visitor), intent(inout) :: self
      character(len=*), intent(in) :: name
      integer, allocatable, intent(inout) :: i(:)
      character(len=*), intent(in) :: unit, meaning
      type(bound_type), intent(in) :: bound
      integer, intent(in) :: most
      logical, intent(in), optional :: required
      real(wp), allocatable :: x(:)

      if (self%mode == putting) then
         if (is_wanted(self, name)) i = nint(self%number)
         return
      end if
      if (allocated(i)) x = real(i, wp)
      call number_list(self, key_type(name=name, kind=integer_kind, unit=unit, bound=bound, &
                                      optional=.not. is_true(required), most=most, meaning=meaning), x)
   end subroutine integer_list_key

   !> A list of numbers when the visit does not put values: collect its key, list it, or check each number.
   subroutine number_list(self, key, x)
      type(key_visitor), intent(inout) :: self
      type(key_type), intent(in) :: key
      real(wp), allocatable, intent(inout) :: x(:)
      type(key_type) :: one
      integer :: i

      select case (self%mode)
      case (collecting)
         call append(self, key)
      case (listing)
         if (allocated(x)) call list_numbers(self, key%name, x)
      case (checking)
         if (.not. allocated(x)) then
            if (.not. key%optional) call missing(self, key)
            return
         end if
         one = key
         one%optional = .false.
         do i = 1, size(x)
            if (is_inside(x(i), key%bound)) cycle
            if (size(x) > 1) one%name = trim(key%name)//'('//to_text(i)//')'
            call check_number(x(i), self%group, one, self%messages, self%sound)
         end do
      case default                                  ! putting is done by the caller; lists are not taken
      end select
   end subroutine number_list

   !> A key whose component is a word or a text of limited length. Without choices it is free; an empty text
   !> means: not given.
   subroutine text_key(self, name, text, meaning, choices, required)
      class(key_visitor), intent(inout) :: self
      character(len=*), intent(in) :: name
      character(len=*), intent(inout) :: text
      character(len=*), intent(in) :: meaning
      !> Words that are allowed, separated by blanks
      character(len=*), intent(in), optional :: choices
      !> Whether the text must be given
      logical, intent(in), optional :: required
      type(key_type) :: key
      character(len=:), allocatable :: value

      if (self%mode == putting) then
         if (.not. is_wanted(self, name)) return
      end if
      key = key_type(name=name, kind=text_kind, default_text=text, optional=.not. is_true(required), &
                     meaning=meaning)
      if (present(choices)) then
         key%kind = word_kind
         key%choices = choices
      end if
      value = trim(text)
      call one_text(self, key, value)
      if (len(value) > len(text)) then
         call self%messages%add(self%group//': '//name//" = '"//value(:min(40, len(value)))// &
                                "' has "//to_text(len(value))//' characters; at most '//to_text(len(text))// &
                                ' are allowed')
      end if
      text = value
   end subroutine text_key

   !> A key whose component is a text of any length; not allocated: not given.
   subroutine long_text_key(self, name, text, meaning, required)
      class(key_visitor), intent(inout) :: self
      character(len=*), intent(in) :: name
      character(len=:), allocatable, intent(inout) :: text
      character(len=*), intent(in) :: meaning
      logical, intent(in), optional :: required

      call one_text(self, key_type(name=name, kind=text_kind, optional=.not. is_true(required), &
                                   meaning=meaning), text)
   end subroutine long_text_key

   !> Collect, put, check or list a text or a word, whichever the visit does.
   subroutine one_text(self, key, text)
      type(key_visitor), intent(inout) :: self
      type(key_type), intent(in) :: key
      character(len=:), allocatable, intent(inout) :: text
      character(len=len(key%choices)) :: name(16)
      integer :: i

      select case (self%mode)
      case (collecting)
         call append(self, key)
      case (putting)
         if (key%name == self%wanted) text = trim(self%text)
      case (checking)
         if (.not. key%optional) then
            if (.not. allocated(text)) text = ''
            if (text == '') call missing(self, key)
         end if
         ! Other texts may not be allocated.
         if (key%kind /= word_kind) return
         if (text == '' .or. choice_number(key, text) > 0) return
         self%sound = .false.
         name = [(choice_name(key, i), i=1, size(name))]
         call self%messages%add(self%group//': '//trim(key%name)//" = '"//text//"' is not known; it is "// &
                                'one of '//trim(choice_list(key))//suggestion(text, name(:count(name /= ''))))
      case (listing)
         if (.not. allocated(text)) return
         if (text == self%keys(find_key(self%keys(:self%count), key%name))%default_text) return
         self%listed = self%listed + 1
         self%entry(self%listed) = entry_type(key%name, text_kind, text=text)
      case default                                  ! taking is of numbers alone
      end select
   end subroutine one_text

   !> Report that a value is missing which must be given.
   subroutine missing(self, key)
      type(key_visitor), intent(inout) :: self
      type(key_type), intent(in) :: key
      character(len=:), allocatable :: remedy

      remedy = 'give it'
      if (key%kind == word_kind) remedy = 'it is one of '//choice_list(key)
      self%sound = .false.
      call self%messages%add(self%group//': '//trim(key%name)//' is missing; '//trim(remedy))
   end subroutine missing

   !> Whether an optional argument is there and true.
   pure logical function is_true(choice)
      logical, intent(in), optional :: choice

      is_true = .false.
      if (present(choice)) is_true = choice
   end function is_true

   !> Add a key to those that are collected.
   subroutine append(self, key)
      type(key_visitor), intent(inout) :: self
      type(key_type), intent(in) :: key
      type(key_type), allocatable :: longer(:)

      if (self%count == size(self%keys)) then
         allocate (longer(2*self%count))
         longer(:self%count) = self%keys
         call move_alloc(longer, self%keys)
      end if
      self%count = self%count + 1
      self%keys(self%count) = key
   end subroutine append

   !> List the values of a key, unless they are its default; the keys have been collected before.
   subroutine list_numbers(self, name, number)
      type(key_visitor), intent(inout) :: self
      character(len=*), intent(in) :: name
      real(wp), intent(in) :: number(:)

      associate (key => self%keys(find_key(self%keys(:self%count), name)))
         if (key%most == 1 .and. is_given(key%default)) then
            if (.not. abs(number(1) - key%default) > 0.0_wp) return
         end if
         self%listed = self%listed + 1
         if (key%kind == word_kind) then
            self%entry(self%listed) = entry_type(name, text_kind, &
                                                 text=trim(choice_name(key, nint(number(1)))))
         else
            self%entry(self%listed) = entry_type(name, key%kind, number=number)
         end if
      end associate
   end subroutine list_numbers

end module rbs_base_key_visitor
