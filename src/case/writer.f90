!> Writes a case as groups of keys and values: as the text of a case file, or as names and numbers for
!> Python. Values that equal the defaults are left out.
module rbs_case_writer
   use rbs_base_constants, only: unset
   use rbs_base_key_visitor, only: key_visitor, entry_type
   use rbs_base_keys, only: key_type, integer_kind, logical_kind
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_base_text, only: to_text, exact_text, text_buffer
   use rbs_case_case_record, only: case_record
   use rbs_case_drawing_record, only: drawing_groups, drawing_record
   use rbs_case_judgement_record, only: judgement_groups
   use rbs_case_spring_entry, only: entry_list, spring_entry
   use rbs_structure_frame_frame_record, only: frame_groups
   use rbs_hysteresis_registry, only: keys_of
   use rbs_hysteresis_spring_record, only: spring_record
   use rbs_section_shape, only: new_shape
   implicit none
   private

   public :: case_text, write_case

   !> Longest line of a namelist text.
   integer, parameter :: line_length = 100

   !> Groups as text: that of a case file, from whose numbers the same bits are read back, or a statement for
   !> Python: names in lines, one per group, and numbers in an array, see `rbs_bindings_statements`.
   type :: case_text
      logical :: is_statement = .false.
      type(text_buffer) :: buffer
      !> Numbers of a statement
      type(stream_type) :: numbers
   contains
      procedure :: group => add_group
   end type case_text

contains

   !> Write the whole case without its units: numbers are in SI.
   subroutine write_case(case, text)
      type(case_record), intent(inout) :: case
      type(case_text), intent(inout) :: text
      !> Springs of layers that have been written before
      type(entry_list) :: layer_springs
      integer :: g, i

      call write_record('case')
      if (allocated(case%frame)) then
         call write_frame()
      else
         call write_record('column')
      end if
      call write_record('damping')
      if (.not. allocated(case%frame)) then
         call write_springs('shear', case%column%shear)
         call write_springs('flexure', case%column%flexure)
         call write_springs('axial_spring', case%column%axial_spring)
      end if
      if (allocated(case%drawing)) then
         do i = 1, size(case%drawing)
            call write_drawing(case%drawing(i))
         end do
      end if
      do i = 1, case%loadings
         call write_record('loading', i)
      end do
      call write_record('analysis')
      do g = 1, size(judgement_groups)
         do i = 1, case%judgement%count_of(judgement_groups(g))
            call write_record(trim(judgement_groups(g)), i)
         end do
      end do
      call write_record('output')

   contains

      !> Write the groups of a frame and its springs.
      subroutine write_frame()
         type(spring_entry) :: entry
         integer :: g, i

         do g = 1, size(frame_groups)
            do i = 1, case%frame%count_of(frame_groups(g))
               call write_record(trim(frame_groups(g)), i)
            end do
         end do
         do i = 1, size(case%frame%spring)
            entry%frame_spring = case%frame%spring(i)
            call write_spring(entry)
            if (allocated(entry%spring%y)) call write_layers(entry)
         end do
      end subroutine write_frame

      !> Write the values of a group that differ from those of a new record.
      subroutine write_record(group, number, drawing)
         character(len=*), intent(in) :: group
         !> Number among the groups of this name; without it the last
         integer, intent(in), optional :: number
         !> Drawing that the group is of
         type(drawing_record), intent(inout), optional :: drawing
         type(case_record) :: new
         type(key_visitor) :: v

         ! The visitor collects the defaults from a new record, then lists what differs from them. The keys
         ! of a section depend on its shape.
         call new%open_group(group)
         if (group == 'section') then
            call new_shape(drawing%section%shape_name, unset, unset, new%drawing(1)%section%shape)
         end if
         call v%collect(group)
         call new%visit_group(group, v)
         call v%list()
         if (present(drawing)) then
            call drawing%visit_group(group, v, number)
         else
            call case%visit_group(group, v, number)
         end if
         ! A case needs these three, even if all their values are defaults.
         if (v%listed > 0 .or. any(group == [character(len=7) :: 'column', 'loading', 'frame'])) then
            call text%group(group, v%entry(:v%listed))
         end if
      end subroutine write_record

      !> Write the groups of a drawing, in the order of their names.
      subroutine write_drawing(drawing)
         type(drawing_record), intent(inout) :: drawing
         integer :: g, i

         do g = 1, size(drawing_groups)
            do i = 1, drawing%count_of(drawing_groups(g))
               call write_record(trim(drawing_groups(g)), i, drawing)
            end do
         end do
      end subroutine write_drawing

      !> Write a spring, or the layers of joints.
      subroutine write_spring(entry)
         type(spring_entry), intent(inout) :: entry
         type(spring_entry) :: new
         type(key_type), allocatable :: keys(:)
         type(key_visitor) :: v

         ! Keys that have the values of a new spring are left out.
         call keys_of(entry%spring%rule, keys)
         new%group = entry%group
         call v%collect(entry%group)
         call new%visit(v, keys)
         call v%list()
         call entry%visit(v, keys)
         call text%group(trim(entry%group), v%entry(:v%listed))
      end subroutine write_spring

      !> Write the springs of layers that have not been written before, then the layers.
      subroutine write_layers(joint)
         !> The joints and their layered spring
         type(spring_entry), intent(in) :: joint
         type(spring_entry) :: layers
         type(spring_record) :: layer
         integer :: i, j

         layers = joint
         layers%group = 'layers'
         layers%y = joint%spring%y
         allocate (layers%layer(size(layers%y)))
         do i = 1, size(layers%y)
            layer = joint%spring%layer(i)
            do j = 1, layer_springs%count
               if (layer_springs%entry(j)%spring%same_as(layer)) exit
            end do
            ! Without an equal one j is the number of a new spring, which becomes its id.
            layers%layer(i) = j
            if (j <= layer_springs%count) cycle
            call layer_springs%add('layer_spring', '', 0)
            layer_springs%entry(j)%id = j
            layer_springs%entry(j)%spring = layer
            call write_spring(layer_springs%entry(j))
         end do
         call write_spring(layers)
      end subroutine write_layers

      !> Write the springs of one kind of a column; equal springs are written once.
      subroutine write_springs(group, spring)
         character(len=*), intent(in) :: group
         type(spring_record), intent(in), allocatable :: spring(:)
         type(spring_entry) :: entry
         integer, allocatable :: first(:)
         !> 1 on a footing, whose joint has the number 0
         integer :: i, j, beneath

         if (.not. allocated(spring)) return
         ! For each joint the first that has the same spring; the lowest joint of a footing has number 0.
         allocate (first(size(spring)))
         beneath = merge(1, 0, case%column%footing)
         do i = 1, size(spring)
            first(i) = i
            do j = 1, i - 1
               if (first(j) /= j) cycle
               if (.not. spring(j)%same_as(spring(i))) cycle
               first(i) = j
               exit
            end do
         end do
         do i = 1, size(spring)
            if (first(i) /= i) cycle
            entry%group = group
            entry%spring = spring(i)
            if (any(first /= 1) .or. beneath > 0) then
               entry%joint = pack([(j - beneath, j=1, size(first))], first == i)
            end if
            call write_spring(entry)
            if (allocated(spring(i)%y)) call write_layers(entry)
         end do
      end subroutine write_springs

   end subroutine write_case

   !> Add one group, in the form of a case file or of a statement.
   subroutine add_group(self, name, entry)
      class(case_text), intent(inout) :: self
      !> Name of the group, and its keys with their values
      character(len=*), intent(in) :: name
      type(entry_type), intent(inout) :: entry(:)

      if (self%is_statement) then
         call statement_group()
      else
         call namelist_group(self, name, entry)
      end if

   contains

      !> Append the line `name key key:count key=text`, separated by tabs, and the numbers to their stream. A
      !> key alone has one number, key:count has several, key=text has none.
      subroutine statement_group()
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
            call self%numbers%item(entry(i)%number)
         end do
         call self%buffer%append(new_line('a'))
      end subroutine statement_group

   end subroutine add_group

   !> Write a group, `&name key = value, ... /`, in lines of limited length.
   subroutine namelist_group(self, name, entry)
      type(case_text), intent(inout) :: self
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
            select case (entry(i)%kind)
            case (integer_kind)
               call piece(head//to_text(nint(entry(i)%number(j))))
            case (logical_kind)
               call piece(head//trim(merge('.true. ', '.false.', abs(entry(i)%number(j)) > 0.0_wp)))
            case default
               call piece(head//trim(exact_text(entry(i)%number(j))))
            end select
         end do
      end do
      call self%buffer%append(' /'//new_line('a'))

   contains

      !> Append a piece after a blank, or on the next line where it would not fit; move `column` to the end.
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
      integer :: i

      quoted = ''''
      do i = 1, len(text)
         quoted = quoted//text(i:i)
         if (text(i:i) == '''') quoted = quoted//''''
      end do
      quoted = quoted//''''
   end subroutine quote

end module rbs_case_writer
