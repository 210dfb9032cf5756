!> Dense matrices of the chain for small rotations: its mass, in two views of the same equations, and its
!> geometric stiffness.
module rbs_structure_column_chain_matrices
   use rbs_base_kinds, only: wp
   use rbs_structure_column_chain, only: geometric_forces
   use rbs_structure_column_column, only: column_type
   use rbs_structure_spring_location, only: shear, flexure, axial
   implicit none
   private

   public :: symmetric_mass, paper_mass, geometric_stiffness

contains

   !> Mass matrix in (slip, relative rotation): symmetric, positive definite. It is the form that the
   !> paper leaves to future work; with k >= max(i, j) and h_ki the height of centroid k over joint i
   !>
   !>     M_uu = sum m_k,  M_uphi = sum m_k h_kj,  M_phiphi = sum (m_k h_ki h_kj + I_k)
   !>
   !> and M_ww = M_uu for the openings, which nothing couples to the others while rotations are small.
   subroutine symmetric_mass(column, mass)
      type(column_type), intent(in) :: column
      !> Matrix (unknowns, unknowns), here by joint and kind [kg, kg m, kg m2]
      real(wp), intent(out) :: mass(column%n, column%kinds, column%n, column%kinds)
      real(wp) :: between
      integer :: i, j, p, n

      n = column%n
      if (column%opens) mass = 0.0_wp
      do j = 1, n
         do i = 1, n
            p = max(i, j)
            between = column%joint_height(p) - column%joint_height(min(i, j))
            mass(i, shear, j, shear) = column%mass_above(p)
            mass(i, shear, j, flexure) = column%moment_above(p) &
                             + (column%joint_height(p) - column%joint_height(j))*column%mass_above(p)
            mass(j, flexure, i, shear) = mass(i, shear, j, flexure)
            mass(i, flexure, j, flexure) = column%inertia_above(p) + between*column%moment_above(p)
            if (column%opens) mass(i, axial, j, axial) = column%mass_above(p)
         end do
      end do
   end subroutine symmetric_mass

   !> The paper's matrix [A B; C D] (eq 3) in (slip, absolute rotation), rows as in eqs 1 and 2, with
   !> the misprints corrected: the lever arm of a body below a joint is zero, the double sums start at
   !> h = j for i < j, I_i = m_i l_i^2/12.
   subroutine paper_mass(column, mass)
      type(column_type), intent(in) :: column
      !> Matrix (2 n, 2 n), here by joint and kind [kg, kg m, kg m2]
      real(wp), intent(out) :: mass(column%n, 2, column%n, 2)
      real(wp) :: to_joint
      integer :: i, j, p, n

      n = column%n
      do j = 1, n
         associate (l => column%length(j), m => column%mass(j), s => column%lower(j))
            do i = 1, n
               p = max(i, j)
               mass(i, shear, j, shear) = column%mass_above(p)
               mass(i, flexure, j, shear) = column%moment_above(p) &
                                + (column%joint_height(p) - column%joint_height(i))*column%mass_above(p)
               if (i > j) then
                  mass(i, shear, j, flexure) = l*column%mass_above(i)
                  mass(i, flexure, j, flexure) = l*column%moment_above(i)
               else
                  to_joint = column%joint_height(j) - column%joint_height(i)
                  mass(i, shear, j, flexure) = m*s + l*column%mass_above(j + 1)
                  mass(i, flexure, j, flexure) = column%inertia(j) + m*(to_joint + s)*s &
                                       + l*(column%moment_above(j + 1) &
                                            + (to_joint + l)*column%mass_above(j + 1))
               end if
            end do
         end associate
      end do
   end subroutine paper_mass

   !> Second derivatives of the potential of the axial forces at the straight column, in (slip, relative
   !> rotation [, opening]); column j of the matrix is the forces of a unit deformation j.
   subroutine geometric_stiffness(column, stiffness)
      class(column_type), intent(in) :: column
      !> Square matrix of 2 n, or of all unknowns, where openings have zeros [N/m, N, N m]
      real(wp), intent(out) :: stiffness(:, :)
      real(wp) :: unit(2*column%n), g(2*column%n)
      integer :: j, m

      m = 2*column%n
      stiffness = 0.0_wp
      unit = 0.0_wp
      do j = 1, m
         unit(j) = 1.0_wp
         call geometric_forces(column%n, column%second_order, unit, g)
         ! Adding zero turns negative zeros, which matrices would show, into positive ones.
         stiffness(:m, j) = g + 0.0_wp
         unit(j) = 0.0_wp
      end do
   end subroutine geometric_stiffness

end module rbs_structure_column_chain_matrices
