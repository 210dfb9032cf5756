!> Concrete across a joint: a normal spring that crushes, opens and closes again.
!>
!> Opening is positive, so the spring works at negative deformations; inside, `c` = -d is the closing.
!> Envelope: the curve of Popovics (1973), as chords, to the peak, a line of softening, a residual. Plastic
!> closing after unloading: Karsan and Jirsa (1969). Faces that were apart do not match: they touch
!> before the plastic closing is reached (Stanton and McNiven 1979 call it focal point), which makes the
!> closing of a crack gradual.
!>
!> Between the envelope and zero force the spring follows an elastic path of two lines. This path changes
!> only without force, or on the envelope in such a way that the path never stores more
!> than the envelope gave: closed loops give no energy. Every change is in proportion to the movement that
!> causes it: small reversals have small effects.
!>
!> With `friction` the path of opening has only a share of the force of the path of closing. Between the two
!> the spring moves with its initial stiffness, as a block that rubs: a crack that closes and opens again
!> takes up energy, whether the crack opens or not.
module rbs_hysteresis_rules_concrete
   use rbs_base_check, only: check_order
   use rbs_base_error, only: message_list
   use rbs_base_key_visitor, only: key_visitor
   use rbs_base_keys, only: above_zero, not_negative, share_below_one, force, deformation, stiffness
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_base_constants, only: unbounded, unset
   use rbs_base_tolerances, only: parallel, same_input
   use rbs_hysteresis_rule, only: rule_type, rule_memory, check_product
   use rbs_hysteresis_segment, only: segment
   implicit none
   private

   public :: concrete_rule

   !> Kinds of branch
   integer, parameter :: envelope = 1, unloading = 2, contact = 3, opening = 4, closing = 5
   !> With friction: on the lower path while the spring opens, and between the paths
   integer, parameter :: releasing = 6, parting = 7, between = 8

   !> Corners of the chords of the rising curve, as shares of the closing at the peak
   real(wp), parameter :: chord_ends(4) = [0.25_wp, 0.5_wp, 0.75_wp, 1.0_wp]

   type :: concrete_state
      !> Kind of the present branch
      integer :: kind = envelope
      !> Largest closing so far and the force there without wear; plastic closing [m, N]
      real(wp) :: c_u = 0.0_wp, f_u = 0.0_wp, c_p = 0.0_wp
      !> Largest force so far, without wear [N]
      real(wp) :: f_largest = 0.0_wp
      !> How far before the plastic closing the faces touch, and widest opening so far, from there too [m]
      real(wp) :: gap = 0.0_wp, widest = 0.0_wp
      !> Where the present opening began [m]; remaining share of the strength
      real(wp) :: c_opened = 0.0_wp, strength = 1.0_wp
   end type concrete_state

   type, extends(rule_memory) :: concrete_memory
      type(concrete_state) :: now
   contains
      procedure :: copy, serialize
   end type concrete_memory

   type, extends(rule_type) :: concrete_rule
      !> Initial stiffness [N/m]; largest force [N] and the closing there [m]
      real(wp) :: k = unset, f_peak = unset, d_peak = unset
      !> Slope of softening after the peak [N/m], positive, and the residual force [N]; factor of the plastic
      !> closing
      real(wp) :: k_soft = unset, f_res = 0.0_wp, plastic = 1.0_wp
      !> Share of the force at unloading at which a closing crack is fully closed; share of the widest opening
      !> at which its faces touch
      real(wp) :: contact = 0.0_wp, misfit = 0.0_wp
      !> Share of the strength that an opening takes, after twice the closing at the peak or more
      real(wp) :: wear = 0.0_wp
      !> Share of the force by which the path of opening is below that of closing
      real(wp) :: friction = 0.0_wp
      !> Whether opening and closing have paths of their own
      logical, private :: rubs = .false.
   contains
      procedure :: visit, prepare, check_relations, next
   end type concrete_rule

   !> A spring at an event: its rule, and the state that the event changes.
   type :: concrete_spring
      type(concrete_rule), pointer :: rule => null()
      type(concrete_state), pointer :: now => null()
      type(segment), pointer :: branch => null()
   end type concrete_spring

contains

   !> Present the parameters to a visitor.
   subroutine visit(self, v)
      class(concrete_rule), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%key('k', self%k, stiffness, above_zero, 'initial stiffness')
      call v%key('f_peak', self%f_peak, force, above_zero, 'largest compression')
      call v%key('d_peak', self%d_peak, deformation, above_zero, 'closing at the largest compression')
      call v%key('k_soft', self%k_soft, stiffness, above_zero, &
                 'slope of softening behind the peak, as a positive number')
      call v%key('f_res', self%f_res, force, not_negative, 'force that softening leaves')
      call v%key('plastic', self%plastic, '', not_negative, &
                 'factor of the plastic closing of Karsan and Jirsa')
      call v%key('contact', self%contact, '', share_below_one, &
                 'share of the force at unloading at which a closing crack is fully closed')
      call v%key('misfit', self%misfit, '', share_below_one, &
                 'share of the widest opening at which the faces of a closing crack touch')
      call v%key('wear', self%wear, '', share_below_one, &
                 'share of the strength that a wide opening of the crack takes')
      call v%key('friction', self%friction, '', share_below_one, &
                 'share of the force that opening gives up at once after closing to d_peak or more')
   end subroutine visit

   !> Initial stiffness, and memory and first branch of the virgin spring.
   subroutine prepare(self)
      class(concrete_rule), intent(inout) :: self
      type(concrete_state) :: virgin
      type(segment) :: branch

      self%initial_stiffness = self%k
      self%rubs = self%friction > 0.0_wp
      ! A closing spring at the lower end of this branch, at zero, goes on to the envelope: its first branch.
      branch%lo = 0.0_wp
      call find_branch(self, virgin, branch, -1)
      self%branch = branch
      self%memory = concrete_memory(now=virgin)
   end subroutine prepare

   !> Add a message for each pair of parameters that do not suit each other.
   subroutine check_relations(self, name, messages)
      class(concrete_rule), intent(inout) :: self
      character(len=*), intent(in) :: name
      type(message_list), intent(inout) :: messages

      call check_order(name, 'f_peak', self%f_peak, 'must be below', 'k d_peak', self%k*self%d_peak, &
                       ' (the curve bends towards its peak)', messages)
      call check_order(name, 'f_res', self%f_res, 'must not be above', 'f_peak', self%f_peak, &
                       ' (it is what is left of it)', messages)
      call check_product(self%k, self%d_peak, name, 'k d_peak', messages)
   end subroutine check_relations

   !> The branch after the present one, which the motion leaves going up (direction = +1) or down (-1).
   subroutine next(self, memory, branch, direction)
      class(concrete_rule), intent(in) :: self
      class(rule_memory), intent(inout) :: memory
      !> The branch that ends, replaced by its successor
      type(segment), intent(inout) :: branch
      integer, intent(in) :: direction

      select type (memory)
      type is (concrete_memory)
         call find_branch(self, memory%now, branch, direction)
      end select
   end subroutine next

   !> The next branch at the end of the present one, where the motion continues or reverses: from the point of
   !> closing c [m] and compression f [N].
   subroutine find_branch(self, now, branch, direction)
      type(concrete_rule), intent(in), target :: self
      type(concrete_state), intent(inout), target :: now
      !> The branch that ends, replaced by its successor
      type(segment), intent(inout), target :: branch
      !> -1: the spring closes, +1: it opens
      integer, intent(in) :: direction
      type(concrete_spring) :: spring
      real(wp) :: c, f

      spring = concrete_spring(self, now, branch)
      c = -branch%end_toward(direction)
      f = -branch%force(-c)
      if (direction < 0) then
         select case (now%kind)
         case (envelope)
            call follow_envelope(spring, c, f)
         case (unloading)
            call follow_envelope(spring, now%c_u, now%strength*now%f_u)
         case (contact)
            call unload(spring)
         case (opening)
            call widen(spring, c)
            ! The line of zero force while the crack closes, until the faces touch
            now%kind = closing
            branch = chord(c, 0.0_wp, now%c_p - now%gap, 0.0_wp)
            ! Openings are added up only if they have an effect.
            if (self%wear > 0.0_wp) call set_unloading(branch)
         case (releasing, parting)
            call rub(spring, c, f)
         case (between)
            call close_on(spring, c)
         case default                                    ! closing
            call touch(spring)
         end select
      else
         select case (now%kind)
         case (envelope)
            if (c > 0.0_wp) then
               ! The state keeps forces without wear.
               call leave_envelope(spring, c, f/now%strength)
               if (self%rubs) then
                  call rub(spring, c, f)
               else
                  call unload(spring)
               end if
            else
               call open_up(spring, c)
            end if
         case (unloading)
            if (self%rubs) then
               call rub(spring, c, f)
            else
               call touch(spring)
            end if
         case (contact)
            if (self%rubs .and. c > now%c_p - now%gap) then
               call rub(spring, c, f)
            else
               call open_up(spring, c)
            end if
         case (between)
            call release(spring, c)
         case (releasing)
            call release(spring, c)
         case default                                    ! opening or closing, without force
            call open_up(spring, c)
         end select
      end if
   end subroutine find_branch

   !> On the envelope from (c, f) to its next corner.
   subroutine follow_envelope(spring, c, f)
      type(concrete_spring), intent(inout) :: spring
      !> Where the spring is: closing [m], force [N]
      real(wp), intent(in) :: c, f
      real(wp) :: c_next, f_next, c_flat
      integer :: i

      associate (rule => spring%rule, now => spring%now, branch => spring%branch)
         now%kind = envelope
         do i = 1, size(chord_ends)
            c_next = chord_ends(i)*rule%d_peak
            if (c_next > c*(1.0_wp + same_input)) then
               f_next = now%strength*curve(rule, c_next)
               branch = chord(c, f, c_next, f_next)
               call set_unloading(branch)
               return
            end if
         end do
         c_flat = rule%d_peak + (rule%f_peak - rule%f_res)/rule%k_soft
         if (c_flat > c*(1.0_wp + same_input)) then
            branch = chord(c, f, c_flat, now%strength*rule%f_res)
         else
            branch = segment(d0=-c, f0=-f, lo=-unbounded, hi=-c)
         end if
         call set_unloading(branch)
      end associate
   end subroutine follow_envelope

   !> The motion has turned back on the envelope at (c, f), f without wear.
   subroutine leave_envelope(spring, c, f)
      type(concrete_spring), intent(inout) :: spring
      real(wp), intent(in) :: c, f
      real(wp) :: largest, share

      associate (rule => spring%rule, now => spring%now)
         ! Crushing wears down the unevenness of the faces: gap times force does not grow, or the path of
         ! unloading would store more than the envelope has given.
         largest = f
         if (c > rule%d_peak) largest = rule%f_peak
         if (largest > now%f_largest) then
            now%gap = now%gap*(now%f_largest/largest)
            now%f_largest = largest
         end if
         now%c_u = c
         now%f_u = f
         ! Up to the end of the first chord the spring is elastic.
         share = karsan_jirsa(c/rule%d_peak) - karsan_jirsa(chord_ends(1))
         ! Unloading is never stiffer than `k`.
         now%c_p = max(min(rule%plastic*share*rule%d_peak, c - f/rule%k), 0.0_wp)
      end associate
   end subroutine leave_envelope

   !> On the line of unloading between full closing and the envelope.
   subroutine unload(spring)
      type(concrete_spring), intent(inout) :: spring
      real(wp) :: c_closed, f_closed

      associate (rule => spring%rule, now => spring%now, branch => spring%branch)
         now%kind = unloading
         call full_closing(spring, c_closed, f_closed)
         branch = chord(c_closed, f_closed, now%c_u, now%strength*now%f_u)
         if (rule%rubs) then
            call set_unloading(branch)
         else
            branch%includes_upper_end = .not. now%gap > 0.0_wp
         end if
      end associate
   end subroutine unload

   !> On the line between the first touch of the faces and full closing. Without a gap this line has no
   !> length: a spring that closes goes on to `unload`, any other opens.
   subroutine touch(spring)
      type(concrete_spring), intent(inout) :: spring
      real(wp) :: c_closed, f_closed

      associate (rule => spring%rule, now => spring%now, branch => spring%branch)
         call full_closing(spring, c_closed, f_closed)
         if (now%gap > 0.0_wp) then
            now%kind = contact
            ! The lines before and after it lead both ways, so both corners belong to this line.
            branch = chord(now%c_p - now%gap, 0.0_wp, c_closed, f_closed)
            branch%includes_lower_end = .true.
            branch%includes_upper_end = .true.
            if (rule%rubs) call set_unloading(branch)
         else if (now%kind == closing) then
            call unload(spring)
         else
            call open_up(spring, now%c_p)
         end if
      end associate
   end subroutine touch

   !> Between the paths through (c, f): as stiff as the virgin spring, up to the path of closing and down
   !> to that of opening.
   subroutine rub(spring, c, f)
      type(concrete_spring), intent(inout) :: spring
      !> Where the spring is: closing [m], compression [N]
      real(wp), intent(in) :: c, f
      !> Closing at which this line meets the path of closing and that of opening
      real(wp) :: upper, lower

      associate (rule => spring%rule, now => spring%now, branch => spring%branch)
         upper = c
         lower = c
         if (now%kind == releasing .or. now%kind == parting) then
            upper = min(max(meeting(spring, 1.0_wp, c, f), c), now%c_u)
         else
            lower = min(meeting(spring, 1.0_wp - share_of_friction(spring), c, f), c)
         end if
         now%kind = between
         branch = segment(d0=-c, f0=-f, k=rule%k, lo=-upper, hi=-lower)
      end associate
   end subroutine rub

   !> The share by which the path of opening is below that of closing: zero where the spring has not closed
   !> beyond the elastic first chord, `friction` from `d_peak` on.
   real(wp) function share_of_friction(spring)
      type(concrete_spring), intent(inout) :: spring

      share_of_friction = (spring%now%c_u/spring%rule%d_peak - chord_ends(1))/(1.0_wp - chord_ends(1))
      share_of_friction = spring%rule%friction*min(max(share_of_friction, 0.0_wp), 1.0_wp)
   end function share_of_friction

   !> Closing at which the line of the initial stiffness through (c, f) meets a path [m].
   real(wp) function meeting(spring, share, c, f)
      type(concrete_spring), intent(inout) :: spring
      !> Force of that path over that of the path of closing; closing [m] and compression [N] of the spring
      real(wp), intent(in) :: share, c, f
      real(wp) :: c_closed, f_closed, c_0, f_0, slope

      associate (rule => spring%rule, now => spring%now)
         call full_closing(spring, c_closed, f_closed)
         if (f + rule%k*(c_closed - c) < share*f_closed) then
            c_0 = c_closed
            f_0 = share*f_closed
            meeting = c_0
            ! The path ends where it closes.
            if (.not. now%c_u > c_0) return
            slope = (share*now%strength*now%f_u - f_0)/(now%c_u - c_0)
         else
            c_0 = now%c_p - now%gap
            f_0 = 0.0_wp
            slope = 0.0_wp
            ! Before it the path has no force.
            if (c_closed > c_0 .and. f < rule%k*(c - c_0)) slope = share*f_closed/(c_closed - c_0)
         end if
         ! Both lines from c_0 on.
         meeting = c_0
         if (rule%k*(1.0_wp - parallel) > slope) then
            meeting = c_0 + (f_0 - f - rule%k*(c_0 - c))/(rule%k - slope)
         end if
         meeting = max(meeting, now%c_p - now%gap)
      end associate
   end function meeting

   !> On the path of closing from the closing c [m] on: the envelope, unloading, or contact.
   subroutine close_on(spring, c)
      type(concrete_spring), intent(inout) :: spring
      real(wp), intent(in) :: c
      real(wp) :: c_closed, f_closed

      associate (now => spring%now, branch => spring%branch)
         call full_closing(spring, c_closed, f_closed)
         if (c >= now%c_u) then
            call follow_envelope(spring, now%c_u, now%strength*now%f_u)
         else if (c >= c_closed) then
            call unload(spring)
            branch%hi = -c
         else
            now%kind = contact
            branch = chord(now%c_p - now%gap, 0.0_wp, c_closed, f_closed)
            branch%hi = -c
            call set_unloading(branch)
         end if
      end associate
   end subroutine close_on

   !> On the path of opening from the closing c [m] on: releasing, parting, or open.
   subroutine release(spring, c)
      type(concrete_spring), intent(inout) :: spring
      real(wp), intent(in) :: c
      real(wp) :: c_closed, f_closed, left, c_none

      associate (now => spring%now, branch => spring%branch)
         call full_closing(spring, c_closed, f_closed)
         left = 1.0_wp - share_of_friction(spring)
         c_none = now%c_p - now%gap
         if (c > c_closed) then
            now%kind = releasing
            branch = chord(c_closed, left*f_closed, now%c_u, left*now%strength*now%f_u)
         else if (c > c_none) then
            now%kind = parting
            branch = chord(c_none, 0.0_wp, c_closed, left*f_closed)
         else
            call open_up(spring, c)
            return
         end if
         branch%lo = -c
         branch%includes_lower_end = .true.
         branch%unload_on_reversal = 1
      end associate
   end subroutine release

   !> Where a closing crack is fully closed: without a gap at the plastic closing, without force.
   subroutine full_closing(spring, c, f)
      type(concrete_spring), intent(inout) :: spring
      !> Closing [m] and force [N]
      real(wp), intent(out) :: c, f

      associate (rule => spring%rule, now => spring%now)
         c = now%c_p
         f = 0.0_wp
         if (.not. now%gap > 0.0_wp) return
         c = now%c_p + rule%contact*(now%c_u - now%c_p)
         f = rule%contact*now%strength*now%f_u
      end associate
   end subroutine full_closing

   !> The line of zero force while the crack opens, from the closing c.
   subroutine open_up(spring, c)
      type(concrete_spring), intent(inout) :: spring
      real(wp), intent(in) :: c

      spring%now%kind = opening
      spring%now%c_opened = c
      spring%branch = segment(d0=-c, lo=-c, hi=unbounded, includes_lower_end=.true., unload_on_reversal=1)
   end subroutine open_up

   !> The crack has opened to a closing c: the wider it was, the earlier its faces touch, and the
   !> strength falls with the way. There is no force, so neither acts at once.
   subroutine widen(spring, c)
      type(concrete_spring), intent(inout) :: spring
      !> Closing where the opening ended [m], below the plastic closing
      real(wp), intent(in) :: c
      !> Width of the opening where it began and where it ended, from the plastic closing; the part of this
      !> way up to the widest opening so far; the way as a number of full openings
      real(wp) :: before, width, inside, openings

      associate (rule => spring%rule, now => spring%now)
         before = now%c_p - now%c_opened
         width = now%c_p - c
         now%gap = max(now%gap, rule%misfit*width)
         if (rule%wear > 0.0_wp .and. now%c_u > 0.0_wp) then
            ! The way over the width so far, integrated as the width grows.
            inside = min(width, now%widest) - min(before, now%widest)
            openings = inside/(now%widest + rule%d_peak)
            if (width > now%widest) then
               openings = openings + log((width + rule%d_peak)/(max(now%widest, before) + rule%d_peak))
            end if
            now%strength = now%strength* &
                            (1.0_wp - rule%wear)**(openings*min(1.0_wp, 0.5_wp*now%c_u/rule%d_peak))
         end if
         now%widest = max(now%widest, width)
      end associate
   end subroutine widen

   !> Plastic closing after unloading from x, both over the closing at the peak (Karsan and Jirsa 1969); a
   !> straight line beyond x = 2.
   elemental real(wp) function karsan_jirsa(x)
      real(wp), intent(in) :: x

      karsan_jirsa = 0.145_wp*x**2 + 0.13_wp*x
      if (x > 2.0_wp) karsan_jirsa = 0.84_wp + 0.834_wp*(x - 2.0_wp)
   end function karsan_jirsa

   !> Rising curve of Popovics (1973) [N]; straight up to its peak where the secant is as stiff as `k`.
   pure real(wp) function curve(self, c)
      type(concrete_rule), intent(in) :: self
      !> Closing, up to the one at the peak [m]
      real(wp), intent(in) :: c
      real(wp) :: x, r

      x = c/self%d_peak
      ! Input has k above the secant; if only round-off parts them, r is large and the curve straight.
      r = self%k/max(self%k - self%f_peak/self%d_peak, epsilon(1.0_wp)*self%k)
      curve = self%f_peak*x*r/(r - 1.0_wp + x**r)
   end function curve

   !> The line through two points (closing [m], compression [N]), of which the second is further closed; both
   !> ends belong to the next lines.
   pure type(segment) function chord(c_1, f_1, c_2, f_2) result(branch)
      real(wp), intent(in) :: c_1, f_1, c_2, f_2

      branch = segment(d0=-c_1, f0=-f_1, lo=-c_2, hi=-c_1)
      if (c_2 > c_1) branch%k = (f_2 - f_1)/(c_2 - c_1)
   end function chord

   !> Let a branch along which the spring closes be left as soon as the motion turns back.
   pure subroutine set_unloading(branch)
      type(segment), intent(inout) :: branch

      branch%includes_upper_end = .true.
      branch%unload_on_reversal = -1
   end subroutine set_unloading

   !> Become a copy of the memory of another spring of this rule.
   pure subroutine copy(self, other)
      class(concrete_memory), intent(inout) :: self
      class(rule_memory), intent(in) :: other

      select type (other)
      type is (concrete_memory)
         self%now = other%now
      end select
   end subroutine copy

   !> Save or restore the state.
   pure subroutine serialize(self, stream)
      class(concrete_memory), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      associate (now => self%now)
         call stream%item(now%kind)
         call stream%items(now%c_u, now%f_u, now%c_p, now%f_largest, now%gap, now%widest, now%c_opened, &
                           now%strength)
      end associate
   end subroutine serialize

end module rbs_hysteresis_rules_concrete
