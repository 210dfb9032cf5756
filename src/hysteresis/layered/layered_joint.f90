!> The rule of a layered joint: a fibre section (`rbs_hysteresis_layered_fibre_section`) under a constant
!> axial load is, like any spring, on a branch with two ends: it ends where the first layer reaches an end
!> (`next`). Where the axial load varies, the joint follows a straight path in rotation and axial load from
!> event to event.
module rbs_hysteresis_layered_layered_joint
   use rbs_base_constants, only: unbounded
   use rbs_base_key_visitor, only: key_visitor
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_base_tolerances, only: no_stiffness
   use rbs_hysteresis_layered_fibre_path, only: choose_branches, go
   use rbs_hysteresis_layered_fibre_section, only: fibre_section
   use rbs_hysteresis_rule, only: rule_type, rule_memory, rule_slot
   use rbs_hysteresis_segment, only: segment
   implicit none
   private

   public :: layered_rule, branch_under, carries_axial_load, check_axial_load

   !> Most events on the way to the rotation without moment
   integer, parameter :: most_events = 10000

   !> The layers are springs with rules of their own, which `set_layers` of the spring gives.
   type, extends(rule_type) :: layered_rule
      !> Distances from the middle of the section [m], and the number of equal layers that each represents
      !> (layers)
      real(wp), allocatable :: y(:), weight(:)
      !> The rules of the layers, and which of them each layer has (layers)
      type(rule_slot), allocatable :: rule(:)
      integer, allocatable :: rule_of(:)
   contains
      procedure :: visit, prepare, start, next
   end type layered_rule

contains

   !> The rule has no parameters of its own.
   subroutine visit(self, v)
      class(layered_rule), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

   end subroutine visit

   !> The rotational stiffness with all layers uncracked.
   subroutine prepare(self)
      class(layered_rule), intent(inout) :: self
      real(wp) :: k(size(self%y))
      integer :: i

      k = [(self%rule(self%rule_of(i))%rule%initial_stiffness*self%weight(i), i=1, size(k))]
      self%initial_stiffness = sum(k*(self%y - sum(k*self%y)/sum(k))**2)
   end subroutine prepare

   !> The memory of a virgin joint under an axial load, and its branch; an unsymmetric section rotates until
   !> there is no moment.
   subroutine start(self, axial_load, memory, branch)
      class(layered_rule), intent(in) :: self
      !> Compression positive [N]
      real(wp), intent(in) :: axial_load
      class(rule_memory), allocatable, intent(out) :: memory
      type(segment), intent(out) :: branch

      allocate (fibre_section :: memory)
      select type (memory)
      type is (fibre_section)
         call memory%start(self%y, self%weight, self%rule, self%rule_of)
         call go(memory, 0.0_wp, axial_load)
         memory%carries = .not. memory%failed
         call find_branch(memory, 1, branch)
         if (memory%carries) call find_rest(memory, branch)
      end select
   end subroutine start

   !> The branch after the present one, which the motion leaves going up (direction = +1) or down (-1).
   subroutine next(self, memory, branch, direction)
      class(layered_rule), intent(in) :: self
      class(rule_memory), intent(inout) :: memory
      !> The branch that ends, replaced by its successor
      type(segment), intent(inout) :: branch
      integer, intent(in) :: direction

      select type (section => memory)
      type is (fibre_section)
         call leave_branch(section, branch, direction)
      end select
   end subroutine next

   !> At the end of the present branch in a direction (+1 or -1), or where the motion reverses into that
   !> direction, find the next one.
   subroutine leave_branch(section, branch, direction)
      type(fibre_section), intent(inout) :: section
      !> The branch that ends, replaced by its successor
      type(segment), intent(inout) :: branch
      integer, intent(in) :: direction
      real(wp) :: rotation, distance
      integer :: first

      rotation = branch%end_toward(direction) + section%rest
      if (section%failed .and. abs(rotation - section%rotation) > 0.0_wp) then
         ! The branch behind a failure has no meaning; the moment stays as it was.
         branch = segment(d0=branch%d0, f0=branch%f0)
         return
      end if
      ! The rate of the path is +-1, so the product is the way along it; it is ahead where both agree.
      distance = section%rotation_rate*(rotation - section%rotation)
      first = merge(section%ends%first_ahead, section%ends%first_behind, &
              direction*section%rotation_rate > 0.0_wp)
      ! Reversed somewhere between the ends.
      if (branch%unload_on_reversal == -direction) first = 0
      call section%move_to(rotation, section%axial_load, distance, first)
      call find_branch(section, direction, branch)
   end subroutine leave_branch

   !> The branch of the joint at its present axial load when it rotates further in a direction; it ends on
   !> each side where the first of its layers ends.
   subroutine find_branch(section, direction, branch)
      type(fibre_section), intent(inout) :: section
      !> +1: the rotation increases, -1: it decreases
      integer, intent(in) :: direction
      type(segment), intent(out) :: branch
      real(wp) :: near, far

      ! Both ends belong to the branch: where a joint is exactly on a corner, as one of contacts without
      ! an axial load does at rest, it would otherwise have no branch.
      call choose_branches(section, real(direction, wp), 0.0_wp)
      branch%d0 = section%rotation - section%rest
      branch%f0 = section%moment
      if (section%failed) then
         ! The joint keeps its moment for the rest of the motion; its caller tests `failed`.
         call branch%lead_outward(direction, near=(branch%d0), far=direction*unbounded)
         return
      end if
      ! Along a rotation of rate +-1 sum k v**2 is the slope of the moment.
      branch%k = section%ends%stiffness
      if (abs(branch%k) <= no_stiffness*section%turning) branch%k = 0.0_wp
      far = direction*unbounded
      near = -direction*unbounded
      if (section%ends%ahead < unbounded) far = branch%d0 + direction*section%ends%ahead
      if (section%ends%behind < unbounded) near = branch%d0 - direction*section%ends%behind
      call branch%lead_outward(direction, near=near, far=far, &
                               unload_on_reversal=section%ends%unload_on_reversal)
   end subroutine find_branch

   !> Rotate until there is no moment, and measure rotations from there (`rest`, zero up to now).
   subroutine find_rest(section, branch)
      type(fibre_section), intent(inout) :: section
      !> The branch at that rotation
      type(segment), intent(inout) :: branch
      real(wp) :: moment, distance
      integer :: event, s

      do event = 1, most_events
         moment = section%moment
         if (.not. abs(moment) > 0.0_wp) exit
         s = merge(-1, 1, moment > 0.0_wp)
         if (event == 1) call find_branch(section, s, branch)
         if (section%failed .or. .not. branch%k > 0.0_wp) exit
         distance = -branch%force(section%rotation)/branch%k
         if (abs(distance) <= abs(branch%end_toward(s) - section%rotation)) then
            call section%move_to(section%rotation + distance, section%axial_load, abs(distance), 0)
            exit
         end if
         call leave_branch(section, branch, s)
      end do
      section%rest = section%rotation
      call find_branch(section, 1, branch)
      branch%f0 = 0.0_wp
   end subroutine find_rest

   !> Message on an axial load that the layers of a spring do not carry; blank if they do, or if the spring
   !> has no layers. The message gives the load that they carry, found by bisection.
   subroutine check_axial_load(rule, axial_load, text)
      class(rule_type), intent(in) :: rule
      !> Compression positive [N]
      real(wp), intent(in) :: axial_load
      character(len=:), allocatable, intent(out) :: text
      real(wp) :: carried, refused, trial
      integer :: i

      text = ''
      if (carries_axial_load(rule, axial_load)) return
      ! The load that they carry lies between zero and the one that is refused.
      carried = 0.0_wp
      refused = axial_load
      do i = 1, 50
         trial = 0.5_wp*(carried + refused)
         if (carries_axial_load(rule, trial)) then
            carried = trial
         else
            refused = trial
         end if
      end do
      text = 'its layers cannot carry the axial load of '//to_text(axial_load)//' N, but '// &
             to_text(carried)//' N (compression positive); lower it, or give stronger layers'
   end subroutine check_axial_load

   !> Whether the layers of a spring carry an axial load; true of other springs, which carry none.
   logical function carries_axial_load(rule, axial_load)
      class(rule_type), intent(in) :: rule
      !> Compression positive [N]
      real(wp), intent(in) :: axial_load
      class(rule_memory), allocatable :: memory
      type(segment) :: branch

      call rule%start(axial_load, memory, branch)
      carries_axial_load = .true.
      select type (memory)
      type is (fibre_section)
         carries_axial_load = memory%carries
      end select
   end function carries_axial_load

   !> At a rotation the axial load changes at once; the branch of the joint from there on.
   subroutine branch_under(section, rotation, axial_load, work, branch)
      type(fibre_section), intent(inout) :: section
      !> Present rotation, on the present branch, counted from `rest` [rad]; new axial load, compression
      !> positive [N]
      real(wp), intent(in) :: rotation, axial_load
      !> The work of the moment is added to it [J]
      real(wp), intent(inout) :: work
      type(segment), intent(out) :: branch
      real(wp) :: distance

      ! First along the present branch to the present rotation.
      distance = section%rotation_rate*(rotation + section%rest - section%rotation)
      if (abs(distance) > 0.0_wp) then
         call section%move_to(rotation + section%rest, section%axial_load, distance, 0)
      end if
      call go(section, rotation, axial_load, work)
      call find_branch(section, 1, branch)
   end subroutine branch_under

end module rbs_hysteresis_layered_layered_joint
