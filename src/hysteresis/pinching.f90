!> The peak-oriented spring with pinched reloading, for columns with open shear cracks or slip of bars:
!> Ibarra, Medina, Krawinkler 2005 (Earthquake Eng. Struct. Dyn. 34, section 2.3).
!>
!> Two parts with the same backbone act in parallel (`rbs_hysteresis_capped`). One has the share kappa_f of
!> the force and is peak-oriented. The other slips: it has no force before the deformation
!> (1 - kappa_d) d_per, where unloading from the peak ends at d_per, and goes to the peak from there. So the
!> line from zero force to the peak has its break there, with kappa_f times the force of the straight line,
!> as in the source, and what holds for each part holds for both.
module rbs_hysteresis_pinching
   use rbs_base_keys, only: key_type, share_above_zero
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_hysteresis_capped, only: capped_part
   use rbs_hysteresis_peak_oriented, only: peak_oriented_rule, capped_keys
   use rbs_hysteresis_rule, only: rule_type
   use rbs_hysteresis_segment, only: segment
   implicit none
   private

   public :: pinching_rule

   type(key_type), parameter :: own_keys(2) = [ &
      key_type('kappa_f', bound=share_above_zero, &
               meaning='force at the break of the reloading line over that of the straight line there'), &
      key_type('kappa_d', bound=share_above_zero, &
               meaning='share of the permanent deformation that is missing at the break')]
   integer, parameter :: before = size(capped_keys)

   !> `part` is the peak-oriented one.
   type, extends(peak_oriented_rule) :: pinching_rule
      !> Share of the peak-oriented part in the force
      real(wp) :: kappa_f = 1.0_wp
      type(capped_part) :: slipping
      !> Present lines of the two parts
      type(segment) :: line, slipping_line
   contains
      procedure, nopass :: keys
      procedure :: set
      procedure :: start
      procedure :: next
      procedure :: copy_memory
      procedure :: serialize
      procedure :: hear
   end type pinching_rule

contains

   pure function keys()
      type(key_type), allocatable :: keys(:)

      keys = [capped_keys, own_keys]
   end function keys

   pure subroutine set(self, value)
      class(pinching_rule), intent(inout) :: self
      real(wp), intent(in) :: value(:)

      call self%peak_oriented_rule%set(value)
      self%kappa_f = value(before + 1)
      self%slipping = self%part
      self%slipping%slips = .true.
      self%slipping%slip = 1.0_wp - value(before + 2)
   end subroutine set

   subroutine start(self, line)
      class(pinching_rule), intent(inout) :: self
      type(segment), intent(out) :: line

      call self%part%start(self%line)
      call self%slipping%start(self%slipping_line)
      line = sum_of(self, 0.0_wp)
   end subroutine start

   subroutine next(self, line, direction)
      class(pinching_rule), intent(inout) :: self
      type(segment), intent(inout) :: line
      integer, intent(in) :: direction
      real(wp) :: here

      here = line%end_toward(direction)
      call follow(self%part, self%line, here, direction)
      call follow(self%slipping, self%slipping_line, here, direction)
      line = sum_of(self, here)
   end subroutine next

   !> A part goes on to its next line if the present one ends here, or if it turns back on a one-way line.
   subroutine follow(part, line, here, direction)
      type(capped_part), intent(inout) :: part
      type(segment), intent(inout) :: line
      real(wp), intent(in) :: here
      integer, intent(in) :: direction

      if (line%one_way == -direction) then
         if (direction > 0) then
            line%hi = here
         else
            line%lo = here
         end if
      else if (direction*(line%end_toward(direction) - here) > 0.0_wp) then
         return
      end if
      call part%next(line, direction)
   end subroutine follow

   !> The line of both parts together from a deformation on.
   pure type(segment) function sum_of(self, here) result(line)
      class(pinching_rule), intent(in) :: self
      real(wp), intent(in) :: here

      associate (a => self%line, b => self%slipping_line, share => self%kappa_f)
         line%d0 = here
         ! Equal lines give the same line to the last bit.
         line%f0 = b%force(here) + share*(a%force(here) - b%force(here))
         line%k = b%k + share*(a%k - b%k)
         line%lo = max(a%lo, b%lo)
         line%hi = min(a%hi, b%hi)
         line%lo_closed = (a%lo_closed .or. a%lo < line%lo) .and. (b%lo_closed .or. b%lo < line%lo)
         line%hi_closed = (a%hi_closed .or. a%hi > line%hi) .and. (b%hi_closed .or. b%hi > line%hi)
         line%one_way = a%one_way
         if (a%one_way == 0) line%one_way = b%one_way
      end associate
   end function sum_of

   pure subroutine copy_memory(self, other, done)
      class(pinching_rule), intent(inout) :: self
      class(rule_type), intent(in) :: other
      logical, intent(out) :: done

      done = .false.
      select type (other)
      class is (pinching_rule)
         call self%part%copy_memory(other%part)
         call self%slipping%copy_memory(other%slipping)
         self%line = other%line
         self%slipping_line = other%slipping_line
         done = .true.
      end select
   end subroutine copy_memory

   !> Take the work of the flexural spring so far [J].
   pure subroutine hear(self, work)
      class(pinching_rule), intent(inout) :: self
      real(wp), intent(in) :: work

      self%part%heard = work
      self%slipping%heard = work
   end subroutine hear

   !> Save or restore all history variables.
   pure subroutine serialize(self, stream)
      class(pinching_rule), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call self%part%serialize(stream)
      call self%slipping%serialize(stream)
      call self%line%serialize(stream)
      call self%slipping_line%serialize(stream)
   end subroutine serialize

end module rbs_hysteresis_pinching
