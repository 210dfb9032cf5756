!> Members that snap. Where a member softens faster than the rest of it can unload, no state near the last one
!> is in equilibrium, although the motion of its ends continues: in a test it would jump, with a bang. The
!> part inside has no mass that could govern the jump, so it moves as in a very viscous liquid, down to the
!> next state at which it rests. The energy that the liquid takes is lost; it is an item of the balance.
submodule (rbs_solve_time_implicit) rbs_solve_time_snap
   implicit none

   !> Rounds in which a member snaps and trials of each, rounds that a resistance is kept for after a smaller
   !> one has failed, the residuals that they leave, that of a state at rest, and the least and the largest
   !> resistance as shares of the initial stiffness.
   integer, parameter :: most_rounds = 100, few_trials = 8, patience = 4
   real(wp), parameter :: loose = 1.0e-6_wp, resting = 1.0e-9_wp, least_resistance = 1.0e-6_wp, &
                          most_resistance = 1.0e4_wp

   !> Shares of the energy that a step may lose without a jump, and that no jump loses; share of the potential
   !> that counts as energy, as differences of potentials are known to some 1e-15 of these.
   real(wp), parameter :: far = 0.01_wp, no_loss = 1.0e-5_wp, of_potential = 1.0e-9_wp

contains

   !> Judge a step by the energy that it loses. If it has not converged, or loses more than a small share,
   !> take it to the state that members snap to, if there is one: else it has not converged.
   module subroutine snap_unless_smooth(self, state)
      class(implicit_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state
      real(wp) :: loss, energy

      if (self%converged) then
         call find_loss(self, state, loss, energy)
         if (abs(loss) <= far*energy) return
      end if
      ! Parts without mass move to the next state of rest, not to any.
      call state%springs%restore()
      self%runaway = 0
      call snap(self, state)
      if (.not. self%converged) return
      call find_loss(self, state, loss, energy)
      ! A jump sets energy free. Where the next state of rest has more, the step is cut.
      self%converged = loss >= -no_loss*energy
      if (loss > no_loss*energy) call count_snap(self, state, loss)
   end subroutine snap_unless_smooth

   !> The step where the inside of a member, or nodes without mass, snap from one equilibrium to another.
   !> Springs that resist their deformation, as if in a very viscous liquid, follow the way from the start
   !> of the step down to the next state at which they rest, in equilibrium without resistance. It is as
   !> small as the softening springs allow.
   subroutine snap(self, state)
      class(implicit_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state
      !> Resistance as a share of the initial stiffness; settings kept for the return; residual at the last
      !> try without resistance; way of a round, measured by energy, and of the round before with its
      !> resistance
      real(wp) :: resistance, wanted, tried, distance, distance_before, at_last
      integer :: round, trials, waits

      wanted = self%wanted
      trials = self%most_trials
      self%most_trials = few_trials
      resistance = 1.0_wp
      at_last = resistance
      waits = 0
      tried = huge(1.0_wp)
      distance_before = sqrt(huge(1.0_wp))
      call self%try_start(state)
      do round = 1, most_rounds
         self%step%now%anchor(:) = self%step%q1
         self%anchor(:) = self%step%moved
         call self%resist(0.0_wp)
         call self%step%find_residual(state, self%h, self%load, self%residual)
         ! Where little resistance is left, an equilibrium without it may be near.
         if (resistance <= 0.1_wp .and. self%residual < 0.3_wp*tried) then
            tried = self%residual
            call self%iterate(state)
            if (self%converged) exit
            call go_back(self, state)
            if (tried <= resting) call rest(self, state, at_last)
            if (self%converged) exit
         end if
         call self%resist(resistance)
         ! Else one step further down against the resistance; if it goes too far, against more of it.
         self%wanted = loose
         call self%step%find_residual(state, self%h, self%load, self%residual)
         call self%iterate(state)
         self%wanted = wanted
         call state%springs%joints%open_layers(self%step%q1)
         distance = 0.0_wp
         if (self%converged) distance = sqrt(sum(energy_of(state, self%step%q1 - self%step%now%anchor)))
         if (.not. self%converged .or. distance > 5.0_wp*max(1.0_wp, at_last/resistance)*distance_before) then
            call go_back(self, state)
            self%converged = .false.
            resistance = 3.0_wp*resistance
            waits = patience
            if (resistance > most_resistance) exit
            cycle
         end if
         self%converged = .false.
         distance_before = distance
         at_last = resistance
         ! A smaller one that has just failed is tried again later.
         waits = waits - 1
         if (waits < 0) resistance = max(0.3_wp*resistance, least_resistance)
         self%runaway = state%motion%structure%unbounded_spring(self%step%q1)
         if (self%runaway > 0) exit
      end do
      call self%resist(0.0_wp)
      self%most_trials = trials
   end subroutine snap

   !> Whether the trial is a state at rest: in equilibrium without resistance, though its tangent is not
   !> definite. The tangent for the next steps is that with resistance.
   subroutine rest(self, state, resistance)
      class(implicit_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state
      !> Share of the initial stiffness
      real(wp), intent(in) :: resistance

      call self%resist(resistance)
      self%step%now%resistance = 0.0_wp
      call self%tangent%fit(self%step, state, self%h)
      call self%step%find_residual(state, self%h, self%load, self%residual)
      self%converged = self%residual <= resting
   end subroutine rest

   !> Return to where the last round of `snap` began.
   subroutine go_back(self, state)
      class(implicit_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state

      self%step%q1(:) = self%step%now%anchor
      self%step%moved(:) = self%anchor
      call state%springs%restore()
      call state%springs%move_all(self%step%q1)
   end subroutine go_back

   !> Energy that is lost in a step, and that of springs and motion.
   subroutine find_loss(self, state, loss, energy)
      class(implicit_stepper), intent(inout) :: self
      type(state_type), intent(inout) :: state
      !> Energy [J]; that of the motion and the springs is the scale of the loss
      real(wp), intent(out) :: loss, energy
      real(wp) :: kinetic

      call self%find_works(state)
      call state%springs%carry_to(self%step%q1)
      associate (structure => state%motion%structure, work => state%springs%work, &
                 work_before => state%springs%journal%work)
         ! The journal has the works at the start of the step.
         kinetic = structure%kinetic_energy(state%q, state%v)
         if (.not. self%potential_known) self%potential(1) = structure%potential_energy(state%q)
         self%potential_known = .true.
         self%potential(2) = structure%potential_energy(self%step%q1)
         loss = self%of_loads - self%of_damping &
                - (total(size(work), work) - total(size(work), work_before)) &
                - (structure%kinetic_energy(self%step%q1, self%step%w1) - kinetic) &
                - (self%potential(2) - self%potential(1))
         energy = abs(total(size(work), work)) + kinetic + of_potential*abs(self%potential(1))
      end associate
   end subroutine find_loss

   !> Count a step in which a member has snapped; the energy that the jump sets free is lost. The largest loss
   !> is kept with its time and spring.
   subroutine count_snap(self, state, loss)
      class(implicit_stepper), intent(in) :: self
      type(state_type), intent(inout) :: state
      !> Energy lost in the step [J]
      real(wp), intent(in) :: loss

      state%in_snaps = state%in_snaps + loss
      state%snaps = state%snaps + 1
      if (loss < state%largest_snap) return
      state%largest_snap = loss
      state%snap_time = state%begin + state%time + self%h
      ! The spring that has gone farthest, by its energy on the first line.
      state%snap_spring = maxloc(energy_of(state, self%step%q1 - state%q), dim=1)
   end subroutine count_snap

   !> Twice the energies of the springs on their first lines (springs) [J].
   pure function energy_of(state, change) result(energy)
      type(state_type), intent(in) :: state
      !> Of the position (coordinates)
      real(wp), intent(in) :: change(:)
      real(wp) :: energy(state%springs%count)

      energy = state%motion%structure%initial_stiffness*change(:state%springs%count)**2
   end function energy_of

end submodule rbs_solve_time_snap
