!> Which steps are taken from which time to which, and after which of them a row is kept.
module rbs_solve_time_plan
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use rbs_base_constants, only: beyond_meaning
   use rbs_base_error, only: error_type, fatal_error, bad_input
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_base_tolerances, only: same_input
   use rbs_base_check, only: is_given
   implicit none
   private

   public :: time_plan, same_step, new_plan, check_times, check_length

   !> Share of a step by which those of equal length may differ.
   real(wp), parameter :: same_step = 1.0e-10_wp

   !> More steps than this would take too long.
   real(wp), parameter :: most_steps = 2.0e9_wp

   !> Intervals run from one time at which a row is kept by default to the next.
   type :: time_plan
      !> Longest step [s]
      real(wp) :: dt = 0.0_wp
      !> Method, and why it was chosen if the user left that to the program
      character(len=20) :: method = ''
      character(len=200) :: reason = ''
      !> Whether rk4 locates events
      logical :: located = .false.
      !> Longest step for which RK4 is stable [s]; 0 if it is not needed
      real(wp) :: limit = 0.0_wp
      !> Number of intervals between kept times, and of steps in all
      integer :: intervals = 0, steps = 0
      !> Whether every interval is one step of length dt from the start on (the last may be shorter);
      !> else interval j is the loading's, in `parts(j)` equal steps
      logical :: free = .false.
      !> First and last time [s]
      real(wp) :: begin = 0.0_wp, finish = 0.0_wp
      !> Where steps of length dt are counted from [s], and how many of them lie before the first time
      real(wp) :: origin = 0.0_wp
      integer :: offset = 0
      integer, allocatable :: parts(:)
   contains
      procedure :: rows, go_on_from
   end type time_plan

contains

   !> Times of a loading must be finite, and ascend by more than nothing.
   subroutine check_times(time, error)
      !> Times of the loading (m) [s]
      real(wp), intent(in) :: time(:)
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      if (size(time) < 2) then
         call fatal_error(error, bad_input, 'time: '//to_text(size(time))// &
                          ' point(s); give two or more, from the start to the end of the analysis')
         return
      end if
      do i = 1, size(time)
         if (ieee_is_finite(time(i))) then
            if (abs(time(i)) <= beyond_meaning) cycle
         end if
         call fatal_error(error, bad_input, 'time: value '//to_text(i)//' of '//to_text(size(time))// &
                          ' is '//to_text(time(i))//'; it must be a finite number of seconds')
         return
      end do
      do i = 2, size(time)
         if (time(i) - time(i - 1) >= 1.0_wp/beyond_meaning) cycle
         if (time(i) > time(i - 1)) then
            call fatal_error(error, bad_input, 'time: value '//to_text(i)//' of '//to_text(size(time))// &
                             ' comes only '//to_text(time(i) - time(i - 1))//' s after the one before; '// &
                             'check its exponent')
            return
         end if
         call fatal_error(error, bad_input, 'time: value '//to_text(i)//' of '//to_text(size(time))// &
                          ', '//to_text(time(i))//' s, does not come after the one before, '// &
                          to_text(time(i - 1))//' s; times must ascend strictly')
         return
      end do
   end subroutine check_times

   !> Plan the steps. Without `dt` each interval of the loading is cut into equal steps not longer than
   !> `longest`, and rows are kept at its ends. With `dt` the same holds if dt divides every interval; else
   !> steps of dt run from the start to the end and a row is kept after each.
   subroutine new_plan(plan, time, dt, longest, limit, error)
      type(time_plan), intent(inout) :: plan
      !> Times of the loading, checked (m) [s]; step given by the user, or `unset` [s]
      real(wp), intent(in) :: time(:), dt
      !> Longest step where the user gives none [s]; limit of a step that the user gives, `huge` for none [s]
      real(wp), intent(in) :: longest, limit
      type(error_type), allocatable, intent(out) :: error
      real(wp), allocatable :: parts(:)
      real(wp) :: step, steps
      integer :: m

      m = size(time)
      plan%begin = time(1)
      plan%origin = time(1)
      plan%finish = time(m)
      if (is_given(dt)) then
         call check_step(dt, limit, error)
         if (allocated(error)) return
         step = dt
         parts = (time(2:) - time(:m - 1))/step
         plan%free = any(abs(parts - max(anint(parts), 1.0_wp)) > same_input*parts)
         parts = max(anint(parts), 1.0_wp)
      else
         step = longest
         ! Rounded up, but not by round-off
         parts = max(aint((time(2:) - time(:m - 1))/step*(1.0_wp - same_input)) + 1.0_wp, 1.0_wp)
      end if
      steps = sum(parts)
      if (plan%free) steps = aint((plan%finish - plan%begin)/step*(1.0_wp - same_input)) + 1.0_wp
      call check_length(steps, step, error)
      if (allocated(error)) return
      plan%steps = nint(steps)
      if (plan%free) then
         plan%dt = step
         plan%intervals = plan%steps
      else
         plan%parts = nint(parts)
         plan%dt = maxval((time(2:) - time(:m - 1))/parts)
         ! Of steps that differ by round-off the first has most digits, and a shorter loading has it too.
         step = (time(2) - time(1))/parts(1)
         if (abs(step - plan%dt) <= same_step*plan%dt) plan%dt = step
         plan%intervals = m - 1
      end if
   end subroutine new_plan

   !> Refuse more steps than can be taken in a sensible time.
   subroutine check_length(steps, step, error)
      !> Number of steps, and their length [s]
      real(wp), intent(in) :: steps, step
      type(error_type), allocatable, intent(out) :: error

      if (steps > most_steps) then
         call fatal_error(error, bad_input, 'analysis: '//to_text(steps)//' steps of '//to_text(step)// &
                          ' s are more than '//to_text(most_steps)//'; shorten the duration, or give '// &
                          "a longer dt (method = 'generalised_alpha' has no limit of stability)")
      end if
   end subroutine check_length

   !> Let the steps continue those of another analysis: the length of the step to the last bit, if both differ
   !> by round-off, and where steps are counted from, if the other one ended where this plan begins.
   pure subroutine go_on_from(self, dt, origin, offset)
      class(time_plan), intent(inout) :: self
      !> Step of the other analysis [s], time from which it counted its steps [s], and how many it has taken
      real(wp), intent(in) :: dt, origin
      integer, intent(in) :: offset

      if (abs(self%dt - dt) > same_step*dt) return
      self%dt = dt
      if (.not. self%free .or. abs(origin + offset*dt - self%begin) > 0.0_wp) return
      self%origin = origin
      self%offset = offset
   end subroutine go_on_from

   !> Number of rows of a run, the first at its start.
   elemental integer function rows(self, every)
      class(time_plan), intent(in) :: self
      !> Every n-th step is kept, and the last; `unset_integer`: every interval
      integer, intent(in) :: every

      if (.not. is_given(every)) then
         rows = 1 + self%intervals
      else
         rows = 1 + self%steps/every + merge(0, 1, mod(self%steps, every) == 0)
      end if
   end function rows

   !> Refuse a step of the user that is not a positive number, or is beyond the limit of stability.
   subroutine check_step(dt, limit, error)
      !> Step, and longest one that is stable; `huge` where there is no limit [s]
      real(wp), intent(in) :: dt, limit
      type(error_type), allocatable, intent(out) :: error

      if (.not. ieee_is_finite(dt)) then
         call fatal_error(error, bad_input, 'analysis: dt = '//to_text(dt)//' must be a finite number')
      else if (dt > 0.0_wp .and. dt < 1.0_wp/beyond_meaning) then
         call fatal_error(error, bad_input, 'analysis: dt = '//to_text(dt)//' s is too short for any '// &
                          'number of steps; check its exponent')
      else if (.not. dt > 0.0_wp) then
         call fatal_error(error, bad_input, 'analysis: dt = '//to_text(dt)//' s must be above zero')
      else if (dt > limit) then
         call fatal_error(error, bad_input, 'analysis: dt = '//to_text(dt)//' s is beyond the '// &
                          'stability limit of rk4, '//to_text(limit)//' s; give a dt below it, '// &
                          "none to have it chosen, or method = 'auto'")
      end if
   end subroutine check_step

end module rbs_solve_time_plan
