!> Motion and balance of one element of a frame: the motion of its ends from the unknowns, the forces that
!> balance its springs, its second-order forces and its elastic energy.
module rbs_structure_frame_element_balance
   use rbs_base_kinds, only: wp
   use rbs_structure_frame_element, only: frame_element, find_forces, find_rates, find_tangent
   use rbs_structure_frame_layered, only: drop_small_rates, layered_forces, layered_rates, layered_tangent, &
                                          take_joints_off
   implicit none
   private

   public :: end_motion, motion_terms, chord_rotation, compatibility_error, set_tangent, balance_ends
   public :: add_end_forces, add_second_order, add_band, add_geometric_band
   public :: spring_motion, clear_round_off, energy_of_rest

   !> Share of the terms of a rate that it is round-off below.
   real(wp), parameter :: round_off = 1.0e-12_wp

contains

   !> Elongation of an element and rotations of its ends against the chord from the unknowns, or changes of
   !> them; of a panel, the rotation of its columns against its beams.
   pure function end_motion(e, x) result(q)
      type(frame_element), intent(in) :: e
      !> (unknowns)
      real(wp), intent(in), contiguous :: x(:)
      real(wp) :: q(3)

      if (e%is_panel) then
         associate (b => e%from_unknowns, at => e%unknown)
            q = [b(1, 3)*x(at(3)) + b(1, 6)*x(at(6)), 0.0_wp, 0.0_wp]
         end associate
      else
         q = motion_along(e%from_unknowns, e%unknown, x)
      end if
   end function end_motion

   !> Three motions that are rows of the displacements of the ends.
   pure function motion_along(row, at, x) result(q)
      real(wp), intent(in) :: row(3, 6)
      !> Unknowns of the ends
      integer, intent(in) :: at(6)
      real(wp), intent(in), contiguous :: x(:)
      real(wp) :: q(3)

      q = row(:, 1)*x(at(1)) + row(:, 2)*x(at(2)) + row(:, 3)*x(at(3)) &
          + row(:, 4)*x(at(4)) + row(:, 5)*x(at(5)) + row(:, 6)*x(at(6))
   end function motion_along

   !> Sizes of the terms that elongation and rotations of an element are sums of.
   pure function motion_terms(e, x) result(terms)
      type(frame_element), intent(in) :: e
      !> Displacements of the nodes (unknowns)
      real(wp), intent(in) :: x(:)
      real(wp) :: terms(3)
      integer :: k

      terms = 0.0_wp
      do k = 1, 6
         if (e%number(k) > 0) terms = terms + abs(e%to_basic(:, k)*x(e%number(k)))
      end do
   end function motion_terms

   !> Rotation of the chord [rad].
   pure real(wp) function chord_rotation(e, x) result(rotation)
      type(frame_element), intent(in) :: e
      real(wp), intent(in), contiguous :: x(:)

      rotation = sum(e%lean(3, :)*x(e%unknown))
   end function chord_rotation

   !> Motion of the ends of an element since it was built, less that which its springs and its dead load make:
   !> the part that its elastic rest has to follow.
   pure function compatibility_error(e, q, d, dead) result(misfit)
      type(frame_element), intent(in) :: e
      !> Motion of the ends; deformations of all springs; share of the dead load that acts
      real(wp), intent(in) :: q(3), dead
      real(wp), intent(in), contiguous :: d(:)
      real(wp) :: misfit(3)
      integer :: j

      misfit = q - e%built_at
      misfit(2:) = misfit(2:) - dead*e%dead_rotation
      if (e%layered) then
         call take_joints_off(size(e%motion), e%motion, e%is_single, e%arm, d, misfit)
         return
      end if
      do j = 1, e%bending
         misfit(2) = misfit(2) - e%share(1, j)*d(e%before + j)
         misfit(3) = misfit(3) - e%share(2, j)*d(e%before + j)
      end do
      do j = e%bending + 1, e%bending + e%opening
         misfit(1) = misfit(1) - d(e%before + j)
      end do
   end function compatibility_error

   !> Tangent of an element on the present lines of its springs. The springs of the last tangent are kept
   !> with it, so that it is only found again where their stiffness has changed.
   pure subroutine set_tangent(e, springs, numbers, k, k0, tangent, stable)
      type(frame_element), intent(in) :: e
      !> Number of springs of the element, and of numbers in all tangents
      integer, intent(in) :: springs, numbers
      !> Present and initial stiffness of its springs
      real(wp), intent(in) :: k(springs), k0(springs)
      real(wp), intent(inout) :: tangent(numbers)
      !> Whether the motion of the ends determines that inside
      logical, intent(out) :: stable
      real(wp) :: change
      integer :: j
      logical :: shares

      stable = .true.
      shares = .false.
      associate (layout => e%layout, m => e%bending, n => e%opening)
         associate (known => tangent(layout%branch:layout%branch + springs - 1), &
                    state => tangent(layout%rate - 1))
            change = 0.0_wp
            !$omp simd reduction(max:change)
            do j = 1, springs
               change = max(change, abs(tangent(layout%branch + j - 1) - k(j)))
            end do
            if (state > 0.0_wp .and. .not. change > 0.0_wp) return
            if (e%is_panel) then
               tangent(layout%stiffness:layout%branch - 1) = 0.0_wp
               tangent(layout%stiffness) = k(1)
               tangent(layout%rate) = 1.0_wp
            else if (e%layered) then
               call layered_tangent(e, springs, k, k0, tangent(layout%stiffness:), tangent(layout%rate:), &
                                    stable, shares)
            else
               call find_tangent(e, m, n, k, k0, tangent(layout%stiffness:), tangent(layout%rate:), &
                                 tangent(layout%bent:), tangent(layout%opened:), stable, shares)
            end if
            state = merge(2.0_wp, 1.0_wp, shares)
            ! That it snaps back is to be found again.
            if (.not. stable) state = -state
            known = k
         end associate
      end associate
   end subroutine set_tangent

   !> Forces of the ends of an element in equilibrium with its springs, and the corrections of their
   !> deformations that this needs.
   pure subroutine balance_ends(e, springs, numbers, misfit, dead, dead_force, f, tangent, s, correction)
      type(frame_element), intent(in) :: e
      !> Numbers of springs in the frame, and of numbers in all tangents
      integer, intent(in) :: springs, numbers
      !> Of `compatibility_error`; share of the dead load that acts; forces that all of it makes in springs
      real(wp), intent(in) :: misfit(3), dead, dead_force(springs)
      !> Forces of all springs
      real(wp), intent(in) :: f(springs), tangent(numbers)
      real(wp), intent(out) :: s(3)
      !> (coordinates)
      real(wp), intent(inout), contiguous :: correction(:)

      associate (layout => e%layout, m => e%bending, n => e%opening, first => e%before + 1)
         if (e%layered) then
            call layered_forces(e, size(e%motion), m + n, size(correction), e%first, e%motion, e%is_single, &
                                e%arm, e%dead_moment, tangent(layout%stiffness:), tangent(layout%rate:), &
                                misfit, f(first:), dead, dead_force(first:), s, correction)
         else
            call find_forces(e, m, n, tangent(layout%stiffness:), tangent(layout%rate:), &
                             tangent(layout%bent:), tangent(layout%opened:), misfit, f(first:), dead, &
                             dead_force(first:), s, correction(first:))
         end if
      end associate
   end subroutine balance_ends

   !> Add the forces on the unknowns by axial force and end moments of an element.
   pure subroutine add_end_forces(e, s, g)
      type(frame_element), intent(in) :: e
      real(wp), intent(in) :: s(3)
      !> (unknowns)
      real(wp), intent(inout) :: g(:)

      if (e%is_panel) then
         g(e%unknown(3)) = g(e%unknown(3)) + s(1)*e%from_unknowns(1, 3)
         g(e%unknown(6)) = g(e%unknown(6)) + s(1)*e%from_unknowns(1, 6)
      else
         call add_along(e%from_unknowns, e%unknown, s, g)
      end if
   end subroutine add_end_forces

   !> Forces on the unknowns of forces along three rows.
   pure subroutine add_along(row, at, s, g)
      real(wp), intent(in) :: row(3, 6), s(3)
      integer, intent(in) :: at(6)
      real(wp), intent(inout) :: g(:)
      integer :: k

      do k = 1, 6
         g(at(k)) = g(at(k)) + (s(1)*row(1, k) + s(2)*row(2, k) + s(3)*row(3, k))
      end do
   end subroutine add_along

   !> Second-order forces of the compression of an element, N sum l r (r . x): rows r are the rotations of its
   !> rigid ends and of its chord. Bending off the chord belongs to the elastic rest.
   pure subroutine add_second_order(e, x, g)
      type(frame_element), intent(in) :: e
      real(wp), intent(in), contiguous :: x(:)
      real(wp), intent(inout), contiguous :: g(:)

      associate (turned => motion_along(e%lean, e%unknown, x))
         call add_along(e%lean, e%unknown, e%compression*[e%rigid, e%length]*turned, g)
      end associate
   end subroutine add_second_order

   !> Add B' A B of an element to a lower band, B its elongation and rotations per unknown.
   pure subroutine add_band(e, a, band)
      type(frame_element), intent(in) :: e
      real(wp), intent(in) :: a(3, 3)
      !> (half_width + 1, unknowns)
      real(wp), intent(inout), contiguous :: band(:, :)

      call add_product(e%number, e%to_basic, a, band)
   end subroutine add_band

   !> Add the derivatives of the second-order forces of an axial force, with their sign turned.
   pure subroutine add_geometric_band(e, compression, band)
      type(frame_element), intent(in) :: e
      real(wp), intent(in) :: compression
      real(wp), intent(inout), contiguous :: band(:, :)
      real(wp) :: a(3, 3)

      a = 0.0_wp
      a(1, 1) = -compression*e%rigid(1)
      a(2, 2) = -compression*e%rigid(2)
      a(3, 3) = -compression*e%length
      call add_product(e%number, e%lean, a, band)
   end subroutine add_geometric_band

   !> Add B' A B of three rows of the displacements of the ends.
   pure subroutine add_product(number, b, a, band)
      integer, intent(in) :: number(6)
      real(wp), intent(in) :: b(3, 6), a(3, 3)
      real(wp), intent(inout), contiguous :: band(:, :)
      real(wp) :: row(3)
      integer :: i, j

      do j = 1, 6
         associate (column => number(j))
            if (column == 0) cycle
            row = a(:, 1)*b(1, j) + a(:, 2)*b(2, j) + a(:, 3)*b(3, j)
            do i = 1, 6
               if (number(i) < column) cycle
               associate (entry => band(1 + number(i) - column, column))
                  entry = entry + sum(b(:, i)*row)
               end associate
            end do
         end associate
      end do
   end subroutine add_product

   !> Changes of the deformations of springs with those of the ends of their element.
   pure subroutine spring_motion(e, springs, numbers, tangent, q, dd)
      type(frame_element), intent(in) :: e
      integer, intent(in) :: springs, numbers
      real(wp), intent(in) :: tangent(numbers), q(3)
      real(wp), intent(inout) :: dd(springs)

      associate (layout => e%layout, m => e%bending + e%opening, first => e%before + 1)
         if (e%layered) then
            call layered_rates(size(e%motion), size(dd), e%motion, e%is_single, e%arm, &
                               tangent(layout%stiffness:), tangent(layout%rate:), q, dd)
         else
            call find_rates(m, tangent(layout%rate:), q, dd(first:))
         end if
      end associate
   end subroutine spring_motion

   !> Take rates that are round-off of their terms for zero.
   pure subroutine clear_round_off(e, springs, numbers, tangent, size_of, dd)
      type(frame_element), intent(in) :: e
      integer, intent(in) :: springs, numbers
      !> Sizes of the motion of the ends, see `motion_terms`
      real(wp), intent(in) :: tangent(numbers), size_of(3)
      real(wp), intent(inout) :: dd(springs)
      integer :: at, j

      associate (layout => e%layout, m => e%bending + e%opening, first => e%before + 1)
         if (e%layered) then
            call drop_small_rates(e, m, tangent(layout%stiffness:), tangent(layout%rate:), size_of, &
                                            round_off, dd(first:))
            return
         end if
         do j = 1, m
            at = layout%rate + 3*(j - 1)
            associate (rate => dd(e%before + j))
               if (abs(rate) < round_off*sum(abs(tangent(at:at + 2))*size_of)) rate = 0.0_wp
            end associate
         end do
      end associate
   end subroutine clear_round_off

   !> Energy of the elastic rest of an element [J].
   pure real(wp) function energy_of_rest(e, misfit) result(energy)
      type(frame_element), intent(in) :: e
      !> Its elongation and rotations
      real(wp), intent(in) :: misfit(3)

      energy = 0.5_wp*e%rest_along*misfit(1)**2
      if (allocated(e%rest)) energy = energy + 0.125_wp*(e%rest(1)*(misfit(2) + misfit(3))**2 &
                                                         + e%rest(2)*(misfit(2) - misfit(3))**2)
   end function energy_of_rest

end module rbs_structure_frame_element_balance
