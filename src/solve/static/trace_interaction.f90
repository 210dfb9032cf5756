!> Static path under an axial load that varies: with the points of the path, or with the lateral force as in
!> an exterior column of a frame (N = P + r F). Layered joints then follow planes in rotation and axial load.
!>
!> On the present lines of all springs the column is in equilibrium where
!>
!>     a F - f(q, N) - K_G(N) q = 0,      M_j = m_j + k_j phi_j - e_j N_j,      K_G = N K_1 + K_weight
!>
!> Between two points of the path, what is driven and P change in proportion to a share of the way. Rates
!> follow from one linear system with the border a + r (e - K_1 q). With small rotations the path between
!> events is straight; with P-Delta it is slightly curved, and target and events are found by Newton's method,
!> each from total equilibrium, so that increments do not matter.
module rbs_solve_static_trace_interaction
   use rbs_base_constants, only: unbounded
   use rbs_base_error, only: error_type, fatal_error, analysis_failed
   use rbs_base_kinds, only: wp
   use rbs_base_linalg, only: factor_positive, solve_general
   use rbs_base_text, only: to_text
   use rbs_column_axial, only: geometric_stiffness
   use rbs_column_column, only: column_type, small
   use rbs_hysteresis_springs, only: spring_array
   use rbs_output_observer, only: observer_type
   use rbs_output_recorder, only: recorder_type
   use rbs_output_summary, only: summary_type
   use rbs_solve_static_corner, only: report_no_line
   use rbs_solve_static_path, only: static_path, describe_state, is_on_end, top_height
   implicit none
   private

   public :: trace_interaction

   !> A share of the way this small is round-off.
   real(wp), parameter :: no_way = 1.0e-13_wp
   !> Most corrections of one point, most searches for lines at one corner
   integer, parameter :: most_corrections = 40, most_searches = 100
   !> Most halvings of the way to the point where a layer turns back
   integer, parameter :: most_halvings = 50
   !> Gauss's rule with four points on the unit interval
   real(wp), parameter :: gauss_points(4) = [0.069431844202973712388_wp, 0.330009478207571867599_wp, &
                                             0.669990521792428132401_wp, 0.930568155797026287612_wp]
   real(wp), parameter :: gauss_weights(4) = [0.173927422568726928687_wp, 0.326072577431273071313_wp, &
                                              0.326072577431273071313_wp, 0.173927422568726928687_wp]

   !> A point of the path and how it goes on, per share of the way.
   type :: point_type
      real(wp) :: share = 0.0_wp, force = 0.0_wp, force_rate = 0.0_wp
      !> Deformations and their rates (2 n); axial loads of the joints and their rates (n)
      real(wp), allocatable :: q(:), rate(:), press(:), press_rate(:)
   end type point_type

   type, extends(static_path) :: pressed_path
      !> Axial load at the top at each target (m) [N], and how it follows the lateral force
      real(wp), allocatable :: load(:)
      real(wp) :: ratio = 0.0_wp
      !> Present target, axial load reached without the share of the force [N]
      integer :: row = 0
      real(wp) :: load_now = 0.0_wp
      !> The way to the target: change of what is driven, and of the axial load; where it began
      real(wp) :: way(2) = 0.0_wp, begin_way(2) = 0.0_wp
      !> Work of the axial forces in the geometric stiffness [J]
      real(wp) :: axial_work = 0.0_wp
      !> Geometric stiffness per axial load at the top, and of the weight (2 n, 2 n)
      real(wp), allocatable :: unit_stiffness(:, :), weight_stiffness(:, :)
      !> Weight above each joint (n) [N]
      real(wp), allocatable :: weight_above(:)
      !> Whether the path between events is straight
      logical :: straight = .true.
      type(point_type) :: at
   contains
      procedure :: advance
      procedure :: solve_line
      procedure :: measure
   end type pressed_path

contains

   !> Follow the targets one after the other from the virgin state under the first axial load.
   subroutine trace_interaction(column, by_force, target, load, every, collapse_drift, recorder, summary, &
                                error, &
                                progress)
      type(column_type), intent(in) :: column
      logical, intent(in) :: by_force
      !> Targets, and axial loads at the top there (m) [N]
      real(wp), intent(in) :: target(:), load(:)
      integer, intent(in) :: every
      real(wp), intent(in) :: collapse_drift
      class(recorder_type), intent(inout) :: recorder
      type(summary_type), intent(out) :: summary
      type(error_type), allocatable, intent(out) :: error
      class(observer_type), intent(inout), optional :: progress
      type(pressed_path) :: path
      type(column_type) :: first
      integer :: m, n

      n = column%n
      m = 2*n
      first = column
      path%load = load
      path%ratio = column%axial_force_ratio
      path%load_now = load(1)
      path%weight_above = column%compression - column%axial_load
      path%straight = column%kinematics == small
      allocate (path%unit_stiffness(m, m), path%weight_stiffness(m, m), source=0.0_wp)
      if (.not. path%straight) then
         first%axial_body = column%axial_lever
         first%axial_joint = column%axial_lever
         call geometric_stiffness(first, path%unit_stiffness)
         first%axial_body = column%axial_body - column%axial_lever*column%axial_load
         first%axial_joint = column%axial_joint - column%axial_lever*column%axial_load
         call geometric_stiffness(first, path%weight_stiffness)
         first%axial_body = column%axial_body
         first%axial_joint = column%axial_joint
      end if
      first%spring(n + 1:m)%axial_load = load(1) + path%weight_above
      call path%begin(first, by_force, m, error)
      if (allocated(error)) return
      call path%springs%vary_axial_loads()
      allocate (path%at%q(m), path%at%rate(m), path%at%press(n), path%at%press_rate(n), source=0.0_wp)
      call path%follow(target, every, collapse_drift, recorder, summary, error, progress)
   end subroutine trace_interaction

   !> Go on to a target and to the axial load there.
   subroutine advance(self, target, error)
      class(pressed_path), intent(inout) :: self
      real(wp), intent(in) :: target
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: state
      integer :: lines
      logical :: found

      self%row = self%row + 1
      self%begin_way = [self%control, self%load_now]
      self%way = [target, self%load(self%row)] - self%begin_way
      if (.not. any(abs(self%way) > 0.0_wp)) return
      self%at%share = 0.0_wp
      do lines = 1, 10000 + 1000*self%springs%count
         call find_lines(self, found)
         if (self%springs%lost_joint() > 0) return
         if (.not. found) then
            call report_no_line(self, target, error)
            return
         end if
         call go_on(self, found)
         if (.not. found) exit
         if (self%at%share >= 1.0_wp) then
            self%control = target
            self%load_now = self%load(self%row)
            if (self%by_force) then
               self%force = target
            else
               self%displacement = target
            end if
            return
         end if
      end do
      call describe_state(self, state)
      call fatal_error(error, analysis_failed, 'the static path makes no progress at '//state//'; the '// &
                       'parameters of the springs or the targets are too extreme for the arithmetic')
   end subroutine advance

   !> Rates of the column on the present lines of its springs.
   subroutine solve_line(self, direction, found)
      class(pressed_path), intent(inout) :: self
      integer, intent(in) :: direction
      logical, intent(out) :: found
      real(wp) :: correction(2*self%column%n), force_correction

      self%at%q = self%springs%d(:2*self%column%n)
      self%at%force = self%force
      call solve_point(self, self%at, correction, force_correction, found)
      self%rate = direction*self%at%rate
   end subroutine solve_line

   !> Find the lines on which all springs go on: those without room are put on the next one, layered joints
   !> choose theirs for the rates found, until the rates agree with the lines.
   subroutine find_lines(self, found)
      class(pressed_path), intent(inout) :: self
      logical, intent(out) :: found
      integer :: search, i, n
      logical :: changed

      n = self%column%n
      do search = 1, most_searches
         call self%solve_line(1, found)
         if (.not. found) return
         changed = .false.
         do i = 1, 2*n
            if (any(self%springs%layered == i)) then
               call choose_joint(self, i, changed)
            else
               call leave_end(self%springs, i, self%at%rate(i), changed)
            end if
         end do
         if (self%springs%lost_joint() > 0) return
         if (.not. changed) return
      end do
      found = .false.
   end subroutine find_lines

   !> A layered joint chooses its lines for the present rates.
   subroutine choose_joint(self, i, changed)
      class(pressed_path), intent(inout) :: self
      integer, intent(in) :: i
      logical, intent(inout) :: changed
      real(wp) :: before(2)

      before = [self%springs%k(i), self%springs%centre(i)]
      call self%springs%choose_lines(i, self%at%rate(i), self%at%press_rate(i - self%column%n))
      changed = changed .or. any(abs(before - [self%springs%k(i), self%springs%centre(i)]) > 0.0_wp)
   end subroutine choose_joint

   !> Put a spring that has no room in the direction of its rate on the next line.
   subroutine leave_end(springs, i, rate, changed)
      type(spring_array), intent(inout) :: springs
      integer, intent(in) :: i
      real(wp), intent(in) :: rate
      logical, intent(inout) :: changed
      integer :: way

      if (.not. abs(rate) > 0.0_wp) return
      way = merge(1, -1, rate > 0.0_wp)
      if (springs%one_way(i) /= -way .and. way*(springs%end_toward(i, way) - springs%d(i)) > 0.0_wp) return
      call springs%leave(i, way)
      changed = .true.
   end subroutine leave_end

   !> Go to the next event or to the target.
   subroutine go_on(self, found)
      class(pressed_path), intent(inout) :: self
      logical, intent(out) :: found
      type(point_type) :: here, there, beyond
      integer :: spring, layer, halving
      real(wp) :: turned, not_turned

      here = self%at
      there = here
      call find_end(self, there, here%share, 1.0_wp, spring, layer, found)
      if (.not. found) return
      if (.not. self%straight) then
         if (turns_back(self, there)) then
            ! A layer on a one-way line turns back on the way: that point is an event too.
            not_turned = here%share
            turned = there%share
            do halving = 1, most_halvings
               beyond = here
               call find_point(self, beyond, 0.5_wp*(not_turned + turned), found)
               if (.not. found) return
               if (turns_back(self, beyond)) then
                  there = beyond
                  turned = beyond%share
               else
                  not_turned = beyond%share
               end if
               if (turned - not_turned <= no_way) exit
            end do
            spring = 0
            layer = 0
         end if
      end if
      call add_works(self, here, there)
      call move_springs(self, there, spring, layer)
      self%at = there
      if (self%at%share > 1.0_wp - no_way) self%at%share = 1.0_wp
      self%force = there%force
      self%displacement = dot_product(self%column%arm(:2*self%column%n), there%q)
      self%control = merge(self%force, self%displacement, self%by_force)
   end subroutine go_on

   !> The first event between two shares of the way, or the point at the second.
   subroutine find_end(self, point, from, to, spring, layer, found)
      type(pressed_path), intent(in) :: self
      type(point_type), intent(inout) :: point
      real(wp), intent(in) :: from, to
      !> The spring that ends the line, and its layer; 0 for none
      integer, intent(out) :: spring, layer
      logical, intent(out) :: found
      real(wp) :: correction(size(point%q)), force_correction, step, room
      integer :: trial, i, first, n

      n = self%column%n
      do trial = 1, most_corrections
         call solve_point(self, point, correction, force_correction, found)
         if (.not. found) return
         point%q = point%q + correction
         point%force = point%force + force_correction
         call find_press(self, point)
         step = to - point%share
         spring = 0
         layer = 0
         do i = 1, 2*n
            first = 0
            if (any(self%springs%layered == i)) then
               call self%springs%way_on_plane(i, point%q(i), point%press(i - n), point%rate(i), &
                                              point%press_rate(i - n), room, first)
            else
               room = room_ahead(self%springs, i, point%q(i), point%rate(i))
            end if
            if (room >= step) cycle
            step = room
            spring = i
            layer = first
         end do
         step = max(step, from - point%share)
         point%q = point%q + point%rate*step
         point%force = point%force + point%force_rate*step
         point%share = point%share + step
         call find_press(self, point)
         if (trial == 1) cycle
         if (self%straight) return
         if (abs(step) <= no_way .and. is_small(correction, point%q)) return
      end do
   end subroutine find_end

   !> The point at a share of the way on the present lines.
   subroutine find_point(self, point, share, found)
      type(pressed_path), intent(in) :: self
      type(point_type), intent(inout) :: point
      real(wp), intent(in) :: share
      logical, intent(out) :: found
      real(wp) :: correction(size(point%q)), force_correction, step
      integer :: trial

      step = share - point%share
      point%q = point%q + point%rate*step
      point%force = point%force + point%force_rate*step
      point%share = share
      do trial = 1, 6
         call solve_point(self, point, correction, force_correction, found)
         if (.not. found) return
         point%q = point%q + correction
         point%force = point%force + force_correction
         if (is_small(correction, point%q)) exit
      end do
      call find_press(self, point)
   end subroutine find_point

   !> Whether a correction is such that the next one would be round-off: Newton's method squares it.
   pure logical function is_small(correction, q)
      real(wp), intent(in) :: correction(:), q(:)

      is_small = maxval(abs(correction)) <= 1.0e-11_wp*maxval(abs(q))
   end function is_small

   !> How far a spring can go on its line, in shares of the way.
   pure real(wp) function room_ahead(springs, i, q, rate) result(room)
      type(spring_array), intent(in) :: springs
      integer, intent(in) :: i
      real(wp), intent(in) :: q, rate
      real(wp) :: way
      integer :: side

      room = unbounded
      if (.not. abs(rate) > 0.0_wp) return
      side = merge(1, -1, rate > 0.0_wp)
      if (springs%one_way(i) == -side) return
      way = side*(springs%end_toward(i, side) - q)
      if (way < 1.0e100_wp*abs(rate)) room = way/abs(rate)
   end function room_ahead

   !> Whether a layer on a one-way line, or a spring on one, goes back at a point.
   pure logical function turns_back(self, point)
      type(pressed_path), intent(in) :: self
      type(point_type), intent(in) :: point
      integer :: i, n

      n = self%column%n
      turns_back = .false.
      do i = 1, 2*n
         if (any(self%springs%layered == i)) then
            turns_back = self%springs%turns_on_plane(i, point%rate(i), point%press_rate(i - n))
         else
            turns_back = self%springs%one_way(i)*point%rate(i) < 0.0_wp
         end if
         if (turns_back) return
      end do
   end function turns_back

   !> Axial loads of the joints at a point, and their rates.
   pure subroutine find_press(self, point)
      type(pressed_path), intent(in) :: self
      type(point_type), intent(inout) :: point

      point%press = self%begin_way(2) + point%share*self%way(2) + self%ratio*point%force + self%weight_above
      point%press_rate = self%way(2) + self%ratio*point%force_rate
   end subroutine find_press

   !> Rates at a point, and what takes its residual away, on the present lines.
   subroutine solve_point(self, point, correction, force_correction, found)
      type(pressed_path), intent(in) :: self
      type(point_type), intent(inout) :: point
      real(wp), intent(out) :: correction(:), force_correction
      logical, intent(out) :: found
      real(wp), dimension(size(point%q) + 1, size(point%q) + 1) :: a
      real(wp), dimension(size(point%q) + 1, 2) :: b
      real(wp), dimension(size(point%q)) :: f, pushed
      real(wp) :: driven, top
      integer :: i, j, m, n

      n = self%column%n
      m = 2*n
      driven = self%begin_way(1) + point%share*self%way(1)
      if (self%by_force) point%force = driven
      call find_press(self, point)
      top = self%begin_way(2) + point%share*self%way(2) + self%ratio*point%force
      associate (springs => self%springs, arm => self%column%arm)
         f = springs%f0(:m) + springs%k(:m)*(point%q - springs%d0(:m))
         ! What the axial load adds to the lever arms: centres of stiffness, second-order arms.
         pushed = -matmul(self%unit_stiffness, point%q)
         do j = 1, size(springs%layered)
            i = springs%layered(j)
            f(i) = f(i) - springs%centre(i)*(point%press(i - n) - springs%press_at(i))
            pushed(i) = pushed(i) + springs%centre(i)
         end do
         a = 0.0_wp
         a(:m, :m) = top*self%unit_stiffness + self%weight_stiffness
         b(:m, 2) = arm(:m)*point%force - f - matmul(a(:m, :m), point%q)
         do i = 1, m
            a(i, i) = a(i, i) + springs%k(i)
         end do
         b(:m, 1) = pushed*self%way(2)
         if (self%by_force) then
            found = is_stable(a(:m, :m))
            if (.not. found) return
            b(:m, 1) = b(:m, 1) + (arm(:m) + self%ratio*pushed)*self%way(1)
            a(m + 1, m + 1) = 1.0_wp
            b(m + 1, :) = [self%way(1), 0.0_wp]
         else
            a(:m, m + 1) = -(arm(:m) + self%ratio*pushed)
            a(m + 1, :m) = arm(:m)
            b(m + 1, :) = [self%way(1), driven - dot_product(arm(:m), point%q)]
         end if
      end associate
      call solve_general(a, b, found)
      if (.not. found) return
      point%rate = b(:m, 1)
      point%force_rate = b(m + 1, 1)
      correction = b(:m, 2)
      force_correction = b(m + 1, 2)
      call find_press(self, point)
   end subroutine solve_point

   !> Whether a stiffness is positive definite.
   logical function is_stable(stiffness)
      real(wp), intent(in) :: stiffness(:, :)
      real(wp) :: copy(size(stiffness, 1), size(stiffness, 2))

      copy = stiffness
      call factor_positive(copy, is_stable)
   end function is_stable

   !> Works between two points: of the lateral force, of the moments of layered joints, and of the axial
   !> forces on the second-order motion. Exact by the trapezoidal rule on a straight path, else by Gauss's
   !> rule.
   subroutine add_works(self, here, there)
      class(pressed_path), intent(inout) :: self
      type(point_type), intent(in) :: here, there
      type(point_type) :: between
      integer :: i
      logical :: found

      associate (length => there%share - here%share)
         if (self%straight) then
            call add_share(self, here, 0.5_wp*length)
            call add_share(self, there, 0.5_wp*length)
            return
         end if
         do i = 1, size(gauss_points)
            between = here
            call find_point(self, between, here%share + gauss_points(i)*length, found)
            if (found) call add_share(self, between, gauss_weights(i)*length)
         end do
      end associate
   end subroutine add_works

   !> Add the powers at a point times its weight.
   subroutine add_share(self, point, weight)
      class(pressed_path), intent(inout) :: self
      type(point_type), intent(in) :: point
      real(wp), intent(in) :: weight
      real(wp) :: top, moment
      integer :: i, j, m

      m = size(point%q)
      associate (springs => self%springs)
         self%work = self%work + weight*point%force*dot_product(self%column%arm(:m), point%rate)
         do j = 1, size(springs%layered)
            i = springs%layered(j)
            moment = springs%f0(i) + springs%k(i)*(point%q(i) - springs%d0(i)) &
                     - springs%centre(i)*(point%press(i - self%column%n) - springs%press_at(i))
            springs%work(i) = springs%work(i) + weight*moment*point%rate(i)
         end do
      end associate
      if (self%straight) return
      top = self%begin_way(2) + point%share*self%way(2) + self%ratio*point%force
      self%axial_work = self%axial_work + weight*dot_product(point%rate, &
                                                             matmul(top*self%unit_stiffness &
                                                                    + self%weight_stiffness, point%q))
   end subroutine add_share

   !> Move all springs to a point; that of the event comes exactly to its end.
   subroutine move_springs(self, point, spring, layer)
      class(pressed_path), intent(inout) :: self
      type(point_type), intent(in) :: point
      integer, intent(in) :: spring, layer
      integer :: i, n

      n = self%column%n
      associate (springs => self%springs)
         do i = 1, 2*n
            if (any(springs%layered == i)) then
               call springs%put_on_plane(i, point%q(i), point%press(i - n), point%rate(i), &
                                         point%press_rate(i - n), merge(layer, 0, i == spring))
            else
               call springs%walk(i, min(max(point%q(i), springs%first(i)), springs%last(i)))
               if (i == spring .or. is_on_end(springs, i, point%q(i), point%rate(i))) then
                  call springs%arrive(i, merge(1, -1, point%rate(i) > 0.0_wp))
               end if
            end if
         end do
      end associate
   end subroutine move_springs

   !> The values of a row that do not follow from the springs.
   pure subroutine measure(self, axial_work, height, rotation)
      class(pressed_path), intent(in) :: self
      real(wp), intent(out) :: axial_work, height, rotation

      axial_work = self%axial_work
      call top_height(self, height, rotation)
   end subroutine measure

end module rbs_solve_static_trace_interaction
