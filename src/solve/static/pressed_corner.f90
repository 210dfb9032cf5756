!> The lines on which all springs of a column go on under an axial load that varies.
module rbs_solve_static_pressed_corner
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_springs, only: spring_array
   use rbs_solve_static_pressed_balance, only: pressed_balance, pressed_point
   implicit none
   private

   public :: find_lines

   !> Most searches for lines at one corner
   integer, parameter :: most_searches = 100

contains

   !> Find the lines on which all springs go on: those without room are put on the next one, layered joints
   !> choose theirs for the rates found, until the rates agree with the lines.
   subroutine find_lines(balance, springs, at, found)
      class(pressed_balance), intent(inout) :: balance
      type(spring_array), intent(inout) :: springs
      !> Where the column is; its rates are found
      type(pressed_point), intent(inout) :: at
      logical, intent(out) :: found
      real(wp) :: correction(size(at%q)), force_correction
      integer :: search, i
      logical :: changed

      do search = 1, most_searches
         call balance%solve_point(springs, at, correction, force_correction, found)
         if (.not. found) return
         changed = .false.
         do i = 1, size(at%q)
            if (any(springs%layered == i)) then
               call choose_joint(springs, i, at%rate(i), at%press_rate(i - balance%column%n), changed)
            else
               call leave_end(springs, i, at%rate(i), changed)
            end if
         end do
         if (springs%lost_joint() > 0) return
         if (.not. changed) return
      end do
      found = .false.
   end subroutine find_lines

   !> A layered joint chooses its lines for the present rates.
   subroutine choose_joint(springs, i, turn, press, changed)
      type(spring_array), intent(inout) :: springs
      integer, intent(in) :: i
      !> Rates of the rotation and of the axial load
      real(wp), intent(in) :: turn, press
      logical, intent(inout) :: changed
      real(wp) :: before(2)

      before = [springs%k(i), springs%centre(i)]
      call springs%choose_lines(i, turn, press)
      changed = changed .or. any(abs(before - [springs%k(i), springs%centre(i)]) > 0.0_wp)
   end subroutine choose_joint

   !> Put a spring that has no room in the direction of its rate on the next line.
   subroutine leave_end(springs, i, rate, changed)
      type(spring_array), intent(inout) :: springs
      integer, intent(in) :: i
      real(wp), intent(in) :: rate
      logical, intent(inout) :: changed
      integer :: way

      if (.not. abs(rate) > 0.0_wp) return
      way = merge(1, -1, rate > 0.0_wp)
      if (springs%one_way(i) /= -way .and. way*(springs%end_toward(i, way) - springs%d(i)) > 0.0_wp) return
      call springs%leave(i, way)
      changed = .true.
   end subroutine leave_end

end module rbs_solve_static_pressed_corner
