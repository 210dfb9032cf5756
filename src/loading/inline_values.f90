!> Values that are given in the case itself.
module rbs_loading_inline_values
   use rbs_base_check, only: is_given
   use rbs_base_kinds, only: wp
   use rbs_base_units, only: unit_type, to_si
   use rbs_loading_loading_record, only: loading_record, units_of
   implicit none
   private

   public :: inline_values

contains

   !> Times and values of a loading with source = 'values'.
   subroutine inline_values(spec, time, value)
      !> Validated loading
      type(loading_record), intent(in) :: spec
      !> Times (m) [s]; if none are given, the number of each point
      real(wp), allocatable, intent(out) :: time(:)
      !> Values (m) [m, N or m/s2]
      real(wp), allocatable, intent(out) :: value(:)
      type(unit_type), allocatable :: units(:)
      real(wp) :: interval
      integer :: i

      value = spec%values*spec%scale
      allocate (units, source=units_of(spec%drive))
      do i = 1, size(units)
         if (spec%unit == units(i)%name) value = to_si(value, units(i))
      end do
      if (allocated(spec%time)) then
         time = spec%time
         return
      end if
      interval = 1.0_wp
      if (is_given(spec%interval)) interval = spec%interval
      time = [((i - 1)*interval, i=1, size(value))]
   end subroutine inline_values

end module rbs_loading_inline_values
