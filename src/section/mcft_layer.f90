!> One layer of cracked concrete under longitudinal strain and shear stress: the modified compression field
!> theory (Vecchio and Collins 1986, ACI Journal 83(2)).
!>
!> Stresses and strains are averages with the same principal axes; here tension is positive. With c and s the
!> cosine and sine of twice the angle between the layer and the principal tension,
!>
!>     eps_1,2 = (eps_x + eps_z)/2 +- R,   R^2 = ((eps_x - eps_z)/2)^2 + (gamma/2)^2
!>     c = (eps_x - eps_z)/(2R),  s = gamma/(2R)
!>     sigma_z = f_1 (1 - c)/2 + f_2 (1 + c)/2 + rho_z f_sz = 0,   tau = (f_1 - f_2) s/2
!>
!> f_1 and f_2 are the uniaxial law of the concrete; compression across cracks is softened by
!> 1/(0.8 + 170 eps_1) <= 1. Poisson's ratio is zero: uncracked G = E_c/2. No check of slip at the crack.
!>
!> A state is found by Newton's method in (eps_z, gamma) from the previous one, in smaller steps where one
!> step does not converge. Where no step does, as the concrete loses stress abruptly when it cracks, states
!> of increasing eps_1, each with eps_2 from sigma_z = 0, are searched for the first that carries tau.
module rbs_section_mcft_layer
   use rbs_base_kinds, only: wp
   use rbs_section_concrete_law, only: concrete_type, concrete_both
   use rbs_section_steel_law, only: steel_type, steel_both, steel_stress
   implicit none
   private

   public :: layer_type, layer_state, layer_stress, stress_of_state, solve_layer, crack_softening

   !> Materials of a layer.
   type :: layer_type
      type(concrete_type) :: concrete
      !> Stirrups, smeared: legs times area of a bar over width times spacing; 0 in the cover
      real(wp) :: rho_z = 0.0_wp
      type(steel_type) :: stirrup
   end type layer_type

   !> State of a layer: its transverse and shear strain under a longitudinal strain and a shear stress [Pa].
   !> Tension is positive.
   type :: layer_state
      real(wp) :: eps_z = 0.0_wp, gamma = 0.0_wp, eps_x = 0.0_wp, tau = 0.0_wp
   end type layer_state

   !> Stresses [Pa] of a state, tension positive, and slopes by (eps_z, gamma).
   type :: layer_stress
      real(wp) :: sigma_x = 0.0_wp, sigma_z = 0.0_wp, tau = 0.0_wp
      real(wp) :: z_by_z = 0.0_wp, z_by_gamma = 0.0_wp, tau_by_z = 0.0_wp, tau_by_gamma = 0.0_wp
   end type layer_stress

   !> Largest residual of sigma_z and tau, as a share of f'c.
   real(wp), parameter :: tolerance = 1.0e-9_wp

   integer, parameter :: most_steps = 20, most_halvings = 5, most_bisections = 100

   !> Smallest step, as a share of the way from one state to the next.
   real(wp), parameter :: smallest_part = 1.0_wp/128.0_wp

   !> Search for eps_1: growth from one trial to the next, and the strain at which the search ends.
   real(wp), parameter :: growth = 1.08_wp, largest_strain = 0.1_wp

contains

   !> Factor of the compressive strength of cracked concrete, 1/(0.8 + 170 eps_1) but not above 1 (Vecchio and
   !> Collins 1986); 1 without a crack.
   elemental subroutine crack_softening(cracking, eps_1, factor, slope)
      !> Strain at cracking, and principal tensile strain
      real(wp), intent(in) :: cracking, eps_1
      !> Factor, and its slope by eps_1
      real(wp), intent(out) :: factor, slope

      factor = 1.0_wp
      slope = 0.0_wp
      if (eps_1 <= cracking) return
      if (0.8_wp + 170.0_wp*eps_1 <= 1.0_wp) return
      factor = 1.0_wp/(0.8_wp + 170.0_wp*eps_1)
      slope = -170.0_wp*factor**2
   end subroutine crack_softening

   !> Stresses of the two principal strains, tension positive, and their slopes [Pa].
   pure subroutine principal_stresses(concrete, eps_1, eps_2, f_1, f_2, f11, f22, f21)
      type(concrete_type), intent(in) :: concrete
      !> Larger and smaller principal strain, tension positive
      real(wp), intent(in) :: eps_1, eps_2
      real(wp), intent(out) :: f_1, f_2
      !> Slopes: of f_1 by eps_1, of f_2 by eps_2 and by eps_1
      real(wp), intent(out) :: f11, f22, f21
      real(wp) :: factor, slope

      ! The law of the concrete takes compression as positive.
      call concrete_both(concrete, -eps_1, f_1, f11)
      call concrete_both(concrete, -eps_2, f_2, f22)
      f_1 = -f_1
      f_2 = -f_2
      f21 = 0.0_wp
      ! Only compression is softened by cracks.
      if (eps_2 >= 0.0_wp) return
      call crack_softening(concrete%ft/concrete%ec, eps_1, factor, slope)
      f21 = slope*f_2
      f_2 = factor*f_2
      f22 = factor*f22
   end subroutine principal_stresses

   !> Stresses and slopes of a state of strain.
   pure type(layer_stress) function stress_of_state(layer, state) result(stress)
      type(layer_type), intent(in) :: layer
      type(layer_state), intent(in) :: state
      real(wp) :: radius, c, s, f_1, f_2, f11, f22, f21, g, share_1, share_2, f_sz, e_sz

      radius = hypot(0.5_wp*(state%eps_x - state%eps_z), 0.5_wp*state%gamma)
      c = 1.0_wp
      s = 0.0_wp
      if (radius > 0.0_wp) then
         c = 0.5_wp*(state%eps_x - state%eps_z)/radius
         s = 0.5_wp*state%gamma/radius
      end if
      associate (mean => 0.5_wp*(state%eps_x + state%eps_z))
         call principal_stresses(layer%concrete, mean + radius, mean - radius, f_1, f_2, f11, f22, f21)
      end associate
      call steel_both(layer%stirrup, state%eps_z, f_sz, e_sz)
      ! Shares of z in the principal directions 1 and 2.
      share_1 = 0.5_wp*(1.0_wp - c)
      share_2 = 0.5_wp*(1.0_wp + c)
      stress%sigma_x = f_1*share_2 + f_2*share_1
      stress%sigma_z = f_1*share_1 + f_2*share_2 + layer%rho_z*f_sz
      stress%tau = 0.5_wp*(f_1 - f_2)*s

      ! The stresses rotate with the strains: tau_12 = (f_1 - f_2)/(2 (eps_1 - eps_2)) gamma_12.
      ! That quotient is g; where both strains are equal its limit is taken.
      if (radius > 1.0e-12_wp) then
         g = 0.25_wp*(f_1 - f_2)/radius
      else
         g = 0.25_wp*(f11 + f22)
      end if
      stress%z_by_z = share_1**2*f11 + share_2*(f21*share_1 + f22*share_2) + s**2*g + layer%rho_z*e_sz
      stress%z_by_gamma = 0.5_wp*s*(share_1*f11 + share_2*(f21 - f22)) + c*s*g
      stress%tau_by_z = 0.5_wp*s*((f11 - f21)*share_1 - f22*share_2) + c*s*g
      stress%tau_by_gamma = 0.25_wp*s**2*(f11 - f21 + f22) + c**2*g
   end function stress_of_state

   !> Transverse and shear strain of a layer under longitudinal strain and shear stress.
   pure subroutine solve_layer(layer, eps_x, tau, state, carried)
      type(layer_type), intent(in) :: layer
      !> Longitudinal strain, tension positive; shear stress [Pa]
      real(wp), intent(in) :: eps_x, tau
      !> The previous state, at first that of the virgin layer; on return the present one
      type(layer_state), intent(inout) :: state
      !> Whether the layer carries tau; if not, the state is that with the largest stress found
      logical, intent(out) :: carried
      type(layer_state) :: trial

      trial = state
      ! All is done for tau >= 0. A change of sign begins at the virgin layer.
      if (tau < 0.0_wp .neqv. state%tau < 0.0_wp) trial = layer_state()
      trial%gamma = abs(trial%gamma)
      trial%tau = abs(trial%tau)
      call iterate(eps_x, abs(tau), trial, carried)
      if (.not. carried) call go_in_parts(abs(tau), trial, carried)
      if (.not. carried) call search(abs(tau), trial, carried)
      state = trial
      if (tau < 0.0_wp) then
         state%gamma = -state%gamma
         state%tau = -state%tau
      end if

   contains

      !> Newton's method; a step that does not reduce the residual is halved. A state at which the stress
      !> falls with the strain is not accepted. Without success the state is unchanged.
      pure subroutine iterate(eps_x, tau, state, found)
         !> Longitudinal strain, tension positive; shear stress, not negative [Pa]
         real(wp), intent(in) :: eps_x, tau
         !> State to start from, replaced by the one found
         type(layer_state), intent(inout) :: state
         logical, intent(out) :: found
         type(layer_stress) :: stress, ahead
         type(layer_state) :: here, trial
         real(wp) :: residual, determinant, share
         integer :: step, halving

         found = .false.
         here = layer_state(state%eps_z, state%gamma, eps_x, tau)
         stress = stress_of_state(layer, here)
         residual = max(abs(stress%sigma_z), abs(stress%tau - tau))
         do step = 1, most_steps
            determinant = stress%z_by_z*stress%tau_by_gamma - stress%z_by_gamma*stress%tau_by_z
            if (.not. determinant > 0.0_wp .or. .not. stress%z_by_z > 0.0_wp) return
            found = residual <= tolerance*layer%concrete%fc .and. here%gamma >= 0.0_wp
            if (found) then
               state = here
               return
            end if
            share = 1.0_wp
            do halving = 0, most_halvings
               trial = here
               trial%eps_z = here%eps_z - share/determinant* &
                             (stress%tau_by_gamma*stress%sigma_z - stress%z_by_gamma*(stress%tau - tau))
               trial%gamma = here%gamma - share/determinant* &
                             (stress%z_by_z*(stress%tau - tau) - stress%tau_by_z*stress%sigma_z)
               ahead = stress_of_state(layer, trial)
               if (max(abs(ahead%sigma_z), abs(ahead%tau - tau)) < residual) exit
               share = 0.5_wp*share
            end do
            if (halving > most_halvings) return
            here = trial
            stress = ahead
            residual = max(abs(stress%sigma_z), abs(stress%tau - tau))
         end do
      end subroutine iterate

      !> Newton's method in several steps along a straight path in (eps_x, tau) from the previous state; a
      !> step that fails is halved.
      pure subroutine go_in_parts(tau, state, arrived)
         real(wp), intent(in) :: tau
         type(layer_state), intent(inout) :: state
         logical, intent(out) :: arrived
         type(layer_state) :: from
         real(wp) :: gone, part
         logical :: found

         from = state
         gone = 0.0_wp
         part = 0.25_wp
         do
            call iterate(from%eps_x + (gone + part)*(eps_x - from%eps_x), from%tau &
                         + (gone + part)*(tau - from%tau), state, found)
            arrived = found .and. gone + part >= 1.0_wp
            if (arrived) return
            if (found) then
               gone = gone + part
               part = min(2.0_wp*part, 1.0_wp - gone)
            else
               part = 0.5_wp*part
               if (part < smallest_part) return
            end if
         end do
      end subroutine go_in_parts

      !> The first state that carries tau as eps_1 increases from the state without shear; if there is none,
      !> the state with the largest shear stress.
      pure subroutine search(tau, state, found)
         real(wp), intent(in) :: tau
         type(layer_state), intent(inout) :: state
         logical, intent(out) :: found
         type(layer_state) :: best
         real(wp) :: below, above, cracking, eps_2, tau_here
         logical :: balanced

         found = .false.
         cracking = layer%concrete%ft/layer%concrete%ec
         below = max(eps_x, 0.0_wp)
         best = layer_state(eps_x=eps_x)
         do while (below < largest_strain)
            above = max(growth*below, below + 0.02_wp*cracking)
            ! Both sides of cracking are tried, as the stress drops there.
            if (below < cracking) above = min(above, cracking)
            if (.not. below < cracking .and. .not. below > cracking) above = nearest(cracking, 1.0_wp)
            call balance(above, eps_2, tau_here, balanced)
            if (balanced .and. tau_here > best%tau) best = state_of(eps_x, above, eps_2, tau_here)
            if (balanced .and. tau_here >= tau) call close_in(tau, below, above, state, found)
            if (found) return
            below = above
         end do
         state = best
      end subroutine search

      !> Halve the interval of eps_1 in which tau is reached; Newton's method gives the last digits.
      pure subroutine close_in(tau, bottom, top, state, found)
         !> Shear stress [Pa]; ends of the interval of eps_1
         real(wp), intent(in) :: tau, bottom, top
         type(layer_state), intent(inout) :: state
         logical, intent(out) :: found
         type(layer_state) :: near
         real(wp) :: below, above, middle, eps_2, tau_here
         integer :: i
         logical :: balanced

         below = bottom
         above = top
         do i = 1, most_bisections
            middle = 0.5_wp*(below + above)
            call balance(middle, eps_2, tau_here, balanced)
            near = state_of(eps_x, middle, eps_2, tau)
            call iterate(eps_x, tau, near, found)
            ! Newton's method may have left the interval: only a state inside it is the first.
            if (found) found = in_between(near, bottom, top)
            if (found) state = near
            if (found .or. .not. (middle > below .and. middle < above)) return
            if (balanced .and. tau_here < tau) then
               below = middle
            else
               above = middle
            end if
         end do
      end subroutine close_in

      !> Given eps_1: eps_2 <= eps_x of the state with sigma_z = 0, and its shear stress.
      !>
      !> (1 - c)/2 = (eps_1 - eps_x)/(eps_1 - eps_2) and eps_z = eps_1 + eps_2 - eps_x: sigma_z, not negative
      !> at eps_2 = eps_x, falls to zero as eps_2 decreases.
      pure subroutine balance(eps_1, eps_2, tau, balanced)
         real(wp), intent(in) :: eps_1
         real(wp), intent(out) :: eps_2, tau
         !> Whether such a state was found
         logical, intent(out) :: balanced
         real(wp) :: low, high, step, sigma_z
         integer :: i

         high = min(eps_x, eps_1)
         step = 0.02_wp*layer%concrete%eps0
         low = high - step
         do i = 1, 40
            call stress_between(layer, eps_x, eps_1, low, sigma_z, tau)
            if (sigma_z <= 0.0_wp) exit
            high = low
            step = 2.0_wp*step
            low = low - step
         end do
         do i = 1, most_bisections
            eps_2 = 0.5_wp*(low + high)
            call stress_between(layer, eps_x, eps_1, eps_2, sigma_z, tau)
            if (abs(sigma_z) <= 0.1_wp*tolerance*layer%concrete%fc) exit
            if (.not. (eps_2 > low .and. eps_2 < high)) exit
            if (sigma_z > 0.0_wp) then
               high = eps_2
            else
               low = eps_2
            end if
         end do
         balanced = abs(sigma_z) <= tolerance*layer%concrete%fc
      end subroutine balance
   end subroutine solve_layer

   !> Transverse and shear stress [Pa] of the layer where eps_x lies between the two principal strains,
   !> eps_2 <= eps_x <= eps_1, tension positive.
   pure subroutine stress_between(layer, eps_x, eps_1, eps_2, sigma_z, tau)
      type(layer_type), intent(in) :: layer
      real(wp), intent(in) :: eps_x, eps_1, eps_2
      real(wp), intent(out) :: sigma_z, tau
      real(wp) :: f_1, f_2, f11, f22, f21

      call principal_stresses(layer%concrete, eps_1, eps_2, f_1, f_2, f11, f22, f21)
      sigma_z = (f_1*(eps_1 - eps_x) + f_2*(eps_x - eps_2))/(eps_1 - eps_2) + &
                layer%rho_z*steel_stress(layer%stirrup, eps_1 + eps_2 - eps_x)
      tau = (f_1 - f_2)*sqrt(max(0.0_wp, (eps_1 - eps_x)*(eps_x - eps_2)))/(eps_1 - eps_2)
   end subroutine stress_between

   !> The state with the principal strains eps_2 <= eps_x <= eps_1 and the shear stress tau [Pa].
   pure type(layer_state) function state_of(eps_x, eps_1, eps_2, tau) result(state)
      real(wp), intent(in) :: eps_x, eps_1, eps_2, tau

      state%eps_x = eps_x
      state%tau = tau
      state%eps_z = eps_1 + eps_2 - eps_x
      state%gamma = 2.0_wp*sqrt(max(0.0_wp, (eps_1 - eps_x)*(eps_x - eps_2)))
   end function state_of

   !> Whether eps_1 of a state is in an interval, apart from round-off.
   elemental logical function in_between(state, bottom, top)
      type(layer_state), intent(in) :: state
      real(wp), intent(in) :: bottom, top
      real(wp) :: eps_1

      eps_1 = 0.5_wp*(state%eps_x + state%eps_z + hypot(state%eps_x - state%eps_z, state%gamma))
      in_between = eps_1 >= bottom*(1.0_wp - 1.0e-9_wp) .and. eps_1 <= top*(1.0_wp + 1.0e-9_wp)
   end function in_between

end module rbs_section_mcft_layer
