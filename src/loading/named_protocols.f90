!> Protocols of the literature by name: amplitudes and numbers of cycles.
!>
!> Sources, and how far they could be confirmed: docs/input.md, "Named protocols".
module rbs_loading_named_protocols
   use rbs_base_error, only: error_type, fatal_error, bad_input
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   implicit none
   private

   public :: named_protocol, counted_in_drift

   !> The names, as the choices of a key.
   character(len=*), parameter, public :: protocol_names = 'aci_374_1 aci_374_2 atc_24 curee fema_461 sac'

   !> Units that the amplitudes of a protocol are counted in.
   integer, parameter :: in_drift = 1, in_reference = 2

   !> Most steps; more are taken for a typing error.
   integer, parameter :: most_steps = 900

   !> Amplitudes in ascending order with their cycles, and the rule of further ones.
   type :: ladder_type
      !> `in_drift` or `in_reference`
      integer :: counted = in_drift
      !> Meaning of the reference of the protocol
      character(len=40) :: reference = ''
      !> Amplitudes, as drifts or as multiples of the reference, and numbers of cycles at each (steps)
      real(wp), allocatable :: amplitude(:)
      integer, allocatable :: cycles(:)
      !> Every step is followed by as many cycles at a smaller amplitude, a factor of its own; 0: by none
      !> (steps)
      integer, allocatable :: trailing(:)
      real(wp) :: trailing_factor = 0.0_wp
      !> Behind the last step each further one is higher by `rise`, with this many cycles, and cycles that
      !> trail; 0: no further step
      real(wp) :: rise = 0.0_wp
      integer :: further_cycles = 0, further_trailing = 0
      !> Whether only a largest amplitude ends the protocol
      logical :: endless = .false.
   end type ladder_type

contains

   !> Amplitudes and cycles of a protocol. A message names a value that is missing or too much.
   subroutine named_protocol(name, reference, largest, amplitudes, cycles, error)
      !> One of `protocol_names`
      character(len=*), intent(in) :: name
      !> The amplitude that the protocol is counted in; not above zero: not given
      real(wp), intent(in) :: reference
      !> Bound of the amplitudes; not above zero: the end of the protocol itself
      real(wp), intent(in) :: largest
      !> Amplitudes as drifts, or in the unit of the reference, and cycles at each; smaller ones that trail
      !> are steps of their own (steps)
      real(wp), allocatable, intent(out) :: amplitudes(:)
      integer, allocatable, intent(out) :: cycles(:)
      type(error_type), allocatable, intent(out) :: error
      type(ladder_type) :: ladder
      character(len=:), allocatable :: who

      who = "loading: protocol = '"//trim(name)//"'"
      call make_ladder(name, reference, ladder)
      if (.not. allocated(ladder%amplitude)) then
         call fatal_error(error, bad_input, who//' is not known; it is one of '//protocol_names)
      else if (ladder%reference /= '' .and. .not. reference > 0.0_wp) then
         call fatal_error(error, bad_input, who//' needs reference, '//trim(ladder%reference)// &
                          '; give it in the unit of the amplitudes')
      else if (ladder%reference == '' .and. reference > 0.0_wp) then
         call fatal_error(error, bad_input, who//' has amplitudes in drift and takes no reference; leave '// &
                          'out reference')
      else if (ladder%endless .and. .not. largest > 0.0_wp) then
         call fatal_error(error, bad_input, who//' has no end of its own; give the largest amplitude')
      else
         if (ladder%counted == in_reference) then
            ladder%amplitude = ladder%amplitude*reference
            ladder%rise = ladder%rise*reference
         end if
         call climb()
      end if

   contains

      !> Set the steps of the ladder up to the largest amplitude.
      subroutine climb()
         !> Amplitude of a step, bound of all, and amplitude of the last step that the ladder states
         real(wp) :: amplitude, most, top
         integer :: step, last, count, trailing

         last = size(ladder%amplitude)
         top = ladder%amplitude(last)
         ! An amplitude that is the largest but for round-off is in it.
         most = largest*(1.0_wp + 1e-9_wp)
         if (.not. largest > 0.0_wp) most = top
         if (most < ladder%amplitude(1)) then
            call fatal_error(error, bad_input, who//' begins at '//to_text(ladder%amplitude(1))// &
                             ', beyond largest = '//to_text(largest)//'; give a larger one')
            return
         else if (most > top .and. .not. ladder%rise > 0.0_wp .and. largest > top*(1.0_wp + 1e-9_wp)) then
            call fatal_error(error, bad_input, who//' ends at '//to_text(top)//', before largest = '// &
                             to_text(largest)//'; leave largest out, or give amplitudes')
            return
         else if (most > top*(1.0_wp + 1e-9_wp) + most_steps*ladder%rise) then
            call fatal_error(error, bad_input, who//' has more than '//to_text(most_steps)// &
                             ' steps up to largest = '//to_text(largest)//'; give a smaller one')
            return
         end if
         allocate (amplitudes(0), cycles(0))
         step = 0
         do
            step = step + 1
            if (step > last .and. .not. ladder%rise > 0.0_wp) exit
            amplitude = top + (step - last)*ladder%rise
            count = ladder%further_cycles
            trailing = ladder%further_trailing
            if (step <= last) then
               amplitude = ladder%amplitude(step)
               count = ladder%cycles(step)
               trailing = 0
               if (allocated(ladder%trailing)) trailing = ladder%trailing(step)
            end if
            if (amplitude > most) exit
            amplitudes = [amplitudes, amplitude]
            cycles = [cycles, count]
            if (trailing == 0) cycle
            amplitudes = [amplitudes, ladder%trailing_factor*amplitude]
            cycles = [cycles, trailing]
         end do
      end subroutine climb

   end subroutine named_protocol

   !> Whether the amplitudes of a protocol are drifts, and not multiples of its reference.
   logical function counted_in_drift(name)
      !> One of `protocol_names`
      character(len=*), intent(in) :: name
      type(ladder_type) :: ladder

      call make_ladder(name, 1.0_wp, ladder)
      counted_in_drift = allocated(ladder%amplitude) .and. ladder%counted == in_drift
   end function counted_in_drift

   !> The ladder of a protocol; without amplitudes if there is no protocol of the name.
   subroutine make_ladder(name, reference, ladder)
      !> One of `protocol_names`, or another word
      character(len=*), intent(in) :: name
      !> Only for 'aci_374_2', whose numbers of cycles depend on it
      real(wp), intent(in) :: reference
      type(ladder_type), intent(out) :: ladder
      integer :: i

      select case (name)
      case ('sac')
         ladder%amplitude = [0.00375_wp, 0.005_wp, 0.0075_wp, 0.01_wp, 0.015_wp, 0.02_wp, 0.03_wp, 0.04_wp]
         ladder%cycles = [6, 6, 6, 4, 2, 2, 2, 2]
         ladder%rise = 0.01_wp
         ladder%further_cycles = 2
      case ('fema_461')
         ladder%counted = in_reference
         ladder%reference = 'the amplitude of its tenth step'
         ladder%amplitude = [(1.4_wp**(i - 10), i=1, 10)]
         ladder%cycles = spread(2, 1, 10)
         ladder%rise = 0.3_wp
         ladder%further_cycles = 2
      case ('curee')
         ladder%counted = in_reference
         ladder%reference = 'the reference deformation'
         ladder%amplitude = [0.05_wp, 0.075_wp, 0.1_wp, 0.2_wp, 0.3_wp, 0.4_wp, 0.7_wp, 1.0_wp]
         ladder%cycles = [6, 1, 1, 1, 1, 1, 1, 1]
         ladder%trailing = [0, 6, 6, 3, 3, 2, 2, 2]
         ladder%trailing_factor = 0.75_wp
         ladder%rise = 0.5_wp
         ladder%further_cycles = 1
         ladder%further_trailing = 2
      case ('aci_374_1')
         ladder%amplitude = [0.002_wp, 0.0025_wp, 0.0035_wp, 0.005_wp, 0.0075_wp, 0.01_wp, 0.014_wp, &
                             0.02_wp, 0.0275_wp, 0.035_wp]
         ladder%cycles = spread(3, 1, 10)
      case ('aci_374_2')
         ladder%reference = 'the drift at yield'
         ladder%amplitude = [0.003_wp, 0.005_wp, 0.0075_wp, 0.01_wp, 0.015_wp, 0.02_wp, 0.025_wp, 0.03_wp, &
                             0.04_wp]
         ladder%cycles = merge(3, 2, ladder%amplitude <= reference)
         ladder%rise = 0.01_wp
         ladder%further_cycles = 2
      case ('atc_24')
         ladder%counted = in_reference
         ladder%reference = 'the amplitude at yield'
         ladder%amplitude = [0.5_wp, 0.75_wp, 1.0_wp, 2.0_wp, 3.0_wp]
         ladder%cycles = spread(3, 1, 5)
         ladder%rise = 1.0_wp
         ladder%further_cycles = 2
         ladder%endless = .true.
      case default                                  ! no amplitudes
      end select
   end subroutine make_ladder

end module rbs_loading_named_protocols
