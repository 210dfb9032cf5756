!> What the user asked of the analysis and of its output.
module rbs_spec_analysis
   use rbs_base_kinds, only: wp
   use rbs_base_constants, only: unset, unset_integer
   use rbs_base_error, only: message_list
   use rbs_base_text, only: to_text
   use rbs_base_check, only: is_given, check_positive, check_finite, check_name
   implicit none
   private

   public :: analysis_spec, output_spec, method_names, event_names

   character(len=17), parameter :: method_names(7) = [ &
      'static           ', 'auto             ', 'rk4              ', 'rk45             ', &
      'newmark          ', 'hht              ', 'generalised_alpha']

   character(len=7), parameter :: event_names(2) = ['step   ', 'located']

   !> Tolerances of `rk45` that can be met in the arithmetic.
   real(wp), parameter :: least_tolerance = 1.0e-13_wp, most_tolerance = 0.1_wp

   !> How the case is solved.
   type :: analysis_spec
      !> One of `method_names`
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

      dynamic = self%method /= 'static'
   end function dynamic

   subroutine validate_analysis(self, messages)
      class(analysis_spec), intent(in) :: self
      type(message_list), intent(inout) :: messages
      integer :: place

      call check_name(self%method, method_names, 'analysis: method', messages, place)
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
      if (self%method == 'hht') then
         call check_range(self%rho_infinity, "analysis: rho_infinity of method = 'hht'", 0.5_wp, 1.0_wp, &
                          messages)
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

   !> A setting that the method does not use is a misunderstanding.
   subroutine refuse_unused(self, messages)
      class(analysis_spec), intent(in) :: self
      type(message_list), intent(inout) :: messages
      character(len=*), parameter :: remedy = "; remove it or set method = '"

      if (.not. self%dynamic() .and. is_given(self%dt)) then
         call messages%add("analysis: dt has no meaning for method = 'static'"//remedy//"rk4'")
      end if
      if (.not. self%dynamic() .and. is_given(self%duration)) then
         call messages%add("analysis: duration has no meaning for method = 'static'"//remedy//"rk4'")
      end if
      if (self%events /= '' .and. self%method /= 'rk4') then
         call messages%add("analysis: events has no meaning for method = '"//trim(self%method)//"'"// &
                           remedy//"rk4'")
      end if
      if (is_given(self%tolerance) .and. self%method /= 'rk45' .and. self%method /= 'auto') then
         call messages%add("analysis: tolerance has no meaning for method = '"//trim(self%method)//"'"// &
                           remedy//"rk45'")
      end if
      if (is_given(self%rho_infinity) .and. self%method /= 'hht' .and. &
          self%method /= 'generalised_alpha') then
         call messages%add("analysis: rho_infinity has no meaning for method = '"//trim(self%method)//"'"// &
                           remedy//"generalised_alpha'")
      end if
      if (self%allow_unstable .and. self%method /= 'rk4') then
         call messages%add("analysis: allow_unstable has no meaning for method = '"//trim(self%method)// &
                           "'"//remedy//"rk4'")
      end if
   end subroutine refuse_unused

   subroutine validate_output(self, messages)
      class(output_spec), intent(in) :: self
      type(message_list), intent(inout) :: messages

      if (self%every < 1 .and. self%every /= unset_integer) then
         call messages%add('output: every = '//to_text(self%every)//' must be 1 or more')
      end if
   end subroutine validate_output

end module rbs_spec_analysis
