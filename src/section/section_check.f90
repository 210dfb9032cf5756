!> Checks of a section: its sizes and cover, bars inside the concrete, ties.
module rbs_section_section_check
   use rbs_base_error, only: message_list
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_section_cross_section, only: section_type, no_ties
   use rbs_section_shape, only: largest_size
   use rbs_section_steel_law, only: check_steel
   use rbs_base_check, only: check_finite, check_positive, check_not_negative
   implicit none
   private

   public :: check_section

contains

   !> Add a message for every error of a section, except those of its concrete, which `check_concrete` finds.
   subroutine check_section(section, messages)
      type(section_type), intent(in) :: section
      type(message_list), intent(inout) :: messages
      logical :: ok(3)
      integer :: i

      call section%shape%check(messages, ok(1))
      call check_not_negative(section%cover, 'section: cover', 'm', messages, ok(2))
      call check_not_negative(section%side_cover, 'section: side_cover', 'm', messages, ok(3))
      do i = 1, size(section%steels)
         call check_steel(section%steels(i), 'section: steel', messages)
      end do
      if (section%transverse%kind /= no_ties) call check_transverse(section, all(ok), messages)
      if (.not. all(ok)) return
      call check_bars(section, messages)
   end subroutine check_section

   subroutine check_bars(section, messages)
      type(section_type), intent(in) :: section
      type(message_list), intent(inout) :: messages
      logical :: ok, all_ok
      real(wp) :: edge
      integer :: i

      all_ok = .true.
      edge = 0.5_wp*section%shape%depth
      do i = 1, size(section%bar_y)
         call check_positive(section%bar_area(i), 'section: area of bar '//to_text(i), 'm2', messages, ok)
         all_ok = all_ok .and. ok
         call check_finite(section%bar_y(i), 'section: y of bar '//to_text(i), 'm', messages, ok)
         all_ok = all_ok .and. ok
         if (.not. ok) cycle
         if (abs(section%bar_y(i)) < edge) cycle
         call messages%add('section: bar '//to_text(i)//' at y = '//to_text(section%bar_y(i))// &
                           ' m is outside the concrete, which goes from '//to_text(-edge)//' to '// &
                           to_text(edge)//' m; y is measured from mid-depth')
      end do
      if (.not. all_ok) return
      if (sum(section%bar_area) > 0.2_wp*section%shape%area()) then
         call messages%add('section: the area of the bars, '//to_text(sum(section%bar_area))// &
                           ' m2, must be below a fifth of the gross area, '// &
                           to_text(section%shape%area())//' m2; 200 mm2 is 200e-6')
      end if
      if (size(section%bar_y) == 0) return
      call check_positive(section%bar_diameter, 'section: bar_diameter', 'm', messages, ok)
      if (.not. ok) return
      if (section%bar_diameter > 0.075_wp) then
         call messages%add('section: bar_diameter = '//to_text(section%bar_diameter)//' m is larger than '// &
                           'any bar; if the entries of bars are rows, give the bar_diameter of one bar')
      end if
   end subroutine check_bars

   subroutine check_transverse(section, sizes_ok, messages)
      type(section_type), intent(in) :: section
      !> Whether sizes and cover are valid
      logical, intent(in) :: sizes_ok
      type(message_list), intent(inout) :: messages
      logical :: ok(2)

      call check_positive(section%transverse%diameter, 'ties: diameter', 'm', messages, ok(1))
      call check_positive(section%transverse%spacing, 'ties: spacing', 'm', messages, ok(2))
      call check_positive(section%transverse%legs, 'ties: legs', '', messages)
      call check_positive(section%transverse%legs_across, 'ties: legs_across', '', messages)
      call check_steel(section%transverse%steel, 'ties: steel', messages)
      if (.not. (all(ok) .and. sizes_ok)) return
      if (section%transverse%spacing > largest_size) then
         call messages%add('ties: spacing = '//to_text(section%transverse%spacing)//' m is larger '// &
                           'than any column; 100 mm is 0.1')
      end if
      if (min(section%core_shape%depth, section%core_shape%width) > section%transverse%diameter) return
      call messages%add('section: cover = '//to_text(section%cover)//' m and ties of '// &
                        to_text(section%transverse%diameter)//' m leave no core; the cover is measured '// &
                        'to the outer edge of the ties')
   end subroutine check_transverse

end module rbs_section_section_check
