!> What one kept row holds, in this order; the same for the csv and for Python.
module rbs_results_row
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   implicit none
   private

   public :: row_size, row_labels
   public :: row_time, row_displacement, row_force, row_input, row_kinetic, row_spring, row_damping
   public :: row_axial, row_residual, row_joints

   !> Time [s] (static: number of the row), displacement of the top [m], lateral force at the top [N].
   integer, parameter :: row_time = 1, row_displacement = 2, row_force = 3
   !> Energies [J]: work of lateral force and ground motion; motion; springs; damping; potential of the
   !> axial forces; what is left of the balance.
   integer, parameter :: row_input = 4, row_kinetic = 5, row_spring = 6, row_damping = 7
   integer, parameter :: row_axial = 8, row_residual = 9
   !> From here n slips [m], n relative rotations [rad], n shear forces [N], n moments [N m].
   integer, parameter :: row_joints = 10

   character(len=14), parameter :: fixed(9) = [ &
      'time_s        ', 'displacement_m', 'force_N       ', 'input_J       ', 'kinetic_J     ', &
      'spring_J      ', 'damping_J     ', 'axial_J       ', 'residual_J    ']

contains

   !> Number of values in a row of a column of n bodies.
   pure integer function row_size(n)
      integer, intent(in) :: n

      row_size = row_joints - 1 + 4*n
   end function row_size

   !> Names of the values with their units.
   function row_labels(n, dynamic) result(labels)
      integer, intent(in) :: n
      !> Whether the first value is a time
      logical, intent(in) :: dynamic
      character(len=24), allocatable :: labels(:)
      integer :: i

      allocate (labels(row_size(n)))
      labels(:row_joints - 1) = fixed
      if (.not. dynamic) labels(row_time) = 'step'
      do i = 1, n
         labels(row_joints - 1 + i) = 'slip_'//to_text(i)//'_m'
         labels(row_joints - 1 + n + i) = 'rotation_'//to_text(i)//'_rad'
         labels(row_joints - 1 + 2*n + i) = 'shear_'//to_text(i)//'_N'
         labels(row_joints - 1 + 3*n + i) = 'moment_'//to_text(i)//'_Nm'
      end do
   end function row_labels

end module rbs_results_row
