!> Columns of one body that are advanced side by side: each value is an array over the lanes, so that one
!> instruction does the same for several columns. It stands below the rest of the program, since it is
!> compiled together with the kernels, each for its own set of instructions.
module rbs_solve_ensemble_lane_fields
   use, intrinsic :: iso_fortran_env, only: int32, real64
   implicit none
   private

   public :: one_body_lanes, lane_method, lanes, wp

   integer, parameter :: wp = real64

   !> Columns side by side: a compile-time number, so that the loops have no remainders.
   integer, parameter :: lanes = 64

   !> Parameters of an implicit method, and the share of the forces that the residual may have.
   type :: lane_method
      real(wp) :: alpha_m = 0.0_wp, alpha_f = 0.0_wp, beta = 0.25_wp, gamma = 0.5_wp, wanted = 1.0e-12_wp
   end type lane_method

   !> In SI units; second index: 1 slip, 2 rotation, or the body's displacement and rotation.
   type :: one_body_lanes
      !> Whether there is a run in the lane, and whether its next step may be taken on its lines: 1 or 0
      real(wp) :: active(lanes) = 0.0_wp, ready(lanes) = 0.0_wp
      !> Deformations and velocities of the joint; of the body: velocities, accelerations, forces, and the
      !> largest forces so far, of implicit methods only
      real(wp) :: q(lanes, 2) = 0.0_wp, v(lanes, 2) = 0.0_wp
      real(wp) :: v0(lanes, 2) = 0.0_wp, a0(lanes, 2) = 0.0_wp, g0(lanes, 2) = 0.0_wp, &
                  largest(lanes, 2) = 0.0_wp
      !> Lines of the springs, as in `spring_lines`; the way is +1 or -1 for one-way lines
      real(wp) :: d0(lanes, 2) = 0.0_wp, f0(lanes, 2) = 0.0_wp, k(lanes, 2) = 0.0_wp, &
                  first(lanes, 2) = 0.0_wp, last(lanes, 2) = 0.0_wp, way(lanes, 2) = 0.0_wp, &
                  work(lanes, 2) = 0.0_wp
      !> Ends of the lines and whether they belong to them, as in `segment`; lines left
      real(wp) :: lo(lanes, 2) = 0.0_wp, hi(lanes, 2) = 0.0_wp, events(lanes) = 0.0_wp
      logical :: lo_closed(lanes, 2) = .false., hi_closed(lanes, 2) = .false.
      !> What the last step leaves for lanes whose springs leave their lines: whether it was tried, 1 or 0; of
      !> RK4 the deformations at its start, of implicit methods what the body moves on its lines, the work of
      !> the residual on that, and the acceleration of the ground at the end
      real(wp) :: tried(lanes) = 0.0_wp, from(lanes, 2) = 0.0_wp, trial(lanes, 4) = 0.0_wp
      !> Inverse of the tangent of an implicit step (11, 12, 21, 22), and 1/(beta h**2)
      real(wp) :: inverse(lanes, 4) = 0.0_wp, per_h(lanes) = 0.0_wp
      !> Inverse of the mass in slip and rotation; moment of the axial force per rotation
      real(wp) :: flexible(lanes) = 0.0_wp, coupling(lanes) = 0.0_wp, turning(lanes) = 0.0_wp, &
                  softening(lanes) = 0.0_wp
      !> The column: mass and rotary inertia, distances of the centroid from bottom and top, length, inertia
      !> load per acceleration of the ground, half of axial force times length
      real(wp) :: mass(lanes, 2) = 1.0_wp, lower(lanes) = 0.0_wp, upper(lanes) = 0.0_wp, &
                  length(lanes) = 0.0_wp, ground_arm(lanes, 2) = 0.0_wp, potential(lanes) = 0.0_wp
      !> Time, step, number of the step within its interval and of steps in an interval
      real(wp) :: t(lanes) = 0.0_wp, h(lanes) = 1.0_wp, part(lanes) = 0.0_wp, parts(lanes) = 1.0_wp
      !> The present interval of the motion: begin and finish, value at the begin and slope; the same of the
      !> next; scale of the motion
      real(wp) :: begin(lanes) = 0.0_wp, finish(lanes) = 1.0_wp, value(lanes) = 0.0_wp, slope(lanes) = 0.0_wp
      real(wp) :: next_finish(lanes) = 2.0_wp, next_value(lanes) = 0.0_wp, next_slope(lanes) = 0.0_wp
      real(wp) :: after_value(lanes) = 0.0_wp, scale(lanes) = 0.0_wp
      !> Acceleration of the ground now
      real(wp) :: ground(lanes) = 0.0_wp
      !> Work of the loads, steps taken here
      real(wp) :: of_loads(lanes) = 0.0_wp, steps(lanes) = 0.0_wp
      !> What is measured: displacement now, and where the column has collapsed; the largest displacement,
      !> force at the base, rotation, error of the energy and energy; kinetic energy at the last row; rotation
      !> that is yielding, and when it was reached first
      real(wp) :: displacement(lanes) = 0.0_wp, furthest(lanes) = huge(1.0_wp), peak(lanes) = 0.0_wp, &
                  base(lanes) = 0.0_wp, rotation(lanes) = 0.0_wp, residual(lanes) = 0.0_wp, &
                  most(lanes) = 0.0_wp, &
                  yield(lanes) = huge(1.0_wp), first_yield(lanes) = huge(1.0_wp)
      !> Whether the run has ended: 1 or 0; intervals that are left
      real(wp) :: ended(lanes) = 0.0_wp, left(lanes) = 0.0_wp
      !> Place of the next point of the motion but one
      integer(int32) :: at(lanes) = 1
   end type one_body_lanes

end module rbs_solve_ensemble_lane_fields
