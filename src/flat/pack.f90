!> A column as two plain arrays, one of whole numbers and one of reals: how it crosses to Python and back.
!>
!> Both begin with what every column has and the sizes of what some have; the lists follow in the order
!> of the sizes. The Python side is `Column._packed` and `rbsdem.case`.
module rbs_flat_pack
   use, intrinsic :: iso_c_binding, only: c_double, c_int
   use rbs_base_error, only: error_type
   use rbs_base_kinds, only: wp
   use rbs_column_column, only: column_type
   use rbs_solve_make_column, only: make_column
   use rbs_spec_column, only: column_spec
   use rbs_spec_spring, only: spring_spec
   use rbs_spec_spring_table, only: rule_names, inner_names, number_count
   implicit none
   private

   public :: column_from_numbers, numbers_from_column, spring_from_numbers

   !> Places in the whole numbers: number of bodies; switches (0 or 1); sizes of the lists.
   integer, parameter :: code_n = 1, code_weight = 2, code_axial_follows = 3, code_force_follows = 4
   integer, parameter :: code_tangent = 5, code_sizes = 6, code_springs = 13
   !> Lists of reals: lengths, masses, rotary_inertia, modal_damping; then springs: shear, flexure, axial.
   integer, parameter :: lists = 7, plain_lists = 4

   !> Reals before the lists: height, mass, axial_load, gravity, top_mass, top_inertia, depth,
   !> mass_damping, stiffness_damping.
   integer, parameter :: scalars = 9

   !> Codes of a spring: places of rule and inner rule among their names, number of layers. Its numbers are
   !> in the order of `number_names`; for each layer its place, rule and numbers follow.
   integer, parameter :: spring_codes = 3, layer_size = 2 + number_count

contains

   !> Validate a column and make it.
   subroutine column_from_numbers(column, codes, numbers, kinematics, error)
      type(column_type), intent(out) :: column
      integer(c_int), intent(in) :: codes(:)
      real(c_double), intent(in) :: numbers(:)
      character(len=*), intent(in) :: kinematics
      type(error_type), allocatable, intent(out) :: error
      type(column_spec) :: spec
      integer :: at, code, sizes(lists)

      spec%n = codes(code_n)
      spec%self_weight = codes(code_weight) /= 0
      spec%axial_follows = codes(code_axial_follows) /= 0
      spec%force_follows = codes(code_force_follows) /= 0
      spec%tangent_damping = codes(code_tangent) /= 0
      sizes = codes(code_sizes:code_sizes + lists - 1)
      spec%kinematics = kinematics
      spec%height = numbers(1)
      spec%mass = numbers(2)
      spec%axial_load = numbers(3)
      spec%gravity = numbers(4)
      spec%top_mass = numbers(5)
      spec%top_inertia = numbers(6)
      spec%depth = numbers(7)
      spec%mass_damping = numbers(8)
      spec%stiffness_damping = numbers(9)
      at = scalars
      code = code_springs - 1
      call take_list(spec%lengths, numbers, sizes(1), at)
      call take_list(spec%masses, numbers, sizes(2), at)
      call take_list(spec%rotary_inertia, numbers, sizes(3), at)
      call take_list(spec%modal_damping, numbers, sizes(4), at)
      call take_springs(spec%shear, codes, numbers, sizes(5), code, at)
      call take_springs(spec%flexure, codes, numbers, sizes(6), code, at)
      call take_springs(spec%axial, codes, numbers, sizes(7), code, at)
      call make_column(spec, column, error)
   end subroutine column_from_numbers

   !> The inverse, for a validated specification.
   subroutine numbers_from_column(spec, codes, numbers)
      type(column_spec), intent(in) :: spec
      integer(c_int), allocatable, intent(out) :: codes(:)
      real(c_double), allocatable, intent(out) :: numbers(:)

      codes = [spec%n, merge(1, 0, [spec%self_weight, spec%axial_follows, spec%force_follows, &
                                    spec%tangent_damping])]
      numbers = [spec%height, spec%mass, spec%axial_load, spec%gravity, spec%top_mass, &
                 spec%top_inertia, spec%depth, spec%mass_damping, spec%stiffness_damping]
      call put_list(spec%lengths, codes, numbers)
      call put_list(spec%masses, codes, numbers)
      call put_list(spec%rotary_inertia, codes, numbers)
      call put_list(spec%modal_damping, codes, numbers)
      codes = [codes, size(spec%shear), size(spec%flexure), 0]
      if (allocated(spec%axial)) codes(size(codes)) = size(spec%axial)
      call put_springs(spec%shear, codes, numbers)
      call put_springs(spec%flexure, codes, numbers)
      if (allocated(spec%axial)) call put_springs(spec%axial, codes, numbers)
   end subroutine numbers_from_column

   !> The next list of reals; not allocated if it has no size.
   subroutine take_list(list, numbers, length, at)
      real(wp), allocatable, intent(out) :: list(:)
      real(c_double), intent(in) :: numbers(:)
      integer, intent(in) :: length
      !> Place of the last number taken
      integer, intent(inout) :: at

      if (length > 0) list = numbers(at + 1:at + length)
      at = at + length
   end subroutine take_list

   subroutine put_list(list, codes, numbers)
      real(wp), allocatable, intent(in) :: list(:)
      integer(c_int), allocatable, intent(inout) :: codes(:)
      real(c_double), allocatable, intent(inout) :: numbers(:)

      if (allocated(list)) then
         codes = [codes, size(list)]
         numbers = [numbers, list]
      else
         codes = [codes, 0]
      end if
   end subroutine put_list

   !> The next springs; not allocated if there are none.
   subroutine take_springs(springs, codes, numbers, count, code, at)
      type(spring_spec), allocatable, intent(out) :: springs(:)
      integer(c_int), intent(in) :: codes(:)
      real(c_double), intent(in) :: numbers(:)
      integer, intent(in) :: count
      !> Places of the last code and the last number taken
      integer, intent(inout) :: code, at
      integer :: i, length

      if (count == 0) return
      allocate (springs(count))
      do i = 1, count
         length = number_count + codes(code + 3)*layer_size
         springs(i) = spring_from_numbers(rule_names(codes(code + 1)), numbers(at + 1:at + length), &
                                          inner_names(codes(code + 2)))
         code = code + spring_codes
         at = at + length
      end do
   end subroutine take_springs

   subroutine put_springs(springs, codes, numbers)
      type(spring_spec), intent(in) :: springs(:)
      integer(c_int), allocatable, intent(inout) :: codes(:)
      real(c_double), allocatable, intent(inout) :: numbers(:)
      integer(c_int) :: their_codes(spring_codes, size(springs))
      real(c_double), allocatable :: their_numbers(:)
      integer :: i, at, length, layers

      ! Not longer with each spring: a column may have 20000 of them.
      length = size(springs)*number_count
      do i = 1, size(springs)
         if (allocated(springs(i)%layers)) length = length + size(springs(i)%layers)
      end do
      allocate (their_numbers(length))
      at = 0
      do i = 1, size(springs)
         associate (s => springs(i))
            layers = 0
            if (allocated(s%layers)) layers = size(s%layers, 2)
            their_codes(:, i) = [findloc(rule_names == s%rule, .true., dim=1), &
                                 findloc(inner_names == s%inner, .true., dim=1), layers]
            their_numbers(at + 1:at + number_count) = s%numbers()
            at = at + number_count
            if (layers == 0) cycle
            their_numbers(at + 1:at + size(s%layers)) = reshape(s%layers, [size(s%layers)])
            at = at + size(s%layers)
         end associate
      end do
      codes = [codes, reshape(their_codes, [size(their_codes)])]
      numbers = [numbers, their_numbers]
   end subroutine put_springs

   !> A spring from its numbers, and those of its layers behind them.
   pure function spring_from_numbers(rule, numbers, inner) result(spring)
      character(len=*), intent(in) :: rule, inner
      real(c_double), intent(in) :: numbers(:)
      type(spring_spec) :: spring
      integer :: layers

      spring%rule = rule
      spring%inner = inner
      call spring%set_numbers(numbers(:number_count))
      layers = (size(numbers) - number_count)/layer_size
      if (layers > 0) spring%layers = reshape(numbers(number_count + 1:), [layer_size, layers])
   end function spring_from_numbers

end module rbs_flat_pack
