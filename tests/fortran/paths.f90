!> Properties of every spring on every path: increments have no effect, and trial moves have none.
module paths
   use check, only: check_same
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_springs, only: follow_path, spring_array
   use rbs_hysteresis_spring_record, only: spring_record
   use samples, only: random_type
   implicit none
   private

   public :: check_increments, check_copies

contains

   !> On a path cut into increments every move ends at the same force, to the last bit.
   subroutine check_increments(error, spec, d, parts)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_record), intent(in) :: spec
      real(wp), intent(in) :: d(:)
      !> Increments of a move
      integer, intent(in) :: parts
      type(spring_array) :: spring
      real(wp) :: f(size(d)), begin
      integer :: i, j

      call follow_path(spec, d, f)
      call spring%create([spec])
      begin = 0.0_wp
      do j = 1, size(d)
         do i = 1, parts - 1
            call spring%advance_to(1, begin + (d(j) - begin)*i/parts)
         end do
         call spring%advance_to(1, d(j))
         call check_same(error, spring%force(1), f(j), 'force')
         begin = d(j)
      end do
   end subroutine check_increments

   !> Trial moves with mark and restore, and copies, change nothing.
   subroutine check_copies(error, spec, d, random, reach)
      type(error_type), allocatable, intent(inout) :: error
      type(spring_record), intent(in) :: spec
      real(wp), intent(in) :: d(:)
      type(random_type), intent(inout) :: random
      !> Size of the trial moves
      real(wp), intent(in) :: reach
      type(spring_array) :: spring, copy
      real(wp) :: f(size(d))
      integer :: j

      call follow_path(spec, d, f)
      call spring%create([spec])
      do j = 1, size(d)
         copy = spring
         call copy%advance_to(1, random%uniform(-reach, reach))
         call spring%mark()
         call spring%advance_to(1, random%uniform(-reach, reach))
         call spring%advance_to(1, random%uniform(-reach, reach))
         call spring%restore()
         if (mod(j, 2) == 0) call spring%forget_mark()
         call spring%advance_to(1, d(j))
         call check_same(error, spring%force(1), f(j), 'force')
      end do
   end subroutine check_copies

end module paths
