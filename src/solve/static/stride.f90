!> One stride along a curved path: its points, each found by Newton's method, and its works.
!>
!> A point ahead is where the first spring or layer reaches the end of its line, where a motion turns back, or
!> the end of the stride.
module rbs_solve_static_stride
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_interaction_joints, only: nearest_layer, moment_on_plane
   use rbs_hysteresis_springs, only: spring_array
   use rbs_solve_line_search, only: false_position
   use rbs_solve_static_curve, only: curve_type, clean, same_rate
   use rbs_structure_structure, only: finite
   use rbs_solve_static_curved_equilibrium, only: curved_equilibrium, path_point
   implicit none
   private

   public :: stride_type, no_progress, round_off

   !> What round-off leaves of a displacement or force, as a share of the largest.
   real(wp), parameter :: round_off = 32.0_wp*epsilon(1.0_wp)

   !> Newton's method has converged if a change is below this share of the largest deformation of its kind:
   !> the next one would be its square. Where round-off ends the progress before, that must be below the
   !> second share.
   real(wp), parameter :: arrived = 1.0e-10_wp, no_progress = 1.0e-7_wp
   integer, parameter :: most_iterations = 15

   !> What the slopes may correct of the work of a stride under a constant axial load, and what may be missing
   !> from its works under one that varies, with exact rotations and without; as shares of the largest energy
   !> so far.
   real(wp), parameter :: most_correction = 1.0e-5_wp, most_missing(2) = [1.0e-12_wp, 1.0e-13_wp]

   type :: stride_type
      type(curved_equilibrium) :: equilibrium
      !> The way along the parameter of the path, +1 or -1
      integer :: direction = 1
      !> The present point and the one that is tried
      type(path_point) :: here, there
      !> The spring that stands on the end of its line there, and its layer; 0 for none
      integer :: spring = 0, layer = 0
      !> The curve between the present point and the farthest tried
      type(curve_type) :: curve
   contains
      procedure :: find_event
      procedure :: find_point
      procedure :: find_turn
      procedure :: find_works
      procedure :: work_of_joint
   end type stride_type

contains

   !> Go from the point that is tried along its tangent to the first end of a line, if there is one before the
   !> limit, else to the limit; not back beyond the present point.
   subroutine find_event(self, springs, limit, change)
      class(stride_type), intent(inout) :: self
      type(spring_array), intent(in) :: springs
      real(wp), intent(in) :: limit
      !> Of the deformations, to be added to
      real(wp), intent(inout), optional :: change(:)
      real(wp) :: room, way
      integer :: i, side, spring, layer

      self%spring = 0
      self%layer = 0
      associate (there => self%there)
         room = self%direction*(limit - there%t)
         do i = 1, springs%count
            associate (rise => self%direction*there%rate(i))
               if (.not. abs(rise) > 0.0_wp) cycle
               side = merge(1, -1, rise > 0.0_wp)
               if (springs%unload_on_reversal(i) == -side) cycle
               way = side*(springs%end_toward(i, side) - there%q(i))
               if (way < room*abs(rise)) then
                  room = way/abs(rise)
                  self%spring = i
               end if
            end associate
         end do
         if (springs%pressed) then
            call nearest_layer(springs, there%q, there%axial_load + self%equilibrium%above, there%rate, &
                               there%axial_rate, way, spring, layer)
            if (way < room) then
               room = way
               self%spring = spring
               self%layer = layer
            end if
         end if
         room = max(room, self%direction*(self%here%t - there%t))
         if (present(change)) change = change + there%rate*(self%direction*room)
         call move(self, self%direction*room)
         if (self%spring > 0 .and. self%layer == 0) then
            there%q(self%spring) = springs%end_toward(self%spring, merge(1, -1, self%direction &
                                                                         *there%rate(self%spring) > 0.0_wp))
         else if (self%spring == 0) then
            there%t = limit
         end if
      end associate
   end subroutine find_event

   !> Move the point that is tried along its tangent.
   pure subroutine move(self, step)
      class(stride_type), intent(inout) :: self
      !> Of the parameter
      real(wp), intent(in) :: step

      associate (there => self%there)
         there%t = there%t + step
         there%q = there%q + there%rate*step
         there%force = there%force + there%force_rate*step
         there%displacement = there%displacement + there%displacement_rate*step
         there%axial_load = there%axial_load + there%axial_rate*step
      end associate
   end subroutine move

   !> Newton's method from the point that is tried to the first event before a limit, or to the limit.
   subroutine find_point(self, springs, limit, with_events, found)
      class(stride_type), intent(inout) :: self
      type(spring_array), intent(in) :: springs
      real(wp), intent(in) :: limit
      logical, intent(in) :: with_events
      logical, intent(out) :: found
      real(wp) :: change(size(self%here%q)), share, last_share
      logical :: regular
      integer :: i

      found = .false.
      last_share = huge(1.0_wp)
      associate (there => self%there, equilibrium => self%equilibrium)
         do i = 1, most_iterations
            call equilibrium%solve(springs, there, regular)
            if (.not. regular) return
            if (equilibrium%varies) there%rate = clean(equilibrium%column, there)
            change = equilibrium%correction
            there%q = there%q + change
            there%force = there%force + equilibrium%force_correction
            there%axial_load = there%axial_load + equilibrium%ratio*equilibrium%force_correction
            if (with_events) call self%find_event(springs, limit, change)
            share = equilibrium%size_of(change, there%q - change)
            found = share <= arrived .or. (share <= no_progress .and. share > 0.25_wp*last_share)
            if (found) exit
            if (i > 3 .and. share > 2.0_wp*last_share) return
            last_share = share
         end do
         if (.not. found) return
         if (self%equilibrium%by_force) then
            there%force = equilibrium%driven(1) + equilibrium%driven(2)*there%t
            there%displacement = self%equilibrium%column%top_displacement(there%q)
         else
            there%displacement = equilibrium%driven(1) + equilibrium%driven(2)*there%t
         end if
      end associate
   end subroutine find_point

   !> Find the point where the first motion turns back.
   subroutine find_turn(self, springs, done)
      class(stride_type), intent(inout) :: self
      type(spring_array), intent(in) :: springs
      logical, intent(out) :: done
      type(false_position) :: line
      real(wp) :: value, reached
      integer :: i

      self%spring = 0
      self%layer = 0
      line = false_position(self%here%t, self%there%t, self%curve%least_rate(springs, self%here), &
                            self%curve%least_rate(springs, self%there))
      done = line%at_low > 0.0_wp .and. line%at_high < 0.0_wp
      if (.not. done) return
      do i = 1, 60
         reached = line%next()
         if (i > 40) reached = 0.5_wp*(line%low + line%high)
         call self%curve%guess(reached, self%there)
         call self%find_point(springs, reached, .false., done)
         if (.not. done) return
         value = self%curve%least_rate(springs, self%there)
         if (abs(value) < 0.9_wp*same_rate) return
         call line%narrow(reached, value)
      end do
      done = .false.
   end subroutine find_turn

   !> Works of the lateral force and of the axial load on the way that was tried, and of the layered joints
   !> whose axial loads vary, all by the cubics of the curve.
   subroutine find_works(self, springs, largest, strict, works, done)
      class(stride_type), intent(inout) :: self
      type(spring_array), intent(in) :: springs
      !> Largest work of the lateral force so far, in size [J]
      real(wp), intent(in) :: largest
      !> Whether a stride whose works are not exact enough is refused
      logical, intent(in) :: strict
      !> Of force, axial load and layered joints [J]
      real(wp), intent(out) :: works(3)
      logical, intent(out) :: done
      real(wp) :: work(2), change(size(self%here%q)), f(size(self%here%q)), lift(2), weight(2), missing, &
           turnover
      integer :: j

      associate (here => self%here, there => self%there)
         work = self%curve%work([here%force, there%force], [here%displacement, there%displacement], &
                                [here%force_rate, there%force_rate], &
                                [here%displacement_rate, there%displacement_rate])
         works = [sum(work), 0.0_wp, 0.0_wp]
         change = there%q - here%q
         f = springs%f0 + springs%k*(there%q - springs%d0)
         if (.not. self%equilibrium%varies) then
            turnover = sum(abs(change*f))
            done = .not. strict .or. abs(work(2)) <= most_correction*max(largest, turnover)
            return
         end if
         lift = [self%equilibrium%unit%potential_energy(here%q), &
              self%equilibrium%unit%potential_energy(there%q)]
         weight = [self%equilibrium%steady%potential_energy(here%q), &
              self%equilibrium%steady%potential_energy(there%q)]
         works(2) = sum(self%curve%work([here%axial_load, there%axial_load], lift, &
                                        [here%axial_rate, there%axial_rate], &
                                        [here%lift_rate, there%lift_rate]))
         f(:) = f - 0.5_wp*springs%k*change
         do j = 1, size(springs%layered)
            if (springs%pressed) f(springs%layered(j)) = 0.0_wp
            if (springs%pressed) works(3) = works(3) + self%work_of_joint(springs, springs%layered(j))
         end do
         turnover = sum(abs(change*f)) + sum(abs(works))
         missing = works(1) - works(2) - works(3) - sum(change*f) - (weight(2) - weight(1))
         done = .not. strict .or. abs(missing) <= &
                most_missing(merge(1, 2, self%equilibrium%column%kinematics == finite)) &
                *max(largest, turnover) &
                + round_off*(abs(there%axial_load)*maxval(abs(lift)) + maxval(abs(weight)))
      end associate
   end subroutine find_works

   !> Work of a layered joint on its plane.
   pure real(wp) function work_of_joint(self, springs, i) result(work)
      class(stride_type), intent(in) :: self
      type(spring_array), intent(in) :: springs
      integer, intent(in) :: i

      associate (here => self%here, there => self%there)
         work = sum(self%curve%work( &
                    moment_on_plane(springs, i, [here%q(i), there%q(i)], &
                                            [here%axial_load, there%axial_load] &
                                            + self%equilibrium%above(i)), &
                    [here%q(i), there%q(i)], &
                    springs%k(i)*[here%rate(i), there%rate(i)] &
                    - springs%centre(i)*[here%axial_rate, there%axial_rate], [here%rate(i), there%rate(i)]))
      end associate
   end function work_of_joint

end module rbs_solve_static_stride
