!> Motion of the chain with exact rotations, in a number of operations proportional to n.
!>
!> Body i has the axis e_i = (sin th_i, cos th_i) and the normal t_i = (cos th_i, -sin th_i), th_i = sum of
!> phi; it spins with om_i = th_i' (e' = om t, t' = -om e). Its bottom is at joint i,
!>
!>     b_i = T_{i-1} + u_i t_{i-1} + w_i e_{i-1},  c_i = b_i + lower_i e_i,  T_i = b_i + length_i e_i
!>
!> The mass matrix of the centroids is diagonal, so the equations of every body stay apart: joint i acts on
!> it at its bottom with -V_i t_{i-1} - N_i e_{i-1} and -M_i, joint i + 1 with the opposite. Forces at the
!> top are those of a joint n + 1. The accelerations of the unknowns are those of the bottom of a body
!> relative to the top of the one below,
!>
!>     t_{i-1} . (b_i'' - T_{i-1}'') = u'' + 2 w' om + w om' - u om^2
!>     e_{i-1} . (b_i'' - T_{i-1}'') = w'' - 2 u' om - u om' - w om^2    (om of body i - 1)
!>
!> all in the directions of the two bodies, so that only sine and cosine of phi_i are needed. A
!> field of acceleration that all bodies share (ground, weight) acts on the first joint alone. No mass
!> matrix is built and none is factored.
module rbs_structure_column_finite
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
   use rbs_base_kinds, only: wp
   use rbs_base_linalg, only: solve_tridiagonal
   use rbs_structure_column_column, only: column_type
   use rbs_structure_spring_location, only: shear, flexure, axial
   use rbs_structure_structure, only: motion_result, signals, lateral, horizontal, vertical, top_axial
   implicit none
   private

   public :: finite_chain_type

   !> Columns of the work array of `accelerations`, one number a joint (n): its axial force, tension positive
   !> [N], which is a reaction where it does not open; sine and cosine of its rotation; diagonal of the
   !> equations of the reactions, and the numbers beside it [1/kg]
   integer, parameter :: reaction = 1, sine = 2, cosine = 3, diagonal = 4, off_diagonal = 5

   type, extends(column_type) :: finite_chain_type
   contains
      procedure :: accelerations, accelerate, find_top_force, body_velocities, speed, power_of_loads
      procedure :: kinetic_energy, potential_energy, angular_momentum, top_displacement, top_height
      procedure :: top_acceleration
   end type finite_chain_type

   !> A body on the way up the chain.
   type :: moving_body
      !> Absolute rotation [rad], its sine and cosine and those of the body below, and its rate [rad/s]
      real(wp) :: rotation = 0.0_wp, s = 0.0_wp, c = 1.0_wp, s_below = 0.0_wp, c_below = 1.0_wp, spin = 0.0_wp
      !> Velocities of centroid and top [m/s]
      real(wp) :: centroid(2) = 0.0_wp, top(2) = 0.0_wp
   end type moving_body

contains

   !> Accelerations of the joints, relative to the ground.
   !>
   !> Damping in proportion to the mass, -alpha (m v_c, I om) on every body, is -alpha M q' in the unknowns:
   !> it takes alpha q' from the accelerations.
   subroutine accelerations(self, d, v, load, pressing, result)
      class(finite_chain_type), intent(in) :: self
      !> Deformations of the joints by kind and their velocities, signals of the loads
      real(wp), intent(in) :: d(self%coordinates), v(self%coordinates), load(signals)
      !> Number of axial forces with second-order terms of their own: 0, as exact rotations have them already
      integer, intent(in) :: pressing
      !> It holds the forces of the springs and gets the accelerations
      type(motion_result), intent(inout) :: result

      if (pressing == 0 .and. size(d) == 2) then
         call accelerate_one_body(self, d, v, result%f, load, result%a, result%power)
         result%has_power = .true.
      else
         call self%accelerate(d, v, result%f, load, result%work, result%a)
      end if
   end subroutine accelerations

   !> Accelerations of any chain by its bodies; it leaves the axial forces of joints that do not open in the
   !> work array (n).
   subroutine accelerate(self, d, v, f, load, work, a)
      class(finite_chain_type), intent(in) :: self
      !> Deformations of the joints by kind, their velocities and forces (springs), signals of the loads
      real(wp), intent(in), contiguous :: d(:), v(:), f(:), load(:)
      !> Five numbers for each joint, see `reaction` and the others at the head of the module
      real(wp), intent(inout), contiguous :: work(:)
      !> Of the deformations, relative to the ground (springs)
      real(wp), intent(out), contiguous :: a(:)

      call accelerate_under_forces(self, d, v, f, load, work, a)
      if (.not. self%opens) call add_reactions(self, d, work, a)
      if (self%mass_damping > 0.0_wp) a = a - self%mass_damping*v
   end subroutine accelerate

   !> One body under dead loads: the paper's eq 4, corrected, with axial load and weight; s is the distance of
   !> the centroid from the joint.
   !>
   !>     m u'' + m s cos(th) th'' - m s sin(th) th'^2 + V = F - m a_g
   !>     m s cos(th) u'' + (I + m s^2) th'' + M = (F l - m s a_g) cos(th) + P l sin(th)
   pure subroutine accelerate_one_body(self, d, v, f, load, a, power)
      class(finite_chain_type), intent(in) :: self
      !> Slip and rotation, their velocities, forces of the two springs, signals of the loads
      real(wp), intent(in) :: d(2), v(2), f(2), load(signals)
      !> Accelerations; power of the loads [W]
      real(wp), intent(out) :: a(2), power
      real(wp) :: s, c, coupling, along, about, determinant, axial

      associate (m => self%mass(1), inertia => self%inertia_above(1), moment => self%moment_above(1), &
                 l => self%length(1))
         s = sin(d(2))
         c = cos(d(2))
         coupling = moment*c
         along = load(lateral) - m*load(horizontal) - f(1) + moment*s*v(2)**2
         axial = self%axial_body(1) + load(top_axial) + load(vertical)*self%lifted_body(1)
         about = (l*load(lateral) - moment*load(horizontal))*c + axial*l*s - f(2)
         if (self%mass_damping > 0.0_wp) then
            along = along - self%mass_damping*(m*v(1) + coupling*v(2))
            about = about - self%mass_damping*(coupling*v(1) + inertia*v(2))
         end if
         determinant = 1.0_wp/(m*inertia - coupling**2)
         a(1) = (inertia*along - coupling*about)*determinant
         a(2) = (m*about - coupling*along)*determinant
         power = load(lateral)*(v(1) + l*c*v(2)) - load(horizontal)*(m*v(1) + coupling*v(2)) &
                 + (l*load(top_axial) + moment*load(vertical))*s*v(2)
      end associate
   end subroutine accelerate_one_body

   !> Accelerations under the known forces. If the joints do not open, their axial forces N are not known:
   !> they are left out, and the equations are set up by which the accelerations w'' of the openings vanish,
   !> w''(N) = w''(0) - G N = 0; `work` then holds w''(0) in place of the reactions, and the matrix G.
   subroutine accelerate_under_forces(column, q, v, f, load, work, a)
      class(finite_chain_type), intent(in) :: column
      !> Unknowns, their velocities, and the forces of the joints conjugate to them, springs and damping
      real(wp), intent(in) :: q(column%n, column%kinds), v(column%n, column%kinds), f(column%n, column%kinds)
      !> Signals of the loads
      real(wp), intent(in) :: load(signals)
      !> Columns as at the head of the module: `reaction`, `sine` and so on
      real(wp), intent(inout) :: work(column%n, 5)
      !> Of the unknowns, relative to the ground, without mass damping
      real(wp), intent(out) :: a(column%n, column%kinds)
      !> Joint below and above the body: forces, slip and opening
      real(wp) :: transverse, tension, moment, slip, opening
      real(wp) :: transverse_above, tension_above, moment_above, slip_above, opening_above
      !> The body: rates of rotation, and those of the body below
      real(wp) :: spin, spin_rate, spin_below, spin_rate_below
      !> Acceleration of the bottom of the body, along t and e of the body below, and of the top of that
      real(wp) :: bottom(2), below(2)
      real(wp) :: per_mass, per_inertia, s, c, separation, flexibility, rotation
      !> Sine and cosine of the last joint where the top is held, then of the top; transverse of the former
      real(wp) :: held(2), along, fixed(2)
      integer :: i, n

      n = column%n
      transverse = f(1, shear)
      moment = f(1, flexure)
      slip = q(1, shear)
      tension = 0.0_wp
      opening = 0.0_wp
      opening_above = 0.0_wp
      tension_above = 0.0_wp
      if (column%opens) then
         tension = f(1, axial)
         opening = q(1, axial)
      end if
      rotation = 0.0_wp
      spin_below = 0.0_wp
      spin_rate_below = 0.0_wp
      flexibility = 0.0_wp
      held = [0.0_wp, 1.0_wp]
      ! In a frame of reference that falls, the ground accelerates upward by gravity.
      below = [load(horizontal), load(vertical) + column%gravity]
      do i = 1, n
         s = sin(q(i, flexure))
         c = cos(q(i, flexure))
         rotation = rotation + q(i, flexure)
         if (i < n) then
            transverse_above = f(i + 1, shear)
            moment_above = f(i + 1, flexure)
            slip_above = q(i + 1, shear)
            if (column%opens) then
               tension_above = f(i + 1, axial)
               opening_above = q(i + 1, axial)
            end if
            if (i == n - 1 .and. column%held) then
               ! The last joint acts at the top of the body, along fixed directions.
               held = [-sin(rotation), cos(rotation)]
               slip_above = 0.0_wp
               opening_above = 0.0_wp
               along = transverse_above
               transverse_above = along*held(2) + tension_above*held(1)
               tension_above = tension_above*held(2) - along*held(1)
            end if
         else
            moment_above = 0.0_wp
            slip_above = 0.0_wp
            opening_above = 0.0_wp
            held = [s, c]
            if (n > 1) held = [sin(rotation), cos(rotation)]
            call column%find_top_force(load, .true., fixed)
            transverse_above = held(2)*fixed(1) - held(1)*fixed(2)
            tension_above = held(1)*fixed(1) + held(2)*fixed(2)
         end if
         per_mass = 1.0_wp/column%mass(i)
         per_inertia = 1.0_wp/column%inertia(i)
         if (i == n .and. column%held) per_inertia = 0.0_wp
         spin = spin_below + v(i, flexure)
         associate (lower => column%lower(i), upper => column%upper(i))
            ! Moments about the centroid, of joint i at its bottom and of joint i + 1.
            spin_rate = (lower*(transverse*c - tension*s) - moment &
                    + transverse_above*(upper + opening_above) - tension_above*slip_above &
                    + moment_above)*per_inertia
            ! b'' = c'' - lower (om' t - om^2 e), along t and e of the body below.
            bottom(1) = (transverse_above*c + tension_above*s - transverse)*per_mass &
                        + lower*(spin**2*s - spin_rate*c)
            bottom(2) = (tension_above*c - transverse_above*s - tension)*per_mass &
                        + lower*(spin**2*c + spin_rate*s)
            a(i, shear) = bottom(1) - below(1) + slip*spin_below**2
            a(i, flexure) = spin_rate - spin_rate_below
            separation = bottom(2) - below(2) + 2.0_wp*v(i, shear)*spin_below + slip*spin_rate_below
            if (column%opens) then
               a(i, shear) = a(i, shear) - 2.0_wp*v(i, axial)*spin_below - opening*spin_rate_below
               a(i, axial) = separation + opening*spin_below**2
            else
               work(i, sine) = s
               work(i, cosine) = c
               work(i, reaction) = separation
               work(i, diagonal) = flexibility + per_mass + (lower*s)**2*per_inertia
               work(i, off_diagonal) = lower*s*slip_above*per_inertia - c*per_mass
               flexibility = per_mass + slip_above**2*per_inertia
               if (i == n - 1 .and. column%held) then
                  work(i, off_diagonal) = -(c*held(2) - s*held(1))*per_mass - &
                       lower*s*upper*held(1)*per_inertia
                  flexibility = per_mass + (upper*held(1))**2*per_inertia
               end if
            end if
            if (i == n .and. column%held) then
               bottom = bottom - below
               a(i, shear) = c*bottom(1) - s*bottom(2)
               if (column%opens) then
                  a(i, axial) = s*bottom(1) + c*bottom(2)
               else
                  work(i, reaction) = s*bottom(1) + c*bottom(2)
               end if
            end if
            ! T'' = c'' + upper (om' t - om^2 e), along its own t and e.
            below(1) = (transverse_above - transverse*c + tension*s)*per_mass + upper*spin_rate
            below(2) = (tension_above - transverse*s - tension*c)*per_mass - upper*spin**2
         end associate
         transverse = transverse_above
         tension = tension_above
         moment = moment_above
         slip = slip_above
         opening = opening_above
         spin_below = spin
         spin_rate_below = spin_rate
      end do
   end subroutine accelerate_under_forces

   !> Force at the top along x and y [N]. The weight of all masses is in the field of acceleration, but that
   !> of the lumped mass belongs to the axial load and is taken away again: `mass` holds the lumped mass,
   !> `weight` does not.
   pure subroutine find_top_force(self, load, constant, force)
      class(finite_chain_type), intent(in) :: self
      !> Signals of the loads
      real(wp), intent(in) :: load(:)
      !> Whether loads that have a potential count too
      logical, intent(in) :: constant
      !> Along x and upward [N]
      real(wp), intent(out) :: force(2)

      force = [load(lateral), -load(top_axial)]
      if (.not. constant) return
      force(2) = -(self%weight(self%n) - self%gravity*self%mass(self%n)) - (load(top_axial) + self%axial_load)
   end subroutine find_top_force

   !> Find the reactions of joints that do not open, from G N = w''(0), and add the accelerations that they
   !> cause.
   subroutine add_reactions(column, q, work, a)
      class(finite_chain_type), intent(in) :: column
      !> Deformations of the joints by kind
      real(wp), intent(in) :: q(column%n, column%kinds)
      !> In work on entry G and w''(0), on return the reactions N; accelerations, to which theirs are added
      real(wp), intent(inout) :: work(column%n, 5), a(column%n, column%kinds)
      !> From the reactions: rotational accelerations of a body and of the one below; acceleration of its top
      !> along its normal; reaction above it
      real(wp) :: spin_rate, spin_rate_below, below, above, along
      logical :: positive
      integer :: i, n

      n = column%n
      call solve_tridiagonal(work(:, diagonal), work(:, off_diagonal), work(:, reaction), positive)
      ! Only numbers beyond all meaning get here; the caller sees that the state is not finite.
      if (.not. positive) work(:, reaction) = ieee_value(a(1, shear), ieee_quiet_nan)
      spin_rate_below = 0.0_wp
      below = 0.0_wp
      do i = 1, n
         if (column%held .and. i >= n - 1) then
            call add_last_reaction(column, work, i, spin_rate_below, below, a)
            cycle
         end if
         spin_rate = column%lower(i)*work(i, sine)*work(i, reaction)
         above = 0.0_wp
         if (i < n) then
            above = work(i + 1, reaction)
            spin_rate = spin_rate + q(i + 1, shear)*above
         end if
         spin_rate = -spin_rate/column%inertia(i)
         along = work(i, sine)/column%mass(i)
         a(i, shear) = a(i, shear) + above*along - column%lower(i)*work(i, cosine)*spin_rate - below
         a(i, flexure) = a(i, flexure) + spin_rate - spin_rate_below
         below = work(i, reaction)*along + column%upper(i)*spin_rate
         spin_rate_below = spin_rate
      end do
   end subroutine add_reactions

   !> The same at the two bodies n - 1 and n, which the joint of a held top is between. Its reaction acts
   !> along the fixed vertical, at the top of the body below.
   pure subroutine add_last_reaction(column, work, i, spin_rate_below, below, a)
      class(finite_chain_type), intent(in) :: column
      !> Sines, cosines and reactions of the joints
      real(wp), intent(in) :: work(column%n, 5)
      !> n - 1 or n
      integer, intent(in) :: i
      !> Acceleration of the body below in rotation, and of its top along its normal, from the reactions
      real(wp), intent(inout) :: spin_rate_below, below
      !> Accelerations of the unknowns, to which those by the reactions are added
      real(wp), intent(inout) :: a(column%n, column%kinds)
      real(wp) :: spin_rate, along
      integer :: n

      n = column%n
      associate (s => work(:, sine), c => work(:, cosine), force => work(:, reaction))
         if (i < n) then
            spin_rate = (column%upper(i)*s(n)*force(n) - column%lower(i)*s(i)*force(i))/column%inertia(i)
            a(i, shear) = a(i, shear) + force(n)*(c(i)*s(n) + s(i)*c(n))/column%mass(i) &
                          - column%lower(i)*c(i)*spin_rate - below
            a(i, flexure) = a(i, flexure) + spin_rate - spin_rate_below
            below = (force(i)*s(i) + force(n)*s(n))/column%mass(i) + column%upper(i)*spin_rate
            spin_rate_below = spin_rate
         else
            along = (force(n)*c(n) - force(n - 1)*c(n - 1))/column%mass(n - 1)
            a(n, shear) = a(n, shear) - c(n)*below + s(n)*along
            a(n, flexure) = a(n, flexure) - spin_rate_below
         end if
      end associate
   end subroutine add_last_reaction

   !> Go up by one body: rotation and velocities of body i from those of body i - 1.
   pure subroutine climb(column, q, v, i, body)
      class(finite_chain_type), intent(in) :: column
      !> Deformations of the joints by kind, and their velocities
      real(wp), intent(in) :: q(column%n, column%kinds), v(column%n, column%kinds)
      !> Number of the body, from the ground up
      integer, intent(in) :: i
      !> On entry body i - 1, at rest on the ground for i = 1
      type(moving_body), intent(inout) :: body
      !> Velocities along t and e: first of the bottom against the body below, then from the bottom upward
      real(wp) :: along_t, along_e, bottom(2)

      call rotate(column, q, i, body)
      ! The joint of a held top moves along its directions, which are fixed.
      if (column%held .and. i == column%n) body%spin = 0.0_wp
      along_t = v(i, shear)
      along_e = -q(i, shear)*body%spin
      if (column%opens) then
         along_t = along_t + q(i, axial)*body%spin
         along_e = along_e + v(i, axial)
      end if
      bottom(1) = body%top(1) + along_t*body%c_below + along_e*body%s_below
      bottom(2) = body%top(2) - along_t*body%s_below + along_e*body%c_below
      if (.not. (column%held .and. i == column%n)) body%spin = body%spin + v(i, flexure)
      along_t = column%lower(i)*body%spin
      body%centroid(1) = bottom(1) + along_t*body%c
      body%centroid(2) = bottom(2) - along_t*body%s
      along_t = column%length(i)*body%spin
      body%top(1) = bottom(1) + along_t*body%c
      body%top(2) = bottom(2) - along_t*body%s
   end subroutine climb

   !> Rotation of body i from that of body i - 1; a held top and its joint have fixed directions.
   pure subroutine rotate(column, q, i, body)
      class(finite_chain_type), intent(in) :: column
      !> Deformations of the joints by kind
      real(wp), intent(in) :: q(column%n, column%kinds)
      !> Number of the body, from the ground up
      integer, intent(in) :: i
      !> On entry body i - 1
      type(moving_body), intent(inout) :: body
      real(wp) :: rotation, s, c

      if (column%held .and. i == column%n) then
         body%s = 0.0_wp
         body%c = 1.0_wp
         body%s_below = 0.0_wp
         body%c_below = 1.0_wp
         return
      end if
      body%s_below = body%s
      body%c_below = body%c
      rotation = body%rotation + q(i, flexure)
      ! Side by side, so that the compiler finds sine and cosine together; the straight column needs neither.
      s = 0.0_wp
      c = 1.0_wp
      if (abs(rotation) > 0.0_wp) then
         s = sin(rotation)
         c = cos(rotation)
      end if
      body%rotation = rotation
      body%s = s
      body%c = c
   end subroutine rotate

   !> Position of body i, whose rotation is known, from that of body i - 1: its bottom and its top (x, y) [m].
   pure subroutine locate(column, q, i, body, bottom, top)
      class(finite_chain_type), intent(in) :: column
      !> Deformations of the joints by kind
      real(wp), intent(in) :: q(column%n, column%kinds)
      !> Number of the body, from the ground up
      integer, intent(in) :: i
      !> Body i, rotated
      type(moving_body), intent(in) :: body
      real(wp), intent(out) :: bottom(2)
      !> On entry the top of body i - 1
      real(wp), intent(inout) :: top(2)

      bottom = top + q(i, shear)*[body%c_below, -body%s_below]
      if (column%opens) bottom = bottom + q(i, axial)*[body%s_below, body%c_below]
      top = bottom + column%length(i)*[body%s, body%c]
   end subroutine locate

   !> Kinetic energy relative to the ground [J].
   pure real(wp) function kinetic_energy(self, d, v) result(energy)
      class(finite_chain_type), intent(in) :: self
      !> Deformations of the joints by kind, and their velocities (springs)
      real(wp), intent(in), contiguous :: d(:), v(:)
      type(moving_body) :: body
      integer :: i

      ! One body, without openings
      if (size(d) == 2) then
         energy = 0.5_wp*(self%mass(1)*v(1)**2 + self%inertia_above(1)*v(2)**2) &
                  + self%moment_above(1)*cos(d(2))*v(1)*v(2)
         return
      end if
      energy = 0.0_wp
      do i = 1, self%n
         call climb(self, d, v, i, body)
         energy = energy + self%mass(i)*(body%centroid(1)**2 + body%centroid(2)**2) &
                  + self%inertia(i)*body%spin**2
      end do
      energy = 0.5_wp*energy
   end function kinetic_energy

   !> Potential of the constant axial load and of the weight; zero for the straight closed column [J].
   pure real(wp) function potential_energy(self, d) result(energy)
      class(finite_chain_type), intent(in) :: self
      !> Deformations of the joints by kind (springs)
      real(wp), intent(in), contiguous :: d(:)
      !> Rotation of a body; sine and cosine of its half; what its length loses in height; rise of its top
      real(wp) :: rotation, half(2), drop, rise, s, c
      integer :: i, n

      n = self%n
      energy = 0.0_wp
      rotation = 0.0_wp
      rise = 0.0_wp
      s = 0.0_wp
      c = 1.0_wp
      do i = 1, n
         if (i == n .and. self%held) then
            s = 0.0_wp
            c = 1.0_wp
         end if
         rise = rise - d(i)*s
         if (self%opens) rise = rise + d(2*n + i)*c
         rotation = rotation + d(n + i)
         ! 1 - cos without cancellation
         half = [sin(0.5_wp*rotation), cos(0.5_wp*rotation)]
         drop = self%length(i)*2.0_wp*half(1)**2
         s = 2.0_wp*half(1)*half(2)
         c = 1.0_wp - 2.0_wp*half(1)**2
         energy = energy + self%weight(i)*(rise - 0.5_wp*drop)
         rise = rise - drop
      end do
      energy = energy + self%axial_load*rise
   end function potential_energy

   !> Velocities of the bodies relative to the ground: x and y of the centroids, rotation (3, n) [m/s, rad/s].
   pure subroutine body_velocities(self, d, v, velocity)
      class(finite_chain_type), intent(in) :: self
      !> Deformations of the joints by kind, and their velocities (springs)
      real(wp), intent(in), contiguous :: d(:), v(:)
      real(wp), intent(out) :: velocity(:, :)
      type(moving_body) :: body
      integer :: i

      do i = 1, self%n
         call climb(self, d, v, i, body)
         velocity(:, i) = [body%centroid, body%spin]
      end do
   end subroutine body_velocities

   !> Velocity conjugate to a signal of the loads: of the top along x for the lateral force [m/s], the
   !> momentum along x with its sign turned for the acceleration of the ground [kg m/s].
   pure real(wp) function speed(self, signal, d, v)
      class(finite_chain_type), intent(in) :: self
      !> `lateral` or `horizontal`
      integer, intent(in) :: signal
      !> Deformations of the joints by kind, and their velocities (springs)
      real(wp), intent(in), contiguous :: d(:), v(:)
      type(moving_body) :: body
      integer :: i

      ! One body, without openings
      if (size(d) == 2) then
         associate (turning => cos(d(2))*v(2))
            speed = v(1) + self%length(1)*turning
            if (signal == horizontal) speed = -(self%mass(1)*v(1) + self%moment_above(1)*turning)
         end associate
         return
      end if
      speed = 0.0_wp
      do i = 1, self%n
         call climb(self, d, v, i, body)
         speed = speed - self%mass(i)*body%centroid(1)
      end do
      if (signal == lateral) speed = body%top(1)
   end function speed

   !> Power of the loads that are in no potential: lateral force, accelerations of the ground, changes of the
   !> axial load [W].
   pure real(wp) function power_of_loads(self, d, v, load) result(power)
      class(finite_chain_type), intent(in) :: self
      !> Deformations of the joints by kind, and their velocities (springs); signals of the loads
      real(wp), intent(in), contiguous :: d(:), v(:), load(:)
      type(moving_body) :: body
      real(wp) :: force(2)
      integer :: i

      power = 0.0_wp
      do i = 1, self%n
         call climb(self, d, v, i, body)
         power = power - self%mass(i)*(load(horizontal)*body%centroid(1) + load(vertical)*body%centroid(2))
      end do
      call self%find_top_force(load, .false., force)
      power = power + sum(force*body%top)
   end function power_of_loads

   !> Angular momentum [kg m2/s] about the bottom of the first body, where slip and opening have moved it.
   pure real(wp) function angular_momentum(self, d, v) result(momentum)
      class(finite_chain_type), intent(in) :: self
      !> Deformations of the joints by kind, and their velocities (springs)
      real(wp), intent(in), contiguous :: d(:), v(:)
      type(moving_body) :: body
      real(wp) :: foot(2), bottom(2), top(2), lever(2)
      integer :: i

      momentum = 0.0_wp
      top = 0.0_wp
      do i = 1, self%n
         call climb(self, d, v, i, body)
         call locate(self, d, i, body, bottom, top)
         if (i == 1) foot = bottom
         lever = bottom + self%lower(i)*[body%s, body%c] - foot
         momentum = momentum + self%mass(i)*(body%centroid(1)*lever(2) - body%centroid(2)*lever(1)) &
                    + self%inertia(i)*body%spin
      end do
   end function angular_momentum

   !> Displacement of the top along x [m].
   pure real(wp) function top_displacement(self, d) result(x)
      class(finite_chain_type), intent(in) :: self
      !> Deformations of the joints by kind (springs)
      real(wp), intent(in), contiguous :: d(:)
      real(wp) :: top(2)

      ! One body, without openings
      if (size(d) == 2) then
         x = d(1) + self%length(1)*sin(d(2))
      else
         top = top_place(self, d)
         x = top(1)
      end if
   end function top_displacement

   !> Height of the top above the ground [m].
   pure real(wp) function top_height(self, d) result(y)
      class(finite_chain_type), intent(in) :: self
      !> Deformations of the joints by kind (springs)
      real(wp), intent(in), contiguous :: d(:)
      real(wp) :: top(2)

      top = top_place(self, d)
      y = top(2)
   end function top_height

   !> Place of the top (x, y) [m].
   pure function top_place(self, d) result(top)
      class(finite_chain_type), intent(in) :: self
      !> Deformations of the joints by kind (springs)
      real(wp), intent(in), contiguous :: d(:)
      real(wp) :: top(2)
      type(moving_body) :: body
      real(wp) :: bottom(2)
      integer :: i

      top = 0.0_wp
      do i = 1, self%n
         call rotate(self, d, i, body)
         call locate(self, d, i, body, bottom, top)
      end do
   end function top_place

   !> Acceleration of the top along x, relative to the ground [m/s2]: the sum of those of slips, openings and
   !> lengths of the bodies.
   pure real(wp) function top_acceleration(self, d, v, a) result(acceleration)
      class(finite_chain_type), intent(in) :: self
      !> Deformations of the joints by kind, and their first and second derivatives (springs)
      real(wp), intent(in), contiguous :: d(:), v(:), a(:)
      !> Of a body: rotation and its derivatives; of its joint: acceleration along t and e of the body below
      real(wp) :: rotation, spin, spin_rate, s, c, along_t, along_e
      integer :: i, n

      n = self%n
      acceleration = 0.0_wp
      rotation = 0.0_wp
      spin = 0.0_wp
      spin_rate = 0.0_wp
      do i = 1, n
         if (i == n .and. self%held) then
            rotation = 0.0_wp
            spin = 0.0_wp
            spin_rate = 0.0_wp
         end if
         s = sin(rotation)
         c = cos(rotation)
         along_t = a(i) - d(i)*spin**2
         along_e = -2.0_wp*v(i)*spin - d(i)*spin_rate
         if (self%opens) then
            along_t = along_t + 2.0_wp*v(2*n + i)*spin + d(2*n + i)*spin_rate
            along_e = along_e + a(2*n + i) - d(2*n + i)*spin**2
         end if
         rotation = rotation + d(n + i)
         spin = spin + v(n + i)
         spin_rate = spin_rate + a(n + i)
         acceleration = acceleration + along_t*c + along_e*s &
                        + self%length(i)*(cos(rotation)*spin_rate - sin(rotation)*spin**2)
      end do
   end function top_acceleration

end module rbs_structure_column_finite
