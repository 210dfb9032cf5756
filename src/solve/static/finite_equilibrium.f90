!> Equilibrium with exact rotations, the springs on their present lines: Newton's method with what is
!> driven as one more equation.
!>
!>     g(z, F) = loads - springs = 0,   and one of   x_T(z) = target,   F = target,   d_s(z) = end
!>
!> The last one puts a spring exactly on the end of its line. The tangent K = -dg/dz is a symmetric band in
!> absolute rotations (see `rbs_column_dead_loads`).
module rbs_solve_static_finite_equilibrium
   use rbs_base_band_matrix, only: band_matrix
   use rbs_base_kinds, only: wp
   use rbs_column_column, only: column_type
   use rbs_column_dead_loads, only: per_joint, dead_loads, add_springs, to_joints
   use rbs_hysteresis_springs, only: spring_array
   implicit none
   private

   public :: finite_equilibrium, path_point

   !> Newton's method has converged if a change is below this share of the largest deformation of its kind:
   !> the next one would be its square. Where round-off ends the progress before, that must be below the
   !> second share.
   real(wp), parameter :: arrived = 1.0e-10_wp, no_progress = 1.0e-7_wp

   !> Most iterations, and the largest change in one of them: rotation [rad], slip per height.
   integer, parameter :: most_iterations = 15
   real(wp), parameter :: most_change = 1.0_wp

   !> A state of equilibrium and how it changes.
   type :: path_point
      !> Deformations (unknowns), lateral force [N], displacement of the top [m]
      real(wp), allocatable :: q(:)
      real(wp) :: force = 0.0_wp, displacement = 0.0_wp
      !> Change of the deformations per unit of what is driven in its direction, and derivatives of force
      !> and displacement by what is driven
      real(wp), allocatable :: rate(:)
      real(wp) :: force_rate = 0.0_wp, displacement_rate = 0.0_wp
   end type path_point

   type :: finite_equilibrium
      type(column_type) :: column
      !> Whether the force is driven, else the displacement
      logical :: by_force = .false.
      !> Largest slip, relative rotation and opening so far
      real(wp) :: scale(3) = 0.0_wp
      type(band_matrix), private :: tangent
      !> Right-hand side, arms and border, change of the unknowns, all joint by joint; change of the joints
      real(wp), allocatable, private :: load(:, :), arm(:), border(:), change(:, :), joints(:), f(:)
   contains
      procedure :: create
      procedure :: find_point
      procedure :: find_rates
      procedure :: settle
      procedure :: remember
      procedure :: find_balance
      procedure :: unbalance
   end type finite_equilibrium

contains

   subroutine create(self, column, by_force)
      class(finite_equilibrium), intent(out) :: self
      type(column_type), intent(in) :: column
      logical, intent(in) :: by_force
      real(wp), allocatable :: stiffness(:), none(:), band(:, :)
      integer :: m

      m = column%unknowns
      self%column = column
      self%by_force = by_force
      allocate (self%load(m, 1), self%change(m, 1), self%arm(m), self%border(m), self%joints(m), self%f(m), &
                source=0.0_wp)
      ! The initial stiffness on the diagonal of the tangent, joint by joint.
      allocate (none(m), source=0.0_wp)
      allocate (band(per_joint(column) + 1, m), source=0.0_wp)
      call add_springs(column, none, column%initial_stiffness, self%f, band)
      stiffness = band(1, :)
      call self%tangent%create(column%unknowns, per_joint(column), stiffness)
   end subroutine create

   !> Newton's method from a guess.
   subroutine find_point(self, springs, point, spring, value, found)
      class(finite_equilibrium), intent(inout) :: self
      type(spring_array), intent(in) :: springs
      !> On entry a guess of deformations and force, on return the point without its rates
      type(path_point), intent(inout) :: point
      !> Spring whose deformation is prescribed; 0: what is driven
      integer, intent(in) :: spring
      !> Its prescribed value
      real(wp), intent(in) :: value
      !> Whether a point was found; if not, `point` is undefined
      logical, intent(out) :: found
      real(wp) :: change, last_change, more_force
      logical :: regular
      integer :: i

      found = .false.
      if (spring == 0 .and. self%by_force) point%force = value
      last_change = huge(1.0_wp)
      do i = 1, most_iterations
         call find_correction(self, springs, point, spring, value, more_force, regular)
         if (.not. regular) return
         if (.not. reasonable(self)) return
         change = relative_change(self, point%q)
         point%q = point%q + self%joints
         point%force = point%force + more_force
         if (spring > 0) point%q(spring) = value
         found = change <= arrived .or. (change <= no_progress .and. change > 0.25_wp*last_change)
         if (found) exit
         if (i > 3 .and. change > 2.0_wp*last_change) return
         last_change = change
      end do
      if (found) call see(self, springs, point)
   end subroutine find_point

   !> Take away what little a point is out of equilibrium: one step of Newton's method.
   subroutine settle(self, springs, point, value)
      class(finite_equilibrium), intent(inout) :: self
      type(spring_array), intent(in) :: springs
      type(path_point), intent(inout) :: point
      !> What is driven, there
      real(wp), intent(in) :: value
      real(wp) :: more_force
      logical :: regular

      call find_correction(self, springs, point, 0, value, more_force, regular)
      if (.not. regular) return
      if (relative_change(self, point%q) > no_progress) return
      point%q = point%q + self%joints
      point%force = point%force + more_force
   end subroutine settle

   !> What takes a point to equilibrium at a displacement of the top.
   subroutine find_balance(self, springs, point, displacement, correction, more_force, regular)
      class(finite_equilibrium), intent(inout) :: self
      type(spring_array), intent(in) :: springs
      type(path_point), intent(inout) :: point
      real(wp), intent(in) :: displacement
      real(wp), intent(out) :: correction(:), more_force
      logical, intent(out) :: regular
      logical :: by_force

      by_force = self%by_force
      self%by_force = .false.
      call find_correction(self, springs, point, 0, displacement, more_force, regular)
      self%by_force = by_force
      correction = self%joints
      if (regular) regular = reasonable(self)
   end subroutine find_balance

   !> The largest force by which a point is out of equilibrium, moments over the height [N].
   real(wp) function unbalance(self, springs, point)
      class(finite_equilibrium), intent(inout) :: self
      type(spring_array), intent(in) :: springs
      type(path_point), intent(inout) :: point
      real(wp) :: displacement
      integer :: i

      displacement = point%displacement
      call see(self, springs, point)
      point%displacement = displacement
      unbalance = 0.0_wp
      do i = 1, self%column%unknowns
         associate (off => abs(self%load(i, 1)))
            unbalance = max(unbalance, merge(off/self%column%joint_height(self%column%n + 1), off, &
                                             modulo(i, per_joint(self%column)) == 0))
         end associate
      end do
   end function unbalance

   !> Loads less springs and the tangent, and the displacement of the top.
   subroutine see(self, springs, point)
      type(finite_equilibrium), intent(inout) :: self
      type(spring_array), intent(in) :: springs
      type(path_point), intent(inout) :: point

      self%f = springs%f0 + springs%k*(point%q - springs%d0)
      call dead_loads(self%column, point%q, point%force, self%load(:, 1), self%arm, self%tangent%band, &
                      point%displacement)
      call add_springs(self%column, self%f, springs%k, self%load(:, 1), self%tangent%band)
      if (.not. self%column%held) return
      self%load(self%column%unknowns, 1) = 0.0_wp
      call self%tangent%hold_last(self%tangent%stiffness(self%column%unknowns))
   end subroutine see

   !> One iteration: what takes the residuals away.
   subroutine find_correction(self, springs, point, spring, value, more_force, regular)
      type(finite_equilibrium), intent(inout) :: self
      type(spring_array), intent(in) :: springs
      type(path_point), intent(inout) :: point
      integer, intent(in) :: spring
      real(wp), intent(in) :: value
      real(wp), intent(out) :: more_force
      logical, intent(out) :: regular
      real(wp) :: y(1)

      call see(self, springs, point)
      call self%tangent%factor()
      y = 0.0_wp
      if (spring > 0) then
         call find_border(self, spring)
         call self%tangent%set_border(self%arm, self%border, regular)
         if (regular) call self%tangent%solve_bordered(self%load, [value - point%q(spring)], self%change, y, &
                                                       regular)
      else if (self%by_force) then
         self%change = self%load
         call self%tangent%solve(self%change, regular)
      else
         call self%tangent%set_border(self%arm, regular=regular)
         if (regular) call self%tangent%solve_bordered(self%load, [value - point%displacement], self%change, &
                                                       y, regular)
      end if
      more_force = y(1)
      if (regular) call to_joints(self%column, per_joint(self%column), self%change(:, 1), self%joints)
   end subroutine find_correction

   !> Derivative of the deformation of a spring.
   subroutine find_border(self, spring)
      type(finite_equilibrium), intent(inout) :: self
      integer, intent(in) :: spring
      integer :: n, per, joint

      n = self%column%n
      per = per_joint(self%column)
      joint = modulo(spring - 1, n) + 1
      self%border = 0.0_wp
      if (spring <= n) then
         self%border(per*(joint - 1) + 1) = 1.0_wp
      else if (spring > 2*n) then
         self%border(per*(joint - 1) + 2) = 1.0_wp
      else
         if (joint < n .or. .not. self%column%held) self%border(per*joint) = 1.0_wp
         if (joint > 1) self%border(per*(joint - 1)) = -1.0_wp
      end if
   end subroutine find_border

   !> Whether the correction is within reasonable bounds.
   pure logical function reasonable(self)
      type(finite_equilibrium), intent(in) :: self
      integer :: n, per

      n = self%column%n
      per = per_joint(self%column)
      reasonable = maxval(abs(self%change(per::per, 1))) < most_change .and. &
                   maxval(abs(self%joints(:n))) < most_change*self%column%joint_height(n + 1)
   end function reasonable

   !> Largest change of slips, relative rotations and openings, in shares of the largest of their kind.
   pure real(wp) function relative_change(self, q) result(change)
      type(finite_equilibrium), intent(in) :: self
      real(wp), intent(in) :: q(:)
      real(wp) :: largest
      integer :: i, n

      n = self%column%n
      change = 0.0_wp
      do i = 1, self%column%unknowns/n
         associate (some => q(n*(i - 1) + 1:n*i), more => self%joints(n*(i - 1) + 1:n*i))
            largest = max(self%scale(i), maxval(abs(some + more)), tiny(1.0_wp))
            change = max(change, min(maxval(abs(more)), largest/arrived)/largest)
         end associate
      end do
   end function relative_change

   !> Rates at a point; `found` is whether it can be followed: under a driven force it must be stable.
   subroutine find_rates(self, springs, point, direction, found)
      class(finite_equilibrium), intent(inout) :: self
      type(spring_array), intent(in) :: springs
      type(path_point), intent(inout) :: point
      integer, intent(in) :: direction
      logical, intent(out) :: found
      real(wp) :: y(1)

      call see(self, springs, point)
      call self%tangent%factor()
      if (self%by_force) then
         found = self%tangent%positive
         if (.not. found) return
         self%change(:, 1) = self%arm
         call self%tangent%solve(self%change, found)
         point%force_rate = 1.0_wp
         point%displacement_rate = dot_product(self%arm, self%change(:, 1))
      else
         call self%tangent%set_border(self%arm, regular=found)
         self%load = 0.0_wp
         if (found) call self%tangent%solve_bordered(self%load, [1.0_wp], self%change, y, found)
         if (.not. found) return
         point%force_rate = y(1)
         point%displacement_rate = 1.0_wp
      end if
      call to_joints(self%column, per_joint(self%column), self%change(:, 1), point%rate)
      if (direction < 0) point%rate = -point%rate
   end subroutine find_rates

   !> Remember the largest deformations of each kind.
   pure subroutine remember(self, q)
      class(finite_equilibrium), intent(inout) :: self
      real(wp), intent(in) :: q(:)
      integer :: i, n

      n = self%column%n
      do i = 1, self%column%unknowns/n
         self%scale(i) = max(self%scale(i), maxval(abs(q(n*(i - 1) + 1:n*i))))
      end do
   end subroutine remember

end module rbs_solve_static_finite_equilibrium
