!> A joint as layers: normal springs across it, at distances from the middle of the section, that together
!> carry an axial load (the multi-spring form of the rigid body-spring method, Kawai 1978).
!>
!> While every layer stays on its line, the moment is a plane in the rotation and the axial load: with the
!> sums a = sum k,  s = sum k y  and the centre of stiffness  e = s/a
!>
!>     dw = -e dphi - dN/a          dM = k_m dphi - e dN,    k_m = sum k (y - e)^2
!>
!> At a constant axial load the joint is, like any spring, on a line with two ends: it ends where the first
!> layer reaches an end (`next`). Where the axial load varies, the joint follows a straight path in both from
!> event to event (`go`).
module rbs_hysteresis_layered
   use rbs_base_constants, only: no_stiffness, unbounded
   use rbs_base_keys, only: key_type
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_hysteresis_layers, only: layer_bank
   use rbs_hysteresis_rule, only: rule_type, places_length, in_flexure
   use rbs_hysteresis_segment, only: segment
   implicit none
   private

   public :: layered_rule

   !> Most events on the way to the rotation without moment
   integer, parameter :: most_events = 10000

   type, extends(rule_type) :: layered_rule
      !> Axial load at the start, compression positive [N]
      real(wp) :: axial_load = 0.0_wp
      !> The layers; whoever makes the rule gives their distances and rules
      type(layer_bank) :: layers
      !> Whether the layers can carry the axial load at the start
      logical :: carries = .true.
      !> Rotation under the first axial load alone, from which the rotation of the joint is counted
      real(wp), private :: rest = 0.0_wp
   contains
      procedure, nopass :: keys
      procedure, nopass :: places
      procedure :: set
      procedure :: initial_stiffness
      procedure :: start
      procedure :: next
      procedure :: go
      procedure :: choose
      procedure :: plane
      procedure :: way_to_event
      procedure :: pass_event
      procedure :: turns
      procedure :: opening_at
      procedure :: present_load
      procedure :: rotation_at_rest
      procedure :: failed
      procedure :: mark
      procedure :: restore
      procedure :: forget
      procedure :: serialize
      procedure :: line_under
   end type layered_rule

contains

   !> The rule has no parameters of its own: the layers are springs, and the axial load is that of the column.
   pure function keys()
      type(key_type), allocatable :: keys(:)

      allocate (keys(0))
   end function keys

   pure function places()
      character(len=places_length) :: places

      places = in_flexure
   end function places

   pure subroutine set(self, value)
      class(layered_rule), intent(inout) :: self
      real(wp), intent(in) :: value(:)

      self%carries = size(value) >= 0
   end subroutine set

   !> Rotational stiffness with all layers uncracked [N m/rad].
   pure real(wp) function initial_stiffness(self)
      class(layered_rule), intent(in) :: self
      real(wp) :: k(size(self%layers%y))
      integer :: i

      do i = 1, size(k)
         k(i) = self%layers%slot(i)%rule%initial_stiffness()
         if (allocated(self%layers%weight)) k(i) = k(i)*self%layers%weight(i)
      end do
      associate (y => self%layers%y)
         initial_stiffness = sum(k*(y - sum(k*y)/sum(k))**2)
      end associate
   end function initial_stiffness

   !> Apply the axial load to the virgin layers; an unsymmetric section rotates until there is no moment.
   subroutine start(self, line)
      class(layered_rule), intent(inout) :: self
      type(segment), intent(out) :: line

      self%rest = 0.0_wp
      call self%layers%start()
      call self%layers%go(0.0_wp, self%axial_load)
      self%carries = .not. self%layers%failed
      call make_line(self, 1, line)
      if (self%carries) call find_rest(self, line)
   end subroutine start

   subroutine next(self, line, direction)
      class(layered_rule), intent(inout) :: self
      type(segment), intent(inout) :: line
      integer, intent(in) :: direction
      real(wp) :: rotation, way
      integer :: first

      associate (layers => self%layers)
         rotation = line%end_toward(direction) + self%rest
         if (layers%failed .and. abs(rotation - layers%rotation) > 0.0_wp) then
            ! What lies behind a failure has no meaning; the moment stays as it was.
            line = segment(d0=line%d0, f0=line%f0)
            return
         end if
         way = layers%turn*(rotation - layers%rotation)
         first = merge(layers%ends%first_ahead, layers%ends%first_behind, direction*layers%turn > 0.0_wp)
         ! Turned back on a one-way line, somewhere between its ends.
         if (line%one_way == -direction) first = 0
         call layers%place(rotation, layers%axial_load, way, first)
      end associate
      call make_line(self, direction, line)
   end subroutine next

   !> The line of the joint at its present axial load when it rotates further in a direction; it ends on each
   !> side where the first of its layers ends.
   subroutine make_line(self, direction, line)
      class(layered_rule), intent(inout) :: self
      integer, intent(in) :: direction
      type(segment), intent(out) :: line
      real(wp) :: near, far

      ! Both ends belong to the line: where a joint stands exactly on a corner, as one of contacts without an
      ! axial load does at rest, it would otherwise have no line.
      associate (layers => self%layers)
         call layers%choose(real(direction, wp), 0.0_wp)
         line%d0 = layers%rotation - self%rest
         line%f0 = layers%moment
         if (layers%failed) then
            ! The joint keeps its moment for the rest of the motion; whoever moves it asks `failed`.
            line = line%outward(direction, near=line%d0, far=direction*unbounded, near_closed=.true., &
                                one_way=.true.)
            return
         end if
         line%k = layers%ends%stiffness
         if (abs(line%k) <= no_stiffness*layers%turning) line%k = 0.0_wp
         far = direction*unbounded
         near = -direction*unbounded
         if (layers%ends%ahead < unbounded) far = line%d0 + direction*layers%ends%ahead
         if (layers%ends%behind < unbounded) near = line%d0 - direction*layers%ends%behind
         line = line%outward(direction, near=near, far=far, near_closed=.true., one_way=layers%ends%one_way)
      end associate
   end subroutine make_line

   !> Rotate until there is no moment, and measure rotations from there.
   subroutine find_rest(self, line)
      class(layered_rule), intent(inout) :: self
      type(segment), intent(inout) :: line
      real(wp) :: moment, way
      integer :: event, s

      associate (layers => self%layers)
         do event = 1, most_events
            moment = layers%moment
            if (.not. abs(moment) > 0.0_wp) exit
            s = merge(-1, 1, moment > 0.0_wp)
            if (event == 1) call make_line(self, s, line)
            if (layers%failed .or. .not. line%k > 0.0_wp) exit
            way = -line%force(layers%rotation)/line%k
            if (abs(way) <= abs(line%end_toward(s) - layers%rotation)) then
               call layers%place(layers%rotation + way, layers%axial_load, abs(way), 0)
               exit
            end if
            call self%next(line, s)
         end do
         self%rest = layers%rotation
      end associate
      call make_line(self, 1, line)
      line%f0 = 0.0_wp
   end subroutine find_rest

   !> Go straight to a rotation and an axial load, from event to event.
   subroutine go(self, rotation, axial_load, work)
      class(layered_rule), intent(inout) :: self
      real(wp), intent(in) :: rotation, axial_load
      !> Work of the moment, to be added to [J]
      real(wp), intent(inout) :: work

      call self%layers%go(rotation + self%rest, axial_load, work)
   end subroutine go

   !> Put the layers on the lines on which they go on along a straight path.
   subroutine choose(self, turn, press)
      class(layered_rule), intent(inout) :: self
      !> Rates of the rotation [rad] and of the axial load [N]
      real(wp), intent(in) :: turn, press

      call self%layers%choose(turn, press)
   end subroutine choose

   !> The plane that the joint is on: M = moment + stiffness (phi - rotation) - centre (N - axial load).
   pure subroutine plane(self, rotation, axial_load, moment, stiffness, centre)
      class(layered_rule), intent(in) :: self
      real(wp), intent(out) :: rotation, axial_load, moment, stiffness, centre

      associate (layers => self%layers)
         rotation = layers%rotation - self%rest
         axial_load = layers%axial_load
         moment = layers%moment
         call layers%find_plane(stiffness, centre)
      end associate
   end subroutine plane

   !> How far a path goes from a point of the plane until a layer reaches an end, in units of its rates.
   pure subroutine way_to_event(self, rotation, axial_load, turn, press, way, first)
      class(layered_rule), intent(in) :: self
      real(wp), intent(in) :: rotation, axial_load, turn, press
      !> `unbounded` if there is none
      real(wp), intent(out) :: way
      !> The layer, 0 for none
      integer, intent(out) :: first

      call self%layers%way_from(rotation + self%rest, axial_load, turn, press, way, first)
   end subroutine way_to_event

   !> Whether a layer goes back on a one-way line.
   pure logical function turns(self, turn, press)
      class(layered_rule), intent(in) :: self
      !> Rates of the rotation and of the axial load
      real(wp), intent(in) :: turn, press

      turns = self%layers%turns_back(turn, press)
   end function turns

   !> Move the joint on its plane to a point, where a layer (0: none) comes exactly to the end of its line.
   subroutine pass_event(self, rotation, axial_load, turn, press, first)
      class(layered_rule), intent(inout) :: self
      real(wp), intent(in) :: rotation, axial_load, turn, press
      integer, intent(in) :: first

      call self%layers%put(rotation + self%rest, axial_load, turn, press, first)
   end subroutine pass_event

   !> Opening of the joint at the middle at a rotation and an axial load on the present plane [m].
   pure real(wp) function opening_at(self, rotation, axial_load)
      class(layered_rule), intent(in) :: self
      real(wp), intent(in) :: rotation, axial_load

      opening_at = self%layers%opening_at(rotation + self%rest, axial_load)
   end function opening_at

   !> Axial load at the last event [N].
   pure real(wp) function present_load(self)
      class(layered_rule), intent(in) :: self

      present_load = self%layers%axial_load
   end function present_load

   !> Rotation of the layers from which that of the joint is counted [rad].
   pure real(wp) function rotation_at_rest(self)
      class(layered_rule), intent(in) :: self

      rotation_at_rest = self%rest
   end function rotation_at_rest

   !> Whether the layers can no longer carry the axial load.
   pure logical function failed(self)
      class(layered_rule), intent(in) :: self

      failed = self%layers%failed
   end function failed

   !> Mark the present state, to which `restore` returns.
   subroutine mark(self)
      class(layered_rule), intent(inout) :: self

      call self%layers%mark()
   end subroutine mark

   !> Return to the mark, to the last bit. The mark stays.
   subroutine restore(self)
      class(layered_rule), intent(inout) :: self

      call self%layers%restore()
   end subroutine restore

   !> Drop the mark.
   subroutine forget(self)
      class(layered_rule), intent(inout) :: self

      call self%layers%forget()
   end subroutine forget

   !> Save or restore all history variables.
   pure subroutine serialize(self, stream)
      class(layered_rule), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%item(self%rest)
      call self%layers%serialize(stream)
   end subroutine serialize

   !> At a rotation the axial load changes at once; the line of the joint from there on.
   subroutine line_under(self, rotation, axial_load, work, line)
      class(layered_rule), intent(inout) :: self
      !> Present rotation, on the present line
      real(wp), intent(in) :: rotation, axial_load
      !> Work of the moment, to be added to [J]
      real(wp), intent(inout) :: work
      type(segment), intent(out) :: line
      real(wp) :: way

      associate (layers => self%layers)
         way = layers%turn*(rotation + self%rest - layers%rotation)
         if (abs(way) > 0.0_wp) call layers%place(rotation + self%rest, layers%axial_load, way, 0)
      end associate
      call self%go(rotation, axial_load, work)
      call make_line(self, 1, line)
   end subroutine line_under

end module rbs_hysteresis_layered
