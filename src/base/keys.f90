!> The keys of a case: the names under which a user sets the values of a record, each with its unit, bounds,
!> default and meaning.
!>
!> Reader, writer, validation, documentation and the Python package are driven by lists of keys. This
!> module defines the type of a key; each list is defined beside the record that it describes.
module rbs_base_keys
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use rbs_base_kinds, only: wp
   use rbs_base_check, only: is_given, check_finite
   use rbs_base_constants, only: beyond_meaning, unset
   use rbs_base_error, only: message_list
   use rbs_base_text, only: to_text
   implicit none
   private

   public :: key_type, bound_type, check_number, is_inside, bound_text, find_key, choice_number, &
             choice_name, choice_list

   !> Kinds of values: real number, whole number, logical, word out of a list of choices, free text.
   character(len=1), parameter, public :: real_kind = 'r', integer_kind = 'i', logical_kind = 'l'
   character(len=1), parameter, public :: word_kind = 'w', text_kind = 't'

   integer, parameter, public :: key_length = 24, choice_length = 24

   !> Dimensions of the parameters of a spring; the unit depends on the joint that the spring is for.
   character(len=*), parameter, public :: force = 'force', deformation = 'deformation'
   character(len=*), parameter, public :: stiffness = 'stiffness'

   !> The range that a number must be in.
   type :: bound_type
      real(wp) :: least = -huge(1.0_wp), most = huge(1.0_wp)
      !> Whether the bound itself is excluded; whether numbers may be arbitrarily close to zero, as the values
      !> of a history are
      logical :: least_open = .false., most_open = .false., tiny = .false.
      !> A reason that the message adds, such as '(it is a share)'
      character(len=40) :: reason = ''
   end type bound_type

   type(bound_type), parameter, public :: any_number = bound_type()
   type(bound_type), parameter, public :: any_value = bound_type(tiny=.true.)
   type(bound_type), parameter, public :: above_zero = bound_type(least=0.0_wp, least_open=.true.)
   type(bound_type), parameter, public :: not_negative = bound_type(least=0.0_wp)
   type(bound_type), parameter, public :: one_or_more = bound_type(least=1.0_wp)
   !> Shares of a whole: from zero to below one, and above zero up to one.
   type(bound_type), parameter, public :: share_below_one = &
      bound_type(0.0_wp, 1.0_wp, most_open=.true., reason='(it is a share)')
   type(bound_type), parameter, public :: share_above_zero = &
      bound_type(0.0_wp, 1.0_wp, least_open=.true., reason='(it is a share)')

   !> One key. Structure constructors with keywords make the lists of keys readable as tables.
   type :: key_type
      character(len=key_length) :: name = ''
      !> One of the kinds above
      character(len=1) :: kind = real_kind
      !> Unit, or dimension of a spring's parameter; empty for a dimensionless number
      character(len=16) :: unit = ''
      type(bound_type) :: bound = bound_type()
      !> Default; `unset`: the key has no default
      real(wp) :: default = unset
      character(len=24) :: default_text = ''
      !> Whether the value may be missing although it has no default
      logical :: optional = .false.
      !> Largest number of values
      integer :: most = 1
      !> Words that are allowed, separated by blanks
      character(len=112) :: choices = ''
      !> One line for the documentation
      character(len=128) :: meaning = ''
   end type key_type

contains

   !> Add a message if a number is missing where it must be given, not finite, or outside its bounds.
   subroutine check_number(x, name, key, messages, ok)
      real(wp), intent(in) :: x
      !> The owner of the number: 'shear spring of joint 2'
      character(len=*), intent(in) :: name
      type(key_type), intent(in) :: key
      type(message_list), intent(inout) :: messages
      !> Set to false if the number fails, else unchanged
      logical, intent(inout) :: ok
      character(len=32) :: number
      logical :: finite

      if (is_inside(x, key%bound)) return
      if (key%optional .and. .not. is_given(x)) return
      call check_finite(x, name//': '//trim(key%name), trim(unit_for_message()), messages, finite)
      if (finite) then
         if (is_within(x, key%bound)) return
         number = to_text(x)
         ! A whole number without an exponent
         if (key%kind == integer_kind .and. abs(x) < huge(1)) number = to_text(nint(x))
         call messages%add(trim(name//': '//trim(key%name)//' = '//trim(number)//' '//unit_for_message())// &
                           ' '//trim(refusal(key%bound)))
      end if
      ok = .false.

   contains

      !> The unit in messages; empty for the dimensions of springs, which are not units.
      pure character(len=16) function unit_for_message() result(unit)

         unit = key%unit
         if (unit == force .or. unit == deformation .or. unit == stiffness) unit = ''
      end function unit_for_message

      !> Why a number outside its bounds is refused: 'must be above zero'.
      character(len=96) function refusal(bound) result(text)
         type(bound_type), intent(in) :: bound
         logical :: below

         below = x <= bound%least
         if (bound%least > -huge(1.0_wp) .and. bound%most < huge(1.0_wp) .and. &
             .not. (bound%least_open .or. bound%most_open)) then
            text = 'must be from '//to_text(bound%least)//' to '//to_text(bound%most)
         else if (.not. below) then
            text = trim(merge('must be below    ', 'must not be above', bound%most_open))//' '// &
                   to_text(bound%most)
         else if (.not. abs(bound%least) > 0.0_wp) then
            text = merge('must be above zero  ', 'must not be negative', bound%least_open)
            return
         else if (bound%least_open) then
            text = 'must be above '//to_text(bound%least)
         else
            text = 'must be '//to_text(bound%least)//' or more'
         end if
         text = trim(text)//' '//bound%reason
      end function refusal

   end subroutine check_number

   !> Whether a number is finite, has a size that the arithmetic can bear, and is within its bounds.
   elemental logical function is_inside(x, bound)
      real(wp), intent(in) :: x
      type(bound_type), intent(in) :: bound

      ! A NaN is never compared: builds with floating-point traps would stop.
      is_inside = ieee_is_finite(x)
      if (.not. is_inside) return
      is_inside = abs(x) < beyond_meaning .and. &
                  (bound%tiny .or. abs(x) > 1.0_wp/beyond_meaning .or. .not. abs(x) > 0.0_wp)
      if (is_inside) is_inside = is_within(x, bound)
   end function is_inside

   !> Whether a finite number is within its bounds.
   elemental logical function is_within(x, bound)
      real(wp), intent(in) :: x
      type(bound_type), intent(in) :: bound

      is_within = x >= bound%least .and. x <= bound%most
      if (bound%least_open .and. .not. x > bound%least) is_within = .false.
      if (bound%most_open .and. .not. x < bound%most) is_within = .false.
   end function is_within

   !> A range in the documentation: '> 0', '0 to < 1'; empty where every number is allowed.
   pure character(len=48) function bound_text(bound) result(text)
      type(bound_type), intent(in) :: bound

      text = ''
      if (bound%most < huge(1.0_wp)) then
         if (bound%least_open) text = 'above '
         text = trim(text)//' '//to_text(bound%least)//' to'
         if (bound%most_open) text = trim(text)//' below'
         text = adjustl(trim(text)//' '//to_text(bound%most))
      else if (bound%least > -huge(1.0_wp)) then
         text = trim(merge('> ', '>=', bound%least_open))//' '//to_text(bound%least)
      end if
   end function bound_text

   !> Place of a key in a list, 0 if it is not there.
   pure integer function find_key(keys, name) result(number)
      type(key_type), intent(in) :: keys(:)
      character(len=*), intent(in) :: name

      do number = 1, size(keys)
         if (keys(number)%name == name) return
      end do
      number = 0
   end function find_key

   !> Place of a word among the choices of a key, 0 if it is not one of them.
   pure integer function choice_number(key, word) result(number)
      type(key_type), intent(in) :: key
      character(len=*), intent(in) :: word
      character(len=choice_length) :: name

      number = 0
      do
         name = choice_name(key, number + 1)
         if (name == '') exit
         number = number + 1
         if (name == word) return
      end do
      number = 0
   end function choice_number

   !> The word at a place among the choices of a key; blank beyond the last one.
   pure character(len=choice_length) function choice_name(key, number) result(name)
      type(key_type), intent(in) :: key
      integer, intent(in) :: number
      integer :: i, first, last

      name = ''
      first = 1
      do i = 1, number
         if (first > len(key%choices)) return
         last = index(key%choices(first:), ' ')
         if (last <= 1) return
         if (i == number) name = key%choices(first:first + last - 2)
         first = first + last
      end do
   end function choice_name

   !> The choices of a key, separated by commas.
   pure function choice_list(key) result(text)
      type(key_type), intent(in) :: key
      character(len=2*len(key%choices)) :: text
      integer :: i

      text = choice_name(key, 1)
      do i = 2, len(key%choices)
         if (choice_name(key, i) == '') return
         text = trim(text)//', '//choice_name(key, i)
      end do
   end function choice_list

end module rbs_base_keys
