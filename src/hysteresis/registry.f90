!> All rules by name. A new rule needs a file of its own; its name and what allocates it stand here.
module rbs_hysteresis_registry
   use rbs_base_keys, only: key_type
   use rbs_hysteresis_bilinear, only: bilinear_rule
   use rbs_hysteresis_compression, only: compression_rule
   use rbs_hysteresis_concrete, only: concrete_rule
   use rbs_hysteresis_elastic, only: elastic_rule
   use rbs_hysteresis_layered, only: layered_rule
   use rbs_hysteresis_peak_oriented, only: peak_oriented_rule
   use rbs_hysteresis_pinching, only: pinching_rule
   use rbs_hysteresis_rule, only: rule_type, rule_length, places_length
   use rbs_hysteresis_steel, only: steel_rule
   use rbs_hysteresis_takeda, only: takeda_rule
   implicit none
   private

   public :: rule_names, new_rule, keys_of, places_of, suits

   character(len=rule_length), parameter :: rule_names(*) = [character(len=rule_length) :: &
      'elastic', 'bilinear', 'takeda', 'compression', 'peak_oriented', 'pinching', 'concrete', 'steel', &
      'layered']

contains

   !> A rule without parameters yet; not allocated if the name is not known.
   subroutine new_rule(rule, name)
      class(rule_type), allocatable, intent(out) :: rule
      character(len=*), intent(in) :: name

      select case (name)
      case ('elastic')
         allocate (elastic_rule :: rule)
      case ('bilinear')
         allocate (bilinear_rule :: rule)
      case ('takeda')
         allocate (takeda_rule :: rule)
      case ('compression')
         allocate (compression_rule :: rule)
      case ('peak_oriented')
         allocate (peak_oriented_rule :: rule)
      case ('pinching')
         allocate (pinching_rule :: rule)
      case ('concrete')
         allocate (concrete_rule :: rule)
      case ('steel')
         allocate (steel_rule :: rule)
      case ('layered')
         allocate (layered_rule :: rule)
      case default                                  ! unknown: the caller reports it
      end select
   end subroutine new_rule

   !> Parameters of a rule by its name; an empty list if the rule is not known.
   subroutine keys_of(name, keys)
      character(len=*), intent(in) :: name
      type(key_type), allocatable, intent(out) :: keys(:)
      class(rule_type), allocatable :: rule

      call new_rule(rule, name)
      if (allocated(rule)) then
         keys = rule%keys()
      else
         allocate (keys(0))
      end if
   end subroutine keys_of

   !> Whether springs of a rule may be used in a place, one of the words of `rbs_hysteresis_rule`.
   impure elemental logical function suits(name, place)
      character(len=*), intent(in) :: name, place

      suits = index(' '//places_of(name)//' ', ' '//trim(place)//' ') > 0
   end function suits

   !> The words of all places where springs of a rule may be used; blank if the rule is not known.
   impure elemental function places_of(name) result(places)
      character(len=*), intent(in) :: name
      character(len=places_length) :: places
      class(rule_type), allocatable :: rule

      places = ''
      call new_rule(rule, name)
      if (allocated(rule)) places = rule%places()
   end function places_of

end module rbs_hysteresis_registry
