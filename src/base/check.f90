!> Checks on single input values: each adds one message that names the quantity, its value and the
!> values that are allowed.
module rbs_base_check
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use, intrinsic :: iso_fortran_env, only: int64
   use rbs_base_constants, only: unset, unset_integer, beyond_meaning
   use rbs_base_error, only: message_list, error_type, fatal_error, bad_input
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text, suggestion, list_of
   implicit none
   private

   public :: is_given, check_finite, check_name, check_order, check_values

   !> Whether the user has given a number. Lists and texts that are not given are not allocated.
   interface is_given
      module procedure :: real_is_given, integer_is_given
   end interface is_given

contains

   !> Whether a real number is not `unset`.
   elemental logical function real_is_given(x)
      real(wp), intent(in) :: x

      ! By its bits: a NaN is given, and comparing it would trap.
      real_is_given = transfer(x, 0_int64) /= transfer(unset, 0_int64)
   end function real_is_given

   !> Whether a whole number is not `unset_integer`.
   elemental logical function integer_is_given(i)
      integer, intent(in) :: i

      integer_is_given = i /= unset_integer
   end function integer_is_given

   !> Add a message unless a number is given, finite, and of a size that the arithmetic can bear.
   subroutine check_finite(x, name, unit, messages, ok)
      real(wp), intent(in) :: x
      !> Owner and key, for the message: 'column: height'; unit, or blank
      character(len=*), intent(in) :: name, unit
      type(message_list), intent(inout) :: messages
      logical, intent(out), optional :: ok
      logical :: passed

      passed = .false.
      if (.not. is_given(x)) then
         if (unit == '') then
            call messages%add(name//' is missing; give it a value')
         else
            call messages%add(name//' is missing; give it a value in '//unit)
         end if
      else if (.not. ieee_is_finite(x)) then
         call messages%add(name//' = '//to_text(x)//' must be a finite number')
      else if (abs(x) > beyond_meaning .or. (abs(x) > 0.0_wp .and. abs(x) < 1.0_wp/beyond_meaning)) then
         call messages%add(name//' = '//to_text(x)//' is outside the range in which products of it '// &
                           'are finite and not zero; check its exponent and unit')
      else
         passed = .true.
      end if
      if (present(ok)) ok = passed
   end subroutine check_finite

   !> Add a message unless a word is one of the valid ones.
   subroutine check_name(word, valid, name, messages, number)
      !> The word, the valid ones, and owner and key for the message
      character(len=*), intent(in) :: word, valid(:), name
      type(message_list), intent(inout) :: messages
      !> Place of the word among the valid ones, 0 if it is none of them
      integer, intent(out) :: number

      do number = 1, size(valid)
         if (word == valid(number)) return
      end do
      number = 0
      if (word == '') then
         call messages%add(name//' is missing; it is one of '//list_of(valid))
      else
         call messages%add(name//" = '"//trim(word)//"' is not known; it is one of "// &
                           list_of(valid)//suggestion(word, valid))
      end if
   end subroutine check_name

   !> Add a message unless two numbers are in order: 'OWNER: k_y = 3 must be below k_c = 2 (REASON)'.
   subroutine check_order(owner, name, x, relation, limit_name, limit, reason, messages)
      !> Owner of the numbers, and key of x, for the message
      character(len=*), intent(in) :: owner, name
      real(wp), intent(in) :: x, limit
      !> 'must be below', 'must not be below', 'must be above' or 'must not be above'
      character(len=*), intent(in) :: relation, limit_name
      !> Reason and remedy, with the sign before them: ' (REASON)' or '; REMEDY'
      character(len=*), intent(in) :: reason
      type(message_list), intent(inout) :: messages
      logical :: below

      ! Whether the number is below or, where the relation says so, above the limit.
      below = x < limit
      if (index(relation, 'above') > 0) below = x > limit
      if (below .eqv. index(relation, 'not') == 0) return
      call messages%add(owner//': '//name//' = '//to_text(x)//' '//relation//' '//limit_name//' = '// &
                        to_text(limit)//reason)
   end subroutine check_order

   !> Refuse values that are not finite, or whose products would not be finite.
   subroutine check_values(values, name, error)
      real(wp), intent(in) :: values(:)
      !> Owner of the values, for the message
      character(len=*), intent(in) :: name
      type(error_type), allocatable, intent(out) :: error
      character(len=64) :: reason
      integer :: i

      do i = 1, size(values)
         reason = 'it must be a finite number'
         if (ieee_is_finite(values(i))) then
            if (abs(values(i)) <= beyond_meaning) cycle
            reason = 'products of it would not be finite: check its exponent and unit'
         end if
         call fatal_error(error, bad_input, name//': value '//to_text(i)//' of '//to_text(size(values))// &
                          ' is '//to_text(values(i))//'; '//trim(reason))
         return
      end do
   end subroutine check_values

end module rbs_base_check
