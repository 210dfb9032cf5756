!> The springs of a column: rules off the hot path, their present lines as plain arrays on it.
module rbs_hysteresis_springs
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
   use rbs_base_kinds, only: wp
   use rbs_base_constants, only: unbounded
   use rbs_hysteresis_factory, only: new_rule
   use rbs_hysteresis_rule, only: rule_type
   use rbs_hysteresis_segment, only: segment
   use rbs_spec_spring, only: spring_spec
   implicit none
   private

   public :: spring_array, follow_path

   !> More lines than this within one move are a circle of lines without length: a fault of a rule. The
   !> longest honest move closes all the open inner loops that a rule remembers.
   integer, parameter :: most_lines = 10000

   !> Holds one rule. Arrays of a polymorphic type are kept out of the program; arrays of this are fine.
   type :: rule_slot
      class(rule_type), allocatable :: rule
   end type rule_slot

   !> `count` springs in their present state. Assignment copies everything, memory of the rules too.
   type :: spring_array
      !> Number of springs
      integer :: count = 0
      !> Present deformation (count) [m or rad]
      real(wp), allocatable :: d(:)
      !> Present line: anchor and slope (count)
      real(wp), allocatable :: d0(:), f0(:), k(:)
      !> First and last deformation that belong to the present line (count)
      real(wp), allocatable :: first(:), last(:)
      !> One-way lines (count), see `segment`
      integer, allocatable :: one_way(:)
      !> Work done on each spring along its path, exact (count) [J]
      real(wp), allocatable :: work(:)
      !> Number of lines left so far
      integer :: events = 0
      !> Whether a rule has gone in a circle; the state is then of no use
      logical :: stuck = .false.
      !> The lines themselves (count), with the ends as the rules gave them
      type(segment), allocatable :: line(:)
      type(rule_slot), allocatable, private :: slot(:)
   contains
      procedure :: create
      procedure :: force
      procedure :: move
      procedure :: move_all
      procedure :: walk
      procedure :: leave
      procedure :: arrive
   end type spring_array

contains

   !> Virgin springs.
   subroutine create(self, specs)
      class(spring_array), intent(out) :: self
      !> Validated numbers of each spring
      type(spring_spec), intent(in) :: specs(:)
      integer :: i, n

      n = size(specs)
      self%count = n
      allocate (self%slot(n), self%line(n), self%one_way(n))
      allocate (self%d(n), self%work(n), source=0.0_wp)
      allocate (self%d0(n), self%f0(n), self%k(n), self%first(n), self%last(n))
      do i = 1, n
         call new_rule(self%slot(i)%rule, specs(i))
         call self%slot(i)%rule%start(self%line(i))
         call put_line(self, i)
      end do
   end subroutine create

   !> Force of one spring at its present deformation [N or N m].
   pure real(wp) function force(self, i)
      class(spring_array), intent(in) :: self
      integer, intent(in) :: i

      force = self%f0(i) + self%k(i)*(self%d(i) - self%d0(i))
   end function force

   !> Move every spring to a new deformation.
   subroutine move_all(self, d)
      class(spring_array), intent(inout) :: self
      !> New deformations (count) [m or rad]
      real(wp), intent(in) :: d(:)
      integer :: i

      do i = 1, self%count
         call self%move(i, d(i))
      end do
   end subroutine move_all

   !> Move one spring monotonically to a new deformation, along as many lines as lie between.
   subroutine move(self, i, d)
      class(spring_array), intent(inout) :: self
      integer, intent(in) :: i
      !> New deformation [m or rad]
      real(wp), intent(in) :: d
      integer :: lines

      do lines = 1, most_lines
         if (d > self%last(i)) then
            call change_line(self, i, 1)
         else if (d < self%first(i)) then
            call change_line(self, i, -1)
         else
            call walk(self, i, d)
            return
         end if
      end do
      self%stuck = .true.
   end subroutine move

   !> Go on the present line to d; the rear end of a one-way line comes along.
   pure subroutine walk(self, i, d)
      class(spring_array), intent(inout) :: self
      integer, intent(in) :: i
      !> New deformation on the present line [m or rad]
      real(wp), intent(in) :: d
      real(wp) :: f_mean

      f_mean = self%f0(i) + self%k(i)*(0.5_wp*(d + self%d(i)) - self%d0(i))
      self%work(i) = self%work(i) + f_mean*(d - self%d(i))
      self%d(i) = d
      if (self%one_way(i) > 0) then
         self%first(i) = d
      else if (self%one_way(i) < 0) then
         self%last(i) = d
      end if
   end subroutine walk

   !> Go to the end of the present line and ask the rule for the one that follows. The rear end of a
   !> one-way line is where the spring is.
   subroutine change_line(self, i, direction)
      class(spring_array), intent(inout) :: self
      integer, intent(in) :: i, direction

      if (self%one_way(i) == direction .or. self%one_way(i) == 0) then
         call walk(self, i, self%line(i)%end_toward(direction))
      else if (direction < 0) then
         self%line(i)%lo = self%d(i)
      else
         self%line(i)%hi = self%d(i)
      end if
      call self%slot(i)%rule%next(self%line(i), direction)
      self%events = self%events + 1
      call put_line(self, i)
   end subroutine change_line

   !> Copy a line into the arrays. An open end is the line's up to the number before it.
   subroutine put_line(self, i)
      class(spring_array), intent(inout) :: self
      integer, intent(in) :: i

      associate (line => self%line(i))
         self%d0(i) = line%d0
         self%f0(i) = line%f0
         self%k(i) = line%k
         self%one_way(i) = line%one_way
         self%first(i) = line%lo
         self%last(i) = line%hi
         if (.not. line%lo_closed .and. line%lo > -unbounded) self%first(i) = nearest(line%lo, 1.0_wp)
         if (.not. line%hi_closed .and. line%hi < unbounded) self%last(i) = nearest(line%hi, -1.0_wp)
      end associate
   end subroutine put_line

   !> A spring stands at an end of its line and is about to go on beyond it.
   subroutine leave(self, i, direction)
      class(spring_array), intent(inout) :: self
      integer, intent(in) :: i
      !> +1: by the upper end, -1: by the lower end
      integer, intent(in) :: direction

      call change_line(self, i, direction)
      ! A new one-way line begins where the spring is, to the last bit.
      if (self%one_way(i) > 0) self%first(i) = self%d(i)
      if (self%one_way(i) < 0) self%last(i) = self%d(i)
   end subroutine leave

   !> Put a spring exactly on the end of its line in a direction; an open end leads onto the next line.
   subroutine arrive(self, i, direction)
      class(spring_array), intent(inout) :: self
      integer, intent(in) :: i
      integer, intent(in) :: direction
      logical :: closed

      closed = merge(self%line(i)%hi_closed, self%line(i)%lo_closed, direction > 0)
      call walk(self, i, self%line(i)%end_toward(direction))
      if (.not. closed) call self%leave(i, direction)
   end subroutine arrive

   !> Forces of one virgin spring along a path.
   subroutine follow_path(spec, d, f)
      !> Validated numbers of the spring
      type(spring_spec), intent(in) :: spec
      !> Deformations, one after the other (m) [m or rad]
      real(wp), intent(in) :: d(:)
      !> Forces there (m) [N or N m]
      real(wp), intent(out) :: f(:)
      type(spring_array) :: spring
      integer :: j

      call spring%create([spec])
      do j = 1, size(d)
         call spring%move(1, d(j))
         f(j) = spring%force(1)
         if (spring%stuck) f(j) = ieee_value(f(j), ieee_quiet_nan)
      end do
   end subroutine follow_path

end module rbs_hysteresis_springs
