!> Numbers as text, comparison of names, lists of messages.
module test_text
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan, ieee_positive_inf, &
                                            ieee_negative_inf
   use check, only: unit_test, check_equal, check_failed, check_same, check_true
   use rbs_base_error, only: error_type, message_list, fatal_error, analysis_failed, bad_input
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: exact_text, to_text, lower, nearest_name, list_of
   use rbs_io_text_file, only: read_real, number_ok
   use samples, only: random_type
   implicit none
   private

   public :: collect_text

   character(len=8), parameter :: names(3) = ['elastic ', 'bilinear', 'takeda  ']

contains

   subroutine collect_text(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('reals have six digits and no trailing zeros', reals), &
               unit_test('reals change to powers of ten outside 1e-4 to 1e6', powers), &
               unit_test('reals are rounded before the form is chosen', rounding), &
               unit_test('NaN, infinity and words that are not numbers', not_numbers), &
               unit_test('integers', integers), &
               unit_test('exact text reads back to the same bits', exact), &
               unit_test('short decimals are read as the library reads them', short_decimals), &
               unit_test('lower case', lower_case), &
               unit_test('list of names', lists), &
               unit_test('nearest name by edit distance', nearest), &
               unit_test('an error carries code and message', one_error), &
               unit_test('messages are raised together, in order', collected), &
               unit_test('messages beyond the limit are counted', flood)]
   end subroutine collect_text

   subroutine reals(error)
      type(error_type), allocatable, intent(inout) :: error

      call check_equal(error, to_text(0.0_wp), '0', 'zero')
      call check_equal(error, to_text(1.0_wp), '1', 'one')
      call check_equal(error, to_text(-0.5_wp), '-0.5', 'minus a half')
      call check_equal(error, to_text(0.0016_wp), '0.0016', '0.0016')
      call check_equal(error, to_text(123456.0_wp), '123456', '123456')
      call check_equal(error, to_text(-120000.0_wp), '-120000', '-120000')
      call check_equal(error, to_text(1.0_wp/3.0_wp), '0.333333', 'a third')
      call check_equal(error, to_text(2.0e2_wp/3.0_wp), '66.6667', '200/3')
   end subroutine reals

   subroutine powers(error)
      type(error_type), allocatable, intent(inout) :: error

      call check_equal(error, to_text(1.0e-4_wp), '0.0001', '1e-4')
      call check_equal(error, to_text(1.0e-5_wp), '1e-05', '1e-5')
      call check_equal(error, to_text(1.0e6_wp), '1e+06', '1e6')
      call check_equal(error, to_text(7.0387e8_wp), '7.0387e+08', '7.0387e8')
      call check_equal(error, to_text(-2.5e-123_wp), '-2.5e-123', '-2.5e-123')
      call check_equal(error, to_text(huge(1.0_wp)), '1.79769e+308', 'the largest')
      call check_equal(error, to_text(tiny(1.0_wp)), '2.22507e-308', 'the smallest')
   end subroutine powers

   subroutine rounding(error)
      type(error_type), allocatable, intent(inout) :: error

      call check_equal(error, to_text(999999.6_wp), '1e+06', '999999.6')
      call check_equal(error, to_text(999999.4_wp), '999999', '999999.4')
      call check_equal(error, to_text(0.99999999_wp), '1', '0.99999999')
      call check_equal(error, to_text(9.9999999e-5_wp), '0.0001', '9.9999999e-5')
   end subroutine rounding

   subroutine not_numbers(error)
      type(error_type), allocatable, intent(inout) :: error

      call check_equal(error, to_text(ieee_value(1.0_wp, ieee_quiet_nan)), 'NaN', 'NaN')
      call check_equal(error, to_text(ieee_value(1.0_wp, ieee_positive_inf)), 'Infinity', '+Inf')
      call check_equal(error, to_text(ieee_value(1.0_wp, ieee_negative_inf)), '-Infinity', '-Inf')
   end subroutine not_numbers

   subroutine integers(error)
      type(error_type), allocatable, intent(inout) :: error

      call check_equal(error, to_text(0), '0', 'zero')
      call check_equal(error, to_text(-42), '-42', '-42')
      call check_equal(error, to_text(huge(1)), '2147483647', 'the largest')
   end subroutine integers

   !> By the library and by `read_real`.
   subroutine exact(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      character(len=32) :: text
      real(wp) :: x, again, ours
      integer :: i, status

      call check_equal(error, trim(exact_text(1.6_wp)), '1.6', '1.6')
      call check_equal(error, trim(exact_text(-744.0e3_wp)), '-744000', '-744e3')
      call check_equal(error, trim(exact_text(1.296e-4_wp)), '0.0001296', '1.296e-4')
      call check_equal(error, trim(exact_text(2.0e11_wp)), '2e11', '2e11')
      do i = 1, 20000
         x = random%uniform(-1.0_wp, 1.0_wp)*10.0_wp**nint(random%uniform(-40.0_wp, 40.0_wp))
         text = exact_text(x)
         read (text, *) again
         call read_real(trim(text), ours, status)
         call check_same(error, again, x, text)
         call check_same(error, ours, x, text)
      end do
   end subroutine exact

   subroutine short_decimals(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      character(len=32) :: text, form
      real(wp) :: library, ours
      integer :: i, status

      do i = 1, 50000
         write (form, '(a, i0, a)') '(es32.', int(random%uniform(0.0_wp, 17.0_wp)), 'e3)'
         write (text, form) random%uniform(-1.0_wp, 1.0_wp)*10.0_wp**nint(random%uniform(-25.0_wp, 25.0_wp))
         text = adjustl(text)
         read (text, *) library
         call read_real(trim(text), ours, status)
         call check_equal(error, status, number_ok, text)
         call check_same(error, ours, library, text)
      end do
   end subroutine short_decimals

   subroutine lower_case(error)
      type(error_type), allocatable, intent(inout) :: error

      call check_equal(error, lower('K_Post [Z@{'), 'k_post [z@{', 'only letters change')
      call check_equal(error, lower(''), '', 'nothing')
   end subroutine lower_case

   subroutine lists(error)
      type(error_type), allocatable, intent(inout) :: error

      call check_equal(error, list_of(names), 'elastic, bilinear, takeda', 'three names')
      call check_equal(error, list_of(names(3:3)), 'takeda', 'one name')
      call check_equal(error, list_of(names(4:)), '', 'no name')
   end subroutine lists

   subroutine nearest(error)
      type(error_type), allocatable, intent(inout) :: error

      call check_equal(error, nearest_name('takda', names), 'takeda', 'a letter left out')
      call check_equal(error, nearest_name('Bi-Linear', names), 'bilinear', 'case and a hyphen')
      call check_equal(error, nearest_name('elasticc  ', names), 'elastic', 'a letter too many')
      call check_equal(error, nearest_name('', names), 'takeda', 'nothing typed: the shortest')
   end subroutine nearest

   subroutine one_error(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome

      call fatal_error(outcome, analysis_failed, 'the column stands no longer')
      call check_failed(error, outcome, analysis_failed, 'the column stands no longer')
   end subroutine one_error

   subroutine collected(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(message_list) :: messages

      call messages%raise(outcome)
      call check_true(error, .not. allocated(outcome), 'an empty list is no error')
      call messages%add('first')
      call messages%add('second')
      call messages%raise(outcome)
      call check_equal(error, messages%count, 2, 'number of messages')
      call check_failed(error, outcome, bad_input, 'first'//new_line('a')//'second')
   end subroutine collected

   subroutine flood(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(message_list) :: messages
      integer :: i

      do i = 1, 2000
         call messages%add('message '//to_text(i))
      end do
      call messages%raise(outcome)
      call check_equal(error, messages%count, 2000, 'number of messages')
      call check_failed(error, outcome, bad_input, 'message 25'//new_line('a')//'and 1975 more')
   end subroutine flood

end module test_text
