!> Values of a loading must be finite and within the range of the arithmetic.
module rbs_solve_check_values
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use rbs_base_constants, only: beyond_meaning
   use rbs_base_error, only: error_type, fatal_error, bad_input
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   implicit none
   private

   public :: check_values

contains

   !> Refuse values that are not finite, or whose products would not be finite.
   subroutine check_values(values, name, error)
      real(wp), intent(in) :: values(:)
      character(len=*), intent(in) :: name
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      do i = 1, size(values)
         if (.not. ieee_is_finite(values(i))) then
            call fatal_error(error, bad_input, name//': value '//to_text(i)//' of '//to_text(size(values))// &
                             ' is '//to_text(values(i))//'; it must be a finite number')
            return
         else if (abs(values(i)) > beyond_meaning) then
            call fatal_error(error, bad_input, name//': value '//to_text(i)//' of '// &
                             to_text(size(values))//' is '//to_text(values(i))// &
                             '; products of it would not be finite: check its exponent and unit')
            return
         end if
      end do
   end subroutine check_values

end module rbs_solve_check_values
