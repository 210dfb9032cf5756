!> A stream of numbers in which an object saves its history variables. One procedure of the object,
!> `serialize`, names each component once; the stream takes the values when it saves and returns them, to the
!> last bit, when it restores. So the two cannot differ, and the numbers can go through an array or a file.
module rbs_base_stream
   use, intrinsic :: iso_fortran_env, only: int64
   use rbs_base_kinds, only: wp
   implicit none
   private

   public :: stream_type

   integer, parameter :: first_room = 16

   type :: stream_type
      !> The numbers, of which the first `count` are used
      real(wp), allocatable :: value(:)
      integer :: count = 0
      !> Whether values are given back, else they are taken
      logical :: restoring = .false.
      !> Whether more numbers were asked for than there are, or one was found that is impossible
      logical :: broken = .false.
      !> Place of the last number that was taken or given back
      integer :: at = 0
   contains
      procedure :: save, restore
      procedure, private :: item_real, item_reals, item_table, item_integer, item_long, item_logical
      procedure, private :: item_logicals
      !> `call stream%item(component)`
      generic :: item => item_real, item_reals, item_table, item_integer, item_long, item_logical, &
         item_logicals
      procedure :: items, item_count
      procedure, private :: step
   end type stream_type

contains

   !> The next `serialize` saves, from the start of the stream.
   pure subroutine save(self)
      class(stream_type), intent(inout) :: self

      self%restoring = .false.
      self%broken = .false.
      self%at = 0
      self%count = 0
   end subroutine save

   !> The next `serialize` restores, from the start of the stream.
   pure subroutine restore(self)
      class(stream_type), intent(inout) :: self

      self%restoring = .true.
      self%broken = .false.
      self%at = 0
   end subroutine restore

   !> Go on by n numbers; `from` is the place before the first of them. A stream that saves gets longer; one
   !> that restores is broken where it has not as many.
   pure subroutine step(self, n, from)
      class(stream_type), intent(inout) :: self
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
      ! Room for the numbers is doubled where it is too small.
      if (.not. allocated(self%value)) allocate (self%value(max(first_room, self%at)))
      if (self%at <= size(self%value)) return
      allocate (longer(2*self%at))
      longer(:from) = self%value(:from)
      call move_alloc(longer, self%value)
   end subroutine step

   !> Save a number, or restore it.
   pure subroutine item_real(self, x)
      class(stream_type), intent(inout) :: self
      real(wp), intent(inout) :: x
      integer :: from

      call self%step(1, from)
      if (.not. self%restoring) then
         self%value(from + 1) = x
      else if (.not. self%broken) then
         x = self%value(from + 1)
      end if
   end subroutine item_real

   !> Save or restore two to eight numbers, one after the other.
   pure subroutine items(self, x_1, x_2, x_3, x_4, x_5, x_6, x_7, x_8)
      class(stream_type), intent(inout) :: self
      real(wp), intent(inout) :: x_1, x_2
      real(wp), intent(inout), optional :: x_3, x_4, x_5, x_6, x_7, x_8

      call self%item_real(x_1)
      call self%item_real(x_2)
      if (present(x_3)) call self%item_real(x_3)
      if (present(x_4)) call self%item_real(x_4)
      if (present(x_5)) call self%item_real(x_5)
      if (present(x_6)) call self%item_real(x_6)
      if (present(x_7)) call self%item_real(x_7)
      if (present(x_8)) call self%item_real(x_8)
   end subroutine items

   !> Save numbers, or restore them.
   pure subroutine item_reals(self, x)
      class(stream_type), intent(inout) :: self
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
   end subroutine item_reals

   !> Save or restore a table of numbers, column by column.
   pure subroutine item_table(self, x)
      class(stream_type), intent(inout) :: self
      real(wp), intent(inout), contiguous :: x(:, :)
      integer :: j

      do j = 1, size(x, 2)
         call self%item_reals(x(:, j))
      end do
   end subroutine item_table

   !> Save or restore a whole number, as a real one; the stream is broken if it is too large for an integer.
   pure subroutine item_integer(self, i)
      class(stream_type), intent(inout) :: self
      integer, intent(inout) :: i
      real(wp) :: x

      x = real(i, wp)
      call self%item_real(x)
      if (.not. self%restoring .or. self%broken) return
      self%broken = .not. abs(x) <= real(huge(i), wp)
      if (.not. self%broken) i = nint(x)
   end subroutine item_integer

   !> Save or restore a long whole number, as a real one: these are serial numbers, far below 2**53, up to
   !> which they are exact.
   pure subroutine item_long(self, i)
      class(stream_type), intent(inout) :: self
      integer(int64), intent(inout) :: i
      real(wp) :: x

      x = real(i, wp)
      call self%item_real(x)
      if (.not. self%restoring .or. self%broken) return
      self%broken = .not. abs(x) <= 2.0_wp**53
      if (.not. self%broken) i = nint(x, int64)
   end subroutine item_long

   !> Save or restore a logical, as 0 or 1.
   pure subroutine item_logical(self, is)
      class(stream_type), intent(inout) :: self
      logical, intent(inout) :: is
      real(wp) :: x

      x = merge(1.0_wp, 0.0_wp, is)
      call self%item_real(x)
      if (self%restoring .and. .not. self%broken) is = x > 0.5_wp
   end subroutine item_logical

   !> Save or restore logicals.
   pure subroutine item_logicals(self, are)
      class(stream_type), intent(inout) :: self
      logical, intent(inout) :: are(:)
      integer :: i

      do i = 1, size(are)
         call self%item_logical(are(i))
      end do
   end subroutine item_logicals

   !> Save or restore the length of a list that may have up to `most` elements; another length breaks the
   !> stream.
   pure subroutine item_count(self, count, most)
      class(stream_type), intent(inout) :: self
      integer, intent(inout) :: count
      integer, intent(in) :: most
      integer :: n

      n = count
      call self%item_integer(n)
      self%broken = self%broken .or. n < 0 .or. n > most
      if (.not. self%broken) count = n
   end subroutine item_count

end module rbs_base_stream
