!> Input of an ensemble: columns with their settings and limit states, motions of the ground, and runs.
module rbs_solve_ensemble_ensemble_input
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_case_analysis_record, only: analysis_record
   use rbs_loading_loads, only: loads_type, horizontal, sideways
   use rbs_solve_time_plan, only: time_plan
   use rbs_solve_time_monitor, only: watch_type
   use rbs_structure_structure, only: structure_type
   implicit none
   private

   public :: ensemble_column, ensemble_motion, run_type, lane_task

   !> A column, or a frame, with the settings of its runs.
   type :: ensemble_column
      class(structure_type), allocatable :: structure
      type(analysis_record) :: analysis
      !> Limit states of its runs, and the number of limit states of the ensemble
      type(watch_type), allocatable :: watch(:)
      integer :: states = 1
      !> The state that its runs begin in, as `end_state` has it; not allocated: at rest
      real(wp), allocatable :: before(:)
      !> Its fault, with which all its runs fail
      type(error_type), allocatable :: error
   end type ensemble_column

   !> A ground motion, or two at once along x and y.
   type :: ensemble_motion
      !> Times (m) [s], ascending, and accelerations (m) [m/s2]
      real(wp), allocatable :: time(:), acceleration(:)
      !> Accelerations along y (m) [m/s2]; not allocated: none
      real(wp), allocatable :: across(:)
   contains
      procedure :: loads
   end type ensemble_motion

   !> One run: its column, its motion, and the factor of the accelerations.
   type :: run_type
      integer :: column = 0, motion = 0
      real(wp) :: scale = 1.0_wp
   end type run_type

   !> A run that lanes can take: its place among the runs, its steps, equal steps in each interval of the
   !> motion, and the scale of the motion.
   type :: lane_task
      integer :: run = 0
      type(time_plan) :: plan
      integer :: parts = 1
      real(wp) :: scale = 1.0_wp
   end type lane_task

contains

   !> The motion as loads of an analysis: accelerations of the ground times a factor, along x and, if there
   !> are any, along y.
   pure type(loads_type) function loads(self, scale)
      class(ensemble_motion), intent(in) :: self
      real(wp), intent(in) :: scale

      loads%signal(horizontal)%time = self%time
      loads%signal(horizontal)%value = scale*self%acceleration
      if (.not. allocated(self%across)) return
      loads%signal(sideways)%time = self%time
      loads%signal(sideways)%value = scale*self%across
   end function loads

end module rbs_solve_ensemble_ensemble_input
