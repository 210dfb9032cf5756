!> Equilibrium on a curved path, the springs on their present lines, and how it goes on.
!>
!> What is driven, c, and the axial load at the top are linear in the parameter t of the path,
!>
!>     c = c_0 + c' t,   N = N_0 + N' t + r F
!>
!> with r F as in an exterior column of a frame; where N is constant, t is c. In absolute rotations joint by
!> joint (see `rbs_structure_column_dead_loads`), with the loads less the forces of the springs R(z, F, N) and
!> their derivatives K = -dR/dz, a = dR/dF, p = dR/dN, rates and corrections follow from one band with a
!> border,
!>
!>     [K    -(a + r p)] [dz]   [p N'         R             ]
!>     [a'    0        ] [dF] = [c'    |      what c misses ]
!>
!> Layered joints under an axial load that varies are on planes M = m + k phi - e N.
module rbs_solve_static_curved_equilibrium
   use rbs_base_band_matrix, only: band_matrix
   use rbs_base_kinds, only: wp
   use rbs_structure_column_column, only: column_type, small
   use rbs_structure_column_dead_loads, only: per_joint, dead_loads, add_springs, to_joints
   use rbs_hysteresis_springs, only: spring_array
   implicit none
   private

   public :: curved_equilibrium, path_point

   !> Largest correction: rotation [rad], slip per height.
   real(wp), parameter :: most_change = 1.0_wp

   !> Deformations [rad, m] below this are those of a column that stands straight under a load that varies,
   !> but for round-off; those below the second share of the largest mean nothing.
   real(wp), parameter :: straight_column = 1.0e-12_wp, no_deformation = 1.0e-13_wp

   !> A state of equilibrium, and its derivatives by the parameter of the path.
   type :: path_point
      real(wp) :: t = 0.0_wp
      !> Deformations (unknowns), lateral force [N], displacement of the top [m], axial load at the top [N]
      real(wp), allocatable :: q(:)
      real(wp) :: force = 0.0_wp, displacement = 0.0_wp, axial_load = 0.0_wp
      real(wp), allocatable :: rate(:)
      real(wp) :: force_rate = 0.0_wp, displacement_rate = 0.0_wp, axial_rate = 0.0_wp
      !> Of the potential of a unit of the axial load [m]
      real(wp) :: lift_rate = 0.0_wp
   end type path_point

   type :: curved_equilibrium
      !> Whether the force is driven, else the displacement; whether the axial load varies
      logical :: by_force = .false., varies = .false.
      !> What is driven and the axial load at t = 0, and their rates
      real(wp) :: driven(2) = [0.0_wp, 1.0_wp], load(2) = 0.0_wp, ratio = 0.0_wp
      !> The column under its constant axial loads alone, which where the load at the top varies is the
      !> weight, and under a unit at the top
      class(column_type), allocatable :: steady, unit
      !> Weight above the joints that layered joints feel (unknowns) [N]
      real(wp), allocatable :: above(:)
      !> Largest slip, relative rotation and opening so far
      real(wp) :: scale(3) = 0.0_wp
      !> What takes the residual away: of the deformations (unknowns), and of the force [N]
      real(wp), allocatable :: correction(:)
      real(wp) :: force_correction = 0.0_wp
      !> The column under the present loads, and its tangent
      type(column_type), private :: column
      type(band_matrix), private :: tangent
      !> R, a, p and its part without springs, right-hand sides and solutions, joint by joint; forces of
      !> springs
      real(wp), allocatable, private :: residual(:), arm(:), pushed(:), lift(:), right(:, :), &
                                        change(:, :), f(:)
   contains
      procedure :: create
      procedure :: solve
      procedure :: size_of
      procedure :: remember
      procedure :: unbalance
   end type curved_equilibrium

contains

   subroutine create(self, column, by_force, varies)
      class(curved_equilibrium), intent(out) :: self
      !> Under the axial load with which the path begins
      class(column_type), intent(in) :: column
      logical, intent(in) :: by_force, varies
      real(wp), allocatable :: band(:, :)
      integer :: m

      m = column%unknowns
      self%column = column
      self%steady = column
      self%by_force = by_force
      self%varies = varies
      allocate (self%right(m, 2), self%change(m, 2), self%residual(m), self%arm(m), self%pushed(m), &
                self%lift(m), self%correction(m), self%f(m), self%above(m), source=0.0_wp)
      if (varies) call take_load_off(self)
      ! The initial stiffness on the diagonal of the tangent, joint by joint.
      allocate (band(per_joint(column) + 1, m), source=0.0_wp)
      call add_springs(column, self%f, column%initial_stiffness, self%residual, band)
      call self%tangent%create(m, per_joint(column), band(1, :))
   end subroutine create

   !> The axial load at the top apart from the weight, which is taken from the bodies: what is left when the
   !> load is taken off would depend on it by round-off, and a path that is cut begins under another load.
   subroutine take_load_off(self)
      type(curved_equilibrium), intent(inout) :: self
      real(wp) :: second_order
      integer :: i

      self%ratio = self%column%axial_force_ratio
      self%unit = self%steady
      second_order = merge(0.0_wp, 1.0_wp, self%column%kinematics == small)
      associate (unit => self%unit, steady => self%steady, n => self%column%n)
         unit%axial_load = 1.0_wp
         unit%weight = 0.0_wp
         unit%axially_loaded = unit%kinematics /= small
         unit%axial_joint = unit%axial_lever
         unit%axial_body = second_order*unit%axial_lever
         unit%axial_slip = unit%axial_body
         steady%axial_load = 0.0_wp
         steady%axial_joint(n) = steady%weight(n)
         do i = n - 1, 1, -1
            steady%axial_joint(i) = steady%axial_joint(i + 1) + steady%weight(i)
         end do
         self%above(n + 1:2*n) = steady%axial_joint
         steady%axial_body = second_order*(steady%axial_joint - 0.5_wp*steady%weight)
         steady%axial_slip = second_order*steady%axial_joint
         if (steady%held) then
            unit%axial_slip(n) = 0.0_wp
            steady%axial_slip(n) = 0.0_wp
         end if
      end associate
   end subroutine take_load_off

   !> Residual and tangent at a point, and its displacement.
   subroutine assemble(self, springs, point)
      type(curved_equilibrium), intent(inout) :: self
      type(spring_array), intent(in) :: springs
      type(path_point), intent(inout) :: point
      integer :: i, j, m

      m = self%column%unknowns
      self%f = springs%f0 + springs%k*(point%q - springs%d0)
      if (self%varies) then
         point%axial_load = self%load(1) + self%load(2)*point%t + self%ratio*point%force
         self%column%axial_body = self%steady%axial_body + point%axial_load*self%unit%axial_body
         self%column%axial_joint = self%steady%axial_joint + point%axial_load*self%unit%axial_joint
         self%column%axial_slip = self%steady%axial_slip + point%axial_load*self%unit%axial_slip
         call dead_loads(self%unit, point%q, 0.0_wp, self%lift, self%arm, self%tangent%band, &
                         point%displacement)
         self%pushed = self%lift
         if (springs%pressed) then
            self%f(:) = self%f - springs%centre*(point%axial_load + self%above - springs%press_at)
            do j = 1, size(springs%layered)
               i = self%column%place(springs%layered(j))%index*per_joint(self%column)
               self%pushed(i) = self%pushed(i) + springs%centre(springs%layered(j))
               i = i - per_joint(self%column)
               if (i > 0) self%pushed(i) = self%pushed(i) - springs%centre(springs%layered(j))
            end do
         end if
      end if
      call dead_loads(self%column, point%q, point%force, self%residual, self%arm, self%tangent%band, &
                      point%displacement)
      call add_springs(self%column, self%f, springs%k, self%residual, self%tangent%band)
      if (.not. self%column%held) return
      self%residual(m) = 0.0_wp
      self%pushed(m) = 0.0_wp
      call self%tangent%hold(m, self%tangent%stiffness(m))
   end subroutine assemble

   !> Rates at a point, and what takes its residual away; under a driven force it must be stable.
   subroutine solve(self, springs, point, found)
      class(curved_equilibrium), intent(inout) :: self
      type(spring_array), intent(in) :: springs
      type(path_point), intent(inout) :: point
      logical, intent(out) :: found
      real(wp) :: missing, y(2)
      integer :: n, per

      n = self%column%n
      per = per_joint(self%column)
      missing = self%driven(1) + self%driven(2)*point%t
      if (self%by_force) point%force = missing
      call assemble(self, springs, point)
      missing = missing - point%displacement
      call self%tangent%factor()
      self%right(:, 1) = self%pushed*self%load(2)
      ! The last digits of forces near zero would look as if the system had no solution.
      self%right(:, 2) = merge(self%residual, 0.0_wp, abs(self%residual) > sqrt(tiny(1.0_wp)))
      if (self%by_force) then
         found = self%tangent%positive
         if (.not. found) return
         self%change(:, 1) = self%right(:, 1) + (self%arm + self%ratio*self%pushed)*self%driven(2)
         self%change(:, 2) = self%residual
         call self%tangent%solve(self%change, found)
         y = [self%driven(2), 0.0_wp]
         point%displacement_rate = dot_product(self%arm, self%change(:, 1))
      else
         if (abs(self%ratio) > 0.0_wp) then
            call self%tangent%set_border(self%arm + self%ratio*self%pushed, self%arm, found)
         else
            call self%tangent%set_border(self%arm, regular=found)
         end if
         if (found) call self%tangent%solve_bordered(self%right, [self%driven(2), missing], self%change, y, &
                                                     found)
         point%displacement_rate = self%driven(2)
      end if
      if (.not. found) return
      point%force_rate = y(1)
      self%force_correction = y(2)
      point%axial_rate = self%load(2) + self%ratio*y(1)
      point%lift_rate = -dot_product(self%lift, self%change(:, 1))
      call to_joints(self%column, per, self%change(:, 1), point%rate)
      call to_joints(self%column, per, self%change(:, 2), self%correction)
      found = maxval(abs(self%change(per::per, 2))) < most_change .and. &
              maxval(abs(self%correction(:n))) < most_change*self%column%joint_height(n + 1)
   end subroutine solve

   !> Largest change of slips, relative rotations and openings, in shares of the largest of their kind.
   pure real(wp) function size_of(self, change, q) result(largest)
      class(curved_equilibrium), intent(in) :: self
      real(wp), intent(in) :: change(:), q(:)
      real(wp) :: reach, most, least
      integer :: i, n

      n = self%column%n
      largest = 0.0_wp
      ! Rotations times a height, so that all are ways [m].
      least = max(no_deformation*maxval(abs(self%column%arm*q)), tiny(1.0_wp))
      if (self%varies) least = max(least, straight_column)
      do i = 1, self%column%unknowns/n
         associate (some => q(n*(i - 1) + 1:n*i), more => change(n*(i - 1) + 1:n*i))
            reach = max(self%scale(i), maxval(abs(some + more)), least)
            most = maxval(abs(more))
            largest = max(largest, min(most, 1.0e10_wp*reach)/reach)
         end associate
      end do
   end function size_of

   !> Remember the largest deformations of each kind.
   pure subroutine remember(self, q)
      class(curved_equilibrium), intent(inout) :: self
      real(wp), intent(in) :: q(:)
      integer :: i, n

      n = self%column%n
      do i = 1, self%column%unknowns/n
         self%scale(i) = max(self%scale(i), maxval(abs(q(n*(i - 1) + 1:n*i))))
      end do
   end subroutine remember

   !> The largest force by which a point is out of equilibrium, moments over the height [N].
   real(wp) function unbalance(self, springs, point)
      class(curved_equilibrium), intent(inout) :: self
      type(spring_array), intent(in) :: springs
      type(path_point), intent(inout) :: point
      real(wp) :: displacement
      integer :: per

      per = per_joint(self%column)
      displacement = point%displacement
      call assemble(self, springs, point)
      point%displacement = displacement
      self%residual(per::per) = self%residual(per::per)/self%column%joint_height(self%column%n + 1)
      unbalance = maxval(abs(self%residual))
   end function unbalance

end module rbs_solve_static_curved_equilibrium
