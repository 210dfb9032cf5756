!> Equilibrium of a frame on the present lines of its springs, and how it goes on: a band of the displacements
!> of the nodes, bordered by what is driven. Either the lateral load grows, dead load being there, or the dead
!> load itself.
module rbs_solve_static_frame_equilibrium
   use rbs_base_band_matrix, only: band_matrix
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_springs, only: spring_array
   use rbs_solve_static_equilibrium, only: equilibrium_type
   use rbs_structure_frame_frame, only: frame_type
   use rbs_structure_structure, only: lateral
   implicit none
   private

   public :: frame_equilibrium

   !> A way, or a rotation, per way of the top that no stable part of a frame has [-, 1/m].
   real(wp), parameter :: without_end = 1.0e8_wp

   !> Share of the height, or rotation, that no correction of round-off comes to unless a
   !> part is free to move.
   real(wp), parameter :: no_more = 1.0_wp

   type, extends(equilibrium_type) :: frame_equilibrium
      !> An element that snaps back on the present lines; 0: none
      integer :: unstable = 0
      type(frame_type), pointer, private :: frame => null()
      type(band_matrix), private :: matrix
      !> Tangents of the elements
      real(wp), allocatable, private :: tangent(:)
      !> Load and residual on the unknowns, and solutions (unknowns, 2); row that is controlled (unknowns)
      real(wp), allocatable, private :: right(:, :), change(:, :), control(:)
      !> Forces of the springs, and deformations that bring the inside of elements to equilibrium
      real(wp), allocatable, private :: f(:), inner(:), way(:), inner_load(:), pushed(:)
   contains
      procedure :: create
      procedure :: follow
      procedure :: find_unbalance
   end type frame_equilibrium

contains

   subroutine create(self, frame, loads)
      class(frame_equilibrium), intent(out) :: self
      type(frame_type), intent(in), target :: frame
      !> Whether the dead load grows
      logical, intent(in) :: loads
      type(band_matrix) :: initial
      integer :: springs

      self%frame => frame
      self%loads = loads
      springs = size(frame%place)
      self%moving = springs
      allocate (self%tangent(frame%tangent_numbers), self%right(frame%unknowns, 2), &
                self%change(frame%unknowns, 2), self%f(springs), self%inner(springs), self%way(springs), &
                self%correction(springs), self%inner_load(springs), self%pushed(frame%unknowns), &
                source=0.0_wp)
      self%control = frame%arm(frame%inside + 1:)
      call initial%create(frame%unknowns, frame%half_width)
      call frame%add_stiffness(frame%initial_stiffness, frame%initial_tangent, initial%band)
      call self%matrix%create(frame%unknowns, frame%half_width, initial%band(1, :))
   end subroutine create

   subroutine follow(self, springs, by_force, corrects, displacement, force, rate, found)
      class(frame_equilibrium), intent(inout) :: self
      type(spring_array), intent(in) :: springs
      logical, intent(in) :: by_force
      !> Corrections are always found: they cost little beside the rates
      logical, intent(in) :: corrects
      real(wp), intent(in) :: displacement, force
      real(wp), intent(inout), contiguous :: rate(:)
      logical, intent(out) :: found
      real(wp) :: y(2), missing
      logical :: settled

      associate (frame => self%frame, always => corrects)
         call linearise(self, springs, found)
         if (.not. found) return
         call find_residual(self, springs, force)
         call find_pattern(self)
         if (by_force) then
            call self%matrix%factor()
            found = self%matrix%positive
            if (.not. found) return
            self%change = self%right
            call self%matrix%solve(self%change, found)
            y = [1.0_wp, 0.0_wp]
         else
            call self%matrix%factor()
            call self%matrix%set_border(self%right(:, 1), self%control, found)
            if (.not. found) return
            self%pushed = self%right(:, 1)
            self%right(:, 1) = 0.0_wp
            missing = displacement - sum(self%control*springs%d(frame%inside + 1:))
            call self%matrix%solve_bordered(self%right(:, :1), [1.0_wp], self%change(:, :1), y(:1), found)
            self%right(:, 1) = self%pushed
            ! A part that gives way beside the top moves without end while the top does not.
            found = found .and. maxval(abs(self%change(:, 1))) < without_end
            if (.not. found) return
            call self%matrix%solve_bordered(self%right(:, 2:), [missing], self%change(:, 2:), y(2:), settled)
            ! Of a mechanism what corrects round-off is round-off itself; more than that is found by the row.
            if (.not. settled .or. maxval(abs(self%change(:, 2))) > no_more*frame%total_height) then
               self%change(:, 2) = 0.0_wp
               y(2) = 0.0_wp
            end if
         end if
         if (.not. found) return
         self%force_rate = y(1)
         self%force_correction = y(2)
         call frame%spring_rates(self%tangent, self%change(:, 1), rate)
         call frame%drop_round_off(self%tangent, self%change(:, 1), rate)
         call frame%spring_rates(self%tangent, self%change(:, 2), self%correction)
         rate = rate + y(1)*self%inner_load
         self%correction = self%correction + self%inner + y(2)*self%inner_load
         self%displacement_rate = sum(self%control*self%change(:, 1))
         self%further_rate = frame%way_of_load(self%loads, rate) - self%displacement_rate
      end associate
   end subroutine follow

   !> Tangents and the band on the present lines.
   subroutine linearise(self, springs, found)
      class(frame_equilibrium), intent(inout) :: self
      type(spring_array), intent(in) :: springs
      logical, intent(out) :: found

      associate (frame => self%frame)
         call frame%linearise(springs%k, self%tangent, self%unstable)
         found = self%unstable == 0
         if (.not. found) return
         self%matrix%band = 0.0_wp
         call frame%add_stiffness(springs%k, self%tangent, self%matrix%band)
         if (frame%axially_loaded) call frame%add_geometric(frame%compression, self%matrix%band)
      end associate
   end subroutine linearise

   !> The load on the unknowns per unit of what is driven, and what it does inside of elements.
   subroutine find_pattern(self)
      class(frame_equilibrium), intent(inout) :: self

      self%inner_load = 0.0_wp
      if (self%loads) then
         self%f = 0.0_wp
         call self%frame%unknown_forces(self%inner_load, self%f, 1.0_wp, self%tangent, self%right(:, 1), &
                                        self%way)
         self%inner_load = self%way
      else
         self%right(:, 1) = self%frame%pattern(lateral)%force
      end if
   end subroutine find_pattern

   !> The largest force out of equilibrium where the springs are.
   subroutine find_unbalance(self, springs, force)
      class(frame_equilibrium), intent(inout) :: self
      type(spring_array), intent(in) :: springs
      real(wp), intent(in) :: force

      ! Where an element snaps back its last tangent serves.
      call self%frame%linearise(springs%k, self%tangent, self%unstable)
      call find_residual(self, springs, force)
   end subroutine find_unbalance

   !> The residual where the springs are, and the largest of it.
   subroutine find_residual(self, springs, force)
      class(frame_equilibrium), intent(inout) :: self
      type(spring_array), intent(in) :: springs
      real(wp), intent(in) :: force
      integer :: i

      associate (frame => self%frame)
         self%f = springs%f0 + springs%k*(springs%d - springs%d0)
         call frame%unknown_forces(springs%d, self%f, merge(force, 1.0_wp, self%loads), self%tangent, &
                                   self%right(:, 2), self%inner)
         if (.not. self%loads) self%right(:, 2) = self%right(:, 2) + force*frame%pattern(lateral)%force
         self%unbalance = 0.0_wp
         do i = 1, frame%unknowns
            self%unbalance = max(self%unbalance, abs(self%right(i, 2))/frame%reach(i))
         end do
      end associate
   end subroutine find_residual

end module rbs_solve_static_frame_equilibrium
