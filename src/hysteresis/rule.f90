!> What a hysteresis rule is: the author of a spring's lines.
module rbs_hysteresis_rule
   use rbs_hysteresis_segment, only: segment
   implicit none
   private

   public :: rule_type

   !> A rule is asked only when a line ends or the motion turns back. What it must remember lives in
   !> its own type and is copied by assignment.
   type, abstract :: rule_type
   contains
      procedure(start_interface), deferred :: start
      procedure(next_interface), deferred :: next
   end type rule_type

   abstract interface
      !> The line of the virgin spring; forgets everything.
      subroutine start_interface(self, line)
         import :: rule_type, segment
         implicit none
         class(rule_type), intent(inout) :: self
         type(segment), intent(out) :: line
      end subroutine start_interface

      !> The line that follows where the motion leaves the present one: by `hi` going up
      !> (direction = +1) or by `lo` going down (direction = -1). On a one-way line the rear end is
      !> the point where the motion turned back.
      subroutine next_interface(self, line, direction)
         import :: rule_type, segment
         implicit none
         class(rule_type), intent(inout) :: self
         !> The line that ends, replaced by its successor
         type(segment), intent(inout) :: line
         integer, intent(in) :: direction
      end subroutine next_interface
   end interface

end module rbs_hysteresis_rule
