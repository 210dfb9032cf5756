!> The curve of a structure between two points of its path: values and rates at both ends, a cubic between.
module rbs_solve_static_curve
   use rbs_base_constants, only: unbounded
   use rbs_base_cubic, only: beyond_ends, cubic_at, turns_of
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_interaction_joints, only: line_list
   use rbs_solve_static_curved_equilibrium, only: path_point
   use rbs_solve_static_path, only: on_the_end
   use rbs_structure_spring_location, only: shear, flexure
   use rbs_structure_structure, only: structure_type
   implicit none
   private

   public :: curve_type, clean, most_rotation, same_rate

   !> Largest rotation in one stride [rad], and how far it may be from its tangent as a share of it.
   real(wp), parameter :: most_rotation = 0.05_wp, most_bend = 0.1_wp

   !> Bends this small are round-off [rad].
   real(wp), parameter :: no_bend = 1.0e-12_wp

   !> A rate below this share of that of the top is round-off, and a difference of rates below this share of
   !> their own size is zero.
   real(wp), parameter :: noise = 1.0e-13_wp, same_rate = 1.0e-8_wp

   !> The least motion of the top [m] between two targets where the axial load varies.
   real(wp), parameter :: least_motion = 1.0e-4_wp

   !> A spring that moves back by less than this share of its deformation has not turned; one that is beyond
   !> its end by less than the second share of its motion is not beyond it, nor a layer by less than the third
   !> of the largest deformation of a layer.
   real(wp), parameter :: no_return = 1.0e-10_wp, no_overshoot = 1.0e-9_wp, layer_digits = 1.0e-13_wp

   type :: curve_type
      !> Change of the parameter from end to end
      real(wp) :: length = 0.0_wp
      !> Its ends, and the lines of springs and layers on it
      type(path_point) :: near, far
      type(line_list) :: lines
      !> Rates that still count for slips and openings, and for rotations; lines of flexural springs (lines)
      real(wp), private :: least(2) = 0.0_wp
      logical, allocatable, private :: is_rotation(:)
      !> Round-off of the deformations of layers [m]
      real(wp), private :: digits = 0.0_wp
   contains
      procedure :: set, is_gentle, work, least_rate, hides_event, guess
   end type curve_type

contains

   !> Make the curve from a point to the next one; `lines` is listed before by the caller. Deformations of
   !> points are those of the springs, then of the layers of joints.
   subroutine set(self, structure, near, far)
      class(curve_type), intent(inout) :: self
      class(structure_type), intent(in) :: structure
      type(path_point), intent(in) :: near, far

      if (.not. allocated(self%is_rotation)) then
         allocate (self%is_rotation(size(near%d)), source=.false.)
         self%is_rotation(:size(near%q)) = structure%location%kind == flexure
      end if
      self%length = far%t - near%t
      self%near = near
      self%far = far
      self%digits = layer_digits*max(maxval(abs(near%d(size(near%q) + 1:))), &
                                     maxval(abs(far%d(size(near%q) + 1:))))
      ! Well above the round-off of `clean`, so that a motion found to have turned counts as turned.
      self%least(1) = 30.0_wp*noise*max(motion_of(structure, near), motion_of(structure, far))
      self%least(2) = self%least(1)/structure%total_height
   end subroutine set

   !> How fast the joints move the top [m per unit of the parameter], by which round-off of their rates is
   !> measured.
   pure real(wp) function motion_of(structure, point) result(motion)
      class(structure_type), intent(in) :: structure
      type(path_point), intent(in) :: point

      motion = abs(point%displacement_rate)
      ! Under an axial load that varies the top may keep still, but for round-off.
      if (abs(point%axial_rate) > 0.0_wp) then
         motion = max(motion, sum(abs(structure%arm*point%rate)), least_motion)
      end if
   end function motion_of

   !> Rates of the springs at a point, with those that are round-off set to zero.
   pure function clean(structure, point) result(rate)
      class(structure_type), intent(in) :: structure
      type(path_point), intent(in) :: point
      real(wp) :: rate(size(point%rate)), least(2)
      integer :: i

      least(1) = noise*motion_of(structure, point)
      least(2) = least(1)/structure%total_height
      do i = 1, size(rate)
         rate(i) = merge(point%rate(i), 0.0_wp, abs(point%rate(i)) > least(merge(2, 1, &
              structure%location(i)%kind == flexure)))
      end do
   end function clean

   !> Whether the curve is so short that its tangents determine the path between its ends: no body turns far,
   !> and nothing is far from the tangent at the near end.
   pure logical function is_gentle(self, structure)
      class(curve_type), intent(in) :: self
      class(structure_type), intent(in) :: structure
      real(wp) :: change(size(self%near%q)), rotation, step

      associate (slips => structure%location%kind == shear, height => structure%total_height)
         change = self%far%q - self%near%q
         rotation = structure%largest_rotation(change)
         step = max(rotation, maxval(abs(change), mask=slips)/height)
         ! Distance of the far end from the tangent
         change = change - self%length*self%near%rate
         is_gentle = rotation <= 2.0_wp*most_rotation .and. &
                     max(structure%largest_rotation(change), maxval(abs(change), mask=slips)/height) &
                     <= most_bend*step + no_bend
      end associate
   end function is_gentle

   !> Work of a force on a displacement: the trapezoidal rule, and its correction by the slopes at the ends
   !> [J]. The correction is exact if both are cubics of the parameter, or one a cubic of the other: the
   !> smallest is that of the straightest curve.
   pure function work(self, force, displacement, force_rate, displacement_rate)
      class(curve_type), intent(in) :: self
      !> At both ends of the curve; the rates are per unit of the parameter
      real(wp), intent(in) :: force(2), displacement(2), force_rate(2), displacement_rate(2)
      !> By the trapezoidal rule, and the correction; three forms of it
      real(wp) :: work(2), correction(3)

      associate (rise => force(2) - force(1), step => displacement(2) - displacement(1), &
                 force_slope => self%length*force_rate, slope => self%length*displacement_rate)
         work(1) = 0.5_wp*(force(1) + force(2))*step
         ! By the parameter; where the slopes allow it also by the displacement, and by the force
         correction = ((force_slope(1) - force_slope(2))*step - rise*(slope(1) - slope(2)))/10.0_wp &
                   + (force_slope(2)*slope(1) - force_slope(1)*slope(2))/60.0_wp
         if (product(force_slope)*product(slope) > 0.0_wp) then
            correction(2) = step**2*(force_slope(1)/slope(1) - force_slope(2)/slope(2))/12.0_wp
            correction(3) = -rise**2*(slope(1)/force_slope(1) - slope(2)/force_slope(2))/12.0_wp
         end if
         work(2) = correction(minloc(abs(correction), dim=1))
      end associate
   end function work

   !> The least forward rate of springs and layers on one-way lines, in shares of their largest, and
   !> `same_rate` more: below zero a motion has clearly turned back. The error of the spring until then is
   !> the square of that.
   pure real(wp) function least_rate(self, point) result(least)
      class(curve_type), intent(in) :: self
      type(path_point), intent(in) :: point
      real(wp) :: largest, sense
      integer :: i

      least = 1.0_wp
      sense = sign(1.0_wp, self%length)
      do i = 1, size(self%is_rotation)
         ! +1 or -1: the direction of a one-way line, 0: the line is for both directions
         if (self%lines%one_way(i) == 0) cycle
         largest = max(abs(self%near%v(i)), abs(self%far%v(i)), &
                       self%least(merge(2, 1, self%is_rotation(i)))/same_rate)
         if (largest > 0.0_wp) least = min(least, self%lines%one_way(i)*sense*point%v(i)/largest + same_rate)
      end do
   end function least_rate

   !> Whether a spring or layer is beyond an end of its line at the far end, or passes it or turns back
   !> and comes again in between.
   pure logical function hides_event(self) result(hides)
      class(curve_type), intent(in) :: self
      integer :: i

      hides = .false.
      ! Round-off of a column at rest.
      if (maxval(abs(self%far%q - self%near%q)) <= noise*least_motion) return
      do i = 1, size(self%is_rotation)
         associate (one_way => self%lines%one_way(i))
            ! +1 or -1: direction of a one-way line, which has no end to the rear; 0: a line for both
            ! directions
            if (one_way /= 0) hides = hides_turn(self, i, one_way)
            if (one_way >= 0 .and. .not. hides) hides = passes(self, i, 1, self%lines%upper(i))
            if (one_way <= 0 .and. .not. hides) hides = passes(self, i, -1, self%lines%lower(i))
         end associate
         if (hides) return
      end do
   end function hides_event

   !> Whether the deformation of spring or layer i is beyond an end of its line at the far point or between.
   pure logical function passes(self, i, side, finish)
      type(curve_type), intent(in) :: self
      !> Spring or layer, and which end: +1 upper, -1 lower
      integer, intent(in) :: i, side
      !> Deformation at that end [m or rad]
      real(wp), intent(in) :: finish
      real(wp) :: c(4), peak(2), allowance

      passes = .false.
      ! Deformation at both ends of the curve, and its slopes there.
      c = cubic_of(self, i)
      ! An end at infinity is never reached.
      if (side*finish > max(side*c(1), side*c(2)) + beyond_ends*(abs(c(3)) + abs(c(4))) .or. &
          .not. abs(finish) < unbounded) return
      allowance = no_overshoot*(abs(c(2)) + abs(c(2) - c(1)))
      if (i > size(self%near%q)) allowance = allowance + self%digits
      ! Where the cubic turns in between.
      peak = cubic_at(turns_of(c), c(1), c(2), c(3), c(4))
      passes = side*(c(2) - finish) > allowance .or. &
               any(side*(peak - finish) > max(allowance, on_the_end*abs(finish)))
   end function passes

   !> Whether a spring or layer on a one-way line turns back and turns again between the ends of the curve.
   pure logical function hides_turn(self, i, one_way)
      type(curve_type), intent(in) :: self
      !> Spring or layer, and the direction of its line, +1 or -1
      integer, intent(in) :: i, one_way
      real(wp) :: c(4), share(2), peak(2)

      ! The shares of the way at which the cubic turns, in order; 1 where it does not.
      c = cubic_of(self, i)
      share = turns_of(c)
      peak = cubic_at(share, c(1), c(2), c(3), c(4))
      hides_turn = share(2) < 1.0_wp .and. one_way*(peak(1) - peak(2)) > no_return*max(abs(c(1)), abs(c(2)))
   end function hides_turn

   !> Deformation of spring or layer i at both ends of the curve, and its slopes there by the share of the
   !> way, from 0 to 1.
   pure function cubic_of(self, i) result(c)
      type(curve_type), intent(in) :: self
      integer, intent(in) :: i
      real(wp) :: c(4)

      c = [self%near%d(i), self%far%d(i), self%length*self%near%v(i), self%length*self%far%v(i)]
   end function cubic_of

   !> The point of the curve at a value of the parameter, as a guess that Newton's method starts from.
   pure subroutine guess(self, t, point)
      class(curve_type), intent(in) :: self
      real(wp), intent(in) :: t
      type(path_point), intent(inout) :: point
      real(wp) :: share

      share = (t - self%near%t)/self%length
      point%t = t
      point%q = cubic_at(share, self%near%q, self%far%q, self%length*self%near%rate, &
                      self%length*self%far%rate)
      point%force = self%near%force + share*(self%far%force - self%near%force)
   end subroutine guess

end module rbs_solve_static_curve
