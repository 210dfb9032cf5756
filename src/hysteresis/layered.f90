!> A joint as layers: normal springs across it, at distances from the middle of the section, that together
!> carry a constant axial load (the multi-spring form of the rigid body-spring method, Kawai 1978).
!>
!> Layer i opens by  w + y_i theta,  with the opening w of the joint at the middle and its rotation theta.
!> While every layer stays on its line, equilibrium of the axial load determines w from theta, and the
!> moment is a straight line in theta: with the sums  a = sum k,  s = sum k y,  i = sum k y^2,
!>
!>     dw/dtheta = -s/a          dM/dtheta = i - s^2/a
!>
!> So the joint, like any spring, is on a line with two ends: it ends where the first layer reaches an end.
module rbs_hysteresis_layered
   use rbs_base_keys, only: key_type
   use rbs_base_kinds, only: wp
   use rbs_base_constants, only: unbounded
   use rbs_hysteresis_rule, only: rule_type, places_length, in_flexure
   use rbs_hysteresis_segment, only: segment
   implicit none
   private

   public :: layered_rule, layer_slot

   !> A layer that changes its line more often than this at one rotation alternates between two lines, each
   !> of which leads back to the other; it then stays on its present line.
   integer, parameter :: most_changes = 4
   !> Below this share of the initial axial stiffness, softening layers cannot be followed.
   real(wp), parameter :: least_share = 1.0e-5_wp
   !> Most events while the axial load is applied
   integer, parameter :: most_events = 10000

   !> The rule of one layer.
   type :: layer_slot
      class(rule_type), allocatable :: rule
   end type layer_slot

   type, extends(rule_type) :: layered_rule
      !> Axial load, compression positive [N]
      real(wp) :: axial_load = 0.0_wp
      !> Distances of the layers from the middle of the section, positive where a positive rotation opens
      !> the joint (count) [m]
      real(wp), allocatable :: y(:)
      !> Rules of the layers; their force is normal to the joint, tension positive (count)
      type(layer_slot), allocatable :: slot(:)
      !> Whether the layers can carry the axial load
      logical :: carries = .true.
      !> Present lines of the layers (count)
      type(segment), allocatable, private :: line(:)
      !> Present openings of the layers (count) [m]
      real(wp), allocatable, private :: d(:)
      !> State at the anchor of the present line: rotation, opening, and slope of the opening
      real(wp), private :: rotation = 0.0_wp, opening = 0.0_wp, slope = 0.0_wp
      !> Initial axial stiffness [N/m], distance of the outermost layer [m]
      real(wp), private :: stiffness = 0.0_wp, reach = 0.0_wp
      !> Rotation under the axial load alone, from which the rotation of the joint is counted
      real(wp), private :: rest = 0.0_wp
   contains
      procedure, nopass :: keys
      procedure, nopass :: places
      procedure :: set
      procedure :: initial_stiffness
      procedure :: start
      procedure :: next
      procedure :: opening_at
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
      real(wp) :: k(size(self%y))
      integer :: i

      do i = 1, size(k)
         k(i) = self%slot(i)%rule%initial_stiffness()
      end do
      initial_stiffness = sum(k*self%y**2) - sum(k*self%y)**2/sum(k)
   end function initial_stiffness

   !> Apply the axial load to the virgin layers; an unsymmetric section rotates until there is no moment.
   subroutine start(self, line)
      class(layered_rule), intent(inout) :: self
      type(segment), intent(out) :: line
      integer :: i, n

      n = size(self%y)
      if (.not. allocated(self%line)) allocate (self%line(n), self%d(n))
      do i = 1, n
         call self%slot(i)%rule%start(self%line(i))
      end do
      self%d = 0.0_wp
      self%rotation = 0.0_wp
      self%opening = 0.0_wp
      self%slope = 0.0_wp
      self%rest = 0.0_wp
      self%stiffness = sum(self%line%k)
      self%reach = maxval(abs(self%y))
      call put_axial_load(self)
      call settle(self, 1, line)
      if (self%carries) call find_rest(self, line)
   end subroutine start

   subroutine next(self, line, direction)
      class(layered_rule), intent(inout) :: self
      type(segment), intent(inout) :: line
      integer, intent(in) :: direction
      real(wp) :: rotation

      rotation = line%end_toward(direction) + self%rest
      self%opening = self%opening_at(rotation)
      self%rotation = rotation
      self%d = self%opening + self%y*rotation
      call settle(self, direction, line)
   end subroutine next

   !> Opening of the joint at the middle at a rotation on the present line [m].
   elemental real(wp) function opening_at(self, rotation)
      class(layered_rule), intent(in) :: self
      !> Rotation counted from the layers without load [rad]
      real(wp), intent(in) :: rotation

      opening_at = self%opening + self%slope*(rotation - self%rotation)
   end function opening_at

   !> Compress (or pull) the joint until the layers carry the axial load.
   subroutine put_axial_load(self)
      class(layered_rule), intent(inout) :: self
      real(wp) :: missing, step, room
      integer :: event, i, s

      self%carries = .true.
      s = merge(-1, 1, self%axial_load > 0.0_wp)
      do event = 1, most_events
         missing = -self%axial_load - total_force(self)
         if (s*missing <= 0.0_wp) return
         step = unbounded
         if (sum(self%line%k) > least_share*self%stiffness) step = abs(missing)/sum(self%line%k)
         room = minval(abs(merge(self%line%hi, self%line%lo, s > 0) - self%d))
         if (step >= unbounded .and. room >= unbounded) exit
         self%d = self%d + s*min(step, room)
         self%opening = self%opening + s*min(step, room)
         call carry_rear_ends(self)
         if (step <= room) return
         do i = 1, size(self%y)
            if (at_end(self, i, s)) call self%slot(i)%rule%next(self%line(i), s)
         end do
      end do
      self%carries = .false.
   end subroutine put_axial_load

   !> Rotate until there is no moment, and measure rotations from there.
   subroutine find_rest(self, line)
      class(layered_rule), intent(inout) :: self
      type(segment), intent(inout) :: line
      real(wp) :: moment, way
      integer :: event, s

      do event = 1, most_events
         moment = line%force(self%rotation)
         if (.not. abs(moment) > 0.0_wp) exit
         s = merge(-1, 1, moment > 0.0_wp)
         if (event == 1) call settle(self, s, line)
         if (.not. line%k > 0.0_wp) exit
         way = -line%force(self%rotation)/line%k
         if (abs(way) <= abs(line%end_toward(s) - self%rotation)) then
            self%opening = self%opening_at(self%rotation + way)
            self%rotation = self%rotation + way
            self%d = self%opening + self%y*self%rotation
            call carry_rear_ends(self)
            exit
         end if
         call self%next(line, s)
      end do
      self%rest = self%rotation
      call settle(self, 1, line)
      line%f0 = 0.0_wp
   end subroutine find_rest

   !> Find the lines of the layers when the joint rotates further in a direction, and the line of the joint.
   subroutine settle(self, direction, line)
      class(layered_rule), intent(inout) :: self
      !> +1 or -1
      integer, intent(in) :: direction
      type(segment), intent(out) :: line
      integer :: changes(size(self%y)), i, s
      real(wp) :: rate
      logical :: changed

      changes = 0
      call carry_rear_ends(self)
      do
         call find_slope(self)
         changed = .false.
         do i = 1, size(self%y)
            if (changes(i) >= most_changes) cycle
            rate = direction*(self%y(i) + self%slope)
            if (.not. abs(rate) > 0.0_wp) cycle
            s = merge(1, -1, rate > 0.0_wp)
            if (.not. (at_end(self, i, s) .or. self%line(i)%one_way == -s)) cycle
            call self%slot(i)%rule%next(self%line(i), s)
            changes(i) = changes(i) + 1
            changed = .true.
         end do
         if (.not. changed) exit
      end do
      call make_line(self, direction, changes < most_changes, line)
   end subroutine settle

   !> The line of the joint from the lines of its layers; it ends on each side where the first of them ends.
   subroutine make_line(self, direction, settled, line)
      class(layered_rule), intent(in) :: self
      integer, intent(in) :: direction
      !> Layers that have found their line (count)
      logical, intent(in) :: settled(:)
      type(segment), intent(out) :: line
      real(wp) :: rate, ahead, behind
      integer :: i, s

      line%d0 = self%rotation - self%rest
      line%f0 = dot_product(self%y, self%line%f0 + self%line%k*(self%d - self%line%d0))
      line%k = dot_product(self%line%k, self%y*(self%y + self%slope))
      ahead = unbounded
      behind = unbounded
      do i = 1, size(self%y)
         rate = direction*(self%y(i) + self%slope)
         if (.not. (settled(i) .and. abs(rate) > 0.0_wp)) cycle
         s = merge(1, -1, rate > 0.0_wp)
         ahead = min(ahead, turn_to(self, i, s, abs(rate)))
         if (self%line(i)%one_way /= 0) then
            line%one_way = direction
         else
            behind = min(behind, turn_to(self, i, -s, abs(rate)))
         end if
      end do
      if (line%one_way /= 0) behind = 0.0_wp
      if (ahead < unbounded) ahead = line%d0 + direction*ahead
      if (behind < unbounded) behind = line%d0 - direction*behind
      if (ahead >= unbounded) ahead = direction*unbounded
      if (behind >= unbounded) behind = -direction*unbounded
      line = line%outward(direction, near=behind, far=ahead, near_closed=.false., &
                          one_way=line%one_way /= 0)
   end subroutine make_line

   !> Rotation by which the joint can turn until a layer reaches the end of its line in a direction [rad].
   pure real(wp) function turn_to(self, i, s, rate)
      class(layered_rule), intent(in) :: self
      integer, intent(in) :: i, s
      !> Opening or closing of the layer per rotation [m/rad]
      real(wp), intent(in) :: rate
      real(wp) :: way

      way = max(s*(self%line(i)%end_toward(s) - self%d(i)), 0.0_wp)
      turn_to = unbounded
      ! The quotient would overflow for a line without an end, or with an extremely distant one.
      if (way < 1.0e100_wp*rate) turn_to = way/rate
   end function turn_to

   !> Whether a layer is at the end of its line in a direction, within the round-off of the rotation.
   pure logical function at_end(self, i, s)
      class(layered_rule), intent(in) :: self
      integer, intent(in) :: i, s
      real(wp) :: far

      far = self%line(i)%end_toward(s)
      at_end = s*(far - self%d(i)) <= 1.0e-13_wp*(abs(far) + abs(self%opening) + &
                                                  self%reach*(abs(self%rotation) + abs(self%rest)))
   end function at_end

   !> Move the rear ends of one-way lines with the layers.
   pure subroutine carry_rear_ends(self)
      class(layered_rule), intent(inout) :: self

      where (self%line%one_way > 0) self%line%lo = self%d
      where (self%line%one_way < 0) self%line%hi = self%d
   end subroutine carry_rear_ends

   !> Find the slope of the opening at the middle with the rotation, from the equilibrium of the axial load.
   subroutine find_slope(self)
      class(layered_rule), intent(inout) :: self
      real(wp) :: a

      a = sum(self%line%k)
      if (a < least_share*self%stiffness) then
         ! With its softening layers the joint could not carry the axial load: these layers keep their force.
         where (self%line%k < 0.0_wp)
            self%line%f0 = self%line%f0 + self%line%k*(self%d - self%line%d0)
            self%line%d0 = self%d
            self%line%k = 0.0_wp
         end where
         a = max(sum(self%line%k), least_share*self%stiffness)
      end if
      self%slope = -dot_product(self%line%k, self%y)/a
   end subroutine find_slope

   !> Sum of the forces of the layers, tension positive [N].
   pure real(wp) function total_force(self)
      class(layered_rule), intent(in) :: self

      total_force = sum(self%line%f0 + self%line%k*(self%d - self%line%d0))
   end function total_force

end module rbs_hysteresis_layered
