!> The rules of the springs and the numbers that each takes: the one table of both.
!>
!> A new rule is a line in `rule_names` and one in `numbers_of_rule`; a new number is a line in
!> `number_names` and its component of `spring_spec`. Python has the same order in `_core`.
module rbs_spec_spring_table
   implicit none
   private

   public :: rule_names, layer_rules, inner_names, number_names, takes, is_capped, side_suffix

   character(len=13), parameter :: rule_names(9) = [character(len=13) :: &
      'elastic', &
      'bilinear', &
      'takeda', &
      'compression', &
      'peak_oriented', &
      'pinching', &
      'concrete', &
      'steel', &
      'layered']

   !> Those that a layer of a joint may have
   character(len=13), parameter :: layer_rules(5) = [character(len=13) :: &
      'concrete', &
      'steel', &
      'elastic', &
      'bilinear', &
      'compression']

   !> What `b1` of the Takeda rule multiplies.
   character(len=3), parameter :: inner_names(3) = ['kc ', 'kr ', 'one']

   !> Most letters of the name of a number.
   integer, parameter, public :: name_length = 10

   !> All numbers that springs have; the order is that of the arrays that cross to Python.
   character(len=name_length), parameter :: number_names(*) = [character(len=name_length) :: &
      'k', 'd_y', 'k_post', 'k_c', 'd_c', 'k_y', 'k_u', 'b0', 'b1', &
      'f_c', 'f_y', 'd_cap', 'f_cap', 'd_pc', 'f_res', 'd_u', &
      'd_c_neg', 'f_c_neg', 'd_y_neg', 'f_y_neg', 'd_cap_neg', 'f_cap_neg', 'd_pc_neg', 'f_res_neg', &
      'd_u_neg', &
      'lambda_s', 'lambda_c', 'lambda_k', 'lambda_a', 'c', 'kappa_f', 'kappa_d', &
      'f_peak', 'd_peak', 'k_fall', 'plastic', 'contact', 'misfit', 'wear', &
      'r0', 'r1', 'r2', 'growth', 'endurance', 'axial_load']

   !> How many numbers there are.
   integer, parameter, public :: number_count = size(number_names)

   !> Behind the names of the numbers of the negative side.
   character(len=*), parameter :: side_suffix = '_neg'

   character(len=*), parameter :: side = ' d_c f_c d_y f_y d_cap f_cap d_pc f_res d_u'
   character(len=*), parameter :: other_side = ' d_c_neg f_c_neg d_y_neg f_y_neg d_cap_neg f_cap_neg'// &
                                  ' d_pc_neg f_res_neg d_u_neg'
   character(len=*), parameter :: capped = side//other_side//' b0 lambda_s lambda_c lambda_k lambda_a c '

   !> The numbers that each rule takes, blanks around each, in the order of `rule_names`.
   character(len=*), parameter :: numbers_of_rule(size(rule_names)) = [character(len=len(capped) + 16) :: &
      ' k ', &
      ' k d_y k_post ', &
      ' k_c d_c k_y d_y k_u b0 b1 ', &
      ' k ', &
      capped, &
      capped//'kappa_f kappa_d ', &
      ' k f_peak d_peak k_fall f_res plastic contact misfit wear ', &
      ' k f_y k_post r0 r1 r2 growth endurance ', &
      ' axial_load ']

contains

   !> Whether a rule takes a number.
   elemental logical function takes(rule, number)
      !> One of `rule_names`, and one of `number_names`
      character(len=*), intent(in) :: rule, number
      integer :: place

      takes = .false.
      do place = 1, size(rule_names)
         if (rule_names(place) == rule) takes = index(numbers_of_rule(place), ' '//trim(number)//' ') > 0
      end do
   end function takes

   !> Whether a rule has the backbone with a capping point (`rbs_spec_backbone`).
   elemental logical function is_capped(rule)
      character(len=*), intent(in) :: rule

      is_capped = takes(rule, 'd_cap')
   end function is_capped

end module rbs_spec_spring_table
