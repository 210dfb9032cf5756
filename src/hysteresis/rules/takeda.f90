!> Trilinear Takeda spring with the degradation factors B0 and B1 (paper, table 1, flexural spring).
!>
!> Takeda, Sozen, Nielsen 1970 (ASCE 96 ST12) in six kinds of branch; s is the side of the force:
!>
!>     uncracked          slope k_c, ends at cracking
!>     cracked backbone   slope k_y, ends at yield; turning back: outer unloading
!>     yielded backbone   slope k_u; turning back: outer unloading
!>     outer unloading    from the peak of the side, slope K_r; ends at zero force
!>     reloading          toward the newest open inner peak of its side, else the backbone peak
!>     inner unloading    from a reversal on reloading, an inner peak, slope K_in; ends at zero force
!>
!> K_r = (|Fm| + f_c)/(|Dm| + d_c) before yield, K_0 (d_y/|Dm|)^B0 after it, K_0 = (f_c + f_y)/(d_c + d_y)
!> (eq 7). K_in = B1 k_c (`inner = 'kc'`), B1 K_r ('kr') or K_r ('one'), never above K_r and never below
!> the secant to the zero crossing of the excursion: below it a loop would create energy.
module rbs_hysteresis_rules_takeda
   use, intrinsic :: iso_fortran_env, only: int64
   use rbs_base_check, only: check_order
   use rbs_base_error, only: message_list
   use rbs_base_key_visitor, only: key_visitor
   use rbs_base_keys, only: above_zero, not_negative, deformation, stiffness
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_base_constants, only: unbounded, unset
   use rbs_base_tolerances, only: no_force, parallel
   use rbs_hysteresis_rules_open_turns, only: point, turn, open_turns
   use rbs_hysteresis_rule, only: rule_type, rule_memory, check_product
   use rbs_hysteresis_segment, only: segment
   implicit none
   private

   public :: takeda_rule

   integer, parameter :: uncracked = 0, cracked_backbone = 1, yielded_backbone = 2
   integer, parameter :: outer_unloading = 3, reloading = 4, inner_unloading = 5

   !> Stiffness that B1 multiplies: the uncracked or the outer unloading one; none is the third choice.
   integer, parameter :: of_uncracked = 1, of_outer = 2

   !> Reloading that turns this close to the peak of the backbone, relative to it, turns there: round-off does
   !> not decide between outer and inner unloading where a hinge in series yields at the same moment again.
   real(wp), parameter :: same_place = 1.0e-11_wp

   !> Where a spring is on its rule.
   type :: takeda_state
      !> Present branch and its side
      integer :: branch = uncracked, side = 0
      !> Of each side: whether it has cracked, its backbone peak, the slope of its last outer unloading
      logical :: cracked(-1:1) = .false.
      type(point) :: peak(-1:1)
      real(wp) :: k_r(-1:1) = 0.0_wp
      !> The present reloading branch, and the number of inner peaks so far
      type(turn) :: aim
      integer(int64) :: peaks = 0_int64
   end type takeda_state

   type, extends(rule_memory) :: takeda_memory
      type(takeda_state) :: now
      !> Inner peaks whose loops are still open, with the reloading branches that were left there
      type(open_turns) :: open
   contains
      procedure :: copy, serialize
   end type takeda_memory

   type, extends(rule_type) :: takeda_rule
      !> Uncracked, cracked and yielded stiffness [N/m or N m/rad]; cracking and yield deformation [m or rad]
      real(wp) :: k_c = unset, k_y = unset, k_u = unset, d_c = unset, d_y = unset
      !> Degradation factors
      real(wp) :: b0 = 0.4_wp, b1 = 1.0_wp
      !> Stiffness that B1 multiplies, the place of its name among the choices
      integer :: inner = of_uncracked
      !> Cracking and yield force [N or N m]
      real(wp), private :: f_c = 0.0_wp, f_y = 0.0_wp
   contains
      procedure :: visit, prepare, check_relations, next
   end type takeda_rule

   !> A spring at an event: its rule, and the state that the event changes.
   type :: takeda_spring
      type(takeda_rule), pointer :: rule => null()
      type(takeda_state), pointer :: now => null()
      type(open_turns), pointer :: open => null()
      type(segment), pointer :: branch => null()
   end type takeda_spring

contains

   !> Present the parameters to a visitor.
   subroutine visit(self, v)
      class(takeda_rule), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%key('k_c', self%k_c, stiffness, above_zero, 'uncracked stiffness')
      call v%key('d_c', self%d_c, deformation, above_zero, 'cracking deformation')
      call v%key('k_y', self%k_y, stiffness, above_zero, 'cracked stiffness, below k_c')
      call v%key('d_y', self%d_y, deformation, above_zero, 'yield deformation, above d_c')
      call v%key('k_u', self%k_u, stiffness, not_negative, 'stiffness after yield, up to k_y')
      call v%key('b0', self%b0, '', not_negative, 'exponent of the outer unloading stiffness')
      call v%key('b1', self%b1, '', above_zero, 'factor of the inner unloading stiffness')
      call v%word('inner', self%inner, &
                  'what b1 multiplies: k_c, the outer unloading stiffness, or nothing', 'kc kr one')
   end subroutine visit

   !> Values that follow from the parameters: forces at cracking and yield, the virgin memory and branch.
   subroutine prepare(self)
      class(takeda_rule), intent(inout) :: self

      self%initial_stiffness = self%k_c
      self%branch = segment(k=self%k_c, lo=-self%d_c, hi=self%d_c)
      self%memory = takeda_memory()
      self%f_c = self%k_c*self%d_c
      self%f_y = self%f_c + self%k_y*(self%d_y - self%d_c)
   end subroutine prepare

   !> Add a message for each pair of parameters that do not suit each other.
   subroutine check_relations(self, name, messages)
      class(takeda_rule), intent(inout) :: self
      character(len=*), intent(in) :: name
      type(message_list), intent(inout) :: messages

      call check_order(name, 'd_y', self%d_y, 'must be above', 'd_c', self%d_c, &
                       ' (yield comes after cracking)', messages)
      call check_order(name, 'k_y', self%k_y, 'must be below', 'k_c', self%k_c, ' (cracking softens)', &
                       messages)
      call check_order(name, 'k_u', self%k_u, 'must not be above', 'k_y', self%k_y, ' (yielding softens)', &
                       messages)
      call check_product(self%k_c, self%d_y, name, 'k_c d_y', messages)
   end subroutine check_relations

   !> The branch after the present one, which the motion leaves going up (direction = +1) or down (-1).
   subroutine next(self, memory, branch, direction)
      class(takeda_rule), intent(in) :: self
      class(rule_memory), intent(inout) :: memory
      !> The branch that ends, replaced by its successor
      type(segment), intent(inout) :: branch
      integer, intent(in) :: direction

      select type (memory)
      type is (takeda_memory)
         call find_branch(self, memory%now, memory%open, branch, direction)
      end select
   end subroutine next

   !> The next branch at the end of the present one, where the motion continues or reverses. `outward` means
   !> away from zero force on the present side. `(now%side)` in parentheses is a copy: the procedure that is
   !> called sets `now%side`.
   subroutine find_branch(self, now, open, branch, direction)
      type(takeda_rule), intent(in), target :: self
      type(takeda_state), intent(inout), target :: now
      type(open_turns), intent(inout), target :: open
      !> The branch that ends, replaced by its successor
      type(segment), intent(inout), target :: branch
      !> +1: the motion goes up, -1: down
      integer, intent(in) :: direction
      type(takeda_spring) :: spring
      type(point) :: end_point
      logical :: outward

      spring%rule => self
      spring%now => now
      spring%open => open
      spring%branch => branch
      end_point%d = branch%end_toward(direction)
      end_point%f = branch%force(end_point%d)
      outward = direction == now%side

      select case (now%branch)
      case (uncracked)
         now%cracked(direction) = .true.
         call follow_backbone(spring, direction, direction*self%d_c)
      case (cracked_backbone, yielded_backbone)
         if (outward) then
            call follow_backbone(spring, (now%side), end_point%d)
         else
            call unload_from_peak(spring, end_point)
         end if
      case (outer_unloading)
         if (outward) then
            call follow_backbone(spring, (now%side), end_point%d)
         else if (now%cracked(direction)) then
            call reload_from_outer(spring, end_point%d)
         else
            call crack_on_reversal(spring, end_point%d)
         end if
      case (reloading)
         if (outward) then
            call reach_target(spring)
         else if (now%aim%goal_number == 0_int64 .and. &
                  abs(end_point%d - now%aim%goal%d) <= same_place*abs(end_point%d)) then
            open%count = 0
            call unload_from_peak(spring, end_point)
         else
            call unload_from_inner_peak(spring, end_point)
         end if
      case (inner_unloading)
         if (outward) then
            call resume_reloading(spring, (open%count))
         else
            call reload_from_inner(spring, direction, end_point)
         end if
      case default                                  ! no other branch
      end select
   end subroutine find_branch

   !> On the backbone of side s (+1 or -1) from the deformation d, with its sign, on.
   subroutine follow_backbone(spring, s, d)
      type(takeda_spring), intent(inout) :: spring
      integer, intent(in) :: s
      real(wp), intent(in) :: d

      associate (rule => spring%rule, now => spring%now, branch => spring%branch)
         now%side = s
         if (s*d < rule%d_y) then
            now%branch = cracked_backbone
            branch = segment(d0=s*rule%d_c, f0=s*rule%f_c, k=rule%k_y)
            call branch%lead_outward(s, near=d, far=s*rule%d_y)
         else
            now%branch = yielded_backbone
            branch = segment(d0=s*rule%d_y, f0=s*rule%f_y, k=rule%k_u)
            call branch%lead_outward(s, near=d, far=s*unbounded)
         end if
      end associate
   end subroutine follow_backbone

   !> Reversal on the backbone: a new peak of this side, unloading with K_r.
   subroutine unload_from_peak(spring, peak)
      type(takeda_spring), intent(inout) :: spring
      type(point), intent(in) :: peak
      real(wp) :: near
      integer :: s

      associate (rule => spring%rule, now => spring%now, branch => spring%branch)
         s = now%side
         now%branch = outer_unloading
         now%peak(s) = peak
         now%k_r(s) = outer_stiffness(spring, abs(peak%d), abs(peak%f))
         branch = segment(d0=peak%d, f0=peak%f, k=now%k_r(s))
         if (now%cracked(-s)) then
            ! To zero force.
            near = peak%d - peak%f/now%k_r(s)
         else if (abs(peak%d) <= rule%d_y) then
            near = -s*rule%d_c                         ! by definition K_r leads to the cracking point
         else
            ! On through zero to the cracking force of the other side.
            near = peak%d - (peak%f + s*rule%f_c)/now%k_r(s)
         end if
         call branch%lead_outward(s, near=near, far=peak%d, includes_near_end=now%cracked(-s), &
                                  unload_on_reversal=.false.)
      end associate
   end subroutine unload_from_peak

   !> K_r of a peak (eq 7), not below the secant: unloading must not end on the other side of the origin.
   real(wp) function outer_stiffness(spring, d, f) result(k_r)
      type(takeda_spring), intent(inout) :: spring
      !> Peak, both positive
      real(wp), intent(in) :: d, f

      associate (rule => spring%rule)
         if (d <= rule%d_y) then
            k_r = (f + rule%f_c)/(d + rule%d_c)
         else
            k_r = (rule%f_c + rule%f_y)/(rule%d_c + rule%d_y)*(rule%d_y/d)**rule%b0
         end if
         k_r = max(k_r, f/d)
      end associate
   end function outer_stiffness

   !> Outer unloading has reached zero force, and the other side has cracked: reload toward its peak, or
   !> toward its yield point if it has not yielded and the line to it is steeper.
   subroutine reload_from_outer(spring, zero)
      type(takeda_spring), intent(inout) :: spring
      !> Deformation there [m or rad]
      real(wp), intent(in) :: zero
      type(point) :: yield
      integer :: s

      associate (rule => spring%rule, now => spring%now)
         s = -now%side
         yield = point(s*rule%d_y, s*rule%f_y)
         if (s*now%peak(s)%d < rule%d_y) then
            if (yield%f/(yield%d - zero) > now%peak(s)%f/(now%peak(s)%d - zero)) now%peak(s) = yield
         end if
         call reload_toward_peak(spring, s, point(zero, 0.0_wp), zero)
      end associate
   end subroutine reload_from_outer

   !> Outer unloading has continued to the cracking force of the other side, which cracks.
   subroutine crack_on_reversal(spring, d)
      type(takeda_spring), intent(inout) :: spring
      !> Deformation there, with its sign [m or rad]
      real(wp), intent(in) :: d
      real(wp) :: zero, k_r, ahead, d_peak
      integer :: s

      associate (rule => spring%rule, now => spring%now)
         s = -now%side
         now%cracked(s) = .true.
         k_r = now%k_r(-s)
         ! Before yield K_r leads to the cracking point itself.
         if (abs(now%peak(-s)%d) <= rule%d_y) then
            call follow_backbone(spring, s, d)
            return
         end if
         zero = now%peak(-s)%d - now%peak(-s)%f/k_r
         now%peak(s) = point(s*rule%d_y, s*rule%f_y)
         ahead = s*(now%peak(s)%d - d)
         if (rule%f_y - rule%f_c > k_r*ahead .and. k_r > (1.0_wp + parallel)*rule%k_u) then
            ! The line to the yield point is steeper than K_r or leads back: continue with K_r to the yielded
            ! backbone.
            d_peak = (rule%f_y - rule%k_u*rule%d_y - rule%f_c + k_r*s*d)/(k_r - rule%k_u)
            now%peak(s) = point(s*d_peak, s*(rule%f_y + rule%k_u*(d_peak - rule%d_y)))
         end if
         call reload_toward_peak(spring, s, point(d, s*rule%f_c), zero)
      end associate
   end subroutine crack_on_reversal

   !> Reloading has reached its target, an inner peak (goal_number > 0) or the backbone peak (0).
   subroutine reach_target(spring)
      type(takeda_spring), intent(inout) :: spring
      type(point) :: end_point
      integer :: place

      associate (now => spring%now, open => spring%open)
         end_point = now%aim%goal
         place = open%place_of(now%aim%goal_number)
         if (place > 0) then
            call resume_reloading(spring, place)
            return
         end if
         open%count = 0
         if (now%aim%goal_number == 0_int64) then
            call follow_backbone(spring, (now%side), end_point%d)
         else
            ! The inner peak was so old that it has been forgotten: continue to the backbone.
            call reload_toward_peak(spring, (now%side), end_point, (now%aim%start))
         end if
      end associate
   end subroutine reach_target

   !> Reversal on reloading before its target: a new inner peak, from which unloading has slope K_in. Where
   !> there is no force to unload, the spring reloads to the other side, or goes back where it came from.
   subroutine unload_from_inner_peak(spring, end_point)
      type(takeda_spring), intent(inout) :: spring
      !> Where the motion has turned, with signs
      type(point), intent(in) :: end_point

      associate (now => spring%now, branch => spring%branch, open => spring%open, at => spring%now%aim%at)
         if (abs(end_point%f) > no_force*spring%rule%f_y) then
            now%peaks = now%peaks + 1_int64
            at = end_point
            now%aim%side = now%side
            now%aim%number = now%peaks
            call open%push(now%aim)
         else if (abs(end_point%d - now%aim%start) > 0.0_wp) then
            ! It has moved along the axis: reload to the other side from here.
            call reload_from_inner(spring, -now%side, end_point)
            return
         else if (open%count > 0) then
            ! It has not moved since inner unloading reached zero force, which is not passed.
            now%aim = open%list(open%count)
            now%side = now%aim%side
         else
            ! No inner peak is open: on the outer unloading of the other side that it came from.
            now%side = -now%side
            call unload_from_peak(spring, now%peak(now%side))
            return
         end if
         now%branch = inner_unloading
         branch = segment(d0=at%d, f0=at%f, k=inner_stiffness(spring))
         call branch%lead_outward(now%side, near=at%d - at%f/branch%k, far=at%d, unload_on_reversal=.false.)
      end associate
   end subroutine unload_from_inner_peak

   !> K_in of the last inner peak within its bounds, of which the lower one has priority.
   real(wp) function inner_stiffness(spring) result(k_in)
      type(takeda_spring), intent(inout) :: spring
      real(wp) :: k_r, distance

      associate (rule => spring%rule, now => spring%now, peak => spring%now%aim%at)
         k_r = now%k_r(now%side)
         ! A side that has had no outer unloading has no K_r yet.
         if (.not. k_r > 0.0_wp) k_r = now%k_r(-now%side)
         select case (rule%inner)
         case (of_uncracked)
            k_in = rule%b1*rule%k_c
         case (of_outer)
            k_in = rule%b1*k_r
         case default
            k_in = k_r
         end select
         k_in = min(k_in, k_r)
         ! At ductilities of 1e16 round-off leaves no distance from the zero crossing.
         distance = now%side*(peak%d - now%aim%start)
         if (distance > 0.0_wp) k_in = max(k_in, now%side*peak%f/distance)
      end associate
   end function inner_stiffness

   !> Continue on the reloading branch that was left at an inner peak; it and all newer peaks are closed.
   subroutine resume_reloading(spring, place)
      type(takeda_spring), intent(inout) :: spring
      !> Place of the inner peak in the list of open turns
      integer, intent(in) :: place

      associate (now => spring%now, branch => spring%branch, open => spring%open)
         now%branch = reloading
         now%aim = open%list(place)
         now%side = now%aim%side
         branch = segment(d0=now%aim%goal%d, f0=now%aim%goal%f, k=now%aim%k)
         call branch%lead_outward(now%side, near=now%aim%at%d, far=now%aim%goal%d)
         open%count = place - 1
      end associate
   end subroutine resume_reloading

   !> Inner unloading has reached zero force: reload toward the newest open peak of side s, else toward its
   !> backbone peak. If the target were the yield point instead, inner loops would not close.
   subroutine reload_from_inner(spring, s, from)
      type(takeda_spring), intent(inout) :: spring
      integer, intent(in) :: s
      type(point), intent(in) :: from
      integer :: place

      associate (now => spring%now, open => spring%open)
         place = open%newest_of_side(s)
         if (place == 0) then
            call reload_toward_peak(spring, s, from, from%d)
         else
            now%aim = turn(goal=open%list(place)%at, goal_number=open%list(place)%number, start=from%d)
            call reload(spring, s, from)
         end if
      end associate
   end subroutine reload_from_inner

   !> Reload toward the backbone peak of side s.
   subroutine reload_toward_peak(spring, s, from, zero)
      type(takeda_spring), intent(inout) :: spring
      integer, intent(in) :: s
      !> Where the spring is, with signs
      type(point), intent(in) :: from
      !> Deformation at which the excursion to this side began, without force [m or rad]
      real(wp), intent(in) :: zero

      spring%now%aim = turn(goal=spring%now%peak(s), start=zero)
      call reload(spring, s, from)
   end subroutine reload_toward_peak

   !> The straight line on side s from a point to the target, `now%aim%goal`. The target is its anchor, so
   !> that a peak is met exactly.
   subroutine reload(spring, s, from)
      type(takeda_spring), intent(inout) :: spring
      integer, intent(in) :: s
      type(point), intent(in) :: from
      real(wp) :: distance, k

      associate (rule => spring%rule, now => spring%now, branch => spring%branch)
         now%branch = reloading
         now%side = s
         distance = now%aim%goal%d - from%d
         ! If round-off leaves no distance, the target is met at once.
         k = rule%k_c
         if (s*distance > 0.0_wp) k = (now%aim%goal%f - from%f)/distance
         now%aim%k = k
         branch = segment(d0=now%aim%goal%d, f0=now%aim%goal%f, k=k)
         call branch%lead_outward(s, near=from%d, far=s*max(s*now%aim%goal%d, s*from%d))
      end associate
   end subroutine reload

   !> Become a copy of the memory of another spring of this rule.
   pure subroutine copy(self, other)
      class(takeda_memory), intent(inout) :: self
      class(rule_memory), intent(in) :: other

      select type (other)
      type is (takeda_memory)
         self%now = other%now
         call self%open%copy(other%open, they_stay=.true.)
      end select
   end subroutine copy

   !> Save or restore the state and the open turns.
   pure subroutine serialize(self, stream)
      class(takeda_memory), intent(inout) :: self
      type(stream_type), intent(inout) :: stream
      integer :: s

      call stream%item(self%now%branch)
      call stream%item(self%now%side)
      call stream%item(self%now%cracked)
      do s = -1, 1, 2
         call self%now%peak(s)%serialize(stream)
      end do
      call stream%item(self%now%k_r)
      call self%now%aim%serialize(stream)
      call stream%item(self%now%peaks)
      call self%open%serialize(stream)
   end subroutine serialize

end module rbs_hysteresis_rules_takeda
