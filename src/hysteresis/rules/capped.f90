!> The mechanics of springs with a capped backbone that reload toward their peaks, for the rules
!> `peak_oriented` and `pinching`, as a continuous function of their path. s is the side of the force:
!>
!>     virgin      elastic up to cracking or yield
!>     backbone    from corner to corner (`rbs_hysteresis_rules_backbone`); turning back: unloading
!>     unloading   both ways, to zero force, or back to its start, from where the line before continues
!>     gap         without force to where reloading starts, in a part that slips; on a side that carries
!>                 nothing as far as the motion goes, and back to where it began
!>     reloading   from zero force to the newest open turn of the side, on along the line that was left
!>                 there, so to all older ones, to the peak, then along the backbone; turning back: unloading
!>
!> Every inner loop closes at the turn where it began, on the line that it left, and wipes it out
!> (`rbs_hysteresis_rules_open_turns`). A turn is also forgotten once reloading starts as far out as its own
!> line did: there both lines are the same. So lines of reloading never become steeper on their way, unloading
!> ends at or before their start, and no loop gives energy. Deterioration
!> (`rbs_hysteresis_rules_deterioration`) acts where the force is zero, by an amount that is zero for an
!> excursion of size zero.
module rbs_hysteresis_rules_capped
   use, intrinsic :: iso_fortran_env, only: int64
   use rbs_base_constants, only: unbounded
   use rbs_base_kinds, only: wp
   use rbs_base_tolerances, only: no_force
   use rbs_hysteresis_rules_capped_lines, only: capped_part, capped_memory, capped_spring, capped_state, &
                                                deteriorate, find_turns, gap, goal_from, no_turn, &
                                                on_backbone, outermost_rest, reloading, spent_at, &
                                                stiffness_left, unloading, unloading_stiffness, virgin, &
                                                virgin_unloading
   use rbs_hysteresis_rules_open_turns, only: point, turn
   use rbs_hysteresis_segment, only: segment
   implicit none
   private

   public :: start_part, next_branch

contains

   !> The memory of a virgin part, and the branch that it is on.
   subroutine start_part(self, memory, branch)
      type(capped_part), intent(in) :: self
      type(capped_memory), intent(out) :: memory
      type(segment), intent(out) :: branch
      integer :: s

      do s = -1, 1, 2
         call memory%now%backbone(s)%draw(self%given(s))
         ! An untouched side reloads toward cracking or yield.
         memory%now%peak(s) = self%given(s)%d_c
         if (.not. memory%now%peak(s) > 0.0_wp) memory%now%peak(s) = self%given(s)%d_y
      end do
      branch = virgin_branch(self, memory%now, 1)
   end subroutine start_part

   !> The elastic line of a side up to its first corner; of both sides if they have the same slope.
   pure type(segment) function virgin_branch(self, now, s) result(branch)
      type(capped_part), intent(in) :: self
      type(capped_state), intent(in) :: now
      !> Side, +1 or -1
      integer, intent(in) :: s
      real(wp) :: near, far

      branch = segment(k=self%given(s)%stiffness())
      near = 0.0_wp
      if (.not. abs(branch%k - self%given(-s)%stiffness()) > 0.0_wp) near = -s*now%backbone(-s)%d(1)
      far = s*unbounded
      if (self%given(s)%carries()) far = s*now%backbone(s)%d(1)
      call branch%lead_outward(s, near=near, far=far, includes_near_end=near*s >= 0.0_wp, &
                               unload_on_reversal=.false.)
   end function virgin_branch

   !> The branch after the present one, which the motion leaves by its end in a direction: onward, or back
   !> from a reversal. `outward` means away from zero force on the present side.
   subroutine next_branch(self, memory, branch, direction)
      type(capped_part), intent(in), target :: self
      type(capped_memory), intent(inout), target :: memory
      !> The branch that ends, replaced by its successor
      type(segment), intent(inout), target :: branch
      !> +1: the motion goes up, -1: down
      integer, intent(in) :: direction
      type(capped_spring) :: spring
      type(point) :: end_point
      logical :: outward

      spring%part => self
      spring%now => memory%now
      spring%turns_of(-1:) => memory%open
      spring%branch => branch
      associate (now => memory%now)
         end_point%d = branch%end_toward(direction)
         end_point%f = branch%force(end_point%d)
         now%work = now%work + 0.5_wp*(end_point%f + now%begun%f)*(end_point%d - now%begun%d)
         now%begun = end_point
         outward = direction == now%side

         select case (now%branch)
         case (virgin)
            if (direction*end_point%d > 0.0_wp) then
               ! Earlier work of the flexural spring does not count: an uncracked spring has not decayed.
               now%work_at_cracking = now%flexural_work
               call follow_backbone(spring, direction, end_point)
            else
               now%side = direction
               branch = virgin_branch(self, now, direction)
            end if
         case (on_backbone)
            if (outward) then
               call follow_backbone(spring, direction, end_point)
            else
               call unload(spring, end_point)
            end if
         case (unloading)
            if (outward) then
               now%branch = now%left_branch
               branch = now%left
               call branch%lead_outward(now%side, near=end_point%d, far=now%left%end_toward(direction))
            else
               call end_excursion(spring, end_point%d)
            end if
         case (reloading)
            if (outward) then
               call go_on(spring, end_point)
            else
               call unload(spring, end_point)
            end if
         case default                                   ! in a gap
            if (outward) then
               call reload(spring)
            else
               now%distance_back = 0.0_wp
               call enter(spring, direction, end_point%d)
            end if
         end select
      end associate
   end subroutine next_branch

   !> On the backbone of side s (+1 or -1) from a point on.
   subroutine follow_backbone(spring, s, end_point)
      type(capped_spring), intent(inout) :: spring
      integer, intent(in) :: s
      !> Where the spring is, with signs
      type(point), intent(in) :: end_point
      real(wp) :: k

      associate (now => spring%now, branch => spring%branch, turns_of => spring%turns_of)
         now%side = s
         now%branch = on_backbone
         ! No turn of this side lies ahead any more.
         turns_of(s)%count = 0
         if (.not. now%yielded .and. s*end_point%d >= now%backbone(s)%d_y) then
            ! Energy dissipated before yield does not deteriorate the spring: counting begins with the work
            ! that unloading from here would leave.
            k = unloading_stiffness(spring, s, point(s*end_point%d, s*end_point%f))
            now%work_at_zero = now%work - 0.5_wp*end_point%f**2/k
            now%yielded = .true.
         end if
         branch = now%backbone(s)%line_from(s, end_point%d)
      end associate
   end subroutine follow_backbone

   !> The motion has turned back: unload toward zero force.
   subroutine unload(spring, end_point)
      type(capped_spring), intent(inout) :: spring
      !> Where it has turned, with signs; `at` is the same point with positive values
      type(point), intent(in) :: end_point
      type(point) :: at
      real(wp) :: k
      integer :: s

      associate (part => spring%part, now => spring%now, branch => spring%branch)
         s = now%side
         at = point(s*end_point%d, s*end_point%f)
         now%peak(s) = max(now%peak(s), at%d)
         now%worn = max(now%worn, spent_at(spring, at%f))
         now%turned = turn(at, start=now%start_at, goal=now%goal)
         now%left = branch
         now%left_branch = now%branch
         now%branch = unloading
         if (at%f <= no_force*part%given(s)%f_y) then
            ! There is no force to unload.
            call end_excursion(spring, end_point%d)
            return
         end if
         k = unloading_stiffness(spring, s, at)
         branch = segment(d0=end_point%d, f0=end_point%f, k=k)
         call branch%lead_outward(s, near=end_point%d - end_point%f/k, far=end_point%d, &
                                  unload_on_reversal=.false.)
      end associate
   end subroutine unload

   !> Zero force is reached: the excursion to the present side is over.
   subroutine end_excursion(spring, zero)
      type(capped_spring), intent(inout) :: spring
      !> Deformation there [m or rad]
      real(wp), intent(in) :: zero

      associate (now => spring%now, turns_of => spring%turns_of)
         if (now%yielded) now%dissipated(now%side) = now%dissipated(now%side) + (now%work - now%work_at_zero)
         now%work_at_zero = now%work
         call turns_of(-now%side)%fade(now%turned%at%d)
         ! A turn behind others that were closed takes the number of the oldest of them.
         now%turns = now%turns + 1_int64
         now%turned%number = min(now%closed, now%turns)
         call turns_of(now%side)%push(now%turned)
         ! The way of this excursion, which the other side looks back on.
         now%distance_back = now%turned%at%d - now%entered
         call enter(spring, -now%side, zero)
      end associate
   end subroutine end_excursion

   !> At zero force the motion goes on toward side s (+1 or -1), which deteriorates now: into a gap, or to
   !> reloading.
   subroutine enter(spring, s, zero)
      type(capped_spring), intent(inout) :: spring
      integer, intent(in) :: s
      !> Where the force is zero [m or rad]
      real(wp), intent(in) :: zero
      real(wp) :: least, k

      associate (part => spring%part, now => spring%now, branch => spring%branch, turns_of => spring%turns_of)
         now%side = s
         now%begun = point(zero, 0.0_wp)
         now%entered = s*zero
         if (.not. part%given(s)%carries()) then
            now%branch = gap
            branch = segment(d0=zero)
            call branch%lead_outward(s, near=zero, far=s*unbounded, unload_on_reversal=.false.)
            return
         end if
         if (part%deterioration%acts() .or. part%hinge_work > 0.0_wp) call deteriorate(spring, s)
         now%start_at = s*zero
         if (part%slips) then
            ! At a share of the permanent deformation, where unloading from the peak ends
            k = virgin_unloading(spring, s, now%peak(s))*stiffness_left(spring, now%worn)
            least = part%slip*max(now%peak(s) - now%backbone(s)%force(now%peak(s))/k, 0.0_wp)
            now%start_at = max(now%start_at, least)
            call find_turns(spring, s, least)
         else
            call find_turns(spring, s, -unbounded)
         end if
         call turns_of(s)%forget_inside(now%start_at)
         if (now%start_at > s*zero) then
            now%branch = gap
            branch = segment(d0=zero)
            call branch%lead_outward(s, near=zero, far=s*now%start_at)
         else
            call reload(spring)
         end if
      end associate
   end subroutine enter

   !> Start reloading at `start_at`, to the newest open turn of the side or, without one, to the peak.
   subroutine reload(spring)
      type(capped_spring), intent(inout) :: spring
      logical :: found

      associate (part => spring%part, now => spring%now, turns_of => spring%turns_of)
         now%branch = reloading
         now%closed_start = now%start_at
         now%closed_at = now%start_at
         now%closed = no_turn
         associate (s => now%side, turns => turns_of(now%side))
            do while (turns%count > 0)
               ! A turn that cannot be reached from here, not even along the virgin slope, is forgotten.
               call turns%list(turns%count)%shift(now%start_at, part%k_0, found)
               if (found) exit
               turns%count = turns%count - 1
            end do
            now%to_turn = turns%count > 0
            if (now%to_turn) then
               now%goal = turns%list(turns%count)%at
            else
               now%goal = goal_from(spring, s, now%start_at)
            end if
            call aim(spring, point(now%start_at, 0.0_wp))
         end associate
      end associate
   end subroutine reload

   !> Reloading has reached its goal: it goes on along the line that was left at that turn, or along the
   !> backbone.
   subroutine go_on(spring, end_point)
      type(capped_spring), intent(inout) :: spring
      !> The goal, with signs
      type(point), intent(in) :: end_point

      associate (now => spring%now, turns_of => spring%turns_of)
         associate (s => now%side, turns => turns_of(now%side))
            now%closed_start = outermost_rest(spring, s*end_point%d)
            now%closed_at = s*end_point%d
            if (now%to_turn) then
               ! The inner loop is closed.
               now%closed = turns%list(turns%count)%number
               call turns_of(-s)%let_fade(now%closed, s*end_point%d)
               now%start_at = turns%list(turns%count)%start
               now%goal = turns%list(turns%count)%goal
               turns%count = turns%count - 1
               now%to_turn = turns%count > 0
               call aim(spring, point(s*end_point%d, s*end_point%f))
            else
               ! On the backbone all turns of the other side fade.
               call turns_of(-s)%let_fade(0_int64, s*end_point%d)
               call follow_backbone(spring, s, end_point)
            end if
         end associate
      end associate
   end subroutine go_on

   !> The straight line from a point to the goal. The goal is its anchor, so that it is met exactly.
   subroutine aim(spring, from)
      type(capped_spring), intent(inout) :: spring
      !> As seen from the present side: positive values lie on it
      type(point), intent(in) :: from
      real(wp) :: distance, k

      associate (part => spring%part, now => spring%now, branch => spring%branch)
         associate (s => now%side, at => now%goal)
            distance = at%d - from%d
            ! If round-off leaves no distance, the goal is met at once. (0 + x turns a force of -0 into 0.)
            k = part%k_0
            if (distance > 0.0_wp) then
               k = (at%f - from%f)/distance
               branch = segment(d0=s*at%d, f0=0.0_wp + s*at%f, k=k)
            else
               branch = segment(d0=s*from%d, f0=0.0_wp + s*from%f, k=k)
            end if
            call branch%lead_outward(s, near=s*from%d, far=s*max(at%d, from%d))
         end associate
      end associate
   end subroutine aim

end module rbs_hysteresis_rules_capped
