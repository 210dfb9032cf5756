!> Mass matrix of the chain with exact rotations: the reference form, dense.
module rbs_column_finite_mass
   use rbs_base_kinds, only: wp
   use rbs_column_column, only: column_type
   implicit none
   private

   public :: finite_mass

contains

   !> M(q) = sum over the bodies k of J_k' diag(m_k, m_k, I_k) J_k with J_k = d(c_k, th_k)/dq.
   !>
   !> The slip of joint i carries everything above it along t_{i-1}, the opening along e_{i-1}, and the
   !> relative rotation turns it about b_i, c_k by R (c_k - b_i) with R (x, y) = (y, -x). So the sums over
   !> the bodies above joint p = max(i, j) - mass m_p, first moment s_p and second moment about b_p, rotary
   !> inertia included, I_p - are all that is needed (d_i, d_j: directions of slips or openings):
   !>
   !>     M_dd = m_p d_i . d_j,  M_dphi = d_i . R (s_p + m_p (b_p - b_j)),
   !>     M_phiphi = I_p + (b_p - b_min(i, j)) . s_p
   !>
   !> For the straight column it is `symmetric_mass`.
   subroutine finite_mass(column, q, mass)
      type(column_type), intent(in) :: column
      !> Unknowns (unknowns)
      real(wp), intent(in) :: q(:)
      !> Matrix (unknowns, unknowns) [kg, kg m, kg m2]
      real(wp), intent(out) :: mass(:, :)
      !> Joints (2, n) [m], their slip and opening directions (2, n)
      real(wp) :: joint(2, column%n), along(2, column%n), across(2, column%n)
      !> First moment of the bodies above each joint about it (2, n + 1) [kg m], and second (n + 1) [kg m2]
      real(wp) :: first(2, column%n + 1), second(column%n + 1)
      real(wp) :: lever(2)
      integer :: i, j, p, n

      n = column%n
      call place_joints(column, q, joint, along, across)
      call sum_moments(column, q, joint, first, second)
      do j = 1, n
         do i = 1, n
            p = max(i, j)
            associate (m => column%mass_above(p))
               mass(i, j) = m*dot(along(:, i), along(:, j))
               lever = turned(first(:, p) + m*(joint(:, p) - joint(:, j)))
               mass(i, n + j) = dot(along(:, i), lever)
               mass(n + j, i) = mass(i, n + j)
               mass(n + i, n + j) = second(p) + dot(joint(:, p) - joint(:, min(i, j)), first(:, p))
               if (.not. column%opens) cycle
               mass(2*n + i, 2*n + j) = m*dot(across(:, i), across(:, j))
               mass(2*n + i, j) = m*dot(across(:, i), along(:, j))
               mass(j, 2*n + i) = mass(2*n + i, j)
               mass(2*n + i, n + j) = dot(across(:, i), lever)
               mass(n + j, 2*n + i) = mass(2*n + i, n + j)
            end associate
         end do
      end do
   end subroutine finite_mass

   !> Joints b_i, and the directions t_{i-1} and e_{i-1} of their slips and openings.
   pure subroutine place_joints(column, q, joint, along, across)
      type(column_type), intent(in) :: column
      real(wp), intent(in) :: q(:)
      real(wp), intent(out) :: joint(:, :), along(:, :), across(:, :)
      real(wp) :: rotation, top(2), e(2)
      integer :: i, n

      n = column%n
      rotation = 0.0_wp
      top = 0.0_wp
      e = [0.0_wp, 1.0_wp]
      do i = 1, n
         across(:, i) = e
         along(:, i) = turned(e)
         joint(:, i) = top + q(i)*along(:, i)
         if (column%opens) joint(:, i) = joint(:, i) + q(2*n + i)*e
         rotation = rotation + q(n + i)
         e = [sin(rotation), cos(rotation)]
         top = joint(:, i) + column%length(i)*e
      end do
   end subroutine place_joints

   !> Moments of the bodies above each joint about it, from the top down.
   pure subroutine sum_moments(column, q, joint, first, second)
      type(column_type), intent(in) :: column
      real(wp), intent(in) :: q(:), joint(:, :)
      real(wp), intent(out) :: first(:, :), second(:)
      real(wp) :: rotation(column%n), between(2), e(2)
      integer :: i, n

      n = column%n
      rotation(1) = q(n + 1)
      do i = 2, n
         rotation(i) = rotation(i - 1) + q(n + i)
      end do
      first(:, n + 1) = 0.0_wp
      second(n + 1) = 0.0_wp
      do i = n, 1, -1
         between = 0.0_wp
         if (i < n) between = joint(:, i + 1) - joint(:, i)
         e = [sin(rotation(i)), cos(rotation(i))]
         associate (m => column%mass(i), s => column%lower(i), above => column%mass_above(i + 1))
            first(:, i) = first(:, i + 1) + above*between + (m*s)*e
            second(i) = second(i + 1) + 2.0_wp*dot(between, first(:, i + 1)) + above*dot(between, between) &
                        + m*s**2 + column%inertia(i)
         end associate
      end do
   end subroutine sum_moments

   !> R a: how a point at a moves per rotation about the origin, clockwise positive.
   pure function turned(a) result(b)
      real(wp), intent(in) :: a(2)
      real(wp) :: b(2)

      b = [a(2), -a(1)]
   end function turned

   pure real(wp) function dot(a, b)
      real(wp), intent(in) :: a(2), b(2)

      dot = a(1)*b(1) + a(2)*b(2)
   end function dot

end module rbs_column_finite_mass
