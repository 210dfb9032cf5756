!> Springs, columns and paths that several suites use.
module samples
   use, intrinsic :: iso_fortran_env, only: int64
   use rbs_base_check, only: is_given
   use rbs_base_constants, only: unset
   use rbs_base_error, only: error_type
   use rbs_base_keys, only: key_type, find_key
   use rbs_base_kinds, only: wp
   use rbs_structure_column_column, only: column_type
   use rbs_solve_begin_make_column, only: make_column
   use rbs_structure_column_column_record, only: column_record
   use rbs_hysteresis_registry, only: keys_of
   use rbs_hysteresis_rule, only: spring_rules
   use rbs_hysteresis_spring_record, only: spring_record, add_rules
   use rbs_hysteresis_springs, only: spring_array
   implicit none
   private

   public :: make_springs
   public :: elastic, bilinear, compression, takeda, bilinear_1, takeda_1, column_1, chain, rich_column, made
   public :: concrete_1, steel_1, capped, random_type, set_value, value_of

   !> Soesianawati & Park No 1, table 3 of the paper: flexure [N m, rad] ...
   real(wp), parameter, public :: k_c = 2.5428e8_wp, d_c = 3.1891e-4_wp
   real(wp), parameter, public :: k_y = 6.2937e7_wp, d_y = 2.7183e-3_wp, k_u = 7.5772e6_wp
   real(wp), parameter, public :: b0 = 0.4_wp, b1 = 0.22_wp
   real(wp), parameter, public :: f_c = k_c*d_c, f_y = f_c + k_y*(d_y - d_c)
   real(wp), parameter, public :: k_0 = (f_c + f_y)/(d_c + d_y)
   !> ... and shear [N, m]
   real(wp), parameter, public :: s_k = 7.0387e8_wp, s_d = 1.2960e-4_wp, s_post = 8.3185e6_wp
   !> Mass [kg] and height [m] of the column
   real(wp), parameter, public :: mass_1 = 614.4_wp, height_1 = 1.6_wp

   !> Random numbers that are the same on every machine (Lehmer, 2**31 - 1).
   type :: random_type
      integer(int64) :: state = 20240229_int64
   contains
      procedure :: uniform
      procedure :: uniform_array
   end type random_type

contains

   !> Virgin springs; they refer to their rules, which stay.
   subroutine make_springs(springs, specs, told)
      type(spring_array), intent(out) :: springs
      type(spring_record), intent(in) :: specs(:)
      !> As in `create`; without it none is told
      integer, intent(in), optional :: told(:)
      type(spring_rules), pointer :: rules
      integer :: work_source(2, size(specs))
      real(wp) :: axial_load(size(specs))

      work_source = 0
      if (present(told)) work_source = spread(told, 1, 2)
      axial_load = specs%axial_load
      allocate (rules)
      call add_rules(rules, specs, size(specs))
      call springs%create(rules, work_source, axial_load, size(specs))
   end subroutine make_springs

   !> The next number between two bounds.
   real(wp) function uniform(self, low, high) result(x)
      class(random_type), intent(inout) :: self
      real(wp), intent(in) :: low, high

      self%state = mod(48271_int64*self%state, 2147483647_int64)
      x = low + (high - low)*real(self%state, wp)/2147483647.0_wp
   end function uniform

   !> The next m numbers.
   function uniform_array(self, low, high, m) result(x)
      class(random_type), intent(inout) :: self
      real(wp), intent(in) :: low, high
      integer, intent(in) :: m
      real(wp) :: x(m)
      integer :: i

      do i = 1, m
         x(i) = self%uniform(low, high)
      end do
   end function uniform_array

   !> Set a parameter of a spring by name. A name that its rule does not have leaves the record as it is.
   subroutine set_value(spec, name, value)
      type(spring_record), intent(inout) :: spec
      character(len=*), intent(in) :: name
      real(wp), intent(in) :: value
      type(key_type), allocatable :: keys(:)
      integer :: place

      call keys_of(spec%rule, keys)
      place = find_key(keys, name)
      if (place > 0) spec%value(place) = value
   end subroutine set_value

   !> A parameter by name, its default where none was given; `unset` if the rule does not have it.
   impure elemental real(wp) function value_of(spec, name) result(value)
      type(spring_record), intent(in) :: spec
      character(len=*), intent(in) :: name
      type(key_type), allocatable :: keys(:)
      integer :: place

      value = unset
      call keys_of(spec%rule, keys)
      place = find_key(keys, name)
      if (place == 0) return
      value = spec%value(place)
      if (.not. is_given(value)) value = keys(place)%default
   end function value_of

   type(spring_record) function elastic(k) result(spec)
      real(wp), intent(in) :: k

      spec%rule = 'elastic'
      call set_value(spec, 'k', k)
   end function elastic

   type(spring_record) function bilinear(k, d_y, k_post) result(spec)
      real(wp), intent(in) :: k, d_y, k_post

      spec%rule = 'bilinear'
      call set_value(spec, 'k', k)
      call set_value(spec, 'd_y', d_y)
      call set_value(spec, 'k_post', k_post)
   end function bilinear

   type(spring_record) function compression(k) result(spec)
      real(wp), intent(in) :: k

      spec%rule = 'compression'
      call set_value(spec, 'k', k)
   end function compression

   type(spring_record) function takeda(k_c, d_c, k_y, d_y, k_u, b0, b1, inner) result(spec)
      real(wp), intent(in) :: k_c, d_c, k_y, d_y, k_u, b0, b1
      character(len=*), intent(in) :: inner

      spec%rule = 'takeda'
      call set_value(spec, 'k_c', k_c)
      call set_value(spec, 'd_c', d_c)
      call set_value(spec, 'k_y', k_y)
      call set_value(spec, 'd_y', d_y)
      call set_value(spec, 'k_u', k_u)
      call set_value(spec, 'b0', b0)
      call set_value(spec, 'b1', b1)
      call set_value(spec, 'inner', real(findloc(['kc ', 'kr ', 'one'] == inner, .true., dim=1), wp))
   end function takeda

   !> Shear spring of column 1.
   type(spring_record) function bilinear_1() result(spec)
      spec = bilinear(s_k, s_d, s_post)
   end function bilinear_1

   !> Flexural spring of column 1.
   type(spring_record) function takeda_1(inner) result(spec)
      character(len=*), intent(in) :: inner

      spec = takeda(k_c, d_c, k_y, d_y, k_u, b0, b1, inner)
   end function takeda_1

   !> A strip of a joint of 30 MPa concrete, 0.4 m by 0.4 m and 0.3 m long.
   type(spring_record) function concrete_1(share) result(spec)
      !> Share of the area
      real(wp), intent(in) :: share

      spec%rule = 'concrete'
      call set_value(spec, 'k', 1.6e10_wp*share)
      call set_value(spec, 'f_peak', 4.8e6_wp*share)
      call set_value(spec, 'd_peak', 6.0e-4_wp)
      call set_value(spec, 'k_soft', 2.4e9_wp*share)
      call set_value(spec, 'f_res', 1.0e6_wp*share)
      call set_value(spec, 'plastic', 1.2_wp)
      call set_value(spec, 'contact', 0.35_wp)
      call set_value(spec, 'misfit', 0.4_wp)
      call set_value(spec, 'wear', 0.03_wp)
   end function concrete_1

   !> A row of bars of the joint, 1600 mm2 of 450 MPa over 0.4 m.
   type(spring_record) function steel_1() result(spec)
      spec%rule = 'steel'
      call set_value(spec, 'k', 8.0e8_wp)
      call set_value(spec, 'f_y', 7.2e5_wp)
      call set_value(spec, 'k_post', 8.0e6_wp)
      call set_value(spec, 'isotropic_hardening', 0.01_wp)
      call set_value(spec, 'endurance', 2000.0_wp)
   end function steel_1

   !> Elastic 100 up to (1, 100), cap (3, 120), softening with -10 to the residual 20 at 13.
   type(spring_record) function capped(rule) result(spec)
      character(len=*), intent(in) :: rule

      spec%rule = rule
      call set_value(spec, 'd_y', 1.0_wp)
      call set_value(spec, 'f_y', 100.0_wp)
      call set_value(spec, 'd_cap', 3.0_wp)
      call set_value(spec, 'f_cap', 120.0_wp)
      call set_value(spec, 'd_pc', 12.0_wp)
      call set_value(spec, 'f_res', 20.0_wp)
   end function capped

   !> Column 1 as one body.
   type(column_record) function column_1(kinematics) result(spec)
      character(len=*), intent(in) :: kinematics

      spec%height = height_1
      spec%mass = mass_1
      spec%kinematics = kinematics
      allocate (spec%shear(1), spec%flexure(1))
      spec%shear(1) = bilinear_1()
      spec%flexure(1) = takeda_1('kc')
   end function column_1

   !> A column 2 m high of n different bodies with different elastic springs.
   type(column_record) function chain(n, kinematics) result(spec)
      integer, intent(in) :: n
      character(len=*), intent(in) :: kinematics
      integer :: i

      spec%n = n
      spec%height = 2.0_wp
      spec%kinematics = kinematics
      allocate (spec%lengths(n), spec%masses(n), spec%shear(n), spec%flexure(n))
      do i = 1, n
         spec%lengths(i) = 1.0_wp + 0.3_wp*sin(1.0_wp*i)
         spec%masses(i) = 80.0_wp + 30.0_wp*cos(2.0_wp*i)
         spec%shear(i) = elastic(4.0e8_wp + 1.0e8_wp*sin(3.0_wp*i))
         spec%flexure(i) = elastic(2.0e8_wp + 5.0e7_wp*cos(1.0_wp*i))
      end do
      spec%lengths = spec%lengths*(spec%height/sum(spec%lengths))
   end function chain

   !> A random column of n bodies with bilinear springs, axial load and weight; it does not buckle.
   type(column_record) function rich_column(n, kinematics, opens, random) result(spec)
      integer, intent(in) :: n
      character(len=*), intent(in) :: kinematics
      !> Whether the joints have axial springs
      logical, intent(in) :: opens
      type(random_type), intent(inout) :: random
      real(wp) :: number(6)
      integer :: i

      spec%n = n
      spec%kinematics = kinematics
      spec%axial_load = random%uniform(-1.0e6_wp, 2.0e6_wp)
      spec%self_weight = .true.
      allocate (spec%lengths(n), spec%masses(n), spec%shear(n), spec%flexure(n), spec%rotary_inertia(n))
      if (opens) allocate (spec%axial_spring(n))
      do i = 1, n
         spec%lengths(i) = random%uniform(0.2_wp, 1.0_wp)
         spec%masses(i) = random%uniform(50.0_wp, 500.0_wp)
         spec%rotary_inertia(i) = spec%masses(i)*random%uniform(0.01_wp, 0.2_wp)
         number = random%uniform_array(1.0_wp, 9.0_wp, 6)
         spec%shear(i) = bilinear(1.0e8_wp*number(1), 2.0e-3_wp, 1.0e7_wp*number(2))
         spec%flexure(i) = bilinear(1.0e8_wp*number(3), 2.0e-3_wp, 1.0e7_wp*number(4))
         if (opens) spec%axial_spring(i) = bilinear(1.0e9_wp*number(5), 2.0e-3_wp, 1.0e7_wp*number(6))
      end do
      spec%height = sum(spec%lengths)
   end function rich_column

   !> The column of a specification that must be valid.
   function made(spec) result(column)
      type(column_record), intent(in) :: spec
      class(column_type), allocatable :: column
      type(error_type), allocatable :: error
      type(column_record) :: asked

      asked = spec
      call make_column(asked, column, error)
      if (allocated(error)) error stop 'samples: a column that should be valid is refused'
   end function made

end module samples
