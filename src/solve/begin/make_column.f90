!> The column that the user has described.
module rbs_solve_begin_make_column
   use rbs_base_error, only: error_type, message_list, fatal_error, bad_input
   use rbs_base_text, only: to_text
   use rbs_structure_column_column, only: column_type
   use rbs_structure_spring_location, only: flexure
   use rbs_hysteresis_layered_layered_joint, only: check_axial_load
   use rbs_structure_column_column_record, only: column_record
   use rbs_structure_column_new_column, only: new_column
   implicit none
   private

   public :: make_column

contains

   !> Validate a column and make it.
   subroutine make_column(spec, column, error)
      type(column_record), intent(inout) :: spec
      class(column_type), allocatable, intent(out) :: column
      type(error_type), allocatable, intent(out) :: error
      type(message_list) :: messages
      character(len=:), allocatable :: text
      integer :: i

      call spec%validate(messages)
      call messages%raise(error)
      if (allocated(error)) return
      call new_column(column, spec)
      do i = 1, column%n
         associate (at => column%at(flexure, i))
            if (column%rules%name(column%rules%of(at)) /= 'layered') cycle
            call check_axial_load(column%rules%list(column%rules%of(at))%rule, column%constant_axial(at), &
                                  text)
         end associate
         if (text == '') cycle
         call fatal_error(error, bad_input, 'flexure spring of joint '//to_text(spec%joint_number(i))// &
                          ': '//text)
         return
      end do
   end subroutine make_column

end module rbs_solve_begin_make_column
