!> Material laws, equilibrium and layers in shear of a section, against closed forms.
module test_section
   use check, only: unit_test, check_close, check_passed, check_true
   use rbs_base_constants, only: pi, unset
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_section_balance, only: follow
   use rbs_section_concrete_law, only: concrete_both, concrete_stress, concrete_type, confined_concrete, &
                                       plain_concrete, spalling_concrete, tension_zero
   use rbs_section_section_build, only: build_section
   use rbs_section_resultants, only: section_laws
   use rbs_section_confinement, only: spiral, ties
   use rbs_section_cross_section, only: section_type
   use rbs_section_mcft_layer, only: layer_state, layer_type, solve_layer
   use rbs_section_shape, only: new_shape
   use rbs_section_shear_flow, only: transverse_ratio
   use rbs_section_steel_law, only: steel_type
   implicit none
   private

   public :: collect_section

contains

   subroutine collect_section(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('concrete: slope is that of the stress', concrete_slope), &
               unit_test('concrete: Mander core, spalling cover', confined_law), &
               unit_test('confinement: square ties by hand', confinement), &
               unit_test('no tension, no bars: the moment of a rocking block', rocking), &
               unit_test('a layer reports that it does not carry the shear stress', exhausted), &
               unit_test('a far state of a layer in shear is reached in parts', in_parts), &
               unit_test('stirrups of a circle add up to pi/2 of a leg', circle_stirrups)]
   end subroutine collect_section

   !> 400 by 500 mm, f'c 30 MPa, two rows of bars of 1000 mm2 at +-200 mm.
   type(section_type) function beam(with_bars, strips) result(section)
      logical, intent(in) :: with_bars
      integer, intent(in) :: strips
      integer :: bars

      bars = merge(2, 0, with_bars)
      call new_shape('rectangle', 0.4_wp, 0.5_wp, section%shape)
      section%cover = 0.03_wp
      section%side_cover = 0.03_wp
      section%bar_diameter = 0.02_wp
      section%plain = plain_concrete(30.0e6_wp, unset, unset, unset)
      allocate (section%steels(1), section%bar_y(bars), section%bar_area(bars), section%bar_steel(bars))
      section%steels(1) = steel_type(450.0e6_wp, 600.0e6_wp)
      if (with_bars) section%bar_y = [0.2_wp, -0.2_wp]
      section%bar_area = 1.0e-3_wp
      section%bar_steel = 1
      call build_section(section, 0.006_wp, strips)
   end function beam

   subroutine concrete_slope(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp), parameter :: strains(7) = [-3.0e-3_wp, -2.0e-4_wp, -3.0e-5_wp, 4.0e-4_wp, 1.7e-3_wp, &
           2.6e-3_wp, 8.0e-3_wp]
      real(wp), parameter :: step = 1.0e-8_wp
      type(concrete_type) :: laws(2)
      integer :: i, k

      laws(1) = plain_concrete(35.0e6_wp, unset, unset, unset)
      laws(2) = confined_concrete(laws(1), 3.0e6_wp, 0.02_wp)
      do k = 1, 2
         do i = 1, size(strains)
            call check_close(error, concrete_tangent(laws(k), strains(i)), &
                             (concrete_stress(laws(k), strains(i) + step) - &
                              concrete_stress(laws(k), strains(i) - step))/(2.0_wp*step), 1.0e-5_wp, &
                              1.0e3_wp, 'slope')
         end do
      end do
   end subroutine concrete_slope

   subroutine confined_law(error)
      type(error_type), allocatable, intent(inout) :: error
      type(concrete_type) :: plain, core, cover
      real(wp) :: fcc, eps_cc, r, x

      plain = plain_concrete(30.0e6_wp, unset, unset, unset)
      core = confined_concrete(plain, 0.0_wp, 0.01_wp)
      call check_close(error, [core%fc, core%eps0], [30.0e6_wp, 0.002_wp], 1.0e-14_wp, 0.0_wp, &
                       'no lateral stress')
      core = confined_concrete(plain, 3.0e6_wp, 0.01_wp)
      fcc = 30.0e6_wp*(-1.254_wp + 2.254_wp*sqrt(1.794_wp) - 0.2_wp)
      eps_cc = 0.002_wp*(1.0_wp + 5.0_wp*(fcc/30.0e6_wp - 1.0_wp))
      r = plain%ec/(plain%ec - fcc/eps_cc)
      x = 2.0_wp
      call check_close(error, concrete_stress(core, eps_cc), fcc, 1.0e-14_wp, 0.0_wp, 'f_cc')
      call check_close(error, concrete_stress(core, x*eps_cc), fcc*x*r/(r - 1.0_wp + x**r), 1.0e-14_wp, &
                       0.0_wp, 'past the peak')
      cover = spalling_concrete(plain, 0.006_wp)
      x = 2.0_wp*plain%eps0
      call check_close(error, concrete_stress(cover, x), concrete_stress(plain, x), 1.0e-14_wp, 0.0_wp, &
                       'where the line begins')
      call check_close(error, concrete_stress(cover, 0.5_wp*(x + 0.006_wp)), 0.5_wp*concrete_stress(plain, &
                       x), 1.0e-13_wp, 0.0_wp, 'halfway down the line')
      call check_close(error, concrete_stress(cover, [0.006_wp, 0.05_wp]), [0.0_wp, 0.0_wp], 0.0_wp, 0.0_wp, &
                       'fallen off')
   end subroutine confined_law

   subroutine confinement(error)
      type(error_type), allocatable, intent(inout) :: error
      type(section_type) :: section
      real(wp) :: k_e, rho, core

      section = beam(.true., 400)
      section%transverse%kind = ties
      section%transverse%diameter = 0.01_wp
      section%transverse%spacing = 0.11_wp
      section%transverse%legs = 2.0_wp
      section%transverse%legs_across = 3.0_wp
      section%transverse%steel = steel_type(400.0e6_wp, 600.0e6_wp)
      call build_section(section, 0.006_wp, 400)
      ! Core 330 x 430; clear between bars 330 - 30 - 20 = 280 (one gap), 400/2 - 20 = 180 (two).
      core = 0.33_wp*0.43_wp
      k_e = (1.0_wp - (2.0_wp*0.28_wp**2 + 4.0_wp*0.18_wp**2)/(6.0_wp*core))*(1.0_wp - 0.1_wp/0.66_wp)* &
            (1.0_wp - 0.1_wp/0.86_wp)/(1.0_wp - 2.0e-3_wp/core)
      rho = 0.25_wp*pi*1.0e-4_wp/0.11_wp*(2.0_wp/0.33_wp + 3.0_wp/0.43_wp)
      associate (found => section%confinement(1), law => section%core(1))
         call check_close(error, [found%effectiveness, found%ratio, found%stress], &
                          [k_e, rho, 0.5_wp*k_e*rho*400.0e6_wp], 1.0e-12_wp, 0.0_wp, 'ties: k_e, rho_s, f_l')
         call check_close(error, law%eps_cu, 0.004_wp + 1.4_wp*rho*400.0e6_wp*0.1_wp/law%fc, &
                          1.0e-12_wp, 0.0_wp, 'eps_cu')
      end associate
   end subroutine confinement

   !> Linear concrete without tension: x = sqrt(2 N/(E b phi)), M = N (h/2 - x/3).
   subroutine rocking(error)
      type(error_type), allocatable, intent(inout) :: error
      type(section_type) :: section
      type(error_type), allocatable :: outcome
      real(wp), parameter :: load = 50.0e3_wp
      real(wp) :: phi(3), moment(3), eps0(3), x(3)

      section = beam(.false., 4000)
      phi = [1.0e-4_wp, 2.0e-4_wp, 4.0e-4_wp]
      call follow(section, section_laws(section, tension_zero, .false.), load, phi, moment, eps0, outcome)
      call check_passed(error, outcome, 'follow')
      x = sqrt(2.0_wp*load/(section%plain%ec*0.4_wp*phi))
      call check_close(error, moment, load*(0.25_wp - x/3.0_wp), 2.0e-4_wp, 0.0_wp, 'M')
      call check_close(error, eps0, phi*(x - 0.25_wp), 5.0e-4_wp, 0.0_wp, 'eps_0')
   end subroutine rocking

   !> Slopes of the laws [Pa].
   elemental real(wp) function concrete_tangent(law, strain) result(tangent)
      type(concrete_type), intent(in) :: law
      real(wp), intent(in) :: strain
      real(wp) :: stress

      call concrete_both(law, strain, stress, tangent)
   end function concrete_tangent

   !> A layer of 32 MPa concrete with stirrups of 325 MPa.
   pure type(layer_type) function sample_layer(rho_z) result(layer)
      real(wp), intent(in) :: rho_z

      layer%concrete = plain_concrete(32.0e6_wp, unset, unset, unset)
      layer%rho_z = rho_z
      layer%stirrup = steel_type(fy=325.0e6_wp, fu=487.5e6_wp)
   end function sample_layer

   subroutine exhausted(error)
      type(error_type), allocatable, intent(inout) :: error
      type(layer_type) :: layer
      type(layer_state) :: state
      logical :: carried
      real(wp) :: most

      layer = sample_layer(0.001_wp)
      call solve_layer(layer, 1.0e-3_wp, 8.0e6_wp, state, carried)
      call check_true(error, .not. carried, '8 MPa is not carried')
      most = state%tau
      state = layer_state()
      call solve_layer(layer, 1.0e-3_wp, 0.99_wp*most, state, carried)
      call check_true(error, carried, 'almost the reported stress is carried')
      state = layer_state()
      call solve_layer(layer, 1.0e-3_wp, 1.05_wp*most, state, carried)
      call check_true(error, .not. carried, 'not much more is')
   end subroutine exhausted

   !> Yielded stirrups: neither the search over eps_1 nor Newton's method in one step finds this state.
   subroutine in_parts(error)
      type(error_type), allocatable, intent(inout) :: error
      type(layer_type) :: layer
      type(layer_state) :: step_by_step, at_once
      logical :: carried
      integer :: i

      layer = sample_layer(0.004_wp)
      do i = 1, 30
         call solve_layer(layer, 4.9e-3_wp, 0.1e6_wp*i, step_by_step, carried)
         call check_true(error, carried, 'step by step')
      end do
      call solve_layer(layer, 4.9e-3_wp, 3.0e6_wp, at_once, carried)
      call check_true(error, carried, 'at once')
      call check_close(error, at_once%gamma, step_by_step%gamma, 1.0e-6_wp, 0.0_wp, 'gamma')
   end subroutine in_parts

   subroutine circle_stirrups(error)
      type(error_type), allocatable, intent(inout) :: error
      type(section_type) :: section
      real(wp) :: width, total
      integer :: i

      section = beam(.false., 400)
      call new_shape('circle', 0.55_wp, 0.55_wp, section%shape)
      section%transverse%kind = spiral
      section%transverse%diameter = 0.012_wp
      section%transverse%spacing = 0.11_wp
      section%transverse%legs = 2.0_wp
      section%transverse%steel = steel_type(fy=325.0e6_wp, fu=429.0e6_wp)
      call build_section(section, 0.006_wp, 400)
      total = 0.0_wp
      do i = 1, size(section%strips%y)
         width = section%strips%area(i)/section%strips%dy
         total = total + transverse_ratio(section, section%strips%y(i), width)*width*section%strips%dy
      end do
      ! A hoop that a crack at 45 degrees cuts pulls with pi/2 A f over the core: A_v f/s D pi/2 for two legs.
      call check_close(error, total, 0.5_wp*pi*0.25_wp*pi*0.012_wp**2*section%core_shape%depth/0.11_wp, &
                       1.0e-3_wp, 0.0_wp, 'steel over the depth')
   end subroutine circle_stirrups

end module test_section
