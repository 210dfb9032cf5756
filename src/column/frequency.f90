!> Lowest and highest natural frequency of the uncracked column, in O(n) time and memory and to the last
!> digits: each by bisection on whether a matrix is positive definite, in the coordinates in which nothing
!> cancels.
module rbs_column_frequency
   use rbs_base_kinds, only: wp
   use rbs_base_linalg, only: is_dominated
   use rbs_column_band, only: add_spring_band, add_geometric_band, opening_band
   use rbs_column_column, only: column_type
   implicit none
   private

   public :: frequency_range

contains

   !> Lowest and highest circular frequency [rad/s], openings included. The column must be stable.
   subroutine frequency_range(column, axial, lowest, highest)
      type(column_type), intent(in) :: column
      !> Whether the axial forces count
      logical, intent(in) :: axial
      real(wp), intent(out) :: lowest, highest
      real(wp) :: low, high

      lowest = sqrt(lowest_square(column, axial))
      highest = sqrt(highest_square(column, axial))
      if (.not. column%opens) return
      call opening_squares(column, low, high)
      lowest = min(lowest, sqrt(low))
      highest = max(highest, sqrt(high))
   end subroutine frequency_range

   !> Square of the lowest frequency of slips and rotations: K - s M is positive definite below it.
   pure real(wp) function lowest_square(column, axial) result(below)
      type(column_type), intent(in) :: column
      logical, intent(in) :: axial
      real(wp) :: above, between, greatest, softness, pushed, total
      integer :: i, n
      logical :: more

      ! Dunkerley and Rayleigh: the trace of K^-1 M and its largest diagonal entry bracket 1/s.
      n = column%n
      total = 0.0_wp
      greatest = 0.0_wp
      pushed = 0.0_wp
      do i = n, 1, -1
         softness = column%mass_above(i)/column%initial_stiffness(i)
         total = total + softness
         greatest = max(greatest, softness)
         if (axial) pushed = pushed + column%axial_body(i)*column%length(i)
         softness = column%inertia_above(i)/column%initial_stiffness(n + i)
         total = total + softness
         ! No joint turns alone where the top is held.
         if (column%held) cycle
         greatest = max(greatest, column%inertia_above(i)/(column%initial_stiffness(n + i) - pushed))
      end do
      below = 1.0_wp/total
      above = 1.0_wp/greatest
      if (axial) then
         ! Compression lowers it: to nothing, at the critical load.
         do while (.not. is_stiffer(column, axial, below))
            below = below/16.0_wp
            if (below < epsilon(1.0_wp)**2*above) return
         end do
      end if
      do
         call split(below, above, between, more)
         if (.not. more) exit
         if (is_stiffer(column, axial, between)) then
            below = between
         else
            above = between
         end if
      end do
   end function lowest_square

   !> Whether K - s M, with the geometric stiffness in K, is positive definite.
   !>
   !> From the top down: the bodies above joint i, each joint between them in equilibrium, answer the
   !> motion (x, th) of its upper side like the negative stiffness -T, a 2 by 2 matrix. A body adds its mass
   !> and its axial force to T, a rigid arm shifts it, and a joint k in series makes of it
   !>
   !>     T + C' (k - T)^-1 C,  C = T + b e_1 e_2'
   !>
   !> if k - T is positive definite. Without tension all terms have one sign, so the answer is that for
   !> stiffnesses and masses with relative errors of round-off.
   pure logical function is_stiffer(column, axial, s)
      type(column_type), intent(in) :: column
      logical, intent(in) :: axial
      !> Square of a circular frequency [1/s2]
      real(wp), intent(in) :: s
      real(wp) :: t11, t12, t22, c12, c21, c22, arm, joint, shear, p1, p2
      integer :: i, n

      is_stiffer = .false.
      n = column%n
      t11 = 0.0_wp
      t12 = 0.0_wp
      t22 = 0.0_wp
      joint = 0.0_wp
      do i = n, 1, -1
         arm = column%upper(i)
         t22 = t22 + arm*(2.0_wp*t12 + arm*t11)
         t12 = t12 + arm*t11
         t11 = t11 + s*column%mass(i)
         t22 = t22 + s*column%inertia(i)
         if (axial) then
            t22 = t22 + column%axial_body(i)*column%length(i)
            joint = column%axial_slip(i)
         end if
         arm = column%lower(i)
         t22 = t22 + arm*(2.0_wp*t12 + arm*t11)
         t12 = t12 + arm*t11

         shear = column%initial_stiffness(i)
         p1 = shear - t11
         if (.not. p1 > 0.0_wp) return
         if (column%held .and. i == n) then
            ! What is held against rotation moves along only; its joint turns by minus what is below.
            t12 = 0.0_wp
            t22 = -column%initial_stiffness(n + i)
            t11 = t11*(shear/p1)
            cycle
         end if
         p2 = column%initial_stiffness(n + i) - (t22 + t12*(t12/p1))
         if (.not. p2 > 0.0_wp) return
         ! C after elimination of the slip
         c12 = t12 + joint
         c21 = t12*(shear/p1)
         c22 = t22 + t12*(c12/p1)
         t12 = t12 + t11*(c12/p1) + c21*(c22/p2)
         t22 = t22 + c12*(c12/p1) + c22*(c22/p2)
         t11 = t11*(shear/p1) + c21*(c21/p2)
      end do
      is_stiffer = .true.
   end function is_stiffer

   !> Square of the highest frequency of slips and rotations: s M - K is positive definite above it.
   real(wp) function highest_square(column, axial) result(above)
      type(column_type), intent(in) :: column
      logical, intent(in) :: axial
      real(wp), allocatable :: band(:, :), mass(:)
      real(wp) :: below, between
      integer :: i, n
      logical :: more

      n = column%n
      allocate (band(4, 2*n), source=0.0_wp)
      allocate (mass(2*n))
      call add_spring_band(column, column%initial_stiffness, band)
      if (axial) call add_geometric_band(column, column%axial_body, column%axial_slip, band)
      if (column%held) then
         band(1, 2*n) = 0.0_wp
         band(2, 2*n - 1) = 0.0_wp
         if (n > 1) band(3, 2*n - 2) = 0.0_wp
         if (n > 1) band(4, 2*n - 3) = 0.0_wp
      end if
      below = 0.0_wp
      above = 0.0_wp
      do i = 1, n
         mass(2*i - 1) = column%mass(i)
         mass(2*i) = column%inertia(i)
      end do
      do i = 1, 2*n
         below = max(below, band(1, i)/mass(i))
         above = above + max(band(1, i)/mass(i), 0.0_wp)
      end do
      do
         call split(below, above, between, more)
         if (.not. more) exit
         if (is_dominated(band, mass, between)) then
            above = between
         else
            below = between
         end if
      end do
   end function highest_square

   !> Squares of the lowest and of the highest frequency of the openings.
   subroutine opening_squares(column, lowest, highest)
      type(column_type), intent(in) :: column
      real(wp), intent(out) :: lowest, highest
      real(wp) :: diagonal(column%n), band(4, column%n), softness(column%n)
      real(wp) :: above, below, between
      integer :: n
      logical :: more

      n = column%n
      softness = column%mass_above(:n)/column%initial_stiffness(2*n + 1:)
      lowest = 1.0_wp/sum(softness)
      above = 1.0_wp/maxval(softness)
      do
         call split(lowest, above, between, more)
         if (.not. more) exit
         if (slower_openings(column, between) == 0) then
            lowest = between
         else
            above = between
         end if
      end do

      call opening_band(column, column%initial_stiffness(2*n + 1:), band)
      diagonal = band(1, :)
      below = maxval(diagonal/column%mass)
      highest = sum(diagonal/column%mass)
      do
         call split(below, highest, between, more)
         if (.not. more) exit
         if (slower_openings(column, between) == n) then
            highest = between
         else
            below = between
         end if
      end do
   end subroutine opening_squares

   !> Number of frequencies of the openings whose square is below s (Sylvester): negative pivots of
   !> K - s M from the top down.
   pure integer function slower_openings(column, s) result(number)
      type(column_type), intent(in) :: column
      real(wp), intent(in) :: s
      real(wp) :: k, pivot, t
      integer :: i

      number = 0
      t = 0.0_wp
      do i = column%n, 1, -1
         k = column%initial_stiffness(2*column%n + i)
         t = t + s*column%mass(i)
         pivot = k - t
         ! A small pivot in place of zero changes nothing but round-off.
         if (.not. abs(pivot) > 0.0_wp) pivot = epsilon(1.0_wp)*k
         if (pivot < 0.0_wp) number = number + 1
         t = t*(k/pivot)
      end do
   end function slower_openings

   !> A number between two positive bounds, the geometric mean while they are far apart. `more` is false when
   !> there is no number between them.
   pure subroutine split(below, above, between, more)
      real(wp), intent(in) :: below, above
      real(wp), intent(out) :: between
      logical, intent(out) :: more

      if (above > 4.0_wp*below) then
         between = sqrt(below)*sqrt(above)
      else
         between = below + 0.5_wp*(above - below)
      end if
      more = between > below .and. between < above
   end subroutine split

end module rbs_column_frequency
