!> A case file as statements and plain arrays, for Python.
module rbs_bindings_case_arrays
   use, intrinsic :: iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type
   use rbs_case_case_record, only: case_record
   use rbs_case_writer, only: statement_sink, write_case
   use rbs_column_column, only: column_type
   use rbs_io_case_file, only: case_history, load_case
   use rbs_loading_loading_record, only: drive_names
   use rbs_loading_signal, only: signal_type
   use rbs_solve_make_column, only: make_column
   implicit none
   private

   public :: case_arrays, open_case

   integer, parameter :: drives = size(drive_names)

   type :: case_arrays
      !> Title, column, analysis and output; loadings are arrays
      type(statement_sink) :: statements
      !> Times (m) [s], and values of the drives in the order of `drive_names` (m, drives)
      real(c_double), allocatable :: time(:), values(:, :)
      !> For each drive, 1 if it is present, else 0
      integer(c_int) :: acting(drives) = 0
   end type case_arrays

contains

   !> Read a case, with all the checks of the executable.
   subroutine open_case(path, arrays, error)
      character(len=*), intent(in) :: path
      type(case_arrays), intent(out) :: arrays
      type(error_type), allocatable, intent(out) :: error
      type(case_record) :: case
      type(case_history) :: history
      type(column_type) :: column
      integer :: place

      call load_case(path, case, history, error, unloaded=.true.)
      if (.not. allocated(error)) call make_column(case%column, column, error)
      if (allocated(error)) return
      arrays%time = history%time
      allocate (arrays%values(size(history%time), drives), source=0.0_c_double)
      if (case%loadings == 0) then
         ! What will shake it is not known yet: the method is left to that.
         if (.not. case%analysis%named) case%analysis%method = 'auto'
      else if (case%analysis%dynamic()) then
         associate (loads => history%loads)
            arrays%acting(2:) = merge(1_c_int, 0_c_int, [loads%force%acts(), loads%ground%acts(), &
                                                         loads%vertical%acts(), loads%axial%acts()])
            call sample(loads%force, arrays%time, arrays%values(:, 2))
            call sample(loads%ground, arrays%time, arrays%values(:, 3))
            call sample(loads%vertical, arrays%time, arrays%values(:, 4))
            call sample(loads%axial, arrays%time, arrays%values(:, 5))
         end associate
      else
         place = merge(2, 1, any(case%loading(:case%loadings)%drive == 'force'))
         arrays%acting(place) = 1
         arrays%values(:, place) = history%target
         if (size(history%axial_load) > 0) then
            arrays%acting(5) = 1
            arrays%values(:, 5) = history%axial_load
         end if
      end if
      case%loadings = 0
      call write_case(case, arrays%statements)
   end subroutine open_case

   !> Values of a signal at common times; at its own points they are exactly its values.
   subroutine sample(signal, time, values)
      type(signal_type), intent(inout) :: signal
      real(c_double), intent(in) :: time(:)
      real(c_double), intent(inout) :: values(:)
      integer :: i, at

      if (.not. signal%acts()) return
      at = 1
      do i = 1, size(time)
         do while (at < size(signal%time) .and. signal%time(at) < time(i))
            at = at + 1
         end do
         if (abs(signal%time(at) - time(i)) > 0.0_c_double) then
            values(i) = signal%at_time(time(i))
         else
            values(i) = signal%value(at)
         end if
      end do
   end subroutine sample

end module rbs_bindings_case_arrays
