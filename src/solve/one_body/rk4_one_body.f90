!> The classical Runge-Kutta step for the paper's column: one body, small rotations, lateral force and
!> horizontal ground motion. The two unknowns stay in registers, while the loops of a chain and their
!> calls would take nearly all of the time. The equations are those of the chain.
module rbs_solve_one_body_rk4_one_body
   use rbs_base_kinds, only: wp
   use rbs_structure_column_column, only: column_type, small
   use rbs_hysteresis_springs, only: spring_array
   use rbs_solve_one_body_body_damping, only: body_damping, decay_of
   implicit none
   private

   public :: rk4_body, resistance_per_velocity, pdelta_moment_of

   type :: rk4_body
      !> Inverse of the mass matrix in slip and rotation [1/kg, 1/(kg m), 1/(kg m2)], and the moment of the
      !> axial force per rotation [N m]
      real(wp) :: inv_mass = 0.0_wp, inv_coupling = 0.0_wp, inv_inertia = 0.0_wp, pdelta_moment = 0.0_wp
      !> Distance of the centroid from the joint, length [m], and mass; accelerations by a lateral force
      real(wp), private :: lower = 0.0_wp, height = 0.0_wp, mass = 0.0_wp, push(2) = 0.0_wp
      !> What velocities are multiplied by: results of `resistance_per_velocity` and of `decay_of`, and the
      !> damping C (11, 12, 22); the step and the lines that they belong to
      real(wp), private :: g(4) = 0.0_wp, d(4) = 0.0_wp, c(3) = 0.0_wp, h = -1.0_wp
      integer, private :: version = -1
   contains
      procedure :: create, take_step
   end type rk4_body

contains

   !> Take the constants of a column with one body.
   subroutine create(self, column)
      class(rk4_body), intent(out) :: self
      type(column_type), intent(in) :: column

      self%lower = column%lower(1)
      self%height = column%arm(2)
      self%mass = column%mass(1)
      self%inv_inertia = 1.0_wp/column%inertia(1)
      if (column%held) self%inv_inertia = 0.0_wp
      self%inv_mass = 1.0_wp/column%mass(1) + self%lower**2*self%inv_inertia
      self%inv_coupling = -self%lower*self%inv_inertia
      self%pdelta_moment = pdelta_moment_of(column)
      ! The ground takes the body with it, so that it accelerates the slip alone.
      self%push = [self%inv_mass + self%inv_coupling*self%height, &
                   self%inv_coupling + self%inv_inertia*self%height]
   end subroutine create

   !> The moment of the axial force per rotation [N m].
   pure real(wp) function pdelta_moment_of(column)
      type(column_type), intent(in) :: column

      pdelta_moment_of = 0.0_wp
      if (column%kinematics /= small .and. column%axially_loaded) then
         pdelta_moment_of = column%axial_body(1)*column%length(1)
      end if
   end function pdelta_moment_of

   !> Move deformations and velocities over a step on the present lines of both springs, and find the works of
   !> loads and damping in it [J]; the springs do not follow. Without damping acceleration needs no velocity,
   !> so stages 1 and 2, and 3 and 4, do not wait for each other.
   subroutine take_step(self, springs, damping, h, load_force, load_ground, q, v, of_loads, of_damping)
      class(rk4_body), intent(inout) :: self
      type(spring_array), intent(in) :: springs
      type(body_damping), intent(in) :: damping
      !> Step [s]; lateral force [N] and acceleration of the ground [m/s2] at its start, middle and end
      real(wp), intent(in) :: h, load_force(3), load_ground(3)
      !> Deformations and velocities
      real(wp), intent(inout) :: q(2), v(2)
      !> Works in the step [J]
      real(wp), intent(out) :: of_loads, of_damping
      real(wp) :: half, sixth, q_1, q_2, v_1, v_2, shear, flexure, back_1, back_2, mid_1, mid_2, of_ground
      real(wp) :: along_1, along_2, along_3, about_1, about_2, about_3, of_force
      real(wp) :: u1, u2, u3, u4, r1, r2, r3, r4, a1, a2, a3, a4, b1, b2, b3, b4

      half = 0.5_wp*h
      sixth = h*(1.0_wp/6.0_wp)
      associate (inv_mass => self%inv_mass, inv_coupling => self%inv_coupling, &
                 inv_inertia => self%inv_inertia, pdelta_moment => self%pdelta_moment, lower => self%lower, &
                 d0_1 => springs%d0(1), f0_1 => springs%f0(1), k_1 => springs%k(1), &
                 d0_2 => springs%d0(2), f0_2 => springs%f0(2), k_2 => springs%k(2), &
                 g11 => self%g(1), g12 => self%g(2), g21 => self%g(3), g22 => self%g(4), &
                 damped => damping%acts, c11 => self%c(1), c12 => self%c(2), c22 => self%c(3), &
                 d11 => self%d(1), d12 => self%d(2), d21 => self%d(3), d22 => self%d(4), &
                 ground_1 => load_ground(1), ground_2 => load_ground(2), ground_3 => load_ground(3))
         if (self%version /= springs%version .or. abs(h - self%h) > 0.0_wp) then
            self%g = resistance_per_velocity(inv_mass, inv_coupling, inv_inertia, pdelta_moment, &
                                             k_1, k_2, half)
            if (damping%acts) then
               self%c = damping%on_lines(k_1, k_2)
               self%d = decay_of(inv_mass, inv_coupling, inv_inertia, self%c)
            end if
            self%version = springs%version
            self%h = h
         end if
         q_1 = q(1)
         q_2 = q(2)
         v_1 = v(1)
         v_2 = v(2)
         along_1 = self%push(1)*load_force(1) - ground_1
         along_2 = self%push(1)*load_force(2) - ground_2
         along_3 = self%push(1)*load_force(3) - ground_3
         about_1 = self%push(2)*load_force(1)
         about_2 = self%push(2)*load_force(2)
         about_3 = self%push(2)*load_force(3)
         ! It makes four stages of the velocities `u` of the slip and `r` of the rotation, with accelerations
         ! `a` and `b`, and moves q and v.
         include 'rk4_step.inc'
      end associate
      q(1) = q_1
      q(2) = q_2
      v(1) = v_1
      v(2) = v_2
      of_force = sixth*(load_force(1)*(u1 + self%height*r1) &
                        + 2.0_wp*(load_force(2)*((u2 + u3) + self%height*(r2 + r3))) &
                        + load_force(3)*(u4 + self%height*r4))
      of_loads = of_force - self%mass*of_ground
   end subroutine take_step

   !> Acceleration that half a step takes away for each velocity, by the springs on their lines and the axial
   !> force [1/s]: of the slip by slip and by rotation, of the rotation by slip and by rotation.
   pure function resistance_per_velocity(inv_mass, inv_coupling, inv_inertia, pdelta_moment, &
                                         k_1, k_2, half) result(g)
      !> Inverse of the mass matrix in slip and rotation (11, 12, 22) [1/kg, 1/(kg m), 1/(kg m2)], moment of
      !> the axial force per rotation [N m]; slopes of the lines [N/m, N m], half a step [s]
      real(wp), intent(in) :: inv_mass, inv_coupling, inv_inertia, pdelta_moment, k_1, k_2, half
      real(wp) :: g(4), shear, flexure

      shear = half*k_1
      flexure = half*(k_2 - pdelta_moment)
      g = [inv_mass*shear, inv_coupling*flexure, inv_coupling*shear, inv_inertia*flexure]
   end function resistance_per_velocity

end module rbs_solve_one_body_rk4_one_body
