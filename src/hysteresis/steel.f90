!> Steel with a rounded transition to yield: Menegotto and Pinto (1973) in straight lines.
!>
!> A branch starts where the motion turned back and bends from the elastic stiffness to the line of
!> hardening,  f* = b x + (1 - b) x/(1 + x^R)^(1/R),  R = r0 (1 - cr1 xi/(cr2 + xi)),  xi = plastic
!> excursion over the yield deformation. Chords replace the curve; their ends depend on its roundness. A
!> branch that meets the previous branch of its direction continues along that one: small cycles close
!> and never overshoot. The strength of new branches grows with the range of the strains (Filippou, Popov
!> and Bertero 1983) and decreases with the plastic work.
module rbs_hysteresis_steel
   use rbs_base_error, only: message_list
   use rbs_base_keys, only: key_type, above_zero, not_negative, share_below_one, &
                           force, stiffness
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_base_constants, only: unbounded
   use rbs_hysteresis_rule, only: rule_type, check_product, places_length, in_shear, in_flexure, &
      in_axial, in_layer
   use rbs_hysteresis_segment, only: segment
   implicit none
   private

   public :: steel_rule

   !> Ends of the chords: values of x^R
   real(wp), parameter :: corners(8) = [0.03_wp, 0.15_wp, 0.4_wp, 0.8_wp, 1.5_wp, 3.0_wp, 8.0_wp, 30.0_wp]
   !> Most branches that are remembered
   integer, parameter :: most_branches = 16
   !> Least roundness
   real(wp), parameter :: least_r = 0.8_wp

   !> One curve from a reversal point to the line of hardening.
   type :: branch_type
      integer :: direction = 0
      !> Its start, and the point where its two asymptotes meet [m, N]
      real(wp) :: d_0 = 0.0_wp, f_0 = 0.0_wp, d_a = 0.0_wp, f_a = 0.0_wp
      !> Roundness
      real(wp) :: r = 20.0_wp
      !> The point where it meets the previous branch of its direction
      real(wp) :: d_meet = unbounded
   end type branch_type

   type(key_type), parameter :: parameters(*) = [ &
      key_type('k', unit=stiffness, bound=above_zero, &
               meaning='elastic stiffness'), &
      key_type('f_y', unit=force, bound=above_zero, &
               meaning='yield force'), &
      key_type('k_post', unit=stiffness, bound=not_negative, &
               meaning='stiffness of hardening, below k'), &
      key_type('r0', bound=above_zero, default=20.0_wp, &
               meaning='roundness of the virgin branch'), &
      key_type('cr1', bound=share_below_one, default=0.925_wp, &
               meaning='largest share by which plastic excursions lower the roundness'), &
      key_type('cr2', bound=above_zero, default=0.15_wp, &
               meaning='plastic excursion over the yield deformation at half of that share'), &
      key_type('isotropic_hardening', bound=not_negative, default=0.0_wp, &
               meaning='share by which the strength has grown at a reach of strains from -d_y to d_y'), &
      key_type('half_strength_work', bound=not_negative, default=0.0_wp, &
               meaning='plastic work over f_y d_y at which the strength is half; 0: it stays')]

   type, extends(rule_type) :: steel_rule
      !> Elastic stiffness [N/m], yield force [N], stiffness of hardening [N/m]
      real(wp) :: k = 0.0_wp, f_y = 0.0_wp, k_post = 0.0_wp
      !> Roundness of the virgin branch and its decrease with the plastic excursion
      real(wp) :: r0 = 20.0_wp, cr1 = 0.925_wp, cr2 = 0.15_wp
      !> Share by which the strength has grown when the strains have ranged from -d_y to d_y (Filippou,
      !> Popov and Bertero 1983); it grows with the power 0.8 of that range
      real(wp) :: isotropic_hardening = 0.0_wp
      !> Plastic work over f_y d_y at which the strength is halved; 0: the strength does not decrease
      real(wp) :: half_strength_work = 0.0_wp
      type(branch_type), private :: branch(most_branches)
      !> Branches in memory; 0: virgin
      integer, private :: count = 0
      !> Extremes of the deformation so far [m]
      real(wp), private :: highest = 0.0_wp, lowest = 0.0_wp
      !> Work up to the last corner [J], and that corner [m, N]
      real(wp), private :: work = 0.0_wp, d_last = 0.0_wp, f_last = 0.0_wp
   contains
      procedure, nopass :: keys
      procedure, nopass :: places
      procedure :: set
      procedure :: initial_stiffness
      procedure :: check
      procedure :: start
      procedure :: next
   end type steel_rule

contains

   pure function keys()
      type(key_type), allocatable :: keys(:)

      keys = parameters
   end function keys

   pure function places()
      character(len=places_length) :: places

      places = in_shear//' '//in_flexure//' '//in_axial//' '//in_layer
   end function places

   pure subroutine set(self, value)
      class(steel_rule), intent(inout) :: self
      real(wp), intent(in) :: value(:)

      self%k = value(1)
      self%f_y = value(2)
      self%k_post = value(3)
      self%r0 = value(4)
      self%cr1 = value(5)
      self%cr2 = value(6)
      self%isotropic_hardening = value(7)
      self%half_strength_work = value(8)
   end subroutine set

   pure real(wp) function initial_stiffness(self)
      class(steel_rule), intent(in) :: self

      initial_stiffness = self%k
   end function initial_stiffness

   subroutine check(self, name, messages)
      class(steel_rule), intent(in) :: self
      character(len=*), intent(in) :: name
      type(message_list), intent(inout) :: messages

      if (self%k_post >= self%k) then
         call messages%add(name//': k_post = '//to_text(self%k_post)//' must be below k = '// &
                           to_text(self%k)//'; use an elastic spring for one that does not yield')
      end if
      call check_product(self%k, self%f_y/self%k, name, 'k d_y', messages)
   end subroutine check

   subroutine start(self, line)
      class(steel_rule), intent(inout) :: self
      type(segment), intent(out) :: line
      real(wp) :: d, d_y
      type(branch_type) :: first

      self%count = 0
      self%highest = 0.0_wp
      self%lowest = 0.0_wp
      self%work = 0.0_wp
      self%d_last = 0.0_wp
      self%f_last = 0.0_wp
      d_y = self%f_y/self%k
      first = branch_type(direction=1, d_a=d_y, f_a=self%f_y, r=self%r0)
      d = corners(1)**(1.0_wp/self%r0)*d_y
      line = segment(k=curve(self, first, d)/d, lo=-d, hi=d)
   end subroutine start

   subroutine next(self, line, direction)
      class(steel_rule), intent(inout) :: self
      type(segment), intent(inout) :: line
      integer, intent(in) :: direction
      real(wp) :: d, f

      d = line%end_toward(direction)
      f = line%force(d)
      self%work = self%work + 0.5_wp*(f + self%f_last)*(d - self%d_last)
      self%d_last = d
      self%f_last = f
      if (self%count == 0) then
         self%count = 1
         self%branch(1) = branch_type(direction=direction, d_a=direction*self%f_y/self%k, &
                                      f_a=direction*self%f_y, r=self%r0, d_meet=direction*unbounded)
      else if (self%branch(self%count)%direction /= direction) then
         call turn_back(self, d, f)
      else
         ! Back on the previous branch: those in between are forgotten.
         do while (direction*(d - self%branch(self%count)%d_meet) >= 0.0_wp)
            self%count = self%count - 2
         end do
      end if
      call follow_branch(self, d, f, line)
   end subroutine next

   !> Start a branch at (d, f) in the direction opposite to the present one.
   subroutine turn_back(self, d, f)
      class(steel_rule), intent(inout) :: self
      real(wp), intent(in) :: d, f
      type(branch_type) :: new
      real(wp) :: d_y, plastic, strength, xi
      integer :: s

      d_y = self%f_y/self%k
      s = -self%branch(self%count)%direction
      ! A branch of the new direction that started less far out than this point is no longer needed. The
      ! branch before it replaces the present one if the two would meet, as the present one only approaches
      ! it; else the present one replaces it.
      do while (self%count >= 2)
         if (s*(d - self%branch(self%count - 1)%d_0) > 0.0_wp) exit
         if (self%count >= 3 .and. abs(self%branch(self%count)%d_meet) < unbounded) then
            self%count = self%count - 2
         else
            call forget(self, self%count - 1)
         end if
      end do
      if (self%count == most_branches) call forget(self, 2)
      self%highest = max(self%highest, d)
      self%lowest = min(self%lowest, d)
      strength = 1.0_wp
      if (self%isotropic_hardening > 0.0_wp) then
         strength = 1.0_wp + self%isotropic_hardening*(0.5_wp*(self%highest - self%lowest)/d_y)**0.8_wp
      end if
      if (self%half_strength_work > 0.0_wp) then
         plastic = max(0.0_wp, self%work - 0.5_wp*f**2/self%k)/(self%f_y*d_y)
         strength = strength/(1.0_wp + (plastic/self%half_strength_work)**2)
      end if
      new%direction = s
      new%d_0 = d
      new%f_0 = f
      ! The elastic line through (d, f) meets  f = s strength f_y + k_post (d - s d_y).
      new%d_a = (s*(strength*self%f_y - self%k_post*d_y) - f + self%k*d)/(self%k - self%k_post)
      if (s*(new%d_a - d) < 1.0e-9_wp*d_y) new%d_a = d + s*1.0e-9_wp*d_y
      new%f_a = f + self%k*(new%d_a - d)
      xi = abs(merge(self%highest, self%lowest, s > 0) - new%d_a)/d_y
      new%r = max(least_r, self%r0*(1.0_wp - self%cr1*xi/(self%cr2 + xi)))
      new%d_meet = s*unbounded
      if (self%count >= 2) call find_meeting(self, self%branch(self%count - 1), new)
      self%count = self%count + 1
      self%branch(self%count) = new
      ! Turned back at once without having moved: still on the previous branch.
      if (abs(new%d_meet - d) <= 1.0e-9_wp*abs(new%d_a - d)) self%count = self%count - 2
   end subroutine turn_back

   !> Forget a branch and the one before it, which later branches have passed or will not meet any more.
   subroutine forget(self, place)
      class(steel_rule), intent(inout) :: self
      integer, intent(in) :: place
      integer :: first, i

      first = max(place - 1, 1)
      self%branch(first:self%count - place + first - 1) = self%branch(place + 1:self%count)
      self%count = self%count - place + first - 1
      do i = first, min(first + 1, self%count)
         self%branch(i)%d_meet = self%branch(i)%direction*unbounded
      end do
   end subroutine forget

   !> The point where a new branch meets the previous one of its direction.
   subroutine find_meeting(self, old, new)
      class(steel_rule), intent(in) :: self
      type(branch_type), intent(in) :: old
      type(branch_type), intent(inout) :: new
      real(wp) :: near, far, middle, reach
      integer :: i, s

      s = new%direction
      reach = abs(new%d_a - new%d_0)
      near = new%d_0
      ! With low roundness a branch may start above the old one and so has already passed it.
      if (s*(new%f_0 - curve(self, old, near)) > 1.0e-9_wp*self%f_y) return
      do i = 1, size(corners)
         far = new%d_0 + s*reach*corners(i)**(1.0_wp/new%r)
         if (s*(curve(self, new, far) - curve(self, old, far)) >= 0.0_wp) exit
         near = far
      end do
      if (i > size(corners)) return
      do i = 1, 60
         middle = 0.5_wp*(near + far)
         if (s*(curve(self, new, middle) - curve(self, old, middle)) >= 0.0_wp) then
            far = middle
         else
            near = middle
         end if
         if (abs(far - near) <= 1.0e-10_wp*reach) exit
      end do
      new%d_meet = far
   end subroutine find_meeting

   !> The chord of the present branch that starts at (d, f).
   subroutine follow_branch(self, d, f, line)
      class(steel_rule), intent(in) :: self
      real(wp), intent(in) :: d, f
      type(segment), intent(out) :: line
      real(wp) :: reach, far, f_far
      integer :: i, s

      associate (branch => self%branch(self%count))
         s = branch%direction
         reach = abs(branch%d_a - branch%d_0)
         far = s*unbounded
         do i = 1, size(corners)
            far = branch%d_0 + s*reach*corners(i)**(1.0_wp/branch%r)
            if (s*(far - d) > 1.0e-6_wp*reach) exit
            far = s*unbounded
         end do
         if (s*(far - branch%d_meet) > 0.0_wp) far = branch%d_meet
         line = segment(d0=d, f0=f, k=self%k_post)
         if (abs(far) < unbounded) then
            f_far = curve(self, branch, far)
            if (s*(far - branch%d_meet) >= 0.0_wp) f_far = curve(self, self%branch(self%count - 2), far)
            line%k = (f_far - f)/(far - d)
         end if
      end associate
      line = line%outward(s, near=d, far=far, near_closed=.true., one_way=.true.)
   end subroutine follow_branch

   !> Force of a branch at a deformation [N]; before its start, on the elastic line.
   pure real(wp) function curve(self, branch, d) result(f)
      class(steel_rule), intent(in) :: self
      type(branch_type), intent(in) :: branch
      !> Deformation [m]
      real(wp), intent(in) :: d
      real(wp) :: x, b

      x = (d - branch%d_0)/(branch%d_a - branch%d_0)
      if (x <= 0.0_wp) then
         f = branch%f_0 + self%k*(d - branch%d_0)
         return
      end if
      b = self%k_post/self%k
      ! Far out the curve equals its asymptote, and the power would overflow.
      f = b*x + 1.0_wp - b
      if (x < 1.0e6_wp) f = b*x + (1.0_wp - b)*x/(1.0_wp + x**branch%r)**(1.0_wp/branch%r)
      f = branch%f_0 + f*(branch%f_a - branch%f_0)
   end function curve

end module rbs_hysteresis_steel
