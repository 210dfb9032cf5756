!> Built-in cyclic protocol.
module test_protocol
   use check, only: unit_test, check_close, check_equal, check_failed, check_passed, check_same
   use rbs_base_error, only: error_type, bad_input
   use rbs_base_kinds, only: wp
   use rbs_loading_protocol, only: protocol_values
   use rbs_loading_loading_record, only: loading_record
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
               unit_test('drift, units and scale', units), &
               unit_test('time: number of the point, or by the period', times), &
               unit_test('a protocol with too many points is refused', too_long)]
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

   subroutine units(error)
      type(error_type), allocatable, intent(inout) :: error
      type(loading_record) :: spec

      spec = protocol([0.01_wp], 1)
      spec%unit = ''
      call expect(error, spec, [0.0_wp, 0.02_wp, 0.0_wp, -0.02_wp, 0.0_wp], 'drift of a height of 2 m')
      spec%unit = 'drift'
      spec%scale = 0.5_wp
      call expect(error, spec, [0.0_wp, 0.01_wp, 0.0_wp, -0.01_wp, 0.0_wp], 'half of it')
      spec = protocol([97.854_wp], 1)
      spec%unit = 'mm'
      call expect(error, spec, [0.0_wp, 97.854e-3_wp, 0.0_wp, -97.854e-3_wp, 0.0_wp], 'millimetres')
      spec%drive = 'force'
      spec%unit = 'kN'
      call expect(error, spec, [0.0_wp, 97854.0_wp, 0.0_wp, -97854.0_wp, 0.0_wp], 'kilonewtons')
   end subroutine units

   subroutine times(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(loading_record) :: spec
      real(wp), allocatable :: time(:), value(:)

      spec = protocol([1.0_wp], 1)
      call protocol_values(spec, 2.0_wp, time, value, outcome)
      call check_passed(error, outcome, 'protocol')
      call check_same(error, time, 1.0_wp*[0, 1, 2, 3, 4], 'number of the point')
      spec%period = 2.0_wp
      call protocol_values(spec, 2.0_wp, time, value, outcome)
      call check_passed(error, outcome, 'protocol')
      call check_close(error, time, 0.5_wp*[0, 1, 2, 3, 4], 1.0e-15_wp, 0.0_wp, 'seconds')
   end subroutine times

   subroutine too_long(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(loading_record) :: spec
      real(wp), allocatable :: time(:), value(:)

      spec = protocol([1.0_wp], 25000)
      spec%cycles = [1000]
      spec%repeats = 1000000
      call protocol_values(spec, 2.0_wp, time, value, outcome)
      call check_failed(error, outcome, bad_input, 'loading: the protocol has 1e+14 points')
   end subroutine too_long

end module test_protocol
