!> Physical and numerical constants.
module rbs_base_constants
   use rbs_base_kinds, only: wp
   implicit none
   private

   real(wp), parameter, public :: pi = 3.141592653589793238462643383279502884_wp

   !> Standard acceleration of gravity [m/s2].
   real(wp), parameter, public :: standard_gravity = 9.80665_wp

   !> A deformation that is never reached: the end of a line without end.
   real(wp), parameter, public :: unbounded = huge(1.0_wp)

   !> Larger numbers, and positive ones below its inverse, have no meaning in any unit; products of them
   !> would overflow or vanish.
   real(wp), parameter, public :: beyond_meaning = 1.0e50_wp

   !> Marks a number that the user has not given. Not a NaN: a NaN from the user must be refused as
   !> such, and comparing a NaN traps in builds with floating-point traps.
   real(wp), parameter, public :: unset = -huge(1.0_wp)

   !> The same for a whole number.
   integer, parameter, public :: unset_integer = -huge(1)

end module rbs_base_constants
