!> Bodies and joints of a chain with exact rotations over a step in time, in absolute coordinates of the
!> centroids (x, y, th): where the step starts, the deformations of the joints that follow from what the
!> bodies have moved, and the velocities of the joints.
module rbs_solve_time_finite_chain
   use rbs_base_kinds, only: wp
   use rbs_structure_column_column, only: column_type
   use rbs_structure_column_finite, only: finite_chain_type
   use rbs_solve_time_finite_joint, only: turned_body, turn_body, body_at, joint_type, joint_change, &
                                          joint_at, joint_rates
   use rbs_solve_time_state, only: state_type
   use rbs_structure_spring_place, only: flexure, axial
   implicit none
   private

   public :: finite_chain

   type :: finite_chain
      class(finite_chain_type), pointer :: column => null()
      !> What the bodies have moved in the step (3, n)
      real(wp), allocatable :: moved(:, :)
      !> How far joints that must not open have opened (n)
      real(wp), allocatable :: gap(:)
      !> Deformations at the end of the step and their change, and velocities of the joints (unknowns)
      real(wp), allocatable :: q1(:), change(:), w1(:)
      !> Velocities of the bodies at the start of the step and at its end (3, n)
      real(wp), allocatable :: v0(:, :), v1(:, :)
      !> Rotations at the start of the step (n)
      real(wp), allocatable :: from(:)
      !> The bodies over the step, and as the forces see them; body 0 is the ground
      type(turned_body), allocatable :: turned(:), seen(:)
      type(joint_type), allocatable :: joint(:)
   contains
      procedure :: make_chain
      procedure :: place
      procedure :: body_velocities
      procedure :: go
      procedure :: see_end
   end type finite_chain

contains

   !> Allocate for a column.
   subroutine make_chain(self, column)
      class(finite_chain), intent(inout) :: self
      class(finite_chain_type), intent(in), target :: column
      integer :: i, m, n

      self%column => column
      n = column%n
      m = column%unknowns
      allocate (self%moved(3, n), self%v0(3, n), self%v1(3, n), source=0.0_wp)
      allocate (self%gap(n), self%from(n), self%q1(m), self%change(m), self%w1(m), source=0.0_wp)
      allocate (self%turned(0:n), self%seen(0:n), self%joint(n))
      do i = 1, n
         self%joint(i)%above = column%lower(i)
         if (i > 1) self%joint(i)%below = column%upper(i - 1)
      end do
      if (.not. column%held) return
      ! The last joint turned about: it reaches from the held top to the top of the body below.
      self%joint(n)%above = -column%upper(n - 1)
      self%joint(n)%below = 0.0_wp
   end subroutine make_chain

   !> Where the step starts.
   subroutine place(self, state)
      class(finite_chain), intent(inout) :: self
      type(state_type), intent(in) :: state
      real(wp) :: rotation
      integer :: i, n

      n = self%column%n
      associate (at => self%column%at)
         rotation = 0.0_wp
         do i = 1, n
            rotation = rotation + state%q(at(flexure, i))
            self%from(i) = rotation
         end do
         self%moved = 0.0_wp
         self%q1 = state%q
         self%change = 0.0_wp
      end associate
   end subroutine place

   !> Velocities of the centroids from those of the joints.
   subroutine body_velocities(self, state)
      class(finite_chain), intent(inout) :: self
      type(state_type), intent(in) :: state
      type(turned_body) :: below, body
      real(wp) :: top(2), spin, spin_below, opening, opens
      integer :: i, n

      n = self%column%n
      associate (at => self%column%at)
         top = 0.0_wp
         spin = 0.0_wp
         opening = 0.0_wp
         opens = 0.0_wp
         do i = 1, n
            spin_below = spin
            spin = spin + state%v(at(flexure, i))
            if (self%column%opens) then
               opening = state%q(at(axial, i))
               opens = state%v(at(axial, i))
            end if
            call body_at(self%from(i), body)
            if (i == n .and. self%column%held) then
               below = body
               spin_below = 0.0_wp
            end if
            top = top + (state%v(i) + opening*spin_below)*below%t1 + (opens - state%q(i)*spin_below)*below%e1
            top = top + (self%column%lower(i)*spin)*body%t1
            self%v0(:, i) = [top(1), top(2), spin]
            top = top + (self%column%upper(i)*spin)*body%t1
            below = body
         end do
      end associate
   end subroutine body_velocities

   !> The deformations that follow from what the bodies have moved.
   subroutine go(self, state)
      class(finite_chain), intent(inout) :: self
      type(state_type), intent(in) :: state
      type(turned_body) :: body
      real(wp) :: moved_below(3), change(2), opening
      integer :: i, n

      n = self%column%n
      associate (at => self%column%at)
         moved_below = 0.0_wp
         opening = 0.0_wp
         do i = 1, n
            call turn_body(self%from(i), self%moved(3, i), self%turned(i))
            if (i > 1) then
               call body_at(self%from(i - 1), body)
            else
               body = self%turned(0)
            end if
            if (self%column%opens) opening = state%q(at(axial, i))
            if (i == n .and. self%column%held) then
               call body_at(self%from(n), body)
               call joint_at(body, -state%q(n), -opening, self%joint(n))
               call joint_change(self%turned(n), self%turned(n - 1), self%moved(:, n), moved_below, &
                                 self%joint(n), change)
               change = -change
            else
               call joint_at(body, state%q(i), opening, self%joint(i))
               call joint_change(self%turned(i - 1), self%turned(i), moved_below, self%moved(:, i), &
                                 self%joint(i), change)
            end if
            self%change(i) = change(1)
            self%change(at(flexure, i)) = self%moved(3, i) - moved_below(3)
            if (self%column%opens) then
               self%change(at(axial, i)) = change(2)
            else
               self%gap(i) = change(2)
            end if
            moved_below = self%moved(:, i)
         end do
         self%q1(:) = state%q + self%change
      end associate
   end subroutine go

   !> Bodies and joints at the end of the step, and the velocities of the joints.
   subroutine see_end(self, column, q)
      class(finite_chain), intent(inout) :: self
      class(column_type), intent(in) :: column
      real(wp), intent(in), contiguous :: q(:)
      real(wp) :: rotation, opening, rates(2), below(3)
      integer :: i, n

      n = column%n
      associate (at => column%at)
         rotation = 0.0_wp
         opening = 0.0_wp
         below = 0.0_wp
         call body_at(0.0_wp, self%seen(0))
         do i = 1, n
            rotation = rotation + q(at(flexure, i))
            call body_at(rotation, self%seen(i))
            if (column%opens) opening = q(at(axial, i))
            if (i == n .and. column%held) then
               call joint_at(self%seen(n), -q(n), -opening, self%joint(n))
               call joint_rates(self%seen(n), self%seen(n - 1), self%v1(:, n), below, self%joint(n), rates)
               rates = -rates
            else
               call joint_at(self%seen(i - 1), q(i), opening, self%joint(i))
               call joint_rates(self%seen(i - 1), self%seen(i), below, self%v1(:, i), self%joint(i), rates)
            end if
            self%w1(i) = rates(1)
            self%w1(at(flexure, i)) = self%v1(3, i) - below(3)
            if (column%opens) self%w1(at(axial, i)) = rates(2)
            below = self%v1(:, i)
         end do
      end associate
   end subroutine see_end

end module rbs_solve_time_finite_chain
