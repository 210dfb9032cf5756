!> Columns that are advanced side by side: each value is an array over the lanes, so that one instruction does
!> the same for several columns. It stands below the rest of the program, since it is
!> compiled together with the kernels, each for its own set of instructions.
module rbs_solve_ensemble_lane_fields
   use, intrinsic :: iso_fortran_env, only: int32, real64
   implicit none
   private

   public :: lane_clock, one_body_lanes, chain_block, lane_method, lanes, few, wp

   integer, parameter :: wp = real64

   !> Columns side by side: a compile-time number, so that the loops have no remainders.
   integer, parameter :: lanes = 64

   !> Chains advance in blocks of fewer lanes, whose numbers stay near the processor.
   integer, parameter :: few = 16

   !> Parameters of an implicit method, and the shares of the forces that the residual may have: that which is
   !> wanted, and that which does where it decreases no more.
   type :: lane_method
      real(wp) :: alpha_m = 0.0_wp, alpha_f = 0.0_wp, beta = 0.25_wp, gamma = 0.5_wp, wanted = 1.0e-12_wp, &
                  acceptable = 1.0e-7_wp
   end type lane_method

   !> What all lanes have: the motion of the ground, the clock, and what is measured, in SI units.
   type :: lane_clock
      !> Whether there is a run in the lane, and whether its next step may be taken on its lines: 1 or 0
      real(wp) :: active(lanes) = 0.0_wp, ready(lanes) = 0.0_wp
      !> Whether the last step has ended, 1, but springs have still to follow, or 0: it was not taken
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
      !> Work of the loads, steps taken here, lines left here
      real(wp) :: of_loads(lanes) = 0.0_wp, steps(lanes) = 0.0_wp, events(lanes) = 0.0_wp
      !> Displacement now, the largest so far, and where the column has collapsed; the largest force at the
      !> base and rotation of a body; time of the step before
      real(wp) :: displacement(lanes) = 0.0_wp, peak(lanes) = 0.0_wp, furthest(lanes) = huge(1.0_wp)
      real(wp) :: base(lanes) = 0.0_wp, rotation(lanes) = 0.0_wp, seen(lanes) = 0.0_wp
      !> Whether the run has ended: 1 or 0; intervals that are left
      real(wp) :: ended(lanes) = 0.0_wp, left(lanes) = 0.0_wp
      !> Place of the next point of the motion but one
      integer(int32) :: at(lanes) = 1
   end type lane_clock

   !> Columns of one body without damping; second index: 1 slip, 2 rotation, or the body's displacement and
   !> rotation.
   type, extends(lane_clock) :: one_body_lanes
      !> Deformations and velocities of the joint; of the body: velocities, accelerations, forces, and the
      !> largest forces so far, of implicit methods only
      real(wp) :: q(lanes, 2) = 0.0_wp, v(lanes, 2) = 0.0_wp
      real(wp) :: v0(lanes, 2) = 0.0_wp, a0(lanes, 2) = 0.0_wp, g0(lanes, 2) = 0.0_wp, &
                  largest(lanes, 2) = 0.0_wp
      !> Lines of the springs, as in `spring_lines`; the way is +1 or -1 for one-way lines
      real(wp) :: d0(lanes, 2) = 0.0_wp, f0(lanes, 2) = 0.0_wp, k(lanes, 2) = 0.0_wp, &
                  first(lanes, 2) = 0.0_wp, last(lanes, 2) = 0.0_wp, way(lanes, 2) = 0.0_wp, &
                  work(lanes, 2) = 0.0_wp
      !> Ends of the lines and whether they belong to them, as in `segment`
      real(wp) :: lo(lanes, 2) = 0.0_wp, hi(lanes, 2) = 0.0_wp
      logical :: lo_closed(lanes, 2) = .false., hi_closed(lanes, 2) = .false.
      !> What the last step leaves for lanes whose springs leave their lines: of RK4 the deformations at its
      !> start, of implicit methods what the body moves on its lines, the work of the residual on that, and
      !> the acceleration of the ground at the end
      real(wp) :: from(lanes, 2) = 0.0_wp, trial(lanes, 4) = 0.0_wp
      !> Inverse of the tangent of an implicit step (11, 12, 21, 22), and 1/(beta h**2)
      real(wp) :: inverse(lanes, 4) = 0.0_wp, per_h(lanes) = 0.0_wp
      !> Of RK4, see `resistance_per_velocity` (11, 12, 21, 22)
      real(wp) :: g(lanes, 4) = 0.0_wp
      !> Inverse of the mass in slip and rotation; moment of the axial force per rotation
      real(wp) :: flexible(lanes) = 0.0_wp, coupling(lanes) = 0.0_wp, turning(lanes) = 0.0_wp, &
                  softening(lanes) = 0.0_wp
      !> The column: mass and rotary inertia, distances of the centroid from bottom and top, length, inertia
      !> load per acceleration of the ground, half of axial force times length
      real(wp) :: mass(lanes, 2) = 1.0_wp, lower(lanes) = 0.0_wp, upper(lanes) = 0.0_wp, &
                  length(lanes) = 0.0_wp, ground_arm(lanes, 2) = 0.0_wp, potential(lanes) = 0.0_wp
      !> The largest error of the energy and energy at the times of the motion; rotation that is yielding,
      !> when it was reached first, and rotation after the step before
      real(wp) :: residual(lanes) = 0.0_wp, most(lanes) = 0.0_wp
      real(wp) :: yield(lanes) = huge(1.0_wp), first_yield(lanes) = huge(1.0_wp), turned(lanes) = 0.0_wp
   end type one_body_lanes

   !> Some columns of n bodies, with or without damping: joints (few, n), unknowns (few, 2 n) in the order of
   !> the joints, slips before rotations, or of the bodies, displacement and rotation of each.
   type :: chain_block
      integer :: n = 0
      !> Whether there is any damping, and modal damping
      logical :: damped = .false., modal = .false.
      !> Deformations and velocities of the joints, deformations before the step, and those between which no
      !> limit state is reached for the first time; displacement of the top, largest rotation of a body and
      !> force at the base
      real(wp), allocatable :: q(:, :), v(:, :), from(:, :), lowest(:, :), highest(:, :)
      real(wp) :: top(few) = 0.0_wp, turn(few) = 0.0_wp, base(few) = 0.0_wp
      !> Whether a deformation is at one of those bounds, 1 or 0
      real(wp) :: beyond(few) = 0.0_wp
      !> Lines of the springs
      real(wp), allocatable :: d0(:, :), f0(:, :), k(:, :), first(:, :), last(:, :), way(:, :), work(:, :)
      !> Damping of the joints per velocity; what of it stands under the sum of its power, and the factor
      !> before that sum; damping of the bodies per momentum; modal damping (few, 2 n, 2 n); its work
      real(wp), allocatable :: damping(:, :), summed(:, :), matrix(:, :, :)
      real(wp) :: factor(few) = 1.0_wp, of_mass(few) = 0.0_wp, of_damping(few) = 0.0_wp
      !> The column, see `column_type`; mass and inertia in the order of the bodies
      real(wp), allocatable :: lower(:, :), upper(:, :), inverse_mass(:, :), inverse_inertia(:, :), &
                               along(:, :), across(:, :), arm(:, :), ground_arm(:, :), mass(:, :)
      real(wp) :: mass_above(few) = 0.0_wp
      !> Of implicit methods: velocities, accelerations and forces of the bodies at the start, the largest
      !> forces so far, and the factor of the tangent (few, 4, 2 n)
      real(wp), allocatable :: v0(:, :), a0(:, :), g0(:, :), tangent(:, :, :)
      real(wp) :: largest(few, 2) = 0.0_wp
   end type chain_block

end module rbs_solve_ensemble_lane_fields
