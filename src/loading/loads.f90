!> The loads on a column in time.
module rbs_loading_loads
   use rbs_base_kinds, only: wp
   use rbs_loading_signal, only: signal_type
   use rbs_structure_structure, only: lateral, horizontal, vertical, axial => top_axial
   implicit none
   private

   public :: loads_type
   public :: lateral, horizontal, vertical, axial

   !> Signals without points are zero.
   type :: loads_type
      !> Lateral force at the top [N]
      type(signal_type) :: force
      !> Acceleration of the ground to +x and upward [m/s2]
      type(signal_type) :: ground, vertical
      !> Axial load besides the constant one, compression positive [N]
      type(signal_type) :: axial
      !> Which of the four act; found by `find_acting`
      logical :: acts(4) = .false.
   contains
      procedure :: find_acting
      procedure :: set_begin
      procedure :: at_time
      procedure :: corner_after
      procedure :: slope_after
      procedure :: find_largest
   end type loads_type

contains

   !> Find which of the four act; to be called once before `at_time`.
   subroutine find_acting(self)
      class(loads_type), intent(inout) :: self

      self%acts = [self%force%acts(), self%ground%acts(), self%vertical%acts(), self%axial%acts()]
   end subroutine find_acting

   !> Count times from a begin.
   subroutine set_begin(self, begin)
      class(loads_type), intent(inout) :: self
      !> Time of the clock there [s]
      real(wp), intent(in) :: begin

      if (self%force%acts()) self%force%time = self%force%time - begin
      if (self%ground%acts()) self%ground%time = self%ground%time - begin
      if (self%vertical%acts()) self%vertical%time = self%vertical%time - begin
      if (self%axial%acts()) self%axial%time = self%axial%time - begin
   end subroutine set_begin

   !> All four loads at a time [N, m/s2, m/s2, N].
   subroutine at_time(self, t, load)
      class(loads_type), intent(inout) :: self
      !> Time [s]
      real(wp), intent(in) :: t
      real(wp), intent(out) :: load(4)

      load = 0.0_wp
      if (self%acts(lateral)) load(lateral) = self%force%at_time(t)
      if (self%acts(horizontal)) load(horizontal) = self%ground%at_time(t)
      if (self%acts(vertical)) load(vertical) = self%vertical%at_time(t)
      if (self%acts(axial)) load(axial) = self%axial%at_time(t)
   end subroutine at_time

   !> Slopes of all four loads until the first corner after t [per s].
   subroutine slope_after(self, t, slope)
      class(loads_type), intent(inout) :: self
      real(wp), intent(in) :: t
      real(wp), intent(out) :: slope(4)

      slope = 0.0_wp
      if (self%acts(lateral)) slope(lateral) = self%force%slope_after(t)
      if (self%acts(horizontal)) slope(horizontal) = self%ground%slope_after(t)
      if (self%acts(vertical)) slope(vertical) = self%vertical%slope_after(t)
      if (self%acts(axial)) slope(axial) = self%axial%slope_after(t)
   end subroutine slope_after

   !> The first time after t at which a load changes its slope; `huge` if there is none [s].
   real(wp) function corner_after(self, t) result(corner)
      class(loads_type), intent(inout) :: self
      real(wp), intent(in) :: t

      corner = huge(1.0_wp)
      if (self%acts(lateral)) corner = min(corner, self%force%corner_after(t))
      if (self%acts(horizontal)) corner = min(corner, self%ground%corner_after(t))
      if (self%acts(vertical)) corner = min(corner, self%vertical%corner_after(t))
      if (self%acts(axial)) corner = min(corner, self%axial%corner_after(t))
   end function corner_after

   !> Largest values of the loads, in size.
   pure subroutine find_largest(self, largest)
      class(loads_type), intent(in) :: self
      real(wp), intent(out) :: largest(4)

      largest = 0.0_wp
      if (self%acts(lateral)) largest(lateral) = maxval(abs(self%force%value))
      if (self%acts(horizontal)) largest(horizontal) = maxval(abs(self%ground%value))
      if (self%acts(vertical)) largest(vertical) = maxval(abs(self%vertical%value))
      if (self%acts(axial)) largest(axial) = maxval(abs(self%axial%value))
   end subroutine find_largest

end module rbs_loading_loads
