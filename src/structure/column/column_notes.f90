!> Notes on a column: what is allowed but perhaps not intended.
module rbs_structure_column_column_notes
   use rbs_base_constants, only: standard_gravity
   use rbs_base_error, only: message_list
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_hysteresis_springs, only: follow_path
   use rbs_structure_column_column_record, only: column_record
   implicit none
   private

   public :: column_notes

   !> Least and largest height of a column [m]: one in millimetres is outside.
   real(wp), parameter :: shortest = 0.05_wp, longest = 100.0_wp

   !> No hinge of concrete or steel yields later [rad].
   real(wp), parameter :: late_yield = 0.2_wp

   !> Axial loads below this share of the lateral strength are hardly meant.
   real(wp), parameter :: hardly_any = 0.005_wp

   !> Lateral strength beside the axial load, M/(h P): a column ten times as long as deep has 0.01 or more.
   real(wp), parameter :: too_weak = 0.003_wp

contains

   !> Sizes in a wrong unit, springs that seem exchanged, loads of a column that do nothing, masses without
   !> weight: each with what to do.
   subroutine column_notes(spec, notes)
      !> Validated
      type(column_record), intent(in) :: spec
      type(message_list), intent(inout) :: notes
      logical :: carried

      if (spec%height < shortest .or. spec%height > longest) then
         call notes%add('column: height = '//to_text(spec%height)//' m is that of no column; lengths are '// &
                        'in m, and 1750 mm is 1.75')
      end if
      if (all(spec%shear%rule == 'takeda') .and. all(spec%flexure%rule == 'bilinear')) then
         call notes%add("column: shear has the rule 'takeda' and flexure 'bilinear', usually it is the "// &
                        'other way round; exchange them if that is meant')
      end if
      ! Axial springs and layers carry the load whatever the kinematics.
      carried = allocated(spec%axial_spring)
      carried = carried .or. any(spec%flexure%rule == 'layered')
      if (spec%kinematics == 'small' .and. .not. carried) then
         if (abs(spec%axial_load) > 0.0_wp) then
            call notes%add('column: axial_load = '//to_text(spec%axial_load)//' N does nothing with '// &
                           "kinematics = 'small'; set kinematics = 'pdelta', which has its second-order "// &
                           'moments, or remove it')
         end if
         if (spec%self_weight .and. spec%gravity > 0.0_wp) then
            call notes%add("column: self_weight does nothing with kinematics = 'small'; set "// &
                           "kinematics = 'pdelta', or remove it")
         end if
      end if
      if (spec%top_mass > 0.0_wp .and. spec%gravity > 0.0_wp .and. .not. abs(spec%axial_load) > 0.0_wp) then
         call notes%add('column: top_mass = '//to_text(spec%top_mass)//' kg has no weight, as axial_load '// &
                        'is zero; give axial_load = '//to_text(anint(spec%top_mass*standard_gravity))// &
                        " N with kinematics = 'pdelta', or gravity = 0 if something else carries it")
      end if
      call balance_notes(spec, notes)
   end subroutine column_notes

   !> Springs and loads that do not go together, as numbers in another unit do: the strength of the lowest
   !> flexural spring is that of a rotation of 0.05 rad.
   subroutine balance_notes(spec, notes)
      !> Validated
      type(column_record), intent(in) :: spec
      type(message_list), intent(inout) :: notes
      real(wp) :: moment(2), stiffness, least

      associate (hinge => spec%flexure(1))
         ! What was drawn is judged where it is drawn; what never yields has no strength.
         if (hinge%rule == 'layered' .or. hinge%rule == 'elastic') return
         call follow_path(hinge, [0.05_wp, late_yield], moment)
         stiffness = hinge%initial_stiffness()
      end associate
      if (spec%kinematics /= 'small' .and. spec%axial_load < 0.0_wp) then
         call notes%add('column: axial_load = '//to_text(spec%axial_load)//' N is tension; compression '// &
                        'is positive')
      end if
      if (moment(2) >= (1.0_wp - 1.0e-9_wp)*stiffness*late_yield) then
         call notes%add('column: flexure does not yield before a rotation of '//to_text(late_yield)// &
                        ' rad; deformations are in rad, and 2.7 mrad is 0.0027')
      end if
      least = moment(1)/spec%height
      if (spec%kinematics /= 'small' .and. least > 0.0_wp .and. least < too_weak*spec%axial_load) then
         call notes%add('column: the lateral strength of flexure, '//to_text(least)//' N, is hardly any '// &
                        'beside axial_load = '//to_text(spec%axial_load)//' N; stiffness is in N m/rad, '// &
                        'forces are in N')
      else if (spec%axial_load > 0.0_wp .and. spec%axial_load < hardly_any*least .and. &
               .not. spec%top_mass > 0.0_wp) then
         call notes%add('column: axial_load = '//to_text(spec%axial_load)//' N is hardly any beside the '// &
                        'lateral strength of '//to_text(least)//' N; loads are in N, and 744 kN is 744e3')
      end if
   end subroutine balance_notes

end module rbs_structure_column_column_notes
