!> Peak-oriented spring with a capped backbone and cyclic deterioration: Ibarra, Medina, Krawinkler 2005
!> (Earthquake Eng. Struct. Dyn. 34, 1489-1511), with a cracking point and an unloading stiffness that may
!> decrease with ductility (Takeda 1970). s is the side of the force:
!>
!>     virgin      elastic up to cracking or yield
!>     backbone    from corner to corner (`rbs_hysteresis_backbone`); turning back: unloading
!>     unloading   both ways, to zero force, or back to its start, from where the line before continues
!>     reloading   from zero force to the last peak of the side if the line to it is steeper, then to the
!>                 largest peak, then along the backbone; turning back: unloading
!>     dead        no force left
!>
!> Deterioration (`rbs_hysteresis_deterioration`) acts where the force is zero, so that no force jumps: at the
!> end of an excursion the side that is entered deteriorates. Only the unloading stiffness is computed where
!> the motion turns back; it is stored when zero force is reached, so partial unloading has no effect.
module rbs_hysteresis_peak_oriented
   use rbs_base_check, only: is_given
   use rbs_base_error, only: message_list
   use rbs_base_keys, only: key_type, bound_type, not_negative, share_below_one
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_backbone, only: backbone_side
   use rbs_hysteresis_backbone_parameters, only: backbone_parameters, backbone_keys, other_side_keys, &
                                                  from_values
   use rbs_hysteresis_deterioration, only: deterioration_type
   use rbs_hysteresis_inner_peaks, only: point
   use rbs_hysteresis_rule, only: rule_type, places_length, in_shear, in_flexure
   use rbs_hysteresis_segment, only: segment
   implicit none
   private

   public :: peak_oriented_rule, capped_keys

   integer, parameter :: virgin = 0, on_backbone = 1, unloading = 2, reloading = 3, dead = 4

   !> Marks a point that does not exist; seen from its side every existing point is positive.
   type(point), parameter :: no_point = point(-1.0_wp, 0.0_wp)

   !> Below this share of the yield force a reversal counts as one at zero force.
   real(wp), parameter :: no_force = 1.0e-12_wp

   !> Lines whose slopes are this close to each other do not meet.
   real(wp), parameter :: parallel = 1.0e-9_wp

   !> Least share of the unloading stiffness after deterioration; normally the chord back to the start of the
   !> excursion limits it much earlier.
   real(wp), parameter :: least_stiffness = 1.0e-6_wp

   character(len=*), parameter :: small_excursions = '(small excursions would count too much)'

   !> Parameters of this rule and of those that extend it: of the positive side, of both sides, of the
   !> negative side.
   type(key_type), parameter :: shared_keys(8) = [ &
      key_type('b0', bound=not_negative, default=0.0_wp, &
               meaning='exponent of the unloading stiffness over ductility'), &
      key_type('lambda_s', bound=not_negative, default=0.0_wp, &
               meaning='energy over f_y d_y that deterioration of the strength lasts for; 0: none'), &
      key_type('lambda_c', bound=not_negative, default=0.0_wp, &
               meaning='the same for the softening line behind the cap'), &
      key_type('lambda_k', bound=not_negative, default=0.0_wp, &
               meaning='the same for the unloading stiffness'), &
      key_type('lambda_a', bound=not_negative, default=0.0_wp, &
               meaning='the same for the target of reloading'), &
      key_type('c', bound=bound_type(least=1.0_wp, reason=small_excursions), default=1.0_wp, &
               meaning='exponent of deterioration'), &
      key_type('lambda_h', bound=not_negative, default=0.0_wp, &
               meaning='work of the flexural spring over f_y d_y that halves what can decay; 0: none'), &
      key_type('s_min', bound=share_below_one, default=0.0_wp, &
               meaning='share of the strength that stays, whatever the flexural spring has done')]
   integer, parameter :: sides = size(backbone_keys), shared = size(shared_keys)
   type(key_type), parameter :: capped_keys(*) = [backbone_keys, shared_keys, other_side_keys]

   type, extends(rule_type) :: peak_oriented_rule
      !> Exponent of the unloading stiffness over ductility
      real(wp) :: b0 = 0.0_wp
      type(deterioration_type) :: deterioration
      !> Work of the flexural spring that halves what can decay [J], 0: none; share that stays
      real(wp) :: hinge_work = 0.0_wp, s_min = 0.0_wp
      !> Work of the flexural spring up to the last event, and up to cracking [J]
      real(wp), private :: heard = 0.0_wp, heard_at_cracking = 0.0_wp
      !> Of each side: share of the strength that the work of the flexural spring has left
      real(wp), private :: left_by_hinge(-1:1) = 1.0_wp
      !> Parameters of both sides
      type(backbone_parameters), private :: given(-1:1)
      !> Present backbones
      type(backbone_side), private :: backbone(-1:1)
      !> Stiffest virgin slope: no line is steeper [N/m or N m/rad]
      real(wp), private :: k_0 = 0.0_wp
      !> Present branch and its side
      integer, private :: branch = virgin, side = 0
      !> Of each side, positive: deformation of the largest peak, and last point where reloading turned back
      real(wp), private :: peak(-1:1) = 0.0_wp
      type(point), private :: turned(-1:1) = no_point
      !> Of each side: whether it has been on its backbone
      logical, private :: loaded(-1:1) = .false.
      !> Whether the spring has yielded, on either side
      logical, private :: yielded = .false.
      !> Factor on the unloading stiffness, now and from the next zero force on
      real(wp), private :: stiffness_left = 1.0_wp, stiffness_next = 1.0_wp
      !> Work since the last crossing of zero force [J], the crossing, and the start of the present line
      real(wp), private :: excursion = 0.0_wp, zero = 0.0_wp
      type(point), private :: begun
      !> The line that was left by unloading, its branch, and whether its target is the largest peak
      type(segment), private :: left
      integer, private :: left_branch = virgin
      logical, private :: aims_at_peak = .true.
   contains
      procedure, nopass :: keys
      procedure, nopass :: places
      procedure :: set
      procedure :: initial_stiffness
      procedure :: check
      procedure :: start
      procedure :: next
      procedure :: unloading_stiffness
      procedure :: break_point
      procedure :: hears
      procedure :: hear
   end type peak_oriented_rule

contains

   pure function keys()
      type(key_type), allocatable :: keys(:)

      keys = capped_keys
   end function keys

   pure function places()
      character(len=places_length) :: places

      places = in_shear//' '//in_flexure
   end function places

   pure subroutine set(self, value)
      class(peak_oriented_rule), intent(inout) :: self
      real(wp), intent(in) :: value(:)
      real(wp) :: energy

      associate (positive => value(:sides), negative => value(sides + shared + 1:2*sides + shared))
         self%given(1) = from_values(positive)
         self%given(-1) = from_values(merge(negative, positive, is_given(negative)))
      end associate
      self%b0 = value(sides + 1)
      energy = 0.5_wp*(self%given(1)%f_y*self%given(1)%d_y + self%given(-1)%f_y*self%given(-1)%d_y)
      associate (lambda => value(sides + 2:sides + 5))
         self%deterioration = deterioration_type(lambda(1)*energy, lambda(2)*energy, lambda(3)*energy, &
                                                 lambda(4)*energy, value(sides + 6))
      end associate
      self%hinge_work = value(sides + 7)*energy
      self%s_min = value(sides + 8)
   end subroutine set

   pure real(wp) function initial_stiffness(self)
      class(peak_oriented_rule), intent(in) :: self

      initial_stiffness = max(self%given(1)%stiffness(), self%given(-1)%stiffness())
   end function initial_stiffness

   subroutine check(self, name, messages)
      class(peak_oriented_rule), intent(in) :: self
      character(len=*), intent(in) :: name
      type(message_list), intent(inout) :: messages
      integer :: known

      known = messages%count
      call self%given(1)%check(name, '', messages)
      ! Otherwise errors of the positive side would be reported twice.
      if (messages%count == known) call self%given(-1)%check(name, '_neg', messages)
   end subroutine check

   subroutine start(self, line)
      class(peak_oriented_rule), intent(inout) :: self
      type(segment), intent(out) :: line
      integer :: s

      do s = -1, 1, 2
         self%backbone(s) = backbone_side(given=self%given(s))
         call self%backbone(s)%draw()
         ! An untouched side reloads toward cracking, or yield (see `reload`).
         self%peak(s) = self%given(s)%d_c
      end do
      self%k_0 = self%initial_stiffness()
      self%branch = virgin
      self%side = 1
      self%turned = no_point
      self%loaded = .false.
      self%yielded = .false.
      self%stiffness_left = 1.0_wp
      self%deterioration%spent = 0.0_wp
      self%heard = 0.0_wp
      self%heard_at_cracking = 0.0_wp
      self%left_by_hinge = 1.0_wp
      self%excursion = 0.0_wp
      self%zero = 0.0_wp
      self%begun = point()
      line = virgin_line(self, 1)
   end subroutine start

   !> The elastic line of a side; of both if they have the same slope.
   pure type(segment) function virgin_line(self, s) result(line)
      class(peak_oriented_rule), intent(in) :: self
      integer, intent(in) :: s
      real(wp) :: near

      line = segment(k=self%given(s)%stiffness())
      near = 0.0_wp
      if (.not. abs(line%k - self%given(-s)%stiffness()) > 0.0_wp) near = -s*self%backbone(-s)%d(1)
      line = line%outward(s, near=near, far=s*self%backbone(s)%d(1), near_closed=near*s >= 0.0_wp, &
                          one_way=.false.)
   end function virgin_line

   subroutine next(self, line, direction)
      class(peak_oriented_rule), intent(inout) :: self
      type(segment), intent(inout) :: line
      integer, intent(in) :: direction
      type(point) :: here
      logical :: outward

      here%d = line%end_toward(direction)
      here%f = line%force(here%d)
      self%excursion = self%excursion + 0.5_wp*(here%f + self%begun%f)*(here%d - self%begun%d)
      self%begun = here
      outward = direction == self%side

      select case (self%branch)
      case (virgin)
         if (direction*here%d > 0.0_wp) then
            ! What the flexural spring did before counts for nothing: an uncracked spring has not decayed.
            self%heard_at_cracking = self%heard
            call follow_backbone(self, line, direction, here%d)
         else
            self%side = direction
            line = virgin_line(self, direction)
         end if
      case (on_backbone)
         if (outward) then
            call follow_backbone(self, line, direction, here%d)
         else
            call unload(self, line, here)
         end if
      case (unloading)
         if (outward) then
            self%branch = self%left_branch
            line = self%left%outward(self%side, near=here%d, far=self%left%end_toward(direction), &
                                     near_closed=.true., one_way=.true.)
         else
            call end_excursion(self, line, direction, here%d)
         end if
      case (reloading)
         if (.not. outward) then
            call unload(self, line, here)
         else if (self%aims_at_peak) then
            call follow_backbone(self, line, direction, here%d)
         else
            call reload_to_peak(self, line, here)
         end if
      case default
         return                                     ! dead: the line never ends
      end select
   end subroutine next

   !> On the backbone of side s from deformation d on.
   subroutine follow_backbone(self, line, s, d)
      class(peak_oriented_rule), intent(inout) :: self
      type(segment), intent(inout) :: line
      integer, intent(in) :: s
      real(wp), intent(in) :: d

      self%side = s
      self%branch = on_backbone
      if (self%backbone(s)%is_exhausted(s*d)) then
         call die(self, line)
      else
         line = self%backbone(s)%line_from(s, d)
      end if
   end subroutine follow_backbone

   subroutine die(self, line)
      class(peak_oriented_rule), intent(inout) :: self
      type(segment), intent(inout) :: line

      self%branch = dead
      line = segment()
   end subroutine die

   !> The motion has turned back: unload toward zero force.
   subroutine unload(self, line, here)
      class(peak_oriented_rule), intent(inout) :: self
      type(segment), intent(inout) :: line
      type(point), intent(in) :: here
      real(wp) :: d, f, k, way, energy, kept
      integer :: s

      s = self%side
      d = s*here%d
      f = s*here%f
      if (f <= no_force*self%given(s)%f_y) then
         ! There is no force to unload: reload on the other side.
         call reload(self, line, -s, here%d)
         return
      end if
      self%turned(s) = point(d, f)
      if (self%branch == on_backbone) then
         self%peak(s) = d
         self%loaded(s) = .true.
         self%turned(s) = no_point
         self%yielded = self%yielded .or. d > self%given(s)%d_y
      end if
      self%left = line
      self%left_branch = self%branch
      self%branch = unloading

      k = self%unloading_stiffness(s)
      self%stiffness_next = self%stiffness_left
      if (self%yielded) then
         ! Energy that unloading would return is not dissipated.
         energy = self%excursion - 0.5_wp*f**2/k
         kept = max(1.0_wp - self%deterioration%share(self%deterioration%unloading, energy), &
                    least_stiffness/self%stiffness_left)
         self%stiffness_next = self%stiffness_left*kept
         k = k*kept
      end if
      ! Unloading must not pass the crossing at which the excursion started, nor return more energy than was
      ! put in: both would create energy.
      way = d - s*self%zero
      if (way > 0.0_wp) k = max(k, f/way)
      if (self%excursion > 0.0_wp) k = max(k, 0.5_wp*f**2/self%excursion)
      k = min(k, self%k_0)
      line = segment(d0=here%d, f0=here%f, k=k)
      line = line%outward(s, near=here%d - here%f/k, far=here%d, near_closed=.true., one_way=.false.)
   end subroutine unload

   !> Unloading stiffness of a side from its largest peak, reduced by deterioration: before yield toward
   !> cracking of the other side, after it decreasing with ductility [N/m].
   elemental real(wp) function unloading_stiffness(self, s) result(k)
      class(peak_oriented_rule), intent(in) :: self
      integer, intent(in) :: s
      real(wp) :: d, f

      associate (own => self%given(s), other => self%given(-s))
         d = max(self%peak(s), own%d_c)
         if (d < own%d_y) then
            f = own%f_c
            if (d > own%d_c) f = f + (own%f_y - own%f_c)*((d - own%d_c)/(own%d_y - own%d_c))
            if (.not. d > 0.0_wp) then
               k = own%stiffness()
            else
               k = (f + other%f_c)/(d + other%d_c)
            end if
         else
            k = (own%f_y + other%f_c)/(own%d_y + other%d_c)*(own%d_y/d)**self%b0
         end if
      end associate
      k = k*self%stiffness_left
   end function unloading_stiffness

   !> Zero force is reached from side -s: the excursion is over, and side s deteriorates.
   subroutine end_excursion(self, line, s, zero)
      class(peak_oriented_rule), intent(inout) :: self
      type(segment), intent(inout) :: line
      integer, intent(in) :: s
      real(wp), intent(in) :: zero
      real(wp) :: energy, strength, softening, target, peak

      self%stiffness_left = self%stiffness_next
      if (self%yielded) then
         energy = max(self%excursion, 0.0_wp)
         associate (deterioration => self%deterioration, backbone => self%backbone(s))
            strength = deterioration%share(deterioration%strength, energy)
            softening = deterioration%share(deterioration%softening, energy)
            target = deterioration%share(deterioration%target, energy)
            deterioration%spent = deterioration%spent + energy
            if (max(strength, softening, target) >= 1.0_wp) then
               call die(self, line)
               return
            end if
            backbone%strength = backbone%strength*(1.0_wp - strength)
            if (self%hinge_work > 0.0_wp) call decay(self, s)
            backbone%softening = backbone%softening*(1.0_wp - softening)
            call backbone%draw()
            peak = self%peak(s)
            if (self%loaded(s)) then
               self%peak(s) = peak*(1.0_wp + target)
               if (is_given(self%given(s)%d_u)) self%peak(s) = min(self%peak(s), max(peak, self%given(s)%d_u))
            else
               self%peak(s) = backbone%strength*self%given(s)%d_c
            end if
         end associate
      else if (self%hinge_work > 0.0_wp) then
         call decay(self, s)
         call self%backbone(s)%draw()
         if (.not. self%loaded(s)) self%peak(s) = self%backbone(s)%strength*self%given(s)%d_c
      end if
      call reload(self, line, s, zero)
   end subroutine end_excursion

   !> The strength of a side falls with the work of the flexural spring of the joint since cracking.
   pure subroutine decay(self, s)
      class(peak_oriented_rule), intent(inout) :: self
      integer, intent(in) :: s
      real(wp) :: work, left

      work = max(self%heard - self%heard_at_cracking, 0.0_wp)
      left = min(self%s_min + (1.0_wp - self%s_min)/(1.0_wp + work/self%hinge_work), self%left_by_hinge(s))
      self%backbone(s)%strength = self%backbone(s)%strength*(left/self%left_by_hinge(s))
      self%left_by_hinge(s) = left
   end subroutine decay

   !> Whether the strength falls with the work of the flexural spring.
   pure logical function hears(self)
      class(peak_oriented_rule), intent(in) :: self

      hears = self%hinge_work > 0.0_wp
   end function hears

   !> Take the work of the flexural spring so far [J].
   pure subroutine hear(self, work)
      class(peak_oriented_rule), intent(inout) :: self
      real(wp), intent(in) :: work

      self%heard = work
   end subroutine hear

   !> Reload from zero force toward side s: to the break of the line (pinching), or to the last turning point
   !> if the line to it is steeper, else directly to the largest peak.
   subroutine reload(self, line, s, zero)
      class(peak_oriented_rule), intent(inout) :: self
      type(segment), intent(inout) :: line
      integer, intent(in) :: s
      !> Where the force is zero [m or rad]
      real(wp), intent(in) :: zero
      type(point) :: peak, yield, first

      self%side = s
      self%zero = zero
      self%excursion = 0.0_wp
      self%begun = point(zero, 0.0_wp)
      associate (backbone => self%backbone(s), z => s*zero, last => self%turned(s))
         peak = point(self%peak(s), backbone%force(self%peak(s)))
         if (peak%d < backbone%d_y) then
            ! Toward yield, if the line to it is steeper (as in Takeda's rule).
            yield = point(backbone%d_y, backbone%force(backbone%d_y))
            if (peak%d <= z .or. yield%f*(peak%d - z) >= peak%f*(yield%d - z)) peak = yield
            if (peak%f > self%k_0*(peak%d - z)) peak = meeting(self, s, z, peak)
            self%peak(s) = peak%d
         end if
         if (.not. peak%f > 0.0_wp) then
            call die(self, line)
            return
         end if
         first = self%break_point(s, z, peak)
         if (.not. first%f > 0.0_wp) then
            first = peak
            if (last%d > z .and. last%d < peak%d .and. last%f < peak%f .and. &
                last%f*(peak%d - z) > peak%f*(last%d - z)) first = last
         end if
         self%aims_at_peak = first%d >= peak%d
         call aim(self, line, s, self%begun, first)
      end associate
   end subroutine reload

   !> The point beyond `peak` where the stiffest line from a crossing of zero force meets the backbone:
   !> small cycles may shift the crossing so near to cracking or yield that a line there would be too steep.
   elemental type(point) function meeting(self, s, zero, peak)
      class(peak_oriented_rule), intent(in) :: self
      integer, intent(in) :: s
      !> Seen from side s
      real(wp), intent(in) :: zero
      type(point), intent(in) :: peak
      type(segment) :: leg
      real(wp) :: d

      meeting = peak
      leg = self%backbone(s)%line_from(1, peak%d)
      if (leg%k >= self%k_0*(1.0_wp - parallel)) return
      d = (leg%force(0.0_wp) + self%k_0*zero)/(self%k_0 - leg%k)
      if (d > peak%d) meeting = point(d, self%backbone(s)%force(d))
   end function meeting

   !> The point to which reloading goes first if the rule pinches, positive; else `no_point`.
   elemental type(point) function break_point(self, s, zero, peak)
      class(peak_oriented_rule), intent(in) :: self
      !> Side
      integer, intent(in) :: s
      !> Start of reloading and the peak that it goes to, seen from side s
      real(wp), intent(in) :: zero
      type(point), intent(in) :: peak

      break_point = point(no_point%d, 0.0_wp*(s*zero*peak%d*self%b0))
   end function break_point

   !> Continue reloading from an intermediate point to the largest peak of the side.
   subroutine reload_to_peak(self, line, from)
      class(peak_oriented_rule), intent(inout) :: self
      type(segment), intent(inout) :: line
      type(point), intent(in) :: from

      self%aims_at_peak = .true.
      associate (s => self%side)
         call aim(self, line, s, from, point(self%peak(s), self%backbone(s)%force(self%peak(s))))
      end associate
   end subroutine reload_to_peak

   !> The straight line to a point of side s. That point is its anchor, so that it is met exactly.
   subroutine aim(self, line, s, from, at)
      class(peak_oriented_rule), intent(inout) :: self
      type(segment), intent(inout) :: line
      integer, intent(in) :: s
      type(point), intent(in) :: from
      !> Both positive
      type(point), intent(in) :: at
      real(wp) :: way, k

      self%branch = reloading
      way = at%d - s*from%d
      ! If round-off leaves no distance, the point is met at once.
      k = self%k_0
      if (way > 0.0_wp) k = (at%f - s*from%f)/way
      line = segment(d0=s*at%d, f0=s*at%f, k=k)
      line = line%outward(s, near=from%d, far=s*max(at%d, s*from%d), near_closed=.true., one_way=.true.)
   end subroutine aim

end module rbs_hysteresis_peak_oriented
