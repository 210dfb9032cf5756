!> How a motion leaves a line within a step in time: it passes an end, or unloads on a reversal. The
!> motion is known at both ends of the step, and taken as the parabola through both velocities.
module rbs_hysteresis_line_exit
   use rbs_base_kinds, only: wp
   implicit none
   private

   public :: line_exit, find_exit, no_end

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

contains

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

   pure integer function direction_of(x)
      real(wp), intent(in) :: x

      direction_of = 0
      if (x > 0.0_wp) direction_of = 1
      if (x < 0.0_wp) direction_of = -1
   end function direction_of

end module rbs_hysteresis_line_exit
