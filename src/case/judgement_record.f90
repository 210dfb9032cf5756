!> What a frame is judged by: the spectrum that asks for its target displacement, records beside it, and the
!> code whose limits its members have. Python computes these; the keys stand here with all others.
module rbs_case_judgement_record
   use rbs_base_constants, only: unset, unset_integer
   use rbs_base_error, only: message_list
   use rbs_base_key_visitor, only: key_visitor, visited_record
   use rbs_base_keys, only: above_zero, bound_type
   use rbs_base_kinds, only: wp
   implicit none
   private

   public :: judgement_record

   character(len=12), parameter, public :: judgement_groups(4) = [character(len=12) :: &
      'target', 'records', 'assess', 'limit']

   !> Accelerations as parts of g.
   type(bound_type), parameter :: part_of_g = bound_type(0.0_wp, 5.0_wp, least_open=.true.)
   type(bound_type), parameter :: ratio = bound_type(0.0_wp, 1.0_wp, least_open=.true.)

   type, extends(visited_record) :: target_record
      character(len=20) :: method = '', spectrum = ''
      real(wp) :: ag = unset, s_xs = unset, s_x1 = unset, long_period = unset, damping = unset
      character(len=4) :: soil = '', site_class = ''
      integer :: kind = unset_integer
   contains
      procedure :: visit => visit_target
   end type target_record

   type, extends(visited_record) :: records_record
      !> A file or a folder
      character(len=:), allocatable :: path
      character(len=8) :: units = ''
   contains
      procedure :: visit => visit_records
   end type records_record

   type, extends(visited_record) :: assess_record
      character(len=12) :: code = '', level = ''
      real(wp) :: knowledge = unset, detailing = unset
      logical :: primary = .true.
   contains
      procedure :: visit => visit_assess
   end type assess_record

   !> Rotations of members in place of those of a code.
   type, extends(visited_record) :: limit_record
      character(len=32) :: member = ''
      character(len=12) :: code = ''
      real(wp), allocatable :: rotations(:)
   contains
      procedure :: visit => visit_limit
   end type limit_record

   type :: judgement_record
      type(target_record), allocatable :: target
      type(records_record), allocatable :: records
      type(assess_record), allocatable :: assess(:)
      type(limit_record), allocatable :: limit(:)
   contains
      procedure :: open_group, count_of, asked, visit_group, validate
   end type judgement_record

contains

   !> Make room for the values of a group.
   subroutine open_group(self, group)
      class(judgement_record), intent(inout) :: self
      character(len=*), intent(in) :: group
      type(limit_record), allocatable :: longer(:)
      integer :: n

      select case (group)
      case ('target')
         allocate (self%target)
      case ('records')
         allocate (self%records)
      case ('limit')
         n = self%count_of(group)
         allocate (longer(n + 1))
         if (n > 0) longer(:n) = self%limit
         call move_alloc(longer, self%limit)
      case default
         if (.not. allocated(self%assess)) allocate (self%assess(0))
         self%assess = [self%assess, assess_record()]
      end select
   end subroutine open_group

   !> How many groups of a name there are.
   pure integer function count_of(self, group) result(number)
      class(judgement_record), intent(in) :: self
      character(len=*), intent(in) :: group

      select case (group)
      case ('target')
         number = merge(1, 0, allocated(self%target))
      case ('records')
         number = merge(1, 0, allocated(self%records))
      case ('limit')
         number = 0
         if (allocated(self%limit)) number = size(self%limit)
      case default
         number = 0
         if (allocated(self%assess)) number = size(self%assess)
      end select
   end function count_of

   !> Whether a case asks for a target displacement or an assessment by a code.
   pure logical function asked(self)
      class(judgement_record), intent(in) :: self

      asked = allocated(self%target) .or. self%count_of('assess') > 0
   end function asked

   !> Present the keys of a group.
   subroutine visit_group(self, group, v, number)
      class(judgement_record), intent(inout) :: self
      character(len=*), intent(in) :: group
      type(key_visitor), intent(inout) :: v
      !> Number among the groups of this name; without it the last
      integer, intent(in), optional :: number
      integer :: i

      select case (group)
      case ('target')
         call self%target%visit(v)
      case ('records')
         call self%records%visit(v)
      case default
         i = self%count_of(group)
         if (present(number)) i = number
         if (group == 'limit') then
            call self%limit(i)%visit(v)
         else
            call self%assess(i)%visit(v)
         end if
      end select
   end subroutine visit_group

   !> The keys of the target displacement.
   subroutine visit_target(self, v)
      class(target_record), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%word('method', self%method, 'method of the target displacement', &
                  'asce_41 en_1998 capacity_spectrum', required=.true.)
      call v%word('spectrum', self%spectrum, 'code of the elastic spectrum', 'en_1998 asce_41', &
                  required=.true.)
      call v%key('ag', self%ag, '', part_of_g, 'EN 1998: acceleration of the ground of type A, as a '// &
                 'part of g', optional=.true.)
      call v%word('soil', self%soil, 'EN 1998: type of the ground, B without it')
      call v%key('kind', self%kind, '', bound_type(1.0_wp, 2.0_wp), 'EN 1998: type of the spectrum, 1 '// &
                 'without it', optional=.true.)
      call v%key('s_xs', self%s_xs, '', part_of_g, 'ASCE 41: acceleration at short periods, as a part of g', &
                 optional=.true.)
      call v%key('s_x1', self%s_x1, '', part_of_g, 'ASCE 41: acceleration at 1 s, as a part of g', &
                 optional=.true.)
      call v%key('long_period', self%long_period, 's', above_zero, 'ASCE 41: T_L, 8 s without it', &
                 optional=.true.)
      call v%key('damping', self%damping, '', ratio, 'damping ratio of the spectrum, 0.05 without it', &
                 optional=.true.)
      call v%word('site_class', self%site_class, 'ASCE 41: class of the site, D without it')
   end subroutine visit_target

   !> The keys of the records that run beside the target.
   subroutine visit_records(self, v)
      class(records_record), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%long_text('path', self%path, 'file or folder of records, from the folder of the case: they '// &
                       'are scaled to the spectrum and run beside the target', required=.true.)
      call v%word('units', self%units, 'unit of records that name none: g, m/s2, cm/s2')
   end subroutine visit_records

   !> The keys of an assessment by a code.
   subroutine visit_assess(self, v)
      class(assess_record), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%word('code', self%code, 'code whose limits the members have', 'asce_41 en_1998_3', &
                  required=.true.)
      call v%word('level', self%level, 'level that is judged (IO, LS, CP or DL, SD, NC); without it the last')
      call v%key('knowledge', self%knowledge, '', ratio, 'ASCE 41: kappa, by which limits are multiplied', &
                 optional=.true.)
      call v%key('primary', self%primary, 'EN 1998-3: whether members are primary ones')
      call v%key('detailing', self%detailing, '', ratio, 'EN 1998-3: factor of the ultimate rotations of '// &
                 'members without seismic detailing or with smooth bars', optional=.true.)
   end subroutine visit_assess

   !> The keys of limits of one member.
   subroutine visit_limit(self, v)
      class(limit_record), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%word('member', self%member, 'name of a member or of a node with a panel, or a pattern of '// &
                  'names, as C-*-1; the last that fits counts', required=.true.)
      call v%key('rotations', self%rotations, 'rad', above_zero, 'its limits in place of those of '// &
                 'the code, one for each level, ascending', 3, required=.true.)
      call v%word('code', self%code, 'code whose levels these are, of all &assess without it', &
                  'asce_41 en_1998_3')
   end subroutine visit_limit

   !> Add a message for every value that is refused.
   subroutine validate(self, messages)
      class(judgement_record), intent(inout) :: self
      type(message_list), intent(inout) :: messages
      integer :: i

      if (allocated(self%target)) call self%target%check('target', messages)
      if (allocated(self%records)) then
         call self%records%check('records', messages)
         if (.not. allocated(self%target)) then
            call messages%add('records: they are scaled to the spectrum of a &target; give that too')
         end if
      end if
      do i = 1, self%count_of('assess')
         call self%assess(i)%check('assess', messages)
      end do
      do i = 1, self%count_of('limit')
         call self%limit(i)%check('limit', messages)
         if (self%count_of('assess') == 0) call messages%add('limit: it is one of an &assess; give that too')
      end do
   end subroutine validate

end module rbs_case_judgement_record
