!> Static path that is a curve: with exact rotations and dead loads, or under an axial load that varies, with
!> the points of the path or with the lateral force.
!>
!> Between two events the path is followed in strides: predicted along the tangent, corrected by Newton's
!> method, never accepted without convergence. An event is a point of the curve and is found as one: a spring
!> or a layer is on the end of its line while the parameter of the path is free; or the motion of one on a
!> one-way line turns back, where its rate is zero.
!>
!> The parameter is the driven quantity where the axial load is constant, else the share of the path between
!> two targets, in proportion to which both change.
module rbs_solve_static_curved
   use rbs_base_error, only: error_type, fatal_error, analysis_failed
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_base_text, only: to_text
   use rbs_base_tolerances, only: round_off_of_sums
   use rbs_hysteresis_interaction_joints, only: list_lines, put_on_plane
   use rbs_solve_static_corner, only: turn_corner
   use rbs_solve_static_curve, only: clean, most_rotation
   use rbs_solve_static_curved_search, only: curve_search, find_event, find_point, find_turn, find_works, &
                                             layer_of, move_to, no_progress, work_of_joint
   use rbs_solve_static_path, only: state_of, weakest_spring, is_on_end, on_the_end, serialize_path
   use rbs_solve_static_resume, only: begin_path, end_path
   use rbs_solve_task, only: task_type
   use rbs_structure_column_column, only: column_type
   use rbs_structure_structure, only: finite
   implicit none
   private

   public :: trace_curved

   !> A stride below this share of the driven quantity, or of its trial, does not count.
   real(wp), parameter :: no_stride = 1.0e-11_wp

   !> A stride may be cut at least this often, however short it becomes; this often for its work.
   integer, parameter :: fewest_cuts = 20, most_cuts_for_work = 8

   !> A stride below this share of the largest value is straight to the last digit, and too short for Newton's
   !> method, whose points are off by round-off.
   real(wp), parameter :: close_by = 1.0e-9_wp

   type, extends(curve_search) :: curved_path
      !> Axial load at the top at each target (m) where it varies [N], and the number of the target
      real(wp), allocatable :: load(:)
      integer :: row = 0
      !> In units of the parameter: length of the next stride, its goal, largest value so far
      real(wp) :: next_length = huge(1.0_wp), goal = 0.0_wp, extent = 0.0_wp
      !> Strides in a row that made no progress
      integer :: stalled_strides = 0
   contains
      procedure :: advance, solve_line, find_balance, unbalance, reset_reference, serialize
   end type curved_path

contains

   !> Follow the targets one after the other.
   subroutine trace_curved(column, by_force, target, load, task, error)
      !> Under the axial load with which the path begins
      class(column_type), intent(in), target :: column
      !> Whether the targets are lateral forces [N], else displacements of the top [m]
      logical, intent(in) :: by_force
      !> Targets (m), and axial loads at the top there; empty where it is constant [N]
      real(wp), intent(in) :: target(:), load(:)
      type(task_type), intent(inout), target :: task
      type(error_type), allocatable, intent(out) :: error
      type(curved_path), target :: path
      logical :: varies
      integer :: m

      varies = size(load) > 0
      m = column%unknowns
      path%load = load
      call path%equilibrium%create(column, by_force, varies)
      allocate (path%current%q(m), path%current%rate(m), path%trial%q(m), path%trial%rate(m), source=0.0_wp)
      path%structure => column
      path%without_top_load => column
      if (varies) path%without_top_load => path%equilibrium%without_top_load
      call begin_path(path, by_force, m, varies, task%before, error)
      if (allocated(error)) return
      ! From the start on, the work that the axial load has done before belongs to the balance.
      if (.not. task%resumes()) then
         call path%reset_reference()
         path%at_begin = path%at_begin + path%load_work
      end if
      call path%follow(target, task, error)
      if (allocated(error) .or. .not. task%keeps_end) return
      if (task%summary%lost_joint == 0) call end_path(path, varies, task%after)
   end subroutine trace_curved

   !> Go on to a target.
   subroutine advance(self, target, error)
      class(curved_path), intent(inout) :: self
      !> Displacement [m] or force [N]
      real(wp), intent(in) :: target
      type(error_type), allocatable, intent(out) :: error
      integer :: direction, strides

      self%stalled_strides = 0
      if (self%equilibrium%varies) then
         self%row = self%row + 1
         ! With an axial load that varies the path is followed by the share of the way, from 0 to 1.
         self%equilibrium%driven = [self%control, target - self%control]
         self%equilibrium%load = [self%load_now, self%load(self%row) - self%load_now]
         if (.not. any(abs([self%equilibrium%driven(2), self%equilibrium%load(2)]) > 0.0_wp)) return
         self%current%t = 0.0_wp
         self%goal = 1.0_wp
         self%extent = 1.0_wp
         self%next_length = huge(1.0_wp)
         self%direction = 0
      else
         self%goal = target
         self%extent = max(self%extent, abs(target))
      end if
      do strides = 1, 10000 + 1000*self%moving
         if (self%task%stops()) return
         if (.not. abs(self%goal - self%current%t) > 0.0_wp) exit
         direction = merge(1, -1, self%goal > self%current%t)
         ! Where the path turns, springs that have come to an end may go back.
         if (direction /= self%last_direction) self%arrived = 0
         self%last_direction = direction
         if (self%direction /= direction) then
            call turn_corner(self, direction, target, error)
            if (allocated(error) .or. self%springs%crushed_joint() > 0) return
            self%arrived = 0
            ! A spring that was put on the end of its line left the column a little out of equilibrium.
            if (self%equilibrium%size_of(self%equilibrium%correction, self%current%q) <= no_progress) then
               self%current%q = self%current%q + self%equilibrium%correction
               self%current%force = self%current%force + self%equilibrium%force_correction
            end if
         end if
         call take_stride(self, target, error)
         if (allocated(error)) return
      end do
      if (abs(self%goal - self%current%t) > 0.0_wp) then
         call report_no_path(self, target, error)
         return
      end if
      if (self%equilibrium%varies) self%load_now = self%load(self%row)
   end subroutine advance

   !> Rates of the column on the present lines of its springs.
   subroutine solve_line(self, direction, found)
      class(curved_path), intent(inout) :: self
      !> +1 or -1: in which the parameter of the path moves
      integer, intent(in) :: direction
      !> Whether there are unique rates, under a driven force those of a stable column
      logical, intent(out) :: found

      call self%equilibrium%solve(self%springs, self%current, found)
      if (.not. found) return
      self%rate = direction*clean(self%structure, self%current)
      if (self%equilibrium%varies) self%current%rate = self%rate
      self%axial_rate = self%current%axial_rate
   end subroutine solve_line

   !> Go on toward the target, at the most to the next event. A stride that fails is cut in halves.
   subroutine take_stride(self, target, error)
      class(curved_path), intent(inout) :: self
      !> Displacement [m] or force [N], for messages
      real(wp), intent(in) :: target
      type(error_type), allocatable, intent(out) :: error
      !> Way to the goal, length of the stride, a length that is nothing, end of the stride (all in units of
      !> the parameter); largest rotation of a body per unit of it
      real(wp) :: distance, length, shortest, limit, rotation_rate
      integer :: cuts
      !> Whether the stride was taken; whether its end is so near that it is taken along the tangent
      logical :: done, near

      call list_lines(self%springs, self%curve%lines)
      if (.not. allocated(self%current%d)) then
         allocate (self%current%d(size(self%curve%lines%joint)), self%current%v(size(self%curve%lines%joint)))
      end if
      call move_to(self, self%current)
      distance = abs(self%goal - self%current%t)
      rotation_rate = self%structure%largest_rotation(self%current%rate)
      length = min(distance, self%next_length)
      if (rotation_rate*length > most_rotation) length = most_rotation/rotation_rate
      shortest = no_stride*max(abs(self%current%t), length)
      cuts = 0
      do
         limit = self%current%t + self%direction*length
         if (length >= distance) limit = self%goal
         call try_stride()
         if (done) exit
         cuts = cuts + 1
         self%cuts = self%cuts + 1
         length = 0.5_wp*length
         if (cuts < fewest_cuts .or. length > shortest) cycle
         call report_no_path(self, target, error)
         return
      end do
      if (.not. near) self%next_length = 2.0_wp*length
      if (self%stalled_strides > 20 + 4*self%moving + merge(2000, 0, self%springs%axial_load_varies)) then
         call report_no_path(self, target, error)
      end if

   contains

      !> One stride, to a limit or to the first event before it.
      subroutine try_stride()
         real(wp) :: works(3)
         logical :: turns

         turns = .false.
         self%trial = self%current
         call find_event(self, limit)
         ! So near to the goal or to an event the point along the tangent has all its digits.
         near = (self%line > 0 .or. .not. abs(self%goal - limit) > 0.0_wp) .and. &
                abs(self%trial%t - self%current%t) <= close_by*self%extent .and. &
                abs(self%trial%t - self%current%t)*rotation_rate <= close_by
         done = near
         if (.not. near) call find_point(self, limit, .true., done)
         if (done) call self%curve%set(self%structure, self%current, self%trial)
         if (done .and. .not. near) then
            done = self%curve%is_gentle(self%structure)
            if (done) turns = self%curve%least_rate(self%trial) < 0.0_wp
            ! A motion on a one-way line has turned back before the end: the stride ends where it turns.
            if (turns) then
               call find_turn(self, done)
               if (done) call self%curve%set(self%structure, self%current, self%trial)
            end if
            if (done) done = .not. self%curve%hides_event()
         end if
         if (.not. done) return
         call find_works(self, cuts < most_cuts_for_work .and. .not. near, works, done)
         if (done) call accept(turns, works)
      end subroutine try_stride

      !> Go to the point that was found: works, springs and present state of the path.
      subroutine accept(turns, works)
         !> Whether a motion turns back there
         logical, intent(in) :: turns
         !> Of force and axial load on the way [J]
         real(wp), intent(in) :: works(:)
         logical :: closed, stands
         integer :: side

         associate (trial => self%trial, current => self%current, spring => self%line)
            ! An end that is met at the goal, but for round-off, is met there: beyond it, the path
            ! would turn back.
            if (abs(self%goal - trial%t) <= on_the_end*abs(self%goal) + round_off_of_sums*self%extent) then
               trial%t = self%goal
            end if
            self%control = self%equilibrium%driven(1) + self%equilibrium%driven(2)*trial%t
            if (self%by_force) then
               trial%force = self%control
            else
               trial%displacement = self%control
            end if
            self%work = self%work + works(1)
            self%load_work = self%load_work + works(2)
            self%most_work = max(self%most_work, abs(self%work))
            stands = .not. abs(trial%t - current%t) > 0.0_wp
            self%stalled_strides = merge(self%stalled_strides + 1, 0, stands)
            if (spring > 0 .and. spring <= self%springs%count) then
               side = merge(1, -1, self%last_direction*trial%rate(spring) > 0.0_wp)
               closed = merge(self%springs%includes_upper_end(spring), &
                        self%springs%includes_lower_end(spring), side > 0)
               call self%arrive(spring, real(side, wp))
               ! Where it made no progress its rate is zero and does not show its direction. From an open
               ! end it has gone on already.
               if (closed .and. stands) call self%springs%leave(spring, side)
            end if
            call put_springs()
            self%rate = self%last_direction*clean(self%structure, trial)
            ! A motion may have turned by less than the search resolves.
            if (turns .or. spring > 0 .or. any(self%springs%unload_on_reversal*self%rate < 0.0_wp)) then
               self%direction = 0
            end if
         end associate
         self%force = self%trial%force
         self%displacement = self%trial%displacement
         self%current = self%trial
         self%current%q = self%springs%d
         call self%equilibrium%remember(self%current%q)
         if (.not. abs(self%goal - self%current%t) > 0.0_wp) return
         if (self%equilibrium%varies) then
            call self%record_corner(self%current%t)
         else
            call self%record_corner((self%control - self%control_begin)/(self%goal - self%control_begin))
         end if
      end subroutine accept

      !> Move the springs along their lines; those that come to an open end are put on the next line.
      subroutine put_springs()
         real(wp) :: work
         integer :: i, j, direction

         direction = self%last_direction
         associate (springs => self%springs, trial => self%trial)
            do i = 1, self%moving
               ! Layered joints follow below; round-off must not take a spring off its line.
               if (springs%on_plane(i)) cycle
               call springs%advance_on_branch(i, min(max(trial%q(i), springs%lower(i)), springs%upper(i)))
               if (.not. is_on_end(springs, i, trial%q(i), direction*trial%rate(i))) cycle
               call self%arrive(i, direction*trial%rate(i))
            end do
            if (.not. springs%axial_load_varies) return
            do j = 1, size(springs%layered)
               i = springs%layered(j)
               work = work_of_joint(self, i)
               call put_on_plane(springs, i, trial%q(i), trial%axial_load + self%equilibrium%above(i), &
                                 trial%rate(i), trial%axial_rate, layer_of(self, i))
               springs%work(i) = springs%work(i) + work
            end do
         end associate
      end subroutine put_springs

   end subroutine take_stride

   !> Report why the path cannot be continued.
   subroutine report_no_path(self, target, error)
      class(curved_path), intent(in) :: self
      !> Displacement [m] or force [N] that the path is on the way to
      real(wp), intent(in) :: target
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: state, weakest

      state = trim(state_of(self))
      weakest = ' ('//trim(weakest_spring(self))//' has the least stiffness left). The path up to there '// &
                'is kept'
      if (self%equilibrium%varies) then
         call fatal_error(error, analysis_failed, 'no equilibrium was found beyond '//state//' and the '// &
                          'axial load '//to_text(self%current%axial_load)//' N on the way to '// &
                          to_text(target)//merge(' N', ' m', self%by_force)//': the column snaps through '// &
                          'or has lost its capacity there'//weakest//'; use a dynamic analysis to go on')
      else if (self%by_force) then
         call fatal_error(error, analysis_failed, 'the lateral force '//to_text(target)//' N is beyond '// &
                          'the capacity of the column: no stable equilibrium was found beyond '//state// &
                          weakest//'; drive the column by displacement, or stiffen the springs')
      else
         call fatal_error(error, analysis_failed, 'no equilibrium was found beyond '//state// &
                          ' on the way to '//to_text(target)//' m: the column snaps back there, or '// &
                          'the top has come as far as its length lets it'//weakest// &
                          '; a driven top cannot follow that, use a dynamic analysis')
      end if
   end subroutine report_no_path

   !> Corrections that take the springs to equilibrium at the present displacement of the top under the
   !> present axial load. The driven force or displacement is set back afterwards.
   subroutine find_balance(self, by_force, correction, force, found)
      class(curved_path), intent(inout) :: self
      !> False on a curved path, which holds the displacement and not the force
      logical, intent(in) :: by_force
      !> Corrections of the deformations (unknowns), and of the lateral force [N]
      real(wp), intent(out) :: correction(:), force
      !> Whether there are unique ones
      logical, intent(out) :: found

      self%current%q = self%springs%d
      self%current%force = self%force
      self%current%t = 0.0_wp
      associate (equilibrium => self%equilibrium)
         equilibrium%by_force = by_force
         equilibrium%driven = [self%displacement, 0.0_wp]
         equilibrium%load = [self%load_now, 0.0_wp]
         call equilibrium%solve(self%springs, self%current, found)
         equilibrium%by_force = self%by_force
         equilibrium%driven = [0.0_wp, 1.0_wp]
         correction = equilibrium%correction
         force = equilibrium%force_correction
         if (self%springs%axial_load_varies) then
            self%springs%target_axial_load(:) = self%current%axial_load + equilibrium%above
         end if
      end associate
   end subroutine find_balance

   !> The largest force by which a joint is out of equilibrium, moments over the height [N].
   real(wp) function unbalance(self)
      class(curved_path), intent(inout) :: self

      self%current%q = self%springs%d
      unbalance = self%equilibrium%unbalance(self%springs, self%current)
   end function unbalance

   !> Take the present deformations of the springs as the point where the path begins.
   subroutine reset_reference(self)
      class(curved_path), intent(inout) :: self

      self%direction = 0
      self%current%q = self%springs%d
      self%current%force = self%force
      self%current%displacement = self%displacement
      self%current%t = merge(self%force, self%displacement, self%by_force)
      self%extent = abs(self%current%t)
      call self%equilibrium%remember(self%current%q)
      if (.not. self%equilibrium%varies) return
      self%equilibrium%load = [self%load_now, 0.0_wp]
      ! The load has done its work before the path begins.
      self%load_work = self%load_now*self%equilibrium%unit_top_load%potential_energy(self%current%q)
   end subroutine reset_reference

   !> Save or restore, whichever the stream is set to, where the path is and how far it may stride.
   subroutine serialize(self, stream)
      class(curved_path), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call serialize_path(self, stream)
      associate (current => self%current)
         call stream%items(self%load_work, self%next_length, self%extent, self%most_work, current%t)
         call stream%item(current%q)
         call stream%item(current%rate)
         call stream%items(current%force, current%displacement, current%axial_load, current%force_rate, &
                           current%displacement_rate, current%axial_rate, current%lift_rate)
      end associate
      call stream%item(self%equilibrium%scale)
      call stream%item(self%equilibrium%load)
   end subroutine serialize

end module rbs_solve_static_curved
