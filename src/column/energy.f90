!> Energies of a column that do not depend on its springs, at every level of kinematics.
module rbs_column_energy
   use rbs_base_inner_product, only: inner_product
   use rbs_base_kinds, only: wp
   use rbs_column_axial, only: axial_energy
   use rbs_column_chain, only: kinetic_of
   use rbs_column_column, only: column_type, finite
   use rbs_column_finite, only: finite_kinetic, finite_potential
   implicit none
   private

   public :: kinetic_energy, potential_energy

contains

   !> Kinetic energy relative to the ground [J].
   pure real(wp) function kinetic_energy(column, q, v) result(energy)
      type(column_type), intent(in) :: column
      !> Deformations and their velocities (unknowns)
      real(wp), intent(in), contiguous :: q(:), v(:)

      if (column%kinematics == finite) then
         energy = finite_kinetic(column, q, v)
      else
         energy = kinetic_of(column, v)
      end if
   end function kinetic_energy

   !> Potential of the constant axial load and the weight, zero for the straight column [J].
   pure real(wp) function potential_energy(column, q) result(energy)
      type(column_type), intent(in) :: column
      !> Deformations (unknowns)
      real(wp), intent(in), contiguous :: q(:)
      integer :: n

      n = column%n
      if (column%kinematics == finite) then
         energy = finite_potential(column, q)
         return
      end if
      energy = 0.0_wp
      if (column%axially_loaded) energy = axial_energy(column, q)
      if (column%opens) energy = energy + inner_product(n, column%axial_joint, q(2*n + 1:))
   end function potential_energy

end module rbs_column_energy
