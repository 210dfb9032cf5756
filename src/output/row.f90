!> What one kept row holds, in this order; the same for the csv and for Python.
module rbs_output_row
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   implicit none
   private

   public :: row_size, row_labels
   public :: row_time, row_displacement, row_force, row_input, row_kinetic, row_spring, row_damping
   public :: row_axial, row_residual, row_top, row_joints

   !> Time [s] (static: number of the row), displacement of the top [m], lateral force at the top [N].
   integer, parameter :: row_time = 1, row_displacement = 2, row_force = 3
   !> Energies [J]: work of lateral force and ground motion; motion; springs; damping; potential of the
   !> axial forces; what is left of the balance.
   integer, parameter :: row_input = 4, row_kinetic = 5, row_spring = 6, row_damping = 7
   integer, parameter :: row_axial = 8, row_residual = 9
   !> Height of the top above the ground [m].
   integer, parameter :: row_top = 10
   !> From here n slips [m], n relative rotations [rad] and, where the joints open, n openings [m]; then in
   !> the same order n shear forces [N], n moments [N m] and n axial forces [N].
   integer, parameter :: row_joints = 11

   character(len=14), parameter :: fixed(10) = [ &
      'time_s        ', 'displacement_m', 'force_N       ', 'input_J       ', 'kinetic_J     ', &
      'spring_J      ', 'damping_J     ', 'axial_J       ', 'residual_J    ', 'top_height_m  ']

contains

   !> Number of values in a row of a column.
   pure integer function row_size(unknowns)
      !> Number of its joint deformations
      integer, intent(in) :: unknowns

      row_size = row_joints - 1 + 2*unknowns
   end function row_size

   !> Names of the values with their units.
   function row_labels(n, opens, dynamic) result(labels)
      integer, intent(in) :: n
      !> Whether the joints open, and whether the first value is a time
      logical, intent(in) :: opens, dynamic
      character(len=24), allocatable :: labels(:)
      integer :: i, m

      m = merge(3, 2, opens)*n
      allocate (labels(row_size(m)))
      labels(:row_joints - 1) = fixed
      if (.not. dynamic) labels(row_time) = 'step'
      do i = 1, n
         associate (deformation => row_joints - 1 + i, force => row_joints - 1 + m + i)
            labels(deformation) = 'slip_'//to_text(i)//'_m'
            labels(deformation + n) = 'rotation_'//to_text(i)//'_rad'
            labels(force) = 'shear_'//to_text(i)//'_N'
            labels(force + n) = 'moment_'//to_text(i)//'_Nm'
            if (.not. opens) cycle
            labels(deformation + 2*n) = 'opening_'//to_text(i)//'_m'
            labels(force + 2*n) = 'axial_force_'//to_text(i)//'_N'
         end associate
      end do
   end function row_labels

end module rbs_output_row
