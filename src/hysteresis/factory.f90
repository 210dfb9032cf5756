!> From the numbers of a user to the rule that they belong to.
module rbs_hysteresis_factory
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_bilinear, only: bilinear_rule
   use rbs_hysteresis_compression, only: compression_rule
   use rbs_hysteresis_concrete, only: concrete_rule
   use rbs_hysteresis_deterioration, only: deterioration_type
   use rbs_hysteresis_elastic, only: elastic_rule
   use rbs_hysteresis_layered, only: layered_rule
   use rbs_hysteresis_peak_oriented, only: peak_oriented_rule
   use rbs_hysteresis_pinching, only: pinching_rule
   use rbs_hysteresis_rule, only: rule_type
   use rbs_hysteresis_steel, only: steel_rule
   use rbs_hysteresis_segment, only: segment
   use rbs_hysteresis_takeda, only: takeda_rule
   use rbs_spec_spring, only: spring_spec
   implicit none
   private

   public :: new_rule, carries_axial_load

contains

   !> The rule of a spring whose numbers have been validated.
   recursive subroutine new_rule(rule, spec)
      class(rule_type), allocatable, intent(out) :: rule
      type(spring_spec), intent(in) :: spec
      type(spring_spec) :: whole

      whole = spec
      call whole%fill_defaults()
      select case (spec%rule)
      case ('bilinear')
         allocate (rule, source=bilinear_rule(k=spec%k, d_y=spec%d_y, k_post=spec%k_post))
      case ('takeda')
         call new_takeda(rule, whole)
      case ('peak_oriented')
         allocate (peak_oriented_rule :: rule)
         call fill_capped(rule, whole)
      case ('pinching')
         allocate (rule, source=pinching_rule(kappa_f=whole%kappa_f, kappa_d=whole%kappa_d))
         call fill_capped(rule, whole)
      case ('concrete')
         allocate (rule, source=concrete_rule(whole%k, whole%f_peak, whole%d_peak, whole%k_fall, &
                                              whole%f_res, whole%plastic, whole%contact, whole%misfit, &
                                              whole%wear))
      case ('steel')
         allocate (rule, source=steel_rule(whole%k, whole%f_y, whole%k_post, whole%r0, whole%r1, whole%r2, &
                                           whole%growth, whole%endurance))
      case ('layered')
         call new_layered(rule, spec)
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

   recursive subroutine new_layered(rule, spec)
      class(rule_type), allocatable, intent(out) :: rule
      type(spring_spec), intent(in) :: spec
      type(layered_rule), allocatable :: layered
      integer :: i

      allocate (layered)
      layered%axial_load = spec%axial_load
      layered%y = spec%layers(1, :)
      allocate (layered%slot(size(layered%y)))
      do i = 1, size(layered%y)
         call new_rule(layered%slot(i)%rule, spec%layer(i))
      end do
      call move_alloc(layered, rule)
   end subroutine new_layered

   !> Whether the layers of a spring can carry its axial load; all other springs carry none.
   logical function carries_axial_load(spec)
      type(spring_spec), intent(in) :: spec
      class(rule_type), allocatable :: rule
      type(segment) :: line

      carries_axial_load = .true.
      if (spec%rule /= 'layered') return
      call new_rule(rule, spec)
      call rule%start(line)
      select type (rule)
      type is (layered_rule)
         carries_axial_load = rule%carries
      end select
   end function carries_axial_load

   !> What the rules with a capped backbone share.
   subroutine fill_capped(rule, spec)
      class(rule_type), intent(inout) :: rule
      type(spring_spec), intent(in) :: spec
      real(wp) :: energy

      select type (rule)
      class is (peak_oriented_rule)
         rule%b0 = spec%b0
         call rule%set_backbone(spec%side(1), spec%side(-1))
         associate (positive => spec%side(1), negative => spec%side(-1))
            energy = 0.5_wp*(positive%f_y*positive%d_y + negative%f_y*negative%d_y)
         end associate
         rule%deterioration = deterioration_type(spec%lambda_s*energy, spec%lambda_c*energy, &
                                                 spec%lambda_k*energy, spec%lambda_a*energy, spec%c)
      end select
   end subroutine fill_capped

end module rbs_hysteresis_factory
