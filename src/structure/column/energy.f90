!> Energies of a column that do not depend on its springs, at every level of kinematics.
module rbs_structure_column_energy
   use rbs_base_inner_product, only: inner_product
   use rbs_base_kinds, only: wp
   use rbs_structure_column_axial, only: axial_energy
   use rbs_structure_column_column, only: column_type, small, finite
   use rbs_structure_spring_place, only: shear, flexure, axial
   use rbs_structure_column_finite, only: finite_kinetic, finite_potential
   use rbs_structure_structure, only: vertical, top_axial
   implicit none
   private

   public :: kinetic_energy, kinetic_of, potential_energy, power_of_lifts

contains

   !> Kinetic energy relative to the ground [J].
   pure real(wp) function kinetic_energy(column, q, v) result(energy)
      type(column_type), intent(in) :: column
      !> Deformations and their velocities (unknowns)
      real(wp), intent(in) :: q(column%n, column%kinds), v(column%n, column%kinds)

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
      real(wp), intent(in) :: q(column%n, column%kinds)
      integer :: n

      n = column%n
      if (column%kinematics == finite) then
         energy = finite_potential(column, q)
         return
      end if
      energy = 0.0_wp
      if (column%axially_loaded) energy = axial_energy(column, q)
      if (column%opens) energy = energy + inner_product(n, column%axial_joint, q(:, axial))
   end function potential_energy

   !> Kinetic energy of velocities of the joints with small rotations, relative to the ground [J].
   pure real(wp) function kinetic_of(column, v) result(energy)
      type(column_type), intent(in) :: column
      real(wp), intent(in) :: v(column%n, column%kinds)
      real(wp) :: top, turning, centroid, height
      integer :: i, n

      n = column%n
      top = 0.0_wp
      turning = 0.0_wp
      energy = 0.0_wp
      do i = 1, n
         turning = turning + v(i, flexure)
         centroid = top + v(i, shear) + column%lower(i)*turning
         top = centroid + column%upper(i)*turning
         energy = energy + 0.5_wp*(column%mass(i)*centroid**2 + column%inertia(i)*turning**2)
      end do
      if (.not. column%opens) return
      height = 0.0_wp
      do i = 1, n
         height = height + v(i, axial)
         energy = energy + 0.5_wp*column%mass(i)*height**2
      end do
   end function kinetic_of

   !> Power of vertical ground motion and of what is added to the axial load, small rotations [W].
   pure real(wp) function power_of_lifts(column, q, v, load) result(watt)
      type(column_type), intent(in) :: column
      !> Deformations and their velocities (unknowns)
      real(wp), intent(in) :: q(column%n, column%kinds), v(column%n, column%kinds)
      !> Signals of the loads
      real(wp), intent(in) :: load(4)
      real(wp) :: rotation, turning, rising, body, joint
      integer :: i, n

      watt = 0.0_wp
      n = column%n
      rotation = 0.0_wp
      turning = 0.0_wp
      rising = 0.0_wp
      do i = 1, n
         body = load(top_axial)*column%axial_lever + load(vertical)*column%lifted_body(i)
         joint = load(top_axial)*column%axial_lever + load(vertical)*column%lifted_joint(i)
         if (i == n .and. column%held) joint = 0.0_wp
         if (column%kinematics /= small) watt = watt + joint*(v(i, shear)*rotation + q(i, shear)*turning)
         rotation = rotation + q(i, flexure)
         turning = turning + v(i, flexure)
         if (column%kinematics /= small) watt = watt + body*column%length(i)*rotation*turning
         if (column%opens) then
            rising = rising + v(i, axial)
            watt = watt - column%mass(i)*load(vertical)*rising
         end if
      end do
      if (column%opens) watt = watt - load(top_axial)*rising
   end function power_of_lifts

end module rbs_structure_column_energy
