!> Points ahead on a static path with exact rotations: where the first spring reaches the end of its line,
!> where a motion turns back, or the end of a stride. Each is a point of the curve of equilibrium, found by
!> Newton's method.
module rbs_solve_static_finite_search
   use rbs_base_kinds, only: wp
   use rbs_column_top, only: largest_turn
   use rbs_solve_static_curve, only: curve_type, same_rate
   use rbs_solve_static_finite_equilibrium, only: finite_equilibrium, path_point
   use rbs_solve_static_path, only: static_path
   implicit none
   private

   public :: turning_search

   !> A way below this share of the largest value is straight to the last digit, and too short for Newton's
   !> method, whose points are off by round-off.
   real(wp), parameter :: close_by = 1.0e-9_wp

   type, abstract, extends(static_path) :: turning_search
      type(finite_equilibrium) :: equilibrium
      !> The present point and the one that is tried
      type(path_point) :: here, there
      !> The curve between the present point and the farthest tried
      type(curve_type) :: curve
      !> Largest value so far, as what is driven [m or N]
      real(wp) :: extent = 0.0_wp
   contains
      procedure :: is_straight
      procedure :: go_straight
      procedure :: aim
      procedure :: meet_end
      procedure :: meet_turn
      procedure :: on_their_lines
   end type turning_search

contains

   !> Whether the path is straight up to a point ahead. A part of a way that was too long does not count:
   !> before a limit point the path bends within any distance.
   pure logical function is_straight(self, way, whole)
      class(turning_search), intent(in) :: self
      !> Change of what is driven up to there, and whether an end of a line or the target is there
      real(wp), intent(in) :: way
      logical, intent(in) :: whole

      is_straight = whole .and. way <= close_by*self%extent
      if (is_straight) is_straight = way*largest_turn(self%column, self%here%rate) <= close_by
   end function is_straight

   !> A point so near that the path is straight up to it: an end of a spring's line, or the goal.
   subroutine go_straight(self, goal, length, spring, way, share, reached)
      class(turning_search), intent(inout) :: self
      real(wp), intent(in) :: goal, length
      !> The spring that stands on its end there, 0 if none, and which end
      integer, intent(in) :: spring, way
      !> Share of the length up to there
      real(wp), intent(in) :: share
      !> What is driven there
      real(wp), intent(out) :: reached

      reached = goal
      if (spring > 0) reached = self%control + share*(goal - self%control)
      self%there = self%here
      associate (here => self%here, there => self%there)
         there%q = here%q + here%rate*(share*length)
         if (spring > 0) there%q(spring) = self%springs%end_toward(spring, way)
         there%force = here%force + here%force_rate*(reached - self%control)
         there%displacement = here%displacement + here%displacement_rate*(reached - self%control)
         call self%curve%set(self%column, abs(reached - self%control), here, there)
      end associate
   end subroutine go_straight

   !> Find a point ahead: where the tangent says that the first spring reaches its end, if this is before
   !> the goal, else the goal.
   subroutine aim(self, goal, length, share, reached, spring, way, done)
      class(turning_search), intent(inout) :: self
      !> Share of the length after which the first spring reaches its end by the tangent
      real(wp), intent(in) :: goal, length, share
      !> What is driven there
      real(wp), intent(out) :: reached
      !> The spring that stands on its end there, 0 if none, and which end; on entry by the tangent
      integer, intent(inout) :: spring, way
      logical, intent(out) :: done

      associate (here => self%here, there => self%there)
         if (spring > 0) then
            there%q = here%q + here%rate*(share*length)
            there%force = here%force + here%force_rate*(share*(goal - self%control))
            call self%equilibrium%find_point(self%springs, there, spring, &
                                             self%springs%end_toward(spring, way), done)
            reached = merge(there%force, there%displacement, self%by_force)
            associate (way_there => self%direction*(reached - self%control))
               if (done .and. way_there >= 0.0_wp .and. way_there <= length) return
            end associate
         end if
         spring = 0
         reached = goal
         there%q = here%q + here%rate*length
         there%force = here%force + here%force_rate*(goal - self%control)
         call self%equilibrium%find_point(self%springs, there, 0, goal, done)
      end associate
   end subroutine aim

   !> Find the point where the first spring reaches its end; `there` becomes that point.
   subroutine meet_end(self, spring, way, share, reached, done)
      class(turning_search), intent(inout) :: self
      !> On entry a guess which is the first, which end, and where on the curve
      integer, intent(inout) :: spring, way
      real(wp), intent(inout) :: share
      !> What is driven there
      real(wp), intent(inout) :: reached
      logical, intent(out) :: done
      real(wp) :: change, limit
      integer :: tries, next, next_way

      done = .false.
      limit = reached
      do tries = 1, 30
         call self%curve%guess(share, self%there)
         call self%equilibrium%find_point(self%springs, self%there, spring, &
                                          self%springs%end_toward(spring, way), done)
         if (.not. done) return
         reached = merge(self%there%force, self%there%displacement, self%by_force)
         change = self%direction*(reached - self%control)
         ! The event must lie between here and the goal; round-off may put it a little beside.
         done = change >= -1.0e-9_wp*abs(limit - self%control) .and. &
                self%direction*(limit - reached) >= -1.0e-9_wp*abs(limit - self%control)
         if (.not. done) return
         call self%curve%first_end(self%springs, self%there%q, .false., next, next_way, share)
         if (next == 0) exit
         spring = next
         way = next_way
      end do
      done = next == 0
      if (done) call self%equilibrium%find_rates(self%springs, self%there, self%direction, done)
   end subroutine meet_end

   !> Find the point where the first motion turns back, by the method of false position (Illinois).
   subroutine meet_turn(self, reached, done)
      class(turning_search), intent(inout) :: self
      real(wp), intent(inout) :: reached
      logical, intent(out) :: done
      real(wp) :: near, far, at_near, at_far, value
      integer :: i, side

      near = self%control
      far = reached
      at_near = self%curve%least_rate(self%springs, self%here%rate)
      at_far = self%curve%least_rate(self%springs, self%there%rate)
      side = 0
      done = at_near > 0.0_wp .and. at_far < 0.0_wp
      if (.not. done) return
      do i = 1, 60
         reached = far - at_far*(far - near)/(at_far - at_near)
         if (i > 40) reached = 0.5_wp*(near + far)
         call self%curve%guess(abs(reached - self%control)/self%curve%length, self%there)
         call self%equilibrium%find_point(self%springs, self%there, 0, reached, done)
         if (done) call self%equilibrium%find_rates(self%springs, self%there, self%direction, done)
         if (.not. done) return
         value = self%curve%least_rate(self%springs, self%there%rate)
         if (abs(value) < 0.9_wp*same_rate) return
         if (value > 0.0_wp) then
            near = reached
            at_near = value
            if (side > 0) at_far = 0.5_wp*at_far
            side = 1
         else
            far = reached
            at_far = value
            if (side < 0) at_near = 0.5_wp*at_near
            side = -1
         end if
      end do
      done = .false.
   end subroutine meet_turn

   !> Whether the springs really are on their lines at the point that was found.
   pure logical function on_their_lines(self)
      class(turning_search), intent(in) :: self
      real(wp) :: room
      integer :: i

      on_their_lines = .true.
      associate (springs => self%springs, q => self%there%q)
         do i = 1, self%moving
            room = 1.0e-9_wp*(abs(q(i)) + abs(q(i) - self%here%q(i)))
            on_their_lines = on_their_lines .and. q(i) <= springs%last(i) + room .and. &
                             q(i) >= springs%first(i) - room
         end do
      end associate
   end function on_their_lines

end module rbs_solve_static_finite_search
