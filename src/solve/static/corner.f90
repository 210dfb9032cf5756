!> The lines on which a structure leaves a corner of its static path.
!>
!> At a corner a spring stands at an end of its line, or on a one-way line against its way. Which springs
!> go on and which turn back must be found together: a linear complementarity problem.
module rbs_solve_static_corner
   use rbs_base_error, only: error_type, fatal_error, analysis_failed
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_hysteresis_interaction_joints, only: choose_lines
   use rbs_hysteresis_springs, only: spring_array
   use rbs_solve_static_path, only: static_path, state_of, weakest_spring
   implicit none
   private

   public :: turn_corner, report_no_line

   !> Most springs whose two ways out of a corner are tried in all combinations, and most trials times
   !> springs.
   integer, parameter :: most_tried = 14, most_work = 1000000

   !> How often all springs may be changed at once while their least number without room stays the same.
   integer, parameter :: patience = 3

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
      integer :: changes, count, fewest, left, i
      logical :: found

      path%direction = 0
      path%changed = 0
      fewest = huge(1)
      left = patience
      do changes = 1, 20 + min(10*path%moving, 1000 + path%moving)
         call path%solve_line(direction, found)
         if (.not. found) then
            ! Some springs may unload, though there is no stiffness under the driven force: let them.
            if (path%by_force .and. any(path%springs%unload_on_reversal(:path%moving) == -direction)) then
               do i = 1, path%moving
                  if (path%springs%unload_on_reversal(i) == -direction) call path%springs%leave(i, direction)
               end do
               cycle
            end if
            call report_no_line(path, target, error)
            return
         end if
         count = without_room()
         if (path%springs%pressed) call choose_planes(count)
         if (path%springs%lost_joint() > 0) return
         if (count == 0) then
            path%direction = direction
            return
         end if
         if (count < fewest) then
            fewest = count
            left = patience
         else
            left = left - 1
         end if
         call change_lines(left >= 0)
      end do
      call try_all_ways()
      if (found) then
         path%direction = direction
      else
         call fatal_error(error, analysis_failed, 'the structure snaps back at '//trim(state_of(path))// &
                          ': no combination of loading and unloading springs was found that lets its '// &
                          'top go on; '//trim(weakest_spring(path))//' has the least stiffness left. A '// &
                          'driven top cannot follow that; use a dynamic analysis')
      end if

   contains

      !> The layers of joints whose axial loads vary choose their lines for the present rates; a joint whose
      !> plane changes by that had no room on it.
      subroutine choose_planes(count)
         integer, intent(inout) :: count
         real(wp) :: before(2)
         integer :: i, j

         do j = 1, size(path%springs%layered)
            i = path%springs%layered(j)
            before = [path%springs%k(i), path%springs%centre(i)]
            call choose_lines(path%springs, i, path%rate(i), path%axial_rate)
            if (any(abs(before - [path%springs%k(i), path%springs%centre(i)]) > 0.0_wp)) count = count + 1
         end do
      end subroutine choose_planes

      !> Number of springs that cannot go the way they should on their present lines.
      pure integer function without_room() result(count)
         integer :: i

         count = 0
         do i = 1, path%moving
            if (barred(path, i) /= 0) count = count + 1
         end do
      end function without_room

      !> Put the springs without room on the lines that follow, all or the first of them.
      subroutine change_lines(all_of_them)
         logical, intent(in) :: all_of_them
         integer :: i, way

         do i = 1, path%moving
            way = barred(path, i)
            if (way == 0) cycle
            path%changed(i) = path%changed(i) + 1
            call path%springs%leave(i, way)
            if (.not. all_of_them) return
         end do
      end subroutine change_lines

      !> Try both ways of the springs at the corner in all combinations, one change at a time (Gray code),
      !> until
      !> all have room. Of more springs than can be tried, those come first that the search has changed more
      !> than
      !> once.
      subroutine try_all_ways()
         integer, allocatable :: tried(:)
         integer :: trial, i, most, count

         tried = pack([(i, i=1, path%moving)], [(way_out(path%springs, i) /= 0, i=1, path%moving)])
         tried = [pack(tried, path%changed(tried) > 1), pack(tried, path%changed(tried) <= 1)]
         most = min(most_tried, int(log(real(most_work, wp)/path%moving)/log(2.0_wp)))
         tried = tried(:min(size(tried), most))
         found = .false.
         do trial = 1, 2**size(tried)
            call path%solve_line(direction, found)
            if (found) then
               count = without_room()
               if (path%springs%pressed) call choose_planes(count)
               found = count == 0
               if (found) return
            end if
         ! The bit that changes next in the Gray code.
            if (trial == 2**size(tried)) exit
            i = tried(trailz(trial) + 1)
            call path%springs%leave(i, way_out(path%springs, i))
         end do
         found = .false.
      end subroutine try_all_ways

   end subroutine turn_corner

   !> The direction in which a spring should go but cannot, 0 if it can.
   pure integer function barred(path, i)
      class(static_path), intent(in) :: path
      integer, intent(in) :: i

      barred = 0
      associate (springs => path%springs)
         ! A spring is beyond the last deformation of its line where the end itself does not belong to it.
         if (path%rate(i) > 0.0_wp) then
            if (springs%unload_on_reversal(i) < 0 .or. springs%d(i) > springs%last(i) .or. &
                (springs%includes_upper_end(i) .and. springs%d(i) >= springs%last(i))) barred = 1
         else if (path%rate(i) < 0.0_wp) then
            if (springs%unload_on_reversal(i) > 0 .or. springs%d(i) < springs%first(i) .or. &
                (springs%includes_lower_end(i) .and. springs%d(i) <= springs%first(i))) barred = -1
         end if
      end associate
   end function barred

   !> The way by which a spring can leave its line where it stands, 0 if it cannot.
   pure integer function way_out(springs, i)
      type(spring_array), intent(in) :: springs
      integer, intent(in) :: i

      way_out = -springs%unload_on_reversal(i)
      if (way_out /= 0) return
      if (springs%d(i) >= springs%end_toward(i, 1)) then
         way_out = 1
      else if (springs%d(i) <= springs%end_toward(i, -1)) then
         way_out = -1
      end if
   end function way_out

   !> Report why the path cannot be continued.
   subroutine report_no_line(path, target, error)
      class(static_path), intent(in) :: path
      real(wp), intent(in) :: target
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: remark

      remark = ''
      if (path%structure%axially_loaded) remark = ' above what the axial load takes away'
      if (path%lost_digits) then
         call fatal_error(error, analysis_failed, 'the stiffnesses are too far apart for the arithmetic at '// &
                          trim(state_of(path))//': '//trim(weakest_spring(path))//' has the least left. '// &
                          'Take stiff springs less stiff, a million times the others is rigid enough, or '// &
                          'fewer bodies')
      else if (.not. path%by_force) then
         call fatal_error(error, analysis_failed, 'the equilibrium is not unique at the displacement '// &
                          to_text(target)//' m at '//trim(state_of(path))//': '// &
                          trim(weakest_spring(path))//' and the axial load leave it without stiffness. '// &
                          'Change the axial load or the stiffness after yield')
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
