!> A whole case: what a namelist file holds.
module rbs_spec_case
   use rbs_base_error, only: message_list
   use rbs_spec_analysis, only: analysis_spec, output_spec
   use rbs_spec_column, only: column_spec
   use rbs_spec_loading, only: loading_spec
   implicit none
   private

   public :: case_spec, most_loadings

   !> A force and a ground motion may act together.
   integer, parameter :: most_loadings = 2

   !> Everything that a run needs to know.
   type :: case_spec
      !> One line for the header of the output
      character(len=:), allocatable :: title
      type(column_spec) :: column
      !> Number of loadings
      integer :: loadings = 0
      type(loading_spec) :: loading(most_loadings)
      type(analysis_spec) :: analysis
      type(output_spec) :: output
   contains
      procedure :: validate
   end type case_spec

contains

   !> Add a message for everything that is wrong with the case.
   subroutine validate(self, messages)
      class(case_spec), intent(in) :: self
      type(message_list), intent(inout) :: messages
      integer :: i

      call self%column%validate(messages)
      do i = 1, self%loadings
         call self%loading(i)%validate(self%analysis%dynamic(), messages)
      end do
      if (self%loadings == 2) then
         if (.not. self%analysis%dynamic()) then
            call messages%add('loading: two loadings need a dynamic analysis; with method = '// &
                              "'static' give one")
         else if (self%loading(1)%drive == self%loading(2)%drive) then
            call messages%add("loading: two loadings with drive = '"//trim(self%loading(1)%drive)// &
                              "'; give one force and one ground motion at the most")
         end if
      end if
      call self%analysis%validate(messages)
      if (self%column%kinematics == 'finite' .and. self%analysis%method == 'static') then
         call messages%add("column: kinematics = 'finite' has no static path; set kinematics = "// &
                           "'small' or 'pdelta', or method = 'rk4' in the group analysis")
      end if
      call self%output%validate(messages)
   end subroutine validate

end module rbs_spec_case
