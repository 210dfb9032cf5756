!> Tolerances that several rooms share: one value for each name.
module rbs_base_tolerances
   use rbs_base_kinds, only: wp
   implicit none
   private

   !> A sum below this share of its terms is round-off: a few units in the last place of each.
   real(wp), parameter, public :: round_off = 8.0_wp*epsilon(1.0_wp)

   !> The same of forces and works that are sums over a whole structure.
   real(wp), parameter, public :: round_off_of_sums = 32.0_wp*epsilon(1.0_wp)

   !> The same of rates, which are solutions of equations with a condition of some thousands.
   real(wp), parameter, public :: round_off_of_rates = 1.0e-12_wp

   !> A slope or a pivot below this share of the initial stiffness is the round-off of zero: four digits more
   !> than the last one, as they are differences of numbers of its size.
   real(wp), parameter, public :: no_stiffness = 1.0e-12_wp

   !> A force below this share of the largest one, or of the yield force, is zero, for the same reason.
   real(wp), parameter, public :: no_force = 1.0e-12_wp

   !> Numbers of the input, and what follows from them in a few steps, that agree to nine digits are meant to
   !> be the same: places, lengths, times.
   real(wp), parameter, public :: same_input = 1.0e-9_wp

   !> Half of the digits: a smaller share of a number has few digits of its own, and what it adds to the next
   !> correction is round-off.
   real(wp), parameter, public :: half_of_digits = 1.0e-8_wp

   !> Lines whose slopes are this close to each other do not meet: their intersection would lose nine digits.
   real(wp), parameter, public :: parallel = 1.0e-9_wp

   !> Share of its initial stiffness that a spring without any is given where nothing else tells how several
   !> share a motion: between round-off, which it must exceed, and the softest springs that are meant.
   real(wp), parameter, public :: hardening_of_none = 1.0e-9_wp

end module rbs_base_tolerances
