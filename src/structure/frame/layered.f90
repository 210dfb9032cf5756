!> Elements of a frame with joints of layers: each layer is a spring of its own, but a joint moves and resists
!> as a whole, by its opening and its rotation. Sums over its layers are all that its element needs; see
!> `rbs_structure_frame_element` for the formulas.
module rbs_structure_frame_layered
   use rbs_base_kinds, only: wp
   use rbs_structure_frame_element, only: frame_element, motion_of_rest, of_joint, shared, unbalance
   implicit none
   private

   public :: layered_tangent, layered_forces, layered_rates, drop_small_rates, joint_motion, &
             take_joints_off

contains

   !> Stiffness of an element with joints of layers, and the compliances of its joints.
   pure subroutine layered_tangent(e, m, k, k0, stiffness, soft, stable)
      type(frame_element), intent(in) :: e
      integer, intent(in) :: m
      !> Present and initial stiffness of its springs
      real(wp), intent(in) :: k(m), k0(m)
      real(wp), intent(out) :: stiffness(3, 3), soft(of_joint, size(e%first) - 1)
      !> Whether it does not snap back: each joint that softens is held by the rest of the element
      logical, intent(out) :: stable
      real(wp) :: flexible(3, 3), now(3), whole(3), determinant, minor(3)
      integer :: i, j, softening

      flexible = 0.0_wp
      if (e%rest_along > 0.0_wp) flexible(1, 1) = 1.0_wp/e%rest_along
      if (allocated(e%rest)) then
         flexible(2:, 2:) = 1.0_wp/e%rest(1)
         flexible(2, 2) = flexible(2, 2) + 1.0_wp/e%rest(2)
         flexible(3, 3) = flexible(3, 3) + 1.0_wp/e%rest(2)
         flexible(2, 3) = flexible(2, 3) - 1.0_wp/e%rest(2)
         flexible(3, 2) = flexible(2, 3)
      end if
      softening = 0
      ! Beyond Euler's load; under tension a rest that takes off flexibility of springs is none of its own.
      if (allocated(e%rest) .and. e%compression > 0.0_wp) softening = count(e%rest < 0.0_wp)
      do j = 1, size(e%first) - 1
         i = e%first(j)
         associate (last => e%first(j + 1) - 1)
            if (last == i) then
               soft(:, j) = [1.0_wp/merge(k(i), shared*k0(i), abs(k(i)) > shared*k0(i)), 0.0_wp, 0.0_wp]
               if (soft(1, j) < 0.0_wp) softening = softening + 1
            else
               now = sums(last - i + 1, e%y(i:last), k(i:last))
               whole = sums(last - i + 1, e%y(i:last), k0(i:last))
               determinant = now(1)*now(3) - now(2)**2
               ! Layers without stiffness share a motion as if each had a little of its initial one.
               if (abs(determinant) <= shared*(whole(1)*whole(3) - whole(2)**2)) then
                  now = now + shared*whole
                  determinant = now(1)*now(3) - now(2)**2
               end if
               soft(:, j) = [now(3), -now(2), now(1)]/determinant
               if (determinant < 0.0_wp) then
                  softening = softening + 1
               else if (now(1) < 0.0_wp) then
                  softening = softening + 2
               end if
            end if
         end associate
         call add_joint(e%arm(:, :, j), soft(:, j), flexible)
      end do
      minor(1) = flexible(1, 1)
      minor(2) = flexible(1, 1)*flexible(2, 2) - flexible(1, 2)**2
      stiffness(:, 1) = cross_product(flexible(:, 2), flexible(:, 3))
      stiffness(:, 2) = cross_product(flexible(:, 3), flexible(:, 1))
      stiffness(:, 3) = cross_product(flexible(:, 1), flexible(:, 2))
      minor(3) = sum(flexible(:, 1)*stiffness(:, 1))
      stiffness = stiffness/minor(3)
      ! As many negative directions in all as in the joints alone, by the signs of the leading minors.
      stable = softening == count([minor(1) < 0.0_wp, minor(2)*minor(1) < 0.0_wp, minor(3)*minor(2) < 0.0_wp])
   end subroutine layered_tangent

   !> Sums of k, k y and k y**2.
   pure function sums(n, y, k)
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
   end function sums

   !> Add the flexibility of a joint.
   pure subroutine add_joint(arm, soft, flexible)
      real(wp), intent(in) :: arm(3, 2), soft(of_joint)
      real(wp), intent(inout) :: flexible(3, 3)
      integer :: i

      do i = 1, 3
         flexible(:, i) = flexible(:, i) + arm(:, 1)*(soft(1)*arm(i, 1) + soft(2)*arm(i, 2)) &
                          + arm(:, 2)*(soft(2)*arm(i, 1) + soft(3)*arm(i, 2))
      end do
   end subroutine add_joint

   pure function cross_product(a, b) result(c)
      real(wp), intent(in) :: a(3), b(3)
      real(wp) :: c(3)

      c = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
   end function cross_product

   !> As `find_forces`.
   pure subroutine layered_forces(e, m, stiffness, soft, gap, d, f, dead, dead_force, s, correction)
      type(frame_element), intent(in) :: e
      integer, intent(in) :: m
      !> Of `layered_tangent`
      real(wp), intent(in) :: stiffness(3, 3), soft(of_joint, size(e%first) - 1)
      !> Compatibility error: motion of the ends less that of the joints; deformations and forces of the
      !> springs; the share of the dead load that acts, and what it does in them
      real(wp), intent(in) :: gap(3), d(m), f(m), dead, dead_force(m)
      real(wp), intent(out) :: s(3), correction(m)
      real(wp) :: all(3), more(3), force, moment, moved(2)
      integer :: j

      all = 0.0_wp
      do j = 1, size(e%first) - 1
         associate (of => e%first(j), last => e%first(j + 1) - 1)
            if (of == last) then
               force = f(of) - dead*dead_force(of)
               correction(of) = force
               all = all + e%arm(:, 1, j)*(soft(1, j)*force)
               cycle
            end if
            call add_up(last - of + 1, e%y(of:last), f(of:last), dead, dead_force(of:last), force, moment)
            correction(of) = force
            correction(of + 1) = moment
         end associate
         all = all + (e%arm(:, 1, j)*(soft(1, j)*force + soft(2, j)*moment) &
                      + e%arm(:, 2, j)*(soft(2, j)*force + soft(3, j)*moment))
      end do
      s = stiffness(:, 1)*all(1) + stiffness(:, 2)*all(2) + stiffness(:, 3)*all(3)
      ! In joints all but without stiffness these forces make motions beside which the gap is round-off.
      all = gap - motion_of_rest(e, s)
      do j = 1, size(e%first) - 1
         associate (a => e%arm(:, :, j), of => e%first(j), last => e%first(j + 1) - 1)
            force = unbalance(correction(of), a(1, 1)*s(1), a(2, 1)*s(2), a(3, 1)*s(3))
            correction(of) = force
            all = all + a(:, 1)*(soft(1, j)*force)
            if (of == last) cycle
            moment = unbalance(correction(of + 1), a(1, 2)*s(1), a(2, 2)*s(2), a(3, 2)*s(3))
            correction(of + 1) = moment
            all = all + (a(:, 1)*(soft(2, j)*moment) + a(:, 2)*(soft(2, j)*force + soft(3, j)*moment))
         end associate
      end do
      more = stiffness(:, 1)*all(1) + stiffness(:, 2)*all(2) + stiffness(:, 3)*all(3)
      s = s + more
      do j = 1, size(e%first) - 1
         associate (of => e%first(j), last => e%first(j + 1) - 1)
            force = work_on(e%arm(:, 1, j), more) - correction(of)
            if (of == last) then
               correction(of) = soft(1, j)*force
               cycle
            end if
            moment = work_on(e%arm(:, 2, j), more) - correction(of + 1)
            ! Layers stay in line.
            moved = joint_motion(e, j, m, d) + [soft(1, j)*force + soft(2, j)*moment, &
                                                soft(2, j)*force + soft(3, j)*moment]
            call align(last - of + 1, e%y(of:last), moved, d(of:last), correction(of:last))
         end associate
      end do
   end subroutine layered_forces

   !> Force and moment of the springs of a joint, less what dead load does in them.
   pure subroutine add_up(n, y, f, dead, dead_force, force, moment)
      integer, intent(in) :: n
      real(wp), intent(in) :: y(n), f(n), dead, dead_force(n)
      real(wp), intent(out) :: force, moment
      integer :: i

      force = 0.0_wp
      moment = 0.0_wp
      !$omp simd reduction(+:force, moment)
      do i = 1, n
         force = force + (f(i) - dead*dead_force(i))
         moment = moment + y(i)*(f(i) - dead*dead_force(i))
      end do
   end subroutine add_up

   !> Work of the forces of the ends per unit motion of a joint.
   pure real(wp) function work_on(arm, s)
      real(wp), intent(in) :: arm(3), s(3)

      work_on = arm(1)*s(1) + arm(2)*s(2) + arm(3)*s(3)
   end function work_on

   !> Corrections that bring the springs of a joint in line.
   pure subroutine align(n, y, moved, d, correction)
      integer, intent(in) :: n
      real(wp), intent(in) :: y(n), moved(2), d(n)
      real(wp), intent(out) :: correction(n)
      integer :: i

      !$omp simd
      do i = 1, n
         correction(i) = (moved(1) + y(i)*moved(2)) - d(i)
      end do
   end subroutine align

   !> Take the motions of the ends that the joints make from those that there are.
   pure subroutine take_joints_off(e, m, d, gap)
      type(frame_element), intent(in) :: e
      integer, intent(in) :: m
      real(wp), intent(in) :: d(m)
      real(wp), intent(inout) :: gap(3)
      real(wp) :: z(2)
      integer :: j

      do j = 1, size(e%first) - 1
         z = joint_motion(e, j, m, d)
         gap = gap - (e%arm(:, 1, j)*z(1) + e%arm(:, 2, j)*z(2))
      end do
   end subroutine take_joints_off

   !> Opening in the middle and rotation of a joint of layers, from its outermost ones; or the deformation
   !> of a single spring.
   pure function joint_motion(e, joint, m, d) result(z)
      type(frame_element), intent(in) :: e
      integer, intent(in) :: joint, m
      real(wp), intent(in) :: d(m)
      real(wp) :: z(2)

      associate (low => e%outermost(1, joint), high => e%outermost(2, joint))
         z = [d(low), 0.0_wp]
         if (low == high) return
         z(2) = (d(high) - d(low))/(e%y(high) - e%y(low))
         z(1) = d(low) - e%y(low)*z(2)
      end associate
   end function joint_motion

   !> Changes of the deformations with those of the ends.
   pure subroutine layered_rates(e, m, stiffness, soft, q, dd)
      type(frame_element), intent(in) :: e
      integer, intent(in) :: m
      real(wp), intent(in) :: stiffness(3, 3), soft(of_joint, size(e%first) - 1), q(3)
      real(wp), intent(out) :: dd(m)
      real(wp) :: s(3), force, moment, z(2)
      integer :: j

      s = stiffness(:, 1)*q(1) + stiffness(:, 2)*q(2) + stiffness(:, 3)*q(3)
      do j = 1, size(e%first) - 1
         force = work_on(e%arm(:, 1, j), s)
         associate (of => e%first(j), last => e%first(j + 1) - 1)
            if (of == last) then
               dd(of) = soft(1, j)*force
               cycle
            end if
            moment = work_on(e%arm(:, 2, j), s)
            z = [soft(1, j)*force + soft(2, j)*moment, soft(2, j)*force + soft(3, j)*moment]
            call open_up(last - of + 1, e%y(of:last), z, dd(of:last))
         end associate
      end do
   end subroutine layered_rates

   pure subroutine open_up(n, y, z, dd)
      integer, intent(in) :: n
      real(wp), intent(in) :: y(n), z(2)
      real(wp), intent(out) :: dd(n)
      integer :: i

      !$omp simd
      do i = 1, n
         dd(i) = z(1) + y(i)*z(2)
      end do
   end subroutine open_up

   !> Take rates for zero that are below a share of the terms they are sums of.
   pure subroutine drop_small_rates(e, m, stiffness, soft, terms, share, dd)
      type(frame_element), intent(in) :: e
      integer, intent(in) :: m
      !> See `layered_tangent`; sizes of what elongation and rotations of the ends are sums of
      real(wp), intent(in) :: stiffness(3, 3), soft(of_joint, size(e%first) - 1), terms(3)
      real(wp), intent(in) :: share
      real(wp), intent(inout) :: dd(m)
      real(wp) :: s(3), force, moment, z(2)
      integer :: j

      s = abs(stiffness(:, 1))*terms(1) + abs(stiffness(:, 2))*terms(2) + abs(stiffness(:, 3))*terms(3)
      do j = 1, size(e%first) - 1
         associate (a => e%arm(:, :, j))
            force = share*(abs(a(1, 1))*s(1) + abs(a(2, 1))*s(2) + abs(a(3, 1))*s(3))
            moment = share*(abs(a(1, 2))*s(1) + abs(a(2, 2))*s(2) + abs(a(3, 2))*s(3))
         end associate
         z = [abs(soft(1, j))*force + abs(soft(2, j))*moment, abs(soft(2, j))*force + abs(soft(3, j))*moment]
         associate (of => e%first(j), last => e%first(j + 1) - 1)
            call drop_below(last - of + 1, e%y(of:last), z, dd(of:last))
         end associate
      end do
   end subroutine drop_small_rates

   pure subroutine drop_below(n, y, z, dd)
      integer, intent(in) :: n
      real(wp), intent(in) :: y(n), z(2)
      real(wp), intent(inout) :: dd(n)
      integer :: i

      !$omp simd
      do i = 1, n
         dd(i) = merge(0.0_wp, dd(i), abs(dd(i)) < z(1) + abs(y(i))*z(2))
      end do
   end subroutine drop_below

end module rbs_structure_frame_layered
