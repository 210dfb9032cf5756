!> The basis of all rules: at any moment a spring is on a straight line with two ends.
module rbs_hysteresis_segment
   use, intrinsic :: iso_fortran_env, only: int64
   use rbs_base_kinds, only: wp
   use rbs_base_constants, only: unbounded
   use rbs_base_stream, only: stream_type
   implicit none
   private

   public :: segment, lowest_on, highest_on, upper_end, lower_end

   !> The line f = f0 + k (d - d0) and the deformations between which it holds.
   !>
   !> The force is always computed from the fixed anchor (d0, f0), never by adding increments, so that
   !> it does not depend on the steps of a path.
   type :: segment
      !> Anchor: deformation [m or rad] and force [N or N m] of one point of the line; slope [N/m or N m/rad]
      real(wp) :: d0 = 0.0_wp, f0 = 0.0_wp, k = 0.0_wp
      !> Ends: least and largest deformation
      real(wp) :: lo = -unbounded, hi = unbounded
      !> Whether the point at the end still belongs to this line. An open end belongs to the line that
      !> follows: a spring that arrives there is on that line. Only a crossing of zero force is closed.
      logical :: includes_lower_end = .false., includes_upper_end = .false.
      !> Whether the branch is left at once when the motion turns back, so that its rear end moves with the
      !> spring. +1: it leads upward, and lo moves; -1: downward, and hi moves; 0: it leads both ways.
      integer :: unload_on_reversal = 0
   contains
      procedure :: force, end_toward, lead_outward, serialize
   end type segment

contains

   !> Force on the line [N or N m].
   elemental real(wp) function force(self, d)
      class(segment), intent(in) :: self
      !> Deformation [m or rad]
      real(wp), intent(in) :: d

      force = self%f0 + self%k*(d - self%d0)
   end function force

   !> The end of the line in a direction, +1 or -1 [m or rad].
   elemental real(wp) function end_toward(self, direction)
      class(segment), intent(in) :: self
      integer, intent(in) :: direction

      end_toward = merge(self%hi, self%lo, direction > 0)
   end function end_toward

   !> From side s the branch leads outward to `far`, and back to `near`; anchor and slope stay. Rules are
   !> written once, for the positive side; this procedure mirrors their branches.
   pure subroutine lead_outward(self, s, near, far, unload_on_reversal, includes_near_end)
      class(segment), intent(inout) :: self
      !> Side, +1 or -1
      integer, intent(in) :: s
      !> Ends, `far` further in the direction s than `near`
      real(wp), intent(in) :: near, far
      !> Whether the branch is left when the motion turns back from s, by default yes. The spring is on the
      !> near end of such a branch
      logical, intent(in), optional :: unload_on_reversal
      !> Whether the near end belongs to a branch that leads both ways, by default yes; it always belongs to
      !> one that is left when the motion turns back
      logical, intent(in), optional :: includes_near_end
      logical :: included

      self%unload_on_reversal = s
      included = .true.
      if (present(unload_on_reversal)) then
         if (.not. unload_on_reversal) then
            self%unload_on_reversal = 0
            if (present(includes_near_end)) included = includes_near_end
         end if
      end if
      self%lo = merge(near, far, s > 0)
      self%hi = merge(far, near, s > 0)
      self%includes_lower_end = included .and. s > 0
      self%includes_upper_end = included .and. s <= 0
   end subroutine lead_outward

   !> Save or restore the line.
   pure subroutine serialize(self, stream)
      class(segment), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%item(self%d0)
      call stream%item(self%f0)
      call stream%item(self%k)
      call stream%item(self%lo)
      call stream%item(self%hi)
      call stream%item(self%includes_lower_end)
      call stream%item(self%includes_upper_end)
      call stream%item(self%unload_on_reversal)
   end subroutine serialize

   !> The lowest deformation that belongs to a line: its lower end, or the number above an open one.
   pure real(wp) function lowest_on(line)
      type(segment), intent(in) :: line

      lowest_on = line%lo
      if (.not. line%includes_lower_end .and. line%lo > -unbounded) lowest_on = next_above(line%lo)
   end function lowest_on

   !> The highest deformation that belongs to a line: its upper end, or the number below an open one.
   pure real(wp) function highest_on(line)
      type(segment), intent(in) :: line

      highest_on = line%hi
      if (.not. line%includes_upper_end .and. line%hi < unbounded) highest_on = -next_above(-line%hi)
   end function highest_on

   !> The upper end of a line from the highest deformation that belongs to it: the inverse of `highest_on`.
   elemental real(wp) function upper_end(highest, closed)
      real(wp), intent(in) :: highest
      !> Whether the end itself belongs to the line
      logical, intent(in) :: closed

      upper_end = highest
      if (.not. closed .and. highest < unbounded) upper_end = next_above(highest)
   end function upper_end

   !> The lower end of a line from the lowest deformation that belongs to it: the inverse of `lowest_on`.
   elemental real(wp) function lower_end(lowest, closed)
      real(wp), intent(in) :: lowest
      !> Whether the end itself belongs to the line
      logical, intent(in) :: closed

      lower_end = lowest
      if (.not. closed .and. lowest > -unbounded) lower_end = -next_above(-lowest)
   end function lower_end

   !> The next larger number, as `nearest(x, 1.0)` for finite numbers. The latter is a call of the C library,
   !> and an event needs up to five of them. The bits of a number, read as an integer, count the numbers from
   !> zero on: one more leads away from zero.
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

end module rbs_hysteresis_segment
