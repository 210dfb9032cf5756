!> The column itself is a straight line with two ends.
!>
!> While every spring stays on its line, deformations and lateral force are linear in what is driven
!> (displacement or force of the top). This module finds that line: exactly, without increments.
!>
!>     K q - a F = r,   a q = x        K = diag(k) + K_G,  a = arms of the lateral force F
!>
!> A few bodies are solved in (slip, relative rotation) with full matrices. More are solved in (slip,
!> absolute rotation), where K is a band of two diagonals beside the main one: k_M couples neighbouring
!> rotations, the axial load only the slip of a joint and the rotation below it. A held top is solved there
!> too: its rotation is the last unknown, and is left out.
module rbs_solve_static_equilibrium
   use rbs_base_band_matrix, only: band_matrix
   use rbs_base_constants, only: no_stiffness
   use rbs_base_kinds, only: wp
   use rbs_structure_column_axial, only: geometric_stiffness, geometric_forces
   use rbs_structure_column_column, only: column_type
   use rbs_structure_column_dead_loads, only: to_joints
   use rbs_solve_static_few_bodies, only: few_bodies
   use rbs_structure_spring_place, only: shear, flexure
   implicit none
   private

   public :: equilibrium_type

   !> A relative rotation is a small difference of absolute ones. The digits that this costs are
   !> recovered: the residual is taken in the deformations of the joints and solved for again.
   integer, parameter :: refinements = 1

   !> Most bodies for which full matrices are faster than bands.
   integer, parameter :: few_are = 2

   type :: equilibrium_type
      !> Number of unknowns, 2 n: openings keep still
      integer :: unknowns = 0
      !> The column, and of it the displacement of the top per unknown (2 n)
      type(column_type) :: column
      real(wp), allocatable :: arm(:)
      !> Whether the geometric stiffness takes part; if not, K is diagonal and nothing is factored
      logical :: coupled = .false.
      !> Initial stiffness (2 n): shares the motion between joints that have none left
      real(wp), allocatable :: initial_stiffness(:)
      !> Few bodies
      type(few_bodies) :: few
      !> The tangent, and the arms joint by joint (2 n)
      type(band_matrix), private :: tangent
      real(wp), allocatable, private :: lever(:)
      !> Work arrays, one column for the rate and one for the correction (2 n, 2)
      real(wp), allocatable, private :: wanted(:, :), found(:, :), missing(:, :), along(:, :), more(:, :)
      !> Forces of the geometric stiffness (2 n)
      real(wp), allocatable, private :: g(:)
   contains
      procedure :: create
      procedure :: residual
      procedure :: follow_force
      procedure :: follow_displacement
   end type equilibrium_type

contains

   subroutine create(self, column)
      class(equilibrium_type), intent(out) :: self
      class(column_type), intent(in) :: column
      integer :: m

      m = 2*column%n
      self%unknowns = m
      self%column = column
      self%arm = column%arm(:m)
      self%initial_stiffness = column%initial_stiffness(:m)
      self%coupled = column%axially_loaded .or. column%held
      if (.not. self%coupled) return
      if (.not. column%axially_loaded) then
         self%column%axial_body = 0.0_wp
         self%column%axial_slip = 0.0_wp
      end if
      allocate (self%wanted(m, 2), self%found(m, 2), self%missing(m, 2), self%along(m, 2), self%more(m, 2), &
                self%g(m))
      call create_band(self, column)
      if (column%n <= few_are .and. .not. column%held) call create_few(self, column)
   end subroutine create

   subroutine create_few(self, column)
      type(equilibrium_type), intent(inout) :: self
      class(column_type), intent(in) :: column
      real(wp) :: geometric(2*column%n + 1, 2*column%n + 1), stiffness(2*column%n, 2*column%n)

      associate (m => self%unknowns)
         geometric = 0.0_wp
         call geometric_stiffness(column, stiffness)
         geometric(:m, :m) = stiffness
         geometric(:m, m + 1) = -self%arm
         geometric(m + 1, :m) = self%arm
      end associate
      call self%few%create(geometric)
   end subroutine create_few

   subroutine create_band(self, column)
      type(equilibrium_type), intent(inout) :: self
      class(column_type), intent(in) :: column
      real(wp) :: stiffness(self%unknowns)
      integer :: i, n

      n = column%n
      allocate (self%lever(self%unknowns))
      do i = 1, n
         self%lever(2*i - 1) = 1.0_wp
         self%lever(2*i) = column%length(i)
         stiffness(2*i - 1:2*i) = column%initial_stiffness(column%at(:flexure, i))
      end do
      do i = 2, n
         stiffness(2*i - 2) = stiffness(2*i - 2) + column%initial_stiffness(column%at(flexure, i))
      end do
      call self%tangent%create(self%unknowns, 2, stiffness)
   end subroutine create_band

   !> Residual of the equilibrium: a F - f - K_G q.
   subroutine residual(self, q, f, force, r)
      class(equilibrium_type), intent(inout) :: self
      !> Deformations and forces of the springs (2 n)
      real(wp), intent(in) :: q(:), f(:)
      !> Lateral force [N]
      real(wp), intent(in) :: force
      !> Residual (2 n)
      real(wp), intent(out) :: r(:)
      integer :: i

      do i = 1, self%unknowns
         r(i) = self%arm(i)*force - f(i)
      end do
      if (.not. self%coupled) return
      call geometric_forces(self%column, q, self%g)
      do i = 1, self%unknowns
         r(i) = r(i) - self%g(i)
      end do
   end subroutine residual

   !> Driven by the force: K rate = a and K correction = r.
   subroutine follow_force(self, k, r, rate, correction, weakest)
      class(equilibrium_type), intent(inout) :: self
      !> Stiffness of the springs (2 n)
      real(wp), intent(in) :: k(:)
      !> Residual (2 n)
      real(wp), intent(in) :: r(:)
      !> Change of the deformations per newton, and what takes the residual away (2 n)
      real(wp), intent(out), contiguous :: rate(:), correction(:)
      !> 0 if the column is stable; else the spring with the least stiffness
      integer, intent(out) :: weakest
      logical :: positive

      if (self%few%fits) then
         self%found(:, 1) = self%arm
         self%found(:, 2) = r
         call self%few%solve_force(k, no_stiffness*self%initial_stiffness, self%found, positive)
         rate = self%found(:, 1)
         correction = self%found(:, 2)
      else if (self%coupled) then
         call follow_force_banded(self, k, r, rate, correction, positive)
      else
         positive = all(k > no_stiffness*self%initial_stiffness)
         if (positive) then
            rate = self%arm/k
            correction = r/k
         end if
      end if
      weakest = 0
      if (positive) return
      weakest = minloc(k/self%initial_stiffness, dim=1)
      rate = 0.0_wp
      correction = 0.0_wp
   end subroutine follow_force

   subroutine follow_force_banded(self, k, r, rate, correction, positive)
      type(equilibrium_type), intent(inout) :: self
      real(wp), intent(in) :: k(:), r(:)
      real(wp), intent(out), contiguous :: rate(:), correction(:)
      logical, intent(out) :: positive
      real(wp), parameter :: force(2) = [1.0_wp, 0.0_wp]
      logical :: regular
      integer :: j, again

      call fill_tangent(self, k)
      call self%tangent%factor()
      positive = self%tangent%positive
      if (.not. positive) return
      self%found = 0.0_wp
      do again = 0, refinements
         do j = 1, 2
            call self%residual(self%found(:, j), k*self%found(:, j), force(j), self%missing(:, j))
            if (j == 2) self%missing(:, j) = self%missing(:, j) + r
            call along_joints(self%column%n, self%missing(:, j), self%more(:, j))
            if (self%column%held) self%more(self%unknowns, j) = 0.0_wp
         end do
         call self%tangent%solve(self%more, regular)
         call add_joints(self, self%more, self%found)
      end do
      rate = self%found(:, 1)
      correction = self%found(:, 2)
   end subroutine follow_force_banded

   !> Driven by the displacement: K rate = a dF and a rate = 1; K correction = r + a F', a correction = gap.
   subroutine follow_displacement(self, k, r, gap, rate, force_rate, correction, force_correction, regular)
      class(equilibrium_type), intent(inout) :: self
      !> Stiffness of the springs (2 n)
      real(wp), intent(in) :: k(:)
      !> Residual (2 n), and what is missing from the displacement [m]
      real(wp), intent(in) :: r(:), gap
      !> Change of the deformations per metre, and what takes the residuals away (2 n)
      real(wp), intent(out), contiguous :: rate(:), correction(:)
      !> Change of the force [N/m], and of the force with the correction [N]
      real(wp), intent(out) :: force_rate, force_correction
      !> Whether there is a unique solution
      logical, intent(out) :: regular
      real(wp) :: g(2), y(2)

      if (self%few%fits) then
         call self%few%solve(k, r, gap, rate, force_rate, correction, force_correction, regular)
      else if (self%coupled) then
         g = [1.0_wp, gap]
         self%wanted(:, 1) = 0.0_wp
         self%wanted(:, 2) = r
         call solve_banded(self, k, g, y, regular)
         if (.not. regular) return
         rate = self%found(:, 1)
         correction = self%found(:, 2)
         force_rate = y(1)
         force_correction = y(2)
      else
         call follow_diagonal(self%arm, self%initial_stiffness, k, r, gap, rate, force_rate, correction, &
                              force_correction, regular)
      end if
   end subroutine follow_displacement

   !> The same system as a band with its border.
   subroutine solve_banded(self, k, g, y, regular)
      type(equilibrium_type), intent(inout) :: self
      real(wp), intent(in) :: k(:), g(2)
      real(wp), intent(out) :: y(2)
      logical, intent(out) :: regular
      real(wp) :: gap(2), more_force(2)
      integer :: j, again

      call fill_tangent(self, k)
      call self%tangent%factor()
      call self%tangent%set_border(self%lever, regular=regular)
      if (.not. regular) return
      self%found = 0.0_wp
      y = 0.0_wp
      do again = 0, refinements
         do j = 1, 2
            call self%residual(self%found(:, j), k*self%found(:, j), y(j), self%missing(:, j))
            self%missing(:, j) = self%missing(:, j) + self%wanted(:, j)
            call along_joints(self%column%n, self%missing(:, j), self%along(:, j))
            if (self%column%held) self%along(self%unknowns, j) = 0.0_wp
            gap(j) = g(j) - sum(self%arm*self%found(:, j))
         end do
         call self%tangent%solve_bordered(self%along, gap, self%more, more_force, regular)
         if (.not. regular) return
         call add_joints(self, self%more, self%found)
         y = y + more_force
      end do
   end subroutine solve_banded

   !> Add changes in (slip, absolute rotation) to deformations of the joints.
   subroutine add_joints(self, z, q)
      type(equilibrium_type), intent(in) :: self
      real(wp), intent(in), contiguous :: z(:, :)
      real(wp), intent(inout) :: q(:, :)
      real(wp) :: change(self%unknowns)
      integer :: j

      do j = 1, size(z, 2)
         call to_joints(self%column, 2, z(:, j), change)
         q(:, j) = q(:, j) + change
      end do
   end subroutine add_joints

   !> The same in (slip, absolute rotation), joint by joint, as a band.
   subroutine fill_tangent(self, k)
      type(equilibrium_type), intent(inout) :: self
      !> Stiffness of the springs, by kind
      real(wp), intent(in) :: k(self%column%n, 2)
      integer :: i, n

      n = self%column%n
      associate (band => self%tangent%band, column => self%column)
         band = 0.0_wp
         do i = 1, n
            band(1, 2*i - 1) = k(i, shear)
            band(1, 2*i) = k(i, flexure) - column%axial_body(i)*column%length(i)
            if (i == n) exit
            band(1, 2*i) = band(1, 2*i) + k(i + 1, flexure)
            band(2, 2*i) = -column%axial_slip(i + 1)
            band(3, 2*i) = -k(i + 1, flexure)
         end do
      end associate
      if (self%column%held) call self%tangent%hold(2*n, self%tangent%stiffness(2*n))
   end subroutine fill_tangent

   !> Forces on (slip, absolute rotation), joint by joint, from those of the joints.
   pure subroutine along_joints(n, r, b)
      integer, intent(in) :: n
      !> By kind; joint by joint
      real(wp), intent(in) :: r(n, 2)
      real(wp), intent(out) :: b(2, n)
      integer :: i

      do i = 1, n
         b(:, i) = r(i, :)
         if (i < n) b(2, i) = b(2, i) - r(i + 1, flexure)
      end do
   end subroutine along_joints

   !> Joints one above the other that nothing couples, small rotations without axial load, driven by the
   !> displacement. They share the force, and their motions add up. The force is that of the most flexible
   !> joint p and what takes the others to it, F' = -r_p/a_p + F'': with F' itself, its motion
   !> (r_p + a_p F')/k_p would be a difference of round-off over next to nothing.
   pure subroutine follow_diagonal(arm, initial, k, r, gap, rate, force_rate, correction, force_correction, &
                                   regular)
      !> Arms of the force and initial stiffness of the joints (m)
      real(wp), intent(in) :: arm(:), initial(:)
      !> Stiffness of the springs, residual (m), and what is missing from the displacement [m]
      real(wp), intent(in) :: k(:), r(:), gap
      !> Change of the deformations per metre, and what takes the residuals away (m)
      real(wp), intent(out), contiguous :: rate(:), correction(:)
      !> Change of the force [N/m], and of the force with the correction [N]
      real(wp), intent(out) :: force_rate, force_correction
      !> Whether there is a unique solution
      logical, intent(out) :: regular
      real(wp) :: flexible(size(arm)), flexibility
      integer :: i, p

      regular = .true.
      p = 1
      do i = 1, size(arm)
         flexible(i) = 0.0_wp
         if (abs(k(i)) > no_stiffness*initial(i)) then
            flexible(i) = arm(i)**2/k(i)
            if (regular .and. abs(flexible(i)) > abs(flexible(p))) p = i
         else
            regular = .false.
            p = i
         end if
      end do
      if (regular) then
         ! Softening joints have a negative flexibility; with that of the others it may vanish.
         flexibility = sum(flexible)
         regular = abs(flexibility) > no_stiffness*sum(abs(flexible))
         if (.not. regular) return
         force_rate = 1.0_wp/flexibility
         rate = flexible/arm*force_rate
      else
         regular = .true.
         force_rate = 0.0_wp
         call follow_mechanism(arm, initial, flexible, rate)
      end if
      force_correction = -r(p)/arm(p)
      correction = flexible/arm*(r/arm + force_correction)
      associate (missing => gap - sum(arm*correction))
         correction = correction + rate*missing
         force_correction = force_correction + force_rate*missing
      end associate
   end subroutine follow_diagonal

   !> Joints without stiffness take all the motion. Several share it as they would with a hardening in
   !> proportion to their initial stiffness, however small.
   pure subroutine follow_mechanism(arm, initial, flexible, rate)
      real(wp), intent(in) :: arm(:), initial(:)
      !> Flexibility, 0 where there is no stiffness
      real(wp), intent(in) :: flexible(:)
      real(wp), intent(out) :: rate(:)

      rate = 0.0_wp
      where (.not. abs(flexible) > 0.0_wp) rate = arm/initial
      rate = rate/sum(arm*rate)
   end subroutine follow_mechanism

end module rbs_solve_static_equilibrium
