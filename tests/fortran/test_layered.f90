!> Joints of layers (docs/rules.md section 11): closed forms. The rules once more, another way:
!> tests/python/test_layered_reference.py.
module test_layered
   use check, only: unit_test, check_close, check_true
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_springs, only: follow_path
   use rbs_hysteresis_spring_record, only: spring_record
   use samples, only: concrete_1, elastic, steel_1
   implicit none
   private

   public :: collect_layered

   !> A section 0.4 m deep: bars at +-0.17 m, strips of concrete between.
   real(wp), parameter :: arm = 0.17_wp, depth = 0.4_wp

contains

   subroutine collect_layered(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('elastic layers: transformed section about its centroid', elastic_section), &
               unit_test('virgin joint of an unsymmetric section has no moment', unsymmetric), &
               unit_test('initial stiffness is the slope of the first line', first_slope)]
   end subroutine collect_layered

   !> A joint from distances and springs.
   function joint(axial_load, y, layer) result(spec)
      real(wp), intent(in) :: axial_load, y(:)
      type(spring_record), intent(in) :: layer(:)
      type(spring_record) :: spec

      spec%rule = 'layered'
      spec%axial_load = axial_load
      call spec%set_layers(y, layer)
   end function joint

   !> Reinforced concrete: `strips` of concrete_1 over the depth, two rows of bars.
   function section(axial_load, strips) result(spec)
      real(wp), intent(in) :: axial_load
      integer, intent(in) :: strips
      type(spring_record) :: spec
      type(spring_record) :: layer(strips + 2)
      real(wp) :: y(strips + 2)
      integer :: i

      do i = 1, strips
         y(i) = depth*((i - 0.5_wp)/strips - 0.5_wp)
         layer(i) = concrete_1(1.0_wp/strips)
      end do
      y(strips + 1:) = [-arm, arm]
      layer(strips + 1) = steel_1()
      layer(strips + 2) = steel_1()
      spec = joint(axial_load, y, layer)
   end function section

   !> Layers of a transformed section: EI about the centroid, over the length of the joint.
   subroutine elastic_section(error)
      type(error_type), allocatable, intent(inout) :: error
      integer, parameter :: n = 100
      real(wp), parameter :: ea = 1.2e9_wp, ea_bar = 2.0e8_wp
      type(spring_record) :: layer(n + 1)
      real(wp) :: y(n + 1), f(2), centroid, ei
      integer :: i

      do i = 1, n
         y(i) = depth*((i - 0.5_wp)/n - 0.5_wp)
         layer(i) = elastic(ea/n)
      end do
      y(n + 1) = arm
      layer(n + 1) = elastic(ea_bar)
      call follow_path(joint(3.0e5_wp, y, layer), [1.0e-3_wp, -2.0e-3_wp], f)
      ! A strip has no second moment h^2/12 of its own: an error of 1/n^2 of the whole.
      centroid = ea_bar*arm/(ea + ea_bar)
      ei = ea*(depth**2/12.0_wp*(1.0_wp - 1.0_wp/n**2) + centroid**2) + ea_bar*(arm - centroid)**2
      call check_close(error, f, ei*[1.0e-3_wp, -2.0e-3_wp], 1.0e-11_wp, 0.0_wp, 'moment')
   end subroutine elastic_section

   !> Bars on one side only: the joint rotates under the axial load alone, and measures from there.
   subroutine unsymmetric(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_record) :: layer(9)
      real(wp) :: y(9), f(4)
      integer :: i

      do i = 1, 8
         y(i) = depth*((i - 0.5_wp)/8 - 0.5_wp)
         layer(i) = concrete_1(1.0_wp/8)
      end do
      y(9) = arm
      layer(9) = steel_1()
      call follow_path(joint(1.0e6_wp, y, layer), [0.0_wp, 1.0e-2_wp, -1.0e-2_wp, 0.0_wp], f)
      call check_close(error, f(1), 0.0_wp, 0.0_wp, 1.0e-6_wp, 'at rest')
      call check_true(error, abs(f(2) + f(3)) > 0.1_wp*f(2), 'the bars pull on one side')
   end subroutine unsymmetric

   subroutine first_slope(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_record) :: spec
      real(wp) :: f(1)

      spec = section(0.0_wp, 10)
      call follow_path(spec, [1.0e-9_wp], f)
      call check_true(error, f(1)/1.0e-9_wp < spec%initial_stiffness(), 'concrete without load opens')
      spec = joint(0.0_wp, [-arm, arm, 0.0_wp], [elastic(1.0_wp), elastic(2.0_wp), elastic(3.0_wp)])
      call follow_path(spec, [1.0_wp], f)
      call check_close(error, spec%initial_stiffness(), f(1), 1.0e-14_wp, 0.0_wp, 'slope')
   end subroutine first_slope

end module test_layered
