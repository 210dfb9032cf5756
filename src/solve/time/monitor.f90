!> Peaks of the response, collapse and limit states of a run: at the end of every step, and within the steps
!> of methods that resolve it. They do not depend on which rows are kept.
module rbs_solve_time_monitor
   use rbs_base_check, only: is_given
   use rbs_base_cubic, only: beyond_ends, bound_of, cubic_at, first_at, largest_of
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_interaction_joints, only: opening_of, rest_of
   use rbs_hysteresis_springs, only: spring_array
   use rbs_loading_loads, only: lateral, horizontal, signals
   use rbs_output_summary, only: peaks_type
   use rbs_solve_time_motion, only: equation_of_motion, motion_result
   use rbs_structure_spring_location, only: shear, flexure, layer
   implicit none
   private

   public :: response_monitor, watch_type

   !> A limit state is reached where a sum of a joint's deformations is at a threshold or beyond it.
   type :: watch_type
      !> Number of the limit state, 1 for first yield, and joint
      integer :: state = 1, joint = 1
      !> Factors of slip, of rotation and of opening; where there is one of the opening, rotations count with
      !> those at rest
      real(wp) :: slip = 0.0_wp, rotation = 0.0_wp, opening = 0.0_wp, threshold = huge(1.0_wp)
      !> The springs of the joint that slip and rotate, which `begin` finds; of a joint of layers in a frame
      !> the next layer and the layer
      integer :: slips = 0, turns = 0
   end type watch_type

   type, extends(peaks_type) :: response_monitor
      !> Displacement of the top [m] or drift of a storey at which the structure has collapsed, and whether it
      !> has
      real(wp) :: furthest = huge(1.0_wp), furthest_storey = huge(1.0_wp)
      logical :: collapsed = .false.
      !> Watches of limit states, and the time at which each is first reached; `huge` before (states) [s]
      type(watch_type), allocatable :: watch(:)
      real(wp), allocatable :: reached(:)
      !> Displacement of the top then (states) [m]
      real(wp), allocatable :: top(:)
      !> Whether anything is still watched for
      logical :: watching = .false.
      !> Deformations between which no limit state is reached for the first time (springs)
      real(wp), allocatable :: lowest(:), highest(:)
      !> State at the last check: clock [s], displacement of the top [m], deformations (springs), shares of
      !> openings in the watches (watches)
      real(wp) :: clock = 0.0_wp, displacement = 0.0_wp
      real(wp), allocatable :: q(:), openings(:)
      !> Whether openings, or two deformations at once, are still watched
      logical, private :: opens = .false.
      !> Absolute rotations of the bodies at both ends of a step, and their rates (n, 4)
      real(wp), allocatable, private :: rotation(:, :)
      !> Whether the acceleration of the top is monitored, and the equation of motion for it
      logical :: monitors_top = .false.
      type(motion_result), private :: now
   contains
      procedure :: watch_for, begin, update, update_within_step, check_limits
   end type response_monitor

contains

   !> Set the limit states to watch for; to be called before `begin`.
   pure subroutine watch_for(self, watch, states)
      class(response_monitor), intent(inout) :: self
      type(watch_type), intent(in) :: watch(:)
      !> Number of limit states
      integer, intent(in) :: states

      self%watch = watch
      self%reached = spread(huge(1.0_wp), 1, states)
      self%top = spread(0.0_wp, 1, states)
   end subroutine watch_for

   !> Begin to monitor a run: find the springs of the watches, forget the peaks before, and look at the state
   !> at the start.
   subroutine begin(self, motion, springs, q, v, load, clock, collapse_drift, floor)
      class(response_monitor), intent(inout) :: self
      type(equation_of_motion), intent(in) :: motion
      type(spring_array), intent(in) :: springs
      !> At the start: deformations and velocities (springs), loads, time of the clock [s]
      real(wp), intent(in), contiguous :: q(:), v(:)
      real(wp), intent(in) :: load(signals), clock
      !> Drift at which the structure has collapsed, of a storey or of the top; `unset`: none
      real(wp), intent(in) :: collapse_drift
      !> Whether the acceleration of the top is monitored
      logical, intent(in) :: floor
      integer, allocatable :: slips(:), turns(:), layers(:)
      integer :: i, m

      if (is_given(collapse_drift)) then
         if (motion%structure%by_storeys) then
            self%furthest_storey = collapse_drift
         else
            self%furthest = collapse_drift*motion%structure%height
         end if
      end if
      if (.not. allocated(self%watch)) call self%watch_for([watch_type ::], 0)
      m = size(q)
      if (.not. allocated(self%lowest)) then
         allocate (self%lowest(m), self%highest(m), self%openings(size(self%watch)), &
                   self%rotation(motion%structure%n, 4), source=0.0_wp)
      end if
      associate (kind => motion%structure%location%kind)
         slips = pack([(i, i=1, size(kind))], kind == shear)
         turns = pack([(i, i=1, size(kind))], kind == flexure)
         layers = pack([(i, i=1, size(kind))], kind == layer)
      end associate
      do i = 1, size(self%watch)
         associate (watch => self%watch(i), behind => self%watch(i)%joint - size(turns))
            watch%slips = numbered(slips, watch%joint)
            watch%turns = numbered(turns, watch%joint)
            ! Behind the flexural springs come layers of joints, of which two give the strains of a section.
            if (behind > 0) then
               watch%turns = numbered(layers, behind)
               watch%slips = numbered(layers, behind + 1)
            end if
         end associate
      end do
      self%peaks_type = peaks_type()
      self%collapsed = .false.
      call set_bounds(self)
      if (motion%structure%storeys > 0) then
         allocate (self%storey_drift(motion%structure%storeys), &
                   self%peak_storey_drift(motion%structure%storeys), source=0.0_wp)
      end if
      self%monitors_top = floor
      if (floor) call self%now%create(motion%structure)
      self%q = q
      self%clock = clock
      self%displacement = motion%structure%top_displacement(q)
      call update_openings(self, springs, q)
      call self%update(motion, springs, q, v, load, clock)
   end subroutine begin

   !> The spring in a place of a list; any spring where the list is shorter, since a kind of spring that the
   !> structure does not have has the factor 0 in a watch.
   pure integer function numbered(springs, number) result(spring)
      integer, intent(in) :: springs(:), number

      spring = 1
      if (number <= size(springs)) spring = springs(number)
   end function numbered

   !> Look at the state at the end of a step: displacement, base shear, drifts, and the limit states that are
   !> still watched for.
   subroutine update(self, motion, springs, q, v, load, clock)
      class(response_monitor), intent(inout) :: self
      type(equation_of_motion), intent(in) :: motion
      type(spring_array), intent(in) :: springs
      !> Deformations and velocities (springs), loads
      real(wp), intent(in), contiguous :: q(:), v(:)
      real(wp), intent(in) :: load(signals)
      !> Time of the clock [s]
      real(wp), intent(in) :: clock
      real(wp) :: displacement, rotation, shear
      integer :: i

      if (associated(motion%one_body)) then
         ! A column of one body: its steps are short, nothing is called that need not be.
         displacement = q(1) + motion%one_body%length(1)*q(2)
         rotation = abs(q(2))
      else
         displacement = motion%structure%top_displacement(q)
         rotation = motion%structure%largest_rotation(q)
      end if
      ! A frame has no one spring whose force is the base shear, and no spring has it alone with damping.
      i = motion%base_spring
      if (i > 0) then
         shear = springs%f0(i) + springs%k(i)*(q(i) - springs%d0(i))
      else
         shear = motion%base_shear(springs, q, v)
         if (allocated(self%storey_drift)) then
            call motion%structure%storey_drifts(q, self%storey_drift)
            self%peak_storey_drift = max(self%peak_storey_drift, abs(self%storey_drift))
            self%collapsed = self%collapsed .or. any(self%peak_storey_drift >= self%furthest_storey)
         end if
      end if
      if (abs(displacement) > abs(self%peak_displacement) .or. abs(load(lateral)) > abs(self%peak_force)) then
         call self%update_peak(displacement, load(lateral))
         self%collapsed = self%collapsed .or. abs(self%peak_displacement) >= self%furthest
      end if
      if (rotation > self%peak_rotation) self%peak_rotation = rotation
      if (abs(shear) > abs(self%peak_base_shear)) call self%update_base_shear(shear)
      if (self%monitors_top) then
         call motion%acceleration(springs, q, v, load, self%now)
         self%peak_floor_acceleration = max(self%peak_floor_acceleration, &
            abs(motion%structure%top_acceleration(q, v, self%now%a) + load(horizontal)))
      end if
      if (.not. self%watching) return
      ! One body between its bounds, which is the most frequent case.
      if (size(q) == 2 .and. .not. self%opens) then
         if (q(1) < self%highest(1) .and. q(1) > self%lowest(1) .and. &
             q(2) < self%highest(2) .and. q(2) > self%lowest(2)) then
            self%clock = clock
            self%displacement = displacement
            self%q(1) = q(1)
            self%q(2) = q(2)
            return
         end if
      end if
      call self%check_limits(springs, q, displacement, clock)
   end subroutine update

   !> Check the limit states at the end of a step, in which deformations are taken as linear in time since the
   !> last check.
   subroutine check_limits(self, springs, q, displacement, clock)
      class(response_monitor), intent(inout) :: self
      type(spring_array), intent(in) :: springs
      !> Deformations (springs)
      real(wp), intent(in), contiguous :: q(:)
      !> Displacement of the top [m], time of the clock [s]
      real(wp), intent(in) :: displacement, clock

      if (self%opens .or. are_beyond(size(q), self%lowest, self%highest, q, q, q, q, 0.0_wp)) then
         call check_limit_states(self, springs, q, displacement, clock)
      end if
      self%clock = clock
      self%displacement = displacement
      self%q(:) = q
      if (self%opens) call update_openings(self, springs, q)
   end subroutine check_limits

   !> Look whether limit states have been reached since the last check, and when, by linear interpolation
   !> between both states.
   subroutine check_limit_states(self, springs, q, displacement, clock)
      type(response_monitor), intent(inout) :: self
      type(spring_array), intent(in) :: springs
      !> Deformations (springs), displacement of the top [m], time of the clock [s]
      real(wp), intent(in) :: q(:), displacement, clock
      real(wp) :: share, before, after, at
      logical :: open(size(self%reached))
      integer :: i

      ! Open before the step: several watches may reach one limit state in it, and the first counts.
      open = .not. self%reached < huge(1.0_wp)
      do i = 1, size(self%watch)
         if (.not. open(self%watch(i)%state)) cycle
         associate (watch => self%watch(i))
            after = value_of(watch, q(watch%slips), q(watch%turns), &
                             opening_share(watch, springs, q(watch%turns)))
            if (.not. after >= watch%threshold) cycle
            before = value_of(watch, self%q(watch%slips), self%q(watch%turns), self%openings(i))
         end associate
         share = 1.0_wp
         if (after > before) share = (self%watch(i)%threshold - before)/(after - before)
         at = self%clock + share*(clock - self%clock)
         call reach(self, i, at, self%displacement + share*(displacement - self%displacement))
      end do
      call set_bounds(self)
   end subroutine check_limit_states

   !> Look at the response within a step, from a state that has been checked, with springs on their lines;
   !> between its ends deformations are cubics in time.
   subroutine update_within_step(self, motion, springs, q0, v0, q1, v1, h, clock)
      class(response_monitor), intent(inout) :: self
      type(equation_of_motion), intent(in) :: motion
      !> On the lines of the step
      type(spring_array), intent(in) :: springs
      !> Deformations and velocities at its start and its end (springs)
      real(wp), intent(in), contiguous :: q0(:), v0(:), q1(:), v1(:)
      !> Its length, and the clock at its end [s]
      real(wp), intent(in) :: h, clock
      real(wp) :: top(4), base(4), rotation(4), spring(3)
      integer :: i

      ! Steps up to an event may have no length.
      if (.not. h > tiny(1.0_wp)) return
      associate (structure => motion%structure)
         top = [structure%top_displacement(q0), structure%top_displacement(q1), &
                h*structure%speed(lateral, q0, v0), h*structure%speed(lateral, q1, v1)]
         if (bound_of(top) > abs(self%peak_displacement)) then
            call self%update_peak(largest_of(top), 0.0_wp)
            self%collapsed = self%collapsed .or. abs(self%peak_displacement) >= self%furthest
         end if
         ! The force of the lowest springs is a cubic; that of damping is taken as linear.
         i = structure%base_spring
         spring = springs%k(i)*[q1(i) - q0(i), h*v0(i), h*v1(i)]
         base(:2) = [motion%base_shear(springs, q0, v0), motion%base_shear(springs, q1, v1)]
         base(3:) = spring(2:) + (base(2) - base(1) - spring(1))
         if (bound_of(base) > abs(self%peak_base_shear)) call self%update_base_shear(largest_of(base))
         call structure%rotations(q0, self%rotation(:, 1))
         call structure%rotations(q1, self%rotation(:, 2))
         call structure%rotations(v0, self%rotation(:, 3))
         call structure%rotations(v1, self%rotation(:, 4))
         do i = 1, structure%n
            rotation = [self%rotation(i, :2), h*self%rotation(i, 3:)]
            if (.not. bound_of(rotation) > self%peak_rotation) cycle
            self%peak_rotation = max(self%peak_rotation, abs(largest_of(rotation)))
         end do
      end associate
      if (self%watching) call check_within(self, springs, q0, v0, q1, v1, top, h, clock)
   end subroutine update_within_step

   !> Look whether limit states have been reached within a step, and when.
   subroutine check_within(self, springs, q0, v0, q1, v1, top, h, clock)
      type(response_monitor), intent(inout) :: self
      type(spring_array), intent(in) :: springs
      !> Deformations and velocities at the start and the end of the step (springs); displacement of the top
      !> as a cubic; length of the step, and time of the clock at its end [s]
      real(wp), intent(in), contiguous :: q0(:), v0(:), q1(:), v1(:)
      real(wp), intent(in) :: top(4), h, clock
      real(wp) :: value(4), share
      logical :: open(size(self%reached))
      integer :: i

      self%clock = clock
      self%displacement = top(2)
      self%q(:) = q1
      if (.not. self%opens) then
         if (.not. are_beyond(size(q0), self%lowest, self%highest, q0, v0, q1, v1, h*beyond_ends)) return
      end if
      ! Open before the step: several watches may reach one limit state in it, and the first counts.
      open = .not. self%reached < huge(1.0_wp)
      do i = 1, size(self%watch)
         if (.not. open(self%watch(i)%state)) cycle
         ! Values at both ends of the step and their rates per step, of a cubic.
         value(:2) = [value_at(q0, v0, 0.0_wp), value_at(q1, v1, 0.0_wp)]
         value(3:) = [value_at(q0, v0, h) - value(1), value_at(q1, v1, h) - value(2)]
         share = first_at(value, self%watch(i)%threshold)
         if (share <= 1.0_wp) call reach(self, i, clock - (1.0_wp - share)*h, &
                                         cubic_at(share, top(1), top(2), top(3), top(4)))
      end do
      call set_bounds(self)
      if (self%opens) call update_openings(self, springs, q1)

   contains

      !> Value of the watch, as if the deformations went on at their velocities for a time: the value is
      !> linear in them, so that differences are rates.
      pure real(wp) function value_at(q, v, later)
         !> Deformations, velocities, and the time [s]
         real(wp), intent(in) :: q(:), v(:), later

         associate (watch => self%watch(i))
            associate (rotation => q(watch%turns) + later*v(watch%turns))
               value_at = value_of(watch, q(watch%slips) + later*v(watch%slips), rotation, &
                                   opening_share(watch, springs, rotation))
            end associate
         end associate
      end function value_at

   end subroutine check_within

   !> Keep the shares that openings of joints have in the limit states, for the next check.
   pure subroutine update_openings(self, springs, q)
      type(response_monitor), intent(inout) :: self
      type(spring_array), intent(in) :: springs
      !> Deformations (springs)
      real(wp), intent(in) :: q(:)
      integer :: i

      do i = 1, size(self%watch)
         self%openings(i) = opening_share(self%watch(i), springs, q(self%watch(i)%turns))
      end do
   end subroutine update_openings

   !> Share that the opening, and the rotation at rest, have in the value of a watch.
   pure real(wp) function opening_share(watch, springs, rotation) result(share)
      type(watch_type), intent(in) :: watch
      type(spring_array), intent(in) :: springs
      !> Rotation of the joint [rad]
      real(wp), intent(in) :: rotation

      share = 0.0_wp
      if (abs(watch%opening) > 0.0_wp) share = watch%opening*opening_of(springs, watch%turns, rotation) &
                                               + watch%rotation*rest_of(springs, watch%turns)
   end function opening_share

   !> Whether some deformation may be at a bound within a step, by bounds of the cubics.
   pure logical function are_beyond(m, lowest, highest, q0, v0, q1, v1, reach)
      integer, intent(in) :: m
      !> Bounds; deformations and velocities at the start and the end of the step
      real(wp), intent(in) :: lowest(m), highest(m), q0(m), v0(m), q1(m), v1(m)
      !> Excess of a cubic over its ends, for the sum of both velocities there [s]
      real(wp), intent(in) :: reach
      real(wp) :: clearance, more
      integer :: i

      clearance = huge(1.0_wp)
      !$omp simd reduction(min:clearance) private(more)
      do i = 1, m
         more = reach*(abs(v0(i)) + abs(v1(i)))
         clearance = min(clearance, highest(i) - (max(q0(i), q1(i)) + more), &
                         (min(q0(i), q1(i)) - more) - lowest(i))
      end do
      are_beyond = .not. clearance > 0.0_wp
   end function are_beyond

   !> Value of a watch, which is compared with its threshold.
   pure real(wp) function value_of(watch, slip, rotation, opening) result(value)
      type(watch_type), intent(in) :: watch
      !> Deformations of its joint, and the share of the opening
      real(wp), intent(in) :: slip, rotation, opening

      value = watch%slip*slip + watch%rotation*rotation + opening
   end function value_of

   !> A limit state is reached by one of its watches: the earliest time counts.
   pure subroutine reach(self, i, at, top)
      type(response_monitor), intent(inout) :: self
      !> Place of the watch
      integer, intent(in) :: i
      !> When [s], and displacement of the top [m]
      real(wp), intent(in) :: at, top

      if (at >= self%reached(self%watch(i)%state)) return
      self%reached(self%watch(i)%state) = at
      self%top(self%watch(i)%state) = top
   end subroutine reach

   !> Find the deformations between which no limit state is reached that is not yet reached, and whether some
   !> have no such bounds: they depend on openings or on two deformations.
   pure subroutine set_bounds(self)
      type(response_monitor), intent(inout) :: self
      integer :: i

      self%lowest = -huge(1.0_wp)
      self%highest = huge(1.0_wp)
      self%opens = .false.
      self%watching = .false.
      do i = 1, size(self%watch)
         associate (watch => self%watch(i))
            if (self%reached(watch%state) < huge(1.0_wp)) cycle
            self%watching = .true.
            if (abs(watch%opening) > 0.0_wp .or. abs(watch%slip*watch%rotation) > 0.0_wp) then
               self%opens = .true.
            else
               associate (slips => watch%slips, turns => watch%turns)
                  call narrow(self%lowest(slips), self%highest(slips), watch%slip, watch%threshold)
                  call narrow(self%lowest(turns), self%highest(turns), watch%rotation, watch%threshold)
               end associate
            end if
         end associate
      end do
   end subroutine set_bounds

   !> Narrow the bounds of a deformation to where its factor times it is below the threshold.
   pure subroutine narrow(lowest, highest, factor, threshold)
      !> Bounds of the deformation [m or rad]
      real(wp), intent(inout) :: lowest, highest
      real(wp), intent(in) :: factor, threshold

      ! Beyond all meaning it would overflow.
      if (abs(threshold) > 1.0e100_wp) return
      if (factor > 0.0_wp) highest = min(highest, threshold/factor)
      if (factor < 0.0_wp) lowest = max(lowest, threshold/factor)
   end subroutine narrow

end module rbs_solve_time_monitor
