!> Exact rotations by an independent method: positions of the bodies' masses and of the lumped mass as in
!> theory.md section 2, their derivatives by Taylor arithmetic, and the dense M = sum J' diag(m, m, I) J.
module exact
   use rbs_base_constants, only: pi
   use rbs_base_kinds, only: wp
   use rbs_base_linalg, only: solve_dense
   use rbs_structure_column_column, only: column_type
   use rbs_structure_column_column_record, only: column_record
   use samples, only: chain, elastic, random_type
   implicit none
   private

   public :: jet, point, variant, state
   public :: sample, variant_of, random_state, place, dense_acceleration

   !> A function of time: value, first and second derivative.
   type :: jet
      real(wp) :: d(0:2) = 0.0_wp
   end type jet

   !> A moving mass point with rotary inertia.
   type :: point
      type(jet) :: x, y, rotation
      real(wp) :: mass = 0.0_wp, inertia = 0.0_wp
   end type point

   !> Properties by which the columns differ.
   type :: variant
      logical :: opens = .false., lumped = .false.
   end type variant

   !> A state of motion and its loads.
   type :: state
      real(wp), allocatable :: q(:), v(:), f(:)
      real(wp) :: load(4) = 0.0_wp
   end type state

   interface operator(+)
      module procedure :: plus
   end interface operator(+)

   interface operator(*)
      module procedure :: times, scaled
   end interface operator(*)

contains

   pure type(jet) function plus(a, b)
      type(jet), intent(in) :: a, b

      plus%d = a%d + b%d
   end function plus

   pure type(jet) function times(a, b)
      type(jet), intent(in) :: a, b

      times%d(0) = a%d(0)*b%d(0)
      times%d(1) = a%d(1)*b%d(0) + a%d(0)*b%d(1)
      times%d(2) = a%d(2)*b%d(0) + 2.0_wp*a%d(1)*b%d(1) + a%d(0)*b%d(2)
   end function times

   pure type(jet) function scaled(a, b)
      real(wp), intent(in) :: a
      type(jet), intent(in) :: b

      scaled%d = a*b%d
   end function scaled

   pure type(jet) function sine(a)
      type(jet), intent(in) :: a

      sine%d(0) = sin(a%d(0))
      sine%d(1) = cos(a%d(0))*a%d(1)
      sine%d(2) = cos(a%d(0))*a%d(2) - sin(a%d(0))*a%d(1)**2
   end function sine

   pure type(jet) function cosine(a)
      type(jet), intent(in) :: a

      cosine%d(0) = cos(a%d(0))
      cosine%d(1) = -sin(a%d(0))*a%d(1)
      cosine%d(2) = -sin(a%d(0))*a%d(2) - cos(a%d(0))*a%d(1)**2
   end function cosine

   !> Column of n different bodies with all optional properties.
   type(column_record) function sample(n, kind) result(spec)
      integer, intent(in) :: n
      type(variant), intent(in) :: kind

      spec = chain(n, 'finite')
      spec%axial_load = 2.0e4_wp
      spec%self_weight = .true.
      spec%depth = 0.4_wp
      spec%damping%mass = 0.7_wp
      if (kind%lumped) then
         spec%top_mass = 500.0_wp
         spec%top_inertia = 30.0_wp
      end if
      if (kind%opens) then
         allocate (spec%axial_spring(1))
         spec%axial_spring(1) = elastic(1.0e9_wp)
      end if
   end function sample

   !> All variants, by number 1 to 16.
   pure type(variant) function variant_of(i)
      integer, intent(in) :: i

      variant_of = variant(btest(i, 0), btest(i, 1))
   end function variant_of

   !> A state far from the straight column, with more than full turns.
   type(state) function random_state(column, random) result(now)
      class(column_type), intent(in) :: column
      type(random_type), intent(inout) :: random
      integer :: i, n

      n = column%n
      allocate (now%q(column%unknowns), now%v(column%unknowns), now%f(column%unknowns))
      do i = 1, column%unknowns
         now%q(i) = random%uniform(-0.3_wp, 0.3_wp)
         if (i > n .and. i <= 2*n) now%q(i) = random%uniform(-2.5_wp*pi, 2.5_wp*pi)
         now%v(i) = random%uniform(-3.0_wp, 3.0_wp)
         now%f(i) = random%uniform(-1.0e4_wp, 1.0e4_wp)
      end do
      now%load = [random%uniform(-1.0e4_wp, 1.0e4_wp), random%uniform(-9.0_wp, 9.0_wp), &
                  random%uniform(-9.0_wp, 9.0_wp), random%uniform(-1.0e4_wp, 1.0e4_wp)]
   end function random_state

   !> Motion of the mass points while the unknowns move as q + v s + a s^2/2: the masses at mid-length of the
   !> bodies, and as last point the lumped mass at the top (n + 1).
   subroutine place(spec, q, v, a, points)
      type(column_record), intent(in) :: spec
      real(wp), intent(in) :: q(:), v(:), a(:)
      type(point), intent(out) :: points(:)
      type(jet) :: moving(size(q)), x, y, rotation
      integer :: i, n

      n = spec%n
      do i = 1, size(q)
         moving(i)%d = [q(i), v(i), a(i)]
      end do
      do i = 1, n
         x = x + moving(i)*cosine(rotation)
         y = y + (-1.0_wp)*(moving(i)*sine(rotation))
         if (allocated(spec%axial_spring)) then
            x = x + moving(2*n + i)*sine(rotation)
            y = y + moving(2*n + i)*cosine(rotation)
         end if
         rotation = rotation + moving(n + i)
         points(i)%x = x + (0.5_wp*spec%lengths(i))*sine(rotation)
         points(i)%y = y + (0.5_wp*spec%lengths(i))*cosine(rotation)
         points(i)%rotation = rotation
         points(i)%mass = spec%masses(i)
         points(i)%inertia = spec%masses(i)*(spec%lengths(i)**2 + spec%depth**2)/12.0_wp
         x = x + spec%lengths(i)*sine(rotation)
         y = y + spec%lengths(i)*cosine(rotation)
      end do
      points(n + 1)%x = x
      points(n + 1)%y = y
      points(n + 1)%rotation = rotation
      points(n + 1)%mass = spec%top_mass
      points(n + 1)%inertia = spec%top_inertia
   end subroutine place

   !> J of all points (3, n + 1, unknowns).
   subroutine find_jacobian(spec, q, jacobian)
      type(column_record), intent(in) :: spec
      real(wp), intent(in) :: q(:)
      real(wp), intent(out) :: jacobian(:, :, :)
      type(point) :: points(spec%n + 1)
      real(wp) :: one(size(q)), zero(size(q))
      integer :: j, k

      zero = 0.0_wp
      do j = 1, size(q)
         one = 0.0_wp
         one(j) = 1.0_wp
         call place(spec, q, one, zero, points)
         do k = 1, spec%n + 1
            jacobian(:, k, j) = [points(k)%x%d(1), points(k)%y%d(1), points(k)%rotation%d(1)]
         end do
      end do
   end subroutine find_jacobian

   !> M = sum J' diag(m, m, I) J.
   subroutine dense_mass(spec, q, mass)
      type(column_record), intent(in) :: spec
      real(wp), intent(in) :: q(:)
      real(wp), intent(out) :: mass(:, :)
      type(point) :: points(spec%n + 1)
      real(wp) :: jacobian(3, spec%n + 1, size(q)), weighted(3, spec%n + 1, size(q))
      integer :: i, j, k

      call find_jacobian(spec, q, jacobian)
      call place(spec, q, q, q, points)
      do k = 1, spec%n + 1
         weighted(:2, k, :) = points(k)%mass*jacobian(:2, k, :)
         weighted(3, k, :) = points(k)%inertia*jacobian(3, k, :)
      end do
      do j = 1, size(q)
         do i = 1, size(q)
            mass(i, j) = sum(jacobian(:, :, i)*weighted(:, :, j))
         end do
      end do
   end subroutine dense_mass

   !> M a = J'(F - m c''(q'' = 0)) - f.
   subroutine dense_acceleration(spec, now, a, largest)
      type(column_record), intent(in) :: spec
      type(state), intent(in) :: now
      real(wp), intent(out) :: a(:)
      !> Size of the terms in the accelerations
      real(wp), intent(out) :: largest
      type(point) :: points(spec%n + 1)
      real(wp) :: jacobian(3, spec%n + 1, size(now%q)), mass(size(now%q), size(now%q))
      real(wp) :: force(3), right(size(now%q)), axial, g
      integer :: j, k, n
      logical :: regular

      n = spec%n
      call find_jacobian(spec, now%q, jacobian)
      call dense_mass(spec, now%q, mass)
      call place(spec, now%q, now%v, 0.0_wp*now%v, points)
      right = -now%f
      do k = 1, n + 1
         g = spec%gravity
         if (k > n) g = 0.0_wp
         associate (p => points(k))
            force(1) = -p%mass*(now%load(2) + p%x%d(2) + spec%damping%mass*p%x%d(1))
            force(2) = -p%mass*(now%load(3) + g + p%y%d(2) + spec%damping%mass*p%y%d(1))
            force(3) = -p%inertia*(p%rotation%d(2) + spec%damping%mass*p%rotation%d(1))
         end associate
         if (k > n) then
            axial = spec%axial_load + now%load(4)
            force(:2) = force(:2) + [now%load(1), -axial]
         end if
         do j = 1, size(a)
            right(j) = right(j) + sum(force*jacobian(:, k, j))
         end do
      end do
      call solve_dense(mass, right, regular)
      if (.not. regular) error stop 'test_finite: singular mass matrix'
      a = right
      largest = maxval(abs(a))
   end subroutine dense_acceleration

end module exact
