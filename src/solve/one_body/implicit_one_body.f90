!> Implicit steps of one body with small rotations: the equations of
!> `rbs_solve_time_implicit_balance` with all numbers in one record of fixed size, for a run alone and for a
!> lane of an ensemble. On the present lines the tangent of two by two is inverted once for all steps; a step
!> on which springs leave their lines is found by Newton's method. Where a step is not found here, nothing has
!> happened and it is taken there.
!>
!> As in `rbs_solve_time_implicit` every trial starts from the start of the step, each spring in one
!> direction, and a correction that overshoots too far is cut.
module rbs_solve_one_body_implicit_one_body
   use rbs_base_constants, only: out_of_bounds
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_journal, only: save_memory, return_memory
   use rbs_hysteresis_rule, only: spring_slot
   use rbs_hysteresis_segment, only: segment, lowest_on, highest_on
   use rbs_hysteresis_springs, only: spring_array, most_lines
   use rbs_solve_line_search, only: false_position
   use rbs_solve_one_body_body_damping, only: body_damping
   implicit none
   private

   public :: one_body_step, body_spring, side_of, move_spring, advance_on_branch

   !> Most trials of Newton's method, which mostly needs two; the same number for the cuts of a correction.
   integer, parameter :: most_trials = 8

   !> Most lines of a spring within one step of Newton's method.
   integer, parameter :: most_changes = 100

   !> Share of the work of the residual on a correction by which the correction may overshoot.
   real(wp), parameter :: too_far = 0.9_wp

   !> One spring beside its rule: its line, the lowest and the highest deformation that belong to the line,
   !> present deformation and work, and how it has come to its line in this step: +1 or -1 by the end of
   !> another, 0 it was on it before. It moves as those of `rbs_hysteresis_springs` do, with the same
   !> bits.
   type :: body_spring
      type(segment) :: line
      real(wp) :: lower = 0.0_wp, upper = 0.0_wp, d = 0.0_wp, work = 0.0_wp
      integer :: direction = 0
   end type body_spring

   !> Second index, or place of two: slip and rotation, or the body's displacement and rotation.
   type :: one_body_step
      !> Parameters of the method, and the share of the forces that the residual may have
      real(wp) :: alpha_m = 0.0_wp, alpha_f = 0.0_wp, beta = 0.25_wp, gamma = 0.5_wp, wanted = 0.0_wp
      !> Step, 1/(beta h**2), lateral force and acceleration of the ground at its end
      real(wp) :: h = -1.0_wp, per_h = 0.0_wp, push = 0.0_wp, ground = 0.0_wp
      !> The column: mass and rotary inertia, distances of the centroid from bottom and top, and the moment of
      !> the axial force per rotation
      real(wp) :: mass(2) = 1.0_wp, lower = 0.0_wp, upper = 0.0_wp, pdelta_moment = 0.0_wp
      !> Its damping, and C on the lines that the tangent is for
      type(body_damping) :: damping
      real(wp) :: c(3) = 0.0_wp
      !> Deformations, velocities, accelerations and forces at the start; the largest forces so far
      real(wp) :: q0(2) = 0.0_wp, v0(2) = 0.0_wp, a0(2) = 0.0_wp, g0(2) = 0.0_wp, largest(2) = 0.0_wp
      !> The springs at the start, and now, which is the same at first; branches left
      type(body_spring) :: start(2), spring(2)
      integer :: events = 0
      !> Motion of the body, its last correction, and the work of the residual on it at its start. The
      !> first is that on the lines of the start, which is given with its work
      real(wp) :: moved(2) = 0.0_wp, dx(2) = 0.0_wp, work = 0.0_wp
      !> At the end: deformations, residual, velocities, accelerations, forces, and the forces that the
      !> residual is measured by
      real(wp) :: q(2) = 0.0_wp, r(2) = 0.0_wp, v1(2) = 0.0_wp, a1(2) = 0.0_wp, g(2) = 0.0_wp, &
                  scale(2) = 0.0_wp
      !> Inverse of the tangent (11, 12, 21, 22), the stiffnesses that it is for, whether it is for the
      !> present column and step, and the lines that it belongs to
      real(wp) :: inverse(4) = 0.0_wp
      real(wp), private :: stiffness(2) = -1.0_wp
      logical :: fits = .false.
      integer, private :: version = -1
      !> Motion by velocity and acceleration at the start; share of the forces and accelerations at the
      !> start in the balance
      real(wp), private :: before(2) = 0.0_wp, carried(2) = 0.0_wp
      !> Whether a rule cycles through lines
      logical, private :: stuck = .false.
   contains
      procedure :: set_step, take_step, fit_to, solve, work_of_damping
   end type one_body_step

contains

   !> Set another length of the step; the inverse of the tangent, which is for the length before, is to be
   !> found anew.
   pure subroutine set_step(self, h)
      class(one_body_step), intent(inout) :: self
      !> Step [s]
      real(wp), intent(in) :: h

      self%h = h
      self%per_h = 1.0_wp/(self%beta*h**2)
      self%fits = .false.
      self%version = -1
   end subroutine set_step

   !> Take a step on the present lines of both springs, or along the lines that follow. If it is not found so,
   !> nothing has happened; else the springs are at its end.
   subroutine take_step(self, springs, q, v0, a0, g0, largest, push, ground, taken)
      class(one_body_step), intent(inout) :: self
      type(spring_array), intent(inout) :: springs
      !> At the start: deformations; velocities, accelerations and forces of the body; largest forces so far
      real(wp), intent(in) :: q(2), v0(2), a0(2), g0(2), largest(2)
      !> Lateral force [N] and acceleration of the ground [m/s2] at the end
      real(wp), intent(in) :: push, ground
      !> Whether the end of the step was found
      logical, intent(out) :: taken
      real(wp) :: before_1, before_2, shear, moment, moved_1, moved_2, to_1, to_2
      real(wp) :: v1_1, v1_2, a1_1, a1_2, g1_1, g1_2, start_1, start_2, rest_1, rest_2, scale_1, scale_2
      real(wp) :: x12, x22

      taken = .false.
      call self%fit_to(springs)
      associate (h => self%h, per_h => self%per_h, alpha_m => self%alpha_m, alpha_f => self%alpha_f, &
                 beta => self%beta, gamma => self%gamma, mass_1 => self%mass(1), mass_2 => self%mass(2), &
                 lower => self%lower, upper => self%upper, pdelta_moment => self%pdelta_moment, &
                 inverse_11 => self%inverse(1), inverse_12 => self%inverse(2), &
                 inverse_21 => self%inverse(3), inverse_22 => self%inverse(4), &
                 damped => self%damping%acts, c11 => self%c(1), c12 => self%c(2), c22 => self%c(3), &
                 d0_1 => springs%d0(1), f0_1 => springs%f0(1), k_1 => springs%k(1), &
                 d0_2 => springs%d0(2), f0_2 => springs%f0(2), k_2 => springs%k(2), &
                 q_1 => q(1), q_2 => q(2), v0_1 => v0(1), v0_2 => v0(2), a0_1 => a0(1), a0_2 => a0(2), &
                 g0_1 => g0(1), g0_2 => g0(2), largest_1 => largest(1), largest_2 => largest(2))
         ! From these names it finds the end of the step: `to`, `v1`, `a1`, `g1`, what is left out of balance
         ! (`rest`) and the forces to measure it by (`scale`).
         include 'implicit_step.inc'
      end associate
      ! NaN fails this comparison too.
      if (.not. (abs(to_1) < out_of_bounds .and. abs(to_2) < out_of_bounds)) return
      taken = to_1 <= springs%upper(1) .and. to_1 >= springs%lower(1) .and. &
              to_2 <= springs%upper(2) .and. to_2 >= springs%lower(2) .and. &
              abs(rest_1) <= self%wanted*scale_1 .and. abs(rest_2) <= self%wanted*scale_2
      self%moved = [moved_1, moved_2]
      if (taken) then
         self%q = [to_1, to_2]
         self%v1 = [v1_1, v1_2]
         self%a1 = [a1_1, a1_2]
         self%g = [g1_1, g1_2]
         self%scale = [scale_1, scale_2]
         call springs%carry_to(self%q)
      else
         ! This is the trial from which the way along other lines is searched.
         self%work = start_1*moved_1 + start_2*moved_2
         self%push = push
         self%ground = ground
         self%q0 = q
         self%v0 = v0
         self%a0 = a0
         self%g0 = g0
         self%largest = largest
         call follow_lines(self, springs, taken)
      end if
   end subroutine take_step

   !> Find the end of the step from the trial that has left the lines, along the lines that follow, and put
   !> the springs there; else the springs are as before.
   subroutine follow_lines(self, springs, taken)
      type(one_body_step), intent(inout) :: self
      type(spring_array), intent(inout) :: springs
      !> Whether the end was found
      logical, intent(out) :: taken
      integer :: i

      do i = 1, 2
         self%start(i) = body_spring(springs%line_of(i), springs%lower(i), springs%upper(i), springs%d(i), &
                                     springs%work(i))
         self%spring(i) = self%start(i)
      end do
      call self%solve(springs%slot, taken)
      if (.not. taken) return
      do i = 1, 2
         call springs%put(i, self%spring(i)%line, self%spring(i)%d, self%spring(i)%work)
      end do
      springs%events = springs%events + self%events
      self%version = springs%version
   end subroutine follow_lines

   !> Find the inverse of the tangent on the present lines, unless it is there already: springs have the same
   !> version as long as none changes its line.
   pure subroutine fit_to(self, springs)
      class(one_body_step), intent(inout) :: self
      type(spring_array), intent(in) :: springs

      if (self%version == springs%version) return
      self%spring(1)%line%k = springs%k(1)
      self%spring(2)%line%k = springs%k(2)
      call fit(self)
      self%version = springs%version
   end subroutine fit_to

   !> Find the end of the step by Newton's method, from the trial `moved`, whose residual did `work` on it. If
   !> it is not found, the memories are as before.
   subroutine solve(self, slot, taken)
      class(one_body_step), intent(inout) :: self
      !> Rules and memories of the springs
      type(spring_slot), intent(inout) :: slot(2)
      !> Whether the end was found
      logical, intent(out) :: taken
      !> Work of the residual on the last correction, at its end; out of bounds where there is none
      real(wp) :: slope
      integer :: trial, i

      self%dx = self%moved
      taken = .false.
      self%stuck = .false.
      self%events = 0
      ! Shares of the start of the step in the motion, and in the balance
      self%before(1) = self%h*self%v0(1) + (self%h**2*(0.5_wp - self%beta))*self%a0(1)
      self%before(2) = self%h*self%v0(2) + (self%h**2*(0.5_wp - self%beta))*self%a0(2)
      self%carried(1) = self%alpha_f*self%g0(1) - self%mass(1)*(self%alpha_m*self%a0(1))
      self%carried(2) = self%alpha_f*self%g0(2) - self%mass(2)*(self%alpha_m*self%a0(2))
      do trial = 1, most_trials
         ! The first trial is given; each other one follows from the residual of the one before.
         if (trial > 1) then
            call fit(self)
            self%dx(1) = self%inverse(1)*self%r(1) + self%inverse(2)*self%r(2)
            self%dx(2) = self%inverse(3)*self%r(1) + self%inverse(4)*self%r(2)
            self%work = self%r(1)*self%dx(1) + self%r(2)*self%dx(2)
            self%moved(1) = self%moved(1) + self%dx(1)
            self%moved(2) = self%moved(2) + self%dx(2)
         end if
         call check_end(self, slot, slope)
         if (.not. slope < out_of_bounds) exit
         taken = abs(self%r(1)) <= self%wanted*self%scale(1) .and. abs(self%r(2)) <= self%wanted*self%scale(2)
         if (taken) exit
         if (slope < -too_far*self%work) call cut_correction(self, slot, slope)
         if (self%stuck) exit
      end do
      if (.not. taken) then
         call put_back(self, slot)
         return
      end if
      call fit(self)
      do i = 1, 2
         self%v1(i) = self%v0(i) + (self%h*(1.0_wp - self%gamma))*self%a0(i) + (self%h*self%gamma)*self%a1(i)
         call advance_on_branch(self%spring(i), self%q(i))
      end do
   end subroutine solve

   !> Find the inverse of the tangent of the step on the present lines, in displacement and rotation of the
   !> body: mass, damping and stiffness as the parameters of the method weigh them.
   pure subroutine fit(self)
      type(one_body_step), intent(inout) :: self
      real(wp) :: of_mass, per_velocity, shear, both, slip, mixed, moment, share

      if (self%fits .and. .not. (abs(self%spring(1)%line%k - self%stiffness(1)) > 0.0_wp .or. &
                                 abs(self%spring(2)%line%k - self%stiffness(2)) > 0.0_wp)) return
      self%stiffness(1) = self%spring(1)%line%k
      self%stiffness(2) = self%spring(2)%line%k
      of_mass = (1.0_wp - self%alpha_m)*self%per_h
      per_velocity = 0.0_wp
      if (self%damping%acts) then
         self%c = self%damping%on_lines(self%stiffness(1), self%stiffness(2))
         per_velocity = (self%h*self%gamma)*self%per_h
      end if
      shear = (1.0_wp - self%alpha_f)*(self%stiffness(1) + per_velocity*self%c(1))
      both = (1.0_wp - self%alpha_f)*(per_velocity*self%c(2))
      slip = shear + of_mass*self%mass(1)
      mixed = both - shear*self%lower
      moment = shear*self%lower**2 - 2.0_wp*self%lower*both &
              + (1.0_wp - self%alpha_f)*(self%stiffness(2) + per_velocity*self%c(3)) + of_mass*self%mass(2) &
              - (1.0_wp - self%alpha_f)*self%pdelta_moment
      ! Where the column softens more than its inertia holds, the pivot is negative. One that is nearly zero
      ! gives a step that does not converge.
      share = mixed/slip
      moment = 1.0_wp/(moment - share*mixed)
      self%inverse(1) = 1.0_wp/slip + share*moment*share
      self%inverse(2) = -share*moment
      self%inverse(3) = -share*moment
      self%inverse(4) = moment
      self%fits = .true.
   end subroutine fit

   !> The correction was too long: return to where the residual does little work on it, by the method of
   !> false position (Illinois).
   subroutine cut_correction(self, slot, slope)
      type(one_body_step), intent(inout) :: self
      type(spring_slot), intent(inout) :: slot(2)
      !> Work of the residual on the correction at its end
      real(wp), intent(inout) :: slope
      type(false_position) :: bracket
      real(wp) :: share, now
      integer :: trial

      ! Between the start of the correction, share 0, and its end, share 1
      bracket = false_position(0.0_wp, 1.0_wp, self%work, slope)
      now = 1.0_wp
      do trial = 1, most_trials
         share = bracket%next()
         self%moved = self%moved + (share - now)*self%dx
         now = share
         call check_end(self, slot, slope)
         if (abs(slope) <= too_far/3.0_wp*self%work .or. self%stuck) return
         call bracket%narrow(share, slope)
      end do
   end subroutine cut_correction

   !> A trial at a displacement of the body: the springs move along their lines. It gives the residual of the
   !> balance, and its work on the correction.
   subroutine check_end(self, slot, slope)
      type(one_body_step), intent(inout) :: self
      type(spring_slot), intent(inout) :: slot(2)
      !> Work of the residual on the last correction; `huge`: out of bounds, or a rule cycles through lines
      real(wp), intent(out) :: slope

      slope = huge(1.0_wp)
      self%q(1) = self%q0(1) + (self%moved(1) - self%lower*self%moved(2))
      self%q(2) = self%q0(2) + self%moved(2)
      if (.not. (abs(self%q(1)) < out_of_bounds .and. abs(self%q(2)) < out_of_bounds)) return
      if (.not. (is_on_line(self%spring(1), self%q(1)) .and. is_on_line(self%spring(2), self%q(2)))) then
         ! Every trial starts from the start of the step.
         if (self%events > 0) call put_back(self, slot)
         call find_line(self, 1, slot)
         call find_line(self, 2, slot)
         if (self%stuck) return
      end if
      call find_residual(self)
      slope = self%r(1)*self%dx(1) + self%r(2)*self%dx(2)
   end subroutine check_end

   !> Whether a spring that moves to q is on its line there: one that has come to it by the end of another is
   !> beyond that end.
   pure logical function is_on_line(spring, q)
      type(body_spring), intent(in) :: spring
      !> Deformation that it moves to [m or rad]
      real(wp), intent(in) :: q

      is_on_line = side_of(spring, q) == 0 .and. spring%direction*(q - spring%d) >= 0.0_wp
   end function is_on_line

   !> Put spring i (1: slip, 2: rotation), which is at the start of the step, on the line that it is on at the
   !> end. Its deformation stays where that line begins.
   subroutine find_line(self, i, slot)
      type(one_body_step), intent(inout) :: self
      integer, intent(in) :: i
      type(spring_slot), intent(inout) :: slot(2)
      integer :: lines, direction

      associate (spring => self%spring(i))
         do lines = 1, most_changes
            direction = side_of(spring, self%q(i))
            if (direction == 0) return
            ! The rule is about to change the memory for the first time in this step.
            if (spring%direction == 0) call save_memory(slot(i))
            spring%direction = direction
            call change_line(spring, slot(i), direction, self%spring(2)%work)
            self%events = self%events + 1
            ! A new one-way line starts at the present deformation, to the last bit.
            if (spring%line%unload_on_reversal > 0) spring%lower = spring%d
            if (spring%line%unload_on_reversal < 0) spring%upper = spring%d
         end do
      end associate
      self%stuck = .true.
   end subroutine find_line

   !> Put the springs back to the start of the step.
   subroutine put_back(self, slot)
      type(one_body_step), intent(inout) :: self
      type(spring_slot), intent(inout) :: slot(2)
      integer :: i

      self%events = 0
      do i = 1, 2
         ! Still on the line of the start.
         if (self%spring(i)%direction == 0) cycle
         self%spring(i) = self%start(i)
         call return_memory(slot(i))
      end do
   end subroutine put_back

   !> Residual of the balance for the present motion of the body, and the forces that it is measured by: (1)
   !> along the displacement of the body, (2) about its centroid.
   pure subroutine find_residual(self)
      type(one_body_step), intent(inout) :: self
      real(wp) :: shear, moment, inertia_1, inertia_2, v(2), c(3), damping(2)

      self%a1(1) = (self%moved(1) - self%before(1))*self%per_h
      self%a1(2) = (self%moved(2) - self%before(2))*self%per_h
      inertia_1 = self%mass(1)*self%a1(1)
      inertia_2 = self%mass(2)*self%a1(2)
      associate (line_1 => self%spring(1)%line, line_2 => self%spring(2)%line)
         shear = line_1%f0 + line_1%k*(self%q(1) - line_1%d0)
         moment = line_2%f0 + line_2%k*(self%q(2) - line_2%d0)
      end associate
      self%g(1) = (self%push - shear) - self%mass(1)*self%ground
      self%g(2) = ((self%lower*shear + self%upper*self%push) - moment) + self%pdelta_moment*self%q(2)
      if (self%damping%acts) then
         v = self%v0 + (self%h*(1.0_wp - self%gamma))*self%a0 + (self%h*self%gamma)*self%a1
         ! The velocity of the slip is that of the bottom of the body.
         v(1) = v(1) - self%lower*v(2)
         c = self%damping%on_lines(self%spring(1)%line%k, self%spring(2)%line%k)
         damping = [c(1)*v(1) + c(2)*v(2), c(2)*v(1) + c(3)*v(2)]
         self%g(1) = self%g(1) - damping(1)
         self%g(2) = self%g(2) + (self%lower*damping(1) - damping(2))
      end if
      self%r(1) = (1.0_wp - self%alpha_f)*self%g(1) + (self%carried(1) - (1.0_wp - self%alpha_m)*inertia_1)
      self%r(2) = (1.0_wp - self%alpha_f)*self%g(2) + (self%carried(2) - (1.0_wp - self%alpha_m)*inertia_2)
      self%scale(1) = max(self%largest(1), abs(shear), abs(self%push), abs(inertia_1))
      self%scale(2) = max(self%largest(2), abs(moment), abs(self%push)*self%upper, abs(inertia_2))
   end subroutine find_residual

   !> Work of the damping in the step that has been found [J].
   pure real(wp) function work_of_damping(self, v0) result(work)
      class(one_body_step), intent(in) :: self
      !> Velocities of the body at its start
      real(wp), intent(in) :: v0(2)
      real(wp) :: v(2)

      v = 0.5_wp*(v0 + self%v1)
      v(1) = v(1) - self%lower*v(2)
      work = self%h*(self%c(1)*v(1)**2 + 2.0_wp*self%c(2)*v(1)*v(2) + self%c(3)*v(2)**2)
   end function work_of_damping

   !> By which end of the line a deformation lies: +1, -1, or 0 if it lies on the line.
   pure integer function side_of(spring, d) result(side)
      type(body_spring), intent(in) :: spring
      !> Deformation [m or rad]
      real(wp), intent(in) :: d

      side = 0
      if (d > spring%upper) then
         side = 1
      else if (d < spring%lower) then
         side = -1
      end if
   end function side_of

   !> Move monotonically to d, over any number of lines.
   subroutine move_spring(spring, slot, d, flexural_work, events, stuck)
      type(body_spring), intent(inout) :: spring
      type(spring_slot), intent(inout) :: slot
      !> New deformation [m or rad]
      real(wp), intent(in) :: d
      !> Work of the spring of rotation so far, with which a rule of the slip may decay [J]
      real(wp), intent(in) :: flexural_work
      !> Number of lines left; whether the rule cycles through lines without length
      integer, intent(out) :: events
      logical, intent(out) :: stuck
      integer :: direction

      stuck = .false.
      do events = 0, most_lines - 1
         direction = side_of(spring, d)
         if (direction == 0) then
            call advance_on_branch(spring, d)
            return
         end if
         call change_line(spring, slot, direction, flexural_work)
      end do
      stuck = .true.
   end subroutine move_spring

   !> Move along the line to d; the rear end of a one-way line follows.
   pure subroutine advance_on_branch(spring, d)
      type(body_spring), intent(inout) :: spring
      !> New deformation on the present line [m or rad]
      real(wp), intent(in) :: d

      associate (line => spring%line)
         spring%work = spring%work + (line%f0 + line%k*(0.5_wp*(d + spring%d) - line%d0))*(d - spring%d)
         spring%d = d
         if (line%unload_on_reversal > 0) spring%lower = d
         if (line%unload_on_reversal < 0) spring%upper = d
      end associate
   end subroutine advance_on_branch

   !> Move to the end of the line and get the line that follows from the rule. When the motion turns back, a
   !> one-way line ends at the present deformation.
   subroutine change_line(spring, slot, direction, flexural_work)
      type(body_spring), intent(inout) :: spring
      type(spring_slot), intent(inout) :: slot
      !> +1: by the upper end, -1: by the lower end
      integer, intent(in) :: direction
      !> Work of the spring of rotation so far, with which a rule of the slip may decay [J]
      real(wp), intent(in) :: flexural_work

      associate (line => spring%line)
         if (line%unload_on_reversal > 0) line%lo = spring%d
         if (line%unload_on_reversal < 0) line%hi = spring%d
         ! Back on a one-way line the end is where the spring is.
         if (line%unload_on_reversal /= -direction) then
            call advance_on_branch(spring, merge(line%hi, line%lo, direction > 0))
         end if
         call slot%next_branch(line, direction, flexural_work)
         spring%lower = lowest_on(line)
         spring%upper = highest_on(line)
      end associate
   end subroutine change_line

end module rbs_solve_one_body_implicit_one_body
