!> What is asked of a section, under the names of keys: a diagram, springs, a shear diagram, a layer.
module rbs_section_settings_record
   use rbs_base_constants, only: unset
   use rbs_base_key_visitor, only: key_visitor, visited_record
   use rbs_base_keys, only: above_zero, any_number, bound_type, not_negative
   use rbs_base_kinds, only: wp
   use rbs_section_events, only: rule_type, ultimate_names, yield_first, yield_names, yield_tension
   use rbs_section_flexural_spring, only: hinge_type
   use rbs_section_shear_diagram, only: default_knee, default_layers, fewest_layers, most_layers
   implicit none
   private

   public :: diagram_record, springs_record, shear_record, layer_record, place_of

   character(len=*), parameter :: tension_choices = 'zero bare ts'
   character(len=*), parameter :: ultimate_choices = 'cover mander steel drop'
   type(bound_type), parameter :: layer_counts = bound_type(real(fewest_layers, wp), real(most_layers, wp))
   type(bound_type), parameter :: knees = &
      bound_type(0.0_wp, 1.0_wp, least_open=.true., most_open=.true., reason='(uncracked it is 1)')

   !> A moment-curvature diagram.
   type, extends(visited_record) :: diagram_record
      !> Compression positive [N]
      real(wp) :: axial_load = 0.0_wp
      !> One of `tension_names`
      character(len=8) :: tension = 'ts'
      !> Whether the core is confined and the cover spalls
      logical :: confined = .false.
      !> One of `yield_names` and of `ultimate_names`, with the strains of these rules
      character(len=8) :: yielding = 'tension', ultimate = 'cover'
      real(wp) :: eps_yield = 0.002_wp, eps_cover = 0.003_wp
   contains
      procedure :: visit => visit_diagram
      procedure :: rule => rule_of_diagram
   end type diagram_record

   !> The flexural spring of a column.
   type, extends(visited_record) :: springs_record
      !> From the base to the point of contraflexure [m], axial load [N], length of the hinge [m]
      real(wp) :: length = unset, axial_load = unset, hinge_length = unset
      !> A, B or first
      character(len=8) :: yield_rule = 'A', ultimate = 'cover'
      real(wp) :: eps_yield = 0.002_wp, eps_cover = 0.003_wp
      logical :: confined = .false.
      !> Factor of M_y and M_u, exponent B_0, rotation for B_1 [rad]
      real(wp) :: moment_factor = 1.0_wp, b0 = 0.4_wp, d_m = unset
   contains
      procedure :: visit => visit_springs
      procedure :: hinge => hinge_of_springs
   end type springs_record

   !> A shear diagram.
   type, extends(visited_record) :: shear_record
      !> Shear span M/V [m], axial load [N]
      real(wp) :: length = unset, axial_load = unset
      character(len=8) :: tension = 'ts'
      logical :: confined = .false.
      !> Whether shear changes the longitudinal stresses and the moment
      logical :: coupled = .false.
      integer :: layers = default_layers
      !> Share of (E_c/2) A at the knee
      real(wp) :: knee = default_knee
   contains
      procedure :: visit => visit_shear
   end type shear_record

   !> One layer of the modified compression field theory.
   type, extends(visited_record) :: layer_record
      !> Smeared stirrups
      real(wp) :: rho_z = 0.0_wp
      character(len=8) :: tension = 'ts'
   contains
      procedure :: visit => visit_layer
   end type layer_record

contains

   subroutine visit_diagram(self, v)
      class(diagram_record), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%key('axial_load', self%axial_load, 'N', any_number, 'axial load, compression positive')
      call v%word('tension', self%tension, 'tension law of the concrete', tension_choices)
      call v%key('confined', self%confined, 'the core is confined and the cover spalls')
      call v%word('yielding', self%yielding, 'rule of yield', 'tension first')
      call v%word('ultimate', self%ultimate, 'rule of the ultimate point', ultimate_choices)
      call v%key('eps_yield', self%eps_yield, '', above_zero, &
                 'strain of the extreme fibre for yielding = first')
      call v%key('eps_cover', self%eps_cover, '', above_zero, &
                 'strain of the extreme fibre for ultimate = cover')
   end subroutine visit_diagram

   subroutine visit_springs(self, v)
      class(springs_record), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%key('length', self%length, 'm', above_zero, 'from the base to the point of contraflexure')
      call v%key('axial_load', self%axial_load, 'N', any_number, 'axial load, compression positive')
      call v%key('hinge_length', self%hinge_length, 'm', above_zero, &
                 'length of the hinge; without it 0.08 L + 0.022 f_y d_b (MPa)', optional=.true.)
      call v%word('yield_rule', self%yield_rule, 'how the yield rotation is read', 'A B first')
      call v%word('ultimate', self%ultimate, 'rule of the ultimate point', ultimate_choices)
      call v%key('eps_yield', self%eps_yield, '', above_zero, &
                 'strain of the extreme fibre for yield_rule = first')
      call v%key('eps_cover', self%eps_cover, '', above_zero, &
                 'strain of the extreme fibre for ultimate = cover')
      call v%key('confined', self%confined, 'the core is confined and the cover spalls')
      call v%key('moment_factor', self%moment_factor, '', above_zero, &
                 'factor of the yield and ultimate moments')
      call v%key('b0', self%b0, '', not_negative, 'exponent of the unloading stiffness')
      call v%key('d_m', self%d_m, 'rad', above_zero, 'rotation for B_1; without it the ultimate one', &
                 optional=.true.)
   end subroutine visit_springs

   subroutine visit_shear(self, v)
      class(shear_record), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%key('length', self%length, 'm', above_zero, 'shear span M/V')
      call v%key('axial_load', self%axial_load, 'N', any_number, 'axial load, compression positive')
      call v%word('tension', self%tension, 'tension law of the concrete', tension_choices)
      call v%key('confined', self%confined, 'the core is confined and the cover spalls')
      call v%key('coupled', self%coupled, 'shear changes the longitudinal stresses and the moment')
      call v%key('layers', self%layers, '', layer_counts, 'number of layers over the depth')
      call v%key('knee', self%knee, '', knees, 'share of (E_c/2) A of the secant at the knee')
   end subroutine visit_shear

   subroutine visit_layer(self, v)
      class(layer_record), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%key('rho_z', self%rho_z, '', not_negative, 'transverse reinforcement over width and spacing')
      call v%word('tension', self%tension, 'tension law of the concrete', tension_choices)
   end subroutine visit_layer

   !> The rules of the named points; the words must be known.
   pure type(rule_type) function rule_of_diagram(self) result(rule)
      class(diagram_record), intent(in) :: self

      rule = rule_type(place_of(self%yielding, yield_names), place_of(self%ultimate, ultimate_names), &
                       self%eps_yield, self%eps_cover)
   end function rule_of_diagram

   !> How the spring is read; the words must be known.
   pure type(hinge_type) function hinge_of_springs(self) result(hinge)
      class(springs_record), intent(in) :: self

      hinge%length = self%length
      hinge%axial_load = self%axial_load
      hinge%hinge_length = self%hinge_length
      hinge%rule = rule_type(merge(yield_first, yield_tension, self%yield_rule == 'first'), &
                             place_of(self%ultimate, ultimate_names), self%eps_yield, self%eps_cover)
      hinge%stiffened_yield = self%yield_rule == 'B'
      hinge%moment_factor = self%moment_factor
      hinge%confined = self%confined
      hinge%b0 = self%b0
      hinge%d_m = self%d_m
   end function hinge_of_springs

   !> Place of a word in a list, 0 if it is not there.
   pure integer function place_of(word, names) result(place)
      character(len=*), intent(in) :: word
      character(len=*), intent(in) :: names(:)

      place = findloc(names == word, .true., dim=1)
   end function place_of

end module rbs_section_settings_record
