!> A spring by itself, in one record of fixed size: its line, and where it is on it. Its rule stands beside.
!> What many springs do in arrays (`rbs_hysteresis_spring_lines`) it does with the same bits.
module rbs_hysteresis_lone_spring
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_rule, only: rule_type
   use rbs_hysteresis_segment, only: segment
   use rbs_hysteresis_spring_lines, only: first_on, last_on, most_lines
   implicit none
   private

   public :: lone_spring

   !> The first and the last deformation that belong to the line, present deformation and work.
   type :: lone_spring
      type(segment) :: line
      real(wp) :: first = 0.0_wp, last = 0.0_wp, d = 0.0_wp, work = 0.0_wp
   contains
      procedure :: side
      procedure :: move
      procedure :: advance_on_branch
      procedure :: change_line
   end type lone_spring

contains

   !> By which end of the line a deformation lies: +1, -1, or 0 if it lies on the line.
   elemental integer function side(self, d)
      class(lone_spring), intent(in) :: self
      real(wp), intent(in) :: d

      side = 0
      if (d > self%last) then
         side = 1
      else if (d < self%first) then
         side = -1
      end if
   end function side

   !> Move monotonically to d, over any number of lines.
   subroutine move(self, rule, d, events, stuck)
      class(lone_spring), intent(inout) :: self
      class(rule_type), intent(inout) :: rule
      !> New deformation [m or rad]
      real(wp), intent(in) :: d
      !> Number of lines left; whether the rule goes round in lines without length
      integer, intent(out) :: events
      logical, intent(out) :: stuck
      integer :: way

      stuck = .false.
      do events = 0, most_lines - 1
         way = self%side(d)
         if (way == 0) then
            call self%advance_on_branch(d)
            return
         end if
         call self%change_line(rule, way)
      end do
      stuck = .true.
   end subroutine move

   !> Move along the line to d; the rear end of a one-way line follows.
   pure subroutine advance_on_branch(self, d)
      class(lone_spring), intent(inout) :: self
      !> New deformation on the present line [m or rad]
      real(wp), intent(in) :: d

      associate (line => self%line)
         self%work = self%work + (line%f0 + line%k*(0.5_wp*(d + self%d) - line%d0))*(d - self%d)
         self%d = d
         if (line%one_way > 0) self%first = d
         if (line%one_way < 0) self%last = d
      end associate
   end subroutine advance_on_branch

   !> Move to the end of the line and get the line that follows from the rule. When the motion turns back, a
   !> one-way line ends at the present deformation.
   subroutine change_line(self, rule, way)
      class(lone_spring), intent(inout) :: self
      class(rule_type), intent(inout) :: rule
      !> +1: by the upper end, -1: by the lower end
      integer, intent(in) :: way

      associate (line => self%line)
         if (line%one_way > 0) line%lo = self%d
         if (line%one_way < 0) line%hi = self%d
         if (line%one_way /= -way) call self%advance_on_branch(merge(line%hi, line%lo, way > 0))
         call rule%next(line, way)
         self%first = first_on(line)
         self%last = last_on(line)
      end associate
   end subroutine change_line

end module rbs_hysteresis_lone_spring
