!> Facts of the methods of analysis, in one table. The choice of `auto`, the plan of the steps, validation,
!> messages, the Python package and the docs read them here.
module rbs_case_methods
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   implicit none
   private

   public :: method_type, methods, method_named, method_choices, takes, quoted_names, method_rows
   public :: usual_tolerance, usual_rho_infinity, methods_columns

   !> Usual settings: error of a step of rk45, spectral radius at infinite frequency.
   real(wp), parameter :: usual_tolerance = 1.0e-6_wp, usual_rho_infinity = 0.8_wp

   !> Responses of studies/error_classes.py, with P-Delta, from which the errors of the methods come.
   integer, parameter :: responses_tried = 44

   !> The facts of one method.
   type :: method_type
      character(len=17) :: name = ''
      !> Order of accuracy; 0: none of its own
      integer :: order = 0
      !> Whether it is an analysis in time
      logical :: in_time = .true.
      !> It is explicit if a step follows from the state at its start, implicit if from an equation with the
      !> state at its end. `auto` is neither: it stands for one of the others.
      logical :: explicit = .false., implicit = .false.
      !> Whether it chooses the length of its steps by a tolerance
      logical :: adaptive = .false.
      !> Settings of the analysis that it uses
      logical :: dt = .true., events = .false., tolerance = .false., rho_infinity = .false.
      logical :: allow_unstable = .false.
      !> Default of its step as a share of the stability limit of rk4, or of the longest natural period; for
      !> rk45 the longest step. 0: the step does not depend on the limit, or on the period
      real(wp) :: limit_share = 0.0_wp, period_share = 0.0_wp
      !> Least spectral radius at infinite frequency
      real(wp) :: least_rho_infinity = 0.0_wp
      !> Errors at its own step or tolerance, relative to the peaks: the median and the largest of the
      !> responses of studies/error_classes.py, or of the leaps of studies/random_frames.py. 0: round-off, or
      !> those of the method that is chosen
      real(wp) :: usual_error = 0.0_wp, largest_error = 0.0_wp
      !> How many responses these were
      integer :: responses = responses_tried
      !> Time of a step for each body and one more, by the same study [s]
      real(wp) :: body_step = 0.0_wp
   end type method_type

   !> The pair 5(4) of rk45 is stable for undamped motion up to h omega = 0.9968, rk4 up to 2 sqrt(2): 0.3524
   !> of the limit of rk4. With longer steps the stiffest mode would grow until its error exceeds the
   !> tolerance, and the springs would follow this false motion.
   type(method_type), parameter :: methods(8) = [ &
      method_type('static', in_time=.false., dt=.false.), &
      method_type('newton', in_time=.false., dt=.false., usual_error=1.0e-5_wp, largest_error=6.0e-4_wp, &
                  responses=1110), &
      method_type('auto', tolerance=.true.), &
      method_type('rk4', order=4, explicit=.true., events=.true., allow_unstable=.true., &
                  limit_share=0.2_wp, usual_error=1.0e-4_wp, largest_error=3.0e-3_wp, &
                  body_step=1.0e-7_wp), &
      method_type('rk45', order=5, explicit=.true., adaptive=.true., tolerance=.true., &
                  limit_share=0.35_wp, usual_error=2.0e-5_wp, largest_error=4.0e-4_wp, &
                  body_step=4.0e-7_wp), &
      method_type('newmark', order=2, implicit=.true., period_share=0.02_wp, &
                  usual_error=6.0e-3_wp, largest_error=0.3_wp, body_step=5.0e-7_wp), &
      method_type('hht', order=2, implicit=.true., rho_infinity=.true., &
                  period_share=0.02_wp, least_rho_infinity=0.5_wp, usual_error=5.0e-3_wp, &
                  largest_error=0.3_wp, body_step=5.0e-7_wp), &
      method_type('generalised_alpha', order=2, implicit=.true., rho_infinity=.true., &
                  period_share=0.02_wp, usual_error=6.0e-3_wp, largest_error=0.3_wp, body_step=5.0e-7_wp)]

   !> Names of the columns of `method_rows`.
   character(len=*), parameter :: methods_columns = 'method order kind adaptive dt events tolerance '// &
                                  'rho_infinity allow_unstable limit_share period_share '// &
                                  'usual_error largest_error responses'

contains

   !> The facts of one method; for an unknown name those of a method without a name.
   pure type(method_type) function method_named(name) result(method)
      character(len=*), intent(in) :: name
      integer :: i

      do i = 1, size(methods)
         if (methods(i)%name == name) method = methods(i)
      end do
   end function method_named

   !> The names of all methods, separated by blanks.
   pure character(len=120) function method_choices() result(names)
      integer :: i

      names = methods(1)%name
      do i = 2, size(methods)
         names = trim(names)//' '//methods(i)%name
      end do
   end function method_choices

   !> Whether a method uses a setting of the analysis.
   elemental logical function takes(method, key)
      type(method_type), intent(in) :: method
      !> 'dt', 'duration', 'events', 'tolerance', 'rho_infinity' or 'allow_unstable'
      character(len=*), intent(in) :: key

      select case (key)
      case ('dt')
         takes = method%dt
      case ('duration')
         takes = method%in_time
      case ('events')
         takes = method%events
      case ('tolerance')
         takes = method%tolerance
      case ('rho_infinity')
         takes = method%rho_infinity
      case default
         takes = method%allow_unstable
      end select
   end function takes

   !> Some of the methods by their quoted names: "'rk4' or 'rk45'".
   subroutine quoted_names(wanted, text)
      !> For each of `methods`, whether it is named
      logical, intent(in) :: wanted(:)
      character(len=:), allocatable, intent(out) :: text
      integer :: i, left

      text = ''
      left = count(wanted)
      do i = 1, size(methods)
         if (.not. wanted(i)) cycle
         ! How many names follow this one.
         left = left - 1
         text = text//"'"//trim(methods(i)%name)//"'"
         if (left == 1) text = text//' or '
         if (left > 1) text = text//', '
      end do
   end subroutine quoted_names

   !> The table as text: a line of `methods_columns`, then a line for each method, with blanks between.
   subroutine method_rows(text)
      character(len=:), allocatable, intent(out) :: text
      type(method_type) :: method
      character(len=8) :: kind
      character(len=4) :: facts(6)
      integer :: i, k

      text = methods_columns
      do i = 1, size(methods)
         method = methods(i)
         kind = 'choice'
         if (method%explicit) kind = 'explicit'
         if (method%implicit) kind = 'implicit'
         if (.not. method%in_time) kind = 'static'
         facts = merge(' yes', ' no ', [method%adaptive, method%dt, method%events, method%tolerance, &
                                        method%rho_infinity, method%allow_unstable])
         text = text//new_line('a')//trim(method%name)//' '//to_text(method%order)//' '//kind
         do k = 1, size(facts)
            text = trim(text)//facts(k)
         end do
         text = trim(text)//' '//to_text(method%limit_share)//' '//to_text(method%period_share)//' '// &
                to_text(method%usual_error)//' '//to_text(method%largest_error)//' '// &
                to_text(merge(method%responses, 0, method%largest_error > 0.0_wp))
      end do
   end subroutine method_rows

end module rbs_case_methods
