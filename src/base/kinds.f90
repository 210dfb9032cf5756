!> The one real kind of the program.
module rbs_base_kinds
   use, intrinsic :: iso_fortran_env, only: real64
   implicit none
   private

   !> Working precision: double; a structural model needs no other.
   integer, parameter, public :: wp = real64

end module rbs_base_kinds
