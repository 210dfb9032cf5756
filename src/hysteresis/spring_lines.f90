!> Springs one at a time: rules off the hot path, their present branches as arrays, and a mark to return to.
module rbs_hysteresis_spring_lines
   use, intrinsic :: iso_fortran_env, only: int64
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_base_constants, only: unbounded
   use rbs_hysteresis_journal, only: journal_type
   use rbs_hysteresis_layered_joint, only: start_under
   use rbs_hysteresis_rule, only: memory_slot, spring_rules
   use rbs_hysteresis_segment, only: segment
   use rbs_hysteresis_spring_record, only: spring_record, make_rules
   implicit none
   private

   public :: spring_lines, first_on, last_on, put_line, most_lines

   !> Most lines within one move. More mean that a rule goes round in lines without length, which is an error
   !> of the rule. The longest correct move closes all open inner loops that a rule remembers.
   integer, parameter :: most_lines = 10000

   !> `count` springs in their present state. Assignment copies everything, `copy_state` what changes.
   type :: spring_lines
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
      !> The flexural spring whose work a spring decays with, 0: none (count)
      integer, allocatable :: heard(:)
      !> Work from before `work` was counted, where a step counts it from its own start (count) [J]
      real(wp), allocatable :: work_before(:)
      !> Number of lines left so far
      integer :: events = 0
      !> Changes with every new line, and in `restore`: factors computed for the lines of one version are
      !> valid while the version is the same
      integer :: version = 0
      !> Whether a rule has exceeded `most_lines`; the state must not be used then
      logical :: stuck = .false.
      !> Rules, which equal springs share; memories (count), and what `mark` has saved
      type(spring_rules) :: rules
      type(memory_slot), allocatable :: slot(:)
      type(journal_type) :: journal
   contains
      procedure, private :: create_from_rules, create_from_records
      generic :: create => create_from_rules, create_from_records
      procedure :: copy_state
      procedure :: next_branch
      procedure :: force
      procedure :: end_toward
      procedure :: move
      procedure :: advance_on_branch
      procedure :: leave
      procedure :: arrive
      procedure :: load_to
      procedure :: line_of
      procedure :: put
      procedure :: mark
      procedure :: restore
      procedure :: forget_mark
      procedure :: serialize_lines
   end type spring_lines

contains

   !> Virgin springs with rules that have been made.
   subroutine create_from_rules(self, rules, told, axial_load)
      class(spring_lines), intent(out) :: self
      type(spring_rules), intent(in) :: rules
      !> The flexural spring whose work each spring may decay with, 0: none (count)
      integer, intent(in) :: told(:)
      !> Axial load that the layers of each spring begin under, compression positive (count) [N]
      real(wp), intent(in) :: axial_load(:)
      type(segment) :: line
      integer :: i, n, before

      n = size(rules%of)
      self%count = n
      self%rules = rules
      allocate (self%slot(n), self%one_way(n), self%lo_closed(n), self%hi_closed(n))
      allocate (self%d(n), self%work(n), self%work_before(n), source=0.0_wp)
      allocate (self%d0(n), self%f0(n), self%k(n), self%first(n), self%last(n))
      allocate (self%heard(n), source=0)
      do i = 1, n
         associate (rule => rules%list(rules%of(i))%rule)
            before = max(i - 1, 1)
            if (allocated(self%slot(before)%memory) .and. rules%of(i) == rules%of(before) .and. &
                .not. abs(axial_load(i) - axial_load(before)) > 0.0_wp) then
               allocate (self%slot(i)%memory, source=self%slot(before)%memory)
            else
               call start_under(rule, axial_load(i), self%slot(i)%memory, line)
            end if
            call put_line(self, i, line)
            if (rule%uses_flexural_work) self%heard(i) = told(i)
         end associate
      end do
   end subroutine create_from_rules

   !> Virgin springs of their records.
   subroutine create_from_records(self, specs, told)
      class(spring_lines), intent(out) :: self
      !> Validated parameters of each spring
      type(spring_record), intent(in) :: specs(:)
      integer, intent(in), optional :: told(:)
      type(spring_rules) :: rules
      integer :: none(size(specs))

      none = 0
      call make_rules(specs, rules)
      if (present(told)) then
         call self%create(rules, told, specs%axial_load)
      else
         call self%create(rules, none, specs%axial_load)
      end if
   end subroutine create_from_records

   !> Take the state of other springs with the same rules, without an allocation where there is room.
   subroutine copy_state(self, other)
      class(spring_lines), intent(inout) :: self
      class(spring_lines), intent(in) :: other
      integer :: i

      self%d(:) = other%d
      self%work(:) = other%work
      self%work_before(:) = other%work_before
      self%events = other%events
      self%stuck = other%stuck
      call self%journal%forget()
      do i = 1, self%count
         call self%slot(i)%memory%copy(other%slot(i)%memory)
         call put_line(self, i, other%line_of(i))
         self%first(i) = other%first(i)
         self%last(i) = other%last(i)
      end do
      self%version = modulo(self%version + 1, huge(1))
   end subroutine copy_state

   !> The branch that follows from the rule of a spring, see `rule_type`.
   subroutine next_branch(self, i, branch, direction, flexural_work)
      class(spring_lines), intent(inout) :: self
      integer, intent(in) :: i
      type(segment), intent(inout) :: branch
      integer, intent(in) :: direction
      !> Work of the flexural spring of the joint so far [J]; for a spring that decays with it
      real(wp), intent(in) :: flexural_work

      if (self%heard(i) > 0) self%slot(i)%memory%flexural_work = flexural_work
      call self%rules%list(self%rules%of(i))%rule%next(self%slot(i)%memory, branch, direction)
   end subroutine next_branch

   !> Force of one spring at its present deformation [N or N m].
   pure real(wp) function force(self, i)
      class(spring_lines), intent(in) :: self
      integer, intent(in) :: i

      force = self%f0(i) + self%k(i)*(self%d(i) - self%d0(i))
   end function force

   !> The end of the present line in a direction, +1 or -1 [m or rad]. The rear end of a one-way line is the
   !> present deformation.
   pure real(wp) function end_toward(self, i, direction)
      class(spring_lines), intent(in) :: self
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

   !> Move one spring monotonically to a new deformation, over any number of lines.
   subroutine move(self, i, d)
      class(spring_lines), intent(inout) :: self
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
            call advance_on_branch(self, i, d)
            return
         end if
      end do
      self%stuck = .true.
   end subroutine move

   !> Move along the present line to d; the rear end of a one-way line follows.
   pure subroutine advance_on_branch(self, i, d)
      class(spring_lines), intent(inout) :: self
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
   end subroutine advance_on_branch

   !> Move to the end of the present line and get the line that follows from the rule. When the motion turns
   !> back, a one-way line ends at the present deformation.
   subroutine change_line(self, i, direction)
      class(spring_lines), intent(inout) :: self
      integer, intent(in) :: i, direction
      type(segment) :: line
      real(wp) :: flexural_work

      line = self%line_of(i)
      if (self%journal%open) call self%journal%keep(i, line, self%slot(i))
      if (self%one_way(i) /= -direction) call advance_on_branch(self, i, merge(line%hi, line%lo, direction > 0))
      flexural_work = 0.0_wp
      associate (j => self%heard(i))
         if (j > 0) flexural_work = self%work_before(j) + self%work(j)
      end associate
      call self%next_branch(i, line, direction, flexural_work)
      self%events = self%events + 1
      self%version = modulo(self%version + 1, huge(1))
      call put_line(self, i, line)
   end subroutine change_line

   !> A spring is at an end of its line and is about to move beyond it.
   subroutine leave(self, i, direction)
      class(spring_lines), intent(inout) :: self
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
      class(spring_lines), intent(inout) :: self
      integer, intent(in) :: i
      integer, intent(in) :: direction
      logical :: closed

      closed = merge(self%hi_closed(i), self%lo_closed(i), direction > 0)
      call advance_on_branch(self, i, self%end_toward(i, direction))
      if (.not. closed) call self%leave(i, direction)
   end subroutine arrive

   !> Follow the lines of a spring until it has a given force.
   subroutine load_to(self, i, f, found)
      class(spring_lines), intent(inout) :: self
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
                  call advance_on_branch(self, i, d0 + (f - f0)/k)
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
      class(spring_lines), intent(inout) :: self

      call self%journal%start(self%d, self%work, self%events)
   end subroutine mark

   !> Drop the mark.
   subroutine forget_mark(self)
      class(spring_lines), intent(inout) :: self

      call self%journal%forget()
   end subroutine forget_mark

   !> Return to the marked state, to the last bit. The mark stays.
   subroutine restore(self)
      class(spring_lines), intent(inout) :: self
      integer :: i, j

      associate (journal => self%journal)
         do i = 1, self%count
            self%d(i) = journal%d(i)
            self%work(i) = journal%work(i)
         end do
         self%events = journal%events
         self%stuck = .false.
         if (journal%changed > 0) self%version = modulo(self%version + 1, huge(1))
         do j = 1, journal%changed
            i = journal%spring(j)
            call journal%give_back(i, self%slot(i))
            call put_line(self, i, journal%line(j))
         end do
         journal%changed = 0
         do i = 1, self%count
            if (self%one_way(i) > 0) self%first(i) = self%d(i)
            if (self%one_way(i) < 0) self%last(i) = self%d(i)
         end do
      end associate
   end subroutine restore

   !> Save or restore where the springs are, and what their rules remember.
   subroutine serialize_lines(self, stream)
      class(spring_lines), intent(inout) :: self
      type(stream_type), intent(inout) :: stream
      integer :: i

      call stream%item(self%d)
      call stream%item(self%d0)
      call stream%item(self%f0)
      call stream%item(self%k)
      call stream%item(self%first)
      call stream%item(self%last)
      call stream%item(self%work)
      call stream%item(self%lo_closed)
      call stream%item(self%hi_closed)
      do i = 1, self%count
         call stream%item(self%one_way(i))
         call self%slot(i)%memory%serialize(stream)
      end do
      self%version = modulo(self%version + 1, huge(1))
   end subroutine serialize_lines

   !> The present line of a spring, in the form that its rule takes.
   pure type(segment) function line_of(self, i) result(line)
      class(spring_lines), intent(in) :: self
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

   !> Store the line of a spring.
   pure subroutine put_line(self, i, line)
      class(spring_lines), intent(inout) :: self
      integer, intent(in) :: i
      type(segment), intent(in) :: line

      self%d0(i) = line%d0
      self%f0(i) = line%f0
      self%k(i) = line%k
      self%lo_closed(i) = line%lo_closed
      self%hi_closed(i) = line%hi_closed
      self%one_way(i) = line%one_way
      self%first(i) = first_on(line)
      self%last(i) = last_on(line)
   end subroutine put_line

   !> Put a spring on a line that was found elsewhere, at d.
   pure subroutine put(self, i, line, d, work)
      class(spring_lines), intent(inout) :: self
      integer, intent(in) :: i
      type(segment), intent(in) :: line
      !> Deformation [m or rad], and work done so far [J]
      real(wp), intent(in) :: d, work

      call put_line(self, i, line)
      self%d(i) = d
      self%work(i) = work
      if (line%one_way > 0) self%first(i) = d
      if (line%one_way < 0) self%last(i) = d
      self%version = modulo(self%version + 1, huge(1))
   end subroutine put

   !> The first and the last deformation that belong to a line. At an open end it is the number next to it.
   pure real(wp) function first_on(line)
      type(segment), intent(in) :: line

      first_on = line%lo
      if (.not. line%lo_closed .and. line%lo > -unbounded) first_on = next_above(line%lo)
   end function first_on

   pure real(wp) function last_on(line)
      type(segment), intent(in) :: line

      last_on = line%hi
      if (.not. line%hi_closed .and. line%hi < unbounded) last_on = -next_above(-line%hi)
   end function last_on

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

end module rbs_hysteresis_spring_lines
