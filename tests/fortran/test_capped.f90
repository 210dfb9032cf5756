!> Springs with a capped backbone: deterioration by hand. Corners are those of reference_capped.py.
module test_capped
   use check, only: unit_test, check_close, check_same, check_true
   use rbs_base_error, only: error_type
   use rbs_base_check, only: is_given
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_rules_backbone, only: backbone_side, backbone_parameters
   use rbs_hysteresis_rules_deterioration, only: deterioration_type
   use rbs_hysteresis_springs, only: spring_array
   use rbs_hysteresis_spring_record, only: spring_record
   use samples, only: make_springs, capped, set_value, value_of
   implicit none
   private

   public :: collect_capped

contains

   subroutine collect_capped(tests)
      type(unit_test), allocatable, intent(out) :: tests(:)

      tests = [unit_test('initial stiffness is that of the stiffer side', stiffness), &
               unit_test('backbone: strength and softening by hand', weakened), &
               unit_test('deterioration: shares by hand', shares), &
               unit_test('a side whose energy is used up has no force and is not stuck', exhausted)]
   end subroutine collect_capped

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

   subroutine stiffness(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_record) :: spec

      spec = capped('peak_oriented')
      call check_same(error, spec%initial_stiffness(), 100.0_wp, 'elastic up to yield')
      call set_value(spec, 'd_y_neg', 0.5_wp)
      call check_same(error, spec%initial_stiffness(), 200.0_wp, 'the negative side is stiffer')
      call set_value(spec, 'd_c', 0.1_wp)
      call set_value(spec, 'f_c', 50.0_wp)
      call check_same(error, spec%initial_stiffness(), 500.0_wp, 'up to cracking')
   end subroutine stiffness

   !> Half the strength: 5 d + 45 beyond (0.5, 50). Less softening line: (150 C - 10 d).
   subroutine weakened(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_record) :: spec
      type(backbone_side) :: side

      spec = capped('peak_oriented')
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

   !> lambda = 1.8: the excursion to 4 dissipates 50 + 220 + 115 - 110**2/200 = 324.5 of 180.
   subroutine exhausted(error)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_record) :: spec
      type(spring_array) :: spring
      integer :: i

      spec = capped('peak_oriented')
      call set_value(spec, 'f_res', 0.0_wp)
      call set_value(spec, 'lambda_s', 1.8_wp)
      call make_springs(spring, [spec])
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

end module test_capped
