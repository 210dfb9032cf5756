!> Input of one side of a backbone with cracking, yield, cap, softening, residual and rupture.
!>
!>     force
!>       f_cap              cap
!>       f_y         yield/  \
!>       f_c  crack /         \  slope -f_cap/d_pc
!>       f_res    /            \____________
!>               /                          \  slope -f_y/d_y
!>              0   d_c  d_y  d_cap          d_u       deformation
!>
!> All values are positive on both sides.
module rbs_hysteresis_rules_backbone_parameters
   use rbs_base_kinds, only: wp
   use rbs_base_constants, only: unset
   use rbs_base_error, only: message_list
   use rbs_base_text, only: to_text
   use rbs_base_check, only: is_given
   use rbs_base_keys, only: key_type, above_zero, not_negative, force, deformation
   implicit none
   private

   public :: backbone_parameters, backbone_keys, other_side_keys, from_values

   character(len=*), parameter :: as_positive = 'the same on the negative side; without it as on the positive'

   !> Slopes this close to each other are the same.
   real(wp), parameter :: round_off = 1.0e-9_wp

   !> The keys of one side; the optional ones have no default.
   type(key_type), parameter :: backbone_keys(9) = [ &
      key_type('d_y', unit=deformation, bound=above_zero, meaning='yield deformation'), &
      key_type('f_y', unit=force, bound=above_zero, meaning='yield force'), &
      key_type('d_cap', unit=deformation, bound=above_zero, meaning='deformation at the cap, from d_y on'), &
      key_type('f_cap', unit=force, bound=above_zero, meaning='largest force, from f_y on'), &
      key_type('d_pc', unit=deformation, bound=above_zero, &
               meaning='from the cap along the softening line to where it would have no force left'), &
      key_type('f_res', unit=force, bound=not_negative, default=0.0_wp, &
               meaning='residual force, below f_y, which softening does not fall below'), &
      key_type('d_u', unit=deformation, bound=above_zero, optional=.true., &
               meaning='deformation beyond which the force falls to zero; without it there is none'), &
      key_type('d_c', unit=deformation, bound=not_negative, default=0.0_wp, &
               meaning='cracking deformation; 0: elastic up to yield'), &
      key_type('f_c', unit=force, bound=not_negative, default=0.0_wp, meaning='cracking force')]

   !> The same for the negative side: positive values, by default those of the positive side.
   type(key_type), parameter :: other_side_keys(9) = [ &
      key_type('d_y_neg', unit=deformation, bound=above_zero, optional=.true., meaning=as_positive), &
      key_type('f_y_neg', unit=force, bound=above_zero, optional=.true., meaning=as_positive), &
      key_type('d_cap_neg', unit=deformation, bound=above_zero, optional=.true., meaning=as_positive), &
      key_type('f_cap_neg', unit=force, bound=above_zero, optional=.true., meaning=as_positive), &
      key_type('d_pc_neg', unit=deformation, bound=above_zero, optional=.true., meaning=as_positive), &
      key_type('f_res_neg', unit=force, bound=not_negative, optional=.true., meaning=as_positive), &
      key_type('d_u_neg', unit=deformation, bound=above_zero, optional=.true., meaning=as_positive), &
      key_type('d_c_neg', unit=deformation, bound=not_negative, optional=.true., meaning=as_positive), &
      key_type('f_c_neg', unit=force, bound=not_negative, optional=.true., meaning=as_positive)]

   type :: backbone_parameters
      !> Cracking point [m], [N]; zero: uncracked from the start, elastic up to yield
      real(wp) :: d_c = unset, f_c = unset
      !> Yield point [m], [N]
      real(wp) :: d_y = unset, f_y = unset
      !> Capping point: the largest force [m], [N]
      real(wp) :: d_cap = unset, f_cap = unset
      !> Deformation from the cap to the point where the softening line reaches zero force [m]
      real(wp) :: d_pc = unset
      !> Residual force, at which softening ends [N]
      real(wp) :: f_res = unset
      !> Deformation beyond which the force drops to zero [m]; `unset`: none
      real(wp) :: d_u = unset
   contains
      procedure :: check
      procedure :: stiffness
   end type backbone_parameters

contains

   !> The parameters of a side from their values in the order of `backbone_keys`.
   pure type(backbone_parameters) function from_values(value) result(side)
      real(wp), intent(in) :: value(:)

      side = backbone_parameters(d_y=value(1), f_y=value(2), d_cap=value(3), f_cap=value(4), d_pc=value(5), &
                                 f_res=value(6), d_u=value(7), d_c=value(8), f_c=value(9))
   end function from_values

   !> Add a message for every relation that does not hold.
   subroutine check(self, name, suffix, messages)
      class(backbone_parameters), intent(in) :: self
      !> Name of the spring, and suffix of the names of the parameters
      character(len=*), intent(in) :: name, suffix
      type(message_list), intent(inout) :: messages

      call check_cracking(self, name, suffix, messages)
      if (self%d_cap < self%d_y) then
         call wrong('d_cap', self%d_cap, 'must not be below', 'd_y', self%d_y, 'the cap comes after yield')
      end if
      if (self%f_cap < self%f_y) then
         call wrong('f_cap', self%f_cap, 'must not be below', 'f_y', self%f_y, &
                    'put the yield point at the cap if the force falls from there')
      else if (self%d_cap > self%d_y) then
         if ((self%f_cap - self%f_y)*(self%d_y - self%d_c) > &
             (self%f_y - self%f_c)*(self%d_cap - self%d_y)*(1.0_wp + round_off)) then
            call wrong('f_cap', self%f_cap, 'is too far above', 'f_y', self%f_y, &
                       'the slope to the cap must not be above that to yield: yielding softens')
         end if
      else if (self%f_cap > self%f_y) then
         call wrong('d_cap', self%d_cap, 'must be above', 'd_y', self%d_y, &
                    'the force rises from yield to the cap')
      end if
      if (self%f_res >= self%f_y) then
         call wrong('f_res', self%f_res, 'must be below', 'f_y', self%f_y, &
                    'it is what softening leaves of the strength')
      end if
      if (is_given(self%d_u)) then
         if (self%d_u < self%d_cap) then
            call wrong('d_u', self%d_u, 'must not be below', 'd_cap', self%d_cap, &
                       'rupture comes after the cap')
         end if
      end if

   contains

      !> 'name: d_cap = 1 must not be below d_y = 2 (the reason)'
      subroutine wrong(number, value, relation, other, limit, reason)
         character(len=*), intent(in) :: number, relation, other, reason
         real(wp), intent(in) :: value, limit

         call messages%add(name//': '//number//suffix//' = '//to_text(value)//' '//relation//' '//other// &
                           suffix//' = '//to_text(limit)//' ('//reason//')')
      end subroutine wrong
   end subroutine check

   !> The cracking point needs both values or none; it must come before yield, on a stiffer line.
   subroutine check_cracking(self, name, suffix, messages)
      class(backbone_parameters), intent(in) :: self
      character(len=*), intent(in) :: name, suffix
      type(message_list), intent(inout) :: messages

      if (self%d_c > 0.0_wp .neqv. self%f_c > 0.0_wp) then
         call messages%add(name//': d_c'//suffix//' = '//to_text(self%d_c)//' and f_c'//suffix//' = '// &
                           to_text(self%f_c)//' are a point together; give both above zero, or none')
      else if (self%d_c > 0.0_wp) then
         if (self%d_c >= self%d_y .or. self%f_c >= self%f_y) then
            call messages%add(name//': the cracking point d_c'//suffix//' = '//to_text(self%d_c)//', f_c'// &
                              suffix//' = '//to_text(self%f_c)//' must come before the yield point d_y'// &
                              suffix//' = '//to_text(self%d_y)//', f_y'//suffix//' = '//to_text(self%f_y))
         else if (self%f_c/self%d_c <= self%f_y/self%d_y) then
            call messages%add(name//': f_c'//suffix//' / d_c'//suffix//' = '// &
                              to_text(self%f_c/self%d_c)//' must be above f_y'//suffix//' / d_y'//suffix// &
                              ' = '//to_text(self%f_y/self%d_y)//' (cracking softens)')
         end if
      end if
   end subroutine check_cracking

   !> Stiffness of the virgin spring on this side [N/m].
   elemental real(wp) function stiffness(self)
      class(backbone_parameters), intent(in) :: self

      stiffness = self%f_y/self%d_y
      if (self%d_c > 0.0_wp) stiffness = self%f_c/self%d_c
   end function stiffness

end module rbs_hysteresis_rules_backbone_parameters
