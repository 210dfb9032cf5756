!> Concrete across a joint: a normal spring that crushes, opens and closes again.
!>
!> Opening is positive, so the spring works at negative deformations; inside, `c` = -d is the closing.
!> Envelope: the curve of Popovics (1973), as chords, to the peak, a line of softening, a residual. Plastic
!> closing after unloading: Karsan and Jirsa (1969). Faces that were apart do not match: they touch
!> before the plastic closing is reached (Stanton and McNiven 1979 call it focal point), which makes the
!> closing of a crack gradual.
!>
!> Between the envelope and zero force the spring follows an elastic path of two lines. What changes this
!> path does so while there is no force, or on the envelope in such a way that the path never stores more
!> than the envelope gave: closed loops give no energy. Every change is in proportion to the movement that
!> causes it: small reversals have small effects.
!>
!> With `friction` the path of opening has only a share of the force of the path of closing. Between the two
!> the spring moves with its initial stiffness, as a block that rubs: what is closed and opened again takes
!> up energy, whether the crack opens or not.
module rbs_hysteresis_concrete
   use rbs_base_error, only: message_list
   use rbs_base_keys, only: bound_type, key_type, above_zero, not_negative, share_below_one, &
                           force, deformation, stiffness
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_base_text, only: to_text
   use rbs_base_constants, only: unbounded
   use rbs_hysteresis_rule, only: rule_type, check_product, places_length, in_axial, in_layer
   use rbs_hysteresis_segment, only: segment
   implicit none
   private

   public :: concrete_rule

   !> Kinds of the present line
   integer, parameter :: envelope = 1, unloading = 2, contact = 3, opening = 4, closing = 5
   !> With friction: on the lower path while the spring opens, and between the paths
   integer, parameter :: releasing = 6, parting = 7, between = 8

   !> Corners of the chords of the rising curve, as shares of the closing at the peak
   real(wp), parameter :: chord_ends(4) = [0.25_wp, 0.5_wp, 0.75_wp, 1.0_wp]

   type(key_type), parameter :: parameters(*) = [ &
      key_type('k', unit=stiffness, bound=above_zero, &
               meaning='initial stiffness'), &
      key_type('f_peak', unit=force, bound=above_zero, &
               meaning='largest compression'), &
      key_type('d_peak', unit=deformation, bound=above_zero, &
               meaning='closing at the largest compression'), &
      key_type('k_soft', unit=stiffness, bound=above_zero, &
               meaning='slope of softening behind the peak, as a positive number'), &
      key_type('f_res', unit=force, bound=not_negative, default=0.0_wp, &
               meaning='force that softening leaves'), &
      key_type('plastic', bound=not_negative, default=1.0_wp, &
               meaning='factor of the plastic closing of Karsan and Jirsa'), &
      key_type('contact', bound=share_below_one, default=0.0_wp, &
               meaning='share of the force at unloading at which a closing crack is fully closed'), &
      key_type('misfit', bound=share_below_one, default=0.0_wp, &
               meaning='share of the widest opening at which the faces of a closing crack touch'), &
      key_type('wear', bound=share_below_one, default=0.0_wp, &
               meaning='share of the strength that a wide opening of the crack takes'), &
      key_type('friction', bound=share_below_one, default=0.0_wp, &
               meaning='share of the force that opening gives up at once after closing to d_peak or more'), &
      key_type('seating', bound=bound_type(0.0_wp, 1.0_wp, reason='(it is a share)'), default=0.0_wp, &
               meaning='share of the early touch that opening does not follow: what was pressed '// &
               'together fits')]

   type, extends(rule_type) :: concrete_rule
      !> Initial stiffness [N/m]
      real(wp) :: k = 0.0_wp
      !> Largest force [N] and the closing there [m]
      real(wp) :: f_peak = 0.0_wp, d_peak = 0.0_wp
      !> Slope of softening after the peak [N/m], positive, and the residual force [N]
      real(wp) :: k_soft = 0.0_wp, f_res = 0.0_wp
      !> Factor of the plastic closing
      real(wp) :: plastic = 1.0_wp
      !> Share of the force at unloading at which a closing crack is fully closed
      real(wp) :: contact = 0.0_wp
      !> Share of the widest opening at which its faces touch
      real(wp) :: misfit = 0.0_wp
      !> Share of the strength that an opening takes, after twice the closing at the peak or more
      real(wp) :: wear = 0.0_wp
      !> Share of the force by which the path of opening is below that of closing
      real(wp) :: friction = 0.0_wp
      !> Share of the gap that opening does not follow; whether opening and closing have paths of their own
      real(wp) :: seating = 0.0_wp
      logical, private :: rubs = .false.
      integer, private :: stage = envelope
      !> Largest closing so far and the force there without wear; plastic closing [m, N]
      real(wp), private :: c_u = 0.0_wp, f_u = 0.0_wp, c_p = 0.0_wp
      !> Largest force so far, without wear [N]
      real(wp), private :: f_largest = 0.0_wp
      !> How far before the plastic closing the faces touch, and widest opening so far, from there too [m]
      real(wp), private :: gap = 0.0_wp, widest = 0.0_wp
      !> Where the present opening began [m]; remaining share of the strength
      real(wp), private :: c_opened = 0.0_wp, strength = 1.0_wp
   contains
      procedure, nopass :: keys
      procedure, nopass :: places
      procedure :: set
      procedure :: initial_stiffness
      procedure :: check
      procedure :: start
      procedure :: next
      procedure :: copy_memory
      procedure :: serialize
   end type concrete_rule

contains

   pure function keys()
      type(key_type), allocatable :: keys(:)

      keys = parameters
   end function keys

   pure function places()
      character(len=places_length) :: places

      places = in_axial//' '//in_layer
   end function places

   pure subroutine set(self, value)
      class(concrete_rule), intent(inout) :: self
      real(wp), intent(in) :: value(:)

      self%k = value(1)
      self%f_peak = value(2)
      self%d_peak = value(3)
      self%k_soft = value(4)
      self%f_res = value(5)
      self%plastic = value(6)
      self%contact = value(7)
      self%misfit = value(8)
      self%wear = value(9)
      self%friction = value(10)
      self%seating = value(11)
      self%rubs = self%friction > 0.0_wp .or. self%seating > 0.0_wp
   end subroutine set

   pure real(wp) function initial_stiffness(self)
      class(concrete_rule), intent(in) :: self

      initial_stiffness = self%k
   end function initial_stiffness

   subroutine check(self, name, messages)
      class(concrete_rule), intent(in) :: self
      character(len=*), intent(in) :: name
      type(message_list), intent(inout) :: messages

      if (self%f_peak >= self%k*self%d_peak) then
         call messages%add(name//': f_peak = '//to_text(self%f_peak)//' must be below k d_peak = '// &
                           to_text(self%k*self%d_peak)//' (the curve bends towards its peak)')
      end if
      if (self%f_res > self%f_peak) then
         call messages%add(name//': f_res = '//to_text(self%f_res)//' must not be above f_peak = '// &
                           to_text(self%f_peak)//' (it is what is left of it)')
      end if
      call check_product(self%k, self%d_peak, name, 'k d_peak', messages)
   end subroutine check

   subroutine start(self, line)
      class(concrete_rule), intent(inout) :: self
      type(segment), intent(out) :: line

      self%c_u = 0.0_wp
      self%f_u = 0.0_wp
      self%c_p = 0.0_wp
      self%f_largest = 0.0_wp
      self%gap = 0.0_wp
      self%widest = 0.0_wp
      self%strength = 1.0_wp
      call follow_envelope(self, 0.0_wp, 0.0_wp, line)
   end subroutine start

   subroutine next(self, line, direction)
      class(concrete_rule), intent(inout) :: self
      type(segment), intent(inout) :: line
      integer, intent(in) :: direction
      real(wp) :: c, f

      c = -line%end_toward(direction)
      f = -line%force(-c)
      if (direction < 0) then
         select case (self%stage)
         case (envelope)
            call follow_envelope(self, c, f, line)
         case (unloading)
            call follow_envelope(self, self%c_u, self%strength*self%f_u, line)
         case (contact)
            call unload(self, line)
         case (opening)
            call widen(self, c)
            if (self%seating > 0.0_wp .and. c > self%c_p - self%gap) then
               call rub(self, c, 0.0_wp, line)
            else
               call close_up(self, c, line)
            end if
         case (releasing, parting)
            call rub(self, c, f, line)
         case (between)
            call close_on(self, c, line)
         case default
            call touch(self, line)
         end select
      else
         select case (self%stage)
         case (envelope)
            if (c > 0.0_wp) then
               call leave_envelope(self, c, f/self%strength)
               if (self%rubs) then
                  call rub(self, c, f, line)
               else
                  call unload(self, line)
               end if
            else
               call open_up(self, c, line)
            end if
         case (unloading)
            if (self%rubs) then
               call rub(self, c, f, line)
            else
               call touch(self, line)
            end if
         case (contact)
            if (self%rubs .and. c > self%c_p - self%gap) then
               call rub(self, c, f, line)
            else
               call open_up(self, c, line)
            end if
         case (between)
            call release(self, c, line)
         case (releasing)
            call release(self, c, line)
         case default
            call open_up(self, c, line)
         end select
      end if
   end subroutine next

   !> On the envelope from (c, f) to its next corner.
   subroutine follow_envelope(self, c, f, line)
      type(concrete_rule), intent(inout) :: self
      !> Where the spring is: closing [m], force [N]
      real(wp), intent(in) :: c, f
      type(segment), intent(out) :: line
      real(wp) :: c_next, f_next, c_flat
      integer :: i

      self%stage = envelope
      do i = 1, size(chord_ends)
         c_next = chord_ends(i)*self%d_peak
         if (c_next > c*(1.0_wp + 1.0e-9_wp)) then
            f_next = self%strength*curve(self, c_next)
            line = chord(c, f, c_next, f_next)
            call set_one_way(line)
            return
         end if
      end do
      c_flat = self%d_peak + (self%f_peak - self%f_res)/self%k_soft
      if (c_flat > c*(1.0_wp + 1.0e-9_wp)) then
         line = chord(c, f, c_flat, self%strength*self%f_res)
      else
         line = segment(d0=-c, f0=-f, lo=-unbounded, hi=-c)
      end if
      call set_one_way(line)
   end subroutine follow_envelope

   !> The motion has turned back on the envelope at (c, f), f without wear.
   pure subroutine leave_envelope(self, c, f)
      type(concrete_rule), intent(inout) :: self
      real(wp), intent(in) :: c, f
      real(wp) :: largest, share

      ! Crushing wears down what keeps the faces apart: gap times force does not grow, or the path of
      ! unloading would store more than the envelope has given.
      largest = f
      if (c > self%d_peak) largest = self%f_peak
      if (largest > self%f_largest) then
         self%gap = self%gap*(self%f_largest/largest)
         self%f_largest = largest
      end if
      self%c_u = c
      self%f_u = f
      share = karsan_jirsa(c/self%d_peak) - karsan_jirsa(chord_ends(1))
      ! Unloading is never stiffer than `k`.
      self%c_p = max(min(self%plastic*share*self%d_peak, c - f/self%k), 0.0_wp)
   end subroutine leave_envelope

   !> Plastic closing after unloading from x, both over the closing at the peak (Karsan and Jirsa 1969); a
   !> straight line beyond x = 2.
   elemental real(wp) function karsan_jirsa(x)
      real(wp), intent(in) :: x

      karsan_jirsa = 0.145_wp*x**2 + 0.13_wp*x
      if (x > 2.0_wp) karsan_jirsa = 0.84_wp + 0.834_wp*(x - 2.0_wp)
   end function karsan_jirsa

   !> On the line of unloading between full closing and the envelope.
   subroutine unload(self, line)
      type(concrete_rule), intent(inout) :: self
      type(segment), intent(out) :: line
      real(wp) :: c_closed, f_closed

      self%stage = unloading
      call full_closing(self, c_closed, f_closed)
      line = chord(c_closed, f_closed, self%c_u, self%strength*self%f_u)
      if (self%rubs) then
         call set_one_way(line)
      else
         line%hi_closed = .not. self%gap > 0.0_wp
      end if
   end subroutine unload

   !> On the line between the first touch of the faces and full closing; without length it is skipped.
   subroutine touch(self, line)
      type(concrete_rule), intent(inout) :: self
      type(segment), intent(inout) :: line
      real(wp) :: c_closed, f_closed

      call full_closing(self, c_closed, f_closed)
      if (self%gap > 0.0_wp) then
         self%stage = contact
         ! The lines before and after it lead both ways, so both corners belong to this line.
         line = chord(self%c_p - self%gap, 0.0_wp, c_closed, f_closed)
         line%lo_closed = .true.
         line%hi_closed = .true.
         if (self%rubs) call set_one_way(line)
      else if (self%stage == closing) then
         call unload(self, line)
      else
         call open_up(self, self%c_p, line)
      end if
   end subroutine touch

   !> Between the paths through (c, f): as stiff as the virgin spring, up to the path of closing and down to
   !> that of opening.
   subroutine rub(self, c, f, line)
      type(concrete_rule), intent(inout) :: self
      real(wp), intent(in) :: c, f
      type(segment), intent(out) :: line
      real(wp) :: upper, lower

      upper = c
      lower = c
      if (self%stage == releasing .or. self%stage == parting .or. self%stage == opening) then
         upper = min(max(meeting(self, 1.0_wp, self%c_p - self%gap, c, f), c), self%c_u)
      else
         lower = min(meeting(self, 1.0_wp - share_of_friction(self), parting_end(self), c, f), c)
      end if
      self%stage = between
      line = segment(d0=-c, f0=-f, k=self%k, lo=-upper, hi=-lower)
   end subroutine rub

   !> The share by which the path of opening is lower: none where the virgin spring is elastic.
   elemental real(wp) function share_of_friction(self)
      type(concrete_rule), intent(in) :: self

      share_of_friction = self%friction*crushed(self)
   end function share_of_friction

   !> From 0, where the virgin spring is elastic, to 1 at the closing at the peak.
   elemental real(wp) function crushed(self)
      type(concrete_rule), intent(in) :: self

      crushed = (self%c_u/self%d_peak - chord_ends(1))/(1.0_wp - chord_ends(1))
      crushed = min(max(crushed, 0.0_wp), 1.0_wp)
   end function crushed

   !> The closing at which the path of opening has no force any more [m].
   elemental real(wp) function parting_end(self)
      type(concrete_rule), intent(in) :: self

      parting_end = self%c_p - self%gap
      if (self%seating > 0.0_wp) parting_end = self%c_p - (1.0_wp - self%seating*crushed(self))*self%gap
   end function parting_end

   !> Where the line of the initial stiffness through (c, f) meets a path: a share of that of closing above
   !> full closing, and a line from there to no force at the closing `c_none` [m].
   real(wp) function meeting(self, share, c_none, c, f)
      type(concrete_rule), intent(in) :: self
      real(wp), intent(in) :: share, c_none, c, f
      real(wp) :: c_closed, f_closed, c_0, f_0, slope

      call full_closing(self, c_closed, f_closed)
      if (f + self%k*(c_closed - c) < share*f_closed) then
         c_0 = c_closed
         f_0 = share*f_closed
         meeting = c_0
         ! The path ends where it closes.
         if (.not. self%c_u > c_0) return
         slope = (share*self%strength*self%f_u - f_0)/(self%c_u - c_0)
      else
         c_0 = c_none
         f_0 = 0.0_wp
         slope = 0.0_wp
         ! Before it the path has no force.
         if (c_closed > c_0 .and. f < self%k*(c - c_0)) slope = share*f_closed/(c_closed - c_0)
      end if
      ! Both lines from c_0 on.
      meeting = c_0
      if (self%k*(1.0_wp - 1.0e-9_wp) > slope) meeting = c_0 + (f_0 - f - self%k*(c_0 - c))/(self%k - slope)
      meeting = max(meeting, self%c_p - self%gap)
   end function meeting

   !> On the path of closing from the closing c on.
   subroutine close_on(self, c, line)
      type(concrete_rule), intent(inout) :: self
      real(wp), intent(in) :: c
      type(segment), intent(out) :: line
      real(wp) :: c_closed, f_closed

      call full_closing(self, c_closed, f_closed)
      if (c >= self%c_u) then
         call follow_envelope(self, self%c_u, self%strength*self%f_u, line)
      else if (c >= c_closed) then
         call unload(self, line)
         line%hi = -c
      else
         self%stage = contact
         line = chord(self%c_p - self%gap, 0.0_wp, c_closed, f_closed)
         line%hi = -c
         call set_one_way(line)
      end if
   end subroutine close_on

   !> On the path of opening from the closing c on.
   subroutine release(self, c, line)
      type(concrete_rule), intent(inout) :: self
      real(wp), intent(in) :: c
      type(segment), intent(out) :: line
      real(wp) :: c_closed, f_closed, left, c_none

      call full_closing(self, c_closed, f_closed)
      left = 1.0_wp - share_of_friction(self)
      c_none = parting_end(self)
      if (c > c_closed) then
         self%stage = releasing
         line = chord(c_closed, left*f_closed, self%c_u, left*self%strength*self%f_u)
      else if (c > c_none) then
         self%stage = parting
         line = chord(c_none, 0.0_wp, c_closed, left*f_closed)
      else
         call open_up(self, c, line)
         return
      end if
      line%lo = -c
      line%lo_closed = .true.
      line%one_way = 1
   end subroutine release

   !> Where a closing crack is fully closed.
   pure subroutine full_closing(self, c, f)
      type(concrete_rule), intent(in) :: self
      !> Closing [m] and force [N]
      real(wp), intent(out) :: c, f

      c = self%c_p
      f = 0.0_wp
      if (.not. self%gap > 0.0_wp) return
      c = self%c_p + self%contact*(self%c_u - self%c_p)
      f = self%contact*self%strength*self%f_u
   end subroutine full_closing

   !> The line of zero force while the crack opens, from the closing c.
   subroutine open_up(self, c, line)
      type(concrete_rule), intent(inout) :: self
      real(wp), intent(in) :: c
      type(segment), intent(out) :: line

      self%stage = opening
      self%c_opened = c
      line = segment(d0=-c, lo=-c, hi=unbounded, lo_closed=.true., one_way=1)
   end subroutine open_up

   !> The line of zero force while the crack closes, from the closing c until the faces touch.
   subroutine close_up(self, c, line)
      type(concrete_rule), intent(inout) :: self
      real(wp), intent(in) :: c
      type(segment), intent(out) :: line

      self%stage = closing
      line = chord(c, 0.0_wp, self%c_p - self%gap, 0.0_wp)
      ! Openings are added up only if they have an effect.
      if (self%wear > 0.0_wp) call set_one_way(line)
   end subroutine close_up

   !> The crack has opened to a closing c: the wider it was, the earlier its faces touch, and the
   !> strength falls with the way. There is no force, so neither is felt at once.
   pure subroutine widen(self, c)
      type(concrete_rule), intent(inout) :: self
      real(wp), intent(in) :: c
      real(wp) :: before, width, inside, openings

      before = self%c_p - self%c_opened
      width = self%c_p - c
      self%gap = max(self%gap, self%misfit*width)
      if (self%wear > 0.0_wp .and. self%c_u > 0.0_wp) then
         ! The way over the width so far, integrated as the width grows.
         inside = min(width, self%widest) - min(before, self%widest)
         openings = inside/(self%widest + self%d_peak)
         if (width > self%widest) then
            openings = openings + log((width + self%d_peak)/(max(self%widest, before) + self%d_peak))
         end if
         self%strength = self%strength* &
                         (1.0_wp - self%wear)**(openings*min(1.0_wp, 0.5_wp*self%c_u/self%d_peak))
      end if
      self%widest = max(self%widest, width)
   end subroutine widen

   !> Rising curve of Popovics (1973) [N].
   pure real(wp) function curve(self, c)
      type(concrete_rule), intent(in) :: self
      !> Closing, up to the one at the peak [m]
      real(wp), intent(in) :: c
      real(wp) :: x, r

      x = c/self%d_peak
      r = self%k/(self%k - self%f_peak/self%d_peak)
      curve = self%f_peak*x*r/(r - 1.0_wp + x**r)
   end function curve

   !> The line through two points (closing, force), of which the second is further closed; both ends open.
   pure type(segment) function chord(c_1, f_1, c_2, f_2) result(line)
      real(wp), intent(in) :: c_1, f_1, c_2, f_2

      line = segment(d0=-c_1, f0=-f_1, lo=-c_2, hi=-c_1)
      if (c_2 > c_1) line%k = (f_2 - f_1)/(c_2 - c_1)
   end function chord

   !> Make a line of the envelope one-way: it is left when the motion turns back.
   pure subroutine set_one_way(line)
      type(segment), intent(inout) :: line

      line%hi_closed = .true.
      line%one_way = -1
   end subroutine set_one_way

   !> Copy the memory of another spring of this rule and its parameters.
   pure subroutine copy_memory(self, other, done)
      class(concrete_rule), intent(inout) :: self
      class(rule_type), intent(in) :: other
      logical, intent(out) :: done

      done = .false.
      select type (other)
      type is (concrete_rule)
         self%stage = other%stage
         self%c_u = other%c_u
         self%f_u = other%f_u
         self%c_p = other%c_p
         self%f_largest = other%f_largest
         self%gap = other%gap
         self%widest = other%widest
         self%c_opened = other%c_opened
         self%strength = other%strength
         done = .true.
      end select
   end subroutine copy_memory

   !> Save or restore all history variables.
   pure subroutine serialize(self, stream)
      class(concrete_rule), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%item(self%stage)
      call stream%item(self%c_u)
      call stream%item(self%f_u)
      call stream%item(self%c_p)
      call stream%item(self%f_largest)
      call stream%item(self%gap)
      call stream%item(self%widest)
      call stream%item(self%c_opened)
      call stream%item(self%strength)
   end subroutine serialize

end module rbs_hysteresis_concrete
