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
   use rbs_base_constants, only: no_stiffness, unbounded
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_layer_choice, only: choosing_layers, beyond
   use rbs_hysteresis_layer_kernels, only: look_along
   implicit none
   private

   public :: layer_bank

   !> Below this share, what is missing from equilibrium is not put right: its round-off would move the joint.
   real(wp), parameter :: firm = 1.0e-6_wp

   !> Layers that are looked at together.
   integer, parameter :: block = 64

   type, extends(choosing_layers) :: layer_bank
   contains
      procedure :: place
      procedure :: go
      procedure :: opening_at
      procedure :: find_plane
      procedure :: way_from
      procedure :: put
      procedure :: turns_back
      procedure :: rate_of_opening
   end type layer_bank

contains

   !> Move the joint along the chosen path to a rotation and an axial load on the present lines.
   pure subroutine place(self, rotation, axial_load, way, first)
      class(layer_bank), intent(inout) :: self
      real(wp), intent(in) :: rotation, axial_load
      !> Way in units of the rates, negative: back
      real(wp), intent(in) :: way
      !> The layer that comes to the end of its line, 0 for none
      integer, intent(in) :: first

      self%rotation = rotation
      self%axial_load = axial_load
      self%on_end = first
      if (self%a > firm*self%stiffness) then
         self%opening = -(axial_load + (self%force_0 + self%s*rotation))/self%a
      else
         self%opening = self%opening + self%open*way
      end if
      self%largest = max(self%largest, abs(self%opening) + self%reach*abs(rotation))
      self%moment = self%moment_0 + (self%s*self%opening + self%q*rotation)
   end subroutine place

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
         stiffness = stiffness + self%k(i)*(self%y(i) - centre)**2
      end do
      if (abs(stiffness) <= no_stiffness*self%turning) stiffness = 0.0_wp
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
      real(wp) :: ahead(block), opening, open, nearest, least_room, stiffness
      integer :: i, begin, n
      logical :: one_way

      way = unbounded
      first = 0
      opening = self%opening_at(rotation, axial_load)
      open = self%rate_of_opening(turn, press)
      do begin = 1, self%count, block
         n = min(block, self%count - begin + 1)
         associate (finish => begin + n - 1)
            ! A layer that goes back on a one-way line is an event of its own, see `turns_back`.
            call look_along(n, self%y(begin:finish), self%k(begin:finish), self%lo(begin:finish), &
                            self%hi(begin:finish), self%slack(begin:finish), self%one_way(begin:finish), &
                            self%both_ways(begin:finish), opening, rotation, open, turn, &
                            self%least_rate(open, turn), 0.0_wp, ahead, nearest, least_room, &
                            one_way, stiffness)
         end associate
         if (.not. nearest < min(way, beyond)) cycle
         do i = 1, n
            if (ahead(i) <= nearest) exit
         end do
         first = begin + i - 1
         way = nearest
      end do
   end subroutine way_from

   !> Rate of the opening on the present lines.
   pure real(wp) function rate_of_opening(self, turn, press) result(open)
      class(layer_bank), intent(in) :: self
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
      real(wp) :: open, least_rate
      integer :: i

      open = self%rate_of_opening(turn, press)
      least_rate = self%least_rate(open, turn)
      turns_back = .false.
      do i = 1, self%count
         turns_back = turns_back .or. self%one_way(i)*(open + self%y(i)*turn) < -least_rate
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
      self%open = self%rate_of_opening(turn, press)
      self%turn = turn
      self%press = press
      self%opening = opening
      call self%place(rotation, axial_load, 0.0_wp, first)
   end subroutine put

   !> Go straight to a rotation and an axial load, from event to event.
   subroutine go(self, rotation, axial_load, work)
      class(layer_bank), intent(inout) :: self
      real(wp), intent(in) :: rotation, axial_load
      !> Work of the moment along the way, to be added to [J]
      real(wp), intent(inout), optional :: work
      real(wp) :: begin(2), way(2), here, before(2)
      integer :: event
      logical :: arrives

      begin = [self%rotation, self%axial_load]
      way = [rotation, axial_load] - begin
      if (.not. any(abs(way) > 0.0_wp)) return
      here = 0.0_wp
      do event = 1, 1000 + 1000*self%count
         call self%choose(way(1), way(2))
         if (self%failed) return
         before = [self%rotation, self%moment]
         arrives = self%ends%ahead >= 1.0_wp - here
         if (arrives) then
            call self%place(rotation, axial_load, 1.0_wp - here, 0)
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

end module rbs_hysteresis_layers
