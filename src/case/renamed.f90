!> Names of an earlier format of the case file, so that messages can give the new names.
module rbs_case_renamed
   implicit none
   private

   public :: new_group, new_key, new_word

   integer, parameter :: length = 24, text_length = 96

   type :: change
      character(len=length) :: group, key
      !> The text of the message after 'is now'
      character(len=text_length) :: now
   end type change

   type(change), parameter :: changes(*) = [ &
      change('opening', '', '&axial_spring'), &
      change('axial', '', 'part of &column: axial_load, self_weight, gravity, axial_follows'), &
      change('layer', '', '&layer_spring id = ..., rule = ..., and &layers y = ..., spring = ...'), &
      change('drive', 'ground', "'ground_acceleration'"), &
      change('drive', 'vertical', "'vertical_acceleration'"), &
      change('drive', 'axial', "'axial_load'"), &
      change('column', 'mass_damping', "'mass' of the group &damping"), &
      change('column', 'stiffness_damping', "'stiffness' of the group &damping"), &
      change('column', 'tangent_damping', "'tangent' of the group &damping"), &
      change('column', 'modal_damping', "'modal' of the group &damping"), &
      change('loading', 'follows', "'force_follows' of the group &column"), &
      change('flexure', 'axial_load', "'axial_load' of the group &column, for layered joints too"), &
      change('*', 'k_fall', "'k_soft'"), &
      change('*', 'r1', "'cr1'"), &
      change('*', 'r2', "'cr2'"), &
      change('*', 'growth', "'isotropic_hardening'"), &
      change('*', 'half_strength_work', "'endurance', a plastic deformation over d_y")]

contains

   !> The new name of a group; blank if it was not renamed.
   pure function new_group(group) result(now)
      character(len=*), intent(in) :: group
      character(len=text_length) :: now

      now = new_key(group, '')
   end function new_group

   !> The new name of a key; blank if it was not renamed.
   pure function new_key(group, key) result(now)
      character(len=*), intent(in) :: group, key
      character(len=text_length) :: now
      integer :: i

      now = ''
      do i = 1, size(changes)
         if (changes(i)%key /= key) cycle
         if (changes(i)%group /= group .and. changes(i)%group /= '*') cycle
         now = changes(i)%now
         return
      end do
   end function new_key

   !> The new name of a word of a key; blank if it was not renamed.
   pure function new_word(key, word) result(now)
      character(len=*), intent(in) :: key, word
      character(len=text_length) :: now

      now = ''
      if (any(changes%group == key)) now = new_key(key, word)
   end function new_word

end module rbs_case_renamed
