!> Units of input and output; inside the program all values are in SI.
module rbs_base_units
   use rbs_base_kinds, only: wp
   use rbs_base_constants, only: standard_gravity
   implicit none
   private

   public :: unit_type, unit_system, length_units, force_units, mass_units, acceleration_units, to_si, &
             unit_named

   !> A unit by name.
   type :: unit_type
      character(len=8) :: name
      !> Its value in SI units
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

   type(unit_type), parameter :: mass_units(2) = [unit_type('kg', 1.0_wp), unit_type('t', 1.0e3_wp)]

   !> The units of a case file.
   type :: unit_system
      type(unit_type) :: force = force_units(1), length = length_units(1), mass = mass_units(1)
   contains
      procedure :: is_si, into_si, out_of_si, name_of
   end type unit_system

contains

   !> The unit of a name; the first one, that of SI, if the name is blank or not in the list.
   pure type(unit_type) function unit_named(units, name) result(unit)
      type(unit_type), intent(in) :: units(:)
      character(len=*), intent(in) :: name

      unit = units(max(1, findloc(units%name == name, .true., dim=1)))
   end function unit_named

   !> A value in a unit, converted to SI.
   elemental real(wp) function to_si(value, unit)
      real(wp), intent(in) :: value
      type(unit_type), intent(in) :: unit

      to_si = scaled(value, unit, 1)
   end function to_si

   !> A value times the factor of a unit, or divided by it. Values in small units, such as millimetres, are
   !> divided by a whole number, which rounds once; a factor of 0.001 would itself be rounded.
   elemental real(wp) function scaled(value, unit, power)
      real(wp), intent(in) :: value
      type(unit_type), intent(in) :: unit
      !> +1: to SI, -1: from SI
      integer, intent(in) :: power
      real(wp) :: whole

      whole = nint(1.0_wp/unit%factor)
      if (unit%factor < 1.0_wp .and. abs(whole*unit%factor - 1.0_wp) < 1.0e-15_wp) then
         if (power > 0) scaled = value/whole
         if (power < 0) scaled = value*whole
      else
         if (power > 0) scaled = value*unit%factor
         if (power < 0) scaled = value/unit%factor
      end if
   end function scaled

   !> Whether the units are those of SI, so that nothing is converted.
   pure logical function is_si(self)
      class(unit_system), intent(in) :: self

      is_si = self%force%name == 'N' .and. self%length%name == 'm' .and. self%mass%name == 'kg'
   end function is_si

   !> A value in the units of the user, converted to SI.
   elemental real(wp) function into_si(self, value, unit)
      class(unit_system), intent(in) :: self
      real(wp), intent(in) :: value
      !> The SI unit, of N, m, kg, s and rad: 'N/m', 'N m/rad', 'kg m2', 'm4'; stresses in Pa stay
      character(len=*), intent(in) :: unit

      into_si = converted(self, value, unit, 1)
   end function into_si

   !> A value in SI, converted to the units of the user.
   elemental real(wp) function out_of_si(self, value, unit)
      class(unit_system), intent(in) :: self
      real(wp), intent(in) :: value
      !> The SI unit, as in `into_si`
      character(len=*), intent(in) :: unit

      out_of_si = converted(self, value, unit, -1)
   end function out_of_si

   !> A value converted by each unit of force, length and mass in its unit, with its power: that of m in
   !> 'kg m2' is 2.
   elemental real(wp) function converted(self, value, unit, direction)
      class(unit_system), intent(in) :: self
      real(wp), intent(in) :: value
      !> The SI unit, of N, m, kg, s and rad: 'N/m', 'kg m2'
      character(len=*), intent(in) :: unit
      !> +1: to SI, -1: from SI
      integer, intent(in) :: direction
      type(unit_type) :: one
      integer :: i, k, power
      logical :: found

      converted = value
      power = direction
      ! Seconds keep their unit, and accelerations and work have units of their own.
      if (unit == 'm/s2' .or. unit == 'J') return
      do i = 1, len_trim(unit)
         if (unit(i:i) == '/') power = -direction
         call unit_of_letter(self, unit, i, one, found)
         if (.not. found) cycle
         converted = scaled(converted, one, power)
         if (i == len(unit)) cycle
         do k = 2, index('1234', unit(i + 1:i + 1))        ! m2, m4
            converted = scaled(converted, one, power)
         end do
      end do
   end function converted

   !> The unit of the user for character i of an SI unit, if the character means one: 'N' in 'N m', but not
   !> 'r' in 'rad'. The mass is known by its k: 'kg'.
   pure subroutine unit_of_letter(self, unit, i, one, found)
      class(unit_system), intent(in) :: self
      character(len=*), intent(in) :: unit
      integer, intent(in) :: i
      type(unit_type), intent(out) :: one
      logical, intent(out) :: found

      found = .true.
      one = length_units(1)
      select case (unit(i:i))
      case ('N')
         one = self%force
      case ('m')
         one = self%length
      case ('k')
         one = self%mass
      case default
         found = .false.
      end select
   end subroutine unit_of_letter

   !> The name of an SI unit in the units of the user: 'kN/mm' for 'N/m'.
   pure character(len=32) function name_of(self, unit) result(name)
      class(unit_system), intent(in) :: self
      character(len=*), intent(in) :: unit
      type(unit_type) :: one
      integer :: i
      logical :: found

      name = ''
      ! Accelerations and work have units of their own.
      if (unit == 'm/s2' .or. unit == 'J') name = unit
      if (name /= '') return
      do i = 1, len_trim(unit)
         call unit_of_letter(self, unit, i, one, found)
         if (found) then
            name = trim(name)//one%name
         else if (i > 1 .and. unit(i:i) == 'g') then
            ! The g of kg: k has named the unit of mass.
            cycle
         else
            name = trim(name)//unit(i:i)
         end if
      end do
   end function name_of

end module rbs_base_units
