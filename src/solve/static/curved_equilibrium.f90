!> Equilibrium of a column on a curved path, the springs on their present lines, and its rates.
!>
!> The driven quantity, c, and the axial load at the top are linear in the parameter t of the path,
!>
!>     c = c_0 + c' t,   N = N_0 + N' t + r F
!>
!> with r F as in an exterior column of a frame; where N is constant, t is c. The dead loads have the
!> potential
!>
!>     A = sum P_i l_i cos th_i + sum Q_i (-u_i sin th_{i-1} + w_i cos th_{i-1}) - F x_T
!>     x_T = sum l_i sin th_i + u_i cos th_{i-1} + w_i sin th_{i-1}
!>
!> or, with the other kinematics, to second order without the work of the lateral force on rotated bodies and
!> the axial loads on openings of rotated joints; th_0 = 0. In absolute rotations joints meet only their
!> neighbours: unknowns z are ordered joint by joint, slip, opening if there is one, absolute rotation. With
!> the loads less the forces of the springs R(z, F, N) and their derivatives K = -dR/dz, a = dR/dF, p = dR/dN,
!> rates and corrections follow from one band with a border,
!>
!>     [K    -(a + r p)] [dz]   [p N'         R             ]
!>     [a'    0        ] [dF] = [c'    |      error of c ]
!>
!> Layered joints under an axial load that varies are on planes M = m + k phi - e N.
module rbs_solve_static_curved_equilibrium
   use rbs_base_band_matrix, only: band_matrix
   use rbs_base_kinds, only: wp
   use rbs_structure_column_column, only: column_type, small, finite
   use rbs_hysteresis_springs, only: spring_array
   use rbs_structure_spring_location, only: shear, flexure, opening => axial
   implicit none
   private

   public :: curved_equilibrium, path_point

   !> Largest correction: rotation [rad], slip per height.
   real(wp), parameter :: most_change = 1.0_wp

   !> Deformations [rad, m] below this are those of a straight column under a load that varies,
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
      !> Deformations and rates of springs and layers (lines)
      real(wp), allocatable :: d(:), v(:)
   end type path_point

   type :: curved_equilibrium
      !> Whether the force is driven, else the displacement; whether the axial load varies
      logical :: by_force = .false., varies = .false.
      !> Driven quantity and axial load at t = 0, and their rates
      real(wp) :: driven(2) = [0.0_wp, 1.0_wp], load(2) = 0.0_wp, ratio = 0.0_wp
      class(column_type), pointer :: column => null()
      !> Where the load at the top varies, the column under its weight alone, and weightless under a unit
      class(column_type), allocatable :: without_top_load, unit_top_load
      !> Weight above the joints, which acts on layered joints (unknowns) [N]
      real(wp), allocatable :: above(:)
      !> Largest slip, relative rotation and opening so far
      real(wp) :: scale(3) = 0.0_wp
      !> Corrections that take the residual away: of the deformations (unknowns), and of the force [N]
      real(wp), allocatable :: correction(:)
      real(wp) :: force_correction = 0.0_wp
      !> Unknowns of a joint: also the number of diagonals beside the main one
      integer, private :: per = 2
      !> Axial forces on rotations of bodies, slips and openings (n, 3): constant ones, per unit of the load
      !> at the top, present ones
      real(wp), allocatable, private :: constant(:, :), per_load(:, :), axial(:, :)
      type(band_matrix), private :: tangent
      !> R, a, p and its part without springs, right-hand sides and solutions, joint by joint; forces of
      !> springs
      real(wp), allocatable, private :: residual(:), arm(:), pushed(:), lift(:), right(:, :), &
                                        change(:, :), f(:)
   contains
      procedure :: create, solve, size_of, remember, unbalance
   end type curved_equilibrium

contains

   !> Make room for a column, with the axial forces on it and the scale of the pivots.
   subroutine create(self, column, by_force, varies)
      class(curved_equilibrium), intent(out) :: self
      !> Under the axial load with which the path begins
      class(column_type), intent(in), target :: column
      !> Whether the force is driven, else the displacement; whether the axial load varies
      logical, intent(in) :: by_force, varies
      real(wp) :: stiffness(column%unknowns)
      integer :: m

      m = column%unknowns
      self%column => column
      self%by_force = by_force
      self%varies = varies
      self%per = column%kinds
      allocate (self%right(m, 2), self%change(m, 2), self%residual(m), self%arm(m), self%pushed(m), &
                self%lift(m), self%correction(m), self%f(m), self%above(m), source=0.0_wp)
      call list_axial_forces(column, self%constant)
      if (varies) then
         ! The rest after the load is taken off would depend on it by round-off, and a path that is cut
         ! begins under another load.
         self%ratio = column%axial_force_ratio
         allocate (self%without_top_load, self%unit_top_load, source=column)
         call self%without_top_load%put_under(0.0_wp)
         self%unit_top_load%weight = 0.0_wp
         call self%unit_top_load%put_under(1.0_wp)
         call list_axial_forces(self%without_top_load, self%constant)
         call list_axial_forces(self%unit_top_load, self%per_load)
         self%above(column%at(flexure, :)) = self%without_top_load%compression
      end if
      self%axial = self%constant
      ! The initial stiffness on the diagonal of the tangent, joint by joint.
      call self%tangent%create(m, self%per)
      call add_springs(self, column%initial_stiffness)
      stiffness = self%tangent%band(1, :)
      call self%tangent%create(m, self%per, stiffness)
   end subroutine create

   !> Axial forces of a column that do work on rotations of bodies (1), on slips (2) and on openings (3) (n,
   !> 3) [N]; with small displacements only those on openings do.
   subroutine list_axial_forces(column, axial)
      class(column_type), intent(in) :: column
      real(wp), allocatable, intent(out) :: axial(:, :)

      allocate (axial(column%n, 3), source=0.0_wp)
      axial(:, 3) = column%axial_joint
      if (column%kinematics == small) return
      axial(:, 1) = column%axial_body
      axial(:, 2) = column%axial_slip
   end subroutine list_axial_forces

   !> Find the residual and the tangent at a point; the point gets its axial load and displacement.
   subroutine assemble(self, springs, point)
      type(curved_equilibrium), intent(inout) :: self
      type(spring_array), intent(in) :: springs
      type(path_point), intent(inout) :: point
      integer :: i, j, m

      m = self%column%unknowns
      self%f = springs%forces(point%q)
      if (self%varies) then
         point%axial_load = self%load(1) + self%load(2)*point%t + self%ratio*point%force
         self%axial = self%constant + point%axial_load*self%per_load
         call find_loads(self, self%per_load, point%q, 0.0_wp, self%lift, point%displacement)
         self%pushed = self%lift
         if (springs%axial_load_varies) then
            self%f(:) = self%f - springs%centre*(point%axial_load + self%above - springs%reference_axial_load)
            ! The moment of a joint on its plane falls with N by `centre`, on the bodies above and below.
            do j = 1, size(springs%layered)
               i = self%column%location(springs%layered(j))%index*self%per
               self%pushed(i) = self%pushed(i) + springs%centre(springs%layered(j))
               i = i - self%per
               if (i > 0) self%pushed(i) = self%pushed(i) - springs%centre(springs%layered(j))
            end do
         end if
      end if
      call find_loads(self, self%axial, point%q, point%force, self%residual, point%displacement)
      call add_springs(self, springs%k)
      if (.not. self%column%held) return
      self%residual(m) = 0.0_wp
      self%pushed(m) = 0.0_wp
      call self%tangent%hold(m, self%tangent%stiffness(m))
   end subroutine assemble

   !> Generalised loads -dA/dz, arms dx_T/dz and stiffness d2A/dz2 under axial forces.
   subroutine find_loads(self, axial, q, force, load, top)
      class(curved_equilibrium), intent(inout) :: self
      !> Axial forces on rotations of bodies, slips and openings (n, 3) [N]; deformations of the joints (n,
      !> per)
      real(wp), intent(in) :: axial(self%column%n, 3), q(self%column%n, self%per)
      !> Lateral force [N]
      real(wp), intent(in) :: force
      !> Joint by joint [N, N, N m]
      real(wp), intent(out), contiguous :: load(:)
      !> Displacement of the top [m]
      real(wp), intent(out) :: top
      real(wp) :: rotation, s, c, across, along, opened, exact
      integer :: i, j, n

      n = self%column%n
      exact = merge(1.0_wp, 0.0_wp, self%column%kinematics == finite)
      top = 0.0_wp
      rotation = 0.0_wp
      s = 0.0_wp
      c = 1.0_wp
      opened = 0.0_wp
      associate (arm => self%arm, band => self%tangent%band, length => self%column%length)
         band = 0.0_wp
         do i = 1, n
            if (i == n .and. self%column%held) then
               ! A held body does not turn, and its joint moves along its directions.
               s = 0.0_wp
               c = 1.0_wp
            end if
            ! Forces of the loads above, across and along the body below the joint.
            across = force*c + axial(i, 2)*s
            along = exact*force*s - axial(i, 2)*c
            j = self%per*(i - 1)
            load(j + 1) = across
            arm(j + 1) = c
            if (self%per == 3) then
               opened = q(i, opening)
               load(j + 2) = exact*force*s - axial(i, 3)*c
               arm(j + 2) = exact*s
            end if
            top = top + q(i, shear)*c + exact*opened*s
            if (j > 0 .and. .not. (i == n .and. self%column%held)) then
               load(j) = load(j) - q(i, shear)*along + exact*opened*across
               arm(j) = arm(j) - exact*(q(i, shear)*s - opened*c)
               band(1, j) = band(1, j) + exact*(q(i, shear)*across + opened*along)
               band(2, j) = along
               if (self%per == 3) band(3, j) = -exact*across
            end if
            rotation = rotation + q(i, flexure)
            if (exact > 0.0_wp) then
               s = sin(rotation)
               c = cos(rotation)
            else
               s = rotation
            end if
            j = self%per*i
            load(j) = length(i)*(force*c + axial(i, 1)*s)
            arm(j) = length(i)*c
            band(1, j) = length(i)*(exact*force*s - axial(i, 1)*c)
            top = top + length(i)*s
         end do
      end associate
   end subroutine find_loads

   !> Take the forces of the springs from the loads and add their stiffness.
   subroutine add_springs(self, k)
      class(curved_equilibrium), intent(inout) :: self
      !> Stiffness of the springs (n, per)
      real(wp), intent(in) :: k(self%column%n, self%per)
      integer :: i, j, per

      per = self%per
      associate (load => self%residual, band => self%tangent%band, f => self%f, at => self%column%at)
         do i = 1, self%column%n
            ! Unknown j is the rotation of the body below, and those of the joint come behind it.
            j = per*(i - 1)
            load(j + 1) = load(j + 1) - f(at(shear, i))
            band(1, j + 1) = band(1, j + 1) + k(i, shear)
            if (per == 3) then
               load(j + 2) = load(j + 2) - f(at(opening, i))
               band(1, j + 2) = band(1, j + 2) + k(i, opening)
            end if
            load(j + per) = load(j + per) - f(at(flexure, i))
            band(1, j + per) = band(1, j + per) + k(i, flexure)
            if (j == 0) cycle
            load(j) = load(j) + f(at(flexure, i))
            band(1, j) = band(1, j) + k(i, flexure)
            band(per + 1, j) = band(per + 1, j) - k(i, flexure)
         end do
      end associate
   end subroutine add_springs

   !> Changes of the deformations of the joints from those of the unknowns joint by joint.
   pure subroutine to_joints(n, per, z, q)
      !> Numbers of joints, and of unknowns of a joint
      integer, intent(in) :: n, per
      !> Slip, opening if there is one, and absolute rotation of each joint
      real(wp), intent(in) :: z(per, n)
      !> Slip, relative rotation, opening if there is one
      real(wp), intent(out) :: q(n, per)
      real(wp) :: below
      integer :: i

      below = 0.0_wp
      do i = 1, n
         q(i, shear) = z(1, i)
         q(i, flexure) = z(per, i) - below
         below = z(per, i)
         if (per == 3) q(i, opening) = z(2, i)
      end do
   end subroutine to_joints

   !> Rates at a point, and the correction of its residual; under a driven force it must be stable.
   subroutine solve(self, springs, point, found)
      class(curved_equilibrium), intent(inout) :: self
      type(spring_array), intent(in) :: springs
      !> Its place on the path, deformations and force; gets its displacement and rates
      type(path_point), intent(inout) :: point
      !> Whether there is a unique correction of bounded size
      logical, intent(out) :: found
      real(wp) :: residual, y(2)
      integer :: n, per

      n = self%column%n
      per = self%per
      residual = self%driven(1) + self%driven(2)*point%t
      if (self%by_force) point%force = residual
      call assemble(self, springs, point)
      residual = residual - point%displacement
      call self%tangent%factor()
      self%right(:, 1) = self%pushed*self%load(2)
      ! The last digits of forces near zero would suggest that the system has no solution.
      self%right(:, 2) = merge(self%residual, 0.0_wp, abs(self%residual) > sqrt(tiny(1.0_wp)))
      if (self%by_force) then
         found = self%tangent%positive
         if (.not. found) return
         ! With the driven quantity (1), and the correction (2).
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
         if (found) call self%tangent%solve_bordered(self%right(:, 1), self%driven(2), self%change(:, 1), &
                                                     y(1), found)
         if (found) call self%tangent%solve_bordered(self%right(:, 2), residual, self%change(:, 2), &
                                                     y(2), found)
         point%displacement_rate = self%driven(2)
      end if
      if (.not. found) return
      point%force_rate = y(1)
      self%force_correction = y(2)
      point%axial_rate = self%load(2) + self%ratio*y(1)
      point%lift_rate = -dot_product(self%lift, self%change(:, 1))
      call to_joints(n, per, self%change(:, 1), point%rate)
      call to_joints(n, per, self%change(:, 2), self%correction)
      found = maxval(abs(self%change(per::per, 2))) < most_change .and. &
              maxval(abs(self%correction(:n))) < most_change*self%column%total_height
   end subroutine solve

   !> Largest change of slips, relative rotations and openings, in shares of the largest of their kind.
   pure real(wp) function size_of(self, change, q) result(largest)
      class(curved_equilibrium), intent(in) :: self
      !> Change, and deformations that it is made from (unknowns)
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
      !> Deformations: slips, relative rotations, openings if there are any (unknowns)
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

      ! `assemble` sets the displacement by the deformations; that of the path stays.
      displacement = point%displacement
      call assemble(self, springs, point)
      point%displacement = displacement
      self%residual(self%per::self%per) = self%residual(self%per::self%per)/self%column%total_height
      unbalance = maxval(abs(self%residual))
   end function unbalance

end module rbs_solve_static_curved_equilibrium
