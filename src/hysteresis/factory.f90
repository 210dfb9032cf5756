!> From the numbers of a user to the rule that they belong to.
module rbs_hysteresis_factory
   use rbs_hysteresis_bilinear, only: bilinear_rule
   use rbs_hysteresis_compression, only: compression_rule
   use rbs_hysteresis_elastic, only: elastic_rule
   use rbs_hysteresis_rule, only: rule_type
   use rbs_hysteresis_takeda, only: takeda_rule
   use rbs_spec_spring, only: spring_spec
   implicit none
   private

   public :: new_rule

contains

   !> The rule of a spring whose numbers have been validated.
   subroutine new_rule(rule, spec)
      class(rule_type), allocatable, intent(out) :: rule
      type(spring_spec), intent(in) :: spec

      select case (spec%rule)
      case ('bilinear')
         allocate (rule, source=bilinear_rule(k=spec%k, d_y=spec%d_y, k_post=spec%k_post))
      case ('takeda')
         call new_takeda(rule, spec)
      case ('compression')
         allocate (rule, source=compression_rule(k=spec%k))
      case default
         allocate (rule, source=elastic_rule(k=spec%k))
      end select
   end subroutine new_rule

   subroutine new_takeda(rule, spec)
      class(rule_type), allocatable, intent(out) :: rule
      type(spring_spec), intent(in) :: spec
      type(takeda_rule), allocatable :: takeda

      allocate (takeda)
      takeda%k_c = spec%k_c
      takeda%d_c = spec%d_c
      takeda%k_y = spec%k_y
      takeda%d_y = spec%d_y
      takeda%k_u = spec%k_u
      takeda%b0 = spec%b0
      takeda%b1 = spec%b1
      takeda%inner = spec%inner(:3)
      call move_alloc(takeda, rule)
   end subroutine new_takeda

end module rbs_hysteresis_factory
