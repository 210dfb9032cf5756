!> Parts with a capped backbone, see `rbs_hysteresis_rules_capped`: parameters and state, and the lines that
!> follow from them: slopes of unloading, goals of reloading, backbones and open turns after deterioration.
module rbs_hysteresis_rules_capped_lines
   use, intrinsic :: iso_fortran_env, only: int64
   use rbs_base_check, only: is_given
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_base_tolerances, only: parallel
   use rbs_hysteresis_rules_backbone, only: backbone_side, backbone_parameters
   use rbs_hysteresis_rules_deterioration, only: deterioration_type
   use rbs_hysteresis_rules_open_turns, only: point, turn, open_turns
   use rbs_hysteresis_segment, only: segment
   implicit none
   private

   public :: capped_part, capped_memory, capped_spring, capped_state
   public :: deteriorate, find_turns, goal_from, no_turn, outermost_rest, spent_at, stiffness_left
   public :: unloading_stiffness, virgin_unloading

   !> Branches
   integer, parameter, public :: virgin = 0, on_backbone = 1, unloading = 2, reloading = 3, gap = 4

   !> More than there can be turns; as a real number it is exact.
   integer(int64), parameter :: no_turn = 2_int64**53

   !> Least share of the unloading stiffness after deterioration.
   real(wp), parameter :: least_stiffness = 1.0e-6_wp

   !> Behind a turn where an inner loop was closed, unloading may end farther out than it could before by no
   !> more than this many times the way from there.
   real(wp), parameter :: release = 2.0_wp

   !> The share of the strength decays by no more than this over an excursion as long as d_y.
   real(wp), parameter :: decay_rate = 2.0_wp

   !> A target that has moved beyond this many times the end of softening is as good as infinitely distant.
   real(wp), parameter :: distant = 1.0e9_wp

   !> The parameters of a part.
   type :: capped_part
      !> Of both sides
      type(backbone_parameters) :: given(-1:1) = [ &
         backbone_parameters(), backbone_parameters(), &
         backbone_parameters(f_res=0.0_wp, d_c=0.0_wp, f_c=0.0_wp)]
      !> Exponent of the unloading stiffness over ductility
      real(wp) :: b0 = 0.0_wp
      type(deterioration_type) :: deterioration
      !> Work of the flexural spring that halves the strength that can decay [J], 0: none; share that stays
      real(wp) :: hinge_work = 0.0_wp, s_min = 0.0_wp
      !> Whether reloading waits until the deformation is at this share of the permanent one
      logical :: slips = .false.
      real(wp) :: slip = 0.0_wp
      !> Stiffest virgin slope: no branch is steeper [N/m or N m/rad]
      real(wp) :: k_0 = 0.0_wp
   end type capped_part

   !> Where a part is.
   type :: capped_state
      !> Present backbones
      type(backbone_side) :: backbone(-1:1)
      !> Present branch and its side
      integer :: branch = virgin, side = 1
      !> Of each side, positive: deformation of the peak, which deterioration moves outward
      real(wp) :: peak(-1:1) = 0.0_wp
      !> Turns of both sides so far, and the oldest of those that the present reloading has closed
      integer(int64) :: turns = 0_int64, closed = no_turn
      !> Work of the flexural spring so far and up to cracking [J], and share of the strength of each side
      !> that its work since has left
      real(wp) :: flexural_work = 0.0_wp, work_at_cracking = 0.0_wp, left_by_hinge(-1:1) = 1.0_wp
      !> Where the force was zero when the present side was entered, as seen from it, and way of the last
      !> excursion to the other side from there [m or rad]
      real(wp) :: entered = 0.0_wp, distance_back = 0.0_wp
      !> Share that is left of 1/peak
      real(wp) :: target_left(-1:1) = 1.0_wp
      !> Start and goal of the present line of reloading, as seen from its side; whether that is an open turn
      real(wp) :: start_at = 0.0_wp
      type(point) :: goal
      logical :: to_turn = .false.
      !> Where unloading had to end at least when the last inner loop was closed, and where that was
      real(wp) :: closed_start = 0.0_wp, closed_at = 0.0_wp
      !> Work so far, work at the last crossing of zero force [J], and start of the present line
      real(wp) :: work = 0.0_wp, work_at_zero = 0.0_wp
      type(point) :: begun
      !> Energy dissipated by completed excursions to each side since the first yield [J]
      real(wp) :: dissipated(-1:1) = 0.0_wp
      logical :: yielded = .false.
      !> The same of all excursions when the motion last turned, which the unloading stiffness follows [J]
      real(wp) :: worn = 0.0_wp
      !> The line that was left by unloading, its branch, and the turn there
      type(segment) :: left
      integer :: left_branch = virgin
      type(turn) :: turned
   end type capped_state

   type :: capped_memory
      type(capped_state) :: now
      !> Of each side, the turns whose loops are still open
      type(open_turns) :: open(-1:1)
   contains
      procedure :: copy, serialize
   end type capped_memory

   !> A spring at an event: its part, and the state that the event changes.
   type :: capped_spring
      type(capped_part), pointer :: part => null()
      type(capped_state), pointer :: now => null()
      !> Open turns of each side (-1:1)
      type(open_turns), pointer :: turns_of(:) => null()
      type(segment), pointer :: branch => null()
   end type capped_spring

contains

   !> Stiffness at which a turn unloads [N/m or N m/rad].
   real(wp) function unloading_stiffness(spring, s, at) result(k)
      type(capped_spring), intent(inout) :: spring
      !> Side, +1 or -1
      integer, intent(in) :: s
      !> The turn, both values positive
      type(point), intent(in) :: at
      real(wp) :: least

      k = virgin_unloading(spring, s, max(spring%now%peak(s), at%d))* &
          stiffness_left(spring, max(spring%now%worn, spent_at(spring, at%f)))
      ! Unloading must not pass the deformation where loading started: that would create energy.
      least = outermost_rest(spring, at%d)
      if (at%d > least) k = max(k, at%f/(at%d - least))
      k = min(k, spring%part%k_0)
   end function unloading_stiffness

   !> The deformation that unloading from a deformation d does not pass, both as seen from the present side.
   real(wp) function outermost_rest(spring, d)
      type(capped_spring), intent(inout) :: spring
      real(wp), intent(in) :: d

      outermost_rest = max(spring%now%start_at, spring%now%closed_start - release*(d - spring%now%closed_at))
   end function outermost_rest

   !> Energy that is dissipated when the motion turns here, after an unloading along the stiffest slope [J];
   !> zero before yield. It never decreases along a line.
   real(wp) function spent_at(spring, f)
      type(capped_spring), intent(inout) :: spring
      !> Present force [N or N m]
      real(wp), intent(in) :: f

      associate (part => spring%part, now => spring%now)
         spent_at = 0.0_wp
         if (.not. now%yielded) return
         spent_at = now%dissipated(1) + now%dissipated(-1) + (now%work - now%work_at_zero) - &
                    0.5_wp*f**2/part%k_0
      end associate
   end function spent_at

   !> Share of the unloading stiffness that deterioration has left.
   real(wp) function stiffness_left(spring, spent) result(share)
      type(capped_spring), intent(inout) :: spring
      !> Energy dissipated at the last turn [J]
      real(wp), intent(in) :: spent

      share = max(spring%part%deterioration%left(spring%part%deterioration%unloading, spent), least_stiffness)
   end function stiffness_left

   !> Unloading stiffness without deterioration from the largest deformation of a side: before yield toward
   !> the cracking force of the other side, after it decreasing with ductility [N/m or N m/rad].
   real(wp) function virgin_unloading(spring, s, d) result(k)
      type(capped_spring), intent(inout) :: spring
      !> Side, +1 or -1
      integer, intent(in) :: s
      !> Largest deformation of that side, positive [m or rad]
      real(wp), intent(in) :: d
      real(wp) :: f, beyond

      associate (side => spring%part%given(s), opposite => spring%part%given(-s))
         k = side%stiffness()
         if (d <= side%d_c .or. (d < side%d_y .and. .not. side%d_c > 0.0_wp)) return
         ! How far beyond zero the elastic line has the cracking force of the opposite side.
         beyond = opposite%f_c/k
         if (d < side%d_y) then
            f = side%f_c + (side%f_y - side%f_c)*((d - side%d_c)/(side%d_y - side%d_c))
            k = (f + opposite%f_c)/(d + beyond)
         else
            k = (side%f_y + opposite%f_c)/(side%d_y + beyond)*(side%d_y/d)**spring%part%b0
         end if
      end associate
   end function virgin_unloading

   !> Draw the backbone of side s anew after the dissipation on the other side, and move its peak outward.
   subroutine deteriorate(spring, s)
      type(capped_spring), intent(inout) :: spring
      integer, intent(in) :: s
      real(wp) :: left, moved, worked

      associate (part => spring%part, now => spring%now, turns_of => spring%turns_of)
         associate (law => part%deterioration, energy => now%dissipated(-s), backbone => now%backbone(s), &
                    given => part%given(s))
            backbone%strength = law%strength_left(energy)
            if (part%hinge_work > 0.0_wp) then
               worked = max(now%flexural_work - now%work_at_cracking, 0.0_wp)/part%hinge_work
               left = part%s_min + (1.0_wp - part%s_min)/(1.0_wp + worked)
               ! After a small excursion to the other side little has changed.
               left = max(left, now%left_by_hinge(s) - decay_rate*max(now%distance_back, 0.0_wp)/given%d_y)
               now%left_by_hinge(s) = min(left, now%left_by_hinge(s))
               backbone%strength = backbone%strength*now%left_by_hinge(s)
            end if
            backbone%softening = law%left(law%softening, energy)
            call backbone%draw(given)
            left = law%left(law%target, energy)
            if (left < now%target_left(s)) then
               ! The peak grows as the share that is left of 1/peak falls; not beyond all meaning, and not
               ! beyond rupture.
               moved = distant*(given%d_cap + given%d_pc)
               if (left*moved > now%peak(s)*now%target_left(s)) moved = now%peak(s)*now%target_left(s)/left
               if (is_given(given%d_u)) moved = min(moved, max(now%peak(s), given%d_u))
               moved = max(moved, now%peak(s))
               call turns_of(s)%move_with_peak(now%peak(s), moved)
               now%peak(s) = moved
               now%target_left(s) = left
            end if
         end associate
      end associate
   end subroutine deteriorate

   !> Put the open turns of side s on the present lines: each on the line to the turn that is next older, the
   !> oldest on the line to the backbone.
   subroutine find_turns(spring, s, least)
      type(capped_spring), intent(inout) :: spring
      integer, intent(in) :: s
      !> The lines do not start before this deformation, as seen from the side
      real(wp), intent(in) :: least
      integer :: i

      do i = 1, spring%turns_of(s)%count
         associate (turned => spring%turns_of(s)%list(i))
            ! A turn at the peak itself stays: unloading from it ends behind `least` in any case.
            if (turned%at%d < turned%goal%d) turned%start = max(turned%start, least)
            if (i == 1) then
               turned%goal = goal_from(spring, s, turned%start)
            else
               turned%goal = spring%turns_of(s)%list(i - 1)%at
            end if
            if (turned%at%d >= turned%goal%d) then
               turned%at%f = spring%now%backbone(s)%force(turned%at%d)
            else if (turned%at%d > turned%start) then
               turned%at%f = turned%goal%f*((turned%at%d - turned%start)/(turned%goal%d - turned%start))
            end if
         end associate
      end do
   end subroutine find_turns

   !> The point of the backbone to which a line from zero force leads: the peak, or a corner beyond it if
   !> the line to it is steeper (as to yield in Takeda's rule).
   type(point) function goal_from(spring, s, start) result(goal)
      type(capped_spring), intent(inout) :: spring
      integer, intent(in) :: s
      !> Deformation at which the line has no force, as seen from side s
      real(wp), intent(in) :: start
      real(wp) :: slope
      integer :: i

      associate (part => spring%part, now => spring%now)
         associate (backbone => now%backbone(s))
            goal = point(now%peak(s), backbone%force(now%peak(s)))
            ! A slope of -1: there is no line yet.
            slope = -1.0_wp
            if (goal%d > start) slope = goal%f/(goal%d - start)
            do i = 1, backbone%last
               ! Only corners beyond the peak and above the line.
               if (backbone%d(i) <= max(now%peak(s), start)) cycle
               if (backbone%f(i) <= slope*(backbone%d(i) - start)) cycle
               goal = point(backbone%d(i), backbone%f(i))
               slope = goal%f/(goal%d - start)
            end do
            if (slope < 0.0_wp .or. slope > part%k_0*(1.0_wp + parallel)) then
               ! No line is steeper than the virgin spring.
               goal%d = backbone%meeting(part%k_0, start)
               goal%f = backbone%force(goal%d)
            end if
         end associate
      end associate
   end function goal_from

   !> Become a copy of another memory. Open turns move with deterioration, so all of them are copied.
   pure subroutine copy(self, other)
      class(capped_memory), intent(inout) :: self
      type(capped_memory), intent(in) :: other
      integer :: s

      self%now = other%now
      do s = -1, 1, 2
         call self%open(s)%copy(other%open(s), they_stay=.false.)
      end do
   end subroutine copy

   !> Save or restore the state and the open turns of both sides.
   pure subroutine serialize(self, stream)
      class(capped_memory), intent(inout) :: self
      type(stream_type), intent(inout) :: stream
      integer :: s

      associate (now => self%now)
         do s = -1, 1, 2
            call now%backbone(s)%serialize(stream)
            call self%open(s)%serialize(stream)
         end do
         call stream%item(now%branch)
         call stream%item(now%side)
         call stream%item(now%peak)
         call stream%item(now%turns)
         call stream%item(now%closed)
         call stream%item(now%target_left)
         call stream%items(now%flexural_work, now%work_at_cracking)
         call stream%item(now%left_by_hinge)
         call stream%items(now%entered, now%distance_back, now%start_at)
         call now%goal%serialize(stream)
         call stream%item(now%to_turn)
         call stream%items(now%closed_start, now%closed_at, now%work, now%work_at_zero)
         call now%begun%serialize(stream)
         call stream%item(now%dissipated)
         call stream%item(now%yielded)
         call stream%item(now%worn)
         call now%left%serialize(stream)
         call stream%item(now%left_branch)
         call now%turned%serialize(stream)
      end associate
   end subroutine serialize

end module rbs_hysteresis_rules_capped_lines
