!> Shear of a section: a layer of the modified compression field theory, shear flow, the diagram.
module test_shear
   use check, only: unit_test, check_close, check_passed, check_same, check_true
   use rbs_base_constants, only: pi, unset
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_section_balance, only: advance, begin, state_type
   use rbs_section_concrete_law, only: plain_concrete, tension_ts
   use rbs_section_mcft_layer, only: layer_state, layer_stress, layer_type, solve_layer, stress_of_state
   use rbs_section_resultants, only: section_laws
   use rbs_section_cross_section, only: section_type, cut_strips, spiral, ties
   use rbs_section_section_build, only: build_section
   use rbs_section_shape, only: new_shape, shape_names
   use rbs_section_shear_diagram, only: follow_shear, shear_diagram_type, shear_record
   use rbs_section_shear_flow, only: begin_flow, flow_type, shear_stresses, transverse_ratio, couple
   use rbs_section_steel_law, only: steel_stress, steel_type
   implicit none
   private

   public :: collect_shear

   !> Axial load of the sample column [N] and its length [m].
   real(wp), parameter :: load = 968.0e3_wp, span = 1.65_wp

contains

   subroutine collect_shear(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('slopes are the differences of the stresses', slopes), &
               unit_test('shear in the other direction is the mirror image', mirror), &
               unit_test('a layer reports that it does not carry the stress', exhausted), &
               unit_test('shear flow adds up to the shear force', flow_adds_up), &
               unit_test('shear flow of an elastic section is V S/(I b)', elastic_flow), &
               unit_test('a far state is reached in parts', in_parts), &
               unit_test('stirrups of a circle add up to pi/2 of a leg', circle_stirrups), &
               unit_test('V/gamma is (E_c/2) A before cracking', before_cracking), &
               unit_test('more layers change nothing', more_layers), &
               unit_test('the failure in shear does not depend on the points', failure_alone), &
               unit_test('coupled, the layers carry N, M and V', coupled_equilibrium), &
               unit_test('coupled without shear is flexure alone', coupled_without_shear)]
   end subroutine collect_shear

   !> A layer of 32 MPa concrete with stirrups of 325 MPa.
   pure type(layer_type) function sample_layer(rho_z) result(layer)
      real(wp), intent(in) :: rho_z

      layer%concrete = plain_concrete(32.0e6_wp, unset, unset, unset)
      layer%rho_z = rho_z
      layer%stirrup = steel_type(fy=325.0e6_wp, fu=487.5e6_wp)
   end function sample_layer

   !> Tanaka and Park No 5 of the paper's table 2.
   type(section_type) function sample_section() result(section)
      real(wp), parameter :: bar = 0.25_wp*pi*0.02_wp**2
      real(wp), parameter :: edge = 0.275_wp - 0.04_wp - 0.012_wp - 0.01_wp

      allocate (section%bar_y(4), section%bar_area(4), section%bar_steel(4), section%steels(1))
      call new_shape('rectangle', 0.55_wp, 0.55_wp, section%shape)
      section%cover = 0.04_wp
      section%side_cover = 0.04_wp
      section%bar_diameter = 0.02_wp
      section%transverse%kind = ties
      section%transverse%diameter = 0.012_wp
      section%transverse%spacing = 0.11_wp
      section%transverse%legs = 4.0_wp
      section%transverse%steel = steel_type(fy=325.0e6_wp, fu=429.0e6_wp)
      section%plain = plain_concrete(32.0e6_wp, unset, unset, unset)
      section%bar_y(:) = [-edge, -edge/3.0_wp, edge/3.0_wp, edge]
      section%bar_area(:) = [4.0_wp, 2.0_wp, 2.0_wp, 4.0_wp]*bar
      section%bar_steel(:) = 1
      section%steels(1) = steel_type(fy=511.0e6_wp, fu=675.0e6_wp)
      call build_section(section, 0.006_wp, 400)
   end function sample_section

   subroutine slopes(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp), parameter :: h = 1.0e-8_wp
      type(layer_type) :: layer
      type(layer_state) :: state
      type(layer_stress) :: here, less, more
      real(wp) :: scale
      integer :: i

      layer = sample_layer(0.004_wp)
      scale = layer%concrete%ec
      do i = 1, 40
         state = layer_state(eps_z=2.0e-3_wp*sin(1.0_wp*i), gamma=2.5e-3_wp*abs(cos(1.7_wp*i)), &
                             eps_x=1.5e-3_wp*sin(2.3_wp*i + 1.0_wp))
         here = stress_of_state(layer, state)
         less = stress_of_state(layer, layer_state(state%eps_z - h, state%gamma, state%eps_x))
         more = stress_of_state(layer, layer_state(state%eps_z + h, state%gamma, state%eps_x))
         call check_close(error, here%z_by_z, 0.5_wp*(more%sigma_z - less%sigma_z)/h, 0.0_wp, &
                          1.0e-5_wp*scale, 'sigma_z by eps_z, state '//to_text(i))
         call check_close(error, here%tau_by_z, 0.5_wp*(more%tau - less%tau)/h, 0.0_wp, 1.0e-5_wp*scale, &
                          'tau by eps_z, state '//to_text(i))
         less = stress_of_state(layer, layer_state(state%eps_z, state%gamma - h, state%eps_x))
         more = stress_of_state(layer, layer_state(state%eps_z, state%gamma + h, state%eps_x))
         call check_close(error, here%z_by_gamma, 0.5_wp*(more%sigma_z - less%sigma_z)/h, 0.0_wp, &
                          1.0e-5_wp*scale, 'sigma_z by gamma, state '//to_text(i))
         call check_close(error, here%tau_by_gamma, 0.5_wp*(more%tau - less%tau)/h, 0.0_wp, 1.0e-5_wp*scale, &
                          'tau by gamma, state '//to_text(i))
      end do
   end subroutine slopes

   subroutine mirror(error)
      type(error_type), allocatable, intent(inout) :: error
      type(layer_type) :: layer
      type(layer_state) :: up, down
      logical :: carried
      integer :: i

      layer = sample_layer(0.004_wp)
      do i = 1, 10
         call solve_layer(layer, 4.0e-4_wp, 2.0e5_wp*i, up, carried)
         call solve_layer(layer, 4.0e-4_wp, -2.0e5_wp*i, down, carried)
         call check_same(error, [down%gamma, down%eps_z, down%tau], [-up%gamma, up%eps_z, -up%tau], 'state')
      end do
      call solve_layer(layer, 4.0e-4_wp, 1.0e6_wp, down, carried)
      call check_true(error, carried .and. down%gamma > 0.0_wp, 'back again')
   end subroutine mirror

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

   !> The flow of the sample bent to a curvature.
   subroutine bent_flow(curvature, flow, state, tau, error)
      real(wp), intent(in) :: curvature
      type(flow_type), intent(out) :: flow
      type(state_type), intent(out) :: state
      real(wp), allocatable, intent(out) :: tau(:)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: failure
      logical :: found

      flow%section = sample_section()
      flow%laws = section_laws(flow%section, tension_ts, .false.)
      flow%span = span
      call begin(flow%section, flow%laws, load, state, failure)
      call check_passed(error, failure, 'the analysis')
      call begin_flow(flow, state)
      call advance(flow%section, flow%laws, load, curvature, state, found)
      call check_true(error, found, 'equilibrium')
      allocate (tau(size(flow%section%strips%y)))
      call shear_stresses(flow, state, tau)
   end subroutine bent_flow

   subroutine flow_adds_up(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp), parameter :: curvatures(4) = [1.0e-4_wp, 1.2e-3_wp, 8.0e-3_wp, 20.0e-3_wp]
      type(flow_type) :: flow
      type(state_type) :: state
      real(wp), allocatable :: tau(:)
      integer :: i

      do i = 1, size(curvatures)
         call bent_flow(curvatures(i), flow, state, tau, error)
         call check_close(error, sum(tau*flow%section%strips%area), state%moment/span, 2.0e-5_wp, 0.0_wp, 'V')
         call check_close(error, tau(size(tau)), 0.0_wp, 0.0_wp, 0.03_wp*maxval(tau), 'at the tension face')
      end do
   end subroutine flow_adds_up

   subroutine elastic_flow(error)
      type(error_type), allocatable, intent(inout) :: error
      type(flow_type) :: flow
      type(state_type) :: state
      real(wp), allocatable :: tau(:)
      type(error_type), allocatable :: failure
      logical :: found
      integer :: i

      ! No bars, and so little load that the concrete is elastic.
      flow%section = sample_section()
      flow%section%bar_y = [real(wp) ::]
      flow%section%bar_area = [real(wp) ::]
      flow%section%bar_steel = [integer ::]
      flow%section%bar_in_core = [logical ::]
      flow%laws = section_laws(flow%section, tension_ts, .false.)
      flow%span = span
      call begin(flow%section, flow%laws, 1.0e3_wp, state, failure)
      call check_passed(error, failure, 'the analysis')
      call begin_flow(flow, state)
      call advance(flow%section, flow%laws, 1.0e3_wp, 1.0e-7_wp, state, found)
      allocate (tau(size(flow%section%strips%y)))
      call shear_stresses(flow, state, tau)
      do i = 1, size(tau)
         call check_close(error, tau(i), 1.5_wp*state%moment/span/0.55_wp**2* &
                          (1.0_wp - (2.0_wp*flow%section%strips%y(i)/0.55_wp)**2), 1.0e-3_wp, &
                          1.0e-4_wp*maxval(tau), 'parabola')
      end do
   end subroutine elastic_flow

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

      section = sample_section()
      call new_shape('circle', 0.55_wp, 0.55_wp, section%shape)
      section%transverse%kind = spiral
      section%transverse%legs = 2.0_wp
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

   subroutine before_cracking(error)
      type(error_type), allocatable, intent(inout) :: error
      type(section_type) :: section
      type(shear_diagram_type) :: diagram
      type(error_type), allocatable :: failure
      integer :: shape

      do shape = 1, size(shape_names)
         section = sample_section()
         call new_shape(shape_names(shape), 0.55_wp, 0.55_wp, section%shape)
         if (section%shape%hollow) section%shape%wall = 0.15_wp
         section%shape%side_wall = section%shape%wall
         section%shape%flange_width = 0.9_wp
         section%shape%flange_thickness = 0.15_wp
         section%bar_area = 1.0e-12_wp*section%bar_area
         call build_section(section, 0.006_wp, 400)
         call follow_shear(section, shear_record(length=span, axial_load=0.0_wp), [1.0e-7_wp], diagram, &
                           failure)
         call check_passed(error, failure, 'the analysis')
         call check_close(error, diagram%points(1)%force/diagram%points(1)%strain, &
                          0.5_wp*section%plain%ec*section%shape%area(), 1.0e-3_wp, 0.0_wp, 'shear stiffness')
      end do
   end subroutine before_cracking

   !> The diagram of the sample.
   subroutine sample_diagram(layers, points, diagram, error)
      integer, intent(in) :: layers, points
      type(shear_diagram_type), intent(out) :: diagram
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: failure
      real(wp) :: curvature(points)
      integer :: i

      do i = 1, points
         curvature(i) = 0.022_wp*(real(i, wp)/points)**2
      end do
      call follow_shear(sample_section(), shear_record(length=span, axial_load=load, layers=layers), &
                        curvature, diagram, failure)
      call check_passed(error, failure, 'the analysis')
      call check_true(error, diagram%knee_found .and. .not. (diagram%sheared .or. diagram%lost), 'whole')
   end subroutine sample_diagram

   subroutine more_layers(error)
      type(error_type), allocatable, intent(inout) :: error
      type(shear_diagram_type) :: diagram, finer
      integer :: layers

      call sample_diagram(320, 30, finer, error)
      layers = 20
      do while (layers < 320)
         call sample_diagram(layers, 30, diagram, error)
         call check_close(error, diagram%knee%force, finer%knee%force, 0.01_wp, 0.0_wp, 'V at the knee')
         call check_close(error, diagram%knee%strain, finer%knee%strain, 0.01_wp, 0.0_wp, 'knee')
         call check_close(error, diagram%last%strain, finer%last%strain, 0.04_wp, 0.0_wp, 'strain at the end')
         call check_close(error, diagram%last%force, finer%last%force, 0.005_wp, 0.0_wp, 'V at the end')
         layers = 2*layers
      end do
   end subroutine more_layers

   !> The sample without ties and axial load, and with a short span.
   subroutine failing_diagram(points, diagram, error)
      integer, intent(in) :: points
      type(shear_diagram_type), intent(out) :: diagram
      type(error_type), allocatable, intent(inout) :: error
      type(section_type) :: section
      type(error_type), allocatable :: failure
      integer :: i

      section = sample_section()
      section%transverse%kind = 0
      call follow_shear(section, shear_record(length=0.7_wp, axial_load=0.0_wp), &
                        [(0.02_wp*i/points, i=1, points)], diagram, failure)
      call check_passed(error, failure, 'the analysis')
      call check_true(error, diagram%sheared .and. size(diagram%points) < points, 'sheared')
   end subroutine failing_diagram

   subroutine failure_alone(error)
      type(error_type), allocatable, intent(inout) :: error
      type(shear_diagram_type) :: few, many

      call failing_diagram(13, few, error)
      call failing_diagram(301, many, error)
      call check_close(error, few%last%curvature, many%last%curvature, 2.0e-3_wp, 0.0_wp, 'curvature')
      call check_close(error, few%last%force, many%last%force, 2.0e-3_wp, 0.0_wp, 'force')
      call check_close(error, few%last%strain, many%last%strain, 2.0e-2_wp, 0.0_wp, 'strain')
   end subroutine failure_alone

   !> The sample and the arguments of `couple`.
   subroutine coupled_sample(long, flow, layers, state, states, error)
      !> M/V [m]
      real(wp), intent(in) :: long
      type(flow_type), intent(out) :: flow
      type(layer_type), allocatable, intent(out) :: layers(:)
      type(state_type), intent(out) :: state
      type(layer_state), allocatable, intent(out) :: states(:)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: failure
      integer :: i

      flow%section = sample_section()
      call cut_strips(flow%section%shape, flow%section%core_shape, 80, flow%section%strips)
      flow%laws = section_laws(flow%section, tension_ts, .false.)
      flow%span = long
      allocate (layers(80), states(80))
      do i = 1, 80
         layers(i) = sample_layer(transverse_ratio(flow%section, flow%section%strips%y(i), &
                                                   flow%section%shape%width))
      end do
      call begin(flow%section, flow%laws, load, state, failure)
      call check_passed(error, failure, 'equilibrium')
      call begin_flow(flow, state)
   end subroutine coupled_sample

   subroutine coupled_equilibrium(error)
      type(error_type), allocatable, intent(inout) :: error
      type(flow_type) :: flow
      type(layer_type), allocatable :: layers(:)
      type(state_type) :: state, alone
      type(layer_state), allocatable :: states(:)
      type(layer_stress) :: stress
      real(wp) :: axial, moment, force, strain
      logical :: found
      integer :: i

      call coupled_sample(span, flow, layers, state, states, error)
      alone = state
      do i = 1, 20
         call couple(flow, layers, load, 0.4e-3_wp*i, state, states, found)
         call check_true(error, found, 'coupled equilibrium')
      end do
      axial = 0.0_wp
      moment = 0.0_wp
      force = 0.0_wp
      associate (section => flow%section)
         do i = 1, 80
            stress = stress_of_state(layers(i), states(i))
            axial = axial - stress%sigma_x*section%strips%area(i)
            moment = moment + stress%sigma_x*section%strips%area(i)*section%strips%y(i)
            force = force + stress%tau*section%strips%area(i)
         end do
         do i = 1, size(section%bar_y)
            strain = state%eps0 - state%curvature*section%bar_y(i)
            associate (at => minloc(abs(section%strips%y - section%bar_y(i)), dim=1))
               stress = stress_of_state(layers(at), states(at))
            end associate
            strain = steel_stress(section%steels(1), strain) + stress%sigma_x      ! `strain` is now a stress
            axial = axial + strain*section%bar_area(i)
            moment = moment - strain*section%bar_area(i)*section%bar_y(i)
         end do
         call check_close(error, axial, load, 1.0e-4_wp, 0.0_wp, 'N')
         call check_close(error, moment, state%moment, 1.0e-9_wp, 0.0_wp, 'M')
         call check_close(error, force, moment/span, 1.0e-4_wp, 0.0_wp, 'V')
         call advance(section, flow%laws, load, state%curvature, alone, found)
      end associate
      ! Diagonal compression reduces the moment: to 0.94 to 0.97 at yield of the paper's columns.
      call check_true(error, state%moment < 0.98_wp*alone%moment .and. state%moment > 0.93_wp*alone%moment, &
                      'less moment: '//to_text(state%moment/alone%moment))
   end subroutine coupled_equilibrium

   subroutine coupled_without_shear(error)
      type(error_type), allocatable, intent(inout) :: error
      type(flow_type) :: flow
      type(layer_type), allocatable :: layers(:)
      type(state_type) :: state, alone
      type(layer_state), allocatable :: states(:)
      logical :: found
      integer :: i

      call coupled_sample(1.0e5_wp, flow, layers, state, states, error)
      alone = state
      do i = 1, 20
         call couple(flow, layers, load, 0.4e-3_wp*i, state, states, found)
         call check_true(error, found, 'coupled equilibrium')
      end do
      call advance(flow%section, flow%laws, load, state%curvature, alone, found)
      call check_close(error, state%moment, alone%moment, 2.0e-3_wp, 0.0_wp, 'M')
      call check_close(error, state%eps0, alone%eps0, 1.0e-2_wp, 0.0_wp, 'strain')
   end subroutine coupled_without_shear

end module test_shear
