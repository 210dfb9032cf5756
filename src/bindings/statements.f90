!> How Python passes a column, a spring or a case: names of keys as text, values as numbers.
!>
!> The text has a line for each group: its name, then its keys, separated by tabs. `key` takes the next
!> number, `key:5` the next five, `key=word` a text; `values:5` of a spring are all parameters of its rule
!> in their order. A group reader sets keys, like those of a case file.
module rbs_bindings_statements
   use, intrinsic :: iso_c_binding, only: c_double
   use rbs_base_error, only: error_type, message_list, fatal_error, bad_input
   use rbs_base_text, only: next_line
   use rbs_case_case_record, only: case_record
   use rbs_case_group_reader, only: group_reader
   use rbs_hysteresis_layered_layered_joint, only: check_axial_load
   use rbs_hysteresis_rule, only: rule_type
   use rbs_hysteresis_spring_record, only: spring_record
   use rbs_solve_end_state, only: end_state
   use rbs_solve_begin_make_structure, only: make_structure
   use rbs_structure_structure, only: structure_type
   implicit none
   private

   public :: put_statements, case_from_statements, structure_from_statements, spring_from_statements

   character(len=1), parameter :: tab = achar(9)

contains

   !> Set all groups of a text, with their numbers one after the other; nothing more after the first message.
   subroutine put_statements(text, number, setter, messages)
      character(len=*), intent(in) :: text
      real(c_double), intent(in), contiguous :: number(:)
      !> It is given the groups, and holds them after
      type(group_reader), intent(inout) :: setter
      type(message_list), intent(inout) :: messages
      !> Line of a group in the text; numbers that have been taken
      integer :: first, last, at

      at = 0
      last = -1
      do while (next_line(text, first, last))
         if (last >= first) call put_group(text(first:last))
         if (messages%count > 0) return
      end do
      call setter%finish(messages)

   contains

      !> Set one group from its line: name and items with tabs between.
      subroutine put_group(line)
         !> Line of the text
         character(len=*), intent(in) :: line
         integer :: first, last
         logical :: ok

         last = index(line//tab, tab)
         call setter%open(line(:last - 1), '', 0, messages, ok)
         do while (ok .and. last <= len(line))
            first = last + 1
            last = index(line(first:), tab) + first - 1
            if (last < first) last = len(line) + 1
            call put_item(line(first:last - 1))
         end do
      end subroutine put_group

      !> Set one key to its value: an item as `key`, `key:5` or `key=word`.
      subroutine put_item(item)
         !> The text between two tabs
         character(len=*), intent(in) :: item
         integer :: mark, key_index, count

         mark = scan(item//':', '=:')
         count = 1
         if (index(item, ':') == mark) read (item(mark + 1:), *) count
         if (setter%is_spring .and. item(:mark - 1) == 'values') then
            call setter%put_parameters(number(at + 1:at + count))
         else
            call setter%find(item(:mark - 1), '', key_index, messages)
            if (key_index == 0) return
            if (index(item, '=') == mark) then
               call setter%put_text(key_index, item(mark + 1:), messages)
               return
            end if
            call setter%put_numbers(key_index, number(at + 1:at + count))
         end if
         at = at + count
      end subroutine put_item

   end subroutine put_statements

   !> Set a case from its text and numbers, without validation.
   subroutine case_from_statements(text, number, case, error)
      !> Groups, and the numbers of their keys
      character(len=*), intent(in) :: text
      real(c_double), intent(in), contiguous :: number(:)
      type(case_record), intent(out) :: case
      type(error_type), allocatable, intent(out) :: error
      type(group_reader) :: setter
      type(message_list) :: messages

      call put_statements(text, number, setter, messages)
      call messages%raise(error)
      case = setter%case
   end subroutine case_from_statements

   !> Validate and make the structure of a text; the rest of its case is set but not validated.
   subroutine structure_from_statements(text, number, structure, before, case, error, is_part)
      !> Groups, and the numbers of their keys
      character(len=*), intent(in) :: text
      real(c_double), intent(in), contiguous :: number(:)
      class(structure_type), allocatable, intent(out) :: structure
      !> The state that its analyses begin in, see `make_structure`
      type(end_state), intent(out) :: before
      type(case_record), intent(out) :: case
      type(error_type), allocatable, intent(out) :: error
      !> Whether a frame is laid out alone, as a part of a building
      logical, intent(in), optional :: is_part

      call case_from_statements(text, number, case, error)
      if (present(is_part) .and. allocated(case%frame)) case%frame%is_part = is_part
      if (.not. allocated(error)) call make_structure(case, structure, before, error)
   end subroutine structure_from_statements

   !> Validate a single spring, which the text gives as the only one of the group flexure.
   subroutine spring_from_statements(text, number, axial_load, spring, error)
      !> Group, and the numbers of its keys
      character(len=*), intent(in) :: text
      real(c_double), intent(in), contiguous :: number(:)
      !> Axial load on the layers, if there are any [N]
      real(c_double), intent(in) :: axial_load
      type(spring_record), intent(out) :: spring
      type(error_type), allocatable, intent(out) :: error
      type(case_record) :: case
      type(message_list) :: messages
      class(rule_type), allocatable :: rule
      character(len=:), allocatable :: capacity

      call case_from_statements(text, number, case, error)
      if (allocated(error)) return
      spring = case%column%flexure(1)
      spring%axial_load = axial_load
      call spring%validate(trim(spring%rule)//' spring', messages)
      call messages%raise(error)
      if (allocated(error)) return
      ! Layers must be able to carry the axial load.
      call spring%make(rule)
      call check_axial_load(rule, axial_load, capacity)
      if (capacity /= '') call fatal_error(error, bad_input, 'layered spring: '//capacity)
   end subroutine spring_from_statements

end module rbs_bindings_statements
