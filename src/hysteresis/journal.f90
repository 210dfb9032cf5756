!> Saved states of springs from before they changed their lines, so that a trial can be undone.
module rbs_hysteresis_journal
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_layered, only: layered_rule
   use rbs_hysteresis_rule, only: rule_type
   use rbs_hysteresis_segment, only: segment
   implicit none
   private

   public :: journal_type, rule_slot, save_rule, return_rule

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
      real(wp), intent(in), contiguous :: d(:), work(:)
      integer, intent(in) :: events
      integer :: i, n

      n = size(d)
      if (.not. allocated(self%is_kept)) then
         allocate (self%is_kept(n), source=.false.)
         allocate (self%spring(n), self%line(n), self%slot(n), self%d(n), self%work(n))
      end if
      if (self%changed > 0) call self%forget()
      self%open = .true.
      do i = 1, n
         self%d(i) = d(i)
         self%work(i) = work(i)
      end do
      self%events = events
   end subroutine start

   !> Save a spring before it changes its line for the first time; a layered joint is marked.
   subroutine keep(self, i, line, slot)
      class(journal_type), intent(inout) :: self
      integer, intent(in) :: i
      type(segment), intent(in) :: line
      type(rule_slot), intent(inout) :: slot

      if (self%is_kept(i)) return
      self%is_kept(i) = .true.
      self%changed = self%changed + 1
      self%spring(self%changed) = i
      self%line(self%changed) = line
      call save_rule(slot, self%slot(i))
   end subroutine keep

   !> Give spring i the rule back that it had at the start.
   subroutine give_back(self, i, slot)
      class(journal_type), intent(inout) :: self
      integer, intent(in) :: i
      type(rule_slot), intent(inout) :: slot

      self%is_kept(i) = .false.
      call return_rule(slot, self%slot(i))
   end subroutine give_back

   !> Save a rule with its memory; a layered joint marks itself.
   subroutine save_rule(slot, kept)
      type(rule_slot), intent(inout) :: slot
      !> Where it is saved; what is there from earlier is of the same spring
      type(rule_slot), intent(inout) :: kept
      logical :: done

      select type (rule => slot%rule)
      type is (layered_rule)
         call rule%mark()
      class default
         done = .false.
         if (allocated(kept%rule)) call kept%rule%copy_memory(rule, done)
         if (.not. done) kept = slot
      end select
   end subroutine save_rule

   !> Give a spring the rule back that was saved.
   subroutine return_rule(slot, kept)
      type(rule_slot), intent(inout) :: slot
      type(rule_slot), intent(in) :: kept
      logical :: done

      select type (rule => slot%rule)
      type is (layered_rule)
         call rule%restore()
      class default
         call rule%copy_memory(kept%rule, done)
         if (.not. done) slot = kept
      end select
   end subroutine return_rule

   !> Discard what has been saved, and stop saving.
   subroutine forget(self)
      class(journal_type), intent(inout) :: self

      integer :: j

      ! As an assignment to elements of a list it would allocate a copy of the list.
      do j = 1, self%changed
         self%is_kept(self%spring(j)) = .false.
      end do
      self%changed = 0
      self%open = .false.
   end subroutine forget

end module rbs_hysteresis_journal
