!> All rules by name. A new rule needs a file of its own, and a line here.
module rbs_hysteresis_registry
   use rbs_base_key_visitor, only: key_visitor
   use rbs_base_keys, only: key_type
   use rbs_hysteresis_layered_layered_joint, only: layered_rule
   use rbs_hysteresis_rule, only: rule_type, rule_length, places_length, in_shear, in_flexure, in_axial, &
                                  in_layer
   use rbs_hysteresis_rules_bilinear, only: bilinear_rule
   use rbs_hysteresis_rules_compression, only: compression_rule
   use rbs_hysteresis_rules_concrete, only: concrete_rule
   use rbs_hysteresis_rules_elastic, only: elastic_rule
   use rbs_hysteresis_rules_peak_oriented, only: peak_oriented_rule
   use rbs_hysteresis_rules_pinching, only: pinching_rule
   use rbs_hysteresis_rules_steel, only: steel_rule
   use rbs_hysteresis_rules_takeda, only: takeda_rule
   implicit none
   private

   public :: rule_names, new_rule, keys_of, places_of, suits

   character(len=rule_length), parameter :: rule_names(*) = [character(len=rule_length) :: &
      'elastic', 'bilinear', 'takeda', 'compression', 'peak_oriented', 'pinching', 'concrete', 'steel', &
      'layered']

   character(len=*), parameter :: in_joints = in_shear//' '//in_flexure, &
        across_joints = in_axial//' '//in_layer, &
                                  anywhere = in_joints//' '//across_joints

contains

   !> A rule without parameters yet; none if the name is not known.
   subroutine new_rule(name, rule)
      character(len=*), intent(in) :: name
      class(rule_type), allocatable, intent(out) :: rule

      select case (name)
      case ('elastic');       allocate (elastic_rule :: rule)
      case ('bilinear');      allocate (bilinear_rule :: rule)
      case ('takeda');        allocate (takeda_rule :: rule)
      case ('compression');   allocate (compression_rule :: rule)
      case ('peak_oriented'); allocate (peak_oriented_rule :: rule)
      case ('pinching');      allocate (pinching_rule :: rule)
      case ('concrete');      allocate (concrete_rule :: rule)
      case ('steel');         allocate (steel_rule :: rule)
      case ('layered');       allocate (layered_rule :: rule)
      case default
      end select
   end subroutine new_rule

   !> Parameters of a rule by its name; an empty list if the rule is not known.
   subroutine keys_of(name, keys)
      character(len=*), intent(in) :: name
      type(key_type), allocatable, intent(out) :: keys(:)
      class(rule_type), allocatable :: rule
      type(key_visitor) :: v

      call new_rule(name, rule)
      call v%collect(name)
      if (allocated(rule)) call rule%visit(v)
      keys = v%keys(:v%count)
   end subroutine keys_of

   !> Whether springs of a rule may be used in a place, one of the words of `rbs_hysteresis_rule`.
   elemental logical function suits(name, place)
      character(len=*), intent(in) :: name, place

      suits = index(' '//places_of(name)//' ', ' '//trim(place)//' ') > 0
   end function suits

   !> Where springs of a rule may be used: some of the words of `rbs_hysteresis_rule`, separated by blanks;
   !> blank if the rule is not known.
   elemental character(len=places_length) function places_of(name) result(places)
      character(len=*), intent(in) :: name

      select case (name)
      case ('elastic', 'bilinear', 'steel')
         places = anywhere
      case ('takeda')
         places = in_joints
      case ('peak_oriented', 'pinching')
         places = in_joints//' '//in_axial
      case ('compression', 'concrete')
         places = across_joints
      case ('layered')
         ! Its layers are springs with parameters of their own.
         places = in_flexure
      case default
         places = ''
      end select
   end function places_of

end module rbs_hysteresis_registry
