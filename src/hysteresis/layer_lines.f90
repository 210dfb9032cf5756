!> The layers of a joint: their rules, present lines and openings, and a journal that leads back to a mark.
module rbs_hysteresis_layer_lines
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_rule, only: rule_type
   use rbs_hysteresis_segment, only: segment
   implicit none
   private

   public :: layer_lines, layer_slot, bank_state, rate_of, set_rear_end

   !> A layer this close to an end, relative to the terms of its deformation, is on it; a rate below this
   !> share of its own terms is zero.
   real(wp), parameter, public :: on_the_end = 1.0e-13_wp, no_rate = 1.0e-13_wp
   !> Where a path comes back to zero, what is left is round-off of the largest deformation so far.
   real(wp), parameter :: round_off = 4.0_wp*epsilon(1.0_wp)

   !> The rule of one layer.
   type :: layer_slot
      class(rule_type), allocatable :: rule
   end type layer_slot

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

   !> The layers without what chooses their lines.
   type, extends(bank_state) :: layer_lines
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
      procedure :: sum_up
      procedure :: leave
      procedure :: rate
      procedure :: has_no_room
      procedure :: room_in_digits
      procedure :: mark
      procedure :: restore
      procedure :: forget
   end type layer_lines

contains

   !> Virgin layers without load.
   subroutine start(self)
      class(layer_lines), intent(inout) :: self
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
      class(layer_lines), intent(inout) :: self
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
      class(layer_lines), intent(in) :: self
      integer, intent(in) :: i

      rate = rate_of(self%y(i), self%turn, self%open, self%reach)
   end function rate

   !> Whether a layer is at the end of its line in a direction, within the round-off of its deformation.
   pure logical function has_no_room(self, i, way)
      class(layer_lines), intent(in) :: self
      integer, intent(in) :: i, way
      real(wp) :: far

      far = merge(self%line(i)%hi, self%line(i)%lo, way > 0)
      has_no_room = way*(far - self%d(i)) <= self%room_in_digits() + on_the_end*abs(far)
   end function has_no_room

   !> What the last digits of opening and rotation leave undecided of a deformation [m].
   pure real(wp) function room_in_digits(self)
      class(layer_lines), intent(in) :: self

      room_in_digits = on_the_end*(abs(self%opening) + self%reach*abs(self%rotation)) &
                       + round_off*self%largest
   end function room_in_digits

   !> A layer goes on beyond the end of its line, or turns back on a one-way line.
   subroutine leave(self, i, way)
      class(layer_lines), intent(inout) :: self
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

   !> Mark the present state, to which `restore` returns. Only layers that change their lines are copied.
   subroutine mark(self)
      class(layer_lines), intent(inout) :: self

      call self%forget()
      self%marked = .true.
      self%kept_state = self%bank_state
      self%kept_d(:) = self%d
   end subroutine mark

   !> Drop the mark.
   subroutine forget(self)
      class(layer_lines), intent(inout) :: self

      self%is_kept(self%kept(:self%number_kept)) = .false.
      self%number_kept = 0
      self%marked = .false.
   end subroutine forget

   !> Save a layer before it changes its line for the first time.
   subroutine keep(self, i)
      type(layer_lines), intent(inout) :: self
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
      class(layer_lines), intent(inout) :: self
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

end module rbs_hysteresis_layer_lines
