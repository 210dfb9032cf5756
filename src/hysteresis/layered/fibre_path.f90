!> Straight paths of a fibre section in rotation and axial load: the branches on which its layers continue,
!> and the way from event to event.
module rbs_hysteresis_layered_fibre_path
   use rbs_base_constants, only: unbounded
   use rbs_base_kinds, only: wp
   use rbs_base_tolerances, only: no_stiffness
   use rbs_hysteresis_layered_fibre_kernels, only: find_ends_ahead, find_ends_behind
   use rbs_hysteresis_layered_fibre_section, only: fibre_section
   implicit none
   private

   public :: choose_branches, go

   !> Passes in which all layers without room change their branches at once, before both ways of each are
   !> weighed.
   integer, parameter :: most_passes = 4
   !> A way beyond this, in units of the rates, is none.
   real(wp), parameter :: beyond = 1.0e100_wp
   !> A root this close to a corner is on it.
   real(wp), parameter :: on_corner = 1.0e-14_wp

contains

   !> Go straight to a rotation and an axial load, from event to event.
   subroutine go(self, rotation, axial_load, work)
      type(fibre_section), intent(inout) :: self
      !> Rotation of the joint, counted from `rest` [rad], and axial load, compression positive [N]
      real(wp), intent(in) :: rotation, axial_load
      !> The work of the moment along the path is added to it [J]
      real(wp), intent(inout), optional :: work
      real(wp) :: begin(2), change(2), share, before(2)
      integer :: event
      logical :: arrives

      begin = [self%rotation, self%axial_load]
      change = [rotation + self%rest, axial_load] - begin
      if (.not. any(abs(change) > 0.0_wp)) return
      ! The whole change is the rate of the path, so that ways along it are shares of it. A path that has not
      ! arrived after so many events does not advance: it has failed.
      share = 0.0_wp
      do event = 1, 1000 + 1000*self%count
         call choose_branches(self, change(1), change(2))
         if (self%failed) return
         before = [self%rotation, self%moment]
         arrives = self%ends%ahead >= 1.0_wp - share
         if (arrives) then
            call self%move_to(rotation + self%rest, axial_load, 1.0_wp - share, 0)
         else
            associate (next => share + self%ends%ahead)
               call self%move_to(begin(1) + next*change(1), begin(2) + next*change(2), self%ends%ahead, &
                               self%ends%first_ahead)
            end associate
         end if
         if (present(work)) work = work + 0.5_wp*(before(2) + self%moment)*(self%rotation - before(1))
         if (arrives) return
         share = share + self%ends%ahead
      end do
      self%failed = .true.
   end subroutine go

   !> Put every layer on its branch along a straight path from the present point, and find
   !> the length of the path on these branches (`ends`), in units of the rates.
   subroutine choose_branches(self, rotation_rate, axial_rate)
      type(fibre_section), intent(inout) :: self
      !> Changes of the rotation [rad] and of the axial load [N] for each unit of length of the path
      real(wp), intent(in) :: rotation_rate, axial_rate
      real(wp) :: least_clearance, least_rate, clearance, v
      integer :: pass, i

      self%failed = .false.
      self%rotation_rate = rotation_rate
      self%axial_rate = axial_rate
      ! Mostly one layer has come to its end, and all others have room.
      if (self%on_end > 0) call leave_end(self)
      do pass = 1, most_passes
         ! Layers without stiffness together do not say how the joint opens as it turns.
         if (.not. self%a > no_stiffness*self%stiffness) exit
         self%opening_rate = -(self%s*rotation_rate + axial_rate)/self%a
         call distances_ahead(self, least_clearance)
         if (least_clearance > 0.0_wp) then
            call set_ends(self)
            return
         end if
         ! All layers without room leave their branches.
         least_rate = self%least_rate(self%opening_rate, self%rotation_rate)
         clearance = self%end_tolerance()
         do i = 1, self%count
            v = self%opening_rate + self%y(i)*self%rotation_rate
            if (abs(v) <= least_rate) cycle
            if (self%unload_on_reversal(i)*v < 0.0_wp .or. self%ahead(i)*abs(v) <= clearance + &
                self%slack(i)) then
               call self%leave(i, merge(1, -1, v > 0.0_wp))
            end if
         end do
         call self%sum_up()
      end do
      call weigh_both_ways(self)
      if (self%failed) return
      call distances_ahead(self, least_clearance)
      call set_ends(self)
   end subroutine choose_branches

   !> The layer that the last event has put on the end of its branch leaves it, if it continues beyond.
   subroutine leave_end(self)
      type(fibre_section), intent(inout) :: self
      real(wp) :: v
      integer :: i, direction

      if (.not. self%a > no_stiffness*self%stiffness) return
      i = self%on_end
      self%opening_rate = -(self%s*self%rotation_rate + self%axial_rate)/self%a
      v = self%opening_rate + self%y(i)*self%rotation_rate
      if (.not. abs(v) > self%least_rate(self%opening_rate, self%rotation_rate)) return
      direction = merge(1, -1, v > 0.0_wp)
      associate (branch => self%branch(i), d => self%deformation(i))
         ! The end where the layer is lies behind it.
         if (abs(branch%end_toward(direction) - d) > abs(branch%end_toward(-direction) - d)) return
      end associate
      call self%leave(i, direction)
      call self%sum_up()
   end subroutine leave_end

   !> Ways of all layers to the ends of their branches (`ahead`), and from them in `ends` the least way, the
   !> stiffness, and whether a layer unloads on reversal.
   pure subroutine distances_ahead(self, least_clearance)
      type(fibre_section), intent(inout) :: self
      !> Not above zero if a layer is on the end that it approaches, or unloads on this reversal
      real(wp), intent(out) :: least_clearance

      call find_ends_ahead(self%count, self%y, self%k, self%lo, self%hi, self%slack, &
                           self%unload_on_reversal, self%both_ways, self%opening, self%rotation, &
                           self%opening_rate, self%rotation_rate, self%least_rate(self%opening_rate, &
                           self%rotation_rate), self%end_tolerance(), self%ahead, self%ends%ahead, &
                           least_clearance, self%ends%unload_on_reversal, self%ends%stiffness)
   end subroutine distances_ahead

   !> Complete the ends of the chosen path, after `distances_ahead`, which sets `ends%ahead` to the least way:
   !> the layers that end it, and the way back.
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
         ! A layer that unloads on reversal leaves no way back: `behind` stays zero.
         if (ends%unload_on_reversal) return
         call find_ends_behind(self%count, self%y, self%lo, self%hi, self%opening, self%rotation, &
                               self%opening_rate, self%rotation_rate, self%least_rate(self%opening_rate, &
                               self%rotation_rate), self%behind, ends%behind)
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
   !> with the slopes k_i of the branches on which layer i would open (v_i > 0) and close; dphi and dN are the
   !> rates of rotation and axial load. G has a corner at each x = -y_i dphi, where layer i stands still.
   !> Without softening G rises and the root is unique; of several roots the one nearest to the present rate
   !> is taken; without a root the layers cannot carry the axial load.
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
         corner(i) = -self%y(i)*self%rotation_rate
      end do
      call order_by(corner, order(:m))
      wanted = -self%axial_rate
      ! Layers without stiffness open as those do that have a little hardening.
      free = -self%centre*self%rotation_rate
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
                  no_stiffness*(abs(wanted) + self%stiffness*self%reach*abs(self%rotation_rate))) then
            ! This piece is level at the wanted value: any x on it is a root.
            x = free
            if (j > 0) x = max(x, at)
            if (j < m) x = min(x, corner(order(j + 1)))
         else
            cycle
         end if
         if (j > 0) then
            if (x < at - on_corner*abs(at)) cycle
         end if
         if (j < m) then
            next_at = corner(order(j + 1))
            if (x > next_at + on_corner*abs(next_at)) cycle
         end if
         if (found .and. abs(x - self%opening_rate) >= abs(best - self%opening_rate)) cycle
         found = .true.
         best = x
      end do
      if (.not. found) then
         self%failed = .true.
         ! Above -dN only closing could lower G.
         self%failure_direction = merge(-1, 1, value_at(free) > wanted)
         return
      end if
      self%opening_rate = best
      do i = 1, self%count
         rate = best + self%y(i)*self%rotation_rate
         if (abs(rate) <= self%least_rate(best, self%rotation_rate)) cycle
         call self%go_on(i, merge(1, -1, rate > 0.0_wp))
      end do
      call self%sum_up()

   contains

      !> Slope of G between the corners j and j + 1.
      real(wp) function slope_between(j) result(total)
         integer, intent(in) :: j
         integer :: p

         ! Layers with one slope for both ways, then the others: those up to corner j open, the rest close.
         total = 0.0_wp
         do p = 1, self%count
            if (.not. abs(opening(p) - closing(p)) > 0.0_wp) total = total + opening(p)
         end do
         do p = 1, m
            total = total + merge(opening(order(p)), closing(order(p)), p <= j)
         end do
      end function slope_between

      !> G at the rate x of the opening.
      real(wp) function value_at(x) result(total)
         real(wp), intent(in) :: x
         real(wp) :: v
         integer :: p

         total = 0.0_wp
         do p = 1, self%count
            v = x + self%y(p)*self%rotation_rate
            total = total + merge(opening(p), closing(p), v > 0.0_wp)*v
         end do
      end function value_at

   end subroutine weigh_both_ways

   !> Slope of the branch on which layer i would continue in a direction (+1: it opens, -1: it closes). For
   !> this the layer is put on that branch, and back again.
   real(wp) function slope_ahead(self, i, direction) result(k)
      type(fibre_section), intent(inout) :: self
      integer, intent(in) :: i, direction
      integer :: on_end

      k = self%k(i)
      if (.not. self%must_leave(i, direction)) return
      on_end = self%on_end
      call self%save_layer(i)
      call self%go_on(i, direction)
      k = self%k(i)
      call self%restore_layer(i)
      self%on_end = on_end
   end function slope_ahead

   !> Sort indices by the values that they point to, ascending, by insertion: there are few.
   pure subroutine order_by(value, order)
      !> Values, and the places among them that are sorted
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
