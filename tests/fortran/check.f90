!> A small framework for unit tests: named tests in suites, and checks that set an error.
!>
!> A test is a subroutine with an error argument; it passes if the error is not allocated at its end. A
!> check does nothing once the error is allocated: the first failure of a test is the one reported.
module check
   use, intrinsic :: iso_fortran_env, only: int64
   use rbs_base_error, only: error_type, fatal_error
   use rbs_base_kinds, only: wp
   implicit none
   private

   public :: unit_test, test_interface, run_suite
   public :: check_true, check_equal, check_close, check_same, check_passed

   !> Code of a failed check.
   integer, parameter :: check_code = 99

   abstract interface
      subroutine test_interface(error)
         import :: error_type
         implicit none
         type(error_type), allocatable, intent(inout) :: error
      end subroutine test_interface
   end interface

   !> One test. The name has a fixed length: array constructors of types with allocatable components
   !> leak in gfortran 12.
   type :: unit_test
      character(len=72) :: name
      procedure(test_interface), pointer, nopass :: run => null()
   end type unit_test

   !> |actual - expected| <= rtol |expected| + atol.
   interface check_close
      module procedure :: close_numbers, close_arrays
   end interface check_close

   !> Reals that are equal to the last bit.
   interface check_same
      module procedure :: same_numbers, same_arrays
   end interface check_same

contains

   !> Run the tests whose name contains `pattern`, and print one line for each.
   subroutine run_suite(suite, tests, pattern, unit, run, failed)
      character(len=*), intent(in) :: suite
      type(unit_test), intent(in) :: tests(:)
      !> Part of a name; empty: all tests
      character(len=*), intent(in) :: pattern
      !> Unit for the lines
      integer, intent(in) :: unit
      !> Tests run and failed so far
      integer, intent(inout) :: run, failed
      type(error_type), allocatable :: error
      integer :: i, length

      call random_seed(size=length)
      do i = 1, size(tests)
         if (index(tests(i)%name, pattern) == 0) cycle
         ! Each test draws the same numbers in each run, alone or among others.
         call random_seed(put=spread(i, 1, length))
         if (allocated(error)) deallocate (error)
         call tests(i)%run(error)
         run = run + 1
         if (allocated(error)) then
            failed = failed + 1
            write (unit, '(a)') 'FAIL  '//suite//': '//trim(tests(i)%name)//': '//error%message
         else
            write (unit, '(a)') 'ok    '//suite//': '//trim(tests(i)%name)
         end if
      end do
   end subroutine run_suite

   !> A condition holds.
   subroutine check_true(error, condition, what)
      type(error_type), allocatable, intent(inout) :: error
      logical, intent(in) :: condition
      character(len=*), intent(in) :: what

      if (.not. condition) call fail(error, what)
   end subroutine check_true

   !> Two integers are equal.
   subroutine check_equal(error, actual, expected, what)
      type(error_type), allocatable, intent(inout) :: error
      integer, intent(in) :: actual, expected
      character(len=*), intent(in) :: what
      character(len=64) :: text

      if (actual == expected) return
      write (text, '(i0, a, i0)') actual, ', expected ', expected
      call fail(error, what//': '//trim(text))
   end subroutine check_equal

   subroutine close_numbers(error, actual, expected, rtol, atol, what)
      type(error_type), allocatable, intent(inout) :: error
      real(wp), intent(in) :: actual, expected, rtol, atol
      character(len=*), intent(in) :: what

      if (.not. abs(actual - expected) <= rtol*abs(expected) + atol) then
         call fail(error, what//': '//difference(actual, expected))
      end if
   end subroutine close_numbers

   subroutine close_arrays(error, actual, expected, rtol, atol, what)
      type(error_type), allocatable, intent(inout) :: error
      real(wp), intent(in) :: actual(:), expected(:), rtol, atol
      character(len=*), intent(in) :: what
      integer :: i

      call check_equal(error, size(actual), size(expected), what//': size')
      do i = 1, min(size(actual), size(expected))
         call close_numbers(error, actual(i), expected(i), rtol, atol, what//' '//place(i))
      end do
   end subroutine close_arrays

   subroutine same_numbers(error, actual, expected, what)
      type(error_type), allocatable, intent(inout) :: error
      real(wp), intent(in) :: actual, expected
      character(len=*), intent(in) :: what

      if (transfer(actual, 0_int64) /= transfer(expected, 0_int64)) then
         call fail(error, what//': '//difference(actual, expected)//' to the last bit')
      end if
   end subroutine same_numbers

   subroutine same_arrays(error, actual, expected, what)
      type(error_type), allocatable, intent(inout) :: error
      real(wp), intent(in) :: actual(:), expected(:)
      character(len=*), intent(in) :: what
      integer :: i

      call check_equal(error, size(actual), size(expected), what//': size')
      do i = 1, min(size(actual), size(expected))
         call same_numbers(error, actual(i), expected(i), what//' '//place(i))
      end do
   end subroutine same_arrays

   !> A procedure under test has not failed.
   subroutine check_passed(error, outcome, what)
      type(error_type), allocatable, intent(inout) :: error
      !> Error that the procedure returned
      type(error_type), allocatable, intent(in) :: outcome
      character(len=*), intent(in) :: what

      if (allocated(outcome)) call fail(error, what//' failed: '//outcome%message)
   end subroutine check_passed

   subroutine fail(error, message)
      type(error_type), allocatable, intent(inout) :: error
      character(len=*), intent(in) :: message

      if (.not. allocated(error)) call fatal_error(error, check_code, message)
   end subroutine fail

   function difference(actual, expected) result(text)
      real(wp), intent(in) :: actual, expected
      character(len=:), allocatable :: text
      character(len=80) :: buffer

      write (buffer, '(es24.16e3, a, es24.16e3)') actual, ', expected', expected
      text = trim(adjustl(buffer))
   end function difference

   function place(i) result(text)
      integer, intent(in) :: i
      character(len=:), allocatable :: text
      character(len=16) :: buffer

      write (buffer, '(a, i0, a)') '(', i, ')'
      text = trim(buffer)
   end function place

end module check
