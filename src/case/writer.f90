!> Writes a case as groups of keys and values: as the text of a case file, or as names and numbers for
!> Python. Values that equal the defaults are left out.
module rbs_case_writer
   use rbs_base_check, only: is_given
   use rbs_base_constants, only: unset
   use rbs_base_key_visitor, only: key_visitor, entry_type
   use rbs_base_keys, only: key_type, integer_kind, logical_kind, word_kind, text_kind, real_kind, choice_name
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text, exact_text
   use rbs_case_case_record, only: case_record
   use rbs_case_drawing_record, only: drawing_record
   use rbs_case_text_buffer, only: text_buffer
   use rbs_column_column_record, only: column_record
   use rbs_hysteresis_registry, only: keys_of
   use rbs_hysteresis_spring_record, only: spring_record
   use rbs_section_cross_section, only: no_ties
   use rbs_section_shapes, only: new_shape, shape_names
   implicit none
   private

   public :: sink_type, namelist_sink, statement_sink, write_case, write_column

   !> Longest line of a namelist text.
   integer, parameter :: line_length = 100

   !> A list of springs.
   type :: spring_list
      integer :: count = 0
      type(spring_record), allocatable :: spring(:)
   end type spring_list

   !> A destination for groups.
   type, abstract :: sink_type
   contains
      procedure(group_interface), deferred :: group
   end type sink_type

   abstract interface
      subroutine group_interface(self, name, entry)
         import :: sink_type, entry_type
         implicit none
         class(sink_type), intent(inout) :: self
         character(len=*), intent(in) :: name
         type(entry_type), intent(in) :: entry(:)
      end subroutine group_interface
   end interface

   !> The text of a case file; from its numbers the same bits are read back.
   type, extends(sink_type) :: namelist_sink
      type(text_buffer) :: buffer
   contains
      procedure :: group => namelist_group
   end type namelist_sink

   !> Names in lines, one per group, and numbers in an array; see `rbs_bindings_statements`.
   type, extends(sink_type) :: statement_sink
      type(text_buffer) :: buffer
      integer :: count = 0
      real(wp), allocatable :: number(:)
   contains
      procedure :: group => statement_group
   end type statement_sink

contains

   !> Write the whole case without its units: numbers are in SI.
   subroutine write_case(case, sink)
      type(case_record), intent(inout) :: case
      class(sink_type), intent(inout) :: sink
      type(case_record) :: new
      type(key_visitor) :: v
      integer :: i

      call v%collect('case')
      call new%visit(v)
      call v%list()
      call case%visit(v)
      if (v%listed > 0) call sink%group('case', v%entry(:v%listed))
      call write_column(case%column, sink)
      if (allocated(case%drawing)) call write_drawing(case%drawing, sink)
      do i = 1, case%loadings
         call v%collect('loading')
         call new%loading(1)%visit(v)
         call v%list()
         call case%loading(i)%visit(v)
         call sink%group('loading', v%entry(:v%listed))
      end do
      call v%collect('analysis')
      call new%analysis%visit(v)
      call v%list()
      call case%analysis%visit(v)
      if (v%listed > 0) call sink%group('analysis', v%entry(:v%listed))
      call v%collect('output')
      call new%output%visit(v)
      call v%list()
      call case%output%visit(v)
      if (v%listed > 0) call sink%group('output', v%entry(:v%listed))
   end subroutine write_case

   !> Write what a column was drawn from.
   subroutine write_drawing(drawing, sink)
      type(drawing_record), intent(inout) :: drawing
      class(sink_type), intent(inout) :: sink
      integer :: i

      call write_group('drawing')
      call write_group('section')
      call write_group('concrete')
      do i = 1, size(drawing%section%steels)
         call write_group('steel', i)
      end do
      call write_group('bars')
      if (allocated(drawing%layout)) call write_group('layout')
      if (allocated(drawing%inner_layout)) call write_group('inner_layout')
      if (drawing%section%hoops%kind /= no_ties) call write_group(trim(drawing%section%hoops%name()))
      do i = 1, size(drawing%parameters)
         call write_group('parameter', i)
      end do

   contains

      subroutine write_group(name, number)
         character(len=*), intent(in) :: name
         !> Which of several
         integer, intent(in), optional :: number
         type(drawing_record) :: new, one
         type(key_visitor) :: v

         call new%open_group(name)
         if (name == 'section' .and. allocated(drawing%section%shape)) then
            call new_shape(findloc(shape_names == drawing%section%shape_name, .true., dim=1), unset, unset, &
                           new%section%shape)
         end if
         call v%collect(name)
         call new%visit(name, v)
         call v%list()
         if (present(number)) then
            call one%open_group(name)
            if (name == 'steel') one%section%steels(1) = drawing%section%steels(number)
            if (name == 'parameter') one%parameters(1) = drawing%parameters(number)
            call one%visit(name, v)
         else
            call drawing%visit(name, v)
         end if
         if (v%listed > 0) call sink%group(name, v%entry(:v%listed))
      end subroutine write_group
   end subroutine write_drawing

   !> Write a column with its damping and its springs; equal springs are written once.
   subroutine write_column(column, sink)
      type(column_record), intent(inout) :: column
      class(sink_type), intent(inout) :: sink
      type(column_record) :: new
      type(key_visitor) :: v
      type(spring_list) :: layer_springs
      integer :: beneath

      call v%collect('column')
      call new%visit(v)
      call v%list()
      call column%visit(v)
      call sink%group('column', v%entry(:v%listed))
      call v%collect('damping')
      call new%damping%visit(v)
      call v%list()
      call column%damping%visit(v)
      if (v%listed > 0) call sink%group('damping', v%entry(:v%listed))
      beneath = merge(1, 0, column%footing)
      if (allocated(column%shear)) call write_springs('shear', column%shear, beneath, layer_springs, sink)
      if (allocated(column%flexure)) then
         call write_springs('flexure', column%flexure, beneath, layer_springs, sink)
      end if
      if (allocated(column%axial_spring)) then
         call write_springs('axial_spring', column%axial_spring, beneath, layer_springs, sink)
      end if
   end subroutine write_column

   !> Write the springs of one kind.
   subroutine write_springs(group, spring, beneath, layer_springs, sink)
      character(len=*), intent(in) :: group
      type(spring_record), intent(in) :: spring(:)
      !> Number of joints beneath joint 1
      integer, intent(in) :: beneath
      !> Springs of layers that have been written before
      type(spring_list), intent(inout) :: layer_springs
      class(sink_type), intent(inout) :: sink
      type(entry_type), allocatable :: entry(:)
      integer :: first(size(spring)), i, j
      logical :: one_for_all

      do i = 1, size(spring)
         first(i) = i
         do j = 1, i - 1
            if (first(j) /= j) cycle
            if (.not. spring(j)%same_as(spring(i))) cycle
            first(i) = j
            exit
         end do
      end do
      one_for_all = all(first == 1) .and. beneath == 0
      do i = 1, size(spring)
         if (first(i) /= i) cycle
         if (one_for_all) then
            call spring_entries(spring(i), 0, entry)
         else
            call spring_entries(spring(i), 1, entry)
            call set_joints(entry(1), first, i, beneath)
         end if
         call sink%group(group, entry)
         if (.not. allocated(spring(i)%y)) cycle
         call write_layers(spring(i), merge(0, i, one_for_all), first, beneath, layer_springs, sink)
      end do
   end subroutine write_springs

   !> The joints that have the same spring as joint i.
   subroutine set_joints(entry, first, i, beneath)
      type(entry_type), intent(inout) :: entry
      integer, intent(in) :: first(:), i
      !> Number of joints beneath joint 1
      integer, intent(in) :: beneath
      integer :: j

      entry%name = 'joint'
      entry%kind = integer_kind
      entry%number = real(pack([(j - beneath, j=1, size(first))], first == i), wp)
   end subroutine set_joints

   !> The entries of rule and parameters of a spring.
   subroutine spring_entries(spring, before, entry)
      type(spring_record), intent(in) :: spring
      !> Number of entries to leave free for the caller
      integer, intent(in) :: before
      type(entry_type), allocatable, intent(out) :: entry(:)
      type(key_type), allocatable :: keys(:)
      integer :: i, count

      call keys_of(spring%rule, keys)
      count = before + 1
      allocate (entry(count + count_given(spring, keys)))
      entry(count)%name = 'rule'
      entry(count)%kind = text_kind
      entry(count)%text = trim(spring%rule)
      do i = 1, size(keys)
         if (.not. is_written(spring, keys(i), i)) cycle
         count = count + 1
         entry(count)%name = keys(i)%name
         if (keys(i)%kind == word_kind) then
            entry(count)%kind = text_kind
            entry(count)%text = trim(choice_name(keys(i), nint(spring%value(i))))
         else
            entry(count)%number = [spring%value(i)]
         end if
      end do
   end subroutine spring_entries

   pure integer function count_given(spring, keys)
      type(spring_record), intent(in) :: spring
      type(key_type), intent(in) :: keys(:)
      integer :: i

      count_given = count([(is_written(spring, keys(i), i), i=1, size(keys))])
   end function count_given

   !> Whether a parameter is given and differs from its default.
   pure logical function is_written(spring, key, i)
      type(spring_record), intent(in) :: spring
      type(key_type), intent(in) :: key
      integer, intent(in) :: i

      is_written = is_given(spring%value(i))
      if (is_written .and. is_given(key%default)) is_written = abs(spring%value(i) - key%default) > 0.0_wp
   end function is_written

   !> Write the springs of layers that have not been written before, then the layers.
   subroutine write_layers(spring, joint, first, beneath, layer_springs, sink)
      type(spring_record), intent(in) :: spring
      !> First of the joints that have the spring, 0: all
      integer, intent(in) :: joint, first(:)
      !> Number of joints beneath joint 1
      integer, intent(in) :: beneath
      type(spring_list), intent(inout) :: layer_springs
      class(sink_type), intent(inout) :: sink
      type(entry_type), allocatable :: entry(:)
      type(spring_record) :: layer
      integer :: id(size(spring%y)), i, j

      do i = 1, size(spring%y)
         layer = spring%layer(i)
         do j = 1, layer_springs%count
            if (layer_springs%spring(j)%same_as(layer)) exit
         end do
         id(i) = j
         if (j <= layer_springs%count) cycle
         call remember(layer_springs, layer)
         call spring_entries(layer, 1, entry)
         entry(1)%name = 'id'
         entry(1)%kind = integer_kind
         entry(1)%number = [real(j, wp)]
         call sink%group('layer_spring', entry)
      end do
      if (allocated(entry)) deallocate (entry)
      allocate (entry(3))
      if (joint > 0) call set_joints(entry(1), first, joint, beneath)
      entry(2)%name = 'y'
      entry(2)%number = spring%y
      entry(3)%name = 'spring'
      entry(3)%kind = integer_kind
      entry(3)%number = real(id, wp)
      call sink%group('layers', entry(merge(1, 2, joint > 0):))
   end subroutine write_layers

   subroutine remember(list, spring)
      type(spring_list), intent(inout) :: list
      type(spring_record), intent(in) :: spring
      type(spring_record), allocatable :: longer(:)

      if (.not. allocated(list%spring)) allocate (list%spring(16))
      if (list%count == size(list%spring)) then
         allocate (longer(2*list%count))
         longer(:list%count) = list%spring
         call move_alloc(longer, list%spring)
      end if
      list%count = list%count + 1
      list%spring(list%count) = spring
   end subroutine remember

   !> Write `&name key = value, ... /` in lines of limited length.
   subroutine namelist_group(self, name, entry)
      class(namelist_sink), intent(inout) :: self
      character(len=*), intent(in) :: name
      type(entry_type), intent(in) :: entry(:)
      character(len=:), allocatable :: full, head
      integer :: column, i, j

      call self%buffer%append('&'//name)
      column = 1 + len(name)
      do i = 1, size(entry)
         head = trim(entry(i)%name)//' = '
         if (i > 1) call self%buffer%append(',')
         if (allocated(entry(i)%text)) then
            call quote(entry(i)%text, full)
            call piece(head//full)
            cycle
         end if
         do j = 1, size(entry(i)%number)
            if (j > 1) call self%buffer%append(',')
            if (j > 1) head = ''
            call piece(head//trim(value_text(entry(i)%kind, entry(i)%number(j))))
         end do
      end do
      call self%buffer%append(' /'//new_line('a'))

   contains

      !> Append a piece after a blank, or on the next line.
      subroutine piece(text)
         character(len=*), intent(in) :: text

         if (column + 2 + len(text) > line_length) then
            call self%buffer%append(new_line('a')//'  ')
            column = 2
         end if
         call self%buffer%append(' '//text)
         column = column + 2 + len(text)
      end subroutine piece
   end subroutine namelist_group

   !> A text in quotes; quotes within are doubled.
   pure subroutine quote(text, quoted)
      character(len=*), intent(in) :: text
      character(len=:), allocatable, intent(out) :: quoted
      character(len=2*len(text) + 2) :: full
      integer :: i, at

      at = 1
      full(1:1) = ''''
      do i = 1, len(text)
         at = at + 1
         full(at:at) = text(i:i)
         if (text(i:i) /= '''') cycle
         at = at + 1
         full(at:at) = ''''
      end do
      at = at + 1
      full(at:at) = ''''
      quoted = full(:at)
   end subroutine quote

   pure function value_text(kind, x) result(text)
      character(len=1), intent(in) :: kind
      real(wp), intent(in) :: x
      character(len=32) :: text

      select case (kind)
      case (integer_kind)
         text = to_text(nint(x))
      case (logical_kind)
         text = merge('.true. ', '.false.', abs(x) > 0.0_wp)
      case default
         text = exact_text(x)
      end select
   end function value_text

   !> Append `name key key:count key=text`, separated by tabs, and the numbers.
   subroutine statement_group(self, name, entry)
      class(statement_sink), intent(inout) :: self
      character(len=*), intent(in) :: name
      type(entry_type), intent(in) :: entry(:)
      character(len=1), parameter :: tab = achar(9)
      integer :: i

      call self%buffer%append(name)
      do i = 1, size(entry)
         call self%buffer%append(tab//trim(entry(i)%name))
         if (allocated(entry(i)%text)) then
            call self%buffer%append('='//entry(i)%text)
            cycle
         end if
         if (size(entry(i)%number) /= 1) call self%buffer%append(':'//to_text(size(entry(i)%number)))
         call add_numbers(self, entry(i)%number)
      end do
      call self%buffer%append(new_line('a'))
   end subroutine statement_group

   subroutine add_numbers(self, number)
      type(statement_sink), intent(inout) :: self
      real(wp), intent(in) :: number(:)
      real(wp), allocatable :: longer(:)

      if (.not. allocated(self%number)) allocate (self%number(256))
      if (self%count + size(number) > size(self%number)) then
         allocate (longer(2*(self%count + size(number))))
         longer(:self%count) = self%number(:self%count)
         call move_alloc(longer, self%number)
      end if
      self%number(self%count + 1:self%count + size(number)) = number
      self%count = self%count + size(number)
   end subroutine add_numbers

end module rbs_case_writer
