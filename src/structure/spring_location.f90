!> Where a spring is in a structure. Nobody else finds a spring by index arithmetic.
module rbs_structure_spring_location
   implicit none
   private

   public :: spring_location, spring_name
   public :: shear, flexure, axial, layer

   !> Kinds of springs, by the deformation that they resist: slip, relative rotation, opening; in frames the
   !> layers of a joint are springs of their own, which open by w + y theta.
   integer, parameter :: shear = 1, flexure = 2, axial = 3, layer = 4

   type :: spring_location
      !> `shear`, `flexure`, `axial` or `layer`
      integer :: kind = 0
      !> Member, 1 for a column, 0 for the panel of a node, and joint of it from the bottom up;
      !> joint 0 is that of a footing
      integer :: member = 1, joint = 0
      !> First and last of the springs whose work this one may ask for: a flexural spring, or the layers of a
      !> joint; 0: none
      integer :: work_source = 0, last_work_source = 0
      !> Number of the joint among those of all members
      integer :: index = 0
      !> Name of the member, or of the node that a spring from the ground belongs to; blank for a column
      character(len=40) :: owner = ''
   end type spring_location

contains

   !> Which spring it is, for messages: 'the shear spring of joint 3'.
   pure character(len=80) function spring_name(location) result(name)
      type(spring_location), intent(in) :: location
      character(len=9), parameter :: kinds(4) = ['shear    ', 'flexural ', 'axial    ', 'layer    ']
      character(len=12) :: joint

      write (joint, '(i0)') location%joint
      name = 'the '//trim(kinds(location%kind))//' spring of joint '//joint
      ! Springs of a frame have an owner; those from the ground have no joint, those of panels no member.
      if (location%owner == '') return
      if (location%joint == 0) then
         name = 'the '//trim(kinds(location%kind))//' spring from the ground to '//location%owner
      else if (location%member == 0) then
         name = 'the spring of the panel of node '//location%owner
      else if (location%kind == layer) then
         name = 'a layer of joint '//trim(joint)//' of member '//location%owner
      else
         name = 'the '//trim(kinds(location%kind))//' spring '//trim(joint)//' of member '//location%owner
      end if
   end function spring_name

end module rbs_structure_spring_location
