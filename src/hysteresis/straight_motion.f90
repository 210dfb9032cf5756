!> Springs that move at constant rates, each on its own line: those that cannot, the first end of a line that
!> they reach, and the motion itself. The springs that move are the first ones.
module rbs_hysteresis_straight_motion
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_springs, only: spring_array
   implicit none
   private

   public :: find_blocked, nearest_end, go_along

   !> Ways beyond this, in units of the rates, have no end.
   real(wp), parameter :: farthest = 1.0e100_wp

contains

   !> Springs blocked on their lines in their direction of motion.
   pure subroutine find_blocked(springs, rate, blocked, count)
      type(spring_array), intent(in) :: springs
      real(wp), intent(in), contiguous :: rate(:)
      !> The springs, and how many they are
      integer, intent(out) :: blocked(size(rate)), count
      integer :: i

      count = 0
      associate (d => springs%d, lower => springs%lower, upper => springs%upper, &
                 one_way => springs%unload_on_reversal)
         do i = 1, size(rate)
            ! A spring is beyond the highest deformation of its line where the end itself is no part of it.
            if (rate(i) > 0.0_wp) then
               if (d(i) < upper(i) .and. one_way(i) >= 0) cycle
               if (.not. (d(i) > upper(i) .or. one_way(i) < 0 .or. springs%includes_upper_end(i))) cycle
            else if (rate(i) < 0.0_wp) then
               if (d(i) > lower(i) .and. one_way(i) <= 0) cycle
               if (.not. (d(i) < lower(i) .or. one_way(i) > 0 .or. springs%includes_lower_end(i))) cycle
            else
               cycle
            end if
            count = count + 1
            blocked(count) = i
         end do
      end associate
   end subroutine find_blocked

   !> The first end of a line that springs reach from given deformations.
   pure subroutine nearest_end(springs, q, rate, stride, ends)
      type(spring_array), intent(in) :: springs
      !> Deformations and rates
      real(wp), intent(in), contiguous :: q(:), rate(:)
      !> In units of the rates; `huge` if there is none
      real(wp), intent(out) :: stride
      !> The spring, 0 for none
      integer, intent(out) :: ends
      real(wp) :: clearance, most
      integer :: i

      stride = huge(1.0_wp)
      most = farthest
      ends = 0
      associate (lower => springs%lower, upper => springs%upper)
         do i = 1, size(q)
            ! The end itself may lie beyond the highest deformation of the line: far beyond, where
            ! the rate is next to nothing.
            if (rate(i) > 0.0_wp) then
               if (upper(i) - q(i) > most*rate(i)) cycle
               clearance = distance(springs%end_toward(i, 1) - q(i), rate(i))
            else if (rate(i) < 0.0_wp) then
               if (q(i) - lower(i) > -most*rate(i)) cycle
               clearance = distance(q(i) - springs%end_toward(i, -1), -rate(i))
            else
               cycle
            end if
            if (.not. clearance < stride) cycle
            stride = clearance
            most = min(stride, farthest)
            ends = i
         end do
      end associate
   end subroutine nearest_end

   !> How long a spring needs for a distance; `huge` on a line without end.
   elemental real(wp) function distance(stride, rate)
      real(wp), intent(in) :: stride, rate

      distance = huge(1.0_wp)
      if (stride < 0.5_wp*huge(1.0_wp)*min(rate, 1.0_wp)) distance = max(stride, 0.0_wp)/rate
   end function distance

   !> Springs move at constant rates from given deformations, each on its own line and not beyond its end, and
   !> the coordinates behind them move too.
   pure subroutine go_along(springs, moving, q, rate, stride, slack, way, near, count)
      type(spring_array), intent(inout) :: springs
      !> Number of springs that move, the first ones
      integer, intent(in) :: moving
      !> From where (size of `d`), and the rates; in units of the rates
      real(wp), intent(in), contiguous :: q(:), rate(:)
      real(wp), intent(in) :: stride
      !> Springs that come closer than this to the end of their line, in shares of the end or on a way in
      !> units of the rates, are near it
      real(wp), intent(in) :: slack, way
      !> The springs near the ends that they approach, and their number
      integer, intent(out) :: near(moving), count

      associate (behind => springs%count + 1)
         springs%d(behind:) = q(behind:) + rate(behind:)*stride
      end associate
      call advance_along(moving, q, rate, stride, slack, way, springs%d0, springs%f0, springs%k, &
                         springs%unload_on_reversal, springs%d, springs%work, springs%lower, springs%upper, &
                         near, count)
   end subroutine go_along

   !> The loops of `go_along` on bare arrays, from which the compiler makes vector instructions.
   pure subroutine advance_along(n, q, rate, stride, slack, way, d0, f0, k, unload_on_reversal, d, work, &
                                 lower, upper, near, count)
      integer, intent(in) :: n, unload_on_reversal(n)
      real(wp), intent(in) :: q(n), rate(n), stride, slack, way, d0(n), f0(n), k(n)
      real(wp), intent(inout) :: d(n), work(n), lower(n), upper(n)
      integer, intent(out) :: near(n), count
      real(wp) :: to
      integer :: i

      !$omp simd
      do i = 1, n
         to = min(max(q(i) + rate(i)*stride, lower(i)), upper(i))
         work(i) = work(i) + (f0(i) + k(i)*(0.5_wp*(to + d(i)) - d0(i)))*(to - d(i))
         d(i) = to
      end do
      count = 0
      do i = 1, n
         if (unload_on_reversal(i) > 0) lower(i) = d(i)
         if (unload_on_reversal(i) < 0) upper(i) = d(i)
         if (rate(i) > 0.0_wp) then
            if (upper(i) - d(i) > slack*abs(upper(i)) + way*rate(i)) cycle
         else
            if (d(i) - lower(i) > slack*abs(lower(i)) - way*rate(i)) cycle
         end if
         count = count + 1
         near(count) = i
      end do
   end subroutine advance_along

end module rbs_hysteresis_straight_motion
