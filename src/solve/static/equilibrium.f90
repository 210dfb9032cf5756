!> Equilibrium of a structure on the present lines of its springs, and how it goes on.
!>
!> While every spring stays on its line, all is linear in what is driven: the number F that the pattern p of
!> the lateral load is multiplied with, or the displacement of the top, a row c of the unknowns. This is
!> found exactly, without increments:
!>
!>     K x' = p F',   c x' = u'        K = B' diag(k) B + K_G
!>
!> with F' = 1 or u' = 1. How the system is solved is the affair of each kind of structure; a path knows no
!> more of it than this.
module rbs_solve_static_equilibrium
   use rbs_base_kinds, only: wp
   use rbs_base_stream, only: stream_type
   use rbs_hysteresis_springs, only: spring_array
   implicit none
   private

   public :: equilibrium_type

   type, abstract :: equilibrium_type
      !> Whether the dead load of a frame grows with the force, from 0 to 1, in place of the lateral one
      logical :: loads = .false.
      !> Number of springs that can move; they are the first ones
      integer :: moving = 0
      !> Rates of force and displacement, and of the way on which the force does its work as far as it is
      !> not the displacement
      real(wp) :: force_rate = 0.0_wp, displacement_rate = 0.0_wp, further_rate = 0.0_wp
      !> What takes the structure to equilibrium: of the deformations (moving), and of the force [N]
      real(wp), allocatable :: correction(:)
      real(wp) :: force_correction = 0.0_wp
      !> The largest force that was found out of equilibrium before the correction; 0 where rates
      !> followed from the last ones [N]
      real(wp) :: unbalance = 0.0_wp
   contains
      procedure(follow_lines), deferred :: follow
      procedure(measure_unbalance), deferred :: find_unbalance
      procedure :: serialize
   end type equilibrium_type

   abstract interface
      !> Find rates and corrections on the present lines.
      subroutine follow_lines(self, springs, by_force, corrects, displacement, force, rate, found)
         import :: equilibrium_type, spring_array, wp
         implicit none
         class(equilibrium_type), intent(inout) :: self
         type(spring_array), intent(in) :: springs
         !> Whether the force is driven, else the displacement; under the force the structure must be stable
         logical, intent(in) :: by_force
         !> Whether the corrections are needed; else rates may follow from the last ones, without any
         logical, intent(in) :: corrects
         !> Of the top [m], and lateral force [N]
         real(wp), intent(in) :: displacement, force
         !> Rates of the deformations (moving)
         real(wp), intent(inout), contiguous :: rate(:)
         logical, intent(out) :: found
      end subroutine follow_lines

      !> Find the largest force by which a joint is out of equilibrium.
      subroutine measure_unbalance(self, springs, force)
         import :: equilibrium_type, spring_array, wp
         implicit none
         class(equilibrium_type), intent(inout) :: self
         type(spring_array), intent(in) :: springs
         real(wp), intent(in) :: force
      end subroutine measure_unbalance
   end interface

contains

   !> Save or restore the rates, and what the next ones may follow from: here nothing.
   subroutine serialize(self, stream)
      class(equilibrium_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%items(self%force_rate, self%displacement_rate, self%further_rate)
   end subroutine serialize

end module rbs_solve_static_equilibrium
