!> The lines on which the layers of a joint go on along a straight path in rotation and axial load.
module rbs_hysteresis_layer_choice
   use rbs_base_constants, only: no_stiffness, unbounded
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_layer_kernels, only: look_along, look_back
   use rbs_hysteresis_layer_lines, only: layer_lines, no_rate
   implicit none
   private

   public :: choosing_layers

   !> Passes in which all layers without room change their lines at once, before both ways of each are
   !> weighed.
   integer, parameter :: most_passes = 4
   !> Lines without length that one layer may pass at one point.
   integer, parameter :: most_lines = 8

   !> A way beyond this, in units of the rates, is none; a rate below the other is none.
   real(wp), parameter, public :: beyond = 1.0e100_wp
   real(wp), parameter :: least_speed = 1.0e-150_wp

   !> Layers that find their lines.
   type, extends(layer_lines) :: choosing_layers
   contains
      procedure :: choose
      procedure :: least_rate
   end type choosing_layers

contains

   !> Put every layer on the line on which it goes on along a straight path from where the joint stands, and
   !> find how far the path goes on these lines.
   subroutine choose(self, turn, press)
      class(choosing_layers), intent(inout) :: self
      !> Rates of the rotation [rad] and of the axial load [N]
      real(wp), intent(in) :: turn, press
      real(wp) :: least_room
      integer :: pass

      self%failed = .false.
      self%turn = turn
      self%press = press
      ! Mostly one layer has come to its end, and all others have room.
      if (self%on_end > 0) call leave_end(self)
      do pass = 1, most_passes
         if (.not. self%a > no_stiffness*self%stiffness) exit
         self%open = -(self%s*turn + press)/self%a
         call look_ahead(self, least_room)
         if (least_room > 0.0_wp) then
            call set_ends(self)
            return
         end if
         call leave_all(self)
      end do
      call weigh_both_ways(self)
      if (self%failed) return
      call look_ahead(self, least_room)
      call set_ends(self)
   end subroutine choose

   !> The layer that has come to its end leaves its line, if it goes on in that direction.
   subroutine leave_end(self)
      type(choosing_layers), intent(inout) :: self
      real(wp) :: v
      integer :: i, way

      if (.not. self%a > no_stiffness*self%stiffness) return
      i = self%on_end
      self%open = -(self%s*self%turn + self%press)/self%a
      v = self%open + self%y(i)*self%turn
      if (.not. abs(v) > self%least_rate(self%open, self%turn)) return
      way = merge(1, -1, v > 0.0_wp)
      associate (line => self%line(i), d => self%deformation(i))
         if (abs(line%end_toward(way) - d) > abs(line%end_toward(-way) - d)) return
      end associate
      call self%leave(i, way)
      call self%sum_up()
   end subroutine leave_end

   !> All layers without room leave their lines.
   subroutine leave_all(self)
      type(choosing_layers), intent(inout) :: self
      real(wp) :: v, least, room
      integer :: i

      least = self%least_rate(self%open, self%turn)
      room = self%room_in_digits()
      do i = 1, self%count
         v = self%open + self%y(i)*self%turn
         if (abs(v) <= least) cycle
         if (self%one_way(i)*v < 0.0_wp .or. self%ahead(i)*abs(v) <= room + self%slack(i)) then
            call self%leave(i, merge(1, -1, v > 0.0_wp))
         end if
      end do
      call self%sum_up()
   end subroutine leave_all

   !> Rates of layers that are round-off, as the opening and the rotation move.
   pure real(wp) function least_rate(self, open, turn)
      class(choosing_layers), intent(in) :: self
      real(wp), intent(in) :: open, turn

      least_rate = max(no_rate*(abs(open) + self%reach*abs(turn)), least_speed)
   end function least_rate

   !> Ways of all layers to the ends of their lines.
   pure subroutine look_ahead(self, least_room)
      type(choosing_layers), intent(inout) :: self
      !> Not above zero if a layer has none
      real(wp), intent(out) :: least_room

      associate (ends => self%ends)
         call look_along(self%count, self%y, self%k, self%lo, self%hi, self%slack, self%one_way, &
                         self%both_ways, self%opening, self%rotation, self%open, self%turn, &
                         self%least_rate(self%open, self%turn), self%room_in_digits(), self%ahead, &
                         ends%ahead, least_room, ends%one_way, ends%stiffness)
      end associate
   end subroutine look_ahead

   !> How far the chosen path goes, ahead and back, until a layer reaches the end of its line.
   pure subroutine set_ends(self)
      type(choosing_layers), intent(inout) :: self
      integer :: i

      associate (ends => self%ends)
         ends%first_ahead = 0
         ends%first_behind = 0
         ends%behind = 0.0_wp
         if (ends%ahead < beyond) then
            do i = 1, self%count
               if (self%ahead(i) <= ends%ahead) exit
            end do
            ends%first_ahead = i
            ends%ahead = max(ends%ahead, 0.0_wp)
         else
            ends%ahead = unbounded
         end if
         if (ends%one_way) return
         call look_back(self%count, self%y, self%lo, self%hi, self%opening, self%rotation, self%open, &
                        self%turn, self%least_rate(self%open, self%turn), self%behind, ends%behind)
         if (ends%behind < beyond) then
            do i = 1, self%count
               if (self%behind(i) <= ends%behind) exit
            end do
            ends%first_behind = i
            ends%behind = max(ends%behind, 0.0_wp)
         else
            ends%behind = unbounded
         end if
      end associate
   end subroutine set_ends

   !> The lines that lead on, where changing those without room does not end, or where layers soften or have
   !> no stiffness. The rate x of the opening is a root of the continuous, piecewise linear
   !>
   !>     G(x) = sum k_i(v_i) v_i = -dN,        v_i = x + y_i dphi
   !>
   !> with the slopes of the lines on which each layer would go on opening and closing. Without softening G
   !> rises and the root is unique; of several the one nearest to the present rate is taken; none means that
   !> the layers cannot carry the axial load.
   subroutine weigh_both_ways(self)
      type(choosing_layers), intent(inout) :: self
      real(wp), dimension(self%count) :: opening, closing, corner
      real(wp) :: x, best, wanted, at, next_at, slope, value, free, rate
      integer :: order(self%count)
      integer :: i, j, m, way, lines
      logical :: found

      m = 0
      do i = 1, self%count
         opening(i) = slope_ahead(self, i, 1)
         closing(i) = slope_ahead(self, i, -1)
         if (abs(opening(i) - closing(i)) > 0.0_wp) then
            m = m + 1
            order(m) = i
         end if
         corner(i) = -self%y(i)*self%turn
      end do
      call order_by(corner, order(:m))
      wanted = -self%press
      ! Layers without stiffness open as those do that have a little hardening.
      free = -self%centre*self%turn
      found = .false.
      best = 0.0_wp
      do j = 0, m
         ! Between the corners j and j + 1; the lines before the first and behind the last have no end.
         at = free
         if (m > 0) at = corner(order(max(j, 1)))
         slope = slope_between(j)
         value = value_at(at)
         if (slope > no_stiffness*self%stiffness) then
            x = at + (wanted - value)/slope
         else if (abs(slope) <= no_stiffness*self%stiffness .and. abs(value - wanted) <= &
                  no_stiffness*(abs(wanted) + self%stiffness*self%reach*abs(self%turn))) then
            x = free
            if (j > 0) x = max(x, at)
            if (j < m) x = min(x, corner(order(j + 1)))
         else
            cycle
         end if
         if (j > 0) then
            if (x < at - 1.0e-14_wp*abs(at)) cycle
         end if
         if (j < m) then
            next_at = corner(order(j + 1))
            if (x > next_at + 1.0e-14_wp*abs(next_at)) cycle
         end if
         if (found .and. abs(x - self%open) >= abs(best - self%open)) cycle
         found = .true.
         best = x
      end do
      if (.not. found) then
         self%failed = .true.
         self%failure_way = merge(-1, 1, value_at(free) > wanted)
         return
      end if
      self%open = best
      do i = 1, self%count
         rate = best + self%y(i)*self%turn
         if (abs(rate) <= self%least_rate(best, self%turn)) cycle
         way = merge(1, -1, rate > 0.0_wp)
         do lines = 1, most_lines
            if (.not. (self%line(i)%one_way == -way .or. self%has_no_room(i, way))) exit
            call self%leave(i, way)
         end do
      end do
      call self%sum_up()

   contains

      !> Slope of G between the corners j and j + 1.
      real(wp) function slope_between(j) result(total)
         integer, intent(in) :: j
         integer :: p

         total = 0.0_wp
         do p = 1, self%count
            if (.not. abs(opening(p) - closing(p)) > 0.0_wp) total = total + opening(p)
         end do
         do p = 1, m
            total = total + merge(opening(order(p)), closing(order(p)), p <= j)
         end do
      end function slope_between

      real(wp) function value_at(x) result(total)
         real(wp), intent(in) :: x
         real(wp) :: v
         integer :: p

         total = 0.0_wp
         do p = 1, self%count
            v = x + self%y(p)*self%turn
            total = total + merge(opening(p), closing(p), v > 0.0_wp)*v
         end do
      end function value_at

   end subroutine weigh_both_ways

   !> Slope of the line on which a layer would go on in a direction. It goes there and back again.
   real(wp) function slope_ahead(self, i, way) result(k)
      type(choosing_layers), intent(inout) :: self
      integer, intent(in) :: i, way
      integer :: lines, on_end

      k = self%k(i)
      if (.not. (self%line(i)%one_way == -way .or. self%has_no_room(i, way))) return
      on_end = self%on_end
      call self%remember(i)
      do lines = 1, most_lines
         if (.not. (self%line(i)%one_way == -way .or. self%has_no_room(i, way))) exit
         call self%leave(i, way)
      end do
      k = self%k(i)
      call self%go_back(i)
      self%on_end = on_end
   end function slope_ahead

   !> Sort indices by values, by insertion: there are few.
   pure subroutine order_by(value, order)
      real(wp), intent(in) :: value(:)
      integer, intent(inout) :: order(:)
      integer :: i, j, item

      do i = 2, size(order)
         item = order(i)
         do j = i - 1, 1, -1
            if (value(order(j)) <= value(item)) exit
            order(j + 1) = order(j)
         end do
         order(j + 1) = item
      end do
   end subroutine order_by

end module rbs_hysteresis_layer_choice
