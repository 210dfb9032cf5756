!> Springs and random numbers that several suites use.
module samples
   use, intrinsic :: iso_fortran_env, only: int64
   use rbs_base_check, only: is_given
   use rbs_base_constants, only: unset
   use rbs_base_keys, only: key_type, find_key
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_registry, only: keys_of
   use rbs_hysteresis_rule, only: spring_rules
   use rbs_hysteresis_spring_record, only: spring_record, add_rules
   use rbs_hysteresis_springs, only: spring_array
   implicit none
   private

   public :: make_springs
   public :: elastic, bilinear, compression, takeda, bilinear_1, takeda_1
   public :: concrete_1, steel_1, capped, random_type, set_value, value_of

   !> Soesianawati & Park No 1, table 3 of the paper: flexure [N m, rad] ...
   real(wp), parameter, public :: k_c = 2.5428e8_wp, d_c = 3.1891e-4_wp
   real(wp), parameter, public :: k_y = 6.2937e7_wp, d_y = 2.7183e-3_wp, k_u = 7.5772e6_wp
   real(wp), parameter, public :: b0 = 0.4_wp, b1 = 0.22_wp
   real(wp), parameter, public :: f_c = k_c*d_c, f_y = f_c + k_y*(d_y - d_c)
   real(wp), parameter, public :: k_0 = (f_c + f_y)/(d_c + d_y)
   !> ... and shear [N, m]
   real(wp), parameter, public :: s_k = 7.0387e8_wp, s_d = 1.2960e-4_wp, s_post = 8.3185e6_wp

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

end module samples
