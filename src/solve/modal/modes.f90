!> Natural frequencies, mode shapes and the stable step of RK4.
module rbs_solve_modal_modes
   use rbs_base_error, only: error_type, fatal_error, analysis_failed, bad_input
   use rbs_base_kinds, only: wp
   use rbs_base_linalg, only: singular_values, solve_upper
   use rbs_base_small_systems, only: factor_positive
   use rbs_base_text, only: to_text
   use rbs_column_axial, only: geometric_stiffness, critical_factor, check_stable
   use rbs_column_band, only: to_joints
   use rbs_column_column, only: column_type
   use rbs_column_ends, only: check_inertia_of_ends
   use rbs_column_frequency, only: frequency_range
   use rbs_column_column_record, only: most_dense
   implicit none
   private

   public :: modes_type, find_modes, frequency_bounds, stability_limit

   !> The stability region of RK4 ends here on the negative real axis: z = -2.785293563...
   real(wp), parameter :: real_limit = 2.785293563405282_wp

   !> The left half of a disc of this radius lies in the stability region; it touches at 122.7 degrees.
   real(wp), parameter :: least_radius = 2.615587_wp

   !> A mode slower than this [rad/s] sets no limit.
   real(wp), parameter :: slowest = 1.0e-100_wp

   !> Above this condition the modes come with a warning.
   real(wp), parameter :: worst_condition = 1.0e4_wp

   type :: modes_type
      !> Circular frequencies, ascending (unknowns) [rad/s]
      real(wp), allocatable :: omega(:)
      !> Shapes in (slip, relative rotation [, opening]), one a column, with shape' M shape = 1 and the
      !> top going to +x or up (unknowns, unknowns)
      real(wp), allocatable :: shapes(:, :)
      !> Longest step for which RK4 is stable [s]
      real(wp) :: stable_step = 0.0_wp
      !> How much a relative error of a stiffness or of the axial load can grow in the square of a
      !> frequency: (f + 1)/(f - 1), where f times the axial load is the critical one; 1 without
      real(wp) :: condition = 1.0_wp
      !> Blank, or what to beware of
      character(len=200) :: warning = ''
   end type modes_type

contains

   !> Modes of the uncracked column; the axial forces count where the kinematics let them.
   !>
   !> An eigenproblem of K and M would lose the low frequencies of stiff joints and small masses. Here
   !> omega are the singular values of
   !>
   !>     R diag(sqrt k) B diag(1/sqrt m),  R' R = diag(1/sqrt k) (diag k + K_G) diag(1/sqrt k)
   !>
   !> (B from the bodies' motions to the joints' deformations, m the bodies' masses, R = 1 without axial
   !> forces), a product of extreme diagonals and harmless matrices, and keep their relative accuracy.
   subroutine find_modes(column, modes, error)
      type(column_type), intent(in) :: column
      type(modes_type), intent(out) :: modes
      type(error_type), allocatable, intent(out) :: error
      real(wp), allocatable :: a(:, :), root(:, :), scale(:)
      integer :: i, m, n
      logical :: positive

      n = column%n
      if (n > most_dense) then
         call fatal_error(error, bad_input, 'modes: all modes are found for up to '//to_text(most_dense)// &
                          ' bodies, not for n = '//to_text(n)//'; take a coarser chain for the modes. '// &
                          'A dynamic analysis does not need them, it finds its stable step for any n')
         return
      end if
      ! This also refuses a column that buckles under its axial load alone.
      call stability_limit(column, modes%stable_step, error)
      if (allocated(error)) return
      call set_condition(column, modes)

      ! Where the top is held, the relative rotation of the last joint follows from the others.
      m = 2*n
      if (column%held) m = m - 1
      call weighted_joints(column, a)
      allocate (modes%omega(size(a, 2)))
      allocate (modes%shapes(column%unknowns, size(a, 2)), source=0.0_wp)
      if (column%axially_loaded .or. column%held) then
         call factor_loaded(column, m, root, scale, positive)
         if (.not. positive) then
            call fatal_error(error, analysis_failed, 'modes: the axial load is the critical one within '// &
                             'round-off, there is no lowest frequency; reduce axial_load')
            return
         end if
         call block_modes(a(:m, :m), scale, modes%omega(:m), modes%shapes(:m, :m), error, root)
      else
         call block_modes(a(:m, :m), sqrt(column%initial_stiffness(:m)), modes%omega(:m), &
                          modes%shapes(:m, :m), error)
      end if
      if (allocated(error)) return
      do i = n + 1, merge(m, 0, column%held)
         modes%shapes(2*n, :m) = modes%shapes(2*n, :m) - modes%shapes(i, :m)
      end do
      if (column%opens) then
         call block_modes(a(2*n + 1:, m + 1:), sqrt(column%initial_stiffness(2*n + 1:)), &
                          modes%omega(m + 1:), modes%shapes(2*n + 1:, m + 1:), error)
         if (allocated(error)) return
      end if
      call arrange(column, m, modes)
   end subroutine find_modes

   !> Deformations of the joints per motion of the bodies, divided by the roots of their masses:
   !> B diag(1/sqrt m) (unknowns, unknowns; one column less where a rotation is held).
   subroutine weighted_joints(column, a)
      type(column_type), intent(in) :: column
      real(wp), allocatable, intent(out) :: a(:, :)
      real(wp) :: x(column%unknowns), mass(column%unknowns)
      integer :: at, j, n

      n = column%n
      mass(1:2*n:2) = column%mass
      mass(2:2*n:2) = column%inertia
      if (column%opens) mass(2*n + 1:) = column%mass
      allocate (a(column%unknowns, column%unknowns - merge(1, 0, column%held)))
      x = 0.0_wp
      at = 0
      do j = 1, column%unknowns
         if (column%held .and. j == 2*n) cycle
         at = at + 1
         x(j) = 1.0_wp
         call to_joints(column, x, a(:, at))
         x(j) = 0.0_wp
         a(:, at) = a(:, at)/sqrt(mass(j))
      end do
   end subroutine weighted_joints

   !> Cholesky factor of the stiffness with axial forces, scaled to a diagonal of ones:
   !> diag(k) + K_G = diag(scale) root root' diag(scale).
   subroutine factor_loaded(column, m, root, scale, positive)
      type(column_type), intent(in) :: column
      !> 2 n, or 2 n - 1 where the top is held: the last rotation is then minus the sum of the others
      integer, intent(in) :: m
      !> Lower triangle (m, m), zeros above
      real(wp), allocatable, intent(out) :: root(:, :)
      !> (m)
      real(wp), allocatable, intent(out) :: scale(:)
      logical, intent(out) :: positive
      real(wp), allocatable :: stiffness(:, :)
      integer :: i, j, n

      n = column%n
      allocate (stiffness(column%unknowns, column%unknowns), source=0.0_wp)
      if (column%axially_loaded) call geometric_stiffness(column, stiffness)
      do i = 1, 2*n
         stiffness(i, i) = stiffness(i, i) + column%initial_stiffness(i)
      end do
      if (m < 2*n) then
         do j = 1, m
            if (j > n) stiffness(:2*n, j) = stiffness(:2*n, j) - stiffness(:2*n, 2*n)
            stiffness(n + 1:m, j) = stiffness(n + 1:m, j) - stiffness(2*n, j)
         end do
      end if
      allocate (root(m, m))
      allocate (scale(m))
      root = stiffness(:m, :m)
      do i = 1, m
         scale(i) = sqrt(max(root(i, i), tiny(1.0_wp)))
      end do
      do i = 1, m
         root(:, i) = root(:, i)/scale/scale(i)
      end do
      call factor_positive(root, positive)
      do i = 2, m
         root(:i - 1, i) = 0.0_wp
      end do
   end subroutine factor_loaded

   !> Frequencies, descending, and shapes of one block of unknowns: the left vectors v of root' diag(scale) a
   !> give the shapes omega diag(scale)^-1 root'^-1 v.
   subroutine block_modes(a, scale, omega, shapes, error, root)
      !> (m, m) and (m)
      real(wp), intent(in) :: a(:, :), scale(:)
      !> (m) and (m, m)
      real(wp), intent(out) :: omega(:), shapes(:, :)
      type(error_type), allocatable, intent(out) :: error
      !> (m, m); the identity if it is absent
      real(wp), intent(in), contiguous, optional :: root(:, :)
      real(wp), allocatable :: scaled(:, :), left(:, :), values(:)
      integer :: i, m

      m = size(scale)
      allocate (scaled(m, m), left(m, m), values(m))
      do i = 1, m
         scaled(:, i) = scale*a(:, i)
      end do
      if (present(root)) scaled = matmul(transpose(root), scaled)
      call singular_values(scaled, values, left, error)
      if (allocated(error)) return
      if (present(root)) call solve_upper(root, left)
      omega = values
      do i = 1, m
         shapes(:, i) = values(i)*(left(:, i)/scale)
      end do
   end subroutine block_modes

   !> Put the modes in ascending order, the top going to +x or, if it only goes along the column, up.
   subroutine arrange(column, laterals, modes)
      type(column_type), intent(in) :: column
      !> Number of modes of slips and rotations, which come first
      integer, intent(in) :: laterals
      type(modes_type), intent(inout) :: modes
      real(wp), allocatable :: omega(:), shapes(:, :)
      real(wp) :: top
      integer :: i, lateral, m, n, opening, taken

      m = size(modes%omega)
      n = column%n
      allocate (omega, source=modes%omega)
      allocate (shapes, source=modes%shapes)
      ! Two descending lists, taken from their ends.
      lateral = laterals
      opening = m
      do i = 1, m
         taken = lateral
         if (opening > laterals) then
            if (lateral == 0) then
               taken = opening
            else if (omega(opening) < omega(lateral)) then
               taken = opening
            end if
         end if
         if (taken > laterals) then
            opening = opening - 1
         else
            lateral = lateral - 1
         end if
         modes%omega(i) = omega(taken)
         top = dot_product(column%arm, shapes(:, taken)) + sum(shapes(2*n + 1:, taken))
         modes%shapes(:, i) = sign(1.0_wp, top)*shapes(:, taken)
      end do
   end subroutine arrange

   !> Condition of the modes under axial load.
   subroutine set_condition(column, modes)
      type(column_type), intent(in) :: column
      type(modes_type), intent(inout) :: modes
      type(error_type), allocatable :: ignored
      real(wp) :: factor, share

      if (.not. column%axially_loaded) return
      call critical_factor(column, factor, ignored)
      share = 1.0_wp/factor
      modes%condition = (1.0_wp + share)/max(1.0_wp - share, epsilon(1.0_wp))
      if (modes%condition < worst_condition) return
      modes%warning = 'the axial load is '//to_text(share)//' of the critical one: a relative error of '// &
                      'a stiffness or of the load may grow by '//to_text(modes%condition)// &
                      ' in the square of the lowest frequency'
   end subroutine set_condition

   !> Lowest and highest circular frequency of the uncracked column [rad/s], for any number of bodies in
   !> O(n); the axial forces count where the kinematics let them.
   subroutine frequency_bounds(column, lowest, highest, error)
      type(column_type), intent(in) :: column
      real(wp), intent(out) :: lowest, highest
      type(error_type), allocatable, intent(out) :: error

      lowest = 0.0_wp
      highest = huge(1.0_wp)
      call check_inertia_of_ends(column, error)
      if (.not. allocated(error)) call check_stable(column, error)
      if (.not. allocated(error)) call frequency_range(column, column%axially_loaded, lowest, highest)
   end subroutine frequency_bounds

   !> Longest step for which RK4 is stable [s], for any number of bodies in O(n).
   !>
   !> Only the lowest and the highest frequency are asked: with c = alpha + beta omega^2 the limit of one mode
   !> first grows with omega and then falls (see the tests), and with c = 2 zeta omega, or on the half disc,
   !> it only falls; so no mode between two has a shorter limit than both.
   subroutine stability_limit(column, limit, error)
      type(column_type), intent(in) :: column
      real(wp), intent(out) :: limit
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: plain(2), loaded(2)

      limit = 0.0_wp
      call frequency_bounds(column, loaded(1), loaded(2), error)
      if (allocated(error)) return
      plain = loaded
      if (column%axially_loaded) call frequency_range(column, .false., plain(1), plain(2))
      limit = min(step_of_mode(column, plain(1), loaded(1)), step_of_mode(column, plain(2), loaded(2)))
   end subroutine stability_limit

   !> Longest stable step for one mode, on the safe side of what is not known.
   !>
   !> Whatever lines the springs are on, a motion lambda^2 x + lambda M^-1 C x + M^-1 K x = 0 obeys the scalar
   !> equation of the quotients c = x'Cx/x'Mx and k = x'Kx/x'Mx of its shape. So |lambda| is at most the
   !> larger of the largest c and omega, which always gives a safe step; where c follows from the initial
   !> stiffness in the shape, the scalar equations themselves give the longest one.
   pure real(wp) function step_of_mode(column, plain, loaded) result(h)
      type(column_type), intent(in) :: column
      !> Circular frequency without and with axial forces [rad/s]
      real(wp), intent(in) :: plain, loaded
      real(wp) :: omega, c, remaining
      logical :: elastic, apart

      elastic = all(column%spring%rule == 'elastic')
      omega = max(plain, loaded)
      c = column%mass_damping + column%stiffness_damping*plain**2
      ! Stiffness damping has no axial forces in it.
      apart = .not. (column%axially_loaded .and. column%stiffness_damping > 0.0_wp)
      if (allocated(column%modal_damping)) then
         c = c + 2.0_wp*maxval(column%modal_damping)*loaded
         apart = elastic .and. size(column%modal_damping) == 1 .and. &
                 .not. (column%mass_damping > 0.0_wp .or. column%stiffness_damping > 0.0_wp)
      end if
      if (.not. apart) then
         h = least_radius/max(omega, c, slowest)
         return
      end if
      h = stable_step(omega, c)
      if (elastic) return
      ! Where springs yield, their stiffness goes and their damping stays, unless it is that of the present
      ! lines: the eigenvalue -c is left.
      remaining = merge(column%mass_damping, c, column%tangent_damping)
      if (remaining > 0.0_wp) h = min(h, real_limit/remaining)
   end function step_of_mode

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

end module rbs_solve_modal_modes
