!> The mechanics of springs with a capped backbone that reload toward their peaks, for the rules
!> `peak_oriented` and `pinching`, as a continuous function of their path. s is the side of the force:
!>
!>     virgin      elastic up to cracking or yield
!>     backbone    from corner to corner (`rbs_hysteresis_backbone`); turning back: unloading
!>     unloading   both ways, to zero force, or back to its start, from where the line before continues
!>     gap         without force to where reloading starts, in a part that slips
!>     reloading   from zero force to the newest open turn of the side, on along the line that was left
!>                 there, so to all older ones, to the peak, then along the backbone; turning back: unloading
!>
!> Every inner loop closes at the turn where it began, on the line that it left, and wipes it out
!> (`rbs_hysteresis_open_turns`). A turn is also forgotten once reloading starts as far out as its own line
!> did: there both lines are the same. So lines of reloading never become steeper on their way, unloading
!> ends at or before their start, and no loop gives energy. Deterioration (`rbs_hysteresis_deterioration`)
!> acts where the force is zero, by an amount that is zero for an excursion of size zero.
module rbs_hysteresis_capped
   use rbs_base_constants, only: unbounded
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_backbone, only: backbone_side
   use rbs_hysteresis_capped_state, only: capped_state, virgin, on_backbone, unloading, reloading, gap
   use rbs_hysteresis_inner_peaks, only: point
   use rbs_hysteresis_open_turns, only: turn
   use rbs_hysteresis_segment, only: segment
   implicit none
   private

   public :: capped_part

   !> Below this share of the yield force a reversal counts as one at zero force.
   real(wp), parameter :: no_force = 1.0e-12_wp

   type, extends(capped_state) :: capped_part
   contains
      procedure :: start
      procedure :: next
   end type capped_part

contains

   !> The line of the virgin part; clears the memory.
   subroutine start(self, line)
      class(capped_part), intent(inout) :: self
      type(segment), intent(out) :: line
      integer :: s

      do s = -1, 1, 2
         self%backbone(s) = backbone_side(given=self%given(s))
         call self%backbone(s)%draw()
         ! An untouched side reloads toward cracking or yield.
         self%peak(s) = self%given(s)%d_c
         if (.not. self%peak(s) > 0.0_wp) self%peak(s) = self%given(s)%d_y
      end do
      self%k_0 = self%initial_stiffness()
      self%branch = virgin
      self%side = 1
      self%time = 0
      self%closed_time = huge(1)
      self%target_left = 1.0_wp
      self%heard = 0.0_wp
      self%heard_at_cracking = 0.0_wp
      self%left_by_hinge = 1.0_wp
      self%entered = 0.0_wp
      self%way_back = 0.0_wp
      self%open%count = 0
      self%start_at = 0.0_wp
      self%to_turn = .false.
      self%closed_start = 0.0_wp
      self%closed_at = 0.0_wp
      self%work = 0.0_wp
      self%work_at_zero = 0.0_wp
      self%begun = point()
      self%dissipated = 0.0_wp
      self%yielded = .false.
      self%worn = 0.0_wp
      line = virgin_line(self, 1)
   end subroutine start

   !> The elastic line of a side; of both if they have the same slope.
   pure type(segment) function virgin_line(self, s) result(line)
      class(capped_part), intent(in) :: self
      integer, intent(in) :: s
      real(wp) :: near

      line = segment(k=self%given(s)%stiffness())
      near = 0.0_wp
      if (.not. abs(line%k - self%given(-s)%stiffness()) > 0.0_wp) near = -s*self%backbone(-s)%d(1)
      line = line%outward(s, near=near, far=s*self%backbone(s)%d(1), near_closed=near*s >= 0.0_wp, &
                          one_way=.false.)
   end function virgin_line

   !> The line that follows, see `rule_type`.
   subroutine next(self, line, direction)
      class(capped_part), intent(inout) :: self
      type(segment), intent(inout) :: line
      integer, intent(in) :: direction
      type(point) :: here
      logical :: outward

      here%d = line%end_toward(direction)
      here%f = line%force(here%d)
      self%work = self%work + 0.5_wp*(here%f + self%begun%f)*(here%d - self%begun%d)
      self%begun = here
      outward = direction == self%side

      select case (self%branch)
      case (virgin)
         if (direction*here%d > 0.0_wp) then
            ! What the flexural spring did before counts for nothing: an uncracked spring has not decayed.
            self%heard_at_cracking = self%heard
            call follow_backbone(self, line, direction, here)
         else
            self%side = direction
            line = virgin_line(self, direction)
         end if
      case (on_backbone)
         if (outward) then
            call follow_backbone(self, line, direction, here)
         else
            call unload(self, line, here)
         end if
      case (unloading)
         if (outward) then
            self%branch = self%left_branch
            line = self%left%outward(self%side, near=here%d, far=self%left%end_toward(direction), &
                                     near_closed=.true., one_way=.true.)
         else
            call end_excursion(self, line, here%d)
         end if
      case (reloading)
         if (outward) then
            call go_on(self, line, here)
         else
            call unload(self, line, here)
         end if
      case default                                   ! in a gap
         if (outward) then
            call reload(self, line)
         else
            self%way_back = 0.0_wp
            call enter(self, line, direction, here%d)
         end if
      end select
   end subroutine next

   !> On the backbone of side s from a point on.
   subroutine follow_backbone(self, line, s, here)
      class(capped_part), intent(inout) :: self
      type(segment), intent(inout) :: line
      integer, intent(in) :: s
      type(point), intent(in) :: here
      real(wp) :: k

      self%side = s
      self%branch = on_backbone
      ! No turn of this side lies ahead any more.
      self%open(s)%count = 0
      if (.not. self%yielded .and. s*here%d >= self%backbone(s)%d_y) then
         ! What was dissipated before yield does not deteriorate.
         k = self%unloading_stiffness(s, point(s*here%d, s*here%f))
         self%work_at_zero = self%work - 0.5_wp*here%f**2/k
         self%yielded = .true.
      end if
      line = self%backbone(s)%line_from(s, here%d)
   end subroutine follow_backbone

   !> The motion has turned back: unload toward zero force.
   subroutine unload(self, line, here)
      class(capped_part), intent(inout) :: self
      type(segment), intent(inout) :: line
      type(point), intent(in) :: here
      type(point) :: at
      real(wp) :: k
      integer :: s

      s = self%side
      at = point(s*here%d, s*here%f)
      self%peak(s) = max(self%peak(s), at%d)
      self%worn = max(self%worn, self%spent_at(at%f))
      self%turned = turn(at, self%start_at, self%goal)
      self%left = line
      self%left_branch = self%branch
      self%branch = unloading
      if (at%f <= no_force*self%given(s)%f_y) then
         ! There is no force to unload.
         call end_excursion(self, line, here%d)
         return
      end if
      k = self%unloading_stiffness(s, at)
      line = segment(d0=here%d, f0=here%f, k=k)
      line = line%outward(s, near=here%d - here%f/k, far=here%d, near_closed=.true., one_way=.false.)
   end subroutine unload

   !> Zero force is reached: the excursion to the present side is over.
   subroutine end_excursion(self, line, zero)
      class(capped_part), intent(inout) :: self
      type(segment), intent(inout) :: line
      real(wp), intent(in) :: zero

      associate (s => self%side)
         if (self%yielded) self%dissipated(s) = self%dissipated(s) + (self%work - self%work_at_zero)
         self%work_at_zero = self%work
         call self%open(-s)%fade(self%turned%at%d)
         ! A turn behind others that were closed takes their place.
         self%time = modulo(self%time, huge(1) - 1) + 1
         self%turned%time = min(self%closed_time, self%time)
         call self%open(s)%push(self%turned)
         self%way_back = self%turned%at%d - self%entered
         call enter(self, line, -s, zero)
      end associate
   end subroutine end_excursion

   !> Without force the motion goes toward side s, which deteriorates.
   subroutine enter(self, line, s, zero)
      class(capped_part), intent(inout) :: self
      type(segment), intent(inout) :: line
      integer, intent(in) :: s
      !> Where the force is zero [m or rad]
      real(wp), intent(in) :: zero
      real(wp) :: least

      self%side = s
      self%begun = point(zero, 0.0_wp)
      self%entered = s*zero
      if (self%deterioration%acts() .or. self%hinge_work > 0.0_wp) call self%deteriorate(s)
      self%start_at = s*zero
      if (self%slips) then
         least = self%least_start(s)
         self%start_at = max(self%start_at, least)
         call self%find_turns(s, least)
      else
         call self%find_turns(s, -unbounded)
      end if
      call self%open(s)%forget_inside(self%start_at)
      if (self%start_at > s*zero) then
         self%branch = gap
         line = segment(d0=zero)
         line = line%outward(s, near=zero, far=s*self%start_at, near_closed=.true., one_way=.true.)
      else
         call reload(self, line)
      end if
   end subroutine enter

   !> Start reloading, to the newest open turn or the peak.
   subroutine reload(self, line)
      class(capped_part), intent(inout) :: self
      type(segment), intent(inout) :: line
      logical :: found

      self%branch = reloading
      self%closed_start = self%start_at
      self%closed_at = self%start_at
      self%closed_time = huge(1)
      associate (s => self%side, open => self%open(self%side))
         do while (open%count > 0)
            call open%list(open%count)%shift(self%start_at, self%k_0, found)
            if (found) exit
            open%count = open%count - 1
         end do
         self%to_turn = open%count > 0
         if (self%to_turn) then
            self%goal = open%list(open%count)%at
         else
            self%goal = self%goal_from(s, self%start_at)
         end if
         call aim(self, line, point(self%start_at, 0.0_wp))
      end associate
   end subroutine reload

   !> The goal of reloading is reached.
   subroutine go_on(self, line, here)
      class(capped_part), intent(inout) :: self
      type(segment), intent(inout) :: line
      type(point), intent(in) :: here

      associate (s => self%side, open => self%open(self%side))
         self%closed_start = self%outermost_rest(s*here%d)
         self%closed_at = s*here%d
         if (self%to_turn) then
            ! The inner loop is closed.
            self%closed_time = open%list(open%count)%time
            call self%open(-s)%let_fade(self%closed_time, s*here%d)
            self%start_at = open%list(open%count)%start
            self%goal = open%list(open%count)%goal
            open%count = open%count - 1
            self%to_turn = open%count > 0
            call aim(self, line, point(s*here%d, s*here%f))
         else
            call self%open(-s)%let_fade(0, s*here%d)
            call follow_backbone(self, line, s, here)
         end if
      end associate
   end subroutine go_on

   !> The straight line to the goal. That point is its anchor, so that it is met exactly.
   subroutine aim(self, line, from)
      class(capped_part), intent(in) :: self
      type(segment), intent(inout) :: line
      !> As seen from the side
      type(point), intent(in) :: from
      real(wp) :: way, k

      associate (s => self%side, at => self%goal)
         way = at%d - from%d
         ! If round-off leaves no distance, the point is met at once.
         k = self%k_0
         if (way > 0.0_wp) then
            k = (at%f - from%f)/way
            line = segment(d0=s*at%d, f0=0.0_wp + s*at%f, k=k)
         else
            line = segment(d0=s*from%d, f0=0.0_wp + s*from%f, k=k)
         end if
         line = line%outward(s, near=s*from%d, far=s*max(at%d, from%d), near_closed=.true., one_way=.true.)
      end associate
   end subroutine aim

end module rbs_hysteresis_capped
