!> The two loops over all layers of a joint that every event needs, on plain arrays. Sums and minima may be
!> taken in any order (`omp simd`), so that they are taken several layers at a time.
module rbs_hysteresis_layered_fibre_kernels
   use rbs_base_kinds, only: wp
   implicit none
   private

   public :: add_lines, find_ends_ahead, find_ends_behind

   !> Added to distances that must not count as nearest
   real(wp), parameter :: far_away = 1.0e120_wp

contains

   !> Sums over the lines  f_i = c_i + k_i d_i  of layers with  d_i = w + y_i phi: the axial force is
   !> c_0 + a w + s phi, the moment c_1 + s w + q phi.
   pure subroutine add_lines(n, y, k, c, a, s, q, c_0, c_1)
      integer, intent(in) :: n
      !> Distances [m], slopes [N/m] and forces at d = 0 [N] of the layers
      real(wp), intent(in) :: y(n), k(n), c(n)
      real(wp), intent(out) :: a, s, q, c_0, c_1
      integer :: i

      a = 0.0_wp
      s = 0.0_wp
      q = 0.0_wp
      c_0 = 0.0_wp
      c_1 = 0.0_wp
      !$omp simd reduction(+:a, s, q, c_0, c_1)
      do i = 1, n
         a = a + k(i)
         s = s + k(i)*y(i)
         q = q + k(i)*y(i)*y(i)
         c_0 = c_0 + c(i)
         c_1 = c_1 + c(i)*y(i)
      end do
   end subroutine add_lines

   !> Look along a straight path, on which layer i is at  w + y_i phi  and moves with  v_i = opening_rate +
   !> y_i rotation_rate:  when it comes to the end of its line ahead.
   !>
   !> Written without branches. Of the ways to both ends divided by the rate, the larger one leads ahead.
   pure subroutine find_ends_ahead(n, y, k, lo, hi, slack, unload_on_reversal, both_ways, w, phi, &
                                   opening_rate, rotation_rate, least_rate, clearance, ahead, nearest, &
                                   least_clearance, any_unloads, stiffness)
      integer, intent(in) :: n
      !> Distances [m], slopes [N/m] and ends of the lines [m]; all finite, so that quotients do not overflow
      real(wp), intent(in) :: y(n), k(n), lo(n), hi(n)
      !> A layer this close to its end is on it, with `clearance` [m]; +1 on a branch that is left at once
      !> when the layer closes, -1 when it opens, else 0; 1 where the branch leads both ways, else 0
      real(wp), intent(in) :: slack(n), unload_on_reversal(n), both_ways(n)
      !> Opening w [m], rotation phi [rad], and their rates
      real(wp), intent(in) :: w, phi, opening_rate, rotation_rate
      !> Rates up to this count as zero; addition to `slack` [m]
      real(wp), intent(in) :: least_rate, clearance
      !> Ways to the ends, in units of the rates, and the least of them; not above zero if a layer is on the
      !> end that it approaches, or unloads on a reversal
      real(wp), intent(out) :: ahead(n), nearest, least_clearance
      !> Whether any layer is on a branch that unloads on reversal
      logical, intent(out) :: any_unloads
      !> sum k v**2
      real(wp), intent(out) :: stiffness
      real(wp) :: least_both, v, size_v, d, per_v, to_lo, to_hi, still, per_least
      integer :: i

      nearest = huge(1.0_wp)
      least_clearance = huge(1.0_wp)
      least_both = 1.0_wp
      stiffness = 0.0_wp
      per_least = far_away/(epsilon(1.0_wp)*least_rate)
      !$omp simd reduction(min:nearest, least_clearance, least_both) reduction(+:stiffness) &
      !$omp private(v, size_v, d, per_v, to_lo, to_hi, still)
      do i = 1, n
         v = opening_rate + y(i)*rotation_rate
         d = w + y(i)*phi
         stiffness = stiffness + k(i)*v*v
         size_v = abs(v)
         ! Zero for a layer that moves, else far away.
         still = max(0.0_wp, least_rate - size_v)*per_least
         per_v = 1.0_wp/sign(max(size_v, least_rate), v)
         to_lo = (lo(i) - d)*per_v
         to_hi = (hi(i) - d)*per_v
         ahead(i) = max(to_lo, to_hi) + still
         nearest = min(nearest, ahead(i))
         ! The second term is above zero if the branch of the layer leads in the direction of v, or both ways.
         least_clearance = min(least_clearance, min(ahead(i) - (clearance + slack(i))*abs(per_v), &
                                          unload_on_reversal(i)*v + both_ways(i) + still))
         least_both = min(least_both, both_ways(i))
      end do
      any_unloads = least_both < 0.5_wp
   end subroutine find_ends_ahead

   !> When a layer was last at the end of its line behind: the ways back, as in `find_ends_ahead`.
   pure subroutine find_ends_behind(n, y, lo, hi, w, phi, opening_rate, rotation_rate, least_rate, behind, &
                                    nearest)
      !> Arguments as in `find_ends_ahead`
      integer, intent(in) :: n
      real(wp), intent(in) :: y(n), lo(n), hi(n), w, phi, opening_rate, rotation_rate, least_rate
      !> Ways back, in units of the rates, and the least of them
      real(wp), intent(out) :: behind(n), nearest
      real(wp) :: v, size_v, d, per_v, per_least
      integer :: i

      nearest = huge(1.0_wp)
      per_least = far_away/(epsilon(1.0_wp)*least_rate)
      !$omp simd reduction(min:nearest) private(v, size_v, d, per_v)
      do i = 1, n
         v = opening_rate + y(i)*rotation_rate
         d = w + y(i)*phi
         size_v = abs(v)
         per_v = 1.0_wp/sign(max(size_v, least_rate), v)
         ! The way to the end behind has the positive sign; a layer that hardly moves never was there.
         behind(i) = max((d - lo(i))*per_v, (d - hi(i))*per_v) + max(0.0_wp, least_rate - size_v)*per_least
         nearest = min(nearest, behind(i))
      end do
   end subroutine find_ends_behind

end module rbs_hysteresis_layered_fibre_kernels
