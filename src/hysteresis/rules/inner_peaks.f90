!> The memory of a reloading rule: the peaks of inner loops that are still open, oldest first.
module rbs_hysteresis_rules_inner_peaks
   use, intrinsic :: iso_fortran_env, only: int64
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_hysteresis_segment, only: segment
   implicit none
   private

   public :: point, reloading_line, inner_peak, inner_peaks

   !> Most peaks that are remembered; beyond that the older half is forgotten, so that memory is bounded
   !> in a vibration whose amplitude decreases for ever.
   integer, parameter :: most_peaks = 4096

   !> A point of the diagram.
   type :: point
      !> Deformation [m or rad] and force [N or N m]
      real(wp) :: d = 0.0_wp, f = 0.0_wp
   contains
      procedure :: serialize => serialize_point
   end type point

   !> A reloading line, with all that is needed to continue on it later.
   type :: reloading_line
      !> Anchor and slope of the line
      type(segment) :: line
      !> The point it aims at
      type(point) :: target
      !> Serial number of the inner peak it aims at, 0 for the peak on the backbone
      integer(int64) :: target_serial = 0_int64
      !> The crossing of zero force at which it started [m or rad]
      real(wp) :: zero = 0.0_wp
   contains
      procedure :: serialize => serialize_reloading
   end type reloading_line

   !> A point where reloading turned back.
   type :: inner_peak
      !> Side, +1 or -1
      integer :: side = 0
      !> Serial number, ascending; 64 bits do not run out
      integer(int64) :: serial = 0_int64
      type(point) :: at
      !> The line that was left here
      type(reloading_line) :: left
   end type inner_peak

   !> The open inner peaks.
   type :: inner_peaks
      !> Number of peaks
      integer :: count = 0
      !> The last serial number
      integer(int64) :: last_serial = 0_int64
      type(inner_peak), allocatable :: peak(:)
   contains
      procedure :: push
      procedure :: take
      procedure :: serialize => serialize_peaks
      procedure :: newest_of_side
      procedure :: place_of
   end type inner_peaks

contains

   !> Remember a peak as the newest.
   subroutine push(self, side, at, left)
      class(inner_peaks), intent(inout) :: self
      integer, intent(in) :: side
      type(point), intent(in) :: at
      type(reloading_line), intent(in) :: left
      type(inner_peak), allocatable :: longer(:)
      integer :: i, dropped

      if (.not. allocated(self%peak)) allocate (self%peak(8))
      if (self%count == most_peaks) then
         dropped = most_peaks/2
         do i = 1, self%count - dropped
            self%peak(i) = self%peak(i + dropped)
         end do
         self%count = self%count - dropped
      else if (self%count == size(self%peak)) then
         allocate (longer(2*self%count))
         longer(:self%count) = self%peak
         call move_alloc(longer, self%peak)
      end if
      self%count = self%count + 1
      self%last_serial = self%last_serial + 1_int64
      self%peak(self%count) = inner_peak(side, self%last_serial, at, left)
   end subroutine push

   !> Become a copy of another, in the room that is there if it is enough. Peaks do not change once they are
   !> there, so that where both have the same one, those below it are the same too.
   pure subroutine take(self, other)
      class(inner_peaks), intent(inout) :: self
      type(inner_peaks), intent(in) :: other
      integer :: i, known

      known = min(self%count, other%count)
      self%count = other%count
      self%last_serial = other%last_serial
      if (other%count == 0) return
      if (allocated(self%peak)) then
         if (size(self%peak) < other%count) then
            deallocate (self%peak)
            known = 0
         end if
      end if
      if (.not. allocated(self%peak)) allocate (self%peak(size(other%peak)))
      do i = other%count, 1, -1
         if (i <= known) then
            if (same_peak(self%peak(i), other%peak(i))) exit
         end if
         self%peak(i) = other%peak(i)
      end do
   end subroutine take

   pure logical function same_peak(one, other)
      type(inner_peak), intent(in) :: one, other

      same_peak = one%serial == other%serial .and. one%side == other%side .and. &
                  .not. (abs(one%at%d - other%at%d) > 0.0_wp .or. abs(one%at%f - other%at%f) > 0.0_wp)
   end function same_peak

   !> Place of the newest peak on a side, 0 if there is none.
   pure integer function newest_of_side(self, side) result(place)
      class(inner_peaks), intent(in) :: self
      integer, intent(in) :: side

      do place = self%count, 1, -1
         if (self%peak(place)%side == side) return
      end do
      place = 0
   end function newest_of_side

   !> Place of the peak with a serial number, 0 if it has been forgotten.
   pure integer function place_of(self, serial) result(place)
      class(inner_peaks), intent(in) :: self
      integer(int64), intent(in) :: serial

      do place = self%count, 1, -1
         if (self%peak(place)%serial == serial) return
      end do
      place = 0
   end function place_of

   pure subroutine serialize_point(self, stream)
      class(point), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%item(self%d)
      call stream%item(self%f)
   end subroutine serialize_point

   pure subroutine serialize_reloading(self, stream)
      class(reloading_line), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call self%line%serialize(stream)
      call self%target%serialize(stream)
      call stream%item(self%target_serial)
      call stream%item(self%zero)
   end subroutine serialize_reloading

   !> Save or restore the open peaks; they come back into the room that is there if it is enough.
   pure subroutine serialize_peaks(self, stream)
      class(inner_peaks), intent(inout) :: self
      type(stream_type), intent(inout) :: stream
      integer :: i

      call stream%item_count(self%count, most_peaks)
      call stream%item(self%last_serial)
      if (stream%restoring) then
         if (allocated(self%peak)) then
            if (size(self%peak) < self%count) deallocate (self%peak)
         end if
         if (.not. allocated(self%peak) .and. self%count > 0) allocate (self%peak(self%count))
      end if
      do i = 1, self%count
         call stream%item(self%peak(i)%side)
         call stream%item(self%peak(i)%serial)
         call self%peak(i)%at%serialize(stream)
         call self%peak(i)%left%serialize(stream)
      end do
   end subroutine serialize_peaks

end module rbs_hysteresis_rules_inner_peaks
