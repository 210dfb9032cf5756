!> Static path with exact rotations and dead loads.
!>
!> Between two events the path is a smooth curve. It is followed in strides: predicted along the tangent,
!> corrected by Newton's method, never accepted without convergence. An event is a point of the curve and
!> is found as one: a spring stands on the end of its line while what is driven is free; or the motion of
!> a spring on a one-way line turns back, where its rate is zero.
module rbs_solve_static_trace_finite
   use rbs_base_error, only: error_type, fatal_error, analysis_failed, bad_input
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_column_column, only: column_type
   use rbs_column_finite, only: finite_potential, finite_top
   use rbs_output_observer, only: observer_type
   use rbs_output_recorder, only: recorder_type
   use rbs_output_summary, only: summary_type
   use rbs_solve_static_corner, only: turn_corner
   use rbs_solve_static_curve, only: curve_type, clean, first_ahead, largest_turn, most_turn, same_rate
   use rbs_solve_static_finite_equilibrium, only: finite_equilibrium, path_point
   use rbs_solve_static_path, only: static_path, describe_state, name_spring, is_on_end, on_the_end
   implicit none
   private

   public :: trace_finite

   !> A stride below this share of what is driven, or of what was tried, does not count as one.
   real(wp), parameter :: no_stride = 1.0e-11_wp

   !> What round-off leaves of a displacement or force, as a share of the largest.
   real(wp), parameter :: round_off = 32.0_wp*epsilon(1.0_wp)

   !> A way below this share of the largest value is straight to the last digit, and too short for Newton's
   !> method, whose points are off by round-off.
   real(wp), parameter :: close_by = 1.0e-9_wp

   !> A stride may be cut at least this often, however short it becomes.
   integer, parameter :: fewest_cuts = 20

   type, extends(static_path) :: turning_path
      type(finite_equilibrium) :: equilibrium
      !> The present point and the one that is tried
      type(path_point) :: here, there
      !> The curve between the present point and the farthest tried
      type(curve_type) :: curve
      !> Length of the next stride, and largest value so far, as what is driven [m or N]
      real(wp) :: stride = huge(1.0_wp), extent = 0.0_wp
      !> Where the path goes to at present
      real(wp) :: target = 0.0_wp
      !> Largest work of the lateral force so far, in size [J]
      real(wp) :: most_work = 0.0_wp
      !> Strides in a row that made no progress
      integer :: standing = 0
   contains
      procedure :: advance
      procedure :: solve_line
      procedure :: measure
   end type turning_path

contains

   !> Follow the targets one after the other from the virgin state.
   subroutine trace_finite(column, by_force, target, every, collapse_drift, recorder, summary, error, &
                           progress)
      type(column_type), intent(in) :: column
      !> Whether the targets are lateral forces [N], else displacements of the top [m]
      logical, intent(in) :: by_force
      !> Targets (m)
      real(wp), intent(in) :: target(:)
      !> Every n-th point is kept, and the last; `unset_integer`: all
      integer, intent(in) :: every
      !> Displacement of the top over the height at which the path ends; `unset`: it does not
      real(wp), intent(in) :: collapse_drift
      class(recorder_type), intent(inout) :: recorder
      type(summary_type), intent(out) :: summary
      !> On failure everything up to the last good state has been recorded
      type(error_type), allocatable, intent(out) :: error
      !> Told now and then how far the path is
      class(observer_type), intent(inout), optional :: progress
      type(turning_path) :: path
      integer :: m

      if (column%axial_follows .or. column%force_follows) then
         call fatal_error(error, bad_input, 'column: loads that follow the top (axial_follows, '// &
                          'force_follows) have no potential, and a static path could miss the loss of '// &
                          'stability; use a dynamic analysis')
         return
      end if
      m = column%unknowns
      call path%equilibrium%create(column, by_force)
      allocate (path%here%q(m), path%here%rate(m), path%there%q(m), path%there%rate(m), source=0.0_wp)
      call path%begin(column, by_force, m, error)
      if (allocated(error)) return
      path%here%q = path%springs%d
      call path%follow(target, every, collapse_drift, recorder, summary, error, progress)
   end subroutine trace_finite

   !> Go on to a target.
   subroutine advance(self, target, error)
      class(turning_path), intent(inout) :: self
      !> Displacement [m] or force [N]
      real(wp), intent(in) :: target
      type(error_type), allocatable, intent(out) :: error
      integer :: direction, strides

      self%standing = 0
      self%target = target
      self%extent = max(self%extent, abs(target))
      do strides = 1, 10000 + 100*self%moving
         if (.not. abs(target - self%control) > 0.0_wp) return
         direction = merge(1, -1, target > self%control)
         if (self%direction /= direction) then
            call turn_corner(self, direction, target, error)
            if (allocated(error)) return
            ! A spring that was put on the end of its line left the column a little out of equilibrium.
            call self%equilibrium%settle(self%springs, self%here, self%control)
         end if
         call take_stride(self, target, error)
         if (allocated(error)) return
      end do
      call report_no_way(self, target, error)
   end subroutine advance

   !> Rates of the column on the present lines of its springs.
   subroutine solve_line(self, direction, found)
      class(turning_path), intent(inout) :: self
      integer, intent(in) :: direction
      logical, intent(out) :: found

      call self%equilibrium%find_rates(self%springs, self%here, direction, found)
      if (found) self%rate = clean(self%column, self%here)
   end subroutine solve_line

   !> Go on toward the target, at the most to the next event. A stride that fails is cut in halves.
   subroutine take_stride(self, target, error)
      class(turning_path), intent(inout) :: self
      real(wp), intent(in) :: target
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: way, length, shortest, goal, turn
      integer :: cuts
      logical :: done, straight

      way = abs(target - self%control)
      turn = largest_turn(self%column, self%here%rate)
      length = min(way, self%stride)
      if (turn*length > most_turn) length = most_turn/turn
      shortest = no_stride*max(abs(self%control), length)
      cuts = 0
      do
         goal = self%control + self%direction*length
         if (length >= way) goal = target
         call try_stride(self, goal, length, done, straight)
         if (done) exit
         cuts = cuts + 1
         self%cuts = self%cuts + 1
         length = 0.5_wp*length
         if (cuts < fewest_cuts .or. length > shortest) cycle
         call report_no_way(self, target, error)
         return
      end do
      if (.not. straight) self%stride = 2.0_wp*length
      if (self%standing <= 20 + 4*self%moving) return
      call report_no_way(self, target, error)
   end subroutine take_stride

   !> One stride, to a goal or to the first event before it.
   subroutine try_stride(self, goal, length, done, straight)
      class(turning_path), intent(inout) :: self
      !> What is driven, there, and its change in size
      real(wp), intent(in) :: goal, length
      logical, intent(out) :: done
      !> Whether the way was so short that it tells nothing of how far the next stride may go
      logical, intent(out) :: straight
      real(wp) :: reached, share
      integer :: spring, way, before, side
      logical :: turns

      turns = .false.
      associate (here => self%here, there => self%there)
         call first_ahead(self%springs, here, length, spring, way, share)
         straight = is_straight(self, share*length, spring > 0 .or. .not. abs(self%target - goal) > 0.0_wp)
         if (straight) then
            call go_straight(self, goal, length, spring, way, share, reached)
            call accept(self, reached, spring, way, turns)
            done = .true.
            return
         end if
         call aim(self, goal, length, share, reached, spring, way, done)
         if (done) call self%equilibrium%find_rates(self%springs, there, self%direction, done)
         if (.not. done) return
         call self%curve%set(self%column, abs(reached - self%control), here, there)
         done = self%curve%is_gentle(self%column, self%springs, self%most_work)
         if (.not. done) return
         call self%curve%first_end(self%springs, there%q, .true., before, side, share)
         if (before > 0) then
            spring = before
            way = side
            call meet_end(self, spring, way, share, reached, done)
            if (.not. done) return
            call self%curve%set(self%column, abs(reached - self%control), here, there)
         end if
         turns = self%curve%least_rate(self%springs, there%rate) < 0.0_wp
         if (turns) then
            spring = 0
            call meet_turn(self, reached, done)
            if (.not. done) return
            call self%curve%set(self%column, abs(reached - self%control), here, there)
         else if (self%curve%hides_turn(self%springs)) then
            done = .false.
            return
         end if
      end associate
      done = on_their_lines(self)
      if (done) call accept(self, reached, spring, way, turns)
   end subroutine try_stride

   !> Whether the path is straight up to a point ahead. A part of a way that was too long does not count:
   !> before a limit point the path bends within any distance.
   pure logical function is_straight(self, way, whole)
      class(turning_path), intent(in) :: self
      !> Change of what is driven up to there, and whether an end of a line or the target is there
      real(wp), intent(in) :: way
      logical, intent(in) :: whole

      is_straight = whole .and. way <= close_by*self%extent
      if (is_straight) is_straight = way*largest_turn(self%column, self%here%rate) <= close_by
   end function is_straight

   !> A point so near that the path is straight up to it: an end of a spring's line, or the goal.
   subroutine go_straight(self, goal, length, spring, way, share, reached)
      class(turning_path), intent(inout) :: self
      real(wp), intent(in) :: goal, length
      !> The spring that stands on its end there, 0 if none, and which end
      integer, intent(in) :: spring, way
      !> Share of the length up to there
      real(wp), intent(in) :: share
      !> What is driven there
      real(wp), intent(out) :: reached

      reached = goal
      if (spring > 0) reached = self%control + share*(goal - self%control)
      self%there = self%here
      associate (here => self%here, there => self%there)
         there%q = here%q + here%rate*(share*length)
         if (spring > 0) there%q(spring) = self%springs%end_toward(spring, way)
         there%force = here%force + here%force_rate*(reached - self%control)
         there%displacement = here%displacement + here%displacement_rate*(reached - self%control)
         call self%curve%set(self%column, abs(reached - self%control), here, there)
      end associate
   end subroutine go_straight

   !> Find a point ahead: where the tangent says that the first spring reaches its end, if this is before
   !> the goal, else the goal.
   subroutine aim(self, goal, length, share, reached, spring, way, done)
      class(turning_path), intent(inout) :: self
      !> Share of the length after which the first spring reaches its end by the tangent
      real(wp), intent(in) :: goal, length, share
      !> What is driven there
      real(wp), intent(out) :: reached
      !> The spring that stands on its end there, 0 if none, and which end; on entry by the tangent
      integer, intent(inout) :: spring, way
      logical, intent(out) :: done

      associate (here => self%here, there => self%there)
         if (spring > 0) then
            there%q = here%q + here%rate*(share*length)
            there%force = here%force + here%force_rate*(share*(goal - self%control))
            call self%equilibrium%find_point(self%springs, there, spring, &
                                             self%springs%end_toward(spring, way), done)
            reached = merge(there%force, there%displacement, self%by_force)
            associate (way_there => self%direction*(reached - self%control))
               if (done .and. way_there >= 0.0_wp .and. way_there <= length) return
            end associate
         end if
         spring = 0
         reached = goal
         there%q = here%q + here%rate*length
         there%force = here%force + here%force_rate*(goal - self%control)
         call self%equilibrium%find_point(self%springs, there, 0, goal, done)
      end associate
   end subroutine aim

   !> Find the point where the first spring reaches its end; `there` becomes that point.
   subroutine meet_end(self, spring, way, share, reached, done)
      class(turning_path), intent(inout) :: self
      !> On entry a guess which is the first, which end, and where on the curve
      integer, intent(inout) :: spring, way
      real(wp), intent(inout) :: share
      !> What is driven there
      real(wp), intent(inout) :: reached
      logical, intent(out) :: done
      real(wp) :: change, limit
      integer :: tries, next, next_way

      done = .false.
      limit = reached
      do tries = 1, 30
         call self%curve%guess(share, self%there)
         call self%equilibrium%find_point(self%springs, self%there, spring, &
                                          self%springs%end_toward(spring, way), done)
         if (.not. done) return
         reached = merge(self%there%force, self%there%displacement, self%by_force)
         change = self%direction*(reached - self%control)
         ! The event must lie between here and the goal; round-off may put it a little beside.
         done = change >= -1.0e-9_wp*abs(limit - self%control) .and. &
                self%direction*(limit - reached) >= -1.0e-9_wp*abs(limit - self%control)
         if (.not. done) return
         call self%curve%first_end(self%springs, self%there%q, .false., next, next_way, share)
         if (next == 0) exit
         spring = next
         way = next_way
      end do
      done = next == 0
      if (done) call self%equilibrium%find_rates(self%springs, self%there, self%direction, done)
   end subroutine meet_end

   !> Find the point where the first motion turns back, by the method of false position (Illinois).
   subroutine meet_turn(self, reached, done)
      class(turning_path), intent(inout) :: self
      real(wp), intent(inout) :: reached
      logical, intent(out) :: done
      real(wp) :: near, far, at_near, at_far, value
      integer :: i, side

      near = self%control
      far = reached
      at_near = self%curve%least_rate(self%springs, self%here%rate)
      at_far = self%curve%least_rate(self%springs, self%there%rate)
      side = 0
      done = at_near > 0.0_wp .and. at_far < 0.0_wp
      if (.not. done) return
      do i = 1, 60
         reached = far - at_far*(far - near)/(at_far - at_near)
         if (i > 40) reached = 0.5_wp*(near + far)
         call self%curve%guess(abs(reached - self%control)/self%curve%length, self%there)
         call self%equilibrium%find_point(self%springs, self%there, 0, reached, done)
         if (done) call self%equilibrium%find_rates(self%springs, self%there, self%direction, done)
         if (.not. done) return
         value = self%curve%least_rate(self%springs, self%there%rate)
         if (abs(value) < 0.9_wp*same_rate) return
         if (value > 0.0_wp) then
            near = reached
            at_near = value
            if (side > 0) at_far = 0.5_wp*at_far
            side = 1
         else
            far = reached
            at_far = value
            if (side < 0) at_near = 0.5_wp*at_near
            side = -1
         end if
      end do
      done = .false.
   end subroutine meet_turn

   !> Whether the springs really are on their lines at the point that was found.
   pure logical function on_their_lines(self)
      class(turning_path), intent(in) :: self
      real(wp) :: room
      integer :: i

      on_their_lines = .true.
      associate (springs => self%springs, q => self%there%q)
         do i = 1, self%moving
            room = 1.0e-9_wp*(abs(q(i)) + abs(q(i) - self%here%q(i)))
            on_their_lines = on_their_lines .and. q(i) <= springs%last(i) + room .and. &
                             q(i) >= springs%first(i) - room
         end do
      end associate
   end function on_their_lines

   !> Go to the point that was found.
   subroutine accept(self, reached, spring, way, turns)
      class(turning_path), intent(inout) :: self
      !> What is driven there
      real(wp), intent(inout) :: reached
      !> The spring that stands on its end, 0 if none, and the end
      integer, intent(in) :: spring, way
      !> Whether a motion turns back there
      logical, intent(in) :: turns
      real(wp) :: change
      logical :: closed

      ! An end that is met where the path goes to, but for round-off, is met there: beyond it, the path would
      ! turn back.
      if (abs(self%target - reached) <= on_the_end*abs(self%target) + round_off*self%extent) then
         reached = self%target
      end if
      change = reached - self%control
      if (self%by_force) then
         self%there%force = reached
      else
         self%there%displacement = reached
      end if
      self%work = self%work + sum(self%curve%work())
      self%most_work = max(self%most_work, abs(self%work))
      self%standing = merge(0, self%standing + 1, abs(change) > 0.0_wp)
      if (spring > 0) then
         closed = merge(self%springs%hi_closed(spring), self%springs%lo_closed(spring), way > 0)
         call self%springs%arrive(spring, way)
         ! Where it made no progress its rate is zero and does not show that it goes on. From an open end
         ! it has gone on already.
         if (closed .and. .not. abs(change) > 0.0_wp) call self%springs%leave(spring, way)
      end if
      call put_springs(self)
      ! A motion may have turned by less than the search resolves.
      if (turns .or. spring > 0 .or. any(self%springs%one_way*clean(self%column, self%there) < 0.0_wp)) then
         self%direction = 0
      end if
      self%force = self%there%force
      self%displacement = self%there%displacement
      self%control = reached
      self%here = self%there
      self%here%q = self%springs%d
      call self%equilibrium%remember(self%here%q)
   end subroutine accept

   !> Move the springs along their lines; those that come to an open end are put on the next line.
   subroutine put_springs(self)
      class(turning_path), intent(inout) :: self
      integer :: i

      associate (springs => self%springs, q => self%there%q, rate => self%there%rate)
         do i = 1, self%moving
            call springs%walk(i, min(max(q(i), springs%first(i)), springs%last(i)))
            if (.not. is_on_end(springs, i, q(i), rate(i))) cycle
            call springs%arrive(i, merge(1, -1, rate(i) > 0.0_wp))
            self%direction = 0
         end do
      end associate
   end subroutine put_springs

   !> Report why the path cannot be continued.
   subroutine report_no_way(self, target, error)
      class(turning_path), intent(in) :: self
      real(wp), intent(in) :: target
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: state, spring

      call describe_state(self, state)
      call name_spring(self, spring)
      if (self%by_force) then
         call fatal_error(error, analysis_failed, 'the lateral force '//to_text(target)// &
                          ' N is beyond the capacity of the column: no stable equilibrium was found '// &
                          'beyond '//state//' ('//spring//' has the least stiffness left). The path up '// &
                          'to there is kept; drive the column by displacement, or stiffen the springs')
      else
         call fatal_error(error, analysis_failed, 'no equilibrium was found beyond '//state// &
                          ' on the way to '//to_text(target)//' m: the column snaps back there, or '// &
                          'the top has come as far as its length lets it ('//spring//' has the '// &
                          'least stiffness left). The path up to there is kept; a driven top cannot '// &
                          'follow that, use a dynamic analysis')
      end if
   end subroutine report_no_way

   pure subroutine measure(self, axial_work, height, rotation)
      class(turning_path), intent(in) :: self
      real(wp), intent(out) :: axial_work, height, rotation
      real(wp) :: top(2)

      axial_work = finite_potential(self%column, self%springs%d)
      top = finite_top(self%column, self%springs%d)
      height = top(2)
      rotation = largest_turn(self%column, self%springs%d)
   end subroutine measure

end module rbs_solve_static_trace_finite
