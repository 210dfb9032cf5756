!> Stress of reinforcing steel under a monotonic strain, the same in tension and compression.
!>
!> E_s up to f_y; constant to eps_sh; f_u - (f_u - f_y)((eps_u - eps)/(eps_u - eps_sh))^2 up to eps_u; no
!> stress beyond, as the bar is broken (Response-2000, manual table 2-2: quadratic with zero slope at its
!> maximum).
module rbs_section_steel_law
   use rbs_base_check, only: check_order, is_given
   use rbs_base_constants, only: unset, unset_integer
   use rbs_base_error, only: message_list
   use rbs_base_key_visitor, only: key_visitor, visited_record
   use rbs_base_keys, only: above_zero, any_number, bound_type
   use rbs_base_kinds, only: wp
   implicit none
   private

   public :: steel_record, steel_type, steel_stress, steel_both, steel_yield_strain

   type :: steel_type
      !> Yield stress, largest stress, modulus of elasticity [Pa]; strain at which hardening begins, and of
      !> rupture
      real(wp) :: fy = 0.0_wp, fu = 0.0_wp, es = 200.0e9_wp, eps_sh = 0.007_wp, eps_u = 0.1_wp
   end type steel_type

   !> Bounds of yield stress, modulus and strain at rupture.
   type(bound_type), parameter :: strengths = &
      bound_type(50.0e6_wp, 3.0e9_wp, reason='(450 MPa is fy = 450e6)')
   type(bound_type), parameter :: moduli = bound_type(1.0e10_wp, 1.0e12_wp, reason='(200 GPa is es = 200e9)')
   type(bound_type), parameter :: rupture_strains = &
      bound_type(0.0_wp, 0.6_wp, least_open=.true., reason='(10 per cent is eps_u = 0.1)')

   !> Input of a steel.
   type, extends(visited_record) :: steel_record
      !> Number by which bars and hoops refer to it
      integer :: id = unset_integer
      !> As in `steel_type`
      real(wp) :: fy = unset, fu = unset, es = 200.0e9_wp
      real(wp) :: eps_sh = unset, eps_u = 0.1_wp
   contains
      procedure :: visit, validate, law
   end type steel_record

contains

   !> Strain at which the yield stress is reached.
   elemental real(wp) function steel_yield_strain(law)
      type(steel_type), intent(in) :: law

      steel_yield_strain = law%fy/law%es
   end function steel_yield_strain

   !> Stress [Pa], with the sign of the strain.
   elemental real(wp) function steel_stress(law, strain) result(stress)
      type(steel_type), intent(in) :: law
      real(wp), intent(in) :: strain
      real(wp) :: tangent

      call steel_both(law, strain, stress, tangent)
   end function steel_stress

   !> Stress and tangent at a strain.
   elemental subroutine steel_both(law, strain, stress, tangent)
      type(steel_type), intent(in) :: law
      real(wp), intent(in) :: strain
      !> [Pa]
      real(wp), intent(out) :: stress, tangent
      real(wp) :: size, left

      size = abs(strain)
      tangent = 0.0_wp
      if (law%es*size <= law%fy) then
         stress = law%es*strain
         tangent = law%es
      else if (size <= law%eps_sh) then
         stress = sign(law%fy, strain)
      else if (size <= law%eps_u) then
         left = (law%eps_u - size)/(law%eps_u - law%eps_sh)
         stress = sign(law%fu - (law%fu - law%fy)*left**2, strain)
         tangent = 2.0_wp*(law%fu - law%fy)*left/(law%eps_u - law%eps_sh)
      else
         stress = 0.0_wp
      end if
   end subroutine steel_both

   !> The keys of a steel.
   subroutine visit(self, v)
      class(steel_record), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%key('id', self%id, '', any_number, 'number by which bars and hoops refer to the steel', &
                 optional=.true.)
      call v%key('fy', self%fy, 'Pa', strengths, 'yield stress')
      call v%key('fu', self%fu, 'Pa', above_zero, 'largest stress; without it 1.5 fy', optional=.true.)
      call v%key('es', self%es, 'Pa', moduli, 'modulus of elasticity')
      call v%key('eps_sh', self%eps_sh, '', above_zero, 'strain at which hardening begins; without it '// &
                 '0.007, or the yield strain where that is larger', optional=.true.)
      call v%key('eps_u', self%eps_u, '', rupture_strains, 'strain of the largest stress, and of rupture')
   end subroutine visit

   !> Add a message for every value that is refused.
   subroutine validate(self, messages)
      class(steel_record), intent(inout) :: self
      type(message_list), intent(inout) :: messages
      type(steel_type) :: law
      logical :: sound

      call self%check('steel', messages, sound)
      if (.not. sound) return
      law = self%law()
      call check_order('steel', 'fu', law%fu, 'must not be below', 'fy', law%fy, ' Pa', messages)
      call check_order('steel', 'eps_sh', law%eps_sh, 'must not be below', 'the yield strain fy/es', &
                       steel_yield_strain(law), '', messages)
      call check_order('steel', 'eps_u', law%eps_u, 'must be above', 'eps_sh', law%eps_sh, '', messages)
   end subroutine validate

   !> The law.
   pure type(steel_type) function law(self)
      class(steel_record), intent(in) :: self

      law = steel_type(self%fy, self%fu, self%es, self%eps_sh, self%eps_u)
      if (.not. is_given(self%fu)) law%fu = 1.5_wp*self%fy
      if (.not. is_given(self%eps_sh)) law%eps_sh = max(0.007_wp, steel_yield_strain(law))
   end function law

end module rbs_section_steel_law
