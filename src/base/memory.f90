!> A tape of numbers on which an object keeps what it remembers. One procedure of the object, `walk`, presents
!> each component once; the tape takes the values when it saves and gives them back, to the last bit, when it
!> restores. So the two cannot differ, and the numbers can go through an array or a file.
module rbs_base_memory
   use, intrinsic :: iso_fortran_env, only: int64
   use rbs_base_kinds, only: wp
   implicit none
   private

   public :: memory_type

   integer, parameter :: first_room = 16

   type :: memory_type
      !> The numbers, of which the first `count` are used
      real(wp), allocatable :: value(:)
      integer :: count = 0
      !> Whether values are given back, else they are taken
      logical :: restoring = .false.
      !> Whether more numbers were asked for than there are, or one that cannot be what it should be
      logical :: broken = .false.
      !> Place of the last number that was taken or given back
      integer :: at = 0
   contains
      procedure :: save
      procedure :: restore
      procedure, private :: keep_real, keep_reals, keep_table, keep_integer, keep_long, keep_logical
      procedure, private :: keep_logicals
      !> `call memory%keep(component)`
      generic :: keep => keep_real, keep_reals, keep_table, keep_integer, keep_long, keep_logical, &
         keep_logicals
      procedure :: keep_count
      procedure, private :: step
   end type memory_type

contains

   !> The next walk saves, from the start of the tape.
   pure subroutine save(self)
      class(memory_type), intent(inout) :: self

      self%restoring = .false.
      self%broken = .false.
      self%at = 0
      self%count = 0
   end subroutine save

   !> The next walk restores, from the start of the tape.
   pure subroutine restore(self)
      class(memory_type), intent(inout) :: self

      self%restoring = .true.
      self%broken = .false.
      self%at = 0
   end subroutine restore

   !> Go on by n numbers; `from` is the place before the first of them.
   pure subroutine step(self, n, from)
      class(memory_type), intent(inout) :: self
      integer, intent(in) :: n
      integer, intent(out) :: from
      real(wp), allocatable :: longer(:)

      from = self%at
      self%at = from + n
      if (self%restoring) then
         self%broken = self%broken .or. self%at > self%count
         return
      end if
      self%count = self%at
      if (.not. allocated(self%value)) allocate (self%value(max(first_room, self%at)))
      if (self%at <= size(self%value)) return
      allocate (longer(2*self%at))
      longer(:from) = self%value(:from)
      call move_alloc(longer, self%value)
   end subroutine step

   pure subroutine keep_real(self, x)
      class(memory_type), intent(inout) :: self
      real(wp), intent(inout) :: x
      integer :: from

      call self%step(1, from)
      if (.not. self%restoring) then
         self%value(from + 1) = x
      else if (.not. self%broken) then
         x = self%value(from + 1)
      end if
   end subroutine keep_real

   pure subroutine keep_reals(self, x)
      class(memory_type), intent(inout) :: self
      real(wp), intent(inout), contiguous :: x(:)
      integer :: from, i

      call self%step(size(x), from)
      if (.not. self%restoring) then
         do i = 1, size(x)
            self%value(from + i) = x(i)
         end do
      else if (.not. self%broken) then
         do i = 1, size(x)
            x(i) = self%value(from + i)
         end do
      end if
   end subroutine keep_reals

   pure subroutine keep_table(self, x)
      class(memory_type), intent(inout) :: self
      real(wp), intent(inout), contiguous :: x(:, :)
      integer :: j

      do j = 1, size(x, 2)
         call self%keep_reals(x(:, j))
      end do
   end subroutine keep_table

   pure subroutine keep_integer(self, i)
      class(memory_type), intent(inout) :: self
      integer, intent(inout) :: i
      real(wp) :: x

      x = real(i, wp)
      call self%keep_real(x)
      if (.not. self%restoring .or. self%broken) return
      self%broken = .not. abs(x) <= real(huge(i), wp)
      if (.not. self%broken) i = nint(x)
   end subroutine keep_integer

   !> Serial numbers stay far below 2**53, up to which they are exact.
   pure subroutine keep_long(self, i)
      class(memory_type), intent(inout) :: self
      integer(int64), intent(inout) :: i
      real(wp) :: x

      x = real(i, wp)
      call self%keep_real(x)
      if (.not. self%restoring .or. self%broken) return
      self%broken = .not. abs(x) <= 2.0_wp**53
      if (.not. self%broken) i = nint(x, int64)
   end subroutine keep_long

   pure subroutine keep_logical(self, is)
      class(memory_type), intent(inout) :: self
      logical, intent(inout) :: is
      real(wp) :: x

      x = merge(1.0_wp, 0.0_wp, is)
      call self%keep_real(x)
      if (self%restoring .and. .not. self%broken) is = x > 0.5_wp
   end subroutine keep_logical

   pure subroutine keep_logicals(self, are)
      class(memory_type), intent(inout) :: self
      logical, intent(inout) :: are(:)
      integer :: i

      do i = 1, size(are)
         call self%keep_logical(are(i))
      end do
   end subroutine keep_logicals

   !> The length of a list that has room for `most`.
   pure subroutine keep_count(self, count, most)
      class(memory_type), intent(inout) :: self
      integer, intent(inout) :: count
      integer, intent(in) :: most
      integer :: n

      n = count
      call self%keep_integer(n)
      self%broken = self%broken .or. n < 0 .or. n > most
      if (.not. self%broken) count = n
   end subroutine keep_count

end module rbs_base_memory
