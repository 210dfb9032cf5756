!> How continuous every rule is, and what its loops give: `study_rules [histories [rule]]` prints the table of
!> docs/rules.md.
program study_rules
   use, intrinsic :: iso_fortran_env, only: output_unit
   use any_rule, only: detours, loops, detour_result, loop_result
   use rbs_base_check, only: is_given
   use rbs_base_keys, only: key_type
   use rbs_hysteresis_registry, only: keys_of, rule_names
   use rbs_hysteresis_spring_record, only: spring_record
   implicit none
   character(len=32) :: argument, only_rule
   integer :: histories, i, j
   type(detour_result) :: changed
   type(loop_result) :: given

   histories = 10000
   call get_command_argument(1, argument)
   if (argument /= '') read (argument, *) histories
   call get_command_argument(2, only_rule)
   write (output_unit, '(a)') '| rule | largest change over k e: e = 1e-3 | 1e-6 | 1e-9 | above 10 |'// &
      ' least work | closed loops |'
   write (output_unit, '(a)') '| --- | ---: | ---: | ---: | ---: | ---: | ---: |'
   do i = 1, size(rule_names)
      if (only_rule /= '' .and. only_rule /= rule_names(i)) cycle
      call detours(trim(rule_names(i)), histories, changed)
      call loops(trim(rule_names(i)), histories, given)
      write (output_unit, '(3a, 3(es8.1, a), f6.2, a, 2(es8.1, a))') '| `', trim(rule_names(i)), '` | ', &
         (changed%largest(j), ' | ', j=1, 3), 100*maxval(changed%share), ' % | ', given%virgin, ' | ', &
         given%closed, ' |'
      flush (output_unit)
      if (only_rule == '') cycle
      call show(changed%spec)
      print '(a, i0, a, es24.16)', 'at ', changed%at, ' length ', changed%length
      print '(4es24.16)', changed%d
      if (.not. allocated(given%d)) cycle
      print '(a, 2es10.2, i8)', 'loops', given%virgin, given%closed, given%loops
      call show(given%spec)
      print '(4es24.16)', given%d
   end do

contains

   !> Print the parameters of a spring.
   recursive subroutine show(spec)
      type(spring_record), intent(in) :: spec
      type(key_type), allocatable :: keys(:)
      type(spring_record) :: layer
      integer :: k

      call keys_of(spec%rule, keys)
      do k = 1, size(keys)
         if (is_given(spec%value(k))) print '(2a, es24.16)', trim(keys(k)%name), ' = ', spec%value(k)
      end do
      if (.not. allocated(spec%y)) return
      print '(a, es24.16)', 'axial load', spec%axial_load
      do k = 1, size(spec%y)
         layer = spec%layer(k)
         print '(a, i0, a, es24.16, 2a)', 'layer ', k, ' at ', spec%y(k), ': ', trim(layer%rule)
         call show(layer)
      end do
   end subroutine show

end program study_rules
