!> Layered joints whose axial loads vary: they follow straight paths in rotation and axial load, and are on
!> planes where other springs are on lines.
module rbs_hysteresis_interaction_joints
   use rbs_base_constants, only: unbounded
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_layered_fibre_fall, only: layer_fall, find_fall
   use rbs_hysteresis_layered_fibre_path, only: choose_branches, way_to_event
   use rbs_hysteresis_layered_fibre_section, only: fibre_section
   use rbs_hysteresis_layered_layered_joint, only: branch_under
   use rbs_hysteresis_segment, only: segment
   use rbs_hysteresis_springs, only: spring_array, put_line, read_plane
   implicit none
   private

   public :: vary_axial_loads, fall_of, opening_of, rest_of, choose_lines, nearest_layer
   public :: moment_on_plane, least_forward_rate, put_on_plane, go_under

contains

   !> The axial loads of the layered joints vary from now on: these joints follow straight paths in rotation
   !> and axial load, towards `press_to`, and have no line of their own that the rotation alone could leave.
   subroutine vary_axial_loads(springs)
      type(spring_array), intent(inout) :: springs

      springs%pressed = size(springs%layered) > 0
      if (.not. springs%pressed) return
      springs%on_plane(springs%layered) = .true.
      allocate (springs%press_to(springs%count), springs%press_at(springs%count), &
                springs%centre(springs%count), source=0.0_wp)
      call springs%fit_planes()
      springs%press_to(:) = springs%press_at
   end subroutine vary_axial_loads

   !> State of a joint that has lost its axial load.
   subroutine fall_of(springs, i, fall)
      type(spring_array), intent(in) :: springs
      integer, intent(in) :: i
      type(layer_fall), intent(out) :: fall

      select type (section => springs%slot(i)%memory)
      type is (fibre_section)
         call find_fall(section, fall)
      end select
   end subroutine fall_of

   !> Opening of a layered joint on its present line or plane [m]; 0 of other springs.
   pure real(wp) function opening_of(springs, i, d) result(opening)
      type(spring_array), intent(in) :: springs
      !> Its flexural spring
      integer, intent(in) :: i
      !> Rotation [rad]
      real(wp), intent(in) :: d

      opening = 0.0_wp
      select type (section => springs%slot(i)%memory)
      type is (fibre_section)
         opening = section%opening_at(d, section%axial_load)
      end select
   end function opening_of

   !> Rotation from which a layered joint counts its own [rad]; 0 of other springs.
   pure real(wp) function rest_of(springs, i) result(rest)
      type(spring_array), intent(in) :: springs
      integer, intent(in) :: i

      rest = 0.0_wp
      select type (section => springs%slot(i)%memory)
      type is (fibre_section)
         rest = section%rest
      end select
   end function rest_of

   !> Put the layers of a joint on the lines on which they go on along a straight path.
   subroutine choose_lines(springs, i, turn, press)
      type(spring_array), intent(inout) :: springs
      integer, intent(in) :: i
      !> Rates of the rotation [rad] and of the axial load [N]
      real(wp), intent(in) :: turn, press

      select type (section => springs%slot(i)%memory)
      type is (fibre_section)
         call choose_branches(section, turn, press)
      end select
      call read_plane(springs, i)
   end subroutine choose_lines

   !> How far the layered joints can go from points of their planes along straight paths until the first layer
   !> reaches the end of its line.
   pure subroutine nearest_layer(springs, rotation, axial_load, turn, press, way, joint, layer)
      type(spring_array), intent(in) :: springs
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
      do j = 1, size(springs%layered)
         i = springs%layered(j)
         select type (section => springs%slot(i)%memory)
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
   elemental real(wp) function moment_on_plane(springs, i, rotation, axial_load) result(moment)
      type(spring_array), intent(in) :: springs
      integer, intent(in) :: i
      real(wp), intent(in) :: rotation, axial_load

      moment = springs%f0(i) + springs%k(i)*(rotation - springs%d0(i)) &
               - springs%centre(i)*(axial_load - springs%press_at(i))
   end function moment_on_plane

   !> The least forward rate of the layers of a joint that would unload on reversal, see `fibre_section`.
   pure real(wp) function least_forward_rate(springs, i, turn, press, digits) result(least)
      type(spring_array), intent(in) :: springs
      integer, intent(in) :: i
      real(wp), intent(in) :: turn(3), press(3), digits

      least = 1.0_wp
      select type (section => springs%slot(i)%memory)
      type is (fibre_section)
         least = section%least_forward_rate(turn, press, digits)
      end select
   end function least_forward_rate

   !> Move a layered joint on its plane to a point, where a layer (0: none) comes to the end of its line.
   !> Its work is left to the caller, who knows the path.
   subroutine put_on_plane(springs, i, rotation, axial_load, turn, press, first)
      type(spring_array), intent(inout) :: springs
      integer, intent(in) :: i
      real(wp), intent(in) :: rotation, axial_load, turn, press
      integer, intent(in) :: first

      select type (section => springs%slot(i)%memory)
      type is (fibre_section)
         call section%put(rotation, axial_load, turn, press, first)
      end select
      call read_plane(springs, i)
      springs%d(i) = rotation
      if (first > 0) springs%events = springs%events + 1
   end subroutine put_on_plane

   !> Springs that were restored go on under other axial loads: at their rotations layered joints go
   !> straight to them. Those under the load that they have stay as they are, unless they were on planes and
   !> are to be on lines.
   subroutine go_under(springs, axial_load, from_planes)
      type(spring_array), intent(inout) :: springs
      !> Compression positive (count) [N]
      real(wp), intent(in) :: axial_load(:)
      !> Whether the axial loads varied before
      logical, intent(in) :: from_planes
      type(segment) :: line
      real(wp) :: load
      integer :: i, j

      do j = 1, size(springs%layered)
         i = springs%layered(j)
         load = axial_load(i)
         select type (section => springs%slot(i)%memory)
         type is (fibre_section)
            if (springs%pressed) then
               if (abs(section%axial_load - load) > 0.0_wp .or. .not. from_planes) then
                  call branch_under(section, springs%d(i), load, springs%work(i), line)
                  call read_plane(springs, i)
               end if
               springs%press_to(i) = load
            else if (abs(section%axial_load - load) > 0.0_wp .or. from_planes) then
               call branch_under(section, springs%d(i), load, springs%work(i), line)
               call put_line(springs, i, line)
            end if
         end select
      end do
      springs%version = modulo(springs%version + 1, huge(1))
   end subroutine go_under

end module rbs_hysteresis_interaction_joints
