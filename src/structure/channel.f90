!> Channels of a row: names and units of its values, and the response that they are taken from.
module rbs_structure_channel
   use rbs_base_kinds, only: wp
   implicit none
   private

   public :: channel_type, row_contents, energy_type, response_type

   !> A quantity of a row.
   type :: channel_type
      character(len=21) :: name = ''
      !> SI
      character(len=4) :: unit = ''
      !> Number of values, 0 for one that has no number; the number of the first one
      integer :: count = 0, first = 1
   end type channel_type

   !> Contents of the rows of a run: whether it is an analysis in time, and on demand the openings of layered
   !> joints, and velocity and acceleration of the top.
   type :: row_contents
      logical :: in_time = .false., openings = .false., motion = .false.
   end type row_contents

   !> Energies of a moment [J]: input of lateral force and ground motion; kinetic; in springs; lost to
   !> damping; potential of the axial forces; lost where members snapped; residual of the balance.
   type :: energy_type
      real(wp) :: input = 0.0_wp, kinetic = 0.0_wp, spring = 0.0_wp, damping = 0.0_wp, axial = 0.0_wp, &
                  snaps = 0.0_wp, residual = 0.0_wp
   end type energy_type

   !> The response of a structure at a time, or at a point of a path, without its springs.
   type :: response_type
      !> Time [s] or number of the point; displacement of the top [m]; lateral force [N]
      real(wp) :: time = 0.0_wp, displacement = 0.0_wp, force = 0.0_wp
      type(energy_type) :: energy
      !> In time: acceleration of the ground [m/s2], with damping the force by which the ground holds the
      !> structure along x [N]; velocities of the springs, forces with those of the damping and, where the
      !> rows ask for them, accelerations (springs)
      real(wp) :: ground = 0.0_wp, base_shear = 0.0_wp
      !> Of a building the acceleration of the ground along y [m/s2]
      real(wp) :: ground_y = 0.0_wp
      real(wp), allocatable :: v(:), f(:), a(:)
   end type response_type

end module rbs_structure_channel
