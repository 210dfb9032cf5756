!> Joints of layers (docs/rules.md section 11): equilibrium of the axial load, closed forms, refusals.
module test_layered
   use check, only: unit_test, check_close, check_failed, check_true
   use rbs_base_error, only: bad_input, error_type, message_list
   use rbs_base_kinds, only: wp
   use rbs_structure_column_column, only: column_type
   use rbs_hysteresis_layered_fibre_section, only: fibre_section
   use rbs_hysteresis_layered_layered_joint, only: start_under, carries_axial_load
   use rbs_hysteresis_rule, only: rule_type, rule_memory
   use rbs_hysteresis_segment, only: segment
   use rbs_hysteresis_springs, only: follow_path, spring_array
   use rbs_solve_make_column, only: make_column
   use rbs_structure_column_column_record, only: column_record
   use rbs_hysteresis_spring_record, only: spring_record
   use samples, only: set_value, value_of, bilinear, compression, concrete_1, elastic, steel_1, takeda_1, &
                      random_type
   implicit none
   private

   public :: collect_layered

   !> A section 0.4 m deep: bars at +-0.17 m, strips of concrete between.
   real(wp), parameter :: arm = 0.17_wp, depth = 0.4_wp

   !> A joint, and copies of its layers as separate springs.
   type :: double_joint
      class(rule_type), allocatable :: rule
      class(rule_memory), allocatable :: memory
      type(segment) :: line
      type(spring_array) :: layers
      real(wp), allocatable :: y(:)
      !> Present rotation [rad], axial load [N], initial axial stiffness [N/m]
      real(wp) :: rotation = 0.0_wp, axial_load = 0.0_wp, stiffness = 0.0_wp
      !> Largest errors so far, relative to the largest force of a layer, and to that times the depth
      real(wp) :: axial_fault = 0.0_wp, moment_fault = 0.0_wp, largest = 1.0_wp
      integer :: events = 0
   contains
      procedure :: begin
      procedure :: turn_to
      procedure :: compare
   end type double_joint

contains

   subroutine collect_layered(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('elastic layers: transformed section about its centroid', elastic_section), &
               unit_test('perfectly plastic layers: moment capacity under axial load', capacity), &
               unit_test('joint without tension: axial load times its arm', rocking), &
               unit_test('axial load: carried by the layers at every event', equilibrium), &
               unit_test('virgin joint of an unsymmetric section has no moment', unsymmetric), &
               unit_test('order of the layers does not matter', order), &
               unit_test('a layer cut in two is the same layer', cut_layer), &
               unit_test('initial stiffness is the slope of the first line', first_slope), &
               unit_test('axial load beyond the capacity is refused', refused), &
               unit_test('validation names layer, value and remedy', validation)]
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

   subroutine begin(self, spec)
      class(double_joint), intent(inout) :: self
      type(spring_record), intent(in) :: spec
      type(spring_record) :: layer(size(spec%y))
      integer :: i

      call spec%make(self%rule)
      call start_under(self%rule, spec%axial_load, self%memory, self%line)
      do i = 1, size(layer)
         layer(i) = spec%layer(i)
      end do
      call self%layers%create(layer)
      self%y = spec%y
      self%axial_load = spec%axial_load
      self%rotation = 0.0_wp
      self%axial_fault = 0.0_wp
      self%moment_fault = 0.0_wp
      self%largest = abs(spec%axial_load)
      self%events = 0
      call self%compare()
   end subroutine begin

   !> Rotate in one direction and compare at every event.
   subroutine turn_to(self, rotation)
      class(double_joint), intent(inout) :: self
      real(wp), intent(in) :: rotation
      integer :: direction

      if (.not. abs(rotation - self%rotation) > 0.0_wp) return
      direction = merge(1, -1, rotation > self%rotation)
      do
         if (self%line%unload_on_reversal == -direction) then
            if (direction > 0) self%line%hi = self%rotation
            if (direction < 0) self%line%lo = self%rotation
         else if (direction*(rotation - self%line%end_toward(direction)) < 0.0_wp) then
            exit
         end if
         self%rotation = self%line%end_toward(direction)
         call self%compare()
         call self%rule%next(self%memory, self%line, direction)
         self%events = self%events + 1
         call self%compare()
      end do
      self%rotation = rotation
      call self%compare()
   end subroutine turn_to

   !> Compare the forces of the separate layers with those of the joint.
   subroutine compare(self)
      class(double_joint), intent(inout) :: self
      real(wp) :: force(size(self%y)), d(size(self%y))
      integer :: i

      select type (section => self%memory)
      type is (fibre_section)
         d = section%opening_at(self%rotation, self%axial_load) + self%y*self%rotation
      end select
      call self%layers%move_all(d)
      do i = 1, size(d)
         force(i) = self%layers%force(i)
      end do
      self%largest = max(self%largest, maxval(abs(force)))
      self%axial_fault = max(self%axial_fault, abs(sum(force) + self%axial_load)/self%largest)
      self%moment_fault = max(self%moment_fault, abs(dot_product(self%y, force) - &
                                                     self%line%force(self%rotation))/(self%largest*depth))
   end subroutine compare

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

   !> All layers yield, those beyond the plastic neutral axis in tension. The axis is at a layer that carries
   !> the remaining force.
   subroutine capacity(error)
      type(error_type), allocatable, intent(inout) :: error
      integer, parameter :: n = 21
      real(wp), parameter :: f_y = 1.0e5_wp
      type(spring_record) :: layer(n)
      real(wp) :: y(n), f(2), axial_load, expected, rest
      integer :: i, load, tension

      do i = 1, n
         y(i) = depth*((i - 0.5_wp)/n - 0.5_wp)
         layer(i) = bilinear(1.0e9_wp, f_y/1.0e9_wp, 0.0_wp)
      end do
      do load = -15, 15, 5
         axial_load = (load + 0.5_wp)*f_y
         tension = (n - 1 - load)/2
         rest = -axial_load - f_y*(tension - (n - 1 - tension))
         expected = f_y*(sum(y(n - tension + 1:)) - sum(y(:n - tension - 1))) + rest*y(n - tension)
         call follow_path(joint(axial_load, y, layer), [1.0_wp, -1.0_wp], f)
         call check_close(error, f, expected*[1.0_wp, -1.0_wp], 1.0e-10_wp, 0.0_wp, 'moment')
      end do
   end subroutine capacity

   !> Layers with compression only: the joint opens until it is supported by the last one.
   subroutine rocking(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_record) :: layer(20)
      real(wp) :: y(20), f(3), k, edge
      integer :: i

      do i = 1, 20
         y(i) = depth*((i - 0.5_wp)/20 - 0.5_wp)
         layer(i) = compression(1.0e9_wp/20)
      end do
      call follow_path(joint(2.0e5_wp, y, layer), [1.0e-4_wp, 1.0_wp, 0.0_wp], f)
      k = sum(1.0e9_wp/20*y**2)
      edge = maxval(y)
      call check_close(error, f(1), k*1.0e-4_wp, 1.0e-12_wp, 0.0_wp, 'all closed')
      call check_close(error, f(2), 2.0e5_wp*edge, 1.0e-12_wp, 0.0_wp, 'on the edge')
      call check_close(error, f(3), 0.0_wp, 0.0_wp, 1.0e-8_wp, 'and back')
   end subroutine rocking

   !> Bilinear bars: the separate layers follow the same lines.
   subroutine equilibrium(error)
      type(error_type), allocatable, intent(inout) :: error
      type(double_joint) :: both
      type(random_type) :: random
      type(spring_record) :: spec, bar, layer(14)
      integer :: path, j, events

      events = 0
      bar = bilinear(8.0e8_wp, 9.0e-4_wp, 8.0e6_wp)
      do path = 1, 40
         spec = section(random%uniform(-2.0e5_wp, 1.5e6_wp), 12)
         do j = 1, 12
            layer(j) = spec%layer(j)
         end do
         layer(13:) = bar
         call spec%set_layers(spec%y, layer)
         call both%begin(spec)
         do j = 1, 30
            call both%turn_to(random%uniform(-1.0e-2_wp, 1.0e-2_wp))
         end do
         events = events + both%events
         call check_close(error, both%axial_fault, 0.0_wp, 0.0_wp, 1.0e-9_wp, 'axial force')
         call check_close(error, both%moment_fault, 0.0_wp, 0.0_wp, 1.0e-9_wp, 'moment')
      end do
      call check_true(error, events > 5000, 'many events')
   end subroutine equilibrium

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

   !> A random path of rotations.
   subroutine wander(random, d)
      type(random_type), intent(inout) :: random
      real(wp), intent(out) :: d(:)
      integer :: j

      do j = 1, size(d)
         d(j) = random%uniform(-2.0e-2_wp, 2.0e-2_wp)*j/size(d)
      end do
   end subroutine wander

   subroutine order(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      type(spring_record) :: spec, other, layer(12)
      real(wp) :: d(30), f(30), g(30)
      integer :: path, i

      spec = section(1.0e6_wp, 10)
      other = spec
      do i = size(layer), 1, -1
         layer(size(layer) + 1 - i) = spec%layer(i)
      end do
      call other%set_layers(spec%y(size(layer):1:-1), layer)
      do path = 1, 20
         call wander(random, d)
         call follow_path(spec, d, f)
         call follow_path(other, d, g)
         call check_close(error, g, f, 0.0_wp, 1.0e-9_wp*maxval(abs(f)), 'moment')
      end do
   end subroutine order

   subroutine cut_layer(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      type(spring_record) :: whole, cut
      type(spring_record) :: layer(6)
      real(wp) :: d(30), f(30), g(30), y(6)
      integer :: path, i

      do i = 1, 3
         y(2*i - 1:2*i) = 0.1_wp*(i - 2)
         layer(2*i - 1) = concrete_1(0.125_wp*i)
         layer(2*i) = layer(2*i - 1)
      end do
      cut = joint(2.0e5_wp, y, layer)
      do i = 1, 3
         layer(i) = concrete_1(0.25_wp*i)
      end do
      whole = joint(2.0e5_wp, y([1, 3, 5]), layer(:3))
      do path = 1, 20
         call wander(random, d)
         call follow_path(whole, d, f)
         call follow_path(cut, d, g)
         call check_close(error, g, f, 0.0_wp, 1.0e-9_wp*maxval(abs(f)), 'moment')
      end do
   end subroutine cut_layer

   logical function carries(spec)
      type(spring_record), intent(in) :: spec
      class(rule_type), allocatable :: rule

      call spec%make(rule)
      carries = carries_axial_load(rule, spec%axial_load)
   end function carries

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

   subroutine refused(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      class(column_type), allocatable :: column
      type(spring_record) :: strip(4)
      real(wp), parameter :: y(4) = [-0.15_wp, -0.05_wp, 0.05_wp, 0.15_wp]
      integer :: i

      do i = 1, 4
         strip(i) = concrete_1(0.25_wp)
      end do
      ! Concrete alone carries 4.8 MN, and no tension.
      call check_true(error, carries(joint(4.79e6_wp, y, strip)), 'below its strength')
      call check_true(error, .not. carries(joint(4.81e6_wp, y, strip)), 'above its strength')
      call check_true(error, .not. carries(joint(-1.0_wp, y, strip)), 'tension')
      call check_true(error, carries(section(-1.3e6_wp, 10)), 'tension on bars')
      call check_true(error, carries(takeda_1('kc')), 'another rule')
      spec%height = 1.6_wp
      spec%mass = 600.0_wp
      spec%shear = [elastic(1.0e9_wp)]
      allocate (spec%flexure(1))
      spec%flexure(1) = joint(0.0_wp, y, strip)
      spec%axial_load = 4.81e6_wp
      call make_column(spec, column, outcome)
      call check_failed(error, outcome, bad_input, 'cannot carry the axial load of 4.81e+06 N')
   end subroutine refused

   subroutine validation(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_record) :: spec, wrong

      call expect(error, section(1.0e6_wp, 10), '')
      spec%rule = 'layered'
      spec%axial_load = 0.0_wp
      call expect(error, spec, 'the layers are missing; give at least two')
      call expect(error, joint(0.0_wp, [0.1_wp], [elastic(1.0_wp)]), 'give at least two')
      spec = joint(0.0_wp, [0.1_wp, 0.2_wp], [elastic(1.0_wp), takeda_1('kc')])
      call expect(error, spec, &
                  "layer 2 has the rule 'takeda'; it is one of elastic, bilinear, compression")
      wrong = steel_1()
      call set_value(wrong, 'k_post', value_of(wrong, 'k'))
      call expect(error, joint(0.0_wp, [0.1_wp, 0.2_wp], [steel_1(), wrong]), &
                  'layer 2: k_post = 8e+08 must be below k = 8e+08')
      wrong = concrete_1(1.0_wp)
      call set_value(wrong, 'f_peak', 1.0e7_wp)
      call expect(error, joint(0.0_wp, [0.1_wp, 0.2_wp], [wrong, steel_1()]), &
                  'layer 1: f_peak = 1e+07 must be below k d_peak = 9.6e+06')
   end subroutine validation

   !> The messages of the validation of a spring; empty if it is valid.
   subroutine expect(error, spec, part)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_record), intent(in) :: spec
      character(len=*), intent(in) :: part
      type(error_type), allocatable :: outcome
      type(message_list) :: messages

      call spec%validate('joint', messages)
      call messages%raise(outcome)
      if (part == '') then
         call check_true(error, .not. allocated(outcome), 'valid')
      else
         call check_failed(error, outcome, bad_input, part)
      end if
   end subroutine expect

end module test_layered
