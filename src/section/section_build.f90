!> Makes a section from its record.
!>
!> Figures of a section and of points of its diagrams, with their names.
!>
!> Confinement of the core by hoops, ties or a spiral (Mander, Priestley, Park 1988, ASCE 114(8)).
!>
!> The lateral stress is the mean of both directions, with the arches between the bars of each face. The
!> layered hinge (`python/rbsdem/section/strips.py`) takes the stress of the direction of loading alone and
!> spreads the held bars evenly around the core; it has its own formula, as its parameters are fitted with it.
module rbs_section_section_build
   use rbs_base_check, only: is_given
   use rbs_base_error, only: error_type, message_list
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_section_concrete_law, only: confined_concrete, spalling_concrete
   use rbs_section_cross_section, only: enclose_core, no_ties, section_type, cut_strips, spiral, &
                                        circular_hoops, hoop_area
   use rbs_section_events, only: point_type
   use rbs_section_section_record, only: find_steel, section_record
   use rbs_section_shape, only: new_core, shape_type, thickest_bar
   use rbs_section_shear_diagram, only: shear_point
   implicit none
   private

   public :: make_section, build_section, outline_core, figures_of_section, values_of_point, &
             values_of_shear_point, confine, volumetric_ratio

   !> Area, second moment about the centroid and shear area of the outline [m2, m4, m2], distance of the
   !> centroid from mid-depth [m]; law of the plain concrete [Pa]; then the confined core with its sizes [m],
   !> zero without hoops.
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

   !> Validate the record and make the section.
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
      if (section%transverse%kind /= no_ties) then
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

      !> Copy the data of a valid record.
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
      call confine(section, eps_spall)
      call cut_strips(section%shape, section%core_shape, strips, section%strips)
   end subroutine build_section

   subroutine check_core(section, messages)
      type(section_type), intent(in) :: section
      type(message_list), intent(inout) :: messages

      associate (core => section%core_shape, hoops => section%transverse)
         if (min(core%depth, core%width) > hoops%diameter) then
            call check_legs('legs', hoops%legs, core%width)
            call check_legs('legs_across', hoops%legs_across, core%depth)
         else
            call messages%add('section: cover = '//to_text(section%cover)//' m and ties of '// &
                              to_text(hoops%diameter)//' m leave no core; the cover is measured '// &
                              'to the outer edge of the ties')
         end if
      end associate

   contains

      !> Side by side the legs fill no more than the core and the outer halves of two of them.
      subroutine check_legs(name, legs, core)
         character(len=*), intent(in) :: name
         real(wp), intent(in) :: legs, core

         if ((legs - 1.0_wp)*section%transverse%diameter <= core) return
         call messages%add('ties: '//name//' = '//to_text(legs)//' bars of '// &
                           to_text(section%transverse%diameter)//' m do not fit into a core of '// &
                           to_text(core)//' m; give fewer, or thinner ones')
      end subroutine check_legs
   end subroutine check_core

   !> The core alone, of a valid record; its hoops may be taken as round.
   subroutine outline_core(record, round, core)
      type(section_record), intent(in) :: record
      !> Whether the hoops are round although they are given as ties
      logical, intent(in) :: round
      type(shape_type), allocatable, intent(inout) :: core
      real(wp) :: side, tie

      side = record%cover
      if (is_given(record%side_cover)) side = record%side_cover
      tie = 0.0_wp
      if (record%hoops%kind /= no_ties) tie = record%hoops%diameter
      call new_core(record%shape, round .or. any(record%hoops%kind == [spiral, circular_hoops]), &
                    2.0_wp*side + tie, 2.0_wp*record%cover + tie, core)
   end subroutine outline_core

   !> In the order of `section_figures`.
   pure function figures_of_section(section) result(figures)
      type(section_type), intent(in) :: section
      real(wp) :: figures(size(section_figures))

      figures = 0.0_wp
      associate (shape => section%shape, p => section%plain, c => section%core)
         figures(:10) = [shape%area(), shape%second_moment(), shape%shear_area(), shape%centroid(), &
                        p%fc, p%ft, p%ec, p%eps0, p%n, p%decay]
         if (section%transverse%kind == no_ties) return
         figures(11:) = [c%fc, c%eps0, c%n, c%eps_cu, section%effectiveness, section%lateral_stress, &
                         volumetric_ratio(section), section%core_shape%width, section%core_shape%depth]
      end associate
   end function figures_of_section

   !> In the order of `point_values`; found is 1 or 0.
   pure function values_of_point(point) result(values)
      type(point_type), intent(in) :: point
      real(wp) :: values(size(point_values))

      values = [point%curvature, point%moment, point%eps0, merge(1.0_wp, 0.0_wp, point%found)]
   end function values_of_point

   !> In the order of `shear_values`.
   pure function values_of_shear_point(point) result(values)
      type(shear_point), intent(in) :: point
      real(wp) :: values(size(shear_values))

      values = [point%curvature, point%moment, point%force, point%strain]
   end function values_of_shear_point

   !> Set the laws of core and cover, the lateral stress and its effectiveness. Hoops around a void do not
   !> confine the walls between them: the inner ones bow into the void.
   pure subroutine confine(section, eps_spall)
      type(section_type), intent(inout) :: section
      !> Strain at which the cover has spalled
      real(wp), intent(in) :: eps_spall
      real(wp) :: ratio, eps_cu, yield

      section%core = section%plain
      section%shell = section%plain
      section%lateral_stress = 0.0_wp
      section%effectiveness = 0.0_wp
      if (section%transverse%kind == no_ties) return
      if (.not. min(section%core_shape%width, section%core_shape%depth) > 0.0_wp) return
      if (.not. section%shape%hollow) section%effectiveness = effectiveness(section)
      ratio = volumetric_ratio(section)
      yield = section%transverse%steel%fy
      ! The ratio is the sum of both directions; half of it is their mean.
      section%lateral_stress = 0.5_wp*section%effectiveness*ratio*yield
      section%core = confined_concrete(section%plain, section%lateral_stress, 0.0_wp)
      eps_cu = 0.004_wp + 1.4_wp*ratio*yield*section%transverse%steel%eps_u/section%core%fc
      section%core%eps_cu = eps_cu
      section%shell = spalling_concrete(section%plain, eps_spall)
   end subroutine confine

   !> Volume of transverse steel over that of the core: the sum of both directions. A round hoop has two legs
   !> in each, which gives its 4 A/(d s).
   pure real(wp) function volumetric_ratio(section) result(ratio)
      type(section_type), intent(in) :: section

      ratio = 0.0_wp
      if (section%transverse%kind == no_ties) return
      associate (t => section%transverse, core => section%core_shape)
         ratio = t%legs*hoop_area(t)/(t%spacing*core%width) + &
                 t%legs_across*hoop_area(t)/(t%spacing*core%depth)
      end associate
   end function volumetric_ratio

   !> k_e: the share of the core that is confined halfway between two hoops.
   pure real(wp) function effectiveness(section) result(k_e)
      type(section_type), intent(in) :: section
      real(wp) :: b_c, d_c, clear, part, core

      b_c = section%core_shape%width
      d_c = section%core_shape%depth
      core = section%core_shape%area()
      clear = max(0.0_wp, section%transverse%spacing - section%transverse%diameter)
      part = max(0.0_wp, 1.0_wp - 0.5_wp*clear/d_c)
      select case (section%transverse%kind)
      case (spiral)
         k_e = part
      case (circular_hoops)
         k_e = part**2
      case default
         k_e = part*max(0.0_wp, 1.0_wp - 0.5_wp*clear/b_c)
         k_e = k_e*max(0.0_wp, 1.0_wp - arches(section, b_c, d_c)/(6.0_wp*core))
      end select
      k_e = min(1.0_wp, k_e/(1.0_wp - min(0.5_wp, sum(section%bar_area)/core)))
   end function effectiveness

   !> Sum of the squares of the clear distances, around the core, between the bars that legs hold [m2].
   !> A leg holds one bar at each of its ends; between two such bars the concrete forms an arch.
   pure real(wp) function arches(section, b_c, d_c)
      type(section_type), intent(in) :: section
      !> Core between hoop centre lines [m]
      real(wp), intent(in) :: b_c, d_c
      real(wp) :: inset, gaps, clear

      inset = section%transverse%diameter + section%bar_diameter
      gaps = max(1.0_wp, section%transverse%legs - 1.0_wp)
      clear = max(0.0_wp, (b_c - inset)/gaps - section%bar_diameter)
      arches = 2.0_wp*gaps*clear**2
      gaps = max(1.0_wp, section%transverse%legs_across - 1.0_wp)
      clear = max(0.0_wp, (d_c - inset)/gaps - section%bar_diameter)
      arches = arches + 2.0_wp*gaps*clear**2
   end function arches

end module rbs_section_section_build
