!> The springs of a column: rules off the hot path, their present lines as plain arrays on it.
module rbs_hysteresis_springs
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_spring_planes, only: spring_planes
   use rbs_hysteresis_spring_record, only: spring_record
   implicit none
   private

   public :: spring_array, follow_path

   !> All springs of a column, which move at the same time.
   type, extends(spring_planes) :: spring_array
   contains
      procedure :: move_all
      procedure :: carry_to
      procedure :: stay_on_lines
      procedure :: nearest_end
      procedure :: go_along
   end type spring_array

contains

   !> Move every spring to a new deformation.
   subroutine move_all(self, d)
      class(spring_array), intent(inout) :: self
      !> New deformations (count) [m or rad]
      real(wp), intent(in), contiguous :: d(:)
      integer :: i

      if (self%pressed) call self%press_joints(d)
      if (self%count == 2) then
         ! One body: while both springs stay on their lines, neither a loop nor a call is needed.
         if (d(1) <= self%last(1) .and. d(1) >= self%first(1) .and. &
             d(2) <= self%last(2) .and. d(2) >= self%first(2)) then
            call advance_pair(d, self%d0, self%f0, self%k, self%one_way, self%d, self%work, self%first, &
                           self%last)
            return
         end if
      end if
      if (.not. are_within(self%count, d, self%first, self%last)) then
         do i = 1, self%count
            if (d(i) > self%last(i) .or. d(i) < self%first(i)) call self%move(i, d(i))
         end do
         if (self%stuck) return
      end if
      ! Springs that have arrived do not move any more.
      call advance_all(self%count, d, self%d0, self%f0, self%k, self%one_way, self%d, self%work, self%first, &
                    self%last)
   end subroutine move_all

   !> Whether all springs can go to new deformations on their present lines.
   pure logical function stay_on_lines(self, d)
      class(spring_array), intent(in) :: self
      !> New deformations (count) [m or rad]
      real(wp), intent(in), contiguous :: d(:)

      stay_on_lines = are_within(self%count, d, self%first, self%last) .and. .not. self%pressed
   end function stay_on_lines

   pure logical function are_within(n, d, first, last)
      integer, intent(in) :: n
      real(wp), intent(in) :: d(n), first(n), last(n)
      integer :: i, outside

      outside = 0
      do i = 1, n
         outside = outside + merge(1, 0, d(i) > last(i) .or. d(i) < first(i))
      end do
      are_within = outside == 0
   end function are_within

   !> `advance_on_branch` for the two springs of one body.
   pure subroutine advance_pair(to, d0, f0, k, one_way, d, work, first, last)
      integer, intent(in) :: one_way(2)
      real(wp), intent(in) :: to(2), d0(2), f0(2), k(2)
      real(wp), intent(inout) :: d(2), work(2), first(2), last(2)
      integer :: i

      work = work + (f0 + k*(0.5_wp*(to + d) - d0))*(to - d)
      d = to
      do i = 1, 2
         if (one_way(i) > 0) first(i) = to(i)
         if (one_way(i) < 0) last(i) = to(i)
      end do
   end subroutine advance_pair

   !> `advance_on_branch` for all springs at once.
   pure subroutine advance_all(n, to, d0, f0, k, one_way, d, work, first, last)
      integer, intent(in) :: n, one_way(n)
      real(wp), intent(in) :: to(n), d0(n), f0(n), k(n)
      real(wp), intent(inout) :: d(n), work(n), first(n), last(n)
      integer :: i

      do i = 1, n
         work(i) = work(i) + (f0(i) + k(i)*(0.5_wp*(to(i) + d(i)) - d0(i)))*(to(i) - d(i))
         d(i) = to(i)
         first(i) = merge(to(i), first(i), one_way(i) > 0)
         last(i) = merge(to(i), last(i), one_way(i) < 0)
      end do
   end subroutine advance_all

   !> Move every spring to a deformation on its present line.
   subroutine carry_to(self, d)
      class(spring_array), intent(inout) :: self
      !> New deformations (count) [m or rad]
      real(wp), intent(in), contiguous :: d(:)

      if (self%pressed) call self%press_joints(d)
      if (self%count == 2) then
         call advance_pair(d, self%d0, self%f0, self%k, self%one_way, self%d, self%work, self%first, self%last)
         return
      end if
      call advance_all(self%count, d, self%d0, self%f0, self%k, self%one_way, self%d, self%work, self%first, &
                    self%last)
   end subroutine carry_to

   !> The first end of a line that springs reach from given deformations at constant rates.
   pure subroutine nearest_end(self, q, rate, way, ends)
      class(spring_array), intent(in) :: self
      !> Deformations and rates of the first springs
      real(wp), intent(in), contiguous :: q(:), rate(:)
      !> In units of the rates; `huge` if there is none
      real(wp), intent(out) :: way
      !> The spring, 0 for none
      integer, intent(out) :: ends
      real(wp) :: room
      integer :: i

      way = huge(1.0_wp)
      ends = 0
      do i = 1, size(q)
         room = huge(1.0_wp)
         if (rate(i) > 0.0_wp) room = distance(self%last(i) - q(i), rate(i))
         if (rate(i) < 0.0_wp) room = distance(q(i) - self%first(i), -rate(i))
         if (.not. room < way) cycle
         ! The end itself may lie beyond the last deformation of the line: far beyond, as ways go, where the
         ! rate is next to nothing.
         if (rate(i) > 0.0_wp) then
            room = distance(self%end_toward(i, 1) - q(i), rate(i))
         else
            room = distance(q(i) - self%end_toward(i, -1), -rate(i))
         end if
         if (.not. room < way) cycle
         way = room
         ends = i
      end do
   end subroutine nearest_end

   !> How long a spring needs for a distance; `huge` on a line without end.
   elemental real(wp) function distance(way, rate)
      real(wp), intent(in) :: way, rate

      distance = huge(1.0_wp)
      if (way < 0.5_wp*huge(1.0_wp)*min(rate, 1.0_wp)) distance = max(way, 0.0_wp)/rate
   end function distance

   !> Springs go at constant rates from given deformations, each on its own line and not beyond its end.
   pure subroutine go_along(self, q, rate, way)
      class(spring_array), intent(inout) :: self
      !> Deformations and rates of the first springs; in units of the rates
      real(wp), intent(in), contiguous :: q(:), rate(:)
      real(wp), intent(in) :: way
      integer :: i

      do i = 1, size(q)
         associate (to => min(max(q(i) + rate(i)*way, self%first(i)), self%last(i)))
            self%work(i) = self%work(i) + (self%f0(i) + self%k(i)*(0.5_wp*(to + self%d(i)) - self%d0(i))) &
                           *(to - self%d(i))
            self%d(i) = to
         end associate
         if (self%one_way(i) > 0) self%first(i) = self%d(i)
         if (self%one_way(i) < 0) self%last(i) = self%d(i)
      end do
   end subroutine go_along

   !> Forces of one virgin spring along a path.
   subroutine follow_path(spec, d, f)
      !> Validated parameters of the spring
      type(spring_record), intent(in) :: spec
      !> Deformations, one after the other (m) [m or rad]
      real(wp), intent(in) :: d(:)
      !> Forces there (m) [N or N m]; not a number where a layered joint has lost its axial load
      real(wp), intent(out) :: f(:)
      type(spring_array) :: spring
      integer :: j

      call spring%create([spec])
      do j = 1, size(d)
         call spring%move(1, d(j))
         f(j) = spring%force(1)
         if (spring%stuck .or. spring%lost_joint() > 0) f(j) = ieee_value(f(j), ieee_quiet_nan)
      end do
   end subroutine follow_path

end module rbs_hysteresis_springs
