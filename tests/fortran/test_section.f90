!> Material laws, strips, equilibrium and events of a section, against closed forms.
module test_section
   use check, only: unit_test, check_close, check_failed, check_passed, check_true
   use rbs_base_constants, only: pi, unset
   use rbs_base_error, only: analysis_failed, bad_input, error_type
   use rbs_base_kinds, only: wp
   use rbs_section_balance, only: axial_capacity, follow
   use rbs_section_concrete_law, only: concrete_both, concrete_stress, concrete_type, confined_concrete, &
                                       plain_concrete, spalling_concrete, tension_bare, tension_ts, &
                                       tension_zero
   use rbs_section_confinement, only: volumetric_ratio
   use rbs_section_events, only: events_type, find_events, rule_type
   use rbs_section_flexural_spring, only: fit_flexural_spring, flexural_spring_type, hinge_record
   use rbs_section_resultants, only: laws_type, resultants, resultants_type, section_laws
   use rbs_section_cross_section, only: section_type, spiral, ties
   use rbs_section_section_build, only: build_section
   use rbs_section_shape, only: new_core, new_shape, shape_names, shape_type
   use rbs_section_steel_law, only: steel_both, steel_stress, steel_type
   use rbs_section_strips, only: cut_strips, strip_centroids, strips_type
   implicit none
   private

   public :: collect_section

contains

   subroutine collect_section(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('concrete: slope, peak and decay (section.md 3)', concrete_law), &
               unit_test('concrete: three tension laws', tension_laws), &
               unit_test('concrete: slope is that of the stress', concrete_slope), &
               unit_test('concrete: Mander core, spalling cover', confined_law), &
               unit_test('steel: corners, symmetry, rupture', steel_law), &
               unit_test('strips: areas and moments of rectangle and circle', strip_sums), &
               unit_test('shapes agree with sums of their width', shapes_agree), &
               unit_test('a round core in a square', round_core), &
               unit_test('confinement: spiral and square ties by hand', confinement), &
               unit_test('uncracked: E_c I of the transformed section', uncracked), &
               unit_test('axial stiffness is the slope of the axial force', axial_slope), &
               unit_test('no tension, no bars: the moment of a rocking block', rocking), &
               unit_test('a symmetric section mirrors its moments', mirrored), &
               unit_test('cracking moment f_t I/(h/2)', cracking), &
               unit_test('axial load over capacity, or lost on the way', capacity), &
               unit_test('compression-controlled: no trilinear line', no_line)]
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

   subroutine concrete_law(error)
      type(error_type), allocatable, intent(inout) :: error
      type(concrete_type) :: law
      real(wp) :: n, ec, eps0, x

      ! f'c = 40 MPa: the formulas of section.md by hand.
      law = plain_concrete(40.0e6_wp, unset, unset, unset)
      n = 0.8_wp + 40.0_wp/17.0_wp
      ec = (3320.0_wp*sqrt(40.0_wp) + 6900.0_wp)*1.0e6_wp
      eps0 = 40.0e6_wp/ec*n/(n - 1.0_wp)
      call check_close(error, [law%ec, law%ft, law%eps0], [ec, 0.45e6_wp*40.0_wp**0.4_wp, eps0], 1.0e-14_wp, &
                       0.0_wp, 'E_c, f_t, eps_0')
      call check_close(error, concrete_stress(law, eps0), 40.0e6_wp, 1.0e-14_wp, 0.0_wp, 'peak')
      call check_close(error, concrete_tangent(law, 1.0e-9_wp), ec, 1.0e-9_wp, 0.0_wp, 'initial slope')
      call check_close(error, concrete_tangent(law, eps0), 0.0_wp, 0.0_wp, 1.0e-6_wp*ec, 'slope at the peak')
      x = 1.7_wp
      call check_close(error, concrete_stress(law, x*eps0), &
                       40.0e6_wp*n*x/(n - 1.0_wp + x**(n*(0.67_wp + 40.0_wp/62.0_wp))), 1.0e-14_wp, 0.0_wp, &
                       'decay past the peak')
      ! Below 20.46 MPa the factor of decay stays 1.
      law = plain_concrete(15.0e6_wp, unset, unset, unset)
      n = 0.8_wp + 15.0_wp/17.0_wp
      call check_close(error, concrete_stress(law, x*law%eps0), 15.0e6_wp*n*x/(n - 1.0_wp + x**n), &
                       1.0e-14_wp, 0.0_wp, 'weak concrete')
      ! With a given strain at the peak E_c is still the initial slope.
      law = plain_concrete(30.0e6_wp, unset, unset, 0.0025_wp)
      call check_close(error, concrete_tangent(law, 1.0e-9_wp), law%ec, 1.0e-5_wp, 0.0_wp, 'given eps0')
      call check_close(error, concrete_stress(law, 0.0025_wp), 30.0e6_wp, 1.0e-14_wp, 0.0_wp, 'its peak')
   end subroutine concrete_law

   subroutine tension_laws(error)
      type(error_type), allocatable, intent(inout) :: error
      type(concrete_type) :: law
      real(wp) :: eps_cr

      law = plain_concrete(30.0e6_wp, unset, unset, unset)
      eps_cr = law%ft/law%ec
      law%tension = tension_ts
      call check_close(error, concrete_stress(law, -0.9_wp*eps_cr), -0.9_wp*law%ft, 1.0e-14_wp, 0.0_wp, &
                       'elastic')
      call check_close(error, concrete_stress(law, -0.002_wp), -law%ft/2.0_wp, 1.0e-14_wp, 0.0_wp, &
                       'ts: 500 eps = 1')
      law%tension = tension_bare
      call check_close(error, concrete_stress(law, -0.9_wp*eps_cr), -0.9_wp*law%ft, 1.0e-14_wp, 0.0_wp, &
                       'bare')
      call check_close(error, concrete_stress(law, -1.1_wp*eps_cr), 0.0_wp, 0.0_wp, 0.0_wp, 'bare, cracked')
      law%tension = tension_zero
      call check_close(error, concrete_stress(law, -0.5_wp*eps_cr), 0.0_wp, 0.0_wp, 0.0_wp, 'zero')
   end subroutine tension_laws

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

   subroutine steel_law(error)
      type(error_type), allocatable, intent(inout) :: error
      type(steel_type) :: law
      real(wp), parameter :: strains(6) = [1.0e-3_wp, 2.25e-3_wp, 5.0e-3_wp, 0.0535_wp, 0.1_wp, 0.11_wp]
      real(wp), parameter :: stresses(6) = [200.0e6_wp, 450.0e6_wp, 450.0e6_wp, 600.0e6_wp, 650.0e6_wp, &
           0.0_wp]

      law = steel_type(450.0e6_wp, 650.0e6_wp)
      call check_close(error, steel_stress(law, strains), stresses, 1.0e-14_wp, 0.0_wp, 'tension')
      call check_close(error, steel_stress(law, -strains), -stresses, 1.0e-14_wp, 0.0_wp, 'compression')
      call check_close(error, steel_tangent(law, 0.0535_wp), 2.0_wp*200.0e6_wp*0.5_wp/0.093_wp, 1.0e-12_wp, &
                       0.0_wp, 'slope halfway along the hardening')
      call check_close(error, steel_tangent(law, 0.1_wp), 0.0_wp, 0.0_wp, 1.0e-3_wp, 'slope at f_u')
   end subroutine steel_law

   subroutine strip_sums(error)
      type(error_type), allocatable, intent(inout) :: error
      type(section_type) :: section

      section = beam(.false., 400)
      call check_close(error, sum(section%strips%area), 0.2_wp, 1.0e-13_wp, 0.0_wp, 'rectangle')
      call check_close(error, sum(section%strips%area*section%strips%y**2), 0.4_wp*0.5_wp**3/12.0_wp, &
                       1.0e-5_wp, 0.0_wp, 'its I')
      call new_shape('circle', 0.5_wp, 0.5_wp, section%shape)
      section%transverse%kind = spiral
      section%transverse%diameter = 0.01_wp
      section%transverse%spacing = 0.1_wp
      section%transverse%steel = steel_type(450.0e6_wp, 650.0e6_wp)
      call build_section(section, 0.006_wp, 400)
      call check_close(error, sum(section%strips%area), section%shape%area(), 1.0e-13_wp, 0.0_wp, 'circle')
      call check_close(error, sum(section%strips%area), 0.25_wp*pi*0.25_wp, 1.0e-13_wp, 0.0_wp, 'pi d^2/4')
      call check_close(error, sum(section%strips%area*section%strips%y**2), pi*0.5_wp**4/64.0_wp, &
                       3.0e-5_wp, 0.0_wp, 'its I')
      call check_close(error, sum(section%strips%core_area), 0.25_wp*pi*0.43_wp**2, 1.0e-13_wp, 0.0_wp, &
                       'core')
   end subroutine strip_sums

   !> Area and moments of a shape against sums of its width over 20 000 thin strips.
   subroutine shapes_agree(error)
      type(error_type), allocatable, intent(inout) :: error
      integer, parameter :: many = 20000
      type(shape_type), allocatable :: shape
      real(wp) :: y(many), width(many), dy
      integer :: place, i

      do place = 1, size(shape_names)
         call new_shape(shape_names(place), 0.6_wp, 0.6_wp, shape)
         if (shape%hollow) shape%wall = 0.12_wp
         if (shape%hollow) shape%side_wall = 0.09_wp
         dy = shape%depth/many
         y = [(-0.5_wp*shape%depth + (i - 0.5_wp)*dy, i=1, many)]
         width = shape%width_at(y)
         associate (part => pack(width, y > -0.1_wp .and. y < 0.25_wp), &
                    at => pack(y, y > -0.1_wp .and. y < 0.25_wp))
            call check_close(error, shape%area_between(-0.1_wp, 0.25_wp), sum(part)*dy, 1.0e-4_wp, 0.0_wp, &
                             trim(shape_names(place))//': part of the area')
            call check_close(error, shape%moment_between(-0.1_wp, 0.25_wp), sum(part*at)*dy, 3.0e-4_wp, &
                             0.0_wp, trim(shape_names(place))//': moment of a part')
         end associate
         call check_close(error, shape%area(), sum(width)*dy, 1.0e-5_wp, 0.0_wp, &
                          trim(shape_names(place))//': area')
         call check_close(error, shape%area_between(-1.0_wp, 1.0_wp), shape%area(), 1.0e-14_wp, 0.0_wp, &
                          trim(shape_names(place))//': all of the area')
         call check_close(error, shape%second_moment(), sum(width*y**2)*dy, 1.0e-5_wp, 0.0_wp, &
                          trim(shape_names(place))//': second moment')
         call check_close(error, shape%width_at(0.31_wp), 0.0_wp, 0.0_wp, 0.0_wp, &
                          trim(shape_names(place))//': width outside')
         call check_close(error, shape%leg_share(0.0_wp), 1.0_wp, 1.0e-14_wp, 0.0_wp, &
                          trim(shape_names(place))//': legs at mid-depth')
      end do
      call new_shape('circle', 0.6_wp, 0.6_wp, shape)
      call check_close(error, shape%shear_area(), 0.9_wp*0.25_wp*pi*0.36_wp, 1.0e-14_wp, 0.0_wp, &
                       'circle: shear area')
      call check_close(error, shape%leg_share([0.18_wp, -0.24_wp, 0.4_wp]), [0.8_wp, 0.6_wp, 0.0_wp], &
                       1.0e-13_wp, 1.0e-7_wp, 'circle: legs')
   end subroutine shapes_agree

   !> A square of 500 mm with a spiral: the core is a circle of 430 mm; half of it has its centroid at
   !> 4 r/(3 pi), and core and cover balance about mid-depth in each half.
   subroutine round_core(error)
      type(error_type), allocatable, intent(inout) :: error
      type(shape_type), allocatable :: outline, core
      type(strips_type) :: strips
      real(wp) :: core_y(2), cover_y(2)

      call new_shape('rectangle', 0.5_wp, 0.5_wp, outline)
      call new_core(outline, .true., 0.07_wp, 0.07_wp, core)
      call check_close(error, core%area(), 0.25_wp*pi*0.43_wp**2, 1.0e-14_wp, 0.0_wp, 'core')
      call cut_strips(outline, core, 2, strips)
      call strip_centroids(outline, core, strips, core_y, cover_y)
      call check_close(error, strips%core_area, [0.5_wp, 0.5_wp]*core%area(), 1.0e-14_wp, 0.0_wp, 'halves')
      call check_close(error, core_y(2), 4.0_wp*0.215_wp/(3.0_wp*pi), 1.0e-14_wp, 0.0_wp, 'half a circle')
      call check_close(error, core_y(1) + core_y(2) + cover_y(1) + cover_y(2), 0.0_wp, 0.0_wp, 1.0e-15_wp, &
                       'symmetry')
      call check_close(error, core_y(2)*strips%core_area(2) + &
                       cover_y(2)*(strips%area(2) - strips%core_area(2)), 0.125_wp*0.125_wp, &
                       1.0e-14_wp, 0.0_wp, 'half of the square')
   end subroutine round_core

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
      call check_close(error, [section%effectiveness, volumetric_ratio(section), section%lateral_stress], &
                       [k_e, rho, 0.5_wp*k_e*rho*400.0e6_wp], 1.0e-12_wp, 0.0_wp, 'ties: k_e, rho_s, f_l')
      call check_close(error, section%core%eps_cu, 0.004_wp + 1.4_wp*rho*400.0e6_wp*0.1_wp/section%core%fc, &
                       1.0e-12_wp, 0.0_wp, 'eps_cu')

      call new_shape('circle', 0.5_wp, 0.5_wp, section%shape)
      section%transverse%kind = spiral
      section%transverse%legs_across = 2.0_wp
      call build_section(section, 0.006_wp, 400)
      core = 0.25_wp*pi*0.43_wp**2
      call check_close(error, section%effectiveness, (1.0_wp - 0.1_wp/0.86_wp)/(1.0_wp - 2.0e-3_wp/core), &
                       1.0e-12_wp, 0.0_wp, 'spiral: k_e')
      call check_close(error, volumetric_ratio(section), pi*1.0e-4_wp/(0.43_wp*0.11_wp), 1.0e-12_wp, 0.0_wp, &
                       'spiral: rho_s')
   end subroutine confinement

   !> Strains so small that concrete is linear to 1e-5.
   subroutine uncracked(error)
      type(error_type), allocatable, intent(inout) :: error
      type(section_type) :: section
      type(laws_type) :: laws
      type(resultants_type) :: sums
      real(wp) :: ratio, area, inertia
      real(wp), parameter :: phi = 2.0e-5_wp, eps0 = 1.0e-6_wp

      section = beam(.true., 2000)
      laws = section_laws(section, tension_ts, .false.)
      sums = resultants(section, laws, eps0, phi)
      ratio = section%steels(1)%es/section%plain%ec - 1.0_wp
      area = 0.2_wp + ratio*2.0e-3_wp
      inertia = 0.4_wp*0.5_wp**3/12.0_wp + ratio*2.0e-3_wp*0.04_wp
      call check_close(error, sums%n, section%plain%ec*area*eps0, 1.0e-4_wp, 0.0_wp, 'N')
      call check_close(error, sums%m, section%plain%ec*inertia*phi, 1.0e-5_wp, 0.0_wp, 'M')
      call check_close(error, sums%stiffness, section%plain%ec*area, 1.0e-4_wp, 0.0_wp, 'dN/d eps')
   end subroutine uncracked

   !> Also where the tip of the crack moves through the strips; to the error of the midpoint rule in the one
   !> that is cut.
   subroutine axial_slope(error)
      type(error_type), allocatable, intent(inout) :: error
      type(section_type) :: section
      type(laws_type) :: laws
      type(resultants_type) :: sums, more, less
      real(wp), parameter :: step = 1.0e-10_wp
      real(wp) :: eps0
      integer :: tension, i

      section = beam(.true., 50)
      do tension = tension_zero, tension_ts
         laws = section_laws(section, tension, .false.)
         do i = -3, 3
            eps0 = 3.1e-4_wp*i + 1.7e-5_wp
            sums = resultants(section, laws, eps0, 5.0e-3_wp)
            more = resultants(section, laws, eps0 + step, 5.0e-3_wp)
            less = resultants(section, laws, eps0 - step, 5.0e-3_wp)
            call check_close(error, sums%stiffness, (more%n - less%n)/(2.0_wp*step), 5.0e-4_wp, 1.0e5_wp, &
                             'slope')
         end do
      end do
   end subroutine axial_slope

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

   subroutine mirrored(error)
      type(error_type), allocatable, intent(inout) :: error
      type(section_type) :: section
      type(error_type), allocatable :: outcome
      real(wp) :: phi(4), up(4), down(4), eps_up(4), eps_down(4)
      integer :: tension

      section = beam(.true., 400)
      phi = [0.0_wp, 5.0e-3_wp, 2.0e-2_wp, 8.0e-2_wp]
      do tension = tension_zero, tension_ts
         call follow(section, section_laws(section, tension, .false.), 8.0e5_wp, phi, up, eps_up, outcome)
         call check_passed(error, outcome, 'up')
         call follow(section, section_laws(section, tension, .false.), 8.0e5_wp, -phi, down, eps_down, &
                     outcome)
         call check_passed(error, outcome, 'down')
         call check_close(error, down, -up, 1.0e-9_wp, 1.0e-4_wp, 'moments')
         call check_close(error, eps_down, eps_up, 1.0e-9_wp, 1.0e-13_wp, 'strains')
      end do
   end subroutine mirrored

   subroutine cracking(error)
      type(error_type), allocatable, intent(inout) :: error
      type(section_type) :: section
      type(error_type), allocatable :: outcome
      type(events_type) :: events
      real(wp) :: inertia

      section = beam(.true., 400)
      call find_events(section, section_laws(section, tension_ts, .false.), 0.0_wp, rule_type(), events, &
                       outcome)
      call check_passed(error, outcome, 'find_events')
      inertia = 0.4_wp*0.5_wp**3/12.0_wp + (section%steels(1)%es/section%plain%ec - 1.0_wp)*2.0e-3_wp*0.04_wp
      call check_close(error, events%cracking%moment, section%plain%ft*inertia/0.25_wp, 5.0e-4_wp, 0.0_wp, &
                       'M_c')
      call check_close(error, events%cracking%curvature, section%plain%ft/section%plain%ec/0.25_wp, &
                       5.0e-4_wp, 0.0_wp, 'phi_c')
      ! At first yield the bar at 0.2 m is at its yield strain.
      call check_close(error, events%yield%curvature*0.2_wp - events%yield%eps0, 450.0e6_wp/200.0e9_wp, &
                       1.0e-9_wp, 0.0_wp, 'strain at yield')
      call check_close(error, events%ultimate%curvature*0.25_wp + events%ultimate%eps0, 0.003_wp, 1.0e-9_wp, &
                       0.0_wp, 'strain at the ultimate point')
      call check_true(error, events%peak%moment >= events%ultimate%moment, 'peak is the largest')
   end subroutine cracking

   subroutine capacity(error)
      type(error_type), allocatable, intent(inout) :: error
      type(section_type) :: section
      type(laws_type) :: laws
      type(error_type), allocatable :: outcome
      type(resultants_type) :: least, most
      real(wp) :: strain(2), phi(2), moment(2), eps0(2)

      section = beam(.true., 400)
      laws = section_laws(section, tension_bare, .false.)
      call axial_capacity(section, laws, least, most, strain)
      call check_close(error, least%n, -2.0e-3_wp*600.0e6_wp, 1.0e-4_wp, 0.0_wp, 'all bars at f_u')
      call check_true(error, most%n > 30.0e6_wp*0.198_wp .and. most%n < 30.0e6_wp*0.198_wp + 0.9e6_wp, &
                      'f_c A_c < most < f_c A_c + f_y A_s')
      phi = [1.0e-3_wp, 5.0e-2_wp]
      call follow(section, laws, 1.01_wp*most%n, phi, moment, eps0, outcome)
      call check_failed(error, outcome, bad_input, 'more compression than the section carries')
      call follow(section, laws, 1.01_wp*least%n, phi, moment, eps0, outcome)
      call check_failed(error, outcome, bad_input, 'more tension than the section carries')
      call follow(section, laws, 0.9_wp*most%n, phi, moment, eps0, outcome)
      call check_failed(error, outcome, analysis_failed, 'no longer carries the axial load')
      call check_true(error, moment(1) > 0.0_wp, 'the moment before is there')
   end subroutine capacity

   subroutine no_line(error)
      type(error_type), allocatable, intent(inout) :: error
      type(section_type) :: section
      type(hinge_record) :: hinge
      type(flexural_spring_type) :: spring
      type(error_type), allocatable :: outcome

      section = beam(.true., 400)
      hinge%length = 1.5_wp
      hinge%axial_load = 4.0e6_wp
      call fit_flexural_spring(section, hinge, spring, outcome)
      call check_failed(error, outcome, bad_input, 'controlled by compression')
      hinge%axial_load = 6.0e5_wp
      call fit_flexural_spring(section, hinge, spring, outcome)
      call check_passed(error, outcome, 'fit')
      call check_close(error, spring%hinge_length, 0.08_wp*1.5_wp + 0.022_wp*450.0_wp*0.02_wp, 1.0e-14_wp, &
                       0.0_wp, 'l_p')
      ! The line goes through its points; eq 7 at D_m = D_u.
      call check_close(error, spring%k_c*spring%d_c + spring%k_y*(spring%d_y - spring%d_c), &
                       spring%yield%moment, 1.0e-12_wp, 0.0_wp, 'M_y')
      call check_close(error, spring%b1*spring%k_c, (spring%cracking%moment + spring%yield%moment)/ &
                       (spring%d_c + spring%d_y)*(spring%yield%curvature/spring%ultimate%curvature)**0.4_wp, &
                       1.0e-12_wp, 0.0_wp, 'eq 7')
   end subroutine no_line

   !> Slopes of the laws [Pa].
   elemental real(wp) function concrete_tangent(law, strain) result(tangent)
      type(concrete_type), intent(in) :: law
      real(wp), intent(in) :: strain
      real(wp) :: stress

      call concrete_both(law, strain, stress, tangent)
   end function concrete_tangent

   elemental real(wp) function steel_tangent(law, strain) result(tangent)
      type(steel_type), intent(in) :: law
      real(wp), intent(in) :: strain
      real(wp) :: stress

      call steel_both(law, strain, stress, tangent)
   end function steel_tangent

end module test_section
