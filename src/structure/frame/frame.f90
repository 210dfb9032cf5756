!> A planar frame: nodes with displacements along x and upward and clockwise rotations, and elements between
!> them, whose inside is condensed to their ends.
!>
!> The springs of the elements come first, then one from the ground to each unknown: soil, a brace, a
!> bearing, or one of no account, whose deformation is the displacement.
module rbs_structure_frame_frame
   use rbs_base_check, only: is_given
   use rbs_base_error, only: error_type, fatal_error, bad_input
   use rbs_base_inner_product, only: inner_product
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_springs, only: spring_array
   use rbs_structure_channel, only: channel_type, response_type, row_contents
   use rbs_structure_frame_element, only: frame_element, find_forces, find_rates, find_tangent, tangent_size
   use rbs_structure_frame_frame_record, only: name_length
   use rbs_structure_frame_layered, only: drop_small_rates, joint_motion, layered_forces, layered_rates, &
                                          layered_tangent
   use rbs_structure_spring_place, only: shear, flexure, axial
   use rbs_structure_structure, only: structure_type, motion_result, lateral, horizontal, signals, top_axial
   implicit none
   private

   public :: frame_type, frame_channel

   !> What rows of a frame hold besides what all structures have: displacements of the nodes along x and
   !> upward and clockwise rotations; axial forces of the members (compression positive) and moments of their
   !> ends; deformations and forces of their springs by kind, in the order of the members; on demand
   !> accelerations of the nodes along x relative to the ground, and that of the ground; 1 for members that
   !> were lost, where any may be.
   type(channel_type), parameter :: frame_channel(16) = [ &
      channel_type('base_shear', 'N'), channel_type('x', 'm'), channel_type('y', 'm'), &
      channel_type('turn', 'rad'), channel_type('member_axial', 'N'), channel_type('moment_from', 'N m'), &
      channel_type('moment_to', 'N m'), channel_type('slip', 'm'), channel_type('shear', 'N'), &
      channel_type('rotation', 'rad'), channel_type('moment', 'N m'), channel_type('opening', 'm'), &
      channel_type('axial_force', 'N'), channel_type('node_acceleration', 'm/s2'), &
      channel_type('ground_acceleration', 'm/s2'), channel_type('lost', '')]

   !> Share of the terms of a rate that it is round-off below.
   real(wp), parameter :: round_off = 1.0e-12_wp

   !> Share of the terms of all elements that counts as those of any.
   real(wp), parameter :: of_all = 0.01_wp

   !> Share of the height of a storey that a node may sink.
   real(wp), parameter :: deepest = 0.1_wp

   !> A rotation that no hinge of a frame has [rad].
   real(wp), parameter :: farthest = 10.0_wp

   !> Times that differ by less than this share are the same.
   real(wp), parameter :: same_time = 1.0e-9_wp

   type :: spring_list
      integer, allocatable :: spring(:)
   end type spring_list

   type, extends(structure_type) :: frame_type
      type(frame_element), allocatable :: element(:)
      !> Names, floors of the grid (-1 for nodes that are none of it) and places [m] of the nodes (nodes), and
      !> names of the members
      character(len=name_length), allocatable :: node_name(:), member_name(:)
      integer, allocatable :: storey(:)
      real(wp), allocatable :: x(:), y(:)
      !> Share of the displacement of a node in the drifts of the storeys below and above it (2, nodes) [1/m]
      real(wp), allocatable :: storey_share(:, :)
      !> Where the springs of the members are, in shares of the clear length (inside)
      real(wp), allocatable :: spring_place(:)
      !> Whether a spring is the first layer of a joint (inside)
      logical, allocatable :: heads(:)
      !> Springs that rows tell, by kind; of a joint of layers the first one where it rotates and opens
      type(spring_list) :: listed(3)
      !> Number of the unknown of each displacement, 0 where a support holds it (3, nodes)
      integer, allocatable :: number(:, :)
      !> The same of the rotation of the beams, where a panel lets them turn against columns; else 0 (nodes)
      integer, allocatable :: beam_rotation(:)
      !> Number of members; elements behind them are panels of nodes
      integer :: members = 0
      !> Number of springs in elements
      integer :: inside = 0
      !> Dead loads on the unknowns (unknowns), and on the springs of elements whose ends do not move (inside)
      real(wp), allocatable :: dead(:), dead_force(:)
      !> Dead load across the elements [N/m] (elements), and rotations of the ends of their elastic rest under
      !> it (2, elements)
      real(wp), allocatable :: load_across(:), dead_rotation(:, :)
      !> Compression of the elements under dead load [N] (elements)
      real(wp), allocatable :: compression(:)
      !> When members are lost, see `frame_member` (members)
      real(wp), allocatable :: failure_drift(:), failure_load(:), shear_drift(:), lost_at(:)
      logical :: may_lose = .false.
      !> Rigid ends and clear length (3, elements) [m]
      real(wp), allocatable :: lengths(:, :)
   contains
      procedure :: linearise
      procedure :: damp
      procedure :: add_damping
      procedure :: unknown_forces
      procedure :: work_of_dead_load
      procedure :: is_loaded
      procedure :: take_load_off
      procedure :: set_compression
      procedure :: press
      procedure :: basic
      procedure :: drop_round_off
      procedure :: size_of_parts
      procedure :: end_forces
      procedure :: add_element
      procedure :: spring_rates
      procedure :: unknown_rates
      procedure :: forces
      procedure :: axial_forces
      procedure :: add_stiffness
      procedure :: add_geometric
      procedure :: rotations
      procedure :: storey_drifts
      procedure :: potential_energy
      procedure :: axial_rate
      procedure :: acceleration_scale
      procedure :: channels
      procedure :: fill_row
      procedure :: base_force
      procedure :: accelerations
      procedure :: check_loads
      procedure :: find_lost
      procedure :: let_go
      procedure :: has_fallen
      procedure :: find_runaway
   end type frame_type

contains

   !> Tangents of the elements on lines of the springs.
   subroutine linearise(self, k, tangent, unstable)
      class(frame_type), intent(in) :: self
      !> Stiffness of the springs (springs)
      real(wp), intent(in), contiguous :: k(:)
      !> Zero or the last ones: elements whose springs have the same stiffness keep theirs (tangent_numbers)
      real(wp), intent(inout), contiguous :: tangent(:)
      !> An element that snaps back; 0: none
      integer, intent(out) :: unstable

      call find_tangents(self, self%inside, k, self%initial_stiffness, tangent, unstable)
   end subroutine linearise

   subroutine find_tangents(frame, springs, k, k0, tangent, unstable)
      type(frame_type), intent(in) :: frame
      integer, intent(in) :: springs
      real(wp), intent(in) :: k(springs + 1), k0(springs + 1)
      real(wp), intent(inout) :: tangent(frame%tangent_numbers)
      integer, intent(out) :: unstable
      integer :: i, at, first, of
      logical :: stable

      unstable = 0
      do i = 1, size(frame%element)
         associate (e => frame%element(i), m => frame%element(i)%bending, n => frame%element(i)%opening)
            at = e%at + 9 + 3*(m + n)
            first = e%before + 1
            of = at + m**2 + n**2
            if (e%layered) of = e%at + tangent_size(e) - (m + n)
            if (is_of(m + n, tangent(of), k(first), k0(first))) cycle
            if (i > frame%members) then
               call find_panel(k(first), tangent(e%at), tangent(e%at + 9), tangent(at))
               call remember(1, tangent(of), k(first), k0(first))
               cycle
            end if
            if (e%layered) then
               call layered_tangent(e, m + n, k(first), k0(first), tangent(e%at), tangent(e%at + 9), stable)
            else
               call find_tangent(e, m, n, k(first), k0(first), tangent(e%at), tangent(e%at + 9), &
                                 tangent(at), tangent(at + m**2), stable)
            end if
            call remember(m + n, tangent(of), k(first), k0(first))
            ! That it snaps back is to be found again.
            if (.not. stable .and. m + n > 0) tangent(of) = huge(1.0_wp)
         end associate
         if (.not. stable) unstable = i
      end do

   contains

      !> Whether a tangent belongs to a stiffness; with the initial one a new array belongs to none.
      pure logical function is_of(springs, known, k, k0)
         integer, intent(in) :: springs
         real(wp), intent(in) :: known(springs), k(springs), k0(springs)
         real(wp) :: most
         integer :: j

         most = 0.0_wp
         !$omp simd reduction(max:most)
         do j = 1, springs
            most = max(most, abs(known(j) - (k(j) + k0(j))))
         end do
         is_of = springs > 0 .and. .not. most > 0.0_wp
      end function is_of

      pure subroutine remember(springs, known, k, k0)
         integer, intent(in) :: springs
         real(wp), intent(out) :: known(springs)
         real(wp), intent(in) :: k(springs), k0(springs)

         known = k + k0
      end subroutine remember

      !> The spring of a panel does what the nodes do.
      pure subroutine find_panel(k, stiffness, rate, opened)
         real(wp), intent(in) :: k
         real(wp), intent(out) :: stiffness(9), rate(3), opened

         stiffness = 0.0_wp
         stiffness(1) = k
         rate = [1.0_wp, 0.0_wp, 0.0_wp]
         opened = 0.0_wp
      end subroutine find_panel
   end subroutine find_tangents

   !> Elongation and rotations of an element from the unknowns, or changes of them; of a panel, the rotation
   !> of its columns against its beams.
   pure function basic(self, element, x) result(q)
      class(frame_type), intent(in) :: self
      integer, intent(in) :: element
      real(wp), intent(in), contiguous :: x(:)
      real(wp) :: q(3)

      associate (b => self%element(element)%from_unknowns, at => self%element(element)%unknown)
         if (element > self%members) then
            q = [b(1, 3)*x(at(3)) + b(1, 6)*x(at(6)), 0.0_wp, 0.0_wp]
         else
            q = b(:, 1)*x(at(1)) + b(:, 2)*x(at(2)) + b(:, 3)*x(at(3)) &
                + b(:, 4)*x(at(4)) + b(:, 5)*x(at(5)) + b(:, 6)*x(at(6))
         end if
      end associate
   end function basic

   !> Add what axial force and moments of the ends of an element do on the unknowns.
   pure subroutine add_element(self, element, s, g)
      class(frame_type), intent(in) :: self
      integer, intent(in) :: element
      real(wp), intent(in) :: s(3)
      real(wp), intent(inout) :: g(:)
      integer :: k

      associate (e => self%element(element))
         if (element > self%members) then
            g(e%unknown(3)) = g(e%unknown(3)) + s(1)*e%from_unknowns(1, 3)
            g(e%unknown(6)) = g(e%unknown(6)) + s(1)*e%from_unknowns(1, 6)
            return
         end if
         do k = 1, 6
            g(e%unknown(k)) = g(e%unknown(k)) + (s(1)*e%from_unknowns(1, k) + s(2)*e%from_unknowns(2, k) &
                                                 + s(3)*e%from_unknowns(3, k))
         end do
      end associate
   end subroutine add_element

   !> What the springs of an element miss to add up to the motion of its ends.
   pure function gap_of(frame, element, q, d, dead) result(gap)
      type(frame_type), intent(in) :: frame
      integer, intent(in) :: element
      real(wp), intent(in) :: q(3), dead
      real(wp), intent(in), contiguous :: d(:)
      real(wp) :: gap(3)
      real(wp) :: z(2)
      integer :: j

      gap = q
      associate (e => frame%element(element))
         gap(2) = gap(2) - dead*frame%dead_rotation(1, element)
         gap(3) = gap(3) - dead*frame%dead_rotation(2, element)
         if (e%layered) then
            do j = 1, size(e%first) - 1
               z = joint_motion(e, j, size(e%y), d(e%before + 1:e%before + size(e%y)))
               gap = gap - (e%arm(:, 1, j)*z(1) + e%arm(:, 2, j)*z(2))
            end do
            return
         end if
         do j = 1, e%bending
            gap(2) = gap(2) - e%share(1, j)*d(e%before + j)
            gap(3) = gap(3) - e%share(2, j)*d(e%before + j)
         end do
         do j = e%bending + 1, e%bending + e%opening
            gap(1) = gap(1) - d(e%before + j)
         end do
      end associate
   end function gap_of

   !> Forces of the ends of an element in equilibrium with its springs, and the corrections that these need.
   pure subroutine end_forces(self, element, q, d, f, dead, tangent, s, correction)
      class(frame_type), intent(in) :: self
      integer, intent(in) :: element
      !> Elongation and rotations of the ends; deformations and forces of all springs
      real(wp), intent(in) :: q(3)
      real(wp), intent(in), contiguous :: d(:), f(:)
      !> Share of the dead load that acts
      real(wp), intent(in) :: dead
      real(wp), intent(in), contiguous :: tangent(:)
      real(wp), intent(out) :: s(3)
      !> Of the deformations of all springs (springs)
      real(wp), intent(inout), contiguous :: correction(:)

      call balance_ends(self, self%element(element), size(d), self%tangent_numbers, &
                        gap_of(self, element, q, d, dead), dead, d, f, tangent, s, correction)
   end subroutine end_forces

   pure subroutine balance_ends(frame, e, springs, numbers, gap, dead, d, f, tangent, s, correction)
      type(frame_type), intent(in) :: frame
      type(frame_element), intent(in) :: e
      integer, intent(in) :: springs, numbers
      real(wp), intent(in) :: gap(3), dead, d(springs), f(springs), tangent(numbers)
      real(wp), intent(out) :: s(3)
      real(wp), intent(inout) :: correction(springs)
      integer :: at

      associate (m => e%bending, n => e%opening, first => e%before + 1, &
                 last => e%before + e%bending + e%opening)
         if (e%layered) then
            call layered_forces(e, m + n, tangent(e%at), tangent(e%at + 9), gap, d(first), f(first), dead, &
                                frame%dead_force(first:last), s, correction(first))
            return
         end if
         at = e%at + 9 + 3*(m + n)
         call find_forces(m, n, tangent(e%at), tangent(e%at + 9), tangent(at), tangent(at + m**2), gap, &
                          f(first), dead, frame%dead_force(first:last), s, correction(first))
      end associate
   end subroutine balance_ends

   pure logical function is_loaded(self)
      class(frame_type), intent(in) :: self

      is_loaded = any(abs(self%dead) > 0.0_wp) .or. any(abs(self%dead_force) > 0.0_wp) .or. &
                  any(abs(self%dead_rotation) > 0.0_wp)
   end function is_loaded

   pure subroutine take_load_off(self)
      class(frame_type), intent(inout) :: self

      self%dead = 0.0_wp
      self%dead_force = 0.0_wp
      self%dead_rotation = 0.0_wp
   end subroutine take_load_off

   !> Take the axial forces of the elements under dead load.
   subroutine set_compression(self, d, f)
      class(frame_type), intent(inout) :: self
      !> Deformations and forces of the springs (springs)
      real(wp), intent(in), contiguous :: d(:), f(:)
      real(wp) :: s(3), correction(size(d))
      integer :: i

      do i = 1, self%members
         call self%end_forces(i, self%basic(i, d(self%inside + 1:)), d, f, 1.0_wp, self%initial_tangent, s, &
                              correction)
         call self%press(i, -s(1))
         ! Springs that open carry it by the path, not from its begin on.
         associate (e => self%element(i))
            self%constant_axial(e%before + 1:e%before + e%bending) = -s(1)
         end associate
      end do
      self%initial_tangent = 0.0_wp
      call self%linearise(self%initial_stiffness, self%initial_tangent, i)
   end subroutine set_compression

   !> Put an axial force that does second-order work on an element.
   pure subroutine press(self, element, compression)
      class(frame_type), intent(inout) :: self
      integer, intent(in) :: element
      !> [N]
      real(wp), intent(in) :: compression

      self%compression(element) = compression
      call self%element(element)%set_rest(merge(compression, 0.0_wp, self%axially_loaded), &
                                          self%load_across(element), self%dead_rotation(:, element))
   end subroutine press

   !> Work of the dead load.
   pure real(wp) function work_of_dead_load(self, d) result(work)
      class(frame_type), intent(in) :: self
      real(wp), intent(in), contiguous :: d(:)
      real(wp) :: gap(3), turned(2)
      integer :: i

      associate (x => d(self%inside + 1:))
         work = sum(self%dead*x) + sum(self%dead_force*d(:self%inside))
         do i = 1, size(self%element)
            associate (e => self%element(i))
               if (.not. allocated(e%rest)) cycle
               gap = gap_of(self, i, self%basic(i, x), d, 0.0_wp)
               turned = self%dead_rotation(:, i)
               work = work + 0.25_wp*(e%rest(1)*sum(turned)*sum(gap(2:)) &
                                    + e%rest(2)*(turned(1) - turned(2))*(gap(2) - gap(3)))
            end associate
         end do
      end associate
   end function work_of_dead_load

   !> Stiffness of the elements, from their tangents, and of the ground.
   subroutine add_stiffness(self, k, tangent, band)
      class(frame_type), intent(in) :: self
      !> Of the springs (springs)
      real(wp), intent(in), contiguous :: k(:), tangent(:)
      real(wp), intent(inout), contiguous :: band(:, :)
      integer :: i

      do i = 1, size(self%element)
         associate (at => self%element(i)%at)
            call add_product(self, i, tangent(at:at + 8), band)
         end associate
      end do
      band(1, :) = band(1, :) + k(self%inside + 1:)
   end subroutine add_stiffness

   !> Add B' A B of an element, B its elongation and rotations per unknown.
   pure subroutine add_product(self, element, a, band)
      type(frame_type), intent(in) :: self
      integer, intent(in) :: element
      real(wp), intent(in) :: a(3, 3)
      real(wp), intent(inout), contiguous :: band(:, :)
      real(wp) :: row(3)
      integer :: number(6), i, j

      associate (e => self%element(element))
         number = e%number
         do j = 1, 6
            if (number(j) == 0) cycle
            row = a(:, 1)*e%to_basic(1, j) + a(:, 2)*e%to_basic(2, j) + a(:, 3)*e%to_basic(3, j)
            do i = 1, 6
               if (number(i) < number(j)) cycle
               band(1 + number(i) - number(j), number(j)) = band(1 + number(i) - number(j), number(j)) &
                                                            + sum(e%to_basic(:, i)*row)
            end do
         end do
      end associate
   end subroutine add_product

   !> Damping of the modes, and in proportion to the stiffness of the elements, initial or present.
   subroutine damp(self, v, tangent, g)
      class(frame_type), intent(in) :: self
      real(wp), intent(in), contiguous :: v(:), tangent(:)
      real(wp), intent(inout), contiguous :: g(:)
      real(wp) :: a(9), q(3)
      integer :: i

      if (allocated(self%modal_momenta)) then
         do i = 1, size(self%modal_momenta, 2)
            g = g - self%modal_momenta(:, i)*inner_product(size(v), self%modal_momenta(:, i), v)
         end do
      end if
      if (.not. self%stiffness_damping > 0.0_wp) return
      do i = 1, self%members
         call damping_of(self, i, tangent, a)
         q = self%basic(i, v)
         call self%add_element(i, -(a(:3)*q(1) + a(4:6)*q(2) + a(7:)*q(3)), g)
      end do
      do i = self%members + 1, size(self%element)
         call damping_of(self, i, tangent, a)
         q = self%basic(i, v)
         call self%add_element(i, -a(:3)*q(1), g)
      end do
   end subroutine damp

   subroutine add_damping(self, factor, tangent, band)
      class(frame_type), intent(in) :: self
      real(wp), intent(in) :: factor
      real(wp), intent(in), contiguous :: tangent(:)
      real(wp), intent(inout), contiguous :: band(:, :)
      real(wp) :: a(9)
      integer :: i

      do i = 1, size(self%element)
         call damping_of(self, i, tangent, a)
         call add_product(self, i, factor*a, band)
      end do
   end subroutine add_damping

   pure subroutine damping_of(frame, element, tangent, a)
      type(frame_type), intent(in) :: frame
      integer, intent(in) :: element
      real(wp), intent(in) :: tangent(:)
      real(wp), intent(out) :: a(9)

      associate (at => frame%element(element)%at)
         if (frame%tangent_damping) then
            a = frame%stiffness_damping*tangent(at:at + 8)
         else
            a = frame%stiffness_damping*frame%initial_tangent(at:at + 8)
         end if
      end associate
   end subroutine damping_of

   !> Changes of the deformations from those of the unknowns.
   subroutine spring_rates(self, tangent, dx, dd)
      class(frame_type), intent(in) :: self
      real(wp), intent(in), contiguous :: tangent(:), dx(:)
      real(wp), intent(out), contiguous :: dd(:)
      real(wp) :: q(3)
      integer :: i

      do i = 1, self%members
         q = self%basic(i, dx)
         call turn_springs(self%element(i), size(dd), self%tangent_numbers, tangent, q, dd)
      end do
      do i = self%members + 1, size(self%element)
         q = self%basic(i, dx)
         dd(self%element(i)%before + 1) = q(1)
      end do
      dd(self%inside + 1:) = dx
   end subroutine spring_rates

   pure subroutine turn_springs(e, springs, numbers, tangent, q, dd)
      type(frame_element), intent(in) :: e
      integer, intent(in) :: springs, numbers
      real(wp), intent(in) :: tangent(numbers), q(3)
      real(wp), intent(inout) :: dd(springs)

      associate (first => e%before + 1, last => e%before + e%bending + e%opening)
         if (e%layered) then
            call layered_rates(e, size(e%y), tangent(e%at), tangent(e%at + 9), q, dd(first:last))
         else
            call find_rates(e%bending + e%opening, tangent(e%at + 9), q, dd(first:last))
         end if
      end associate
   end subroutine turn_springs

   !> Take rates that are round-off of larger ones for zero: a spring that stands still on a corner of its
   !> curve, as in a mechanism beside it, must not be sent either way. Larger ones are those of the ends of
   !> its element, and of all elements, as displacements are round-off of each other.
   pure subroutine drop_round_off(self, tangent, dx, dd)
      class(frame_type), intent(in) :: self
      real(wp), intent(in), contiguous :: tangent(:), dx(:)
      real(wp), intent(inout), contiguous :: dd(:)
      real(wp) :: largest(3), size_of(3)
      integer :: i

      largest = 0.0_wp
      do i = 1, size(self%element)
         largest = max(largest, terms_of(self%element(i), dx))
      end do
      do i = 1, size(self%element)
         associate (e => self%element(i))
            size_of = terms_of(e, dx)
            ! The share of a layer in a motion may be as small without being round-off.
            if (.not. e%layered) size_of = max(size_of, of_all*largest)
            call drop_small(e, size(dd), self%tangent_numbers, tangent, size_of, dd)
         end associate
      end do

   end subroutine drop_round_off

   !> Sizes of the terms that elongation and rotations of an element are sums of.
   pure function terms_of(e, x) result(terms)
      type(frame_element), intent(in) :: e
      !> Displacements of the nodes (unknowns)
      real(wp), intent(in) :: x(:)
      real(wp) :: terms(3)
      integer :: k

      terms = 0.0_wp
      do k = 1, 6
         if (e%number(k) > 0) terms = terms + abs(e%to_basic(:, k)*x(e%number(k)))
      end do
   end function terms_of

   !> Largest force of elements and dead loads, and the largest force and the work of elements that are
   !> sums of terms of one sign; moments over the height.
   subroutine size_of_parts(self, springs, least, force, terms, work)
      class(frame_type), intent(in) :: self
      type(spring_array), intent(in) :: springs
      real(wp), intent(in) :: least
      real(wp), intent(out) :: force, terms, work
      real(wp) :: s(3), q(3), to_force(3)
      integer :: i

      to_force = [1.0_wp, 1.0_wp/self%total_height, 1.0_wp/self%total_height]
      force = maxval(abs(self%dead)/self%reach)
      terms = 0.0_wp
      work = 0.0_wp
      associate (x => springs%d(self%inside + 1:))
         do i = 1, size(self%element)
            associate (e => self%element(i))
               if (i <= self%members) then
                  call find_ends(self, i, springs, s)
                  force = max(force, maxval(abs(s)*to_force))
               end if
               q = terms_of(e, max(abs(x), least*self%total_height/self%reach))
               s = matmul(abs(reshape(self%initial_tangent(e%at:e%at + 8), [3, 3])), q)
               terms = max(terms, maxval(s*to_force))
               work = work + sum(s*q)
            end associate
         end do
      end associate
   end subroutine size_of_parts

   pure subroutine drop_small(e, springs, numbers, tangent, size_of, dd)
      type(frame_element), intent(in) :: e
      integer, intent(in) :: springs, numbers
      real(wp), intent(in) :: tangent(numbers), size_of(3)
      real(wp), intent(inout) :: dd(springs)
      integer :: at, j

      associate (first => e%before + 1, last => e%before + e%bending + e%opening)
         if (e%layered) then
            call drop_small_rates(e, size(e%y), tangent(e%at), tangent(e%at + 9), size_of, round_off, &
                                  dd(first:last))
            return
         end if
         do j = first, last
            at = e%at + 6 + 3*(j - e%before)
            if (abs(dd(j)) < round_off*sum(abs(tangent(at:at + 2))*size_of)) dd(j) = 0.0_wp
         end do
      end associate
   end subroutine drop_small

   pure subroutine unknown_rates(self, dd, dx)
      class(frame_type), intent(in) :: self
      real(wp), intent(in), contiguous :: dd(:)
      real(wp), intent(out), contiguous :: dx(:)

      dx = dd(self%inside + 1:)
   end subroutine unknown_rates

   !> Forces on the unknowns under all dead load and the lateral one.
   subroutine forces(self, d, load, axial, tangent, f, g, correction)
      class(frame_type), intent(in) :: self
      real(wp), intent(in), contiguous :: d(:), load(:), axial(:), tangent(:)
      real(wp), intent(inout), contiguous :: f(:)
      real(wp), intent(out), contiguous :: g(:)
      real(wp), intent(inout), contiguous :: correction(:)

      call self%unknown_forces(d, f, 1.0_wp, tangent, g, correction)
      ! The axial forces are those of the dead load.
      if (size(axial) >= 0) g = g + load(lateral)*self%pattern(lateral)%force
   end subroutine forces

   !> Forces on the unknowns: dead load less what springs and elastic rest carry, and second-order forces;
   !> corrections of the deformations that bring the inside of the elements to equilibrium.
   subroutine unknown_forces(self, d, f, dead, tangent, g, correction)
      class(frame_type), intent(in) :: self
      real(wp), intent(in), contiguous :: d(:), f(:)
      !> Share of the dead load that acts
      real(wp), intent(in) :: dead
      real(wp), intent(in), contiguous :: tangent(:)
      real(wp), intent(out), contiguous :: g(:), correction(:)
      real(wp) :: s(3), q(3)
      integer :: i

      associate (x => d(self%inside + 1:))
         g = dead*self%dead - f(self%inside + 1:)
         correction = 0.0_wp
         do i = 1, self%members
            q = self%basic(i, x)
            call self%end_forces(i, q, d, f, dead, tangent, s, correction)
            call self%add_element(i, -s, g)
            if (self%axially_loaded) call add_second_order(self, i, x, g)
         end do
         do i = self%members + 1, size(self%element)
            associate (at => self%element(i)%at, spring => self%element(i)%before + 1)
               q = self%basic(i, x)
               correction(spring) = q(1) - d(spring)
               s = [f(spring) + tangent(at)*correction(spring), 0.0_wp, 0.0_wp]
               call self%add_element(i, -s, g)
            end associate
         end do
      end associate
   end subroutine unknown_forces

   !> Second-order forces of the compression of an element, N sum l r (r . x): rows r are the rotations of its
   !> rigid ends and of its chord. What bends off the chord is in the elastic rest.
   pure subroutine add_second_order(self, element, x, g)
      class(frame_type), intent(in) :: self
      integer, intent(in) :: element
      real(wp), intent(in), contiguous :: x(:)
      real(wp), intent(inout), contiguous :: g(:)
      real(wp) :: turn
      integer :: j

      associate (e => self%element(element), length => self%lengths(:, element), &
                 press => self%compression(element))
         do j = 1, 2
            associate (at => e%number(3*j))
               if (length(j) > 0.0_wp .and. at > 0) g(at) = g(at) + press*length(j)*x(at)
            end associate
         end do
         turn = press*length(3)*chord_rotation(e, x)
         do j = 1, 6
            g(e%unknown(j)) = g(e%unknown(j)) + turn*e%chord(j)
         end do
      end associate
   end subroutine add_second_order

   pure real(wp) function chord_rotation(e, x) result(rotation)
      type(frame_element), intent(in) :: e
      real(wp), intent(in), contiguous :: x(:)
      integer :: j

      rotation = 0.0_wp
      do j = 1, 6
         rotation = rotation + e%chord(j)*x(e%unknown(j))
      end do
   end function chord_rotation

   subroutine axial_forces(self, load, axial)
      class(frame_type), intent(in) :: self
      real(wp), intent(in), contiguous :: load(:)
      real(wp), intent(out), contiguous :: axial(:)

      axial = self%compression(:size(axial))
      if (size(load) < 0) axial = 0.0_wp
   end subroutine axial_forces

   !> Add the derivatives of these forces, with their sign turned.
   subroutine add_geometric(self, k, band)
      class(frame_type), intent(in) :: self
      real(wp), intent(in), contiguous :: k(:)
      real(wp), intent(inout), contiguous :: band(:, :)
      integer :: i, j, m

      do m = 1, self%members
         associate (e => self%element(m), length => self%lengths(:, m))
            do j = 1, 2
               associate (at => e%number(3*j))
                  if (at > 0) band(1, at) = band(1, at) - k(m)*length(j)
               end associate
            end do
            do j = 1, 6
               associate (column => e%number(j))
                  if (column == 0) cycle
                  do i = 1, 6
                     if (e%number(i) < column) cycle
                     associate (entry => band(1 + e%number(i) - column, column))
                        entry = entry - k(m)*length(3)*e%chord(i)*e%chord(j)
                     end associate
                  end do
               end associate
            end do
         end associate
      end do
   end subroutine add_geometric

   pure subroutine rotations(self, d, rotation)
      class(frame_type), intent(in) :: self
      real(wp), intent(in), contiguous :: d(:)
      real(wp), intent(out), contiguous :: rotation(:)
      integer :: i

      do i = 1, self%n
         rotation(i) = 0.0_wp
         if (self%number(3, i) > 0) rotation(i) = d(self%inside + self%number(3, i))
      end do
   end subroutine rotations

   !> Differences of the displacements of the floors, mean of their nodes, over the heights.
   pure subroutine storey_drifts(self, d, drift)
      class(frame_type), intent(in) :: self
      real(wp), intent(in), contiguous :: d(:)
      real(wp), intent(out), contiguous :: drift(:)
      integer :: i

      drift = 0.0_wp
      do i = 1, self%n
         if (self%number(1, i) == 0) cycle
         associate (floor => self%storey(i), x => d(self%inside + self%number(1, i)))
            if (floor > 0) drift(floor) = drift(floor) + self%storey_share(1, i)*x
            if (floor >= 0 .and. floor < self%storeys) then
               drift(floor + 1) = drift(floor + 1) + self%storey_share(2, i)*x
            end if
         end associate
      end do
   end subroutine storey_drifts

   !> Of dead load and second-order work, and energy of what is elastic.
   pure real(wp) function potential_energy(self, d) result(energy)
      class(frame_type), intent(in) :: self
      real(wp), intent(in), contiguous :: d(:)
      real(wp) :: gap(3), g(self%unknowns)
      integer :: i

      associate (x => d(self%inside + 1:))
         g = 0.0_wp
         energy = -sum(self%dead*x) - sum(self%dead_force*d(:self%inside))
         do i = 1, self%members
            gap = gap_of(self, i, self%basic(i, x), d, 1.0_wp)
            energy = energy + energy_of_rest(self%element(i), gap)
            if (self%axially_loaded) call add_second_order(self, i, x, g)
         end do
         energy = energy - 0.5_wp*sum(g*x)
      end associate
   end function potential_energy

   pure real(wp) function axial_rate(self, spring, load)
      class(frame_type), intent(in) :: self
      integer, intent(in) :: spring
      real(wp), intent(in) :: load(:)

      axial_rate = 0.0_wp*(self%height + spring + sum(load))
   end function axial_rate

   pure real(wp) function acceleration_scale(self, spring, springs, load) result(scale)
      class(frame_type), intent(in) :: self
      integer, intent(in) :: spring
      type(spring_array), intent(in) :: springs
      real(wp), intent(in) :: load(:)

      scale = abs(springs%force(spring))/maxval(self%inertias) + abs(load(horizontal))
   end function acceleration_scale

   !> Displacements of the nodes, forces of the members, deformations and forces of their springs by kind.
   pure subroutine channels(self, contents, channel)
      class(frame_type), intent(in) :: self
      type(row_contents), intent(in) :: contents
      type(channel_type), allocatable, intent(out) :: channel(:)
      logical :: held(size(frame_channel))
      integer :: kind, m

      m = self%members
      held = .true.
      held(14:15) = contents%motion
      held(16) = self%may_lose
      channel = frame_channel
      channel(2:4)%count = self%n
      channel(5:7)%count = m
      do kind = 1, 3
         held(6 + 2*kind:7 + 2*kind) = size(self%listed(kind)%spring) > 0
         channel(6 + 2*kind:7 + 2*kind)%count = size(self%listed(kind)%spring)
      end do
      channel(14)%count = self%n
      channel(16)%count = m
      channel = pack(channel, held)
   end subroutine channels

   pure subroutine fill_row(self, contents, response, springs, d, row)
      class(frame_type), intent(in) :: self
      type(row_contents), intent(in) :: contents
      type(response_type), intent(in) :: response
      type(spring_array), intent(in) :: springs
      real(wp), intent(in), contiguous :: d(:)
      real(wp), intent(out), contiguous :: row(:)
      real(wp) :: f(size(d)), s(3), correction(size(d))
      integer :: at, i, j, kind, m

      f = springs%f0 + springs%k*(d - springs%d0)
      row(1) = self%base_force(d, f)
      if (contents%in_time .and. self%damped) row(1) = response%base_shear
      row(2:3*self%n + 1) = 0.0_wp
      do i = 1, self%n
         do j = 1, 3
            if (self%number(j, i) > 0) row(1 + (j - 1)*self%n + i) = d(self%inside + self%number(j, i))
         end do
      end do
      at = 1 + 3*self%n
      m = self%members
      do i = 1, m
         call self%end_forces(i, self%basic(i, d(self%inside + 1:)), d, f, 1.0_wp, self%initial_tangent, s, &
                              correction)
         ! Compression is positive, as everywhere.
         row(at + i) = -s(1)
         row(at + m + i) = s(2)
         row(at + 2*m + i) = s(3)
      end do
      at = at + 3*m
      do kind = 1, 3
         associate (of => self%listed(kind)%spring)
            do j = 1, size(of)
               call tell_spring(self, kind, of(j), d, f, row(at + j), row(at + size(of) + j))
            end do
            at = at + 2*size(of)
         end associate
      end do
      if (contents%motion) then
         row(at + 1:at + self%n) = 0.0_wp
         do i = 1, self%n
            if (self%number(1, i) > 0) row(at + i) = response%a(self%inside + self%number(1, i))
         end do
         at = at + self%n + 1
         row(at) = response%ground
      end if
      if (.not. self%may_lose) return
      do i = 1, m
         row(at + i) = merge(1.0_wp, 0.0_wp, is_lost(self, i, springs))
      end do
   end subroutine fill_row

   !> Deformation and force of a spring; of a joint of layers rotation and moment, or opening and axial force.
   pure subroutine tell_spring(self, kind, spring, d, f, deformation, force)
      type(frame_type), intent(in) :: self
      !> Kind that is told, and the spring, of a joint its first layer
      integer, intent(in) :: kind, spring
      real(wp), intent(in), contiguous :: d(:), f(:)
      real(wp), intent(out) :: deformation, force
      real(wp) :: z(2)
      integer :: j, last

      deformation = d(spring)
      force = f(spring)
      if (.not. self%heads(spring)) return
      associate (e => self%element(self%place(spring)%member), joint => self%place(spring)%joint)
         z = joint_motion(e, joint, size(e%y), d(e%before + 1:e%before + size(e%y)))
         last = e%before + e%first(joint + 1) - 1
         if (kind == axial) then
            deformation = z(1)
            force = sum(f(spring:last))
         else
            deformation = z(2)
            j = spring - e%before
            force = sum(f(spring:last)*e%y(j:j + last - spring))
         end if
      end associate
   end subroutine tell_spring

   !> What supports and springs from the ground hold the frame with along x [N].
   pure real(wp) function base_force(self, d, f) result(force)
      class(frame_type), intent(in) :: self
      real(wp), intent(in), contiguous :: d(:), f(:)
      real(wp) :: s(3), correction(size(d))
      integer :: i, j

      force = 0.0_wp
      do i = 1, self%members
         associate (e => self%element(i))
            if (all(self%number(1, e%node) > 0)) cycle
            call self%end_forces(i, self%basic(i, d(self%inside + 1:)), d, f, 1.0_wp, self%initial_tangent, &
                                 s, &
                                 correction)
            do j = 1, 2
               if (self%number(1, e%node(j)) > 0) cycle
               force = force - sum(s*e%to_basic(:, 3*j - 2))
               ! A chord that leans presses the support aside; a rotation against it has the opposite sign.
               if (self%axially_loaded) then
                  force = force - self%compression(i)*self%lengths(3, i) &
                          *chord_rotation(e, d(self%inside + 1:))*e%to_basic(2, 3*j - 2)
               end if
            end do
         end associate
      end do
      ! A spring of no account carries nothing that counts.
      do i = self%inside + 1, size(d)
         if (self%place(i)%kind == shear) force = force + f(i)
      end do
   end function base_force

   !> Accelerations of what has mass; where there is none they follow from the motion, not from forces.
   subroutine accelerations(self, d, v, load, pressing, result)
      class(frame_type), intent(in) :: self
      real(wp), intent(in) :: d(size(self%place)), v(size(self%place)), load(signals)
      integer, intent(in) :: pressing
      type(motion_result), intent(inout) :: result
      real(wp) :: correction(size(d))
      integer :: i

      associate (x => result%force)
         call self%forces(d, load, result%axial(:pressing), self%initial_tangent, result%f, x, correction)
         if (self%damped) call self%damp(v(self%inside + 1:), self%initial_tangent, x)
         call self%add_ground(load, x)
         do i = 1, self%unknowns
            if (self%inertias(i) > 0.0_wp) then
               x(i) = x(i)/self%inertias(i) - self%mass_damping*v(self%inside + i)
            else
               x(i) = 0.0_wp
            end if
         end do
         call self%spring_rates(self%initial_tangent, x, result%a)
      end associate
   end subroutine accelerations

   !> Refuse an axial load with time: what columns carry follows from the dead load.
   subroutine check_loads(self, acts, error)
      class(frame_type), intent(in) :: self
      logical, intent(in) :: acts(signals)
      type(error_type), allocatable, intent(inout) :: error

      if (acts(top_axial)) then
         call fatal_error(error, bad_input, 'axial_load: a frame has none that varies in time; its '// &
                          'columns carry the dead load of floors, beams and nodes')
      else if (acts(lateral) .and. .not. any(abs(self%pattern(lateral)%force) > 0.0_wp)) then
         call fatal_error(error, bad_input, 'force: the pattern of the lateral load has no share of any '// &
                          'node; choose pattern')
      end if
   end subroutine check_loads

   !> Whether a member carries nothing any more.
   pure logical function is_lost(frame, member, springs)
      type(frame_type), intent(in) :: frame
      integer, intent(in) :: member
      type(spring_array), intent(in) :: springs

      associate (e => frame%element(member))
         is_lost = e%bending + e%opening > 0
         if (is_lost) is_lost = springs%is_released(e%before + 1)
      end associate
   end function is_lost

   !> A member whose time has come, or one that has failed in shear and whose drift is that at which its axial
   !> load is lost: failure_drift/(1 + P/failure_load).
   integer function find_lost(self, springs, time) result(member)
      class(frame_type), intent(in) :: self
      type(spring_array), intent(in) :: springs
      real(wp), intent(in), optional :: time
      integer :: i

      member = 0
      if (.not. self%may_lose) return
      do i = 1, self%members
         if (is_lost(self, i, springs)) cycle
         if (present(time) .and. is_given(self%lost_at(i))) then
            if (time - self%lost_at(i) >= -same_time*abs(self%lost_at(i))) member = i
         end if
         if (is_given(self%failure_drift(i))) then
            if (has_failed(self, i, springs)) member = i
         end if
         if (member > 0) return
      end do
   end function find_lost

   logical function has_failed(frame, member, springs)
      type(frame_type), intent(in) :: frame
      integer, intent(in) :: member
      type(spring_array), intent(in) :: springs
      real(wp) :: drift, s(3)
      integer :: i

      associate (e => frame%element(member), x => springs%d(frame%inside + 1:))
         drift = abs(sum(e%chord*x(e%unknown)))
         has_failed = is_given(frame%shear_drift(member)) .and. drift >= abs(frame%shear_drift(member))
         do i = e%before + 1, e%before + e%bending
            if (frame%place(i)%kind /= shear) cycle
            if (springs%rules%list(springs%rules%of(i))%rule%has_yielded(springs%slot(i)%memory)) has_failed &
               = .true.
         end do
         if (.not. has_failed) return
         call find_ends(frame, member, springs, s)
         ! Tension, or no load, does not fall.
         has_failed = s(1) < 0.0_wp .and. &
                      drift*(1.0_wp - s(1)/frame%failure_load(member)) >= frame%failure_drift(member)
      end associate
   end function has_failed

   !> Axial force, tension positive, and moments of the ends where the springs are.
   subroutine find_ends(frame, member, springs, s)
      type(frame_type), intent(in) :: frame
      integer, intent(in) :: member
      type(spring_array), intent(in) :: springs
      real(wp), intent(out) :: s(3)
      real(wp) :: correction(springs%count)

      associate (d => springs%d)
         call frame%end_forces(member, frame%basic(member, d(frame%inside + 1:)), d, &
                               springs%f0 + springs%k*(d - springs%d0), 1.0_wp, frame%initial_tangent, s, &
                               correction)
      end associate
   end subroutine find_ends

   !> What the elastic rest would give back is lost with the member. Its springs keep what dead load does in
   !> them where it is carried to the nodes, on which it stays.
   subroutine let_go(self, member, springs)
      class(frame_type), intent(in) :: self
      integer, intent(in) :: member
      type(spring_array), intent(inout) :: springs
      real(wp) :: tangent(self%tangent_numbers), correction(springs%count), s(3), q(3), energy
      integer :: i, unstable

      tangent = 0.0_wp
      correction = 0.0_wp
      associate (e => self%element(member))
         q = self%basic(member, springs%d(self%inside + 1:))
         energy = energy_of_rest(e, gap_of(self, member, q, springs%d, 1.0_wp))
         do i = e%before + 1, e%before + e%bending + e%opening
            call springs%let_go(i, self%dead_force(i))
         end do
         call self%linearise(springs%k, tangent, unstable)
         call self%end_forces(member, q, springs%d, springs%f0 + springs%k*(springs%d - springs%d0), &
                              1.0_wp, tangent, s, correction)
         do i = e%before + 1, e%before + e%bending + e%opening
            call springs%advance_on_branch(i, springs%d(i) + correction(i))
         end do
         energy = energy - energy_of_rest(e, gap_of(self, member, q, springs%d, 1.0_wp))
         springs%work(e%before + 1) = springs%work(e%before + 1) + energy
      end associate
   end subroutine let_go

   !> Whether a node has sunk by a tenth of the height of a storey, once members may be lost.
   pure logical function has_fallen(self, d)
      class(frame_type), intent(in) :: self
      real(wp), intent(in), contiguous :: d(:)
      integer :: i

      has_fallen = .false.
      if (.not. self%may_lose) return
      do i = 1, self%n
         if (self%number(2, i) == 0) cycle
         has_fallen = has_fallen .or. &
                      d(self%inside + self%number(2, i)) < -deepest*self%height/max(self%storeys, 1)
      end do
   end function has_fallen

   !> A spring in a member that has slid by the height of the frame, or turned several times: it does not
   !> carry the dead load, or the end moments, of its member any more.
   pure integer function find_runaway(self, d) result(spring)
      class(frame_type), intent(in) :: self
      real(wp), intent(in), contiguous :: d(:)

      do spring = 1, self%inside
         if (abs(d(spring)) < min(self%height, farthest)) cycle
         if (abs(d(spring)) > merge(farthest, self%height, self%place(spring)%kind == flexure)) return
      end do
      spring = 0
   end function find_runaway

   !> Energy of the elastic rest of an element [J].
   pure real(wp) function energy_of_rest(e, gap) result(energy)
      type(frame_element), intent(in) :: e
      !> Its elongation and rotations
      real(wp), intent(in) :: gap(3)

      energy = 0.5_wp*e%rest_along*gap(1)**2
      if (allocated(e%rest)) energy = energy + 0.125_wp*(e%rest(1)*(gap(2) + gap(3))**2 &
                                                         + e%rest(2)*(gap(2) - gap(3))**2)
   end function energy_of_rest

end module rbs_structure_frame_frame
