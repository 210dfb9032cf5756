!> The structure that the user has described, a column or a frame, and the state that its analyses begin in.
module rbs_solve_begin_make_structure
   use rbs_base_band_matrix, only: band_matrix
   use rbs_base_error, only: error_type, message_list, fatal_error, bad_input
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_case_case_record, only: case_record
   use rbs_hysteresis_layered_layered_joint, only: check_axial_load
   use rbs_solve_end_state, only: end_state, stamp_of
   use rbs_solve_modal_matrices, only: find_modal_momenta
   use rbs_solve_modal_modes, only: modes_type, find_modes
   use rbs_solve_static_dead_load, only: put_dead_load
   use rbs_structure_column_column, only: column_type
   use rbs_structure_column_column_record, only: column_record
   use rbs_structure_column_new_column, only: new_column
   use rbs_structure_condensation, only: series_tangent
   use rbs_structure_frame_frame, only: frame_type
   use rbs_structure_frame_new_frame, only: new_frame
   use rbs_structure_spring_location, only: flexure
   use rbs_structure_structure, only: structure_type, small, pdelta, lateral, horizontal, sideways
   implicit none
   private

   public :: make_structure

   !> Lowest modes among which that of the lateral load is sought: the one that moves most mass along x.
   integer, parameter :: modes_along = 10

   !> Ratio of the stiffness of an unknown to that with others free, beyond which too few digits stay;
   !> share of the softest member that others are taken down to where a mechanism is distinguished from
   !> round-off.
   real(wp), parameter :: most_lost = 1.0e10_wp, like_stiffness = 1.0e3_wp

contains

   !> Validate the structure of a case and make it.
   subroutine make_structure(case, structure, before, error)
      type(case_record), intent(inout) :: case
      class(structure_type), allocatable, intent(out) :: structure
      !> A frame begins under its dead load; empty: without any
      type(end_state), intent(out) :: before
      type(error_type), allocatable, intent(out) :: error
      class(column_type), allocatable :: column
      type(frame_type), allocatable :: frame

      if (case%is_drawn()) then
         call fatal_error(error, bad_input, trim(case%drawn_at//' ')//' the case is drawn by sections, '// &
                          'or has loads that are made of others, and this executable solves springs: '// &
                          'type rbsdem run CASE.nml with the Python package installed, or make its '// &
                          'springs there: rbsdem draw CASE.nml > springs.nml')
         return
      end if
      if (allocated(case%frame)) then
         allocate (frame)
         call make_frame(case, frame, before, error)
         if (.not. allocated(error)) call move_alloc(frame, structure)
      else
         call make_column(case%column, column, error)
         if (.not. allocated(error)) call move_alloc(column, structure)
      end if
   end subroutine make_structure

   !> Validate a column and make it.
   subroutine make_column(spec, column, error)
      type(column_record), intent(inout) :: spec
      class(column_type), allocatable, intent(out) :: column
      type(error_type), allocatable, intent(out) :: error
      type(message_list) :: messages
      character(len=:), allocatable :: text
      integer :: i

      call spec%validate(messages)
      call messages%raise(error)
      if (allocated(error)) return
      call new_column(column, spec)
      do i = 1, column%n
         associate (at => column%at(flexure, i))
            if (column%rules%name(column%rules%of(at)) /= 'layered') cycle
            call check_axial_load(column%rules%list(column%rules%of(at))%rule, column%constant_axial(at), &
                                  text)
         end associate
         if (text == '') cycle
         call fatal_error(error, bad_input, 'flexure spring of joint '//to_text(spec%joint_number(i))// &
                          ': '//text)
         return
      end do
   end subroutine make_column

   !> Make the frame of a case, put its dead load on it, and find what needs its modes: modal damping and the
   !> pattern of the lateral load.
   subroutine make_frame(case, frame, before, error)
      type(case_record), intent(inout) :: case
      type(frame_type), intent(inout) :: frame
      !> State under the dead load, in which every analysis begins; empty: there is none
      type(end_state), intent(out) :: before
      type(error_type), allocatable, intent(out) :: error
      type(message_list) :: messages
      type(modes_type) :: modes
      real(wp), allocatable :: momenta(:, :)
      integer :: i, j

      if (.not. allocated(case%parts)) then
         allocate (case%parts)
         call case%parts%find(case%frame, messages)
      end if
      call case%column%damping%check('damping', messages)
      call messages%raise(error)
      if (allocated(error)) return
      call new_frame(frame, case%parts%node, case%parts%member, merge(pdelta, small, &
                     case%frame%kinematics == 'pdelta'), case%parts%plan, case%parts%top, &
                     case%frame%control == 'y')
      frame%by_storeys = frame%storeys > 0 .and. case%frame%collapse == 'storey'
      associate (damping => case%column%damping)
         frame%mass_damping = damping%mass
         frame%stiffness_damping = damping%stiffness
         frame%tangent_damping = damping%tangent
         frame%damped = damping%mass > 0.0_wp .or. damping%stiffness > 0.0_wp
      end associate
      if (case%frame%is_part) return
      call check_stable(frame, error)
      if (allocated(error)) return
      frame%stamp = stamp_of(frame)
      call put_dead_load(frame, before, error)
      if (allocated(error)) return
      call frame%set_damping()
      if (allocated(case%column%damping%modal)) then
         frame%damped = .true.
         frame%modal_damping = case%column%damping%modal
         call find_modal_momenta(frame, momenta, error)
         if (allocated(error)) return
         frame%massed = pack([(j, j=1, frame%unknowns)], any(abs(momenta) > 0.0_wp, dim=2))
         frame%modal_momenta = momenta(frame%massed, :)
         if (2*size(momenta, 2) > size(frame%massed)) then
            frame%modal_matrix = matmul(frame%modal_momenta, transpose(frame%modal_momenta))
         end if
      end if
      if (allocated(error) .or. case%frame%pattern /= 'modal') return
      call find_modes(frame, modes, error, modes_along)
      if (allocated(error)) return
      associate (push => frame%pattern(lateral)%force)
         ! Heavy beams may swing upward before the frame sways.
         associate (toward => frame%plan%direction)
            i = maxloc([(abs(toward(1)*frame%work_of(horizontal, modes%shapes(:, j)) + &
                             toward(2)*frame%work_of(sideways, modes%shapes(:, j))), &
                         j=1, size(modes%omega))], dim=1)
            if (frame%plan%is_given()) then
               ! With its torque
               push = frame%plan%on_floors(frame%inertias*modes%shapes(:, i))
               push = -push/(toward(1)*frame%work_of(horizontal, modes%shapes(:, i)) + &
                             toward(2)*frame%work_of(sideways, modes%shapes(:, i)))
               return
            end if
         end associate
         push = -frame%pattern(horizontal)%force*modes%shapes(:, i)
         push = push/sum(push)
      end associate
   end subroutine make_frame

   !> Refuse a frame that can move without force, one whose member has springs that leave its inside
   !> undetermined, and one whose members are so unlike that round-off decides how it moves.
   subroutine check_stable(frame, error)
      type(frame_type), intent(in) :: frame
      type(error_type), allocatable, intent(out) :: error
      type(band_matrix) :: matrix
      character(len=12), parameter :: motion(4) = [character(len=12) :: 'move along x', 'move up', 'turn', &
                                                   'move along y']
      character(len=:), allocatable :: part
      type(series_tangent), allocatable :: tangent(:)
      real(wp) :: band(frame%half_width + 1, frame%unknowns)
      !> Stiffness of elements along their axes and across, rotations over a length [N/m]
      real(wp) :: stiffness(2, size(frame%element)), lost(frame%unknowns), length, most
      integer :: at(2), of_floor(2), unstable, i

      tangent = frame%initial_tangent
      call frame%linearise(frame%initial_stiffness, tangent, unstable)
      if (unstable > 0) then
         call fatal_error(error, bad_input, 'member '//trim(frame%member_name(unstable))//': its springs '// &
                          'have no stiffness at the start that determines how it bends; give them some')
         return
      end if
      call factor_stiffness()
      if (matrix%positive .and. maxval(matrix%triangle(1, :)*matrix%band(1, :)) < most_lost) return
      ! With parts of like stiffness a mechanism differs from round-off.
      length = sum(frame%element(:frame%members)%length)/frame%members
      do i = 1, size(frame%element)
         associate (of => tangent(i)%stiffness, e => frame%element(i))
            stiffness(:, i) = [of(1, 1), max(of(2, 2), of(3, 3))/merge(length, e%length, e%is_panel)**2]
            if (e%is_panel) stiffness(:, i) = [0.0_wp, of(1, 1)/length**2]
         end associate
      end do
      most = like_stiffness*minval(stiffness, mask=stiffness > 0.0_wp)
      do i = 1, size(frame%element)
         associate (of => tangent(i)%stiffness, e => frame%element(i), &
                    share => sqrt(min(1.0_wp, most/max(stiffness(:, i), most))))
            if (e%is_panel) then
               of = of*share(2)**2
            else
               of(1, :) = of(1, :)*share(1)
               of(:, 1) = of(:, 1)*share(1)
               of(2:, :) = of(2:, :)*share(2)
               of(:, 2:) = of(:, 2:)*share(2)
            end if
         end associate
      end do
      call factor_stiffness()
      if (matrix%positive) then
         call report_stiffest()
         return
      end if
      ! Pivots behind the first that is lost are made of it.
      lost = matrix%triangle(1, :)*matrix%band(1, :)
      i = max(1, findloc(lost > 0.0_wp .and. lost < most_lost, .false., dim=1))
      ! Unknown i is a motion (1: x, 2: up, 3: turn) of a node.
      at = findloc(frame%number, i)
      ! The beams of a node behind a panel
      if (at(2) == 0) at = [3, frame%part(i)]
      part = 'node '//trim(frame%node_name(max(1, at(2))))
      if (frame%plan%is_given()) then
         of_floor = findloc(frame%plan%number, i)
         if (of_floor(2) > 0) then
            part = 'floor '//to_text(of_floor(2))
            at(1) = merge(4, of_floor(1), of_floor(1) == 2)
         end if
      end if
      call fatal_error(error, bad_input, 'frame: it is a mechanism, '//part//' can '//trim(motion(at(1)))// &
                       ' without any force; give it a support, a spring or a stiffer member')

   contains

      !> Factor the initial stiffness of the frame with the present tangents of its elements.
      subroutine factor_stiffness()

         band = 0.0_wp
         call frame%add_stiffness(frame%initial_stiffness, tangent, band)
         call matrix%create(frame%unknowns, frame%half_width, band(1, :))
         matrix%band(:frame%half_width + 1, :) = band
         call matrix%factor()
      end subroutine factor_stiffness

      !> Name the part whose stiffness costs the digits, and what is rigid in its place.
      subroutine report_stiffest()
         character(len=:), allocatable :: remedy

         at = maxloc(stiffness)
         associate (e => frame%element(at(2)))
            if (e%is_panel) then
               part = 'node '//trim(frame%node_name(e%node(1)))//': its panel of '// &
                      to_text(frame%initial_stiffness(e%before + 1))//' N m/rad'
               remedy = 'a node without a panel is rigid'
            else
               part = 'member '//trim(frame%member_name(at(2)))//': '// &
                      trim(merge('along its axis', 'in bending    ', at(1) == 1))//' it'
               remedy = "one with interior = 'rigid' and no springs is rigid"
            end if
         end associate
         call fatal_error(error, bad_input, part//' is so much stiffer than what holds it that the frame '// &
                          'loses 10 of its 16 digits or more; '//remedy//'; lengths are in m (3200 mm is '// &
                          '3.2), areas in m2, inertias in m4, moduli in Pa, stiffness of springs in N/m '// &
                          'and N m/rad')
      end subroutine report_stiffest
   end subroutine check_stable

end module rbs_solve_begin_make_structure
