!> Equilibrium of a structure on the present lines of its springs, and its rates.
!>
!> While every spring stays on its line, all is linear in the driven quantity: the number F that the pattern p
!> of the load is multiplied with, or the displacement of the top, a row c of the unknowns. This is found
!> exactly, without increments:
!>
!>     K x' = p F',   c x' = u'        K = B' diag(k) B + K_G
!>
!> with F' = 1 or u' = 1. K is a band, bordered by p and c where the displacement is driven. The pattern is
!> that of the lateral load, or the dead load of a frame, which grows from 0 to 1. Deformations that are small
!> differences of unknowns lose digits; the residual is taken in the deformations and solved for once more.
!> Joints of a chain in series have a diagonal K and need no factor.
module rbs_solve_static_equilibrium
   use rbs_base_band_matrix, only: band_matrix
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_base_tolerances, only: no_stiffness, half_of_digits, hardening_of_none
   use rbs_hysteresis_springs, only: spring_array
   use rbs_structure_condensation, only: series_tangent
   use rbs_structure_spring_location, only: flexure
   use rbs_structure_structure, only: structure_type, lateral, signals
   implicit none
   private

   public :: equilibrium_type

   !> A displacement or rotation per displacement of the top that no stable part of a structure has [-, 1/m].
   real(wp), parameter :: without_end = 1.0e8_wp

   !> Deformation inside of members by all of the dead load that none has which carries it [m or rad].
   real(wp), parameter :: falls = 1.0e3_wp

   !> A displacement, in shares of the height, or a rotation that no correction of round-off comes to unless a
   !> part is free to move.
   real(wp), parameter :: no_more = 1.0_wp

   !> Most refinements.
   integer, parameter :: refinements = 20

   !> A displacement, in shares of the height, or a rotation that is no more than round-off.
   real(wp), parameter :: of_round_off = 1.0e-12_wp

   !> What the rates in the equilibrium are for. They stay while no stiffness changes, as where a spring has
   !> come to a closed end and is still on its line.
   type :: known_rates
      !> Whether they serve, and whether the force was driven
      logical :: serve = .false., by_force = .false.
      !> Stiffnesses of the springs (springs), and rates of the position (coordinates)
      real(wp), allocatable :: k(:), rate(:)
   end type known_rates

   type :: equilibrium_type
      !> Whether the dead load of a frame grows with the force, from 0 to 1, in place of the lateral one
      logical :: of_dead_load = .false.
      !> Number of springs that can move; they are the first ones
      integer :: moving = 0
      !> An element that snaps back on the present lines; 0: none. Whether the path may continue with it
      integer :: unstable = 0
      logical :: may_snap_back = .false.
      !> Whether the stiffnesses are too far apart for the arithmetic
      logical :: lost_digits = .false.
      !> Whether the structure is known to be stable on the present lines while the displacement is held
      logical :: is_stable = .false.
      !> Rates of force and displacement; work of the load per force and per unit of the driven quantity, less
      !> that of the displacement
      real(wp) :: force_rate = 0.0_wp, displacement_rate = 0.0_wp, dead_load_work_rate = 0.0_wp
      !> Change that takes the structure to equilibrium: of the position (coordinates), and of the force [N]
      real(wp), allocatable :: correction(:)
      real(wp) :: force_correction = 0.0_wp
      !> The largest force that was out of equilibrium before the correction, moments over the height [N]
      real(wp) :: unbalance = 0.0_wp
      class(structure_type), pointer, private :: structure => null()
      type(band_matrix), private :: matrix
      !> The rates of which this is the factor
      type(known_rates), private :: known
      !> Pivots of the initial stiffness (unknowns), and the band of the axial forces
      real(wp), allocatable, private :: pivot(:), geometric(:, :)
      !> Columns of the band that are filled anew before it is factored (unknowns)
      logical, allocatable, private :: renewed(:)
      !> Unknowns that stay where they are (unknowns)
      logical, allocatable, private :: still(:)
      logical, private :: has_still = .false.
      !> Axial forces that do second-order work
      real(wp), allocatable, private :: axial(:)
      !> Parts between the unknowns on the present lines (parts)
      type(series_tangent), allocatable, private :: tangent(:)
      !> Height for moments, 1 for forces (unknowns)
      real(wp), allocatable, private :: reach(:)
      !> Load per unit, residual, and an array for the loads that are solved for (unknowns)
      real(wp), allocatable, private :: pattern(:), residual(:), load(:)
      !> Changes of the unknowns and their refinement (unknowns, 2); changes of the position
      !> with the driven quantity and by correction (coordinates, 2)
      real(wp), allocatable, private :: change(:, :), moved(:, :)
      !> Forces of the springs, flexibilities (springs); changes of the position that bring the inside of
      !> elements to equilibrium, and those by the load per unit (coordinates, or none)
      real(wp), allocatable, private :: f(:), flexible(:), inner(:), inner_load(:), inner_more(:), more(:)
   contains
      procedure :: create, follow, find_unbalance, serialize
   end type equilibrium_type

contains

   !> Make room for a structure, and factor its initial stiffness.
   subroutine create(self, structure, of_dead_load)
      class(equilibrium_type), intent(out) :: self
      class(structure_type), intent(in), target :: structure
      !> Whether the dead load grows
      logical, intent(in) :: of_dead_load
      type(band_matrix) :: initial
      real(wp) :: no_load(signals)
      integer :: springs, m, i

      self%structure => structure
      self%of_dead_load = of_dead_load
      m = structure%unknowns
      springs = size(structure%location)
      self%moving = structure%moving
      self%still = structure%is_still
      self%has_still = any(self%still)
      allocate (self%reach(m), source=1.0_wp)
      do i = 1, size(structure%group)
         associate (of => structure%group(i))
            ! A frame whose members have no springs has an empty group.
            if (of%last_spring < of%first_spring) cycle
            if (structure%location(of%first_spring)%kind /= flexure) cycle
            self%reach(of%first:of%first + (of%count - 1)*of%step:of%step) = structure%total_height
         end associate
      end do
      if (allocated(structure%reach)) self%reach(:) = structure%reach
      self%tangent = structure%initial_tangent
      allocate (self%pattern(m), self%residual(m), self%load(m), &
                self%change(m, 2), self%moved(structure%coordinates, 2), self%f(springs), &
                self%flexible(springs), self%inner(structure%coordinates), &
                self%inner_load(structure%coordinates), self%inner_more(structure%coordinates), &
                self%more(structure%coordinates), self%correction(structure%coordinates), source=0.0_wp)
      allocate (self%axial(merge(structure%axial_count, 0, structure%axially_loaded)))
      no_load = 0.0_wp
      if (structure%axially_loaded) call structure%axial_forces(no_load, self%axial)
      if (.not. of_dead_load) self%pattern = structure%pattern(lateral)%force
      ! Joints in series need no factor.
      if (structure%in_series) return
      call initial%create(m, structure%half_width)
      call structure%add_stiffness(structure%initial_stiffness, structure%initial_tangent, initial%band)
      call self%matrix%create(m, structure%half_width, initial%band(1, :))
      self%matrix%band = initial%band
      call hold_still(self)
      call self%matrix%factor()
      self%pivot = 1.0_wp/self%matrix%triangle(1, :)
      allocate (self%geometric, source=0.0_wp*initial%band)
      allocate (self%renewed(m), source=.true.)
      if (structure%axially_loaded) call structure%add_geometric(self%axial, self%geometric)
   end subroutine create

   !> Hold the unknowns that do not move.
   subroutine hold_still(self)
      class(equilibrium_type), intent(inout) :: self
      integer :: i

      if (.not. self%has_still) return
      do i = 1, size(self%still)
         if (self%still(i)) call self%matrix%hold(i, self%matrix%stiffness(i))
      end do
   end subroutine hold_still

   !> Rates and corrections on the present lines.
   subroutine follow(self, springs, by_force, displacement, force, rate, found)
      class(equilibrium_type), intent(inout) :: self
      type(spring_array), intent(in) :: springs
      !> Whether the force is driven, else the displacement; under the force the structure must be stable
      logical, intent(in) :: by_force
      !> Of the top [m], and lateral force [N]
      real(wp), intent(in) :: displacement, force
      !> Rates of the position (coordinates)
      real(wp), intent(inout), contiguous :: rate(:)
      !> Whether there are unique ones, under a driven force those of a stable structure
      logical, intent(out) :: found
      real(wp) :: residual

      self%lost_digits = .false.
      residual = displacement - self%structure%top_displacement(springs%d)
      if (.not. self%structure%in_series) then
         call follow_band(self, springs, by_force, residual, force, rate, found)
         return
      end if
      ! Joints in series are each by themselves.
      call self%find_unbalance(springs, force)
      associate (arm => self%structure%arm(:self%moving), k => springs%k(:self%moving), &
                 initial => self%structure%initial_stiffness(:self%moving), r => self%f(:self%moving))
         if (.not. by_force) then
            call follow_diagonal(self%moving, arm, initial, k, r, residual, rate, self%force_rate, &
                                 self%correction, self%force_correction, self%flexible, found)
            self%displacement_rate = 1.0_wp
            return
         end if
         found = all(k > no_stiffness*initial)
         if (.not. found) return
         rate(:self%moving) = arm/k
         self%correction(:self%moving) = r/k
         self%force_rate = 1.0_wp
         self%force_correction = 0.0_wp
         self%displacement_rate = sum(arm*rate(:self%moving))
      end associate
   end subroutine follow

   !> Rates and corrections by the band.
   subroutine follow_band(self, springs, by_force, residual, force, rate, found)
      class(equilibrium_type), intent(inout) :: self
      type(spring_array), intent(in) :: springs
      !> Whether the force is driven, else the displacement
      logical, intent(in) :: by_force
      !> Displacement that the springs lack [m]; lateral force [N], or share of the dead load
      real(wp), intent(in) :: residual, force
      !> Rates of the position (coordinates)
      real(wp), intent(inout), contiguous :: rate(:)
      !> Whether there are unique ones, under a driven force those of a stable structure
      logical, intent(out) :: found
      !> Force of the rates and of the corrections, in multiples of the pattern
      real(wp) :: y(2)
      logical :: settled, shares, refines, is_hardened

      associate (structure => self%structure, known => self%known)
         found = known%serve .and. (by_force .eqv. known%by_force)
         if (found) found = .not. any(abs(springs%k - known%k) > 0.0_wp)
         if (found) then
            refines = structure%loses_digits
            rate = known%rate
            call structure%linearise(springs%k, self%tangent, self%unstable)
            call find_residual(self, springs, force)
         else
            self%is_stable = .false.
            ! Of joints without stiffness in series the band knows only the sum.
            if (by_force .or. .not. structure%loses_digits) call find_rates(springs%k, .false., found)
            ! A node between springs without stiffness is free to turn.
            if (.not. found .and. self%unstable == 0 .and. .not. by_force) then
               call find_rates(with_hardening(springs%k, structure%initial_stiffness), .true., found)
            end if
            if (.not. found) return
            rate = self%moved(:, 1)
            call springs%joints%open_layers(rate)
            call structure%clear_round_off(self%tangent, self%change(:, 1), springs%k, rate)
            self%force_rate = y(1)
            self%displacement_rate = 1.0_wp
            if (by_force) self%displacement_rate = structure%top_displacement(self%moved(:, 1))
            self%is_stable = self%matrix%negative == merge(1, 0, self%force_rate < 0.0_wp)
            self%dead_load_work_rate = work_rate(self, rate) - self%displacement_rate
            known%serve = self%unstable == 0 .and. .not. is_hardened
            known%by_force = by_force
            known%k = springs%k
            known%rate = rate
         end if
         call solve(2, residual, settled)
         ! In a mechanism the correction of round-off is round-off itself; more than that is found by the row.
         if (.not. settled .or. maxval(abs(self%change(:, 1))) > no_more*structure%total_height .or. &
             has_no_stiffness(self%moving, structure%initial_stiffness, self%moved(:, 2), &
                              dot_product(self%residual, self%change(:, 1)))) then
            self%moved(:, 2) = 0.0_wp
            y(2) = 0.0_wp
         end if
         self%force_correction = y(2)
         self%correction(:) = self%moved(:, 2) + self%inner
         call springs%joints%align(springs%d, self%correction)
      end associate

   contains

      !> Find rates with given stiffnesses of the springs: linearise, factor, solve, and refuse rates that no
      !> stable structure has.
      subroutine find_rates(k, of_none, found)
         !> Stiffness of the springs (springs)
         real(wp), intent(in), contiguous :: k(:)
         !> Whether springs without stiffness have a small one in `k`, which refinement takes away
         logical, intent(in) :: of_none
         !> Whether there are unique rates without a part that moves without end
         logical, intent(out) :: found

         is_hardened = of_none
         self%known%serve = .false.
         call self%structure%linearise(k, self%tangent, self%unstable, shares)
         refines = is_hardened .or. self%structure%loses_digits
         found = self%unstable == 0 .or. self%may_snap_back
         if (.not. found) return
         call find_residual(self, springs, force)
         call factor(self, k, by_force, found)
         if (.not. found) return
         call solve(1, 1.0_wp, found)
         ! A part that gives way beside the top moves without end while the top does not.
         if (.not. by_force) found = found .and. maxval(abs(self%change(:, 1))) < without_end
         ! Where hinges make a mechanism of a member between nodes at rest, its own load moves it.
         if (self%of_dead_load .and. (shares .or. is_hardened)) then
            found = found .and. maxval(abs(self%inner_load)) < falls
         end if
      end subroutine find_rates

      !> Changes of the unknowns and of the position: per unit of the driven quantity (1), or by the residual
      !> (2); `y` is the force of these changes.
      subroutine solve(j, displacement, regular)
         !> Which changes: 1 or 2
         integer, intent(in) :: j
         !> Change of the displacement, where it is driven [m]
         real(wp), intent(in) :: displacement
         !> Whether there is a solution with its digits
         logical, intent(out) :: regular
         real(wp) :: signal(signals), more
         integer :: again

         y(j) = merge(1.0_wp, 0.0_wp, by_force .and. j == 1)
         self%load(:) = y(j)*self%pattern
         if (j == 2) self%load(:) = self%residual
         call solve_once(1, displacement, more, regular)
         if (.not. regular) return
         y(j) = y(j) + more
         call self%structure%spring_rates(self%tangent, self%change(:, 1), self%moved(:, j))
         if (self%of_dead_load) self%moved(:, j) = self%moved(:, j) + y(j)*self%inner_load
         if (.not. refines .or. (j == 2 .and. .not. self%structure%loses_digits)) return
         ! A correction that is round-off itself needs no digits of its own.
         if (j == 2 .and. maxval(abs(self%change(:, 1))) <= of_round_off*self%structure%total_height) return
         signal = 0.0_wp
         do again = 1, refinements
            if (.not. self%of_dead_load) signal(lateral) = y(j)
            call springs%find_resistance(springs%k, self%moved(:, j), self%f)
            call self%structure%forces(self%moved(:, j), signal, self%axial, self%tangent, self%f, &
                                       self%load, self%inner_more, merge(y(j), 0.0_wp, self%of_dead_load))
            if (j == 2) self%load(:) = self%load + self%residual
            if (self%has_still) where (self%still) self%load = 0.0_wp
            call solve_once(2, displacement - self%structure%top_displacement(self%moved(:, j)), more, &
                            regular)
            if (.not. regular) exit
            y(j) = y(j) + more
            call self%structure%spring_rates(self%tangent, self%change(:, 2), self%more)
            self%more = self%more + self%inner_more
            if (self%of_dead_load) self%more = self%more + more*self%inner_load
            self%moved(:, j) = self%moved(:, j) + self%more
            self%change(:, 1) = self%change(:, 1) + self%change(:, 2)
            ! One more would add about the square of this share.
            if (maxval(abs(self%change(:, 2))) <= half_of_digits*maxval(abs(self%change(:, 1)))) return
         end do
         ! Else round-off is left to correct, or the common motion of parts that are free to move.
         self%lost_digits = regular .and. self%structure%loses_digits .and. j == 1
         regular = .not. self%structure%loses_digits
      end subroutine solve

      !> Change i of the unknowns under `load`, or where the displacement is driven so that it changes by a
      !> given value.
      subroutine solve_once(i, displacement, more, regular)
         !> Column of `change` that takes the result
         integer, intent(in) :: i
         !> The given change of the displacement [m]
         real(wp), intent(in) :: displacement
         !> Force on the pattern besides the load, by which the displacement is reached; 0 under a driven
         !> force
         real(wp), intent(out) :: more
         logical, intent(out) :: regular

         more = 0.0_wp
         if (by_force) then
            self%change(:, i) = self%load
            call self%matrix%solve(self%change(:, i:i), regular)
         else
            call self%matrix%solve_bordered(self%load, displacement, self%change(:, i), more, regular)
         end if
      end subroutine solve_once

   end subroutine follow_band

   !> Factor the band on the present lines, with its border where the displacement is driven.
   subroutine factor(self, k, by_force, found)
      class(equilibrium_type), intent(inout) :: self
      !> Stiffness of the springs (springs)
      real(wp), intent(in), contiguous :: k(:)
      !> Whether the force is driven, else the displacement
      logical, intent(in) :: by_force
      !> Whether the matrix is regular, under a driven force positive definite
      logical, intent(out) :: found
      integer :: i

      associate (structure => self%structure, matrix => self%matrix)
         ! Where one spring has changed its line, few columns differ.
         call structure%mark_columns(self%tangent, self%renewed)
         if (self%has_still) self%renewed = self%renewed .or. self%still
         do i = 1, size(self%renewed)
            if (self%renewed(i)) matrix%band(:, i) = self%geometric(:, i)
         end do
         call structure%add_stiffness(k, self%tangent, matrix%band, self%renewed)
         call hold_still(self)
         call matrix%factor(self%renewed)
         self%renewed = .false.
         ! The last pivots of a long chain are small by themselves; their ratio to the sums before counts.
         matrix%positive = matrix%negative == 0 .and. &
                           maxval(matrix%triangle(1, :)*self%pivot) < 1.0_wp/no_stiffness
         if (by_force) then
            found = matrix%positive
         else
            call matrix%set_border(self%pattern, structure%control, found)
         end if
      end associate
   end subroutine factor

   !> Whether the work of a correction is that of no stiffness, compared with the initial stiffness.
   pure logical function has_no_stiffness(springs, initial, motion, work)
      integer, intent(in) :: springs
      !> Initial stiffness and motion of the springs; twice the work of the correction [J]
      real(wp), intent(in) :: initial(springs), motion(springs), work
      real(wp) :: stiff_work
      integer :: i

      stiff_work = 0.0_wp
      !$omp simd reduction(+:stiff_work)
      do i = 1, springs
         stiff_work = stiff_work + initial(i)*motion(i)**2
      end do
      has_no_stiffness = abs(work) < no_stiffness*stiff_work
   end function has_no_stiffness

   !> Springs without stiffness share a motion as with a hardening in proportion to their initial stiffness,
   !> which the refinement takes away.
   elemental real(wp) function with_hardening(k, initial)
      !> Present and initial stiffness of a spring
      real(wp), intent(in) :: k, initial

      with_hardening = merge(k, hardening_of_none*initial, abs(k) > no_stiffness*initial)
   end function with_hardening

   !> Work of the load per unit of it and per unit of the driven quantity.
   real(wp) function work_rate(self, rate) result(work)
      class(equilibrium_type), intent(in) :: self
      !> Rates of the position (coordinates)
      real(wp), intent(in), contiguous :: rate(:)

      if (self%of_dead_load) then
         work = self%structure%work_of_dead_load(rate)
      else
         work = self%structure%work_of(lateral, self%change(:, 1))
      end if
   end function work_rate

   !> Find the largest force out of equilibrium where the springs are, which `unbalance` keeps.
   subroutine find_unbalance(self, springs, force)
      class(equilibrium_type), intent(inout) :: self
      type(spring_array), intent(in) :: springs
      !> Lateral force [N], or share of the dead load
      real(wp), intent(in) :: force
      integer :: i

      if (.not. self%structure%in_series) then
         ! Where an element snaps back its last tangent serves.
         call self%structure%linearise(springs%k, self%tangent, self%unstable)
         call find_residual(self, springs, force)
         return
      end if
      self%unbalance = 0.0_wp
      associate (structure => self%structure)
         do i = 1, self%moving
            self%f(i) = structure%arm(i)*force - (springs%f0(i) + springs%k(i)*(springs%d(i) - springs%d0(i)))
            self%unbalance = max(self%unbalance, abs(self%f(i))/merge(structure%total_height, 1.0_wp, &
                                                                      structure%location(i)%kind == flexure))
         end do
      end associate
   end subroutine find_unbalance

   !> Residual of the unknowns where the springs are, and the largest of it; under a growing dead load also
   !> the load per unit, which follows the present lines.
   subroutine find_residual(self, springs, force)
      class(equilibrium_type), intent(inout) :: self
      type(spring_array), intent(in) :: springs
      !> Lateral force [N], or share of the dead load
      real(wp), intent(in) :: force
      real(wp) :: signal(signals)
      integer :: i

      signal = 0.0_wp
      if (.not. self%of_dead_load) signal(lateral) = force
      associate (structure => self%structure)
         call springs%find_forces(springs%d, self%f)
         call structure%forces(springs%d, signal, self%axial, self%tangent, self%f, self%residual, &
                               self%inner, merge(force, 1.0_wp, self%of_dead_load))
         ! All of the dead load on the structure without deformations
         if (self%of_dead_load) then
            self%moved(:, 1) = 0.0_wp
            self%f = 0.0_wp
            call structure%forces(self%moved(:, 1), signal, self%axial, self%tangent, self%f, self%pattern, &
                                  self%inner_load)
         end if
         if (self%has_still) where (self%still) self%residual = 0.0_wp
         self%unbalance = 0.0_wp
         do i = 1, structure%unknowns
            self%unbalance = max(self%unbalance, abs(self%residual(i))/self%reach(i))
         end do
      end associate
   end subroutine find_residual

   !> Joints one above the other that nothing couples, small rotations without axial load, driven by the
   !> displacement. They share the force, and their motions add up. The force is that of the most flexible
   !> joint p and the corrections of the others, F' = -r_p/a_p + F'': with F' itself, its motion
   !> (r_p + a_p F')/k_p would be a difference of round-off over next to nothing.
   pure subroutine follow_diagonal(m, arm, initial, k, r, residual, rate, force_rate, correction, &
                                   force_correction, flexible, regular)
      integer, intent(in) :: m
      !> Arms of the force and initial stiffness of the joints (m); stiffness of the springs, residual (m),
      !> and the residual of the displacement [m]
      real(wp), intent(in) :: arm(m), initial(m), k(m), r(m), residual
      !> Change of the deformations per metre, and correction of the residuals (m); change of the force
      !> [N/m], and of the force with the correction [N]
      real(wp), intent(out) :: rate(m), correction(m), force_rate, force_correction
      !> Flexibilities, 0 where there is no stiffness (m)
      real(wp), intent(out) :: flexible(m)
      !> Whether there is a unique solution
      logical, intent(out) :: regular
      real(wp) :: flexibility
      integer :: i, p

      regular = .true.
      p = 1
      do i = 1, m
         flexible(i) = 0.0_wp
         if (abs(k(i)) > no_stiffness*initial(i)) then
            flexible(i) = arm(i)**2/k(i)
            if (regular .and. abs(flexible(i)) > abs(flexible(p))) p = i
         else
            regular = .false.
            p = i
         end if
      end do
      if (regular) then
         ! Softening joints have a negative flexibility; with that of the others it may vanish.
         flexibility = sum(flexible)
         regular = abs(flexibility) > no_stiffness*sum(abs(flexible))
         if (.not. regular) return
         force_rate = 1.0_wp/flexibility
         rate = flexible/arm*force_rate
      else
         regular = .true.
         force_rate = 0.0_wp
         ! Joints without stiffness take all the motion. Several share it as they would with a hardening in
         ! proportion to their initial stiffness, however small.
         rate = 0.0_wp
         where (.not. abs(flexible) > 0.0_wp) rate = arm/initial
         rate = rate/sum(arm*rate)
      end if
      force_correction = -r(p)/arm(p)
      correction = flexible/arm*(r/arm + force_correction)
      associate (displacement_error => residual - sum(arm*correction))
         correction = correction + rate*displacement_error
         force_correction = force_correction + force_rate*displacement_error
      end associate
   end subroutine follow_diagonal

   !> Save or restore, whichever the stream is set to, the rates. The factor is not saved, so that rates that
   !> are restored do not serve for the next lines.
   subroutine serialize(self, stream)
      class(equilibrium_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%items(self%force_rate, self%displacement_rate, self%dead_load_work_rate)
      if (stream%restoring) self%known%serve = .false.
   end subroutine serialize

end module rbs_solve_static_equilibrium
