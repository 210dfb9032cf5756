!> Layered joints among the springs whose axial loads vary: they follow straight paths in rotation and axial
!> load, and are on planes where other springs are on lines.
module rbs_hysteresis_spring_planes
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_base_constants, only: unbounded
   use rbs_hysteresis_layered_fibre_fall, only: layer_fall, find_fall
   use rbs_hysteresis_layered_fibre_path, only: choose_branches, go, way_to_event
   use rbs_hysteresis_layered_fibre_section, only: fibre_section
   use rbs_hysteresis_layered_joint, only: branch_under
   use rbs_hysteresis_rule, only: spring_rules
   use rbs_hysteresis_segment, only: segment
   use rbs_hysteresis_spring_lines, only: spring_lines, put_line
   implicit none
   private

   public :: spring_planes

   type, extends(spring_lines) :: spring_planes
      !> Layered joints among the springs, and whether their axial loads vary along the path
      integer, allocatable :: layered(:)
      logical :: pressed = .false.
      !> Whether a spring is on a plane (count)
      logical, allocatable :: on_plane(:)
      !> Where they vary (count): axial load that the joint is to reach, axial load of the present plane
      !> [N], and its centre of stiffness e = -dM/dN [m]
      real(wp), allocatable :: press_to(:), press_at(:), centre(:)
   contains
      procedure, private :: create_from_rules
      procedure :: restore
      procedure :: press_joints
      procedure :: vary_axial_loads
      procedure :: lost_joint
      procedure :: fall_of
      procedure :: fill_openings
      procedure :: opening
      procedure :: choose_lines
      procedure :: nearest_layer
      procedure :: moment_on_plane
      procedure :: put_on_plane
      procedure :: least_forward_rate
      procedure :: serialize
      procedure :: go_under
   end type spring_planes

contains

   !> Virgin springs; the axial loads of layered joints do not vary.
   subroutine create_from_rules(self, rules, told, axial_load)
      class(spring_planes), intent(out) :: self
      type(spring_rules), intent(in) :: rules
      !> See `spring_lines`
      integer, intent(in) :: told(:)
      real(wp), intent(in) :: axial_load(:)
      logical :: is_layered(size(rules%of))
      integer :: i

      call self%spring_lines%create(rules, told, axial_load)
      do i = 1, self%count
         select type (section => self%slot(i)%memory)
         type is (fibre_section)
            is_layered(i) = .true.
         class default
            is_layered(i) = .false.
         end select
      end do
      self%layered = pack([(i, i=1, self%count)], is_layered)
      allocate (self%on_plane(self%count), source=.false.)
   end subroutine create_from_rules

   !> The axial loads of the layered joints vary from now on: these joints follow straight paths in rotation
   !> and axial load, towards `press_to`, and have no line of their own that the rotation alone could leave.
   subroutine vary_axial_loads(self)
      class(spring_planes), intent(inout) :: self

      self%pressed = size(self%layered) > 0
      if (.not. self%pressed) return
      self%on_plane(self%layered) = .true.
      allocate (self%press_to(self%count), self%press_at(self%count), self%centre(self%count), &
                source=0.0_wp)
      call read_planes(self)
   end subroutine vary_axial_loads

   !> The plane that a layered joint is on.
   subroutine read_plane(self, i)
      type(spring_planes), intent(inout) :: self
      integer, intent(in) :: i

      select type (section => self%slot(i)%memory)
      type is (fibre_section)
         call section%read_plane(self%d0(i), self%press_at(i), self%f0(i), self%k(i), self%centre(i))
      end select
      self%first(i) = -unbounded
      self%last(i) = unbounded
      self%one_way(i) = 0
      self%version = modulo(self%version + 1, huge(1))
   end subroutine read_plane

   !> Layered joints whose axial loads vary go straight to new rotations and to `press_to`.
   subroutine press_joints(self, d)
      class(spring_planes), intent(inout) :: self
      !> New deformations (count) [m or rad]
      real(wp), intent(in), contiguous :: d(:)
      integer :: i, j

      do j = 1, size(self%layered)
         i = self%layered(j)
         if (.not. abs(d(i) - self%d(i)) + abs(self%press_to(i) - self%press_at(i)) > 0.0_wp) cycle
         if (self%journal%open) call self%journal%keep(i, self%line_of(i), self%slot(i))
         select type (section => self%slot(i)%memory)
         type is (fibre_section)
            call go(section, d(i), self%press_to(i), self%work(i))
         end select
         self%events = self%events + 1
         call read_plane(self, i)
         self%d(i) = d(i)
      end do
   end subroutine press_joints

   !> The first layered joint that can no longer carry its axial load, 0 if all can.
   pure integer function lost_joint(self) result(lost)
      class(spring_planes), intent(in) :: self
      integer :: j

      do j = 1, size(self%layered)
         lost = self%layered(j)
         select type (section => self%slot(lost)%memory)
         type is (fibre_section)
            if (section%failed) return
         end select
      end do
      lost = 0
   end function lost_joint

   !> What becomes of a joint that has lost its axial load.
   subroutine fall_of(self, i, fall)
      class(spring_planes), intent(in) :: self
      integer, intent(in) :: i
      type(layer_fall), intent(out) :: fall

      select type (section => self%slot(i)%memory)
      type is (fibre_section)
         call find_fall(section, fall)
      end select
   end subroutine fall_of

   !> Openings of n joints at the middle of their sections [m], then the rotations from which they count
   !> theirs [rad]; zero for a joint that is not layered. Without room nothing is filled.
   pure subroutine fill_openings(self, n, values)
      class(spring_planes), intent(in) :: self
      !> Number of joints; their flexural springs are n + 1 to 2 n
      integer, intent(in) :: n
      !> (2 n), or empty
      real(wp), intent(inout) :: values(:)
      integer :: i, j

      if (size(values) == 0) return
      values = 0.0_wp
      do j = 1, size(self%layered)
         i = self%layered(j)
         values(i - n) = self%opening(i, self%d(i), 0.0_wp)
         select type (section => self%slot(i)%memory)
         type is (fibre_section)
            values(i) = section%rest
         end select
      end do
   end subroutine fill_openings

   !> Opening of a layered joint on its present line or plane [m]; 0 of other springs.
   pure real(wp) function opening(self, i, d, share)
      class(spring_planes), intent(in) :: self
      !> Its flexural spring
      integer, intent(in) :: i
      !> Rotation [rad], and the share of the way from the present axial load to that of the end of the step
      real(wp), intent(in) :: d, share

      opening = 0.0_wp
      select type (section => self%slot(i)%memory)
      type is (fibre_section)
         if (self%pressed) then
            opening = section%opening_at(d, self%press_at(i) + share*(self%press_to(i) - self%press_at(i)))
         else
            opening = section%opening_at(d, section%axial_load)
         end if
      end select
   end function opening

   !> Put the layers of a joint on the lines on which they go on along a straight path.
   subroutine choose_lines(self, i, turn, press)
      class(spring_planes), intent(inout) :: self
      integer, intent(in) :: i
      !> Rates of the rotation [rad] and of the axial load [N]
      real(wp), intent(in) :: turn, press

      select type (section => self%slot(i)%memory)
      type is (fibre_section)
         call choose_branches(section, turn, press)
      end select
      call read_plane(self, i)
   end subroutine choose_lines

   !> How far the layered joints can go from points of their planes along straight paths until the first layer
   !> reaches the end of its line.
   pure subroutine nearest_layer(self, rotation, axial_load, turn, press, way, joint, layer)
      class(spring_planes), intent(in) :: self
      !> Of the joints, and rates (count); rate of all axial loads
      real(wp), intent(in) :: rotation(:), axial_load(:), turn(:), press
      !> In units of the rates; `unbounded` if there is no end
      real(wp), intent(out) :: way
      !> The spring and its layer, 0 for none
      integer, intent(out) :: joint, layer
      real(wp) :: room
      integer :: i, j, first

      way = unbounded
      joint = 0
      layer = 0
      do j = 1, size(self%layered)
         i = self%layered(j)
         select type (section => self%slot(i)%memory)
         type is (fibre_section)
            call way_to_event(section, rotation(i), axial_load(i), turn(i), press, room, first)
            if (first == 0 .or. room >= way) cycle
            way = room
            joint = i
            layer = first
         end select
      end do
   end subroutine nearest_layer

   !> Moment of a layered joint on its plane [N m].
   elemental real(wp) function moment_on_plane(self, i, rotation, axial_load) result(moment)
      class(spring_planes), intent(in) :: self
      integer, intent(in) :: i
      real(wp), intent(in) :: rotation, axial_load

      moment = self%f0(i) + self%k(i)*(rotation - self%d0(i)) - self%centre(i)*(axial_load - self%press_at(i))
   end function moment_on_plane

   !> The least forward rate of the layers of a joint on one-way lines, see `fibre_section`.
   pure real(wp) function least_forward_rate(self, i, turn, press, digits) result(least)
      class(spring_planes), intent(in) :: self
      integer, intent(in) :: i
      real(wp), intent(in) :: turn(3), press(3), digits

      least = 1.0_wp
      select type (section => self%slot(i)%memory)
      type is (fibre_section)
         least = section%least_forward_rate(turn, press, digits)
      end select
   end function least_forward_rate

   !> Move a layered joint on its plane to a point, where a layer (0: none) comes to the end of its line.
   !> Its work is left to the caller, who knows the path.
   subroutine put_on_plane(self, i, rotation, axial_load, turn, press, first)
      class(spring_planes), intent(inout) :: self
      integer, intent(in) :: i
      real(wp), intent(in) :: rotation, axial_load, turn, press
      integer, intent(in) :: first

      select type (section => self%slot(i)%memory)
      type is (fibre_section)
         call section%put(rotation, axial_load, turn, press, first)
      end select
      call read_plane(self, i)
      self%d(i) = rotation
      if (first > 0) self%events = self%events + 1
   end subroutine put_on_plane

   !> Return to the marked state, to the last bit. The mark stays.
   subroutine restore(self)
      class(spring_planes), intent(inout) :: self
      integer :: j

      call self%spring_lines%restore()
      if (.not. self%pressed) return
      do j = 1, size(self%layered)
         call read_plane(self, self%layered(j))
      end do
   end subroutine restore

   !> Save or restore where the springs are, and what they remember.
   subroutine serialize(self, stream)
      class(spring_planes), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call self%serialize_lines(stream)
      if (.not. (self%pressed .and. stream%restoring)) return
      call read_planes(self)
   end subroutine serialize

   subroutine read_planes(self)
      type(spring_planes), intent(inout) :: self
      integer :: j

      do j = 1, size(self%layered)
         call read_plane(self, self%layered(j))
      end do
      self%press_to(:) = self%press_at
   end subroutine read_planes

   !> Springs that were restored go on under other axial loads: at their rotations layered joints go
   !> straight to them. Those under the load that they have stay as they are, unless they were on planes and
   !> are to be on lines.
   subroutine go_under(self, axial_load, from_planes)
      class(spring_planes), intent(inout) :: self
      !> Of the joints, compression positive (n) [N]
      real(wp), intent(in) :: axial_load(:)
      !> Whether the axial loads varied before
      logical, intent(in) :: from_planes
      type(segment) :: line
      real(wp) :: load
      integer :: i, j

      do j = 1, size(self%layered)
         i = self%layered(j)
         load = axial_load(i - size(axial_load))
         select type (section => self%slot(i)%memory)
         type is (fibre_section)
            if (self%pressed) then
               if (abs(section%axial_load - load) > 0.0_wp .or. .not. from_planes) then
                  call branch_under(section, self%d(i), load, self%work(i), line)
                  call read_plane(self, i)
               end if
               self%press_to(i) = load
            else if (abs(section%axial_load - load) > 0.0_wp .or. from_planes) then
               call branch_under(section, self%d(i), load, self%work(i), line)
               call put_line(self%spring_lines, i, line)
            end if
         end select
      end do
      self%version = modulo(self%version + 1, huge(1))
   end subroutine go_under

end module rbs_hysteresis_spring_planes
