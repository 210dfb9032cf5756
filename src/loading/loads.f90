!> The loads on a structure in time.
module rbs_loading_loads
   use rbs_base_kinds, only: wp
   use rbs_loading_signal, only: signal_type
   use rbs_structure_structure, only: lateral, horizontal, vertical, top_axial, sideways, signals, &
                                      signal_names
   implicit none
   private

   public :: loads_type
   public :: lateral, horizontal, vertical, top_axial, sideways, signals, signal_names

   !> The signals of all loads, each a table of its own times.
   type :: loads_type
      !> Signals, in the order of `lateral` and so on [N, m/s2, m/s2, N, m/s2]; one without points is zero
      type(signal_type) :: signal(signals)
      !> Which signals act; found by `find_acting`
      logical :: acts(signals) = .false.
   contains
      procedure :: find_acting, set_begin, at_time, corner_after, find_largest
   end type loads_type

contains

   !> Find which signals act; to be called once before `at_time`.
   subroutine find_acting(self)
      class(loads_type), intent(inout) :: self

      self%acts = self%signal%acts()
      ! Axial loads that vary ask more of a method; with a ground that does not rise they are constant.
      self%acts(vertical) = self%signal(vertical)%is_nonzero()
   end subroutine find_acting

   !> Count the times of all signals from a begin.
   subroutine set_begin(self, begin)
      class(loads_type), intent(inout) :: self
      !> Time of the clock there [s]
      real(wp), intent(in) :: begin
      integer :: i

      do i = 1, signals
         if (self%acts(i)) self%signal(i)%time = self%signal(i)%time - begin
      end do
   end subroutine set_begin

   !> Values of all signals at a time. The signals are changed: they keep the interval that was found.
   subroutine at_time(self, t, load)
      class(loads_type), intent(inout) :: self
      !> Time [s]
      real(wp), intent(in) :: t
      !> In the order of `lateral` and so on (signals) [N, m/s2, m/s2, N, m/s2]
      real(wp), intent(out) :: load(signals)
      integer :: i

      do i = 1, signals
         load(i) = 0.0_wp
         if (self%acts(i)) load(i) = self%signal(i)%at_time(t)
      end do
   end subroutine at_time

   !> The first time after t at which a load changes its slope; `huge` if there is none [s].
   real(wp) function corner_after(self, t) result(corner)
      class(loads_type), intent(inout) :: self
      !> Time [s]
      real(wp), intent(in) :: t
      integer :: i

      corner = huge(1.0_wp)
      do i = 1, signals
         if (self%acts(i)) corner = min(corner, self%signal(i)%corner_after(t))
      end do
   end function corner_after

   !> Largest values of the loads, in size.
   pure subroutine find_largest(self, largest)
      class(loads_type), intent(in) :: self
      !> In the order of `lateral` and so on (signals) [N, m/s2, m/s2, N, m/s2]
      real(wp), intent(out) :: largest(signals)
      integer :: i

      largest = 0.0_wp
      do i = 1, signals
         if (self%acts(i)) largest(i) = maxval(abs(self%signal(i)%value))
      end do
   end subroutine find_largest

end module rbs_loading_loads
