!> The peak-oriented spring with pinched reloading, for columns with open shear cracks or slip of bars:
!> Ibarra, Medina, Krawinkler 2005 (Earthquake Eng. Struct. Dyn. 34, section 2.3).
!>
!> Two parts with the same backbone act in parallel (`rbs_hysteresis_rules_capped`). One has the share kappa_f of
!> the force and is peak-oriented. The other slips: it has no force before the deformation
!> (1 - kappa_d) d_per, where unloading from the peak ends at d_per, and goes to the peak from there. So the
!> line from zero force to the peak has its break there, with kappa_f times the force of the straight line,
!> as in the source, and what holds for each part holds for both.
module rbs_hysteresis_rules_pinching
   use rbs_base_keys, only: key_type, share_above_zero
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_hysteresis_rules_capped, only: capped_part, capped_memory
   use rbs_hysteresis_rules_peak_oriented, only: peak_oriented_rule, capped_keys
   use rbs_hysteresis_rule, only: rule_memory
   use rbs_hysteresis_segment, only: segment
   implicit none
   private

   public :: pinching_rule

   type(key_type), parameter :: own_keys(2) = [ &
      key_type('kappa_f', bound=share_above_zero, &
               meaning='force at the break of the reloading line over that of the straight line there'), &
      key_type('kappa_d', bound=share_above_zero, &
               meaning='share of the permanent deformation that is missing at the break')]
   type(key_type), parameter, public :: pinching_keys(*) = [capped_keys, own_keys]
   integer, parameter :: before = size(capped_keys)

   !> `part` is the peak-oriented one.
   type, extends(peak_oriented_rule) :: pinching_rule
      !> Share of the peak-oriented part in the force
      real(wp) :: kappa_f = 1.0_wp
      type(capped_part) :: slipping
   contains
      procedure :: set
      procedure :: start
      procedure :: next
   end type pinching_rule

   !> Present branches of the two parts.
   type :: pinching_state
      type(segment) :: branch, slipping_branch
   end type pinching_state

   type, extends(rule_memory) :: pinching_memory
      type(pinching_state) :: now
      type(capped_memory) :: part, slipping
   contains
      procedure :: copy
      procedure :: serialize
   end type pinching_memory

contains

   pure subroutine set(self, value)
      class(pinching_rule), intent(inout) :: self
      real(wp), intent(in) :: value(:)

      call self%peak_oriented_rule%set(value)
      self%kappa_f = value(before + 1)
      self%slipping = self%part
      self%slipping%slips = .true.
      self%slipping%slip = 1.0_wp - value(before + 2)
   end subroutine set

   subroutine start(self, memory, branch)
      class(pinching_rule), intent(in) :: self
      class(rule_memory), allocatable, intent(out) :: memory
      type(segment), intent(out) :: branch

      allocate (pinching_memory :: memory)
      select type (memory)
      type is (pinching_memory)
         call self%part%start(memory%part, memory%now%branch)
         call self%slipping%start(memory%slipping, memory%now%slipping_branch)
         branch = sum_of(self, memory%now, 0.0_wp)
      end select
   end subroutine start

   subroutine next(self, memory, branch, direction)
      class(pinching_rule), intent(in) :: self
      class(rule_memory), intent(inout) :: memory
      type(segment), intent(inout) :: branch
      integer, intent(in) :: direction
      real(wp) :: here

      select type (memory)
      type is (pinching_memory)
         memory%part%now%flexural_work = memory%flexural_work
         memory%slipping%now%flexural_work = memory%flexural_work
         here = branch%end_toward(direction)
         call follow(self%part, memory%part, memory%now%branch, here, direction)
         call follow(self%slipping, memory%slipping, memory%now%slipping_branch, here, direction)
         branch = sum_of(self, memory%now, here)
      end select
   end subroutine next

   !> A part goes on to its next branch if the present one ends here, or if it unloads on a reversal.
   subroutine follow(part, memory, branch, here, direction)
      type(capped_part), intent(in) :: part
      type(capped_memory), intent(inout) :: memory
      type(segment), intent(inout) :: branch
      real(wp), intent(in) :: here
      integer, intent(in) :: direction

      if (branch%one_way == -direction) then
         if (direction > 0) then
            branch%hi = here
         else
            branch%lo = here
         end if
      else if (direction*(branch%end_toward(direction) - here) > 0.0_wp) then
         return
      end if
      call part%next(memory, branch, direction)
   end subroutine follow

   !> The branch of both parts together from a deformation on.
   pure type(segment) function sum_of(self, now, here) result(branch)
      class(pinching_rule), intent(in) :: self
      type(pinching_state), intent(in) :: now
      real(wp), intent(in) :: here

      associate (a => now%branch, b => now%slipping_branch, share => self%kappa_f)
         branch%d0 = here
         ! Equal lines give the same line to the last bit.
         branch%f0 = b%force(here) + share*(a%force(here) - b%force(here))
         branch%k = b%k + share*(a%k - b%k)
         branch%lo = max(a%lo, b%lo)
         branch%hi = min(a%hi, b%hi)
         branch%lo_closed = (a%lo_closed .or. a%lo < branch%lo) .and. (b%lo_closed .or. b%lo < branch%lo)
         branch%hi_closed = (a%hi_closed .or. a%hi > branch%hi) .and. (b%hi_closed .or. b%hi > branch%hi)
         branch%one_way = a%one_way
         if (a%one_way == 0) branch%one_way = b%one_way
      end associate
   end function sum_of

   pure subroutine copy(self, other)
      class(pinching_memory), intent(inout) :: self
      class(rule_memory), intent(in) :: other

      select type (other)
      type is (pinching_memory)
         self%now = other%now
         call self%part%copy(other%part)
         call self%slipping%copy(other%slipping)
      end select
   end subroutine copy

   pure subroutine serialize(self, stream)
      class(pinching_memory), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call self%part%serialize(stream)
      call self%slipping%serialize(stream)
      call self%now%branch%serialize(stream)
      call self%now%slipping_branch%serialize(stream)
   end subroutine serialize

end module rbs_hysteresis_rules_pinching
