!> In place of `processor.c` where there is no C compiler: nothing is known of the processor.
module rbs_solve_ensemble_processor_unknown
   use, intrinsic :: iso_c_binding, only: c_int
   implicit none
   private

   public :: processor_level

contains

   !> Level 1: the instructions that all processors of the family have.
   integer(c_int) function processor_level() bind(c, name='rbs_processor_level')
      processor_level = 1_c_int
   end function processor_level

end module rbs_solve_ensemble_processor_unknown
