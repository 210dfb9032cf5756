!> A spring that stays on one line.
module rbs_hysteresis_elastic
   use rbs_base_keys, only: key_type, above_zero, stiffness
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_hysteresis_rule, only: rule_type, places_length, in_shear, in_flexure, in_axial, in_layer
   use rbs_hysteresis_segment, only: segment
   implicit none
   private

   public :: elastic_rule

   type(key_type), parameter :: parameters(*) = [ &
      key_type('k', unit=stiffness, bound=above_zero, &
               meaning='stiffness')]

   type, extends(rule_type) :: elastic_rule
      !> Stiffness [N/m or N m/rad]
      real(wp) :: k = 0.0_wp
   contains
      procedure, nopass :: keys
      procedure, nopass :: places
      procedure :: set
      procedure :: initial_stiffness
      procedure :: start
      procedure :: next
      procedure :: serialize
   end type elastic_rule

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
      class(elastic_rule), intent(inout) :: self
      real(wp), intent(in) :: value(:)

      self%k = value(1)
   end subroutine set

   pure real(wp) function initial_stiffness(self)
      class(elastic_rule), intent(in) :: self

      initial_stiffness = self%k
   end function initial_stiffness

   subroutine start(self, line)
      class(elastic_rule), intent(inout) :: self
      type(segment), intent(out) :: line

      line%k = self%k
   end subroutine start

   !> Called only for deformations beyond the largest number: the line continues.
   subroutine next(self, line, direction)
      class(elastic_rule), intent(inout) :: self
      type(segment), intent(inout) :: line
      integer, intent(in) :: direction

      line%k = self%k
      line%one_way = 0*direction
   end subroutine next

   !> There is no memory: the line says all.
   pure subroutine serialize(self, stream)
      class(elastic_rule), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      stream%broken = stream%broken .or. .not. self%k > 0.0_wp
   end subroutine serialize

end module rbs_hysteresis_elastic
