!> Notes on a run: what is allowed but perhaps not intended.
module rbs_output_notes
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_column_column, only: column_type, small, finite
   use rbs_output_summary, only: summary_type
   implicit none
   private

   public :: rotation_note

   !> Rotations larger than this are not small [rad].
   real(wp), parameter :: largest_small = 0.1_wp

contains

   !> Rotations that are taken as small but have grown large. The first term that is left out of sin(th) is
   !> th^3/6, an error of th^2/6; in cos(th), which lever arms contain, the error is th^2/2.
   subroutine rotation_note(column, summary, text)
      type(column_type), intent(in) :: column
      type(summary_type), intent(in) :: summary
      !> Empty if there is no note
      character(len=:), allocatable, intent(out) :: text
      character(len=6) :: kinematics
      real(wp) :: percent

      text = ''
      if (column%kinematics == finite .or. .not. summary%peak_rotation > largest_small) return
      kinematics = 'pdelta'
      if (column%kinematics == small) kinematics = 'small'
      text = 'the rotation of a body reaches '//to_text(summary%peak_rotation)//' rad; with '// &
             "kinematics = '"//trim(kinematics)//"' the displacement "
      if (summary%peak_rotation < 1.0_wp) then
         percent = 0.01_wp*anint(1.0e4_wp*summary%peak_rotation**2/6.0_wp)
         text = text//'errs by about '//to_text(percent)//' % (th^2/6)'
      else
         text = text//'has no meaning then'
      end if
      text = text//"; use 'finite'"
   end subroutine rotation_note

end module rbs_output_notes
