! The one file that f2py reads: free subroutines, arrays of C kinds, a status and a message each.
!
! status: 0 well, 1 the analysis failed (rows up to there are good), 2 bad input.
! f2py would take real(wp) for a C float without a word, so only c_double and c_int appear here.

subroutine rbs_version_text(text)
   use rbs_version, only: version
   implicit none
   character(len=32), intent(out) :: text
   !f2py threadsafe

   text = version
end subroutine rbs_version_text

subroutine rbs_check_spring(rule, numbers, inner, status, message)
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type, message_list
   use rbs_flat_door, only: spring_from_numbers, tell
   use rbs_spec_spring, only: spring_spec
   implicit none
   character(len=*), intent(in) :: rule, inner
   real(c_double), intent(in) :: numbers(9)
   integer(c_int), intent(out) :: status
   character(len=8192), intent(out) :: message
   !f2py threadsafe
   type(spring_spec) :: spring
   type(message_list) :: messages
   type(error_type), allocatable :: error

   spring = spring_from_numbers(rule, numbers, inner)
   call spring%validate(rule//' spring', messages)
   call messages%raise(error)
   call tell(error, status, message)
end subroutine rbs_check_spring

subroutine rbs_spring_response(rule, numbers, inner, m, deformation, force)
   use iso_c_binding, only: c_double, c_int
   use rbs_flat_door, only: spring_from_numbers
   use rbs_hysteresis_springs, only: follow_path
   implicit none
   character(len=*), intent(in) :: rule, inner
   real(c_double), intent(in) :: numbers(9)
   integer(c_int), intent(in) :: m
   real(c_double), intent(in) :: deformation(m)
   real(c_double), intent(out) :: force(m)
   !f2py threadsafe

   call follow_path(spring_from_numbers(rule, numbers, inner), deformation, force)
end subroutine rbs_spring_response

subroutine rbs_check_column(n, kinematics, numbers, nl, lengths, nm, masses, &
                            ns, shear, codes_shear, nf, flexure, codes_flexure, status, message)
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type
   use rbs_column_column, only: column_type
   use rbs_flat_door, only: column_from_numbers, tell
   implicit none
   integer(c_int), intent(in) :: n, nl, nm, ns, nf
   character(len=*), intent(in) :: kinematics
   real(c_double), intent(in) :: numbers(7), lengths(nl), masses(nm), shear(9, ns), flexure(9, nf)
   integer(c_int), intent(in) :: codes_shear(2, ns), codes_flexure(2, nf)
   integer(c_int), intent(out) :: status
   character(len=8192), intent(out) :: message
   !f2py threadsafe
   type(column_type) :: column
   type(error_type), allocatable :: error

   call column_from_numbers(column, n, kinematics, numbers, lengths, masses, shear, flexure, &
                            codes_shear, codes_flexure, error)
   call tell(error, status, message)
end subroutine rbs_check_column

subroutine rbs_modes(n, kinematics, numbers, nl, lengths, nm, masses, &
                     ns, shear, codes_shear, nf, flexure, codes_flexure, &
                     omega, shapes, stable_step, status, message)
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type
   use rbs_column_column, only: column_type
   use rbs_flat_door, only: column_from_numbers, tell
   use rbs_solve_modal, only: modes_type, find_modes
   implicit none
   integer(c_int), intent(in) :: n, nl, nm, ns, nf
   character(len=*), intent(in) :: kinematics
   real(c_double), intent(in) :: numbers(7), lengths(nl), masses(nm), shear(9, ns), flexure(9, nf)
   integer(c_int), intent(in) :: codes_shear(2, ns), codes_flexure(2, nf)
   real(c_double), intent(out) :: omega(2*n), shapes(2*n, 2*n), stable_step
   integer(c_int), intent(out) :: status
   character(len=8192), intent(out) :: message
   !f2py threadsafe
   type(column_type) :: column
   type(modes_type) :: modes
   type(error_type), allocatable :: error

   omega = 0.0_c_double
   shapes = 0.0_c_double
   stable_step = 0.0_c_double
   call column_from_numbers(column, n, kinematics, numbers, lengths, masses, shear, flexure, &
                            codes_shear, codes_flexure, error)
   if (.not. allocated(error)) call find_modes(column, modes, error)
   call tell(error, status, message)
   if (status /= 0) return
   omega = modes%omega
   shapes = modes%shapes
   stable_step = modes%stable_step
end subroutine rbs_modes

subroutine rbs_mass_matrix(n, kinematics, numbers, nl, lengths, nm, masses, &
                           ns, shear, codes_shear, nf, flexure, codes_flexure, &
                           paper, mass, status, message)
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type
   use rbs_column_column, only: column_type
   use rbs_column_mass, only: paper_mass, symmetric_mass
   use rbs_flat_door, only: column_from_numbers, tell
   implicit none
   integer(c_int), intent(in) :: n, nl, nm, ns, nf, paper
   character(len=*), intent(in) :: kinematics
   real(c_double), intent(in) :: numbers(7), lengths(nl), masses(nm), shear(9, ns), flexure(9, nf)
   integer(c_int), intent(in) :: codes_shear(2, ns), codes_flexure(2, nf)
   real(c_double), intent(out) :: mass(2*n, 2*n)
   integer(c_int), intent(out) :: status
   character(len=8192), intent(out) :: message
   !f2py threadsafe
   type(column_type) :: column
   type(error_type), allocatable :: error

   mass = 0.0_c_double
   call column_from_numbers(column, n, kinematics, numbers, lengths, masses, shear, flexure, &
                            codes_shear, codes_flexure, error)
   call tell(error, status, message)
   if (status /= 0) return
   if (paper /= 0) then
      call paper_mass(column, mass)
   else
      call symmetric_mass(column, mass)
   end if
end subroutine rbs_mass_matrix

subroutine rbs_cyclic(n, kinematics, numbers, nl, lengths, nm, masses, &
                      ns, shear, codes_shear, nf, flexure, codes_flexure, &
                      by_force, m, values, every, width, height, rows, kept, figures, status, message)
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type
   use rbs_column_column, only: column_type
   use rbs_flat_door, only: column_from_numbers, into_rows_static, tell
   use rbs_results_summary, only: summary_type
   implicit none
   integer(c_int), intent(in) :: n, nl, nm, ns, nf, by_force, m, every, width, height
   character(len=*), intent(in) :: kinematics
   real(c_double), intent(in) :: numbers(7), lengths(nl), masses(nm), shear(9, ns), flexure(9, nf)
   integer(c_int), intent(in) :: codes_shear(2, ns), codes_flexure(2, nf)
   real(c_double), intent(in) :: values(m)
   real(c_double), intent(inout) :: rows(width, height)
   real(c_double), intent(out) :: figures(13)
   integer(c_int), intent(out) :: kept, status
   character(len=8192), intent(out) :: message
   !f2py threadsafe
   type(column_type) :: column
   type(summary_type) :: summary
   type(error_type), allocatable :: error

   kept = 0
   call column_from_numbers(column, n, kinematics, numbers, lengths, masses, shear, flexure, &
                            codes_shear, codes_flexure, error)
   if (.not. allocated(error)) then
      call into_rows_static(column, by_force /= 0, values, every, rows, kept, summary, error)
   end if
   figures = summary%as_array()
   call tell(error, status, message)
end subroutine rbs_cyclic

subroutine rbs_plan(n, kinematics, numbers, nl, lengths, nm, masses, &
                    ns, shear, codes_shear, nf, flexure, codes_flexure, &
                    m, time, dt, every, rows, status, message)
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type
   use rbs_column_column, only: column_type
   use rbs_flat_door, only: column_from_numbers, tell
   use rbs_solve_run, only: plan_dynamic
   use rbs_solve_time_plan, only: time_plan
   implicit none
   integer(c_int), intent(in) :: n, nl, nm, ns, nf, m, every
   character(len=*), intent(in) :: kinematics
   real(c_double), intent(in) :: numbers(7), lengths(nl), masses(nm), shear(9, ns), flexure(9, nf)
   integer(c_int), intent(in) :: codes_shear(2, ns), codes_flexure(2, nf)
   real(c_double), intent(in) :: time(m), dt
   integer(c_int), intent(out) :: rows, status
   character(len=8192), intent(out) :: message
   !f2py threadsafe
   type(column_type) :: column
   type(time_plan) :: plan
   type(error_type), allocatable :: error
   real(c_double) :: limit

   call column_from_numbers(column, n, kinematics, numbers, lengths, masses, shear, flexure, &
                            codes_shear, codes_flexure, error)
   if (.not. allocated(error)) call plan_dynamic(column, time, dt, plan, limit, error)
   rows = plan%rows(every)
   call tell(error, status, message)
end subroutine rbs_plan

subroutine rbs_time_history(n, kinematics, numbers, nl, lengths, nm, masses, &
                            ns, shear, codes_shear, nf, flexure, codes_flexure, &
                            m, time, mf, force, mg, ground, dt, initial_deformation, initial_velocity, &
                            every, width, height, rows, kept, figures, status, message)
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type
   use rbs_column_column, only: column_type
   use rbs_flat_door, only: column_from_numbers, into_rows_dynamic, tell
   use rbs_results_summary, only: summary_type
   implicit none
   integer(c_int), intent(in) :: n, nl, nm, ns, nf, m, mf, mg, every, width, height
   character(len=*), intent(in) :: kinematics
   real(c_double), intent(in) :: numbers(7), lengths(nl), masses(nm), shear(9, ns), flexure(9, nf)
   integer(c_int), intent(in) :: codes_shear(2, ns), codes_flexure(2, nf)
   real(c_double), intent(in) :: time(m), force(mf), ground(mg), dt
   real(c_double), intent(in) :: initial_deformation(2*n), initial_velocity(2*n)
   real(c_double), intent(inout) :: rows(width, height)
   real(c_double), intent(out) :: figures(13)
   integer(c_int), intent(out) :: kept, status
   character(len=8192), intent(out) :: message
   !f2py threadsafe
   type(column_type) :: column
   type(summary_type) :: summary
   type(error_type), allocatable :: error

   kept = 0
   call column_from_numbers(column, n, kinematics, numbers, lengths, masses, shear, flexure, &
                            codes_shear, codes_flexure, error)
   if (.not. allocated(error)) then
      call into_rows_dynamic(column, time, force, ground, dt, initial_deformation, initial_velocity, &
                             every, rows, kept, summary, error)
   end if
   figures = summary%as_array()
   call tell(error, status, message)
end subroutine rbs_time_history

subroutine rbs_protocol(na, amplitudes, nc, cycles, repeats, points, m, values, status, message)
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type
   use rbs_flat_door, only: protocol_from_numbers, tell
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

subroutine rbs_read_history(path, most, rows, name, displacement, force, status, message)
   use iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type
   use rbs_flat_door, only: tell
   use rbs_io_loading_file, only: read_test
   implicit none
   character(len=*), intent(in) :: path
   integer(c_int), intent(in) :: most
   real(c_double), intent(out) :: displacement(most), force(most)
   integer(c_int), intent(out) :: rows, status
   character(len=256), intent(out) :: name
   character(len=8192), intent(out) :: message
   !f2py threadsafe
   type(error_type), allocatable :: error
   character(len=:), allocatable :: test

   call read_test(path, test, rows, displacement, force, error)
   name = test
   call tell(error, status, message)
end subroutine rbs_read_history

subroutine rbs_kept_rows(points, every, rows)
   use iso_c_binding, only: c_int
   use rbs_solve_static, only: kept_rows
   implicit none
   integer(c_int), intent(in) :: points, every
   integer(c_int), intent(out) :: rows
   !f2py threadsafe

   rows = kept_rows(points, every)
end subroutine rbs_kept_rows
