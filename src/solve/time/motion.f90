!> Equation of motion of a structure: forces on its unknowns and accelerations of its springs at a state, on
!> the present lines of the springs.
!>
!>     M x'' + C x' + B' f(d) + K_G x = sum signal * pattern,   d = B x
!>
!> A motion does not change once it has been created: all that `acceleration` finds is in its result.
module rbs_solve_time_motion
   use rbs_base_error, only: error_type
   use rbs_base_inner_product, only: inner_product
   use rbs_base_kinds, only: wp
   use rbs_structure_column_column, only: column_type
   use rbs_hysteresis_springs, only: spring_array
   use rbs_solve_modal_matrices, only: modal_damping
   use rbs_solve_one_body_body_damping, only: body_damping, column_of_one_body, damping_of_body
   use rbs_loading_loads, only: lateral, horizontal, vertical, top_axial
   use rbs_structure_structure, only: structure_type, motion_result, signals, pdelta, finite
   implicit none
   private

   public :: equation_of_motion, motion_result

   type :: equation_of_motion
      class(structure_type), pointer :: structure => null()
      !> The structure where it is a column of one body under lateral force and horizontal ground motion, its
      !> rotations small: such runs have forms of their own; its damping there
      type(column_type), pointer :: one_body => null()
      type(body_damping) :: damping
      !> Which of the loads act (see `rbs_loading_loads`), and whether axial forces vary
      logical :: acts(signals) = .false., varies = .false.
      !> Damping of the springs, beta k0 (springs) [N s/m, N m s]; modal damping (springs, springs); allocated
      !> only if there is any
      real(wp), allocatable :: joint_damping(:), modal(:, :)
      !> Whether there is damping at all, and whether any axial force does second-order work
      logical :: damped = .false., second_order = .false.
      !> Whether springs are damped one by one, or by modes of their deformations
      logical :: springs_damp = .false.
      !> The spring whose force is the base shear, 0 where more than that belongs to it
      integer :: base_spring = 0
      !> Whether the power of the loads follows from velocity of the top and momentum alone, and that of
      !> damping is none
      logical :: plain = .false.
   contains
      procedure :: create, acceleration, forces_on_bodies, joint_forces, set_axial_loads, damping_power
      procedure :: base_shear
      procedure, non_overridable :: viscous
   end type equation_of_motion

contains

   !> Set what belongs to the equation of motion of a structure under given loads.
   subroutine create(self, structure, acts, error)
      class(equation_of_motion), intent(out) :: self
      class(structure_type), intent(in), target :: structure
      !> Which of the loads act
      logical, intent(in) :: acts(signals)
      type(error_type), allocatable, intent(out) :: error

      self%structure => structure
      self%acts = acts
      self%varies = acts(vertical) .or. acts(top_axial)
      self%joint_damping = structure%spring_damping*structure%initial_stiffness
      self%damped = structure%damped
      if (.not. self%damped .and. structure%base_spring > 0) self%base_spring = structure%base_spring
      if (allocated(structure%modal_damping) .and. .not. allocated(structure%modal_momenta)) then
         call modal_damping(structure, self%modal, error)
         if (allocated(error)) return
      end if
      self%springs_damp = structure%spring_damping > 0.0_wp .or. allocated(self%modal)
      self%second_order = structure%kinematics == pdelta .and. (structure%axially_loaded .or. self%varies)
      self%plain = structure%kinematics /= finite .and. .not. (self%damped .or. self%varies)
      ! The forms for one body know small rotations and constant axial forces alone.
      if (structure%kinematics == finite .or. self%varies) return
      self%one_body => column_of_one_body(structure)
      if (.not. associated(self%one_body)) return
      self%damping = damping_of_body(self%one_body, self%joint_damping, self%modal)
   end subroutine create

   !> Accelerations of the springs at a state, and the forces that cause them.
   subroutine acceleration(self, springs, q, v, load, result)
      class(equation_of_motion), intent(in) :: self
      type(spring_array), intent(in) :: springs
      !> Deformations and their velocities (springs); loads at the time
      real(wp), intent(in) :: q(self%structure%coordinates), v(self%structure%coordinates), load(signals)
      type(motion_result), intent(inout) :: result
      integer :: m

      call springs%find_forces(q, result%f)
      m = 0
      if (self%damped .or. self%second_order .or. springs%axial_load_varies) then
         call find_others(self, springs, v, load, result, m)
      end if
      call self%structure%accelerations(q, v, load, m, result)
   end subroutine acceleration

   !> Forces on the unknowns with small rotations; all of the result but the accelerations.
   subroutine forces_on_bodies(self, springs, q, v, load, result, g)
      class(equation_of_motion), intent(in) :: self
      type(spring_array), intent(in) :: springs
      !> Position and velocity (coordinates)
      real(wp), intent(in) :: q(self%structure%coordinates), v(self%structure%coordinates)
      !> Loads at the time
      real(wp), intent(in) :: load(signals)
      type(motion_result), intent(inout) :: result
      !> Without the inertia of the moving ground and without mass damping (unknowns)
      real(wp), intent(out), contiguous :: g(:)
      real(wp), allocatable :: more(:)
      integer :: m

      call springs%find_forces(q, result%f)
      m = 0
      if (self%damped .or. self%second_order .or. springs%axial_load_varies) then
         call find_others(self, springs, v, load, result, m)
      end if
      ! Springs resist a motion from an anchor where an implicit step asks for that.
      if (result%resistance > 0.0_wp) then
         allocate (more(springs%count))
         call springs%find_resistance(result%resistance*self%structure%initial_stiffness, q - result%anchor, &
                                      more)
         result%f = result%f + more
      end if
      call self%structure%forces(q, load, result%axial(:m), result%tangent, result%f, g, result%correction)
   end subroutine forces_on_bodies

   !> Add what acts besides the forces of the springs on their lines: forces of damping and of axial loads
   !> that vary, to the forces of the springs; axial forces that do second-order work.
   subroutine find_others(self, springs, v, load, result, m)
      type(equation_of_motion), intent(in) :: self
      type(spring_array), intent(in) :: springs
      !> Velocity (coordinates); loads at the time
      real(wp), intent(in) :: v(self%structure%coordinates), load(signals)
      !> Gets the forces
      type(motion_result), intent(inout) :: result
      !> Number of axial forces that do second-order work
      integer, intent(inout) :: m

      if (self%damped .or. springs%axial_load_varies) call add_to_springs(self, springs, v, load, result%f)
      if (.not. self%second_order) return
      m = size(result%axial)
      if (self%varies) call self%structure%axial_forces(load, result%axial)
   end subroutine find_others

   !> Forces of the springs on their present lines and of the damping beside them, for output.
   subroutine joint_forces(self, springs, q, v, load, f)
      class(equation_of_motion), intent(in) :: self
      type(spring_array), intent(in) :: springs
      !> Position and velocity (coordinates)
      real(wp), intent(in), contiguous :: q(:), v(:)
      !> Loads at the time
      real(wp), intent(in) :: load(signals)
      !> Forces (springs) [N, N m]
      real(wp), intent(inout), contiguous :: f(:)

      call springs%find_forces(q, f)
      if (self%damped .or. springs%axial_load_varies) call add_to_springs(self, springs, v, load, f)
   end subroutine joint_forces

   !> Add the forces of layered joints by axial loads that have changed, and those of the damping.
   subroutine add_to_springs(self, springs, v, load, f)
      class(equation_of_motion), intent(in) :: self
      type(spring_array), intent(in) :: springs
      !> Velocity (coordinates); loads at the time
      real(wp), intent(in) :: v(self%structure%coordinates), load(signals)
      !> Forces of the springs, which are added to (springs) [N, N m]
      real(wp), intent(inout), contiguous :: f(:)
      integer :: i, j

      if (springs%axial_load_varies) then
         do j = 1, size(springs%layered)
            i = springs%layered(j)
            ! On its plane M = m + k phi - e N the moment falls with the axial load by e, the `centre`.
            f(i) = f(i) - springs%centre(i)*(self%structure%axial_force(i, load) - &
              springs%reference_axial_load(i))
         end do
      end if
      if (.not. self%springs_damp) return
      f = f + viscous(self, springs%k, self%joint_damping)*v
      if (allocated(self%modal)) f = f + modal_forces(size(v), self%modal, v)
   end subroutine add_to_springs

   !> Damping of a spring [N s/m, N m s] by its present or its initial stiffness; one that softens damps
   !> nothing.
   elemental real(wp) function viscous(self, k, initial)
      class(equation_of_motion), intent(in) :: self
      !> Stiffness of its line, and its damping on the initial one
      real(wp), intent(in) :: k, initial

      viscous = merge(self%structure%spring_damping*max(k, 0.0_wp), initial, self%structure%tangent_damping)
   end function viscous

   !> Forces of the modal damping.
   pure function modal_forces(m, modal, v) result(f)
      integer, intent(in) :: m
      !> Matrix of the modal damping, and velocities of the springs
      real(wp), intent(in) :: modal(m, m), v(m)
      real(wp) :: f(m)
      integer :: j

      f = 0.0_wp
      do j = 1, m
         f = f + modal(:, j)*v(j)
      end do
   end function modal_forces

   !> Tell layered joints the axial forces that their next move leads to; nothing where axial loads are
   !> constant.
   subroutine set_axial_loads(self, springs, load)
      class(equation_of_motion), intent(in) :: self
      type(spring_array), intent(inout) :: springs
      !> Loads at the end of the move
      real(wp), intent(in) :: load(signals)
      integer :: i, j

      if (.not. springs%axial_load_varies) return
      do j = 1, size(springs%layered)
         i = springs%layered(j)
         springs%target_axial_load(i) = self%structure%axial_force(i, load)
      end do
   end subroutine set_axial_loads

   !> Power of the damping of springs and bodies at a state [W].
   real(wp) function damping_power(self, springs, q, v) result(watt)
      class(equation_of_motion), intent(in) :: self
      type(spring_array), intent(in) :: springs
      !> Position and velocity (coordinates)
      real(wp), intent(in), contiguous :: q(:), v(:)

      watt = 0.0_wp
      if (.not. self%damped) return
      associate (structure => self%structure)
         if (self%springs_damp) watt = sum(viscous(self, springs%k, self%joint_damping)*v**2)
         if (allocated(self%modal)) then
            watt = watt + inner_product(size(v), v, modal_forces(size(v), self%modal, v))
         end if
         ! In proportion to the mass: twice the kinetic energy
         if (structure%mass_damping > 0.0_wp) then
            watt = watt + 2.0_wp*structure%mass_damping*structure%kinetic_energy(q, v)
         end if
      end associate
   end function damping_power

   !> Base shear, the force of the ground on the structure along x: forces of the lowest springs and of the
   !> damping, that between the bodies and the ground included [N]; called in every step.
   real(wp) function base_shear(self, springs, q, v) result(force)
      class(equation_of_motion), intent(in) :: self
      type(spring_array), intent(in) :: springs
      !> Position and velocity (coordinates)
      real(wp), intent(in) :: q(self%structure%coordinates), v(self%structure%coordinates)
      real(wp) :: c(3)
      integer :: i

      if (associated(self%one_body)) then
         c = self%damping%on_lines(springs%k(1), springs%k(2))
         force = springs%f0(1) + springs%k(1)*(q(1) - springs%d0(1)) + (c(1)*v(1) + c(2)*v(2))
         return
      end if
      associate (structure => self%structure)
         i = structure%base_spring
         if (i == 0) then
            force = structure%base_force(q, springs%forces(q))
         else
            force = springs%f0(i) + springs%k(i)*(q(i) - springs%d0(i))
            if (self%damped) then
               force = force + viscous(self, springs%k(i), self%joint_damping(i))*v(i)
               ! The matrix is symmetric: its columns lie together.
               if (allocated(self%modal)) force = force + inner_product(size(v), self%modal(:, i), v)
            end if
         end if
         if (structure%mass_damping > 0.0_wp) then
            force = force - structure%mass_damping*structure%speed(horizontal, q, v)
         end if
      end associate
   end function base_shear

end module rbs_solve_time_motion
