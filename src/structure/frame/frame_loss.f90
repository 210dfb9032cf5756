!> Members of a frame that fail in shear, lose their axial load or are removed, and collapse after that.
submodule (rbs_structure_frame_frame) rbs_structure_frame_frame_loss
   use rbs_base_check, only: is_given
   use rbs_base_tolerances, only: same_input
   use rbs_structure_frame_element_balance, only: energy_of_rest, chord_rotation
   use rbs_structure_spring_location, only: shear, flexure
   implicit none

   !> Share of the height of a storey that a node may sink.
   real(wp), parameter :: deepest = 0.1_wp

   !> A rotation that no hinge of a frame has [rad].
   real(wp), parameter :: farthest = 10.0_wp

contains

   !> Whether a member carries nothing any more: all of its springs are released together, so that one tells.
   module procedure is_removed

      associate (e => self%element(member))
         is_removed = e%bending + e%opening > 0
         if (is_removed) is_removed = springs%is_removed(e%before + 1)
      end associate
   end procedure is_removed

   !> The first member whose time has come, or that has failed and is at the drift of its axial failure; 0:
   !> none. Without `time`, on a static path, none is lost by time.
   module procedure next_failed_member
      integer :: i

      member = 0
      if (.not. self%may_lose) return
      do i = 1, self%members
         if (self%is_removed(i, springs)) cycle
         if (present(time) .and. is_given(self%lost_at(i))) then
            if (time - self%lost_at(i) >= -same_input*abs(self%lost_at(i))) member = i
         end if
         if (is_given(self%failure_drift(i))) then
            if (has_failed(self, i, springs)) member = i
         end if
         if (member > 0) return
      end do
   end procedure next_failed_member

   !> Whether a member has failed in shear and is at the drift of its axial failure.
   logical function has_failed(frame, member, springs)
      type(frame_type), intent(in) :: frame
      !> Number of the member, and springs in their present state
      integer, intent(in) :: member
      !> Springs in their present state
      type(spring_array), intent(in) :: springs
      real(wp) :: drift, s(3)
      integer :: i

      ! Its shear failure is by drift, or by a shear spring that has yielded.
      associate (e => frame%element(member), x => springs%d(frame%springs + 1:))
         drift = abs(chord_rotation(e, x))
         has_failed = is_given(frame%shear_drift(member)) .and. drift >= abs(frame%shear_drift(member))
         do i = e%before + 1, e%before + e%bending
            if (frame%location(i)%kind /= shear) cycle
            if (springs%rules%list(springs%rules%of(i))%rule%has_yielded(springs%slot(i)%memory)) has_failed &
               = .true.
         end do
         if (.not. has_failed) return
         call frame%member_forces(member, springs%d, springs%forces(springs%d), s)
         ! A member in tension, or without axial force, does not fall. s(1) < 0 is compression, so that the
         ! drift reaches failure_drift/(1 + P/failure_load).
         has_failed = s(1) < 0.0_wp .and. &
                      drift*(1.0_wp - s(1)/frame%failure_load(member)) >= frame%failure_drift(member)
      end associate
   end function has_failed

   !> Take the forces of a member away: release its springs, find its inside in equilibrium without them, and
   !> book the energy of its elastic rest that is lost as work of its first spring.
   module procedure remove_member
      type(series_tangent) :: tangent
      real(wp) :: correction(size(springs%d)), s(3), q(3), energy
      integer :: i

      tangent = self%initial_tangent(member)
      correction = 0.0_wp
      associate (e => self%element(member))
         q = end_motion(e, springs%d(self%springs + 1:))
         energy = energy_of_rest(e, compatibility_error(e, q, springs%d, 1.0_wp))
         do i = e%before + 1, e%before + e%bending + e%opening
            call springs%release(i, self%dead_force(i))
         end do
         call set_tangent(e, e%bending + e%opening, springs%k(e%before + 1:), tangent)
         call balance_ends(e, springs%count, compatibility_error(e, q, springs%d, 1.0_wp), 1.0_wp, &
                           self%dead_force, springs%forces(springs%d), tangent, s, correction)
         correction = springs%d + correction
         call springs%joints%open_layers(correction)
         do i = e%before + 1, e%before + e%bending + e%opening
            call springs%advance_on_branch(i, correction(i))
         end do
         springs%d(self%springs + 1:) = correction(self%springs + 1:)
         energy = energy - energy_of_rest(e, compatibility_error(e, q, springs%d, 1.0_wp))
         springs%work(e%before + 1) = springs%work(e%before + 1) + energy
      end associate
   end procedure remove_member

   !> Whether a node has sunk by a tenth of the height of a storey, once members may be lost.
   module procedure has_collapsed
      integer :: i

      has_collapsed = .false.
      if (.not. self%may_lose) return
      do i = 1, self%n
         ! Held upward
         if (self%number(2, i) == 0) cycle
         has_collapsed = has_collapsed .or. &
                      d(self%springs + self%number(2, i)) < -deepest*self%height/max(self%storeys, 1)
      end do
   end procedure has_collapsed

   !> The first spring in a member that has slid, or opened, by the height of the frame or turned by
   !> `farthest`; 0: none.
   module procedure unbounded_spring
      integer :: j

      do j = 1, self%joints%count
         spring = self%joints%first(j)
         ! Of a joint of layers opening and rotation count.
         associate (at => self%joints%before + 2*j)
            if (abs(d(at - 1)) > self%height .or. abs(d(at)) > farthest) return
         end associate
      end do
      do j = 1, size(self%joints%others)
         spring = self%joints%others(j)
         ! Springs from the ground come behind those of members.
         if (spring > self%member_springs) exit
         if (abs(d(spring)) < min(self%height, farthest)) cycle
         if (abs(d(spring)) > merge(farthest, self%height, self%location(spring)%kind == flexure)) return
      end do
      spring = 0
   end procedure unbounded_spring

end submodule rbs_structure_frame_frame_loss
