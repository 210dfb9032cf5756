!> Kind of a member: its springs, and the elastic rest between them.
module rbs_structure_frame_frame_kinds
   use rbs_base_check, only: is_given
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_spring_record, only: spring_record
   use rbs_structure_frame_frame_checks, only: group_of, is_rigid, is_strut
   use rbs_structure_frame_frame_record, only: kind_record, frame_spring
   use rbs_structure_frame_new_frame, only: frame_member
   use rbs_structure_spring_location, only: shear, flexure, axial, layer
   implicit none
   private

   public :: put_kind, can_be_lost, stiffness_of

   !> Shares of the length in the rule of Gauss and Lobatto with three points.
   real(wp), parameter :: share(3) = [1.0_wp/6.0_wp, 2.0_wp/3.0_wp, 1.0_wp/6.0_wp]
   real(wp), parameter :: point(3) = [0.0_wp, 0.5_wp, 1.0_wp]

   !> Stiffness of a rigid member along it and in bending, over the largest of the others: its
   !> deformation and the digits that it costs are both some 1e-7 of the results.
   real(wp), parameter :: rigid(2) = [1.0e5_wp, 1.0e7_wp]

contains

   !> E A/l [N/m] and E I/l [N m] of a member of a kind with a clear length.
   pure function stiffness_of(kind, clear) result(stiffness)
      type(kind_record), intent(in) :: kind
      !> Clear length [m]
      real(wp), intent(in) :: clear
      real(wp) :: stiffness(2)

      stiffness = kind%modulus*[kind%area, kind%inertia]/clear
   end function stiffness_of

   !> Give a member the springs and the elastic rest of its kind, now that its clear length is known.
   subroutine put_kind(m, kind, spring, clear, stiffest)
      type(frame_member), intent(inout) :: m
      type(kind_record), intent(in) :: kind
      !> All springs of the frame, those of this kind among them
      type(frame_spring), intent(in) :: spring(:)
      !> Clear length [m]
      real(wp), intent(in) :: clear
      !> Largest `stiffness_of` members of the frame that are not rigid
      real(wp), intent(in) :: stiffest(2)
      !> A spring of bending at a point of the rule; E A [N] and E I [N m2]
      type(spring_record) :: hinge
      real(wp) :: rigidity(2)
      integer :: i, j, k, group

      allocate (m%kind(0), m%joint(0), m%position(0), m%y(0), m%spring(0))
      rigidity = clear*stiffness_of(kind, clear)
      if (is_rigid(kind, spring)) rigidity = clear*rigid*stiffest
      ! A strut is flexible by its springs along its axis alone; E I = k l^3 is of their size.
      if (is_strut(kind, spring)) rigidity = [0.0_wp, clear**3*stiffness_of_springs(kind, spring)]
      m%axial = rigidity(1)
      m%failure_drift = kind%failure_drift
      m%failure_load = kind%failure_load
      m%shear_drift = kind%shear_drift
      ! Springs at the points of the rule hold all bending: where the member yields, or is elastic and may be
      ! lost.
      if (is_given(kind%yield_moment) .or. &
          (is_given(m%lost_at) .and. all(spring%kind /= kind%name) .and. .not. m%pinned)) then
         m%bending = rigidity(2)
         m%lumped = .true.
         do i = 1, 3
            ! Curvature of the member in three springs that together bend as it does.
            hinge = elastic(rigidity(2)/(share(i)*clear))
            if (is_given(kind%yield_moment)) then
               hinge%rule = 'bilinear'
               ! Rotation at yielding, and stiffness after it
               hinge%value(2:3) = [kind%yield_moment/hinge%value(1), kind%hardening*hinge%value(1)]
            end if
            call append_spring(m, flexure, point(i), hinge)
         end do
         if (kind%shear_rigidity > 0.0_wp) then
            call append_spring(m, shear, 0.5_wp, elastic(kind%shear_rigidity/clear))
         end if
         call add_opening(m, clear)
         return
      end if
      if (kind%interior == 'elastic' .or. is_rigid(kind, spring) .or. m%pinned) then
         m%bending = rigidity(2)
         m%sliding = kind%shear_rigidity
      end if
      ! By groups shear, flexure and axial, so that springs that open come last.
      do group = 1, 3
         do j = 1, size(spring)
            if (spring(j)%kind /= kind%name .or. spring(j)%group /= group_of(group)) cycle
            if (allocated(spring(j)%position)) then
               do k = 1, size(spring(j)%position)
                  call append_spring(m, group, spring(j)%position(k), spring(j)%spring)
               end do
            ! Without positions flexural springs are at both ends, others in the middle.
            else if (group == flexure) then
               call append_spring(m, flexure, 0.0_wp, spring(j)%spring)
               call append_spring(m, flexure, 1.0_wp, spring(j)%spring)
            else
               call append_spring(m, group, 0.5_wp, spring(j)%spring)
            end if
         end do
      end do
      call add_opening(m, clear)
   end subroutine put_kind

   !> Give a member that may be removed a spring for its axial force, if it has none: E A/l moves into it.
   subroutine add_opening(m, clear)
      type(frame_member), intent(inout) :: m
      !> Clear length [m]
      real(wp), intent(in) :: clear

      if (.not. (is_given(m%failure_drift) .or. is_given(m%lost_at))) return
      if (any(m%kind == layer .or. m%kind == axial)) return
      call append_spring(m, axial, 0.5_wp, elastic(m%axial/clear))
      m%axial = 0.0_wp
   end subroutine add_opening

   !> Largest stiffness of the springs of a kind, which for a strut act along it [N/m].
   real(wp) function stiffness_of_springs(kind, spring) result(largest)
      type(kind_record), intent(in) :: kind
      !> All springs of the frame
      type(frame_spring), intent(in) :: spring(:)
      integer :: i

      largest = 0.0_wp
      do i = 1, size(spring)
         if (spring(i)%kind == kind%name) largest = max(largest, spring(i)%spring%initial_stiffness())
      end do
   end function stiffness_of_springs

   !> An elastic spring with a stiffness.
   type(spring_record) function elastic(stiffness)
      !> [N/m] or [N m]
      real(wp), intent(in) :: stiffness

      elastic%rule = 'elastic'
      elastic%value(1) = stiffness
   end function elastic

   !> Whether a member without the forces of its springs carries nothing: springs bend in two ways, and open.
   !> Those of a member with pinned ends need only open.
   pure logical function can_be_lost(m)
      type(frame_member), intent(in) :: m

      associate (bends => m%kind == flexure .or. m%kind == layer)
         can_be_lost = any(m%kind == layer .or. m%kind == axial) .and. any(bends)
         if (can_be_lost) can_be_lost = any(m%kind == shear) .or. &
                                        maxval(m%position, mask=bends) > minval(m%position, mask=bends)
         can_be_lost = can_be_lost .or. (m%pinned .and. any(m%kind == axial))
      end associate
   end function can_be_lost

   !> Append a spring to a member, or the layers of a joint as a spring each.
   subroutine append_spring(m, kind, position, spring)
      type(frame_member), intent(inout) :: m
      !> `shear`, `flexure` or `axial`, and position in shares of the clear length
      integer, intent(in) :: kind
      real(wp), intent(in) :: position
      !> The spring, or with the rule layered all layers of the joint
      type(spring_record), intent(in) :: spring
      type(spring_record), allocatable :: longer(:)
      integer :: i, joint, layers, n

      n = size(m%kind)
      joint = 1
      if (n > 0) joint = m%joint(n) + 1
      if (spring%rule == 'layered') then
         ! A joint of layers is as many springs at one place.
         layers = size(spring%y)
         m%kind = [m%kind, spread(layer, 1, layers)]
         m%y = [m%y, spring%y]
      else
         layers = 1
         m%kind = [m%kind, kind]
         m%y = [m%y, 0.0_wp]
      end if
      m%joint = [m%joint, spread(joint, 1, layers)]
      m%position = [m%position, spread(position, 1, layers)]
      allocate (longer(n + layers))
      longer(:n) = m%spring
      if (spring%rule == 'layered') then
         do i = 1, layers
            longer(n + i) = spring%layer(i)
         end do
      else
         longer(n + 1) = spring
      end if
      call move_alloc(longer, m%spring)
   end subroutine append_spring

end module rbs_structure_frame_frame_kinds
