!> Equilibrium under an axial load that varies, with exact rotations: loads and tangent of
!> `rbs_column_dead_loads`, in absolute rotations joint by joint.
!>
!> Layered joints and their neighbours carry the axial load of the straight column, N plus the weight above
!> them, as they do in time.
module rbs_solve_static_pressed_finite
   use rbs_base_kinds, only: wp
   use rbs_column_column, only: column_type
   use rbs_column_dead_loads, only: per_joint, dead_loads, add_springs, to_joints
   use rbs_hysteresis_springs, only: spring_array
   use rbs_solve_static_pressed_balance, only: pressed_balance, pressed_point, hold
   implicit none
   private

   public :: pressed_finite

   type, extends(pressed_balance) :: pressed_finite
      !> The column under an axial load of one alone, and under the present one
      type(column_type), private :: unit, loaded
      !> Axial forces of the weight (n) [N]
      real(wp), allocatable, private :: weight_body(:), weight_joint(:)
      !> Bands of the present loads, of a load of one, and of nothing (per joint + 1, unknowns)
      real(wp), allocatable, private :: band(:, :), unused(:, :)
   contains
      procedure :: create
      procedure :: assemble
      procedure :: hold_top
      procedure :: to_deformations
      procedure :: is_moment
   end type pressed_finite

contains

   subroutine create(self, column, by_force)
      class(pressed_finite), intent(inout) :: self
      type(column_type), intent(in) :: column
      logical, intent(in) :: by_force

      self%column = column
      self%by_force = by_force
      self%straight = .false.
      self%ratio = column%axial_force_ratio
      self%weight_above = column%compression - column%axial_load
      self%weight_body = column%axial_body - column%axial_lever*column%axial_load
      self%weight_joint = column%axial_joint - column%axial_lever*column%axial_load
      self%unit = column
      self%unit%axial_body = column%axial_lever
      self%unit%axial_joint = column%axial_lever
      self%loaded = column
      allocate (self%band(per_joint(column) + 1, column%unknowns), &
                self%unused(per_joint(column) + 1, column%unknowns), source=0.0_wp)
   end subroutine create

   subroutine assemble(self, springs, point, tangent, missing, arm, pushed, axial, displacement)
      class(pressed_finite), intent(inout) :: self
      type(spring_array), intent(in) :: springs
      type(pressed_point), intent(in) :: point
      real(wp), intent(out) :: tangent(:, :)
      real(wp), intent(out) :: missing(:), arm(:), pushed(:), axial(:)
      real(wp), intent(out) :: displacement
      real(wp) :: f(size(missing)), centre(size(missing)), top
      integer :: i, j

      top = self%top_load(point)
      self%loaded%axial_body = self%weight_body + top*self%unit%axial_body
      self%loaded%axial_joint = self%weight_joint + top*self%unit%axial_joint
      call dead_loads(self%unit, point%q, 0.0_wp, pushed, arm, self%unused, displacement)
      call dead_loads(self%loaded, point%q, 0.0_wp, axial, arm, self%unused, displacement)
      call dead_loads(self%loaded, point%q, point%force, missing, arm, self%band, displacement)
      call self%plane_forces(springs, point, f, centre)
      call add_springs(self%column, f, springs%k, missing, self%band)
      ! The axial load takes e dN from the moments of layered joints.
      f = 0.0_wp
      call add_springs(self%column, -centre, f, pushed, self%unused)
      tangent = 0.0_wp
      do j = 1, size(missing)
         do i = j, min(j + size(self%band, 1) - 1, size(missing))
            tangent(i, j) = self%band(1 + i - j, j)
            tangent(j, i) = tangent(i, j)
         end do
      end do
   end subroutine assemble

   !> The rotation of a held top is the last unknown.
   pure subroutine hold_top(self, tangent, missing, pushed, axial)
      class(pressed_finite), intent(in) :: self
      real(wp), intent(inout) :: tangent(:, :)
      real(wp), intent(inout) :: missing(:), pushed(:), axial(:)

      call hold(self%column%unknowns, tangent, missing, pushed, axial)
   end subroutine hold_top

   pure logical function is_moment(self, i)
      class(pressed_finite), intent(in) :: self
      integer, intent(in) :: i

      is_moment = modulo(i, per_joint(self%column)) == 0
   end function is_moment

   pure subroutine to_deformations(self, z, q)
      class(pressed_finite), intent(in) :: self
      real(wp), intent(in), contiguous :: z(:)
      real(wp), intent(out), contiguous :: q(:)

      call to_joints(self%column, per_joint(self%column), z, q)
   end subroutine to_deformations

end module rbs_solve_static_pressed_finite
