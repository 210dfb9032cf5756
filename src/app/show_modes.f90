!> The natural modes of the structure of a case, and its matrices, as csv.
module rbs_app_show_modes
   use rbs_app_progress, only: say
   use rbs_base_constants, only: pi
   use rbs_base_error, only: error_type, message_list
   use rbs_base_kinds, only: wp
   use rbs_case_case_record, only: case_record
   use rbs_io_namelist, only: read_case
   use rbs_solve_begin_make_structure, only: make_structure
   use rbs_solve_end_state, only: end_state
   use rbs_solve_modal_matrices, only: matrices_type, assemble_matrices
   use rbs_solve_modal_modes, only: modes_type, find_modes
   use rbs_structure_structure, only: structure_type
   implicit none
   private

   public :: show_modes

contains

   !> rbsdem modes: print frequencies, stable step, and the matrices if they are asked for.
   subroutine show_modes(path, count, with_matrices, error)
      !> Path of the case
      character(len=*), intent(in) :: path
      !> How many modes; 0: all
      integer, intent(in) :: count
      logical, intent(in) :: with_matrices
      type(error_type), allocatable, intent(out) :: error
      type(case_record) :: case
      class(structure_type), allocatable :: structure
      type(end_state) :: before
      type(modes_type) :: modes
      type(matrices_type) :: matrices
      type(message_list) :: messages
      logical :: understood
      character(len=96) :: line
      real(wp) :: period
      integer, allocatable :: wanted
      integer :: i

      call read_case(path, case, messages, understood)
      call messages%raise(error)
      if (allocated(error)) return
      call make_structure(case, structure, before, error)
      if (allocated(error)) return
      ! Not allocated, it is an argument that is left out.
      if (count > 0) wanted = count
      call find_modes(structure, modes, error, wanted)
      if (.not. allocated(error) .and. with_matrices) then
         call assemble_matrices(structure, .false., matrices, error)
      end if
      if (allocated(error)) return
      call say('mode,frequency_Hz,period_s,omega_rad/s', error)
      do i = 1, size(modes%omega)
         ! A column with negligible stiffness has frequency zero and no period.
         period = 0.0_wp
         if (modes%omega(i) > tiny(1.0_wp)*1.0e3_wp) period = 2.0_wp*pi/modes%omega(i)
         write (line, '(i0, 3(a, es22.16e2))') i, ',', modes%omega(i)/(2.0_wp*pi), ',', period, ',', &
            modes%omega(i)
         call say(trim(line), error)
      end do
      if (modes%warning /= '') call say('# note: '//trim(modes%warning), error)
      ! Frames have none, as explicit methods are not for them.
      if (modes%stable_step > 0.0_wp) then
         write (line, '(a, es23.16e2)') '# stable step of rk4 [s]:', modes%stable_step
         call say(trim(line), error)
      end if
      if (.not. with_matrices) return
      call print_matrix('mass', matrices%unknown, matrices%mass, error)
      call print_matrix('stiffness', matrices%unknown, matrices%stiffness, error)
      call print_matrix('geometric', matrices%unknown, matrices%geometric, error)
      call print_matrix('damping', matrices%unknown, matrices%damping, error)
   end subroutine show_modes

   !> Print a matrix as csv, in N, m, kg, s and rad.
   subroutine print_matrix(name, unknown, a, error)
      !> Name of the matrix, and names of its unknowns, which stand at columns and rows
      character(len=*), intent(in) :: name, unknown(:)
      real(wp), intent(in) :: a(:, :)
      type(error_type), allocatable, intent(inout) :: error
      character(len=:), allocatable :: line
      character(len=24) :: number
      integer :: i, j

      line = name
      do j = 1, size(unknown)
         line = line//','//trim(unknown(j))
      end do
      call say(line, error)
      do i = 1, size(unknown)
         line = trim(unknown(i))
         do j = 1, size(unknown)
            write (number, '(es23.16e3)') a(i, j)
            line = line//','//trim(adjustl(number))
         end do
         call say(line, error)
      end do
   end subroutine print_matrix

end module rbs_app_show_modes
