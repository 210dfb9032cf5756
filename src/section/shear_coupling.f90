!> Bending and shear of a section together: the longitudinal stress of a layer is that of its cracked
!> membrane, which the diagonal compression of the shear changes, and the moment follows from these stresses.
!>
!> For each curvature the strain at mid-depth and the shear stresses are found in turn: the strain by a step
!> of Newton's method towards the axial load, the stresses as the mean of the old ones and those of the
!> shear flow of the longitudinal forces.
module rbs_section_shear_coupling
   use rbs_base_kinds, only: wp
   use rbs_section_balance, only: state_type
   use rbs_section_mcft_layer, only: layer_type, layer_state, layer_stress, solve_layer, stress_of_state
   use rbs_section_resultants, only: force_scale
   use rbs_section_shear_flow, only: flow_type, stresses_of_forces
   use rbs_section_steel_law, only: steel_stress
   implicit none
   private

   public :: couple

   integer, parameter :: most_turns = 200

   !> Largest residuals: axial load as a share of `force_scale`, shear stress as a share of f'c.
   real(wp), parameter :: close_load = 1.0e-6_wp, close_stress = 1.0e-5_wp

   !> Change of the strain from which the slope is found, and the largest step.
   real(wp), parameter :: small_strain = 1.0e-7_wp, longest_step = 2.0e-5_wp

contains

   !> Equilibrium at a curvature from the state before.
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
      real(wp), dimension(size(layers)) :: tau, wanted, concrete_force, aside
      real(wp) :: bar_force(size(flow%section%bar_y)), bar_aside(size(flow%section%bar_y))
      real(wp) :: load, slope, scale, eps0
      integer :: turn

      scale = force_scale(flow%section)
      tau = layer_states%tau
      eps0 = state%eps0
      do turn = 1, most_turns
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

end module rbs_section_shear_coupling
