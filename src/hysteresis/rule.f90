!> The interface of a hysteresis rule. A rule holds the parameters of equal springs, which share it; the part
!> that changes along the path of a spring is the memory of that spring.
module rbs_hysteresis_rule
   use rbs_base_error, only: message_list
   use rbs_base_key_visitor, only: key_visitor, visited_record
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_base_text, only: to_text
   use rbs_hysteresis_segment, only: segment
   implicit none
   private

   public :: rule_type, rule_memory, rule_slot, memory_slot, spring_slot, spring_rules, copy_memory, &
             check_product

   !> Places of springs; the registry lists those where a rule may be used.
   character(len=*), parameter, public :: in_shear = 'shear', in_flexure = 'flexure'
   character(len=*), parameter, public :: in_axial = 'axial', in_layer = 'layer'

   !> Largest number of parameters of a rule.
   integer, parameter, public :: most_parameters = 32

   integer, parameter, public :: rule_length = 16, places_length = 32

   !> The history variables of one spring. A rule whose present branch suffices adds none; others extend this
   !> type, and override both procedures.
   type :: rule_memory
      !> Work of the flexural spring of the joint so far [J]; set before each event of a rule
      !> that `uses_flexural_work`
      real(wp) :: flexural_work = 0.0_wp
   contains
      procedure :: copy, serialize
   end type rule_memory

   !> The parameters of a spring, which do not change once they are prepared. `visit` presents their keys.
   type, extends(visited_record), abstract :: rule_type
      !> Stiffness of the virgin spring, of the stiffer side if they differ, of half of it if the other side
      !> carries nothing [N/m or N m/rad]
      real(wp) :: initial_stiffness = 0.0_wp
      !> Whether the spring decays with the work of the flexural spring of its joint
      logical :: uses_flexural_work = .false.
      !> The memory of a virgin spring, not allocated where its branch suffices, and its branch
      class(rule_memory), allocatable :: memory
      type(segment) :: branch
   contains
      procedure :: take, check_relations, prepare, has_yielded, start
      procedure(next_interface), deferred :: next
   end type rule_type

   !> Hold one rule, or one memory. The program uses arrays of these types in place of polymorphic arrays.
   type :: rule_slot
      class(rule_type), allocatable :: rule
   end type rule_slot

   type :: memory_slot
      class(rule_memory), allocatable :: memory
   end type memory_slot

   !> Parts of one spring, side by side, as every new line needs all of them: its rule, its memory, and
   !> room for a copy of the memory from before a trial.
   type :: spring_slot
      !> Of the structure, which is there as long as the spring
      class(rule_type), pointer :: rule => null()
      class(rule_memory), allocatable :: memory, kept
      !> Whether the memory needs the work of the flexural spring
      logical :: needs_flexural_work = .false.
   contains
      procedure :: next_branch
   end type spring_slot

   !> The rules of many springs, made once: equal neighbours share one.
   type :: spring_rules
      type(rule_slot), allocatable :: list(:)
      !> Their names
      character(len=rule_length), allocatable :: name(:)
      !> The rule of each spring (springs)
      integer, allocatable :: of(:)
   contains
      procedure :: initial_stiffness => stiffness_of_springs
   end type spring_rules

   abstract interface
      !> The branch that follows when the motion leaves the present one: at `hi` going up (direction = +1)
      !> or at `lo` going down (direction = -1). Where a branch unloads on reversal, its rear end is the point
      !> where the motion turned back.
      subroutine next_interface(self, memory, branch, direction)
         import :: rule_type, rule_memory, segment
         class(rule_type), intent(in) :: self
         class(rule_memory), intent(inout) :: memory
         !> The branch that ends, replaced by its successor
         type(segment), intent(inout) :: branch
         integer, intent(in) :: direction
      end subroutine next_interface
   end interface

contains

   !> Stiffness of each virgin spring (springs) [N/m or N m/rad].
   pure function stiffness_of_springs(self) result(k)
      class(spring_rules), intent(in) :: self
      real(wp) :: k(size(self%of))
      integer :: i

      k = [(self%list(self%of(i))%rule%initial_stiffness, i=1, size(k))]
   end function stiffness_of_springs

   !> The branch that follows when the motion leaves the present one by its end in a direction.
   subroutine next_branch(self, branch, direction, flexural_work)
      class(spring_slot), intent(inout) :: self
      !> The branch that ends, replaced by its successor
      type(segment), intent(inout) :: branch
      !> +1: the motion goes up, -1: down
      integer, intent(in) :: direction
      !> Work of the flexural spring of the joint so far [J]; for a spring that decays with it
      real(wp), intent(in) :: flexural_work

      if (self%needs_flexural_work) self%memory%flexural_work = flexural_work
      call self%rule%next(self%memory, branch, direction)
   end subroutine next_branch

   !> Become a copy of the memory of another spring with the same rule, without an allocation where there is
   !> room.
   pure subroutine copy(self, other)
      class(rule_memory), intent(inout) :: self
      class(rule_memory), intent(in) :: other

      self%flexural_work = other%flexural_work
   end subroutine copy

   !> Save or restore all history variables: everything that `next` changes. Here there is none, as the work
   !> of the flexural spring is set anew before each event.
   pure subroutine serialize(self, stream)
      class(rule_memory), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

   end subroutine serialize

   !> Copy a memory to where one of the same rule may be already.
   pure subroutine copy_memory(from, to)
      type(memory_slot), intent(in) :: from
      type(memory_slot), intent(inout) :: to

      if (allocated(to%memory)) then
         call to%memory%copy(from%memory)
      else
         allocate (to%memory, source=from%memory)
      end if
   end subroutine copy_memory

   !> Take the parameters; one that is not given has its default.
   subroutine take(self, value)
      class(rule_type), intent(inout) :: self
      !> Parameters in the order of their keys; `unset`: not given
      real(wp), intent(in), contiguous, target :: value(:)
      type(key_visitor) :: v

      call v%take(value)
      call self%visit(v)
   end subroutine take

   !> Add messages on relations between parameters that are each within their bounds. A rule without such
   !> relations inherits this procedure.
   subroutine check_relations(self, name, messages)
      class(rule_type), intent(inout) :: self
      !> Name of the spring: 'shear spring of joint 2'
      character(len=*), intent(in) :: name
      type(message_list), intent(inout) :: messages

   end subroutine check_relations

   !> Compute the values that follow from the parameters alone, once they have been checked.
   subroutine prepare(self)
      class(rule_type), intent(inout) :: self

   end subroutine prepare

   !> Whether a spring has yielded so far; rules that soften know it, for others it is false.
   pure logical function has_yielded(self, memory)
      class(rule_type), intent(in) :: self
      class(rule_memory), intent(in) :: memory

      has_yielded = .false.
   end function has_yielded

   !> The memory of a virgin spring, and its branch.
   subroutine start(self, axial_load, memory, branch)
      class(rule_type), intent(in) :: self
      !> Axial load, compression positive [N]; only the rule of layers uses it
      real(wp), intent(in) :: axial_load
      class(rule_memory), allocatable, intent(out) :: memory
      type(segment), intent(out) :: branch

      branch = self%branch
      if (allocated(self%memory)) then
         allocate (memory, source=self%memory)
      else
         allocate (memory)
      end if
   end subroutine start

   !> Add a message where stiffness times deformation would overflow or vanish, or where one of the two alone
   !> takes more than half of the exponents that numbers can have.
   subroutine check_product(k, d, name, product_name, messages)
      !> Stiffness [N/m or N m/rad] and deformation [m or rad], both above zero
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
