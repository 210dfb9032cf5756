!> The implicit methods with finite rotations: a joint in the coordinates of the bodies, orders, energy, what
!> becomes of them for small rotations, stiff chains.
module test_implicit_finite
   use check, only: unit_test, check_close, check_equal, check_passed, check_same, check_true
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_structure_column_column, only: column_type
   use rbs_solve_time_finite_joint, only: turned_body, turn_body, body_at, joint_type, joint_change, &
                                          joint_at, add_joint_forces, joint_tangent, local
   use rbs_solve_time_implicit, only: new_newmark, new_hht, new_generalised_alpha, with_finite_rotations
   use rbs_solve_time_implicit_finite, only: finite_stepper
   use rbs_loading_loads, only: loads_type, lateral, horizontal, vertical, top_axial
   use rbs_solve_time_state, only: state_type
   use rbs_structure_column_column_record, only: column_record
   use runs, only: scene_type, play, find_reference, new_state, signal_of, check_order, residual_of, distance
   use samples, only: bilinear, chain, elastic, made, random_type, rich_column
   implicit none
   private

   public :: collect_implicit_finite

   !> Bodies of the tests of one joint: distances of the joint from their centroids [m].
   real(wp), parameter :: below = 0.7_wp, above = 0.4_wp

contains

   subroutine collect_implicit_finite(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('changes of slip and opening, from the positions of the bodies', exact_change), &
               unit_test('forces of a joint do the work of its springs', exact_work), &
               unit_test('tangent of a joint, by differences', tangent), &
               unit_test('order 2 for chains with damping, openings and all loads', order_of_chains), &
               unit_test('average acceleration balances the energy, springs that yield included', energy), &
               unit_test('stiff chains with a long step', stiff), &
               unit_test('a step that fails has no effect', no_trace)]
   end subroutine collect_implicit_finite

   type(finite_stepper) function method(number) result(stepper)
      integer, intent(in) :: number

      select case (number)
      case (1)
         stepper = with_finite_rotations(new_newmark())
      case (2)
         stepper = with_finite_rotations(new_hht(0.8_wp))
      case default
         stepper = with_finite_rotations(new_generalised_alpha(0.8_wp))
      end select
   end function method

   !> D = c - s e - (c' + r e') and from it slip and opening; rotation.
   pure subroutine deformations(lower, upper, d)
      !> x, y and rotation of the centroids
      real(wp), intent(in) :: lower(3), upper(3)
      real(wp), intent(out) :: d(3)
      real(wp) :: way(2)

      way = upper(:2) - above*[sin(upper(3)), cos(upper(3))] - lower(:2) &
            - below*[sin(lower(3)), cos(lower(3))]
      d(1) = way(1)*cos(lower(3)) - way(2)*sin(lower(3))
      d(2) = upper(3) - lower(3)
      d(3) = way(1)*sin(lower(3)) + way(2)*cos(lower(3))
   end subroutine deformations

   !> The joint over a step from one place of the bodies by what they move.
   pure subroutine over_step(place, moved, bodies, joint, change)
      real(wp), intent(in) :: place(3, 2), moved(3, 2)
      type(turned_body), intent(out) :: bodies(2)
      type(joint_type), intent(out) :: joint
      real(wp), intent(out) :: change(3)
      type(turned_body) :: start
      real(wp) :: d(3)
      integer :: i

      do i = 1, 2
         call turn_body(place(3, i), moved(3, i), bodies(i))
      end do
      joint%below = below
      joint%above = above
      call deformations(place(:, 1), place(:, 2), d)
      call body_at(place(3, 1), start)
      joint%start = joint_at(start, joint, d)
      call joint_change(bodies(1), bodies(2), moved(:, 1), moved(:, 2), joint, change)
   end subroutine over_step

   !> Bodies somewhere, and what they move: by far, and by as little as round-off.
   subroutine random_step(random, size, place, moved)
      type(random_type), intent(inout) :: random
      real(wp), intent(in) :: size
      real(wp), intent(out) :: place(3, 2), moved(3, 2)
      integer :: i

      do i = 1, 2
         place(:, i) = random%uniform_array(-1.0_wp, 1.0_wp, 3)
         moved(:, i) = size*random%uniform_array(-1.0_wp, 1.0_wp, 3)
      end do
   end subroutine random_step

   subroutine exact_change(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      type(turned_body) :: bodies(2)
      type(joint_type) :: joint
      real(wp) :: place(3, 2), moved(3, 2), change(3), before(3), after(3)
      integer :: i

      do i = 1, 200
         call random_step(random, 3.0_wp*10.0_wp**(-mod(i, 5)), place, moved)
         call over_step(place, moved, bodies, joint, change)
         call deformations(place(:, 1), place(:, 2), before)
         call deformations(place(:, 1) + moved(:, 1), place(:, 2) + moved(:, 2), after)
         call check_close(error, change, after - before, 0.0_wp, 1.0e-14_wp*10.0_wp, 'change')
      end do
   end subroutine exact_change

   subroutine exact_work(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      type(turned_body) :: bodies(2)
      type(joint_type) :: joint
      real(wp) :: place(3, 2), moved(3, 2), change(3), f(3), on(3, 2)
      integer :: i

      do i = 1, 200
         call random_step(random, 3.0_wp*10.0_wp**(-mod(i, 5)), place, moved)
         call over_step(place, moved, bodies, joint, change)
         f = random%uniform_array(-1.0_wp, 1.0_wp, 3)
         on = 0.0_wp
         call add_joint_forces(bodies(1), bodies(2), joint, f, on(:, 1), on(:, 2))
         call check_close(error, -sum(on*moved), sum(f*change), 0.0_wp, 1.0e-13_wp*maxval(abs(moved)), 'work')
      end do
   end subroutine exact_work

   !> A joint with elastic springs where the bodies have moved, and the forces of its springs: over the step
   !> those of the middle of the lines; at one state those of the end.
   subroutine stretch(place, moved, k, tension, closed, at_end, bodies, joint, change, f)
      real(wp), intent(in) :: place(3, 2), moved(3, 2), k(3), tension
      logical, intent(in) :: closed, at_end
      type(turned_body), intent(out) :: bodies(2)
      type(joint_type), intent(out) :: joint
      real(wp), intent(out) :: change(3), f(3)
      real(wp) :: d(3)
      integer :: i

      call over_step(place, moved, bodies, joint, change)
      f = merge(1.0_wp, 0.5_wp, at_end)*k*change
      if (closed) f(3) = tension
      if (.not. at_end) return
      do i = 1, 2
         call body_at(place(3, i) + moved(3, i), bodies(i))
      end do
      call deformations(place(:, 1) + moved(:, 1), place(:, 2) + moved(:, 2), d)
      joint%finish = joint_at(bodies(1), joint, d)
      joint%mean = joint%finish
   end subroutine stretch

   subroutine tangent(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      type(turned_body) :: bodies(2)
      type(joint_type) :: joint
      real(wp), parameter :: k(3) = [3.0_wp, 2.0_wp, 5.0_wp], tension = 0.7_wp, h = 1.0e-5_wp
      real(wp) :: place(3, 2), moved(3, 2), near(3, 2), change(3), f(3), share, shift(local)
      real(wp) :: on(3, 2, 2), opened(2), found(local, local), wanted(local, local)
      integer :: i, j, way
      logical :: closed, at_end

      do i = 1, 40
         closed = mod(i, 2) == 0
         at_end = mod(i, 4) > 1
         call random_step(random, merge(1.0_wp, 1.0e-3_wp, mod(i, 8) > 3), place, moved)
         wanted = 0.0_wp
         ! Three unknowns of the lower body, the tension, three of the upper one.
         do j = 1, local
            do way = 1, 2
               shift = 0.0_wp
               shift(j) = (3 - 2*way)*h
               near = moved + reshape([shift(:3), shift(5:)], [3, 2])
               call stretch(place, near, k, tension + shift(4), closed, at_end, bodies, joint, change, f)
               opened(way) = change(3)
               on(:, :, way) = 0.0_wp
               call add_joint_forces(bodies(1), bodies(2), joint, f, on(:, 1, way), on(:, 2, way))
            end do
            wanted(1:3, j) = (on(:, 1, 2) - on(:, 1, 1))/(2.0_wp*h)
            wanted(5:7, j) = (on(:, 2, 2) - on(:, 2, 1))/(2.0_wp*h)
            wanted(4, j) = (opened(1) - opened(2))/(2.0_wp*h)
         end do
         call stretch(place, moved, k, tension, closed, at_end, bodies, joint, change, f)
         share = merge(1.0_wp, 0.5_wp, at_end)
         call joint_tangent(bodies(1), bodies(2), joint, share, f, share*k, closed, found)
         do j = 1, local
            call check_close(error, found(:, j), wanted(:, j), 0.0_wp, 1.0e-8_wp, 'column '//to_text(j))
         end do
         if (allocated(error)) return
      end do
   end subroutine tangent

   !> A random chain under all loads; with large rotations.
   subroutine new_chain(scene, n, kind)
      type(scene_type), intent(out) :: scene
      integer, intent(in) :: n
      !> Bits: openings, damping
      integer, intent(in) :: kind
      type(column_record) :: spec
      type(random_type) :: random

      spec = rich_column(n, 'finite', btest(kind, 0), random)
      spec%top_mass = 500.0_wp
      if (btest(kind, 1)) then
         spec%damping%mass = 2.0_wp
         spec%damping%stiffness = 1.0e-4_wp
      end if
      scene%column = made(spec)
      scene%finish = 0.03_wp
      scene%loads%signal(lateral) = signal_of([0.0_wp, 0.011_wp, 0.03_wp], [0.0_wp, 4.0e5_wp, -4.0e5_wp])
      scene%loads%signal(horizontal) = signal_of([0.0_wp, 0.013_wp, 0.03_wp], [3.0_wp, -50.0_wp, 90.0_wp])
      scene%loads%signal(vertical) = signal_of([0.0_wp, 0.017_wp, 0.03_wp], [0.0_wp, 50.0_wp, -20.0_wp])
      scene%loads%signal(top_axial) = signal_of([0.0_wp, 0.019_wp, 0.03_wp], [0.0_wp, -1.0e5_wp, 2.0e5_wp])
      allocate (scene%q(scene%column%unknowns), scene%v(scene%column%unknowns), source=0.0_wp)
      scene%v(n + 1) = 10.0_wp
   end subroutine new_chain

   subroutine order_of_chains(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(scene_type) :: scene
      type(state_type) :: reference, state
      type(finite_stepper) :: stepper
      real(wp) :: wrong(4)
      integer :: i, kind, number

      do kind = 0, 3
         call new_chain(scene, 3, kind)
         call find_reference(scene, reference, error)
         do number = 1, 3, 2
            do i = 1, 4
               stepper = method(number)
               call play(scene, stepper, 1000*2**i, state, outcome)
               call check_passed(error, outcome, 'method '//to_text(number))
               wrong(i) = distance(state, reference)
            end do
            call check_order(error, wrong, 1.3_wp, 2.7_wp, &
                             'kind '//to_text(kind)//', method '//to_text(number))
            call check_true(error, wrong(4) < 1.0e-2_wp, 'error '//to_text(wrong(4)))
            if (allocated(error)) return
         end do
      end do
   end subroutine order_of_chains

   !> For steps of any length.
   subroutine energy(error)
      type(error_type), allocatable, intent(inout) :: error
      integer, parameter :: bodies(4) = [1, 2, 7, 40]
      type(error_type), allocatable :: outcome
      type(scene_type) :: scene
      type(state_type) :: state
      type(finite_stepper) :: stepper
      real(wp) :: largest
      integer :: i, kind, step

      do i = 1, 4
         do kind = 0, 3
            call new_chain(scene, bodies(i), kind)
            call new_state(state, scene%column, scene%loads, scene%q, scene%v)
            largest = state%at_begin
            stepper = method(1)
            do step = 1, 30
               call stepper%advance(state, scene%finish/30, outcome)
               call check_passed(error, outcome, 'step')
               if (allocated(error)) return
               largest = max(largest, sum(abs(state%springs%work)), abs(state%of_loads))
               call check_close(error, residual_of(state), 0.0_wp, 0.0_wp, 1.0e-10_wp*largest, &
                                'n = '//to_text(bodies(i))//', kind '//to_text(kind)//': energy')
            end do
            call check_true(error, state%springs%events > 0, 'springs yield')
            if (allocated(error)) return
         end do
      end do
   end subroutine energy

   !> A hundred stiff bodies that yield, with steps that are many times their shortest period.
   subroutine stiff(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      class(column_type), allocatable :: column
      type(loads_type) :: loads
      type(state_type) :: state
      type(finite_stepper) :: stepper
      integer, parameter :: n = 100
      real(wp), allocatable :: rest(:)
      integer :: number, step

      spec = chain(n, 'finite')
      spec%top_mass = 2.0e4_wp
      spec%axial_load = 2.0e5_wp
      deallocate (spec%shear, spec%flexure)
      allocate (spec%shear(1), spec%flexure(1))
      spec%shear(1) = elastic(1.0e9_wp*n)
      spec%flexure(1) = bilinear(2.0e7_wp*n, 0.01_wp/n, 1.0e6_wp*n)
      column = made(spec)
      allocate (rest(2*n), source=0.0_wp)
      loads%signal(horizontal) = signal_of([0.0_wp, 0.2_wp, 0.6_wp, 1.0_wp], &
                                           [0.0_wp, 8.0_wp, -9.0_wp, 5.0_wp])
      do number = 1, 3, 2
         call new_state(state, column, loads, rest, rest)
         stepper = method(number)
         do step = 1, 200
            call stepper%advance(state, 5.0e-3_wp, outcome)
            call check_passed(error, outcome, 'step')
            if (allocated(error)) return
         end do
         call check_equal(error, stepper%cut_steps, 0, 'no step is cut')
         call check_true(error, state%springs%events > n, 'springs yield')
         call check_true(error, abs(residual_of(state)) < merge(1.0e-11_wp, 0.05_wp, number == 1) &
                         *sum(state%springs%work), 'energy: '//to_text(residual_of(state)))
      end do
   end subroutine stiff

   !> A step in which the bodies turn many times has no solution near its start.
   subroutine no_trace(error)
      type(error_type), allocatable, intent(inout) :: error
      type(scene_type) :: scene
      type(state_type) :: state, before
      type(finite_stepper) :: stepper

      call new_chain(scene, 3, 1)
      call new_state(state, scene%column, scene%loads, scene%q, 1.0e4_wp*scene%v)
      before = state
      stepper = method(1)
      call stepper%prepare(state)
      stepper%h = 1.0e-2_wp
      stepper%load = state%load
      call stepper%take_step(state)
      call check_true(error, .not. stepper%converged, 'the step fails')
      call check_same(error, state%q, before%q, 'deformations')
      call check_same(error, state%springs%d, before%springs%d, 'springs')
      call check_same(error, state%springs%k, before%springs%k, 'lines')
      call check_same(error, state%springs%work, before%springs%work, 'work')
      call check_true(error, stepper%busiest > 0, 'a spring is named')
   end subroutine no_trace

end module test_implicit_finite
