!> Built-in cyclic protocol: full cycles of given amplitudes.
module rbs_loading_protocol
   use rbs_base_error, only: error_type, fatal_error, bad_input
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_loading_loading_record, only: loading_record, units_of
   use rbs_loading_named_protocols, only: named_protocol
   use rbs_base_units, only: to_si, unit_named
   implicit none
   private

   public :: protocol_values

   !> Most points of a protocol; a larger number is taken for a typing error.
   integer, parameter :: most_points = 100000000

contains

   !> Points of a protocol: from zero, the cycles 0, +a, 0, -b, 0 of every amplitude a and its negative one b,
   !> with each quarter in equal parts; the whole is repeated `repeats` times.
   subroutine protocol_values(spec, height, time, value, error)
      !> Validated loading with source = 'protocol'
      type(loading_record), intent(in) :: spec
      !> Height of the column, for amplitudes in drift [m]
      real(wp), intent(in) :: height
      !> Time of each point [s]; its number if no period is given
      real(wp), allocatable, intent(out) :: time(:)
      !> Points [m, N or m/s2]
      real(wp), allocatable, intent(out) :: value(:)
      type(error_type), allocatable, intent(out) :: error
      real(wp), allocatable :: positive(:), negative(:)
      integer, allocatable :: cycles(:)
      real(wp) :: total, interval, wave
      integer :: repeat, step, cycle, j, at, up, quarter

      if (spec%protocol /= '') then
         call named_protocol(spec%protocol, spec%reference, spec%largest, positive, cycles, error)
         if (allocated(error)) return
      else
         positive = spec%amplitudes
         allocate (cycles(size(positive)), source=1)
         ! One number of cycles serves all steps.
         if (allocated(spec%cycles)) cycles = spec%cycles(min([(j, j=1, size(cycles))], size(spec%cycles)))
      end if
      negative = positive
      if (allocated(spec%negative_amplitudes)) negative = spec%negative_amplitudes
      do step = 1, size(cycles)
         positive(step) = si_amplitude(spec, positive(step), height)
         negative(step) = si_amplitude(spec, negative(step), height)
      end do
      quarter = spec%points
      total = 4.0_wp*quarter*sum(real(cycles, wp))*spec%repeats + 1.0_wp
      if (total > real(most_points, wp)) then
         call fatal_error(error, bad_input, 'loading: the protocol has '//to_text(total)// &
                          ' points; reduce cycles, repeats or points to stay below '//to_text(most_points))
         return
      end if
      allocate (value(nint(total)), time(nint(total)))
      value(1) = 0.0_wp
      at = 1
      do repeat = 1, spec%repeats
         do step = 1, size(cycles)
            do cycle = 1, cycles(step)
               do j = 1, 4*quarter
                  ! The triangle wave between -1 and 1, exact at its peaks and zeros: up, and down from the
                  ! first quarter on
                  up = merge(2*quarter - j, j, j > quarter)
                  wave = real(merge(j - 4*quarter, up, j > 3*quarter), wp)/quarter
                  ! Adding zero gives a negative zero the sign of a positive one.
                  value(at + j) = merge(positive(step), negative(step), wave > 0.0_wp)*wave + 0.0_wp
               end do
               at = at + 4*quarter
            end do
         end do
      end do
      interval = 1.0_wp
      if (spec%period > 0.0_wp) interval = spec%period/(4*quarter)
      time = [((j - 1)*interval, j=1, size(value))]
   end subroutine protocol_values

   !> Amplitude in SI, with the factor `scale`; drift, the unit of displacements without another, is
   !> displacement over height.
   real(wp) function si_amplitude(spec, amplitude, height) result(si)
      type(loading_record), intent(in) :: spec
      !> In the unit of the loading; height of the column [m]
      real(wp), intent(in) :: amplitude, height

      si = amplitude*spec%scale
      if (spec%drive == 'displacement' .and. (spec%unit == '' .or. spec%unit == 'drift')) then
         si = si*height
      else
         si = to_si(si, unit_named(units_of(spec%drive), spec%unit))
      end if
   end function si_amplitude

end module rbs_loading_protocol
