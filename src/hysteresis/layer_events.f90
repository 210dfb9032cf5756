!> Events of the layers of joints whose axial loads vary, within a step in time. On its plane a joint gives
!> the deformation of every layer as a linear function of rotation and axial load,
!>
!>     d_i = w(phi, N) + y_i phi,        v_i = w'(phi', N') + y_i phi'
!>
!> so that a layer leaves its line as any spring does.
module rbs_hysteresis_layer_events
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_layered_fibre_section, only: fibre_section
   use rbs_hysteresis_line_exit, only: line_exit, find_exit
   use rbs_hysteresis_springs, only: spring_array
   implicit none
   private

   public :: layer_motion, layer_end, first_layer_exit, turn_layer

contains

   !> Deformation and velocity of a layer at a point of the present plane of its joint.
   pure subroutine layer_motion(springs, i, layer, rotation, axial_load, turn, press, d, v)
      type(spring_array), intent(in) :: springs
      !> The joint, and its layer
      integer, intent(in) :: i, layer
      !> Rotation of the joint and axial load, and their rates
      real(wp), intent(in) :: rotation, axial_load, turn, press
      real(wp), intent(out) :: d, v

      d = 0.0_wp
      v = 0.0_wp
      select type (section => springs%slot(i)%memory)
      type is (fibre_section)
         d = section%opening_at(rotation, axial_load) + section%y(layer)*(rotation + section%rest)
         v = section%rate_of_opening(turn, press) + section%y(layer)*turn
      end select
   end subroutine layer_motion

   !> The end of the line of a layer in a direction, and what the last digits leave undecided there [m].
   pure subroutine layer_end(springs, i, layer, way, finish, digits)
      type(spring_array), intent(in) :: springs
      integer, intent(in) :: i, layer, way
      real(wp), intent(out) :: finish, digits

      finish = 0.0_wp
      digits = 0.0_wp
      select type (section => springs%slot(i)%memory)
      type is (fibre_section)
         finish = section%branch(layer)%end_toward(way)
         digits = section%room_in_digits()
      end select
   end subroutine layer_end

   !> The first layer of a joint that leaves its line on the way to a point of the plane.
   pure subroutine first_layer_exit(springs, i, rotation, axial_load, turn, press, h, layer, exit)
      type(spring_array), intent(in) :: springs
      integer, intent(in) :: i
      !> Rotation and axial load at the end of the step; rates of the rotation at the start of the step and at
      !> its end, and of the axial load
      real(wp), intent(in) :: rotation, axial_load, turn(2), press
      !> Length of the step [s]
      real(wp), intent(in) :: h
      !> The layer, 0 for none
      integer, intent(out) :: layer
      type(line_exit), intent(out) :: exit
      type(line_exit) :: one
      real(wp) :: d(2), v(2), opening, turned, open(2), least(2), digits
      integer :: j

      layer = 0
      exit%estimate = huge(1.0_wp)
      select type (section => springs%slot(i)%memory)
      type is (fibre_section)
         turned = rotation + section%rest
         opening = section%opening_at(rotation, axial_load)
         open = [section%rate_of_opening(turn(1), press), section%rate_of_opening(turn(2), press)]
         least = [section%least_rate(open(1), turn(1)), section%least_rate(open(2), turn(2))]
         digits = section%room_in_digits()
         do j = 1, section%count
            d = [section%deformation(j), opening + section%y(j)*turned]
            v = open + section%y(j)*turn
            ! Most layers stay inside their line and do not turn.
            if (d(2) >= section%lo(j) .and. d(2) <= section%hi(j) .and. v(1)*v(2) > 0.0_wp .and. &
                section%unload_on_reversal(j)*v(2) >= 0.0_wp) cycle
            where (abs(v) <= least) v = 0.0_wp
            ! A layer that keeps still does not turn.
            if (.not. any(abs(v) > 0.0_wp)) cycle
            call find_exit([section%lo(j), section%hi(j)], section%branch(j)%unload_on_reversal, d, v, h, &
                           digits, one)
            if (one%way == 0 .or. one%estimate >= exit%estimate) cycle
            exit = one
            layer = j
         end do
      end select
   end subroutine first_layer_exit

   !> A layer whose motion has come to a stand unloads. Its joint chooses its branches
   !> afterwards.
   subroutine turn_layer(springs, i, layer, way)
      type(spring_array), intent(inout) :: springs
      integer, intent(in) :: i, layer
      !> The direction in which it goes on
      integer, intent(in) :: way

      select type (section => springs%slot(i)%memory)
      type is (fibre_section)
         call section%leave(layer, way)
         call section%sum_up()
      end select
      springs%events = springs%events + 1
   end subroutine turn_layer

end module rbs_hysteresis_layer_events
