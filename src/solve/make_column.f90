!> The column that the user has described.
module rbs_solve_make_column
   use rbs_base_error, only: error_type, message_list, fatal_error, bad_input
   use rbs_base_text, only: to_text
   use rbs_column_column, only: column_type, new_column
   use rbs_hysteresis_spring_record, only: carries_axial_load, told_capacity
   use rbs_column_column_record, only: column_record
   implicit none
   private

   public :: make_column

contains

   !> Validate a column and make it.
   subroutine make_column(spec, column, error)
      type(column_record), intent(inout) :: spec
      type(column_type), intent(out) :: column
      type(error_type), allocatable, intent(out) :: error
      type(message_list) :: messages
      integer :: i

      call spec%validate(messages)
      call messages%raise(error)
      if (allocated(error)) return
      call new_column(column, spec)
      do i = 1, column%n
         associate (spring => column%spring(column%n + i))
            if (carries_axial_load(spring)) cycle
            call fatal_error(error, bad_input, 'flexure spring of joint '// &
                             to_text(spec%joint_number(i))//': '//trim(told_capacity(spring)))
         end associate
         return
      end do
   end subroutine make_column

end module rbs_solve_make_column
