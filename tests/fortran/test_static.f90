!> The static path, event to event: closed forms, and bands against full matrices. What a user sees of it is
!> proved in tests/python/test_static.py and test_invariants.py.
module test_static
   use dense, only: is_positive, solve_general
   use check, only: unit_test, check_close, check_failed, check_passed, check_true
   use rbs_base_error, only: error_type, analysis_failed
   use rbs_base_kinds, only: wp
   use rbs_structure_column_chain_matrices, only: geometric_stiffness
   use rbs_structure_column_column, only: column_type
   use rbs_hysteresis_springs, only: spring_array
   use rbs_output_summary, only: summary_type
   use rbs_solve_static_chain_equilibrium, only: chain_equilibrium
   use rbs_structure_column_column_record, only: column_record
   use runs, only: run_path
   use samples, only: bilinear, chain, column_1, elastic, made, random_type, k_c, d_y, k_u, s_k, s_d, height_1
   use row_places, only: row_displacement, row_force, row_axial, row_joints, row_top
   implicit none
   private

   public :: collect_static

contains

   subroutine collect_static(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('pdelta: elastic column below and beyond its critical load', pdelta_elastic), &
               unit_test('a mechanism of joints shares the motion by their stiffness', mechanism), &
               unit_test('bands and full matrices give the same line', bands), &
               unit_test('rates that are updated are those that are solved for', updated_rates), &
               unit_test('a mechanism in a band', band_mechanism), &
               unit_test('height of the top, largest rotation', height_of_top), &
               unit_test('a force that is that of yield but for its last digits', nearly_yield)]
   end subroutine collect_static

   !> Below the critical load, and beyond it, where the column pushes against the support at its top.
   subroutine pdelta_elastic(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      real(wp), allocatable :: rows(:, :)
      real(wp), parameter :: load(2) = [5.0e7_wp, 2.0e8_wp], x(2) = [0.01_wp, -0.03_wp]
      real(wp) :: force(2)
      integer :: i

      do i = 1, 2
         spec = column_1('pdelta')
         spec%axial_load = load(i)
         spec%shear(1) = elastic(s_k)
         spec%flexure(1) = elastic(k_c)
         call run_path(spec, .false., x, rows, outcome)
         call check_passed(error, outcome, 'driven by displacement')
         call check_close(error, x/rows(row_force, :), spread(1.0_wp/s_k + height_1**2/(k_c &
                          - load(i)*height_1), 1, 2), 1.0e-12_wp, 0.0_wp, 'flexibility')
         force = rows(row_force, :)
         call run_path(spec, .true., force, rows, outcome)
         if (i == 1) then
            call check_passed(error, outcome, 'driven by force')
            call check_close(error, rows(row_displacement, :), x, 1.0e-13_wp, 0.0_wp, 'displacement')
         else
            call check_failed(error, outcome, analysis_failed, &
                              'times the critical load of the uncracked column')
         end if
      end do
   end subroutine pdelta_elastic

   !> Joints of equal strength: the motion is distributed as by hardening in proportion to the stiffness.
   subroutine mechanism(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      real(wp), allocatable :: rows(:, :)
      real(wp), parameter :: ratio(2) = [1.0_wp, 3.0_wp]
      integer :: i

      do i = 1, 2
         spec = column_1('small')
         spec%n = 2
         spec%shear = [bilinear(s_k, s_d, 0.0_wp), bilinear(ratio(i)*s_k, s_d/ratio(i), 0.0_wp)]
         spec%flexure(1) = elastic(k_c)
         call run_path(spec, .false., [0.01_wp, 0.02_wp], rows, outcome)
         call check_passed(error, outcome, 'static path')
         if (allocated(error)) return
         call check_close(error, rows(row_joints:row_joints + 1, 2) - rows(row_joints:row_joints + 1, 1), &
                          [ratio(i), 1.0_wp]/(1.0_wp + ratio(i))*0.01_wp, 1.0e-10_wp, 0.0_wp, 'slips')
         call check_close(error, rows(row_force, :), [s_k*s_d, s_k*s_d], 1.0e-12_wp, 0.0_wp, 'force')
      end do
   end subroutine mechanism

   !> Springs of a column on lines through zero.
   subroutine put_on_lines(column, k, f0, springs)
      class(column_type), intent(in) :: column
      !> Stiffness, and forces without deformation
      real(wp), intent(in) :: k(:), f0(:)
      type(spring_array), intent(out) :: springs
      integer :: heard(size(k))
      real(wp) :: axial_load(size(k))

      heard = 0
      axial_load = 0.0_wp
      call springs%create(column%rules, heard, axial_load)
      springs%k = k
      springs%f0 = f0
      springs%d0 = 0.0_wp
   end subroutine put_on_lines

   !> One spring after the other changes its stiffness, most of them several times in a row.
   subroutine updated_rates(error)
      type(error_type), allocatable, intent(inout) :: error
      type(chain_equilibrium) :: solved, updated
      type(random_type) :: random
      type(spring_array) :: springs
      class(column_type), allocatable :: column
      type(column_record) :: spec
      real(wp), dimension(4) :: k, none, rate, rate_updated
      integer :: change, spring, updates
      logical :: regular

      spec = chain(2, 'pdelta')
      spec%axial_load = 2.0e6_wp
      column = made(spec)
      call updated%create(column)
      call solved%create(column)
      k = column%initial_stiffness
      none = 0.0_wp
      updates = 0
      do change = 1, 400
         spring = 1 + modulo(change/30, 4)
         k(spring) = column%initial_stiffness(spring)*10.0_wp**random%uniform(-3.0_wp, 0.0_wp)
         call put_on_lines(column, k, none, springs)
         call solved%follow(springs, .false., .true., 0.0_wp, 0.0_wp, rate, regular)
         call check_true(error, regular, 'the column has a line')
         call updated%follow(springs, .false., .false., 0.0_wp, 0.0_wp, rate_updated, regular)
         if (any(abs(rate_updated - rate) > 0.0_wp)) updates = updates + 1
         call check_close(error, rate_updated, rate, 1.0e-11_wp, 1.0e-11_wp*maxval(abs(rate)), 'rates')
         call check_close(error, updated%force_rate, solved%force_rate, 1.0e-11_wp, 0.0_wp, &
                          'rate of the force')
      end do
      call check_true(error, updates > 100, 'many updates')
   end subroutine updated_rates

   !> Random stiffness on both sides of the loss of stability, residuals, gap; few bodies.
   subroutine bands(error)
      type(error_type), allocatable, intent(inout) :: error
      type(chain_equilibrium) :: band
      type(random_type) :: random
      type(spring_array) :: springs
      class(column_type), allocatable :: column
      type(column_record) :: spec
      real(wp), allocatable, dimension(:) :: k, r, rate, correction, rate_band
      real(wp) :: gap, force(2), largest(2)
      logical :: regular, regular_band
      integer :: stable, unstable, i, j, n

      stable = 0
      unstable = 0
      do n = 1, 12
         spec = chain(n, 'pdelta')
         spec%self_weight = .true.
         do j = 1, 20
            spec%axial_load = random%uniform(-4.0e7_wp, 4.0e7_wp)/n
            column = made(spec)
            call band%create(column)
            k = column%initial_stiffness*[(10.0_wp**random%uniform(-3.0_wp, 0.0_wp), i=1, 2*n)]
            r = [(random%uniform(-1.0_wp, 1.0_wp), i=1, 2*n)]
            gap = random%uniform(-1.0e-6_wp, 1.0e-6_wp)
            allocate (rate(2*n), correction(2*n), rate_band(2*n))
            ! Without deformations the residual is what the springs have of forces.
            call put_on_lines(column, k, -r, springs)
            call follow_displacement()
            call band%follow(springs, .false., .true., gap, 0.0_wp, rate_band, regular_band)
            call check_true(error, regular .and. regular_band, 'both have an answer')
            call compare('displacement')
            call check_close(error, band%force_rate, force(1), 1.0e-8_wp, 1.0e-12_wp*s_k, 'rate of the force')
            call follow_force()
            call band%follow(springs, .true., .true., 0.0_wp, 0.0_wp, rate_band, regular_band)
            call check_true(error, regular_band .eqv. regular, 'both are stable, or none')
            if (regular) call compare('force')
            if (regular) stable = stable + 1
            if (.not. regular) unstable = unstable + 1
            deallocate (rate, correction, rate_band)
         end do
      end do
      call check_true(error, stable > 40 .and. unstable > 40, 'stable and unstable columns')

   contains

      !> The tangent as a full matrix.
      subroutine fill(a)
         real(wp), intent(out) :: a(2*n, 2*n)

         call geometric_stiffness(column, a)
         do i = 1, 2*n
            a(i, i) = a(i, i) + k(i)
         end do
      end subroutine fill

      subroutine follow_displacement()
         real(wp) :: a(2*n + 1, 2*n + 1), b(2*n + 1, 2)

         a = 0.0_wp
         call fill(a(:2*n, :2*n))
         a(:2*n, 2*n + 1) = -column%arm
         a(2*n + 1, :2*n) = column%arm
         b(:, 1) = 0.0_wp
         b(:2*n, 2) = r
         b(2*n + 1, :) = [1.0_wp, gap]
         call solve_general(a, b, regular)
         rate = b(:2*n, 1)
         correction = b(:2*n, 2)
         force = b(2*n + 1, :)
      end subroutine follow_displacement

      subroutine follow_force()
         real(wp) :: a(2*n, 2*n), b(2*n, 2)

         call fill(a)
         regular = is_positive(a)
         if (.not. regular) return
         b(:, 1) = column%arm
         b(:, 2) = r
         call solve_general(a, b, regular)
         rate = b(:, 1)
         correction = b(:, 2)
      end subroutine follow_force

      !> Slips and rotations relative to the largest, as the residual has entries of different size.
      subroutine compare(drive)
         character(len=*), intent(in) :: drive

         do i = 1, 2
            associate (first => (i - 1)*n + 1, last => i*n)
               largest = [maxval(abs(rate(first:last))), maxval(abs(correction(first:last)))]
               call check_close(error, rate_band(first:last), rate(first:last), 0.0_wp, &
                                1.0e-10_wp*largest(1), 'rates by '//drive)
               call check_close(error, band%correction(first:last), correction(first:last), 0.0_wp, &
                                1.0e-10_wp*largest(2), 'corrections by '//drive)
            end associate
         end do
      end subroutine compare

   end subroutine bands

   !> The spring stands on the end of its line, so that the joints move the top a little farther.
   subroutine nearly_yield(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      real(wp), allocatable :: rows(:, :)
      real(wp), parameter :: nearly = 1.0_wp - 5.0e-12_wp

      spec = column_1('small')
      spec%shear(1) = elastic(s_k)
      spec%flexure(1) = bilinear(k_c, d_y, k_u)
      call run_path(spec, .true., [0.5_wp, nearly]*k_c*d_y/height_1, rows, outcome)
      call check_passed(error, outcome, 'path to yield')
      if (allocated(error)) return
      call check_close(error, rows(row_displacement, 2), &
                       nearly*k_c*d_y*(height_1/k_c + 1.0_wp/(s_k*height_1)), 1.0e-12_wp, 0.0_wp, &
                       'displacement')
   end subroutine nearly_yield

   !> The shear spring of the base has no stiffness left: its row of K is zero, and K has no inverse.
   subroutine band_mechanism(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      real(wp), allocatable :: rows(:, :)
      integer :: i, n

      do n = 1, 5
         spec = chain(n, 'pdelta')
         spec%axial_load = 1.0e5_wp
         spec%shear(1) = bilinear(1.0e8_wp, 1.0e-3_wp, 0.0_wp)
         call run_path(spec, .false., [0.01_wp, 0.05_wp], rows, outcome)
         call check_passed(error, outcome, 'static path')
         if (allocated(error)) return
         call check_close(error, rows(row_force, :), [1.0e5_wp, 1.0e5_wp], 1.0e-12_wp, 0.0_wp, 'force')
         call check_close(error, rows(row_joints, 2) - rows(row_joints, 1), 0.04_wp, 1.0e-11_wp, 0.0_wp, &
                          'the base slips')
         do i = 1, 2*n - 1
            call check_close(error, rows(row_joints + i, 2), rows(row_joints + i, 1), 1.0e-9_wp, 0.0_wp, &
                             'the other springs do not move')
         end do
      end do
   end subroutine band_mechanism

   subroutine height_of_top(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      class(column_type), allocatable :: column
      type(summary_type) :: summary
      real(wp), allocatable :: rows(:, :)
      real(wp) :: turn(3)

      spec = chain(3, 'small')
      call run_path(spec, .false., [0.1_wp, -0.05_wp], rows, outcome, summary=summary)
      call check_passed(error, outcome, 'small')
      call check_close(error, rows(row_top, :), [2.0_wp, 2.0_wp], 1.0e-15_wp, 0.0_wp, 'height')
      turn = [rows(row_joints + 3, 1), sum(rows(row_joints + 3:row_joints + 4, 1)), &
              sum(rows(row_joints + 3:row_joints + 5, 1))]
      call check_close(error, summary%peak_rotation, maxval(abs(turn)), 1.0e-14_wp, 0.0_wp, &
                       'largest rotation')
      spec%kinematics = 'pdelta'
      spec%axial_load = 1.0e6_wp
      column = made(spec)
      call run_path(spec, .false., [0.1_wp], rows, outcome)
      call check_passed(error, outcome, 'pdelta')
      turn = [rows(row_joints + 3, 1), sum(rows(row_joints + 3:row_joints + 4, 1)), &
              sum(rows(row_joints + 3:row_joints + 5, 1))]
      call check_close(error, rows(row_top, 1), 2.0_wp - sum(0.5_wp*column%length*turn**2) &
                       - sum(rows(row_joints + 1:row_joints + 2, 1)*turn(:2)), 1.0e-15_wp, 0.0_wp, 'height')
      call check_close(error, rows(row_axial, 1), 1.0e6_wp*(rows(row_top, 1) - 2.0_wp), 1.0e-10_wp, 0.0_wp, &
                       'work of the axial load')
   end subroutine height_of_top

end module test_static
