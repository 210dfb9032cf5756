!> Second-order work of the axial forces: geometric stiffness and critical load.
module rbs_column_axial
   use rbs_base_error, only: error_type, fatal_error, bad_input
   use rbs_base_kinds, only: wp
   use rbs_base_linalg, only: solve_eigen
   use rbs_base_text, only: to_text
   use rbs_column_column, only: column_type
   implicit none
   private

   public :: geometric_stiffness, geometric_forces, axial_energy, critical_factor, check_stable

contains

   !> Second derivatives of the potential of the axial forces, to second order
   !>
   !>     V = -sum a_k l_k th_k^2/2 - sum b_k u_k th_{k-1}
   !>
   !> with a = `axial_body`, b = `axial_joint` and the absolute rotations th = sum of phi. For the load
   !> alone it is P times the height of the top; slips above a joint belong to the lever arm too.
   subroutine geometric_stiffness(column, stiffness)
      type(column_type), intent(in) :: column
      !> Matrix (2 n, 2 n) in (slip, relative rotation) [N/m, N, N m]
      real(wp), intent(out) :: stiffness(:, :)
      real(wp) :: above(column%n + 1)
      integer :: i, j, n

      n = column%n
      above(n + 1) = 0.0_wp
      do i = n, 1, -1
         above(i) = above(i + 1) + column%axial_body(i)*column%length(i)
      end do
      stiffness(:n, :n) = 0.0_wp
      do j = 1, n
         do i = 1, n
            stiffness(n + i, n + j) = -above(max(i, j))
            stiffness(i, n + j) = merge(-column%axial_joint(i), 0.0_wp, j < i)
            stiffness(n + j, i) = stiffness(i, n + j)
         end do
      end do
   end subroutine geometric_stiffness

   !> Geometric stiffness times deformations, in a number of operations proportional to n.
   pure subroutine geometric_forces(column, q, g)
      type(column_type), intent(in) :: column
      !> Deformations (2 n)
      real(wp), intent(in) :: q(:)
      !> Forces (2 n) [N, N m]
      real(wp), intent(out) :: g(:)
      real(wp) :: rotation, above
      integer :: i, n

      n = column%n
      rotation = 0.0_wp
      do i = 1, n
         g(i) = -column%axial_joint(i)*rotation
         rotation = rotation + q(n + i)
         g(n + i) = -column%axial_body(i)*column%length(i)*rotation
         if (i < n) g(n + i) = g(n + i) - column%axial_joint(i + 1)*q(i + 1)
      end do
      above = 0.0_wp
      do i = n, 1, -1
         above = above + g(n + i)
         g(n + i) = above
      end do
   end subroutine geometric_forces

   !> Potential of the axial forces to second order, zero for the straight column [J].
   pure real(wp) function axial_energy(column, q) result(energy)
      type(column_type), intent(in) :: column
      !> Deformations (2 n)
      real(wp), intent(in) :: q(:)
      real(wp) :: rotation
      integer :: i

      energy = 0.0_wp
      rotation = 0.0_wp
      do i = 1, column%n
         energy = energy - column%axial_joint(i)*q(i)*rotation
         rotation = rotation + q(column%n + i)
         energy = energy - 0.5_wp*column%axial_body(i)*column%length(i)*rotation**2
      end do
   end function axial_energy

   !> The number by which all axial forces must be multiplied to make the uncracked column lose its
   !> stiffness; `huge` if no multiple does. Tension too can buckle a column of several bodies, by slip
   !> against rotation.
   subroutine critical_factor(column, factor, error)
      type(column_type), intent(in) :: column
      real(wp), intent(out) :: factor
      type(error_type), allocatable, intent(out) :: error
      real(wp), allocatable :: softening(:, :), stiffness(:, :), w(:)
      integer :: i, m

      factor = huge(1.0_wp)
      if (.not. column%axially_loaded) return
      m = column%unknowns
      allocate (softening(m, m), w(m))
      allocate (stiffness(m, m), source=0.0_wp)
      call geometric_stiffness(column, softening)
      softening = -softening
      do i = 1, m
         stiffness(i, i) = column%initial_stiffness(i)
      end do
      call solve_eigen(softening, stiffness, w, error)
      if (allocated(error)) return
      if (w(m) > 1.0_wp/huge(1.0_wp)) factor = 1.0_wp/w(m)
   end subroutine critical_factor

   !> Refuse an axial load that the unloaded column cannot carry.
   subroutine check_stable(column, error)
      type(column_type), intent(in) :: column
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: factor

      call critical_factor(column, factor, error)
      if (allocated(error) .or. factor > 1.0_wp) return
      call fatal_error(error, bad_input, 'column: the axial load of '// &
                       to_text(column%axial_joint(1))//' N at the base is beyond the critical load of '// &
                       to_text(factor*column%axial_joint(1))//' N; the column buckles by itself. '// &
                       'Reduce axial_load or stiffen the springs')
   end subroutine check_stable

end module rbs_column_axial
