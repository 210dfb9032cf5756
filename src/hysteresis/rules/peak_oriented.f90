!> Peak-oriented spring with a capped backbone and cyclic deterioration: Ibarra, Medina, Krawinkler 2005
!> (Earthquake Eng. Struct. Dyn. 34, 1489-1511), with a cracking point and an unloading stiffness that may
!> decrease with ductility (Takeda 1970). Its mechanics are those of `rbs_hysteresis_rules_capped`.
module rbs_hysteresis_rules_peak_oriented
   use rbs_base_error, only: message_list
   use rbs_base_key_visitor, only: key_visitor
   use rbs_base_keys, only: bound_type, not_negative, share_below_one
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_base_text, only: to_text
   use rbs_base_tolerances, only: same_input
   use rbs_hysteresis_rules_backbone, only: backbone_parameters
   use rbs_hysteresis_rules_capped, only: start_part, next_branch
   use rbs_hysteresis_rules_capped_lines, only: capped_part, capped_memory
   use rbs_hysteresis_rules_deterioration, only: deterioration_type
   use rbs_hysteresis_rule, only: rule_type, rule_memory
   use rbs_hysteresis_segment, only: segment
   implicit none
   private

   public :: peak_oriented_rule

   character(len=*), parameter :: range_of_source = '(the range of its source)'

   type, extends(rule_type) :: peak_oriented_rule
      !> The peak-oriented part and, in the rule `pinching`, the one that slips; how many there are (1 or 2),
      !> and the share of the first in the force
      type(capped_part) :: part(2)
      integer :: parts = 1
      real(wp) :: share = 1.0_wp
      !> Energies that deterioration of strength, softening line, unloading stiffness and target last for, and
      !> work of the flexural spring that halves the strength that can decay, over f_y d_y; 0: none
      real(wp) :: lambda(4) = 0.0_wp, lambda_h = 0.0_wp
   contains
      procedure :: visit, prepare, check_relations, has_yielded, start, next
   end type peak_oriented_rule

   type, extends(rule_memory) :: peak_oriented_memory
      integer :: parts = 1
      !> Of each part, its memory and, where there are two, its present branch
      type(capped_memory) :: part(2)
      type(segment) :: branch(2)
   contains
      procedure :: copy, serialize
   end type peak_oriented_memory

contains

   !> The keys of the positive side, of both sides, of the negative side.
   subroutine visit(self, v)
      class(peak_oriented_rule), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call self%part(1)%given(1)%visit(v, negative=.false.)
      call v%key('b0', self%part(1)%b0, '', bound_type(0.0_wp, 1.0_wp), &
                 'exponent of the unloading stiffness over ductility')
      call v%key('lambda_s', self%lambda(1), '', not_negative, &
                 'energy over f_y d_y that deterioration of the strength lasts for; 0: none')
      call v%key('lambda_c', self%lambda(2), '', not_negative, &
                 'the same for the softening line behind the cap')
      call v%key('lambda_k', self%lambda(3), '', not_negative, 'the same for the unloading stiffness')
      call v%key('lambda_a', self%lambda(4), '', not_negative, 'the same for the target of reloading')
      call v%key('c', self%part(1)%deterioration%c, '', bound_type(1.0_wp, 2.0_wp, reason=range_of_source), &
                 'exponent of deterioration')
      call v%key('lambda_h', self%lambda_h, '', not_negative, 'energy dissipated in the hinge, in f_y '// &
                 'd_y, after which half of what can be lost is lost; 0: none')
      call v%key('s_min', self%part(1)%s_min, '', share_below_one, &
                 'share of the strength that stays, whatever the flexural spring has done')
      call v%key('fade', self%part(1)%deterioration%fade, '', bound_type(0.0_wp, 4.0_wp), &
                 'strength falls ever more slowly, its rate as its power fade; 0: evenly, to nothing')
      call self%part(1)%given(-1)%visit(v, negative=.true.)
   end subroutine visit

   !> Values that follow from the parameters of the first part: the negative side, energies, stiffness.
   subroutine prepare(self)
      class(peak_oriented_rule), intent(inout) :: self
      real(wp) :: energy

      associate (part => self%part(1))
         part%given(-1) = part%given(-1)%completed(part%given(1))
         ! A side without strength has no cracking force that the other one could unload to.
         where (.not. part%given%carries()) part%given%f_c = 0.0_wp
         energy = energy_of(part)
         part%deterioration = deterioration_type(self%lambda(1)*energy, self%lambda(2)*energy, &
                                                 self%lambda(3)*energy, self%lambda(4)*energy, &
                                                 part%deterioration%c, part%deterioration%fade)
         part%hinge_work = self%lambda_h*energy
         part%k_0 = max(part%given(1)%stiffness(), part%given(-1)%stiffness())
         self%initial_stiffness = part%k_0
         ! The mean of both sides: two struts that cross have the stiffness of the one that is compressed.
         if (.not. all(part%given([1, -1])%carries())) self%initial_stiffness = 0.5_wp*part%k_0
         self%uses_flexural_work = part%hinge_work > 0.0_wp
      end associate
   end subroutine prepare

   !> Whether any part has yielded so far.
   pure logical function has_yielded(self, memory)
      class(peak_oriented_rule), intent(in) :: self
      class(rule_memory), intent(in) :: memory

      has_yielded = .false.
      select type (memory)
      type is (peak_oriented_memory)
         has_yielded = any(memory%part(:self%parts)%now%yielded)
      end select
   end function has_yielded

   !> The energy f_y d_y, the mean of both sides, of which capacities are multiples [J].
   pure real(wp) function energy_of(part)
      type(capped_part), intent(in) :: part

      energy_of = 0.5_wp*(part%given(1)%f_y*part%given(1)%d_y + part%given(-1)%f_y*part%given(-1)%d_y)
   end function energy_of

   !> Add a message for each relation between parameters that does not hold; `prepare` completes the negative
   !> side first.
   subroutine check_relations(self, name, messages)
      class(peak_oriented_rule), intent(inout) :: self
      character(len=*), intent(in) :: name
      type(message_list), intent(inout) :: messages
      integer :: known

      call self%prepare()
      known = messages%count
      if (.not. any(self%part(1)%given([1, -1])%carries())) then
         call messages%add(name//': f_y = 0 and f_y_neg = 0: neither side carries anything; give one of '// &
                           'them strength')
         return
      end if
      call self%part(1)%given(1)%check(name, '', messages)
      ! Otherwise errors of the positive side would be reported twice.
      if (messages%count == known) call self%part(1)%given(-1)%check(name, '_neg', messages)
      if (messages%count > known) return
      if (.not. all(self%part(1)%given([1, -1])%carries())) call refuse_idle_decay()
      if (messages%count > known) return
      call check_capacity(self%part(1)%deterioration%strength, 'lambda_s')
      call check_capacity(self%part(1)%deterioration%softening, 'lambda_c')
      call check_capacity(self%part(1)%deterioration%unloading, 'lambda_k')
      call check_capacity(self%part(1)%deterioration%target, 'lambda_a')

   contains

      !> Strength, softening line and target of a side follow the work of the other one, which is none here.
      subroutine refuse_idle_decay()
         character(len=*), parameter :: key(3) = [character(len=8) :: 'lambda_s', 'lambda_c', 'lambda_a']
         real(wp) :: given(3)
         integer :: i

         given = self%lambda([1, 2, 4])
         do i = 1, 3
            if (.not. given(i) > 0.0_wp) cycle
            call messages%add(name//': '//trim(key(i))//' = '//to_text(given(i))//' does nothing in a '// &
                              'spring of one side, as a side deteriorates by the work of the other one; '// &
                              'remove it')
         end do
      end subroutine refuse_idle_decay

      !> Add a message if so small a capacity lets the force fall faster over the deformation than the spring
      !> is stiff.
      subroutine check_capacity(capacity, key)
         !> E_t [J], 0: none; its key
         real(wp), intent(in) :: capacity
         character(len=*), intent(in) :: key
         real(wp) :: least, unit

         least = max(fastest(self%part(1)%given(1)), fastest(self%part(1)%given(-1)))/self%initial_stiffness
         if (.not. capacity > 0.0_wp .or. capacity >= least*(1.0_wp - same_input)) return
         unit = energy_of(self%part(1))
         call messages%add(name//': '//key//' = '//to_text(capacity/unit)//' must be 0 (it is off) '// &
                           'or at least f_cap**2 (1 + d_cap/d_pc)/(k f_y d_y) = '//to_text(least/unit)// &
                           ' (the force would fall faster than the spring is stiff)')
      end subroutine check_capacity
   end subroutine check_relations

   !> Largest force times the force that the softening line has at zero deformation, f_cap (1 + d_cap/d_pc)
   !> [N2 or N2 m2]: divided by the stiffness it is the least capacity.
   pure real(wp) function fastest(side)
      type(backbone_parameters), intent(in) :: side

      fastest = side%f_cap**2*(1.0_wp + side%d_cap/side%d_pc)
   end function fastest

   !> The memory of a virgin spring, and its branch; the axial load has no effect.
   subroutine start(self, axial_load, memory, branch)
      class(peak_oriented_rule), intent(in) :: self
      real(wp), intent(in) :: axial_load
      class(rule_memory), allocatable, intent(out) :: memory
      type(segment), intent(out) :: branch
      integer :: i

      allocate (peak_oriented_memory :: memory)
      select type (memory)
      type is (peak_oriented_memory)
         memory%parts = self%parts
         do i = 1, self%parts
            call start_part(self%part(i), memory%part(i), memory%branch(i))
         end do
         branch = memory%branch(1)
         if (self%parts == 2) branch = sum_of(memory%branch(1), memory%branch(2), self%share, 0.0_wp)
      end select
   end subroutine start

   !> The branch after the present one, which the motion leaves going up (direction = +1) or down (-1). With
   !> two parts their branches are followed and added up.
   subroutine next(self, memory, branch, direction)
      class(peak_oriented_rule), intent(in) :: self
      class(rule_memory), intent(inout) :: memory
      !> The branch that ends, replaced by its successor
      type(segment), intent(inout) :: branch
      integer, intent(in) :: direction
      real(wp) :: here
      integer :: i

      select type (memory)
      type is (peak_oriented_memory)
         if (self%parts == 1) then
            memory%part(1)%now%flexural_work = memory%flexural_work
            call next_branch(self%part(1), memory%part(1), branch, direction)
         else
            here = branch%end_toward(direction)
            do i = 1, 2
               memory%part(i)%now%flexural_work = memory%flexural_work
               call follow(self%part(i), memory%part(i), memory%branch(i), here, direction)
            end do
            branch = sum_of(memory%branch(1), memory%branch(2), self%share, here)
         end if
      end select
   end subroutine next

   !> A part changes to its next branch if the present one ends here, or if it unloads on a reversal.
   subroutine follow(part, memory, branch, here, direction)
      type(capped_part), intent(in) :: part
      type(capped_memory), intent(inout) :: memory
      type(segment), intent(inout) :: branch
      !> Present deformation [m or rad]
      real(wp), intent(in) :: here
      integer, intent(in) :: direction

      if (branch%unload_on_reversal == -direction) then
         if (direction > 0) then
            branch%hi = here
         else
            branch%lo = here
         end if
      else if (direction*(branch%end_toward(direction) - here) > 0.0_wp) then
         return
      end if
      call next_branch(part, memory, branch, direction)
   end subroutine follow

   !> The branch of two parts together from a deformation on.
   pure type(segment) function sum_of(a, b, share, here) result(branch)
      type(segment), intent(in) :: a, b
      !> Share of part a in the force; present deformation [m or rad]
      real(wp), intent(in) :: share, here

      branch%d0 = here
      ! Equal lines give the same line to the last bit.
      branch%f0 = b%force(here) + share*(a%force(here) - b%force(here))
      branch%k = b%k + share*(a%k - b%k)
      branch%lo = max(a%lo, b%lo)
      branch%hi = min(a%hi, b%hi)
      ! An end belongs to the sum if it belongs to each part that ends there.
      branch%includes_lower_end = (a%includes_lower_end .or. a%lo < branch%lo) .and. &
           (b%includes_lower_end .or. b%lo < branch%lo)
      branch%includes_upper_end = (a%includes_upper_end .or. a%hi > branch%hi) .and. &
           (b%includes_upper_end .or. b%hi > branch%hi)
      branch%unload_on_reversal = a%unload_on_reversal
      if (a%unload_on_reversal == 0) branch%unload_on_reversal = b%unload_on_reversal
   end function sum_of

   !> Become a copy of the memory of another spring of this rule.
   pure subroutine copy(self, other)
      class(peak_oriented_memory), intent(inout) :: self
      class(rule_memory), intent(in) :: other
      integer :: i

      select type (other)
      type is (peak_oriented_memory)
         self%branch = other%branch
         do i = 1, self%parts
            call self%part(i)%copy(other%part(i))
         end do
      end select
   end subroutine copy

   !> Save or restore the parts; with one part the spring itself keeps the branch.
   pure subroutine serialize(self, stream)
      class(peak_oriented_memory), intent(inout) :: self
      type(stream_type), intent(inout) :: stream
      integer :: i

      do i = 1, self%parts
         call self%part(i)%serialize(stream)
      end do
      if (self%parts == 1) return
      call self%branch(1)%serialize(stream)
      call self%branch(2)%serialize(stream)
   end subroutine serialize

end module rbs_hysteresis_rules_peak_oriented
