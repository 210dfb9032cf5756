!> A structure of rigid bodies and springs, as solvers use it: unknowns with a diagonal mass, springs
!> whose deformations are linear in them, and loads that are signals times patterns.
!>
!>     M x'' + C x' + B' f(d) + K_G(N) x = sum signal * pattern,   d = B x
!>
!> A structure does not change once it has been made, and every run on it shares it.
module rbs_structure_structure
   use rbs_base_error, only: error_type, fatal_error, bad_input
   use rbs_base_inner_product, only: inner_product
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_hysteresis_layer_joints, only: layer_joints
   use rbs_hysteresis_rule, only: spring_rules
   use rbs_hysteresis_springs, only: spring_array
   use rbs_structure_condensation, only: series_tangent
   use rbs_structure_channel, only: channel_type, response_type, row_contents
   use rbs_structure_dynamic_stiffness, only: dynamic_stiffness
   use rbs_structure_spring_location, only: spring_location
   implicit none
   private

   public :: structure_type, motion_result, load_pattern, unknown_group, accelerate_unknowns, &
             power_of_patterns
   public :: small, pdelta, finite
   public :: lateral, horizontal, vertical, top_axial, sideways, signals, signal_names

   !> Levels of kinematics.
   integer, parameter :: small = 1, pdelta = 2, finite = 3

   !> Signals of the loads: lateral force [N], acceleration of the ground to +x and upward [m/s2], axial load
   !> besides the constant one, compression positive [N]; acceleration of the ground along y of a building, to
   !> whose x the one to +x is [m/s2].
   integer, parameter :: lateral = 1, horizontal = 2, vertical = 3, top_axial = 4, sideways = 5, signals = 5
   character(len=21), parameter :: signal_names(signals) = [character(len=21) :: &
      'force', 'ground_acceleration', 'vertical_acceleration', 'axial_load', 'ground_acceleration_y']

   !> Forces on the unknowns per unit of a signal.
   type :: load_pattern
      real(wp), allocatable :: force(:)
      !> Forces conjugate to the deformations of the springs, where these are the coordinates of a position;
      !> else not allocated (coordinates)
      real(wp), allocatable :: arm(:)
      !> First and last unknown that has any; none if the last is less than the first
      integer :: first = 1, last = 0
   end type load_pattern

   !> Unknowns of one kind and the springs whose forces are of that kind: forces, moments, vertical forces.
   !> Both are slices of their arrays; that of the unknowns is given by first, count and step.
   type :: unknown_group
      integer :: first = 1, count = 0, step = 1, first_spring = 1, last_spring = 0
      !> Largest force of the group per lateral force
      real(wp) :: lateral_arm = 0.0_wp
   end type unknown_group

   type, abstract :: structure_type
      !> Number of unknowns, and of diagonals of the stiffness beside the main one; number of bodies; those
      !> that are held count too
      integer :: unknowns = 0, half_width = 0, n = 0
      !> Length of a position: deformations of the springs, and behind them the unknowns where these do not
      !> follow from the deformations, openings and rotations of joints of layers. All move with the same step
      integer :: coordinates = 0
      !> `small`, `pdelta` or `finite`; number of storeys whose drifts are known
      integer :: kinematics = small, storeys = 0
      !> Whether collapse is judged by the drifts of the storeys, else by that of the top
      logical :: by_storeys = .false.
      !> Names of the unknowns of a frame, for its matrices (unknowns)
      character(len=40), allocatable :: unknown_name(:)
      !> Lengths of the bodies (n) [m]
      real(wp), allocatable :: length(:)
      !> Height that drifts are in proportion to, and that of the top above the ground [m]
      real(wp) :: height = 0.0_wp, total_height = 0.0_wp
      !> Mass or rotary inertia of each unknown (unknowns) [kg, kg m2]
      real(wp), allocatable :: inertias(:)
      !> Unknowns that supports keep still, and those that keep still on static paths (unknowns)
      logical, allocatable :: is_held(:), is_still(:)
      !> Number of springs that can move on static paths; they are the first ones
      integer :: moving = 0
      !> Whether deformations are small differences of the unknowns, whose digits a refinement recovers
      logical :: loses_digits = .false.
      !> Whether motions are found by implicit steps alone
      logical :: is_implicit = .false.
      !> The body, or the part of it that is coupled, that an unknown belongs to (unknowns)
      integer, allocatable :: part(:)
      type(unknown_group), allocatable :: group(:)
      !> Height for moments, 1 for forces: factors that bring those of one group to one unit (unknowns); not
      !> allocated where no group has both
      real(wp), allocatable :: reach(:)
      !> Where the springs are, their rules and initial stiffness, and the constant axial force at each,
      !> compression positive [N] (springs)
      type(spring_location), allocatable :: location(:)
      type(spring_rules) :: rules
      real(wp), allocatable :: initial_stiffness(:), constant_axial(:)
      !> Joints whose layers are springs
      type(layer_joints) :: joints
      !> Displacement of the top per coordinate, for small rotations, which static paths control (coordinates)
      real(wp), allocatable :: arm(:)
      !> Zeros that it begins with, or fewer: a multiple of four, so that the sums of `inner_product` stay the
      !> same
      integer :: before_arm = 0
      !> The same per unknown (unknowns)
      real(wp), allocatable :: control(:)
      !> The spring whose force is the base shear; 0: `base_force` gives it
      integer :: base_spring = 0
      !> Axial load at the top that is there from the start, compression positive [N]; change of the axial
      !> load at the top per lateral force on a static path
      real(wp) :: axial_load = 0.0_wp, axial_force_ratio = 0.0_wp
      !> Whether a constant axial force does second-order work, from the load or from the weight; whether all
      !> springs carry the lateral force and their motions add up to that of the top
      logical :: axially_loaded = .false., in_series = .false.
      !> Damping in proportion to the mass [1/s] and to the stiffness of the springs [s], the initial one
      !> or that of the present line; the part of the latter that acts in each spring by itself [s]
      real(wp) :: mass_damping = 0.0_wp, stiffness_damping = 0.0_wp, spring_damping = 0.0_wp
      logical :: tangent_damping = .false.
      !> Damping ratios of the modes (first modes, or one for all); not allocated without modal damping
      real(wp), allocatable :: modal_damping(:)
      !> Where it acts on the unknowns: those that have mass; momenta of the modes times sqrt(2 zeta omega),
      !> whose products are the damping matrix (unknowns with mass, modes); that itself where it takes fewer
      !> numbers
      integer, allocatable :: massed(:)
      real(wp), allocatable :: modal_momenta(:, :), modal_matrix(:, :)
      !> Whether there is damping at all
      logical :: damped = .false.
      !> Number of axial forces that may do second-order work, and of numbers in the work array of
      !> `accelerations`
      integer :: axial_count = 0, work_size = 0
      !> Parts between the unknowns, whose deformations depend on the present stiffness of the springs, on the
      !> initial one: none where deformations follow from the unknowns alone (parts)
      type(series_tangent), allocatable :: initial_tangent(:)
      !> Loads in the order of their signals (signals)
      type(load_pattern) :: pattern(signals)
      !> Two numbers that mark its springs and sizes in a state, 0 as long as none was asked for
      real(wp) :: stamp(2) = 0.0_wp
   contains
      !> Changes of the deformations of the springs from those of the unknowns
      procedure(gather), deferred :: spring_rates
      !> Changes of the unknowns from those of the deformations
      procedure(spread_out), deferred :: unknown_rates
      !> Forces on the unknowns
      procedure(collect), deferred :: forces
      !> Axial forces that do second-order work, under loads
      procedure(find_axial_forces), deferred :: axial_forces
      procedure(assemble_springs), deferred :: add_stiffness
      procedure(assemble), deferred :: add_geometric
      !> Absolute rotations of the bodies
      procedure(find_rotations), deferred :: rotations
      !> Potential of constant loads, zero where no spring is deformed [J]
      procedure(of_position), deferred :: potential_energy
      !> Refuse loads that do nothing
      procedure(refuse_loads), deferred :: check_loads
      !> Channels of a row besides those of all structures, and the values of a row
      procedure(list_channels), deferred :: channels
      procedure(fill_values), deferred :: fill_row
      ! Defaults for small rotations
      procedure :: accelerations => accelerate_unknowns, speed, power_of_loads => power_of_patterns
      procedure :: kinetic_energy, largest_rotation, storey_drifts, largest_drift, top_displacement
      procedure :: top_acceleration, axial_force, acceleration_scale, check_initial, check_inertia
      ! Small motions on the initial stiffness
      procedure :: dynamic_parts, critical_factor, momenta
      !> Put the structure under a constant axial load at its top
      procedure :: put_under
      ! Members that fail during a run
      procedure :: next_failed_member, remove_member, has_collapsed, unbounded_spring
      ! Where deformations follow from the unknowns and the present stiffness of the springs
      procedure :: linearise, mark_columns, damp, add_damping, size_of_parts, clear_round_off, set_shape
      procedure :: work_of_dead_load, create_springs, add_ground, base_force, work_of
   end type structure_type

   !> Accelerations, forces and powers of the equation of motion at one state. `create` allocates it once,
   !> before the first step.
   type :: motion_result
      !> Accelerations of the coordinates (coordinates) [m/s2, rad/s2]
      real(wp), allocatable :: a(:)
      !> Rates of the `speed` of both signals, mass damping left out; where rotations are small
      real(wp) :: of_speeds(2) = 0.0_wp
      !> Power of the loads [W], where it is found on the way
      real(wp) :: power = 0.0_wp
      logical :: has_power = .false.
      !> Forces of the springs with damping and, with small rotations, the second-order share of the axial
      !> forces (springs) [N, N m, N]
      real(wp), allocatable :: f(:)
      !> Forces on the unknowns, without the inertia of the moving ground and without mass damping (unknowns)
      real(wp), allocatable :: force(:)
      !> Axial forces that do second-order work at the time, in the order of the structure [N]
      real(wp), allocatable :: axial(:)
      !> Work array of the structure (work_size)
      real(wp), allocatable :: work(:)
      !> Parts between the unknowns on the present lines (parts), and changes of the coordinates that bring
      !> them to equilibrium (coordinates, or none)
      type(series_tangent), allocatable :: tangent(:)
      real(wp), allocatable :: correction(:)
      !> Resistance of the springs against deformation from `anchor`, as a share of their initial stiffness,
      !> in the search for one of several states; 0 in equilibrium. Position where it begins
      !> (coordinates, or none)
      real(wp) :: resistance = 0.0_wp
      real(wp), allocatable :: anchor(:)
   contains
      procedure :: create
   end type motion_result

   abstract interface
      !> Changes of the deformations of the springs from those of the unknowns.
      subroutine gather(self, tangent, dx, dd)
         import :: structure_type, series_tangent, wp
         class(structure_type), intent(in) :: self
         !> Parts between the unknowns on the present lines of the springs, see `linearise`
         type(series_tangent), intent(in) :: tangent(:)
         !> (unknowns)
         real(wp), intent(in), contiguous :: dx(:)
         !> (springs)
         real(wp), intent(out), contiguous :: dd(:)
      end subroutine gather

      !> Changes of the unknowns from those of the deformations.
      pure subroutine spread_out(self, dd, dx)
         import :: structure_type, wp
         class(structure_type), intent(in) :: self
         !> (springs)
         real(wp), intent(in), contiguous :: dd(:)
         !> (unknowns)
         real(wp), intent(out), contiguous :: dx(:)
      end subroutine spread_out

      !> Forces on the unknowns: of springs, of loads but for the inertia of the moving ground, and of axial
      !> forces.
      subroutine collect(self, d, load, axial, tangent, f, g, correction, dead)
         import :: structure_type, series_tangent, wp
         class(structure_type), intent(in) :: self
         !> Deformations (springs), signals of the loads (signals), axial forces (those of `axial_forces`, or
         !> none)
         real(wp), intent(in), contiguous :: d(:), load(:), axial(:)
         !> See `linearise`
         type(series_tangent), intent(in) :: tangent(:)
         !> Forces of the springs; those of slips get the second-order share of the axial forces (springs)
         real(wp), intent(inout), contiguous :: f(:)
         !> (unknowns) [N, N m]
         real(wp), intent(out), contiguous :: g(:)
         !> Changes of the deformations that bring the parts between the unknowns to equilibrium (springs, or
         !> none)
         real(wp), intent(inout), contiguous :: correction(:)
         !> Share of the dead load of a frame that acts; without it, all
         real(wp), intent(in), optional :: dead
      end subroutine collect

      !> Axial forces that do second-order work, of the constant loads and of those given.
      subroutine find_axial_forces(self, load, axial)
         import :: structure_type, wp
         class(structure_type), intent(in) :: self
         !> Signals of the loads (signals)
         real(wp), intent(in), contiguous :: load(:)
         !> Compression positive, in the order of the structure [N]
         real(wp), intent(out), contiguous :: axial(:)
      end subroutine find_axial_forces

      !> Add B' diag(k) B of the springs to a lower band, band(1 + i - j, j) = a(i, j).
      subroutine assemble_springs(self, k, tangent, band, columns)
         import :: structure_type, series_tangent, wp
         class(structure_type), intent(in) :: self
         !> Stiffness of the springs, and the tangent of it (see `linearise`)
         real(wp), intent(in), contiguous :: k(:)
         type(series_tangent), intent(in) :: tangent(:)
         !> (half_width + 1, unknowns)
         real(wp), intent(inout), contiguous :: band(:, :)
         !> The columns that are filled, of those of `mark_columns` (unknowns); without it, all
         logical, intent(in), optional, contiguous :: columns(:)
      end subroutine assemble_springs

      !> Add the geometric stiffness of axial forces to a lower band.
      subroutine assemble(self, k, band)
         import :: structure_type, wp
         class(structure_type), intent(in) :: self
         !> Axial forces, as `axial_forces` gives them
         real(wp), intent(in), contiguous :: k(:)
         !> (half_width + 1, unknowns)
         real(wp), intent(inout), contiguous :: band(:, :)
      end subroutine assemble

      !> A number that depends on the position alone.
      pure real(wp) function of_position(self, d)
         import :: structure_type, wp
         class(structure_type), intent(in) :: self
         !> Deformations of the springs (springs)
         real(wp), intent(in), contiguous :: d(:)
      end function of_position

      !> Absolute rotations of the bodies.
      pure subroutine find_rotations(self, d, rotation)
         import :: structure_type, wp
         class(structure_type), intent(in) :: self
         !> Deformations of the springs, or changes of them (springs)
         real(wp), intent(in), contiguous :: d(:)
         !> (n) [rad]
         real(wp), intent(out), contiguous :: rotation(:)
      end subroutine find_rotations

      !> Refuse loads that do nothing.
      subroutine refuse_loads(self, acts, error)
         import :: structure_type, error_type, signals
         class(structure_type), intent(in) :: self
         !> Which loads act (signals)
         logical, intent(in) :: acts(signals)
         !> Set where a load is refused
         type(error_type), allocatable, intent(inout) :: error
      end subroutine refuse_loads

      !> Channels of the rows of a run, besides those of all structures.
      pure subroutine list_channels(self, contents, channel)
         import :: structure_type, row_contents, channel_type
         class(structure_type), intent(in) :: self
         type(row_contents), intent(in) :: contents
         type(channel_type), allocatable, intent(out) :: channel(:)
      end subroutine list_channels

      !> Values of these channels at a time.
      pure subroutine fill_values(self, contents, response, springs, d, row)
         import :: structure_type, row_contents, response_type, spring_array, wp
         class(structure_type), intent(in) :: self
         type(row_contents), intent(in) :: contents
         type(response_type), intent(in) :: response
         type(spring_array), intent(in) :: springs
         !> Deformations of the springs (springs)
         real(wp), intent(in), contiguous :: d(:)
         !> Values of `channels`, one after the other
         real(wp), intent(out), contiguous :: row(:)
      end subroutine fill_values
   end interface

contains

   !> Make room for the forces of a structure, under its axial forces at rest.
   subroutine create(self, structure)
      class(motion_result), intent(out) :: self
      !> The structure that moves
      class(structure_type), intent(in) :: structure
      real(wp) :: at_rest(signals)
      integer :: inside

      inside = merge(structure%coordinates, 0, size(structure%initial_tangent) > 0)
      allocate (self%a(structure%coordinates), self%f(size(structure%location)), &
                self%force(structure%unknowns), self%work(structure%work_size), &
                self%axial(structure%axial_count), &
                self%correction(inside), self%anchor(inside), source=0.0_wp)
      self%tangent = structure%initial_tangent
      at_rest = 0.0_wp
      call structure%axial_forces(at_rest, self%axial)
   end subroutine create

   !> Accelerations of the springs, mass damping included, for explicit steps.
   subroutine accelerate_unknowns(self, d, v, load, pressing, result)
      class(structure_type), intent(in) :: self
      !> Deformations of the springs and their velocities (springs), signals of the loads
      real(wp), intent(in) :: d(self%coordinates), v(self%coordinates), load(signals)
      !> Number of axial forces that do second-order work: all, or none where none does
      integer, intent(in) :: pressing
      !> It has the axial forces, and forces of springs and damping in `f`; it gets forces and accelerations
      type(motion_result), intent(inout) :: result
      real(wp) :: speed(self%unknowns)

      call self%unknown_rates(v, speed)
      associate (x => result%force)
         call self%forces(d, load, result%axial(:pressing), result%tangent, result%f, x, result%correction)
         if (self%damped) call self%damp(speed, result%tangent, x)
         call self%add_ground(load, x)
         where (self%inertias > 0.0_wp .and. .not. self%is_held)
            x = x/self%inertias - self%mass_damping*speed
         else where
            ! Without mass it follows from the motion, not from forces.
            x = 0.0_wp
         end where
         call self%spring_rates(result%tangent, x, result%a)
         result%of_speeds = [self%work_of(lateral, x), self%work_of(horizontal, x)]
      end associate
   end subroutine accelerate_unknowns

   !> Velocity that is conjugate to a load, as to lateral force and acceleration of the ground: velocity of
   !> the top along x [m/s], momentum along x relative to the ground with its sign turned [kg m/s].
   pure real(wp) function speed(self, signal, d, v)
      class(structure_type), intent(in) :: self
      !> Number of the signal, `lateral` to `sideways`
      integer, intent(in) :: signal
      !> Deformations of the springs and their velocities (springs)
      real(wp), intent(in), contiguous :: d(:), v(:)
      ! Asked for in every explicit step of a chain, which allocates nothing.
      real(wp), allocatable :: x(:)

      if (allocated(self%pattern(signal)%arm)) then
         speed = inner_product(size(d), self%pattern(signal)%arm, v)
      else
         allocate (x(self%unknowns))
         call self%unknown_rates(v(:size(d)), x)
         speed = self%work_of(signal, x)
      end if
   end function speed

   !> Power of the loads, constant ones left out [W].
   pure real(wp) function power_of_patterns(self, d, v, load) result(watt)
      class(structure_type), intent(in) :: self
      !> Deformations of the springs and their velocities (springs); signals of the loads (signals)
      real(wp), intent(in), contiguous :: d(:), v(:), load(:)
      integer :: j

      watt = 0.0_wp
      do j = 1, signals
         if (abs(load(j)) > 0.0_wp) watt = watt + load(j)*self%speed(j, d, v)
      end do
   end function power_of_patterns

   !> Energy of a motion relative to the ground [J].
   pure real(wp) function kinetic_energy(self, d, v) result(energy)
      class(structure_type), intent(in) :: self
      !> Deformations of the springs and their velocities (springs); only their number and the latter count
      real(wp), intent(in), contiguous :: d(:), v(:)
      real(wp) :: x(self%unknowns)

      call self%unknown_rates(v(:size(d)), x)
      energy = 0.5_wp*sum(self%inertias*x**2)
   end function kinetic_energy

   !> Largest absolute rotation of a body in deformations, or in a change of them, in size [rad].
   pure real(wp) function largest_rotation(self, d) result(largest)
      class(structure_type), intent(in) :: self
      !> Deformations of the springs, or changes of them (springs)
      real(wp), intent(in), contiguous :: d(:)
      real(wp) :: rotation(self%n)

      call self%rotations(d, rotation)
      largest = maxval(abs(rotation))
   end function largest_rotation

   !> Displacement of the top along x [m].
   pure real(wp) function top_displacement(self, d) result(x)
      class(structure_type), intent(in) :: self
      !> Deformations of the springs (springs)
      real(wp), intent(in), contiguous :: d(:)

      x = inner_product(size(d) - self%before_arm, self%arm(self%before_arm + 1:), d(self%before_arm + 1:))
   end function top_displacement

   !> Drift ratios of the storeys; a structure that is no frame has none.
   pure subroutine storey_drifts(self, d, drift)
      class(structure_type), intent(in) :: self
      !> Deformations of the springs (springs)
      real(wp), intent(in), contiguous :: d(:)
      !> (storeys)
      real(wp), intent(out), contiguous :: drift(:)

      drift = 0.0_wp
   end subroutine storey_drifts

   !> The drift that collapse is judged by, in size: of the storeys, or of the top over the height.
   pure real(wp) function largest_drift(self, d) result(drift)
      class(structure_type), intent(in) :: self
      !> Deformations of the springs (springs)
      real(wp), intent(in), contiguous :: d(:)
      real(wp) :: storey(self%storeys)

      if (self%by_storeys) then
         call self%storey_drifts(d, storey)
         drift = maxval(abs(storey))
      else
         drift = abs(self%top_displacement(d))/self%height
      end if
   end function largest_drift

   !> Acceleration of the top along x, relative to the ground [m/s2].
   pure real(wp) function top_acceleration(self, d, v, a) result(acceleration)
      class(structure_type), intent(in) :: self
      !> Deformations of the springs and their derivatives (springs)
      real(wp), intent(in), contiguous :: d(:), v(:), a(:)

      acceleration = inner_product(size(a), self%arm, a)
   end function top_acceleration

   !> Axial force at a spring under loads, compression positive [N].
   pure real(wp) function axial_force(self, spring, load)
      class(structure_type), intent(in) :: self
      !> Number of the spring; signals of the loads (signals), which some structures add
      integer, intent(in) :: spring
      real(wp), intent(in) :: load(:)

      axial_force = self%constant_axial(spring)
   end function axial_force

   !> Bound of the acceleration of a spring under the present loads and forces [m/s2, rad/s2].
   pure real(wp) function acceleration_scale(self, spring, springs, load) result(scale)
      class(structure_type), intent(in) :: self
      !> Which spring, and all of them
      integer, intent(in) :: spring
      type(spring_array), intent(in) :: springs
      !> Signals of the loads (signals)
      real(wp), intent(in) :: load(:)

      scale = abs(springs%force(spring))/maxval(self%inertias) + abs(load(horizontal))
   end function acceleration_scale

   !> Refuse deformations at the start, or velocities, that the structure cannot have.
   subroutine check_initial(self, name, value, error)
      class(structure_type), intent(in) :: self
      !> For messages
      character(len=*), intent(in) :: name
      !> (springs)
      real(wp), intent(in), contiguous :: value(:)
      type(error_type), allocatable, intent(inout) :: error

      if (allocated(error) .or. size(value) == size(self%location)) return
      call fatal_error(error, bad_input, name//': '//to_text(size(value))//' values for '// &
                       to_text(size(self%location))//' springs; give one for each')
   end subroutine check_initial

   !> Refuse a structure without inertia.
   subroutine check_inertia(self, error)
      class(structure_type), intent(in) :: self
      type(error_type), allocatable, intent(inout) :: error

      if (any(self%inertias > 0.0_wp .and. .not. self%is_held)) return
      call fatal_error(error, bad_input, 'frame: nothing has mass; give &floor mass, or mass to nodes')
   end subroutine check_inertia

   !> Dynamic stiffness before any spring yields, in parts that nothing couples.
   subroutine dynamic_parts(self, axial, part)
      class(structure_type), intent(in) :: self
      !> Whether the constant axial forces count
      logical, intent(in) :: axial
      !> One part here; a chain that opens has two
      class(dynamic_stiffness), allocatable, intent(out) :: part(:)
      real(wp), allocatable :: stiffness(:, :), geometric(:, :)
      real(wp) :: at_rest(signals), force(self%axial_count)

      allocate (stiffness(self%half_width + 1, self%unknowns), source=0.0_wp)
      call self%add_stiffness(self%initial_stiffness, self%initial_tangent, stiffness)
      ! Without signals the constant axial forces are left.
      if (axial) then
         allocate (geometric(self%half_width + 1, self%unknowns), source=0.0_wp)
         at_rest = 0.0_wp
         call self%axial_forces(at_rest, force)
         call self%add_geometric(force, geometric)
      end if
      allocate (dynamic_stiffness :: part(1))
      call part(1)%create(self%inertias, self%is_held, stiffness, geometric)
   end subroutine dynamic_parts

   !> The number by which the constant axial forces must be multiplied to buckle the structure before any
   !> spring yields; `huge` if no multiple does.
   real(wp) function critical_factor(self) result(factor)
      class(structure_type), intent(in) :: self
      class(dynamic_stiffness), allocatable :: part(:)

      factor = huge(1.0_wp)
      if (.not. self%axially_loaded) return
      call self%dynamic_parts(.true., part)
      factor = part(1)%critical_multiple()
   end function critical_factor

   !> Momenta of a shape of vibration, conjugate to its coordinates, which here are the unknowns.
   pure subroutine momenta(self, shape, momentum)
      class(structure_type), intent(in) :: self
      !> (unknowns)
      real(wp), intent(in), contiguous :: shape(:)
      !> (unknowns) [kg m, kg m2 times the unit of the shape]
      real(wp), intent(out), contiguous :: momentum(:)

      momentum = self%inertias*shape
   end subroutine momenta

   !> Note the axial load at the top. In a frame it does no more: its loads are dead loads of the nodes.
   subroutine put_under(self, load)
      class(structure_type), intent(inout) :: self
      !> Compression positive [N]
      real(wp), intent(in) :: load

      self%axial_load = load
   end subroutine put_under

   !> The number of a member that fails in the present state of the springs, 0: none; only frames have any.
   integer function next_failed_member(self, springs, time) result(member)
      class(structure_type), intent(in) :: self
      !> Springs in their present state
      type(spring_array), intent(in) :: springs
      !> [s]; on a static path no member is removed by time
      real(wp), intent(in), optional :: time

      member = 0
   end function next_failed_member

   !> Take away all forces of a member; here there is none to take, as only frames have members that fail.
   subroutine remove_member(self, member, springs)
      class(structure_type), intent(in) :: self
      !> Number of the member; springs, which lose its forces
      integer, intent(in) :: member
      type(spring_array), intent(inout) :: springs
   end subroutine remove_member

   !> Whether a part has fallen beyond the range of small rotations; only frames lose parts.
   pure logical function has_collapsed(self, d)
      class(structure_type), intent(in) :: self
      !> Deformations of the springs (springs)
      real(wp), intent(in), contiguous :: d(:)

      has_collapsed = .false.
   end function has_collapsed

   !> A spring without mass whose deformation is unbounded, as nothing in its part resists it; 0: none.
   pure integer function unbounded_spring(self, d) result(spring)
      class(structure_type), intent(in) :: self
      !> Deformations of the springs (springs)
      real(wp), intent(in), contiguous :: d(:)

      spring = 0
   end function unbounded_spring

   !> Tangent on the present stiffness of the springs; here none, as deformations follow from the unknowns.
   subroutine linearise(self, k, tangent, unstable, shares)
      class(structure_type), intent(in) :: self
      !> Stiffness of the springs (springs)
      real(wp), intent(in), contiguous :: k(:)
      !> One for each part between the unknowns: none here
      type(series_tangent), intent(inout) :: tangent(:)
      !> A part whose springs determine its motion no more; 0: none
      integer, intent(out) :: unstable
      !> Whether springs without stiffness share motions as if they had some, which refinement takes away
      logical, intent(out), optional :: shares

      unstable = 0
      if (present(shares)) shares = .false.
   end subroutine linearise

   !> Mark the columns of the stiffness that have changed since the last call; here all.
   subroutine mark_columns(self, tangent, columns)
      class(structure_type), intent(in) :: self
      !> See `linearise`
      type(series_tangent), intent(inout) :: tangent(:)
      !> (unknowns)
      logical, intent(inout), contiguous :: columns(:)

      columns = .true.
   end subroutine mark_columns

   !> Add forces of the damping of modes or stiffness that is no damping of the springs one by one; here none.
   subroutine damp(self, v, tangent, g)
      class(structure_type), intent(in) :: self
      !> Velocities of the unknowns (unknowns); see `linearise`
      real(wp), intent(in), contiguous :: v(:)
      type(series_tangent), intent(in) :: tangent(:)
      !> (unknowns)
      real(wp), intent(inout), contiguous :: g(:)
   end subroutine damp

   !> Add the derivative of forces of damping by velocity, with its sign turned and times a factor, to a band;
   !> here nothing is added.
   subroutine add_damping(self, factor, tangent, band)
      class(structure_type), intent(in) :: self
      !> Factor; tangent, see `linearise`; lower band (half_width + 1, unknowns)
      real(wp), intent(in) :: factor
      type(series_tangent), intent(in) :: tangent(:)
      real(wp), intent(inout), contiguous :: band(:, :)
   end subroutine add_damping

   !> Sizes of forces and works in parts that have no spring, measures of round-off; here no part is without.
   subroutine size_of_parts(self, springs, d, least, force, terms, work)
      class(structure_type), intent(in) :: self
      type(spring_array), intent(in) :: springs
      !> Position (coordinates)
      real(wp), intent(in), contiguous :: d(:)
      !> Least displacement that counts, in shares of the height
      real(wp), intent(in) :: least
      !> Largest force [N], moments over the height; the largest force [N] and the work [J] if no terms of
      !> different signs cancelled
      real(wp), intent(out) :: force, terms, work

      force = 0.0_wp
      terms = 0.0_wp
      work = 0.0_wp
   end subroutine size_of_parts

   !> Take rates that are round-off of larger ones for zero: a spring at rest on a corner of its curve, as
   !> beside a mechanism, must not be sent either way. Structures that need it override this empty procedure.
   pure subroutine clear_round_off(self, tangent, dx, k, dd)
      class(structure_type), intent(in) :: self
      !> See `linearise`
      type(series_tangent), intent(in) :: tangent(:)
      !> Rates of the unknowns (unknowns); stiffness of the springs (springs)
      real(wp), intent(in), contiguous :: dx(:), k(:)
      !> Rates of the deformations (springs)
      real(wp), intent(inout), contiguous :: dd(:)
   end subroutine clear_round_off

   !> A shape of vibration in the order of the structure, with its sign: the masses move to +x.
   subroutine set_shape(self, part, found, shape)
      class(structure_type), intent(in) :: self
      !> Number of the part of `dynamic_parts` that vibrates
      integer, intent(in) :: part
      !> The shape, in the order of the part
      real(wp), intent(in), contiguous :: found(:)
      !> (unknowns), zero
      real(wp), intent(inout), contiguous :: shape(:)

      shape = sign(1.0_wp, -self%work_of(horizontal, found))*found
   end subroutine set_shape

   !> Work of a dead load that grows on a static path [J]; only frames have one.
   pure real(wp) function work_of_dead_load(self, d) result(work)
      class(structure_type), intent(in) :: self
      !> Deformations of the springs, or changes of them (springs)
      real(wp), intent(in), contiguous :: d(:)

      work = 0.0_wp
   end function work_of_dead_load

   !> The springs without deformation, layered joints under given axial forces.
   subroutine create_springs(self, springs, axial_force)
      class(structure_type), intent(in), target :: self
      !> Virgin springs
      type(spring_array), intent(out) :: springs
      !> Compression positive (springs) [N]
      real(wp), intent(in), contiguous :: axial_force(:)
      integer :: work_source(2, size(axial_force))

      work_source(1, :) = self%location%work_source
      work_source(2, :) = self%location%last_work_source
      call springs%create(self%rules, work_source, axial_force, self%coordinates, self%joints)
   end subroutine create_springs

   !> Add the inertia of the moving ground: all signals but those of forces.
   pure subroutine add_ground(self, load, g)
      class(structure_type), intent(in) :: self
      !> Signals of the loads
      real(wp), intent(in) :: load(signals)
      !> Forces on the unknowns (unknowns)
      real(wp), intent(inout), contiguous :: g(:)
      integer :: i, j

      do j = horizontal, sideways
         if (j == top_axial .or. .not. abs(load(j)) > 0.0_wp) cycle
         associate (pattern => self%pattern(j))
            do i = pattern%first, pattern%last
               g(i) = g(i) + pattern%force(i)*load(j)
            end do
         end associate
      end do
   end subroutine add_ground

   !> Base shear of a structure in which it is not the force of one spring [N]; such structures override this.
   real(wp) function base_force(self, d, f) result(force)
      class(structure_type), intent(in) :: self
      !> Deformations and forces of the springs (springs)
      real(wp), intent(in), contiguous :: d(:), f(:)

      force = 0.0_wp
   end function base_force

   !> Work of a load that keeps its direction, per unit of its signal.
   pure real(wp) function work_of(self, signal, moved) result(work)
      class(structure_type), intent(in) :: self
      !> Number of the signal
      integer, intent(in) :: signal
      !> Displacements of the unknowns (unknowns)
      real(wp), intent(in), contiguous :: moved(:)
      integer :: i

      work = 0.0_wp
      associate (pattern => self%pattern(signal))
         do i = pattern%first, pattern%last
            work = work + pattern%force(i)*moved(i)
         end do
      end associate
   end function work_of

end module rbs_structure_structure
