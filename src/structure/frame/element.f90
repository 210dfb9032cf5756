!> An element of a frame: the part between two nodes, condensed to its ends.
!>
!> Elongation and rotations of the ends against the chord, q, follow from the displacements of the nodes, and
!> work with axial force and end moments, s. By equilibrium the springs in the element carry f = p . s, so
!> that their deformations add up to q = sum p d, and the element is its flexibility F = sum p p'/k. Springs
!> at the points of a Gauss-Lobatto rule, each with the stiffness of its share of the length, make the
!> force-based beam-column element (Neuenhofer and Filippou, J. Struct. Eng. 123 (1997) 958-966).
!>
!> A joint of layers, which open by w + y theta, is two springs. These are its motions along the axes of its
!> stiffness sum k [1 y; y y^2], in the opening at the initial centre of stiffness y_0 and the rotation times
!> the initial radius of gyration, so that they have one unit and are alike at the start. All are condensed by
!> `rbs_structure_condensation`, with the elastic rest as three springs more.
!>
!> Compression N that does second-order work bends the elastic rest off its chord. With x = N l^2/4EI,
!> phi = sqrt(x) and c = (1 - phi cot phi)/x, which is 1/3 without compression, end moments (M, M) and (M, -M)
!> turn the ends by M l c/2EI and M l/2EI(1 - c x), the stability functions of beams (Livesley and Chandler
!> 1956), and a load w across the member by w l^3/24EI 3 c/(1 - c x). Where springs have the flexibility of
!> the member, this less its value without compression is in series with them.
module rbs_structure_frame_element
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_layer_joints, only: stiffness_sums
   implicit none
   private

   public :: frame_element, element_joint, most_columns

   !> Most unknowns that move an element: in a building x of both ends follows from three of a floor, and a
   !> column may have two planes that share its elongation.
   integer, parameter :: most_columns = 11

   !> x at which a member buckles between ends that are clamped.
   real(wp), parameter :: largest_x = acos(-1.0_wp)**2

   !> Below the first the series of c is exact, below the second compression does nothing.
   real(wp), parameter :: small_x = 0.05_wp, no_compression = 1.0e-10_wp

   !> A spring in an element, or a joint of layers.
   type :: element_joint
      !> First and last spring in the element
      integer :: first = 0, last = 0
      logical :: is_single = .true.
      !> Coordinate of its deformation, or of the opening before that of the rotation
      integer :: motion = 0
      !> The condensed spring that it is, or the first of the two
      integer :: spring = 0
      !> Motion of the ends by its deformation, or by w and theta: forces of it by axial force and end moments
      real(wp) :: arm(3, 2) = 0.0_wp
      !> y_0 and rho [m], and the motion of the ends by the opening at y_0 and by rho theta
      real(wp) :: centre = 0.0_wp, radius = 1.0_wp, about_centre(3, 2) = 0.0_wp
      !> Moment of the dead load in its layers [N m]
      real(wp) :: dead_moment = 0.0_wp
   end type element_joint

   type :: frame_element
      !> The nodes at its ends
      integer :: node(2) = 0
      !> Numbers of their displacements among the unknowns, (x, y, theta) each; 0 where a support holds one.
      !> In a building these of x are the first unknown that moves the floor, and others stand behind; how
      !> many there are in all
      integer :: number(most_columns) = 0, width = 6
      !> Elongation and rotations against the chord from the displacements of the nodes, (x, y, theta) each
      real(wp) :: to_basic(3, most_columns) = 0.0_wp
      !> The same, and the rotations of rigid ends and chord, from the unknowns alone, without branches: zero
      !> and the first unknown where a support holds a displacement
      real(wp) :: from_unknowns(3, most_columns) = 0.0_wp, lean(3, most_columns) = 0.0_wp
      integer :: unknown(most_columns) = 1
      !> Rotation of the chord by a displacement along x of either end, held or not [1/m]
      real(wp) :: lean_of_end(2) = 0.0_wp
      !> Springs of the frame before its first; how many bend or slip, and how many open behind these
      integer :: before = 0, bending = 0, opening = 0
      type(element_joint), allocatable :: joint(:)
      !> Distances of layers from the middle of their joint (springs) [m]
      real(wp), allocatable :: y(:)
      !> Condensed springs before those of the rest; their initial stiffness in size (inner), and one against
      !> each motion of the ends
      integer :: inner = 0
      real(wp), allocatable :: initial(:)
      !> Their coordinates: those of the motion of their joint (inner)
      integer, allocatable :: place(:)
      real(wp) :: weight(3) = 0.0_wp
      !> Stiffness of the elastic rest in its two directions, and along the axis; none, if it is rigid
      real(wp), allocatable :: rest(:)
      real(wp) :: rest_along = 0.0_wp
      !> E I [N m2] and G A_s [N] between the ends and their distance [m]; 0 where it does not bend, or slip.
      !> Whether springs have this flexibility
      real(wp) :: flexural_rigidity = 0.0_wp, shear_rigidity = 0.0_wp, length = 0.0_wp
      logical :: lumped = .false.
      !> Lengths of its rigid ends [m]
      real(wp) :: rigid(2) = 0.0_wp
      !> Compression under dead load [N]
      real(wp) :: compression = 0.0_wp
      !> Dead load across it [N/m], and rotations of the ends of the elastic rest under it
      real(wp) :: load_across = 0.0_wp, dead_rotation(2) = 0.0_wp
      !> Whether it is the panel of a node: one spring that deforms by the rotation of columns against beams
      logical :: is_panel = .false.
      !> Whether its ends turn without moments, and whether it is built under the dead load; elongation and
      !> rotations of its ends when it is built
      logical :: pinned = .false., after_dead_load = .false.
      real(wp) :: built_at(3) = 0.0_wp
   contains
      procedure :: follow_floor, leave_out_supports, disconnect, set_initial, condensed, inner_springs
      procedure :: bend_as_springs, set_rest, buckles
   end type frame_element

contains

   !> Columns of the matrices for a building: x of an end follows from unknowns of its floor, by shares.
   pure subroutine follow_floor(self, end_of, factor)
      class(frame_element), intent(inout) :: self
      !> The column of x that each follows from, and its share in it (columns)
      integer, intent(in) :: end_of(most_columns)
      real(wp), intent(in) :: factor(most_columns)
      integer :: k

      ! Backward: the column of x itself, from which others are made, comes before them and is scaled last.
      do k = self%width, 1, -1
         if (end_of(k) == 0) cycle
         self%to_basic(:, k) = factor(k)*self%to_basic(:, end_of(k))
         self%lean(:, k) = factor(k)*self%lean(:, end_of(k))
      end do
   end subroutine follow_floor

   !> Columns for the unknowns alone, from `number`, `to_basic` and `lean`: zero where a support holds one.
   pure subroutine leave_out_supports(self)
      class(frame_element), intent(inout) :: self
      integer :: k

      do k = 1, self%width
         if (self%number(k) > 0) then
            self%unknown(k) = self%number(k)
            self%from_unknowns(:, k) = self%to_basic(:, k)
         else
            self%lean(:, k) = 0.0_wp
         end if
      end do
   end subroutine leave_out_supports

   !> Let no unknown move the element, as long as it is not built.
   pure subroutine disconnect(self)
      class(frame_element), intent(inout) :: self

      self%to_basic = 0.0_wp
      self%from_unknowns = 0.0_wp
      self%lean = 0.0_wp
      self%built_at = 0.0_wp
   end subroutine disconnect

   !> Find E I of a member whose springs hold all of its flexibility: under a moment that is constant it
   !> leaves its chord by the same mean. Springs at its ends alone leave the chord straight, and E I stays
   !> zero.
   pure subroutine bend_as_springs(self, k)
      class(frame_element), intent(inout) :: self
      !> Initial stiffness of all springs of the frame
      real(wp), intent(in) :: k(:)
      real(wp) :: off_chord
      integer :: j

      if (self%is_panel .or. self%flexural_rigidity > 0.0_wp) return
      off_chord = 0.0_wp
      do j = 1, size(self%joint)
         if (.not. self%joint(j)%is_single) cycle
         associate (p => self%joint(j)%arm(2:, 1))
            ! A slip leaves the ends as they are.
            off_chord = off_chord - p(1)*p(2)*(p(2) - p(1))/k(self%before + self%joint(j)%first)
         end associate
      end do
      if (.not. off_chord > 0.0_wp) return
      self%flexural_rigidity = self%length/(6.0_wp*off_chord)
      self%lumped = .true.
   end subroutine bend_as_springs

   !> The elastic rest under compression: it bends as a beam on two supports, with end moments alike or
   !> against each other.
   pure subroutine set_rest(self, compression)
      class(frame_element), intent(inout) :: self
      !> Axial force that does second-order work, compression positive [N]
      real(wp), intent(in) :: compression
      real(wp) :: c, x, flexible(2), added

      self%dead_rotation = 0.0_wp
      if (allocated(self%rest)) deallocate (self%rest)
      if (.not. self%flexural_rigidity > 0.0_wp) return
      x = compression*self%length**2/self%flexural_rigidity/4.0_wp
      ! Springs hold all flexibility, and compression adds none: there is no elastic rest.
      if (self%lumped .and. .not. abs(x) > no_compression) return
      c = shape_of(x)
      ! Moments (M, M) turn both ends by M l/6EI + 2M/(l GA), moments (M, -M) by M l/2EI without compression.
      flexible = [c/4.0_wp, 0.25_wp/(1.0_wp - c*x)]
      added = c/(1.0_wp - c*x)/8.0_wp
      if (self%lumped) then
         ! Only what compression adds is in the rest.
         flexible = flexible - [1.0_wp, 3.0_wp]/12.0_wp
         added = added - 1.0_wp/24.0_wp
      end if
      flexible = flexible*self%length/self%flexural_rigidity
      if (self%shear_rigidity > 0.0_wp) flexible(1) = flexible(1) + 1.0_wp/(self%length*self%shear_rigidity)
      self%rest = 1.0_wp/flexible
      self%dead_rotation = [1.0_wp, -1.0_wp]*added*self%load_across*self%length**3/self%flexural_rigidity
   end subroutine set_rest

   !> Whether the element buckles under compression [N] between clamped ends or, if pinned, between its pins.
   pure logical function buckles(self, compression)
      class(frame_element), intent(in) :: self
      !> Compression positive [N]
      real(wp), intent(in) :: compression

      buckles = compression*self%length**2 >= &
                merge(1.0_wp, 4.0_wp, self%pinned)*largest_x*self%flexural_rigidity &
                .and. self%flexural_rigidity > 0.0_wp
   end function buckles

   !> c = (1 - phi cot phi)/x with x = phi^2, of tension x < 0; see the head of this module.
   pure real(wp) function shape_of(x) result(c)
      !> N l^2/4EI, compression positive
      real(wp), intent(in) :: x
      real(wp), parameter :: term(6) = [1.0_wp/3.0_wp, 1.0_wp/45.0_wp, 2.0_wp/945.0_wp, 1.0_wp/4725.0_wp, &
                                        2.0_wp/93555.0_wp, 1382.0_wp/638512875.0_wp]
      integer :: i

      ! Close to 0 by the series, as the difference loses digits.
      if (abs(x) < small_x) then
         c = 0.0_wp
         do i = size(term), 1, -1
            c = term(i) + x*c
         end do
      else if (x > 0.0_wp) then
         c = (1.0_wp - sqrt(x)/tan(sqrt(x)))/x
      else
         c = (1.0_wp - sqrt(-x)/tanh(sqrt(-x)))/x
      end if
   end function shape_of

   !> Set the initial stiffness of the condensed springs, and what follows from it: their places, the axes of
   !> joints of layers, and a stiffness against each motion of the ends.
   pure subroutine set_initial(self, k)
      class(frame_element), intent(inout) :: self
      !> Of the springs of the element, initial (springs)
      real(wp), intent(in), contiguous :: k(:)
      !> Rows, stiffness and axes, see `inner_springs`; flexibility of the ends; sums k, k y and k y^2 of
      !> layers
      real(wp) :: p(3, self%inner + 3), stiffness(self%inner + 3), flexible(3), turn(2, size(self%joint))
      real(wp) :: sums(3)
      integer :: i, j

      if (allocated(self%initial)) deallocate (self%initial)
      allocate (self%initial(self%inner), source=0.0_wp)
      allocate (self%place(self%inner), source=0)
      do j = 1, size(self%joint)
         associate (of => self%joint(j))
            self%place(of%spring) = of%motion
            self%initial(of%spring) = abs(k(of%first))
            of%about_centre = of%arm
            if (of%is_single) cycle
            self%place(of%spring + 1) = of%motion + 1
            ! Layers together are two springs at their centre of stiffness: they open, and turn by a rotation
            ! times their radius, so that both are lengths.
            sums = stiffness_sums(of%last - of%first + 1, self%y(of%first:of%last), k(of%first:of%last))
            of%centre = sums(2)/sums(1)
            of%radius = sqrt(sum(k(of%first:of%last)*(self%y(of%first:of%last) - of%centre)**2)/sums(1))
            of%about_centre(:, 2) = (of%arm(:, 2) - of%centre*of%arm(:, 1))/of%radius
            self%initial(of%spring:of%spring + 1) = sums(1)
         end associate
      end do
      call self%inner_springs(size(k), k, p, stiffness, turn)
      flexible = 0.0_wp
      do i = 1, self%condensed()
         ! How far each motion of the ends gives way; `weight` is the stiffness against it alone.
         flexible = flexible + p(:, i)**2/abs(stiffness(i))
      end do
      self%weight = 0.0_wp
      where (flexible > 0.0_wp) self%weight = 1.0_wp/flexible
   end subroutine set_initial

   !> Number of condensed springs with those of the elastic rest.
   pure integer function condensed(self)
      class(frame_element), intent(in) :: self

      condensed = self%inner
      if (self%rest_along > 0.0_wp) condensed = condensed + 1
      if (allocated(self%rest)) condensed = condensed + size(self%rest)
   end function condensed

   !> Rows and stiffness of the condensed springs, from a stiffness of the springs of the element.
   pure subroutine inner_springs(self, springs, k, p, stiffness, turn)
      class(frame_element), intent(in) :: self
      !> Number of springs of the element, and their stiffness
      integer, intent(in) :: springs
      real(wp), intent(in) :: k(springs)
      !> (3, condensed), (condensed); cosine and sine of the axes of a joint of layers (2, joints)
      real(wp), intent(out) :: p(:, :), stiffness(:), turn(:, :)
      integer :: i, j

      do j = 1, size(self%joint)
         associate (of => self%joint(j), at => self%joint(j)%spring)
            if (of%is_single) then
               p(:, at) = of%arm(:, 1)
               stiffness(at) = k(of%first)
               cycle
            end if
            call find_axes(of%last - of%first + 1, self%y(of%first:of%last), k(of%first:of%last), of%centre, &
                           of%radius, stiffness(at:at + 1), turn(:, j))
            p(:, at) = turn(1, j)*of%about_centre(:, 1) + turn(2, j)*of%about_centre(:, 2)
            p(:, at + 1) = turn(1, j)*of%about_centre(:, 2) - turn(2, j)*of%about_centre(:, 1)
         end associate
      end do
      ! The elastic rest of the member: along its axis, in double and in single curvature.
      i = self%inner
      if (self%rest_along > 0.0_wp) then
         i = i + 1
         p(:, i) = [1.0_wp, 0.0_wp, 0.0_wp]
         stiffness(i) = self%rest_along
      end if
      if (allocated(self%rest)) then
         p(:, i + 1) = [0.0_wp, 1.0_wp, 1.0_wp]
         p(:, i + 2) = [0.0_wp, 1.0_wp, -1.0_wp]
         stiffness(i + 1:i + 2) = self%rest
      end if
   end subroutine inner_springs

   !> Stiffness of a joint of layers along the two axes in which its matrix is diagonal, and their directions.
   pure subroutine find_axes(n, y, k, centre, radius, stiffness, turn)
      !> Number of layers
      integer, intent(in) :: n
      !> Distances of the layers from the middle [m], their stiffness [N/m]; y_0 and rho of `element_joint`
      !> [m]
      real(wp), intent(in) :: y(n), k(n), centre, radius
      !> [N/m]; cosine and sine of the turn of the axes
      real(wp), intent(out) :: stiffness(2), turn(2)
      !> Sums k, k y and k y^2; the term between the axes; cotangent of twice the turn; tangent of the turn
      real(wp) :: sums(3), across, ratio, tangent

      sums = stiffness_sums(n, (y - centre)/radius, k)
      across = sums(2)
      stiffness = [sums(1), sums(3)]
      turn = [1.0_wp, 0.0_wp]
      if (.not. abs(across) > epsilon(1.0_wp)*maxval(abs(stiffness))) return
      ! Jacobi's rotation: the smaller angle.
      ratio = (sums(3) - sums(1))/(2.0_wp*across)
      tangent = sign(1.0_wp, ratio)/(abs(ratio) + hypot(1.0_wp, ratio))
      turn(1) = 1.0_wp/hypot(1.0_wp, tangent)
      turn(2) = -tangent*turn(1)
      stiffness = [sums(1) - tangent*across, sums(3) + tangent*across]
   end subroutine find_axes

end module rbs_structure_frame_element
