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
   use rbs_hysteresis_layer_choice, only: choosing_layers, no_stiffness
   use rbs_hysteresis_layer_lines, only: rate_of, set_rear_end, no_rate
   use rbs_hysteresis_segment, only: segment
   implicit none
   private

   public :: layer_bank, path_ends

   !> Below this share, what is missing from equilibrium is not put right: its round-off would move the joint.
   real(wp), parameter :: firm = 1.0e-6_wp

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

   type, extends(choosing_layers) :: layer_bank
   contains
      procedure :: find_ends
      procedure :: place
      procedure :: go
      procedure :: opening_at
      procedure :: find_plane
      procedure :: way_from
      procedure :: put
      procedure :: turns_back
   end type layer_bank

contains

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

end module rbs_hysteresis_layers
