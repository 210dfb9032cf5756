!> What takes the keys of a group by name: the one way into a record, for files and for Python.
module rbs_base_key_setter
   use rbs_base_error, only: message_list
   use rbs_base_kinds, only: wp
   implicit none
   private

   public :: key_setter

   type, abstract :: key_setter
   contains
      !> Open a group
      procedure(open_group), deferred :: open
      !> Place of a key of the open group; 0 with a message if the group does not have it
      procedure(find_key), deferred :: find
      !> Put numbers, whole numbers, or 0 and 1 under the key at a place
      procedure(put_number), deferred :: put_numbers
      !> Put a word or a text under the key at a place
      procedure(put_word), deferred :: put_text
      !> All groups have been put
      procedure(end_of_groups), deferred :: finish
   end type key_setter

   abstract interface
      subroutine open_group(self, group, where, messages, ok)
         import :: key_setter, message_list
         implicit none
         class(key_setter), intent(inout) :: self
         character(len=*), intent(in) :: group
         !> For messages, may be blank
         character(len=*), intent(in) :: where
         type(message_list), intent(inout) :: messages
         logical, intent(out) :: ok
      end subroutine open_group

      subroutine find_key(self, name, where, place, messages)
         import :: key_setter, message_list
         implicit none
         class(key_setter), intent(in) :: self
         character(len=*), intent(in) :: name
         !> For messages, may be blank
         character(len=*), intent(in) :: where
         integer, intent(out) :: place
         type(message_list), intent(inout) :: messages
      end subroutine find_key

      subroutine put_number(self, place, number)
         import :: key_setter, wp
         implicit none
         class(key_setter), intent(inout) :: self
         !> From `find`
         integer, intent(in) :: place
         real(wp), intent(in) :: number(:)
      end subroutine put_number

      subroutine put_word(self, place, text, messages)
         import :: key_setter, message_list
         implicit none
         class(key_setter), intent(inout) :: self
         !> From `find`
         integer, intent(in) :: place
         character(len=*), intent(in) :: text
         type(message_list), intent(inout) :: messages
      end subroutine put_word

      subroutine end_of_groups(self, messages)
         import :: key_setter, message_list
         implicit none
         class(key_setter), intent(inout) :: self
         type(message_list), intent(inout) :: messages
      end subroutine end_of_groups
   end interface

end module rbs_base_key_setter
