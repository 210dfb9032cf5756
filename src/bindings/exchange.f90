!> Exchange between Python and Fortran: a request, which names a question and brings a text and
!> numbers, and its answer, a text and numbers of any length.
module rbs_bindings_exchange
   use, intrinsic :: iso_c_binding, only: c_double
   use rbs_base_error, only: error_type
   use rbs_solve_end_state, only: end_state
   use rbs_structure_structure, only: structure_type
   implicit none
   private

   public :: request_type, answer_type

   !> A question of Python, see `rbs_bindings_evaluate`.
   type :: request_type
      !> Name of the question
      character(len=:), allocatable :: what
      !> Groups of keys (see `rbs_bindings_statements`) or another text, and the numbers of the keys
      character(len=:), allocatable :: statement
      real(c_double), pointer, contiguous :: number(:) => null()
      !> Arrays with names: name and size of each ('values:100'), separated by blanks, and all their numbers
      !> one after the other
      character(len=:), allocatable :: names
      real(c_double), pointer, contiguous :: input(:) => null()
      !> The answer that holds the structure of an analysis
      type(answer_type), pointer :: made => null()
   contains
      procedure :: array, whole, wants
   end type request_type

   !> What Python gets.
   type :: answer_type
      type(error_type), allocatable :: error
      character(len=:), allocatable :: text
      real(c_double), allocatable :: value(:)
      !> Each column of the array is a row for Python; if not all of them count, `kept` is how many do
      real(c_double), allocatable :: rows(:, :)
      integer :: kept = -1
      !> A structure, which all analyses of it share, and the state that they begin in
      class(structure_type), allocatable :: structure
      type(end_state) :: before
   end type answer_type

contains

   !> The numbers of one of the named arrays, in place; empty if it is not given.
   function array(self, name) result(values)
      class(request_type), intent(in) :: self
      !> Name of the array
      character(len=*), intent(in) :: name
      real(c_double), pointer, contiguous :: values(:)
      character(len=20) :: length
      integer :: first, last, mark, at, count

      ! The arrays stand in `input` in the order of their names.
      at = 0
      first = 1
      do while (first <= len(self%names))
         last = first + index(self%names(first:)//' ', ' ') - 2
         mark = first + index(self%names(first:last), ':') - 1
         length = self%names(mark + 1:last)
         read (length, *) count
         values => self%input(at + 1:at + count)
         if (self%names(first:mark - 1) == name) return
         at = at + count
         first = last + 2
      end do
      values => self%input(1:0)
   end function array

   !> A whole number, the first of a named array, which must be given.
   integer function whole(self, name)
      class(request_type), intent(in) :: self
      !> Name of the array
      character(len=*), intent(in) :: name
      real(c_double), pointer, contiguous :: values(:)

      values => self%array(name)
      whole = nint(values(1))
   end function whole

   !> Whether a switch, a named array, is given and not zero.
   logical function wants(self, name)
      class(request_type), intent(in) :: self
      !> Name of the switch
      character(len=*), intent(in) :: name

      wants = any(abs(self%array(name)) > 0.0_c_double)
   end function wants

end module rbs_bindings_exchange
