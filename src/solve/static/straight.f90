!> Static path for small rotations, event to event: the structure moves along its line to the target or to the
!> next end of a spring's line, whichever comes first. Exact for `small` and `pdelta`; no tolerance, no
!> increments.
module rbs_solve_static_straight
   use rbs_base_error, only: error_type, fatal_error, analysis_failed
   use rbs_base_inner_product, only: total
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_base_text, only: to_text
   use rbs_hysteresis_springs, only: spring_array
   use rbs_hysteresis_straight_motion, only: go_along, nearest_end
   use rbs_solve_end_state, only: checkpoint_type
   use rbs_solve_static_corner, only: turn_corner, report_no_line, is_spent, same_rate
   use rbs_solve_static_equilibrium, only: equilibrium_type
   use rbs_solve_static_path, only: static_path, state_of, target_of, weakest_spring, is_on_end, &
                                    on_the_end, serialize_path
   use rbs_solve_static_resume, only: begin_path, end_path, checkpoint_of, settle
   use rbs_solve_task, only: task_type
   use rbs_structure_structure, only: structure_type
   implicit none
   private

   public :: trace_straight

   !> Farther from the ends of their lines than this, relative to them, springs need not be asked whether they
   !> are on one.
   real(wp), parameter :: nearly = 2.0_wp*on_the_end

   !> Ends that are reached within this share of the driven quantity are reached at once: its round-off.
   !> Layers that close together do so at zero, where no share of a deformation tells.
   real(wp), parameter :: same_control = 1.0e-13_wp

   !> A correction of equilibrium below this share of a deformation is round-off.
   real(wp), parameter :: small_correction = 1.0e-10_wp

   !> Lines without progress toward a target after which a path is given up: some, and some for each spring.
   integer, parameter :: most_idle = 1000, most_idle_per_spring = 10

   !> Shortest leap, as a share of the way to a target, and most trials of one. Shares of the largest force,
   !> or displacement, by whose work a leap may be wrong, and which turns of springs may change in it.
   real(wp), parameter :: shortest_leap = 1.0_wp/64.0_wp, missing_work = 1.0e-2_wp, missing_turns = 1.0e-4_wp
   !> A point of a path is in equilibrium within this share of the largest force.
   real(wp), parameter :: missing_force = 1.0e-9_wp
   !> A change below this share of the largest force is round-off.
   real(wp), parameter :: of_round_off = 1.0e-12_wp
   integer, parameter :: most_trials = 12

   !> The state of a path and the line it is on.
   type, extends(static_path) :: straight_path
      type(equilibrium_type), pointer :: equilibrium => null()
      !> The line: driven quantity, position (coordinates), force and displacement where it begins
      real(wp) :: start = 0.0_wp
      real(wp), allocatable :: q(:)
      !> Springs near the ends of their lines, a work array (moving)
      integer, allocatable :: near(:)
      real(wp) :: force_start = 0.0_wp, displacement_start = 0.0_wp
      !> Its end, and the spring that ends it (0: none)
      real(wp) :: finish = 0.0_wp
      integer :: ends = 0
      !> Largest value of the control; the way to the present target, and the largest share of it so far
      real(wp) :: farthest = 0.0_wp, way = 0.0_wp, share = 0.0_wp
      !> What turns of springs have changed in leaps so far, the sum [N, m under a driven force]
      real(wp) :: turned = 0.0_wp
      !> Largest force [N] and displacement [m] at the ends of leaps so far
      real(wp) :: largest(2) = 0.0_wp
      !> Whether the path is in a loop of snap-backs; control, force and work where it began [m, N, J]; motion
      !> of the load since then [m]
      logical :: in_loop = .false.
      real(wp) :: loop_control = 0.0_wp, loop_force = 0.0_wp, loop_work = 0.0_wp, loop_motion = 0.0_wp
   contains
      procedure :: advance, solve_line, find_balance, unbalance, serialize
   end type straight_path

contains

   !> Follow the targets one after the other, for small rotations and constant axial loads.
   subroutine trace_straight(structure, equilibrium, by_force, target, task, error, checkpoint, springs)
      class(structure_type), intent(in), target :: structure
      !> Equilibrium of the structure on the lines of its springs
      type(equilibrium_type), intent(inout), target :: equilibrium
      !> Whether the targets are lateral forces [N], else displacements of the top [m]
      logical, intent(in) :: by_force
      !> Targets (m)
      real(wp), intent(in) :: target(:)
      type(task_type), intent(inout), target :: task
      type(error_type), allocatable, intent(out) :: error
      !> State and springs in which the path ends; the caller takes both or none
      type(checkpoint_type), intent(out), optional :: checkpoint
      type(spring_array), intent(out), optional :: springs
      type(straight_path) :: path

      path%structure => structure
      path%without_top_load => structure
      path%equilibrium => equilibrium
      path%is_straight = .true.
      path%may_go_back = .not. by_force
      path%of_dead_load = equilibrium%of_dead_load
      allocate (path%q(structure%coordinates), source=0.0_wp)
      allocate (path%near(equilibrium%moving))
      call begin_path(path, by_force, equilibrium%moving, .false., task%before, error)
      if (allocated(error)) return
      call path%follow(target, task, error)
      associate (peak => merge(task%summary%peak_displacement, task%summary%peak_force, by_force))
         if (task%leaps) task%summary%leap_error = path%turned/max(abs(peak), tiny(1.0_wp))
      end associate
      if (allocated(error) .or. task%summary%has_fallen()) return
      if (task%keeps_end) call end_path(path, .false., task%after)
      if (.not. (present(checkpoint) .and. present(springs))) return
      checkpoint = checkpoint_of(path, .false.)
      springs = path%springs
   end subroutine trace_straight

   !> Go on to a target: by leaps where the task asks for them, else from event to event. A leap that fails is
   !> halved; where it cannot be shorter, or has few events, these are followed.
   subroutine advance(self, target, error)
      class(straight_path), intent(inout) :: self
      !> Displacement [m] or force [N]
      real(wp), intent(in) :: target
      type(error_type), allocatable, intent(out) :: error
      !> Way to the target, length of a leap (both with the sign of their direction), and where it leads to
      real(wp) :: whole, length, next
      !> Whether the end was reached, a shorter leap is worth a trial, a member fails before `next`
      logical :: arrived, halves, fails

      self%share = 0.0_wp
      self%way = target - self%control_begin
      if (.not. self%task%leaps .or. self%structure%in_series .or. self%in_loop) then
         call follow_events(self, target, error)
         return
      end if
      length = target - self%control
      whole = length
      fails = .false.
      do
         if (.not. abs(target - self%control) > 0.0_wp) return
         if (self%task%stops()) return
         next = target
         if (abs(next - self%control) > 1.5_wp*abs(length)) next = self%control + length
         ! Corners behind a leap do not bind its springs: they may turn back.
         self%arrived = 0
         self%direction = 0
         call leap(self, next, arrived, halves, fails)
         if (.not. arrived .and. halves .and. abs(length) > shortest_leap*abs(whole)) then
            length = 0.5_wp*length
            cycle
         end if
         if (.not. arrived) then
            call follow_events(self, next, error)
            if (allocated(error) .or. self%loses_load() .or. self%task%summary%stopped) return
         end if
         ! What is left of the way to where a member fails is halved.
         fails = fails .and. arrived
         length = merge(0.5_wp, 2.0_wp, fails)*length
         if (.not. abs(target - self%control) > 0.0_wp) return
         self%share = max(self%share, (self%control - self%control_begin)/self%way)
         call self%record_corner(self%share)
      end do
   end subroutine advance

   !> Go to a displacement or a force in one leap, by Newton's method. Every spring follows its rule on the
   !> way, in one direction, or by one turning point. Nothing has happened where no equilibrium is found,
   !> where it is not stable, where work is missing or turns may change the end too much, or a member fails;
   !> and where springs turn or begin to soften in a leap with no more events than it may have trials: these
   !> events cost no more, and in their order each spring has its turn.
   subroutine leap(self, next, arrived, halves, fails)
      class(straight_path), intent(inout) :: self
      !> Driven quantity at the end of the leap [m or N]
      real(wp), intent(in) :: next
      !> Whether the end is reached; else nothing has happened, and whether a shorter leap is worth a trial
      logical, intent(out) :: arrived, halves
      !> Whether a leap in this way has met a member that fails, or a joint that loses its load
      logical, intent(inout) :: fails
      !> Rates at the start; first correction of the position and of the force
      real(wp) :: first(size(self%rate)), correction(size(self%rate)), force_correction, slope
      !> Change of the driven quantity; displacement, force and energy at the start; motion and work of the
      !> load; largest force, or displacement, so far, and what turns change of it
      real(wp) :: change, displacement, force, energy, moved, work, largest, turned
      !> Springs that soften at the start
      logical :: softens(self%moving)

      change = next - self%control
      displacement = self%displacement
      force = self%force
      energy = stored()
      halves = .true.
      turned = 0.0_wp
      call self%springs%mark()
      call self%solve_line(1, arrived)
      associate (line => self%equilibrium, springs => self%springs)
         if (arrived) then
            first = self%rate
            softens = springs%k(:self%moving) < 0.0_wp
            ! Work is the integral of the force over the displacement; under a driven force, by parts, less
            ! that of the displacement over the force. The slopes are those of the integrand.
            slope = merge(-line%displacement_rate, line%force_rate, self%by_force)
            correction = line%correction + change*first
            force_correction = line%force_correction + change*line%force_rate
            if (.not. self%by_force) self%displacement = next
            call settle(self, self%by_force, 0.0_wp, most_trials, correction, force_correction, arrived)
         end if
         if (arrived) then
            halves = springs%events - springs%journal%events > most_trials
            call find_turns(self, first, change, turned)
            if (.not. halves) arrived = springs%turned == 0 .and. &
                                        .not. any(springs%k(:self%moving) < 0.0_wp .and. .not. softens)
         end if
         if (arrived .and. springs%turned > 0) then
            largest = max(self%largest(1), abs(force), abs(self%force))
            if (self%by_force) largest = maxval(abs([displacement, self%largest(2), &
                                                     self%structure%top_displacement(springs%d)]))
            arrived = turned <= missing_turns*largest
            if (arrived) call take_turns(self, largest, arrived)
         end if
         if (arrived) then
            if (self%by_force) self%displacement = self%structure%top_displacement(springs%d)
            moved = self%displacement - displacement + line%dead_load_work_rate*change
            slope = slope - merge(-line%displacement_rate, line%force_rate, self%by_force)
            ! The trapezoid, with the slopes at its ends
            work = 0.5_wp*(force + self%force)*moved + slope*change**2/12.0_wp
            largest = max(self%largest(1), abs(force), abs(self%force))
            arrived = (line%is_stable .or. self%by_force) .and. &
                      abs(work - (stored() - energy)) <= missing_work*abs(largest*moved) .and. &
                      self%unbalance() <= missing_force*largest
            if (self%loses_load() .or. self%structure%next_failed_member(springs) > 0) then
               arrived = .false.
               fails = .true.
            end if
         end if
         if (.not. arrived) then
            call springs%restore()
            self%displacement = displacement
            self%force = force
         end if
         call springs%forget_mark()
      end associate
      if (.not. arrived) return
      self%work = self%work + work
      self%turned = self%turned + turned
      self%control = next
      self%last_direction = merge(1, -1, change > 0.0_wp)
      self%farthest = max(self%farthest, abs(next))
      self%largest = max(self%largest, abs([force, displacement]), abs([self%force, self%displacement]))

   contains

      !> Energy of springs and axial load [J].
      real(wp) function stored()
         stored = total(self%springs%count, self%springs%work) + &
                  self%structure%potential_energy(self%springs%d)
      end function stored

   end subroutine leap

   !> Find the springs that have turned in a leap, their rates at its start and its end being opposite. Their
   !> turning points are those of rates that change once, from these to those. A spring that comes back on the
   !> line on which it has turned is where it is.
   subroutine find_turns(self, first, change, turned)
      class(straight_path), intent(inout) :: self
      !> Rates at the start (coordinates)
      real(wp), intent(in) :: first(:)
      !> Change of the driven quantity in the leap [m or N]
      real(wp), intent(in) :: change
      !> Force, or displacement under a driven force, that the ways there or back cost, the shorter ones, if
      !> the springs had their initial stiffness [N or m]
      real(wp), intent(out) :: turned
      !> Share of the leap before the turn, and the turning point [m or rad]
      real(wp) :: share, point
      integer :: i

      turned = 0.0_wp
      associate (springs => self%springs, rate => self%rate)
         do i = 1, self%moving
            if (first(i)*rate(i) >= 0.0_wp) cycle
            share = ((springs%d(i) - springs%journal%d(i))/change - rate(i))/(first(i) - rate(i))
            if (share <= 0.0_wp .or. share >= 1.0_wp) cycle
            point = springs%journal%d(i) + first(i)*share*change
            if (springs%unload_on_reversal(i) == 0 .and. point >= springs%lower(i) .and. &
                point <= springs%upper(i)) cycle
            call springs%turn_at(i, point)
            turned = turned + self%structure%initial_stiffness(i)*abs(change*rate(i))* &
                     min(abs(first(i))*share, abs(rate(i))*(1.0_wp - share))
         end do
      end associate
   end subroutine find_turns

   !> Springs that have turned in a leap go by their turning points, and all settle once more.
   subroutine take_turns(self, largest, arrived)
      class(straight_path), intent(inout) :: self
      !> Largest force so far, displacement under a driven force [N or m]
      real(wp), intent(in) :: largest
      !> Whether equilibrium was found
      logical, intent(out) :: arrived
      real(wp) :: q(size(self%rate)), correction(size(self%rate)), force_correction
      !> Forces of the springs that turn, before
      real(wp) :: force(self%springs%turned)
      !> What the turns have changed of the force, or the displacement [N or m]
      real(wp) :: changed
      integer :: j

      q = self%springs%d
      force = [(self%springs%force(self%springs%turning(j)), j=1, self%springs%turned)]
      call self%springs%retry(q)
      arrived = .not. self%springs%stuck
      changed = 0.0_wp
      do j = 1, size(force)
         associate (i => self%springs%turning(j))
            changed = changed + abs((self%springs%force(i) - force(j))*self%rate(i))
         end associate
      end do
      ! Where it is round-off, the equilibrium that was found stays.
      if (.not. arrived .or. changed <= of_round_off*largest) return
      call self%find_balance(self%by_force, correction, force_correction, arrived)
      if (.not. arrived) return
      call settle(self, self%by_force, 0.0_wp, most_trials, correction, force_correction, arrived)
   end subroutine take_turns

   !> Go on to a target from event to event.
   subroutine follow_events(self, target, error)
      class(straight_path), intent(inout) :: self
      !> Displacement [m] or force [N]
      real(wp), intent(in) :: target
      type(error_type), allocatable, intent(out) :: error
      !> +1 or -1: toward the target; lines in a row that led no nearer to it
      integer :: direction, idle
      logical :: went_back

      direction = 0
      idle = 0
      do while (idle <= most_idle + most_idle_per_spring*self%springs%count)
         if (.not. self%goes_back) then
            if (.not. abs(target - self%control) > 0.0_wp) return
            direction = merge(1, -1, target > self%control)
         end if
         if (self%task%stops()) return
         idle = idle + 1
         if (self%direction == 0 .or. (self%direction /= direction .and. .not. self%goes_back)) then
            went_back = self%goes_back
            ! Where the top turns back at a target, springs turn as they must.
            if (direction /= self%last_direction .and. .not. went_back) self%arrived = 0
            call turn_corner(self, direction, target, error)
            if (allocated(error) .or. self%loses_load()) return
            call self%check_point(target, self%equilibrium%unbalance, .true., error)
            if (allocated(error)) return
            if (self%goes_back .and. .not. went_back) call begin_loop(self)
            call begin_line(self, self%direction)
            self%last_direction = self%direction
         end if
         if (self%goes_back) then
            ! The way back has no end, or it leads beyond all that was reached on the other side.
            if (self%ends == 0 .or. direction*self%finish < -max(abs(target), self%farthest)) then
               call report_fall(self, target, error)
               return
            end if
            call go(self, self%finish)
            call end_line(self)
            call report_corner()
         else if (direction*(self%finish - target) > on_the_end*abs(target)) then
            ! The line goes beyond the target, ends before it, or ends there.
            call go(self, target)
         else if (direction*(self%finish - target) < -on_the_end*abs(target)) then
            call go(self, self%finish)
            call end_line(self)
            call report_corner()
         else
            call go(self, target)
            call end_line(self)
         end if
      end do
      call fatal_error(error, analysis_failed, 'the equilibrium path to '// &
                       trim(target_of(self, target))//' makes no progress at '//trim(state_of(self))// &
                       ': the last '//to_text(idle)//' changes of stiffness led no nearer; '// &
                       trim(weakest_spring(self))//' has the least stiffness left. The path up to there '// &
                       'is kept; a response in time goes on')

   contains

      !> Record the corner. Its number is the share of the way to the target, and on a way back that reached
      !> before, so that numbers do not fall.
      subroutine report_corner()
         real(wp) :: share

         share = (self%control - self%control_begin)/self%way
         if (share > self%share) idle = 0
         self%share = max(self%share, share)
         call self%record_corner(self%share)
      end subroutine report_corner

   end subroutine follow_events

   !> The control moves back from here on: a snap-back. The first one of a loop is where the energy of the
   !> loop is counted from.
   subroutine begin_loop(self)
      class(straight_path), intent(inout) :: self

      self%snap_backs = self%snap_backs + 1
      if (self%in_loop) return
      self%in_loop = .true.
      self%loop_control = self%control
      self%loop_force = self%force
      self%loop_work = self%work
      self%loop_motion = 0.0_wp
   end subroutine begin_loop

   !> Report that the way back of a snap-back has no end: no displacement of the top holds the structure.
   subroutine report_fall(self, target, error)
      class(straight_path), intent(in) :: self
      !> Displacement that the path is on the way to [m]
      real(wp), intent(in) :: target
      type(error_type), allocatable, intent(out) :: error

      if (is_spent(self)) then
         call report_no_line(self, target, error)
         return
      end if
      call fatal_error(error, analysis_failed, 'the equilibrium path to '//to_text(target)//' m leads '// &
                       'away for good at '//trim(state_of(self))//': beyond the strength of '// &
                       trim(weakest_spring(self))//' a part of the structure falls, which no '// &
                       'displacement of the top holds. The path up to there is kept; a response in '// &
                       'time follows the fall')
   end subroutine report_fall

   !> Rates of the structure on the present lines of its springs.
   subroutine solve_line(self, direction, found)
      class(straight_path), intent(inout) :: self
      !> +1 or -1: in which the driven quantity moves
      integer, intent(in) :: direction
      !> Whether there are unique rates, under a driven force those of a stable structure
      logical, intent(out) :: found

      self%equilibrium%may_snap_back = self%passes
      call self%equilibrium%follow(self%springs, self%by_force, self%displacement, self%force, self%rate, &
                                   found)
      self%lost_digits = self%equilibrium%lost_digits
      self%is_stable = self%equilibrium%is_stable
      ! They are rates per unit of the driven quantity; the path may go against it.
      if (direction < 0) self%rate = -self%rate
      if (is_spent(self)) call rest(self%moving, self%structure%initial_stiffness, &
                                    self%equilibrium%force_rate, self%rate)
   end subroutine solve_line

   !> Springs whose rates are round-off rest: beside a storey without strength nothing else moves. What has
   !> stiffness left has none of them: a spring that is stiff beside others carries their force.
   pure subroutine rest(n, initial, stiffness, rate)
      integer, intent(in) :: n
      !> Initial stiffnesses, and that of the structure under the displacement that is driven [N/m]
      real(wp), intent(in) :: initial(n), stiffness
      !> Rates of the springs, of which those that are round-off become zero
      real(wp), intent(inout) :: rate(n)
      real(wp) :: largest

      largest = maxval(initial*rate**2)
      if (abs(stiffness) > same_rate*largest) return
      where (initial*rate**2 < same_rate**2*largest) rate = 0.0_wp
   end subroutine rest

   !> Begin the line that was found: where it starts and where it ends. Where the control may turn, its last
   !> digit is a long way of the springs: these are corrected across the path, and the control follows.
   subroutine begin_line(self, direction)
      class(straight_path), intent(inout) :: self
      !> +1 or -1: in which the driven quantity moves on the line
      integer, intent(in) :: direction
      !> Way to the next end of a line; what the springs lack of the displacement [m]; way on the line by
      !> which the correction is taken off, so that it is across the path
      real(wp) :: distance, residual, along
      logical :: turns

      self%arrived = 0
      along = 0.0_wp
      associate (line => self%equilibrium, m => self%moving)
         turns = self%may_go_back .and. (self%in_loop .or. line%force_rate < 0.0_wp)
         if (turns) then
            along = share_along(m, self%structure%initial_stiffness, line%correction, self%rate)
            line%correction = line%correction - along*self%rate
         end if
         self%start = self%control - direction*along
         self%displacement_start = self%displacement - direction*along
         self%force_start = self%force + line%force_correction - direction*along*line%force_rate
         self%q(:) = self%springs%d + line%correction
         call keep_within(m, self%springs%d, line%correction, self%rate, self%springs%lower, &
                          self%springs%upper, self%q)
         residual = self%displacement - self%structure%top_displacement(self%q)
         ! The displacement follows the springs where the force is driven; else they go on along the line to
         ! it.
         if (self%by_force) then
            self%displacement_start = self%displacement - residual
         else if (abs(residual) > 0.0_wp .and. .not. turns) then
            self%q(:) = self%q + direction*residual*self%rate
            self%force_start = self%force_start + line%force_rate*residual
         end if
      end associate
      call nearest_end(self%springs, self%q(:self%moving), self%rate(:self%moving), distance, self%ends)
      self%finish = direction*huge(1.0_wp)
      if (self%ends > 0) self%finish = self%start + direction*distance
   end subroutine begin_line

   !> How far a correction goes along the rates: the factor of the rates in it, measured by the initial
   !> stiffness.
   pure real(wp) function share_along(n, weight, correction, rate) result(share)
      integer, intent(in) :: n
      !> Initial stiffness, correction and rates of the springs
      real(wp), intent(in) :: weight(n), correction(n), rate(n)
      real(wp) :: square
      integer :: i

      share = 0.0_wp
      square = 0.0_wp
      do i = 1, n
         share = share + weight(i)*rate(i)*correction(i)
         square = square + weight(i)*rate(i)**2
      end do
      share = share/max(square, tiny(1.0_wp))
   end function share_along

   !> Round-off of the equilibrium is corrected in full, off the rear end of a line too, or the rest
   !> would be missing at the next corner. More than round-off moves no spring off its line.
   pure subroutine keep_within(n, d, correction, rate, lower, upper, q)
      integer, intent(in) :: n
      !> Deformations before the correction, the correction, rates on the line, and ends of the lines
      real(wp), intent(in) :: d(n), correction(n), rate(n), lower(n), upper(n)
      !> Deformations with their corrections, which are moved back to an end that they must not pass
      real(wp), intent(inout) :: q(n)
      logical :: is_large
      integer :: i

      !$omp simd private(is_large)
      do i = 1, n
         is_large = abs(correction(i)) > small_correction*abs(d(i))
         q(i) = merge(q(i), max(q(i), lower(i)), rate(i) > 0.0_wp .and. .not. is_large)
         q(i) = merge(q(i), min(q(i), upper(i)), rate(i) < 0.0_wp .and. .not. is_large)
      end do
   end subroutine keep_within

   !> Go along the line; each spring moves on its own line.
   subroutine go(self, control)
      class(straight_path), intent(inout) :: self
      !> Driven quantity to go to [m or N]
      real(wp), intent(in) :: control
      !> Way from where the line begins; force, displacement and motion of the load at its end; deformation of
      !> a spring; way within which ends are reached at once
      real(wp) :: change, force, displacement, moved, d, way
      integer :: count, j

      change = control - self%start
      way = same_control*abs(control)
      call go_along(self%springs, self%moving, self%q, self%rate, abs(change), nearly, way, self%near, count)
      do j = 1, count
         associate (i => self%near(j))
            d = self%q(i) + self%rate(i)*abs(change)
            if (is_on_end(self%springs, i, d, self%rate(i), way)) call self%arrive(i, self%rate(i))
         end associate
      end do
      associate (line => self%equilibrium)
         force = self%force_start + line%force_rate*change
         displacement = self%displacement_start + line%displacement_rate*change
         if (self%by_force) then
            force = control
         else
            displacement = control
         end if
         if (self%in_loop) then
            if ((control - self%loop_control)*(self%control - self%loop_control) <= 0.0_wp) call end_loop()
         end if
         moved = displacement - self%displacement &
                                + line%dead_load_work_rate*(control - self%control)
         self%work = self%work + 0.5_wp*(force + self%force)*moved
         self%loop_motion = self%loop_motion + moved
      end associate
      call self%record_crossing(displacement, force)
      self%force = force
      self%displacement = displacement
      self%control = control
      self%farthest = max(self%farthest, abs(control))

   contains

      !> The displacement at which the loop began is reached again. A test, whose displacement does not move
      !> back, would release the work that the loads of all storeys do while their force changes from the one
      !> to the other, less that of the loop. Where energy is missing no test follows.
      subroutine end_loop()
         real(wp) :: at, motion, energy

         if (self%goes_back .or. .not. abs(self%control - self%loop_control) > 0.0_wp) return
         ! The force, and the motion of the load still to come, where the loop closes
         associate (line => self%equilibrium)
            at = self%force_start + line%force_rate*(self%loop_control - self%start)
            motion = (1.0_wp + line%dead_load_work_rate)*(self%loop_control - self%control)
         end associate
         energy = 0.5_wp*((self%loop_force + at)*(self%loop_motion + motion) - (at + self%force)*motion) &
                  - (self%work - self%loop_work)
         self%released = self%released + max(energy, 0.0_wp)
         self%gained = self%gained + max(-energy, 0.0_wp)
         self%in_loop = .false.
      end subroutine end_loop

   end subroutine go

   !> The line has ended: the spring that ends it gets exactly the deformation of its end.
   subroutine end_line(self)
      class(straight_path), intent(inout) :: self
      integer :: i

      i = self%ends
      ! If `go` has already moved it there, the line has ended.
      if (self%direction /= 0 .and. i > 0) call self%arrive(i, self%rate(i))
      self%direction = 0
   end subroutine end_line

   !> Corrections that take the springs to equilibrium at the displacement of the top, or under the force.
   subroutine find_balance(self, by_force, correction, force, found)
      class(straight_path), intent(inout) :: self
      !> Whether the lateral force is held, else the displacement of the top
      logical, intent(in) :: by_force
      !> Corrections of the deformations (coordinates), and of the lateral force [N]
      real(wp), intent(out) :: correction(:), force
      !> Whether there are unique ones
      logical, intent(out) :: found

      call self%equilibrium%follow(self%springs, by_force, self%displacement, self%force, self%rate, found)
      correction = self%equilibrium%correction
      force = self%equilibrium%force_correction
   end subroutine find_balance

   !> The largest force by which a joint is out of equilibrium, moments over the height [N].
   real(wp) function unbalance(self)
      class(straight_path), intent(inout) :: self

      call self%equilibrium%find_unbalance(self%springs, self%force)
      unbalance = self%equilibrium%unbalance
   end function unbalance

   !> Save or restore, whichever the stream is set to, the line that the structure is on.
   subroutine serialize(self, stream)
      class(straight_path), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call serialize_path(self, stream)
      call stream%items(self%start, self%force_start, self%displacement_start, self%finish)
      call stream%item(self%largest)
      call stream%item(self%q)
      call stream%item(self%ends)
      call self%equilibrium%serialize(stream)
   end subroutine serialize

end module rbs_solve_static_straight
