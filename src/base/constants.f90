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

   !> In time deformations beyond this [m, rad] have no meaning, and their squares would overflow.
   real(wp), parameter, public :: out_of_bounds = 1.0e100_wp

   !> Numbers larger than this, and positive numbers below its inverse, are refused in every unit: products
   !> of them would overflow or vanish.
   real(wp), parameter, public :: beyond_meaning = 1.0e50_wp

   !> Marks a number that the user has not given. It is not a NaN: a NaN from the user must be refused,
   !> and comparing a NaN traps in builds with floating-point traps.
   real(wp), parameter, public :: unset = -huge(1.0_wp)

   !> The same for a whole number.
   integer, parameter, public :: unset_integer = -huge(1)

end module rbs_base_constants
