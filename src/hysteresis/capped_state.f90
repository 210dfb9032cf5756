!> Parameters and memory of a spring with a capped backbone, and what follows from them: stiffness of
!> unloading, goal and start of reloading, deterioration. `rbs_hysteresis_capped` moves it.
module rbs_hysteresis_capped_state
   use rbs_base_check, only: is_given
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_hysteresis_backbone, only: backbone_side
   use rbs_hysteresis_backbone_parameters, only: backbone_parameters
   use rbs_hysteresis_deterioration, only: deterioration_type
   use rbs_hysteresis_inner_peaks, only: point
   use rbs_hysteresis_open_turns, only: turn, open_turns
   use rbs_hysteresis_segment, only: segment
   implicit none
   private

   public :: capped_state

   !> Branches
   integer, parameter, public :: virgin = 0, on_backbone = 1, unloading = 2, reloading = 3, gap = 4

   !> Lines whose slopes are this close to each other do not meet.
   real(wp), parameter :: parallel = 1.0e-9_wp

   !> Least share of the unloading stiffness after deterioration.
   real(wp), parameter :: least_stiffness = 1.0e-6_wp

   !> Behind a turn where an inner loop was closed, unloading may end farther out than it could before by no
   !> more than this many times the way from there.
   real(wp), parameter :: release = 2.0_wp

   !> The share of the strength decays by no more than this over an excursion as long as d_y.
   real(wp), parameter :: decay_rate = 2.0_wp

   !> A target that has moved beyond this many times the end of softening is as good as infinitely distant.
   real(wp), parameter :: distant = 1.0e9_wp

   type :: capped_state
      !> Parameters of both sides
      type(backbone_parameters) :: given(-1:1)
      !> Exponent of the unloading stiffness over ductility
      real(wp) :: b0 = 0.0_wp
      type(deterioration_type) :: deterioration
      !> Work of the flexural spring that halves the strength that can decay [J], 0: none; share that stays;
      !> work of the flexural spring up to the last event
      real(wp) :: hinge_work = 0.0_wp, s_min = 0.0_wp, heard = 0.0_wp
      !> Whether reloading waits until the deformation is at this share of the permanent one
      logical :: slips = .false.
      real(wp) :: slip = 0.0_wp
      !> Stiffest virgin slope: no line is steeper [N/m or N m/rad]
      real(wp) :: k_0 = 0.0_wp
      !> Present backbones
      type(backbone_side) :: backbone(-1:1)
      !> Present branch and its side
      integer :: branch = virgin, side = 0
      !> Of each side, positive: deformation of the peak, which deterioration moves outward
      real(wp) :: peak(-1:1) = 0.0_wp
      !> The last turn, counted over both sides, and the oldest of those that the present reloading has closed
      integer :: time = 0, closed_time = huge(1)
      !> Work of the flexural spring up to cracking [J], and share of the strength of each side that its work
      !> since has left
      real(wp) :: heard_at_cracking = 0.0_wp, left_by_hinge(-1:1) = 1.0_wp
      !> Where the force was zero when the present side was entered, as seen from it, and way of the last
      !> excursion to the other side from there [m or rad]
      real(wp) :: entered = 0.0_wp, way_back = 0.0_wp
      !> Share that is left of 1/peak
      real(wp) :: target_left(-1:1) = 1.0_wp
      type(open_turns) :: open(-1:1)
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
   contains
      procedure :: initial_stiffness
      procedure :: unloading_stiffness
      procedure :: outermost_rest
      procedure :: spent_at
      procedure :: stiffness_left
      procedure :: virgin_unloading
      procedure :: deteriorate
      procedure :: least_start
      procedure :: find_turns
      procedure :: goal_from
      procedure :: copy_memory
      procedure :: serialize
   end type capped_state

contains

   !> Stiffness of the virgin part, of the stiffer side [N/m or N m/rad].
   pure real(wp) function initial_stiffness(self)
      class(capped_state), intent(in) :: self

      initial_stiffness = max(self%given(1)%stiffness(), self%given(-1)%stiffness())
   end function initial_stiffness

   !> Stiffness at which a turn unloads [N/m or N m/rad].
   pure real(wp) function unloading_stiffness(self, s, at) result(k)
      class(capped_state), intent(in) :: self
      integer, intent(in) :: s
      !> The turn, both positive
      type(point), intent(in) :: at
      real(wp) :: least

      k = self%virgin_unloading(s, max(self%peak(s), at%d))* &
          self%stiffness_left(max(self%worn, self%spent_at(at%f)))
      ! Unloading must not pass the deformation where loading started: that would create energy.
      least = self%outermost_rest(at%d)
      if (at%d > least) k = max(k, at%f/(at%d - least))
      k = min(k, self%k_0)
   end function unloading_stiffness

   !> The deformation, as seen from the side, that unloading from a deformation does not pass.
   pure real(wp) function outermost_rest(self, d)
      class(capped_state), intent(in) :: self
      real(wp), intent(in) :: d

      outermost_rest = max(self%start_at, self%closed_start - release*(d - self%closed_at))
   end function outermost_rest

   !> Energy that is dissipated at a turn: without what the stiffest unloading would return [J]. It never
   !> decreases along a line.
   pure real(wp) function spent_at(self, f)
      class(capped_state), intent(in) :: self
      real(wp), intent(in) :: f

      spent_at = 0.0_wp
      if (.not. self%yielded) return
      spent_at = self%dissipated(1) + self%dissipated(-1) + (self%work - self%work_at_zero) - &
                 0.5_wp*f**2/self%k_0
   end function spent_at

   !> Share of the unloading stiffness that deterioration has left.
   pure real(wp) function stiffness_left(self, spent) result(share)
      class(capped_state), intent(in) :: self
      !> Energy dissipated at the last turn [J]
      real(wp), intent(in) :: spent

      share = max(self%deterioration%left(self%deterioration%unloading, spent), least_stiffness)
   end function stiffness_left

   !> Unloading stiffness without deterioration from the largest deformation of a side: before yield toward
   !> the cracking force of the other side, after it decreasing with ductility [N/m or N m/rad].
   pure real(wp) function virgin_unloading(self, s, d) result(k)
      class(capped_state), intent(in) :: self
      integer, intent(in) :: s
      !> Positive
      real(wp), intent(in) :: d
      real(wp) :: f, beyond

      associate (own => self%given(s), other => self%given(-s))
         k = own%stiffness()
         if (d <= own%d_c .or. (d < own%d_y .and. .not. own%d_c > 0.0_wp)) return
         ! Where the elastic line of this side has the cracking force of the other.
         beyond = other%f_c/k
         if (d < own%d_y) then
            f = own%f_c + (own%f_y - own%f_c)*((d - own%d_c)/(own%d_y - own%d_c))
            k = (f + other%f_c)/(d + beyond)
         else
            k = (own%f_y + other%f_c)/(own%d_y + beyond)*(own%d_y/d)**self%b0
         end if
      end associate
   end function virgin_unloading

   !> The backbone and the peak of a side as they are after what the other side has dissipated.
   pure subroutine deteriorate(self, s)
      class(capped_state), intent(inout) :: self
      integer, intent(in) :: s
      real(wp) :: left, moved, worked

      associate (law => self%deterioration, energy => self%dissipated(-s), backbone => self%backbone(s), &
                 given => self%given(s))
         backbone%strength = law%strength_left(energy)
         if (self%hinge_work > 0.0_wp) then
            worked = max(self%heard - self%heard_at_cracking, 0.0_wp)/self%hinge_work
            left = self%s_min + (1.0_wp - self%s_min)/(1.0_wp + worked)
            ! After a small excursion to the other side little has changed.
            left = max(left, self%left_by_hinge(s) - decay_rate*max(self%way_back, 0.0_wp)/given%d_y)
            self%left_by_hinge(s) = min(left, self%left_by_hinge(s))
            backbone%strength = backbone%strength*self%left_by_hinge(s)
         end if
         backbone%softening = law%left(law%softening, energy)
         call backbone%draw()
         left = law%left(law%target, energy)
         if (left < self%target_left(s)) then
            moved = distant*(given%d_cap + given%d_pc)
            if (left*moved > self%peak(s)*self%target_left(s)) moved = self%peak(s)*self%target_left(s)/left
            if (is_given(given%d_u)) moved = min(moved, max(self%peak(s), given%d_u))
            moved = max(moved, self%peak(s))
            call self%open(s)%move_with_peak(self%peak(s), moved)
            self%peak(s) = moved
            self%target_left(s) = left
         end if
      end associate
   end subroutine deteriorate

   !> Where reloading of a part that slips starts at least: at a share of the permanent deformation, where
   !> unloading from the peak ends.
   pure real(wp) function least_start(self, s)
      class(capped_state), intent(in) :: self
      integer, intent(in) :: s
      real(wp) :: k

      k = self%virgin_unloading(s, self%peak(s))*self%stiffness_left(self%worn)
      least_start = self%slip*max(self%peak(s) - self%backbone(s)%force(self%peak(s))/k, 0.0_wp)
   end function least_start

   !> Put the open turns of a side on the lines as they are now.
   pure subroutine find_turns(self, s, least)
      class(capped_state), intent(inout) :: self
      integer, intent(in) :: s
      !> Lines start here or farther in
      real(wp), intent(in) :: least
      integer :: i

      do i = 1, self%open(s)%count
         associate (now => self%open(s)%list(i))
            ! That of the peak itself stays: unloading from it ends behind `least` in any case.
            if (now%at%d < now%goal%d) now%start = max(now%start, least)
            if (i == 1) then
               now%goal = self%goal_from(s, now%start)
            else
               now%goal = self%open(s)%list(i - 1)%at
            end if
            if (now%at%d >= now%goal%d) then
               now%at%f = self%backbone(s)%force(now%at%d)
            else if (now%at%d > now%start) then
               now%at%f = now%goal%f*((now%at%d - now%start)/(now%goal%d - now%start))
            end if
         end associate
      end do
   end subroutine find_turns

   !> The point of the backbone to which a line from zero force leads: the peak, or a corner beyond it if the
   !> line to it is steeper (as to yield in Takeda's rule).
   pure type(point) function goal_from(self, s, start) result(goal)
      class(capped_state), intent(in) :: self
      integer, intent(in) :: s
      !> As seen from the side
      real(wp), intent(in) :: start
      real(wp) :: slope
      integer :: i

      associate (backbone => self%backbone(s))
         goal = point(self%peak(s), backbone%force(self%peak(s)))
         slope = -1.0_wp
         if (goal%d > start) slope = goal%f/(goal%d - start)
         do i = 1, backbone%last
            if (backbone%d(i) <= max(self%peak(s), start)) cycle
            if (backbone%f(i) <= slope*(backbone%d(i) - start)) cycle
            goal = point(backbone%d(i), backbone%f(i))
            slope = goal%f/(goal%d - start)
         end do
         if (slope < 0.0_wp .or. slope > self%k_0*(1.0_wp + parallel)) then
            goal%d = backbone%meeting(self%k_0, start)
            goal%f = backbone%force(goal%d)
         end if
      end associate
   end function goal_from

   !> Copy the memory of another part with the same parameters.
   pure subroutine copy_memory(self, other)
      class(capped_state), intent(inout) :: self
      class(capped_state), intent(in) :: other
      integer :: s

      do s = -1, 1, 2
         self%backbone(s) = other%backbone(s)
         call self%open(s)%copy(other%open(s))
      end do
      self%branch = other%branch
      self%side = other%side
      self%peak = other%peak
      self%time = other%time
      self%closed_time = other%closed_time
      self%target_left = other%target_left
      self%heard = other%heard
      self%heard_at_cracking = other%heard_at_cracking
      self%left_by_hinge = other%left_by_hinge
      self%entered = other%entered
      self%way_back = other%way_back
      self%start_at = other%start_at
      self%goal = other%goal
      self%to_turn = other%to_turn
      self%closed_start = other%closed_start
      self%closed_at = other%closed_at
      self%work = other%work
      self%work_at_zero = other%work_at_zero
      self%begun = other%begun
      self%dissipated = other%dissipated
      self%yielded = other%yielded
      self%worn = other%worn
      self%left = other%left
      self%left_branch = other%left_branch
      self%turned = other%turned
   end subroutine copy_memory

   !> Save or restore all history variables.
   pure subroutine serialize(self, stream)
      class(capped_state), intent(inout) :: self
      type(stream_type), intent(inout) :: stream
      integer :: s

      do s = -1, 1, 2
         call self%backbone(s)%serialize(stream)
         call self%open(s)%serialize(stream)
      end do
      call stream%item(self%branch)
      call stream%item(self%side)
      call stream%item(self%peak)
      call stream%item(self%time)
      call stream%item(self%closed_time)
      call stream%item(self%target_left)
      call stream%item(self%heard)
      call stream%item(self%heard_at_cracking)
      call stream%item(self%left_by_hinge)
      call stream%item(self%entered)
      call stream%item(self%way_back)
      call stream%item(self%start_at)
      call self%goal%serialize(stream)
      call stream%item(self%to_turn)
      call stream%item(self%closed_start)
      call stream%item(self%closed_at)
      call stream%item(self%work)
      call stream%item(self%work_at_zero)
      call self%begun%serialize(stream)
      call stream%item(self%dissipated)
      call stream%item(self%yielded)
      call stream%item(self%worn)
      call self%left%serialize(stream)
      call stream%item(self%left_branch)
      call self%turned%serialize(stream)
   end subroutine serialize

end module rbs_hysteresis_capped_state
