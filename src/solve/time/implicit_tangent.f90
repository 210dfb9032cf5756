!> The tangent of an implicit step: mass, damping and stiffness on the present lines of the springs, as a band
!> in centroid coordinates, and its factor.
module rbs_solve_time_implicit_tangent
   use rbs_base_kinds, only: wp
   use rbs_base_linalg, only: solve_general_band, solve_tridiagonal
   use rbs_base_narrow_band, only: factor_narrow_band, solve_narrow_band
   use rbs_column_band, only: add_spring_band, add_geometric_band, hold_last, opening_stiffness
   use rbs_column_column, only: column_type
   use rbs_solve_time_implicit_balance, only: step_balance
   use rbs_solve_time_loads, only: vertical, axial
   use rbs_solve_time_state, only: state_type
   implicit none
   private

   public :: step_tangent

   type :: step_tangent
      !> Diagonal of the tangent (2 n), and that of the openings (n)
      real(wp), allocatable :: stiffness(:), diagonal(:)
      !> Factor (4, 2 n), or the band itself where it is not positive definite
      real(wp), allocatable :: factor(:, :)
      logical :: positive = .true.
      !> Numbers beside the diagonal of the openings (n - 1); what each joint adds (unknowns)
      real(wp), allocatable, private :: beside(:), k(:)
      !> Step and lines that the factor belongs to
      real(wp), private :: factor_step = -1.0_wp
      integer, private :: factor_version = -1
      !> Work arrays: band (4, 2 n), band with room for pivots (10, 2 n), right-hand side (2 n, 1), diagonal
      !> and the numbers beside it, which a solution spoils
      real(wp), allocatable, private :: band(:, :), general(:, :), right(:, :)
      real(wp), allocatable, private :: spoilt_diagonal(:), spoilt_beside(:)
   contains
      procedure :: create
      procedure :: find_correction
      procedure :: fit
   end type step_tangent

contains

   subroutine create(self, column)
      class(step_tangent), intent(out) :: self
      type(column_type), intent(in) :: column
      integer :: n

      n = column%n
      allocate (self%stiffness(2*n), self%k(column%unknowns), self%factor(4, 2*n), self%band(4, 2*n), &
                self%general(10, 2*n), self%right(2*n, 1), source=0.0_wp)
      allocate (self%diagonal(n), self%beside(max(n - 1, 1)), self%spoilt_diagonal(n), &
                self%spoilt_beside(max(n - 1, 1)), source=0.0_wp)
   end subroutine create

   !> The correction that takes the residual away as long as no line changes. The tangent is factored anew
   !> only if a line, the step or the axial load has changed.
   subroutine find_correction(self, step, state, h, dx)
      class(step_tangent), intent(inout) :: self
      type(step_balance), intent(in) :: step
      type(state_type), intent(in) :: state
      real(wp), intent(in) :: h
      !> Of the bodies (unknowns)
      real(wp), intent(out), contiguous :: dx(:)
      logical :: regular
      integer :: n

      n = state%motion%column%n
      call self%fit(step, state, h)
      dx = step%r
      if (self%positive) then
         call solve_narrow_band(2*n, self%factor, dx(:2*n))
      else
         ! The column softens more than its inertia holds: elimination with pivots.
         call spread_band(self%factor, self%general)
         self%right(:, 1) = dx(:2*n)
         call solve_general_band(self%general, 3, 3, self%right, regular)
         dx(:2*n) = self%right(:, 1)
      end if
      if (.not. state%motion%column%opens) return
      self%spoilt_diagonal(:) = self%diagonal
      self%spoilt_beside(:) = self%beside
      call solve_tridiagonal(self%spoilt_diagonal, self%spoilt_beside(:n - 1), dx(2*n + 1:), regular)
   end subroutine find_correction

   !> Factor the tangent anew, if a line, the step or the axial load has changed.
   subroutine fit(self, step, state, h)
      class(step_tangent), intent(inout) :: self
      type(step_balance), intent(in) :: step
      type(state_type), intent(in) :: state
      real(wp), intent(in) :: h

      if (is_stale(self, state, h)) call set_tangent(self, step, state, h)
   end subroutine fit

   pure logical function is_stale(self, state, h)
      type(step_tangent), intent(in) :: self
      type(state_type), intent(in) :: state
      real(wp), intent(in) :: h

      is_stale = state%springs%version /= self%factor_version .or. &
                 abs(h - self%factor_step) > 1.0e-14_wp*h
      if (state%motion%second_order) then
         is_stale = is_stale .or. state%motion%acts(vertical) .or. state%motion%acts(axial)
      end if
   end function is_stale

   !> Tangent of the step on the present lines, and its factor.
   subroutine set_tangent(self, step, state, h)
      type(step_tangent), intent(inout) :: self
      type(step_balance), intent(in) :: step
      type(state_type), intent(in) :: state
      real(wp), intent(in) :: h
      real(wp) :: of_mass, of_damping
      integer :: n

      n = state%motion%column%n
      of_damping = (1.0_wp - step%alpha_f)*step%gamma/(step%beta*h)
      of_mass = (1.0_wp - step%alpha_m)/(step%beta*h**2) + of_damping*state%motion%column%mass_damping
      associate (motion => state%motion, springs => state%springs)
         self%k = (1.0_wp - step%alpha_f)*springs%k
         if (motion%column%tangent_damping) then
            self%k = self%k + (of_damping*motion%column%stiffness_damping)*max(springs%k, 0.0_wp)
         else if (motion%damped) then
            self%k = self%k + of_damping*motion%joint_damping
         end if
         self%factor = 0.0_wp
         call add_spring_band(motion%column, self%k(:2*n), self%factor)
         if (motion%second_order) then
            call add_geometric_band(motion%column, (1.0_wp - step%alpha_f)*step%now%axial_body, &
                                    (1.0_wp - step%alpha_f)*step%now%axial_joint, self%factor)
         end if
         self%factor(1, :) = self%factor(1, :) + of_mass*step%mass(:2*n)
         if (motion%column%opens) then
            call opening_stiffness(motion%column, self%k(2*n + 1:), self%diagonal, self%beside(:n - 1))
            self%diagonal = self%diagonal + of_mass*step%mass(2*n + 1:)
         end if
      end associate
      if (state%motion%column%held) call hold_last(self%factor, of_mass*step%mass(2*n))
      self%stiffness = self%factor(1, :)
      if (springs_soften(state)) then
         self%band(:, :) = self%factor
         call factor_narrow_band(2*n, self%factor, self%positive)
         if (.not. self%positive) self%factor(:, :) = self%band
      else
         call factor_narrow_band(2*n, self%factor, self%positive)
      end if
      self%factor_step = h
      self%factor_version = state%springs%version
   end subroutine set_tangent

   pure logical function springs_soften(state)
      type(state_type), intent(in) :: state

      springs_soften = state%motion%second_order .or. any(state%springs%k < 0.0_wp)
   end function springs_soften

   !> A symmetric band as `solve_general_band` wants it.
   subroutine spread_band(band, general)
      real(wp), intent(in) :: band(:, :)
      !> (10, size)
      real(wp), intent(out) :: general(:, :)
      integer :: i, j, m

      m = size(band, 2)
      general = 0.0_wp
      do j = 1, m
         do i = j, min(j + 3, m)
            general(7 + i - j, j) = band(1 + i - j, j)
            general(7 + j - i, i) = band(1 + i - j, j)
         end do
      end do
   end subroutine spread_band

end module rbs_solve_time_implicit_tangent
