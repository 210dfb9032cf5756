!> Numbers as text, lists of messages.
module test_text
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan, ieee_positive_inf, ieee_negative_inf
   use check, only: unit_test, check_equal, check_failed, check_same, check_true
   use rbs_base_error, only: error_type, message_list, fatal_error, analysis_failed, bad_input
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: exact_text, to_text
   use rbs_io_text_file, only: read_real, number_ok
   use samples, only: random_type
   implicit none
   private

   public :: collect_text

contains

   subroutine collect_text(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('numbers have six digits or powers of ten', numbers), &
               unit_test('exact text reads back to the same bits', exact), &
               unit_test('short decimals are read as the library reads them', short_decimals), &
               unit_test('an error carries code and message', one_error), &
               unit_test('messages are raised together, in order', collected), &
               unit_test('messages beyond the limit are counted', flood)]
   end subroutine collect_text

   !> Six digits without trailing zeros; powers of ten outside 1e-4 to 1e6, chosen after rounding.
   subroutine numbers(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp), parameter :: third = 1.0_wp/3.0_wp
      real(wp), parameter :: x(19) = &
         [0.0_wp, 1.0_wp, -0.5_wp, 0.0016_wp, 123456.0_wp, -120000.0_wp, third, 200.0_wp*third, 1.0e-4_wp, &
          1.0e-5_wp, 1.0e6_wp, 7.0387e8_wp, -2.5e-123_wp, huge(1.0_wp), tiny(1.0_wp), 999999.6_wp, &
          999999.4_wp, 0.99999999_wp, 9.9999999e-5_wp]
      character(len=12), parameter :: expected(19) = [character(len=12) :: &
         '0', '1', '-0.5', '0.0016', '123456', '-120000', '0.333333', '66.6667', '0.0001', &
         '1e-05', '1e+06', '7.0387e+08', '-2.5e-123', '1.79769e+308', '2.22507e-308', '1e+06', &
         '999999', '1', '0.0001']
      integer :: i

      do i = 1, size(x)
         call check_equal(error, to_text(x(i)), trim(expected(i)), expected(i))
      end do
      call check_equal(error, to_text(ieee_value(1.0_wp, ieee_quiet_nan)), 'NaN', 'NaN')
      call check_equal(error, to_text(ieee_value(1.0_wp, ieee_positive_inf)), 'Infinity', '+Inf')
      call check_equal(error, to_text(ieee_value(1.0_wp, ieee_negative_inf)), '-Infinity', '-Inf')
      call check_equal(error, to_text(-huge(1)), '-2147483647', 'an integer')
   end subroutine numbers

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
