!> The dynamic stiffness K - s M of the chain, by elimination from the top down: the number of its negative
!> pivots is that of the squared frequencies below s (a Sturm sequence), and the same pivots solve it.
!>
!> The bodies above joint i, each joint between them in equilibrium, answer the motion (x, th) of its upper
!> side like the negative stiffness -T, a 2 by 2 matrix. A body adds its inertia and its axial force to T, a
!> rigid arm shifts it, and a joint k in series makes of it
!>
!>     T + C' (k - T)^-1 C,  C = T + b e_1 e_2'
!>
!> with the pivots of k - T. Below the lowest frequency and without tension all terms have one sign, so
!> stiffnesses and masses have no more than relative errors of round-off: the assembled band of K - s M would
!> lose the low frequencies of a long chain, which are differences of large numbers in it.
!>
!> Openings, which nothing couples to slips and rotations, are a chain of their own that does not rotate.
module rbs_structure_column_sturm
   use rbs_base_kinds, only: wp
   use rbs_structure_dynamic_stiffness, only: dynamic_stiffness
   implicit none
   private

   public :: sturm_chain, sturm_chain_of

   type, extends(dynamic_stiffness) :: sturm_chain
      private
      !> Number of bodies, and of joints
      integer :: n = 0
      !> Whether the last body is held against rotation
      logical :: held = .false.
      !> Stiffness of the joints against translation and rotation (2, n) [N/m, N m]
      real(wp), allocatable :: k(:, :)
      !> Distance of the centroid from the bottom and from the top of the body (n) [m]; axial force times
      !> length of each body [N m], axial force across the slip of each joint [N], compression positive (n)
      real(wp), allocatable :: lower(:), upper(:), turning(:), sliding(:)
      !> Pivots, T and C of the joints at the last shift (7, n)
      real(wp), allocatable :: joint(:, :)
   contains
      procedure :: factor, solve, motion, stiffness_of, sum_of_squares
   end type sturm_chain

contains

   !> A chain from its joints and bodies.
   pure type(sturm_chain) function sturm_chain_of(along, about, mass, inertia, lower, upper, axial, held) &
      result(self)
      !> Stiffness of the joints against translation and rotation, masses and rotary inertias of the bodies,
      !> distances of their centroids from bottom and top (n)
      real(wp), intent(in) :: along(:), about(:), mass(:), inertia(:), lower(:), upper(:)
      !> Axial forces times lengths of the bodies [N m], then axial forces across the slips [N], compression
      !> positive (2 n)
      real(wp), intent(in) :: axial(:)
      !> Whether the last body is held against rotation
      logical, intent(in) :: held
      integer :: n

      n = size(mass)
      self%n = n
      self%held = held
      self%k = transpose(reshape([along, about], [n, 2]))
      self%inertia = reshape(transpose(reshape([mass, inertia], [n, 2])), [2*n])
      self%modes = count(self%inertia > 0.0_wp) - merge(1, 0, held)
      allocate (self%joint(7, n), self%reach(2*n), source=1.0_wp)
      ! In modes a translation is about the height times a rotation; a chain of openings does not turn.
      self%reach(::2) = sum(lower + upper)
      if (.not. any(inertia > 0.0_wp)) self%reach = 1.0_wp
      self%lower = lower
      self%upper = upper
      self%turning = axial(:n)
      self%sliding = axial(n + 1:)
   end function sturm_chain_of

   !> Eliminate at the shift s, with the axial forces times a multiple; the number of squared frequencies
   !> below s.
   integer function factor(self, s, multiple) result(below)
      class(sturm_chain), intent(inout) :: self
      !> Square of a circular frequency [1/s2]
      real(wp), intent(in) :: s
      !> 1, if it is not given
      real(wp), intent(in), optional :: multiple
      real(wp) :: axial

      axial = 1.0_wp
      if (present(multiple)) axial = multiple
      call eliminate(self%n, self%held, self%k, self%inertia, self%lower, self%upper, self%turning, &
                     self%sliding, s, axial, self%joint, below)
   end function factor

   !> Eliminate slip and rotation of the joints from the top down, see the head of this module. Two shifts by
   !> `arm` move T from the top of a body over its centroid, where its inertia is added, to its bottom.
   pure subroutine eliminate(n, held, k, mass, lower, upper, turning, sliding, s, axial, joint, below)
      !> Number of bodies; whether the last one is held against rotation
      integer, intent(in) :: n
      logical, intent(in) :: held
      !> Stiffness of the joints, mass and rotary inertia of the bodies, their lengths and axial forces as in
      !> `sturm_chain`; shift [1/s2]; multiple of the axial forces
      real(wp), intent(in) :: k(2, n), mass(2, n), lower(n), upper(n), turning(n), sliding(n), s, axial
      !> For each joint: inverse pivots (1, 2), T (3, 4) and C (5 to 7), as `substitute` needs them
      real(wp), intent(out) :: joint(7, n)
      !> Number of negative pivots
      integer, intent(out) :: below
      real(wp) :: t11, t12, t22, c12, c21, c22, arm, b, p1, p2, stiffer
      integer :: i

      below = 0
      t11 = 0.0_wp
      t12 = 0.0_wp
      t22 = 0.0_wp
      do i = n, 1, -1
         arm = upper(i)
         t22 = t22 + arm*(2.0_wp*t12 + arm*t11)
         t12 = t12 + arm*t11
         t11 = t11 + s*mass(1, i)
         t22 = t22 + s*mass(2, i)
         t22 = t22 + axial*turning(i)
         arm = lower(i)
         t22 = t22 + arm*(2.0_wp*t12 + arm*t11)
         t12 = t12 + arm*t11

         p1 = k(1, i) - t11
         ! A small pivot in place of zero changes nothing but round-off.
         if (.not. abs(p1) > 0.0_wp) p1 = epsilon(1.0_wp)*k(1, i)
         if (p1 < 0.0_wp) below = below + 1
         p1 = 1.0_wp/p1
         if (held .and. i == n) then
            ! A body held against rotation moves along x only; its joint turns by minus the rotation below.
            joint(:, i) = [p1, 0.0_wp, t11, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp]
            t12 = 0.0_wp
            t22 = -k(2, n)
            t11 = t11*(k(1, i)*p1)
            cycle
         end if
         ! T and C after elimination of the slip
         t22 = t22 + t12*(t12*p1)
         b = axial*sliding(i)*p1
         c12 = t12 + axial*sliding(i)
         c21 = t12*(k(1, i)*p1)
         c22 = t22 + t12*b
         p2 = k(2, i) - t22
         if (.not. abs(p2) > 0.0_wp) p2 = epsilon(1.0_wp)*k(2, i)
         if (p2 < 0.0_wp) below = below + 1
         p2 = 1.0_wp/p2
         joint(:, i) = [p1, p2, t11, t12, c12, c21, c22]
         ! Products in place of sums, which may have two signs above the lowest frequency
         stiffer = k(2, i)*p2
         t22 = (t22 + 2.0_wp*t12*b)*stiffer + axial*sliding(i)*b + (t12*b)*(t12*b*p2)
         t12 = c21*stiffer + b*(t11 + c21*(t12*p2))
         t11 = t11*(k(1, i)*p1) + c21*(c21*p2)
      end do
   end subroutine eliminate

   !> Solve (K - s M) d = M x: slips and relative rotations of the joints under inertia forces of the bodies.
   subroutine solve(self, x, d)
      class(sturm_chain), intent(in) :: self
      !> Displacement and rotation of each body in turn (2 n)
      real(wp), intent(in), contiguous :: x(:)
      !> Slip and relative rotation of each joint in turn (2 n)
      real(wp), intent(out), contiguous :: d(:)

      call substitute(self, self%inertia*x, d)
   end subroutine solve

   !> Deformations under loads: forces from the top down, deformations from the ground up.
   pure subroutine substitute(self, load, d)
      type(sturm_chain), intent(in) :: self
      !> Force and moment on each body (2, n)
      real(wp), intent(in) :: load(2, self%n)
      !> Slip and relative rotation of each joint (2, n)
      real(wp), intent(out) :: d(2, self%n)
      real(wp) :: force, moment, half, top, turned
      integer :: i

      ! Of a joint are known: its inverse pivots (1, 2), T (3, 4) and C (5 to 7).
      force = 0.0_wp
      moment = 0.0_wp
      do i = self%n, 1, -1
         moment = moment + self%upper(i)*force
         force = force + load(1, i)
         moment = moment + load(2, i) + self%lower(i)*force
         d(1, i) = force*self%joint(1, i)
         half = moment + self%joint(4, i)*d(1, i)
         d(2, i) = half*self%joint(2, i)
         force = force*(self%k(1, i)*self%joint(1, i)) + self%joint(6, i)*d(2, i)
         moment = moment + self%joint(5, i)*d(1, i) + self%joint(7, i)*d(2, i)
         ! The support of a held body takes the moment.
         if (self%held .and. i == self%n) moment = 0.0_wp
      end do
      top = 0.0_wp
      turned = 0.0_wp
      do i = 1, self%n
         associate (p1 => self%joint(1, i), p2 => self%joint(2, i), t11 => self%joint(3, i), &
                    t12 => self%joint(4, i), c12 => self%joint(5, i), c21 => self%joint(6, i), &
                    c22 => self%joint(7, i))
            d(2, i) = d(2, i) + (c21*top + c22*turned)*p2
            d(1, i) = d(1, i) + (t11*top + c12*turned + t12*d(2, i))*p1
            ! The joint of a held body turns by minus the rotation below.
            if (self%held .and. i == self%n) d(2, i) = -turned
            turned = turned + d(2, i)
            top = top + d(1, i) + (self%lower(i) + self%upper(i))*turned
         end associate
      end do
   end subroutine substitute

   !> Motion of the bodies from that of the joints.
   pure subroutine motion(self, d, x)
      class(sturm_chain), intent(in) :: self
      !> Slip and relative rotation of each joint in turn (2 n)
      real(wp), intent(in), contiguous :: d(:)
      !> Displacement and rotation of each body in turn (2 n)
      real(wp), intent(out), contiguous :: x(:)
      real(wp) :: top, turned
      integer :: i

      top = 0.0_wp
      turned = 0.0_wp
      do i = 1, self%n
         turned = turned + d(2*i)
         x(2*i) = turned
         x(2*i - 1) = top + d(2*i - 1) + self%lower(i)*turned
         top = x(2*i - 1) + self%upper(i)*turned
      end do
      if (self%held) x(2*self%n) = 0.0_wp
   end subroutine motion

   !> d' K d of a motion: that of the springs less that of the axial forces.
   pure real(wp) function stiffness_of(self, d, x) result(total)
      class(sturm_chain), intent(in) :: self
      !> Slip and relative rotation of each joint, and displacement and rotation of each body, in turn (2 n)
      real(wp), intent(in), contiguous :: d(:), x(:)
      integer :: i

      total = 0.0_wp
      do i = 1, self%n
         total = total + (self%k(1, i)*d(2*i - 1)**2 + self%k(2, i)*d(2*i)**2)
      end do
      total = total - sum(self%turning*x(2::2)**2)
      do i = 2, self%n
         total = total - 2.0_wp*self%sliding(i)*d(2*i - 1)*x(2*i - 2)
      end do
   end function stiffness_of

   !> The trace of M^-1 K, which bounds the sum of the squared frequencies, as axial forces count by size
   !> [1/s2].
   pure real(wp) function sum_of_squares(self) result(total)
      class(sturm_chain), intent(in) :: self
      real(wp) :: turned
      integer :: i, n

      n = self%n
      total = sum((self%k(1, :) + [self%k(1, 2:), 0.0_wp])/self%inertia(::2))
      do i = 1, n
         if (self%held .and. i == n .or. .not. self%inertia(2*i) > 0.0_wp) cycle
         turned = self%k(1, i)*self%lower(i)**2 + self%k(2, i) + abs(self%turning(i))
         if (i < n) turned = turned + self%k(1, i + 1)*self%upper(i)**2 + self%k(2, i + 1) &
                             + 2.0_wp*abs(self%sliding(i + 1))*self%upper(i)
         total = total + turned/self%inertia(2*i)
      end do
   end function sum_of_squares

end module rbs_structure_column_sturm
