!> The kernels for the instructions that the processor has.
module rbs_solve_ensemble_dispatch
   use, intrinsic :: iso_c_binding, only: c_int
   use rbs_solve_ensemble_chain_kernel_avx2, only: avx2_kernels => kernels
   use rbs_solve_ensemble_chain_kernel_avx512, only: avx512_kernels => kernels
   use rbs_solve_ensemble_chain_kernel_baseline, only: baseline_kernels => kernels
   use rbs_solve_ensemble_lane_arrays, only: kernel_type
   implicit none
   private

   public :: chosen_kernel

   interface
      !> 1: the least that all processors of the family have, 2: AVX2, 3: AVX-512.
      integer(c_int) function processor_level() bind(c, name='rbs_processor_level')
         import :: c_int
         implicit none
      end function processor_level
   end interface

contains

   !> The fastest kernel that the processor has, or a slower one.
   type(kernel_type) function chosen_kernel(most, one_body)
      !> 0: the fastest; else the highest level that may be taken
      integer, intent(in) :: most
      !> Whether the columns are one body without damping
      logical, intent(in) :: one_body
      integer :: level

      level = processor_level()
      if (most > 0) level = min(level, most)
      select case (level)
      case (3:)
         chosen_kernel = avx512_kernels(one_body)
      case (2)
         chosen_kernel = avx2_kernels(one_body)
      case default
         chosen_kernel = baseline_kernels(one_body)
      end select
   end function chosen_kernel

end module rbs_solve_ensemble_dispatch
