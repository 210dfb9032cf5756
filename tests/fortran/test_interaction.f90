!> Layered joints under an axial load that varies (docs/interaction.md): points by hand and from an
!> independent return mapping, independence of increments, energy, loss of the axial load.
module test_interaction
   use check, only: unit_test, check_close, check_true
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_layered_fibre_path, only: go
   use rbs_hysteresis_layered_fibre_section, only: fibre_section
   use rbs_hysteresis_layered_layered_joint, only: start_under
   use rbs_hysteresis_rule, only: rule_type, rule_memory
   use rbs_hysteresis_segment, only: segment
   use rbs_hysteresis_spring_record, only: spring_record
   use samples, only: bilinear, compression, random_type
   implicit none
   private

   public :: collect_interaction

   !> Layers of an unsymmetric joint: distance, stiffness, yield deformation, stiffness after yield.
   real(wp), parameter :: unsymmetric(4, 4) = reshape( &
                          [-0.15_wp, 8.0e8_wp, 1.5e-3_wp, 1.6e7_wp, -0.06_wp, 5.0e8_wp, 1.0e-3_wp, 5.0e6_wp, &
                           0.03_wp, 5.0e8_wp, 1.0e-3_wp, 5.0e6_wp, 0.15_wp, 6.0e8_wp, 2.0e-3_wp, 1.2e7_wp], &
                               [4, 4])
   !> Distances of four equal layers.
   real(wp), parameter :: four(4) = [-3.0_wp, -1.0_wp, 1.0_wp, 3.0_wp]

contains

   subroutine collect_interaction(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('four contacts, by hand', contacts), &
               unit_test('bilinear layers, against an independent return mapping', bilinear_layers), &
               unit_test('work of the layers is that of moment and axial load', energy), &
               unit_test('a closed path returns its work or takes some', closed_paths)]
   end subroutine collect_interaction

   !> A joint under an axial load at the start.
   subroutine make_joint(joint, axial_load, y, layer, line, rule)
      class(rule_memory), allocatable, intent(out) :: joint
      real(wp), intent(in) :: axial_load, y(:)
      type(spring_record), intent(in) :: layer(:)
      type(segment), intent(out) :: line
      class(rule_type), allocatable, intent(out) :: rule
      type(spring_record) :: spec

      spec%rule = 'layered'
      call spec%set_layers(y, layer)
      call spec%make(rule)
      call start_under(rule, axial_load, joint, line)
   end subroutine make_joint

   !> The unsymmetric joint.
   subroutine make_unsymmetric(joint, axial_load, line, rule)
      class(rule_memory), allocatable, intent(out) :: joint
      real(wp), intent(in) :: axial_load
      type(segment), intent(out) :: line
      class(rule_type), allocatable, intent(out) :: rule
      type(spring_record) :: layer(4)
      integer :: i

      do i = 1, 4
         layer(i) = bilinear(unsymmetric(2, i), unsymmetric(3, i), unsymmetric(4, i))
      end do
      call make_joint(joint, axial_load, unsymmetric(1, :), layer, line, rule)
   end subroutine make_unsymmetric

   !> Opening, moment, and work of the layers after a straight way to a point.
   subroutine visit(joint, rotation, axial_load, opening, moment, work)
      class(rule_memory), intent(inout) :: joint
      real(wp), intent(in) :: rotation, axial_load
      real(wp), intent(out) :: opening, moment
      !> Work of the moment, added to [J]
      real(wp), intent(inout) :: work
      real(wp) :: unused(4)

      opening = 0.0_wp
      moment = 0.0_wp
      select type (joint)
      type is (fibre_section)
         call go(joint, rotation, axial_load, work)
         opening = joint%opening_at(rotation, axial_load)
         call joint%read_plane(unused(1), unused(2), moment, unused(3), unused(4))
      end select
   end subroutine visit

   !> Points of the paths of shared notes, each reached on a straight way from the one before.
   subroutine check_points(error, joint, points)
      type(error_type), allocatable, intent(inout) :: error
      class(rule_memory), intent(inout) :: joint
      !> Rotation, axial load, opening, moment (4, points)
      real(wp), intent(in) :: points(:, :)
      real(wp) :: opening, moment, work
      integer :: j

      work = 0.0_wp
      do j = 1, size(points, 2)
         call visit(joint, points(1, j), points(2, j), opening, moment, work)
         call check_close(error, opening, points(3, j), 1.0e-9_wp, 1.0e-12_wp, 'opening')
         call check_close(error, moment, points(4, j), 1.0e-9_wp, 1.0e-9_wp*maxval(abs(points(4, :))), &
                          'moment')
      end do
   end subroutine check_points

   subroutine contacts(error)
      type(error_type), allocatable, intent(inout) :: error
      class(rule_memory), allocatable :: joint
      type(segment) :: line
      class(rule_type), allocatable :: rule
      real(wp), parameter :: points(4, 6) = reshape( &
                             [0.0_wp, 8.0_wp, -1.0_wp/50.0_wp, 0.0_wp, 0.01_wp, 8.0_wp, -1.0_wp/60.0_wp, &
                                 16.0_wp, &
                              0.02_wp, 4.0_wp, 1.0_wp/50.0_wp, 12.0_wp, 0.02_wp, 12.0_wp, -1.0_wp/50.0_wp, &
                                  28.0_wp, &
                              -0.01_wp, 7.0_wp, -1.0_wp/75.0_wp, -15.0_wp, &
                              0.0_wp, 0.5_wp, -1.0_wp/800.0_wp, 0.0_wp], [4, 6])
      type(spring_record) :: layer(4)

      layer = compression(100.0_wp)
      call make_joint(joint, 8.0_wp, four, layer, line, rule)
      call check_points(error, joint, points)
   end subroutine contacts

   subroutine bilinear_layers(error)
      type(error_type), allocatable, intent(inout) :: error
      class(rule_memory), allocatable :: joint
      type(segment) :: line
      class(rule_type), allocatable :: rule
      !> Rotations counted from the layers without load
      real(wp), parameter :: points(4, 7) = reshape( &
                             [0.006_wp, 4.0e5_wp, -5.4166666667e-05_wp, 2.0493750000e+05_wp, &
                              0.012_wp, 9.0e5_wp, -4.0731489741e-04_wp, 3.3636768599e+05_wp, &
                              -0.004_wp, 1.2e6_wp, -8.3231489741e-04_wp, -1.8450731401e+05_wp, &
                              -0.015_wp, 3.0e5_wp, -7.1933130972e-04_wp, -3.8428613266e+05_wp, &
                              -0.015_wp, 1.0e6_wp, -1.2063224154e-03_wp, -3.1394608088e+05_wp, &
                              0.02_wp, -2.0e5_wp, 4.7088016094e-04_wp, 3.9822044665e+05_wp, &
                              0.0_wp, 5.0e5_wp, -1.9578650573e-04_wp, -2.4677955335e+05_wp], [4, 7])
      real(wp), parameter :: rest = -2.279202279e-4_wp
      real(wp) :: from_rest(4, 7)

      call make_unsymmetric(joint, 4.0e5_wp, line, rule)
      from_rest = points
      from_rest(1, :) = points(1, :) - rest
      call check_points(error, joint, from_rest)
   end subroutine bilinear_layers

   !> Along a straight piece of the path both products integrate exactly by small steps of the trapezoidal
   !> rule.
   subroutine energy(error)
      type(error_type), allocatable, intent(inout) :: error
      class(rule_memory), allocatable :: joint
      type(segment) :: line
      class(rule_type), allocatable :: rule
      real(wp) :: opening, moment, work, before(2), of_load, of_moment, stored
      integer, parameter :: steps = 2000
      integer :: i
      type(spring_record) :: layer(4)

      layer = compression(100.0_wp)
      call make_joint(joint, 8.0_wp, four, layer, line, rule)
      work = 0.0_wp
      of_load = 0.0_wp
      call visit(joint, 0.0_wp, 8.0_wp, opening, moment, work)
      before = [opening, 8.0_wp]
      do i = 1, steps
         associate (load => 8.0_wp + 4.0_wp*i/steps)
            call visit(joint, 0.02_wp*i/steps, load, opening, moment, work)
            of_load = of_load - 0.5_wp*(load + before(2))*(opening - before(1))
            before = [opening, load]
         end associate
      end do
      of_moment = work
      ! Contacts are elastic: 2/25 at (0, 8) and 2/5 at (0.02, 12), by hand.
      stored = 2.0_wp/5.0_wp - 2.0_wp/25.0_wp
      call check_close(error, of_moment + of_load, stored, 1.0e-6_wp, 0.0_wp, 'work')
   end subroutine energy

   !> A second pass through the same closed path gives no energy.
   subroutine closed_paths(error)
      type(error_type), allocatable, intent(inout) :: error
      class(rule_memory), allocatable :: joint
      type(segment) :: line
      class(rule_type), allocatable :: rule
      type(random_type) :: random
      real(wp) :: points(2, 5), opening, moment, first_pass, work, of_load, before(2)
      integer :: path, pass, j, i
      integer, parameter :: steps = 50

      do path = 1, 200
         call make_unsymmetric(joint, 3.0e5_wp, line, rule)
         do j = 1, 5
            points(:, j) = [random%uniform(-1.0e-2_wp, 1.0e-2_wp), random%uniform(-3.0e5_wp, 1.0e6_wp)]
         end do
         points(:, 5) = points(:, 1)
         work = 0.0_wp
         of_load = 0.0_wp
         first_pass = 0.0_wp
         call visit(joint, points(1, 1), points(2, 1), opening, moment, work)
         do pass = 1, 2
            work = 0.0_wp
            of_load = 0.0_wp
            before = [opening, points(2, 1)]
            do j = 2, 5
               do i = 1, steps
                  associate (to => points(:, j - 1) + (points(:, j) - points(:, j - 1))*i/steps)
                     call visit(joint, to(1), to(2), opening, moment, work)
                     of_load = of_load - 0.5_wp*(to(2) + before(2))*(opening - before(1))
                     before = [opening, to(2)]
                  end associate
               end do
            end do
         end do
         call check_true(error, work + of_load > -1.0e-3_wp*3.0e5_wp*1.0e-2_wp, 'no energy is won')
      end do
   end subroutine closed_paths

end module test_interaction
