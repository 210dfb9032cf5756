!> Common part of the static paths of all structures: the springs, the driven quantity, the way from
!> target to target, and the rows.
!>
!> Whether a point of a static path is a state of the structure: the top is where its springs are, each joint
!> is in equilibrium, and no work is missing. A path is found without tolerances, so that the error of a point
!> is round-off; more means that the arithmetic has failed.
module rbs_solve_static_path
   use rbs_base_check, only: is_given
   use rbs_base_error, only: error_type, fatal_error, analysis_failed
   use rbs_base_inner_product, only: total
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_base_text, only: to_text
   use rbs_base_tolerances, only: no_force
   use rbs_hysteresis_interaction_joints, only: fall_of
   use rbs_hysteresis_springs, only: spring_array
   use rbs_solve_task, only: task_type, many_unknowns
   use rbs_structure_channel, only: energy_type, response_type
   use rbs_structure_spring_location, only: spring_name, axial, flexure
   use rbs_structure_structure, only: structure_type, finite
   implicit none
   private

   public :: static_path, kept_rows, is_on_end, state_of, target_of, weakest_spring, on_the_end, &
             serialize_path

   !> A spring this close to an end of its line, relative to the end, is on it. Not a tolerance of the
   !> solution: where a cycle returns to its peak, round-off would otherwise decide between outer and inner
   !> unloading.
   real(wp), parameter :: on_the_end = 1.0e-11_wp

   !> Tolerances of a point: of the displacement, in shares of the sum over all springs; of equilibrium, in
   !> shares of the forces; of work, in shares of the works; each the largest so far. Where Newton's method
   !> follows a curve, and work is an integral over it, displacement and work have limits of their own.
   real(wp), parameter :: force_tolerance = 1.0e-9_wp, curve_work_tolerance = 1.0e-5_wp
   real(wp), parameter :: curve_displacement_tolerance = 1.0e-10_wp, leap_work_tolerance = 0.1_wp
   !> A displacement below this share of the height and a force below this share of the axial load have no
   !> digits to lose.
   real(wp), parameter :: no_digits = 1.0e-3_wp
   !> Growth of the displacement after which springs are measured again.
   real(wp), parameter :: growth = 1.1_wp
   !> Displacement, in shares of the height, and rotation by which stiff springs have forces and works.
   real(wp), parameter :: small_motion = 1.0e-6_wp
   !> A displacement below this share of the height is round-off.
   real(wp), parameter :: no_motion = 1.0e-12_wp
   !> Round-off of forces and works by the initial stiffness of the springs.
   real(wp), parameter :: digits = 1.0e-13_wp

   type :: row_check
      !> Tolerances of displacement and work
      real(wp) :: displacement = 1.0e-12_wp, work = 1.0e-9_wp
      !> Largest motion of all springs, force and work so far [m, N, J]; the work missing at the start
      real(wp) :: largest_displacement = 0.0_wp, largest_force = 0.0_wp, largest_work = 0.0_wp
      real(wp) :: at_begin = 0.0_wp
      !> Displacement up to which these have been measured [m]
      real(wp) :: farthest = 0.0_wp
      !> Force and work of the springs if they had their initial stiffness, the largest so far [N, J]
      real(wp) :: stiff_force = 0.0_wp, stiff_work = 0.0_wp
      !> Force at the top for a force of each spring: moments count by the height; those of axial springs not
      !> at all (springs)
      real(wp), allocatable :: share(:)
   end type row_check

   !> Displacement of the top by round-off alone, as a share of the contributions of all springs.
   real(wp), parameter :: same_displacement = 2.0e-13_wp

   !> The state of a path and its rates.
   type, abstract :: static_path
      !> The structure, and the one whose potential belongs to the balance of energy: where axial loads vary,
      !> under the constant ones alone
      class(structure_type), pointer :: structure => null(), without_top_load => null()
      type(spring_array) :: springs
      !> Number of springs that can move, the first ones
      integer :: moving = 0
      !> Whether the force is driven, else the displacement; whether the driven quantity is the share of the
      !> dead load of a frame
      logical :: by_force = .false., of_dead_load = .false.
      !> Displacement of the top [m], lateral force [N], work of the force [J]; the driven quantity, and its
      !> direction on the line found last: +1, -1, 0 for no line
      real(wp) :: displacement = 0.0_wp, force = 0.0_wp, work = 0.0_wp, control = 0.0_wp
      integer :: direction = 0
      !> Direction of its last motion
      integer :: last_direction = 0
      !> Change of the position per unit of the driven quantity, in its direction (coordinates)
      real(wp), allocatable :: rate(:)
      !> The same of the axial load at the top where it varies [N]
      real(wp) :: axial_rate = 0.0_wp
      !> Whether the path consists of straight lines, whose ends are monitored
      logical :: is_straight = .false.
      !> Whether rates were not found as the stiffnesses are too far apart for the arithmetic
      logical :: lost_digits = .false.
      !> Whether the path follows snap-backs, moves back at present, and is in search through a corner, where
      !> the inside of elements may snap back
      logical :: may_go_back = .false., goes_back = .false., passes = .false.
      !> Whether the structure is known to be stable on the lines of the rates found last while the
      !> displacement is held: then there is one way on
      logical :: is_stable = .false.
      !> Motions of springs to the ends of their lines, 0 for others; whether those lines were
      !> one way, and their stiffness; rates before the corner (springs)
      integer, allocatable :: arrived(:)
      logical, allocatable :: one_way(:)
      real(wp), allocatable :: k_in(:), rate_in(:)
      !> Number of snap-backs; the energy that the structure gave back in them while the displacement of a
      !> test would have been held, and the energy that it gained in others [J]
      integer :: snap_backs = 0
      real(wp) :: released = 0.0_wp, gained = 0.0_wp
      !> Energy of springs and axial load at the start, work of the axial load as far as it varies [J], and
      !> the steps that were cut
      real(wp) :: at_begin = 0.0_wp, load_work = 0.0_wp
      integer :: cuts = 0
      !> Axial load at the top without the part that follows the force [N], and energy damped before [J]
      real(wp) :: load_now = 0.0_wp, damped_before = 0.0_wp
      !> Driven quantity where the way to the present target begins, and the number of the target, from 0
      real(wp) :: control_begin = 0.0_wp
      !> Force [N] and displacement [m] where the path begins; the sign of the displacement that a positive
      !> force makes, 0 as long as it is not known
      real(wp), private :: first_point(2) = 0.0_wp, sense = 0.0_wp
      integer, private :: number = 0
      !> Tolerances of a state of the structure, and whether the present point violates them
      type(row_check), private :: check
      logical, private :: violates_balance = .false.
      !> The potential that was found last [J]. The row of a corner and its check ask for it at one position
      real(wp), private :: potential = 0.0_wp
      real(wp), allocatable, private :: position(:)
      !> Whether it was found last for the row of a corner
      logical, private :: knows_potential = .false.
      !> Rotations of the bodies, a work array (n)
      real(wp), allocatable, private :: rotation(:)
      !> Report on a corner between two targets: its summary, and its recorder if the row is to be kept
      type(task_type), pointer :: task => null()
   contains
      procedure :: prepare
      procedure :: compress
      procedure :: follow
      procedure :: arrive
      procedure :: check_point
      procedure :: record_corner
      procedure :: record_crossing
      procedure :: energies
      procedure :: loses_load
      procedure(serialize_interface), deferred :: serialize
      procedure(advance_interface), deferred :: advance
      procedure(solve_line_interface), deferred :: solve_line
      procedure(balance_interface), deferred :: find_balance
      procedure(unbalance_interface), deferred :: unbalance
      procedure :: reset_reference
   end type static_path

   abstract interface
      !> Go on to a target.
      subroutine advance_interface(self, target, error)
         import :: static_path, error_type, wp
         class(static_path), intent(inout) :: self
         !> Displacement [m] or force [N]
         real(wp), intent(in) :: target
         type(error_type), allocatable, intent(out) :: error
      end subroutine advance_interface

      !> Find the rates of the structure on the present lines of its springs.
      subroutine solve_line_interface(self, direction, found)
         import :: static_path
         class(static_path), intent(inout) :: self
         !> +1 or -1: in which the driven quantity moves
         integer, intent(in) :: direction
         !> Whether there are unique ones, under a driven force those of a stable structure
         logical, intent(out) :: found
      end subroutine solve_line_interface

      !> Corrections that take the springs, where they are and on their present lines, to equilibrium at the
      !> displacement of the top, or under the force.
      subroutine balance_interface(self, by_force, correction, force, found)
         import :: static_path, wp
         class(static_path), intent(inout) :: self
         !> Whether the lateral force is held, else the displacement of the top
         logical, intent(in) :: by_force
         !> Of the deformations (unknowns), and of the lateral force [N]
         real(wp), intent(out) :: correction(:), force
         !> Whether there are unique ones
         logical, intent(out) :: found
      end subroutine balance_interface

      !> The largest force by which a joint is out of equilibrium, moments over the height [N].
      real(wp) function unbalance_interface(self)
         import :: static_path, wp
         class(static_path), intent(inout) :: self
      end function unbalance_interface

      !> Save or restore all that the next target depends on, the springs excepted.
      subroutine serialize_interface(self, stream)
         import :: static_path, stream_type
         class(static_path), intent(inout) :: self
         type(stream_type), intent(inout) :: stream
      end subroutine serialize_interface
   end interface

contains

   !> Number of rows that are kept of m when every n-th, from the first on, and the last are.
   elemental integer function kept_rows(m, every)
      !> Rows in all; n, or `unset_integer` for all rows
      integer, intent(in) :: m, every

      kept_rows = 0
      if (.not. is_given(every)) then
         kept_rows = m
      else if (m > 0) then
         kept_rows = (m - 1)/every + 1 + merge(0, 1, mod(m - 1, every) == 0)
      end if
   end function kept_rows

   !> Make the springs of the structure, under its constant axial forces and not yet moved, and room for the
   !> path.
   subroutine prepare(self, by_force, moving)
      class(static_path), intent(inout) :: self
      !> Whether the force is driven, else the displacement
      logical, intent(in) :: by_force
      !> Number of springs that can move
      integer, intent(in) :: moving

      self%by_force = by_force
      self%moving = moving
      call self%structure%create_springs(self%springs, self%structure%constant_axial)
      allocate (self%rate(self%structure%coordinates), source=0.0_wp)
      allocate (self%arrived(self%springs%count), source=0)
      allocate (self%one_way(self%springs%count), source=.false.)
      allocate (self%k_in(self%springs%count), source=0.0_wp)
      allocate (self%rotation(self%structure%n))
   end subroutine prepare

   !> Take the present deformations of the springs as the point where the path begins: it is on no line yet.
   !> Curved paths have more to set, in a procedure of their own.
   subroutine reset_reference(self)
      class(static_path), intent(inout) :: self

      self%direction = 0
   end subroutine reset_reference

   !> Save or restore, whichever the stream is set to, the memory common to all paths; each kind of path adds
   !> its own.
   subroutine serialize_path(self, stream)
      class(static_path), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%items(self%displacement, self%force, self%work, self%control, self%load_now)
      call stream%item(self%direction)
      call stream%item(self%rate)
   end subroutine serialize_path

   !> The axial springs follow their lines to the forces of axial load and weight, tension positive. An error
   !> names the first spring that cannot reach its force.
   subroutine compress(self, error)
      class(static_path), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: tension
      logical :: found
      integer :: i

      do i = 1, self%springs%count
         if (self%structure%location(i)%kind /= axial) cycle
         tension = -self%structure%constant_axial(i)
         call self%springs%load_to(i, tension, found)
         if (found .or. abs(tension - self%springs%force(i)) <= no_force*abs(tension)) cycle
         call fatal_error(error, analysis_failed, trim(spring_name(self%structure%location(i)))//' (rule '// &
                          "'"//trim(self%springs%rules%name(self%springs%rules%of(i)))//"') cannot carry "// &
                          'the '//trim(merge('compression', 'tension    ', tension < 0.0_wp))//' of '// &
                          to_text(abs(tension))//' N from axial load and weight: it has no stiffness '// &
                          'left. Change axial_load, or give the joint a spring that holds')
         return
      end do
   end subroutine compress

   !> Follow the targets one after the other.
   subroutine follow(self, target, task, error)
      class(static_path), intent(inout) :: self
      !> Targets (m): lateral forces [N], or displacements of the top [m]
      real(wp), intent(in) :: target(:)
      type(task_type), intent(inout), target :: task
      !> On failure everything up to the last good state has been recorded
      type(error_type), allocatable, intent(out) :: error
      type(error_type), allocatable :: failure
      type(energy_type) :: energy
      logical :: may_collapse, falls, ends
      integer :: i, every, crushed_joint

      every = task%every
      if (.not. is_given(every)) every = 1
      may_collapse = is_given(task%collapse_drift)
      self%task => task
      energy = self%energies()
      call begin_check(self%check, self%structure, self%springs, energy%residual)
      if (task%leaps) self%check%work = leap_work_tolerance
      ! A continued path has forces and works from before, with their round-off: this check is for the scales
      ! that it finds, and its verdict is dropped.
      call self%check_point(self%control, self%unbalance(), .false., failure)
      if (allocated(failure)) deallocate (failure)
      self%violates_balance = .false.
      do i = 1, size(target)
         self%number = i - 1
         self%control_begin = self%control
         if (i == 1) self%first_point = [self%force, self%displacement]
         ! A path whose first target is not where it begins has a way to it.
         if (i == 1 .and. abs(target(1) - self%control) > 0.0_wp) call self%record_corner(0.0_wp)
         call self%advance(target(i), failure)
         if (task%summary%stopped) then
            task%summary%remark = 'the path was stopped on the way to row '//to_text(i)// &
                                  ' (max_seconds, or from outside)'
            return
         end if
         crushed_joint = self%springs%crushed_joint()
         if (crushed_joint > 0) then
            task%summary%lost_joint = self%structure%location(crushed_joint)%index
            call fall_of(self%springs, crushed_joint, task%summary%fall)
         end if
         falls = crushed_joint > 0 .or. task%summary%fallen_member > 0
         if (falls) then
            ! This ends the path.
            if (allocated(failure)) deallocate (failure)
         else if (.not. allocated(failure)) then
            call snap_to_ends(self)
            call check_members(self, failure)
         end if
         if (may_collapse) then
            task%summary%collapsed = self%structure%largest_drift(self%springs%d) >= task%collapse_drift
         end if
         ends = i == size(target) .or. falls .or. task%summary%collapsed .or. allocated(failure)
         if (falls .or. allocated(failure)) then
            if (.not. self%violates_balance) then
               call update_rotation(self)
               call task%summary%update_energies(self%energies())
            end if
         else if (ends .or. .not. self%is_straight) then
            call self%check_point(target(i), self%unbalance(), self%by_force .and. self%direction == 0, &
                                  failure)
         end if
         if (allocated(failure)) failure%message = 'row '//to_text(i)//': '//failure%message
         ! A point that is no state of the structure is no row.
         if (.not. self%violates_balance) then
            call update_peak(self)
            if (ends .or. mod(i - 1, every) == 0) then
               task%summary%rows = task%summary%rows + 1
               task%summary%last_time = i - 1
               call keep_row(self, real(i - 1, wp), error)
               if (allocated(error)) return
            end if
            task%summary%steps = i
            task%summary%events = self%springs%events
            task%summary%cut_steps = self%cuts
            task%summary%snap_backs = self%snap_backs
            task%summary%released = self%released
            if (self%gained > 0.0_wp) task%summary%remark = 'the path leads over snap-backs to states '// &
               'that hold '//to_text(self%gained)//' J more than those before them at the same '// &
               'displacement: a test does not go there by itself; a response in time takes another way'
         end if
         if (allocated(failure)) call move_alloc(failure, error)
         if (allocated(error) .or. ends) return
         ! The way between two points of a frame is long.
         if (associated(task%progress)) then
            if (mod(i, 1024) == 0 .or. self%structure%unknowns >= many_unknowns) then
               call task%progress%update(real(i, wp)/size(target))
            end if
         end if
      end do
   end subroutine follow

   !> Whether a joint of layers has lost its axial load, or a member has fallen.
   pure logical function loses_load(self)
      class(static_path), intent(in) :: self

      loses_load = self%springs%crushed_joint() > 0 .or. self%task%summary%fallen_member > 0
   end function loses_load

   !> A path ends with an error where a member loses its axial load, since a fall follows.
   subroutine check_members(self, failure)
      class(static_path), intent(in) :: self
      type(error_type), allocatable, intent(inout) :: failure
      integer :: member

      member = self%structure%next_failed_member(self%springs)
      if (member == 0) return
      associate (location => self%structure%location)
         call fatal_error(failure, analysis_failed, 'member '// &
                          trim(location(findloc(location%member, member, dim=1))%owner)//' has failed in '// &
                          'shear and loses its axial load here (failure_drift), '//trim(state_of(self))// &
                          '. Nothing static follows: use a response in time, in which the others take '// &
                          'the load, or the frame without the member')
      end associate
   end subroutine check_members

   !> Where a straight line ends, at a row of a curve, and at the end of the path: energies and rotations
   !> belong to the summary, and the point must be a state of the structure. On a straight line forces and
   !> rotations are linear and energies quadratic, so that nothing is larger between its ends.
   subroutine check_point(self, target, unbalance, on_ends, failure)
      class(static_path), intent(inout) :: self
      !> Target that the path is on the way to [m or N], and the largest force out of equilibrium [N]
      real(wp), intent(in) :: target, unbalance
      !> Whether springs were put on ends of their lines since the displacement was found
      logical, intent(in) :: on_ends
      type(error_type), allocatable, intent(inout) :: failure
      character(len=:), allocatable :: fault
      type(energy_type) :: energy
      real(wp) :: top, displacement_error, residual, tolerance, reach, works

      energy = self%energies()
      call update_rotation(self)
      call self%task%summary%update_energies(energy)
      top = self%structure%top_displacement(self%springs%d)
      displacement_error = abs(top - self%displacement)
      residual = energy%residual - self%check%at_begin
      tolerance = self%check%displacement + merge(2.0_wp*on_the_end, 0.0_wp, on_ends)
      associate (check => self%check, springs => self%springs)
         check%largest_force = max(check%largest_force, abs(self%force))
         check%largest_work = max(check%largest_work, abs(energy%input), abs(energy%spring), &
                                  abs(energy%axial))
         ! Springs are measured only where their scales may have grown by a share, or would decide.
         if (abs(self%displacement) > growth*check%farthest .or. balance_fault() > 0) then
            check%farthest = max(check%farthest, abs(self%displacement))
            call measure_springs(springs%count, self%structure%initial_stiffness, check%share, springs%d, &
                                 springs%d0, springs%f0, springs%k, check%largest_force, &
                                 check%stiff_force, works)
            reach = sum(abs(self%structure%arm*springs%d))
            ! Parts without springs cost more: they are asked if the scales so far do not suffice.
            if (balance_fault() > 0) call update_parts(check, self%structure, springs)
            check%largest_displacement = max(check%largest_displacement, reach)
            check%stiff_work = max(check%stiff_work, works)
         end if
      end associate
      select case (balance_fault())
      case (0)
         return
      case (1)
         fault = 'its joints move the top by '//to_text(top)//' m'
      case (2)
         fault = to_text(unbalance)//' N of its forces are out of balance'
      case default
         fault = to_text(residual)//' J of its work are missing'
      end select
      self%violates_balance = .true.
      call fatal_error(failure, analysis_failed, 'on the way to '//trim(target_of(self, target))// &
                       ' the arithmetic has lost the static path: at a displacement of '// &
                       to_text(self%displacement)//' m '//fault//'. The path up to there is kept. The '// &
                       'stiffnesses of the springs are too far apart ('//trim(weakest_spring(self))// &
                       ' has the least left): give it more stiffness after yield, or take stiff springs '// &
                       'less stiff')

   contains

      !> The balance that is violated by more than round-off: displacement, forces, work; 0: none.
      pure integer function balance_fault()
         balance_fault = 0
         if (displacement_error > tolerance*self%check%largest_displacement) then
            balance_fault = 1
         else if (unbalance > force_tolerance*self%check%largest_force + digits*self%check%stiff_force) then
            balance_fault = 2
         else if (abs(residual) > self%check%work*self%check%largest_work + digits*self%check%stiff_work) then
            balance_fault = 3
         end if
      end function balance_fault

   end subroutine check_point

   !> Scales of round-off by the springs: their largest force so far, the largest force and the sum of works
   !> if they had their initial stiffness.
   pure subroutine measure_springs(n, initial, share, d, d0, f0, k, force, stiff_force, works)
      integer, intent(in) :: n
      !> Initial stiffness; force at the top per force of the spring, 0 for axial springs; deformation; line
      !> through (d0, f0) with slope k (springs)
      real(wp), intent(in) :: initial(n), share(n), d(n), d0(n), f0(n), k(n)
      !> Sum of the works of initial stiffness on the deformations, each twice its energy [J]
      real(wp), intent(out) :: works
      !> Largest forces at the top, which grow [N]
      real(wp), intent(inout) :: force, stiff_force
      real(wp) :: term
      integer :: i

      works = 0.0_wp
      !$omp simd reduction(+:works) reduction(max:force, stiff_force) private(term)
      do i = 1, n
         term = initial(i)*abs(d(i))
         force = max(force, abs(f0(i) + k(i)*(d(i) - d0(i)))*share(i))
         stiff_force = max(stiff_force, term*share(i))
         works = works + merge(term*abs(d(i)), 0.0_wp, share(i) > 0.0_wp)
      end do
   end subroutine measure_springs

   !> The path is at a corner: its figures belong to the summary, and its row to recorders that keep every
   !> corner.
   subroutine record_corner(self, share)
      class(static_path), intent(inout) :: self
      !> Share of the way to the present target that is behind, 0 to 1
      real(wp), intent(in) :: share
      type(error_type), allocatable :: error

      call update_peak(self)
      if (self%task%recorder%corners) then
         call keep_row(self, self%number - 1 + share, error)
         self%position = self%springs%d
         self%knows_potential = .true.
      end if
   end subroutine record_corner

   !> Straight line from the present point to another one. Where it passes zero displacement, the
   !> force in the direction of loading begins or ends, and may be the largest.
   subroutine record_crossing(self, displacement, force)
      class(static_path), intent(inout) :: self
      !> Displacement of the top [m] and lateral force [N] at the other point
      real(wp), intent(in) :: displacement, force

      if (.not. displacement*self%displacement < 0.0_wp) return
      call self%task%summary%update_peak(0.0_wp, (self%force*displacement - force*self%displacement)/ &
                                              (displacement - self%displacement))
   end subroutine record_crossing

   !> Report the present rotations of the bodies to the summary, which keeps the largest in size.
   subroutine update_rotation(self)
      class(static_path), intent(inout) :: self

      call self%structure%rotations(self%springs%d, self%rotation)
      associate (summary => self%task%summary)
         summary%peak_rotation = max(summary%peak_rotation, maxval(abs(self%rotation)))
      end associate
   end subroutine update_rotation

   !> Report the present force and displacement to the summary, which keeps the peaks.
   subroutine update_peak(self)
      class(static_path), intent(inout) :: self

      ! Pushed downward, a positive load goes with a negative displacement.
      ! Within round-off of where it begins a path has no side yet.
      if (.not. abs(self%sense) > 0.0_wp .and. abs(self%displacement - self%first_point(2)) > &
          no_motion*self%structure%height) then
         self%sense = (self%force - self%first_point(1))*(self%displacement - self%first_point(2))
         if (abs(self%sense) > 0.0_wp) self%sense = sign(1.0_wp, self%sense)
      end if
      ! A force that pulls the structure back, as where second-order moments drive it on, is no strength.
      call self%task%summary%update_peak(self%displacement, merge(self%force, 0.0_wp, &
                                                     self%sense*self%force*self%displacement >= 0.0_wp))
   end subroutine update_peak

   !> Keep the row of the present point.
   subroutine keep_row(self, number, error)
      class(static_path), intent(inout) :: self
      !> Number of the row; between two targets with the share of the way as its fraction
      real(wp), intent(in) :: number
      type(error_type), allocatable, intent(inout) :: error
      type(response_type) :: response

      response%time = number
      response%displacement = self%displacement
      response%force = self%force
      response%energy = self%energies()
      call self%task%recorder%keep(self%structure, response, self%springs, self%springs%d, error)
   end subroutine keep_row

   !> Whether a spring has reached the end that it moves to. An end that belongs to its line holds nothing up,
   !> since the spring is still on the line there: it counts only where a way is given.
   pure logical function is_on_end(springs, i, d, rate, way)
      type(spring_array), intent(in) :: springs
      integer, intent(in) :: i
      !> Deformation [m or rad], and its rate, of which only the sign counts without a way
      real(wp), intent(in) :: d, rate
      !> Way by which it may be before the end, in units of the rate
      real(wp), intent(in), optional :: way
      real(wp) :: finish, slack
      logical :: open_only

      is_on_end = .false.
      slack = 0.0_wp
      if (present(way)) slack = way*abs(rate)
      open_only = .not. present(way)
      ! Most springs are far from their ends, which need not be computed then.
      if (rate > 0.0_wp .and. .not. (open_only .and. springs%includes_upper_end(i))) then
         if (springs%upper(i) - d > 2.0_wp*on_the_end*abs(springs%upper(i)) + slack) return
         finish = springs%end_toward(i, 1)
         is_on_end = finish - d <= on_the_end*abs(finish) + slack
      else if (rate < 0.0_wp .and. .not. (open_only .and. springs%includes_lower_end(i))) then
         if (d - springs%lower(i) > 2.0_wp*on_the_end*abs(springs%lower(i)) + slack) return
         finish = springs%end_toward(i, -1)
         is_on_end = d - finish <= on_the_end*abs(finish) + slack
      end if
   end function is_on_end

   !> A spring that was put exactly on the end of its line has moved the top by a last digit: the displacement
   !> that is driven becomes that at which the top is, and the work on the way is added.
   subroutine snap_to_ends(self)
      class(static_path), intent(inout) :: self
      real(wp) :: top, reach

      ! While the path is on a line no spring was put on an end.
      if (self%by_force .or. self%direction /= 0 .or. self%structure%kinematics == finite) return
      top = self%structure%top_displacement(self%springs%d)
      reach = sum(abs(self%structure%arm*self%springs%d))
      if (abs(top - self%displacement) <= same_displacement*reach .or. &
          abs(top - self%displacement) > 2.0_wp*on_the_end*reach) return
      self%work = self%work + self%force*(top - self%displacement)
      self%displacement = top
      self%control = top
   end subroutine snap_to_ends

   !> The energies at the present point, and the residual of their balance.
   type(energy_type) function energies(self) result(energy)
      class(static_path), intent(inout) :: self

      if (self%knows_potential) self%knows_potential = all(abs(self%springs%d - self%position) <= 0.0_wp)
      if (.not. self%knows_potential) then
         self%potential = self%without_top_load%potential_energy(self%springs%d)
      end if
      self%knows_potential = .false.
      energy%input = self%work
      energy%spring = total(self%springs%count, self%springs%work)
      energy%damping = self%damped_before
      energy%axial = self%potential + self%load_work
      energy%residual = self%work + self%at_begin - energy%spring - energy%damping - energy%axial
   end function energies

   !> Put a spring on the end of its line that it moves to.
   subroutine arrive(self, i, rate)
      class(static_path), intent(inout) :: self
      integer, intent(in) :: i
      !> Rate of the spring, of which only the sign counts
      real(wp), intent(in) :: rate

      self%arrived(i) = merge(1, -1, rate > 0.0_wp)
      self%one_way(i) = self%springs%unload_on_reversal(i) /= 0
      self%k_in(i) = self%springs%k(i)
      call self%springs%arrive(i, self%arrived(i))
      self%direction = 0
   end subroutine arrive

   !> Where the path is, for a message. Under a growing dead load the driven force is a share of it.
   pure character(len=80) function state_of(path) result(text)
      class(static_path), intent(in) :: path

      if (path%of_dead_load) then
         text = 'a share '//to_text(path%force)//' of the dead load'
      else
         text = 'force '//to_text(path%force)//' N, displacement '//to_text(path%displacement)//' m'
      end if
   end function state_of

   !> A target with its unit, for a message: a force, a displacement of the top, or a share of the dead load.
   pure character(len=40) function target_of(path, target) result(text)
      class(static_path), intent(in) :: path
      real(wp), intent(in) :: target

      if (path%of_dead_load) then
         text = to_text(target)//' of the dead load'
      else
         text = to_text(target)//merge(' N', ' m', path%by_force)
      end if
   end function target_of

   !> The spring that has least of its initial stiffness left, for a message; springs that yield before those
   !> that nothing has happened to.
   pure character(len=80) function weakest_spring(path) result(text)
      class(static_path), intent(in) :: path
      !> Shares of the initial stiffnesses that are left
      real(wp) :: left(path%moving)

      associate (structure => path%structure, m => path%moving)
         left = path%springs%k(:m)/structure%initial_stiffness(:m)
         text = 'its elastic stiffness'
         if (minval(left) < 1.0_wp) text = spring_name(structure%location(minloc(left, dim=1)))
      end associate
   end function weakest_spring

   !> Begin to measure points: tolerances, and the smallest scales that they are shares of.
   subroutine begin_check(self, structure, springs, missing_work)
      type(row_check), intent(out) :: self
      class(structure_type), intent(in) :: structure
      type(spring_array), intent(in) :: springs
      !> Residual of the energies at the start, which is no fault of the path [J]
      real(wp), intent(in) :: missing_work
      real(wp) :: d
      integer :: i

      self%at_begin = missing_work
      self%largest_displacement = no_digits*structure%total_height
      self%largest_force = no_digits*maxval(abs(structure%constant_axial))
      allocate (self%share(size(structure%location)))
      do i = 1, size(self%share)
         self%share(i) = merge(1.0_wp/structure%total_height, 1.0_wp, structure%location(i)%kind == flexure)
         if (structure%location(i)%kind == axial) self%share(i) = 0.0_wp
         d = small_motion*structure%total_height*self%share(i)
         self%stiff_force = max(self%stiff_force, structure%initial_stiffness(i)*d*self%share(i))
         self%stiff_work = self%stiff_work + structure%initial_stiffness(i)*d**2
      end do
      call update_parts(self, structure, springs)
      ! Newton's method on a curve leaves more than round-off.
      if (structure%kinematics /= finite) return
      self%displacement = curve_displacement_tolerance
      self%work = curve_work_tolerance
   end subroutine begin_check

   !> Enlarge the scales of force and work by those of parts without springs.
   subroutine update_parts(self, structure, springs)
      type(row_check), intent(inout) :: self
      class(structure_type), intent(in) :: structure
      type(spring_array), intent(in) :: springs
      real(wp) :: force, terms, work

      call structure%size_of_parts(springs, springs%d, small_motion, force, terms, work)
      self%largest_force = max(self%largest_force, force)
      self%stiff_force = max(self%stiff_force, terms)
      self%stiff_work = max(self%stiff_work, work)
   end subroutine update_parts

end module rbs_solve_static_path
