!> The lines on which the layers of a joint go on along a straight path in rotation and axial load.
module rbs_hysteresis_layer_choice
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_layer_lines, only: layer_lines, rate_of, on_the_end, no_rate
   implicit none
   private

   public :: choosing_layers

   !> Passes in which all layers without room change their lines at once, before both ways of each are
   !> weighed.
   integer, parameter :: most_passes = 4
   !> Lines without length that one layer may pass at one point.
   integer, parameter :: most_lines = 8
   !> Below this share of the initial axial stiffness the layers count as having none.
   real(wp), parameter, public :: no_stiffness = 1.0e-12_wp

   !> Layers that find their lines.
   type, extends(layer_lines) :: choosing_layers
   contains
      procedure :: choose
   end type choosing_layers

contains

   !> Put every layer on the line on which it goes on along a straight path from where the joint stands.
   subroutine choose(self, turn, press)
      class(choosing_layers), intent(inout) :: self
      !> Rates of the rotation [rad] and of the axial load [N]
      real(wp), intent(in) :: turn, press
      real(wp) :: v, least_rate, least_room
      integer :: i, pass, way
      logical :: changed

      self%failed = .false.
      self%turn = turn
      self%press = press
      least_room = self%room_in_digits()
      do pass = 1, most_passes
         call self%sum_up()
         if (.not. self%a > no_stiffness*self%stiffness) exit
         self%open = -(self%s*turn + press)/self%a
         changed = .false.
         least_rate = no_rate*(abs(self%open) + self%reach*abs(turn))
         do i = 1, self%count
            v = self%open + self%y(i)*turn
            way = 0
            associate (line => self%line(i), d => self%d(i))
               if (v > least_rate) then
                  if (line%one_way < 0 .or. line%hi - d <= least_room + on_the_end*abs(line%hi)) way = 1
               else if (v < -least_rate) then
                  if (line%one_way > 0 .or. d - line%lo <= least_room + on_the_end*abs(line%lo)) way = -1
               end if
            end associate
            if (way == 0) cycle
            call self%leave(i, way)
            changed = .true.
         end do
         if (.not. changed) return
      end do
      call weigh_both_ways(self)
   end subroutine choose

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
      real(wp) :: x, best, wanted, at, next_at, slope, value, free
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
         associate (v => rate_of(self%y(i), self%turn, best, self%reach))
            if (.not. abs(v) > 0.0_wp) cycle
            way = merge(1, -1, v > 0.0_wp)
            do lines = 1, most_lines
               if (.not. (self%line(i)%one_way == -way .or. self%has_no_room(i, way))) exit
               call self%leave(i, way)
            end do
         end associate
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

   !> Slope of the line on which a layer would go on in a direction. A copy of its rule is asked.
   real(wp) function slope_ahead(self, i, way) result(k)
      type(choosing_layers), intent(in) :: self
      integer, intent(in) :: i, way
      type(choosing_layers) :: copy
      integer :: lines

      k = self%line(i)%k
      if (.not. (self%line(i)%one_way == -way .or. self%has_no_room(i, way))) return
      copy%count = 1
      copy%y = [self%y(i)]
      allocate (copy%slot(1), copy%line(1), copy%d(1))
      allocate (copy%slot(1)%rule, source=self%slot(i)%rule)
      copy%line(1) = self%line(i)
      copy%d(1) = self%d(i)
      copy%opening = self%opening
      copy%rotation = self%rotation
      copy%reach = self%reach
      copy%largest = self%largest
      do lines = 1, most_lines
         if (.not. (copy%line(1)%one_way == -way .or. copy%has_no_room(1, way))) exit
         call copy%leave(1, way)
      end do
      k = copy%line(1)%k
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
