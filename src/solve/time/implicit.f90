!> Newmark's method and the generalised-alpha method (HHT is a case of it) in the unknowns of a structure,
!> where the mass is diagonal and the tangent a band: O(n) a step, no limit of stability.
!>
!> The springs are straight lines, so the tangent step is exact up to the next end of a line. Where Newton's
!> method oscillates between two branches, the solution moves from end to end instead. A step that
!> does not converge is taken back to the stored state and cut in two.
module rbs_solve_time_implicit
   use rbs_base_arrays, only: swap
   use rbs_base_inner_product, only: inner_product, total
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_hysteresis_springs, only: spring_array
   use rbs_solve_one_body_implicit_one_body, only: one_body_step
   use rbs_solve_one_body_rk4_one_body, only: pdelta_moment_of
   use rbs_solve_time_implicit_finite, only: finite_stepper
   use rbs_solve_time_implicit_balance, only: step_balance, step_tangent
   use rbs_loading_loads, only: lateral, horizontal, sideways, signals
   use rbs_solve_time_motion, only: equation_of_motion
   use rbs_solve_time_newton, only: newton_stepper, progress
   use rbs_solve_time_state, only: state_type
   implicit none
   private

   !> How often a spring may leave its lines while the residual does not decrease.
   integer, parameter :: most_returns = 5

   !> Steps on the same lines that may follow each other without a look at their residuals.
   integer, parameter :: most_unchecked = 7
   !> Residual, as a share of the largest forces, that may be left then. Stiff members leave more, which would
   !> gather from step to step: where they do, each step is checked.
   real(wp), parameter :: no_residual = 1.0e-14_wp

   !> Resistance, as a share of the initial stiffness, by which springs without stiffness share a motion.
   real(wp), parameter :: little = 1.0e-3_wp

   public :: implicit_stepper, new_newmark, new_generalised_alpha, new_hht, with_finite_rotations

   type, extends(newton_stepper) :: implicit_stepper
      !> Whether it is average acceleration, which with finite rotations has the forces of the mean
      logical, private :: average = .false.
      type(step_balance) :: step
      type(step_tangent) :: tangent
      type(one_body_step) :: one_body
      !> Correction of the bodies and of the joints, and mean velocities of the joints (unknowns)
      real(wp), allocatable, private :: dx(:), dq(:), mean(:)
      !> Works of loads and damping in the step, and whether they are known [J]
      real(wp), private :: of_loads = 0.0_wp, of_damping = 0.0_wp
      logical, private :: weighed = .false.
      !> Length of step and version of the lines with which a first trial left no residual, number of steps
      !> since then that were not checked, and whether the next trial is the first of its step
      real(wp), private :: sure_step = 0.0_wp
      integer, private :: sure_version = -1, unchecked = 0
      logical, private :: is_first = .false.
      !> Potential energies at the start and at the end of the step, and whether the first is known [J]
      real(wp), private :: potential(2) = 0.0_wp
      logical, private :: potential_known = .false.
      !> Whether springs without stiffness shared a motion, in an element or about a node, in a trial
      logical, private :: ambiguous = .false.
      !> How far the unknowns had moved where the last round of `snap` began (unknowns); how often each spring
      !> has left its lines since the residual decreased (springs)
      real(wp), allocatable, private :: anchor(:)
      integer, allocatable, private :: returns(:)
   contains
      procedure :: prepare, take_step, correct, try, work_of_residual, is_round_off, serialize
      procedure, private :: try_start, check_runaway, find_works, resist
   end type implicit_stepper

   interface
      !> Judge the step by the energy that it loses. If it is not found, or if it loses more than a member
      !> that yields, search the state that members snap to.
      module subroutine snap_unless_smooth(self, state)
         class(implicit_stepper), intent(inout) :: self
         type(state_type), intent(inout) :: state
      end subroutine snap_unless_smooth
   end interface

contains

   !> Newmark's average acceleration.
   type(implicit_stepper) function new_newmark() result(stepper)

      stepper%step%beta = 0.25_wp
      stepper%average = .true.
   end function new_newmark

   !> Generalised-alpha with the least damping of low frequencies for a spectral radius at infinite
   !> frequency.
   type(implicit_stepper) function new_generalised_alpha(rho) result(stepper)
      !> From 0 (all damped in one step) to 1 (no damping)
      real(wp), intent(in) :: rho

      stepper%step%alpha_m = (2.0_wp*rho - 1.0_wp)/(rho + 1.0_wp)
      stepper%step%alpha_f = rho/(rho + 1.0_wp)
      stepper%step%gamma = 0.5_wp - stepper%step%alpha_m + stepper%step%alpha_f
      stepper%step%beta = 0.25_wp*(1.0_wp - stepper%step%alpha_m + stepper%step%alpha_f)**2
   end function new_generalised_alpha

   !> The method of Hilber, Hughes and Taylor (1977): alpha_f = (1 - rho)/(1 + rho) = -alpha of the authors.
   type(implicit_stepper) function new_hht(rho) result(stepper)
      !> From 1/2 to 1
      real(wp), intent(in) :: rho

      stepper%step%alpha_f = (1.0_wp - rho)/(1.0_wp + rho)
      stepper%step%gamma = 0.5_wp + stepper%step%alpha_f
      stepper%step%beta = 0.25_wp*(1.0_wp + stepper%step%alpha_f)**2
   end function new_hht

   !> The same method, with its parameters, for a column with finite rotations.
   type(finite_stepper) function with_finite_rotations(method) result(stepper)
      type(implicit_stepper), intent(in) :: method

      stepper%average = method%average
      stepper%by = method%step%family_type
   end function with_finite_rotations

   !> Make room, and find velocities, accelerations and forces at the start of the first step.
   subroutine prepare(self, state)
      class(implicit_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state

      call self%step%start(state)
      self%sure_version = -1
      self%potential_known = .false.
      if (allocated(self%dx)) return
      call self%tangent%create(state%motion%structure)
      allocate (self%anchor(state%motion%structure%unknowns), self%returns(size(state%q)))
      allocate (self%dx(state%motion%structure%unknowns), &
                self%dq(size(state%q)), self%mean(size(state%q)), source=0.0_wp)
   end subroutine prepare

   !> Take a step; a column of one body has a procedure of its own, and where that finds no end the step is
   !> taken as for any structure.
   subroutine take_step(self, state)
      class(implicit_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state

      self%busiest = 0
      self%runaway = 0
      if (associated(state%motion%one_body)) then
         call take_step_of_one_body(self, state)
         if (self%converged) return
      end if
      call solve_step(self, state)
      if (self%converged) call commit(self, state)
   end subroutine take_step

   !> Take a step of one body. If it is not found so, nothing has happened.
   subroutine take_step_of_one_body(self, state)
      class(implicit_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state
      real(wp) :: mean(2)

      associate (step => self%step, body => self%one_body, motion => state%motion, h => self%h, &
                 load => self%load)
         body%wanted = self%wanted
         if (abs(h - body%h) > 0.0_wp) call fit_one_body(body, step, motion, h)
         call body%take_step(state%springs, state%q, step%v0, step%a0, step%g0, step%largest, &
                             load(lateral), load(horizontal), self%converged)
         if (.not. self%converged) return
         ! Lateral force and acceleration of the ground are the first two loads.
         mean = 0.5_wp*(state%load(:2) + load(:2))
         if (motion%acts(lateral)) then
            state%of_loads = state%of_loads + mean(lateral)*(body%moved(1) + body%upper*body%moved(2))
         end if
         if (motion%acts(horizontal)) then
            state%of_loads = state%of_loads - mean(horizontal)*body%mass(1)*body%moved(1)
         end if
         if (motion%damped) state%of_damping = state%of_damping + body%work_of_damping(step%v0)
         ! The slip has the velocity of the bottom of the body. Both elements one by one: the compiler does
         ! not know that there are no more.
         state%v(1) = body%v1(1) - body%lower*body%v1(2)
         state%v(2) = body%v1(2)
         state%q(1) = body%q(1)
         state%q(2) = body%q(2)
         state%time = state%time + h
         state%load = load
         step%largest(1) = body%scale(1)
         step%largest(2) = body%scale(2)
         step%v0(1) = body%v1(1)
         step%v0(2) = body%v1(2)
         step%a0(1) = body%a1(1)
         step%a0(2) = body%a1(2)
         step%g0(1) = body%g(1)
         step%g0(2) = body%g(2)
      end associate
   end subroutine take_step_of_one_body

   !> Find the end of the step, by Newton's method or along a snap of members. If it is not found, the springs
   !> are as before.
   subroutine solve_step(self, state)
      class(implicit_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state

      self%marked = .false.
      self%weighed = .false.
      self%ambiguous = .false.
      call state%motion%set_axial_loads(state%springs, self%load)
      call find_end(self, state)
      ! Springs without stiffness shared a motion: of many states in equilibrium the nearest is sought.
      if (self%converged .and. self%ambiguous) call settle(self, state)
      if (self%converged) call self%check_runaway(state)
      ! Without a mark no spring has left its line: there is nothing to take back.
      if (.not. self%marked) return
      if (size(self%step%now%tangent) > 0) then
         call snap_unless_smooth(self, state)
         self%weighed = .true.
      end if
      if (.not. self%converged) call state%springs%restore()
      call state%springs%forget_mark()
   end subroutine solve_step

   !> Find a state in equilibrium, by Newton's method and, where it fails, from end to end of the springs'
   !> lines.
   subroutine find_end(self, state)
      class(implicit_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state

      call self%try_start(state)
      call self%iterate(state)
      if (self%converged .or. .not. self%marked) return
      call state%springs%restore()
      ! Joints under an axial load that varies have no lines that deformations alone could follow.
      if (.not. state%springs%axial_load_varies) call go_by_events(self, state)
   end subroutine find_end

   !> Many states are in equilibrium, as springs without stiffness share a motion. The step goes to the one
   !> that is nearest to its begin, where a very viscous liquid would lead: else round-off would choose.
   subroutine settle(self, state)
      class(implicit_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state

      if (self%marked) call state%springs%restore()
      call self%try_start(state)
      ! With a little resistance from the start of the step, and from where that leads without any
      self%step%now%anchor(:) = state%q
      call self%resist(little)
      call self%step%find_residual(state, self%h, self%load, self%residual)
      call self%iterate(state)
      call self%resist(0.0_wp)
      if (self%converged) then
         call self%step%find_residual(state, self%h, self%load, self%residual)
         call self%iterate(state)
         if (self%converged) return
      end if
      if (self%marked) call state%springs%restore()
      call find_end(self, state)
   end subroutine settle

   !> The step from end to end of the springs' lines, where `iterate` has failed. On the present lines the
   !> tangent step is exact, so the residual decreases in proportion to the way. A spring that leaves its
   !> lines again and again while the residual does not decrease shows that no line leads on from there.
   subroutine go_by_events(self, state)
      class(implicit_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state
      !> Share of the correction up to an end; residual at the trial before, `huge` after an end; least
      !> residual
      real(wp) :: share, before, least
      !> Spring that is at the end of its line, and which end: +1 or -1
      integer :: i, direction

      before = huge(1.0_wp)
      least = huge(1.0_wp)
      call self%try_start(state)
      do
         if (self%residual < progress*least) then
            least = self%residual
            self%returns = 0
         end if
         call self%correct(state)
         call state%springs%joints%open_layers(self%dq)
         call first_end(state%springs, self%step%q1, self%dq, share, i, direction)
         self%step%q1 = self%step%q1 + share*self%dq
         self%step%moved = self%step%moved + share*self%dx
         ! A spring that comes to the end of its line goes on to the next line.
         if (i > 0) then
            self%returns(i) = self%returns(i) + 1
            self%busiest = i
            call state%springs%carry_to(self%step%q1)
            call state%springs%leave(i, direction)
            self%step%q1(i) = state%springs%d(i)
            if (state%springs%stuck) return
            before = huge(1.0_wp)
         end if
         call self%step%find_residual(state, self%h, self%load, self%residual)
         if (i > 0) then
            if (self%returns(i) <= most_returns) cycle
            ! About an equilibrium round-off sends springs at their corners to and fro.
            self%converged = self%residual <= self%acceptable
            return
         end if
         self%converged = self%has_converged(state, before)
         if (self%converged .or. .not. self%residual < before) return
         before = self%residual
      end do
   end subroutine go_by_events

   !> The share of a correction up to the first end of a line that a spring reaches.
   pure subroutine first_end(springs, q, dq, share, first, direction)
      type(spring_array), intent(in) :: springs
      !> Deformations reached and their correction (coordinates)
      real(wp), intent(in), contiguous :: q(:), dq(:)
      !> Share from 0 to 1; the spring that ends it, 0 if there is none; its direction, +1 or -1
      real(wp), intent(out) :: share
      integer, intent(out) :: first, direction
      real(wp) :: clearance
      integer :: i

      share = 1.0_wp
      first = 0
      direction = 0
      do i = 1, springs%count
         ! Most springs stay on their lines.
         if (q(i) + dq(i) >= springs%lower(i) .and. q(i) + dq(i) <= springs%upper(i)) cycle
         if (dq(i) > 0.0_wp) then
            ! The rear end of a one-way line is where the spring was put last.
            clearance = springs%end_toward(i, 1) - q(i)
         else
            clearance = q(i) - springs%end_toward(i, -1)
         end if
         if (clearance >= share*abs(dq(i))) cycle
         share = max(clearance, 0.0_wp)/abs(dq(i))
         first = i
         direction = merge(1, -1, dq(i) > 0.0_wp)
         if (.not. share > 0.0_wp) return
      end do
   end subroutine first_end

   !> The end of the step becomes the state.
   subroutine commit(self, state)
      class(implicit_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state

      ! Where members may snap the works are known already.
      if (.not. self%weighed) then
         call self%find_works(state)
         call state%springs%carry_to(self%step%q1)
      end if
      state%of_loads = state%of_loads + self%of_loads
      state%of_damping = state%of_damping + self%of_damping
      call swap(state%q, self%step%q1)
      call swap(state%v, self%step%w1)
      state%time = state%time + self%h
      state%load = self%load
      self%potential(1) = self%potential(2)
      self%potential_known = self%weighed
      call self%step%go_on(state)
   end subroutine commit

   !> The first trial, in which nothing moves from the start of the step, and its residual.
   subroutine try_start(self, state)
      class(implicit_stepper), intent(inout) :: self
      type(state_type), intent(in) :: state

      self%step%moved = 0.0_wp
      self%step%resistance = 0.0_wp
      self%is_first = .true.
      self%step%q1(:) = state%q
      call self%step%find_first(state, self%h, self%load, self%residual)
   end subroutine try_start

   !> Springs resist a deformation from an anchor, by a share of their initial stiffness.
   subroutine resist(self, share)
      class(implicit_stepper), intent(inout) :: self
      !> Share of the initial stiffness; 0: no resistance
      real(wp), intent(in) :: share

      self%step%resistance = share
      self%step%now%resistance = share
   end subroutine resist

   !> A step in which a member slides or turns away without bounds is no step: it has not converged.
   subroutine check_runaway(self, state)
      class(implicit_stepper), intent(inout) :: self
      type(state_type), intent(in) :: state

      self%runaway = state%motion%structure%unbounded_spring(self%step%q1)
      self%converged = self%runaway == 0
   end subroutine check_runaway

   !> Find the works of loads and damping in the step by the trapezoidal rule along the way, which balances
   !> exactly for average acceleration on straight lines; velocities of the springs at its end.
   subroutine find_works(self, state)
      class(implicit_stepper), intent(inout) :: self
      type(state_type), intent(in) :: state
      !> Power of vertical loads at start and end [W]
      real(wp) :: before, after
      integer :: i

      self%of_loads = 0.0_wp
      self%of_damping = 0.0_wp
      call state%springs%joints%open_layers(self%step%q1)
      associate (motion => state%motion, h => self%h, load => self%load, &
                 mean => 0.5_wp*(state%load + self%load))
         do i = lateral, sideways
            ! Loads of a fixed direction work on the motion; those that lift or press, by their power.
            if (motion%acts(i) .and. any(i == [lateral, horizontal, sideways])) then
               self%of_loads = self%of_loads + mean(i)*motion%structure%work_of(i, self%step%moved)
            end if
         end do
         if (motion%structure%is_implicit .and. .not. motion%springs_damp) then
            ! Of a frame only the velocities of the unknowns count.
            associate (before => motion%structure%joints%before)
               self%step%w1(before - size(self%step%v1) + 1:before) = self%step%v1
            end associate
         else
            call motion%structure%spring_rates(self%step%now%tangent, self%step%v1, self%step%w1)
         end if
         if (motion%varies) then
            before = motion%structure%power_of_loads(state%q, state%v, lifts(state%load))
            after = motion%structure%power_of_loads(self%step%q1, self%step%w1, lifts(load))
            self%of_loads = self%of_loads + 0.5_wp*h*(before + after)
         end if
         if (motion%damped) then
            do i = 1, size(self%step%run, 2)
               associate (first => self%step%run(1, i), last => self%step%run(2, i))
                  self%mean(first:last) = 0.5_wp*(state%v(first:last) + self%step%w1(first:last))
               end associate
            end do
            self%of_damping = h*motion%damping_power(state%springs, self%step%q1, self%mean)
            ! Elements damp as wholes; the residual is not needed any more.
            call motion%structure%unknown_rates(self%mean, self%dx)
            self%step%r = 0.0_wp
            call motion%structure%damp(self%dx, self%step%damping_tangent, self%step%r)
            self%of_damping = self%of_damping - h*inner_product(size(self%dx), self%dx, self%step%r)
         end if
      end associate
   end subroutine find_works

   !> Give the record of a step of one body its column, its method and the length of the step.
   pure subroutine fit_one_body(body, step, motion, h)
      type(one_body_step), intent(inout) :: body
      type(step_balance), intent(in) :: step
      type(equation_of_motion), intent(in) :: motion
      !> Step [s]
      real(wp), intent(in) :: h

      body%alpha_m = step%alpha_m
      body%alpha_f = step%alpha_f
      body%beta = step%beta
      body%gamma = step%gamma
      body%damping = motion%damping
      associate (column => motion%one_body)
         body%mass = column%inertias(:2)
         body%lower = column%lower(1)
         body%upper = column%upper(1)
         body%pdelta_moment = pdelta_moment_of(column)
      end associate
      call body%set_step(h)
   end subroutine fit_one_body

   !> Find the correction that takes the residual away as long as no line changes.
   subroutine correct(self, state)
      class(implicit_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state

      call self%tangent%find_correction(self%step, state, self%h, self%dx)
      self%ambiguous = self%ambiguous .or. self%step%shares .or. self%tangent%holds
      call state%motion%structure%spring_rates(self%step%now%tangent, self%dx, self%dq)
      ! Springs between the unknowns are corrected by themselves.
      if (size(self%step%now%correction) > 0) then
         call add_share(self%step%run, 1.0_wp, self%step%now%correction, self%dq)
      end if
   end subroutine correct

   !> Add a share of a change to a position; its layers stay.
   pure subroutine add_share(run, share, change, q)
      !> Runs of the coordinates that are no layers (2, runs)
      integer, intent(in) :: run(:, :)
      real(wp), intent(in) :: share
      !> Change and position (coordinates)
      real(wp), intent(in), contiguous :: change(:)
      real(wp), intent(inout), contiguous :: q(:)
      integer :: i

      do i = 1, size(run, 2)
         associate (first => run(1, i), last => run(2, i))
            q(first:last) = q(first:last) + share*change(first:last)
         end associate
      end do
   end subroutine add_share

   !> Go on (or back) by a share of the correction, and find the residual there; `huge` out of bounds.
   subroutine try(self, state, share)
      class(implicit_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state
      real(wp), intent(in) :: share
      logical :: in_range

      self%residual = huge(1.0_wp)
      ! Layers follow when springs leave their lines, or the step has ended.
      call add_share(self%step%run, share, self%dq, self%step%q1)
      self%step%moved = self%step%moved + share*self%dx
      call self%move_springs(state, self%step%q1, in_range)
      if (in_range) call judge_trial(self, state)
   end subroutine try

   !> Find the residual of a trial. The tangent step of a frame is exact as long as no line changes: if it has
   !> left no residual with these lines and this length, it leaves none in the next steps. One in eight is
   !> checked, so that round-off does not gather.
   subroutine judge_trial(self, state)
      type(implicit_stepper), intent(inout) :: self
      type(state_type), intent(in) :: state
      logical :: is_exact

      associate (motion => state%motion, structure => state%motion%structure, &
                 version => state%springs%version)
         is_exact = self%is_first .and. .not. (self%marked .or. self%ambiguous .or. motion%varies .or. &
                                               allocated(structure%modal_momenta)) .and. &
                    size(self%step%now%tangent) > 0 .and. .not. self%step%resistance > 0.0_wp
         self%is_first = .false.
         if (is_exact .and. version == self%sure_version .and. self%unchecked < most_unchecked .and. &
             .not. abs(self%h - self%sure_step) > 0.0_wp) then
            self%unchecked = self%unchecked + 1
            call self%step%end_on_lines(structure%inertias, self%h, self%load)
            self%residual = 0.0_wp
            return
         end if
         call self%step%find_residual(state, self%h, self%load, self%residual)
         self%sure_version = -1
         if (.not. is_exact .or. self%residual > no_residual) return
         self%sure_version = version
         self%sure_step = self%h
         self%unchecked = 0
      end associate
   end subroutine judge_trial

   !> Work of the residual on the correction [J].
   real(wp) function work_of_residual(self) result(work)
      class(implicit_stepper), intent(in) :: self

      work = inner_product(size(self%step%r), self%step%r, self%dx)
   end function work_of_residual

   !> Whether the residual is the round-off of the terms of the step.
   logical function is_round_off(self, state)
      class(implicit_stepper), intent(in) :: self
      type(state_type), intent(in) :: state

      is_round_off = self%step%is_round_off(state, self%h, self%tangent%stiffness)
   end function is_round_off

   !> The vertical loads alone, without lateral force and ground motions along x and y: the work of a vertical
   !> load is not that of a force which keeps its direction, and is found by its power.
   pure function lifts(load)
      real(wp), intent(in) :: load(signals)
      real(wp) :: lifts(signals)

      lifts = load
      lifts([lateral, horizontal, sideways]) = 0.0_wp
   end function lifts

   !> Save or restore the motion of the bodies at the start of a step, and which step is checked next.
   subroutine serialize(self, stream)
      class(implicit_stepper), intent(inout) :: self
      type(stream_type), intent(inout) :: stream
      logical :: is_sure

      call self%step%serialize(stream)
      is_sure = self%sure_version == self%step%version
      call stream%item(is_sure)
      call stream%item(self%sure_step)
      call stream%item(self%unchecked)
      self%sure_version = merge(self%step%version, -1, is_sure)
   end subroutine serialize

end module rbs_solve_time_implicit
