!> Equilibrium of a column with small rotations, in the deformations of its joints: openings keep still, and
!> the force F has the arms a.
!>
!>     K q - a F = r,   a q = u        K = diag(k) + K_G
!>
!> A few bodies are solved in (slip, relative rotation) with full matrices. More are solved in (slip,
!> absolute rotation), where K is a band of two diagonals beside the main one: k_M couples neighbouring
!> rotations, the axial load only the slip of a joint and the rotation below it. A held top is solved there
!> too: its rotation is the last unknown, and is left out.
module rbs_solve_static_chain_equilibrium
   use rbs_base_band_matrix, only: band_matrix
   use rbs_base_constants, only: no_stiffness
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_hysteresis_springs, only: spring_array
   use rbs_solve_static_equilibrium, only: equilibrium_type
   use rbs_solve_static_few_bodies, only: few_bodies, most_unknowns
   use rbs_structure_column_chain, only: geometric_forces
   use rbs_structure_column_chain_matrices, only: geometric_stiffness
   use rbs_structure_column_column, only: column_type
   implicit none
   private

   public :: chain_equilibrium

   !> A relative rotation is a small difference of absolute ones. The digits that this costs are
   !> recovered: the residual is taken in the deformations of the joints and solved for again.
   integer, parameter :: refinements = 1

   type, extends(equilibrium_type) :: chain_equilibrium
      !> Number of joints, whether the rotation of the last body is held, and the height of the top [m]
      integer, private :: n = 0
      logical, private :: held = .false.
      real(wp), private :: height = 0.0_wp
      !> Arms of the force, and initial stiffness, which shares the motion between joints that have none left
      !> (2 n)
      real(wp), allocatable, private :: arm(:), initial(:)
      !> Axial forces that do second-order work, times lengths and across slips (2 n): the stiffness that they
      !> take away of the rotations, and between the slip of a joint and the rotation below it
      real(wp), allocatable, private :: axial(:)
      !> Whether the joints are coupled; if not, K is diagonal and nothing is factored
      logical, private :: coupled = .false.
      type(few_bodies), private :: few
      !> The tangent of more bodies, and the arms joint by joint (2 n)
      type(band_matrix), private :: tangent
      real(wp), allocatable, private :: lever(:)
      !> Forces of the springs and of K_G, and the residual (2 n)
      real(wp), allocatable, private :: f(:), g(:), residual(:)
      !> Work arrays, one column for the rate and one for the correction (2 n, 2)
      real(wp), allocatable, private :: found(:, :), missing(:, :), along(:, :), more(:, :)
   contains
      procedure :: create
      procedure :: follow
      procedure :: find_unbalance
      procedure :: serialize
   end type chain_equilibrium

contains

   subroutine create(self, column)
      class(chain_equilibrium), intent(out) :: self
      class(column_type), intent(in) :: column
      real(wp) :: stiffness(most_unknowns, most_unknowns), band(2*column%n)
      integer :: m, i

      m = 2*column%n
      self%n = column%n
      self%moving = m
      self%held = column%held
      self%height = column%total_height
      self%arm = column%arm(:m)
      self%initial = column%initial_stiffness(:m)
      self%coupled = column%axially_loaded .or. column%held
      allocate (self%f(m), self%g(m), self%residual(m), self%correction(m), source=0.0_wp)
      if (.not. self%coupled) return
      allocate (self%axial(m), source=0.0_wp)
      if (column%axially_loaded) self%axial(:) = column%second_order
      if (m <= most_unknowns .and. .not. column%held) then
         call geometric_stiffness(column, stiffness(:m, :m))
         call self%few%create(stiffness(:m, :m), self%arm)
      else
         allocate (self%lever(m), self%found(m, 2), self%missing(m, 2), self%along(m, 2), self%more(m, 2))
         do i = 1, self%n
            self%lever(2*i - 1:2*i) = [1.0_wp, column%length(i)]
            band(2*i - 1:2*i) = [self%initial(i), self%initial(self%n + i)]
            if (i < self%n) band(2*i) = band(2*i) + self%initial(self%n + i + 1)
         end do
         call self%tangent%create(m, 2, band)
      end if
   end subroutine create

   !> Residual of the equilibrium: a F - f - K_G q.
   subroutine find_residual(self, q, f, force, r)
      class(chain_equilibrium), intent(inout) :: self
      !> Deformations and forces of the springs (2 n)
      real(wp), intent(in), contiguous :: q(:), f(:)
      !> Lateral force [N]
      real(wp), intent(in) :: force
      !> Residual (2 n)
      real(wp), intent(out), contiguous :: r(:)
      integer :: i

      do i = 1, self%moving
         r(i) = self%arm(i)*force - f(i)
      end do
      if (.not. self%coupled) return
      call geometric_forces(self%n, self%axial, q, self%g)
      do i = 1, self%moving
         r(i) = r(i) - self%g(i)
      end do
   end subroutine find_residual

   !> The residual where the springs are, and the largest of it: moments over the height.
   subroutine find_unbalance(self, springs, force)
      class(chain_equilibrium), intent(inout) :: self
      type(spring_array), intent(in) :: springs
      real(wp), intent(in) :: force
      real(wp) :: shear, moment, of_top
      integer :: i

      do i = 1, self%moving
         self%f(i) = springs%f0(i) + springs%k(i)*(springs%d(i) - springs%d0(i))
      end do
      call find_residual(self, springs%d(:self%moving), self%f, force, self%residual)
      shear = 0.0_wp
      moment = 0.0_wp
      ! The moment that holds the top acts on all rotations.
      of_top = merge(self%residual(self%moving), 0.0_wp, self%held)
      do i = 1, self%n
         shear = max(shear, abs(self%residual(i)))
         moment = max(moment, abs(self%residual(self%n + i) - of_top))
      end do
      self%unbalance = max(shear, moment/self%height)
   end subroutine find_unbalance

   !> Rates and corrections on the present lines.
   subroutine follow(self, springs, by_force, corrects, displacement, force, rate, found)
      class(chain_equilibrium), intent(inout) :: self
      type(spring_array), intent(in) :: springs
      logical, intent(in) :: by_force, corrects
      real(wp), intent(in) :: displacement, force
      real(wp), intent(inout), contiguous :: rate(:)
      logical, intent(out) :: found
      real(wp) :: gap

      self%displacement_rate = 1.0_wp
      self%force_correction = 0.0_wp
      self%unbalance = 0.0_wp
      if (.not. by_force .and. .not. corrects) then
         call self%few%update(springs%k, rate, self%force_rate, found)
         if (found) self%correction = 0.0_wp
         if (found) return
      end if
      call self%find_unbalance(springs, force)
      gap = displacement - sum(self%arm*springs%d(:self%moving))
      if (self%few%unknowns > 0) then
         if (by_force) then
            call self%few%solve_force(springs%k, no_stiffness*self%initial, self%arm, self%residual, rate, &
                                      self%correction, found)
         else
            call self%few%solve(springs%k, self%residual, gap, rate, self%force_rate, self%correction, &
                                self%force_correction, found)
         end if
      else if (self%coupled) then
         call follow_band(self, springs%k, by_force, gap, rate, found)
      else if (by_force) then
         associate (k => springs%k(:self%moving))
            found = all(k > no_stiffness*self%initial)
            if (found) then
               rate = self%arm/k
               self%correction = self%residual/k
            end if
         end associate
      else
         call follow_diagonal(self%moving, self%arm, self%initial, springs%k, self%residual, gap, rate, &
                              self%force_rate, self%correction, self%force_correction, self%g, found)
      end if
      if (.not. by_force .or. .not. found) return
      self%force_rate = 1.0_wp
      self%displacement_rate = sum(self%arm*rate)
   end subroutine follow

   !> The band, where the displacement is driven with a border.
   subroutine follow_band(self, k, by_force, gap, rate, regular)
      class(chain_equilibrium), intent(inout) :: self
      !> Stiffness of the springs (2 n)
      real(wp), intent(in), contiguous :: k(:)
      logical, intent(in) :: by_force
      !> What is missing from the displacement [m]
      real(wp), intent(in) :: gap
      real(wp), intent(out), contiguous :: rate(:)
      logical, intent(out) :: regular
      real(wp) :: displacement(2), missing(2), force(2), more_force(2)
      integer :: j, again

      call fill_tangent(self, k)
      call self%tangent%factor()
      if (by_force) then
         regular = self%tangent%positive
         force = [1.0_wp, 0.0_wp]
      else
         call self%tangent%set_border(self%lever, regular=regular)
         displacement = [1.0_wp, gap]
         force = 0.0_wp
      end if
      if (.not. regular) return
      self%found = 0.0_wp
      do again = 0, refinements
         do j = 1, 2
            self%f = k(:self%moving)*self%found(:, j)
            call find_residual(self, self%found(:, j), self%f, force(j), self%missing(:, j))
            if (j == 2) self%missing(:, j) = self%missing(:, j) + self%residual
            call along_joints(self%n, self%missing(:, j), self%along(:, j))
            if (self%held) self%along(self%moving, j) = 0.0_wp
            missing(j) = displacement(j) - sum(self%arm*self%found(:, j))
         end do
         if (by_force) then
            self%more(:, :) = self%along
            call self%tangent%solve(self%more, regular)
         else
            call self%tangent%solve_bordered(self%along, missing, self%more, more_force, regular)
            if (.not. regular) return
            force = force + more_force
         end if
         do j = 1, 2
            call add_joints(self%n, self%more(:, j), self%found(:, j))
         end do
      end do
      rate = self%found(:, 1)
      self%correction(:) = self%found(:, 2)
      if (by_force) return
      self%force_rate = force(1)
      self%force_correction = force(2)
   end subroutine follow_band

   !> The tangent in (slip, absolute rotation), joint by joint.
   subroutine fill_tangent(self, k)
      class(chain_equilibrium), intent(inout) :: self
      !> Stiffness of the springs (2 n)
      real(wp), intent(in), contiguous :: k(:)
      integer :: i, n

      n = self%n
      self%tangent%band = 0.0_wp
      do i = 1, n
         self%tangent%band(1, 2*i - 1) = k(i)
         self%tangent%band(1, 2*i) = k(n + i) - self%axial(i)
         if (i == n) exit
         self%tangent%band(1, 2*i) = self%tangent%band(1, 2*i) + k(n + i + 1)
         self%tangent%band(2, 2*i) = -self%axial(n + i + 1)
         self%tangent%band(3, 2*i) = -k(n + i + 1)
      end do
      if (self%held) call self%tangent%hold(2*n, self%tangent%stiffness(2*n))
   end subroutine fill_tangent

   !> Forces on (slip, absolute rotation), joint by joint, from those of the joints.
   pure subroutine along_joints(n, r, b)
      integer, intent(in) :: n
      !> By kind; joint by joint
      real(wp), intent(in) :: r(n, 2)
      real(wp), intent(out) :: b(2, n)
      integer :: i

      do i = 1, n
         b(:, i) = r(i, :)
         if (i < n) b(2, i) = b(2, i) - r(i + 1, 2)
      end do
   end subroutine along_joints

   !> Add changes in (slip, absolute rotation) to deformations of the joints.
   pure subroutine add_joints(n, z, q)
      integer, intent(in) :: n
      !> Joint by joint; by kind
      real(wp), intent(in) :: z(2, n)
      real(wp), intent(inout) :: q(n, 2)
      integer :: i

      do i = n, 2, -1
         q(i, 1) = q(i, 1) + z(1, i)
         q(i, 2) = q(i, 2) + (z(2, i) - z(2, i - 1))
      end do
      q(1, :) = q(1, :) + z(:, 1)
   end subroutine add_joints

   !> Joints one above the other that nothing couples, small rotations without axial load, driven by the
   !> displacement. They share the force, and their motions add up. The force is that of the most flexible
   !> joint p and what takes the others to it, F' = -r_p/a_p + F'': with F' itself, its motion
   !> (r_p + a_p F')/k_p would be a difference of round-off over next to nothing.
   pure subroutine follow_diagonal(m, arm, initial, k, r, gap, rate, force_rate, correction, &
                                   force_correction, flexible, regular)
      integer, intent(in) :: m
      !> Arms of the force and initial stiffness of the joints (m); stiffness of the springs, residual (m),
      !> and what is missing from the displacement [m]
      real(wp), intent(in) :: arm(m), initial(m), k(m), r(m), gap
      !> Change of the deformations per metre, and what takes the residuals away (m); change of the force
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
      associate (missing => gap - sum(arm*correction))
         correction = correction + rate*missing
         force_correction = force_correction + force_rate*missing
      end associate
   end subroutine follow_diagonal

   !> Save or restore the rates, and the last solution of few bodies.
   subroutine serialize(self, stream)
      class(chain_equilibrium), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%items(self%force_rate, self%displacement_rate)
      call self%few%serialize(stream)
   end subroutine serialize

end module rbs_solve_static_chain_equilibrium
