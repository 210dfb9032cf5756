!> What a row of a run holds: names, units and places of its values, stated once. Solvers fill rows from a
!> response; the csv, the summary and Python find what they need by the names of this list.
module rbs_output_channels
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_base_units, only: unit_system
   use rbs_structure_column_column, only: column_type
   use rbs_hysteresis_interaction_joints, only: fill_openings
   use rbs_hysteresis_springs, only: spring_array
   implicit none
   private

   public :: channel_list, new_channels, channel_units, energy_type, response_type

   !> Which rows hold a channel: all; those of a static path, or of a response in time; those of a column with
   !> axial springs; those in time of a damped column; on demand how the top moves, and layered joints.
   integer, parameter :: always = 1, static_path = 2, in_time = 3, axial_springs = 4, damping = 5, &
                         motion = 6, layers = 7

   !> A quantity of a row.
   type :: channel_type
      character(len=19) :: name
      !> SI
      character(len=4) :: unit
      integer :: held = always
      !> Whether it has a value for each joint, from the ground up
      logical :: of_joints = .false.
   end type channel_type

   !> All of them, in the order of a row. In a static analysis the first is the number of the row. Energies:
   !> work of lateral force and ground motion; motion; springs; damping; potential of the axial forces; what
   !> is left of the balance. Without `base_shear` and `base_moment` the base has the forces of the lowest
   !> joint. The motion is that of the top relative to the ground. Openings of layered joints are those at the
   !> middle of their sections; `rest` is the rotation at which they rest under their first axial load.
   type(channel_type), parameter :: channel(24) = [ &
      channel_type('step', '', static_path), channel_type('time', 's', in_time), &
      channel_type('displacement', 'm'), channel_type('force', 'N'), channel_type('input', 'J'), &
      channel_type('kinetic', 'J'), channel_type('spring', 'J'), channel_type('damping', 'J'), &
      channel_type('axial', 'J'), channel_type('residual', 'J'), channel_type('top_height', 'm'), &
      channel_type('slip', 'm', always, .true.), channel_type('rotation', 'rad', always, .true.), &
      channel_type('opening', 'm', axial_springs, .true.), channel_type('shear', 'N', always, .true.), &
      channel_type('moment', 'N m', always, .true.), &
      channel_type('axial_force', 'N', axial_springs, .true.), channel_type('base_shear', 'N', damping), &
      channel_type('base_moment', 'N m', damping), channel_type('velocity', 'm/s', motion), &
      channel_type('acceleration', 'm/s2', motion), channel_type('ground_acceleration', 'm/s2', motion), &
      channel_type('opening', 'm', layers, .true.), channel_type('rest', 'rad', layers, .true.)]

   !> Number of values before those of the joints, of which one is the first or the second channel; and
   !> channels that some rows begin with after the joints.
   integer, parameter :: head = findloc(channel%name, 'slip', dim=1) - 2, &
                         base = findloc(channel%held, damping, dim=1), &
                         top_motion = findloc(channel%held, motion, dim=1), &
                         openings = findloc(channel%held, layers, dim=1)

   !> The channels of the rows of a run.
   type :: channel_list
      !> Number of joints, and of values in a row
      integer :: joints = 0, width = 0
      !> Whether the rows hold how the top moves
      logical :: motion = .false.
      !> Number by which the lowest joint is known
      integer, private :: lowest = 1
      !> Where each channel begins in a row; 0: it is not in it
      integer, private :: first(size(channel)) = 0
   contains
      procedure :: fill
      procedure :: get_labels
      procedure :: names
   end type channel_list

   !> Energies of a moment [J], see `channel`.
   type :: energy_type
      real(wp) :: input = 0.0_wp, kinetic = 0.0_wp, spring = 0.0_wp, damping = 0.0_wp, axial = 0.0_wp, &
                  residual = 0.0_wp
   end type energy_type

   !> The response of a column at a time, or at a point of a path, without its springs.
   type :: response_type
      !> Time [s] or number of the point; displacement and height of the top [m]; lateral force [N]
      real(wp) :: time = 0.0_wp, displacement = 0.0_wp, height = 0.0_wp, force = 0.0_wp
      type(energy_type) :: energy
      !> Shear and moment at the base [N, N m]; velocity and acceleration of the top, acceleration of the
      !> ground
      real(wp) :: base(2) = 0.0_wp, motion(3) = 0.0_wp
   end type response_type

contains

   !> The channels of a run.
   pure function new_channels(column, dynamic, with_layers, with_motion) result(list)
      type(column_type), intent(in) :: column
      !> Whether the analysis is one in time
      logical, intent(in) :: dynamic
      !> Whether openings of layered joints, and how the top moves, are to be kept
      logical, intent(in) :: with_layers, with_motion
      type(channel_list) :: list
      logical :: held(layers)
      integer :: i

      held([always, static_path, in_time]) = [.true., .not. dynamic, dynamic]
      held(axial_springs) = column%opens
      held(damping) = dynamic .and. column%damped
      held(motion) = dynamic .and. with_motion
      held(layers) = with_layers .and. .not. column%opens
      list%joints = column%n
      list%lowest = merge(0, 1, column%footing)
      list%motion = held(motion)
      do i = 1, size(channel)
         if (.not. held(channel(i)%held)) cycle
         list%first(i) = list%width + 1
         list%width = list%width + merge(column%n, 1, channel(i)%of_joints)
      end do
   end function new_channels

   !> Fill a row in the order of the channels, which is that of the springs too.
   pure subroutine fill(self, response, springs, deformation, row)
      class(channel_list), intent(in) :: self
      type(response_type), intent(in) :: response
      type(spring_array), intent(in) :: springs
      !> Deformations of the springs [m, rad]
      real(wp), intent(in), contiguous :: deformation(:)
      !> (width)
      real(wp), intent(out), contiguous :: row(:)
      integer :: m

      m = size(deformation)
      associate (r => response, e => response%energy, first => self%first)
         row(:head) = [r%time, r%displacement, r%force, e%input, e%kinetic, e%spring, e%damping, e%axial, &
                       e%residual, r%height]
         row(head + 1:head + m) = deformation
         row(head + m + 1:head + 2*m) = springs%f0 + springs%k*(deformation - springs%d0)
         if (first(base) > 0) row(first(base):first(base) + 1) = r%base
         if (first(top_motion) > 0) row(first(top_motion):first(top_motion) + 2) = r%motion
         if (first(openings) > 0) call fill_openings(springs, self%joints, row(first(openings):))
      end associate
   end subroutine fill

   !> Names of the values of a row with their units, and the SI units.
   subroutine get_labels(self, units, label, si)
      class(channel_list), intent(in) :: self
      !> Units of the labels
      type(unit_system), intent(in) :: units
      !> (width)
      character(len=32), allocatable, intent(out) :: label(:)
      character(len=4), allocatable, intent(out) :: si(:)
      integer :: i, j, at

      allocate (label(self%width), si(self%width))
      do i = 1, size(channel)
         if (self%first(i) == 0) cycle
         do j = 1, merge(self%joints, 1, channel(i)%of_joints)
            at = self%first(i) + j - 1
            si(at) = channel(i)%unit
            label(at) = channel(i)%name
            if (channel(i)%of_joints) label(at) = trim(label(at))//'_'//to_text(self%lowest + j - 1)
            if (si(at) /= '') label(at) = trim(label(at))//'_'//without_blanks(units%name_of(si(at)))
         end do
      end do
   end subroutine get_labels

   !> Names of the channels in their order, each with the number of its joints, or 0 for a single value.
   pure function names(self) result(text)
      class(channel_list), intent(in) :: self
      character(len=512) :: text
      integer :: i

      text = ''
      do i = 1, size(channel)
         if (self%first(i) == 0) cycle
         text = trim(text)//' '//trim(channel(i)%name)//' '// &
                to_text(merge(self%joints, 0, channel(i)%of_joints))
      end do
   end function names

   !> All names with their units, with semicolons between.
   pure function channel_units() result(text)
      character(len=size(channel)*(len(channel%name) + len(channel%unit) + 2)) :: text
      integer :: i

      text = ''
      do i = 1, size(channel)
         text = trim(text)//trim(channel(i)%name)//' '//trim(channel(i)%unit)//';'
      end do
   end function channel_units

   !> A unit as it stands in a label: 'Nm'.
   pure function without_blanks(unit) result(text)
      character(len=*), intent(in) :: unit
      character(len=len(unit)) :: text
      integer :: i

      text = ''
      do i = 1, len_trim(unit)
         if (unit(i:i) /= ' ') text = trim(text)//unit(i:i)
      end do
   end function without_blanks

end module rbs_output_channels
