!> The motions of an ensemble as the kernels read them.
module rbs_solve_ensemble_motions
   use rbs_base_kinds, only: wp
   use rbs_solve_ensemble_subject, only: ensemble_motion
   implicit none
   private

   public :: motion_table, fill_table

   !> One after the other, each followed by two more points.
   type :: motion_table
      real(wp), allocatable :: time(:), acceleration(:)
      !> Place of the first point of each
      integer, allocatable :: first(:)
   end type motion_table

contains

   !> Fill the table.
   subroutine fill_table(motion, table)
      type(ensemble_motion), intent(in) :: motion(:)
      type(motion_table), intent(out) :: table
      integer :: j, m, at

      at = 0
      do j = 1, size(motion)
         at = at + size(motion(j)%time) + 2
      end do
      allocate (table%time(at), table%acceleration(at), table%first(size(motion)))
      at = 0
      do j = 1, size(motion)
         m = size(motion(j)%time)
         table%first(j) = at + 1
         table%time(at + 1:at + m) = motion(j)%time
         table%time(at + m + 1) = motion(j)%time(m) + 1.0_wp
         table%time(at + m + 2) = motion(j)%time(m) + 2.0_wp
         table%acceleration(at + 1:at + m) = motion(j)%acceleration
         ! After its end a motion stays at its last value.
         table%acceleration(at + m + 1:at + m + 2) = motion(j)%acceleration(m)
         at = at + m + 2
      end do
   end subroutine fill_table

end module rbs_solve_ensemble_motions
