!> Peak-oriented spring with a capped backbone and cyclic deterioration: Ibarra, Medina, Krawinkler 2005
!> (Earthquake Eng. Struct. Dyn. 34, 1489-1511), with a cracking point and an unloading stiffness that may
!> decrease with ductility (Takeda 1970). Its mechanics are those of `rbs_hysteresis_rules_capped`.
module rbs_hysteresis_rules_peak_oriented
   use rbs_base_check, only: is_given
   use rbs_base_error, only: message_list
   use rbs_base_keys, only: key_type, bound_type, not_negative, share_below_one
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_base_text, only: to_text
   use rbs_hysteresis_rules_backbone_parameters, only: backbone_parameters, backbone_keys, other_side_keys, &
                                                  from_values
   use rbs_hysteresis_rules_capped, only: capped_part, capped_memory
   use rbs_hysteresis_rules_deterioration, only: deterioration_type
   use rbs_hysteresis_rule, only: rule_type, rule_memory
   use rbs_hysteresis_segment, only: segment
   implicit none
   private

   public :: peak_oriented_rule, capped_keys

   character(len=*), parameter :: range_of_source = '(the range of its source)'

   !> Parameters of this rule and of those that extend it: of the positive side, of both sides, of the
   !> negative side.
   type(key_type), parameter :: shared_keys(9) = [ &
      key_type('b0', bound=bound_type(least=0.0_wp, most=1.0_wp), default=0.0_wp, &
               meaning='exponent of the unloading stiffness over ductility'), &
      key_type('lambda_s', bound=not_negative, default=0.0_wp, &
               meaning='energy over f_y d_y that deterioration of the strength lasts for; 0: none'), &
      key_type('lambda_c', bound=not_negative, default=0.0_wp, &
               meaning='the same for the softening line behind the cap'), &
      key_type('lambda_k', bound=not_negative, default=0.0_wp, &
               meaning='the same for the unloading stiffness'), &
      key_type('lambda_a', bound=not_negative, default=0.0_wp, &
               meaning='the same for the target of reloading'), &
      key_type('c', bound=bound_type(least=1.0_wp, most=2.0_wp, reason=range_of_source), default=1.0_wp, &
               meaning='exponent of deterioration'), &
      key_type('lambda_h', bound=not_negative, default=0.0_wp, &
               meaning='work of the flexural spring over f_y d_y that halves what can decay; 0: none'), &
      key_type('s_min', bound=share_below_one, default=0.0_wp, &
               meaning='share of the strength that stays, whatever the flexural spring has done'), &
      key_type('fade', bound=bound_type(least=0.0_wp, most=4.0_wp), default=0.0_wp, &
               meaning='strength falls ever more slowly, its rate as its power fade; 0: evenly, to nothing')]
   !> Capacities are divided by the energy at yield and multiplied by it.
   real(wp), parameter :: round_off = 1.0e-9_wp

   integer, parameter :: sides = size(backbone_keys), shared = size(shared_keys)
   type(key_type), parameter :: capped_keys(*) = [backbone_keys, shared_keys, other_side_keys]

   type, extends(rule_type) :: peak_oriented_rule
      type(capped_part) :: part
   contains
      procedure :: set
      procedure :: initial_stiffness
      procedure :: check
      procedure :: start
      procedure :: next
   end type peak_oriented_rule

   type, extends(rule_memory) :: peak_oriented_memory
      type(capped_memory) :: part
   contains
      procedure :: copy
      procedure :: serialize
   end type peak_oriented_memory

contains

   pure subroutine set(self, value)
      class(peak_oriented_rule), intent(inout) :: self
      real(wp), intent(in) :: value(:)

      associate (part => self%part, positive => value(:sides), &
                 negative => value(sides + shared + 1:2*sides + shared), lambda => value(sides + 2:sides + 5))
         part%given(1) = from_values(positive)
         part%given(-1) = from_values(merge(negative, positive, is_given(negative)))
         part%b0 = value(sides + 1)
         associate (energy => energy_of(part))
            part%deterioration = deterioration_type(lambda(1)*energy, lambda(2)*energy, lambda(3)*energy, &
                                                    lambda(4)*energy, value(sides + 6), value(sides + 9))
            part%hinge_work = value(sides + 7)*energy
            part%s_min = value(sides + 8)
         end associate
         part%k_0 = max(part%given(1)%stiffness(), part%given(-1)%stiffness())
         self%uses_flexural_work = part%hinge_work > 0.0_wp
      end associate
   end subroutine set

   !> The energy in whose units capacities are given: f_y d_y, the mean of both sides [J].
   pure real(wp) function energy_of(part)
      type(capped_part), intent(in) :: part

      energy_of = 0.5_wp*(part%given(1)%f_y*part%given(1)%d_y + part%given(-1)%f_y*part%given(-1)%d_y)
   end function energy_of

   pure real(wp) function initial_stiffness(self)
      class(peak_oriented_rule), intent(in) :: self

      initial_stiffness = self%part%k_0
   end function initial_stiffness

   subroutine check(self, name, messages)
      class(peak_oriented_rule), intent(in) :: self
      character(len=*), intent(in) :: name
      type(message_list), intent(inout) :: messages
      integer :: known

      known = messages%count
      call self%part%given(1)%check(name, '', messages)
      ! Otherwise errors of the positive side would be reported twice.
      if (messages%count == known) call self%part%given(-1)%check(name, '_neg', messages)
      if (messages%count > known) return
      associate (law => self%part%deterioration)
         call check_capacity(law%strength, 'lambda_s')
         call check_capacity(law%softening, 'lambda_c')
         call check_capacity(law%unloading, 'lambda_k')
         call check_capacity(law%target, 'lambda_a')
      end associate

   contains

      !> Nothing deteriorates faster over the deformation than the spring is stiff.
      subroutine check_capacity(capacity, key)
         real(wp), intent(in) :: capacity
         character(len=*), intent(in) :: key
         real(wp) :: least, unit

         least = max(fastest(self%part%given(1)), fastest(self%part%given(-1)))/self%initial_stiffness()
         if (.not. capacity > 0.0_wp .or. capacity >= least*(1.0_wp - round_off)) return
         unit = energy_of(self%part)
         call messages%add(name//': '//key//' = '//to_text(capacity/unit)//' must be 0 (it is off) '// &
                           'or at least f_cap**2 (1 + d_cap/d_pc)/(k f_y d_y) = '//to_text(least/unit)// &
                           ' (the force would fall faster than the spring is stiff)')
      end subroutine check_capacity
   end subroutine check

   !> Largest product of a force that dissipates and the force at zero deformation of the softening line.
   pure real(wp) function fastest(side)
      type(backbone_parameters), intent(in) :: side

      fastest = side%f_cap**2*(1.0_wp + side%d_cap/side%d_pc)
   end function fastest

   subroutine start(self, memory, branch)
      class(peak_oriented_rule), intent(in) :: self
      class(rule_memory), allocatable, intent(out) :: memory
      type(segment), intent(out) :: branch

      allocate (peak_oriented_memory :: memory)
      select type (memory)
      type is (peak_oriented_memory)
         call self%part%start(memory%part, branch)
      end select
   end subroutine start

   subroutine next(self, memory, branch, direction)
      class(peak_oriented_rule), intent(in) :: self
      class(rule_memory), intent(inout) :: memory
      type(segment), intent(inout) :: branch
      integer, intent(in) :: direction

      select type (memory)
      type is (peak_oriented_memory)
         memory%part%now%flexural_work = memory%flexural_work
         call self%part%next(memory%part, branch, direction)
      end select
   end subroutine next

   pure subroutine copy(self, other)
      class(peak_oriented_memory), intent(inout) :: self
      class(rule_memory), intent(in) :: other

      select type (other)
      type is (peak_oriented_memory)
         call self%part%copy(other%part)
      end select
   end subroutine copy

   pure subroutine serialize(self, stream)
      class(peak_oriented_memory), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call self%part%serialize(stream)
   end subroutine serialize

end module rbs_hysteresis_rules_peak_oriented
