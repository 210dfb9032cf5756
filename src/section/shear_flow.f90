!> Shear stress over the depth of a section that bends: V = M/a with the shear span a.
!>
!> The shear flow is the difference of the forces of two sections, here the bent one and the same without
!> moment (Bentz 2000, with the secant in place of the tangent, ill conditioned at cracking and yield):
!>
!>     q(y) = 1/a  integral from the compression face to y of (sigma(M) - sigma(M = 0)) dA,   tau = q/b
!>
!> Bending and shear of a section together: the longitudinal stress of a layer is that of its cracked
!> membrane, which the diagonal compression of the shear changes, and the moment follows from these stresses.
!>
!> For each curvature the strain at mid-depth and the shear stresses are found in turn: the strain by a step
!> of Newton's method towards the axial load, the stresses as the mean of the old ones and those of the
!> shear flow of the longitudinal forces.
module rbs_section_shear_flow
   use rbs_base_kinds, only: wp
   use rbs_section_balance, only: state_type
   use rbs_section_concrete_law, only: concrete_type, concrete_stress
   use rbs_section_confinement, only: hoop_area, no_ties
   use rbs_section_cross_section, only: section_type, side_of
   use rbs_section_mcft_layer, only: layer_type, layer_state, layer_stress, solve_layer, stress_of_state
   use rbs_section_resultants, only: laws_type, force_scale
   use rbs_section_steel_law, only: steel_stress
   implicit none
   private

   public :: flow_type, begin_flow, shear_stresses, stresses_of_forces, transverse_ratio, couple

   integer, parameter :: most_iterations = 200

   !> Largest residuals: axial load as a share of `force_scale`, shear stress as a share of f'c.
   real(wp), parameter :: close_load = 1.0e-6_wp, close_stress = 1.0e-5_wp

   !> Change of the strain from which the slope is found, and the largest step.
   real(wp), parameter :: small_strain = 1.0e-7_wp, longest_step = 2.0e-5_wp

   !> A section cut into layers, and its longitudinal forces without moment.
   type :: flow_type
      type(section_type) :: section
      type(laws_type) :: laws
      !> Shear span M/V [m]
      real(wp) :: span = 0.0_wp
      !> Forces of the concrete of each layer, and of each bar less the concrete it displaces [N]
      real(wp), allocatable :: concrete_force(:), bar_force(:)
   end type flow_type

contains

   !> Keep the forces of the section before it is bent.
   subroutine begin_flow(flow, state)
      !> Section, laws and span are set; the forces are set here
      type(flow_type), intent(inout) :: flow
      type(state_type), intent(in) :: state
      real(wp), allocatable :: concrete_force(:), bar_force(:)

      call longitudinal_forces(flow, state, concrete_force, bar_force)
      call move_alloc(concrete_force, flow%concrete_force)
      call move_alloc(bar_force, flow%bar_force)
   end subroutine begin_flow

   !> Shear stress in the middle of each layer of the bent section [Pa].
   pure subroutine shear_stresses(flow, state, tau)
      type(flow_type), intent(in) :: flow
      type(state_type), intent(in) :: state
      real(wp), intent(out) :: tau(:)
      real(wp), allocatable :: concrete_force(:), bar_force(:)

      call longitudinal_forces(flow, state, concrete_force, bar_force)
      call stresses_of_forces(flow, concrete_force, bar_force, tau)
   end subroutine shear_stresses

   !> Shear stress in the middle of each layer from the longitudinal forces of layers and bars; the force of a
   !> bar is spread over the height of a layer.
   pure subroutine stresses_of_forces(flow, concrete_force, bar_force, tau)
      type(flow_type), intent(in) :: flow
      !> Forces of the bent section (layers), (bars) [N]
      real(wp), intent(in) :: concrete_force(:), bar_force(:)
      !> (layers) [Pa]
      real(wp), intent(out) :: tau(:)
      !> Force that the layers so far have gained by bending, that of the present one [N]; share of a bar
      !> that lies before the middle of the layer
      real(wp) :: along, gained, share
      integer :: i, j

      along = 0.0_wp
      do i = 1, size(tau)
         gained = concrete_force(i) - flow%concrete_force(i)
         tau(i) = along + 0.5_wp*gained
         along = along + gained
         do j = 1, size(bar_force)
            share = (flow%section%strips%y(i) - flow%section%bar_y(j))/flow%section%strips%dy + 0.5_wp
            tau(i) = tau(i) + (bar_force(j) - flow%bar_force(j))*min(max(share, 0.0_wp), 1.0_wp)
         end do
         tau(i) = tau(i)/flow%span*flow%section%strips%dy/flow%section%strips%area(i)
      end do
   end subroutine stresses_of_forces

   !> Forces of the concrete of each layer, and of each bar less the concrete it displaces [N].
   pure subroutine longitudinal_forces(flow, state, concrete_force, bar_force)
      type(flow_type), intent(in) :: flow
      type(state_type), intent(in) :: state
      real(wp), allocatable, intent(out) :: concrete_force(:), bar_force(:)
      real(wp) :: strain
      integer :: i

      associate (section => flow%section, strips => flow%section%strips, laws => flow%laws)
         allocate (concrete_force(size(strips%y)), bar_force(size(section%bar_y)))
         do i = 1, size(strips%y)
            strain = state%eps0 - state%curvature*strips%y(i)
            concrete_force(i) = mean_stress(laws%shell, strain, state%curvature*strips%dy)*strips%area(i)
            if (laws%confined .and. strips%core_area(i) > 0.0_wp) then
               concrete_force(i) = concrete_force(i) + strips%core_area(i)* &
                                   (concrete_stress(laws%core(side_of(strips%y(i))), strain) - &
                                    concrete_stress(laws%shell, strain))
            end if
         end do
         do i = 1, size(section%bar_y)
            strain = state%eps0 - state%curvature*section%bar_y(i)
            bar_force(i) = steel_stress(section%steels(section%bar_steel(i)), strain)
            if (section%bar_in_core(i)) then
               bar_force(i) = bar_force(i) - concrete_stress(laws%core(side_of(section%bar_y(i))), strain)
            else
               bar_force(i) = bar_force(i) - concrete_stress(laws%shell, strain)
            end if
            bar_force(i) = bar_force(i)*section%bar_area(i)
         end do
      end associate
   end subroutine longitudinal_forces

   !> Mean stress of a layer [Pa], compression positive. The layer that contains the tip of the crack has two
   !> parts, as in the axial force of the section.
   elemental real(wp) function mean_stress(law, strain, fall) result(stress)
      type(concrete_type), intent(in) :: law
      !> Strain in the middle of the layer, and its decrease over the height of the layer
      real(wp), intent(in) :: strain, fall
      !> Share of the layer that is not cracked
      real(wp) :: whole

      whole = 1.0_wp
      if (fall > 0.0_wp) whole = (strain + law%ft/law%ec)/fall + 0.5_wp
      if (whole > 0.0_wp .and. whole < 1.0_wp) then
         stress = whole*concrete_stress(law, strain + 0.5_wp*(1.0_wp - whole)*fall) + &
                  (1.0_wp - whole)*concrete_stress(law, strain - 0.5_wp*whole*fall)
      else
         stress = concrete_stress(law, strain)
      end if
   end function mean_stress

   !> Transverse reinforcement in the direction of the shear, smeared over width and spacing.
   !>
   !> Legs A/(b s) inside the outer edge of the hoops, times the share with which they pull there: a round
   !> hoop is inclined to the shear.
   elemental real(wp) function transverse_ratio(section, y, width) result(ratio)
      type(section_type), intent(in) :: section
      !> Place and width of the layer [m]
      real(wp), intent(in) :: y, width

      ratio = 0.0_wp
      associate (hoops => section%transverse)
         if (hoops%kind == no_ties .or. abs(y) > 0.5_wp*section%shape%depth - section%cover) return
         ratio = hoops%legs*hoop_area(hoops)*section%core_shape%leg_share(y)/(width*hoops%spacing)
      end associate
   end function transverse_ratio

   !> Equilibrium of bending and shear together at a curvature, from the state before.
   pure subroutine couple(flow, layers, axial_load, curvature, state, layer_states, found)
      type(flow_type), intent(in) :: flow
      type(layer_type), intent(in) :: layers(:)
      !> Compression positive [N]; [1/m]
      real(wp), intent(in) :: axial_load, curvature
      !> Strain at mid-depth and moment; on return those at `curvature`
      type(state_type), intent(inout) :: state
      type(layer_state), intent(inout) :: layer_states(:)
      !> Whether there is an equilibrium that all layers carry
      logical, intent(out) :: found
      type(layer_state) :: trial(size(layers))
      !> Shear stresses in use and those of the shear flow [Pa]; forces of the layers, and those at a strain
      !> that differs by `small_strain` [N]
      real(wp), dimension(size(layers)) :: tau, wanted, concrete_force, aside
      real(wp) :: bar_force(size(flow%section%bar_y)), bar_aside(size(flow%section%bar_y))
      real(wp) :: load, slope, scale, eps0
      integer :: iteration

      scale = force_scale(flow%section)
      tau = layer_states%tau
      eps0 = state%eps0
      do iteration = 1, most_iterations
         call membrane_forces(eps0, layer_states, concrete_force, bar_force, found)
         if (.not. found) return
         load = sum(concrete_force) + sum(bar_force)
         call stresses_of_forces(flow, concrete_force, bar_force, wanted)
         found = abs(load - axial_load) <= close_load*scale .and. &
                 maxval(abs(wanted - tau)) <= close_stress*flow%section%plain%fc
         if (found) exit
         trial = layer_states
         call membrane_forces(eps0 + small_strain, trial, aside, bar_aside, found)
         if (.not. found) return
         slope = (sum(aside) + sum(bar_aside) - load)/small_strain
         ! Past the peak of all layers the slope is not positive: a small step towards the axial load.
         slope = max(slope, 1.0e-3_wp*scale/longest_step)
         eps0 = eps0 + min(max((axial_load - load)/slope, -longest_step), longest_step)
         tau = 0.5_wp*(tau + wanted)
      end do
      if (.not. found) return
      state%curvature = curvature
      state%eps0 = eps0
      state%moment = -dot_product(concrete_force, flow%section%strips%y) &
                     - dot_product(bar_force, flow%section%bar_y)

   contains

      !> Longitudinal forces of the layers under given shear stresses, and of the bars less the concrete that
      !> they displace [N].
      pure subroutine membrane_forces(eps0, layer_states, concrete_force, bar_force, carried)
         !> Strain at mid-depth, compression positive; the shear stresses are the `tau` of `couple`
         real(wp), intent(in) :: eps0
         type(layer_state), intent(inout) :: layer_states(:)
         real(wp), intent(out) :: concrete_force(:), bar_force(:)
         logical, intent(out) :: carried
         type(layer_stress) :: stress
         real(wp) :: displaced, strain
         integer :: i, layer

         carried = .true.
         associate (section => flow%section, strips => flow%section%strips)
            do i = 1, size(layers)
               call solve_layer(layers(i), curvature*strips%y(i) - eps0, tau(i), layer_states(i), carried)
               if (.not. carried) return
               stress = stress_of_state(layers(i), layer_states(i))
               ! Layers take tension as positive, forces compression.
               concrete_force(i) = -stress%sigma_x*strips%area(i)
            end do
            do i = 1, size(bar_force)
               strain = eps0 - curvature*section%bar_y(i)
               layer = min(size(layers), 1 + int((section%bar_y(i) + 0.5_wp*section%shape%depth)/strips%dy))
               displaced = concrete_force(layer)/strips%area(layer)
               bar_force(i) = (steel_stress(section%steels(section%bar_steel(i)), strain) - displaced)* &
                              section%bar_area(i)
            end do
         end associate
      end subroutine membrane_forces

   end subroutine couple

end module rbs_section_shear_flow
