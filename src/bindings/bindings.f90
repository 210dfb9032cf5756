! The only file that f2py reads: subroutines outside modules with arrays of C kinds; each returns a status and
! a message.
!
! status: 0 success, 1 the analysis failed (the rows before are valid), 2 bad input.
! f2py would treat real(wp) as a C float without a warning, so only c_double and c_int appear here.

subroutine rbs_version_text(text)
   use rbs_version, only: version
   implicit none
   character(len=32), intent(out) :: text
   !f2py threadsafe

   text = version
end subroutine rbs_version_text

subroutine rbs_methods_text(text)
   use rbs_case_methods, only: method_rows
   implicit none
   character(len=2048), intent(out) :: text
   !f2py threadsafe
   character(len=:), allocatable :: rows

   call method_rows(rows)
   text = rows
end subroutine rbs_methods_text

subroutine rbs_keys(most, text, length)
   ! The list of all keys as JSON; only its length if the text is too short for it.
   use iso_c_binding, only: c_int
   use rbs_case_key_list, only: keys_as_json
   use rbs_case_text_buffer, only: text_buffer
   implicit none
   integer(c_int), intent(in) :: most
   character(len=most), intent(out) :: text
   integer(c_int), intent(out) :: length
   !f2py threadsafe
   type(text_buffer) :: buffer

   call keys_as_json(buffer)
   length = buffer%length
   text = ''
   if (length <= most) text = buffer%text(:length)
end subroutine rbs_keys

subroutine rbs_check_spring(statement, nn, number, axial_load, status, message)
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type
   use rbs_bindings_runs, only: tell
   use rbs_bindings_statements, only: spring_from_statements
   use rbs_hysteresis_spring_record, only: spring_record
   implicit none
   character(len=*), intent(in) :: statement
   integer(c_int), intent(in) :: nn
   real(c_double), intent(in) :: number(nn), axial_load
   integer(c_int), intent(out) :: status
   character(len=8192), intent(out) :: message
   !f2py threadsafe
   type(spring_record) :: spring
   type(error_type), allocatable :: error

   call spring_from_statements(statement, number, axial_load, spring, error)
   call tell(error, status, message)
end subroutine rbs_check_spring

subroutine rbs_spring_response(statement, nn, number, axial_load, m, deformation, force, status, message)
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type
   use rbs_bindings_runs, only: tell
   use rbs_bindings_statements, only: spring_from_statements
   use rbs_hysteresis_spring_record, only: spring_record
   use rbs_hysteresis_springs, only: follow_path
   implicit none
   character(len=*), intent(in) :: statement
   integer(c_int), intent(in) :: nn, m
   real(c_double), intent(in) :: number(nn), axial_load
   real(c_double), intent(in) :: deformation(m)
   real(c_double), intent(out) :: force(m)
   integer(c_int), intent(out) :: status
   character(len=8192), intent(out) :: message
   !f2py threadsafe
   type(spring_record) :: spring
   type(error_type), allocatable :: error

   force = 0.0_c_double
   call spring_from_statements(statement, number, axial_load, spring, error)
   call tell(error, status, message)
   if (status == 0) call follow_path(spring, deformation, force)
end subroutine rbs_spring_response

subroutine rbs_check_column(statement, nn, number, status, message)
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type
   use rbs_bindings_runs, only: tell
   use rbs_bindings_statements, only: column_from_statements
   use rbs_case_case_record, only: case_record
   use rbs_column_column, only: column_type
   implicit none
   character(len=*), intent(in) :: statement
   integer(c_int), intent(in) :: nn
   real(c_double), intent(in) :: number(nn)
   integer(c_int), intent(out) :: status
   character(len=8192), intent(out) :: message
   !f2py threadsafe
   type(case_record) :: case
   type(column_type) :: column
   type(error_type), allocatable :: error

   call column_from_statements(statement, number, column, case, error)
   call tell(error, status, message)
end subroutine rbs_check_column

subroutine rbs_to_namelist(statement, nn, number, most, text, length, status, message)
   ! The case as the text of a file; only its length if the text is too short for it.
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type
   use rbs_bindings_runs, only: tell
   use rbs_bindings_statements, only: case_from_statements
   use rbs_case_case_record, only: case_record
   use rbs_case_writer, only: namelist_sink, write_case
   implicit none
   character(len=*), intent(in) :: statement
   integer(c_int), intent(in) :: nn, most
   real(c_double), intent(in) :: number(nn)
   character(len=most), intent(out) :: text
   integer(c_int), intent(out) :: length, status
   character(len=8192), intent(out) :: message
   !f2py threadsafe
   type(case_record) :: case
   type(namelist_sink) :: sink
   type(error_type), allocatable :: error

   text = ''
   length = 0
   call case_from_statements(statement, number, case, error)
   call tell(error, status, message)
   if (status /= 0) return
   call write_case(case, sink)
   length = sink%buffer%length
   if (length <= most) text = sink%buffer%text(:length)
end subroutine rbs_to_namelist

subroutine rbs_modes(statement, nn, number, unknowns, omega, shapes, stable_step, status, message)
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type
   use rbs_bindings_runs, only: tell
   use rbs_bindings_statements, only: column_from_statements
   use rbs_case_case_record, only: case_record
   use rbs_column_column, only: column_type
   use rbs_solve_modal_modes, only: modes_type, find_modes
   implicit none
   character(len=*), intent(in) :: statement
   integer(c_int), intent(in) :: nn, unknowns
   real(c_double), intent(in) :: number(nn)
   real(c_double), intent(out) :: omega(unknowns), shapes(unknowns, unknowns), stable_step
   integer(c_int), intent(out) :: status
   character(len=8192), intent(out) :: message
   !f2py threadsafe
   type(case_record) :: case
   type(column_type) :: column
   type(modes_type) :: modes
   type(error_type), allocatable :: error

   omega = 0.0_c_double
   shapes = 0.0_c_double
   stable_step = 0.0_c_double
   call column_from_statements(statement, number, column, case, error)
   if (.not. allocated(error)) call find_modes(column, modes, error)
   call tell(error, status, message)
   if (status /= 0) return
   omega = modes%omega
   shapes = modes%shapes
   stable_step = modes%stable_step
   message = modes%warning
end subroutine rbs_modes

subroutine rbs_mass_matrix(statement, nn, number, unknowns, paper, mass, status, message)
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type
   use rbs_bindings_runs, only: tell
   use rbs_bindings_statements, only: column_from_statements
   use rbs_case_case_record, only: case_record
   use rbs_column_column, only: column_type
   use rbs_column_mass, only: paper_mass, symmetric_mass
   implicit none
   character(len=*), intent(in) :: statement
   integer(c_int), intent(in) :: nn, unknowns, paper
   real(c_double), intent(in) :: number(nn)
   real(c_double), intent(out) :: mass(unknowns, unknowns)
   integer(c_int), intent(out) :: status
   character(len=8192), intent(out) :: message
   !f2py threadsafe
   type(case_record) :: case
   type(column_type) :: column
   type(error_type), allocatable :: error

   mass = 0.0_c_double
   call column_from_statements(statement, number, column, case, error)
   call tell(error, status, message)
   if (status /= 0) return
   if (paper /= 0) then
      call paper_mass(column, mass)
   else
      call symmetric_mass(column, mass)
   end if
end subroutine rbs_mass_matrix

subroutine rbs_quantities(opens, rows, figures)
   ! Names of the columns of a row, `slip*` for one value per joint, and of the summary values of a run.
   use iso_c_binding, only: c_int
   use rbs_output_row, only: row_quantities
   use rbs_output_summary, only: figure_names
   implicit none
   integer(c_int), intent(in) :: opens
   character(len=512), intent(out) :: rows, figures
   !f2py threadsafe

   rows = row_quantities(opens /= 0)
   figures = figure_names()
end subroutine rbs_quantities

subroutine rbs_cyclic(statement, nn, number, by_force, m, values, width, height, rows, kept, nf, figures, &
                      method, status, message)
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type
   use rbs_bindings_runs, only: into_rows_static, tell_run
   use rbs_bindings_statements, only: column_from_statements
   use rbs_case_case_record, only: case_record
   use rbs_column_column, only: column_type
   use rbs_output_summary, only: summary_type
   implicit none
   character(len=*), intent(in) :: statement
   integer(c_int), intent(in) :: nn, by_force, m, width, height, nf
   real(c_double), intent(in) :: number(nn), values(m)
   real(c_double), intent(inout) :: rows(width, height)
   real(c_double), intent(out) :: figures(nf)
   integer(c_int), intent(out) :: kept, status
   character(len=220), intent(out) :: method
   character(len=8192), intent(out) :: message
   !f2py threadsafe
   type(case_record) :: case
   type(column_type) :: column
   type(summary_type) :: summary
   type(error_type), allocatable :: error

   kept = 0
   call column_from_statements(statement, number, column, case, error)
   if (.not. allocated(error)) then
      call into_rows_static(column, case, by_force /= 0, values, rows, kept, summary, error)
   end if
   call tell_run(column, summary, error, figures, method, status, message)
end subroutine rbs_cyclic

subroutine rbs_time_history(statement, nn, number, m, time, drives, nd, load, mi, initial, opening_given, &
                            width, height, rows, kept, nf, figures, used, status, message)
   ! status 3: the array is too small for the rows; `kept` rows are needed, and nothing was solved.
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type
   use rbs_bindings_runs, only: choose_method, into_rows_dynamic, little_room, make_loads, tell_run
   use rbs_bindings_statements, only: column_from_statements
   use rbs_case_case_record, only: case_record
   use rbs_column_column, only: column_type
   use rbs_output_summary, only: summary_type
   use rbs_solve_time_loads, only: loads_type
   implicit none
   character(len=*), intent(in) :: statement, drives
   integer(c_int), intent(in) :: nn, m, nd, mi, opening_given, width, height, nf
   real(c_double), intent(in) :: number(nn), time(m), load(m, nd), initial(mi)
   real(c_double), intent(inout) :: rows(width, height)
   real(c_double), intent(out) :: figures(nf)
   integer(c_int), intent(out) :: kept, status
   character(len=220), intent(out) :: used
   character(len=8192), intent(out) :: message
   !f2py threadsafe
   type(case_record) :: case
   type(column_type) :: column
   type(loads_type) :: loads
   type(summary_type) :: summary
   type(error_type), allocatable :: error
   logical :: enough

   kept = 0
   enough = .true.
   call column_from_statements(statement, number, column, case, error)
   if (.not. allocated(error)) call make_loads(loads, drives, time, load, error)
   if (.not. allocated(error)) call choose_method(case, loads, error)
   if (.not. allocated(error)) then
      call into_rows_dynamic(column, case, time, loads, initial, opening_given /= 0, rows, kept, summary, &
                             enough, error)
   end if
   call tell_run(column, summary, error, figures, used, status, message)
   if (.not. enough) status = little_room
end subroutine rbs_time_history

subroutine rbs_read_case(path, nt, nn, m, statement, number, time, values, acting, sizes, status, message)
   ! `sizes` returns the sizes of statement, number and time; the arrays are filled if they are large enough.
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type
   use rbs_bindings_case_arrays, only: case_arrays, open_case
   use rbs_bindings_runs, only: tell
   implicit none
   character(len=*), intent(in) :: path
   integer(c_int), intent(in) :: nt, nn, m
   character(len=nt), intent(out) :: statement
   real(c_double), intent(out) :: number(nn), time(m), values(m, 5)
   integer(c_int), intent(out) :: acting(5), sizes(3), status
   character(len=8192), intent(out) :: message
   !f2py threadsafe
   type(case_arrays) :: arrays
   type(error_type), allocatable :: error

   statement = ''
   acting = 0
   sizes = 0
   call open_case(path, arrays, error)
   call tell(error, status, message)
   if (status /= 0) return
   associate (from => arrays%statements)
      sizes = [from%buffer%length, from%count, size(arrays%time)]
      if (any(sizes > [nt, nn, m])) return
      statement = from%buffer%text(:sizes(1))
      number(:sizes(2)) = from%number(:sizes(2))
   end associate
   time(:sizes(3)) = arrays%time
   values(:sizes(3), :) = arrays%values
   acting = arrays%acting
end subroutine rbs_read_case

subroutine rbs_protocol(na, amplitudes, nc, cycles, repeats, points, m, values, status, message)
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type
   use rbs_bindings_runs, only: protocol_from_numbers, tell
   implicit none
   integer(c_int), intent(in) :: na, nc, repeats, points, m
   real(c_double), intent(in) :: amplitudes(na)
   integer(c_int), intent(in) :: cycles(nc)
   real(c_double), intent(out) :: values(m)
   integer(c_int), intent(out) :: status
   character(len=8192), intent(out) :: message
   !f2py threadsafe
   type(error_type), allocatable :: error

   call protocol_from_numbers(amplitudes, cycles, repeats, points, values, error)
   call tell(error, status, message)
end subroutine rbs_protocol

subroutine rbs_read_history(path, length_unit, force_unit, most, rows, name, displacement, force, &
                            status, message)
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type
   use rbs_bindings_runs, only: tell
   use rbs_io_loading_file, only: read_test
   implicit none
   character(len=*), intent(in) :: path, length_unit, force_unit
   integer(c_int), intent(in) :: most
   real(c_double), intent(out) :: displacement(most), force(most)
   integer(c_int), intent(out) :: rows, status
   character(len=256), intent(out) :: name
   character(len=8192), intent(out) :: message
   !f2py threadsafe
   type(error_type), allocatable :: error
   character(len=:), allocatable :: test
   character(len=16) :: units(2)

   units(1) = length_unit
   units(2) = force_unit
   call read_test(path, units, test, rows, displacement, force, error)
   name = test
   call tell(error, status, message)
end subroutine rbs_read_history

subroutine rbs_kept_rows(points, every, rows)
   use iso_c_binding, only: c_int
   use rbs_solve_static_trace, only: kept_rows
   implicit none
   integer(c_int), intent(in) :: points, every
   integer(c_int), intent(out) :: rows
   !f2py threadsafe

   rows = kept_rows(points, every)
end subroutine rbs_kept_rows

subroutine rbs_check_section(nc, codes, nn, numbers, figures, status, message)
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type
   use rbs_bindings_runs, only: tell
   use rbs_bindings_section_arrays, only: section_from_numbers, figures_of_section
   use rbs_section_cross_section, only: section_type
   implicit none
   integer(c_int), intent(in) :: nc, nn, codes(nc)
   real(c_double), intent(in) :: numbers(nn)
   real(c_double), intent(out) :: figures(15)
   integer(c_int), intent(out) :: status
   character(len=8192), intent(out) :: message
   !f2py threadsafe
   type(section_type) :: section
   type(error_type), allocatable :: error

   figures = 0.0_c_double
   call section_from_numbers(section, codes, numbers, error)
   call tell(error, status, message)
   if (status == 0) call figures_of_section(section, figures)
end subroutine rbs_check_section

subroutine rbs_axial_capacity(nc, codes, nn, numbers, least, most, status, message)
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type
   use rbs_bindings_runs, only: tell
   use rbs_bindings_section_arrays, only: section_from_numbers
   use rbs_section_balance, only: axial_capacity
   use rbs_section_concrete_law, only: tension_bare
   use rbs_section_resultants, only: section_laws
   use rbs_section_cross_section, only: section_type
   implicit none
   integer(c_int), intent(in) :: nc, nn, codes(nc)
   real(c_double), intent(in) :: numbers(nn)
   real(c_double), intent(out) :: least, most
   integer(c_int), intent(out) :: status
   character(len=8192), intent(out) :: message
   !f2py threadsafe
   type(section_type) :: section
   type(error_type), allocatable :: error

   least = 0.0_c_double
   most = 0.0_c_double
   call section_from_numbers(section, codes, numbers, error)
   call tell(error, status, message)
   if (status == 0) call axial_capacity(section, section_laws(section, tension_bare, .false.), least, most)
end subroutine rbs_axial_capacity

subroutine rbs_moment_curvature(nc, codes, nn, numbers, axial_load, tension, confined, m, curvature, &
                                moment, strain, status, message)
   ! Curvatures of one sign and increasing magnitude.
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type
   use rbs_bindings_runs, only: tell
   use rbs_bindings_section_arrays, only: section_from_numbers
   use rbs_section_balance, only: follow
   use rbs_section_resultants, only: section_laws
   use rbs_section_cross_section, only: section_type
   implicit none
   integer(c_int), intent(in) :: nc, nn, tension, confined, m, codes(nc)
   real(c_double), intent(in) :: numbers(nn), axial_load, curvature(m)
   real(c_double), intent(out) :: moment(m), strain(m)
   integer(c_int), intent(out) :: status
   character(len=8192), intent(out) :: message
   !f2py threadsafe
   type(section_type) :: section
   type(error_type), allocatable :: error

   moment = 0.0_c_double
   strain = 0.0_c_double
   call section_from_numbers(section, codes, numbers, error)
   if (.not. allocated(error)) then
      call follow(section, section_laws(section, tension, confined /= 0), axial_load, curvature, &
                  moment, strain, error)
   end if
   call tell(error, status, message)
end subroutine rbs_moment_curvature

subroutine rbs_section_events(nc, codes, nn, numbers, axial_load, tension, confined, yield, ultimate, &
                              strains, points, lost, status, message)
   ! Columns of `points`: cracking, yield, peak, ultimate and the end; strains: eps_yield, eps_cover.
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type, message_list
   use rbs_bindings_runs, only: tell
   use rbs_bindings_section_arrays, only: section_from_numbers, point_numbers
   use rbs_section_events, only: check_rules, events_type, find_events, rule_type
   use rbs_section_resultants, only: section_laws
   use rbs_section_cross_section, only: section_type
   implicit none
   integer(c_int), intent(in) :: nc, nn, tension, confined, codes(nc)
   real(c_double), intent(in) :: numbers(nn), axial_load, strains(2)
   character(len=*), intent(in) :: yield, ultimate
   real(c_double), intent(out) :: points(4, 5)
   integer(c_int), intent(out) :: lost, status
   character(len=8192), intent(out) :: message
   !f2py threadsafe
   type(section_type) :: section
   type(events_type) :: events
   type(rule_type) :: rule
   type(message_list) :: messages
   type(error_type), allocatable :: error

   points = 0.0_c_double
   lost = 0
   rule%eps_yield = strains(1)
   rule%eps_cover = strains(2)
   call section_from_numbers(section, codes, numbers, error)
   if (.not. allocated(error)) then
      call check_rules(section, confined /= 0, yield, ultimate, rule, messages)
      call messages%raise(error)
   end if
   if (.not. allocated(error)) then
      call find_events(section, section_laws(section, tension, confined /= 0), axial_load, rule, events, &
                       error)
   end if
   call tell(error, status, message)
   if (status /= 0) return
   points(:, 1) = point_numbers(events%cracking)
   points(:, 2) = point_numbers(events%yield)
   points(:, 3) = point_numbers(events%peak)
   points(:, 4) = point_numbers(events%ultimate)
   points(:, 5) = point_numbers(events%last)
   lost = merge(1, 0, events%lost)
end subroutine rbs_section_events

subroutine rbs_section_flexure(nc, codes, nn, numbers, settings, stiffened, confined, yield, ultimate, &
                               points, figures, status, message)
   ! settings: length, axial load, hinge length, factor of the moments, B_0, D_m, eps_yield, eps_cover.
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type, message_list
   use rbs_bindings_runs, only: tell
   use rbs_bindings_section_arrays, only: section_from_numbers, point_numbers, spring_figures
   use rbs_section_events, only: check_rules, rule_type
   use rbs_section_flexural_spring, only: check_hinge, fit_flexural_spring, flexural_spring_type, hinge_type
   use rbs_section_cross_section, only: section_type
   implicit none
   integer(c_int), intent(in) :: nc, nn, stiffened, confined, codes(nc)
   real(c_double), intent(in) :: numbers(nn), settings(8)
   character(len=*), intent(in) :: yield, ultimate
   real(c_double), intent(out) :: points(4, 4), figures(10)
   integer(c_int), intent(out) :: status
   character(len=8192), intent(out) :: message
   !f2py threadsafe
   type(section_type) :: section
   type(hinge_type) :: hinge
   type(flexural_spring_type) :: spring
   type(message_list) :: messages
   type(error_type), allocatable :: error

   points = 0.0_c_double
   figures = 0.0_c_double
   hinge%length = settings(1)
   hinge%axial_load = settings(2)
   hinge%hinge_length = settings(3)
   hinge%moment_factor = settings(4)
   hinge%b0 = settings(5)
   hinge%d_m = settings(6)
   hinge%rule%eps_yield = settings(7)
   hinge%rule%eps_cover = settings(8)
   hinge%stiffened_yield = stiffened /= 0
   hinge%confined = confined /= 0
   call section_from_numbers(section, codes, numbers, error)
   if (.not. allocated(error)) then
      call check_rules(section, hinge%confined, yield, ultimate, hinge%rule, messages)
      call check_hinge(hinge, messages)
      call messages%raise(error)
   end if
   if (.not. allocated(error)) call fit_flexural_spring(section, hinge, spring, error)
   call tell(error, status, message)
   if (status /= 0) return
   points(:, 1) = point_numbers(spring%cracking)
   points(:, 2) = point_numbers(spring%yield)
   points(:, 3) = point_numbers(spring%peak)
   points(:, 4) = point_numbers(spring%ultimate)
   figures = spring_figures(spring)
end subroutine rbs_section_flexure

subroutine rbs_section_concrete(nc, codes, nn, numbers, tension, part, m, strain, stress, status, message)
   ! part: 0 without confinement, 1 core, 2 cover that spalls; compression positive.
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type
   use rbs_bindings_runs, only: tell
   use rbs_bindings_section_arrays, only: section_from_numbers
   use rbs_section_concrete_law, only: concrete_stress
   use rbs_section_resultants, only: laws_type, section_laws
   use rbs_section_cross_section, only: section_type
   implicit none
   integer(c_int), intent(in) :: nc, nn, tension, part, m, codes(nc)
   real(c_double), intent(in) :: numbers(nn), strain(m)
   real(c_double), intent(out) :: stress(m)
   integer(c_int), intent(out) :: status
   character(len=8192), intent(out) :: message
   !f2py threadsafe
   type(section_type) :: section
   type(laws_type) :: laws
   type(error_type), allocatable :: error

   stress = 0.0_c_double
   call section_from_numbers(section, codes, numbers, error)
   call tell(error, status, message)
   if (status /= 0) return
   laws = section_laws(section, tension, part /= 0)
   if (part == 1) then
      stress = concrete_stress(laws%core, strain)
   else
      stress = concrete_stress(laws%shell, strain)
   end if
end subroutine rbs_section_concrete

subroutine rbs_section_shear(nc, codes, nn, numbers, axial_load, span, tension, confined, coupled, layers, &
                             share, m, curvature, points, profile, kept, events, ends, status, message)
   ! Each column of `points` holds curvature, moment, shear force, shear strain; of `profile` y, eps_x, tau,
   ! gamma, eps_z of a layer at the last point. `ends`: the knee and the last point, like `points`.
   ! `events`: knee found, a layer failed in shear, axial load lost.
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type
   use rbs_bindings_runs, only: tell
   use rbs_bindings_section_arrays, only: section_from_numbers
   use rbs_bindings_shear_arrays, only: shear_into_arrays
   use rbs_section_cross_section, only: section_type
   implicit none
   integer(c_int), intent(in) :: nc, nn, tension, confined, coupled, layers, m, codes(nc)
   real(c_double), intent(in) :: numbers(nn), axial_load, span, share, curvature(m)
   real(c_double), intent(out) :: points(4, m), profile(5, layers), ends(4, 2)
   integer(c_int), intent(out) :: kept, events(3), status
   character(len=8192), intent(out) :: message
   !f2py threadsafe
   type(section_type) :: section
   type(error_type), allocatable :: error

   points = 0.0_c_double
   profile = 0.0_c_double
   ends = 0.0_c_double
   kept = 0
   events = 0
   call section_from_numbers(section, codes, numbers, error)
   if (.not. allocated(error)) then
      call shear_into_arrays(section, tension, confined /= 0, coupled /= 0, axial_load, span, layers, share, &
                             curvature, points, profile, kept, events, ends, error)
   end if
   call tell(error, status, message)
end subroutine rbs_section_shear

subroutine rbs_layer_response(concrete, tension, stirrup, m, path, states, carried)
   ! concrete: fc, ft, ec, eps0; stirrup: rho_z, fy, fu, es, eps_sh, eps_u. Each column of `path` holds eps_x
   ! and tau, of `states` eps_z, gamma, sigma_x, sigma_z, tau.
   use iso_c_binding, only: c_double, c_int
   use rbs_bindings_shear_arrays, only: layer_into_arrays
   implicit none
   integer(c_int), intent(in) :: tension, m
   real(c_double), intent(in) :: concrete(4), stirrup(6), path(2, m)
   real(c_double), intent(out) :: states(5, m)
   integer(c_int), intent(out) :: carried(m)
   !f2py threadsafe

   call layer_into_arrays(concrete, tension, stirrup, path, states, carried)
end subroutine rbs_layer_response

subroutine rbs_section_strips(shape, sizes, round_core, m, core, cover, figures, status, message)
   ! sizes: width, depth, and the reductions of both to the core between hoop centre lines. Each column of
   ! `core` and `cover` holds y of the centroid and area; figures: area, second moment, shear area.
   use iso_c_binding, only: c_double, c_int
   use rbs_base_check, only: check_name
   use rbs_base_error, only: error_type, message_list
   use rbs_bindings_runs, only: tell
   use rbs_section_shape, only: shape_type
   use rbs_section_shapes, only: new_core, new_shape, shape_names
   use rbs_section_strips, only: cut_strips, strip_centroids, strips_type
   implicit none
   character(len=*), intent(in) :: shape
   real(c_double), intent(in) :: sizes(4)
   integer(c_int), intent(in) :: round_core, m
   real(c_double), intent(out) :: core(2, m), cover(2, m), figures(3)
   integer(c_int), intent(out) :: status
   character(len=8192), intent(out) :: message
   !f2py threadsafe
   class(shape_type), allocatable :: outline, inside
   type(strips_type) :: strips
   type(message_list) :: messages
   type(error_type), allocatable :: error
   integer :: place
   logical :: ok

   core = 0.0_c_double
   cover = 0.0_c_double
   figures = 0.0_c_double
   call check_name(shape, shape_names, 'section: shape', messages, place)
   call new_shape(place, sizes(1), sizes(2), outline)
   call outline%check(messages, ok)
   call messages%raise(error)
   call tell(error, status, message)
   if (status /= 0) return
   call new_core(outline, round_core /= 0, sizes(3), sizes(4), inside)
   call cut_strips(outline, inside, int(m), strips)
   call strip_centroids(outline, inside, strips, core(1, :), cover(1, :))
   core(2, :) = strips%core_area
   cover(2, :) = strips%area - strips%core_area
   figures = [outline%area(), outline%second_moment(), outline%shear_area()]
end subroutine rbs_section_strips

subroutine rbs_concrete_response(numbers, tension, m, strain, stress, status, message)
   ! numbers: fc, ft, ec, eps0, eps_spall; without confinement, compression positive.
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type, message_list
   use rbs_bindings_runs, only: tell
   use rbs_section_concrete_law, only: check_concrete, concrete_stress, concrete_type, plain_concrete
   implicit none
   real(c_double), intent(in) :: numbers(5)
   integer(c_int), intent(in) :: tension, m
   real(c_double), intent(in) :: strain(m)
   real(c_double), intent(out) :: stress(m)
   integer(c_int), intent(out) :: status
   character(len=8192), intent(out) :: message
   !f2py threadsafe
   type(concrete_type) :: law
   type(message_list) :: messages
   type(error_type), allocatable :: error

   stress = 0.0_c_double
   call check_concrete(numbers(1), numbers(2), numbers(3), numbers(4), numbers(5), messages)
   call messages%raise(error)
   call tell(error, status, message)
   if (status /= 0) return
   law = plain_concrete(numbers(1), numbers(2), numbers(3), numbers(4))
   law%tension = tension
   stress = concrete_stress(law, strain)
end subroutine rbs_concrete_response

subroutine rbs_steel_response(numbers, m, strain, stress, status, message)
   ! numbers: fy, fu, es, eps_sh, eps_u.
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type, message_list
   use rbs_bindings_runs, only: tell
   use rbs_section_steel_law, only: check_steel, steel_stress, steel_type
   implicit none
   real(c_double), intent(in) :: numbers(5)
   integer(c_int), intent(in) :: m
   real(c_double), intent(in) :: strain(m)
   real(c_double), intent(out) :: stress(m)
   integer(c_int), intent(out) :: status
   character(len=8192), intent(out) :: message
   !f2py threadsafe
   type(message_list) :: messages
   type(error_type), allocatable :: error
   type(steel_type) :: law

   stress = 0.0_c_double
   law = steel_type(numbers(1), numbers(2), numbers(3), numbers(4), numbers(5))
   call check_steel(law, 'steel', messages)
   call messages%raise(error)
   call tell(error, status, message)
   if (status == 0) stress = steel_stress(law, strain)
end subroutine rbs_steel_response
