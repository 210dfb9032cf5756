!> Shear force and shear strain of a section that bends under a constant axial load: V = M/a with the shear
!> span a, layer by layer with the modified compression field theory.
!>
!> For each curvature the section in flexure gives the longitudinal strain and the shear stress of each layer,
!> from which its shear strain follows; gamma is the mean of these over the area, so that an uncracked section
!> of concrete has V = (E_c/2) A gamma exactly.
module rbs_section_shear_diagram
   use rbs_base_error, only: error_type, message_list
   use rbs_base_constants, only: unset
   use rbs_base_key_visitor, only: key_visitor, visited_record
   use rbs_base_keys, only: above_zero, any_number, bound_type, check_number, key_type
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_section_balance, only: state_type, begin, advance
   use rbs_section_concrete_law, only: tension_choices, tension_place
   use rbs_section_mcft_layer, only: layer_type, layer_state, solve_layer
   use rbs_section_resultants, only: section_laws
   use rbs_section_cross_section, only: section_type, cut_strips, side_of
   use rbs_section_shear_flow, only: flow_type, begin_flow, shear_stresses, transverse_ratio, couple
   implicit none
   private

   public :: shear_record, shear_point, shear_diagram_type, follow_shear, check_curvatures

   !> Layers over the depth.
   integer, parameter :: default_layers = 80

   !> The shear spring leaves its first branch where V/gamma has fallen to this share of (E_c/2) A;
   !> calibrated on table 3 of the paper, whose columns have 0.41 to 0.53.
   real(wp), parameter :: default_knee = 0.48_wp

   integer, parameter :: fewest_layers = 4, most_layers = 10000

   type(bound_type), parameter :: layer_counts = bound_type(real(fewest_layers, wp), real(most_layers, wp))
   type(bound_type), parameter :: knees = &
      bound_type(0.0_wp, 1.0_wp, least_open=.true., most_open=.true., reason='(uncracked it is 1)')

   integer, parameter :: most_bisections = 40

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
      procedure :: visit
   end type shear_record

   !> A point of the diagram: curvature [1/m], moment [N m], shear force [N], shear strain.
   type :: shear_point
      real(wp) :: curvature = 0.0_wp, moment = 0.0_wp, force = 0.0_wp, strain = 0.0_wp
   end type shear_point

   type :: shear_diagram_type
      !> The points at the given curvatures, as far as the section carries them
      type(shear_point), allocatable :: points(:)
      !> Where the secant has fallen to the share of the knee
      type(shear_point) :: knee
      logical :: knee_found = .false.
      !> The last point: at the last curvature, or where a layer or the section fails
      type(shear_point) :: last
      !> Whether a layer no longer carries the shear (if coupled: whether equilibrium is lost), and whether
      !> the section no longer carries its axial load
      logical :: sheared = .false., lost = .false.
      !> The layers at the last point, from the compression face on: y [m], longitudinal strain (tension
      !> positive), shear stress [Pa], shear strain and transverse strain
      real(wp), allocatable :: y(:), eps_x(:), tau(:), gamma(:), eps_z(:)
   end type shear_diagram_type

   !> Data that are constant along the diagram.
   type :: model_type
      type(flow_type) :: flow
      type(layer_type), allocatable :: layers(:)
      !> [N]
      real(wp) :: axial_load = 0.0_wp
      !> Whether shear changes the longitudinal stress and the moment
      logical :: coupled = .false.
   end type model_type

   !> State at a point of the diagram.
   type :: shear_state
      type(state_type) :: flexure
      type(layer_state), allocatable :: layers(:)
      type(shear_point) :: point
   end type shear_state

contains

   !> The keys of a shear diagram.
   subroutine visit(self, v)
      class(shear_record), intent(inout) :: self
      type(key_visitor), intent(inout) :: v

      call v%key('length', self%length, 'm', above_zero, 'shear span M/V')
      call v%key('axial_load', self%axial_load, 'N', any_number, 'axial load, compression positive')
      call v%word('tension', self%tension, 'tension law of the concrete', tension_choices)
      call v%key('confined', self%confined, 'the core is confined and the cover spalls')
      call v%key('coupled', self%coupled, 'shear changes the longitudinal stresses and the moment')
      call v%key('layers', self%layers, '', layer_counts, 'number of layers over the depth')
      call v%key('knee', self%knee, '', knees, 'share of (E_c/2) A of the secant at the knee')
   end subroutine visit

   !> Follow the diagram along increasing curvatures.
   subroutine follow_shear(section, record, curvature, diagram, error)
      type(section_type), intent(in) :: section
      type(shear_record), intent(in) :: record
      !> Positive and increasing [1/m]
      real(wp), intent(in) :: curvature(:)
      type(shear_diagram_type), intent(out) :: diagram
      type(error_type), allocatable, intent(out) :: error
      type(model_type) :: model
      type(shear_state) :: last, here
      type(shear_point), allocatable :: points(:)
      real(wp) :: knee_stiffness
      integer :: i, count
      logical :: sheared, lost

      call prepare(here)
      if (allocated(error)) return
      knee_stiffness = record%knee*0.5_wp*section%plain%ec*section%shape%area()
      allocate (points(size(curvature)))
      count = 0
      do i = 1, size(curvature)
         last = here
         call bend(curvature(i), here, sheared, lost)
         if (sheared .or. lost) then
            diagram%sheared = sheared
            diagram%lost = lost
            ! The last point that is carried lies between the last curvature and this one.
            here = last
            call halve(curvature(i), 1.0e-4_wp, here)
         end if
         if (.not. diagram%knee_found .and. beyond_knee(here%point, knee_stiffness)) then
            diagram%knee_found = .true.
            diagram%knee = here%point
            ! The knee lies between the last curvature and this one.
            call halve(here%point%curvature, 1.0e-9_wp, last, knee_stiffness, diagram%knee)
         end if
         if (sheared .or. lost) exit
         count = i
         points(i) = here%point
      end do
      diagram%points = points(:count)
      diagram%last = here%point
      diagram%y = model%flow%section%strips%y
      diagram%eps_x = here%layers%eps_x
      diagram%tau = here%layers%tau
      diagram%gamma = here%layers%gamma
      diagram%eps_z = here%layers%eps_z

   contains

      !> Cut the section into layers (sets `model`) and apply its axial load.
      subroutine prepare(state)
         type(shear_state), intent(out) :: state
         integer :: i

         model%axial_load = record%axial_load
         model%coupled = record%coupled
         model%flow%section = section
         call cut_strips(section%shape, section%core_shape, record%layers, model%flow%section%strips)
         model%flow%laws = section_laws(section, tension_place(record%tension), record%confined)
         model%flow%span = record%length
         allocate (model%layers(record%layers), state%layers(record%layers))
         associate (cut => model%flow%section, laws => model%flow%laws)
            do i = 1, record%layers
               model%layers(i)%concrete = laws%shell
               if (2.0_wp*cut%strips%core_area(i) > cut%strips%area(i)) then
                  model%layers(i)%concrete = laws%core(side_of(cut%strips%y(i)))
               end if
               model%layers(i)%stirrup = section%transverse%steel
               model%layers(i)%rho_z = transverse_ratio(cut, cut%strips%y(i), &
                            cut%strips%area(i)/cut%strips%dy)
            end do
            call begin(cut, laws, record%axial_load, state%flexure, error)
         end associate
         if (allocated(error)) return
         call begin_flow(model%flow, state%flexure)
      end subroutine prepare

      !> Bend the section to a larger curvature [1/m] and solve its layers.
      subroutine bend(curvature, state, sheared, lost)
         real(wp), intent(in) :: curvature
         type(shear_state), intent(inout) :: state
         !> Whether a layer no longer carries the shear, or if coupled the equilibrium is lost; whether the
         !> section no longer carries its axial load
         logical, intent(out) :: sheared, lost
         real(wp) :: tau(size(state%layers)), eps_x
         logical :: carried
         integer :: i

         sheared = .false.
         lost = .false.
         if (model%coupled) then
            call couple(model%flow, model%layers, model%axial_load, curvature, state%flexure, state%layers, &
                        carried)
            sheared = .not. carried
            if (sheared) return
         else
            call advance(model%flow%section, model%flow%laws, model%axial_load, curvature, state%flexure, &
                         carried)
            lost = .not. carried
            if (lost) return
            call shear_stresses(model%flow, state%flexure, tau)
            do i = 1, size(tau)
               eps_x = curvature*model%flow%section%strips%y(i) - state%flexure%eps0
               call solve_layer(model%layers(i), eps_x, tau(i), state%layers(i), carried)
               sheared = .not. carried
               if (sheared) return
            end do
         end if
         associate (area => model%flow%section%strips%area)
            state%point = shear_point(curvature, state%flexure%moment, state%flexure%moment/model%flow%span, &
                                      dot_product(state%layers%gamma, area)/sum(area))
         end associate
      end subroutine bend

      !> Halve the step to the last state that the section carries or, with a knee, that is before the knee.
      subroutine halve(above, tolerance, state, stiffness, knee)
         !> A curvature beyond that state [1/m]; length of the last step, as a share of the curvature
         real(wp), intent(in) :: above, tolerance
         !> A state that is carried; on return the last one
         type(shear_state), intent(inout) :: state
         !> Secant at the knee [N], and the first point found beyond it
         real(wp), intent(in), optional :: stiffness
         type(shear_point), intent(inout), optional :: knee
         type(shear_state) :: here
         real(wp) :: high, middle
         integer :: i
         logical :: sheared, lost, beyond

         high = above
         do i = 1, most_bisections
            if (high - state%point%curvature <= tolerance*high) exit
            middle = 0.5_wp*(state%point%curvature + high)
            here = state
            call bend(middle, here, sheared, lost)
            beyond = sheared .or. lost
            if (present(knee) .and. .not. beyond) then
               beyond = beyond_knee(here%point, stiffness)
               if (beyond) knee = here%point
            end if
            if (beyond) then
               high = middle
            else
               state = here
            end if
         end do
      end subroutine halve

   end subroutine follow_shear

   !> Whether the secant V/gamma is at or below that of the knee.
   elemental logical function beyond_knee(point, stiffness)
      type(shear_point), intent(in) :: point
      !> Secant at the knee [N]
      real(wp), intent(in) :: stiffness

      beyond_knee = point%strain > 0.0_wp .and. point%force <= stiffness*point%strain
   end function beyond_knee

   !> Add a message unless the curvatures are positive and increase.
   subroutine check_curvatures(curvature, messages)
      !> [1/m]
      real(wp), intent(in) :: curvature(:)
      type(message_list), intent(inout) :: messages
      real(wp) :: before
      logical :: ok
      integer :: i

      if (size(curvature) == 0) call messages%add('shear: curvature is empty; give at least one')
      before = 0.0_wp
      ok = .true.
      do i = 1, size(curvature)
         call check_number(curvature(i), 'shear', &
                           key_type('curvature '//to_text(i), unit='1/m', bound=above_zero), messages, ok)
         if (.not. ok) return
         if (curvature(i) <= before) then
            call messages%add('shear: curvature '//to_text(i)//' = '//to_text(curvature(i))//' 1/m is '// &
                              'not above the one before it; they must rise')
            return
         end if
         before = curvature(i)
      end do
   end subroutine check_curvatures

end module rbs_section_shear_diagram
