!> Newmark's method and the generalised-alpha method (HHT is a case of it) in centroid coordinates, where
!> mass and tangent are bands: O(n) a step, no limit of stability.
!>
!>     (1 - am) M a1 + am M a0 = (1 - af) G(q1, v1, t1) + af G(q0, v0, t0)
!>     x1 = x0 + h v0 + h^2 ((1/2 - b) a0 + b a1),   v1 = v0 + h ((1 - g) a0 + g a1)
!>
!> with G the forces on the bodies (J. Chung, G. M. Hulbert, J. Appl. Mech. 60 (1993)). The springs are
!> straight lines, so the tangent step is exact up to the next end of a line. Where Newton's method goes back
!> and forth between two branches, the solution goes from end to end instead. A step that does not converge
!> is taken back to the stored state and cut in two.
module rbs_solve_time_implicit
   use rbs_base_error, only: error_type, fatal_error, analysis_failed
   use rbs_base_kinds, only: wp
   use rbs_base_linalg, only: solve_general_band, solve_tridiagonal
   use rbs_base_narrow_band, only: factor_narrow_band, solve_narrow_band
   use rbs_base_text, only: to_text
   use rbs_column_band, only: add_spring_band, add_geometric_band, opening_stiffness, to_joints
   use rbs_column_chain, only: body_velocities
   use rbs_column_column, only: joint_name
   use rbs_solve_time_loads, only: lateral, horizontal, vertical, axial
   use rbs_solve_time_motion, only: motion_result
   use rbs_solve_time_state, only: state_type, stepper_type, in_bounds, out_of_bounds
   implicit none
   private

   public :: implicit_stepper, new_newmark, new_generalised_alpha, new_hht

   !> What round-off leaves of the terms of a sum, as a share of the largest.
   real(wp), parameter :: round_off = 32.0_wp*epsilon(1.0_wp)

   !> Trials of Newton's method, which mostly needs two or three; a step is cut in halves this often.
   integer, parameter :: most_iterations = 40, most_cuts = 24

   !> Trials in which Newton's method may go too far.
   integer, parameter :: most_free = 8

   type, extends(stepper_type) :: implicit_stepper
      !> Parameters of the method; those of Newmark's average acceleration
      real(wp) :: alpha_m = 0.0_wp, alpha_f = 0.0_wp, beta = 0.25_wp, gamma = 0.5_wp
      !> Most changes of lines within a step; 0: what the number of springs allows for
      integer :: most_changes = 0
      !> The residual is gone below this share of the forces; where round-off does not let it, below the
      !> second
      real(wp) :: wanted = 1.0e-12_wp, acceptable = 1.0e-7_wp
      logical, private :: ready = .false.
      !> Forces on the bodies at the present trial
      type(motion_result), private :: now
      !> Velocities, accelerations and forces of the bodies at the begin of a step, and at its end
      !> (unknowns), in the order x_1, th_1, x_2, ... [, y_1, ...]
      real(wp), allocatable, private :: v0(:), a0(:), g0(:), v1(:), a1(:), g1(:)
      !> Mass in that order
      real(wp), allocatable, private :: mass(:)
      !> Largest force, moment and lift of the present trial and of all steps so far. Residuals are measured
      !> by them: where a motion passes through zero, or springs and damping take each other away, all
      !> forces of the moment are round-off.
      real(wp), private :: scale(3) = 0.0_wp, largest(3) = 0.0_wp
      !> Residual, correction, and what the bodies have moved in the step (unknowns)
      real(wp), allocatable, private :: r(:), dx(:), moved(:)
      !> Deformations, velocities and correction of the joints (unknowns)
      real(wp), allocatable, private :: q1(:), w1(:), dq(:)
      !> Factor of the tangent (4, 2 n) and of what step and line changes; tangent of the openings
      real(wp), allocatable, private :: factor(:, :), diagonal(:), beside(:), k(:)
      !> Diagonal of the tangent (2 n)
      real(wp), allocatable, private :: stiffness(:)
      real(wp), private :: factor_step = -1.0_wp
      integer, private :: factor_version = -1
      logical, private :: positive = .true.
   contains
      procedure :: advance
   end type implicit_stepper

contains

   !> Newmark's average acceleration.
   function new_newmark() result(stepper)
      type(implicit_stepper) :: stepper

      stepper%beta = 0.25_wp
   end function new_newmark

   !> Generalised-alpha with the least damping of low frequencies for a spectral radius at infinite
   !> frequency.
   function new_generalised_alpha(rho) result(stepper)
      !> From 0 (all damped in one step) to 1 (no damping)
      real(wp), intent(in) :: rho
      type(implicit_stepper) :: stepper

      stepper%alpha_m = (2.0_wp*rho - 1.0_wp)/(rho + 1.0_wp)
      stepper%alpha_f = rho/(rho + 1.0_wp)
      stepper%gamma = 0.5_wp - stepper%alpha_m + stepper%alpha_f
      stepper%beta = 0.25_wp*(1.0_wp - stepper%alpha_m + stepper%alpha_f)**2
   end function new_generalised_alpha

   !> The method of Hilber, Hughes and Taylor (1977): alpha_f = (1 - rho)/(1 + rho) = -alpha of the authors.
   function new_hht(rho) result(stepper)
      !> From 1/2 to 1
      real(wp), intent(in) :: rho
      type(implicit_stepper) :: stepper

      stepper%alpha_f = (1.0_wp - rho)/(1.0_wp + rho)
      stepper%gamma = 0.5_wp + stepper%alpha_f
      stepper%beta = 0.25_wp*(1.0_wp + stepper%alpha_f)**2
   end function new_hht

   subroutine advance(self, state, h, error)
      class(implicit_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state
      real(wp), intent(in) :: h
      type(error_type), allocatable, intent(inout) :: error
      real(wp) :: finish

      if (allocated(error)) return
      if (.not. self%ready) call start(self, state)
      finish = state%time + h
      call move_on(self, state, h, 0, error)
      if (.not. allocated(error)) state%time = finish
   end subroutine advance

   !> Velocities and accelerations of the bodies at the begin of the first step.
   subroutine start(self, state)
      type(implicit_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state
      integer :: m, n, i

      n = state%motion%column%n
      m = state%motion%column%unknowns
      allocate (self%v0(m), self%a0(m), self%g0(m), self%v1(m), self%a1(m), self%g1(m), self%mass(m), &
                self%r(m), self%dx(m), self%moved(m), self%q1(m), self%w1(m), self%dq(m), self%k(m), &
                source=0.0_wp)
      allocate (self%factor(4, 2*n), source=0.0_wp)
      allocate (self%diagonal(n), self%beside(max(n - 1, 1)), source=0.0_wp)
      do i = 1, n
         self%mass(2*i - 1) = state%motion%column%mass(i)
         self%mass(2*i) = state%motion%column%inertia(i)
         if (state%motion%column%opens) self%mass(2*n + i) = state%motion%column%mass(i)
      end do
      call self%now%create(state%motion%column)
      call body_velocities(state%motion%column, state%v, self%v0)
      call find_forces(state, self%mass, state%q, state%v, self%v0, state%load, self%now, self%g0)
      self%a0 = self%g0/self%mass
      call find_scale(n, m, self%mass, self%a0, self%g0, self%now%f, state%load(lateral), &
                      state%motion%column%upper(n), self%largest)
      self%ready = .true.
   end subroutine start

   !> Forces on the bodies, inertia of the ground and damping included.
   subroutine find_forces(state, mass, q, w, v, load, now, g)
      type(state_type), intent(in) :: state
      !> Mass, deformations and velocities of the joints, velocities of the bodies (unknowns)
      real(wp), intent(in), contiguous :: mass(:), q(:), w(:), v(:)
      real(wp), intent(in) :: load(4)
      type(motion_result), intent(inout) :: now
      real(wp), intent(out), contiguous :: g(:)
      integer :: i, n

      n = state%motion%column%n
      associate (motion => state%motion)
         call motion%forces_on_bodies(state%springs, q, w, load, now)
         do i = 1, n
            g(2*i - 1) = now%force(i) - motion%column%mass(i)*load(horizontal)
            g(2*i) = now%torque(i)
         end do
         if (motion%column%opens) g(2*n + 1:) = now%lift - motion%column%mass*load(vertical)
         if (motion%column%mass_damping > 0.0_wp) g = g - motion%column%mass_damping*mass*v
      end associate
   end subroutine find_forces

   !> Take a step, or its two halves if it does not converge.
   recursive subroutine move_on(self, state, h, cuts, error)
      type(implicit_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state
      real(wp), intent(in) :: h
      !> How often the step has been cut already
      integer, intent(in) :: cuts
      type(error_type), allocatable, intent(inout) :: error
      real(wp) :: load(4)
      integer :: busiest
      logical :: converged

      call state%loads%at_time(state%time + h, load)
      call solve_step(self, state, h, load, converged, busiest)
      if (converged) then
         call commit(self, state, h, load)
         return
      end if
      self%cut_steps = self%cut_steps + 1
      if (cuts == most_cuts) then
         call fatal_error(error, analysis_failed, 'the step of '//to_text(h)//' s at time '// &
                          to_text(state%begin + state%time)//' s does not converge although it was cut '// &
                          to_text(most_cuts)//' times; '// &
                          trim(joint_name(state%motion%column, max(busiest, 1)))// &
                          ' is the busiest. Rows up to there are kept, the last good state is that of '// &
                          "this time. Try a shorter dt or method = 'rk45', and look at the springs "// &
                          'that soften')
         return
      end if
      call move_on(self, state, 0.5_wp*h, cuts + 1, error)
      if (.not. allocated(error)) call move_on(self, state, 0.5_wp*h, cuts + 1, error)
   end subroutine move_on

   !> Find the end of a step of h. If it is not found, the springs are as before.
   subroutine solve_step(self, state, h, load, converged, busiest)
      type(implicit_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state
      real(wp), intent(in) :: h, load(4)
      logical, intent(out) :: converged
      !> The spring that changed its line last, 0 for none
      integer, intent(out) :: busiest
      logical :: marked

      marked = .false.
      busiest = 0
      call iterate(self, state, h, load, converged, marked)
      if (.not. converged .and. marked) then
         call state%springs%restore()
         call go_by_events(self, state, h, load, converged, busiest)
         if (.not. converged) call state%springs%restore()
      end if
      if (marked) call state%springs%forget_mark()
   end subroutine solve_step

   !> Newton's method with a line search. Every trial goes from the state at the begin of the step, springs
   !> in one way each, so that what was tried leaves no trace; and the forces of springs that do not soften
   !> then have a convex potential, on which this converges.
   subroutine iterate(self, state, h, load, converged, marked)
      type(implicit_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state
      real(wp), intent(in) :: h, load(4)
      logical, intent(out) :: converged
      !> Whether springs have changed their lines, and a mark was set
      logical, intent(inout) :: marked
      real(wp) :: size_now, size_before, slope_before, slope, too_far
      integer :: iteration, most

      converged = .false.
      self%moved = 0.0_wp
      self%q1 = state%q
      most = most_iterations
      if (self%most_changes > 0) most = self%most_changes
      ! Modal damping is not in the tangent: its share goes with the damping ratio every time.
      if (allocated(state%motion%modal)) most = 10*most
      call find_residual(self, state, h, load, size_now)
      do iteration = 1, most
         size_before = size_now
         call find_correction(self, state, h)
         call to_joints(state%motion%column, self%dx, self%dq)
         slope_before = product_of(size(self%r), self%r, self%dx)
         call try(self, state, h, load, 1.0_wp, marked, size_now)
         if (.not. size_now < out_of_bounds) return
         converged = has_converged(self, h, size_now, size_before)
         if (converged) return
         slope = product_of(size(self%r), self%r, self%dx)
         ! Too far is mostly no harm; where Newton's method has gone back and forth, it is made certain of.
         too_far = merge(0.9_wp, 0.05_wp, iteration <= most_free)
         if (slope < -too_far*slope_before) then
            call search_line(self, state, h, load, slope_before, slope, too_far/3.0_wp, marked, size_now)
         end if
         if (state%springs%stuck) return
      end do
   end subroutine iterate

   !> The trial has gone too far: find the share of the correction at which the residual does little work
   !> on it, by false position (Illinois).
   subroutine search_line(self, state, h, load, slope_before, slope_at_end, share_left, marked, size_now)
      type(implicit_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state
      real(wp), intent(in) :: h, load(4)
      !> Work of the residual on the correction at its begin and at its end
      real(wp), intent(in) :: slope_before, slope_at_end
      !> What of the first may be left
      real(wp), intent(in) :: share_left
      logical, intent(inout) :: marked
      real(wp), intent(inout) :: size_now
      real(wp) :: low, high, at_low, at_high, share, slope, now
      integer :: trial

      low = 0.0_wp
      high = 1.0_wp
      at_low = slope_before
      at_high = slope_at_end
      now = 1.0_wp
      do trial = 1, 8
         share = low + (high - low)*at_low/(at_low - at_high)
         call try(self, state, h, load, share - now, marked, size_now)
         now = share
         slope = product_of(size(self%r), self%r, self%dx)
         if (abs(slope) <= share_left*slope_before .or. state%springs%stuck) return
         if (slope > 0.0_wp) then
            low = share
            at_low = slope
            at_high = 0.5_wp*at_high
         else
            high = share
            at_high = slope
            at_low = 0.5_wp*at_low
         end if
      end do
   end subroutine search_line

   !> Go a share of the correction on (or back), and find the residual there.
   subroutine try(self, state, h, load, share, marked, size_now)
      type(implicit_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state
      real(wp), intent(in) :: h, load(4), share
      logical, intent(inout) :: marked
      real(wp), intent(out) :: size_now

      size_now = huge(1.0_wp)
      self%q1 = self%q1 + share*self%dq
      self%moved = self%moved + share*self%dx
      if (.not. in_bounds(size(self%q1), self%q1)) return
      if (marked .or. .not. state%springs%stay_on_lines(self%q1)) then
         if (marked) then
            call state%springs%restore()
         else
            call state%springs%mark()
            marked = .true.
         end if
         call state%springs%move_all(self%q1)
      end if
      call find_residual(self, state, h, load, size_now)
   end subroutine try

   pure real(wp) function product_of(m, a, b)
      integer, intent(in) :: m
      real(wp), intent(in) :: a(m), b(m)
      real(wp) :: part(4)
      integer :: i

      part = 0.0_wp
      do i = 1, m - 3, 4
         part = part + a(i:i + 3)*b(i:i + 3)
      end do
      product_of = sum(part)
      do i = m - mod(m, 4) + 1, m
         product_of = product_of + a(i)*b(i)
      end do
   end function product_of

   !> The same from end to end of the springs' lines. On the lines of a moment the tangent step is exact, so
   !> the residual goes down in proportion to the way, and no line is taken up twice.
   subroutine go_by_events(self, state, h, load, converged, busiest)
      type(implicit_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state
      real(wp), intent(in) :: h, load(4)
      logical, intent(out) :: converged
      integer, intent(out) :: busiest
      real(wp) :: share, size_now, size_before
      integer :: iteration, most, i, way

      converged = .false.
      busiest = 0
      self%moved = 0.0_wp
      self%q1 = state%q
      most = self%most_changes
      if (most == 0) most = 100 + 20*state%springs%count
      size_before = huge(1.0_wp)
      call find_residual(self, state, h, load, size_now)
      do iteration = 1, most
         call find_correction(self, state, h)
         call to_joints(state%motion%column, self%dx, self%dq)
         call first_end(state, self%q1, self%dq, share, i, way)
         self%q1 = self%q1 + share*self%dq
         self%moved = self%moved + share*self%dx
         if (i > 0) then
            busiest = i
            call state%springs%carry_to(self%q1)
            call state%springs%leave(i, way)
            self%q1(i) = state%springs%d(i)
            if (state%springs%stuck) return
            size_before = huge(1.0_wp)
         end if
         call find_residual(self, state, h, load, size_now)
         if (i > 0) cycle
         converged = has_converged(self, h, size_now, size_before)
         if (converged .or. .not. size_now < size_before) return
         size_before = size_now
      end do
   end subroutine go_by_events

   !> Whether a residual is gone, or as small as round-off lets it be.
   pure logical function has_converged(self, h, size_now, size_before)
      type(implicit_stepper), intent(in) :: self
      real(wp), intent(in) :: h
      !> Relative size now and at the last trial
      real(wp), intent(in) :: size_now, size_before

      integer :: n

      has_converged = size_now <= self%wanted
      if (has_converged .or. self%acceptable < 0.0_wp) return
      has_converged = size_now <= self%acceptable .and. size_now > 0.5_wp*size_before
      ! As long as it becomes much smaller, it is not round-off yet.
      if (has_converged .or. size_now < 0.1_wp*size_before) return
      n = size(self%stiffness)/2
      has_converged = is_round_off(n, h, self%stiffness, self%r, self%moved, self%v0, self%a0)
      if (size(self%r) > 2*n .and. has_converged) then
         has_converged = is_round_off_of_lifts(n, h, self%diagonal, self%r(2*n + 1:), self%moved(2*n + 1:), &
                                               self%v0(2*n + 1:), self%a0(2*n + 1:))
      end if
   end function has_converged

   !> Whether the residual is what round-off leaves of the terms of the step. Modes that the step does not
   !> resolve have accelerations far beyond what comes of them: after a shock h^2 a0 is many turns.
   pure logical function is_round_off(n, h, stiffness, r, moved, v0, a0)
      integer, intent(in) :: n
      real(wp), intent(in) :: h, stiffness(2*n), r(2*n), moved(2*n), v0(2*n), a0(2*n)
      real(wp) :: way, turn, along, about
      integer :: i

      way = 0.0_wp
      turn = 0.0_wp
      do i = 1, n
         way = max(way, abs(moved(2*i - 1)) + h*abs(v0(2*i - 1)) + h**2*abs(a0(2*i - 1)))
         turn = max(turn, abs(moved(2*i)) + h*abs(v0(2*i)) + h**2*abs(a0(2*i)))
      end do
      is_round_off = .true.
      do i = 1, n
         along = sqrt(max(stiffness(2*i - 1), 0.0_wp))
         about = sqrt(max(stiffness(2*i), 0.0_wp))
         is_round_off = is_round_off .and. abs(r(2*i - 1)) <= round_off*along*(along*way + about*turn) &
                        .and. abs(r(2*i)) <= round_off*about*(along*way + about*turn)
      end do
   end function is_round_off

   !> The same for the openings.
   pure logical function is_round_off_of_lifts(n, h, stiffness, r, moved, v0, a0) result(is_round_off)
      integer, intent(in) :: n
      real(wp), intent(in) :: h, stiffness(n), r(n), moved(n), v0(n), a0(n)
      real(wp) :: way

      way = maxval(abs(moved) + h*abs(v0) + h**2*abs(a0))
      is_round_off = all(abs(r) <= round_off*stiffness*way)
   end function is_round_off_of_lifts

   !> How much of a correction the first spring allows that comes to an end of its line.
   subroutine first_end(state, q, dq, share, first, way)
      type(state_type), intent(in) :: state
      !> Deformations reached and their correction (unknowns)
      real(wp), intent(in), contiguous :: q(:), dq(:)
      !> Share from 0 to 1; the spring, 0 if all is allowed; its way
      real(wp), intent(out) :: share
      integer, intent(out) :: first, way
      real(wp) :: room
      integer :: i

      share = 1.0_wp
      first = 0
      way = 0
      associate (springs => state%springs)
         do i = 1, springs%count
            ! Most springs have room.
            if (q(i) + dq(i) >= springs%first(i) .and. q(i) + dq(i) <= springs%last(i)) cycle
            if (dq(i) > 0.0_wp) then
               ! The rear end of a one-way line is where the spring was put last.
               room = springs%end_toward(i, 1) - q(i)
            else
               room = q(i) - springs%end_toward(i, -1)
            end if
            if (room >= share*abs(dq(i))) cycle
            share = max(room, 0.0_wp)/abs(dq(i))
            first = i
            way = merge(1, -1, dq(i) > 0.0_wp)
            if (.not. share > 0.0_wp) return
         end do
      end associate
   end subroutine first_end

   !> Residual of the step for what the bodies have moved, and its size relative to the forces.
   subroutine find_residual(self, state, h, load, relative)
      type(implicit_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state
      real(wp), intent(in) :: h, load(4)
      real(wp), intent(out) :: relative
      integer :: m, n

      m = size(self%r)
      n = state%motion%column%n
      call end_of_step(m, h, self%beta, self%gamma, self%moved, self%v0, self%a0, self%v1, self%a1)
      if (state%motion%damped) call to_joints(state%motion%column, self%v1, self%w1)
      call find_forces(state, self%mass, self%q1, self%w1, self%v1, load, self%now, self%g1)
      call balance(m, self%alpha_m, self%alpha_f, self%mass, self%a0, self%a1, self%g0, self%g1, self%r)
      call find_scale(n, m, self%mass, self%a1, self%g1, self%now%f, load(lateral), &
                      state%motion%column%upper(n), self%scale)
      relative = size_of(n, m, self%r, max(self%scale, self%largest))
   end subroutine find_residual

   pure subroutine end_of_step(m, h, beta, gamma, moved, v0, a0, v1, a1)
      integer, intent(in) :: m
      real(wp), intent(in) :: h, beta, gamma, moved(m), v0(m), a0(m)
      real(wp), intent(out) :: v1(m), a1(m)

      a1 = (moved - h*v0 - (h**2*(0.5_wp - beta))*a0)*(1.0_wp/(beta*h**2))
      v1 = v0 + (h*(1.0_wp - gamma))*a0 + (h*gamma)*a1
   end subroutine end_of_step

   pure subroutine balance(m, alpha_m, alpha_f, mass, a0, a1, g0, g1, r)
      integer, intent(in) :: m
      real(wp), intent(in) :: alpha_m, alpha_f, mass(m), a0(m), a1(m), g0(m), g1(m)
      real(wp), intent(out) :: r(m)

      r = (1.0_wp - alpha_f)*g1 + alpha_f*g0 - mass*((1.0_wp - alpha_m)*a1 + alpha_m*a0)
   end subroutine balance

   !> Largest force, moment and lift at a state.
   pure subroutine find_scale(n, m, mass, a, g, f, lateral_force, arm, scale)
      integer, intent(in) :: n, m
      real(wp), intent(in) :: mass(m), a(m), g(m), f(m), lateral_force, arm
      real(wp), intent(out) :: scale(3)
      integer :: i

      scale = [abs(lateral_force), abs(lateral_force)*arm, 0.0_wp]
      do i = 1, n
         scale(1) = max(scale(1), abs(f(i)), abs(mass(2*i - 1)*a(2*i - 1)))
         scale(2) = max(scale(2), abs(f(n + i)), abs(mass(2*i)*a(2*i)))
      end do
      if (m > 2*n) scale(3) = max(maxval(abs(f(2*n + 1:))), maxval(abs(g(2*n + 1:))))
   end subroutine find_scale

   !> Largest residual over the largest force, at the most 1: forces, moments and lifts each by themselves.
   pure real(wp) function size_of(n, m, r, scale) result(relative)
      integer, intent(in) :: n, m
      real(wp), intent(in) :: r(m), scale(3)
      real(wp) :: rest(3)
      integer :: i

      rest = 0.0_wp
      do i = 1, n
         rest(1) = max(rest(1), abs(r(2*i - 1)))
         rest(2) = max(rest(2), abs(r(2*i)))
      end do
      if (m > 2*n) rest(3) = maxval(abs(r(2*n + 1:)))
      relative = maxval(rest/max(scale, rest, tiny(1.0_wp)))
   end function size_of

   !> What the tangent asks for to take the residual away. The tangent is factored anew only if a line, the
   !> step or the axial load has changed.
   subroutine find_correction(self, state, h)
      type(implicit_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state
      real(wp), intent(in) :: h
      real(wp), allocatable :: general(:, :), b(:, :), diagonal(:), beside(:)
      logical :: regular
      integer :: n

      n = state%motion%column%n
      if (is_stale(self, state, h)) call set_tangent(self, state, h)
      self%dx = self%r
      if (self%positive) then
         call solve_narrow_band(2*n, self%factor, self%dx(:2*n))
      else
         ! The column softens more than its inertia holds: elimination with pivots.
         call spread_band(self%factor, general)
         b = reshape(self%dx(:2*n), [2*n, 1])
         call solve_general_band(general, 3, 3, b, regular)
         self%dx(:2*n) = b(:, 1)
      end if
      if (.not. state%motion%column%opens) return
      diagonal = self%diagonal
      beside = self%beside(:n - 1)
      call solve_tridiagonal(diagonal, beside, self%dx(2*n + 1:), regular)
   end subroutine find_correction

   pure logical function is_stale(self, state, h)
      type(implicit_stepper), intent(in) :: self
      type(state_type), intent(in) :: state
      real(wp), intent(in) :: h

      is_stale = state%springs%version /= self%factor_version .or. &
                 abs(h - self%factor_step) > 1.0e-14_wp*h
      if (state%motion%second_order) then
         is_stale = is_stale .or. state%motion%acts(vertical) .or. state%motion%acts(axial)
      end if
   end function is_stale

   !> Tangent of the step on the present lines, and its factor.
   subroutine set_tangent(self, state, h)
      type(implicit_stepper), intent(inout) :: self
      type(state_type), intent(in) :: state
      real(wp), intent(in) :: h
      real(wp) :: of_mass, of_damping
      real(wp), allocatable :: band(:, :)
      integer :: n

      n = state%motion%column%n
      of_damping = (1.0_wp - self%alpha_f)*self%gamma/(self%beta*h)
      of_mass = (1.0_wp - self%alpha_m)/(self%beta*h**2) + of_damping*state%motion%column%mass_damping
      associate (motion => state%motion, springs => state%springs)
         self%k = (1.0_wp - self%alpha_f)*springs%k
         if (motion%column%tangent_damping) then
            self%k = self%k + (of_damping*motion%column%stiffness_damping)*max(springs%k, 0.0_wp)
         else if (motion%damped) then
            self%k = self%k + of_damping*motion%joint_damping
         end if
         self%factor = 0.0_wp
         call add_spring_band(motion%column, self%k(:2*n), self%factor)
         if (motion%second_order) then
            call add_geometric_band(motion%column, (1.0_wp - self%alpha_f)*self%now%axial_body, &
                                    (1.0_wp - self%alpha_f)*self%now%axial_joint, self%factor)
         end if
         self%factor(1, :) = self%factor(1, :) + of_mass*self%mass(:2*n)
         if (motion%column%opens) then
            call opening_stiffness(motion%column, self%k(2*n + 1:), self%diagonal, self%beside(:n - 1))
            self%diagonal = self%diagonal + of_mass*self%mass(2*n + 1:)
         end if
      end associate
      self%stiffness = self%factor(1, :)
      if (springs_soften(state)) then
         band = self%factor
         call factor_narrow_band(2*n, self%factor, self%positive)
         if (.not. self%positive) call move_alloc(band, self%factor)
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
      real(wp), allocatable, intent(out) :: general(:, :)
      integer :: i, j, m

      m = size(band, 2)
      allocate (general(10, m), source=0.0_wp)
      do j = 1, m
         do i = j, min(j + 3, m)
            general(7 + i - j, j) = band(1 + i - j, j)
            general(7 + j - i, i) = band(1 + i - j, j)
         end do
      end do
   end subroutine spread_band

   !> The end of the step becomes the state. Works by the trapezoidal rule along the way, which balances
   !> exactly for average acceleration on straight lines.
   subroutine commit(self, state, h, load)
      type(implicit_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state
      real(wp), intent(in) :: h, load(4)
      real(wp) :: before, after
      integer :: n, i

      n = state%motion%column%n
      associate (motion => state%motion, mean => 0.5_wp*(state%load + load))
         if (motion%acts(lateral)) then
            state%of_loads = state%of_loads + mean(lateral)*(self%moved(2*n - 1) &
                                                             + motion%column%upper(n)*self%moved(2*n))
         end if
         if (motion%acts(horizontal)) then
            do i = 1, n
               state%of_loads = state%of_loads - mean(horizontal)*motion%column%mass(i)*self%moved(2*i - 1)
            end do
         end if
         call to_joints(motion%column, self%v1, self%w1)
         if (motion%acts(vertical) .or. motion%acts(axial)) then
            before = motion%lifting_power(state%q, state%v, state%load)
            after = motion%lifting_power(self%q1, self%w1, load)
            state%of_loads = state%of_loads + 0.5_wp*h*(before + after)
         end if
         if (motion%damped) then
            state%of_damping = state%of_damping &
                               + h*motion%damping_power(state%springs, self%q1, 0.5_wp*(state%v + self%w1))
         end if
      end associate
      call state%springs%carry_to(self%q1)
      state%q = self%q1
      state%v = self%w1
      state%time = state%time + h
      state%load = load
      self%steps = self%steps + 1
      self%largest = max(self%largest, self%scale)
      self%v0 = self%v1
      self%a0 = self%a1
      self%g0 = self%g1
   end subroutine commit

end module rbs_solve_time_implicit
