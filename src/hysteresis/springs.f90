!> The springs of a column: rules off the hot path, their present lines as plain arrays on it.
module rbs_hysteresis_springs
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
   use, intrinsic :: iso_fortran_env, only: int64
   use rbs_base_kinds, only: wp
   use rbs_base_constants, only: unbounded
   use rbs_hysteresis_journal, only: journal_type, rule_slot
   use rbs_hysteresis_layered, only: layered_rule
   use rbs_hysteresis_segment, only: segment
   use rbs_hysteresis_spring_record, only: spring_record
   implicit none
   private

   public :: spring_array, follow_path

   !> Most lines within one move. More mean that a rule goes round in lines without length, which is an error
   !> of the rule. The longest correct move closes all open inner loops that a rule remembers.
   integer, parameter :: most_lines = 10000

   !> `count` springs in their present state. Assignment copies everything, memory of the rules too.
   type :: spring_array
      !> Number of springs
      integer :: count = 0
      !> Present deformation (count) [m or rad]
      real(wp), allocatable :: d(:)
      !> Present line: anchor and slope (count)
      real(wp), allocatable :: d0(:), f0(:), k(:)
      !> First and last deformation that belong to the present line (count). Where the end itself does not
      !> belong to it, they are the numbers next to it.
      real(wp), allocatable :: first(:), last(:)
      !> Whether the ends themselves belong to the line (count), see `segment`
      logical, allocatable :: lo_closed(:), hi_closed(:)
      !> One-way lines (count), see `segment`
      integer, allocatable :: one_way(:)
      !> Work done on each spring along its path, exact (count) [J]
      real(wp), allocatable :: work(:)
      !> Number of lines left so far
      integer :: events = 0
      !> Changes with every new line, and in `restore`: factors computed for the lines of one version are
      !> valid while the version is the same
      integer :: version = 0
      !> Whether a rule has exceeded `most_lines`; the state must not be used then
      logical :: stuck = .false.
      !> Layered joints among the springs, and whether their axial loads vary along the path
      integer, allocatable :: layered(:)
      logical :: pressed = .false.
      !> Where they vary (count): axial load that the joint is to reach, axial load of the present plane
      !> [N], and its centre of stiffness e = -dM/dN [m]
      real(wp), allocatable :: press_to(:), press_at(:), centre(:)
      type(rule_slot), allocatable, private :: slot(:)
      type(journal_type), private :: journal
   contains
      procedure :: create
      procedure :: force
      procedure :: end_toward
      procedure :: move
      procedure :: move_all
      procedure :: walk
      procedure :: leave
      procedure :: arrive
      procedure :: carry_to
      procedure :: stay_on_lines
      procedure :: load_to
      procedure :: mark
      procedure :: restore
      procedure :: forget_mark
      procedure :: vary_axial_loads
      procedure :: lost_joint
      procedure :: fill_openings
      procedure :: choose_lines
      procedure :: way_on_plane
      procedure :: put_on_plane
      procedure :: turns_on_plane
   end type spring_array

contains

   !> Virgin springs.
   subroutine create(self, specs)
      class(spring_array), intent(out) :: self
      !> Validated parameters of each spring
      type(spring_record), intent(in) :: specs(:)
      type(segment) :: line
      integer :: i, n

      n = size(specs)
      self%count = n
      allocate (self%slot(n), self%one_way(n), self%lo_closed(n), self%hi_closed(n))
      allocate (self%d(n), self%work(n), source=0.0_wp)
      allocate (self%d0(n), self%f0(n), self%k(n), self%first(n), self%last(n))
      do i = 1, n
         call specs(i)%make(self%slot(i)%rule)
         call self%slot(i)%rule%start(line)
         call put_line(self, i, line)
      end do
      self%layered = pack([(i, i=1, n)], specs%rule == 'layered')
   end subroutine create

   !> The axial loads of the layered joints vary from now on: these joints follow straight paths in rotation
   !> and axial load, towards `press_to`, and have no line of their own that the rotation alone could leave.
   subroutine vary_axial_loads(self)
      class(spring_array), intent(inout) :: self
      integer :: j

      self%pressed = size(self%layered) > 0
      if (.not. self%pressed) return
      allocate (self%press_to(self%count), self%press_at(self%count), self%centre(self%count), &
                source=0.0_wp)
      do j = 1, size(self%layered)
         call read_plane(self, self%layered(j))
      end do
      self%press_to(:) = self%press_at
   end subroutine vary_axial_loads

   !> The plane that a layered joint is on.
   subroutine read_plane(self, i)
      type(spring_array), intent(inout) :: self
      integer, intent(in) :: i

      select type (rule => self%slot(i)%rule)
      class is (layered_rule)
         call rule%plane(self%d0(i), self%press_at(i), self%f0(i), self%k(i), self%centre(i))
      end select
      self%first(i) = -unbounded
      self%last(i) = unbounded
      self%one_way(i) = 0
      self%version = modulo(self%version + 1, huge(1))
   end subroutine read_plane

   !> Layered joints whose axial loads vary go straight to new rotations and to `press_to`.
   subroutine press_joints(self, d)
      type(spring_array), intent(inout) :: self
      !> New deformations (count) [m or rad]
      real(wp), intent(in), contiguous :: d(:)
      integer :: i, j

      do j = 1, size(self%layered)
         i = self%layered(j)
         if (.not. abs(d(i) - self%d(i)) + abs(self%press_to(i) - self%press_at(i)) > 0.0_wp) cycle
         if (self%journal%open) call self%journal%keep(i, line_of(self, i), self%slot(i))
         select type (rule => self%slot(i)%rule)
         class is (layered_rule)
            call rule%go(d(i), self%press_to(i), self%work(i))
         end select
         self%events = self%events + 1
         call read_plane(self, i)
         self%d(i) = d(i)
      end do
   end subroutine press_joints

   !> The first layered joint that can no longer carry its axial load, 0 if all can.
   pure integer function lost_joint(self) result(lost)
      class(spring_array), intent(in) :: self
      integer :: j

      do j = 1, size(self%layered)
         lost = self%layered(j)
         select type (rule => self%slot(lost)%rule)
         class is (layered_rule)
            if (rule%failed()) return
         end select
      end do
      lost = 0
   end function lost_joint

   !> Openings of n joints at the middle of their sections [m], then the rotations from which they count
   !> theirs [rad]; zero for a joint that is not layered. Without room nothing is filled.
   pure subroutine fill_openings(self, n, values)
      class(spring_array), intent(in) :: self
      !> Number of joints; their flexural springs are n + 1 to 2 n
      integer, intent(in) :: n
      !> (2 n), or empty
      real(wp), intent(inout) :: values(:)
      integer :: i, j

      if (size(values) == 0) return
      values = 0.0_wp
      do j = 1, size(self%layered)
         i = self%layered(j)
         select type (rule => self%slot(i)%rule)
         class is (layered_rule)
            if (self%pressed) then
               values(i - n) = rule%opening_at(self%d(i), self%press_at(i))
            else
               values(i - n) = rule%opening_at(self%d(i), rule%present_load())
            end if
            values(i) = rule%rotation_at_rest()
         end select
      end do
   end subroutine fill_openings

   !> Put the layers of a joint on the lines on which they go on along a straight path.
   subroutine choose_lines(self, i, turn, press)
      class(spring_array), intent(inout) :: self
      integer, intent(in) :: i
      !> Rates of the rotation [rad] and of the axial load [N]
      real(wp), intent(in) :: turn, press

      select type (rule => self%slot(i)%rule)
      class is (layered_rule)
         call rule%choose(turn, press)
      end select
      call read_plane(self, i)
   end subroutine choose_lines

   !> How far a layered joint can go from a point of its plane along a straight path until a layer reaches the
   !> end of its line.
   pure subroutine way_on_plane(self, i, rotation, axial_load, turn, press, way, first)
      class(spring_array), intent(in) :: self
      integer, intent(in) :: i
      real(wp), intent(in) :: rotation, axial_load, turn, press
      !> In units of the rates; `unbounded` if there is no end
      real(wp), intent(out) :: way
      !> The layer, 0 for none
      integer, intent(out) :: first

      way = unbounded
      first = 0
      select type (rule => self%slot(i)%rule)
      class is (layered_rule)
         call rule%way_to_event(rotation, axial_load, turn, press, way, first)
      end select
   end subroutine way_on_plane

   !> Whether a layer of a joint goes back on a one-way line.
   pure logical function turns_on_plane(self, i, turn, press)
      class(spring_array), intent(in) :: self
      integer, intent(in) :: i
      !> Rates of the rotation and of the axial load
      real(wp), intent(in) :: turn, press

      turns_on_plane = .false.
      select type (rule => self%slot(i)%rule)
      class is (layered_rule)
         turns_on_plane = rule%turns(turn, press)
      end select
   end function turns_on_plane

   !> Move a layered joint on its plane to a point, where a layer (0: none) comes to the end of its line.
   !> Its work is left to the caller, who knows the path.
   subroutine put_on_plane(self, i, rotation, axial_load, turn, press, first)
      class(spring_array), intent(inout) :: self
      integer, intent(in) :: i
      real(wp), intent(in) :: rotation, axial_load, turn, press
      integer, intent(in) :: first

      select type (rule => self%slot(i)%rule)
      class is (layered_rule)
         call rule%pass_event(rotation, axial_load, turn, press, first)
      end select
      call read_plane(self, i)
      self%d(i) = rotation
      if (first > 0) self%events = self%events + 1
   end subroutine put_on_plane

   !> Force of one spring at its present deformation [N or N m].
   pure real(wp) function force(self, i)
      class(spring_array), intent(in) :: self
      integer, intent(in) :: i

      force = self%f0(i) + self%k(i)*(self%d(i) - self%d0(i))
   end function force

   !> The end of the present line in a direction, +1 or -1 [m or rad]. The rear end of a one-way line is the
   !> present deformation.
   pure real(wp) function end_toward(self, i, direction)
      class(spring_array), intent(in) :: self
      integer, intent(in) :: i, direction

      if (self%one_way(i) == -direction) then
         end_toward = self%d(i)
      else if (direction > 0) then
         end_toward = upper_end(self%last(i), self%hi_closed(i))
      else
         end_toward = lower_end(self%first(i), self%lo_closed(i))
      end if
   end function end_toward

   !> The upper end of a line from the last deformation that belongs to it.
   elemental real(wp) function upper_end(last, closed)
      real(wp), intent(in) :: last
      logical, intent(in) :: closed

      upper_end = last
      if (.not. closed .and. last < unbounded) upper_end = next_above(last)
   end function upper_end

   !> The lower end of a line from the first deformation that belongs to it.
   elemental real(wp) function lower_end(first, closed)
      real(wp), intent(in) :: first
      logical, intent(in) :: closed

      lower_end = first
      if (.not. closed .and. first > -unbounded) lower_end = -next_above(-first)
   end function lower_end

   !> Move every spring to a new deformation.
   subroutine move_all(self, d)
      class(spring_array), intent(inout) :: self
      !> New deformations (count) [m or rad]
      real(wp), intent(in), contiguous :: d(:)
      integer :: i

      if (self%pressed) call press_joints(self, d)
      if (self%count == 2) then
         ! One body: while both springs stay on their lines, neither a loop nor a call is needed.
         if (d(1) <= self%last(1) .and. d(1) >= self%first(1) .and. &
             d(2) <= self%last(2) .and. d(2) >= self%first(2)) then
            call walk_pair(d, self%d0, self%f0, self%k, self%one_way, self%d, self%work, self%first, &
                           self%last)
            return
         end if
      end if
      if (.not. are_within(self%count, d, self%first, self%last)) then
         do i = 1, self%count
            if (d(i) > self%last(i) .or. d(i) < self%first(i)) call move(self, i, d(i))
         end do
         if (self%stuck) return
      end if
      ! Springs that have arrived do not move any more.
      call walk_all(self%count, d, self%d0, self%f0, self%k, self%one_way, self%d, self%work, self%first, &
                    self%last)
   end subroutine move_all

   !> Whether all springs can go to new deformations on their present lines.
   pure logical function stay_on_lines(self, d)
      class(spring_array), intent(in) :: self
      !> New deformations (count) [m or rad]
      real(wp), intent(in), contiguous :: d(:)

      stay_on_lines = are_within(self%count, d, self%first, self%last) .and. .not. self%pressed
   end function stay_on_lines

   pure logical function are_within(n, d, first, last)
      integer, intent(in) :: n
      real(wp), intent(in) :: d(n), first(n), last(n)
      integer :: i, outside

      outside = 0
      do i = 1, n
         outside = outside + merge(1, 0, d(i) > last(i) .or. d(i) < first(i))
      end do
      are_within = outside == 0
   end function are_within

   !> `walk` for the two springs of one body.
   pure subroutine walk_pair(to, d0, f0, k, one_way, d, work, first, last)
      integer, intent(in) :: one_way(2)
      real(wp), intent(in) :: to(2), d0(2), f0(2), k(2)
      real(wp), intent(inout) :: d(2), work(2), first(2), last(2)
      integer :: i

      work = work + (f0 + k*(0.5_wp*(to + d) - d0))*(to - d)
      d = to
      do i = 1, 2
         if (one_way(i) > 0) first(i) = to(i)
         if (one_way(i) < 0) last(i) = to(i)
      end do
   end subroutine walk_pair

   !> `walk` for all springs at once.
   pure subroutine walk_all(n, to, d0, f0, k, one_way, d, work, first, last)
      integer, intent(in) :: n, one_way(n)
      real(wp), intent(in) :: to(n), d0(n), f0(n), k(n)
      real(wp), intent(inout) :: d(n), work(n), first(n), last(n)
      integer :: i

      do i = 1, n
         work(i) = work(i) + (f0(i) + k(i)*(0.5_wp*(to(i) + d(i)) - d0(i)))*(to(i) - d(i))
         d(i) = to(i)
         first(i) = merge(to(i), first(i), one_way(i) > 0)
         last(i) = merge(to(i), last(i), one_way(i) < 0)
      end do
   end subroutine walk_all

   !> Move every spring to a deformation on its present line.
   subroutine carry_to(self, d)
      class(spring_array), intent(inout) :: self
      !> New deformations (count) [m or rad]
      real(wp), intent(in), contiguous :: d(:)

      if (self%pressed) call press_joints(self, d)
      call walk_all(self%count, d, self%d0, self%f0, self%k, self%one_way, self%d, self%work, self%first, &
                    self%last)
   end subroutine carry_to

   !> Follow the lines of a spring until it has a given force.
   subroutine load_to(self, i, f, found)
      class(spring_array), intent(inout) :: self
      integer, intent(in) :: i
      !> Force [N or N m]
      real(wp), intent(in) :: f
      !> Whether the spring can reach it
      logical, intent(out) :: found
      real(wp) :: way, far
      integer :: lines, direction
      logical :: is_there

      found = .true.
      do lines = 1, most_lines
         way = f - self%force(i)
         if (.not. abs(way) > 0.0_wp) return
         direction = merge(1, -1, way > 0.0_wp)
         if (self%one_way(i) /= -direction) then
            associate (d0 => self%d0(i), f0 => self%f0(i), k => self%k(i))
               far = self%end_toward(i, direction)
               is_there = k > 0.0_wp .and. abs(far) >= unbounded
               if (abs(far) < unbounded) is_there = direction*(f0 + k*(far - d0) - f) >= 0.0_wp
               if (is_there) then
                  call walk(self, i, d0 + (f - f0)/k)
                  return
               end if
            end associate
            if (abs(far) >= unbounded) exit
         end if
         call self%leave(i, direction)
      end do
      found = .false.
   end subroutine load_to

   !> Mark the present state, to which `restore` returns. Only springs that change their lines are copied.
   subroutine mark(self)
      class(spring_array), intent(inout) :: self

      call self%journal%start(self%d, self%work, self%events)
   end subroutine mark

   !> Drop the mark.
   subroutine forget_mark(self)
      class(spring_array), intent(inout) :: self

      call self%journal%forget()
   end subroutine forget_mark

   !> Return to the marked state, to the last bit. The mark stays.
   subroutine restore(self)
      class(spring_array), intent(inout) :: self
      integer :: i, j

      associate (journal => self%journal)
         self%d = journal%d
         self%work = journal%work
         self%events = journal%events
         self%stuck = .false.
         if (journal%changed > 0) self%version = modulo(self%version + 1, huge(1))
         do j = 1, journal%changed
            i = journal%spring(j)
            call journal%give_back(i, self%slot(i))
            call put_line(self, i, journal%line(j))
         end do
         if (self%pressed) then
            do j = 1, size(self%layered)
               call read_plane(self, self%layered(j))
            end do
         end if
         journal%changed = 0
         where (self%one_way > 0) self%first = self%d
         where (self%one_way < 0) self%last = self%d
      end associate
   end subroutine restore

   !> Move one spring monotonically to a new deformation, over any number of lines.
   subroutine move(self, i, d)
      class(spring_array), intent(inout) :: self
      integer, intent(in) :: i
      !> New deformation [m or rad]
      real(wp), intent(in) :: d
      integer :: lines

      do lines = 1, most_lines
         if (d > self%last(i)) then
            call change_line(self, i, 1)
         else if (d < self%first(i)) then
            call change_line(self, i, -1)
         else
            call walk(self, i, d)
            return
         end if
      end do
      self%stuck = .true.
   end subroutine move

   !> Move along the present line to d; the rear end of a one-way line follows.
   pure subroutine walk(self, i, d)
      class(spring_array), intent(inout) :: self
      integer, intent(in) :: i
      !> New deformation on the present line [m or rad]
      real(wp), intent(in) :: d
      real(wp) :: f_mean

      f_mean = self%f0(i) + self%k(i)*(0.5_wp*(d + self%d(i)) - self%d0(i))
      self%work(i) = self%work(i) + f_mean*(d - self%d(i))
      self%d(i) = d
      if (self%one_way(i) > 0) then
         self%first(i) = d
      else if (self%one_way(i) < 0) then
         self%last(i) = d
      end if
   end subroutine walk

   !> Move to the end of the present line and get the line that follows from the rule. When the motion turns
   !> back, a one-way line ends at the present deformation.
   subroutine change_line(self, i, direction)
      class(spring_array), intent(inout) :: self
      integer, intent(in) :: i, direction
      type(segment) :: line

      line = line_of(self, i)
      if (self%journal%open) call self%journal%keep(i, line, self%slot(i))
      if (self%one_way(i) /= -direction) call walk(self, i, merge(line%hi, line%lo, direction > 0))
      call self%slot(i)%rule%next(line, direction)
      self%events = self%events + 1
      self%version = modulo(self%version + 1, huge(1))
      call put_line(self, i, line)
   end subroutine change_line

   !> The present line of a spring, in the form that its rule takes.
   pure type(segment) function line_of(self, i) result(line)
      class(spring_array), intent(in) :: self
      integer, intent(in) :: i

      line%d0 = self%d0(i)
      line%f0 = self%f0(i)
      line%k = self%k(i)
      line%lo = lower_end(self%first(i), self%lo_closed(i))
      line%hi = upper_end(self%last(i), self%hi_closed(i))
      if (self%one_way(i) > 0) line%lo = self%d(i)
      if (self%one_way(i) < 0) line%hi = self%d(i)
      line%lo_closed = self%lo_closed(i)
      line%hi_closed = self%hi_closed(i)
      line%one_way = self%one_way(i)
   end function line_of

   !> Store the line of a spring. At an open end the last deformation is the number next to the end.
   pure subroutine put_line(self, i, line)
      class(spring_array), intent(inout) :: self
      integer, intent(in) :: i
      type(segment), intent(in) :: line

      self%d0(i) = line%d0
      self%f0(i) = line%f0
      self%k(i) = line%k
      self%lo_closed(i) = line%lo_closed
      self%hi_closed(i) = line%hi_closed
      self%one_way(i) = line%one_way
      self%first(i) = line%lo
      self%last(i) = line%hi
      if (.not. line%lo_closed .and. line%lo > -unbounded) self%first(i) = next_above(line%lo)
      if (.not. line%hi_closed .and. line%hi < unbounded) self%last(i) = -next_above(-line%hi)
   end subroutine put_line

   !> The next larger number, as `nearest(x, 1.0)` for finite numbers. The latter is a call of the C library,
   !> and an event needs up to five of them.
   elemental real(wp) function next_above(x)
      real(wp), intent(in) :: x

      if (x > 0.0_wp) then
         next_above = transfer(transfer(x, 0_int64) + 1_int64, x)
      else if (x < 0.0_wp) then
         next_above = transfer(transfer(x, 0_int64) - 1_int64, x)
      else
         next_above = transfer(1_int64, x)
      end if
   end function next_above

   !> A spring is at an end of its line and is about to move beyond it.
   subroutine leave(self, i, direction)
      class(spring_array), intent(inout) :: self
      integer, intent(in) :: i
      !> +1: by the upper end, -1: by the lower end
      integer, intent(in) :: direction

      call change_line(self, i, direction)
      ! A new one-way line starts at the present deformation, to the last bit.
      if (self%one_way(i) > 0) self%first(i) = self%d(i)
      if (self%one_way(i) < 0) self%last(i) = self%d(i)
   end subroutine leave

   !> Put a spring exactly on the end of its line in a direction; from an open end it goes to the next line.
   subroutine arrive(self, i, direction)
      class(spring_array), intent(inout) :: self
      integer, intent(in) :: i
      integer, intent(in) :: direction
      logical :: closed

      closed = merge(self%hi_closed(i), self%lo_closed(i), direction > 0)
      call walk(self, i, self%end_toward(i, direction))
      if (.not. closed) call self%leave(i, direction)
   end subroutine arrive

   !> Forces of one virgin spring along a path.
   subroutine follow_path(spec, d, f)
      !> Validated parameters of the spring
      type(spring_record), intent(in) :: spec
      !> Deformations, one after the other (m) [m or rad]
      real(wp), intent(in) :: d(:)
      !> Forces there (m) [N or N m]; not a number where a layered joint has lost its axial load
      real(wp), intent(out) :: f(:)
      type(spring_array) :: spring
      integer :: j

      call spring%create([spec])
      do j = 1, size(d)
         call spring%move(1, d(j))
         f(j) = spring%force(1)
         if (spring%stuck .or. spring%lost_joint() > 0) f(j) = ieee_value(f(j), ieee_quiet_nan)
      end do
   end subroutine follow_path

end module rbs_hysteresis_springs
