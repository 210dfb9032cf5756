!> Order of the nodes of a frame, so that those that are coupled are near each other.
module rbs_structure_frame_numbering
   implicit none
   private

   public :: order_nodes

contains

   !> Reverse order of Cuthill and McKee: level behind level from a node at the end of a longest way, each
   !> level in the order of its neighbours before (A. George and J. Liu, Computer Solution of Large Sparse
   !> Positive Definite Systems, 1981).
   pure subroutine order_nodes(nodes, pair, order)
      integer, intent(in) :: nodes
      !> Nodes that are coupled (2, pairs)
      integer, intent(in) :: pair(:, :)
      !> The nodes one after the other (nodes)
      integer, intent(out) :: order(nodes)
      integer :: degree(nodes), numbered, i, first, last
      logical :: is_numbered(nodes)

      do i = 1, nodes
         degree(i) = count(pair == i)
      end do
      is_numbered = .false.
      numbered = 0
      do while (numbered < nodes)
         first = minloc(degree, dim=1, mask=.not. is_numbered)
         ! Twice to the far end of the part.
         do i = 1, 2
            last = numbered
            call visit(nodes, pair, degree, is_numbered, first, order, last)
            first = order(last)
         end do
         call visit(nodes, pair, degree, is_numbered, first, order, numbered)
         is_numbered(order(:numbered)) = .true.
      end do
      order = order(nodes:1:-1)
   end subroutine order_nodes

   !> Add a node and all that it is connected with, the nearest first and of these those with few neighbours.
   pure subroutine visit(nodes, pair, degree, is_numbered, first, order, last)
      integer, intent(in) :: nodes, pair(:, :), degree(nodes), first
      logical, intent(in) :: is_numbered(nodes)
      integer, intent(inout) :: order(nodes), last
      logical :: is_seen(nodes), is_next(nodes)
      integer :: at, i

      is_seen = is_numbered
      at = last + 1
      last = at
      order(at) = first
      is_seen(first) = .true.
      do while (at <= last)
         is_next = .false.
         do i = 1, size(pair, 2)
            if (pair(1, i) == order(at)) is_next(pair(2, i)) = .true.
            if (pair(2, i) == order(at)) is_next(pair(1, i)) = .true.
         end do
         is_next = is_next .and. .not. is_seen
         do while (any(is_next))
            i = minloc(degree, dim=1, mask=is_next)
            last = last + 1
            order(last) = i
            is_seen(i) = .true.
            is_next(i) = .false.
         end do
         at = at + 1
      end do
   end subroutine visit

end module rbs_structure_frame_numbering
