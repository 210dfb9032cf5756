!> Damping by ratios of the modes.
module rbs_solve_modal_damping
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_column_column, only: column_type
   use rbs_column_mass, only: symmetric_mass
   use rbs_solve_modal_modes, only: modes_type, find_modes
   implicit none
   private

   public :: modal_damping

contains

   !> C = sum_j 2 zeta_j omega_j (M s_j) (M s_j)', the modes s_j of the uncracked column.
   subroutine modal_damping(column, damping, error)
      type(column_type), intent(in) :: column
      !> Matrix (unknowns, unknowns) in slip, relative rotation and opening
      real(wp), allocatable, intent(out) :: damping(:, :)
      type(error_type), allocatable, intent(out) :: error
      type(modes_type) :: modes
      real(wp), allocatable :: mass(:, :), carried(:, :)
      real(wp) :: ratio
      integer :: j, m

      m = column%unknowns
      call find_modes(column, modes, error)
      if (allocated(error)) return
      allocate (mass(m, m))
      allocate (damping(m, m), source=0.0_wp)
      call symmetric_mass(column, mass)
      carried = matmul(mass, modes%shapes)
      do j = 1, size(modes%omega)
         ratio = 0.0_wp
         if (size(column%modal_damping) == 1) then
            ratio = column%modal_damping(1)
         else if (j <= size(column%modal_damping)) then
            ratio = column%modal_damping(j)
         end if
         carried(:, j) = sqrt(2.0_wp*ratio*modes%omega(j))*carried(:, j)
      end do
      damping = matmul(carried, transpose(carried))
   end subroutine modal_damping

end module rbs_solve_modal_damping
