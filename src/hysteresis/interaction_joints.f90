!> Layered joints whose axial loads vary: they follow straight paths in rotation and axial load, and are on
!> planes where other springs are on lines.
module rbs_hysteresis_interaction_joints
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_layered_fibre_fall, only: layer_fall, find_fall
   use rbs_hysteresis_layered_fibre_path, only: choose_branches
   use rbs_hysteresis_layered_fibre_section, only: fibre_section
   use rbs_hysteresis_layered_layered_joint, only: branch_under
   use rbs_hysteresis_segment, only: segment
   use rbs_hysteresis_springs, only: spring_array, put_line, read_plane
   implicit none
   private

   public :: vary_axial_loads, fall_of, opening_of, rest_of, update_branches, line_list, list_lines, &
             place_lines
   public :: moment_on_plane, put_on_plane, change_axial_loads

   !> Lines of the springs, then those of the layers of joints on planes, joint by joint (lines).
   type :: line_list
      !> Ends, and direction of a branch that unloads on reversal, see `segment`
      real(wp), allocatable :: lower(:), upper(:)
      integer, allocatable :: one_way(:)
      !> The spring that a layer belongs to; 0 of springs
      integer, allocatable :: joint(:)
   end type line_list

contains

   !> The axial loads of the layered joints vary from now on: these joints follow straight paths in rotation
   !> and axial load, towards `target_axial_load`, and have no line of their own that the rotation alone could
   !> leave.
   subroutine vary_axial_loads(springs)
      type(spring_array), intent(inout) :: springs

      springs%axial_load_varies = size(springs%layered) > 0
      if (.not. springs%axial_load_varies) return
      springs%on_plane(springs%layered) = .true.
      allocate (springs%target_axial_load(springs%count), springs%reference_axial_load(springs%count), &
                springs%centre(springs%count), source=0.0_wp)
      call springs%fit_planes()
      springs%target_axial_load(:) = springs%reference_axial_load
   end subroutine vary_axial_loads

   !> How a layered joint falls that has lost its axial load.
   subroutine fall_of(springs, i, fall)
      type(spring_array), intent(in) :: springs
      !> Flexural spring of the joint
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
      !> Flexural spring of the joint
      integer, intent(in) :: i
      !> Rotation of the joint [rad]
      real(wp), intent(in) :: d

      opening = 0.0_wp
      select type (section => springs%slot(i)%memory)
      type is (fibre_section)
         opening = section%opening_at(d, section%axial_load)
      end select
   end function opening_of

   !> Rotation of a section from which the rotation of its layered joint is counted [rad]; 0 of other springs.
   pure real(wp) function rest_of(springs, i) result(rest)
      type(spring_array), intent(in) :: springs
      !> Flexural spring of the joint
      integer, intent(in) :: i

      rest = 0.0_wp
      select type (section => springs%slot(i)%memory)
      type is (fibre_section)
         rest = section%rest
      end select
   end function rest_of

   !> Put the layers of a joint on the lines along which they continue on a straight path, and take the plane
   !> that follows.
   subroutine update_branches(springs, i, rotation_rate, axial_rate)
      type(spring_array), intent(inout) :: springs
      !> Flexural spring of the joint
      integer, intent(in) :: i
      !> Changes of the rotation [rad] and of the axial load [N] for each unit of length of the path
      real(wp), intent(in) :: rotation_rate, axial_rate

      select type (section => springs%slot(i)%memory)
      type is (fibre_section)
         call choose_branches(section, rotation_rate, axial_rate)
      end select
      call read_plane(springs, i)
   end subroutine update_branches

   !> The present lines of springs and of layers on planes.
   pure subroutine list_lines(springs, lines)
      type(spring_array), intent(in) :: springs
      !> Its length is set at the first call, its lines at each
      type(line_list), intent(inout) :: lines
      integer :: i, j

      if (.not. allocated(lines%joint)) then
         lines%joint = spread(0, 1, springs%count)
         do j = 1, merge(size(springs%layered), 0, springs%axial_load_varies)
            i = springs%layered(j)
            select type (section => springs%slot(i)%memory)
            type is (fibre_section)
               lines%joint = [lines%joint, spread(i, 1, section%count)]
            end select
         end do
         allocate (lines%lower(size(lines%joint)), lines%upper(size(lines%joint)), &
                   lines%one_way(size(lines%joint)))
      end if
      do i = 1, springs%count
         lines%lower(i) = springs%end_toward(i, -1)
         lines%upper(i) = springs%end_toward(i, 1)
         lines%one_way(i) = springs%unload_on_reversal(i)
      end do
      i = springs%count + 1
      do while (i <= size(lines%joint))
         select type (section => springs%slot(lines%joint(i))%memory)
         type is (fibre_section)
            j = i + section%count - 1
            lines%lower(i:j) = section%lo
            lines%upper(i:j) = section%hi
            lines%one_way(i:j) = section%branch%unload_on_reversal
            i = j + 1
         end select
      end do
   end subroutine list_lines

   !> Where springs and layers are at a point of a path, and their rates.
   pure subroutine place_lines(springs, lines, q, axial_load, rate, axial_rate, d, v)
      type(spring_array), intent(in) :: springs
      type(line_list), intent(in) :: lines
      !> Deformations and axial loads of the springs at that point (count) [m or rad, N]; rates of the
      !> deformations (count), and the one rate of all axial loads
      real(wp), intent(in) :: q(:), axial_load(:), rate(:), axial_rate
      !> Deformations and rates, in the order of the list (lines)
      real(wp), intent(inout) :: d(:), v(:)
      integer :: i, j, joint

      d(:springs%count) = q
      v(:springs%count) = rate
      i = springs%count + 1
      do while (i <= size(lines%joint))
         joint = lines%joint(i)
         select type (section => springs%slot(joint)%memory)
         type is (fibre_section)
            j = i + section%count - 1
            call section%motion_of_layers(q(joint), axial_load(joint), rate(joint), axial_rate, d(i:j), &
                                          v(i:j))
            i = j + 1
         end select
      end do
   end subroutine place_lines

   !> Moment of a layered joint on its plane [N m].
   elemental real(wp) function moment_on_plane(springs, i, rotation, axial_load) result(moment)
      type(spring_array), intent(in) :: springs
      !> Flexural spring of the joint
      integer, intent(in) :: i
      !> Rotation [rad]; axial load, compression positive [N]
      real(wp), intent(in) :: rotation, axial_load

      moment = springs%f0(i) + springs%k(i)*(rotation - springs%d0(i)) &
               - springs%centre(i)*(axial_load - springs%reference_axial_load(i))
   end function moment_on_plane

   !> Move a layered joint on its plane to a point. The caller adds the work.
   subroutine put_on_plane(springs, i, rotation, axial_load, rotation_rate, axial_rate, first)
      type(spring_array), intent(inout) :: springs
      !> Flexural spring of the joint
      integer, intent(in) :: i
      !> Rotation [rad] and axial load, compression positive [N], of that point, and rates on the way to it
      real(wp), intent(in) :: rotation, axial_load, rotation_rate, axial_rate
      !> The layer that comes to the end of its line there, 0 for none
      integer, intent(in) :: first

      select type (section => springs%slot(i)%memory)
      type is (fibre_section)
         call section%put(rotation, axial_load, rotation_rate, axial_rate, first)
      end select
      call read_plane(springs, i)
      springs%d(i) = rotation
      if (first > 0) springs%events = springs%events + 1
   end subroutine put_on_plane

   !> Springs that were restored from a saved state continue under other axial loads: at their rotations
   !> layered joints move straight to these loads. A joint whose load does not change stays as it is, unless
   !> it changes from a plane to a line or back.
   subroutine change_axial_loads(springs, axial_load, from_planes)
      type(spring_array), intent(inout) :: springs
      !> Compression positive (count) [N]
      real(wp), intent(in) :: axial_load(:)
      !> Whether the axial loads varied before
      logical, intent(in) :: from_planes
      type(segment) :: line
      integer :: i, j

      do j = 1, size(springs%layered)
         i = springs%layered(j)
         select type (section => springs%slot(i)%memory)
         type is (fibre_section)
            if (.not. abs(section%axial_load - axial_load(i)) > 0.0_wp .and. &
                (springs%axial_load_varies .eqv. from_planes)) cycle
            call branch_under(section, springs%d(i), axial_load(i), springs%work(i), line)
         end select
         if (springs%axial_load_varies) then
            call read_plane(springs, i)
            springs%target_axial_load(i) = axial_load(i)
         else
            call put_line(springs, i, line)
         end if
      end do
      springs%version = modulo(springs%version + 1, huge(1))
   end subroutine change_axial_loads

end module rbs_hysteresis_interaction_joints
