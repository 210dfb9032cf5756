!> Places of the values that all rows hold.
module row_places
   implicit none
   public

   integer, parameter :: row_time = 1, row_displacement = 2, row_force = 3, row_input = 4, row_kinetic = 5, &
                         row_spring = 6, row_damping = 7, row_axial = 8, row_residual = 9, row_top = 10, &
                         row_joints = 11

end module row_places
