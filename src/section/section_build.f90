!> Makes a section from what is given of it.
module rbs_section_section_build
   use rbs_base_check, only: is_given
   use rbs_base_error, only: error_type, message_list
   use rbs_base_kinds, only: wp
   use rbs_section_confinement, only: confine
   use rbs_section_cross_section, only: enclose_core, no_ties, section_type, slice, spiral, circular_hoops
   use rbs_section_section_check, only: check_section
   use rbs_section_section_record, only: find_steel, section_record
   use rbs_section_shape, only: new_core, shape_type
   implicit none
   private

   public :: make_section, build_section, outline_core

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
      call take_data(record, section)
      call enclose_core(section)
      call check_section(section, messages)
      call messages%raise(error)
      if (.not. allocated(error)) call build_section(section, record%concrete%eps_spall, record%strips)
   end subroutine make_section

   !> Copy the data of a valid record.
   subroutine take_data(record, section)
      type(section_record), intent(in) :: record
      type(section_type), intent(inout) :: section
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
