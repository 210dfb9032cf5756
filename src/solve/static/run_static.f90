!> The entry of the static analyses.
module rbs_solve_static_run_static
   use rbs_base_error, only: error_type, fatal_error, bad_input
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_structure_column_column, only: column_type
   use rbs_base_check, only: check_values
   use rbs_solve_static_curved, only: trace_curved
   use rbs_solve_static_equilibrium, only: equilibrium_type
   use rbs_solve_static_straight, only: trace_straight
   use rbs_solve_task, only: task_type
   use rbs_structure_structure, only: structure_type, finite, signals, top_axial
   implicit none
   private

   public :: run_static

   !> Axial loads that differ by less than this share are one constant load.
   real(wp), parameter :: same_load = 1.0e-12_wp

contains

   !> Static path through displacements of the top or lateral forces: a curve where rotations are exact or the
   !> axial load at the top of a column varies, else a chain of straight lines.
   subroutine run_static(structure, method, by_force, target, task, error, axial_load)
      class(structure_type), intent(in), target :: structure
      !> 'newton' for a path in leaps, else from event to event
      character(len=*), intent(in) :: method
      !> Whether the targets are lateral forces [N], else displacements of the top [m]
      logical, intent(in) :: by_force
      !> Targets (m)
      real(wp), intent(in) :: target(:)
      type(task_type), intent(inout) :: task
      type(error_type), allocatable, intent(out) :: error
      !> Axial load at the top of a column at each target (m) [N]; empty or absent: its constant one
      real(wp), intent(in), optional :: axial_load(:)

      class(structure_type), allocatable, target :: other
      class(structure_type), pointer :: loaded
      type(equilibrium_type) :: equilibrium
      real(wp) :: load(size(target)), factor
      integer :: i
      logical :: varies, curves

      call check_values(target, trim(merge('force       ', 'displacement', by_force)), error)
      if (allocated(error)) return
      loaded => structure
      load = structure%axial_load
      varies = abs(structure%axial_force_ratio) > 0.0_wp
      if (present(axial_load)) then
         if (size(axial_load) > 0) then
            call check_axial_load()
            if (allocated(error)) return
            load = axial_load
            ! From the state of another analysis the load changes to its first value.
            varies = varies .or. task%resumes() .or. any(abs(load - load(1)) > same_load*maxval(abs(load)))
            allocate (other, source=structure)
            call other%put_under(load(1))
            loaded => other
         end if
      end if
      curves = varies .or. structure%kinematics == finite
      task%leaps = method == 'newton' .and. .not. (curves .or. structure%in_series)
      if (method == 'newton' .and. .not. task%leaps) then
         task%summary%reason = "newton is for frames, and columns with 'pdelta', under constant axial loads"
      end if
      if (curves) then
         ! Only columns have paths that are curves.
         select type (column => loaded)
         class is (column_type)
            call trace_curved(column, by_force, target, pack(load, varies), task, error)
         end select
      else
         ! The lateral load grows, not the dead load.
         call equilibrium%create(loaded, .false.)
         call trace_straight(loaded, equilibrium, by_force, target, task, error)
         if (allocated(error) .and. equilibrium%unstable > 0) then
            i = findloc(structure%location%member, equilibrium%unstable, dim=1)
            error%message = error%message//'. Member '//trim(structure%location(i)%owner)// &
                            ' snaps back: its springs soften faster than the rest of it gives back; '// &
                            'give it a softer rest, or springs that soften less'
         end if
      end if
      if (allocated(error) .and. by_force .and. .not. abs(task%summary%peak_displacement) > 0.0_wp) then
         ! A column that no force could move may have buckled before: its axial load times the factor is the
         ! critical one.
         factor = loaded%critical_factor()
         if (factor <= 1.0_wp .and. task%summary%steps > 0) then
            error%message = 'row '//to_text(task%summary%steps)//': the axial load is '// &
                            to_text(1.0_wp/factor)//' times the critical load of the uncracked '// &
                            'column, which buckles by itself; reduce axial_load, stiffen the springs, '// &
                            'or drive it by displacement'
         end if
      end if
      ! Without inertia the ground balances the driving force.
      task%summary%peak_base_shear = task%summary%peak_force
      task%summary%method = merge('newton', 'static', task%leaps)

   contains

      !> One axial load for each target, which does something.
      subroutine check_axial_load()
         logical :: acts(signals)

         acts = .false.
         acts(top_axial) = .true.
         call structure%check_loads(acts, error)
         if (allocated(error)) return
         if (size(axial_load) /= size(target)) then
            call fatal_error(error, bad_input, 'axial_load: '//to_text(size(axial_load))//' values for '// &
                             to_text(size(target))//' points of the path; give one for each')
            return
         end if
         call check_values(axial_load, 'axial_load', error)
      end subroutine check_axial_load

   end subroutine run_static

end module rbs_solve_static_run_static
