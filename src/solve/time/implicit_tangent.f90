!> The tangent of an implicit step: mass, damping and stiffness on the present lines of the springs, as a band
!> in the unknowns of the structure, and its factor.
module rbs_solve_time_implicit_tangent
   use rbs_base_band_matrix, only: band_matrix
   use rbs_base_constants, only: no_stiffness
   use rbs_base_kinds, only: wp
   use rbs_solve_time_implicit_balance, only: step_balance
   use rbs_solve_time_state, only: state_type
   use rbs_structure_structure, only: structure_type, signals
   implicit none
   private

   public :: step_tangent

   !> A rotation without mass that hinges leave free is held by this share of the initial stiffness.
   real(wp), parameter :: held_by = 1.0e-9_wp

   type :: step_tangent
      !> Diagonal of the tangent (unknowns)
      real(wp), allocatable :: stiffness(:)
      type(band_matrix) :: matrix
      !> Initial diagonal of unknowns without mass whose elements yield, 0 of the others (unknowns)
      real(wp), allocatable, private :: initial(:)
      !> What each spring adds (springs)
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

   subroutine create(self, structure)
      class(step_tangent), intent(out) :: self
      class(structure_type), intent(in) :: structure

      allocate (self%stiffness(structure%unknowns), self%k(size(structure%place)), source=0.0_wp)
      call self%matrix%create(structure%unknowns, structure%half_width)
      if (structure%tangent_numbers == 0) return
      call structure%add_stiffness(structure%initial_stiffness, structure%initial_tangent, self%matrix%band)
      self%initial = merge(0.0_wp, self%matrix%band(1, :), structure%inertias > 0.0_wp)
   end subroutine create

   !> The correction that takes the residual away as long as no line changes. The tangent is factored anew
   !> only if a line, the step or the axial load has changed.
   subroutine find_correction(self, step, state, h, dx)
      class(step_tangent), intent(inout) :: self
      type(step_balance), intent(inout) :: step
      type(state_type), intent(in) :: state
      real(wp), intent(in) :: h
      !> Of the unknowns (unknowns)
      real(wp), intent(out), contiguous :: dx(:)
      logical :: regular

      call self%fit(step, state, h)
      dx = step%r
      call self%matrix%solve(dx, regular)
   end subroutine find_correction

   !> Factor the tangent anew, if a line, the step or the axial load has changed.
   subroutine fit(self, step, state, h)
      class(step_tangent), intent(inout) :: self
      type(step_balance), intent(inout) :: step
      type(state_type), intent(in) :: state
      real(wp), intent(in) :: h

      real(wp) :: relative, load(signals)

      if (.not. is_stale(self, state, h)) return
      call set_tangent()
      ! What lies between the unknowns is condensed by the new tangent.
      if (size(step%now%tangent) == 0) return
      load = step%load
      call step%find_residual(state, h, load, relative)

   contains

      !> Tangent of the step on the present lines, and its factor.
      subroutine set_tangent()
         real(wp) :: of_mass, of_damping
         integer :: i, unstable

         of_damping = (1.0_wp - step%alpha_f)*step%gamma/(step%beta*h)
         of_mass = (1.0_wp - step%alpha_m)/(step%beta*h**2) + of_damping*state%motion%structure%mass_damping
         associate (motion => state%motion, springs => state%springs, structure => state%motion%structure)
            self%k = (1.0_wp - step%alpha_f)*springs%k
            if (structure%tangent_numbers > 0) then
               call structure%linearise(self%k, step%now%tangent, unstable)
            else if (structure%tangent_damping) then
               self%k = self%k + (of_damping*structure%stiffness_damping)*max(springs%k, 0.0_wp)
            else if (motion%damped) then
               self%k = self%k + of_damping*motion%joint_damping
            end if
            self%matrix%band = 0.0_wp
            call structure%add_stiffness(self%k, step%now%tangent, self%matrix%band)
            if (structure%stiffness_damping > 0.0_wp) then
               call structure%add_damping(of_damping, step%now%tangent, self%matrix%band)
            end if
            if (motion%second_order) then
               call structure%add_geometric((1.0_wp - step%alpha_f)*step%now%axial, self%matrix%band)
            end if
            self%matrix%band(1, :) = self%matrix%band(1, :) + of_mass*structure%inertias
            if (structure%has_held) then
               do i = 1, structure%unknowns
                  if (structure%is_held(i)) call self%matrix%hold(i, of_mass*structure%inertias(i))
               end do
            end if
            self%stiffness = self%matrix%band(1, :)
            call self%matrix%factor()
            if (allocated(self%initial)) call hold_free()
         end associate
         self%factor_step = h
         self%factor_version = state%springs%version
      end subroutine set_tangent

      !> Where the pivot of an unknown without mass is round-off, it stays where it is.
      subroutine hold_free()

         associate (inverse => abs(self%matrix%triangle(1, :)), initial => self%initial)
            if (all(no_stiffness*initial*inverse <= 1.0_wp)) return
            where (no_stiffness*initial*inverse > 1.0_wp) self%matrix%band(1, :) = self%matrix%band(1, :) &
                                                                                    + held_by*initial
            call self%matrix%factor()
         end associate
      end subroutine hold_free

   end subroutine fit

   pure logical function is_stale(self, state, h)
      type(step_tangent), intent(in) :: self
      type(state_type), intent(in) :: state
      real(wp), intent(in) :: h

      is_stale = state%springs%version /= self%factor_version .or. &
                 abs(h - self%factor_step) > 1.0e-14_wp*h
      if (state%motion%second_order) is_stale = is_stale .or. state%motion%varies
   end function is_stale

end module rbs_solve_time_implicit_tangent
