!> What an ensemble is made of: columns with what is asked of them, motions of the ground, and runs.
module rbs_solve_ensemble_subject
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_case_analysis_record, only: analysis_record
   use rbs_column_column, only: column_type
   implicit none
   private

   public :: ensemble_column, ensemble_motion, run_type

   !> A column and what is asked of it.
   type :: ensemble_column
      type(column_type) :: column
      type(analysis_record) :: analysis
      !> Rotation at which each joint yields; `huge` where that is not known (n) [rad]
      real(wp), allocatable :: yield(:)
      !> What is wrong with it; all its runs fail
      type(error_type), allocatable :: error
   end type ensemble_column

   !> A ground motion.
   type :: ensemble_motion
      !> Times (m) [s], ascending, and accelerations (m) [m/s2]
      real(wp), allocatable :: time(:), acceleration(:)
   end type ensemble_motion

   !> One run: its column, its motion, and the factor of the accelerations.
   type :: run_type
      integer :: column = 0, motion = 0
      real(wp) :: scale = 1.0_wp
   end type run_type

end module rbs_solve_ensemble_subject
