!> Springs of any rule in the registry with random parameters, random paths, and what holds for each rule:
!> small detours have small effects, and closed loops give no energy.
!>
!> Parameters are drawn from the keys of a rule, so that a new rule is held to these properties without a
!> change here.
module any_rule
   use rbs_base_check, only: is_given
   use rbs_base_constants, only: unbounded
   use rbs_base_error, only: message_list
   use rbs_base_keys, only: key_type, choice_name, word_kind, deformation, force, stiffness
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_registry, only: keys_of, rule_names, suits
   use rbs_hysteresis_rule, only: rule_type, rule_memory, most_parameters, in_layer
   use rbs_hysteresis_segment, only: segment
   use rbs_hysteresis_layered_layered_joint, only: carries_axial_load
   use rbs_hysteresis_spring_record, only: spring_record
   use rbs_hysteresis_springs, only: spring_array
   use samples, only: make_springs, random_type
   implicit none
   private

   public :: random_spring, random_path, yield_of, detours, loops, detour_result, loop_result

   !> Sizes of the detours over the first yield deformation
   real(wp), parameter, public :: sizes(3) = [1.0e-3_wp, 1.0e-6_wp, 1.0e-9_wp]

   !> Histories of one spring
   integer, parameter :: histories_each = 10

   !> What detours have changed.
   type :: detour_result
      !> Largest change of a later force over size times stiffness (see `steepest`), by size
      real(wp) :: largest(size(sizes)) = 0.0_wp
      !> Share of the histories in which it is above 10, by size
      real(wp) :: share(size(sizes)) = 0.0_wp
      !> The worst spring, its path, the place and the length of the detour
      type(spring_record) :: spec
      real(wp), allocatable :: d(:)
      integer :: at = 0
      real(wp) :: length = 0.0_wp
   end type detour_result

   !> What loops have given.
   type :: loop_result
      !> Least work from the virgin state, and of closed loops, over first stiffness times square of the
      !> largest deformation
      real(wp) :: virgin = 0.0_wp, closed = 0.0_wp
      !> Number of closed loops
      integer :: loops = 0
      type(spring_record) :: spec
      real(wp), allocatable :: d(:)
   end type loop_result

contains

   !> A spring of a rule that its checks accept.
   recursive subroutine random_spring(random, rule, spec)
      type(random_type), intent(inout) :: random
      character(len=*), intent(in) :: rule
      type(spring_record), intent(out) :: spec
      type(key_type), allocatable :: keys(:)
      real(wp) :: before(most_parameters), choice
      integer :: i, trial

      spec%rule = rule
      if (rule == 'layered') then
         call random_layers(random, spec)
         return
      end if
      call keys_of(rule, keys)
      do
         do i = 1, size(keys)
            if (is_required(keys(i))) spec%value(i) = random_value(random, keys(i))
         end do
         if (is_valid(spec)) exit
      end do
      ! One or two of the other parameters at a time, as some belong together.
      do trial = 1, 6*size(keys)
         before = spec%value
         i = 1 + int(random%uniform(0.0_wp, 0.999999_wp)*size(keys))
         spec%value(i) = random_value(random, keys(i))
         choice = random%uniform(0.0_wp, 1.0_wp)
         if (i < size(keys) .and. choice > 0.5_wp) spec%value(i + 1) = random_value(random, keys(i + 1))
         if (.not. is_valid(spec)) spec%value = before
      end do
   end subroutine random_spring

   pure logical function is_required(key)
      type(key_type), intent(in) :: key

      is_required = .not. (is_given(key%default) .or. key%optional)
   end function is_required

   logical function is_valid(spec)
      type(spring_record), intent(in) :: spec
      type(message_list) :: messages

      call spec%validate('spring', messages)
      is_valid = messages%count == 0
   end function is_valid

   !> A value within the bounds of a parameter; forces, deformations and stiffnesses are around 1.
   real(wp) function random_value(random, key) result(x)
      type(random_type), intent(inout) :: random
      type(key_type), intent(in) :: key
      real(wp) :: choice, exponent
      integer :: choices

      choice = random%uniform(0.0_wp, 1.0_wp)
      associate (low => key%bound%least, high => key%bound%most)
         if (key%kind == word_kind) then
            choices = 1
            do while (choice_name(key, choices + 1) /= '')
               choices = choices + 1
            end do
            x = 1.0_wp + int(choice*0.999999_wp*choices)
         else if (low < 0.0_wp) then
            x = random%uniform(-3.0_wp, 3.0_wp)
         else if (high < huge(1.0_wp)) then
            x = random%uniform(low, high)
            if (choice < 0.2_wp .and. .not. key%bound%least_open) x = low
         else if (choice < 0.2_wp .and. .not. key%bound%least_open) then
            x = low
         else
            exponent = random%uniform(-1.0_wp, 1.5_wp)
            if (key%unit == deformation .or. key%unit == force) exponent = random%uniform(-1.0_wp, 1.0_wp)
            if (key%unit == stiffness) exponent = random%uniform(-2.0_wp, 1.0_wp)
            ! Stiffness ratios of up to 1e8
            if (key%unit == stiffness .and. choice > 0.9_wp) exponent = random%uniform(-8.0_wp, -2.0_wp)
            x = low + 10.0_wp**exponent
         end if
      end associate
   end function random_value

   !> A joint of layers: strips of one spring, rows of another; without axial load, under a random one, at
   !> 0.99 of what it carries, or in tension.
   recursive subroutine random_layers(random, spec)
      type(random_type), intent(inout) :: random
      type(spring_record), intent(inout) :: spec
      type(spring_record), allocatable :: layer(:)
      type(spring_record) :: two(2)
      real(wp), allocatable :: y(:)
      integer, parameter :: counts(8) = [2, 3, 4, 6, 10, 16, 30, 1000]
      real(wp) :: capacity, choice
      integer :: i, n

      i = 1 + int(random%uniform(0.0_wp, 7.2_wp))
      n = counts(i)
      do i = 1, 2
         call random_layer(random, two(i))
      end do
      allocate (y(n), layer(n))
      do i = 1, n
         y(i) = (i - 0.5_wp)/n - 0.5_wp
         choice = random%uniform(0.0_wp, 1.0_wp)
         layer(i) = two(merge(2, 1, choice > 0.7_wp))
      end do
      call spec%set_layers(y, layer)
      choice = random%uniform(0.0_wp, 1.0_wp)
      if (choice < 0.25_wp) return
      call find_capacity(spec, merge(-1.0_wp, 1.0_wp, choice < 0.4_wp), capacity)
      spec%axial_load = capacity*merge(0.99_wp, random%uniform(0.0_wp, 0.7_wp), choice > 0.85_wp)
   end subroutine random_layers

   recursive subroutine random_layer(random, spec)
      type(random_type), intent(inout) :: random
      type(spring_record), intent(out) :: spec
      integer :: i

      do
         i = 1 + int(random%uniform(0.0_wp, 0.999999_wp)*size(rule_names))
         if (suits(rule_names(i), in_layer)) exit
      end do
      call random_spring(random, trim(rule_names(i)), spec)
   end subroutine random_layer

   !> The largest axial load of a sign that the layers carry, not more than their forces at a large
   !> deformation.
   subroutine find_capacity(spec, way, capacity)
      type(spring_record), intent(in) :: spec
      real(wp), intent(in) :: way
      real(wp), intent(out) :: capacity
      class(rule_type), allocatable :: rule
      real(wp) :: high, low, middle
      integer :: i

      call spec%make(rule)
      low = 0.0_wp
      high = 10.0_wp*size(spec%y)
      do i = 1, 40
         middle = 0.5_wp*(low + high)
         if (carries_axial_load(rule, way*middle)) then
            low = middle
         else
            high = middle
         end if
      end do
      capacity = way*low
   end subroutine find_capacity

   !> First deformation at which the line of the virgin spring ends; 1 if it never does.
   real(wp) function yield_of(spec) result(d)
      type(spring_record), intent(in) :: spec
      class(rule_type), allocatable :: rule
      class(rule_memory), allocatable :: memory
      type(segment) :: line

      call spec%make(rule)
      call rule%start(0.0_wp, memory, line)
      d = unbounded
      if (line%hi > 0.0_wp) d = min(d, line%hi)
      if (line%lo < 0.0_wp) d = min(d, -line%lo)
      if (d >= 1.0e50_wp) d = 1.0_wp
   end function yield_of

   !> A path of turns, with a point in the middle of each leg and some returns to an earlier turn.
   subroutine random_path(random, yield, d)
      type(random_type), intent(inout) :: random
      real(wp), intent(in) :: yield
      real(wp), intent(out) :: d(:)
      real(wp) :: exponent, from, choice
      integer :: j

      do j = 2, size(d), 2
         exponent = random%uniform(-0.5_wp, 1.5_wp)
         d(j) = yield*random%uniform(-1.0_wp, 1.0_wp)*10.0_wp**exponent
         choice = random%uniform(0.0_wp, 1.0_wp)
         if (choice > 0.8_wp) d(j) = d(max(j - 4, 2))
         from = 0.0_wp
         if (j > 2) from = d(max(j - 2, 1))
         d(j - 1) = from + random%uniform(0.0_wp, 1.0_wp)*(d(j) - from)
      end do
   end subroutine random_path

   !> Put some points in the middle of a leg where a line ends, as a detour there may matter most.
   subroutine meet_ends(random, virgin, d)
      type(random_type), intent(inout) :: random
      type(spring_array), intent(in) :: virgin
      real(wp), intent(inout) :: d(:)
      type(spring_array) :: spring
      real(wp) :: far, choice
      integer :: j, s

      spring = virgin
      do j = 2, size(d), 2
         s = merge(1, -1, d(j) > spring%d(1))
         call spring%advance_to(1, d(j - 1))
         far = spring%end_toward(1, s)
         choice = random%uniform(0.0_wp, 1.0_wp)
         if (s*(d(j) - far) > 0.0_wp .and. choice > 0.5_wp) then
            d(j - 1) = far
            ! Turn there
            if (choice > 0.8_wp) d(j) = far
         end if
         call spring%advance_to(1, d(j - 1))
         call spring%advance_to(1, d(j))
      end do
   end subroutine meet_ends

   !> The stiffness against which changes are measured: that of the virgin spring, or that of the steepest
   !> softening line on a path.
   real(wp) function steepest(spec, virgin, d) result(k)
      type(spring_record), intent(in) :: spec
      type(spring_array), intent(in) :: virgin
      real(wp), intent(in) :: d(:)
      type(spring_array) :: spring
      integer :: j, s

      k = spec%initial_stiffness()
      spring = virgin
      do j = 1, size(d)
         do
            s = merge(1, -1, d(j) > spring%d(1))
            k = max(k, -spring%k(1))
            if (s*(d(j) - spring%end_toward(1, s)) <= 0.0_wp) exit
            call spring%advance_on_branch(1, spring%end_toward(1, s))
            call spring%leave(1, s)
         end do
         call spring%advance_to(1, d(j))
      end do
   end function steepest

   !> Largest change of a later force by a detour anywhere.
   subroutine detours(rule, histories, found)
      character(len=*), intent(in) :: rule
      integer, intent(in) :: histories
      type(detour_result), intent(out) :: found
      type(random_type) :: random
      type(spring_record) :: spec
      type(spring_array) :: virgin, spring, detour
      real(wp) :: d(28), f(28), e, k, yield, change, length, worst
      integer :: history, i, j, at, turns, above(size(sizes))

      above = 0
      worst = 0.0_wp
      do history = 1, histories
         if (mod(history - 1, histories_each) == 0) then
            call random_spring(random, rule, spec)
            call make_springs(virgin, [spec])
            yield = yield_of(spec)
         end if
         turns = int(random%uniform(3.0_wp, 15.0_wp))
         call random_path(random, yield, d(:2*turns))
         call meet_ends(random, virgin, d(:2*turns))
         at = int(random%uniform(1.0_wp, 2.0_wp*turns))
         k = steepest(spec, virgin, d(:2*turns))
         spring = virgin
         do j = 1, 2*turns
            call spring%advance_to(1, d(j))
            f(j) = spring%force(1)
            if (j == at) detour = spring
         end do
         do i = 1, size(sizes)
            e = sizes(i)*yield
            length = sign(e, random%uniform(-1.0_wp, 1.0_wp))
            spring = detour
            call spring%advance_to(1, d(at) + length)
            change = 0.0_wp
            do j = at, 2*turns
               call spring%advance_to(1, d(j))
               change = max(change, abs(spring%force(1) - f(j)) - 1.0e-13_wp*k*maxval(abs(d(:2*turns))))
            end do
            change = change/(k*e)
            if (change > 10.0_wp) above(i) = above(i) + 1
            found%largest(i) = max(found%largest(i), change)
            if (change > worst) then
               worst = change
               found%spec = spec
               found%d = d(:2*turns)
               found%at = at
               found%length = length
            end if
         end do
      end do
      found%share = real(above, wp)/histories
   end subroutine detours

   !> Least work from the virgin state, and of loops that close in deformation and force.
   subroutine loops(rule, histories, found)
      character(len=*), intent(in) :: rule
      integer, intent(in) :: histories
      type(loop_result), intent(out) :: found
      type(random_type) :: random
      type(spring_record) :: spec
      type(spring_array) :: virgin, spring
      real(wp) :: d(20), loop(4), before(2), k, yield, unit, work
      integer :: history, j

      do history = 1, histories
         if (mod(history - 1, histories_each) == 0) then
            call random_spring(random, rule, spec)
            ! An axial load does work too, which is not that of the spring.
            spec%axial_load = 0.0_wp
            call make_springs(virgin, [spec])
            k = spec%initial_stiffness()
            yield = yield_of(spec)
         end if
         spring = virgin
         call random_path(random, yield, d)
         unit = k*maxval(abs(d))**2
         do j = 1, size(d)
            call spring%advance_to(1, d(j))
            if (spring%work(1)/unit < min(found%virgin, found%closed)) call keep()
            found%virgin = min(found%virgin, spring%work(1)/unit)
         end do
         loop = random%uniform_array(-1.0_wp, 1.0_wp, 4)*maxval(abs(d))
         do j = 1, 16
            if (mod(j - 1, 4) == 0 .and. j > 1) then
               if (j > 5 .and. abs(spring%force(1) - before(1)) <= 1.0e-9_wp*k*yield) then
                  found%loops = found%loops + 1
                  work = (spring%work(1) - before(2))/unit
                  if (work < min(found%virgin, found%closed)) call keep()
                  found%closed = min(found%closed, work)
               end if
               before = [spring%force(1), spring%work(1)]
            end if
            call spring%advance_to(1, loop(modulo(j - 1, 4) + 1))
         end do
      end do

   contains

      subroutine keep()
         found%spec = spec
         found%d = [d, loop]
      end subroutine keep
   end subroutine loops

end module any_rule
