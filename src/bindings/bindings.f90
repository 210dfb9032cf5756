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
   ! A column that is allowed may have notes in the message, a line each.
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type, message_list
   use rbs_bindings_runs, only: tell
   use rbs_bindings_statements, only: column_from_statements
   use rbs_case_case_record, only: case_record
   use rbs_column_column, only: column_type
   use rbs_output_notes, only: column_notes
   implicit none
   character(len=*), intent(in) :: statement
   integer(c_int), intent(in) :: nn
   real(c_double), intent(in) :: number(nn)
   integer(c_int), intent(out) :: status
   character(len=8192), intent(out) :: message
   !f2py threadsafe
   type(case_record) :: case
   type(column_type) :: column
   type(message_list) :: notes
   type(error_type), allocatable :: error

   call column_from_statements(statement, number, column, case, error)
   call tell(error, status, message)
   if (status /= 0) return
   call column_notes(case%column, notes)
   if (notes%count > 0) message = notes%text
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

subroutine rbs_modes(statement, nn, number, unknowns, count, omega, shapes, stable_step, status, message)
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type
   use rbs_bindings_runs, only: tell
   use rbs_bindings_statements, only: column_from_statements
   use rbs_case_case_record, only: case_record
   use rbs_column_column, only: column_type
   use rbs_solve_modal_modes, only: modes_type, find_modes
   implicit none
   character(len=*), intent(in) :: statement
   integer(c_int), intent(in) :: nn, unknowns, count
   real(c_double), intent(in) :: number(nn)
   real(c_double), intent(out) :: omega(count), shapes(unknowns, count), stable_step
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

subroutine rbs_quantities(opens, with_base, with_openings, with_motion, rows, figures)
   ! Names of the columns of a row, `slip*` for one value per joint, and of the summary values of a run.
   use iso_c_binding, only: c_int
   use rbs_output_row, only: row_quantities
   use rbs_output_summary, only: figure_names
   implicit none
   integer(c_int), intent(in) :: opens, with_base, with_openings, with_motion
   character(len=512), intent(out) :: rows, figures
   !f2py threadsafe

   rows = row_quantities(opens /= 0, with_base /= 0, with_openings /= 0, with_motion /= 0)
   figures = figure_names()
end subroutine rbs_quantities

subroutine rbs_cyclic(statement, nn, number, by_force, m, values, ma, axial_load, mb, before, corners, &
                      width, height, rows, kept, ms, after, ended, nf, figures, method, status, message)
   ! `axial_load` is empty where the axial load is constant, `before` where the column is virgin. The state at
   ! the end has `ended` numbers; it is not filled if they are more than `after` has room for. With `corners`
   ! there are rows between the targets too; `kept` may be more than there was room for.
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type
   use rbs_bindings_runs, only: into_rows_static, tell_run
   use rbs_bindings_statements, only: column_from_statements
   use rbs_case_case_record, only: case_record
   use rbs_column_column, only: column_type
   use rbs_output_summary, only: summary_type
   implicit none
   character(len=*), intent(in) :: statement
   integer(c_int), intent(in) :: nn, by_force, m, ma, mb, corners, width, height, ms, nf
   real(c_double), intent(in) :: number(nn), values(m), axial_load(ma), before(mb)
   real(c_double), intent(inout) :: rows(width, height), after(ms)
   real(c_double), intent(out) :: figures(nf)
   integer(c_int), intent(out) :: kept, ended, status
   character(len=220), intent(out) :: method
   character(len=8192), intent(out) :: message
   !f2py threadsafe
   type(case_record) :: case
   type(column_type) :: column
   type(summary_type) :: summary
   type(error_type), allocatable :: error

   kept = 0
   ended = 0
   call column_from_statements(statement, number, column, case, error)
   if (.not. allocated(error)) then
      call into_rows_static(column, case, by_force /= 0, values, axial_load, before, &
                            corners /= 0, rows, kept, after, ended, summary, error)
   end if
   call tell_run(column, summary, error, figures, method, status, message)
end subroutine rbs_cyclic

subroutine rbs_time_history(statement, nn, number, m, time, drives, nd, load, mi, initial, opening_given, &
                            mb, before, nw, watches, told, width, height, rows, kept, ms, after, ended, &
                            reached, nf, figures, used, status, message)
   ! `reached`: time and displacement of the top where each of the `watches` is reached first.
   ! status 3: the array is too small for the rows; `kept` rows are needed, and nothing was solved.
   ! status 4: the run is long, as the message says, and nothing was solved; with `told` it starts.
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type
   use rbs_bindings_runs, only: choose_method, into_rows_dynamic, little_room, long_run, make_loads, tell_run
   use rbs_bindings_statements, only: column_from_statements
   use rbs_case_case_record, only: case_record
   use rbs_column_column, only: column_type
   use rbs_output_summary, only: summary_type
   use rbs_loading_loads, only: loads_type
   implicit none
   character(len=*), intent(in) :: statement, drives
   integer(c_int), intent(in) :: nn, m, nd, mi, opening_given, mb, nw, told, width, height, ms, nf
   real(c_double), intent(in) :: number(nn), time(m), load(m, nd), initial(mi), before(mb)
   real(c_double), intent(in) :: watches(6, nw)
   real(c_double), intent(inout) :: rows(width, height), after(ms)
   real(c_double), intent(out) :: reached(2, nw), figures(nf)
   integer(c_int), intent(out) :: kept, ended, status
   character(len=220), intent(out) :: used
   character(len=8192), intent(out) :: message
   !f2py threadsafe
   type(case_record) :: case
   type(column_type) :: column
   type(loads_type) :: loads
   type(summary_type) :: summary
   type(error_type), allocatable :: error
   character(len=:), allocatable :: note
   logical :: enough

   kept = 0
   ended = 0
   reached = 0
   enough = .true.
   call column_from_statements(statement, number, column, case, error)
   if (.not. allocated(error)) call make_loads(loads, drives, time, load, error)
   if (.not. allocated(error)) call choose_method(case, loads, error)
   if (.not. allocated(error)) then
      call into_rows_dynamic(column, case, time, loads, initial, opening_given /= 0, before, watches, &
                             rows, kept, after, ended, reached, summary, enough, told /= 0, note, error)
   end if
   call tell_run(column, summary, error, figures, used, status, message)
   if (.not. enough) status = little_room
   if (.not. allocated(note)) return
   status = long_run
   message = note
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

subroutine rbs_protocol(na, amplitudes, nn, negative, nc, cycles, repeats, points, m, values, status, message)
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type
   use rbs_bindings_runs, only: protocol_from_numbers, tell
   implicit none
   integer(c_int), intent(in) :: na, nn, nc, repeats, points, m
   real(c_double), intent(in) :: amplitudes(na), negative(nn)
   integer(c_int), intent(in) :: cycles(nc)
   real(c_double), intent(out) :: values(m)
   integer(c_int), intent(out) :: status
   character(len=8192), intent(out) :: message
   !f2py threadsafe
   type(error_type), allocatable :: error

   call protocol_from_numbers(amplitudes, negative, cycles, repeats, points, values, error)
   call tell(error, status, message)
end subroutine rbs_protocol

subroutine rbs_named_protocol(name, reference, largest, steps, amplitudes, cycles, status, message)
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type
   use rbs_bindings_runs, only: tell
   use rbs_loading_named_protocols, only: named_protocol
   implicit none
   character(len=*), intent(in) :: name
   real(c_double), intent(in) :: reference, largest
   integer(c_int), intent(out) :: steps, cycles(2000), status
   real(c_double), intent(out) :: amplitudes(2000)
   character(len=8192), intent(out) :: message
   !f2py threadsafe
   type(error_type), allocatable :: error
   real(c_double), allocatable :: found(:)
   integer(c_int), allocatable :: counts(:)

   amplitudes = 0.0
   cycles = 0
   steps = 0
   call named_protocol(name, reference, largest, found, counts, error)
   if (.not. allocated(error)) then
      steps = size(found)
      amplitudes(:steps) = found
      cycles(:steps) = counts
   end if
   call tell(error, status, message)
end subroutine rbs_named_protocol

subroutine rbs_spectrum(m, acceleration, dt, np, period, damping, peak)
   ! Peaks of relative displacement, relative velocity and absolute acceleration, a column for each period.
   use iso_c_binding, only: c_double, c_int
   use rbs_loading_spectrum, only: response_spectrum
   implicit none
   integer(c_int), intent(in) :: m, np
   real(c_double), intent(in) :: acceleration(m), dt, period(np), damping
   real(c_double), intent(out) :: peak(3, np)
   !f2py threadsafe

   call response_spectrum(acceleration, dt, period, damping, peak)
end subroutine rbs_spectrum

subroutine rbs_read_history(path, length_unit, force_unit, separator, decimal, skip, columns, most, rows, &
                            name, displacement, force, status, message)
   ! With skip < 0 the file says what its layout and its columns are.
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type
   use rbs_bindings_runs, only: tell
   use rbs_io_history, only: layout_type
   use rbs_io_loading_file, only: read_test
   implicit none
   character(len=*), intent(in) :: path, length_unit, force_unit
   integer(c_int), intent(in) :: separator, decimal, skip, columns(2)
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
   if (skip < 0) then
      call read_test(path, units, test, rows, displacement, force, error)
   else
      call read_test(path, units, test, rows, displacement, force, error, columns, &
                     layout_type(skip, achar(separator), achar(decimal)))
   end if
   name = test
   call tell(error, status, message)
end subroutine rbs_read_history

subroutine rbs_kept_rows(points, every, rows)
   use iso_c_binding, only: c_int
   use rbs_solve_static_path, only: kept_rows
   implicit none
   integer(c_int), intent(in) :: points, every
   integer(c_int), intent(out) :: rows
   !f2py threadsafe

   rows = kept_rows(points, every)
end subroutine rbs_kept_rows

subroutine rbs_section_quantities(section, spring, point, shear, profile, layer)
   ! Names of the values that come back: figures of a section and of its spring, points of a moment-curvature
   ! and of a shear diagram, layers at the last point of that, states of one layer.
   use rbs_section_flexural_spring, only: spring_figures
   use rbs_section_section_figures, only: layer_values, point_values, profile_values, section_figures, &
                                          shear_values
   use rbs_base_text, only: list_of
   implicit none
   character(len=512), intent(out) :: section, spring, point, shear, profile, layer
   !f2py threadsafe

   section = list_of(section_figures)
   spring = list_of(spring_figures)
   point = list_of(point_values)
   shear = list_of(shear_values)
   profile = list_of(profile_values)
   layer = list_of(layer_values)
end subroutine rbs_section_quantities

subroutine rbs_check_section(statement, nn, number, nf, figures, status, message)
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type
   use rbs_bindings_runs, only: tell
   use rbs_bindings_section_statements, only: section_from_statements
   use rbs_section_cross_section, only: section_type
   use rbs_section_section_figures, only: figures_of_section
   use rbs_case_group_reader, only: group_reader
   implicit none
   character(len=*), intent(in) :: statement
   integer(c_int), intent(in) :: nn, nf
   real(c_double), intent(in) :: number(nn)
   real(c_double), intent(out) :: figures(nf)
   integer(c_int), intent(out) :: status
   character(len=8192), intent(out) :: message
   !f2py threadsafe
   type(group_reader) :: setter
   type(section_type) :: section
   type(error_type), allocatable :: error

   figures = 0.0_c_double
   call section_from_statements(statement, number, '', setter, section, error)
   call tell(error, status, message)
   if (status == 0) figures = figures_of_section(section)
end subroutine rbs_check_section

subroutine rbs_axial_capacity(statement, nn, number, load, moment, status, message)
   ! Least and largest axial load without curvature, and the moments that go with them; tension law and
   ! confinement are those of the group diagram.
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type
   use rbs_bindings_runs, only: tell
   use rbs_bindings_section_statements, only: section_from_statements, tension_place
   use rbs_section_balance, only: axial_capacity
   use rbs_section_cross_section, only: section_type
   use rbs_section_resultants, only: resultants_type, section_laws
   use rbs_case_group_reader, only: group_reader
   implicit none
   character(len=*), intent(in) :: statement
   integer(c_int), intent(in) :: nn
   real(c_double), intent(in) :: number(nn)
   real(c_double), intent(out) :: load(2), moment(2)
   integer(c_int), intent(out) :: status
   character(len=8192), intent(out) :: message
   !f2py threadsafe
   type(group_reader) :: setter
   type(section_type) :: section
   type(resultants_type) :: least, most
   type(error_type), allocatable :: error
   real(c_double) :: strain(2)

   load = 0.0_c_double
   moment = 0.0_c_double
   call section_from_statements(statement, number, '', setter, section, error)
   call tell(error, status, message)
   if (status /= 0) return
   associate (given => setter%diagram)
      call axial_capacity(section, section_laws(section, tension_place(given%tension), given%confined), &
                          least, most, strain)
   end associate
   load = [least%n, most%n]
   moment = [least%m, most%m]
end subroutine rbs_axial_capacity

subroutine rbs_moment_curvature(statement, nn, number, m, curvature, moment, strain, status, message)
   ! Curvatures of one sign and increasing magnitude; the settings are those of the group diagram.
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type
   use rbs_bindings_runs, only: tell
   use rbs_bindings_section_statements, only: section_from_statements, tension_place
   use rbs_section_balance, only: follow
   use rbs_section_cross_section, only: section_type
   use rbs_section_resultants, only: section_laws
   use rbs_case_group_reader, only: group_reader
   implicit none
   character(len=*), intent(in) :: statement
   integer(c_int), intent(in) :: nn, m
   real(c_double), intent(in) :: number(nn), curvature(m)
   real(c_double), intent(out) :: moment(m), strain(m)
   integer(c_int), intent(out) :: status
   character(len=8192), intent(out) :: message
   !f2py threadsafe
   type(group_reader) :: setter
   type(section_type) :: section
   type(error_type), allocatable :: error

   moment = 0.0_c_double
   strain = 0.0_c_double
   call section_from_statements(statement, number, 'diagram', setter, section, error)
   if (.not. allocated(error)) then
      associate (given => setter%diagram)
         call follow(section, section_laws(section, tension_place(given%tension), given%confined), &
                     given%axial_load, curvature, moment, strain, error)
      end associate
   end if
   call tell(error, status, message)
end subroutine rbs_moment_curvature

subroutine rbs_section_events(statement, nn, number, points, lost, status, message)
   ! A column of `points` each for cracking, yield, peak, ultimate and the end.
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type
   use rbs_bindings_runs, only: tell
   use rbs_bindings_section_statements, only: check_settings, section_from_statements, tension_place
   use rbs_section_cross_section, only: section_type
   use rbs_section_events, only: events_type, find_events
   use rbs_section_resultants, only: section_laws
   use rbs_section_section_figures, only: values_of_point
   use rbs_case_group_reader, only: group_reader
   implicit none
   character(len=*), intent(in) :: statement
   integer(c_int), intent(in) :: nn
   real(c_double), intent(in) :: number(nn)
   real(c_double), intent(out) :: points(4, 5)
   integer(c_int), intent(out) :: lost, status
   character(len=8192), intent(out) :: message
   !f2py threadsafe
   type(group_reader) :: setter
   type(section_type) :: section
   type(events_type) :: events
   type(error_type), allocatable :: error

   points = 0.0_c_double
   lost = 0
   call section_from_statements(statement, number, 'diagram', setter, section, error)
   associate (given => setter%diagram)
      if (.not. allocated(error)) call check_settings(section, given%confined, given%rule(), error)
      if (.not. allocated(error)) then
         call find_events(section, section_laws(section, tension_place(given%tension), given%confined), &
                          given%axial_load, given%rule(), events, error)
      end if
   end associate
   call tell(error, status, message)
   if (status /= 0) return
   points(:, 1) = values_of_point(events%cracking)
   points(:, 2) = values_of_point(events%yield)
   points(:, 3) = values_of_point(events%peak)
   points(:, 4) = values_of_point(events%ultimate)
   points(:, 5) = values_of_point(events%last)
   lost = merge(1, 0, events%lost)
end subroutine rbs_section_events

subroutine rbs_section_flexure(statement, nn, number, nf, points, figures, status, message)
   ! The settings are those of the group springs; a column of `points` each for cracking, yield, peak,
   ! ultimate.
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type
   use rbs_bindings_runs, only: tell
   use rbs_bindings_section_statements, only: check_settings, section_from_statements
   use rbs_section_cross_section, only: section_type
   use rbs_section_flexural_spring, only: fit_flexural_spring, flexural_spring_type, hinge_type
   use rbs_section_section_figures, only: values_of_point
   use rbs_case_group_reader, only: group_reader
   implicit none
   character(len=*), intent(in) :: statement
   integer(c_int), intent(in) :: nn, nf
   real(c_double), intent(in) :: number(nn)
   real(c_double), intent(out) :: points(4, 4), figures(nf)
   integer(c_int), intent(out) :: status
   character(len=8192), intent(out) :: message
   !f2py threadsafe
   type(group_reader) :: setter
   type(section_type) :: section
   type(hinge_type) :: hinge
   type(flexural_spring_type) :: spring
   type(error_type), allocatable :: error

   points = 0.0_c_double
   figures = 0.0_c_double
   call section_from_statements(statement, number, 'springs', setter, section, error)
   hinge = setter%springs%hinge()
   if (.not. allocated(error)) call check_settings(section, hinge%confined, hinge%rule, error)
   if (.not. allocated(error)) call fit_flexural_spring(section, hinge, spring, error)
   call tell(error, status, message)
   if (status /= 0) return
   points(:, 1) = values_of_point(spring%cracking)
   points(:, 2) = values_of_point(spring%yield)
   points(:, 3) = values_of_point(spring%peak)
   points(:, 4) = values_of_point(spring%ultimate)
   figures = spring%as_array()
end subroutine rbs_section_flexure

subroutine rbs_section_shear(statement, nn, number, layers, m, curvature, points, profile, kept, events, &
                             ends, status, message)
   ! The settings are those of the group shear; `ends` are the knee and the last point. `events`: knee found,
   ! a layer sheared, axial load lost. `layers` is the room of the profile.
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type
   use rbs_bindings_runs, only: tell
   use rbs_bindings_section_statements, only: section_from_statements, shear_into_arrays
   use rbs_section_cross_section, only: section_type
   use rbs_case_group_reader, only: group_reader
   implicit none
   character(len=*), intent(in) :: statement
   integer(c_int), intent(in) :: nn, layers, m
   real(c_double), intent(in) :: number(nn), curvature(m)
   real(c_double), intent(out) :: points(4, m), profile(5, layers), ends(4, 2)
   integer(c_int), intent(out) :: kept, events(3), status
   character(len=8192), intent(out) :: message
   !f2py threadsafe
   type(group_reader) :: setter
   type(section_type) :: section
   type(error_type), allocatable :: error

   points = 0.0_c_double
   profile = 0.0_c_double
   ends = 0.0_c_double
   kept = 0
   events = 0
   call section_from_statements(statement, number, 'shear', setter, section, error)
   if (.not. allocated(error)) then
      call shear_into_arrays(section, setter, curvature, points, profile, kept, events, ends, error)
   end if
   call tell(error, status, message)
end subroutine rbs_section_shear

subroutine rbs_layer_response(statement, nn, number, m, path, states, carried, status, message)
   ! Groups concrete, steel (of the stirrups) and layer; path: eps_x and tau.
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type
   use rbs_bindings_runs, only: tell
   use rbs_bindings_section_statements, only: layer_into_arrays, record_from_statements
   use rbs_case_group_reader, only: group_reader
   implicit none
   character(len=*), intent(in) :: statement
   integer(c_int), intent(in) :: nn, m
   real(c_double), intent(in) :: number(nn), path(2, m)
   real(c_double), intent(out) :: states(5, m)
   integer(c_int), intent(out) :: carried(m), status
   character(len=8192), intent(out) :: message
   !f2py threadsafe
   type(group_reader) :: setter
   type(error_type), allocatable :: error

   states = 0.0_c_double
   carried = 0
   call record_from_statements(statement, number, 'layer', setter, error)
   call tell(error, status, message)
   if (status == 0) call layer_into_arrays(setter, path, states, carried)
end subroutine rbs_layer_response

subroutine rbs_section_strips(statement, nn, number, round_core, m, core, cover, status, message)
   ! A column of `core` and `cover`: y of the centroid and area.
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type
   use rbs_bindings_runs, only: tell
   use rbs_bindings_section_statements, only: record_from_statements
   use rbs_section_section_build, only: outline_core
   use rbs_case_group_reader, only: group_reader
   use rbs_section_shape, only: shape_type
   use rbs_section_strips, only: cut_strips, strip_centroids, strips_type
   implicit none
   character(len=*), intent(in) :: statement
   integer(c_int), intent(in) :: nn, round_core, m
   real(c_double), intent(in) :: number(nn)
   real(c_double), intent(out) :: core(2, m), cover(2, m)
   integer(c_int), intent(out) :: status
   character(len=8192), intent(out) :: message
   !f2py threadsafe
   type(group_reader) :: setter
   class(shape_type), allocatable :: inside
   type(strips_type) :: strips
   type(error_type), allocatable :: error

   core = 0.0_c_double
   cover = 0.0_c_double
   call record_from_statements(statement, number, '', setter, error)
   call tell(error, status, message)
   if (status /= 0) return
   call outline_core(setter%case%drawing%section, round_core /= 0, inside)
   call cut_strips(setter%case%drawing%section%shape, inside, int(m), strips)
   call strip_centroids(setter%case%drawing%section%shape, inside, strips, core(1, :), cover(1, :))
   core(2, :) = strips%core_area
   cover(2, :) = strips%area - strips%core_area
end subroutine rbs_section_strips

subroutine rbs_concrete_response(statement, nn, number, m, strain, stress, status, message)
   ! Groups concrete and diagram (its tension law); without confinement, compression positive.
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type, message_list
   use rbs_bindings_runs, only: tell
   use rbs_bindings_section_statements, only: record_from_statements, tension_place
   use rbs_section_concrete_law, only: concrete_stress, concrete_type
   use rbs_case_group_reader, only: group_reader
   implicit none
   character(len=*), intent(in) :: statement
   integer(c_int), intent(in) :: nn, m
   real(c_double), intent(in) :: number(nn), strain(m)
   real(c_double), intent(out) :: stress(m)
   integer(c_int), intent(out) :: status
   character(len=8192), intent(out) :: message
   !f2py threadsafe
   type(group_reader) :: setter
   type(concrete_type) :: law
   type(message_list) :: messages
   type(error_type), allocatable :: error

   stress = 0.0_c_double
   call record_from_statements(statement, number, 'diagram', setter, error)
   if (.not. allocated(error)) then
      call setter%case%drawing%section%concrete%validate(messages)
      call messages%raise(error)
   end if
   call tell(error, status, message)
   if (status /= 0) return
   law = setter%case%drawing%section%concrete%law()
   law%tension = tension_place(setter%diagram%tension)
   stress = concrete_stress(law, strain)
end subroutine rbs_concrete_response

subroutine rbs_steel_response(statement, nn, number, m, strain, stress, status, message)
   ! Group steel.
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type, message_list
   use rbs_bindings_runs, only: tell
   use rbs_bindings_section_statements, only: record_from_statements
   use rbs_case_group_reader, only: group_reader
   use rbs_section_steel_law, only: steel_stress
   implicit none
   character(len=*), intent(in) :: statement
   integer(c_int), intent(in) :: nn, m
   real(c_double), intent(in) :: number(nn), strain(m)
   real(c_double), intent(out) :: stress(m)
   integer(c_int), intent(out) :: status
   character(len=8192), intent(out) :: message
   !f2py threadsafe
   type(group_reader) :: setter
   type(message_list) :: messages
   type(error_type), allocatable :: error

   stress = 0.0_c_double
   call record_from_statements(statement, number, '', setter, error)
   if (.not. allocated(error)) then
      call setter%case%drawing%section%steels(1)%validate(messages)
      call messages%raise(error)
   end if
   call tell(error, status, message)
   if (status == 0) stress = steel_stress(setter%case%drawing%section%steels(1)%law(), strain)
end subroutine rbs_steel_response

subroutine rbs_measures(names)
   ! Names of the measures of a run of an ensemble, separated by blanks.
   use rbs_solve_ensemble_outcome, only: measure_names
   implicit none
   character(len=512), intent(out) :: names
   !f2py threadsafe

   names = measure_names()
end subroutine rbs_measures

subroutine rbs_plan_ensemble(statements, nn, numbers, nc, counts, nw, watches, nb, before, m, time, &
                             acceleration, nm, points, most, seconds, in_lanes, text, length)
   ! `length` is that of the whole text, which is cut at `most`.
   use iso_c_binding, only: c_double, c_int
   use rbs_bindings_ensembles, only: plan_ensemble
   use rbs_case_text_buffer, only: text_buffer
   implicit none
   character(len=*), intent(in) :: statements
   integer(c_int), intent(in) :: nn, nc, nw, nb, m, nm, most, counts(3, nc), points(nm)
   real(c_double), intent(in) :: numbers(nn), watches(6, nw), before(nb), time(m), acceleration(m)
   real(c_double), intent(out) :: seconds(nm, nc)
   integer(c_int), intent(out) :: in_lanes(nm, nc)
   character(len=most), intent(out) :: text
   integer(c_int), intent(out) :: length
   !f2py threadsafe
   type(text_buffer) :: buffer

   call plan_ensemble(statements, numbers, counts, watches, before, time, acceleration, points, seconds, &
                      in_lanes, buffer)
   text = ''
   length = buffer%length
   if (length > 0) text = buffer%text(:min(length, most))
end subroutine rbs_plan_ensemble

subroutine rbs_run_ensemble(statements, nn, numbers, nc, counts, nw, watches, nb, before, m, time, &
                            acceleration, nm, points, nr, columns, motions, scales, level, control, nv, &
                            most, fates, values, text, length)
   ! `length` is that of the whole text, which is cut at `most`. Another thread reads and sets `control`.
   use iso_c_binding, only: c_double, c_int
   use rbs_bindings_ensembles, only: run_ensemble
   use rbs_case_text_buffer, only: text_buffer
   implicit none
   character(len=*), intent(in) :: statements
   integer(c_int), intent(in) :: nn, nc, nw, nb, m, nm, nr, nv, most, counts(3, nc), points(nm)
   integer(c_int), intent(in) :: columns(nr), motions(nr), level
   integer(c_int), intent(inout) :: control(2)
   real(c_double), intent(in) :: numbers(nn), watches(6, nw), before(nb), time(m), acceleration(m), scales(nr)
   integer(c_int), intent(out) :: fates(nr)
   real(c_double), intent(out) :: values(nv, nr)
   character(len=most), intent(out) :: text
   integer(c_int), intent(out) :: length
   !f2py threadsafe
   type(text_buffer) :: buffer

   call run_ensemble(statements, numbers, counts, watches, before, time, acceleration, points, columns, &
                     motions, scales, level, control, fates, values, buffer)
   text = ''
   length = buffer%length
   if (length > 0) text = buffer%text(:min(length, most))
end subroutine rbs_run_ensemble
