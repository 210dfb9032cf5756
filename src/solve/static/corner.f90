!> The lines on which a structure leaves a corner of its static path.
!>
!> At a corner a spring is at an end of its line, or on a one-way line against its direction. Which springs
!> continue and which turn back must be found together: a linear complementarity problem.
module rbs_solve_static_corner
   use rbs_base_error, only: error_type, fatal_error, analysis_failed
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_hysteresis_interaction_joints, only: update_branches
   use rbs_hysteresis_springs, only: spring_array
   use rbs_hysteresis_straight_motion, only: find_blocked
   use rbs_solve_static_path, only: static_path, state_of, weakest_spring, on_the_end
   implicit none
   private

   public :: turn_corner, report_no_line, is_spent

   !> How often all springs may be changed at once while their least number without room stays the same.
   integer, parameter :: patience = 3

   !> Rate of a spring at rest, as a share of the largest, by which it may move back virtually; force
   !> of a structure without strength, as a share of its peak.
   real(wp), parameter :: at_rest = 1.0e-6_wp

   !> Most springs whose ways are tried in all combinations, and most springs times combinations.
   integer, parameter :: most_tried = 14, most_work = 200000

   !> Most sets of gaps.
   integer, parameter :: most_gaps = 2

   !> Its multiples spread over the fractions, so that no two springs are alike.
   real(wp), parameter :: golden = 0.6180339887498949_wp

contains

   !> Find the lines that lead on in a direction, and the rates on them.
   !>
   !> Springs without room are put on the next line, all at once as long as this leaves fewer and fewer
   !> without room, else the first one first: while the structure is stable this ends (Murty's least-index
   !> rule; with blocks: Judice and Pires, Computers Oper. Res. 21 (1994) 587-596). Beyond the peak it may
   !> cycle.
   subroutine turn_corner(path, direction, target, error)
      class(static_path), intent(inout) :: path
      integer, intent(in) :: direction
      real(wp), intent(in) :: target
      type(error_type), allocatable, intent(out) :: error
      !> Springs blocked on their lines in their direction of motion, their number, and that with planes
      integer :: blocked(path%moving), springs_blocked, stopped
      integer :: changes, fewest, left, combinations, i
      logical :: found, may_pass

      path%direction = 0
      path%changed = 0
      may_pass = path%may_go_back
      if (may_pass) may_pass = any(path%arrived /= 0)
      if (may_pass) then
         path%rate_in = path%rate
         ! Before the first spring is changed: this is the corner.
         call path%springs%mark()
      end if
      found = path%goes_back
      if (found) then
         call pass()
         if (.not. found) call try_all_ways()
         if (.not. found) call report_snap_back()
         return
      end if
      fewest = huge(1)
      left = patience
      do changes = 1, 20 + min(10*path%moving, 1000 + path%moving)
         call path%solve_line(direction, found)
         if (.not. found) then
            ! Some springs may unload, though there is no stiffness under the driven force: let them.
            if (path%by_force .and. path%structure%tangent_numbers == 0 .and. &
                any(path%springs%unload_on_reversal(:path%moving) == -direction)) then
               do i = 1, path%moving
                  if (path%springs%unload_on_reversal(i) == -direction) call path%springs%leave(i, direction)
               end do
               cycle
            end if
            call pass()
            if (found) return
            if (path%structure%tangent_numbers > 0) call let_one_unload()
            if (found) cycle
            call report_no_line(path, target, error)
            return
         end if
         call find_stopped()
         if (path%springs%crushed_joint() > 0) return
         if (stopped == 0) then
            path%direction = direction
            call path%springs%forget_mark()
            return
         end if
         if (stopped < fewest) then
            fewest = stopped
            left = patience
         else
            left = left - 1
         end if
         if (left < 0 .and. may_pass) then
            call pass()
            if (found) return
            ! Where the way was sought in vain the springs are on the lines of the corner again.
            if (.not. may_pass) cycle
         end if
         call change_lines(left >= 0)
      end do
      call pass(always=.true.)
      if (found) return
      call try_all_ways()
      if (found) return
      if (path%by_force) then
         call report_no_line(path, target, error)
      else
         call report_snap_back()
      end if

   contains

      !> Follow the path through the corner, where something softens; once.
      subroutine pass(always)
         !> Whether it is the last resort
         logical, intent(in), optional :: always

         found = .false.
         if (.not. may_pass) return
         if (.not. (present(always) .or. path%goes_back .or. path%structure%axially_loaded .or. &
                    any(path%springs%k(:path%moving) < 0.0_wp))) return
         may_pass = .false.
         call path%springs%restore()
         call follow_through(path, direction, found)
         if (.not. found) call path%springs%restore()
         call path%springs%forget_mark()
      end subroutine pass

      !> Springs that yield at once may leave a node free to turn, though one of them holds it: the one that
      !> has come last and was changed least unloads. Those that should not are put back.
      subroutine let_one_unload()
         integer, allocatable :: turns(:)
         integer :: i

         turns = pack([(i, i=1, path%moving)], path%springs%unload_on_reversal(:path%moving) /= 0)
         found = size(turns) > 0
         if (.not. found) return
         i = turns(minloc(2*path%changed(turns) + merge(0, 1, path%arrived(turns) /= 0), dim=1))
         path%changed(i) = path%changed(i) + 1
         call path%springs%leave(i, -path%springs%unload_on_reversal(i))
      end subroutine let_one_unload

      subroutine report_snap_back()
         if (is_spent(path)) then
            call report_no_line(path, target, error)
            return
         end if
         call fatal_error(error, analysis_failed, 'the structure snaps back at '//trim(state_of(path))// &
                          ': none of '//to_text(combinations)//' combinations of loading and unloading '// &
                          'springs lets it go on or back; '//trim(weakest_spring(path))//' has the least '// &
                          'stiffness left. The path up to there is kept. Strength that is lost more '// &
                          'slowly, or a response in time, goes on')
      end subroutine report_snap_back

      !> Springs that are blocked on their lines for the present rates, and joints on their planes.
      subroutine find_stopped()
         call find_blocked(path%springs, path%rate(:path%moving), blocked, springs_blocked)
         stopped = springs_blocked
         if (path%springs%axial_load_varies) call update_layer_branches(stopped)
      end subroutine find_stopped

      !> The layers of joints whose axial loads vary choose their lines for the present rates; a joint whose
      !> plane changes by that had no room on it.
      subroutine update_layer_branches(count)
         integer, intent(inout) :: count
         real(wp) :: before(2)
         integer :: i, j

         do j = 1, size(path%springs%layered)
            i = path%springs%layered(j)
            before = [path%springs%k(i), path%springs%centre(i)]
            call update_branches(path%springs, i, path%rate(i), path%axial_rate)
            if (any(abs(before - [path%springs%k(i), path%springs%centre(i)]) > 0.0_wp)) count = count + 1
         end do
      end subroutine update_layer_branches

      !> Put the springs without room on the lines that follow, all or the first of them.
      subroutine change_lines(all_of_them)
         logical, intent(in) :: all_of_them
         integer :: j

         do j = 1, merge(springs_blocked, min(springs_blocked, 1), all_of_them)
            associate (i => blocked(j))
               path%changed(i) = path%changed(i) + 1
               call path%springs%leave(i, merge(1, -1, path%rate(i) > 0.0_wp))
            end associate
         end do
      end subroutine change_lines

      !> Try both ways of the springs at a corner in all combinations, one change at a time (Gray code), until
      !> none is blocked: equal springs in series reach their caps at once. A path that may go back takes the
      !> way forward if there is one. Of more springs than can be tried, those come first that the search has
      !> changed more than once.
      subroutine try_all_ways()
         integer, allocatable :: tried(:)
         integer :: trial, i, most

         tried = pack([(i, i=1, path%moving)], [(exit_direction(path%springs, i) /= 0, i=1, path%moving)])
         tried = [pack(tried, path%changed(tried) > 1), pack(tried, path%changed(tried) <= 1)]
         most = min(most_tried, int(log(real(most_work, wp)/path%moving)/log(2.0_wp)))
         tried = tried(:min(size(tried), most))
         combinations = 2**size(tried)
         path%passes = path%may_go_back
         do trial = 1, merge(2, 1, path%may_go_back .and. any(path%arrived /= 0))*combinations
            call path%solve_line(merge(direction, -direction, trial <= combinations), found)
            if (found) then
               call find_stopped()
               found = stopped == 0
               ! A path on which all springs turn back would return as it came.
               if (trial > combinations) found = found .and. goes_on(path)
               if (found) exit
            end if
            if (trial == 2*combinations) exit
            ! The bit that changes next in the Gray code, which ends one change before it begins.
            i = min(trailz(trial) + 1, size(tried))
            if (i > 0) call path%springs%leave(tried(i), exit_direction(path%springs, tried(i)))
         end do
         path%passes = .false.
         if (.not. found) return
         path%goes_back = trial > combinations
         path%direction = merge(-direction, direction, path%goes_back)
      end subroutine try_all_ways

   end subroutine turn_corner

   !> Follow the path of a structure that softens through a corner, and back where it snaps back.
   !>
   !> Each spring on a one-way line may virtually move back by a small gap before it turns. Then the corner is
   !> one of a continuous piecewise linear map, through which one path runs: the spring that has changed its
   !> line last continues in its direction, which decides whether the control moves forward or back; the first
   !> spring that is blocked on these rates changes its line and is the last one now. No lines come twice.
   !> Where no spring is blocked ahead, these rates lead out of the corner, however small the gaps are. Of
   !> several ways out, as symmetric structures have them, the gaps choose one.
   subroutine follow_through(path, toward, found)
      class(static_path), intent(inout) :: path
      !> Direction of the target; the mark of the springs is the corner
      integer, intent(in) :: toward
      logical, intent(out) :: found
      !> Virtual motions of the springs, gaps, where they have changed their lines, stiffness of the line
      !> after the corner
      real(wp), dimension(path%moving) :: v, gap, edge, k
      !> Whether a spring is virtually back on the line on which it came to the corner
      logical :: is_back(path%moving)
      integer :: crossed(path%moving), i, m, first, spring, next, heading, goes, sense, pivots, trial, ends

      m = path%moving
      first = findloc(path%arrived(:m) /= 0, .true., dim=1)
      path%passes = .true.
      ! If one end of the path is plain unloading, the other one leads on. Where it closes in itself, other
      ! gaps may open it.
      do trial = 1, 2*most_gaps
         ends = merge(1, -1, modulo(trial, 2) == 1)
         gap = [(1.0_wp + modulo(i*((trial + 1)/2)*golden, 1.0_wp), i=1, m)]
         gap = gap*max(abs(path%rate_in(:m)), at_rest**(1.0_wp/((trial + 1)/2))*maxval(abs(path%rate_in(:m))))
         v = 0.0_wp
         is_back = .false.
         ! Springs that have come to their ends at once did so one after the other.
         crossed = path%arrived(:m)
         edge = -0.1_wp*crossed*gap
         edge(first) = 0.0_wp
         do i = 1, m
            if (crossed(i) == 0) cycle
            if (is_on_closed_end(path%springs, i, crossed(i))) call path%springs%leave(i, crossed(i))
         end do
         k = path%springs%k(:m)
         spring = first
         goes = ends*crossed(first)
         if (ends < 0) call change(first, goes, 0.0_wp)
         do pivots = 1, 100 + 4*m
            call path%solve_line(1, found)
            if (.not. found) exit
            sense = merge(1, -1, goes*path%rate(spring) > 0.0_wp)
            path%rate = sense*path%rate
            call find_next()
            if (next == 0) exit
         end do
         found = found .and. next == 0
         if (found) found = goes_on(path)
         do i = 1, m
            if (is_back(i)) call path%springs%set_stiffness(i, k(i))
         end do
         if (found) exit
         call path%springs%restore()
      end do
      path%passes = .false.
      if (.not. found) return
      path%direction = sense
      path%goes_back = sense /= toward

   contains

      !> The spring that is blocked first, and its change of lines; 0: none is.
      subroutine find_next()
         real(wp) :: at, clearance, least, next_at
         logical :: is_blocked(m)
         integer :: blocked(m), count, next_heading

         next = 0
         next_heading = 0
         next_at = 0.0_wp
         least = huge(1.0_wp)
         call find_blocked(path%springs, path%rate(:m), blocked, count)
         is_blocked = .false.
         is_blocked(blocked(:count)) = .true.
         do i = 1, m
            if (is_back(i)) then
               heading = merge(1, -1, path%rate(i) > 0.0_wp)
               if (.not. abs(path%rate(i)) > 0.0_wp) cycle
               at = edge(i)
               if (heading /= path%arrived(i)) at = edge(i) + heading*gap(i)
            else
               if (.not. is_blocked(i)) cycle
               heading = merge(1, -1, path%rate(i) > 0.0_wp)
               at = merge(edge(i), heading*gap(i), crossed(i) == -heading)
               if (heading == path%arrived(i) .and. path%one_way(i)) at = edge(i) - heading*gap(i)
            end if
            clearance = max((at - v(i))*heading, 0.0_wp)/abs(path%rate(i))
            if (.not. clearance < least) cycle
            least = clearance
            next = i
            next_heading = heading
            next_at = at
         end do
         if (next == 0) return
         v = v + least*path%rate(:m)
         call change(next, next_heading, next_at)
         spring = next
         goes = next_heading
      end subroutine find_next

      !> Change the line of a spring that is blocked in a direction. Over the corner a one-way line moves back
      !> as it came, and turns a gap later.
      subroutine change(i, heading, at)
         integer, intent(in) :: i, heading
         real(wp), intent(in) :: at

         v(i) = at
         associate (springs => path%springs, came => path%arrived(i))
            if (.not. is_back(i) .and. heading == -came .and. path%one_way(i)) then
               is_back(i) = .true.
               call springs%set_stiffness(i, path%k_in(i))
            else if (is_back(i)) then
               is_back(i) = .false.
               call springs%set_stiffness(i, k(i))
               if (heading == came) return
               call leave(springs, i, heading)
               crossed(i) = heading
            else
               call leave(springs, i, heading)
               crossed(i) = heading
               if (heading == came .and. path%one_way(i)) then
                  is_back(i) = .true.
                  k(i) = springs%k(i)
                  call springs%set_stiffness(i, path%k_in(i))
               else
                  edge(i) = at
               end if
            end if
         end associate
      end subroutine change

   end subroutine follow_through

   !> Put a spring on the line that follows; a line without length, as layers have that unload at once after
   !> they were loaded again, is left in the direction in which it is met.
   subroutine leave(springs, i, side)
      type(spring_array), intent(inout) :: springs
      integer, intent(in) :: i, side

      call springs%leave(i, side)
      if (springs%upper(i) - springs%lower(i) <= on_the_end*abs(springs%d(i))) call springs%leave(i, side)
   end subroutine leave

   !> Whether a spring is on an end that belongs to its line.
   pure logical function is_on_closed_end(springs, i, heading)
      type(spring_array), intent(in) :: springs
      integer, intent(in) :: i, heading

      if (heading > 0) then
         is_on_closed_end = springs%includes_upper_end(i) .and. springs%d(i) >= springs%upper(i)
      else
         is_on_closed_end = springs%includes_lower_end(i) .and. springs%d(i) <= springs%lower(i)
      end if
   end function is_on_closed_end

   !> Direction in which a spring can leave its line from its present deformation, 0 if it cannot.
   pure integer function exit_direction(springs, i)
      type(spring_array), intent(in) :: springs
      integer, intent(in) :: i

      exit_direction = -springs%unload_on_reversal(i)
      if (exit_direction /= 0) return
      if (springs%d(i) >= springs%end_toward(i, 1)) then
         exit_direction = 1
      else if (springs%d(i) <= springs%end_toward(i, -1)) then
         exit_direction = -1
      end if
   end function exit_direction

   !> Whether a spring goes on in its direction before the corner.
   pure logical function goes_on(path)
      class(static_path), intent(in) :: path

      goes_on = any(path%rate(:path%moving)*path%rate_in(:path%moving) > 0.0_wp)
   end function goes_on

   !> Whether a structure whose displacement is driven has no strength left.
   pure logical function is_spent(path)
      class(static_path), intent(in) :: path

      is_spent = .not. path%by_force .and. abs(path%force) <= at_rest*abs(path%task%summary%peak_force)
   end function is_spent

   !> Report why the path cannot be continued.
   subroutine report_no_line(path, target, error)
      class(static_path), intent(in) :: path
      real(wp), intent(in) :: target
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: remark

      remark = ''
      if (path%structure%axially_loaded) remark = ' above what the axial load takes away'
      if (path%lost_digits) then
         call fatal_error(error, analysis_failed, 'the stiffnesses are too far apart for the arithmetic '// &
                          'at '//trim(state_of(path))//': '//trim(weakest_spring(path))//' has the least '// &
                          'left. Take stiff springs less stiff, a million times the others is rigid '// &
                          'enough, or '// &
                          'fewer bodies')
      else if (is_spent(path)) then
         call fatal_error(error, analysis_failed, 'the strength of the structure is used up at '// &
                          trim(state_of(path))//': nothing resists its motion to '//to_text(target)// &
                          ' m; '//trim(weakest_spring(path))//' has the least stiffness left. End the '// &
                          'path before, or give the springs a residual force')
      else if (.not. path%by_force) then
         call fatal_error(error, analysis_failed, 'the equilibrium is not unique at the displacement '// &
                          to_text(target)//' m at '//trim(state_of(path))//': '// &
                          trim(weakest_spring(path))//trim(merge(' and the axial load leave', &
                          ' leaves                  ', path%structure%axially_loaded))//' it without '// &
                          'stiffness. Change its stiffness after yield, or the axial load if there is one')
      else if (path%of_dead_load) then
         call fatal_error(error, analysis_failed, 'it is beyond the capacity of the frame: at a share of '// &
                          to_text(path%force)//' of it '//trim(weakest_spring(path))// &
                          ' has no stiffness left. Give less load, or stronger or stiffer members')
      else
         call fatal_error(error, analysis_failed, 'the lateral force '//to_text(target)//' N is beyond '// &
                          'the capacity of the structure: '//trim(weakest_spring(path))//' has no '// &
                          'stiffness left at '//trim(state_of(path))//'. The path up to there is kept; '// &
                          'drive the column by displacement, or give the spring a stiffness after yield'// &
                          remark)
      end if
   end subroutine report_no_line

end module rbs_solve_static_corner
