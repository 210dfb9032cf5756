!> One side of a backbone with cracking, yield, cap, softening, residual and rupture, as the user gives it.
!>
!>     force
!>       f_cap              cap
!>       f_y         yield/  \
!>       f_c  crack /         \  slope -f_cap/d_pc
!>       f_res    /            \____________
!>               /                          \  slope -f_y/d_y
!>              0   d_c  d_y  d_cap          d_u       deformation
!>
!> All numbers are positive on both sides.
module rbs_spec_backbone
   use rbs_base_kinds, only: wp
   use rbs_base_constants, only: unset
   use rbs_base_error, only: message_list
   use rbs_base_text, only: to_text
   use rbs_base_check, only: is_given, check_positive, check_not_negative
   implicit none
   private

   public :: backbone_spec

   !> Slopes this close to each other are the same.
   real(wp), parameter :: round_off = 1.0e-9_wp

   type :: backbone_spec
      !> Cracking point [m], [N]; zero: uncracked from the start, elastic up to yield
      real(wp) :: d_c = unset, f_c = unset
      !> Yield point [m], [N]
      real(wp) :: d_y = unset, f_y = unset
      !> Capping point: the largest force [m], [N]
      real(wp) :: d_cap = unset, f_cap = unset
      !> From the cap along the softening line to where it would have no force left [m]
      real(wp) :: d_pc = unset
      !> Force that softening does not fall below [N]
      real(wp) :: f_res = unset
      !> Deformation beyond which the force falls to zero [m]; `unset`: none
      real(wp) :: d_u = unset
   contains
      procedure :: validate
      procedure :: stiffness
   end type backbone_spec

contains

   !> Add a message for every number that does not fit.
   subroutine validate(self, name, suffix, messages)
      class(backbone_spec), intent(in) :: self
      !> Which spring, and what stands behind the names of the numbers
      character(len=*), intent(in) :: name, suffix
      type(message_list), intent(inout) :: messages
      logical :: ok(6), ok_u

      call check_positive(self%d_y, name//': d_y'//suffix, '', messages, ok(1))
      call check_positive(self%f_y, name//': f_y'//suffix, '', messages, ok(2))
      call check_positive(self%d_cap, name//': d_cap'//suffix, '', messages, ok(3))
      call check_positive(self%f_cap, name//': f_cap'//suffix, '', messages, ok(4))
      call check_positive(self%d_pc, name//': d_pc'//suffix, '', messages, ok(5))
      call check_not_negative(self%f_res, name//': f_res'//suffix, '', messages, ok(6))
      call check_cracking(self, name, suffix, all(ok(:2)), messages)
      ok_u = .false.
      if (is_given(self%d_u)) call check_positive(self%d_u, name//': d_u'//suffix, '', messages, ok_u)
      if (.not. all(ok)) return
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
      if (ok_u .and. self%d_u < self%d_cap) then
         call wrong('d_u', self%d_u, 'must not be below', 'd_cap', self%d_cap, 'rupture comes after the cap')
      end if

   contains

      !> 'name: d_cap = 1 must not be below d_y = 2 (the reason)'
      subroutine wrong(number, value, relation, other, limit, reason)
         character(len=*), intent(in) :: number, relation, other, reason
         real(wp), intent(in) :: value, limit

         call messages%add(name//': '//number//suffix//' = '//to_text(value)//' '//relation//' '//other// &
                           suffix//' = '//to_text(limit)//' ('//reason//')')
      end subroutine wrong
   end subroutine validate

   !> Both numbers of the cracking point or none; before yield, and stiffer than the way to yield.
   subroutine check_cracking(self, name, suffix, has_yield, messages)
      class(backbone_spec), intent(in) :: self
      character(len=*), intent(in) :: name, suffix
      !> Whether the yield point is sound
      logical, intent(in) :: has_yield
      type(message_list), intent(inout) :: messages
      logical :: ok(2)

      call check_not_negative(self%d_c, name//': d_c'//suffix, '', messages, ok(1))
      call check_not_negative(self%f_c, name//': f_c'//suffix, '', messages, ok(2))
      if (.not. all(ok)) return
      if (self%d_c > 0.0_wp .neqv. self%f_c > 0.0_wp) then
         call messages%add(name//': d_c'//suffix//' = '//to_text(self%d_c)//' and f_c'//suffix//' = '// &
                           to_text(self%f_c)//' are a point together; give both above zero, or none')
      else if (has_yield .and. self%d_c > 0.0_wp) then
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
      class(backbone_spec), intent(in) :: self

      stiffness = self%f_y/self%d_y
      if (self%d_c > 0.0_wp) stiffness = self%f_c/self%d_c
   end function stiffness

end module rbs_spec_backbone
