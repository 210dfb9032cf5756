!> Errors as values: nothing in the library prints or stops.
!>
!> A procedure that can fail has `type(error_type), allocatable, intent(out) :: error` as its last
!> argument; the error is there if and only if the procedure failed.
module rbs_base_error
   implicit none
   private

   public :: error_type, message_list, fatal_error
   public :: analysis_failed, bad_input

   !> The analysis could not be continued (exit code 1 of the executable).
   integer, parameter :: analysis_failed = 1
   !> The input is wrong (exit code 2 of the executable).
   integer, parameter :: bad_input = 2

   !> One error: its kind, and the message for the user.
   type :: error_type
      !> `analysis_failed` or `bad_input`
      integer :: code = 0
      !> The object, the value and the remedy
      character(len=:), allocatable :: message
   end type error_type

   !> More messages than this are only counted.
   integer, parameter :: most_messages = 25

   !> A list of messages, so that one run reports all errors of an input.
   type :: message_list
      !> Number of messages
      integer :: count = 0
      !> The messages, separated by `new_line`
      character(len=:), allocatable :: text
   contains
      procedure :: add, add_at, join, raise
   end type message_list

contains

   !> Make an error.
   subroutine fatal_error(error, code, message)
      type(error_type), allocatable, intent(out) :: error
      !> `analysis_failed` or `bad_input`
      integer, intent(in) :: code
      character(len=*), intent(in) :: message

      allocate (error)
      error%code = code
      error%message = message
   end subroutine fatal_error

   !> Append one message; beyond `most_messages` it is only counted.
   subroutine add(self, message)
      class(message_list), intent(inout) :: self
      character(len=*), intent(in) :: message

      self%count = self%count + 1
      if (self%count == 1) then
         self%text = message
      else if (self%count <= most_messages) then
         self%text = self%text//new_line('a')//message
      end if
   end subroutine add

   !> Append a message behind a location.
   subroutine add_at(self, where, message)
      class(message_list), intent(inout) :: self
      !> Location, such as 'case.nml line 4:', or blank
      character(len=*), intent(in) :: where, message

      call self%add(trim(adjustl(trim(where)//' '//message)))
   end subroutine add_at

   !> Append all messages of another list.
   subroutine join(self, other)
      class(message_list), intent(inout) :: self
      type(message_list), intent(in) :: other

      if (other%count == 0) return
      ! The texts of all count as one message in `add`; the others are counted here.
      call self%add(other%text)
      self%count = self%count + other%count - 1
   end subroutine join

   !> Turn the list into one `bad_input` error; `error` stays unallocated if the list is empty.
   subroutine raise(self, error)
      class(message_list), intent(in) :: self
      type(error_type), allocatable, intent(out) :: error

      character(len=12) :: rest

      if (self%count == 0) return
      call fatal_error(error, bad_input, self%text)
      if (self%count <= most_messages) return
      write (rest, '(i0)') self%count - most_messages
      error%message = error%message//new_line('a')//'and '//trim(rest)//' more'
   end subroutine raise

end module rbs_base_error
