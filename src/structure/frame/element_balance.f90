!> Motion and balance of one element of a frame: the motion of its ends from the unknowns, the forces that
!> balance its springs, its second-order forces and its elastic energy.
module rbs_structure_frame_element_balance
   use rbs_base_kinds, only: wp
   use rbs_base_tolerances, only: round_off_of_rates, round_off_of_sums
   use rbs_structure_condensation, only: series_tangent
   use rbs_structure_frame_element, only: frame_element, element_joint, most_columns
   implicit none
   private

   public :: end_motion, motion_terms, chord_rotation, compatibility_error, set_tangent, balance_ends, &
             balance_of_ends
   public :: add_end_forces, add_band, add_geometric_band
   public :: spring_motion, drop_round_off, energy_of_rest

   !> Displacements of two ends.
   integer, parameter :: ends = 6

contains

   !> Elongation of an element [m] and rotations of its ends against the chord [rad] from the unknowns, or
   !> changes of them; of a panel, the rotation of its columns against its beams, then zeros.
   pure function end_motion(e, x) result(q)
      type(frame_element), intent(in) :: e
      !> (unknowns)
      real(wp), intent(in), contiguous :: x(:)
      real(wp) :: q(3)
      integer :: k

      ! A panel is between two unknowns: number 3 turns its columns, number 6 its beams.
      if (e%is_panel) then
         associate (b => e%from_unknowns, at => e%unknown)
            q = [b(1, 3)*x(at(3)) + b(1, 6)*x(at(6)), 0.0_wp, 0.0_wp]
         end associate
      else
         associate (row => e%from_unknowns, at => e%unknown)
            q = row(:, 1)*x(at(1)) + row(:, 2)*x(at(2)) + row(:, 3)*x(at(3)) &
                + row(:, 4)*x(at(4)) + row(:, 5)*x(at(5)) + row(:, 6)*x(at(6))
            ! In a building further unknowns of its floors move it.
            do k = ends + 1, e%width
               q = q + row(:, k)*x(at(k))
            end do
         end associate
      end if
   end function end_motion

   !> Sizes of the terms that elongation and rotations of an element are sums of.
   pure function motion_terms(e, x) result(terms)
      type(frame_element), intent(in) :: e
      !> Displacements of the nodes (unknowns)
      real(wp), intent(in) :: x(:)
      real(wp) :: terms(3)
      integer :: k

      terms = 0.0_wp
      do k = 1, e%width
         if (e%number(k) > 0) terms = terms + abs(e%to_basic(:, k)*x(e%number(k)))
      end do
   end function motion_terms

   !> Rotation of the chord, clockwise [rad].
   pure real(wp) function chord_rotation(e, x) result(rotation)
      type(frame_element), intent(in) :: e
      !> (unknowns)
      real(wp), intent(in), contiguous :: x(:)

      rotation = sum(e%lean(3, :e%width)*x(e%unknown(:e%width)))
   end function chord_rotation

   !> Motion of the ends of an element since it was built, less that which its springs and its dead load make:
   !> the part that its elastic rest has to follow.
   pure function compatibility_error(e, q, d, dead) result(misfit)
      type(frame_element), intent(in) :: e
      !> Motion of the ends, of `end_motion`; share of the dead load that acts
      real(wp), intent(in) :: q(3), dead
      !> Deformations of all springs (coordinates)
      real(wp), intent(in), contiguous :: d(:)
      real(wp) :: misfit(3)
      integer :: j

      misfit = q - e%built_at
      misfit(2:) = misfit(2:) - dead*e%dead_rotation
      do j = 1, size(e%joint)
         associate (of => e%joint(j))
            ! Opening and rotation of a joint of layers are two coordinates.
            misfit = misfit - of%arm(:, 1)*d(of%motion)
            if (.not. of%is_single) misfit = misfit - of%arm(:, 2)*d(of%motion + 1)
         end associate
      end do
   end function compatibility_error

   !> Tangent of an element on the present lines of its springs. The springs of the last tangent are kept
   !> with it, so that it is only found again where their stiffness has changed.
   pure subroutine set_tangent(e, springs, k, tangent)
      type(frame_element), intent(in) :: e
      !> Number of springs of the element, and their present stiffness
      integer, intent(in) :: springs
      real(wp), intent(in) :: k(springs)
      !> On entry the tangent of the last call, if there was one
      type(series_tangent), intent(inout) :: tangent
      integer :: spared

      if (tangent%is_known) then
         if (.not. any(abs(tangent%branch - k) > 0.0_wp)) return
      end if
      tangent%branch = k
      call e%inner_springs(springs, k, tangent%p, tangent%k, tangent%turn)
      tangent%k0(:e%inner) = e%initial
      tangent%k0(e%inner + 1:) = abs(tangent%k(e%inner + 1:))
      spared = 0
      ! Under tension the elastic rest only takes off flexibility of springs: it has a negative stiffness, and
      ! softens nothing. Beyond Euler's load a negative stiffness counts.
      if (allocated(e%rest) .and. .not. e%compression > 0.0_wp) spared = count(e%rest < 0.0_wp)
      call tangent%condense(e%condensed(), e%weight, spared)
   end subroutine set_tangent

   !> Forces of the ends of an element in equilibrium with its springs, and the corrections of their
   !> deformations that this needs.
   pure subroutine balance_ends(e, springs, misfit, dead, dead_force, f, tangent, s, correction)
      type(frame_element), intent(in) :: e
      !> Number of springs in the frame
      integer, intent(in) :: springs
      !> Of `compatibility_error`; share of the dead load that acts; forces that all of it makes in springs
      real(wp), intent(in) :: misfit(3), dead, dead_force(springs)
      !> Forces of all springs
      real(wp), intent(in) :: f(springs)
      !> Tangent of the element on the present lines of its springs
      type(series_tangent), intent(in) :: tangent
      !> Axial force [N] and moments [N m] of the ends
      real(wp), intent(out) :: s(3)
      !> Set for the springs of this element (coordinates)
      real(wp), intent(inout), contiguous :: correction(:)
      real(wp) :: pair(2)
      integer :: j

      do j = 1, size(e%joint)
         associate (of => e%joint(j), i => e%before + e%joint(j)%first, at => e%joint(j)%motion)
            if (of%is_single) then
               correction(at) = f(i) - dead*dead_force(i)
            else
               pair = pair_forces(of, f(i:i + 1), dead, tangent%turn(:, j))
               ! Layers that yield would move far for the round-off of the sum of their forces.
               if (tangent%is_mechanism) where (abs(pair) <= round_off_of_sums*sum(abs(pair))) pair = 0.0_wp
               correction(at:at + 1) = pair
            end if
         end associate
      end do
      call tangent%correct(e%condensed(), e%place, misfit, s, correction)
      if (allocated(e%y)) call turn_pairs(e, tangent, correction)
   end subroutine balance_ends

   !> The forces of the ends that `balance_ends` finds, alone, under all of the dead load.
   pure function balance_of_ends(e, springs, misfit, dead_force, f, tangent) result(s)
      type(frame_element), intent(in) :: e
      !> Number of springs in the frame
      integer, intent(in) :: springs
      !> Of `compatibility_error`; forces of the dead load in all springs; forces of all springs
      real(wp), intent(in) :: misfit(3), dead_force(springs), f(springs)
      !> Tangent of the element on the present lines of its springs
      type(series_tangent), intent(in) :: tangent
      real(wp) :: s(3), pair(2)
      integer :: j

      ! s = K m + sum f dd/dq, see `rbs_structure_condensation`
      associate (k => tangent%stiffness, rate => tangent%rate)
         s = k(:, 1)*misfit(1) + k(:, 2)*misfit(2) + k(:, 3)*misfit(3)
         do j = 1, size(e%joint)
            associate (of => e%joint(j), i => e%before + e%joint(j)%first, at => e%joint(j)%spring)
               if (of%is_single) then
                  s = s + rate(:, at)*(f(i) - dead_force(i))
               else
                  pair = pair_forces(of, f(i:i + 1), 1.0_wp, tangent%turn(:, j))
                  s = s + rate(:, at)*pair(1) + rate(:, at + 1)*pair(2)
               end if
            end associate
         end do
      end associate
   end function balance_of_ends

   !> Forces along the axes of a joint of layers, without those of the dead load [N].
   pure function pair_forces(joint, f, dead, turn) result(along)
      type(element_joint), intent(in) :: joint
      !> Axial force [N] and moment [N m], share of the dead load, cosine and sine of the axes
      real(wp), intent(in) :: f(2), dead, turn(2)
      real(wp) :: along(2), moment

      moment = ((f(2) - dead*joint%dead_moment) - joint%centre*f(1))/joint%radius
      along = [turn(1)*f(1) + turn(2)*moment, turn(1)*moment - turn(2)*f(1)]
   end function pair_forces

   !> Openings and rotations of the joints of layers from the motions along their axes, in their places.
   pure subroutine turn_pairs(e, tangent, d)
      type(frame_element), intent(in) :: e
      !> Tangent of the element on the present lines of its springs
      type(series_tangent), intent(in) :: tangent
      !> (coordinates)
      real(wp), intent(inout), contiguous :: d(:)
      real(wp) :: along(2)
      integer :: j

      do j = 1, size(e%joint)
         associate (of => e%joint(j), at => e%joint(j)%motion, turn => tangent%turn(:, j))
            if (of%is_single) cycle
            along = d(at:at + 1)
            d(at + 1) = (turn(2)*along(1) + turn(1)*along(2))/of%radius
            d(at) = (turn(1)*along(1) - turn(2)*along(2)) - of%centre*d(at + 1)
         end associate
      end do
   end subroutine turn_pairs

   !> Add B' s of an element to forces on the unknowns; a caller that wants the forces of the element on them
   !> gives -s.
   pure subroutine add_end_forces(e, s, g)
      type(frame_element), intent(in) :: e
      !> Axial force [N], moments of the first and the last end [N m]
      real(wp), intent(in) :: s(3)
      !> (unknowns)
      real(wp), intent(inout) :: g(:)
      integer :: k

      ! A panel is between two unknowns: number 3 turns its columns, number 6 its beams.
      if (e%is_panel) then
         g(e%unknown(3)) = g(e%unknown(3)) + s(1)*e%from_unknowns(1, 3)
         g(e%unknown(6)) = g(e%unknown(6)) + s(1)*e%from_unknowns(1, 6)
      else
         associate (row => e%from_unknowns, at => e%unknown)
            do k = 1, e%width
               g(at(k)) = g(at(k)) + (s(1)*row(1, k) + s(2)*row(2, k) + s(3)*row(3, k))
            end do
         end associate
      end if
   end subroutine add_end_forces

   !> Add B' A B of an element to a lower band, B its elongation and rotations per unknown.
   pure subroutine add_band(e, a, band, columns)
      type(frame_element), intent(in) :: e
      !> Stiffness of the ends [N/m, N, N m]
      real(wp), intent(in) :: a(3, 3)
      !> (half_width + 1, unknowns)
      real(wp), intent(inout), contiguous :: band(:, :)
      !> The columns that are filled (unknowns); without it, all
      logical, intent(in), optional, contiguous :: columns(:)
      integer :: j

      if (present(columns)) then
         ! Column by column, as most elements have none of these
         do j = 1, e%width
            if (.not. columns(e%unknown(j))) cycle
            call add_column(e%width, e%number, e%to_basic, a, j, band)
         end do
      else if (e%width == ends) then
         call add_product(ends, e%number, e%to_basic, a, band)
      else
         call add_product(e%width, e%number, e%to_basic, a, band)
      end if
   end subroutine add_band

   !> Add the derivatives of the second-order forces of an axial force, with their sign turned, to a lower
   !> band.
   pure subroutine add_geometric_band(e, compression, band)
      type(frame_element), intent(in) :: e
      !> Compression positive [N]
      real(wp), intent(in) :: compression
      !> (half_width + 1, unknowns)
      real(wp), intent(inout), contiguous :: band(:, :)
      real(wp) :: a(3, 3)

      a = 0.0_wp
      ! The force leans with both rigid ends and with the chord.
      a(1, 1) = -compression*e%rigid(1)
      a(2, 2) = -compression*e%rigid(2)
      a(3, 3) = -compression*e%length
      call add_product(e%width, e%number, e%lean, a, band)
   end subroutine add_geometric_band

   !> Add B' A B of three rows of the displacements of the ends to a lower band.
   pure subroutine add_product(width, number, b, a, band)
      !> Number of unknowns of the element; their numbers in the frame, 0 where a support holds one
      integer, intent(in) :: width, number(width)
      !> Rows of B by unknowns of the element; A
      real(wp), intent(in) :: b(3, width), a(3, 3)
      !> (half_width + 1, unknowns)
      real(wp), intent(inout), contiguous :: band(:, :)
      integer :: j

      do j = 1, width
         call add_column(width, number, b, a, j, band)
      end do
   end subroutine add_product

   !> Add one column of B' A B, that of the unknown j of the element, to a lower band.
   pure subroutine add_column(width, number, b, a, j, band)
      !> As in `add_product`
      integer, intent(in) :: width, number(width), j
      real(wp), intent(in) :: b(3, width), a(3, 3)
      real(wp), intent(inout), contiguous :: band(:, :)
      real(wp) :: row(3)
      integer :: i

      associate (column => number(j))
         if (column == 0) return
         row = a(:, 1)*b(1, j) + a(:, 2)*b(2, j) + a(:, 3)*b(3, j)
         do i = 1, width
            if (number(i) < column) cycle
            associate (entry => band(1 + number(i) - column, column))
               entry = entry + sum(b(:, i)*row)
            end associate
         end do
      end associate
   end subroutine add_column

   !> Changes of deformations, openings and rotations with those of the ends of their element.
   pure subroutine spring_motion(e, tangent, q, d)
      type(frame_element), intent(in) :: e
      !> Tangent of the element on the present lines of its springs
      type(series_tangent), intent(in) :: tangent
      !> Changes of elongation and rotations of the ends
      real(wp), intent(in) :: q(3)
      !> Set for the springs and joints of this element (coordinates)
      real(wp), intent(inout), contiguous :: d(:)
      integer :: j

      do j = 1, e%inner
         associate (rate => tangent%rate(:, j))
            d(e%place(j)) = rate(1)*q(1) + rate(2)*q(2) + rate(3)*q(3)
         end associate
      end do
      if (allocated(e%y)) call turn_pairs(e, tangent, d)
   end subroutine spring_motion

   !> Take rates of springs that are round-off of the terms that they are sums of for zero.
   pure subroutine drop_round_off(e, tangent, size_of, d)
      type(frame_element), intent(in) :: e
      !> Tangent of the element on the present lines of its springs
      type(series_tangent), intent(in) :: tangent
      !> Sizes of the motion of the ends, see `motion_terms`
      real(wp), intent(in) :: size_of(3)
      !> Rates of all springs (springs)
      real(wp), intent(inout) :: d(:)
      !> Sizes of round-off: along both axes of a joint, then of its opening [m] and rotation [rad]
      real(wp) :: least, across, opening, tilt
      integer :: j

      do j = 1, size(e%joint)
         associate (of => e%joint(j), at => e%joint(j)%spring, i => e%before + e%joint(j)%first)
            ! A rate is a sum over the motions of the ends; it is round-off beside the sizes of its terms.
            least = round_off_of_rates*sum(abs(tangent%rate(:, at))*size_of)
            if (of%is_single) then
               if (abs(d(i)) < least) d(i) = 0.0_wp
            else
               across = round_off_of_rates*sum(abs(tangent%rate(:, at + 1))*size_of)
               associate (last => e%before + of%last, turn => abs(tangent%turn(:, j)))
                  opening = turn(1)*least + turn(2)*across
                  tilt = (turn(2)*least + turn(1)*across)/of%radius
                  call drop_below(last - i + 1, e%y(of%first:of%last), opening + abs(of%centre)*tilt, tilt, &
                                  d(i:last))
               end associate
            end if
         end associate
      end do
   end subroutine drop_round_off

   !> Take rates of layers that are less than the round-off of opening and rotation of their joint for zero.
   pure subroutine drop_below(n, y, opening, tilt, d)
      !> Number of layers
      integer, intent(in) :: n
      !> Distances of the layers from the middle [m]; round-off of the opening and of the rotation
      real(wp), intent(in) :: y(n), opening, tilt
      !> Rates of the layers
      real(wp), intent(inout) :: d(n)
      integer :: i

      !$omp simd
      do i = 1, n
         d(i) = merge(0.0_wp, d(i), abs(d(i)) < opening + abs(y(i))*tilt)
      end do
   end subroutine drop_below

   !> Energy of the elastic rest of an element [J].
   pure real(wp) function energy_of_rest(e, misfit) result(energy)
      type(frame_element), intent(in) :: e
      !> Elongation and rotations of the rest, of `compatibility_error`
      real(wp), intent(in) :: misfit(3)

      ! The rest bends in double curvature by half the sum, in single curvature by half the difference of the
      ! rotations.
      energy = 0.5_wp*e%rest_along*misfit(1)**2
      if (allocated(e%rest)) energy = energy + 0.125_wp*(e%rest(1)*(misfit(2) + misfit(3))**2 &
                                                         + e%rest(2)*(misfit(2) - misfit(3))**2)
   end function energy_of_rest

end module rbs_structure_frame_element_balance
