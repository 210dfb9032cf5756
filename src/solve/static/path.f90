!> What the static paths have in common, whatever the kinematics: the springs, what is driven, the way from
!> target to target, and the rows.
module rbs_solve_static_path
   use rbs_base_check, only: is_given
   use rbs_base_error, only: error_type, fatal_error, analysis_failed
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_base_text, only: to_text
   use rbs_structure_column_column, only: column_type, finite
   use rbs_hysteresis_interaction_joints, only: fall_of, vary_axial_loads
   use rbs_hysteresis_springs, only: spring_array
   use rbs_solve_static_row_check, only: row_check
   use rbs_solve_task, only: task_type
   use rbs_structure_channel, only: energy_type, response_type
   use rbs_structure_spring_place, only: spring_name, axial
   implicit none
   private

   public :: static_path, kept_rows, is_on_end, describe_state, missing_work, name_spring, &
             on_the_end, serialize_path

   !> A spring this close to an end of its line, relative to the end, is on it. Not a tolerance of the
   !> solution: where a cycle returns to its peak, round-off would otherwise decide between outer and inner
   !> unloading.
   real(wp), parameter :: on_the_end = 1.0e-11_wp

   !> What round-off alone moves the top, as a share of what all joints do.
   real(wp), parameter :: same_place = 2.0e-13_wp

   !> A force is reached if less than this share of it is missing.
   real(wp), parameter :: no_force = 1.0e-12_wp

   !> The state of a path and how it goes on.
   type, abstract :: static_path
      !> The column, and under its constant axial loads alone where others vary, as the potential needs it
      class(column_type), allocatable :: column, steady
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
      !> The same of the axial load at the top where it varies [N]
      real(wp) :: axial_rate = 0.0_wp
      !> Number of the straight line that the path is on, 0 for a curve, and where the line begins
      integer :: line = 0
      real(wp) :: start = 0.0_wp
      !> How often each spring has changed its line at the present corner (unknowns)
      integer, allocatable :: changed(:)
      !> Energy of springs and axial load at the start, work of the axial load as far as it varies [J], and
      !> the steps that were cut
      real(wp) :: at_begin = 0.0_wp, load_work = 0.0_wp
      integer :: cuts = 0
      !> Axial load at the top without what follows the force [N], and energy that was damped before [J]
      real(wp) :: load_now = 0.0_wp, damped_before = 0.0_wp
      !> What is driven where the way to the present target begins, and the number of the target, from 0
      real(wp) :: way_begin = 0.0_wp
      integer, private :: number = 0
      !> What is told of a corner between two targets: its summary, and its recorder if the row is to be kept
      type(task_type), pointer, private :: task => null()
   contains
      procedure :: prepare
      procedure :: begin
      procedure :: compress
      procedure :: follow
      procedure :: see_corner
      procedure(serialize_interface), deferred :: serialize
      procedure(advance_interface), deferred :: advance
      procedure(solve_line_interface), deferred :: solve_line
      procedure, private :: axial_work
      procedure(balance_interface), deferred :: find_balance
      procedure(unbalance_interface), deferred :: unbalance
      procedure(stand_interface), deferred :: stand_still
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

      !> What takes the springs, where they are and on their present lines, to equilibrium at the
      !> displacement of the top.
      subroutine balance_interface(self, correction, force, found)
         import :: static_path, wp
         implicit none
         class(static_path), intent(inout) :: self
         !> Of the deformations (unknowns), and of the lateral force [N]
         real(wp), intent(out) :: correction(:), force
         logical, intent(out) :: found
      end subroutine balance_interface

      !> The largest force by which a joint is out of equilibrium, moments over the height [N].
      real(wp) function unbalance_interface(self)
         import :: static_path, wp
         implicit none
         class(static_path), intent(inout) :: self
      end function unbalance_interface

      !> The springs stand where the path begins: take their place as the present point.
      subroutine stand_interface(self)
         import :: static_path
         implicit none
         class(static_path), intent(inout) :: self
      end subroutine stand_interface

      !> Save or restore all that the next target depends on, the springs excepted.
      subroutine serialize_interface(self, stream)
         import :: static_path, stream_type
         implicit none
         class(static_path), intent(inout) :: self
         type(stream_type), intent(inout) :: stream
      end subroutine serialize_interface
   end interface

contains

   !> Number of rows kept of m when every n-th and the last are.
   elemental integer function kept_rows(m, every)
      integer, intent(in) :: m, every

      kept_rows = 0
      if (.not. is_given(every)) then
         kept_rows = m
      else if (m > 0) then
         kept_rows = (m - 1)/every + 1 + merge(0, 1, mod(m - 1, every) == 0)
      end if
   end function kept_rows

   !> The column as it is given, its springs without load.
   subroutine prepare(self, column, by_force, moving)
      class(static_path), intent(inout) :: self
      class(column_type), intent(in) :: column
      logical, intent(in) :: by_force
      !> Number of springs that can move
      integer, intent(in) :: moving
      integer :: heard(column%unknowns)
      real(wp) :: axial_load(column%unknowns)

      self%column = column
      self%by_force = by_force
      self%moving = moving
      heard = column%place%heard
      axial_load = column%spring%axial_load
      call self%springs%create(column%rules, heard, axial_load)
      allocate (self%rate(column%unknowns), source=0.0_wp)
      allocate (self%changed(column%unknowns), source=0)
   end subroutine prepare

   !> The straight column under its axial load.
   subroutine begin(self, column, by_force, moving, varies, error)
      class(static_path), intent(inout) :: self
      class(column_type), intent(in) :: column
      logical, intent(in) :: by_force
      !> Number of springs that can move
      integer, intent(in) :: moving
      !> Whether the axial loads of layered joints vary
      logical, intent(in) :: varies
      type(error_type), allocatable, intent(out) :: error

      call self%prepare(column, by_force, moving)
      if (column%opens) call self%compress(error)
      if (allocated(error)) return
      if (varies) call vary_axial_loads(self%springs)
      self%load_now = column%axial_load
      self%at_begin = sum(self%springs%work) + self%axial_work()
   end subroutine begin

   !> Save or restore what every path remembers; solvers add what is their own.
   subroutine serialize_path(self, stream)
      class(static_path), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%item(self%displacement)
      call stream%item(self%force)
      call stream%item(self%work)
      call stream%item(self%control)
      call stream%item(self%direction)
      call stream%item(self%rate)
      call stream%item(self%load_now)
   end subroutine serialize_path

   !> The axial springs follow their lines to the forces of load and weight.
   subroutine compress(self, error)
      class(static_path), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: kind
      real(wp) :: tension
      logical :: found
      integer :: i, joint

      do joint = 1, self%column%n
         i = self%column%at(axial, joint)
         tension = -self%column%compression(joint)
         call self%springs%load_to(i, tension, found)
         if (found .or. abs(tension - self%springs%force(i)) <= no_force*abs(tension)) cycle
         kind = 'tension'
         if (tension < 0.0_wp) kind = 'compression'
         call fatal_error(error, analysis_failed, trim(spring_name(self%column%place(i)))//" (rule '"// &
                          trim(self%column%spring(i)%rule)//"') cannot carry the "//kind//' of '// &
                          to_text(abs(tension))//' N from axial load and weight: it has no stiffness '// &
                          'left. Change axial_load, or give the joint a spring that holds')
         return
      end do
   end subroutine compress

   !> Follow the targets one after the other.
   subroutine follow(self, target, task, error)
      class(static_path), intent(inout) :: self
      !> Targets (m): lateral forces [N], or displacements of the top [m]
      real(wp), intent(in) :: target(:)
      type(task_type), intent(inout), target :: task
      !> On failure everything up to the last good state has been recorded
      type(error_type), allocatable, intent(out) :: error
      type(error_type), allocatable :: failure
      type(row_check) :: check
      type(response_type) :: response
      real(wp) :: way
      logical :: may_collapse
      integer :: i, n, lost, line

      n = task%every
      if (.not. is_given(n)) n = 1
      may_collapse = is_given(task%collapse_drift)
      self%task => task
      call check%begin(self%column, missing_work(self))
      ! A path that goes on has forces and works from before, and the round-off of theirs.
      call check_row(self, check, self%control, failure)
      if (allocated(failure)) deallocate (failure)
      line = -1
      way = 0.0_wp
      do i = 1, size(target)
         self%number = i - 1
         self%way_begin = self%control
         ! A path whose first target is not where it begins has a way to it.
         if (i == 1 .and. abs(target(1) - self%control) > 0.0_wp) call self%see_corner(0.0_wp)
         call self%advance(target(i), failure)
         if (.not. allocated(failure) .and. self%springs%lost_joint() == 0) then
            call stand_on_ends(self)
            ! On a straight line what is wrong grows with the way.
            if (self%line == 0 .or. self%line /= line .or. abs(self%control - self%start) > 2.0_wp*way .or. &
                i == size(target)) then
               call check_row(self, check, target(i), failure)
               line = self%line
               way = abs(self%control - self%start)
            end if
            if (allocated(failure)) then
               ! What is no state of the column is no row.
               failure%message = 'row '//to_text(i)//': '//failure%message
               call move_alloc(failure, error)
               return
            end if
         end if
         lost = self%springs%lost_joint()
         if (lost > 0) then
            task%summary%lost_joint = self%column%place(lost)%index
            call fall_of(self%springs, lost, task%summary%fall)
         end if
         ! Where a joint has lost its axial load, that is what ends the path.
         if (task%summary%lost_joint > 0 .and. allocated(failure)) deallocate (failure)
         if (allocated(failure)) failure%message = 'row '//to_text(i)//': '//failure%message
         call see_peaks(self)
         if (may_collapse) then
            task%summary%collapsed = abs(self%displacement)/self%column%height >= task%collapse_drift
         end if
         call find_energies(self, response%energy)
         call task%summary%see_energies(response%energy)
         if (mod(i - 1, n) == 0 .or. i == size(target) .or. allocated(failure) .or. &
             task%summary%collapsed .or. task%summary%lost_joint > 0) then
            task%summary%rows = task%summary%rows + 1
            call find_response(self, real(i - 1, wp), response)
            task%summary%last_time = response%time
            call task%recorder%keep(self%column, response, self%springs, self%springs%d, error)
            if (allocated(error)) return
         end if
         task%summary%steps = i
         if (mod(i, 8192) == 0 .and. associated(task%progress)) call task%progress%update(real(i, &
              wp)/size(target))
         task%summary%events = self%springs%events
         task%summary%cut_steps = self%cuts
         if (allocated(failure)) then
            call move_alloc(failure, error)
            return
         end if
         if (task%summary%collapsed .or. task%summary%lost_joint > 0) return
      end do
   end subroutine follow

   !> The path is at a corner, a share of the way to the present target: its figures belong to the summary,
   !> and its row to those who keep every corner.
   subroutine see_corner(self, share)
      class(static_path), intent(inout) :: self
      real(wp), intent(in) :: share
      type(error_type), allocatable :: error
      type(response_type) :: response

      call see_peaks(self)
      if (.not. self%task%recorder%corners) return
      call find_energies(self, response%energy)
      call find_response(self, self%number - 1 + share, response)
      call self%task%recorder%keep(self%column, response, self%springs, self%springs%d, error)
   end subroutine see_corner

   !> Tell the summary of the present force, displacement and rotations.
   subroutine see_peaks(self)
      class(static_path), intent(inout) :: self

      ! A force that pulls the column back, as where second-order moments drive it on, is no strength.
      call self%task%summary%see_peak(self%displacement, merge(self%force, 0.0_wp, &
                                                          self%force*self%displacement >= 0.0_wp))
      call self%task%summary%see_turn(self%column%largest_turn(self%springs%d))
   end subroutine see_peaks

   !> Whether a spring has come to the open end that it goes to.
   pure logical function is_on_end(springs, i, d, rate)
      type(spring_array), intent(in) :: springs
      integer, intent(in) :: i
      !> Deformation [m or rad], and its rate, of which only the sign counts
      real(wp), intent(in) :: d, rate
      real(wp) :: finish

      is_on_end = .false.
      ! Most springs are far from their ends, which need not be computed then.
      if (rate > 0.0_wp .and. .not. springs%includes_upper_end(i)) then
         if (springs%last(i) - d > 2.0_wp*on_the_end*abs(springs%last(i))) return
         finish = springs%end_toward(i, 1)
         is_on_end = finish - d <= on_the_end*abs(finish)
      else if (rate < 0.0_wp .and. .not. springs%includes_lower_end(i)) then
         if (d - springs%first(i) > 2.0_wp*on_the_end*abs(springs%first(i))) return
         finish = springs%end_toward(i, -1)
         is_on_end = d - finish <= on_the_end*abs(finish)
      end if
   end function is_on_end

   !> A spring that was put on the end of its line has moved the top by as little: that is where the top is.
   subroutine stand_on_ends(self)
      class(static_path), intent(inout) :: self
      real(wp) :: there, reach

      if (self%by_force .or. self%direction /= 0 .or. self%column%kinematics == finite) return
      there = self%column%top_displacement(self%springs%d)
      reach = sum(abs(self%column%arm*self%springs%d))
      if (abs(there - self%displacement) <= same_place*reach .or. &
          abs(there - self%displacement) > 2.0_wp*on_the_end*reach) return
      self%work = self%work + self%force*(there - self%displacement)
      self%displacement = there
      self%control = there
   end subroutine stand_on_ends

   !> Whether the present row is a state of the column.
   subroutine check_row(self, check, target, failure)
      class(static_path), intent(inout) :: self
      type(row_check), intent(inout) :: check
      real(wp), intent(in) :: target
      type(error_type), allocatable, intent(inout) :: failure
      character(len=:), allocatable :: fault, spring

      call check%look(self%column, self%springs, self%displacement, self%force, self%unbalance(), &
                      [self%work, sum(self%springs%work), self%axial_work()], missing_work(self), fault)
      if (.not. allocated(fault)) return
      call name_spring(self, spring)
      call fatal_error(failure, analysis_failed, 'on the way to '//to_text(target)//' '// &
                       merge('N', 'm', self%by_force)//' the arithmetic has lost the static path: at a '// &
                       'displacement of '//to_text(self%displacement)//' m '//fault//'. The path up to '// &
                       'there is kept. The stiffnesses of the springs are too far apart ('//spring// &
                       ' has the least left): give it more stiffness after yield, or take stiff springs '// &
                       'less stiff')
   end subroutine check_row

   !> Work that the balance of energy misses [J].
   pure real(wp) function missing_work(self)
      class(static_path), intent(in) :: self

      missing_work = self%work + self%at_begin - sum(self%springs%work) - self%damped_before &
                     - self%axial_work()
   end function missing_work

   !> Potential of the constant axial loads, and the work of those that vary [J].
   pure real(wp) function axial_work(self)
      class(static_path), intent(in) :: self

      axial_work = self%steady%potential_energy(self%springs%d) + self%load_work
   end function axial_work

   !> The energies at the present point.
   subroutine find_energies(self, energy)
      class(static_path), intent(in) :: self
      type(energy_type), intent(out) :: energy

      energy%input = self%work
      energy%spring = sum(self%springs%work)
      energy%damping = self%damped_before
      energy%axial = self%axial_work()
      energy%residual = self%work + self%at_begin - energy%spring - self%damped_before - energy%axial
   end subroutine find_energies

   !> The response at the present point, whose energies are known.
   subroutine find_response(self, number, response)
      class(static_path), intent(in) :: self
      !> Of the row, between two targets with the share of the way
      real(wp), intent(in) :: number
      type(response_type), intent(inout) :: response

      response%time = number
      response%displacement = self%displacement
      response%force = self%force
   end subroutine find_response

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

      text = trim(spring_name(path%column%place(minloc(path%springs%k(:path%moving)/ &
                                                        path%column%initial_stiffness(:path%moving), dim=1))))
   end subroutine name_spring

end module rbs_solve_static_path
