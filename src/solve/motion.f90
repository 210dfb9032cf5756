!> Equation of motion of the column: the acceleration at a state, on the present lines of the springs.
!>
!>     M q'' + beta k0 q' + alpha M q' + f(q) + K_G q = a F - b a_g
!>
!> with a = `arm`, b = `ground_arm`. One body with finite rotation: the paper's eq 4 without its last
!> term in row 2, which is a misprint (it makes energy drift).
module rbs_solve_motion
   use rbs_base_error, only: error_type, fatal_error, bad_input
   use rbs_base_kinds, only: wp
   use rbs_base_linalg, only: factor_positive, invert_positive, solve_positive
   use rbs_column_axial, only: geometric_forces, axial_energy
   use rbs_column_column, only: column_type, finite
   use rbs_column_mass, only: symmetric_mass
   implicit none
   private

   public :: motion_type

   type :: motion_type
      type(column_type) :: column
      !> Mass matrix (2 n, 2 n), and its Cholesky factor, or its inverse for one body
      real(wp), allocatable :: mass(:, :), solver(:, :)
      !> Damping of the joints, beta k0 (2 n)
      real(wp), allocatable :: joint_damping(:)
      !> Whether there is damping at all
      logical :: damped = .false.
      !> Work array (2 n)
      real(wp), allocatable, private :: g(:)
   contains
      procedure :: create
      procedure :: acceleration
      procedure :: power
      procedure :: kinetic_energy
      procedure :: potential
      procedure :: top_displacement
   end type motion_type

contains

   subroutine create(self, column, error)
      class(motion_type), intent(out) :: self
      type(column_type), intent(in) :: column
      type(error_type), allocatable, intent(out) :: error
      logical :: positive
      integer :: m

      m = column%unknowns
      self%column = column
      self%joint_damping = column%stiffness_damping*column%initial_stiffness
      self%damped = column%mass_damping > 0.0_wp .or. column%stiffness_damping > 0.0_wp
      allocate (self%mass(m, m))
      allocate (self%g(m), source=0.0_wp)
      call symmetric_mass(column, self%mass)
      self%solver = self%mass
      if (column%n == 1) then
         call invert_positive(self%solver, positive)
      else
         call factor_positive(self%solver, positive)
      end if
      if (.not. positive) then
         call fatal_error(error, bad_input, 'column: the mass matrix is not positive definite in the '// &
                          'arithmetic; check masses and lengths for extreme ratios')
      end if
   end subroutine create

   !> Acceleration of the unknowns.
   subroutine acceleration(self, q, v, f, force, ground, a)
      class(motion_type), intent(inout) :: self
      !> Deformations, their velocities, forces of the springs (2 n)
      real(wp), intent(in) :: q(:), v(:), f(:)
      !> Lateral force [N] and acceleration of the ground [m/s2]
      real(wp), intent(in) :: force, ground
      !> Accelerations (2 n)
      real(wp), intent(out) :: a(:)
      real(wp) :: r1

      if (self%column%kinematics == finite) then
         call accelerate_finite(self, q, v, f, force, ground, a)
         return
      end if
      a = self%column%arm*force - self%column%ground_arm*ground - f
      if (self%column%axially_loaded) then
         call geometric_forces(self%column, q, self%g)
         a = a - self%g
      end if
      if (self%damped) a = a - self%joint_damping*v
      if (self%column%n == 1) then
         r1 = a(1)
         a(1) = self%solver(1, 1)*r1 + self%solver(1, 2)*a(2)
         a(2) = self%solver(2, 1)*r1 + self%solver(2, 2)*a(2)
      else
         call solve_positive(self%solver, a)
      end if
      if (self%damped) a = a - self%column%mass_damping*v
   end subroutine acceleration

   !> One body, finite rotation (corrected eq 4, with axial load and weight).
   pure subroutine accelerate_finite(self, q, v, f, force, ground, a)
      class(motion_type), intent(in) :: self
      real(wp), intent(in) :: q(:), v(:), f(:), force, ground
      real(wp), intent(out) :: a(:)
      real(wp) :: m, half, inertia, s, c, r_u, r_th, coupling, determinant

      m = self%column%mass(1)
      half = 0.5_wp*self%column%length(1)
      inertia = self%column%inertia_above(1)
      s = sin(q(2))
      c = cos(q(2))
      coupling = m*half*c
      r_u = force - m*ground - f(1) + m*half*s*v(2)**2
      r_th = (2.0_wp*half*c)*force + self%column%axial_body(1)*(2.0_wp*half)*s - coupling*ground - f(2)
      if (self%damped) then
         r_u = r_u - self%joint_damping(1)*v(1) - self%column%mass_damping*(m*v(1) + coupling*v(2))
         r_th = r_th - self%joint_damping(2)*v(2) - self%column%mass_damping*(coupling*v(1) + inertia*v(2))
      end if
      determinant = m*inertia - coupling**2
      a(1) = (inertia*r_u - coupling*r_th)/determinant
      a(2) = (m*r_th - coupling*r_u)/determinant
   end subroutine accelerate_finite

   !> Power of the loads and of the damping [W].
   pure subroutine power(self, q, v, force, ground, of_loads, of_damping)
      class(motion_type), intent(in) :: self
      real(wp), intent(in) :: q(:), v(:), force, ground
      real(wp), intent(out) :: of_loads, of_damping
      real(wp) :: arm, ground_arm

      if (self%column%kinematics == finite) then
         arm = self%column%length(1)*cos(q(2))
         ground_arm = 0.5_wp*self%column%mass(1)*arm
         of_loads = force*(v(1) + arm*v(2)) - ground*(self%column%mass(1)*v(1) + ground_arm*v(2))
      else
         of_loads = dot(self%column%arm, v)*force - dot(self%column%ground_arm, v)*ground
      end if
      of_damping = 0.0_wp
      if (self%damped) then
         of_damping = sum(self%joint_damping*v**2) &
                      + 2.0_wp*self%column%mass_damping*self%kinetic_energy(q, v)
      end if
   end subroutine power

   pure real(wp) function dot(a, b)
      real(wp), intent(in) :: a(:), b(:)
      integer :: i

      dot = 0.0_wp
      do i = 1, size(a)
         dot = dot + a(i)*b(i)
      end do
   end function dot

   !> Kinetic energy [J].
   pure real(wp) function kinetic_energy(self, q, v) result(energy)
      class(motion_type), intent(in) :: self
      real(wp), intent(in) :: q(:), v(:)

      if (self%column%kinematics == finite) then
         energy = 0.5_wp*self%column%mass(1)*v(1)**2 + 0.5_wp*self%column%inertia_above(1)*v(2)**2 &
                  + 0.5_wp*self%column%mass(1)*self%column%length(1)*cos(q(2))*v(1)*v(2)
      else
         energy = 0.5_wp*dot(v, matmul(self%mass, v))
      end if
   end function kinetic_energy

   !> Potential of axial load and weight, zero for the straight column [J].
   pure real(wp) function potential(self, q) result(energy)
      class(motion_type), intent(in) :: self
      real(wp), intent(in) :: q(:)

      if (self%column%kinematics == finite) then
         ! 1 - cos without cancellation
         energy = -2.0_wp*self%column%axial_body(1)*self%column%length(1)*sin(0.5_wp*q(2))**2
      else if (self%column%axially_loaded) then
         energy = axial_energy(self%column, q)
      else
         energy = 0.0_wp
      end if
   end function potential

   !> Displacement of the top [m].
   pure real(wp) function top_displacement(self, q) result(x)
      class(motion_type), intent(in) :: self
      real(wp), intent(in) :: q(:)

      if (self%column%kinematics == finite) then
         x = q(1) + self%column%length(1)*sin(q(2))
      else
         x = dot(self%column%arm, q)
      end if
   end function top_displacement

end module rbs_solve_motion
