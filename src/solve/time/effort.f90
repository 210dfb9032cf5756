!> Expected duration of a run in time, noted before it starts, and the faster method.
module rbs_solve_time_effort
   use rbs_base_constants, only: pi
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_case_methods, only: method_type, method_named
   use rbs_solve_modal_modes, only: frequency_bounds
   use rbs_solve_time_plan, only: time_plan
   use rbs_structure_structure, only: structure_type, finite
   implicit none
   private

   public :: patience, expected_seconds, long_run_note

   !> Runs that are expected to be shorter start without a word [s].
   real(wp), parameter :: patience = 5.0_wp

   !> Work for a spring, over that for a column of one body.
   real(wp), parameter :: share_of_spring = 0.3_wp

   !> Exact rotations make a step this much longer.
   real(wp), parameter :: cost_of_finite = 6.0_wp

   !> Another method is named if it is this many times faster.
   real(wp), parameter :: much_faster = 3.0_wp

   !> The method that is named.
   character(len=*), parameter :: faster = 'generalised_alpha'

contains

   !> Time that a run will take by the method of its plan, within a factor of about three; it depends on the
   !> machine [s].
   pure real(wp) function expected_seconds(structure, plan) result(seconds)
      class(structure_type), intent(in) :: structure
      type(time_plan), intent(in) :: plan
      type(method_type) :: method

      method = method_named(plan%method)
      seconds = steps_of(plan, method)*(1.0_wp + share_of_spring*size(structure%location))*method%body_step
      if (structure%kinematics == finite) seconds = cost_of_finite*seconds
   end function expected_seconds

   !> Number of steps that a method takes by a plan; those that an adaptive method takes at least.
   pure real(wp) function steps_of(plan, method) result(steps)
      type(time_plan), intent(in) :: plan
      type(method_type), intent(in) :: method

      steps = real(plan%steps, wp)
      if (method%adaptive) steps = max(steps, (plan%finish - plan%begin)/(method%limit_share*plan%limit))
   end function steps_of

   !> A sentence for the user before a long run: its expected time, and a faster method if there is one; empty
   !> for a short run.
   subroutine long_run_note(structure, plan, text)
      class(structure_type), intent(in) :: structure
      type(time_plan), intent(in) :: plan
      character(len=:), allocatable, intent(out) :: text
      type(method_type) :: method, other
      type(error_type), allocatable :: error
      type(time_plan) :: short
      real(wp) :: seconds, lowest

      text = ''
      seconds = expected_seconds(structure, plan)
      if (seconds < patience) return
      method = method_named(plan%method)
      text = 'analysis: about '//to_text(anint(steps_of(plan, method)))//" steps with method = '"// &
             trim(plan%method)//"' will take some "//to_text(one_digit(seconds))//' s'
      if (.not. method%explicit) return
      text = text//'; the highest frequency limits the stable step to '//to_text(plan%limit)//' s'
      other = method_named(faster)
      call frequency_bounds(structure, lowest, error)
      if (allocated(error)) return
      ! The same run by the other method: its steps are a share of the longest period.
      short = plan
      short%method = faster
      short%steps = int(min(real(plan%intervals, wp) + (plan%finish - plan%begin)/ &
                            other%period_share*lowest/(2.0_wp*pi), 2.0e9_wp))
      if (much_faster*expected_seconds(structure, short) > seconds) return
      text = text//". Faster: method = '"//faster//"', some "// &
             to_text(one_digit(expected_seconds(structure, short)))//' s, with errors of about '// &
             to_text(other%usual_error)//' in place of '//to_text(method%usual_error)
   end subroutine long_run_note

   !> Round to one digit, as no more is known.
   elemental real(wp) function one_digit(seconds)
      real(wp), intent(in) :: seconds
      real(wp) :: unit

      unit = 10.0_wp**floor(log10(max(seconds, 1.0e-3_wp)))
      one_digit = anint(seconds/unit)*unit
   end function one_digit

end module rbs_solve_time_effort
