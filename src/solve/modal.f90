!> Natural frequencies, mode shapes and the stable step of RK4.
module rbs_solve_modal
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_base_linalg, only: solve_eigen
   use rbs_column_axial, only: geometric_stiffness, check_stable
   use rbs_column_column, only: column_type
   use rbs_column_mass, only: symmetric_mass
   implicit none
   private

   public :: modes_type, find_modes

   !> The stability region of RK4 ends here on the negative real axis: z = -2.785293563...
   real(wp), parameter :: real_limit = 2.785293563405282_wp

   !> The left half of a disc of this radius lies in the stability region; it touches at 122.7 degrees.
   real(wp), parameter :: least_radius = 2.615587_wp

   !> A mode slower than this [rad/s] sets no limit.
   real(wp), parameter :: slowest = 1.0e-100_wp

   type :: modes_type
      !> Circular frequencies, ascending (2 n) [rad/s]
      real(wp), allocatable :: omega(:)
      !> Shapes in (slip, relative rotation), one a column, with shape' M shape = 1 (2 n, 2 n)
      real(wp), allocatable :: shapes(:, :)
      !> Longest step for which RK4 is stable [s]
      real(wp) :: stable_step = 0.0_wp
   end type modes_type

contains

   !> Modes of the uncracked column; the axial forces count where the kinematics let them.
   subroutine find_modes(column, modes, error)
      type(column_type), intent(in) :: column
      type(modes_type), intent(out) :: modes
      type(error_type), allocatable, intent(out) :: error
      real(wp), allocatable :: plain(:), shapes(:, :)
      integer :: i

      call check_stable(column, error)
      if (allocated(error)) return
      call solve_modes(column, column%axially_loaded, modes%omega, modes%shapes, error)
      if (allocated(error)) return
      plain = modes%omega
      if (column%axially_loaded) then
         call solve_modes(column, .false., plain, shapes, error)
         if (allocated(error)) return
      end if
      modes%stable_step = huge(1.0_wp)
      do i = 1, size(plain)
         modes%stable_step = min(modes%stable_step, step_of_mode(column, plain(i), modes%omega(i)))
      end do
   end subroutine find_modes

   !> Longest stable step for one mode, on the safe side of what is not known.
   pure real(wp) function step_of_mode(column, plain, loaded) result(h)
      type(column_type), intent(in) :: column
      !> Circular frequency without and with axial forces [rad/s]
      real(wp), intent(in) :: plain, loaded
      real(wp) :: omega, c

      omega = max(plain, loaded)
      c = column%mass_damping + column%stiffness_damping*plain**2
      if (column%axially_loaded .and. column%stiffness_damping > 0.0_wp) then
         ! The axial load is not in the damping, so the modes do not part; but no eigenvalue is larger
         ! than the larger of omega and c.
         h = least_radius/max(omega, c)
      else
         h = stable_step(omega, c)
      end if
      ! Where springs yield, their stiffness goes and their damping stays: the eigenvalue -c is left.
      if (c > 0.0_wp .and. any(column%spring%rule /= 'elastic')) h = min(h, real_limit/c)
   end function step_of_mode

   !> Eigenproblem K x = omega^2 M x of the uncracked column.
   subroutine solve_modes(column, axial, omega, shapes, error)
      type(column_type), intent(in) :: column
      !> Whether the axial forces count
      logical, intent(in) :: axial
      real(wp), allocatable, intent(out) :: omega(:), shapes(:, :)
      type(error_type), allocatable, intent(out) :: error
      real(wp), allocatable :: mass(:, :)
      integer :: i, m

      m = column%unknowns
      allocate (mass(m, m), omega(m))
      allocate (shapes(m, m), source=0.0_wp)
      if (axial) call geometric_stiffness(column, shapes)
      do i = 1, m
         shapes(i, i) = shapes(i, i) + column%initial_stiffness(i)
      end do
      call symmetric_mass(column, mass)
      call solve_eigen(shapes, mass, omega, error)
      if (.not. allocated(error)) omega = sqrt(max(omega, 0.0_wp))
   end subroutine solve_modes

   !> Longest stable step of RK4 for x'' + c x' + omega^2 x = 0: the largest h with |R(lambda h)| <= 1
   !> for both eigenvalues, R(z) = 1 + z + z^2/2 + z^3/6 + z^4/24. Without damping 2 sqrt(2)/omega.
   pure real(wp) function stable_step(omega, c) result(h)
      real(wp), intent(in) :: omega, c
      complex(wp) :: root, lambda(2)
      real(wp) :: below, above
      integer :: i

      h = 2.0_wp*sqrt(2.0_wp)/max(omega, slowest)
      if (.not. c > 0.0_wp) return
      root = sqrt(cmplx((c/2.0_wp)**2 - omega**2, 0.0_wp, wp))
      ! The larger real root without cancellation, the other from the product of the roots.
      lambda(1) = -c/2.0_wp - root
      lambda(2) = omega**2/lambda(1)
      ! |lambda h| stays below 4 in the region of stability.
      below = 0.0_wp
      above = 4.0_wp/abs(lambda(1))
      do i = 1, 100
         h = 0.5_wp*(below + above)
         if (all(growth(lambda*h) <= 1.0_wp + 1.0e-12_wp)) then
            below = h
         else
            above = h
         end if
      end do
      h = below
   end function stable_step

   elemental real(wp) function growth(z)
      complex(wp), intent(in) :: z

      growth = abs(1.0_wp + z*(1.0_wp + z/2.0_wp*(1.0_wp + z/3.0_wp*(1.0_wp + z/4.0_wp))))
   end function growth

end module rbs_solve_modal
