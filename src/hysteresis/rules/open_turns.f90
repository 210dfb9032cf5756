!> The memory of a rule that reloads: the points where reloading turned back and whose inner loops are still
!> open, oldest first.
module rbs_hysteresis_rules_open_turns
   use, intrinsic :: iso_fortran_env, only: int64
   use rbs_base_constants, only: unbounded
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_base_tolerances, only: parallel
   implicit none
   private

   public :: point, turn, open_turns

   !> Most turns that are remembered; beyond that the older half is forgotten, so that memory is bounded in a
   !> vibration whose amplitude decreases for ever.
   integer, parameter :: most_turns = 4096

   !> How far the start of a line moves inward over the way of the other side, while its turn fades. With the
   !> start the line becomes flatter, until it is the one that reloading follows without the turn.
   real(wp), parameter :: rate = 2.0_wp

   !> A point of the diagram.
   type :: point
      !> Deformation [m or rad] and force [N or N m]
      real(wp) :: d = 0.0_wp, f = 0.0_wp
   contains
      procedure :: serialize => serialize_point
   end type point

   !> A line of reloading, and the point where it turned back.
   type :: turn
      type(point) :: at
      !> Side, +1 or -1, and number of the turn, ascending; 64 bits do not run out
      integer :: side = 0
      integer(int64) :: number = 0_int64
      !> Deformation at which the line started from zero force [m or rad]
      real(wp) :: start = 0.0_wp
      !> The point that it leads to, the number of that turn (0: it is on the backbone), and its slope
      type(point) :: goal
      integer(int64) :: goal_number = 0_int64
      real(wp) :: k = 0.0_wp
      !> Deformation of the other side, as seen from there, behind which this turn fades [m or rad]
      real(wp) :: fades_from = unbounded
   contains
      procedure :: shift, serialize => serialize_turn
   end type turn

   type :: open_turns
      !> Number of turns
      integer :: count = 0
      type(turn), allocatable :: list(:)
   contains
      procedure :: push, newest_of_side, place_of, forget_inside, let_fade, fade, move_with_peak, copy
      procedure :: serialize => serialize_turns
   end type open_turns

contains

   !> Where the line to a turn would be steeper than the virgin one, reloading follows the virgin slope to the
   !> line that was left there.
   pure subroutine shift(last, start, steepest, found)
      class(turn), intent(inout) :: last
      !> Where reloading starts [m or rad] and the virgin slope [N/m or N m/rad]
      real(wp), intent(in) :: start, steepest
      !> Whether the turn can be reached: the line to it is not too steep, or the line that was left there is
      !> met before its goal, and the turn is moved to that point
      logical, intent(out) :: found
      real(wp) :: k, shortfall

      shortfall = last%at%f - steepest*(1.0_wp + parallel)*(last%at%d - start)
      found = .not. shortfall > 0.0_wp
      if (found .or. last%goal%d <= last%at%d) return
      k = (last%goal%f - last%at%f)/(last%goal%d - last%at%d)
      shortfall = last%at%f - steepest*(last%at%d - start)
      if (shortfall >= (steepest - k)*(last%goal%d - last%at%d)) return
      found = .true.
      last%at%d = last%at%d + shortfall/(steepest - k)
      last%at%f = steepest*(last%at%d - start)
   end subroutine shift

   !> Remember a turn as the newest.
   subroutine push(self, new)
      class(open_turns), intent(inout) :: self
      type(turn), intent(in) :: new
      type(turn), allocatable :: longer(:)
      integer :: i, dropped

      if (.not. allocated(self%list)) allocate (self%list(4))
      if (self%count == most_turns) then
         dropped = most_turns/2
         do i = 1, self%count - dropped
            self%list(i) = self%list(i + dropped)
         end do
         self%count = self%count - dropped
      else if (self%count == size(self%list)) then
         allocate (longer(2*self%count))
         longer(:self%count) = self%list
         call move_alloc(longer, self%list)
      end if
      self%count = self%count + 1
      self%list(self%count) = new
   end subroutine push

   !> Place in the list of the newest turn on a side, 0 if there is none.
   pure integer function newest_of_side(self, side) result(place)
      class(open_turns), intent(in) :: self
      !> +1 or -1
      integer, intent(in) :: side

      do place = self%count, 1, -1
         if (self%list(place)%side == side) return
      end do
      place = 0
   end function newest_of_side

   !> Place of the turn with a number, 0 if it has been forgotten.
   pure integer function place_of(self, number) result(place)
      class(open_turns), intent(in) :: self
      integer(int64), intent(in) :: number

      do place = self%count, 1, -1
         if (self%list(place)%number == number) return
      end do
      place = 0
   end function place_of

   !> Forget the newest turns as long as their lines start at a deformation or beyond it, as seen from their
   !> side: their loops lie inside the one that begins there.
   pure subroutine forget_inside(self, start)
      class(open_turns), intent(inout) :: self
      real(wp), intent(in) :: start

      do while (self%count > 0)
         if (self%list(self%count)%start < start) exit
         self%count = self%count - 1
      end do
   end subroutine forget_inside

   !> A loop that began on the other side with a turn is closed there: the turns since then lie inside it, and
   !> fade as the motion goes on beyond (`fade`).
   pure subroutine let_fade(self, number, from)
      class(open_turns), intent(inout) :: self
      !> Number of the turn with which the loop began
      integer(int64), intent(in) :: number
      !> Where it is closed, as seen from the other side
      real(wp), intent(in) :: from
      integer :: i

      do i = self%count, 1, -1
         if (self%list(i)%number < number) exit
         self%list(i)%fades_from = min(self%list(i)%fades_from, from)
      end do
   end subroutine let_fade

   !> The motion has turned on the other side: the starts of lines whose turns fade move inward, toward their
   !> own side, by `rate` times the way beyond the deformation from which they fade.
   pure subroutine fade(self, d)
      class(open_turns), intent(inout) :: self
      !> As seen from the other side
      real(wp), intent(in) :: d
      integer :: i

      do i = 1, self%count
         if (d <= self%list(i)%fades_from) cycle
         self%list(i)%start = self%list(i)%start + rate*(d - self%list(i)%fades_from)
         self%list(i)%fades_from = d
      end do
   end subroutine fade

   !> The peak of the side has moved outward: each turn moves by its share of the way to it.
   pure subroutine move_with_peak(self, from, to)
      class(open_turns), intent(inout) :: self
      !> Deformation of the peak before and now
      real(wp), intent(in) :: from, to
      integer :: i

      if (.not. to > from) return
      do i = 1, self%count
         associate (d => self%list(i)%at%d, start => self%list(i)%start)
            if (d >= from) then
               d = d + (to - from)
            else if (d > start) then
               d = d + (to - from)*((d - start)/(from - start))
            end if
         end associate
      end do
   end subroutine move_with_peak

   !> Copy the turns of another list, without an allocation where there is room.
   pure subroutine copy(self, other, they_stay)
      class(open_turns), intent(inout) :: self
      type(open_turns), intent(in) :: other
      !> Whether turns do not change once they are there: where both lists have the same one, those below it
      !> are the same too
      logical, intent(in) :: they_stay
      integer :: i, known

      known = merge(min(self%count, other%count), 0, they_stay)
      call make_room(self, other%count)
      do i = other%count, 1, -1
         if (i <= known) then
            if (same_turn(self%list(i), other%list(i))) exit
         end if
         self%list(i) = other%list(i)
      end do
   end subroutine copy

   !> Whether two turns have the same number, side and point.
   pure logical function same_turn(one, other)
      type(turn), intent(in) :: one, other

      same_turn = one%number == other%number .and. one%side == other%side .and. &
                  .not. (abs(one%at%d - other%at%d) > 0.0_wp .or. abs(one%at%f - other%at%f) > 0.0_wp)
   end function same_turn

   !> Set the number of turns and make room for them. The turns that are there are kept only where the room
   !> need not grow.
   pure subroutine make_room(self, count)
      type(open_turns), intent(inout) :: self
      integer, intent(in) :: count

      self%count = count
      if (count == 0) return
      if (allocated(self%list)) then
         if (size(self%list) >= count) return
         deallocate (self%list)
      end if
      allocate (self%list(count))
   end subroutine make_room

   !> Save or restore a point.
   pure subroutine serialize_point(self, stream)
      class(point), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%items(self%d, self%f)
   end subroutine serialize_point

   !> Save or restore a turn.
   pure subroutine serialize_turn(self, stream)
      class(turn), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call self%at%serialize(stream)
      call stream%item(self%side)
      call stream%item(self%number)
      call self%goal%serialize(stream)
      call stream%item(self%goal_number)
      call stream%items(self%start, self%k, self%fades_from)
   end subroutine serialize_turn

   !> Save or restore the turns; they come back into the room that is there if it is enough.
   pure subroutine serialize_turns(self, stream)
      class(open_turns), intent(inout) :: self
      type(stream_type), intent(inout) :: stream
      integer :: i, count

      count = self%count
      call stream%item_count(count, most_turns)
      if (stream%restoring) call make_room(self, count)
      do i = 1, count
         call self%list(i)%serialize(stream)
      end do
   end subroutine serialize_turns

end module rbs_hysteresis_rules_open_turns
