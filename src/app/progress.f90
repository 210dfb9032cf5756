!> Progress of a long run on a terminal; nothing is written to a pipe.
!>
!> Lines on standard output, through C: the Fortran library does not report a full disk.
module rbs_app_progress
   use, intrinsic :: iso_c_binding, only: c_int, c_size_t
   use, intrinsic :: iso_fortran_env, only: error_unit, int64
   use rbs_base_error, only: error_type, fatal_error, analysis_failed
   use rbs_base_kinds, only: wp
   use rbs_io_posix, only: c_write, standard_output
   use rbs_output_recorder, only: observer_type
   implicit none
   private

   public :: terminal_progress, say

   !> Runs shorter than this show no progress; least time between two updates [s].
   real(wp), parameter :: quiet_time = 1.0_wp, pause = 0.2_wp

   !> Signs of the bar
   integer, parameter :: bar_length = 30

   character(len=1), parameter :: carriage_return = achar(13)

   type, extends(observer_type) :: terminal_progress
      !> Whether a line is on the terminal now; whether progress is to be shown
      logical :: shown = .false.
      logical, private :: wanted = .false.
      !> Times of the clock at the begin and at the last update [s]
      real(wp), private :: begin = 0.0_wp, last = 0.0_wp
   contains
      procedure :: start, update, finish
   end type terminal_progress

   interface
      !> In C: 1 if a file descriptor is a terminal.
      integer(c_int) function c_isatty(descriptor) bind(c, name='isatty') result(answer)
         import :: c_int
         integer(c_int), value :: descriptor
      end function c_isatty
   end interface

contains

   !> Start the clock; progress is shown unless it is not wanted or goes to no terminal.
   subroutine start(self, quiet)
      class(terminal_progress), intent(inout) :: self
      !> Whether the user wants no progress
      logical, intent(in) :: quiet

      self%wanted = .false.
      ! Descriptor 2 is the standard error.
      if (.not. quiet) self%wanted = c_isatty(2_c_int) == 1_c_int
      self%begin = seconds()
   end subroutine start

   !> Show which share is done and how many seconds are left, some times a second.
   subroutine update(self, share)
      class(terminal_progress), intent(inout) :: self
      !> From 0 to 1
      real(wp), intent(in) :: share
      real(wp) :: now
      integer :: filled

      if (.not. self%wanted) return
      now = seconds()
      if (now - self%begin < quiet_time .or. now - self%last < pause) return
      self%last = now
      self%shown = .true.
      filled = nint(bar_length*share)
      write (error_unit, '(5a, i3, a, i0, a)', advance='no') carriage_return, '[', repeat('#', filled), &
         repeat('.', bar_length - filled), '] ', nint(100.0_wp*share), ' % ', &
         nint(min((now - self%begin)*(1.0_wp/max(share, 1.0e-6_wp) - 1.0_wp), 1.0e6_wp)), ' s left       '
      flush (error_unit)
   end subroutine update

   !> Erase the line of progress.
   subroutine finish(self)
      class(terminal_progress), intent(inout) :: self

      if (self%shown) then
         write (error_unit, '(3a)', advance='no') carriage_return, repeat(' ', 70), carriage_return
      end if
      self%shown = .false.
   end subroutine finish

   !> Time of the system clock [s].
   real(wp) function seconds()
      integer(int64) :: count, rate

      call system_clock(count, rate)
      seconds = real(count, wp)/rate
   end function seconds

   !> Print a line on standard output, unless an error has occurred.
   subroutine say(line, error)
      character(len=*), intent(in) :: line
      type(error_type), allocatable, intent(inout) :: error
      character(len=len(line) + 1) :: text
      integer(c_size_t) :: written
      integer :: at

      if (allocated(error)) return
      text = line//new_line('a')
      at = 1
      do while (at <= len(text))
         ! The system may take a part only.
         written = c_write(standard_output, text(at:), int(len(text) - at + 1, c_size_t))
         if (written < 1_c_size_t) then
            call fatal_error(error, analysis_failed, 'standard output cannot be written; is the disk full?')
            return
         end if
         at = at + int(written)
      end do
   end subroutine say

end module rbs_app_progress
