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

   !> Springs that are looked at together whether any needs a closer look: which way each moves is as good as
   !> random, and a branch for each would cost more than all of the rest.
   integer, parameter :: block_length = 32

contains

   !> Springs that cannot move on along their lines: they are on the end, or unload on this reversal.
   pure subroutine find_blocked(springs, rate, blocked, count)
      type(spring_array), intent(in) :: springs
      !> Rates of the springs that move; only their signs count
      real(wp), intent(in), contiguous :: rate(:)
      !> The blocked springs (the first `count` elements), and how many they are
      integer, intent(out) :: blocked(size(rate)), count
      integer :: first, last, i

      count = 0
      associate (d => springs%d, lower => springs%lower, upper => springs%upper, &
                 one_way => springs%unload_on_reversal)
         do first = 1, size(rate), block_length
            last = min(first + block_length - 1, size(rate))
            if (all_are_far(last - first + 1, d(first:last), rate(first:last), lower(first:last), &
                            upper(first:last), 0.0_wp, 0.0_wp)) then
               if (.not. any(one_way(first:last)*rate(first:last) < 0.0_wp)) cycle
            end if
            do i = first, last
               ! `upper` is the highest deformation of the line: where the end does not belong to it, the
               ! number below the end, and only a spring beyond that number is blocked.
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
         end do
      end associate
   end subroutine find_blocked

   !> The first end of a line that springs reach from the deformations q, moving by q + stride*rate.
   pure subroutine nearest_end(springs, q, rate, stride, ends)
      type(spring_array), intent(in) :: springs
      !> Deformations [m or rad] and rates of the springs that move
      real(wp), intent(in), contiguous :: q(:), rate(:)
      !> The stride at which that end is reached; `huge` if there is none
      real(wp), intent(out) :: stride
      !> The spring that reaches it, 0 for none
      integer, intent(out) :: ends
      real(wp) :: clearance, most
      integer :: first, last, i

      stride = huge(1.0_wp)
      most = farthest
      ends = 0
      associate (lower => springs%lower, upper => springs%upper)
         do first = 1, size(q), block_length
            last = min(first + block_length - 1, size(q))
            if (all_are_far(last - first + 1, q(first:last), rate(first:last), lower(first:last), &
                            upper(first:last), 0.0_wp, most)) cycle
            do i = first, last
               ! Most springs are passed over by the highest deformation of the line. The end itself may be
               ! the next number: a long stride, where the rate is next to nothing.
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
         end do
      end associate
   end subroutine nearest_end

   !> Whether the springs of a block all are farther from the ends of their lines that they move to than
   !> slack*|d| + way*|rate|. Fewer springs are not looked at together.
   pure logical function all_are_far(n, d, rate, lower, upper, slack, way)
      integer, intent(in) :: n
      real(wp), intent(in) :: d(n), rate(n), lower(n), upper(n), slack, way
      real(wp) :: near, up, room
      integer :: i

      all_are_far = .false.
      if (n < block_length) return
      near = 0.0_wp
      !$omp simd reduction(max:near) private(up, room)
      do i = 1, n
         ! One comparison, so that no branch keeps the loop from vectors. An end is no factor here: beside
         ! zero it is the smallest number there is, by which processors multiply a hundred times slower.
         up = 0.5_wp + sign(0.5_wp, rate(i))
         room = up*(upper(i) - d(i)) + (1.0_wp - up)*(d(i) - lower(i))
         near = max(near, merge(0.0_wp, 1.0_wp, room - slack*abs(d(i)) > way*abs(rate(i))))
      end do
      all_are_far = .not. near > 0.0_wp
   end function all_are_far

   !> How many times its rate a spring moves over a distance; `huge` on a line without end, or where the
   !> quotient would overflow.
   elemental real(wp) function distance(stride, rate)
      !> Distance to the end [m or rad], below zero only by round-off; rate, above zero
      real(wp), intent(in) :: stride, rate

      distance = huge(1.0_wp)
      if (stride < 0.5_wp*huge(1.0_wp)*min(rate, 1.0_wp)) distance = max(stride, 0.0_wp)/rate
   end function distance

   !> Springs move at constant rates from given deformations, each on its own line and not beyond its end, and
   !> the coordinates behind them move too.
   pure subroutine go_along(springs, moving, q, rate, stride, slack, way, near, count)
      !> Their deformations, works and moving rear ends are brought up to date
      type(spring_array), intent(inout) :: springs
      !> Number of springs that move, the first ones
      integer, intent(in) :: moving
      !> Deformations at the start [m or rad] and rates (size of `springs%d`)
      real(wp), intent(in), contiguous :: q(:), rate(:)
      !> The motion is to q + stride*rate
      real(wp), intent(in) :: stride
      !> A spring is near the end of its line if the distance left is at most slack*|d| + way*|rate|
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

   !> The loops of `go_along`, with its arguments, on bare arrays, from which the compiler makes vector
   !> instructions: n springs on lines f0 + k (d - d0) between `lower` and `upper`.
   pure subroutine advance_along(n, q, rate, stride, slack, way, d0, f0, k, unload_on_reversal, d, work, &
                                 lower, upper, near, count)
      integer, intent(in) :: n, unload_on_reversal(n)
      real(wp), intent(in) :: q(n), rate(n), stride, slack, way, d0(n), f0(n), k(n)
      real(wp), intent(inout) :: d(n), work(n), lower(n), upper(n)
      integer, intent(out) :: near(n), count
      real(wp) :: to, room
      integer :: first, last, i

      !$omp simd
      do i = 1, n
         ! The work of a line is exact with the force in the middle of the way.
         to = min(max(q(i) + rate(i)*stride, lower(i)), upper(i))
         work(i) = work(i) + (f0(i) + k(i)*(0.5_wp*(to + d(i)) - d0(i)))*(to - d(i))
         d(i) = to
      end do
      do i = 1, n
         if (unload_on_reversal(i) > 0) lower(i) = d(i)
         if (unload_on_reversal(i) < 0) upper(i) = d(i)
      end do
      count = 0
      do first = 1, n, block_length
         last = min(first + block_length - 1, n)
         if (all_are_far(last - first + 1, d(first:last), rate(first:last), lower(first:last), &
                         upper(first:last), slack, way)) cycle
         do i = first, last
            room = merge(upper(i) - d(i), d(i) - lower(i), rate(i) > 0.0_wp)
            if (room - slack*abs(d(i)) > way*abs(rate(i))) cycle
            count = count + 1
            near(count) = i
         end do
      end do
   end subroutine advance_along

end module rbs_hysteresis_straight_motion
