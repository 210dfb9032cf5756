!> The column that a specification describes: bodies, masses, axial forces, springs and loads.
module rbs_structure_column_new_column
   use rbs_base_check, only: is_given
   use rbs_base_kinds, only: wp
   use rbs_structure_column_chain, only: joint_forces
   use rbs_structure_column_column, only: column_type, small, pdelta, finite
   use rbs_structure_column_column_record, only: column_record
   use rbs_structure_column_finite, only: finite_chain_type
   use rbs_hysteresis_spring_record, only: add_rules
   use rbs_structure_spring_location, only: spring_location, shear, flexure, axial
   use rbs_structure_structure, only: unknown_group, lateral, horizontal, vertical, top_axial
   implicit none
   private

   public :: new_column

   !> Rotary inertia of a body that does not turn [kg m2]: any positive number serves, as its rotation is
   !> held.
   real(wp), parameter :: of_held_body = 1.0_wp

contains

   !> Make the column of a validated specification.
   subroutine new_column(column, spec)
      class(column_type), allocatable, intent(out) :: column
      !> Validated
      type(column_record), intent(in) :: spec
      integer :: first, last, n

      if (spec%kinematics == 'finite') then
         allocate (finite_chain_type :: column)
      else
         allocate (column_type :: column)
      end if
      column%footing = spec%footing
      column%held = spec%top == 'fixed'
      n = spec%joints()
      column%n = n
      column%height = spec%height
      ! The bodies of the column itself
      first = merge(2, 1, column%footing)
      last = first + spec%n - 1
      column%opens = allocated(spec%axial_spring)
      column%kinds = merge(3, 2, column%opens)
      column%unknowns = column%kinds*n
      select case (spec%kinematics)
      case ('pdelta')
         column%kinematics = pdelta
      case ('finite')
         column%kinematics = finite
      case default
         column%kinematics = small
      end select

      allocate (column%length(n), column%mass(n), source=0.0_wp)
      if (allocated(spec%lengths)) then
         column%length(first:last) = spec%lengths
      else
         column%length(first:last) = spec%height/spec%n
      end if
      if (allocated(spec%masses)) then
         column%mass(first:last) = spec%masses
      else
         column%mass(first:last) = spec%mass*(column%length(first:last)/spec%height)
      end if
      if (column%footing) then
         column%length(1) = spec%footing_height
         column%mass(1) = spec%footing_mass
      end if
      column%mass_damping = spec%damping%mass
      column%stiffness_damping = spec%damping%stiffness
      ! In a chain the damping by stiffness acts in each spring by itself.
      column%spring_damping = column%stiffness_damping
      column%tangent_damping = spec%damping%tangent
      if (allocated(spec%damping%modal)) column%modal_damping = spec%damping%modal
      column%damped = column%mass_damping > 0.0_wp .or. column%stiffness_damping > 0.0_wp .or. &
                      allocated(column%modal_damping)

      call set_heights()
      if (spec%self_weight) column%gravity = spec%gravity
      column%weight = column%gravity*column%mass
      call set_bodies()
      call set_mass_sums()
      call set_lifted_masses()
      call set_springs()
      column%axial_force_ratio = spec%axial_force_ratio
      if (is_given(spec%axial_height)) column%axial_lever = spec%axial_height/spec%height
      call column%put_under(spec%axial_load)
      column%initial_stiffness = column%rules%initial_stiffness()
      call set_unknowns(column)

   contains

      !> Set the heights of the joints, and the displacement of the top per deformation of a joint (`arm`).
      subroutine set_heights()
         integer :: i, n

         n = column%n
         allocate (column%joint_height(n + 1))
         column%coordinates = column%unknowns
         allocate (column%arm(column%coordinates), source=0.0_wp)
         column%joint_height(1) = 0.0_wp
         do i = 1, n
            column%joint_height(i + 1) = column%joint_height(i) + column%length(i)
         end do
         column%total_height = column%joint_height(n + 1)
         column%arm(:n) = 1.0_wp
         ! Summed from the top down: the lever arm of an upper joint is not a difference of large heights.
         column%arm(2*n) = column%length(n)
         do i = n - 1, 1, -1
            column%arm(n + i) = column%arm(n + i + 1) + column%length(i)
         end do
      end subroutine set_heights

      !> Centroids and rotary inertias of the bodies; those of the last one with the mass lumped at the top.
      subroutine set_bodies()
         real(wp) :: body_mass, shift
         integer :: i, n

         n = column%n
         column%inertia = column%mass*(column%length**2 + spec%depth**2)/12.0_wp
         if (allocated(spec%rotary_inertia)) then
            ! One value serves all bodies.
            column%inertia(first:last) = spec%rotary_inertia(min([(i, i=1, spec%n)], &
                           size(spec%rotary_inertia)))
         end if
         column%lower = column%length/2.0_wp
         column%upper = column%length/2.0_wp
         if (column%footing) column%inertia(1) = spec%footing_inertia
         if (column%held) then
            column%mass(n) = spec%top_mass
            column%inertia(n) = of_held_body
            return
         end if
         if (.not. spec%top_mass > 0.0_wp .and. .not. spec%top_inertia > 0.0_wp) return
         ! The centroid of the last body moves up by `shift`. About it the body adds body_mass shift^2
         ! and the lumped mass top_mass (upper - shift)^2, together body_mass shift upper.
         body_mass = column%mass(n)
         shift = spec%top_mass/(body_mass + spec%top_mass)*column%upper(n)
         column%inertia(n) = column%inertia(n) + spec%top_inertia + body_mass*shift*column%upper(n)
         column%mass(n) = body_mass + spec%top_mass
         column%upper(n) = body_mass/column%mass(n)*column%upper(n)
         column%lower(n) = column%length(n) - column%upper(n)
      end subroutine set_bodies

      !> Sums over the bodies above each joint; every term is positive, so nothing cancels.
      subroutine set_mass_sums()
         integer :: i, n

         n = column%n
         allocate (column%mass_above(n + 1), column%moment_above(n + 1), column%inertia_above(n + 1), &
                   source=0.0_wp)
         do i = n, 1, -1
            associate (m => column%mass(i), l => column%length(i), s => column%lower(i))
               column%mass_above(i) = column%mass_above(i + 1) + m
               column%moment_above(i) = column%moment_above(i + 1) + l*column%mass_above(i + 1) + m*s
               column%inertia_above(i) = column%inertia_above(i + 1) &
                                         + 2.0_wp*l*column%moment_above(i + 1) &
                                         + l**2*column%mass_above(i + 1) &
                                         + m*s**2 + column%inertia(i)
            end associate
         end do
      end subroutine set_mass_sums

      !> Axial forces per vertical acceleration of the ground [kg]: masses above a joint and, for the rotation
      !> of a body, its own mass at its centroid and those above it.
      subroutine set_lifted_masses()
         integer :: n

         n = column%n
         ! A body without length does not lean.
         column%lifted_body = column%mass_above(2:)
         where (column%length > 0.0_wp)
            column%lifted_body = column%mass*column%lower/column%length + column%mass_above(2:)
         end where
         column%lifted_joint = column%mass_above(:n)
      end subroutine set_lifted_masses

      !> Set the places of the springs and their rules: of all joints shear, then flexure, then axial springs.
      subroutine set_springs()
         integer :: i, joint, n

         n = column%n
         allocate (column%location(column%unknowns))
         allocate (column%constant_axial(column%unknowns), source=0.0_wp)
         allocate (column%at(3, n), source=0)
         do i = 1, n
            column%at(:2, i) = [i, n + i]
            ! With a footing joints have numbers from 0 on.
            joint = merge(i - 1, i, column%footing)
            ! A shear spring may ask for the work of the flexural one of its joint, spring n + i.
            column%location(i) = spring_location(shear, 1, joint, n + i, n + i, i)
            column%location(n + i) = spring_location(flexure, 1, joint, index=i)
            if (.not. column%opens) cycle
            column%at(axial, i) = 2*n + i
            column%location(2*n + i) = spring_location(axial, 1, joint, index=i)
         end do
         call add_rules(column%rules, spec%shear, n)
         call add_rules(column%rules, spec%flexure, n)
         if (column%opens) call add_rules(column%rules, spec%axial_spring, n)
      end subroutine set_springs
   end subroutine new_column

   !> The coordinates of the bodies, in which the mass is diagonal, their groups and the patterns of the
   !> loads; see `rbs_structure_column_chain`.
   subroutine set_unknowns(column)
      class(column_type), intent(inout) :: column
      integer :: i, n, m

      n = column%n
      m = column%unknowns
      column%half_width = 3
      allocate (column%inertias(m), column%is_held(m), column%part(m))
      column%is_held = .false.
      column%is_held(2*n) = column%held
      ! Axial springs keep still where no axial load changes.
      column%moving = 2*n
      column%is_still = column%is_held
      column%is_still(2*n + 1:) = .true.
      column%loses_digits = .true.
      do i = 1, n
         column%inertias(2*i - 1:2*i) = [column%mass(i), column%inertia(i)]
         column%part(2*i - 1:2*i) = i
         if (.not. column%opens) cycle
         column%inertias(2*n + i) = column%mass(i)
         column%part(2*n + i) = n + i
      end do
      ! A column that is used on static paths alone may have no mass, or no rotary inertia.
      allocate (column%inverse_mass(n), column%inverse_inertia(n), source=0.0_wp)
      where (column%mass > 0.0_wp) column%inverse_mass = 1.0_wp/column%mass
      where (column%inertia > 0.0_wp) column%inverse_inertia = 1.0_wp/column%inertia
      if (column%held) column%inverse_inertia(n) = 0.0_wp
      ! A chain has no parts between its unknowns.
      allocate (column%initial_tangent(0))
      column%axial_count = 2*n
      column%work_size = 5*n
      ! The spring whose force is the base shear
      column%base_spring = column%at(shear, 1)
      ! Translations, rotations, and openings if there are some.
      allocate (column%group(merge(3, 2, column%opens)))
      ! First unknown, count, step; first and last spring; largest force per lateral force
      column%group(1) = unknown_group(1, n, 2, 1, n, 1.0_wp)
      column%group(2) = unknown_group(2, n, 2, n + 1, 2*n, column%upper(n))
      if (column%opens) column%group(3) = unknown_group(2*n + 1, n, 1, 2*n + 1, 3*n)
      do i = 1, size(column%pattern)
         allocate (column%pattern(i)%force(m), source=0.0_wp)
      end do
      ! The lateral force acts at the top, `upper` above the centroid of the last body.
      column%pattern(lateral)%force(2*n - 1:2*n) = [1.0_wp, column%upper(n)]
      if (column%held) column%pattern(lateral)%force(2*n) = 0.0_wp
      column%control = column%pattern(lateral)%force
      column%pattern(horizontal)%force(1:2*n:2) = -column%mass
      if (column%opens) then
         column%pattern(vertical)%force(2*n + 1:) = -column%mass
         column%pattern(top_axial)%force(3*n) = -1.0_wp
      end if
      ! Forces of the joints by each pattern; the unknowns from the first to the last that it acts on
      do i = 1, size(column%pattern)
         associate (pattern => column%pattern(i))
            allocate (pattern%arm(m))
            call joint_forces(n, column%kinds, column%lower, column%upper, pattern%force, pattern%arm)
            pattern%first = findloc(abs(pattern%force) > 0.0_wp, .true., dim=1)
            pattern%last = findloc(abs(pattern%force) > 0.0_wp, .true., dim=1, back=.true.)
            if (pattern%first == 0) pattern%first = 1
         end associate
      end do
   end subroutine set_unknowns

end module rbs_structure_column_new_column
