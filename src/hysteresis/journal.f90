!> Saved states of springs from before they changed their branches, so that a trial can be undone.
module rbs_hysteresis_journal
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_layered_fibre_section, only: fibre_section
   use rbs_hysteresis_rule, only: spring_slot
   use rbs_hysteresis_segment, only: segment
   implicit none
   private

   public :: journal_type, save_memory, return_memory

   type :: journal_type
      !> Whether changes are being saved
      logical :: open = .false.
      !> Deformations with the coordinates behind them, and works (count) at the start [m or rad, J]
      real(wp), allocatable :: d(:), work(:)
      !> Number of branches left at the start; number of springs that have changed their branches since, and
      !> which (changed)
      integer :: events = 0, changed = 0
      integer, allocatable :: spring(:)
      !> Whether each spring is among them (count)
      logical, allocatable :: is_kept(:)
      !> The branches that they had (changed)
      type(segment), allocatable :: line(:)
      !> How those that are kept have changed since, in one move: the direction, 0 if there were several
      !> moves or directions; the deformation beyond which they pass through the same branches again; how
      !> many; deformation and work where they entered the last one (count)
      integer, allocatable :: direction(:), branches(:)
      real(wp), allocatable :: beyond(:), d_entered(:), work_entered(:)
   contains
      procedure :: start, keep, leave_branch, enter_branch, passes_again, give_back, forget
   end type journal_type

contains

   !> Start to save changes.
   subroutine start(self, d, work, events)
      class(journal_type), intent(inout) :: self
      !> Present deformations and works (count)
      real(wp), intent(in), contiguous :: d(:), work(:)
      !> Number of branches left so far
      integer, intent(in) :: events
      integer :: i, n

      n = size(work)
      if (.not. allocated(self%is_kept)) then
         allocate (self%is_kept(n), source=.false.)
         allocate (self%spring(n), self%line(n), self%d(size(d)), self%work(n))
         allocate (self%direction(n), self%branches(n), self%beyond(n), self%d_entered(n), &
                   self%work_entered(n))
      end if
      if (self%changed > 0) call self%forget()
      self%open = .true.
      do i = 1, size(d)
         self%d(i) = d(i)
      end do
      do i = 1, n
         self%work(i) = work(i)
      end do
      self%events = events
   end subroutine start

   !> Save a spring before it changes its branch for the first time; a layered joint is marked.
   subroutine keep(self, i, line, slot)
      class(journal_type), intent(inout) :: self
      integer, intent(in) :: i
      !> Present branch of spring i; in its slot the memory is copied
      type(segment), intent(in) :: line
      type(spring_slot), intent(inout) :: slot

      if (self%is_kept(i)) return
      self%is_kept(i) = .true.
      self%changed = self%changed + 1
      self%spring(self%changed) = i
      self%line(self%changed) = line
      self%direction(i) = 0
      self%branches(i) = 0
      call save_memory(slot)
   end subroutine keep

   !> Spring i leaves a branch by its end in a direction, +1 or -1.
   pure subroutine leave_branch(self, i, direction, last)
      class(journal_type), intent(inout) :: self
      integer, intent(in) :: i, direction
      !> The last deformation of the branch in that direction
      real(wp), intent(in) :: last

      if (self%branches(i) == 0) then
         self%direction(i) = direction
         self%beyond(i) = last
      else if (self%direction(i) /= direction) then
         ! The spring has turned: it cannot pass through the same branches in one move.
         self%direction(i) = 0
      else
         self%beyond(i) = direction*max(direction*self%beyond(i), direction*last)
      end if
      self%branches(i) = self%branches(i) + 1
   end subroutine leave_branch

   !> Spring i, which has left a branch, has entered the next one.
   pure subroutine enter_branch(self, i, d, work)
      class(journal_type), intent(inout) :: self
      integer, intent(in) :: i
      !> Deformation [m or rad] and work [J] there
      real(wp), intent(in) :: d, work

      self%d_entered(i) = d
      self%work_entered(i) = work
   end subroutine enter_branch

   !> Whether spring i on its way from the mark to a deformation d passes through the same branches as before
   !> and enters its present one. With a direction of 0 (it had turned) the answer is no.
   pure logical function passes_again(self, i, d)
      class(journal_type), intent(in) :: self
      integer, intent(in) :: i
      real(wp), intent(in) :: d

      passes_again = self%direction(i)*(d - self%beyond(i)) > 0.0_wp
   end function passes_again

   !> Give spring i the memory back that it had at the start.
   subroutine give_back(self, i, slot)
      class(journal_type), intent(inout) :: self
      integer, intent(in) :: i
      type(spring_slot), intent(inout) :: slot

      self%is_kept(i) = .false.
      call return_memory(slot)
   end subroutine give_back

   !> Save a memory, without an allocation where there is a copy from earlier. A layered joint marks itself:
   !> of its many layers few change.
   subroutine save_memory(slot)
      type(spring_slot), intent(inout) :: slot

      if (allocated(slot%kept)) then
         call slot%kept%copy(slot%memory)
         return
      end if
      select type (memory => slot%memory)
      type is (fibre_section)
         call memory%mark()
      class default
         allocate (slot%kept, source=memory)
      end select
   end subroutine save_memory

   !> Give a spring the memory back that was saved: the copy, or for a layered joint the state it has marked.
   subroutine return_memory(slot)
      type(spring_slot), intent(inout) :: slot

      if (allocated(slot%kept)) then
         call slot%memory%copy(slot%kept)
         return
      end if
      select type (memory => slot%memory)
      type is (fibre_section)
         call memory%restore()
      end select
   end subroutine return_memory

   !> Discard the saved memories, and stop saving.
   subroutine forget(self)
      class(journal_type), intent(inout) :: self

      integer :: j

      ! An assignment to all of these elements at once would allocate a copy of their list.
      do j = 1, self%changed
         self%is_kept(self%spring(j)) = .false.
      end do
      self%changed = 0
      self%open = .false.
   end subroutine forget

end module rbs_hysteresis_journal
