!> Units of history files; inside the program everything is SI.
module rbs_base_units
   use rbs_base_kinds, only: wp
   use rbs_base_constants, only: standard_gravity
   implicit none
   private

   public :: unit_type, length_units, force_units, acceleration_units, to_si

   !> A unit by name.
   type :: unit_type
      character(len=8) :: name
      !> SI units in one of it
      real(wp) :: factor
   end type unit_type

   type(unit_type), parameter :: length_units(4) = [ &
      unit_type('m', 1.0_wp), unit_type('mm', 1.0e-3_wp), unit_type('cm', 1.0e-2_wp), &
      unit_type('in', 0.0254_wp)]

   type(unit_type), parameter :: force_units(4) = [ &
      unit_type('N', 1.0_wp), unit_type('kN', 1.0e3_wp), unit_type('MN', 1.0e6_wp), &
      unit_type('kip', 4448.2216152605_wp)]

   type(unit_type), parameter :: acceleration_units(4) = [ &
      unit_type('m/s2', 1.0_wp), unit_type('g', standard_gravity), &
      unit_type('cm/s2', 1.0e-2_wp), unit_type('mm/s2', 1.0e-3_wp)]

contains

   !> A value in SI. Millimetres and the like are divided by a whole number, which rounds once; a factor
   !> of 0.001 is itself rounded.
   elemental real(wp) function to_si(value, unit)
      real(wp), intent(in) :: value
      type(unit_type), intent(in) :: unit

      if (unit%factor < 1.0_wp .and. abs(nint(1.0_wp/unit%factor)*unit%factor - 1.0_wp) < 1.0e-15_wp) then
         to_si = value/nint(1.0_wp/unit%factor)
      else
         to_si = value*unit%factor
      end if
   end function to_si

end module rbs_base_units
