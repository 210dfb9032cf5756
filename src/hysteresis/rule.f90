!> The interface of a hysteresis rule: its parameters, and the lines that a spring follows.
module rbs_hysteresis_rule
   use rbs_base_error, only: message_list
   use rbs_base_keys, only: key_type
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_base_text, only: to_text
   use rbs_hysteresis_segment, only: segment
   implicit none
   private

   public :: rule_type, check_product

   !> Places of springs; `places` of a rule lists those where it may be used.
   character(len=*), parameter, public :: in_shear = 'shear', in_flexure = 'flexure'
   character(len=*), parameter, public :: in_axial = 'axial', in_layer = 'layer'

   !> Largest number of parameters of a rule.
   integer, parameter, public :: most_parameters = 32

   integer, parameter, public :: rule_length = 16, places_length = 32

   !> A rule is called only when a line ends or the motion turns back. Its memory is part of its type and is
   !> copied by assignment.
   type, abstract :: rule_type
   contains
      procedure(keys_interface), deferred, nopass :: keys
      procedure(places_interface), deferred, nopass :: places
      procedure(set_interface), deferred :: set
      procedure(stiffness_interface), deferred :: initial_stiffness
      procedure :: check
      procedure(start_interface), deferred :: start
      procedure(next_interface), deferred :: next
      procedure(serialize_interface), deferred :: serialize
      procedure :: copy_memory
      procedure :: hears
      procedure :: hear
   end type rule_type

   abstract interface
      !> The parameters: names, dimensions, bounds, defaults, meaning.
      pure function keys_interface() result(keys)
         import :: key_type
         implicit none
         type(key_type), allocatable :: keys(:)
      end function keys_interface

      !> The places where springs of this rule may be used: some of the words above, separated by blanks.
      pure function places_interface() result(places)
         import :: places_length
         implicit none
         character(len=places_length) :: places
      end function places_interface

      !> Set the parameters, in the order of `keys`.
      pure subroutine set_interface(self, value)
         import :: rule_type, wp
         implicit none
         class(rule_type), intent(inout) :: self
         real(wp), intent(in) :: value(:)
      end subroutine set_interface

      !> Stiffness of the virgin spring, of the stiffer side if they differ [N/m or N m/rad].
      pure real(wp) function stiffness_interface(self)
         import :: rule_type, wp
         implicit none
         class(rule_type), intent(in) :: self
      end function stiffness_interface

      !> The line of the virgin spring; clears the memory.
      subroutine start_interface(self, line)
         import :: rule_type, segment
         implicit none
         class(rule_type), intent(inout) :: self
         type(segment), intent(out) :: line
      end subroutine start_interface

      !> The line that follows when the motion leaves the present one: at `hi` going up (direction = +1)
      !> or at `lo` going down (direction = -1). On a one-way line the rear end is the point where the
      !> motion turned back.
      subroutine next_interface(self, line, direction)
         import :: rule_type, segment
         implicit none
         class(rule_type), intent(inout) :: self
         !> The line that ends, replaced by its successor
         type(segment), intent(inout) :: line
         integer, intent(in) :: direction
      end subroutine next_interface

      !> Save or restore everything that `next` changes, not the parameters: what another analysis needs to
      !> go on.
      pure subroutine serialize_interface(self, stream)
         import :: rule_type, stream_type
         implicit none
         class(rule_type), intent(inout) :: self
         type(stream_type), intent(inout) :: stream
      end subroutine serialize_interface
   end interface

contains

   !> Copy the memory of another rule of the same type and parameters. A rule that is copied often, as that of
   !> a layer, does so without a new allocation; for all others `done` is false and the whole rule is copied.
   pure subroutine copy_memory(self, other, done)
      class(rule_type), intent(inout) :: self
      class(rule_type), intent(in) :: other
      logical, intent(out) :: done

      done = .false. .and. same_type_as(self, other)
   end subroutine copy_memory

   !> Whether the rule wants to be told of the work of the flexural spring of its joint.
   pure logical function hears(self)
      class(rule_type), intent(in) :: self

      hears = .false. .and. same_type_as(self, self)
   end function hears

   !> Take the work that the flexural spring of the joint has taken up so far. A rule that `hears` is told at
   !> each of its own events, before `next`.
   pure subroutine hear(self, work)
      class(rule_type), intent(inout) :: self
      !> [J]
      real(wp), intent(in) :: work

      if (work > 0.0_wp .and. .not. same_type_as(self, self)) return
   end subroutine hear

   !> Add messages on relations between parameters that are each within their bounds. A rule without such
   !> relations inherits this procedure.
   subroutine check(self, name, messages)
      class(rule_type), intent(in) :: self
      !> Name of the spring: 'shear spring of joint 2'
      character(len=*), intent(in) :: name
      type(message_list), intent(inout) :: messages

      if (.false.) call messages%add(name//to_text(self%initial_stiffness()))
   end subroutine check

   !> Stiffness times deformation must neither overflow nor vanish.
   subroutine check_product(k, d, name, product_name, messages)
      real(wp), intent(in) :: k, d
      !> Names of the spring and of the product for the message: 'k d_y'
      character(len=*), intent(in) :: name, product_name
      type(message_list), intent(inout) :: messages
      real(wp) :: power

      power = log10(k) + log10(d)
      if (power > 0.9_wp*range(1.0_wp) .or. power < -0.9_wp*range(1.0_wp) .or. &
          abs(log10(k)) > 0.5_wp*range(1.0_wp) .or. abs(log10(d)) > 0.5_wp*range(1.0_wp)) then
         call messages%add(name//': '//product_name//' = '//to_text(k)//' * '//to_text(d)// &
                           ' is outside the range of the arithmetic; check the units')
      end if
   end subroutine check_product

end module rbs_hysteresis_rule
