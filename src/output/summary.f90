!> What is reported of a run besides its rows.
module rbs_output_summary
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_layered_fibre_fall, only: layer_fall
   use rbs_output_channels, only: energy_type
   implicit none
   private

   public :: peaks_type, summary_type, summary_size, summary_names, summary_units, figure_names

   integer, parameter :: summary_size = 23

   !> Names of the figures of `as_array`, and their SI units.
   character(len=26), parameter :: summary_names(summary_size) = [character(len=26) :: &
      'steps', 'rows', 'events', 'time_step', 'stable_step', 'peak_displacement', 'peak_force', &
      'displacement_at_peak_force', 'peak_base_shear', 'input_energy', 'spring_energy', 'damping_energy', &
      'energy_residual', 'relative_energy_residual', 'peak_rotation', 'peak_floor_acceleration', &
      'cut_steps', 'collapsed', &
      'lost_joint', 'lost_axial_load', 'axial_capacity', 'fall', 'fall_energy']
   character(len=4), parameter :: summary_units(summary_size) = [character(len=4) :: &
      '', '', '', 's', 's', 'm', 'N', 'm', 'N', 'J', 'J', 'J', 'J', '', 'rad', 'm/s2', '', '', &
                                                             '', 'N', 'N', 'm', 'J']

   !> The largest responses: over all points (static) or all steps (in time), kept or not.
   type :: peaks_type
      !> Largest displacement and force in size, with sign [m, N], and the displacement where the force
      !> is largest [m]; of a static path the force where it has the sign of the displacement
      real(wp) :: peak_displacement = 0.0_wp, peak_force = 0.0_wp, displacement_at_peak = 0.0_wp
      !> Largest shear force at the base in size, with sign [N]
      real(wp) :: peak_base_shear = 0.0_wp
      !> Largest absolute rotation of a body, in size [rad]
      real(wp) :: peak_rotation = 0.0_wp
      !> Largest absolute acceleration of the top, in size [m/s2]; negative where it is not looked at
      real(wp) :: peak_floor_acceleration = -1.0_wp
   contains
      procedure :: see_peak
      procedure :: see_turn
      procedure :: see_base
      procedure :: see_floor
   end type peaks_type

   type, extends(peaks_type) :: summary_type
      !> Steps or increments taken, rows kept, lines that springs have left
      integer :: steps = 0, rows = 0, events = 0
      !> Time step and stability limit of the scheme [s]; 0 in a static analysis
      real(wp) :: time_step = 0.0_wp, stable_step = 0.0_wp
      !> Time [s] or number of the last row kept, and the displacement of the top there [m]
      real(wp) :: last_time = 0.0_wp, last_displacement = 0.0_wp
      !> Energies at the end
      type(energy_type) :: energy
      !> Steps that were cut: at an event, for accuracy, or because they did not converge
      integer :: cut_steps = 0
      !> Whether the analysis ended where the user's criterion of collapse was met
      logical :: collapsed = .false.
      !> Joint whose layers could not carry the axial load any more, where the analysis ended; 0: none
      integer :: lost_joint = 0
      !> The axial load that it lost and what its layers can carry at that rotation, compression positive [N];
      !> how far it falls before it rests, elongation positive [m], and the energy set free [J]
      type(layer_fall) :: fall
      !> Method that was used and, if the program chose it, why
      character(len=20) :: method = ''
      character(len=200) :: reason = ''
      !> Largest residual of the balance, in size, and the largest energy [J]: over all points (static) or
      !> times of the loading (in time)
      real(wp) :: residual = 0.0_wp, largest = 0.0_wp
   contains
      procedure :: see_energies
      procedure :: as_array
   end type summary_type

contains

   !> Take a displacement and a force into account.
   pure subroutine see_peak(self, displacement, force)
      class(peaks_type), intent(inout) :: self
      !> Of the top [m], lateral [N]
      real(wp), intent(in) :: displacement, force

      if (abs(displacement) > abs(self%peak_displacement)) self%peak_displacement = displacement
      if (abs(force) > abs(self%peak_force)) then
         self%peak_force = force
         self%displacement_at_peak = displacement
      end if
   end subroutine see_peak

   !> Take the largest rotation of a body into account.
   pure subroutine see_turn(self, rotation)
      class(peaks_type), intent(inout) :: self
      !> In size [rad]
      real(wp), intent(in) :: rotation

      self%peak_rotation = max(self%peak_rotation, rotation)
   end subroutine see_turn

   !> Take a shear force at the base into account.
   pure subroutine see_base(self, shear)
      class(peaks_type), intent(inout) :: self
      !> [N]
      real(wp), intent(in) :: shear

      if (abs(shear) > abs(self%peak_base_shear)) self%peak_base_shear = shear
   end subroutine see_base

   !> Take an absolute acceleration of the top into account.
   pure subroutine see_floor(self, acceleration)
      class(peaks_type), intent(inout) :: self
      !> [m/s2]
      real(wp), intent(in) :: acceleration

      self%peak_floor_acceleration = max(self%peak_floor_acceleration, abs(acceleration))
   end subroutine see_floor

   !> Take the energies of a moment into account; those of the last one stay.
   pure subroutine see_energies(self, energy)
      class(summary_type), intent(inout) :: self
      type(energy_type), intent(in) :: energy

      self%energy = energy
      self%residual = max(self%residual, abs(energy%residual))
      self%largest = max(self%largest, abs(energy%input), energy%kinetic + energy%spring)
   end subroutine see_energies

   !> The figures in the order of `summary_names`.
   pure function as_array(self) result(values)
      class(summary_type), intent(in) :: self
      real(wp) :: values(summary_size)

      values = [real(self%steps, wp), real(self%rows, wp), real(self%events, wp), self%time_step, &
                self%stable_step, self%peak_displacement, self%peak_force, self%displacement_at_peak, &
                self%peak_base_shear, self%energy%input, self%energy%spring, self%energy%damping, self%residual, &
                self%residual/max(self%largest, tiny(1.0_wp)), self%peak_rotation, &
                self%peak_floor_acceleration, real(self%cut_steps, wp), &
                merge(1.0_wp, 0.0_wp, self%collapsed), real(self%lost_joint, wp), self%fall%axial_load, &
                self%fall%capacity, self%fall%drop, self%fall%freed]
      associate (floor => values(findloc(summary_names, 'peak_floor_acceleration', dim=1)))
         if (floor < 0.0_wp) floor = ieee_value(floor, ieee_quiet_nan)
      end associate
      if (.not. self%fall%rests) values(summary_size - 1:) = ieee_value(1.0_wp, ieee_quiet_nan)
   end function as_array

   !> Names of the figures in their order, separated by blanks.
   pure function figure_names() result(names)
      character(len=512) :: names
      integer :: i

      names = summary_names(1)
      do i = 2, summary_size
         names = trim(names)//' '//summary_names(i)
      end do
   end function figure_names

end module rbs_output_summary
