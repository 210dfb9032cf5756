!> The trilinear flexural spring of a plastic hinge from the moment-curvature diagram of its section.
!>
!> Rotation is curvature times the hinge length l_p = 0.08 L + 0.022 f_y d_b (MPa; Paulay and Priestley 1992,
!> without its lower bound). Cracking is read from the diagram with tension stiffening, yield and ultimate
!> from that without. B_1 follows from eq 7 of the paper at a rotation D_m.
module rbs_section_flexural_spring
   use rbs_base_constants, only: unset
   use rbs_base_error, only: error_type, fatal_error, bad_input
   use rbs_base_key_visitor, only: key_visitor
   use rbs_base_keys, only: above_zero, any_number, not_negative
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_section_concrete_law, only: tension_bare, tension_ts
   use rbs_section_events, only: events_type, point_type, points_record, find_events, reach_moment
   use rbs_section_resultants, only: laws_type, section_laws
   use rbs_section_cross_section, only: section_type
   use rbs_base_check, only: is_given
   implicit none
   private

   public :: hinge_record, flexural_spring_type, fit_flexural_spring, hinge_length

   !> Names of the figures of `as_array`.
   character(len=12), parameter, public :: spring_figures(10) = [character(len=12) :: &
      'k_c', 'd_c', 'k_y', 'd_y', 'k_u', 'b0', 'b1', 'k_u_found', 'hinge_length', 'd_m']

   !> How the spring is read from the diagrams.
   type, extends(points_record) :: hinge_record
      !> From the base to the point of contraflexure [m], axial load, compression positive [N]
      real(wp) :: length = unset, axial_load = unset
      !> Hinge length [m]; `unset`: by the formula above
      real(wp) :: hinge_length = unset
      !> Yield of the bare diagram (A); its moment on the diagram with tension stiffening (B); or
      !> `yield_first` (first)
      character(len=8) :: yield_rule = 'A'
      !> Factor of M_y and M_u for the shear that acts with the moment
      real(wp) :: moment_factor = 1.0_wp
      !> Exponent B_0, and rotation D_m at which eq 7 is taken for B_1 [rad]; `unset`: the ultimate one
      real(wp) :: b0 = 0.4_wp, d_m = unset
   contains
      procedure :: visit
   end type hinge_record

   type :: flexural_spring_type
      !> Stiffnesses [N m/rad] and rotations [rad] of the trilinear line
      real(wp) :: k_c = 0.0_wp, d_c = 0.0_wp, k_y = 0.0_wp, d_y = 0.0_wp, k_u = 0.0_wp
      !> Degradation factors; stiffness after yield before it was raised to zero [N m/rad]
      real(wp) :: b0 = 0.0_wp, b1 = 0.0_wp, k_u_found = 0.0_wp
      !> Length of the hinge [m], rotation D_m of eq 7 [rad]
      real(wp) :: hinge_length = 0.0_wp, d_m = 0.0_wp
      !> The points of the diagram on the line, and the largest moment
      type(point_type) :: cracking, yield, peak, ultimate
   contains
      procedure :: as_array
   end type flexural_spring_type

contains

   !> Present the keys to a visitor.
   subroutine visit(self, v)
      class(hinge_record), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%key('length', self%length, 'm', above_zero, 'from the base to the point of contraflexure')
      call v%key('axial_load', self%axial_load, 'N', any_number, 'axial load, compression positive')
      call v%key('hinge_length', self%hinge_length, 'm', above_zero, &
                 'length of the hinge; without it 0.08 L + 0.022 f_y d_b (MPa)', optional=.true.)
      call v%word('yield_rule', self%yield_rule, 'how the yield rotation is read', 'A B first')
      call self%visit_points(v)
      call v%key('moment_factor', self%moment_factor, '', above_zero, &
                 'factor of the yield and ultimate moments')
      call v%key('b0', self%b0, '', not_negative, 'exponent of the unloading stiffness')
      call v%key('d_m', self%d_m, 'rad', above_zero, 'rotation for B_1; without it the ultimate one', &
                 optional=.true.)
   end subroutine visit

   !> Fit the trilinear spring to the diagram of a section.
   subroutine fit_flexural_spring(section, hinge, spring, error)
      type(section_type), intent(in) :: section
      type(hinge_record), intent(in) :: hinge
      type(flexural_spring_type), intent(out) :: spring
      type(error_type), allocatable, intent(out) :: error
      type(laws_type) :: stiffened, bare
      type(events_type) :: with_stiffening, without
      type(point_type) :: point

      stiffened = section_laws(section, tension_ts, hinge%confined)
      bare = section_laws(section, tension_bare, hinge%confined)
      call find_events(section, stiffened, hinge%axial_load, hinge%rule(hinge%yield_rule), with_stiffening, &
                       error, only_cracking=.true.)
      if (allocated(error)) return
      call find_events(section, bare, hinge%axial_load, hinge%rule(hinge%yield_rule), without, error)
      if (allocated(error)) return
      spring%cracking = with_stiffening%cracking
      spring%yield = without%yield
      spring%ultimate = without%ultimate
      spring%peak = without%peak
      call check_points(hinge%axial_load)
      if (allocated(error)) return
      if (hinge%yield_rule == 'B') then
         ! The yield moment of the bare diagram on the one with tension stiffening
         call reach_moment(section, stiffened, hinge%axial_load, spring%yield%moment, point, error)
         if (allocated(error)) return
         if (point%found) spring%yield = point
      end if
      call draw_line()

   contains

      !> Set `error` unless cracking, yield and ultimate point exist, in this order.
      subroutine check_points(axial_load)
         real(wp), intent(in) :: axial_load

         if (size(section%bar_y) == 0) then
            call fatal_error(error, bad_input, 'flexural spring: the section has no bars, so nothing '// &
                             'yields; give it bars or a layout')
         else if (.not. spring%yield%found) then
            call fatal_error(error, bad_input, 'flexural spring: no bar yields in tension before the '// &
                             "section fails (controlled by compression); take yield = 'first', or give "// &
                             'the spring by hand')
         else if (.not. spring%ultimate%found) then
            call fatal_error(error, bad_input, 'flexural spring: the diagram ends before the ultimate '// &
                             'point '//"of this rule; take ultimate = 'drop'")
         else if (.not. (spring%cracking%found .and. spring%cracking%curvature > 0.0_wp)) then
            call fatal_error(error, bad_input, 'flexural spring: the axial load alone cracks the '// &
                             'section: '//to_text(axial_load)//' N, compression positive; the trilinear '// &
                             'line has no first branch, reduce the tension')
         else if (spring%ultimate%curvature <= spring%yield%curvature) then
            call fatal_error(error, bad_input, 'flexural spring: the ultimate curvature '// &
                             to_text(spring%ultimate%curvature)//' 1/m is not beyond the yield curvature '// &
                             to_text(spring%yield%curvature)//' 1/m (controlled by compression); take '// &
                             "yield = 'first', or give the spring by hand")
         else if (spring%yield%curvature <= spring%cracking%curvature) then
            call fatal_error(error, bad_input, 'flexural spring: the section yields at '// &
                             to_text(spring%yield%curvature)//' 1/m, before it cracks at '// &
                             to_text(spring%cracking%curvature)//' 1/m; the trilinear line does not apply')
         end if
      end subroutine check_points

      !> The line through the three points, in rotations: sets `spring`, or `error` if its slopes do not
      !> fall.
      subroutine draw_line()
         !> Moments at cracking, yield and the ultimate point [N m]; length of the hinge [m]
         real(wp) :: m_c, m_y, m_u, l_p

         l_p = hinge%hinge_length
         if (.not. is_given(l_p)) l_p = hinge_length(section, hinge%length)
         m_c = spring%cracking%moment
         m_y = hinge%moment_factor*spring%yield%moment
         m_u = hinge%moment_factor*spring%ultimate%moment
         spring%hinge_length = l_p
         spring%d_c = spring%cracking%curvature*l_p
         spring%d_y = spring%yield%curvature*l_p
         spring%k_c = m_c/spring%d_c
         spring%k_y = (m_y - m_c)/(spring%d_y - spring%d_c)
         spring%k_u_found = (m_u - m_y)/((spring%ultimate%curvature - spring%yield%curvature)*l_p)
         spring%k_u = max(0.0_wp, spring%k_u_found)
         spring%b0 = hinge%b0
         spring%d_m = hinge%d_m
         if (.not. is_given(hinge%d_m)) spring%d_m = spring%ultimate%curvature*l_p
         if (m_y <= m_c) then
            call fatal_error(error, bad_input, 'flexural spring: the yield moment '//to_text(m_y)// &
                             ' N m is not above the cracking moment '//to_text(m_c)//' N m (lightly '// &
                             'reinforced); the trilinear line does not apply')
         else if (spring%k_u > spring%k_y .or. spring%k_y >= spring%k_c) then
            call fatal_error(error, bad_input, 'flexural spring: the stiffnesses '//to_text(spring%k_c)// &
                             ', '//to_text(spring%k_y)//', '//to_text(spring%k_u)//' N m/rad do not fall '// &
                             'from branch to branch; the trilinear line does not apply')
         else
            ! eq 7: K_r = (M_c + M_y)/(D_c + D_y) (D_y/D_m)^B_0, and B_1 = K_r/K_c.
            spring%b1 = (m_c + m_y)/(spring%d_c + spring%d_y)*(spring%d_y/spring%d_m)**spring%b0/spring%k_c
         end if
      end subroutine draw_line

   end subroutine fit_flexural_spring

   !> l_p = 0.08 L + 0.022 f_y d_b [m]; f_y (MPa) of the bar farthest on the tension side.
   pure real(wp) function hinge_length(section, length)
      type(section_type), intent(in) :: section
      !> From the base to the point of contraflexure [m]
      real(wp), intent(in) :: length
      integer :: outermost

      hinge_length = 0.08_wp*length
      if (size(section%bar_y) == 0) return
      outermost = maxloc(section%bar_y, dim=1)
      hinge_length = hinge_length + 0.022e-6_wp*section%steels(section%bar_steel(outermost))%fy* &
                     section%bar_diameter
   end function hinge_length

   !> The figures in the order of their names.
   pure function as_array(self) result(figures)
      class(flexural_spring_type), intent(in) :: self
      real(wp) :: figures(size(spring_figures))

      figures = [self%k_c, self%d_c, self%k_y, self%d_y, self%k_u, self%b0, self%b1, self%k_u_found, &
                 self%hinge_length, self%d_m]
   end function as_array

end module rbs_section_flexural_spring
