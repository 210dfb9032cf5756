!> A section as two plain arrays, one of whole numbers and one of reals, in which Python passes it.
!>
!> Whole numbers: shape, kind of ties, numbers of strips, steels and bars; place of the steel of each bar.
!> Reals: the scalars in the order of `section_from_numbers`, five of each steel, y and area of each bar.
!> The Python side is `rbsdem.section.section`.
module rbs_bindings_section_arrays
   use, intrinsic :: iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type, message_list
   use rbs_base_kinds, only: wp
   use rbs_section_section_check, only: check_section
   use rbs_section_concrete_law, only: check_concrete, plain_concrete
   use rbs_section_confinement, only: volumetric_ratio
   use rbs_section_events, only: point_type
   use rbs_section_flexural_spring, only: flexural_spring_type
   use rbs_section_cross_section, only: enclose_core, section_type, no_ties
   use rbs_section_section_build, only: build_section
   use rbs_section_shapes, only: new_shape
   use rbs_section_steel_law, only: steel_type
   implicit none
   private

   public :: section_from_numbers, figures_of_section, point_numbers, spring_figures

   integer, parameter :: codes_before = 5, scalars = 19, steel_size = 5

contains

   !> Validate a section and make it.
   subroutine section_from_numbers(section, codes, numbers, error)
      type(section_type), intent(out) :: section
      integer(c_int), intent(in) :: codes(:)
      real(c_double), intent(in) :: numbers(:)
      type(error_type), allocatable, intent(out) :: error
      type(message_list) :: messages
      integer :: steels, bars, at, i

      steels = codes(4)
      bars = codes(5)
      call new_shape(int(codes(1)), numbers(1), numbers(2), section%shape)
      section%cover = numbers(3)
      section%side_cover = numbers(4)
      section%bar_diameter = numbers(5)
      section%transverse%kind = codes(2)
      section%transverse%diameter = numbers(11)
      section%transverse%spacing = numbers(12)
      section%transverse%legs = numbers(13)
      section%transverse%legs_across = numbers(14)
      section%transverse%steel = steel_of(numbers(15:19))
      allocate (section%steels(steels))
      do i = 1, steels
         at = scalars + (i - 1)*steel_size
         section%steels(i) = steel_of(numbers(at + 1:at + steel_size))
      end do
      at = scalars + steels*steel_size
      allocate (section%bar_y(bars), section%bar_area(bars))
      section%bar_steel = codes(codes_before + 1:codes_before + bars)
      section%bar_y = numbers(at + 1:at + bars)
      section%bar_area = numbers(at + bars + 1:at + 2*bars)

      call check_concrete(numbers(6), numbers(7), numbers(8), numbers(9), numbers(10), messages)
      call enclose_core(section)
      call check_section(section, messages)
      call messages%raise(error)
      if (allocated(error)) return
      section%plain = plain_concrete(numbers(6), numbers(7), numbers(8), numbers(9))
      call build_section(section, numbers(10), int(codes(3)))
   end subroutine section_from_numbers

   pure type(steel_type) function steel_of(numbers)
      !> fy, fu, es, eps_sh, eps_u
      real(c_double), intent(in) :: numbers(steel_size)

      steel_of = steel_type(numbers(1), numbers(2), numbers(3), numbers(4), numbers(5))
   end function steel_of

   !> Derived values: fc, ft, ec, eps0, n, decay; the same of the core with eps_cu; k_e, f_l, rho_s; width and
   !> depth of the core.
   subroutine figures_of_section(section, figures)
      type(section_type), intent(in) :: section
      real(c_double), intent(out) :: figures(15)

      figures = 0.0_c_double
      associate (p => section%plain, c => section%core)
         figures(1:6) = [p%fc, p%ft, p%ec, p%eps0, p%n, p%decay]
         figures(7:10) = [c%fc, c%eps0, c%n, c%eps_cu]
      end associate
      figures(11:13) = [section%effectiveness, section%lateral_stress, volumetric_ratio(section)]
      if (section%transverse%kind == no_ties) return
      figures(14:15) = [section%core_shape%width, section%core_shape%depth]
   end subroutine figures_of_section

   !> Curvature, moment, strain at mid-depth and whether it was found (1) or not (0).
   pure function point_numbers(point) result(numbers)
      type(point_type), intent(in) :: point
      real(c_double) :: numbers(4)

      numbers = [point%curvature, point%moment, point%eps0, merge(1.0_wp, 0.0_wp, point%found)]
   end function point_numbers

   !> Values of a fitted spring in the order of its type.
   pure function spring_figures(spring) result(numbers)
      type(flexural_spring_type), intent(in) :: spring
      real(c_double) :: numbers(10)

      numbers = [spring%k_c, spring%d_c, spring%k_y, spring%d_y, spring%k_u, spring%b0, spring%b1, &
                 spring%k_u_found, spring%hinge_length, spring%d_m]
   end function spring_figures

end module rbs_bindings_section_arrays
