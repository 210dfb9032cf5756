!> The basis of all rules: at any moment a spring is on a straight line with two ends.
module rbs_hysteresis_segment
   use rbs_base_kinds, only: wp
   use rbs_base_constants, only: unbounded
   use rbs_base_stream, only: stream_type
   implicit none
   private

   public :: segment

   !> The line f = f0 + k (d - d0) and the deformations between which it holds.
   !>
   !> The force is always computed from the fixed anchor (d0, f0), never by adding increments, so that
   !> it does not depend on the steps of a path.
   type :: segment
      !> Anchor: deformation [m or rad] and force [N or N m] of one point of the line
      real(wp) :: d0 = 0.0_wp, f0 = 0.0_wp
      !> Slope [N/m or N m/rad]
      real(wp) :: k = 0.0_wp
      !> Ends: least and largest deformation
      real(wp) :: lo = -unbounded, hi = unbounded
      !> Whether the point at the end still belongs to this line. An open end belongs to the line that
      !> follows: a spring that arrives there is on that line. Only a crossing of zero force is closed.
      logical :: lo_closed = .false., hi_closed = .false.
      !> A one-way line is left at once when the motion turns back: its rear end moves with the spring.
      !> +1: one-way upward, lo moves; -1: one-way downward, hi moves; 0: both ways.
      integer :: one_way = 0
   contains
      procedure :: force
      procedure :: end_toward
      procedure :: outward
      procedure :: serialize
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

   !> A line through (d0, f0) seen from side s: it leads outward to `far`, and back to `near`.
   !> Rules are written once, for the positive side; this procedure mirrors their lines.
   elemental type(segment) function outward(self, s, near, far, near_closed, one_way) result(line)
      !> Anchor and slope are taken from here
      class(segment), intent(in) :: self
      !> Side, +1 or -1
      integer, intent(in) :: s
      !> Ends, `far` further in the direction s than `near`
      real(wp), intent(in) :: near, far
      !> Whether the near end is closed; that of a one-way line always is, as the spring is on it
      logical, intent(in) :: near_closed
      !> Whether the line is left when the motion turns back from s
      logical, intent(in) :: one_way

      line = segment(d0=self%d0, f0=self%f0, k=self%k)
      if (s > 0) then
         line%lo = near
         line%hi = far
         line%lo_closed = near_closed .or. one_way
      else
         line%lo = far
         line%hi = near
         line%hi_closed = near_closed .or. one_way
      end if
      if (one_way) line%one_way = s
   end function outward

   !> Save or restore the line.
   pure subroutine serialize(self, stream)
      class(segment), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%item(self%d0)
      call stream%item(self%f0)
      call stream%item(self%k)
      call stream%item(self%lo)
      call stream%item(self%hi)
      call stream%item(self%lo_closed)
      call stream%item(self%hi_closed)
      call stream%item(self%one_way)
   end subroutine serialize

end module rbs_hysteresis_segment
