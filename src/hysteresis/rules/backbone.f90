!> The present backbone of one side: straight lines from corner to corner, all values positive.
!>
!> Deterioration by energy acts through two factors (Ibarra, Medina, Krawinkler 2005, Earthquake Eng.
!> Struct. Dyn. 34, section 3): cracking point, yield point and slope to the cap are multiplied by
!> `strength`, the force of the softening line at zero deformation by `softening`. Cap and start of the
!> residual are the points where the lines meet; beyond `d_u` the force drops to zero.
!>
!> Input of one side of a backbone with cracking, yield, cap, softening, residual and rupture.
!>
!>     force
!>       f_cap              cap
!>       f_y         yield/  \
!>       f_c  crack /         \  slope -f_cap/d_pc
!>       f_res    /            \____________
!>               /                          \  slope -f_y/d_y
!>              0   d_c  d_y  d_cap          d_u       deformation
!>
!> All values are positive on both sides. A side whose f_y is zero carries nothing, as a strut that opens or a
!> tie that goes slack; its other values do nothing.
module rbs_hysteresis_rules_backbone
   use rbs_base_check, only: check_order, is_given
   use rbs_base_constants, only: unbounded, unset
   use rbs_base_error, only: message_list
   use rbs_base_key_visitor, only: key_visitor
   use rbs_base_keys, only: bound_type, above_zero, not_negative, key_force => force, deformation
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_base_text, only: to_text
   use rbs_base_tolerances, only: parallel
   use rbs_hysteresis_segment, only: segment
   implicit none
   private

   public :: backbone_side, backbone_parameters

   character(len=*), parameter :: as_positive = 'the same on the negative side; without it as on the positive'

   type :: backbone_parameters
      !> Cracking point [m], [N]; zero: uncracked from the start, elastic up to yield
      real(wp) :: d_c = unset, f_c = unset
      !> Yield point [m], [N]; capping point: the largest force [m], [N]
      real(wp) :: d_y = unset, f_y = unset, d_cap = unset, f_cap = unset
      !> Deformation from the cap to the point where the softening line reaches zero force [m]
      real(wp) :: d_pc = unset
      !> Residual force, at which softening ends [N]; deformation beyond which the force drops to zero [m];
      !> `unset`: none
      real(wp) :: f_res = unset, d_u = unset
   contains
      procedure :: visit, completed, carries, check, stiffness
   end type backbone_parameters

   type :: backbone_side
      !> Remaining shares of the strength, and of the force of the softening line
      real(wp) :: strength = 1.0_wp, softening = 1.0_wp
      !> Present corners from 0, the origin: deformations [m or rad] and forces [N or N m]
      integer :: last = 0
      real(wp) :: d(0:6) = 0.0_wp, f(0:6) = 0.0_wp
      !> Present yield deformation [m or rad]
      real(wp) :: d_y = 0.0_wp
   contains
      procedure :: draw, force, line_from, meeting, add_corner, end_at_rupture, serialize
   end type backbone_side

contains

   !> Find the corners for the present factors, `strength` and `softening`.
   pure subroutine draw(self, given)
      class(backbone_side), intent(inout) :: self
      !> The virgin side, with values for all but `d_u`
      type(backbone_parameters), intent(in) :: given
      real(wp) :: hardening, softening, f_zero, d_res, d_x, d, f, slope

      self%last = 0
      self%d_y = 0.0_wp
      associate (b => given)
         if (.not. b%carries()) return
         ! Residual strength does not deteriorate.
         self%strength = max(self%strength, b%f_res/b%f_y)
         if (.not. self%strength > 0.0_wp) return
         hardening = 0.0_wp
         if (b%d_cap > b%d_y) hardening = self%strength*(b%f_cap - b%f_y)/(b%d_cap - b%d_y)
         ! The softening line is f_zero + softening d; at d_res it meets the residual force.
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
         ! Slope of the line that was followed last: to yield or, where the cracking point is above the
         ! limit already, to cracking.
         slope = f/d
         if (self%last > 0) slope = (f - self%f(1))/(d - self%d(1))
         if (b%d_c > 0.0_wp .and. self%last == 0) slope = b%f_c/b%d_c
         if (f <= limit(d)) then
            if (self%last == 0 .or. d > self%d(self%last)) call self%add_corner(d, f)
            slope = hardening
         end if
         ! Where the last line of hardening meets the softening one.
         d_x = (f_zero - self%f(self%last) + slope*self%d(self%last))/(slope - softening)
         ! Without deterioration the cap must equal that of the user to the last bit.
         if (self%strength >= 1.0_wp .and. self%softening >= 1.0_wp) d_x = b%d_cap
         f = limit(d_x)
         if (d_x > d_res) then
            f = b%f_res
            if (slope > 0.0_wp) d_x = self%d(self%last) + (f - self%f(self%last))/slope
         end if
         if (self%strength >= 1.0_wp .and. self%softening >= 1.0_wp) f = b%f_cap
         if (d_x > self%d(self%last)) call self%add_corner(d_x, f)
         if (d_res > d_x) call self%add_corner(d_res, b%f_res)
         if (is_given(b%d_u)) call self%end_at_rupture(given)
      end associate

   contains

      !> The force of the softening line or, where that is larger, of the residual one.
      pure real(wp) function limit(at)
         real(wp), intent(in) :: at

         limit = max(f_zero + softening*at, given%f_res)
      end function limit
   end subroutine draw

   !> Cut the lines at d_u; from there the force drops to zero, a little more steeply than the line from zero
   !> to yield rises: with the same slope a like spring in the same member, which unloads, would make the line
   !> of the member upright.
   pure subroutine end_at_rupture(self, given)
      class(backbone_side), intent(inout) :: self
      type(backbone_parameters), intent(in) :: given
      real(wp), parameter :: drop = 15.0_wp/16.0_wp
      real(wp) :: f

      f = self%force(given%d_u)
      if (.not. f > 0.0_wp) return
      do while (self%last > 0)
         if (self%d(self%last) < given%d_u) exit
         self%last = self%last - 1
      end do
      call self%add_corner(given%d_u, f)
      call self%add_corner(given%d_u + drop*f*(given%d_y/given%f_y), 0.0_wp)
   end subroutine end_at_rupture

   !> Add a corner behind the others.
   pure subroutine add_corner(self, d, f)
      class(backbone_side), intent(inout) :: self
      !> Deformation and force, both positive
      real(wp), intent(in) :: d, f

      self%last = self%last + 1
      self%d(self%last) = d
      self%f(self%last) = f
   end subroutine add_corner

   !> Force at a deformation, both positive [N or N m]; behind the last corner it is constant.
   elemental real(wp) function force(self, d)
      class(backbone_side), intent(in) :: self
      real(wp), intent(in) :: d
      integer :: i

      i = corner_before(self, d)
      force = self%f(i)
      if (i < self%last) force = self%f(i) + slope_after(self, i)*(d - self%d(i))
   end function force

   !> Number of the last corner that is not beyond a deformation; 0 is the origin.
   pure integer function corner_before(self, d) result(i)
      type(backbone_side), intent(in) :: self
      real(wp), intent(in) :: d

      do i = self%last, 1, -1
         if (self%d(i) <= d) return
      end do
      i = 0
   end function corner_before

   !> Slope of the line from corner i to the next one.
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
      ! The sum turns a force of -0 into 0.
      line = segment(d0=s*self%d(i), f0=0.0_wp + s*self%f(i), k=slope)
      call line%lead_outward(s, near=d, far=s*far)
   end function line_from

   !> The first deformation where a line that rises steeply from zero force meets the backbone [m or rad].
   elemental real(wp) function meeting(self, k, start)
      class(backbone_side), intent(in) :: self
      !> Slope, not below the elastic one [N/m or N m/rad], and deformation at zero force, positive
      real(wp), intent(in) :: k, start
      real(wp) :: slope
      integer :: i

      do i = corner_before(self, start), self%last - 1
         ! At corner i + 1 the line is still below the backbone.
         if (self%f(i + 1) > k*(self%d(i + 1) - start)) cycle
         slope = slope_after(self, i)
         meeting = self%d(i + 1)
         if (slope < k) meeting = min(meeting, (self%f(i) - slope*self%d(i) + k*start)/(k - slope))
         meeting = max(meeting, start)
         return
      end do
      ! Behind the last corner the force is constant.
      meeting = max(start + self%f(self%last)/k, self%d(self%last))
   end function meeting

   !> Save or restore the backbone after deterioration.
   pure subroutine serialize(self, stream)
      class(backbone_side), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%items(self%strength, self%softening)
      call stream%item_count(self%last, ubound(self%d, 1))
      call stream%item(self%d)
      call stream%item(self%f)
      call stream%item(self%d_y)
   end subroutine serialize

   !> The keys of a side. All of those of the negative side are optional and have a suffix.
   subroutine visit(self, v, negative)
      class(backbone_parameters), intent(inout) :: self
      type(key_visitor), intent(inout) :: v
      logical, intent(in) :: negative

      call key('d_y', self%d_y, deformation, above_zero, 'yield deformation')
      call key('f_y', self%f_y, key_force, not_negative, 'yield force; 0: this side carries nothing')
      call key('d_cap', self%d_cap, deformation, above_zero, 'deformation at the cap, from d_y on')
      call key('f_cap', self%f_cap, key_force, above_zero, 'largest force, from f_y on')
      call key('d_pc', self%d_pc, deformation, above_zero, &
               'from the cap along the softening line to where it would have no force left')
      call key('f_res', self%f_res, key_force, not_negative, &
               'residual force, below f_y, which softening does not fall below')
      call key('d_u', self%d_u, deformation, above_zero, &
               'deformation beyond which the force falls to zero; without it there is none')
      call key('d_c', self%d_c, deformation, not_negative, 'cracking deformation; 0: elastic up to yield')
      call key('f_c', self%f_c, key_force, not_negative, 'cracking force')

   contains

      !> Present one key, under its name or, on the negative side, with the suffix _neg.
      subroutine key(name, x, unit, bound, meaning)
         character(len=*), intent(in) :: name, unit, meaning
         real(wp), intent(inout) :: x
         type(bound_type), intent(in) :: bound

         if (negative) then
            call v%key(name//'_neg', x, unit, bound, as_positive, optional=.true.)
         else
            call v%key(name, x, unit, bound, meaning, optional=name == 'd_u')
         end if
      end subroutine key
   end subroutine visit

   !> A side; values that are not given are those of the other side.
   pure type(backbone_parameters) function completed(self, other)
      class(backbone_parameters), intent(in) :: self, other

      completed = backbone_parameters( &
                  d_c=either(self%d_c, other%d_c), f_c=either(self%f_c, other%f_c), &
                  d_y=either(self%d_y, other%d_y), f_y=either(self%f_y, other%f_y), &
                  d_cap=either(self%d_cap, other%d_cap), f_cap=either(self%f_cap, other%f_cap), &
                  d_pc=either(self%d_pc, other%d_pc), f_res=either(self%f_res, other%f_res), &
                  d_u=either(self%d_u, other%d_u))
   end function completed

   !> A number if it is given, else that of the other side.
   pure real(wp) function either(x, other)
      real(wp), intent(in) :: x, other

      either = merge(x, other, is_given(x))
   end function either

   !> Add a message for every relation that does not hold.
   subroutine check(self, name, suffix, messages)
      class(backbone_parameters), intent(in) :: self
      !> Name of the spring, and suffix of the names of the parameters
      character(len=*), intent(in) :: name, suffix
      type(message_list), intent(inout) :: messages

      if (.not. self%carries()) return
      call check_cracking(self, name, suffix, messages)
      call require('d_cap', self%d_cap, 'must not be below', 'd_y', self%d_y, 'the cap comes after yield')
      call require('f_cap', self%f_cap, 'must not be below', 'f_y', self%f_y, &
                   'put the yield point at the cap if the force falls from there')
      if (self%f_cap > self%f_y .and. .not. self%d_cap > self%d_y) then
         call require('d_cap', self%d_cap, 'must be above', 'd_y', self%d_y, &
                      'the force rises from yield to the cap')
      else if ((self%f_cap - self%f_y)*(self%d_y - self%d_c) > &
               (self%f_y - self%f_c)*(self%d_cap - self%d_y)*(1.0_wp + parallel)) then
         call messages%add(name//': f_cap'//suffix//' = '//to_text(self%f_cap)//' is too far above f_y'// &
                           suffix//' = '//to_text(self%f_y)//' (the slope to the cap must not be above '// &
                           'that to yield: yielding softens)')
      end if
      call require('f_res', self%f_res, 'must be below', 'f_y', self%f_y, &
                   'it is what softening leaves of the strength')
      if (is_given(self%d_u)) call require('d_u', self%d_u, 'must not be below', 'd_cap', self%d_cap, &
                                           'rupture comes after the cap')

   contains

      !> Add a message unless a value and a limit, each with its name, stand in a relation.
      subroutine require(number, value, relation, other, limit, reason)
         character(len=*), intent(in) :: number, relation, other, reason
         real(wp), intent(in) :: value, limit

         call check_order(name, number//suffix, value, relation, other//suffix, limit, ' ('//reason//')', &
                          messages)
      end subroutine require
   end subroutine check

   !> The cracking point needs both values or none; it must come before yield, on a stiffer line.
   subroutine check_cracking(self, name, suffix, messages)
      class(backbone_parameters), intent(in) :: self
      character(len=*), intent(in) :: name, suffix
      type(message_list), intent(inout) :: messages

      if (self%d_c > 0.0_wp .neqv. self%f_c > 0.0_wp) then
         call messages%add(name//': d_c'//suffix//' = '//to_text(self%d_c)//' and f_c'//suffix//' = '// &
                           to_text(self%f_c)//' are a point together; give both above zero, or none')
      else if (self%d_c > 0.0_wp) then
         if (self%d_c >= self%d_y .or. self%f_c >= self%f_y) then
            call messages%add(name//': the cracking point d_c'//suffix//' = '//to_text(self%d_c)//', f_c'// &
                              suffix//' = '//to_text(self%f_c)//' must come before the yield point d_y'// &
                              suffix//' = '//to_text(self%d_y)//', f_y'//suffix//' = '//to_text(self%f_y))
         else if (self%f_c/self%d_c <= self%f_y/self%d_y) then
            call messages%add(name//': f_c'//suffix//' / d_c'//suffix//' = '// &
                              to_text(self%f_c/self%d_c)//' must be above f_y'//suffix//' / d_y'//suffix// &
                              ' = '//to_text(self%f_y/self%d_y)//' (cracking softens)')
         end if
      end if
   end subroutine check_cracking

   !> Whether the side has any strength.
   elemental logical function carries(self)
      class(backbone_parameters), intent(in) :: self

      carries = self%f_y > 0.0_wp
   end function carries

   !> Stiffness of the virgin spring on this side, up to cracking or yield [N/m or N m/rad].
   elemental real(wp) function stiffness(self)
      class(backbone_parameters), intent(in) :: self

      stiffness = self%f_y/self%d_y
      if (self%carries() .and. self%d_c > 0.0_wp) stiffness = self%f_c/self%d_c
   end function stiffness

end module rbs_hysteresis_rules_backbone
