!> Peaks of the response, collapse and limit states of a run: at the end of every step, and within the steps
!> of methods that resolve it. They do not depend on which rows are kept.
!>
!> Cubics on a step: through four values at its start, its thirds and its end.
module rbs_solve_time_monitor
   use rbs_base_check, only: is_given
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_interaction_joints, only: opening_of, rest_of
   use rbs_hysteresis_springs, only: spring_array
   use rbs_loading_loads, only: lateral, horizontal
   use rbs_output_summary, only: peaks_type
   use rbs_solve_time_motion, only: equation_of_motion, motion_result
   use rbs_structure_spring_place, only: shear, flexure, layer
   use rbs_structure_structure, only: finite
   implicit none
   private

   public :: response_monitor, watch_type

   !> c(1) + c(2) s + c(3) s**2 + c(4) s**3, s from 0 to 1.
   type :: cubic_type
      real(wp) :: c(4) = 0.0_wp
      !> Its value at the end, to the last bit
      real(wp) :: last = 0.0_wp
   contains
      procedure :: at
      procedure :: largest
      procedure :: first_at
      procedure, private :: turns
   end type cubic_type

   !> A limit state is reached where a sum of a joint's deformations is at a threshold or beyond it.
   type :: watch_type
      !> Number of the limit state, 1 for first yield, and joint
      integer :: state = 1, joint = 1
      !> Factors of slip, of rotation and of opening; where there is one of the opening, rotations count with
      !> those at rest
      real(wp) :: slip = 0.0_wp, rotation = 0.0_wp, opening = 0.0_wp, threshold = huge(1.0_wp)
      !> The springs of the joint that slip and rotate, which `begin` finds
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
      !> Shares of the openings now (watches)
      real(wp), allocatable, private :: openings_now(:)
      !> Whether openings are still watched
      logical, private :: opens = .false.
      !> States within a step (springs, 4), shares of the openings there (watches, 4), and absolute rotations
      !> of the bodies (n, 4)
      real(wp), allocatable, private :: inner_q(:, :), inner_v(:, :), inner_openings(:, :), rotation(:, :)
      !> Whether the acceleration of the top is looked at, and the equation of motion for it
      logical :: feels = .false.
      type(motion_result), private :: now
   contains
      procedure :: watch_for
      procedure :: begin
      procedure :: update
      procedure :: update_within_step
      procedure :: check_limits
   end type response_monitor

contains

   !> Limit states to watch for; to be called before `begin`.
   pure subroutine watch_for(self, watch, states)
      class(response_monitor), intent(inout) :: self
      type(watch_type), intent(in) :: watch(:)
      !> Number of limit states
      integer, intent(in) :: states

      self%watch = watch
      self%reached = spread(huge(1.0_wp), 1, states)
      self%top = spread(0.0_wp, 1, states)
   end subroutine watch_for

   !> The start of a run.
   subroutine begin(self, motion, springs, q, v, load, clock, collapse_drift, floor)
      class(response_monitor), intent(inout) :: self
      !> See `update`
      type(equation_of_motion), intent(in) :: motion
      type(spring_array), intent(in) :: springs
      real(wp), intent(in), contiguous :: q(:), v(:)
      real(wp), intent(in) :: load(4), clock
      !> Drift at which the structure has collapsed, of a storey or of the top; `unset`: none
      real(wp), intent(in) :: collapse_drift
      !> Whether the acceleration of the top is looked at
      logical, intent(in) :: floor
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
         allocate (self%lowest(m), self%highest(m), self%inner_q(m, 4), self%inner_v(m, 4), &
                   self%openings(size(self%watch)), self%openings_now(size(self%watch)), &
                   self%inner_openings(size(self%watch), 4), self%rotation(motion%structure%n, 4), &
                   source=0.0_wp)
      end if
      do i = 1, size(self%watch)
         ! A kind that the structure does not have has the factor 0, with any spring.
         self%watch(i)%slips = max(motion%structure%spring_of(shear, self%watch(i)%joint), 1)
         self%watch(i)%turns = motion%structure%spring_of(flexure, self%watch(i)%joint)
         ! Behind the flexural springs come layers of joints.
         if (self%watch(i)%turns == 0) then
            self%watch(i)%turns = max(motion%structure%spring_of(layer, self%watch(i)%joint - &
                                                   count(motion%structure%place%kind == flexure)), 1)
         end if
      end do
      self%peaks_type = peaks_type()
      self%collapsed = .false.
      call set_bounds(self)
      if (motion%structure%storeys > 0) then
         allocate (self%storey_drift(motion%structure%storeys), &
                   self%peak_storey_drift(motion%structure%storeys), source=0.0_wp)
      end if
      self%feels = floor
      if (floor) call self%now%create(motion%structure)
      self%q = q
      self%clock = clock
      self%displacement = motion%structure%top_displacement(q)
      call fill_openings(self, springs, springs%d, 0.0_wp, self%openings)
      call self%update(motion, springs, q, v, load, clock)
   end subroutine begin

   !> The end of a step.
   subroutine update(self, motion, springs, q, v, load, clock)
      class(response_monitor), intent(inout) :: self
      type(equation_of_motion), intent(in) :: motion
      type(spring_array), intent(in) :: springs
      !> Deformations and velocities (springs), loads
      real(wp), intent(in), contiguous :: q(:), v(:)
      real(wp), intent(in) :: load(4)
      !> [s]
      real(wp), intent(in) :: clock
      real(wp) :: displacement, turn, shear
      integer :: i

      if (associated(motion%one_body)) then
         ! Its steps are short: nothing is called that need not be.
         displacement = q(1) + motion%one_body%length(1)*q(2)
         turn = abs(q(2))
      else
         displacement = motion%structure%top_displacement(q)
         turn = motion%structure%largest_turn(q)
      end if
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
         call self%see_peak(displacement, load(lateral))
         self%collapsed = self%collapsed .or. abs(self%peak_displacement) >= self%furthest
      end if
      if (turn > self%peak_rotation) call self%see_turn(turn)
      if (abs(shear) > abs(self%peak_base_shear)) call self%see_base(shear)
      if (self%feels) then
         call motion%acceleration(springs, q, v, load, self%now)
         call self%see_floor(motion%structure%top_acceleration(q, v, self%now%a) + load(horizontal))
      end if
      if (.not. self%watching) return
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

   !> Limit states at the end of a step; between its ends deformations are straight in time.
   subroutine check_limits(self, springs, q, displacement, clock)
      class(response_monitor), intent(inout) :: self
      type(spring_array), intent(in) :: springs
      real(wp), intent(in), contiguous :: q(:)
      !> Of the top [m]
      real(wp), intent(in) :: displacement, clock

      if (self%opens) call fill_openings(self, springs, springs%d, 0.0_wp, self%openings_now)
      if (self%opens .or. are_beyond(size(q), self%lowest, self%highest, q, q)) then
         call check_limit_states(self, q, displacement, clock)
      end if
      self%clock = clock
      self%displacement = displacement
      self%q(:) = q
      if (self%opens) self%openings(:) = self%openings_now
   end subroutine check_limits

   !> Limit states that may have been reached.
   subroutine check_limit_states(self, q, displacement, clock)
      type(response_monitor), intent(inout) :: self
      real(wp), intent(in) :: q(:), displacement, clock
      real(wp) :: share, before, after, at
      logical :: open(size(self%reached))
      integer :: i

      open = .not. self%reached < huge(1.0_wp)
      do i = 1, size(self%watch)
         if (.not. open(self%watch(i)%state)) cycle
         after = value_of(self%watch(i), q, self%openings_now(i))
         if (.not. after >= self%watch(i)%threshold) cycle
         before = value_of(self%watch(i), self%q, self%openings(i))
         share = 1.0_wp
         if (after > before) share = (self%watch(i)%threshold - before)/(after - before)
         at = self%clock + share*(clock - self%clock)
         call reach(self, i, at, self%displacement + share*(displacement - self%displacement))
      end do
      call set_bounds(self)
   end subroutine check_limit_states

   !> A step from a state that has been checked, with springs on their lines; between its ends deformations
   !> are cubics in time.
   subroutine update_within_step(self, motion, springs, q0, v0, q1, v1, h, clock)
      class(response_monitor), intent(inout) :: self
      type(equation_of_motion), intent(in) :: motion
      !> On the lines of the step
      type(spring_array), intent(in) :: springs
      !> Deformations and velocities at its start and its end (springs)
      real(wp), intent(in), contiguous :: q0(:), v0(:), q1(:), v1(:)
      !> Its length, and the clock at its end [s]
      real(wp), intent(in) :: h, clock
      real(wp) :: displacement(2), reach
      integer :: i, m

      ! Steps up to an event may have no length.
      if (.not. h > tiny(1.0_wp)) return
      m = size(q0)
      ! No cubic goes further beyond its ends than that.
      reach = 4.0_wp/27.0_wp*h
      displacement = [motion%structure%top_displacement(q0), motion%structure%top_displacement(q1)]
      if (peaks_may_grow(self, motion, springs, displacement, q0, v0, q1, v1, reach)) then
         call fill_inner(m, q0, v0, q1, v1, h, self%inner_q, self%inner_v)
         call find_peaks(self, motion, springs)
      end if
      if (.not. self%watching) return
      self%clock = clock
      self%displacement = displacement(2)
      self%q(:) = q1
      if (.not. self%opens) then
         if (.not. are_beyond(m, self%lowest, self%highest, min(q0, q1) - reach*(abs(v0) + abs(v1)), &
                              max(q0, q1) + reach*(abs(v0) + abs(v1)))) return
      end if
      call fill_inner(m, q0, v0, q1, v1, h, self%inner_q, self%inner_v)
      if (self%opens) then
         do i = 1, 4
            call fill_openings(self, springs, self%inner_q(:, i), (i - 1)/3.0_wp, self%inner_openings(:, i))
         end do
         self%openings(:) = self%inner_openings(:, 4)
      end if
      call look_within(self, motion, h, clock)
   end subroutine update_within_step

   !> Whether the largest responses may grow within a step: each is a cubic in time, as the deformations are.
   !> With damping it is not, and every step is looked at.
   logical function peaks_may_grow(self, motion, springs, displacement, q0, v0, q1, v1, reach) result(grow)
      type(response_monitor), intent(inout) :: self
      type(equation_of_motion), intent(in) :: motion
      type(spring_array), intent(in) :: springs
      !> Of the top at both ends [m]
      real(wp), intent(in) :: displacement(2)
      !> See `update_within_step`
      real(wp), intent(in), contiguous :: q0(:), v0(:), q1(:), v1(:)
      !> How far a cubic goes beyond its ends, for the sum of both velocities there [s]
      real(wp), intent(in) :: reach
      real(wp) :: shear(2), more, longer
      integer :: i

      grow = .true.
      if (motion%damped) return
      associate (structure => motion%structure)
         if (structure%kinematics == finite) then
            ! The top turns about a joint on the arm of the straight structure, longer by all slips and
            ! openings; twice that, as a cubic through values overshoots them.
            longer = 0.0_wp
            do i = 1, size(q0)
               if (structure%place(i)%kind /= flexure) longer = longer + abs(q0(i)) + way_of(i)
            end do
            more = 0.0_wp
            do i = 1, size(q0)
               more = more + 2.0_wp*(max(abs(structure%arm(i)), 1.0_wp) + longer)*way_of(i)
            end do
         else
            more = reach*(abs(structure%speed(lateral, q0, v0)) + abs(structure%speed(lateral, q1, v1)))
         end if
         if (goes_beyond(displacement(1), displacement(2), more, self%peak_displacement)) return
         i = structure%base_spring
         if (i > 0) then
            associate (f0 => springs%f0(i), k => springs%k(i))
               shear = [f0 + k*(q0(i) - springs%d0(i)), f0 + k*(q1(i) - springs%d0(i))]
               more = reach*abs(k)*(abs(v0(i)) + abs(v1(i)))
            end associate
            if (goes_beyond(shear(1), shear(2), more, self%peak_base_shear)) return
         end if
         call structure%rotations(q0, self%rotation(:, 1))
         call structure%rotations(q1, self%rotation(:, 2))
         call structure%rotations(v0, self%rotation(:, 3))
         call structure%rotations(v1, self%rotation(:, 4))
         do i = 1, structure%n
            associate (r => self%rotation(i, :))
               if (goes_beyond(r(1), r(2), reach*(abs(r(3)) + abs(r(4))), self%peak_rotation)) return
            end associate
         end do
      end associate
      grow = .false.

   contains

      !> How far a deformation may go from its values at the ends.
      pure real(wp) function way_of(i)
         integer, intent(in) :: i

         way_of = abs(q1(i) - q0(i)) + reach*(abs(v0(i)) + abs(v1(i)))
      end function way_of

   end function peaks_may_grow

   !> Whether a value between two others, or somewhat beyond them, may exceed a peak in size.
   pure logical function goes_beyond(start, finish, more, peak)
      real(wp), intent(in) :: start, finish, more, peak

      goes_beyond = max(abs(start), abs(finish)) + more > abs(peak)*(1.0_wp - 1.0e-12_wp)
   end function goes_beyond

   !> The largest responses within a step whose inner states are known.
   subroutine find_peaks(self, motion, springs)
      type(response_monitor), intent(inout) :: self
      type(equation_of_motion), intent(in) :: motion
      type(spring_array), intent(in) :: springs
      type(cubic_type) :: part
      real(wp) :: displacement(4), base(4), turn(4)
      integer :: i, j

      do j = 1, 4
         displacement(j) = motion%structure%top_displacement(self%inner_q(:, j))
         base(j) = motion%base_shear(springs, self%inner_q(:, j), self%inner_v(:, j))
         call motion%structure%rotations(self%inner_q(:, j), self%rotation(:, j))
      end do
      if (may_exceed(displacement, self%peak_displacement)) then
         part = cubic_through(displacement)
         call self%see_peak(part%largest(), 0.0_wp)
         self%collapsed = self%collapsed .or. abs(self%peak_displacement) >= self%furthest
      end if
      if (may_exceed(base, self%peak_base_shear)) then
         part = cubic_through(base)
         call self%see_base(part%largest())
      end if
      do i = 1, size(self%rotation, 1)
         turn = self%rotation(i, :)
         if (.not. may_exceed(turn, self%peak_rotation)) cycle
         part = cubic_through(turn)
         call self%see_turn(abs(part%largest()))
      end do
   end subroutine find_peaks

   !> Whether a cubic through four values may exceed another one in size: between them it is at most 1.64
   !> times the largest of them (the Lebesgue constant of four equal distances).
   pure logical function may_exceed(value, other)
      real(wp), intent(in) :: value(4), other

      may_exceed = 1.64_wp*max(abs(value(1)), abs(value(2)), abs(value(3)), abs(value(4))) > abs(other)
   end function may_exceed

   !> Limit states within a step whose inner states are known.
   subroutine look_within(self, motion, h, clock)
      type(response_monitor), intent(inout) :: self
      type(equation_of_motion), intent(in) :: motion
      real(wp), intent(in) :: h, clock
      type(cubic_type) :: along, top
      real(wp) :: value(4), share
      logical :: open(size(self%reached))
      integer :: i, j

      do j = 1, 4
         value(j) = motion%structure%top_displacement(self%inner_q(:, j))
      end do
      top = cubic_through(value)
      open = .not. self%reached < huge(1.0_wp)
      do i = 1, size(self%watch)
         if (.not. open(self%watch(i)%state)) cycle
         do j = 1, 4
            value(j) = value_of(self%watch(i), self%inner_q(:, j), self%inner_openings(i, j))
         end do
         along = cubic_through(value)
         share = along%first_at(self%watch(i)%threshold)
         if (share <= 1.0_wp) call reach(self, i, clock - (1.0_wp - share)*h, top%at(share))
      end do
      call set_bounds(self)
   end subroutine look_within

   !> Shares of the openings, and of the rotations at rest, in what is watched.
   pure subroutine fill_openings(self, springs, q, share, openings)
      type(response_monitor), intent(in) :: self
      type(spring_array), intent(in) :: springs
      !> Deformations (springs), and the share of the step, see `opening_of`
      real(wp), intent(in) :: q(:), share
      !> (watches)
      real(wp), intent(inout) :: openings(:)
      integer :: i

      do i = 1, size(self%watch)
         associate (watch => self%watch(i))
            if (.not. abs(watch%opening) > 0.0_wp) cycle
            openings(i) = watch%opening*opening_of(springs, watch%turns, q(watch%turns), share) &
                          + watch%rotation*rest_of(springs, watch%turns)
         end associate
      end do
   end subroutine fill_openings

   !> The states at the start of a step, at its thirds and at its end.
   pure subroutine fill_inner(m, q0, v0, q1, v1, h, q, v)
      integer, intent(in) :: m
      real(wp), intent(in) :: q0(m), v0(m), q1(m), v1(m), h
      real(wp), intent(out) :: q(m, 4), v(m, 4)
      real(wp) :: s, bulge
      integer :: i, j

      q(:, 1) = q0
      v(:, 1) = v0
      q(:, 4) = q1
      v(:, 4) = v1
      do j = 2, 3
         s = (j - 1)/3.0_wp
         do i = 1, m
            q(i, j) = q0(i) + s**2*(3.0_wp - 2.0_wp*s)*(q1(i) - q0(i)) &
                      + s*(1.0_wp - s)*h*((1.0_wp - s)*v0(i) - s*v1(i))
            ! Excess of the mean velocity over that of the ends; in a very short step it would be round-off.
            bulge = (q1(i) - q0(i))/h - 0.5_wp*(v0(i) + v1(i))
            bulge = min(max(bulge, -abs(v1(i) - v0(i))), abs(v1(i) - v0(i)))
            v(i, j) = (1.0_wp - s)*v0(i) + s*v1(i) + 6.0_wp*s*(1.0_wp - s)*bulge
         end do
      end do
   end subroutine fill_inner

   !> Whether some deformation may be at a bound.
   pure logical function are_beyond(m, lowest, highest, least, most)
      integer, intent(in) :: m
      real(wp), intent(in) :: lowest(m), highest(m), least(m), most(m)
      integer :: i, beyond

      beyond = 0
      do i = 1, m
         beyond = beyond + merge(1, 0, most(i) >= highest(i) .or. least(i) <= lowest(i))
      end do
      are_beyond = beyond > 0
   end function are_beyond

   !> Value of a watch, which is compared with its threshold.
   pure real(wp) function value_of(watch, q, opening) result(value)
      type(watch_type), intent(in) :: watch
      !> Deformations (springs), and the share of the opening
      real(wp), intent(in) :: q(:), opening

      value = watch%slip*q(watch%slips) + watch%rotation*q(watch%turns) + opening
   end function value_of

   !> A limit state may be reached.
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

   !> The bounds of what is still watched for.
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
            if (abs(watch%opening) > 0.0_wp) then
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

   !> The bound of a deformation that has a factor.
   pure subroutine narrow(lowest, highest, factor, threshold)
      real(wp), intent(inout) :: lowest, highest
      real(wp), intent(in) :: factor, threshold

      ! Beyond all meaning it would overflow.
      if (abs(threshold) > 1.0e100_wp) return
      if (factor > 0.0_wp) highest = min(highest, threshold/factor)
      if (factor < 0.0_wp) lowest = max(lowest, threshold/factor)
   end subroutine narrow

   pure type(cubic_type) function cubic_through(value) result(cubic)
      !> At 0, 1/3, 2/3 and 1
      real(wp), intent(in) :: value(4)
      real(wp) :: d1, d2, d3

      ! Differences: values that are equal have coefficients that vanish.
      d1 = value(2) - value(1)
      d2 = value(3) - value(2)
      d3 = value(4) - value(3)
      cubic%last = value(4)
      cubic%c(1) = value(1)
      cubic%c(2) = 0.5_wp*(11.0_wp*d1 - 7.0_wp*d2 + 2.0_wp*d3)
      cubic%c(3) = 4.5_wp*(-2.0_wp*d1 + 3.0_wp*d2 - d3)
      cubic%c(4) = 4.5_wp*(d1 - 2.0_wp*d2 + d3)
   end function cubic_through

   pure real(wp) function at(self, s)
      class(cubic_type), intent(in) :: self
      real(wp), intent(in) :: s

      at = self%last
      if (s < 1.0_wp) at = self%c(1) + s*(self%c(2) + s*(self%c(3) + s*self%c(4)))
   end function at

   !> Where it turns within the step, in order; 1 where it does not.
   pure function turns(self) result(s)
      class(cubic_type), intent(in) :: self
      real(wp) :: s(2), a, half, root, q

      s = 1.0_wp
      a = 3.0_wp*self%c(4)
      half = self%c(3)
      root = half**2 - a*self%c(2)
      if (.not. root > 0.0_wp) return
      ! The larger of both in size first, so that nothing cancels.
      q = -(half + sign(sqrt(root), half))
      s(1) = share_of(self%c(2), q)
      s(2) = share_of(q, a)
      if (s(1) > s(2)) s = s([2, 1])
   end function turns

   !> A quotient, 1 where it is not between 0 and 1.
   pure real(wp) function share_of(part, whole) result(share)
      real(wp), intent(in) :: part, whole

      share = 1.0_wp
      if (abs(part) < abs(whole) .and. part*whole > 0.0_wp) share = part/whole
   end function share_of

   !> The value that is largest in size, with its sign.
   pure real(wp) function largest(self)
      class(cubic_type), intent(in) :: self
      real(wp) :: value(4), s(2)

      s = self%turns()
      value = [self%c(1), self%at(s(1)), self%at(s(2)), self%last]
      largest = value(maxloc(abs(value), dim=1))
   end function largest

   !> Where it first has a value or is above it; 2 if it does not within the step.
   pure real(wp) function first_at(self, value) result(s)
      class(cubic_type), intent(in) :: self
      real(wp), intent(in) :: value
      real(wp) :: way(3), low, high
      integer :: i

      s = 0.0_wp
      if (self%c(1) >= value) return
      way(:2) = self%turns()
      way(3) = 1.0_wp
      low = 0.0_wp
      do i = 1, 3
         high = way(i)
         if (self%at(high) >= value) exit
         low = high
      end do
      s = 2.0_wp
      if (i > 3) return
      ! It rises from the one to the other.
      do
         s = 0.5_wp*(low + high)
         if (.not. (s > low .and. s < high)) exit
         if (self%at(s) >= value) then
            high = s
         else
            low = s
         end if
      end do
      s = high
   end function first_at

end module rbs_solve_time_monitor
