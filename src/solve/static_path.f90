!> What the static paths have in common, whatever the kinematics: the springs, what is driven, the way from
!> target to target, and the rows.
module rbs_solve_static_path
   use rbs_base_constants, only: unset, unset_integer
   use rbs_base_error, only: error_type, fatal_error, analysis_failed
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_column_column, only: column_type
   use rbs_hysteresis_segment, only: segment
   use rbs_hysteresis_springs, only: spring_array
   use rbs_results_progress, only: progress_type
   use rbs_results_recorder, only: recorder_type
   use rbs_results_row, only: row_size, row_time, row_displacement, row_force, row_input, row_kinetic, &
                              row_spring, row_damping, row_axial, row_residual, row_top, row_joints
   use rbs_results_summary, only: summary_type
   implicit none
   private

   public :: static_path, kept_rows, put_springs, describe_state, name_spring, on_the_end

   !> A spring this close to an end of its line, relative to the end, is on it. Not a tolerance of the
   !> solution: where a cycle returns to its peak, round-off would else decide between outer and inner
   !> unloading.
   real(wp), parameter :: on_the_end = 1.0e-11_wp

   !> A force that lacks less than this share is there.
   real(wp), parameter :: no_force = 1.0e-12_wp

   !> The state of a path and how it goes on.
   type, abstract :: static_path
      type(column_type) :: column
      type(spring_array) :: springs
      !> Number of springs that can move: with small rotations the openings keep still
      integer :: moving = 0
      !> Whether the force is driven, else the displacement
      logical :: by_force = .false.
      !> Displacement of the top [m], lateral force [N], work of the force [J]
      real(wp) :: displacement = 0.0_wp, force = 0.0_wp, work = 0.0_wp
      !> What is driven, and the way it goes on the line found last: +1, -1, 0 for no line
      real(wp) :: control = 0.0_wp
      integer :: direction = 0
      !> Change of the deformations per unit of what is driven, in its direction (unknowns)
      real(wp), allocatable :: rate(:)
      !> How often each spring has changed its line at the present corner (unknowns)
      integer, allocatable :: changed(:)
      !> Energy of springs and axial load at the begin [J], and the steps that were cut
      real(wp) :: at_begin = 0.0_wp
      integer :: cuts = 0
   contains
      procedure :: begin
      procedure :: follow
      procedure(advance_interface), deferred :: advance
      procedure(solve_line_interface), deferred :: solve_line
      procedure(energy_interface), deferred :: axial_work
      procedure(energy_interface), deferred :: height
   end type static_path

   abstract interface
      !> Go on to a target.
      subroutine advance_interface(self, target, error)
         import :: static_path, error_type, wp
         implicit none
         class(static_path), intent(inout) :: self
         !> Displacement [m] or force [N]
         real(wp), intent(in) :: target
         type(error_type), allocatable, intent(out) :: error
      end subroutine advance_interface

      !> Find the rates of the column on the present lines of its springs.
      subroutine solve_line_interface(self, direction, found)
         import :: static_path
         implicit none
         class(static_path), intent(inout) :: self
         integer, intent(in) :: direction
         logical, intent(out) :: found
      end subroutine solve_line_interface

      !> Potential of axial load and weight [J]; height of the top above the ground [m].
      pure real(wp) function energy_interface(self)
         import :: static_path, wp
         implicit none
         class(static_path), intent(in) :: self
      end function energy_interface
   end interface

contains

   !> Number of rows kept of m when every n-th and the last are.
   elemental integer function kept_rows(m, every)
      integer, intent(in) :: m, every

      kept_rows = 0
      if (every == unset_integer) then
         kept_rows = m
      else if (m > 0) then
         kept_rows = (m - 1)/every + 1 + merge(0, 1, mod(m - 1, every) == 0)
      end if
   end function kept_rows

   !> The straight column under its axial load.
   subroutine begin(self, column, by_force, moving, error)
      class(static_path), intent(inout) :: self
      type(column_type), intent(in) :: column
      logical, intent(in) :: by_force
      !> Number of springs that can move
      integer, intent(in) :: moving
      type(error_type), allocatable, intent(out) :: error

      self%column = column
      self%by_force = by_force
      self%moving = moving
      call self%springs%create(column%spring)
      allocate (self%rate(column%unknowns), source=0.0_wp)
      allocate (self%changed(column%unknowns), source=0)
      if (column%opens) call compress(self, error)
      self%at_begin = sum(self%springs%work) + self%axial_work()
   end subroutine begin

   !> The axial springs follow their lines to the forces of load and weight: N_i = -Q_i.
   subroutine compress(self, error)
      class(static_path), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: wanted, d
      integer :: i, j, way, lines

      do i = 1, self%column%n
         j = 2*self%column%n + i
         wanted = -self%column%axial_joint(i)
         associate (springs => self%springs)
            do lines = 1, 100
               if (abs(wanted - springs%force(j)) <= no_force*abs(wanted)) exit
               way = merge(1, -1, wanted > springs%force(j))
               if (.not. springs%k(j) > 0.0_wp) then
                  call report_no_hold(self, i, wanted, error)
                  return
               end if
               d = springs%d0(j) + (wanted - springs%f0(j))/springs%k(j)
               if (way*(d - springs%line(j)%end_toward(way)) < 0.0_wp) then
                  call springs%walk(j, d)
                  exit
               end if
               call springs%walk(j, springs%line(j)%end_toward(way))
               call springs%leave(j, way)
            end do
         end associate
      end do
   end subroutine compress

   subroutine report_no_hold(self, joint, wanted, error)
      class(static_path), intent(in) :: self
      integer, intent(in) :: joint
      real(wp), intent(in) :: wanted
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: kind

      kind = 'tension'
      if (wanted < 0.0_wp) kind = 'compression'
      call fatal_error(error, analysis_failed, 'the axial spring of joint '//to_text(joint)// &
                       " (rule '"//trim(self%column%spring(2*self%column%n + joint)%rule)// &
                       "') cannot carry the "//kind//' of '//to_text(abs(wanted))// &
                       ' N from axial load and weight: it has no stiffness left. Change axial_load, or '// &
                       'give the joint a spring that holds')
   end subroutine report_no_hold

   !> Follow the targets one after the other.
   subroutine follow(self, target, every, collapse_drift, recorder, summary, error, progress)
      class(static_path), intent(inout) :: self
      !> Targets (m): lateral forces [N], or displacements of the top [m]
      real(wp), intent(in) :: target(:)
      !> Every n-th point is kept, and the last; `unset_integer`: all
      integer, intent(in) :: every
      !> Displacement of the top over the height at which the path ends; `unset`: it does not
      real(wp), intent(in) :: collapse_drift
      class(recorder_type), intent(inout) :: recorder
      type(summary_type), intent(inout) :: summary
      !> On failure everything up to the last good state has been recorded
      type(error_type), allocatable, intent(out) :: error
      !> Told now and then how far the path is
      class(progress_type), intent(inout), optional :: progress
      type(error_type), allocatable :: failure
      real(wp), allocatable :: row(:)
      real(wp) :: farthest
      integer :: i, n

      n = every
      if (every == unset_integer) n = 1
      farthest = huge(1.0_wp)
      if (collapse_drift > unset) farthest = collapse_drift*self%column%joint_height(self%column%n + 1)
      allocate (row(row_size(self%column%unknowns)))
      do i = 1, size(target)
         call self%advance(target(i), failure)
         if (allocated(failure)) failure%message = 'row '//to_text(i)//': '//failure%message
         call summary%see_peak(self%displacement, self%force)
         summary%collapsed = abs(self%displacement) >= farthest
         if (mod(i - 1, n) == 0 .or. i == size(target) .or. allocated(failure) .or. &
             summary%collapsed) then
            call fill_row(self, row, i - 1, summary%peak_rotation)
            call summary%see(row)
            call recorder%record(row, error)
            if (allocated(error)) return
         end if
         summary%steps = i
         if (mod(i, 8192) == 0 .and. present(progress)) call progress%update(real(i, wp)/size(target))
         summary%events = self%springs%events
         summary%cut_steps = self%cuts
         if (allocated(failure)) then
            call move_alloc(failure, error)
            return
         end if
         if (summary%collapsed) return
      end do
   end subroutine follow

   !> Move the springs along their lines. Those that come to an open end are put on the next line, and the
   !> line of the column ends with theirs.
   subroutine put_springs(path, d, rate)
      class(static_path), intent(inout) :: path
      !> New deformations, and the way they go on, of which the sign counts (moving)
      real(wp), intent(in) :: d(:), rate(:)
      integer :: i

      associate (springs => path%springs)
         do i = 1, path%moving
            call springs%walk(i, min(max(d(i), springs%first(i)), springs%last(i)))
            if (is_on_end(springs%line(i), d(i), rate(i))) then
               call springs%arrive(i, merge(1, -1, rate(i) > 0.0_wp))
               path%direction = 0
            end if
         end do
      end associate
   end subroutine put_springs

   !> Whether a spring has come to the open end that it goes to.
   pure logical function is_on_end(line, d, rate)
      type(segment), intent(in) :: line
      real(wp), intent(in) :: d, rate

      is_on_end = .false.
      if (rate > 0.0_wp .and. .not. line%hi_closed) then
         is_on_end = line%hi - d <= on_the_end*abs(line%hi)
      else if (rate < 0.0_wp .and. .not. line%lo_closed) then
         is_on_end = d - line%lo <= on_the_end*abs(line%lo)
      end if
   end function is_on_end

   !> The present state as a row.
   subroutine fill_row(self, row, number, peak_rotation)
      class(static_path), intent(in) :: self
      real(wp), intent(out) :: row(:)
      integer, intent(in) :: number
      !> Largest absolute rotation so far, in size [rad]
      real(wp), intent(inout) :: peak_rotation
      real(wp) :: rotation
      integer :: i, m, n

      associate (springs => self%springs)
         n = self%column%n
         m = springs%count
         row(row_time) = number
         row(row_displacement) = self%displacement
         row(row_force) = self%force
         row(row_input) = self%work
         row(row_kinetic) = 0.0_wp
         row(row_spring) = sum(springs%work)
         row(row_damping) = 0.0_wp
         row(row_axial) = self%axial_work()
         row(row_residual) = row(row_input) + self%at_begin - row(row_spring) - row(row_axial)
         row(row_top) = self%height()
         row(row_joints:row_joints + m - 1) = springs%d
         row(row_joints + m:) = springs%f0 + springs%k*(springs%d - springs%d0)
         rotation = 0.0_wp
         do i = n + 1, 2*n
            rotation = rotation + springs%d(i)
            peak_rotation = max(peak_rotation, abs(rotation))
         end do
      end associate
   end subroutine fill_row

   !> Where the path is, for a message.
   subroutine describe_state(path, text)
      class(static_path), intent(in) :: path
      character(len=:), allocatable, intent(out) :: text

      text = 'force '//to_text(path%force)//' N, displacement '//to_text(path%displacement)//' m'
   end subroutine describe_state

   !> The spring that has least of its initial stiffness left, for a message.
   subroutine name_spring(path, text)
      class(static_path), intent(in) :: path
      character(len=:), allocatable, intent(out) :: text
      integer :: i, n

      n = path%column%n
      i = minloc(path%springs%k(:path%moving)/path%column%initial_stiffness(:path%moving), dim=1)
      if (i > 2*n) then
         text = 'the axial spring of joint '//to_text(i - 2*n)
      else if (i > n) then
         text = 'the flexural spring of joint '//to_text(i - n)
      else
         text = 'the shear spring of joint '//to_text(i)
      end if
   end subroutine name_spring

end module rbs_solve_static_path
