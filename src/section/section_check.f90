!> Checks of what belongs together in a section: bars inside the concrete, their area, a core inside the ties.
module rbs_section_section_check
   use rbs_base_error, only: message_list
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_section_cross_section, only: section_type, no_ties
   implicit none
   private

   public :: check_section

   !> The thinnest bar, that of a small model, and the thickest [m].
   real(wp), parameter :: thinnest = 0.003_wp, thickest = 0.075_wp

contains

   !> Add a message for every error of a section whose values are valid one by one.
   subroutine check_section(section, messages)
      type(section_type), intent(in) :: section
      type(message_list), intent(inout) :: messages

      if (section%transverse%kind /= no_ties) then
         call check_core(section, messages)
      else
         call check_cover(section, messages)
      end if
      if (size(section%bar_y) > 0) call check_bars(section, messages)
   end subroutine check_section

   subroutine check_bars(section, messages)
      type(section_type), intent(in) :: section
      type(message_list), intent(inout) :: messages
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
      else if (section%bar_diameter > thickest) then
         call messages%add('section: bar_diameter = '//to_text(section%bar_diameter)//' m is larger than '// &
                           'any bar; if the entries of bars are rows, give the bar_diameter of one bar')
      end if
   end subroutine check_bars

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

   !> Without hoops the cover still leaves something inside.
   subroutine check_cover(section, messages)
      type(section_type), intent(in) :: section
      type(message_list), intent(inout) :: messages

      if (section%cover < 0.5_wp*section%shape%depth .and. &
          section%side_cover < 0.5_wp*section%shape%width) return
      call messages%add('section: cover = '//to_text(section%cover)//' m, side_cover = '// &
                        to_text(section%side_cover)//' m leave nothing of the section; 20 mm is 0.02')
   end subroutine check_cover

end module rbs_section_section_check
