!> An implicit step of one body on which springs leave their lines, by Newton's method with all numbers in one
!> record of fixed size: a run alone and a lane of an ensemble fill it, and take from it what it leads to.
!>
!> As in `rbs_solve_time_implicit` every trial goes from the start of the step, each spring in one direction,
!> and a correction that overshoots too far is cut.
module rbs_solve_time_bent_step
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_journal, only: rule_slot, save_rule, return_rule
   use rbs_hysteresis_lone_spring, only: lone_spring
   use rbs_solve_time_state, only: out_of_bounds
   implicit none
   private

   public :: bent_step, bent_spring

   !> Most trials of Newton's method, which mostly needs two; the same number for the cuts of a correction.
   integer, parameter :: most_trials = 8

   !> Most lines of a spring within one step here.
   integer, parameter :: most_lines = 100

   !> Share of the work of the residual on a correction by which the correction may overshoot.
   real(wp), parameter :: too_far = 0.9_wp

   !> How a spring has come to its line in this step: +1 or -1 by the end of another, 0 it was on it before.
   type, extends(lone_spring) :: bent_spring
      integer :: way = 0
   end type bent_spring

   !> Second index, or place of two: slip and rotation, or the body's displacement and rotation.
   type :: bent_step
      !> Parameters of the method, and the share of the forces that the residual may have
      real(wp) :: alpha_m = 0.0_wp, alpha_f = 0.0_wp, beta = 0.25_wp, gamma = 0.5_wp, wanted = 0.0_wp
      !> Step, 1/(beta h**2), lateral force and acceleration of the ground at its end
      real(wp) :: h = -1.0_wp, per_h = 0.0_wp, push = 0.0_wp, ground = 0.0_wp
      !> The column: see `one_body_lanes`
      real(wp) :: mass(2) = 1.0_wp, lower = 0.0_wp, upper = 0.0_wp, softening = 0.0_wp
      !> Deformations, velocities, accelerations and forces at the start; the largest forces so far
      real(wp) :: q0(2) = 0.0_wp, v0(2) = 0.0_wp, a0(2) = 0.0_wp, g0(2) = 0.0_wp, largest(2) = 0.0_wp
      !> The springs; whether the first is told the work of the second at its events; lines left
      type(bent_spring) :: spring(2)
      logical :: hears = .false.
      integer :: events = 0
      !> What the body has moved, the last correction, and the work of the residual on it at its start. The
      !> first is that on the lines of the start, which is given with its work
      real(wp) :: moved(2) = 0.0_wp, dx(2) = 0.0_wp, work = 0.0_wp
      !> At the end: deformations, residual, velocities, accelerations, forces, and what the residual is
      !> measured by
      real(wp) :: q(2) = 0.0_wp, r(2) = 0.0_wp, v1(2) = 0.0_wp, a1(2) = 0.0_wp, g(2) = 0.0_wp, &
                  scale(2) = 0.0_wp
      !> Inverse of the tangent on the lines at the end (11, 12, 21, 22), and the stiffnesses that it is for
      real(wp) :: inverse(4) = 0.0_wp
      real(wp), private :: stiffness(2) = -1.0_wp
      logical, private :: fits = .false.
      !> What velocity and acceleration at the start would move; whether springs have left their lines, and
      !> whether the memories of their rules are saved
      real(wp), private :: before(2) = 0.0_wp
      !> Share of the forces and accelerations at the start in the balance
      real(wp), private :: carried(2) = 0.0_wp
      logical, private :: changed = .false., saved(2) = .false., stuck = .false.
   contains
      procedure :: set_step
      procedure :: solve
      procedure :: fit
   end type bent_step

contains

   !> Another length of the step.
   pure subroutine set_step(self, h)
      class(bent_step), intent(inout) :: self
      real(wp), intent(in) :: h

      self%h = h
      self%per_h = 1.0_wp/(self%beta*h**2)
      self%fits = .false.
   end subroutine set_step

   !> Find the end of the step. If it is not found, the rules are as before.
   subroutine solve(self, slot, kept, taken)
      class(bent_step), intent(inout) :: self
      !> Rules of the springs, and room for copies of them
      type(rule_slot), intent(inout) :: slot(2), kept(2)
      logical, intent(out) :: taken
      type(bent_spring) :: start(2)
      real(wp) :: slope
      integer :: trial, i

      self%spring(1)%way = 0
      self%spring(2)%way = 0
      self%dx = self%moved
      taken = .false.
      self%changed = .false.
      self%stuck = .false.
      self%saved = .false.
      self%events = 0
      self%before(1) = self%h*self%v0(1) + (self%h**2*(0.5_wp - self%beta))*self%a0(1)
      self%before(2) = self%h*self%v0(2) + (self%h**2*(0.5_wp - self%beta))*self%a0(2)
      self%carried(1) = self%alpha_f*self%g0(1) - self%mass(1)*(self%alpha_m*self%a0(1))
      self%carried(2) = self%alpha_f*self%g0(2) - self%mass(2)*(self%alpha_m*self%a0(2))
      do trial = 1, most_trials
         if (trial > 1) then
            call self%fit()
            self%dx(1) = self%inverse(1)*self%r(1) + self%inverse(2)*self%r(2)
            self%dx(2) = self%inverse(3)*self%r(1) + self%inverse(4)*self%r(2)
            self%work = self%r(1)*self%dx(1) + self%r(2)*self%dx(2)
            self%moved(1) = self%moved(1) + self%dx(1)
            self%moved(2) = self%moved(2) + self%dx(2)
         end if
         call look(self, start, slot, kept, slope)
         if (.not. slope < out_of_bounds) exit
         taken = abs(self%r(1)) <= self%wanted*self%scale(1) .and. abs(self%r(2)) <= self%wanted*self%scale(2)
         if (taken) exit
         if (slope < -too_far*self%work) call cut_correction(self, start, slot, kept, slope)
         if (self%stuck) exit
      end do
      if (.not. taken) then
         call put_back(self, start, slot, kept)
         return
      end if
      call self%fit()
      do i = 1, 2
         self%v1(i) = self%v0(i) + (self%h*(1.0_wp - self%gamma))*self%a0(i) + (self%h*self%gamma)*self%a1(i)
         call self%spring(i)%advance_on_branch(self%q(i))
      end do
   end subroutine solve

   !> Find the inverse of the tangent on the present lines.
   pure subroutine fit(self)
      class(bent_step), intent(inout) :: self
      real(wp) :: of_mass, shear, along, across, about, share

      if (self%fits .and. .not. (abs(self%spring(1)%line%k - self%stiffness(1)) > 0.0_wp .or. &
                                 abs(self%spring(2)%line%k - self%stiffness(2)) > 0.0_wp)) return
      self%stiffness(1) = self%spring(1)%line%k
      self%stiffness(2) = self%spring(2)%line%k
      of_mass = (1.0_wp - self%alpha_m)*self%per_h
      shear = (1.0_wp - self%alpha_f)*self%stiffness(1)
      along = shear + of_mass*self%mass(1)
      across = -shear*self%lower
      about = shear*self%lower**2 + (1.0_wp - self%alpha_f)*self%stiffness(2) + of_mass*self%mass(2) &
              - (1.0_wp - self%alpha_f)*self%softening
      ! Where the column softens more than its inertia holds, the pivot is negative. One that is nearly zero
      ! gives a step that does not converge.
      share = across/along
      about = 1.0_wp/(about - share*across)
      self%inverse(1) = 1.0_wp/along + share*about*share
      self%inverse(2) = -share*about
      self%inverse(3) = -share*about
      self%inverse(4) = about
      self%fits = .true.
   end subroutine fit

   !> The correction has gone too far: go back to where the residual does little work on it, by the method of
   !> false position (Illinois).
   subroutine cut_correction(self, start, slot, kept, slope)
      class(bent_step), intent(inout) :: self
      type(bent_spring), intent(inout) :: start(2)
      type(rule_slot), intent(inout) :: slot(2), kept(2)
      !> Work of the residual on the correction at its end
      real(wp), intent(inout) :: slope
      real(wp) :: low, high, at_low, at_high, share, now
      integer :: trial

      low = 0.0_wp
      high = 1.0_wp
      at_low = self%work
      at_high = slope
      now = 1.0_wp
      do trial = 1, most_trials
         share = low + (high - low)*at_low/(at_low - at_high)
         self%moved = self%moved + (share - now)*self%dx
         now = share
         call look(self, start, slot, kept, slope)
         if (abs(slope) <= too_far/3.0_wp*self%work .or. self%stuck) return
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
   end subroutine cut_correction

   !> Look where the body is when it has moved so far: put the springs on their lines there, find what is left
   !> of the balance, and its work on the correction.
   subroutine look(self, start, slot, kept, slope)
      class(bent_step), intent(inout) :: self
      type(bent_spring), intent(inout) :: start(2)
      type(rule_slot), intent(inout) :: slot(2), kept(2)
      !> `huge`: out of bounds, or the springs go round in lines
      real(wp), intent(out) :: slope

      slope = huge(1.0_wp)
      self%q(1) = self%q0(1) + (self%moved(1) - self%lower*self%moved(2))
      self%q(2) = self%q0(2) + self%moved(2)
      if (.not. (abs(self%q(1)) < out_of_bounds .and. abs(self%q(2)) < out_of_bounds)) return
      if (.not. (is_on_line(self%spring(1), self%q(1)) .and. is_on_line(self%spring(2), self%q(2)))) then
         if (self%changed) call put_back(self, start, slot, kept)
         self%changed = .true.
         call find_line(self, 1, start(1), slot(1), kept(1))
         call find_line(self, 2, start(2), slot(2), kept(2))
         if (self%stuck) return
      end if
      call find_residual(self)
      slope = self%r(1)*self%dx(1) + self%r(2)*self%dx(2)
   end subroutine look

   !> Whether a spring that goes to q is on its line there: one that has come to it by the end of another is
   !> beyond that end.
   pure logical function is_on_line(spring, q)
      type(bent_spring), intent(in) :: spring
      real(wp), intent(in) :: q

      is_on_line = spring%side(q) == 0 .and. spring%way*(q - spring%d) >= 0.0_wp
   end function is_on_line

   !> Put a spring, which is at the start of the step, on the line that it is on at the end. It stays where
   !> that line begins.
   subroutine find_line(self, i, start, slot, kept)
      class(bent_step), intent(inout) :: self
      integer, intent(in) :: i
      !> Where it was, once it has left its line
      type(bent_spring), intent(inout) :: start
      type(rule_slot), intent(inout) :: slot, kept
      integer :: lines, way

      associate (spring => self%spring(i))
         do lines = 1, most_lines
            way = spring%side(self%q(i))
            if (way == 0) return
            spring%way = way
            if (.not. self%saved(i)) then
               start = spring
               call save_rule(slot, kept)
               self%saved(i) = .true.
            end if
            if (i == 1 .and. self%hears) call slot%rule%hear(self%spring(2)%work)
            call spring%change_line(slot%rule, way)
            self%events = self%events + 1
            ! A new one-way line starts at the present deformation, to the last bit.
            if (spring%line%one_way > 0) spring%first = spring%d
            if (spring%line%one_way < 0) spring%last = spring%d
         end do
      end associate
      self%stuck = .true.
   end subroutine find_line

   !> Put the springs back to the start of the step.
   subroutine put_back(self, start, slot, kept)
      class(bent_step), intent(inout) :: self
      type(bent_spring), intent(in) :: start(2)
      type(rule_slot), intent(inout) :: slot(2)
      type(rule_slot), intent(in) :: kept(2)
      integer :: i

      self%events = 0
      do i = 1, 2
         if (.not. self%saved(i)) cycle
         self%spring(i) = start(i)
         call return_rule(slot(i), kept(i))
         self%saved(i) = .false.
      end do
   end subroutine put_back

   !> What is left of the balance where the body has moved so far.
   pure subroutine find_residual(self)
      class(bent_step), intent(inout) :: self
      real(wp) :: shear, moment, inertia_1, inertia_2

      self%a1(1) = (self%moved(1) - self%before(1))*self%per_h
      self%a1(2) = (self%moved(2) - self%before(2))*self%per_h
      inertia_1 = self%mass(1)*self%a1(1)
      inertia_2 = self%mass(2)*self%a1(2)
      associate (line_1 => self%spring(1)%line, line_2 => self%spring(2)%line)
         shear = line_1%f0 + line_1%k*(self%q(1) - line_1%d0)
         moment = line_2%f0 + line_2%k*(self%q(2) - line_2%d0)
      end associate
      self%g(1) = (self%push - shear) - self%mass(1)*self%ground
      self%g(2) = ((self%lower*shear + self%upper*self%push) - moment) + self%softening*self%q(2)
      self%r(1) = (1.0_wp - self%alpha_f)*self%g(1) + (self%carried(1) - (1.0_wp - self%alpha_m)*inertia_1)
      self%r(2) = (1.0_wp - self%alpha_f)*self%g(2) + (self%carried(2) - (1.0_wp - self%alpha_m)*inertia_2)
      self%scale(1) = max(self%largest(1), abs(shear), abs(self%push), abs(inertia_1))
      self%scale(2) = max(self%largest(2), abs(moment), abs(self%push)*self%upper, abs(inertia_2))
   end subroutine find_residual

end module rbs_solve_time_bent_step
