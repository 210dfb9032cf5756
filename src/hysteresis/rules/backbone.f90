!> The present backbone of one side: straight lines from corner to corner, all values positive.
!>
!> Deterioration by energy acts through two factors (Ibarra, Medina, Krawinkler 2005, Earthquake Eng.
!> Struct. Dyn. 34, section 3): cracking point, yield point and slope to the cap are multiplied by
!> `strength`, the force of the softening line at zero deformation by `softening`. Cap and start of the
!> residual are the points where the lines meet; beyond `d_u` the force drops to zero.
module rbs_hysteresis_rules_backbone
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_base_constants, only: unbounded
   use rbs_hysteresis_segment, only: segment
   use rbs_hysteresis_rules_backbone_parameters, only: backbone_parameters
   use rbs_base_check, only: is_given
   implicit none
   private

   public :: backbone_side

   type :: backbone_side
      !> Remaining shares of the strength, and of the force of the softening line
      real(wp) :: strength = 1.0_wp, softening = 1.0_wp
      !> Present corners from 0, the origin: deformations [m or rad] and forces [N or N m]
      integer :: last = 0
      real(wp) :: d(0:6) = 0.0_wp, f(0:6) = 0.0_wp
      !> Present yield deformation [m or rad]
      real(wp) :: d_y = 0.0_wp
   contains
      procedure :: draw
      procedure :: force
      procedure :: line_from
      procedure :: meeting
      procedure :: add_corner
      procedure :: end_at_rupture
      procedure :: serialize
   end type backbone_side

contains

   !> Find the corners for the present factors.
   pure subroutine draw(self, given)
      class(backbone_side), intent(inout) :: self
      type(backbone_parameters), intent(in) :: given
      real(wp) :: hardening, softening, f_zero, d_res, d_x, d, f, slope

      self%last = 0
      self%d_y = 0.0_wp
      associate (b => given)
         ! Residual strength does not deteriorate.
         self%strength = max(self%strength, b%f_res/b%f_y)
         if (.not. self%strength > 0.0_wp) return
         hardening = 0.0_wp
         if (b%d_cap > b%d_y) hardening = self%strength*(b%f_cap - b%f_y)/(b%d_cap - b%d_y)
         softening = -b%f_cap/b%d_pc
         f_zero = self%softening*(b%f_cap - softening*b%d_cap)
         d_res = (b%f_res - f_zero)/softening
         self%d_y = self%strength*b%d_y

         ! Up along the lines of hardening, until they meet the softening or the residual one.
         d = self%strength*b%d_c
         f = self%strength*b%f_c
         if (d > 0.0_wp .and. f <= limit(d)) call self%add_corner(d, f)
         d = self%d_y
         f = self%strength*b%f_y
         slope = f/d
         if (self%last > 0) slope = (f - self%f(1))/(d - self%d(1))
         if (b%d_c > 0.0_wp .and. self%last == 0) slope = b%f_c/b%d_c
         if (f <= limit(d)) then
            if (self%last == 0 .or. d > self%d(self%last)) call self%add_corner(d, f)
            slope = hardening
         end if
         associate (from_d => self%d(self%last), from_f => self%f(self%last))
            d_x = (f_zero - from_f + slope*from_d)/(slope - softening)
            ! Without deterioration the cap must equal that of the user to the last bit.
            if (self%strength >= 1.0_wp .and. self%softening >= 1.0_wp) d_x = b%d_cap
            f = limit(d_x)
            if (d_x > d_res) then
               f = b%f_res
               if (slope > 0.0_wp) d_x = from_d + (f - from_f)/slope
            end if
         end associate
         if (self%strength >= 1.0_wp .and. self%softening >= 1.0_wp) f = b%f_cap
         if (d_x > self%d(self%last)) call self%add_corner(d_x, f)
         if (d_res > d_x) call self%add_corner(d_res, b%f_res)
         if (is_given(b%d_u)) call self%end_at_rupture(given)
      end associate

   contains

      !> The largest force that the softening and the residual line allow.
      pure real(wp) function limit(at)
         real(wp), intent(in) :: at

         limit = max(f_zero + softening*at, given%f_res)
      end function limit
   end subroutine draw

   !> Cut the lines at d_u; from there the force drops to zero with the slope of the line from zero to yield.
   pure subroutine end_at_rupture(self, given)
      class(backbone_side), intent(inout) :: self
      type(backbone_parameters), intent(in) :: given
      real(wp) :: f

      associate (d_u => given%d_u)
         f = self%force(d_u)
         if (.not. f > 0.0_wp) return
         do while (self%last > 0)
            if (self%d(self%last) < d_u) exit
            self%last = self%last - 1
         end do
         call self%add_corner(d_u, f)
         call self%add_corner(d_u + f*(given%d_y/given%f_y), 0.0_wp)
      end associate
   end subroutine end_at_rupture

   pure subroutine add_corner(self, d, f)
      class(backbone_side), intent(inout) :: self
      !> Deformation and force, both positive
      real(wp), intent(in) :: d, f

      self%last = self%last + 1
      self%d(self%last) = d
      self%f(self%last) = f
   end subroutine add_corner

   !> Force at a deformation, both positive [N or N m].
   elemental real(wp) function force(self, d)
      class(backbone_side), intent(in) :: self
      real(wp), intent(in) :: d
      integer :: i

      i = corner_before(self, d)
      force = self%f(i)
      if (i < self%last) force = self%f(i) + slope_after(self, i)*(d - self%d(i))
   end function force

   !> The last corner that is not beyond a deformation.
   pure integer function corner_before(self, d) result(i)
      type(backbone_side), intent(in) :: self
      real(wp), intent(in) :: d

      do i = self%last, 1, -1
         if (self%d(i) <= d) return
      end do
      i = 0
   end function corner_before

   elemental real(wp) function slope_after(self, i) result(slope)
      type(backbone_side), intent(in) :: self
      integer, intent(in) :: i

      slope = (self%f(i + 1) - self%f(i))/(self%d(i + 1) - self%d(i))
   end function slope_after

   !> The line of the backbone on side s that starts at, or contains, a deformation; it unloads on reversal.
   pure type(segment) function line_from(self, s, d) result(line)
      class(backbone_side), intent(in) :: self
      !> Side, +1 or -1
      integer, intent(in) :: s
      !> Deformation, with its sign [m or rad]
      real(wp), intent(in) :: d
      real(wp) :: far, slope
      integer :: i

      i = corner_before(self, s*d)
      far = unbounded
      slope = 0.0_wp
      if (i < self%last) then
         far = self%d(i + 1)
         slope = slope_after(self, i)
      end if
      line = segment(d0=s*self%d(i), f0=0.0_wp + s*self%f(i), k=slope)
      call line%lead_outward(s, near=d, far=s*far)
   end function line_from

   !> The first deformation where a line that rises steeply from zero force meets the backbone [m or rad].
   elemental real(wp) function meeting(self, k, start)
      class(backbone_side), intent(in) :: self
      !> Slope, not below the elastic one, and deformation without force
      real(wp), intent(in) :: k, start
      real(wp) :: slope
      integer :: i

      do i = corner_before(self, start), self%last - 1
         if (self%f(i + 1) > k*(self%d(i + 1) - start)) cycle
         slope = slope_after(self, i)
         meeting = self%d(i + 1)
         if (slope < k) meeting = min(meeting, (self%f(i) - slope*self%d(i) + k*start)/(k - slope))
         meeting = max(meeting, start)
         return
      end do
      meeting = max(start + self%f(self%last)/k, self%d(self%last))
   end function meeting

   !> Save or restore what deterioration has made of the backbone.
   pure subroutine serialize(self, stream)
      class(backbone_side), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%items(self%strength, self%softening)
      call stream%item_count(self%last, ubound(self%d, 1))
      call stream%item(self%d)
      call stream%item(self%f)
      call stream%item(self%d_y)
   end subroutine serialize

end module rbs_hysteresis_rules_backbone
