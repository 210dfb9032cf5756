!> Columns that are advanced side by side, each in a lane: each value is an array over the lanes, so that one
!> instruction does the same for several columns. It uses nothing of the rest of the program, since it is
!> compiled together with the kernels, each for its own set of instructions.
module rbs_solve_ensemble_lane_arrays
   use, intrinsic :: iso_fortran_env, only: int32, real64
   implicit none
   private

   public :: lane_clock, body_arrays, lane_method, kernel_type, lanes, wp

   integer, parameter :: wp = real64

   !> Columns side by side: a compile-time number, so that the loops have no remainders, and so small that the
   !> numbers of the lanes stay near the processor, with those that their events need.
   integer, parameter :: lanes = 32

   !> Deformations beyond this [m, rad] have no meaning.
   real(wp), parameter, public :: out_of_bounds = 1.0e100_wp

   !> Whether a method is implicit, its parameters, and the shares of the forces that the residual may have:
   !> that which is wanted, and that which does where it decreases no more.
   type :: lane_method
      logical :: implicit = .false.
      real(wp) :: alpha_m = 0.0_wp, alpha_f = 0.0_wp, beta = 0.25_wp, gamma = 0.5_wp, wanted = 1.0e-12_wp, &
                  acceptable = 1.0e-7_wp
   end type lane_method

   !> Numbers of every lane: the motion of the ground, the clock, the measures of the run, and the column; in
   !> SI units. Flags are 1 or 0.
   type :: lane_clock
      !> Whether there is a run in the lane, and whether its next step may be taken on its lines
      real(wp) :: active(lanes) = 0.0_wp, ready(lanes) = 0.0_wp
      !> Whether the last step has ended, but springs have still to follow; else it was not taken
      real(wp) :: tried(lanes) = 0.0_wp
      !> Time, step, number of the step within its interval and of steps in an interval
      real(wp) :: t(lanes) = 0.0_wp, h(lanes) = 1.0_wp, part(lanes) = 0.0_wp, parts(lanes) = 1.0_wp
      !> The present interval of the motion: begin and finish, value at the begin and slope; the same of the
      !> next; scale of the motion
      real(wp) :: begin(lanes) = 0.0_wp, finish(lanes) = 1.0_wp, value(lanes) = 0.0_wp, slope(lanes) = 0.0_wp
      real(wp) :: next_finish(lanes) = 2.0_wp, next_value(lanes) = 0.0_wp, next_slope(lanes) = 0.0_wp
      real(wp) :: after_value(lanes) = 0.0_wp, scale(lanes) = 0.0_wp
      !> Acceleration of the ground now
      real(wp) :: ground(lanes) = 0.0_wp
      !> Work of the loads and of the damping, steps taken here
      real(wp) :: of_loads(lanes) = 0.0_wp, of_damping(lanes) = 0.0_wp, steps(lanes) = 0.0_wp
      !> Displacement now, the largest so far, and where the column has collapsed; the largest force at the
      !> base and rotation of a body; time of the step before
      real(wp) :: displacement(lanes) = 0.0_wp, peak(lanes) = 0.0_wp, furthest(lanes) = huge(1.0_wp)
      real(wp) :: base(lanes) = 0.0_wp, rotation(lanes) = 0.0_wp, seen(lanes) = 0.0_wp
      !> Whether a deformation is where a limit state may be reached, and whether it is in any lane
      real(wp) :: beyond(lanes) = 0.0_wp, any_beyond = 0.0_wp
      !> Whether a spring may come there on its present line, and whether one may in any lane: else no
      !> deformation need be looked at
      real(wp) :: may_reach(lanes) = 0.0_wp
      logical :: watched = .false.
      !> The largest error of the energy, and the largest energy, at the times of the motion
      real(wp) :: residual(lanes) = 0.0_wp, most(lanes) = 0.0_wp
      !> Whether the run has ended; intervals that are left
      real(wp) :: ended(lanes) = 0.0_wp, left(lanes) = 0.0_wp
      !> Place of the next point of the motion but one
      integer(int32) :: at(lanes) = 1
      !> Result of an implicit step for lanes whose springs leave their lines: the motion of the
      !> body moves on its lines, the work of the residual on that, and the acceleration of the ground
      real(wp) :: trial(lanes, 4) = 0.0_wp
      !> Inverse of the tangent of an implicit step (11, 12, 21, 22), and 1/(beta h**2); of RK4 the
      !> acceleration that half a step takes away for each velocity by springs and axial force [1/s]
      real(wp) :: inverse(lanes, 4) = 0.0_wp, per_h(lanes) = 0.0_wp, g(lanes, 4) = 0.0_wp
      !> Damping matrix C on the present lines (11, 12, 22); for RK4 M^-1 C (11, 12, 21, 22) [1/s]
      real(wp) :: c(lanes, 3) = 0.0_wp, d(lanes, 4) = 0.0_wp
      !> Inverse of the mass in slip and rotation; moment of the axial force per rotation
      real(wp) :: inv_mass(lanes) = 0.0_wp, inv_coupling(lanes) = 0.0_wp, inv_inertia(lanes) = 0.0_wp, &
                  pdelta_moment(lanes) = 0.0_wp
      !> Mass and rotary inertia, distances of the centroid from bottom and top, length
      real(wp) :: mass(lanes, 2) = 1.0_wp, lower(lanes) = 0.0_wp, upper(lanes) = 0.0_wp, &
                  length(lanes) = 0.0_wp
      !> Whether the columns are damped
      logical :: damped = .false.
   end type lane_clock

   !> How the columns move and the lines of their springs (lanes, slip and rotation).
   type :: body_arrays
      !> Deformations and velocities, deformations before the step, and those between which no limit state is
      !> reached for the first time
      real(wp), dimension(lanes, 2) :: q = 0.0_wp, v = 0.0_wp, from = 0.0_wp, lowest = -huge(1.0_wp), &
                                       highest = huge(1.0_wp)
      !> Lines of the springs, as in `spring_array`; direction +1 or -1 where they unload on reversal
      real(wp), dimension(lanes, 2) :: d0 = 0.0_wp, f0 = 0.0_wp, k = 0.0_wp, lower = 0.0_wp, upper = 0.0_wp, &
                                       direction = 0.0_wp, work = 0.0_wp
      !> Of implicit methods: velocities, accelerations and forces of the bodies at the start, the largest
      !> forces so far
      real(wp), dimension(lanes, 2) :: v0 = 0.0_wp, a0 = 0.0_wp, g0 = 0.0_wp, largest = 0.0_wp
   end type body_arrays

   abstract interface
      !> A step of all lanes. Lanes that have a run and could not take it, or not wholly, are listed.
      subroutine advance_interface(x, y, method, count, list)
         import :: lane_clock, body_arrays, lane_method, lanes
         type(lane_clock), intent(inout) :: x
         type(body_arrays), intent(inout) :: y
         type(lane_method), intent(in) :: method
         !> How many lanes are listed, and which: the first `count` of the list
         integer, intent(out) :: count, list(lanes)
      end subroutine advance_interface

      !> After a step of all lanes: the clock and the measures. Lanes whose runs have ended are listed.
      subroutine finish_interface(x, y, m, time, acceleration, count, list)
         import :: lane_clock, body_arrays, lanes, wp
         type(lane_clock), intent(inout) :: x
         type(body_arrays), intent(inout) :: y
         !> Points of all motions, one motion after the other, in which `lane_clock%at` is a place [s, m/s2]
         integer, intent(in) :: m
         real(wp), intent(in) :: time(m), acceleration(m)
         !> How many lanes are listed, and which: the first `count` of the list
         integer, intent(out) :: count, list(lanes)
      end subroutine finish_interface
   end interface

   !> The procedures of a kernel.
   type :: kernel_type
      procedure(advance_interface), pointer, nopass :: advance => null()
      procedure(finish_interface), pointer, nopass :: finish => null()
   end type kernel_type

end module rbs_solve_ensemble_lane_arrays
