!> What holds for every rule in the registry, with random parameters on random paths (`any_rule`).
module test_rules
   use any_rule, only: detours, loops, detour_result, loop_result
   use check, only: unit_test, check_true
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_registry, only: rule_names
   implicit none
   private

   public :: collect_rules

   !> Rules that depend on their path discontinuously: Takeda's at a former peak and where the force is zero
   !> (docs/takeda.md), and a joint whose layers soften.
   character(len=*), parameter :: exceptions(*) = [character(len=16) :: 'takeda', 'layered']

contains

   subroutine collect_rules(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('a detour of size e changes later forces by 10 k e at most', &
                         continuous), &
               unit_test('property 9: no loop and no path gives energy', dissipative)]
   end subroutine collect_rules

   subroutine continuous(error)
      type(error_type), allocatable, intent(inout) :: error
      type(detour_result) :: found
      integer :: i

      do i = 1, size(rule_names)
         if (any(exceptions == rule_names(i))) cycle
         call detours(trim(rule_names(i)), 600, found)
         call check_true(error, all(found%largest <= 10.0_wp), trim(rule_names(i)))
      end do
   end subroutine continuous

   subroutine dissipative(error)
      type(error_type), allocatable, intent(inout) :: error
      type(loop_result) :: found
      integer :: i, histories

      do i = 1, size(rule_names)
         histories = 400
         if (rule_names(i) == 'layered') histories = 60
         call loops(trim(rule_names(i)), histories, found)
         call check_true(error, found%virgin >= -1.0e-12_wp, trim(rule_names(i))//': virgin')
         call check_true(error, found%closed >= -1.0e-9_wp, trim(rule_names(i))//': work of closed loops')
         call check_true(error, found%loops > 0, trim(rule_names(i))//': some loops close')
      end do
   end subroutine dissipative

end module test_rules
