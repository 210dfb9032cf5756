!> Symmetric matrices with few elements, column by column of their lower triangle.
module rbs_base_sparse_matrix
   use rbs_base_kinds, only: wp
   implicit none
   private

   public :: sparse_matrix, sparse_of

   type :: sparse_matrix
      !> Place of the diagonal element of each column, and one behind the last element (size + 1); rows and
      !> values of the elements
      integer, allocatable, private :: start(:), row(:)
      real(wp), allocatable, private :: value(:)
   contains
      procedure :: subtract_product, add_to
   end type sparse_matrix

contains

   !> The elements of a lower band that are not zero.
   pure type(sparse_matrix) function sparse_of(band) result(self)
      !> band(1 + i - j, j) = a(i, j) for i >= j (half_width + 1, size)
      real(wp), intent(in) :: band(:, :)
      integer :: i, j, at

      at = size(band, 2) + count(abs(band(2:, :)) > 0.0_wp)
      allocate (self%start(size(band, 2) + 1), self%row(at), self%value(at))
      at = 0
      do j = 1, size(band, 2)
         self%start(j) = at + 1
         do i = 1, size(band, 1)
            if (i > 1 .and. .not. abs(band(i, j)) > 0.0_wp) cycle
            at = at + 1
            self%row(at) = j + i - 1
            self%value(at) = band(i, j)
         end do
      end do
      self%start(size(band, 2) + 1) = at + 1
   end function sparse_of

   !> Subtract from g the matrix times the column x.
   pure subroutine subtract_product(self, x, g)
      class(sparse_matrix), intent(in) :: self
      !> Columns (size)
      real(wp), intent(in), contiguous :: x(:)
      real(wp), intent(inout), contiguous :: g(:)
      real(wp) :: product
      integer :: j, k

      do j = 1, size(self%start) - 1
         product = self%value(self%start(j))*x(j)
         do k = self%start(j) + 1, self%start(j + 1) - 1
            product = product + self%value(k)*x(self%row(k))
            g(self%row(k)) = g(self%row(k)) - self%value(k)*x(j)
         end do
         g(j) = g(j) - product
      end do
   end subroutine subtract_product

   !> Add a multiple of the matrix to a lower band.
   pure subroutine add_to(self, factor, band)
      class(sparse_matrix), intent(in) :: self
      real(wp), intent(in) :: factor
      !> band(1 + i - j, j) = a(i, j) for i >= j (half_width + 1, size)
      real(wp), intent(inout), contiguous :: band(:, :)
      integer :: j, k

      do j = 1, size(self%start) - 1
         do k = self%start(j), self%start(j + 1) - 1
            associate (element => band(1 + self%row(k) - j, j))
               element = element + factor*self%value(k)
            end associate
         end do
      end do
   end subroutine add_to

end module rbs_base_sparse_matrix
