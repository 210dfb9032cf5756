!> The matrices of the uncracked column for small rotations, in full: mass, stiffness of the joints, geometric
!> stiffness of the axial forces, and damping. The solvers do without them, and the tests hold their
!> recursions equal to these.
!>
!>     M q'' + C q' + (K + K_G) q = p
module rbs_solve_modal_matrices
   use rbs_base_error, only: error_type, fatal_error, analysis_failed, bad_input
   use rbs_base_kinds, only: wp
   use rbs_base_linalg, only: solve_dense
   use rbs_base_text, only: to_text
   use rbs_structure_column_column, only: column_type
   use rbs_structure_column_chain_matrices, only: symmetric_mass, paper_mass, geometric_stiffness
   use rbs_solve_modal_modes, only: modes_type, find_modes, most_numbers
   use rbs_structure_spring_location, only: flexure
   use rbs_structure_structure, only: structure_type, signals
   implicit none
   private

   public :: matrices_type, assemble_matrices, modal_damping, find_modal_momenta

   type :: matrices_type
      !> Name of each unknown: slip_1, ..., rotation_1, ... [, opening_1, ...], rotations relative to the body
      !> below, or in the paper's form slip_1, ..., theta_1, ... with absolute rotations. The last rotation is
      !> no unknown where the top is held
      character(len=40), allocatable :: unknown(:)
      !> (unknowns, unknowns) [N, m, kg, s, rad]
      real(wp), allocatable :: mass(:, :), stiffness(:, :), geometric(:, :), damping(:, :)
   contains
      procedure :: accelerations
   end type matrices_type

contains

   !> The matrices of a structure: those of a column in its coordinates, of others in the displacements of
   !> their nodes.
   subroutine assemble_matrices(structure, paper, matrices, error)
      class(structure_type), intent(in) :: structure
      !> Whether in the paper's form: unknowns (slip, absolute rotation), rows of its eqs 1 and 2. Else in
      !> (slip, relative rotation), where all are symmetric
      logical, intent(in) :: paper
      type(matrices_type), intent(out) :: matrices
      type(error_type), allocatable, intent(out) :: error

      select type (structure)
      class is (column_type)
         call assemble_column(structure)
      class default
         if (paper) then
            call fatal_error(error, bad_input, "matrices: the paper's form is that of a column; ask for "// &
                             'the other one')
            return
         end if
         call assemble_bands()
      end select

   contains

      !> Assemble them from the bands that the solvers use.
      subroutine assemble_bands()
         real(wp) :: band(structure%half_width + 1, structure%unknowns), axial(structure%axial_count)
         real(wp) :: at_rest(signals)
         integer :: i, m

         m = structure%unknowns
         allocate (matrices%mass(m, m), matrices%stiffness(m, m), matrices%geometric(m, m), &
                   matrices%damping(m, m), source=0.0_wp)
         matrices%unknown = structure%unknown_name
         ! The mass of nodes is diagonal.
         do i = 1, m
            matrices%mass(i, i) = structure%inertias(i)
         end do
         band = 0.0_wp
         call structure%add_stiffness(structure%initial_stiffness, structure%initial_tangent, band)
         call fill(band, matrices%stiffness)
         if (structure%axially_loaded) then
            band = 0.0_wp
            at_rest = 0.0_wp
            call structure%axial_forces(at_rest, axial)
            call structure%add_geometric(axial, band)
            call fill(band, matrices%geometric)
         end if
         if (.not. structure%damped) return
         band = 0.0_wp
         call structure%add_damping(1.0_wp, structure%initial_tangent, band)
         call fill(band, matrices%damping)
         matrices%damping = matrices%damping + structure%mass_damping*matrices%mass
         if (.not. allocated(structure%modal_momenta)) return
         associate (momenta => structure%modal_momenta, at => structure%massed)
            matrices%damping(at, at) = matrices%damping(at, at) + matmul(momenta, transpose(momenta))
         end associate
      end subroutine assemble_bands

      !> The matrices of a column.
      subroutine assemble_column(column)
         class(column_type), intent(in) :: column
         character(len=9) :: names(3)
         integer :: i, m, n

         n = column%n
         m = column%unknowns
         if (real(m, wp)**2 > most_numbers) then
            call fatal_error(error, bad_input, 'matrices: those of n = '//to_text(n)//' bodies take too '// &
                             'much memory; take '//to_text(int(sqrt(most_numbers))*n/m)//' at the most')
            return
         end if
         allocate (matrices%mass(m, m))
         allocate (matrices%stiffness(m, m), matrices%geometric(m, m), matrices%damping(m, m), source=0.0_wp)
         call symmetric_mass(column, matrices%mass)
         do i = 1, m
            matrices%stiffness(i, i) = column%initial_stiffness(i)
         end do
         if (column%axially_loaded) call geometric_stiffness(column, matrices%geometric)
         if (allocated(column%modal_damping)) then
            call modal_damping(column, matrices%damping, error)
            if (allocated(error)) return
         end if
         matrices%damping = matrices%damping + column%mass_damping*matrices%mass &
                            + column%stiffness_damping*matrices%stiffness
         allocate (matrices%unknown(m))
         ! In the order of the kinds of springs: shear, flexure, axial
         names = [character(len=9) :: 'slip_', merge('theta_   ', 'rotation_', paper), 'opening_']
         do i = 1, m
            matrices%unknown(i) = trim(names(column%location(i)%kind))//to_text(column%location(i)%joint)
         end do
         call transform(column, matrices%mass)
         call transform(column, matrices%stiffness)
         call transform(column, matrices%geometric)
         call transform(column, matrices%damping)
         if (column%held) matrices%unknown = pack(matrices%unknown, [(i /= column%at(flexure, n), i=1, m)])
         ! Its rows are eqs 1 and 2 as they stand, not combined to a symmetric matrix.
         if (paper .and. .not. column%held) call paper_mass(column, matrices%mass(:2*n, :2*n))
      end subroutine assemble_column

      !> Take the rotation of a held top out of a matrix, as it is minus the sum of those below; and in the
      !> paper's form pass from relative rotations, each the difference of two, to absolute ones.
      subroutine transform(column, a)
         class(column_type), intent(in) :: column
         !> Matrix in slips, relative rotations and openings, in this order
         real(wp), allocatable, intent(inout) :: a(:, :)
         integer :: i, last, n
         integer, allocatable :: kept(:)

         n = column%n
         last = 2*n
         if (column%held) then
            do i = n + 1, last - 1
               a(:, i) = a(:, i) - a(:, last)
            end do
            do i = n + 1, last - 1
               a(i, :) = a(i, :) - a(last, :)
            end do
            kept = [(i, i=1, last - 1), (i, i=last + 1, size(a, 1))]
            a = a(kept, kept)
            last = last - 1
         end if
         if (.not. paper) return
         ! The unknowns change, the equations stay.
         do i = n + 1, last - 1
            a(:, i) = a(:, i) - a(:, i + 1)
         end do
      end subroutine transform

   end subroutine assemble_matrices

   !> A symmetric matrix in full from its lower band, whose row 1 is the diagonal.
   pure subroutine fill(band, a)
      !> (half width + 1, m)
      real(wp), intent(in) :: band(:, :)
      !> (m, m), whose elements outside the band stay as they are
      real(wp), intent(inout) :: a(:, :)
      integer :: i, j

      do j = 1, size(a, 2)
         do i = j, min(j + size(band, 1) - 1, size(a, 1))
            a(i, j) = band(1 + i - j, j)
            a(j, i) = a(i, j)
         end do
      end do
   end subroutine fill

   !> The accelerations that forces give to a structure at rest: M q'' = p, eqs 1 and 2 of the paper for a
   !> column in its form, solved as they stand.
   subroutine accelerations(self, force, acceleration, error)
      class(matrices_type), intent(in) :: self
      !> Forces on the unknowns (unknowns) [N, N m]
      real(wp), intent(in) :: force(:)
      !> (unknowns) [m/s2, rad/s2]
      real(wp), intent(out) :: acceleration(:)
      type(error_type), allocatable, intent(out) :: error
      real(wp), allocatable :: a(:, :)
      logical :: regular

      allocate (a, source=self%mass)
      acceleration = force
      call solve_dense(a, acceleration, regular)
      if (.not. regular) then
         call fatal_error(error, analysis_failed, 'matrices: the mass matrix has no inverse; '// &
                          'check the masses')
      end if
   end subroutine accelerations

   !> Damping of the modes of a column, as a matrix of its unknowns (slip, relative rotation and opening).
   subroutine modal_damping(structure, damping, error)
      class(structure_type), intent(in) :: structure
      !> (unknowns, unknowns)
      real(wp), allocatable, intent(out) :: damping(:, :)
      type(error_type), allocatable, intent(out) :: error
      real(wp), allocatable :: momenta(:, :)

      call find_modal_momenta(structure, momenta, error)
      if (.not. allocated(error)) damping = matmul(momenta, transpose(momenta))
   end subroutine modal_damping

   !> Modal damping is C = sum_j 2 zeta_j omega_j (M s_j) (M s_j)', with the modes s_j of the uncracked
   !> structure under its constant load: find the momenta M s_j times sqrt(2 zeta_j omega_j), whose products
   !> add up to C.
   subroutine find_modal_momenta(structure, momenta, error)
      class(structure_type), intent(in) :: structure
      !> (unknowns, modes)
      real(wp), allocatable, intent(out) :: momenta(:, :)
      type(error_type), allocatable, intent(out) :: error
      type(modes_type) :: modes
      integer :: given, j

      ! One damping ratio is for all modes; several are for the first modes.
      given = size(structure%modal_damping)
      if (given == 1) then
         call find_modes(structure, modes, error)
      else
         call find_modes(structure, modes, error, count=given)
      end if
      if (allocated(error)) return
      if (size(modes%omega) < given) then
         call fatal_error(error, bad_input, 'damping: modal has '//to_text(given)//' values for '// &
                          to_text(size(modes%omega))//' modes; give one for all, or one for each of the '// &
                          'first modes')
         return
      end if
      allocate (momenta, mold=modes%shapes)
      do j = 1, size(modes%omega)
         call structure%momenta(modes%shapes(:, j), momenta(:, j))
         momenta(:, j) = sqrt(2.0_wp*structure%modal_damping(min(j, given))*modes%omega(j))*momenta(:, j)
      end do
   end subroutine find_modal_momenta

end module rbs_solve_modal_matrices
