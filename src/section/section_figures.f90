!> Figures of a section and of points of its diagrams, with their names.
module rbs_section_section_figures
   use rbs_base_kinds, only: wp
   use rbs_section_confinement, only: volumetric_ratio
   use rbs_section_cross_section, only: no_ties, section_type
   use rbs_section_events, only: point_type
   use rbs_section_shear_diagram, only: shear_point
   implicit none
   private

   public :: figures_of_section, values_of_point, values_of_shear_point

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

contains

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

end module rbs_section_section_figures
