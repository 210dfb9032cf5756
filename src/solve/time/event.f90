!> Events of an explicit step: which spring, or which layer of a joint whose axial load varies, leaves its
!> line first in an attempt, and how far an attempt that ends near an event is from it.
!>
!> Events of the layers of joints whose axial loads vary, within a step in time. On its plane a joint gives
!> the deformation of every layer as a linear function of rotation and axial load,
!>
!>     d_i = w(phi, N) + y_i phi,        v_i = w'(phi', N') + y_i phi'
!>
!> so that a layer leaves its line as any spring does.
!>
!> How a motion leaves a line within a step in time: it passes an end, or unloads on a reversal. The
!> motion is known at both ends of the step, and taken as the parabola through both velocities.
module rbs_solve_time_event
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_layered_fibre_section, only: fibre_section
   use rbs_hysteresis_springs, only: spring_array
   use rbs_solve_time_motion, only: motion_result
   use rbs_solve_time_scheme, only: scheme_type
   use rbs_solve_time_state, only: state_type
   implicit none
   private

   public :: event_type, find_event, same_event, distance_to, standing_rotation, round_off_of, felt, &
             layer_motion, layer_end, first_layer_exit, turn_layer, direction_of

   !> Deformations beyond this [m, rad] have no meaning: an end there is none.
   real(wp), parameter :: no_end = 1.0e100_wp

   type :: line_exit
      !> Direction in which the line is left: +1, -1; 0: it is not
      integer :: way = 0
      !> Whether it is left because the motion turns back, else because the line ends
      logical :: turns = .false.
      !> Time from the start of the step: an estimate, and after which it has certainly happened [s]
      real(wp) :: estimate = 0.0_wp, latest = 0.0_wp
   end type line_exit

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
      call layer_motion(state%springs, i, event%layer, scheme%q(i), force, scheme%v(i), press, d, v)
      if (event%turns) then
         call layer_motion(state%springs, i, event%layer, scheme%q(i), force, now%a(i), 0.0_wp, unused, a)
         call layer_motion(state%springs, i, event%layer, scheme%q(i), force, state%v(i), press, unused, &
                           at_start)
         wrong = event%way*v
         small = 4.0_wp*epsilon(1.0_wp)*abs(at_start)
         growth = event%way*a
      else
         call layer_end(state%springs, i, event%layer, event%way, finish, small)
         wrong = event%way*(d - finish)
         small = 0.25_wp*small
         growth = event%way*v
      end if
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

   !> Deformation and velocity of a layer at a point of the present plane of its joint.
   pure subroutine layer_motion(springs, i, layer, rotation, axial_load, turn, press, d, v)
      type(spring_array), intent(in) :: springs
      !> The joint, and its layer
      integer, intent(in) :: i, layer
      !> Rotation of the joint and axial load, and their rates
      real(wp), intent(in) :: rotation, axial_load, turn, press
      real(wp), intent(out) :: d, v

      d = 0.0_wp
      v = 0.0_wp
      select type (section => springs%slot(i)%memory)
      type is (fibre_section)
         d = section%opening_at(rotation, axial_load) + section%y(layer)*(rotation + section%rest)
         v = section%rate_of_opening(turn, press) + section%y(layer)*turn
      end select
   end subroutine layer_motion

   !> The end of the line of a layer in a direction, and what the last digits leave undecided there [m].
   pure subroutine layer_end(springs, i, layer, way, finish, digits)
      type(spring_array), intent(in) :: springs
      integer, intent(in) :: i, layer, way
      real(wp), intent(out) :: finish, digits

      finish = 0.0_wp
      digits = 0.0_wp
      select type (section => springs%slot(i)%memory)
      type is (fibre_section)
         finish = section%branch(layer)%end_toward(way)
         digits = section%room_in_digits()
      end select
   end subroutine layer_end

   !> The first layer of a joint that leaves its line on the way to a point of the plane.
   pure subroutine first_layer_exit(springs, i, rotation, axial_load, turn, press, h, layer, exit)
      type(spring_array), intent(in) :: springs
      integer, intent(in) :: i
      !> Rotation and axial load at the end of the step; rates of the rotation at the start of the step and at
      !> its end, and of the axial load
      real(wp), intent(in) :: rotation, axial_load, turn(2), press
      !> Length of the step [s]
      real(wp), intent(in) :: h
      !> The layer, 0 for none
      integer, intent(out) :: layer
      type(line_exit), intent(out) :: exit
      type(line_exit) :: one
      real(wp) :: d(2), v(2), opening, turned, open(2), least(2), digits
      integer :: j

      layer = 0
      exit%estimate = huge(1.0_wp)
      select type (section => springs%slot(i)%memory)
      type is (fibre_section)
         turned = rotation + section%rest
         opening = section%opening_at(rotation, axial_load)
         open = [section%rate_of_opening(turn(1), press), section%rate_of_opening(turn(2), press)]
         least = [section%least_rate(open(1), turn(1)), section%least_rate(open(2), turn(2))]
         digits = section%room_in_digits()
         do j = 1, section%count
            d = [section%deformation(j), opening + section%y(j)*turned]
            v = open + section%y(j)*turn
            ! Most layers stay inside their line and do not turn.
            if (d(2) >= section%lo(j) .and. d(2) <= section%hi(j) .and. v(1)*v(2) > 0.0_wp .and. &
                section%unload_on_reversal(j)*v(2) >= 0.0_wp) cycle
            where (abs(v) <= least) v = 0.0_wp
            ! A layer that keeps still does not turn.
            if (.not. any(abs(v) > 0.0_wp)) cycle
            call find_exit([section%lo(j), section%hi(j)], section%branch(j)%unload_on_reversal, d, v, h, &
                           digits, one)
            if (one%way == 0 .or. one%estimate >= exit%estimate) cycle
            exit = one
            layer = j
         end do
      end select
   end subroutine first_layer_exit

   !> A layer whose motion has come to a stand unloads. Its joint chooses its branches
   !> afterwards.
   subroutine turn_layer(springs, i, layer, way)
      type(spring_array), intent(inout) :: springs
      integer, intent(in) :: i, layer
      !> The direction in which it goes on
      integer, intent(in) :: way

      select type (section => springs%slot(i)%memory)
      type is (fibre_section)
         call section%leave(layer, way)
         call section%sum_up()
      end select
      springs%events = springs%events + 1
   end subroutine turn_layer

   !> The exit from a line within a step.
   pure subroutine find_exit(ends, unload_on_reversal, d, v, h, digits, exit)
      !> The ends of the line, from below and from above, and whether it unloads on reversal
      real(wp), intent(in) :: ends(2)
      integer, intent(in) :: unload_on_reversal
      !> Deformation and velocity at the start of the step and at its end; length of the step [s], and what
      !> the last digits of a deformation leave undecided
      real(wp), intent(in) :: d(2), v(2), h, digits
      type(line_exit), intent(out) :: exit
      real(wp) :: turning, furthest, far
      integer :: way

      way = direction_of(v(1))
      turning = huge(1.0_wp)
      if (v(1)*v(2) < 0.0_wp) turning = h*v(1)/(v(1) - v(2))
      if (way /= 0 .and. turning < h) then
         furthest = d(1) + 0.5_wp*v(1)*turning
         if (is_beyond(furthest, way)) then
            ! It passes the end and comes back within the step.
            far = end_of(way) - d(1)
            exit = line_exit(way, .false., turning*(1.0_wp - sqrt(max(1.0_wp - 2.0_wp*far/(v(1)*turning), &
                                                                      0.0_wp))), turning)
            return
         else if (unload_on_reversal == way) then
            exit = line_exit(-way, .true., turning, h)
            return
         end if
      end if
      way = direction_of(d(2) - d(1))
      if (turning < h) way = -direction_of(v(1))
      if (way == 0) return
      if (is_beyond(d(2), way)) then
         far = end_of(way) - d(1)
         exit = line_exit(way, .false., h*min(max(far/(d(2) - d(1)), 0.0_wp), 1.0_wp), h)
      else if (unload_on_reversal == -way) then
         exit = line_exit(way, .true., 0.5_wp*h, h)
      end if

   contains

      pure real(wp) function end_of(side)
         integer, intent(in) :: side

         end_of = merge(ends(2), ends(1), side > 0)
      end function end_of

      !> Whether a deformation is beyond the end of the line in a direction, by more than the last digits. The
      !> rear end of one that unloads on reversal does not count.
      pure logical function is_beyond(at, side)
         real(wp), intent(in) :: at
         integer, intent(in) :: side

         is_beyond = .false.
         if (unload_on_reversal == -side) return
         if (abs(end_of(side)) > no_end) return
         is_beyond = side*(at - end_of(side)) > 4.0_wp*spacing(max(abs(end_of(side)), abs(d(1)))) + digits
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
