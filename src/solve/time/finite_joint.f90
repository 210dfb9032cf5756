!> One joint between two bodies with exact rotations: its deformations over a step, the forces that it gives
!> the bodies, and their derivatives, in the coordinates of the centroids.
!>
!> A body has the axis e = (sin th, cos th) and the normal t = (cos th, -sin th). The joint reaches from the
!> top of the body below to the bottom of the body above: D = c - s e - (c' + r e') = u t' + w e', the prime
!> for the body below. With the means over a step that turns a body from m - A/2 to m + A/2,
!>
!>     tb = sg t(m),  eb = sg e(m),  sg = sin(A/2)/(A/2),
!>     tm = (t_0 + t_1)/2,  em = (e_0 + e_1)/2,  Dm = (D_0 + D_1)/2,
!>
!> the changes of the deformations are exactly
!>
!>     du = tm'.dD - (eb'.Dm) dth',   dw = em'.dD + (tb'.Dm) dth',   dD = dc - s tb dth - dc' - r tb' dth'
!>
!> (mean-value derivatives: O. Gonzalez, J. Nonlinear Sci. 6 (1996) 449-467). Forces with these arms do
!> exactly the work of the springs. At one state all means are the values there.
module rbs_solve_time_finite_joint
   use rbs_base_kinds, only: wp
   implicit none
   private

   public :: turned_body, turn_body, body_at, joint_type, joint_change, joint_at
   public :: joint_rates, add_joint_forces, joint_tangent, local

   !> Coordinates that meet at a joint: x, y, th of the body below, axial force of the joint, x, y, th of the
   !> body above.
   integer, parameter :: local = 7

   !> Directions of a body over a step.
   type :: turned_body
      !> Directions at the end of the step
      real(wp) :: t1(2) = [1.0_wp, 0.0_wp], e1(2) = [0.0_wp, 1.0_wp]
      !> Mean of both ends, and mean-value directions
      real(wp) :: tm(2) = [1.0_wp, 0.0_wp], em(2) = [0.0_wp, 1.0_wp]
      real(wp) :: tb(2) = [1.0_wp, 0.0_wp], eb(2) = [0.0_wp, 1.0_wp]
      !> Derivatives of the latter by the rotation at the end
      real(wp) :: tb_rate(2) = [0.0_wp, -0.5_wp], eb_rate(2) = [0.5_wp, 0.0_wp]
   end type turned_body

   !> A joint over a step. That of a held top is turned over: its lower body is the top, and its
   !> deformations and forces have the other sign.
   type :: joint_type
      !> Numbers of its bodies, 0 for the ground, and its sign
      integer :: lower = 0, upper = 0
      real(wp) :: sign = 1.0_wp
      !> Distances of the joint from the centroids of the bodies below and above [m]; D at the start of the
      !> step, in the mean and at the end [m]
      real(wp) :: below = 0.0_wp, above = 0.0_wp, start(2) = 0.0_wp, mean(2) = 0.0_wp, finish(2) = 0.0_wp
   end type joint_type

contains

   !> Directions of a body over a step in which it turns.
   pure subroutine turn_body(from, change, body)
      !> Rotation at the start of the step, and its change over the step [rad]
      real(wp), intent(in) :: from, change
      type(turned_body), intent(out) :: body
      real(wp) :: s, c, sg, sg_rate, half

      ! Directions t and e of the head: at the end (1), in the mean of both ends (m), and those of the mean
      ! rotation (b); sg = sin(half)/half by its series where both vanish.
      half = 0.5_wp*change
      s = sin(from)
      c = cos(from)
      body%t1 = [cos(from + change), -sin(from + change)]
      body%e1 = [-body%t1(2), body%t1(1)]
      body%tm = 0.5_wp*([c, -s] + body%t1)
      body%em = 0.5_wp*([s, c] + body%e1)
      if (abs(change) < 0.02_wp) then
         sg = 1.0_wp - half**2*(1.0_wp - half**2/20.0_wp)/6.0_wp
         sg_rate = -half*(1.0_wp - half**2/10.0_wp)/6.0_wp
      else
         sg = sin(half)/half
         sg_rate = 0.5_wp*(cos(half) - sg)/half
      end if
      s = sin(from + half)
      c = cos(from + half)
      body%tb = sg*[c, -s]
      body%eb = sg*[s, c]
      body%tb_rate = sg_rate*[c, -s] - 0.5_wp*body%eb
      body%eb_rate = sg_rate*[s, c] + 0.5_wp*body%tb
   end subroutine turn_body

   !> Directions of a body at one rotation: all means are the values there.
   pure subroutine body_at(rotation, body)
      !> Rotation [rad]
      real(wp), intent(in) :: rotation
      type(turned_body), intent(out) :: body

      body%t1 = [cos(rotation), -sin(rotation)]
      body%e1 = [-body%t1(2), body%t1(1)]
      body%tm = body%t1
      body%em = body%e1
      body%tb = body%t1
      body%eb = body%e1
      body%tb_rate = -body%e1
      body%eb_rate = body%t1
   end subroutine body_at

   !> Changes of slip, rotation and opening over a step.
   pure subroutine joint_change(below, above, moved_below, moved_above, joint, change)
      !> The bodies over the step, and how their centroids have moved and turned (x, y, th)
      type(turned_body), intent(in) :: below, above
      real(wp), intent(in) :: moved_below(3), moved_above(3)
      !> Its gap D gets the mean and the value at the end of the step
      type(joint_type), intent(inout) :: joint
      !> Slip [m], rotation [rad], opening [m]
      real(wp), intent(out) :: change(3)
      real(wp) :: moved(2)

      ! dD, by which the gap has changed
      moved = (moved_above(:2) - moved_below(:2)) - joint%above*above%tb*moved_above(3) &
            - joint%below*below%tb*moved_below(3)
      joint%finish = joint%start + moved
      joint%mean = joint%start + 0.5_wp*moved
      change = joint%sign*[sum(below%tm*moved) - sum(below%eb*joint%mean)*moved_below(3), &
                           moved_above(3) - moved_below(3), &
                           sum(below%em*moved) + sum(below%tb*joint%mean)*moved_below(3)]
   end subroutine joint_change

   !> The gap D of a joint at one state [m], from slip, rotation and opening.
   pure function joint_at(below, joint, deformation) result(d)
      type(turned_body), intent(in) :: below
      type(joint_type), intent(in) :: joint
      !> Slip [m], rotation [rad], opening [m]
      real(wp), intent(in) :: deformation(3)
      real(wp) :: d(2)

      d = joint%sign*(deformation(1)*below%t1 + deformation(3)*below%e1)
   end function joint_at

   !> Velocities of slip, rotation and opening at one state.
   pure function joint_rates(below, above, rate_below, rate_above, joint) result(rates)
      type(turned_body), intent(in) :: below, above
      !> Velocities of the bodies (x, y, th)
      real(wp), intent(in) :: rate_below(3), rate_above(3)
      type(joint_type), intent(in) :: joint
      real(wp) :: rates(3), rate(2)

      rate = (rate_above(:2) - rate_below(:2)) - (joint%above*rate_above(3))*above%t1 &
             - (joint%below*rate_below(3))*below%t1
      rates = joint%sign*[sum(below%t1*rate) - sum(below%e1*joint%finish)*rate_below(3), &
                          rate_above(3) - rate_below(3), &
                          sum(below%e1*rate) + sum(below%t1*joint%finish)*rate_below(3)]
   end function joint_rates

   !> Add the forces of a joint on its bodies, in their coordinates.
   pure subroutine add_joint_forces(below, above, joint, force, on_below, on_above)
      type(turned_body), intent(in) :: below, above
      type(joint_type), intent(in) :: joint
      !> Shear, moment and axial force (tension positive) [N, N m, N]
      real(wp), intent(in) :: force(3)
      !> Forces along x and y [N] and moments about the centroids [N m], to which those of the joint are added
      real(wp), intent(inout) :: on_below(3), on_above(3)
      real(wp) :: p(2), f(3)

      f = joint%sign*force
      p = f(1)*below%tm + f(3)*below%em
      on_above(:2) = on_above(:2) - p
      on_above(3) = on_above(3) - f(2) + joint%above*sum(above%tb*p)
      on_below(:2) = on_below(:2) + p
      on_below(3) = on_below(3) + f(2) + joint%below*sum(below%tb*p) + f(1)*sum(below%eb*joint%mean) &
                    - f(3)*sum(below%tb*joint%mean)
   end subroutine add_joint_forces

   !> Minus the derivatives of `add_joint_forces` by the state at the end of the step: rows of the bodies, and
   !> in the row of the axial force the derivative of the opening.
   pure subroutine joint_tangent(below, above, joint, half, forces, k, closed, tangent)
      type(turned_body), intent(in) :: below, above
      type(joint_type), intent(in) :: joint
      !> Share of the end of the step in the means: 1/2, or 1 at one state; forces, and their derivatives by
      !> the deformations at the end of the step
      real(wp), intent(in) :: half, forces(3), k(3)
      !> Whether the joint does not open: its axial force is an unknown
      logical, intent(in) :: closed
      !> Rows and columns: x, y, th of the body below, axial force, x, y, th of the body above
      real(wp), intent(out) :: tangent(local, local)
      real(wp) :: moved(2, local), force(2, local), shear(local), tension(local), moment(local), &
           opening(local)
      real(wp) :: p(2), arms(2), f(3)
      integer :: i

      f = joint%sign*forces
      ! How the gap of the joint moves, in space, with each number of the state: place and rotation of the
      ! body below (1 to 3), axial force (4), place and rotation of the body above (5 to 7).
      moved = 0.0_wp
      moved(1, 1) = -1.0_wp
      moved(2, 2) = -1.0_wp
      moved(1, 5) = 1.0_wp
      moved(2, 6) = 1.0_wp
      moved(:, 3) = -joint%below*below%t1
      moved(:, 7) = -joint%above*above%t1
      ! Slip and opening are the parts of the gap along the directions of the body below, which turn.
      do i = 1, local
         shear(i) = k(1)*(below%t1(1)*moved(1, i) + below%t1(2)*moved(2, i))
         opening(i) = below%e1(1)*moved(1, i) + below%e1(2)*moved(2, i)
      end do
      shear(3) = shear(3) - k(1)*sum(below%e1*joint%finish)
      opening(3) = opening(3) + sum(below%t1*joint%finish)
      moment = 0.0_wp
      moment(3) = -k(2)
      moment(7) = k(2)
      if (closed) then
         tension = 0.0_wp
         tension(4) = 1.0_wp
      else
         tension = k(3)*opening
      end if
      p = f(1)*below%tm + f(3)*below%em
      arms = [sum(below%eb*joint%mean), sum(below%tb*joint%mean)]
      do i = 1, local
         force(:, i) = shear(i)*below%tm + tension(i)*below%em
      end do
      force(:, 3) = force(:, 3) + half*(f(3)*below%t1 - f(1)*below%e1)
      ! Both bodies take the force and its moment about their centroids.
      do i = 1, local
         tangent(1:2, i) = -force(:, i)
         tangent(3, i) = -joint%below*sum(below%tb*force(:, i)) - shear(i)*arms(1) &
                         + tension(i)*arms(2) - moment(i) &
                         + half*sum((f(3)*below%tb - f(1)*below%eb)*moved(:, i))
         tangent(4, i) = opening(i)
         tangent(5:6, i) = force(:, i)
         tangent(7, i) = moment(i) - joint%above*sum(above%tb*force(:, i))
      end do
      tangent(3, 3) = tangent(3, 3) - joint%below*sum(below%tb_rate*p) &
                      + sum((f(3)*below%tb_rate - f(1)*below%eb_rate)*joint%mean)
      tangent(7, 7) = tangent(7, 7) - joint%above*sum(above%tb_rate*p)
      tangent(4, :) = joint%sign*tangent(4, :)
      tangent(:, 4) = joint%sign*tangent(:, 4)
   end subroutine joint_tangent

end module rbs_solve_time_finite_joint
