!> Events of an explicit step: which spring, or which layer of a joint whose axial load varies, leaves its
!> line first in an attempt, and how far an attempt that ends near an event is from it.
module rbs_solve_time_event
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_layer_events, only: first_layer_exit, layer_end, layer_motion
   use rbs_hysteresis_line_exit, only: line_exit, find_exit
   use rbs_solve_time_motion, only: motion_result
   use rbs_solve_time_scheme, only: scheme_type
   use rbs_solve_time_state, only: state_type
   implicit none
   private

   public :: event_type, find_event, same_event, distance_to, standing_rotation, round_off_of, felt

   !> An acceleration below this share of those of the single forces is round-off.
   real(wp), parameter :: least_share = 32.0_wp*epsilon(1.0_wp)

   !> How a spring leaves its line, and when in the step that is expected.
   type, extends(line_exit) :: event_type
      !> Spring, 0 for none, and its layer, 0 if it is the spring itself
      integer :: spring = 0, layer = 0
   end type event_type

contains

   !> The first event of an attempt of length h.
   pure subroutine find_event(state, scheme, h, slope, event)
      type(state_type), intent(in) :: state
      class(scheme_type), intent(in) :: scheme
      real(wp), intent(in) :: h
      !> Slopes of the loads in the step
      real(wp), intent(in) :: slope(4)
      type(event_type), intent(out) :: event
      type(line_exit) :: one
      real(wp) :: press
      integer :: i, j, layer

      event%estimate = huge(1.0_wp)
      associate (springs => state%springs, motion => state%motion)
         do i = 1, springs%count
            ! Most springs stay inside their line and do not turn.
            if (scheme%q(i) >= springs%first(i) .and. scheme%q(i) <= springs%last(i) .and. &
                state%v(i)*scheme%v(i) > 0.0_wp) cycle
            call find_exit([springs%end_toward(i, -1), springs%end_toward(i, 1)], &
                           springs%unload_on_reversal(i), &
                           [state%q(i), scheme%q(i)], [state%v(i), scheme%v(i)], h, 0.0_wp, one)
            if (one%way == 0) cycle
            if (one%turns .and. keeps_still(state, scheme, i, h)) cycle
            if (one%estimate < event%estimate) then
               event = event_type(one%way, one%turns, one%estimate, one%latest, i, 0)
            end if
         end do
         if (.not. springs%pressed) return
         do j = 1, size(springs%layered)
            i = springs%layered(j)
            press = motion%structure%axial_rate(i, slope)
            call first_layer_exit(springs, i, scheme%q(i), motion%structure%axial_force(i, scheme%load), &
                                  [state%v(i), scheme%v(i)], press, h, layer, one)
            if (layer == 0) cycle
            if (one%turns .and. .not. abs(press) > 0.0_wp) then
               if (keeps_still(state, scheme, i, h)) cycle
            end if
            if (one%estimate < event%estimate) then
               event = event_type(one%way, one%turns, one%estimate, one%latest, i, layer)
            end if
         end do
      end associate
   end subroutine find_event

   !> Whether a spring moves by no more in a step than round-off moves it: its velocity then tells no
   !> direction. The round-off of the forces has another sign on either side of an end, and a spring at rest
   !> would turn from line to line for ever.
   pure logical function keeps_still(state, scheme, i, h)
      type(state_type), intent(in) :: state
      class(scheme_type), intent(in) :: scheme
      integer, intent(in) :: i
      real(wp), intent(in) :: h

      keeps_still = max(abs(state%v(i)), abs(scheme%v(i))) <= round_off_of(state, i)*h
   end function keeps_still

   !> Acceleration of an unknown that is the round-off of the forces [m/s2, rad/s2].
   pure real(wp) function round_off_of(state, i) result(least)
      type(state_type), intent(in) :: state
      integer, intent(in) :: i

      least = least_share*state%motion%structure%acceleration_scale(i, state%springs, state%load)
   end function round_off_of

   !> A number, zero where it is not above its round-off.
   elemental real(wp) function felt(x, least)
      real(wp), intent(in) :: x, least

      felt = merge(x, 0.0_wp, abs(x) > least)
   end function felt

   !> Whether two events are of the same spring or layer and of the same kind.
   pure logical function same_event(one, other)
      type(event_type), intent(in) :: one, other

      same_event = one%spring == other%spring .and. one%layer == other%layer .and. &
                   (one%turns .eqv. other%turns)
   end function same_event

   !> How far the end of an attempt is beyond an event, how fast that grows with time, and what is round-off
   !> of it: a deformation beyond the end of its line, or the velocity of what is to turn back.
   subroutine distance_to(state, scheme, event, slope, now, wrong, growth, small)
      type(state_type), intent(in) :: state
      class(scheme_type), intent(in) :: scheme
      type(event_type), intent(in) :: event
      !> Slopes of the loads in the step
      real(wp), intent(in) :: slope(4)
      !> Work arrays
      type(motion_result), intent(inout) :: now
      real(wp), intent(out) :: wrong, growth, small
      real(wp) :: finish, d, v, a, at_start, press, force, unused
      integer :: i

      i = event%spring
      if (event%turns) call state%motion%acceleration(state%springs, scheme%q, scheme%v, scheme%load, now)
      if (event%layer == 0) then
         if (event%turns) then
            wrong = event%way*scheme%v(i)
            small = 4.0_wp*epsilon(1.0_wp)*abs(state%v(i))
            growth = event%way*now%a(i)
         else
            finish = state%springs%end_toward(i, event%way)
            wrong = event%way*(scheme%q(i) - finish)
            small = 2.0_wp*spacing(max(abs(finish), abs(state%q(i))))
            growth = event%way*scheme%v(i)
         end if
         return
      end if
      press = state%motion%structure%axial_rate(i, slope)
      force = state%motion%structure%axial_force(i, scheme%load)
      associate (springs => state%springs)
         call layer_motion(springs, i, event%layer, scheme%q(i), force, scheme%v(i), press, d, v)
         if (event%turns) then
            call layer_motion(springs, i, event%layer, scheme%q(i), force, now%a(i), 0.0_wp, unused, a)
            call layer_motion(springs, i, event%layer, scheme%q(i), force, state%v(i), press, unused, &
                              at_start)
            wrong = event%way*v
            small = 4.0_wp*epsilon(1.0_wp)*abs(at_start)
            growth = event%way*a
         else
            call layer_end(springs, i, event%layer, event%way, finish, small)
            wrong = event%way*(d - finish)
            small = 0.25_wp*small
            growth = event%way*v
         end if
      end associate
   end subroutine distance_to

   !> The rate of rotation of a joint at which one of its layers stands still [rad/s]; where rotation does not
   !> move the layer, the present rate.
   pure real(wp) function standing_rotation(state, event, slope) result(turn)
      type(state_type), intent(in) :: state
      type(event_type), intent(in) :: event
      real(wp), intent(in) :: slope(4)
      real(wp) :: unused, pressed, turned

      associate (i => event%spring)
         call layer_motion(state%springs, i, event%layer, 0.0_wp, 0.0_wp, 0.0_wp, &
                           state%motion%structure%axial_rate(i, slope), unused, pressed)
         call layer_motion(state%springs, i, event%layer, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, unused, turned)
         turn = state%v(i)
         if (abs(pressed) < 1.0e100_wp*abs(turned)) turn = -pressed/turned
      end associate
   end function standing_rotation

end module rbs_solve_time_event
