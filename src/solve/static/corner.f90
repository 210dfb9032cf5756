!> The lines on which a structure leaves a corner of its static path.
!>
!> At a corner a spring is at an end of its line, or on a one-way line against its direction. Which springs
!> continue and which turn back must be found together: a linear complementarity problem.
module rbs_solve_static_corner
   use rbs_base_error, only: error_type, fatal_error, analysis_failed
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_base_tolerances, only: no_stiffness
   use rbs_hysteresis_interaction_joints, only: update_branches
   use rbs_hysteresis_springs, only: spring_array
   use rbs_hysteresis_straight_motion, only: find_blocked
   use rbs_solve_static_path, only: static_path, state_of, weakest_spring, on_the_end, is_on_end
   implicit none
   private

   public :: turn_corner, report_no_line, is_spent, same_rate

   !> How often all springs may be changed at once while their least number without room stays the same.
   integer, parameter :: patience = 3

   !> Rate of a spring at rest, as a share of the largest, by which it may move back virtually; force
   !> of a structure without strength, as a share of its peak.
   real(wp), parameter :: at_rest = 1.0e-6_wp

   !> When a search for a way forward gives up: unless all springs move on or the structure is stable; when
   !> blocks of springs make no more progress; only after all its tries.
   integer, parameter :: if_stable = 1, by_blocks = 2, to_the_end = 3

   !> Share by which rates differ that are not equal, and share of the rate before that is none.
   real(wp), parameter :: same_rate = 1.0e-9_wp, no_rate = 1.0e-11_wp

   !> Springs that come to their gaps within this share of them turn back together, as if their gaps were
   !> smaller by it: where a whole storey unloads, layers of concrete turn in a few steps.
   real(wp), parameter :: together = 0.1_wp

contains

   !> Find the lines that lead on from a corner in a direction, and put the springs on them; the rates on the
   !> lines, and the direction in which the path goes on, are those of the path. An error says why there are
   !> none.
   !>
   !> The way on which no spring turns back is the one of greatest force rate. If there is none, springs
   !> without room are put on the next line, all at once as long as this leaves fewer and fewer without room
   !> (blocks: Judice and Pires, Computers Oper. Res. 21 (1994) 587-596). While the structure is stable there
   !> is no other way, and the first one first ends at it (Murty's least-index rule), whatever the order of
   !> springs. A structure that softens may have several ways: the fundamental one continues the rates before
   !> the corner, see `follow_through`; where none is found, springs that were changed least often are changed
   !> first, so that no number of a spring decides.
   subroutine turn_corner(path, direction, target, error)
      class(static_path), intent(inout) :: path
      !> +1 or -1: the driven quantity is to grow or to fall
      integer, intent(in) :: direction
      !> Displacement [m] or force [N] that the path is on the way to, for messages
      real(wp), intent(in) :: target
      type(error_type), allocatable, intent(out) :: error
      !> Springs blocked on their lines in their direction of motion, their number, and that with planes; how
      !> often each spring has changed its line here
      integer :: blocked(path%moving), springs_blocked, stopped, changed(path%moving)
      logical :: found, through, is_singular

      path%direction = 0
      changed = 0
      found = .false.
      is_singular = .false.
      ! Rates are continued through a corner that springs have come to while the displacement is driven.
      through = .not. (path%by_force .or. path%springs%axial_load_varies)
      if (through) through = any(path%arrived /= 0)
      if (through) then
         path%rate_in = path%rate
         ! Before the first spring is changed: this is the corner.
         call path%springs%mark()
         if (.not. path%goes_back) call search(if_stable)
         if (.not. found) call go_through()
      else
         call search(to_the_end)
      end if
      if (through .and. .not. found) call find_fall(path)
      call path%springs%forget_mark()
      if (found .or. path%loses_load()) return
      if (path%by_force .or. is_singular .or. is_spent(path)) then
         call report_no_line(path, target, error)
      else
         call fatal_error(error, analysis_failed, 'the structure snaps back at '//trim(state_of(path))// &
                          ': no choice of loading and unloading springs lets it go on or back; '// &
                          trim(weakest_spring(path))//' has the least stiffness left. The path up to '// &
                          'there is kept. Strength that is lost more slowly, or a response in time, goes on')
      end if

   contains

      !> Continue the rates through the corner. If this way leads back, a way forward goes before it, if there
      !> is one.
      subroutine go_through()
         logical :: back

         call path%springs%restore()
         call follow_through(path, found)
         ! The way found may lead back, which counts only where the path may go back.
         back = found .and. path%direction /= direction
         found = found .and. (path%may_go_back .or. .not. back)
         if (.not. path%goes_back .and. (back .or. .not. found)) then
            back = found
            call path%springs%restore()
            changed = 0
            ! With less effort where a way back is at hand
            call search(merge(by_blocks, to_the_end, back))
            back = back .and. .not. found
            if (back) then
               call path%springs%restore()
               call follow_through(path, found)
            end if
         end if
         path%goes_back = back
      end subroutine go_through

      !> Search a way forward: find rates, put springs that have no room for them on other lines, and repeat.
      subroutine search(effort)
         !> `if_stable`: only where all springs move on or the structure is stable; `by_blocks`: until blocks
         !> of springs make no more progress; `to_the_end`: all tries
         integer, intent(in) :: effort
         !> Least number of springs without room so far, and how often all may still be changed at once
         integer :: fewest, left, changes, i

         fewest = huge(1)
         left = patience
         do changes = 1, 20 + min(10*path%moving, 1000 + path%moving)
            call path%solve_line(direction, found)
            is_singular = .not. found
            if (.not. found) then
               if (effort < to_the_end) return
               ! Of a column (no elements, no tangents): some springs may unload, though there is no stiffness
               ! under the driven force: let them.
               if (path%by_force .and. size(path%structure%initial_tangent) == 0 .and. &
                   any(path%springs%unload_on_reversal(:path%moving) == -direction)) then
                  do i = 1, path%moving
                     if (path%springs%unload_on_reversal(i) /= -direction) cycle
                     call path%springs%leave(i, direction)
                  end do
                  cycle
               end if
               if (size(path%structure%initial_tangent) > 0) call let_one_unload()
               if (found) cycle
               return
            end if
            call find_stopped()
            if (path%loses_load()) return
            found = stopped == 0
            if (found) then
               path%direction = direction
               return
            end if
            ! A structure that is not known to be stable, and may soften, can have several ways on.
            if (effort == if_stable .and. changes == 1 .and. .not. path%is_stable) then
               if (path%structure%axially_loaded .or. any(path%springs%k(:path%moving) < 0.0_wp)) return
            end if
            if (stopped < fewest) then
               fewest = stopped
               left = patience
            else
               left = left - 1
            end if
            if (left < 0 .and. effort < to_the_end) return
            call change_lines(left >= 0)
         end do
         found = .false.
      end subroutine search

      !> Springs that yield at once may leave a node free to turn, though one of them holds it: one unloads,
      !> which has been changed least often here and, among equals, has come to an end. Those that
      !> should not are put back later.
      subroutine let_one_unload()
         integer, allocatable :: turns(:)
         integer :: i

         turns = pack([(i, i=1, path%moving)], path%springs%unload_on_reversal(:path%moving) /= 0)
         found = size(turns) > 0
         if (.not. found) return
         i = turns(minloc(2*changed(turns) + merge(0, 1, path%arrived(turns) /= 0), dim=1))
         changed(i) = changed(i) + 1
         call path%springs%leave(i, -path%springs%unload_on_reversal(i))
      end subroutine let_one_unload

      !> Springs that are blocked on their lines for the present rates, and joints on their planes. Springs
      !> whose rates are round-off rest: beside a storey without strength nothing else moves.
      subroutine find_stopped()
         real(wp) :: least
         integer :: i, count

         call find_blocked(path%springs, path%rate(:path%moving), blocked, count)
         springs_blocked = 0
         associate (initial => path%structure%initial_stiffness(:path%moving), &
                    rate => path%rate(:path%moving))
            if (count > 0) least = same_rate**2*maxval(initial*rate**2)
            do i = 1, count
               if (initial(blocked(i))*rate(blocked(i))**2 < least) then
                  rate(blocked(i)) = 0.0_wp
               else
                  springs_blocked = springs_blocked + 1
                  blocked(springs_blocked) = blocked(i)
               end if
            end do
         end associate
         stopped = springs_blocked
         if (path%springs%axial_load_varies) call update_layer_branches(stopped)
      end subroutine find_stopped

      !> The layers of joints whose axial loads vary choose their lines for the present rates; a joint whose
      !> plane changes by that had no room on it.
      subroutine update_layer_branches(count)
         !> Number without room, to which such joints are added
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

      !> Put the springs without room on the lines that follow: all, the first, or those changed least.
      subroutine change_lines(all_of_them)
         !> Whether all springs without room change their lines
         logical, intent(in) :: all_of_them
         logical :: is_unique
         integer :: most, j

         is_unique = path%by_force .or. path%is_stable
         most = huge(1)
         if (.not. (all_of_them .or. is_unique)) most = minval(changed(blocked(:springs_blocked)))
         do j = 1, merge(springs_blocked, min(springs_blocked, 1), all_of_them .or. .not. is_unique)
            associate (i => blocked(j))
               if (changed(i) > most) cycle
               changed(i) = changed(i) + 1
               call leave(path%springs, i, merge(1, -1, path%rate(i) > 0.0_wp))
            end associate
         end do
      end subroutine change_lines

   end subroutine turn_corner

   !> Follow the rates through the corner of a structure that softens, from those before it to those after it.
   !>
   !> Katzenelson's homotopy (IEEE Trans. Circuit Theory 12 (1965) 544): the rates before the corner solve the
   !> equations behind it with a force added to each spring that has come to an end, which is taken away
   !> evenly. In other words each spring on a one-way line may virtually move back by a gap, in proportion to
   !> its rate, before it turns. The springs that have changed their lines last continue in their directions,
   !> which decides whether the control moves forward or back; those that are blocked first on these rates,
   !> equal ones at once, change their lines next. The end of this path is the way out. Nothing depends on the
   !> order of springs, and equal ones do the same.
   subroutine follow_through(path, found)
      !> The mark of its springs is the corner
      class(static_path), intent(inout) :: path
      !> Whether there is a way out other than that on which the path has come
      logical, intent(out) :: found

      call follow_gaps(path, together, found)
      if (found) return
      call path%springs%restore()
      call follow_gaps(path, same_rate, found)
   end subroutine follow_through

   !> Follow the rates through a corner as `follow_through` describes, with a given share of their gaps within
   !> which springs turn back at once.
   subroutine follow_gaps(path, at_once, found)
      !> The mark of its springs is the corner
      class(static_path), intent(inout) :: path
      !> Share of a gap within which springs turn back together
      real(wp), intent(in) :: at_once
      !> Whether there is a way out other than that on which the path has come
      logical, intent(out) :: found
      !> Virtual motions of the springs, and gaps; their weights in the direction of the path; stiffnesses of
      !> their lines ahead and of those on which they go back
      real(wp), dimension(path%moving) :: v, gap, weight, forward, backward
      !> Directions ahead, 0 for springs that have none; the line of each: that ahead, that on which it has
      !> come to the corner, that on which it goes back; directions of those that have changed it last, 0 for
      !> others
      integer, dimension(path%moving) :: ahead, line, heading
      !> Whether the line on which it goes back is known
      logical :: is_known(path%moving)
      !> Lines of a spring: ahead of the corner, that on which it came, that on which it goes back
      integer, parameter :: on = 0, came = 1, back = 2
      integer :: i, m, sense, pivots

      m = path%moving
      gap = abs(path%rate_in(:m))
      gap = max(gap, at_rest*maxval(gap))
      weight = gap*path%structure%initial_stiffness(:m)
      v = 0.0_wp
      ahead = path%arrived(:m)
      line = on
      is_known = .false.
      call go_ahead()
      forward = path%springs%k(:m)
      heading = ahead
      path%passes = .true.
      ! A pivot: rates on the present lines, in the sense in which the springs that changed last go on, up to
      ! the springs that change next. Where none does, this is the way out.
      do pivots = 1, 100 + 4*m
         call find_rates(1)
         if (.not. found) exit
         sense = merge(1, -1, sum(heading*path%rate(:m)*weight) > 0.0_wp)
         path%rate = sense*path%rate
         call change_first()
         if (all(heading == 0) .or. all(path%arrived(:m) == 0 .or. line /= on)) exit
      end do
      found = found .and. all(heading == 0)
      ! Where all turn back, it is the way on which the path has come.
      if (found) found = any(path%rate(:m)*path%rate_in(:m) > 0.0_wp .and. &
                             (ahead /= 0 .or. path%springs%unload_on_reversal(:m) /= 0))
      do i = 1, m
         if (ahead(i) /= 0) call path%springs%set_stiffness(i, forward(i))
      end do
      call path%springs%restore()
      if (found) then
         call go_ahead()
         do i = 1, m
            if (line(i) == back) call leave(path%springs, i, -ahead(i))
         end do
         call find_rates(sense)
         path%direction = sense
      end if
      path%passes = .false.

   contains

      !> Find rates; those that are round-off of the rates before the corner send no spring either way.
      subroutine find_rates(direction)
         !> +1 or -1: in which the driven quantity moves
         integer, intent(in) :: direction

         call path%solve_line(direction, found)
         if (found) where (abs(path%rate(:m)) < no_rate*gap) path%rate(:m) = 0.0_wp
      end subroutine find_rates

      !> Springs that have come to closed ends leave their lines.
      subroutine go_ahead()
         integer :: i

         do i = 1, m
            associate (direction => path%arrived(i))
               if (direction == 0) cycle
               if (is_on_closed_end(path%springs, i, direction)) call leave(path%springs, i, direction)
            end associate
         end do
      end subroutine go_ahead

      !> Move the springs virtually at the present rates until the first ones come to where they change their
      !> lines, and change these. `heading` gets their directions, 0 for the others.
      subroutine change_first()
         !> Virtual motion at which a spring changes its line, and how far ahead that is, in units of the
         !> rates; the line that it changes to
         real(wp) :: at(m), clearance(m), least
         integer :: next(m), blocked(m), count, way, i
         logical :: is_blocked(m)

         call find_blocked(path%springs, path%rate(:m), blocked, count)
         is_blocked = .false.
         is_blocked(blocked(:count)) = .true.
         clearance = huge(1.0_wp)
         do i = 1, m
            if (.not. abs(path%rate(i)) > 0.0_wp) cycle
            way = merge(1, -1, path%rate(i) > 0.0_wp)
            ! A spring inside its line takes part when it is blocked: ahead is then where it came from.
            if (ahead(i) == 0) then
               if (.not. is_blocked(i)) cycle
               ahead(i) = -way
            end if
            if (line(i) == merge(on, back, way == ahead(i))) cycle
            ! The lines of a spring lie in the order ahead, came, back. One inside its line, or that came on a
            ! one-way line, turns back only after its gap.
            next(i) = line(i) - way*ahead(i)
            if (path%arrived(i) == 0) then
               at(i) = -ahead(i)*gap(i)
               next(i) = merge(on, back, way == ahead(i))
            else if (path%one_way(i)) then
               at(i) = merge(0.0_wp, -ahead(i)*gap(i), min(line(i), next(i)) == on)
            else
               at(i) = 0.0_wp
               next(i) = merge(on, back, way == ahead(i))
            end if
            clearance(i) = max((at(i) - v(i))*way, 0.0_wp)/abs(path%rate(i))
         end do
         heading = 0
         least = minval(clearance)
         if (.not. least < huge(1.0_wp)) return
         ! Move on to the nearest change; springs that are as near, or nearly so, change with it.
         v = v + least*path%rate(:m)
         do i = 1, m
            if (.not. clearance(i) < huge(1.0_wp)) cycle
            if ((clearance(i) - least)*abs(path%rate(i)) > &
                merge(at_once, same_rate, next(i) == back)*gap(i)) cycle
            heading(i) = merge(1, -1, path%rate(i) > 0.0_wp)
            if (next(i) == back) then
               gap(i) = abs(v(i))
            else
               v(i) = at(i)
            end if
            call change(i, next(i))
         end do
      end subroutine change_first

      !> Put a spring on one of its lines, for rates alone: only its stiffness changes.
      subroutine change(i, next)
         !> Spring, and its line: `on`, `came` or `back`
         integer, intent(in) :: i, next
         real(wp) :: k

         line(i) = next
         if (next == back .and. .not. is_known(i)) then
            call path%springs%set_stiffness(i, forward(i))
            call leave(path%springs, i, -ahead(i))
            backward(i) = path%springs%k(i)
            is_known(i) = .true.
         end if
         k = forward(i)
         if (next == came) k = path%k_in(i)
         if (next == back) k = backward(i)
         call path%springs%set_stiffness(i, k)
      end subroutine change

   end subroutine follow_gaps

   !> Look for a joint of layers that falls: it is in compression, and its layers together resist no more of
   !> it on the lines ahead of the corner. It has lost its axial load, which the summary reports.
   subroutine find_fall(path)
      !> The mark of its springs is the corner
      class(static_path), intent(inout) :: path
      integer :: i, j

      if (path%springs%joints%count == 0) return
      call path%springs%restore()
      ! Springs that have come to the corner go on to the lines ahead.
      do i = 1, path%moving
         if (path%arrived(i) /= 0) call leave(path%springs, i, path%arrived(i))
      end do
      associate (joints => path%springs%joints, summary => path%task%summary)
         do j = 1, joints%count
            associate (first => joints%first(j), last => joints%last(j), &
                       location => path%structure%location(joints%first(j)))
               if (sum(path%springs%k(first:last)) > &
                   no_stiffness*sum(path%structure%initial_stiffness(first:last))) cycle
               if (.not. sum([(path%springs%force(i), i=first, last)]) < 0.0_wp) cycle
               summary%fallen_member = location%member
               summary%remark = 'the layers of joint '//to_text(location%joint)//' of member '// &
                                trim(location%owner)//' no longer carry its axial load at '//state_of(path)
            end associate
         end do
      end associate
   end subroutine find_fall

   !> Put a spring on the line that follows in a direction. Lines without length, as layers have that unload
   !> at once after they were loaded again, and those whose end is met at once are left too: a spring that has
   !> turned at one place more than once has several, one in the other.
   subroutine leave(springs, i, side)
      type(spring_array), intent(inout) :: springs
      !> Spring, and direction: +1 or -1
      integer, intent(in) :: i, side
      integer, parameter :: most_lines = 8
      integer :: lines

      do lines = 1, most_lines
         call springs%leave(i, side)
         if (springs%upper(i) - springs%lower(i) > on_the_end*abs(springs%d(i)) .and. &
             .not. is_on_end(springs, i, springs%d(i), real(side, wp))) exit
      end do
   end subroutine leave

   !> Whether a spring is on an end that belongs to its line (a closed end).
   pure logical function is_on_closed_end(springs, i, heading)
      type(spring_array), intent(in) :: springs
      !> Spring, and which end: +1 upper, -1 lower
      integer, intent(in) :: i, heading

      if (heading > 0) then
         is_on_closed_end = springs%includes_upper_end(i) .and. springs%d(i) >= springs%upper(i)
      else
         is_on_closed_end = springs%includes_lower_end(i) .and. springs%d(i) <= springs%lower(i)
      end if
   end function is_on_closed_end

   !> Whether a structure whose displacement is driven has no strength left: its force is next to nothing
   !> beside its peak.
   pure logical function is_spent(path)
      class(static_path), intent(in) :: path

      is_spent = .not. path%by_force .and. abs(path%force) <= at_rest*abs(path%task%summary%peak_force)
   end function is_spent

   !> Report why the path cannot be continued.
   subroutine report_no_line(path, target, error)
      class(static_path), intent(in) :: path
      !> Displacement [m] or force [N] that the path is on the way to
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
