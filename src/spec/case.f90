!> A whole case: what a namelist file holds.
module rbs_spec_case
   use rbs_base_error, only: message_list
   use rbs_spec_analysis, only: analysis_spec, output_spec
   use rbs_spec_column, only: column_spec
   use rbs_spec_loading, only: loading_spec
   implicit none
   private

   public :: case_spec, most_loadings

   !> A force, a ground motion in two directions and an axial load may act together.
   integer, parameter :: most_loadings = 4

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
      call check_together(self, messages)
      call self%analysis%validate(messages)
      call check_static(self, messages)
      call self%output%validate(messages)
   end subroutine validate

   !> What a static path cannot take, found before it is begun (in the words of the solver).
   subroutine check_static(self, messages)
      type(case_spec), intent(in) :: self
      type(message_list), intent(inout) :: messages

      if (self%analysis%dynamic() .or. self%column%kinematics /= 'finite') return
      if (.not. (self%column%axial_follows .or. self%column%force_follows)) return
      call messages%add('column: loads that follow the top (axial_follows, force_follows) have no '// &
                        'potential, and a static path could miss the loss of stability; use a '// &
                        'dynamic analysis')
   end subroutine check_static

   !> Loadings that cannot act together.
   subroutine check_together(self, messages)
      type(case_spec), intent(in) :: self
      type(message_list), intent(inout) :: messages
      integer :: i

      if (self%loadings < 2) return
      if (.not. self%analysis%dynamic()) then
         call messages%add('loading: several loadings need a dynamic analysis; with method = '// &
                           "'static' give one")
         return
      end if
      do i = 2, self%loadings
         if (all(self%loading(:i - 1)%drive /= self%loading(i)%drive)) cycle
         call messages%add("loading: two loadings with drive = '"//trim(self%loading(i)%drive)// &
                           "'; give each drive once")
      end do
   end subroutine check_together

end module rbs_spec_case
