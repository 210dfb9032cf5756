!> The shear of a section between plain arrays and the types of the library.
module rbs_bindings_shear_arrays
   use, intrinsic :: iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type, message_list
   use rbs_base_kinds, only: wp
   use rbs_section_concrete_law, only: plain_concrete
   use rbs_section_mcft_layer, only: layer_state, layer_stress, layer_type, solve_layer, stress_of_state
   use rbs_section_cross_section, only: section_type
   use rbs_section_shear_diagram, only: check_shear, follow_shear, shear_diagram_type, shear_point
   use rbs_section_steel_law, only: steel_type
   implicit none
   private

   public :: shear_into_arrays, layer_into_arrays

contains

   !> Follow the shear diagram; points that were not reached are zero.
   subroutine shear_into_arrays(section, tension, confined, coupled, axial_load, span, layers, share, &
                                curvature, points, profile, kept, events, ends, error)
      type(section_type), intent(in) :: section
      integer, intent(in) :: tension, layers
      logical, intent(in) :: confined, coupled
      !> [N], [m], share of (E_c/2) A at the knee
      real(c_double), intent(in) :: axial_load, span, share
      !> [1/m]
      real(c_double), intent(in) :: curvature(:)
      !> In each column curvature, moment, force, strain
      real(c_double), intent(inout) :: points(:, :), ends(:, :)
      !> In each column y, eps_x, tau, gamma, eps_z of a layer at the last point
      real(c_double), intent(inout) :: profile(:, :)
      integer(c_int), intent(inout) :: kept, events(:)
      type(error_type), allocatable, intent(out) :: error
      type(shear_diagram_type) :: diagram
      type(message_list) :: messages
      integer :: i

      call check_shear(axial_load, span, layers, share, curvature, messages)
      call messages%raise(error)
      if (allocated(error)) return
      call follow_shear(section, tension, confined, coupled, axial_load, span, layers, share, curvature, &
                        diagram, error)
      if (allocated(error)) return
      kept = size(diagram%points)
      do i = 1, kept
         points(:, i) = numbers_of(diagram%points(i))
      end do
      ends(:, 1) = numbers_of(diagram%knee)
      ends(:, 2) = numbers_of(diagram%last)
      events = merge(1, 0, [diagram%knee_found, diagram%sheared, diagram%lost])
      profile(1, :) = diagram%y
      profile(2, :) = diagram%eps_x
      profile(3, :) = diagram%tau
      profile(4, :) = diagram%gamma
      profile(5, :) = diagram%eps_z
   end subroutine shear_into_arrays

   pure function numbers_of(point) result(numbers)
      type(shear_point), intent(in) :: point
      real(c_double) :: numbers(4)

      numbers = [point%curvature, point%moment, point%force, point%strain]
   end function numbers_of

   !> One layer along a path of longitudinal strain and shear stress, from its virgin state.
   subroutine layer_into_arrays(concrete, tension, stirrup, path, states, carried)
      !> fc, ft, ec, eps0
      real(c_double), intent(in) :: concrete(4)
      !> Place among `tension_names`
      integer(c_int), intent(in) :: tension
      !> rho_z, fy, fu, es, eps_sh, eps_u
      real(c_double), intent(in) :: stirrup(6)
      !> In each column eps_x (tension positive), tau [Pa]
      real(c_double), intent(in) :: path(:, :)
      !> In each column eps_z, gamma, sigma_x, sigma_z, tau
      real(c_double), intent(out) :: states(:, :)
      !> Whether the layer carries tau
      integer(c_int), intent(out) :: carried(:)
      type(layer_type) :: layer
      type(layer_state) :: state
      type(layer_stress) :: stress
      logical :: found
      integer :: i

      layer%concrete = plain_concrete(concrete(1), concrete(2), concrete(3), concrete(4))
      layer%concrete%tension = tension
      layer%rho_z = stirrup(1)
      layer%stirrup = steel_type(stirrup(2), stirrup(3), stirrup(4), stirrup(5), stirrup(6))
      do i = 1, size(path, 2)
         call solve_layer(layer, path(1, i), path(2, i), state, found)
         stress = stress_of_state(layer, state)
         states(:, i) = [state%eps_z, state%gamma, stress%sigma_x, stress%sigma_z, stress%tau]
         carried(i) = merge(1, 0, found)
      end do
   end subroutine layer_into_arrays

end module rbs_bindings_shear_arrays
