!> The kernels for the instructions that the processor has.
module rbs_solve_ensemble_dispatch
   use, intrinsic :: iso_c_binding, only: c_int
   use rbs_solve_ensemble_one_body_kernel_avx2, only: avx2_kernel => kernel
   use rbs_solve_ensemble_one_body_kernel_avx512, only: avx512_kernel => kernel
   use rbs_solve_ensemble_one_body_kernel_baseline, only: baseline_kernel => kernel
   use rbs_solve_ensemble_lane_arrays, only: kernel_type
   implicit none
   private

   public :: chosen_kernel

   interface
      !> 1: the least that all processors of the family have, 2: AVX2, 3: AVX-512.
      integer(c_int) function processor_level() bind(c, name='rbs_processor_level')
         import :: c_int
      end function processor_level
   end interface

contains

   !> The fastest kernel that the processor has, or a slower one.
   type(kernel_type) function chosen_kernel(most)
      !> 0: the fastest; else the highest level that may be taken
      integer, intent(in) :: most
      integer :: level

      level = processor_level()
      if (most > 0) level = min(level, most)
      select case (level)
      case (3:)
         chosen_kernel = avx512_kernel()
      case (2)
         chosen_kernel = avx2_kernel()
      case default
         chosen_kernel = baseline_kernel()
      end select
   end function chosen_kernel

end module rbs_solve_ensemble_dispatch
