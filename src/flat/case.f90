!> A case file as plain arrays.
module rbs_flat_case
   use, intrinsic :: iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_column_column, only: column_type
   use rbs_flat_pack, only: numbers_from_column
   use rbs_io_case, only: case_history, load_case
   use rbs_loading_signal, only: signal_type
   use rbs_solve_make_column, only: make_column
   use rbs_spec_case, only: case_spec
   implicit none
   private

   public :: case_arrays, open_case

   !> Drives: displacement, force, ground, vertical, axial.
   integer, parameter :: drives = 5

   type :: case_arrays
      type(case_spec) :: case
      !> The column as in `rbs_flat_pack`
      integer(c_int), allocatable :: codes(:)
      real(c_double), allocatable :: numbers(:)
      !> Times (m) [s], and values of the drives (m, drives)
      real(c_double), allocatable :: time(:), values(:, :)
      !> Which drives there are, 0 or 1
      integer(c_int) :: acting(drives) = 0
   end type case_arrays

contains

   !> Read a case, with all the checks of the executable.
   subroutine open_case(path, arrays, error)
      character(len=*), intent(in) :: path
      type(case_arrays), intent(out) :: arrays
      type(error_type), allocatable, intent(out) :: error
      type(case_history) :: history
      type(column_type) :: column

      call load_case(path, arrays%case, history, error)
      if (.not. allocated(error)) call make_column(arrays%case%column, column, error)
      if (allocated(error)) return
      call numbers_from_column(arrays%case%column, arrays%codes, arrays%numbers)
      arrays%time = history%time
      allocate (arrays%values(size(history%time), drives), source=0.0_c_double)
      if (arrays%case%analysis%dynamic()) then
         associate (loads => history%loads)
            arrays%acting(2:) = merge(1_c_int, 0_c_int, [loads%force%acts(), loads%ground%acts(), &
                                                         loads%vertical%acts(), loads%axial%acts()])
            call sample(loads%force, arrays%time, arrays%values(:, 2))
            call sample(loads%ground, arrays%time, arrays%values(:, 3))
            call sample(loads%vertical, arrays%time, arrays%values(:, 4))
            call sample(loads%axial, arrays%time, arrays%values(:, 5))
         end associate
      else
         associate (place => merge(2, 1, arrays%case%loading(1)%drive == 'force'))
            arrays%acting(place) = 1
            arrays%values(:, place) = history%target
         end associate
      end if
   end subroutine open_case

   !> Values of a signal at common times; its own points come back as they are.
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
         if (abs(signal%time(at) - time(i)) > 0.0_wp) then
            values(i) = signal%at_time(time(i))
         else
            values(i) = signal%value(at)
         end if
      end do
   end subroutine sample

end module rbs_flat_case
