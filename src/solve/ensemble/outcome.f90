!> What is kept of each run of an ensemble: its fate and its measures.
module rbs_solve_ensemble_outcome
   use rbs_base_kinds, only: wp
   implicit none
   private

   public :: outcome_type, measure_count, measure_names
   public :: fate_completed, fate_collapsed, fate_axial, fate_failed, fate_skipped

   !> The fates of a run, a closed list. Skipped runs are those that were not started before a stop.
   integer, parameter :: fate_skipped = 0, fate_completed = 1, fate_collapsed = 2, fate_axial = 3, &
                         fate_failed = 4

   integer, parameter :: measure_count = 16

   !> Positions of the measures; names and order are those of `measure_names`.
   integer, parameter, public :: at_peak_displacement = 1, at_residual_displacement = 2, &
                                 at_peak_base_shear = 3, at_peak_rotation = 4, at_input = 5, at_spring = 6, &
                                 at_damping = 7, at_residual = 8, at_relative_residual = 9, &
                                 at_first_yield = 10, at_end = 11, at_time_step = 12, at_steps = 13, &
                                 at_events = 14, at_cut = 15, at_lost_joint = 16

   !> One run; not a number where a run has failed.
   type :: outcome_type
      integer :: fate = fate_skipped
      real(wp) :: value(measure_count) = 0.0_wp
      !> When each limit state was reached first; not a number if it was not (states) [s]
      real(wp), allocatable :: reached(:)
      !> Why it failed
      character(len=:), allocatable :: message
   end type outcome_type

contains

   !> Names of the measures in their order, separated by blanks.
   pure function measure_names() result(names)
      character(len=512) :: names

      names = 'peak_displacement residual_displacement peak_base_shear peak_rotation input_energy '// &
              'spring_energy damping_energy energy_residual relative_energy_residual first_yield '// &
              'end_time time_step steps events cut_steps lost_joint'
   end function measure_names

end module rbs_solve_ensemble_outcome
