!> Elastic response spectra of a ground motion that is linear between its points.
!>
!> The oscillator is solved exactly from point to point (Nigam and Jennings 1969). Peaks between the points
!> are found too, and those of the free vibration after the end of the motion.
module rbs_loading_spectrum
   use rbs_base_constants, only: pi
   use rbs_base_cubic, only: largest_of
   use rbs_base_kinds, only: wp
   implicit none
   private

   public :: response_spectrum

   !> Fewest steps in a period, more where strong damping makes the response faster: longer steps are divided,
   !> which changes nothing in the exact solution, but keeps the peaks between two points within 4e-5.
   real(wp), parameter :: steps_in_period = 20.0_wp

   !> Periods of free vibration that are followed after the end.
   real(wp), parameter :: periods_after = 1.25_wp

   !> Terms of the series of the exponential; the matrix is small, as a step is short.
   integer, parameter :: most_terms = 60

   !> The exact step in units of its own length: z' = A z - (0, a0 + (a1 - a0) tau), 0 <= tau <= 1, where z
   !> holds displacement and velocity times the step, and accelerations are times the step squared.
   type :: exact_step
      !> Circular frequency times the step, squared; damping term 2 zeta theta
      real(wp) :: square, c
      !> exp(A), and the weights of a0 and of a1 - a0
      real(wp) :: e(2, 2), constant(2), linear(2)
   end type exact_step

contains

   !> Largest relative displacement, relative velocity and absolute acceleration of oscillators that are at
   !> rest at first.
   pure subroutine response_spectrum(acceleration, dt, period, damping, peak)
      !> Acceleration of the ground (m) [m/s2], at equal steps; step [s]
      real(wp), intent(in) :: acceleration(:), dt
      !> Natural periods (n) [s]; 0 is a rigid oscillator
      real(wp), intent(in) :: period(:)
      !> Damping ratio
      real(wp), intent(in) :: damping
      !> Peaks (3, n) [m, m/s, m/s2]
      real(wp), intent(out) :: peak(:, :)
      integer :: i

      do i = 1, size(period)
         if (period(i) > 0.0_wp) then
            call peaks_of(acceleration, dt, period(i), damping, peak(:, i))
         else
            peak(:, i) = [0.0_wp, 0.0_wp, maxval(abs(acceleration))]
         end if
      end do
   end subroutine response_spectrum

   !> Peaks of the response of one oscillator, also of its free vibration after the motion.
   pure subroutine peaks_of(acceleration, dt, period, damping, peak)
      !> Acceleration of the ground (m) [m/s2], step and natural period [s], damping ratio
      real(wp), intent(in) :: acceleration(:), dt, period, damping
      !> Largest displacement, velocity and absolute acceleration (3) [m, m/s, m/s2]
      real(wp), intent(out) :: peak(:)
      type(exact_step) :: step
      real(wp) :: h, z(2), a0, a1, from, rise
      integer :: i, j, parts

      parts = max(1, ceiling(steps_in_period*max(1.0_wp, 2.0_wp*damping)*dt/period))
      h = dt/parts
      call make_step(2.0_wp*pi*h/period, damping, step)
      ! Displacement, and velocity times the step; accelerations times its square.
      z = 0.0_wp
      peak = 0.0_wp
      a0 = h**2*acceleration(1)
      ! A step of the record is divided into equal parts.
      do i = 2, size(acceleration)
         from = h**2*acceleration(i - 1)
         rise = (h**2*acceleration(i) - from)/parts
         do j = 1, parts
            a1 = from + j*rise
            call advance(step, a0, a1, z, peak)
            a0 = a1
         end do
      end do
      do i = 1, ceiling(periods_after*period/h)
         call advance(step, 0.0_wp, 0.0_wp, z, peak)
      end do
      peak = peak/[1.0_wp, h, h**2]
   end subroutine peaks_of

   !> Advance the oscillator by one step, and note the peaks at its end and inside it.
   pure subroutine advance(step, a0, a1, z, peak)
      !> Exact step, see `exact_step`
      type(exact_step), intent(in) :: step
      !> Acceleration of the ground at both ends, times the step squared
      real(wp), intent(in) :: a0, a1
      !> Displacement and velocity, times the step; largest displacement, velocity and absolute acceleration
      !> so far, in the same units
      real(wp), intent(inout) :: z(2), peak(:)
      !> Relative acceleration, absolute acceleration and its rate, at both ends
      real(wp) :: old(2), x0, x1, total0, total1, slope0, slope1

      old = z
      z(1) = step%e(1, 1)*old(1) + step%e(1, 2)*old(2) - step%constant(1)*a0 - step%linear(1)*(a1 - a0)
      z(2) = step%e(2, 1)*old(1) + step%e(2, 2)*old(2) - step%constant(2)*a0 - step%linear(2)*(a1 - a0)
      total0 = -step%square*old(1) - step%c*old(2)
      total1 = -step%square*z(1) - step%c*z(2)
      x0 = total0 - a0
      x1 = total1 - a1
      slope0 = -step%square*old(2) - step%c*x0
      slope1 = -step%square*z(2) - step%c*x1
      peak(1) = max(peak(1), abs(z(1)))
      peak(2) = max(peak(2), abs(z(2)))
      peak(3) = max(peak(3), abs(total1))
      ! Where a rate changes its sign the peak is within the step: that of the cubic by both ends.
      if (old(2)*z(2) < 0.0_wp) peak(1) = max(peak(1), abs(largest_of([old(1), z(1), old(2), z(2)])))
      if (x0*x1 < 0.0_wp) peak(2) = max(peak(2), abs(largest_of([old(2), z(2), x0, x1])))
      if (slope0*slope1 < 0.0_wp) then
         peak(3) = max(peak(3), abs(largest_of([total0, total1, slope0, slope1])))
      end if
   end subroutine advance

   !> Make the exact step by the series of the exponential, which has no differences of large numbers and
   !> holds for any damping.
   pure subroutine make_step(theta, damping, step)
      !> Circular frequency times the step; damping ratio
      real(wp), intent(in) :: theta, damping
      type(exact_step), intent(out) :: step
      real(wp) :: power(2, 2), weight
      integer :: k

      step%square = theta**2
      step%c = 2.0_wp*damping*theta
      power = reshape([1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [2, 2])
      step%e = 0.0_wp
      step%constant = 0.0_wp
      step%linear = 0.0_wp
      weight = 1.0_wp
      do k = 0, most_terms
         ! weight = 1/k!
         step%e = step%e + weight*power
         step%constant = step%constant + weight/(k + 1)*power(:, 2)
         step%linear = step%linear + weight/((k + 1)*(k + 2))*power(:, 2)
         power = reshape([power(2, 1), -step%square*power(1, 1) - step%c*power(2, 1), &
                          power(2, 2), -step%square*power(1, 2) - step%c*power(2, 2)], [2, 2])
         weight = weight/(k + 1)
      end do
   end subroutine make_step

end module rbs_loading_spectrum
