!> Springs in a row, condensed to their ends, against the equations of equilibrium and compatibility solved as
!> a whole.
module test_condensation
   use check, only: unit_test, check_close, check_true
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_base_linalg, only: solve_dense
   use rbs_structure_condensation, only: series_tangent
   implicit none
   private

   public :: collect_condensation

   integer, parameter :: springs = 6, all_springs(springs) = [1, 2, 3, 4, 5, 6]
   real(wp), parameter :: weight(3) = 1.0_wp

contains

   subroutine collect_condensation(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('rates, stiffness and corrections of any springs', any_springs), &
               unit_test('springs without stiffness move the ends without force', plastic), &
               unit_test('a mechanism shares its motion as elastic springs do', mechanism), &
               unit_test('negative directions inside a row that softens', softening), &
               unit_test('units scaled by powers of two give the same bits', scaled)]
   end subroutine collect_condensation

   !> Springs like those of a member: openings, slips and hinges, which are not at one place. Hinges without
   !> stiffness whose distance is below 1e-6 of the member are one.
   subroutine draw(p, k0)
      real(wp), intent(out) :: p(3, springs), k0(springs)
      real(wp) :: u(4), place
      integer :: j

      do j = 1, springs
         call random_number(u)
         k0(j) = 10.0_wp**(4.0_wp*u(1) - 2.0_wp)
         select case (mod(j, 4))
         case (0)
            p(:, j) = [0.0_wp, -1.0_wp, -1.0_wp]/3.0_wp
         case (1)
            p(:, j) = [1.0_wp, 0.0_wp, 0.0_wp]
         case (2)
            place = merge(0.49_wp*u(2), 1.0_wp - 0.49_wp*u(2), j < 4)
            p(:, j) = [0.0_wp, place - 1.0_wp, place]
         case default
            p(:, j) = [sign(0.01_wp + 0.2_wp*u(3), u(4) - 0.3_wp), u(2) - 1.0_wp, u(2)]
         end select
      end do
   end subroutine draw

   !> Deformations d and end forces s of k d - P' s = -f, P d = q.
   subroutine solve_whole(p, k, q, f, d, s)
      real(wp), intent(in) :: p(3, springs), k(springs), q(3), f(springs)
      real(wp), intent(out) :: d(springs), s(3)
      real(wp) :: a(springs + 3, springs + 3), b(springs + 3)
      logical :: regular
      integer :: j

      a = 0.0_wp
      do j = 1, springs
         a(j, j) = k(j)
         a(j, springs + 1:) = -p(:, j)
         a(springs + 1:, j) = p(:, j)
      end do
      b(:springs) = -f
      b(springs + 1:) = q
      call solve_dense(a, b, regular)
      d = b(:springs)
      s = b(springs + 1:)
   end subroutine solve_whole

   subroutine condense(row, p, k, k0, against, spared)
      type(series_tangent), intent(out) :: row
      real(wp), intent(in) :: p(3, springs), k(springs), k0(springs), against(3)
      integer, intent(in) :: spared

      call row%create(springs, springs, 0)
      row%p = p
      row%k = k
      row%k0 = k0
      call row%condense(springs, against, spared)
   end subroutine condense

   !> One row against the whole, for rates and for a correction.
   subroutine compare(error, p, k, k0, what)
      type(error_type), allocatable, intent(inout) :: error
      real(wp), intent(in) :: p(3, springs), k(springs), k0(springs)
      character(len=*), intent(in) :: what
      type(series_tangent) :: row
      real(wp) :: q(3), f(springs), d(springs), s(3), expected(springs), forces(3)

      call random_number(q)
      call random_number(f)
      call condense(row, p, k, k0, weight, 0)
      call solve_whole(p, k, q, spread(0.0_wp, 1, springs), expected, forces)
      d = matmul(q, row%rate)
      call check_close(error, d, expected, 0.0_wp, 1.0e-11_wp*maxval(abs(expected)), what//': rates')
      call check_close(error, matmul(row%stiffness, q), forces, 0.0_wp, &
                       1.0e-11_wp*maxval(abs(k)*maxval(abs(d))), what//': forces')
      call solve_whole(p, k, q, f, expected, forces)
      d = f
      call row%correct(springs, all_springs, q, s, d)
      call check_close(error, d, expected, 0.0_wp, 1.0e-11_wp*maxval(abs(expected)), what//': correction')
      call check_close(error, s, forces, 0.0_wp, 1.0e-11_wp*maxval(abs(k)*maxval(abs(d))), &
                       what//': balanced forces')
      call check_true(error, .not. row%is_mechanism, what//': no mechanism')
   end subroutine compare

   subroutine any_springs(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp) :: p(3, springs), k0(springs)
      integer :: i

      do i = 1, 1000
         call draw(p, k0)
         call compare(error, p, k0, k0, 'stiff')
      end do
   end subroutine any_springs

   subroutine plastic(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp) :: p(3, springs), k(springs), k0(springs), u(3), s(3), d(springs)
      type(series_tangent) :: row
      integer :: i

      do i = 1, 1000
         call draw(p, k0)
         call random_number(u)
         k = k0
         ! An opening, and hinges at different places
         if (u(1) < 0.5_wp) k(1) = 0.0_wp
         if (u(2) < 0.7_wp) k(2) = 0.0_wp
         if (u(3) < 0.7_wp) k(6) = 0.0_wp
         call compare(error, p, k, k0, 'plastic')
         k([1, 2, 6]) = 0.0_wp
         call condense(row, p, k, k0, weight, 0)
         call check_true(error, all(abs(row%stiffness) <= 0.0_wp), 'three hinges have no stiffness at all')
         d = k0
         call row%correct(springs, all_springs, spread(0.0_wp, 1, 3), s, d)
         call check_close(error, [sum(p(:, 1)*s), sum(p(:, 2)*s), sum(p(:, 6)*s)], k0([1, 2, 6]), &
                          1.0e-11_wp, 1.0e-11_wp*maxval(k0), 'their forces are those of the row')
      end do
   end subroutine plastic

   subroutine mechanism(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp) :: p(3, springs), k(springs), k0(springs), q(3), d(springs), expected(springs), s(3)
      type(series_tangent) :: row
      integer :: i

      do i = 1, 1000
         call draw(p, k0)
         k0 = 1.0_wp + 0.1_wp*k0
         k = k0
         k([2, 3, 6]) = 0.0_wp
         if (mod(i, 2) == 0) k([1, 4]) = 0.0_wp
         call condense(row, p, k, k0, weight, 0)
         call check_true(error, row%is_mechanism .eqv. mod(i, 2) == 0, 'five springs, but three rows')
         if (.not. row%is_mechanism) cycle
         call random_number(q)
         d = matmul(q, row%rate)
         call solve_whole(p, merge(k, 1.0e-6_wp*k0, k > 0.0_wp), q, spread(0.0_wp, 1, springs), expected, s)
         call check_close(error, d, expected, 0.0_wp, 1.0e-3_wp*maxval(abs(expected)), 'shared motion')
         call check_close(error, matmul(p, d), q, 1.0e-11_wp, 1.0e-11_wp*maxval(abs(d)), 'motion of the ends')
         call check_true(error, all(abs(row%stiffness) <= 0.0_wp), 'no stiffness')
      end do
   end subroutine mechanism

   !> The energy inside in the motions of the last springs, while the first three keep the ends in place.
   subroutine softening(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp) :: p(3, springs), k(springs), k0(springs), u(springs), h(3, 3), to_first(3, 3), pivot
      type(series_tangent) :: row
      logical :: regular
      integer :: i, j, negative, spared

      do i = 1, 2000
         call draw(p, k0)
         k0 = 1.0_wp + 0.1_wp*k0
         call random_number(u)
         k = k0*merge(1.0_wp, -0.4_wp, u < 0.7_wp)
         do j = 1, 3
            h = p(:, :3)
            to_first(:, j) = p(:, j + 3)
            call solve_dense(h, to_first(:, j), regular)
         end do
         h = matmul(transpose(to_first), spread(k(:3), 2, 3)*to_first)
         negative = 0
         do j = 1, 3
            h(j, j) = h(j, j) + k(j + 3)
         end do
         do j = 1, 3
            pivot = h(j, j)
            if (pivot < 0.0_wp) negative = negative + 1
            h = h - spread(h(:, j), 2, 3)*spread(h(j, :), 1, 3)/pivot
            h(j, :) = 0.0_wp
            h(:, j) = 0.0_wp
         end do
         do spared = 0, 3
            call condense(row, p, k, k0, weight, spared)
            call check_true(error, row%snaps_back .eqv. negative > spared, 'number of negative directions')
         end do
      end do
   end subroutine softening

   subroutine scaled(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp) :: p(3, springs), k(springs), k0(springs), unit(3), q(3), d(springs), other(springs)
      type(series_tangent) :: row, scaled_row
      integer :: i

      do i = 1, 1000
         call draw(p, k0)
         k = k0
         k(2) = 0.0_wp
         k(5) = -0.1_wp*k(5)
         ! Moments in another unit of length and force, so that rotations are the same
         unit = [1.0_wp, 2.0_wp**60, 2.0_wp**60]
         call condense(row, p, k, k0, weight, 0)
         call condense(scaled_row, p*spread(unit, 2, springs), k*2.0_wp**(-300), k0*2.0_wp**(-300), &
                       weight*2.0_wp**(-300)/unit**2, 0)
         call random_number(q)
         d = matmul(q, row%rate)
         other = matmul(q*unit, scaled_row%rate)
         call check_true(error, all(abs(d - other) <= 0.0_wp), 'the same rates')
      end do
   end subroutine scaled

end module test_condensation
