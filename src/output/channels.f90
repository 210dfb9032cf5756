!> Channels of a row of a run: names, units and places of its values. The first are those of every structure,
!> the others are stated by the structure. Solvers fill rows from a response; the csv, the summary and Python
!> find their values by the names of this list.
module rbs_output_channels
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_base_units, only: unit_system
   use rbs_hysteresis_springs, only: spring_array
   use rbs_structure_channel, only: channel_type, row_contents, response_type
   use rbs_structure_column_column, only: column_channel
   use rbs_structure_frame_frame, only: frame_channel, plan_channel
   use rbs_structure_structure, only: structure_type
   implicit none
   private

   public :: channel_list, new_channels, channel_units

   !> First channels of the rows of every structure; the first is the number of the row in a static analysis.
   type(channel_type), parameter :: first_channel(2) = [channel_type('step', ''), channel_type('time', 's')]
   type(channel_type), parameter :: common_channel(8) = [ &
      channel_type('displacement', 'm'), channel_type('force', 'N'), channel_type('input', 'J'), &
      channel_type('kinetic', 'J'), channel_type('spring', 'J'), channel_type('damping', 'J'), &
      channel_type('axial', 'J'), channel_type('residual', 'J')]
   integer, parameter :: common = 1 + size(common_channel)

   !> The channels of the rows of a run.
   type :: channel_list
      !> Number of values in a row
      integer :: width = 0
      type(row_contents) :: contents
      type(channel_type), allocatable, private :: channel(:)
   contains
      procedure :: fill, get_labels, names, before
   end type channel_list

contains

   !> The channels of a run.
   pure type(channel_list) function new_channels(structure, in_time, with_openings, with_motion) result(list)
      class(structure_type), intent(in) :: structure
      !> Whether the analysis is one in time; whether openings of layered joints, and how the top moves, are
      !> to be kept
      logical, intent(in) :: in_time, with_openings, with_motion
      type(channel_type), allocatable :: channel(:)

      list%contents = row_contents(in_time, with_openings, in_time .and. with_motion)
      call structure%channels(list%contents, channel)
      list%channel = [first_channel(merge(2, 1, in_time)), common_channel, channel]
      list%width = sum(max(list%channel%count, 1))
   end function new_channels

   !> Fill a row in the order of the channels.
   pure subroutine fill(self, structure, response, springs, deformation, row)
      class(channel_list), intent(in) :: self
      !> The structure, its response at the time, and its springs on their present lines
      class(structure_type), intent(in) :: structure
      type(response_type), intent(in) :: response
      type(spring_array), intent(in) :: springs
      !> Deformations of the springs [m, rad]
      real(wp), intent(in), contiguous :: deformation(:)
      !> (width)
      real(wp), intent(out), contiguous :: row(:)

      associate (r => response, e => response%energy)
         row(:common) = [r%time, r%displacement, r%force, e%input, e%kinetic, e%spring, e%damping, e%axial, &
                         e%residual]
      end associate
      call structure%fill_row(self%contents, response, springs, deformation, row(common + 1:))
   end subroutine fill

   !> Names of the values of a row with their units, as 'shear_2_kN', and the SI units.
   subroutine get_labels(self, units, label, si)
      class(channel_list), intent(in) :: self
      !> Units of the labels
      type(unit_system), intent(in) :: units
      !> (width)
      character(len=32), allocatable, intent(out) :: label(:)
      !> SI units of the values (width)
      character(len=4), allocatable, intent(out) :: si(:)
      integer :: i, j, at

      allocate (label(self%width), si(self%width))
      at = 0
      do i = 1, size(self%channel)
         associate (channel => self%channel(i))
            do j = 1, max(channel%count, 1)
               at = at + 1
               si(at) = channel%unit
               label(at) = channel%name
               if (channel%count > 0) label(at) = trim(label(at))//'_'//to_text(channel%first + j - 1)
               if (si(at) /= '') label(at) = trim(label(at))//'_'//without_blanks(units%name_of(si(at)))
            end do
         end associate
      end do
   end subroutine get_labels

   !> Number of the values of a row before those of a channel, which is 0 if there is no such channel in front
   !> of it.
   pure integer function before(self, name)
      class(channel_list), intent(in) :: self
      !> Name of a channel of this run
      character(len=*), intent(in) :: name

      before = sum(max(self%channel(:findloc(self%channel%name == name, .true., dim=1) - 1)%count, 1))
   end function before

   !> Names of the channels in their order, each with the number of its values, or 0 for one that has none.
   pure character(len=1024) function names(self) result(text)
      class(channel_list), intent(in) :: self
      integer :: i

      text = ''
      do i = 1, size(self%channel)
         text = trim(text)//' '//trim(self%channel(i)%name)//' '//to_text(self%channel(i)%count)
      end do
   end function names

   !> All names that rows may hold, with their units, with semicolons between.
   pure function channel_units() result(text)
      type(channel_type), parameter :: channel(2 + size(common_channel) + size(column_channel) &
                                               + size(frame_channel) + size(plan_channel)) = &
                                       [first_channel, common_channel, column_channel, frame_channel, &
                                        plan_channel]
      character(len=size(channel)*(len(channel%name) + len(channel%unit) + 2)) :: text
      integer :: i

      text = ''
      do i = 1, size(channel)
         text = trim(text)//trim(channel(i)%name)//' '//trim(channel(i)%unit)//';'
      end do
   end function channel_units

   !> A unit without its blanks, as it is written in a label: 'Nm' for 'N m'.
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
