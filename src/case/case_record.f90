!> A whole case: the contents of a namelist file.
module rbs_case_case_record
   use rbs_base_check, only: is_given
   use rbs_base_error, only: message_list
   use rbs_base_kinds, only: wp
   use rbs_base_key_visitor, only: key_visitor, visited_record
   use rbs_base_text, only: to_text
   use rbs_base_units, only: unit_system, unit_named, length_units, force_units, mass_units
   use rbs_case_analysis_record, only: analysis_record, output_record
   use rbs_case_drawing_record, only: drawing_groups, drawing_record
   use rbs_case_judgement_record, only: judgement_groups, judgement_record
   use rbs_hysteresis_spring_record, only: spring_record
   use rbs_structure_column_column_record, only: column_record
   use rbs_loading_loading_record, only: loading_record
   use rbs_structure_frame_frame_checks, only: check_reference
   use rbs_structure_frame_frame_parts, only: frame_parts
   use rbs_structure_frame_frame_record, only: frame_groups, frame_record, name_length
   implicit none
   private

   public :: case_record, most_loadings

   !> A force, a ground motion in two directions and an axial load may act together.
   integer, parameter :: most_loadings = 5

   !> Names of the units of a case.
   type, extends(visited_record) :: units_record
      character(len=8) :: force = 'N', length = 'm', mass = 'kg'
   contains
      procedure :: visit => visit_units, system
   end type units_record

   !> The input of a run.
   type, extends(visited_record) :: case_record
      !> One line for the header of the output
      character(len=:), allocatable :: title
      type(units_record) :: units
      type(column_record) :: column
      !> A frame in place of the column, whose damping it has then
      type(frame_record), allocatable :: frame
      !> Its nodes and members, once it has been validated
      type(frame_parts), allocatable :: parts
      !> Drawings that its springs were made of, if they are known: one of a column, several of a drawn frame
      type(drawing_record), allocatable :: drawing(:)
      !> Where the first of them, or another group that Python needs, stands: 'case.nml line 4:'
      character(len=80) :: drawn_at = ''
      !> What Python judges a frame by
      type(judgement_record) :: judgement
      !> Number of loadings
      integer :: loadings = 0
      type(loading_record) :: loading(most_loadings)
      type(analysis_record) :: analysis
      type(output_record) :: output
   contains
      procedure :: open_group, visit, visit_group, settle, validate, check_static, height, is_drawn
   end type case_record

contains

   !> Make room for the values of a group: one more loading, frame part or drawing. A group of a drawing
   !> belongs to the last drawing.
   subroutine open_group(self, group)
      class(case_record), intent(inout) :: self
      character(len=*), intent(in) :: group
      type(drawing_record), allocatable :: longer(:)
      logical :: is_new
      integer :: n

      if (group == 'loading') self%loadings = self%loadings + 1
      if (any(frame_groups == group)) then
         if (.not. allocated(self%frame)) allocate (self%frame)
         call self%frame%open_group(group)
      end if
      if (any(judgement_groups == group)) call self%judgement%open_group(group)
      if (all(drawing_groups /= group)) return
      n = 0
      if (allocated(self%drawing)) n = size(self%drawing)
      is_new = n == 0
      ! Its groups may have come before &drawing itself.
      if (group == 'drawing' .and. n > 0) is_new = self%drawing(n)%stated
      if (is_new) then
         allocate (longer(n + 1))
         if (n > 0) longer(:n) = self%drawing
         call move_alloc(longer, self%drawing)
      end if
      call self%drawing(size(self%drawing))%open_group(group)
   end subroutine open_group

   !> Present the keys of a group; a group of a drawing is that of the last drawing.
   subroutine visit_group(self, group, v, number)
      class(case_record), intent(inout) :: self
      character(len=*), intent(in) :: group
      type(key_visitor), intent(inout) :: v
      !> Number among the groups of this name; without it the last
      integer, intent(in), optional :: number
      integer :: i

      select case (group)
      case ('case')
         call self%visit(v)
      case ('units')
         call self%units%visit(v)
      case ('column')
         call self%column%visit(v)
      case ('damping')
         call self%column%damping%visit(v)
      case ('loading')
         i = self%loadings
         if (present(number)) i = number
         call self%loading(i)%visit(v)
      case ('analysis')
         call self%analysis%visit(v)
      case ('output')
         call self%output%visit(v)
      case default
         if (any(judgement_groups == group)) then
            call self%judgement%visit_group(group, v, number)
         else if (any(frame_groups == group)) then
            call self%frame%visit_group(group, v, number)
         else
            call self%drawing(size(self%drawing))%visit_group(group, v, number)
         end if
      end select
   end subroutine visit_group

   !> The keys of the case itself.
   subroutine visit(self, v)
      class(case_record), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%long_text('title', self%title, 'one line for the header of the output')
   end subroutine visit

   !> The keys of the units.
   subroutine visit_units(self, v)
      class(units_record), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%word('force', self%force, 'unit of forces in the file and in the csv', 'N kN MN kip')
      call v%word('length', self%length, 'unit of lengths in the file and in the csv', 'm mm cm in')
      call v%word('mass', self%mass, 'unit of masses in the file', 'kg t')
   end subroutine visit_units

   !> The units by their names.
   pure type(unit_system) function system(self)
      class(units_record), intent(in) :: self

      system%force = unit_named(force_units, self%force)
      system%length = unit_named(length_units, self%length)
      system%mass = unit_named(mass_units, self%mass)
   end function system

   !> Set values that follow from other input: sources and units of the loadings, the method.
   subroutine settle(self)
      class(case_record), intent(inout) :: self
      !> Whether the ground moves in a loading; whether a force or axial load has times
      logical :: moving, timed
      integer :: i

      moving = .false.
      timed = .false.
      do i = 1, self%loadings
         associate (loading => self%loading(i))
            call loading%settle()
            moving = moving .or. index(loading%drive, 'acceleration') > 0
            timed = timed .or. ((loading%drive == 'force' .or. loading%drive == 'axial_load') &
                                .and. loading%has_time())
            if (loading%unit /= '') cycle
            select case (loading%drive)
            case ('force', 'axial_load')
               if (self%units%force /= 'N') loading%unit = self%units%force
            case ('displacement')
               if (self%units%length /= 'm' &
                   .and. loading%source /= 'protocol') loading%unit = self%units%length
            case default                            ! accelerations are in m/s2
            end select
         end associate
      end do
      if (self%analysis%method /= '') return
      ! With times alone the method stays empty: the user must choose (`validate`).
      self%analysis%named = .false.
      if (moving) then
         self%analysis%method = 'auto'
      else if (.not. timed) then
         self%analysis%method = 'static'
      end if
   end subroutine settle

   !> Add a message for every error of the case.
   subroutine validate(self, messages)
      class(case_record), intent(inout) :: self
      type(message_list), intent(inout) :: messages
      type(frame_record) :: with_kinds
      integer :: i, known

      known = messages%count
      call self%units%check('units', messages)
      ! Numbers cannot be judged if their units are unknown.
      if (messages%count > known) return
      call self%settle()
      if (allocated(self%frame)) then
         call validate_frame()
      else
         self%column%drawn = self%is_drawn()
         call self%column%validate(messages)
      end if
      if (allocated(self%drawing)) then
         do i = 1, size(self%drawing)
            if (i > 1) call self%drawing(i)%take_materials(self%drawing(i - 1))
            call self%drawing(i)%validate(allocated(self%frame), self%is_drawn(), messages)
         end do
         if (size(self%drawing) > 1 .and. .not. allocated(self%frame)) then
            call messages%add('drawing: a column has one; remove the others')
         end if
      end if
      if (self%analysis%method == '') then
         call messages%add("analysis: the loading has times, so method must be named: 'static' for the "// &
                           "path without inertia, or 'auto' for the response in time")
         return
      end if
      do i = 1, self%loadings
         ! The input that a loading needs depends on the method; an unknown method is reported below.
         if (.not. self%analysis%known()) exit
         call self%loading(i)%validate(self%analysis%dynamic(), messages)
      end do
      call check_together()
      call self%analysis%validate(messages)
      call self%check_static(messages)
      call self%judgement%validate(messages)
      call self%output%check('output', messages)
      if (self%output%motion .and. self%analysis%static()) then
         call messages%add('output: motion = .true. has no meaning in a static path, where nothing '// &
                           'moves; '//"remove it, or set method = 'auto' in the group analysis")
      end if

   contains

      !> Messages on the frame, and on groups that belong to columns alone.
      subroutine validate_frame()
         integer :: i

         allocate (self%parts)
         with_kinds = self%frame
         ! Elastic members in place of drawn ones, for the checks of all else.
         if (allocated(self%drawing)) then
            do i = 1, size(self%drawing)
               call stand_in(self%drawing(i)%name)
            end do
         end if
         call self%parts%find(with_kinds, messages)
         call check_sections()
         ! Python will make the members, so these parts are not those of the frame.
         if (self%is_drawn()) deallocate (self%parts)
         call self%column%damping%check('damping', messages)
         if (any(self%loading(:self%loadings)%drive == 'axial_load')) then
            call messages%add("loading: drive = 'axial_load' is for columns; in a frame they carry the "// &
                              'dead load of floors, beams and nodes')
         end if
      end subroutine validate_frame

      !> Check that the drawings that kinds of members name are there, and keys that need one.
      subroutine check_sections()
         character(len=name_length), allocatable :: names(:)
         integer :: i

         allocate (names(0))
         if (allocated(self%drawing)) names = self%drawing%name
         do i = 1, size(self%frame%kind)
            associate (kind => self%frame%kind(i), &
                       name => "member_kind '"//trim(self%frame%kind(i)%name)//"'")
               if (kind%section /= '') call check_reference(kind%section, names, name, 'drawing', messages)
               if (kind%section_to /= '') call check_reference(kind%section_to, names, name, 'drawing', &
                                                               messages)
               if (kind%section == '' .and. (kind%section_to /= '' .or. allocated(kind%shear_spans) .or. &
                                             any(is_given([kind%bar_length, kind%concrete_length])))) then
                  call messages%add(name//': section_to, shear_spans and lengths of layers are of a kind '// &
                                    'with a section; name it, or remove them')
               else if (allocated(kind%shear_spans)) then
                  if (size(kind%shear_spans) /= 4) then
                     call messages%add(name//': shear_spans has '//to_text(size(kind%shear_spans))// &
                                       ' values; give four')
                  end if
               end if
            end associate
         end do
      end subroutine check_sections

      !> Add a member kind with any numbers in place of a drawing, whose springs Python makes.
      subroutine stand_in(name)
         character(len=*), intent(in) :: name

         if (allocated(with_kinds%kind)) then
            if (name /= '' .and. any(with_kinds%kind%name == name)) then
               call messages%add("drawing '"//trim(name)//"': another drawing or member_kind has this "// &
                                 'name; give each a name of its own')
               return
            end if
         end if
         call with_kinds%open_group('member_kind')
         associate (kind => with_kinds%kind(size(with_kinds%kind)))
            kind%name = name
            kind%modulus = 3e10_wp
            kind%area = 0.16_wp
            kind%inertia = 2e-3_wp
         end associate
      end subroutine stand_in

      !> Refuse loadings that cannot act together.
      subroutine check_together()
         integer :: i

         if (self%loadings == 0) return
         if (.not. self%analysis%dynamic()) then
            if (all(self%loading(:self%loadings)%drive == 'axial_load')) then
               call messages%add("loading: drive = 'axial_load' alone does not drive a static path; "// &
                                 "give a displacement or a force too, or set method = 'auto' in the "// &
                                 'group analysis')
               return
            end if
            if (count(self%loading(:self%loadings)%drive /= 'axial_load') > 1) then
               call messages%add('loading: several loadings need a dynamic analysis; with method = '// &
                                 "'static' give one displacement or force, and the axial load if it varies")
               return
            end if
         end if
         do i = 2, self%loadings
            if (all(self%loading(:i - 1)%drive /= self%loading(i)%drive)) cycle
            call messages%add("loading: two loadings with drive = '"//trim(self%loading(i)%drive)// &
                              "'; give each drive once")
         end do
      end subroutine check_together

   end subroutine validate

   !> Height of the column or of the frame, to which drifts are in proportion [m].
   pure real(wp) function height(self)
      class(case_record), intent(in) :: self

      if (allocated(self%frame)) then
         height = self%frame%total_height()
      else
         height = self%column%height
      end if
   end function height

   !> Whether something is still to be made by Python: from drawings the springs of a column (but for those
   !> beneath its footing) or of the members of a frame, or the loads of a frame.
   pure logical function is_drawn(self)
      class(case_record), intent(in) :: self
      integer :: i

      if (.not. allocated(self%frame)) then
         is_drawn = allocated(self%drawing) .and. only_beneath(self%column%shear) &
                    .and. only_beneath(self%column%flexure)
         return
      end if
      associate (frame => self%frame)
         is_drawn = size(frame%infill_of) > 0 .or. allocated(frame%bays_x) &
                    .or. size(frame%node_load) > 0 .or. frame%self_weight &
                    .or. frame%mass /= 'of_floors' .or. any(abs(frame%floor%live_load) > 0.0_wp)
         if (.not. allocated(self%drawing)) return
         do i = 1, size(self%drawing)
            associate (name => self%drawing(i)%name)
               ! The springs of a kind are there, whatever section it names.
               is_drawn = is_drawn .or. any([frame%column_of%kind, frame%beam_of%kind] == name) .or. &
                          all([frame%kind%section, frame%kind%section_to] /= name)
            end associate
         end do
      end associate

   contains

      !> Whether a column has no springs of a kind but, on a footing, the one beneath it.
      pure logical function only_beneath(springs)
         type(spring_record), intent(in), allocatable :: springs(:)

         only_beneath = .not. allocated(springs)
         if (self%column%footing .and. .not. only_beneath) only_beneath = size(springs) == 1
      end function only_beneath
   end function is_drawn

   !> Refuse input that a static path cannot take: members of a frame that are lost at a time.
   subroutine check_static(self, messages)
      class(case_record), intent(in) :: self
      type(message_list), intent(inout) :: messages

      if (self%analysis%dynamic()) return
      if (allocated(self%frame)) then
         if (size(self%frame%loss) > 0) then
            call messages%add('loss: member '//trim(self%frame%loss(1)%member)//' is lost at a time, and '// &
                              'a static path has none; use a response in time, or leave the member out')
         end if
      end if
   end subroutine check_static

end module rbs_case_case_record
