!> Questions about a section and its materials, and their answers.
module rbs_bindings_sections
   use, intrinsic :: iso_c_binding, only: c_double
   use rbs_base_error, only: error_type, message_list
   use rbs_base_kinds, only: wp
   use rbs_bindings_exchange, only: request_type, answer_type
   use rbs_bindings_statements, only: put_statements
   use rbs_case_group_reader, only: group_reader
   use rbs_section_balance, only: axial_capacity, follow
   use rbs_section_concrete_law, only: concrete_stress, concrete_type, tension_place
   use rbs_section_confinement, only: confinement_form, confinement_of, confinement_type, form_of_hinge, &
                                      form_of_wall, hooped_core, no_ties
   use rbs_section_cross_section, only: enclose_core, hooped_core_of, section_type, strip_centroids
   use rbs_section_events, only: check_rules, events_type, find_events, rule_type
   use rbs_section_flexural_spring, only: fit_flexural_spring, flexural_spring_type
   use rbs_section_resultants, only: laws_type, resultants_type, section_laws
   use rbs_section_section_build, only: make_section, figures_of_section, values_of_point, &
                                        values_of_shear_point
   use rbs_section_section_record, only: section_record
   use rbs_section_shape, only: shape_type
   use rbs_section_shear_diagram, only: check_curvatures, follow_shear, shear_diagram_type
   use rbs_section_steel_law, only: steel_stress
   implicit none
   private

   public :: evaluate_section

contains

   !> Answer a question about a section. Strains, curvatures and loads come as arrays of the request; the
   !> settings are those of a group of its statement.
   subroutine evaluate_section(request, answer)
      type(request_type), intent(in) :: request
      type(answer_type), intent(inout) :: answer
      type(group_reader), target :: reader
      type(section_record), pointer :: drawn
      type(section_type) :: section
      type(message_list) :: messages

      reader%of_section = .true.
      call put_statements(request%statement, request%number, reader, messages)
      call messages%raise(answer%error)
      if (allocated(answer%error)) return
      drawn => reader%case%drawing(1)%section
      select case (request%what)
      case ('concrete_response')
         call respond_concrete(request%array('strain'))
         return
      case ('steel_response')
         call drawn%steels(1)%validate(messages)
         call messages%raise(answer%error)
         if (.not. allocated(answer%error)) then
            answer%value = steel_stress(drawn%steels(1)%law(), request%array('strain'))
         end if
         return
      case default                                  ! asks for the section, which is made next
      end select
      call make_section(drawn, section, answer%error)
      if (allocated(answer%error)) return
      select case (request%what)
      case ('section_strips')
         call cut_section(request%wants('round_core'), request%whole('number'), request%array('held'))
      case ('check_section')
         answer%value = figures_of_section(section)
      case ('section_flexure')
         call fit_spring()
      case ('section_shear')
         call follow_shear_diagram(request%array('curvature'))
      case default
         call bend_section()
      end select

   contains

      !> Answer with axial capacity, moments at curvatures, or named points; the settings are those of the
      !> group `diagram`.
      subroutine bend_section()
         type(laws_type) :: laws
         type(resultants_type) :: least, most
         type(events_type) :: events
         real(c_double), pointer, contiguous :: curvature(:)
         !> Strains at least and largest axial load, which Python does not ask for
         real(c_double) :: strain(2)

         associate (given => reader%diagram)
            laws = section_laws(section, tension_place(given%tension), given%confined)
            select case (request%what)
            case ('axial_capacity')
               ! Least and largest axial load without curvature, and the moments at them.
               call axial_capacity(section, laws, least, most, strain)
               answer%value = [least%n, most%n, least%m, most%m]
            case ('moment_curvature')
               ! Curvatures of one sign and increasing magnitude; moments, then strains.
               curvature => request%array('curvature')
               allocate (answer%rows(size(curvature), 2), source=0.0_c_double)
               call follow(section, laws, given%axial_load, curvature, answer%rows(:, 1), answer%rows(:, 2), &
                           answer%error)
            case default
               ! Cracking, yield, peak, ultimate and the end; whether the axial load is lost there.
               call check_rule(given%confined, given%rule(given%yielding), answer%error)
               if (allocated(answer%error)) return
               call find_events(section, laws, given%axial_load, given%rule(given%yielding), events, &
                                answer%error)
               if (allocated(answer%error)) return
               answer%value = [merge(1.0_wp, 0.0_wp, events%lost)]
               answer%rows = reshape([values_of_point(events%cracking), values_of_point(events%yield), &
                                      values_of_point(events%peak), values_of_point(events%ultimate), &
                                      values_of_point(events%last)], [4, 5])
            end select
         end associate
      end subroutine bend_section

      !> Answer with the figures of the flexural spring; rows: points of cracking, yield, peak and ultimate.
      subroutine fit_spring()
         type(flexural_spring_type) :: spring

         call check_rule(reader%springs%confined, reader%springs%rule(reader%springs%yield_rule), &
                         answer%error)
         if (.not. allocated(answer%error)) then
            call fit_flexural_spring(section, reader%springs, spring, answer%error)
         end if
         if (allocated(answer%error)) return
         answer%value = spring%as_array()
         answer%rows = reshape([values_of_point(spring%cracking), values_of_point(spring%yield), &
                                values_of_point(spring%peak), values_of_point(spring%ultimate)], [4, 4])
      end subroutine fit_spring

      !> Answer with the points of a shear diagram, then its knee and its last point, as rows. Values: whether
      !> the knee was found, a layer sheared, the axial load was lost; then the profile of the layers at the
      !> last point.
      subroutine follow_shear_diagram(curvature)
         !> Curvatures to follow [1/m]
         real(c_double), intent(in) :: curvature(:)
         type(shear_diagram_type) :: diagram
         type(message_list) :: messages
         integer :: i, count

         call check_curvatures(curvature, messages)
         call messages%raise(answer%error)
         if (allocated(answer%error)) return
         call follow_shear(section, reader%shear, curvature, diagram, answer%error)
         if (allocated(answer%error)) return
         count = size(diagram%points)
         allocate (answer%rows(4, count + 2))
         do i = 1, count
            answer%rows(:, i) = values_of_shear_point(diagram%points(i))
         end do
         answer%rows(:, count + 1) = values_of_shear_point(diagram%knee)
         answer%rows(:, count + 2) = values_of_shear_point(diagram%last)
         answer%value = [merge(1.0_wp, 0.0_wp, [diagram%knee_found, diagram%sheared, diagram%lost]), &
                        diagram%y, diagram%eps_x, diagram%tau, diagram%gamma, diagram%eps_z]
      end subroutine follow_shear_diagram

      !> Answer with stresses of unconfined concrete [Pa], compression positive; the tension law is that of
      !> the group `diagram`.
      subroutine respond_concrete(strain)
         !> Compression positive
         real(c_double), intent(in) :: strain(:)
         type(concrete_type) :: law
         type(message_list) :: messages

         call drawn%concrete%validate(messages)
         call messages%raise(answer%error)
         if (allocated(answer%error)) return
         law = drawn%concrete%law()
         law%tension = tension_place(reader%diagram%tension)
         answer%value = concrete_stress(law, strain)
      end subroutine respond_concrete

      !> Cut the section into strips. Rows: y of the centroid [m] and area [m2] of the core, then of the
      !> cover. Values: the confining stress [Pa] at y < 0 and at y > 0, then for both the volume of the hoops
      !> over that of the core times their yield stress [Pa].
      subroutine cut_section(round_core, number, held)
         !> Whether the core has a round outline; number of strips
         logical, intent(in) :: round_core
         integer, intent(in) :: number
         !> Number of bars that legs hold, as the only value
         real(c_double), intent(in) :: held(:)
         type(confinement_form) :: form
         !> Confinement on the side y < 0 and on the side y > 0
         type(confinement_type) :: found(2)
         type(hooped_core) :: core
         integer :: side

         call enclose_core(section, round_core)
         ! What no hoop confines is no core.
         if (section%transverse%kind == no_ties .and. .not. section%shape%walled) then
            section%core_shape = shape_type()
         end if
         answer%rows = strip_centroids(section, number)
         form = form_of_hinge
         if (section%shape%walled) form = form_of_wall
         form%held = held(1)
         allocate (answer%value(4), source=0.0_c_double)
         do side = 1, 2
            core = hooped_core_of(section, side)
            found(side) = confinement_of(core, form)
            answer%value(side) = found(side)%stress
            answer%value(2 + side) = found(side)%ratio*core%hoops%steel%fy
         end do
      end subroutine cut_section

      !> Refuse rules of the named points that do not apply to the section.
      subroutine check_rule(confined, rule, error)
         !> Whether confined concrete counts, and the rule that the user chose for yielding
         logical, intent(in) :: confined
         type(rule_type), intent(in) :: rule
         type(error_type), allocatable, intent(out) :: error
         type(message_list) :: messages

         call check_rules(section, confined, rule, messages)
         call messages%raise(error)
      end subroutine check_rule

   end subroutine evaluate_section

end module rbs_bindings_sections
