!> Second-order work of the axial forces: geometric stiffness and critical load.
module rbs_column_axial
   use rbs_base_error, only: error_type, fatal_error, bad_input
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_column_column, only: column_type
   use rbs_structure_spring_place, only: shear, flexure
   implicit none
   private

   public :: geometric_stiffness, geometric_forces, axial_energy, critical_factor, check_stable

contains

   !> Second derivatives of the potential of the axial forces, to second order
   !>
   !>     V = -sum a_k l_k th_k^2/2 - sum b_k u_k th_{k-1}
   !>
   !> with a = `axial_body`, b = `axial_slip` and the absolute rotations th = sum of phi. For the load
   !> alone it is P times the height of the top; slips above a joint belong to the lever arm too.
   subroutine geometric_stiffness(column, stiffness)
      type(column_type), intent(in) :: column
      !> Matrix (unknowns, unknowns) in (slip, relative rotation [, opening]) [N/m, N, N m]
      real(wp), intent(out) :: stiffness(:, :)
      real(wp) :: above(column%n + 1)
      integer :: i, j, n

      n = column%n
      above(n + 1) = 0.0_wp
      do i = n, 1, -1
         above(i) = above(i + 1) + column%axial_body(i)*column%length(i)
      end do
      stiffness = 0.0_wp
      do j = 1, n
         do i = 1, n
            stiffness(n + i, n + j) = -above(max(i, j))
            stiffness(i, n + j) = merge(-column%axial_slip(i), 0.0_wp, j < i)
            stiffness(n + j, i) = stiffness(i, n + j)
         end do
      end do
   end subroutine geometric_stiffness

   !> Geometric stiffness times deformations, in a number of operations proportional to n.
   pure subroutine geometric_forces(column, q, g)
      type(column_type), intent(in) :: column
      !> Deformations (unknowns)
      real(wp), intent(in) :: q(column%n, *)
      !> Forces of slips and rotations; those of openings are not touched (unknowns) [N, N m]
      real(wp), intent(inout) :: g(column%n, *)
      real(wp) :: rotation, above
      integer :: i, n

      n = column%n
      rotation = 0.0_wp
      do i = 1, n
         g(i, shear) = -column%axial_slip(i)*rotation
         rotation = rotation + q(i, flexure)
         g(i, flexure) = -column%axial_body(i)*column%length(i)*rotation
         if (i < n) g(i, flexure) = g(i, flexure) - column%axial_slip(i + 1)*q(i + 1, shear)
      end do
      above = 0.0_wp
      do i = n, 1, -1
         above = above + g(i, flexure)
         g(i, flexure) = above
      end do
   end subroutine geometric_forces

   !> Potential of the axial forces to second order, zero for the straight column [J].
   pure real(wp) function axial_energy(column, q) result(energy)
      type(column_type), intent(in) :: column
      !> Deformations (2 n)
      real(wp), intent(in) :: q(column%n, *)
      real(wp) :: rotation
      integer :: i

      energy = 0.0_wp
      rotation = 0.0_wp
      do i = 1, column%n
         energy = energy - column%axial_slip(i)*q(i, shear)*rotation
         rotation = rotation + q(i, flexure)
         energy = energy - 0.5_wp*column%axial_body(i)*column%length(i)*rotation**2
      end do
   end function axial_energy

   !> The number by which all axial forces must be multiplied to make the uncracked column lose its
   !> stiffness; `huge` if no multiple does. Tension too can buckle a column of several bodies, by slip
   !> against rotation.
   !>
   !> The multiples that the column carries are an interval from zero, so it is bisected; whether it carries
   !> one is asked in O(n) operations, from the top down, and to the last digit.
   subroutine critical_factor(column, factor, error)
      type(column_type), intent(in) :: column
      real(wp), intent(out) :: factor
      !> Never allocated: no column is beyond this method
      type(error_type), allocatable, intent(out) :: error
      !> Beyond 2**200 times the scale of the problem nothing buckles.
      integer, parameter :: most_doublings = 200
      real(wp), allocatable :: turning(:), sliding(:), stiffer(:)
      real(wp) :: scale, below, above, between
      integer :: i, n

      factor = huge(1.0_wp)
      if (.not. column%axially_loaded) return
      n = column%n
      allocate (turning(n), sliding(n), stiffer(n))
      turning(n) = column%axial_body(n)*column%length(n)/column%initial_stiffness(2*n)
      sliding(n) = 0.0_wp
      stiffer(n) = 0.0_wp
      do i = 1, n - 1
         associate (shear => column%initial_stiffness(i + 1), flexure => column%initial_stiffness(n + i))
            turning(i) = column%axial_body(i)*column%length(i)/flexure
            sliding(i) = abs(column%axial_slip(i + 1))/sqrt(shear)/sqrt(flexure)
            stiffer(i) = column%initial_stiffness(n + i + 1)/flexure
         end associate
      end do
      ! A held top takes the stiffness of its joint away from what turns the body below.
      if (column%held) stiffer(n - 1) = -stiffer(n - 1)
      scale = max(maxval(abs(turning)), maxval(sliding))
      if (.not. scale > 0.0_wp) return
      turning = turning/scale
      sliding = (sliding/scale)**2

      below = 1.0_wp
      if (carries(below, turning, sliding, stiffer)) then
         do i = 1, most_doublings
            if (.not. carries(2.0_wp*below, turning, sliding, stiffer)) exit
            below = 2.0_wp*below
         end do
         if (i > most_doublings) return
      else
         do i = 1, most_doublings
            below = 0.5_wp*below
            if (carries(below, turning, sliding, stiffer)) exit
         end do
      end if
      above = 2.0_wp*below
      do i = 1, digits(1.0_wp)
         between = 0.5_wp*(below + above)
         if (carries(between, turning, sliding, stiffer)) then
            below = between
         else
            above = between
         end if
      end do
      factor = below/scale
   end subroutine critical_factor

   !> Whether the column is stable under a multiple of its axial forces: whether K + multiple K_G is
   !> positive definite.
   !>
   !> All bodies above joint i, in equilibrium on it, push over the one below it with a negative rotational
   !> stiffness -t_i. A body adds a l; a flexural spring in series makes of t the stiffness t k_M/(k_M - t)
   !> and must be stiffer than t; the slip of the joint adds b^2/k_V. With compression all terms have one
   !> sign: nothing cancels. Here as tau_i = t_i/k_Mi. What is held is infinitely stiff: t k_M/(k_M - t) tends
   !> to -k_M.
   pure logical function carries(multiple, turning, sliding, stiffer)
      real(wp), intent(in) :: multiple
      !> a_i l_i/k_Mi, b_{i+1}^2/(k_V,i+1 k_Mi) and k_M,i+1/k_Mi
      real(wp), intent(in), contiguous :: turning(:), sliding(:), stiffer(:)
      real(wp) :: tau
      integer :: i, n

      n = size(turning)
      carries = .false.
      tau = multiple*turning(n)
      if (n > 1) then
         if (stiffer(n - 1) < 0.0_wp) then
            n = n - 1
            tau = multiple*turning(n) + multiple**2*sliding(n) + stiffer(n)
         end if
      end if
      do i = n - 1, 1, -1
         if (.not. tau < 1.0_wp) return
         tau = multiple*turning(i) + multiple**2*sliding(i) + stiffer(i)*tau/(1.0_wp - tau)
      end do
      carries = tau < 1.0_wp
   end function carries

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
