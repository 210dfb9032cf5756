!> Unit tests: `unit_tests [suite [part of a test's name]]`; without arguments all suites.
program unit_tests
   use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
   use check, only: unit_test, run_suite
   use test_capped, only: collect_capped
   use test_condensation, only: collect_condensation
   use test_concrete, only: collect_concrete
   use test_layered, only: collect_layered
   use test_linalg, only: collect_linalg
   use test_peak_oriented, only: collect_peak_oriented
   use test_rules, only: collect_rules
   use test_section, only: collect_section
   use test_springs, only: collect_springs
   use test_steel, only: collect_steel
   use test_takeda, only: collect_takeda
   implicit none

   abstract interface
      subroutine collect_interface(tests)
         import :: unit_test
         implicit none
         type(unit_test), allocatable, intent(out) :: tests(:)
      end subroutine collect_interface
   end interface

   !> A suite by name.
   type :: suite_type
      character(len=16) :: name
      procedure(collect_interface), pointer, nopass :: collect => null()
   end type suite_type

   type(suite_type) :: suites(11)
   character(len=80) :: wanted, pattern
   integer :: i, run, failed, found

   suites = [suite_type('section', collect_section), suite_type('linalg', collect_linalg), &
             suite_type('condensation', collect_condensation), &
             suite_type('takeda', collect_takeda), suite_type('capped', collect_capped), &
             suite_type('peak_oriented', collect_peak_oriented), &
             suite_type('concrete', collect_concrete), suite_type('steel', collect_steel), &
             suite_type('layered', collect_layered), suite_type('rules', collect_rules), &
             suite_type('springs', collect_springs)]

   call get_command_argument(1, wanted)
   call get_command_argument(2, pattern)
   found = 0
   run = 0
   failed = 0
   do i = 1, size(suites)
      if (wanted /= '' .and. wanted /= suites(i)%name) cycle
      found = found + 1
      call run_one(suites(i))
   end do

   write (output_unit, '(i0, a, i0, a)') run, ' tests, ', failed, ' failed'
   if (found == 0) then
      write (error_unit, '(a)', advance='no') "unit_tests: no suite '"//trim(wanted)//"'; there are"
      do i = 1, size(suites)
         write (error_unit, '(a)', advance='no') ' '//trim(suites(i)%name)
      end do
      write (error_unit, '(a)') ''
   end if
   ! A filter that matches no test, or an unknown suite, must not look like success.
   if (failed > 0 .or. run == 0) error stop 1

contains

   subroutine run_one(suite)
      type(suite_type), intent(in) :: suite
      type(unit_test), allocatable :: tests(:)

      call suite%collect(tests)
      call run_suite(trim(suite%name), tests, trim(pattern), output_unit, run, failed)
   end subroutine run_one

end program unit_tests
