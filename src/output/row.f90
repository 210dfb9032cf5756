!> What one kept row holds, in this order; the same for the csv and for Python.
module rbs_output_row
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_base_units, only: unit_system
   implicit none
   private

   public :: row_size, row_labels, row_quantities
   public :: row_time, row_displacement, row_force, row_input, row_kinetic, row_spring, row_damping
   public :: row_axial, row_residual, row_top, row_joints

   !> Time [s] (static: number of the row), displacement of the top [m], lateral force at the top [N].
   integer, parameter :: row_time = 1, row_displacement = 2, row_force = 3
   !> Energies [J]: work of lateral force and ground motion; motion; springs; damping; potential of the
   !> axial forces; what is left of the balance.
   integer, parameter :: row_input = 4, row_kinetic = 5, row_spring = 6, row_damping = 7
   integer, parameter :: row_axial = 8, row_residual = 9
   !> Height of the top above the ground [m].
   integer, parameter :: row_top = 10
   !> From here n slips [m], n relative rotations [rad] and, where the joints open, n openings [m]; then in
   !> the same order n shear forces [N], n moments [N m] and n axial forces [N].
   integer, parameter :: row_joints = 11

   !> Where the column is damped in an analysis in time, the row ends with shear and moment at the base
   !> [N, N m]. Else those are the forces of the lowest joint.

   !> On demand the row of an analysis in time then has velocity and acceleration of the top relative to the
   !> ground, and acceleration of the ground [m/s, m/s2, m/s2].

   !> On demand the row then has n openings of layered joints at the middle of their sections [m], and the n
   !> rotations at which they rest under their first axial load [rad].

   !> One value of a row, or one for each joint, with its SI unit.
   type :: quantity_type
      character(len=19) :: name
      character(len=4) :: unit
   end type quantity_type

   type(quantity_type), parameter :: fixed(row_joints - 1) = [ &
      quantity_type('time', 's'), quantity_type('displacement', 'm'), quantity_type('force', 'N'), &
      quantity_type('input', 'J'), quantity_type('kinetic', 'J'), quantity_type('spring', 'J'), &
      quantity_type('damping', 'J'), quantity_type('axial', 'J'), quantity_type('residual', 'J'), &
      quantity_type('top_height', 'm')]

   !> For each joint: deformations, then forces; those of openings come last of each.
   type(quantity_type), parameter :: of_joints(6) = [ &
      quantity_type('slip', 'm'), quantity_type('rotation', 'rad'), quantity_type('opening', 'm'), &
      quantity_type('shear', 'N'), quantity_type('moment', 'N m'), quantity_type('axial_force', 'N')]

   type(quantity_type), parameter :: of_base(2) = [ &
      quantity_type('base_shear', 'N'), quantity_type('base_moment', 'N m')]

   type(quantity_type), parameter :: of_motion(3) = [ &
      quantity_type('velocity', 'm/s'), quantity_type('acceleration', 'm/s2'), &
      quantity_type('ground_acceleration', 'm/s2')]

   type(quantity_type), parameter :: of_layers(2) = [ &
      quantity_type('opening', 'm'), quantity_type('rest', 'rad')]

contains

   !> Number of values in a row of a column.
   pure integer function row_size(unknowns, with_base, layered, with_motion)
      !> Number of its joint deformations
      integer, intent(in) :: unknowns
      !> Whether the row ends with the forces at the base; without it, it does not
      logical, intent(in), optional :: with_base
      !> Number of joints whose openings are kept too; without it none
      integer, intent(in), optional :: layered
      !> Whether the row holds how the top moves; without it, it does not
      logical, intent(in), optional :: with_motion

      row_size = row_joints - 1 + 2*unknowns
      if (present(with_base)) row_size = row_size + merge(size(of_base), 0, with_base)
      if (present(layered)) row_size = row_size + size(of_layers)*layered
      if (present(with_motion)) row_size = row_size + merge(size(of_motion), 0, with_motion)
   end function row_size

   !> Names of the quantities in their order, separated by blanks; an asterisk marks one value a joint.
   pure function row_quantities(opens, with_base, with_openings, with_motion) result(names)
      !> Whether the joints open, whether the row has the forces at the base, and whether it has the openings
      !> of layered joints and the motion of the top
      logical, intent(in) :: opens, with_base, with_openings, with_motion
      character(len=512) :: names
      integer :: i

      names = fixed(1)%name
      do i = 2, size(fixed)
         names = trim(names)//' '//fixed(i)%name
      end do
      do i = 1, size(of_joints)
         if (.not. opens .and. mod(i, 3) == 0) cycle
         names = trim(names)//' '//trim(of_joints(i)%name)//'*'
      end do
      do i = 1, merge(size(of_base), 0, with_base)
         names = trim(names)//' '//of_base(i)%name
      end do
      do i = 1, merge(size(of_motion), 0, with_motion)
         names = trim(names)//' '//of_motion(i)%name
      end do
      do i = 1, merge(size(of_layers), 0, with_openings)
         names = trim(names)//' '//trim(of_layers(i)%name)//'*'
      end do
   end function row_quantities

   !> Names of the values with their units, and the SI units themselves.
   subroutine row_labels(n, opens, dynamic, with_base, with_openings, units, labels, si, first, with_motion)
      !> Number of joints
      integer, intent(in) :: n
      !> Whether the joints open, whether the first value is a time, and whether the row has the forces at the
      !> base and the openings of layered joints
      logical, intent(in) :: opens, dynamic, with_base, with_openings
      !> Units of the labels
      type(unit_system), intent(in) :: units
      !> (values of a row)
      character(len=32), allocatable, intent(out) :: labels(:)
      character(len=4), allocatable, intent(out) :: si(:)
      !> Number by which the lowest joint is known; without it 1
      integer, intent(in), optional :: first
      !> Whether the row holds how the top moves; without it, it does not
      logical, intent(in), optional :: with_motion
      integer :: i, j, at, lowest
      logical :: moves

      lowest = 1
      if (present(first)) lowest = first
      moves = .false.
      if (present(with_motion)) moves = with_motion
      at = row_size(merge(3, 2, opens)*n, with_base, merge(n, 0, with_openings), moves)
      allocate (labels(at), si(at))
      do i = 1, size(fixed)
         labels(i) = trim(fixed(i)%name)//'_'//compact(units%name_of(fixed(i)%unit))
         si(i) = fixed(i)%unit
      end do
      if (.not. dynamic) labels(row_time) = 'step'
      at = size(fixed)
      do j = 1, size(of_joints)
         if (.not. opens .and. mod(j, 3) == 0) cycle
         call label_joints(of_joints(j))
      end do
      do i = 1, merge(size(of_base), 0, with_base)
         at = at + 1
         labels(at) = trim(of_base(i)%name)//'_'//compact(units%name_of(of_base(i)%unit))
         si(at) = of_base(i)%unit
      end do
      do i = 1, merge(size(of_motion), 0, moves)
         at = at + 1
         labels(at) = trim(of_motion(i)%name)//'_'//compact(units%name_of(of_motion(i)%unit))
         si(at) = of_motion(i)%unit
      end do
      do j = 1, merge(size(of_layers), 0, with_openings)
         call label_joints(of_layers(j))
      end do

   contains

      subroutine label_joints(quantity)
         type(quantity_type), intent(in) :: quantity
         integer :: joint

         do joint = 1, n
            at = at + 1
            labels(at) = trim(quantity%name)//'_'//to_text(lowest + joint - 1)//'_'// &
                         compact(units%name_of(quantity%unit))
            si(at) = quantity%unit
         end do
      end subroutine label_joints

   end subroutine row_labels

   !> A unit without blanks, as it stands in a label: 'Nm'.
   pure function compact(unit) result(text)
      character(len=*), intent(in) :: unit
      character(len=len(unit)) :: text
      integer :: i

      text = ''
      do i = 1, len_trim(unit)
         if (unit(i:i) /= ' ') text = trim(text)//unit(i:i)
      end do
   end function compact

end module rbs_output_row
