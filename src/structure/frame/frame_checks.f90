!> Checks of the groups of a frame one by one, with messages and remedies.
module rbs_structure_frame_frame_checks
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use rbs_base_check, only: is_given
   use rbs_base_error, only: message_list
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: list_of, suggestion, to_text
   use rbs_hysteresis_registry, only: rule_names, suits
   use rbs_structure_frame_frame_record, only: frame_record, frame_spring, kind_record
   implicit none
   private

   public :: check_values, check_reference, is_rigid, is_strut, group_of

   !> A mechanism of sections that harden less is known to fewer digits than its energies are checked to.
   real(wp), parameter :: least_hardening = 1.0e-7_wp

   !> Groups of springs, in the order of their kinds, and the words for their places in rules and messages.
   character(len=*), parameter :: group_of(3) = [character(len=12) :: 'shear', 'flexure', 'axial_spring']
   character(len=*), parameter :: place_of(3) = [character(len=8) :: 'shear', 'flexure', 'axial']

contains

   !> Check the values of each group by itself.
   subroutine check_values(record, messages)
      type(frame_record), intent(inout) :: record
      type(message_list), intent(inout) :: messages
      integer :: i

      call record%check('frame', messages)
      do i = 1, size(record%plane)
         if (record%plane(i)%name == '') call messages%add('plane: the name is missing; give each a name')
         call record%plane(i)%check("plane '"//trim(record%plane(i)%name)//"'", messages)
         if (any(record%plane(:i - 1)%name == record%plane(i)%name)) then
            call messages%add("plane '"//trim(record%plane(i)%name)//"' is given twice; remove one")
         end if
      end do
      do i = 1, size(record%floor)
         call record%floor(i)%check('floor', messages)
      end do
      do i = 1, size(record%node_load)
         call record%node_load(i)%check('node_load', messages)
      end do
      call check_kinds(record, messages)
      do i = 1, size(record%column_of)
         call record%column_of(i)%check('column_of', messages)
      end do
      do i = 1, size(record%beam_of)
         call record%beam_of(i)%check('beam_of', messages)
      end do
      call check_infills(record, messages)
      do i = 1, size(record%node)
         if (record%node(i)%name == '') call messages%add('node: the name is missing; give each a name')
         call record%node(i)%check("node '"//trim(record%node(i)%name)//"'", messages)
      end do
      do i = 1, size(record%member)
         if (record%member(i)%name == '') call messages%add('member: the name is missing; give each a name')
         call record%member(i)%check("member '"//trim(record%member(i)%name)//"'", messages)
      end do
      do i = 1, size(record%loss)
         call record%loss(i)%check('loss', messages)
         if (any(record%loss(:i - 1)%member == record%loss(i)%member)) then
            call messages%add("loss: member '"//trim(record%loss(i)%member)//"' is lost twice; remove one")
         end if
      end do
      do i = 1, size(record%spring)
         call check_spring(record%spring(i), record%kind, messages)
      end do
   end subroutine check_values

   !> Check the kinds of members, each by itself, and that no name is given twice.
   subroutine check_kinds(record, messages)
      type(frame_record), intent(inout) :: record
      type(message_list), intent(inout) :: messages
      integer :: i, known

      do i = 1, size(record%kind)
         associate (k => record%kind(i))
            known = messages%count
            if (is_rigid(k, record%spring) .or. is_strut(k, record%spring)) then
               ! Elastic values do nothing in these kinds and need not be given; 1 passes the check.
               k%modulus = 1.0_wp
               k%area = 1.0_wp
               k%inertia = 1.0_wp
            end if
            call k%check("member_kind '"//trim(k%name)//"'", messages)
            if (messages%count == known) call check_kind(record, k, messages)
            if (any(record%kind(:i - 1)%name == k%name)) then
               call messages%add("member_kind '"//trim(k%name)//"' is given twice; remove one")
            end if
         end associate
      end do
   end subroutine check_kinds

   !> Check the infills, each by itself, and where they are.
   subroutine check_infills(record, messages)
      type(frame_record), intent(inout) :: record
      type(message_list), intent(inout) :: messages
      integer :: i

      do i = 1, size(record%infill)
         associate (infill => record%infill(i), name => "infill '"//trim(record%infill(i)%name)//"'")
            call infill%check(name, messages)
            if (infill%name == 'none') then
               call messages%add(name//': the name means that there is no infill; choose another one')
            else if (any(record%infill(:i - 1)%name == infill%name)) then
               call messages%add(name//' is given twice; remove one')
            end if
            if (.not. (is_given(infill%fm) .or. is_given(infill%strength))) then
               call messages%add(name//': fm is not given; give it, or strength')
            else if (infill%opening_length > 0.0_wp .neqv. infill%opening_height > 0.0_wp) then
               call messages%add(name//': opening_length and opening_height belong together; give both, '// &
                                 'or none')
            end if
         end associate
      end do
      do i = 1, size(record%infill_of)
         call record%infill_of(i)%check('infill_of', messages)
      end do
   end subroutine check_infills

   !> A spring stands in one place, where its rule may be used.
   subroutine check_spring(s, kind_of, messages)
      !> The spring with its place
      type(frame_spring), intent(inout) :: s
      !> All kinds of members
      type(kind_record), intent(in) :: kind_of(:)
      type(message_list), intent(inout) :: messages
      character(len=:), allocatable :: name, from
      !> Number of the group of springs in `group_of`
      integer :: kind
      logical :: within

      call s%spring%where_given(from)
      kind = findloc(group_of == s%group, .true., dim=1)
      name = from//trim(place_of(kind))//' spring of '
      if (count([s%kind, s%node, s%panel] /= '') /= 1) then
         call messages%add(from//'&'//trim(s%group)//': a spring of a frame belongs to a kind of '// &
                           'members, stands between a node and the ground, or is in the panel of a node; '// &
                           'give kind, node or panel')
         return
      else if (s%kind /= '') then
         name = name//"member_kind '"//trim(s%kind)//"'"
         call check_reference(s%kind, [kind_of%name], name, 'kind', messages)
      else
         name = name//"node '"//trim(s%node)//trim(s%panel)//"'"
      end if
      if (s%panel /= '' .and. s%group /= 'flexure') then
         call messages%add(name//': a panel has one spring, which turns; give it as &flexure')
      end if
      if (s%spring%rule == 'layered' .and. s%kind == '') then
         call messages%add(name//': a joint of layers stands in a member; take a rule for the moment '// &
                           'alone, such as takeda or peak_oriented')
         return
      end if
      call s%spring%validate(name, messages)
      ! A rule that is not known is reported by the spring.
      if (all(rule_names /= s%spring%rule)) return
      if (.not. suits(s%spring%rule, place_of(kind))) then
         call messages%add(name//" cannot be of the rule '"//trim(s%spring%rule)//"'; it is one of "// &
                           list_of(pack(rule_names, suits(rule_names, place_of(kind)))))
      end if
      if (.not. allocated(s%position)) return
      if (s%kind == '') then
         call messages%add(name//': position is for springs of members; remove it')
         return
      end if
      within = all(ieee_is_finite(s%position))
      if (within) within = all(s%position >= 0.0_wp .and. s%position <= 1.0_wp)
      if (.not. within) call messages%add(name//': position is a share of the clear length, from 0 to 1')
   end subroutine check_spring

   !> Refuse values of a kind that contradict each other: it is elastic, yields at its points, or has springs
   !> of its own.
   subroutine check_kind(record, kind, messages)
      type(frame_record), intent(in) :: record
      type(kind_record), intent(in) :: kind
      type(message_list), intent(inout) :: messages
      !> Number of flexural springs; the lowest and the highest position of springs that turn, in shares of
      !> the length
      integer :: i, bending
      real(wp) :: least, most

      if (kind%name == '') then
         call messages%add('member_kind: the name is missing; give each a name')
         return
      else if (kind%name == 'none') then
         call messages%add("member_kind 'none': the name means that there is no member; choose another one")
         return
      end if
      bending = 0
      least = 2.0_wp
      most = -1.0_wp
      do i = 1, size(record%spring)
         associate (s => record%spring(i))
            if (s%kind /= kind%name .or. s%group == 'axial_spring') cycle
            ! A slip turns both ends alike, which no spring at an end does: it counts as one more position.
            if (s%group == 'shear') most = most + 2.0_wp
            if (s%group == 'shear') cycle
            if (.not. allocated(s%position)) then
               bending = bending + 2
               least = 0.0_wp
               most = 1.0_wp
            else
               if (.not. all(ieee_is_finite(s%position))) return
               bending = bending + size(s%position)
               least = min(least, minval(s%position))
               most = max(most, maxval(s%position))
            end if
         end associate
      end do
      associate (name => "member_kind '"//trim(kind%name)//"'")
         if (is_given(kind%yield_moment) .and. any(record%spring%kind == kind%name)) then
            call messages%add(name//': it has a yield_moment and springs of its own; keep one of them')
         else if (abs(kind%hardening) > 0.0_wp .and. .not. is_given(kind%yield_moment)) then
            call messages%add(name//': hardening does nothing without yield_moment; give one, or remove it')
         else if (abs(kind%hardening) > 0.0_wp .and. abs(kind%hardening) < least_hardening) then
            call messages%add(name//': hardening = '//to_text(kind%hardening)//' is lost in round-off; '// &
                              'give 0, or '//to_text(least_hardening)//' or more')
         else if (is_given(kind%failure_drift) .neqv. is_given(kind%failure_load)) then
            call messages%add(name//': failure_drift and failure_load belong together; give both, or none')
         else if (is_given(kind%shear_drift) .and. .not. is_given(kind%failure_drift)) then
            call messages%add(name//': shear_drift does nothing without failure_drift; give that, or '// &
                              'remove it')
         else if (is_given(kind%failure_drift) .and. .not. is_given(kind%shear_drift) .and. .not. &
                  any(softens(record%spring, kind%name))) then
            call messages%add(name//': failure_drift is that after a failure in shear; give shear_drift, '// &
                              "or a shear spring of the rule 'peak_oriented' or 'pinching'")
         else if (kind%ends == 'pinned' .and. (bending > 0 .or. most > 0.0_wp .or. &
                                               is_given(kind%yield_moment) .or. &
                                               kind%shear_rigidity > 0.0_wp)) then
            call messages%add(name//": with ends = 'pinned' it carries axial force alone; remove "// &
                              'yield_moment, shear_rigidity and the springs that turn or slip')
         else if (kind%ends == 'pinned' .and. kind%interior == 'rigid' .and. &
                  .not. is_strut(kind, record%spring)) then
            call messages%add(name//": with ends = 'pinned' and interior = 'rigid' all of its "// &
                              'flexibility is in a spring; give it an axial_spring, or another interior')
         else if (kind%interior == 'rigid' .and. .not. (most > least .or. is_rigid(kind, record%spring) &
                                                        .or. is_strut(kind, record%spring))) then
            call messages%add(name//": with interior = 'rigid' all bending is in springs; give it two "// &
                              'flexural springs or more, at different positions, or none if it is rigid')
         end if
      end associate
   end subroutine check_kind

   !> Whether members of a kind do not deform at all.
   pure logical function is_rigid(kind, spring)
      type(kind_record), intent(in) :: kind
      !> All springs of the frame
      type(frame_spring), intent(in) :: spring(:)

      is_rigid = kind%interior == 'rigid' .and. .not. (is_given(kind%yield_moment) .or. &
                                                       any(spring%kind == kind%name))
   end function is_rigid

   !> Whether members of a kind are springs between two pins, and nothing else.
   pure logical function is_strut(kind, spring)
      type(kind_record), intent(in) :: kind
      !> All springs of the frame
      type(frame_spring), intent(in) :: spring(:)

      is_strut = kind%interior == 'rigid' .and. kind%ends == 'pinned' .and. any(spring%kind == kind%name)
   end function is_strut

   !> Whether a spring belongs to a kind of this name and may fail in shear.
   elemental logical function softens(spring, kind)
      type(frame_spring), intent(in) :: spring
      !> Name of the kind
      character(len=*), intent(in) :: kind

      softens = spring%kind == kind .and. spring%group == 'shear' .and. &
                (spring%spring%rule == 'peak_oriented' .or. spring%spring%rule == 'pinching')
   end function softens

   !> Refuse a name that is not in a list.
   subroutine check_reference(word, names, owner, key, messages)
      !> Name; those that there are; where it was given, and the key or the kind of thing, for the message
      character(len=*), intent(in) :: word, names(:), owner, key
      type(message_list), intent(inout) :: messages

      if (any(names == word)) return
      if (size(names) == 0) then
         call messages%add(owner//': there is no '//key//" '"//trim(word)//"'; give one")
      else if (word == '') then
         call messages%add(owner//': '//key//' is missing; it is one of '//list_of(names))
      else
         call messages%add(owner//': there is no '//key//" '"//trim(word)//"'; it is one of "// &
                           list_of(names)//suggestion(word, names))
      end if
   end subroutine check_reference

end module rbs_structure_frame_frame_checks
