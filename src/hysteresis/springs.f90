!> The springs of a structure: rules off the hot path, their present branches as plain arrays on it, and a
!> mark to return to.
module rbs_hysteresis_springs
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
   use rbs_base_constants, only: unbounded, out_of_bounds
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_hysteresis_journal, only: journal_type, block_length
   use rbs_hysteresis_layer_joints, only: layer_joints
   use rbs_hysteresis_layered_fibre_path, only: go
   use rbs_hysteresis_layered_fibre_section, only: fibre_section
   use rbs_hysteresis_rule, only: spring_slot, spring_rules
   use rbs_hysteresis_segment, only: segment, lowest_on, highest_on, upper_end, lower_end
   use rbs_hysteresis_spring_record, only: spring_record, add_rules
   implicit none
   private

   public :: spring_array, put_line, read_plane, follow_path, most_lines

   !> Most lines within one move. More mean that a rule cycles through lines without length, which is an error
   !> of the rule. The longest correct move closes all open inner loops in the memory of a rule.
   integer, parameter :: most_lines = 10000

   !> `count` springs in their present state. Assignment copies everything.
   type :: spring_array
      !> Number of springs
      integer :: count = 0
      !> Present deformations (count) [m or rad], and behind them further coordinates of the structure, which
      !> moves as they do; present line: anchor and slope (count)
      real(wp), allocatable :: d(:), d0(:), f0(:), k(:)
      !> Lowest and highest deformation that belong to the present line (count). Where the end itself does not
      !> belong to it, they are the numbers next to it.
      real(wp), allocatable :: lower(:), upper(:)
      !> Whether the ends themselves belong to the line (count), see `segment`
      logical, allocatable :: includes_lower_end(:), includes_upper_end(:)
      !> Direction of a branch that unloads on reversal, else 0 (count), see `segment`
      integer, allocatable :: unload_on_reversal(:)
      !> Work done on each spring along its path, exact (count) [J]
      real(wp), allocatable :: work(:)
      !> First and last of the springs whose work a spring decays with, 0: none (2, count)
      integer, allocatable :: work_source(:, :)
      !> Work from before `work` was counted, where a step counts it from its own start (count) [J]
      real(wp), allocatable :: work_before(:)
      !> Number of lines left so far
      integer :: events = 0
      !> Changes with every new stiffness: factors computed for one version are valid while it is the same
      integer :: version = 0
      !> Whether a rule has exceeded `most_lines`; the state must not be used then
      logical :: stuck = .false.
      !> Rules, which equal springs share, of the structure; rule and memory of each spring (count), and
      !> the memory that `mark` has saved
      type(spring_rules), pointer :: rules => null()
      type(spring_slot), allocatable :: slot(:)
      type(journal_type) :: journal
      !> Springs that `choose_lines` takes to a turning point first, the first `turned` elements, and these
      !> points (count) [m or rad]
      integer :: turned = 0
      integer, allocatable :: turning(:)
      real(wp), allocatable :: turning_point(:)
      !> Layered joints among the springs, and whether their axial loads vary along the path: then they follow
      !> straight paths in rotation and axial load, and are on planes where other springs are on lines, see
      !> `rbs_hysteresis_interaction_joints`
      integer, allocatable :: layered(:)
      logical :: axial_load_varies = .false.
      !> Whether a spring is on a plane (count)
      logical, allocatable :: on_plane(:)
      !> Where they vary (count): axial load that the joint is to reach, axial load of the present plane
      !> [N], and its centre of stiffness e = -dM/dN [m]
      real(wp), allocatable :: target_axial_load(:), reference_axial_load(:), centre(:)
      !> Joints whose layers are springs
      type(layer_joints) :: joints
   contains
      procedure :: create, restart, force, forces, find_forces, find_resistance, end_toward, advance_to
      procedure :: advance_on_branch, leave, arrive, load_to, line_of, set_stiffness, put, release, is_removed
      procedure :: mark, restore, choose_lines, retry, turn_at, forget_mark, serialize, move_all, carry_to
      procedure :: stay_on_lines, crushed_joint, fit_planes
   end type spring_array

contains

   !> Virgin springs with rules that have been made.
   subroutine create(self, rules, work_source, axial_load, coordinates, joints)
      class(spring_array), intent(out) :: self
      !> The rules are not copied: they must be there as long as the springs
      type(spring_rules), intent(in), target :: rules
      !> First and last of the springs whose work each spring may decay with, 0: none (2, count)
      integer, intent(in) :: work_source(:, :)
      !> Axial load that the layers of each spring begin under, compression positive (count) [N]
      real(wp), intent(in) :: axial_load(:)
      !> Numbers that `d` has, as many as springs or more
      integer, intent(in) :: coordinates
      !> Joints whose layers are springs
      type(layer_joints), intent(in), optional :: joints
      type(segment) :: line
      integer :: i, n, before

      n = size(rules%of)
      if (present(joints)) self%joints = joints
      self%count = n
      self%rules => rules
      allocate (self%slot(n), self%unload_on_reversal(n), self%includes_lower_end(n), &
                self%includes_upper_end(n))
      allocate (self%d(coordinates), self%work(n), self%work_before(n), source=0.0_wp)
      allocate (self%d0(n), self%f0(n), self%lower(n), self%upper(n))
      allocate (self%k(n), source=0.0_wp)
      allocate (self%work_source(2, n), source=0)
      allocate (self%on_plane(n), source=.false.)
      allocate (self%layered(0))
      do i = 1, n
         self%slot(i)%rule => rules%list(rules%of(i))%rule
         associate (rule => self%slot(i)%rule)
            ! Equal springs often follow each other: the memory of the one before is copied, and `line` is
            ! still its line.
            before = max(i - 1, 1)
            if (allocated(self%slot(before)%memory) .and. rules%of(i) == rules%of(before) .and. &
                .not. abs(axial_load(i) - axial_load(before)) > 0.0_wp) then
               allocate (self%slot(i)%memory, source=self%slot(before)%memory)
            else
               call rule%start(axial_load(i), self%slot(i)%memory, line)
            end if
            call put_line(self, i, line)
            if (rule%uses_flexural_work) self%work_source(:, i) = work_source(:, i)
            self%slot(i)%needs_flexural_work = self%work_source(1, i) > 0
         end associate
         select type (section => self%slot(i)%memory)
         type is (fibre_section)
            self%layered = [self%layered, i]
         end select
      end do
      call sum_up_joints(self, self%d)
   end subroutine create

   !> The same springs, virgin once more; their axial loads do not vary.
   subroutine restart(self, axial_load)
      class(spring_array), intent(inout) :: self
      !> As in `create`
      real(wp), intent(in) :: axial_load(:)
      type(segment) :: line
      integer :: i

      self%d = 0.0_wp
      self%work = 0.0_wp
      self%events = 0
      self%stuck = .false.
      do i = 1, self%count
         call self%slot(i)%rule%start(axial_load(i), self%slot(i)%memory, line)
         call put_line(self, i, line)
      end do
      call sum_up_joints(self, self%d)
   end subroutine restart

   !> Force of one spring at its present deformation [N or N m].
   pure real(wp) function force(self, i)
      class(spring_array), intent(in) :: self
      integer, intent(in) :: i

      force = self%f0(i) + self%k(i)*(self%d(i) - self%d0(i))
   end function force

   !> Forces of all springs in a position on their present lines (count), see `find_forces`.
   pure function forces(self, d) result(f)
      class(spring_array), intent(in) :: self
      real(wp), intent(in), contiguous :: d(:)
      real(wp) :: f(self%count)

      call self%find_forces(d, f)
   end function forces

   !> Forces in a position on the present lines [N or N m]. A joint of layers has its axial force and its
   !> moment in the places of its first two layers; the elements of its other layers are not touched.
   pure subroutine find_forces(self, d, f)
      class(spring_array), intent(in) :: self
      !> Deformations (count) [m or rad], behind them further coordinates; forces (count)
      real(wp), intent(in), contiguous :: d(:)
      real(wp), intent(inout), contiguous :: f(:)
      integer :: i, j

      if (self%joints%count == 0) then
         call on_lines(self%count, self%d0, self%f0, self%k, d, f)
         return
      end if
      do j = 1, size(self%joints%others)
         i = self%joints%others(j)
         f(i) = self%f0(i) + self%k(i)*(d(i) - self%d0(i))
      end do
      call self%joints%forces(d, f)
   end subroutine find_forces

   !> Forces of n springs on the lines f0 + k (d - d0), on bare arrays.
   pure subroutine on_lines(n, d0, f0, k, d, f)
      integer, intent(in) :: n
      real(wp), intent(in) :: d0(n), f0(n), k(n), d(n)
      real(wp), intent(out) :: f(n)

      f = f0 + k*(d - d0)
   end subroutine on_lines

   !> Forces that a change of the position causes, in the places of `find_forces`, if each spring had the
   !> stiffness k.
   pure subroutine find_resistance(self, k, change, f)
      class(spring_array), intent(in) :: self
      !> Stiffnesses (count) [N/m or N m/rad]; change of the position (coordinates) [m or rad]
      real(wp), intent(in), contiguous :: k(:), change(:)
      real(wp), intent(out), contiguous :: f(:)
      type(layer_joints) :: joints
      integer :: j

      f = k*change(:self%count)
      if (self%joints%count == 0) return
      ! The sums of a copy of the joints, on lines through zero: f, set to zero there, serves as d0 and f0.
      joints = self%joints
      joints%anchor = 0.0_wp
      do j = 1, joints%count
         f(joints%first(j):joints%last(j)) = 0.0_wp
         call joints%sum_up(j, f, f, k)
      end do
      call joints%forces(change, f)
   end subroutine find_resistance

   !> Find the sums of the joints whose layers have changed their lines.
   pure subroutine sum_up_joints(self, d)
      type(spring_array), intent(inout) :: self
      !> Position whose motions become the anchors (coordinates)
      real(wp), intent(in), contiguous :: d(:)
      integer :: j

      do j = 1, self%joints%count
         if (self%joints%is_changed(j)) call sum_up_joint(self, j, d)
      end do
   end subroutine sum_up_joints

   !> Find the sums of one joint on the present lines of its layers, with its motion in a position as anchor.
   pure subroutine sum_up_joint(self, joint, d)
      type(spring_array), intent(inout) :: self
      integer, intent(in) :: joint
      !> (coordinates)
      real(wp), intent(in), contiguous :: d(:)

      self%joints%anchor(:, joint) = self%joints%motion(joint, d)
      call self%joints%sum_up(joint, self%d0, self%f0, self%k)
   end subroutine sum_up_joint

   !> Find the sums of the joint that spring i is a layer of, if it is one.
   pure subroutine sum_up_joint_of(self, i)
      type(spring_array), intent(inout) :: self
      integer, intent(in) :: i

      if (self%joints%count == 0) return
      if (self%joints%of(i) > 0) call sum_up_joint(self, self%joints%of(i), self%d)
   end subroutine sum_up_joint_of

   !> Let the line of a spring have another stiffness, for a virtual motion.
   pure subroutine set_stiffness(self, i, k)
      class(spring_array), intent(inout) :: self
      integer, intent(in) :: i
      real(wp), intent(in) :: k

      self%k(i) = k
      call sum_up_joint_of(self, i)
   end subroutine set_stiffness

   !> The end of the present line in a direction, +1 or -1 [m or rad]. The rear end of one that unloads on
   !> reversal is the present deformation.
   pure real(wp) function end_toward(self, i, direction)
      class(spring_array), intent(in) :: self
      integer, intent(in) :: i, direction

      if (self%unload_on_reversal(i) == -direction) then
         end_toward = self%d(i)
      else if (direction > 0) then
         end_toward = upper_end(self%upper(i), self%includes_upper_end(i))
      else
         end_toward = lower_end(self%lower(i), self%includes_lower_end(i))
      end if
   end function end_toward

   !> Move one spring monotonically to a new deformation, over any number of lines.
   subroutine advance_to(self, i, d)
      class(spring_array), intent(inout) :: self
      integer, intent(in) :: i
      !> New deformation [m or rad]
      real(wp), intent(in) :: d
      integer :: lines

      do lines = 1, most_lines
         if (d > self%upper(i)) then
            call change_line(self, i, 1)
         else if (d < self%lower(i)) then
            call change_line(self, i, -1)
         else
            call advance_on_branch(self, i, d)
            return
         end if
      end do
      self%stuck = .true.
   end subroutine advance_to

   !> Move along the present line to d; the rear end of one that unloads on reversal follows.
   pure subroutine advance_on_branch(self, i, d)
      class(spring_array), intent(inout) :: self
      integer, intent(in) :: i
      !> New deformation on the present line [m or rad]
      real(wp), intent(in) :: d
      real(wp) :: f_mean

      f_mean = self%f0(i) + self%k(i)*(0.5_wp*(d + self%d(i)) - self%d0(i))
      self%work(i) = self%work(i) + f_mean*(d - self%d(i))
      self%d(i) = d
      call follow_rear_end(self, i)
   end subroutine advance_on_branch

   !> Move to the end of the present line and get the line that follows from the rule. When the motion turns
   !> back, one that unloads on reversal ends at the present deformation.
   subroutine change_line(self, i, direction)
      class(spring_array), intent(inout) :: self
      !> Spring; +1: it leaves by the upper end, -1: by the lower end
      integer, intent(in) :: i, direction
      type(segment) :: line
      real(wp) :: flexural_work

      line = self%line_of(i)
      if (self%journal%open) then
         call self%journal%keep(i, self%d(i), self%work(i), line, self%slot(i))
         call self%journal%leave_branch(i, direction, merge(self%upper(i), self%lower(i), direction > 0))
      end if
      ! On a reversal it stays where it is.
      if (self%unload_on_reversal(i) /= -direction) call advance_on_branch(self, i, &
           merge(line%hi, line%lo, direction > 0))
      flexural_work = 0.0_wp
      associate (first => self%work_source(1, i), last => self%work_source(2, i))
         if (first > 0) flexural_work = sum(self%work_before(first:last) + self%work(first:last))
      end associate
      call self%slot(i)%next_branch(line, direction, flexural_work)
      self%events = self%events + 1
      call put_line(self, i, line)
      if (self%journal%open) call self%journal%enter_branch(i, self%d(i), self%work(i))
   end subroutine change_line

   !> A spring is at an end of its line and is about to move beyond it.
   subroutine leave(self, i, direction)
      class(spring_array), intent(inout) :: self
      integer, intent(in) :: i
      !> +1: by the upper end, -1: by the lower end
      integer, intent(in) :: direction

      call change_line(self, i, direction)
      ! Direction 0: `choose_lines` does not let this spring enter its branch again as before.
      if (self%journal%open) self%journal%direction(i) = 0
      ! A branch that unloads on reversal starts at the present deformation, to the last bit.
      call follow_rear_end(self, i)
      call sum_up_joint_of(self, i)
   end subroutine leave

   !> Put a spring exactly on the end of its line in a direction; from an open end it takes the next line.
   subroutine arrive(self, i, direction)
      class(spring_array), intent(inout) :: self
      !> Spring; +1: upper end, -1: lower end
      integer, intent(in) :: i, direction
      logical :: closed

      closed = merge(self%includes_upper_end(i), self%includes_lower_end(i), direction > 0)
      call advance_on_branch(self, i, self%end_toward(i, direction))
      if (.not. closed) call self%leave(i, direction)
   end subroutine arrive

   !> Follow the lines of a spring until it has a given force.
   subroutine load_to(self, i, f, found)
      class(spring_array), intent(inout) :: self
      integer, intent(in) :: i
      !> Force [N or N m]
      real(wp), intent(in) :: f
      !> Whether the spring can reach it
      logical, intent(out) :: found
      real(wp) :: rise, far
      integer :: lines, direction
      logical :: is_there

      found = .true.
      do lines = 1, most_lines
         rise = f - self%force(i)
         if (.not. abs(rise) > 0.0_wp) return
         direction = merge(1, -1, rise > 0.0_wp)
         if (self%unload_on_reversal(i) /= -direction) then
            associate (d0 => self%d0(i), f0 => self%f0(i), k => self%k(i))
               far = self%end_toward(i, direction)
               ! Whether the force is on this line, which may have no end.
               is_there = k > 0.0_wp .and. abs(far) >= unbounded
               if (abs(far) < unbounded) is_there = direction*(f0 + k*(far - d0) - f) >= 0.0_wp
               if (is_there) then
                  call advance_on_branch(self, i, d0 + (f - f0)/k)
                  return
               end if
            end associate
            ! The line has no end, and the force is not on it.
            if (abs(far) >= unbounded) exit
         end if
         call self%leave(i, direction)
      end do
      found = .false.
   end subroutine load_to

   !> Mark the present state, to which `restore` returns. Only springs that change their lines are copied as
   !> wholes.
   subroutine mark(self)
      class(spring_array), intent(inout) :: self

      call self%journal%start(size(self%d), self%count, self%events)
      call self%journal%save_all(self%d, self%work)
   end subroutine mark

   !> From now on `choose_lines` takes a spring to a turning point first, and from there to its deformation.
   subroutine turn_at(self, i, d)
      class(spring_array), intent(inout) :: self
      integer, intent(in) :: i
      !> The turning point [m or rad]
      real(wp), intent(in) :: d

      if (.not. allocated(self%turning)) allocate (self%turning(self%count), self%turning_point(self%count))
      self%turned = self%turned + 1
      self%turning(self%turned) = i
      self%turning_point(self%turned) = d
      self%journal%direction(i) = 0
   end subroutine turn_at

   !> Drop the mark.
   subroutine forget_mark(self)
      class(spring_array), intent(inout) :: self

      call self%journal%forget()
      self%turned = 0
   end subroutine forget_mark

   !> Return to the marked state, to the last bit. The mark stays.
   subroutine restore(self)
      class(spring_array), intent(inout) :: self

      call go_back(self)
      call sum_up_joints(self, self%d)
   end subroutine restore

   !> Put the springs on the lines that they have at new deformations, each in one direction from the mark,
   !> which is the present state if there is none, or by its turning point. Those that stay on their lines are
   !> not moved; `carry_to` moves all. A spring that passes through the same branches as in the last move
   !> enters the last of them again; the state is the same to the last bit.
   subroutine choose_lines(self, d)
      class(spring_array), intent(inout) :: self
      !> New deformations and the coordinates behind them [m or rad]
      real(wp), intent(in), contiguous :: d(:)
      logical :: again
      integer :: j

      again = self%journal%open
      if (self%axial_load_varies) then
         ! The ways of joints depend on their axial loads too, so no branch is entered again.
         if (again) call go_back(self)
         if (.not. again) call self%mark()
         call self%move_all(d)
         return
      end if
      if (again) then
         call go_back(self, d)
      else
         call self%journal%start(size(self%d), self%count, self%events)
      end if
      do j = 1, self%turned
         call self%advance_to(self%turning(j), self%turning_point(j))
         self%journal%direction(self%turning(j)) = 0
      end do
      call leave_lines(self, d, again)
      do j = 1, self%turned
         self%journal%direction(self%turning(j)) = 0
      end do
      if (.not. self%stuck) call sum_up_joints(self, d)
   end subroutine choose_lines

   !> Move every spring from the mark to new deformations.
   subroutine retry(self, d)
      class(spring_array), intent(inout) :: self
      !> New deformations and the coordinates behind them [m or rad]
      real(wp), intent(in), contiguous :: d(:)

      call self%choose_lines(d)
      if (.not. (self%stuck .or. self%axial_load_varies)) call advance_all(self, d)
   end subroutine retry

   !> Move the springs that leave their lines on the way to new deformations, one after the other. Most stay:
   !> they are looked at by blocks.
   subroutine leave_lines(self, d, again)
      type(spring_array), intent(inout) :: self
      !> New deformations (count) [m or rad]
      real(wp), intent(in), contiguous :: d(:)
      !> Whether those that have kept their branches enter these again
      logical, intent(in) :: again
      logical :: on_lines, enters
      integer :: first, last, kept, i

      kept = 0
      do first = 1, self%count, block_length
         last = min(first + block_length - 1, self%count)
         on_lines = are_on_lines(last - first + 1, d(first:), self%lower(first:), self%upper(first:))
         if (again) kept = self%journal%in_block((first - 1)/block_length + 1)
         if (on_lines .and. kept == 0) cycle
         do i = first, last
            enters = .false.
            if (kept > 0) enters = self%journal%is_kept(i) .and. self%journal%direction(i) /= 0
            if (enters) then
               call enter_again(self, i)
            else if (on_lines) then
               cycle
            else if (d(i) <= self%upper(i) .and. d(i) >= self%lower(i)) then
               cycle
            end if
            call self%advance_to(i, d(i))
         end do
      end do
   end subroutine leave_lines

   !> Whether n springs at new deformations are on their lines.
   pure logical function are_on_lines(n, d, lower, upper)
      integer, intent(in) :: n
      !> Deformations, and the lowest and highest of each line [m or rad]
      real(wp), intent(in) :: d(n), lower(n), upper(n)
      real(wp) :: beyond
      integer :: i

      beyond = 0.0_wp
      !$omp simd reduction(max:beyond)
      do i = 1, n
         beyond = max(beyond, d(i) - upper(i), lower(i) - d(i))
      end do
      are_on_lines = .not. beyond > 0.0_wp
   end function are_on_lines

   !> Put spring i, which is at the mark, where it entered its present branch in the last move; the branches
   !> on this way count as left again.
   pure subroutine enter_again(self, i)
      type(spring_array), intent(inout) :: self
      integer, intent(in) :: i

      self%d(i) = self%journal%d_entered(i)
      self%work(i) = self%journal%work_entered(i)
      self%events = self%events + self%journal%branches(i)
      call follow_rear_end(self, i)
   end subroutine enter_again

   !> Return to the mark. Of springs that pass their present branch again on the way to new deformations,
   !> branch and memory stay.
   subroutine go_back(self, d)
      type(spring_array), intent(inout) :: self
      !> New deformations (count) [m or rad]; without them every spring returns
      real(wp), intent(in), contiguous, optional :: d(:)
      logical :: stays
      integer :: i, j, left

      associate (journal => self%journal)
         if (journal%whole) then
            self%d(:) = journal%d
            self%work(:) = journal%work
         end if
         self%events = journal%events
         self%stuck = .false.
         left = 0
         do j = 1, journal%changed
            i = journal%spring(j)
            self%d(i) = journal%d(i)
            self%work(i) = journal%work(i)
            ! A spring that decays with the work of others depends on their ways.
            stays = present(d) .and. .not. self%slot(i)%needs_flexural_work
            if (stays) stays = journal%passes_again(i, d(i))
            if (stays) then
               left = left + 1
               journal%spring(left) = i
               journal%line(left) = journal%line(j)
            else
               call journal%give_back(i, self%slot(i))
               call put_line(self, i, journal%line(j))
               call follow_rear_end(self, i)
            end if
         end do
         journal%changed = left
         ! Springs on one-way lines that have moved without leaving them
         if (journal%whole) then
            do i = 1, self%count
               call follow_rear_end(self, i)
            end do
         end if
      end associate
      if (self%axial_load_varies) call self%fit_planes()
   end subroutine go_back

   !> Let the rear end of a line that unloads on reversal be the present deformation.
   pure subroutine follow_rear_end(self, i)
      type(spring_array), intent(inout) :: self
      integer, intent(in) :: i

      if (self%unload_on_reversal(i) > 0) self%lower(i) = self%d(i)
      if (self%unload_on_reversal(i) < 0) self%upper(i) = self%d(i)
   end subroutine follow_rear_end

   !> Save or restore the deformations, lines and works of the springs and the memory of their rules.
   subroutine serialize(self, stream)
      class(spring_array), intent(inout) :: self
      type(stream_type), intent(inout) :: stream
      integer :: i

      call stream%item(self%d)
      call stream%item(self%d0)
      call stream%item(self%f0)
      call stream%item(self%k)
      call stream%item(self%lower)
      call stream%item(self%upper)
      call stream%item(self%work)
      call stream%item(self%includes_lower_end)
      call stream%item(self%includes_upper_end)
      do i = 1, self%count
         call stream%item(self%unload_on_reversal(i))
         call self%slot(i)%memory%serialize(stream)
      end do
      self%version = modulo(self%version + 1, huge(1))
      if (self%joints%count > 0) call stream%item(self%joints%anchor)
      do i = 1, self%joints%count
         call self%joints%sum_up(i, self%d0, self%f0, self%k)
      end do
      if (.not. (self%axial_load_varies .and. stream%restoring)) return
      call self%fit_planes()
      self%target_axial_load(:) = self%reference_axial_load
   end subroutine serialize

   !> The present line of a spring, in the form that its rule takes.
   pure type(segment) function line_of(self, i) result(line)
      class(spring_array), intent(in) :: self
      integer, intent(in) :: i

      line%d0 = self%d0(i)
      line%f0 = self%f0(i)
      line%k = self%k(i)
      line%lo = lower_end(self%lower(i), self%includes_lower_end(i))
      line%hi = upper_end(self%upper(i), self%includes_upper_end(i))
      if (self%unload_on_reversal(i) > 0) line%lo = self%d(i)
      if (self%unload_on_reversal(i) < 0) line%hi = self%d(i)
      line%includes_lower_end = self%includes_lower_end(i)
      line%includes_upper_end = self%includes_upper_end(i)
      line%unload_on_reversal = self%unload_on_reversal(i)
   end function line_of

   !> Store the line of a spring.
   pure subroutine put_line(self, i, line)
      class(spring_array), intent(inout) :: self
      integer, intent(in) :: i
      type(segment), intent(in) :: line

      if (abs(line%k - self%k(i)) > 0.0_wp) self%version = modulo(self%version + 1, huge(1))
      self%d0(i) = line%d0
      self%f0(i) = line%f0
      self%k(i) = line%k
      self%includes_lower_end(i) = line%includes_lower_end
      self%includes_upper_end(i) = line%includes_upper_end
      self%unload_on_reversal(i) = line%unload_on_reversal
      self%lower(i) = lowest_on(line)
      self%upper(i) = highest_on(line)
      if (self%joints%count == 0) return
      if (self%joints%of(i) > 0) self%joints%is_changed(self%joints%of(i)) = .true.
   end subroutine put_line

   !> Put spring i on a given line at the deformation d.
   pure subroutine put(self, i, line, d, work)
      class(spring_array), intent(inout) :: self
      integer, intent(in) :: i
      type(segment), intent(in) :: line
      !> Deformation [m or rad], and work done so far [J]
      real(wp), intent(in) :: d, work

      call put_line(self, i, line)
      self%d(i) = d
      self%work(i) = work
      call follow_rear_end(self, i)
      call sum_up_joint_of(self, i)
   end subroutine put

   !> Let spring i have a constant force from now on.
   pure subroutine release(self, i, force)
      class(spring_array), intent(inout) :: self
      integer, intent(in) :: i
      !> [N or N m]
      real(wp), intent(in) :: force

      call self%put(i, segment(f0=force), self%d(i), self%work(i))
   end subroutine release

   !> Whether the member of spring i was removed, so that `release` has given the spring a line without
   !> stiffness and without ends, which no rule has.
   pure logical function is_removed(self, i)
      class(spring_array), intent(in) :: self
      integer, intent(in) :: i

      is_removed = .not. abs(self%k(i)) > 0.0_wp .and. self%lower(i) <= -unbounded .and. &
                    self%upper(i) >= unbounded .and. self%unload_on_reversal(i) == 0
   end function is_removed

   !> Move every spring to a new deformation.
   subroutine move_all(self, d)
      class(spring_array), intent(inout) :: self
      !> New deformations (count) [m or rad]
      real(wp), intent(in), contiguous :: d(:)

      if (self%journal%open .and. .not. self%journal%whole) call self%journal%save_all(self%d, self%work)
      if (self%axial_load_varies) call move_joints(self, d)
      if (size(self%d) == 2) then
         ! One body: while both springs stay on their lines, neither a loop nor a call is needed.
         if (d(1) <= self%upper(1) .and. d(1) >= self%lower(1) .and. &
             d(2) <= self%upper(2) .and. d(2) >= self%lower(2)) then
            call advance_pair(d, self%d0, self%f0, self%k, self%unload_on_reversal, self%d, self%work, &
                              self%lower, self%upper)
            return
         end if
      end if
      call leave_lines(self, d, again=.false.)
      if (self%stuck) return
      ! The others move along their lines; a spring that has arrived stays where it is.
      call advance_all(self, d)
      call sum_up_joints(self, self%d)
   end subroutine move_all

   !> Whether all springs can go to a new position on their present lines, with no deformation of
   !> `out_of_bounds` or more. Where axial loads vary the answer is no.
   logical function stay_on_lines(self, d)
      class(spring_array), intent(inout) :: self
      !> New position (coordinates) [m or rad]; deformations of layers are found from those of their joints
      real(wp), intent(in), contiguous :: d(:)
      integer :: i, j

      stay_on_lines = .not. self%axial_load_varies
      if (.not. stay_on_lines) return
      if (self%joints%count == 0) then
         stay_on_lines = are_within(self%count, d, self%lower, self%upper)
         return
      end if
      do j = 1, size(self%joints%others)
         i = self%joints%others(j)
         stay_on_lines = d(i) <= self%upper(i) .and. d(i) >= self%lower(i) .and. abs(d(i)) < out_of_bounds
         if (.not. stay_on_lines) return
      end do
      call self%joints%stay_on_lines(d, self%lower, self%upper, self%unload_on_reversal, stay_on_lines)
   end function stay_on_lines

   !> Move every spring to a deformation on its present line.
   subroutine carry_to(self, d)
      class(spring_array), intent(inout) :: self
      !> New deformations (count) [m or rad]
      real(wp), intent(in), contiguous :: d(:)

      if (self%journal%open .and. .not. self%journal%whole) call self%journal%save_all(self%d, self%work)
      if (self%axial_load_varies) call move_joints(self, d)
      if (size(self%d) == 2) then
         call advance_pair(d, self%d0, self%f0, self%k, self%unload_on_reversal, self%d, self%work, &
                           self%lower, self%upper)
         return
      end if
      call advance_all(self, d)
   end subroutine carry_to

   !> Whether deformations are on their lines, and none is out of bounds.
   pure logical function are_within(n, d, lower, upper)
      integer, intent(in) :: n
      !> Deformations, and the lowest and highest of each line [m or rad]
      real(wp), intent(in) :: d(n), lower(n), upper(n)
      real(wp) :: outside, beyond
      integer :: i

      outside = 0.0_wp
      !$omp simd reduction(max:outside) private(beyond)
      do i = 1, n
         ! One comparison, so that no branch keeps the loop from vectors.
         beyond = max(d(i) - upper(i), lower(i) - d(i), abs(d(i)) - out_of_bounds)
         outside = max(outside, merge(0.0_wp, 1.0_wp, beyond <= 0.0_wp))
      end do
      are_within = .not. outside > 0.0_wp
   end function are_within

   !> `advance_on_branch` for the two springs of one body, to the deformations `to`.
   pure subroutine advance_pair(to, d0, f0, k, unload_on_reversal, d, work, lower, upper)
      integer, intent(in) :: unload_on_reversal(2)
      real(wp), intent(in) :: to(2), d0(2), f0(2), k(2)
      real(wp), intent(inout) :: d(2), work(2), lower(2), upper(2)
      integer :: i

      work = work + (f0 + k*(0.5_wp*(to + d) - d0))*(to - d)
      d = to
      do i = 1, 2
         if (unload_on_reversal(i) > 0) lower(i) = to(i)
         if (unload_on_reversal(i) < 0) upper(i) = to(i)
      end do
   end subroutine advance_pair

   !> `advance_on_branch` for all springs at once, and the coordinates behind them.
   pure subroutine advance_all(self, d)
      type(spring_array), intent(inout) :: self
      !> New deformations (count), perhaps with the coordinates behind them [m or rad]
      real(wp), intent(in), contiguous :: d(:)

      call advance_each(self%count, d, self%d0, self%f0, self%k, self%unload_on_reversal, self%d, self%work, &
                        self%lower, self%upper)
      if (size(d) > self%count) self%d(self%count + 1:) = d(self%count + 1:)
   end subroutine advance_all

   !> Move n springs along their lines to the deformations `to`, with their works; lines that unload on
   !> reversal then begin where the springs are.
   pure subroutine advance_each(n, to, d0, f0, k, unload_on_reversal, d, work, lower, upper)
      integer, intent(in) :: n, unload_on_reversal(n)
      real(wp), intent(in) :: to(n), d0(n), f0(n), k(n)
      real(wp), intent(inout) :: d(n), work(n), lower(n), upper(n)
      integer :: i, one_way

      one_way = 0
      !$omp simd reduction(ior:one_way)
      do i = 1, n
         work(i) = work(i) + (f0(i) + k(i)*(0.5_wp*(to(i) + d(i)) - d0(i)))*(to(i) - d(i))
         d(i) = to(i)
         one_way = ior(one_way, unload_on_reversal(i))
      end do
      if (one_way == 0) return
      do i = 1, n
         if (unload_on_reversal(i) > 0) lower(i) = to(i)
         if (unload_on_reversal(i) < 0) upper(i) = to(i)
      end do
   end subroutine advance_each

   !> Take the plane that layered joint i is on, d0 to `centre`; as a line it has no ends, as those of its
   !> layers count.
   subroutine read_plane(self, i)
      type(spring_array), intent(inout) :: self
      integer, intent(in) :: i

      select type (section => self%slot(i)%memory)
      type is (fibre_section)
         call section%read_plane(self%d0(i), self%reference_axial_load(i), self%f0(i), self%k(i), &
                                 self%centre(i))
      end select
      self%lower(i) = -unbounded
      self%upper(i) = unbounded
      self%unload_on_reversal(i) = 0
      self%version = modulo(self%version + 1, huge(1))
   end subroutine read_plane

   !> Take the planes that the layered joints are on.
   subroutine fit_planes(self)
      class(spring_array), intent(inout) :: self
      integer :: j

      do j = 1, size(self%layered)
         call read_plane(self, self%layered(j))
      end do
   end subroutine fit_planes

   !> Layered joints whose axial loads vary move straight to new rotations and to `target_axial_load`.
   subroutine move_joints(self, d)
      type(spring_array), intent(inout) :: self
      !> New deformations (count) [m or rad]
      real(wp), intent(in), contiguous :: d(:)
      integer :: i, j

      do j = 1, size(self%layered)
         i = self%layered(j)
         ! A joint stays if neither its rotation nor its axial load changes.
         if (.not. abs(d(i) - self%d(i)) + &
             abs(self%target_axial_load(i) - self%reference_axial_load(i)) > 0.0_wp) cycle
         ! A trial that is marked saves the joint first.
         if (self%journal%open) call self%journal%keep(i, self%d(i), self%work(i), self%line_of(i), &
                                                          self%slot(i))
         select type (section => self%slot(i)%memory)
         type is (fibre_section)
            call go(section, d(i), self%target_axial_load(i), self%work(i))
         end select
         self%events = self%events + 1
         call read_plane(self, i)
         self%d(i) = d(i)
      end do
   end subroutine move_joints

   !> The first layered joint that can no longer carry its axial load, 0 if all can.
   pure integer function crushed_joint(self) result(lost)
      class(spring_array), intent(in) :: self
      integer :: j

      do j = 1, size(self%layered)
         lost = self%layered(j)
         select type (section => self%slot(lost)%memory)
         type is (fibre_section)
            if (section%failed) return
         end select
      end do
      lost = 0
   end function crushed_joint

   !> Forces of one virgin spring along a path.
   subroutine follow_path(spec, d, f)
      !> Validated parameters of the spring
      type(spring_record), intent(in) :: spec
      !> Deformations, one after the other (m) [m or rad]
      real(wp), intent(in) :: d(:)
      !> Forces there (m) [N or N m]; not a number where a layered joint has lost its axial load
      real(wp), intent(out) :: f(:)
      type(spring_array) :: spring
      type(spring_rules), target :: rules
      integer :: j

      ! One spring, which decays with the work of no other.
      call add_rules(rules, [spec], 1)
      call spring%create(rules, spread([0], 1, 2), [spec%axial_load], 1)
      do j = 1, size(d)
         call spring%advance_to(1, d(j))
         f(j) = spring%force(1)
         if (spring%stuck .or. spring%crushed_joint() > 0) f(j) = ieee_value(f(j), ieee_quiet_nan)
      end do
   end subroutine follow_path

end module rbs_hysteresis_springs
