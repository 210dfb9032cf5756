!> A planar frame: nodes with displacements along x and upward and clockwise rotations, and elements between
!> them, whose inside is condensed to their ends.
!>
!> The springs of the elements come first, then those from the ground: soil, a brace, a bearing. Behind the
!> deformations of all springs a position has the unknowns.
module rbs_structure_frame_frame
   use rbs_base_error, only: error_type, fatal_error, bad_input
   use rbs_base_inner_product, only: inner_product
   use rbs_base_kinds, only: wp
   use rbs_base_sparse_matrix, only: sparse_matrix, sparse_of
   use rbs_hysteresis_springs, only: spring_array
   use rbs_structure_condensation, only: series_tangent
   use rbs_structure_channel, only: channel_type, response_type, row_contents
   use rbs_structure_frame_element, only: frame_element
   use rbs_structure_frame_element_balance, only: end_motion, motion_terms, compatibility_error, &
                                                  set_tangent, balance_ends, balance_of_ends, &
                                                  add_end_forces, add_band, add_geometric_band, &
                                                  spring_motion, drop_round_off
   use rbs_structure_frame_frame_record, only: name_length
   use rbs_structure_frame_plan, only: floor_plan
   use rbs_structure_structure, only: structure_type, lateral, horizontal, sideways, signals, top_axial
   implicit none
   private

   public :: frame_type, frame_channel, plan_channel

   !> Channels of a frame besides those of all structures: displacements of the nodes along x and
   !> upward and clockwise rotations; axial forces of the members (compression positive) and moments of their
   !> ends; deformations and forces of their springs by kind, in the order of the members; on demand
   !> accelerations of the nodes along x relative to the ground, and that of the ground; 1 for members that
   !> were lost, where any may be.
   type(channel_type), parameter :: frame_channel(16) = [ &
      channel_type('base_shear', 'N'), channel_type('x', 'm'), channel_type('y', 'm'), &
      channel_type('node_rotation', 'rad'), channel_type('member_axial', 'N'), &
      channel_type('moment_from', 'N m'), channel_type('moment_to', 'N m'), channel_type('slip', 'm'), &
      channel_type('shear', 'N'), channel_type('rotation', 'rad'), channel_type('moment', 'N m'), &
      channel_type('opening', 'm'), channel_type('axial_force', 'N'), &
      channel_type('node_acceleration', 'm/s2'), channel_type('ground_acceleration', 'm/s2'), &
      channel_type('lost', '')]

   !> Channels of a building besides these: displacements of its floors along x and y and counterclockwise
   !> rotations, and forces of the supports along x of each plane, without those of damping; on demand
   !> the acceleration of the ground along y.
   type(channel_type), parameter :: plan_channel(5) = [ &
      channel_type('floor_x', 'm'), channel_type('floor_y', 'm'), channel_type('floor_rotation', 'rad'), &
      channel_type('plane_shear', 'N'), channel_type('ground_acceleration_y', 'm/s2')]

   !> Share of the terms of all elements that counts as those of any.
   real(wp), parameter :: of_all = 0.01_wp

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
      real(wp), allocatable :: position_ratio(:)
      !> Whether a spring is the first layer of a joint (inside)
      logical, allocatable :: heads(:)
      !> Springs listed in rows, by kind; of a joint of layers the first one, which gives rotation and opening
      type(spring_list) :: listed(3)
      !> Number of the unknown of each displacement, 0 where a support holds it (3, nodes)
      integer, allocatable :: number(:, :)
      !> In a building x of a node on a floor is moved by up to three unknowns of it: that of `number` and
      !> others (2, nodes), 0 for none, by their shares (3, nodes)
      integer, allocatable :: also(:, :)
      real(wp), allocatable :: share(:, :)
      !> Rigid floors of a building, of no planes for a planar frame. Planes of the nodes, 0 for none (nodes);
      !> their nodes at the base (planes); heights of the storeys [m]
      type(floor_plan) :: plan
      integer, allocatable :: plane(:), foot(:)
      real(wp), allocatable :: storey_height(:)
      !> Of a column in two planes: for the second the member of the first, and the unknown of the part of
      !> their elongation that is of the second; 0: none (members)
      integer, allocatable :: axial_of(:), parting(:)
      !> The same of the rotation of the beams, where a panel lets them turn against columns; else 0 (nodes)
      integer, allocatable :: beam_rotation(:)
      !> Number of members; elements behind them are panels of nodes
      integer :: members = 0
      !> Number of springs in elements, and of all; unknown that each spring from the ground deforms by
      integer :: member_springs = 0, springs = 0
      integer, allocatable :: ground(:)
      !> Dead loads on the unknowns (unknowns), and on the springs of elements whose ends do not move (inside)
      real(wp), allocatable :: dead(:), dead_force(:)
      !> When members are lost, see `frame_member` (members)
      real(wp), allocatable :: failure_drift(:), failure_load(:), shear_drift(:), lost_at(:)
      logical :: may_lose = .false.
      !> Second-order stiffness of the axial forces under dead load, and damping in proportion to the initial
      !> stiffness; not allocated where there is none
      type(sparse_matrix), allocatable :: second_order, damping
   contains
      procedure :: along_x, add_along_x, plane_drift, linearise, damp, add_damping, work_of_dead_load
      procedure :: is_loaded, take_load_off, leave_out_later, build_later, set_compression, compress
      procedure :: set_second_order, set_damping, clear_round_off, size_of_parts, member_forces, spring_rates
      procedure :: unknown_rates, forces, axial_forces, add_stiffness, add_geometric, rotations, storey_drifts
      procedure :: potential_energy, channels, fill_row, base_force, set_shape, check_loads, is_removed
      procedure :: next_failed_member, remove_member, has_collapsed, unbounded_spring
      procedure :: mark_columns
   end type frame_type

   interface

      !> Whether any dead load acts.
      pure logical module function is_loaded(self)
         class(frame_type), intent(in) :: self
      end function is_loaded

      !> Take all dead load off.
      pure module subroutine take_load_off(self)
         class(frame_type), intent(inout) :: self
      end subroutine take_load_off

      !> Leave out members that are built under the dead load: nothing moves them.
      pure module subroutine leave_out_later(self)
         class(frame_type), intent(inout) :: self
      end subroutine leave_out_later

      !> Build these members without forces into the frame as it stands.
      pure module subroutine build_later(self, d)
         class(frame_type), intent(inout) :: self
         !> Deformations of the springs and unknowns
         real(wp), intent(in), contiguous :: d(:)
      end subroutine build_later

      !> Take the axial forces of the elements under dead load.
      module subroutine set_compression(self, d, f)
         class(frame_type), intent(inout) :: self
         !> Deformations and forces of the springs (springs)
         real(wp), intent(in), contiguous :: d(:), f(:)
      end subroutine set_compression

      !> Put an axial force that does second-order work on an element.
      pure module subroutine compress(self, element, compression)
         class(frame_type), intent(inout) :: self
         !> Number of the element
         integer, intent(in) :: element
         !> [N]
         real(wp), intent(in) :: compression
      end subroutine compress

      !> Assemble the second-order stiffness of the axial forces.
      pure module subroutine set_second_order(self)
         class(frame_type), intent(inout) :: self
      end subroutine set_second_order

      !> Assemble the damping in proportion to the initial stiffness.
      pure module subroutine set_damping(self)
         class(frame_type), intent(inout) :: self
      end subroutine set_damping

      !> Work of the dead load on unknowns, springs and elastic rests [J].
      pure real(wp) module function work_of_dead_load(self, d) result(work)
         class(frame_type), intent(in) :: self
         !> Deformations of the springs and unknowns, or changes of them (coordinates)
         real(wp), intent(in), contiguous :: d(:)
      end function work_of_dead_load

      !> Potential of dead load and second-order work, and energy of the elastic rests of elements [J].
      pure real(wp) module function potential_energy(self, d) result(energy)
         class(frame_type), intent(in) :: self
         !> Deformations of the springs and unknowns (coordinates)
         real(wp), intent(in), contiguous :: d(:)
      end function potential_energy

      !> Channels of a frame: displacements of the nodes, forces of the members, deformations and forces of
      !> their springs by kind.
      pure module subroutine channels(self, contents, channel)
         class(frame_type), intent(in) :: self
         type(row_contents), intent(in) :: contents
         type(channel_type), allocatable, intent(out) :: channel(:)
      end subroutine channels

      !> Values of these channels at a time, one after the other.
      pure module subroutine fill_row(self, contents, response, springs, d, row)
         class(frame_type), intent(in) :: self
         type(row_contents), intent(in) :: contents
         type(response_type), intent(in) :: response
         type(spring_array), intent(in) :: springs
         !> Deformations of the springs and unknowns (coordinates)
         real(wp), intent(in), contiguous :: d(:)
         !> Values of `channels` without those of all structures
         real(wp), intent(out), contiguous :: row(:)
      end subroutine fill_row

      !> Base shear: forces along x of the supports and of the springs from the ground [N].
      pure real(wp) module function base_force(self, d, f) result(force)
         class(frame_type), intent(in) :: self
         !> Deformations and unknowns (coordinates); forces of the springs (springs)
         real(wp), intent(in), contiguous :: d(:), f(:)
      end function base_force

      !> Whether a member carries nothing any more.
      pure logical module function is_removed(self, member, springs)
         class(frame_type), intent(in) :: self
         !> Number of the member
         integer, intent(in) :: member
         type(spring_array), intent(in) :: springs
      end function is_removed

      !> A member whose time has come, or one that has failed in shear and whose drift is that at which its
      !> axial load is lost: failure_drift/(1 + P/failure_load).
      integer module function next_failed_member(self, springs, time) result(member)
         class(frame_type), intent(in) :: self
         type(spring_array), intent(in) :: springs
         !> [s]; without it no member is lost by time
         real(wp), intent(in), optional :: time
      end function next_failed_member

      !> Take the forces of a member away. The energy of its elastic rest is lost with it. Its springs keep
      !> the work of the dead load in them, which is carried to the nodes and stays there.
      module subroutine remove_member(self, member, springs)
         class(frame_type), intent(in) :: self
         !> Number of the member
         integer, intent(in) :: member
         type(spring_array), intent(inout) :: springs
      end subroutine remove_member

      !> Whether a node has sunk by a tenth of the height of a storey, once members may be lost.
      pure logical module function has_collapsed(self, d)
         class(frame_type), intent(in) :: self
         !> Deformations of the springs and unknowns (coordinates)
         real(wp), intent(in), contiguous :: d(:)
      end function has_collapsed

      !> A spring in a member that has slid by the height of the frame, or turned several times: it does not
      !> carry the dead load, or the end moments, of its member any more.
      pure integer module function unbounded_spring(self, d) result(spring)
         class(frame_type), intent(in) :: self
         !> Deformations of the springs and unknowns (coordinates)
         real(wp), intent(in), contiguous :: d(:)
      end function unbounded_spring

   end interface

contains

   !> Displacement of a node along x of its plane [m].
   pure real(wp) function along_x(self, node, x) result(moved)
      class(frame_type), intent(in) :: self
      !> Number of the node
      integer, intent(in) :: node
      !> Unknowns, or changes of them (unknowns)
      real(wp), intent(in) :: x(:)
      integer :: j

      moved = 0.0_wp
      ! A support holds it.
      if (self%number(1, node) == 0) return
      moved = self%share(1, node)*x(self%number(1, node))
      do j = 1, 2
         if (self%also(j, node) > 0) moved = moved + self%share(1 + j, node)*x(self%also(j, node))
      end do
   end function along_x

   !> Add the forces on the unknowns by a force along x of a node.
   pure subroutine add_along_x(self, node, force, row)
      class(frame_type), intent(in) :: self
      !> Number of the node
      integer, intent(in) :: node
      !> To +x of its plane [N]
      real(wp), intent(in) :: force
      !> (unknowns)
      real(wp), intent(inout) :: row(:)
      integer :: j

      ! In a building x follows from up to three unknowns of the floor, by shares; 0: a support holds it.
      associate (at => self%number(1, node))
         if (at == 0) return
         row(at) = row(at) + self%share(1, node)*force
      end associate
      do j = 1, 2
         associate (at => self%also(j, node))
            if (at > 0) row(at) = row(at) + self%share(1 + j, node)*force
         end associate
      end do
   end subroutine add_along_x

   !> Drift ratio of a storey in a plane of a building; 0 where the plane has no node on its upper floor.
   pure real(wp) function plane_drift(self, plane, storey, x) result(drift)
      class(frame_type), intent(in) :: self
      !> Numbers of the plane and of the storey
      integer, intent(in) :: plane, storey
      !> (unknowns)
      real(wp), intent(in) :: x(:)

      drift = 0.0_wp
      if (.not. self%plan%is_there(plane, storey)) return
      drift = sum(self%plan%share(:, plane, storey)*self%plan%motion(storey, x))
      if (storey > 1) drift = drift - &
                              sum(self%plan%share(:, plane, storey - 1)*self%plan%motion(storey - 1, x))
      ! At the base a node may move on springs from the ground.
      if (storey == 1 .and. self%foot(plane) > 0) drift = drift - self%along_x(self%foot(plane), x)
      drift = drift/self%storey_height(storey)
   end function plane_drift

   !> Tangents of the elements on the present lines of the springs.
   subroutine linearise(self, k, tangent, unstable, shares)
      class(frame_type), intent(in) :: self
      !> Stiffness of the springs (springs)
      real(wp), intent(in), contiguous :: k(:)
      !> Elements whose springs have the stiffness of their last tangent keep it (elements)
      type(series_tangent), intent(inout) :: tangent(:)
      !> An element that snaps back; 0: none
      integer, intent(out) :: unstable
      !> Whether springs without stiffness share motions in any element
      logical, intent(out), optional :: shares
      integer :: i

      do i = 1, size(self%element)
         associate (e => self%element(i))
            call set_tangent(e, e%bending + e%opening, k(e%before + 1:), tangent(i))
         end associate
      end do
      unstable = findloc(tangent%snaps_back, .true., dim=1, back=.true.)
      if (present(shares)) shares = any(tangent%is_mechanism)
   end subroutine linearise

   !> Mark the columns of the stiffness that elements with a new tangent take part in, and those of springs
   !> from the ground.
   subroutine mark_columns(self, tangent, columns)
      class(frame_type), intent(in) :: self
      !> Tangents of the elements, which are new no more (elements)
      type(series_tangent), intent(inout) :: tangent(:)
      !> (unknowns)
      logical, intent(inout), contiguous :: columns(:)
      integer :: i

      do i = 1, size(tangent)
         if (.not. tangent(i)%is_new) cycle
         tangent(i)%is_new = .false.
         ! Where a support holds a displacement this is the first unknown, which does no harm.
         columns(self%element(i)%unknown(:self%element(i)%width)) = .true.
      end do
      columns(self%ground) = .true.
   end subroutine mark_columns

   !> Add the stiffness of the elements, from their tangents, and of the springs from the ground to a lower
   !> band.
   subroutine add_stiffness(self, k, tangent, band, columns)
      class(frame_type), intent(in) :: self
      !> Stiffness of the springs (springs); those in elements are in the tangents already
      real(wp), intent(in), contiguous :: k(:)
      !> Tangents of the elements (elements)
      type(series_tangent), intent(in) :: tangent(:)
      !> (half_width + 1, unknowns)
      real(wp), intent(inout), contiguous :: band(:, :)
      !> The columns that are filled, with those of springs from the ground (unknowns); without it, all
      logical, intent(in), optional, contiguous :: columns(:)
      integer :: i

      do i = 1, size(self%element)
         call add_band(self%element(i), tangent(i)%stiffness, band, columns)
      end do
      band(1, self%ground) = band(1, self%ground) + k(self%member_springs + 1:)
   end subroutine add_stiffness

   !> Add the forces of the damping: of the modes, and in proportion to the stiffness of the elements, initial
   !> or present.
   subroutine damp(self, v, tangent, g)
      class(frame_type), intent(in) :: self
      !> Velocities of the unknowns (unknowns), tangents of the elements
      real(wp), intent(in), contiguous :: v(:)
      type(series_tangent), intent(in) :: tangent(:)
      !> Forces on the unknowns (unknowns)
      real(wp), intent(inout), contiguous :: g(:)
      real(wp) :: s(3)
      integer :: i

      if (allocated(self%modal_momenta)) call damp_modes(self, size(self%massed), v, g)
      if (allocated(self%damping)) call self%damping%subtract_product(v, g)
      ! In proportion to the initial stiffness it is in `damping`.
      if (.not. self%tangent_damping) return
      do i = 1, size(tangent)
         associate (k => tangent(i)%stiffness, q => end_motion(self%element(i), v))
            s = k(:, 1)*q(1) + k(:, 2)*q(2) + k(:, 3)*q(3)
         end associate
         call add_end_forces(self%element(i), -self%stiffness_damping*s, g)
      end do
   end subroutine damp

   !> Subtract the damping forces of the modes.
   pure subroutine damp_modes(self, massed, v, g)
      class(frame_type), intent(in) :: self
      !> Number of unknowns with mass
      integer, intent(in) :: massed
      !> Velocities of the unknowns, and forces on them (unknowns)
      real(wp), intent(in), contiguous :: v(:)
      real(wp), intent(inout), contiguous :: g(:)
      real(wp) :: speed(massed), force(massed)
      integer :: i

      speed = v(self%massed)
      force = 0.0_wp
      ! The matrix itself, where it takes fewer numbers
      if (allocated(self%modal_matrix)) then
         do i = 1, massed
            force = force + self%modal_matrix(:, i)*speed(i)
         end do
      else
         do i = 1, size(self%modal_momenta, 2)
            force = force + self%modal_momenta(:, i)*inner_product(massed, self%modal_momenta(:, i), speed)
         end do
      end if
      g(self%massed) = g(self%massed) - force
   end subroutine damp_modes

   !> Add a factor times the damping matrix, but for the modes, to a lower band.
   subroutine add_damping(self, factor, tangent, band)
      class(frame_type), intent(in) :: self
      !> Factor; tangents of the elements; (half_width + 1, unknowns)
      real(wp), intent(in) :: factor
      type(series_tangent), intent(in) :: tangent(:)
      real(wp), intent(inout), contiguous :: band(:, :)
      integer :: i

      if (allocated(self%damping)) call self%damping%add_to(factor, band)
      if (.not. self%tangent_damping) return
      do i = 1, size(tangent)
         call add_band(self%element(i), factor*self%stiffness_damping*tangent(i)%stiffness, band)
      end do
   end subroutine add_damping

   !> Changes of the deformations from those of the unknowns. Those of layers follow from their joints.
   subroutine spring_rates(self, tangent, dx, dd)
      class(frame_type), intent(in) :: self
      !> Tangents of the elements
      type(series_tangent), intent(in) :: tangent(:)
      !> Changes of the unknowns (unknowns), and of all coordinates
      real(wp), intent(in), contiguous :: dx(:)
      real(wp), intent(out), contiguous :: dd(:)
      integer :: i

      do i = 1, size(self%element)
         call spring_motion(self%element(i), tangent(i), end_motion(self%element(i), dx), dd)
      end do
      ! Springs from the ground deform by one unknown; behind all springs a position has the unknowns
      ! themselves.
      dd(self%member_springs + 1:self%springs) = dx(self%ground)
      dd(self%springs + 1:self%joints%before) = dx
   end subroutine spring_rates

   !> Take rates of springs that are round-off of larger ones for zero. The larger ones are those of the ends
   !> of the element, and a share of those of all elements, as displacements are round-off of each other.
   pure subroutine clear_round_off(self, tangent, dx, k, dd)
      class(frame_type), intent(in) :: self
      !> Tangents of the elements
      type(series_tangent), intent(in) :: tangent(:)
      !> Rates of the unknowns (unknowns); stiffness of the springs, which is not used
      real(wp), intent(in), contiguous :: dx(:), k(:)
      !> Rates of the springs (springs)
      real(wp), intent(inout), contiguous :: dd(:)
      !> Sizes of elongation and end rotations: of the elements, largest, and with which rates are compared
      real(wp) :: terms(3, size(self%element)), largest(3), size_of(3)
      integer :: i

      largest = 0.0_wp
      do i = 1, size(self%element)
         terms(:, i) = motion_terms(self%element(i), dx)
         largest = max(largest, terms(:, i))
      end do
      do i = 1, size(self%element)
         associate (e => self%element(i))
            size_of = terms(:, i)
            ! The share of a layer in a motion may be as small without being round-off.
            if (.not. allocated(e%y)) size_of = max(size_of, of_all*largest)
            call drop_round_off(e, tangent(i), size_of, dd)
         end associate
      end do
   end subroutine clear_round_off

   !> Sizes that measure round-off: the largest force of elements and dead loads and, as if all terms had one
   !> sign, the largest force and the work of elements; moments over the height.
   subroutine size_of_parts(self, springs, d, least, force, terms, work)
      class(frame_type), intent(in) :: self
      !> Springs on their present lines
      type(spring_array), intent(in) :: springs
      !> Position (coordinates)
      real(wp), intent(in), contiguous :: d(:)
      !> Least displacement that counts, in shares of the height
      real(wp), intent(in) :: least
      !> Largest force [N]; largest force of terms of one sign [N], and their work [J]
      real(wp), intent(out) :: force, terms, work
      real(wp) :: s(3), q(3), to_force(3), f(springs%count)
      integer :: i

      to_force = [1.0_wp, 1.0_wp/self%total_height, 1.0_wp/self%total_height]
      force = maxval(abs(self%dead)/self%reach)
      terms = 0.0_wp
      work = 0.0_wp
      f = springs%forces(d)
      associate (x => d(self%springs + 1:self%joints%before))
         do i = 1, size(self%element)
            associate (e => self%element(i))
               ! Elements behind the members are panels.
               if (i <= self%members) then
                  call self%member_forces(i, d, f, s)
                  force = max(force, maxval(abs(s)*to_force))
               end if
               q = motion_terms(e, max(abs(x), least*self%total_height/self%reach))
               s = matmul(abs(self%initial_tangent(i)%stiffness), q)
               terms = max(terms, maxval(s*to_force))
               work = work + sum(s*q)
            end associate
         end do
      end associate
   end subroutine size_of_parts

   !> Changes of the unknowns from those of a position, which holds them behind the springs.
   pure subroutine unknown_rates(self, dd, dx)
      class(frame_type), intent(in) :: self
      !> Changes of a position (coordinates), of the unknowns (unknowns)
      real(wp), intent(in), contiguous :: dd(:)
      real(wp), intent(out), contiguous :: dx(:)

      dx = dd(self%springs + 1:self%joints%before)
   end subroutine unknown_rates

   !> Forces on the unknowns: the lateral load and the dead one, less forces of springs and elastic rest,
   !> and second-order forces, of the axial forces under the dead load; corrections of the deformations that
   !> bring the inside of the elements to equilibrium.
   subroutine forces(self, d, load, axial, tangent, f, g, correction, dead)
      class(frame_type), intent(in) :: self
      !> Deformations and unknowns (coordinates), signals of the loads; `axial` is not used, see
      !> `second_order`
      real(wp), intent(in), contiguous :: d(:), load(:), axial(:)
      !> Tangents of the elements
      type(series_tangent), intent(in) :: tangent(:)
      !> Forces of the springs (springs), which a frame does not change
      real(wp), intent(inout), contiguous :: f(:)
      !> Forces on the unknowns (unknowns) [N, N m]
      real(wp), intent(out), contiguous :: g(:)
      !> Changes of the deformations that bring the inside of the elements to equilibrium (coordinates)
      real(wp), intent(inout), contiguous :: correction(:)
      !> Share of the dead load that acts; without it, all
      real(wp), intent(in), optional :: dead
      real(wp) :: misfit(3), s(3), part
      integer :: i

      part = 1.0_wp
      if (present(dead)) part = dead
      associate (x => d(self%springs + 1:))
         g = part*self%dead + load(lateral)*self%pattern(lateral)%force
         g(self%ground) = g(self%ground) - f(self%member_springs + 1:)
         do i = 1, size(self%element)
            associate (e => self%element(i))
               misfit = compatibility_error(e, end_motion(e, x), d, part)
               call balance_ends(e, size(f), misfit, part, self%dead_force, f, tangent(i), s, correction)
               call add_end_forces(e, -s, g)
            end associate
         end do
         if (allocated(self%second_order)) call self%second_order%subtract_product(x, g)
      end associate
   end subroutine forces

   !> Axial force, tension positive, and moments of the ends of a member under all of its dead load.
   pure subroutine member_forces(self, member, d, f, s)
      class(frame_type), intent(in) :: self
      !> Number of the member
      integer, intent(in) :: member
      !> Deformations and unknowns (coordinates); forces of all springs (springs)
      real(wp), intent(in), contiguous :: d(:), f(:)
      !> Axial force, moments of the first and the last end [N, N m]
      real(wp), intent(out) :: s(3)
      real(wp) :: misfit(3)

      associate (e => self%element(member), x => d(self%springs + 1:))
         misfit = compatibility_error(e, end_motion(e, x), d, 1.0_wp)
         s = balance_of_ends(e, size(f), misfit, self%dead_force, f, self%initial_tangent(member))
      end associate
   end subroutine member_forces

   !> Axial forces of the members that do second-order work: those under dead load, whatever the loads.
   subroutine axial_forces(self, load, axial)
      class(frame_type), intent(in) :: self
      !> Signals of the loads, which have no part in it
      real(wp), intent(in), contiguous :: load(:)
      !> (members, or none) [N]
      real(wp), intent(out), contiguous :: axial(:)

      axial = self%element(:size(axial))%compression
   end subroutine axial_forces

   !> Add the derivatives of second-order forces, with their sign turned, to a lower band; the axial forces
   !> are those under dead load, and `k` is not used.
   subroutine add_geometric(self, k, band)
      class(frame_type), intent(in) :: self
      real(wp), intent(in), contiguous :: k(:)
      real(wp), intent(inout), contiguous :: band(:, :)

      if (allocated(self%second_order)) call self%second_order%add_to(1.0_wp, band)
   end subroutine add_geometric

   !> Rotations of the nodes, 0 where a support holds one.
   pure subroutine rotations(self, d, rotation)
      class(frame_type), intent(in) :: self
      !> Deformations and unknowns (coordinates), or changes of them; rotations (nodes) [rad]
      real(wp), intent(in), contiguous :: d(:)
      real(wp), intent(out), contiguous :: rotation(:)
      integer :: i

      do i = 1, self%n
         rotation(i) = 0.0_wp
         if (self%number(3, i) > 0) rotation(i) = d(self%springs + self%number(3, i))
      end do
   end subroutine rotations

   !> Drift ratios of the storeys: differences of the displacements of the floors, mean of their nodes, over
   !> the heights; of a building the largest of all planes.
   pure subroutine storey_drifts(self, d, drift)
      class(frame_type), intent(in) :: self
      !> Deformations and unknowns (coordinates)
      real(wp), intent(in), contiguous :: d(:)
      real(wp), intent(out), contiguous :: drift(:)
      integer :: i, plane

      if (self%plan%is_given()) then
         ! The largest drift of any plane
         do i = 1, self%storeys
            associate (of_planes => [(abs(self%plane_drift(plane, i, d(self%springs + 1:))), &
                                      plane=1, self%plan%planes())])
               drift(i) = maxval(of_planes)
            end associate
         end do
         return
      end if
      drift = 0.0_wp
      ! A floor is the upper one of a storey and the lower one of the next; nodes of none (-1) do not count.
      do i = 1, self%n
         if (self%number(1, i) == 0) cycle
         associate (floor => self%storey(i), x => d(self%springs + self%number(1, i)))
            if (floor > 0) drift(floor) = drift(floor) + self%storey_share(1, i)*x
            if (floor >= 0 .and. floor < self%storeys) then
               drift(floor + 1) = drift(floor + 1) + self%storey_share(2, i)*x
            end if
         end associate
      end do
   end subroutine storey_drifts

   !> A shape of vibration with its sign: the masses move to +x. A mode of a building that moves no mass along
   !> x has the sign of that along y, or of the turn of its roof.
   pure subroutine set_shape(self, part, found, shape)
      class(frame_type), intent(in) :: self
      !> Number of the part, of which a frame has one
      integer, intent(in) :: part
      !> The shape (unknowns)
      real(wp), intent(in), contiguous :: found(:)
      !> The same with its sign
      real(wp), intent(inout), contiguous :: shape(:)
      real(wp) :: moved(3), roof(3)

      ! Momentum along x and y per unit of the motion, and for a building a measure of the turn of its roof
      moved = [-self%work_of(horizontal, found), -self%work_of(sideways, found), 0.0_wp]
      if (self%plan%is_given()) then
         roof = self%plan%motion(self%storeys, found)
         moved(3) = roof(3)*sqrt(self%plan%turning_mass(self%inertias))
         ! Of one part in one direction nothing but round-off may be left.
         moved(1) = moved(maxloc(abs(moved), dim=1))
      end if
      shape = sign(1.0_wp, moved(1))*found
   end subroutine set_shape

   !> Refuse an axial load, as that of columns follows from the dead load, and loads that nothing takes.
   subroutine check_loads(self, acts, error)
      class(frame_type), intent(in) :: self
      !> Which loads act (signals)
      logical, intent(in) :: acts(signals)
      type(error_type), allocatable, intent(inout) :: error

      if (acts(top_axial)) then
         call fatal_error(error, bad_input, 'axial_load: a frame has none that varies; its columns '// &
                          'carry the dead load of floors, beams and nodes')
      else if (acts(sideways) .and. .not. any(abs(self%pattern(sideways)%force) > 0.0_wp)) then
         call fatal_error(error, bad_input, 'ground_acceleration_y: nothing of it moves along y; give '// &
                          'ground_acceleration alone, or planes along y with mass')
      else if (acts(horizontal) .and. self%plan%is_given() .and. &
               .not. any(abs(self%pattern(horizontal)%force) > 0.0_wp)) then
         call fatal_error(error, bad_input, 'ground_acceleration: nothing of the building moves along x; '// &
                          'give ground_acceleration_y, or planes along x with mass')
      else if (acts(lateral) .and. .not. any(abs(self%pattern(lateral)%force) > 0.0_wp)) then
         call fatal_error(error, bad_input, 'force: the pattern of the lateral load has no share of any '// &
                          'node; choose pattern')
      end if
   end subroutine check_loads

end module rbs_structure_frame_frame
