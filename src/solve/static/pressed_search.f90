!> Points of a path under an axial load that varies: where it reaches a share of its way, where the first
!> spring or layer reaches the end of its line, and where one turns back. All are found by Newton's method
!> from total equilibrium, so that increments do not matter.
module rbs_solve_static_pressed_search
   use rbs_base_constants, only: unbounded
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_springs, only: spring_array
   use rbs_solve_static_pressed_balance, only: pressed_balance, pressed_point
   implicit none
   private

   public :: find_end, find_point, find_turn, hides_event, no_way

   !> A share of the way this small is round-off.
   real(wp), parameter :: no_way = 1.0e-13_wp
   !> Most corrections of one point
   integer, parameter :: most_corrections = 40
   !> Most halvings of the way to the point where a layer turns back
   integer, parameter :: most_halvings = 50
   !> A motion that goes back by less than this share of its rates has not turned, and one that is beyond an
   !> end by less than the second share of its deformation is not beyond it.
   real(wp), parameter :: no_turn = 1.0e-7_wp, no_overshoot = 1.0e-9_wp
   !> Deformations [rad, m] below this are those of a column that stands straight, but for round-off.
   real(wp), parameter :: straight_column = 1.0e-12_wp

contains

   !> The first event between two shares of the way, or the point at the second.
   subroutine find_end(balance, springs, point, from, to, spring, layer, found)
      class(pressed_balance), intent(inout) :: balance
      type(spring_array), intent(in) :: springs
      type(pressed_point), intent(inout) :: point
      real(wp), intent(in) :: from, to
      !> The spring that ends the line, and its layer; 0 for none
      integer, intent(out) :: spring, layer
      logical, intent(out) :: found
      real(wp) :: correction(size(point%q)), force_correction, step, room
      integer :: trial, i, first, n

      n = balance%column%n
      do trial = 1, most_corrections
         call balance%solve_point(springs, point, correction, force_correction, found)
         if (.not. found) return
         point%q = point%q + correction
         point%force = point%force + force_correction
         call balance%find_press(point)
         step = to - point%share
         spring = 0
         layer = 0
         do i = 1, size(point%q)
            first = 0
            if (any(springs%layered == i)) then
               call springs%way_on_plane(i, point%q(i), point%press(i - n), point%rate(i), &
                                         point%press_rate(i - n), room, first)
            else
               room = room_ahead(springs, i, point%q(i), point%rate(i))
            end if
            if (room >= step) cycle
            step = room
            spring = i
            layer = first
         end do
         step = max(step, from - point%share)
         point%q = point%q + point%rate*step
         point%force = point%force + point%force_rate*step
         point%share = point%share + step
         call balance%find_press(point)
         if (trial == 1) cycle
         if (balance%straight) return
         if (abs(step) <= no_way .and. is_small(correction, point)) return
      end do
      found = abs(step) <= 1.0e-9_wp .and. is_small(1.0e-4_wp*correction, point)
   end subroutine find_end

   !> The point at a share of the way on the present lines.
   subroutine find_point(balance, springs, point, share, found)
      class(pressed_balance), intent(inout) :: balance
      type(spring_array), intent(in) :: springs
      type(pressed_point), intent(inout) :: point
      real(wp), intent(in) :: share
      logical, intent(out) :: found
      real(wp) :: correction(size(point%q)), force_correction, step
      integer :: trial

      step = share - point%share
      point%q = point%q + point%rate*step
      point%force = point%force + point%force_rate*step
      point%share = share
      do trial = 1, 6
         call balance%solve_point(springs, point, correction, force_correction, found)
         if (.not. found) return
         point%q = point%q + correction
         point%force = point%force + force_correction
         if (is_small(correction, point)) exit
      end do
      call balance%find_press(point)
   end subroutine find_point

   !> If a layer or spring on a one-way line turns back on the way to a point, that point becomes the one
   !> where it does.
   subroutine find_turn(balance, springs, here, there, turned, found)
      class(pressed_balance), intent(inout) :: balance
      type(spring_array), intent(in) :: springs
      type(pressed_point), intent(in) :: here
      type(pressed_point), intent(inout) :: there
      logical, intent(out) :: turned, found
      type(pressed_point) :: beyond
      real(wp) :: near, far
      integer :: halving

      found = .true.
      turned = turns_back(balance, springs, there%rate, there%press_rate)
      if (.not. turned) return
      near = here%share
      far = there%share
      do halving = 1, most_halvings
         beyond = here
         call find_point(balance, springs, beyond, 0.5_wp*(near + far), found)
         if (.not. found) return
         if (turns_back(balance, springs, beyond%rate, beyond%press_rate)) then
            there = beyond
            far = beyond%share
         else
            near = beyond%share
         end if
         if (far - near <= no_way) exit
      end do
   end subroutine find_turn

   !> Whether a cubic through two points of a curve shows, half way, a spring or layer that is beyond its end
   !> or goes back on a one-way line, although neither point does.
   pure logical function hides_event(balance, springs, here, there) result(hides)
      class(pressed_balance), intent(in) :: balance
      type(spring_array), intent(in) :: springs
      type(pressed_point), intent(in) :: here, there
      real(wp), dimension(size(here%q)) :: q, rate
      real(wp), dimension(size(here%press)) :: press, press_rate
      real(wp) :: length, room
      integer :: i, j, first

      length = there%share - here%share
      q = 0.5_wp*(here%q + there%q) + 0.125_wp*length*(here%rate - there%rate)
      rate = 1.5_wp*(there%q - here%q)/length - 0.25_wp*(here%rate + there%rate)
      press = 0.5_wp*(here%press + there%press) + 0.125_wp*length*(here%press_rate - there%press_rate)
      press_rate = 1.5_wp*(there%press - here%press)/length - 0.25_wp*(here%press_rate + there%press_rate)
      hides = .false.
      do i = 1, size(q)
         if (any(springs%layered == i)) then
            j = i - balance%column%n
            call springs%way_on_plane(i, q(i), press(j), rate(i), press_rate(j), room, first)
            hides = room < -no_overshoot .or. springs%turns_on_plane(i, rate(i), press_rate(j))
         else
            associate (least => no_overshoot*(abs(q(i)) + abs(there%q(i) - here%q(i))))
               hides = q(i) > springs%last(i) + least .and. springs%one_way(i) >= 0 .or. &
                       q(i) < springs%first(i) - least .and. springs%one_way(i) <= 0 .or. &
                       springs%one_way(i)*rate(i) < -no_turn*(abs(here%rate(i)) + abs(there%rate(i)))
            end associate
         end if
         if (hides) return
      end do
   end function hides_event

   !> Whether a correction is such that the next one would be round-off: Newton's method squares it. The way
   !> counts as well as the point, and both may be round-off of the straight column.
   pure logical function is_small(correction, point)
      real(wp), intent(in) :: correction(:)
      type(pressed_point), intent(in) :: point

      is_small = maxval(abs(correction)) <= 1.0e-11_wp*max(maxval(abs(point%q)), straight_column, &
                                                           1.0e-4_wp*maxval(abs(point%rate)))
   end function is_small

   !> How far a spring can go on its line, in shares of the way.
   pure real(wp) function room_ahead(springs, i, q, rate) result(room)
      type(spring_array), intent(in) :: springs
      integer, intent(in) :: i
      real(wp), intent(in) :: q, rate
      real(wp) :: way
      integer :: side

      room = unbounded
      if (.not. abs(rate) > 0.0_wp) return
      side = merge(1, -1, rate > 0.0_wp)
      if (springs%one_way(i) == -side) return
      way = side*(springs%end_toward(i, side) - q)
      if (way < 1.0e100_wp*abs(rate)) room = way/abs(rate)
   end function room_ahead

   !> Whether a layer on a one-way line, or a spring on one, goes back with given rates.
   pure logical function turns_back(balance, springs, rate, press_rate)
      class(pressed_balance), intent(in) :: balance
      type(spring_array), intent(in) :: springs
      !> Of the deformations, and of the axial loads of the joints
      real(wp), intent(in) :: rate(:), press_rate(:)
      integer :: i

      turns_back = .false.
      do i = 1, size(rate)
         if (any(springs%layered == i)) then
            turns_back = springs%turns_on_plane(i, rate(i), press_rate(i - balance%column%n))
         else
            turns_back = springs%one_way(i)*rate(i) < 0.0_wp
         end if
         if (turns_back) return
      end do
   end function turns_back

end module rbs_solve_static_pressed_search
