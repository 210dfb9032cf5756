!> The entry of the static analyses.
module rbs_solve_static_run_static
   use rbs_base_error, only: error_type, fatal_error, bad_input
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_structure_column_column, only: column_type, small, finite
   use rbs_solve_check_values, only: check_values
   use rbs_solve_static_curved, only: trace_curved
   use rbs_solve_static_straight, only: trace_straight
   use rbs_solve_task, only: task_type
   use rbs_structure_spring_place, only: flexure
   implicit none
   private

   public :: run_static

   !> Axial loads that differ by less than this share are one constant load.
   real(wp), parameter :: same_load = 1.0e-12_wp

contains

   !> Static path through displacements of the top or lateral forces.
   subroutine run_static(column, by_force, target, task, error, axial_load)
      class(column_type), intent(in) :: column
      !> Whether the targets are lateral forces [N], else displacements of the top [m]
      logical, intent(in) :: by_force
      !> Targets (m)
      real(wp), intent(in) :: target(:)
      type(task_type), intent(inout) :: task
      type(error_type), allocatable, intent(out) :: error
      !> Axial load at the top at each target (m), instead of the constant one; empty: constant [N]
      real(wp), intent(in), optional :: axial_load(:)
      class(column_type), allocatable :: loaded
      real(wp) :: load(size(target))
      logical :: varies, curved

      loaded = column
      load = column%axial_load
      varies = abs(column%axial_force_ratio) > 0.0_wp
      if (present(axial_load)) then
         if (size(axial_load) > 0) then
            call check_axial_load(column, axial_load, size(target), error)
            if (allocated(error)) return
            load = axial_load
            ! From the state of another analysis the load goes to its first value.
            varies = varies .or. task%resumes() .or. any(abs(load - load(1)) > same_load*maxval(abs(load)))
            call put_under(loaded, load(1))
         end if
      end if
      curved = varies .or. column%kinematics == finite
      if (curved .and. (column%axial_follows .or. column%force_follows)) then
         call fatal_error(error, bad_input, 'column: loads that follow the top (axial_follows, '// &
                          'force_follows) have no potential, and a static path could miss the loss of '// &
                          'stability; use a dynamic analysis')
         return
      end if
      if (by_force) then
         call check_values(target, 'force', error)
      else
         call check_values(target, 'displacement', error)
      end if
      if (allocated(error)) return
      if (curved) then
         call trace_curved(loaded, by_force, target, pack(load, varies), task, error)
      else
         call trace_straight(loaded, by_force, target, task, error)
      end if
      ! Without inertia the ground holds what drives the column.
      task%summary%peak_base_shear = task%summary%peak_force
      task%summary%method = 'static'
   end subroutine run_static

   !> Put a column under another constant axial load at its top.
   pure subroutine put_under(column, load)
      type(column_type), intent(inout) :: column
      real(wp), intent(in) :: load
      real(wp) :: more

      more = load - column%axial_load
      if (.not. abs(more) > 0.0_wp) return
      associate (n => column%n)
         column%axial_load = load
         column%axial_body = column%axial_body + more*column%axial_lever
         column%axial_joint = column%axial_joint + more*column%axial_lever
         column%axial_slip = column%axial_joint
         if (column%held) column%axial_slip(n) = 0.0_wp
         column%compression = column%compression + more
         column%spring(column%at(flexure, :))%axial_load = column%compression
         column%axially_loaded = column%kinematics /= small .and. &
                                 (abs(load) > 0.0_wp .or. column%gravity > 0.0_wp)
      end associate
   end subroutine put_under

   !> One axial load for each target.
   subroutine check_axial_load(column, axial_load, targets, error)
      class(column_type), intent(in) :: column
      real(wp), intent(in) :: axial_load(:)
      integer, intent(in) :: targets
      type(error_type), allocatable, intent(out) :: error

      if (size(axial_load) /= targets) then
         call fatal_error(error, bad_input, 'axial_load: '//to_text(size(axial_load))//' values for '// &
                          to_text(targets)//' points of the path; give one for each')
         return
      end if
      call check_values(axial_load, 'axial_load', error)
      if (allocated(error) .or. column%kinematics /= small .or. column%opens .or. &
          any(column%spring%rule == 'layered')) return
      call fatal_error(error, bad_input, "axial_load: with kinematics = 'small', no layered joint and no "// &
                       "axial spring a history of it does nothing; use 'pdelta', or give such springs")
   end subroutine check_axial_load

end module rbs_solve_static_run_static
