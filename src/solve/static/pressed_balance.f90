!> Equilibrium of a column under an axial load that varies, on the present lines of its springs.
!>
!> What is driven and the axial load P at the top change in proportion to a share s of the way to the next
!> target; N = P + r F follows the lateral force as in an exterior column of a frame. With the loads less the
!> forces of the springs R(z, F, N) in unknowns z, their derivatives K = -dR/dz, dR/dF = a (the arms of the
!> top) and dR/dN = p, rates and corrections follow from one linear system with a border,
!>
!>     [K    -(a + r p)] [dz]   [R + p dP          ]
!>     [a'    0        ] [dF] = [dx or what is missing]
!>
!> Layered joints are on planes M = m + k phi - e N, so that -K_1 q and e make up p with small rotations
!> (K_G = N K_1 + K_weight); axial springs carry -N. Exact rotations: `rbs_solve_static_pressed_finite`.
module rbs_solve_static_pressed_balance
   use rbs_base_kinds, only: wp
   use rbs_base_small_systems, only: factor_positive, solve_general
   use rbs_column_axial, only: geometric_stiffness
   use rbs_column_column, only: column_type, small
   use rbs_hysteresis_springs, only: spring_array
   implicit none
   private

   public :: pressed_balance, pressed_point, hold

   !> A point of the path and how it goes on, per share of the way.
   type :: pressed_point
      real(wp) :: share = 0.0_wp, force = 0.0_wp, force_rate = 0.0_wp
      !> Displacement of the top [m] and its rate
      real(wp) :: displacement = 0.0_wp, displacement_rate = 0.0_wp
      !> Rate of the potential of the axial forces [J]
      real(wp) :: axial_power = 0.0_wp
      !> Deformations and their rates (unknowns); axial loads of the joints and their rates (n)
      real(wp), allocatable :: q(:), rate(:), press(:), press_rate(:)
   end type pressed_point

   type :: pressed_balance
      type(column_type) :: column
      !> Whether the force is driven, else the displacement
      logical :: by_force = .false.
      !> Whether the path between events is straight
      logical :: straight = .true.
      !> How the axial load follows the lateral force
      real(wp) :: ratio = 0.0_wp
      !> The way to the target: change of what is driven, and of the axial load; where it began
      real(wp) :: way(2) = 0.0_wp, begin_way(2) = 0.0_wp
      !> Weight above each joint (n) [N]
      real(wp), allocatable :: weight_above(:)
      !> Geometric stiffness per axial load at the top, and of the weight (unknowns, unknowns)
      real(wp), allocatable, private :: unit_stiffness(:, :), weight_stiffness(:, :)
   contains
      procedure :: create
      procedure :: assemble
      procedure :: hold_top
      procedure :: to_deformations
      procedure :: solve_point
      procedure :: unbalance
      procedure :: is_moment
      procedure :: find_press
      procedure :: top_load
      procedure :: plane_forces
   end type pressed_balance

contains

   subroutine create(self, column, by_force)
      class(pressed_balance), intent(inout) :: self
      type(column_type), intent(in) :: column
      logical, intent(in) :: by_force
      type(column_type) :: loaded
      integer :: m

      m = column%unknowns
      self%column = column
      self%by_force = by_force
      self%ratio = column%axial_force_ratio
      self%weight_above = column%compression - column%axial_load
      self%straight = column%kinematics == small
      allocate (self%unit_stiffness(m, m), self%weight_stiffness(m, m), source=0.0_wp)
      if (self%straight) return
      loaded = column
      loaded%axial_body = column%axial_lever
      loaded%axial_slip = column%axial_lever
      if (column%held) loaded%axial_slip(column%n) = 0.0_wp
      call geometric_stiffness(loaded, self%unit_stiffness)
      loaded%axial_body = column%axial_body - column%axial_lever*column%axial_load
      loaded%axial_slip = column%axial_slip - column%axial_lever*column%axial_load
      if (column%held) loaded%axial_slip(column%n) = 0.0_wp
      call geometric_stiffness(loaded, self%weight_stiffness)
   end subroutine create

   !> Axial load at the top at a point [N].
   pure real(wp) function top_load(self, point)
      class(pressed_balance), intent(in) :: self
      type(pressed_point), intent(in) :: point

      top_load = self%begin_way(2) + point%share*self%way(2) + self%ratio*point%force
   end function top_load

   !> Axial loads of the joints at a point, and their rates.
   pure subroutine find_press(self, point)
      class(pressed_balance), intent(in) :: self
      type(pressed_point), intent(inout) :: point

      point%press = self%top_load(point) + self%weight_above
      point%press_rate = self%way(2) + self%ratio*point%force_rate
   end subroutine find_press

   !> Forces of the springs at a point, and minus their derivatives by the axial load.
   pure subroutine plane_forces(self, springs, point, f, centre)
      class(pressed_balance), intent(in) :: self
      type(spring_array), intent(in) :: springs
      type(pressed_point), intent(in) :: point
      !> (unknowns)
      real(wp), intent(out) :: f(:), centre(:)
      integer :: i, j

      f = springs%f0 + springs%k*(point%q - springs%d0)
      centre = 0.0_wp
      do j = 1, size(springs%layered)
         i = springs%layered(j)
         centre(i) = springs%centre(i)
         f(i) = f(i) - centre(i)*(point%press(i - self%column%n) - springs%press_at(i))
      end do
   end subroutine plane_forces

   !> What the equilibrium at a point consists of. With small rotations z is q.
   subroutine assemble(self, springs, point, tangent, missing, arm, pushed, axial, displacement)
      class(pressed_balance), intent(inout) :: self
      type(spring_array), intent(in) :: springs
      !> With the axial loads of the joints
      type(pressed_point), intent(in) :: point
      !> K (unknowns, unknowns)
      real(wp), intent(out) :: tangent(:, :)
      !> R, a, p, and the share of axial load and weight in R (unknowns)
      real(wp), intent(out) :: missing(:), arm(:), pushed(:), axial(:)
      !> Displacement of the top [m]
      real(wp), intent(out) :: displacement
      real(wp) :: f(size(missing)), centre(size(missing))
      integer :: i, n

      n = self%column%n
      call self%plane_forces(springs, point, f, centre)
      arm = self%column%arm
      displacement = dot_product(arm, point%q)
      tangent = self%top_load(point)*self%unit_stiffness + self%weight_stiffness
      axial = -matmul(tangent, point%q)
      pushed = centre - matmul(self%unit_stiffness, point%q)
      if (self%column%opens) then
         axial(2*n + 1:) = -point%press
         pushed(2*n + 1:) = -1.0_wp
      end if
      missing = arm*point%force - f + axial
      do i = 1, size(f)
         tangent(i, i) = tangent(i, i) + springs%k(i)
      end do
   end subroutine assemble

   !> Leave the relative rotation of the last joint out where the top is held: it is minus the sum of the
   !> others. Here z is q without it.
   pure subroutine hold_top(self, tangent, missing, pushed, axial)
      class(pressed_balance), intent(in) :: self
      real(wp), intent(inout) :: tangent(:, :)
      real(wp), intent(inout) :: missing(:), pushed(:), axial(:)
      integer :: first, last, m

      first = self%column%n + 1
      last = 2*self%column%n
      m = last - first
      missing(first:last - 1) = missing(first:last - 1) - missing(last)
      pushed(first:last - 1) = pushed(first:last - 1) - pushed(last)
      axial(first:last - 1) = axial(first:last - 1) - axial(last)
      tangent(first:last - 1, first:last - 1) = tangent(first:last - 1, first:last - 1) &
                                                + tangent(last, last) &
                                                - spread(tangent(first:last - 1, last), 2, m) &
                                                - spread(tangent(last, first:last - 1), 1, m)
      tangent(first:last - 1, :first - 1) = tangent(first:last - 1, :first - 1) &
                                            - spread(tangent(last, :first - 1), 1, m)
      tangent(:first - 1, first:last - 1) = transpose(tangent(first:last - 1, :first - 1))
      call hold(last, tangent, missing, pushed, axial)
   end subroutine hold_top

   !> Hold one unknown: it couples with nothing.
   pure subroutine hold(i, tangent, missing, pushed, axial)
      integer, intent(in) :: i
      real(wp), intent(inout) :: tangent(:, :)
      real(wp), intent(inout) :: missing(:), pushed(:), axial(:)

      tangent(i, :) = 0.0_wp
      tangent(:, i) = 0.0_wp
      tangent(i, i) = 1.0_wp
      missing(i) = 0.0_wp
      pushed(i) = 0.0_wp
      axial(i) = 0.0_wp
   end subroutine hold

   !> Changes of the deformations from those of the unknowns.
   pure subroutine to_deformations(self, z, q)
      class(pressed_balance), intent(in) :: self
      real(wp), intent(in), contiguous :: z(:)
      real(wp), intent(out), contiguous :: q(:)
      integer :: n

      q = z(:self%column%unknowns)
      if (.not. self%column%held) return
      n = self%column%n
      q(2*n) = -sum(q(n + 1:2*n - 1))
   end subroutine to_deformations

   !> Rates at a point, and what takes its residual away, on the present lines.
   subroutine solve_point(self, springs, point, correction, force_correction, found)
      class(pressed_balance), intent(inout) :: self
      type(spring_array), intent(in) :: springs
      type(pressed_point), intent(inout) :: point
      real(wp), intent(out) :: correction(:), force_correction
      logical, intent(out) :: found
      real(wp), dimension(size(point%q) + 1, size(point%q) + 1) :: a
      real(wp), dimension(size(point%q) + 1, 2) :: b
      real(wp), dimension(size(point%q), size(point%q)) :: tangent
      real(wp), dimension(size(point%q)) :: arm, pushed, axial, missing
      real(wp) :: driven
      integer :: m

      m = size(point%q)
      driven = self%begin_way(1) + point%share*self%way(1)
      if (self%by_force) point%force = driven
      call self%find_press(point)
      call self%assemble(springs, point, tangent, missing, arm, pushed, axial, point%displacement)
      if (self%column%held) call self%hold_top(tangent, missing, pushed, axial)
      a = 0.0_wp
      a(:m, :m) = tangent
      b(:m, 1) = pushed*self%way(2)
      b(:m, 2) = missing
      if (self%by_force) then
         found = is_stable(tangent)
         if (.not. found) return
         b(:m, 1) = b(:m, 1) + (arm + self%ratio*pushed)*self%way(1)
         a(m + 1, m + 1) = 1.0_wp
         b(m + 1, :) = [self%way(1), 0.0_wp]
      else
         a(:m, m + 1) = -(arm + self%ratio*pushed)
         a(m + 1, :m) = arm
         b(m + 1, :) = [self%way(1), driven - point%displacement]
      end if
      call solve_general(a, b, found)
      if (.not. found) return
      call self%to_deformations(b(:m, 1), point%rate)
      call self%to_deformations(b(:m, 2), correction)
      point%force_rate = b(m + 1, 1)
      force_correction = b(m + 1, 2)
      point%displacement_rate = dot_product(arm, b(:m, 1))
      point%axial_power = -dot_product(axial, b(:m, 1))
      call self%find_press(point)
   end subroutine solve_point

   !> The largest force by which a point is out of equilibrium, moments over the height [N].
   real(wp) function unbalance(self, springs, point)
      class(pressed_balance), intent(inout) :: self
      type(spring_array), intent(in) :: springs
      type(pressed_point), intent(inout) :: point
      real(wp), dimension(size(point%q), size(point%q)) :: tangent
      real(wp), dimension(size(point%q)) :: arm, pushed, axial, missing
      real(wp) :: displacement
      integer :: i

      call self%find_press(point)
      call self%assemble(springs, point, tangent, missing, arm, pushed, axial, displacement)
      if (self%column%held) call self%hold_top(tangent, missing, pushed, axial)
      unbalance = 0.0_wp
      do i = 1, size(missing)
         unbalance = max(unbalance, merge(abs(missing(i))/self%column%joint_height(self%column%n + 1), &
                                          abs(missing(i)), self%is_moment(i)))
      end do
   end function unbalance

   !> Whether an unknown is a rotation.
   pure logical function is_moment(self, i)
      class(pressed_balance), intent(in) :: self
      integer, intent(in) :: i

      is_moment = i > self%column%n .and. i <= 2*self%column%n
   end function is_moment

   !> Whether a stiffness is positive definite; it is overwritten.
   logical function is_stable(stiffness)
      real(wp), intent(inout) :: stiffness(:, :)

      call factor_positive(stiffness, is_stable)
   end function is_stable

end module rbs_solve_static_pressed_balance
