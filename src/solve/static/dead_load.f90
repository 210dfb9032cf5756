!> Frames under their dead load: the path from no load to all of it, event by event, on which the columns get
!> the axial forces whose second-order work is counted from then on.
module rbs_solve_static_dead_load
   use rbs_base_band_matrix, only: band_matrix
   use rbs_base_error, only: error_type, fatal_error, analysis_failed
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_hysteresis_springs, only: spring_array
   use rbs_output_recorder, only: array_recorder
   use rbs_solve_end_state, only: end_state, checkpoint_type
   use rbs_solve_static_equilibrium, only: equilibrium_type
   use rbs_solve_static_straight, only: trace_straight
   use rbs_solve_task, only: task_type
   use rbs_structure_condensation, only: series_tangent
   use rbs_structure_frame_frame, only: frame_type
   implicit none
   private

   public :: put_dead_load

   !> Axial forces have settled if they change by less than this share of the largest one; where round-off
   !> ends the progress before, by less than the second.
   real(wp), parameter :: same_force = 1.0e-14_wp, nearly_same = 1.0e-9_wp
   integer, parameter :: most_rounds = 100

   !> Halvings by which a critical load has its digits.
   integer, parameter :: most_halvings = 40

contains

   !> Put the dead load on a frame: its members get their axial forces, and every analysis begins in the state
   !> under the load.
   subroutine put_dead_load(frame, state, error)
      type(frame_type), intent(inout) :: frame
      !> The state under the load; empty where the frame has none
      type(end_state), intent(out) :: state
      type(error_type), allocatable, intent(out) :: error
      !> Compressions before a round; largest change of them in this round and in the last [N]
      real(wp) :: before(frame%members), change, last
      type(checkpoint_type) :: checkpoint
      type(spring_array) :: springs
      integer :: round

      if (.not. frame%is_loaded()) return
      ! Axial forces do second-order work, which changes the axial forces: the path is repeated until those
      ! that it counts with are those that it ends with.
      change = huge(1.0_wp)
      do round = 1, most_rounds
         before = frame%element(:frame%members)%compression
         call load_once(frame, checkpoint, springs, error)
         if (.not. allocated(error)) call check_members(frame, error)
         if (allocated(error)) call check_stability(frame, error)
         if (allocated(error) .or. .not. frame%axially_loaded) exit
         last = change
         change = maxval(abs(frame%element(:frame%members)%compression - before))
         ! Enough digits, or all that round-off leaves.
         if (change <= same_force*maxval(abs(before))) exit
         if (change <= nearly_same*maxval(abs(before)) .and. change > 0.5_wp*last) exit
      end do
      if (.not. allocated(error)) then
         checkpoint%axial_force = frame%constant_axial
         ! Work of the dead load is no part of an analysis, whose lateral force begins at zero.
         checkpoint%force = 0.0_wp
         checkpoint%load = 0.0_wp
         checkpoint%input = 0.0_wp
         checkpoint%residual = 0.0_wp
         checkpoint%method = 0
         call state%start_saving(frame, checkpoint, springs)
         call state%finish_saving()
      end if
      ! The path has one row, from no load to all of it: its number at the head of a message is left out.
      if (allocated(error)) error%message = 'dead load: '//error%message(len('row 1: ') + 1:)
   end subroutine put_dead_load

   !> The path under the dead load has failed. If the elastic frame buckles under the axial forces found so
   !> far, say so in place of that error: find by halving the share of the forces at which a pivot of the
   !> stiffness vanishes.
   subroutine check_stability(frame, error)
      type(frame_type), intent(in) :: frame
      type(error_type), allocatable, intent(inout) :: error
      type(frame_type) :: loaded
      type(band_matrix) :: matrix
      type(series_tangent), allocatable :: tangent(:)
      real(wp) :: low, high, share
      integer :: i, trial, unstable

      if (.not. frame%axially_loaded .or. .not. any(frame%element%compression > 0.0_wp)) return
      loaded = frame
      ! Parts that are built after the dead load do not carry it.
      call loaded%leave_out_later()
      call matrix%create(frame%unknowns, frame%half_width)
      tangent = frame%initial_tangent
      low = 0.0_wp
      high = 1.0_wp
      share = high
      do trial = 1, most_halvings
         do i = 1, frame%members
            call loaded%compress(i, share*frame%element(i)%compression)
         end do
         call loaded%set_second_order()
         tangent%is_known = .false.
         call loaded%linearise(loaded%initial_stiffness, tangent, unstable)
         matrix%band = 0.0_wp
         call loaded%add_stiffness(loaded%initial_stiffness, tangent, matrix%band)
         call loaded%add_geometric(loaded%element%compression, matrix%band)
         call matrix%factor()
         if (matrix%negative == 0 .and. unstable == 0) then
            ! It is stable under all of the forces: the error of the path stands.
            if (trial == 1) return
            low = share
         else
            high = share
         end if
         share = 0.5_wp*(low + high)
      end do
      call fatal_error(error, analysis_failed, 'row 1: the frame buckles under it: '//to_text(share)// &
                       ' of it is the critical load of the elastic frame. Give stiffer columns, braces '// &
                       'or less load')
   end subroutine check_stability

   !> Refuse members that buckle between their ends, even if these are held.
   subroutine check_members(frame, error)
      type(frame_type), intent(in) :: frame
      type(error_type), allocatable, intent(inout) :: error
      integer :: i

      if (.not. frame%axially_loaded) return
      do i = 1, frame%members
         ! With both ends held the critical force is 4 pi^2 E I/l^2.
         if (.not. frame%element(i)%buckles(frame%element(i)%compression)) cycle
         call fatal_error(error, analysis_failed, 'row 1: member '//trim(frame%member_name(i))// &
                          ' buckles between its ends: its compression of '// &
                          to_text(frame%element(i)%compression)//' N is more than '// &
                          '4 pi^2 E I/l^2; give it more stiffness, or less load')
         return
      end do
   end subroutine check_members

   !> Apply the dead load to the frame without load, along a straight path from nothing to all of it. The
   !> state at its end gives the compression of the members.
   subroutine load_once(frame, checkpoint, springs, error)
      type(frame_type), intent(inout), target :: frame
      type(checkpoint_type), intent(out) :: checkpoint
      type(spring_array), intent(out) :: springs
      type(error_type), allocatable, intent(out) :: error
      type(frame_type), target :: bare, unloaded
      type(equilibrium_type), target :: equilibrium
      type(array_recorder), target :: nothing
      type(task_type), target :: task

      ! Parts that are built later take no part; the load that grows belongs to `equilibrium`.
      bare = frame
      call bare%leave_out_later()
      call equilibrium%create(bare, .true.)
      unloaded = bare
      call unloaded%take_load_off()
      task%recorder => nothing
      call trace_straight(unloaded, equilibrium, .true., [1.0_wp], task, error, checkpoint, springs)
      if (.not. allocated(error) .and. task%summary%has_fallen()) then
         call fatal_error(error, analysis_failed, 'row 1: a joint of layers loses its axial load under '// &
                          'it; give it more strength, or less load')
      end if
      if (allocated(error)) return
      call frame%build_later(springs%d)
      call frame%set_compression(springs%d, springs%forces(springs%d))
   end subroutine load_once

end module rbs_solve_static_dead_load
