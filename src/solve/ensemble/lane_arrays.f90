!> Columns that are advanced side by side, each in a lane: each value is an array over the lanes, so that one
!> instruction does the same for several columns. It stands below the rest of the program, since it is
!> compiled together with the kernels, each for its own set of instructions.
module rbs_solve_ensemble_lane_arrays
   use, intrinsic :: iso_fortran_env, only: int32, real64
   implicit none
   private

   public :: lane_clock, lane_block, body_arrays, lane_method, kernel_type, allot, lanes, few, wp

   integer, parameter :: wp = real64

   !> Columns side by side: compile-time numbers, so that the loops have no remainders, and so few that their
   !> numbers stay near the processor, with what their events need. Chains advance in blocks of fewer lanes.
   integer, parameter :: lanes = 32, few = 16

   !> Deformations beyond this [m, rad] have no meaning.
   real(wp), parameter, public :: out_of_bounds = 1.0e100_wp

   !> Whether a method is implicit, its parameters, and the shares of the forces that the residual may have:
   !> that which is wanted, and that which does where it decreases no more.
   type :: lane_method
      logical :: implicit = .false.
      real(wp) :: alpha_m = 0.0_wp, alpha_f = 0.0_wp, beta = 0.25_wp, gamma = 0.5_wp, wanted = 1.0e-12_wp, &
                  acceptable = 1.0e-7_wp
   end type lane_method

   !> What there is of every lane: the motion of the ground, the clock, what is measured, and of one body
   !> without damping what its kernel needs; in SI units. Flags are 1 or 0.
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
      !> The largest error of the energy, and the largest energy, at the times of the motion
      real(wp) :: residual(lanes) = 0.0_wp, most(lanes) = 0.0_wp
      !> Whether the run has ended; intervals that are left
      real(wp) :: ended(lanes) = 0.0_wp, left(lanes) = 0.0_wp
      !> Place of the next point of the motion but one
      integer(int32) :: at(lanes) = 1
      !> One body: what an implicit step leaves for lanes whose springs leave their lines, which is what the
      !> body moves on its lines, the work of the residual on that, and the acceleration of the ground
      real(wp) :: trial(lanes, 4) = 0.0_wp
      !> Inverse of the tangent of an implicit step (11, 12, 21, 22), and 1/(beta h**2); of RK4 see
      !> `resistance_per_velocity`
      real(wp) :: inverse(lanes, 4) = 0.0_wp, per_h(lanes) = 0.0_wp, g(lanes, 4) = 0.0_wp
      !> Inverse of the mass in slip and rotation; moment of the axial force per rotation
      real(wp) :: flexible(lanes) = 0.0_wp, coupling(lanes) = 0.0_wp, turning(lanes) = 0.0_wp, &
                  softening(lanes) = 0.0_wp
      !> Mass and rotary inertia, distances of the centroid from bottom and top, length
      real(wp) :: mass(lanes, 2) = 1.0_wp, lower(lanes) = 0.0_wp, upper(lanes) = 0.0_wp, &
                  length(lanes) = 0.0_wp
   end type lane_clock

   !> Some lanes of columns of n bodies: their joints (width, n), and unknowns (width, 2 n) in the order of
   !> the joints, slips before rotations, or of the bodies, displacement and rotation of each. All lanes of
   !> one body without damping are one block, other columns are in blocks of `few`.
   type :: lane_block
      !> Number of lanes, lanes before the block, and bodies
      integer :: width = 0, base = 0, n = 0
      !> Whether there is any damping, and modal damping
      logical :: damped = .false., modal = .false.
      type(lane_method) :: method
      !> Deformations and velocities of the joints, deformations before the step, and those between which no
      !> limit state is reached for the first time
      real(wp), pointer, contiguous :: q(:, :) => null(), v(:, :) => null(), from(:, :) => null(), &
                                       lowest(:, :) => null(), highest(:, :) => null()
      !> Branches of the springs, as in `spring_array`; the way is +1 or -1 for those that unload on reversal
      real(wp), pointer, contiguous :: d0(:, :) => null(), f0(:, :) => null(), k(:, :) => null(), &
                                       first(:, :) => null(), last(:, :) => null(), way(:, :) => null(), &
                                       work(:, :) => null()
      !> Of implicit methods: velocities, accelerations and forces of the bodies at the start, the largest
      !> forces so far (width, 2)
      real(wp), pointer, contiguous :: v0(:, :) => null(), a0(:, :) => null(), g0(:, :) => null(), &
                                       largest(:, :) => null()
      !> Not of one body without damping: damping of the joints per velocity; what of it stands under the sum
      !> of its power, and the factor before that sum; damping of the bodies per momentum; modal damping
      !> (width, 2 n, 2 n)
      real(wp), allocatable :: damping(:, :), summed(:, :), matrix(:, :, :)
      real(wp) :: factor(few) = 1.0_wp, of_mass(few) = 0.0_wp
      !> The column, see `column_type`; mass and inertia in the order of the bodies; factor of the tangent
      !> (width, 4, 2 n)
      real(wp), allocatable :: lower(:, :), upper(:, :), inverse_mass(:, :), inverse_inertia(:, :), &
                               along(:, :), across(:, :), arm(:, :), ground_arm(:, :), mass(:, :), &
                               tangent(:, :, :)
      real(wp) :: mass_above(few) = 0.0_wp
   end type lane_block

   !> The arrays of a block of one body without damping as its kernel sees them, with sizes that the compiler
   !> knows: in the order in which they stand in the room.
   type :: body_arrays
      real(wp), dimension(lanes, 2) :: q, v, from, lowest, highest, d0, f0, k, first, last, way, work, v0, &
                                       a0, g0, largest
   end type body_arrays

   abstract interface
      !> A step of all lanes. Those that have a run and could not take it, or not wholly, are listed.
      subroutine advance_interface(x, block, count, list)
         import :: lane_clock, lane_block, lanes
         implicit none
         type(lane_clock), intent(inout) :: x
         type(lane_block), intent(inout) :: block(:)
         integer, intent(out) :: count, list(lanes)
      end subroutine advance_interface

      !> After a step of all lanes: the clock and what is measured. Lanes whose runs have ended are listed.
      subroutine finish_interface(x, block, m, time, acceleration, count, list)
         import :: lane_clock, lane_block, lanes, wp
         implicit none
         type(lane_clock), intent(inout) :: x
         type(lane_block), intent(inout) :: block(:)
         !> All motions, see `lane_clock%at` [s, m/s2]
         integer, intent(in) :: m
         real(wp), intent(in) :: time(m), acceleration(m)
         integer, intent(out) :: count, list(lanes)
      end subroutine finish_interface
   end interface

   !> The procedures of a kernel.
   type :: kernel_type
      procedure(advance_interface), pointer, nopass :: advance => null()
      procedure(finish_interface), pointer, nopass :: finish => null()
   end type kernel_type

contains

   !> Take an array from a room.
   subroutine allot(room, taken, width, m, array)
      real(wp), intent(inout), target, contiguous :: room(:)
      !> Numbers of the room that are taken
      integer, intent(inout) :: taken
      integer, intent(in) :: width, m
      real(wp), pointer, contiguous, intent(out) :: array(:, :)

      array(1:width, 1:m) => room(taken + 1:taken + width*m)
      taken = taken + width*m
   end subroutine allot

end module rbs_solve_ensemble_lane_arrays
