!> A section and what is asked of it, from names of keys and their values; see `rbs_bindings_statements`.
module rbs_bindings_section_statements
   use, intrinsic :: iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type, message_list
   use rbs_bindings_statements, only: put_statements
   use rbs_case_group_reader, only: group_reader
   use rbs_section_concrete_law, only: tension_names
   use rbs_section_cross_section, only: section_type
   use rbs_section_events, only: check_rules, rule_type
   use rbs_section_mcft_layer, only: layer_state, layer_type, solve_layer, stress_of_state
   use rbs_section_section_build, only: make_section
   use rbs_section_section_figures, only: values_of_layer, values_of_shear_point
   use rbs_section_settings_record, only: place_of
   use rbs_section_shear_diagram, only: check_curvatures, follow_shear, shear_diagram_type
   implicit none
   private

   public :: section_from_statements, record_from_statements, tension_place, check_settings, &
             shear_into_arrays, layer_into_arrays

contains

   !> What is given, with the settings of one group checked.
   subroutine record_from_statements(statement, number, group, setter, error)
      character(len=*), intent(in) :: statement
      real(c_double), intent(in) :: number(:)
      !> Group of settings that is checked; blank for none
      character(len=*), intent(in) :: group
      type(group_reader), intent(inout) :: setter
      type(error_type), allocatable, intent(out) :: error
      type(message_list) :: messages

      setter%of_section = .true.
      call put_statements(statement, number, setter, messages)
      if (group /= '') call setter%check(group, messages)
      call messages%raise(error)
   end subroutine record_from_statements

   !> The same, and the section.
   subroutine section_from_statements(statement, number, group, setter, section, error)
      character(len=*), intent(in) :: statement
      real(c_double), intent(in) :: number(:)
      character(len=*), intent(in) :: group
      type(group_reader), intent(inout) :: setter
      type(section_type), intent(out) :: section
      type(error_type), allocatable, intent(out) :: error

      call record_from_statements(statement, number, group, setter, error)
      if (.not. allocated(error)) call make_section(setter%case%drawing%section, section, error)
   end subroutine section_from_statements

   !> Place of a tension law that has been checked.
   pure integer function tension_place(word)
      character(len=*), intent(in) :: word

      tension_place = place_of(word, tension_names)
   end function tension_place

   !> The rules of the named points must apply to the section.
   subroutine check_settings(section, confined, rule, error)
      type(section_type), intent(in) :: section
      logical, intent(in) :: confined
      type(rule_type), intent(in) :: rule
      type(error_type), allocatable, intent(out) :: error
      type(message_list) :: messages

      call check_rules(section, confined, rule, messages)
      call messages%raise(error)
   end subroutine check_settings

   !> Follow the shear diagram; points that were not reached are zero.
   subroutine shear_into_arrays(section, setter, curvature, points, profile, kept, events, ends, error)
      type(section_type), intent(in) :: section
      type(group_reader), intent(in) :: setter
      !> [1/m]
      real(c_double), intent(in) :: curvature(:)
      !> A column each, as `shear_values`
      real(c_double), intent(inout) :: points(:, :), ends(:, :)
      !> A column each, as `profile_values`
      real(c_double), intent(inout) :: profile(:, :)
      integer(c_int), intent(inout) :: kept, events(:)
      type(error_type), allocatable, intent(out) :: error
      type(shear_diagram_type) :: diagram
      type(message_list) :: messages
      integer :: i

      call check_curvatures(curvature, messages)
      call messages%raise(error)
      if (allocated(error)) return
      associate (given => setter%shear)
         call follow_shear(section, tension_place(given%tension), given%confined, given%coupled, &
                           given%axial_load, given%length, given%layers, given%knee, curvature, diagram, &
                           error)
      end associate
      if (allocated(error)) return
      kept = size(diagram%points)
      do i = 1, kept
         points(:, i) = values_of_shear_point(diagram%points(i))
      end do
      ends(:, 1) = values_of_shear_point(diagram%knee)
      ends(:, 2) = values_of_shear_point(diagram%last)
      events = merge(1, 0, [diagram%knee_found, diagram%sheared, diagram%lost])
      profile(1, :) = diagram%y
      profile(2, :) = diagram%eps_x
      profile(3, :) = diagram%tau
      profile(4, :) = diagram%gamma
      profile(5, :) = diagram%eps_z
   end subroutine shear_into_arrays

   !> One layer along a path of longitudinal strain and shear stress, from its virgin state.
   subroutine layer_into_arrays(setter, path, states, carried)
      type(group_reader), intent(in) :: setter
      !> A column each: eps_x (tension positive), tau [Pa]
      real(c_double), intent(in) :: path(:, :)
      !> A column each, as `layer_values`
      real(c_double), intent(out) :: states(:, :)
      !> Whether the layer carries tau
      integer(c_int), intent(out) :: carried(:)
      type(layer_type) :: layer
      type(layer_state) :: state
      logical :: found
      integer :: i

      layer%concrete = setter%case%drawing%section%concrete%law()
      layer%concrete%tension = tension_place(setter%layer%tension)
      layer%rho_z = setter%layer%rho_z
      layer%stirrup = setter%case%drawing%section%steels(1)%law()
      do i = 1, size(path, 2)
         call solve_layer(layer, path(1, i), path(2, i), state, found)
         states(:, i) = values_of_layer(state, stress_of_state(layer, state))
         carried(i) = merge(1, 0, found)
      end do
   end subroutine layer_into_arrays

end module rbs_bindings_section_statements
