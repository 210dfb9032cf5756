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
   use rbs_base_key_visitor, only: key_visitor
   use rbs_base_keys, only: bound_type, above_zero, not_negative, force, deformation
   implicit none
   private

   public :: backbone_parameters

   character(len=*), parameter :: as_positive = 'the same on the negative side; without it as on the positive'

   !> Slopes this close to each other are the same.
   real(wp), parameter :: round_off = 1.0e-9_wp

   type :: backbone_parameters
      !> Cracking point [m], [N]; zero: uncracked from the start, elastic up to yield
      real(wp) :: d_c = unset, f_c = unset
      !> Yield point [m], [N]; capping point: the largest force [m], [N]
      real(wp) :: d_y = unset, f_y = unset, d_cap = unset, f_cap = unset
      !> Deformation from the cap to the point where the softening line reaches zero force [m]
      real(wp) :: d_pc = unset
      !> Residual force, at which softening ends [N]; deformation beyond which the force drops to zero [m];
      !> `unset`: none
      real(wp) :: f_res = unset, d_u = unset
   contains
      procedure :: visit
      procedure :: completed
      procedure :: check
      procedure :: stiffness
   end type backbone_parameters

contains

   !> The keys of a side. All of those of the negative side are optional and have a suffix.
   subroutine visit(self, v, negative)
      class(backbone_parameters), intent(inout) :: self
      type(key_visitor), intent(inout) :: v
      logical, intent(in) :: negative

      call key('d_y', self%d_y, deformation, above_zero, 'yield deformation')
      call key('f_y', self%f_y, force, above_zero, 'yield force')
      call key('d_cap', self%d_cap, deformation, above_zero, 'deformation at the cap, from d_y on')
      call key('f_cap', self%f_cap, force, above_zero, 'largest force, from f_y on')
      call key('d_pc', self%d_pc, deformation, above_zero, &
               'from the cap along the softening line to where it would have no force left')
      call key('f_res', self%f_res, force, not_negative, &
               'residual force, below f_y, which softening does not fall below')
      call key('d_u', self%d_u, deformation, above_zero, &
               'deformation beyond which the force falls to zero; without it there is none')
      call key('d_c', self%d_c, deformation, not_negative, 'cracking deformation; 0: elastic up to yield')
      call key('f_c', self%f_c, force, not_negative, 'cracking force')

   contains

      subroutine key(name, x, unit, bound, meaning)
         character(len=*), intent(in) :: name, unit, meaning
         real(wp), intent(inout) :: x
         type(bound_type), intent(in) :: bound

         if (negative) then
            call v%key(name//'_neg', x, unit, bound, as_positive, optional=.true.)
         else
            call v%key(name, x, unit, bound, meaning, optional=name == 'd_u')
         end if
      end subroutine key
   end subroutine visit

   !> A side; what is not given of it is as on the other side.
   pure type(backbone_parameters) function completed(self, other)
      class(backbone_parameters), intent(in) :: self, other

      completed = backbone_parameters( &
                  d_c=either(self%d_c, other%d_c), f_c=either(self%f_c, other%f_c), &
                  d_y=either(self%d_y, other%d_y), f_y=either(self%f_y, other%f_y), &
                  d_cap=either(self%d_cap, other%d_cap), f_cap=either(self%f_cap, other%f_cap), &
                  d_pc=either(self%d_pc, other%d_pc), f_res=either(self%f_res, other%f_res), &
                  d_u=either(self%d_u, other%d_u))
   end function completed

   pure real(wp) function either(x, other)
      real(wp), intent(in) :: x, other

      either = merge(x, other, is_given(x))
   end function either

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
