!> Recorders of kept rows: an array (Python) or a file (executable). The solver does not know which.
module rbs_output_recorder
   use rbs_base_error, only: error_type, fatal_error, analysis_failed
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_hysteresis_springs, only: spring_array
   use rbs_output_channels, only: channel_list
   use rbs_output_spans, only: span_watch
   use rbs_structure_channel, only: response_type
   use rbs_structure_structure, only: structure_type
   implicit none
   private

   public :: recorder_type, array_recorder, observer_type

   !> An observer of a long run; it is called now and then with the share that has been completed.
   type, abstract :: observer_type
   contains
      procedure(update_interface), deferred :: update
   end type observer_type

   !> What keeps the rows of a run, as an array or in a file.
   type, abstract :: recorder_type
      !> Channels of a row; where this is not set no rows are kept
      type(channel_list) :: channels
      !> Whether a static path has rows at its corners too, where a spring leaves its line between two targets
      logical :: corners = .false.
      !> Watches the rows of a frame
      type(span_watch) :: spans
      !> The present row
      real(wp), allocatable, private :: row(:)
   contains
      procedure :: keep
      procedure(record_interface), deferred :: record
   end type recorder_type

   abstract interface
      subroutine update_interface(self, share)
         import :: observer_type, wp
         class(observer_type), intent(inout) :: self
         !> Share of the run that has been completed, 0 to 1
         real(wp), intent(in) :: share
      end subroutine update_interface

      !> Take one row, in the order of the channels.
      subroutine record_interface(self, row, error)
         import :: recorder_type, error_type, wp
         class(recorder_type), intent(inout) :: self
         !> (width of the channels)
         real(wp), intent(in) :: row(:)
         type(error_type), allocatable, intent(inout) :: error
      end subroutine record_interface
   end interface

   !> Keeps rows in an array.
   type, extends(recorder_type) :: array_recorder
      !> Rows kept so far, and how many there will be as far as known
      integer :: count = 0, expected = 0
      !> Rows that there is room for
      integer, private :: capacity = 0
      !> A column of the array is a row (values of a row, capacity)
      real(wp), allocatable :: rows(:, :)
   contains
      procedure :: record
   end type array_recorder

contains

   !> Make a row of a response and keep it.
   subroutine keep(self, structure, response, springs, deformation, error)
      class(recorder_type), intent(inout) :: self
      !> The structure, its response at the time, and its springs on their present lines
      class(structure_type), intent(in) :: structure
      type(response_type), intent(in) :: response
      type(spring_array), intent(in) :: springs
      !> Deformations of the springs [m, rad]
      real(wp), intent(in), contiguous :: deformation(:)
      type(error_type), allocatable, intent(inout) :: error

      if (self%channels%width == 0) return
      if (.not. allocated(self%row)) allocate (self%row(0))
      ! The first row of a run, which may have other channels than the last run
      if (size(self%row) /= self%channels%width) then
         self%row = spread(0.0_wp, 1, self%channels%width)
         call self%spans%start(structure, self%channels%before('moment_from'), &
                               self%channels%before('moment_to'), self%channels%before('moment'))
      end if
      call self%channels%fill(structure, response, springs, deformation, self%row)
      if (self%spans%watches) call self%spans%update(self%row)
      call self%record(self%row, error)
   end subroutine keep

   !> Keep a row behind the others.
   subroutine record(self, row, error)
      class(array_recorder), intent(inout) :: self
      !> (width of the channels)
      real(wp), intent(in) :: row(:)
      type(error_type), allocatable, intent(inout) :: error
      real(wp), allocatable :: larger(:, :)
      integer :: most, status

      if (allocated(error)) return
      if (self%count == self%capacity) then
         ! Room for all rows that are expected, then for twice as many: how many corners a path has is not
         ! known before.
         most = max(1, self%expected, 2*self%count)
         allocate (larger(size(row), most), stat=status)
         if (status /= 0) then
            call fatal_error(error, analysis_failed, 'memory runs out: '//to_text(most)//' rows of '// &
                             to_text(size(row))//' numbers; keep fewer of them with every')
            return
         end if
         self%capacity = most
         if (self%count > 0) larger(:, :self%count) = self%rows
         call move_alloc(larger, self%rows)
      end if
      self%count = self%count + 1
      self%rows(:, self%count) = row
   end subroutine record

end module rbs_output_recorder
