!> Static path with exact rotations and dead loads.
!>
!> Between two events the path is a smooth curve. It is followed in strides: predicted along the tangent,
!> corrected by Newton's method, never accepted without convergence. An event is a point of the curve and
!> is found as one: a spring stands on the end of its line while what is driven is free; or the motion of
!> a spring on a one-way line turns back, where its rate is zero.
module rbs_solve_static_trace_finite
   use rbs_base_error, only: error_type, fatal_error, analysis_failed, bad_input
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_base_text, only: to_text
   use rbs_column_column, only: column_type
   use rbs_column_finite, only: finite_potential, finite_top
   use rbs_column_top, only: largest_turn
   use rbs_solve_static_corner, only: turn_corner
   use rbs_solve_static_curve, only: clean, first_ahead, most_turn
   use rbs_solve_static_finite_search, only: turning_search
   use rbs_solve_static_path, only: describe_state, name_spring, is_on_end, on_the_end, serialize_path
   use rbs_solve_static_resume, only: begin_path, end_path
   use rbs_solve_task, only: task_type
   implicit none
   private

   public :: trace_finite

   !> A stride below this share of what is driven, or of what was tried, does not count as one.
   real(wp), parameter :: no_stride = 1.0e-11_wp

   !> What round-off leaves of a displacement or force, as a share of the largest.
   real(wp), parameter :: round_off = 32.0_wp*epsilon(1.0_wp)

   !> A stride may be cut at least this often, however short it becomes.
   integer, parameter :: fewest_cuts = 20

   type, extends(turning_search) :: turning_path
      !> Length of the next stride, as what is driven [m or N]
      real(wp) :: stride = huge(1.0_wp)
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
      procedure :: find_balance
      procedure :: unbalance
      procedure :: stand_still
      procedure :: serialize
   end type turning_path

contains

   !> Follow the targets one after the other.
   subroutine trace_finite(column, by_force, target, task, error)
      type(column_type), intent(in) :: column
      !> Whether the targets are lateral forces [N], else displacements of the top [m]
      logical, intent(in) :: by_force
      !> Targets (m)
      real(wp), intent(in) :: target(:)
      type(task_type), intent(inout), target :: task
      type(error_type), allocatable, intent(out) :: error
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
      path%here%q = 0.0_wp
      call begin_path(path, column, by_force, m, .false., error, task%before)
      if (allocated(error)) return
      path%here%q = path%springs%d
      call path%follow(target, task, error)
      if (allocated(error) .or. .not. task%keeps_end) return
      if (task%summary%lost_joint == 0) call end_path(path, .false., task%after)
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
         straight = self%is_straight(share*length, spring > 0 .or. .not. abs(self%target - goal) > 0.0_wp)
         if (straight) then
            call self%go_straight(goal, length, spring, way, share, reached)
            call accept(self, reached, spring, way, turns)
            done = .true.
            return
         end if
         call self%aim(goal, length, share, reached, spring, way, done)
         if (done) call self%equilibrium%find_rates(self%springs, there, self%direction, done)
         if (.not. done) return
         call self%curve%set(self%column, abs(reached - self%control), here, there)
         done = self%curve%is_gentle(self%column, self%springs, self%most_work)
         if (.not. done) return
         call self%curve%first_end(self%springs, there%q, .true., before, side, share)
         if (before > 0) then
            spring = before
            way = side
            call self%meet_end(spring, way, share, reached, done)
            if (.not. done) return
            call self%curve%set(self%column, abs(reached - self%control), here, there)
         end if
         turns = self%curve%least_rate(self%springs, there%rate) < 0.0_wp
         if (turns) then
            spring = 0
            call self%meet_turn(reached, done)
            if (.not. done) return
            call self%curve%set(self%column, abs(reached - self%control), here, there)
         else if (self%curve%hides_turn(self%springs)) then
            done = .false.
            return
         end if
      end associate
      done = self%on_their_lines()
      if (done) call accept(self, reached, spring, way, turns)
   end subroutine try_stride

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
      if (.not. abs(self%target - self%control) > 0.0_wp) return
      call self%see_corner((self%control - self%way_begin)/(self%target - self%way_begin))
   end subroutine accept

   !> Move the springs along their lines; those that come to an open end are put on the next line.
   subroutine put_springs(self)
      class(turning_path), intent(inout) :: self
      integer :: i

      associate (springs => self%springs, q => self%there%q, rate => self%there%rate)
         do i = 1, self%moving
            call springs%advance_on_branch(i, min(max(q(i), springs%first(i)), springs%last(i)))
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

   !> What takes the springs to equilibrium at the displacement of the top.
   subroutine find_balance(self, correction, force, found)
      class(turning_path), intent(inout) :: self
      real(wp), intent(out) :: correction(:), force
      logical, intent(out) :: found

      self%here%q = self%springs%d
      self%here%force = self%force
      call self%equilibrium%find_balance(self%springs, self%here, self%displacement, correction, force, found)
   end subroutine find_balance

   !> The largest force by which a joint is out of equilibrium, moments over the height [N].
   real(wp) function unbalance(self)
      class(turning_path), intent(inout) :: self

      unbalance = self%equilibrium%unbalance(self%springs, self%here)
   end function unbalance

   !> The springs stand where the path begins.
   subroutine stand_still(self)
      class(turning_path), intent(inout) :: self

      self%direction = 0
      self%here%q = self%springs%d
      self%here%force = self%force
      self%here%displacement = self%displacement
      self%extent = abs(merge(self%force, self%displacement, self%by_force))
      call self%equilibrium%remember(self%here%q)
   end subroutine stand_still

   !> Save or restore where the path is and how far it may stride.
   subroutine serialize(self, stream)
      class(turning_path), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call serialize_path(self, stream)
      call stream%item(self%stride)
      call stream%item(self%target)
      call stream%item(self%extent)
      call stream%item(self%most_work)
      call stream%item(self%here%q)
      call stream%item(self%here%rate)
      call stream%item(self%here%force)
      call stream%item(self%here%displacement)
      call stream%item(self%here%force_rate)
      call stream%item(self%here%displacement_rate)
      call stream%item(self%equilibrium%scale)
   end subroutine serialize

   pure subroutine measure(self, axial_work, height)
      class(turning_path), intent(in) :: self
      real(wp), intent(out) :: axial_work, height
      real(wp) :: top(2)

      axial_work = finite_potential(self%column, self%springs%d)
      top = finite_top(self%column, self%springs%d)
      height = top(2)
   end subroutine measure

end module rbs_solve_static_trace_finite
