!> Built-in cyclic protocol.
module test_protocol
   use check, only: unit_test, check_close, check_equal, check_failed, check_passed, check_same
   use rbs_base_error, only: error_type, bad_input
   use rbs_base_kinds, only: wp
   use rbs_loading_protocol, only: protocol_values
   use rbs_loading_loading_record, only: loading_record
   use rbs_loading_named_protocols, only: named_protocol
   implicit none
   private

   public :: collect_protocol

contains

   subroutine collect_protocol(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('a cycle goes 0, +a, 0, -a, 0 in equal parts', one_cycle), &
               unit_test('corners are exact for any number of points', corners), &
               unit_test('cycles: one for all, or one for each', cycles), &
               unit_test('the whole is repeated', repeats), &
               unit_test('amplitudes of their own to the other side', two_sides), &
               unit_test('a protocol of the literature has its steps and cycles', by_name)]
   end subroutine collect_protocol

   type(loading_record) function protocol(amplitudes, points) result(spec)
      real(wp), intent(in) :: amplitudes(:)
      integer, intent(in) :: points

      spec%drive = 'displacement'
      spec%source = 'protocol'
      spec%unit = 'm'
      allocate (spec%amplitudes, source=amplitudes)
      spec%points = points
   end function protocol

   subroutine expect(error, spec, expected, what)
      type(error_type), allocatable, intent(inout) :: error
      type(loading_record), intent(in) :: spec
      real(wp), intent(in) :: expected(:)
      character(len=*), intent(in) :: what
      type(error_type), allocatable :: outcome
      real(wp), allocatable :: time(:), value(:)

      call protocol_values(spec, 2.0_wp, time, value, outcome)
      call check_passed(error, outcome, what)
      if (allocated(error)) return
      call check_same(error, value, expected, what)
      call check_equal(error, size(time), size(value), what//': times')
   end subroutine expect

   subroutine one_cycle(error)
      type(error_type), allocatable, intent(inout) :: error

      call expect(error, protocol([3.0_wp], 1), [0.0_wp, 3.0_wp, 0.0_wp, -3.0_wp, 0.0_wp], 'corners only')
      call expect(error, protocol([4.0_wp], 2), &
                  [0.0_wp, 2.0_wp, 4.0_wp, 2.0_wp, 0.0_wp, -2.0_wp, -4.0_wp, -2.0_wp, 0.0_wp], 'two points')
   end subroutine one_cycle

   subroutine corners(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      real(wp), allocatable :: time(:), value(:)
      real(wp), parameter :: a = 0.0123_wp
      integer :: points

      do points = 1, 60
         call protocol_values(protocol([a], points), 2.0_wp, time, value, outcome)
         call check_passed(error, outcome, 'protocol')
         if (allocated(error)) return
         call check_equal(error, size(value), 4*points + 1, 'number of points')
         call check_same(error, value(1::points), [0.0_wp, a, 0.0_wp, -a, 0.0_wp], 'corners')
      end do
   end subroutine corners

   subroutine cycles(error)
      type(error_type), allocatable, intent(inout) :: error
      type(loading_record) :: spec

      spec = protocol([1.0_wp, 2.0_wp], 1)
      spec%cycles = [2]
      call expect(error, spec, 1.0_wp*[0, 1, 0, -1, 0, 1, 0, -1, 0, 2, 0, -2, 0, 2, 0, -2, 0], 'two for all')
      spec%cycles = [1, 2]
      call expect(error, spec, 1.0_wp*[0, 1, 0, -1, 0, 2, 0, -2, 0, 2, 0, -2, 0], 'one, then two')
   end subroutine cycles

   subroutine repeats(error)
      type(error_type), allocatable, intent(inout) :: error
      type(loading_record) :: spec

      spec = protocol([1.0_wp, 2.0_wp], 1)
      spec%repeats = 2
      call expect(error, spec, 1.0_wp*[0, 1, 0, -1, 0, 2, 0, -2, 0, 1, 0, -1, 0, 2, 0, -2, 0], 'twice')
   end subroutine repeats

   subroutine two_sides(error)
      type(error_type), allocatable, intent(inout) :: error
      type(loading_record) :: spec

      spec = protocol([1.0_wp, 2.0_wp], 1)
      spec%negative_amplitudes = [0.5_wp, 0.0_wp]
      call expect(error, spec, [0.0_wp, 1.0_wp, 0.0_wp, -0.5_wp, 0.0_wp, 2.0_wp, 0.0_wp, 0.0_wp, 0.0_wp], &
                  'half to the other side, then nothing')
   end subroutine two_sides

   !> The numbers are those of docs/input.md, "Named protocols".
   subroutine by_name(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      real(wp), allocatable :: amplitudes(:)
      integer, allocatable :: cycles(:)
      type(loading_record) :: spec
      real(wp), allocatable :: time(:), value(:)

      call named_protocol('sac', -1.0_wp, -1.0_wp, amplitudes, cycles, outcome)
      call check_passed(error, outcome, 'sac')
      if (allocated(error)) return
      call check_close(error, amplitudes, [0.00375_wp, 0.005_wp, 0.0075_wp, 0.01_wp, 0.015_wp, 0.02_wp, &
                                           0.03_wp, 0.04_wp], 1e-15_wp, 0.0_wp, 'drifts of sac')
      call check_equal(error, sum(cycles), 30, 'cycles of sac')
      ! FEMA 461: each step 1.4 times the last, ten of them up to the reference.
      call named_protocol('fema_461', 0.05_wp, 0.07_wp, amplitudes, cycles, outcome)
      call check_passed(error, outcome, 'fema_461')
      if (allocated(error)) return
      call check_close(error, amplitudes(2:10)/amplitudes(:9), spread(1.4_wp, 1, 9), 1e-14_wp, 0.0_wp, &
                       'factor')
      call check_close(error, amplitudes(10:), [0.05_wp, 0.065_wp], 1e-14_wp, 0.0_wp, 'reference and beyond')
      ! CUREE: a step of one cycle is followed by trailing ones at three quarters.
      call named_protocol('curee', 2.0_wp, 0.2_wp, amplitudes, cycles, outcome)
      call check_passed(error, outcome, 'curee')
      if (allocated(error)) return
      call check_close(error, amplitudes, [0.1_wp, 0.15_wp, 0.1125_wp, 0.2_wp, 0.15_wp], 1e-15_wp, 0.0_wp, &
                       'curee')
      call check_equal(error, cycles(5), 6, 'trailing cycles')
      call named_protocol('atc_24', 0.01_wp, -1.0_wp, amplitudes, cycles, outcome)
      call check_failed(error, outcome, bad_input, 'largest')
      call named_protocol('fema_461', -1.0_wp, -1.0_wp, amplitudes, cycles, outcome)
      call check_failed(error, outcome, bad_input, 'reference')
      ! Up to its own end, which it does not go beyond.
      call named_protocol('aci_374_1', -1.0_wp, 0.035_wp, amplitudes, cycles, outcome)
      call check_passed(error, outcome, 'aci_374_1 to its end')
      if (allocated(error)) return
      call check_equal(error, size(amplitudes), 10, 'steps of aci_374_1')
      call named_protocol('aci_374_1', -1.0_wp, 0.05_wp, amplitudes, cycles, outcome)
      call check_failed(error, outcome, bad_input, 'ends at')
      ! Drift times height, through the record.
      spec%drive = 'displacement'
      spec%protocol = 'sac'
      spec%source = 'protocol'
      spec%points = 1
      call protocol_values(spec, 2.0_wp, time, value, outcome)
      call check_passed(error, outcome, 'record')
      call check_close(error, [maxval(value), minval(value)], [0.08_wp, -0.08_wp], 1e-15_wp, 0.0_wp, &
                       'drift of 2 m')
   end subroutine by_name

end module test_protocol
