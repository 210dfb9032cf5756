!> Summary of a run: its figures besides the rows.
module rbs_output_summary
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_layered_fibre_fall, only: layer_fall
   use rbs_structure_channel, only: energy_type
   implicit none
   private

   public :: peaks_type, summary_type, figure_type

   !> A figure of a summary, as it is printed and given to Python.
   type :: figure_type
      character(len=26) :: name
      !> SI
      character(len=4) :: unit
      real(wp) :: value
      !> Whether the run has it
      logical :: applies = .true.
   end type figure_type

   !> The largest responses: over all points (static) or all steps (in time), kept or not.
   type :: peaks_type
      !> Largest displacement and force in size, with sign [m, N], and the displacement where the force
      !> is largest [m]; of a static path the force where it has the sign of the displacement
      real(wp) :: peak_displacement = 0.0_wp, peak_force = 0.0_wp, displacement_at_peak = 0.0_wp
      !> Largest shear force at the base in size, with sign [N]; largest absolute rotation of a body, in size
      !> [rad]
      real(wp) :: peak_base_shear = 0.0_wp, peak_rotation = 0.0_wp
      !> Largest absolute acceleration of the top, in size [m/s2]; negative where it is not recorded
      real(wp) :: peak_floor_acceleration = -1.0_wp
      !> Drift ratios of the storeys, the last ones and the largest in size (storeys); not allocated without
      !> storeys
      real(wp), allocatable :: storey_drift(:), peak_storey_drift(:)
   contains
      procedure :: update_peak, update_base_shear
   end type peaks_type

   !> The figures of a run.
   type, extends(peaks_type) :: summary_type
      !> Whether a lateral force acts at the top
      logical :: has_force = .true.
      !> Steps or increments taken, rows kept, lines that springs have left
      integer :: steps = 0, rows = 0, events = 0
      !> Time step and stability limit of the scheme [s]; 0 in a static analysis
      real(wp) :: time_step = 0.0_wp, stable_step = 0.0_wp
      !> Largest acceleration of the ground [m/s2]
      real(wp) :: peak_ground = 0.0_wp
      !> Time [s] or number of the last row kept, and the displacement of the top there [m]
      real(wp) :: last_time = 0.0_wp, last_displacement = 0.0_wp
      !> Energies at the end
      type(energy_type) :: energy
      !> Steps that were cut: at an event, for accuracy, or because they did not converge
      integer :: cut_steps = 0
      !> Snap-backs of a static path, and the energy that a test would release in them, with the displacement
      !> held [J]
      integer :: snap_backs = 0
      real(wp) :: released = 0.0_wp
      !> What springs that turn within leaps of a static path have changed, the sum, as a share of the largest
      !> force, or of the largest displacement under a driven force; below zero without leaps
      real(wp) :: leap_error = -1.0_wp
      !> Whether the analysis ended where the user's criterion of collapse was met
      logical :: collapsed = .false.
      !> Whether it was stopped from outside before its end
      logical :: stopped = .false.
      !> Joint whose layers could not carry the axial load any more, where the analysis ended; 0: none
      integer :: lost_joint = 0
      !> The axial load that it lost and the capacity of its layers at that rotation, compression positive
      !> [N]; how far it falls before it rests, elongation positive [m], and the energy set free [J]
      type(layer_fall) :: fall
      !> Method that was used and, if the program chose it, why
      character(len=20) :: method = ''
      character(len=200) :: reason = ''
      !> Members that snapped or fell, and snap-backs that no test follows
      character(len=400) :: remark = ''
      !> Steps in which members snapped, the member that lost most in one and when [s]; a member that fell; 0:
      !> none
      integer :: snaps = 0, snap_member = 0, fallen_member = 0
      real(wp) :: snap_time = 0.0_wp
      !> Largest residual of the balance, in size, and the largest energy [J]: over all points (static) or
      !> times of the loading (in time)
      real(wp) :: residual = 0.0_wp, largest = 0.0_wp
   contains
      procedure :: update_energies, get_figures, status, has_fallen
   end type summary_type

   !> Forces closer than this share of them are the same peak, as on a plateau, of which the first counts.
   real(wp), parameter :: same_peak = 1.0e-9_wp

contains

   !> Take a displacement and a force into account.
   pure subroutine update_peak(self, displacement, force)
      class(peaks_type), intent(inout) :: self
      !> Of the top [m], lateral [N]
      real(wp), intent(in) :: displacement, force

      if (abs(displacement) > abs(self%peak_displacement)) self%peak_displacement = displacement
      if (abs(force) > (1.0_wp + same_peak)*abs(self%peak_force)) then
         self%peak_force = force
         self%displacement_at_peak = displacement
      end if
   end subroutine update_peak

   !> Take a shear force at the base into account.
   pure subroutine update_base_shear(self, shear)
      class(peaks_type), intent(inout) :: self
      !> [N]
      real(wp), intent(in) :: shear

      if (abs(shear) > (1.0_wp + same_peak)*abs(self%peak_base_shear)) self%peak_base_shear = shear
   end subroutine update_base_shear

   !> Take the energies of a point or a time into account; those of the last one stay.
   pure subroutine update_energies(self, energy)
      class(summary_type), intent(inout) :: self
      type(energy_type), intent(in) :: energy

      self%energy = energy
      self%residual = max(self%residual, abs(energy%residual))
      self%largest = max(self%largest, abs(energy%input), energy%kinetic + energy%spring)
   end subroutine update_energies

   !> The figures that apply to the run, with names and SI units. How far a joint falls that does not rest is
   !> not a number.
   pure subroutine get_figures(self, list)
      class(summary_type), intent(in) :: self
      type(figure_type), allocatable, intent(out) :: list(:)
      real(wp) :: drop, freed
      logical :: crushed, snapped
      logical, allocatable :: applies(:)

      drop = merge(self%fall%drop, ieee_value(drop, ieee_quiet_nan), self%fall%rests)
      freed = merge(self%fall%freed, ieee_value(freed, ieee_quiet_nan), self%fall%rests)
      crushed = self%lost_joint > 0
      snapped = self%snaps > 0
      list = [figure_type('steps', '', real(self%steps, wp)), &
              figure_type('rows', '', real(self%rows, wp)), &
              figure_type('events', '', real(self%events, wp)), &
              figure_type('time_step', 's', self%time_step), &
              figure_type('stable_step', 's', self%stable_step), &
              figure_type('peak_displacement', 'm', self%peak_displacement), &
              figure_type('peak_force', 'N', self%peak_force, self%has_force), &
              figure_type('displacement_at_peak_force', 'm', self%displacement_at_peak, self%has_force), &
              figure_type('peak_base_shear', 'N', self%peak_base_shear), &
              figure_type('input_energy', 'J', self%energy%input), &
              figure_type('spring_energy', 'J', self%energy%spring), &
              figure_type('damping_energy', 'J', self%energy%damping), &
              figure_type('energy_residual', 'J', self%residual), &
              figure_type('relative_energy_residual', '', self%residual/max(self%largest, tiny(1.0_wp))), &
              figure_type('peak_rotation', 'rad', self%peak_rotation), &
              figure_type('peak_floor_acceleration', 'm/s2', self%peak_floor_acceleration, &
                          self%peak_floor_acceleration >= 0.0_wp), &
              figure_type('leap_error', '', self%leap_error, self%leap_error >= 0.0_wp), &
              figure_type('cut_steps', '', real(self%cut_steps, wp)), &
              figure_type('snaps', '', real(self%snaps, wp), snapped), &
              figure_type('snap_energy', 'J', self%energy%snaps, snapped), &
              figure_type('snap_member', '', real(self%snap_member, wp), snapped), &
              figure_type('snap_time', 's', self%snap_time, snapped), &
              figure_type('fallen_member', '', real(self%fallen_member, wp), self%fallen_member > 0), &
              figure_type('snap_backs', '', real(self%snap_backs, wp), self%snap_backs > 0), &
              figure_type('released_energy', 'J', self%released, self%snap_backs > 0), &
              figure_type('lost_joint', '', real(self%lost_joint, wp), crushed), &
              figure_type('lost_axial_load', 'N', self%fall%axial_load, crushed), &
              figure_type('axial_capacity', 'N', self%fall%capacity, crushed), &
              figure_type('fall', 'm', drop, crushed), figure_type('fall_energy', 'J', freed, crushed)]
      applies = list%applies
      list = pack(list, applies)
   end subroutine get_figures

   !> Whether a joint of layers or a member has lost its axial load, so that no state follows, static or in
   !> time; a fall that met the criterion of collapse counts as collapse.
   pure logical function has_fallen(self)
      class(summary_type), intent(in) :: self

      has_fallen = self%lost_joint > 0 .or. (self%fallen_member > 0 .and. .not. self%collapsed)
   end function has_fallen

   !> How the run ended, if nothing failed: the last of these that applies.
   pure character(len=13) function status(self)
      class(summary_type), intent(in) :: self

      status = 'completed'
      if (self%stopped) status = 'stopped'
      if (self%collapsed) status = 'collapsed'
      if (self%has_fallen()) status = 'axial_failure'
   end function status

end module rbs_output_summary
