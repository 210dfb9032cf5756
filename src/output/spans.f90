!> Members under load that are bent most between their springs: the moment there is a parabola, and where no
!> spring stands nothing cracks or yields.
module rbs_output_spans
   use rbs_base_error, only: message_list
   use rbs_base_kinds, only: wp
   use rbs_base_text, only: to_text
   use rbs_hysteresis_springs, only: spring_array
   use rbs_structure_frame_frame, only: frame_type
   use rbs_structure_spring_location, only: flexure, layer
   use rbs_structure_structure, only: structure_type
   implicit none
   private

   public :: span_watch, hinge_turned

   !> A rotation beyond the yield of any hinge [rad].
   real(wp), parameter :: hinge_turned = 0.02_wp

   !> Ratios of the moment in a span to that of its springs above which a note is due: for springs, and for
   !> layers, whose moment depends on the axial load.
   real(wp), parameter :: over_springs = 1.005_wp, over_layers = 1.05_wp

   !> A loaded member between its springs.
   type :: span_type
      !> Number of the member, and w l^2/2 by its load w across it [N m]
      integer :: member = 0
      real(wp) :: hung = 0.0_wp
      !> Largest moment in the span, where, in shares of the clear length, and that of its springs [N m]
      real(wp) :: largest = 0.0_wp, place = 0.0_wp, of_springs = 0.0_wp
      !> Ratio above which a note is due
      real(wp) :: over = over_springs
   end type span_type

   !> A watch over the rows of a frame.
   type :: span_watch
      !> Whether there is a span to watch
      logical :: watches = .false.
      type(span_type), allocatable, private :: span(:)
      !> Span of each flexural spring, 0 for none (flexural springs in rows); in a member with layers only the
      !> layers have one
      integer, allocatable, private :: owner(:)
      !> Places in a row before the moments of the first ends, of the last ends, and of the flexural springs
      integer, private :: from = 0, to = 0, moment = 0
   contains
      procedure :: start
      procedure :: update
      procedure :: tell
   end type span_watch

contains

   !> Begin to watch the members of a frame that have a load across and flexural springs or layers.
   subroutine start(self, structure, from, to, moment)
      class(span_watch), intent(out) :: self
      class(structure_type), intent(in) :: structure
      !> Places in a row before the moments of the first ends, of the last ends, and of the flexural springs
      integer, intent(in) :: from, to, moment
      integer, allocatable :: of(:)
      logical, allocatable :: is_layer(:)
      integer :: i, j

      self%from = from
      self%to = to
      self%moment = moment
      allocate (self%span(0))
      select type (structure)
      class is (frame_type)
         associate (springs => structure%listed(flexure)%spring)
            of = structure%location(springs)%member
            is_layer = structure%location(springs)%kind == layer
         end associate
         allocate (self%owner(size(of)), source=0)
         do i = 1, structure%members
            associate (e => structure%element(i))
               if (.not. (abs(e%load_across) > 0.0_wp .and. any(of == i))) cycle
               self%span = [self%span, span_type(i, 0.5_wp*e%load_across*e%length**2)]
            end associate
            j = size(self%span)
            if (any(of == i .and. is_layer)) self%span(j)%over = over_layers
            where (of == i .and. (is_layer .or. .not. any(of == i .and. is_layer))) self%owner = j
         end do
      end select
      self%watches = size(self%span) > 0
   end subroutine start

   !> Take a row into account: the largest moments in spans and in springs.
   pure subroutine update(self, row)
      class(span_watch), intent(inout) :: self
      !> Values of all channels, see `channel_list`
      real(wp), intent(in) :: row(:)
      !> Where the moment is largest, in shares of the length: the top of the parabola; the moment there
      real(wp) :: share, moment
      integer :: i

      do i = 1, size(self%span)
         associate (s => self%span(i), a => row(self%from + self%span(i)%member), &
                    b => row(self%to + self%span(i)%member))
            share = 0.5_wp - (a + b)/(2.0_wp*s%hung)
            if (.not. (share > 0.0_wp .and. share < 1.0_wp)) cycle
            moment = abs(a*(1.0_wp - share) - b*share + s%hung*share*(1.0_wp - share))
            if (.not. moment > s%largest) cycle
            s%largest = moment
            s%place = share
         end associate
      end do
      do i = 1, size(self%owner)
         if (self%owner(i) == 0) cycle
         associate (s => self%span(self%owner(i)))
            s%of_springs = max(s%of_springs, abs(row(self%moment + i)))
         end associate
      end do
   end subroutine update

   !> Note the member whose span is bent most beyond what its springs yield at, or have carried.
   subroutine tell(self, structure, notes)
      class(span_watch), intent(in) :: self
      class(structure_type), intent(in) :: structure
      type(message_list), intent(inout) :: notes
      character(len=:), allocatable :: more
      !> Moments of the springs of the spans [N m]: carried, or at yield
      real(wp), allocatable :: known(:)
      type(spring_array) :: springs
      integer :: i

      if (.not. allocated(self%span)) return
      select type (structure)
      class is (frame_type)
         associate (s => self%span)
            known = s%of_springs
            ! The strength takes time to find, and is not asked for if what the springs have carried covers
            ! the span.
            if (.not. any(s%largest > s%over*known)) return
            call structure%create_springs(springs, structure%constant_axial)
            do i = 1, size(self%owner)
               if (self%owner(i) > 0) call find_strength(springs, structure%listed(flexure)%spring(i), &
                                                         known(self%owner(i)))
            end do
            if (.not. any(s%largest > s%over*known)) return
            i = maxloc(s%largest/max(known, tiny(1.0_wp)), dim=1, mask=s%largest > s%over*known)
            more = ''
            if (count(s%largest > s%over*known) > 1) then
               more = ', and so in '//to_text(count(s%largest > s%over*known) - 1)//' more members'
            end if
            call notes%add('member '//trim(structure%member_name(s(i)%member))//': at '// &
                           to_text(anint(100.0_wp*s(i)%place)/100.0_wp)//' of its clear length the '// &
                           'moment in its span reaches '//to_text(s(i)%largest)//' N m, '// &
                           to_text(anint(100.0_wp*s(i)%largest/max(known(i), tiny(1.0_wp)))/100.0_wp)// &
                           ' times what its flexural springs yield at or carry'//more//'; no spring '// &
                           'stands there, so that nothing cracks or yields. Put a node there, or a '// &
                           'spring (flexure at a place, section.member with its load)')
         end associate
      end select
   end subroutine tell

   !> Raise a moment to that of a hinge at a rotation beyond its yield, to either side. That of layers depends
   !> on their axial load, and is not known.
   subroutine find_strength(springs, i, moment)
      !> Virgin springs
      type(spring_array), intent(inout) :: springs
      !> Number of the spring
      integer, intent(in) :: i
      !> Moment that the spring has carried [N m]; not bounded if it is elastic
      real(wp), intent(inout) :: moment
      integer :: side

      if (springs%joints%of(i) > 0) return
      if (springs%rules%name(springs%rules%of(i)) == 'elastic') moment = huge(moment)
      do side = 1, -1, -2
         call springs%advance_to(i, side*hinge_turned)
         moment = max(moment, abs(springs%force(i)))
      end do
   end subroutine find_strength

end module rbs_output_spans
