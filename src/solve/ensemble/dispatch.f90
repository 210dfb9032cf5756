!> The kernels for the instructions that the processor has.
module rbs_solve_ensemble_dispatch
   use, intrinsic :: iso_c_binding, only: c_int
   use rbs_solve_ensemble_lane_fields, only: one_body_lanes, lane_method, lanes, wp
   use rbs_solve_ensemble_kernel_baseline, only: rk4_baseline => rk4_lanes, &
                                                 implicit_baseline => implicit_lanes, &
                                                 finish_baseline => finish_step
   use rbs_solve_ensemble_kernel_avx2, only: rk4_avx2 => rk4_lanes, implicit_avx2 => implicit_lanes, &
                                             finish_avx2 => finish_step
   use rbs_solve_ensemble_kernel_avx512, only: rk4_avx512 => rk4_lanes, implicit_avx512 => implicit_lanes, &
                                               finish_avx512 => finish_step
   implicit none
   private

   public :: kernel_type, chosen_kernel

   abstract interface
      subroutine rk4_interface(x, count, list)
         import :: one_body_lanes, lanes
         implicit none
         type(one_body_lanes), intent(inout) :: x
         integer, intent(out) :: count, list(lanes)
      end subroutine rk4_interface

      subroutine implicit_interface(x, method, count, list)
         import :: one_body_lanes, lane_method, lanes
         implicit none
         type(one_body_lanes), intent(inout) :: x
         type(lane_method), intent(in) :: method
         integer, intent(out) :: count, list(lanes)
      end subroutine implicit_interface

      subroutine finish_interface(x, m, time, acceleration, count, list)
         import :: one_body_lanes, lanes, wp
         implicit none
         type(one_body_lanes), intent(inout) :: x
         integer, intent(in) :: m
         real(wp), intent(in) :: time(m), acceleration(m)
         integer, intent(out) :: count, list(lanes)
      end subroutine finish_interface
   end interface

   !> The procedures of `kernel.inc`.
   type :: kernel_type
      procedure(rk4_interface), pointer, nopass :: rk4_lanes => null()
      procedure(implicit_interface), pointer, nopass :: implicit_lanes => null()
      procedure(finish_interface), pointer, nopass :: finish_step => null()
   end type kernel_type

   interface
      !> 1: the least that all processors of the family have, 2: AVX2, 3: AVX-512.
      integer(c_int) function processor_level() bind(c, name='rbs_processor_level')
         import :: c_int
         implicit none
      end function processor_level
   end interface

contains

   !> The fastest kernel that the processor has, or a slower one.
   function chosen_kernel(most) result(kernel)
      !> 0: the fastest; else the highest level that may be taken
      integer, intent(in) :: most
      type(kernel_type) :: kernel
      integer :: level

      level = processor_level()
      if (most > 0) level = min(level, most)
      select case (level)
      case (3:)
         kernel%rk4_lanes => rk4_avx512
         kernel%implicit_lanes => implicit_avx512
         kernel%finish_step => finish_avx512
      case (2)
         kernel%rk4_lanes => rk4_avx2
         kernel%implicit_lanes => implicit_avx2
         kernel%finish_step => finish_avx2
      case default
         kernel%rk4_lanes => rk4_baseline
         kernel%implicit_lanes => implicit_baseline
         kernel%finish_step => finish_baseline
      end select
   end function chosen_kernel

end module rbs_solve_ensemble_dispatch
