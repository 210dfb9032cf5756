!> Viscous damping of one body with small rotations: forces C v of slip and relative rotation, from its mass,
!> the stiffness of its springs and its modes.
module rbs_solve_one_body_body_damping
   use rbs_base_kinds, only: wp
   use rbs_structure_column_column, only: column_type
   use rbs_structure_structure, only: structure_type
   implicit none
   private

   public :: body_damping, column_of_one_body, damping_of_body, decay_of

   type :: body_damping
      !> Whether there is any
      logical :: acts = .false.
      !> C as far as it is constant (11, 12, 22); that in proportion to the stiffness of the present lines [s]
      real(wp) :: constant(3) = 0.0_wp, of_lines = 0.0_wp
   contains
      procedure :: on_lines
   end type body_damping

contains

   !> The structure, if it is a column of one body with small rotations, whose joint does not open; else none.
   function column_of_one_body(structure) result(column)
      class(structure_type), intent(in), target :: structure
      type(column_type), pointer :: column

      column => null()
      if (structure%unknowns /= 2) return
      select type (structure)
      type is (column_type)
         column => structure
      end select
   end function column_of_one_body

   !> The damping of a column of one body.
   pure type(body_damping) function damping_of_body(column, joint_damping, modal) result(damping)
      type(column_type), intent(in) :: column
      !> Damping of the springs by their initial stiffness (2) [N s/m, N m s]; matrix of the modal damping
      !> (2, 2), not allocated: none
      real(wp), intent(in) :: joint_damping(:)
      real(wp), intent(in), allocatable :: modal(:, :)

      damping%acts = column%damped
      if (.not. damping%acts) return
      ! Mass damping resists the velocity of the centroid, which slip and rotation share.
      associate (m => column%mass_damping*column%mass(1), lower => column%lower(1))
         damping%constant = [m, m*lower, m*lower**2 + column%mass_damping*column%inertia(1)]
      end associate
      if (column%tangent_damping) then
         damping%of_lines = column%stiffness_damping
      else
         damping%constant([1, 3]) = damping%constant([1, 3]) + joint_damping
      end if
      if (allocated(modal)) damping%constant = damping%constant + [modal(1, 1), modal(1, 2), modal(2, 2)]
   end function damping_of_body

   !> C on the present lines (11, 12, 22): its constant part, and that in proportion to the stiffness of the
   !> lines; springs that soften damp nothing.
   pure function on_lines(self, k_1, k_2) result(c)
      class(body_damping), intent(in) :: self
      !> Slopes of the lines of slip [N/m] and rotation [N m]
      real(wp), intent(in) :: k_1, k_2
      real(wp) :: c(3)

      c(1) = self%constant(1) + self%of_lines*max(k_1, 0.0_wp)
      c(2) = self%constant(2)
      c(3) = self%constant(3) + self%of_lines*max(k_2, 0.0_wp)
   end function on_lines

   !> Deceleration by the damping for each velocity, M^-1 C (11, 12, 21, 22) [1/s].
   pure function decay_of(inv_mass, inv_coupling, inv_inertia, c) result(d)
      !> Inverse of the mass matrix in slip and rotation (11, 12, 22) [1/kg, 1/(kg m), 1/(kg m2)]; C (11, 12,
      !> 22)
      real(wp), intent(in) :: inv_mass, inv_coupling, inv_inertia, c(3)
      real(wp) :: d(4)

      d = [inv_mass*c(1) + inv_coupling*c(2), inv_mass*c(2) + inv_coupling*c(3), &
           inv_coupling*c(1) + inv_inertia*c(2), inv_coupling*c(2) + inv_inertia*c(3)]
   end function decay_of

end module rbs_solve_one_body_body_damping
