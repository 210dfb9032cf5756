!> The peak-oriented and the pinching spring: sequences of docs/rules.md, computed by hand.
module test_peak_oriented
   use check, only: unit_test, check_close, check_same, check_true
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_spring_record, only: spring_record
   use rbs_hysteresis_springs, only: follow_path, spring_array
   use samples, only: make_springs, capped, set_value, random_type
   implicit none
   private

   public :: collect_peak_oriented

   !> Energy that the excursion from zero to 2 and back to zero force dissipates, 94.5.
   real(wp), parameter :: energy = 50.0_wp + 105.0_wp - 0.5_wp*110.0_wp**2/100.0_wp

   real(wp), parameter :: close = 1.0e-12_wp

contains

   subroutine collect_peak_oriented(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('unloading, reloading to yield, to the peaks, past the cap', sequence), &
               unit_test('inner loops close at the turn where they began', inner_loops), &
               unit_test('pinching: the break, with and without a permanent deformation', pinching), &
               unit_test('strength deteriorates', strength), &
               unit_test('the strength fades', fading), &
               unit_test('the softening line deteriorates', softening), &
               unit_test('the unloading stiffness deteriorates where the motion turns back', unloading), &
               unit_test('the target of reloading moves outward', target), &
               unit_test('the strength decays with the work of the hinge', decay), &
               unit_test('decay: small detours of both springs have small effects', small_detours)]
   end subroutine collect_peak_oriented

   !> Forces along a path against those by hand.
   subroutine expect(error, spec, d, by_hand, what)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_record), intent(in) :: spec
      real(wp), intent(in) :: d(:), by_hand(:)
      character(len=*), intent(in) :: what
      real(wp) :: f(size(d))

      call follow_path(spec, d, f)
      call check_close(error, f, by_hand, close, 1.0e-10_wp, what)
   end subroutine expect

   subroutine sequence(error)
      type(error_type), allocatable, intent(inout) :: error

      ! Zero force at 2 - 110/100; from there to the yield point at -1; from -0.9 to the peak at 2.
      call expect(error, capped('peak_oriented'), &
                  [2.0_wp, 1.5_wp, 2.0_wp, 0.9_wp, 0.45_wp, -1.0_wp, -2.0_wp, 0.0_wp, 2.0_wp, 8.0_wp, &
                   7.3_wp, -2.0_wp], &
                  [110.0_wp, 60.0_wp, 110.0_wp, 0.0_wp, -100.0_wp*0.45_wp/1.9_wp, -100.0_wp, -110.0_wp, &
                   110.0_wp*0.9_wp/2.9_wp, 110.0_wp, 70.0_wp, 0.0_wp, -110.0_wp], 'forces')
   end subroutine sequence

   !> After an inner cycle reloading goes first to where it turned back, then to the peak; after two of them
   !> to both. A turn whose line started farther in is forgotten.
   subroutine inner_loops(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp) :: turn, zero, back, again, inner, third

      turn = 110.0_wp/2.9_wp*1.9_wp
      zero = 1.0_wp - turn/100.0_wp
      back = -110.0_wp/(2.0_wp + zero)*(0.5_wp + zero)
      again = -0.5_wp - back/100.0_wp
      call expect(error, capped('peak_oriented'), &
                  [2.0_wp, -2.0_wp, 1.0_wp, -0.5_wp, 0.5_wp, 1.0_wp, 1.5_wp, 2.0_wp], &
                  [110.0_wp, -110.0_wp, turn, back, turn*(0.5_wp - again)/(1.0_wp - again), turn, &
                   0.5_wp*(turn + 110.0_wp), 110.0_wp], 'one')
      ! From 0.5 to zero force, a little to the other side on the line to its turn, and back over 0.5 and 1.
      inner = turn*(0.5_wp - again)/(1.0_wp - again)
      zero = 0.5_wp - inner/100.0_wp
      third = back*(zero + 0.1_wp)/(zero + 0.5_wp)
      again = -0.1_wp - third/100.0_wp
      call expect(error, capped('peak_oriented'), &
                  [2.0_wp, -2.0_wp, 1.0_wp, -0.5_wp, 0.5_wp, -0.1_wp, 0.3_wp, 0.5_wp, 0.75_wp, 1.0_wp, &
                   1.5_wp], &
                  [110.0_wp, -110.0_wp, turn, back, inner, third, inner*(0.3_wp - again)/(0.5_wp - again), &
                   inner, 0.5_wp*(inner + turn), turn, 0.5_wp*(turn + 110.0_wp)], 'two')
      ! Unloading from -2 again ends at -0.9, where the line to the turn at 1 started: straight to the peak.
      call expect(error, capped('peak_oriented'), [2.0_wp, -2.0_wp, 1.0_wp, -2.5_wp, 1.0_wp], &
                  [110.0_wp, -110.0_wp, turn, -115.0_wp, 110.0_wp*2.35_wp/3.35_wp], 'forgotten')
   end subroutine inner_loops

   !> Peak (2, 110) on both sides: permanent 0.9, break at 0.45 with 0.4 of the straight line.
   subroutine pinching(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_record) :: spec
      real(wp) :: break_force

      spec = capped('pinching')
      call set_value(spec, 'kappa_f', 0.4_wp)
      call set_value(spec, 'kappa_d', 0.5_wp)
      break_force = 0.4_wp*110.0_wp/2.9_wp*1.35_wp
      call expect(error, spec, [2.0_wp, -2.0_wp, 0.0_wp, 0.45_wp, 1.225_wp, 2.0_wp], &
                  [110.0_wp, -110.0_wp, break_force*0.9_wp/1.35_wp, break_force, &
                   0.5_wp*(break_force + 110.0_wp), 110.0_wp], 'both sides loaded')
      call set_value(spec, 'kappa_d', 0.4_wp)
      call expect(error, spec, [2.0_wp, -2.0_wp, 0.54_wp], &
                  [110.0_wp, -110.0_wp, 0.4_wp*110.0_wp/2.9_wp*1.44_wp], 'less missing')
      ! A side that has not yielded breaks at zero deformation.
      break_force = 0.4_wp*100.0_wp/1.9_wp*0.9_wp
      call expect(error, spec, [2.0_wp, 0.0_wp, -0.5_wp, -1.0_wp], &
                  [110.0_wp, -break_force, -0.5_wp*(break_force + 100.0_wp), -100.0_wp], 'one side loaded')
   end subroutine pinching

   !> lambda = 10: the other side has the share S of its strength, hardening 10 S.
   subroutine strength(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_record) :: spec
      real(wp) :: c, left
      integer :: i

      do i = 0, 1
         c = 1.0_wp + 0.5_wp*i
         spec = capped('peak_oriented')
         call set_value(spec, 'lambda_s', 10.0_wp)
         call set_value(spec, 'c', c)
         left = 1.0_wp - (energy/1000.0_wp)**c
         call expect(error, spec, [2.0_wp, -2.0_wp, -2.5_wp], &
                     [110.0_wp, -left*(100.0_wp + 10.0_wp*(2.0_wp - left)), &
                      -left*(100.0_wp + 10.0_wp*(2.5_wp - left))], 'forces')
      end do
   end subroutine strength

   subroutine fading(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_record) :: spec
      real(wp), parameter :: left(2) = [exp(-energy/1000.0_wp), 1.0_wp/(1.0_wp + energy/1000.0_wp)]
      integer :: i

      spec = capped('peak_oriented')
      call set_value(spec, 'lambda_s', 10.0_wp)
      do i = 1, 2
         call set_value(spec, 'fade', real(i, wp))
         call expect(error, spec, [2.0_wp, -2.0_wp], &
                     [110.0_wp, -left(i)*(100.0_wp + 10.0_wp*(2.0_wp - left(i)))], 'forces')
      end do
   end subroutine fading

   !> The same of the softening line.
   subroutine softening(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_record) :: spec
      real(wp) :: left

      spec = capped('peak_oriented')
      call set_value(spec, 'lambda_c', 10.0_wp)
      left = 1.0_wp - energy/1000.0_wp
      call expect(error, spec, [2.0_wp, -8.0_wp], [110.0_wp, -(150.0_wp*left - 80.0_wp)], 'forces')
   end subroutine softening

   !> Computed where the motion turns back, from the energy that unloading will not return.
   subroutine unloading(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_record) :: spec
      real(wp) :: k

      spec = capped('peak_oriented')
      call set_value(spec, 'lambda_k', 10.0_wp)
      k = 100.0_wp*(1.0_wp - energy/1000.0_wp)
      call expect(error, spec, [2.0_wp, 1.5_wp, 1.0_wp, 1.8_wp, 2.0_wp, 2.1_wp], &
                  [110.0_wp, 110.0_wp - 0.5_wp*k, 110.0_wp - k, 110.0_wp - 0.2_wp*k, 110.0_wp, 111.0_wp], &
                  'forces')
   end subroutine unloading

   !> Target of the side that is entered: from 2 outward, on the backbone.
   subroutine target(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_record) :: spec
      real(wp) :: yield, force, second, reached, slope

      spec = capped('peak_oriented')
      call set_value(spec, 'lambda_a', 10.0_wp)
      ! The second excursion, from 0.9 to the moved yield of the other side, to (-2, -110), back to zero.
      yield = 1.0_wp/(1.0_wp - energy/1000.0_wp)
      force = 100.0_wp + 10.0_wp*(yield - 1.0_wp)
      second = 0.5_wp*(yield + 0.9_wp)*force + 0.5_wp*(force + 110.0_wp)*(2.0_wp - yield) - 60.5_wp
      reached = 2.0_wp/(1.0_wp - second/1000.0_wp)
      slope = (100.0_wp + 10.0_wp*(reached - 1.0_wp))/(reached + 0.9_wp)
      call expect(error, spec, [2.0_wp, -2.0_wp, 1.0_wp], &
                  [110.0_wp, -110.0_wp, slope*1.9_wp], 'forces')
   end subroutine target

   !> A hinge, elastic 100 up to 1 and then plastic.
   type(spring_record) function hinge() result(spec)
      spec%rule = 'bilinear'
      call set_value(spec, 'k', 100.0_wp)
      call set_value(spec, 'd_y', 1.0_wp)
      call set_value(spec, 'k_post', 0.0_wp)
   end function hinge

   !> A work of 200 = lambda_h f_y d_y leaves 0.2 + 0.8/2 = 0.6 of the side that is entered next; what the
   !> hinge did before the spring left its first line, 450, counts for nothing.
   subroutine decay(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_array) :: springs
      type(spring_record) :: spec

      spec = capped('peak_oriented')
      call set_value(spec, 'lambda_h', 2.0_wp)
      call set_value(spec, 's_min', 0.2_wp)
      call make_springs(springs, [spec, hinge()], told=[2, 0])
      call springs%advance_to(2, 5.0_wp)
      call springs%advance_to(1, 2.0_wp)
      call check_same(error, springs%force(1), 110.0_wp, 'not yet')
      call springs%advance_to(2, 7.0_wp)
      call check_same(error, springs%work(2), 650.0_wp, 'work of the hinge')
      call springs%advance_to(1, -1.0_wp)
      call check_close(error, springs%force(1), -62.4_wp, close, 0.0_wp, '0.6 (100 + 10 (1 - 0.6))')
      call springs%advance_to(1, -1.6_wp)
      call check_close(error, springs%force(1), -66.0_wp, close, 0.0_wp, 'its hardening, 0.6 times 10')
      ! Alone there is no hinge to hear of.
      call expect(error, spec, [2.0_wp, -1.0_wp], [110.0_wp, -100.0_wp], 'alone')
   end subroutine decay

   subroutine small_detours(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      type(spring_array) :: springs(2)
      type(spring_record) :: spec
      real(wp) :: d(2, 20), e, worst
      integer :: history, step, at, i

      worst = 0.0_wp
      do history = 1, 400
         spec = capped(merge('pinching     ', 'peak_oriented', mod(history, 2) == 0))
         if (mod(history, 2) == 0) then
            call set_value(spec, 'kappa_f', 0.4_wp)
            call set_value(spec, 'kappa_d', 0.5_wp)
         end if
         call set_value(spec, 'lambda_h', 2.0_wp)
         if (mod(history, 3) == 0) then
            call set_value(spec, 'd_c', 0.3_wp)
            call set_value(spec, 'f_c', 60.0_wp)
         end if
         e = 10.0_wp**random%uniform(-9.0_wp, -4.0_wp)
         at = int(random%uniform(2.0_wp, 18.0_wp))
         do step = 1, size(d, 2)
            d(:, step) = [random%uniform(-3.0_wp, 3.0_wp), random%uniform(-2.0_wp, 2.0_wp)]
            ! Near zero force the excursions end.
            if (random%uniform(0.0_wp, 1.0_wp) < 0.3_wp) d(:, step) = 0.01_wp*d(:, step)
         end do
         do i = 1, 2
            call make_springs(springs(i), [spec, hinge()], told=[2, 0])
         end do
         do step = 1, size(d, 2)
            do i = 1, 2
               call springs(i)%move_all(d(:, step))
            end do
            if (step == at) then
               call springs(2)%move_all(d(:, step) - e)
               call springs(2)%move_all(d(:, step))
            end if
            worst = max(worst, abs(springs(1)%force(1) - springs(2)%force(1))/(200.0_wp*e))
         end do
      end do
      call check_true(error, worst <= 10.0_wp, 'a detour of e changes later forces by 10 k e at most')
      call check_true(error, worst > 0.0_wp, 'there was an effect')
   end subroutine small_detours

end module test_peak_oriented
