!> Steel with a rounded transition (docs/rules.md section 10): Menegotto and Pinto 1973 in chords.
module test_steel
   use check, only: unit_test, check_close, check_same, check_true
   use paths, only: check_copies, check_increments
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_rule, only: rule_type
   use rbs_hysteresis_segment, only: segment
   use rbs_hysteresis_springs, only: follow_path, spring_array
   use rbs_hysteresis_spring_record, only: spring_record
   use samples, only: random_type, steel_1
   implicit none
   private

   public :: collect_steel

   !> Yields at (1, 1).
   real(wp), parameter :: hardening = 0.01_wp

contains

   subroutine collect_steel(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('Menegotto and Pinto 1973: virgin branch at the ends of the chords', virgin), &
               unit_test('Menegotto and Pinto 1973: branch after a reversal', reversed), &
               unit_test('Filippou, Popov and Bertero 1983: strength grows with the range', growth), &
               unit_test('half_strength_work: half of the strength, a fifth', endurance), &
               unit_test('moves in the elastic range have no effect', elastic_range), &
               unit_test('small cycles close and never overshoot', small_cycles), &
               unit_test('a small cycle has no effect', closed), &
               unit_test('more cycles within cycles than are remembered', many_nested), &
               unit_test('mirrored path, mirrored bits', mirror), &
               unit_test('forces are continuous where lines meet', continuous), &
               unit_test('property 2: 1, 7, 1000 increments, to the last bit', increments), &
               unit_test('copies and trial moves have no effect', copies), &
               unit_test('start clears the memory', forgets), &
               unit_test('property 9: work of closed cycles, to the error of the chords', cycles), &
               unit_test('the force stays between the lines of hardening', bounded)]
   end subroutine collect_steel

   !> Yields at (1, 1).
   type(spring_record) function unit_steel() result(spec)
      spec%rule = 'steel'
      call spec%set('k', 1.0_wp)
      call spec%set('f_y', 1.0_wp)
      call spec%set('k_post', hardening)
   end function unit_steel

   !> f* = b x + (1 - b) x/(1 + x^R)^(1/R).
   elemental real(wp) function star(x, r)
      real(wp), intent(in) :: x, r

      star = hardening*x + (1.0_wp - hardening)*x/(1.0_wp + x**r)**(1.0_wp/r)
   end function star

   !> The ends are where x^R is 0.03, 0.15, 0.4, 0.8, 1.5, 3, 8, 30.
   subroutine virgin(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp), parameter :: power(8) = [0.03_wp, 0.15_wp, 0.4_wp, 0.8_wp, 1.5_wp, 3.0_wp, 8.0_wp, 30.0_wp]
      real(wp) :: x(8), f(8), far(1)
      integer :: r0

      do r0 = 2, 20, 6
         x = power**(1.0_wp/r0)
         call follow_path(with_roundness(real(r0, wp)), x, f)
         call check_close(error, f, star(x, real(r0, wp)), 1.0e-13_wp, 0.0_wp, 'chords')
      end do
      ! After the last chord with the slope of hardening.
      call follow_path(with_roundness(20.0_wp), [50.0_wp], far)
      call check_close(error, far(1), f(8) + hardening*(50.0_wp - x(8)), 1.0e-13_wp, 0.0_wp, 'far out')
      call check_close(error, far(1), star(50.0_wp, 20.0_wp), 2.0e-3_wp, 0.0_wp, 'asymptote')
   end subroutine virgin

   type(spring_record) function with_roundness(r0) result(spec)
      real(wp), intent(in) :: r0

      spec = unit_steel()
      call spec%set('r0', r0)
   end function with_roundness

   !> From (5, f): asymptotes meet where the elastic line meets -1 + b (d + 1); the plastic excursion is
   !> measured from the lowest deformation so far, here 0.
   subroutine reversed(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp) :: f(2), f_turn(1), d_a, f_a, r, xi, x
      type(spring_record) :: spec

      spec = unit_steel()
      call follow_path(spec, [5.0_wp], f_turn)
      d_a = (-1.0_wp + hardening - f_turn(1) + 5.0_wp)/(1.0_wp - hardening)
      f_a = f_turn(1) + d_a - 5.0_wp
      xi = abs(0.0_wp - d_a)
      r = spec%get('r0')*(1.0_wp - spec%get('cr1')*xi/(spec%get('cr2') + xi))
      x = 1.5_wp**(1.0_wp/r)
      call follow_path(spec, [5.0_wp, 5.0_wp + x*(d_a - 5.0_wp)], f)
      call check_close(error, f(2), f_turn(1) + star(x, r)*(f_a - f_turn(1)), 1.0e-12_wp, 0.0_wp, 'force')
   end subroutine reversed

   !> Range from 0 to 8: half of it is 4 d_y, the strength grows by isotropic_hardening 4^0.8.
   subroutine growth(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_record) :: spec
      real(wp) :: f(2), g(2)

      spec = unit_steel()
      call spec%set('cr1', 0.0_wp)
      call follow_path(spec, [8.0_wp, -200.0_wp], f)
      call spec%set('isotropic_hardening', 0.1_wp)
      call follow_path(spec, [8.0_wp, -200.0_wp], g)
      call check_same(error, g(1), f(1), 'virgin branch')
      call check_close(error, f(2) - g(2), 0.1_wp*4.0_wp**0.8_wp, 3.0e-3_wp, 0.0_wp, 'new branch')
   end subroutine growth

   !> The plastic work up to `far` is the area under the curve less the elastic part.
   subroutine endurance(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_record) :: spec
      type(spring_array) :: spring
      real(wp) :: f(2), g(2), plastic

      spec = unit_steel()
      call spec%set('cr1', 0.0_wp)
      call spring%create([spec])
      call spring%move(1, 20.0_wp)
      plastic = spring%work(1) - 0.5_wp*spring%force(1)**2
      call follow_path(spec, [20.0_wp, -400.0_wp], f)
      call spec%set('half_strength_work', plastic)
      call follow_path(spec, [20.0_wp, -400.0_wp], g)
      call check_close(error, g(2) - f(2), 0.5_wp, 3.0e-3_wp, 0.0_wp, 'half')
      call spec%set('half_strength_work', 0.5_wp*plastic)
      call follow_path(spec, [20.0_wp, -400.0_wp], g)
      call check_close(error, g(2) - f(2), 0.8_wp, 3.0e-3_wp, 0.0_wp, 'a fifth after twice the work')
   end subroutine endurance

   subroutine elastic_range(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp) :: f(7), straight(1)

      call follow_path(unit_steel(), [0.8_wp, -0.8_wp, 0.5_wp, 0.0_wp, -0.3_wp, 0.0_wp, 3.0_wp], f)
      call check_close(error, f(:6), [0.8_wp, -0.8_wp, 0.5_wp, 0.0_wp, -0.3_wp, 0.0_wp], 3.0e-3_wp, &
                       1.0e-15_wp, 'elastic')
      call follow_path(unit_steel(), [3.0_wp], straight)
      call check_same(error, f(7), straight(1), 'no effect')
   end subroutine elastic_range

   !> Cycles that return to the virgin branch: after them the force is on it, between curve and chord.
   subroutine small_cycles(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      type(spring_record) :: spec
      real(wp) :: top, d(8), f(8), x
      integer :: i, j

      do i = 1, 200
         spec = with_roundness(random%uniform(3.0_wp, 20.0_wp))
         top = random%uniform(1.5_wp, 8.0_wp)
         d(1) = top
         do j = 2, 7
            d(j) = top - random%uniform(0.0_wp, 0.6_wp)
         end do
         x = top + random%uniform(0.5_wp, 3.0_wp)
         d(8) = x
         call follow_path(spec, d, f)
         call check_true(error, f(8) <= star(x, spec%get('r0')) + 1.0e-9_wp, 'no overshoot')
         call check_close(error, f(8), star(x, spec%get('r0')), 2.0e-2_wp, 0.0_wp, 'after the small cycles')
      end do
   end subroutine small_cycles

   !> After a return to the start of a cycle the rest of the path is as without the cycle.
   subroutine closed(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      type(spring_record) :: spec
      real(wp) :: d(6), f(6), g(3), small
      integer :: i

      do i = 1, 200
         spec = with_roundness(random%uniform(10.0_wp, 20.0_wp))
         small = random%uniform(0.05_wp, 0.5_wp)
         d = [-4.0_wp, 3.0_wp, 3.0_wp - small, 3.0_wp, 5.0_wp, -6.0_wp]
         call follow_path(spec, d, f)
         call follow_path(spec, d([1, 5, 6]), g)
         call check_close(error, f([5, 6]), g(2:3), 2.0e-2_wp, 0.0_wp, 'as without the cycle')
      end do
   end subroutine closed

   !> More nested cycles than are remembered, and out of all of them: elastic ones that return to their start,
   !> and plastic ones.
   subroutine many_nested(error)
      type(error_type), allocatable, intent(inout) :: error
      integer, parameter :: most = 60
      real(wp), parameter :: widths(4) = [0.4_wp, 0.8_wp, 1.5_wp, 6.0_wp]
      type(spring_record) :: spec
      real(wp) :: d(most + 1), f(most + 1), g(2)
      integer :: i, w, side

      spec = unit_steel()
      call spec%set('cr1', 0.0_wp)
      do w = 1, size(widths)
         do i = 1, most
            d(i) = 6.0_wp - widths(w)*(1.0_wp - (1.0_wp - 0.012_wp*i)*(-1.0_wp)**(i + 1))
         end do
         do side = -1, 1, 2
            d(most + 1) = side*30.0_wp
            call follow_path(spec, d, f)
            call follow_path(spec, d([1, most + 1]), g)
            call check_close(error, f(most + 1), g(2), 2.0e-2_wp, 0.0_wp, 'out of all')
            call check_true(error, maxval(abs(f)) <= 1.01_wp*abs(g(2)), 'on the path')
         end do
      end do
   end subroutine many_nested

   !> A random steel, and a path in units of its yield deformation.
   subroutine random_steel(random, spec, d)
      type(random_type), intent(inout) :: random
      type(spring_record), intent(out) :: spec
      real(wp), intent(out) :: d(:)
      real(wp) :: exponent
      integer :: j

      spec = unit_steel()
      call spec%set('k_post', max(0.0_wp, random%uniform(-0.02_wp, 0.1_wp)))
      call spec%set('r0', random%uniform(1.0_wp, 25.0_wp))
      call spec%set('cr1', random%uniform(0.0_wp, 0.95_wp))
      call spec%set('cr2', random%uniform(0.05_wp, 0.5_wp))
      do j = 1, size(d)
         exponent = random%uniform(-1.0_wp, 1.2_wp)
         d(j) = random%uniform(-1.0_wp, 1.0_wp)*10.0_wp**exponent
         ! Exact returns to an earlier point.
         if (random%uniform(0.0_wp, 1.0_wp) > 0.85_wp) d(j) = d(max(j - 3, 1))
      end do
   end subroutine random_steel

   subroutine mirror(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      type(spring_record) :: spec
      real(wp) :: d(40), f(40), mirrored(40)
      integer :: path

      do path = 1, 200
         call random_steel(random, spec, d)
         call spec%set('isotropic_hardening', 0.02_wp)
         call spec%set('half_strength_work', 500.0_wp)
         call follow_path(spec, d, f)
         call follow_path(spec, -d, mirrored)
         call check_same(error, mirrored, 0.0_wp - f, 'mirror')
      end do
   end subroutine mirror

   !> The force is continuous at every event; the ends of every line are in order.
   subroutine continuous(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      type(spring_record) :: spec
      class(rule_type), allocatable :: rule
      type(segment) :: line
      real(wp) :: to(40), d, before
      integer :: path, j, direction, lines

      do path = 1, 300
         call random_steel(random, spec, to)
         call spec%set('isotropic_hardening', 0.02_wp)
         call spec%set('half_strength_work', 500.0_wp)
         call spec%make(rule)
         call rule%start(line)
         d = 0.0_wp
         do j = 1, size(to)
            direction = merge(1, -1, to(j) > d)
            do lines = 1, 200
               if (line%one_way == -direction) then
                  if (direction > 0) line%hi = d
                  if (direction < 0) line%lo = d
               end if
               if (direction*(to(j) - line%end_toward(direction)) < 0.0_wp) exit
               d = line%end_toward(direction)
               before = line%force(d)
               call rule%next(line, direction)
               call check_close(error, line%force(d), before, 0.0_wp, 1.0e-9_wp, 'force at an event')
               call check_true(error, line%lo <= d .and. d <= line%hi, 'on the new line')
               call check_true(error, line%k <= 1.0_wp + 1.0e-6_wp, 'not stiffer than elastic')
               call check_true(error, line%k >= 0.0_wp, 'does not fall')
            end do
            call check_true(error, lines < 150, 'few lines in one move')
            d = to(j)
         end do
      end do
   end subroutine continuous

   subroutine increments(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      type(spring_record) :: spec
      real(wp) :: d(20)
      integer :: path

      do path = 1, 200
         call random_steel(random, spec, d)
         call check_increments(error, spec, d, 7)
         if (path <= 20) call check_increments(error, spec, d, 1000)
      end do
   end subroutine increments

   subroutine copies(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      type(spring_record) :: spec
      real(wp) :: d(40)
      integer :: path

      do path = 1, 100
         call random_steel(random, spec, d)
         call check_copies(error, spec, d, random, 12.0_wp)
      end do
   end subroutine copies

   subroutine forgets(error)
      type(error_type), allocatable, intent(inout) :: error
      class(rule_type), allocatable :: rule
      type(spring_record) :: spec
      type(segment) :: first, line
      integer :: i

      spec = steel_1()
      call spec%make(rule)
      call rule%start(first)
      line = first
      do i = 1, 100
         ! Up four lines, down four lines: branches have no end.
         call rule%next(line, merge(1, -1, mod(i, 8) < 4))
      end do
      call rule%start(line)
      call check_same(error, [line%d0, line%f0, line%k, line%lo, line%hi], &
                      [first%d0, first%f0, first%k, first%lo, first%hi], 'first line')
   end subroutine forgets

   !> From a state away and back, twice, so that the second cycle is closed.
   subroutine cycles(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      type(spring_record) :: spec
      type(spring_array) :: spring
      real(wp) :: d(12), begin, ends(2)
      integer :: path, j, i

      do path = 1, 300
         call random_steel(random, spec, d)
         call spring%create([spec])
         do j = 1, size(d)
            call spring%move(1, d(j))
            call check_true(error, spring%work(1) >= -1.0e-9_wp, 'work from the virgin state')
         end do
         ends(1) = random%uniform(-5.0_wp, 5.0_wp)
         ends(2) = random%uniform(-5.0_wp, 5.0_wp)
         do i = 1, 6
            begin = spring%work(1)
            call spring%move(1, ends(1))
            call spring%move(1, ends(2))
         end do
         ! Two chords of a small cycle may lie beyond the curves they replace.
         call check_true(error, spring%work(1) - begin >= -5.0e-3_wp, 'work of a closed cycle')
      end do
   end subroutine cycles

   !> |f - k_post d| <= f_y - k_post d_y.
   subroutine bounded(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      type(spring_record) :: spec
      real(wp) :: d(60), f(60)
      integer :: path

      do path = 1, 300
         call random_steel(random, spec, d)
         call follow_path(spec, d, f)
         call check_true(error, &
                         all(abs(f - spec%get('k_post')*d) <= 1.0_wp - spec%get('k_post') + 1.0e-6_wp), &
                             'bounds')
      end do
   end subroutine bounded

end module test_steel
