!> The kernels for the instructions that the processor has.
module rbs_solve_ensemble_dispatch
   use, intrinsic :: iso_c_binding, only: c_int
   use rbs_solve_ensemble_lane_fields, only: lane_clock, one_body_lanes, chain_block, lane_method, lanes, &
                                             few, wp
   use rbs_solve_ensemble_kernel_baseline, only: rk4_baseline => rk4_lanes, &
      implicit_baseline => implicit_lanes, finish_baseline => finish_step, turn_baseline => turn_clock
   use rbs_solve_ensemble_chain_forces_baseline, only: measure_baseline => measure_chain
   use rbs_solve_ensemble_chain_kernel_baseline, only: rk4_chain_baseline => rk4_chain, &
      implicit_chain_baseline => implicit_chain
   use rbs_solve_ensemble_kernel_avx2, only: rk4_avx2 => rk4_lanes, &
      implicit_avx2 => implicit_lanes, finish_avx2 => finish_step, turn_avx2 => turn_clock
   use rbs_solve_ensemble_chain_forces_avx2, only: measure_avx2 => measure_chain
   use rbs_solve_ensemble_chain_kernel_avx2, only: rk4_chain_avx2 => rk4_chain, &
      implicit_chain_avx2 => implicit_chain
   use rbs_solve_ensemble_kernel_avx512, only: rk4_avx512 => rk4_lanes, &
      implicit_avx512 => implicit_lanes, finish_avx512 => finish_step, turn_avx512 => turn_clock
   use rbs_solve_ensemble_chain_forces_avx512, only: measure_avx512 => measure_chain
   use rbs_solve_ensemble_chain_kernel_avx512, only: rk4_chain_avx512 => rk4_chain, &
      implicit_chain_avx512 => implicit_chain
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

      subroutine turn_interface(x, m, time, acceleration, row, rows, count, list)
         import :: lane_clock, lanes, wp
         implicit none
         type(lane_clock), intent(inout) :: x
         integer, intent(in) :: m
         real(wp), intent(in) :: time(m), acceleration(m)
         real(wp), intent(out) :: row(lanes)
         logical, intent(out) :: rows
         integer, intent(out) :: count, list(lanes)
      end subroutine turn_interface

      subroutine rk4_chain_interface(clock, b, base, inside)
         import :: lane_clock, chain_block, few
         implicit none
         type(lane_clock), intent(inout) :: clock
         type(chain_block), intent(inout) :: b
         integer, intent(in) :: base
         logical, intent(out) :: inside(few)
      end subroutine rk4_chain_interface

      subroutine implicit_chain_interface(clock, b, base, method, inside)
         import :: lane_clock, chain_block, lane_method, few
         implicit none
         type(lane_clock), intent(inout) :: clock
         type(chain_block), intent(inout) :: b
         integer, intent(in) :: base
         type(lane_method), intent(in) :: method
         logical, intent(out) :: inside(few)
      end subroutine implicit_chain_interface

      subroutine measure_interface(b)
         import :: chain_block
         implicit none
         type(chain_block), intent(inout) :: b
      end subroutine measure_interface
   end interface

   !> The procedures of the kernels.
   type :: kernel_type
      procedure(rk4_interface), pointer, nopass :: rk4_lanes => null()
      procedure(implicit_interface), pointer, nopass :: implicit_lanes => null()
      procedure(finish_interface), pointer, nopass :: finish_step => null()
      procedure(turn_interface), pointer, nopass :: turn_clock => null()
      procedure(measure_interface), pointer, nopass :: measure_chain => null()
      procedure(rk4_chain_interface), pointer, nopass :: rk4_chain => null()
      procedure(implicit_chain_interface), pointer, nopass :: implicit_chain => null()
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
         kernel%turn_clock => turn_avx512
         kernel%rk4_chain => rk4_chain_avx512
         kernel%measure_chain => measure_avx512
         kernel%implicit_chain => implicit_chain_avx512
      case (2)
         kernel%rk4_lanes => rk4_avx2
         kernel%implicit_lanes => implicit_avx2
         kernel%finish_step => finish_avx2
         kernel%turn_clock => turn_avx2
         kernel%rk4_chain => rk4_chain_avx2
         kernel%measure_chain => measure_avx2
         kernel%implicit_chain => implicit_chain_avx2
      case default
         kernel%rk4_lanes => rk4_baseline
         kernel%implicit_lanes => implicit_baseline
         kernel%finish_step => finish_baseline
         kernel%turn_clock => turn_baseline
         kernel%rk4_chain => rk4_chain_baseline
         kernel%measure_chain => measure_baseline
         kernel%implicit_chain => implicit_chain_baseline
      end select
   end function chosen_kernel

end module rbs_solve_ensemble_dispatch
