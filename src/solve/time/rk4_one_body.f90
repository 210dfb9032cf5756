!> The classical Runge-Kutta step for the paper's column: one body, small rotations, no damping, lateral force
!> and horizontal ground motion. It is the one fast path beside `acceleration`: the two unknowns stay in
!> registers, while the loops of a chain and their calls would take nearly all of the time. The equations
!> are those of the chain.
module rbs_solve_time_rk4_one_body
   use rbs_base_kinds, only: wp
   use rbs_loading_loads, only: lateral, horizontal
   use rbs_solve_time_motion, only: motion_type
   use rbs_solve_time_state, only: state_type, out_of_bounds
   implicit none
   private

   public :: advance_one_body, step_of_one_body, inverse_of_mass, resistance_per_velocity

contains

   !> One step; the springs follow at its end.
   subroutine advance_one_body(state, h)
      type(state_type), intent(inout) :: state
      !> Step [s]
      real(wp), intent(in) :: h
      real(wp) :: force(3), ground(3), of_loads

      force = 0.0_wp
      ground = 0.0_wp
      if (state%motion%acts(lateral)) then
         force(1) = state%load(lateral)
         force(2) = state%loads%force%at_time(state%time + 0.5_wp*h)
         force(3) = state%loads%force%at_time(state%time + h)
      end if
      if (state%motion%acts(horizontal)) then
         ground(1) = state%load(horizontal)
         ground(2) = state%loads%ground%at_time(state%time + 0.5_wp*h)
         ground(3) = state%loads%ground%at_time(state%time + h)
      end if
      call step_of_one_body(state%motion, state%springs%d0, state%springs%f0, state%springs%k, h, force, &
                            ground, state%q, state%v, of_loads)
      state%time = state%time + h
      state%load(lateral) = force(3)
      state%load(horizontal) = ground(3)
      state%of_loads = state%of_loads + of_loads
      state%lost = .not. (abs(state%q(1)) < out_of_bounds .and. abs(state%q(2)) < out_of_bounds)
      if (.not. state%lost) call state%springs%move_all(state%q)
   end subroutine advance_one_body

   !> The step on the present lines of both springs, and the work of the loads in it [J]. Acceleration needs
   !> no velocity here, so stages 1 and 2, and 3 and 4, do not wait for each other.
   subroutine step_of_one_body(motion, d0, f0, k, h, load_force, load_ground, q, v, of_loads)
      type(motion_type), intent(in) :: motion
      !> Lines of the springs
      real(wp), intent(in) :: d0(2), f0(2), k(2)
      !> Step [s]; lateral force [N] and acceleration of the ground [m/s2] at its start, middle and end
      real(wp), intent(in) :: h, load_force(3), load_ground(3)
      !> Deformations and velocities
      real(wp), intent(inout) :: q(2), v(2)
      real(wp), intent(out) :: of_loads
      real(wp) :: half, sixth, flexible, coupling, turning, softening, lower, height, push(2), g(4)
      real(wp) :: d0_1, f0_1, k_1, d0_2, f0_2, k_2, q_1, q_2, v_1, v_2, ground_1, ground_2, ground_3
      real(wp) :: along_1, along_2, along_3, about_1, about_2, about_3, shear, flexure, back_1, back_2
      real(wp) :: g11, g12, g21, g22, mid_1, mid_2, of_ground, of_force
      real(wp) :: u1, u2, u3, u4, r1, r2, r3, r4, a1, a2, a3, a4, b1, b2, b3, b4

      half = 0.5_wp*h
      sixth = h*(1.0_wp/6.0_wp)
      call inverse_of_mass(motion, flexible, coupling, turning, softening)
      lower = motion%column%lower(1)
      height = motion%column%arm(2)
      g = resistance_per_velocity(flexible, coupling, turning, softening, k(1), k(2), half)
      g11 = g(1)
      g12 = g(2)
      g21 = g(3)
      g22 = g(4)
      d0_1 = d0(1)
      f0_1 = f0(1)
      k_1 = k(1)
      d0_2 = d0(2)
      f0_2 = f0(2)
      k_2 = k(2)
      q_1 = q(1)
      q_2 = q(2)
      v_1 = v(1)
      v_2 = v(2)
      ground_1 = load_ground(1)
      ground_2 = load_ground(2)
      ground_3 = load_ground(3)
      ! Accelerations by the loads. The ground takes the body with it, so that it accelerates the slip alone.
      push = [flexible + coupling*height, coupling + turning*height]
      along_1 = push(1)*load_force(1) - ground_1
      along_2 = push(1)*load_force(2) - ground_2
      along_3 = push(1)*load_force(3) - ground_3
      about_1 = push(2)*load_force(1)
      about_2 = push(2)*load_force(2)
      about_3 = push(2)*load_force(3)
      ! The lanes of ensembles take the lines up to the next mark from here.
      !---
      ! On its line a spring resists a stage with its force at the start of the step plus k times the way from
      ! there, which is a multiple of the velocity: the accelerations are c - G v. This keeps the chain of
      ! dependent operations from stage to stage short.
      shear = f0_1 + k_1*(q_1 - d0_1)
      flexure = (f0_2 + k_2*(q_2 - d0_2)) - softening*q_2
      back_1 = flexible*shear + coupling*flexure
      back_2 = coupling*shear + turning*flexure

      u1 = v_1
      r1 = v_2
      a1 = along_1 - back_1
      b1 = about_1 - back_2
      u2 = u1 + half*a1
      r2 = r1 + half*b1

      mid_1 = along_2 - back_1
      mid_2 = about_2 - back_2
      a2 = mid_1 - (g11*u1 + g12*r1)
      b2 = mid_2 - (g21*u1 + g22*r1)
      u3 = u1 + half*a2
      r3 = r1 + half*b2

      a3 = mid_1 - (g11*u2 + g12*r2)
      b3 = mid_2 - (g21*u2 + g22*r2)
      u4 = u1 + h*a3
      r4 = r1 + h*b3

      a4 = (along_3 - back_1) - 2.0_wp*(g11*u3 + g12*r3)
      b4 = (about_3 - back_2) - 2.0_wp*(g21*u3 + g22*r3)

      q_1 = q_1 + sixth*(u1 + 2.0_wp*(u2 + u3) + u4)
      q_2 = q_2 + sixth*(r1 + 2.0_wp*(r2 + r3) + r4)
      v_1 = u1 + sixth*(a1 + 2.0_wp*(a2 + a3) + a4)
      v_2 = r1 + sixth*(b1 + 2.0_wp*(b2 + b3) + b4)
      ! Per mass: the velocities of the centroid count.
      of_ground = sixth*(ground_1*(u1 + lower*r1) + 2.0_wp*(ground_2*((u2 + u3) + lower*(r2 + r3))) &
                         + ground_3*(u4 + lower*r4))
      !---
      q = [q_1, q_2]
      v = [v_1, v_2]
      of_force = sixth*(load_force(1)*(u1 + height*r1) &
                        + 2.0_wp*(load_force(2)*((u2 + u3) + height*(r2 + r3))) &
                        + load_force(3)*(u4 + height*r4))
      of_loads = of_force - motion%column%ground_arm(1)*of_ground
   end subroutine step_of_one_body

   !> Acceleration that half a step takes away for each velocity, by the springs on their lines and the axial
   !> force [1/s]: of the slip by slip and by rotation, of the rotation by slip and by rotation.
   pure function resistance_per_velocity(flexible, coupling, turning, softening, k_1, k_2, half) result(g)
      !> See `inverse_of_mass`
      real(wp), intent(in) :: flexible, coupling, turning, softening
      !> Slopes of the lines, half a step [s]
      real(wp), intent(in) :: k_1, k_2, half
      real(wp) :: g(4)
      real(wp) :: shear, flexure

      shear = half*k_1
      flexure = half*(k_2 - softening)
      g = [flexible*shear, coupling*flexure, coupling*shear, turning*flexure]
   end function resistance_per_velocity

   !> Inverse of the mass matrix in slip and rotation [1/kg, 1/(kg m), 1/(kg m2)], and the moment of the axial
   !> force per rotation [N m].
   pure subroutine inverse_of_mass(motion, flexible, coupling, turning, softening)
      type(motion_type), intent(in) :: motion
      real(wp), intent(out) :: flexible, coupling, turning, softening

      flexible = motion%inverse(1) + motion%column%lower(1)**2*motion%inverse(2)
      coupling = -motion%column%lower(1)*motion%inverse(2)
      turning = motion%inverse(2)
      softening = 0.0_wp
      if (motion%second_order) softening = motion%column%axial_body(1)*motion%column%length(1)
   end subroutine inverse_of_mass

end module rbs_solve_time_rk4_one_body
