!> Questions that Python can ask: the one table of them.
module rbs_bindings_evaluate
   use, intrinsic :: iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: message_list
   use rbs_base_text, only: list_of, text_buffer
   use rbs_bindings_exchange, only: request_type, answer_type
   use rbs_bindings_ensembles, only: plan_ensemble, run_ensemble
   use rbs_bindings_files, only: case_from_file, case_to_text, groups_of_file, test_from_file
   use rbs_bindings_runs, only: run_analysis
   use rbs_bindings_sections, only: evaluate_section
   use rbs_bindings_statements, only: case_from_statements, structure_from_statements, spring_from_statements
   use rbs_case_case_record, only: case_record
   use rbs_case_key_list, only: keys_as_json
   use rbs_case_methods, only: method_rows
   use rbs_hysteresis_spring_record, only: spring_record
   use rbs_hysteresis_springs, only: follow_path
   use rbs_loading_named_protocols, only: named_protocol
   use rbs_loading_protocol, only: protocol_values
   use rbs_loading_spectrum, only: response_spectrum
   use rbs_output_notes, only: structure_notes, largest_small, largest_ground, much
   use rbs_output_channels, only: channel_units
   use rbs_section_flexural_spring, only: spring_figures
   use rbs_section_section_build, only: point_values, profile_values, section_figures, shear_values
   use rbs_solve_ensemble_run_result, only: measure_names
   use rbs_solve_modal_matrices, only: matrices_type, assemble_matrices
   use rbs_solve_modal_modes, only: modes_type, find_modes
   use rbs_structure_frame_frame, only: frame_type
   use rbs_structure_spring_location, only: flexure, axial, layer
   use rbs_structure_structure, only: structure_type, horizontal, sideways
   use rbs_version, only: version
   implicit none
   private

   public :: evaluate

contains

   !> Answer a request: find its question in this table.
   subroutine evaluate(request, control, answer)
      type(request_type), intent(in) :: request
      !> Words that another thread sets and reads, see `run_block`
      integer(c_int), intent(inout), volatile, target :: control(2)
      type(answer_type), intent(inout) :: answer
      type(text_buffer) :: buffer
      character(len=1), parameter :: line = new_line('a')

      select case (request%what)
      case ('version')
         answer%text = version
      case ('methods')
         call method_rows(answer%text)
      case ('keys')
         call keys_as_json(buffer)
         answer%text = buffer%text(:buffer%length)
      case ('quantities')
         ! A line each: values of rows with their units, measures of a run of an ensemble; then names
         ! of figures of a section.
         answer%text = trim(channel_units())//line//trim(measure_names())//line//list_of(section_figures)// &
                       line//list_of(spring_figures)//line//list_of(point_values)//line// &
                       list_of(shear_values)//line//list_of(profile_values)
         ! Limits of the notes on a run, by which runs of an ensemble and records are judged too.
         answer%value = [largest_small, much, largest_ground]
      case ('check_spring', 'spring_response')
         call evaluate_spring()
      case ('check_structure', 'lay_out', 'modes', 'matrices')
         call evaluate_structure(request, answer)
      case ('cyclic', 'time_history')
         call run_analysis(request, control, answer)
      case ('plan_ensemble')
         call plan_ensemble(request, answer)
      case ('run_ensemble')
         call run_ensemble(request, control, answer)
      case ('to_namelist')
         call case_to_text(request, answer)
      case ('read_case')
         call case_from_file(request%statement, answer)
      case ('read_groups')
         call groups_of_file(request%statement, answer)
      case ('read_history')
         call test_from_file(request%statement, answer)
      case ('protocol')
         call make_protocol()
      case ('named_protocol')
         call find_protocol()
      case ('spectrum')
         call find_spectrum(request%array('acceleration'), request%array('dt'), request%array('period'), &
                            request%array('damping'))
      ! All other questions are about sections.
      case default
         call evaluate_section(request, answer)
      end select

   contains

      !> Whether the rule allows a spring, or the forces of a virgin one along a path of deformations.
      subroutine evaluate_spring()
         type(spring_record) :: spring
         real(c_double), pointer, contiguous :: load(:), path(:)

         load => request%array('axial_load')
         path => request%array('deformation')
         call spring_from_statements(request%statement, request%number, load(1), spring, answer%error)
         if (allocated(answer%error)) return
         allocate (answer%value(size(path)))
         call follow_path(spring, path, answer%value)
      end subroutine evaluate_spring

      !> Points of a cyclic protocol, the only loading of a case, in the unit of the amplitudes.
      subroutine make_protocol()
         type(case_record) :: case
         type(message_list) :: messages
         real(c_double), allocatable :: time(:)

         call case_from_statements(request%statement, request%number, case, answer%error)
         if (allocated(answer%error)) return
         call case%loading(1)%validate(.false., messages)
         call messages%raise(answer%error)
         if (allocated(answer%error)) return
         ! With a height of 1 drifts stay drifts.
         call protocol_values(case%loading(1), 1.0_c_double, time, answer%value, answer%error)
      end subroutine make_protocol

      !> Amplitudes and cycles of a protocol of the literature.
      subroutine find_protocol()
         real(c_double), pointer, contiguous :: limit(:)
         real(c_double), allocatable :: amplitude(:)
         integer, allocatable :: cycles(:)

         limit => request%array('reference_and_largest')
         call named_protocol(request%statement, limit(1), limit(2), amplitude, cycles, answer%error)
         if (.not. allocated(answer%error)) answer%value = [amplitude, real(cycles, c_double)]
      end subroutine find_protocol

      !> Peaks of relative displacement, relative velocity and absolute acceleration for each period.
      subroutine find_spectrum(acceleration, dt, period, damping)
         !> Acceleration of the ground [m/s2], its step [s], periods [s], damping ratio
         real(c_double), intent(in) :: acceleration(:), dt(:), period(:), damping(:)

         allocate (answer%rows(3, size(period)))
         call response_spectrum(acceleration, dt(1), period, damping(1), answer%rows)
      end subroutine find_spectrum

   end subroutine evaluate

   !> Answer with parts of a frame and notes on a structure that is allowed, a line each; with its modes; or
   !> with its matrices.
   subroutine evaluate_structure(request, answer)
      type(request_type), intent(in) :: request
      type(answer_type), intent(inout), target :: answer
      type(case_record) :: case
      class(structure_type), pointer :: structure
      type(frame_type), pointer :: frame
      type(message_list) :: notes

      if (associated(request%made)) then
         ! The structure of an answer that Python still holds
         structure => request%made%structure
      else
         call structure_from_statements(request%statement, request%number, answer%structure, answer%before, &
                                        case, answer%error, is_part=request%what == 'lay_out')
         if (allocated(answer%error)) return
         structure => answer%structure
      end if
      frame => null()
      select type (structure)
      type is (frame_type)
         frame => structure
      end select
      select case (request%what)
      case ('check_structure', 'lay_out')
         answer%text = ''
         if (associated(frame)) call list_parts(frame, case%parts%node%mass(1), answer)
         if (request%what == 'check_structure') call structure_notes(case, structure, notes)
         if (notes%count > 0) answer%text = answer%text//notes%text
      case ('modes')
         call answer_modes()
      case default
         call answer_matrices(request%wants('paper'))
      end select

   contains

      !> Answer with the modes of a structure: values are the stable step [s] and the circular frequencies
      !> [rad/s], a row for each mode is its shape.
      subroutine answer_modes()
         type(modes_type) :: modes
         integer, allocatable :: count
         integer :: i, j, floors

         ! Not allocated, it is an argument that is left out.
         if (size(request%array('count')) > 0) count = request%whole('count')
         call find_modes(structure, modes, answer%error, count)
         if (allocated(answer%error)) return
         answer%text = trim(modes%warning)
         answer%value = [modes%stable_step, modes%omega]
         if (.not. associated(frame)) then
            answer%rows = modes%shapes
            return
         end if
         ! Displacements of the nodes, held ones too: along x, upward, rotations; then the mass of each mode;
         ! of a building that along y, the rotary inertia, and U, V and Theta of the floors.
         floors = merge(frame%storeys, 0, frame%plan%is_given())
         allocate (answer%rows(3*frame%n + 1 + merge(2, 0, floors > 0) + 3*floors, size(modes%omega)), &
                   source=0.0_c_double)
         do i = 1, frame%n
            answer%rows(i, :) = [(frame%along_x(i, modes%shapes(:, j)), j=1, size(modes%omega))]
            do j = 2, 3
               if (frame%number(j, i) == 0) cycle
               answer%rows((j - 1)*frame%n + i, :) = modes%shapes(frame%number(j, i), :)
            end do
         end do
         answer%rows(3*frame%n + 1, :) = [(frame%work_of(horizontal, modes%shapes(:, i))**2, &
                                           i=1, size(modes%omega))]
         if (floors == 0) return
         do i = 1, size(modes%omega)
            associate (row => answer%rows(3*frame%n + 2:, i), shape => modes%shapes(:, i))
               row(1) = frame%work_of(sideways, shape)**2
               row(2) = frame%plan%turning_momentum(frame%inertias, shape)**2
               row(3:) = [(frame%plan%motion(j, shape), j=1, floors)]
            end associate
         end do
      end subroutine answer_modes

      !> Answer with the matrices of a structure, mass, stiffness, geometric stiffness and damping one after
      !> the other, and the names of its unknowns.
      subroutine answer_matrices(paper)
         !> Whether the mass is that of the paper
         logical, intent(in) :: paper
         type(matrices_type) :: matrices
         integer :: i

         call assemble_matrices(structure, paper, matrices, answer%error)
         if (allocated(answer%error)) return
         answer%text = trim(matrices%unknown(1))
         do i = 2, size(matrices%unknown)
            answer%text = answer%text//new_line('a')//trim(matrices%unknown(i))
         end do
         ! Columns here are rows in Python.
         answer%rows = reshape([transpose(matrices%mass), transpose(matrices%stiffness), &
                                transpose(matrices%geometric), transpose(matrices%damping)], &
                               [size(matrices%unknown), 4*size(matrices%unknown)])
      end subroutine answer_matrices

   end subroutine evaluate_structure

   !> Answer with the parts of a frame. Text: names of nodes, of members and of the springs of members ('C-1-1
   !> flexure bilinear'), a line each with tabs between. Values: for the nodes x, y, floor and mass; for the
   !> members numbers of their nodes, compression under dead load [N]; for the springs positions in the clear
   !> length and initial stiffness; the mass along x [kg].
   subroutine list_parts(frame, node_mass, answer)
      type(frame_type), intent(in) :: frame
      !> Masses along x (nodes) [kg]
      real(c_double), intent(in) :: node_mass(:)
      type(answer_type), intent(inout) :: answer
      character(len=1), parameter :: tab = achar(9), line = new_line('a')
      character(len=12), parameter :: kinds(3) = ['shear       ', 'flexure     ', 'axial_spring']
      character(len=12) :: group
      type(text_buffer) :: text
      real(c_double), allocatable :: position(:), stiffness(:)
      real(c_double) :: of_joint(2)
      integer :: i

      do i = 1, frame%n
         call text%append(trim(frame%node_name(i))//tab)
      end do
      call text%append(line)
      do i = 1, frame%members
         call text%append(trim(frame%member_name(i))//tab)
      end do
      call text%append(line)
      allocate (position(0), stiffness(0))
      do i = 1, frame%member_springs
         if (frame%location(i)%kind /= layer) then
            group = kinds(frame%location(i)%kind)
            ! Springs of panels come last.
            if (i > frame%member_springs - count(frame%beam_rotation > 0)) group = 'panel'
            call add_spring(group, trim(frame%rules%name(frame%rules%of(i))), frame%initial_stiffness(i))
         else if (frame%heads(i)) then
            ! About the centre of stiffness of its layers [N m/rad], and axially [N/m]
            associate (e => frame%element(frame%location(i)%member))
               associate (of => e%joint(frame%location(i)%joint))
                  of_joint = e%initial(of%spring)*[of%radius**2, 1.0_c_double]
               end associate
            end associate
            call add_spring(kinds(flexure), 'layered', of_joint(1))
            call add_spring(kinds(axial), 'layered', of_joint(2))
         end if
      end do
      answer%text = text%text(:text%length)//line
      answer%value = [frame%x, frame%y, real(frame%storey, c_double), node_mass, &
                      (real(frame%element(i)%node, c_double), i=1, frame%members), &
                      frame%element(:frame%members)%compression, position, stiffness, &
                      -sum(frame%pattern(horizontal)%force)]

   contains

      !> Add one spring to text and values.
      subroutine add_spring(kind, rule, k)
         !> Word for the kind, name of the rule, initial stiffness [N/m, N m]
         character(len=*), intent(in) :: kind, rule
         real(c_double), intent(in) :: k

         call text%append(trim(frame%location(i)%owner)//' '//trim(kind)//' '//trim(rule)//tab)
         position = [position, frame%position_ratio(i)]
         stiffness = [stiffness, k]
      end subroutine add_spring
   end subroutine list_parts

end module rbs_bindings_evaluate
