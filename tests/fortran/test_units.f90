!> Numbers with units: exact decimals, and the unit of a spring's parameter by its group.
module test_units
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
   use check, only: unit_test, check_close, check_equal, check_same, check_true
   use rbs_base_check, only: is_given
   use rbs_base_constants, only: unset, standard_gravity
   use rbs_base_error, only: error_type
   use rbs_base_keys, only: deformation, force, stiffness
   use rbs_base_kinds, only: wp
   use rbs_base_units, only: unit_system, unit_type, to_si, length_units, force_units, acceleration_units
   use rbs_case_group_reader, only: unit_in_group
   implicit none
   private

   public :: collect_units

contains

   subroutine collect_units(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('unset differs from every number and from NaN', given), &
               unit_test('exact decimals', units)]
   end subroutine collect_units

   subroutine given(error)
      type(error_type), allocatable, intent(inout) :: error

      call check_true(error, .not. is_given(unset), 'unset is not given')
      call check_true(error, all(is_given([0.0_wp, -1.0_wp, huge(1.0_wp)])), 'numbers are given')
      call check_true(error, is_given(ieee_value(1.0_wp, ieee_quiet_nan)), 'a NaN is given')
   end subroutine given

   subroutine units(error)
      type(error_type), allocatable, intent(inout) :: error
      type(unit_type) :: unit
      type(unit_system) :: system
      integer :: i

      ! 0.017*0.001 and 0.017e-3 are different numbers.
      call check_same(error, to_si(0.017_wp, length_units(2)), 0.017e-3_wp, '0.017 mm')
      call check_same(error, to_si(97.854_wp, length_units(2)), 97.854e-3_wp, '97.854 mm')
      call check_same(error, to_si(1.23_wp, length_units(3)), 1.23e-2_wp, '1.23 cm')
      call check_same(error, to_si(2.0_wp, length_units(4)), 0.0508_wp, '2 in')
      call check_same(error, to_si(-3.3_wp, length_units(1)), -3.3_wp, '-3.3 m')
      call check_same(error, to_si(120.5_wp, force_units(2)), 120500.0_wp, '120.5 kN')
      call check_close(error, to_si(1.0_wp, force_units(4)), 0.45359237e3_wp*standard_gravity, &
                       1.0e-13_wp, 0.0_wp, '1 kip')
      call check_same(error, to_si(0.5_wp, acceleration_units(2)), 4.903325_wp, '0.5 g')
      do i = 1, size(length_units)
         unit = length_units(i)
         call check_same(error, to_si(0.0_wp, unit), 0.0_wp, '0 '//trim(unit%name))
      end do
      system%force = force_units(2)
      system%length = length_units(2)
      call check_same(error, system%into_si(2.0_wp, 'N/m'), 2.0e6_wp, '2 kN/mm')
      call check_same(error, system%out_of_si(2.0e6_wp, 'N/m'), 2.0_wp, '2 kN/mm and back')
      call check_same(error, system%into_si(3.0_wp, 'N m/rad'), 3.0_wp, '3 kN mm/rad')
      call check_same(error, system%out_of_si(3.0_wp, 'N m/rad'), 3.0_wp, '3 kN mm/rad and back')
      call check_equal(error, trim(unit_in_group(force, 'flexure')), 'N m', 'a moment')
      call check_equal(error, trim(unit_in_group(force, 'shear')), 'N', 'a force')
      call check_equal(error, trim(unit_in_group(stiffness, 'flexure')), 'N m/rad', 'against rotation')
      call check_equal(error, trim(unit_in_group(stiffness, 'axial_spring')), 'N/m', 'against opening')
      call check_equal(error, trim(unit_in_group(deformation, 'flexure')), 'rad', 'a rotation')
      call check_equal(error, trim(unit_in_group(deformation, 'layer_spring')), 'm', 'an opening')
   end subroutine units

end module test_units
