!> What the ends of a column need where it moves in time: a footing and a fixed top have inertia of their own.
module rbs_structure_column_ends
   use rbs_base_error, only: error_type, fatal_error, bad_input
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_structure_column_column, only: column_type
   implicit none
   private

   public :: check_inertia_of_ends, check_held_rotation

   !> Rotations of bodies that are differences of numbers this much larger are zero.
   real(wp), parameter :: no_rotation = 1.0e-9_wp

contains

   !> Refuse ends without inertia: no equation of motion would hold them.
   subroutine check_inertia_of_ends(column, error)
      type(column_type), intent(in) :: column
      type(error_type), allocatable, intent(out) :: error

      if (column%footing) then
         if (.not. (column%mass(1) > 0.0_wp .and. column%inertia(1) > 0.0_wp)) then
            call fatal_error(error, bad_input, 'column: footing_mass = '//to_text(column%mass(1))// &
                             ' kg and footing_inertia = '//to_text(column%inertia(1))// &
                             ' kg m2 must be above zero in a dynamic analysis; give those of the footing '// &
                             '(only a static path takes a footing without inertia)')
            return
         end if
      end if
      if (.not. column%held .or. column%mass(column%n) > 0.0_wp) return
      call fatal_error(error, bad_input, "column: with top = 'fixed' a dynamic analysis needs top_mass, "// &
                       'the mass that moves with the top without turning; give one above zero')
   end subroutine check_inertia_of_ends

   !> Refuse an initial state in which a fixed top is turned, or turns.
   subroutine check_held_rotation(column, name, value, error)
      type(column_type), intent(in) :: column
      !> For messages
      character(len=*), intent(in) :: name
      !> Deformations or velocities of the joints (unknowns)
      real(wp), intent(in) :: value(:)
      type(error_type), allocatable, intent(inout) :: error
      real(wp) :: total
      integer :: n

      if (.not. column%held .or. allocated(error)) return
      n = column%n
      total = sum(value(n + 1:2*n))
      if (abs(total) <= no_rotation*maxval(abs(value(n + 1:2*n)))) return
      call fatal_error(error, bad_input, name//": with top = 'fixed' the relative rotations must add up "// &
                       'to zero, not to '//to_text(total)//'; change that of the last joint')
   end subroutine check_held_rotation

end module rbs_structure_column_ends
