!> A tabulated signal of time, linear between its points.
module rbs_loading_signal
   use rbs_base_kinds, only: wp
   implicit none
   private

   public :: signal_type

   type :: signal_type
      !> Times, strictly ascending (m) [s]; a signal without points is zero
      real(wp), allocatable :: time(:)
      !> Values (m)
      real(wp), allocatable :: value(:)
      !> The interval of the last call: time runs forward, so the next interval is the same or near
      integer, private :: at = 1
      !> The line in that interval, from `begin` to `finish` [s]: value = start + slope (t - begin). As long
      !> as none is known, the end is before the begin
      real(wp), private :: begin = 1.0_wp, finish = -1.0_wp, start = 0.0_wp, slope = 0.0_wp
   contains
      procedure :: at_time, corner_after, acts, is_nonzero, replace
      procedure, private :: find
   end type signal_type

contains

   !> Whether there is a signal.
   elemental logical function acts(self)
      class(signal_type), intent(in) :: self

      acts = allocated(self%value)
   end function acts

   !> Whether the signal has a value that is not zero.
   pure logical function is_nonzero(self)
      class(signal_type), intent(in) :: self

      is_nonzero = allocated(self%value)
      if (is_nonzero) is_nonzero = any(abs(self%value) > 0.0_wp)
   end function is_nonzero

   !> Value at a time; before the first point the first value, after the last one the last. At a point it is
   !> the end of the interval before it, from whichever side one comes: a run has the same bits with any
   !> neighbours.
   real(wp) function at_time(self, t) result(value)
      class(signal_type), intent(inout) :: self
      !> Time [s]
      real(wp), intent(in) :: t

      if (t < self%begin .or. t > self%finish) call self%find(t)
      value = self%start + self%slope*(t - self%begin)
   end function at_time

   !> The first point after a time, where the slope changes; `huge` if there is none [s].
   real(wp) function corner_after(self, t) result(corner)
      class(signal_type), intent(inout) :: self
      !> Time [s]
      real(wp), intent(in) :: t
      real(wp) :: after

      ! A time that is the point but for round-off is past it.
      after = t + 8.0_wp*spacing(t)
      if (after < self%begin .or. after >= self%finish) call self%find(after)
      corner = self%finish
   end function corner_after

   !> Take other points, as many as there are, and forget the interval.
   pure subroutine replace(self, time, value)
      class(signal_type), intent(inout) :: self
      !> Times, strictly ascending (m) [s], and values (m)
      real(wp), intent(in) :: time(:), value(:)

      self%time(:) = time
      self%value(:) = value
      self%at = 1
      self%begin = 1.0_wp
      self%finish = -1.0_wp
   end subroutine replace

   !> Find the interval that holds t, and keep its line.
   subroutine find(self, t)
      class(signal_type), intent(inout) :: self
      !> Time [s]
      real(wp), intent(in) :: t
      integer :: last

      last = size(self%time)
      self%slope = 0.0_wp
      if (t <= self%time(1)) then
         self%begin = -huge(1.0_wp)/2
         self%finish = self%time(1)
         self%start = self%value(1)
         self%at = 1
         return
      else if (t > self%time(last)) then
         self%begin = self%time(last)
         self%finish = huge(1.0_wp)
         self%start = self%value(last)
         self%at = last
         return
      end if
      ! From the last interval, backward or forward
      self%at = min(self%at, last - 1)
      do while (t < self%time(self%at))
         self%at = self%at - 1
      end do
      do while (t > self%time(self%at + 1))
         self%at = self%at + 1
      end do
      self%begin = self%time(self%at)
      self%finish = self%time(self%at + 1)
      self%start = self%value(self%at)
      self%slope = (self%value(self%at + 1) - self%start)/(self%finish - self%begin)
   end subroutine find

end module rbs_loading_signal
