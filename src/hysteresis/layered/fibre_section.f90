!> A joint as a fibre section: normal springs (layers) across it, at distances y_i from the middle of the
!> section, that open by  d_i = w + y_i phi  and together carry an axial load N, compression positive (the
!> multi-spring form of the rigid body-spring method, Kawai 1978).
!>
!> While every layer stays on its branch, with the sums  a = sum k,  s = sum k y,  equilibrium of the axial
!> load
!>
!>     sum F_i = -N        gives        dw = x = -(s dphi + dN)/a
!>
!> and the moment is a plane in the rotation and the axial load: with the centre of stiffness  e = s/a
!>
!>     dM = k_m dphi - e dN,    k_m = sum k (y - e)^2
!>
!> On a straight path in (phi, N) every layer moves at a constant rate  v_i = x + y_i dphi, and the branches
!> hold until the first layer reaches an end of its own (`rbs_hysteresis_layered_fibre_path`). Nothing is
!> added up along the path: w is corrected by the residual of equilibrium wherever a branch changes.
!>
!> A layer that represents several equal ones at one place counts with its weight.
module rbs_hysteresis_layered_fibre_section
   use rbs_base_constants, only: unbounded
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_base_tolerances, only: no_stiffness, round_off
   use rbs_hysteresis_layered_fibre_kernels, only: add_lines
   use rbs_hysteresis_rule, only: rule_memory, rule_slot, memory_slot, copy_memory
   use rbs_hysteresis_segment, only: segment
   implicit none
   private

   public :: fibre_section, path_ends

   !> A layer this close to an end, relative to the terms of its deformation, is on it; a rate below this
   !> share of its own terms is zero.
   real(wp), parameter :: on_layer_end = 1.0e-13_wp, no_layer_rate = 1.0e-13_wp
   !> A rate below this is none.
   real(wp), parameter :: least_speed = 1.0e-150_wp
   !> Branches without length that one layer may pass at one point.
   integer, parameter :: most_branches = 8
   !> In the arrays of the ends, the number for none.
   real(wp), parameter :: no_end = 1.0e140_wp
   !> Below this share the residual of equilibrium is not corrected: its round-off would move the joint.
   real(wp), parameter :: firm = 1.0e-6_wp

   !> Length of a path on the present branches, in units of its rates.
   type :: path_ends
      !> Ahead and back; `unbounded` if no layer reaches an end
      real(wp) :: ahead = unbounded, behind = unbounded
      !> The layers that end it, 0 for none
      integer :: first_ahead = 0, first_behind = 0
      !> Whether a layer is on a branch that unloads on reversal, so that there is no way back
      logical :: unload_on_reversal = .false.
      !> sum k v**2: for a rotation at a constant axial load the slope of the moment [N m/rad]
      real(wp) :: stiffness = 0.0_wp
   end type path_ends

   !> Rotation, axial load and opening of a section, and the path that it is on.
   type, extends(rule_memory) :: section_state
      !> Rotation under the first axial load alone, from which that of the joint is counted [rad]
      real(wp) :: rest = 0.0_wp
      !> Rotation (from zero), axial load and opening at the middle at the last event [rad, N, m]
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
      !> The path that the lines were chosen for: rates of rotation, axial load and opening; its length
      real(wp) :: rotation_rate = 0.0_wp, axial_rate = 0.0_wp, opening_rate = 0.0_wp
      type(path_ends) :: ends
      !> Whether no equilibrium of the axial load lies ahead, and the direction of the joint then: -1 it
      !> closes (compression is lost), +1 it opens
      logical :: failed = .false.
      integer :: failure_direction = 0
   end type section_state

   type, extends(section_state) :: fibre_section
      integer :: count = 0
      !> Distances from the middle of the section, positive where a positive rotation opens the joint (count)
      !> [m]
      real(wp), allocatable :: y(:)
      !> Number of equal layers that each represents (count)
      real(wp), allocatable :: weight(:)
      !> The rules of the layers, and which of them each layer has (count)
      type(rule_slot), allocatable :: rule(:)
      integer, allocatable :: rule_of(:)
      !> Memories and present branches of the layers, of one each (count)
      type(memory_slot), allocatable :: slot(:)
      type(segment), allocatable :: branch(:)
      !> The same branches with their weights as arrays: slopes, forces without deformation, ends, how close
      !> to them a layer is on them, and as numbers whether they unload on reversal and whether they do not
      !> (count)
      real(wp), allocatable :: k(:), c(:), lo(:), hi(:), slack(:), unload_on_reversal(:), both_ways(:)
      !> Ways to their ends on the chosen path, ahead and behind (count)
      real(wp), allocatable :: ahead(:), behind(:)
      !> Initial stiffness, axial and about the centre of stiffness [N/m, N m/rad]; distance of the outermost
      !> layer and of that centre [m]
      real(wp) :: stiffness = 0.0_wp, turning = 0.0_wp, reach = 0.0_wp, centre = 0.0_wp
      !> Whether the layers can carry the axial load at the start
      logical :: carries = .true.
      !> Copy saved by `mark`: state, and the layers that have changed since
      type(section_state), private :: kept_state
      type(memory_slot), allocatable, private :: kept_slot(:)
      type(segment), allocatable, private :: kept_branch(:)
      !> Copy of each layer saved by `save_layer` (count)
      type(memory_slot), allocatable, private :: tried_slot(:)
      type(segment), allocatable, private :: tried_branch(:)
      integer, allocatable, private :: kept(:)
      logical, allocatable, private :: is_kept(:)
      integer, private :: number_kept = 0
      logical, private :: marked = .false.
   contains
      procedure :: start, sum_up, deformation, leave, must_leave, go_on, end_tolerance, least_rate, move_to
      procedure :: put, opening_at, read_plane, motion_of_layers, mark, restore, forget, save_layer
      procedure :: restore_layer, serialize
   end type fibre_section

contains

   !> Virgin layers without load.
   subroutine start(self, y, weight, rule, rule_of)
      class(fibre_section), intent(inout) :: self
      !> Distances of the layers from the middle of the section [m], number of equal layers that each
      !> represents (layers)
      real(wp), intent(in) :: y(:), weight(:)
      !> The rules of the layers, and which of them each layer has (layers)
      type(rule_slot), intent(in) :: rule(:)
      integer, intent(in) :: rule_of(:)
      integer :: i, n

      n = size(y)
      self%y = y
      self%weight = weight
      self%rule = rule
      self%rule_of = rule_of
      self%count = n
      allocate (self%slot(n), self%branch(n), self%kept_slot(n), self%kept_branch(n), self%kept(n), &
                self%tried_slot(n), self%tried_branch(n))
      allocate (self%k(n), self%c(n), self%lo(n), self%hi(n), self%slack(n), self%unload_on_reversal(n), &
                self%both_ways(n), self%ahead(n), self%behind(n))
      allocate (self%is_kept(n), source=.false.)
      do i = 1, n
         call self%rule(self%rule_of(i))%rule%start(0.0_wp, self%slot(i)%memory, self%branch(i))
         call put_branch(self, i)
      end do
      self%reach = maxval(abs(self%y))
      call self%sum_up()
      self%stiffness = self%a
      self%centre = self%s/self%a
      self%turning = sum(self%k*(self%y - self%centre)**2)
   end subroutine start

   !> Sums over the layers on their present branches, and from them the moment at the present opening and
   !> rotation.
   pure subroutine sum_up(self)
      class(fibre_section), intent(inout) :: self

      call add_lines(self%count, self%y, self%k, self%c, self%a, self%s, self%q, self%force_0, self%moment_0)
      self%moment = self%moment_0 + (self%s*self%opening + self%q*self%rotation)
   end subroutine sum_up

   !> Copy the branch of layer i, times the weight of the layer, into the arrays.
   pure subroutine put_branch(self, i)
      type(fibre_section), intent(inout) :: self
      integer, intent(in) :: i

      associate (branch => self%branch(i))
         self%k(i) = self%weight(i)*branch%k
         self%c(i) = self%weight(i)*(branch%f0 - branch%k*branch%d0)
         self%unload_on_reversal(i) = branch%unload_on_reversal
         self%both_ways(i) = 1 - abs(branch%unload_on_reversal)
         self%lo(i) = -no_end
         self%hi(i) = no_end
         self%slack(i) = 0.0_wp
         ! The rear end of a branch that unloads on reversal moves with the layer.
         if (branch%unload_on_reversal <= 0 .and. branch%lo > -unbounded) then
            self%lo(i) = branch%lo
            self%slack(i) = on_layer_end*abs(branch%lo)
         end if
         if (branch%unload_on_reversal >= 0 .and. branch%hi < unbounded) then
            self%hi(i) = branch%hi
            self%slack(i) = max(self%slack(i), on_layer_end*abs(branch%hi))
         end if
      end associate
   end subroutine put_branch

   !> Deformation of a layer [m].
   pure real(wp) function deformation(self, i)
      class(fibre_section), intent(in) :: self
      integer, intent(in) :: i

      deformation = self%opening + self%y(i)*self%rotation
   end function deformation

   !> Put layer i on the branch that follows: it passes the end of its present branch, or unloads on a
   !> reversal. The caller calls `sum_up`.
   subroutine leave(self, i, direction)
      class(fibre_section), intent(inout) :: self
      integer, intent(in) :: i
      !> +1: it opens, -1: it closes
      integer, intent(in) :: direction

      ! The first change since `mark` saves the layer.
      if (self%marked) then
         if (.not. self%is_kept(i)) then
            self%is_kept(i) = .true.
            self%number_kept = self%number_kept + 1
            self%kept(self%number_kept) = i
            self%kept_branch(self%number_kept) = self%branch(i)
            call copy_memory(self%slot(i), self%kept_slot(i))
         end if
      end if
      if (self%branch(i)%unload_on_reversal > 0) self%branch(i)%lo = self%deformation(i)
      if (self%branch(i)%unload_on_reversal < 0) self%branch(i)%hi = self%deformation(i)
      call self%rule(self%rule_of(i))%rule%next(self%slot(i)%memory, self%branch(i), direction)
      call put_branch(self, i)
      if (i == self%on_end) self%on_end = 0
   end subroutine leave

   !> Whether a layer that moves in a direction leaves its branch at once: it unloads on the reversal, or is
   !> at the end within the round-off of its deformation.
   pure logical function must_leave(self, i, direction)
      class(fibre_section), intent(in) :: self
      !> Layer; +1: it opens, -1: it closes
      integer, intent(in) :: i, direction
      real(wp) :: far

      must_leave = self%branch(i)%unload_on_reversal == -direction
      if (must_leave) return
      far = self%branch(i)%end_toward(direction)
      must_leave = direction*(far - self%deformation(i)) <= self%end_tolerance() + on_layer_end*abs(far)
   end function must_leave

   !> Put a layer that moves in a direction on the branch along which it can move; branches without length are
   !> passed. The caller calls `sum_up`.
   subroutine go_on(self, i, direction)
      class(fibre_section), intent(inout) :: self
      !> Layer; +1: it opens, -1: it closes
      integer, intent(in) :: i, direction
      integer :: branches

      do branches = 1, most_branches
         if (.not. self%must_leave(i, direction)) exit
         call self%leave(i, direction)
      end do
   end subroutine go_on

   !> Uncertainty of a deformation by the last digits of opening and rotation [m].
   pure real(wp) function end_tolerance(self)
      class(fibre_section), intent(in) :: self

      end_tolerance = on_layer_end*(abs(self%opening) + self%reach*abs(self%rotation)) &
                       + round_off*self%largest
   end function end_tolerance

   !> Rates of layers up to this are round-off, as the opening and the rotation move with these rates.
   pure real(wp) function least_rate(self, opening_rate, rotation_rate)
      class(fibre_section), intent(in) :: self
      real(wp), intent(in) :: opening_rate, rotation_rate

      least_rate = max(no_layer_rate*(abs(opening_rate) + self%reach*abs(rotation_rate)), least_speed)
   end function least_rate

   !> Move the joint along the chosen path to a rotation (from zero) and an axial load on the present
   !> branches.
   pure subroutine move_to(self, rotation, axial_load, distance, first)
      class(fibre_section), intent(inout) :: self
      !> Rotation, from zero and not from `rest` [rad]; compression positive [N]
      real(wp), intent(in) :: rotation, axial_load
      !> Way there, in units of the rates, negative: back. Only layers without stiffness use it
      real(wp), intent(in) :: distance
      !> The layer that comes to the end of its branch, 0 for none
      integer, intent(in) :: first

      self%rotation = rotation
      self%axial_load = axial_load
      self%on_end = first
      ! Equilibrium gives the opening, unless the layers have next to no stiffness.
      if (self%a > firm*self%stiffness) then
         self%opening = -(axial_load + (self%force_0 + self%s*rotation))/self%a
      else
         self%opening = self%opening + self%opening_rate*distance
      end if
      self%largest = max(self%largest, abs(self%opening) + self%reach*abs(rotation))
      self%moment = self%moment_0 + (self%s*self%opening + self%q*rotation)
   end subroutine move_to

   !> Opening of the joint at the middle at a rotation and an axial load on the present branches [m].
   pure real(wp) function opening_at(self, rotation, axial_load)
      class(fibre_section), intent(in) :: self
      !> Rotation of the joint, counted from `rest` [rad]; compression positive [N]
      real(wp), intent(in) :: rotation, axial_load

      associate (turned => rotation + self%rest - self%rotation)
         if (self%a > no_stiffness*self%stiffness) then
            opening_at = self%opening - (self%s*turned + (axial_load - self%axial_load))/self%a
         else
            ! Layers without stiffness open as on the path that was chosen last.
            opening_at = self%opening
            if (abs(self%rotation_rate) > 0.0_wp) then
               opening_at = opening_at + self%opening_rate/self%rotation_rate*turned
            end if
         end if
      end associate
   end function opening_at

   !> Rate of the opening on the present branches; layers without stiffness open as on the path that was
   !> chosen last.
   pure real(wp) function rate_of_opening(self, rotation_rate, axial_rate) result(opening_rate)
      type(fibre_section), intent(in) :: self
      real(wp), intent(in) :: rotation_rate, axial_rate

      if (self%a > no_stiffness*self%stiffness) then
         opening_rate = -(self%s*rotation_rate + axial_rate)/self%a
      else if (abs(self%rotation_rate) > 0.0_wp) then
         opening_rate = self%opening_rate/self%rotation_rate*rotation_rate
      else
         opening_rate = self%opening_rate
      end if
   end function rate_of_opening

   !> The plane that the joint is on: M = moment + stiffness (phi - rotation) - centre (N - axial load).
   pure subroutine read_plane(self, rotation, axial_load, moment, stiffness, centre)
      class(fibre_section), intent(in) :: self
      !> Rotation [rad], axial load [N] and moment [N m] of a point; slopes k_m [N m/rad] and e [m]
      real(wp), intent(out) :: rotation, axial_load, moment, stiffness, centre
      integer :: i

      rotation = self%rotation - self%rest
      axial_load = self%axial_load
      moment = self%moment
      centre = self%centre
      if (self%a > no_stiffness*self%stiffness) then
         centre = self%s/self%a
      else if (abs(self%rotation_rate) > 0.0_wp) then
         centre = -self%opening_rate/self%rotation_rate
      end if
      stiffness = 0.0_wp
      do i = 1, self%count
         stiffness = stiffness + self%k(i)*(self%y(i) - centre)**2
      end do
      if (abs(stiffness) <= no_stiffness*self%turning) stiffness = 0.0_wp
   end subroutine read_plane

   !> Layers at a point of the present branches, and how they move along a path with given rates.
   pure subroutine motion_of_layers(self, rotation, axial_load, rotation_rate, axial_rate, d, v)
      class(fibre_section), intent(in) :: self
      !> Rotation of the joint, counted from `rest`; axial load, and rates
      real(wp), intent(in) :: rotation, axial_load, rotation_rate, axial_rate
      !> Deformations [m] and their rates (count)
      real(wp), intent(out), contiguous :: d(:), v(:)
      real(wp) :: opening_rate

      opening_rate = rate_of_opening(self, rotation_rate, axial_rate)
      d = self%opening_at(rotation, axial_load) + self%y*(rotation + self%rest)
      v = opening_rate + self%y*rotation_rate
      where (abs(v) <= self%least_rate(opening_rate, rotation_rate)) v = 0.0_wp
   end subroutine motion_of_layers

   !> Put the joint on a point of its present branches that lies ahead on a path with given rates. Its work is
   !> left to the caller.
   pure subroutine put(self, rotation, axial_load, rotation_rate, axial_rate, first)
      class(fibre_section), intent(inout) :: self
      !> Rotation of the joint, counted from `rest`; axial load, and rates
      real(wp), intent(in) :: rotation, axial_load, rotation_rate, axial_rate
      !> The layer that comes exactly to the end of its branch, 0 for none
      integer, intent(in) :: first
      real(wp) :: opening

      opening = self%opening_at(rotation, axial_load)
      self%opening_rate = rate_of_opening(self, rotation_rate, axial_rate)
      self%rotation_rate = rotation_rate
      self%axial_rate = axial_rate
      self%opening = opening
      call self%move_to(rotation + self%rest, axial_load, 0.0_wp, first)
   end subroutine put

   !> Mark the present state, to which `restore` returns. Only layers that change their branches are copied.
   subroutine mark(self)
      class(fibre_section), intent(inout) :: self

      call self%forget()
      self%marked = .true.
      self%kept_state = self%section_state
   end subroutine mark

   !> Drop the mark.
   subroutine forget(self)
      class(fibre_section), intent(inout) :: self
      integer :: j

      do j = 1, self%number_kept
         self%is_kept(self%kept(j)) = .false.
      end do
      self%number_kept = 0
      self%marked = .false.
   end subroutine forget

   !> Save layer i before it is put on a branch for a trial.
   subroutine save_layer(self, i)
      class(fibre_section), intent(inout) :: self
      integer, intent(in) :: i

      self%tried_branch(i) = self%branch(i)
      call copy_memory(self%slot(i), self%tried_slot(i))
   end subroutine save_layer

   !> Put layer i back as `save_layer` has saved it.
   subroutine restore_layer(self, i)
      class(fibre_section), intent(inout) :: self
      integer, intent(in) :: i

      self%branch(i) = self%tried_branch(i)
      call copy_memory(self%tried_slot(i), self%slot(i))
      call put_branch(self, i)
   end subroutine restore_layer

   !> Return to the mark, to the last bit. The mark stays.
   subroutine restore(self)
      class(fibre_section), intent(inout) :: self
      integer :: i, j

      do j = 1, self%number_kept
         i = self%kept(j)
         self%branch(i) = self%kept_branch(j)
         call copy_memory(self%kept_slot(i), self%slot(i))
         call put_branch(self, i)
         self%is_kept(i) = .false.
      end do
      self%number_kept = 0
      self%section_state = self%kept_state
   end subroutine restore

   !> Save or restore the state and the layers; the arrays of the branches follow from these.
   pure subroutine serialize(self, stream)
      class(fibre_section), intent(inout) :: self
      type(stream_type), intent(inout) :: stream
      integer :: i

      call stream%items(self%rest, self%rotation, self%axial_load, self%opening)
      call stream%item(self%on_end)
      call stream%items(self%largest, self%a, self%s, self%q, self%force_0, self%moment_0, self%moment)
      call stream%items(self%rotation_rate, self%axial_rate, self%opening_rate, self%ends%ahead, &
                        self%ends%behind)
      call stream%item(self%ends%first_ahead)
      call stream%item(self%ends%first_behind)
      call stream%item(self%ends%unload_on_reversal)
      call stream%item(self%ends%stiffness)
      call stream%item(self%failed)
      call stream%item(self%failure_direction)
      do i = 1, self%count
         call self%branch(i)%serialize(stream)
         call self%slot(i)%memory%serialize(stream)
         if (stream%restoring) call put_branch(self, i)
      end do
   end subroutine serialize

end module rbs_hysteresis_layered_fibre_section
