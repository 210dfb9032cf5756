!> The column itself is a straight line with two ends.
!>
!> While every spring stays on its line, deformations and lateral force are linear in what is driven
!> (displacement or force of the top). This module finds that line: exactly, without increments.
!>
!>     K q - a F = r,   a q = x        K = diag(k) + K_G,  a = arms of the lateral force F
module rbs_solve_equilibrium
   use rbs_base_kinds, only: wp
   use rbs_base_linalg, only: factor_positive, solve_positive, solve_general
   use rbs_column_axial, only: geometric_stiffness, geometric_forces
   use rbs_column_column, only: column_type
   implicit none
   private

   public :: equilibrium_type

   !> A pivot below this share of the initial stiffness is round-off.
   real(wp), parameter :: no_stiffness = 1.0e-12_wp

   type :: equilibrium_type
      !> Number of unknowns
      integer :: unknowns = 0
      !> The column, and of it the displacement of the top per unknown (2 n)
      type(column_type) :: column
      real(wp), allocatable :: arm(:)
      !> Whether the geometric stiffness takes part; if not, K is diagonal and nothing is factored
      logical :: coupled = .false.
      !> Geometric stiffness (2 n, 2 n), allocated only if it takes part
      real(wp), allocatable :: geometric(:, :)
      !> Initial stiffness (2 n): shares the motion between joints that have none left
      real(wp), allocatable :: initial_stiffness(:)
   contains
      procedure :: create
      procedure :: residual
      procedure :: follow_force
      procedure :: follow_displacement
   end type equilibrium_type

contains

   subroutine create(self, column)
      class(equilibrium_type), intent(out) :: self
      type(column_type), intent(in) :: column

      self%unknowns = column%unknowns
      self%column = column
      self%arm = column%arm
      self%initial_stiffness = column%initial_stiffness
      self%coupled = column%axially_loaded
      if (self%coupled) then
         allocate (self%geometric(self%unknowns, self%unknowns))
         call geometric_stiffness(column, self%geometric)
      end if
   end subroutine create

   !> What is missing to equilibrium: a F - f - K_G q.
   subroutine residual(self, q, f, force, r)
      class(equilibrium_type), intent(in) :: self
      !> Deformations and forces of the springs (2 n)
      real(wp), intent(in) :: q(:), f(:)
      !> Lateral force [N]
      real(wp), intent(in) :: force
      !> Residual (2 n)
      real(wp), intent(out) :: r(:)
      real(wp) :: g(self%unknowns)

      r = self%arm*force - f
      if (self%coupled) then
         call geometric_forces(self%column, q, g)
         r = r - g
      end if
   end subroutine residual

   !> Driven by the force: K rate = a and K correction = r.
   subroutine follow_force(self, k, r, rate, correction, weakest)
      class(equilibrium_type), intent(in) :: self
      !> Stiffness of the springs (2 n)
      real(wp), intent(in) :: k(:)
      !> Residual (2 n)
      real(wp), intent(in) :: r(:)
      !> Change of the deformations per newton, and what takes the residual away (2 n)
      real(wp), intent(out) :: rate(:), correction(:)
      !> 0 if the column is stable; else the spring with the least stiffness
      integer, intent(out) :: weakest
      real(wp), allocatable :: a(:, :)
      logical :: positive
      integer :: i

      weakest = 0
      if (.not. self%coupled) then
         if (minval(k) > 0.0_wp) then
            rate = self%arm/k
            correction = r/k
            return
         end if
      else
         a = tangent(self, k)
         call factor_positive(a, positive)
         if (positive) then
            do i = 1, self%unknowns
               positive = positive .and. a(i, i)**2 > no_stiffness*self%initial_stiffness(i)
            end do
         end if
         if (positive) then
            rate = self%arm
            correction = r
            call solve_positive(a, rate)
            call solve_positive(a, correction)
            return
         end if
      end if
      weakest = minloc(k/self%initial_stiffness, dim=1)
      rate = 0.0_wp
      correction = 0.0_wp
   end subroutine follow_force

   !> Driven by the displacement: K rate = a dF and a rate = 1; K correction = r + a F', a correction = gap.
   subroutine follow_displacement(self, k, r, gap, rate, force_rate, correction, force_correction, regular)
      class(equilibrium_type), intent(in) :: self
      !> Stiffness of the springs (2 n)
      real(wp), intent(in) :: k(:)
      !> Residual (2 n), and what is missing to the displacement [m]
      real(wp), intent(in) :: r(:), gap
      !> Change of the deformations per metre, and what takes the residuals away (2 n)
      real(wp), intent(out) :: rate(:), correction(:)
      !> Change of the force [N/m], and of the force with the correction [N]
      real(wp), intent(out) :: force_rate, force_correction
      !> Whether there is one answer
      logical, intent(out) :: regular
      real(wp), allocatable :: a(:, :), b(:, :)
      real(wp) :: flexibility
      integer :: m

      m = self%unknowns
      if (self%coupled) then
         allocate (a(m + 1, m + 1), b(m + 1, 2))
         a(:m, :m) = tangent(self, k)
         a(:m, m + 1) = -self%arm
         a(m + 1, :m) = self%arm
         a(m + 1, m + 1) = 0.0_wp
         b(:, 1) = 0.0_wp
         b(m + 1, 1) = 1.0_wp
         b(:m, 2) = r
         b(m + 1, 2) = gap
         call solve_general(a, b, regular)
         rate = b(:m, 1)
         force_rate = b(m + 1, 1)
         correction = b(:m, 2)
         force_correction = b(m + 1, 2)
      else if (minval(k) > 0.0_wp) then
         regular = .true.
         flexibility = sum(self%arm**2/k)
         force_rate = 1.0_wp/flexibility
         rate = self%arm/k*force_rate
         correction = r/k
         force_correction = (gap - sum(self%arm*correction))*force_rate
         correction = correction + self%arm/k*force_correction
      else
         regular = .true.
         call follow_mechanism(self, k, rate)
         force_rate = 0.0_wp
         force_correction = 0.0_wp
         where (k > 0.0_wp)
            correction = r/max(k, tiny(1.0_wp))
         else where
            correction = 0.0_wp
         end where
         correction = correction + rate*(gap - sum(self%arm*correction))
      end if
   end subroutine follow_displacement

   !> Joints without stiffness take all the motion. Several share it as they would with a hardening in
   !> proportion to their initial stiffness, however small.
   subroutine follow_mechanism(self, k, rate)
      type(equilibrium_type), intent(in) :: self
      real(wp), intent(in) :: k(:)
      real(wp), intent(out) :: rate(:)

      rate = 0.0_wp
      where (.not. k > 0.0_wp) rate = self%arm/self%initial_stiffness
      rate = rate/sum(self%arm*rate)
   end subroutine follow_mechanism

   !> Tangent stiffness diag(k) + K_G.
   function tangent(self, k) result(a)
      type(equilibrium_type), intent(in) :: self
      real(wp), intent(in) :: k(:)
      real(wp), allocatable :: a(:, :)
      integer :: i

      a = self%geometric
      do i = 1, self%unknowns
         a(i, i) = a(i, i) + k(i)
      end do
   end function tangent

end module rbs_solve_equilibrium
