!> Saved states of springs from before they changed their branches, so that a trial can be undone.
module rbs_hysteresis_journal
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_layered_fibre_section, only: fibre_section
   use rbs_hysteresis_rule, only: spring_slot
   use rbs_hysteresis_segment, only: segment
   implicit none
   private

   public :: journal_type, save_memory, return_memory

   !> Springs in a row that are counted together.
   integer, parameter, public :: block_length = 16

   type :: journal_type
      !> Whether changes are being saved, and whether all springs are, else only those that have changed their
      !> branches
      logical :: open = .false., whole = .false.
      !> Deformations with the coordinates behind them, and works (count) at the start, of the springs that
      !> are saved [m or rad, J]
      real(wp), allocatable :: d(:), work(:)
      !> Number of branches left at the start; number of springs that have changed their branches since, and
      !> which (changed)
      integer :: events = 0, changed = 0
      integer, allocatable :: spring(:)
      !> Whether each spring is among them (count), and how many of each block are (blocks)
      logical, allocatable :: is_kept(:)
      integer, allocatable :: in_block(:)
      !> The branches that they had (changed)
      type(segment), allocatable :: line(:)
      !> How those that are kept have changed since, in one move: the direction, 0 if there were several
      !> moves or directions; the deformation beyond which they pass through the same branches again; how
      !> many; deformation and work where they entered the last one (count)
      integer, allocatable :: direction(:), branches(:)
      real(wp), allocatable :: beyond(:), d_entered(:), work_entered(:)
   contains
      procedure :: start, save_all, keep, leave_branch, enter_branch, passes_again, give_back, forget
   end type journal_type

contains

   !> Start to save the springs that change their branches.
   subroutine start(self, coordinates, springs, events)
      class(journal_type), intent(inout) :: self
      !> Numbers of coordinates and of springs, and of branches left so far
      integer, intent(in) :: coordinates, springs, events

      if (.not. allocated(self%is_kept)) then
         allocate (self%is_kept(springs), source=.false.)
         allocate (self%in_block((springs - 1)/block_length + 1), source=0)
         allocate (self%spring(springs), self%line(springs), self%d(coordinates), self%work(springs))
         allocate (self%direction(springs), self%branches(springs), self%beyond(springs), &
                   self%d_entered(springs), self%work_entered(springs))
      end if
      if (self%changed > 0) call self%forget()
      self%open = .true.
      self%whole = .false.
      self%events = events
   end subroutine start

   !> Save the deformations and works of the springs that have not been saved, as all are about to move.
   subroutine save_all(self, d, work)
      class(journal_type), intent(inout) :: self
      !> Present deformations with the coordinates behind them, and works (count)
      real(wp), intent(in), contiguous :: d(:), work(:)
      !> Deformations and works that have been saved already, in the order of the changes
      real(wp) :: saved(2, self%changed)
      integer :: i, j

      do j = 1, self%changed
         saved(:, j) = [self%d(self%spring(j)), self%work(self%spring(j))]
      end do
      self%d(:) = d
      self%work(:) = work
      do j = 1, self%changed
         i = self%spring(j)
         self%d(i) = saved(1, j)
         self%work(i) = saved(2, j)
      end do
      self%whole = .true.
   end subroutine save_all

   !> Save a spring before it changes its branch for the first time; a layered joint is marked.
   subroutine keep(self, i, d, work, line, slot)
      class(journal_type), intent(inout) :: self
      integer, intent(in) :: i
      !> Deformation [m or rad] and work [J] of spring i
      real(wp), intent(in) :: d, work
      !> Its present branch; in its slot the memory is copied
      type(segment), intent(in) :: line
      type(spring_slot), intent(inout) :: slot

      if (self%is_kept(i)) return
      call count_in(self, i, 1)
      self%changed = self%changed + 1
      self%spring(self%changed) = i
      self%line(self%changed) = line
      if (.not. self%whole) then
         self%d(i) = d
         self%work(i) = work
      end if
      self%direction(i) = 0
      self%branches(i) = 0
      call save_memory(slot)
   end subroutine keep

   !> Count spring i among those that are kept, or no more.
   pure subroutine count_in(self, i, change)
      type(journal_type), intent(inout) :: self
      integer, intent(in) :: i
      !> +1 or -1
      integer, intent(in) :: change

      self%is_kept(i) = change > 0
      associate (number => self%in_block((i - 1)/block_length + 1))
         number = number + change
      end associate
   end subroutine count_in

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

      call count_in(self, i, -1)
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

      do j = 1, self%changed
         call count_in(self, self%spring(j), -1)
      end do
      self%changed = 0
      self%open = .false.
   end subroutine forget

end module rbs_hysteresis_journal
