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
   use rbs_spec_backbone, only: backbone_spec
   use rbs_base_check, only: is_given, check_positive, check_not_negative, check_finite, check_name
   use rbs_spec_spring_table, only: rule_names, layer_rules, inner_names, number_names, number_count, &
                                    name_length, side_suffix, takes, is_capped
   implicit none
   private

   public :: spring_spec, initial_stiffness

   !> One spring. Numbers that its rule does not use stay `unset`.
   type :: spring_spec
      !> One of `rule_names`
      character(len=16) :: rule = ''
      !> elastic, bilinear, compression: initial stiffness [N/m]
      real(wp) :: k = unset
      !> bilinear, takeda, capped rules: yield deformation [m]
      real(wp) :: d_y = unset
      !> bilinear: stiffness after yield [N/m]
      real(wp) :: k_post = unset
      !> takeda: uncracked stiffness [N/m]
      real(wp) :: k_c = unset
      !> takeda, capped rules: cracking deformation [m]
      real(wp) :: d_c = unset
      !> takeda: cracked stiffness [N/m]
      real(wp) :: k_y = unset
      !> takeda: stiffness after yield [N/m]
      real(wp) :: k_u = unset
      !> takeda, capped rules: exponent of the outer unloading stiffness
      real(wp) :: b0 = unset
      !> takeda: factor of the inner unloading stiffness
      real(wp) :: b1 = unset
      !> Capped rules: the rest of the backbone, see `rbs_spec_backbone` [m], [N]
      real(wp) :: f_c = unset, f_y = unset, d_cap = unset, f_cap = unset, d_pc = unset, f_res = unset
      real(wp) :: d_u = unset
      !> Capped rules: the backbone of the negative side, where it differs
      real(wp) :: d_c_neg = unset, f_c_neg = unset, d_y_neg = unset, f_y_neg = unset, d_cap_neg = unset
      real(wp) :: f_cap_neg = unset, d_pc_neg = unset, f_res_neg = unset, d_u_neg = unset
      !> Capped rules: energy that a kind of deterioration lasts for, over f_y d_y (0: it does not act), of
      !> the strength, the softening line, the unloading stiffness and the target of reloading; exponent
      real(wp) :: lambda_s = unset, lambda_c = unset, lambda_k = unset, lambda_a = unset, c = unset
      !> pinching: shares of force and deformation at the break of the reloading line
      real(wp) :: kappa_f = unset, kappa_d = unset
      !> concrete: largest force [N], closing there [m], slope of the fall [N/m]; factor of the plastic
      !> closing; shares of force at full closing, of the opening at touch; strength lost by a cycle
      real(wp) :: f_peak = unset, d_peak = unset, k_fall = unset
      real(wp) :: plastic = unset, contact = unset, misfit = unset, wear = unset
      !> steel: roundness of the virgin branch and how it falls; growth of the strength; work over f_y d_y
      !> at half the strength
      real(wp) :: r0 = unset, r1 = unset, r2 = unset, growth = unset, endurance = unset
      !> layered: axial load that the layers share, compression positive [N]
      real(wp) :: axial_load = unset
      !> layered: the layers, a column for each: distance from the middle [m], place of the rule in
      !> `rule_names`, numbers of the rule (2 + number_count, layers)
      real(wp), allocatable :: layers(:, :)
      !> takeda: what `b1` multiplies, one of `inner_names`
      character(len=16) :: inner = 'kc'
   contains
      procedure :: validate
      procedure :: numbers
      procedure :: set_numbers
      procedure :: fill_defaults
      procedure :: side
      procedure :: layer
   end type spring_spec

contains

   !> All numbers in the order of `number_names`.
   pure function numbers(self) result(values)
      class(spring_spec), intent(in) :: self
      real(wp) :: values(number_count)

      values = [self%k, self%d_y, self%k_post, self%k_c, self%d_c, self%k_y, self%k_u, self%b0, self%b1, &
                self%f_c, self%f_y, self%d_cap, self%f_cap, self%d_pc, self%f_res, self%d_u, &
                self%d_c_neg, self%f_c_neg, self%d_y_neg, self%f_y_neg, self%d_cap_neg, self%f_cap_neg, &
                self%d_pc_neg, self%f_res_neg, self%d_u_neg, &
                self%lambda_s, self%lambda_c, self%lambda_k, self%lambda_a, self%c, &
                self%kappa_f, self%kappa_d, &
                self%f_peak, self%d_peak, self%k_fall, self%plastic, self%contact, self%misfit, self%wear, &
                self%r0, self%r1, self%r2, self%growth, self%endurance, self%axial_load]
   end function numbers

   !> The inverse.
   pure subroutine set_numbers(self, values)
      class(spring_spec), intent(inout) :: self
      real(wp), intent(in) :: values(number_count)

      self%k = values(1)
      self%d_y = values(2)
      self%k_post = values(3)
      self%k_c = values(4)
      self%d_c = values(5)
      self%k_y = values(6)
      self%k_u = values(7)
      self%b0 = values(8)
      self%b1 = values(9)
      self%f_c = values(10)
      self%f_y = values(11)
      self%d_cap = values(12)
      self%f_cap = values(13)
      self%d_pc = values(14)
      self%f_res = values(15)
      self%d_u = values(16)
      self%d_c_neg = values(17)
      self%f_c_neg = values(18)
      self%d_y_neg = values(19)
      self%f_y_neg = values(20)
      self%d_cap_neg = values(21)
      self%f_cap_neg = values(22)
      self%d_pc_neg = values(23)
      self%f_res_neg = values(24)
      self%d_u_neg = values(25)
      self%lambda_s = values(26)
      self%lambda_c = values(27)
      self%lambda_k = values(28)
      self%lambda_a = values(29)
      self%c = values(30)
      self%kappa_f = values(31)
      self%kappa_d = values(32)
      self%f_peak = values(33)
      self%d_peak = values(34)
      self%k_fall = values(35)
      self%plastic = values(36)
      self%contact = values(37)
      self%misfit = values(38)
      self%wear = values(39)
      self%r0 = values(40)
      self%r1 = values(41)
      self%r2 = values(42)
      self%growth = values(43)
      self%endurance = values(44)
      self%axial_load = values(45)
   end subroutine set_numbers

   !> Numbers that may be left out get the value that the rule has for them.
   pure subroutine fill_defaults(self)
      class(spring_spec), intent(inout) :: self

      if (self%rule == 'takeda') then
         call default(self%b0, 0.4_wp)
         call default(self%b1, 1.0_wp)
      else if (is_capped(self%rule)) then
         call default(self%d_c, 0.0_wp)
         call default(self%f_c, 0.0_wp)
         call default(self%f_res, 0.0_wp)
         call default(self%b0, 0.0_wp)
         call default(self%lambda_s, 0.0_wp)
         call default(self%lambda_c, 0.0_wp)
         call default(self%lambda_k, 0.0_wp)
         call default(self%lambda_a, 0.0_wp)
         call default(self%c, 1.0_wp)
      else if (self%rule == 'concrete') then
         call default(self%f_res, 0.0_wp)
         call default(self%plastic, 1.0_wp)
         call default(self%contact, 0.0_wp)
         call default(self%misfit, 0.0_wp)
         call default(self%wear, 0.0_wp)
      else if (self%rule == 'steel') then
         call default(self%r0, 20.0_wp)
         call default(self%r1, 0.925_wp)
         call default(self%r2, 0.15_wp)
         call default(self%growth, 0.0_wp)
         call default(self%endurance, 0.0_wp)
      end if
   end subroutine fill_defaults

   pure subroutine default(number, value)
      real(wp), intent(inout) :: number
      real(wp), intent(in) :: value

      if (.not. is_given(number)) number = value
   end subroutine default

   !> The backbone of a side; what is not given for the negative one is as on the positive.
   elemental type(backbone_spec) function side(self, s)
      class(spring_spec), intent(in) :: self
      !> +1 or -1
      integer, intent(in) :: s

      side = backbone_spec(self%d_c, self%f_c, self%d_y, self%f_y, self%d_cap, self%f_cap, self%d_pc, &
                           self%f_res, self%d_u)
      if (s > 0) return
      if (is_given(self%d_c_neg)) side%d_c = self%d_c_neg
      if (is_given(self%f_c_neg)) side%f_c = self%f_c_neg
      if (is_given(self%d_y_neg)) side%d_y = self%d_y_neg
      if (is_given(self%f_y_neg)) side%f_y = self%f_y_neg
      if (is_given(self%d_cap_neg)) side%d_cap = self%d_cap_neg
      if (is_given(self%f_cap_neg)) side%f_cap = self%f_cap_neg
      if (is_given(self%d_pc_neg)) side%d_pc = self%d_pc_neg
      if (is_given(self%f_res_neg)) side%f_res = self%f_res_neg
      if (is_given(self%d_u_neg)) side%d_u = self%d_u_neg
   end function side

   !> Add a message for every number that the rule does not allow.
   recursive subroutine validate(self, name, messages)
      class(spring_spec), intent(in) :: self
      !> Which spring: 'shear spring of joint 2'
      character(len=*), intent(in) :: name
      type(message_list), intent(inout) :: messages
      type(spring_spec) :: whole
      integer :: place

      call check_name(self%rule, rule_names, name//': rule', messages, place)
      if (place == 0) return
      whole = self
      call whole%fill_defaults()
      select case (self%rule)
      case ('elastic', 'compression')
         call check_positive(self%k, name//': k', '', messages)
      case ('bilinear')
         call validate_bilinear(self, name, messages)
      case ('takeda')
         call validate_takeda(whole, name, messages)
      case ('peak_oriented', 'pinching')
         call validate_capped(whole, name, messages)
      case ('concrete')
         call validate_concrete(whole, name, messages)
      case ('steel')
         call validate_steel(whole, name, messages)
      case ('layered')
         call validate_layered(self, name, messages)
      case default
         call messages%add(name//': the rule '//trim(self%rule)//' has no checks')
      end select
      if (allocated(self%layers) .and. self%rule /= 'layered') then
         call messages%add(name//': layers are not used by the rule '//trim(self%rule)// &
                           '; remove them or choose the rule layered')
      end if
      call refuse_unused(self, name, messages)
   end subroutine validate

   !> A number that the rule does not use is a misunderstanding.
   subroutine refuse_unused(self, name, messages)
      class(spring_spec), intent(in) :: self
      character(len=*), intent(in) :: name
      type(message_list), intent(inout) :: messages
      real(wp) :: values(number_count)
      integer :: i

      values = self%numbers()
      do i = 1, number_count
         if (takes(self%rule, number_names(i)) .or. .not. is_given(values(i))) cycle
         call messages%add(name//': '//trim(number_names(i))//' is not used by the rule '//trim(self%rule)// &
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

   subroutine validate_capped(self, name, messages)
      type(spring_spec), intent(in) :: self
      character(len=*), intent(in) :: name
      type(message_list), intent(inout) :: messages
      type(backbone_spec) :: backbone
      logical :: ok
      integer :: known

      known = messages%count
      backbone = self%side(1)
      call backbone%validate(name, '', messages)
      if (messages%count == known) then
         ! Else its faults would be told twice.
         backbone = self%side(-1)
         call backbone%validate(name, side_suffix, messages)
      end if
      call check_not_negative(self%b0, name//': b0', '', messages)
      call check_not_negative(self%lambda_s, name//': lambda_s', '', messages)
      call check_not_negative(self%lambda_c, name//': lambda_c', '', messages)
      call check_not_negative(self%lambda_k, name//': lambda_k', '', messages)
      call check_not_negative(self%lambda_a, name//': lambda_a', '', messages)
      call check_finite(self%c, name//': c', '', messages, ok)
      if (ok) then
         if (self%c < 1.0_wp) then
            call messages%add(name//': c = '//to_text(self%c)//' must not be below 1: small excursions '// &
                              'would count for more than their energy')
         end if
      end if
      if (self%rule /= 'pinching') return
      call check_share(self%kappa_f, name//': kappa_f', messages)
      call check_share(self%kappa_d, name//': kappa_d', messages)
   end subroutine validate_capped

   subroutine validate_concrete(self, name, messages)
      type(spring_spec), intent(in) :: self
      character(len=*), intent(in) :: name
      type(message_list), intent(inout) :: messages
      logical :: ok(5)

      call check_positive(self%k, name//': k', '', messages, ok(1))
      call check_positive(self%f_peak, name//': f_peak', '', messages, ok(2))
      call check_positive(self%d_peak, name//': d_peak', '', messages, ok(3))
      call check_positive(self%k_fall, name//': k_fall', '', messages, ok(4))
      call check_not_negative(self%f_res, name//': f_res', '', messages, ok(5))
      if (all(ok)) then
         if (self%f_peak >= self%k*self%d_peak) then
            call messages%add(name//': f_peak = '//to_text(self%f_peak)//' must be below k d_peak = '// &
                              to_text(self%k*self%d_peak)//' (the curve bends towards its peak)')
         end if
         if (self%f_res > self%f_peak) then
            call messages%add(name//': f_res = '//to_text(self%f_res)//' must not be above f_peak = '// &
                              to_text(self%f_peak)//' (it is what is left of it)')
         end if
         call check_force(self%k, self%d_peak, name, 'k d_peak', messages)
      end if
      call check_not_negative(self%plastic, name//': plastic', '', messages)
      call check_part(self%contact, name//': contact', messages)
      call check_part(self%misfit, name//': misfit', messages)
      call check_part(self%wear, name//': wear', messages)
   end subroutine validate_concrete

   subroutine validate_steel(self, name, messages)
      type(spring_spec), intent(in) :: self
      character(len=*), intent(in) :: name
      type(message_list), intent(inout) :: messages
      logical :: ok(3)

      call check_positive(self%k, name//': k', '', messages, ok(1))
      call check_positive(self%f_y, name//': f_y', '', messages, ok(2))
      call check_not_negative(self%k_post, name//': k_post', '', messages, ok(3))
      if (all(ok)) then
         if (self%k_post >= self%k) then
            call messages%add(name//': k_post = '//to_text(self%k_post)//' must be below k = '// &
                              to_text(self%k)//'; use an elastic spring for one that does not yield')
         end if
         call check_force(self%k, self%f_y/self%k, name, 'k d_y', messages)
      end if
      call check_positive(self%r0, name//': r0', '', messages)
      call check_part(self%r1, name//': r1', messages)
      call check_positive(self%r2, name//': r2', '', messages)
      call check_not_negative(self%growth, name//': growth', '', messages)
      call check_not_negative(self%endurance, name//': endurance', '', messages)
   end subroutine validate_steel

   recursive subroutine validate_layered(self, name, messages)
      type(spring_spec), intent(in) :: self
      character(len=*), intent(in) :: name
      type(message_list), intent(inout) :: messages
      type(spring_spec) :: layer
      logical :: ok
      integer :: i

      call check_finite(self%axial_load, name//': axial_load', 'N', messages)
      if (.not. allocated(self%layers)) then
         call messages%add(name//': the layers are missing; give at least two')
         return
      end if
      if (size(self%layers, 2) < 2) then
         call messages%add(name//': one layer has no stiffness against rotation; give at least two')
      end if
      do i = 1, size(self%layers, 2)
         call check_finite(self%layers(1, i), name//': y of layer '//to_text(i), 'm', messages, ok)
         layer = self%layer(i)
         if (.not. any(layer_rules == layer%rule)) then
            call messages%add(name//': layer '//to_text(i)//" has the rule '"//trim(layer%rule)// &
                              "'; it is one of concrete, steel, elastic, bilinear, compression")
         else
            call layer%validate(name//': layer '//to_text(i), messages)
         end if
         ! One table for all layers: a slip is likely in all of them.
         if (messages%count > 20) return
      end do
   end subroutine validate_layered

   !> The spring of a layer.
   pure function layer(self, i)
      class(spring_spec), intent(in) :: self
      !> Number of the layer
      integer, intent(in) :: i
      type(spring_spec) :: layer
      integer :: place

      place = nint(self%layers(2, i))
      if (place >= 1 .and. place <= size(rule_names)) layer%rule = rule_names(place)
      call layer%set_numbers(self%layers(3:, i))
   end function layer

   !> From zero to below one.
   subroutine check_part(x, name, messages)
      real(wp), intent(in) :: x
      character(len=*), intent(in) :: name
      type(message_list), intent(inout) :: messages
      logical :: ok

      call check_not_negative(x, name, '', messages, ok)
      if (.not. ok) return
      if (x >= 1.0_wp) call messages%add(name//' = '//to_text(x)//' must be below 1 (it is a share)')
   end subroutine check_part

   !> Above zero and up to one.
   subroutine check_share(x, name, messages)
      real(wp), intent(in) :: x
      character(len=*), intent(in) :: name
      type(message_list), intent(inout) :: messages
      logical :: ok

      call check_positive(x, name, '', messages, ok)
      if (.not. ok) return
      if (x > 1.0_wp) call messages%add(name//' = '//to_text(x)//' must not be above 1 (it is a share)')
   end subroutine check_share

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

   !> Stiffness of the unloaded virgin spring, of the stiffer side if they differ [N/m].
   elemental real(wp) function initial_stiffness(self)
      type(spring_spec), intent(in) :: self
      type(spring_spec) :: whole
      type(backbone_spec) :: backbone(2)

      if (self%rule == 'takeda') then
         initial_stiffness = self%k_c
      else if (is_capped(self%rule)) then
         whole = self
         call whole%fill_defaults()
         backbone = whole%side([1, -1])
         initial_stiffness = maxval(backbone%stiffness())
      else if (self%rule == 'layered') then
         initial_stiffness = layered_stiffness(self)
      else
         initial_stiffness = self%k
      end if
   end function initial_stiffness

   !> Against rotation, with all layers uncracked [N m/rad].
   pure real(wp) function layered_stiffness(self) result(stiffness)
      type(spring_spec), intent(in) :: self
      type(spring_spec) :: layer
      real(wp) :: y(size(self%layers, 2)), k(size(self%layers, 2))
      integer :: i

      do i = 1, size(k)
         layer = self%layer(i)
         k(i) = layer%k
         y(i) = self%layers(1, i)
      end do
      stiffness = sum(k*y**2) - sum(k*y)**2/sum(k)
   end function layered_stiffness

end module rbs_spec_spring
