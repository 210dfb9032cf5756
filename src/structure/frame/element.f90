!> An element of a frame: the part between two nodes, condensed to its ends.
!>
!> Elongation and rotations of the ends against the chord, q, follow from the displacements of the nodes, and
!> work with axial force and end moments, s. By equilibrium the springs in the element carry f = p . s, so
!> that their deformations add up to q = sum p d, and the element is its flexibility F = sum p p'/k. Springs
!> at the points of a Gauss-Lobatto rule, each with the stiffness of its share of the length, make the
!> force-based beam-column element (Neuenhofer and Filippou, J. Struct. Eng. 123 (1997) 958-966).
!>
!> Springs may have no stiffness, so that nothing is divided by one. With p = (p_a, p_b), r = (-p_b, p_a) and
!> p x p' = p_a p'_b - p_b p'_a, by the theorem of Cauchy and Binet and K = F^-1,
!>
!>     det F = sum_(i<j) (p_i x p_j)^2/(k_i k_j),   K = sum r_i r_i'/k_i / det F,
!>     dd_j/dq = K p_j/k_j = sum_i (p_i x p_j) r_i/(k_i k_j) / det F
!>
!> where the product of all k is taken into numerator and denominator. Forces f that are not in equilibrium
!> are brought there by deformations -H f,
!>
!>     H_ij = delta_ij/k_i - p_i' K p_j/(k_i k_j)
!>
!> Joints of layers are condensed by their compliances: with w and theta of a joint, z = (w, theta) or the one
!> deformation of a single spring, q = sum P z + F_rest s and K_j z' = P' s', so that
!>
!>     F = sum P K_j^-1 P' + F_rest,   K_j = sum k [1 y; y y^2],   layers open by w + y theta
!>
!> Compression N that does second-order work bends the elastic rest off its chord. With x = N l^2/4EI,
!> phi = sqrt(x) and c = (1 - phi cot phi)/x, which is 1/3 without compression, end moments (M, M) and (M, -M)
!> turn the ends by M l c/2EI and M l/2EI(1 - c x), the stability functions of beams (Livesley and Chandler
!> 1956), and a load w across the member by w l^3/24EI 3 c/(1 - c x). Where springs have the flexibility of
!> the member, this less its value without compression is in series with them.
module rbs_structure_frame_element
   use rbs_base_constants, only: no_stiffness
   use rbs_base_kinds, only: wp
   implicit none
   private

   public :: frame_element, find_tangent, find_forces, end_forces, find_rates, motion_of_rest, unbalance
   public :: shared, joint_numbers

   !> Springs without stiffness share a motion as if each had this part of its initial one.
   real(wp), parameter :: shared = 1.0e-9_wp

   !> A sum below this share of its terms is round-off.
   real(wp), parameter :: round_off = 8.0_wp*epsilon(1.0_wp)

   !> x at which a member buckles between ends that are clamped.
   real(wp), parameter :: largest_x = acos(-1.0_wp)**2

   !> Below the first the series of c is exact, below the second compression does nothing.
   real(wp), parameter :: small_x = 0.05_wp, no_compression = 1.0e-10_wp

   !> Where the numbers of an element begin in the work array of all tangents of a frame.
   type :: tangent_layout
      !> K (3, 3), and behind it the state: 0 before the tangent is found, 2 if springs without stiffness
      !> share a motion, else 1, and with a minus sign where the element snaps back
      integer :: stiffness = 1
      !> Deformations per motion of the ends, dd/dq (3, springs); of joints of layers see `layered_tangent`
      !> (of_joint, joints)
      integer :: rate = 1
      !> H of springs that bend, and of those that open
      integer :: bent = 1, opened = 1
      !> Stiffness of the springs that the tangent belongs to (springs)
      integer :: branch = 1
   end type tangent_layout

   type :: frame_element
      !> The nodes at its ends
      integer :: node(2) = 0
      !> Numbers of their displacements among the unknowns, (x, y, theta) each; 0 where a support holds one
      integer :: number(6) = 0
      !> Elongation and rotations against the chord from the displacements of the nodes, (x, y, theta) each
      real(wp) :: to_basic(3, 6) = 0.0_wp
      !> The same, and the rotations of rigid ends and chord, from the unknowns alone, without branches: zero
      !> and the first unknown where a support holds a displacement
      real(wp) :: from_unknowns(3, 6) = 0.0_wp, lean(3, 6) = 0.0_wp
      integer :: unknown(6) = 1
      !> Springs of the frame before its first; how many bend or slip, and how many open behind these
      integer :: before = 0, bending = 0, opening = 0
      !> Moments of the ends per force of a spring, p, of those that bend, then of the elastic rest
      !> (2, bending + rest)
      real(wp), allocatable :: share(:, :)
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
      type(tangent_layout) :: layout
      !> Joints, if some are of layers: first spring of each in the element, and one more (joints + 1); motion
      !> (w, theta) of each by axial force and end moments (3, 2, joints); distances of the layers
      !> (springs) [m]
      logical :: layered = .false.
      integer, allocatable :: first(:)
      !> Coordinate of the opening of each, before that of its rotation, or of its one deformation; whether it
      !> is one spring; moment of the dead load in its layers (joints)
      integer, allocatable :: motion(:)
      logical, allocatable :: is_single(:)
      real(wp), allocatable :: dead_moment(:)
      real(wp), allocatable :: arm(:, :, :), y(:)
   contains
      procedure :: leave_out_supports
      procedure :: disconnect
      procedure :: lay_out
      procedure :: bend_as_springs
      procedure :: set_rest
      procedure :: buckles
   end type frame_element

   !> Numbers of a joint of layers in a tangent.
   integer, parameter :: joint_numbers = 6

contains

   !> Rows per unknown from `number`, `to_basic` and `lean`: zero where a support holds a displacement.
   pure subroutine leave_out_supports(self)
      class(frame_element), intent(inout) :: self
      integer :: k

      do k = 1, 6
         if (self%number(k) > 0) then
            self%unknown(k) = self%number(k)
            self%from_unknowns(:, k) = self%to_basic(:, k)
         else
            self%lean(:, k) = 0.0_wp
         end if
      end do
   end subroutine leave_out_supports

   !> Let no unknown move it, as long as it is not built.
   pure subroutine disconnect(self)
      class(frame_element), intent(inout) :: self

      self%to_basic = 0.0_wp
      self%from_unknowns = 0.0_wp
      self%lean = 0.0_wp
      self%built_at = 0.0_wp
   end subroutine disconnect

   !> E I of a member whose springs hold all of its flexibility: under a moment that is constant it leaves its
   !> chord by the same mean. Springs at its ends alone leave the chord straight.
   pure subroutine bend_as_springs(self, k)
      class(frame_element), intent(inout) :: self
      !> Initial stiffness of all springs
      real(wp), intent(in) :: k(:)
      real(wp) :: off_chord
      integer :: j

      if (self%is_panel .or. self%flexural_rigidity > 0.0_wp) return
      off_chord = 0.0_wp
      do j = 1, self%bending
         associate (p => self%share(:, j))
            ! A slip leaves the ends as they are.
            off_chord = off_chord - p(1)*p(2)*(p(2) - p(1))/k(self%before + j)
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
      real(wp) :: springs(2, self%bending), c, x, flexible(2), added

      self%dead_rotation = 0.0_wp
      springs = self%share(:, :self%bending)
      self%share = springs
      if (allocated(self%rest)) deallocate (self%rest)
      if (.not. self%flexural_rigidity > 0.0_wp) return
      x = compression*self%length**2/self%flexural_rigidity/4.0_wp
      if (self%lumped .and. .not. abs(x) > no_compression) return
      c = shape_of(x)
      ! Moments (M, M) turn both ends by M l/6EI + 2M/(l GA), moments (M, -M) by M l/2EI without compression.
      flexible = [c/4.0_wp, 0.25_wp/(1.0_wp - c*x)]
      added = c/(1.0_wp - c*x)/8.0_wp
      if (self%lumped) then
         flexible = flexible - [1.0_wp, 3.0_wp]/12.0_wp
         added = added - 1.0_wp/24.0_wp
      end if
      flexible = flexible*self%length/self%flexural_rigidity
      if (self%shear_rigidity > 0.0_wp) flexible(1) = flexible(1) + 1.0_wp/(self%length*self%shear_rigidity)
      self%rest = 1.0_wp/flexible
      self%dead_rotation = [1.0_wp, -1.0_wp]*added*self%load_across*self%length**3/self%flexural_rigidity
      self%share = reshape([springs, 1.0_wp, 1.0_wp, 1.0_wp, -1.0_wp], [2, self%bending + 2])
   end subroutine set_rest

   !> Whether it buckles under compression [N] where its ends are clamped, or between its pins.
   pure logical function buckles(self, compression)
      class(frame_element), intent(in) :: self
      real(wp), intent(in) :: compression

      buckles = compression*self%length**2 >= &
                merge(1.0_wp, 4.0_wp, self%pinned)*largest_x*self%flexural_rigidity &
                .and. self%flexural_rigidity > 0.0_wp
   end function buckles

   !> c = (1 - phi cot phi)/x with x = phi^2; of tension x < 0.
   pure real(wp) function shape_of(x) result(c)
      real(wp), intent(in) :: x
      real(wp), parameter :: term(6) = [1.0_wp/3.0_wp, 1.0_wp/45.0_wp, 2.0_wp/945.0_wp, 1.0_wp/4725.0_wp, &
                                        2.0_wp/93555.0_wp, 1382.0_wp/638512875.0_wp]
      integer :: i

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

   !> Place the tangent of an element behind others in their work array.
   pure subroutine lay_out(self, numbers)
      class(frame_element), intent(inout) :: self
      !> In the work array, so far and with this element
      integer, intent(inout) :: numbers

      associate (layout => self%layout, m => self%bending, n => self%opening)
         layout%stiffness = numbers + 1
         layout%rate = layout%stiffness + 10
         if (self%layered) then
            layout%branch = layout%rate + joint_numbers*(size(self%first) - 1)
         else
            layout%bent = layout%rate + 3*(m + n)
            layout%opened = layout%bent + m**2
            layout%branch = layout%opened + n**2
         end if
         numbers = layout%branch + m + n - 1
      end associate
   end subroutine lay_out

   !> Stiffness and rates on lines of the springs.
   pure subroutine find_tangent(element, m, n, k, k0, stiffness, rate, bent, opened, stable, shares)
      type(frame_element), intent(in) :: element
      !> Numbers of springs that bend, and that open
      integer, intent(in) :: m, n
      !> Present and initial stiffness of the springs of the element, those that bend first
      real(wp), intent(in) :: k(m + n), k0(m + n)
      !> K, dd/dq, and H of both
      real(wp), intent(out) :: stiffness(3, 3), rate(3, m + n), bent(m, m), opened(n, n)
      !> Whether the motion of the ends determines that inside: the element does not snap back; whether
      !> springs without stiffness share a motion
      logical, intent(out) :: stable, shares
      real(wp) :: of_ends(2, 2), of_rotations(2, m), open_up(n)
      logical :: stable_along

      call bend(size(element%share, 2), m, element%share, [k0(:m), rest_of(element)], &
                [k(:m), rest_of(element)], of_ends, of_rotations, bent, stable, shares)
      call elongate(n, element%rest_along, k0(m + 1:), k(m + 1:), stiffness(1, 1), open_up, opened, &
                   stable_along)
      stiffness(2:, 1) = 0.0_wp
      stiffness(1, 2:) = 0.0_wp
      stiffness(2:, 2:) = of_ends
      rate = 0.0_wp
      rate(2:, :m) = of_rotations
      rate(1, m + 1:) = open_up
      stable = stable .and. stable_along
   end subroutine find_tangent

   !> Forces of the ends that are in equilibrium with forces of the springs, and the corrections of their
   !> deformations that this needs.
   pure subroutine find_forces(e, m, n, stiffness, rate, bent, opened, misfit, f, dead, dead_force, s, &
                               correction)
      type(frame_element), intent(in) :: e
      !> Numbers of springs that bend, and that open
      integer, intent(in) :: m, n
      !> Of `find_tangent`
      real(wp), intent(in) :: stiffness(3, 3), rate(3, m + n), bent(m, m), opened(n, n)
      !> The misfit, motion of the ends less the deformations; forces of the springs, the share of
      !> the dead load that acts, and its forces in them
      real(wp), intent(in) :: misfit(3), f(m + n), dead, dead_force(m + n)
      real(wp), intent(out) :: s(3), correction(m + n)
      real(wp) :: force, left(3)
      integer :: i, j

      s = forces_inside(m + n, rate, f, dead, dead_force)
      left = misfit - motion_of_rest(e, s)
      do j = 1, m + n
         correction(j) = rate(1, j)*left(1) + rate(2, j)*left(2) + rate(3, j)*left(3)
      end do
      do j = 1, m
         force = unbalance(f(j) - dead*dead_force(j), 0.0_wp, e%share(1, j)*s(2), e%share(2, j)*s(3))
         do i = 1, m
            correction(i) = correction(i) - bent(i, j)*force
         end do
      end do
      do j = 1, n
         force = unbalance(f(m + j) - dead*dead_force(m + j), s(1), 0.0_wp, 0.0_wp)
         do i = 1, n
            correction(m + i) = correction(m + i) - opened(i, j)*force
         end do
      end do
      s = s + forces_of(stiffness, misfit)
   end subroutine find_forces

   !> Forces of the ends alone.
   pure function end_forces(m, stiffness, rate, misfit, f, dead_force) result(s)
      !> See `find_forces`, under all of the dead load
      integer, intent(in) :: m
      real(wp), intent(in) :: stiffness(3, 3), rate(3, m), misfit(3), f(m), dead_force(m)
      real(wp) :: s(3)

      s = forces_inside(m, rate, f, 1.0_wp, dead_force) + forces_of(stiffness, misfit)
   end function end_forces

   !> Forces of the ends that forces of springs without the dead load make where the ends are held.
   pure function forces_inside(m, rate, f, dead, dead_force) result(s)
      integer, intent(in) :: m
      real(wp), intent(in) :: rate(3, m), f(m), dead, dead_force(m)
      real(wp) :: s(3)
      integer :: j

      s = 0.0_wp
      do j = 1, m
         s = s + rate(:, j)*(f(j) - dead*dead_force(j))
      end do
   end function forces_inside

   pure function forces_of(stiffness, misfit) result(s)
      real(wp), intent(in) :: stiffness(3, 3), misfit(3)
      real(wp) :: s(3)

      s = stiffness(:, 1)*misfit(1) + stiffness(:, 2)*misfit(2) + stiffness(:, 3)*misfit(3)
   end function forces_of

   !> Motion of the ends that forces of the ends make in the elastic rest.
   pure function motion_of_rest(e, s) result(q)
      type(frame_element), intent(in) :: e
      real(wp), intent(in) :: s(3)
      real(wp) :: q(3), alike, against

      q = 0.0_wp
      if (e%rest_along > 0.0_wp) q(1) = s(1)/e%rest_along
      if (.not. allocated(e%rest)) return
      alike = (s(2) + s(3))/e%rest(1)
      against = (s(2) - s(3))/e%rest(2)
      q(2:) = [alike + against, alike - against]
   end function motion_of_rest

   !> Force of a spring or joint less the effect of end forces there, term by term. Round-off of it is none:
   !> a joint all but without stiffness would move far for it, and back in the next trial.
   pure real(wp) function unbalance(force, first, second, third)
      real(wp), intent(in) :: force, first, second, third

      unbalance = force - (first + second + third)
      associate (terms => abs(force) + (abs(first) + abs(second) + abs(third)))
         if (abs(unbalance) <= round_off*terms) unbalance = 0.0_wp
      end associate
   end function unbalance

   !> Changes of the deformations with those of the ends.
   pure subroutine find_rates(springs, rate, q, dd)
      integer, intent(in) :: springs
      real(wp), intent(in) :: rate(3, springs), q(3)
      real(wp), intent(out) :: dd(springs)
      integer :: j

      do j = 1, springs
         dd(j) = rate(1, j)*q(1) + rate(2, j)*q(2) + rate(3, j)*q(3)
      end do
   end subroutine find_rates

   pure function rest_of(element) result(rest)
      type(frame_element), intent(in) :: element
      real(wp) :: rest(size(element%share, 2) - element%bending)

      if (size(rest) > 0) rest = element%rest
   end function rest_of

   pure subroutine bend(all, m, p, k0, k, stiffness, rate, bent, stable, shares)
      !> Springs with the elastic rest, springs
      integer, intent(in) :: all, m
      real(wp), intent(in) :: p(2, all), k0(all), k(all)
      real(wp), intent(out) :: stiffness(2, 2), rate(2, m), bent(m, m)
      logical, intent(out) :: stable, shares
      !> Moments over roots of the initial stiffness, and stiffness over the initial one
      real(wp) :: share(2, all), soft(all), across(2, all), determinant, initial, root(all)
      integer :: i, j, l

      root = sqrt(abs(k0))
      do i = 1, all
         share(:, i) = p(:, i)/root(i)
         across(:, i) = [-share(2, i), share(1, i)]
      end do
      soft = k/abs(k0)
      initial = determinant_of(spread(1.0_wp, 1, all))
      determinant = determinant_of(soft)
      stable = determinant > -no_stiffness*initial
      stiffness = 0.0_wp
      do i = 1, all
         do j = 1, 2
            stiffness(:, j) = stiffness(:, j) + others([i])*across(:, i)*across(j, i)
         end do
      end do
      shares = abs(determinant) <= no_stiffness*initial
      if (shares) then
         ! More springs than the ends determine have no stiffness.
         soft = merge(shared, soft, abs(soft) < shared)
         determinant = determinant_of(soft)
      end if
      stiffness = stiffness/determinant
      rate = 0.0_wp
      bent = 0.0_wp
      do j = 1, m
         do i = 1, all
            if (i /= j) rate(:, j) = rate(:, j) + cross(i, j)*others([i, j])*across(:, i)
         end do
         rate(:, j) = rate(:, j)/(determinant*root(j))
         do i = 1, m
            do l = 1, all
               if (l /= i .and. l /= j .and. i /= j) then
                  bent(i, j) = bent(i, j) - cross(l, i)*cross(l, j)*others([i, j, l])
               end if
            end do
         end do
         do i = 1, all
            do l = i + 1, all
               if (i /= j .and. l /= j) bent(j, j) = bent(j, j) + cross(i, l)**2*others([i, j, l])
            end do
         end do
         bent(:, j) = bent(:, j)/(determinant*root(j)*root(:m))
      end do

   contains

      pure real(wp) function cross(a, b)
         integer, intent(in) :: a, b

         cross = share(1, a)*share(2, b) - share(2, a)*share(1, b)
      end function cross

      !> Product of the stiffness of all but some.
      pure real(wp) function others(some)
         integer, intent(in) :: some(:)
         integer :: a

         others = 1.0_wp
         do a = 1, all
            if (.not. any(some == a)) others = others*soft(a)
         end do
      end function others

      pure real(wp) function determinant_of(stiff) result(total)
         real(wp), intent(in) :: stiff(all)
         integer :: a, b, c
         real(wp) :: product_of_others

         total = 0.0_wp
         do b = 2, all
            do a = 1, b - 1
               product_of_others = 1.0_wp
               do c = 1, all
                  if (c /= a .and. c /= b) product_of_others = product_of_others*stiff(c)
               end do
               total = total + cross(a, b)**2*product_of_others
            end do
         end do
      end function determinant_of

   end subroutine bend

   !> Springs that open, one behind the other, and the elastic rest.
   pure subroutine elongate(n, rest, k0, k, stiffness, rate, opened, stable)
      integer, intent(in) :: n
      real(wp), intent(in) :: rest, k0(n), k(n)
      real(wp), intent(out) :: stiffness, rate(n), opened(n, n)
      logical, intent(out) :: stable
      real(wp) :: flexible
      integer :: i, j

      stable = .true.
      stiffness = rest
      if (n == 0) return
      associate (least => shared*no_stiffness*k0)
         flexible = sum(1.0_wp/sign(max(abs(k), least), k))
         if (rest > 0.0_wp) flexible = flexible + 1.0_wp/rest
         stable = flexible > 0.0_wp
         stiffness = 1.0_wp/flexible
         rate = 1.0_wp/(sign(max(abs(k), least), k)*flexible)
         do j = 1, n
            do i = 1, n
               opened(i, j) = -rate(i)*rate(j)*flexible
            end do
            opened(j, j) = opened(j, j) + rate(j)*flexible
         end do
      end associate
   end subroutine elongate

end module rbs_structure_frame_element
