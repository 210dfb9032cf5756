!> The curve of a column between two points of its path: values and rates at both ends, a cubic between.
module rbs_solve_static_curve
   use rbs_base_kinds, only: wp
   use rbs_column_column, only: column_type
   use rbs_column_top, only: largest_turn
   use rbs_hysteresis_springs, only: spring_array
   use rbs_solve_static_finite_equilibrium, only: path_point
   use rbs_solve_static_path, only: on_the_end
   implicit none
   private

   public :: curve_type, clean, first_ahead, most_turn, most_bend, same_rate

   !> Largest rotation in one stride [rad], how far it may be from its tangent as a share of it, and what
   !> the slopes may correct of its work as a share of the largest energy so far.
   real(wp), parameter :: most_turn = 0.05_wp, most_bend = 0.1_wp, most_correction = 1.0e-5_wp

   !> Bends this small are round-off [rad].
   real(wp), parameter :: round_off = 1.0e-13_wp

   !> A rate below this share of that of the top is round-off, and a difference of rates below this share of
   !> their own size is zero.
   real(wp), parameter :: noise = 1.0e-13_wp, same_rate = 1.0e-8_wp

   !> A spring that goes back less than this share of its deformation has not turned.
   real(wp), parameter :: no_way = 1.0e-10_wp

   type :: curve_type
      !> Change of what is driven from end to end, in size
      real(wp) :: length = 0.0_wp
      !> Its ends
      type(path_point), private :: near, far
      !> Rates that still count for slips and openings, and for rotations
      real(wp), private :: least(2) = 0.0_wp
      integer, private :: n = 0
   contains
      procedure :: set
      procedure :: is_gentle
      procedure :: work
      procedure :: least_rate
      procedure :: first_end
      procedure :: hides_turn
      procedure :: guess
      procedure, private :: largest_rate
   end type curve_type

contains

   subroutine set(self, column, length, near, far)
      class(curve_type), intent(inout) :: self
      type(column_type), intent(in) :: column
      real(wp), intent(in) :: length
      type(path_point), intent(in) :: near, far

      self%n = column%n
      self%length = length
      self%near = near
      self%far = far
      ! Well above what `clean` takes for round-off, so that a motion found to have turned counts as turned.
      self%least(1) = 30.0_wp*noise*max(abs(near%displacement_rate), abs(far%displacement_rate))
      self%least(2) = self%least(1)/column%joint_height(column%n + 1)
   end subroutine set

   !> Set rates that are round-off to zero.
   pure function clean(column, point) result(rate)
      type(column_type), intent(in) :: column
      type(path_point), intent(in) :: point
      real(wp) :: rate(column%unknowns)
      real(wp) :: least
      integer :: i

      do i = 1, column%unknowns
         least = noise*abs(point%displacement_rate)
         if ((i - 1)/column%n == 1) least = least/column%joint_height(column%n + 1)
         rate(i) = merge(point%rate(i), 0.0_wp, abs(point%rate(i)) > least)
      end do
   end function clean

   !> Whether the stride has been small enough for its tangents to tell what lies between.
   pure logical function is_gentle(self, column, springs, most_work)
      class(curve_type), intent(in) :: self
      type(column_type), intent(in) :: column
      type(spring_array), intent(in) :: springs
      !> Largest work of the lateral force so far, in size [J]
      real(wp), intent(in) :: most_work
      real(wp) :: change(size(self%near%q)), turn, step, turnover, work(2)

      associate (n => column%n, height => column%joint_height(column%n + 1))
         change = self%far%q - self%near%q
         turn = largest_turn(column, change)
         turnover = sum(abs(change*(springs%f0 + springs%k*(self%far%q - springs%d0))))
         step = max(turn, maxval(abs(change(:n)))/height)
         change = change - self%length*self%near%rate
         is_gentle = turn <= 2.0_wp*most_turn .and. &
                     max(largest_turn(column, change), maxval(abs(change(:n)))/height) &
                     <= most_bend*step + round_off
      end associate
      work = self%work()
      is_gentle = is_gentle .and. abs(work(2)) <= most_correction*max(most_work, turnover)
   end function is_gentle

   !> Work of the lateral force: trapezoidal rule, and its correction by the slopes at both ends [J]. The
   !> correction is exact for a cubic F(x), or for a cubic x(F): of two, the smaller is that of the
   !> straighter curve.
   pure function work(self)
      class(curve_type), intent(in) :: self
      real(wp) :: work(2)
      real(wp) :: bend(2)

      associate (here => self%near, there => self%far)
         associate (force => there%force - here%force, way => there%displacement - here%displacement)
            bend = way**2*difference(here%force_rate, here%displacement_rate, &
                                     there%force_rate, there%displacement_rate)
            if (here%force_rate*there%force_rate*here%displacement_rate*there%displacement_rate &
                > 0.0_wp) then
               bend(2) = -force**2*difference(here%displacement_rate, here%force_rate, &
                                              there%displacement_rate, there%force_rate)
            end if
            work = [0.5_wp*(there%force + here%force)*way, bend(minloc(abs(bend), dim=1))/12.0_wp]
         end associate
      end associate
   end function work

   !> a/b - c/d; a quotient whose divisor is zero counts as zero.
   elemental real(wp) function difference(a, b, c, d)
      real(wp), intent(in) :: a, b, c, d

      difference = 0.0_wp
      if (abs(b) > 0.0_wp .and. abs(d) > 0.0_wp) difference = a/b - c/d
   end function difference

   !> The least forward rate of the springs on one-way lines, in shares of their largest, and `same_rate`
   !> more: below zero a motion has clearly turned back. The error of the spring until then is the
   !> square of that.
   pure real(wp) function least_rate(self, springs, rate) result(least)
      class(curve_type), intent(in) :: self
      type(spring_array), intent(in) :: springs
      real(wp), intent(in) :: rate(:)
      real(wp) :: largest
      integer :: i

      least = 1.0_wp
      do i = 1, springs%count
         if (springs%one_way(i) == 0) cycle
         largest = self%largest_rate(i)
         if (largest > 0.0_wp) least = min(least, springs%one_way(i)*rate(i)/largest + same_rate)
      end do
   end function least_rate

   !> Deformation of spring i at a share of the way.
   pure real(wp) function at_share(self, i, share) result(d)
      type(curve_type), intent(in) :: self
      integer, intent(in) :: i
      real(wp), intent(in) :: share

      d = cubic(share, self%near%q(i), self%far%q(i), self%length*self%near%rate(i), &
                self%length*self%far%rate(i))
   end function at_share

   !> Hermite's cubic; its change is reckoned from the near end.
   elemental real(wp) function cubic(share, a, b, slope_a, slope_b)
      real(wp), intent(in) :: share, a, b, slope_a, slope_b

      associate (t => share, rest => 1.0_wp - share)
         cubic = a + t*(slope_a*rest**2 + t*((b - a)*(3.0_wp - 2.0_wp*t) - slope_b*rest))
      end associate
   end function cubic

   !> The first spring that would reach an end of its line along the tangent, before a length of what is
   !> driven.
   pure subroutine first_ahead(springs, here, length, spring, way, share)
      type(spring_array), intent(in) :: springs
      type(path_point), intent(in) :: here
      real(wp), intent(in) :: length
      !> The spring, 0 if there is none; the end, +1 or -1; and where, as a share of the length
      integer, intent(out) :: spring, way
      real(wp), intent(out) :: share
      real(wp) :: room
      integer :: i, side

      spring = 0
      way = 0
      share = 1.0_wp
      do i = 1, springs%count
         associate (rise => length*here%rate(i))
            if (.not. abs(rise) > 0.0_wp) cycle
            side = merge(1, -1, rise > 0.0_wp)
            room = side*(springs%end_toward(i, side) - here%q(i))
            if (room < share*abs(rise)) then
               spring = i
               way = side
               share = max(room, 0.0_wp)/abs(rise)
            end if
         end associate
      end do
   end subroutine first_ahead

   !> Of the springs that are beyond an end of their line, the one that passed it first.
   subroutine first_end(self, springs, q, whole, spring, way, share)
      class(curve_type), intent(in) :: self
      type(spring_array), intent(in) :: springs
      !> Deformations of the point that is looked at
      real(wp), intent(in) :: q(:)
      !> Whether this is the far end: then springs count too that went beyond and have come back
      logical, intent(in) :: whole
      !> The spring, 0 if there is none; the end, +1 or -1; and where, as a share of the way
      integer, intent(out) :: spring, way
      real(wp), intent(out) :: share
      real(wp) :: passed, beyond, reach
      integer :: i, side

      spring = 0
      way = 0
      share = huge(1.0_wp)
      do i = 1, springs%count
         do side = -1, 1, 2
            if (springs%one_way(i) == -side) cycle
            associate (finish => springs%end_toward(i, side))
               ! No cubic reaches farther; an end at infinity is never reached.
               reach = max(side*self%near%q(i), side*self%far%q(i)) &
                       + 0.25_wp*self%length*(abs(self%near%rate(i)) + abs(self%far%rate(i)))
               if (side*finish > reach .or. .not. abs(finish) < huge(1.0_wp)) cycle
               beyond = 1.0_wp
               if (.not. side*(q(i) - finish) > on_the_end*abs(finish)) then
                  if (.not. whole) cycle
                  beyond = farthest(self, i, side)
                  if (.not. beyond > 0.0_wp) cycle
                  if (.not. side*(at_share(self, i, beyond) - finish) > on_the_end*abs(finish)) cycle
               end if
               ! Where another spring has passed, this one has not yet: it comes later.
               if (share < beyond) then
                  if (.not. side*(at_share(self, i, share) - finish) > 0.0_wp) cycle
                  beyond = share
               end if
               passed = where_passed(self, i, side, finish, beyond)
            end associate
            if (passed < share) then
               spring = i
               way = side
               share = passed
            end if
         end do
      end do
   end subroutine first_end

   !> Whether a spring on a one-way line turns back and turns again between the ends. What it goes back
   !> between the roots of the derivative a t^2 + b t + c is (b^2 - 4 a c)^(3/2)/(6 a^2).
   pure logical function hides_turn(self, springs)
      class(curve_type), intent(in) :: self
      type(spring_array), intent(in) :: springs
      real(wp) :: slope(3), back
      integer :: i

      hides_turn = .false.
      do i = 1, springs%count
         if (springs%one_way(i) == 0) cycle
         slope = springs%one_way(i)*slopes(self, i)
         ! The least derivative lies between the ends.
         if (.not. slope(1) > sqrt(tiny(1.0_wp))) cycle
         if (slope(2) >= 0.0_wp .or. -slope(2) >= 2.0_wp*slope(1)) cycle
         back = max(slope(2)**2 - 4.0_wp*slope(1)*slope(3), 0.0_wp)
         back = back*sqrt(back)/(6.0_wp*slope(1)**2)
         hides_turn = back > no_way*max(abs(self%near%q(i)), abs(self%far%q(i)))
         if (hides_turn) return
      end do
   end function hides_turn

   !> Derivative of a deformation by the share t of the way, as a t^2 + b t + c.
   pure function slopes(self, i)
      type(curve_type), intent(in) :: self
      integer, intent(in) :: i
      real(wp) :: slopes(3)
      real(wp) :: rise, first, last

      rise = self%far%q(i) - self%near%q(i)
      first = self%length*self%near%rate(i)
      last = self%length*self%far%rate(i)
      slopes = [3.0_wp*(first + last) - 6.0_wp*rise, 6.0_wp*rise - 4.0_wp*first - 2.0_wp*last, first]
   end function slopes

   !> Where on the way a spring turns back from one side, 0 if it does not.
   pure real(wp) function farthest(self, i, side) result(share)
      type(curve_type), intent(in) :: self
      integer, intent(in) :: i, side
      real(wp) :: slope(3), root

      share = 0.0_wp
      slope = side*slopes(self, i)
      root = slope(2)**2 - 4.0_wp*slope(1)*slope(3)
      if (.not. root > 0.0_wp) return
      root = sqrt(root)
      ! The root where the derivative falls, in the form that does not cancel, if it is between the ends.
      if (slope(2) < 0.0_wp) then
         if (slope(3) > 0.0_wp .and. 2.0_wp*slope(3) <= root - slope(2)) then
            share = 2.0_wp*slope(3)/(root - slope(2))
         end if
      else if (slope(2) + root <= -2.0_wp*slope(1)) then
         share = (slope(2) + root)/(-2.0_wp*slope(1))
      end if
   end function farthest

   !> Where a spring passes its end, between 0 and a share where it is beyond.
   pure real(wp) function where_passed(self, i, side, finish, beyond) result(share)
      type(curve_type), intent(in) :: self
      integer, intent(in) :: i, side
      real(wp), intent(in) :: finish, beyond
      real(wp) :: before, after
      integer :: halving

      before = 0.0_wp
      after = beyond
      do halving = 1, 30
         share = 0.5_wp*(before + after)
         if (side*(at_share(self, i, share) - finish) > 0.0_wp) then
            after = share
         else
            before = share
         end if
      end do
      share = 0.5_wp*(before + after)
   end function where_passed

   !> The curve at a share of the way, as a guess of a point.
   pure subroutine guess(self, share, point)
      class(curve_type), intent(in) :: self
      real(wp), intent(in) :: share
      type(path_point), intent(inout) :: point

      point%q = cubic(share, self%near%q, self%far%q, self%length*self%near%rate, &
                      self%length*self%far%rate)
      point%force = self%near%force + share*(self%far%force - self%near%force)
   end subroutine guess

   !> Size of the rate of a spring; never so small that `same_rate` of it is round-off.
   pure real(wp) function largest_rate(self, i)
      class(curve_type), intent(in) :: self
      integer, intent(in) :: i
      real(wp) :: least

      least = self%least(1)
      if ((i - 1)/self%n == 1) least = self%least(2)
      largest_rate = max(abs(self%near%rate(i)), abs(self%far%rate(i)), least/same_rate)
   end function largest_rate

end module rbs_solve_static_curve
