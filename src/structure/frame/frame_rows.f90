!> Rows of results of a frame: its channels and their values.
submodule (rbs_structure_frame_frame) rbs_structure_frame_frame_rows
   use rbs_structure_frame_element_balance, only: chord_rotation
   use rbs_structure_spring_location, only: shear, axial
   implicit none

contains

   !> Channels of a frame in a row, from `frame_channel` and `plan_channel`: those that the run asks for and
   !> the frame has.
   module procedure channels
      !> Whether a channel is kept, by its place in `frame_channel`
      logical :: held(size(frame_channel))
      integer :: kind, m

      m = self%members
      held = .true.
      held(14:15) = contents%motion
      held(16) = self%may_lose
      channel = frame_channel
      channel(2:4)%count = self%n
      channel(5:7)%count = m
      ! Of the kinds shear, flexure and axial: deformations, then forces
      do kind = 1, 3
         held(6 + 2*kind:7 + 2*kind) = size(self%listed(kind)%spring) > 0
         channel(6 + 2*kind:7 + 2*kind)%count = size(self%listed(kind)%spring)
      end do
      channel(14)%count = self%n
      channel(16)%count = m
      channel = pack(channel, held)
      if (.not. self%plan%is_given()) return
      associate (of_plan => plan_channel)
         channel = [channel, of_plan(:merge(5, 4, contents%motion))]
      end associate
      associate (first => findloc(channel%name, plan_channel(1)%name, dim=1))
         channel(first:first + 2)%count = self%storeys
         channel(first + 3)%count = self%plan%planes()
      end associate
   end procedure channels

   !> Fill a row with the values of `channels`, one after the other, from deformations and unknowns d.
   module procedure fill_row
      real(wp) :: f(self%springs), s(3)
      integer :: at, i, j, kind, m

      f = springs%forces(d)
      ! Held displacements stay zero.
      row(1:3*self%n + 1) = 0.0_wp
      do i = 1, self%n
         row(1 + i) = self%along_x(i, d(self%springs + 1:))
         do j = 2, 3
            ! Place among the unknowns, 0 if it is held
            associate (at => self%number(j, i))
               if (at > 0) row(1 + (j - 1)*self%n + i) = d(self%springs + at)
            end associate
         end do
      end do
      ! Place of the last value that is filled
      at = 1 + 3*self%n
      m = self%members
      do i = 1, m
         call self%member_forces(i, d, f, s)
         ! Compression is positive, as everywhere.
         row(at + i) = -s(1)
         row(at + m + i) = s(2)
         row(at + 2*m + i) = s(3)
         row(1) = row(1) + support_force(self, i, d, s)
      end do
      ! In its second plane a column has the axial force of the first, whose member may come later.
      if (self%plan%is_given()) then
         do i = 1, m
            if (self%axial_of(i) > 0) row(at + i) = row(at + self%axial_of(i))
         end do
      end if
      ! The base shear: supports of members and springs from the ground or, of a building, along the load
      row(1) = row(1) + ground_force(self, f)
      if (self%plan%is_given()) row(1) = self%base_force(d, f)
      if (contents%in_time .and. self%damped) row(1) = response%base_shear
      at = at + 3*m
      do kind = 1, 3
         associate (of => self%listed(kind)%spring)
            do j = 1, size(of)
               call spring_response(self, kind, of(j), d, f, row(at + j), row(at + size(of) + j))
            end do
            at = at + 2*size(of)
         end associate
      end do
      if (contents%motion) then
         row(at + 1:at + self%n) = 0.0_wp
         do i = 1, self%n
            row(at + i) = self%along_x(i, response%a(self%springs + 1:))
         end do
         at = at + self%n + 1
         row(at) = response%ground
      end if
      if (self%may_lose) then
         do i = 1, m
            row(at + i) = merge(1.0_wp, 0.0_wp, self%is_removed(i, springs))
         end do
         at = at + m
      end if
      if (self%plan%is_given()) call fill_plan(self, contents, response, d, f, row(at + 1:))
   end procedure fill_row

   !> Values of the channels of a building: motions of its floors, forces of its planes.
   pure subroutine fill_plan(self, contents, response, d, f, row)
      type(frame_type), intent(in) :: self
      type(row_contents), intent(in) :: contents
      type(response_type), intent(in) :: response
      !> Deformations of the springs and unknowns; forces of the springs
      real(wp), intent(in), contiguous :: d(:), f(:)
      !> Values of `plan_channel`
      real(wp), intent(out) :: row(:)
      real(wp) :: moved(3)
      integer :: floor

      associate (n => self%storeys, planes => self%plan%planes())
         do floor = 1, n
            moved = self%plan%motion(floor, d(self%springs + 1:))
            row([floor, n + floor, 2*n + floor]) = moved
         end do
         row(3*n + 1:3*n + planes) = plane_forces(self, d, f)
         if (contents%motion) row(3*n + planes + 1) = response%ground_y
      end associate
   end subroutine fill_plan

   !> Forces along x of the supports and of the springs from the ground in each plane [N].
   pure function plane_forces(self, d, f) result(force)
      type(frame_type), intent(in) :: self
      !> Deformations of the springs and unknowns; forces of the springs
      real(wp), intent(in), contiguous :: d(:), f(:)
      real(wp) :: force(self%plan%planes()), s(3)
      integer :: i

      force = 0.0_wp
      do i = 1, self%members
         associate (e => self%element(i), plane => self%plane(self%element(i)%node(1)))
            ! Neither end is held.
            if (all(self%number(1, e%node) > 0)) cycle
            call self%member_forces(i, d, f, s)
            force(plane) = force(plane) + support_force(self, i, d, s)
         end associate
      end do
      do i = self%member_springs + 1, self%springs
         if (self%location(i)%kind /= shear) cycle
         associate (plane => self%plane(self%location(i)%index))
            force(plane) = force(plane) + f(i)
         end associate
      end do
   end function plane_forces

   !> Deformation and force of a spring; of a joint of layers rotation and moment, or opening and axial force.
   pure subroutine spring_response(self, kind, spring, d, f, deformation, force)
      type(frame_type), intent(in) :: self
      !> Kind of response (shear, flexure or axial), and number of the spring; of a joint of layers its first
      !> layer
      integer, intent(in) :: kind, spring
      !> Deformations of the springs and unknowns; forces of the springs, of a joint axial force, then moment
      real(wp), intent(in), contiguous :: d(:), f(:)
      !> [m, N] or [rad, N m]
      real(wp), intent(out) :: deformation, force
      real(wp) :: z(2)

      deformation = d(spring)
      force = f(spring)
      ! A spring that is no first layer
      if (.not. self%heads(spring)) return
      z = self%joints%motion(self%joints%of(spring), d)
      deformation = merge(z(1), z(2), kind == axial)
      force = merge(f(spring), f(spring + 1), kind == axial)
   end subroutine spring_response

   !> Base shear of a frame along x, of a building along the lateral load, from deformations d and forces f
   !> [N].
   module procedure base_force
      real(wp) :: s(3)
      integer :: i

      if (self%plan%is_given()) then
         ! Along the direction of the lateral load
         force = sum(matmul(self%plan%direction(:2), self%plan%share(:2, :, 1))*plane_forces(self, d, f))
         return
      end if
      force = ground_force(self, f)
      do i = 1, self%members
         ! Neither end is held.
         if (all(self%number(1, self%element(i)%node) > 0)) cycle
         call self%member_forces(i, d, f, s)
         force = force + support_force(self, i, d, s)
      end do
   end procedure base_force

   !> Force along x of the supports of a member [N].
   pure real(wp) function support_force(self, member, d, s) result(force)
      type(frame_type), intent(in) :: self
      !> Number of the member
      integer, intent(in) :: member
      !> Deformations of the springs and unknowns; axial force and moments of its ends [N, N m]
      real(wp), intent(in), contiguous :: d(:)
      real(wp), intent(in) :: s(3)
      integer :: j

      force = 0.0_wp
      associate (e => self%element(member), x => d(self%springs + 1:))
         do j = 1, 2
            ! An end that can move has no support along x.
            if (self%number(1, e%node(j)) > 0) cycle
            ! Column 3 j - 2 is that of x at end j.
            force = force - sum(s*e%to_basic(:, 3*j - 2))
            if (.not. self%axially_loaded) cycle
            ! A chord that leans presses the support aside, between pins too.
            force = force + e%compression*e%length*chord_rotation(e, x)*e%lean_of_end(j)
         end do
      end associate
   end function support_force

   !> Force along x of the springs from the ground [N].
   pure real(wp) function ground_force(self, f) result(force)
      type(frame_type), intent(in) :: self
      !> Forces of all springs (springs)
      real(wp), intent(in), contiguous :: f(:)

      force = sum(f(self%member_springs + 1:), mask=self%location(self%member_springs + 1:)%kind == shear)
   end function ground_force

end submodule rbs_structure_frame_frame_rows
