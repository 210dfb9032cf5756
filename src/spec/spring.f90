!> What the user asked of one joint spring: the rule and its numbers.
!>
!> Deformation is slip [m] or rotation [rad], force is shear [N] or moment [N m]; the units below are
!> those of a shear spring.
module rbs_spec_spring
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use rbs_base_kinds, only: wp
   use rbs_base_constants, only: unset
   use rbs_base_error, only: message_list
   use rbs_base_text, only: to_text
   use rbs_spec_check, only: is_given, check_positive, check_not_negative, check_name
   implicit none
   private

   public :: spring_spec, rule_names, inner_names, initial_stiffness

   character(len=11), parameter :: rule_names(4) = [ &
      'elastic    ', 'bilinear   ', 'takeda     ', 'compression']
   character(len=3), parameter :: inner_names(3) = ['kc ', 'kr ', 'one']

   !> One spring. Numbers that its rule does not use stay `unset`.
   type :: spring_spec
      !> One of `rule_names`
      character(len=16) :: rule = ''
      !> elastic, bilinear, compression: initial stiffness [N/m]
      real(wp) :: k = unset
      !> bilinear, takeda: yield deformation [m]
      real(wp) :: d_y = unset
      !> bilinear: stiffness after yield [N/m]
      real(wp) :: k_post = unset
      !> takeda: uncracked stiffness [N/m]
      real(wp) :: k_c = unset
      !> takeda: cracking deformation [m]
      real(wp) :: d_c = unset
      !> takeda: cracked stiffness [N/m]
      real(wp) :: k_y = unset
      !> takeda: stiffness after yield [N/m]
      real(wp) :: k_u = unset
      !> takeda: exponent of the outer unloading stiffness
      real(wp) :: b0 = 0.4_wp
      !> takeda: factor of the inner unloading stiffness
      real(wp) :: b1 = 1.0_wp
      !> takeda: what `b1` multiplies, one of `inner_names`
      character(len=16) :: inner = 'kc'
   contains
      procedure :: validate
   end type spring_spec

contains

   !> Add a message for every number that the rule does not allow.
   subroutine validate(self, name, messages)
      class(spring_spec), intent(in) :: self
      !> Which spring: 'shear spring of joint 2'
      character(len=*), intent(in) :: name
      type(message_list), intent(inout) :: messages
      integer :: place

      call check_name(self%rule, rule_names, name//': rule', messages, place)
      select case (self%rule)
      case ('elastic', 'compression')
         call check_positive(self%k, name//': k', '', messages)
      case ('bilinear')
         call validate_bilinear(self, name, messages)
      case ('takeda')
         call validate_takeda(self, name, messages)
      case default
         return                                     ! the rule has been reported
      end select
      call refuse_unused(self, name, messages)
   end subroutine validate

   !> A number that the rule does not use is a misunderstanding.
   subroutine refuse_unused(self, name, messages)
      class(spring_spec), intent(in) :: self
      character(len=*), intent(in) :: name
      type(message_list), intent(inout) :: messages
      character(len=6), parameter :: names(7) = ['k     ', 'd_y   ', 'k_post', 'k_c   ', 'd_c   ', &
                                                 'k_y   ', 'k_u   ']
      logical, parameter :: no = .false., yes = .true.
      logical :: used(7)
      real(wp) :: values(7)
      integer :: i

      values = [self%k, self%d_y, self%k_post, self%k_c, self%d_c, self%k_y, self%k_u]
      select case (self%rule)
      case ('elastic', 'compression')
         used = [yes, no, no, no, no, no, no]
      case ('bilinear')
         used = [yes, yes, yes, no, no, no, no]
      case default
         used = [no, yes, no, yes, yes, yes, yes]
      end select
      do i = 1, size(names)
         if (used(i) .or. .not. is_given(values(i))) cycle
         call messages%add(name//': '//trim(names(i))//' is not used by the rule '//trim(self%rule)// &
                           '; remove it or choose another rule')
      end do
   end subroutine refuse_unused

   subroutine validate_bilinear(self, name, messages)
      type(spring_spec), intent(in) :: self
      character(len=*), intent(in) :: name
      type(message_list), intent(inout) :: messages
      logical :: ok(3)

      call check_positive(self%k, name//': k', '', messages, ok(1))
      call check_positive(self%d_y, name//': d_y', '', messages, ok(2))
      call check_not_negative(self%k_post, name//': k_post', '', messages, ok(3))
      if (.not. all(ok)) return
      if (self%k_post >= self%k) then
         call messages%add(name//': k_post = '//to_text(self%k_post)//' must be below k = '// &
                           to_text(self%k)//'; use an elastic spring for one that does not yield')
      end if
      call check_force(self%k, self%d_y, name, 'k d_y', messages)
   end subroutine validate_bilinear

   subroutine validate_takeda(self, name, messages)
      type(spring_spec), intent(in) :: self
      character(len=*), intent(in) :: name
      type(message_list), intent(inout) :: messages
      logical :: ok(5), ok_b
      integer :: place

      call check_positive(self%k_c, name//': k_c', '', messages, ok(1))
      call check_positive(self%d_c, name//': d_c', '', messages, ok(2))
      call check_positive(self%k_y, name//': k_y', '', messages, ok(3))
      call check_positive(self%d_y, name//': d_y', '', messages, ok(4))
      call check_not_negative(self%k_u, name//': k_u', '', messages, ok(5))
      call check_not_negative(self%b0, name//': b0', '', messages, ok_b)
      call check_positive(self%b1, name//': b1', '', messages, ok_b)
      call check_name(self%inner, inner_names, name//': inner', messages, place)
      if (.not. all(ok)) return
      if (self%d_y <= self%d_c) then
         call messages%add(name//': d_y = '//to_text(self%d_y)//' must be above d_c = '// &
                           to_text(self%d_c)//' (yield comes after cracking)')
      end if
      if (self%k_y >= self%k_c) then
         call messages%add(name//': k_y = '//to_text(self%k_y)//' must be below k_c = '// &
                           to_text(self%k_c)//' (cracking softens)')
      end if
      if (self%k_u > self%k_y) then
         call messages%add(name//': k_u = '//to_text(self%k_u)//' must not be above k_y = '// &
                           to_text(self%k_y)//' (yielding softens)')
      end if
      call check_force(self%k_c, self%d_y, name, 'k_c d_y', messages)
   end subroutine validate_takeda

   !> Stiffness times deformation must be a normal number, or the lines have no meaning.
   subroutine check_force(k, d, name, product_name, messages)
      real(wp), intent(in) :: k, d
      character(len=*), intent(in) :: name, product_name
      type(message_list), intent(inout) :: messages
      real(wp) :: power

      power = log10(k) + log10(d)
      if (power > 0.9_wp*range(1.0_wp) .or. power < -0.9_wp*range(1.0_wp) .or. &
          abs(log10(k)) > 0.5_wp*range(1.0_wp) .or. abs(log10(d)) > 0.5_wp*range(1.0_wp)) then
         call messages%add(name//': '//product_name//' = '//to_text(k)//' * '//to_text(d)// &
                           ' is outside the range of the arithmetic; check the units')
      end if
   end subroutine check_force

   !> Stiffness of the unloaded virgin spring [N/m].
   elemental real(wp) function initial_stiffness(self)
      type(spring_spec), intent(in) :: self

      if (self%rule == 'takeda') then
         initial_stiffness = self%k_c
      else
         initial_stiffness = self%k
      end if
   end function initial_stiffness

end module rbs_spec_spring
