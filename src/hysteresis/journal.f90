!> Saved states of springs from before they changed their lines, so that a trial can be undone.
module rbs_hysteresis_journal
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_layered, only: layered_rule
   use rbs_hysteresis_rule, only: rule_type
   use rbs_hysteresis_segment, only: segment
   implicit none
   private

   public :: journal_type, rule_slot

   !> Holds one rule. The program uses arrays of this type in place of polymorphic arrays.
   type :: rule_slot
      class(rule_type), allocatable :: rule
   end type rule_slot

   type :: journal_type
      !> Whether changes are being saved
      logical :: open = .false.
      !> Deformations and works at the start (count) [m or rad, J]
      real(wp), allocatable :: d(:), work(:)
      !> Number of lines left at the start
      integer :: events = 0
      !> Number of springs that have changed their lines since, and which (changed)
      integer :: changed = 0
      integer, allocatable :: spring(:)
      !> Whether each spring is among them (count)
      logical, allocatable :: is_kept(:)
      !> The lines that they had (changed), and their rules with their memory (count). A layered joint marks
      !> itself: of its many layers few change
      type(segment), allocatable :: line(:)
      type(rule_slot), allocatable :: slot(:)
   contains
      procedure :: start
      procedure :: keep
      procedure :: give_back
      procedure :: forget
   end type journal_type

contains

   !> Start to save changes.
   subroutine start(self, d, work, events)
      class(journal_type), intent(inout) :: self
      !> Present deformations and works (count)
      real(wp), intent(in) :: d(:), work(:)
      integer, intent(in) :: events
      integer :: n

      n = size(d)
      if (.not. allocated(self%is_kept)) then
         allocate (self%is_kept(n), source=.false.)
         allocate (self%spring(n), self%line(n), self%slot(n), self%d(n), self%work(n))
      end if
      call self%forget()
      self%open = .true.
      self%d(:) = d
      self%work(:) = work
      self%events = events
   end subroutine start

   !> Save a spring before it changes its line for the first time; a layered joint is marked.
   subroutine keep(self, i, line, slot)
      class(journal_type), intent(inout) :: self
      integer, intent(in) :: i
      type(segment), intent(in) :: line
      type(rule_slot), intent(inout) :: slot
      logical :: done

      if (self%is_kept(i)) return
      self%is_kept(i) = .true.
      self%changed = self%changed + 1
      self%spring(self%changed) = i
      self%line(self%changed) = line
      select type (rule => slot%rule)
      class is (layered_rule)
         call rule%mark()
      class default
         done = .false.
         if (allocated(self%slot(i)%rule)) call self%slot(i)%rule%copy_memory(rule, done)
         if (.not. done) self%slot(i) = slot
      end select
   end subroutine keep

   !> Give spring i the rule back that it had at the start.
   subroutine give_back(self, i, slot)
      class(journal_type), intent(inout) :: self
      integer, intent(in) :: i
      type(rule_slot), intent(inout) :: slot
      logical :: done

      self%is_kept(i) = .false.
      select type (rule => slot%rule)
      class is (layered_rule)
         call rule%restore()
         done = .true.
      class default
         call rule%copy_memory(self%slot(i)%rule, done)
      end select
      if (.not. done) slot = self%slot(i)
   end subroutine give_back

   !> Discard what has been saved, and stop saving.
   subroutine forget(self)
      class(journal_type), intent(inout) :: self

      self%is_kept(self%spring(:self%changed)) = .false.
      self%changed = 0
      self%open = .false.
   end subroutine forget

end module rbs_hysteresis_journal
