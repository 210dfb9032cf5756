!> Order of the nodes of a frame, so that those that are coupled are near each other.
module rbs_structure_frame_numbering
   use rbs_base_kinds, only: wp
   implicit none
   private

   public :: order_nodes, order_downward

contains

   !> Reverse order of Cuthill and McKee: level behind level from a node at the end of a longest way, each
   !> level in the order of its neighbours before (A. George and J. Liu, Computer Solution of Large Sparse
   !> Positive Definite Systems, 1981).
   pure subroutine order_nodes(nodes, pair, order)
      !> Number of nodes
      integer, intent(in) :: nodes
      !> Nodes that are coupled (2, pairs)
      integer, intent(in) :: pair(:, :)
      !> The nodes one after the other (nodes)
      integer, intent(out) :: order(nodes)
      integer :: degree(nodes), start(nodes + 1), neighbour(2*size(pair, 2)), numbered, i, first, last
      logical :: is_numbered(nodes)

      call list_neighbours(nodes, pair, start, neighbour)
      degree = start(2:) - start(:nodes)
      is_numbered = .false.
      numbered = 0
      do while (numbered < nodes)
         first = minloc(degree, dim=1, mask=.not. is_numbered)
         ! Going twice to the far end of the part finds an end of a longest way.
         do i = 1, 2
            last = numbered
            call visit(nodes, start, neighbour, degree, is_numbered, first, order, last)
            first = order(last)
         end do
         call visit(nodes, start, neighbour, degree, is_numbered, first, order, numbered)
         is_numbered(order(:numbered)) = .true.
      end do
      order = order(nodes:1:-1)
   end subroutine order_nodes

   !> Order of the nodes floor by floor from the top down: rigid floors couple all nodes of a floor, and rows
   !> of the band are shorter so than from the base up.
   pure subroutine order_downward(nodes, y, order)
      !> Number of nodes
      integer, intent(in) :: nodes
      !> Heights (nodes)
      real(wp), intent(in) :: y(nodes)
      !> The nodes one after the other (nodes)
      integer, intent(out) :: order(nodes)
      logical :: is_numbered(nodes)
      integer :: i

      is_numbered = .false.
      do i = 1, nodes
         order(i) = maxloc(y, dim=1, mask=.not. is_numbered)
         is_numbered(order(i)) = .true.
      end do
   end subroutine order_downward

   !> The neighbours of each node: those of node i stand from start(i) to start(i + 1) - 1.
   pure subroutine list_neighbours(nodes, pair, start, neighbour)
      !> Number of nodes, and pairs of them that are coupled (2, pairs)
      integer, intent(in) :: nodes, pair(:, :)
      !> First place of each node in the list, and the list; start(nodes + 1) is its end plus one
      integer, intent(out) :: start(nodes + 1), neighbour(2*size(pair, 2))
      integer :: i, j

      ! Count the neighbours, sum them to the ends of the ranges, and fill these backward: `start` moves to
      ! the begin.
      start = 0
      do i = 1, size(pair, 2)
         do j = 1, 2
            start(pair(j, i)) = start(pair(j, i)) + 1
         end do
      end do
      start(1) = start(1) + 1
      do i = 1, nodes
         start(i + 1) = start(i + 1) + start(i)
      end do
      do i = 1, size(pair, 2)
         do j = 1, 2
            associate (at => start(pair(j, i)))
               at = at - 1
               neighbour(at) = pair(3 - j, i)
            end associate
         end do
      end do
   end subroutine list_neighbours

   !> Append a node and all that it is connected with to the order, the nearest first and of these those with
   !> few neighbours.
   pure subroutine visit(nodes, start, neighbour, degree, is_numbered, first, order, last)
      !> Number of nodes; neighbours as in `list_neighbours`, and their numbers; the node to begin with
      integer, intent(in) :: nodes, start(nodes + 1), neighbour(:), degree(nodes), first
      !> Nodes that are left out, as they are in the order already
      logical, intent(in) :: is_numbered(nodes)
      !> The order, filled up to `last`
      integer, intent(inout) :: order(nodes), last
      logical :: is_seen(nodes)
      integer :: at, begin, i, j

      is_seen = is_numbered
      at = last + 1
      last = at
      order(at) = first
      is_seen(first) = .true.
      do while (at <= last)
         begin = last + 1
         do i = start(order(at)), start(order(at) + 1) - 1
            associate (node => neighbour(i))
               if (is_seen(node)) cycle
               is_seen(node) = .true.
               last = last + 1
               ! Put it in its place among the neighbours of this node.
               j = last
               do while (j > begin)
                  if (.not. comes_before(node, order(j - 1))) exit
                  order(j) = order(j - 1)
                  j = j - 1
               end do
               order(j) = node
            end associate
         end do
         at = at + 1
      end do

   contains

      !> Whether a node has fewer neighbours than another one or, with as many, the lower number.
      pure logical function comes_before(node, other)
         integer, intent(in) :: node, other

         comes_before = degree(node) < degree(other) .or. (degree(node) == degree(other) .and. node < other)
      end function comes_before
   end subroutine visit

end module rbs_structure_frame_numbering
