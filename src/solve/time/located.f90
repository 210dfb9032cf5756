!> Explicit steps that are cut where a spring's line ends or its velocity turns, so that the order of the
!> scheme is kept through yielding and unloading; with a scheme that estimates its error also steps whose
!> length follows from a tolerance.
module rbs_solve_time_located
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use rbs_base_error, only: error_type, fatal_error, analysis_failed
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_base_text, only: to_text
   use rbs_solve_time_event, only: event_type, find_event, same_event, event_distance, round_off_of, &
      above_round_off, direction_of
   use rbs_solve_time_motion, only: motion_result
   use rbs_solve_time_scheme, only: scheme_type
   use rbs_solve_time_state, only: state_type, stepper_type, in_bounds
   use rbs_structure_spring_location, only: spring_name
   implicit none
   private

   public :: located_stepper

   !> Error assigned to an attempt that is not finite.
   real(wp), parameter :: not_finite = 1.0e10_wp

   type, extends(stepper_type) :: located_stepper
      class(scheme_type), allocatable :: scheme
      !> Wanted relative error of a step in energy norm; 0: steps are not cut for accuracy
      real(wp) :: tolerance = 0.0_wp
      !> Step to try next, shortest and longest step [s]
      real(wp) :: next_step = 0.0_wp, shortest = 0.0_wp, longest = huge(1.0_wp)
      !> Largest energy so far, as the measure of errors [J]
      real(wp), private :: largest = 0.0_wp
      !> The equation of motion where springs are at rest, and where one turns back
      type(motion_result), private :: now
      !> Deformations that are zero (springs)
      real(wp), allocatable, private :: at_rest(:)
   contains
      procedure :: advance, resume
   end type located_stepper

contains

   !> Move the state on by h, in as many parts as events and tolerance ask for.
   subroutine advance(self, state, h, error)
      class(located_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state
      !> Step [s]
      real(wp), intent(in) :: h
      !> The state is then the last good one
      type(error_type), allocatable, intent(inout) :: error
      !> The first event of the attempt; its spring is 0 for none
      type(event_type) :: event
      !> End of the step, time left of it, length of the part to be tried, time to the next corner of the
      !> loading; error over the tolerance; lengths that are round-off of the step and of the clock [s]
      real(wp) :: finish, left, part, corner, excess, no_length, clock_digits
      !> `idle`: parts in a row without length
      integer :: tries, idle, i

      if (allocated(error)) return
      if (.not. allocated(self%now%a)) then
         call self%now%create(state%motion%structure)
         allocate (self%at_rest(size(state%q)), source=0.0_wp)
      end if
      finish = state%time + h
      left = h
      idle = 0
      no_length = 4.0_wp*spacing(h)
      clock_digits = 8.0_wp*spacing(finish)
      do
         ! A remainder below the last digits of the step is ignored. It is not read off the clock, which
         ! rounds where times are large.
         if (.not. left > no_length) exit
         ! A corner of the loading would lower the order as an event does.
         part = left
         corner = state%loads%corner_after(state%time) - state%time
         if (corner < left - clock_digits) then
            part = corner
            self%cut_steps = self%cut_steps + 1
         end if
         if (self%tolerance > 0.0_wp .and. self%next_step < 0.999_wp*part) then
            ! Two equal steps rather than a long and a short one.
            part = min(self%next_step, 0.5_wp*part)
         end if
         call leave_at_once(self, state, part, error)
         if (allocated(error)) return
         do tries = 1, 200
            call self%scheme%attempt(state, part)
            excess = error_of()
            if (.not. excess > 1.0_wp) exit
            ! A load may jump within the last digits of the clock; a shorter step would not help then.
            if (part <= clock_digits .and. excess < not_finite) exit
            if (self%tolerance > 0.0_wp .and. part > self%shortest) then
               part = max(part*max(0.2_wp, 0.9_wp*excess**(-1.0_wp/self%scheme%order)), 0.5_wp*self%shortest)
               self%cut_steps = self%cut_steps + 1
            else
               i = maxloc(abs(self%scheme%error_q)*sqrt(state%motion%structure%initial_stiffness), dim=1)
               call fatal_error(error, analysis_failed, 'the step of '//to_text(part)//' s at time '// &
                                to_text(state%begin + state%time)//' s does not reach the tolerance of '// &
                                to_text(self%tolerance)//'; the largest error is in '// &
                                trim(spring_name(state%motion%structure%location(i)))//'. Rows up to '// &
                                'there are kept. Give a larger tolerance, or method = '// &
                                "'generalised_alpha' for a stiff column")
               return
            end if
         end do
         call find_event(state, self%scheme, part, event)
         if (event%spring > 0) call locate(part)
         call accept(part)
         left = left - part
         state%time = finish - left
         idle = merge(0, idle + 1, part > no_length)
         if (idle > most_idle(state)) then
            call report_standstill(state, event%spring, error)
            return
         end if
         self%steps = self%steps + 1
         if (state%springs%stuck) return
         if (state%diverged) return
         if (event%spring > 0) then
            if (state%springs%crushed_joint() > 0) return
         end if
         if (state%monitor%monitors_top) call state%update_monitor(state%begin + state%time)
         if (state%monitor%collapsed) return
      end do
      state%time = finish

   contains

      !> Take the attempt of length h [s] as the state; the springs follow, that of the event onto its next
      !> line.
      subroutine accept(h)
         real(wp), intent(in) :: h
         integer :: i

         call self%scheme%accept(state, h)
         state%diverged = .not. in_bounds(size(state%q), state%q)
         if (state%diverged) return
         i = event%spring
         if (i > 0) then
            self%cut_steps = self%cut_steps + 1
            if (event%turns) then
               state%v(i) = 0.0_wp
            else
               state%q(i) = state%springs%end_toward(i, event%direction)
            end if
         end if
         call state%monitor%update_within_step(state%motion, state%springs, self%scheme%q, self%scheme%v, &
                                               state%q, state%v, h, state%begin + state%time)
         ! No other spring has passed an end by more than the last digits.
         call state%springs%carry_to(state%q)
         if (i > 0) call state%springs%leave(i, event%direction)
         if (self%tolerance > 0.0_wp) then
            self%longest_step = max(self%longest_step, h)
            self%largest = max(self%largest, energy_of(state%q, state%v))
            ! The length of a step that ends at an event is not that which accuracy allows.
            if (i == 0) then
               self%next_step = h*min(5.0_wp, 0.9_wp*max(excess, 1.0e-10_wp)**(-1.0_wp/self%scheme%order))
               self%next_step = min(self%next_step, self%longest)
            end if
         end if
      end subroutine accept

      !> Error of the attempt over the tolerance, in energy norm; above 1 also where it is not finite. Without
      !> a tolerance it is 0.
      real(wp) function error_of() result(excess)
         real(wp) :: measure

         excess = 0.0_wp
         if (.not. self%tolerance > 0.0_wp) return
         excess = not_finite
         if (.not. all(ieee_is_finite(self%scheme%v))) return
         if (.not. all(ieee_is_finite(self%scheme%q))) return
         excess = 0.0_wp
         ! Out of bounds the run ends, which `accept` finds.
         if (.not. in_bounds(size(self%scheme%q), self%scheme%q)) return
         measure = max(self%largest, energy_of(self%scheme%q, self%scheme%v))
         if (measure > 0.0_wp) then
            excess = sqrt(energy_of(self%scheme%error_q, self%scheme%error_v)/measure)/self%tolerance
         end if
      end function error_of

      !> Energy of small deformations and their velocities, no spring having yielded [J].
      pure real(wp) function energy_of(q, v) result(energy)
         real(wp), intent(in), contiguous :: q(:), v(:)

         energy = 0.5_wp*sum(state%motion%structure%initial_stiffness*q**2) &
                  + state%motion%structure%kinetic_energy(self%at_rest, v)
      end function energy_of

      !> Shorten the step to the event: attempts of shorter and shorter steps, by Newton's method within
      !> bounds. If another event turns out to come before, that one is located.
      subroutine locate(h)
         !> On entry the length of the attempt, on return that up to the event [s]
         real(wp), intent(inout) :: h
         type(event_type) :: other
         integer :: rounds

         do rounds = 1, 2 + most_idle(state)/5
            call approach(h)
            call find_event(state, self%scheme, h, other)
            if (other%spring == 0) return
            if (same_event(other, event)) return
            event = other
         end do
      end subroutine locate

      !> Newton's method, within bounds that are drawn closer, for the time of the event; the attempt ends
      !> there.
      subroutine approach(h)
         !> On entry the length of the attempt, on return that up to the event [s]
         real(wp), intent(inout) :: h
         !> Bounds of the time of the event, and a trial [s]; distance beyond the event there
         real(wp) :: low, high, t, distance, rate, round_off
         integer :: iteration

         low = 0.0_wp
         high = min(event%latest, h)
         t = min(max(event%estimate, 0.0_wp), high)
         if (.not. t > 0.0_wp) t = 0.5_wp*high
         do iteration = 1, 60
            call self%scheme%attempt(state, t)
            call event_distance(state, self%scheme, event, self%now, distance, rate, round_off)
            h = t
            if (abs(distance) <= round_off .or. high - low <= 4.0_wp*epsilon(1.0_wp)*high) exit
            if (distance > 0.0_wp) then
               high = t
            else
               low = t
            end if
            t = 0.5_wp*(low + high)
            if (rate > 0.0_wp) then
               if (h - distance/rate > low .and. h - distance/rate < high) t = h - distance/rate
            end if
         end do
      end subroutine approach

   end subroutine advance

   !> Save or restore, whichever the stream is set to, what the next step depends on: with a tolerance its
   !> length and the measure of its error, which follow from the steps before.
   subroutine resume(self, state, stream)
      class(located_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state
      type(stream_type), intent(inout) :: stream

      stream%broken = stream%broken .or. state%diverged
      call stream%item(self%next_step)
      call stream%item(self%largest)
   end subroutine resume

   !> How many parts of no length a step may have in a row.
   pure integer function most_idle(state)
      type(state_type), intent(in) :: state

      most_idle = 20 + 10*state%springs%count
   end function most_idle

   !> Before a step, change the lines of springs that would leave their lines at once: they move, or are about
   !> to move, beyond an end, or back on a one-way line. One spring at a time, since each change gives other
   !> accelerations.
   subroutine leave_at_once(self, state, part, error)
      class(located_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state
      !> Length of the step [s]
      real(wp), intent(in) :: part
      type(error_type), allocatable, intent(inout) :: error
      integer :: changes, i, direction
      logical :: known

      known = .false.
      associate (springs => state%springs)
         do changes = 0, 20 + 10*springs%count
            do i = 1, springs%count
               if (springs%unload_on_reversal(i) == 0 .and. springs%d(i) > springs%lower(i) .and. &
                   springs%d(i) < springs%upper(i)) cycle
               direction = direction_of(state%v(i))
               if (direction /= 0) then
                  if (.not. goes_on(i, direction)) cycle
                  ! A velocity that round-off could have brought about in one step has no direction.
                  direction = direction_of(above_round_off(state%v(i), round_off_of(state, i)*part))
               end if
               if (direction == 0) then
                  if (.not. known) then
                     call state%motion%acceleration(springs, state%q, state%v, state%load, self%now)
                     known = .true.
                  end if
                  direction = direction_of(above_round_off(self%now%a(i), round_off_of(state, i)))
               end if
               if (direction == 0) cycle
               if (goes_on(i, direction)) exit
            end do
            if (i > springs%count) return
            call springs%leave(i, direction)
            self%scheme%begun = .false.
            known = .false.
         end do
      end associate
      call report_standstill(state, i, error)

   contains

      !> Whether a spring leaves its line if it moves in a direction.
      pure logical function goes_on(i, direction)
         integer, intent(in) :: i, direction

         goes_on = state%springs%unload_on_reversal(i) == -direction
         if (.not. goes_on) then
            goes_on = direction*(state%springs%d(i) - state%springs%end_toward(i, direction)) >= 0.0_wp
         end if
      end function goes_on

   end subroutine leave_at_once

   !> Report that spring i changes its lines in a circle.
   subroutine report_standstill(state, i, error)
      type(state_type), intent(in) :: state
      integer, intent(in) :: i
      type(error_type), allocatable, intent(inout) :: error

      call fatal_error(error, analysis_failed, trim(spring_name(state%motion%structure%location(i)))// &
                       ' changes its line again and again at time '//to_text(state%begin + state%time)// &
                       " s without moving. Rows up to there are kept; try method = 'newmark'")
   end subroutine report_standstill

end module rbs_solve_time_located
