!> The list of all keys, as JSON for other programs and as a table for readers.
module rbs_case_key_list
   use rbs_base_check, only: is_given
   use rbs_base_constants, only: unset
   use rbs_base_error, only: bad_input, error_type, fatal_error, message_list
   use rbs_base_key_visitor, only: key_visitor
   use rbs_base_keys, only: key_type, bound_text, choice_name, choice_length, real_kind, integer_kind, &
                            logical_kind, word_kind, text_kind
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: exact_text, lower, suggestion, to_text, text_buffer
   use rbs_case_group_reader, only: group_names, group_reader, section_groups
   use rbs_hysteresis_registry, only: rule_names, keys_of, places_of
   use rbs_section_shape, only: new_shape, shape_names, shape_type
   implicit none
   private

   public :: keys_as_json, keys_as_table

   !> Kinds of values, and their names.
   character(len=*), parameter :: kinds = real_kind//integer_kind//logical_kind//word_kind//text_kind
   character(len=7), parameter :: kind_names(5) = ['real   ', 'integer', 'logical', 'word   ', 'text   ']

contains

   !> The keys of a group, without the parameters of a rule; of the name of a shape the keys of its sizes.
   subroutine group_keys(group, of_section, keys)
      !> Name of a group or of a shape
      character(len=*), intent(in) :: group
      !> Whether it is one of `section_groups`, else of `group_names`
      logical, intent(in) :: of_section
      type(key_type), allocatable, intent(out) :: keys(:)
      type(group_reader) :: reader
      type(message_list) :: messages
      type(shape_type), allocatable :: shape
      type(key_visitor) :: v
      logical :: ok

      call new_shape(group, unset, unset, shape)
      if (allocated(shape)) then
         call v%collect(group)
         call shape%visit(v)
         keys = v%keys(:v%count)
      else
         reader%of_section = of_section
         call reader%open(group, '', 0, messages, ok)
         call reader%collect_keys()
         keys = reader%keys
      end if
   end subroutine group_keys

   !> All keys as JSON: {"groups": {name: [key, ...]}, "rules": {name: {"places": "...", "keys": [key, ...]}},
   !> "section": {name: [key, ...]}}; the last are requests about a section, and sizes of shapes.
   subroutine keys_as_json(buffer)
      type(text_buffer), intent(inout) :: buffer
      character(len=16), parameter :: section_parts(*) = [character(len=16) :: section_groups, shape_names]
      type(key_type), allocatable :: keys(:)
      integer :: i

      call buffer%append('{"groups": {')
      do i = 1, size(group_names)
         call group_keys(group_names(i), .false., keys)
         call append_list(group_names(i), '[', keys, ']')
      end do
      call buffer%append(new_line('a')//'}, "rules": {')
      do i = 1, size(rule_names)
         call keys_of(rule_names(i), keys)
         call append_list(rule_names(i), '{"places": "'//trim(places_of(rule_names(i)))//'", "keys": [', &
                          keys, ']}')
      end do
      call buffer%append(new_line('a')//'}, "section": {')
      do i = 1, size(section_parts)
         call group_keys(section_parts(i), .true., keys)
         call append_list(section_parts(i), '[', keys, ']')
      end do
      call buffer%append(new_line('a')//'}}'//new_line('a'))

   contains

      !> A name and its list of keys, each on a line, between two texts; `i` is that of the loop outside.
      subroutine append_list(name, before, keys, after)
         character(len=*), intent(in) :: name, before, after
         type(key_type), intent(in) :: keys(:)
         integer :: k

         if (i > 1) call buffer%append(',')
         call buffer%append(new_line('a')//'  "'//trim(name)//'": '//before)
         do k = 1, size(keys)
            if (k > 1) call buffer%append(',')
            call buffer%append(new_line('a')//'    ')
            call append_key(buffer, keys(k))
         end do
         call buffer%append(after)
      end subroutine append_list
   end subroutine keys_as_json

   !> One key as JSON; bounds, choices and defaults that it does not have are left out.
   subroutine append_key(buffer, key)
      type(text_buffer), intent(inout) :: buffer
      type(key_type), intent(in) :: key
      character(len=choice_length) :: choice
      character(len=:), allocatable :: quote
      integer :: i

      call buffer%append('{"name": "'//trim(key%name)//'", "kind": "'// &
                         trim(kind_names(index(kinds, key%kind)))//'"')
      if (key%unit /= '') call buffer%append(', "unit": "'//trim(key%unit)//'"')
      if (key%bound%least > -huge(1.0_wp)) then
         call buffer%append(', "least": '//trim(exact_text(key%bound%least)))
         if (key%bound%least_open) call buffer%append(', "least_open": true')
      end if
      if (key%bound%most < huge(1.0_wp)) then
         call buffer%append(', "most": '//trim(exact_text(key%bound%most)))
         if (key%bound%most_open) call buffer%append(', "most_open": true')
      end if
      if (key%kind == word_kind) then
         call buffer%append(', "choices": [')
         do i = 1, len(key%choices)
            choice = choice_name(key, i)
            if (choice == '') exit
            if (i > 1) call buffer%append(', ')
            call buffer%append('"'//trim(choice)//'"')
         end do
         call buffer%append(']')
      end if
      if (default_of(key) /= '') then
         quote = ''
         if (key%kind == word_kind .or. key%kind == text_kind) quote = '"'
         call buffer%append(', "default": '//quote//trim(default_of(key))//quote)
      end if
      if (key%optional) call buffer%append(', "optional": true')
      if (key%most > 1) call buffer%append(', "values": '//to_text(key%most))
      call buffer%append(', "meaning": "'//trim(key%meaning)//'"}')
   end subroutine append_key

   !> The default as text; blank if there is none.
   pure character(len=32) function default_of(key) result(text)
      type(key_type), intent(in) :: key

      text = key%default_text
      if (text /= '' .or. .not. is_given(key%default)) return
      select case (key%kind)
      case (logical_kind)
         text = merge('true ', 'false', abs(key%default) > 0.0_wp)
      case (word_kind)
         text = choice_name(key, nint(key%default))
      case default
         text = exact_text(key%default)
      end select
   end function default_of

   !> Groups and rules, a line for each key: name, kind, unit, bounds, default, meaning; an error if the name
   !> is neither a group nor a rule.
   subroutine keys_as_table(given, buffer, error)
      !> A group or a rule, in upper or lower case; empty for all of them
      character(len=*), intent(in) :: given
      type(text_buffer), intent(inout) :: buffer
      type(error_type), allocatable, intent(inout) :: error
      type(key_type), allocatable :: keys(:)
      character(len=len(given)) :: name
      integer :: i

      name = lower(given)
      if (index(name, '&') == 1) name = name(2:)
      if (name /= '' .and. all(group_names /= name) .and. all(rule_names /= name)) then
         if (scan(given, './\') > 0) then
            call fatal_error(error, bad_input, "'"//given//"' looks like a file; keys explains the keys "// &
                             "of a group or rule, as 'rbsdem keys column', and 'rbsdem check "//given// &
                             "' finds the errors of a case")
            return
         end if
         call fatal_error(error, bad_input, "there is no group or rule '"//given//"'"// &
                          suggestion(name, [character(len=24) :: group_names, rule_names]))
         return
      end if
      do i = 1, size(group_names)
         if (name /= '' .and. name /= group_names(i)) cycle
         call group_keys(group_names(i), .false., keys)
         call buffer%append('&'//trim(group_names(i))//new_line('a'))
         call append_rows(buffer, keys)
      end do
      do i = 1, size(rule_names)
         if (name /= '' .and. name /= rule_names(i)) cycle
         call keys_of(rule_names(i), keys)
         call buffer%append("rule = '"//trim(rule_names(i))//"' ("//trim(places_of(rule_names(i)))//')'// &
                            new_line('a'))
         call append_rows(buffer, keys)
      end do
   end subroutine keys_as_table

   !> Append a row for each key.
   subroutine append_rows(buffer, keys)
      type(text_buffer), intent(inout) :: buffer
      type(key_type), intent(in) :: keys(:)
      !> Name, kind, unit, bounds and default, each at its column
      character(len=77) :: columns
      character(len=48) :: bound
      integer :: i

      do i = 1, size(keys)
         associate (key => keys(i))
            bound = bound_text(key%bound)
            if (key%kind == word_kind) bound = 'see meaning'
            write (columns, '(2x, a24, a7, 2x, a12, a18, a12)') key%name, &
               merge('list   ', kind_names(index(kinds, key%kind)), key%most > 1), key%unit, bound, &
               default_of(key)
            call buffer%append(columns//trim(key%meaning))
            if (key%kind == word_kind .and. key%choices /= '') call buffer%append(': '//trim(key%choices))
            call buffer%append(new_line('a'))
         end associate
      end do
   end subroutine append_rows

end module rbs_case_key_list
