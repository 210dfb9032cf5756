!> Static paths that begin in the state another analysis ended in, and the state that they end in themselves.
module rbs_solve_static_resume
   use rbs_base_constants, only: unbounded
   use rbs_base_error, only: error_type, fatal_error, analysis_failed
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_hysteresis_interaction_joints, only: vary_axial_loads
   use rbs_solve_end_state, only: end_state, checkpoint_type, static_state
   use rbs_solve_line_search, only: false_position
   use rbs_solve_static_path, only: static_path
   use rbs_structure_channel, only: energy_type
   implicit none
   private

   public :: begin_path, end_path, checkpoint_of, settle

   !> Joints have come to equilibrium if a correction is below this share of the deformations, measured by the
   !> initial stiffness; where round-off ends the progress before, below the second.
   real(wp), parameter :: settled = 1.0e-13_wp, nearly_settled = 1.0e-9_wp
   integer, parameter :: most_of_all = 2400, most_on_line = 12

contains

   !> Begin a path: from the structure without lateral force under its axial load, or from the state that
   !> another analysis ended in.
   subroutine begin_path(path, by_force, moving, varies, before, error)
      class(static_path), intent(inout) :: path
      !> Whether the force is driven, else the displacement
      logical, intent(in) :: by_force
      !> Number of springs that can move
      integer, intent(in) :: moving
      !> Whether the axial loads of layered joints vary
      logical, intent(in) :: varies
      !> The state to begin in; empty: none
      type(end_state), intent(inout) :: before
      type(error_type), allocatable, intent(out) :: error
      type(energy_type) :: energy

      call path%prepare(by_force, moving)
      if (before%is_given()) then
         call begin_from()
         return
      end if
      call path%compress(error)
      if (allocated(error)) return
      if (varies) call vary_axial_loads(path%springs)
      path%load_now = path%structure%axial_load
      energy = path%energies()
      path%at_begin = energy%spring + energy%axial

   contains

      !> Begin in the state that another analysis ended in. A static path of the same kind under the same
      !> axial load continues as if it had not been cut. Otherwise the top is held in place, velocities
      !> vanish, and the joints come to equilibrium.
      subroutine begin_from()
         type(checkpoint_type) :: checkpoint
         real(wp) :: axial_force(size(path%structure%location)), residual
         type(energy_type) :: energy
         logical :: goes_on

         call before%restore(path%structure, checkpoint, path%springs, error)
         if (allocated(error)) return
         if (varies) call vary_axial_loads(path%springs)
         axial_force = path%structure%constant_axial
         if (varies) axial_force = checkpoint%axial_force
         goes_on = checkpoint%kind == static_state .and. &
                   all(abs(axial_force - checkpoint%axial_force) <= 0.0_wp)
         call checkpoint%put_under(path%structure, axial_force, path%springs, error)
         if (allocated(error)) return
         path%load_now = merge(checkpoint%axial_load, path%structure%axial_load, varies)
         path%work = checkpoint%input
         path%damped_before = checkpoint%damping
         path%at_begin = checkpoint%at_begin
         if (goes_on) then
            path%displacement = checkpoint%displacement
            path%force = checkpoint%force
            ! The same kind of path takes up its memory; another one begins a line here.
            if (checkpoint%method == kind_of(path, varies)) then
               call path%serialize(before%stream)
               if (before%stream%broken) then
                  call fatal_error(error, analysis_failed, 'initial: the state ends too early; run the '// &
                                   'first analysis again')
                  return
               end if
            else
               call path%reset_reference()
            end if
         else
            path%displacement = path%structure%top_displacement(path%springs%d)
            path%force = checkpoint%force
            call path%compress(error)
            if (.not. allocated(error)) call settle_at_top(path, error)
            if (allocated(error)) return
            call path%reset_reference()
         end if
         if (path%direction == 0) path%control = merge(path%force, path%displacement, path%by_force)
         energy = path%energies()
         residual = checkpoint%residual - energy%residual
         if (abs(residual) > 0.0_wp) path%at_begin = path%at_begin + residual
      end subroutine begin_from

   end subroutine begin_path

   !> Kind of a path as a number: 10 more where the force is driven, 100 more where the axial load varies. A
   !> path can take up the memory of one of its own kind.
   pure integer function kind_of(path, varies)
      class(static_path), intent(in) :: path
      logical, intent(in) :: varies

      kind_of = 1 + merge(10, 0, path%by_force) + merge(100, 0, varies)
   end function kind_of

   !> The joints come to equilibrium while the displacement of the top is held.
   subroutine settle_at_top(path, error)
      class(static_path), intent(inout) :: path
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: correction(path%structure%coordinates), force_correction, line_lengths
      logical :: settled

      ! Where nothing but round-off has been displaced, the lengths of the lines are the scale.
      associate (lower => path%springs%lower, upper => path%springs%upper)
         line_lengths = sum(path%structure%initial_stiffness*(upper - lower)**2, &
                            mask=lower > -unbounded .and. upper < unbounded)
      end associate
      call path%springs%mark()
      call path%find_balance(.false., correction, force_correction, settled)
      if (settled) then
         call settle(path, .false., line_lengths, most_of_all, correction, force_correction, settled)
      end if
      if (.not. settled) then
         call fatal_error(error, analysis_failed, 'initial: no equilibrium was found at the displacement '// &
                          to_text(path%displacement)//' m in which the first analysis ended; let '// &
                          'the motion come to rest first, or change axial_load')
      end if
      call path%springs%forget_mark()
   end subroutine settle_at_top

   !> Come to equilibrium by Newton's method with a line search, from a first correction. Every trial starts
   !> from the mark, each spring in one direction, so that earlier trials leave no trace.
   subroutine settle(path, by_force, least, most, correction, force_correction, is_settled)
      class(static_path), intent(inout) :: path
      !> Whether the lateral force is held, else the displacement of the top
      logical, intent(in) :: by_force
      !> Least scale of a correction, as `measure_of` measures it [J]
      real(wp), intent(in) :: least
      !> Most trials
      integer, intent(in) :: most
      !> Of the deformations (coordinates), and of the force [N]
      real(wp), intent(inout) :: correction(:), force_correction
      !> Whether the joints have come to equilibrium; else the springs are at the last trial
      logical, intent(out) :: is_settled
      !> Position of the trial, and the correction found there (coordinates)
      real(wp), dimension(path%structure%coordinates) :: q, next_correction
      !> Correction of the force [N]; squares of the corrections before and now, product of a correction and
      !> the next one [J]; share of a correction to be tried, and that reached; largest square of the
      !> deformations
      real(wp) :: next_force, before, change, slope, share, now, largest
      type(false_position) :: line
      integer :: trials, on_line
      logical :: found

      q = path%springs%d
      is_settled = .false.
      ! Corrections are measured against the deformations themselves.
      largest = max(least, measure_of(q, q))
      change = measure_of(correction, correction)
      trials = 0
      do while (trials < most .and. change < huge(1.0_wp))
         before = change
         call try(1.0_wp)
         if (.not. found) exit
         slope = measure_of(correction, next_correction)
         ! The trial has gone too far: find the share of the correction at which the next one is across it.
         if (slope < -0.3_wp*before) then
            line = false_position(at_low=before, at_high=slope)
            now = 1.0_wp
            do on_line = 1, most_on_line
               share = line%next()
               call try(share - now)
               now = share
               if (.not. found) exit
               slope = measure_of(correction, next_correction)
               if (abs(slope) <= 0.1_wp*before) exit
               call line%narrow(share, slope)
            end do
            if (.not. found) exit
         end if
         change = measure_of(next_correction, next_correction)
         largest = max(largest, measure_of(q, q))
         is_settled = change <= settled**2*largest .or. &
                 (change <= nearly_settled**2*largest .and. change >= 0.25_wp*before)
         correction = next_correction
         force_correction = next_force
         if (.not. is_settled) cycle
         ! The last correction is made too.
         call try(1.0_wp)
         exit
      end do
      is_settled = is_settled .and. .not. path%springs%stuck

   contains

      !> Go on by a share of the correction, and find the next one there.
      subroutine try(part)
         !> Share of the correction
         real(wp), intent(in) :: part

         trials = trials + 1
         q = q + part*correction
         path%force = path%force + part*force_correction
         call path%springs%retry(q)
         found = .not. path%springs%stuck
         if (found) call path%find_balance(by_force, next_correction, next_force, found)
      end subroutine try

      !> Product of two changes of deformations, measured by the initial stiffness [J].
      pure real(wp) function measure_of(a, b)
         real(wp), intent(in) :: a(:), b(:)

         measure_of = sum(path%structure%initial_stiffness*a(:path%springs%count)*b(:path%springs%count))
      end function measure_of

   end subroutine settle

   !> Keep the state in which the path ends.
   subroutine end_path(path, varies, after)
      class(static_path), intent(inout) :: path
      !> Whether the axial load at the top varies
      logical, intent(in) :: varies
      type(end_state), intent(inout) :: after
      type(checkpoint_type) :: checkpoint

      checkpoint = checkpoint_of(path, varies)
      call after%start_saving(path%structure, checkpoint, path%springs)
      call path%serialize(after%stream)
      call after%finish_saving()
   end subroutine end_path

   !> Numbers of the state in which the path ends, besides its springs.
   type(checkpoint_type) function checkpoint_of(path, varies) result(checkpoint)
      class(static_path), intent(inout) :: path
      !> Whether the axial load at the top varies
      logical, intent(in) :: varies
      type(energy_type) :: energy

      checkpoint%kind = static_state
      checkpoint%axial_load_varies = path%springs%axial_load_varies
      checkpoint%displacement = path%displacement
      checkpoint%force = path%force
      checkpoint%axial_load = path%load_now
      checkpoint%axial_force = path%structure%constant_axial
      if (varies) then
         ! Present load at the top, the part of it that follows the lateral force, and the weight above
         checkpoint%axial_force = path%load_now + path%structure%axial_force_ratio*path%force &
                          + (path%structure%constant_axial - path%structure%axial_load)
         ! Layered joints know theirs to the last bit.
         if (path%springs%axial_load_varies) then
            checkpoint%axial_force(path%springs%layered) = &
               path%springs%reference_axial_load(path%springs%layered)
         end if
      end if
      allocate (checkpoint%v(path%structure%coordinates), source=0.0_wp)
      checkpoint%input = path%work
      checkpoint%damping = path%damped_before
      checkpoint%at_begin = path%at_begin
      energy = path%energies()
      checkpoint%residual = energy%residual
      ! The first load is the lateral force.
      checkpoint%load(1) = path%force
      checkpoint%method = kind_of(path, varies)
   end function checkpoint_of

end module rbs_solve_static_resume
