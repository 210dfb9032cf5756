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

   !> A rule without parameters yet, and where springs of this rule may be used: some of the words of
   !> `rbs_hysteresis_rule`, separated by blanks. If the name is not known, no rule and blanks.
   subroutine new_rule(name, rule, places)
      character(len=*), intent(in) :: name
      class(rule_type), allocatable, intent(out) :: rule
      character(len=places_length), intent(out), optional :: places
      character(len=places_length) :: where_used

      where_used = ''
      select case (name)
      case ('elastic');       call enter(elastic_rule(), anywhere)
      case ('bilinear');      call enter(bilinear_rule(), anywhere)
      case ('takeda');        call enter(takeda_rule(), in_joints)
      case ('compression');   call enter(compression_rule(), across_joints)
      case ('peak_oriented'); call enter(peak_oriented_rule(), in_joints//' '//in_axial)
      case ('pinching');      call enter(pinching_rule(), in_joints//' '//in_axial)
      case ('concrete');      call enter(concrete_rule(), across_joints)
      case ('steel');         call enter(steel_rule(), anywhere)
      ! Its layers are springs with parameters of their own.
      case ('layered');       call enter(layered_rule(), in_flexure)
      case default
      end select
      if (present(places)) places = where_used

   contains

      subroutine enter(new, used)
         class(rule_type), intent(in) :: new
         character(len=*), intent(in) :: used

         allocate (rule, source=new)
         where_used = used
      end subroutine enter
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
   impure elemental logical function suits(name, place)
      character(len=*), intent(in) :: name, place

      suits = index(' '//places_of(name)//' ', ' '//trim(place)//' ') > 0
   end function suits

   !> The words of all places where springs of a rule may be used; blank if the rule is not known.
   impure elemental character(len=places_length) function places_of(name) result(places)
      character(len=*), intent(in) :: name
      class(rule_type), allocatable :: rule

      call new_rule(name, rule, places)
   end function places_of

end module rbs_hysteresis_registry
