!> Notes on a run: what is allowed but perhaps not intended.
module rbs_output_notes
   use rbs_base_error, only: message_list
   use rbs_base_kinds, only: wp
   use rbs_structure_structure, only: structure_type, small, finite
   use rbs_output_summary, only: summary_type
   implicit none
   private

   public :: drift_note, rotation_note

   !> Rotations larger than this are not small [rad].
   real(wp), parameter :: largest_small = 0.1_wp

   !> Displacements beyond this share of the height are hardly meant.
   real(wp), parameter :: far = 0.5_wp

contains

   !> Rotations that are taken as small but have grown large. What is left out of sin(th) is th^2/6 of it, and
   !> what is left out of cos(th), which lever arms contain, th^2/2: together 2 th^2/3.
   subroutine rotation_note(structure, summary, notes)
      class(structure_type), intent(in) :: structure
      type(summary_type), intent(in) :: summary
      type(message_list), intent(inout) :: notes
      character(len=6) :: kinematics
      integer :: before

      ! A run to its collapse was asked for, and its rotations are known to be large.
      if (summary%collapsed) return
      if (structure%kinematics == finite) return
      ! A path is given; a response in time goes where it goes.
      if (.not. summary%time_step > 0.0_wp) then
         before = notes%count
         call drift_note(summary%peak_displacement, structure%total_height, notes)
         if (notes%count > before) return
      end if
      if (.not. summary%peak_rotation > largest_small) return
      kinematics = 'pdelta'
      if (structure%kinematics == small) kinematics = 'small'
      ! Without a number of its own, so that a session that makes many runs is told once.
      if (summary%peak_rotation < 1.0_wp) then
         call notes%add("the rotation of a body goes beyond 0.1 rad; with kinematics = '"// &
                        trim(kinematics)//"' displacements and forces err by about 2 th^2/3 of them "// &
                        "(0.7 % at 0.1 rad, 2.7 % at 0.2 rad), where th is peak_rotation; use 'finite'")
      else
         call notes%add("the rotation of a body goes beyond 1 rad; with kinematics = '"//trim(kinematics)// &
                        "' the displacement has no meaning then (displacements are in m, forces in N); "// &
                        "use 'finite'")
      end if
   end subroutine rotation_note

   !> A displacement beyond half of the height, which a number in another unit is.
   subroutine drift_note(displacement, height, notes)
      !> Largest of the top, and height [m]
      real(wp), intent(in) :: displacement, height
      type(message_list), intent(inout) :: notes

      if (.not. abs(displacement) > far*height) return
      call notes%add('the top goes beyond half of the height; displacements are in m (16 mm is 0.016), '// &
                     'drifts are parts of the height (2 per cent is 0.02), forces are in N; if it is '// &
                     "meant, use kinematics = 'finite'")
   end subroutine drift_note

end module rbs_output_notes
