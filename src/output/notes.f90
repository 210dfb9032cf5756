!> Notes on a column and on a run: what is allowed but perhaps not intended.
module rbs_output_notes
   use rbs_base_constants, only: standard_gravity
   use rbs_base_error, only: message_list
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_column_column, only: column_type, small, finite
   use rbs_column_column_record, only: column_record
   use rbs_output_summary, only: summary_type
   implicit none
   private

   public :: column_notes, rotation_note

   !> Least and largest height of a column [m]: one in millimetres is outside.
   real(wp), parameter :: shortest = 0.05_wp, longest = 100.0_wp

   !> Rotations larger than this are not small [rad].
   real(wp), parameter :: largest_small = 0.1_wp

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
   end subroutine column_notes

   !> Rotations that are taken as small but have grown large. The first term that is left out of sin(th) is
   !> th^3/6, an error of th^2/6; in cos(th), which lever arms contain, the error is th^2/2.
   subroutine rotation_note(column, summary, text)
      type(column_type), intent(in) :: column
      type(summary_type), intent(in) :: summary
      !> Empty if there is no note
      character(len=:), allocatable, intent(out) :: text
      character(len=6) :: kinematics

      text = ''
      ! A run to its collapse was asked for, and its rotations are known to be large.
      if (summary%collapsed) return
      if (column%kinematics == finite .or. .not. summary%peak_rotation > largest_small) return
      kinematics = 'pdelta'
      if (column%kinematics == small) kinematics = 'small'
      ! Without a number of its own, so that a session that makes many runs is told once.
      if (summary%peak_rotation < 1.0_wp) then
         text = "the rotation of a body goes beyond 0.1 rad; with kinematics = '"//trim(kinematics)// &
                "' the displacement errs by about th^2/6 of it, where th is peak_rotation; use 'finite'"
      else
         text = "the rotation of a body goes beyond 1 rad; with kinematics = '"//trim(kinematics)// &
                "' the displacement has no meaning then (displacements are in m, forces in N); use 'finite'"
      end if
   end subroutine rotation_note

end module rbs_output_notes
