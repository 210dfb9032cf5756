!> Makes a section from what is given of it.
module rbs_section_section_build
   use rbs_base_check, only: is_given
   use rbs_base_error, only: error_type, message_list
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_section_confinement, only: confine
   use rbs_section_cross_section, only: enclose_core, no_ties, section_type, slice, spiral, circular_hoops
   use rbs_section_section_record, only: find_steel, section_record
   use rbs_section_shape, only: new_core, shape_type, thickest_bar
   implicit none
   private

   public :: make_section, build_section, outline_core

   !> The thinnest bar, that of a small model [m].
   real(wp), parameter :: thinnest = 0.003_wp

contains

   !> Validate what is given and make the section.
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
      call check_section()
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
         allocate (section%steels(size(record%steels)))
         do i = 1, size(record%steels)
            section%steels(i) = record%steels(i)%law()
         end do
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

      !> Add a message for every error of a section whose values are valid one by one.
      subroutine check_section()

         if (section%transverse%kind /= no_ties) then
            call check_core(section, messages)
         else
            call check_cover()
         end if
         if (size(section%bar_y) > 0) call check_bars()
      end subroutine check_section

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

      !> Without hoops the cover still leaves something inside.
      subroutine check_cover()

         if (section%cover < 0.5_wp*section%shape%depth .and. &
             section%side_cover < 0.5_wp*section%shape%width) return
         call messages%add('section: cover = '//to_text(section%cover)//' m, side_cover = '// &
                           to_text(section%side_cover)//' m leave nothing of the section; 20 mm is 0.02')
      end subroutine check_cover

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
      call slice(section, strips)
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

end module rbs_section_section_build
