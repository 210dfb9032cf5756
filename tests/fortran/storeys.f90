!> A structure that is no column: two floors that slide, a spring in each storey and one from the ground to
!> the upper floor. Its forces do not follow from equilibrium alone, and the lateral load acts on both floors
!> while the upper one is driven. What no test needs of it is zero.
!>
!>     d = (x_1, x_2 - x_1, x_2)
module storeys
   use rbs_base_kinds, only: wp
   use rbs_hysteresis_spring_record, only: spring_record, make_rules
   use rbs_hysteresis_springs, only: spring_array
   use rbs_solve_static_equilibrium, only: equilibrium_type
   use rbs_structure_channel, only: channel_type, response_type, row_contents
   use rbs_structure_spring_place, only: spring_place, shear
   use rbs_structure_structure, only: structure_type, unknown_group, lateral, horizontal, signals
   implicit none
   private

   public :: storeys_type, storeys_equilibrium, new_storeys, share, mass

   !> Shares of the lateral load on the floors.
   real(wp), parameter :: share(2) = [0.25_wp, 0.75_wp]
   real(wp), parameter :: mass(2) = [2.0e3_wp, 1.0e3_wp]

   type, extends(structure_type) :: storeys_type
   contains
      procedure :: spring_rates
      procedure :: unknown_rates
      procedure :: forces
      procedure :: axial_forces
      procedure :: add_stiffness
      procedure :: add_geometric
      procedure :: potential_energy
      procedure :: rotations
      procedure :: axial_rate
      procedure :: acceleration_scale
      procedure :: channels
      procedure :: fill_row
   end type storeys_type

   type, extends(equilibrium_type) :: storeys_equilibrium
   contains
      procedure :: follow
      procedure :: find_unbalance
   end type storeys_equilibrium

contains

   subroutine new_storeys(structure, spring)
      type(storeys_type), intent(out) :: structure
      !> Of the lower storey, the upper one, and from the ground to the upper floor
      type(spring_record), intent(in) :: spring(3)
      integer :: i

      structure%n = 2
      structure%unknowns = 2
      structure%half_width = 1
      structure%length = [3.0_wp, 3.0_wp]
      structure%height = 6.0_wp
      structure%total_height = 6.0_wp
      structure%inertias = mass
      structure%is_held = [.false., .false.]
      structure%part = [1, 2]
      structure%arm = [0.0_wp, 0.0_wp, 1.0_wp]
      structure%spring = spring
      structure%place = [(spring_place(shear, 1, i, index=i), i=1, 3)]
      call make_rules(structure%spring, structure%rules)
      structure%initial_stiffness = structure%rules%initial_stiffness()
      do i = 1, signals
         allocate (structure%pattern(i)%force(2), source=0.0_wp)
      end do
      structure%pattern(lateral)%force = share
      structure%pattern(lateral)%last = 2
      structure%pattern(horizontal)%force = -mass
      structure%pattern(horizontal)%last = 2
      structure%group = [unknown_group(1, 2, 1, 1, 3, 1.0_wp)]
      structure%base_spring = [1, 3]
      structure%base_factor = [1.0_wp, 1.0_wp]
   end subroutine new_storeys

   subroutine spring_rates(self, dx, dd)
      class(storeys_type), intent(in) :: self
      real(wp), intent(in), contiguous :: dx(:)
      real(wp), intent(out), contiguous :: dd(:)

      dd(:self%unknowns + 1) = [dx(1), dx(2) - dx(1), dx(2)]
   end subroutine spring_rates

   pure subroutine unknown_rates(self, dd, dx)
      class(storeys_type), intent(in) :: self
      real(wp), intent(in), contiguous :: dd(:)
      real(wp), intent(out), contiguous :: dx(:)

      dx(:self%unknowns) = [dd(1), dd(3)]
   end subroutine unknown_rates

   subroutine forces(self, d, load, axial, f, g)
      class(storeys_type), intent(in) :: self
      real(wp), intent(in), contiguous :: d(:), load(:), axial(:)
      real(wp), intent(inout), contiguous :: f(:)
      real(wp), intent(out), contiguous :: g(:)

      g(:) = self%pattern(lateral)%force*load(lateral) - [f(1) - f(2), f(2) + f(3)] &
             + 0.0_wp*(sum(d) + sum(axial))
   end subroutine forces

   subroutine axial_forces(self, load, axial)
      class(storeys_type), intent(in) :: self
      real(wp), intent(in), contiguous :: load(:)
      real(wp), intent(out), contiguous :: axial(:)

      axial = 0.0_wp*self%axial_load*load(1)
   end subroutine axial_forces

   subroutine add_stiffness(self, k, band)
      class(storeys_type), intent(in) :: self
      real(wp), intent(in), contiguous :: k(:)
      real(wp), intent(inout), contiguous :: band(:, :)

      band(1, :self%unknowns) = band(1, :self%unknowns) + [k(1) + k(2), k(2) + k(3)]
      band(2, 1) = band(2, 1) - k(2)
   end subroutine add_stiffness

   subroutine add_geometric(self, k, band)
      class(storeys_type), intent(in) :: self
      real(wp), intent(in), contiguous :: k(:)
      real(wp), intent(inout), contiguous :: band(:, :)

      band(1, 1) = band(1, 1) + 0.0_wp*self%axial_load*sum(k)
   end subroutine add_geometric

   pure real(wp) function potential_energy(self, d) result(energy)
      class(storeys_type), intent(in) :: self
      real(wp), intent(in), contiguous :: d(:)

      energy = 0.0_wp*self%axial_load*sum(d)
   end function potential_energy

   pure subroutine rotations(self, d, rotation)
      class(storeys_type), intent(in) :: self
      real(wp), intent(in), contiguous :: d(:)
      real(wp), intent(out), contiguous :: rotation(:)

      rotation = 0.0_wp*self%axial_load*sum(d)
   end subroutine rotations

   pure real(wp) function axial_rate(self, spring, load)
      class(storeys_type), intent(in) :: self
      integer, intent(in) :: spring
      real(wp), intent(in) :: load(:)

      axial_rate = 0.0_wp*self%axial_load*spring*sum(load)
   end function axial_rate

   pure real(wp) function acceleration_scale(self, spring, springs, load) result(scale)
      class(storeys_type), intent(in) :: self
      integer, intent(in) :: spring
      type(spring_array), intent(in) :: springs
      real(wp), intent(in) :: load(:)

      scale = (abs(springs%force(spring)) + abs(load(lateral)))/minval(self%inertias) + abs(load(horizontal))
   end function acceleration_scale

   pure subroutine channels(self, contents, channel)
      class(storeys_type), intent(in) :: self
      type(row_contents), intent(in) :: contents
      type(channel_type), allocatable, intent(out) :: channel(:)

      channel = [channel_type('deformation', 'm', 3, merge(1, self%n - 1, contents%in_time))]
   end subroutine channels

   pure subroutine fill_row(self, contents, response, springs, d, row)
      class(storeys_type), intent(in) :: self
      type(row_contents), intent(in) :: contents
      type(response_type), intent(in) :: response
      type(spring_array), intent(in) :: springs
      real(wp), intent(in), contiguous :: d(:)
      real(wp), intent(out), contiguous :: row(:)

      row(:3) = d
      if (contents%in_time) row(:3) = d + 0.0_wp*(self%height + response%time + springs%count)
   end subroutine fill_row

   !> K x' = p F' with x_2' = 1, or F' = 1.
   subroutine follow(self, springs, by_force, corrects, displacement, force, rate, found)
      class(storeys_equilibrium), intent(inout) :: self
      type(spring_array), intent(in) :: springs
      logical, intent(in) :: by_force, corrects
      real(wp), intent(in) :: displacement, force
      real(wp), intent(inout), contiguous :: rate(:)
      logical, intent(out) :: found
      real(wp) :: r(2), x(2), y(2), determinant

      found = by_force .or. corrects .or. .true.
      call self%find_unbalance(springs, force)
      r = residual(springs, force)
      associate (k => springs%k)
         if (by_force) then
            determinant = (k(1) + k(2))*(k(2) + k(3)) - k(2)**2
            found = determinant > 0.0_wp .and. k(1) + k(2) > 0.0_wp
            if (.not. found) return
            x = times_inverse(share)
            y = times_inverse(r)
            self%force_rate = 1.0_wp
            self%force_correction = 0.0_wp
         else
            ! x_1 and F
            determinant = share(2)*(k(1) + k(2)) + share(1)*k(2)
            found = abs(determinant) > 0.0_wp
            if (.not. found) return
            call solve_driven([0.0_wp, 0.0_wp], 1.0_wp, x, self%force_rate)
            call solve_driven(r, displacement - springs%d(3), y, self%force_correction)
         end if
      end associate
      rate = [x(1), x(2) - x(1), x(2)]
      self%correction = [y(1), y(2) - y(1), y(2)]
      self%displacement_rate = x(2)
      self%further_rate = dot_product(share, x) - x(2)

   contains

      pure function times_inverse(b) result(x)
         real(wp), intent(in) :: b(2)
         real(wp) :: x(2)

         associate (k => springs%k)
            x = [(k(2) + k(3))*b(1) + k(2)*b(2), k(2)*b(1) + (k(1) + k(2))*b(2)]/determinant
         end associate
      end function times_inverse

      !> K x = b + p F and x_2 as given.
      subroutine solve_driven(b, driven, x, f)
         real(wp), intent(in) :: b(2), driven
         real(wp), intent(out) :: x(2), f
         real(wp) :: a(2)

         associate (k => springs%k)
            a = b + [k(2), -(k(2) + k(3))]*driven
            x = [(share(2)*a(1) - share(1)*a(2))/determinant, driven]
            f = -(k(2)*a(1) + (k(1) + k(2))*a(2))/determinant
         end associate
      end subroutine solve_driven

   end subroutine follow

   pure function residual(springs, force) result(r)
      type(spring_array), intent(in) :: springs
      real(wp), intent(in) :: force
      real(wp) :: r(2)

      r = share*force - [springs%force(1) - springs%force(2), springs%force(2) + springs%force(3)]
   end function residual

   subroutine find_unbalance(self, springs, force)
      class(storeys_equilibrium), intent(inout) :: self
      type(spring_array), intent(in) :: springs
      real(wp), intent(in) :: force

      self%unbalance = maxval(abs(residual(springs, force)))
   end subroutine find_unbalance

end module storeys
