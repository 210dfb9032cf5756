!> Springs with a capped backbone: corners, deterioration, and the properties of the rules to the last bit.
module test_capped
   use check, only: unit_test, check_close, check_contains, check_equal, check_same, check_true
   use rbs_base_error, only: error_type, message_list
   use rbs_base_check, only: is_given
   use rbs_base_keys, only: find_key, key_type
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_rules_backbone, only: backbone_side
   use rbs_hysteresis_rules_deterioration, only: deterioration_type
   use rbs_hysteresis_springs, only: follow_path, spring_array
   use rbs_hysteresis_rules_backbone_parameters, only: backbone_parameters
   use rbs_hysteresis_registry, only: keys_of, rule_names
   use rbs_hysteresis_rule, only: most_parameters
   use rbs_structure_column_column_record, only: column_record
   use rbs_hysteresis_spring_record, only: spring_record
   use samples, only: set_value, value_of, elastic, random_type
   implicit none
   private

   public :: collect_capped

contains

   subroutine collect_capped(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('keys: all have different places', table), &
               unit_test('validation names number, value and remedy', validation), &
               unit_test('initial stiffness is that of the stiffer side', stiffness), &
               unit_test('backbone: corners by hand', corners), &
               unit_test('backbone: strength and softening by hand', weakened), &
               unit_test('backbone: rupture', rupture), &
               unit_test('deterioration: shares by hand', shares), &
               unit_test('property 6: the mirror path with swapped sides, to the last bit', mirror), &
               unit_test('a side whose energy is used up has no force and is not stuck', exhausted), &
               unit_test('no line is steeper than the virgin one', steepest)]
   end subroutine collect_capped

   !> Elastic 100 up to (1, 100), cap (3, 120), softening with -10 to the residual 20 at 13.
   type(spring_record) function hand() result(spec)
      spec%rule = 'peak_oriented'
      call set_value(spec, 'd_y', 1.0_wp)
      call set_value(spec, 'f_y', 100.0_wp)
      call set_value(spec, 'd_cap', 3.0_wp)
      call set_value(spec, 'f_cap', 120.0_wp)
      call set_value(spec, 'd_pc', 12.0_wp)
      call set_value(spec, 'f_res', 20.0_wp)
   end function hand

   !> The backbone of a side; the negative side has the values of the positive one if it is not given.
   type(backbone_parameters) function side_of(spec, s) result(side)
      type(spring_record), intent(in) :: spec
      integer, intent(in) :: s

      side = backbone_parameters(d_y=value('d_y'), f_y=value('f_y'), d_cap=value('d_cap'), &
                                 f_cap=value('f_cap'), d_pc=value('d_pc'), f_res=value('f_res'), &
                                 d_u=value('d_u'), d_c=value('d_c'), f_c=value('f_c'))

   contains

      real(wp) function value(name)
         character(len=*), intent(in) :: name

         value = value_of(spec, name)
         if (s < 0) then
            if (is_given(value_of(spec, name//'_neg'))) value = value_of(spec, name//'_neg')
         end if
      end function value
   end function side_of

   subroutine table(error)
      type(error_type), allocatable, intent(inout) :: error
      type(key_type), allocatable :: keys(:), more(:)
      type(spring_record) :: spec
      integer :: i

      call keys_of('pinching', keys)
      spec%rule = 'pinching'
      do i = 1, size(keys)
         call set_value(spec, trim(keys(i)%name), 1.0_wp*i)
      end do
      call check_same(error, spec%value(:size(keys)), [(1.0_wp*i, i=1, size(keys))], 'each has a place')
      call check_same(error, value_of(spec, keys%name), spec%value(:size(keys)), 'there and back')
      call set_value(spec, 'k', 7.0_wp)
      call check_true(error, .not. is_given(value_of(spec, 'k')), 'k is not there')
      call keys_of('peak_oriented', more)
      call check_true(error, find_key(keys, 'kappa_f') > 0 .and. find_key(more, 'kappa_f') == 0, &
                      'rules with kappa_f')
      do i = 1, size(rule_names)
         call keys_of(rule_names(i), keys)
         call check_true(error, size(keys) <= most_parameters, 'there is room for the parameters')
      end do
   end subroutine table

   subroutine validation(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_record) :: spec

      spec = hand()
      call expect(error, spec, '')
      call set_value(spec, 'f_y_neg', 130.0_wp)
      call expect(error, spec, 'f_cap_neg = 120 must not be below f_y_neg = 130')
      spec = hand()
      spec%rule = 'pinching'
      call set_value(spec, 'kappa_d', 0.5_wp)
      call expect(error, spec, 'kappa_f is missing')
      call set_value(spec, 'kappa_f', 1.5_wp)
      call expect(error, spec, 'kappa_f = 1.5 must not be above 1')
      spec = hand()
      call set_value(spec, 'd_c', 0.5_wp)
      call expect(error, spec, 'are a point together')
      call set_value(spec, 'f_c', 40.0_wp)
      call expect(error, spec, 'f_c / d_c = 80 must be above f_y / d_y = 100 (cracking softens)')
      spec = hand()
      call set_value(spec, 'c', 0.5_wp)
      call expect(error, spec, 'c = 0.5 must')
      call set_value(spec, 'c', 1.0_wp)
      call set_value(spec, 'lambda_a', 1.7_wp)
      call expect(error, spec, 'lambda_a = 1.7 must be 0 (it is off) or at least '// &
                  'f_cap**2 (1 + d_cap/d_pc)/(k f_y d_y) = 1.8')
      call axial(error)
   end subroutine validation

   !> Expect one message that contains `part`, or none if `part` is empty.
   subroutine expect(error, spec, part)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_record), intent(in) :: spec
      character(len=*), intent(in) :: part
      type(message_list) :: messages

      call spec%validate('spring', messages)
      call check_equal(error, messages%count, merge(0, 1, part == ''), "messages for '"//part//"'")
      if (messages%count > 0) call check_contains(error, messages%text, part, 'message')
   end subroutine expect

   subroutine axial(error)
      type(error_type), allocatable, intent(inout) :: error
      type(column_record) :: spec
      type(message_list) :: messages

      spec%height = 1.0_wp
      spec%mass = 1.0_wp
      allocate (spec%shear(1), spec%flexure(1), spec%axial_spring(1))
      spec%shear(1) = elastic(1.0_wp)
      spec%flexure(1) = hand()
      spec%axial_spring(1) = hand()
      call spec%validate(messages)
      call check_equal(error, messages%count, 1, 'messages')
      call check_contains(error, messages%text, "cannot be of the rule 'peak_oriented'", 'axial')
   end subroutine axial

   subroutine stiffness(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_record) :: spec

      spec = hand()
      call check_same(error, spec%initial_stiffness(), 100.0_wp, 'elastic up to yield')
      call set_value(spec, 'd_y_neg', 0.5_wp)
      call check_same(error, spec%initial_stiffness(), 200.0_wp, 'the negative side is stiffer')
      call set_value(spec, 'd_c', 0.1_wp)
      call set_value(spec, 'f_c', 50.0_wp)
      call check_same(error, spec%initial_stiffness(), 500.0_wp, 'up to cracking')
   end subroutine stiffness

   subroutine corners(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_record) :: spec
      type(backbone_side) :: side

      spec = hand()
      side = backbone_side()
      call side%draw(side_of(spec, 1))
      call check_same(error, side%d(:side%last), [0.0_wp, 1.0_wp, 3.0_wp, 13.0_wp], 'deformations')
      call check_same(error, side%f(:side%last), [0.0_wp, 100.0_wp, 120.0_wp, 20.0_wp], 'forces')
      call check_same(error, side%force([0.5_wp, 2.0_wp, 8.0_wp, 99.0_wp]), &
                      [50.0_wp, 110.0_wp, 70.0_wp, 20.0_wp], 'between')
      call check_same(error, side%force(1.0e6_wp), 20.0_wp, 'a residual lasts')
      call check_close(error, side%meeting(100.0_wp, 0.5_wp), 140.0_wp/90.0_wp, 1.0e-14_wp, 0.0_wp, &
                       'a steep line from 0.5 meets 90 + 10 d')
      call check_close(error, side%meeting(50.0_wp, 6.0_wp), 7.5_wp, 1.0e-14_wp, 0.0_wp, &
                       'one from 6 meets 150 - 10 d')
      call set_value(spec, 'd_c', 0.25_wp)
      call set_value(spec, 'f_c', 40.0_wp)
      call set_value(spec, 'd_cap', 1.0_wp)
      call set_value(spec, 'f_cap', 100.0_wp)
      call set_value(spec, 'f_res', 0.0_wp)
      side = backbone_side()
      call side%draw(side_of(spec, 1))
      call check_close(error, side%d(:side%last), [0.0_wp, 0.25_wp, 1.0_wp, 13.0_wp], 1.0e-15_wp, 0.0_wp, &
                       'cracking, no hardening')
      call check_same(error, side%f(:side%last), [0.0_wp, 40.0_wp, 100.0_wp, 0.0_wp], 'their forces')
      call check_same(error, side%force(13.1_wp), 0.0_wp, 'no force left')
      side%strength = 0.0_wp
      call side%draw(side_of(spec, 1))
      call check_same(error, side%force([0.1_wp, 1.0_wp, 99.0_wp]), [0.0_wp, 0.0_wp, 0.0_wp], &
                      'no strength left')
   end subroutine corners

   !> Half the strength: 5 d + 45 beyond (0.5, 50). Less softening line: (150 C - 10 d).
   subroutine weakened(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_record) :: spec
      type(backbone_side) :: side

      spec = hand()
      side = backbone_side(strength=0.5_wp)
      call side%draw(side_of(spec, 1))
      call check_close(error, side%d(:side%last), [0.0_wp, 0.5_wp, (150.0_wp - 47.5_wp)/15.0_wp, 13.0_wp], &
                       1.0e-14_wp, 0.0_wp, 'half the strength')
      side = backbone_side(softening=0.6_wp)
      call side%draw(side_of(spec, 1))
      call check_close(error, side%d(:side%last), [0.0_wp, 90.0_wp/110.0_wp, 7.0_wp], 1.0e-14_wp, 0.0_wp, &
                       'the softening line cuts the elastic one')
      call check_close(error, side%f(1), 9000.0_wp/110.0_wp, 1.0e-14_wp, 0.0_wp, 'there')
      side = backbone_side(softening=0.1_wp)
      call side%draw(side_of(spec, 1))
      call check_close(error, side%d(:side%last), [0.0_wp, 0.2_wp], 1.0e-14_wp, 0.0_wp, &
                       'only the residual is left')
      side = backbone_side(strength=0.01_wp)
      call side%draw(side_of(spec, 1))
      call check_close(error, side%strength, 0.2_wp, 1.0e-15_wp, 0.0_wp, 'not below the residual')
      call check_close(error, side%force(5.0_wp), 0.2_wp*(100.0_wp + 10.0_wp*4.8_wp), 1.0e-14_wp, 0.0_wp, &
                       'its hardening')
   end subroutine weakened

   subroutine rupture(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_record) :: spec
      type(backbone_side) :: side

      spec = hand()
      call set_value(spec, 'd_u', 8.0_wp)
      side = backbone_side()
      call side%draw(side_of(spec, 1))
      call check_same(error, side%d(:side%last), [0.0_wp, 1.0_wp, 3.0_wp, 8.0_wp, 8.7_wp], 'while softening')
      call set_value(spec, 'd_u', 20.0_wp)
      side = backbone_side()
      call side%draw(side_of(spec, 1))
      call check_same(error, side%d(:side%last), [0.0_wp, 1.0_wp, 3.0_wp, 13.0_wp, 20.0_wp, 20.2_wp], &
                      'on the residual')
   end subroutine rupture

   subroutine shares(error)
      type(error_type), allocatable, intent(inout) :: error
      type(deterioration_type) :: deterioration

      call check_close(error, deterioration%left(100.0_wp, 30.0_wp), 0.7_wp, 1.0e-15_wp, 0.0_wp, '1 - E/E_t')
      call check_same(error, deterioration%left(100.0_wp, 100.0_wp), 0.0_wp, 'used up')
      call check_same(error, deterioration%left(100.0_wp, 199.0_wp), 0.0_wp, 'more than there is')
      call check_same(error, deterioration%left(0.0_wp, 30.0_wp), 1.0_wp, 'does not act')
      call check_same(error, deterioration%left(100.0_wp, -1.0_wp), 1.0_wp, 'round-off of no energy')
      deterioration%c = 2.0_wp
      call check_close(error, deterioration%left(100.0_wp, 30.0_wp), 0.91_wp, 1.0e-15_wp, 0.0_wp, 'squared')
   end subroutine shares

   !> A random spring with all features, and a path for it.
   subroutine random_spring(random, spec, d)
      type(random_type), intent(inout) :: random
      type(spring_record), intent(out) :: spec
      real(wp), intent(out) :: d(:)
      real(wp) :: size_of_move
      integer :: j

      spec = hand()
      call set_value(spec, 'd_cap', random%uniform(1.0_wp, 5.0_wp))
      call set_value(spec, 'f_cap', 100.0_wp + (value_of(spec, 'd_cap') - 1.0_wp)* &
                     random%uniform(0.0_wp, 20.0_wp))
      call set_value(spec, 'd_pc', random%uniform(1.0_wp, 50.0_wp))
      call set_value(spec, 'f_res', random%uniform(-50.0_wp, 90.0_wp))
      if (value_of(spec, 'f_res') < 0.0_wp) call set_value(spec, 'f_res', 0.0_wp)
      if (random%uniform(0.0_wp, 1.0_wp) > 0.5_wp) then
         call set_value(spec, 'd_c', 0.2_wp)
         call set_value(spec, 'f_c', random%uniform(34.0_wp, 60.0_wp))
      end if
      if (random%uniform(0.0_wp, 1.0_wp) > 0.5_wp) then
         call set_value(spec, 'd_y_neg', random%uniform(0.6_wp, 1.0_wp))
         call set_value(spec, 'f_res_neg', 0.5_wp*value_of(spec, 'f_res'))
         call set_value(spec, 'd_u_neg', random%uniform(5.0_wp, 15.0_wp))
      end if
      call set_value(spec, 'b0', random%uniform(0.0_wp, 0.8_wp))
      call set_value(spec, 'lambda_s', random%uniform(25.0_wp, 200.0_wp))
      call set_value(spec, 'lambda_c', random%uniform(25.0_wp, 200.0_wp))
      call set_value(spec, 'lambda_k', random%uniform(25.0_wp, 200.0_wp))
      call set_value(spec, 'lambda_a', random%uniform(25.0_wp, 200.0_wp))
      call set_value(spec, 'c', random%uniform(1.0_wp, 2.0_wp))
      if (random%uniform(0.0_wp, 1.0_wp) > 0.5_wp) then
         spec%rule = 'pinching'
         call set_value(spec, 'kappa_f', random%uniform(0.1_wp, 1.0_wp))
         call set_value(spec, 'kappa_d', random%uniform(0.1_wp, 1.0_wp))
      end if
      do j = 1, size(d)
         size_of_move = random%uniform(-0.5_wp, 1.1_wp)
         d(j) = random%uniform(-1.0_wp, 1.0_wp)*10.0_wp**size_of_move
         ! Exact returns to an earlier point.
         if (random%uniform(0.0_wp, 1.0_wp) > 0.85_wp) d(j) = d(max(j - 3, 1))
      end do
   end subroutine random_spring

   subroutine mirror(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      type(spring_record) :: spec, other
      type(backbone_parameters) :: side(-1:1)
      real(wp) :: d(40), f(40), mirrored(40)
      integer :: path, s

      do path = 1, 200
         call random_spring(random, spec, d)
            do s = -1, 1, 2
            side(s) = side_of(spec, s)
         end do
         other = spec
         call set_value(other, 'd_y', side(-1)%d_y)
         call set_value(other, 'f_res', side(-1)%f_res)
         call set_value(other, 'd_u', side(-1)%d_u)
         call set_value(other, 'd_y_neg', side(1)%d_y)
         call set_value(other, 'f_res_neg', side(1)%f_res)
         ! A parameter without a value on one side cannot be given for the other side alone.
         call set_value(other, 'd_u_neg', max(side(1)%d_u, 1.0e9_wp))
         call follow_path(spec, d, f)
         call follow_path(other, -d, mirrored)
         call check_same(error, mirrored, 0.0_wp - f, 'mirror')
      end do
   end subroutine mirror

   !> lambda = 1.8: the excursion to 4 dissipates 50 + 220 + 115 - 110**2/200 = 324.5 of 180.
   subroutine exhausted(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_record) :: spec
      type(spring_array) :: spring
      integer :: i

      spec = hand()
      call set_value(spec, 'f_res', 0.0_wp)
      call set_value(spec, 'lambda_s', 1.8_wp)
      call spring%create([spec])
      call spring%advance_to(1, 4.0_wp)
      call check_close(error, spring%force(1), 110.0_wp, 1.0e-14_wp, 0.0_wp, 'at 4')
      do i = 1, 50
         call spring%advance_to(1, -20.0_wp - i)
         call check_same(error, spring%force(1), 0.0_wp, 'nothing left on the other side')
         call check_close(error, spring%work(1), 324.5_wp, 1.0e-12_wp, 0.0_wp, 'work')
      end do
      call spring%advance_to(1, 4.0_wp)
      call check_close(error, spring%force(1), 110.0_wp, 1.0e-12_wp, 0.0_wp, 'by itself')
      call check_true(error, .not. spring%stuck, 'not stuck')
   end subroutine exhausted

   subroutine steepest(error)
      type(error_type), allocatable, intent(inout) :: error
      type(random_type) :: random
      type(spring_record) :: spec
      type(spring_array) :: spring
      real(wp) :: d(60)
      integer :: path, j

      do path = 1, 300
         call random_spring(random, spec, d)
         call spring%create([spec])
         do j = 1, size(d)
            call spring%advance_to(1, d(j))
            call check_true(error, spring%k(1) <= (1.0_wp + 1.0e-9_wp)*spec%initial_stiffness(), 'slope')
         end do
      end do
   end subroutine steepest

end module test_capped
