!> What the user asked of the analysis and of its output.
module rbs_spec_analysis
   use rbs_base_kinds, only: wp
   use rbs_base_constants, only: unset, unset_integer
   use rbs_base_error, only: message_list
   use rbs_base_text, only: to_text
   use rbs_base_check, only: is_given, check_positive, check_finite, check_name
   use rbs_case_methods, only: method_type, methods, method_named, quoted_names
   implicit none
   private

   public :: analysis_spec, output_spec, event_names

   character(len=7), parameter :: event_names(2) = ['step   ', 'located']

   !> Tolerances of `rk45` that can be met in the arithmetic.
   real(wp), parameter :: least_tolerance = 1.0e-13_wp, most_tolerance = 0.1_wp

   !> How the case is solved.
   type :: analysis_spec
      !> One of `methods`, see `rbs_case_methods`
      character(len=20) :: method = 'static'
      !> Time step [s]; `unset`: chosen by the method
      real(wp) :: dt = unset
      !> End of the analysis [s]; `unset`: the end of the loading
      real(wp) :: duration = unset
      !> rk4: where a spring changes its line, one of `event_names`; empty: 'step'
      character(len=20) :: events = ''
      !> rk45, auto: wanted relative error of a step in energy norm; `unset`: 1e-6
      real(wp) :: tolerance = unset
      !> hht, generalised_alpha: spectral radius at infinite frequency, 1 without damping; `unset`: 0.8
      real(wp) :: rho_infinity = unset
      !> Displacement of the top over the height at which the column counts as collapsed and the analysis
      !> ends; `unset`: none
      real(wp) :: collapse_drift = unset
      !> rk4: whether a step beyond the stability limit is taken all the same
      logical :: allow_unstable = .false.
   contains
      procedure :: dynamic
      procedure :: validate => validate_analysis
   end type analysis_spec

   !> What is written.
   type :: output_spec
      !> Path of the csv; not allocated: the case file's name with .csv
      character(len=:), allocatable :: file
      !> Every n-th point (static) or step (dynamic) is kept, and the last; `unset_integer`: every point
      !> of the loading
      integer :: every = unset_integer
   contains
      procedure :: validate => validate_output
   end type output_spec

contains

   !> Whether the analysis runs in time.
   pure logical function dynamic(self)
      class(analysis_spec), intent(in) :: self

      type(method_type) :: method

      method = method_named(self%method)
      dynamic = method%in_time
   end function dynamic

   subroutine validate_analysis(self, messages)
      class(analysis_spec), intent(in) :: self
      type(message_list), intent(inout) :: messages
      type(method_type) :: method
      integer :: place

      method = method_named(self%method)
      call check_name(self%method, methods%name, 'analysis: method', messages, place)
      if (is_given(self%dt)) call check_positive(self%dt, 'analysis: dt', 's', messages)
      if (is_given(self%duration)) then
         call check_positive(self%duration, 'analysis: duration', 's', messages)
      end if
      if (is_given(self%collapse_drift)) then
         call check_positive(self%collapse_drift, 'analysis: collapse_drift', '', messages)
      end if
      if (self%events /= '') call check_name(self%events, event_names, 'analysis: events', messages, place)
      call check_range(self%tolerance, 'analysis: tolerance', least_tolerance, most_tolerance, messages)
      call check_range(self%rho_infinity, 'analysis: rho_infinity', 0.0_wp, 1.0_wp, messages)
      if (method%least_rho_infinity > 0.0_wp) then
         call check_range(self%rho_infinity, "analysis: rho_infinity of method = '"//trim(method%name)//"'", &
                          method%least_rho_infinity, 1.0_wp, messages)
      end if
      call refuse_unused(self, messages)
   end subroutine validate_analysis

   !> A number that may be missing, else lies between two bounds.
   subroutine check_range(x, name, least, most, messages)
      real(wp), intent(in) :: x, least, most
      character(len=*), intent(in) :: name
      type(message_list), intent(inout) :: messages
      logical :: ok

      if (.not. is_given(x)) return
      call check_finite(x, name, '', messages, ok)
      if (.not. ok) return
      if (x < least .or. x > most) then
         call messages%add(name//' = '//to_text(x)//' must be from '//to_text(least)//' to '//to_text(most))
      end if
   end subroutine check_range

   !> Refuse settings that the method does not take: the user expects something of them.
   subroutine refuse_unused(self, messages)
      class(analysis_spec), intent(in) :: self
      type(message_list), intent(inout) :: messages
      type(method_type) :: method

      method = method_named(self%method)
      ! A name that is not known has been reported already.
      if (method%name == '') return
      call refuse(is_given(self%dt) .and. .not. method%dt, 'dt', methods%dt)
      call refuse(is_given(self%duration) .and. .not. method%in_time, 'duration', methods%in_time)
      call refuse(self%events /= '' .and. .not. method%events, 'events', methods%events)
      call refuse(is_given(self%tolerance) .and. .not. method%tolerance, 'tolerance', methods%tolerance)
      call refuse(is_given(self%rho_infinity) .and. .not. method%rho_infinity, 'rho_infinity', &
                  methods%rho_infinity)
      call refuse(self%allow_unstable .and. .not. method%allow_unstable, 'allow_unstable', &
                  methods%allow_unstable)

   contains

      subroutine refuse(unused, key, takes)
         logical, intent(in) :: unused
         character(len=*), intent(in) :: key
         !> Which of the methods take the setting
         logical, intent(in) :: takes(:)
         character(len=:), allocatable :: names

         if (.not. unused) return
         call quoted_names(takes, names)
         call messages%add('analysis: '//key//" has no meaning for method = '"//trim(method%name)// &
                           "'; remove it or set method = "//names)
      end subroutine refuse

   end subroutine refuse_unused

   subroutine validate_output(self, messages)
      class(output_spec), intent(in) :: self
      type(message_list), intent(inout) :: messages

      if (self%every < 1 .and. self%every /= unset_integer) then
         call messages%add('output: every = '//to_text(self%every)//' must be 1 or more')
      end if
   end subroutine validate_output

end module rbs_spec_analysis
