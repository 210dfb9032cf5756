!> Steel with a rounded transition to yield: a bank of parallel elements, each elastic up to its own limit.
!>
!> The force is f = sum s_i with -y_i <= s_i <= y_i (Iwan 1966). An element inside its limits follows the
!> deformation with its stiffness k_i; one that slips stays on its limit. The limits y_i = w k_i d_y Y_i(q)
!> follow the plastic reach q = (H - L)/d_y - 2, with H and L the extremes of the deformation so far, along
!> a table that gives the branches the roundness of Menegotto and Pinto (1973). No limit moves faster than
!> its element can: small reversals have small effects, and closed loops never create energy. Plastic
!> deformation inside the reach may reduce the strength through the factor w (wear).
module rbs_hysteresis_rules_steel
   use rbs_base_check, only: check_order, is_given
   use rbs_base_constants, only: unbounded, unset
   use rbs_base_error, only: message_list
   use rbs_base_key_visitor, only: key_visitor
   use rbs_base_keys, only: above_zero, not_negative, share_below_one, force, stiffness, deformation
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_base_text, only: to_text
   use rbs_base_tolerances, only: no_stiffness, parallel
   use rbs_hysteresis_rule, only: rule_type, rule_memory, check_product
   use rbs_hysteresis_segment, only: segment
   implicit none
   private

   public :: steel_rule

   !> Number of elements that yield, and number with the one of hardening
   integer, parameter :: yielding = 7, elements = 8
   !> Slopes of a branch between the limits of the elements, over k
   real(wp), parameter :: slopes(0:yielding) = &
      [1.0_wp, 0.94_wp, 0.75_wp, 0.5_wp, 0.25_wp, 0.08_wp, 0.015_wp, 0.0_wp]
   !> Stiffness of each element over that of all that yield
   real(wp), parameter :: share(yielding) = slopes(:yielding - 1) - slopes(1:)
   !> Plastic reaches of the table, without those of the plateau
   real(wp), parameter :: reaches(12) = [0.0_wp, 0.1_wp, 0.2_wp, 0.4_wp, 0.8_wp, 1.6_wp, 3.2_wp, 6.4_wp, &
                                         12.8_wp, 25.6_wp, 51.2_wp, 102.4_wp]
   integer, parameter :: most_rows = size(reaches) + 2
   !> Rows whose plastic reaches differ by less are one; a reach this close to a row is on it
   real(wp), parameter :: same_row = 1.0e-6_wp, on_row = 1.0e-12_wp
   !> Least roundness
   real(wp), parameter :: least_r = 0.8_wp
   !> An element is on its limit if no more than this share of H - L is missing
   real(wp), parameter :: near_limit = 1.0e-13_wp
   !> A limit that moves with at least this share of its element's stiffness carries the element with it
   real(wp), parameter :: as_fast = 1.0_wp - parallel

   !> Limits over k_i d_y in rows of the plastic reach: linear between them, constant after the last.
   type :: table_type
      integer :: rows = 1
      real(wp) :: q(most_rows) = 0.0_wp, y(elements, most_rows) = 1.0_wp
   end type table_type

   type :: steel_state
      !> Forces of the elements [N] at the last event, and their slopes on the present branch [N/m]
      real(wp) :: s(elements) = 0.0_wp, rate(elements) = 0.0_wp
      !> Deformation at the last event, and extremes of the deformation up to it [m]
      real(wp) :: d = 0.0_wp, highest = 0.0_wp, lowest = 0.0_wp
      !> Plastic deformation inside the reach up to it [m], and its growth along the present branch
      real(wp) :: worn = 0.0_wp, wear_rate = 0.0_wp
   end type steel_state

   type, extends(rule_memory) :: steel_memory
      type(steel_state) :: now
   contains
      procedure :: copy, serialize
   end type steel_memory

   type, extends(rule_type) :: steel_rule
      !> Elastic stiffness [N/m], yield force [N], stiffness of hardening [N/m]; roundness, and its decrease
      !> with the plastic reach
      real(wp) :: k = unset, f_y = unset, k_post = unset, r0 = 20.0_wp, cr1 = 0.925_wp, cr2 = 0.15_wp
      !> Growth of the strength with the plastic reach, and half of the reach that it belongs to
      real(wp) :: isotropic_hardening = 0.0_wp, hardening_reach = 1.0_wp
      !> Force at which hardening ends [N], `unset`: it does not end
      real(wp) :: f_u = unset
      !> Length of the plateau, and plastic deformation that halves the strength (0: none), over d_y
      real(wp) :: plateau = 0.0_wp, endurance = 0.0_wp
      !> Tensile deformation from which on bars bow [m], `unset`: never; growth of the wear beyond it
      real(wp) :: d_buckle = unset, buckling = 0.0_wp
      !> Largest factor of the wear: no limit may move faster than its element; yield deformation [m]
      real(wp), private :: most_wear = 1.0_wp, d_y = 0.0_wp
      type(table_type), private :: table
      !> Elements that have limits: all, or all but that of hardening
      integer, private :: limited = yielding
      !> Stiffness of the elements [N/m]
      real(wp), private :: k_element(elements) = 0.0_wp
   contains
      procedure :: visit, check_relations, prepare, next
   end type steel_rule

contains

   !> Present the parameters to a visitor.
   subroutine visit(self, v)
      class(steel_rule), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%key('k', self%k, stiffness, above_zero, 'elastic stiffness')
      call v%key('f_y', self%f_y, force, above_zero, 'yield force')
      call v%key('k_post', self%k_post, stiffness, not_negative, 'stiffness of hardening, below k')
      call v%key('r0', self%r0, '', above_zero, 'roundness of branches after little yielding')
      call v%key('cr1', self%cr1, '', share_below_one, &
                 'largest share by which the plastic reach lowers the roundness')
      call v%key('cr2', self%cr2, '', above_zero, &
                 'plastic reach over the yield deformation at half of that share')
      call v%key('isotropic_hardening', self%isotropic_hardening, '', not_negative, &
                 'share by which the strength has grown at a plastic reach of 2 hardening_reach')
      call v%key('hardening_reach', self%hardening_reach, '', above_zero, &
                 'half of that plastic reach, over the yield deformation')
      call v%key('f_u', self%f_u, force, above_zero, 'force at which hardening with k_post ends', &
                 optional=.true.)
      call v%key('plateau', self%plateau, '', not_negative, &
                 'length of the yield plateau over the yield deformation; needs f_u')
      call v%key('endurance', self%endurance, '', not_negative, 'sum of plastic deformations over d_y, '// &
                 'without new maxima, that halves the strength; 0: none')
      call v%key('d_buckle', self%d_buckle, deformation, above_zero, &
                 'tensile deformation from which on bars bow when they are compressed again', optional=.true.)
      call v%key('buckling', self%buckling, '', not_negative, &
                 'by how much more compression wears a bar that has been stretched to 2 d_buckle')
   end subroutine visit

   !> Add a message for each relation between parameters that does not hold.
   subroutine check_relations(self, name, messages)
      class(steel_rule), intent(inout) :: self
      character(len=*), intent(in) :: name
      type(message_list), intent(inout) :: messages
      type(table_type) :: table
      real(wp) :: largest
      integer :: before

      before = messages%count
      call check_order(name, 'k_post', self%k_post, 'must be below', 'k', self%k, &
                       '; use an elastic spring for one that does not yield', messages)
      if (is_given(self%f_u)) then
         call check_order(name, 'f_u', self%f_u, 'must not be below', 'f_y', self%f_y, '', messages)
         if (.not. self%k_post > 0.0_wp) then
            call messages%add(name//': f_u = '//to_text(self%f_u)//' is not reached with k_post = 0; '// &
                              'remove f_u or give k_post above zero')
         end if
      else if (self%plateau > 0.0_wp) then
         call messages%add(name//': plateau = '//to_text(self%plateau)//' needs f_u, where hardening ends')
      end if
      if (self%buckling > 0.0_wp .and. .not. (is_given(self%d_buckle) .and. self%endurance > 0.0_wp)) then
         call messages%add(name//': buckling = '//to_text(self%buckling)//' is a factor of the wear '// &
                           'beyond d_buckle; give d_buckle and endurance, or remove it')
      end if
      call check_product(self%k, self%f_y/self%k, name, 'k d_y', messages)
      if (messages%count > before .or. .not. self%endurance > 0.0_wp) return
      ! The widest limit of an element that has one, over k_i d_y
      call make_table(self, table)
      largest = maxval(table%y(:merge(elements, yielding, is_given(self%f_u)), :table%rows))
      if (self%endurance < largest) then
         call messages%add(name//': endurance = '//to_text(self%endurance)//' must be '//to_text(largest)// &
                           ' or more, the widest limit of an element over d_y; 0 means no wear')
      end if
   end subroutine check_relations

   !> Values that follow from the parameters alone.
   subroutine prepare(self)
      class(steel_rule), intent(inout) :: self

      self%initial_stiffness = self%k
      self%d_y = self%f_y/self%k
      self%k_element = [(self%k - self%k_post)*share, self%k_post]
      self%limited = merge(elements, yielding, is_given(self%f_u))
      call make_table(self, self%table)
      self%most_wear = max(1.0_wp, self%endurance/maxval(self%table%y(:self%limited, :self%table%rows)))
      self%branch = segment(k=self%k, lo=-self%d_y, hi=self%d_y)
      self%memory = steel_memory(now=steel_state(rate=self%k_element, highest=self%d_y, lowest=-self%d_y))
   end subroutine prepare

   !> The branch after the present one, which the motion leaves going up (direction = +1) or down (-1).
   subroutine next(self, memory, branch, direction)
      class(steel_rule), intent(in) :: self
      class(rule_memory), intent(inout) :: memory
      !> The branch that ends, replaced by its successor
      type(segment), intent(inout) :: branch
      integer, intent(in) :: direction

      select type (memory)
      type is (steel_memory)
         call find_branch(self, memory%now, branch, direction)
      end select
   end subroutine next

   !> Set the branch that begins at the end of the present one in a direction, +1 or -1. It ends where the
   !> next element comes to its limit, a row of the table begins, the reach begins to grow, or strength ends.
   subroutine find_branch(self, now, branch, direction)
      type(steel_rule), intent(in) :: self
      type(steel_state), intent(inout) :: now
      !> The branch that ends, replaced by its successor
      type(segment), intent(inout) :: branch
      integer, intent(in) :: direction
      !> As seen in the direction: forces, their limits, growth of the limits with the deformation
      real(wp) :: s(elements), limit(elements), growth(elements)
      real(wp) :: end_of_reach, reach, ahead, far, f, slope
      integer :: i, n
      logical :: growing, one_slips, slips(elements)

      n = self%limited
      call bring(branch%end_toward(direction))
      reach = now%highest - now%lowest
      end_of_reach = merge(now%highest, now%lowest, direction > 0)
      ! Beyond the extreme in this direction the plastic reach, and with it the limits, grow.
      growing = direction*(end_of_reach - now%d) <= 0.0_wp
      call find_limits(growing, limit, growth, ahead)
      s = direction*now%s
      do i = 1, n
         slips(i) = s(i) >= limit(i) - near_limit*reach*self%k_element(i) .and. &
                    growth(i) < as_fast*self%k_element(i)
         if (slips(i)) s(i) = limit(i)
      end do
      one_slips = any(slips(:n))
      now%wear_rate = 0.0_wp
      if (self%endurance > 0.0_wp .and. .not. growing .and. one_slips) then
         call wear(bowing(direction), limit, slips, growth, ahead)
      end if
      now%rate(:n) = merge(growth(:n), self%k_element(:n), slips(:n))
      do i = 1, n
         if (growth(i) >= as_fast*self%k_element(i) .or. slips(i)) cycle
         ahead = min(ahead, (limit(i) - s(i))/(self%k_element(i) - growth(i)))
      end do
      now%s(:n) = direction*s(:n)

      ! Force and slope of the bank.
      f = 0.0_wp
      if (n < elements) f = now%s(elements)
      f = f + direction*sum(s(:n))
      slope = self%k
      if (one_slips) slope = sum(now%rate)
      if (abs(slope) <= no_stiffness*self%k) slope = 0.0_wp
      far = direction*unbounded
      if (ahead < unbounded) far = now%d + direction*ahead
      if (.not. growing .and. direction*(end_of_reach - far) <= 0.0_wp) far = end_of_reach
      branch = segment(d0=now%d, f0=f, k=slope)
      call branch%lead_outward(direction, near=now%d, far=far, unload_on_reversal=growing .or. one_slips)

   contains

      !> Bring forces, wear and extremes along the present branch to its end at the deformation d [m].
      subroutine bring(d)
         real(wp), intent(in) :: d
         integer :: n

         n = self%limited
         now%s(:n) = now%s(:n) + now%rate(:n)*(d - now%d)
         ! Hardening without end is a line through the origin.
         if (n < elements) now%s(elements) = self%k_post*d
         now%worn = now%worn + now%wear_rate*abs(d - now%d)
         now%d = d
         now%highest = max(now%highest, d)
         now%lowest = min(now%lowest, d)
      end subroutine bring

      !> Limits of the elements, their growth with the deformation, and distance to the next row of the table.
      subroutine find_limits(growing, limit, growth, ahead)
         !> Whether the plastic reach grows along the branch; if not, the limits stay
         logical, intent(in) :: growing
         !> (elements) [N], (elements) [N/m]; [m], `unbounded` if no row follows
         real(wp), intent(out) :: limit(elements), growth(elements), ahead
         real(wp) :: q, distance, strength
         integer :: row

         strength = 1.0_wp
         if (self%endurance > 0.0_wp) then
            strength = max(0.0_wp, 1.0_wp - now%worn/(2.0_wp*self%endurance*self%d_y))
         end if
         ! Plastic reach: how far the deformation has gone both ways, over d_y, beyond the elastic range.
         q = (now%highest - now%lowest)/self%d_y - 2.0_wp
         growth = 0.0_wp
         ahead = unbounded
         associate (table => self%table)
            do row = 1, table%rows - 1
               if (q < table%q(row + 1) - on_row*(2.0_wp + q)) exit
            end do
            limit = strength*self%d_y*self%k_element*table%y(:, row)
            if (row == table%rows) return
            distance = table%q(row + 1) - table%q(row)
            growth = strength*self%k_element*(table%y(:, row + 1) - table%y(:, row))/distance
            limit = limit + growth*(q - table%q(row))*self%d_y
            ahead = (table%q(row + 1) - q)*self%d_y
            if (growing) return
            growth = 0.0_wp
            ahead = unbounded
         end associate
      end subroutine find_limits

      !> Factor of the wear: a bar that has been stretched beyond `d_buckle` bows when it is compressed, and
      !> a bar that is bowed and straightened cracks. The largest elongation is settled where the bar turns
      !> back.
      real(wp) function bowing(direction)
         !> +1: the bar lengthens, without an effect; -1: it is compressed
         integer, intent(in) :: direction

         bowing = 1.0_wp
         if (direction > 0 .or. .not. self%buckling > 0.0_wp) return
         if (now%highest <= self%d_buckle) return
         bowing = min(1.0_wp + self%buckling*(now%highest/self%d_buckle - 1.0_wp), self%most_wear)
      end function bowing

      !> Wear and force along a branch determine each other: the limits y_i lose e_i for each unit of plastic
      !> deformation d - f/k, and its share in the deformation follows from the slope that this gives.
      subroutine wear(times, limit, slips, growth, ahead)
         !> Weight of a unit of plastic deformation
         real(wp), intent(in) :: times
         !> Limits of the elements [N], and which of them slip
         real(wp), intent(in) :: limit(elements)
         logical, intent(in) :: slips(elements)
         !> (elements) [N/m]
         real(wp), intent(out) :: growth(elements)
         !> Distance to the deformation at which no strength is left [m]
         real(wp), intent(inout) :: ahead
         real(wp) :: left, loss(elements), slope, slipping
         integer :: n

         n = self%limited
         growth = 0.0_wp
         left = 2.0_wp*self%endurance*self%d_y - now%worn
         ! No strength is left.
         if (left <= near_limit*(now%highest - now%lowest)) then
            now%worn = 2.0_wp*self%endurance*self%d_y
            return
         end if
         loss(:n) = times*limit(:n)/left
         slipping = sum(loss(:n), mask=slips(:n))
         slope = sum(self%k_element(:n), mask=.not. slips(:n)) - slipping
         if (n < elements) slope = slope + self%k_post
         slope = slope/(1.0_wp - slipping/self%k)
         growth(:n) = -loss(:n)*(1.0_wp - slope/self%k)
         now%wear_rate = times*(1.0_wp - slope/self%k)
         ahead = min(ahead, left/now%wear_rate)
      end subroutine wear
   end subroutine find_branch

   !> The limits of the elements over k_i d_y, in rows of the plastic reach.
   pure subroutine make_table(self, table)
      type(steel_rule), intent(in) :: self
      type(table_type), intent(out) :: table
      real(wp) :: b, r, q, strength, distance, y_u
      integer :: j

      table%rows = size(reaches)
      table%q(:table%rows) = reaches
      ! Deformations over that at yield; y_u is where hardening ends at f_u.
      y_u = 1.0_wp
      if (is_given(self%f_u)) then
         b = self%k_post/self%k
         y_u = max(1.0_wp, (self%f_u/self%f_y - (1.0_wp - b))/b)
         if (self%plateau > 0.0_wp) then
            call insert_row(table, self%plateau)
            call insert_row(table, self%plateau + (y_u - 1.0_wp))
         end if
      end if
      table%y(elements, :) = y_u
      if (self%plateau > 0.0_wp) then
         table%y(elements, :) = 1.0_wp + min(max(table%q - self%plateau, 0.0_wp), y_u - 1.0_wp)
      end if
      ! With more plastic reach the corner gets rounder (a smaller r), and the strength grows.
      do j = 2, table%rows
         associate (before => table%y(:yielding, j - 1), y => table%y(:yielding, j))
            q = min(table%q(j), reaches(size(reaches)))
            distance = table%q(j) - table%q(j - 1)
            r = max(least_r, self%r0*(1.0_wp - self%cr1*q/(self%cr2 + q)))
            strength = 1.0_wp + self%isotropic_hardening*(0.5_wp*q/self%hardening_reach)**0.8_wp
            strength = min(strength, sum(share*before) + 0.9_wp*distance)
            y = strength*round_limits(r)
            call limit_row(y, strength, max(before - distance, 0.0_wp), before + distance)
            ! Apart from round-off the limit moves as fast as its element.
            where (y - before > as_fast*distance) y = before + distance
         end associate
      end do
   end subroutine make_table

   !> Make a corner of the plateau a row; it replaces a row next to it.
   pure subroutine insert_row(table, q)
      type(table_type), intent(inout) :: table
      !> Plastic reach of the corner
      real(wp), intent(in) :: q
      integer :: place

      if (q <= same_row) return
      place = minloc(abs(table%q(:table%rows) - q), dim=1)
      if (abs(table%q(place) - q) > same_row*max(1.0_wp, q)) then
         place = count(table%q(:table%rows) < q) + 1
         table%q(place + 1:table%rows + 1) = table%q(place:table%rows)
         table%rows = table%rows + 1
      end if
      table%q(place) = q
   end subroutine insert_row

   !> Limits of the elements for which the polygon follows g = x/(1 + x^R)^(1/R): its tangent of slope m meets
   !> x = 0 at c with c^p + m^p = 1, p = R/(R + 1). The polygon is moved from outside the curve to both sides
   !> of it; its asymptote is exact.
   pure function round_limits(r) result(x)
      !> Roundness R; limits over k_i d_y
      real(wp), intent(in) :: r
      real(wp) :: x(yielding), c(0:yielding), p

      p = r/(r + 1.0_wp)
      c = (1.0_wp - 0.03_wp/r)*(1.0_wp - slopes**p)**(1.0_wp/p)
      c(0) = 0.0_wp
      c(yielding) = 1.0_wp
      x = (c(1:) - c(:yielding - 1))/share
   end function round_limits

   !> Keep limits within bounds, and shift all by one value c so that the bank has a given strength.
   pure subroutine limit_row(y, strength, least, most)
      !> Limits over k_i d_y, each between `least` and `most`
      real(wp), intent(inout) :: y(:)
      !> Strength of the bank over that of the virgin one
      real(wp), intent(in) :: strength
      real(wp), intent(in) :: least(:), most(:)
      real(wp) :: from(size(y)), low, high, c, shortfall, free
      integer :: i

      from = y
      low = minval(least - from)
      high = maxval(most - from)
      c = min(max(0.0_wp, low), high)
      ! The sum is made of straight pieces in c: Newton's method ends on the right one.
      do i = 1, 200
         y = min(max(from + c, least), most)
         shortfall = strength - sum(share*y)
         if (abs(shortfall) <= 1.0e-15_wp*strength) exit
         if (shortfall > 0.0_wp) low = c
         if (shortfall < 0.0_wp) high = c
         free = sum(share, mask=from + c > least .and. from + c < most)
         if (free > 0.0_wp) then
            c = max(min(c + shortfall/free, high), low)
         else
            c = 0.5_wp*(low + high)
         end if
      end do
   end subroutine limit_row

   !> Become a copy of the memory of another spring of this rule.
   pure subroutine copy(self, other)
      class(steel_memory), intent(inout) :: self
      class(rule_memory), intent(in) :: other

      select type (other)
      type is (steel_memory)
         self%now = other%now
      end select
   end subroutine copy

   !> Save or restore the state.
   pure subroutine serialize(self, stream)
      class(steel_memory), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%item(self%now%s)
      call stream%item(self%now%rate)
      call stream%items(self%now%d, self%now%highest, self%now%lowest, self%now%worn, self%now%wear_rate)
   end subroutine serialize

end module rbs_hysteresis_rules_steel
