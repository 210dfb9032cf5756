!> Stress of reinforcing steel under a monotonic strain, the same in tension and compression.
!>
!> E_s up to f_y; constant to eps_sh; f_u - (f_u - f_y)((eps_u - eps)/(eps_u - eps_sh))^2 up to eps_u; no
!> stress beyond, as the bar is broken (Response-2000, manual table 2-2: quadratic with zero slope at its
!> maximum).
module rbs_section_steel_law
   use rbs_base_error, only: message_list
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_base_check, only: check_positive
   implicit none
   private

   public :: steel_type, steel_stress, steel_tangent, steel_both, steel_yield_strain, check_steel

   type :: steel_type
      !> Yield stress, largest stress, modulus of elasticity [Pa]
      real(wp) :: fy = 0.0_wp, fu = 0.0_wp, es = 200.0e9_wp
      !> Strain at which hardening begins, and of rupture
      real(wp) :: eps_sh = 0.007_wp, eps_u = 0.1_wp
   end type steel_type

contains

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

   !> Slope of the law [Pa].
   elemental real(wp) function steel_tangent(law, strain) result(tangent)
      type(steel_type), intent(in) :: law
      real(wp), intent(in) :: strain
      real(wp) :: stress

      call steel_both(law, strain, stress, tangent)
   end function steel_tangent

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

   !> Add a message for every value that is refused.
   subroutine check_steel(law, name, messages)
      type(steel_type), intent(in) :: law
      !> Which steel: 'steel of bar 3'
      character(len=*), intent(in) :: name
      type(message_list), intent(inout) :: messages
      logical :: ok(5)

      call check_positive(law%fy, name//': fy', 'Pa', messages, ok(1))
      call check_positive(law%fu, name//': fu', 'Pa', messages, ok(2))
      call check_positive(law%es, name//': es', 'Pa', messages, ok(3))
      call check_positive(law%eps_sh, name//': eps_sh', '', messages, ok(4))
      call check_positive(law%eps_u, name//': eps_u', '', messages, ok(5))
      if (.not. all(ok)) return
      if (law%fy < 50.0e6_wp .or. law%fy > 3.0e9_wp) then
         call messages%add(name//': fy = '//to_text(law%fy)//' Pa must be between 50e6 and 3e9: '// &
                           '450 MPa is fy = 450e6')
         return
      end if
      if (law%es < 1.0e10_wp .or. law%es > 1.0e12_wp) then
         call messages%add(name//': es = '//to_text(law%es)//' Pa must be between 10e9 and 1000e9: '// &
                           '200 GPa is es = 200e9')
         return
      end if
      if (law%fu < law%fy) then
         call messages%add(name//': fu = '//to_text(law%fu)//' Pa must not be below fy = '// &
                           to_text(law%fy)//' Pa')
      end if
      if (law%eps_sh < steel_yield_strain(law)) then
         call messages%add(name//': eps_sh = '//to_text(law%eps_sh)//' must not be below the yield '// &
                           'strain fy/es = '//to_text(steel_yield_strain(law)))
      end if
      if (law%eps_u <= law%eps_sh) then
         call messages%add(name//': eps_u = '//to_text(law%eps_u)//' must be above eps_sh = '// &
                           to_text(law%eps_sh))
      else if (law%eps_u > 0.6_wp) then
         call messages%add(name//': eps_u = '//to_text(law%eps_u)//' must be below 0.6; 10 per cent is '// &
                           'eps_u = 0.1')
      end if
   end subroutine check_steel

end module rbs_section_steel_law
