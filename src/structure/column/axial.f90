!> Second-order work of the axial forces: geometric stiffness and critical load.
module rbs_structure_column_axial
   use rbs_base_error, only: error_type, fatal_error, bad_input
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_structure_column_column, only: column_type
   use rbs_structure_column_sturm, only: sturm_chain, lateral_chain
   use rbs_structure_spring_place, only: shear, flexure
   implicit none
   private

   public :: geometric_stiffness, geometric_forces, critical_factor, check_stable

contains

   !> Second derivatives of the potential of the axial forces, to second order
   !>
   !>     V = -sum a_k l_k th_k^2/2 - sum b_k u_k th_{k-1}
   !>
   !> with a = `axial_body`, b = `axial_slip` and the absolute rotations th = sum of phi. For the load
   !> alone it is P times the height of the top; slips above a joint belong to the lever arm too.
   subroutine geometric_stiffness(column, stiffness)
      type(column_type), intent(in) :: column
      !> Matrix (2 n or unknowns, as many) in (slip, relative rotation [, opening]) [N/m, N, N m]
      real(wp), intent(out), contiguous :: stiffness(:, :)
      real(wp) :: q(size(stiffness, 1))
      integer :: j

      q = 0.0_wp
      stiffness = 0.0_wp
      do j = 1, size(q)
         q(j) = 1.0_wp
         call geometric_forces(column, q, stiffness(:, j))
         ! No negative zeros
         stiffness(:, j) = stiffness(:, j) + 0.0_wp
         q(j) = 0.0_wp
      end do
   end subroutine geometric_stiffness

   !> Geometric stiffness times deformations, in a number of operations proportional to n.
   pure subroutine geometric_forces(column, q, g)
      type(column_type), intent(in) :: column
      !> Deformations (unknowns)
      real(wp), intent(in) :: q(column%n, 2)
      !> Forces of slips and rotations; those of openings are not touched (unknowns) [N, N m]
      real(wp), intent(inout) :: g(column%n, 2)
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

   !> The number by which all axial forces must be multiplied to make the uncracked column lose its
   !> stiffness; `huge` if no multiple does. Tension too can buckle a column of several bodies, by slip
   !> against rotation.
   !>
   !> The multiples that the column carries are an interval from zero, so it is bisected; whether it carries
   !> one is asked in O(n) operations, and to the last digit.
   subroutine critical_factor(column, factor)
      type(column_type), intent(in) :: column
      real(wp), intent(out) :: factor
      !> Beyond 2**200 times the scale of the problem nothing buckles.
      integer, parameter :: most_doublings = 200
      type(sturm_chain) :: chain
      real(wp) :: scale, below, between
      integer :: i

      factor = huge(1.0_wp)
      if (.not. column%axially_loaded) return
      chain = lateral_chain(column, .true.)
      scale = max(maxval(abs(chain%turning)/chain%k(2, :)), &
                  maxval(abs(chain%sliding(2:))/sqrt(chain%k(1, 2:))/sqrt(chain%k(2, :column%n - 1))))
      if (.not. scale > 0.0_wp) return
      below = 1.0_wp
      if (carries(below)) then
         do i = 1, most_doublings
            if (.not. carries(2.0_wp*below)) exit
            below = 2.0_wp*below
         end do
         if (i > most_doublings) return
      else
         do i = 1, most_doublings
            below = 0.5_wp*below
            if (carries(below)) exit
         end do
      end if
      between = below
      do i = 1, digits(1.0_wp)
         between = 0.5_wp*between
         if (carries(below + between)) below = below + between
      end do
      factor = below/scale

   contains

      logical function carries(multiple)
         real(wp), intent(in) :: multiple

         carries = chain%factor(0.0_wp, multiple/scale) == 0
      end function carries

   end subroutine critical_factor

   !> Refuse an axial load that the unloaded column cannot carry.
   subroutine check_stable(column, error)
      type(column_type), intent(in) :: column
      type(error_type), allocatable, intent(out) :: error
      type(sturm_chain) :: chain
      real(wp) :: factor

      if (.not. column%axially_loaded) return
      chain = lateral_chain(column, .true.)
      if (chain%factor(0.0_wp) == 0) return
      call critical_factor(column, factor)
      call fatal_error(error, bad_input, 'column: the axial load of '// &
                       to_text(column%axial_joint(1))//' N at the base is beyond the critical load of '// &
                       to_text(factor*column%axial_joint(1))//' N; the column buckles by itself. '// &
                       'Reduce axial_load or stiffen the springs')
   end subroutine check_stable

end module rbs_structure_column_axial
