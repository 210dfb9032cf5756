!> The chain in centroid coordinates against the dense matrices in slips and rotations.
module test_band
   use check, only: unit_test, check_close
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_structure_column_column, only: column_type
   use rbs_structure_column_chain_matrices, only: symmetric_mass, geometric_stiffness
   use rbs_structure_column_column_record, only: column_record
   use samples, only: chain, elastic, made
   implicit none
   private

   public :: collect_band

contains

   subroutine collect_band(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('a rigid motion deforms the lowest joint only', rigid), &
               unit_test('the mass is diagonal at the centroids', mass_diagonal), &
               unit_test('band of the springs is B''k B', springs), &
               unit_test('band of the axial forces is B''K_G B', geometric), &
               unit_test('openings are not coupled to slips and rotations', openings)]
   end subroutine collect_band

   !> A chain with openings, a mass on top, weight and axial load.
   function full(n) result(column)
      integer, intent(in) :: n
      class(column_type), allocatable :: column
      type(column_record) :: spec
      integer :: i

      spec = chain(n, 'pdelta')
      spec%top_mass = 55.0_wp
      spec%top_inertia = 7.0_wp
      spec%axial_load = 1.0e6_wp
      spec%self_weight = .true.
      spec%gravity = 2.0e3_wp
      allocate (spec%axial_spring(n))
      do i = 1, n
         spec%axial_spring(i) = elastic(1.0e9_wp + 2.0e8_wp*sin(5.0_wp*i))
      end do
      column = made(spec)
   end function full

   !> B by columns.
   subroutine joints_of_bodies(column, b)
      class(column_type), intent(in) :: column
      real(wp), intent(out) :: b(:, :)
      real(wp) :: x(column%unknowns)
      integer :: j

      do j = 1, column%unknowns
         x = 0.0_wp
         x(j) = 1.0_wp
         call column%spring_rates(x, b(:, j))
      end do
   end subroutine joints_of_bodies

   !> The whole matrix of a lower band of half-width 3.
   pure function whole(band) result(a)
      real(wp), intent(in) :: band(:, :)
      real(wp) :: a(size(band, 2), size(band, 2))
      integer :: i, j

      a = 0.0_wp
      do j = 1, size(band, 2)
         do i = j, min(j + 3, size(band, 2))
            a(i, j) = band(1 + i - j, j)
            a(j, i) = a(i, j)
         end do
      end do
   end function whole

   subroutine check_matrix(error, actual, expected, what)
      type(error_type), allocatable, intent(inout) :: error
      real(wp), intent(in) :: actual(:, :), expected(:, :)
      character(len=*), intent(in) :: what

      call check_close(error, pack(actual, .true.), pack(expected, .true.), 0.0_wp, &
                       1.0e-14_wp*maxval(abs(expected)), what)
   end subroutine check_matrix

   subroutine rigid(error)
      type(error_type), allocatable, intent(inout) :: error
      integer, parameter :: n = 5
      class(column_type), allocatable :: column
      real(wp) :: x(3*n), d(3*n), expected(3*n)
      integer :: i

      column = full(n)
      do i = 1, n
         x(2*i - 1) = 0.3_wp + 0.1_wp*(column%joint_height(i) + column%lower(i))
         x(2*i) = 0.1_wp
         x(2*n + i) = 0.2_wp
      end do
      call column%spring_rates(x, d)
      expected = 0.0_wp
      expected([1, n + 1, 2*n + 1]) = [0.3_wp, 0.1_wp, 0.2_wp]
      call check_close(error, d, expected, 0.0_wp, 1.0e-15_wp, 'rigid motion')
   end subroutine rigid

   subroutine mass_diagonal(error)
      type(error_type), allocatable, intent(inout) :: error
      integer, parameter :: n = 5
      class(column_type), allocatable :: column
      real(wp) :: b(3*n, 3*n), mass(3*n, 3*n), expected(3*n, 3*n)
      integer :: i

      column = full(n)
      call joints_of_bodies(column, b)
      call symmetric_mass(column, mass)
      mass = matmul(transpose(b), matmul(mass, b))
      expected = 0.0_wp
      do i = 1, n
         expected(2*i - 1, 2*i - 1) = column%mass(i)
         expected(2*i, 2*i) = column%inertia(i)
         expected(2*n + i, 2*n + i) = column%mass(i)
      end do
      call check_close(error, pack(mass, .true.), pack(expected, .true.), 0.0_wp, 1.0e-11_wp, 'mass')
   end subroutine mass_diagonal

   subroutine springs(error)
      type(error_type), allocatable, intent(inout) :: error
      class(column_type), allocatable :: column
      real(wp), allocatable :: b(:, :), k(:, :), band(:, :)
      integer :: i, n

      do n = 1, 6
         column = full(n)
         if (allocated(b)) deallocate (b, k, band)
         allocate (b(3*n, 3*n))
         allocate (k(3*n, 3*n), band(4, 3*n), source=0.0_wp)
         call joints_of_bodies(column, b)
         do i = 1, 3*n
            k(i, i) = column%initial_stiffness(i)
         end do
         call column%add_stiffness(column%initial_stiffness, band)
         call check_matrix(error, whole(band), matmul(transpose(b), matmul(k, b)), 'stiffness')
      end do
   end subroutine springs

   subroutine geometric(error)
      type(error_type), allocatable, intent(inout) :: error
      class(column_type), allocatable :: column
      real(wp), allocatable :: b(:, :), k(:, :), band(:, :)
      integer :: n

      do n = 1, 6
         column = full(n)
         if (allocated(b)) deallocate (b, k, band)
         allocate (b(3*n, 3*n), k(3*n, 3*n))
         allocate (band(4, 3*n), source=0.0_wp)
         call joints_of_bodies(column, b)
         call geometric_stiffness(column, k)
         call column%add_geometric([column%axial_body, column%axial_joint], band)
         k = matmul(transpose(b), matmul(k, b))
         call check_matrix(error, whole(band), k, 'geometric stiffness')
      end do
   end subroutine geometric

   subroutine openings(error)
      type(error_type), allocatable, intent(inout) :: error
      integer, parameter :: n = 4
      class(column_type), allocatable :: column
      real(wp) :: b(3*n, 3*n)

      column = full(n)
      call joints_of_bodies(column, b)
      call check_close(error, maxval(abs(b(:2*n, 2*n + 1:))), 0.0_wp, 0.0_wp, 0.0_wp, 'not coupled')
      call check_close(error, maxval(abs(b(2*n + 1:, :2*n))), 0.0_wp, 0.0_wp, 0.0_wp, 'not coupled')
   end subroutine openings

end module test_band
