!> Straight paths of a fibre section in rotation and axial load: the branches on which its layers continue,
!> and the way from event to event.
module rbs_hysteresis_layered_fibre_path
   use rbs_base_constants, only: no_stiffness, unbounded
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_layered_fibre_kernels, only: look_along, look_back
   use rbs_hysteresis_layered_fibre_section, only: fibre_section
   implicit none
   private

   public :: choose_branches, go

   !> Passes in which all layers without room change their branches at once, before both ways of each are
   !> weighed.
   integer, parameter :: most_passes = 4
   !> A way beyond this, in units of the rates, is none.
   real(wp), parameter :: beyond = 1.0e100_wp

contains

   !> Go straight to a rotation and an axial load, from event to event.
   subroutine go(self, rotation, axial_load, work)
      type(fibre_section), intent(inout) :: self
      real(wp), intent(in) :: rotation, axial_load
      !> Work of the moment along the way, to be added to [J]
      real(wp), intent(inout), optional :: work
      real(wp) :: begin(2), way(2), here, before(2)
      integer :: event
      logical :: arrives

      begin = [self%rotation, self%axial_load]
      way = [rotation + self%rest, axial_load] - begin
      if (.not. any(abs(way) > 0.0_wp)) return
      here = 0.0_wp
      do event = 1, 1000 + 1000*self%count
         call choose_branches(self, way(1), way(2))
         if (self%failed) return
         before = [self%rotation, self%moment]
         arrives = self%ends%ahead >= 1.0_wp - here
         if (arrives) then
            call self%place(rotation + self%rest, axial_load, 1.0_wp - here, 0)
         else
            associate (there => here + self%ends%ahead)
               call self%place(begin(1) + there*way(1), begin(2) + there*way(2), self%ends%ahead, &
                               self%ends%first_ahead)
            end associate
         end if
         if (present(work)) work = work + 0.5_wp*(before(2) + self%moment)*(self%rotation - before(1))
         if (arrives) return
         here = here + self%ends%ahead
      end do
      self%failed = .true.
   end subroutine go

   !> Put every layer on its branch along a straight path from the present point, and find
   !> the length of the path on these branches.
   subroutine choose_branches(self, turn, press)
      type(fibre_section), intent(inout) :: self
      !> Rates of the rotation [rad] and of the axial load [N]
      real(wp), intent(in) :: turn, press
      real(wp) :: least_room, least_rate, room, v
      integer :: pass, i

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
         ! All layers without room leave their branches.
         least_rate = self%least_rate(self%open, self%turn)
         room = self%room_in_digits()
         do i = 1, self%count
            v = self%open + self%y(i)*self%turn
            if (abs(v) <= least_rate) cycle
            if (self%unload_on_reversal(i)*v < 0.0_wp .or. self%ahead(i)*abs(v) <= room + self%slack(i)) then
               call self%leave(i, merge(1, -1, v > 0.0_wp))
            end if
         end do
         call self%sum_up()
      end do
      call weigh_both_ways(self)
      if (self%failed) return
      call look_ahead(self, least_room)
      call set_ends(self)
   end subroutine choose_branches

   !> The layer at the end of its branch leaves it, if it continues in that direction.
   subroutine leave_end(self)
      type(fibre_section), intent(inout) :: self
      real(wp) :: v
      integer :: i, way

      if (.not. self%a > no_stiffness*self%stiffness) return
      i = self%on_end
      self%open = -(self%s*self%turn + self%press)/self%a
      v = self%open + self%y(i)*self%turn
      if (.not. abs(v) > self%least_rate(self%open, self%turn)) return
      way = merge(1, -1, v > 0.0_wp)
      associate (branch => self%branch(i), d => self%deformation(i))
         if (abs(branch%end_toward(way) - d) > abs(branch%end_toward(-way) - d)) return
      end associate
      call self%leave(i, way)
      call self%sum_up()
   end subroutine leave_end

   !> Ways of all layers to the ends of their branches.
   pure subroutine look_ahead(self, least_room)
      type(fibre_section), intent(inout) :: self
      !> Not above zero if a layer has none
      real(wp), intent(out) :: least_room

      call look_along(self%count, self%y, self%k, self%lo, self%hi, self%slack, self%unload_on_reversal, &
                      self%both_ways, self%opening, self%rotation, self%open, self%turn, &
                      self%least_rate(self%open, self%turn), self%room_in_digits(), self%ahead, &
                      self%ends%ahead, least_room, self%ends%unload_on_reversal, self%ends%stiffness)
   end subroutine look_ahead

   !> Length of the chosen path, ahead and back, until a layer reaches the end of its branch.
   pure subroutine set_ends(self)
      type(fibre_section), intent(inout) :: self
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
         if (ends%unload_on_reversal) return
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

   !> The branches that lead on, where changing those without room does not end, or where layers soften or
   !> have no stiffness. The rate x of the opening is a root of the continuous, piecewise linear
   !>
   !>     G(x) = sum k_i(v_i) v_i = -dN,        v_i = x + y_i dphi
   !>
   !> with the slopes of the branches on which each layer would open and close. Without softening G
   !> rises and the root is unique; of several the one nearest to the present rate is taken; none means that
   !> the layers cannot carry the axial load.
   subroutine weigh_both_ways(self)
      type(fibre_section), intent(inout) :: self
      real(wp), dimension(self%count) :: opening, closing, corner
      real(wp) :: x, best, wanted, at, next_at, slope, value, free, rate
      integer :: order(self%count), i, j, m
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
         call self%go_on(i, merge(1, -1, rate > 0.0_wp))
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

   !> Slope of the branch on which a layer would continue in a direction. It is moved there and back.
   real(wp) function slope_ahead(self, i, way) result(k)
      type(fibre_section), intent(inout) :: self
      integer, intent(in) :: i, way
      integer :: on_end

      k = self%k(i)
      if (.not. self%must_leave(i, way)) return
      on_end = self%on_end
      call self%save_layer(i)
      call self%go_on(i, way)
      k = self%k(i)
      call self%restore_layer(i)
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

end module rbs_hysteresis_layered_fibre_path
