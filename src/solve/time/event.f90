!> Events of an explicit step: the spring that leaves its line first in an attempt, and the distance of the
!> end of an attempt from an event. A motion passes the end of a line, or unloads where it turns back. It is
!> known at both ends of the step, and taken as the parabola through both velocities.
module rbs_solve_time_event
   use rbs_base_kinds, only: wp
   use rbs_base_tolerances, only: round_off_of_sums
   use rbs_solve_time_motion, only: motion_result
   use rbs_solve_time_scheme, only: scheme_type
   use rbs_solve_time_state, only: state_type
   implicit none
   private

   public :: event_type, find_event, same_event, event_distance, round_off_of, above_round_off, direction_of

   !> Deformations beyond this [m, rad] have no meaning: an end there is none.
   real(wp), parameter :: no_end = 1.0e100_wp

   type :: line_exit
      !> Direction in which the line is left: +1, -1; 0: it is not
      integer :: direction = 0
      !> Whether it is left because the motion turns back, else because the line ends
      logical :: turns = .false.
      !> Time from the start of the step: an estimate, and after which it has certainly happened [s]
      real(wp) :: estimate = 0.0_wp, latest = 0.0_wp
   end type line_exit

   !> The exit of a spring from its line, and the time in the step at which that is expected.
   type, extends(line_exit) :: event_type
      !> 0 for none
      integer :: spring = 0
   end type event_type

contains

   !> The first event of an attempt: the spring that leaves its line at the earliest estimate; `spring` is 0
   !> if none does.
   pure subroutine find_event(state, scheme, h, event)
      type(state_type), intent(in) :: state
      class(scheme_type), intent(in) :: scheme
      !> Length of the attempt [s]
      real(wp), intent(in) :: h
      type(event_type), intent(out) :: event
      !> Exit of one spring
      type(line_exit) :: one
      integer :: i

      event%estimate = huge(1.0_wp)
      associate (springs => state%springs)
         do i = 1, springs%count
            ! Most springs stay inside their line and do not turn.
            if (scheme%q(i) >= springs%lower(i) .and. scheme%q(i) <= springs%upper(i) .and. &
                state%v(i)*scheme%v(i) > 0.0_wp) cycle
            call find_exit([springs%end_toward(i, -1), springs%end_toward(i, 1)], &
                           springs%unload_on_reversal(i), &
                           [state%q(i), scheme%q(i)], [state%v(i), scheme%v(i)], h, one)
            if (one%direction == 0) cycle
            if (one%turns .and. keeps_still(state, scheme, i, h)) cycle
            if (one%estimate < event%estimate) then
               event = event_type(one%direction, one%turns, one%estimate, one%latest, i)
            end if
         end do
      end associate
   end subroutine find_event

   !> Whether spring i moves by no more in a step than round-off moves it: its velocity then has no direction.
   !> The round-off of the forces has another sign on either side of an end, and a spring at rest would turn
   !> from line to line for ever.
   pure logical function keeps_still(state, scheme, i, h)
      type(state_type), intent(in) :: state
      class(scheme_type), intent(in) :: scheme
      integer, intent(in) :: i
      !> Length of the step [s]
      real(wp), intent(in) :: h

      keeps_still = max(abs(state%v(i)), abs(scheme%v(i))) <= round_off_of(state, i)*h
   end function keeps_still

   !> Acceleration of spring i that is the round-off of the forces [m/s2, rad/s2].
   pure real(wp) function round_off_of(state, i) result(least)
      type(state_type), intent(in) :: state
      integer, intent(in) :: i

      least = round_off_of_sums*state%motion%structure%acceleration_scale(i, state%springs, state%load)
   end function round_off_of

   !> A number, or zero where it is not larger in size than its round-off, `least`.
   elemental real(wp) function above_round_off(x, least)
      real(wp), intent(in) :: x, least

      above_round_off = merge(x, 0.0_wp, abs(x) > least)
   end function above_round_off

   !> Whether two events are of the same spring and of the same kind.
   pure logical function same_event(one, other)
      type(event_type), intent(in) :: one, other

      same_event = one%spring == other%spring .and. (one%turns .eqv. other%turns)
   end function same_event

   !> Distance by which the end of an attempt is beyond an event: of the deformation from the end of its line
   !> [m or rad], or, of a spring that is to turn back, its velocity [m/s or rad/s].
   subroutine event_distance(state, scheme, event, now, distance, rate, round_off)
      type(state_type), intent(in) :: state
      class(scheme_type), intent(in) :: scheme
      type(event_type), intent(in) :: event
      !> Work arrays
      type(motion_result), intent(inout) :: now
      !> The distance, its rate in time, and its round-off
      real(wp), intent(out) :: distance, rate, round_off
      real(wp) :: finish

      associate (i => event%spring)
         ! Where the motion turns back: the velocity in the new direction, whose rate is the acceleration
         if (event%turns) then
            call state%motion%acceleration(state%springs, scheme%q, scheme%v, scheme%load, now)
            distance = event%direction*scheme%v(i)
            round_off = 4.0_wp*epsilon(1.0_wp)*abs(state%v(i))
            rate = event%direction*now%a(i)
         else
            finish = state%springs%end_toward(i, event%direction)
            distance = event%direction*(scheme%q(i) - finish)
            round_off = 2.0_wp*spacing(max(abs(finish), abs(state%q(i))))
            rate = event%direction*scheme%v(i)
         end if
      end associate
   end subroutine event_distance

   !> How a spring leaves its line within a step: by an end, or by a turn on a one-way line. In the step its
   !> velocity is linear in time. `exit` keeps the direction 0 where the spring stays on its line.
   pure subroutine find_exit(ends, unload_on_reversal, d, v, h, exit)
      !> Lower and upper end of the line; direction of a one-way line, which is left where the motion turns
      !> back (+1, -1), 0: the line is for both directions
      real(wp), intent(in) :: ends(2)
      integer, intent(in) :: unload_on_reversal
      !> Deformation and velocity at the start of the step and at its end; length of the step [s]
      real(wp), intent(in) :: d(2), v(2), h
      type(line_exit), intent(out) :: exit
      !> Time of the reversal [s], deformation then; way to the end of the line, share of the time that it
      !> takes
      real(wp) :: reversal, furthest, far, share
      integer :: direction

      direction = direction_of(v(1))
      ! The velocity is linear in the step, and passes zero at the reversal.
      reversal = huge(1.0_wp)
      if (v(1)*v(2) < 0.0_wp) reversal = h*v(1)/(v(1) - v(2))
      if (direction /= 0 .and. reversal < h) then
         furthest = d(1) + 0.5_wp*v(1)*reversal
         if (is_beyond(furthest, direction)) then
            ! It passes the end and comes back within the step.
            far = end_of(direction) - d(1)
            share = 1.0_wp - sqrt(max(1.0_wp - 2.0_wp*far/(v(1)*reversal), 0.0_wp))
            exit = line_exit(direction, .false., reversal*share, reversal)
            return
         else if (unload_on_reversal == direction) then
            exit = line_exit(-direction, .true., reversal, h)
            return
         end if
      end if
      ! Whether the end of the step, without a way there and back, is off the line.
      direction = direction_of(d(2) - d(1))
      if (reversal < h) direction = -direction_of(v(1))
      if (direction == 0) return
      if (is_beyond(d(2), direction)) then
         far = end_of(direction) - d(1)
         exit = line_exit(direction, .false., h*min(max(far/(d(2) - d(1)), 0.0_wp), 1.0_wp), h)
      else if (unload_on_reversal == -direction) then
         exit = line_exit(direction, .true., 0.5_wp*h, h)
      end if

   contains

      !> The end of the line on a side, +1 or -1.
      pure real(wp) function end_of(side)
         integer, intent(in) :: side

         end_of = merge(ends(2), ends(1), side > 0)
      end function end_of

      !> Whether a deformation is beyond the end of the line in a direction, by more than the last digits. The
      !> rear end of one that unloads on reversal does not count.
      pure logical function is_beyond(at, side)
         !> Deformation, and direction: +1 or -1
         real(wp), intent(in) :: at
         integer, intent(in) :: side

         is_beyond = .false.
         if (unload_on_reversal == -side) return
         if (abs(end_of(side)) > no_end) return
         is_beyond = side*(at - end_of(side)) > 4.0_wp*spacing(max(abs(end_of(side)), abs(d(1))))
      end function is_beyond

   end subroutine find_exit

   !> Which way a value points: +1, -1, or 0 where it is zero.
   pure integer function direction_of(x)
      real(wp), intent(in) :: x

      direction_of = 0
      if (x > 0.0_wp) direction_of = 1
      if (x < 0.0_wp) direction_of = -1
   end function direction_of

end module rbs_solve_time_event
