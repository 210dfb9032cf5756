!> The strain at mid-depth at which a section carries its axial load, for one curvature after the other.
!>
!> Past the peak several such strains may exist. The one taken is the first that the section reaches from the
!> last curvature when the unbalanced axial load moves it: it is stable, and it follows the last one
!> continuously as long as a continuous solution exists.
module rbs_section_balance
   use rbs_base_constants, only: unbounded
   use rbs_base_error, only: error_type, fatal_error, bad_input, analysis_failed
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_section_resultants, only: laws_type, resultants_type, resultants, force_scale
   use rbs_section_cross_section, only: section_type
   implicit none
   private

   public :: state_type, begin, advance, follow, axial_capacity

   !> A section in equilibrium.
   type :: state_type
      !> Curvature [1/m], strain at mid-depth (compression positive), moment about mid-depth [N m]
      real(wp) :: curvature = 0.0_wp, eps0 = 0.0_wp, moment = 0.0_wp
      !> Change of the strain with the curvature over the last step [m], to guess the next one
      real(wp) :: trend = 0.0_wp
   end type state_type

   !> Largest residual of the axial force, as a share of `force_scale`.
   real(wp), parameter :: tolerance = 1.0e-10_wp
   integer, parameter :: most_newton = 8, most_bisections = 200

   !> Largest change of the strain over the depth in one step, so that no branch is skipped: a constant, and
   !> a share of the present strain.
   real(wp), parameter :: longest_step = 1.0e-3_wp, longest_growth = 0.05_wp
   !> Search for the strain: the first step, the growth of the steps and the longest one, to which a share of
   !> the strain over the depth is added.
   real(wp), parameter :: first_search = 2.0e-6_wp, search_growth = 1.4_wp, longest_search = 1.0e-4_wp, &
                          search_share = 0.02_wp
   !> Strain in compression at which a section counts as crushed.
   real(wp), parameter :: crushed = 0.05_wp

contains

   !> The section under its axial load before it is bent.
   subroutine begin(section, laws, axial_load, state, error)
      type(section_type), intent(in) :: section
      type(laws_type), intent(in) :: laws
      !> Compression positive [N]
      real(wp), intent(in) :: axial_load
      !> Equilibrium without curvature
      type(state_type), intent(out) :: state
      type(error_type), allocatable, intent(out) :: error
      type(resultants_type) :: least, most
      real(wp) :: strain(2)
      logical :: found

      call settle(section, laws, axial_load, 0.0_wp, state, found)
      if (found) return
      ! The search may step over a narrow peak: where the section carries more, it returns from there.
      call axial_capacity(section, laws, least, most, strain)
      if (least%n <= axial_load .and. axial_load <= most%n) then
         state = state_type(eps0=strain(merge(2, 1, axial_load > 0.0_wp)))
         call settle(section, laws, axial_load, 0.0_wp, state, found)
         if (found) return
      end if
      call fatal_error(error, bad_input, 'section: axial_load = '//to_text(axial_load)//' N is more '// &
                       trim(merge('compression', 'tension    ', axial_load > 0.0_wp))// &
                       ' than the section carries; compression is positive: give '//to_text(least%n)// &
                       ' to '//to_text(most%n)//' N')
   end subroutine begin

   !> Bend the section to a curvature of the same sign and larger magnitude, in internal steps.
   subroutine advance(section, laws, axial_load, curvature, state, found)
      type(section_type), intent(in) :: section
      type(laws_type), intent(in) :: laws
      !> Axial load, compression positive [N]; curvature [1/m]
      real(wp), intent(in) :: axial_load, curvature
      !> Moves to `curvature`, or to the last one at which the section carries the axial load
      type(state_type), intent(inout) :: state
      !> Whether the section carries the axial load up to `curvature`
      logical, intent(out) :: found
      type(state_type) :: next
      integer :: steps, i
      real(wp) :: first

      found = .true.
      first = state%curvature
      steps = max(1, ceiling(abs(curvature - first)*section%shape%depth/ &
                             max(longest_step, longest_growth*abs(first)*section%shape%depth)))
      do i = 1, steps
         next = state
         next%curvature = curvature
         if (i < steps) next%curvature = first + i*(curvature - first)/steps
         call find_strain(state)
         if (.not. found) return
         state = next
      end do

   contains

      !> Set `next` to equilibrium at next%curvature, starting from `last`: Newton's method from the
      !> extrapolated strain; if it does not converge nearby, the search of `settle`. Sets `found`.
      subroutine find_strain(last)
         type(state_type), intent(in) :: last
         type(resultants_type) :: sums
         real(wp) :: residual, near, guess, limit, rise
         integer :: i

         rise = next%curvature - last%curvature
         guess = last%eps0 + last%trend*rise
         ! How far from the guess Newton's method may go: beyond it another branch may lie.
         near = 2.0e-5_wp + 0.3_wp*abs(rise)*section%shape%depth
         limit = tolerance*force_scale(section)
         next%eps0 = guess
         found = .false.
         do i = 1, most_newton
            sums = resultants(section, laws, next%eps0, next%curvature)
            if (.not. sums%stiffness > 0.0_wp) exit
            residual = sums%n - axial_load
            if (abs(residual) <= limit) then
               found = .true.
               next%moment = sums%m
               exit
            end if
            next%eps0 = next%eps0 - residual/sums%stiffness
            if (abs(next%eps0 - guess) > near) exit
         end do
         if (.not. found) then
            next%eps0 = last%eps0
            call settle(section, laws, axial_load, next%curvature, next, found)
         end if
         if (found .and. abs(rise) > 0.0_wp) next%trend = (next%eps0 - last%eps0)/rise
      end subroutine find_strain

   end subroutine advance

   !> Moments for curvatures of one sign and increasing magnitude.
   subroutine follow(section, laws, axial_load, curvature, moment, eps0, error)
      type(section_type), intent(in) :: section
      type(laws_type), intent(in) :: laws
      !> Compression positive [N]; [1/m]
      real(wp), intent(in) :: axial_load, curvature(:)
      !> About mid-depth [N m], and strain at mid-depth, compression positive; zero after a failure
      real(wp), intent(out) :: moment(:), eps0(:)
      type(error_type), allocatable, intent(out) :: error
      type(state_type) :: state
      logical :: found
      integer :: i

      moment = 0.0_wp
      eps0 = 0.0_wp
      call begin(section, laws, axial_load, state, error)
      if (allocated(error)) return
      do i = 1, size(curvature)
         call advance(section, laws, axial_load, curvature(i), state, found)
         if (.not. found) then
            call fatal_error(error, analysis_failed, 'section: beyond a curvature of '// &
                             to_text(state%curvature)//' 1/m it no longer carries the axial load of '// &
                             to_text(axial_load)//' N (asked for '//to_text(curvature(i))// &
                             ' 1/m); end the curvatures there, or reduce the axial load')
            return
         end if
         moment(i) = state%moment
         eps0(i) = state%eps0
      end do
   end subroutine follow

   !> Move from state%eps0 in the direction of the unbalanced axial load to the first equilibrium.
   subroutine settle(section, laws, axial_load, curvature, state, found)
      type(section_type), intent(in) :: section
      type(laws_type), intent(in) :: laws
      !> Axial load, compression positive [N]; curvature [1/m]
      real(wp), intent(in) :: axial_load, curvature
      !> On return its strain, curvature and moment are those of the equilibrium, if there is one
      type(state_type), intent(inout) :: state
      logical, intent(out) :: found
      type(resultants_type) :: current, trial
      real(wp) :: step, direction, at, next, furthest

      found = .true.
      state%curvature = curvature
      at = state%eps0
      current = resultants(section, laws, at, curvature)
      state%moment = current%m
      if (abs(current%n - axial_load) <= tolerance*force_scale(section)) return
      direction = sign(1.0_wp, axial_load - current%n)
      ! The search ends where the section is crushed or its last bar has broken.
      furthest = crushed
      if (direction < 0.0_wp) furthest = largest_opening(section)
      furthest = furthest + abs(curvature)*section%shape%depth
      step = first_search
      do
         next = at + direction*step
         if (abs(next) > furthest) exit
         trial = resultants(section, laws, next, curvature)
         if ((trial%n - axial_load)*direction >= 0.0_wp) then
            call close_in(at, current, next, trial)
            return
         end if
         at = next
         current = trial
         step = min(longest_search + search_share*abs(curvature)*section%shape%depth, search_growth*step)
      end do
      found = .false.

   contains

      !> Set `state` to equilibrium between two strains with residuals of opposite sign: the Illinois form of
      !> regula falsi,
      !> with a bisection at every third step. Where the force jumps because a bar breaks, equilibrium lies
      !> within the jump.
      subroutine close_in(first, at_first, second, at_second)
         !> The two strains and the forces at them
         real(wp), intent(in) :: first, second
         type(resultants_type), intent(in) :: at_first, at_second
         type(resultants_type) :: a_sums, b_sums, sums
         real(wp) :: a, b, at, weight_a, weight_b, limit, share
         integer :: i, kept

         a = first
         b = second
         kept = 0
         a_sums = at_first
         b_sums = at_second
         weight_a = a_sums%n - axial_load
         weight_b = b_sums%n - axial_load
         limit = tolerance*force_scale(section)
         do i = 1, most_bisections
            at = 0.5_wp*(a + b)
            if (mod(i, 3) /= 0) at = b - weight_b*(b - a)/(weight_b - weight_a)
            sums = resultants(section, laws, at, curvature)
            if (abs(sums%n - axial_load) <= limit) then
               state%eps0 = at
               state%moment = sums%m
               return
            end if
            if ((sums%n - axial_load)*(b_sums%n - axial_load) > 0.0_wp) then
               ! A strain that stays twice counts half, so that the secant moves it too.
               if (kept > 0) weight_a = 0.5_wp*weight_a
               kept = 1
               b = at
               b_sums = sums
               weight_b = sums%n - axial_load
            else
               if (kept < 0) weight_b = 0.5_wp*weight_b
               kept = -1
               a = at
               a_sums = sums
               weight_a = sums%n - axial_load
            end if
            if (abs(b - a) <= 4.0_wp*spacing(max(abs(a), abs(b)))) exit
         end do
         ! No strain between the two is left: the axial load lies within the jump, and so does the moment.
         share = (axial_load - a_sums%n)/(b_sums%n - a_sums%n)
         state%eps0 = b
         state%moment = a_sums%m + share*(b_sums%m - a_sums%m)
      end subroutine close_in

   end subroutine settle

   !> Strain at which the last bar breaks; 0.1 without bars.
   pure real(wp) function largest_opening(section)
      type(section_type), intent(in) :: section

      largest_opening = 0.1_wp
      if (size(section%steels) > 0) largest_opening = maxval(section%steels%eps_u)
   end function largest_opening

   !> The section without curvature under its least (tension) and largest (compression) axial force, from a
   !> march over strains up to crushing and to the rupture of the last bar.
   subroutine axial_capacity(section, laws, least, most, strain)
      type(section_type), intent(in) :: section
      type(laws_type), intent(in) :: laws
      type(resultants_type), intent(out) :: least, most
      !> Strains at which the section carries the least and the largest force, compression positive
      real(wp), intent(out) :: strain(2)
      type(resultants_type) :: sums
      real(wp) :: at

      strain = 0.0_wp
      at = longest_search
      do while (at < crushed)
         sums = resultants(section, laws, at, 0.0_wp)
         if (sums%n > most%n) then
            most = sums
            strain(2) = at
         end if
         at = at + longest_search
      end do
      at = first_search
      do while (at < largest_opening(section))
         sums = resultants(section, laws, -at, 0.0_wp)
         if (sums%n < least%n) then
            least = sums
            strain(1) = -at
         end if
         at = at + merge(first_search, longest_search, at < 2.0e-4_wp)
      end do
   end subroutine axial_capacity

end module rbs_section_balance
