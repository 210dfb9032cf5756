!> The layers of a joint: their rules and present lines, and a journal that leads back to a mark.
!>
!> A layer that stands for several equal ones at one place counts with its weight.
module rbs_hysteresis_layer_lines
   use rbs_base_constants, only: unbounded
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_hysteresis_layer_kernels, only: add_lines
   use rbs_hysteresis_rule, only: rule_type
   use rbs_hysteresis_segment, only: segment
   implicit none
   private

   public :: layer_lines, layer_slot, path_ends

   !> A layer this close to an end, relative to the terms of its deformation, is on it; a rate below this
   !> share of its own terms is zero.
   real(wp), parameter, public :: on_the_end = 1.0e-13_wp, no_rate = 1.0e-13_wp
   !> Where a path comes back to zero, what is left is round-off of the largest deformation so far.
   real(wp), parameter :: round_off = 4.0_wp*epsilon(1.0_wp)
   !> In the arrays of the ends, what stands for none.
   real(wp), parameter :: no_end = 1.0e140_wp

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
      !> The layer that has come to the end of its line there, but for round-off; 0 for none
      integer :: on_end = 0
      !> Largest deformation so far of a layer, or more [m]
      real(wp) :: largest = 0.0_wp
      !> Sums over the lines f = c + k d: a = sum k [N/m], s = sum k y [N], q = sum k y**2 [N m], and without
      !> deformation force [N] and moment [N m]
      real(wp) :: a = 0.0_wp, s = 0.0_wp, q = 0.0_wp, force_0 = 0.0_wp, moment_0 = 0.0_wp
      !> Moment of the layers [N m]
      real(wp) :: moment = 0.0_wp
      !> The path that the lines were chosen for: rates of rotation, axial load and opening; how far it goes
      real(wp) :: turn = 0.0_wp, press = 0.0_wp, open = 0.0_wp
      type(path_ends) :: ends
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
      !> How many equal layers each stands for (count)
      real(wp), allocatable :: weight(:)
      !> Rules and present lines of the layers, of one each (count)
      type(layer_slot), allocatable :: slot(:)
      type(segment), allocatable :: line(:)
      !> The same lines with their weights as arrays: slopes, forces without deformation, ends, how close to
      !> them a layer is on them, and as numbers whether lines are one-way and whether they are not (count)
      real(wp), allocatable :: k(:), c(:), lo(:), hi(:), slack(:), one_way(:), both_ways(:)
      !> Ways to their ends on the chosen path, ahead and behind (count)
      real(wp), allocatable :: ahead(:), behind(:)
      !> Initial stiffness, axial and about the centre of stiffness [N/m, N m/rad]; distance of the outermost
      !> layer and of that centre [m]
      real(wp) :: stiffness = 0.0_wp, turning = 0.0_wp, reach = 0.0_wp, centre = 0.0_wp
      !> What `mark` has saved: state, and the layers that have changed since
      type(bank_state), private :: kept_state
      type(layer_slot), allocatable, private :: kept_slot(:)
      type(segment), allocatable, private :: kept_line(:)
      !> What `remember` has saved of each layer (count)
      type(layer_slot), allocatable, private :: tried_slot(:)
      type(segment), allocatable, private :: tried_line(:)
      integer, allocatable, private :: kept(:)
      logical, allocatable, private :: is_kept(:)
      integer, private :: number_kept = 0
      logical, private :: marked = .false.
   contains
      procedure :: start
      procedure :: sum_up
      procedure :: deformation
      procedure :: leave
      procedure :: has_no_room
      procedure :: room_in_digits
      procedure :: mark
      procedure :: restore
      procedure :: forget
      procedure :: remember
      procedure :: go_back
      procedure :: serialize
   end type layer_lines

contains

   !> Virgin layers without load.
   subroutine start(self)
      class(layer_lines), intent(inout) :: self
      integer :: i, n

      n = size(self%y)
      self%count = n
      if (.not. allocated(self%line)) then
         if (.not. allocated(self%weight)) allocate (self%weight(n), source=1.0_wp)
         allocate (self%line(n), self%kept_slot(n), self%kept_line(n), self%kept(n), self%tried_slot(n), &
                   self%tried_line(n))
         allocate (self%k(n), self%c(n), self%lo(n), self%hi(n), self%slack(n), self%one_way(n), &
                   self%both_ways(n), self%ahead(n), self%behind(n))
         allocate (self%is_kept(n), source=.false.)
      end if
      do i = 1, n
         call self%slot(i)%rule%start(self%line(i))
         call put_line(self, i)
      end do
      self%bank_state = bank_state()
      self%reach = maxval(abs(self%y))
      call self%sum_up()
      self%stiffness = self%a
      self%centre = self%s/self%a
      self%turning = sum(self%k*(self%y - self%centre)**2)
   end subroutine start

   !> Sums over the layers on their present lines.
   pure subroutine sum_up(self)
      class(layer_lines), intent(inout) :: self

      call add_lines(self%count, self%y, self%k, self%c, self%a, self%s, self%q, self%force_0, self%moment_0)
      self%moment = self%moment_0 + (self%s*self%opening + self%q*self%rotation)
   end subroutine sum_up

   !> The line of a layer into the arrays.
   pure subroutine put_line(self, i)
      type(layer_lines), intent(inout) :: self
      integer, intent(in) :: i

      associate (line => self%line(i))
         self%k(i) = self%weight(i)*line%k
         self%c(i) = self%weight(i)*(line%f0 - line%k*line%d0)
         self%one_way(i) = line%one_way
         self%both_ways(i) = 1 - abs(line%one_way)
         self%lo(i) = -no_end
         self%hi(i) = no_end
         self%slack(i) = 0.0_wp
         ! The rear end of a one-way line moves with the layer.
         if (line%one_way <= 0 .and. line%lo > -unbounded) then
            self%lo(i) = line%lo
            self%slack(i) = on_the_end*abs(line%lo)
         end if
         if (line%one_way >= 0 .and. line%hi < unbounded) then
            self%hi(i) = line%hi
            self%slack(i) = max(self%slack(i), on_the_end*abs(line%hi))
         end if
      end associate
   end subroutine put_line

   !> Deformation of a layer [m].
   pure real(wp) function deformation(self, i)
      class(layer_lines), intent(in) :: self
      integer, intent(in) :: i

      deformation = self%opening + self%y(i)*self%rotation
   end function deformation

   !> Whether a layer is at the end of its line in a direction, within the round-off of its deformation.
   pure logical function has_no_room(self, i, way)
      class(layer_lines), intent(in) :: self
      integer, intent(in) :: i, way
      real(wp) :: far

      far = self%line(i)%end_toward(way)
      has_no_room = way*(far - self%deformation(i)) <= self%room_in_digits() + on_the_end*abs(far)
   end function has_no_room

   !> What the last digits of opening and rotation leave undecided of a deformation [m].
   pure real(wp) function room_in_digits(self)
      class(layer_lines), intent(in) :: self

      room_in_digits = on_the_end*(abs(self%opening) + self%reach*abs(self%rotation)) &
                       + round_off*self%largest
   end function room_in_digits

   !> A layer goes on beyond the end of its line, or turns back on a one-way line. `sum_up` is left to the
   !> caller.
   subroutine leave(self, i, way)
      class(layer_lines), intent(inout) :: self
      integer, intent(in) :: i
      !> +1: it opens, -1: it closes
      integer, intent(in) :: way

      if (self%marked) then
         if (.not. self%is_kept(i)) call keep(self, i)
      end if
      associate (line => self%line(i))
         if (line%one_way > 0) line%lo = self%deformation(i)
         if (line%one_way < 0) line%hi = self%deformation(i)
         call self%slot(i)%rule%next(line, way)
      end associate
      call put_line(self, i)
      if (i == self%on_end) self%on_end = 0
   end subroutine leave

   !> Mark the present state, to which `restore` returns. Only layers that change their lines are copied.
   subroutine mark(self)
      class(layer_lines), intent(inout) :: self

      call self%forget()
      self%marked = .true.
      self%kept_state = self%bank_state
   end subroutine mark

   !> Drop the mark.
   subroutine forget(self)
      class(layer_lines), intent(inout) :: self
      integer :: j

      do j = 1, self%number_kept
         self%is_kept(self%kept(j)) = .false.
      end do
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

   !> Save a layer before it tries a way.
   subroutine remember(self, i)
      class(layer_lines), intent(inout) :: self
      integer, intent(in) :: i

      self%tried_line(i) = self%line(i)
      call copy_rule(self%slot(i), self%tried_slot(i))
   end subroutine remember

   !> A layer comes back from its trial.
   subroutine go_back(self, i)
      class(layer_lines), intent(inout) :: self
      integer, intent(in) :: i

      self%line(i) = self%tried_line(i)
      call copy_rule(self%tried_slot(i), self%slot(i))
      call put_line(self, i)
   end subroutine go_back

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
         call put_line(self, i)
         self%is_kept(i) = .false.
      end do
      self%number_kept = 0
      self%bank_state = self%kept_state
   end subroutine restore

   !> Save or restore where the joint stands, and lines and memory of its layers.
   pure subroutine serialize(self, stream)
      class(layer_lines), intent(inout) :: self
      type(stream_type), intent(inout) :: stream
      integer :: i

      call serialize_state(self%bank_state, stream)
      do i = 1, self%count
         call self%line(i)%serialize(stream)
         call self%slot(i)%rule%serialize(stream)
         if (stream%restoring) call put_line(self, i)
      end do
   end subroutine serialize

   pure subroutine serialize_state(self, stream)
      type(bank_state), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%item(self%rotation)
      call stream%item(self%axial_load)
      call stream%item(self%opening)
      call stream%item(self%on_end)
      call stream%item(self%largest)
      call stream%item(self%a)
      call stream%item(self%s)
      call stream%item(self%q)
      call stream%item(self%force_0)
      call stream%item(self%moment_0)
      call stream%item(self%moment)
      call stream%item(self%turn)
      call stream%item(self%press)
      call stream%item(self%open)
      call stream%item(self%ends%ahead)
      call stream%item(self%ends%behind)
      call stream%item(self%ends%first_ahead)
      call stream%item(self%ends%first_behind)
      call stream%item(self%ends%one_way)
      call stream%item(self%ends%stiffness)
      call stream%item(self%failed)
      call stream%item(self%failure_way)
   end subroutine serialize_state

end module rbs_hysteresis_layer_lines
