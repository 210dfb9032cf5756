!> The one way into a section and what is asked of it: a group is opened, its keys are set by name.
module rbs_section_section_setter
   use rbs_base_constants, only: unset
   use rbs_base_error, only: message_list
   use rbs_base_key_setter, only: key_setter
   use rbs_base_key_visitor, only: key_visitor
   use rbs_base_keys, only: find_key, key_type
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: list_of, nearest_name
   use rbs_section_cross_section, only: spiral, ties
   use rbs_section_section_record, only: append_steel, section_record
   use rbs_section_settings_record, only: diagram_record, layer_record, place_of, shear_record, springs_record
   use rbs_section_shapes, only: new_shape, shape_names
   implicit none
   private

   public :: section_setter, section_group_keys

   character(len=8), parameter, public :: section_groups(10) = [ &
      'section ', 'concrete', 'steel   ', 'bars    ', 'ties    ', 'spiral  ', 'diagram ', 'springs ', &
      'shear   ', 'layer   ']

   type, extends(key_setter) :: section_setter
      type(section_record) :: section
      type(diagram_record) :: diagram
      type(springs_record) :: springs
      type(shear_record) :: shear
      type(layer_record) :: layer
      character(len=16), private :: group = ''
      !> Keys of the open group
      type(key_type), allocatable, private :: keys(:)
   contains
      procedure :: open
      procedure :: find
      procedure :: put_numbers
      procedure :: put_text
      procedure :: finish
      procedure :: check
      procedure, private :: collect_keys
      procedure, private :: visit_open
   end type section_setter

contains

   subroutine open(self, group, where, messages, ok)
      class(section_setter), intent(inout) :: self
      character(len=*), intent(in) :: group, where
      type(message_list), intent(inout) :: messages
      logical, intent(out) :: ok

      ok = any(section_groups == group)
      if (.not. ok) then
         call messages%add(adjustl(trim(where)//" the group '"//trim(group)//"' of a section is not "// &
                                   "known; did you mean '"//nearest_name(group, section_groups)// &
                                   "'? Groups are "//list_of(section_groups)))
         return
      end if
      self%group = group
      if (.not. allocated(self%section%steels)) allocate (self%section%steels(0))
      if (group == 'steel') call append_steel(self%section)
      if (group == 'ties') self%section%hoops%kind = ties
      if (group == 'spiral') self%section%hoops%kind = spiral
      call self%collect_keys()
   end subroutine open

   !> The list of keys of the open group.
   subroutine collect_keys(self)
      class(section_setter), intent(inout) :: self
      type(key_visitor) :: v

      call v%collect(self%group)
      call self%visit_open(v)
      self%keys = v%keys(:v%count)
   end subroutine collect_keys

   !> Show the record of the open group to a visitor.
   subroutine visit_open(self, v)
      class(section_setter), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      select case (self%group)
      case ('section')
         call self%section%visit(v)
      case ('concrete')
         call self%section%concrete%visit(v)
      case ('steel')
         call self%section%steels(size(self%section%steels))%visit(v)
      case ('bars')
         call self%section%bars%visit(v)
      case ('ties', 'spiral')
         call self%section%hoops%visit(v)
      case ('diagram')
         call self%diagram%visit(v)
      case ('springs')
         call self%springs%visit(v)
      case ('shear')
         call self%shear%visit(v)
      case default
         call self%layer%visit(v)
      end select
   end subroutine visit_open

   !> The shape of a section must have been put before its sizes are looked for.
   subroutine find(self, name, where, place, messages)
      class(section_setter), intent(in) :: self
      character(len=*), intent(in) :: name, where
      integer, intent(out) :: place
      type(message_list), intent(inout) :: messages
      character(len=len(self%keys%name)) :: names(size(self%keys))

      place = find_key(self%keys, name)
      if (place > 0) return
      names = self%keys%name
      call messages%add(adjustl(trim(where)//' '//trim(self%group)//" has no '"//trim(name)// &
                                "'; did you mean '"//nearest_name(name, names)//"'?"))
   end subroutine find

   subroutine put_numbers(self, place, number)
      class(section_setter), intent(inout) :: self
      integer, intent(in) :: place
      real(wp), intent(in) :: number(:)
      type(key_visitor) :: putter

      call putter%put(self%keys(place)%name, number=number)
      call self%visit_open(putter)
   end subroutine put_numbers

   subroutine put_text(self, place, text, messages)
      class(section_setter), intent(inout) :: self
      integer, intent(in) :: place
      character(len=*), intent(in) :: text
      type(message_list), intent(inout) :: messages
      type(key_visitor) :: putter

      if (text == '') then
         call messages%add(trim(self%group)//': '//trim(self%keys(place)%name)// &
                           " = '' is not known; it is one of "//trim(self%keys(place)%choices))
         return
      end if
      call putter%put(self%keys(place)%name, text=text)
      call self%visit_open(putter)
      call putter%end_check(messages)
      if (self%keys(place)%name /= 'shape') return
      ! The shape brings its sizes as keys.
      if (.not. any(shape_names == text)) then
         call messages%add("section: shape = '"//text//"' is not known; it is one of "//list_of(shape_names))
         return
      end if
      call new_shape(place_of(text, shape_names), unset, unset, self%section%shape)
      call self%collect_keys()
   end subroutine put_text

   !> Nothing is left to do when all groups have been put.
   subroutine finish(self, messages)
      class(section_setter), intent(inout) :: self
      type(message_list), intent(inout) :: messages

      if (messages%count > 0) self%group = ''
   end subroutine finish

   !> Check the values of the settings of one analysis.
   subroutine check(self, group, messages)
      class(section_setter), intent(inout) :: self
      character(len=*), intent(in) :: group
      type(message_list), intent(inout) :: messages
      type(key_visitor) :: v

      self%group = group
      call v%start_check(group)
      call self%visit_open(v)
      call v%end_check(messages)
   end subroutine check

   !> The keys of a group, or the sizes of a shape, for the list of keys.
   subroutine section_group_keys(group, keys)
      !> One of `section_groups` or `shape_names`
      character(len=*), intent(in) :: group
      type(key_type), allocatable, intent(out) :: keys(:)
      type(section_setter) :: setter
      type(message_list) :: messages
      type(key_visitor) :: v
      logical :: ok

      if (any(shape_names == group)) then
         call new_shape(place_of(group, shape_names), unset, unset, setter%section%shape)
         call v%collect(group)
         call setter%section%shape%visit(v)
         keys = v%keys(:v%count)
      else
         call setter%open(group, '', messages, ok)
         keys = setter%keys
      end if
   end subroutine section_group_keys

end module rbs_section_section_setter
