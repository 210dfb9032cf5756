!> What the user asked of the analysis and of its output.
module rbs_spec_analysis
   use rbs_base_kinds, only: wp
   use rbs_base_constants, only: unset, unset_integer
   use rbs_base_error, only: message_list
   use rbs_base_text, only: to_text
   use rbs_spec_check, only: is_given, check_positive, check_name
   implicit none
   private

   public :: analysis_spec, output_spec, method_names

   character(len=6), parameter :: method_names(2) = ['static', 'rk4   ']

   !> How the case is solved.
   type :: analysis_spec
      !> One of `method_names`
      character(len=16) :: method = 'static'
      !> Time step [s]; `unset`: chosen from the stability limit
      real(wp) :: dt = unset
      !> End of the analysis [s]; `unset`: the end of the loading
      real(wp) :: duration = unset
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
      if (.not. self%dynamic() .and. is_given(self%dt)) then
         call messages%add("analysis: dt has no meaning for method = 'static'; remove it or set "// &
                           "method = 'rk4'")
      end if
      if (.not. self%dynamic() .and. is_given(self%duration)) then
         call messages%add("analysis: duration has no meaning for method = 'static'; remove it or "// &
                           "set method = 'rk4'")
      end if
   end subroutine validate_analysis

   subroutine validate_output(self, messages)
      class(output_spec), intent(in) :: self
      type(message_list), intent(inout) :: messages

      if (self%every < 1 .and. self%every /= unset_integer) then
         call messages%add('output: every = '//to_text(self%every)//' must be 1 or more')
      end if
   end subroutine validate_output

end module rbs_spec_analysis
