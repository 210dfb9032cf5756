!> Planar frames on static paths: closed forms of the stiffness method, limit loads, dead load.
module test_frame
   use check, only: unit_test, check_close, check_same, check_true
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_springs, only: spring_array
   use rbs_output_channels, only: new_channels
   use rbs_output_recorder, only: array_recorder
   use rbs_solve_end_state, only: end_state, checkpoint_type
   use rbs_solve_static_dead_load, only: put_dead_load
   use rbs_solve_static_equilibrium, only: equilibrium_type
   use rbs_solve_static_straight, only: trace_straight
   use rbs_solve_task, only: task_type
   use rbs_structure_frame_element, only: frame_element, find_tangent
   use rbs_structure_frame_frame, only: frame_type
   use rbs_structure_frame_new_frame, only: frame_node, frame_member, new_frame
   use rbs_structure_spring_place, only: flexure
   use rbs_structure_structure, only: small, pdelta, lateral
   use rbs_loading_loads, only: loads_type, horizontal
   use rbs_solve_time_implicit, only: implicit_stepper, new_newmark
   use rbs_solve_time_state, only: state_type
   use rbs_case_analysis_record, only: analysis_record
   use rbs_solve_time_march, only: initial_state
   use rbs_solve_time_plan, only: time_plan
   use rbs_solve_time_run_dynamic, only: plan_dynamic, run_dynamic
   use row_places, only: row_displacement
   use runs, only: check_order, new_state, residual_of, signal_of, times
   use samples, only: random_type
   implicit none
   private

   public :: collect_frame

   !> Stiffness, height and span of the portal, plastic moment.
   real(wp), parameter :: bending = 2.0e7_wp, along = 3.0e9_wp, h = 3.0_wp, l = 6.0_wp, plastic = 2.0e5_wp
   !> Place of the base shear in a row.
   integer, parameter :: row_base = 10
   !> A moment that is never reached.
   real(wp), parameter :: never = 1.0e30_wp
   !> Shares of the length in a rule of Gauss and Lobatto.
   real(wp), parameter :: share(3) = [1.0_wp/6.0_wp, 2.0_wp/3.0_wp, 1.0_wp/6.0_wp]

contains

   subroutine collect_frame(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('an element of springs of any stiffness: the dense system', elements), &
               unit_test('fixed-end moments w l^2/12, springs or elastic', fixed_ends), &
               unit_test('an elastic portal sways by the stiffness method', elastic_portal), &
               unit_test('limit loads of a portal: the least of three mechanisms', limit_loads), &
               unit_test('a path in 1, 7, 100 parts, or cut, turns at the same points', parts), &
               unit_test('a column under dead load: energies balance, P-Delta by hand', loaded_column), &
               unit_test('a mass on an elastic column: the steps of the scalar theory', elastic_mass), &
               unit_test('a portal that yields in time: order 2, energies balance', yielding_portal), &
               unit_test('runs of a portal go on with the same bits, and end at collapse', runs_of_portal)]
   end subroutine collect_frame

   !> K d = p s, sum p d = q with LAPACK's independent order of things: here by Gauss-Jordan elimination.
   subroutine elements(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      type(frame_element) :: element
      real(wp) :: k0(3), k(3), a(5, 10), stiffness(3, 3), rate(3, 3), bent(3, 3), opened(0, 0)
      logical :: stable, shares
      integer :: trial, i

      element%bending = 3
      element%share = reshape([-1.0_wp, 0.0_wp, -0.5_wp, 0.5_wp, 0.0_wp, 1.0_wp], [2, 3])
      k0 = bending/(share*l)
      do trial = 1, 60
         k = [(k0(i)*random%uniform(0.0_wp, 1.0_wp), i=1, 3)]
         if (mod(trial, 2) == 0) k(1 + mod(trial, 3)) = 0.0_wp
         if (mod(trial, 7) == 0) k(1) = -0.02_wp*k0(1)
         call find_tangent(element, 3, 0, k, k0, stiffness, rate, bent, opened, stable, shares)
         a = 0.0_wp
         do i = 1, 3
            a(i, i) = k(i)/k0(1)
            a(i, 4:5) = -element%share(:, i)
            a(4:5, i) = element%share(:, i)
         end do
         do i = 1, 5
            a(i, 5 + i) = 1.0_wp
         end do
         call eliminate(a)
         call check_true(error, stable, 'stable')
         call check_close(error, reshape(transpose(rate(2:, :)), [6]), reshape(a(:3, 9:10), [6]), 0.0_wp, &
                          1.0e-12_wp, 'rates')
         call check_close(error, reshape(stiffness(2:, 2:)/k0(1), [4]), reshape(a(4:5, 9:10), [4]), 0.0_wp, &
                          1.0e-12_wp, 'stiffness')
         call check_close(error, reshape(bent*k0(1), [9]), reshape(a(:3, 6:8), [9]), 0.0_wp, 1.0e-11_wp, &
                          'what brings forces into equilibrium')
      end do
   end subroutine elements

   !> Turn the left half into the identity, with the largest pivot of each column.
   subroutine eliminate(a)
      real(wp), intent(inout) :: a(:, :)
      real(wp) :: row(size(a, 2))
      integer :: i, j, p

      do j = 1, size(a, 1)
         p = j - 1 + maxloc(abs(a(j:, j)), dim=1)
         row = a(p, :)
         a(p, :) = a(j, :)
         a(j, :) = row/row(j)
         do i = 1, size(a, 1)
            if (i /= j) a(i, :) = a(i, :) - a(i, j)*a(j, :)
         end do
      end do
   end subroutine eliminate

   !> A member with three springs that carry all of its bending.
   subroutine put_springs(member, length, yield, slope)
      type(frame_member), intent(inout) :: member
      real(wp), intent(in) :: length, yield
      !> Stiffness after yield over the first one
      real(wp), intent(in) :: slope
      integer :: i

      member%axial = along
      member%kind = [flexure, flexure, flexure]
      member%joint = [1, 2, 3]
      member%place = [0.0_wp, 0.5_wp, 1.0_wp]
      allocate (member%spring(3))
      do i = 1, 3
         associate (k => bending/(share(i)*length))
            member%spring(i)%rule = 'bilinear'
            member%spring(i)%value(:3) = [k, yield/k, slope*k]
         end associate
      end do
   end subroutine put_springs

   subroutine fixed_ends(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp), parameter :: w = 3.0e4_wp
      type(frame_type), target :: frame
      type(frame_node) :: node(3)
      type(end_state) :: state
      type(checkpoint_type) :: checkpoint
      type(spring_array) :: springs
      real(wp) :: s(3)
      integer :: of, i

      node([1, 3])%held(1) = .true.
      node([1, 3])%held(2) = .true.
      node([1, 3])%held(3) = .true.
      node(2)%x = l/2.0_wp
      node(3)%x = l
      do of = 1, 2
         call make_beam(frame, node, of == 1, w)
         call put_dead_load(frame, state, error)
         if (allocated(error)) return
         call stand(frame, springs)
         call state%restore(frame, checkpoint, springs, error)
         if (allocated(error)) return
         call check_close(error, springs%d(frame%springs + frame%number(2, 2)), &
                          -w*l**4/(384.0_wp*bending), 1.0e-12_wp, 0.0_wp, 'sag')
         do i = 1, 2
            call frame%member_forces(i, springs%d, springs%forces(springs%d), s)
            s = s/(w*l**2/12.0_wp)
            call check_close(error, s(2:), merge([-1.0_wp, -0.5_wp], [0.5_wp, 1.0_wp], i == 1), 1.0e-12_wp, &
                             0.0_wp, 'moments of the ends')
         end do
      end do
   end subroutine fixed_ends

   subroutine make_beam(frame, node, has_springs, w)
      type(frame_type), intent(out) :: frame
      type(frame_node), intent(in) :: node(3)
      logical, intent(in) :: has_springs
      real(wp), intent(in) :: w
      type(frame_member) :: member(2)
      integer :: i

      do i = 1, 2
         member(i)%node = [i, i + 1]
         member(i)%load = w
         if (has_springs) then
            call put_springs(member(i), l/2.0_wp, never, 0.5_wp)
         else
            member(i)%axial = along
            member(i)%bending = bending
            allocate (member(i)%kind(0), member(i)%joint(0), member(i)%place(0), member(i)%spring(0))
         end if
      end do
      call new_frame(frame, node, member, small, 2)
   end subroutine make_beam

   subroutine stand(frame, springs)
      type(frame_type), intent(in), target :: frame
      type(spring_array), intent(out) :: springs

      call frame%create_springs(springs, frame%constant_axial)
   end subroutine stand

   !> A portal with fixed feet, pushed at its left corner and v times as much down in the middle of its beam.
   subroutine push_portal(error, v, yield, stiff, target, task, rows)
      type(error_type), allocatable, intent(inout) :: error
      real(wp), intent(in) :: v, yield
      !> Whether columns and beam do not get longer
      logical, intent(in) :: stiff
      real(wp), intent(in) :: target(:)
      type(task_type), intent(inout), target :: task
      real(wp), allocatable, intent(out) :: rows(:, :)
      type(frame_type), target :: frame
      type(equilibrium_type), target :: equilibrium
      type(array_recorder), pointer :: recorder
      type(frame_node) :: node(5)
      type(frame_member) :: member(4)
      integer :: i

      allocate (recorder)
      node(1)%held = .true.
      node(2)%held = .true.
      node(3:)%y = h
      node(:)%x = [0.0_wp, l, 0.0_wp, l/2.0_wp, l]
      node(3)%push(1) = 1.0_wp
      if (stiff) then
         node(3)%held(2) = .true.
         node(5)%held(2) = .true.
         node(4:)%like = 3
      end if
      member(1)%node = [1, 3]
      member(2)%node = [2, 5]
      member(3)%node = [3, 4]
      member(4)%node = [4, 5]
      do i = 1, 4
         call put_springs(member(i), merge(h, l/2.0_wp, i <= 2), yield, 0.0_wp)
      end do
      call new_frame(frame, node, member, small, 3)
      frame%pattern(lateral)%force(frame%number(2, 4)) = -v
      call equilibrium%create(frame, .false.)
      recorder%channels = new_channels(frame, .false., .false., .false.)
      task%recorder => recorder
      call trace_straight(frame, equilibrium, .false., target, task, error)
      call move_alloc(recorder%rows, rows)
      nullify (task%recorder)
      deallocate (recorder)
   end subroutine push_portal

   subroutine elastic_portal(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp), parameter :: ratio = h/l
      type(task_type), target :: task
      real(wp), allocatable :: rows(:, :)

      call push_portal(error, 0.0_wp, never, .true., [1.0e-3_wp], task, rows)
      call check_close(error, task%summary%peak_force, 1.0e-3_wp*24.0_wp*bending/h**3 &
                       *(1.0_wp + 6.0_wp*ratio)/(4.0_wp + 6.0_wp*ratio), 1.0e-12_wp, 0.0_wp, 'force')
   end subroutine elastic_portal

   !> Some of the paths end where the beam alone gives way, which the top does not see.
   subroutine limit_loads(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: ended
      type(task_type), target :: task
      real(wp), allocatable :: rows(:, :)
      real(wp) :: v, least
      integer :: i

      do i = 0, 6
         v = 0.5_wp*i
         task = task_type()
         call push_portal(ended, v, plastic, .false., [0.02_wp, 0.05_wp, 0.1_wp, 0.5_wp], task, rows)
         if (allocated(ended)) deallocate (ended)
         least = min(4.0_wp*plastic/h, 6.0_wp*plastic/(h + v*l/2.0_wp))
         if (i > 0) least = min(least, 8.0_wp*plastic/(l*v))
         call check_close(error, task%summary%peak_force, least, 1.0e-12_wp, 0.0_wp, 'limit load')
      end do
   end subroutine limit_loads

   subroutine parts(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp), parameter :: turn(4) = [0.03_wp, -0.05_wp, 0.08_wp, 0.0_wp]
      type(task_type), target :: task, cut
      real(wp), allocatable :: whole(:, :), rows(:, :), target(:)
      real(wp) :: before
      integer, parameter :: number(2) = [7, 100]
      integer :: i, j, k

      call push_portal(error, 0.7_wp, plastic, .false., turn, task, whole)
      do k = 1, 2
         target = [real(wp) ::]
         before = 0.0_wp
         do i = 1, 4
            target = [target, [(before + (turn(i) - before)*j/number(k), j=1, number(k) - 1)], turn(i)]
            before = turn(i)
         end do
         task = task_type()
         call push_portal(error, 0.7_wp, plastic, .false., target, task, rows)
         if (allocated(error)) return
         do i = 1, 4
            call check_same(error, rows(3, i*number(k)), whole(3, i), 'force at a turning point')
         end do
      end do
      cut%keeps_end = .true.
      call push_portal(error, 0.7_wp, plastic, .false., turn(:2), cut, rows)
      cut%before = cut%after
      call push_portal(error, 0.7_wp, plastic, .false., turn(3:), cut, rows)
      if (allocated(error)) return
      do i = 3, 4
         call check_same(error, rows(2:, i - 2), whole(2:, i), 'a path that goes on')
      end do
   end subroutine parts

   !> Rigid but for the foot: k_M r = (F + P r) h with r = u/h. A path through yield balances its energies.
   subroutine loaded_column(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp), parameter :: load = 1.0e6_wp, kh = h*sqrt(load/bending)
      type(frame_type), target :: frame
      type(equilibrium_type), target :: equilibrium
      type(array_recorder), target :: recorder
      type(task_type), target :: task
      type(frame_node) :: node(2)
      type(frame_member) :: member(1)

      node(1)%held = .true.
      node(2)%y = h
      node(2)%push(1) = 1.0_wp
      node(2)%load(2) = -load
      member(1)%node = [1, 2]
      call put_springs(member(1), h, plastic/2.0_wp, 0.01_wp)
      call new_frame(frame, node, member, pdelta, 2)
      call put_dead_load(frame, task%before, error)
      if (allocated(error)) return
      call check_close(error, frame%element%compression, [load], 1.0e-14_wp, 0.0_wp, 'axial force')
      call equilibrium%create(frame, .false.)
      recorder%channels = new_channels(frame, .false., .false., .false.)
      task%recorder => recorder
      call trace_straight(frame, equilibrium, .false., [0.001_wp, -0.02_wp, 0.05_wp, 0.0_wp], task, error)
      if (allocated(error)) return
      ! The cantilever of E I: u = H h/P (tan kh/kh - 1), k^2 = P/E I.
      call check_close(error, recorder%rows(3, 1), 0.001_wp*load/(h*(tan(kh)/kh - 1.0_wp)), 1.0e-9_wp, &
                       0.0_wp, 'force')
      call check_close(error, recorder%rows(9, :4), spread(0.0_wp, 1, 4), 0.0_wp, 1.0e-10_wp, &
                       'what is missing from the balance')
   end subroutine loaded_column

   !> Average acceleration under a ground that begins to accelerate: u'' + w^2 u = -a, rotation without mass.
   subroutine elastic_mass(error)
      type(error_type), allocatable, intent(inout) :: error
      real(wp), parameter :: mass = 2.0e4_wp, ground = 2.0_wp, step = 0.02_wp
      type(frame_type) :: frame
      type(frame_node) :: node(2)
      type(frame_member) :: member(1)
      type(loads_type) :: loads
      type(state_type) :: state
      type(implicit_stepper) :: stepper
      real(wp) :: u, v, a, now, stiffness
      integer :: i

      node(1)%held = .true.
      node(2)%y = h
      node(2)%mass(:2) = mass
      member(1)%node = [1, 2]
      call put_springs(member(1), h, never, 0.5_wp)
      call new_frame(frame, node, member, small, 2)
      loads%signal(horizontal) = signal_of([0.0_wp, 1.0_wp], [ground, ground])
      stepper = new_newmark()
      call new_state(state, frame, loads, spread(0.0_wp, 1, frame%coordinates), &
                     spread(0.0_wp, 1, frame%coordinates))
      stiffness = 3.0_wp*bending/h**3
      u = 0.0_wp
      v = 0.0_wp
      a = -ground
      do i = 1, 40
         call stepper%advance(state, step, error)
         if (allocated(error)) return
         now = (-ground*mass + mass*(4.0_wp/step**2*u + 4.0_wp/step*v + a))/(4.0_wp*mass/step**2 + stiffness)
         v = 2.0_wp/step*(now - u) - v
         a = -ground - stiffness/mass*now
         u = now
         call check_close(error, frame%top_displacement(state%q), u, 1.0e-10_wp, 1.0e-12_wp, 'displacement')
      end do
      call check_close(error, residual_of(state), 0.0_wp, 0.0_wp, 1.0e-9_wp*sum(state%springs%work), 'energy')
   end subroutine elastic_mass

   !> A damped portal with masses at its corners.
   subroutine new_portal(frame)
      type(frame_type), intent(out) :: frame
      type(frame_node) :: node(4)
      type(frame_member) :: member(3)
      integer :: i

      node(:2)%held(1) = .true.
      node(:2)%held(2) = .true.
      node(:2)%held(3) = .true.
      node(:)%x = [0.0_wp, l, 0.0_wp, l]
      node(3:)%y = h
      do i = 3, 4
         node(i)%mass = [3.0e4_wp, 3.0e4_wp, 1.0e3_wp]
      end do
      member(1)%node = [1, 3]
      member(2)%node = [2, 4]
      member(3)%node = [3, 4]
      do i = 1, 3
         call put_springs(member(i), merge(h, l, i < 3), plastic, 0.05_wp)
      end do
      call new_frame(frame, node, member, small, 3)
      frame%damped = .true.
      frame%stiffness_damping = 1.0e-3_wp
      frame%mass_damping = 0.2_wp
   end subroutine new_portal

   subroutine yielding_portal(error)
      type(error_type), allocatable, intent(inout) :: error
      integer, parameter :: steps(4) = [400, 800, 1600, 25600]
      real(wp), parameter :: finish = 1.0_wp
      type(frame_type) :: frame
      type(loads_type) :: loads
      type(state_type) :: state
      type(implicit_stepper) :: stepper
      real(wp) :: top(4), residual(4), time(21)
      integer :: i, j

      call new_portal(frame)
      time = [(finish*i/20, i=0, 20)]
      loads%signal(horizontal) = signal_of(time, 12.0_wp*sin(17.0_wp*time))
      do j = 1, 4
         stepper = new_newmark()
         call new_state(state, frame, loads, spread(0.0_wp, 1, frame%coordinates), &
                        spread(0.0_wp, 1, frame%coordinates))
         do i = 1, steps(j)
            call stepper%advance(state, finish/steps(j), error)
            if (allocated(error)) return
         end do
         top(j) = frame%top_displacement(state%q)
         residual(j) = abs(residual_of(state))/sum(state%springs%work)
      end do
      call check_true(error, state%springs%events > 10, 'it yields')
      call check_order(error, abs(top(:3) - top(4)), 1.4_wp, 3.0_wp, 'displacement')
      call check_true(error, residual(4) < 1.0e-6_wp .and. residual(4) < 0.01_wp*residual(1), 'energy')
   end subroutine yielding_portal

   !> The rows of every step; half of a motion and the rest from the state at its end; the end by collapse.
   subroutine runs_of_portal(error)
      type(error_type), allocatable, intent(inout) :: error
      type(frame_type) :: frame
      type(task_type) :: whole, first, second, falls
      type(array_recorder) :: all_rows, half, rest
      type(loads_type) :: loads
      real(wp) :: time(101)

      call new_portal(frame)
      time = times(100, 0.01_wp)
      loads%signal(horizontal) = signal_of(time, 12.0_wp*sin(17.0_wp*time))
      call run(time, whole, all_rows)
      first%keeps_end = .true.
      call run(time(:51), first, half)
      second%before = first%after
      call run(time(51:), second, rest)
      if (allocated(error)) return
      call check_same(error, rest%rows(:, rest%count), all_rows%rows(:, all_rows%count), 'it goes on')
      associate (rows => all_rows%rows(:, :all_rows%count))
         call check_same(error, whole%summary%peak_base_shear, &
                         rows(row_base, maxloc(abs(rows(row_base, :)), dim=1)), 'base shear')
         falls%collapse_drift = 0.5_wp*maxval(abs(rows(row_displacement, :)))/h
      end associate
      call run(time, falls, half)
      if (allocated(error)) return
      call check_true(error, falls%summary%collapsed, 'collapse')
      associate (drift => abs(half%rows(row_displacement, :half%count))/h)
         call check_true(error, maxval(drift(:half%count - 1)) < falls%collapse_drift .and. &
                         drift(half%count) >= falls%collapse_drift, 'at its drift')
      end associate

   contains

      subroutine run(time, task, recorder)
         real(wp), intent(in) :: time(:)
         type(task_type), intent(inout) :: task
         type(array_recorder), intent(out), target :: recorder
         type(analysis_record) :: analysis
         type(time_plan) :: plan

         if (allocated(error)) return
         analysis = analysis_record(method='newmark', dt=2.0e-3_wp)
         call plan_dynamic(frame, analysis, time, loads, plan, error)
         if (allocated(error)) return
         recorder%channels = new_channels(frame, .true., .false., .false.)
         task%recorder => recorder
         task%every = 1
         call run_dynamic(frame, analysis, plan, time, loads, initial_state(), task, error)
      end subroutine run

   end subroutine runs_of_portal

end module test_frame
