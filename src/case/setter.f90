!> The only way to set a case: a group is opened, then its keys are set by name. The reader of case files and
!> the bindings for Python both use it, so that a value has one name, one check and one message.
module rbs_case_setter
   use rbs_base_constants, only: unset
   use rbs_base_error, only: message_list
   use rbs_base_key_setter, only: key_setter
   use rbs_base_key_visitor, only: key_visitor
   use rbs_base_keys, only: key_type, find_key, choice_place, choice_name, choice_length, integer_kind, &
                            word_kind, text_kind, force, deformation, stiffness
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text, nearest_name, list_of
   use rbs_base_units, only: unit_system
   use rbs_case_case_record, only: case_record, most_loadings
   use rbs_case_drawing_record, only: drawing_groups, is_drawing_group, may_repeat
   use rbs_case_renamed, only: new_group, new_key, new_word
   use rbs_case_spring_entry, only: entry_list, keys_of_group, is_spring_group, place_springs
   use rbs_hysteresis_registry, only: rule_names, keys_of
   use rbs_section_shapes, only: new_shape, shape_names
   implicit none
   private

   public :: setter_type, group_names, unit_in_group

   character(len=16), parameter :: group_names(*) = [character(len=16) :: &
      'case', 'units', 'column', 'damping', 'shear', 'flexure', 'axial_spring', 'layer_spring', 'layers', &
      drawing_groups, 'loading', 'analysis', 'output']

   !> The result of `find` for a key that is ignored because the rule of its spring is unknown.
   integer, parameter, public :: ignored = -1

   type, extends(key_setter) :: setter_type
      type(case_record) :: case
      !> Units of the numbers that are set
      type(unit_system) :: units
      !> Keys of the open group
      type(key_type), allocatable :: keys(:)
      character(len=16) :: group = ''
      !> Location of the group, for messages: 'case.nml line 4:' or blank
      character(len=80) :: where = ''
      type(entry_list), private :: springs
      type(key_visitor), private :: visitor
      !> Whether each group has been opened before
      logical, private :: seen(size(group_names)) = .false.
      !> From this key on they are parameters of the rule of a spring
      integer, private :: parameters = huge(1)
   contains
      procedure :: open
      procedure :: find
      procedure :: put_numbers
      procedure :: put_text
      procedure :: finish
      procedure, private :: visit_open
   end type setter_type

contains

   !> Open a group, after a check of its name and of how often it appears.
   subroutine open(self, group, where, messages, ok)
      class(setter_type), intent(inout) :: self
      character(len=*), intent(in) :: group
      !> For messages, may be blank
      character(len=*), intent(in) :: where
      type(message_list), intent(inout) :: messages
      logical, intent(out) :: ok
      integer :: place

      self%group = group
      self%where = where
      self%parameters = huge(1)
      place = findloc(group_names == group, .true., dim=1)
      ok = place > 0
      if (.not. ok) then
         if (new_group(group) /= '') then
            call messages%add(adjustl(trim(where)//' the group &'//trim(group)//' is now '// &
                                      trim(new_group(group))))
         else
            call messages%add(adjustl(trim(where)//' the group &'//trim(group)// &
                                      " is not known; did you mean '&"//nearest_name(group, group_names)// &
                                      "'? Groups are "//list_of(group_names)))
         end if
         return
      end if
      if (is_spring_group(group)) then
         call self%springs%add(group, where)
         self%keys = keys_of_group(group)
         self%seen(place) = .true.
         return
      else if (group == 'loading') then
         ok = self%case%loadings < most_loadings
         if (.not. ok) then
            call messages%add(adjustl(trim(where)//' &loading appears more than '//to_text(most_loadings)// &
                                      ' times'))
            return
         end if
         self%case%loadings = self%case%loadings + 1
      else if (self%seen(place) .and. .not. may_repeat(group)) then
         call messages%add(adjustl(trim(where)//' &'//trim(group)//' appears twice; it may appear once'))
         ok = .false.
         return
      end if
      self%seen(place) = .true.
      if (is_drawing_group(group)) then
         if (.not. allocated(self%case%drawing)) allocate (self%case%drawing)
         call self%case%drawing%open_group(group)
      end if
      call self%visitor%collect(group)
      call self%visit_open()
      self%keys = self%visitor%keys(:self%visitor%count)
   end subroutine open

   !> Present the record of the open group to the visitor.
   subroutine visit_open(self)
      class(setter_type), intent(inout) :: self

      if (is_drawing_group(self%group)) then
         call self%case%drawing%visit(self%group, self%visitor)
         return
      end if
      select case (self%group)
      case ('case')
         call self%case%visit(self%visitor)
      case ('units')
         call self%case%units%visit(self%visitor)
      case ('column')
         call self%case%column%visit(self%visitor)
      case ('damping')
         call self%case%column%damping%visit(self%visitor)
      case ('loading')
         call self%case%loading(self%case%loadings)%visit(self%visitor)
      case ('analysis')
         call self%case%analysis%visit(self%visitor)
      case default
         call self%case%output%visit(self%visitor)
      end select
   end subroutine visit_open

   !> Place of a key of the open group; 0 with a message if the group does not have it. The rule of a
   !> spring must be set before its parameters.
   subroutine find(self, name, where, place, messages)
      class(setter_type), intent(in) :: self
      character(len=*), intent(in) :: name
      !> For messages, may be blank
      character(len=*), intent(in) :: where
      integer, intent(out) :: place
      type(message_list), intent(inout) :: messages
      type(key_type), allocatable :: others(:)
      character(len=len(self%keys%name)) :: names(size(self%keys))
      integer :: i

      place = find_key(self%keys, name)
      if (place > 0) return
      if (new_key(self%group, name) /= '') then
         call messages%add(adjustl(trim(where)//" the key '"//trim(name)//"' of &"//trim(self%group)// &
                                   ' is now '//trim(new_key(self%group, name))))
         return
      end if
      if (any(self%keys%name == 'rule')) then
         do i = 1, size(rule_names)
            call keys_of(rule_names(i), others)
            if (find_key(others, name) == 0) cycle
            if (self%parameters == huge(1)) then
               place = ignored
            else
               associate (spring => self%springs%entry(self%springs%count)%spring)
                  call messages%add(adjustl(trim(where)//' &'//trim(self%group)//': '//trim(name)// &
                                            ' is not used by the rule '//trim(spring%rule)// &
                                            '; remove it or choose another rule'))
               end associate
            end if
            return
         end do
      end if
      names = self%keys%name
      call messages%add(adjustl(trim(where)//' &'//trim(self%group)//" has no '"//trim(name)// &
                                "'; did you mean '"//nearest_name(name, names)//"'?"))
   end subroutine find

   !> Set the key at a place to numbers, whole numbers, or 0 and 1.
   subroutine put_numbers(self, place, number)
      class(setter_type), intent(inout) :: self
      !> From `find`
      integer, intent(in) :: place
      real(wp), intent(in) :: number(:)
      real(wp) :: si(size(number))

      if (place == ignored) return
      si = number
      if (.not. self%units%is_si()) then
         si = self%units%into_si(number, unit_in_group(self%keys(place)%unit, self%group))
      end if
      if (.not. is_spring_group(self%group)) then
         call self%visitor%put(self%keys(place)%name, number=si)
         call self%visit_open()
         return
      end if
      associate (entry => self%springs%entry(self%springs%count))
         if (place >= self%parameters) then
            entry%spring%value(place - self%parameters + 1) = si(1)
            return
         end if
         select case (self%keys(place)%name)
         case ('joint')
            entry%joint = nint(si)
         case ('id')
            entry%id = nint(si(1))
         case ('y')
            entry%y = si
         case default
            entry%layer = nint(si)
         end select
      end associate
   end subroutine put_numbers

   !> Set the key at a place to a word or a text.
   subroutine put_text(self, place, text, messages)
      class(setter_type), intent(inout) :: self
      integer, intent(in) :: place
      character(len=*), intent(in) :: text
      type(message_list), intent(inout) :: messages
      integer :: choice

      if (place == ignored) return
      if (.not. is_spring_group(self%group)) then
         if (self%keys(place)%kind == word_kind .and. text == '') then
            call messages%add(adjustl(trim(self%where)//' '//trim(self%group)//': '// &
                                      trim(self%keys(place)%name)//" = '' is not known; it is one of "// &
                                      self%keys(place)%choices))
            return
         end if
         if (new_word(self%keys(place)%name, text) /= '') then
            call messages%add(adjustl(trim(self%where)//' '//trim(self%group)//': '// &
                                      trim(self%keys(place)%name)//" = '"//text//"' is now "// &
                                      trim(new_word(self%keys(place)%name, text))))
            return
         end if
         call self%visitor%put(self%keys(place)%name, text=text)
         call self%visit_open()
         call self%visitor%end_check(messages)
         if (self%group == 'units') self%units = self%case%units%system()
         if (self%group == 'section') call take_shape(self, text, messages)
         return
      end if
      associate (spring => self%springs%entry(self%springs%count)%spring, key => self%keys(place))
         if (key%name == 'rule') then
            call take_rule(self, text)
            return
         end if
         choice = choice_place(key, text)
         if (choice == 0) then
            call messages%add(adjustl(trim(self%where)//' '//trim(self%group)//' spring: '//trim(key%name)// &
                                      " = '"//trim(text)//"' is not known; it is one of "// &
                                      trim(listed(key))))
         else
            spring%value(place - self%parameters + 1) = choice
         end if
      end associate
   end subroutine put_text

   !> Set the rule of a spring, and add its parameters to the keys.
   subroutine take_rule(self, name)
      type(setter_type), intent(inout) :: self
      character(len=*), intent(in) :: name
      type(key_type), allocatable :: keys(:)

      associate (spring => self%springs%entry(self%springs%count)%spring)
         spring%rule = name
         if (len_trim(name) > len(spring%rule)) spring%rule(len(spring%rule):) = '~'
         if (.not. any(rule_names == spring%rule)) return
         call keys_of(spring%rule, keys)
         self%parameters = size(self%keys) + 1
         self%keys = [self%keys, keys]
      end associate
   end subroutine take_rule

   !> The shape of a section, its only word, brings its sizes as keys.
   subroutine take_shape(self, name, messages)
      type(setter_type), intent(inout) :: self
      character(len=*), intent(in) :: name
      type(message_list), intent(inout) :: messages

      if (.not. any(shape_names == name)) then
         call messages%add(adjustl(trim(self%where)//" section: shape = '"//name//"' is not known; it is "// &
                                   'one of '//list_of(shape_names)))
         return
      end if
      call new_shape(findloc(shape_names == name, .true., dim=1), unset, unset, &
                     self%case%drawing%section%shape)
      call self%visitor%collect(self%group)
      call self%visit_open()
      self%keys = self%visitor%keys(:self%visitor%count)
   end subroutine take_shape

   !> The choices of a key, separated by commas.
   pure function listed(key) result(text)
      type(key_type), intent(in) :: key
      character(len=160) :: text
      character(len=choice_length) :: name
      integer :: i

      text = choice_name(key, 1)
      do i = 2, len(key%choices)
         name = choice_name(key, i)
         if (name == '') return
         text = trim(text)//', '//name
      end do
   end function listed

   !> Give the springs to the joints after all groups have been set.
   subroutine finish(self, messages)
      class(setter_type), intent(inout) :: self
      type(message_list), intent(inout) :: messages

      call place_springs(self%springs, self%case%column, messages)
   end subroutine finish

   !> The SI unit of a parameter of a spring, which depends on the kind of the spring; other units are
   !> returned unchanged.
   elemental function unit_in_group(unit, group) result(si)
      character(len=*), intent(in) :: unit, group
      character(len=16) :: si

      si = unit
      select case (unit)
      case (stiffness)
         si = merge('N m/rad', 'N/m    ', group == 'flexure')
      case (force)
         si = merge('N m', 'N  ', group == 'flexure')
      case (deformation)
         si = merge('rad', 'm  ', group == 'flexure')
      case default                                  ! not a dimension of springs
      end select
   end function unit_in_group

end module rbs_case_setter
