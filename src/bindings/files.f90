!> Files for Python: a case as statements and arrays, a measured test, the text of a case file.
module rbs_bindings_files
   use, intrinsic :: iso_c_binding, only: c_double
   use rbs_bindings_exchange, only: request_type, answer_type
   use rbs_bindings_statements, only: case_from_statements
   use rbs_case_case_record, only: case_record
   use rbs_case_writer, only: case_text, write_case
   use rbs_io_case_file, only: case_history, load_case
   use rbs_io_loading_file, only: read_test
   use rbs_loading_loading_record, only: drive_names
   use rbs_loading_loads, only: signals
   use rbs_loading_signal, only: signal_type
   use rbs_solve_end_state, only: end_state
   use rbs_solve_begin_make_structure, only: make_structure
   use rbs_structure_structure, only: structure_type
   implicit none
   private

   public :: case_from_file, case_to_text, groups_of_file, test_from_file

   !> Number of quantities that a loading may prescribe
   integer, parameter :: drives = size(drive_names)

contains

   !> Read a case, with all the checks of the executable. Text and values: title, column, analysis and output
   !> as a statement. Rows: the times with 1 before them, then for each of `drive_names` 1 if it acts and its
   !> values, else zeros.
   subroutine case_from_file(path, answer)
      !> Path of the case
      character(len=*), intent(in) :: path
      type(answer_type), intent(inout) :: answer
      type(case_record) :: case
      type(case_history) :: history
      class(structure_type), allocatable :: structure
      type(end_state) :: before
      type(case_text) :: statements
      !> Drive of a static path: 1 displacement, 2 force
      integer :: column, m, i

      call load_case(path, case, history, answer%error, unloaded=.true.)
      if (allocated(answer%error)) return
      ! What is drawn is made, and checked, by Python.
      if (.not. case%is_drawn()) call make_structure(case, structure, before, answer%error)
      if (allocated(answer%error)) return
      m = size(history%time)
      allocate (answer%rows(1 + m, 0:drives), source=0.0_c_double)
      answer%rows(2:, 0) = history%time
      if (case%loadings == 0) then
         ! The motion is not known yet: the choice of the method waits for it.
         if (.not. case%analysis%named) case%analysis%method = 'auto'
      else if (case%analysis%dynamic()) then
         ! Signals are the drives behind the displacement.
         do i = 1, signals
            call sample(history%loads%signal(i), history%time, answer%rows(:, 1 + i))
         end do
      else
         ! A static method that is not named is not in the statement.
         if (.not. case%analysis%named) case%analysis%method = ''
         column = merge(2, 1, any(case%loading(:case%loadings)%drive == 'force'))
         answer%rows(:, column) = [1.0_c_double, history%target]
         ! The fifth drive is the axial load.
         if (size(history%axial_load) > 0) answer%rows(:, 5) = [1.0_c_double, history%axial_load]
      end if
      ! Loadings are in the rows, not in the statement.
      case%loadings = 0
      statements%is_statement = .true.
      call write_case(case, statements)
      answer%text = statements%buffer%text(:statements%buffer%length)
      answer%value = statements%numbers%value(:statements%numbers%count)
   end subroutine case_from_file

   !> Read the groups of a case in SI with its loadings as they are given, not as histories.
   subroutine groups_of_file(path, answer)
      !> Path of the case
      character(len=*), intent(in) :: path
      type(answer_type), intent(inout) :: answer
      type(case_record) :: case
      type(case_history) :: history
      type(case_text) :: statements

      call load_case(path, case, history, answer%error, unloaded=.true.)
      if (allocated(answer%error)) return
      statements%is_statement = .true.
      call write_case(case, statements)
      answer%text = statements%buffer%text(:statements%buffer%length)
      answer%value = statements%numbers%value(:statements%numbers%count)
   end subroutine groups_of_file

   !> Set whether a signal acts, and its values at common times; at its own points they are exactly its
   !> values.
   subroutine sample(signal, time, row)
      type(signal_type), intent(inout) :: signal
      !> Times [s]
      real(c_double), intent(in) :: time(:)
      !> 1 if it acts, then its values
      real(c_double), intent(inout) :: row(:)
      integer :: i, at

      if (.not. signal%acts()) return
      row(1) = 1.0_c_double
      at = 1
      do i = 1, size(time)
         do while (at < size(signal%time) .and. signal%time(at) < time(i))
            at = at + 1
         end do
         if (abs(signal%time(at) - time(i)) > 0.0_c_double) then
            row(1 + i) = signal%at_time(time(i))
         else
            row(1 + i) = signal%value(at)
         end if
      end do
   end subroutine sample

   !> Write a case as the text of a file.
   subroutine case_to_text(request, answer)
      type(request_type), intent(in) :: request
      type(answer_type), intent(inout) :: answer
      type(case_record) :: case
      type(case_text) :: text

      call case_from_statements(request%statement, request%number, case, answer%error)
      if (allocated(answer%error)) return
      call write_case(case, text)
      answer%text = text%buffer%text(:text%buffer%length)
   end subroutine case_to_text

   !> Read displacements [m] and forces [N] of a measured test, and its name. The text of the request has
   !> three lines: units of both, empty for those of the file, and the path.
   subroutine test_from_file(text, answer)
      character(len=*), intent(in) :: text
      type(answer_type), intent(inout) :: answer
      character(len=16) :: units(2)
      integer :: first, second

      first = index(text, new_line('a'))
      second = first + index(text(first + 1:), new_line('a'))
      units = [character(len=16) :: text(:first - 1), text(first + 1:second - 1)]
      call read_test(text(second + 1:), units, answer%text, answer%rows, answer%error)
   end subroutine test_from_file

end module rbs_bindings_files
