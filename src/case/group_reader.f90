!> The only way to set records: a group is opened, then its keys are set by name. The reader of case files
!> and the bindings for Python both use it, so that a value has one name, one check and one message.
module rbs_case_group_reader
   use rbs_base_error, only: message_list
   use rbs_base_key_visitor, only: key_visitor
   use rbs_base_keys, only: key_type, find_key, choice_list, choice_name, choice_number, word_kind, &
                            force, deformation, stiffness
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text, lower, suggestion, list_of
   use rbs_base_units, only: unit_system
   use rbs_case_case_record, only: case_record, most_loadings
   use rbs_case_drawing_record, only: drawing_groups
   use rbs_case_judgement_record, only: judgement_groups
   use rbs_case_spring_entry, only: entry_list, spring_groups, give_springs, place_springs
   use rbs_hysteresis_registry, only: rule_names, keys_of
   use rbs_section_events, only: diagram_record
   use rbs_structure_frame_frame_record, only: frame_groups
   use rbs_section_flexural_spring, only: hinge_record
   use rbs_section_shape, only: shape_names
   use rbs_section_shear_diagram, only: shear_record
   implicit none
   private

   public :: group_reader, unit_in_group

   !> The groups of a case.
   character(len=16), parameter, public :: group_names(*) = [character(len=16) :: &
      'case', 'units', 'column', frame_groups, 'damping', spring_groups, drawing_groups, 'loading', &
      'analysis', judgement_groups, 'output']

   !> The groups that Python gives of a section: the drawing, and last the three kinds of requests.
   character(len=16), parameter, public :: section_groups(10) = [character(len=16) :: &
      'section', 'concrete', 'steel', 'bars', 'ties', 'spiral', 'boundary', 'diagram', 'springs', 'shear']

   !> Groups that may appear several times.
   character(len=16), parameter :: repeated(*) = [character(len=16) :: &
      spring_groups, frame_groups(2:), 'steel', 'row', 'boundary', 'curtain', 'parameter', &
      'loading', 'assess', 'limit']

   !> The result of `find` for a key that is ignored because the rule of its spring is unknown.
   integer, parameter, public :: ignored = -1

   type :: group_reader
      type(case_record) :: case
      !> Whether `section_groups` are given, not those of a case
      logical :: of_section = .false.
      !> Question about a section
      type(diagram_record) :: diagram
      type(hinge_record) :: springs
      type(shear_record) :: shear
      !> Units of the numbers that are set
      type(unit_system) :: units
      !> Keys of the open group, collected when one is looked for
      type(key_type), allocatable :: keys(:)
      character(len=16) :: group = ''
      !> Location of the group, for messages: 'case.nml line 4:' or blank
      character(len=80) :: where = ''
      !> Whether it is a spring or the layers of joints
      logical :: is_spring = .false.
      logical, private :: collected = .false.
      type(entry_list), private :: entries
      !> Keys of the rule of the open spring
      type(key_type), allocatable, private :: rule_keys(:)
      type(key_visitor), private :: visitor
      !> Whether each group has been opened before
      logical, private :: seen(size(group_names)) = .false.
   contains
      procedure :: open, collect_keys, find, put_numbers, put_parameters, put_text, finish
      procedure, private :: visit_open
   end type group_reader

contains

   !> Open a group, after a check of its name and of how often it appears.
   subroutine open(self, group, where, line, messages, ok)
      class(group_reader), intent(inout) :: self
      !> Name of the group, without &
      character(len=*), intent(in) :: group
      !> Location for messages, 'case.nml line 4:', or blank
      character(len=*), intent(in) :: where
      !> Line of the file in which the group begins, 0 without a file
      integer, intent(in) :: line
      type(message_list), intent(inout) :: messages
      !> Whether the group has been opened, without a message
      logical, intent(out) :: ok
      integer :: i, group_index, known

      known = messages%count
      self%group = group
      self%where = where
      if (self%of_section) then
         group_index = findloc(section_groups == group, .true., dim=1)
      else
         group_index = findloc(group_names == group, .true., dim=1)
      end if
      if (group_index == 0) then
         call messages%add_at(where, 'the group &'//trim(group)//' is not known; it is one of '// &
                              list_of(group_names)//suggestion(group, group_names))
      else if (group == 'loading' .and. self%case%loadings == most_loadings) then
         call messages%add_at(where, '&loading appears more than '//to_text(most_loadings)//' times')
      else if (group == 'drawing' .and. self%seen(group_index)) then
         ! Each drawing of a frame has groups of its own.
         do i = 1, size(group_names)
            if (any(drawing_groups == group_names(i))) self%seen(i) = i == group_index
         end do
      else if (self%seen(group_index) .and. all(repeated /= group)) then
         call messages%add_at(where, '&'//trim(group)//' appears twice; it may appear once')
      else
         self%seen(group_index) = .true.
      end if
      ok = messages%count == known
      if (.not. ok) return
      self%collected = .false.
      self%is_spring = .not. self%of_section .and. any(spring_groups == group)
      if (self%is_spring) then
         call self%entries%add(group, where, line)
      else
         call self%case%open_group(group)
         if (group == 'drawing' .and. self%case%drawn_at == '') self%case%drawn_at = where
      end if
   end subroutine open

   !> Collect the list of keys of the open group, with those of the rule of a spring.
   subroutine collect_keys(self)
      class(group_reader), intent(inout) :: self

      self%collected = .true.
      if (self%is_spring) call keys_of(self%entries%entry(self%entries%count)%spring%rule, self%rule_keys)
      call self%visitor%collect(self%group)
      call self%visit_open()
      self%keys = self%visitor%keys(:self%visitor%count)
   end subroutine collect_keys

   !> Present the record of the open group to the visitor.
   subroutine visit_open(self)
      class(group_reader), intent(inout) :: self

      if (self%is_spring) then
         call self%entries%entry(self%entries%count)%visit(self%visitor, self%rule_keys)
         return
      end if
      ! Only of a section these names are requests; &shear of a case is a spring.
      select case (merge(self%group, repeat(' ', len(self%group)), self%of_section))
      case ('diagram')
         call self%diagram%visit(self%visitor)
      case ('springs')
         call self%springs%visit(self%visitor)
      case ('shear')
         call self%shear%visit(self%visitor)
      case default
         call self%case%visit_group(self%group, self%visitor)
      end select
   end subroutine visit_open

   !> Find the index of a key of the open group.
   !>
   !> It is 0, with a message, if the group does not have the key, and `ignored`, without one, if the key is a
   !> parameter of some rule and the rule of the spring is unknown, which is told elsewhere. The rule of a
   !> spring and the shape of a section must be set before the keys that they bring.
   subroutine find(self, name, where, key_index, messages)
      class(group_reader), intent(inout) :: self
      character(len=*), intent(in) :: name
      !> Location for messages, 'case.nml line 4:', or blank
      character(len=*), intent(in) :: where
      integer, intent(out) :: key_index
      type(message_list), intent(inout) :: messages
      type(key_type), allocatable :: others(:)
      character(len=:), allocatable :: remedy
      integer :: i

      if (.not. self%collected) call self%collect_keys()
      key_index = find_key(self%keys, name)
      if (key_index > 0) return
      ! A parameter of another rule?
      do i = 1, merge(size(rule_names), 0, self%is_spring .and. self%group /= 'layers')
         call keys_of(rule_names(i), others)
         if (find_key(others, name) == 0) cycle
         associate (rule => self%entries%entry(self%entries%count)%spring%rule)
            key_index = ignored
            if (all(rule_names /= rule)) return
            key_index = 0
            call messages%add_at(where, '&'//trim(self%group)//': '//trim(name)//' is not used by the '// &
                                 'rule '//trim(rule)//'; remove it or choose another rule')
            return
         end associate
      end do
      remedy = suggestion(name, [self%keys%name])
      if (remedy == '') remedy = '; rbsdem keys '//trim(self%group)//' lists what it has'
      call messages%add_at(where, '&'//trim(self%group)//" has no '"//trim(name)//"'"//remedy)
   end subroutine find

   !> Set a key by its index to numbers, whole numbers, or 0 and 1.
   subroutine put_numbers(self, key_index, number)
      class(group_reader), intent(inout) :: self
      !> Index that `find` has returned
      integer, intent(in) :: key_index
      !> Values of the key in `units`, one or, for a list, several
      real(wp), intent(in), contiguous, target :: number(:)
      real(wp), allocatable, target :: si(:)
      integer :: parameter

      if (key_index == ignored) return
      ! The last keys of a spring are the parameters of its rule.
      parameter = key_index - size(self%keys)
      if (self%is_spring) parameter = parameter + size(self%rule_keys)
      if (self%units%is_si()) then
         ! Without conversion a parameter is stored without a visit, which would take time.
         if (parameter > 0) then
            self%entries%entry(self%entries%count)%spring%value(parameter) = number(1)
            return
         end if
         call self%visitor%put(self%keys(key_index)%name, number=number)
      else
         si = self%units%into_si(number, unit_in_group(self%keys(key_index)%unit, self%group))
         call self%visitor%put(self%keys(key_index)%name, number=si)
      end if
      call self%visit_open()
   end subroutine put_numbers

   !> Set all parameters of the rule of the open spring, in the order of its keys and in SI.
   subroutine put_parameters(self, number)
      class(group_reader), intent(inout) :: self
      !> As many values as the rule has keys; `unset`: not given
      real(wp), intent(in) :: number(:)

      self%entries%entry(self%entries%count)%spring%value(:size(number)) = number
   end subroutine put_parameters

   !> Set a key by its index to a word or a text.
   subroutine put_text(self, key_index, given, messages)
      class(group_reader), intent(inout) :: self
      !> Index that `find` has returned
      integer, intent(in) :: key_index
      !> The text without quotes; a word may be in upper or lower case
      character(len=*), intent(in) :: given
      type(message_list), intent(inout) :: messages
      type(key_type) :: key
      character(len=:), allocatable :: text
      integer :: i

      if (key_index == ignored) return
      key = self%keys(key_index)
      text = given
      if (key%kind == word_kind) then
         ! The word in the letters in which the key lists it.
         i = 1
         do while (choice_name(key, i) /= '')
            if (lower(choice_name(key, i)) == lower(given)) text = trim(choice_name(key, i))
            i = i + 1
         end do
      end if
      ! A rule brings keys of its own, so the list of keys is collected anew.
      if (self%is_spring .and. key%name == 'rule') then
         call self%entries%entry(self%entries%count)%set_rule(lower(text))
         self%collected = .false.
         return
      else if (self%is_spring .and. key%kind == word_kind) then
         if (choice_number(key, text) > 0) then
            call self%put_numbers(key_index, [real(choice_number(key, text), wp)])
         else
            call messages%add_at(self%where, trim(self%group)//' spring: '//trim(key%name)//" = '"// &
                                 trim(text)//"' is not known; it is one of "//trim(choice_list(key)))
         end if
         return
      else if (key%kind == word_kind .and. text == '') then
         call messages%add_at(self%where, trim(self%group)//': '//trim(key%name)// &
                              " = '' is not known; it is one of "//key%choices)
         return
      end if
      call self%visitor%put(key%name, text=text)
      call self%visit_open()
      call self%visitor%end_check(messages)
      ! Numbers of later groups are in these units.
      if (self%group == 'units') self%units = self%case%units%system()
      ! A shape brings keys too.
      if (key%name /= 'shape') return
      self%collected = .false.
      if (all(shape_names /= text)) then
         call messages%add_at(self%where, "section: shape = '"//text//"' is not known; it is one of "// &
                              list_of(shape_names))
      end if
   end subroutine put_text

   !> After all groups have been set: give the springs to the joints, or check the requests about a section.
   subroutine finish(self, messages)
      class(group_reader), intent(inout) :: self
      type(message_list), intent(inout) :: messages
      integer :: i

      if (.not. self%of_section) then
         if (.not. allocated(self%case%frame)) then
            call place_springs(self%entries, self%case%column, allocated(self%case%drawing), messages)
            return
         end if
         if (self%seen(findloc(group_names == 'column', .true., dim=1))) then
            call messages%add('a case has a group &column or a group &frame, not both; remove one')
         end if
         call give_springs(self%entries, self%case%frame, messages)
         return
      end if
      ! The last three groups of a section are the requests.
      do i = size(section_groups) - 2, size(section_groups)
         if (.not. self%seen(i)) cycle
         self%group = section_groups(i)
         call self%visitor%start_check(self%group)
         call self%visit_open()
         call self%visitor%end_check(messages)
      end do
   end subroutine finish

   !> The SI unit of a parameter of a spring, which depends on the kind of the spring; other units are
   !> returned unchanged.
   elemental character(len=16) function unit_in_group(unit, group) result(si)
      !> One of the dimensions `stiffness`, `force`, `deformation`, or a unit; group of the spring
      character(len=*), intent(in) :: unit, group

      ! Moments and rotations in flexure; forces and lengths in all other springs.
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

end module rbs_case_group_reader
