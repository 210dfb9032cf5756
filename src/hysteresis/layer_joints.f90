!> Joints of layers. Each layer is a spring of its own, which opens by w + y theta; but as long as no layer
!> leaves its line, a joint is one spring in its opening w and its rotation theta. Both are coordinates of a
!> position.
module rbs_hysteresis_layer_joints
   use rbs_base_constants, only: out_of_bounds
   use rbs_base_kinds, only: wp
   use rbs_base_tolerances, only: round_off
   implicit none
   private

   public :: layer_joints, stiffness_sums

   type :: layer_joints
      !> Number of joints, and of coordinates before theirs
      integer :: count = 0, before = 0
      !> First and last layer (joints); joint of each spring, 0 for none (springs), and springs that are no
      !> layers
      integer, allocatable :: first(:), last(:), of(:), others(:)
      !> Places of forces among those of all springs
      integer, allocatable :: with_force(:)
      !> Coordinates that are no layers, which follow from the others: first and last of each run of them
      !> (2, runs)
      integer, allocatable :: run(:, :)
      !> Distances of the layers (springs) [m]
      real(wp), allocatable :: y(:)
      !> Largest distance of a layer (joints) [m]
      real(wp), allocatable :: reach(:)
      !> Sums over the layers of a joint on their present lines: of k, k y and k y**2, axial force and moment
      !> at the anchor, the motion at which they were found (5, joints), (2, joints)
      real(wp), allocatable :: sums(:, :), anchor(:, :)
      !> Motion at which all layers were on their lines, and the least distance of any to an end of its
      !> line (2, joints), (joints); none is known where it is negative
      real(wp), allocatable :: seen(:, :), clearance(:)
      !> Whether layers have changed their lines since the sums were found (joints)
      logical, allocatable :: is_changed(:)
   contains
      procedure :: create
      procedure :: motion
      procedure :: forces
      procedure :: open_layers
      procedure :: align
      procedure :: sum_up
      procedure :: stay_on_lines
   end type layer_joints

contains

   !> Joints without deformation, their lines not yet known.
   subroutine create(self, of, y, before)
      class(layer_joints), intent(out) :: self
      !> Joint of each spring, 0 for none; the layers of a joint follow each other
      integer, intent(in) :: of(:)
      !> Distances of the layers from the middle of their sections (springs) [m]
      real(wp), intent(in) :: y(:)
      !> Number of coordinates of a position before those of the joints
      integer, intent(in) :: before
      !> Whether each coordinate is that of a joint or of a spring without one; none before and behind them
      logical :: moves(0:before + 2*maxval([0, of]) + 1)
      integer :: i, j

      self%count = maxval([0, of])
      self%before = before
      self%of = of
      self%y = y
      self%others = pack([(i, i=1, size(of))], of == 0)
      self%first = [(findloc(of, j, dim=1), j=1, self%count)]
      self%last = [(findloc(of, j, dim=1, back=.true.), j=1, self%count)]
      self%with_force = [self%others, self%first, self%first + 1]
      moves = .true.
      moves(1:size(of)) = of == 0
      moves([0, ubound(moves, 1)]) = .false.
      associate (m => ubound(moves, 1) - 1)
         associate (first => pack([(i, i=1, m)], moves(1:m) .and. .not. moves(0:m - 1)), &
                    last => pack([(i, i=1, m)], moves(1:m) .and. .not. moves(2:m + 1)))
            self%run = transpose(reshape([first, last], [size(first), 2]))
         end associate
      end associate
      self%reach = [(maxval(abs(y), mask=of == j), j=1, self%count)]
      allocate (self%sums(5, self%count), self%anchor(2, self%count), self%seen(2, self%count), &
                source=0.0_wp)
      allocate (self%clearance(self%count), source=-1.0_wp)
      allocate (self%is_changed(self%count), source=.true.)
   end subroutine create

   !> Opening [m] and rotation [rad] of a joint in a position.
   pure function motion(self, joint, d) result(z)
      class(layer_joints), intent(in) :: self
      integer, intent(in) :: joint
      !> (coordinates)
      real(wp), intent(in), contiguous :: d(:)
      real(wp) :: z(2)

      z = d(self%before + 2*joint - 1:self%before + 2*joint)
   end function motion

   !> Axial forces and moments of the joints on the present lines, in the places of their first two layers.
   pure subroutine forces(self, d, f)
      class(layer_joints), intent(in) :: self
      !> Position (coordinates); forces (springs), of which those places are set [N, N m]
      real(wp), intent(in), contiguous :: d(:)
      real(wp), intent(inout), contiguous :: f(:)

      call resist(self%count, size(f), self%first, self%sums, self%anchor, d(self%before + 1:), f)
   end subroutine forces

   !> Force and moment of each of n joints at its opening and rotation d, from the sums over its layers (as in
   !> `layer_joints`): f(first) and f(first + 1) are set.
   pure subroutine resist(n, springs, first, sums, anchor, d, f)
      integer, intent(in) :: n, springs, first(n)
      real(wp), intent(in) :: sums(5, n), anchor(2, n), d(2, n)
      real(wp), intent(inout) :: f(springs)
      real(wp) :: w, theta
      integer :: j

      do j = 1, n
         w = d(1, j) - anchor(1, j)
         theta = d(2, j) - anchor(2, j)
         f(first(j)) = sums(4, j) + (sums(1, j)*w + sums(2, j)*theta)
         f(first(j) + 1) = sums(5, j) + (sums(2, j)*w + sums(3, j)*theta)
      end do
   end subroutine resist

   !> Deformations of the layers in a position, or changes of them.
   pure subroutine open_layers(self, d)
      class(layer_joints), intent(in) :: self
      !> Position, or its change; the elements of the layers follow from those of the joints (coordinates)
      real(wp), intent(inout), contiguous :: d(:)
      integer :: j

      do j = 1, self%count
         associate (i => self%first(j), last => self%last(j), at => self%before + 2*j)
            call open_up(last - i + 1, self%y(i:last), d(at - 1:at), d(i:last))
         end associate
      end do
   end subroutine open_layers

   !> Set the changes of the deformations of the layers so that after the change they agree with the openings
   !> and rotations of their joints.
   pure subroutine align(self, d, change)
      class(layer_joints), intent(in) :: self
      !> Position, and its change, of which the elements of the layers are set (coordinates)
      real(wp), intent(in), contiguous :: d(:)
      real(wp), intent(inout), contiguous :: change(:)
      real(wp) :: z(2)
      integer :: j

      do j = 1, self%count
         z = self%motion(j, d) + self%motion(j, change)
         associate (i => self%first(j), last => self%last(j))
            change(i:last) = (z(1) + self%y(i:last)*z(2)) - d(i:last)
         end associate
      end do
   end subroutine align

   !> Deformations d of the n layers of a joint with the opening z(1) and the rotation z(2).
   pure subroutine open_up(n, y, z, d)
      integer, intent(in) :: n
      real(wp), intent(in) :: y(n), z(2)
      real(wp), intent(out) :: d(n)
      integer :: i

      !$omp simd
      do i = 1, n
         d(i) = z(1) + y(i)*z(2)
      end do
   end subroutine open_up

   !> Find the sums of a joint on the present lines of its layers, from its anchor.
   pure subroutine sum_up(self, joint, d0, f0, k)
      class(layer_joints), intent(inout) :: self
      integer, intent(in) :: joint
      !> Lines f0 + k (d - d0) of all springs (springs)
      real(wp), intent(in), contiguous :: d0(:), f0(:), k(:)

      associate (i => self%first(joint), last => self%last(joint))
         call add_up(last - i + 1, self%y(i:last), self%anchor(:, joint), d0(i:last), f0(i:last), k(i:last), &
                     self%sums(:, joint))
      end associate
      self%clearance(joint) = -1.0_wp
      self%is_changed(joint) = .false.
   end subroutine sum_up

   !> Sums over the n layers of a joint: of k, k y and k y**2, force and moment at the opening z(1) and the
   !> rotation z(2).
   pure subroutine add_up(n, y, z, d0, f0, k, sums)
      integer, intent(in) :: n
      real(wp), intent(in) :: y(n), z(2), d0(n), f0(n), k(n)
      real(wp), intent(out) :: sums(5)
      real(wp) :: force, moment, f
      integer :: i

      force = 0.0_wp
      moment = 0.0_wp
      !$omp simd reduction(+:force, moment) private(f)
      do i = 1, n
         f = f0(i) + k(i)*((z(1) + y(i)*z(2)) - d0(i))
         force = force + f
         moment = moment + y(i)*f
      end do
      sums = [stiffness_sums(n, y, k), force, moment]
   end subroutine add_up

   !> Sums of k, k y and k y**2 over n layers [N/m, N, N m].
   pure function stiffness_sums(n, y, k) result(sums)
      integer, intent(in) :: n
      real(wp), intent(in) :: y(n), k(n)
      real(wp) :: sums(3), of_k, of_ky, of_kyy
      integer :: i

      of_k = 0.0_wp
      of_ky = 0.0_wp
      of_kyy = 0.0_wp
      !$omp simd reduction(+:of_k, of_ky, of_kyy)
      do i = 1, n
         of_k = of_k + k(i)
         of_ky = of_ky + k(i)*y(i)
         of_kyy = of_kyy + k(i)*y(i)**2
      end do
      sums = [of_k, of_ky, of_kyy]
   end function stiffness_sums

   !> Whether all layers stay on their lines in another position.
   pure subroutine stay_on_lines(self, d, lower, upper, one_way, stay)
      class(layer_joints), intent(inout) :: self
      !> Other position (coordinates)
      real(wp), intent(in), contiguous :: d(:)
      !> Lowest and highest deformations of the lines, whether they are left when the motion turns (springs)
      real(wp), intent(in), contiguous :: lower(:), upper(:)
      integer, intent(in), contiguous :: one_way(:)
      logical, intent(out) :: stay
      real(wp) :: z(2), least
      integer :: j

      stay = .true.
      do j = 1, self%count
         associate (i => self%first(j), n => self%last(j), at => self%before + 2*j)
            if (is_within_clearance(d(at - 1:at), self%seen(:, j), self%reach(j), self%clearance(j))) cycle
            z = d(at - 1:at)
            call find_clearance(n - i + 1, self%y(i:n), z, lower(i:n), upper(i:n), least)
            stay = least >= 0.0_wp .and. maxval(abs(z)) < out_of_bounds
            if (.not. stay) return
            self%seen(:, j) = z
            self%clearance(j) = min(least, out_of_bounds) - round_off*(abs(z(1)) + self%reach(j)*abs(z(2)))
            ! The rear end of a line that is left when the motion turns moves with the layer.
            if (any(one_way(i:n) /= 0)) self%clearance(j) = -1.0_wp
         end associate
      end do
   end subroutine stay_on_lines

   !> Whether the distance from one motion of a joint to another is less than its clearance.
   pure logical function is_within_clearance(z, seen, reach, clearance)
      !> Motions (opening [m], rotation [rad]); distance of the outermost layer and clearance [m]
      real(wp), intent(in) :: z(2), seen(2), reach, clearance

      is_within_clearance = abs(z(1) - seen(1)) + reach*abs(z(2) - seen(2)) < clearance
   end function is_within_clearance

   !> Least distance of any layer from a motion of the joint to an end of its line, negative beyond it.
   pure subroutine find_clearance(n, y, z, lower, upper, clearance)
      !> Layers: number, distances y [m], ends of their lines [m]; z: opening [m] and rotation [rad]
      integer, intent(in) :: n
      real(wp), intent(in) :: y(n), z(2), lower(n), upper(n)
      real(wp), intent(out) :: clearance
      real(wp) :: d
      integer :: i

      clearance = huge(1.0_wp)
      !$omp simd reduction(min:clearance) private(d)
      do i = 1, n
         d = z(1) + y(i)*z(2)
         clearance = min(clearance, upper(i) - d, d - lower(i))
      end do
   end subroutine find_clearance

end module rbs_hysteresis_layer_joints
