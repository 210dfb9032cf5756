!> The input of one spring: its rule and the parameters of the rule.
!>
!> Deformation is slip [m], rotation [rad] or opening [m], force is shear [N], moment [N m] or axial
!> force [N].
module rbs_hysteresis_spring_record
   use rbs_base_check, only: check_finite, check_name
   use rbs_base_constants, only: unset
   use rbs_base_error, only: message_list
   use rbs_base_keys, only: any_number, is_inside
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text, list_of
   use rbs_hysteresis_layered_layered_joint, only: layered_rule
   use rbs_hysteresis_registry, only: rule_names, new_rule, suits
   use rbs_hysteresis_rule, only: rule_type, rule_slot, spring_rules, rule_length, most_parameters, in_layer
   implicit none
   private

   public :: spring_record, add_rules

   !> The place of a rule among `rule_names`, stored for layers.
   integer, parameter :: no_rule = 0

   !> One spring. Layers belong to the rule `layered` alone.
   type :: spring_record
      !> One of `rule_names`
      character(len=rule_length) :: rule = ''
      !> Line of the input that its group begins in, for messages; 0: not from a file
      integer :: line = 0
      !> Parameters in the order of the keys of the rule; a word is stored as its place among the choices;
      !> `unset`: not given
      real(wp) :: value(most_parameters) = unset
      !> Axial load that the layers share, compression positive; the column sets it [N]
      real(wp) :: axial_load = 0.0_wp
      !> Distances of the layers from the middle of the section (layers) [m]
      real(wp), allocatable :: y(:)
      !> Rules of the layers, by their place among `rule_names` (layers), and parameters (most_parameters,
      !> layers)
      integer, allocatable :: layer_rule(:)
      !> Lines of the input where the springs of the layers are (layers), and their places; 0: not from a file
      integer, allocatable :: layer_line(:)
      integer :: places_line = 0
      real(wp), allocatable :: layer_value(:, :)
   contains
      procedure :: set_layers, layer, validate, make, initial_stiffness, same_as, where_given
   end type spring_record

contains

   !> Beginning of a message on the spring: 'line 4: ', or nothing where it is not from a file.
   subroutine where_given(self, text)
      class(spring_record), intent(in) :: self
      character(len=:), allocatable, intent(out) :: text

      text = ''
      if (self%line > 0) text = 'line '//to_text(self%line)//': '
   end subroutine where_given

   !> Give a joint its layers.
   pure subroutine set_layers(self, y, spring)
      class(spring_record), intent(inout) :: self
      !> Distances from the middle of the section [m], and the spring of each layer (layers)
      real(wp), intent(in) :: y(:)
      type(spring_record), intent(in) :: spring(:)
      integer :: i

      self%y = y
      if (allocated(self%layer_rule)) deallocate (self%layer_rule, self%layer_value, self%layer_line)
      allocate (self%layer_rule(size(y)), self%layer_line(size(y)))
      allocate (self%layer_value(most_parameters, size(y)))
      do i = 1, size(y)
         self%layer_rule(i) = max(findloc(rule_names == spring(i)%rule, .true., dim=1), no_rule)
         self%layer_value(:, i) = spring(i)%value
         self%layer_line(i) = spring(i)%line
      end do
   end subroutine set_layers

   !> The spring of a layer.
   pure type(spring_record) function layer(self, i)
      class(spring_record), intent(in) :: self
      !> Number of the layer
      integer, intent(in) :: i

      if (self%layer_rule(i) /= no_rule) layer%rule = rule_names(self%layer_rule(i))
      layer%value = self%layer_value(:, i)
      layer%line = self%layer_line(i)
   end function layer

   !> Add a message for every parameter that the rule does not allow.
   recursive subroutine validate(self, name, messages)
      class(spring_record), intent(in) :: self
      !> Name of the spring: 'shear spring of joint 2'
      character(len=*), intent(in) :: name
      type(message_list), intent(inout) :: messages
      class(rule_type), allocatable :: rule
      integer :: found_rule
      logical :: sound

      call new_rule(self%rule, rule)
      if (.not. allocated(rule)) then
         call check_name(self%rule, rule_names, name//': rule', messages, found_rule)
         return
      end if
      call rule%take(self%value)
      call rule%check(name, messages, sound)
      if (sound) call rule%check_relations(name, messages)
      if (self%rule == 'layered') then
         call validate_layers(self, name, messages)
      else if (allocated(self%y)) then
         call messages%add(name//': layers are not used by the rule '//trim(self%rule)// &
                           '; remove them or choose the rule layered')
      end if
   end subroutine validate

   !> Check the layers of a joint and their springs.
   recursive subroutine validate_layers(self, name, messages)
      type(spring_record), intent(in) :: self
      !> Name of the spring: 'shear spring of joint 2'
      character(len=*), intent(in) :: name
      type(message_list), intent(inout) :: messages
      type(spring_record) :: layer
      character(len=:), allocatable :: prefix
      integer :: i

      if (.not. allocated(self%y)) then
         call messages%add(name//': the layers are missing; give at least two')
         return
      end if
      if (size(self%y) < 2) then
         call messages%add(name//': one layer has no stiffness against rotation; give at least two')
      end if
      do i = 1, size(self%y)
         if (.not. is_inside(self%y(i), any_number)) then
            call move_to_line(self%line, self%places_line, name, prefix)
            call check_finite(self%y(i), prefix//': y of layer '//to_text(i), 'm', messages)
         end if
         ! The errors of equal layers have been reported.
         if (same_as_before(self, i)) cycle
         layer = self%layer(i)
         call move_to_line(self%line, layer%line, name, prefix)
         if (.not. suits(layer%rule, in_layer)) then
            call messages%add(prefix//': layer '//to_text(i)//" has the rule '"//trim(layer%rule)// &
                              "'; it is one of "//list_of(pack(rule_names, suits(rule_names, in_layer))))
         else
            call layer%validate(prefix//': layer '//to_text(i), messages)
         end if
         ! All layers may have the same error: a few messages are enough.
         if (messages%count > 20) return
      end do
   end subroutine validate_layers

   !> The name of a spring with the line of another group, in which the fault is.
   pure subroutine move_to_line(from, to, name, moved)
      !> Lines of the input; 0: not from a file
      integer, intent(in) :: from, to
      !> The name with the first line, and with the second
      character(len=*), intent(in) :: name
      character(len=:), allocatable, intent(out) :: moved

      moved = name
      if (from == 0 .or. to == 0) return
      associate (first => 'line '//to_text(from)//': ')
         if (index(name, first) == 1) moved = 'line '//to_text(to)//': '//name(len(first) + 1:)
      end associate
   end subroutine move_to_line

   !> Whether the layer before layer i has the same spring.
   pure logical function same_as_before(self, i)
      type(spring_record), intent(in) :: self
      integer, intent(in) :: i

      same_as_before = i > 1
      if (same_as_before) same_as_before = same_layer(self, i, i - 1)
   end function same_as_before

   !> Whether two layers have the same spring.
   pure logical function same_layer(self, i, j)
      type(spring_record), intent(in) :: self
      integer, intent(in) :: i, j

      same_layer = self%layer_rule(i) == self%layer_rule(j)
      if (same_layer) same_layer = all(same_bits(self%layer_value(:, i), self%layer_value(:, j)))
   end function same_layer

   !> Whether two numbers have the same bits: a NaN must not be compared, as that may trap.
   elemental logical function same_bits(a, b)
      use, intrinsic :: iso_fortran_env, only: int64
      real(wp), intent(in) :: a, b

      same_bits = transfer(a, 0_int64) == transfer(b, 0_int64)
   end function same_bits

   !> Whether another spring has the same rule and parameters.
   pure logical function same_as(self, other)
      class(spring_record), intent(in) :: self
      type(spring_record), intent(in) :: other

      same_as = self%rule == other%rule .and. all(same_bits(self%value, other%value)) .and. &
                (allocated(self%y) .eqv. allocated(other%y))
      if (.not. same_as .or. .not. allocated(self%y)) return
      same_as = size(self%y) == size(other%y)
      if (same_as) same_as = all(same_bits(self%y, other%y)) .and. all(self%layer_rule == other%layer_rule)
      if (same_as) same_as = all(same_bits(self%layer_value, other%layer_value))
   end function same_as

   !> The rule with its parameters, of a spring that has been validated.
   recursive subroutine make(self, rule)
      class(spring_record), intent(in) :: self
      class(rule_type), allocatable, intent(out) :: rule

      call new_rule(self%rule, rule)
      call rule%take(self%value)
      select type (rule)
      type is (layered_rule)
         call make_layers(self, rule)
      end select
      call rule%prepare()
   end subroutine make

   !> The layers of a joint. Equal springs share a rule; those at one place, as bars in a row, are one layer
   !> that counts several times.
   recursive subroutine make_layers(self, joint)
      type(spring_record), intent(in) :: self
      type(layered_rule), intent(inout) :: joint
      type(spring_record) :: layer
      real(wp) :: weight(size(self%y))
      !> The first layer with the same spring, and the rule of each layer
      integer, dimension(size(self%y)) :: same, rule_of
      integer :: i, j, rules

      weight = 0.0_wp
      rules = 0
      do i = 1, size(self%y)
         same(i) = i
         do j = i - 1, 1, -1
            if (same(j) < j .or. .not. same_layer(self, i, j)) cycle
            same(i) = j
            exit
         end do
         if (same(i) == i) rules = rules + 1
         rule_of(i) = rules
         if (same(i) < i) rule_of(i) = rule_of(same(i))
         do j = 1, i - 1
            if (same(j) == same(i) .and. same_bits(self%y(j), self%y(i))) exit
         end do
         ! Here j is the first layer of this spring at this place; if there was none before, i itself.
         weight(j) = weight(j) + 1.0_wp
      end do
      joint%y = pack(self%y, weight > 0.0_wp)
      joint%weight = pack(weight, weight > 0.0_wp)
      joint%rule_of = pack(rule_of, weight > 0.0_wp)
      allocate (joint%rule(rules))
      do i = 1, size(self%y)
         if (same(i) < i) cycle
         layer = self%layer(i)
         call layer%make(joint%rule(rule_of(i))%rule)
      end do
   end subroutine make_layers

   !> Stiffness of the virgin spring, of the stiffer side if they differ [N/m or N m/rad]. The spring must
   !> have been validated.
   impure elemental real(wp) function initial_stiffness(self)
      class(spring_record), intent(in) :: self
      class(rule_type), allocatable :: rule

      call self%make(rule)
      initial_stiffness = rule%initial_stiffness
   end function initial_stiffness

   !> Add the rules of springs; neighbours that are equal share one.
   subroutine add_rules(rules, spring, count)
      type(spring_rules), intent(inout) :: rules
      !> Validated springs: one for all, or one for each
      type(spring_record), intent(in) :: spring(:)
      !> Number of springs that are added
      integer, intent(in) :: count
      type(rule_slot), allocatable :: list(:)
      !> Of each new rule the first spring that has it; of each new spring its rule
      integer :: first(count), of(count), before, i, j, n

      if (.not. allocated(rules%list)) allocate (rules%list(0), rules%name(0), rules%of(0))
      before = size(rules%list)
      n = 0
      do i = 1, count
         j = min(i, size(spring))
         if (n > 0) then
            of(i) = before + n
            if (spring(j)%same_as(spring(first(n)))) cycle
         end if
         n = n + 1
         first(n) = j
         of(i) = before + n
      end do
      allocate (list(before + n))
      do i = 1, before
         call move_alloc(rules%list(i)%rule, list(i)%rule)
      end do
      do i = 1, n
         call spring(first(i))%make(list(before + i)%rule)
      end do
      call move_alloc(list, rules%list)
      rules%name = [character(len=rule_length) :: rules%name, spring(first(:n))%rule]
      rules%of = [rules%of, of]
   end subroutine add_rules

end module rbs_hysteresis_spring_record
