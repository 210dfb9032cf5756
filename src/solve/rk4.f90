!> One step of the classical Runge-Kutta scheme (the paper's choice), and nothing else.
module rbs_solve_rk4
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_springs, only: spring_array
   use rbs_solve_motion, only: motion_type
   implicit none
   private

   public :: rk4_work, step

   !> Arrays of the scheme, allocated once.
   type :: rk4_work
      real(wp), allocatable :: q(:), v(:), a(:), f(:), dq(:), dv(:)
   contains
      procedure :: create
   end type rk4_work

contains

   subroutine create(self, m)
      class(rk4_work), intent(out) :: self
      !> Number of unknowns
      integer, intent(in) :: m

      allocate (self%q(m), self%v(m), self%a(m), self%f(m), self%dq(m), self%dv(m))
   end subroutine create

   !> Advance q and v by h. Springs stay on their present lines within the step; the works of loads and
   !> damping are integrated with the weights of the scheme.
   subroutine step(motion, springs, work, h, force, ground, q, v, work_of_loads, work_of_damping)
      type(motion_type), intent(inout) :: motion
      type(spring_array), intent(in) :: springs
      type(rk4_work), intent(inout) :: work
      !> Step [s]
      real(wp), intent(in) :: h
      !> Lateral force [N] and acceleration of the ground [m/s2] at the begin, middle and end
      real(wp), intent(in) :: force(3), ground(3)
      !> Deformations and velocities (2 n)
      real(wp), intent(inout) :: q(:), v(:)
      !> Works so far [J]
      real(wp), intent(inout) :: work_of_loads, work_of_damping
      integer, parameter :: at(4) = [1, 2, 2, 3]
      real(wp), parameter :: weight(4) = [1.0_wp, 2.0_wp, 2.0_wp, 1.0_wp]/6.0_wp
      real(wp), parameter :: reach(4) = [0.5_wp, 0.5_wp, 1.0_wp, 0.0_wp]
      real(wp) :: of_loads, of_damping
      integer :: stage

      work%q = q
      work%v = v
      work%dq = 0.0_wp
      work%dv = 0.0_wp
      do stage = 1, 4
         work%f = springs%f0 + springs%k*(work%q - springs%d0)
         call motion%acceleration(work%q, work%v, work%f, force(at(stage)), ground(at(stage)), work%a)
         call motion%power(work%q, work%v, force(at(stage)), ground(at(stage)), of_loads, of_damping)
         work_of_loads = work_of_loads + h*weight(stage)*of_loads
         work_of_damping = work_of_damping + h*weight(stage)*of_damping
         work%dq = work%dq + weight(stage)*work%v
         work%dv = work%dv + weight(stage)*work%a
         if (stage == 4) exit
         work%q = q + (h*reach(stage))*work%v
         work%v = v + (h*reach(stage))*work%a
      end do
      q = q + h*work%dq
      v = v + h*work%dv
   end subroutine step

end module rbs_solve_rk4
