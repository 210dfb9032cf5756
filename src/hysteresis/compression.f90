!> A contact: elastic while the joint is closed, without force while it is open. With a gap it closes only
!> after the joint has closed by that much.
module rbs_hysteresis_compression
   use rbs_base_keys, only: key_type, above_zero, not_negative, deformation, stiffness
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_base_constants, only: unbounded
   use rbs_hysteresis_rule, only: rule_type, places_length, in_axial, in_layer
   use rbs_hysteresis_segment, only: segment
   implicit none
   private

   public :: compression_rule

   type(key_type), parameter :: parameters(*) = [ &
      key_type('k', unit=stiffness, bound=above_zero, &
               meaning='stiffness in compression; there is none in tension'), &
      key_type('gap', unit=deformation, bound=not_negative, default=0.0_wp, &
               meaning='closing before the faces touch')]

   type, extends(rule_type) :: compression_rule
      !> Stiffness of the closed joint [N/m]
      real(wp) :: k = 0.0_wp
      !> Closing at which it begins to carry [m]
      real(wp) :: gap = 0.0_wp
   contains
      procedure, nopass :: keys
      procedure, nopass :: places
      procedure :: set
      procedure :: initial_stiffness
      procedure :: start
      procedure :: next
      procedure :: serialize
   end type compression_rule

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
      class(compression_rule), intent(inout) :: self
      real(wp), intent(in) :: value(:)

      self%k = value(1)
      self%gap = value(2)
   end subroutine set

   pure real(wp) function initial_stiffness(self)
      class(compression_rule), intent(in) :: self

      initial_stiffness = self%k
   end function initial_stiffness

   !> The joint is closed at zero opening, or with a gap at minus that; openings are positive.
   subroutine start(self, line)
      class(compression_rule), intent(inout) :: self
      type(segment), intent(out) :: line

      if (self%gap > 0.0_wp) then
         line = segment(k=0.0_wp, lo=-self%gap, hi=unbounded)
      else
         line = segment(k=self%k, hi=0.0_wp, hi_closed=.true.)
      end if
   end subroutine start

   subroutine next(self, line, direction)
      class(compression_rule), intent(inout) :: self
      type(segment), intent(inout) :: line
      integer, intent(in) :: direction

      if (direction > 0) then
         line = segment(k=0.0_wp, lo=-self%gap, hi=unbounded)
      else
         line = segment(d0=-self%gap, k=self%k, lo=-unbounded, hi=-self%gap, hi_closed=.true.)
      end if
   end subroutine next

   !> There is no memory: the line says all.
   pure subroutine serialize(self, stream)
      class(compression_rule), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      stream%broken = stream%broken .or. .not. self%k > 0.0_wp
   end subroutine serialize

end module rbs_hysteresis_compression
