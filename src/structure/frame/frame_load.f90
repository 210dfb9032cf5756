!> Dead load of a frame: the compression of its members, its work, and the energy of the elastic parts.
submodule (rbs_structure_frame_frame) rbs_structure_frame_frame_load
   use rbs_structure_frame_element_balance, only: energy_of_rest
   implicit none

contains

   !> Whether any dead load acts: on unknowns, on springs, or on the elastic rests of elements.
   module procedure is_loaded
      integer :: i

      is_loaded = any(abs(self%dead) > 0.0_wp) .or. any(abs(self%dead_force) > 0.0_wp) .or. &
                  any([(any(abs(self%element(i)%dead_rotation) > 0.0_wp), i=1, self%members)])
   end procedure is_loaded

   !> Take all dead load off.
   module procedure take_load_off
      integer :: i

      self%dead = 0.0_wp
      self%dead_force = 0.0_wp
      do i = 1, self%members
         self%element(i)%dead_rotation = 0.0_wp
         self%element(i)%joint%dead_moment = 0.0_wp
      end do
   end procedure take_load_off

   !> Leave out members that are built under the dead load: no unknown moves them.
   module procedure leave_out_later
      integer :: i

      do i = 1, self%members
         if (self%element(i)%after_dead_load) call self%element(i)%disconnect()
      end do
      call self%set_second_order()
   end procedure leave_out_later

   !> Build these members without forces into the frame, whose springs and unknowns stand at d.
   module procedure build_later
      integer :: i

      do i = 1, self%members
         associate (e => self%element(i))
            ! From these motions of its ends on it deforms.
            if (e%after_dead_load) e%built_at = end_motion(e, d(self%springs + 1:))
         end associate
      end do
   end procedure build_later

   !> Take the axial forces of the elements under dead load, from deformations d and forces f of all springs,
   !> for second-order work and for springs whose law depends on them.
   module procedure set_compression
      real(wp) :: s(3)
      integer :: i

      do i = 1, self%members
         call self%member_forces(i, d, f, s)
         ! Zero minus a zero force has no negative sign.
         call self%compress(i, 0.0_wp - s(1))
         ! Springs that open, behind those that bend, carry it by the path and not from its begin on.
         associate (e => self%element(i))
            self%constant_axial(e%before + 1:e%before + e%bending) = -s(1)
         end associate
      end do
      ! In its second plane a column carries the axial force of the first.
      do i = 1, self%members
         if (self%axial_of(i) == 0) cycle
         associate (e => self%element(i), whole => self%element(self%axial_of(i))%compression)
            call self%compress(i, whole)
            self%constant_axial(e%before + 1:e%before + e%bending) = whole
         end associate
      end do
      call self%set_second_order()
      ! The elastic rests have changed, and with them the tangents.
      self%initial_tangent%is_known = .false.
      call self%linearise(self%initial_stiffness, self%initial_tangent, i)
   end procedure set_compression

   !> Put a compression [N] that does second-order work on an element.
   module procedure compress

      self%element(element)%compression = compression
      call self%element(element)%set_rest(merge(compression, 0.0_wp, self%axially_loaded))
   end procedure compress

   !> Assemble the second-order stiffness of the axial forces, if the frame has any.
   module procedure set_second_order
      real(wp) :: band(self%half_width + 1, self%unknowns)
      integer :: i

      if (.not. self%axially_loaded) return
      band = 0.0_wp
      do i = 1, self%members
         call add_geometric_band(self%element(i), self%element(i)%compression, band)
      end do
      self%second_order = sparse_of(band)
   end procedure set_second_order

   !> Assemble the damping in proportion to the initial stiffness, if there is any.
   module procedure set_damping
      real(wp) :: band(self%half_width + 1, self%unknowns)
      integer :: i

      if (self%tangent_damping .or. .not. self%stiffness_damping > 0.0_wp) return
      band = 0.0_wp
      do i = 1, size(self%element)
         call add_band(self%element(i), self%stiffness_damping*self%initial_tangent(i)%stiffness, band)
      end do
      self%damping = sparse_of(band)
   end procedure set_damping

   !> Work of the dead load on unknowns, springs and elastic rests, by deformations and unknowns d [J].
   module procedure work_of_dead_load
      real(wp) :: misfit(3), turned(2)
      integer :: i

      associate (x => d(self%springs + 1:self%joints%before))
         work = sum(self%dead*x) + sum(self%dead_force*d(:self%member_springs))
         ! The rest in double and in single curvature: stiffness times rotation by the load times rotation of
         ! the ends
         do i = 1, size(self%element)
            associate (e => self%element(i))
               if (.not. allocated(e%rest)) cycle
               misfit = compatibility_error(e, end_motion(e, x), d, 0.0_wp)
               turned = e%dead_rotation
               work = work + 0.25_wp*(e%rest(1)*sum(turned)*sum(misfit(2:)) &
                                    + e%rest(2)*(turned(1) - turned(2))*(misfit(2) - misfit(3)))
            end associate
         end do
      end associate
   end procedure work_of_dead_load

   !> Potential of the dead load and of the second-order work, and energy of the elastic rests, at d [J].
   module procedure potential_energy
      real(wp) :: g(self%unknowns), in_springs
      integer :: i

      associate (x => d(self%springs + 1:self%joints%before))
         energy = -sum(self%dead*x)
         in_springs = 0.0_wp
         do i = 1, self%member_springs
            ! Most springs have no dead load.
            if (abs(self%dead_force(i)) > 0.0_wp) in_springs = in_springs + self%dead_force(i)*d(i)
         end do
         energy = energy - in_springs
         do i = 1, self%members
            associate (e => self%element(i))
               energy = energy + energy_of_rest(e, compatibility_error(e, end_motion(e, x), d, 1.0_wp))
            end associate
         end do
         if (.not. allocated(self%second_order)) return
         g = 0.0_wp
         ! g = -K_G x
         call self%second_order%subtract_product(x, g)
         energy = energy - 0.5_wp*sum(g*x)
      end associate
   end procedure potential_energy

end submodule rbs_structure_frame_frame_load
