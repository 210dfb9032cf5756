!> Static path under an axial load that varies: with the points of the path, or with the lateral force as in
!> an exterior column of a frame (N = P + r F). Layered joints then follow planes in rotation and axial load.
!>
!> Between two points of the path, what is driven and P change in proportion to a share of the way. With small
!> rotations the path between events is straight; with P-Delta it is slightly curved, and with exact rotations
!> it is followed in strides. Target and events are found by Newton's method, each from total equilibrium.
module rbs_solve_static_trace_interaction
   use rbs_base_error, only: error_type, fatal_error, analysis_failed
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_base_text, only: to_text
   use rbs_column_column, only: column_type, finite
   use rbs_column_top, only: top_position, top_displacement, largest_turn
   use rbs_solve_static_corner, only: report_no_line
   use rbs_solve_static_curve, only: most_turn, most_bend
   use rbs_solve_static_path, only: static_path, describe_state, name_spring, is_on_end, serialize_path
   use rbs_solve_static_pressed_balance, only: pressed_balance, pressed_point
   use rbs_solve_static_pressed_corner, only: find_lines
   use rbs_solve_static_pressed_finite, only: pressed_finite
   use rbs_solve_static_pressed_search, only: find_end, find_point, find_turn, hides_event, no_way
   use rbs_solve_static_resume, only: begin_path, end_path
   use rbs_solve_task, only: task_type
   implicit none
   private

   public :: trace_interaction

   !> Most lines in a row without progress
   integer, parameter :: most_standing = 2000
   !> How often a stride is cut because of what a cubic shows between its ends
   integer, parameter :: most_looks = 6
   !> Bends this small are round-off [rad].
   real(wp), parameter :: no_bend = 1.0e-12_wp
   !> Gauss's rule with four points on the unit interval
   real(wp), parameter :: gauss_points(4) = [0.069431844202973712388_wp, 0.330009478207571867599_wp, &
                                             0.669990521792428132401_wp, 0.930568155797026287612_wp]
   real(wp), parameter :: gauss_weights(4) = [0.173927422568726928687_wp, 0.326072577431273071313_wp, &
                                              0.326072577431273071313_wp, 0.173927422568726928687_wp]

   type, extends(static_path) :: pressed_path
      class(pressed_balance), allocatable :: balance
      !> Axial load at the top at each target (m) [N]
      real(wp), allocatable :: load(:)
      !> Present target
      integer :: row = 0
      !> Work of the axial forces, that of the openings included [J]
      real(wp) :: axial_work = 0.0_wp
      type(pressed_point) :: at
   contains
      procedure :: advance
      procedure :: solve_line
      procedure :: measure
      procedure :: find_balance
      procedure :: unbalance
      procedure :: stand_still
      procedure :: serialize
   end type pressed_path

contains

   !> Follow the targets one after the other from the virgin state under the first axial load.
   subroutine trace_interaction(column, by_force, target, load, task, error)
      type(column_type), intent(in) :: column
      !> Whether the targets are lateral forces [N], else displacements of the top [m]
      logical, intent(in) :: by_force
      !> Targets (m)
      real(wp), intent(in) :: target(:)
      !> Axial loads at the top there (m) [N]
      real(wp), intent(in) :: load(:)
      type(task_type), intent(inout), target :: task
      type(error_type), allocatable, intent(out) :: error
      type(pressed_path) :: path
      type(column_type) :: first
      integer :: m, n

      n = column%n
      m = column%unknowns
      path%load = load
      if (column%kinematics == finite) then
         allocate (pressed_finite :: path%balance)
      else
         allocate (pressed_balance :: path%balance)
      end if
      call path%balance%create(column, by_force)
      first = column
      first%compression = load(1) + path%balance%weight_above
      first%spring(n + 1:2*n)%axial_load = first%compression
      first%axial_load = load(1)
      allocate (path%at%q(m), path%at%rate(m), path%at%press(n), path%at%press_rate(n), source=0.0_wp)
      first%axial_joint = column%axial_joint + (load(1) - column%axial_load)*column%axial_lever
      call begin_path(path, first, by_force, m, .true., error, task%before)
      if (allocated(error)) return
      if (column%opens .and. .not. task%resumes()) then
         ! The load has done its work on the openings before the path begins.
         path%axial_work = sum(first%axial_joint*path%springs%d(2*n + 1:))
         path%at_begin = path%at_begin + path%axial_work
      end if
      call path%follow(target, task, error)
      if (allocated(error) .or. .not. task%keeps_end) return
      if (task%summary%lost_joint == 0) call end_path(path, .true., task%after)
   end subroutine trace_interaction

   !> Go on to a target and to the axial load there.
   subroutine advance(self, target, error)
      class(pressed_path), intent(inout) :: self
      real(wp), intent(in) :: target
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: state
      real(wp) :: before
      integer :: lines, standing
      logical :: found

      self%row = self%row + 1
      associate (way => self%balance%way, begin_way => self%balance%begin_way)
         begin_way = [self%control, self%load_now]
         way = [target, self%load(self%row)] - begin_way
         if (.not. any(abs(way) > 0.0_wp)) return
      end associate
      self%at%share = 0.0_wp
      standing = 0
      do lines = 1, 10000 + 1000*self%springs%count
         before = self%at%share
         call stand(self)
         call find_lines(self%balance, self%springs, self%at, found)
         if (self%springs%lost_joint() > 0) return
         if (.not. found) then
            call report_no_line(self, target, error)
            return
         end if
         call go_on(self, found)
         if (.not. found) then
            call report_no_way(self, target, error)
            return
         end if
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
         ! Many springs and layers may change their lines at one point, but not for ever.
         standing = merge(0, standing + 1, self%at%share > before)
         if (standing > most_standing + self%springs%count) exit
      end do
      call describe_state(self, state)
      call fatal_error(error, analysis_failed, 'the static path makes no progress at '//state//'; the '// &
                       'parameters of the springs or the targets are too extreme for the arithmetic')
   end subroutine advance

   !> Report that no equilibrium was found ahead.
   subroutine report_no_way(self, target, error)
      class(pressed_path), intent(in) :: self
      real(wp), intent(in) :: target
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: state, spring, way

      call describe_state(self, state)
      call name_spring(self, spring)
      way = to_text(target)//merge(' N', ' m', self%by_force)
      call fatal_error(error, analysis_failed, 'no equilibrium was found beyond '//state//' and the '// &
                       'axial load '//to_text(self%balance%top_load(self%at))//' N on the way to '// &
                       way//': the column snaps through or has lost its capacity there ('// &
                       spring//' has the least stiffness left). The path up to there is kept; use a '// &
                       'dynamic analysis to go on')
   end subroutine report_no_way

   !> The point at which the springs stand.
   subroutine stand(self)
      class(pressed_path), intent(inout) :: self

      self%at%q = self%springs%d
      self%at%force = self%force
   end subroutine stand

   !> Rates of the column on the present lines of its springs.
   subroutine solve_line(self, direction, found)
      class(pressed_path), intent(inout) :: self
      integer, intent(in) :: direction
      logical, intent(out) :: found
      real(wp) :: correction(self%column%unknowns), force_correction

      call stand(self)
      call self%balance%solve_point(self%springs, self%at, correction, force_correction, found)
      self%rate = direction*self%at%rate
   end subroutine solve_line

   !> Go to the next event or to the target; with exact rotations in strides, each short enough for its
   !> tangent to tell what lies ahead.
   subroutine go_on(self, found)
      class(pressed_path), intent(inout) :: self
      logical, intent(out) :: found
      type(pressed_point) :: here, there
      real(wp) :: limit, turn
      integer :: spring, layer, looks
      logical :: turned, strides

      here = self%at
      strides = self%column%kinematics == finite
      limit = 1.0_wp
      if (strides) then
         turn = largest_turn(self%column, here%rate)
         if (turn*(limit - here%share) > most_turn) limit = here%share + most_turn/turn
      end if
      looks = 0
      do
         there = here
         call find_end(self%balance, self%springs, there, here%share, limit, spring, layer, found)
         if (found .and. strides) found = is_gentle(self, here, there)
         if (found .and. .not. self%balance%straight) then
            call find_turn(self%balance, self%springs, here, there, turned, found)
            if (turned) then
               spring = 0
               layer = 0
            else if (found .and. strides .and. looks < most_looks .and. there%share > here%share) then
               looks = looks + 1
               found = .not. hides_event(self%balance, self%springs, here, there)
            end if
         end if
         if (found) exit
         self%cuts = self%cuts + 1
         limit = here%share + 0.5_wp*(limit - here%share)
         if (limit - here%share <= no_way) return
      end do
      call add_works(self, here, there)
      call move_springs(self, there, spring, layer)
      self%at = there
      if (self%at%share > 1.0_wp - no_way) self%at%share = 1.0_wp
      self%force = there%force
      self%displacement = top_displacement(self%column, there%q)
      self%control = merge(self%force, self%displacement, self%by_force)
      if (self%at%share < 1.0_wp) call self%see_corner(self%at%share)
   end subroutine go_on

   !> Whether a stride has been small enough for its tangent to tell what lies between.
   pure logical function is_gentle(self, here, there)
      class(pressed_path), intent(in) :: self
      type(pressed_point), intent(in) :: here, there
      real(wp), dimension(size(here%q)) :: change, bend
      real(wp) :: height

      height = self%column%joint_height(self%column%n + 1)
      change = there%q - here%q
      bend = change - (there%share - here%share)*here%rate
      is_gentle = largest_turn(self%column, change) <= 2.0_wp*most_turn .and. &
                  size_of(bend) <= most_bend*size_of(change) + no_bend

   contains

      pure real(wp) function size_of(way)
         real(wp), intent(in) :: way(:)

         size_of = max(largest_turn(self%column, way), maxval(abs(way(:self%column%n)))/height, &
                       maxval(abs(way(2*self%column%n + 1:)))/height)
      end function size_of

   end function is_gentle

   !> Works between two points: of the lateral force, of the moments of layered joints, and of the axial
   !> forces. Exact by the trapezoidal rule on a straight path, else by Gauss's rule.
   subroutine add_works(self, here, there)
      class(pressed_path), intent(inout) :: self
      type(pressed_point), intent(in) :: here, there
      type(pressed_point) :: between
      real(wp) :: share
      integer :: i, part, parts
      logical :: found

      associate (length => there%share - here%share)
         if (self%balance%straight) then
            call add_share(self, here, 0.5_wp*length)
            call add_share(self, there, 0.5_wp*length)
            return
         end if
         ! A long piece of curve in several parts.
         parts = 1 + int(largest_turn(self%column, there%q - here%q)/most_turn)
         do part = 1, parts
            do i = 1, size(gauss_points)
               share = here%share + length*((part - 1) + gauss_points(i))/parts
               between = here
               call find_point(self%balance, self%springs, between, share, found)
               if (found) call add_share(self, between, gauss_weights(i)*length/parts)
            end do
         end do
      end associate
   end subroutine add_works

   !> Add the powers at a point times its weight.
   subroutine add_share(self, point, weight)
      class(pressed_path), intent(inout) :: self
      type(pressed_point), intent(in) :: point
      real(wp), intent(in) :: weight
      real(wp) :: f(size(point%q)), centre(size(point%q))
      integer :: i, j

      self%work = self%work + weight*point%force*point%displacement_rate
      self%axial_work = self%axial_work + weight*point%axial_power
      associate (springs => self%springs)
         if (size(springs%layered) == 0) return
         call self%balance%plane_forces(springs, point, f, centre)
         do j = 1, size(springs%layered)
            i = springs%layered(j)
            springs%work(i) = springs%work(i) + weight*f(i)*point%rate(i)
         end do
      end associate
   end subroutine add_share

   !> Move all springs to a point; that of the event comes exactly to its end.
   subroutine move_springs(self, point, spring, layer)
      class(pressed_path), intent(inout) :: self
      type(pressed_point), intent(in) :: point
      integer, intent(in) :: spring, layer
      integer :: i, n

      n = self%column%n
      associate (springs => self%springs)
         do i = 1, springs%count
            if (any(springs%layered == i)) then
               call springs%put_on_plane(i, point%q(i), point%press(i - n), point%rate(i), &
                                         point%press_rate(i - n), merge(layer, 0, i == spring))
            else
               call springs%advance_on_branch(i, min(max(point%q(i), springs%first(i)), springs%last(i)))
               if (i == spring .or. is_on_end(springs, i, point%q(i), point%rate(i))) then
                  call springs%arrive(i, merge(1, -1, point%rate(i) > 0.0_wp))
               end if
            end if
         end do
      end associate
   end subroutine move_springs

   !> What takes the springs to equilibrium at the displacement of the top, under the present axial load.
   subroutine find_balance(self, correction, force, found)
      class(pressed_path), intent(inout) :: self
      real(wp), intent(out) :: correction(:), force
      logical, intent(out) :: found
      integer :: i, n
      logical :: by_force

      n = self%column%n
      by_force = self%balance%by_force
      self%balance%by_force = .false.
      self%balance%begin_way = [self%displacement, self%load_now]
      self%balance%way = 0.0_wp
      self%at%share = 0.0_wp
      call stand(self)
      call self%balance%solve_point(self%springs, self%at, correction, force, found)
      self%balance%by_force = by_force
      if (.not. self%springs%pressed) return
      do i = 1, size(self%springs%layered)
         associate (place => self%springs%layered(i))
            self%springs%press_to(place) = self%at%press(place - n)
         end associate
      end do
   end subroutine find_balance

   !> The largest force by which a joint is out of equilibrium, moments over the height [N].
   real(wp) function unbalance(self)
      class(pressed_path), intent(inout) :: self

      call stand(self)
      unbalance = self%balance%unbalance(self%springs, self%at)
   end function unbalance

   !> The springs stand where the path begins.
   subroutine stand_still(self)
      class(pressed_path), intent(inout) :: self

      self%direction = 0
      call stand(self)
   end subroutine stand_still

   !> Save or restore where the path is.
   subroutine serialize(self, stream)
      class(pressed_path), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call serialize_path(self, stream)
      call stream%item(self%axial_work)
      call stream%item(self%at%q)
      call stream%item(self%at%rate)
      call stream%item(self%at%press)
      call stream%item(self%at%press_rate)
      call stream%item(self%at%share)
      call stream%item(self%at%force)
      call stream%item(self%at%force_rate)
      call stream%item(self%at%displacement)
      call stream%item(self%at%displacement_rate)
      call stream%item(self%at%axial_power)
   end subroutine serialize

   !> The values of a row that do not follow from the springs.
   pure subroutine measure(self, axial_work, height)
      class(pressed_path), intent(in) :: self
      real(wp), intent(out) :: axial_work, height
      real(wp) :: top(2)

      axial_work = self%axial_work
      top = top_position(self%column, self%springs%d)
      height = top(2)
   end subroutine measure

end module rbs_solve_static_trace_interaction
