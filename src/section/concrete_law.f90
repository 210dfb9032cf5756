!> Stress of concrete under a uniaxial strain; compression is positive.
!>
!> Compression: Popovics' curve f = f_p n x/(n - 1 + x^(n k)), x = eps/eps_0. Plain concrete has n, eps_0
!> and the decay k past the peak from its strength (Thorenfeldt, Tomaszewicz, Jensen 1987; Collins and
!> Mitchell 1991); confined concrete has k = 1, and peak and n of Mander, Priestley, Park 1988 (ASCE 114(8)).
!> The initial slope is E_c in both. Tension: E_c eps up to f_t, then one of three laws.
module rbs_section_concrete_law
   use rbs_base_constants, only: unset, unbounded
   use rbs_base_error, only: message_list
   use rbs_base_key_visitor, only: key_visitor, visited_record
   use rbs_base_keys, only: above_zero, bound_type, not_negative
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_base_check, only: check_order, is_given
   implicit none
   private

   public :: concrete_record, concrete_type, plain_concrete, confined_concrete, spalling_concrete
   public :: concrete_stress, concrete_both, tension_place

   !> Tension laws: no tension at any strain; none beyond f_t; tension stiffening f_t/(1 + sqrt(500 eps))
   !> beyond f_t (Collins and Mitchell 1987).
   character(len=4), parameter, public :: tension_names(3) = ['zero', 'bare', 'ts  ']
   character(len=*), parameter, public :: tension_choices = 'zero bare ts'
   integer, parameter, public :: tension_zero = 1, tension_bare = 2, tension_ts = 3

   real(wp), parameter :: mpa = 1.0e6_wp

   !> Bounds of strength, modulus and strain at the peak.
   type(bound_type), parameter :: strengths = &
      bound_type(5.0_wp*mpa, 200.0_wp*mpa, reason='(30 MPa is fc = 30e6)')
   type(bound_type), parameter :: moduli = bound_type(1.0e9_wp, 1.0e12_wp, reason='(25 GPa is ec = 25e9)')
   type(bound_type), parameter :: peak_strains = &
      bound_type(0.0_wp, 0.02_wp, least_open=.true., reason='(2 per mille is eps0 = 0.002)')

   !> Input of a concrete.
   type, extends(visited_record) :: concrete_record
      !> Cylinder strength, tensile strength, modulus of elasticity [Pa]; strain at the peak; strain at which
      !> a cover has spalled
      real(wp) :: fc = unset, ft = unset, ec = unset, eps0 = unset, eps_spall = 0.006_wp
   contains
      procedure :: visit, validate, law
   end type concrete_record

   type :: concrete_type
      !> Peak stress in compression and in tension [Pa], modulus of elasticity [Pa]
      real(wp) :: fc = 0.0_wp, ft = 0.0_wp, ec = 0.0_wp
      !> Strain at the peak of compression, exponent of Popovics' curve, factor of it past the peak
      real(wp) :: eps0 = 0.0_wp, n = 0.0_wp, decay = 1.0_wp
      !> Spalling: the strains at which a straight line to zero stress begins and ends
      real(wp) :: eps_line = unbounded, eps_spall = unbounded
      !> Strain at which the confinement is lost: first hoop fracture; unbounded without confinement
      real(wp) :: eps_cu = unbounded
      !> Place of the tension law among `tension_names`
      integer :: tension = tension_ts
   end type concrete_type

contains

   !> Concrete without confinement. Values that are not given follow from the strength:
   !> E_c = 3320 sqrt(f'c) + 6900, f_t = 0.45 f'c^0.4, n = 0.8 + f'c/17 (MPa), eps_0 = f'c/E_c n/(n - 1).
   elemental type(concrete_type) function plain_concrete(fc, ft, ec, eps0) result(law)
      !> Cylinder strength [Pa]; tensile strength, modulus [Pa] and strain at the peak, or `unset`
      real(wp), intent(in) :: fc, ft, ec, eps0
      real(wp) :: strength

      strength = fc/mpa
      law%fc = fc
      law%ft = ft
      if (.not. is_given(ft)) law%ft = 0.45_wp*strength**0.4_wp*mpa
      law%ec = ec
      if (.not. is_given(ec)) law%ec = (3320.0_wp*sqrt(strength) + 6900.0_wp)*mpa
      law%n = 0.8_wp + strength/17.0_wp
      if (is_given(eps0)) then
         law%eps0 = eps0
         law%n = law%ec*eps0/(law%ec*eps0 - fc)    ! keeps E_c as the initial slope
      else
         law%eps0 = fc/law%ec*law%n/(law%n - 1.0_wp)
      end if
      law%decay = max(1.0_wp, 0.67_wp + strength/62.0_wp)
   end function plain_concrete

   !> The same concrete under lateral stress (Mander, Priestley, Park 1988).
   elemental type(concrete_type) function confined_concrete(plain, lateral, eps_cu) result(law)
      type(concrete_type), intent(in) :: plain
      !> Effective lateral stress f_l [Pa]; strain at hoop fracture
      real(wp), intent(in) :: lateral, eps_cu
      real(wp) :: share, eps_co

      law = plain
      share = lateral/plain%fc
      law%fc = plain%fc*(-1.254_wp + 2.254_wp*sqrt(1.0_wp + 7.94_wp*share) - 2.0_wp*share)
      ! 0.002 as in the source. Strong concrete (above about 50 MPa) peaks later; with 0.002 its secant would
      ! approach E_c, for which the curve is not defined.
      eps_co = max(0.002_wp, 0.9_wp*plain%eps0, 1.1_wp*plain%fc/plain%ec)
      law%eps0 = eps_co*(1.0_wp + 5.0_wp*(law%fc/plain%fc - 1.0_wp))
      law%n = law%ec/(law%ec - law%fc/law%eps0)
      law%decay = 1.0_wp
      law%eps_cu = eps_cu
   end function confined_concrete

   !> The same concrete as cover that spalls: from 2 eps_0 on a straight line to zero stress at eps_spall.
   elemental type(concrete_type) function spalling_concrete(plain, eps_spall) result(law)
      type(concrete_type), intent(in) :: plain
      !> Strain at which the cover has spalled; the line begins at three quarters of it at the latest
      real(wp), intent(in) :: eps_spall

      law = plain
      law%eps_line = min(2.0_wp*plain%eps0, 0.75_wp*eps_spall)
      law%eps_spall = eps_spall
   end function spalling_concrete

   !> Place of a tension law, of which the name has been checked.
   pure integer function tension_place(word)
      character(len=*), intent(in) :: word

      tension_place = findloc(tension_names == word, .true., dim=1)
   end function tension_place

   !> Stress [Pa] at a strain, compression positive.
   elemental real(wp) function concrete_stress(law, strain) result(stress)
      type(concrete_type), intent(in) :: law
      real(wp), intent(in) :: strain
      real(wp) :: tangent

      call concrete_both(law, strain, stress, tangent)
   end function concrete_stress

   !> Stress and slope together, as both need the same costly power.
   elemental subroutine concrete_both(law, strain, stress, tangent)
      type(concrete_type), intent(in) :: law
      !> Compression positive
      real(wp), intent(in) :: strain
      !> Stress, compression positive, and its slope by the strain [Pa]
      real(wp), intent(out) :: stress, tangent

      if (strain <= 0.0_wp) then
         call in_tension(law, -strain, stress, tangent)
      else if (strain <= law%eps_line) then
         call in_compression(law, strain, stress, tangent)
      else if (strain < law%eps_spall) then
         ! The cover spalls: a straight line from the stress at eps_line to zero.
         call in_compression(law, law%eps_line, stress, tangent)
         tangent = -stress/(law%eps_spall - law%eps_line)
         stress = -tangent*(law%eps_spall - strain)
      else
         stress = 0.0_wp
         tangent = 0.0_wp
      end if
   end subroutine concrete_both

   !> Stress and tangent [Pa] of the curve of compression at a strain above zero.
   pure subroutine in_compression(law, strain, stress, tangent)
      type(concrete_type), intent(in) :: law
      real(wp), intent(in) :: strain
      real(wp), intent(out) :: stress, tangent
      real(wp) :: x, power, exponent, below

      x = strain/law%eps0
      exponent = law%n
      if (x > 1.0_wp) exponent = law%n*law%decay
      power = x**exponent
      below = 1.0_wp/(law%n - 1.0_wp + power)
      stress = law%fc*law%n*x*below
      tangent = law%fc*law%n*(law%n - 1.0_wp + (1.0_wp - exponent)*power)*below**2/law%eps0
   end subroutine in_compression

   !> Stress, compression positive and so not above zero here, and tangent [Pa] in tension.
   pure subroutine in_tension(law, opening, stress, tangent)
      type(concrete_type), intent(in) :: law
      !> Strain, tension positive, not below zero
      real(wp), intent(in) :: opening
      real(wp), intent(out) :: stress, tangent
      real(wp) :: root

      stress = 0.0_wp
      tangent = 0.0_wp
      if (law%tension == tension_zero) then
         if (.not. opening > 0.0_wp) tangent = law%ec
      else if (law%ec*opening <= law%ft) then
         stress = -law%ec*opening
         tangent = law%ec
      else if (law%tension == tension_ts) then
         root = sqrt(500.0_wp*opening)
         stress = -law%ft/(1.0_wp + root)
         tangent = -law%ft*250.0_wp/(root*(1.0_wp + root)**2)
      end if
   end subroutine in_tension

   !> The keys of a concrete.
   subroutine visit(self, v)
      class(concrete_record), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%key('fc', self%fc, 'Pa', strengths, 'cylinder strength')
      call v%key('ft', self%ft, 'Pa', not_negative, 'tensile strength; without it 0.45 fc^0.4 (MPa)', &
                 optional=.true.)
      call v%key('ec', self%ec, 'Pa', moduli, &
                 'modulus of elasticity; without it 3320 sqrt(fc) + 6900 (MPa)', optional=.true.)
      call v%key('eps0', self%eps0, '', peak_strains, &
                 'strain at the peak; without it fc/ec n/(n - 1) with n = 0.8 + fc/17 (MPa)', optional=.true.)
      call v%key('eps_spall', self%eps_spall, '', above_zero, 'strain at which the cover has spalled')
   end subroutine visit

   !> Add a message for every value that is refused.
   subroutine validate(self, messages)
      class(concrete_record), intent(inout) :: self
      type(message_list), intent(inout) :: messages
      type(concrete_type) :: law
      logical :: sound

      call self%check('concrete', messages, sound)
      if (.not. sound) return
      if (is_given(self%ft)) call check_order('concrete', 'ft', self%ft, 'must be below', 'fc', self%fc, &
                                              ' Pa', messages)
      law = plain_concrete(self%fc, self%ft, self%ec, unset)
      if (is_given(self%eps0)) then
         if (law%ec*self%eps0 < 1.02_wp*self%fc) then
            call messages%add('concrete: eps0 = '//to_text(self%eps0)//' must be above fc/ec = '// &
                              to_text(self%fc/law%ec)//', where the curve would be straight up to its peak')
         end if
         law%eps0 = self%eps0
      end if
      if (self%eps_spall < 1.2_wp*law%eps0) then
         call messages%add('concrete: eps_spall = '//to_text(self%eps_spall)//' must be above 1.2 times '// &
                           'the strain at the peak, '//to_text(law%eps0))
      end if
   end subroutine validate

   !> The law without confinement.
   pure type(concrete_type) function law(self)
      class(concrete_record), intent(in) :: self

      law = plain_concrete(self%fc, self%ft, self%ec, self%eps0)
   end function law

end module rbs_section_concrete_law
