!> Elements of a frame with joints of layers: each layer is a spring of its own, but a joint moves and resists
!> as a whole, by its opening and its rotation. Sums over its layers are all that its element needs; see
!> `rbs_structure_frame_element` for the formulas.
module rbs_structure_frame_layered
   use rbs_base_constants, only: no_stiffness
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_layer_joints, only: stiffness_sums
   use rbs_structure_frame_element, only: frame_element, motion_of_rest, joint_numbers, unbalance
   implicit none
   private

   public :: layered_tangent, layered_forces, layered_rates, drop_small_rates, take_joints_off

   !> Joints without stiffness share a motion as if each had this part of its initial one. It costs as many
   !> digits, and refinement removes its effect.
   real(wp), parameter :: shared = 1.0e-6_wp

   !> Flexibility of springs in a row, its adjugate and determinant, and how many of them soften.
   type :: flexibility
      real(wp) :: whole(3, 3) = 0.0_wp, adjugate(3, 3) = 0.0_wp, determinant = 0.0_wp
      integer :: softening = 0
   end type flexibility

contains

   !> Stiffness of an element with joints of layers, and its joints: compliance of the opening at the centre
   !> of stiffness, the place of this, compliance of the rotation, and effect of axial force and end moments
   !> about the centre.
   !>
   !> The flexibility F is a sum of p p'/k, to which any joint may add much more than the others. With
   !> adj(F + p p'/k) = adj F + P F P'/k and det(F + p p'/k) = det F + p' adj(F) p/k, P x = p x x, both are
   !> sums of terms of one sign while nothing softens, and K = adj F/det F keeps its digits.
   pure subroutine layered_tangent(e, m, k, k0, stiffness, soft, stable, shares)
      type(frame_element), intent(in) :: e
      integer, intent(in) :: m
      !> Present and initial stiffness of its springs
      real(wp), intent(in) :: k(m), k0(m)
      real(wp), intent(out) :: stiffness(3, 3), soft(joint_numbers, size(e%first) - 1)
      !> Whether it does not snap back: each joint that softens is held by the rest of the element; whether
      !> joints without stiffness share a motion
      logical, intent(out) :: stable, shares
      type(flexibility) :: sum_of
      real(wp) :: now(3), whole(3)
      integer :: i, j

      shares = .false.
      if (e%rest_along > 0.0_wp) call add_spring(sum_of, [1.0_wp, 0.0_wp, 0.0_wp], 1.0_wp/e%rest_along)
      if (allocated(e%rest)) then
         call add_spring(sum_of, [0.0_wp, 1.0_wp, 1.0_wp], 1.0_wp/e%rest(1))
         call add_spring(sum_of, [0.0_wp, 1.0_wp, -1.0_wp], 1.0_wp/e%rest(2))
      end if
      ! Beyond Euler's load; under tension a rest that takes off flexibility of springs is none of its own.
      if (.not. e%compression > 0.0_wp) sum_of%softening = 0
      do j = 1, size(e%first) - 1
         i = e%first(j)
         associate (last => e%first(j + 1) - 1, a => e%arm(:, :, j))
            if (last == i) then
               now(1) = k(i)
               call share_motion(k0(i), now(1), shares)
               soft(:, j) = [1.0_wp/now(1), (0.0_wp, i=2, joint_numbers)]
               call add_spring(sum_of, a(:, 1), soft(1, j))
               cycle
            end if
            now = stiffness_sums(last - i + 1, e%y(i:last), k(i:last))
            whole = stiffness_sums(last - i + 1, e%y(i:last), k0(i:last))
            call share_motion(whole(1), now(1), shares)
            now(3) = now(3) - now(2)**2/now(1)
            call share_motion(whole(3) - whole(2)**2/whole(1), now(3), shares)
            soft(:, j) = [1.0_wp/now(1), now(2)/now(1), 1.0_wp/now(3), a(:, 2) - now(2)/now(1)*a(:, 1)]
            call add_spring(sum_of, a(:, 1), soft(1, j))
            call add_spring(sum_of, soft(4:, j), soft(3, j))
         end associate
      end do
      ! As many negative directions in all as in the joints alone, by the signs of the leading minors.
      associate (minor => [sum_of%whole(1, 1), sum_of%adjugate(3, 3), sum_of%determinant])
         stable = sum_of%softening == count(minor*[1.0_wp, minor(:2)] < 0.0_wp)
         stiffness = sum_of%adjugate/minor(3)
      end associate

   end subroutine layered_tangent

   !> Stiffness of a spring; one without any shares motions as if it had a little of the initial one.
   pure subroutine share_motion(initial, k, shares)
      real(wp), intent(in) :: initial
      real(wp), intent(inout) :: k
      logical, intent(inout) :: shares

      if (abs(k) > no_stiffness*initial) return
      k = shared*initial
      shares = .true.
   end subroutine share_motion

   !> Add a spring to a flexibility.
   pure subroutine add_spring(self, p, compliance)
      type(flexibility), intent(inout) :: self
      real(wp), intent(in) :: p(3), compliance
      real(wp) :: crossed(3, 3)
      integer :: i

      if (compliance < 0.0_wp) self%softening = self%softening + 1
      do i = 1, 3
         self%determinant = self%determinant + compliance*p(i)*work_on(self%adjugate(:, i), p)
         crossed(:, i) = cross_product(p, self%whole(:, i))
      end do
      do i = 1, 3
         self%adjugate(:, i) = self%adjugate(:, i) + compliance*cross_product(p, crossed(i, :))
         self%whole(:, i) = self%whole(:, i) + compliance*p(i)*p
      end do
   end subroutine add_spring

   pure function cross_product(a, b) result(c)
      real(wp), intent(in) :: a(3), b(3)
      real(wp) :: c(3)

      c = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
   end function cross_product

   !> As `find_forces`. Of a joint of layers axial force and moment are in the places of its first two.
   pure subroutine layered_forces(e, n, m, coordinates, slot, motion, is_single, arm, dead_moment, &
                                  stiffness, soft, misfit, f, dead, dead_force, s, correction)
      type(frame_element), intent(in) :: e
      !> Numbers of its joints and springs, and of coordinates
      integer, intent(in) :: n, m, coordinates
      !> Of the element, see there
      integer, intent(in) :: slot(n), motion(n)
      logical, intent(in) :: is_single(n)
      real(wp), intent(in) :: arm(3, 2, n), dead_moment(n)
      !> Of `layered_tangent`
      real(wp), intent(in) :: stiffness(3, 3), soft(joint_numbers, n)
      !> The misfit, motion of the ends less that of the joints; forces of the springs; the share of the
      !> dead load that acts, and its forces in them
      real(wp), intent(in) :: misfit(3), f(m), dead, dead_force(m)
      real(wp), intent(out) :: s(3)
      real(wp), intent(inout) :: correction(coordinates)
      real(wp) :: all(3), more(3)
      integer :: j

      all = 0.0_wp
      do j = 1, n
         associate (at => motion(j), i => slot(j))
            if (is_single(j)) then
               correction(at) = f(i) - dead*dead_force(i)
            else
               correction(at) = f(i)
               correction(at + 1) = (f(i + 1) - dead*dead_moment(j)) - soft(2, j)*f(i)
               all = all + soft(4:, j)*(soft(3, j)*correction(at + 1))
            end if
            all = all + arm(:, 1, j)*(soft(1, j)*correction(at))
         end associate
      end do
      s = stiffness(:, 1)*all(1) + stiffness(:, 2)*all(2) + stiffness(:, 3)*all(3)
      ! In joints all but without stiffness these forces make motions beside which the misfit is round-off.
      all = misfit - motion_of_rest(e, s)
      do j = 1, n
         associate (at => motion(j), a => arm(:, 1, j), b => soft(4:, j))
            correction(at) = unbalance(correction(at), a(1)*s(1), a(2)*s(2), a(3)*s(3))
            all = all + a*(soft(1, j)*correction(at))
            if (is_single(j)) cycle
            correction(at + 1) = unbalance(correction(at + 1), b(1)*s(1), b(2)*s(2), b(3)*s(3))
            all = all + b*(soft(3, j)*correction(at + 1))
         end associate
      end do
      more = stiffness(:, 1)*all(1) + stiffness(:, 2)*all(2) + stiffness(:, 3)*all(3)
      s = s + more
      do j = 1, n
         associate (at => motion(j))
            correction(at) = soft(1, j)*(work_on(arm(:, 1, j), more) - correction(at))
            if (is_single(j)) cycle
            correction(at + 1) = soft(3, j)*(work_on(soft(4:, j), more) - correction(at + 1))
            correction(at) = correction(at) - soft(2, j)*correction(at + 1)
         end associate
      end do
   end subroutine layered_forces

   !> Work of the forces of the ends per unit motion of a joint.
   pure real(wp) function work_on(arm, s)
      real(wp), intent(in) :: arm(3), s(3)

      work_on = arm(1)*s(1) + arm(2)*s(2) + arm(3)*s(3)
   end function work_on

   !> Take the motions of the ends that the joints make from those that there are.
   pure subroutine take_joints_off(n, motion, is_single, arm, d, misfit)
      integer, intent(in) :: n, motion(n)
      logical, intent(in) :: is_single(n)
      real(wp), intent(in) :: arm(3, 2, n)
      !> (coordinates)
      real(wp), intent(in), contiguous :: d(:)
      real(wp), intent(inout) :: misfit(3)
      integer :: j

      do j = 1, n
         misfit = misfit - arm(:, 1, j)*d(motion(j))
         if (.not. is_single(j)) misfit = misfit - arm(:, 2, j)*d(motion(j) + 1)
      end do
   end subroutine take_joints_off

   !> Changes of the motions of the joints with those of the ends.
   pure subroutine layered_rates(n, coordinates, motion, is_single, arm, stiffness, soft, q, dd)
      integer, intent(in) :: n, coordinates, motion(n)
      logical, intent(in) :: is_single(n)
      real(wp), intent(in) :: arm(3, 2, n), stiffness(3, 3), soft(joint_numbers, n), q(3)
      real(wp), intent(inout) :: dd(coordinates)
      real(wp) :: s(3)
      integer :: j

      s = stiffness(:, 1)*q(1) + stiffness(:, 2)*q(2) + stiffness(:, 3)*q(3)
      do j = 1, n
         associate (at => motion(j))
            dd(at) = soft(1, j)*work_on(arm(:, 1, j), s)
            if (is_single(j)) cycle
            dd(at + 1) = soft(3, j)*work_on(soft(4:, j), s)
            dd(at) = dd(at) - soft(2, j)*dd(at + 1)
         end associate
      end do
   end subroutine layered_rates

   !> Take rates for zero that are below a share of the terms they are sums of.
   pure subroutine drop_small_rates(e, m, stiffness, soft, terms, share, dd)
      type(frame_element), intent(in) :: e
      integer, intent(in) :: m
      !> See `layered_tangent`; sizes of the terms of elongation and rotations of the ends
      real(wp), intent(in) :: stiffness(3, 3), soft(joint_numbers, size(e%first) - 1), terms(3)
      real(wp), intent(in) :: share
      real(wp), intent(inout) :: dd(m)
      real(wp) :: s(3), opening, tilt
      integer :: j

      s = abs(stiffness(:, 1))*terms(1) + abs(stiffness(:, 2))*terms(2) + abs(stiffness(:, 3))*terms(3)
      do j = 1, size(e%first) - 1
         associate (a => e%arm(:, 1, j), b => e%arm(:, 2, j), of => e%first(j), last => e%first(j + 1) - 1)
            opening = abs(soft(1, j))*sum(abs(a)*s)
            tilt = abs(soft(3, j))*sum(abs(soft(4:, j))*s)
            ! However soft a joint is, it moves no more than the ends.
            if (of < last) then
               opening = min(opening, sum(abs(a)*terms))
               tilt = min(tilt, sum(abs(b)*terms))
            end if
            call drop_below(last - of + 1, e%y(of:last), share*(opening + abs(soft(2, j))*tilt), share*tilt, &
                            dd(of:last))
         end associate
      end do
   end subroutine drop_small_rates

   pure subroutine drop_below(n, y, opening, tilt, dd)
      integer, intent(in) :: n
      real(wp), intent(in) :: y(n), opening, tilt
      real(wp), intent(inout) :: dd(n)
      integer :: i

      !$omp simd
      do i = 1, n
         dd(i) = merge(0.0_wp, dd(i), abs(dd(i)) < opening + abs(y(i))*tilt)
      end do
   end subroutine drop_below

end module rbs_structure_frame_layered
