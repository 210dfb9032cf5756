!> Input that is refused, with messages that name the quantity, its value and the remedy.
module test_case
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan, ieee_positive_inf
   use check, only: unit_test, check_close, check_contains, check_equal, check_failed, check_same, &
                    check_true
   use rbs_base_constants, only: unset, standard_gravity
   use rbs_base_error, only: error_type, message_list, bad_input
   use rbs_base_kinds, only: wp
   use rbs_case_methods, only: methods
   use rbs_structure_column_column, only: column_type
   use rbs_solve_make_column, only: make_column
   use rbs_case_analysis_record, only: analysis_record
   use rbs_case_case_record, only: case_record
   use rbs_base_check, only: is_given
   use rbs_structure_column_column_record, only: column_record, most_bodies, most_dense
   use rbs_loading_loading_record, only: loading_record, units_of
   use rbs_hysteresis_spring_record, only: spring_record
   use rbs_base_keys, only: deformation, force, stiffness
   use rbs_case_group_reader, only: unit_in_group
   use rbs_base_units, only: unit_system, unit_type, to_si, length_units, force_units, acceleration_units
   use samples, only: set_value, elastic, bilinear, takeda, bilinear_1, takeda_1, column_1, chain, k_c, &
                      d_c, k_y, d_y, k_u, s_k
   implicit none
   private

   public :: collect_case

contains

   subroutine collect_case(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('unset differs from every number and from NaN', given), &
               unit_test('the springs of table 3 are valid', springs_valid), &
               unit_test('spring: unknown rule', spring_rule), &
               unit_test('spring: elastic', spring_elastic), &
               unit_test('spring: bilinear', spring_bilinear), &
               unit_test('spring: takeda, single parameters', spring_takeda_numbers), &
               unit_test('spring: takeda, order of the parameters', spring_takeda_order), &
               unit_test('spring: limits of the rules are valid', spring_limits), &
               unit_test('spring: NaN and infinity in every parameter', spring_not_finite), &
               unit_test('spring: beyond the range of the arithmetic', spring_range), &
               unit_test('spring: initial stiffness', spring_stiffness), &
               unit_test('column: valid ones', column_valid), &
               unit_test('column: single numbers', column_numbers), &
               unit_test('column: lengths and masses', column_parts), &
               unit_test('column: number of springs', column_springs), &
               unit_test('column: loads that follow need finite rotations', column_follows), &
               unit_test('column: mass at the top, rotary inertia', column_inertia), &
               unit_test('column: damping', column_damping), &
               unit_test('column: axial springs', column_axial), &
               unit_test('loading: drive and source', loading_names), &
               unit_test('loading: a drive that the analysis cannot take', loading_drive), &
               unit_test('loading: units', loading_units), &
               unit_test('loading: protocol', loading_protocol), &
               unit_test('analysis and output', analysis), &
               unit_test('analysis: settings of the methods', settings), &
               unit_test('analysis: a setting that the method does not use', unused_settings), &
               unit_test('case: all errors at once', all_at_once), &
               unit_test('case: several loadings', several_loadings), &
               unit_test('units: exact decimals', units)]
   end subroutine collect_case

   !> Expect messages on a spring that contain `part`, or none if `part` is empty.
   subroutine expect_spring(error, spec, part)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_record), intent(in) :: spec
      character(len=*), intent(in) :: part
      type(message_list) :: messages

      call spec%validate('shear spring', messages)
      call expect(error, messages, part)
   end subroutine expect_spring

   subroutine expect_column(error, spec, part)
      type(error_type), allocatable, intent(inout) :: error
      type(column_record), intent(in) :: spec
      character(len=*), intent(in) :: part
      type(message_list) :: messages
      type(column_record) :: asked

      asked = spec
      call asked%validate(messages)
      call expect(error, messages, part)
   end subroutine expect_column

   subroutine expect_loading(error, spec, dynamic, part)
      type(error_type), allocatable, intent(inout) :: error
      type(loading_record), intent(in) :: spec
      logical, intent(in) :: dynamic
      character(len=*), intent(in) :: part
      type(message_list) :: messages
      type(loading_record) :: asked

      asked = spec
      call asked%validate(dynamic, messages)
      call expect(error, messages, part)
   end subroutine expect_loading

   !> Expect one message that contains `part`, or none if `part` is empty.
   subroutine expect(error, messages, part)
      type(error_type), allocatable, intent(inout) :: error
      type(message_list), intent(in) :: messages
      character(len=*), intent(in) :: part

      if (part == '') then
         if (messages%count > 0) call check_equal(error, messages%text, '', 'messages')
      else if (messages%count == 0) then
         call check_true(error, .false., "no message, expected one with '"//part//"'")
      else
         call check_contains(error, messages%text, part, 'message')
         call check_equal(error, messages%count, 1, "messages in '"//messages%text//"'")
      end if
   end subroutine expect

   subroutine given(error)
      type(error_type), allocatable, intent(inout) :: error

      call check_true(error, .not. is_given(unset), 'unset is not given')
      call check_true(error, all(is_given([0.0_wp, -1.0_wp, huge(1.0_wp)])), 'numbers are given')
      call check_true(error, is_given(ieee_value(1.0_wp, ieee_quiet_nan)), 'a NaN is given')
   end subroutine given

   subroutine springs_valid(error)
      type(error_type), allocatable, intent(inout) :: error

      call expect_spring(error, bilinear_1(), '')
      call expect_spring(error, takeda_1('kc'), '')
      call expect_spring(error, takeda_1('kr'), '')
      call expect_spring(error, takeda_1('one'), '')
      call expect_spring(error, elastic(1.0_wp), '')
   end subroutine springs_valid

   subroutine spring_rule(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_record) :: spec

      call expect_spring(error, spec, 'shear spring: rule is missing; it is one of elastic, bilinear, takeda')
      spec%rule = 'takda'
      call expect_spring(error, spec, "rule = 'takda' is not known")
      call expect_spring(error, spec, "did you mean 'takeda'?")
   end subroutine spring_rule

   subroutine spring_elastic(error)
      type(error_type), allocatable, intent(inout) :: error

      call expect_spring(error, elastic(unset), 'shear spring: k is missing')
      call expect_spring(error, elastic(0.0_wp), 'shear spring: k = 0 must be above zero')
      call expect_spring(error, elastic(-2.0_wp), 'shear spring: k = -2 must be above zero')
   end subroutine spring_elastic

   subroutine spring_bilinear(error)
      type(error_type), allocatable, intent(inout) :: error

      call expect_spring(error, bilinear(-1.0_wp, 1.0_wp, 0.0_wp), 'k = -1 must be above zero')
      call expect_spring(error, bilinear(1.0_wp, 0.0_wp, 0.0_wp), 'd_y = 0 must be above zero')
      call expect_spring(error, bilinear(1.0_wp, 1.0_wp, -0.1_wp), 'k_post = -0.1 must not be negative')
      call expect_spring(error, bilinear(1.0_wp, 1.0_wp, 1.0_wp), 'k_post = 1 must be below k = 1')
      call expect_spring(error, bilinear(1.0_wp, 1.0_wp, unset), 'k_post is missing')
   end subroutine spring_bilinear

   subroutine spring_takeda_numbers(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_record) :: spec

      spec = takeda_1('kc')
      call set_value(spec, 'k_c', 0.0_wp)
      call expect_spring(error, spec, 'k_c = 0 must be above zero')
      spec = takeda_1('kc')
      call set_value(spec, 'd_c', -1.0_wp)
      call expect_spring(error, spec, 'd_c = -1 must be above zero')
      spec = takeda_1('kc')
      call set_value(spec, 'k_y', unset)
      call expect_spring(error, spec, 'k_y is missing')
      spec = takeda_1('kc')
      call set_value(spec, 'k_u', -1.0_wp)
      call expect_spring(error, spec, 'k_u = -1 must not be negative')
      spec = takeda_1('kc')
      call set_value(spec, 'b0', -0.1_wp)
      call expect_spring(error, spec, 'b0 = -0.1 must not be negative')
      spec = takeda_1('kc')
      call set_value(spec, 'b1', 0.0_wp)
      call expect_spring(error, spec, 'b1 = 0 must be above zero')
      call expect_spring(error, takeda_1('ko'), 'inner is not known; it is one of kc kr one')
   end subroutine spring_takeda_numbers

   subroutine spring_takeda_order(error)
      type(error_type), allocatable, intent(inout) :: error

      call expect_spring(error, takeda(k_c, d_c, k_y, d_c, k_u, 0.4_wp, 1.0_wp, 'kc'), &
                         'd_y = 0.00031891 must be above d_c = 0.00031891')
      call expect_spring(error, takeda(k_c, d_c, k_c, d_y, k_u, 0.4_wp, 1.0_wp, 'kc'), &
                         'k_y = 2.5428e+08 must be below k_c = 2.5428e+08')
      call expect_spring(error, takeda(k_c, d_c, k_y, d_y, 1.01_wp*k_y, 0.4_wp, 1.0_wp, 'kc'), &
                         'must not be above k_y')
   end subroutine spring_takeda_order

   subroutine spring_limits(error)
      type(error_type), allocatable, intent(inout) :: error

      call expect_spring(error, bilinear(1.0_wp, 1.0_wp, 0.0_wp), '')
      call expect_spring(error, takeda(k_c, d_c, k_y, d_y, 0.0_wp, 0.0_wp, 1.5_wp, 'kr'), '')
      call expect_spring(error, takeda(k_c, d_c, k_y, d_y, k_y, 1.0_wp, 0.05_wp, 'kc'), '')
   end subroutine spring_limits

   !> Also under floating-point traps: a NaN is never compared.
   subroutine spring_not_finite(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_record) :: spec
      real(wp) :: numbers(7), bad(2)
      integer :: i, j
      character(len=8) :: text(2)

      bad = [ieee_value(1.0_wp, ieee_quiet_nan), ieee_value(1.0_wp, ieee_positive_inf)]
      text = ['NaN     ', 'Infinity']
      do j = 1, 2
         do i = 1, 7
            numbers = [k_c, d_c, k_y, d_y, k_u, 0.4_wp, 0.2_wp]
            numbers(i) = bad(j)
            spec = takeda(numbers(1), numbers(2), numbers(3), numbers(4), numbers(5), numbers(6), &
                          numbers(7), 'kc')
            call expect_spring(error, spec, '= '//trim(text(j))//' must be a finite number')
         end do
         call expect_spring(error, elastic(bad(j)), 'k = '//trim(text(j)))
         call expect_spring(error, bilinear(bad(j), 1.0_wp, 0.0_wp), 'k = '//trim(text(j)))
         call expect_spring(error, bilinear(1.0_wp, bad(j), 0.0_wp), 'd_y = '//trim(text(j)))
         call expect_spring(error, bilinear(1.0_wp, 1.0_wp, bad(j)), 'k_post = '//trim(text(j)))
      end do
   end subroutine spring_not_finite

   subroutine spring_range(error)
      type(error_type), allocatable, intent(inout) :: error

      call expect_spring(error, bilinear(1.0e200_wp, 1.0_wp, 0.0_wp), 'k = 1e+200 is outside the range')
      call expect_spring(error, bilinear(1.0_wp, 1.0e-200_wp, 0.0_wp), 'd_y = 1e-200 is outside the range')
      call expect_spring(error, bilinear(1.0_wp, 1.0_wp, tiny(1.0_wp)), 'k_post = 2.22507e-308 is outside')
   end subroutine spring_range

   subroutine spring_stiffness(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_record) :: springs(3)

      springs(1) = elastic(3.0_wp)
      springs(2) = bilinear_1()
      springs(3) = takeda_1('kc')
      call check_close(error, springs%initial_stiffness(), &
                       [3.0_wp, s_k, k_c], 0.0_wp, 0.0_wp, 'elastic, bilinear, takeda')
   end subroutine spring_stiffness

   subroutine column_valid(error)
      type(error_type), allocatable, intent(inout) :: error
      type(column_record) :: spec

      call expect_column(error, column_1('small'), '')
      call expect_column(error, column_1('finite'), '')
      call expect_column(error, chain(7, 'finite'), '')
      call expect_column(error, chain(7, 'pdelta'), '')
      spec = column_1('pdelta')
      spec%axial_load = -1.0e5_wp
      call expect_column(error, spec, '')
   end subroutine column_valid

   subroutine column_numbers(error)
      type(error_type), allocatable, intent(inout) :: error
      type(column_record) :: spec

      spec = column_1('small')
      spec%n = 0
      call expect_column(error, spec, 'column: n = 0 must be from 1 to 10000')
      spec%n = most_bodies + 1
      call expect_column(error, spec, 'column: n = 10001 must be from 1 to 10000')
      spec = column_1('small')
      spec%height = unset
      call expect_column(error, spec, 'column: height is missing; give it a value in m')
      spec = column_1('small')
      spec%mass = -614.4_wp
      call expect_column(error, spec, 'column: mass = -614.4 kg must be above zero')
      call expect_column(error, column_1('large'), "column: kinematics = 'large' is not known")
      spec = column_1('small')
      spec%axial_load = ieee_value(1.0_wp, ieee_quiet_nan)
      call expect_column(error, spec, 'column: axial_load = NaN must be a finite number')
      spec = column_1('small')
      spec%gravity = -9.81_wp
      call expect_column(error, spec, 'column: gravity = -9.81 m/s2 must not be negative')
      spec = column_1('small')
      spec%damping%mass = -1.0_wp
      call expect_column(error, spec, 'damping: mass = -1 1/s must not be negative')
      spec = column_1('small')
      spec%damping%stiffness = -1.0_wp
      call expect_column(error, spec, 'damping: stiffness = -1 s must not be negative')
   end subroutine column_numbers

   subroutine column_parts(error)
      type(error_type), allocatable, intent(inout) :: error
      type(column_record) :: spec

      spec = chain(3, 'small')
      spec%lengths(1) = spec%lengths(1) + 0.1_wp
      call expect_column(error, spec, 'the lengths add up to 2.1 m, the height is 2 m')
      spec = chain(3, 'small')
      spec%masses(2) = 0.0_wp
      call expect_column(error, spec, 'column: masses(2) = 0 kg must be above zero')
      spec = chain(3, 'small')
      spec%masses = [100.0_wp, 100.0_wp]
      call expect_column(error, spec, 'column: masses has 2 values for n = 3 bodies; give one for each')
      spec = chain(3, 'small')
      spec%lengths = [1.0_wp, 1.0_wp]
      call expect_column(error, spec, 'column: lengths has 2 values for n = 3')
   end subroutine column_parts

   subroutine column_springs(error)
      type(error_type), allocatable, intent(inout) :: error
      type(column_record) :: spec

      spec = chain(3, 'small')
      deallocate (spec%shear)
      call expect_column(error, spec, 'column: the shear spring is missing')
      spec = chain(3, 'small')
      spec%flexure = spec%flexure(:2)
      call expect_column(error, spec, 'column: 2 flexure springs for 3 joints; give one, or one for each')
      spec = chain(3, 'small')
      call set_value(spec%flexure(2), 'k', -1.0_wp)
      call expect_column(error, spec, 'flexure spring of joint 2: k = -1 must be above zero')
   end subroutine column_springs

   subroutine column_follows(error)
      type(error_type), allocatable, intent(inout) :: error
      type(column_record) :: spec

      spec = chain(2, 'finite')
      spec%axial_follows = .true.
      spec%force_follows = .true.
      call expect_column(error, spec, '')
      spec%kinematics = 'pdelta'
      call expect_column(error, spec, "(axial_follows, force_follows) needs kinematics = 'finite'")
      spec%axial_follows = .false.
      spec%kinematics = 'small'
      call expect_column(error, spec, "needs kinematics = 'finite'; remove it")
   end subroutine column_follows

   subroutine column_inertia(error)
      type(error_type), allocatable, intent(inout) :: error
      type(column_record) :: spec

      spec = chain(3, 'small')
      spec%top_mass = 500.0_wp
      spec%top_inertia = 30.0_wp
      spec%depth = 0.4_wp
      call expect_column(error, spec, '')
      spec%top_mass = -1.0_wp
      call expect_column(error, spec, 'column: top_mass = -1 kg must not be negative')
      spec%top_mass = ieee_value(1.0_wp, ieee_quiet_nan)
      call expect_column(error, spec, 'column: top_mass = NaN must be a finite number')
      spec%top_mass = 0.0_wp
      spec%top_inertia = ieee_value(1.0_wp, ieee_positive_inf)
      call expect_column(error, spec, 'column: top_inertia = Infinity must be a finite number')
      spec%top_inertia = 0.0_wp
      spec%depth = -0.4_wp
      call expect_column(error, spec, 'column: depth = -0.4 m must not be negative')
      spec%depth = 0.4_wp
      spec%rotary_inertia = [2.0_wp]
      call expect_column(error, spec, 'both depth and rotary_inertia are given')
      spec%depth = 0.0_wp
      call expect_column(error, spec, '')
      spec%rotary_inertia = [2.0_wp, 3.0_wp]
      call expect_column(error, spec, 'column: rotary_inertia has 2 values for n = 3 bodies')
      spec%rotary_inertia = [2.0_wp, 0.0_wp, 3.0_wp]
      call expect_column(error, spec, 'column: rotary_inertia(2) = 0 kg m2 must be above zero')
      spec%rotary_inertia = [-2.0_wp]
      call expect_column(error, spec, 'column: rotary_inertia = -2 kg m2 must be above zero')
   end subroutine column_inertia

   subroutine column_damping(error)
      type(error_type), allocatable, intent(inout) :: error
      type(column_record) :: spec

      spec = chain(3, 'small')
      spec%damping%tangent = .true.
      call expect_column(error, spec, 'damping: tangent has no meaning without stiffness; give one')
      spec%damping%stiffness = 1.0e-4_wp
      call expect_column(error, spec, '')
      spec%damping%modal = [0.05_wp]
      call expect_column(error, spec, '')
      spec%damping%modal = [0.0_wp, 0.05_wp, 0.999_wp]
      call expect_column(error, spec, '')
      spec%damping%modal = [0.02_wp, 5.0_wp]
      call expect_column(error, spec, 'damping: modal(2) = 5 must be below 1')
      spec%damping%modal = [-0.02_wp]
      call expect_column(error, spec, 'damping: modal = -0.02 must not be negative')
      spec%damping%modal = [ieee_value(1.0_wp, ieee_quiet_nan)]
      call expect_column(error, spec, 'damping: modal = NaN must be a finite number')
      deallocate (spec%damping%modal)
      allocate (spec%damping%modal(7), source=0.01_wp)
      call expect_column(error, spec, 'damping: modal has 7 values for 6 modes')
      spec = chain(most_dense + 1, 'small')
      spec%damping%modal = [0.05_wp]
      call expect_column(error, spec, 'up to 500 bodies, not for n = 501')
   end subroutine column_damping

   subroutine column_axial(error)
      type(error_type), allocatable, intent(inout) :: error
      type(column_record) :: spec
      type(spring_record) :: contact
      integer :: i

      contact%rule = 'compression'
      call set_value(contact, 'k', 1.0e9_wp)
      spec = chain(3, 'small')
      allocate (spec%axial_spring(1), source=contact)
      call expect_column(error, spec, '')
      spec%axial_spring(1) = bilinear_1()
      call expect_column(error, spec, '')
      spec%axial_spring(1) = takeda_1('kc')
      call expect_column(error, spec, "column: the axial spring cannot be of the rule 'takeda'")
      deallocate (spec%axial_spring)
      allocate (spec%axial_spring(3))
      do i = 1, 3
         spec%axial_spring(i) = elastic(1.0e9_wp)
      end do
      call expect_column(error, spec, '')
      call set_value(spec%axial_spring(2), 'k', 0.0_wp)
      call expect_column(error, spec, 'axial spring of joint 2: k = 0 must be above zero')
      spec%axial_spring = spec%axial_spring(:2)
      call set_value(spec%axial_spring(2), 'k', 1.0_wp)
      call expect_column(error, spec, 'column: 2 axial springs for 3 joints')
      deallocate (spec%axial_spring)
      spec%flexure(3) = contact
      call expect_column(error, spec, "the flexure spring cannot be of the rule 'compression'")
   end subroutine column_axial

   !> A displacement protocol in drift.
   type(loading_record) function drift_protocol() result(spec)
      spec%drive = 'displacement'
      spec%source = 'protocol'
      allocate (spec%amplitudes, source=[0.005_wp, 0.01_wp])
   end function drift_protocol

   subroutine loading_names(error)
      type(error_type), allocatable, intent(inout) :: error
      type(loading_record) :: spec

      spec = drift_protocol()
      call expect_loading(error, spec, .false., '')
      spec%drive = ''
      call expect_loading(error, spec, .false., 'loading: drive is missing')
      spec = drift_protocol()
      spec%source = 'fil'
      call expect_loading(error, spec, .false., "did you mean 'file'?")
      spec%source = 'file'
      deallocate (spec%amplitudes)
      call expect_loading(error, spec, .false., 'loading: file is missing')
      spec%file = 'history.txt'
      call expect_loading(error, spec, .false., '')
      spec%amplitudes = [1.0_wp]
      call expect_loading(error, spec, .false., &
                          'more than one of file, amplitudes, protocol and values are given')
      deallocate (spec%amplitudes)
      spec%format = 'xls'
      call expect_loading(error, spec, .false., "loading: format = 'xls' is not known")
      spec%format = 'peer'
      spec%scale = ieee_value(1.0_wp, ieee_quiet_nan)
      call expect_loading(error, spec, .false., 'loading: scale = NaN')
      spec%scale = 1.0_wp
      spec%interval = 0.0_wp
      call expect_loading(error, spec, .false., 'loading: interval = 0 s must be above zero')
   end subroutine loading_names

   subroutine loading_drive(error)
      type(error_type), allocatable, intent(inout) :: error
      type(loading_record) :: spec

      spec = drift_protocol()
      spec%period = 1.0_wp
      call expect_loading(error, spec, .true., "drive = 'displacement' needs the static analysis")
      spec%drive = 'ground_acceleration'
      call expect_loading(error, spec, .false., "drive = 'ground_acceleration' needs a dynamic analysis")
      call expect_loading(error, spec, .true., '')
      spec%drive = 'vertical_acceleration'
      call expect_loading(error, spec, .false., "drive = 'vertical_acceleration' needs a dynamic analysis")
      call expect_loading(error, spec, .true., '')
      spec%drive = 'axial_load'
      call expect_loading(error, spec, .false., '')
      call expect_loading(error, spec, .true., '')
   end subroutine loading_drive

   subroutine loading_units(error)
      type(error_type), allocatable, intent(inout) :: error
      type(loading_record) :: spec

      spec = drift_protocol()
      spec%unit = 'kN'
      call expect_loading(error, spec, .false., "unit of the drive 'displacement' = 'kN' is not known")
      call expect_loading(error, spec, .false., 'drift, m, mm, cm, in')
      spec%unit = 'mm'
      call expect_loading(error, spec, .false., '')
      spec%unit = 'drift'
      spec%source = 'file'
      spec%file = 'history.csv'
      deallocate (spec%amplitudes)
      call expect_loading(error, spec, .false., "= 'drift' is not known; it is one of m, mm, cm, in")
      call check_equal(error, size(units_of('force')), 4, 'units of force')
      call check_equal(error, size(units_of('ground_acceleration')), 4, 'units of acceleration')
      call check_equal(error, size(units_of('axial_load')), 4, 'units of axial load')
      call check_equal(error, size(units_of('vertical_acceleration')), 4, 'units of vertical acceleration')
   end subroutine loading_units

   subroutine loading_protocol(error)
      type(error_type), allocatable, intent(inout) :: error
      type(loading_record) :: spec

      spec = drift_protocol()
      deallocate (spec%amplitudes)
      call expect_loading(error, spec, .false., 'loading: amplitudes are missing')
      spec = drift_protocol()
      spec%amplitudes(2) = -0.01_wp
      call expect_loading(error, spec, .false., 'loading: amplitudes(2) = -0.01 must be above zero')
      spec = drift_protocol()
      spec%cycles = [2, 2, 2]
      call expect_loading(error, spec, .false., 'loading: cycles has 3 values for 2 amplitudes')
      spec%cycles = [2, 0]
      call expect_loading(error, spec, .false., 'loading: cycles(2) = 0 must be 1 or more')
      spec = drift_protocol()
      spec%repeats = 0
      call expect_loading(error, spec, .false., 'loading: repeats = 0 must be 1 or more')
      spec = drift_protocol()
      spec%points = 0
      call expect_loading(error, spec, .false., 'loading: points = 0 must be 1 or more')
      spec = drift_protocol()
      spec%drive = 'force'
      call expect_loading(error, spec, .true., 'loading: period is missing; give it a value in s')
   end subroutine loading_protocol

   subroutine analysis(error)
      type(error_type), allocatable, intent(inout) :: error
      type(analysis_record) :: spec
      type(message_list) :: messages
      type(case_record) :: whole
      type(message_list) :: of_case

      spec%method = 'rk5'
      spec%dt = 0.0_wp
      spec%duration = ieee_value(1.0_wp, ieee_positive_inf)
      call spec%validate(messages)
      call check_equal(error, messages%count, 3, 'messages of a dynamic analysis')
      call check_contains(error, messages%text, "did you mean 'rk4'?", 'method')
      call check_contains(error, messages%text, 'analysis: dt = 0 s must be above zero', 'dt')
      call check_contains(error, messages%text, 'analysis: duration = Infinity', 'duration')

      whole%column = column_1('small')
      whole%analysis%dt = 0.1_wp
      whole%analysis%duration = 1.0_wp
      whole%output%every = 0
      call whole%validate(of_case)
      call check_equal(error, of_case%count, 3, 'messages of a static analysis')
      call check_contains(error, of_case%text, "dt has no meaning for method = 'static'", 'dt')
      call check_contains(error, of_case%text, 'duration has no meaning', 'duration')
      call check_contains(error, of_case%text, 'output: every = 0 must be 1 or more', 'every')
   end subroutine analysis

   !> Expect of the settings of an analysis one message that contains `part`, or none if it is empty.
   subroutine expect_analysis(error, spec, part)
      type(error_type), allocatable, intent(inout) :: error
      type(analysis_record), intent(in) :: spec
      character(len=*), intent(in) :: part
      type(message_list) :: messages
      type(analysis_record) :: asked

      asked = spec
      call asked%validate(messages)
      call expect(error, messages, part)
   end subroutine expect_analysis

   subroutine settings(error)
      type(error_type), allocatable, intent(inout) :: error
      type(analysis_record) :: spec
      real(wp) :: nan
      integer :: i

      nan = ieee_value(1.0_wp, ieee_quiet_nan)
      do i = 1, size(methods)
         spec%method = methods(i)%name
         spec%collapse_drift = 0.1_wp
         call expect_analysis(error, spec, '')
      end do
      spec%collapse_drift = 0.0_wp
      call expect_analysis(error, spec, 'analysis: collapse_drift = 0 must be above zero')
      spec%collapse_drift = nan
      call expect_analysis(error, spec, 'analysis: collapse_drift = NaN must be a finite number')
      spec = analysis_record(method='rk4', events='located', allow_unstable=.true.)
      call expect_analysis(error, spec, '')
      spec%events = 'locatd'
      call expect_analysis(error, spec, "events = 'locatd' is not known; it is one of step, located (did "// &
                           "you mean 'located'?)")
      spec = analysis_record(method='auto', tolerance=1.0e-8_wp)
      call expect_analysis(error, spec, '')
      spec%method = 'rk45'
      call expect_analysis(error, spec, '')
      spec%tolerance = 0.5_wp
      call expect_analysis(error, spec, 'analysis: tolerance = 0.5 must be from 1e-13 to 0.1')
      spec%tolerance = -1.0_wp
      call expect_analysis(error, spec, 'analysis: tolerance = -1 must be from')
      spec%tolerance = nan
      call expect_analysis(error, spec, 'analysis: tolerance = NaN must be a finite number')
      spec = analysis_record(method='generalised_alpha', rho_infinity=0.0_wp)
      call expect_analysis(error, spec, '')
      spec%rho_infinity = 1.1_wp
      call expect_analysis(error, spec, 'analysis: rho_infinity = 1.1 must be from 0 to 1')
      spec = analysis_record(method='hht', rho_infinity=0.5_wp)
      call expect_analysis(error, spec, '')
      spec%rho_infinity = 0.4_wp
      call expect_analysis(error, spec, "rho_infinity = 0.4 of method = 'hht' must be from 0.5 to 1")
   end subroutine settings

   subroutine unused_settings(error)
      type(error_type), allocatable, intent(inout) :: error
      integer :: i

      do i = 1, size(methods)
         associate (method => methods(i)%name)
            if (method /= 'rk4') then
               call expect_analysis(error, analysis_record(method=method, events='step'), &
                                    "events has no meaning for method = '"//trim(method)//"'")
               call expect_analysis(error, analysis_record(method=method, allow_unstable=.true.), &
                                    "allow_unstable has no meaning for method = '"//trim(method)//"'")
            end if
            if (method /= 'rk45' .and. method /= 'auto') then
               call expect_analysis(error, analysis_record(method=method, tolerance=1.0e-6_wp), &
                                    "tolerance has no meaning for method = '"//trim(method)//"'")
            end if
            if (method /= 'hht' .and. method /= 'generalised_alpha') then
               call expect_analysis(error, analysis_record(method=method, rho_infinity=0.9_wp), &
                                    "rho_infinity has no meaning for method = '"//trim(method)//"'")
            end if
         end associate
      end do
   end subroutine unused_settings

   subroutine all_at_once(error)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: outcome
      type(column_record) :: spec
      class(column_type), allocatable :: column

      spec = column_1('small')
      spec%height = 0.0_wp
      spec%mass = unset
      call set_value(spec%shear(1), 'k_post', 2.0_wp*s_k)
      call set_value(spec%flexure(1), 'd_c', ieee_value(1.0_wp, ieee_quiet_nan))
      call make_column(spec, column, outcome)
      call check_failed(error, outcome, bad_input, 'column: height = 0 m must be above zero')
      call check_failed(error, outcome, bad_input, 'column: mass is missing; give it a value in kg')
      call check_failed(error, outcome, bad_input, 'shear spring: k_post = 1.40774e+09 must be below k')
      call check_failed(error, outcome, bad_input, 'flexure spring: d_c = NaN must be a finite number')
   end subroutine all_at_once

   subroutine several_loadings(error)
      type(error_type), allocatable, intent(inout) :: error
      type(case_record) :: spec
      type(message_list) :: messages(5)
      character(len=21), parameter :: drives(4) = [character(len=21) :: &
         'force', 'ground_acceleration', 'vertical_acceleration', 'axial_load']
      integer :: i

      spec%column = column_1('pdelta')
      spec%loadings = 2
      do i = 1, 4
         spec%loading(i) = drift_protocol()
         spec%loading(i)%drive = 'force'
         spec%loading(i)%period = 1.0_wp
      end do
      spec%analysis%method = 'static'
      call spec%validate(messages(1))
      call expect(error, messages(1), 'several loadings need a dynamic analysis')
      spec%analysis%method = 'rk4'
      call spec%validate(messages(2))
      call expect(error, messages(2), "two loadings with drive = 'force'")
      spec%loading(2)%drive = 'ground_acceleration'
      spec%loading(2)%unit = 'g'
      call spec%validate(messages(3))
      call expect(error, messages(3), '')
      spec%loadings = 4
      do i = 1, 4
         spec%loading(i)%drive = drives(i)
      end do
      call spec%validate(messages(4))
      call expect(error, messages(4), '')
      spec%loading(1)%drive = 'axial_load'
      call spec%validate(messages(5))
      call expect(error, messages(5), "two loadings with drive = 'axial_load'; give each drive once")
   end subroutine several_loadings

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

end module test_case
