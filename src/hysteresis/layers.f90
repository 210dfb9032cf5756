!> Layers side by side across a joint: normal springs at distances y_i from the middle of the section, that
!> open by  d_i = w + y_i phi  and together carry an axial load N (compression positive).
!>
!> While every layer stays on its line, with the sums  a = sum k,  s = sum k y,  equilibrium of the axial load
!>
!>     sum F_i = -N        gives        dw = x = -(s dphi + dN)/a
!>
!> so on a straight path in (phi, N) every layer moves at a constant rate  v_i = x + y_i dphi, and the lines
!> hold until the first layer reaches an end of its own. Nothing is added up along the path: w is corrected by
!> what is missing from equilibrium wherever a line changes.
module rbs_hysteresis_layers
   use rbs_base_constants, only: unbounded
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_rule, only: rule_type
   use rbs_hysteresis_segment, only: segment
   implicit none
   private

   public :: layer_bank, layer_slot, path_ends

   !> Passes in which all layers without room change their lines at once, before both ways of each are
   !> weighed.
   integer, parameter :: most_passes = 4
   !> Lines without length that one layer may pass at one point.
   integer, parameter :: most_lines = 8
   !> Below this share of the initial axial stiffness the layers count as having none.
   real(wp), parameter :: no_stiffness = 1.0e-12_wp
   !> Below this share, what is missing from equilibrium is not put right: its round-off would move the joint.
   real(wp), parameter :: firm = 1.0e-6_wp
   !> A layer this close to an end, relative to the terms of its deformation, is on it; a rate below this
   !> share of its own terms is zero.
   real(wp), parameter :: on_the_end = 1.0e-13_wp, no_rate = 1.0e-13_wp
   !> Where a path comes back to zero, what is left is round-off of the largest deformation so far.
   real(wp), parameter :: round_off = 4.0_wp*epsilon(1.0_wp)

   !> The rule of one layer.
   type :: layer_slot
      class(rule_type), allocatable :: rule
   end type layer_slot

   !> How far a path goes on the present lines, in units of its rates.
   type :: path_ends
      !> Ahead and back; `unbounded` if no layer reaches an end
      real(wp) :: ahead = unbounded, behind = unbounded
      !> The layers that end it, 0 for none
      integer :: first_ahead = 0, first_behind = 0
      !> Whether a layer is on a one-way line, so that there is no way back
      logical :: one_way = .false.
      !> sum k v**2: for a rotation at a constant axial load the slope of the moment [N m/rad]
      real(wp) :: stiffness = 0.0_wp
   end type path_ends

   !> Where a joint stands and where its path leads.
   type :: bank_state
      !> Rotation, axial load and opening at the middle at the last event [rad, N, m]
      real(wp) :: rotation = 0.0_wp, axial_load = 0.0_wp, opening = 0.0_wp
      !> Largest deformation so far of a layer, or more [m]
      real(wp) :: largest = 0.0_wp
      !> Sums of the lines there: a [N/m], s [N]; force [N] and moment [N m] of the layers
      real(wp) :: a = 0.0_wp, s = 0.0_wp, force = 0.0_wp, moment = 0.0_wp
      !> The path that the lines were chosen for: rates of rotation, axial load and opening
      real(wp) :: turn = 0.0_wp, press = 0.0_wp, open = 0.0_wp
      !> Whether no equilibrium of the axial load lies ahead, and the way the joint then goes: -1 it closes
      !> (compression is lost), +1 it opens
      logical :: failed = .false.
      integer :: failure_way = 0
   end type bank_state

   type, extends(bank_state) :: layer_bank
      integer :: count = 0
      !> Distances from the middle of the section, positive where a positive rotation opens the joint (count)
      !> [m]
      real(wp), allocatable :: y(:)
      !> Rules, present lines and openings of the layers (count)
      type(layer_slot), allocatable :: slot(:)
      type(segment), allocatable :: line(:)
      real(wp), allocatable :: d(:)
      !> Initial axial stiffness [N/m], distance of the outermost layer and of the centre of stiffness [m]
      real(wp) :: stiffness = 0.0_wp, reach = 0.0_wp, centre = 0.0_wp
      !> What `mark` has saved: state, openings, and the layers that have changed since
      type(bank_state), private :: kept_state
      real(wp), allocatable, private :: kept_d(:)
      type(layer_slot), allocatable, private :: kept_slot(:)
      type(segment), allocatable, private :: kept_line(:)
      integer, allocatable, private :: kept(:)
      logical, allocatable, private :: is_kept(:)
      integer, private :: number_kept = 0
      logical, private :: marked = .false.
   contains
      procedure :: start
      procedure :: choose
      procedure :: find_ends
      procedure :: place
      procedure :: go
      procedure :: opening_at
      procedure :: find_plane
      procedure :: way_from
      procedure :: put
      procedure :: turns_back
      procedure :: sum_up
      procedure :: leave
      procedure :: rate
      procedure :: mark
      procedure :: restore
      procedure :: forget
   end type layer_bank

contains

   !> Virgin layers without load.
   subroutine start(self)
      class(layer_bank), intent(inout) :: self
      integer :: i, n

      n = size(self%y)
      self%count = n
      if (.not. allocated(self%line)) then
         allocate (self%line(n), self%d(n), self%kept_slot(n), self%kept_line(n), self%kept(n), &
                   self%kept_d(n))
         allocate (self%is_kept(n), source=.false.)
      end if
      do i = 1, n
         call self%slot(i)%rule%start(self%line(i))
      end do
      self%d = 0.0_wp
      self%rotation = 0.0_wp
      self%axial_load = 0.0_wp
      self%opening = 0.0_wp
      self%largest = 0.0_wp
      self%failed = .false.
      self%failure_way = 0
      self%reach = maxval(abs(self%y))
      call self%sum_up()
      self%stiffness = self%a
      self%centre = self%s/self%a
      self%turn = 0.0_wp
      self%press = 0.0_wp
      self%open = 0.0_wp
   end subroutine start

   !> Sums over the layers on their present lines.
   pure subroutine sum_up(self)
      class(layer_bank), intent(inout) :: self
      real(wp) :: a, s, force, moment, f
      integer :: i

      a = 0.0_wp
      s = 0.0_wp
      force = 0.0_wp
      moment = 0.0_wp
      do i = 1, self%count
         associate (line => self%line(i), y => self%y(i))
            f = line%f0 + line%k*(self%d(i) - line%d0)
            a = a + line%k
            s = s + line%k*y
            force = force + f
            moment = moment + f*y
         end associate
      end do
      self%a = a
      self%s = s
      self%force = force
      self%moment = moment
   end subroutine sum_up

   !> Rate of a layer on the path that the lines were chosen for; exactly zero where it is round-off.
   elemental real(wp) function rate_of(y, turn, open, reach) result(v)
      real(wp), intent(in) :: y, turn, open, reach

      v = open + y*turn
      if (abs(v) <= no_rate*(abs(open) + reach*abs(turn))) v = 0.0_wp
   end function rate_of

   !> Rate of layer i on the path that the lines were chosen for.
   pure real(wp) function rate(self, i)
      class(layer_bank), intent(in) :: self
      integer, intent(in) :: i

      rate = rate_of(self%y(i), self%turn, self%open, self%reach)
   end function rate

   !> Put every layer on the line on which it goes on along a straight path from where the joint stands.
   subroutine choose(self, turn, press)
      class(layer_bank), intent(inout) :: self
      !> Rates of the rotation [rad] and of the axial load [N]
      real(wp), intent(in) :: turn, press
      real(wp) :: v, least_rate, least_room
      integer :: i, pass, way
      logical :: changed

      self%failed = .false.
      self%turn = turn
      self%press = press
      least_room = room_in_digits(self)
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

   !> Whether a layer is at the end of its line in a direction, within the round-off of its deformation.
   pure logical function has_no_room(self, i, way)
      type(layer_bank), intent(in) :: self
      integer, intent(in) :: i, way
      real(wp) :: far

      far = merge(self%line(i)%hi, self%line(i)%lo, way > 0)
      has_no_room = way*(far - self%d(i)) <= room_in_digits(self) + on_the_end*abs(far)
   end function has_no_room

   !> What the last digits of opening and rotation leave undecided of a deformation [m].
   pure real(wp) function room_in_digits(self)
      type(layer_bank), intent(in) :: self

      room_in_digits = on_the_end*(abs(self%opening) + self%reach*abs(self%rotation)) &
                       + round_off*self%largest
   end function room_in_digits

   !> A layer goes on beyond the end of its line, or turns back on a one-way line.
   subroutine leave(self, i, way)
      class(layer_bank), intent(inout) :: self
      integer, intent(in) :: i
      !> +1: it opens, -1: it closes
      integer, intent(in) :: way

      if (self%marked) then
         if (.not. self%is_kept(i)) call keep(self, i)
      end if
      call set_rear_end(self%line(i), self%d(i))
      call self%slot(i)%rule%next(self%line(i), way)
   end subroutine leave

   !> The rear end of a one-way line moves with the layer.
   elemental subroutine set_rear_end(line, d)
      type(segment), intent(inout) :: line
      real(wp), intent(in) :: d

      if (line%one_way > 0) line%lo = d
      if (line%one_way < 0) line%hi = d
   end subroutine set_rear_end

   !> The lines that lead on, where changing those without room does not end, or where layers soften or have
   !> no stiffness. The rate x of the opening is a root of the continuous, piecewise linear
   !>
   !>     G(x) = sum k_i(v_i) v_i = -dN,        v_i = x + y_i dphi
   !>
   !> with the slopes of the lines on which each layer would go on opening and closing. Without softening G
   !> rises and the root is unique; of several the one nearest to the present rate is taken; none means that
   !> the layers cannot carry the axial load.
   subroutine weigh_both_ways(self)
      type(layer_bank), intent(inout) :: self
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
               if (.not. (self%line(i)%one_way == -way .or. has_no_room(self, i, way))) exit
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
      type(layer_bank), intent(in) :: self
      integer, intent(in) :: i, way
      type(layer_bank) :: copy
      integer :: lines

      k = self%line(i)%k
      if (.not. (self%line(i)%one_way == -way .or. has_no_room(self, i, way))) return
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
         if (.not. (copy%line(1)%one_way == -way .or. has_no_room(copy, 1, way))) exit
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

   !> How far the chosen path goes, ahead and back, until a layer reaches the end of its line.
   pure subroutine find_ends(self, ends)
      class(layer_bank), intent(in) :: self
      type(path_ends), intent(out) :: ends
      real(wp) :: v, size_v, ahead, back, nearest(2), least_rate
      integer :: i

      ! Not quotients: those would overflow for lines without an end. A distance beyond this counts as none.
      nearest = 1.0e100_wp
      least_rate = no_rate*(abs(self%open) + self%reach*abs(self%turn))
      do i = 1, self%count
         v = self%open + self%y(i)*self%turn
         size_v = abs(v)
         if (size_v <= least_rate) cycle
         associate (line => self%line(i))
            ends%stiffness = ends%stiffness + line%k*v**2
            if (v > 0.0_wp) then
               ahead = line%hi - self%d(i)
               back = self%d(i) - line%lo
            else
               ahead = self%d(i) - line%lo
               back = line%hi - self%d(i)
            end if
            if (ahead < nearest(1)*size_v) then
               nearest(1) = max(ahead, 0.0_wp)/size_v
               ends%first_ahead = i
            end if
            if (line%one_way /= 0) then
               ends%one_way = .true.
            else if (back < nearest(2)*size_v) then
               nearest(2) = max(back, 0.0_wp)/size_v
               ends%first_behind = i
            end if
         end associate
      end do
      if (ends%first_ahead > 0) ends%ahead = nearest(1)
      if (ends%first_behind > 0) ends%behind = nearest(2)
      if (ends%one_way) ends%behind = 0.0_wp
   end subroutine find_ends

   !> Move the joint along the chosen path to a rotation and an axial load on the present lines.
   pure subroutine place(self, rotation, axial_load, way, first)
      class(layer_bank), intent(inout) :: self
      real(wp), intent(in) :: rotation, axial_load
      !> Way in units of the rates, negative: back
      real(wp), intent(in) :: way
      !> The layer that comes exactly to the end of its line, 0 for none
      integer, intent(in) :: first
      real(wp) :: missing
      integer :: i

      self%opening = self%opening + self%open*way
      self%rotation = rotation
      self%axial_load = axial_load
      missing = axial_load
      do i = 1, self%count
         associate (line => self%line(i))
            missing = missing + (line%f0 + line%k*((self%opening + self%y(i)*rotation) - line%d0))
         end associate
      end do
      if (self%a > firm*self%stiffness) self%opening = self%opening - missing/self%a
      self%d = self%opening + self%y*rotation
      self%largest = max(self%largest, abs(self%opening) + self%reach*abs(rotation))
      if (first > 0) call put_on_end(self%line(first), self%d(first))
      call set_rear_end(self%line, self%d)
   end subroutine place

   !> Put a layer exactly on the end of its line that it has reached but for round-off.
   pure subroutine put_on_end(line, d)
      type(segment), intent(in) :: line
      real(wp), intent(inout) :: d

      d = merge(line%hi, line%lo, line%hi - d < d - line%lo)
   end subroutine put_on_end

   !> Opening of the joint at the middle at a rotation and an axial load on the present lines [m].
   pure real(wp) function opening_at(self, rotation, axial_load)
      class(layer_bank), intent(in) :: self
      real(wp), intent(in) :: rotation, axial_load

      if (self%a > no_stiffness*self%stiffness) then
         opening_at = self%opening - (self%s*(rotation - self%rotation) &
                                      + (axial_load - self%axial_load))/self%a
      else
         opening_at = self%opening
         if (abs(self%turn) > 0.0_wp) then
            opening_at = opening_at + self%open/self%turn*(rotation - self%rotation)
         end if
      end if
   end function opening_at

   !> Slopes of the moment on the present lines: k_m with the rotation [N m/rad], -e with the axial load [m].
   pure subroutine find_plane(self, stiffness, centre)
      class(layer_bank), intent(in) :: self
      real(wp), intent(out) :: stiffness, centre
      integer :: i

      centre = self%centre
      if (self%a > no_stiffness*self%stiffness) then
         centre = self%s/self%a
      else if (abs(self%turn) > 0.0_wp) then
         centre = -self%open/self%turn
      end if
      stiffness = 0.0_wp
      do i = 1, self%count
         stiffness = stiffness + self%line(i)%k*(self%y(i) - centre)**2
      end do
   end subroutine find_plane

   !> How far a path goes from a point on the present lines until a layer reaches the end of its line.
   pure subroutine way_from(self, rotation, axial_load, turn, press, way, first)
      class(layer_bank), intent(in) :: self
      real(wp), intent(in) :: rotation, axial_load
      !> Rates of the rotation and of the axial load
      real(wp), intent(in) :: turn, press
      !> In units of the rates; `unbounded` if none does
      real(wp), intent(out) :: way
      !> The layer, 0 for none
      integer, intent(out) :: first
      real(wp) :: opening, open, v, ahead, d
      integer :: i

      way = unbounded
      first = 0
      opening = self%opening_at(rotation, axial_load)
      open = rate_of_opening(self, turn, press)
      do i = 1, self%count
         v = rate_of(self%y(i), turn, open, self%reach)
         if (.not. abs(v) > 0.0_wp) cycle
         d = opening + self%y(i)*rotation
         ahead = merge(self%line(i)%hi - d, d - self%line(i)%lo, v > 0.0_wp)
         ! A layer that goes back on a one-way line is an event of its own, see `turns_back`.
         if (self%line(i)%one_way*v < 0.0_wp) cycle
         if (ahead < min(way, 1.0e100_wp)*abs(v)) then
            way = ahead/abs(v)
            first = i
         end if
      end do
   end subroutine way_from

   !> Rate of the opening on the present lines.
   pure real(wp) function rate_of_opening(self, turn, press) result(open)
      type(layer_bank), intent(in) :: self
      real(wp), intent(in) :: turn, press

      if (self%a > no_stiffness*self%stiffness) then
         open = -(self%s*turn + press)/self%a
      else if (abs(self%turn) > 0.0_wp) then
         open = self%open/self%turn*turn
      else
         open = self%open
      end if
   end function rate_of_opening

   !> Whether a layer on a one-way line goes back on a path on the present lines.
   pure logical function turns_back(self, turn, press)
      class(layer_bank), intent(in) :: self
      real(wp), intent(in) :: turn, press
      real(wp) :: open
      integer :: i

      open = rate_of_opening(self, turn, press)
      turns_back = .false.
      do i = 1, self%count
         turns_back = turns_back .or. self%line(i)%one_way*rate_of(self%y(i), turn, open, self%reach) < 0.0_wp
      end do
   end function turns_back

   !> Put the joint on a point of its present lines that lies ahead on a path with given rates.
   pure subroutine put(self, rotation, axial_load, turn, press, first)
      class(layer_bank), intent(inout) :: self
      real(wp), intent(in) :: rotation, axial_load, turn, press
      !> The layer that comes exactly to the end of its line, 0 for none
      integer, intent(in) :: first
      real(wp) :: opening

      opening = self%opening_at(rotation, axial_load)
      self%open = rate_of_opening(self, turn, press)
      self%turn = turn
      self%press = press
      self%opening = opening
      call self%place(rotation, axial_load, 0.0_wp, first)
      call self%sum_up()
   end subroutine put

   !> Go straight to a rotation and an axial load, from event to event.
   subroutine go(self, rotation, axial_load, work)
      class(layer_bank), intent(inout) :: self
      real(wp), intent(in) :: rotation, axial_load
      !> Work of the moment along the way, to be added to [J]
      real(wp), intent(inout), optional :: work
      real(wp) :: begin(2), way(2), here, before(2)
      type(path_ends) :: ends
      integer :: event
      logical :: arrives

      begin = [self%rotation, self%axial_load]
      way = [rotation, axial_load] - begin
      if (.not. any(abs(way) > 0.0_wp)) return
      here = 0.0_wp
      do event = 1, 1000 + 1000*self%count
         call self%choose(way(1), way(2))
         if (self%failed) return
         call self%find_ends(ends)
         before = [self%rotation, self%moment]
         arrives = ends%ahead >= 1.0_wp - here
         if (arrives) then
            call self%place(rotation, axial_load, 1.0_wp - here, 0)
         else
            associate (there => here + ends%ahead)
               call self%place(begin(1) + there*way(1), begin(2) + there*way(2), ends%ahead, ends%first_ahead)
            end associate
         end if
         call self%sum_up()
         if (present(work)) work = work + 0.5_wp*(before(2) + self%moment)*(self%rotation - before(1))
         if (arrives) return
         here = here + ends%ahead
      end do
      self%failed = .true.
   end subroutine go

   !> Mark the present state, to which `restore` returns. Only layers that change their lines are copied.
   subroutine mark(self)
      class(layer_bank), intent(inout) :: self

      call self%forget()
      self%marked = .true.
      self%kept_state = self%bank_state
      self%kept_d(:) = self%d
   end subroutine mark

   !> Drop the mark.
   subroutine forget(self)
      class(layer_bank), intent(inout) :: self

      self%is_kept(self%kept(:self%number_kept)) = .false.
      self%number_kept = 0
      self%marked = .false.
   end subroutine forget

   !> Save a layer before it changes its line for the first time.
   subroutine keep(self, i)
      type(layer_bank), intent(inout) :: self
      integer, intent(in) :: i

      self%is_kept(i) = .true.
      self%number_kept = self%number_kept + 1
      self%kept(self%number_kept) = i
      self%kept_line(self%number_kept) = self%line(i)
      call copy_rule(self%slot(i), self%kept_slot(i))
   end subroutine keep

   !> Copy a rule with its memory.
   subroutine copy_rule(from, to)
      type(layer_slot), intent(in) :: from
      type(layer_slot), intent(inout) :: to
      logical :: done

      done = .false.
      if (allocated(to%rule)) call to%rule%copy_memory(from%rule, done)
      if (.not. done) to = from
   end subroutine copy_rule

   !> Return to the mark, to the last bit. The mark stays.
   subroutine restore(self)
      class(layer_bank), intent(inout) :: self
      integer :: i, j

      do j = 1, self%number_kept
         i = self%kept(j)
         self%line(i) = self%kept_line(j)
         call copy_rule(self%kept_slot(i), self%slot(i))
         self%is_kept(i) = .false.
      end do
      self%number_kept = 0
      self%bank_state = self%kept_state
      self%d(:) = self%kept_d
      call set_rear_end(self%line, self%d)
   end subroutine restore

end module rbs_hysteresis_layers
