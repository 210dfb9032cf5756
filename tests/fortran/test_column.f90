!> Geometry, mass matrix in both forms, axial forces: against sums from the equations of theory.md.
module test_column
   use dense, only: factor_positive
   use check, only: unit_test, check_close, check_equal, check_failed, check_passed, check_same, check_true
   use rbs_base_error, only: error_type, bad_input
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_structure_column_sturm, only: critical_factor, check_stable
   use rbs_structure_column_chain, only: geometric_forces
   use rbs_structure_column_column, only: column_type, small, pdelta, finite
   use rbs_structure_column_chain_matrices, only: symmetric_mass, paper_mass, geometric_stiffness
   use rbs_structure_column_column_record, only: column_record
   use rbs_structure_spring_place, only: spring_name
   use samples, only: value_of, chain, column_1, elastic, made, random_type, k_c, s_k, mass_1, height_1
   implicit none
   private

   public :: collect_column

   integer, parameter :: n = 5

contains

   subroutine collect_column(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('one body: defaults', one_body), &
               unit_test('equal bodies from height and mass', equal_bodies), &
               unit_test('lever arms of the top and of the ground', arms), &
               unit_test('levels of kinematics', levels), &
               unit_test('one spring for every joint, or one for each', spring_places), &
               unit_test('symmetric mass matrix against its definition', symmetric_definition), &
               unit_test('paper mass matrix against eqs 1 and 2', paper_definition), &
               unit_test('M_symmetric = M_paper L', two_views), &
               unit_test('the mass matrix is positive definite', mass_positive), &
               unit_test('rigid translation moves the total mass', translation), &
               unit_test('geometric stiffness is the height of the load to second order', potential), &
               unit_test('geometric forces are K_G q', forces), &
               unit_test('no axial work with small kinematics', no_axial), &
               unit_test('critical load of one body is k_M/l', critical_one), &
               unit_test('at the critical load the stiffness is singular', critical_chain), &
               unit_test('tension has no critical load', tension), &
               unit_test('a column that buckles by itself is refused', buckling), &
               unit_test('a mass lumped at the top is part of the last body', lumped), &
               unit_test('rotary inertia: default, depth of the section, given', rotary), &
               unit_test('axial forces of load and weight, body by body', weights), &
               unit_test('axial forces per vertical acceleration', lifted), &
               unit_test('joints that open', opening), &
               unit_test('names of the springs', names)]
   end subroutine collect_column

   subroutine one_body(error)
      type(error_type), allocatable, intent(inout) :: error
      class(column_type), allocatable :: column

      column = made(column_1('small'))
      call check_equal(error, column%n, 1, 'bodies')
      call check_equal(error, column%unknowns, 2, 'unknowns')
      call check_same(error, [column%length, column%mass], [height_1, mass_1], 'length and mass')
      call check_close(error, column%inertia, [mass_1*height_1**2/12.0_wp], 1.0e-15_wp, 0.0_wp, &
                       'misprint E4: the inertia is m l^2/12')
      call check_same(error, column%initial_stiffness, [s_k, k_c], 'initial stiffness')
   end subroutine one_body

   subroutine equal_bodies(error)
      type(error_type), allocatable, intent(inout) :: error
      type(column_record) :: spec
      class(column_type), allocatable :: column

      spec = column_1('small')
      spec%n = 4
      column = made(spec)
      call check_close(error, column%length, spread(height_1/4, 1, 4), 1.0e-15_wp, 0.0_wp, 'lengths')
      call check_close(error, column%mass, spread(mass_1/4, 1, 4), 1.0e-15_wp, 0.0_wp, 'masses')
   end subroutine equal_bodies

   subroutine arms(error)
      type(error_type), allocatable, intent(inout) :: error
      class(column_type), allocatable :: column
      real(wp) :: b(2*n)
      integer :: i, k

      column = made(chain(n, 'small'))
      call check_close(error, column%arm(:n), spread(1.0_wp, 1, n), 0.0_wp, 0.0_wp, 'slips')
      b = 0.0_wp
      do i = 1, n
         call check_close(error, column%arm(n + i), sum(column%length(i:)), 1.0e-15_wp, 0.0_wp, 'rotations')
         do k = i, n
            b(i) = b(i) + column%mass(k)
            b(n + i) = b(n + i) + column%mass(k)*height(column, k, i)
         end do
      end do
      call check_close(error, column%ground_arm, b, 1.0e-14_wp, 0.0_wp, 'ground')
      call check_close(error, column%joint_height(n + 1), 2.0_wp, 1.0e-15_wp, 0.0_wp, 'height of the top')
   end subroutine arms

   subroutine levels(error)
      type(error_type), allocatable, intent(inout) :: error
      class(column_type), allocatable :: column

      column = made(column_1('small'))
      call check_equal(error, column%kinematics, small, 'small')
      column = made(column_1('pdelta'))
      call check_equal(error, column%kinematics, pdelta, 'pdelta')
      column = made(column_1('finite'))
      call check_equal(error, column%kinematics, finite, 'finite')
   end subroutine levels

   subroutine spring_places(error)
      type(error_type), allocatable, intent(inout) :: error
      type(column_record) :: spec
      class(column_type), allocatable :: column
      integer :: i

      spec = chain(3, 'small')
      column = made(spec)
      do i = 1, 3
         call check_same(error, value_of(column%spring(i), 'k'), value_of(spec%shear(i), 'k'), &
                         'shear of a joint')
         call check_same(error, value_of(column%spring(3 + i), 'k'), value_of(spec%flexure(i), 'k'), &
                         'flexure of a joint')
      end do
      spec%shear = spec%shear(2:2)
      column = made(spec)
      call check_same(error, [(value_of(column%spring(i), 'k'), i=1, 3)], &
                      spread(value_of(spec%shear(1), 'k'), 1, 3), &
                      'one for every joint')
   end subroutine spring_places

   !> Height of centroid k above joint i, k >= i (theory.md section 3).
   pure real(wp) function height(column, k, i)
      class(column_type), intent(in) :: column
      integer, intent(in) :: k, i

      height = sum(column%length(i:k - 1)) + 0.5_wp*column%length(k)
   end function height

   subroutine symmetric_definition(error)
      type(error_type), allocatable, intent(inout) :: error
      class(column_type), allocatable :: column
      real(wp) :: mass(2*n, 2*n), expected(2*n, 2*n)
      integer :: i, j, k

      column = made(chain(n, 'small'))
      expected = 0.0_wp
      do j = 1, n
         do i = 1, n
            do k = max(i, j), n
               associate (m => column%mass(k), h_i => height(column, k, i), h_j => height(column, k, j))
                  expected(i, j) = expected(i, j) + m
                  expected(i, n + j) = expected(i, n + j) + m*h_j
                  expected(n + i, j) = expected(n + i, j) + m*h_i
                  expected(n + i, n + j) = expected(n + i, n + j) + m*h_i*h_j + column%inertia(k)
               end associate
            end do
         end do
      end do
      call symmetric_mass(column, mass)
      call check_close(error, pack(mass, .true.), pack(expected, .true.), 1.0e-14_wp, 0.0_wp, 'entry')
      call check_same(error, pack(mass, .true.), pack(transpose(mass), .true.), 'symmetry')
   end subroutine symmetric_definition

   !> Horizontal equilibrium of everything above joint i, and its moment about joint i, with
   !> x_k'' = sum of u_j'' (j <= k) + sum of l~_kj th_j'', l~_kj = l_j below k, l_k/2 for k, 0 above.
   subroutine paper_definition(error)
      type(error_type), allocatable, intent(inout) :: error
      class(column_type), allocatable :: column
      real(wp) :: mass(2*n, 2*n), expected(2*n, 2*n), lever
      integer :: i, j, k

      column = made(chain(n, 'small'))
      expected = 0.0_wp
      do i = 1, n
         do k = i, n
            do j = 1, k
               lever = column%length(j)
               if (j == k) lever = 0.5_wp*lever
               associate (m => column%mass(k), h => height(column, k, i))
                  expected(i, j) = expected(i, j) + m
                  expected(n + i, j) = expected(n + i, j) + m*h
                  expected(i, n + j) = expected(i, n + j) + m*lever
                  expected(n + i, n + j) = expected(n + i, n + j) + m*h*lever
               end associate
            end do
            expected(n + i, n + k) = expected(n + i, n + k) + column%inertia(k)
         end do
      end do
      call paper_mass(column, mass)
      call check_close(error, pack(mass, .true.), pack(expected, .true.), 1.0e-14_wp, 0.0_wp, 'entry')
   end subroutine paper_definition

   subroutine two_views(error)
      type(error_type), allocatable, intent(inout) :: error
      class(column_type), allocatable :: column
      real(wp) :: from_relative(2*n, 2*n), symmetric(2*n, 2*n), paper(2*n, 2*n)
      integer :: i

      column = made(chain(n, 'small'))
      from_relative = 0.0_wp
      do i = 1, n
         from_relative(i, i) = 1.0_wp
         from_relative(n + i, n + 1:n + i) = 1.0_wp
      end do
      call symmetric_mass(column, symmetric)
      call paper_mass(column, paper)
      call check_close(error, pack(matmul(paper, from_relative), .true.), pack(symmetric, .true.), &
                       1.0e-14_wp, 0.0_wp, 'entry')
   end subroutine two_views

   subroutine mass_positive(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp), allocatable :: mass(:, :)
      class(column_type), allocatable :: column
      integer :: i
      integer, parameter :: bodies(4) = [1, 2, 20, 200]
      logical :: positive

      do i = 1, size(bodies)
         column = made(chain(bodies(i), 'small'))
         if (allocated(mass)) deallocate (mass)
         allocate (mass(2*bodies(i), 2*bodies(i)))
         call symmetric_mass(column, mass)
         call factor_positive(mass, positive)
         call check_true(error, positive, 'n = '//to_text(bodies(i)))
      end do
   end subroutine mass_positive

   subroutine translation(error)
      type(error_type), allocatable, intent(inout) :: error
      class(column_type), allocatable :: column
      real(wp) :: mass(2*n, 2*n), shape(2*n)

      column = made(chain(n, 'small'))
      call symmetric_mass(column, mass)
      shape = 0.0_wp
      shape(1) = 1.0_wp
      call check_close(error, dot_product(shape, matmul(mass, shape)), sum(column%mass), 1.0e-14_wp, &
                       0.0_wp, 'slip of the base')
      call check_close(error, matmul(mass, shape), column%ground_arm, 1.0e-14_wp, 0.0_wp, &
                       'it is the load of the ground')
      ! About the base: sum of m (h^2 + l^2/12) as for a rigid rod of bodies.
      call check_close(error, mass(n + 1, n + 1), rod(column), 1.0e-14_wp, 0.0_wp, 'rotation of the base')
   end subroutine translation

   real(wp) function rod(column)
      class(column_type), intent(in) :: column
      integer :: k

      rod = 0.0_wp
      do k = 1, n
         rod = rod + column%mass(k)*(height(column, k, 1)**2 + column%length(k)**2/12.0_wp)
      end do
   end function rod

   !> A chain with axial load and weight.
   function loaded() result(column)
      class(column_type), allocatable :: column
      type(column_record) :: spec

      spec = chain(n, 'pdelta')
      spec%axial_load = 3.0e5_wp
      spec%self_weight = .true.
      spec%gravity = 50.0_wp
      column = made(spec)
   end function loaded

   !> Potential P y_T + sum m_k g y_k with the heights to second order (theory.md section 3).
   subroutine potential(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      class(column_type), allocatable :: column
      real(wp) :: q(2*n), energy, theta, height_now
      integer :: i, k

      column = loaded()
      do i = 1, 2*n
         q(i) = random%uniform(-0.1_wp, 0.1_wp)
      end do
      energy = 0.0_wp
      theta = 0.0_wp
      height_now = 0.0_wp
      do k = 1, n
         height_now = height_now - q(k)*theta
         theta = theta + q(n + k)
         energy = energy + 50.0_wp*column%mass(k)*(height_now - 0.25_wp*column%length(k)*theta**2)
         height_now = height_now - 0.5_wp*column%length(k)*theta**2
      end do
      energy = energy + 3.0e5_wp*height_now
      call check_close(error, column%potential_energy(q), energy, 1.0e-13_wp, 0.0_wp, 'energy')
   end subroutine potential

   subroutine forces(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      class(column_type), allocatable :: column
      real(wp) :: q(2*n), g(2*n), stiffness(2*n, 2*n)
      integer :: i

      column = loaded()
      do i = 1, 2*n
         q(i) = random%uniform(-0.1_wp, 0.1_wp)
      end do
      call geometric_stiffness(column, stiffness)
      call geometric_forces(column%n, column%length, [column%axial_body, column%axial_slip], &
                               q, g)
      call check_close(error, g, matmul(stiffness, q), 1.0e-12_wp, 0.0_wp, 'force')
      call check_close(error, column%potential_energy(q), 0.5_wp*dot_product(q, g), 1.0e-13_wp, 0.0_wp, &
                       'energy is half of q K_G q')
      call check_same(error, pack(stiffness, .true.), pack(transpose(stiffness), .true.), 'symmetry')
   end subroutine forces

   subroutine no_axial(error)
      type(error_type), allocatable, intent(inout) :: error
      class(column_type), allocatable :: column
      type(column_record) :: spec
      real(wp) :: factor

      spec = column_1('small')
      spec%axial_load = 1.0e12_wp
      column = made(spec)
      call check_true(error, .not. column%axially_loaded, 'small')
      call critical_factor(column, factor)
      call check_same(error, factor, huge(1.0_wp), 'critical factor')
      column = made(column_1('pdelta'))
      call check_true(error, .not. column%axially_loaded, 'pdelta without load')
   end subroutine no_axial

   subroutine critical_one(error)
      type(error_type), allocatable, intent(inout) :: error
      type(column_record) :: spec
      real(wp) :: factor

      spec = column_1('pdelta')
      spec%axial_load = 1.0e6_wp
      call critical_factor(made(spec), factor)
      call check_close(error, factor*spec%axial_load, k_c/height_1, 1.0e-14_wp, 0.0_wp, 'critical load')
      ! The weight alone: m g acts at half of the height.
      spec%axial_load = 0.0_wp
      spec%self_weight = .true.
      call critical_factor(made(spec), factor)
      call check_close(error, factor*spec%gravity, 2.0_wp*k_c/(mass_1*height_1), 1.0e-14_wp, 0.0_wp, &
                       'critical gravity')
   end subroutine critical_one

   subroutine critical_chain(error)
      type(error_type), allocatable, intent(inout) :: error
      class(column_type), allocatable :: column
      real(wp) :: factor, stiffness(2*n, 2*n), share(2)
      logical :: positive(2)
      integer :: i, j

      column = loaded()
      call critical_factor(column, factor)
      share = [1.0_wp - 1.0e-10_wp, 1.0_wp + 1.0e-10_wp]
      do j = 1, 2
         call geometric_stiffness(column, stiffness)
         stiffness = share(j)*factor*stiffness
         do i = 1, 2*n
            stiffness(i, i) = stiffness(i, i) + column%initial_stiffness(i)
         end do
         call factor_positive(stiffness, positive(j))
      end do
      call check_true(error, positive(1), 'stable just below')
      call check_true(error, .not. positive(2), 'unstable just above')
   end subroutine critical_chain

   subroutine tension(error)
      type(error_type), allocatable, intent(inout) :: error
      type(column_record) :: spec
      type(error_type), allocatable :: outcome
      real(wp) :: factor

      spec = column_1('pdelta')
      spec%axial_load = -1.0e9_wp
      call critical_factor(made(spec), factor)
      call check_same(error, factor, huge(1.0_wp), 'critical factor')
      call check_stable(made(spec), outcome)
      call check_passed(error, outcome, 'check_stable')
   end subroutine tension

   subroutine buckling(error)
      type(error_type), allocatable, intent(inout) :: error
      type(column_record) :: spec
      type(error_type), allocatable :: outcome

      spec = column_1('pdelta')
      spec%axial_load = 0.999_wp*k_c/height_1
      call check_stable(made(spec), outcome)
      call check_passed(error, outcome, 'just below')
      spec%axial_load = 2.0e8_wp
      call check_stable(made(spec), outcome)
      call check_failed(error, outcome, bad_input, 'the axial load of 2e+08 N at the base')
      call check_failed(error, outcome, bad_input, 'the critical load of '//to_text(k_c/height_1)//' N')
   end subroutine buckling

   !> Parallel axes: the body's mass at mid-length and a point with inertia at the top, about their common
   !> centroid; and the mass matrix with the two kept separate.
   subroutine lumped(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp), parameter :: m = 700.0_wp, j = 35.0_wp
      type(column_record) :: spec
      class(column_type), allocatable :: column, plain
      real(wp) :: mass(2*n, 2*n), without(2*n, 2*n), expected(2*n, 2*n), own, l, centroid
      integer :: a, b

      spec = chain(n, 'pdelta')
      plain = made(spec)
      spec%top_mass = m
      spec%top_inertia = j
      column = made(spec)
      own = spec%masses(n)
      l = spec%lengths(n)
      centroid = (own*0.5_wp*l + m*l)/(own + m)
      call check_close(error, column%mass(n), own + m, 1.0e-15_wp, 0.0_wp, 'mass')
      call check_close(error, [column%lower(n), column%upper(n)], [centroid, l - centroid], 1.0e-14_wp, &
                       0.0_wp, 'centroid')
      call check_close(error, column%inertia(n), own*l**2/12.0_wp + own*(centroid - 0.5_wp*l)**2 &
                       + m*(l - centroid)**2 + j, 1.0e-14_wp, 0.0_wp, 'inertia')
      call check_same(error, column%mass(:n - 1), plain%mass(:n - 1), 'the other bodies')
      call check_same(error, column%lower(:n - 1), plain%lower(:n - 1), 'their centroids')
      ! The point moves with the displacement arm of the top and the sum of the rotations.
      call symmetric_mass(column, mass)
      call symmetric_mass(plain, without)
      do b = 1, 2*n
         do a = 1, 2*n
            expected(a, b) = without(a, b) + m*column%arm(a)*column%arm(b)
            if (a > n .and. b > n) expected(a, b) = expected(a, b) + j
         end do
      end do
      call check_close(error, pack(mass, .true.), pack(expected, .true.), 1.0e-13_wp, 0.0_wp, 'mass matrix')
      call check_close(error, column%ground_arm, plain%ground_arm + m*column%arm, 1.0e-14_wp, 0.0_wp, &
                       'ground')
      ! Its weight is not part of the column's.
      spec%self_weight = .true.
      column = made(spec)
      spec%top_mass = 0.0_wp
      spec%top_inertia = 0.0_wp
      plain = made(spec)
      call check_same(error, column%axial_body, plain%axial_body, 'the weight belongs to the axial load')
      call check_same(error, column%weight, plain%weight, 'weight')
   end subroutine lumped

   subroutine rotary(error)
      type(error_type), allocatable, intent(inout) :: error
      type(column_record) :: spec
      class(column_type), allocatable :: column

      spec = chain(n, 'small')
      column = made(spec)
      call check_close(error, column%inertia, spec%masses*spec%lengths**2/12.0_wp, 1.0e-15_wp, 0.0_wp, 'rods')
      spec%depth = 0.55_wp
      column = made(spec)
      call check_close(error, column%inertia, spec%masses*(spec%lengths**2 + 0.55_wp**2)/12.0_wp, &
                       1.0e-15_wp, 0.0_wp, 'blocks')
      spec%depth = 0.0_wp
      spec%rotary_inertia = [7.0_wp]
      column = made(spec)
      call check_same(error, column%inertia, spread(7.0_wp, 1, n), 'one for all')
      spec%rotary_inertia = [1.0_wp, 2.0_wp, 3.0_wp, 4.0_wp, 5.0_wp]
      column = made(spec)
      call check_same(error, column%inertia, spec%rotary_inertia, 'one for each')
   end subroutine rotary

   subroutine weights(error)
      type(error_type), allocatable, intent(inout) :: error
      type(column_record) :: spec
      class(column_type), allocatable :: column
      integer :: i

      spec = chain(n, 'pdelta')
      spec%axial_load = 1000.0_wp
      spec%self_weight = .true.
      spec%gravity = 10.0_wp
      column = made(spec)
      do i = 1, n
         call check_close(error, column%axial_joint(i), 1000.0_wp + 10.0_wp*sum(spec%masses(i:)), &
                          1.0e-14_wp, 0.0_wp, 'in a joint: all above')
         call check_close(error, column%axial_body(i), 1000.0_wp + 10.0_wp*(sum(spec%masses(i:)) &
                                                                          - 0.5_wp*spec%masses(i)), &
                          1.0e-14_wp, 0.0_wp, 'of a body: half of its own weight')
         call check_close(error, column%spring(n + i)%axial_load, column%axial_joint(i), 1.0e-14_wp, &
                          0.0_wp, 'what the layers of a joint carry')
         call check_close(error, column%weight(i), 10.0_wp*spec%masses(i), 1.0e-15_wp, 0.0_wp, 'weight')
      end do
      call check_true(error, column%axially_loaded, 'loaded')
      spec%self_weight = .false.
      column = made(spec)
      call check_same(error, [column%axial_joint, column%axial_body], spread(1000.0_wp, 1, 2*n), 'load alone')
      call check_same(error, column%weight, spread(0.0_wp, 1, n), 'no weight')
   end subroutine weights

   !> A vertical acceleration a of the ground is a weight of all masses, the lumped one included.
   subroutine lifted(error)
      type(error_type), allocatable, intent(inout) :: error
      type(column_record) :: spec
      class(column_type), allocatable :: column
      integer :: i

      spec = chain(n, 'pdelta')
      spec%top_mass = 400.0_wp
      column = made(spec)
      do i = 1, n
         call check_close(error, column%lifted_joint(i), 400.0_wp + sum(spec%masses(i:)), 1.0e-14_wp, &
                          0.0_wp, 'joint')
         call check_close(error, column%lifted_body(i), &
                          400.0_wp + sum(spec%masses(i:)) - 0.5_wp*spec%masses(i), 1.0e-14_wp, 0.0_wp, 'body')
      end do
   end subroutine lifted

   subroutine opening(error)
      type(error_type), allocatable, intent(inout) :: error
      type(column_record) :: spec
      class(column_type), allocatable :: column, plain
      real(wp) :: mass(3*n, 3*n), lateral(2*n, 2*n)
      integer :: i, j

      spec = chain(n, 'small')
      plain = made(spec)
      allocate (spec%axial_spring(n))
      spec%axial_spring = [(elastic(1.0e9_wp*i), i=1, n)]
      column = made(spec)
      call check_equal(error, column%unknowns, 3*n, 'unknowns')
      call check_true(error, column%opens .and. .not. plain%opens, 'opens')
      call check_same(error, column%initial_stiffness(2*n + 1:), [(1.0e9_wp*i, i=1, n)], 'stiffness')
      call check_same(error, column%arm, [plain%arm, spread(0.0_wp, 1, n)], 'arms of the top')
      call check_same(error, column%ground_arm, [plain%ground_arm, spread(0.0_wp, 1, n)], &
                      'arms of the ground')
      call symmetric_mass(column, mass)
      call symmetric_mass(plain, lateral)
      call check_same(error, pack(mass(:2*n, :2*n), .true.), pack(lateral, .true.), 'slip and rotation')
      call check_same(error, pack(mass(2*n + 1:, :2*n), .true.), spread(0.0_wp, 1, 2*n*n), 'not coupled')
      do j = 1, n
         do i = 1, n
            call check_close(error, mass(2*n + i, 2*n + j), sum(spec%masses(max(i, j):)), 1.0e-14_wp, &
                             0.0_wp, 'what an opening lifts')
         end do
      end do
   end subroutine opening

   subroutine names(error)
      type(error_type), allocatable, intent(inout) :: error
      type(column_record) :: spec
      class(column_type), allocatable :: column

      spec = chain(n, 'small')
      allocate (spec%axial_spring(1))
      spec%axial_spring(1) = elastic(1.0e9_wp)
      column = made(spec)
      call check_equal(error, trim(spring_name(column%place(1))), 'the shear spring of joint 1', 'first')
      call check_equal(error, trim(spring_name(column%place(n))), 'the shear spring of joint 5', 'last shear')
      call check_equal(error, trim(spring_name(column%place(n + 1))), 'the flexural spring of joint 1', &
                       'first flexure')
      call check_equal(error, trim(spring_name(column%place(3*n))), 'the axial spring of joint 5', 'last')
   end subroutine names

end module test_column
