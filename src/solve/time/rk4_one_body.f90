!> The classical Runge-Kutta step for the paper's column: one body, small rotations, no damping, lateral force
!> and horizontal ground motion. It is the one fast path beside `acceleration`: the two unknowns stay in
!> registers, while the loops of a chain and their calls would take nearly all of the time. The equations
!> are those of the chain.
module rbs_solve_time_rk4_one_body
   use rbs_base_kinds, only: wp
   use rbs_solve_time_loads, only: lateral, horizontal
   use rbs_solve_time_motion, only: motion_type
   use rbs_solve_time_state, only: state_type, out_of_bounds
   implicit none
   private

   public :: advance_one_body, step_of_one_body

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
      real(wp) :: half, sixth, flexible, coupling, turning, softening
      real(wp) :: along(3), about(3), load_along(3), load_about(3), force, moment, shear, flexure
      real(wp) :: g11, g12, g21, g22
      real(wp) :: u1, u2, u3, u4, r1, r2, r3, r4, a1, a2, a3, a4, b1, b2, b3, b4
      integer :: j

      ! Inverse of the mass matrix in slip and rotation.
      flexible = motion%inverse_mass(1) + motion%column%lower(1)**2*motion%inverse_inertia(1)
      coupling = -motion%column%lower(1)*motion%inverse_inertia(1)
      turning = motion%inverse_inertia(1)
      softening = 0.0_wp
      if (motion%second_order) softening = motion%column%axial_body(1)*motion%column%length(1)
      ! Loads along the slip and about the joint.
      do j = 1, 3
         load_along(j) = load_force(j) - motion%column%ground_arm(1)*load_ground(j)
         load_about(j) = motion%column%arm(2)*load_force(j) - motion%column%ground_arm(2)*load_ground(j)
      end do
      half = 0.5_wp*h
      sixth = h*(1.0_wp/6.0_wp)

      ! On its line a spring resists a stage with its force at the start of the step plus k times the way from
      ! there, which is a multiple of the velocity: the accelerations are c - G v. This keeps the chain of
      ! dependent operations from stage to stage short.
      shear = half*k(1)
      flexure = half*(k(2) - softening)
      g11 = flexible*shear
      g12 = coupling*flexure
      g21 = coupling*shear
      g22 = turning*flexure
      along = load_along - (f0(1) + k(1)*(q(1) - d0(1)))
      about = load_about - (f0(2) + k(2)*(q(2) - d0(2))) + softening*q(2)

      u1 = v(1)
      r1 = v(2)
      a1 = flexible*along(1) + coupling*about(1)
      b1 = coupling*along(1) + turning*about(1)
      u2 = u1 + half*a1
      r2 = r1 + half*b1

      force = flexible*along(2) + coupling*about(2)
      moment = coupling*along(2) + turning*about(2)
      a2 = force - (g11*u1 + g12*r1)
      b2 = moment - (g21*u1 + g22*r1)
      u3 = u1 + half*a2
      r3 = r1 + half*b2

      a3 = force - (g11*u2 + g12*r2)
      b3 = moment - (g21*u2 + g22*r2)
      u4 = u1 + h*a3
      r4 = r1 + h*b3

      a4 = (flexible*along(3) + coupling*about(3)) - 2.0_wp*(g11*u3 + g12*r3)
      b4 = (coupling*along(3) + turning*about(3)) - 2.0_wp*(g21*u3 + g22*r3)

      q(1) = q(1) + sixth*(u1 + 2.0_wp*(u2 + u3) + u4)
      q(2) = q(2) + sixth*(r1 + 2.0_wp*(r2 + r3) + r4)
      v(1) = u1 + sixth*(a1 + 2.0_wp*(a2 + a3) + a4)
      v(2) = r1 + sixth*(b1 + 2.0_wp*(b2 + b3) + b4)
      of_loads = sixth*((load_along(1)*u1 + load_about(1)*r1) &
                        + 2.0_wp*(load_along(2)*(u2 + u3) + load_about(2)*(r2 + r3)) &
                        + (load_along(3)*u4 + load_about(3)*r4))
   end subroutine step_of_one_body

end module rbs_solve_time_rk4_one_body
