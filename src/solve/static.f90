!> Static path, event to event: the column goes along its line to the target or to the next end of a
!> spring's line, whichever comes first. Exact for `small` and `pdelta`; no tolerance, no increments.
module rbs_solve_static
   use rbs_base_constants, only: unset_integer
   use rbs_base_error, only: error_type, fatal_error, analysis_failed
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_column_axial, only: axial_energy, critical_factor
   use rbs_column_column, only: column_type
   use rbs_hysteresis_segment, only: segment
   use rbs_hysteresis_springs, only: spring_array
   use rbs_results_progress, only: progress_type
   use rbs_results_recorder, only: recorder_type
   use rbs_results_row, only: row_size, row_time, row_displacement, row_force, row_input, row_kinetic, &
                              row_spring, row_damping, row_axial, row_residual, row_joints
   use rbs_results_summary, only: summary_type
   use rbs_solve_equilibrium, only: equilibrium_type
   implicit none
   private

   public :: trace, kept_rows

   !> A spring this close to an end of its line, relative to the end, is on it. Not a tolerance of the
   !> solution: where a cycle returns to its peak, round-off would else decide between outer and inner
   !> unloading.
   real(wp), parameter :: on_the_end = 1.0e-11_wp

   !> Most springs whose two ways out of a corner are tried in all combinations.
   integer, parameter :: most_tried = 14

   !> The state of a path and the line it is on.
   type :: path_type
      type(equilibrium_type) :: equilibrium
      type(spring_array) :: springs
      !> Whether the force is driven, else the displacement
      logical :: by_force = .false.
      !> Displacement of the top [m], lateral force [N], work of the force [J]
      real(wp) :: displacement = 0.0_wp, force = 0.0_wp, work = 0.0_wp
      !> What is driven, and the way it goes on the line found last: +1, -1, 0 for no line
      real(wp) :: control = 0.0_wp
      integer :: direction = 0
      !> The line: values at `start`, and rates per unit of what is driven
      real(wp) :: start = 0.0_wp
      real(wp), allocatable :: q(:), rate(:)
      real(wp) :: force_start = 0.0_wp, force_rate = 0.0_wp
      real(wp) :: displacement_start = 0.0_wp, displacement_rate = 0.0_wp
      !> Its end, and the spring that ends it (0: none)
      real(wp) :: finish = 0.0_wp
      integer :: ends = 0
      !> How often each spring has changed its line at the present corner (2 n)
      integer, allocatable :: changed(:)
      !> Work arrays (2 n)
      real(wp), allocatable :: residual(:), correction(:), f(:)
   end type path_type

contains

   !> Number of rows kept of m when every n-th and the last are.
   elemental integer function kept_rows(m, every)
      integer, intent(in) :: m, every

      kept_rows = 0
      if (every == unset_integer) then
         kept_rows = m
      else if (m > 0) then
         kept_rows = (m - 1)/every + 1 + merge(0, 1, mod(m - 1, every) == 0)
      end if
   end function kept_rows

   !> Follow the targets one after the other from the virgin state.
   subroutine trace(column, by_force, target, every, recorder, summary, error, progress)
      type(column_type), intent(in) :: column
      !> Whether the targets are lateral forces [N], else displacements of the top [m]
      logical, intent(in) :: by_force
      !> Targets (m)
      real(wp), intent(in) :: target(:)
      !> Every n-th point is kept, and the last; `unset_integer`: all
      integer, intent(in) :: every
      class(recorder_type), intent(inout) :: recorder
      type(summary_type), intent(out) :: summary
      !> On failure everything up to the last good state has been recorded
      type(error_type), allocatable, intent(out) :: error
      !> Told now and then how far the path is
      class(progress_type), intent(inout), optional :: progress
      type(path_type) :: path
      type(error_type), allocatable :: failure
      real(wp), allocatable :: row(:)
      integer :: i, n

      n = every
      if (every == unset_integer) n = 1
      call start_path(path, column, by_force)
      allocate (row(row_size(column%n)))
      do i = 1, size(target)
         call advance(path, target(i), failure)
         if (allocated(failure)) failure%message = 'row '//to_text(i)//': '//failure%message
         call summary%see_peak(path%displacement, path%force)
         if (mod(i - 1, n) == 0 .or. i == size(target) .or. allocated(failure)) then
            call fill_row(path, row, i - 1)
            call summary%see(row)
            call recorder%record(row, error)
            if (allocated(error)) return
         end if
         summary%steps = i
         if (mod(i, 8192) == 0 .and. present(progress)) call progress%update(real(i, wp)/size(target))
         summary%events = path%springs%events
         if (allocated(failure)) then
            call move_alloc(failure, error)
            return
         end if
      end do
   end subroutine trace

   subroutine start_path(path, column, by_force)
      type(path_type), intent(out) :: path
      type(column_type), intent(in) :: column
      logical, intent(in) :: by_force

      call path%equilibrium%create(column)
      call path%springs%create(column%spring)
      path%by_force = by_force
      allocate (path%q(column%unknowns), path%rate(column%unknowns), source=0.0_wp)
      allocate (path%changed(column%unknowns), source=0)
      allocate (path%residual(column%unknowns), path%correction(column%unknowns), &
                path%f(column%unknowns), source=0.0_wp)
   end subroutine start_path

   !> Go on to a target.
   subroutine advance(path, target, error)
      type(path_type), intent(inout) :: path
      !> Displacement [m] or force [N]
      real(wp), intent(in) :: target
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: state
      integer :: direction, lines

      do lines = 1, 10000 + 1000*path%springs%count
         if (.not. abs(target - path%control) > 0.0_wp) return
         direction = merge(1, -1, target > path%control)
         if (path%direction /= direction) then
            call find_line(path, direction, target, error)
            if (allocated(error)) return
         end if
         if (direction*(path%finish - target) > on_the_end*abs(target)) then
            call go(path, target)
         else if (direction*(path%finish - target) < -on_the_end*abs(target)) then
            call go(path, path%finish)
            call end_line(path)
         else
            call go(path, target)
            call end_line(path)
         end if
      end do
      call describe_state(path, state)
      call fatal_error(error, analysis_failed, 'the static path makes no way at '//state//'; the '// &
                       'parameters of the springs or the targets are too extreme for the arithmetic')
   end subroutine advance

   !> Find the line of the column that leads on in a direction.
   !>
   !> A spring that stands at an end of its line, or on a one-way line against its way, is put on the
   !> next line, one at a time and the first one first: while the column is stable this ends (Murty's
   !> least-index rule of the linear complementarity problem). Beyond the peak it may go in a circle.
   subroutine find_line(path, direction, target, error)
      type(path_type), intent(inout) :: path
      integer, intent(in) :: direction
      real(wp), intent(in) :: target
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: state
      integer :: changes, i, way
      logical :: found

      path%direction = 0
      path%changed = 0
      do changes = 1, 20 + 10*path%springs%count
         call solve_line(path, direction, found)
         if (.not. found) then
            i = findloc(path%springs%one_way, -direction, dim=1)
            if (path%by_force .and. i > 0) then
               ! Without stiffness this way, but some springs would unload: let them.
               call path%springs%leave(i, direction)
               cycle
            end if
            call report_no_line(path, target, error)
            return
         end if
         call first_without_room(path, direction, i, way)
         if (i == 0) then
            call begin_line(path, direction)
            return
         end if
         path%changed(i) = path%changed(i) + 1
         call path%springs%leave(i, way)
      end do
      call try_all_ways(path, direction, found)
      if (found) then
         call begin_line(path, direction)
      else
         call describe_state(path, state)
         call fatal_error(error, analysis_failed, 'the column snaps back at '//state// &
                          ': no combination of loading and unloading springs was found that lets its '// &
                          'top go on. A driven top cannot follow that; use a dynamic analysis')
      end if
   end subroutine find_line

   !> Try both ways of the springs at the corner in all combinations, one change at a time (Gray code),
   !> until all have room. Of more springs than can be tried, those come first that the search went back
   !> and forth with.
   subroutine try_all_ways(path, direction, found)
      type(path_type), intent(inout) :: path
      integer, intent(in) :: direction
      logical, intent(out) :: found
      integer, allocatable :: tried(:)
      integer :: trial, i, way

      associate (springs => path%springs)
         tried = pack([(i, i=1, springs%count)], springs%one_way /= 0 .or. springs%d >= springs%line%hi &
                      .or. springs%d <= springs%line%lo)
      end associate
      tried = [pack(tried, path%changed(tried) > 1), pack(tried, path%changed(tried) <= 1)]
      tried = tried(:min(size(tried), most_tried))
      found = .false.
      do trial = 1, 2**size(tried)
         call solve_line(path, direction, found)
         if (found) then
            call first_without_room(path, direction, i, way)
            found = i == 0
            if (found) return
         end if
         ! The bit that changes next in the Gray code.
         if (trial == 2**size(tried)) exit
         i = tried(trailz(trial) + 1)
         call path%springs%leave(i, way_out(path, i))
      end do
      found = .false.
   end subroutine try_all_ways

   !> The way by which a spring at a corner leaves its line.
   pure integer function way_out(path, i)
      type(path_type), intent(in) :: path
      integer, intent(in) :: i

      if (path%springs%one_way(i) /= 0) then
         way_out = -path%springs%one_way(i)
      else if (path%springs%d(i) >= path%springs%line(i)%hi) then
         way_out = 1
      else
         way_out = -1
      end if
   end function way_out

   !> Rates of the column on the present lines of its springs.
   subroutine solve_line(path, direction, found)
      type(path_type), intent(inout) :: path
      integer, intent(in) :: direction
      logical, intent(out) :: found
      real(wp) :: gap, force_correction
      integer :: weakest

      associate (springs => path%springs, equilibrium => path%equilibrium)
         path%f = springs%f0 + springs%k*(springs%d - springs%d0)
         call equilibrium%residual(springs%d, path%f, path%force, path%residual)
         if (path%by_force) then
            call equilibrium%follow_force(springs%k, path%residual, path%rate, path%correction, weakest)
            found = weakest == 0
            path%force_rate = 1.0_wp
            force_correction = 0.0_wp
            path%displacement_rate = sum(equilibrium%arm*path%rate)
         else
            gap = path%displacement - sum(equilibrium%arm*springs%d)
            call equilibrium%follow_displacement(springs%k, path%residual, gap, path%rate, &
                                                 path%force_rate, path%correction, force_correction, found)
            path%displacement_rate = 1.0_wp
         end if
         path%force_start = path%force + force_correction
         path%rate = direction*path%rate
      end associate
   end subroutine solve_line

   !> The first spring that cannot go the way it should on its present line.
   subroutine first_without_room(path, direction, i, way)
      type(path_type), intent(in) :: path
      integer, intent(in) :: direction
      !> Spring, 0 if all have room; and its way
      integer, intent(out) :: i, way

      associate (springs => path%springs)
         do i = 1, springs%count
            if (path%rate(i) > 0.0_wp) then
               way = 1
               if (springs%one_way(i) < 0 .or. springs%d(i) >= springs%line(i)%hi) return
            else if (path%rate(i) < 0.0_wp) then
               way = -1
               if (springs%one_way(i) > 0 .or. springs%d(i) <= springs%line(i)%lo) return
            end if
         end do
      end associate
      i = 0
      way = direction
   end subroutine first_without_room

   !> Set out on the line found: where it begins and where it ends.
   subroutine begin_line(path, direction)
      type(path_type), intent(inout) :: path
      integer, intent(in) :: direction
      real(wp) :: way, room
      integer :: i

      path%direction = direction
      path%start = path%control
      path%displacement_start = path%displacement
      path%q = path%springs%d + path%correction
      if (path%by_force) path%displacement_start = sum(path%equilibrium%arm*path%q)
      way = huge(1.0_wp)
      path%ends = 0
      do i = 1, path%springs%count
         associate (line => path%springs%line(i), rate => path%rate(i))
            room = huge(1.0_wp)
            if (rate > 0.0_wp) room = distance(line%hi - path%q(i), rate)
            if (rate < 0.0_wp) room = distance(path%q(i) - line%lo, -rate)
            if (room < way) then
               way = room
               path%ends = i
            end if
         end associate
      end do
      path%finish = direction*huge(1.0_wp)
      if (path%ends > 0) path%finish = path%start + direction*way
   end subroutine begin_line

   !> How far the driven end goes until a spring has gone a way; a line without end stays so.
   pure real(wp) function distance(way, rate)
      real(wp), intent(in) :: way, rate

      distance = huge(1.0_wp)
      if (way < 0.5_wp*huge(1.0_wp)*min(rate, 1.0_wp)) distance = max(way, 0.0_wp)/rate
   end function distance

   !> Go along the line; every spring comes along on its own.
   subroutine go(path, control)
      type(path_type), intent(inout) :: path
      real(wp), intent(in) :: control
      real(wp) :: change, force, displacement, d
      integer :: i

      change = control - path%start
      associate (springs => path%springs)
         do i = 1, springs%count
            d = path%q(i) + path%rate(i)*abs(change)
            call springs%walk(i, min(max(d, springs%first(i)), springs%last(i)))
            if (is_on_end(springs%line(i), d, path%rate(i))) then
               call springs%arrive(i, merge(1, -1, path%rate(i) > 0.0_wp))
               path%direction = 0
            end if
         end do
      end associate
      force = path%force_start + path%force_rate*change
      displacement = path%displacement_start + path%displacement_rate*change
      if (path%by_force) then
         force = control
      else
         displacement = control
      end if
      path%work = path%work + 0.5_wp*(force + path%force)*(displacement - path%displacement)
      path%force = force
      path%displacement = displacement
      path%control = control
   end subroutine go

   !> Whether a spring has come to the open end that it goes to.
   pure logical function is_on_end(line, d, rate)
      type(segment), intent(in) :: line
      real(wp), intent(in) :: d, rate

      is_on_end = .false.
      if (rate > 0.0_wp .and. .not. line%hi_closed) then
         is_on_end = line%hi - d <= on_the_end*abs(line%hi)
      else if (rate < 0.0_wp .and. .not. line%lo_closed) then
         is_on_end = d - line%lo <= on_the_end*abs(line%lo)
      end if
   end function is_on_end

   !> The spring that ends the line stands exactly on its end.
   subroutine end_line(path)
      type(path_type), intent(inout) :: path
      integer :: i

      i = path%ends
      ! If `go` has put it there already, the line is done with.
      if (path%direction /= 0 .and. i > 0) call path%springs%arrive(i, merge(1, -1, path%rate(i) > 0.0_wp))
      path%direction = 0
   end subroutine end_line

   !> Say why the path cannot be carried on.
   subroutine report_no_line(path, target, error)
      type(path_type), intent(in) :: path
      real(wp), intent(in) :: target
      type(error_type), allocatable, intent(out) :: error
      type(error_type), allocatable :: ignored
      character(len=:), allocatable :: spring, state, remark
      real(wp) :: factor
      integer :: i, n

      call describe_state(path, state)
      remark = ''
      if (path%equilibrium%coupled) remark = ' above what the axial load takes away'
      n = path%equilibrium%column%n
      i = minloc(path%springs%k/path%equilibrium%initial_stiffness, dim=1)
      spring = 'the shear spring of joint '//to_text(min(i, n))
      if (i > n) spring = 'the flexural spring of joint '//to_text(i - n)
      call critical_factor(path%equilibrium%column, factor, ignored)
      if (.not. path%by_force) then
         call fatal_error(error, analysis_failed, 'the column has no single answer to the displacement '// &
                          to_text(target)//' m at '//state//': '//spring// &
                          ' and the axial load leave it without stiffness. Change the axial load '// &
                          'or the stiffness after yield')
      else if (factor <= 1.0_wp) then
         call fatal_error(error, analysis_failed, 'the axial load is '//to_text(1.0_wp/factor)// &
                          ' times the critical load of the uncracked column, which buckles by itself; '// &
                          'reduce axial_load, stiffen the springs, or drive it by displacement')
      else
         call fatal_error(error, analysis_failed, 'the lateral force '//to_text(target)// &
                          ' N is beyond the capacity of the column: '//spring// &
                          ' has no stiffness left at '//state//'. The path up to there is '// &
                          'kept; drive the column by displacement, or give the spring a stiffness '// &
                          'after yield'//remark)
      end if
   end subroutine report_no_line

   !> Where the path is, for a message.
   subroutine describe_state(path, text)
      type(path_type), intent(in) :: path
      character(len=:), allocatable, intent(out) :: text

      text = 'force '//to_text(path%force)//' N, displacement '//to_text(path%displacement)//' m'
   end subroutine describe_state

   !> The present state as a row.
   subroutine fill_row(path, row, number)
      type(path_type), intent(in) :: path
      real(wp), intent(out) :: row(:)
      integer, intent(in) :: number
      integer :: m

      associate (springs => path%springs)
         m = springs%count
         row(row_time) = number
         row(row_displacement) = path%displacement
         row(row_force) = path%force
         row(row_input) = path%work
         row(row_kinetic) = 0.0_wp
         row(row_spring) = sum(springs%work)
         row(row_damping) = 0.0_wp
         row(row_axial) = 0.0_wp
         if (path%equilibrium%coupled) row(row_axial) = axial_energy(path%equilibrium%column, springs%d)
         row(row_residual) = row(row_input) - row(row_spring) - row(row_axial)
         row(row_joints:row_joints + m - 1) = springs%d
         row(row_joints + m:) = springs%f0 + springs%k*(springs%d - springs%d0)
      end associate
   end subroutine fill_row

end module rbs_solve_static
