!> Fall of a joint whose layers can no longer carry its axial load: the load that they can carry at
!> that rotation, and where the joint comes to rest if it falls, if it does.
!>
!> At a fixed rotation the joint closes (or opens, where tension is lost) from end to end of the branches of
!> its layers. It rests at the first point at which the layers carry the load again and their stiffness ahead
!> is positive; the work of the load beyond that of the layers is set free.
module rbs_hysteresis_layered_fibre_fall
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_layered_fibre_section, only: fibre_section
   implicit none
   private

   public :: layer_fall, find_fall

   !> A step beyond this is none.
   real(wp), parameter :: no_step = 1.0e100_wp
   !> A load that is missing by less than this share is carried.
   real(wp), parameter :: carried = 1.0e-12_wp

   type :: layer_fall
      !> Axial load that was lost, and the largest that the layers carry at the rotation, compression positive
      !> [N]
      real(wp) :: axial_load = 0.0_wp, capacity = 0.0_wp
      !> Whether the joint comes to rest; its change of opening then [m], and the energy set free [J]
      logical :: rests = .false.
      real(wp) :: drop = 0.0_wp, freed = 0.0_wp
      !> Moment there [N m]
      real(wp) :: moment = 0.0_wp
   end type layer_fall

contains

   !> Let a copy of a joint fall from its present state, in which it has lost its axial load.
   subroutine find_fall(section, fall)
      type(fibre_section), intent(in) :: section
      type(layer_fall), intent(out) :: fall
      type(fibre_section) :: copy
      real(wp) :: begin, gain, most, work, step, next, scale
      integer :: event, i, direction

      copy = section
      direction = section%failure_direction
      if (direction == 0) direction = merge(-1, 1, section%axial_load >= 0.0_wp)
      fall%axial_load = section%axial_load
      begin = copy%opening
      scale = carried*(abs(section%axial_load) + section%stiffness*section%largest)
      most = 0.0_wp
      work = 0.0_wp
      do event = 1, 1000 + 1000*copy%count
         ! Every layer on its next branch.
         do i = 1, copy%count
            call copy%go_on(i, direction)
         end do
         call copy%sum_up()
         ! Force of the layers beyond the load; it grows with their stiffness.
         gain = direction*(tension(copy, 0.0_wp) + copy%axial_load)
         ! At a fixed rotation all layers move with the opening: the way to the first end of a branch.
         step = no_step
         do i = 1, copy%count
            associate (d => copy%deformation(i))
               step = min(step, merge(copy%hi(i) - d, d - copy%lo(i), direction > 0))
            end associate
         end do
         if (.not. fall%rests .and. abs(copy%opening - begin) > 0.0_wp .and. copy%a > 0.0_wp) then
            ! The joint rests where the layers carry the load again, if that lies on these branches.
            next = max(-gain, 0.0_wp)/copy%a
            if (-gain <= scale) next = 0.0_wp
            if (next <= step) then
               fall%rests = .true.
               fall%drop = copy%opening + direction*next - begin
               fall%moment = copy%moment_0 + copy%s*(begin + fall%drop) + copy%q*copy%rotation
               ! Work of the axial load less that of the layers, whose mean force acts in mid-way.
               fall%freed = -fall%axial_load*fall%drop - &
                            (work + direction*next*tension(copy, 0.5_wp*direction*next))
            end if
         end if
         most = max(most, gain)
         if (.not. step < no_step) exit
         work = work + direction*step*tension(copy, 0.5_wp*direction*step)
         copy%opening = copy%opening + direction*step
         copy%largest = max(copy%largest, abs(copy%opening) + copy%reach*abs(copy%rotation))
      end do
      fall%capacity = fall%axial_load - direction*most
   end subroutine find_fall

   !> Force of the layers, tension positive, where the joint has opened further by a way [m] [N].
   pure real(wp) function tension(copy, further)
      type(fibre_section), intent(in) :: copy
      real(wp), intent(in) :: further

      tension = copy%force_0 + copy%a*(copy%opening + further) + copy%s*copy%rotation
   end function tension

end module rbs_hysteresis_layered_fibre_fall
