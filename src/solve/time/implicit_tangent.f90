!> The tangent of an implicit step: mass, damping and stiffness on the present lines of the springs, as a band
!> in centroid coordinates, and its factor.
module rbs_solve_time_implicit_tangent
   use rbs_base_band_matrix, only: band_matrix
   use rbs_base_kinds, only: wp
   use rbs_column_band, only: add_spring_band, add_geometric_band, opening_band
   use rbs_column_column, only: column_type
   use rbs_solve_time_implicit_balance, only: step_balance
   use rbs_loading_loads, only: vertical, axial
   use rbs_solve_time_state, only: state_type
   implicit none
   private

   public :: step_tangent

   type :: step_tangent
      !> Diagonal of the tangent (unknowns)
      real(wp), allocatable :: stiffness(:)
      !> Of slips and rotations, and of the openings
      type(band_matrix) :: lateral
      type(band_matrix), private :: openings
      !> What each joint adds (unknowns)
      real(wp), allocatable, private :: k(:)
      !> Step and lines that the factor belongs to
      real(wp), private :: factor_step = -1.0_wp
      integer, private :: factor_version = -1
   contains
      procedure :: create
      procedure :: find_correction
      procedure :: fit
   end type step_tangent

contains

   subroutine create(self, column)
      class(step_tangent), intent(out) :: self
      type(column_type), intent(in) :: column

      allocate (self%stiffness(column%unknowns), self%k(column%unknowns), source=0.0_wp)
      call self%lateral%create(2*column%n, 3)
      if (column%opens) call self%openings%create(column%n, 1)
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

      call self%fit(step, state, h)
      dx = step%r
      call self%lateral%solve(dx(:self%lateral%size), regular)
      if (state%motion%column%opens) call self%openings%solve(dx(self%lateral%size + 1:), regular)
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
         self%lateral%band = 0.0_wp
         call add_spring_band(motion%column, self%k(:2*n), self%lateral%band)
         if (motion%second_order) then
            call add_geometric_band(motion%column, (1.0_wp - step%alpha_f)*step%now%axial_body, &
                                    (1.0_wp - step%alpha_f)*step%now%axial_joint, self%lateral%band)
         end if
         self%lateral%band(1, :) = self%lateral%band(1, :) + of_mass*step%mass(:2*n)
         if (motion%column%held) call self%lateral%hold_last(of_mass*step%mass(2*n))
         self%stiffness(:2*n) = self%lateral%band(1, :)
         call self%lateral%factor()
         if (motion%column%opens) then
            call opening_band(motion%column, self%k(2*n + 1:), self%openings%band)
            self%openings%band(1, :) = self%openings%band(1, :) + of_mass*step%mass(2*n + 1:)
            self%stiffness(2*n + 1:) = self%openings%band(1, :)
            call self%openings%factor()
         end if
      end associate
      self%factor_step = h
      self%factor_version = state%springs%version
   end subroutine set_tangent

end module rbs_solve_time_implicit_tangent
