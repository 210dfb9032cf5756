!> Bilinear spring with kinematic hardening (paper, table 1, shear spring).
!>
!> Between two bounding lines F = k_post D + q and F = k_post D - q, q = (k - k_post) d_y, the spring is
!> elastic with slope k; the elastic range is 2 d_y wide and travels with the plastic deformation.
module rbs_hysteresis_bilinear
   use rbs_base_error, only: message_list
   use rbs_base_keys, only: key_type, above_zero, not_negative, deformation, stiffness
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_base_text, only: to_text
   use rbs_base_constants, only: unbounded
   use rbs_hysteresis_rule, only: rule_type, check_product, places_length, in_shear, in_flexure, &
      in_axial, in_layer
   use rbs_hysteresis_segment, only: segment
   implicit none
   private

   public :: bilinear_rule

   type(key_type), parameter :: parameters(*) = [ &
      key_type('k', unit=stiffness, bound=above_zero, &
               meaning='initial stiffness'), &
      key_type('d_y', unit=deformation, bound=above_zero, &
               meaning='yield deformation'), &
      key_type('k_post', unit=stiffness, bound=not_negative, &
               meaning='stiffness after yield, below k')]

   type, extends(rule_type) :: bilinear_rule
      !> Initial stiffness [N/m or N m/rad]
      real(wp) :: k = 0.0_wp
      !> Yield deformation [m or rad]
      real(wp) :: d_y = 0.0_wp
      !> Stiffness after yield [N/m or N m/rad]
      real(wp) :: k_post = 0.0_wp
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
   end type bilinear_rule

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
      class(bilinear_rule), intent(inout) :: self
      real(wp), intent(in) :: value(:)

      self%k = value(1)
      self%d_y = value(2)
      self%k_post = value(3)
   end subroutine set

   pure real(wp) function initial_stiffness(self)
      class(bilinear_rule), intent(in) :: self

      initial_stiffness = self%k
   end function initial_stiffness

   subroutine check(self, name, messages)
      class(bilinear_rule), intent(in) :: self
      character(len=*), intent(in) :: name
      type(message_list), intent(inout) :: messages

      if (self%k_post >= self%k) then
         call messages%add(name//': k_post = '//to_text(self%k_post)//' must be below k = '// &
                           to_text(self%k)//'; use an elastic spring for one that does not yield')
      end if
      call check_product(self%k, self%d_y, name, 'k d_y', messages)
   end subroutine check

   subroutine start(self, line)
      class(bilinear_rule), intent(inout) :: self
      type(segment), intent(out) :: line

      line = segment(k=self%k, lo=-self%d_y, hi=self%d_y)
   end subroutine start

   subroutine next(self, line, direction)
      class(bilinear_rule), intent(inout) :: self
      type(segment), intent(inout) :: line
      integer, intent(in) :: direction
      real(wp) :: d, f

      d = line%end_toward(direction)
      if (line%one_way == 0) then
         ! The elastic line has ended: yield along the bounding line of this direction.
         line = segment(f0=direction*(self%k - self%k_post)*self%d_y, k=self%k_post)
         line = line%outward(direction, near=d, far=direction*unbounded, near_closed=.false., &
                             one_way=.true.)
      else
         ! The motion has turned back from a bounding line: elastic over twice the yield deformation.
         f = line%force(d)
         line = segment(d0=d, f0=f, k=self%k)
         line = line%outward(-direction, near=d + direction*2.0_wp*self%d_y, far=d, &
                             near_closed=.false., one_way=.false.)
      end if
   end subroutine next

   !> Copy the memory of another spring of this rule and its parameters.
   pure subroutine copy_memory(self, other, done)
      class(bilinear_rule), intent(inout) :: self
      class(rule_type), intent(in) :: other
      logical, intent(out) :: done

      ! There is none: the line says all.
      done = same_type_as(self, other)
   end subroutine copy_memory

   !> There is no memory: the line says all.
   pure subroutine serialize(self, stream)
      class(bilinear_rule), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      stream%broken = stream%broken .or. .not. self%k > 0.0_wp
   end subroutine serialize

end module rbs_hysteresis_bilinear
