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
         ! Compression lowers the frequencies, tension raises them: the higher ones are the safe ones,
         ! and cover a column that loses its axial load.
         call solve_modes(column, .false., plain, shapes, error)
         if (allocated(error)) return
         plain = max(plain, modes%omega)
      end if
      modes%stable_step = huge(1.0_wp)
      do i = size(plain), 1, -1
         modes%stable_step = min(modes%stable_step, stable_step(plain(i), column%mass_damping &
                                                                + column%stiffness_damping*plain(i)**2))
         if (.not. (column%mass_damping > 0.0_wp .or. column%stiffness_damping > 0.0_wp)) exit
      end do
   end subroutine find_modes

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

      h = 2.0_wp*sqrt(2.0_wp)/omega
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
