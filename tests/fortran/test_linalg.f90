!> LAPACK behind its wall: small systems by hand, and every way to fail.
module test_linalg
   use check, only: unit_test, check_close, check_failed, check_passed, check_true
   use rbs_base_error, only: error_type, analysis_failed
   use rbs_base_kinds, only: wp
   use rbs_base_linalg, only: factor_positive, solve_positive, invert_positive, solve_general, &
                              solve_eigen
   implicit none
   private

   public :: collect_linalg

   !> Symmetric, positive definite; eigenvalues 1 and 3. Its upper triangle must never be read.
   real(wp), parameter :: two_by_two(2, 2) = reshape([2.0_wp, 1.0_wp, -99.0_wp, 2.0_wp], [2, 2])

contains

   subroutine collect_linalg(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('Cholesky solves, lower triangle only', positive), &
               unit_test('Cholesky refuses an indefinite matrix', indefinite), &
               unit_test('Cholesky refuses a singular matrix', semidefinite), &
               unit_test('the inverse is whole and symmetric', inverse), &
               unit_test('inverse of a 6 by 6 Hilbert matrix, exact integers', hilbert), &
               unit_test('the inverse of an indefinite matrix is refused', no_inverse), &
               unit_test('elimination with pivots, two right-hand sides', general), &
               unit_test('elimination refuses a singular matrix', singular), &
               unit_test('eigenvalues ascend, vectors have unit mass', eigen), &
               unit_test('eigenproblem names a mass matrix that is not positive', bad_mass)]
   end subroutine collect_linalg

   subroutine positive(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp) :: a(2, 2), b(2)
      logical :: is_positive

      a = two_by_two
      b = [4.0_wp, 5.0_wp]
      call factor_positive(a, is_positive)
      call check_true(error, is_positive, 'positive definite')
      call solve_positive(a, b)
      call check_close(error, b, [1.0_wp, 2.0_wp], 1.0e-15_wp, 0.0_wp, 'solution')
   end subroutine positive

   subroutine indefinite(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp) :: a(2, 2)
      logical :: is_positive

      a = reshape([1.0_wp, 2.0_wp, 2.0_wp, 1.0_wp], [2, 2])
      call factor_positive(a, is_positive)
      call check_true(error, .not. is_positive, 'eigenvalues -1 and 3')
   end subroutine indefinite

   subroutine semidefinite(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp) :: a(2, 2)
      logical :: is_positive

      a = reshape([4.0_wp, 2.0_wp, 2.0_wp, 1.0_wp], [2, 2])
      call factor_positive(a, is_positive)
      call check_true(error, .not. is_positive, 'eigenvalues 0 and 5')
   end subroutine semidefinite

   subroutine inverse(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp) :: a(2, 2)
      logical :: is_positive

      a = two_by_two
      call invert_positive(a, is_positive)
      call check_true(error, is_positive, 'positive definite')
      call check_close(error, pack(a, .true.), [2.0_wp, -1.0_wp, -1.0_wp, 2.0_wp]/3.0_wp, 1.0e-15_wp, &
                       0.0_wp, 'inverse')
   end subroutine inverse

   subroutine hilbert(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp) :: a(6, 6)
      integer :: i, j
      logical :: is_positive

      do j = 1, 6
         do i = 1, 6
            a(i, j) = 1.0_wp/(i + j - 1)
         end do
      end do
      call invert_positive(a, is_positive)
      call check_true(error, is_positive, 'positive definite')
      ! Condition 1.5e7: nine digits must be left.
      call check_close(error, a(1, :3), [36.0_wp, -630.0_wp, 3360.0_wp], 1.0e-8_wp, 0.0_wp, 'row 1')
      call check_close(error, a(6, 4:), [1552320.0_wp, -1746360.0_wp, 698544.0_wp], 1.0e-8_wp, &
                       0.0_wp, 'row 6')
   end subroutine hilbert

   subroutine no_inverse(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp) :: a(2, 2)
      logical :: is_positive

      a = reshape([-1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [2, 2])
      call invert_positive(a, is_positive)
      call check_true(error, .not. is_positive, 'a negative diagonal')
   end subroutine no_inverse

   subroutine general(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp) :: a(3, 3), b(3, 2)
      logical :: regular

      ! A zero in the first place: needs pivots, as the bordered matrix of a driven top does.
      a = reshape([0.0_wp, 1.0_wp, 2.0_wp, 1.0_wp, 0.0_wp, 1.0_wp, 3.0_wp, -1.0_wp, 0.0_wp], [3, 3])
      b(:, 1) = matmul(a, [1.0_wp, 2.0_wp, 3.0_wp])
      b(:, 2) = matmul(a, [-1.0_wp, 0.0_wp, 0.5_wp])
      call solve_general(a, b, regular)
      call check_true(error, regular, 'regular')
      call check_close(error, b(:, 1), [1.0_wp, 2.0_wp, 3.0_wp], 1.0e-14_wp, 0.0_wp, 'first')
      call check_close(error, b(:, 2), [-1.0_wp, 0.0_wp, 0.5_wp], 1.0e-14_wp, 1.0e-15_wp, 'second')
   end subroutine general

   subroutine singular(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp) :: a(2, 2), b(2, 1)
      logical :: regular

      a = reshape([1.0_wp, 2.0_wp, 2.0_wp, 4.0_wp], [2, 2])
      b = 1.0_wp
      call solve_general(a, b, regular)
      call check_true(error, .not. regular, 'two equal rows')
   end subroutine singular

   subroutine eigen(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      real(wp) :: a(2, 2), b(2, 2), w(2)

      ! K = [6 -2; -2 4], M = diag(2, 1): w^2 - 7 w + 10 = 0.
      a = reshape([6.0_wp, -2.0_wp, 99.0_wp, 4.0_wp], [2, 2])
      b = reshape([2.0_wp, 0.0_wp, 99.0_wp, 1.0_wp], [2, 2])
      call solve_eigen(a, b, w, outcome)
      call check_passed(error, outcome, 'eigenproblem')
      call check_close(error, w, [2.0_wp, 5.0_wp], 1.0e-14_wp, 0.0_wp, 'eigenvalues')
      call check_close(error, a(1, :)/a(2, :), [1.0_wp, -0.5_wp], 1.0e-14_wp, 0.0_wp, 'shapes')
      call check_close(error, 2.0_wp*a(1, :)**2 + a(2, :)**2, [1.0_wp, 1.0_wp], 1.0e-14_wp, 0.0_wp, &
                       'modal masses')
   end subroutine eigen

   subroutine bad_mass(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      real(wp) :: a(2, 2), b(2, 2), w(2)

      a = two_by_two
      b = reshape([1.0_wp, 0.0_wp, 0.0_wp, -1.0_wp], [2, 2])
      call solve_eigen(a, b, w, outcome)
      call check_failed(error, outcome, analysis_failed, 'mass matrix is not positive')
      call check_failed(error, outcome, analysis_failed, 'leading minor 2')
   end subroutine bad_mass

end module test_linalg
