!> Points of a curved path: the next event or target, found by Newton's method from the point that is tried;
!> where a motion turns back; and the works between two points.
module rbs_solve_static_curved_search
   use rbs_base_kinds, only: wp
   use rbs_base_tolerances, only: round_off_of_sums
   use rbs_hysteresis_interaction_joints, only: moment_on_plane, place_lines
   use rbs_solve_line_search, only: false_position
   use rbs_solve_static_curve, only: clean, curve_type, same_rate
   use rbs_solve_static_curved_equilibrium, only: curved_equilibrium, path_point
   use rbs_solve_static_path, only: static_path
   use rbs_structure_structure, only: finite
   implicit none
   private

   public :: curve_search, find_event, find_point, find_turn, find_works
   public :: layer_of, move_to, no_progress, work_of_joint

   !> Newton's method has converged if a change is below this share of the largest deformation of its kind:
   !> the next one would be its square. Where round-off ends the progress before, that must be below the
   !> second share.
   real(wp), parameter :: arrived = 1.0e-10_wp, no_progress = 1.0e-7_wp
   integer, parameter :: most_iterations = 15

   !> Largest correction by slopes of the work of a stride under a constant axial load, and the largest
   !> residual of its works under one that varies, with exact rotations and without; as shares of the largest
   !> energy so far.
   real(wp), parameter :: most_correction = 1.0e-5_wp, largest_residual(2) = [1.0e-12_wp, 1.0e-13_wp]

   type, abstract, extends(static_path) :: curve_search
      type(curved_equilibrium) :: equilibrium
      !> The present point and the one that is tried, the curve between the first and the farthest tried, and
      !> the spring or layer that is on the end of its line there; 0 for none
      type(path_point) :: current, trial
      type(curve_type) :: curve
      integer :: line = 0
      !> Largest work of the lateral force so far, in size [J]
      real(wp) :: most_work = 0.0_wp
   end type curve_search

contains

   !> Go from the point that is tried along its tangent to the first end of a line, if there is one before
   !> the limit, else to the limit; not back beyond the present point.
   subroutine find_event(self, limit, change)
      class(curve_search), intent(inout) :: self
      !> Value of the parameter to go to at the most
      real(wp), intent(in) :: limit
      !> Change of the deformations, to which the motion is added
      real(wp), intent(inout), optional :: change(:)
      real(wp) :: clearance, distance, finish
      integer :: i, side

      self%line = 0
      associate (trial => self%trial, lines => self%curve%lines)
         clearance = self%direction*(limit - trial%t)
         do i = 1, size(trial%v)
            associate (rise => self%direction*trial%v(i))
               if (.not. abs(rise) > 0.0_wp) cycle
               side = merge(1, -1, rise > 0.0_wp)
               ! Back on a one-way line there is no end, but a turn, which `find_turn` finds.
               if (lines%one_way(i) == -side) cycle
               distance = side*(merge(lines%upper(i), lines%lower(i), side > 0) - trial%d(i))
               if (distance < clearance*abs(rise)) then
                  clearance = distance/abs(rise)
                  self%line = i
                  finish = merge(lines%upper(i), lines%lower(i), side > 0)
               end if
            end associate
         end do
         clearance = max(clearance, self%direction*(self%current%t - trial%t))
         if (present(change)) change = change + trial%rate*(self%direction*clearance)
         call move(self, self%direction*clearance)
         if (self%line == 0) then
            trial%t = limit
         else if (self%line <= self%springs%count) then
            trial%q(self%line) = finish
         end if
      end associate
   end subroutine find_event

   !> Deformations and rates of springs and layers at a point.
   subroutine move_to(self, point)
      class(curve_search), intent(in) :: self
      type(path_point), intent(inout) :: point

      call place_lines(self%springs, self%curve%lines, point%q, &
                       point%axial_load + self%equilibrium%above, point%rate, point%axial_rate, &
                       point%d, point%v)
   end subroutine move_to

   !> Which layer of a joint, from 1, is on the end of its line at the point that is tried; 0 for none.
   pure integer function layer_of(self, joint)
      class(curve_search), intent(in) :: self
      integer, intent(in) :: joint

      layer_of = 0
      if (self%line == 0) return
      associate (of => self%curve%lines%joint)
         if (of(self%line) == joint) layer_of = self%line - findloc(of, joint, dim=1) + 1
      end associate
   end function layer_of

   !> Move the point that is tried along its tangent.
   subroutine move(self, step)
      class(curve_search), intent(inout) :: self
      !> Change of the parameter
      real(wp), intent(in) :: step

      associate (trial => self%trial)
         trial%t = trial%t + step
         trial%q = trial%q + trial%rate*step
         trial%d = trial%d + trial%v*step
         trial%force = trial%force + trial%force_rate*step
         trial%displacement = trial%displacement + trial%displacement_rate*step
         trial%axial_load = trial%axial_load + trial%axial_rate*step
      end associate
   end subroutine move

   !> Newton's method from the point that is tried to the first event before a limit, or to the limit.
   subroutine find_point(self, limit, with_events, found)
      class(curve_search), intent(inout) :: self
      !> Value of the parameter to go to at the most
      real(wp), intent(in) :: limit
      !> Whether the point is that of an event, if there is one before the limit
      logical, intent(in) :: with_events
      !> Whether Newton's method has converged
      logical, intent(out) :: found
      real(wp) :: change(size(self%current%q)), share, last_share
      logical :: regular
      integer :: i

      found = .false.
      last_share = huge(1.0_wp)
      associate (trial => self%trial, equilibrium => self%equilibrium)
         do i = 1, most_iterations
            call equilibrium%solve(self%springs, trial, regular)
            if (.not. regular) return
            if (equilibrium%varies) trial%rate = clean(equilibrium%column, trial)
            change = equilibrium%correction
            trial%q = trial%q + change
            trial%force = trial%force + equilibrium%force_correction
            trial%axial_load = trial%axial_load + equilibrium%ratio*equilibrium%force_correction
            call move_to(self, trial)
            if (with_events) call find_event(self, limit, change)
            ! Converged, or as near as round-off lets it come.
            share = equilibrium%size_of(change, trial%q - change)
            found = share <= arrived .or. (share <= no_progress .and. share > 0.25_wp*last_share)
            if (found) exit
            if (i > 3 .and. share > 2.0_wp*last_share) return
            last_share = share
         end do
         if (.not. found) return
         if (self%equilibrium%by_force) then
            trial%force = equilibrium%driven(1) + equilibrium%driven(2)*trial%t
            trial%displacement = self%equilibrium%column%top_displacement(trial%q)
         else
            trial%displacement = equilibrium%driven(1) + equilibrium%driven(2)*trial%t
         end if
      end associate
   end subroutine find_point

   !> Find, by false position, the point of the curve where the first motion on a one-way line turns back.
   subroutine find_turn(self, done)
      class(curve_search), intent(inout) :: self
      !> Whether it was found
      logical, intent(out) :: done
      type(false_position) :: line
      real(wp) :: value, reached
      integer :: i

      self%line = 0
      ! Between the present point, before the turn, and the farthest tried, beyond it
      line = false_position(self%current%t, self%trial%t, self%curve%least_rate(self%current), &
                            self%curve%least_rate(self%trial))
      done = line%at_low > 0.0_wp .and. line%at_high < 0.0_wp
      if (.not. done) return
      do i = 1, 60
         reached = line%next()
         ! False position may be slow beside a root: then halve.
         if (i > 40) reached = 0.5_wp*(line%low + line%high)
         call self%curve%guess(reached, self%trial)
         call find_point(self, reached, .false., done)
         if (.not. done) return
         value = self%curve%least_rate(self%trial)
         ! It is the least rate plus `same_rate`: between -0.9 and 0.9 of that the rate itself is just below
         ! zero, and the point is just beyond the turn.
         if (abs(value) < 0.9_wp*same_rate) return
         call line%narrow(reached, value)
      end do
      done = .false.
   end subroutine find_turn

   !> Works of the lateral force and of the axial load on the way that was tried, and of the layered joints
   !> whose axial loads vary, all by the cubics of the curve.
   subroutine find_works(self, strict, works, done)
      class(curve_search), intent(inout) :: self
      !> Whether a stride whose works are not exact enough is refused
      logical, intent(in) :: strict
      !> Of force, axial load and layered joints [J]
      real(wp), intent(out) :: works(3)
      !> Whether they are exact enough
      logical, intent(out) :: done
      real(wp) :: work(2), change(size(self%current%q)), f(size(self%current%q)), lift(2), weight(2)
      real(wp) :: residual, turnover
      integer :: j

      associate (current => self%current, trial => self%trial)
         ! The trapezoidal rule, and its correction.
         work = self%curve%work([current%force, trial%force], [current%displacement, trial%displacement], &
                                [current%force_rate, trial%force_rate], &
                                [current%displacement_rate, trial%displacement_rate])
         works = [sum(work), 0.0_wp, 0.0_wp]
         change = trial%q - current%q
         f = self%springs%f0 + self%springs%k*(trial%q - self%springs%d0)
         if (.not. self%equilibrium%varies) then
            turnover = sum(abs(change*f))
            done = .not. strict .or. abs(work(2)) <= most_correction*max(self%most_work, turnover)
            return
         end if
         associate (unit_top_load => self%equilibrium%unit_top_load, &
                    without_top_load => self%equilibrium%without_top_load)
            lift = [unit_top_load%potential_energy(current%q), unit_top_load%potential_energy(trial%q)]
            weight = [without_top_load%potential_energy(current%q), &
                      without_top_load%potential_energy(trial%q)]
         end associate
         works(2) = sum(self%curve%work([current%axial_load, trial%axial_load], lift, &
                                        [current%axial_rate, trial%axial_rate], &
                                        [current%lift_rate, trial%lift_rate]))
         ! Mean forces of the springs on their lines; layered joints have works of their own.
         f(:) = f - 0.5_wp*self%springs%k*change
         do j = 1, size(self%springs%layered)
            if (self%springs%axial_load_varies) f(self%springs%layered(j)) = 0.0_wp
            if (self%springs%axial_load_varies) then
               works(3) = works(3) + work_of_joint(self, self%springs%layered(j))
            end if
         end do
         turnover = sum(abs(change*f)) + sum(abs(works))
         ! What the energy balance of the way misses.
         residual = works(1) - works(2) - works(3) - sum(change*f) - (weight(2) - weight(1))
         done = .not. strict .or. abs(residual) <= max(self%most_work, turnover) &
                *largest_residual(merge(1, 2, self%structure%kinematics == finite)) &
                + round_off_of_sums*(abs(trial%axial_load)*maxval(abs(lift)) + maxval(abs(weight)))
      end associate
   end subroutine find_works

   !> Work on the way that was tried of layered joint i, whose moment is M = m + k phi - e N on its plane, e
   !> being the `centre` [J].
   pure real(wp) function work_of_joint(self, i) result(work)
      class(curve_search), intent(in) :: self
      integer, intent(in) :: i

      associate (current => self%current, trial => self%trial)
         work = sum(self%curve%work( &
                    moment_on_plane(self%springs, i, [current%q(i), trial%q(i)], &
                                    [current%axial_load, trial%axial_load] + self%equilibrium%above(i)), &
                    [current%q(i), trial%q(i)], self%springs%k(i)*[current%rate(i), trial%rate(i)] &
                    - self%springs%centre(i)*[current%axial_rate, trial%axial_rate], &
                    [current%rate(i), trial%rate(i)]))
      end associate
   end function work_of_joint

end module rbs_solve_static_curved_search
