!> Makes a section from its record.
!>
!> Figures of a section and of points of its diagrams, with their names.
module rbs_section_section_build
   use rbs_base_check, only: is_given
   use rbs_base_error, only: error_type, message_list
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_section_concrete_law, only: confined_concrete, spalling_concrete
   use rbs_section_confinement, only: confinement_of, form_of_diagram, hooped_core, no_ties, ties, &
                                      transverse_type
   use rbs_section_cross_section, only: enclose_core, hooped_core_of, section_type, cut_strips, side_of
   use rbs_section_events, only: point_type
   use rbs_section_section_record, only: find_steel, section_record, side_names
   use rbs_section_shape, only: thickest_bar
   use rbs_section_shear_diagram, only: shear_point
   implicit none
   private

   public :: make_section, build_section, figures_of_section, values_of_point, values_of_shear_point

   !> Area, second moment about the centroid and shear area of the outline [m2, m4, m2], distance of the
   !> centroid from mid-depth [m]; law of the plain concrete [Pa]; then the confined core with its sizes [m],
   !> that of a wall at y < 0, zero without hoops.
   character(len=16), parameter, public :: section_figures(19) = [character(len=16) :: &
      'area', 'inertia', 'shear_area', 'centroid', 'fc', 'ft', 'ec', 'eps0', 'n', 'decay', 'fcc', 'eps_cc', &
      'r', 'eps_cu', 'effectiveness', 'lateral_stress', 'ratio', 'width', 'depth']

   !> Points of a moment-curvature diagram [1/m, N m].
   character(len=16), parameter, public :: point_values(4) = [character(len=16) :: &
      'curvature', 'moment', 'strain', 'found']

   !> Points of a shear diagram [1/m, N m, N]; its layers at the last point [m, Pa].
   character(len=16), parameter, public :: shear_values(4) = [character(len=16) :: &
      'curvature', 'moment', 'force', 'strain']
   character(len=16), parameter, public :: profile_values(5) = [character(len=16) :: &
      'y', 'eps_x', 'tau', 'gamma', 'eps_z']

   !> The thinnest bar, that of a small model [m].
   real(wp), parameter :: thinnest = 0.003_wp

contains

   !> Validate the record and make the section. Every fault gets a message in `messages`; the section is built
   !> only without any.
   subroutine make_section(record, section, error)
      type(section_record), intent(inout) :: record
      type(section_type), intent(out) :: section
      type(error_type), allocatable, intent(out) :: error
      type(message_list) :: messages

      call record%validate(messages)
      call messages%raise(error)
      if (allocated(error)) return
      call take_data()
      call enclose_core(section)
      if (section%shape%walled) then
         call check_wall(section, messages)
      else if (section%transverse%kind /= no_ties) then
         call check_core(section, messages)
      else if (section%cover >= 0.5_wp*section%shape%depth .or. &
               section%side_cover >= 0.5_wp*section%shape%width) then
         call messages%add('section: cover = '//to_text(section%cover)//' m, side_cover = '// &
                           to_text(section%side_cover)//' m leave nothing of the section; 20 mm is 0.02')
      end if
      if (size(section%bar_y) > 0) call check_bars()
      call messages%raise(error)
      if (.not. allocated(error)) call build_section(section, record%concrete%eps_spall, record%strips)

   contains

      !> Copy the data of a valid record into the section.
      subroutine take_data()
         integer :: bars, i

         allocate (section%shape, source=record%shape)
         section%cover = record%cover
         section%side_cover = record%cover
         if (is_given(record%side_cover)) section%side_cover = record%side_cover
         if (is_given(record%bar_diameter)) section%bar_diameter = record%bar_diameter
         section%plain = record%concrete%law()
         section%steels = [(record%steels(i)%law(), i=1, size(record%steels))]
         bars = 0
         if (allocated(record%bars%y)) bars = size(record%bars%y)
         allocate (section%bar_y(bars), section%bar_area(bars), section%bar_steel(bars))
         if (bars > 0) then
            section%bar_y(:) = record%bars%y
            section%bar_area(:) = record%bars%area
            section%bar_steel(:) = [(find_steel(record, record%bars%steel(i)), i=1, bars)]
         end if
         if (section%shape%walled) call take_boundaries()
         associate (given => record%hoops, hoops => section%transverse)
            if (given%kind == no_ties) return
            hoops%kind = given%kind
            hoops%diameter = given%diameter
            hoops%spacing = given%spacing
            hoops%legs = given%legs
            hoops%legs_across = merge(given%legs_across, given%legs, is_given(given%legs_across))
            hoops%steel = record%steels(find_steel(record, given%steel))%law()
         end associate
      end subroutine take_data

      !> Outline and hoops at the ends of a wall.
      subroutine take_boundaries()
         integer :: i, side

         section%shape%end_width = section%shape%width
         if (.not. allocated(record%boundaries)) return
         do i = 1, size(record%boundaries)
            associate (given => record%boundaries(i))
               do side = 1, 2
                  ! Not on this side if the record names the other one; 'both' is none of the two.
                  if (given%side == side_names(3 - side)) cycle
                  section%shape%end_length(side) = given%length
                  if (is_given(given%thickness)) section%shape%end_width(side) = given%thickness
                  if (.not. is_given(given%hoop_diameter)) cycle
                  section%boundary(side) = transverse_type(ties, given%hoop_diameter, given%hoop_spacing, &
                                                           given%legs_along, given%legs_across)
                  section%boundary(side)%steel = record%steels(find_steel(record, given%steel))%law()
               end do
            end associate
         end do
      end subroutine take_boundaries

      !> Check that bars are inside of the concrete and do not fill it.
      subroutine check_bars()
         real(wp) :: edge
         integer :: i

         edge = 0.5_wp*section%shape%depth
         do i = 1, size(section%bar_y)
            if (abs(section%bar_y(i)) < edge) cycle
            call messages%add('section: bar '//to_text(i)//' at y = '//to_text(section%bar_y(i))// &
                              ' m is outside the concrete, which goes from '//to_text(-edge)//' to '// &
                              to_text(edge)//' m; y is measured from mid-depth')
         end do
         if (sum(section%bar_area) > 0.2_wp*section%shape%area()) then
            call messages%add('section: the area of the bars, '//to_text(sum(section%bar_area))// &
                              ' m2, must be below a fifth of the gross area, '// &
                              to_text(section%shape%area())//' m2; 200 mm2 is 200e-6')
         end if
         if (.not. section%bar_diameter > 0.0_wp) then
            call messages%add('section: bar_diameter is missing; give it a value in m')
         else if (section%bar_diameter < thinnest) then
            call messages%add('section: bar_diameter = '//to_text(section%bar_diameter)//' m is thinner '// &
                              'than any bar; a diameter is in m and no area: 20 mm is 0.02')
         else if (section%bar_diameter > thickest_bar) then
            call messages%add('section: bar_diameter = '// &
                              to_text(section%bar_diameter)//' m is larger than '// &
                              'any bar; if the entries of bars are rows, give the bar_diameter of one bar')
         end if
      end subroutine check_bars

   end subroutine make_section

   !> Complete a section whose shape, cover, hoops, bars and plain concrete are set and checked.
   subroutine build_section(section, eps_spall, strips)
      type(section_type), intent(inout) :: section
      !> Strain at which the cover has spalled
      real(wp), intent(in) :: eps_spall
      !> Number of strips
      integer, intent(in) :: strips

      call enclose_core(section)
      section%bar_in_core = abs(section%bar_y) <= 0.5_wp*section%core_shape%depth
      if (section%shape%walled) then
         associate (core => section%core_shape, side => side_of(section%bar_y))
            ! Within half the length of the core from its middle, which lies inset from the end of the wall.
            section%bar_in_core = abs(abs(section%bar_y) - 0.5_wp*core%depth + core%end_inset(side) + &
                                      0.5_wp*core%end_length(side)) <= 0.5_wp*core%end_length(side)
         end associate
      end if
      call confine(section, eps_spall)
      call cut_strips(section%shape, section%core_shape, strips, section%strips)
   end subroutine build_section

   !> Check that hoops leave a core and fit it.
   subroutine check_core(section, messages)
      type(section_type), intent(in) :: section
      type(message_list), intent(inout) :: messages

      associate (core => section%core_shape, hoops => section%transverse)
         if (min(core%depth, core%width) > hoops%diameter) then
            call check_legs('ties: legs', hoops, hoops%legs, core%width, messages)
            call check_legs('ties: legs_across', hoops, hoops%legs_across, core%depth, messages)
         else
            call messages%add('section: cover = '//to_text(section%cover)//' m and ties of '// &
                              to_text(hoops%diameter)//' m leave no core; the cover is measured '// &
                              'to the outer edge of the ties')
         end if
      end associate

   end subroutine check_core

   !> Side by side the legs fill no more than the core and the outer halves of two of them.
   subroutine check_legs(name, hoops, legs, core, messages)
      !> Group and key, for the message: 'ties: legs'
      character(len=*), intent(in) :: name
      type(transverse_type), intent(in) :: hoops
      !> Number of legs; size of the core between the centre lines of the outer ones [m]
      real(wp), intent(in) :: legs, core
      type(message_list), intent(inout) :: messages

      if ((legs - 1.0_wp)*hoops%diameter <= core) return
      call messages%add(name//' = '//to_text(legs)//' bars of '//to_text(hoops%diameter)// &
                        ' m do not fit into a core of '//to_text(core)//' m; give fewer, or thinner ones')
   end subroutine check_legs

   !> Check that boundary elements fit into the wall, and their hoops into them.
   subroutine check_wall(section, messages)
      type(section_type), intent(in) :: section
      type(message_list), intent(inout) :: messages
      integer :: side

      associate (shape => section%shape, core => section%core_shape)
         if (shape%width > shape%depth) then
            call messages%add('wall: thickness = '//to_text(shape%width)//' m is more than the length, '// &
                              to_text(shape%depth)//' m; draw it as a column')
         end if
         do side = 1, 2
            if (.not. shape%end_length(side) > 0.0_wp) cycle
            if (shape%end_length(side) > 0.5_wp*shape%depth) then
               call messages%add('wall: boundary length '//to_text(shape%end_length(side))// &
                                 ' m is more than half of '//to_text(shape%depth)//' m')
            end if
            if (shape%end_width(side) < shape%width) then
               call messages%add('wall: boundary thickness '//to_text(shape%end_width(side))// &
                                 ' m must not be below that of the web, '//to_text(shape%width)//' m')
            end if
            if (section%boundary(side)%kind == no_ties) cycle
            if (min(core%end_width(side), core%end_length(side)) > section%boundary(side)%diameter) then
               call check_legs('boundary: legs_along', section%boundary(side), section%boundary(side)%legs, &
                               core%end_width(side), messages)
               call check_legs('boundary: legs_across', section%boundary(side), &
                               section%boundary(side)%legs_across, core%end_length(side), messages)
            else
               call messages%add('wall: cover = '//to_text(section%cover)//' m and hoops of '// &
                                 to_text(section%boundary(side)%diameter)//' m leave no core in a '// &
                                 'boundary of '//to_text(shape%end_length(side))//' m; the cover is '// &
                                 'measured to the outer edge of the hoops')
            end if
         end do
      end associate
   end subroutine check_wall

   !> The figures of a section in the order of `section_figures`.
   pure function figures_of_section(section) result(figures)
      type(section_type), intent(in) :: section
      real(wp) :: figures(size(section_figures))
      type(hooped_core) :: core

      figures = 0.0_wp
      associate (shape => section%shape, p => section%plain, c => section%core(1))
         figures(:10) = [shape%area(), shape%second_moment(), shape%shear_area(), shape%centroid(), &
                        p%fc, p%ft, p%ec, p%eps0, p%n, p%decay]
         if (.not. section%confinement(1)%ratio > 0.0_wp) return
         core = hooped_core_of(section, 1)
         figures(11:) = [c%fc, c%eps0, c%n, c%eps_cu, section%confinement(1)%effectiveness, &
                         section%confinement(1)%stress, section%confinement(1)%ratio, core%width, core%depth]
      end associate
   end function figures_of_section

   !> A point of a diagram in the order of `point_values`; found is 1 or 0.
   pure function values_of_point(point) result(values)
      type(point_type), intent(in) :: point
      real(wp) :: values(size(point_values))

      values = [point%curvature, point%moment, point%eps0, merge(1.0_wp, 0.0_wp, point%found)]
   end function values_of_point

   !> A point of a shear diagram in the order of `shear_values`.
   pure function values_of_shear_point(point) result(values)
      type(shear_point), intent(in) :: point
      real(wp) :: values(size(shear_values))

      values = [point%curvature, point%moment, point%force, point%strain]
   end function values_of_shear_point

   !> Set confinement and laws of core and cover.
   pure subroutine confine(section, eps_spall)
      type(section_type), intent(inout) :: section
      !> Strain at which the cover has spalled
      real(wp), intent(in) :: eps_spall
      type(hooped_core) :: core
      real(wp) :: eps_cu
      integer :: side

      section%core = section%plain
      section%shell = section%plain
      do side = 1, 2
         core = hooped_core_of(section, side)
         section%confinement(side) = confinement_of(core, form_of_diagram)
         associate (ratio => section%confinement(side)%ratio, steel => core%hoops%steel)
            if (.not. ratio > 0.0_wp) cycle
            section%core(side) = confined_concrete(section%plain, section%confinement(side)%stress, 0.0_wp)
            ! Strain at the first fracture of a hoop (Paulay and Priestley 1992).
            eps_cu = 0.004_wp + 1.4_wp*ratio*steel%fy*steel%eps_u/section%core(side)%fc
            section%core(side)%eps_cu = eps_cu
            section%shell = spalling_concrete(section%plain, eps_spall)
         end associate
      end do
   end subroutine confine

end module rbs_section_section_build
